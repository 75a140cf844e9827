"""Where dashes are decided: a crease becomes a line, a perforation, or the dashes of the origami notation.

Creases -> the pieces that are made of each, ``(n, 2, 2)``. Dashes are geometry everywhere, since most programs that cut
or plot drop line styles. Their lengths come from the profile: perforations from its material (``Dash``), drawn dashes
from its ``LineStyle``. They are stretched a little so that each line begins and ends with a dash.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.model import CreasePattern
from foldcut.pattern.straight_lines import straight_lines
from foldcut.profiles import Dash, LineStyle, Treatment


def crease_pieces(
    creases: CreasePattern, letter: str, treatment: Treatment, dashes: Mapping[str, Dash], style: LineStyle
) -> Iterator[list[Floats]]:
    """Yield the pieces, ``(2, 2)`` each, of every crease with this assignment, "M" or "V".

    A score is one piece for each straight line of creases. A perforation goes from vertex to vertex, with a clearance
    at both ends, so that no two cuts meet; ``dashes`` are by assignment. Drawn lines, like scores, go straight through
    vertices, in the dashes of ``style``: the Yoshizawa-Randlett notation.
    """
    edges = creases.edges_vertices[creases.edges_assignment == letter]
    points = creases.vertices_coords
    if treatment == "perforate":
        for edge in edges:
            pieces = perforation(points[edge], dashes[letter])
            if pieces:
                yield pieces
        return
    for a, b in straight_lines(points, edges.tolist()):
        line = points[[a, b]]
        if treatment == "score":
            yield [line]
        elif letter == "V":
            yield list(valley_pieces(line, style))
        else:
            yield list(mountain_pieces(line, style))


def perforation(line: Floats, dash: Dash) -> list[Floats]:
    """Return the cuts along a crease, ``(2, 2)`` each, stretched a little to fit, with both ends uncut.

    A crease too short for one cut and both clearances gets a single cut in its middle half, so that none is lost.
    """
    length = float(math.dist(*line))
    room = length - 2 * dash.clearance_mm
    if room < dash.dash_mm:
        ends = np.array([0.25, 0.75])
    else:
        count = max(0, round((room - dash.dash_mm) / (dash.dash_mm + dash.gap_mm)))
        steps = np.array([0.0, *np.cumsum([dash.dash_mm, *[dash.gap_mm, dash.dash_mm] * count])])
        ends = (dash.clearance_mm + steps / steps[-1] * room) / length
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
