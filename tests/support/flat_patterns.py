"""Crease patterns of other people's kinds, as FOLD objects without a layer order: twists, strips, single vertices."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

Document = dict[str, Any]
Point = tuple[float, float]


def document(points: Sequence[Point], edges: Sequence[tuple[int, int, str]], **more: Any) -> Document:
    """Return a FOLD object; its faces are traced by whoever reads it."""
    return {
        "file_spec": 1.2,
        "frame_classes": ["creasePattern"],
        "frame_unit": "mm",
        "vertices_coords": [[float(x), float(y)] for x, y in points],
        "edges_vertices": [[one, other] for one, other, _ in edges],
        "edges_assignment": [letter for *_, letter in edges],
        **more,
    }


def twist(sides: int, turn: float, letters: str, size: float = 10.0, pleat: float = 40.0) -> Document:
    """Return a twist: a regular polygon with a pleat at each side, ``turn`` degrees off the side's normal.

    ``letters``: of the polygon's sides, of the first and of the second crease of each pleat. The sheet ends where the
    pleats do, and its edges join their ends.
    """
    angles = 2 * np.pi * np.arange(sides) / sides
    corners = size * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    normals = angles + np.pi / sides + np.radians(turn)
    along = pleat * np.stack([np.cos(normals), np.sin(normals)], axis=1)
    first, second = corners + along, np.roll(corners, -1, axis=0) + along
    points = [*map(tuple, corners), *map(tuple, np.stack([first, second], axis=1).reshape(-1, 2))]
    edges = [(k, (k + 1) % sides, letters[0]) for k in range(sides)]
    edges += [(k, sides + 2 * k, letters[1]) for k in range(sides)]
    edges += [((k + 1) % sides, sides + 2 * k + 1, letters[2]) for k in range(sides)]
    rim = list(range(sides, 3 * sides))
    edges += [(one, other, "B") for one, other in pairwise([*rim, rim[0]])]
    return document(points, edges)


def strip(widths: Sequence[float], letters: str, height: float = 10.0) -> Document:
    """Return a strip with upright creases of these letters between parts of these widths."""
    ends = [0.0, *np.cumsum(widths).tolist()]
    points = [(x, y) for x in ends for y in (0.0, height)]
    edges = [(2 * k, 2 * k + 1, letter) for k, letter in enumerate(f"B{letters}B")]
    edges += [(2 * k + y, 2 * k + 2 + y, "B") for k in range(len(widths)) for y in (0, 1)]
    return document(points, edges)


def vertex(sectors: Sequence[float], letters: str, radius: float = 50.0) -> Document:
    """Return a sheet with creases from its middle to its corners; crease k comes before sector k, in degrees."""
    turn = np.radians(np.concatenate([[0], np.cumsum(sectors)[:-1]]))
    count = len(sectors)
    points = [(0.0, 0.0), *((float(radius * np.cos(t)), float(radius * np.sin(t))) for t in turn)]
    edges = [(0, k + 1, letter) for k, letter in enumerate(letters)]
    edges += [(k + 1, (k + 1) % count + 1, "B") for k in range(count)]
    return document(points, edges)


def stamps(columns: int, rows: int, letter: str = "U") -> Document:
    """Return a sheet of unit squares with all lines between them creased."""
    number = {(x, y): x * (rows + 1) + y for x in range(columns + 1) for y in range(rows + 1)}
    along = [(number[x, y], number[x + 1, y], letter if 0 < y < rows else "B") for x, y in number if x < columns]
    up = [(number[x, y], number[x, y + 1], letter if 0 < x < columns else "B") for x, y in number if y < rows]
    return document([(float(x), float(y)) for x, y in number], along + up)
