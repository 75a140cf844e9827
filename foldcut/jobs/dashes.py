"""Where dashes are decided: a crease becomes a line, a perforation, or the dashes of the origami notation.

Creases -> the pieces that are made of each, ``(n, 2, 2)``. Dashes are geometry everywhere, since most programs that cut
or plot drop line styles. Their lengths come from the profile: perforations from its material (``Dash``), drawn dashes
from its ``LineStyle``. They are stretched a little so that each line begins and ends with a dash.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from foldcut.core.arrays import Floats
from foldcut.core.model import CreasePattern
from foldcut.pattern.straight_lines import straight_lines
from foldcut.profiles import Dash, LineStyle, Treatment

SHORTEST_CUT = 0.05
"""A single cut in a short crease is at least this part of it long."""


@dataclass(frozen=True)
class Cuts:
    """How creases are perforated: the ``dashes`` by assignment, and what stays between the cuts.

    ``apart_mm``: how far the cuts of two creases stay apart, the kerf and a web of paper; ``shortest_mm``: no cut is
    shorter, since no blade could follow it.
    """

    dashes: Mapping[str, Dash]
    apart_mm: float = 0.0
    shortest_mm: float = 0.0


def crease_pieces(
    creases: CreasePattern, letter: str, treatment: Treatment, style: LineStyle
) -> Iterator[list[Floats]]:
    """Yield the pieces, ``(2, 2)`` each, of every straight line of creases with this assignment, "M" or "V".

    A score is one piece. Drawn lines are in the dashes of ``style``: the Yoshizawa-Randlett notation. Perforations are
    made by ``perforations``.
    """
    edges = creases.edges_vertices[creases.edges_assignment == letter]
    points = creases.vertices_coords
    for a, b in straight_lines(points, edges.tolist()):
        line = points[[a, b]]
        if treatment == "score":
            yield [line]
        elif letter == "V":
            yield list(valley_pieces(line, style))
        else:
            yield list(mountain_pieces(line, style))


def perforations(creases: CreasePattern, cuts: Cuts) -> tuple[dict[str, list[list[Floats]]], int]:
    """Return the cuts along every crease, by assignment, and the number of creases that have no room for one.

    A perforation goes from vertex to vertex, with a clearance at both ends that grows with 1 / sin of the angle to the
    next edge: so the cuts of two creases, mountains and valleys, stay ``apart_mm`` apart. Where they would be nearer
    all the same, since both are by a short third one, the shorter cut is left out.
    """
    found: dict[str, list[list[Floats]]] = {"M": [], "V": []}
    needed = cuts.apart_mm / sines(creases)
    lines = creases.vertices_coords[creases.edges_vertices]
    uncut = 0
    for letter, line, room in zip(creases.edges_assignment.tolist(), lines, needed, strict=True):
        if letter not in found:
            continue
        pieces = perforation(line, cuts.dashes[letter], room, cuts.shortest_mm)
        uncut += not pieces
        if pieces:
            found[letter].append(pieces)
    return _kept_apart(found, cuts.apart_mm, uncut)


def _kept_apart(
    found: dict[str, list[list[Floats]]], apart: float, uncut: int
) -> tuple[dict[str, list[list[Floats]]], int]:
    """Leave out cuts that are too near to a longer one of another crease."""
    runs = [run for some in found.values() for run in some]
    owner = np.repeat(np.arange(len(runs)), [len(run) for run in runs])
    pieces = [piece for run in runs for piece in run]
    if not pieces or not apart:
        return found, uncut
    drawn = shapely.linestrings(np.array(pieces))
    first, second = shapely.STRtree(drawn).query(drawn, predicate="dwithin", distance=apart - 1e-9)
    near = owner[first] < owner[second]
    length = shapely.length(drawn)
    gone: set[int] = set()
    for a, b in zip(first[near].tolist(), second[near].tolist(), strict=True):
        if not {a, b} & gone:
            gone.add(a if length[a] < length[b] else b)
    if not gone:
        return found, uncut
    number = iter(range(len(pieces)))
    kept = {letter: [[p for p in run if next(number) not in gone] for run in some] for letter, some in found.items()}
    uncut += sum(not run for some in kept.values() for run in some)
    return {letter: [run for run in some if run] for letter, some in kept.items()}, uncut


def sines(creases: CreasePattern) -> Floats:
    """Return the sine of the angle to the next edge at both ends of every edge, ``(n, 2)``; 1 from 90 degrees on."""
    points, edges = creases.vertices_coords, creases.edges_vertices
    along = points[edges[:, 1]] - points[edges[:, 0]]
    direction = np.concatenate([np.arctan2(along[:, 1], along[:, 0]), np.arctan2(-along[:, 1], -along[:, 0])])
    at = np.concatenate([edges[:, 0], edges[:, 1]])
    order = np.lexsort((direction, at))
    vertices, counts = np.unique(at[order], return_counts=True)
    starts = np.cumsum(counts) - counts
    last = np.repeat(starts + counts - 1, counts)
    following = np.arange(len(order)) + 1
    wraps = following > last
    following[wraps] = starts[np.repeat(np.arange(len(vertices)), counts)][wraps]
    turn = direction[order][following] - direction[order]
    turn[wraps] += 2 * np.pi
    angle = np.full(len(order), np.inf)
    angle[order] = turn
    np.minimum.at(angle, order[following], turn)
    sine = np.where(angle < np.pi / 2, np.sin(angle), 1.0)
    return sine.reshape(2, -1).T


def perforation(line: Floats, dash: Dash, needed: Floats | None = None, shortest: float = 0.0) -> list[Floats]:
    """Return the cuts along a crease, ``(2, 2)`` each, stretched a little to fit, with both ends uncut.

    ``needed``: how much has to stay uncut at either end, whatever ``dash`` says; ``shortest``: the length of the
    shortest cut that can be made. A crease too short for one cut and both clearances gets a single cut in its middle
    half, and none if there is no room for that either.
    """
    length = float(math.dist(*line))
    least = np.zeros(2) if needed is None else needed
    clear = np.maximum(least, dash.clearance_mm)
    room, cut = length - float(clear.sum()), max(dash.dash_mm, shortest)
    if room < cut:
        start, end = max(0.25 * length, least[0]), min(0.75 * length, length - least[1])
        ends = np.array([start, end]) / length
        if end - start < max(shortest, SHORTEST_CUT * length):
            return []
    else:
        count = max(0, round((room - cut) / (cut + dash.gap_mm)))
        if count and room / (cut + count * (cut + dash.gap_mm)) * cut < shortest:
            count -= 1  # stretched rather than pressed together: no cut gets too short
        steps = np.array([0.0, *np.cumsum([cut, *[dash.gap_mm, cut] * count])])
        ends = (clear[0] + steps / steps[-1] * room) / length
    places = line[0] + ends[:, None] * (line[1] - line[0])
    return list(places.reshape(-1, 2, 2))


def valley_pieces(line: Floats, style: LineStyle) -> Floats:
    """Return the dashes along a valley, ``(n, 2, 2)``; the first and the last reach the line's ends."""
    dash, gap = style.dash_mm, style.gap_mm
    count = round((math.dist(*line) - dash) / (dash + gap))
    return _divided(line, [dash, gap] * max(0, count) + [dash])


def mountain_pieces(line: Floats, style: LineStyle) -> Floats:
    """Return the dashes and dots along a mountain, ``(n, 2, 2)``; the first and the last piece are dashes."""
    dash, gap, dot = style.dash_mm, style.gap_mm, style.dot_mm
    count = round((math.dist(*line) - dash) / (dash + gap + dot + gap))
    return _divided(line, [dash, gap, dot, gap] * max(0, count) + [dash])


def _divided(line: Floats, lengths: Sequence[float]) -> Floats:
    """Divide a line in these proportions and return every other part, the first and the last among them."""
    if len(lengths) == 1:  # most creases of large patterns are shorter than two dashes
        return line[None].copy()
    ends = np.concatenate([[0.0], np.cumsum(lengths) / np.sum(lengths)])
    start, end = line
    points: Floats = start + ends[:, None] * (end - start)
    points[-1] = end
    return points.reshape(-1, 2, 2)
