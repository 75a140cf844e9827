"""Panels: pictures that are fitted into a frame, with letters and a legend, and laid out in rows; SVG.

Input: what a panel shows, in its own coordinates with y up; output: SVG 1.1, one user unit is 1 mm. A panel is
``PANEL_MM`` wide, or high where it is higher than wide. Strokes, dashes and letters are in mm on the panel, whatever
the size of what is shown, so that a panel can be read at 100 mm; all grows with a larger print.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import svgwrite

from foldcut.job import mountain_pieces, valley_pieces
from foldcut.model import Floats
from foldcut.profiles import Drawing

from .svg import path_data
from .text import number, printable

PANEL_MM, GAP_MM = 100.0, 8.0
TEXT_MM = 2.8
LETTER, LINE = 0.53, 1.7
"""How wide a letter is, and how far lines are apart, in sizes of the text."""

EDGE, STROKE, BOLD = 0.12, 0.3, 0.6
EDGE_COLOUR = "#444444"
LIGHTEST, SHARE = 0.06, 0.07
"""Strokes get no thinner than this, and where lines are short, this part of their length."""

DASHES = 0.45
"""How long dashes are on a panel, as a part of what they are on a sheet in true size."""

Dash = Callable[[Floats], Floats]


@dataclass(frozen=True, eq=False)
class Item:
    """Polylines or, closed, polygons: ``(n, 2)`` each, all of one look. ``dash`` divides a line of two points."""

    lines: Sequence[Floats]
    fill: str = ""
    stroke: str = ""
    width: float = STROKE
    closed: bool = False
    dash: Dash | None = None


@dataclass(frozen=True, eq=False)
class Label:
    """Letters around a place, in the middle of it, moved by ``aside`` sizes of the text."""

    text: str
    at: Floats
    aside: tuple[float, float] = (0.0, 0.0)
    colour: str = "#1a1a1a"


@dataclass(frozen=True)
class Key:
    """A line of the legend: what a stroke, or a fill, means. Without a colour it is words only."""

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


def mountain(look: Drawing) -> Dash:
    """Return what divides a line on a panel into dashes and dots."""
    return lambda line: mountain_pieces(line / DASHES, look) * DASHES


def valley(look: Drawing) -> Dash:
    """Return what divides a line on a panel into dashes."""
    return lambda line: valley_pieces(line / DASHES, look) * DASHES


def faces(rings: Sequence[Floats], fill: str) -> Item:
    """Return filled polygons with a fine edge."""
    return Item(rings, fill=fill, stroke=EDGE_COLOUR, width=EDGE, closed=True)


def fine(lines: Floats, extent: float, most: float = STROKE) -> float:
    """Return how wide strokes may be so that short lines, ``(n, 2, 2)``, can be told apart; ``extent`` of all."""
    if not len(lines):
        return most
    lengths = np.hypot(*(lines[:, 1] - lines[:, 0]).T) * PANEL_MM / extent
    return float(np.clip(SHARE * np.quantile(lengths, 0.2), LIGHTEST, most))


def laid_out(panels: Sequence[tuple[str, Panel]], title: str) -> tuple[bytes, tuple[float, float]]:
    """Return panels with their names side by side, in rows of two, as SVG, and its size in mm."""
    columns = min(2, len(panels))
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
        group = drawing.add(drawing.g(id=name) if name else drawing.g())
        _draw(drawing, group, panel, left, top, height)
    text = ET.tostring(drawing.get_xml(), encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n{text}\n'.encode(), (width, y)


class _Frame:
    """Where what a panel shows is put: as large as there is room for."""

    def __init__(self, panel: Panel) -> None:
        every = np.concatenate([line for item in panel.items for line in item.lines])
        self.low, self.extent = every.min(axis=0), np.maximum(np.ptp(every, axis=0), 1e-9)
        self.scale = PANEL_MM / float(self.extent.max())
        self.height = float(self.extent[1]) * self.scale

    def place(self, points: Floats, left: float, top: float, height: float) -> Floats:
        """Return points on the drawing, in the middle of a row of this height."""
        margin = (PANEL_MM - self.scale * self.extent[0]) / 2, (height - self.height) / 2
        placed: Floats = (points - self.low) * self.scale * (1, -1) + (left + margin[0], top + height - margin[1])
        return placed


def _draw(drawing: svgwrite.Drawing, group: Any, panel: Panel, left: float, top: float, height: float) -> None:
    frame = _Frame(panel)
    for item in panel.items:
        style: dict[str, str] = {"fill": item.fill or "none", "stroke": item.stroke or "none"}
        if item.stroke:
            style |= {"stroke_width": number(item.width), "stroke_linejoin": "round"}
        lines = [frame.place(line, left, top, height) for line in item.lines]
        if item.dash is not None:
            lines = [piece for line in lines for piece in item.dash(line)]
        paths = [path_data(line.tolist(), closed=item.closed) for line in lines]
        for data in paths if item.fill else ["".join(paths)]:
            if data:
                group.add(drawing.path(d=data, **style))
    font: dict[str, Any] = {"font_family": "sans-serif", "font_size": number(TEXT_MM)}
    for label in panel.labels:
        x, y = frame.place(label.at[None], left, top, height)[0]
        place = (number(x + label.aside[0] * TEXT_MM), number(y + (0.36 - label.aside[1]) * TEXT_MM))
        group.add(drawing.text(label.text, insert=place, fill=label.colour, text_anchor="middle", **font))
    for key, x, y in _legend_rows(panel):
        x, y = left + x, top + height + y
        start, middle = x, y - 0.36 * TEXT_MM
        if key.fill:
            corner = (number(x), number(y - 0.8 * TEXT_MM))
            box = {"stroke": key.stroke or EDGE_COLOUR, "stroke_width": number(EDGE)}
            size = (number(2 * TEXT_MM), number(TEXT_MM))
            group.add(drawing.rect(insert=corner, size=size, fill=key.fill, **box))
        elif key.stroke:
            line = np.array([(x, middle), (x + SAMPLE * TEXT_MM, middle)])
            pieces = key.dash(line) if key.dash else line[None]
            for a, b in pieces.tolist():
                ends = [tuple(map(number, end)) for end in (a, b)]
                group.add(drawing.line(*ends, stroke=key.stroke, stroke_width=number(key.width)))
        start += _sample(key)
        group.add(drawing.text(key.text, insert=(number(start), number(y)), fill="#222222", **font))


SAMPLE = 4.5


def _sample(key: Key) -> float:
    """Return how much room the sample before a key's words takes, in mm."""
    return TEXT_MM * (2.6 if key.fill else SAMPLE + 0.6 if key.stroke else 0.0)


def _legend_rows(panel: Panel) -> list[tuple[Key, float, float]]:
    """Return the keys with their places under the picture, mm."""
    rows = []
    x, y = 0.0, LINE * TEXT_MM + 1
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
