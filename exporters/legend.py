"""Where a page has room for a legend: the place that covers the least length of lines.

Lines in mm, y up, and the sizes of boxes, of which one has to be placed -> that box and its lower left corner. Among
places that cover equally little, one beside the shape to cut out comes before one inside it, and one near the lower
left corner of the page before one far away.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Floats

CELLS = 300
"""A page is divided into cells, this many along its longer side."""

BLOCK = 65_536
"""This many lines are added at once."""

IN_SHAPE = 2e-3
"""The cost of each mm² of a box that lies in the shape, in mm of covered lines."""

FAR = 1e-3
"""The cost of each mm between a box and the lower left corner, in mm of covered lines."""

LATER = 0.5
"""The cost of taking the next box in the list, in mm of covered lines."""

BACKING = 0.75
"""The opacity of the white behind words that cover lines all the same: the lines must stay visible."""

Indices = NDArray[np.intp]

Box = tuple[float, float]
"""Width and height, in mm."""

Corner = tuple[float, float]
"""A lower left corner, in mm."""


@dataclass(frozen=True)
class Place:
    """The index of the box that was placed, its lower left corner, and its size, in mm."""

    box: int
    x: float
    y: float
    width: float
    height: float


class Ground:
    """A page and what is drawn on it; no box is placed within ``inset`` mm of its edges."""

    def __init__(self, width: float, height: float, inset: float) -> None:
        self.inset = inset
        self.cell = max(width, height) / CELLS
        self.room = np.maximum(np.array([width, height]) - 2 * inset, 0.0)
        self.under = np.zeros(np.ceil(self.room / self.cell).astype(int) + 1)  # mm of lines in each cell
        self.shape: Floats = np.zeros_like(self.under)  # mm² of the shape in each cell

    def add_lines(self, lines: Floats, weight: float = 1.0) -> None:
        """Add straight lines, ``(n, 2, 2)``; a mm of them counts as ``weight`` mm."""
        for low in range(0, len(lines), BLOCK):
            some = lines[low : low + BLOCK] - self.inset
            length = np.hypot(*(some[:, 1] - some[:, 0]).T)
            count = np.ceil(2 * length / self.cell).astype(int) + 1
            row = np.repeat(np.arange(len(some)), count)
            share = (np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count) + 0.5) / count[row]
            points = some[row, 0] + share[:, None] * (some[row, 1] - some[row, 0])
            x, y = np.floor(points / self.cell).astype(int).T
            on = (x >= 0) & (x < len(self.under)) & (y >= 0) & (y < self.under.shape[1])
            np.add.at(self.under, (x[on], y[on]), (weight * length / count)[row][on])

    def add_polyline(self, points: Floats, weight: float = 1.0) -> None:
        """Add a polyline, ``(n, 2)``; a mm of it counts as ``weight`` mm."""
        self.add_lines(np.stack([points[:-1], points[1:]], axis=1), weight)

    def fill(self, x: float, y: float, width: float, height: float, weight: float = 1.0) -> None:
        """Fill a box with lines, to keep other boxes away; with a weight of -1 take them away again."""
        low, high = self._cells(x, y, width, height)
        self.under[low[0] : high[0], low[1] : high[1]] += weight * self.cell

    def centres(self) -> Floats:
        """Return the centres of the cells, ``(n, 2)``, for the caller to find those in the shape."""
        indices = np.stack(np.meshgrid(*map(np.arange, self.under.shape), indexing="ij"), axis=-1).reshape(-1, 2)
        return np.asarray(self.inset + (indices + 0.5) * self.cell)

    def set_shape(self, inside: Bools) -> None:
        """Set which cells are in the shape, ``(n,)`` in the order of ``centres``."""
        self.shape = np.where(inside.reshape(self.under.shape), self.cell**2, 0.0)

    def lines_under(self, x: float, y: float, width: float, height: float) -> float:
        """Return how many mm of lines are in a box, counted by all the cells that it touches."""
        low, high = self._cells(x, y, width, height)
        return float(self.under[low[0] : high[0], low[1] : high[1]].sum())

    def _cells(self, x: float, y: float, width: float, height: float) -> tuple[Indices, Indices]:
        """Return the lowest column and row of cells that a box touches, and the first ones beyond it."""
        low = np.floor((np.array([x, y]) - self.inset) / self.cell + 1e-9).astype(int)
        high = np.ceil((np.array([x + width, y + height]) - self.inset) / self.cell - 1e-9).astype(int)
        return np.maximum(low, 0), np.maximum(high, 0)

    def place(self, boxes: Sequence[Box], away: float = 0.0) -> Place:
        """Return the best place for one of the boxes; lines within ``away`` mm of it count as covered.

        Boxes too large for the page are passed over; if all are, the last one is put in the lower left corner.
        """
        best, place = np.inf, None
        for number, (width, height) in enumerate(boxes):
            steps = np.floor((self.room - (width, height)) / self.cell + 1e-9).astype(int) + 1
            if (steps < 1).any():
                continue
            cost = self._sums(self.under, width, height, away, steps)
            cost += IN_SHAPE * self._sums(self.shape, width, height, away, steps)
            right, up = (np.arange(count) * self.cell for count in steps)
            cost += FAR * (right[:, None] + up) + LATER * number
            i, j = np.unravel_index(int(np.argmin(cost)), cost.shape)
            if cost[i, j] < best:
                best = cost[i, j]
                place = Place(number, self.inset + float(right[i]), self.inset + float(up[j]), width, height)
        return place or Place(len(boxes) - 1, self.inset, self.inset, *boxes[-1])

    def _sums(self, cells: Floats, width: float, height: float, away: float, steps: Floats) -> Floats:
        """Return the sum of the cells under a box and around it, for every place where it fits."""
        more = int(np.ceil(away / self.cell))
        wide, high = (int(np.ceil(size / self.cell - 1e-9)) + 2 * more for size in (width, height))
        padded = np.pad(cells, ((more + 1, more + wide), (more + 1, more + high)))
        total = padded.cumsum(axis=0).cumsum(axis=1)
        m, n = steps
        sums = total[wide : wide + m, high : high + n] - total[:m, high : high + n] - total[wide : wide + m, :n]
        return np.asarray(np.maximum(sums + total[:m, :n], 0.0).round(6))
