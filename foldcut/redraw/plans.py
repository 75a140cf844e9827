"""In which ways a drawing may be folded that is redrawn within a tolerance: as a whole, or along its mirror axes first.

``Drawing``, with its curves and a tolerance -> ``Plan``s: the drawing in a frame, with the axes in the middle of
the sheet.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import shapely

from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import ShapeError
from foldcut.core.model import Shape, Sheet
from foldcut.drawing.laying import Laid, Laying
from foldcut.drawing.shape import make_shape, polygon_loops
from foldcut.drawing.simplify import simplify
from foldcut.geometry.curves import CurvedLoop
from foldcut.geometry.mirror_axes import symmetric
from foldcut.methods.frame import Frame, frames
from foldcut.methods.mirror.halves import halves_of
from foldcut.methods.mirror.unfold import Half
from foldcut.pattern.first_folds import FEWEST_OF_WEDGE
from foldcut.redraw.narrow_parts import SmallPart, treated
from foldcut.redraw.proxy import Field
from foldcut.redraw.starts import Axis as StartAxis
from foldcut.redraw.starts import all_starts
from foldcut.redraw.symmetry import Axis, Symmetry, symmetry
from foldcut.redraw.target import Target

ALIGNED = 1e-5
"""An axis whose direction differs by less than this from that of a side of the sheet, in radians, is parallel to it."""

SQUARE = 1e-4
"""Two axes are at right angles if the angle between them differs from that by less than this, in radians."""

EXACT_MM = 0.02
"""A drawing that is less off from symmetric, in mm of the frame, is as good as exact."""

MOST_OWN_CORNERS = 60
"""A drawing with no more corners than this is an outline to begin with itself."""

LEVEL = 1e-3
"""An axis found anew in a turned drawing may be off by so much, in radians."""

NEAR_MIDDLE = 1.0
"""So far, in mm of the frame, a drawing is moved at least to have its axis in the middle of the sheet."""

MOST_AXES = 4
"""How many sets of axes are tried."""

FAR = 1e4
"""More than the size of any sheet of a frame, in mm."""

LEAST_SIDE = 0.05
"""Outlines with shorter sides are no good beginning, in mm."""

Corners = tuple[Floats, tuple[int, ...]]
"""The corners of several loops, ``(n, 2)`` mm, and how many each loop has."""


@dataclass(frozen=True, eq=False)
class Plan:
    """A drawing in a frame, and the axes the sheet is folded along first: 0 its upright middle line, 1 the level one.

    ``laid``: how the drawing lies on the sheet that is asked for, turned perhaps; ``target`` is in mm of the frame,
    with the axes in the middle of the frame's sheet, and ``off`` mm from symmetric.
    """

    laid: Laid
    frame: Frame
    target: Target
    axes: tuple[int, ...]
    off: float = 0.0

    @cached_property
    def middle(self) -> Floats:
        """Where the part of the frame's sheet begins that is left after the axes are folded, ``(2,)`` mm."""
        size = np.array([self.frame.sheet.width, self.frame.sheet.height])
        return np.where(np.isin([0, 1], self.axes), size / 2, 0.0)

    @cached_property
    def part(self) -> Sheet:
        """That part of the frame's sheet."""
        size = np.array([self.frame.sheet.width, self.frame.sheet.height]) - self.middle
        return Sheet(*size.tolist())

    def field(self, tolerance: float) -> Field:
        """Return what outlines are compared with, within ``tolerance`` mm, on that part of the sheet."""
        loops = [loop - self.middle for loop in self.target.loops]
        if self.off > EXACT_MM:  # the outline will be exactly symmetric, so it has to be near to the image, too
            for axis in self.axes:
                loops += [points_array(loop * np.where(np.arange(2) == axis, -1.0, 1.0)) for loop in loops]
        return Field(tuple(loops), self.part.width, self.part.height, tolerance, self.axes)

    def starts(self, tolerance: float) -> Iterator[Corners]:
        """Yield outlines to begin a search with, on that part of the sheet."""
        middle = np.array([self.frame.sheet.width, self.frame.sheet.height]) / 2
        axes = [StartAxis(middle, math.pi / 2 if axis == 0 else 0.0) for axis in self.axes]
        own = self.target.shape if self.target.shape.corner_count <= MOST_OWN_CORNERS else None
        if own is not None and (corners := self._corners_beside_axes(own, tolerance)) is not None:
            yield corners
        for start in all_starts(self.target.shape, tolerance, axes, loose=True):
            if len(start.axes) < len(axes):
                return
            if (corners := self._corners_beside_axes(start.shape, tolerance)) is not None:
                yield corners

    def _corners_beside_axes(self, shape: Shape, tolerance: float) -> Corners | None:
        """Return the corners of an outline on that part of the sheet, None where it is no good beginning."""
        loops = shape.loops
        if min(float(np.hypot(*(np.roll(loop, -1, axis=0) - loop).T).min()) for loop in loops) < LEAST_SIDE:
            return None
        if self.axes:
            middle = np.array([self.frame.sheet.width, self.frame.sheet.height]) / 2
            exact, moved = symmetric(shape, middle, self.axes)
            if moved > 0.1 * tolerance:
                return None
            loops = next(halves_of(exact, self.frame.sheet, self.axes)).loops
        return np.concatenate(loops), tuple(map(len, loops))

    def outline(self, corners: Floats, sizes: tuple[int, ...]) -> tuple[Shape, Half | None]:
        """Return the whole shape of an outline on its part of the sheet, and the half to fold it by, if there are axes.

        Raises ``ShapeError`` where it is no shape, or its loops are not nested as in the drawing.
        """
        loops = tuple(np.split(corners, np.cumsum(sizes)[:-1]))
        if not self.axes:
            shape = make_shape(loops)
            if len(shape.parent) != len(self.target.parent):
                raise ShapeError("the redrawn outline is no shape")
            return shape, None
        area = shapely.Polygon()
        for loop in loops:
            area = area.symmetric_difference(shapely.Polygon(loop))
        low = [0.0 if axis in self.axes else -FAR for axis in (0, 1)]
        area = area.intersection(shapely.box(*low, FAR, FAR))
        for axis in self.axes:
            sign = np.where(np.arange(2) == axis, -1.0, 1.0)
            area = area.union(shapely.transform(area, lambda points, sign=sign: points * sign))
        polygons = [one for one in getattr(area, "geoms", [area]) if one.area > 0]
        shape = make_shape([loop + self.middle for loop in polygon_loops(polygons)])
        if len(shape.parent) != len(self.target.parent):
            raise ShapeError("the redrawn outline is no shape")
        return shape, Half(shape, loops, self.part, self.axes)


@dataclass(frozen=True, eq=False)
class Drawing:
    """A drawing, and how it is laid, with what is smaller than the tolerance treated.

    ``target`` is in mm of ``frame``; ``small_parts`` are those that were treated, in mm of the frame; ``untreated`` is
    the target before. ``curves`` are the loops of ``laying.outline`` where they are known.
    """

    laying: Laying
    laid: Laid
    frame: Frame
    target: Target
    curves: tuple[CurvedLoop, ...]
    small_parts: tuple[SmallPart, ...]
    treatment: str
    tolerance: float
    may_turn: bool
    untreated: Target

    @classmethod
    def of(
        cls,
        laying: Laying,
        curves: Sequence[CurvedLoop],
        tolerance: float,
        treatment: str = "drop",
        *,
        may_turn: bool,
        turn: float = 0.0,
    ) -> Drawing:
        """Return a drawing for outlines that are at most ``tolerance`` mm of the frame off.

        ``treatment`` of small parts: "drop", "keep" or "enlarge". ``turn``: by how many degrees more it is turned.
        """
        laid = laying.lay(turn)
        frame = next(frames(laid))
        untreated = Target.of_frame(frame, curves)
        target, parts = treated(untreated, tolerance, treatment)
        return cls(laying, laid, frame, target, tuple(curves), tuple(parts), treatment, tolerance, may_turn, untreated)

    def within(self, tolerance: float) -> Drawing:
        """Return the drawing for outlines that are at most ``tolerance`` mm of the frame off."""
        target, parts = treated(self.untreated, tolerance, self.treatment)
        return replace(self, target=target, small_parts=tuple(parts), tolerance=tolerance)

    def turned(self, turn: float) -> Drawing:
        """Return the drawing turned by so many degrees more."""
        return type(self).of(
            self.laying, self.curves, self.tolerance, self.treatment, may_turn=self.may_turn, turn=turn
        )

    def chords(self) -> int:
        """Return how many chords of the drawing are within the tolerance of it: about as many as are needed."""
        return simplify(self.target.shape, self.tolerance).shape.corner_count

    def copies(self) -> int:
        """Return into how many parts the drawing's mirror axes divide it: 1, 2, 4, or 6 and more around one point."""
        found = self.symmetry
        if len(found.axes) >= FEWEST_OF_WEDGE and not found.is_round:
            return 2 * len(found.axes)
        if any(_pairs(found.axes)):
            return 4
        return 2 if found.axes or found.others else 1

    @cached_property
    def symmetry(self) -> Symmetry:
        """The symmetry that the drawing has within the tolerance."""
        return symmetry(self.target, self.tolerance)

    def place(self, point: Floats) -> Floats:
        """Return a point of the frame on the sheet, ``(2,)`` mm."""
        place: Floats = self.frame.points(points_array([point]))[0]
        return place

    def on_sheet(self, plan: Plan) -> tuple[Floats, ...]:
        """Return the loops of the drawing where they lie on the sheet if it is folded by a plan, in mm."""
        return self.laying.on_sheet(self.laying.outline.loops, plan.laid)


def plans(drawing: Drawing) -> Iterator[Plan]:
    """Yield plans for a drawing: those with most axes come first."""
    laid, frame, target = drawing.laid, drawing.frame, drawing.target
    found = drawing.symmetry
    sets = [*_pairs(found.axes), *((axis,) for axis in (*found.axes, *found.others))]
    turns: list[tuple[float, tuple[Axis, ...]]] = []
    for axes in sets:
        turn = -math.remainder(axes[0].angle, math.pi / 2)
        turn = 0.0 if abs(turn) < ALIGNED else turn
        if turn == 0.0 or drawing.may_turn:
            turns.append((turn, axes))
    for turn, axes in turns[:MOST_AXES]:
        on = drawing.turned(math.degrees(turn)) if turn else drawing
        plan = _with_axes_in_the_middle(on, len(axes), axes, turned=turn != 0.0)
        if plan is not None:
            yield plan
    yield Plan(laid, frame, target, ())


def _pairs(axes: Sequence[Axis]) -> Iterator[tuple[Axis, Axis]]:
    """Yield pairs of axes at right angles."""
    for k, one in enumerate(axes):
        for other in axes[k + 1 :]:
            if abs(abs(math.remainder(one.angle - other.angle, math.pi)) - math.pi / 2) < SQUARE:
                yield one, other


def _with_axes_in_the_middle(drawing: Drawing, count: int, axes: Sequence[Axis], *, turned: bool) -> Plan | None:
    """Return the plan with the drawing moved so that its axes are in the middle of the frame's sheet.

    None if they are not near it. Where the drawing was turned, its axes are looked for once more.
    """
    frame, target, tolerance = drawing.frame, drawing.target, drawing.tolerance
    if turned:
        again = drawing.symmetry
        level = [one for one in (*again.axes, *again.others) if abs(math.remainder(one.angle, math.pi / 2)) < LEVEL]
        axes = sorted(level, key=lambda axis: axis.off)[:count]
    numbers = tuple(sorted({0 if abs(math.cos(axis.angle)) < 0.5 else 1 for axis in axes}))
    if len(numbers) != count:
        return None
    middle = np.array([frame.sheet.width, frame.sheet.height]) / 2
    step = np.zeros(2)
    for axis in axes:
        number = 0 if abs(math.cos(axis.angle)) < 0.5 else 1
        step[number] = middle[number] - axis.offset / axis.normal[number]
    if np.abs(step).max() > max(2 * tolerance, NEAR_MIDDLE):
        return None
    matrix = np.column_stack([np.eye(2), step])
    return Plan(drawing.laid, frame, target.transformed(matrix), numbers, max(axis.off for axis in axes))


def on_the_sheet(plan: Plan, shape: Shape) -> Laid:
    """Return how a redrawn shape of the frame lies on the sheet that is asked for."""
    return replace(plan.laid, shape=plan.frame.on_sheet(shape))
