"""The outline of a shape, and what the compact method needs to know about it.

A loop on the sheet -> ``Outline``: its sides, corners and pockets, and what its straight skeletons say about them.

A *pocket* is a region between the outline and its convex hull.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, Numbers
from foldcut.geometry.vectors import cross
from foldcut.geometry.wavefront import Node, corner_lives, side_nodes

MOST_POCKETS = 62
"""How many pockets are told apart, each by one bit of an int64. All further pockets share the last bit."""

FRONT_SLACK = 1e-7
"""By how much a wavefront's free region is enlarged, as a part of the shape's size, so that its border counts."""

MITRE_LIMIT = 1e3
"""How far, in multiples of its height, a wavefront's sharp corner may reach before it is cut off."""


@dataclass(frozen=True, eq=False)
class Outline:
    """The outline of a shape: ``loop`` ``(n, 2)`` in mm, counter-clockwise.

    Side k goes from corner k to corner k + 1. All properties are computed once, when they are first used.
    """

    loop: Floats

    @cached_property
    def along(self) -> Floats:
        """The sides as vectors, ``(n, 2)`` mm."""
        vectors: Floats = np.roll(self.loop, -1, axis=0) - self.loop
        return vectors

    @cached_property
    def length(self) -> Floats:
        """The lengths of the sides, ``(n,)`` mm."""
        lengths: Floats = np.hypot(*self.along.T)
        return lengths

    @cached_property
    def direction(self) -> Floats:
        """The unit vectors of the sides, ``(n, 2)``."""
        return np.asarray(self.along / self.length[:, None])

    @cached_property
    def turning(self) -> Floats:
        """By what angle the outline turns left at each corner, ``(n,)`` radians."""
        before = np.roll(self.direction, 1, axis=0)
        turning: Floats = np.arctan2(cross(before, self.direction), (before * self.direction).sum(axis=1))
        return turning

    @cached_property
    def reflex(self) -> Bools:
        """Which corners are reflex, ``(n,)``."""
        return np.asarray(self.turning < 0)

    @cached_property
    def size(self) -> float:
        """The larger side of the bounding box in mm."""
        return float(np.ptp(self.loop, axis=0).max())

    @cached_property
    def falls(self) -> Floats:
        """How far the image of each reflex corner falls inside if the corner is a dip, ``(n,)`` mm; 0 for others.

        It falls until the corner's wavefront meets another.
        """
        return self.inside_lives[1]

    @cached_property
    def rises(self) -> Floats:
        """How far the image of each convex corner rises outside if the corner is a crest, ``(n,)`` mm; 0 for others."""
        return np.minimum(self.outside_lives[1], self.size)

    @cached_property
    def inside_lives(self) -> tuple[Floats, Floats]:
        """When the wavefront of each corner meets another inside, and its growth: see ``corner_lives``."""
        return corner_lives(self.loop)

    @cached_property
    def outside_lives(self) -> tuple[Floats, Floats]:
        """When the wavefront of each corner meets another outside, and its growth: see ``corner_lives``."""
        return corner_lives(self.loop, outside=True)

    @cached_property
    def nodes(self) -> list[list[Node]]:
        """For each side, the nodes of the inner and the outer straight skeleton that lie above it."""
        nodes: list[list[Node]] = [[] for _ in self.loop]
        for node in (*side_nodes(self.loop), *side_nodes(self.loop, outside=True)):
            if 0 < node.along < self.length[node.side]:
                nodes[node.side].append(node)
        return nodes

    def front(self, height: float, outside: bool) -> shapely.Geometry:
        """Return the region, slightly enlarged, that the wavefront has not yet passed at ``height`` mm."""
        key = (height, outside)
        if key not in self._fronts:
            shape = shapely.Polygon(self.loop)
            slack = FRONT_SLACK * self.size
            if outside:
                box = shapely.box(*shape.buffer(2 * height + self.size).bounds)
                front = box.difference(shape.buffer(height - slack, join_style="mitre", mitre_limit=MITRE_LIMIT))
            else:
                front = shape.buffer(slack - height, join_style="mitre", mitre_limit=MITRE_LIMIT)
            shapely.prepare(front)
            self._fronts[key] = front
        return self._fronts[key]

    @cached_property
    def _fronts(self) -> dict[tuple[float, bool], shapely.Geometry]:
        return {}

    def width_at(self, point: Floats, side: int) -> float:
        """Return how far a point on a side is from the nearest side other than that one and its two neighbours."""
        along = np.sum((point - self.loop) * self.direction, axis=1)
        foot = self.loop + self.direction * np.clip(along, 0.0, self.length)[:, None]
        away: Floats = np.hypot(*(foot - point).T)
        count = len(self.loop)
        away[[side, (side - 1) % count, (side + 1) % count]] = np.inf
        return float(away.min(initial=self.size))

    @cached_property
    def pockets(self) -> Numbers:
        """The pocket that each side borders, as one bit of an integer, ``(n,)``; 0 for a side of the convex hull."""
        count = len(self.loop)
        corners = shapely.get_coordinates(shapely.convex_hull(shapely.multipoints(self.loop)))
        hull = np.flatnonzero((self.loop[:, None] == corners).all(axis=2).any(axis=1))
        pockets = np.zeros(count, dtype=np.int64)
        number = 0
        for a, b in zip(hull.tolist(), [*hull[1:].tolist(), int(hull[0]) + count], strict=True):
            if b - a > 1:
                pockets[np.arange(a, b) % count] = 1 << min(number, MOST_POCKETS - 1)
                number += 1
        return pockets

    @property
    def pocket_bits(self) -> list[int]:
        """The bits of all pockets, lowest first."""
        return [1 << n for n in range(int(self.pockets.max()).bit_length())]
