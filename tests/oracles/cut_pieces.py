"""What one straight cut makes of a folded sheet: a simple, slow twin of what ``proof.cut`` says of graphs.

Every folded face is divided by the cut line, and its parts are joined with those of its neighbours wherever they still
hang together. It knows nothing of shapes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from foldcut.core.model import CreasePattern, Shape
from foldcut.geometry.planar_graph import edge_faces
from foldcut.geometry.union_find import groups

NEAR = 1e-6
"""Points of the folded sheet that are this near to the cut line are on it, in mm."""


def pieces_of_cut(pattern: CreasePattern, heights: Sequence[float]) -> list[shapely.Geometry]:
    """Return the pieces of the sheet, as it lies flat, that a cut makes; ``heights``: of the vertices over the line."""
    parts: list[shapely.Geometry] = []
    part_of: dict[tuple[int, int], int] = {}
    for face in range(len(pattern.faces_vertices)):
        corners = pattern.faces_vertices[face].tolist()
        for side in (1, -1):
            outline = _on_side([(*pattern.vertices_coords[v].tolist(), side * heights[v]) for v in corners])
            if len(outline) > 2:
                part_of[face, side] = len(parts)
                parts.append(shapely.Polygon(outline))
    hanging = []
    for (one, other), edge in zip(edge_faces(pattern).tolist(), pattern.edges_vertices.tolist(), strict=True):
        hanging += [
            (part_of[one, side], part_of[other, side])
            for side in (1, -1)
            if min(one, other) >= 0 and max(side * heights[v] for v in edge) > NEAR
        ]
    piece = np.array(groups(len(parts), hanging))
    # parts meet along lines whose ends are rounded differently
    wide = [shapely.buffer(part, NEAR, join_style="mitre") for part in parts]
    return [shapely.union_all([wide[k] for k in np.flatnonzero(piece == name)]) for name in np.unique(piece)]


def pieces_of_sheet(sheet: shapely.Geometry, shape: Shape) -> list[shapely.Geometry]:
    """Return the pieces of a sheet that is cut along all lines of a shape; a slit within a piece leaves it whole."""
    lines = [shapely.linestrings(stroke) for stroke in shape.strokes]
    return list(shapely.get_parts(shapely.polygonize([shapely.union_all([*lines, sheet.exterior])])))


def _on_side(corners: Sequence[tuple[float, float, float]]) -> list[tuple[float, float]]:
    """Return what lies over the line of a convex face or not; each corner has its height after its place."""
    outline = []
    highest = max(height for _, _, height in corners)
    if highest <= NEAR:
        return []
    for (x, y, height), (to_x, to_y, to_height) in zip(corners, [*corners[1:], corners[0]], strict=True):
        if height > -NEAR:
            outline.append((x, y))
        if (height > NEAR and to_height < -NEAR) or (height < -NEAR and to_height > NEAR):
            part = height / (height - to_height)
            outline.append((x + part * (to_x - x), y + part * (to_y - y)))
    return outline
