"""Parts of faces: a ring of equal disks around each loop, and everything that is packed with it.

``BoundaryDisks``, rings -> ``Parts`` (docs/several-loops.md, the equal-disk gate).

A face of the plane with several loops has one *main part* and, around each loop reached through it, a *collar*. Main
parts have the numbers of the faces; collars come after them. Between a collar and its main part lies a ring of equal
disks, each of which touches the next. A *petal* fills the *crevice* between two of them, on either side of the ring;
the two disks and the petal make a *crevice triangle*. A *fan* of smaller equal disks closes the gap around each disk of
the ring, from petal to petal. The *corridor* is a strip of a hexagonal packing of small disks, from loop to ring.

Invariant: the triangles at a ring's disks fold no higher on the main side than in the collar's crevices.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely

from foldcut.core.arrays import Floats, Numbers, Ragged, index_array
from foldcut.geometry.vectors import left_normal
from foldcut.methods.disks.boundary import BoundaryDisks
from foldcut.methods.gate.rings import PETAL, SMALL, Ring

__all__ = ["Parts", "divide_faces"]

MAIN_PETAL = 0.36
"""The radius of the petals on the main side, relative to the ring's disks: molecules must be lower there."""


@dataclass(frozen=True, eq=False)
class Parts:
    """Boundary disks with the parts as faces, and the molecules at the rings, which are packed already.

    ``molecules``: triangles of disks, counter-clockwise, with their ``parts``; ``ring_disks``: by loop, the disks of
    its ring; ``collar``: by loop, the part around it.
    """

    boundary: BoundaryDisks
    molecules: list[list[int]]
    parts: list[int]
    ring_disks: dict[int, list[int]]
    collar: dict[int, int]


def divide_faces(boundary: BoundaryDisks, rings: list[Ring]) -> Parts:
    """Put the rings, with their petals, fans and corridors, among the boundary disks."""
    return _Divider(boundary).divide(rings)


class _Divider:
    """The growing lists of disks, chains and molecules."""

    def __init__(self, boundary: BoundaryDisks) -> None:
        self.boundary = boundary
        self.centres: list[Floats] = list(boundary.centres)
        self.radii: list[float] = boundary.radii.tolist()
        self.chains = boundary.chains.to_lists()
        self.chain_part = boundary.chain_face.tolist()
        self.molecules: list[list[int]] = []
        self.parts: list[int] = []

    def divide(self, rings: list[Ring]) -> Parts:
        """See ``divide_faces``."""
        inside = self.boundary.face_inside.tolist()
        ring_disks, collars = {}, {}
        for ring in rings:
            collar = collars[ring.loop] = len(inside)
            inside.append(inside[ring.face])
            for number, loop in enumerate(self.boundary.chain_loop.tolist()):
                if loop == ring.loop and self.chain_part[number] == ring.face:
                    self.chain_part[number] = collar
            disks = ring_disks[ring.loop] = [self._add(centre, ring.radius) for centre in ring.centres]
            self._petals(disks, PETAL, collar)
            self._petals(disks[::-1], MAIN_PETAL, ring.face)
        for ring in rings:
            for part, end in zip((ring.face, collars[ring.loop]), ring.ends, strict=True):
                self._corridor(ring, ring_disks[ring.loop], part, end)
        nodes = self.boundary.node.tolist()
        nodes += range(max(nodes) + 1, max(nodes) + 1 + len(self.radii) - len(nodes))
        boundary = replace(
            self.boundary,
            centres=np.array(self.centres),
            radii=np.array(self.radii),
            node=index_array(nodes),
            chains=Ragged.from_rows(self.chains),
            chain_face=index_array(self.chain_part),
            face_inside=np.array(inside),
        )
        return Parts(boundary, self.molecules, self.parts, ring_disks, collars)

    def _add(self, centre: Floats, radius: float) -> int:
        self.centres.append(centre)
        self.radii.append(radius)
        return len(self.radii) - 1

    def _petals(self, disks: list[int], share: float, part: int) -> None:
        """Close the left side of the ring ``disks`` with petals and fans; their disks become a chain of the part."""
        ring = np.array([self.centres[disk] for disk in disks])
        radius = self.radii[disks[0]]
        size = share * radius
        along = np.roll(ring, -1, axis=0) - ring
        unit = along / np.hypot(*along.T)[:, None]
        places = ring + along / 2 + left_normal(unit) * radius * math.sqrt(share * (share + 2))
        petals = [self._add(place, size) for place in places]
        chain: list[int] = []
        fans = _fans(ring, radius, places, size)
        for k, disk in enumerate(disks):
            fan = [petals[k - 1], *(self._add(centre, its_radius) for centre, its_radius in fans[k]), petals[k]]
            chain += fan[:-1]
            for one, other in pairwise(fan):
                self._molecule([disk, other, one], part)
            self._molecule([disk, disks[k + 1 - len(disks)], petals[k]], part)
        self.chains.append(chain)
        self.chain_part.append(part)

    def _molecule(self, disks: list[int], part: int) -> None:
        self.molecules.append(disks)
        self.parts.append(part)

    def _corridor(self, ring: Ring, disks: list[int], part: int, end: Floats) -> None:
        """Lay a hexagonal strip of disks from the ring's first disk to a loop, wherever there is room."""
        small = SMALL * ring.radius
        ring_disks = set(disks)
        own = {disk for triangle in self.molecules for disk in triangle if not ring_disks.isdisjoint(triangle)}
        mine = {disk for chain, its in zip(self.chains, self.chain_part, strict=True) if its == part for disk in chain}
        taken = sorted(mine.union(disks))
        centres, radii = np.array([self.centres[d] for d in taken]), np.array([self.radii[d] for d in taken])
        walls = shapely.union_all(
            [
                shapely.LinearRing([self.centres[disk] for disk in chain])
                for chain, its in zip(self.chains, self.chain_part, strict=True)
                if its == part and len(chain) > 2 and chain[0] not in own
            ]
        )
        for place in _strip(ring.centres[0], end, small):
            slack = np.hypot(*(centres - place).T) - radii - small
            way = shapely.LineString([ring.centres[0], place])
            if slack.min() > 0.1 * small and not way.intersects(walls):
                self.chains.append([self._add(place, small)])
                self.chain_part.append(part)


def _strip(start: Floats, end: Floats, radius: float) -> Iterator[Floats]:
    """Yield the centres of three rows of a hexagonal packing from one point to another."""
    along = end - start
    length = math.hypot(*along)
    if length == 0:
        return
    along = along / length
    for row in (-1, 0, 1):
        for k in range(int(length / (2 * radius)) + 1):
            x = (2 * k + row % 2) * radius
            if x < length:
                yield start + along * x + left_normal(along) * (row * math.sqrt(3) * radius)


def _fans(ring: Floats, radius: float, petals: Floats, size: float) -> list[list[tuple[Floats, float]]]:
    """The fan around each disk of a ring, clockwise from the petal before it to its own: centres and radii."""
    to_first, to_last = np.roll(petals, 1, axis=0) - ring, petals - ring
    start = np.arctan2(to_first[:, 1], to_first[:, 0])
    turn = (start - np.arctan2(to_last[:, 1], to_last[:, 0])) % (2 * np.pi)
    count = np.ones(len(ring), dtype=np.int64)
    while (few := _fan_angle(radius, size, size, count) < turn).any():
        count[few] += 1
    low, high = np.zeros(len(ring)), np.full(len(ring), size)
    for _ in range(100):
        middle = (low + high) / 2
        small = _fan_angle(radius, size, middle, count) < turn
        low, high = np.where(small, middle, low), np.where(small, high, middle)
    first, step = start - _angle_between(radius, size, high), _angle_between(radius, high, high)
    fans = []
    for k, (centre, its_radius) in enumerate(zip(ring, high.tolist(), strict=True)):
        angles = first[k] - step[k] * np.arange(count[k])
        centres = centre + (radius + its_radius) * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        fans.append([(one, its_radius) for one in centres])
    return fans


def _fan_angle(radius: float, petal: float, size: float | Floats, count: Numbers) -> Floats:
    return 2 * _angle_between(radius, petal, size) + (count - 1) * _angle_between(radius, size, size)


def _angle_between(radius: float, one: float | Floats, other: float | Floats) -> Floats:
    """The angle, at a disk, between two that touch it and each other."""
    cosine = 1 - 2 * one * other / ((radius + one) * (radius + other))
    return np.asarray(np.arccos(np.maximum(-1.0, cosine)))
