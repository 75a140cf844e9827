"""The frame in which the wavefront of a graph moves."""

from __future__ import annotations

import math

import numpy as np

from foldcut.core.arrays import Floats

__all__ = ["Frame"]


class Frame:
    """A frame in which coordinates are within -1 and 1: a power of two smaller or larger, so nothing is rounded.

    ``x``, ``y`` ``(n,)``: the points in it; ``noise``: their rounding.
    """

    def __init__(self, points: Floats) -> None:
        low, high = points.min(axis=0), points.max(axis=0)
        self.points = points
        self.middle = (low + high) / 2
        self.scale = 2.0 ** math.frexp(float((high - low).max()))[1]
        self.x, self.y = (points - self.middle).T / self.scale
        self.noise = 2.0**-52 * max(1.0, float(np.abs(points).max()) / self.scale)
