"""The fewest straight sides for a row of points, by dynamic programming; written once, run plain or compiled.

A row of points in order is divided into *pieces*, each within a tolerance of a line of its own; pieces that follow each
other share the point between them. Several rows may be divided at the same places at once: then the lines of a piece
are parallel, at given distances from each other (the two edges of a strip, which so get the same bends).

``fit_freely``: lines of any direction. ``fit_directed``: lines whose directions are from a given set.

Arrays: ``points`` ``(k, m, 2)`` mm, row after row; ``shift`` ``(k,)`` mm, how far each row's line is to the left of
the piece's middle line; ``breaks`` ``(m,)``, nonzero where a piece has to end; ``first``, ``last`` ``(6,)``: the kind of
the first and last piece (``FREE``, ``DIRECTED``, ``GIVEN``), the left normal and offset of its line, what it costs, and
whether it may have another direction all the same. All results are written to arrays that are passed in.
"""

from __future__ import annotations

from math import atan2, cos, hypot, sin

from foldcut.core.compiled import compiled_in

__all__ = ["DIRECTED", "FREE", "GIVEN", "fit_directed", "fit_freely", "straight_as_far_as"]

compiled = compiled_in(__name__)
inlined = compiled_in(__name__, inline=True)

FREE, DIRECTED, GIVEN = 0.0, 1.0, 2.0
"""Kinds of first and last pieces: any line; a line of a given direction; a given line, which costs nothing."""

HOPELESS = 2.2
"""A piece this many times the tolerance off its best line by squares has no line within the tolerance, nor has any
longer one."""

STEPS = 7
"""How many times the direction of a line that nearly fits is improved."""

GOLDEN = 0.6180339887498949

INFINITE = 1e300


@inlined
def _off(points, shift, i, j, x, y, own, known):
    """Return half the width of points i..j across the normal (x, y); with ``own`` the largest of the rows' widths."""
    low, high, worst = INFINITE, -INFINITE, 0.0
    for k in range(points.shape[0]):
        for p in range(i, j + 1):
            v = points[k, p, 0] * x + points[k, p, 1] * y - shift[k]
            low = min(low, v)
            high = max(high, v)
        if own:
            worst = max(worst, high - low)
            low, high = INFINITE, -INFINITE
        elif high - low > known:
            return (high - low) / 2
    return worst / 2 if own else (high - low) / 2


@inlined
def _add_up(points, sums):
    """Add up along each row what lines by least squares are found from."""
    rows, m = points.shape[0], points.shape[1]
    for k in range(rows):
        for c in range(5):
            sums[k, 0, c] = 0.0
        for p in range(1, m):
            ax, ay, bx, by = points[k, p - 1, 0], points[k, p - 1, 1], points[k, p, 0], points[k, p, 1]
            length = hypot(bx - ax, by - ay)
            sums[k, p, 0] = sums[k, p - 1, 0] + length
            sums[k, p, 1] = sums[k, p - 1, 1] + length * (ax + bx) / 2
            sums[k, p, 2] = sums[k, p - 1, 2] + length * (ay + by) / 2
            xx = (ax * ax + bx * bx + ax * bx) / 3
            yy = (ay * ay + by * by + ay * by) / 3
            xy = (ax * ay + bx * by) / 3 + (ax * by + ay * bx) / 6
            sums[k, p, 3] = sums[k, p - 1, 3] + length * (xx - yy)
            sums[k, p, 4] = sums[k, p - 1, 4] + length * xy


@inlined
def _line(points, sums, i, j):
    """Return the left normal of the line by least squares for places i..j, the way between its ends, and its length."""
    rows = points.shape[0]
    spread, mixed, cx, cy, length = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(rows):
        n = sums[k, j, 0] - sums[k, i, 0]
        if n <= 0.0:
            continue
        sx, sy = sums[k, j, 1] - sums[k, i, 1], sums[k, j, 2] - sums[k, i, 2]
        spread += sums[k, j, 3] - sums[k, i, 3] - (sx * sx - sy * sy) / n
        mixed += sums[k, j, 4] - sums[k, i, 4] - sx * sy / n
        cx += points[k, j, 0] - points[k, i, 0]
        cy += points[k, j, 1] - points[k, i, 1]
        length = max(length, hypot(points[k, j, 0] - points[k, i, 0], points[k, j, 1] - points[k, i, 1]))
    angle = 0.5 * atan2(2 * mixed, spread)
    x, y = -sin(angle), cos(angle)
    if cos(angle) * cx + sin(angle) * cy < 0.0:
        x, y = -x, -y
    return x, y, cx, cy, length


@compiled
def straight_as_far_as(points, tolerance, sums, reach):
    """Find for each place of a row ``(1, m, 2)`` how far pieces that begin there are nearly within the tolerance of a line.

    Nearly: of the line by least squares. Result: ``reach`` ``(m,)``, the last place. Scratch: ``sums`` ``(1, m, 5)``.
    """
    m = points.shape[1]
    _add_up(points, sums)
    j = 0
    for i in range(m):
        j = max(j, min(i + 1, m - 1))
        while j + 1 < m:
            x, y, _, _, _ = _line(points, sums, i, j + 1)
            low, high = INFINITE, -INFINITE
            for p in range(i, j + 2):
                v = points[0, p, 0] * x + points[0, p, 1] * y
                low = min(low, v)
                high = max(high, v)
            if high - low > 2 * tolerance:
                break
            j += 1
        reach[i] = j


@compiled
def fit_freely(points, shift, breaks, reach, tolerance, weight, own, first, last, sums, cost, previous, normals):
    """Divide rows into the fewest pieces, each within the tolerance of its line.

    ``reach`` ``(m,)``: where a piece that begins at each place ends at the latest. ``weight``: what a piece at the tolerance costs more than one on its line, which costs 1. ``own``: the rows' lines
    are parallel, at any distance. Scratch: ``sums`` ``(k, m, 5)``. Results for each place j: ``cost[j]`` of the best
    pieces that end there (``INFINITE``: none), ``previous[j]``, where the last of them begins, ``normals[j]``, its left
    normal.
    """
    rows, m = points.shape[0], points.shape[1]
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
            x, y, cx, cy, length = _line(points, sums, i, j)
            off = _off(points, shift, i, j, x, y, own, 2 * HOPELESS * tolerance)
            if off > HOPELESS * tolerance:
                misses += 1
                if misses > 2:
                    break
            elif off > tolerance and length > 0.0:
                low, high = -2 * off / length, 2 * off / length
                a, b = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
                off_a = _off(points, shift, i, j, x * cos(a) - y * sin(a), x * sin(a) + y * cos(a), own, INFINITE)
                off_b = _off(points, shift, i, j, x * cos(b) - y * sin(b), x * sin(b) + y * cos(b), own, INFINITE)
                for _ in range(STEPS):
                    if off_a < off_b:
                        high, b, off_b = b, a, off_a
                        a = high - GOLDEN * (high - low)
                        off_a = _off(
                            points, shift, i, j, x * cos(a) - y * sin(a), x * sin(a) + y * cos(a), own, INFINITE
                        )
                    else:
                        low, a, off_a = a, b, off_b
                        b = low + GOLDEN * (high - low)
                        off_b = _off(
                            points, shift, i, j, x * cos(b) - y * sin(b), x * sin(b) + y * cos(b), own, INFINITE
                        )
                turn = a if off_a < off_b else b
                if min(off_a, off_b) < off:
                    off = min(off_a, off_b)
                    x, y = x * cos(turn) - y * sin(turn), x * sin(turn) + y * cos(turn)
            price = 1.0
            if off <= tolerance and cx * y - cy * x > 0.0:
                pass
            else:
                price = INFINITE
            if i == 0 and first[0] == DIRECTED:
                other = _off(points, shift, i, j, first[1], first[2], own, INFINITE)
                if first[5] == 0.0:
                    price = INFINITE
                if (
                    other <= tolerance
                    and first[4] + weight * (other / tolerance) ** 2 < price + weight * (off / tolerance) ** 2
                ):
                    price, x, y, off = first[4], first[1], first[2], other
            if j == m - 1 and last[0] == DIRECTED:
                other = _off(points, shift, i, j, last[1], last[2], own, INFINITE)
                if last[5] == 0.0:
                    price = INFINITE
                if (
                    other <= tolerance
                    and last[4] + weight * (other / tolerance) ** 2 < price + weight * (off / tolerance) ** 2
                ):
                    price, x, y, off = last[4], last[1], last[2], other
            if i == 0 and first[0] == GIVEN and _on(points, shift, i, j, first, tolerance):
                price, x, y, off = 0.0, first[1], first[2], 0.0
            if j == m - 1 and last[0] == GIVEN and _on(points, shift, i, j, last, tolerance):
                price, x, y, off = 0.0, last[1], last[2], 0.0
            if price < INFINITE:
                total = cost[i] + price + weight * (off / tolerance) ** 2
                if total < cost[j]:
                    cost[j] = total
                    previous[j] = i
                    normals[j, 0] = x
                    normals[j, 1] = y
            if breaks[j] != 0:
                break


@inlined
def _on(points, shift, i, j, line, tolerance):
    """Tell whether points i..j are within the tolerance of a given line."""
    for k in range(points.shape[0]):
        for p in range(i, j + 1):
            v = points[k, p, 0] * line[1] + points[k, p, 1] * line[2] - shift[k] - line[3]
            if v > tolerance or v < -tolerance:
                return False
    return True


@compiled
def fit_directed(points, shift, breaks, tolerance, weight, own, first, last, directions, apart, cost, previous, before):
    """Divide rows into the fewest pieces whose lines have left normals from ``directions`` ``(d, 2)``.

    ``apart``: the least sine of the angle between lines that follow each other. Results for each place j and direction
    d: ``cost[j, d]``, ``previous[j, d]``, ``before[j, d]``, the direction of the piece before. Row ``d`` of the results
    beyond the directions is for a first or last line that is given.
    """
    rows, m, count = points.shape[0], points.shape[1], directions.shape[0]
    for j in range(m):
        for d in range(count + 1):
            cost[j, d] = INFINITE
            previous[j, d] = -1
            before[j, d] = -1
    for i in range(m - 1):
        given = i == 0 and first[0] == GIVEN
        for d in range(count + 1):
            if d == count and not given:
                continue
            if given and d == count:
                x, y = first[1], first[2]
            elif d < count:
                x, y = directions[d, 0], directions[d, 1]
            else:
                continue
            # the best way to get here with another direction
            base, behind = INFINITE, -1
            if i == 0:
                base = 0.0
                if given and d < count and abs(first[1] * y - first[2] * x) < apart:
                    base = INFINITE
            else:
                for e in range(count + 1):
                    if cost[i, e] >= base:
                        continue
                    ex, ey = first[1], first[2]
                    if e < count:
                        ex, ey = directions[e, 0], directions[e, 1]
                    if abs(ex * y - ey * x) >= apart:
                        base, behind = cost[i, e], e
            if base >= INFINITE:
                continue
            if i == 0 and first[0] == DIRECTED:
                same = first[1] * x + first[2] * y > 1 - 1e-9
                if same:
                    base += first[4] - 1.0
                elif first[5] == 0.0:
                    continue
            low, high = INFINITE, -INFINITE
            for j in range(i + 1, m):
                stop = False
                worst = 0.0
                for k in range(rows):
                    if own:
                        low, high = INFINITE, -INFINITE
                        for p in range(i, j + 1):
                            v = points[k, p, 0] * x + points[k, p, 1] * y
                            low = min(low, v)
                            high = max(high, v)
                    else:
                        for p in range(j - 1 if j == i + 1 else j, j + 1):
                            v = points[k, p, 0] * x + points[k, p, 1] * y - shift[k]
                            low = min(low, v)
                            high = max(high, v)
                    worst = max(worst, high - low)
                    if d == count and (high > first[3] + tolerance or low < first[3] - tolerance):
                        stop = True
                if worst > 2 * tolerance or stop:
                    break
                ahead = 0.0
                for k in range(rows):
                    ahead += (points[k, j, 0] - points[k, i, 0]) * y - (points[k, j, 1] - points[k, i, 1]) * x
                if ahead > 0.0:
                    price = 0.0 if d == count else 1.0
                    if j == m - 1 and last[0] == DIRECTED:
                        if last[1] * x + last[2] * y > 1 - 1e-9:
                            price += last[4] - 1.0
                        elif last[5] == 0.0:
                            price = INFINITE
                    if j == m - 1 and last[0] == GIVEN and abs(last[1] * y - last[2] * x) < apart:
                        price = INFINITE
                    total = base + price + weight * (worst / (2 * tolerance)) ** 2
                    if total < cost[j, d]:
                        cost[j, d], previous[j, d], before[j, d] = total, i, behind
                if breaks[j] != 0:
                    break
