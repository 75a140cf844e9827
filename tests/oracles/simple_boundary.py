"""Distances from corners to edges, all with all: what ``foldcut.methods.disks.boundary`` looks up in a tree."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from foldcut.core.arrays import Floats


def distances_to_edges(starts: Sequence[Floats], ends: Sequence[Floats]) -> list[Floats]:
    """Distances from the corners of loops to the nearest edge, of any of the loops, that does not end there."""
    found = []
    for place, points in enumerate(starts):
        reach = np.full(len(points), np.inf)
        for other, (start, end) in enumerate(zip(starts, ends, strict=True)):
            distance = _distances(points, start, end)
            if other == place:
                row = np.arange(len(points))
                distance[row, row] = distance[row, row - 1] = np.inf
            reach = np.minimum(reach, distance.min(axis=1))
        found.append(reach)
    return found


def _distances(points: Floats, starts: Floats, ends: Floats) -> Floats:
    along = ends - starts
    to_point = points[:, None] - starts[None]
    part = np.clip(np.sum(to_point * along, axis=2) / np.sum(along * along, axis=1), 0.0, 1.0)
    away = to_point - part[:, :, None] * along
    distances: Floats = np.hypot(away[:, :, 0], away[:, :, 1])
    return distances
