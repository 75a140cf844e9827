"""The sheet while it closes, seen from the front and above.

A ``HalfClosed`` sheet -> ``Item`` after ``Item``, the farthest triangle first; the steeper a part is seen, the darker.
"""

from __future__ import annotations

import math

import numpy as np

from foldcut.core.arrays import Bools
from foldcut.folding_steps.half_closed import HalfClosed

from .folded_paper import BACK, FRONT
from .panels import EDGE, EDGE_COLOUR, Item

__all__ = ["in_space"]

TILT = math.radians(48)
"""How far from straight above the sheet is seen."""

DARKEST = 0.72
"""How bright a part is that is seen from its edge; 1 is that of one seen from straight above it."""


def in_space(sheet: HalfClosed, drawn: set[tuple[int, int]], *, up: bool = True) -> list[Item]:
    """Return a sheet in space; ``drawn``: the edges that are drawn, each as its lower and its higher vertex.

    ``up``: the printed side is on the side that triangles go round counter-clockwise.
    """
    x, y, z = sheet.points.T
    seen = np.stack([x, y * math.cos(TILT) + z * math.sin(TILT)], axis=1)
    depth = z * math.cos(TILT) - y * math.sin(TILT)
    corners = sheet.points[sheet.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    facing = normals @ np.array([0.0, -math.sin(TILT), math.cos(TILT)])
    fronts: Bools = (facing > 0) == up
    items = []
    for number in np.argsort(depth[sheet.triangles].mean(axis=1), kind="stable").tolist():
        triangle = sheet.triangles[number].tolist()
        fill = _darkened(FRONT if fronts[number] else BACK, DARKEST + (1 - DARKEST) * abs(float(facing[number])))
        items.append(Item([seen[triangle]], fill=fill, stroke=fill, width=EDGE / 2, closed=True))
        pairs = ((triangle[k], triangle[(k + 1) % 3]) for k in range(3))
        lines = [seen[list(pair)] for pair in pairs if (min(pair), max(pair)) in drawn]
        items += [Item(lines, stroke=EDGE_COLOUR, width=EDGE)] if lines else []
    return items


def _darkened(colour: str, share: float) -> str:
    """Return a colour with so much of its brightness."""
    parts = (round(int(colour[k : k + 2], 16) * share) for k in (1, 3, 5))
    return "#" + "".join(f"{part:02x}" for part in parts)
