"""Rings of equal disks around loops, which divide the faces of a shape with several loops into parts.

Shape, sheet -> a ``Ring`` for every loop but the root (docs/several-loops.md, the equal-disk gate). ``parts`` puts the
rings among the boundary disks.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely

from foldcut.core.arrays import Floats
from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.methods.disks.boundary import Limit

__all__ = ["FEWEST", "HEIGHT", "MOST", "PETAL", "SMALL", "Ring", "equal_sides", "plan_rings", "small_at_gates"]

PETAL = 0.4
"""The radius of a collar's petals, relative to the ring's disks."""

HEIGHT = math.sqrt(PETAL / (2 + PETAL))
"""How high the crevice triangles fold, relative to the radius of the ring's disks."""

PETAL_REACH = 1.85
"""Petals lie within this many radii of the line through the centres of a ring."""

SHARPEST = 5.0
"""Disks at sharp corners grow and move beyond the ribbon by up to this many of its half-widths."""

FEWEST = 9
"""The least number of disks of a ring."""

MOST = 400
"""The largest number of disks of a ring."""

SMALL = 0.4
"""The radius of the corridor's disks, and the largest of boundary disks near a gate, relative to the ring's disks."""

NEAR = 2.0
"""Boundary disks are small within this many radii of the ring's disks from the ends of the corridor."""


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


def plan_rings(shape: Shape, sheet: Sheet, ribbon: float, room: float) -> tuple[int, list[Ring]]:
    """Return the root loop, numbered from 1, and a ring around each other loop.

    ``shape`` is in the sheet's mm and ``ribbon`` is its half-width in mm; a ring has ``room`` radii, at least 2.5, on
    either side of its disks' centres. Raises ``UnfoldableError`` with the loop's place where there is no room for a
    ring.
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
        # growing too far and shrinking again rounds the notches of the curve
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
        raise _no_room(loop, shape)
    at = np.arange(count) * (curve.length / count)
    centres = shapely.get_coordinates(shapely.line_interpolate_point(curve, at))
    if not curve.is_ccw:
        centres = centres[::-1]
    centres = equal_sides(centres)
    if not _sides(centres)[1].all():
        raise _no_room(loop, shape)
    lines = [polygons[above - 1].exterior, polygons[loop - 1].exterior]
    distance = sum(shapely.distance(shapely.points(centres), line) for line in lines)
    centres = np.roll(centres, -int(np.argmin(distance)), axis=0)
    gate = shapely.Point(centres[0])
    ends = np.array([line.interpolate(line.project(gate)).coords[0] for line in lines])
    return Ring(loop, face, above, centres, float(np.hypot(*(centres[1] - centres[0]))) / 2, ends)


def _no_room(loop: int, shape: Shape) -> UnfoldableError:
    x, y = shape.loops[loop - 1].mean(axis=0)
    return UnfoldableError(
        f"there is too little room around loop {loop}, near ({x:.4g}, {y:.4g}), for a ring of at most {MOST} "
        "disks; move the loops apart or use a bigger sheet"
    )


def _sides(points: Floats) -> tuple[Floats, Floats]:
    """The sides of a polygon and their lengths."""
    sides = np.roll(points, -1, axis=0) - points
    return sides, np.hypot(*sides.T)


def equal_sides(points: Floats) -> Floats:
    """Move the corners of a polygon, ``(n, 2)``, as little as possible so that all its sides are equal.

    Each step of Newton's method is the shortest, ``rows.T @ solve(rows @ rows.T, off)``, where each side has a row for
    its two corners and the common length. A polygon with a side of no length stays as it is: that side has no
    direction.
    """
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import splu

    count = len(points)
    side = np.arange(count)
    before_side = np.roll(side, 1)
    off = math.inf
    for _ in range(20):
        sides, lengths = _sides(points)
        if not lengths.all():
            break
        unit = sides / lengths[:, None]
        mean = lengths.mean()
        before, off = off, float(np.abs(mean - lengths).max())
        if off < 1e-14 * mean or off >= before:  # only rounding is left
            break
        # rows @ rows.T is sparse except for the common length, which adds 1 everywhere: Sherman-Morrison
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
    """Return the limit that keeps boundary disks off the rings' petals, and small where the corridors end."""
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
