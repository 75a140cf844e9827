"""The contact sheet: one picture with a thumbnail and the name of every pattern of a batch.

``thumbnail``: a ``FoldedPattern`` -> a few hundred numbers, small enough for a batch to keep until all patterns are
made. ``contact_sheet``: names and thumbnails -> SVG 1.1, one user unit is 1 mm. Mountains are dash-dotted and red,
valleys dashed and blue, the shape is yellow, as in ``pictures``; where the outline was drawn anew it is black, over the
drawing in grey. A line at the bottom says so.
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
"""A thumbnail's coordinates are whole numbers, from 0 to this along its longer side."""

MOST_CREASES = 300
"""A thumbnail shows only the longest creases, at most this many: there is no room for more."""

MOST_POINTS = 600
"""A thumbnail's outlines have at most this many corners, chosen evenly."""

THUMBNAIL_MM = 40.0
"""The length of a thumbnail's longer side."""

CELL_MM = 46.0
"""The width of the cell around a thumbnail; it is higher by the caption."""

CAPTION_MM = 2.4
"""The size of captions."""

DASHES = 0.3
"""The length of dashes on a thumbnail, as a fraction of their length on a sheet at true size."""

STROKE_MM = 0.12
"""The width of creases."""

SAMPLE_MM = 5.0
"""The length of a sample line in the legend."""

KEY_MM = 20.0
"""The room for a sample line and its word."""

DRAWN = {"stroke": "#8a8a8a"}
"""The attributes of the drawing, where the outline that is cut out is another."""

CUT_OUT = {"stroke": "#000000"}
"""The attributes of that outline."""

TEXT = {"font_size": number(CAPTION_MM), "font_family": "sans-serif", "fill": "#222222"}
"""The attributes of words."""


@dataclass(frozen=True)
class Thumbnail:
    """A pattern on a grid of whole numbers, y down: ``width`` and ``height`` of its sheet, and path data.

    ``drawn``: the drawing, if the shape is another outline.
    """

    width: int
    height: int
    shape: str
    mountains: str
    valleys: str
    drawn: str = ""


def thumbnail(pattern: FoldedPattern) -> Thumbnail:
    """Return what can be seen of a pattern at the size of a stamp."""
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

    def outlines(loops: Sequence[Floats]) -> str:
        step = max(1, math.ceil(sum(map(len, loops)) / MOST_POINTS))
        return "".join(path_data(placed(loop[::step]), closed=True) for loop in loops)

    size = round(sheet.width * scale), round(sheet.height * scale)
    return Thumbnail(*size, outlines(pattern.shape.closed_strokes), lines("M"), lines("V"), outlines(pattern.drawn))


def contact_sheet(
    thumbnails: Sequence[tuple[str, Thumbnail]], title: str, look: LineStyle
) -> tuple[bytes, tuple[float, float]]:
    """Return an SVG of all thumbnails in rows, each above its name, and its width and height in mm.

    ``look``: the colours of creases, and their dashes at true size.
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
            (picture.drawn, DRAWN),
            (picture.shape if picture.drawn else "", CUT_OUT),
        ):
            if data:
                group.add(drawing.path(d=data, **style))
        caption = shortened(printable(name), THUMBNAIL_MM / CAPTION_MM)
        below = (number(x), number(y + picture.height * scale + 1.4 * CAPTION_MM))
        drawing.add(drawing.text(caption, insert=below, **TEXT))
    redrawn = any(picture.drawn for _, picture in thumbnails)
    keys = list(zip(("mountain", "valley"), _styles(look, 1.0), strict=True))
    keys += [("drawing", DRAWN), ("cut out", CUT_OUT)] * redrawn
    for count, (word, style) in enumerate(keys):
        x, y = gap + count * KEY_MM, legend + 0.5 * CAPTION_MM
        sample = path_data([(x, y), (x + SAMPLE_MM, y)], closed=False)
        drawing.add(drawing.path(d=sample, fill="none", stroke_width=number(STROKE_MM), **style))
        beside = (number(x + SAMPLE_MM + 0.5 * CAPTION_MM), number(y + 0.35 * CAPTION_MM))
        drawing.add(drawing.text(word, insert=beside, **TEXT))
    text = ET.tostring(drawing.get_xml(), encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n{text}\n'.encode(), size


def _styles(look: LineStyle, scale: float) -> tuple[dict[str, str], dict[str, str]]:
    """Return the attributes of mountains and of valleys in a group that is drawn at a scale."""
    dash, gap, dot = (number(DASHES * length / scale) for length in (look.dash_mm, look.gap_mm, look.dot_mm))
    return (
        {"stroke": look.mountain_colour, "stroke_dasharray": f"{dash} {gap} {dot} {gap}"},
        {"stroke": look.valley_colour, "stroke_dasharray": f"{dash} {gap}"},
    )
