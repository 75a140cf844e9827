"""How a pattern is folded, as a picture that moves: the guide's steps, the cut and the shape, one after another.

``FoldedPattern`` -> SVG with declarative animation (SMIL), which browsers play without a script. Between the states of
a straight fold the moving faces turn about its line, seen from above: lengths along the line stay, those across it
shrink with the cosine. What closes together jumps from one state to the next: how it moves is not computed.
"""

from __future__ import annotations

import html
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Floats, Ints, index_array
from foldcut.core.model import FoldedPattern, FoldedState
from foldcut.folding_steps.steps import FoldingStep, folding_steps
from foldcut.geometry.vectors import left_normal

from ..pattern.svg import path_data
from ..text import number, printable
from .panels import EDGE_COLOUR
from .pictures import CUT, INSIDE, OUTSIDE, coloured, pieces

__all__ = ["export_animation"]

TURNS = (0.2, 0.4, 0.6, 0.8)
"""The parts of half a turn at which a straight fold is shown."""

TURN_S, STEP_S, LONG_S = 0.12, 0.9, 2.2
"""How long a part of a turn, the state after a step, and the first and the last pictures are shown, in seconds."""

TEXT = 0.045
"""The height of the words, as a part of the picture's width."""


@dataclass(frozen=True, eq=False)
class _Frame:
    """Polygons from the lowest to the highest, ``(n, 2)`` mm each, with their colours; what is said, and how long."""

    drawn: Sequence[tuple[Floats, str]]
    words: str
    seconds: float
    line: Floats | None = None


def export_animation(pattern: FoldedPattern) -> bytes:
    """Return an animated SVG; the same pattern gives the same bytes."""
    frames = list(_frames(pattern))
    every = np.concatenate([polygon for frame in frames for polygon, _ in frame.drawn])
    low, size = every.min(axis=0), np.ptp(every, axis=0)
    text = TEXT * float(size[0])
    width, height = float(size[0]) + 2 * text, float(size[1]) + 4 * text
    total = sum(frame.seconds for frame in frames)
    parts, start = [], 0.0
    for frame in frames:
        body = "".join(_path((polygon - low) * (1, -1) + (text, size[1] + text), fill) for polygon, fill in frame.drawn)
        if frame.line is not None:
            ends = path_data(((frame.line - low) * (1, -1) + (text, size[1] + text)).tolist(), closed=False)
            body += f'<path d="{ends}" stroke="{CUT}" stroke-width="{number(text / 4)}"/>'
        words = f'<text x="{number(width / 2)}" y="{number(height - text)}">{html.escape(frame.words)}</text>'
        end = start + frame.seconds
        parts.append(f"<g{_shown(start / total, end / total, total)}{body}{words}</g>")
        start = end
    title = html.escape(printable(pattern.title) or "foldcut")
    box = f'viewBox="0 0 {number(width)} {number(height)}" width="{number(width)}mm" height="{number(height)}mm"'
    look = f'fill="none" stroke="{EDGE_COLOUR}" stroke-width="{number(text / 25, 3)}" stroke-linejoin="round"'
    style = f"text{{font:{number(text)}px system-ui,sans-serif;text-anchor:middle;fill:#1a1a1a;stroke:none}}"
    head = f"<title>{title}: how to fold it</title>\n<style>{style}</style>"
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" {box} {look}>', head, *parts, "</svg>\n"]
    return ('<?xml version="1.0" encoding="utf-8"?>\n' + "\n".join(lines)).encode()


def _path(polygon: Floats, fill: str) -> str:
    return f'<path d="{path_data(polygon.tolist(), closed=True)}" fill="{fill}"/>'


def _shown(start: float, end: float, total: float) -> str:
    """Return the rest of a group's tag, and what shows it in a part of the time; where nothing moves, at the start."""
    times, values = [0.0, start, end], ["hidden", "visible", "hidden"]
    if start == 0:
        del times[0], values[0]
    if end >= 1 - 1e-9:
        del times[-1], values[-1]
    keys = ";".join(number(time, 5) for time in times)
    return (
        f' visibility="{values[0]}"><animate attributeName="visibility" calcMode="discrete" dur="{number(total)}s" '
        f'repeatCount="indefinite" keyTimes="{keys}" values="{";".join(values)}"/>'
    )


def _frames(pattern: FoldedPattern) -> Iterator[_Frame]:
    """Yield the pictures: the sheet, the steps, the folded sheet with the cut, the shape."""
    flat = pattern.creases.vertices_coords
    count = len(pattern.creases.faces_vertices)
    parts = [(face, inside, outline) for face, inside, outline, _ in pieces(pattern)]
    state = FoldedState(flat, index_array(np.arange(count)))
    draw = _Drawing(pattern, parts)
    title = printable(pattern.title)
    yield _Frame(draw.at(state), title, LONG_S)
    steps = folding_steps(pattern)
    for index, step in enumerate(steps, start=1):
        what = "fold" if step.line is not None else f"{len(step.edges)} creases close together"
        words = f"{index} of {len(steps)}: {what}"
        if step.line is not None:
            yield from (_Frame(draw.turning(state, step, part), words, TURN_S) for part in TURNS)
        state = step.state
        yield _Frame(draw.at(state), words, STEP_S)
    middle = (flat.min(axis=0) + flat.max(axis=0)) / 2
    folded = pattern.folded.vertices_coords
    aside = middle - (folded.min(axis=0) + folded.max(axis=0)) / 2
    moved = FoldedState(folded + aside, pattern.folded.layers)
    over = 0.06 * float(np.ptp(folded[:, 0]))
    line = np.array([[folded[:, 0].min() - over, 0.0], [folded[:, 0].max() + over, 0.0]]) + aside
    yield _Frame(draw.at(moved), "cut once, along the line", LONG_S, line)
    if pattern.shape.is_graph:  # what is cut is no outline: all of the sheet, divided by the cut
        yield _Frame([(outline, INSIDE if inside else OUTSIDE) for _, inside, outline in parts], title, LONG_S)
    else:
        yield _Frame([(outline, INSIDE) for _, inside, outline in parts if inside], title, LONG_S)


class _Drawing:
    """Draws the sheet in any state: the parts of its faces on either side of the cut, where the faces lie."""

    def __init__(self, pattern: FoldedPattern, parts: Sequence[tuple[int, bool, Floats]]) -> None:
        self._flat, self._parts = pattern.creases.vertices_coords, parts
        self._faces = pattern.creases.faces_vertices.to_lists()

    def at(self, state: FoldedState) -> list[tuple[Floats, str]]:
        """Return the sheet as it lies."""
        return self._drawn(self._laid(state), state.layers)

    def turning(self, state: FoldedState, step: FoldingStep, part: float) -> list[tuple[Floats, str]]:
        """Return the sheet while faces turn over a line: a ``part`` of half a turn after a state."""
        assert step.line is not None
        assert step.moved is not None
        along = (step.line[1] - step.line[0]) / np.hypot(*(step.line[1] - step.line[0]))
        across = left_normal(along)
        moving = set(step.moved.tolist())
        laid = self._laid(state)
        for index, (face, _, _) in enumerate(self._parts):
            if face in moving:
                away = laid[index] - step.line[0]
                shrunk = np.outer(away @ across, across) * np.cos(np.pi * part)
                laid[index] = step.line[0] + np.outer(away @ along, along) + shrunk
        if part > 0.5:
            return self._drawn(laid, step.state.layers)
        rest = [face for face in state.layers.tolist() if face not in moving]
        turned = [face for face in state.layers.tolist() if face in moving]
        return self._drawn(laid, index_array([*rest, *turned] if step.over else [*turned, *rest]))

    def _laid(self, state: FoldedState) -> list[Floats]:
        """Return where the parts lie: each face is moved as a whole."""
        laid = []
        for face, _, outline in self._parts:
            corners = self._faces[face]
            flat = np.column_stack([self._flat[corners], np.ones(len(corners))])
            motion = np.linalg.lstsq(flat, state.vertices_coords[corners], rcond=None)[0]
            laid.append(np.column_stack([outline, np.ones(len(outline))]) @ motion)
        return laid

    def _drawn(self, laid: Sequence[Floats], layers: Ints) -> list[tuple[Floats, str]]:
        rank = np.argsort(layers)
        order = sorted(range(len(laid)), key=lambda index: int(rank[self._parts[index][0]]))
        return [(laid[index], coloured(self._parts[index][1], laid[index])) for index in order]
