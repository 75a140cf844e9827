"""Shapes that have a mirror axis but for a small part: a fish with one fin more.

``Shape`` -> ``PartialAxis``. Each pair of corners whose sides have the same lengths, in the opposite order, votes for
the line between them that takes one to the other. The lines with the most votes are measured along the whole outline.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass

import numpy as np
import shapely

from foldcut.core.arrays import Floats
from foldcut.core.model import Shape

__all__ = ["PartialAxis", "partial_axis"]

MOST_CORNERS = 200
"""In shapes with more corners no axis is looked for: the time grows with the square of their number."""

ALIKE = 0.005
"""Lengths and places that differ by less than this, relative to the shape's size, are alike."""

MOST_MEASURED = 8
"""How many lines are measured."""

PLACES = 800
"""At how many places along the outline."""

LEAST_SHARE = 0.85
"""The least part of the outline whose image lies on the outline."""


@dataclass(frozen=True)
class PartialAxis:
    """A line about which all but a part of a shape is symmetric.

    ``angle`` is its direction in radians, from 0 to below pi; it goes through ``place``. ``share``: the part of the
    outline, below 1, whose mirror image lies on the outline; ``off``: how far the image of the rest is from it at most.
    Lengths are in the shape's unit.
    """

    angle: float
    place: tuple[float, float]
    share: float
    off: float


def partial_axis(shape: Shape) -> PartialAxis | None:
    """Return the line about which the largest part of a shape is symmetric, None if it is less than ``LEAST_SHARE``."""
    if shape.corner_count > MOST_CORNERS:
        return None
    points = np.concatenate(shape.loops)
    middle, size = points.mean(axis=0), float(np.ptp(points, axis=0).max())
    outline = shapely.multilinestrings([shapely.linearrings(loop) for loop in shape.loops])
    shapely.prepare(outline)
    along = np.linspace(0, 1, PLACES, endpoint=False)
    places = np.concatenate(
        [
            shapely.get_coordinates(shapely.line_interpolate_point(ring, along, normalized=True))
            for ring in outline.geoms
        ]
    )
    weights = np.repeat([ring.length for ring in outline.geoms], PLACES)
    best: PartialAxis | None = None
    for angle, offset in _candidates(shape, middle, ALIKE * size):
        normal = np.array([-math.sin(angle), math.cos(angle)])
        images = places - 2 * ((places - middle) @ normal - offset)[:, None] * normal
        away = shapely.distance(outline, shapely.points(images))
        share = float(weights[away <= ALIKE * size].sum() / weights.sum())
        if share >= LEAST_SHARE and (best is None or share > best.share):
            x, y = (middle + offset * normal).tolist()
            best = PartialAxis(angle, (x, y), share, float(away.max()))
    return best


def _candidates(shape: Shape, middle: Floats, alike: float) -> list[tuple[float, float]]:
    """Return lines, as a direction and a distance from the middle, for which the most pairs of corners vote."""
    corners = np.concatenate(shape.loops) - middle
    before = np.concatenate([np.roll(loop, 1, axis=0) for loop in shape.loops]) - middle
    after = np.concatenate([np.roll(loop, -1, axis=0) for loop in shape.loops]) - middle
    back, ahead = np.hypot(*(before - corners).T), np.hypot(*(after - corners).T)
    like = (np.abs(back[:, None] - ahead) <= alike) & (np.abs(ahead[:, None] - back) <= alike)
    votes: Counter[tuple[int, int]] = Counter()
    lines: dict[tuple[int, int], tuple[float, float]] = {}
    for one, other in np.argwhere(np.triu(like)).tolist():
        if one == other:
            way = (before[one] - corners[one]) / back[one] + (after[one] - corners[one]) / ahead[one]
            through = corners[one]
        else:
            step = corners[other] - corners[one]
            way, through = np.array([-step[1], step[0]]), (corners[one] + corners[other]) / 2
        if not np.hypot(*way) > 0:
            continue
        angle = math.atan2(way[1], way[0]) % math.pi
        angle = 0.0 if math.pi - angle < ALIKE else angle
        offset = float(through @ (-math.sin(angle), math.cos(angle)))
        key = round(angle / ALIKE), round(offset / alike)
        votes[key] += 1
        lines.setdefault(key, (angle, offset))
    return [lines[key] for key, _ in votes.most_common(MOST_MEASURED)]
