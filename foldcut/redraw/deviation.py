"""By how much an outline was moved from a drawing: one length that a FOLD file states, and that ``check`` measures.

Loops of an outline and of a drawing, in the same unit -> a length. No point of the outline is farther than this from
the drawing's own outline, and nothing that lies between the two is. So whatever of the drawing is wider than twice this
length is there, and nothing else; a hole, part, slit or neck that is narrower may have been left out.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from foldcut.core.arrays import Floats
from foldcut.redraw.distance import farthest

__all__ = ["EXACT", "drawing_size", "left_out", "moved_by"]

EXACT = 1e-4
"""How exact the length is, relative to the size of the drawing."""

HAIR = 1e-3
"""Corners that are moved by no more than this part of the drawing's size are taken to be the same corners."""

ARCS = 32
"""Into how many segments a quarter of a circle is divided around corners; these are up to 0.03 % too short."""

ROUNDED = 1e-3
"""A distance is taken as this much larger, so that the segments of such arcs leave nothing over."""

HALVINGS = 20
"""How often the length is halved to find it where something was left out."""


def moved_by(outline: Sequence[Floats], drawing: Sequence[Floats]) -> float:
    """Return by how much ``outline`` was moved from ``drawing``; both are closed loops, ``(n, 2)`` each, even-odd."""
    size = drawing_size(drawing)
    if [len(loop) for loop in outline] == [len(loop) for loop in drawing]:
        # a side whose ends are moved by no more than a length is moved by no more than that
        corners = np.concatenate(outline) - np.concatenate(drawing)
        if (most := float(np.hypot(*corners.T).max())) <= HAIR * size:
            return most
    off = farthest(outline, drawing, EXACT * size)
    between = shapely.symmetric_difference(_area(outline), _area(drawing))
    lines = shapely.multilinestrings([shapely.linearrings(loop) for loop in drawing])

    def covers(length: float) -> bool:
        near = lines.buffer(length * (1 + ROUNDED) + EXACT * size, quad_segs=ARCS)
        return bool(between.difference(near).area <= (EXACT * size) ** 2)

    if covers(off):
        return off
    low = high = off or EXACT * size
    while not covers(high):
        low, high = high, 2 * high
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (low, middle) if covers(middle) else (middle, high)
    return high


def left_out(outline: Sequence[Floats], drawing: Sequence[Floats], moved: float) -> float:
    """Return how far parts of a drawing are from its outline at most that were left out, 0 where none was.

    ``moved`` is what ``moved_by`` returns.
    """
    far = farthest(drawing, outline, EXACT * drawing_size(drawing))
    return far if far > 2 * moved + EXACT * drawing_size(drawing) else 0.0


def drawing_size(drawing: Sequence[Floats]) -> float:
    """Return the length of the diagonal of the box around a drawing."""
    return float(np.hypot(*np.ptp(np.concatenate(drawing), axis=0)))


def _area(loops: Sequence[Floats]) -> shapely.Geometry:
    """Return the area of loops by the even-odd rule."""
    area = shapely.Polygon()
    for loop in loops:
        area = shapely.symmetric_difference(area, shapely.make_valid(shapely.Polygon(loop)))
    return area
