"""The cut: whether one straight line through the folded sheet cuts out exactly the shape.

Pattern, folded faces and shape on the sheet -> findings. The shape's boundary must fold onto one line, no
crease, wherever it is on the sheet, may fold onto that line, and what is inside the shape must fold to one
side of the line, what is outside to the other.

Why looking at vertices is enough: the height over the line is continuous on the sheet and linear on each
face, of slope 1. The boundary divides the faces into pieces that are wholly inside or wholly outside, and
whose corners are pattern vertices and points of the boundary, where the height is 0. A linear function is
least and greatest at corners; so if no inner vertex is below and no outer one above, every piece is on its
side, and reaches the line at most with an edge: a point strictly within a piece is strictly off the line.

Of a large pattern only the edges that reach the line are compared with the boundary: see ``_is_surely_cut``.
"""

from __future__ import annotations

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, Ints
from foldcut.core.model import CreasePattern, Finding, Shape
from foldcut.geometry.segments import collinear_overlap
from foldcut.pattern.cut_line import (
    Indices,
    contains,
    edges_in_boxes,
    edges_near,
    face_depths,
    face_polygons,
    fold_pieces,
    sides_of,
)
from foldcut.pattern.face_maps import FaceMaps, folded_edges

__all__ = ["check_cut"]


ON_THE_LINE = 2e-8
"""A crease is on the cut line when its ends are this close, relative to the sheet's diagonal.

Not the verifier's tolerance: there less is stricter, here it would let creases pass that the cut cannot spare.
"""

SEVERED = 6e-8
"""Shorter creases, relative to the sheet's diagonal, only cross the line or end on it."""

MANY_EDGES = 20_000
"""Of so many edges of a pattern those that can come near the boundary are told by their heights."""

SAMPLES = 6
"""So many sides are folded first, to learn where the cut line is."""

REACH = 32
"""Edges that come as near to the cut line as so many tolerances are compared with the boundary."""


def check_cut(
    pattern: CreasePattern, faces_of_edges: Ints, maps: FaceMaps, shape: Shape, tolerance: float
) -> list[Finding]:
    """Find where one straight cut would not follow the shape's boundary, all of it and nothing else.

    ``faces_of_edges`` is ``planar.edge_faces(pattern)``, ``maps`` its folded faces, ``shape`` on the sheet in
    mm, ``tolerance`` in mm.
    """
    if not shape.loops:
        return [Finding("cut", "the shape has no loops; give at least one")]
    sides = sides_of(shape)
    findings = _check_on_sheet(pattern, faces_of_edges, sides, tolerance)
    if findings:
        return findings
    if len(pattern.edges_vertices) >= MANY_EDGES and _is_surely_cut(
        pattern, faces_of_edges, maps, shape, sides, tolerance
    ):
        return []
    near = edges_near(pattern, sides, 2 * tolerance)
    findings = _check_creases(pattern, sides, near, tolerance)
    pieces, _, landed = fold_pieces(pattern, faces_of_edges, maps, sides, near, tolerance)
    folded = np.concatenate([landed[:, 0], landed[:, 1]])
    along, level = _line_through(folded)
    heights = _heights(folded, along, level)
    off = np.abs(heights).reshape(2, -1).max(axis=0)
    for at in np.flatnonzero(off > 2 * tolerance).tolist():
        message = f"the shape's boundary folds {off[at]:.3g} mm away from the cut line"
        findings.append(_finding(message, pieces[at].mean(axis=0), off[at]))
    if findings:
        return findings
    height = _vertex_heights(pattern, maps, along, level)
    coords = pattern.vertices_coords
    return [*_check_sides(coords, height, shape, 2 * tolerance), *_check_severed(pattern, height, shape)]


def _is_surely_cut(
    pattern: CreasePattern, faces_of_edges: Ints, maps: FaceMaps, shape: Shape, sides: Floats, tolerance: float
) -> bool:
    """Whether the cut has no findings, told from the edges that reach the cut line; if not, all have to be asked.

    A few sides tell where the line is. Why the other edges do not matter: if one came near the boundary, the boundary
    would be off the line there. Going back from there on the boundary to where it is on the line, one leaves the face
    where it is off; along a straight piece in a face the height is linear, so that piece has an end off the line, or
    is divided by an edge that reaches the line. But all pieces are found to be in their faces, both ends on the line.
    """
    sample = np.append(np.linspace(0, len(sides) - 1, SAMPLES).astype(np.intp), _lengths(sides).argmax())
    sample = np.unique(sample)
    near = edges_in_boxes(pattern, sides[sample], 2 * tolerance)
    _, _, landed = fold_pieces(pattern, faces_of_edges, maps, sides[sample], near, tolerance)
    guess = _vertex_heights(pattern, maps, *_line_through(landed.reshape(-1, 2)))
    reach = REACH * tolerance
    asked = _reaching(pattern, guess, reach)
    close = np.flatnonzero(asked)
    if not len(close):
        return False
    side, edge = edges_near(pattern, sides, 2 * tolerance, close)
    if _check_creases(pattern, sides, (side, edge), tolerance):
        return False
    pieces, faces, landed = fold_pieces(pattern, faces_of_edges, maps, sides, (side, edge), tolerance)
    along, level = _line_through(landed.reshape(-1, 2))
    height = _vertex_heights(pattern, maps, along, level)
    missed = _reaching(pattern, height, reach / 2) & ~asked
    if missed.any() or (np.abs(_heights(landed.reshape(-1, 2), along, level)) > 2 * tolerance).any():
        return False
    middles = pieces.mean(axis=1)
    unsure = np.flatnonzero(face_depths(pattern, middles, faces) < -tolerance)
    if (shapely.distance(face_polygons(pattern, faces[unsure]), shapely.points(middles[unsure])) > tolerance).any():
        return False
    coords = pattern.vertices_coords
    return not (_check_sides(coords, height, shape, 2 * tolerance) or _check_severed(pattern, height, shape))


def _reaching(pattern: CreasePattern, height: Floats, reach: float) -> Bools:
    """Which edges come as near as ``reach`` to the cut line, or across it, ``(e,)``; ``height`` of the vertices."""
    side_of_line = ((height > reach).astype(np.int8) - (height < -reach))[pattern.edges_vertices]
    there: Bools = (side_of_line[:, 0] != side_of_line[:, 1]) | (side_of_line[:, 0] == 0)
    return there


def _check_on_sheet(pattern: CreasePattern, faces_of_edges: Ints, sides: Floats, tolerance: float) -> list[Finding]:
    border = pattern.edges_vertices[(faces_of_edges < 0).any(axis=1)]
    outline = shapely.polygonize(shapely.linestrings(pattern.vertices_coords[border]).tolist())
    sheet = shapely.buffer(outline, tolerance)
    shapely.prepare(sheet)
    return [
        _finding("the shape reaches over the sheet's border; use a larger sheet", sides[at].mean(axis=0))
        for at in np.flatnonzero(~shapely.covers(sheet, shapely.linestrings(sides))).tolist()
    ]


def _check_creases(
    pattern: CreasePattern, sides: Floats, near: tuple[Indices, Indices], tolerance: float
) -> list[Finding]:
    """Find mountains and valleys, of the edges near the sides, that lie along the boundary."""
    side, edge = near
    folded = folded_edges(pattern)[edge]
    side, edge = side[folded], edge[folded]
    ends = pattern.vertices_coords[pattern.edges_vertices[edge]]
    length, _ = collinear_overlap(sides[side], ends, 2 * tolerance)
    findings = []
    for pair in np.flatnonzero(length > 2 * tolerance).tolist():
        message = f"crease {edge[pair]} lies on the shape's boundary for {length[pair]:.3g} mm"
        findings.append(_finding(message, ends[pair].mean(axis=0), length[pair]))
    return findings


def _lengths(sides: Floats) -> Floats:
    lengths: Floats = np.hypot(*(sides[:, 1] - sides[:, 0]).T)
    return lengths


def _line_through(points: Floats) -> tuple[Floats, float]:
    """Return the line through two far-apart points: its unit direction, and its level across that."""
    one = points[np.hypot(*(points - points[0]).T).argmax()]
    other = points[np.hypot(*(points - one).T).argmax()]
    along = (other - one) / np.hypot(*(other - one))
    middle = (one + other) / 2
    return along, float(along[0] * middle[1] - along[1] * middle[0])


def _heights(points: Floats, along: Floats, level: float) -> Floats:
    heights: Floats = along[0] * points[:, 1] - along[1] * points[:, 0] - level
    return heights


def _vertex_heights(pattern: CreasePattern, maps: FaceMaps, along: Floats, level: float) -> Floats:
    """Return how high over the cut line every vertex folds."""
    coords = pattern.vertices_coords
    face = np.zeros(len(coords), dtype=np.int32)
    face[pattern.faces_vertices.values] = pattern.faces_vertices.rows
    return _heights(maps.apply(face, coords), along, level)


def _check_sides(coords: Floats, height: Floats, shape: Shape, tolerance: float) -> list[Finding]:
    """Find vertices that fold to the wrong side of the cut line."""
    inside = contains(shape, coords)
    # Which side is the inside? Ask the vertex that is surest.
    surest = np.abs(height).argmax()
    if (height[surest] > 0) != inside[surest]:
        height = -height
    wrong = np.where(inside, -height, height)
    findings = []
    for vertex in np.flatnonzero(wrong > tolerance).tolist():
        where = "inside" if inside[vertex] else "outside"
        message = f"vertex {vertex}, {where} the shape, folds {wrong[vertex]:.3g} mm over the cut line"
        findings.append(_finding(message, coords[vertex], wrong[vertex]))
    return findings


def _check_severed(pattern: CreasePattern, height: Floats, shape: Shape) -> list[Finding]:
    """Find mountains and valleys that fold onto the cut line: there the cut would go through the fold itself."""
    diagonal = float(np.hypot(*np.ptp(pattern.vertices_coords, axis=0)))
    level = np.abs(height) <= ON_THE_LINE * diagonal
    one, other = pattern.edges_vertices.T
    crease = np.flatnonzero(folded_edges(pattern) & level[one] & level[other])
    ends = pattern.vertices_coords[pattern.edges_vertices[crease]]
    length, middle = np.hypot(*(ends[:, 1] - ends[:, 0]).T), ends.mean(axis=1)
    inside = contains(shape, middle)
    findings = []
    for at in np.flatnonzero(length > SEVERED * diagonal).tolist():
        where = "inside" if inside[at] else "outside"
        message = (
            f"crease {crease[at]}, {where} the shape, folds onto the cut line for {length[at]:.3g} mm: the cut would "
            "sever the paper there; keep creases off the line, for example with a ribbon"
        )
        findings.append(_finding(message, middle[at], length[at]))
    return findings


def _finding(message: str, place: Floats, size: float = 0.0) -> Finding:
    return Finding("cut", message, (float(place[0]), float(place[1])), float(size))
