"""The fewest sides along a smooth row of points, where sides around a bend touch one circle; plain or compiled.

The bisectors between tangents of one circle all meet in its middle, so the straight skeleton has one node there, and
both edges of a strip have it together. An *anchor* is a line that the sides may include: a straight part of the row, or
the tangent at a place, moved sideways by a part of the tolerance. Between two anchors that are taken lie tangents of
one circle that also touches both anchors, at even angles.
"""

from __future__ import annotations

from math import cos, pi, sin

from foldcut.core.compiled import compiled_in

__all__ = ["fit_arcs"]

compiled = compiled_in(__name__)
inlined = compiled_in(__name__, inline=True)

INFINITE = 1e300

LEAST_TURN = 0.05
"""The least turn between two anchors that are taken, in radians."""

LARGEST_STEP = 1.6
"""The largest turn between two sides of one bend, in radians."""

LEAST_RADIUS = 0.2
"""The least radius of a circle, in mm."""

MOST = 9
"""The largest number of sides between two anchors."""


@inlined
def _range(points, i, j, x, y):
    """Return the least and the largest distance of points i..j from the line through 0 with normal (x, y)."""
    low, high = INFINITE, -INFINITE
    for p in range(i, j + 1):
        v = points[p, 0] * x + points[p, 1] * y
        low = min(low, v)
        high = max(high, v)
    return low, high


@compiled
def _bend(points, theta, reach, half, tolerance, i, j, a, b, c, d):
    """Return how many sides at least lie between two lines, where on the bisector their circle is, and how far off.

    The lines have the directions a and b, in radians, and the offsets c and d, and are near the row up to place i, from
    place j on. The number is -1 if none fit.
    """
    turn = b - a
    sign = 1.0 if turn > 0 else -1.0
    wide = abs(turn) / 2
    if wide < LEAST_TURN / 2 or wide > pi * 0.98:
        return -1, 0.0, 0.0
    ax, ay, bx, by = -sin(a), cos(a), -sin(b), cos(b)
    mid = (a + b) / 2
    wx, wy = ax - bx, ay - by
    w = wx * wx + wy * wy
    qx, qy = wx * (c - d) / w, wy * (c - d) / w
    base = ax * qx + ay * qy - c
    for count in range(MOST + 1):
        step = 2 * wide / (count + 1)
        if step > LARGEST_STEP:
            continue
        low, high = -INFINITE, INFINITE
        here = i
        possible = True
        worst = 0.0
        for s in range(count + 2):
            # the piece of side s: as far as the row turns to the middle between its direction and the next
            there = here
            if s <= count:
                bound = (s + 0.5) * step
                while there < j and (theta[there] - a) * sign < bound:
                    there += 1
            else:
                there = j
            angle = a + sign * s * step
            x, y = -sin(angle), cos(angle)
            if there > (half[here] if s == 0 or s == count + 1 else reach[here]):
                possible = False
                break
            least, most = _range(points, here, there, x, y)
            room = tolerance - (most - least) / 2
            if room < 0.0:
                possible = False
                break
            worst = max(worst, tolerance - room)
            middle = (most + least) / 2
            if s == 0 or s == count + 1:
                off = middle - (c if s == 0 else d)
                if abs(off) > room:
                    possible = False
                    break
            else:
                slope = cos(mid - angle) - cos(wide)
                start = x * qx + y * qy - base
                if slope < 1e-9:
                    possible = False
                    break
                low = max(low, (middle - room - start) / slope)
                high = min(high, (middle + room - start) / slope)
                if low > high:
                    possible = False
                    break
            here = there
        if not possible:
            continue
        if count == 0:
            return 0, 0.0, worst
        along = (low + high) / 2
        radius = base + along * cos(wide)
        if sign * radius > LEAST_RADIUS:
            return count, along, worst
    return -1, 0.0, 0.0


@compiled
def fit_arcs(points, theta, reach, half, tolerance, weight, anchors, price, cost, previous, between, along):
    """Find the fewest sides for a row: which anchors to take, and how many sides lie between two of them.

    ``theta`` ``(m,)``: the row's direction at each place, in radians, without jumps. ``reach`` ``(m,)``: where a piece
    that begins at each place ends at the latest, and ``half``, where half the piece of an anchor does. ``anchors``
    ``(n, 4)``, in order: the first and last place where the row is on the anchor's line, the line's direction (near
    ``theta`` there), its offset. ``price`` ``(n,)``. Results for each anchor: ``cost``, the ``previous`` anchor (-1: it
    is the first), the number of sides ``between``, and where ``along`` the bisector the circle's middle is. Returns the
    last anchor, or -1.
    """
    m, count = points.shape[0], anchors.shape[0]
    best, last = INFINITE, -1
    for n in range(count):
        cost[n] = INFINITE
        previous[n] = -1
        between[n] = 0
        along[n] = 0.0
        i, j = int(anchors[n, 0]), int(anchors[n, 1])
        x, y = -sin(anchors[n, 2]), cos(anchors[n, 2])
        low, high = _range(points, 0, i, x, y)
        if low >= anchors[n, 3] - tolerance and high <= anchors[n, 3] + tolerance:
            cost[n] = price[n]
        for b in range(n):
            h = int(anchors[b, 1])
            if h >= i or cost[b] + price[n] >= cost[n]:
                continue
            if abs(anchors[n, 2] - anchors[b, 2]) > 6.2:
                continue
            sides, place, off = _bend(
                points,
                theta,
                reach,
                half,
                tolerance,
                h,
                i,
                anchors[b, 2],
                anchors[n, 2],
                anchors[b, 3],
                anchors[n, 3],
            )
            if sides >= 0:
                total = cost[b] + price[n] + sides + weight * (off / tolerance) ** 2
                if total < cost[n]:
                    cost[n], previous[n], between[n], along[n] = total, b, sides, place
        if cost[n] < best:
            low, high = _range(points, j, m - 1, x, y)
            if low >= anchors[n, 3] - tolerance and high <= anchors[n, 3] + tolerance:
                best, last = cost[n], n
    return last
