"""The edges of a crease pattern one by one, as the formats of bare lines have them: .cp, .opx, and bare SVG.

``FoldedPattern`` -> assignment and ends of each edge, in mm, y pointing down, neither merged nor divided into dashes.
"""

from __future__ import annotations

from collections.abc import Iterator

from foldcut.core.model import FoldedPattern

TYPES = {"B": 1, "M": 2, "V": 3}
"""The numbers of assignments in ORIPA's formats: border, mountain, valley."""

BLOCK = 8192
"""This many edges are turned into Python's numbers at once: all of them would take much memory."""


def edge_lines(pattern: FoldedPattern) -> Iterator[tuple[str, float, float, float, float]]:
    """Yield the assignment of every edge and its ends, x y x y, in mm, y down."""
    creases = pattern.creases
    points = creases.vertices_coords * (1, -1) + (0, pattern.sheet.height)
    for low in range(0, len(creases.edges_vertices), BLOCK):
        some = slice(low, low + BLOCK)
        ends = points[creases.edges_vertices[some]].reshape(-1, 4).tolist()
        for letter, (a, b, c, d) in zip(creases.edges_assignment[some].tolist(), ends, strict=True):
            yield letter, a, b, c, d
