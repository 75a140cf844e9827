"""Pairs of disks that are near each other: which overlap, which touch, and how much room is between them."""

from __future__ import annotations

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, Ints
from foldcut.methods.disks.tolerance import Tolerance

__all__ = ["NEARLY_TOUCHING", "near_disks", "nearly_touching", "overlapping_disks", "touching_disks"]

NEARLY_TOUCHING = 0.02
"""Boundary disks whose gap is less than this fraction of the smaller radius nearly touch.

The gap beside them would fold to creases far too short, so vertex disks are shrunk there, and others split. Vertex
disks often nearly touch: half the distance to an edge is nearly half the distance to that edge's end.
"""


def overlapping_disks(centres: Floats, radii: Floats, face: Ints, tolerance: Tolerance) -> tuple[Ints, Ints]:
    """Return the pairs i < j of disks of one face that overlap by more than the tie tolerance."""
    i, j, slack = near_disks(centres, radii, face)
    crowded = slack < -tolerance.touching(radii[i], radii[j])
    return i[crowded], j[crowded]


def touching_disks(centres: Floats, radii: Floats, face: Ints, tolerance: Tolerance) -> tuple[Ints, Ints]:
    """Return the pairs i < j of disks of one face that touch within the tie tolerance."""
    i, j, slack = near_disks(centres, radii, face)
    touching = np.abs(slack) <= tolerance.touching(radii[i], radii[j])
    return i[touching], j[touching]


def near_disks(centres: Floats, radii: Floats, face: Ints, chosen: Bools | None = None) -> tuple[Ints, Ints, Floats]:
    """Return the pairs i < j of disks of one face whose boxes meet, and the distance between their circles.

    The distance is negative where they overlap. A negative ``face`` takes a disk out. ``chosen`` ``(n,)`` keeps only
    pairs with at least one of these disks.
    """
    used = np.flatnonzero(face >= 0)
    reach = radii[used, None] * (1 + NEARLY_TOUCHING)
    low, high = centres[used] - reach, centres[used] + reach
    boxes = shapely.linestrings(np.stack([low, high], axis=1))  # diagonals: faster to make, with the same bounds
    if chosen is None:
        left, right = shapely.STRtree(boxes).query(boxes)
        kept = left < right
    else:
        asked = np.flatnonzero(chosen[used])
        left, right = shapely.STRtree(boxes).query(boxes[asked])
        left = asked[left]
        kept = (left < right) | ~chosen[used[right]]
    i, j = used[np.minimum(left[kept], right[kept])], used[np.maximum(left[kept], right[kept])]
    same = face[i] == face[j]
    i, j = i[same].astype(np.int32), j[same].astype(np.int32)
    away = centres[i] - centres[j]
    return i, j, np.hypot(away[:, 0], away[:, 1]) - radii[i] - radii[j]


def nearly_touching(slack: Floats, a: Floats, b: Floats, tolerance: Tolerance) -> Bools:
    """Tell which disks of radii ``a`` and ``b``, ``slack`` apart, nearly touch but do not touch."""
    return (slack > tolerance.touching(a, b)) & (slack < NEARLY_TOUCHING * np.minimum(a, b))
