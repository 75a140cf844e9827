"""Join creases that go straight on through vertices into lines.

Points and edges -> the ends of the lines.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence

from foldcut.core.arrays import Floats
from foldcut.geometry.vectors import cross

STRAIGHT = 1e-9
"""Creases go straight on if they turn by less than this, in radians."""


def straight_lines(points: Floats, edges: Sequence[Sequence[int]]) -> list[tuple[int, int]]:
    """Return the ends, as two vertices, of the lines that edges make when those that go straight on are joined.

    ``points`` is ``(v, 2)``; the lines are in the order of their first edges.
    """
    at: dict[int, list[int]] = defaultdict(list)
    for number, edge in enumerate(edges):
        for vertex in edge:
            at[vertex].append(number)

    def other(number: int, vertex: int) -> int:
        """Return the other end of an edge."""
        a, b = edges[number]
        return b if vertex == a else a

    onward: dict[tuple[int, int], int] = {}
    for vertex, mine in at.items():
        for n, one in enumerate(mine):
            for two in mine[n + 1 :]:
                u, v = (points[other(number, vertex)] - points[vertex] for number in (one, two))
                if u @ v < 0 and abs(float(cross(u, v))) < STRAIGHT * math.hypot(*u) * math.hypot(*v):
                    onward[one, vertex], onward[two, vertex] = two, one
    lines = []
    done: set[int] = set()
    for first, (a, b) in enumerate(edges):
        if first in done:
            continue
        ends = []
        for vertex in (a, b):
            number = first
            done.add(number)
            while (number, vertex) in onward:
                number = onward[number, vertex]
                vertex = other(number, vertex)
                done.add(number)
            ends.append(vertex)
        lines.append((ends[0], ends[1]))
    return lines
