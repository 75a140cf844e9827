"""Parts of a drawing that are smaller than a tolerance: an eye, a dot, a splinter. They are named before they go.

``Shape`` and tolerance -> ``Parts``: the shape without them, with them, or with them made larger, and what was done.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import ShapeError
from foldcut.core.model import Shape
from foldcut.drawing.shape import make_shape

__all__ = ["Parts", "SmallPart", "treated"]

ENLARGED = 1.05
"""A part that is made larger becomes this many times as wide as the tolerance."""


@dataclass(frozen=True)
class SmallPart:
    """A loop that is narrower than the tolerance everywhere.

    ``loop``: its number in the shape, from 0; ``hole``: whether it is one; ``place``: its middle.
    """

    loop: int
    hole: bool
    place: tuple[float, float]
    width: float


@dataclass(frozen=True, eq=False)
class Parts:
    """A shape after its small parts were treated, these parts, and the loops of the drawing that are left in it."""

    shape: Shape
    small: tuple[SmallPart, ...]
    kept: tuple[int, ...]


def treated(shape: Shape, tolerance: float, treatment: str) -> Parts:
    """Return a shape whose parts that are narrower than ``tolerance``, in the shape's units, were treated.

    ``treatment``: "drop" leaves them out, with all that is in them, "enlarge" makes them wider than the tolerance where
    there is room, "keep" leaves them alone. One loop is always kept: the widest.
    """
    small = _small_parts(shape, tolerance)
    every = tuple(range(len(shape.loops)))
    if not small or treatment == "keep":
        return Parts(shape, small, every)
    if treatment == "enlarge":
        return Parts(_enlarged(shape, small, tolerance), small, every)
    gone = {part.loop for part in small}
    kept = tuple(loop for loop in every if not _within(shape, loop, gone))
    return Parts(make_shape([shape.loops[loop] for loop in kept]), small, kept)


def width(loop: Floats) -> float:
    """Return how wide a loop is at its widest: the diameter of the largest circle in it."""
    polygon = shapely.Polygon(loop)
    size = float(np.ptp(loop, axis=0).max())
    return 2 * float(shapely.length(shapely.maximum_inscribed_circle(polygon, tolerance=0.01 * size)))


def _small_parts(shape: Shape, tolerance: float) -> tuple[SmallPart, ...]:
    """Return the loops that are narrower than the tolerance; never all of them."""
    widths = [width(loop) for loop in shape.loops]
    widest = int(np.argmax(widths))
    found = []
    for number, (loop, wide) in enumerate(zip(shape.loops, widths, strict=True)):
        if wide < tolerance and number != widest:
            x, y = ((loop.min(axis=0) + loop.max(axis=0)) / 2).tolist()
            found.append(SmallPart(number, shape.depth(number) % 2 == 1, (x, y), wide))
    return tuple(found)


def _within(shape: Shape, loop: int, gone: set[int]) -> bool:
    """Whether a loop or one around it is gone."""
    return loop >= 0 and (loop in gone or _within(shape, shape.parent[loop], gone))


def _enlarged(shape: Shape, small: Sequence[SmallPart], tolerance: float) -> Shape:
    """Return a shape with these parts made larger, each as far as that leaves a valid shape of the same loops."""
    loops = list(shape.loops)
    for part in small:
        middle = np.array(part.place)
        loop = loops[part.loop]
        for share in (1.0, 0.5, 0.25):
            factor = 1 + share * (ENLARGED * tolerance / part.width - 1)
            loops[part.loop] = points_array((loop - middle) * factor + middle)
            try:
                if make_shape(loops).parent == shape.parent:
                    break
            except ShapeError:
                pass
            loops[part.loop] = loop
    return make_shape(loops)
