"""The fewest bends of a strip whose width may change: tangents of disks between its edges; run plain or compiled.

Where both edges of a strip are tangents of the same disks, one pair of tangents from each disk to the next, then around
the middle of each disk four sides are equally far away, two of each edge: a node of the straight skeleton with four
ridges. So a strip is a path through (x, y, radius), and its bends are matched, whatever its width does.
"""

from __future__ import annotations

from math import hypot, sqrt

from foldcut.core.compiled import compiled_in

__all__ = ["fit_disks"]

compiled = compiled_in(__name__)
inlined = compiled_in(__name__, inline=True)

INFINITE = 1e300

TAPER = 0.3
"""What a side costs more whose edges are not parallel."""


@inlined
def _off_line(points, k, i, j, x, y, c, known):
    """Return how far points i..j of row k are from a line, at most; a lower bound if it is more than ``known``."""
    worst = 0.0
    for p in range(i, j + 1):
        v = abs(points[k, p, 0] * x + points[k, p, 1] * y - c)
        if v > worst:
            worst = v
            if worst > known:
                return worst
    return worst


@compiled
def fit_disks(points, disks, tolerance, weight, first, last, cost, previous):
    """Find the fewest disks whose tangents are within the tolerance of both rows ``points`` ``(2, m, 2)``.

    ``disks`` ``(n, 4)``, sorted: the place of a disk, its middle, its radius, negative where it is on the right of the
    first row. ``first``, ``last``: as in ``pieces``; of the kind ``DIRECTED`` the row may begin (end) with tangents of
    one disk alone that have the given left normal; others begin and end at a disk. Results: ``cost`` and ``previous``
    of each disk, -1: it is the first. Returns the last disk, -1 if there is none.
    """
    m, count = points.shape[1], disks.shape[0]
    best, end = INFINITE, -1
    for n in range(count):
        cost[n] = INFINITE
        previous[n] = -1
        j = int(disks[n, 0])
        if first[0] == 1.0:
            c = first[1] * disks[n, 1] + first[2] * disks[n, 2]
            worst = _off_line(points, 0, 0, j, first[1], first[2], c - disks[n, 3], tolerance)
            worst = max(worst, _off_line(points, 1, 0, j, first[1], first[2], c + disks[n, 3], tolerance))
            if worst <= tolerance:
                cost[n] = first[4] + weight * (worst / tolerance) ** 2
        if j == 0:
            cost[n] = min(cost[n], 0.0)
        for b in range(n):
            i = int(disks[b, 0])
            if i >= j or cost[b] + 1.0 >= cost[n]:
                continue
            ux, uy = disks[n, 1] - disks[b, 1], disks[n, 2] - disks[b, 2]
            length = hypot(ux, uy)
            if length < 1e-9:
                continue
            s = (disks[n, 3] - disks[b, 3]) / length
            if abs(s) > 0.7:
                continue
            ux, uy = ux / length, uy / length
            t = sqrt(1 - s * s)
            x, y = s * ux - t * uy, s * uy + t * ux
            worst = _off_line(points, 0, i, j, x, y, x * disks[b, 1] + y * disks[b, 2] - disks[b, 3], tolerance)
            if worst > tolerance:
                continue
            x, y = -s * ux - t * uy, -s * uy + t * ux
            other = _off_line(points, 1, i, j, x, y, x * disks[b, 1] + y * disks[b, 2] + disks[b, 3], tolerance)
            if other > tolerance:
                continue
            total = cost[b] + 1.0 + weight * (max(worst, other) / tolerance) ** 2
            if abs(s) > 1e-9:
                total += TAPER
            if total < cost[n]:
                cost[n], previous[n] = total, b
        if cost[n] >= INFINITE:
            continue
        if j == m - 1 and cost[n] < best:
            best, end = cost[n], n
        if last[0] == 1.0:
            c = last[1] * disks[n, 1] + last[2] * disks[n, 2]
            worst = _off_line(points, 0, j, m - 1, last[1], last[2], c - disks[n, 3], tolerance)
            worst = max(worst, _off_line(points, 1, j, m - 1, last[1], last[2], c + disks[n, 3], tolerance))
            total = cost[n] + last[4] + weight * (worst / tolerance) ** 2
            if worst <= tolerance and total < best:
                best, end = total, n
    return end
