"""Leave out corners that a shape hardly needs: fewer corners make fewer and longer creases.

Shape and tolerance, both in mm -> ``Simplified``. Corners are only left out, never moved. The corner whose loss changes
the shape least goes first. Corners that tie go together, so that symmetric shapes mostly stay symmetric.
``drawing.mend`` calls this too, to keep to a number of corners.

Invariants: the old and the new boundary are nowhere farther apart than the tolerance; loops stay simple, do not touch,
lie within the same loops as before, and keep at least three corners.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Bools, Floats, points_array
from foldcut.core.errors import BadInputError, ShapeError
from foldcut.core.model import Shape
from foldcut.drawing.shape import make_shape

__all__ = ["Simplified", "simplify"]

ALIKE = 1e-9
"""Corners tie if their deviations differ by less than this, relative to the tolerance."""

CLEARANCE = 1e-5
"""The least distance between a new edge and other corners, relative to the size of the shape."""


@dataclass(frozen=True, eq=False)
class Simplified:
    """A shape with fewer corners, their number before and after, and the largest ``deviation`` from it in mm."""

    shape: Shape
    corners_before: int
    corners_after: int
    deviation: float

    def __str__(self) -> str:
        if self.corners_after == self.corners_before:
            return f"simplified: none of the {self.corners_before} corners can be left out"
        return f"simplified: {self.corners_before} -> {self.corners_after} corners, at most {self.deviation:.2g} mm off"


def simplify(shape: Shape, tolerance: float) -> Simplified:
    """Return ``shape`` without the corners that it does not need to stay within ``tolerance``, in the shape's units.

    Raises ``BadInputError`` for a tolerance that is not a finite number from 0 up, and ``ShapeError`` if rounding makes
    the result invalid.
    """
    if not 0 <= tolerance < float("inf"):
        raise BadInputError(f"the tolerance to simplify with is {tolerance} mm; give 0 or a positive number")
    loops = [_Loop(loop) for loop in shape.loops]
    clearance = CLEARANCE * float(np.ptp(np.concatenate(shape.loops), axis=0).max())
    for number, loop in enumerate(loops):
        while True:
            others = [other.points[other.kept] for at, other in enumerate(loops) if at != number]
            if not loop.drop_least(tolerance, clearance, others):
                break
    try:
        simplified = make_shape([loop.points[loop.kept] for loop in loops])
    except ShapeError as error:
        raise ShapeError(f"simplified by {tolerance:g} mm, the shape is not valid: {error}") from error
    if simplified.parent != shape.parent:
        raise ShapeError(f"simplified by {tolerance:g} mm, loops would change places; simplify less")
    return Simplified(
        simplified, shape.corner_count, simplified.corner_count, max(loop.worst_deviation() for loop in loops)
    )


@dataclass(frozen=True, eq=False)
class _Fits:
    """What a loop must keep to: the largest deviation, and the clearance from the corners of ``others``, in mm."""

    tolerance: float
    clearance: float
    others: list[Floats]


class _Loop:
    """The points of a loop, which of them are kept, and the deviation that leaving out each kept one would make."""

    def __init__(self, points: Floats) -> None:
        self.points = points_array(points)
        self.kept: Bools = np.ones(len(points), dtype=np.bool_)
        self.after = [(at + 1) % len(points) for at in range(len(points))]
        self.before = [at - 1 for at in range(len(points))]
        self.before[0] = len(points) - 1
        self.missed = np.array([self._deviation(self.before[at], self.after[at]) for at in range(len(points))])

    def drop_least(self, tolerance: float, clearance: float, others: list[Floats]) -> bool:
        """Leave out the corners that make the least deviation, and return whether there may be more to leave out."""
        candidates = np.where(self.kept, self.missed, np.inf)
        least = float(candidates.min())
        if least > tolerance or self.kept.sum() <= 3:
            return False
        fits = _Fits(tolerance, clearance, others)
        for run in self._runs(np.flatnonzero(candidates <= least + ALIKE * tolerance).tolist()):
            # From both ends at once, so that mirrored runs are treated alike.
            for step in range(0, (len(run) + 1) // 2, 2):
                first, last = run[step], run[-1 - step]
                if self.after[first] == last and first != last:
                    self._try_pair(first, last, fits)
                    continue
                self._try(first, fits)
                if last != first and self.before[last] != first:
                    self._try(last, fits)
        return True

    def _runs(self, alike: list[int]) -> list[list[int]]:
        """Return the runs of neighbours among these corners, each in order; every other corner of a run can go."""
        chosen = set(alike)
        starts = [at for at in alike if self.before[at] not in chosen]
        if not starts:  # the whole loop ties: every other corner, as a run of its own
            return [[at] for at in alike[:-1:2]]
        runs = []
        for start in starts:
            run = [start]
            while self.after[run[-1]] in chosen:
                run.append(self.after[run[-1]])
            runs.append(run)
        return runs

    def _try(self, at: int, fits: _Fits) -> bool:
        """Leave out a corner if that is possible; if it is not, the corner waits until a neighbour goes."""
        free = self.kept.sum() > 3 and self.missed[at] <= fits.tolerance and self._is_free(at, fits)
        if free:
            self._drop(at)
        else:
            self.missed[at] = np.inf
        return bool(free)

    def _try_pair(self, one: int, other: int, fits: _Fits) -> None:
        """Leave out two neighbours that tie: the one farther out, or if both are as far, both of them or neither."""
        centre = (self.points.min(axis=0) + self.points.max(axis=0)) / 2
        away = np.hypot(*(self.points[[one, other]] - centre).T)
        if abs(away[0] - away[1]) > 1e-9 * away.max():
            self._try(one if away[0] > away[1] else other, fits)
        elif self._try(one, fits) and not self._try(other, fits):
            before, after = self.before[one], self.after[one]
            self.kept[one] = True
            self.after[before] = self.before[after] = one
            self.missed[[one, other]] = np.inf
            self.missed[before] = self._deviation(self.before[before], one)

    def _drop(self, at: int) -> None:
        before, after = self.before[at], self.after[at]
        self.kept[at] = False
        self.after[before], self.before[after] = after, before
        for corner in (before, after):
            self.missed[corner] = self._deviation(self.before[corner], self.after[corner])

    def _is_free(self, at: int, fits: _Fits) -> bool:
        """Return whether a corner can go: no other corner is near the new edge, or in the triangle that it cuts off."""
        before, after = self.before[at], self.after[at]
        kept = self.kept.copy()
        kept[[before, at, after]] = False
        rest = np.concatenate([self.points[kept], *fits.others])
        a, corner, b = self.points[before], self.points[at], self.points[after]
        if len(rest) and _distances(rest, a, b).min() <= fits.clearance:
            return False
        turns = [_side(rest, *side) for side in ((a, corner), (corner, b), (b, a))]
        inside = np.all([turn >= 0 for turn in turns], axis=0) | np.all([turn <= 0 for turn in turns], axis=0)
        return not bool(inside.any())

    def _deviation(self, start: int, end: int) -> float:
        """Return how far the points between two corners are from the straight edge between the corners."""
        between = (
            self.points[start + 1 : end]
            if start < end
            else np.concatenate([self.points[start + 1 :], self.points[:end]])
        )
        return float(_distances(between, self.points[start], self.points[end]).max(initial=0.0))

    def worst_deviation(self) -> float:
        """Return the largest distance of a corner that was left out from the edge that replaces it."""
        return max(self._deviation(at, self.after[at]) for at in np.flatnonzero(self.kept).tolist())


def _side(points: Floats, start: Floats, end: Floats) -> Floats:
    """Return on which side of a line points are: positive on the left."""
    along, away = end - start, points - start
    sides: Floats = along[0] * away[:, 1] - along[1] * away[:, 0]
    return sides


def _distances(points: Floats, start: Floats, end: Floats) -> Floats:
    """Return the distances of points from a segment."""
    along, away = end - start, points - start
    share = np.clip(away @ along / max(float(along @ along), np.finfo(float).tiny), 0.0, 1.0)
    distances: Floats = np.hypot(*(away - share[:, None] * along).T)
    return distances
