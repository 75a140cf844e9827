"""Fit tangents of few circles to a smooth row of points: points -> ``Sides``, by the program of ``arcs_code``."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from foldcut.core.arrays import Bools, Floats, Indices
from foldcut.core.compiled import compiled_copy
from foldcut.redraw.starts import arcs_code, pieces
from foldcut.redraw.starts.fitting import ANY, End, Sides

__all__ = ["directions_along", "fit_bends", "straight_parts"]

MOST_PLACES = 60
"""The largest number of places whose tangents are anchors."""

ASIDE = (0.0, 0.55, 0.95)
"""How far tangents are moved to the inside of a bend, as parts of the tolerance."""

STRAIGHT = math.radians(0.7)
"""A row that turns by no more is straight."""


def fit_bends(
    points: Floats,
    tolerance: float,
    weight: float = 0.3,
    *,
    breaks: Bools | None = None,
    reach: Indices | None = None,
    half: Indices | None = None,
    first: End = ANY,
    last: End = ANY,
) -> Sides | None:
    """Return few lines for a row of ``points`` ``(m, 2)``, in each bend tangents of one circle, or None.

    Parameters as for ``fitting.fit``. ``half`` ``(m,)``: where that part of an anchor's piece that is
    beside one bend ends at the latest.
    """
    m = len(points)
    stops = [0, *(np.flatnonzero(breaks[1:-1]) + 1).tolist(), m - 1] if breaks is not None else [0, m - 1]
    bound = np.full(m, m - 1, dtype=np.int64) if reach is None else reach
    part_bound = bound if half is None else half
    cuts, normals, offsets, total = [0], [], [], 0.0
    for a, b in pairwise(stops):
        ends = first if a == 0 else ANY, last if b == m - 1 else ANY
        row = np.ascontiguousarray(points[a : b + 1])
        part = _fit(row, bound[a : b + 1] - a, part_bound[a : b + 1] - a, tolerance, weight, *ends)
        if part is None:
            return None
        some, angles, middle, cost = part
        cuts += [a + k for k in some[1:]]
        normals += [(-math.sin(t), math.cos(t)) for t in angles]
        offsets += middle
        total += cost
    return Sides(np.array(cuts), np.array(normals)[None], np.array(offsets)[None], total)


def _fit(
    points: Floats,
    reach: Indices,
    half: Indices,
    tolerance: float,
    weight: float,
    first: End,
    last: End,
) -> tuple[list[int], list[float], list[float], float] | None:
    """Return cuts, directions and middle offsets of the fewest lines for a smooth row."""
    m = len(points)
    theta = directions_along(points[None])
    anchors, price = _anchors(points, theta, tolerance, first, last)
    count = len(anchors)
    cost, along = np.empty(count), np.empty(count)
    previous, between = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    end = compiled_copy(arcs_code).fit_arcs(
        points, theta, reach, half, tolerance, weight, anchors, price, cost, previous, between, along
    )
    if end < 0:
        return None
    taken = [int(end)]
    while previous[taken[-1]] >= 0:
        taken.append(int(previous[taken[-1]]))
    taken.reverse()
    cuts, angles, offsets = [0], [float(anchors[taken[0], 2])], [float(anchors[taken[0], 3])]
    for b, n in pairwise(taken):
        a0, a1, c0, c1 = anchors[b, 2], anchors[n, 2], anchors[b, 3], anchors[n, 3]
        sides, sign = int(between[n]), 1.0 if a1 > a0 else -1.0
        step = abs(a1 - a0) / (sides + 1)
        here = int(anchors[b, 1])
        start, stop = _normal(a0), _normal(a1)
        apart = start - stop
        base = apart * (c0 - c1) / (apart @ apart)
        middle = base + along[n] * _normal((a0 + a1) / 2)
        radius = float(start @ middle - c0)
        for s in range(1, sides + 2):
            bound = (s - 0.5) * step
            while here < anchors[n, 0] and (theta[here] - a0) * sign < bound:
                here += 1
            cuts.append(max(here, cuts[-1]))
            angle = a0 + sign * s * step
            angles.append(float(angle))
            offsets.append(float(c1) if s == sides + 1 else float(_normal(angle) @ middle) - radius)
    return [*cuts, m - 1], angles, offsets, float(cost[end])


def _normal(angle: float) -> Floats:
    return np.array([-math.sin(angle), math.cos(angle)])


def directions_along(points: Floats) -> Floats:
    """Return the direction of the rows at each place, in radians, without jumps."""
    steps = np.zeros((points.shape[1] + 1, 2))
    for row in points:
        steps[1:-1] += np.diff(row, axis=0)
    around = steps[:-1] + steps[1:]
    angles: Floats = np.unwrap(np.arctan2(around[:, 1], around[:, 0]))
    return angles


def _anchors(points: Floats, theta: Floats, tolerance: float, first: End, last: End) -> tuple[Floats, Floats]:
    """Return the anchors ``(n, 4)`` of a row, and what each costs."""
    m = len(points)
    found: list[tuple[float, float, float, float, float]] = []
    curving = np.gradient(theta) if m > 2 else np.zeros(m)
    straight = straight_parts(points, max(5.0, 2.5 * tolerance))
    covered = np.zeros(m, dtype=bool)
    for a, b in straight:
        ahead = points[b] - points[a]
        angle = _near(math.atan2(ahead[1], ahead[0]), float(theta[(a + b) // 2]))
        found.append((a, b, angle, _middle(points, a, b, angle), 1.0))
        covered[a + 1 : b] = True
    stride = max(1, math.ceil(m / MOST_PLACES))
    for place in range(0, m, stride):
        if covered[place]:
            continue
        angle = float(theta[place])
        offset = _middle(points, place, place, angle)
        sign = float(np.sign(curving[place]))
        found += [(place, place, angle, offset + sign * part * tolerance, 1.0) for part in ASIDE]
    for end, place in ((first, 0), (last, m - 1)):
        if end.kind == pieces.FREE:
            continue
        x, y = end.normal
        angle = _near(math.atan2(-x, y), float(theta[place]))
        if end.kind == pieces.GIVEN:
            found.append((place, place, angle, end.offset, 0.0))
            continue
        offset = _middle(points, place, place, angle)
        inward = 1 if place == 0 else m - 2
        sign = float(np.sign(curving[inward]))
        found += [(place, place, angle, offset + sign * part * tolerance, end.price) for part in ASIDE]
    array = np.array(sorted(found))
    return np.ascontiguousarray(array[:, :4]), np.ascontiguousarray(array[:, 4])


def _middle(points: Floats, a: int, b: int, angle: float) -> float:
    heights = points[a : b + 1] @ _normal(angle)
    return float(heights.min() + heights.max()) / 2


def _near(angle: float, other: float) -> float:
    """Return an angle by whole turns as near to another as possible."""
    return other + math.remainder(angle - other, 2 * math.pi)


def straight_parts(points: Floats, least: float) -> list[tuple[int, int]]:
    """Return the longest parts, first and last place, along which a row is straight, longer than ``least`` mm."""
    steps = np.diff(points, axis=0)
    angles = np.arctan2(steps[:, 1], steps[:, 0])
    parts: list[tuple[int, int]] = []
    start, count = 0, len(angles)
    while start < count:
        same = np.abs(_turn(angles[start:] - angles[start])) < STRAIGHT
        end = start + (count - start if same.all() else int(same.argmin()))
        if float(np.hypot(*(points[end] - points[start]))) > least:
            parts.append((start, end))
            start = end
        else:
            start += 1
    return parts


def _turn(angles: Floats) -> Floats:
    turns: Floats = (angles + math.pi) % (2 * math.pi) - math.pi
    return turns
