"""Outlines made of curves: straight lines, Béziers and elliptical arcs, and how far they are from polygons.

A ``CurvedLoop`` is a closed chain of segments; each ends where the next one begins, and the last where the first does.
Segments are functions of t from 0 to 1. All of them can be moved, turned, scaled, mirrored and sheared without loss,
and be replaced by straight lines within a tolerance.

``farthest_apart`` bounds the Hausdorff distance between curves and polygons from both sides: curves are halved until
the bounds meet, and what cannot be farthest is left out on the way. Nothing is sampled.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from foldcut.core.arrays import Floats, blocks, points_array
from foldcut.geometry.vectors import left_normal

__all__ = ["Arc", "Bezier", "CurvedLoop", "Line", "Segment", "farthest_apart", "is_within"]

PRECISION = 1e-4
"""How much smaller than the Hausdorff distance ``farthest_apart`` may be, in the unit of the points, unless told."""

MOST_STEPS = 1000
"""The greatest number of straight lines that replace a segment."""

ARC_PIECE = math.pi / 10
"""Arcs are measured as cubic Béziers of at most this angle, which are within 2e-8 of their radius."""

FIRST_PIECES = 64
"""Into about how many pieces ``farthest_apart`` divides all curves before it starts."""

MOST_ROUNDS = 60
"""How often pieces are halved at most; far fewer rounds are needed for any drawing."""

ROUND = 1e-6
"""By how much, relative to its radius, the two half axes of an arc of a circle may differ."""

MOST_OF_CUBIC = 2.2
"""A cubic Bézier that turns more than this, in radians, stands for no arc."""

Box = tuple[Floats, Floats]


class Segment(ABC):
    """A line, Bézier or arc: points for t from 0 to 1."""

    @abstractmethod
    def points(self, t: ArrayLike) -> Floats:
        """Return the points, ``(n, 2)``, at the places ``t``, ``(n,)``."""

    @abstractmethod
    def derivatives(self, t: ArrayLike) -> Floats:
        """Return how fast the points move with t, ``(n, 2)``."""

    @abstractmethod
    def transformed(self, matrix: Floats) -> Segment:
        """Return the segment after an affine map ``(2, 3)``: ``matrix[:, :2] @ point + matrix[:, 2]``."""

    @abstractmethod
    def reversed(self) -> Segment:
        """Return the segment drawn the other way."""

    @abstractmethod
    def steps(self, tolerance: float) -> int:
        """Return into how many parts, even in t, it is divided so that chords are within ``tolerance`` of it."""

    @abstractmethod
    def between(self, first: float, last: float) -> Segment:
        """Return the part from t = ``first`` to t = ``last``."""

    @property
    @abstractmethod
    def cubics(self) -> Floats:
        """Control points, ``(k, 4, 2)``, of cubic Béziers that are the segment, or to rounding an arc."""

    @property
    @abstractmethod
    def _turning_places(self) -> Floats:
        """The places, ``(k,)``, where x or y may have an extremum between the ends."""

    @property
    def start(self) -> Floats:
        """The first point, ``(2,)``."""
        start: Floats = self.points([0.0])[0]
        return start

    @property
    def end(self) -> Floats:
        """The last point, ``(2,)``."""
        end: Floats = self.points([1.0])[0]
        return end

    @property
    def box(self) -> Box:
        """The corners of the box around it, lower left and upper right, each ``(2,)``."""
        points = self.points(np.concatenate([np.array([0.0, 1.0]), self._turning_places]))
        return points.min(axis=0), points.max(axis=0)

    def tangents(self, t: ArrayLike) -> Floats:
        """Return unit tangents, ``(n, 2)``; at a place where the points stand still, that of their next move."""
        t = np.asarray(t, dtype=np.float64)
        found = self.derivatives(t)
        length = np.hypot(*found.T)
        still = length <= 1e-9 * max(float(np.ptp(self.cubics.reshape(-1, 2), axis=0).max()), 1e-300)
        if still.any():
            nudge = np.where(t[still] < 0.5, 1.0, -1.0) * 1e-4
            found[still] = self.derivatives(t[still] + nudge)
            length = np.hypot(*found.T)
        found /= np.where(length > 0, length, 1.0)[:, None]
        return found

    def flattened(self, tolerance: float) -> Floats:
        """Return points from the start on, without the end, ``(k, 2)``; chords are within ``tolerance``."""
        steps = self.steps(tolerance)
        return self.points(np.arange(steps) / steps)


@dataclass(frozen=True, eq=False)
class Line(Segment):
    """A straight line between two points, each ``(2,)``."""

    first: Floats
    last: Floats

    def points(self, t: ArrayLike) -> Floats:
        """Return the points at ``t``."""
        share = np.asarray(t, dtype=np.float64)[:, None]
        points: Floats = (1 - share) * self.first + share * self.last
        return points

    def derivatives(self, t: ArrayLike) -> Floats:
        """Return the direction, once for each of ``t``."""
        return np.repeat((np.asarray(self.last) - self.first)[None], np.size(t), axis=0)

    def transformed(self, matrix: Floats) -> Line:
        """Return the line after an affine map."""
        return Line(*_moved(np.array([self.first, self.last]), matrix))

    def reversed(self) -> Line:
        """Return the line drawn the other way."""
        return Line(self.last, self.first)

    def steps(self, tolerance: float) -> int:
        """Return 1."""
        return 1

    def between(self, first: float, last: float) -> Line:
        """Return a part."""
        return Line(*self.points([first, last]))

    @property
    def cubics(self) -> Floats:
        """The line as one cubic Bézier."""
        return _lines_as_cubics(np.array([[self.first, self.last]], dtype=np.float64))

    @property
    def _turning_places(self) -> Floats:
        return np.empty(0)


@dataclass(frozen=True, eq=False)
class Bezier(Segment):
    """A Bézier curve with three control points (quadratic) or four (cubic), ``(3, 2)`` or ``(4, 2)``."""

    control: Floats

    def __post_init__(self) -> None:
        if np.shape(self.control) not in ((3, 2), (4, 2)):
            raise ValueError(f"a Bézier has 3 or 4 control points of 2 numbers, not {np.shape(self.control)}")

    def points(self, t: ArrayLike) -> Floats:
        """Return the points at ``t``."""
        return _bernstein(np.asarray(t, dtype=np.float64), len(self.control) - 1) @ self.control

    def derivatives(self, t: ArrayLike) -> Floats:
        """Return the derivatives at ``t``."""
        degree = len(self.control) - 1
        return _bernstein(np.asarray(t, dtype=np.float64), degree - 1) @ (degree * np.diff(self.control, axis=0))

    def transformed(self, matrix: Floats) -> Bezier:
        """Return the curve after an affine map."""
        return Bezier(_moved(self.control, matrix))

    def reversed(self) -> Bezier:
        """Return the curve drawn the other way."""
        return Bezier(self.control[::-1])

    def steps(self, tolerance: float) -> int:
        """Return the number of chords, from the second differences of the control points (Wang's formula)."""
        degree = len(self.control) - 1
        bend = float(np.hypot(*np.diff(self.control, 2, axis=0).T).max())
        return _whole(math.sqrt(degree * (degree - 1) * bend / (8 * tolerance)) if tolerance > 0 else math.inf)

    def between(self, first: float, last: float) -> Bezier:
        """Return a part."""
        ends = np.array([[first]]), np.array([[last]])
        if len(self.control) == 4:
            return Bezier(_parts_of(self.control[None], *ends).reshape(4, 2))
        middle = _blossom(self.control[None], ends)
        return Bezier(np.concatenate([self.points([first]), middle.reshape(1, 2), self.points([last])]))

    @property
    def cubics(self) -> Floats:
        """The curve as one cubic Bézier."""
        if len(self.control) == 4:
            return np.asarray(self.control, dtype=np.float64)[None]
        first, middle, last = self.control
        return np.array([[first, (first + 2 * middle) / 3, (2 * middle + last) / 3, last]])

    @property
    def _turning_places(self) -> Floats:
        steps = np.diff(self.control, axis=0)
        if len(steps) == 2:
            a, b, c = np.zeros(2), steps[1] - steps[0], steps[0]
        else:
            a, b, c = steps[0] - 2 * steps[1] + steps[2], 2 * (steps[1] - steps[0]), steps[0]
        roots = [np.roots([p, q, r]) for p, q, r in zip(a, b, c, strict=True) if np.isfinite([p, q, r]).all()]
        places = np.concatenate(roots) if roots else np.empty(0)
        real = places.real[np.abs(places.imag) < 1e-9]
        return np.asarray(real[(real > 0) & (real < 1)], dtype=np.float64)


@dataclass(frozen=True, eq=False)
class Arc(Segment):
    """A part of an ellipse: ``centre + first * cos(angle) + second * sin(angle)``, angle from 0 to ``sweep``.

    ``centre``, ``first`` and ``second`` are ``(2,)``: two half diameters, conjugate to each other, of which the first
    leads to the start. ``sweep`` is in radians, from -2 pi to 2 pi.
    """

    centre: Floats
    first: Floats
    second: Floats
    sweep: float

    @classmethod
    def of_circle(cls, centre: ArrayLike, radius: float, start: float = 0.0, sweep: float = math.tau) -> Arc:
        """Return an arc of a circle; ``start`` and ``sweep`` in radians, counter-clockwise."""
        first = radius * np.array([math.cos(start), math.sin(start)])
        return cls(np.asarray(centre, dtype=np.float64), first, left_normal(first), sweep)

    @classmethod
    def of_cubic(cls, control: Floats) -> Arc | None:
        """Return the arc of a circle that a cubic Bézier, ``(4, 2)``, stands for, if programs would draw it so.

        It has the same ends and tangents there, and its middle is on the Bézier; so the two are within 0.00028 of the
        radius for a quarter turn. None for any other Bézier, and for more than about a third of a turn.
        """
        ahead, behind = control[1] - control[0], control[3] - control[2]
        length, other = math.hypot(*ahead), math.hypot(*behind)
        if not length > 0 or abs(length - other) > ROUND * length:
            return None
        sweep = math.atan2(ahead[0] * behind[1] - ahead[1] * behind[0], float(ahead @ behind))
        if not 1e-3 < abs(sweep) < MOST_OF_CUBIC:
            return None
        radius = length / (4 / 3 * math.tan(sweep / 4))  # below 0 for an arc to the right
        centre = control[0] + left_normal(ahead) * (radius / length)
        arc = cls(centre, control[0] - centre, left_normal(control[0] - centre), sweep)
        return arc if np.hypot(*(arc.points([1.0])[0] - control[3])) <= ROUND * abs(radius) else None

    @property
    def radius(self) -> float | None:
        """The radius if this is an arc of a circle, or else None."""
        one, other = math.hypot(*self.first), math.hypot(*self.second)
        alike = abs(one - other) <= ROUND * one and abs(float(self.first @ self.second)) <= ROUND * one * one
        return (one + other) / 2 if alike else None

    def points(self, t: ArrayLike) -> Floats:
        """Return the points at ``t``."""
        angle = self.sweep * np.asarray(t, dtype=np.float64)[:, None]
        points: Floats = self.centre + np.cos(angle) * self.first + np.sin(angle) * self.second
        return points

    def derivatives(self, t: ArrayLike) -> Floats:
        """Return the derivatives at ``t``."""
        angle = self.sweep * np.asarray(t, dtype=np.float64)[:, None]
        found: Floats = self.sweep * (np.cos(angle) * self.second - np.sin(angle) * self.first)
        return found

    def transformed(self, matrix: Floats) -> Arc:
        """Return the arc after an affine map."""
        first, second = np.array([self.first, self.second]) @ matrix[:, :2].T
        return Arc(_moved(self.centre[None], matrix)[0], first, second, self.sweep)

    def reversed(self) -> Arc:
        """Return the arc drawn the other way."""
        return self.between(1.0, 0.0)

    def between(self, first: float, last: float) -> Arc:
        """Return a part."""
        angle = self.sweep * first
        cosine, sine = math.cos(angle), math.sin(angle)
        one, other = cosine * self.first + sine * self.second, cosine * self.second - sine * self.first
        return Arc(self.centre, one, other, self.sweep * (last - first))

    def steps(self, tolerance: float) -> int:
        """Return the number of chords, from the longer half diameter."""
        radius = float(np.linalg.norm(np.array([self.first, self.second]), 2))
        if not 0 < radius < math.inf:
            return 1
        step = 2 * math.acos(max(1 - tolerance / radius, 0.0))
        return _whole(abs(self.sweep) / min(step, math.pi / 2) if step > 0 else math.inf)

    @property
    def cubics(self) -> Floats:
        """The arc as cubic Béziers that touch it at both ends and between them."""
        count = max(math.ceil(abs(self.sweep) / ARC_PIECE), 1)
        step = self.sweep / count
        angle = step * np.arange(count + 1)[:, None]
        ends = self.centre + np.cos(angle) * self.first + np.sin(angle) * self.second
        along = 4 / 3 * math.tan(step / 4) * (np.cos(angle) * self.second - np.sin(angle) * self.first)
        return np.stack([ends[:-1], ends[:-1] + along[:-1], ends[1:] - along[1:], ends[1:]], axis=1)

    @property
    def _turning_places(self) -> Floats:
        angles = np.arctan2(self.second, self.first)[:, None] + math.pi * np.arange(-3, 4)
        places = angles.ravel() / self.sweep if self.sweep else np.empty(0)
        return np.asarray(places[(places > 0) & (places < 1)], dtype=np.float64)


@dataclass(frozen=True, eq=False)
class CurvedLoop:
    """A closed outline; each segment begins where the one before ends.

    Places on it are numbers from 0 to the number of segments: the whole part is the segment, the rest its t.
    """

    segments: tuple[Segment, ...]

    @classmethod
    def of_points(cls, points: Floats) -> CurvedLoop:
        """Return the polygon with the corners ``points``, ``(n, 2)``, as lines."""
        loop = cls(tuple(Line(one, other) for one, other in zip(points, np.roll(points, -1, axis=0), strict=True)))
        loop.__dict__["cubics"] = _lines_as_cubics(np.stack([points, np.roll(points, -1, axis=0)], axis=1))
        return loop

    def __len__(self) -> int:
        return len(self.segments)

    @cached_property
    def is_straight(self) -> bool:
        """Whether all segments are lines."""
        return all(isinstance(segment, Line) for segment in self.segments)

    @cached_property
    def cubics(self) -> Floats:
        """Control points, ``(k, 4, 2)``, of cubic Béziers that are the loop, but for rounding."""
        return np.concatenate([segment.cubics for segment in self.segments])

    @property
    def box(self) -> Box:
        """The corners of the box around the loop, lower left and upper right, each ``(2,)``."""
        boxes = np.array([segment.box for segment in self.segments])
        return boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)

    def points(self, places: ArrayLike) -> Floats:
        """Return the points, ``(n, 2)``, at ``places``, ``(n,)``."""
        return self._at(places, "points")

    def tangents(self, places: ArrayLike) -> Floats:
        """Return unit tangents, ``(n, 2)``, at ``places``; where segments meet, that of the later one."""
        return self._at(places, "tangents")

    def _at(self, places: ArrayLike, what: str) -> Floats:
        places = np.asarray(places, dtype=np.float64) % len(self.segments)
        number = np.minimum(places.astype(np.intp), len(self.segments) - 1)
        found = np.empty((len(places), 2))
        for one in np.unique(number).tolist():
            these = number == one
            found[these] = getattr(self.segments[one], what)(places[these] - one)
        return found

    def part(self, first: float, last: float) -> list[Segment]:
        """Return the segments from one place to another, backward if ``last`` is less; either may be on any round."""
        if last < first:
            return [segment.reversed() for segment in self.part(last, first)[::-1]]
        found: list[Segment] = []
        for number in range(math.floor(first), math.ceil(last)):
            segment = self.segments[number % len(self.segments)]
            start, end = max(first - number, 0.0), min(last - number, 1.0)
            if end > start:
                found.append(segment if (start, end) == (0.0, 1.0) else segment.between(start, end))
        return found

    @cached_property
    def turns(self) -> Floats:
        """By how much the tangent turns at the start of each segment, in radians, to the left above 0, ``(n,)``."""
        ahead = np.array([segment.tangents([0.0])[0] for segment in self.segments]) @ (1, 1j)
        behind = np.array([segment.tangents([1.0])[0] for segment in self.segments]) @ (1, 1j)
        return np.asarray(np.angle(ahead * np.roll(behind, 1).conj()), dtype=np.float64)

    def transformed(self, matrix: Floats) -> CurvedLoop:
        """Return the loop after an affine map ``(2, 3)``; a map that mirrors changes the direction around it."""
        return CurvedLoop(tuple(segment.transformed(matrix) for segment in self.segments))

    def reversed(self) -> CurvedLoop:
        """Return the loop drawn the other way around."""
        return CurvedLoop(tuple(segment.reversed() for segment in self.segments[::-1]))

    def flattened(self, tolerance: float) -> Floats:
        """Return a polygon, ``(n, 2)``, whose sides are within ``tolerance`` of the loop; joints are corners of it."""
        return self.flattened_at(tolerance)[0]

    def flattened_at(self, tolerance: float) -> tuple[Floats, Floats]:
        """Return ``flattened`` and the place of each of its corners, ``(n,)``."""
        parts = [segment.flattened(tolerance) for segment in self.segments]
        places = [number + np.arange(len(part)) / len(part) for number, part in enumerate(parts)]
        return points_array(np.concatenate(parts)), np.concatenate(places)


def farthest_apart(
    loops: Sequence[CurvedLoop], polygons: Sequence[Floats], precision: float = PRECISION
) -> tuple[float, Floats]:
    """Return the Hausdorff distance between curves and the sides of polygons, and a place, ``(2,)``, where it is.

    It is that of the sets: of all curves together from all sides of the polygons, ``(n, 2)`` each, together, and of the
    sides from the curves. The distance returned is at most ``precision`` smaller than it, and never larger. Raises
    ``ValueError`` if either set is empty.
    """
    if not loops or not polygons:
        raise ValueError("there is no distance from nothing")
    curves = np.concatenate([loop.cubics for loop in loops])
    sides = np.concatenate([np.stack([one, np.roll(one, -1, axis=0)], axis=1) for one in polygons])
    lines = _lines_as_cubics(sides)
    there, place = _farthest(curves, lines, precision, 0.0)
    back, other = _farthest(lines, curves, precision, there)
    return (back, other) if back > there else (there, place)


def is_within(
    loops: Sequence[CurvedLoop], polygons: Sequence[Floats], distance: float, precision: float = PRECISION
) -> bool:
    """Tell whether the Hausdorff distance between curves and the sides of polygons is at most ``distance``.

    If it is less by no more than ``precision``, the answer may be no. This takes less time than to find the distance.
    """
    curves = np.concatenate([loop.cubics for loop in loops])
    sides = np.concatenate([np.stack([one, np.roll(one, -1, axis=0)], axis=1) for one in polygons])
    lines = _lines_as_cubics(sides)
    if distance <= precision:
        return farthest_apart(loops, polygons, precision / 2)[0] <= distance - precision / 2
    least = distance - precision
    return all(
        _farthest(one, other, precision, least, least)[0] <= least for one, other in ((lines, curves), (curves, lines))
    )


def _farthest(
    from_: Floats, to: Floats, precision: float, least: float, enough: float = math.inf
) -> tuple[float, Floats]:
    """Return how far the farthest point of the cubics ``from_`` is from the cubics ``to``, and that point.

    What is not farther than ``least`` need not be found; what is farther than ``enough`` ends the search. Every piece
    of a curve is taken for its chord, with the error that this makes: so a distance is one between a point and a line,
    with bounds.
    """
    lengths = _chord_lengths(from_)
    piece = max(float(lengths.sum()), precision) / FIRST_PIECES
    far = _divided(from_, np.ceil(lengths / piece))
    near = _divided(to, np.ceil(np.sqrt(_off_chord(to) / max(piece / 50, precision))))
    best, place = least, far[0, 0]
    for _ in range(MOST_ROUNDS):
        far_off, near_off = _off_chord(far), _off_chord(near)
        middle = (far[:, 0] + far[:, 3]) / 2
        half = _chord_lengths(far) / 2
        low, high = np.empty(len(far)), np.empty(len(far))
        relevant = np.zeros(len(near), dtype=np.bool_)
        for some in blocks(len(far), max(1_000_000 // len(near), 1)):
            between = _distances(middle[some], near)
            low[some] = (between - near_off).min(axis=1) - far_off[some]
            nearest = (between + near_off).argmin(axis=1)
            ends = [_distances_in_rows(far[some, end], near[nearest]) for end in (0, 3)]
            high[some] = np.maximum(*ends) + near_off[nearest] + far_off[some]
            best_here = int(low[some].argmax())
            if low[some][best_here] > best:
                best, place = float(low[some][best_here]), middle[some][best_here]
            active = high[some] > best + precision
            reach = (high[some] + half[some] + far_off[some])[active]
            relevant |= (between[active] - near_off <= reach[:, None]).any(axis=0)
        active = high > best + precision
        if best > enough or not active.any():
            break
        near, near_off = near[relevant], near_off[relevant]
        wanted = max(precision, float(high.max()) - best) / 8
        near = _divided(near, np.ceil(np.sqrt(near_off / wanted)))
        far = _divided(far[active], np.full(int(active.sum()), 4.0 if active.sum() < FIRST_PIECES else 2.0))
    return best, place


def _lines_as_cubics(lines: Floats) -> Floats:
    """Return lines, ``(n, 2, 2)``, as cubic Béziers, ``(n, 4, 2)``."""
    first, last = lines[:, 0], lines[:, 1]
    return np.stack([first, (2 * first + last) / 3, (first + 2 * last) / 3, last], axis=1)


def _off_chord(cubics: Floats) -> Floats:
    """Return bounds on how far each cubic is from its chord at equal t, ``(n,)``."""
    one = cubics[:, 1] - (2 * cubics[:, 0] + cubics[:, 3]) / 3
    other = cubics[:, 2] - (cubics[:, 0] + 2 * cubics[:, 3]) / 3
    return np.asarray(0.75 * np.maximum(np.hypot(*one.T), np.hypot(*other.T)), dtype=np.float64)


def _chord_lengths(cubics: Floats) -> Floats:
    return np.asarray(np.hypot(*(cubics[:, 3] - cubics[:, 0]).T), dtype=np.float64)


def _divided(cubics: Floats, counts: Floats) -> Floats:
    """Return each cubic in ``counts[i]`` parts, even in t; at least one."""
    number = np.maximum(counts, 1).astype(np.intp)
    if (number == 1).all():
        return cubics
    share = np.repeat(1 / number, number)[:, None]
    first = (np.arange(number.sum()) - np.repeat(np.cumsum(number) - number, number))[:, None] * share
    return _parts_of(np.repeat(cubics, number, axis=0), first, first + share)


def _parts_of(cubics: Floats, first: Floats, last: Floats) -> Floats:
    """Return the parts between t = ``first`` and ``last``, both ``(n, 1)``."""
    wanted = (first, first, first), (first, first, last), (first, last, last), (last, last, last)
    return np.stack([_blossom(cubics, places) for places in wanted], axis=1)


def _blossom(controls: Floats, places: Sequence[Floats]) -> Floats:
    """Return de Casteljau's point with another t, ``(n, 1)``, in each round: ``(n, 2)``."""
    for t in places:
        controls = (1 - t[:, None]) * controls[:, :-1] + t[:, None] * controls[:, 1:]
    point: Floats = controls[:, 0]
    return point


def _distances(points: Floats, cubics: Floats) -> Floats:
    """Return the distance of every point, ``(n, 2)``, from every chord: ``(n, m)``."""
    (x, y), (to_x, to_y) = cubics[:, 0].T, (cubics[:, 3] - cubics[:, 0]).T
    away_x, away_y = points[:, :1] - x, points[:, 1:] - y
    share = away_x * to_x
    share += away_y * to_y
    share /= np.maximum(to_x**2 + to_y**2, 1e-300)
    np.clip(share, 0.0, 1.0, out=share)
    away_x -= share * to_x
    away_y -= share * to_y
    return np.asarray(np.sqrt(away_x * away_x + away_y * away_y), dtype=np.float64)


def _distances_in_rows(points: Floats, cubics: Floats) -> Floats:
    """Return the distance of each point from the chord in the same row, ``(n,)``."""
    along, away = cubics[:, 3] - cubics[:, 0], points - cubics[:, 0]
    share = (along * away).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-300)
    return np.asarray(np.hypot(*(away - share.clip(0.0, 1.0)[:, None] * along).T), dtype=np.float64)


def _bernstein(t: Floats, degree: int) -> Floats:
    """Return the Bernstein polynomials at ``t``, ``(n, degree + 1)``."""
    powers = np.arange(degree + 1)
    counts = np.array([math.comb(degree, k) for k in range(degree + 1)])
    return np.asarray(counts * t[:, None] ** powers * (1 - t[:, None]) ** (degree - powers), dtype=np.float64)


def _moved(points: Floats, matrix: Floats) -> Floats:
    moved: Floats = np.asarray(points, dtype=np.float64) @ matrix[:, :2].T + matrix[:, 2]
    return moved


def _whole(count: float) -> int:
    """Return a number of steps, from 1 to ``MOST_STEPS``."""
    return max(math.ceil(round(min(count, MOST_STEPS), 6)), 1) if count == count else 1
