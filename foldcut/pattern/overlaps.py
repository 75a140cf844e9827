"""Which faces of a folded sheet lie on each other.

Where the vertices are and the faces -> pairs of faces. Faces that only touch do not overlap.
"""

from __future__ import annotations

import mapbox_earcut
import numpy as np
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Floats, Ints, Ragged

__all__ = ["OVERLAP_TOLERANCE", "distinct", "doubled_areas", "overlaps", "wholly_outside"]

OVERLAP_TOLERANCE = 1e-9
"""Folded faces that overlap by less than this fraction of the sheet's diagonal only touch."""

CHUNK = 128
"""This many faces are compared with all others at once: few enough for the processor's cache."""

PROBES = 16
"""The number of places where faces are counted, to find out early that there are too many pairs."""


def overlaps(points: Floats, faces: Ragged, tolerance: float, most: int) -> Ints | None:
    """Return the pairs of faces that overlap, ``(m, 2)`` with f < g, or None if more than ``most`` do.

    ``points`` ``(v, 2)`` are the places of the vertices in the folded state; faces that overlap by less than
    ``tolerance``, in the same unit, only touch.
    Two convex pieces overlap unless one lies wholly outside some side of the other (separating axis theorem).
    """
    if len(faces) < 2:
        return np.empty((0, 2), dtype=np.int32)
    if _surely_more(points, faces, tolerance, most):
        return None
    pieces, faces_of_pieces = _convex_pieces(points, faces)
    sides = _inward_sides(points, pieces)
    found = [np.empty(0, dtype=np.int64)]
    for first in range(0, len(pieces), CHUNK):
        # These pieces against themselves and all later ones.
        these, rest = slice(first, first + CHUNK), slice(first, None)
        apart = wholly_outside(points, pieces[rest], sides[:, these], tolerance).T
        apart |= wholly_outside(points, pieces[these], sides[:, rest], tolerance)
        f, g = faces_of_pieces[np.argwhere(np.triu(~apart, k=1)) + first].T
        found.append(distinct(f[f != g] * len(faces) + g[f != g]))
        if sum(map(len, found)) > most:
            return None
    return np.column_stack(np.divmod(distinct(np.concatenate(found)), len(faces))).astype(np.int32)


def _surely_more(points: Floats, faces: Ragged, tolerance: float, most: int) -> bool:
    """Return True only if more than ``most`` pairs overlap: any two of the convex faces that cover one place do."""
    if len(faces) * (len(faces) - 1) // 2 <= most:
        return False
    starts, following = faces.offsets[:-1], faces.following
    corner = points[faces.values]
    side = corner[following] - corner
    length = np.hypot(side[:, 0], side[:, 1])
    turned = np.sign(doubled_areas(points, faces))
    convex = np.ones(len(faces), dtype=bool)
    convex[list(_faces_with_bends(points, faces))] = False
    # a side without length says nothing about whether a place is inside
    normal = side[:, ::-1] * (-1, 1) * (turned[faces.rows] / np.where(length > 0, length, 1.0))[:, None]
    for face in np.flatnonzero(convex)[:: max(1, np.count_nonzero(convex) // PROBES)]:
        place = corner[starts[face] : faces.offsets[face + 1]].mean(axis=0)
        inward = np.where(length > 0, np.sum((place - corner) * normal, axis=1), np.inf)
        around = np.count_nonzero(convex & (np.minimum.reduceat(inward, starts) > 10 * tolerance))
        if around * (around - 1) // 2 > most:
            return True
    return False


def distinct(keys: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the keys sorted, without repetitions; ``np.unique`` takes ten times as long for millions."""
    keys = np.sort(keys)
    return keys[np.diff(keys, prepend=-1) > 0]


def wholly_outside(points: Floats, pieces: Ints, sides: Floats, tolerance: float) -> Bools:
    """Return whether piece i lies wholly outside some side of piece j, ``(i, j)``."""
    used, corners = np.unique(pieces, return_inverse=True)
    points, pieces = points[used], corners.astype(np.int32).reshape(pieces.shape)
    outside = np.zeros((len(pieces), sides.shape[1]), dtype=bool)
    for side in sides:
        heights = points @ side[:, :2].T + side[:, 2]
        highest = heights[pieces[:, 0]]
        for corner in pieces.T[1:]:
            np.maximum(highest, heights[corner], out=highest)
        outside |= highest <= tolerance
    return outside


def _inward_sides(points: Floats, pieces: Ints) -> Floats:
    """Return the sides of the pieces as (a, b, c), ``(4, n, 3)``: a x + b y + c is the distance inward."""
    start = points[pieces.T]
    vector = np.roll(start, -1, axis=0) - start
    length = np.hypot(vector[..., 0], vector[..., 1])
    counter_clockwise = np.sign(_cross(start[2] - start[0], start[3] - start[1]))
    scale = counter_clockwise / np.where(length > 0, length, np.inf)
    normal = np.stack([-vector[..., 1], vector[..., 0]], axis=-1) * scale[..., None]
    constant = -np.sum(normal * start, axis=-1)
    constant[length == 0] = np.inf  # a side without length separates nothing
    return np.concatenate([normal, constant[..., None]], axis=-1)


def _convex_pieces(points: Floats, faces: Ragged) -> tuple[Ints, NDArray[np.int64]]:
    """Divide the faces into triangles and convex quadrilaterals.

    Returns their vertices, ``(n, 4)``, where a triangle has its last vertex twice, and the face of each.
    """
    bent = _faces_with_bends(points, faces)
    rows, owners = [], []
    for face, outline in enumerate(faces.to_lists()):
        if face in bent:
            ends = np.array([len(outline)], dtype=np.uint32)
            parts = mapbox_earcut.triangulate_float64(points[outline], ends).reshape(-1, 3).tolist()
            fan = [[outline[corner] for corner in part] for part in parts]
        else:
            fan = [[outline[0], *outline[at : at + 3]] for at in range(1, len(outline) - 1, 2)]
        rows += [[*part, part[-1]] if len(part) == 3 else part for part in fan]
        owners += [face] * len(fan)
    return np.array(rows, dtype=np.int32).reshape(-1, 4), np.array(owners, dtype=np.int64)


def _faces_with_bends(points: Floats, faces: Ragged) -> set[int]:
    """Return the faces that are not convex."""
    following = faces.following
    corner = points[faces.values]
    vector = corner[following] - corner
    turn = _cross(vector, vector[following]) * np.sign(doubled_areas(points, faces))[faces.rows]
    length = np.hypot(vector[:, 0], vector[:, 1])
    reflex = turn < -OVERLAP_TOLERANCE * length * length[following]
    return set(faces.rows[reflex].tolist())


def doubled_areas(points: Floats, faces: Ragged) -> Floats:
    """Return twice the signed area of every face; below 0 = clockwise."""
    # Relative to each face's first corner, so that small faces far from the origin keep their digits.
    corner = points[faces.values] - points[faces.values[faces.offsets[:-1]]][faces.rows]
    return np.add.reduceat(_cross(corner, corner[faces.following]), faces.offsets[:-1])


def _cross(a: Floats, b: Floats) -> Floats:
    """Return the cross products of the rows of two ``(n, 2)`` arrays."""
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
