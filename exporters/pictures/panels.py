"""Panels: pictures fitted into a frame, with labels and a legend, and laid out in rows as SVG.

Input: what a panel shows, in its own coordinates with y up; output: SVG 1.1, one user unit is 1 mm. The longer side of
a panel is ``PANEL_MM``. Strokes, dashes and letters have sizes in mm on the panel, whatever the size of what is shown,
so that a panel can be read when it is 100 mm wide; everything grows in a larger print.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import svgwrite

from foldcut.core.arrays import Floats
from foldcut.jobs.dashes import mountain_pieces, valley_pieces
from foldcut.profiles import LineStyle

from ..pattern.svg import path_data
from ..text import number, printable

PANEL_MM = 100.0
"""The longer side of a panel."""

GAP_MM = 8.0
"""The distance between panels."""

TEXT_MM = 2.8
"""The size of the text."""

LETTER = 0.53
"""The width of a letter, as a multiple of the size of the text."""

LINE = 1.7
"""The distance between lines of text, as a multiple of its size."""

EDGE = 0.12
"""The width of the edges of faces, in mm."""

STROKE = 0.3
"""The width of strokes, in mm."""

BOLD = 0.6
"""The width of bold strokes, in mm."""

EDGE_COLOUR = "#444444"
"""The colour of the edges of faces."""

LIGHTEST = 0.06
"""The least width of strokes, in mm."""

SHARE = 0.07
"""The width of strokes where lines are short, as a fraction of the lines' length."""

DASHES = 0.45
"""The length of dashes on a panel, as a fraction of their length on a sheet at true size."""

Dash = Callable[[Floats], Floats]
"""Divides a line, ``(2, 2)``, into pieces, ``(n, 2, 2)``."""


@dataclass(frozen=True, eq=False)
class Item:
    """Polylines, or polygons if ``closed``, ``(n, 2)`` each, that look the same; ``dash`` needs lines of two points."""

    lines: Sequence[Floats]
    fill: str = ""
    stroke: str = ""
    width: float = STROKE
    closed: bool = False
    dash: Dash | None = None


@dataclass(frozen=True, eq=False)
class Label:
    """A text centred on a place, then moved by ``aside`` times the size of the text."""

    text: str
    at: Floats
    aside: tuple[float, float] = (0.0, 0.0)
    colour: str = "#1a1a1a"


@dataclass(frozen=True)
class Key:
    """An entry of the legend: what a stroke or a fill means. Without a colour it is words only."""

    text: str
    stroke: str = ""
    fill: str = ""
    width: float = STROKE
    dash: Dash | None = None


@dataclass(frozen=True, eq=False)
class Panel:
    """A picture: items from back to front, letters over them, and a legend below."""

    items: list[Item]
    keys: list[Key] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)


def mountain(look: LineStyle) -> Dash:
    """Return what divides a line on a panel into dashes and dots."""
    return lambda line: mountain_pieces(line / DASHES, look) * DASHES


def valley(look: LineStyle) -> Dash:
    """Return what divides a line on a panel into dashes."""
    return lambda line: valley_pieces(line / DASHES, look) * DASHES


def faces(outlines: Sequence[Floats], fill: str) -> Item:
    """Return filled polygons with thin edges."""
    return Item(outlines, fill=fill, stroke=EDGE_COLOUR, width=EDGE, closed=True)


def fine(lines: Floats, extent: float, most: float = STROKE) -> float:
    """Return the width of strokes at which short lines, ``(n, 2, 2)``, can be told apart; ``extent``: the panel's."""
    if not len(lines):
        return most
    lengths = np.hypot(*(lines[:, 1] - lines[:, 0]).T) * PANEL_MM / extent
    return float(np.clip(SHARE * np.quantile(lengths, 0.2), LIGHTEST, most))


@dataclass(frozen=True, eq=False)
class Outline:
    """A polyline of a laid-out drawing, or a polygon if ``closed``: ``(n, 2)`` mm, y down."""

    points: Floats
    closed: bool
    fill: str
    stroke: str
    width: float


@dataclass(frozen=True)
class Text:
    """Words of a laid-out drawing: the start of their baseline, or its middle if ``centred``, in mm, y down."""

    words: str
    x: float
    y: float
    colour: str
    centred: bool


def laid_out(
    panels: Sequence[tuple[str, Panel]], title: str, most_columns: int = 2
) -> tuple[bytes, tuple[float, float]]:
    """Return named panels in rows of two, or as many as ``most_columns``, as SVG, and its width and height in mm."""
    columns = min(most_columns, len(panels))
    width = columns * (PANEL_MM + GAP_MM) + GAP_MM
    places, y = [], GAP_MM
    for first in range(0, len(panels), columns):
        row = [panel for _, panel in panels[first : first + columns]]
        height = max(_Frame(panel).height for panel in row)
        places += [(GAP_MM + k * (PANEL_MM + GAP_MM), y, height) for k in range(len(row))]
        y += height + max(_legend_height(panel) for panel in row) + GAP_MM
    drawing = svgwrite.Drawing(
        size=(f"{number(width)}mm", f"{number(y)}mm"), viewBox=f"0 0 {number(width)} {number(y)}", debug=False
    )
    drawing.set_desc(title=printable(title) or "foldcut")
    for (name, panel), (left, top, height) in zip(panels, places, strict=True):
        for part, drawn in (("", _drawn(panel, left, top, height)), ("-legend", _legend(panel, left, top + height))):
            group = drawing.add(drawing.g(id=name + part) if name else drawing.g())
            for marks in drawn:
                _add(drawing, group, marks)
    text = ET.tostring(drawing.get_xml(), encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n{text}\n'.encode(), (width, y)


def flat(panel: Panel) -> tuple[list[Outline | Text], tuple[float, float]]:
    """Return everything that a panel is drawn with, in drawing order, and its width and height in mm."""
    height = _Frame(panel).height
    drawn = [*_drawn(panel, 0.0, 0.0, height), *_legend(panel, 0.0, height)]
    marks = [mark for some in drawn for mark in some]
    return marks, (PANEL_MM, height + _legend_height(panel) + 1)


def _add(drawing: svgwrite.Drawing, group: Any, marks: Sequence[Outline | Text]) -> None:
    """Add marks that look the same to an SVG, all polylines as one path."""
    lines = [mark for mark in marks if isinstance(mark, Outline)]
    if lines:
        first = lines[0]
        style: dict[str, str] = {"fill": first.fill or "none", "stroke": first.stroke or "none"}
        if first.stroke:
            style |= {"stroke_width": number(first.width), "stroke_linejoin": "round"}
        data = "".join(path_data(line.points.tolist(), closed=line.closed) for line in lines)
        group.add(drawing.path(d=data, **style))
    for mark in marks:
        if isinstance(mark, Text):
            style = {"fill": mark.colour, "font_family": "sans-serif", "font_size": number(TEXT_MM)}
            if mark.centred:
                style["text_anchor"] = "middle"
            group.add(drawing.text(mark.words, insert=(number(mark.x), number(mark.y)), **style))


class _Frame:
    """The scale and place at which a panel shows its items: as large as they fit."""

    def __init__(self, panel: Panel) -> None:
        every = np.concatenate([line for item in panel.items for line in item.lines])
        self.low, self.extent = every.min(axis=0), np.maximum(np.ptp(every, axis=0), 1e-9)
        self.scale = PANEL_MM / float(self.extent.max())
        self.height = float(self.extent[1]) * self.scale

    def place(self, points: Floats, left: float, top: float, height: float) -> Floats:
        """Return points moved to the drawing, centred in a row of this height."""
        margin = (PANEL_MM - self.scale * self.extent[0]) / 2, (height - self.height) / 2
        placed: Floats = (points - self.low) * self.scale * (1, -1) + (left + margin[0], top + height - margin[1])
        return placed


def _drawn(panel: Panel, left: float, top: float, height: float) -> Iterator[list[Outline | Text]]:
    """Yield what a panel is drawn with: marks that look the same together, but filled polygons one by one."""
    frame = _Frame(panel)
    for item in panel.items:
        lines = [frame.place(line, left, top, height) for line in item.lines]
        if item.dash is not None:
            lines = [piece for line in lines for piece in item.dash(line)]
        marks: list[Outline | Text] = [Outline(p, item.closed, item.fill, item.stroke, item.width) for p in lines]
        yield from ([mark] for mark in marks) if item.fill else [marks] if marks else []
    for label in panel.labels:
        x, y = frame.place(label.at[None], left, top, height)[0].tolist()
        x, y = x + label.aside[0] * TEXT_MM, y + (0.36 - label.aside[1]) * TEXT_MM
        yield [Text(label.text, x, y, label.colour, centred=True)]


def _legend(panel: Panel, left: float, top: float) -> Iterator[list[Outline | Text]]:
    """Yield the legend of a panel, under a picture that ends at ``top``."""
    for key, right, below in _legend_rows(panel):
        x, y = left + right, top + below
        yield list(_key_sample(key, x, y))
        yield [Text(key.text, x + _sample(key), y, "#222222", centred=False)]


def _key_sample(key: Key, x: float, y: float) -> Iterator[Outline]:
    """Yield the sample of a key: a box, or a stroke."""
    if key.fill:
        corners = np.array([(0.0, -0.8), (2.0, -0.8), (2.0, 0.2), (0.0, 0.2)])
        yield Outline(corners * TEXT_MM + (x, y), True, key.fill, key.stroke or EDGE_COLOUR, EDGE)
    elif key.stroke:
        line = np.array([(x, y - 0.36 * TEXT_MM), (x + SAMPLE * TEXT_MM, y - 0.36 * TEXT_MM)])
        for piece in key.dash(line) if key.dash else line[None]:
            yield Outline(piece, False, "", key.stroke, key.width)


SAMPLE = 4.5
"""The length of a key's stroke, as a multiple of the size of the text."""


def _sample(key: Key) -> float:
    """Return the room that the sample before a key's words takes, in mm."""
    return TEXT_MM * (2.6 if key.fill else SAMPLE + 0.6 if key.stroke else 0.0)


def _legend_rows(panel: Panel) -> list[tuple[Key, float, float]]:
    """Return the keys with their places, in mm from the lower left corner of the picture, y down."""
    rows = []
    x, y = 0.0, LINE * TEXT_MM + 1 + (TEXT_MM if panel.labels else 0.0)
    for key in panel.keys:
        width = _sample(key) + LETTER * TEXT_MM * len(key.text)
        if x and x + width > PANEL_MM:
            x, y = 0.0, y + LINE * TEXT_MM
        rows.append((key, x, y))
        x += width + 2 * TEXT_MM
    return rows


def _legend_height(panel: Panel) -> float:
    rows = _legend_rows(panel)
    return rows[-1][2] if rows else 0.0
