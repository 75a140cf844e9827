"""How often outlines cross: counted, as far as it matters, before what takes long for many crossings."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from foldcut.core.arrays import Floats

__all__ = ["MOST_CROSSINGS", "are_tangled", "faces_of_lines", "winding"]

Geometries = np.ndarray[tuple[int], np.dtype[np.object_]]
"""Geometries of shapely."""

MOST_CROSSINGS = 10_000
"""Outlines with more crossings are left as they are; ``make_shape`` refuses them and says where."""

_BATCH = 256
"""The greatest number of segments in one query."""


def are_tangled(loops: Sequence[Floats], most: int = MOST_CROSSINGS) -> bool:
    """Whether closed loops, ``(n, 2)``, have more than ``most`` pairs of sides that meet.

    Neighbours do not count. A tangle is found after a few sides of it.
    """
    sides = np.concatenate([np.stack([loop, np.roll(loop, -1, axis=0)], axis=1) for loop in loops])
    segments = shapely.linestrings(sides)
    tree, count, start, batch = shapely.STRtree(segments), 0, 0, 1
    segments = np.random.default_rng(0).permutation(segments)  # at random: if all lie in one place, a few suffice
    while start < len(segments) and count <= 2 * most + 1:
        asked = segments[start : start + batch]
        one, _ = tree.query(asked, predicate="intersects")
        count += max(len(one) - 3 * len(asked), 0)
        start, batch = start + batch, min(2 * batch, _BATCH)
    return count // 2 > most


def faces_of_lines(lines: Sequence[shapely.LineString]) -> tuple[Geometries, Floats]:
    """Return the faces, ``(f,)``, into which closed lines divide the plane, and a point in each, ``(f, 2)``."""
    faces: Geometries = shapely.get_parts(shapely.polygonize([shapely.union_all(lines)]))
    return faces, shapely.get_coordinates(shapely.point_on_surface(faces))


def winding(points: Floats, loop: Floats) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Return the winding number of ``loop`` around each point: how often it goes around it, counter-clockwise."""
    (x, y), (to_x, to_y) = loop.T, np.roll(loop, -1, axis=0).T
    turns = np.zeros(len(points), dtype=np.int64)
    for number, (px, py) in enumerate(points.tolist()):
        left = (to_x - x) * (py - y) - (px - x) * (to_y - y)
        turns[number] = np.sum((y <= py) & (to_y > py) & (left > 0)) - np.sum((y > py) & (to_y <= py) & (left < 0))
    return turns
