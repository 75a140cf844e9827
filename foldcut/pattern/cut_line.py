"""Where the boundary of a shape lands when the sheet is folded, and what is inside it."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Floats, Ints, Numbers
from foldcut.core.model import CreasePattern, Shape
from foldcut.geometry.planar_graph import edge_faces, half_edges
from foldcut.pattern.face_maps import FaceMaps


def fold_boundary(
    pattern: CreasePattern, maps: FaceMaps, shape: Shape, tolerance: float
) -> tuple[Floats, Indices, Floats]:
    """Return the shape's boundary in pieces within one face each: their ends, faces, and where the ends land.

    ``(n, 2, 2)`` mm on the sheet, ``(n,)``, and ``(n, 2, 2)`` in the frame of ``maps``; ``tolerance`` in mm.
    """
    sides = sides_of(shape)
    near = edges_near(pattern, sides, tolerance)
    return fold_pieces(pattern, edge_faces(pattern), maps, sides, near, tolerance)


def contains(shape: Shape, points: Floats) -> Bools:
    """Return whether points are inside: in an odd number of loops."""
    depth = np.zeros(len(points), dtype=np.intp)
    for loop in shape.loops:
        polygon = shapely.Polygon(loop)
        shapely.prepare(polygon)
        depth += shapely.contains_xy(polygon, points)
    odd: Bools = depth % 2 == 1
    return odd


Indices = NDArray[np.intp]


BATCH = 1 << 16
"""Edges looked at together; bounds the memory, not the result."""


def fold_pieces(
    pattern: CreasePattern,
    faces_of_edges: Ints,
    maps: FaceMaps,
    sides: Floats,
    near: tuple[Indices, Indices],
    tolerance: float,
) -> tuple[Floats, Indices, Floats]:
    """Do as ``fold_boundary``; ``near`` are sides and the edges near them."""
    side, edge = near
    ends = pattern.vertices_coords[pattern.edges_vertices[edge]]
    close = shapely.dwithin(shapely.linestrings(sides)[side], shapely.linestrings(ends), tolerance)
    side, edge = side[close], edge[close]
    pieces, ending = _divide(pattern, sides, side, edge, tolerance)
    middles = pieces.mean(axis=1)
    # most pieces are well within a face at an edge that they end at
    beside = np.where(ending[:, :, None] >= 0, faces_of_edges[ending], np.int32(-1)).reshape(-1, 4)
    depth = np.stack([face_depths(pattern, middles, face) for face in beside.T], axis=1)
    best = depth.argmax(axis=1)
    rows = np.arange(len(best))
    faces = beside[rows, best].astype(np.intp)
    rest = np.flatnonzero(depth[rows, best] <= tolerance)
    if len(rest):
        # the others lie in a face at one of these edges, but for sides that no edge comes near
        around = np.unique(faces_of_edges[edge]) if len(np.unique(side)) == len(sides) else np.empty(0, dtype=np.int32)
        faces[rest] = _faces_at(pattern, middles[rest], around[around >= 0] if len(around) else None)
    return pieces, faces, np.stack([maps.apply(faces, pieces[:, end]) for end in (0, 1)], axis=1)


def edges_near(
    pattern: CreasePattern, sides: Floats, distance: float, among: Indices | None = None
) -> tuple[Indices, Indices]:
    """Return the sides and edges, all or some, that come within a distance of each other, in pairs."""
    edges = pattern.edges_vertices if among is None else pattern.edges_vertices[among]
    tree = shapely.STRtree(shapely.linestrings(pattern.vertices_coords[edges]))
    side, edge = tree.query(shapely.linestrings(sides), predicate="dwithin", distance=distance)
    return side, edge if among is None else among[edge]


def edges_in_boxes(pattern: CreasePattern, sides: Floats, distance: float) -> tuple[Indices, Indices]:
    """Return few sides and the edges whose boxes come within a distance of theirs, in pairs."""
    low, high = sides.min(axis=1) - distance, sides.max(axis=1) + distance
    side, edge = [], []
    for first in range(0, len(pattern.edges_vertices), BATCH):
        edges = pattern.edges_vertices[first : first + BATCH]
        one, other = pattern.vertices_coords[edges[:, 0]], pattern.vertices_coords[edges[:, 1]]
        left, right = np.minimum(one[:, 0], other[:, 0]), np.maximum(one[:, 0], other[:, 0])
        for number in range(len(sides)):
            (x_low, y_low), (x_high, y_high) = low[number], high[number]
            meet = np.flatnonzero((left <= x_high) & (right >= x_low))
            bottom, top = np.minimum(one[meet, 1], other[meet, 1]), np.maximum(one[meet, 1], other[meet, 1])
            meet = meet[(bottom <= y_high) & (top >= y_low)]
            side.append(np.full(len(meet), number))
            edge.append(first + meet)
    return np.concatenate(side), np.concatenate(edge)


def sides_of(shape: Shape) -> Floats:
    """Return the sides of all loops, ``(n, 2, 2)``."""
    starts = np.concatenate(shape.loops)
    return np.stack([starts, np.concatenate([np.roll(loop, -1, axis=0) for loop in shape.loops])], axis=1)


def _divide(
    pattern: CreasePattern, sides: Floats, side: Indices, edge: Indices, tolerance: float
) -> tuple[Floats, Indices]:
    """Return the sides cut up where they meet edges of the pattern, ``(n, 2, 2)``: each within one face.

    And an edge at either end, ``(n, 2)``, -1 for none. ``side`` and ``edge`` are those that come within the
    tolerance of each other.

    A piece may lie on an edge that is not folded; then it belongs to either face.
    """
    ends = pattern.vertices_coords[pattern.edges_vertices[edge]]
    base, along = sides[side, 0], sides[side, 1] - sides[side, 0]
    across = ends[:, 1] - ends[:, 0]
    to_edge = ends - base[:, None]
    slope = along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        meet = (to_edge[:, 0, 0] * across[:, 1] - to_edge[:, 0, 1] * across[:, 0]) / slope
    length_squared = (along**2).sum(axis=1)
    # The ends count as well: the quotient says little when side and edge are nearly parallel.
    near = (to_edge * along[:, None]).sum(axis=2) / length_squared[:, None]
    at = np.concatenate([meet, near[:, 0], near[:, 1], np.zeros(len(sides)), np.ones(len(sides))])
    owner = np.concatenate([side, side, side, np.arange(len(sides)), np.arange(len(sides))])
    by = np.concatenate([edge, edge, edge, np.full(2 * len(sides), -1)])
    inside = np.flatnonzero((at >= 0) & (at <= 1))
    order = inside[np.lexsort((at[inside], owner[inside]))]
    at, owner, by = at[order], owner[order], by[order]
    same = owner[1:] == owner[:-1]
    start, stop, owner = at[:-1][same], at[1:][same], owner[1:][same]
    ending = np.stack([by[:-1][same], by[1:][same]], axis=1)
    base, along = sides[owner, 0], sides[owner, 1] - sides[owner, 0]
    pieces = np.stack([base + start[:, None] * along, base + stop[:, None] * along], axis=1)
    kept = (stop - start) * np.hypot(*along.T) > 1e-3 * tolerance
    return pieces[kept], ending[kept]


def face_depths(pattern: CreasePattern, points: Floats, faces: Numbers) -> Floats:
    """Return how far each point is on the inner side of all sides of its face: negative where it may be outside."""
    depths = np.full(len(points), -np.inf)
    at = np.flatnonzero(faces >= 0)
    rings = pattern.faces_vertices.take(faces[at])
    start, end = half_edges(rings)
    base = pattern.vertices_coords[start]
    along = pattern.vertices_coords[end] - base
    away = points[at][rings.rows] - base
    height = (along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0]) / np.hypot(*along.T)
    if len(at):
        depths[at] = np.minimum.reduceat(height, rings.offsets[:-1])
    return depths


def _faces_at(pattern: CreasePattern, points: Floats, around: Ints | None) -> Indices:
    """Return a face at each point, one of ``around``: the one it is in, or one it borders."""
    number = np.arange(len(pattern.faces_vertices)) if around is None else around
    return np.asarray(number[shapely.STRtree(face_polygons(pattern, number)).nearest(shapely.points(points))])


def face_polygons(pattern: CreasePattern, number: Numbers) -> NDArray[np.object_]:
    """Return faces as polygons."""
    faces = pattern.faces_vertices.take(number)
    rings = shapely.linearrings(pattern.vertices_coords[faces.values], indices=faces.rows)
    return np.asarray(shapely.polygons(rings))
