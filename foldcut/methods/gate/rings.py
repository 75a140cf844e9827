"""Rings of equal disks around loops: they divide the faces of a shape with several loops into parts.

Shape, sheet -> ``Ring`` for every loop but the root; ``BoundaryDisks``, rings -> ``Parts`` (docs/several-loops.md, the
equal-disk gate).

A face of the plane with several loops has one *main part* and, around each loop reached through it, a *collar*. Main
parts are numbered as the faces are, collars after them. Between a collar and its main part lies a ring of equal disks,
each of which touches the next. *Petals* fill the crevices between two of them on either side, and smaller equal disks
close the fan around each. The *corridor* is a strip of a hexagonal packing of small disks, from loop to ring.

Invariants: the triangles at a ring's disks are no higher on the main side than in the collar's crevices.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely

from foldcut.core.arrays import Floats, Numbers, Ragged, index_array
from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.geometry.vectors import left_normal
from foldcut.methods.disks.boundary import BoundaryDisks, Limit

# The petals' radii relative to the ring's: in the collar, and on the main side, where molecules must be lower.
PETAL, MAIN_PETAL = 0.4, 0.36
# How high the crevice triangles fold, relative to the ring's radius.
HEIGHT = math.sqrt(PETAL / (2 + PETAL))
PETAL_REACH = 1.85  # so many radii from the centres of a ring there are no petals any more
SHARPEST = 5.0  # so many half-widths of the ribbon disks at sharp corners grow and move beyond it
FEWEST, MOST = 9, 400  # disks of a ring
# Disks of the corridor and boundary disks near the gate, relative to the ring's.
SMALL = 0.4
# How far from the gate boundary disks are small, in radii of the ring.
NEAR = 2.0


@dataclass(frozen=True, eq=False)
class Ring:
    """A ring around ``loop``, which is reached through ``face`` from the loop ``above`` (numbered like the faces).

    ``centres`` ``(k, 2)`` mm counter-clockwise, the first at the gate; ``radius`` mm; ``ends`` ``(2, 2)``: where the
    corridor ends on the loop above and on the loop itself.
    """

    loop: int
    face: int
    above: int
    centres: Floats
    radius: float
    ends: Floats


@dataclass(frozen=True, eq=False)
class Parts:
    """Boundary disks with the parts as faces, and what is packed already.

    ``molecules`` ragged triangles of disks, counter-clockwise, with their ``parts``; ``ring_disks`` by loop;
    ``collar`` by loop.
    """

    boundary: BoundaryDisks
    molecules: list[list[int]]
    parts: list[int]
    ring_disks: dict[int, list[int]]
    collar: dict[int, int]


def plan_rings(shape: Shape, sheet: Sheet, ribbon: float, room: float) -> tuple[int, list[Ring]]:
    """Return the root loop, numbered from 1, and a ring around each other loop.

    A ring has ``room`` radii on either side of its disks' centres, at least 2.5.
    Raises ``UnfoldableError`` with the loop's place where there is no room for a ring.
    """
    polygons = [shapely.Polygon(loop) for loop in shape.loops]
    root = max((k for k, above in enumerate(shape.parent) if above < 0), key=lambda k: polygons[k].area)
    children = [child for child in range(len(polygons)) if child != root]
    curves, obstacles = {}, {}
    for child in children:
        face = shape.parent[child]
        around = polygons[root if face < 0 else face].exterior
        if face < 0:
            around = shapely.union(around, shapely.LinearRing(sheet.corners))
        siblings = [polygons[k].exterior for k in children if shape.parent[k] == face and k != child]
        obstacles[child] = shapely.union_all([around, *siblings])
        free = min([polygons[child].distance(around) / 2] + [polygons[child].distance(s) / 3.5 for s in siblings])
        # Closing rounds the notches in the curve.
        curves[child] = polygons[child].buffer(2 * free, quad_segs=32).buffer(-free, quad_segs=32).exterior
    rings = []
    for child in children:
        curve, face = curves[child], shape.parent[child]
        radius = curve.distance(shapely.union(obstacles[child], polygons[child].exterior)) - SHARPEST * ribbon
        others = [curves[k] for k in children if shape.parent[k] == face and k != child]
        radius = min([radius / room] + [curve.distance(other) / (1.5 * room) for other in others])
        if radius < 2 * ribbon:
            radius = 0.0
        rings.append(_ring(child + 1, face + 1, (root if face < 0 else face) + 1, curve, radius, polygons, shape))
    return root + 1, rings


def _ring(
    loop: int,
    face: int,
    above: int,
    curve: shapely.LinearRing,
    radius: float,
    polygons: list[shapely.Polygon],
    shape: Shape,
) -> Ring:
    count = max(FEWEST, math.ceil(curve.length / (2 * radius))) if radius > 0 else MOST + 1
    if count > MOST:
        x, y = shape.loops[loop - 1].mean(axis=0)
        raise UnfoldableError(
            f"there is too little room around loop {loop}, near ({x:.4g}, {y:.4g}), for a ring of at most {MOST} "
            "disks; move the loops apart or use a bigger sheet"
        )
    at = np.arange(count) * (curve.length / count)
    centres = shapely.get_coordinates(shapely.line_interpolate_point(curve, at))
    if not curve.is_ccw:
        centres = centres[::-1]
    centres = _equal_sides(centres)
    lines = [polygons[above - 1].exterior, polygons[loop - 1].exterior]
    distance = sum(shapely.distance(shapely.points(centres), line) for line in lines)
    centres = np.roll(centres, -int(np.argmin(distance)), axis=0)
    gate = shapely.Point(centres[0])
    ends = np.array([line.interpolate(line.project(gate)).coords[0] for line in lines])
    return Ring(loop, face, above, centres, float(np.hypot(*(centres[1] - centres[0]))) / 2, ends)


def _equal_sides(points: Floats) -> Floats:
    """Move the corners of a polygon as little as possible so that all its sides are equal.

    Each step of Newton's method is the shortest, ``rows.T @ solve(rows @ rows.T, off)``, with a row for each side: its
    two corners, and the common length.
    """
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import splu

    count = len(points)
    side = np.arange(count)
    before_side = np.roll(side, 1)
    off = math.inf
    for _ in range(20):
        sides = np.roll(points, -1, axis=0) - points
        lengths = np.hypot(*sides.T)
        unit = sides / lengths[:, None]
        mean = lengths.mean()
        before, off = off, float(np.abs(mean - lengths).max())
        if off < 1e-14 * mean or off >= before:  # no more than rounding
            break
        # rows @ rows.T is sparse but for the common length, which adds 1 everywhere: Sherman and Morrison
        beside = -(unit * np.roll(unit, 1, axis=0)).sum(axis=1)
        entries = np.concatenate([np.full(count, 2.0), beside, beside])
        places = np.concatenate([side, side, before_side]), np.concatenate([side, before_side, side])
        solved = splu(csc_array((entries, places), shape=(count, count))).solve(
            np.stack([mean - lengths, np.ones(count)], axis=1)
        )
        weights = solved[:, 0] - solved[:, 1] * (solved[:, 0].sum() / (1 + solved[:, 1].sum()))
        share = weights[:, None] * unit
        points = points + np.roll(share, 1, axis=0) - share
    return points


def small_at_gates(rings: list[Ring]) -> Limit:
    """Return the limit that keeps boundary disks off the rings' petals, and small near the ends of the corridors."""
    lines = [shapely.LinearRing(ring.centres) for ring in rings]
    shapely.prepare(lines)

    def limit(centres: Floats, radii: Floats) -> Floats:
        largest = np.full(len(centres), np.inf)
        points = shapely.points(centres)
        for ring, line in zip(rings, lines, strict=True):
            away = shapely.distance(line, points)
            largest = np.minimum(largest, away - PETAL_REACH * ring.radius)
            for end in ring.ends:
                near = np.hypot(*(centres - end).T) - radii < NEAR * ring.radius
                largest[near] = np.minimum(largest[near], SMALL * ring.radius)
        return largest

    return limit


def divide_faces(boundary: BoundaryDisks, rings: list[Ring]) -> Parts:
    """Put the rings, with all that belongs to them, among the boundary disks."""
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
        """Close the left side of the ring ``disks`` with petals and fans, whose disks make a chain of the part."""
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
        """Lay a hexagonal strip from the ring's first disk to a loop, as far as it is free."""
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
    along = end - start
    length = math.hypot(*along)
    along = along / length
    for row in (-1, 0, 1):
        for k in range(int(length / (2 * radius)) + 1):
            x = (2 * k + row % 2) * radius
            if x < length:
                yield start + along * x + left_normal(along) * (row * math.sqrt(3) * radius)


def _fans(ring: Floats, radius: float, petals: Floats, size: float) -> list[list[tuple[Floats, float]]]:
    """Equal disks around each ring disk, clockwise from the petal before it to its own: their centres and radii."""
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
