"""Marks that a job may have besides its creases: their names, and the lines they are drawn with.

``FoldedPattern`` -> polylines, ``(n, 2)`` mm, on the pattern's sheet. Text is made of the single strokes of Hershey's
fonts, so that a pen or a laser can follow it. A *room* is the part of the sheet that the machine reaches: left, lower,
right and upper edge in mm, by default those of the sheet.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import shapely

from foldcut.core.arrays import Floats
from foldcut.core.model import FoldedPattern, Sheet
from foldcut.geometry.planar_graph import edge_faces
from foldcut.geometry.vectors import cross, left_normal
from foldcut.pattern.cut_line import fold_boundary
from foldcut.pattern.face_maps import fold_faces, folded_edges
from foldcut.pattern.first_folds import fold_numbers, in_front
from foldcut.pattern.straight_lines import straight_lines

TOUCHING = 1e-9
"""Places this close together, relative to the sheet's diagonal, are one."""

Room = tuple[float, float, float, float]

REACH_MM = 1.0
"""Marks keep this far from where the machine's reach ends."""

TEXT_MM = 4.0
"""The height of titles."""

NUMBER_MM = 2.5
"""The height of numbers."""

INSET_MM = 6.0
"""The distance of titles and rulers from the sheet's edges."""

RULER_MM = 100.0
"""The length of the ruler on a sheet that is wide enough."""

CORNER_MARK_MM = 5.0
"""The length of the corner marks that line the back up with the front."""

ARROW_MM = 4.0
"""The length of the arrowheads at the ends of first folds."""

SHORTEST_NUMBERED_MM = 8.0
"""Shorter lines of creases have no number beside them."""

HOLES_MM = {"holes": 3.0, "pins": 1.0}
"""The diameter of registration holes: for pegs, and for pins."""

HOLE_INSET_MM = 8.0
"""The distance of the centres of registration holes from the sheet's edges."""

HOLE_CORNERS = 24
"""The number of corners of the polygon that is cut for a round hole."""


def outline(pattern: FoldedPattern, room: Room | None = None) -> list[Floats]:
    """Return the loops and lines of the shape: where the cut will be on the flat sheet."""
    return list(pattern.shape.strokes)


def first_folds(pattern: FoldedPattern, room: Room | None = None) -> list[Floats]:
    """Return arrowheads at both ends of each line that is folded first, pointing at the sheet's edge."""
    around = shapely.box(*(room or whole(pattern.sheet)))
    arrows = []
    for whole_line in pattern.first_folds:
        line = shapely.get_coordinates(shapely.intersection(shapely.linestrings(whole_line), around))
        if len(line) < 2:
            continue
        for end, other in (line, line[::-1]):
            along = (end - other) / math.dist(end, other)
            tip, across = end - 0.5 * along, left_normal(along)
            foot = tip - ARROW_MM * along
            arrows.append(np.array([foot + 0.4 * ARROW_MM * across, tip, foot - 0.4 * ARROW_MM * across]))
    return arrows


def cut_line(pattern: FoldedPattern, room: Room | None = None) -> list[Floats]:
    """Return the parts of the outline that can be seen on the folded sheet, from front or back: where to cut."""
    creases = pattern.creases
    tolerance = TOUCHING * pattern.sheet.diagonal
    maps = fold_faces(creases, edge_faces(creases))
    pieces, faces, landed = fold_boundary(creases, maps, pattern.shape, tolerance)
    longest = int(np.hypot(*(landed[:, 1] - landed[:, 0]).T).argmax())
    line = landed[longest, 1] - landed[longest, 0]
    x = (landed - landed[longest, 0]) @ line / math.hypot(*line)  # all land on one line
    places = np.unique(np.round(x / tolerance)) * tolerance
    low, high = (np.searchsorted(places, ends - tolerance / 2) for ends in (x.min(axis=1), x.max(axis=1)))
    rank = np.argsort(pattern.folded.layers)[faces]
    seen: list[Floats] = []
    for order in (np.argsort(rank), np.argsort(-rank)):
        shown = np.full(len(places) - 1, -1)  # by interval between places: the topmost piece so far
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
    """Return the first folds, and the lines of creases to press after them, longest first; ``(2, 2)`` mm each.

    A crease pressed through several layers is several lines on the flat sheet; only the one that is then on top is
    listed.
    """
    creases = pattern.creases
    edges = creases.edges_vertices[folded_edges(creases)].tolist()
    lines = [creases.vertices_coords[list(ends)] for ends in straight_lines(creases.vertices_coords, edges)]
    firsts = list(pattern.first_folds)
    rest = [line for line in lines if in_front(line, firsts)]
    rest.sort(key=lambda line: (-round(math.dist(*line), 6), *np.round(line, 6).ravel().tolist()))
    return firsts, rest


def numbers(pattern: FoldedPattern, room: Room | None = None) -> list[Floats]:
    """Return a number beside each line of creases, in ``pressing_order``: that of the fold which creases it.

    Lines shorter than ``SHORTEST_NUMBERED_MM`` count but have no number.
    """
    firsts, rest = pressing_order(pattern)
    first = fold_numbers(len(firsts))
    folds = [*first, *range(max(first, default=0) + 1, max(first, default=0) + 1 + len(rest))]
    strokes = []
    for place, (number, line) in enumerate(zip(folds, [*firsts, *rest], strict=True)):
        if math.dist(*line) < SHORTEST_NUMBERED_MM:
            continue
        along = (line[1] - line[0]) / math.dist(*line)
        along = -along if along[0] < -1e-9 or (abs(along[0]) < 1e-9 and along[1] < 0) else along
        # first folds cross in one point, where their numbers would lie on each other
        spot = line.mean(axis=0) if place >= len(firsts) or len(firsts) < 2 else _halfway(line, firsts)
        middle = spot + left_normal(along) * 0.3 * NUMBER_MM
        strokes += [_turned(stroke, along) + middle for stroke in text(str(number), NUMBER_MM)]
    return _in_room(strokes, room or whole(pattern.sheet))


def _halfway(line: Floats, firsts: list[Floats]) -> Floats:
    """Return the point of a first fold halfway from where it crosses the others to its farther end."""
    other = next(first for first in firsts if first is not line)
    along, across = line[1] - line[0], other[1] - other[0]
    centre = line[0] + along * float(cross(other[0] - line[0], across) / cross(along, across))
    far = line[int(np.hypot(*(line - centre).T).argmax())]
    halfway: Floats = (centre + far) / 2
    return halfway


def title(pattern: FoldedPattern, room: Room | None = None) -> list[Floats]:
    """Return as much of the title as fits into the upper left corner of the sheet."""
    words = pattern.title
    left, _, right, high = _inset(pattern.sheet, room, INSET_MM)
    while words:
        strokes = text(words, TEXT_MM, (left, high - TEXT_MM))
        if not strokes or max(stroke[:, 0].max() for stroke in strokes) < right:
            return _in_room(strokes, room or whole(pattern.sheet))
        words = words[:-1]
    return []


def ruler(pattern: FoldedPattern, room: Room | None = None) -> list[Floats]:
    """Return a ruler along the sheet's lower edge, to check the size: 100 mm, or as much as fits."""
    x, y, right, _ = _inset(pattern.sheet, room, INSET_MM)
    length = min(RULER_MM, 10 * math.floor((right - x - 20) / 10))
    if length <= 0:
        return []
    ticks = range(round(length / 10) + 1)
    lines = [np.array([(x, y), (x + length, y)])]
    lines += [np.array([(x + 10 * k, y), (x + 10 * k, y + (2.0 if k % 5 else 3.0))]) for k in ticks]
    return lines + text(f"{length:g} mm", NUMBER_MM, (x + length + 2, y))


MARKS: dict[str, Callable[[FoldedPattern, Room | None], list[Floats]]] = {
    "outline": outline,
    "first-folds": first_folds,
    "cut-line": cut_line,
    "numbers": numbers,
    "title": title,
    "ruler": ruler,
}
"""The marks that can be asked for, by name."""


def corner_marks(sheet: Sheet, room: Room | None = None) -> list[Floats]:
    """Return an L in each corner of the sheet except the upper right, which shows how the sheet lies."""
    size = CORNER_MARK_MM
    left, low, right_edge, high = _inset(sheet, room, CORNER_MARK_MM / 2)
    marks = []
    for x, y, right, up in ((left, low, 1, 1), (right_edge, low, -1, 1), (left, high, 1, -1)):
        marks.append(np.array([(x + right * size, y), (x, y), (x, y + up * size)]))
    return marks


def hole_centres(sheet: Sheet, diameter: float, room: Room | None = None) -> Floats:
    """Return the centres of the registration holes, ``(3, 2)``: in each corner of the sheet except the upper right."""
    left, low, right, high = _inset(sheet, room, HOLE_INSET_MM, diameter)
    return np.array([(left, low), (right, low), (left, high)])


def holes(sheet: Sheet, diameter: float, room: Room | None = None) -> list[Floats]:
    """Return the round registration holes, closed."""
    angle = np.linspace(0.0, 2 * np.pi, HOLE_CORNERS + 1)
    circle = diameter / 2 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    circle[-1] = circle[0]
    return [circle + place for place in hole_centres(sheet, diameter, room)]


def crosses(sheet: Sheet, size: float, room: Room | None = None) -> list[Floats]:
    """Return crosses at the centres of ``holes``."""
    lines = []
    for centre in hole_centres(sheet, size, room):
        lines += [np.array([centre - step, centre + step]) for step in ((size, 0.0), (0.0, size))]
    return lines


def text(words: str, height: float, at: tuple[float, float] = (0.0, 0.0)) -> list[Floats]:
    """Return text as polylines, ``height`` mm high, to the right of a place; letters the font lacks are left out."""
    return [np.array(stroke, dtype=np.float64) + np.array(at) for stroke in _font(height).strokes_for_text(words)]


@cache
def _font(height: float) -> Any:
    """Return Hershey's plain font at a height; cached, since reading it takes longer than setting most texts."""
    from HersheyFonts import HersheyFonts

    font = HersheyFonts()
    font.load_default_font("futural")
    font.normalize_rendering(height)
    return font


def _turned(stroke: Floats, along: Floats) -> Floats:
    turned: Floats = stroke @ np.stack([along, left_normal(along)])
    return turned


def whole(sheet: Sheet) -> Room:
    """Return all of a sheet as the room for marks."""
    return 0.0, 0.0, sheet.width, sheet.height


def _inset(sheet: Sheet, room: Room | None, inset: float, clear: float = REACH_MM) -> Room:
    """Return the edges that are ``inset`` from the sheet's, and at least ``clear`` from those of the room."""
    left, low, right, high = room or (-inset, -inset, sheet.width + inset, sheet.height + inset)
    return (
        max(inset, left + clear),
        max(inset, low + clear),
        min(sheet.width - inset, right - clear),
        min(sheet.height - inset, high - clear),
    )


def _in_room(strokes: Iterable[Floats], room: Room) -> list[Floats]:
    """Return the strokes that lie wholly in the room."""
    low, high = np.array(room[:2]), np.array(room[2:])
    return [s for s in strokes if (s >= low).all() and (s <= high).all()]
