"""A second opinion on layers: all pairs, in plain Python and shapely, sharing nothing with the verifier."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import shapely

from foldcut.core.arrays import Floats, Ints
from foldcut.core.model import CreasePattern

NEAR = 1e-6


def slow_check(pattern: CreasePattern, layers: Ints) -> set[str]:
    """Return the checks that the layer order fails, of a pattern that is planar and closes up."""
    rings = pattern.faces_vertices.to_lists()
    edges = {
        frozenset(edge): letter
        for edge, letter in zip(pattern.edges_vertices.tolist(), pattern.edges_assignment, strict=True)
    }
    beside: dict[frozenset[int], list[int]] = {edge: [] for edge in edges}
    for face, ring in enumerate(rings):
        for side in zip(ring, ring[1:] + ring[:1], strict=True):
            beside[frozenset(side)].append(face)
    maps = _fold(pattern.vertices_coords, edges, beside)
    rank = {face: place for place, face in enumerate(np.asarray(layers).tolist())}
    place = {
        face: {v: maps[face] @ [*pattern.vertices_coords[v], 1.0] for v in ring} for face, ring in enumerate(rings)
    }
    polygons = [shapely.Polygon([place[face][v][:2] for v in ring]) for face, ring in enumerate(rings)]
    insides = [polygon.buffer(-NEAR) for polygon in polygons]
    up = [float(np.linalg.det(maps[face])) > 0 for face in range(len(rings))]

    failed = set()
    folds = []
    for edge, faces in beside.items():
        if len(faces) < 2:
            continue
        one, two = sorted(faces, key=lambda face: rank[face])
        letter = edges[edge]
        line = shapely.LineString([place[one][v][:2] for v in edge])
        folds.append((line, one, two, letter in "MV"))
        if letter in "MV" and (letter == "V") != (up[one] or not up[two]):
            failed.add("mountain-valley")
        for face in layers[rank[one] + 1 : rank[two]]:
            if insides[face].intersects(line):
                failed.add("taco-tortilla" if letter in "MV" else "tortilla-tortilla")
    for (line, a, b, folded), (other, c, d, other_folded) in combinations(folds, 2):
        overlap = line.intersection(other.buffer(NEAR, cap_style="flat"))
        if not _are_parallel(line, other) or overlap.length < 10 * NEAR:
            continue
        middle = shapely.get_coordinates(overlap).mean(axis=0)
        sides = [_side(polygons[face], line, middle) for face in (a, b, c, d)]
        failed |= _pair(sides, [rank[face] for face in (a, b, c, d)], folded, other_folded)
    return failed


def _pair(sides: list[int], ranks: list[int], folded: bool, other_folded: bool) -> set[str]:
    """Return what two coinciding edges do wrong, from their four faces' sides and layers."""
    a, b, c, d = ranks
    if folded and other_folded:
        crosses = (min(a, b) < c < max(a, b)) != (min(a, b) < d < max(a, b))
        return {"taco-taco"} if crosses and sides[0] == sides[2] else set()
    if not folded and not other_folded:
        if sides[0] != sides[2]:
            c, d = d, c
        return {"tortilla-tortilla"} if (a < c) != (b < d) else set()
    if not folded:
        sides, (a, b, c, d) = sides[2:] + sides[:2], (c, d, a, b)
    between = [rank for rank, side in zip((c, d), sides[2:], strict=True) if side == sides[0]]
    return {"taco-tortilla"} if any(min(a, b) < rank < max(a, b) for rank in between) else set()


def _are_parallel(line: shapely.LineString, other: shapely.LineString) -> bool:
    (ax, ay), (bx, by) = line.coords
    (cx, cy), (dx, dy) = other.coords
    sine = ((bx - ax) * (dy - cy) - (by - ay) * (dx - cx)) / (line.length * other.length)
    return abs(sine) < 1e-5


def _side(polygon: shapely.Polygon, line: shapely.LineString, at: Floats) -> int:
    """Return 1 for a polygon left of the line next to ``at``, -1 for one on the right."""
    (ax, ay), (bx, by) = line.coords
    normal = np.array([ay - by, bx - ax]) / line.length
    return 1 if polygon.distance(shapely.Point(at + 5 * NEAR * normal)) < NEAR else -1


def _fold(
    coords: Floats, edges: dict[frozenset[int], str], beside: dict[frozenset[int], list[int]]
) -> dict[int, Floats]:
    """Return a 3 x 3 matrix for every face."""
    maps = {0: np.eye(3)}
    waiting = [0]
    while waiting:
        here = waiting.pop(0)
        for edge, faces in beside.items():
            if here not in faces or len(faces) < 2:
                continue
            there = faces[0] if faces[1] == here else faces[1]
            if there in maps:
                continue
            mirror = np.eye(3)
            if edges[edge] in "MV":
                p, q = (coords[v] for v in edge)
                unit = (q - p) / np.hypot(*(q - p))
                mirror[:2, :2] = 2 * np.outer(unit, unit) - np.eye(2)
                mirror[:2, 2] = p - mirror[:2, :2] @ p
            maps[there] = maps[here] @ mirror
            waiting.append(there)
    return maps
