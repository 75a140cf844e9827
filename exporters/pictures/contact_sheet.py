"""The contact sheet: one picture with a thumbnail and the name of every pattern of a batch.

``thumbnail``: a ``FoldedPattern`` -> a few hundred numbers at most, which a batch keeps until all patterns are made.
``contact_sheet``: names and thumbnails -> SVG 1.1, one user unit is 1 mm. Mountains are dash-dotted and red, valleys
dashed and blue, the shape is yellow, as in ``pictures``; a line below says so.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import svgwrite

from foldcut.core.arrays import Floats
from foldcut.core.model import FoldedPattern
from foldcut.profiles import LineStyle

from ..pattern.svg import path_data, shortened
from ..text import number, printable

GRID = 1000
"""A thumbnail's longer side has so many steps: all of its coordinates are whole numbers."""

MOST_CREASES, MOST_POINTS = 300, 600
"""A thumbnail has the longest creases only, and of an outline evenly chosen corners; there is no room for more."""

THUMBNAIL_MM, CELL_MM, CAPTION_MM = 40.0, 46.0, 2.4

DASHES = 0.3
"""How long dashes are on a thumbnail, as a part of what they are on a sheet in true size."""

STROKE_MM, SAMPLE_MM, KEY_MM = 0.12, 5.0, 20.0
"""How wide creases are; how long a sample of the legend is, and the room for it and its word."""

TEXT = {"font_size": number(CAPTION_MM), "font_family": "sans-serif", "fill": "#222222"}


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


def contact_sheet(
    thumbnails: Sequence[tuple[str, Thumbnail]], title: str, look: LineStyle
) -> tuple[bytes, tuple[float, float]]:
    """Return the SVG of all thumbnails in rows, each over its name, and its width and height in mm.

    ``look`` has the colours of creases, and their dashes in true size.
    """
    columns = max(1, math.ceil(math.sqrt(len(thumbnails))))
    rows = max(1, math.ceil(len(thumbnails) / columns))
    gap = (CELL_MM - THUMBNAIL_MM) / 2
    legend = rows * (CELL_MM + 2 * CAPTION_MM)
    size = (columns * CELL_MM, legend + 2 * CAPTION_MM)
    drawing = svgwrite.Drawing(
        size=tuple(f"{number(side)}mm" for side in size),
        viewBox=f"0 0 {number(size[0])} {number(size[1])}",
        debug=False,
    )
    drawing.set_desc(title=printable(title))
    drawing.add(drawing.rect(size=size, fill="#ffffff"))
    scale = THUMBNAIL_MM / GRID
    mountain, valley = _styles(look, scale)
    for place, (name, picture) in enumerate(thumbnails):
        x = (place % columns) * CELL_MM + gap
        y = (place // columns) * (CELL_MM + 2 * CAPTION_MM) + gap
        at = f"translate({number(x)} {number(y)}) scale({number(scale)})"
        group = drawing.add(drawing.g(transform=at, fill="none", stroke_width=number(STROKE_MM / scale)))
        group.add(drawing.rect(size=(picture.width, picture.height), stroke="#888888"))
        for data, style in (
            (picture.shape, {"fill": "#ffe08a", "fill_rule": "evenodd"}),
            (picture.valleys, valley),
            (picture.mountains, mountain),
        ):
            if data:
                group.add(drawing.path(d=data, **style))
        caption = shortened(printable(name), THUMBNAIL_MM / CAPTION_MM)
        below = (number(x), number(y + picture.height * scale + 1.4 * CAPTION_MM))
        drawing.add(drawing.text(caption, insert=below, **TEXT))
    for count, (word, style) in enumerate(zip(("mountain", "valley"), _styles(look, 1.0), strict=True)):
        x, y = gap + count * KEY_MM, legend + 0.5 * CAPTION_MM
        sample = path_data([(x, y), (x + SAMPLE_MM, y)], closed=False)
        drawing.add(drawing.path(d=sample, fill="none", stroke_width=number(STROKE_MM), **style))
        beside = (number(x + SAMPLE_MM + 0.5 * CAPTION_MM), number(y + 0.35 * CAPTION_MM))
        drawing.add(drawing.text(word, insert=beside, **TEXT))
    text = ET.tostring(drawing.get_xml(), encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n{text}\n'.encode(), size


def _styles(look: LineStyle, scale: float) -> tuple[dict[str, str], dict[str, str]]:
    """Return the attributes of mountains and of valleys in a picture that is drawn at a scale."""
    dash, gap, dot = (number(DASHES * length / scale) for length in (look.dash_mm, look.gap_mm, look.dot_mm))
    return (
        {"stroke": look.mountain_colour, "stroke_dasharray": f"{dash} {gap} {dot} {gap}"},
        {"stroke": look.valley_colour, "stroke_dasharray": f"{dash} {gap}"},
    )
