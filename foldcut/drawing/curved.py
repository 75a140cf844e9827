"""Which curves the loops of a shape were flattened from.

A reader's loops and their curves, and the shape that came of the loops after mending -> a ``CurvedLoop`` for each loop
of the shape. A loop that was changed on the way, by more than rounding, is the polygon that it is now.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from foldcut.core.arrays import Floats
from foldcut.core.model import Shape
from foldcut.geometry.curves import CurvedLoop
from foldcut.geometry.vectors import signed_area

__all__ = ["curves_of", "similarity"]

SAME = 1e-6
"""How far corners may be from those that were drawn, relative to the size of the drawing."""

SAME_AREA = 1e-9
"""By how much the area of a loop may differ from that of the drawn one, relative to the square of that size."""

_MIRROR = np.array([(-1.0, 0.0, 0.0), (0.0, 1.0, 0.0)])


def curves_of(
    shape: Shape, drawn: Sequence[Floats], curves: Sequence[CurvedLoop], *, mirrored: bool = False
) -> tuple[CurvedLoop, ...]:
    """Return the curved loops of ``shape``, in its order, all counter-clockwise, in its coordinates.

    ``drawn`` are the loops that were read and ``curves`` what they were flattened from, in the same order (or nothing).
    ``mirrored``: the shape has been mirrored, left to right.
    """
    if not curves:
        return tuple(CurvedLoop.of_points(loop) for loop in shape.loops)
    if mirrored:
        drawn = [loop * (-1.0, 1.0) for loop in drawn]
        curves = [curve.transformed(_MIRROR) for curve in curves]
    size = float(np.ptp(np.concatenate(shape.loops), axis=0).max())
    boxes = np.array([_box(loop) if len(loop) else np.full(4, np.nan) for loop in drawn])
    found = []
    for loop in shape.loops:
        same = np.flatnonzero((np.abs(boxes - _box(loop)) <= SAME * size).all(axis=1)).tolist()
        number = next((one for one in same if _is_same(loop, drawn[one], size)), None)
        if number is None:
            found.append(CurvedLoop.of_points(loop))
        else:
            found.append(curves[number] if signed_area(drawn[number]) > 0 else curves[number].reversed())
    return tuple(found)


def similarity(drawn: Floats, placed: Floats) -> Floats:
    """Return the similarity, ``(2, 3)``, without mirroring, that takes points to ``placed``, both ``(n, 2)``."""
    middle, to = drawn.mean(axis=0), placed.mean(axis=0)
    z, w = (drawn - middle) @ (1, 1j), (placed - to) @ (1, 1j)
    factor = complex((z.conj() * w).sum() / (z.conj() * z).sum())
    linear = np.array([(factor.real, -factor.imag), (factor.imag, factor.real)])
    return np.column_stack([linear, to - linear @ middle])


def _box(loop: Floats) -> Floats:
    return np.concatenate([loop.min(axis=0), loop.max(axis=0)])


def _is_same(loop: Floats, drawn: Floats, size: float) -> bool:
    """Whether a loop is a drawn one, perhaps without collinear corners and the other way around."""
    near = shapely.STRtree(shapely.points(drawn)).query(shapely.points(loop), predicate="dwithin", distance=SAME * size)
    if len(np.unique(near[0])) < len(loop):
        return False
    middle = loop.mean(axis=0)
    return abs(abs(signed_area(loop - middle)) - abs(signed_area(drawn - middle))) <= SAME_AREA * size**2
