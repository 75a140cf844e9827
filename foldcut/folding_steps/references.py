"""Where a fold goes without a printed line: corners and edges that come to lie on each other, or places to measure.

``FoldedPattern``, the sheet before a step, and the step -> a sentence. The sheet's corners are called A, B, C and D,
counter-clockwise from the lower left of the printed side.
"""

from __future__ import annotations

import numpy as np

from foldcut.core.arrays import Floats, Indices
from foldcut.core.model import FoldedPattern, FoldedState
from foldcut.folding_steps.steps import FoldingStep
from foldcut.geometry.vectors import cross

__all__ = ["CORNERS", "corner_vertices", "reference"]

CORNERS = "ABCD"
"""The names of the sheet's corners, counter-clockwise from the lower left of the printed side."""

EXACT = 1e-6
"""Places that are this near each other, relative to the sheet's diagonal, are one."""

LONG = 0.1
"""An edge lies along another if this much of it does, as a fraction of the sheet's diagonal."""


def reference(pattern: FoldedPattern, before: FoldedState, step: FoldingStep) -> str:
    """Return how to find the line of a fold: by folding where that is exact, or else with a ruler on the flat sheet.

    Corners that come to lie on corners, and an edge that comes to lie along another, say exactly where the line is.
    """
    assert step.line is not None
    assert step.moved is not None
    paper = _Paper(pattern, before, step)
    corners = paper.corners_on_corners()
    if corners:
        (one, other), *rest = corners
        return " and ".join([f"{one} comes to lie on {other}", *(f"{a} on {b}" for a, b in rest)]) + "."
    edges = paper.edges_along_edges()
    if edges:
        return f"Edge {edges[0][0]} comes to lie along edge {edges[0][1]}."
    return "The line goes from {}, to {}.".format(*(paper.place(end) for end in step.line))


def corner_vertices(pattern: FoldedPattern) -> list[int]:
    """Return the vertices at the sheet's corners, in the order of ``CORNERS``."""
    flat = pattern.creases.vertices_coords
    return [int(np.hypot(*(flat - corner).T).argmin()) for corner in pattern.sheet.corners]


class _Paper:
    """The sheet before and after a fold."""

    def __init__(self, pattern: FoldedPattern, before: FoldedState, step: FoldingStep) -> None:
        self.sheet, self.flat = pattern.sheet, pattern.creases.vertices_coords
        self.tie = EXACT * pattern.sheet.diagonal
        self.before, self.after = before.vertices_coords, step.state.vertices_coords
        self.moved = np.hypot(*(self.after - self.before).T) > self.tie
        self.on_line = np.unique(pattern.creases.edges_vertices[step.edges])
        self.corners = corner_vertices(pattern)

    def corners_on_corners(self) -> list[tuple[str, str]]:
        """Return the names of corners that move, and of those that they come to lie on; "AD" for A and D together."""
        places: dict[str, int] = {}
        for name, vertex in zip(CORNERS, self.corners, strict=True):
            same = [there for there, other in places.items() if self._near(self.before[vertex], self.before[other])]
            places[(same[0] if same else "") + name] = places.pop(same[0]) if same else vertex
        return [
            (one, other)
            for one, here in places.items()
            for other, there in places.items()
            if self.moved[here] and not self.moved[there] and self._near(self.after[here], self.before[there])
        ]

    def edges_along_edges(self) -> list[tuple[str, str]]:
        """Return the names of edges that move, and of the other edges that they come to lie along."""
        sides = [(CORNERS[k] + CORNERS[(k + 1) % 4], self._side(k)) for k in range(4)]
        found = []
        for one, some in sides:
            moves = self.after[some[self.moved[some]]]
            for other, others in sides:
                stays = self.before[others[~self.moved[others]]]
                if one != other and self._is_long(moves) and self._is_long(stays) and self._on_one_line(moves, stays):
                    found.append((one, other))
        return found

    def place(self, end: Floats) -> str:
        """Return in words where an end of the line is on the flat sheet."""
        here = self.on_line[np.hypot(*(self.before[self.on_line] - end).T) < self.tie]
        for vertex in here.tolist():
            if vertex in self.corners:
                return f"corner {CORNERS[self.corners.index(vertex)]}"
        for k in range(4):
            on_side = np.intersect1d(here, self._side(k))
            if len(on_side):
                ends = self.sheet.corners[[k, (k + 1) % 4]]
                away = np.hypot(*(ends - self.flat[on_side[0]]).T)
                near = int(away.argmin())
                return f"edge {CORNERS[k]}{CORNERS[(k + 1) % 4]}, {away[near]:.1f} mm from {CORNERS[(k + near) % 4]}"
        x, y = self.flat[here[0]].tolist()
        return f"the point {x:.1f} mm from edge DA and {y:.1f} mm from edge AB"

    def _near(self, one: Floats, other: Floats) -> bool:
        return bool(np.hypot(*(one - other)) < self.tie)

    def _side(self, number: int) -> Indices:
        """Return the vertices on a side of the sheet."""
        start, end = self.sheet.corners[[number, (number + 1) % 4]]
        off = np.abs(cross(end - start, self.flat - start)) / np.hypot(*(end - start))
        return np.flatnonzero(off < self.tie)

    def _is_long(self, points: Floats) -> bool:
        return len(points) > 1 and float(np.hypot(*np.ptp(points, axis=0))) > LONG * self.sheet.diagonal

    def _on_one_line(self, some: Floats, others: Floats) -> bool:
        far = int(np.hypot(*(others - others[0]).T).argmax())
        along = (others[far] - others[0]) / np.hypot(*(others[far] - others[0]))
        off = np.abs(cross(along, np.concatenate([some, others]) - others[0]))
        return bool((off < self.tie).all())
