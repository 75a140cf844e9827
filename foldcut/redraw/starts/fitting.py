"""Fit straight sides to a row of points: points -> ``Sides``, by the dynamic programs of ``pieces``."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Bools, Floats, Indices
from foldcut.core.compiled import compiled_copy
from foldcut.redraw.starts import pieces

__all__ = ["ANY", "End", "Sides", "fit", "straight_as_far_as"]

APART = np.sin(np.radians(8))
"""The least sine of the angle between sides that follow each other, where directions are from a set."""


@dataclass(frozen=True)
class End:
    """How the first or last piece of a row has to be: ``kind`` of ``pieces``, the left normal of its line, its offset.

    ``price``: what such a piece costs, where others cost 1.
    """

    kind: float = pieces.FREE
    normal: tuple[float, float] = (0.0, 0.0)
    offset: float = 0.0
    price: float = 1.0

    def array(self) -> Floats:
        """The form that ``pieces`` takes."""
        return np.array([self.kind, *self.normal, self.offset, self.price])


ANY = End()
"""A first or last piece like any other."""


@dataclass(frozen=True, eq=False)
class Sides:
    """Lines for the pieces of rows: piece s goes from place ``cuts[s]`` to ``cuts[s + 1]``.

    ``normals`` ``(k, s, 2)`` point to the left; the line of row k is ``normals[k, s] @ p == offsets[k, s]``.
    ``cost``: the number of lines, and a little for how far they are off.
    """

    cuts: Indices
    normals: Floats
    offsets: Floats
    cost: float


def fit(
    points: Floats,
    tolerance: float,
    weight: float = 0.3,
    *,
    breaks: Bools | None = None,
    reach: Indices | None = None,
    first: End = ANY,
    last: End = ANY,
    directions: Floats | None = None,
) -> Sides | None:
    """Return the fewest lines for a row of ``points`` ``(m, 2)``, each within ``tolerance`` mm of its piece, or None.

    ``weight``: what a line costs more that is off by the tolerance; each costs 1. ``breaks`` ``(m,)``: where a piece
    has to end. ``reach`` ``(m,)``: where a piece that begins at a place ends at the latest, if lines may have any
    direction.
    ``directions`` ``(d, 2)``: the left normals that lines may have, if not any.
    """
    m = len(points)
    if m < 2:
        return None
    points = np.ascontiguousarray(points)
    stops = np.zeros(m, dtype=np.int64) if breaks is None else breaks.astype(np.int64)
    if directions is not None:
        return _fit_directed(points, stops, tolerance, weight, first, last, directions)
    bound = np.full(m, m - 1, dtype=np.int64) if reach is None else reach
    cost, previous, normals = np.empty(m), np.empty(m, dtype=np.int64), np.empty((m, 2))
    ends, sums = (first.array(), last.array()), np.empty((m, 5))
    compiled_copy(pieces).fit_freely(points, stops, bound, tolerance, weight, *ends, sums, cost, previous, normals)
    if cost[-1] >= pieces.INFINITE:
        return None
    cuts = [m - 1]
    while cuts[-1] > 0:
        cuts.append(int(previous[cuts[-1]]))
    cuts.reverse()
    return _sides(points, cuts, normals[cuts[1:]], first, last, float(cost[-1]))


def straight_as_far_as(row: Floats, tolerance: float) -> Indices:
    """Return for each place of a row ``(m, 2)`` how far a piece from there is straight within ``tolerance`` mm."""
    reach = np.empty(len(row), dtype=np.int64)
    compiled_copy(pieces).straight_as_far_as(np.ascontiguousarray(row), tolerance, np.empty((len(row), 5)), reach)
    return reach


def _fit_directed(
    points: Floats, stops: Indices, tolerance: float, weight: float, first: End, last: End, directions: Floats
) -> Sides | None:
    """Return the fewest lines of given directions."""
    m, count = len(points), len(directions)
    cost = np.empty((m, count + 1))
    previous, before = np.empty((m, count + 1), dtype=np.int64), np.empty((m, count + 1), dtype=np.int64)
    ends = first.array(), last.array()
    compiled_copy(pieces).fit_directed(points, stops, tolerance, weight, *ends, directions, APART, cost, previous, before)
    every = np.concatenate([directions, [first.normal]])
    j, d = m - 1, int(cost[-1].argmin())
    total = float(cost[j, d])
    tail: list[int] = []
    if last.kind == pieces.GIVEN:  # the last pieces may be on the given line
        heights = points @ np.array(last.normal) - last.offset
        off = np.maximum.accumulate(np.abs(heights)[::-1])[::-1]
        apart = np.abs(every[:, 0] * last.normal[1] - every[:, 1] * last.normal[0]) >= APART
        for i in np.flatnonzero(off[:-1] <= tolerance)[::-1].tolist():
            if stops[i + 1 : -1].any():
                break
            reach = np.where(apart, cost[i], np.inf)
            if i == 0 and first.kind != pieces.GIVEN:
                j, total, tail = 0, 0.0, [m - 1]
            elif reach.min() < total:
                j, d, total, tail = i, int(reach.argmin()), float(reach.min()), [m - 1]
    if total >= pieces.INFINITE:
        return None
    cuts, normals = [*tail, j], [np.array(last.normal)] * len(tail)
    while cuts[-1] > 0:
        j = cuts[-1]
        cuts.append(int(previous[j, d]))
        normals.append(every[d])
        d = int(before[j, d])
    return _sides(points, cuts[::-1], np.array(normals[::-1]), first, last, total)


def _sides(points: Floats, cuts: list[int], normals: Floats, first: End, last: End, cost: float) -> Sides:
    """Return the lines in the middle of their pieces."""
    offsets = np.empty((1, len(normals)))
    for s, normal in enumerate(normals):
        heights = points[cuts[s] : cuts[s + 1] + 1] @ normal
        offsets[0, s] = (heights.min() + heights.max()) / 2
    for s, end in ((0, first), (-1, last)):
        if end.kind == pieces.GIVEN and (normals[s] == np.array(end.normal)).all():
            offsets[0, s] = end.offset
    return Sides(np.array(cuts), normals[None], offsets, cost)
