"""The loops of a shape and of its sheet, with the borders of the ribbon and the disks at their corners.

The loops are numbered with the sheet's border as loop 0 and the shape's loops after it; face f of the plane is the
region directly inside loop f. Paper section 2 for the vertex disks, section 5 for the ribbon.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from foldcut.core.arrays import Floats
from foldcut.core.model import Shape, Sheet
from foldcut.geometry.vectors import cross, left_normal

__all__ = ["RIBBON_SLACK", "Loop", "distances_to_edges", "loops_of", "vertex_radii"]

RIBBON_SLACK = 0.2
"""A vertex disk may shrink to this fraction of its size to make room for the ribbon."""


@dataclass(frozen=True, eq=False)
class Loop:
    """A loop, the edges between its corners, and how the corners move when the ribbon widens.

    ``corners`` ``(n, 2)`` mm; of the edge after each corner ``lengths`` ``(n,)`` and unit ``directions`` ``(n, 2)``;
    ``half_width`` of the ribbon in mm; ``sides``: pairs (face, sign), the sign +1 on the left of the loop, -1 on its
    right.
    """

    corners: Floats
    lengths: Floats
    directions: Floats
    outward_cot: (
        Floats  # cot(theta / 2) of the angle on the left: how far an inset of 1 mm moves a corner along an edge
    )
    inset: Floats  # how an inset of 1 mm to the left moves a corner
    half_width: float
    sides: tuple[tuple[int, int], ...]

    @classmethod
    def build(cls, corners: Floats, half_width: float, sides: tuple[tuple[int, int], ...]) -> Loop:
        """Return the loop of these corners, no two of which coincide."""
        edges = np.roll(corners, -1, axis=0) - corners
        lengths = np.hypot(*edges.T)
        directions = edges / lengths[:, None]
        before = np.roll(directions, 1, axis=0)
        cot = cross(before, directions) / (1.0 + np.sum(before * directions, axis=1))
        inset = left_normal(directions) + directions * cot[:, None]
        return cls(corners, lengths, directions, cot, inset, half_width, sides)

    def offset(self, sign: int) -> Floats:
        """Return the corners, moved to the ribbon's border on one side."""
        return self.corners + sign * self.half_width * self.inset

    def shift(self, sign: int) -> Floats:
        """Return how much smaller a vertex disk is on the ribbon's border than at the corner itself."""
        return sign * self.half_width * self.outward_cot


def loops_of(shape: Shape, sheet: Sheet, ribbon: float) -> list[Loop]:
    """Return the sheet's border and the loops of a shape, which is in the sheet's mm; ``ribbon`` is its half-width."""
    loops = [Loop.build(sheet.corners, 0.0, ((0, +1),))]
    for number, (corners, parent) in enumerate(zip(shape.loops, shape.parent, strict=True), start=1):
        loops.append(Loop.build(corners, ribbon, ((number, +1), (parent + 1, -1))))
    return loops


def vertex_radii(loops: list[Loop]) -> list[Floats] | None:
    """Return the radii of the disks at each loop's corners, or None if the ribbon leaves no room for them.

    On each border of the ribbon, a vertex disk reaches halfway to the nearest edge that does not end at its corner.
    """
    limits = [np.full(len(loop.corners), np.inf) for loop in loops]
    for face in range(len(loops)):
        around = [(number, sign) for number, loop in enumerate(loops) for f, sign in loop.sides if f == face]
        starts = [loops[number].offset(sign) for number, sign in around]
        ends = [np.roll(points, -1, axis=0) for points in starts]
        for (number, _), start, end in zip(around, starts, ends, strict=True):
            if (np.sum((end - start) * loops[number].directions, axis=1) <= 0).any():
                return None
        for (number, sign), reach in zip(around, distances_to_edges(starts, ends), strict=True):
            np.minimum(limits[number], reach / 2 + loops[number].shift(sign), out=limits[number])
        if any(loops[number].half_width > 0 for number, _ in around) and not _is_simple(starts):
            return None
    for loop, radius in zip(loops, limits, strict=True):
        if loop.half_width > 0 and (radius - np.abs(loop.shift(1)) < RIBBON_SLACK * radius).any():
            return None
    return limits


def _is_simple(loops: list[Floats]) -> bool:
    largest = max(range(len(loops)), key=lambda i: float(np.ptp(loops[i], axis=0).max()))
    holes = [points for i, points in enumerate(loops) if i != largest]
    return bool(shapely.Polygon(loops[largest], holes).is_valid)


def distances_to_edges(starts: list[Floats], ends: list[Floats]) -> list[Floats]:
    """Return the distances from the corners of loops to the nearest edge, of any loop, that does not end there.

    The edge after the next starts at the next corner, so the nearest edge is no farther than that corner: only edges
    within this distance are considered.
    """
    counts = [len(points) for points in starts]
    start, end = np.concatenate(starts), np.concatenate(ends)
    before = np.concatenate(
        [first + np.roll(np.arange(n), 1) for first, n in zip(_firsts(counts), counts, strict=True)]
    )
    length = np.hypot(*(end - start).T)
    tree = shapely.STRtree(shapely.linestrings(np.stack([start, end], axis=1)))
    reach = np.minimum(length, length[before]) * (1 + 1e-9)
    corner, edge = tree.query(shapely.points(start), predicate="dwithin", distance=reach)
    apart = (corner != edge) & (edge != before[corner])
    corner, edge = corner[apart], edge[apart]
    distances = np.full(len(start), np.inf)
    np.minimum.at(distances, corner, _point_segment_distances(start[corner], start[edge], end[edge]))
    return np.split(distances, np.cumsum(counts)[:-1])


def _firsts(counts: list[int]) -> list[int]:
    return [0, *np.cumsum(counts)[:-1].tolist()]


def _point_segment_distances(points: Floats, starts: Floats, ends: Floats) -> Floats:
    """Distances from points to segments, ``(n,)``; no segment is a point."""
    along = ends - starts
    to_point = points - starts
    part = np.clip(np.sum(to_point * along, axis=1) / np.sum(along * along, axis=1), 0.0, 1.0)
    away = to_point - part[:, None] * along
    distances: Floats = np.hypot(away[:, 0], away[:, 1])
    return distances
