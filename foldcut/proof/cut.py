"""The cut: whether one straight line through the folded sheet cuts out exactly the shape.

Pattern, maps of its faces and shape on the sheet -> findings. The boundary of the shape must fold onto one line. No
crease anywhere on the sheet may fold onto that line. The inside of the shape must fold to one side of the line, and
the outside to the other.

It is enough to look at vertices: the height over the line is continuous on the sheet, and on each face it is linear
with slope 1. The boundary divides the faces into pieces that are wholly inside or wholly outside. The corners of a
piece are vertices of the pattern and points of the boundary, where the height is 0. A linear function is least and
greatest at corners. So if no inner vertex is below the line and no outer one above it, every piece is on its own
side and reaches the line with an edge at most: a point strictly within a piece is strictly off the line.

A shape may be any planar graph (docs/graphs.md): loops whose two sides go to opposite sides of the cut line, and lines
whose two sides go to the same side. Then the paper is folded along the lines, on the cut line, and nowhere else on it.
The argument stays: loops and lines divide the faces into pieces, and each piece reaches the line with an edge at most.

In a large pattern, only the edges that reach the line are compared with the boundary: see ``is_surely_cut``.
``pattern.cut_line`` divides and folds the boundary.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, Indices, Ints
from foldcut.core.model import CreasePattern, Finding, Shape
from foldcut.geometry.segments import collinear_overlap
from foldcut.pattern.cut_line import (
    contains,
    edges_in_boxes,
    edges_near,
    face_depths,
    face_polygons,
    fold_pieces,
    sides_of,
)
from foldcut.pattern.face_maps import FaceMaps, folded_edges
from foldcut.proof.findings import finding

__all__ = ["check_cut", "check_on_sheet", "is_surely_cut", "line_through"]

ON_THE_LINE = 2e-8
"""A crease is on the cut line if both its ends are this close to it, relative to the sheet's diagonal.

This is not the verifier's tolerance. A smaller tolerance is stricter there, but here it would let creases pass that
the cut would sever.
"""

SEVERED = 6e-8
"""Creases that are shorter than this, relative to the sheet's diagonal, only cross the line or end on it."""

MANY_EDGES = 20_000
"""In a pattern with at least this many edges, heights over the line tell which edges may come near the boundary."""

SAMPLES = 6
"""The number of sides that are folded first, to learn where the cut line is."""

REACH = 32
"""Edges that come this near to the cut line, in tolerances, are compared with the boundary."""


def check_cut(
    pattern: CreasePattern, faces_of_edges: Ints, maps: FaceMaps, shape: Shape, tolerance: float
) -> list[Finding]:
    """Find where one straight cut would not follow the boundary of the shape, all of it and nothing else.

    ``faces_of_edges`` is ``edge_faces(pattern)``, ``maps`` is ``fold_faces`` of both, ``shape`` is on the sheet in mm,
    and ``tolerance`` is in mm.
    """
    if not shape.loops and not shape.lines:
        return [Finding("cut", "the shape has no loops; give at least one")]
    sides = sides_of(shape)
    findings = check_on_sheet(pattern, faces_of_edges, sides, tolerance)
    if findings:
        return findings
    is_large = len(pattern.edges_vertices) >= MANY_EDGES and not shape.is_graph
    if is_large and is_surely_cut(pattern, faces_of_edges, maps, shape, sides, tolerance):
        return []
    near = edges_near(pattern, sides, 2 * tolerance)
    findings = _check_creases(pattern, sides, _of_loops(shape, near), tolerance)
    pieces, _, landed = fold_pieces(pattern, faces_of_edges, maps, sides, near, tolerance)
    folded = np.concatenate([landed[:, 0], landed[:, 1]])
    along, level = line_through(folded)
    heights = _heights(folded, along, level)
    off = np.abs(heights).reshape(2, -1).max(axis=0)
    for at in np.flatnonzero(off > 2 * tolerance).tolist():
        message = f"the shape's boundary folds {off[at]:.3g} mm away from the cut line"
        findings.append(finding("cut", message, pieces[at].mean(axis=0), off[at]))
    if findings:
        return findings
    height = _vertex_heights(pattern, maps, along, level)
    coords = pattern.vertices_coords
    return [*_check_sides(coords, height, shape, 2 * tolerance), *_check_severed(pattern, height, shape)]


def is_surely_cut(
    pattern: CreasePattern, faces_of_edges: Ints, maps: FaceMaps, shape: Shape, sides: Floats, tolerance: float
) -> bool:
    """Whether the cut is right, judged only by the edges that reach the cut line; if not, all edges must be asked.

    ``sides`` are those of ``shape``; the rest is as for ``check_cut``. Folding a few sides tells where the line is. The
    other edges do not matter: if one of them came near the boundary, the boundary would be off the line there. Follow
    the boundary from that place back to where it is on the line. Along a straight piece within one face, the height is
    linear. So there is a piece that has an end off the line, or one that an edge which reaches the line should have
    divided. But every piece was found to be in its face, with both ends on the line.
    """
    sample = np.append(np.linspace(0, len(sides) - 1, SAMPLES).astype(np.intp), _lengths(sides).argmax())
    sample = np.unique(sample)
    near = edges_in_boxes(pattern, sides[sample], 2 * tolerance)
    _, _, landed = fold_pieces(pattern, faces_of_edges, maps, sides[sample], near, tolerance)
    guess = _vertex_heights(pattern, maps, *line_through(landed.reshape(-1, 2)))
    reach = REACH * tolerance
    asked = _reaching(pattern, guess, reach)
    close = np.flatnonzero(asked)
    if not len(close):
        return False
    side, edge = edges_near(pattern, sides, 2 * tolerance, close)
    if _check_creases(pattern, sides, (side, edge), tolerance):
        return False
    pieces, faces, landed = fold_pieces(pattern, faces_of_edges, maps, sides, (side, edge), tolerance)
    along, level = line_through(landed.reshape(-1, 2))
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
    """Return which edges come within ``reach`` of the cut line or cross it, ``(e,)``; ``height`` is of the vertices."""
    side_of_line = ((height > reach).astype(np.int8) - (height < -reach))[pattern.edges_vertices]
    there: Bools = (side_of_line[:, 0] != side_of_line[:, 1]) | (side_of_line[:, 0] == 0)
    return there


def check_on_sheet(pattern: CreasePattern, faces_of_edges: Ints, sides: Floats, tolerance: float) -> list[Finding]:
    """Find sides of the shape, ``(n, 2, 2)``, that leave the sheet by more than ``tolerance``, in mm."""
    border = pattern.edges_vertices[(faces_of_edges < 0).any(axis=1)]
    outline = shapely.polygonize(shapely.linestrings(pattern.vertices_coords[border]).tolist())
    sheet = shapely.buffer(outline, tolerance)
    shapely.prepare(sheet)
    return [
        finding("cut", "the shape reaches over the sheet's border; use a larger sheet", sides[at].mean(axis=0))
        for at in np.flatnonzero(~shapely.covers(sheet, shapely.linestrings(sides))).tolist()
    ]


def _check_creases(
    pattern: CreasePattern, sides: Floats, near: tuple[Indices, Indices], tolerance: float
) -> list[Finding]:
    """Find mountains and valleys that lie along the boundary; ``near`` are the pairs of a side and an edge near it."""
    side, edge = near
    folded = folded_edges(pattern)[edge]
    side, edge = side[folded], edge[folded]
    ends = pattern.vertices_coords[pattern.edges_vertices[edge]]
    length, _ = collinear_overlap(sides[side], ends, 2 * tolerance)
    findings = []
    for pair in np.flatnonzero(length > 2 * tolerance).tolist():
        message = f"crease {edge[pair]} lies on the shape's boundary for {length[pair]:.3g} mm"
        findings.append(finding("cut", message, ends[pair].mean(axis=0), length[pair]))
    return findings


def _of_loops(shape: Shape, near: tuple[Indices, Indices]) -> tuple[Indices, Indices]:
    """Return the pairs of a side and an edge near it whose side is of a loop: along lines, paper has to be folded."""
    side, edge = near
    kept = side < sum(len(loop) for loop in shape.loops)
    return side[kept], edge[kept]


def _lengths(sides: Floats) -> Floats:
    lengths: Floats = np.hypot(*(sides[:, 1] - sides[:, 0]).T)
    return lengths


def line_through(points: Floats) -> tuple[Floats, float]:
    """Return the line through two points far apart: its unit direction, and its level across that direction."""
    one = points[np.hypot(*(points - points[0]).T).argmax()]
    other = points[np.hypot(*(points - one).T).argmax()]
    along = (other - one) / np.hypot(*(other - one))
    middle = (one + other) / 2
    return along, float(along[0] * middle[1] - along[1] * middle[0])


def _heights(points: Floats, along: Floats, level: float) -> Floats:
    heights: Floats = along[0] * points[:, 1] - along[1] * points[:, 0] - level
    return heights


def _vertex_heights(pattern: CreasePattern, maps: FaceMaps, along: Floats, level: float) -> Floats:
    """Return how high over the cut line each vertex folds, ``(v,)``."""
    coords = pattern.vertices_coords
    face = np.zeros(len(coords), dtype=np.int32)
    face[pattern.faces_vertices.values] = pattern.faces_vertices.rows
    return _heights(maps.apply(face, coords), along, level)


def _check_sides(coords: Floats, height: Floats, shape: Shape, tolerance: float) -> list[Finding]:
    """Find vertices that fold to the wrong side of the cut line."""
    inside = contains(shape, coords)
    # Which side is the inside? The vertex farthest from the line decides.
    surest = np.abs(height).argmax()
    if (height[surest] > 0) != inside[surest]:
        height = -height
    wrong = np.where(inside, -height, height)
    findings = []
    for vertex in np.flatnonzero(wrong > tolerance).tolist():
        where = "inside" if inside[vertex] else "outside"
        message = f"vertex {vertex}, {where} the shape, folds {wrong[vertex]:.3g} mm over the cut line"
        findings.append(finding("cut", message, coords[vertex], wrong[vertex]))
    return findings


def _check_severed(pattern: CreasePattern, height: Floats, shape: Shape) -> list[Finding]:
    """Find mountains and valleys that fold onto the cut line, where the cut would go through the fold itself."""
    diagonal = float(np.hypot(*np.ptp(pattern.vertices_coords, axis=0)))
    level = np.abs(height) <= ON_THE_LINE * diagonal
    one, other = pattern.edges_vertices.T
    crease = np.flatnonzero(folded_edges(pattern) & level[one] & level[other])
    ends = pattern.vertices_coords[pattern.edges_vertices[crease]]
    length, middle = np.hypot(*(ends[:, 1] - ends[:, 0]).T), ends.mean(axis=1)
    inside = contains(shape, middle)
    beyond = length - _along_lines(ends, shape, ON_THE_LINE * diagonal)
    findings = []
    for at in np.flatnonzero(beyond > SEVERED * diagonal).tolist():
        where = "inside" if inside[at] else "outside"
        message = (
            f"crease {crease[at]}, {where} the shape, folds onto the cut line for {length[at]:.3g} mm: the cut would "
            "sever the paper there; keep creases off the line, for example with a ribbon"
        )
        findings.append(finding("cut", message, middle[at], length[at]))
    return findings


def _along_lines(creases: Floats, shape: Shape, tolerance: float) -> Floats:
    """Return how much of each crease, ``(n, 2, 2)``, lies along lines of the shape, ``(n,)`` mm."""
    along = np.zeros(len(creases))
    if shape.lines and len(creases):
        lines = sides_of(replace(shape, loops=(), parent=()))
        tree = shapely.STRtree(shapely.linestrings(lines))
        crease, line = tree.query(shapely.linestrings(creases), predicate="dwithin", distance=tolerance)
        np.add.at(along, crease, collinear_overlap(creases[crease], lines[line], tolerance)[0])
    return along
