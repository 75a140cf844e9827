"""A sheet with a convex outline that is no rectangle: a wedge that the paper was folded into.

``ConvexSheet`` has the outline; ``ConvexBorder`` says what lies on it, and where lines leave it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from foldcut.core.arrays import Floats, points_array
from foldcut.core.model import Sheet

Point = tuple[float, float]
"""A place on the sheet, in mm."""


@dataclass(frozen=True)
class ConvexSheet(Sheet):
    """A convex sheet. ``width`` and ``height`` are those of the rectangle around it, whose lower left corner is (0, 0).

    ``outline``: the corners in mm, counter-clockwise; three of them or more, no two in one place.
    """

    outline: tuple[Point, ...] = ()

    @classmethod
    def of(cls, outline: Floats) -> ConvexSheet:
        """Return the sheet with an outline, ``(n, 2)`` mm, none of whose coordinates is below 0."""
        width, height = outline.max(axis=0).tolist()
        return cls(width, height, outline=tuple((x, y) for x, y in outline.tolist()))

    @property
    def corners(self) -> Floats:
        """The corners, ``(n, 2)``, counter-clockwise."""
        return points_array(self.outline)


class ConvexBorder:
    """The border of a convex sheet, with what is nearer to it than ``snap`` mm on it."""

    def __init__(self, sheet: ConvexSheet, snap: float) -> None:
        self._snap = snap
        self._lines: list[tuple[float, float, float]] = []  # the unit normal inwards, and where the line is along it
        for (x, y), (to_x, to_y) in zip(sheet.outline, (*sheet.outline[1:], sheet.outline[0]), strict=True):
            length = math.hypot(to_x - x, to_y - y)
            inward_x, inward_y = (y - to_y) / length, (to_x - x) / length
            self._lines.append((inward_x, inward_y, inward_x * x + inward_y * y))

    def has_inside(self, point: Point) -> bool:
        """Return whether a point is strictly on the sheet, off its border."""
        x, y = point
        return all(inward_x * x + inward_y * y - at > self._snap for inward_x, inward_y, at in self._lines)

    def part_inside(self, start: Point, end: Point) -> tuple[float, float] | None:
        """Return from which to which part, 0 to 1, a segment is on the sheet, None where none of it is.

        A segment along the border is not on the sheet.
        """
        low, high = 0.0, 1.0
        for inward_x, inward_y, at in self._lines:
            here = inward_x * start[0] + inward_y * start[1] - at
            there = inward_x * end[0] + inward_y * end[1] - at
            if abs(there - here) <= self._snap:
                if here <= self._snap:
                    return None
                continue
            part = here / (here - there)
            low, high = (max(low, part), high) if there > here else (low, min(high, part))
        return None if (high - low) * math.dist(start, end) <= self._snap else (low, high)

    def exit_of(self, here: Point, there: Point) -> Point | None:
        """Return where the segment from a point on the sheet leaves it, None if it does not."""
        if self.has_inside(there):
            return None
        step = there[0] - here[0], there[1] - here[1]
        least, line = math.inf, self._lines[0]
        for inward_x, inward_y, at in self._lines:
            nearer = -(inward_x * step[0] + inward_y * step[1])
            part = (inward_x * here[0] + inward_y * here[1] - at) / nearer if nearer > 0 else math.inf
            if part < least:
                least, line = part, (inward_x, inward_y, at)
        part = min(1.0, least)
        x, y = here[0] + part * step[0], here[1] + part * step[1]
        off = line[0] * x + line[1] * y - line[2]
        return x - off * line[0], y - off * line[1]
