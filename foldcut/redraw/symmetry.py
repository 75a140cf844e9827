"""Mirror axes of a drawing, and turns about its middle, exact or within a tolerance.

``Target`` and tolerance -> ``Symmetry``. A drawing is symmetric if it is nowhere farther than half of the tolerance
from its image: so there is an outline within the tolerance that is exactly symmetric.

Directions are tried on a map of distances from the outline. Those that may do are improved by least squares, until the
image lies on the outline as well as it can, and are then measured. Axes need not be upright or level, and need not go
through any middle that is known beforehand.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import shapely

from foldcut.core.arrays import Floats, points_array
from foldcut.redraw.target import Target

__all__ = ["Axis", "Symmetry", "symmetries", "symmetry"]

MOST_TURNS = 12
"""The greatest order of symmetry that is looked for."""

DIRECTIONS = 360
"""The number of directions of axes that are tried."""

CELLS = 320
"""The map of distances has about this many cells along its longer side."""

MOST_CANDIDATES = 36
"""Of so many directions at most the axis is improved and measured."""

ROUNDING = 1e-9
"""Directions that are turned to within this of upright or level, in radians, are so."""

EXACT_MM = 1e-3
"""Images that are off by less than this are exact but for rounding, in mm of the frame."""

FLAT_MM = 2e-3
"""How far the polygons that images are compared with may be from the curves, in mm of the frame."""

SNAP = math.radians(0.3)
"""An axis that is nearer than this to a multiple of 15 degrees is made one if it is hardly worse for it."""

SAME = math.radians(2)
"""Axes whose directions differ by less than this are the same."""

MOST_ROUNDS = 12
"""How often an axis or a centre is improved at most."""

BORDERLINE = 2.0
"""Axes that are off by up to this many times what is allowed after least squares are improved further."""


@dataclass(frozen=True)
class Axis:
    """A mirror axis: the points x with ``normal @ x = offset``, where the normal is the direction turned left.

    ``angle`` is the direction in radians, from 0 to below pi; ``offset`` is in mm; ``off``: the Hausdorff distance of
    the outline from its image, in mm.
    """

    angle: float
    offset: float
    off: float

    @property
    def normal(self) -> Floats:
        """The unit normal, ``(2,)``."""
        return _normal(self.angle)

    def transformed(self, matrix: Floats) -> Axis:
        """Return the axis after a similarity ``(2, 3)`` that moves and turns it."""
        along = matrix[:, :2] @ (math.cos(self.angle), math.sin(self.angle))
        angle = math.atan2(along[1], along[0])
        nearest = round(angle / (math.pi / 2)) * math.pi / 2
        angle = nearest if abs(angle - nearest) < ROUNDING else angle
        through = matrix[:, :2] @ (self.normal * self.offset) + matrix[:, 2]
        return _axis(angle, float(_normal(angle) @ through), self.off * float(np.hypot(*along)))

    def image(self, points: Floats) -> Floats:
        """Return the mirror images of points, ``(n, 2)``."""
        return _image(points, self.angle, self.offset)


@dataclass(frozen=True, eq=False)
class Symmetry:
    """The symmetry of a drawing, all about one point, ``centre`` ``(2,)`` in mm.

    ``axes``: the mirror axes through the centre, evenly spaced if there are several. ``order``: how many turns about
    the centre, by equal angles, bring the drawing onto itself; 1 if only the whole turn does. With two axes or more it
    is their number. ``off``: the largest Hausdorff distance of the outline from any of these images, in mm. ``others``:
    mirror axes that go together with none of ``axes``; each might be taken alone. ``is_round``: any line through the
    centre is an axis, and ``axes`` are only some of them.
    """

    centre: Floats
    axes: tuple[Axis, ...] = ()
    order: int = 1
    off: float = 0.0
    others: tuple[Axis, ...] = ()
    is_round: bool = False

    def transformed(self, matrix: Floats) -> Symmetry:
        """Return the symmetry after a similarity ``(2, 3)`` that moves and turns the drawing."""
        centre = points_array(matrix[:, :2] @ self.centre + matrix[:, 2])[0]
        axes = tuple(sorted((axis.transformed(matrix) for axis in self.axes), key=lambda axis: axis.angle))
        others = tuple(axis.transformed(matrix) for axis in self.others)
        return Symmetry(centre, axes, self.order, self.off * float(np.hypot(*matrix[:, 0])), others, self.is_round)

    @property
    def angles(self) -> tuple[float, ...]:
        """The directions of the axes, in radians."""
        return tuple(axis.angle for axis in self.axes)


def symmetry(target: Target, tolerance: float) -> Symmetry:
    """Return the symmetry that a drawing has within ``tolerance``, in mm of the frame."""
    return symmetries(target, [tolerance])[0]


def symmetries(target: Target, tolerances: Sequence[float]) -> list[Symmetry]:
    """Return the symmetry that a drawing has within each of some tolerances, in mm of the frame."""
    outline = _outline_of(target)
    return [_symmetry(outline, max(tolerance / 2, EXACT_MM)) for tolerance in tolerances]


@lru_cache(maxsize=2)
def _outline_of(target: Target) -> _Outline:
    """Return the outline of a target: one and the same target is asked for with several tolerances."""
    return _Outline(target)


def _symmetry(outline: _Outline, allowed: float) -> Symmetry:
    """Return the symmetry of an outline whose images may be off by as much as ``allowed`` mm."""
    found: list[Axis] = []
    for angle in outline.directions(allowed):
        if not any(_apart(angle, axis.angle) < SAME / 2 for axis in found):
            axis = outline.improved(angle, allowed)
            if axis is not None and not any(_apart(axis.angle, one.angle) < SAME for one in found):
                found.append(axis)
    found.sort(key=_preference)
    if len(found) >= MOST_TURNS:  # it is round, perhaps
        for middle in (outline.box_middle, outline.middle):
            axes = tuple(outline.axis(math.pi * number / MOST_TURNS, middle) for number in range(MOST_TURNS))
            if (off := max(axis.off for axis in axes)) <= allowed:
                between = outline.axis(math.pi / (2 * MOST_TURNS), middle)
                return Symmetry(points_array(middle)[0], axes, MOST_TURNS, off, is_round=between.off <= allowed)
    for count in range(min(len(found), MOST_TURNS), 1, -1):
        if (several := _together(outline, found, count, allowed)) is not None:
            return several
    if found:
        best, *others = found
        middle = best.image(outline.middle[None])[0]
        return Symmetry(points_array((middle + outline.middle) / 2)[0], (best,), 1, best.off, tuple(others))
    for order in range(MOST_TURNS, 1, -1):
        if (turned := outline.turned(order, allowed)) is not None:
            return Symmetry(turned[0], (), order, turned[1])
    return Symmetry(points_array(outline.middle)[0])


def _preference(axis: Axis) -> tuple[bool, int, float]:
    """Order axes: exact ones first, of these and of the others upright ones, level ones, then those with less off."""
    upright = 0 if abs(axis.angle - math.pi / 2) < 1e-9 else 1 if axis.angle < 1e-9 else 2
    return axis.off > EXACT_MM, upright, axis.off


def _together(outline: _Outline, found: Sequence[Axis], count: int, allowed: float) -> Symmetry | None:
    """Return the symmetry with ``count`` evenly spaced axes that are among those found, if there is one."""
    for first in found:
        places = [first.angle + math.pi * number / count for number in range(count)]
        nearest = [min(found, key=lambda axis: _apart(axis.angle, place)) for place in places]
        if max(_apart(axis.angle, place) for axis, place in zip(nearest, places, strict=True)) > SAME:
            continue
        turns = [math.remainder(axis.angle - place, math.pi) for axis, place in zip(nearest, places, strict=True)]
        start = first.angle + sum(turns) / count
        normals = np.array([axis.normal for axis in nearest])
        centre = np.linalg.lstsq(normals, np.array([axis.offset for axis in nearest]), rcond=None)[0]
        for at in _snapped(start, math.pi / count):
            for middle in (outline.box_middle, centre):
                axes = [outline.axis((at + math.pi * number / count) % math.pi, middle) for number in range(count)]
                off = max(axis.off for axis in axes)
                least = max(axis.off for axis in nearest)
                if off <= _hardly_worse(least, allowed) or (at == start and middle is centre):
                    break
            else:
                continue
            break
        if off <= allowed:
            axes.sort(key=lambda axis: axis.angle)
            others = [one for one in found if all(_apart(one.angle, axis.angle) > SAME for axis in axes)]
            return Symmetry(points_array(middle)[0], tuple(axes), count, off, tuple(others))
    return None


def _snapped(angle: float, period: float) -> list[float]:
    """Return an angle that is upright or level, or another multiple of 15 degrees, if near; then the angle itself."""
    for step in (math.pi / 2, math.pi / 12):
        near = round(angle / step) * step
        if abs(angle - near) < SNAP:
            return [near, angle]
        if step < period or period == math.pi:
            continue
        steps = round((math.pi / 2 - angle) / period)  # one of several axes may be upright
        if abs(math.pi / 2 - angle - steps * period) < SNAP:
            return [math.pi / 2 - steps * period, angle]
    return [angle]


def _hardly_worse(off: float, allowed: float) -> float:
    """Return how far images may be off about an axis that is nicer than the best one."""
    return allowed if off > 5 * FLAT_MM else min(allowed, off + 2 * FLAT_MM)


def _apart(one: float, other: float) -> float:
    """Return the angle between two directions."""
    return abs(math.remainder(one - other, math.pi))


def _normal(angle: float) -> Floats:
    quarters = round(angle / (math.pi / 2))
    if abs(angle - quarters * math.pi / 2) < 1e-12:  # upright and level exactly
        return np.array([(0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (1.0, 0.0)][quarters % 4])
    return np.array([-math.sin(angle), math.cos(angle)])


def _image(points: Floats, angle: float, offset: float) -> Floats:
    normal = _normal(angle)
    image: Floats = points - 2 * (points @ normal - offset)[:, None] * normal
    return image


class _Outline:
    """The outline of a target, and how far points are from it."""

    def __init__(self, target: Target) -> None:
        loops = [curve.flattened(FLAT_MM) for curve in target.curves]
        self.starts = np.concatenate(loops)
        self.ends = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])
        self.tree = shapely.STRtree(shapely.linestrings(np.stack([self.starts, self.ends], axis=1)))
        self.middle = np.array(shapely.centroid(target.area).coords[0])
        self.box_middle = (self.starts.min(axis=0) + self.starts.max(axis=0)) / 2
        length = float(np.hypot(*(self.ends - self.starts).T).sum())
        corners = [loop[at] for loop, at in zip(target.loops, target.true_corners, strict=True)]
        self.few = np.concatenate([*(one.points for one in target.samples(length / 250)), *corners])
        self.many = np.concatenate([*target.loops, *(one.points for one in target.samples(max(length / 1500, 0.5)))])

    def nearest(self, points: Floats) -> tuple[Floats, Floats]:
        """Return the nearest point of the outline to each point and the unit normal there, toward the point or not."""
        side = np.asarray(self.tree.nearest(shapely.points(points)), dtype=np.intp)
        along = self.ends[side] - self.starts[side]
        square = np.maximum((along**2).sum(axis=1), 1e-300)
        share = (((points - self.starts[side]) * along).sum(axis=1) / square).clip(0.0, 1.0)
        foot = self.starts[side] + share[:, None] * along
        away = points - foot
        distance = np.hypot(*away.T)
        normal = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.sqrt(square)[:, None]
        beyond = ((share == 0) | (share == 1)) & (distance > 1e-9)
        normal[beyond] = away[beyond] / distance[beyond, None]
        return foot, normal

    def off(self, images: Floats) -> float:
        """Return how far the farthest of some points is from the outline."""
        foot, _ = self.nearest(images)
        return float(np.hypot(*(images - foot).T).max())

    def axis(self, angle: float, through: Floats) -> Axis:
        """Return the axis in a direction through a point, measured."""
        offset = float(_normal(angle) @ through)
        return Axis(angle, offset, self.off(_image(self.many, angle, offset)))

    def directions(self, allowed: float) -> list[float]:
        """Return the directions of axes that may do, the best first."""
        step = math.pi / DIRECTIONS
        reach = float(np.hypot(*(self.few - self.middle).T).max())
        slack = 2 * allowed + reach * step + 1.5 * self.map[2]
        angles = 2 * step * np.arange(DIRECTIONS)
        cosine, sine = np.cos(angles)[:, None], np.sin(angles)[:, None]
        scores = np.full(DIRECTIONS, np.inf)
        for middle in (self.middle, self.box_middle):
            x, y = (self.few - middle).T
            images = np.stack([cosine * x + sine * y, sine * x - cosine * y], axis=-1) + middle
            away = self._on_map(images)
            may = away.max(axis=1) <= slack
            scores[may] = np.minimum(scores[may], away[may].mean(axis=1))
        least = (scores <= np.roll(scores, 1)) & (scores <= np.roll(scores, -1)) & np.isfinite(scores)
        order = np.flatnonzero(least)
        order = order[np.argsort(scores[order], kind="stable")]
        multiples = [one for one in order.tolist() if one % (DIRECTIONS // 12) == 0]
        best = [*multiples, *(one for one in order.tolist() if one % (DIRECTIONS // 12))][:MOST_CANDIDATES]
        return [one * step for one in best]

    def _on_map(self, points: Floats) -> Floats:
        """Return how far points, ``(..., 2)``, are from the outline, to about a cell of the map."""
        distance, low, cell = self.map
        at = ((points - low) / cell).astype(np.intp).clip(0, CELLS - 1)
        return np.asarray(distance[at[..., 0], at[..., 1]], dtype=np.float64)

    @cached_property
    def map(self) -> tuple[Floats, Floats, float]:
        """Return the distance from the outline in each cell of a grid, the grid's lower left corner, and its step."""
        from scipy.ndimage import distance_transform_edt

        reach = 1.2 * float(np.hypot(*(self.starts - self.middle).T).max())
        cell = 2 * reach / CELLS
        low = self.middle - reach
        lengths = np.hypot(*(self.ends - self.starts).T)
        counts = np.ceil(lengths / cell).astype(np.intp) + 1
        share = np.concatenate([np.linspace(0, 1, count) for count in counts])[:, None]
        points = np.repeat(self.starts, counts, axis=0) + share * np.repeat(self.ends - self.starts, counts, axis=0)
        empty = np.ones((CELLS, CELLS), dtype=np.bool_)
        at = np.clip(((points - low) / cell).astype(np.intp), 0, CELLS - 1)
        empty[at[:, 0], at[:, 1]] = False
        return np.asarray(distance_transform_edt(empty), dtype=np.float64) * cell, low, cell

    def improved(self, angle: float, allowed: float) -> Axis | None:
        """Return the best axis near a direction, or None if it is not good enough."""
        shift = 0.0
        for count in range(MOST_ROUNDS):
            matrix, residual = self._moves(angle, shift)
            if count == 3 and np.abs(residual).max() > 2 * BORDERLINE * allowed:
                return None
            turn, further = np.linalg.lstsq(matrix, -residual, rcond=None)[0].tolist()
            angle, shift = angle + min(max(turn, -0.02), 0.02), shift + further
            if abs(turn) < 1e-13 and abs(further) < 1e-11:
                break
        off = self._axis_off(angle, shift)
        if allowed < off <= BORDERLINE * allowed:
            for _ in range(3):
                turn, further = _least_at_worst(*self._moves(angle, shift))
                angle, shift = angle + turn, shift + further
            off = self._axis_off(angle, shift)
        if off > allowed:
            return None
        for nicer in _snapped(angle, math.pi):
            to_box = float(_normal(nicer) @ (self.box_middle - self.middle))
            for at in (to_box, shift):
                snapped = self._axis_off(nicer, at)
                if snapped <= _hardly_worse(off, allowed):
                    return _axis(nicer, float(_normal(nicer) @ self.middle) + at, snapped)
        return _axis(angle, float(_normal(angle) @ self.middle) + shift, off)

    def _axis_off(self, angle: float, shift: float) -> float:
        """Return how far the image is off about the axis in a direction that passes the middle at a distance."""
        return self.off(_image(self.many, angle, float(_normal(angle) @ self.middle) + shift))

    def _moves(self, angle: float, shift: float) -> tuple[Floats, Floats]:
        """Return how far images are off, ``(n,)``, and how they move off with the angle and the shift, ``(n, 2)``."""
        normal, along = _normal(angle), np.array([math.cos(angle), math.sin(angle)])
        from_middle = self.few - self.middle
        away = from_middle @ normal - shift
        images = self.few - 2 * away[:, None] * normal
        foot, across = self.nearest(images)
        turning = 2 * (from_middle @ along)[:, None] * normal + 2 * away[:, None] * along
        matrix = np.stack([(across * turning).sum(axis=1), 2 * across @ normal], axis=1)
        return matrix, (across * (images - foot)).sum(axis=1)

    def turned(self, order: int, allowed: float) -> tuple[Floats, float] | None:
        """Return the centre about which equal turns bring the outline onto itself, and how far off they are."""
        angle = math.tau / order
        cosine, sine = math.cos(angle), math.sin(angle)
        turn = np.array([(cosine, -sine), (sine, cosine)])
        centre = self.middle
        still = np.eye(2) - turn
        if self._on_map((self.few - centre) @ turn.T + centre).max() > 4 * allowed + 1.5 * self.map[2]:
            return None
        for _ in range(MOST_ROUNDS):
            images = (self.few - centre) @ turn.T + centre
            foot, across = self.nearest(images)
            residual = (across * (images - foot)).sum(axis=1)
            step = np.linalg.lstsq(across @ still, -residual, rcond=None)[0]
            centre = centre + step
            if np.abs(step).max() < 1e-11:
                break
        best: tuple[Floats, float] | None = None
        for middle in (self.box_middle, centre):
            images = [
                (self.many - middle) @ np.linalg.matrix_power(turn, k).T + middle for k in range(1, order // 2 + 1)
            ]
            off = max(self.off(one) for one in images)
            if off <= allowed and (best is None or off < best[1] - 2 * FLAT_MM):
                best = points_array(middle)[0], off
        return best


def _least_at_worst(matrix: Floats, residual: Floats) -> tuple[float, float]:
    """Return x for which the greatest of ``abs(matrix @ x + residual)`` is least, nearly (Lawson's algorithm)."""
    weights = np.full(len(residual), 1 / len(residual))
    best, least = np.zeros(2), float(np.abs(residual).max())
    for _ in range(40):
        weighted = matrix * weights[:, None]
        try:
            x = np.linalg.solve(weighted.T @ matrix, -weighted.T @ residual)
        except np.linalg.LinAlgError:
            break
        off = np.abs(matrix @ x + residual)
        if off.max() < least:
            best, least = x, float(off.max())
        weights *= off
        weights /= weights.sum()
    return float(best[0]), float(best[1])


def _axis(angle: float, offset: float, off: float) -> Axis:
    """Return an axis with its direction from 0 to below pi."""
    turns = math.floor(angle / math.pi + 1e-12)
    angle -= turns * math.pi
    return Axis(max(angle, 0.0), -offset if turns % 2 else offset, off)
