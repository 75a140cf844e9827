"""Plane graphs to make straight skeletons of: many kinds of random ones by seed, and curves of any size.

A graph is ``points`` ``(n, 2)`` and ``edges`` ``(m, 2)``, straight edges that meet at their ends only. Every point
has an edge.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import minimum_spanning_tree
from scipy.spatial import Delaunay

from foldcut.core.arrays import Floats
from support.strategies import unit_point

Edges = NDArray[np.int64]
Graph = tuple[Floats, Edges]
Random = np.random.Generator

MAX_TRIES = 200


def random_graph(seed: int) -> Graph:
    """Return a random plane graph, mostly with 5 to 60 corners; the kinds take turns."""
    for attempt in range(MAX_TRIES):
        points, edges = KINDS[seed % len(KINDS)](np.random.default_rng([seed, attempt]))
        if is_plane(points, edges):
            return points, edges
    raise AssertionError(f"no plane graph for seed {seed}, a {kind_of(seed)}")


def kind_of(seed: int) -> str:
    """Return the name of the kind of graph that a seed gives."""
    return KINDS[seed % len(KINDS)].__name__


def is_plane(points: Floats, edges: Edges) -> bool:
    """Return whether every point has an edge, points are apart, and edges meet at their ends only."""
    if len(edges) == 0 or (edges[:, 0] == edges[:, 1]).any() or set(edges.ravel().tolist()) != set(range(len(points))):
        return False
    if len(np.unique(points, axis=0)) != len(points):
        return False
    lines = shapely.linestrings(points[edges])
    pairs = shapely.STRtree(lines).query(lines, predicate="intersects").T
    for one, other in pairs[pairs[:, 0] < pairs[:, 1]].tolist():
        shared = set(edges[one].tolist()) & set(edges[other].tolist())
        if len(shared) != 1:
            return False
        middle = shared.pop()
        a, b = (_exact(points[edges[k].sum() - middle]) - _exact(points[middle]) for k in (one, other))
        if a[0] * b[1] == a[1] * b[0] and a @ b > 0:
            return False
    return True


def _exact(point: Floats) -> NDArray[np.object_]:
    return np.array([Fraction(value) for value in point.tolist()])


def of_loops(loops: Sequence[ArrayLike]) -> Graph:
    """Return the graph of closed loops; places where loops touch become one point."""
    return joined([(np.array(loop, dtype=float), _cycle(len(np.array(loop)))) for loop in loops])


def of_paths(paths: Sequence[ArrayLike]) -> Graph:
    """Return the graph of open paths; places where they touch become one point."""
    return joined([(np.array(path, dtype=float), _cycle(len(np.array(path)))[:-1]) for path in paths])


def joined(graphs: Sequence[Graph]) -> Graph:
    """Return graphs as one; equal points become one, and points without an edge go."""
    before = np.cumsum([0, *(len(points) for points, _ in graphs)])
    points = np.concatenate([points for points, _ in graphs])
    edges = np.concatenate([edges + first for first, (_, edges) in zip(before[:-1], graphs, strict=True)])
    _, first, number = np.unique(points, axis=0, return_index=True, return_inverse=True)
    edges = first[number.ravel()][edges]  # every point is the first that lies there
    used, renumbered = np.unique(edges, return_inverse=True)
    return points[used], renumbered.reshape(edges.shape)


def turned(graph: Graph, angle: float, scale: float = 1.0, shift: tuple[float, float] = (0.0, 0.0)) -> Graph:
    """Return a graph turned counter-clockwise by an angle in radians, scaled, then shifted; coordinates are rounded."""
    points, edges = graph
    turn = np.array([(math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))])
    return scale * (points @ turn) + shift, edges


def _cycle(count: int) -> Edges:
    return np.stack([np.arange(count), (np.arange(count) + 1) % count], axis=1)


def _polar(radii: ArrayLike, angles: ArrayLike) -> Floats:
    return np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)


def _loop(rng: Random, count: int, least: float, radius: float = 1.0) -> Floats:
    """Return a star-shaped loop around the origin whose corners are ``least`` to 1 times the radius away."""
    angles = math.tau * (np.arange(count) + 0.8 * rng.random(count)) / count
    return _polar(radius * rng.uniform(least, 1, count), angles)


# --- the kinds ---------------------------------------------------------------------------------------------------


def star_shaped(rng: Random) -> Graph:
    return of_loops([_loop(rng, int(rng.integers(3, 41)), rng.choice([0.1, 0.5, 0.9]), 10.0)])


def holes_and_islands(rng: Random) -> Graph:
    """Loops in a loop, and loops in these."""
    loops = [_loop(rng, int(rng.integers(4, 20)), 0.9, 10.0)]
    places = np.array([(0, 0), (5, 0), (-5, 0), (0, 5), (0, -5)]) + rng.uniform(-0.5, 0.5, (5, 2))
    for place in rng.permutation(places)[: rng.integers(1, 6)]:
        loops.append(place + _loop(rng, int(rng.integers(3, 9)), 0.7, 2.0))
        if rng.random() < 0.5:
            loops.append(place + _loop(rng, int(rng.integers(3, 6)), 0.4, 0.4))
    return of_loops(loops)


def grid_polygon(rng: Random) -> Graph:
    """A star-shaped polygon with whole coordinates: many events at one time."""
    corners = np.round(_loop(rng, int(rng.integers(4, 24)), 0.3, float(rng.integers(3, 12))))
    return of_loops([corners[(corners != np.roll(corners, 1, axis=0)).any(axis=1)]])


def polyomino(rng: Random) -> Graph:
    """The outline of cells of a grid; cells may touch in corners, or lie around a hole."""
    cells = {(0, 0)}
    for _ in range(int(rng.integers(3, 25))):
        x, y = sorted(cells)[rng.integers(len(cells))]
        dx, dy = rng.choice([(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1)], p=[0.24, 0.24, 0.24, 0.24, 0.04])
        cells.add((int(x + dx), int(y + dy)))
    paths = []
    for x, y in sorted(cells):
        corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1), (x, y)]
        around = [(x, y - 1), (x + 1, y), (x, y + 1), (x - 1, y)]
        paths += [side for side, cell in zip(pairwise(corners), around, strict=True) if cell not in cells]
    graph = of_paths(paths)
    return graph if rng.random() < 0.3 else straightened(graph)


def straightened(graph: Graph) -> Graph:
    """Return a graph with whole coordinates without its corners of 180 degrees."""
    points, edges = graph
    at: list[set[int]] = [set() for _ in points]
    for a, b in edges.tolist():
        at[a].add(b)
        at[b].add(a)
    for middle, others in enumerate(at):
        if len(others) == 2:
            a, b = others
            one, other = points[a] - points[middle], points[b] - points[middle]
            if one[0] * other[1] == one[1] * other[0] and one @ other < 0:
                at[a] = at[a] - {middle} | {b}
                at[b] = at[b] - {middle} | {a}
                others.clear()
    left = np.array([(a, b) for a, others in enumerate(at) for b in sorted(others) if a < b])
    return joined([(points, left)])


def turned_grid(rng: Random) -> Graph:
    """A polyomino or a polygon on a grid at an angle: what was simultaneous differs by rounding."""
    return turned((polyomino, grid_polygon)[rng.integers(2)](rng), rng.uniform(0, math.tau), rng.uniform(0.3, 3))


def regular(rng: Random) -> Graph:
    """A regular polygon, or several in each other."""
    count = int(rng.integers(3, 25))
    corners = np.array([unit_point(k, count) for k in range(count)])
    graph = of_loops([corners * 2.0**k for k in range(rng.integers(1, 4))])
    return graph if rng.random() < 0.5 else turned(graph, rng.uniform(0, 1), rng.uniform(0.1, 10))


def comb(rng: Random) -> Graph:
    """A bar with teeth on one side or on two."""
    count = int(rng.integers(2, 8))
    width, gap, height = rng.integers(1, 4, 3) if rng.random() < 0.5 else rng.uniform(0.3, 3, 3)

    def teeth(base: float, up: float) -> list[tuple[float, float]]:
        found = []
        for k in range(count):
            tip = base + up * (height if even else rng.uniform(0.5, 2) * height)
            left = k * (width + gap)
            found += [(left, base), (left, tip), (left + width, tip), (left + width, base)]
        return found

    even = rng.random() < 0.5
    upper = teeth(1.0, 1.0)[::-1]
    lower = teeth(0.0, -1.0) if rng.random() < 0.5 else [(0.0, 0.0), (upper[0][0], 0.0)]
    return turned(of_loops([lower + upper]), rng.choice([0.0, 0.0, rng.uniform(0, math.tau)]))


def needles(rng: Random) -> Graph:
    """Very thin triangles, apart or as the spikes of one polygon."""
    thin = 10.0 ** rng.uniform(-7, -1.5)
    if rng.random() < 0.5:
        count = int(rng.integers(1, 7))
        each = [np.array([(0, 0), (rng.uniform(2, 8), rng.uniform(-1, 1) * thin), (0, thin)]) for _ in range(count)]
        moved = [needle + np.array([rng.uniform(-1, 1), k + 0.4 * rng.random()]) for k, needle in enumerate(each)]
        return of_loops([turned((needle, _cycle(3)), rng.uniform(0, 0.04))[0] for needle in moved])
    count = int(rng.integers(3, 12))
    angles = np.repeat(math.tau * (np.arange(count) + 0.3 * rng.random(count)) / count, 3)
    angles += np.tile([-thin, 0, thin], count)
    return of_loops([_polar(np.tile([1, 6, 1], count), angles)])


def nearly_collinear(rng: Random) -> Graph:
    """A polygon with corners of nearly 180 degrees."""
    corners = _loop(rng, int(rng.integers(3, 10)), 0.4, 10.0)
    bent = []
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        bent.append(a)
        for share in np.sort(rng.uniform(0.1, 0.9, rng.integers(0, 4))):
            off = rng.choice([0, 1, -1]) * 10.0 ** rng.uniform(-15, -3)
            bent.append(a + share * (b - a) + off * np.array([a[1] - b[1], b[0] - a[0]]))
    return of_loops([bent])


def nearly_parallel(rng: Random) -> Graph:
    """A polyomino or a comb whose corners are a little off the grid."""
    points, edges = (polyomino, comb, grid_subdivision)[rng.integers(3)](rng)
    return points + 10.0 ** rng.uniform(-15, -3) * rng.uniform(-1, 1, points.shape), edges


def open_paths(rng: Random) -> Graph:
    """Paths that do not close: on a grid, along a line, or zigzags."""
    count = int(rng.integers(3, 30))
    if rng.random() < 0.5:
        way, place = [(0, 0)], (0, 0)
        for _ in range(count):
            x, y = place
            free = [p for p in ((x + 1, y), (x, y + 1), (x - 1, y), (x, y - 1)) if p not in way]
            if not free:
                break
            place = free[rng.integers(len(free))]
            way.append(place)
        return of_paths([way])
    x = np.cumsum(rng.uniform(0.2, 2, count))
    y = rng.uniform(-3, 3, count) if rng.random() < 0.5 else np.resize([0.0, rng.uniform(1, 3)], count)
    return turned(of_paths([np.stack([x, y + 8 * k], axis=1) for k in range(rng.integers(1, 3))]), rng.uniform(0, 3))


def tree(rng: Random) -> Graph:
    """The shortest tree between random points, which may lie on a grid."""
    points = rng.uniform(0, 10, (int(rng.integers(3, 40)), 2))
    if rng.random() < 0.4:
        points = np.unique(np.round(points * rng.choice([0.5, 1])), axis=0)
    start, end = np.triu_indices(len(points), 1)
    lengths = np.hypot(*(points[start] - points[end]).T)
    found = minimum_spanning_tree(coo_array((lengths, (start, end)), shape=(len(points), len(points))))
    return joined([(points, np.stack(found.tocoo().coords, axis=1).astype(np.int64))])


def spokes(rng: Random) -> Graph:
    """Edges from one point, of any degree, at equal angles or not."""
    count = int(rng.integers(1, 13))
    angles = [
        math.tau * np.arange(count) / count,
        math.tau * rng.choice(24, count, replace=False) / 24,
        math.tau * np.sort(rng.random(count)),
    ][rng.integers(3)]
    tips = _polar(np.full(count, 2.0) if rng.random() < 0.5 else rng.uniform(0.5, 4, count), angles)
    return of_paths([[(0.0, 0.0), tip] for tip in tips])


def lone_edges(rng: Random) -> Graph:
    """Edges that touch nothing: at random, parallel, on one line, or on a grid."""
    count = int(rng.integers(1, 16))
    middles = np.stack(np.divmod(rng.choice(25, count, replace=False), 5), axis=1).astype(float)
    angles = [rng.uniform(0, math.pi, count), np.zeros(count), rng.choice([0.0, 1.0], count)][rng.integers(3)]
    reach = 0.1 + 0.3 * (rng.random(count) if rng.random() < 0.5 else np.ones(count))
    step = np.where(angles[:, None] == 1.0, (0.0, 1.0), _polar(np.ones(count), angles)) * reach[:, None]
    return of_paths(np.stack([middles - step, middles + step], axis=1))


def several_pieces(rng: Random) -> Graph:
    """Graphs of other kinds beside each other."""
    others = [kind for kind in KINDS if kind not in (several_pieces, subdivided)]
    pieces = []
    for place in rng.permutation([(0, 0), (1, 0), (0, 1), (1, 1)])[: rng.integers(2, 5)]:
        points, edges = others[rng.integers(len(others))](rng)
        low, high = points.min(axis=0), points.max(axis=0)
        scale = 1 / (1.1 * max(high - low))
        pieces.append(((points - low) * scale + place, edges))
    return joined(pieces)


def subdivided(rng: Random) -> Graph:
    """A graph of another kind with edges divided, in the middle or anywhere; middles on a grid are exact."""
    points, edges = (polyomino, grid_subdivision, star_shaped, spokes, regular)[rng.integers(5)](rng)
    share = 0.5 if rng.random() < 0.6 else rng.uniform(0.2, 0.8)
    chosen = rng.random(len(edges)) < 0.4
    a, b = edges[chosen].T
    new = len(points) + np.arange(len(a))
    halves = [np.stack([a, new], axis=1), np.stack([new, b], axis=1)]
    points = np.concatenate([points, points[a] + share * (points[b] - points[a])])
    return joined([(points, np.concatenate([edges[~chosen], *halves]))])


def triangulation(rng: Random) -> Graph:
    """Edges of the Delaunay triangulation of random points."""
    points = rng.uniform(0, 10, (int(rng.integers(4, 26)), 2))
    triangles = np.sort(Delaunay(points).simplices, axis=1)
    edges = np.unique(np.concatenate([triangles[:, pair] for pair in ([0, 1], [1, 2], [0, 2])]), axis=0)
    return joined([(points, edges[rng.random(len(edges)) < rng.choice([0.3, 0.6, 1.0])].astype(np.int64))])


def grid_subdivision(rng: Random) -> Graph:
    """Edges of a grid of squares."""
    width, height = rng.integers(2, 6, 2)
    number = np.arange(width * height).reshape(width, height)
    across = np.stack([number[:-1].ravel(), number[1:].ravel()], axis=1)
    up = np.stack([number[:, :-1].ravel(), number[:, 1:].ravel()], axis=1)
    edges = np.concatenate([across, up])
    points = np.stack(np.divmod(number.ravel(), height), axis=1).astype(float)
    return joined([(points, edges[rng.random(len(edges)) < rng.choice([0.5, 0.8, 1.0])])])


def snowflake(rng: Random) -> Graph:
    """A figure with the symmetries of a regular polygon: a star with several radii, or branches."""
    count = int(rng.choice([3, 4, 5, 6, 8]))
    if rng.random() < 0.5:
        radii = rng.uniform(0.4, 1, rng.integers(1, 4))
        arm = np.concatenate([radii, radii[-2::-1], [0.3]])
        total = count * len(arm)
        corners = np.array([unit_point(k, total) for k in range(total)])
        return of_loops([10 * corners * np.tile(arm, count)[:, None]])
    reach, twig = rng.uniform(0.3, 0.7), rng.uniform(0.05, 0.25)
    arm = np.array([(0.0, 0.0), (reach, 0.0), (1.0, 0.0), (reach + twig, twig), (reach + twig, -twig)])
    branches = np.array([(0, 1), (1, 2), (1, 3), (1, 4)])
    points = [(0.0, 0.0)]
    edges = []
    for k in range(count):
        x, y = unit_point(k, count)
        numbers = [0, *range(len(points), len(points) + 4)]
        points += [(x * u - y * v, y * u + x * v) for u, v in arm[1:].tolist()]
        edges += [(numbers[a], numbers[b]) for a, b in branches.tolist()]
    return np.array(points), np.array(edges)


def touching_loops(rng: Random) -> Graph:
    """Loops that share corners: a chain of diamonds, or triangles around a point."""
    count = int(rng.integers(2, 8))
    if rng.random() < 0.5:
        x = np.cumsum([0, *(rng.integers(1, 4, count) * 2 if rng.random() < 0.5 else rng.uniform(1, 4, count))])
        bulge = rng.uniform(0.3, 1.5, (count, 2)) if rng.random() < 0.5 else np.ones((count, 2))
        chain = zip(pairwise(x.tolist()), bulge.tolist(), strict=True)
        return of_loops([[(a, 0), ((a + b) / 2, -down), (b, 0), ((a + b) / 2, up)] for (a, b), (down, up) in chain])
    angles = math.tau * (np.arange(count)[:, None] + rng.uniform(0.1, 0.9) * np.array([0, 0.5, 1])) / count
    radii = [2.0, rng.uniform(1, 4), 2.0] if rng.random() < 0.5 else rng.uniform(0.5, 3, 3)
    return of_loops([np.concatenate([[(0.0, 0.0)], _polar(radii, around)]) for around in angles])


def spiral(rng: Random) -> Graph:
    """A band wound up, or a line: with right angles, or with more corners a turn."""
    turns, a_turn = int(rng.integers(1, 4)), int(rng.choice([4, 4, 5, 8, 11]))
    if a_turn == 4:
        gap = rng.choice([1.0, rng.uniform(0.5, 2)])
        place, way = np.zeros(2), [(0.0, 0.0)]
        for k in range(4 * turns):
            place = place + gap * 2 * (k // 2 + 1) * np.array([(1, 0), (0, 1), (-1, 0), (0, -1)][k % 4])
            way.append((float(place[0]), float(place[1])))
        if rng.random() < 0.4:
            return of_paths([way])
        band = shapely.LineString(way).buffer(gap * rng.choice([0.5, 0.25, 0.6]), cap_style="flat", join_style="mitre")
        return of_loops([shapely.get_coordinates(band.exterior)[:-1]])
    angles = math.tau * np.arange(turns * a_turn + 1) / a_turn
    outer, inner = _polar(1 + angles, angles), _polar(1 + angles - rng.uniform(0.5, 3), angles)
    return of_paths([outer]) if rng.random() < 0.4 else of_loops([np.concatenate([outer, inner[::-1]])])


def maze(rng: Random) -> Graph:
    return random_polygon(int(rng.integers(12, 61)), int(rng.integers(1 << 30)))


KINDS: tuple[Callable[[Random], Graph], ...] = (
    star_shaped,
    holes_and_islands,
    grid_polygon,
    polyomino,
    turned_grid,
    regular,
    comb,
    needles,
    nearly_collinear,
    nearly_parallel,
    open_paths,
    tree,
    spokes,
    lone_edges,
    several_pieces,
    subdivided,
    triangulation,
    grid_subdivision,
    snowflake,
    touching_loops,
    spiral,
    maze,
)


# --- curves of any size ------------------------------------------------------------------------------------------


def koch(corners: int) -> Graph:
    """Return the snowflake of Koch with as many corners, or up to two more, about 2 across.

    With 3, 12, 48, 192, 768, 3072, 12288, 49152 corners all its sides are equal; otherwise some are divided once more.
    """
    level = 0
    while 3 * 4 ** (level + 1) <= corners:
        level += 1
    size = 3 ** (level + 1)
    loop = np.array([(0, 0), (0, size), (size, 0)])  # in steps along two sides of a triangle: all whole numbers
    for _ in range(level):
        loop = _with_tips(loop, np.ones(len(loop), dtype=bool))
    more = np.zeros(len(loop), dtype=bool)
    count = math.ceil((corners - len(loop)) / 3)
    if count > 0:
        more[np.arange(count) * len(loop) // count] = True
    a, b = _with_tips(loop, more)[::-1].T / size
    return of_cycle(np.stack([2 * a + b, math.sqrt(3) * b], axis=1))


def _with_tips(loop: NDArray[np.int64], chosen: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Put a tip on the middle third of the chosen sides of a clockwise loop; its left is outside."""
    third = (np.roll(loop, -1, axis=0) - loop) // 3
    left = np.stack([-third[:, 1], third[:, 0] + third[:, 1]], axis=1)  # turned by 60 degrees
    four = np.stack([loop, loop + third, loop + third + left, loop + 2 * third], axis=1)
    return four[np.stack([np.ones_like(chosen), chosen, chosen, chosen], axis=1)]


def hilbert(corners: int) -> Graph:
    """Return a closed Hilbert curve (Moore's) through a grid with steps of 1, of the order next to so many corners.

    The orders have 4, 12, 52, 204, 820, 3276, 13108, 52428, 209716 corners; none where it goes straight on.
    """
    level = 1
    curve = np.zeros(1, dtype=complex)
    loops = []
    while len(loops) == 0 or len(loops[-1]) < corners:
        side = 2.0 ** (level - 1)
        loops.append(_moore(curve, side))
        # the next order of Hilbert's curve, from the lower left to the lower right
        mirrored = curve.real * 1j + curve.imag
        down = (side - 1) * (1 + 1j) - mirrored
        curve = np.concatenate([mirrored, curve + 1j * side, curve + side * (1 + 1j), down + side])
        level += 1
    best = min(loops, key=lambda loop: abs(math.log(len(loop) / corners)))
    return of_cycle(np.stack([best.real, best.imag], axis=1))


def _moore(curve: NDArray[np.complex128], side: float) -> NDArray[np.complex128]:
    """Close four of Hilbert's curves to a loop, and leave out the points where it goes straight on."""
    up = (side - 1) + 1j * curve  # from the lower right to the upper right
    up, down = up, (side - 1) * (1 + 1j) - up
    loop = np.concatenate([up, up + 1j * side, down + side * (1 + 1j), down + side])
    before, after = loop - np.roll(loop, 1), np.roll(loop, -1) - loop
    return loop[before != after]


def random_polygon(corners: int, seed: int) -> Graph:
    """Return a random simple polygon with so many corners, at least 4 and up to three fewer: the way around a tree.

    Its corners are those of a grid with steps of 1, each moved by up to 0.3 to the right or left and up or down.
    """
    rng = np.random.default_rng(seed)
    width = max(1, math.isqrt(corners // 4))
    cells = np.arange(corners // 4)
    x, y = cells % width, cells // width
    right = cells[(x + 1 < width) & (cells + 1 < len(cells))]
    up = cells[cells + width < len(cells)]
    tree_edges = np.concatenate([np.stack([right, right + 1], axis=1), np.stack([up, up + width], axis=1)])
    weights = rng.uniform(1, 2, len(tree_edges))
    matrix = coo_array((weights, tuple(tree_edges.T)), shape=(len(cells), len(cells)))
    start, end = minimum_spanning_tree(matrix).tocoo().coords
    start, end = np.minimum(start, end), np.maximum(start, end)
    # each cell has four corners, counter-clockwise from its lower left; the way goes on from each to the next of its
    # cell, or, where the tree passes between these, to the neighbour's corner
    following = 4 * cells[:, None] + np.array([1, 2, 3, 0])
    level = (end == start + 1) & (width > 1)
    a, b = start[level], end[level]
    following[a, 1], following[b, 3] = 4 * b, 4 * a + 2
    a, b = start[~level], end[~level]
    following[a, 2], following[b, 0] = 4 * b + 1, 4 * a + 3
    lower_left = 2 * np.stack([x, y], axis=1)
    places = (lower_left[:, None] + np.array([(0, 0), (1, 0), (1, 1), (0, 1)])).reshape(-1, 2)
    places = places + rng.uniform(-0.3, 0.3, places.shape)
    flat, way = following.ravel().tolist(), [0]
    while flat[way[-1]] != 0:
        way.append(flat[way[-1]])
    return of_cycle(places[way])


def of_cycle(corners: Floats) -> Graph:
    """Return the graph of one loop, with its corners in order."""
    return corners, _cycle(len(corners))
