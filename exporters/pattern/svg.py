"""SVG: a drawing of the crease pattern at true size, to print, to look at, or to give to a machine.

Input: a ``FoldedPattern`` and a ``Profile``; output: SVG 1.1. One user unit is 1 mm, y points down, nothing is
transformed. The Inkscape layers, in drawing order, are First-fold (if there are first folds: wide and pale, under the
creases), Shape, Valley, Mountain, Cut (the sheet's outline) and Legend. Each dash is a line of its own and not part of
a line style (``jobs.dashes``).
"""

from __future__ import annotations

import unicodedata
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from textwrap import wrap
from typing import Any

import numpy as np
import svgwrite
from svgwrite.extensions import Inkscape

from foldcut.core.arrays import Floats
from foldcut.core.model import FoldedPattern, Sheet
from foldcut.jobs.dashes import mountain_pieces, valley_pieces
from foldcut.pattern.cut_line import contains
from foldcut.pattern.first_folds import is_wedge
from foldcut.profiles import LineStyle, Profile

from ..legend import BACKING, Corner, Ground, Place
from ..text import number, printable


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
    outlines = [_closed(_flip(loop, sheet)) for loop in pattern.shape.loops]
    outlines += [path_data(_flip(line, sheet).tolist(), closed=False) for line in pattern.shape.lines]
    if pattern.first_folds:
        wide = WIDE * look.crease_stroke_mm
        firsts = [_segments(_flip(line, sheet)[None]) for line in pattern.first_folds]
        layer("First-fold", look.legend_colour, wide, firsts).update({"stroke-opacity": PALE})
    layer("Shape", look.shape_colour, look.shape_stroke_mm, outlines)
    width = look.crease_stroke_mm
    layer("Valley", look.valley_colour, width, valley_paths)
    layer("Mountain", look.mountain_colour, width, mountain_paths)
    layer("Cut", look.border_colour, look.border_stroke_mm, [_closed(_flip(sheet.corners, sheet))])

    parts, backings = _placed_legend(pattern, look)
    group = layer("Legend", look.legend_colour, look.legend_stroke_mm, [])
    for x, y, width, height in backings:
        place, size = (number(x), number(sheet.height - y - height)), (number(width), number(height))
        group.add(drawing.rect(insert=place, size=size, fill="#ffffff", fill_opacity=BACKING, stroke="none"))
    for part, corner in parts:
        for strokes in part.strokes:
            group.add(drawing.path(d=_segments((strokes + np.array(corner)) * (1, -1) + (0, sheet.height))))
    for part, (left, low) in parts:
        font = {"font_family": "sans-serif", "font_size": number(part.size)}
        for text, x, y in part.texts:
            place = (number(left + x), number(sheet.height - low - y))
            group.add(drawing.text(text, insert=place, fill=look.legend_colour, stroke="none", **font))

    return with_paths(drawing, paths_of)


def with_paths(drawing: Any, paths_of: Mapping[str, Iterable[str]]) -> bytes:
    """Return the file of an svgwrite drawing, with paths put first into its layers: path data by the layer's id.

    Paths are added as text, since an XML element for each would take most of the time and memory.
    """
    root = drawing.get_xml()
    paths = {name: [f'\n  <path d="{data}" />' for data in some] for name, some in paths_of.items()}
    ends = {}
    for group in root:
        name = group.get("id")
        if paths.get(name):
            group.text = f"\x00{name}\x00"  # a mark that no printable text has
            ends[name] = "\n  " if len(group) else "\n "
    ET.indent(root, " ")
    parts = ET.tostring(root, encoding="unicode").split("\x00")
    parts[1::2] = ["".join([*paths[name], ends[name]]) for name in parts[1::2]]
    return "".join(['<?xml version="1.0" encoding="utf-8"?>\n', *parts, "\n"]).encode()


def _flip(points: Floats, sheet: Sheet) -> Floats:
    """Return the points with y pointing down, as in SVG."""
    return np.column_stack([points[:, 0], sheet.height - points[:, 1]])


LETTER_WIDTH = 0.6
"""The width of a letter, as a multiple of the size of the text: common sans-serif fonts average 0.5 to 0.6."""

LINE_HEIGHT = 1.6
"""The distance between lines of text, as a multiple of its size."""

DESCENT = 0.3
"""How far letters reach below the baseline, as a multiple of the size of the text."""

WIDE = 8.0
"""The width of the line of a first fold, as a multiple of the width of a crease."""

PALE = 0.25
"""The opacity of the line of a first fold."""

AWAY = 0.5
"""How far the legend keeps from lines, where it can, as a multiple of the size of its text."""

OUTLINE = 4.0
"""A mm of the shape's outline counts as this many mm of creases when the legend looks for its place."""


@dataclass(frozen=True)
class _Legend:
    """What a legend draws, in mm, y up, with (0, 0) at its lower left corner.

    ``size``: that of its text; ``strokes``: lines, ``(n, 2, 2)`` each; ``texts``, each with the left end of its
    baseline; ``boxes``: the parts that have to stay readable, ``(x, y, width, height)``.
    """

    size: float
    strokes: list[Floats]
    texts: list[tuple[str, float, float]]
    boxes: list[tuple[float, float, float, float]]

    def add(self, text: str, x: float, y: float, strokes: Floats | None = None, indent: float = 0.0) -> float:
        """Add a text ``indent`` mm right of (x, y), and the strokes in front of it; return where it ends."""
        if strokes is not None:
            self.strokes.append(strokes)
        self.texts.append((text, x + indent, y))
        width = indent + _text_width(text) * self.size
        self.boxes.append((x, y - DESCENT * self.size, width, LINE_HEIGHT * self.size))
        return x + width

    @property
    def extent(self) -> tuple[float, float]:
        """Its width and height in mm."""
        right, top = zip(*((x + width, y + height) for x, y, width, height in self.boxes), strict=True)
        return max(right), max(top)


def _placed_legend(
    pattern: FoldedPattern, look: LineStyle
) -> tuple[list[tuple[_Legend, Corner]], list[tuple[float, ...]]]:
    """Return the parts of the legend with the places of their lower left corners, and the boxes to back with white.

    The legend is put where it covers the fewest lines. It is divided if that covers fewer still: into the key, which
    says what lines mean, and the ruler with the title. Boxes that cover lines all the same get a backing.
    """
    sheet, creases = pattern.sheet, pattern.creases
    inset = min(look.inset_mm, 0.05 * sheet.width)
    widest = sheet.width - 2 * inset
    ground = Ground(sheet.width, sheet.height, inset)
    ground.add_lines(creases.vertices_coords[creases.edges_vertices[creases.edges_assignment != "B"]])
    for stroke in pattern.shape.strokes:
        ground.add_polyline(stroke, OUTLINE)
    for line in pattern.first_folds:
        ground.add_polyline(line)
    ground.set_shape(contains(pattern.shape, ground.centres()))

    def best(*, key: bool, ruler: bool) -> tuple[_Legend, Place]:
        rooms = ((widest, 99), (0.0, 99), (0.0, 28))
        legends = [_legend(pattern, look, width, letters, key=key, ruler=ruler) for width, letters in rooms]
        place = ground.place([legend.extent for legend in legends], AWAY * legends[0].size)
        return legends[place.box], place

    def under(parts: list[tuple[_Legend, Place]]) -> float:
        return sum(ground.lines_under(place.x, place.y, place.width, place.height) for _, place in parts)

    parts = [best(key=True, ruler=True)]
    if lines := under(parts):
        apart = [best(key=True, ruler=False)]
        key = apart[0][1]
        more = under(apart)
        ground.fill(key.x, key.y, key.width, key.height)
        apart.append(best(key=False, ruler=True))
        if more + under(apart[1:]) < lines:
            parts = apart
        ground.fill(key.x, key.y, key.width, key.height, -1)
    boxes = [
        (place.x + x, place.y + y, width, height) for legend, place in parts for x, y, width, height in legend.boxes
    ]
    return [(legend, (place.x, place.y)) for legend, place in parts], [box for box in boxes if ground.lines_under(*box)]


def _legend(pattern: FoldedPattern, look: LineStyle, room: float, letters: int, *, key: bool, ruler: bool) -> _Legend:
    """Set the key, and below it the ruler with the title, in rows that fill ``room`` mm.

    Texts of more than ``letters`` letters are broken into lines.
    """
    sheet = pattern.sheet
    small = sheet.width < look.small_sheet_mm
    length = look.small_ruler_mm if small else look.ruler_mm
    inset = min(look.inset_mm, 0.05 * sheet.width)
    size = min(look.text_mm, 0.025 * sheet.width)
    sample = look.sample_mm * size / look.text_mm
    sample_line = np.array([[0.0, 0.0], [sample, 0.0]])
    samples = [
        (mountain_pieces(sample_line, look), "mountain: fold away from you"),
        (valley_pieces(sample_line, look), "valley: fold toward you"),
        (sample_line[None], "shape: the one straight cut, when folded flat"),
    ]
    if pattern.first_folds:
        edges = np.array([-0.5, 0.5]) * WIDE * look.crease_stroke_mm
        into = "into a wedge" if is_wedge(pattern.first_folds) else "in half"
        samples.append(
            (sample_line + np.stack([0 * edges, edges], axis=1)[:, None], f"first: fold {into}, away from you")
        )
    legend = _Legend(size, [], [], [])
    indent = sample + 0.5 * size
    broken = [(pieces, wrap(text, letters)) for pieces, text in samples]
    room = max(room, indent + max(_text_width(row) for _, rows in broken for row in rows) * size)
    x, y = 0.0, DESCENT * size
    if ruler and inset + length + 4 * size <= sheet.width:
        x = legend.add(f"{length:g} mm", x, y, _ruler(length, size) + np.array([x, y]), length + 0.5 * size) + 2 * size
    title = shortened(printable(pattern.title), room / size)
    if x and x + _text_width(title) * size > room:
        x, y = 0.0, y + 2 * LINE_HEIGHT * size
    if ruler and title:
        legend.add(title, x, y)
    x, y = 0.0, y + (2 * LINE_HEIGHT * size if legend.texts else 0.0)
    for pieces, rows in reversed(broken) if key else ():
        width = indent + max(map(_text_width, rows)) * size
        if x and x + width > room:
            x, y = 0.0, y + LINE_HEIGHT * size
        for row in rows[:0:-1]:
            legend.add(row, x, y, indent=indent)
            y += LINE_HEIGHT * size
        x = legend.add(rows[0], x, y, pieces + np.array([x, y + 0.35 * size]), indent) + 2 * size
    return legend


def _ruler(length: float, size: float) -> Floats:
    """Return the lines of a ruler from (0, 0) to the right, ``(n, 2, 2)``: a tick every mm, longer ones at 5 and 10."""
    heights = [size * (1.0 if mm % 10 == 0 else 0.7 if mm % 5 == 0 else 0.4) for mm in range(round(length) + 1)]
    return np.array([[(0, 0), (length, 0)], *([(mm, 0), (mm, height)] for mm, height in enumerate(heights))])


def _text_width(text: str) -> float:
    """Estimate the width of a text, as a multiple of its size."""
    return sum(1.0 if unicodedata.east_asian_width(letter) in "WF" else LETTER_WIDTH for letter in text)


def shortened(text: str, room: float) -> str:
    """Return the text, cut short with an ellipsis if it is wider than ``room`` times its size."""
    if _text_width(text) <= room:
        return text
    while text and _text_width(text + "…") > room:
        text = text[:-1]
    return text + "…"


def _segments(pieces: Floats) -> str:
    """Return path data of separate lines, ``(n, 2, 2)``."""
    return "".join(f"M{_point(start)}L{_point(end)}" for start, end in pieces.tolist())


def path_data(points: Iterable[Sequence[float]], *, closed: bool) -> str:
    """Return path data of a polyline or a closed polygon."""
    return "M" + "L".join(map(_point, points)) + ("Z" if closed else "")


def _closed(loop: Floats) -> str:
    """Return path data of a closed polygon, ``(n, 2)``."""
    return path_data(loop.tolist(), closed=True)


def _point(point: Sequence[float]) -> str:
    return f"{number(point[0])} {number(point[1])}"
