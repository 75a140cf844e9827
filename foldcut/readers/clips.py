"""Cut outlines off where a clip path ends (SVG 2, CSS Masking 1, section 5).

An outline and the elements of its clip paths -> what of the outline can be seen. An outline that lies within all of
them keeps its numbers to the last digit.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely

from foldcut.core.arrays import Floats, points_array
from foldcut.drawing.shape import polygon_loops
from foldcut.readers.fill_outlines import fill
from foldcut.readers.join_outlines import Outline
from foldcut.readers.svg_page import Clip, Element


class Clips:
    """Clips outlines, and counts what became of them.

    ``cut``: those that were cut off. ``gone``: those that are outside altogether. ``whole``: strokes that would have to
    be cut off, and were left as they are.
    """

    def __init__(self, flip: Floats, tolerance: float) -> None:
        self.flip, self.tolerance = flip, tolerance
        self.areas: dict[int, tuple[Clip, shapely.Geometry]] = {}
        self.cut = self.gone = self.whole = 0

    def seen(self, outline: Outline, element: Element) -> Outline | None:
        """Return what can be seen of the outline of an element; None if nothing."""
        points = np.concatenate([line for line, _ in outline.lines]) if outline.lines else np.empty((0, 2))
        if not element.clips or not len(points) or not np.isfinite(points).all():
            return outline
        area = shapely.intersection_all([self._area(clip) for clip in element.clips])
        if shapely.covers(area, shapely.box(*points.min(axis=0), *points.max(axis=0))):
            return outline
        if not outline.filled:
            lines = shapely.multilinestrings([line for line, _ in outline.lines if len(line) > 1])
            if shapely.intersects(area, lines):
                self.whole += not shapely.covers(area, lines)
                return outline
            self.gone += 1
            return None
        seen = shapely.intersection(_filled(outline), area)
        if shapely.area(seen) <= 1e-9 * shapely.area(shapely.box(*points.min(axis=0), *points.max(axis=0))):
            self.gone += 1
            return None
        if shapely.covers(area, _filled(outline)):
            return outline
        self.cut += 1
        parts = (part for part in shapely.get_parts(seen) if isinstance(part, shapely.Polygon) and part.area)
        return replace(outline, lines=[(loop, True) for loop in polygon_loops(parts)], even_odd=True, curves=())

    def notes(self) -> tuple[str, ...]:
        """Return what is told."""
        cut = f"{self.cut} outline{'s' * (self.cut > 1)} cut off by clip paths" if self.cut else ""
        gone = f"{self.gone} outline{'s' * (self.gone > 1)} outside clip paths left out" if self.gone else ""
        return tuple(filter(None, (cut, gone)))

    def _area(self, clip: Clip) -> shapely.Geometry:
        """Return the area of a clip path in the coordinates of the outlines."""
        if id(clip) not in self.areas:
            parts = []
            for element in clip:
                lines = [points_array((self.flip @ points).T) for points, _, _ in element.lines(self.tolerance)]
                lines = [line for line in lines if len(line) > 2 and np.isfinite(line).all()]
                parts.append(_filled(Outline([(line, True) for line in lines], True, element.even_odd)))
            self.areas[id(clip)] = clip, shapely.union_all(parts)
        return self.areas[id(clip)][1]


def _filled(outline: Outline) -> shapely.Geometry:
    """Return the area that an outline fills."""
    loops = fill([line for line, _ in outline.lines if len(line) > 2], even_odd=outline.even_odd)
    areas = [shapely.make_valid(shapely.Polygon(loop)) for loop in loops]
    area = shapely.Polygon()
    for one in areas:
        area = shapely.symmetric_difference(area, one)
    return area
