"""The path of a drag knife's holder: it leads, and the blade trails behind it along the lines.

Strokes, ``(n, 2)`` mm, and a ``Blade`` -> the path of the holder's axis. The blade is ``offset_mm`` behind the axis, so
the axis is that far ahead on every segment; in a corner it goes round the corner on an arc, while the blade turns on
the spot. A closed line is cut beyond its start, so that its ends meet.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.profiles import Blade

SWIVEL = math.radians(15)
"""The longest step of the arc on which the axis goes round a corner."""


def holder_path(stroke: Floats, blade: Blade) -> Floats:
    """Return the path of the axis, ``(m, 2)``, on which the blade follows a stroke."""
    points = stroke[np.append(True, (np.diff(stroke, axis=0) != 0).any(axis=1))]
    if len(points) < 2:
        return stroke
    closed = len(points) > 3 and bool((points[0] == points[-1]).all())
    if closed and blade.overcut_mm:
        points = np.concatenate([points, _beginning(points, blade.overcut_mm)])
    along = np.diff(points, axis=0)
    angles = np.arctan2(along[:, 1], along[:, 0])
    path = [points[0] + _ahead(angles[0], blade)]
    for corner, before, after in zip(points[1:], angles, [*angles[1:], angles[-1]], strict=True):
        turn = (after - before + math.pi) % (2 * math.pi) - math.pi
        steps = max(1, math.ceil(abs(turn) / SWIVEL))
        path += [corner + _ahead(before + turn * step / steps, blade) for step in range(steps + 1)]
    found = np.array(path)
    return np.asarray(found[np.append(True, (np.abs(np.diff(found, axis=0)) > 1e-12).any(axis=1))])


def _ahead(angle: float, blade: Blade) -> Floats:
    return blade.offset_mm * np.array([math.cos(angle), math.sin(angle)])


def _beginning(points: Floats, length: float) -> Floats:
    """Return the points of a line after its first one, as far as ``length``."""
    found: list[Floats] = []
    for start, end in pairwise(points):
        size = math.dist(start, end)
        if size >= length:
            return np.array([*found, start + (end - start) * (length / size)])
        found.append(end)
        length -= size
    return np.array(found)
