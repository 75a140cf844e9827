"""Drawings of open lines, lines that cross and figures that touch, for tests and benchmarks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from foldcut.core.arrays import Floats, points_array
from foldcut.core.model import Shape
from foldcut.drawing.graph import make_graph
from foldcut.drawing.placement import Layout, parse_sheet

Lines = list[Floats]


def square(x: float, y: float, size: float = 1.0) -> Floats:
    """Return a closed square by its lower left corner."""
    return points_array([(x, y), (x + size, y), (x + size, y + size), (x, y + size), (x, y)])


def chessboard(count: int) -> Lines:
    """Return all squares of a board; neighbours share their sides."""
    return [square(x, y) for x in range(count) for y in range(count)]


def lines(*drawn: Sequence[tuple[float, float]]) -> Lines:
    """Return lines from plain numbers."""
    return [points_array(line) for line in drawn]


TANGRAM = lines(
    [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0)],
    [(0, 4), (4, 0)],
    [(0, 0), (3, 3)],
    [(2, 4), (4, 2), (3, 1)],
    [(1, 3), (3, 3)],
)

GRAPHS = {
    "slit": lines([(0, 0), (10, 1)]),
    "two slits": lines([(0, 0), (10, 0)], [(0, 3), (10, 3)]),
    "zigzag": lines([(0, 0), (3, 4), (6, 0), (9, 4)]),
    "cross": lines([(0, 0), (4, 4)], [(0, 4), (4, 0)]),
    "tee": lines([(0, 0), (6, 0)], [(3, 0), (3, -4)]),
    "bow tie": lines([(0, 0), (4, 3), (0, 5), (0, 0)], [(4, 3), (8, 0.5), (8, 6), (4, 3)]),
    "square with a slit": [square(0, 0, 6), *lines([(2, 2), (4, 3)])],
    "triangle in three": lines([(0, 0), (6, 0), (2, 5), (0, 0)], [(0, 0), (3, 2), (6, 0)], [(3, 2), (2, 5)]),
    "black squares": [square(x, y) for x in range(3) for y in range(3) if (x + y) % 2 == 0],
    "chessboard": chessboard(3),
}


def random_lines(seed: int, most: int = 12) -> Lines:
    """Return up to ``most`` edges between random points that cross nowhere and come near no other point."""
    rng = np.random.default_rng(seed)
    points = rng.random((int(rng.integers(3, 11)), 2))
    wanted = int(rng.integers(1, most + 1))
    found: list[shapely.Geometry] = []
    for _ in range(300):
        one, other = rng.choice(len(points), 2, replace=False).tolist()
        edge = shapely.LineString(points[[one, other]])
        away = [shapely.distance(edge, shapely.Point(points[k])) for k in range(len(points)) if k not in (one, other)]
        if min(away) > 0.02 and not any(edge.crosses(known) or edge.equals(known) for known in found):
            found.append(edge)
        if len(found) == wanted:
            break
    return [points_array(shapely.get_coordinates(edge)) for edge in found]


def shape_of(drawn: Lines) -> Shape:
    """Return lines as a shape on A4, with the sides of the cut that fold the fewest edges."""
    shape = next(make_graph((), drawn).shapes())
    return Layout(parse_sheet("a4")).place(shape)[1]
