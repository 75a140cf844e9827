"""Where the boundary of a shape lands when its sheet is folded, and which points are inside the shape.

Pattern, maps of its faces and shape on the sheet -> the boundary in pieces, each within one face, and where each
piece lands. ``fold_boundary`` does it all. ``proof.cut``, which compares large patterns with the boundary only where
they come near it, calls the steps: ``sides_of``, ``edges_near`` or ``edges_in_boxes``, ``fold_pieces``.
"""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Floats, Indices, Ints, Numbers, blocks
from foldcut.core.model import CreasePattern, Shape, Sheet
from foldcut.geometry.planar_graph import edge_faces, half_edges
from foldcut.pattern.face_maps import FaceMaps

__all__ = [
    "contains",
    "edges_in_boxes",
    "edges_near",
    "face_depths",
    "face_polygons",
    "fold_boundary",
    "fold_pieces",
    "pieces_of",
    "sides_of",
    "sides_of_lines",
]

BATCH = 1 << 16
"""The number of edges handled at a time; it bounds the memory, not the result."""


def contains(shape: Shape, points: Floats) -> Bools:
    """Return which ``points``, ``(n, 2)``, are inside ``shape``: within an odd number of loops."""
    depth = np.zeros(len(points), dtype=np.intp)
    for loop in shape.loops:
        polygon = shapely.Polygon(loop)
        shapely.prepare(polygon)
        depth += shapely.contains_xy(polygon, points)
    odd: Bools = depth % 2 == 1
    return odd


def sides_of_lines(shape: Shape) -> Bools:
    """Return for each of a shape's lines whether the paper beside it is inside the shape, ``(n,)``."""
    return contains(shape, np.array([line[:2].mean(axis=0) for line in shape.lines]).reshape(-1, 2))


def pieces_of(shape: Shape, sheet: Sheet) -> list[shapely.Polygon]:
    """Return the pieces of the sheet that a cut along all loops and lines leaves, the largest first, as they lie flat.

    A slit that ends within a piece is not seen in it.
    """
    lines = [shapely.linestrings(stroke) for stroke in shape.strokes]
    divided = shapely.union_all([*lines, shapely.box(0, 0, sheet.width, sheet.height).exterior])
    pieces: list[shapely.Polygon] = list(shapely.get_parts(shapely.polygonize([divided])))
    return sorted(pieces, key=lambda piece: (-round(piece.area, 6), piece.bounds))


def fold_boundary(
    pattern: CreasePattern, maps: FaceMaps, shape: Shape, tolerance: float
) -> tuple[Floats, Indices, Floats]:
    """Return the boundary of the shape in pieces that lie within one face each.

    The result is the ends of the pieces on the sheet, ``(n, 2, 2)`` mm, their faces, ``(n,)``, and where the ends land,
    ``(n, 2, 2)`` in the frame of ``maps``. ``tolerance`` is in mm.
    """
    sides = sides_of(shape)
    near = edges_near(pattern, sides, tolerance)
    return fold_pieces(pattern, edge_faces(pattern), maps, sides, near, tolerance)


def sides_of(shape: Shape) -> Floats:
    """Return the sides of all loops, and then those of all lines, ``(n, 2, 2)``."""
    starts = [*shape.loops, *(line[:-1] for line in shape.lines)]
    ends = [*(np.roll(loop, -1, axis=0) for loop in shape.loops), *(line[1:] for line in shape.lines)]
    return np.stack([np.concatenate(starts), np.concatenate(ends)], axis=1)


def edges_near(
    pattern: CreasePattern, sides: Floats, distance: float, among: Indices | None = None
) -> tuple[Indices, Indices]:
    """Return all pairs of a side and an edge, of ``among`` if given, that come within ``distance`` of each other."""
    edges = pattern.edges_vertices if among is None else pattern.edges_vertices[among]
    tree = shapely.STRtree(shapely.linestrings(pattern.vertices_coords[edges]))
    side, edge = tree.query(shapely.linestrings(sides), predicate="dwithin", distance=distance)
    return side, edge if among is None else among[edge]


def edges_in_boxes(pattern: CreasePattern, sides: Floats, distance: float) -> tuple[Indices, Indices]:
    """Return all pairs of a side and an edge whose boxes come within ``distance`` of each other, for a few sides."""
    low, high = sides.min(axis=1) - distance, sides.max(axis=1) + distance
    side, edge = [], []
    for some in blocks(len(pattern.edges_vertices), BATCH):
        edges = pattern.edges_vertices[some]
        one, other = pattern.vertices_coords[edges[:, 0]], pattern.vertices_coords[edges[:, 1]]
        left, right = np.minimum(one[:, 0], other[:, 0]), np.maximum(one[:, 0], other[:, 0])
        for number in range(len(sides)):
            (x_low, y_low), (x_high, y_high) = low[number], high[number]
            meet = np.flatnonzero((left <= x_high) & (right >= x_low))
            bottom, top = np.minimum(one[meet, 1], other[meet, 1]), np.maximum(one[meet, 1], other[meet, 1])
            meet = meet[(bottom <= y_high) & (top >= y_low)]
            side.append(np.full(len(meet), number))
            edge.append(some.start + meet)
    return np.concatenate(side), np.concatenate(edge)


def fold_pieces(
    pattern: CreasePattern,
    faces_of_edges: Ints,
    maps: FaceMaps,
    sides: Floats,
    near: tuple[Indices, Indices],
    tolerance: float,
) -> tuple[Floats, Indices, Floats]:
    """Return ``sides`` in pieces as ``fold_boundary`` does; ``near`` are the pairs of a side and an edge near it."""
    side, edge = near
    ends = pattern.vertices_coords[pattern.edges_vertices[edge]]
    close = shapely.dwithin(shapely.linestrings(sides)[side], shapely.linestrings(ends), tolerance)
    side, edge = side[close], edge[close]
    pieces, ending = _divide(pattern, sides, side, edge, tolerance)
    middles = pieces.mean(axis=1)
    # Most pieces are well inside a face beside an edge that they end at.
    beside = np.where(ending[:, :, None] >= 0, faces_of_edges[ending], np.int32(-1)).reshape(-1, 4)
    depth = np.stack([face_depths(pattern, middles, face) for face in beside.T], axis=1)
    best = depth.argmax(axis=1)
    rows = np.arange(len(best))
    faces = beside[rows, best].astype(np.intp)
    rest = np.flatnonzero(depth[rows, best] <= tolerance)
    if len(rest):
        # The others are in a face beside one of these edges, unless there is a side that no edge comes near.
        around = np.unique(faces_of_edges[edge]) if len(np.unique(side)) == len(sides) else np.empty(0, dtype=np.int32)
        faces[rest] = _faces_at(pattern, middles[rest], around[around >= 0] if len(around) else None)
    return pieces, faces, np.stack([maps.apply(faces, pieces[:, end]) for end in (0, 1)], axis=1)


def _divide(
    pattern: CreasePattern, sides: Floats, side: Indices, edge: Indices, tolerance: float
) -> tuple[Floats, Indices]:
    """Divide the sides where they meet edges of the pattern, so that each piece is within one face.

    ``side`` and ``edge`` are the pairs that come within the tolerance of each other. Returns the pieces, ``(n, 2, 2)``,
    and an edge at either end of each, ``(n, 2)``, -1 for none. A piece that lies along an unfolded edge may be counted
    to either of its faces.
    """
    ends = pattern.vertices_coords[pattern.edges_vertices[edge]]
    base, along = sides[side, 0], sides[side, 1] - sides[side, 0]
    across = ends[:, 1] - ends[:, 0]
    to_edge = ends - base[:, None]
    slope = along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        meet = (to_edge[:, 0, 0] * across[:, 1] - to_edge[:, 0, 1] * across[:, 0]) / slope
    length_squared = (along**2).sum(axis=1)
    # Divide at the ends of the edge as well: the quotient is unreliable where side and edge are nearly parallel.
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
    """Return how far each point is inside its face, in mm: its least distance to the lines through the face's sides.

    ``points`` is ``(n, 2)`` and ``faces`` ``(n,)``, -1 for none. The depth is negative where the point may be outside,
    and minus infinity where there is no face.
    """
    depths = np.full(len(points), -np.inf)
    at = np.flatnonzero(faces >= 0)
    outlines = pattern.faces_vertices.take(faces[at])
    start, end = half_edges(outlines)
    base = pattern.vertices_coords[start]
    along = pattern.vertices_coords[end] - base
    away = points[at][outlines.rows] - base
    height = (along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0]) / np.hypot(*along.T)
    if len(at):
        depths[at] = np.minimum.reduceat(height, outlines.offsets[:-1])
    return depths


def _faces_at(pattern: CreasePattern, points: Floats, around: Ints | None) -> Indices:
    """Return for each point the face, of ``around`` if given, that it is in, or one that it borders."""
    number = np.arange(len(pattern.faces_vertices)) if around is None else around
    return np.asarray(number[shapely.STRtree(face_polygons(pattern, number)).nearest(shapely.points(points))])


def face_polygons(pattern: CreasePattern, number: Numbers) -> NDArray[np.object_]:
    """Return the faces with these numbers, ``(n,)``, as shapely polygons on the sheet."""
    faces = pattern.faces_vertices.take(number)
    outlines = shapely.linearrings(pattern.vertices_coords[faces.values], indices=faces.rows)
    return np.asarray(shapely.polygons(outlines))
