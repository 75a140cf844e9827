"""Where dashes are decided."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.profiles import Dash, Drawing


def perforation(line: Floats, dash: Dash) -> list[Floats]:
    """Return the cuts along a crease, ``(2, 2)`` each: stretched a little to fit, with paper at both ends.

    A crease too short for one cut and both clearances gets one cut in its middle half; none is lost.
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


def valley_pieces(line: Floats, drawing: Drawing) -> Floats:
    """Return the dashes along a valley, ``(n, 2, 2)``, stretched a little so that both ends have ink."""
    dash, gap = drawing.dash_mm, drawing.gap_mm
    count = round((math.dist(*line) - dash) / (dash + gap))
    return _divided(line, [dash, gap] * max(0, count) + [dash])


def mountain_pieces(line: Floats, drawing: Drawing) -> Floats:
    """Return the dashes and dots along a mountain, ``(n, 2, 2)``, stretched to begin and end with a dash."""
    dash, gap, dot = drawing.dash_mm, drawing.gap_mm, drawing.dot_mm
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
