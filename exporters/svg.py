"""SVG: a drawing of the crease pattern in true size, to print, to look at, or to give to a machine.

Input: a ``FoldedPattern`` and a ``Profile``; output: SVG 1.1. One user unit is 1 mm, y points down, nothing
is transformed. Inkscape layers in drawing order: Shape, Valley, Mountain, Cut (the sheet's outline),
Legend. Dashes are short line pieces and not a line style, because most programs that cut or plot drop
styles.
"""

from __future__ import annotations

import unicodedata
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import svgwrite
from svgwrite.extensions import Inkscape

from foldcut.model import Floats, FoldedPattern, Sheet
from foldcut.profiles import Profile

DIGITS = 4
"""Digits after the point, in mm: far below what any machine resolves."""


def export(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return ``pattern`` as an SVG file."""
    sheet = pattern.sheet
    size = (f"{_number(sheet.width)}mm", f"{_number(sheet.height)}mm")
    box = f"0 0 {_number(sheet.width)} {_number(sheet.height)}"
    drawing = svgwrite.Drawing(size=size, viewBox=box, debug=False)
    drawing.set_desc(title=_printable(pattern.title) or "foldcut")
    inkscape = Inkscape(drawing)

    def layer(label: str, colour: str, width: float, paths: Iterable[str]) -> Any:
        group = inkscape.layer(label=label, id=label.lower(), fill="none", stroke=colour, stroke_width=_number(width))
        for data in paths:
            group.add(drawing.path(d=data))
        return drawing.add(group)

    creases = pattern.creases
    lines = _flip(creases.vertices_coords, sheet)[creases.edges_vertices]
    mountains, valleys = (lines[creases.edges_assignment == letter] for letter in "MV")
    mountain_paths = (_segments(mountain_pieces(line, profile)) for line in mountains)
    valley_paths = (_segments(valley_pieces(line, profile)) for line in valleys)
    outlines = (_closed(_flip(loop, sheet)) for loop in pattern.shape.loops)
    layer("Shape", profile.shape_colour, profile.shape_stroke_mm, outlines)
    width = profile.crease_stroke_mm
    layer("Valley", profile.valley_colour, width, valley_paths)
    layer("Mountain", profile.mountain_colour, width, mountain_paths)
    layer("Cut", profile.border_colour, profile.border_stroke_mm, [_closed(_flip(sheet.corners, sheet))])

    legend = _legend(pattern.title, sheet, profile)
    group = layer("Legend", profile.legend_colour, profile.legend_stroke_mm, legend.paths)
    for text, x, y in legend.texts:
        place = (_number(x), _number(y))
        group.add(drawing.text(text, insert=place, fill=profile.legend_colour, stroke="none", **legend.font))

    root = drawing.get_xml()
    ET.indent(root, " ")
    text = ET.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n{text}\n'.encode()


def valley_pieces(line: Floats, profile: Profile) -> Floats:
    """Return the dashes along a valley, ``(n, 2, 2)``, stretched a little so that both ends have ink."""
    dash, gap = profile.dash_mm, profile.gap_mm
    count = round((_length(line) - dash) / (dash + gap))
    return _divided(line, [dash, gap] * max(0, count) + [dash])


def mountain_pieces(line: Floats, profile: Profile) -> Floats:
    """Return the dashes and dots along a mountain, ``(n, 2, 2)``, stretched to begin and end with a dash."""
    dash, gap, dot = profile.dash_mm, profile.gap_mm, profile.dot_mm
    count = round((_length(line) - dash) / (dash + gap + dot + gap))
    return _divided(line, [dash, gap, dot, gap] * max(0, count) + [dash])


def _divided(line: Floats, lengths: Sequence[float]) -> Floats:
    """Divide a line in these proportions and return every other part, the first and the last among them."""
    ends = np.concatenate([[0.0], np.cumsum(lengths) / np.sum(lengths)])
    start, end = line
    points: Floats = start + ends[:, None] * (end - start)
    points[-1] = end
    return points.reshape(-1, 2, 2)


def _length(line: Floats) -> float:
    return float(np.hypot(*(line[1] - line[0])))


def _flip(points: Floats, sheet: Sheet) -> Floats:
    """Return the points with y down, as SVG has it."""
    return np.column_stack([points[:, 0], sheet.height - points[:, 1]])


# Text of the legend. Letters of common sans-serif fonts are 0.5 to 0.6 of the size wide on average.
LETTER_WIDTH = 0.6
LINE_HEIGHT = 1.6


@dataclass(frozen=True)
class _Legend:
    """What the legend draws: path data, texts with their left baseline ends, and the font of the texts."""

    paths: list[str]
    texts: list[tuple[str, float, float]]
    font: dict[str, str]


def _legend(title: str, sheet: Sheet, profile: Profile) -> _Legend:
    """Set the legend in rows along the bottom edge, the ruler lowest, all inside the sheet."""
    small = sheet.width < profile.small_sheet_mm
    ruler = profile.small_ruler_mm if small else profile.ruler_mm
    inset = min(profile.inset_mm, 0.05 * sheet.width)
    size = min(profile.text_mm, 0.025 * sheet.width)
    sample = profile.sample_mm * size / profile.text_mm
    sample_line = np.array([[0.0, 0.0], [sample, 0.0]])
    samples = [
        (mountain_pieces(sample_line, profile), "mountain: fold away from you"),
        (valley_pieces(sample_line, profile), "valley: fold toward you"),
        (sample_line[None], "shape: the one straight cut, when folded flat"),
    ]
    legend = _Legend([], [], {"font_family": "sans-serif", "font_size": _number(size)})
    x, y, right = inset, sheet.height - inset, sheet.width - inset
    if x + ruler + 4 * size <= sheet.width:
        _add_ruler(legend, ruler, x, y, size)
        x += ruler + 6 * size
    title = _shortened(_printable(title), (right - inset) / size)
    if x + _text_width(title) * size > right:
        x, y = inset, y - 2 * LINE_HEIGHT * size
    if title:
        legend.texts.append((title, x, y))
    x, y = inset, y - 2 * LINE_HEIGHT * size
    for pieces, text in samples:
        width = sample + (0.5 + _text_width(text)) * size
        if x > inset and x + width > right:
            x, y = inset, y - LINE_HEIGHT * size
        legend.paths.append(_segments(pieces + np.array([x, y - 0.35 * size])))
        legend.texts.append((text, x + sample + 0.5 * size, y))
        x += width + 2 * size
    return legend


def _add_ruler(legend: _Legend, length: float, x: float, y: float, size: float) -> None:
    """Add a ruler from (x, y) to the right: a tick every mm, longer at 5 and 10, and its length in words."""
    ticks = [f"M{_point((x, y))}H{_number(x + length)}"]
    for mm in range(round(length) + 1):
        height = size * (1.0 if mm % 10 == 0 else 0.7 if mm % 5 == 0 else 0.4)
        ticks.append(f"M{_point((x + mm, y))}V{_number(y - height)}")
    legend.paths.append("".join(ticks))
    legend.texts.append((f"{length:g} mm", x + length + 0.5 * size, y))


def _printable(text: str) -> str:
    """Return the text without the characters that XML forbids or nobody sees."""
    return "".join(filter(str.isprintable, text))


def _text_width(text: str) -> float:
    """Estimate how wide a text is, in font sizes."""
    return sum(1.0 if unicodedata.east_asian_width(letter) in "WF" else LETTER_WIDTH for letter in text)


def _shortened(text: str, room: float) -> str:
    """Return the text, cut off with an ellipsis if it is wider than ``room`` font sizes."""
    if _text_width(text) <= room:
        return text
    while text and _text_width(text + "…") > room:
        text = text[:-1]
    return text + "…"


def _segments(pieces: Floats) -> str:
    """Return path data of separate line pieces, ``(n, 2, 2)``."""
    return "".join(f"M{_point(start)}L{_point(end)}" for start, end in pieces.tolist())


def _closed(loop: Floats) -> str:
    """Return path data of a closed polygon, ``(n, 2)``."""
    return "M" + "L".join(map(_point, loop.tolist())) + "Z"


def _point(point: Sequence[float]) -> str:
    return f"{_number(point[0])} {_number(point[1])}"


def _number(value: float) -> str:
    """Return a number of mm in the shortest form, without exponent or negative zero."""
    text = f"{value:.{DIGITS}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
