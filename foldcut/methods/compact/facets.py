"""What a molecule is made of: vertices, facets and their order."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

from foldcut.core.arrays import Floats


@dataclass
class Vertices:
    """The growing list of vertices: where they are on the sheet, and where they land.

    ``cuts``: vertices where an edge is cut off at the sheet's border, with the edge's ends and the border's axis.
    """

    flat: list[tuple[float, float]] = field(default_factory=list)
    folded: list[tuple[float, float]] = field(default_factory=list)
    cuts: list[tuple[int, int, int, int]] = field(default_factory=list)

    def add(self, flat: Floats, folded: tuple[float, float]) -> int:
        """Add a vertex and return its number."""
        self.flat.append((float(flat[0]), float(flat[1])))
        self.folded.append(folded)
        return len(self.flat) - 1


@dataclass
class _Facet:
    """Two chains of vertices going up from the ends of a stretch of the border; closed when they meet."""

    start: list[int]
    end: list[int]

    def ring(self) -> list[int]:
        """The outline, counter-clockwise, without slits; empty if nothing is left of the facet."""
        ring: list[int] = []
        for vertex in (self.start[0], *self.end, *reversed(self.start[1:])):
            if len(ring) > 1 and ring[-2] == vertex:
                ring.pop()
            elif not ring or ring[-1] != vertex:
                ring.append(vertex)
        while len(ring) > 2 and (ring[0] == ring[-1] or ring[1] == ring[-1] or ring[0] == ring[-2]):
            ring = ring[1:] if ring[1] == ring[-1] else ring[:-1]
        return ring if len(ring) > 2 else []


class _Order:
    """The order of the facets: who comes after whom."""

    def __init__(self, count: int) -> None:
        self.after = [*range(1, count), -1]
        self.before = [-1, *range(count - 1)]
        self.first = 0

    def insert(self, new: list[int], before: int, after: int) -> None:
        """Put new facets between two that follow each other, or at an end, which is -1."""
        more = [-1] * (max(new) + 1 - len(self.after))
        self.after += more
        self.before += more
        chain = [before, *new, after]
        for one, other in pairwise(chain):
            if one < 0:
                self.first = other
            else:
                self.after[one] = other
            if other >= 0:
                self.before[other] = one

    def list(self) -> list[int]:
        """The facets in order."""
        facets = [self.first]
        while (after := self.after[facets[-1]]) >= 0:
            facets.append(after)
        return facets
