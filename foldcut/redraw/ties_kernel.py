"""Move the corners of an outline so that skeleton nodes become one, and as near to the drawing as that leaves them.

Corners, ties and meetings, points of the drawing -> corners, by Newton's method with constraints: each step takes the
best fit to the drawing, in the sense of weighted least squares, among those that satisfy the linear constraints. Where
that leaves a point too far off, the weights are changed until the largest distance is the least (``tighten``).

A *tie* is a set of sides that are to be equally far from one point. For its m sides there are m distances and three
unknowns, the point and its height; what is left when these are eliminated are m - 3 constraints on the corners. A
*meeting* is a perpendicular that starts at one node, crosses the faces of some sides, and is to come to another node.

This file is run as it is, or compiled; nothing is allocated in it.
"""

from __future__ import annotations

from math import inf, isfinite, sqrt

from foldcut.core.compiled import compiled_in

compiled = compiled_in(__name__)
inlined = compiled_in(__name__, inline=True)

FREE = 0.03
"""How strongly every corner is held where it is, against 1 for a point of the drawing that is off by the tolerance."""

LEAST_WEIGHT = 0.05
"""The weight of a point of the drawing that the outline passes through."""

MOST_STEPS = 9
"""How many steps Newton's method gets."""

SINGULAR = 1e-10
"""A constraint whose part that is not in those before it is smaller than this is left out."""

DIFFERENCE = 1e-5
"""How far corners are moved, in mm, to find the derivatives of a meeting."""

MOST_TIGHTENED = 12
"""How many steps the corners are moved to make the largest distance from the drawing smaller."""

REWEIGHTED = 4
"""How often the weights are changed for each of them."""

HOPELESS_AFTER, HOPELESS = 4, 1.35
"""After so many steps an outline is given up that is farther from the drawing than so many tolerances."""

TIGHT = 0.97
"""An outline is tight enough that is nowhere farther from the drawing than this part of the tolerance."""

LEAST_SHARE = 0.02
"""What is added to each distance, in parts of the largest, where it changes a weight."""

LONGEST_STEP = 3.0
"""How far a corner is moved at most in one of these steps, in tolerances."""

NEARLY = 0.05
"""A tie that fails by less than this, in mm, is made exact at last."""

# what a function returns
SOLVED, FAILED = 1, 0

# places in ``t.sizes``
TOLERANCE, EXACT, FITS, WIDTH, HEIGHT = range(5)


@compiled
def set_sides(t, n):
    """Set direction and length of every side; side 2k runs along edge k, side 2k + 1 against it."""
    for k in range(n):
        a, b = k, t.following[k]
        dx, dy = t.x[b] - t.x[a], t.y[b] - t.y[a]
        length = sqrt(dx * dx + dy * dy)
        if not length > 1e-9:
            return False
        t.length[k] = length
        t.dx[k], t.dy[k] = dx / length, dy / length
    return True


@compiled
def node_of(t, begin, end, out):
    """Find the point and the height that fit some sides best; ``out`` gets x, y and height."""
    # normal equations of rows (nx, ny, -1) = n . a, about the mean of the sides' starts
    mx, my = 0.0, 0.0
    for i in range(begin, end):
        k = t.member[i] >> 1
        mx += t.x[k]
        my += t.y[k]
    mx /= end - begin
    my /= end - begin
    a00 = a01 = a02 = a11 = a12 = a22 = b0 = b1 = b2 = 0.0
    for i in range(begin, end):
        side = t.member[i]
        k = side >> 1
        sign = 1.0 if side & 1 == 0 else -1.0
        nx, ny = -sign * t.dy[k], sign * t.dx[k]
        value = nx * (t.x[k] - mx) + ny * (t.y[k] - my)
        a00 += nx * nx
        a01 += nx * ny
        a02 -= nx
        a11 += ny * ny
        a12 -= ny
        a22 += 1.0
        b0 += nx * value
        b1 += ny * value
        b2 -= value
    c00 = a11 * a22 - a12 * a12
    c01 = a02 * a12 - a01 * a22
    c02 = a01 * a12 - a02 * a11
    det = a00 * c00 + a01 * c01 + a02 * c02
    if not abs(det) > 1e-14:
        return False
    c11 = a00 * a22 - a02 * a02
    c12 = a01 * a02 - a00 * a12
    c22 = a00 * a11 - a01 * a01
    out[0] = (c00 * b0 + c01 * b1 + c02 * b2) / det + mx
    out[1] = (c01 * b0 + c11 * b1 + c12 * b2) / det + my
    out[2] = (c02 * b0 + c12 * b1 + c22 * b2) / det
    return True


@compiled
def orthogonalised(t, rank, m):
    """Take from row ``rank`` of ``t.basis`` what lies along the rows before it; returns the norm of what is left."""
    for _ in range(2):
        for r in range(rank):
            dot = 0.0
            for i in range(m):
                dot += t.basis[r, i] * t.basis[rank, i]
            for i in range(m):
                t.basis[rank, i] -= dot * t.basis[r, i]
    norm = 0.0
    for i in range(m):
        norm += t.basis[rank, i] * t.basis[rank, i]
    return sqrt(norm)


@compiled
def add_tie(t, n, begin, end, rows):
    """Add the constraints of a tie to ``t.g`` and ``t.value``; returns how many rows there are then, -1 on failure."""
    m = end - begin
    if not node_of(t, begin, end, t.node):
        return -1
    px, py, height = t.node[0], t.node[1], t.node[2]
    # an orthonormal basis of the columns nx, ny, -1
    rank = 0
    for c in range(3):
        for i in range(m):
            side = t.member[begin + i]
            k = side >> 1
            sign = 1.0 if side & 1 == 0 else -1.0
            t.basis[rank, i] = -sign * t.dy[k] if c == 0 else (sign * t.dx[k] if c == 1 else -1.0)
        norm = orthogonalised(t, rank, m)
        if norm > 1e-6:
            for i in range(m):
                t.basis[rank, i] /= norm
            rank += 1
    # what is left of the unit vectors
    for unit in range(m):
        if rank >= m:
            break
        for i in range(m):
            t.basis[rank, i] = 1.0 if i == unit else 0.0
        norm = orthogonalised(t, rank, m)
        if norm < 0.2 / sqrt(m + 0.0):
            continue
        if rows >= len(t.value):
            return -1
        for j in range(2 * n):
            t.g[rows, j] = 0.0
        value = 0.0
        for i in range(m):
            weight = t.basis[rank, i] / norm
            t.basis[rank, i] = weight
            side = t.member[begin + i]
            k = side >> 1
            sign = 1.0 if side & 1 == 0 else -1.0
            nx, ny = -sign * t.dy[k], sign * t.dx[k]
            away_x, away_y = px - t.x[k], py - t.y[k]
            value += weight * (nx * away_x + ny * away_y - height)
            part = (away_x * t.dx[k] + away_y * t.dy[k]) / t.length[k]
            f = t.following[k]
            t.g[rows, 2 * k] -= weight * (1 - part) * nx
            t.g[rows, 2 * k + 1] -= weight * (1 - part) * ny
            t.g[rows, 2 * f] -= weight * part * nx
            t.g[rows, 2 * f + 1] -= weight * part * ny
        t.value[rows] = value
        rank += 1
        rows += 1
    return rows


@compiled
def missed(t, number):
    """Return by how much a perpendicular misses its node; not finite where sides are parallel."""
    begin, way, end, stop = t.meeting[number, 0], t.meeting[number, 1], t.meeting[number, 2], t.meeting[number, 3]
    if not node_of(t, begin, way, t.node):
        return inf
    x, y = t.node[0], t.node[1]
    for i in range(way, end - 1):
        one, other = t.member[i], t.member[i + 1]
        if one >> 1 == other >> 1:
            continue
        a, b = one >> 1, other >> 1
        u = (x - t.x[a]) * t.dx[a] + (y - t.y[a]) * t.dy[a]
        foot_x, foot_y = t.x[a] + u * t.dx[a], t.y[a] + u * t.dy[a]
        sign = 1.0 if one & 1 == 0 else -1.0
        up_x, up_y = -sign * t.dy[a], sign * t.dx[a]
        sign = 1.0 if other & 1 == 0 else -1.0
        down_x, down_y = -sign * t.dy[b], sign * t.dx[b]
        level = (foot_x - t.x[b]) * down_x + (foot_y - t.y[b]) * down_y
        slope = 1 - (up_x * down_x + up_y * down_y)
        if not abs(slope) > 1e-12:
            return inf
        x, y = foot_x + level / slope * up_x, foot_y + level / slope * up_y
    if not node_of(t, end, stop, t.node):
        return inf
    last = t.member[end - 1] >> 1
    return (x - t.node[0]) * t.dx[last] + (y - t.node[1]) * t.dy[last]


@inlined
def set_side(t, k):
    """Set direction and length of a side."""
    b = t.following[k]
    dx, dy = t.x[b] - t.x[k], t.y[b] - t.y[k]
    t.length[k] = sqrt(dx * dx + dy * dy)
    t.dx[k], t.dy[k] = dx / t.length[k], dy / t.length[k]


@compiled
def add_meeting(t, n, number, rows):
    """Add the constraint of a meeting, with derivatives by differences."""
    if rows >= len(t.value):
        return -1
    value = missed(t, number)
    if not isfinite(value):
        return -1
    for j in range(2 * n):
        t.g[rows, j] = 0.0
    for k in range(n):
        t.mark[k] = 0
    for i in range(t.meeting[number, 0], t.meeting[number, 3]):
        k = t.member[i] >> 1
        t.mark[k] = 1
        t.mark[t.following[k]] = 1
    for k in range(n):
        if t.mark[k]:
            for c in range(2):
                old = t.x[k] if c == 0 else t.y[k]
                both = 0.0
                for step in (DIFFERENCE, -DIFFERENCE):
                    if c == 0:
                        t.x[k] = old + step
                    else:
                        t.y[k] = old + step
                    set_side(t, k)
                    set_side(t, t.before[k])
                    both += missed(t, number) / step
                if c == 0:
                    t.x[k] = old
                else:
                    t.y[k] = old
                set_side(t, k)
                set_side(t, t.before[k])
                slope = both / 2
                if not isfinite(slope):
                    return -1
                t.g[rows, 2 * k + c] = slope
    t.value[rows] = value
    return rows + 1


@compiled
def nearest_side(t, n, px, py, out):
    """Find the side nearest to a point; ``out`` gets the distance and how far along the side, from 0 to 1."""
    best, found, part = inf, -1, 0.0
    for k in range(n):
        away_x, away_y = px - t.x[k], py - t.y[k]
        u = away_x * t.dx[k] + away_y * t.dy[k]
        if u < 0:
            u = 0.0
        elif u > t.length[k]:
            u = t.length[k]
        away_x -= u * t.dx[k]
        away_y -= u * t.dy[k]
        distance = away_x * away_x + away_y * away_y
        if distance < best:
            best, found, part = distance, k, u / t.length[k]
    out[0], out[1] = sqrt(best), part
    return found


@inlined
def clear_fit(t, n):
    """Set matrix ``t.h`` and slope ``t.slope`` to what they are without any points."""
    size = 2 * n
    for i in range(size):
        for j in range(size):
            t.h[i, j] = 0.0
        t.h[i, i] = FREE
        t.slope[i] = 0.0


@compiled
def add_fit(t, n, samples):
    """Set up the least squares of the drawing's points about the outline: matrix ``t.h`` and slope ``t.slope``."""
    clear_fit(t, n)
    tolerance = t.sizes[TOLERANCE]
    for s in range(samples):
        px, py = t.sample_x[s], t.sample_y[s]
        k = nearest_side(t, n, px, py, t.node)
        distance, part = t.node[0], t.node[1]
        off = distance / tolerance
        weight = LEAST_WEIGHT + min(off * off, 4.0)
        if part == 0.0 or part == 1.0:
            corner = k if part == 0.0 else t.following[k]
            if distance < 1e-9:
                continue
            ux, uy = (t.x[corner] - px) / distance, (t.y[corner] - py) / distance
            i = 2 * corner
            t.h[i, i] += weight * ux * ux
            t.h[i, i + 1] += weight * ux * uy
            t.h[i + 1, i] += weight * ux * uy
            t.h[i + 1, i + 1] += weight * uy * uy
            t.slope[i] += weight * distance * ux
            t.slope[i + 1] += weight * distance * uy
            continue
        nx, ny = -t.dy[k], t.dx[k]
        # the side's point nearest to the sample, minus the sample, along the normal
        r = (t.x[k] - px) * nx + (t.y[k] - py) * ny
        i, j = 2 * k, 2 * t.following[k]
        one, other = 1 - part, part
        for c in range(2):
            a = nx if c == 0 else ny
            t.slope[i + c] += weight * r * one * a
            t.slope[j + c] += weight * r * other * a
            for d in range(2):
                b = nx if d == 0 else ny
                t.h[i + c, i + d] += weight * one * one * a * b
                t.h[i + c, j + d] += weight * one * other * a * b
                t.h[j + c, i + d] += weight * one * other * a * b
                t.h[j + c, j + d] += weight * other * other * a * b


@compiled
def factor(t, size):
    """Replace the lower half of ``t.h`` by its Cholesky factor."""
    for i in range(size):
        for j in range(i + 1):
            total = t.h[i, j]
            for k in range(j):
                total -= t.h[i, k] * t.h[j, k]
            if i == j:
                if not total > 1e-14:
                    return False
                t.h[i, i] = sqrt(total)
            else:
                t.h[i, j] = total / t.h[j, j]
    return True


@compiled
def step(t, n, rows):
    """Set ``t.change`` to the best step that satisfies the linear constraints as far as they do not contradict."""
    size = 2 * n
    # y = L^-1 slope, and rows of g L^-T in place
    for i in range(size):
        total = t.slope[i]
        for k in range(i):
            total -= t.h[i, k] * t.slope[k]
        t.slope[i] = total / t.h[i, i]
    for r in range(rows):
        for i in range(size):
            total = t.g[r, i]
            for k in range(i):
                total -= t.h[i, k] * t.g[r, k]
            t.g[r, i] = total / t.h[i, i]
    # z = L^T change; minimise |z + y|^2 subject to g z = -value: project onto the rows, one after the other
    for i in range(size):
        t.change[i] = -t.slope[i]
    kept = 0
    for r in range(rows):
        # orthogonalise against the rows that are kept; the value goes along
        norm_before = 0.0
        for i in range(size):
            norm_before += t.g[r, i] * t.g[r, i]
        if norm_before == 0.0:
            continue
        for _ in range(2):
            for q in range(kept):
                dot = 0.0
                for i in range(size):
                    dot += t.g[q, i] * t.g[r, i]
                for i in range(size):
                    t.g[r, i] -= dot * t.g[q, i]
                t.value[r] -= dot * t.value[q]
        norm = 0.0
        for i in range(size):
            norm += t.g[r, i] * t.g[r, i]
        if norm <= SINGULAR * norm_before:
            continue
        norm = sqrt(norm)
        for i in range(size):
            t.g[kept, i] = t.g[r, i] / norm
        t.value[kept] = t.value[r] / norm
        kept += 1
    for q in range(kept):
        dot = t.value[q]
        for i in range(size):
            dot += t.g[q, i] * t.change[i]
        for i in range(size):
            t.change[i] -= dot * t.g[q, i]
    for i in range(size - 1, -1, -1):
        total = t.change[i]
        for k in range(i + 1, size):
            total -= t.h[k, i] * t.change[k]
        t.change[i] = total / t.h[i, i]


@inlined
def add_ties(t, n, ties):
    """Add the equations of all ties; return the number of rows, negative where one has no equation."""
    rows = 0
    for k in range(ties):
        rows = add_tie(t, n, t.tie_first[k], t.tie_first[k + 1], rows)
        if rows < 0:
            break
    return rows


@inlined
def add_meetings(t, n, meetings, rows):
    """Add the equations of all meetings behind ``rows`` others; return as ``add_ties`` does."""
    for k in range(meetings):
        rows = add_meeting(t, n, k, rows)
        if rows < 0:
            break
    return rows


@compiled
def solve(t, n, ties, meetings, samples):
    """Move the corners until ties and meetings hold exactly; returns whether they do."""
    exact = t.sizes[EXACT]
    fits = int(t.sizes[FITS])
    for turn in range(MOST_STEPS + fits):
        if not set_sides(t, n):
            return FAILED
        rows = add_ties(t, n, ties)
        if rows < 0:
            return FAILED
        worst = 0.0
        for r in range(rows):
            worst = max(worst, abs(t.value[r]))
        exact_rows = rows
        rows = add_meetings(t, n, meetings, rows)
        if rows < 0:
            return FAILED
        worst_miss = 0.0
        for r in range(exact_rows, rows):
            worst_miss = max(worst_miss, abs(t.value[r]))
        if turn >= fits and worst <= exact and worst_miss <= 100 * exact:
            return SOLVED
        if turn < max(fits, 1):
            add_fit(t, n, samples)
            if not factor(t, 2 * n):
                return FAILED
        if turn >= fits:  # nothing but the constraints: the least change, measured as before
            for i in range(2 * n):
                t.slope[i] = 0.0
        step(t, n, rows)
        longest = 0.0
        for i in range(2 * n):
            longest = max(longest, abs(t.change[i]))
        if not longest < 60.0:
            return FAILED
        for k in range(n):
            t.x[k] += t.change[2 * k]
            t.y[k] += t.change[2 * k + 1]
        if turn == fits - 1:
            if not set_sides(t, n):
                return FAILED
            if deviation_of_samples(t, n, samples) > 2.0 * t.sizes[TOLERANCE]:
                return FAILED
    return FAILED


@compiled
def deviation_of_samples(t, n, samples):
    """Return how far the drawing's points are from the outline at most."""
    worst = 0.0
    for s in range(samples):
        nearest_side(t, n, t.sample_x[s], t.sample_y[s], t.node)
        worst = max(worst, t.node[0])
    return worst


@compiled
def foot_on_drawing(t, px, py, out):
    """Return how far a point is from the drawing; infinite where that is much more than the tolerance.

    ``out`` gets the nearest point of the drawing.
    """
    column = int((px - t.grid[0]) / t.grid[2])
    row = int((py - t.grid[1]) / t.grid[2])
    columns, rows = int(t.grid[3]), int(t.grid[4])
    if column < 0 or row < 0 or column >= columns or row >= rows:
        return inf
    cell = row * columns + column
    best = inf
    for i in range(t.cell_first[cell], t.cell_first[cell + 1]):
        k = t.cell_item[i]
        x, y, dx, dy = t.line[k, 0], t.line[k, 1], t.line[k, 2], t.line[k, 3]
        u = ((px - x) * dx + (py - y) * dy) / (dx * dx + dy * dy)
        u = min(1.0, max(0.0, u))
        away_x, away_y = px - x - u * dx, py - y - u * dy
        distance = away_x * away_x + away_y * away_y
        if distance < best:
            best = distance
            out[0], out[1] = x + u * dx, y + u * dy
    return sqrt(best)


@compiled
def deviation(t, n, samples, most):
    """Return the distance between outline and drawing, both ways, on the sheet; infinite if more than ``most``."""
    if not set_sides(t, n):
        return inf
    worst = deviation_of_samples(t, n, samples)
    if worst > most:
        return inf
    width, height = t.sizes[WIDTH], t.sizes[HEIGHT]
    for k in range(n):
        f = t.following[k]
        pieces = int(t.length[k] / 1.5) + 1
        for p in range(pieces):
            part = p / pieces
            x, y = t.x[k] + part * (t.x[f] - t.x[k]), t.y[k] + part * (t.y[f] - t.y[k])
            if 0 <= x <= width and 0 <= y <= height:
                away = foot_on_drawing(t, x, y, t.node)
                if away > most:
                    return inf
                worst = max(worst, away)
    return worst


@compiled
def set_distances(t, n, samples):
    """Set how far the drawing's points are from the outline, and its corners from the drawing; returns the largest.

    ``t.row`` gets a row for each: the distance, the part of the side where the outline is nearest, and the direction in
    which the distance grows; ``t.row_side`` the side. Infinite where a corner is much farther off than the tolerance.
    """
    width, height = t.sizes[WIDTH], t.sizes[HEIGHT]
    worst = 0.0
    for s in range(samples + n):
        if s < samples:
            px, py = t.sample_x[s], t.sample_y[s]
            k = nearest_side(t, n, px, py, t.node)
            off, part = t.node[0], t.node[1]
            x, y = -t.dy[k], t.dx[k]
            if (part == 0.0 or part == 1.0) and off > 1e-9:
                corner = k if part == 0.0 else t.following[k]
                x, y = (t.x[corner] - px) / off, (t.y[corner] - py) / off
            elif (t.x[k] - px) * x + (t.y[k] - py) * y < 0:
                x, y = -x, -y
        else:
            k = s - samples
            x, y, off, part = 0.0, 0.0, 0.0, 0.0
            if 0 <= t.x[k] <= width and 0 <= t.y[k] <= height:
                off = foot_on_drawing(t, t.x[k], t.y[k], t.node)
                if off == inf:
                    return inf
                if off > 1e-9:
                    x, y = (t.x[k] - t.node[0]) / off, (t.y[k] - t.node[1]) / off
        t.row_side[s] = k
        t.row[s, 0], t.row[s, 1], t.row[s, 2], t.row[s, 3] = off, part, x, y
        worst = max(worst, off)
    return worst


@inlined
def reweigh(t, count, worst):
    """Give points that are far off after ``t.change`` more weight, and the others less; the mean weight is 1."""
    total = 0.0
    for s in range(count):
        i, j = 2 * t.row_side[s], 2 * t.following[t.row_side[s]]
        part, x, y = t.row[s, 1], t.row[s, 2], t.row[s, 3]
        off = t.row[s, 0] + (1 - part) * (x * t.change[i] + y * t.change[i + 1])
        off += part * (x * t.change[j] + y * t.change[j + 1])
        t.row[s, 4] *= abs(off) + LEAST_SHARE * worst
        total += t.row[s, 4]
    for s in range(count):
        t.row[s, 4] *= count / total


@inlined
def add_distances(t, n, count):
    """Set up the least squares of the weighted distances: matrix ``t.h`` and slope ``t.slope``."""
    clear_fit(t, n)
    for s in range(count):
        i, j = 2 * t.row_side[s], 2 * t.following[t.row_side[s]]
        off, part, weight = t.row[s, 0], t.row[s, 1], t.row[s, 4]
        one = 1 - part
        for c in range(2):
            a = weight * t.row[s, 2 + c]
            t.slope[i + c] += off * one * a
            t.slope[j + c] += off * part * a
            for d in range(2):
                b = t.row[s, 2 + d]
                t.h[i + c, i + d] += one * one * a * b
                t.h[i + c, j + d] += one * part * a * b
                t.h[j + c, i + d] += part * one * a * b
                t.h[j + c, j + d] += part * part * a * b


@compiled
def tighten(t, n, ties, meetings, samples):
    """Move the corners so that the largest distance from the drawing gets less, while ties and meetings hold nearly.

    Returns whether it is within the tolerance then. The weights of the least squares are multiplied by the distances,
    so that what is farthest off counts more and more (C. L. Lawson, "Contributions to the theory of linear least
    maximum approximation", 1961).
    """
    size, count = 2 * n, samples + n
    tolerance = t.sizes[TOLERANCE]
    for s in range(count):
        t.row[s, 4] = 1.0
    for turn in range(MOST_TIGHTENED):
        if not set_sides(t, n):
            return FAILED
        worst = set_distances(t, n, samples)
        if worst == inf or (turn >= HOPELESS_AFTER and worst > HOPELESS * tolerance):
            return FAILED
        rows = add_ties(t, n, ties)
        if rows < 0:
            return FAILED
        rows = add_meetings(t, n, meetings, rows)
        if rows < 0:
            return FAILED
        failing = 0.0
        for r in range(rows):
            failing = max(failing, abs(t.value[r]))
            t.kept_value[r] = t.value[r]
            for i in range(size):
                t.kept_g[r, i] = t.g[r, i]
        if worst <= TIGHT * tolerance and failing <= NEARLY:
            return SOLVED
        for i in range(size):
            t.change[i] = 0.0
        for _ in range(REWEIGHTED):
            reweigh(t, count, worst)
            add_distances(t, n, count)
            if not factor(t, size):
                return FAILED
            for r in range(rows):
                t.value[r] = t.kept_value[r]
                for i in range(size):
                    t.g[r, i] = t.kept_g[r, i]
            step(t, n, rows)
        longest = 0.0
        for i in range(size):
            longest = max(longest, abs(t.change[i]))
        if not isfinite(longest):
            return FAILED
        part = min(1.0, LONGEST_STEP * tolerance / max(longest, 1e-9))
        for k in range(n):
            t.x[k] += part * t.change[2 * k]
            t.y[k] += part * t.change[2 * k + 1]
    return FAILED


@compiled
def is_simple(t, n):
    """Return whether no two sides cross or touch, and no corner is too sharp."""
    for i in range(n):
        fi = t.following[i]
        ax, ay, bx, by = t.x[i], t.y[i], t.x[fi], t.y[fi]
        low_x, high_x, low_y, high_y = min(ax, bx), max(ax, bx), min(ay, by), max(ay, by)
        dx, dy = bx - ax, by - ay
        for j in range(i + 1, n):
            fj = t.following[j]
            cx, cy, ex, ey = t.x[j], t.y[j], t.x[fj], t.y[fj]
            if max(cx, ex) < low_x or min(cx, ex) > high_x or max(cy, ey) < low_y or min(cy, ey) > high_y:
                continue
            if fi == j or fj == i:
                continue
            one = dx * (cy - ay) - dy * (cx - ax)
            other = dx * (ey - ay) - dy * (ex - ax)
            if (one > 0 and other > 0) or (one < 0 and other < 0):
                continue
            gx, gy = ex - cx, ey - cy
            one = gx * (ay - cy) - gy * (ax - cx)
            other = gx * (by - cy) - gy * (bx - cx)
            if (one > 0 and other > 0) or (one < 0 and other < 0):
                continue
            return False
        # the turn at the end of this side
        k = t.following[fi]
        ex, ey = t.x[k] - bx, t.y[k] - by
        dot = dx * ex + dy * ey
        area = dx * ey - dy * ex
        if dot < 0 and abs(area) < 0.03 * -dot:
            return False
    return True
