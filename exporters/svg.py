"""SVG: a drawing of the crease pattern in true size, to print, to look at, or to give to a machine.

Input: a ``FoldedPattern`` and a ``Profile``; output: SVG 1.1. One user unit is 1 mm, y points down, nothing
is transformed. Inkscape layers in drawing order: First-fold (if there is one: wide and pale, under the creases),
Shape, Valley, Mountain, Cut (the sheet's outline), Legend. Dashes are short line pieces and not a line style,
because most programs that cut or plot drop styles.
"""

from __future__ import annotations

import unicodedata
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import svgwrite
from svgwrite.extensions import Inkscape

from foldcut.job import mountain_pieces, valley_pieces
from foldcut.model import Floats, FoldedPattern, Sheet
from foldcut.profiles import Drawing, Profile

from .text import number, printable


def export(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return ``pattern`` as an SVG file."""
    look = profile.drawing
    sheet = pattern.sheet
    size = (f"{number(sheet.width)}mm", f"{number(sheet.height)}mm")
    box = f"0 0 {number(sheet.width)} {number(sheet.height)}"
    drawing = svgwrite.Drawing(size=size, viewBox=box, debug=False)
    drawing.set_desc(title=printable(pattern.title) or "foldcut")
    inkscape = Inkscape(drawing)

    paths_of: dict[str, Iterable[str]] = {}

    def layer(label: str, colour: str, width: float, paths: Iterable[str]) -> Any:
        paths_of[label.lower()] = paths
        group = inkscape.layer(label=label, id=label.lower(), fill="none", stroke=colour, stroke_width=number(width))
        return drawing.add(group)

    creases = pattern.creases
    lines = _flip(creases.vertices_coords, sheet)[creases.edges_vertices]
    mountains, valleys = (lines[creases.edges_assignment == letter] for letter in "MV")
    mountain_paths = (_segments(mountain_pieces(line, look)) for line in mountains)
    valley_paths = (_segments(valley_pieces(line, look)) for line in valleys)
    outlines = (_closed(_flip(loop, sheet)) for loop in pattern.shape.loops)
    if pattern.first_folds:
        wide = WIDE * look.crease_stroke_mm
        firsts = [_segments(_flip(line, sheet)[None]) for line in pattern.first_folds]
        layer("First-fold", look.legend_colour, wide, firsts).update({"stroke-opacity": PALE})
    layer("Shape", look.shape_colour, look.shape_stroke_mm, outlines)
    width = look.crease_stroke_mm
    layer("Valley", look.valley_colour, width, valley_paths)
    layer("Mountain", look.mountain_colour, width, mountain_paths)
    layer("Cut", look.border_colour, look.border_stroke_mm, [_closed(_flip(sheet.corners, sheet))])

    legend = _legend(pattern.title, sheet, look, first_fold=bool(pattern.first_folds))
    group = layer("Legend", look.legend_colour, look.legend_stroke_mm, legend.paths)
    for text, x, y in legend.texts:
        place = (number(x), number(y))
        group.add(drawing.text(text, insert=place, fill=look.legend_colour, stroke="none", **legend.font))

    return with_paths(drawing, paths_of)


def with_paths(drawing: Any, paths_of: Mapping[str, Iterable[str]]) -> bytes:
    """Return the file of an svgwrite drawing whose layers, by id, get paths of this data before what is in them.

    An element for each path would take most of the time, and of the memory.
    """
    root = drawing.get_xml()
    paths = {name: [f'\n  <path d="{data}" />' for data in some] for name, some in paths_of.items()}
    ends = {}
    for group in root:
        name = group.get("id")
        if paths.get(name):
            group.text = f"\x00{name}\x00"  # nothing that is printable
            ends[name] = "\n  " if len(group) else "\n "
    ET.indent(root, " ")
    parts = ET.tostring(root, encoding="unicode").split("\x00")
    parts[1::2] = ["".join([*paths[name], ends[name]]) for name in parts[1::2]]
    return "".join(['<?xml version="1.0" encoding="utf-8"?>\n', *parts, "\n"]).encode()


def _flip(points: Floats, sheet: Sheet) -> Floats:
    """Return the points with y down, as SVG has it."""
    return np.column_stack([points[:, 0], sheet.height - points[:, 1]])


# Text of the legend. Letters of common sans-serif fonts are 0.5 to 0.6 of the size wide on average.
LETTER_WIDTH = 0.6
LINE_HEIGHT = 1.6

WIDE, PALE = 8.0, 0.25
"""How many times as wide as a crease the line of the first fold is, and its opacity."""


@dataclass(frozen=True)
class _Legend:
    """What the legend draws: path data, texts with their left baseline ends, and the font of the texts."""

    paths: list[str]
    texts: list[tuple[str, float, float]]
    font: dict[str, str]


def _legend(title: str, sheet: Sheet, look: Drawing, *, first_fold: bool) -> _Legend:
    """Set the legend in rows along the bottom edge, the ruler lowest, all inside the sheet."""
    small = sheet.width < look.small_sheet_mm
    ruler = look.small_ruler_mm if small else look.ruler_mm
    inset = min(look.inset_mm, 0.05 * sheet.width)
    size = min(look.text_mm, 0.025 * sheet.width)
    sample = look.sample_mm * size / look.text_mm
    sample_line = np.array([[0.0, 0.0], [sample, 0.0]])
    samples = [
        (mountain_pieces(sample_line, look), "mountain: fold away from you"),
        (valley_pieces(sample_line, look), "valley: fold toward you"),
        (sample_line[None], "shape: the one straight cut, when folded flat"),
    ]
    if first_fold:
        edges = np.array([-0.5, 0.5]) * WIDE * look.crease_stroke_mm
        samples.append(
            (sample_line + np.stack([0 * edges, edges], axis=1)[:, None], "first: fold in half, away from you")
        )
    legend = _Legend([], [], {"font_family": "sans-serif", "font_size": number(size)})
    x, y, right = inset, sheet.height - inset, sheet.width - inset
    if x + ruler + 4 * size <= sheet.width:
        _add_ruler(legend, ruler, x, y, size)
        x += ruler + 6 * size
    title = shortened(printable(title), (right - inset) / size)
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
    ticks = [f"M{_point((x, y))}H{number(x + length)}"]
    for mm in range(round(length) + 1):
        height = size * (1.0 if mm % 10 == 0 else 0.7 if mm % 5 == 0 else 0.4)
        ticks.append(f"M{_point((x + mm, y))}V{number(y - height)}")
    legend.paths.append("".join(ticks))
    legend.texts.append((f"{length:g} mm", x + length + 0.5 * size, y))


def _text_width(text: str) -> float:
    """Estimate how wide a text is, in font sizes."""
    return sum(1.0 if unicodedata.east_asian_width(letter) in "WF" else LETTER_WIDTH for letter in text)


def shortened(text: str, room: float) -> str:
    """Return the text, cut off with an ellipsis if it is wider than ``room`` font sizes."""
    if _text_width(text) <= room:
        return text
    while text and _text_width(text + "…") > room:
        text = text[:-1]
    return text + "…"


def _segments(pieces: Floats) -> str:
    """Return path data of separate line pieces, ``(n, 2, 2)``."""
    return "".join(f"M{_point(start)}L{_point(end)}" for start, end in pieces.tolist())


def path_data(points: Iterable[Sequence[float]], *, closed: bool) -> str:
    """Return path data of a polyline or a closed polygon."""
    return "M" + "L".join(map(_point, points)) + ("Z" if closed else "")


def _closed(loop: Floats) -> str:
    """Return path data of a closed polygon, ``(n, 2)``."""
    return path_data(loop.tolist(), closed=True)


def _point(point: Sequence[float]) -> str:
    return f"{number(point[0])} {number(point[1])}"
