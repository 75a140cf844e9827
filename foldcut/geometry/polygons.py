"""Many polygons at once: which segments pass through the inside of which, by more than a tolerance.

Nearly every face of a flat-foldable pattern is convex: alternate angles around an inner vertex add up to a half turn,
so none is larger, and sheets are convex. Segments are clipped by all convex faces together, as intersections of
half-planes; shapely does the other faces.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Floats

__all__ = ["Outlines", "runs"]

Indices = NDArray[np.intp]
Integers = NDArray[np.integer[Any]]

MANY_CORNERS = 64
"""Polygons with more corners go to shapely; of the others every side is compared with every corner."""


def runs(first: Integers, count: Integers) -> Indices:
    """Return ``first[i], first[i] + 1, ...`` for every i, ``count[i]`` numbers each, in one array."""
    start = np.cumsum(count) - count
    numbers: Indices = np.arange(int(count.sum())) + np.repeat(first - start, count)
    return numbers


class Outlines:
    """Simple polygons; only what lies more than ``inset`` within their sides counts as inside.

    ``corners`` ``(m, 2)``, of all polygons; ``offsets`` ``(p + 1,)``. Polygons may run either way around.
    """

    def __init__(self, corners: Floats, offsets: Integers, inset: float) -> None:
        self.corners = corners
        self.inset = inset
        self._first = offsets[:-1].astype(np.intp)
        self._count = np.diff(offsets).astype(np.intp)

    def crossed(self, segments: Floats, polygons: Indices) -> Bools:
        """Return whether ``segments[i]``, ``(n, 2, 2)``, enters the inside of ``polygons[i]``."""
        result = np.zeros(len(polygons), dtype=np.bool_)
        if not len(polygons):
            return result
        normals, levels, others = self._insides
        count = self._count[polygons]
        side = runs(self._first[polygons], count)
        pair = np.repeat(np.arange(len(polygons)), count)
        normal = normals[side]
        depth = (segments[pair, 0] * normal).sum(axis=1) - levels[side]
        rise = ((segments[pair, 1] - segments[pair, 0]) * normal).sum(axis=1)
        # along the segment, t from 0 to 1, each side requires depth + t * rise >= 0
        with np.errstate(divide="ignore", invalid="ignore"):
            t = -depth / rise
        never = np.where(depth < 0, np.inf, -np.inf)  # if the segment is parallel to the side
        enter = np.where(rise > 0, t, np.where(rise < 0, -np.inf, never))
        leave = np.where(rise < 0, t, np.inf)
        starts = np.cumsum(count) - count
        result = np.maximum(np.maximum.reduceat(enter, starts), 0) < np.minimum(np.minimum.reduceat(leave, starts), 1)
        for other, inside in others.items():
            at = np.flatnonzero(polygons == other)
            result[at] = shapely.intersects(inside, shapely.linestrings(segments[at]))
        return result

    @cached_property
    def _insides(self) -> tuple[Floats, Floats, dict[int, shapely.Geometry]]:
        """What ``crossed`` needs; it is made on first use, because boxes alone often show that nothing is crossed."""
        normals, levels, special = self._half_planes()
        return normals, levels, self._inset_others(special)

    def _half_planes(self) -> tuple[Floats, Floats, Indices]:
        """Return every side's inward unit normal, the level above which the inside lies, and the special polygons.

        Special polygons are not convex, or have many corners.
        """
        offsets = self._first
        following = np.arange(1, len(self.corners) + 1)
        following[offsets + self._count - 1] = offsets
        along = self.corners[following] - self.corners
        base = np.repeat(self.corners[offsets], self._count, axis=0)
        spoke, across = self.corners - base, self.corners[following] - base
        area = np.add.reduceat(spoke[:, 0] * across[:, 1] - spoke[:, 1] * across[:, 0], offsets)
        turn = np.repeat(np.sign(area), self._count) / np.hypot(*along.T)
        normals = np.stack([-along[:, 1] * turn, along[:, 0] * turn], axis=1)
        # the line through a short side is inaccurate far away; the parallel line that just contains all corners is
        # safe, and the same if the polygon is convex
        many = self._count > MANY_CORNERS
        reach = np.repeat(np.where(many, 1, self._count), self._count)
        corner = runs(np.where(reach > 1, np.repeat(offsets, self._count), np.arange(len(reach))), reach)
        height = (self.corners[corner] * np.repeat(normals, reach, axis=0)).sum(axis=1)
        lowest = np.minimum.reduceat(height, np.cumsum(reach) - reach)
        own = (self.corners * normals).sum(axis=1)
        special = np.flatnonzero(many | (np.maximum.reduceat(own - lowest, offsets) > self.inset))
        return normals, lowest + self.inset, special

    def _inset_others(self, special: Indices) -> dict[int, shapely.Geometry]:
        """Return the special polygons, each shrunk by the inset."""
        others = {}
        for index in special.tolist():
            first = self._first[index]
            outline = shapely.Polygon(self.corners[first : first + self._count[index]])
            inside = outline.buffer(-self.inset, join_style="mitre")
            shapely.prepare(inside)
            others[index] = inside
        return others
