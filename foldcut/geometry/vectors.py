"""Vectors in the plane: everything works on arrays ``(..., 2)``."""

from __future__ import annotations

import numpy as np

from foldcut.core.arrays import Floats


def cross(a: Floats, b: Floats) -> Floats:
    """Return the z component of the cross product, positive when ``b`` is to the left of ``a``."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def left_normal(vectors: Floats) -> Floats:
    """Return ``vectors`` turned 90 degrees counter-clockwise."""
    return np.stack([-vectors[..., 1], vectors[..., 0]], axis=-1)


def signed_area(polygon: Floats) -> float:
    """Return the area of ``polygon``, ``(n, 2)``, positive when counter-clockwise."""
    return float(cross(polygon, np.roll(polygon, -1, axis=0)).sum() / 2)


def contains_point(polygon: Floats, point: Floats) -> bool:
    """Tell whether ``point`` is inside ``polygon`` by the even-odd rule; the polygon may touch itself."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    spans = (a[:, 1] > point[1]) != (b[:, 1] > point[1])
    a, b = a[spans], b[spans]
    at = a[:, 0] + (point[1] - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
    return bool(np.count_nonzero(at > point[0]) % 2)
