"""A flat sheet whose creases have begun to close together: its vertices in space, for a picture of the movement.

``CreasePattern`` -> ``HalfClosed``. The sheet is a net of bars that keep their lengths and of hinges: creases turn
towards a part of a half turn, and the faces between them, divided into triangles, bend a little, as paper does. The
angles grow step by step, by Levenberg and Marquardt's method; at the end the lengths count far more than the angles.
How far lengths are off then, and whether anything crosses, is measured; what is not good enough is not returned.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from foldcut.core.arrays import Bools, Floats, Indices
from foldcut.core.model import CreasePattern

if TYPE_CHECKING:
    from scipy.sparse import csr_array

__all__ = ["MOST_STRAIN_MM", "HalfClosed", "half_closed"]

SHARES = (0.05, 0.1, 0.2, 0.3)
"""The shares of a half turn that the creases turn towards, one after another."""

MOST_VERTICES = 150
"""Sheets with more vertices than this are not closed: it takes too long."""

MOST_STRAIN_MM = 0.05
"""No bar of what is returned is longer or shorter than on the flat sheet by more than this."""

BARS = 300.0
"""The weight of the lengths, in mean lengths."""

CREASES = 1.0
"""The weight of the creases' angles, in radians, while these grow."""

FACES = 2.0
"""The weight of the angles within faces meanwhile."""

AT_LAST = (0.2, 0.5)
"""The weights of both at the end."""

THIN = 1e-7
"""A face with a part that is thinner than this, its height by its length, has no angles to speak of."""

ROUNDS = 40
"""At each angle, so many steps are made at most."""

ENOUGH = 1e-9
"""A step that lessens the error by less than this, as a fraction, is the last."""


@dataclass(frozen=True, eq=False)
class HalfClosed:
    """A sheet in space: ``points`` ``(v, 3)`` mm, and the ``triangles`` ``(t, 3)`` that its faces are divided into.

    ``strain_mm``: by how much the length of a side of a triangle is off at most.
    """

    points: Floats
    triangles: Indices
    strain_mm: float


def half_closed(creases: CreasePattern) -> HalfClosed | None:
    """Return a flat sheet with all creases about a third closed, or None where that is not found without crossing."""
    if len(creases.vertices_coords) > MOST_VERTICES:
        return None
    net = _Net(creases)
    points: Floats = np.column_stack([net.flat, np.zeros(len(net.flat))])
    if min(_width(net.flat, triangle) for triangle in net.triangles.tolist()) < THIN:
        return None
    for share in SHARES:
        points = net.settled(points, share * math.pi, CREASES, FACES)
    points = net.settled(points, SHARES[-1] * math.pi, *AT_LAST)
    strain = net.strain(points)
    if strain > MOST_STRAIN_MM or net.crosses(points):
        return None
    return HalfClosed(points, net.triangles, strain)


class _Net:
    """Bars and hinges of a sheet.

    Each bar ``(b, 2)`` joins two vertices; each hinge ``(h, 4)`` is an edge, and the third corners of the triangles on
    its left and on its right. ``way`` ``(h,)``: 1 for valleys, -1 for mountains, 0 within faces. ``entries``: row and
    column of all slopes that are not always zero.
    """

    def __init__(self, creases: CreasePattern) -> None:
        self.flat = creases.vertices_coords
        triangles = [t for ring in creases.faces_vertices.to_lists() for t in _triangles(self.flat, ring)]
        self.triangles = np.array(triangles)
        third = {(t[k], t[(k + 1) % 3]): t[(k + 2) % 3] for t in triangles for k in range(3)}
        self.bars = np.array(sorted({(min(pair), max(pair)) for pair in third}))
        self.lengths = np.hypot(*(self.flat[self.bars[:, 1]] - self.flat[self.bars[:, 0]]).T)
        self.mean = float(self.lengths.mean())
        kinds = zip(creases.edges_vertices.tolist(), creases.edges_assignment.tolist(), strict=True)
        kind = {(min(ends), max(ends)): letter for ends, letter in kinds}
        inner = sorted(pair for pair in third if pair[0] < pair[1] and pair[::-1] in third)
        self.hinges = np.array([(*pair, third[pair], third[pair[::-1]]) for pair in inner])
        self.way = np.array([{"V": 1.0, "M": -1.0}.get(kind.get(pair, ""), 0.0) for pair in inner])
        ends = self.flat[self.hinges[:, :2]]
        self.spans = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
        count, hinges = len(self.bars), len(self.bars) + np.arange(len(self.hinges))
        rows = [np.arange(count), np.arange(count), hinges, hinges, hinges, hinges]
        places = np.concatenate([self.bars[:, 0], self.bars[:, 1], *self.hinges.T])
        self.entries = np.repeat(np.concatenate(rows), 3), (places[:, None] * 3 + np.arange(3)).ravel()

    def settled(self, points: Floats, angle: float, creases: float, faces: float) -> Floats:
        """Return the points where lengths and angles are as near as can be to what they should be."""
        from scipy.sparse import eye_array
        from scipy.sparse.linalg import spsolve

        damping = 1e-3
        off, slopes = self._errors(points, angle, creases, faces)
        error = float(off @ off)
        for _ in range(ROUNDS):
            normal = (slopes.T @ slopes + damping * eye_array(slopes.shape[1])).tocsc()
            step = spsolve(normal, -(slopes.T @ off)).reshape(-1, 3)
            further, steeper = self._errors(points + step, angle, creases, faces)
            new = float(further @ further)
            if new < error:
                done = error - new < ENOUGH * error
                points, off, slopes, error = points + step, further, steeper, new
                damping = max(damping / 4, 1e-9)
                if done:
                    break
            else:
                damping *= 6
        return points

    def _errors(self, points: Floats, angle: float, creases: float, faces: float) -> tuple[Floats, csr_array]:
        """Return the weighted errors of lengths and angles, and their slopes by the coordinates, a sparse array."""
        from scipy.sparse import coo_array

        away = points[self.bars[:, 1]] - points[self.bars[:, 0]]
        lengths = np.linalg.norm(away, axis=1)
        weight = BARS / self.mean
        pull = away / lengths[:, None] * weight
        turned, by_corner = self._angles(points)
        weights = np.where(self.way == 0, faces, creases) * np.sqrt(self.spans / self.mean)
        off = np.concatenate([weight * (lengths - self.lengths), weights * (turned - self.way * angle)])
        slopes = [-pull, pull, *(weights[:, None] * slope for slope in by_corner)]
        return off, coo_array((np.concatenate(slopes).ravel(), self.entries), shape=(len(off), points.size)).tocsr()

    def _angles(self, points: Floats) -> tuple[Floats, list[Floats]]:
        """Return the angle of each hinge, 0 if it is flat and positive for valleys, and its slopes by its corners."""
        a, b, left, right = (points[self.hinges[:, k]] for k in range(4))
        edge = b - a
        span = np.linalg.norm(edge, axis=1)
        one, other = np.cross(edge, left - a), np.cross(right - a, edge)
        turned = np.arctan2((np.cross(other, one) * edge).sum(axis=1) / span, (one * other).sum(axis=1))
        by_left = (span / (one**2).sum(axis=1))[:, None] * one
        by_right = (span / (other**2).sum(axis=1))[:, None] * other
        at_left, at_right = (((p - a) * edge).sum(axis=1)[:, None] / span[:, None] ** 2 for p in (left, right))
        by_a = -(1 - at_left) * by_left - (1 - at_right) * by_right
        by_b = -at_left * by_left - at_right * by_right
        return turned, [by_a, by_b, by_left, by_right]

    def strain(self, points: Floats) -> float:
        """Return by how much the length of a bar is off at most, in mm."""
        lengths = np.linalg.norm(points[self.bars[:, 1]] - points[self.bars[:, 0]], axis=1)
        return float(np.abs(lengths - self.lengths).max())

    def crosses(self, points: Floats) -> bool:
        """Return whether a bar goes through a triangle with which it shares no vertex."""
        start, end = points[self.bars[:, 0]], points[self.bars[:, 1]]
        for triangle in self.triangles.tolist():
            apart = ~np.isin(self.bars, triangle).any(axis=1)
            if _go_through(start[apart], end[apart], points[triangle]).any():
                return True
        return False


def _go_through(start: Floats, end: Floats, triangle: Floats) -> Bools:
    """Return which segments go through a triangle, ``(3, 3)``."""
    a, b, c = triangle
    normal = np.cross(b - a, c - a)
    low, high = (start - a) @ normal, (end - a) @ normal
    through = low * high < 0
    share = np.where(through, low / np.where(through, low - high, 1.0), 0.0)
    places = start + share[:, None] * (end - start)
    inside: Bools = through
    for one, other in ((a, b), (b, c), (c, a)):
        inside = inside & (np.cross(other - one, places - one) @ normal > 0)
    return inside


def _triangles(points: Floats, ring: list[int]) -> list[list[int]]:
    """Divide a face into triangles: one corner after another is cut off, the one with the widest triangle first."""
    left, found = list(ring), []
    while len(left) > 3:
        widths = []
        for k in range(len(left)):
            corner = [left[k - 1], left[k], left[(k + 1) % len(left)]]
            free = not any(_is_inside(points, corner, other) for other in left if other not in corner)
            widths.append(_width(points, corner) if free else -math.inf)
        k = int(np.argmax(widths))
        found.append([left[k - 1], left[k], left[(k + 1) % len(left)]])
        left.pop(k)
    return [*found, left]


def _width(points: Floats, corner: list[int]) -> float:
    """Return how wide a triangle is: its area by the square of its longest side, negative if it is clockwise."""
    (ax, ay), (bx, by), (cx, cy) = points[corner].tolist()
    area: float = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    longest = max(math.hypot(bx - ax, by - ay), math.hypot(cx - bx, cy - by), math.hypot(ax - cx, ay - cy))
    return area / longest**2


def _is_inside(points: Floats, corner: list[int], other: int) -> bool:
    i, j, k = corner
    return all(_width(points, [one, two, other]) > 0 for one, two in ((i, j), (j, k), (k, i)))
