"""The pages of a printer that a sheet needs, and how a sheet with two sides is turned over in it.

``Job`` and a ``Profile`` with the size of the printer's pages (``bed``) and their margins (``page``) -> a ``Tile`` for
each page. A sheet larger than a page is divided into tiles that overlap and are together centred on it, so that the
tiles of the back lie behind those of the front.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from foldcut.jobs.bed import TurnedOver
from foldcut.jobs.job import Job
from foldcut.profiles import Profile

Edge = Literal["long", "short"]
"""The edge of a page on which a printer for both sides turns it over."""


@dataclass(frozen=True)
class Tile:
    """A page of a sheet, in mm.

    ``width`` and ``height``: its size; ``x`` and ``y``: the place on the sheet where its lower left corner lies;
    ``inset``: the margin; ``row`` and ``column``: its place among the ``count`` pages.
    """

    width: float
    height: float
    x: float
    y: float
    inset: float
    row: int
    column: int
    count: int

    @property
    def tiled(self) -> bool:
        """Whether the sheet takes more than this page."""
        return self.count > 1

    @property
    def clear_width(self) -> float:
        """The width between the margins."""
        return self.width - 2 * self.inset

    @property
    def clear_height(self) -> float:
        """The height between the margins."""
        return self.height - 2 * self.inset


def tiles(job: Job, profile: Profile) -> Iterator[Tile]:
    """Yield the pages that a sheet needs, row by row from the upper left; turned if that takes fewer."""
    assert profile.bed is not None
    assert profile.page is not None
    width, height = job.size
    page = profile.bed.width_mm, profile.bed.height_mm
    slack = 1e-6
    for w, h in (page, page[::-1]):
        if width <= w + slack and height <= h + slack:
            yield Tile(w, h, -(w - width) / 2, -(h - height) / 2, 0.0, 0, 0, 1)
            return
    inset, overlap = profile.page.margin_mm, profile.page.overlap_mm

    def counts(w: float, h: float) -> tuple[int, int]:
        return tuple(
            max(1, math.ceil((size - overlap - slack) / (side - 2 * inset - overlap)))
            for size, side in ((width, w), (height, h))
        )  # type: ignore[return-value]

    w, h = min((page, page[::-1]), key=lambda size: math.prod(counts(*size)))
    columns, rows = counts(w, h)
    step = w - 2 * inset - overlap, h - 2 * inset - overlap
    # the tiles together are centred on the sheet
    left = (width - columns * step[0] - overlap) / 2
    low = (height - rows * step[1] - overlap) / 2
    for row in range(rows):
        for column in range(columns):
            x, y = left + column * step[0], low + (rows - 1 - row) * step[1]
            yield Tile(w, h, x - inset, y - inset, inset, row, column, rows * columns)


def pages_behind(front: Job, back: Job, profile: Profile) -> list[tuple[Tile, Tile]]:
    """Return each page of the front with the page of the back that is printed behind it."""
    fronts, backs = list(tiles(front, profile)), {(tile.row, tile.column): tile for tile in tiles(back, profile)}
    rows, columns = (1 + max(place) for place in zip(*backs, strict=True))
    if back.turned_over == "left to right":
        return [(tile, backs[tile.row, columns - 1 - tile.column]) for tile in fronts]
    return [(tile, backs[rows - 1 - tile.row, tile.column]) for tile in fronts]


def flip_edge(turned_over: TurnedOver, tile: Tile) -> Edge:
    """Return on which edge of a page the sheet is turned over: left to right, it is the one that stands upright."""
    edge, other = (tile.height, tile.width) if turned_over == "left to right" else (tile.width, tile.height)
    return "long" if edge >= other else "short"
