"""What a molecule consists of: vertices, facets, and the order of the facets from top to bottom."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise

from foldcut.core.arrays import Floats


@dataclass
class Vertices:
    """The growing list of vertices: where they are on the sheet, and where they land, in mm.

    ``cuts``: vertices where an edge is cut off at the sheet's border, with the edge's ends and the border's normal.
    """

    flat: list[tuple[float, float]] = field(default_factory=list)
    folded: list[tuple[float, float]] = field(default_factory=list)
    cuts: list[tuple[int, int, int, tuple[float, float]]] = field(default_factory=list)

    def add(self, flat: Floats, folded: tuple[float, float]) -> int:
        """Add a vertex and return its number."""
        self.flat.append((float(flat[0]), float(flat[1])))
        self.folded.append(folded)
        return len(self.flat) - 1


class SharedVertices:
    """The vertices that one molecule adds: events at one place share a vertex.

    ``tie`` mm: places that differ by no more are equal; ``sign``: +1 when the molecule is above the cut line, else -1.
    Vertices are found by small squares of the sheet.
    """

    def __init__(self, vertices: Vertices, tie: float, sign: int) -> None:
        self._vertices, self._tie, self._sign = vertices, tie, sign
        self._in_square: dict[tuple[int, int], list[int]] = {}

    def at(self, position: Floats, x: float, height: float) -> int:
        """Return the vertex at a place, or a new one there that lands on ``x`` at a height; the latest of several."""
        at_x, at_y = float(position[0]), float(position[1])
        # squares are some ties wide: what is within one tie is in the same or the next
        tie, size, floor = self._tie, 8 * self._tie, math.floor
        column, last_column = floor((at_x - tie) / size), floor((at_x + tie) / size)
        row, last_row = floor((at_y - tie) / size), floor((at_y + tie) / size)
        latest = -1
        for square in (
            ((column, row),)
            if column == last_column and row == last_row
            else [(c, r) for c in range(column, last_column + 1) for r in range(row, last_row + 1)]
        ):
            for number in self._in_square.get(square, ()):
                there = self._vertices.flat[number]
                if abs(there[0] - at_x) <= tie and abs(there[1] - at_y) <= tie:
                    latest = max(latest, number)
        if latest < 0:
            latest = self._vertices.add(position, (float(x), self._sign * height))
            self._in_square.setdefault((floor(at_x / size), floor(at_y / size)), []).append(latest)
        return latest


@dataclass
class Facet:
    """Two chains of vertices that go up from the ends of a stretch of border; the facet is closed when they meet."""

    start: list[int]
    end: list[int]

    def polygon(self) -> list[int]:
        """The outline, counter-clockwise, without slits; empty if nothing is left of the facet."""
        polygon: list[int] = []
        for vertex in (self.start[0], *self.end, *reversed(self.start[1:])):
            if len(polygon) > 1 and polygon[-2] == vertex:
                polygon.pop()
            elif not polygon or polygon[-1] != vertex:
                polygon.append(vertex)
        while len(polygon) > 2 and (
            polygon[0] == polygon[-1] or polygon[1] == polygon[-1] or polygon[0] == polygon[-2]
        ):
            polygon = polygon[1:] if polygon[1] == polygon[-1] else polygon[:-1]
        return polygon if len(polygon) > 2 else []


class LayerList:
    """The facets from top to bottom, as a linked list: which one comes before and which one after each; -1 for none."""

    def __init__(self, count: int) -> None:
        self.after = [*range(1, count), -1]
        self.before = [-1, *range(count - 1)]
        self.first = 0

    def insert_before(self, facet: int, new: list[int]) -> None:
        """Put new facets in front of one."""
        self._chain([self.before[facet], *new, facet])

    def insert_after(self, facet: int, new: list[int]) -> None:
        """Put new facets behind one."""
        self._chain([facet, *new, self.after[facet]])

    def _chain(self, facets: list[int]) -> None:
        more = [-1] * (max(facets) + 1 - len(self.after))
        self.after += more
        self.before += more
        for one, other in pairwise(facets):
            if one < 0:
                self.first = other
            else:
                self.after[one] = other
            if other >= 0:
                self.before[other] = one

    def facets(self) -> list[int]:
        """The facets in order."""
        facets = [self.first]
        while (after := self.after[facets[-1]]) >= 0:
            facets.append(after)
        return facets
