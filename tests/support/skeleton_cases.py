"""Plane graphs made by hand, and drawings, that the tests of the straight skeleton share."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np

from foldcut.drawing.shape import make_shape
from foldcut.readers import read_shape
from foldcut.samples import sample_path
from support.planar_graphs import Graph, of_loops, of_paths
from support.samples import TESTED
from support.strategies import cross, regular

SHAPES = os.environ.get("FOLDCUT_SHAPES", "")
"""A folder with more drawings to try, JSON files with ``loops``, at any depth."""

SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4)]

TOOTH = [(2, 0), (2, 3), (1, 3), (1, 0)]

COMB = [(0, -1), (7, -1), (7, 0), *((x + 2 * k, y) for k in (2, 1, 0) for x, y in TOOTH), (0, 0)]
"""A bar with three teeth; all gaps and teeth are equally wide."""

CASES: dict[str, Graph] = {
    "square": of_loops([SQUARE]),
    "rectangle": of_loops([[(0, 0), (6, 0), (6, 2), (0, 2)]]),
    **{f"regular polygon with {n} corners": of_loops([regular(n)]) for n in range(3, 13)},
    "L": of_loops([[(0, 0), (4, 0), (4, 2), (2, 2), (2, 4), (0, 4)]]),
    "plus": of_loops([cross()]),
    "two squares side by side": of_loops([SQUARE, [(x + 6, y) for x, y in SQUARE]]),
    "two squares corner to corner": of_loops([SQUARE, [(x + 4, y + 4) for x, y in SQUARE]]),
    "two squares with a common edge": of_paths([[*SQUARE, (0, 0)], [(4, 0), (8, 0), (8, 4), (4, 4)]]),
    "square with a hole": of_loops([[(-3, -3), (3, -3), (3, 3), (-3, 3)], [(-1, -1), (1, -1), (1, 1), (-1, 1)]]),
    "T": of_paths([[(-3, 0), (0, 0), (3, 0)], [(0, 0), (0, -4)]]),
    "edge": of_paths([[(0, 0), (4, 0)]]),
    "two edges on one line": of_paths([[(0, 0), (4, 0)], [(6, 0), (10, 0)]]),
    "straight path": of_paths([[(0, 0), (4, 0), (10, 0)]]),
    "comb": of_loops([COMB]),
    "seven edges around a point": of_paths([[(0, 0), point] for point in regular(7)]),
    "frame around three edges": of_paths([[*((2 * x - 2, 2 * y - 2) for x, y in (*SQUARE, (0, 0)))]]
                                         + [[(0, 0), point] for point in regular(3)]),
}  # fmt: skip


def drawings() -> dict[str, Graph]:
    """Return the graphs of all samples, and of the shapes in the folder ``FOLDCUT_SHAPES``."""
    loops = {name: read_shape(sample_path(name)).loops for name in TESTED}
    if SHAPES:
        files = sorted(Path(SHAPES).rglob("*.json"))
        loops |= {path.stem: [np.array(loop) for loop in json.loads(path.read_text())["loops"]] for path in files}
    return {name: of_loops(make_shape(some).loops) for name, some in loops.items()}
