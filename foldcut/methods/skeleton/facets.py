"""The sheet divided by ridges and perpendiculars into facets, and folded.

``Perpendiculars``, and which of them to fold -> ``Facets``.

Each facet lies in one skeleton face. Folded, a point of it is at height z, its distance from the face's side, and at x,
its distance along that side plus the facet's shift, with x running one way or the other. Neighbours agree on the crease
between them, so the first facet's place gives all others.
"""

from __future__ import annotations

import math
from collections import defaultdict, deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import shapely

from foldcut.core.arrays import Floats, index_array
from foldcut.core.errors import UnfoldableError
from foldcut.geometry.convex_sheet import ConvexSheet
from foldcut.geometry.planar_graph import trace_faces
from foldcut.methods.skeleton.perpendiculars import Perpendiculars, Point, Ridges
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

    @property
    def shortest(self) -> float:
        """The length of the shortest crease, in mm."""
        ends = self.flat[np.array([edge for edge, _ in self.creases])]
        return float(np.hypot(*(ends[:, 1] - ends[:, 0]).T).min())


def divide_sheet(perpendiculars: Perpendiculars, taken: Sequence[int], *, most_creases: float = MOST_CREASES) -> Facets:
    """Divide the sheet by the ridges and by some perpendiculars, by number, and fold it.

    Raises ``UnfoldableError`` where facets do not meet when they are folded, and where there are too many creases.
    """
    division = Division(perpendiculars, taken)
    facets, creases = division.planar()
    placed = _placed(perpendiculars.ridges, [division.face_of(facet) for facet in facets])
    folded, up = _folded(division.points, facets, creases, placed, FITS * perpendiculars.ridges.snap)
    if len(creases) > most_creases:
        raise UnfoldableError(f"the pattern has {len(creases):,} creases; this method takes at most {most_creases:,}")
    return Facets(np.array(division.points), folded, facets, creases, up, set(division.corners))


class Division:
    """The sheet as a planar graph: its border, the ridges on it, and some perpendiculars.

    ``points`` begin with the skeleton's; ``path_of`` tells for an edge, its lesser vertex first, which perpendicular it
    is a piece of; ``corners`` are the vertices that are the sheet's corners.
    """

    def __init__(self, perpendiculars: Perpendiculars, taken: Iterable[int]) -> None:
        self._perpendiculars = perpendiculars
        self._ridges = perpendiculars.ridges
        self.points = [*self._ridges.places]
        self.path_of: dict[Edge, int] = {}
        self.corners = [self._add((x, y)) for x, y in self._ridges.sheet.corners.tolist()]
        self._edges: list[Edge] = []
        self._face_of: dict[Edge, int] = {}  # the skeleton face on the left
        self._border = list(self.corners)
        self._on_ridge: dict[Edge, list[int]] = defaultdict(list)
        for number in taken:
            self._draw_perpendicular(number)
        for ridge in self._ridges.edges:
            self._draw_ridge(ridge)
        self._draw_border()

    def face_of(self, facet: Vertices) -> int:
        """Return a skeleton face in which a part of a facet lies; beyond a side it may go on in another."""
        for pair in half_edges(facet):
            if pair in self._face_of:
                return self._face_of[pair]
        # nothing divides the sheet: half of one may need no crease but the axis
        middle, skeleton = shapely.Point(self._ridges.sheet.corners.mean(axis=0)), self._ridges.skeleton
        faces = shapely.polygons([shapely.linearrings(skeleton.points[face.vertices]) for face in skeleton.faces])
        return int(shapely.distance(faces, middle).argmin())

    def planar(self) -> tuple[list[Vertices], list[Crease]]:
        """Return the vertices of every facet, and the creases."""
        used, edges = np.unique(np.array(self._edges), return_inverse=True)
        traced = trace_faces(np.array(self.points)[used], index_array(edges.reshape(-1, 2))).to_lists()
        facets = [used[facet].tolist() for facet in traced]
        beside = {pair: k for k, facet in enumerate(facets) for pair in half_edges(facet)}
        return facets, [((a, b), (k, beside[b, a])) for (a, b), k in beside.items() if a < b and (b, a) in beside]

    def _add(self, point: Point) -> int:
        self.points.append(point)
        return len(self.points) - 1

    def _add_on_border(self, point: Point) -> int:
        for vertex in self._border:
            if math.dist(self.points[vertex], point) <= self._ridges.snap:
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
            self._face_of[vertex, following] = self._face_of[following, vertex] = piece.face
            self.path_of[min(vertex, following), max(vertex, following)] = number
            vertex = following

    def _draw_ridge(self, ridge: Edge) -> None:
        """Draw what lies of a ridge on the sheet, divided where perpendiculars cross it."""
        a, b = ridge
        start, end = self.points[a], self.points[b]
        step = end[0] - start[0], end[1] - start[1]
        part = self._ridges.on_sheet_part(a, b)
        if part is None:
            return
        low, high = part

        def end_at(vertex: int, part: float, *, whole: bool) -> int:
            if whole and self._ridges.on_sheet(self.points[vertex]):
                return vertex
            return self._add_on_border((start[0] + part * step[0], start[1] + part * step[1]))

        def along(vertex: int) -> float:
            x, y = self.points[vertex]
            return (x - start[0]) * step[0] + (y - start[1]) * step[1]

        first, last = end_at(a, low, whole=low == 0.0), end_at(b, high, whole=high == 1.0)
        left, right = self._ridges.face_of((a, b)), self._ridges.face_of((b, a))
        for one, other in pairwise([first, *sorted(self._on_ridge[ridge], key=along), last]):
            self._edges.append((one, other))
            self._face_of[one, other], self._face_of[other, one] = left, right

    def _draw_border(self) -> None:
        places = np.array([self.points[v] for v in self._border])
        if isinstance(self._ridges.sheet, ConvexSheet):
            x, y = (places - self._ridges.sheet.corners.mean(axis=0)).T
            order = np.argsort(np.arctan2(y, x))
        else:
            order = np.argsort(_around_square(places / (self._ridges.size / 2) - 1))
        self._edges += half_edges([self._border[k] for k in order.tolist()])


class _Placed(NamedTuple):
    """Where a facet lies: the first corner and the unit direction of its side, and 1.0 if the shape is on its left."""

    start: Point
    along: Point
    left: float


def _placed(ridges: Ridges, faces: Sequence[int]) -> list[_Placed]:
    """Return where facets lie that are in these skeleton faces."""
    starts, along = ridges.skeleton.starts.tolist(), ridges.skeleton.along.tolist()
    sides = [face.side for face in ridges.skeleton.faces]
    return [
        _Placed(tuple(starts[sides[face]]), tuple(along[sides[face]]), ridges.shape_at_left[face]) for face in faces
    ]


def _folded(
    points: Sequence[Point], facets: list[Vertices], creases: list[Crease], placed: list[_Placed], most: float
) -> tuple[Floats, list[bool]]:
    """Return the vertices' folded places ``(v, 2)``, and whether each facet shows its upper side.

    ``most``: by how many mm a vertex may be off between two of its facets.
    """
    beside: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for (a, _), (one, two) in creases:
        beside[one].append((two, a))
        beside[two].append((one, a))
    folded: dict[int, Point] = {}
    turns: dict[int, tuple[float, float]] = {0: (1.0, 0.0)}  # which way x runs, and the shift
    queue = deque([0])
    worst = 0.0
    while queue:
        facet = queue.popleft()
        turn, shift = turns[facet]
        (start_x, start_y), (along_x, along_y), left = placed[facet]
        for vertex in facets[facet]:
            x, y = points[vertex]
            x, y = x - start_x, y - start_y
            u, z = turn * (x * along_x + y * along_y) + shift, left * (y * along_x - x * along_y)
            if vertex in folded:
                old_u, old_z = folded[vertex]
                worst = max(worst, abs(old_u - u), abs(old_z - z))
            else:
                folded[vertex] = u, z
        for other, vertex in beside[facet]:
            if other not in turns:
                (start_x, start_y), (along_x, along_y), other_left = placed[other]
                turned = -turn * left * other_left
                x, y = points[vertex]
                u = (x - start_x) * along_x + (y - start_y) * along_y
                turns[other] = turned, folded[vertex][0] - turned * u
                queue.append(other)
    if len(turns) < len(facets) or worst > most:
        raise UnfoldableError("the facets do not meet when they are folded")
    least = min(u for u, _ in folded.values())
    landed = np.zeros((len(points), 2))  # 0 for vertices that are not on the sheet
    landed[list(folded)] = [(u - least, z) for u, z in folded.values()]
    return landed, [turns[k][0] * placed[k].left > 0 for k in range(len(facets))]


def _around_square(away: Floats) -> Floats:
    """Return numbers that grow counter-clockwise along the border of the square with half side 1."""
    x, y = away.T
    flat = np.abs(y) >= np.abs(x)
    quarter: Floats = np.where(flat & (y < 0), x, np.where(~flat & (x > 0), 2 + y, np.where(flat, 4 - x, 6 - y)))
    return quarter
