"""Marks that a job may have besides its creases: what they are called, and the lines that they are drawn with.

``FoldedPattern`` -> polylines in mm on the pattern's sheet. Text is in the single strokes of Hershey's fonts, so that a
pen or a laser can follow it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.model import FoldedPattern, Sheet
from foldcut.geometry.planar_graph import edge_faces
from foldcut.geometry.vectors import left_normal
from foldcut.pattern.cut_line import fold_boundary
from foldcut.pattern.face_maps import fold_faces, folded_edges
from foldcut.pattern.straight_lines import straight_lines

TOUCHING = 1e-9
"""Places this near, relative to the sheet's diagonal, are one."""

TEXT_MM, NUMBER_MM = 4.0, 2.5
"""How high titles and numbers are."""

INSET_MM = 6.0
"""How far from the sheet's edges titles and rulers are."""

RULER_MM = 100.0
CORNER_MARK_MM = 5.0
"""The length of the corner marks that line the back up with the front."""

ARROW_MM = 4.0
SHORTEST_NUMBERED_MM = 8.0

HOLES_MM = {"holes": 3.0, "pins": 1.0}
"""The diameter of registration holes: for pegs, and for needles."""

HOLE_INSET_MM = 8.0
HOLE_CORNERS = 24


def outline(pattern: FoldedPattern) -> list[Floats]:
    """Where the cut will be on the flat sheet: the shape's loops."""
    return [np.concatenate([loop, loop[:1]]) for loop in pattern.shape.loops]


def first_folds(pattern: FoldedPattern) -> list[Floats]:
    """Arrowheads at the ends of the lines that are folded first, pointing at the sheet's edge."""
    arrows = []
    for line in pattern.first_folds:
        for end, other in (line, line[::-1]):
            along = (end - other) / math.dist(end, other)
            tip, across = end - 0.5 * along, left_normal(along)
            foot = tip - ARROW_MM * along
            arrows.append(np.array([foot + 0.4 * ARROW_MM * across, tip, foot - 0.4 * ARROW_MM * across]))
    return arrows


def cut_line(pattern: FoldedPattern) -> list[Floats]:
    """The parts of the outline that are seen on the folded sheet, from the front or the back: where to cut there."""
    creases = pattern.creases
    tolerance = TOUCHING * pattern.sheet.diagonal
    maps = fold_faces(creases, edge_faces(creases))
    pieces, faces, landed = fold_boundary(creases, maps, pattern.shape, tolerance)
    longest = int(np.hypot(*(landed[:, 1] - landed[:, 0]).T).argmax())
    line = landed[longest, 1] - landed[longest, 0]
    x = (landed - landed[longest, 0]) @ line / math.hypot(*line)  # all of them land on one line
    places = np.unique(np.round(x / tolerance)) * tolerance
    low, high = (np.searchsorted(places, ends - tolerance / 2) for ends in (x.min(axis=1), x.max(axis=1)))
    rank = np.argsort(pattern.folded.layers)[faces]
    seen: list[Floats] = []
    for order in (np.argsort(rank), np.argsort(-rank)):
        shown = np.full(len(places) - 1, -1)  # between places, the piece that covers all before it
        for piece in order.tolist():
            shown[low[piece] : high[piece]] = piece
        edges = np.flatnonzero(np.diff(shown, prepend=-2, append=-2))
        for first, last in pairwise(edges.tolist()):
            piece = int(shown[first])
            if piece >= 0:
                share = (places[[first, last]] - x[piece, 0]) / (x[piece, 1] - x[piece, 0])
                seen.append(pieces[piece, 0] + share[:, None] * (pieces[piece, 1] - pieces[piece, 0]))
    return seen


def pressing_order(pattern: FoldedPattern) -> tuple[list[Floats], list[Floats]]:
    """Return the first folds, and the lines of creases to press after them, the longest first; ``(2, 2)`` mm each.

    Of what is folded through several layers only the line to the right of, or above, the first folds is there.
    """
    creases = pattern.creases
    edges = creases.edges_vertices[folded_edges(creases)].tolist()
    lines = [creases.vertices_coords[list(ends)] for ends in straight_lines(creases.vertices_coords, edges)]
    firsts = list(pattern.first_folds)
    rest = [line for line in lines if all(_in_front(line, first) for first in firsts)]
    rest.sort(key=lambda line: (-round(math.dist(*line), 6), *np.round(line, 6).ravel().tolist()))
    return firsts, rest


def numbers(pattern: FoldedPattern) -> list[Floats]:
    """A number beside each line of creases, in the order to press them: first folds, then the longest.

    What is folded through several layers has its number on the one to the right of, or above, the first folds.
    """
    firsts, rest = pressing_order(pattern)
    strokes = []
    for number, line in enumerate([*firsts, *rest], start=1):
        if math.dist(*line) < SHORTEST_NUMBERED_MM:
            continue
        along = (line[1] - line[0]) / math.dist(*line)
        along = -along if along[0] < -1e-9 or (abs(along[0]) < 1e-9 and along[1] < 0) else along
        middle = line.mean(axis=0) + left_normal(along) * 0.3 * NUMBER_MM
        strokes += [_turned(stroke, along) + middle for stroke in text(str(number), NUMBER_MM)]
    return _on_sheet(strokes, pattern.sheet)


def title(pattern: FoldedPattern) -> list[Floats]:
    """The title in the sheet's upper left corner, as much of it as has room."""
    words = pattern.title
    while words:
        strokes = text(words, TEXT_MM, (INSET_MM, pattern.sheet.height - INSET_MM - TEXT_MM))
        if not strokes or max(stroke[:, 0].max() for stroke in strokes) < pattern.sheet.width - INSET_MM:
            return _on_sheet(strokes, pattern.sheet)
        words = words[:-1]
    return []


def ruler(pattern: FoldedPattern) -> list[Floats]:
    """A ruler of 100 mm, or what there is room for, along the sheet's lower edge, to see that the size is true."""
    length = min(RULER_MM, 10 * math.floor((pattern.sheet.width - 2 * INSET_MM - 20) / 10))
    if length <= 0:
        return []
    x, y = INSET_MM, INSET_MM
    ticks = range(round(length / 10) + 1)
    lines = [np.array([(x, y), (x + length, y)])]
    lines += [np.array([(x + 10 * k, y), (x + 10 * k, y + (2.0 if k % 5 else 3.0))]) for k in ticks]
    return lines + text(f"{length:g} mm", NUMBER_MM, (x + length + 2, y))


MARKS: dict[str, Callable[[FoldedPattern], list[Floats]]] = {
    "outline": outline,
    "first-folds": first_folds,
    "cut-line": cut_line,
    "numbers": numbers,
    "title": title,
    "ruler": ruler,
}
DEFAULT_MARKS = ("outline", "first-folds")


def corner_marks(sheet: Sheet) -> list[Floats]:
    """An L in each corner of the sheet but the upper right, which shows how the sheet lies."""
    inset, size = CORNER_MARK_MM / 2, CORNER_MARK_MM
    marks = []
    for x, y, right, up in ((0.0, 0.0, 1, 1), (sheet.width, 0.0, -1, 1), (0.0, sheet.height, 1, -1)):
        x, y = x + right * inset, y + up * inset
        marks.append(np.array([(x + right * size, y), (x, y), (x, y + up * size)]))
    return marks


def holes(sheet: Sheet, diameter: float) -> list[Floats]:
    """Three round holes, closed, in all corners of the sheet but the upper right."""
    angle = np.linspace(0.0, 2 * np.pi, HOLE_CORNERS + 1)
    circle = diameter / 2 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    circle[-1] = circle[0]
    inset = HOLE_INSET_MM
    places = ((inset, inset), (sheet.width - inset, inset), (inset, sheet.height - inset))
    return [circle + place for place in places]


def crosses(sheet: Sheet, size: float) -> list[Floats]:
    """Crosses where ``holes`` are."""
    lines = []
    for hole in holes(sheet, size):
        centre = hole[:-1].mean(axis=0)
        lines += [np.array([centre - step, centre + step]) for step in ((size, 0.0), (0.0, size))]
    return lines


def text(words: str, height: float, at: tuple[float, float] = (0.0, 0.0)) -> list[Floats]:
    """Text as polylines, ``height`` mm high, from a place on to the right; what has no strokes is left out."""
    return [np.array(stroke, dtype=np.float64) + np.array(at) for stroke in _font(height).strokes_for_text(words)]


@cache
def _font(height: float) -> Any:
    """Return Hershey's plain font in a size; reading it takes longer than most texts."""
    from HersheyFonts import HersheyFonts

    font = HersheyFonts()
    font.load_default_font("futural")
    font.normalize_rendering(height)
    return font


def _turned(stroke: Floats, along: Floats) -> Floats:
    turned: Floats = stroke @ np.stack([along, left_normal(along)])
    return turned


def _on_sheet(strokes: Iterable[Floats], sheet: Sheet) -> list[Floats]:
    """Leave out strokes that reach over the sheet's edge."""
    return [s for s in strokes if s.min() >= 0 and s[:, 0].max() <= sheet.width and s[:, 1].max() <= sheet.height]


def _in_front(line: Floats, first: Floats) -> bool:
    """Whether a line is, at least partly, to the right of or above a line that is folded first."""
    across = 0 if first[0, 0] == first[1, 0] else 1
    return bool(line[:, across].max() > first[0, across] + 1e-6)
