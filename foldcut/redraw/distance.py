"""How far two outlines are apart: the Hausdorff distance of their lines."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from foldcut.core.arrays import Floats

__all__ = ["apart", "farthest"]

EXACT = 1e-4
"""How exact the distance is, relative to the size of the loops."""


def apart(some: Sequence[Floats], others: Sequence[Floats]) -> float:
    """Return how far any point of one outline is at most from the other outline, both ways.

    Outlines are closed loops, ``(n, 2)``, in the same units.
    """
    return max(
        farthest(one, other, EXACT * float(np.ptp(np.concatenate(one), axis=0).max()))
        for one, other in ((some, others), (others, some))
    )


def farthest(some: Sequence[Floats], others: Sequence[Floats], error: float) -> float:
    """Return how far a point of ``some`` is at most from ``others``: pieces that may be farther are halved.

    Outlines are closed loops, ``(n, 2)``, in the same units as ``error``, by which the result may be too small.
    """
    start = np.concatenate(some)
    end = np.concatenate([np.roll(loop, -1, axis=0) for loop in some])
    segments = np.stack([np.concatenate(others), np.concatenate([np.roll(loop, -1, axis=0) for loop in others])], 1)
    tree = shapely.STRtree(shapely.linestrings(segments))

    def distances(points: Floats) -> Floats:
        nearest = tree.query_nearest(shapely.points(points), all_matches=False)[1]
        a, b = segments[nearest].transpose(1, 0, 2)
        along, away = b - a, points - a
        share = np.clip((away * along).sum(axis=1) / np.maximum((along * along).sum(axis=1), 1e-300), 0, 1)
        away = away - share[:, None] * along
        found: Floats = np.hypot(away[:, 0], away[:, 1])
        return found

    best = float(distances(start).max())
    while len(start):
        middle = (start + end) / 2
        here = distances(middle)
        best = max(best, float(here.max()))
        half = np.hypot(*(end - start).T) / 2
        far = here + half > best + error
        start, middle, end = start[far], middle[far], end[far]
        start, end = np.concatenate([start, middle]), np.concatenate([middle, end])
    return best
