"""The sheet divided by ridges and perpendiculars into facets, and folded.

``Perpendiculars``, and which of them to fold -> ``Facets``.

Each facet lies in one skeleton face. Folded, a point of it is at height z, its distance from the face's side, and at x,
its distance along that side plus the facet's shift, with x running one way or the other. Neighbours agree on the crease
between them, so the first facet's place gives all others.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import shapely

from foldcut.core.arrays import Floats, index_array
from foldcut.core.errors import UnfoldableError
from foldcut.geometry.planar_graph import trace_faces
from foldcut.geometry.vectors import left_normal
from foldcut.methods.skeleton.perpendiculars import Perpendiculars, Ridges
from foldcut.methods.skeleton.skeleton_faces import Edge, Vertices, half_edges

Crease = tuple[Edge, tuple[int, int]]
"""An edge between two facets, its lesser vertex first, and the facets on its left and on its right."""

MOST_CREASES = 1000
"""Divisions of the sheet with more creases are refused: their layers take too long to order."""

FITS = 1e3
"""Places of one folded vertex, as its facets have them, differ by no more than this many times the snap distance."""


@dataclass(frozen=True, eq=False)
class Facets:
    """The sheet divided by creases, and where each part of it comes to lie.

    ``flat`` and ``folded`` ``(v, 2)`` mm; ``facets`` their vertices, counter-clockwise on the sheet; ``creases``;
    ``up`` whether a facet shows its upper side; ``sheet_corners`` the vertices that are the sheet's corners.
    """

    flat: Floats
    folded: Floats
    facets: list[Vertices]
    creases: list[Crease]
    up: list[bool]
    sheet_corners: set[int]


def divide_sheet(perpendiculars: Perpendiculars, taken: Sequence[int], *, most_creases: float = MOST_CREASES) -> Facets:
    """Divide the sheet by the ridges and by some perpendiculars, by number, and fold it.

    Raises ``UnfoldableError`` where facets do not meet when they are folded, and where there are too many creases.
    """
    division = Division(perpendiculars, taken)
    points = np.array(division.points)
    facets, creases = division.planar()
    placed = _placed(perpendiculars.ridges, points, facets)
    folded, up = _folded(points, facets, creases, placed, FITS * perpendiculars.ridges.snap)
    if len(creases) > most_creases:
        raise UnfoldableError(f"the pattern has {len(creases):,} creases; this method takes at most {most_creases:,}")
    return Facets(points, folded, facets, creases, up, set(division.corners))


class Division:
    """The sheet as a planar graph: its border, the ridges on it, and some perpendiculars.

    ``points`` begin with the skeleton's; ``path_of`` tells for an edge, its lesser vertex first, which perpendicular it
    is a piece of; ``corners`` are the vertices that are the sheet's corners.
    """

    def __init__(self, perpendiculars: Perpendiculars, taken: Iterable[int]) -> None:
        self._perpendiculars = perpendiculars
        self._ridges = perpendiculars.ridges
        self.points = [*self._ridges.skeleton.points]
        self.path_of: dict[Edge, int] = {}
        self.corners = [self._add(corner) for corner in self._ridges.sheet.corners]
        self._edges: list[Edge] = []
        self._border = list(self.corners)
        self._on_ridge: dict[Edge, list[int]] = defaultdict(list)
        for number in taken:
            self._draw_perpendicular(number)
        for ridge in self._ridges.edges:
            self._draw_ridge(ridge)
        self._draw_border()

    def planar(self) -> tuple[list[Vertices], list[Crease]]:
        """Return the vertices of every facet, and the creases."""
        used, edges = np.unique(np.array(self._edges), return_inverse=True)
        traced = trace_faces(np.array(self.points)[used], index_array(edges.reshape(-1, 2))).to_lists()
        facets = [used[facet].tolist() for facet in traced]
        beside = {pair: k for k, facet in enumerate(facets) for pair in half_edges(facet)}
        return facets, [((a, b), (k, beside[b, a])) for (a, b), k in beside.items() if a < b and (b, a) in beside]

    def _add(self, point: Floats) -> int:
        self.points.append(point)
        return len(self.points) - 1

    def _add_on_border(self, point: Floats) -> int:
        for vertex in self._border:
            if np.hypot(*(self.points[vertex] - point)) <= self._ridges.snap:
                return vertex
        self._border.append(self._add(point))
        return self._border[-1]

    def _draw_perpendicular(self, number: int) -> None:
        path = self._perpendiculars.paths[number]
        vertex = path.start
        for k, piece in enumerate(path.pieces):
            if k == len(path.pieces) - 1:
                following = path.end if path.end >= 0 else self._add_on_border(piece.end)
            elif piece.edge is None or self._ridges.skeleton.is_side(piece.edge):
                continue  # it goes straight on across a side, which is no crease
            else:
                following = self._add(piece.end)
                self._on_ridge[min(piece.edge, piece.edge[::-1])].append(following)
            self._edges.append((vertex, following))
            self.path_of[min(vertex, following), max(vertex, following)] = number
            vertex = following

    def _draw_ridge(self, ridge: Edge) -> None:
        """Draw what lies of a ridge on the sheet, divided where perpendiculars cross it."""
        a, b = ridge
        start, step = self.points[a], self.points[b] - self.points[a]
        low, high = 0.0, 1.0
        size, snap = self._ridges.size, self._ridges.snap
        for axis in (0, 1):
            if abs(step[axis]) <= snap:
                if not snap < start[axis] < size[axis] - snap:
                    return
                continue
            parts = sorted([-start[axis] / step[axis], (size[axis] - start[axis]) / step[axis]])
            low, high = max(low, parts[0]), min(high, parts[1])
        if (high - low) * np.hypot(*step) <= snap:
            return
        first, last = self._ridge_end(a, low, start + low * step), self._ridge_end(b, 1.0 - high, start + high * step)
        between = sorted(self._on_ridge[ridge], key=lambda v: float((self.points[v] - start) @ step))
        self._edges += pairwise([first, *between, last])

    def _ridge_end(self, vertex: int, cut_off: float, place: Floats) -> int:
        """Return the vertex at the end of what lies of a ridge on the sheet; nodes may lie on the border, too."""
        whole = cut_off == 0.0 and self._ridges.on_sheet(self.points[vertex])
        return vertex if whole else self._add_on_border(place)

    def _draw_border(self) -> None:
        middle = self._ridges.size / 2
        away = np.array([self.points[v] for v in self._border]) / middle - 1
        order = np.argsort(_around_square(away))
        self._edges += half_edges([self._border[k] for k in order.tolist()])


class _Placed(NamedTuple):
    """Where a facet lies: the first corner and the unit direction of its side, and 1.0 if the shape is on its left."""

    start: Floats
    along: Floats
    left: float


def _placed(ridges: Ridges, points: Floats, facets: Sequence[Vertices]) -> list[_Placed]:
    full = shapely.polygons([shapely.linearrings(points[facet]) for facet in facets])
    skeleton, found = ridges.skeleton, []
    for number in ridges.faces_at(shapely.point_on_surface(full)):
        side = skeleton.faces[number].side
        found.append(_Placed(skeleton.starts[side], skeleton.along[side], ridges.shape_at_left[number]))
    return found


def _folded(
    points: Floats, facets: list[Vertices], creases: list[Crease], placed: list[_Placed], most: float
) -> tuple[Floats, list[bool]]:
    """Return the vertices' folded places ``(v, 2)``, and whether each facet shows its upper side.

    ``most``: by how many mm a vertex may be off between two of its facets.
    """
    beside: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for (a, _), (one, two) in creases:
        beside[one].append((two, a))
        beside[two].append((one, a))
    folded = np.full((len(points), 2), np.nan)
    turns: dict[int, tuple[float, float]] = {0: (1.0, 0.0)}  # which way x runs, and the shift
    queue = deque([0])
    worst = 0.0
    while queue:
        facet = queue.popleft()
        turn, shift = turns[facet]
        start, along, left = placed[facet]
        away = points[facets[facet]] - start
        z = left * (away @ left_normal(along))
        place = np.column_stack([turn * (away @ along) + shift, z])
        old = folded[facets[facet]]
        known = ~np.isnan(old[:, 0])
        worst = max(worst, float(np.abs(old[known] - place[known]).max(initial=0.0)))
        folded[facets[facet]] = np.where(known[:, None], old, place)
        for other, vertex in beside[facet]:
            if other not in turns:
                turned = -turn * left * placed[other].left
                u = float((points[vertex] - placed[other].start) @ placed[other].along)
                turns[other] = turned, float(folded[vertex, 0]) - turned * u
                queue.append(other)
    if len(turns) < len(facets) or worst > most:
        raise UnfoldableError("the facets do not meet when they are folded")
    folded[:, 0] -= np.nanmin(folded[:, 0])
    folded[np.isnan(folded)] = 0.0  # vertices that are not on the sheet
    return folded, [turns[k][0] * placed[k].left > 0 for k in range(len(facets))]


def _around_square(away: Floats) -> Floats:
    """Return numbers that grow counter-clockwise along the border of the square with half side 1."""
    x, y = away.T
    flat = np.abs(y) >= np.abs(x)
    quarter: Floats = np.where(flat & (y < 0), x, np.where(~flat & (x > 0), 2 + y, np.where(flat, 4 - x, 6 - y)))
    return quarter
