"""What a redrawn outline must stay near to: the drawing in mm of the frame, and what can be recognised in it.

``Shape`` in the frame and, where they are known, its curves -> ``Target``: dense polygons, curves, true corners. From
it come mirror axes (``redraw.symmetry``) and parts that are smaller than a tolerance (``redraw.narrow_parts``).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, Indices, points_array
from foldcut.core.model import Shape
from foldcut.drawing.curved import similarity
from foldcut.geometry.curves import CurvedLoop, Line, farthest_apart, is_within
from foldcut.geometry.vectors import signed_area
from foldcut.methods.frame import Frame

__all__ = ["Samples", "Target"]

FLAT_MM = 0.02
"""How far the sides of the dense polygons may be from the curves, in mm of the frame."""

TURN = math.radians(25)
"""The tangent turns by more than this at a true corner."""

STEP_MM = 0.1
"""A corner that an arc with chords of this sagitta would have, in mm of the frame, may belong to a flattened arc."""

SHARPER = 2.5
"""By how much more than its neighbours a corner turns if it is none of a flattened arc."""

TINY_MM = 0.02
"""Segments shorter than this have no direction, in mm of the frame."""


@dataclass(frozen=True, eq=False)
class Samples:
    """Points along one loop, about evenly apart, true corners among them.

    ``points`` ``(n, 2)`` mm; ``tangents`` ``(n, 2)``: unit vectors ahead; ``along`` ``(n,)``: mm from the start of the
    loop; ``corner`` ``(n,)``: whether it is a true corner; ``places`` ``(n,)`` on the curved loop. ``length`` is the
    loop's.
    """

    points: Floats
    tangents: Floats
    along: Floats
    corner: Bools
    places: Floats
    length: float


@dataclass(frozen=True, eq=False)
class Target:
    """A drawing in mm of the frame.

    ``loops``: polygons ``(n, 2)``, counter-clockwise, within 0.02 mm of ``curves``, which are parallel to them;
    ``places[i]`` ``(n,)`` has the place on curve i of each corner of loop i. ``parent`` is as in ``Shape``.
    """

    loops: tuple[Floats, ...]
    parent: tuple[int, ...]
    curves: tuple[CurvedLoop, ...]
    places: tuple[Floats, ...]

    @classmethod
    def of(cls, shape: Shape, curves: Sequence[CurvedLoop] = ()) -> Target:
        """Return the target for a shape in mm of the frame; ``curves`` are its loops in the same order, if known.

        They may run either way around. Curves that cross by a hair, where the flattened loops of the shape do not, are
        not used.
        """
        target = cls.of_curves(curves or [CurvedLoop.of_points(loop) for loop in shape.loops], shape.parent)
        return target if not curves or shapely.is_simple(target.outline) else cls.of(shape)

    @classmethod
    def of_curves(cls, curves: Sequence[CurvedLoop], parent: Sequence[int]) -> Target:
        """Return the target for curved loops in mm of the frame, either way around."""
        onward = tuple(one if signed_area(one.flattened(1.0)) > 0 else one.reversed() for one in curves)
        flat = [one.flattened_at(FLAT_MM) for one in onward]
        return cls(tuple(points for points, _ in flat), tuple(parent), onward, tuple(places for _, places in flat))

    @classmethod
    def of_frame(cls, frame: Frame, curves: Sequence[CurvedLoop] = ()) -> Target:
        """Return the target for the shape of a frame; ``curves`` are those of ``frame.laid.drawn``, if known."""
        if not curves:
            return cls.of(frame.shape)
        matrix = similarity(np.concatenate(frame.laid.drawn.loops), np.concatenate(frame.shape.loops))
        return cls.of(frame.shape, [one.transformed(matrix) for one in curves])

    @cached_property
    def true_corners(self) -> tuple[Indices, ...]:
        """The corners of each dense loop that are corners of the drawing, as indices into it, in order."""
        return tuple(
            np.searchsorted(places, _true_corners(curve))
            for places, curve in zip(self.places, self.curves, strict=True)
        )

    @cached_property
    def area(self) -> shapely.Geometry:
        """The inside of the dense loops by the even-odd rule."""
        around = [one for one in range(len(self.loops)) if _depth(self.parent, one) % 2 == 0]
        holes = [[self.loops[k] for k, up in enumerate(self.parent) if up == one] for one in around]
        return shapely.union_all(
            [shapely.Polygon(self.loops[one], own) for one, own in zip(around, holes, strict=True)]
        )

    @cached_property
    def outline(self) -> shapely.Geometry:
        """All dense loops as closed lines."""
        return shapely.multilinestrings([shapely.linestrings(np.concatenate([loop, loop[:1]])) for loop in self.loops])

    @property
    def shape(self) -> Shape:
        """The dense loops as a shape; nothing is checked."""
        return Shape(self.loops, self.parent)

    def off_by(self, polygons: Sequence[Floats]) -> tuple[float, Floats]:
        """Return the Hausdorff distance of the drawing's curves from polygons in mm, and where it is, ``(2,)``."""
        return farthest_apart(self.curves, polygons)

    def is_within(self, polygons: Sequence[Floats], tolerance: float) -> bool:
        """Tell whether ``off_by`` is at most ``tolerance`` mm; this is faster."""
        return is_within(self.curves, polygons, tolerance)

    def transformed(self, matrix: Floats) -> Target:
        """Return the target after a similarity ``(2, 3)`` of about the same size; what is known of it is kept."""
        curves = tuple(one.transformed(matrix) for one in self.curves)
        if np.linalg.det(matrix[:, :2]) < 0:
            return Target.of_curves(curves, self.parent)
        loops = tuple(points_array(loop @ matrix[:, :2].T + matrix[:, 2]) for loop in self.loops)
        moved = Target(loops, self.parent, curves, self.places)
        moved.__dict__["true_corners"] = self.true_corners
        return moved

    def samples(self, step: float) -> tuple[Samples, ...]:
        """Return points along every loop, at most ``step`` mm apart, evenly so between true corners."""
        return tuple(self._samples(number, step) for number in range(len(self.loops)))

    def _samples(self, number: int, step: float) -> Samples:
        loop, places, curve = self.loops[number], self.places[number], self.curves[number]
        sides = np.hypot(*(np.roll(loop, -1, axis=0) - loop).T)
        along = np.concatenate([[0.0], np.cumsum(sides)])
        corners = self.true_corners[number]
        stops = along[corners] if len(corners) else np.zeros(1)
        gaps = np.diff(np.concatenate([stops, stops[:1] + along[-1]]))
        counts = np.maximum(np.ceil(gaps / step - 1e-9), 1).astype(np.intp)
        share = np.concatenate([np.arange(count) / count for count in counts])
        at = (np.repeat(stops, counts) + share * np.repeat(gaps, counts)) % along[-1]
        first = np.cumsum(counts) - counts
        corner = np.zeros(len(at), dtype=np.bool_)
        corner[first[: len(corners)]] = True
        place = np.interp(at, along, np.concatenate([places, [float(len(curve))]]))
        order = np.argsort(at, kind="stable")
        at, place, corner = at[order], place[order], corner[order]
        tangents = curve.tangents(place)
        joint = (place % 1 == 0) & ~corner
        tangents[joint] += curve.tangents(np.nextafter(place[joint], -1.0))
        tangents /= np.hypot(*tangents.T)[:, None]
        return Samples(points_array(curve.points(place)), tangents, at, corner, place, float(along[-1]))


def _depth(parent: Sequence[int], loop: int) -> int:
    return 0 if parent[loop] < 0 else 1 + _depth(parent, parent[loop])


def _true_corners(curve: CurvedLoop) -> Floats:
    """Return the places where a tangent turns at one point by more than ``TURN``, in order.

    A corner between two lines counts only if it is not one that an arc drawn as chords would have.
    """
    segments = curve.segments
    chords = np.array([segment.points([0.0, 1.0]) for segment in segments])
    straight = np.array([isinstance(segment, Line) for segment in segments])
    lengths = np.where(straight, np.hypot(*(chords[:, 1] - chords[:, 0]).T), np.inf)
    for number in np.flatnonzero(~straight).tolist():
        if np.ptp(segments[number].cubics.reshape(-1, 2), axis=0).max() < TINY_MM:
            lengths[number] = 0.0
    kept = np.flatnonzero(lengths > TINY_MM)
    if len(kept) < 2:
        return np.empty(0) if len(kept) == 0 else kept[np.abs(curve.turns[kept]) > TURN].astype(np.float64)
    ahead = np.array([segments[k].tangents([0.0])[0] for k in kept]) @ (1, 1j)
    behind = np.array([segments[k].tangents([1.0])[0] for k in kept]) @ (1, 1j)
    turn = np.abs(np.angle(ahead * np.roll(behind, 1).conj()))
    length = lengths[kept]
    before = np.roll(length, 1)
    with np.errstate(invalid="ignore"):
        sagitta = np.minimum(length, before) / 2 * np.tan(turn / 4)
    # the turns at the other ends of those of its two lines that are short enough to be chords
    chord = 2 * STEP_MM / np.tan(np.maximum(turn, 1e-9) / 4)
    beside = np.maximum(
        np.where(length < chord, np.roll(turn, -1), 0.0), np.where(before < chord, np.roll(turn, 1), 0.0)
    )
    is_corner = (turn > TURN) & ((sagitta > STEP_MM) | (turn > SHARPER * beside))
    return kept[is_corner].astype(np.float64)
