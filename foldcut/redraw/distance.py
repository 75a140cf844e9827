"""How far two outlines are apart: the Hausdorff distance of their lines."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from foldcut.core.arrays import Floats, Indices

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

    def nearest(points: Floats) -> tuple[Floats, Indices]:
        """Return how far points are from the nearest of the segments, and its number."""
        number = tree.query_nearest(shapely.points(points), all_matches=False)[1]
        a, b = segments[number].transpose(1, 0, 2)
        along, away = b - a, points - a
        share = np.clip((away * along).sum(axis=1) / np.maximum((along * along).sum(axis=1), 1e-300), 0, 1)
        away = away - share[:, None] * along
        return np.hypot(away[:, 0], away[:, 1]), number

    off, first = nearest(start)
    best = float(off.max())
    last = np.concatenate([np.roll(part, -1) for part in np.split(first, np.cumsum([len(loop) for loop in some])[:-1])])
    while len(start):
        middle = (start + end) / 2
        off, between = nearest(middle)
        best = max(best, float(off.max()))
        half = np.hypot(*(end - start).T) / 2
        far = off + half > best + error
        # how far a piece is from one segment is greatest at an end: if both are nearest to the same, nothing is farther
        one, other = far & (first != between), far & (between != last)
        start, end = np.concatenate([start[one], middle[other]]), np.concatenate([middle[one], end[other]])
        first, last = np.concatenate([first[one], between[other]]), np.concatenate([between[one], last[other]])
    return best
