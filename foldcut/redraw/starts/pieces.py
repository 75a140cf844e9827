"""The fewest straight sides for a row of points, by dynamic programming; written once, run plain or compiled.

A row of points in order is divided into *pieces*, each within a tolerance of a line of its own; pieces that follow each
other share the point between them.

``fit_freely``: lines of any direction. ``fit_directed``: lines whose directions are from a given set.

Arrays: ``points`` ``(m, 2)`` mm; ``breaks`` ``(m,)``, nonzero where a piece has to end; ``first``, ``last`` ``(5,)``:
the kind of the first and last piece (``FREE``, ``DIRECTED``, ``GIVEN``), the left normal and offset of its line, and
what it costs. All results are written to arrays that are passed in.
"""

from __future__ import annotations

from math import atan2, cos, hypot, sin

from foldcut.core.compiled import compiled_in

__all__ = ["DIRECTED", "FREE", "GIVEN", "fit_directed", "fit_freely", "straight_as_far_as"]

compiled = compiled_in(__name__)
inlined = compiled_in(__name__, inline=True)

FREE, DIRECTED, GIVEN = 0.0, 1.0, 2.0
"""Kinds of first and last pieces: like any other; also, at another price, with a line of a given direction; or, for
nothing, on a given line."""

HOPELESS = 2.2
"""A piece this many times the tolerance off its best line by squares has no line within the tolerance, nor has any
longer one."""

STEPS = 7
"""How many times the direction of a line that nearly fits is improved."""

GOLDEN = 0.6180339887498949

INFINITE = 1e300


@inlined
def _off(points, i, j, x, y, known):
    """Return half the width of points i..j across the normal (x, y), less if it is more than half ``known``."""
    low, high = INFINITE, -INFINITE
    for p in range(i, j + 1):
        v = points[p, 0] * x + points[p, 1] * y
        low = min(low, v)
        high = max(high, v)
        if high - low > known:
            break
    return (high - low) / 2


@inlined
def _turned(points, i, j, x, y, angle):
    """Return half the width of points i..j across the normal (x, y), turned by an angle."""
    return _off(points, i, j, x * cos(angle) - y * sin(angle), x * sin(angle) + y * cos(angle), INFINITE)


@inlined
def _is_on(points, i, j, line, tolerance):
    """Tell whether points i..j are within the tolerance of a given line."""
    for p in range(i, j + 1):
        v = points[p, 0] * line[1] + points[p, 1] * line[2] - line[3]
        if v > tolerance or v < -tolerance:
            return False
    return True


@inlined
def _add_up(points, sums):
    """Add up along the row what lines by least squares are found from."""
    for c in range(5):
        sums[0, c] = 0.0
    for p in range(1, points.shape[0]):
        ax, ay, bx, by = points[p - 1, 0], points[p - 1, 1], points[p, 0], points[p, 1]
        length = hypot(bx - ax, by - ay)
        xx = (ax * ax + bx * bx + ax * bx) / 3
        yy = (ay * ay + by * by + ay * by) / 3
        xy = (ax * ay + bx * by) / 3 + (ax * by + ay * bx) / 6
        sums[p, 0] = sums[p - 1, 0] + length
        sums[p, 1] = sums[p - 1, 1] + length * (ax + bx) / 2
        sums[p, 2] = sums[p - 1, 2] + length * (ay + by) / 2
        sums[p, 3] = sums[p - 1, 3] + length * (xx - yy)
        sums[p, 4] = sums[p - 1, 4] + length * xy


@inlined
def _line(points, sums, i, j):
    """Return the left normal of the line by least squares for places i..j, and the way between its ends."""
    cx, cy = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1]
    n = sums[j, 0] - sums[i, 0]
    if n <= 0.0:
        return 0.0, 1.0, cx, cy
    sx, sy = sums[j, 1] - sums[i, 1], sums[j, 2] - sums[i, 2]
    spread = sums[j, 3] - sums[i, 3] - (sx * sx - sy * sy) / n
    mixed = sums[j, 4] - sums[i, 4] - sx * sy / n
    angle = 0.5 * atan2(2 * mixed, spread)
    x, y = -sin(angle), cos(angle)
    if cos(angle) * cx + sin(angle) * cy < 0.0:
        x, y = -x, -y
    return x, y, cx, cy


@compiled
def straight_as_far_as(points, tolerance, sums, reach):
    """Find for each place of a row how far pieces that begin there are within the tolerance of a line, nearly.

    Nearly: of the line by least squares. Result: ``reach`` ``(m,)``, the last place. Scratch: ``sums`` ``(m, 5)``.
    """
    m = points.shape[0]
    _add_up(points, sums)
    j = 0
    for i in range(m):
        j = max(j, min(i + 1, m - 1))
        while j + 1 < m:
            x, y, _, _ = _line(points, sums, i, j + 1)
            if _off(points, i, j + 1, x, y, INFINITE) > tolerance:
                break
            j += 1
        reach[i] = j


@compiled
def fit_freely(points, breaks, reach, tolerance, weight, first, last, sums, cost, previous, normals):
    """Divide a row into the fewest pieces, each within the tolerance of its line.

    ``reach`` ``(m,)``: where a piece that begins at each place ends at the latest. ``weight``: what a piece at the
    tolerance costs more than one on its line, which costs 1. Scratch: ``sums`` ``(m, 5)``. Results for each place j:
    ``cost[j]`` of the best pieces that end there (``INFINITE``: none), ``previous[j]``, where the last of them begins,
    ``normals[j]``, its left normal.
    """
    m = points.shape[0]
    _add_up(points, sums)
    for j in range(m):
        cost[j] = INFINITE
        previous[j] = -1
    cost[0] = 0.0
    for i in range(m - 1):
        if cost[i] >= INFINITE:
            continue
        misses = 0
        for j in range(i + 1, min(m, reach[i] + 1)):
            x, y, cx, cy = _line(points, sums, i, j)
            length = hypot(cx, cy)
            off = _off(points, i, j, x, y, 2 * HOPELESS * tolerance)
            if off > HOPELESS * tolerance:
                misses += 1
                if misses > 2:
                    break
            elif off > tolerance and length > 0.0:  # the best direction is near, by the golden section
                low, high = -2 * off / length, 2 * off / length
                a, b = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
                off_a, off_b = _turned(points, i, j, x, y, a), _turned(points, i, j, x, y, b)
                for _ in range(STEPS):
                    if off_a < off_b:
                        high, b, off_b = b, a, off_a
                        a = high - GOLDEN * (high - low)
                        off_a = _turned(points, i, j, x, y, a)
                    else:
                        low, a, off_a = a, b, off_b
                        b = low + GOLDEN * (high - low)
                        off_b = _turned(points, i, j, x, y, b)
                if min(off_a, off_b) < off:
                    off, turn = min(off_a, off_b), (a if off_a < off_b else b)
                    x, y = x * cos(turn) - y * sin(turn), x * sin(turn) + y * cos(turn)
            price = INFINITE
            if off <= tolerance and cx * y - cy * x > 0.0:
                price = 1.0 + weight * (off / tolerance) ** 2
            for end in range(2):
                line = first if end == 0 else last
                if (end == 0 and i > 0) or (end == 1 and j < m - 1):
                    continue
                if line[0] == DIRECTED:
                    other = _off(points, i, j, line[1], line[2], INFINITE)
                    own = line[4] + weight * (other / tolerance) ** 2
                    if other <= tolerance and own < price:
                        price, x, y = own, line[1], line[2]
                elif line[0] == GIVEN and _is_on(points, i, j, line, tolerance):
                    price, x, y = 0.0, line[1], line[2]
            if cost[i] + price < cost[j]:
                cost[j] = cost[i] + price
                previous[j] = i
                normals[j, 0] = x
                normals[j, 1] = y
            if breaks[j] != 0:
                break


@compiled
def fit_directed(points, breaks, tolerance, weight, first, last, directions, apart, cost, previous, before):
    """Divide a row into the fewest pieces whose lines have left normals from ``directions`` ``(d, 2)``.

    ``apart``: the least sine of the angle between lines that follow each other. Results for each place j and direction
    d: ``cost[j, d]``, ``previous[j, d]``, ``before[j, d]``, the direction of the piece before. Row ``d`` of the results
    beyond the directions is for a first line that is given.
    """
    m, count = points.shape[0], directions.shape[0]
    for j in range(m):
        for d in range(count + 1):
            cost[j, d] = INFINITE
            previous[j, d] = -1
            before[j, d] = -1
    for i in range(m - 1):
        given = i == 0 and first[0] == GIVEN
        for d in range(count + 1):
            x, y = first[1], first[2]
            if d < count:
                x, y = directions[d, 0], directions[d, 1]
            elif not given:
                continue
            # the best way to get here with another direction
            base, behind = INFINITE, -1
            if i == 0:
                if not (given and d < count and abs(first[1] * y - first[2] * x) < apart):
                    base = 0.0
                if first[0] == DIRECTED and first[1] * x + first[2] * y > 1 - 1e-9:
                    base += first[4] - 1.0
            else:
                for e in range(count + 1):
                    ex, ey = first[1], first[2]
                    if e < count:
                        ex, ey = directions[e, 0], directions[e, 1]
                    if cost[i, e] < base and abs(ex * y - ey * x) >= apart:
                        base, behind = cost[i, e], e
            if base >= INFINITE:
                continue
            low = high = points[i, 0] * x + points[i, 1] * y
            for j in range(i + 1, m):
                v = points[j, 0] * x + points[j, 1] * y
                low = min(low, v)
                high = max(high, v)
                if high - low > 2 * tolerance:
                    break
                if d == count and (high > first[3] + tolerance or low < first[3] - tolerance):
                    break
                if (points[j, 0] - points[i, 0]) * y - (points[j, 1] - points[i, 1]) * x > 0.0:
                    price = 0.0 if d == count else 1.0
                    if j == m - 1 and last[0] == DIRECTED and last[1] * x + last[2] * y > 1 - 1e-9:
                        price += last[4] - 1.0
                    if j == m - 1 and last[0] == GIVEN and abs(last[1] * y - last[2] * x) < apart:
                        price = INFINITE
                    total = base + price + weight * ((high - low) / (2 * tolerance)) ** 2
                    if total < cost[j, d]:
                        cost[j, d], previous[j, d], before[j, d] = total, i, behind
                if breaks[j] != 0:
                    break
