"""The contact sheet: one picture with a thumbnail and the name of every pattern of a batch.

``thumbnail``: a ``FoldedPattern`` -> a few hundred numbers at most, which a batch keeps until all patterns are made.
``contact_sheet``: names and thumbnails -> SVG 1.1, one user unit is 1 mm. Mountains are red, valleys blue, the shape
is yellow, as in ``pictures``.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import svgwrite

from foldcut.model import Floats, FoldedPattern

from .svg import path_data, shortened
from .text import number, printable

GRID = 1000
"""A thumbnail's longer side has so many steps: all of its coordinates are whole numbers."""

MOST_CREASES, MOST_POINTS = 300, 600
"""A thumbnail has the longest creases only, and of an outline evenly chosen corners; there is no room for more."""

THUMBNAIL_MM, CELL_MM, CAPTION_MM = 40.0, 46.0, 2.4


@dataclass(frozen=True)
class Thumbnail:
    """A pattern on a grid, y down: ``width`` and ``height`` of its sheet, and path data."""

    width: int
    height: int
    shape: str
    mountains: str
    valleys: str


def thumbnail(pattern: FoldedPattern) -> Thumbnail:
    """Return what is seen of a pattern at the size of a stamp."""
    sheet, creases = pattern.sheet, pattern.creases
    scale = GRID / max(sheet.width, sheet.height)

    def placed(points: Floats) -> list[list[int]]:
        moved: list[list[int]] = np.rint((points * (1, -1) + (0, sheet.height)) * scale).astype(int).tolist()
        return moved

    folded = np.flatnonzero(np.isin(creases.edges_assignment, ("M", "V")))
    ends = creases.vertices_coords[creases.edges_vertices]
    lengths = np.hypot(*(ends[folded, 1] - ends[folded, 0]).T)
    longest = folded[np.argsort(-lengths, kind="stable")[:MOST_CREASES]]

    def lines(letter: str) -> str:
        some = longest[creases.edges_assignment[longest] == letter]
        return "".join(path_data(placed(line), closed=False) for line in ends[some])

    step = math.ceil(pattern.shape.corner_count / MOST_POINTS)
    loops = (path_data(placed(loop[::step]), closed=True) for loop in pattern.shape.loops)
    return Thumbnail(round(sheet.width * scale), round(sheet.height * scale), "".join(loops), lines("M"), lines("V"))


def contact_sheet(thumbnails: Sequence[tuple[str, Thumbnail]], title: str) -> tuple[bytes, tuple[float, float]]:
    """Return the SVG of all thumbnails in rows, each over its name, and its width and height in mm."""
    columns = max(1, math.ceil(math.sqrt(len(thumbnails))))
    rows = max(1, math.ceil(len(thumbnails) / columns))
    gap = (CELL_MM - THUMBNAIL_MM) / 2
    size = (columns * CELL_MM, rows * (CELL_MM + 2 * CAPTION_MM))
    drawing = svgwrite.Drawing(
        size=tuple(f"{number(side)}mm" for side in size),
        viewBox=f"0 0 {number(size[0])} {number(size[1])}",
        debug=False,
    )
    drawing.set_desc(title=printable(title))
    drawing.add(drawing.rect(size=size, fill="#ffffff"))
    scale = THUMBNAIL_MM / GRID
    for place, (name, picture) in enumerate(thumbnails):
        x = (place % columns) * CELL_MM + gap
        y = (place // columns) * (CELL_MM + 2 * CAPTION_MM) + gap
        at = f"translate({number(x)} {number(y)}) scale({number(scale)})"
        group = drawing.add(drawing.g(transform=at, fill="none", stroke_width=number(0.12 / scale)))
        group.add(drawing.rect(size=(picture.width, picture.height), stroke="#888888"))
        for data, look in (
            (picture.shape, {"fill": "#ffe08a", "fill_rule": "evenodd"}),
            (picture.valleys, {"stroke": "#0000ff"}),
            (picture.mountains, {"stroke": "#ff0000"}),
        ):
            if data:
                group.add(drawing.path(d=data, **look))
        caption = shortened(printable(name), THUMBNAIL_MM / CAPTION_MM)
        below = (number(x), number(y + picture.height * scale + 1.4 * CAPTION_MM))
        drawing.add(
            drawing.text(caption, insert=below, font_size=number(CAPTION_MM), font_family="sans-serif", fill="#222222")
        )
    text = ET.tostring(drawing.get_xml(), encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n{text}\n'.encode(), size
