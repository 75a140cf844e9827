"""Tell whether an outline is within a tolerance of a drawing, on samples: fast, for sifting outlines.

The exact check is ``foldcut.geometry.curves.farthest_apart``; here both are sampled, so the answer is right to a few
hundredths of a millimetre.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
import shapely

from foldcut.core.arrays import Floats, points_array
from foldcut.core.model import Shape
from foldcut.geometry.vectors import signed_area
from foldcut.redraw.starts.chains import Axis

__all__ = ["Near"]

STEP = 1.0
"""The distance between samples, in mm of the frame."""


STRAIGHT = 1e-4
"""A corner that is nearer than this to the line between its neighbours, in mm, is none."""


class Near:
    """Loops ``(n, 2)``, dense, in mm of the frame, and how they are nested: what outlines must be near to."""

    def __init__(self, drawn: Shape) -> None:
        self.drawn = drawn
        self._lines = [shapely.linearrings(loop) for loop in drawn.loops]
        for line in self._lines:
            shapely.prepare(line)
        self._samples = [shapely.points(sampled(loop, STEP)) for loop in drawn.loops]

    def distance(self, loops: Sequence[Floats], enough: float = float("inf")) -> float:
        """Return how far loops are from the drawn ones, pair by pair, the larger of both ways, in mm.

        The answer is only a lower bound where it is more than ``enough``.
        """
        worst = 0.0
        for loop, line, samples in zip(loops, self._lines, self._samples, strict=True):
            ring = shapely.linearrings(loop)
            shapely.prepare(ring)
            worst = max(worst, float(shapely.distance(samples, ring).max()))
            if worst > enough:
                return worst
            worst = max(worst, float(shapely.distance(shapely.points(sampled(loop, STEP)), line).max()))
            if worst > enough:
                return worst
        return worst

    def asymmetry(self, axes: Iterable[Axis]) -> float:
        """Return how far mirror images of the drawing's points are from it, at most, in mm."""
        whole = shapely.multilinestrings(self._lines)
        shapely.prepare(whole)
        points = np.concatenate([sampled(loop, 2 * STEP) for loop in self.drawn.loops])
        off = [float(shapely.distance(shapely.points(axis.mirrored(points)), whole).max()) for axis in axes]
        return max(off, default=0.0)

    def shape(self, loops: Sequence[Floats], tolerance: float) -> Shape | None:
        """Return the shape of ``loops``, one for each drawn one, if it is near enough, else None.

        Loops may not cross or touch, and must be nested as the drawn ones are.
        """
        turned = []
        for drawn in loops:
            loop = without_straight_corners(drawn)
            if len(loop) < 3 or not np.isfinite(loop).all():
                return None
            turned.append(points_array(loop if signed_area(loop) > 0 else loop[::-1]))
        rings = [shapely.linearrings(loop) for loop in turned]
        if not shapely.is_simple(shapely.multilinestrings([shapely.linestrings([*r, r[0]]) for r in turned])):
            return None
        if self.distance(turned, tolerance) > tolerance:
            return None
        polygons = shapely.polygons(rings)
        for k, parent in enumerate(self.drawn.parent):
            if parent >= 0 and not shapely.contains_xy(polygons[parent], *turned[k][0]):
                return None
            if parent < 0 and any(
                shapely.contains_xy(polygons[m], *turned[k][0]) for m in range(len(turned)) if m != k
            ):
                return None
        return Shape(tuple(turned), self.drawn.parent)


def without_straight_corners(loop: Floats) -> Floats:
    """Return a closed loop without corners that are within ``STRAIGHT`` of the line between those beside them."""
    while len(loop) > 3:
        before, after = loop - np.roll(loop, 1, axis=0), np.roll(loop, -1, axis=0) - loop
        chord = before + after
        length = np.maximum(np.hypot(*chord.T), 1e-12)
        height = np.abs(before[:, 0] * chord[:, 1] - before[:, 1] * chord[:, 0]) / length
        worst = int(height.argmin())
        if height[worst] > STRAIGHT:
            break
        loop = np.delete(loop, worst, axis=0)
    return loop


def sampled(loop: Floats, step: float) -> Floats:
    """Return a closed loop's points and more between them, none farther apart than ``step``."""
    after = np.roll(loop, -1, axis=0)
    counts = np.maximum(1, np.ceil(np.hypot(*(after - loop).T) / step)).astype(int)
    first = np.repeat(np.cumsum(counts) - counts, counts)
    part = (np.arange(counts.sum()) - first) / np.repeat(counts, counts)
    points: Floats = np.repeat(loop, counts, axis=0) + part[:, None] * np.repeat(after - loop, counts, axis=0)
    return points
