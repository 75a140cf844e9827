"""Strips whose inner edge leads in every bend, with sides there that touch one circle: rows -> ``Lead``.

Then the ridges of the paper beside a bend, on its inner side, meet in one node. Between two bends to different sides
the strip has a straight part, whose lines belong to both bends.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from foldcut.core.arrays import Bools, Floats
from foldcut.redraw.starts import pieces
from foldcut.redraw.starts.arcs import directions_along, fit_bends
from foldcut.redraw.starts.fitting import ANY, End, Sides, straight_as_far_as
from foldcut.redraw.starts.following import Lead

__all__ = ["lead_in_bends"]

Side = tuple[Floats, Floats, Bools]
"""Normals and offsets of the lines of both edges, and which of them are known."""

BEND = math.radians(35)
"""A strip that turns by less to one side has no bend there."""

STRAIGHT = 0.6
"""How far the edges of the straight part between two bends may be off a line, as a part of the tolerance."""


def lead_in_bends(
    points: Floats, tolerance: float, followed: float, weight: float, *, first: End = ANY, last: End = ANY
) -> Lead | None:
    """Return the lines of the inner edge in each bend of a strip with the rows ``points`` ``(2, m, 2)``, or None.

    ``tolerance`` mm of these lines; ``followed`` mm: how straight the other edge is beside each.
    """
    m = points.shape[1]
    theta = directions_along(points)
    between = [_straight_part(points, place, STRAIGHT * tolerance) for place in _inflections(theta)]
    if any(one[1][0] <= other[1][1] for other, one in pairwise(between)):
        return None
    cuts: list[int] = [0]
    sides: list[Side] = []
    starts = [0, *(part[1] for _, part in between)]
    stops = [*(part[0] for _, part in between), m - 1]
    for k, (a, b) in enumerate(zip(starts, stops, strict=True)):
        if b <= a:
            return None
        some = points[:, a : b + 1]
        lengths = np.hypot(*np.diff(some, axis=1).transpose(2, 0, 1)).sum(axis=1)
        edge = int(lengths[1] < lengths[0])
        start = _given(between[k - 1][0], edge) if k else first
        stop = _given(between[k][0], edge) if k < len(between) else last
        reach = straight_as_far_as(some[1 - edge], followed)
        half = straight_as_far_as(some[1 - edge], followed / 3)
        row = some[edge]
        fitted = fit_bends(row, tolerance, weight, reach=reach, half=half, first=start, last=stop)
        if fitted is None:
            return None
        _add(cuts, sides, fitted, a, edge)
        if k < len(between):
            lines = between[k][0]
            merged = stop.kind == pieces.GIVEN and np.allclose(sides[-1][0][edge], lines.normals[edge, 0])
            side = lines.normals[:, 0], lines.offsets[:, 0], np.array([True, True])
            if merged:
                sides[-1] = side
            else:
                sides.append(side)
                cuts.append(b)
            cuts[-1] = stops[k]
    normals = np.stack([side[0] for side in sides], axis=1)
    offsets = np.stack([side[1] for side in sides], axis=1)
    known = np.stack([side[2] for side in sides], axis=1)
    return Lead(np.array(cuts), normals, offsets, known)


def _add(cuts: list[int], sides: list[Side], fitted: Sides, start: int, edge: int) -> None:
    """Add the sides of a bend, which begins at column ``start``; the first may be the straight part before it."""
    known = np.array([edge == 0, edge == 1])
    for s, (normal, offset) in enumerate(zip(fitted.normals[0], fitted.offsets[0], strict=True)):
        if s == 0 and sides and sides[-1][2].all():
            if np.allclose(sides[-1][0][edge], normal):
                cuts[-1] = start + int(fitted.cuts[1])
                continue
            cuts[-1] = start
        sides.append((np.stack([normal, normal]), np.array([offset, offset]), known))
        cuts.append(start + int(fitted.cuts[s + 1]))


def _given(lines: Sides, edge: int) -> End:
    x, y = lines.normals[edge, 0].tolist()
    return End(pieces.GIVEN, (x, y), float(lines.offsets[edge, 0]))


def _inflections(theta: Floats) -> list[int]:
    """Return the places between bends to different sides, each of which turns by ``BEND`` or more."""
    found: list[tuple[int, int]] = []  # place, and 1 where the direction is at its greatest
    low = high = 0
    sign = 0
    for place, angle in enumerate(theta.tolist()):
        if angle > theta[high]:
            high = place
        if angle < theta[low]:
            low = place
        if sign >= 0 and theta[high] - angle > BEND:
            if sign > 0:
                found.append((high, 1))
            sign, low = -1, place
        elif sign <= 0 and angle - theta[low] > BEND:
            if sign < 0:
                found.append((low, -1))
            sign, high = 1, place
    return [place for place, _ in found]


def _straight_part(points: Floats, place: int, tolerance: float) -> tuple[Sides, tuple[int, int]]:
    """Return the lines of both rows where they are straight around a place, and from where to where that is."""
    m = points.shape[1]
    a, b = max(0, place - 1), min(m - 1, place + 1)
    best = _lines(points, a, b, tolerance)
    open_ends = [True, True]
    step = max(1, m // 150)
    while any(open_ends):
        for end in (0, 1):
            if not open_ends[end]:
                continue
            low, high = (max(0, a - step), b) if end == 0 else (a, min(m - 1, b + step))
            more = _lines(points, low, high, tolerance) if (low, high) != (a, b) else None
            if more is None:
                open_ends[end] = False
            else:
                a, b, best = low, high, more
    assert best is not None
    # the bends begin a little before it ends
    inset = max(0, (b - a) // 6)
    return best, (a + inset, b - inset)


def _lines(points: Floats, a: int, b: int, tolerance: float) -> Sides | None:
    """Return parallel lines for both rows from column a to b, None if a row is farther off its own."""
    some = points[:, a : b + 1]
    ahead = (some[:, -1] - some[:, 0]).sum(axis=0)
    if float(np.hypot(*ahead)) < 1e-9:
        return None
    centred = np.concatenate([row - row.mean(axis=0) for row in some])
    x, y = np.linalg.svd(centred, full_matrices=False)[2][0]
    normal = np.array([-y, x]) if x * ahead[0] + y * ahead[1] > 0 else np.array([y, -x])
    heights = some @ normal
    if float(np.ptp(heights, axis=1).max()) > 2 * tolerance and b - a > 2:
        return None
    offsets = (heights.min(axis=1) + heights.max(axis=1)) / 2
    return Sides(np.array([0, b - a]), np.broadcast_to(normal, (2, 1, 2)), offsets[:, None], 1.0)
