"""Boxes that can be looked up by place, and of which there may be more at any time.

The boxes that were there from the start are in an R-tree, which cannot grow; those that come later are compared one by
one.
"""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from foldcut.core.arrays import Floats, Numbers


class GrowingBoxes:
    """Boxes ``(n, 4)`` as lowest x, lowest y, highest x, highest y; ``names`` ``(n, ...)`` are found by them."""

    def __init__(self, boxes: Floats, names: Numbers) -> None:
        self._tree = shapely.STRtree(_diagonals(boxes))
        self._first_names = names
        self._boxes = np.empty((256, 4))
        self._names = np.empty((256, *names.shape[1:]), dtype=np.int64)
        self._count = 0

    def add(self, box: Floats, name: Numbers | int) -> None:
        """Add a box, ``(4,)``."""
        if self._count == len(self._boxes):
            self._boxes = np.concatenate([self._boxes, np.empty_like(self._boxes)])
            self._names = np.concatenate([self._names, np.empty_like(self._names)])
        self._boxes[self._count], self._names[self._count] = box, name
        self._count += 1

    def first_pairs(self) -> tuple[Numbers, Numbers]:
        """Return the names of each two boxes that meet, of those that were there from the start."""
        one, other = self._tree.query(self._tree.geometries)
        keep = one < other
        return self._first_names[one[keep]], self._first_names[other[keep]]

    def meeting(self, box: Floats) -> Numbers:
        """Return the names of all boxes that meet this one, ``(4,)``."""
        x0, y0, x1, y1 = self._boxes[: self._count].T
        low_x, low_y, high_x, high_y = box.tolist()
        late = (x0 <= high_x) & (y0 <= high_y) & (x1 >= low_x) & (y1 >= low_y)
        found = self._first_names[self._tree.query(_diagonals(box)[0])]
        return np.concatenate([found, self._names[: self._count][late]])


def _diagonals(boxes: Floats) -> NDArray[np.object_]:
    """Lines with these bounding boxes: shapely makes them faster than polygons."""
    lines: NDArray[np.object_] = shapely.linestrings(boxes.reshape(-1, 2, 2))
    return lines
