"""Find the curves again of loops that were cut out of flattened outlines.

Polygons and the ``CurvedLoop``s that they were flattened from; a loop that shapely made of the polygons where they
overlap -> its ``CurvedLoop``. Corners that it has from the polygons keep their numbers to the last digit: where several
of them follow each other as in a polygon, the loop is a part of that polygon's curve. What is left are the sides next
to crossings, which stay straight.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.geometry.curves import CurvedLoop, Line, Segment

__all__ = ["CutCurves"]

ON_CURVE = 2e-4
"""How far corners may be from a curve, relative to its size: of arcs of a DXF, Béziers were flattened."""

SAME = 1e-9
"""How far an end of a segment may be from the corner that it is, relative to its size."""

MOST_CORNERS = 50_000
"""With more corners than this, loops stay polygons."""


class CutCurves:
    """Polygons, each ``(n, 2)``, and what they were flattened from; a polygon may have several corners at one place."""

    def __init__(self, polygons: Sequence[Floats], curves: Sequence[CurvedLoop]) -> None:
        both = list(zip(polygons, curves, strict=True))
        if sum(len(polygon) for polygon in polygons) > MOST_CORNERS:
            both = []
        places = [_places(polygon, curve) for polygon, curve in both]
        known = [(*one, at) for one, at in zip(both, places, strict=True) if at is not None]
        self.curves = [curve for _, curve, _ in known]
        self.places = [at for _, _, at in known]
        self.count = [len(polygon) for polygon, _, _ in known]
        corners = np.concatenate([polygon @ (1, 1j) for polygon, _, _ in known]) if known else np.empty(0, complex)
        self.owner = np.repeat(np.arange(len(known)), self.count)
        self.index = np.concatenate([np.arange(count) for count in self.count]) if known else np.empty(0, np.intp)
        order = np.argsort(corners, kind="stable")
        self.corners, self.owner, self.index = corners[order], self.owner[order], self.index[order]

    def curve_of(self, loop: Floats) -> CurvedLoop | None:
        """Return what a loop, ``(n, 2)``, was cut out of; None if all of it is straight."""
        if not len(self.corners):
            return None
        z = loop @ (1, 1j)
        at = np.searchsorted(self.corners, z).clip(max=len(self.corners) - 1)
        found = self.corners[at] == z
        ahead = np.roll(at, -1)
        count = np.array(self.count)[self.owner[at]]
        step = (self.index[ahead] - self.index[at] + 1) % count - 1  # 1, -1, or anything else
        same = found & np.roll(found, -1) & (self.owner[ahead] == self.owner[at]) & (np.abs(step) == 1) & (count > 2)
        keys = [(int(self.owner[k]), int(s)) if ok else None for k, s, ok in zip(at, step, same, strict=True)]
        if not any(keys):
            return None
        start = next((k for k in range(len(keys)) if keys[k] != keys[k - 1]), 0)
        order = [*range(start, len(keys)), *range(start)]
        segments: list[Segment] = []
        for key, group in groupby(order, key=lambda k: keys[k]):
            sides = list(group)
            if key is None:
                segments += [Line(loop[k], loop[(k + 1) % len(loop)]) for k in sides]
            else:
                segments += self._part(key[0], key[1], int(self.index[at[sides[0]]]), len(sides))
        around = zip([segments[-1], *segments[:-1]], segments, [*segments[1:], segments[0]], strict=True)
        curve = CurvedLoop(tuple(_between(*three) for three in around))
        return None if curve.is_straight else curve

    def _part(self, number: int, step: int, first: int, sides: int) -> list[Segment]:
        """Return the segments along so many sides of a polygon, from one of its corners onward or backward."""
        places, curve = self.places[number], self.curves[number]
        turns, last = divmod(first + step * sides, len(places))
        return curve.part(float(places[first]), float(places[last]) + turns * len(curve))


def _between(before: Segment, segment: Segment, after: Segment) -> Segment:
    """Return a segment; if it is a line, from where the curve before ends to where the curve after begins."""
    if not isinstance(segment, Line):
        return segment
    first = segment.first if isinstance(before, Line) else before.end
    return Line(first, segment.last if isinstance(after, Line) else after.start)


def _places(polygon: Floats, curve: CurvedLoop) -> Floats | None:
    """Return the places on a curve, ``(n,)``, of the corners of the polygon that it was flattened to, in order.

    None if they are not found: if a corner is not on the curve, or if an end of a segment is no corner.
    """
    size = float(np.ptp(polygon, axis=0).max())
    places = np.full(len(polygon), np.nan)
    corner = 0
    for number, segment in enumerate(curve.segments):
        ends = np.hypot(*(polygon[corner:] - segment.end).T) <= SAME * size
        following = corner + 1 + int(ends[1:].argmax()) if ends[1:].any() else len(polygon)
        inner = np.arange(corner + 1, following)
        t = np.concatenate([[0.0], (inner - corner) / (following - corner)])
        for _ in range(20):
            move = segment.derivatives(t)
            away = polygon[corner:following] - segment.points(t)
            step = (away * move).sum(axis=1) / np.maximum((move**2).sum(axis=1), 1e-300)
            t = (t + step).clip(0, 1)
            if np.abs(step).max() < 1e-12:
                break
        if np.hypot(*(polygon[corner:following] - segment.points(t)).T).max() > ON_CURVE * size:
            return None
        places[corner:following] = number + t
        corner = following
        if corner == len(polygon):
            break
    return places if number >= len(curve) - 2 and corner == len(polygon) else None
