"""Circles, arcs and strips in a drawing.

``Target`` -> ``Round``s, pieces of the outline that are arcs of circles, and ``Strip``s, pairs of pieces that run side
by side at one distance: letters and strokes are made of them.

Strips are found from discs: the largest disc that touches the outline at a point, on one side of it, touches it
somewhere else, too. Where the disc's radius hardly changes and the two tangents are opposite, there is a strip.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from foldcut.core.arrays import Bools, Floats, Indices, points_array
from foldcut.geometry.vectors import cross, left_normal
from foldcut.redraw.target import Samples, Target

__all__ = ["Piece", "Round", "Strip", "concentric", "rounds", "strips"]

MOST_SAMPLES = 800
"""The number of points of all loops together that discs are made for, about."""

NEIGHBOURS = 2
"""Discs may reach beyond so many of the next points along the outline on either side."""

OPPOSITE = math.cos(math.radians(25))
"""Two sides run side by side where their tangents are opposite but for less than this angle, as its cosine."""

ROUND_MM = 0.03
"""How far points may be from the circle that they are taken to lie on, in mm of the frame."""

CHORD_MM = 0.1
"""How far the middle of a straight side may be from a circle that the side is a chord of, in mm of the frame."""

LEAST_SWEEP = math.radians(60)
"""Arcs of a smaller angle are not recognised."""

LEAST_POINTS = 5
"""The least number of corners of a polygon on an arc."""


@dataclass(frozen=True)
class Piece:
    """A part of a loop of a target, counter-clockwise from ``first`` to ``last``, in mm along the dense loop.

    ``last`` is more than ``first``, and beyond the length of the loop if the piece goes over its start. ``whole``: it
    is all of the loop.
    """

    loop: int
    first: float
    last: float
    whole: bool = False


@dataclass(frozen=True, eq=False)
class Round:
    """A piece that is an arc of a circle: ``centre`` ``(2,)`` and ``radius`` in mm.

    ``sweep`` is in radians, above 0 where the piece goes counter-clockwise around the centre.
    """

    piece: Piece
    centre: Floats
    radius: float
    sweep: float


@dataclass(frozen=True, eq=False)
class Strip:
    """Two pieces of the outline that run side by side at one distance.

    ``line`` ``(n, 2)`` is the centre line, and ``left`` and ``right`` ``(n, 2)`` are the points on both sides that
    belong to its points. ``half_width`` is half of the distance, and ``off`` by how much it varies at most; both in mm.
    ``pieces`` are the left and the right side, as they lie when one goes along the centre line; the loops run along one
    of them and against the other unless they are an outline and its hole. ``inside``: the strip is a part of the shape;
    else it is a gap. ``closed``: it is a ring.
    """

    line: Floats
    left: Floats
    right: Floats
    half_width: float
    off: float
    pieces: tuple[Piece, Piece]
    inside: bool
    closed: bool

    @property
    def length(self) -> float:
        """The length of the centre line, in mm."""
        return _length(self.line, closed=self.closed)


def strips(target: Target, tolerance: float, *, inside: bool = True) -> list[Strip]:
    """Return the strips whose half width varies by at most half of ``tolerance`` mm to both sides, the longest first.

    They are at least as long as wide. ``inside``: those of the shape; else the gaps.
    """
    discs = _Discs.of(target, inside=inside)
    taken = np.zeros(len(discs.radius), dtype=np.bool_)
    found = []
    windows = [window for run in discs.runs() for window in _windows(discs.radius[run], run, tolerance)]
    for window in sorted(windows, key=len, reverse=True):
        left = window[~taken[window]]
        if len(left) < 0.75 * len(window) or len(left) < 3:
            continue
        strip = discs.strip(left, inside=inside)
        if strip.length < 2 * strip.half_width:
            continue
        taken[left] = True
        taken[discs.between(discs.partner[left])] = True
        found.append(strip)
    return sorted(found, key=lambda strip: -strip.length)


@dataclass(frozen=True, eq=False)
class _Discs:
    """Of each sample the largest disc that touches the outline there: its radius, and the other sample it touches.

    ``first`` is the number of the first sample of each loop, and one past the last. ``towards`` are unit vectors to the
    centres.
    """

    samples: tuple[Samples, ...]
    points: Floats
    towards: Floats
    first: Indices
    radius: Floats
    partner: Indices
    opposite: Bools

    @classmethod
    def of(cls, target: Target, *, inside: bool) -> _Discs:
        total = sum(float(np.hypot(*(np.roll(loop, -1, axis=0) - loop).T).sum()) for loop in target.loops)
        samples = target.samples(max(total / MOST_SAMPLES, 0.25))
        points = np.concatenate([one.points for one in samples])
        tangents = np.concatenate([one.tangents for one in samples])
        corner = np.concatenate([one.corner for one in samples])
        is_hole = [target.shape.depth(number) % 2 == 1 for number in range(len(samples))]
        side = np.repeat([1.0 if hole != inside else -1.0 for hole in is_hole], [len(one.points) for one in samples])
        towards = side[:, None] * left_normal(tangents)
        first = np.cumsum([0, *(len(one.points) for one in samples)])
        counts = np.diff(first)
        own = np.arange(len(points)) - np.repeat(first[:-1], counts)
        beside = (own[:, None] + np.arange(-NEIGHBOURS, NEIGHBOURS + 1)) % np.repeat(counts, counts)[:, None]
        beside += np.repeat(first[:-1], counts)[:, None]
        radius, partner = np.full(len(points), np.inf), np.zeros(len(points), dtype=np.intp)
        for start in range(0, len(points), 256):
            some = slice(start, start + 256)
            across, up = points[:, 0] - points[some, :1], points[:, 1] - points[some, 1:]
            square = across * across + up * up
            height = 2 * (across * towards[some, :1] + up * towards[some, 1:])
            size = np.full(square.shape, np.inf)
            np.divide(square, height, out=size, where=height > 1e-10 * square + 1e-12)
            size[np.arange(len(size))[:, None], beside[some]] = np.inf  # chords of flattened curves turn all at once
            partner[some] = size.argmin(axis=1)
            radius[some] = size.min(axis=1)
        opposite = ((tangents * tangents[partner]).sum(axis=1) < -OPPOSITE) & np.isfinite(radius) & ~corner
        same_way = ((tangents * tangents[partner]).sum(axis=1) > OPPOSITE) & np.isfinite(radius) & ~corner
        other = side != side[partner]  # the sides of a ring run the same way around
        return cls(samples, points, towards, first, radius, partner, np.where(other, same_way, opposite))

    def loop_of(self, sample: int) -> int:
        """Return the loop that a sample is on."""
        return int(np.searchsorted(self.first, sample, side="right")) - 1

    def runs(self) -> Iterator[Indices]:
        """Yield the runs of neighbouring samples whose discs lie between the same two sides, in order."""
        for loop, (start, end) in enumerate(zip(self.first[:-1].tolist(), self.first[1:].tolist(), strict=True)):
            numbers = np.arange(start, end)
            follows = self._follows(numbers, np.roll(numbers, -1))
            breaks = np.flatnonzero(~follows)
            if not len(breaks):
                yield numbers
                continue
            rolled, follows = np.roll(numbers, -breaks[0] - 1), np.roll(follows, -breaks[0] - 1)
            for part in np.split(rolled, np.flatnonzero(~follows)[:-1] + 1):
                if len(part) >= 3 and self.opposite[part].all() and self.first[loop] <= part[0]:
                    yield part

    def _follows(self, one: Indices, other: Indices) -> Bools:
        """Whether the discs of neighbouring samples touch neighbouring places on the other side."""
        a, b = self.partner[one], self.partner[other]
        step = np.hypot(*(self.points[other] - self.points[one]).T)
        across = np.hypot(*(self.points[b] - self.points[a]).T)
        same = np.searchsorted(self.first, a, side="right") == np.searchsorted(self.first, b, side="right")
        return np.asarray(
            self.opposite[one] & self.opposite[other] & same & (across < 4 * step + 0.1 * self.radius[one])
        )

    def between(self, partners: Indices) -> Indices:
        """Return all samples from the least to the greatest of partners, which follow each other on one loop."""
        loop = self.loop_of(int(partners[0]))
        start, count = int(self.first[loop]), int(self.first[loop + 1] - self.first[loop])
        steps = _cyclic(np.diff(partners - start), count)
        at = partners[0] - start + np.concatenate([[0], np.cumsum(steps)])
        return start + np.arange(int(at.min()), min(int(at.max()), int(at.min()) + count - 1) + 1) % count

    def strip(self, window: Indices, *, inside: bool) -> Strip:
        """Return the strip that neighbouring discs make."""
        radius = self.radius[window]
        half = float(radius.max() + radius.min()) / 2
        one, other = self.loop_of(int(window[0])), self.loop_of(int(self.partner[window[0]]))
        closed = len(window) == self.first[one + 1] - self.first[one]
        line = self.points[window] + self.towards[window] * radius[:, None]
        own, across = self.points[window], self.points[self.partner[window]]
        pieces = self._piece(one, window, closed), self._piece(other, self.between(self.partner[window]), closed)
        is_left = _is_left(line, own, closed=closed)
        left, right = (own, across) if is_left else (across, own)
        pieces = pieces if is_left else pieces[::-1]
        off = float(np.abs(radius - half).max())
        return Strip(
            points_array(line), points_array(left), points_array(right), half, off, pieces, inside, bool(closed)
        )

    def _piece(self, loop: int, numbers: Indices, closed: bool) -> Piece:
        sample = self.samples[loop]
        along = sample.along[np.asarray([numbers[0], numbers[-1]]) - self.first[loop]].tolist()
        if closed:
            return Piece(loop, 0.0, sample.length, whole=True)
        return Piece(loop, along[0], along[1] if along[1] > along[0] else along[1] + sample.length)


def _cyclic(steps: Indices, count: int) -> Indices:
    """Return steps around a loop of ``count`` the short way."""
    return np.asarray((steps + count // 2) % count - count // 2)


def _windows(radius: Floats, run: Indices, tolerance: float) -> Iterator[Indices]:
    """Yield the parts of a run in which radii differ by at most ``tolerance``, the longest first."""
    waiting = [(0, len(run))]
    while waiting:
        start, end = waiting.pop()
        if end - start < 3:
            continue
        best, first = (start, start), start
        for last in range(start, end):
            while np.ptp(radius[first : last + 1]) > tolerance:
                first += 1
            if last + 1 - first > best[1] - best[0]:
                best = first, last + 1
        yield run[best[0] : best[1]]
        waiting += [(start, best[0]), (best[1], end)]


def _length(line: Floats, *, closed: bool) -> float:
    steps = np.roll(line, -1, axis=0) - line
    return float(np.hypot(*(steps if closed else steps[:-1]).T).sum())


def _is_left(line: Floats, own: Floats, *, closed: bool) -> bool:
    """Whether points lie on the left of the line that they belong to."""
    ahead = np.roll(line, -1, axis=0) - line
    turns = cross(ahead, own - line)
    return bool((turns if closed else turns[:-1]).sum() > 0)


def rounds(target: Target) -> list[Round]:
    """Return the pieces of the outline that are arcs of circles, of at least 60 degrees, in order."""
    found: list[Round] = []
    for number, (loop, corners) in enumerate(zip(target.loops, target.true_corners, strict=True)):
        along = np.concatenate([[0.0], np.cumsum(np.hypot(*(np.roll(loop, -1, axis=0) - loop).T))])
        if not len(corners) and (whole := _circle(np.concatenate([loop, loop[:1]]))):
            found.append(Round(Piece(number, 0.0, float(along[-1]), whole=True), *whole))
            continue
        start = int(corners[0]) if len(corners) else _smooth_start(loop)
        stops = [*(int(one) - start for one in corners), len(loop)] if len(corners) else [0, len(loop)]
        around = np.roll(loop, -start, axis=0)
        around = np.concatenate([around, around[:1]])
        for first, last in pairwise(stops):
            for one, other, circle in _arcs(around[first : last + 1]):
                a, b = ((first + end + start) % len(loop) for end in (one, other))
                end_along = along[b] if b > a else along[b] + along[-1]
                found.append(Round(Piece(number, float(along[a]), float(end_along)), *circle))
    return found


def concentric(found: Sequence[Round], tolerance: float) -> list[list[Round]]:
    """Return arcs in groups whose centres are within ``tolerance`` mm of the group's first."""
    groups: list[list[Round]] = []
    for one in sorted(found, key=lambda one: -abs(one.sweep * one.radius)):
        group = next((g for g in groups if math.dist(g[0].centre, one.centre) <= tolerance), None)
        if group is None:
            groups.append([one])
        else:
            group.append(one)
    return groups


Circle = tuple[Floats, float, float]
"""Centre, radius, sweep."""


def _smooth_start(loop: Floats) -> int:
    """Return the end of the longest side, where no arc is cut in two if there is any straight side."""
    return (int(np.hypot(*(np.roll(loop, -1, axis=0) - loop).T).argmax()) + 1) % len(loop)


def _arcs(points: Floats) -> Iterator[tuple[int, int, Circle]]:
    """Yield the arcs in an open line, as its first and its last point, from the start on."""
    first = free = 0
    while first + LEAST_POINTS <= len(points):
        last, circle = first + LEAST_POINTS - 1, _circle(points[first : first + LEAST_POINTS], least=0.0)
        step = 1
        while circle is not None and step:
            reach = min(last + step, len(points) - 1)
            more = _circle(points[first : reach + 1], least=0.0) if reach > last else None
            if more is None:
                step //= 2
            else:
                last, circle, step = reach, more, 2 * step
        if circle is not None and abs(circle[2]) >= LEAST_SWEEP:
            while first > free and (more := _circle(points[first - 1 : last + 1], least=0.0)):
                first, circle = first - 1, more
            yield first, last, circle
            first = free = last
        else:
            first += max((last - first) // 3, 1)


def _circle(points: Floats, least: float = LEAST_SWEEP) -> Circle | None:
    """Return the circle that a line, ``(n, 2)``, is an arc of, if it is one."""
    if len(points) < LEAST_POINTS:
        return None
    middle = points.mean(axis=0)
    from_middle = points - middle
    square = (from_middle**2).sum(axis=1)
    matrix = np.column_stack([2 * from_middle, np.ones(len(points))])
    try:
        solution = np.linalg.solve(matrix.T @ matrix, matrix.T @ square)
    except np.linalg.LinAlgError:
        return None
    centre = solution[:2]
    radius = math.sqrt(max(float(solution[2] + centre @ centre), 0.0))
    spokes = from_middle - centre
    if radius > 100 * float(np.ptp(points, axis=0).max()):
        return None
    if np.abs(np.hypot(*spokes.T) - radius).max() > ROUND_MM:
        return None
    if np.abs(np.hypot(*((spokes[1:] + spokes[:-1]) / 2).T) - radius).max() > CHORD_MM + ROUND_MM:
        return None
    z = spokes @ (1, 1j)
    turns = np.angle(z[1:] * z[:-1].conj())
    if not ((turns > -1e-9).all() or (turns < 1e-9).all()) or np.abs(turns).max() > 2.0:
        return None
    sweep = float(turns.sum())
    return (centre + middle, radius, sweep) if abs(sweep) >= least else None
