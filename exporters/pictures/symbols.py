"""The symbols of origami diagrams, after Yoshizawa and Randlett: arrows for valley and mountain folds, and so on.

Places and sizes in the coordinates of a panel -> ``Item``, in black. A valley fold's arrow has a whole, filled head, a
mountain fold's a hollow half of one; fold and unfold has a head at both ends.
"""

from __future__ import annotations

import math

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.geometry.vectors import left_normal

from .panels import BOLD, Item

__all__ = ["fold_arrow", "rotate", "turn_over", "unfold_arrow"]

INK = "#000000"
"""The colour of symbols."""

HEAD = 0.16
"""The length of an arrow's head, as a fraction of the arrow's reach, if that is not too long."""

WHITE = "#ffffff"
"""The colour inside a hollow head."""


def fold_arrow(points: Floats, line: Floats, extent: float, *, valley: bool) -> list[Item]:
    """Return the arrow of a fold along a ``line``, ``(2, 2)``, from the middle of what moves to where it comes to lie.

    ``points``: the corners of what moves; ``extent``: the size of the picture.
    """
    curve = _curve(points, line)
    head = (_valley_head if valley else _mountain_head)(curve, _size(curve, extent))
    return [Item([curve], stroke=INK, width=BOLD / 2), head]


def unfold_arrow(place: Floats, line: Floats, extent: float) -> list[Item]:
    """Return the arrow for folding along a ``line`` and unfolding again: over the line at a place, with two heads."""
    across = left_normal((line[1] - line[0]) / math.dist(*line)) * 0.1 * extent
    curve = _curve(np.array([place + across]), line)
    size = _size(curve, extent)
    heads = [_valley_head(curve, size), _valley_head(curve[::-1], size)]
    return [Item([curve], stroke=INK, width=BOLD / 2), *heads]


def _valley_head(curve: Floats, size: float) -> Item:
    """Return the head of a valley fold's arrow at the end of a curve: a filled triangle."""
    tip, back, aside = _head(curve, size)
    return Item([np.array([tip, tip + back + aside, tip + 0.75 * back, tip + back - aside])], fill=INK, closed=True)


def _mountain_head(curve: Floats, size: float) -> Item:
    """Return the head of a mountain fold's arrow at the end of a curve: a hollow half of a triangle."""
    tip, back, aside = _head(curve, size)
    corners = np.array([tip, tip + 1.2 * back + 1.3 * aside, tip + back])
    return Item([corners], fill=WHITE, stroke=INK, width=BOLD / 2, closed=True)


def turn_over(place: Floats, size: float) -> list[Item]:
    """Return the symbol for turning the paper over: an arrow with a loop, ``size`` wide, its middle at ``place``."""
    angle = np.linspace(-0.5 * math.pi, 1.5 * math.pi, 33)
    loop = 0.17 * np.stack([np.cos(angle), np.sin(angle) + 1], axis=1)
    curve = np.concatenate([np.array([[-0.5, 0.0]]), loop, np.array([[0.38, 0.0], [0.5, 0.0]])]) * size + place
    return [Item([curve], stroke=INK, width=BOLD / 2), _valley_head(curve, 0.16 * size)]


def rotate(place: Floats, size: float, *, left: bool) -> list[Item]:
    """Return the symbol for turning the paper round: two arrows on a circle, ``size`` wide, around ``place``."""
    items = []
    for start in (20.0, 200.0):
        angle = np.radians(np.linspace(start, start + 140, 21))
        arc = place + 0.5 * size * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        arc = arc if left else arc[::-1]
        items += [Item([arc], stroke=INK, width=BOLD / 2), _valley_head(arc, 0.25 * size)]
    return items


def _curve(points: Floats, line: Floats) -> Floats:
    """Return an arc over a line, from the middle of points on one side of it to where that comes to lie."""
    along = (line[1] - line[0]) / math.dist(*line)
    middle = points.mean(axis=0)
    foot = line[0] + along * float((middle - line[0]) @ along)
    away = middle - foot
    angle = np.radians(np.linspace(25, 150, 30))[:, None]
    arc: Floats = foot + away * np.cos(angle) + 0.45 * math.hypot(*away) * along * np.sin(angle)
    return arc


def _size(curve: Floats, extent: float) -> float:
    """Return how long the head of an arrow is."""
    return float(np.clip(HEAD * math.dist(curve[0], curve[-1]), 0.025 * extent, 0.05 * extent))


def _head(curve: Floats, size: float) -> tuple[Floats, Floats, Floats]:
    """Return the tip of an arrow, the way back from it, and the way aside."""
    tip = curve[-1]
    before = curve[np.hypot(*(curve - tip).T) > 0.7 * size]
    back = (before[-1] if len(before) else curve[0]) - tip
    back = back / max(math.hypot(*back), 1e-12) * size
    return tip, back, left_normal(back) * 0.4
