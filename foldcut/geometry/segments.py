"""Relations between straight segments."""

from __future__ import annotations

import numpy as np

from foldcut.core.arrays import Bools, Floats


def collinear_overlap(one: Floats, other: Floats, tolerance: float) -> tuple[Floats, Bools]:
    """Return the length along which each pair of segments coincides, ``(n,)``, and whether both point the same way.

    ``one`` and ``other`` are ``(n, 2, 2)``. The length is 0 where an end of the shorter segment is farther than
    ``tolerance`` from the line through the longer one.
    """
    first, second = one[:, 1] - one[:, 0], other[:, 1] - other[:, 0]
    swap = np.hypot(*second.T) > np.hypot(*first.T)
    base = np.where(swap[:, None, None], other, one)
    probe = np.where(swap[:, None, None], one, other)
    along = base[:, 1] - base[:, 0]
    length = np.hypot(*along.T)
    along = along / length[:, None]
    away = probe - base[:, :1]
    aside = np.abs(along[:, None, 0] * away[..., 1] - along[:, None, 1] * away[..., 0]).max(axis=1)
    on = (away * along[:, None]).sum(axis=2)
    overlap = np.minimum(on.max(axis=1), length) - np.maximum(on.min(axis=1), 0)
    return np.where(aside <= tolerance, np.maximum(overlap, 0), 0), (first * second).sum(axis=1) > 0
