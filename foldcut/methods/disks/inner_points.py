"""Where the inner vertices of molecules lie, on the sheet and folded: incentres, perpendicular points and gussets.

Paper section 3. Which diagonal a gusset has, and where the perpendicular points count as one, follows from the
requirement that both perpendicular points lie inside.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from foldcut.core.arrays import BLOCK, Bools, Floats, Numbers
from foldcut.core.errors import UnfoldableError
from foldcut.methods.disks.packing import Packing
from foldcut.methods.disks.templates import COINCIDENT, GUSSET, TRIANGLE
from foldcut.methods.disks.tolerance import Tolerance

__all__ = ["InnerPoints", "inner_points"]


class InnerPoints(NamedTuple):
    """The inner vertices of some molecules of one sort.

    ``molecules`` ``(n,)``; ``flat`` and ``folded`` ``(n, k, 2)`` mm, in the order of the template.
    """

    sort: int
    molecules: Numbers
    flat: Floats
    folded: Floats


class _Gusset(NamedTuple):
    """What a diagonal gives: the inset's height, the perpendicular points, their heights, and their distance, ``(n,)``.

    The inset is infinite where the perpendicular points do not exist or do not lie inside.
    """

    inset: Floats
    u: Floats
    v: Floats
    u_height: Floats
    v_height: Floats
    distance: Floats


def inner_points(packing: Packing, tolerance: Tolerance) -> Iterator[InnerPoints]:
    """Yield the inner vertices of all molecules, some molecules of one sort at a time.

    Raises ``UnfoldableError`` with the place where a quadrilateral has no gusset.
    """
    shapes = _Shapes(packing, tolerance)
    sizes = packing.gaps.lengths
    for low in range(0, len(sizes), BLOCK):
        size = sizes[low : low + BLOCK]
        yield shapes.triangles(low + np.flatnonzero(size == 3))
        yield from shapes.quadrilaterals(low + np.flatnonzero(size == 4))


class _Shapes:
    """The molecules' disks, and the height at which their sides fold."""

    def __init__(self, packing: Packing, tolerance: Tolerance) -> None:
        self.packing = packing
        self.tolerance = tolerance
        self.first = packing.gaps.offsets[:-1]
        self.sign = np.where(packing.face_inside, 1.0, -1.0)[packing.gap_face]

    def triangles(self, which: Numbers) -> InnerPoints:
        """Return the incentres of triangles."""
        centres, radii = self._disks(which, 3)
        apex, _ = _radical_centre(centres, radii)
        height = _height(apex, centres[:, 0], centres[:, 1])
        return InnerPoints(
            TRIANGLE, which, apex[:, None], self._folded(which, np.zeros((len(which), 1)), height[:, None])
        )

    def quadrilaterals(self, which: Numbers) -> Iterator[InnerPoints]:
        """Yield the quadrilaterals with one inner point, and those with a gusset from corner 0, or from corner 1."""
        centres, radii = self._disks(which, 4)
        choices = [_gusset(centres, radii, first) for first in (0, 1)]
        insets = np.stack([choice.inset for choice in choices])
        chosen = (insets[1] < insets[0]).astype(np.intp)
        bad = np.flatnonzero(np.isinf(insets.min(axis=0)))
        if len(bad):
            x, y = centres[bad[0]].mean(axis=0)
            raise UnfoldableError(
                f"the quadrilateral of disks near ({x:.3f}, {y:.3f}) mm has no gusset; move the drawing a little"
            )
        row = np.arange(len(which))
        _, u, v, u_height, v_height, distance = (np.stack(both)[chosen, row] for both in zip(*choices, strict=True))
        one_point = distance <= self.tolerance.tie * radii.min(axis=1, initial=np.inf) + self.tolerance.rounding
        middle, height = (u + v) / 2, (u_height + v_height) / 2
        at = which[one_point]
        landed = self._folded(at, np.zeros((len(at), 1)), height[one_point, None])
        yield InnerPoints(COINCIDENT, at, middle[one_point, None], landed)
        for first in (0, 1):
            mine = ~one_point & (chosen == first)
            at = which[mine]
            heights = (u_height[mine] + v_height[mine] - distance[mine]) / 2
            along = (v[mine] - u[mine]) / distance[mine, None]
            m = u[mine] + along * (u_height[mine] - heights)[:, None]
            p, p_x = _inset_corner(centres[mine], radii[mine], first, heights)
            r, r_x = _inset_corner(centres[mine], radii[mine], (first + 2) % 4, heights)
            zero = np.zeros(len(at))
            x = np.stack([zero, zero, zero, p_x, r_x], axis=1)
            z = np.stack([u_height[mine], v_height[mine], heights, heights, heights], axis=1)
            flat = np.stack([u[mine], v[mine], m, p, r], axis=1)
            yield InnerPoints(GUSSET + first, at, flat, self._folded(at, x, z))

    def _disks(self, which: Numbers, sides: int) -> tuple[Floats, Floats]:
        disks = self.packing.gaps.values[self.first[which][:, None] + np.arange(sides)]
        return self.packing.centres[disks], self.packing.radii[disks]

    def _folded(self, which: Numbers, x: Floats, height: Floats) -> Floats:
        """Where points at distance ``x`` from the spine and ``height`` from their side fold to."""
        return np.stack([x, self.sign[which, None] * (self.packing.ribbon + height)], axis=2)


def _gusset(centres: Floats, radii: Floats, first: int) -> _Gusset:
    """Return what the diagonal from corner ``first`` gives."""
    a, b, c, d = ((first + k) % 4 for k in range(4))
    u, u_exists = _radical_centre(centres[:, [a, b, c]], radii[:, [a, b, c]])
    v, v_exists = _radical_centre(centres[:, [c, d, a]], radii[:, [c, d, a]])
    u_height, v_height = _height(u, centres[:, a], centres[:, b]), _height(v, centres[:, c], centres[:, d])
    x, y = (v - u).T
    distance = np.sqrt(x * x + y * y)
    good = u_exists & v_exists & (u_height > 0) & (v_height > 0)
    with np.errstate(invalid="ignore"):
        inset = np.where(good, u_height + v_height - distance, np.inf)
    return _Gusset(inset, u, v, u_height, v_height, distance)


def _radical_centre(centres: Floats, radii: Floats) -> tuple[Floats, Bools]:
    """The radical centres of three circles each, and whether there is one: not where the centres are collinear."""
    (x, y), (ux, uy), (vx, vy) = centres[:, 0].T, (centres[:, 1] - centres[:, 0]).T, (centres[:, 2] - centres[:, 0]).T
    determinant = ux * vy - uy * vx
    exists = np.abs(determinant) > 1e-12 * (ux * ux + uy * uy + vx * vx + vy * vy)
    square = radii * radii
    u = (ux * ux + uy * uy + square[:, 0] - square[:, 1]) / 2
    v = (vx * vx + vy * vy + square[:, 0] - square[:, 2]) / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.stack([x + (u * vy - v * uy) / determinant, y + (ux * v - vx * u) / determinant], axis=1), exists


def _height(point: Floats, start: Floats, end: Floats) -> Floats:
    """The distances of points to the left of the lines from ``start`` to ``end``."""
    (ax, ay), (bx, by) = (end - start).T, (point - start).T
    with np.errstate(invalid="ignore"):
        heights: Floats = (ax * by - ay * bx) / np.sqrt(ax * ax + ay * ay)
    return heights


def _inset_corner(centres: Floats, radii: Floats, k: int, h: Floats) -> tuple[Floats, Floats]:
    """The corners k of the inset polygons at height h, and their radii, smaller by h cot(alpha / 2).

    They lie on the bisectors. The sine and cosine of half the angle are half the lengths of the difference and of the
    sum of the sides' directions.
    """
    corner = centres[:, k]
    (ax, ay), (bx, by) = _directions(corner, centres[:, (k + 1) % 4]), _directions(corner, centres[:, k - 1])
    apart_x, apart_y, sum_x, sum_y = ax - bx, ay - by, ax + bx, ay + by
    sine = np.sqrt(apart_x * apart_x + apart_y * apart_y) / 2
    cosine = np.where(ax * by - ay * bx >= 0, 1.0, -1.0) * np.sqrt(sum_x * sum_x + sum_y * sum_y) / 2
    reach = h / sine
    x = corner[:, 0] + reach * (ax * cosine - ay * sine)
    y = corner[:, 1] + reach * (ax * sine + ay * cosine)
    return np.stack([x, y], axis=1), radii[:, k] - h * (cosine / sine)


def _directions(start: Floats, end: Floats) -> tuple[Floats, Floats]:
    x, y = (end - start).T
    length = np.sqrt(x * x + y * y)
    return x / length, y / length
