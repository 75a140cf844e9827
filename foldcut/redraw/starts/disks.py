"""Fit both edges of a strip of any width with tangents of few disks: rows -> ``Sides``, by ``disks_code``."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.compiled import compiled_copy
from foldcut.redraw.starts import disks_code, pieces
from foldcut.redraw.starts.fitting import ANY, End, Sides

__all__ = ["fit_disks"]

MOST_PLACES = 60
"""The largest number of places of disks along a strip."""

ASIDE = (-0.5, 0.0, 0.5, 0.9)
"""How far disks are moved to the outside of a bend, as parts of the tolerance."""

GRID = 0.25
"""Radii differ from the usual one by multiples of this part of the tolerance, so that sides may be parallel."""

LARGER = (-0.5, 0.0, 0.5)
"""How much larger disks are made, as parts of the tolerance."""


def fit_disks(
    points: Floats,
    along: Floats,
    tolerance: float,
    weight: float = 0.3,
    *,
    paired: tuple[int, int] | None = None,
    first: End = ANY,
    last: End = ANY,
) -> Sides | None:
    """Return few lines for both rows of ``points`` ``(2, m, 2)`` of a strip, tangents of common disks, or None.

    ``along`` ``(m, 3)`` mm: middle and radius of the disks that touch both rows; the radius is negative where they
    lie on the right of the first. ``paired``: the first and last column where there is a disk between both rows.
    ``first``, ``last``: only those of an axis matter.
    """
    points = np.ascontiguousarray(points)
    m = points.shape[1]
    disks = _disks(along, tolerance, paired or (0, m - 1))
    ends = [end.array() if end.kind == pieces.DIRECTED else ANY.array() for end in (first, last)]
    cost, previous = np.empty(len(disks)), np.empty(len(disks), dtype=np.int64)
    end = int(compiled_copy(disks_code).fit_disks(points, disks, tolerance, weight, *ends, cost, previous))
    if end < 0:
        return None
    taken = [end]
    while previous[taken[-1]] >= 0:
        taken.append(int(previous[taken[-1]]))
    taken.reverse()
    cuts: list[int] = [int(disks[taken[0], 0])]
    normals: list[tuple[Floats, Floats]] = []
    offsets: list[tuple[float, float]] = []

    def add(disk: Floats, normal: Floats, other: Floats) -> None:
        normals.append((normal, other))
        middle = disk[1:3]
        offsets.append((float(normal @ middle - disk[3]), float(other @ middle + disk[3])))

    if cuts[0] > 0:
        cuts.insert(0, 0)
        add(disks[taken[0]], np.array(first.normal), np.array(first.normal))
    for b, n in pairwise(taken):
        ahead = disks[n, 1:3] - disks[b, 1:3]
        length = float(np.hypot(*ahead))
        ahead /= length
        s = float(disks[n, 3] - disks[b, 3]) / length
        left = math.sqrt(1 - s * s) * np.array([-ahead[1], ahead[0]])
        add(disks[b], s * ahead + left, -s * ahead + left)
        cuts.append(int(disks[n, 0]))
    if cuts[-1] < m - 1:
        cuts.append(m - 1)
        add(disks[taken[-1]], np.array(last.normal), np.array(last.normal))
    if not normals:
        return None
    return Sides(np.array(cuts), np.swapaxes(np.array(normals), 0, 1), np.array(offsets).T, float(cost[end]))


def _disks(along: Floats, tolerance: float, paired: tuple[int, int]) -> Floats:
    """Return the disks that may be taken: at places along the strip, moved and enlarged by parts of the tolerance."""
    m = len(along)
    start, end = paired
    stride = max(1, math.ceil((end - start) / MOST_PLACES))
    places = np.unique([*range(start, end, stride), end])
    middle, radii = along[:, :2], along[:, 2]
    around = np.empty_like(middle)
    around[1:-1] = middle[2:] - middle[:-2]
    around[0], around[-1] = middle[1] - middle[0], middle[-1] - middle[-2]
    length = np.maximum(np.hypot(*around.T), 1e-12)
    left = np.column_stack([-around[:, 1], around[:, 0]]) / length[:, None]
    angles = np.unwrap(np.arctan2(around[:, 1], around[:, 0]))
    window = max(1, m // 20)
    turn = np.array([angles[min(m - 1, p + window)] - angles[max(0, p - window)] for p in places])
    outward = -np.sign(turn)
    rows = []
    usual, step = float(np.median(radii)), GRID * tolerance
    for place, sign in zip(places.tolist(), outward.tolist(), strict=True):
        for aside in ASIDE:
            for larger in LARGER:
                x, y = middle[place] + sign * aside * tolerance * left[place]
                column = 0 if place == start else m - 1 if place == end else place
                radius = usual + step * round((radii[place] + larger * tolerance - usual) / step)
                rows.append((column, x, y, radius))
    return np.array(rows)
