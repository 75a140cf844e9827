"""Perpendiculars: where they begin at the straight skeleton's nodes, and how they run through the sheet.

``Skeleton`` on its sheet -> ``Ridges`` -> ``Perpendiculars`` (Demaine, Demaine and Lubiw 1999).

Folded along all ridges, every side of the shape comes to lie on the cut line, and a point at distance z from its side
at height z. What is left open is how the skeleton faces lie along that line: x runs one way or the other, and opposite
ways in neighbouring faces. Around a node where an odd number of ridges meet, that is impossible, so a *perpendicular*
has to begin there: a crease along which x turns back. It crosses its face at a right angle to the face's side, goes on
at a right angle to the next face's side, and so on, until it leaves the sheet or comes to another node. Which of a
node's perpendiculars are folded is free, as long as the number of creases at every node becomes even: see ``choices``.

Nothing ensures that a perpendicular ends: it may go around for ever. If none of an odd node ends, there is no pattern.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections import Counter, defaultdict, deque
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, pairwise
from typing import NamedTuple

import numpy as np

from foldcut.core.errors import UnfoldableWhereError
from foldcut.core.model import Sheet
from foldcut.geometry.convex_sheet import ConvexBorder, ConvexSheet
from foldcut.methods.skeleton.skeleton_faces import Edge, Skeleton, Vertices, half_edges

Point = tuple[float, float]
"""A place on the sheet, in mm: plain numbers, since they are looked at one by one."""

SNAP = 1e-9
"""A perpendicular that passes a node this closely, relative to the sheet's diagonal, comes to it."""

STRAIGHT = 1e-6
"""Two pieces are one line if their unit directions differ by less."""

MOST_CROSSINGS = 600
"""A perpendicular that crosses more skeleton faces is given up."""


@dataclass(frozen=True, eq=False)
class Chain:
    """One of the two chains of a skeleton face: its vertices, and ``u``, how far along the side each is, in mm."""

    vertices: Vertices
    u: list[float]


class Hit(NamedTuple):
    """Where a perpendicular meets a chain: the place, and there the edge, or the vertex (else -1)."""

    place: Point
    edge: Edge | None
    vertex: int


class Place(NamedTuple):
    """A node, on one of the two chains of a skeleton face."""

    node: int
    face: int
    chain: int


class Piece(NamedTuple):
    """What lies in one skeleton face of a perpendicular: from ``start`` to ``end``, ``u`` mm along the face's side."""

    face: int
    u: float
    start: Point
    end: Point
    edge: Edge | None  # by which it leaves the face; None at a node and at the sheet's border


@dataclass(frozen=True)
class Perpendicular:
    """A perpendicular from a node to a node, or with ``end`` -1 to the sheet's border."""

    start: int
    end: int
    pieces: tuple[Piece, ...]

    def creases(self, skeleton: Skeleton) -> list[tuple[Point, Point]]:
        """Return the ends of its creases: pieces between which it crosses a side of the shape are one."""
        creases: list[tuple[Point, Point]] = []
        start = self.pieces[0].start
        for piece in self.pieces:
            if piece.edge is None or not skeleton.is_side(piece.edge) or piece is self.pieces[-1]:
                creases.append((start, piece.end))
                start = piece.end
        return creases

    @property
    def ends(self) -> list[tuple[int, Point]]:
        """The nodes at its ends, and the unit direction in which it leaves each of them."""
        ends = [(self.start, _way(self.pieces[0]))]
        if self.end >= 0:
            x, y = _way(self.pieces[-1])
            ends.append((self.end, (-x, -y)))
        return ends


class Ridges:
    """The ridges of a straight skeleton on its sheet, and the nodes at which perpendiculars begin.

    ``size`` ``(2,)`` mm is the sheet's; ``snap`` in mm: points less far apart are one; ``places`` are the skeleton's
    points as plain numbers. ``shape_at_left`` is for each skeleton face 1.0 where the shape is on the left of its side,
    else -1.0. ``edges`` are the ridges, and of a graph also the sides that are folded; ``degree`` is how many of them
    meet in a vertex. ``corners`` are those of the shape. ``nodes`` are the vertices strictly on the sheet that are no
    corners, or in ``odd``: there an odd number of creases meet. At corners of a graph that happens where a line ends.
    """

    def __init__(self, skeleton: Skeleton, sheet: Sheet) -> None:
        self.skeleton = skeleton
        self.sheet = sheet
        self.size = np.array([sheet.width, sheet.height])
        self.snap = SNAP * sheet.diagonal
        faces = skeleton.faces
        self.places: list[Point] = [(x, y) for x, y in skeleton.points.tolist()]
        self.shape_at_left = [float(face.sign if face.flank.left else -face.sign) for face in faces]
        starts, along = skeleton.starts.tolist(), skeleton.along.tolist()
        self._sides: list[tuple[float, float, float, float]] = [
            (*starts[face.side], *along[face.side]) for face in faces
        ]
        self._low, self._high = self.snap, (sheet.width - self.snap, sheet.height - self.snap)
        self._border = ConvexBorder(sheet, self.snap) if isinstance(sheet, ConvexSheet) else None
        self._face_of: dict[Edge, int] = {}
        for number, face in enumerate(faces):
            for pair in half_edges(face.vertices if face.flank.left else face.vertices[::-1]):
                self._face_of[pair] = number
        self._chains: list[tuple[Chain, Chain]] = []
        self._chain_of: dict[tuple[int, int, int], int] = {}
        for number, face in enumerate(faces):
            lower, upper = (Chain(way, [self.u(number, v) for v in way]) for way in (face.lower, face.upper))
            self._chains.append((lower, upper))
            for which in (1, 0):
                for a, b in pairwise((lower, upper)[which].vertices):
                    self._chain_of[number, a, b] = self._chain_of[number, b, a] = which
        self.edges = [
            (a, b) for a, b in self._face_of if a < b and (b, a) in self._face_of and not skeleton.is_side((a, b))
        ]
        self.degree = Counter(vertex for edge in self.edges for vertex in edge)
        self.corners = {vertex for side in skeleton.base for vertex in side}
        self.odd = [v for v, count in self.degree.items() if count % 2 and self.on_sheet(self.places[v])]
        inner = self.degree.keys() - self.corners | {*self.odd}  # of a graph, some corners are odd
        self.nodes = [v for v in self.degree if v in inner and self.on_sheet(self.places[v])]

    def u(self, face: int, vertex: int) -> float:
        """Return how far along a skeleton face's side a vertex is, in mm."""
        return self.along(face, self.places[vertex])

    def along(self, face: int, place: Point) -> float:
        """Return how far along a skeleton face's side a place is, in mm."""
        x, y, along_x, along_y = self._sides[face]
        return (place[0] - x) * along_x + (place[1] - y) * along_y

    def on_sheet(self, point: Point) -> bool:
        """Return whether a point is strictly on the sheet, off its border."""
        if self._border is not None:
            return self._border.has_inside(point)
        return self._low < point[0] < self._high[0] and self._low < point[1] < self._high[1]

    def on_sheet_part(self, a: int, b: int) -> tuple[float, float] | None:
        """Return from which to which part, 0 to 1, a ridge is on the sheet, None where none of it is."""
        start, end = self.places[a], self.places[b]
        if self._border is not None:
            return self._border.part_inside(start, end)
        low, high = 0.0, 1.0
        for at, other, size in zip(start, end, (self.sheet.width, self.sheet.height), strict=True):
            step = other - at
            if abs(step) <= self.snap:
                if not self.snap < at < size - self.snap:
                    return None
                continue
            parts = sorted([-at / step, (size - at) / step])
            low, high = max(low, parts[0]), min(high, parts[1])
        return None if (high - low) * math.dist(start, end) <= self.snap else (low, high)

    def face_of(self, edge: Edge) -> int:
        """Return the skeleton face on the left of an edge between two of its vertices, -1 if there is none."""
        return self._face_of.get(edge, -1)

    def beyond(self, edge: Edge, face: int) -> int:
        """Return the skeleton face on the other side of an edge, -1 if there is none."""
        left, right = self.face_of(edge), self.face_of(edge[::-1])
        return right if left == face else left

    def chain_with(self, edge: Edge, face: int) -> int:
        """Return which of a face's two chains has an edge, -1 if neither."""
        return self._chain_of.get((face, *edge), -1)

    def hit(self, face: int, u: float, chain: int) -> Hit | None:
        """Return where the perpendicular at ``u`` mm along a face's side meets a chain, None if it passes it by."""
        way = self._chains[face][chain]
        vertices, places = way.vertices, way.u
        if not places[0] + self.snap < u < places[-1] - self.snap:
            return None
        k = bisect_left(places, u)  # places[k - 1] < u <= places[k], so what is divided by is not 0
        if min(places[k] - u, u - places[k - 1]) <= self.snap:
            nearest = vertices[min(range(len(places)), key=lambda n: abs(places[n] - u))]
            return Hit(self.places[nearest], None, nearest)
        a, b = vertices[k - 1], vertices[k]
        part = (u - places[k - 1]) / (places[k] - places[k - 1])
        (ax, ay), (bx, by) = self.places[a], self.places[b]
        return Hit((ax + part * (bx - ax), ay + part * (by - ay)), (a, b), -1)

    def exit_of(self, here: Point, there: Point) -> Point | None:
        """Return where the segment from a point on the sheet leaves it, None if it does not."""
        if self._border is not None:
            return self._border.exit_of(here, there)
        if self.on_sheet(there):
            return None
        (x, y), size = here, (self.sheet.width, self.sheet.height)
        step = there[0] - x, there[1] - y
        parts = [
            (most - at) / go if go > 0 else -at / go if go < 0 else np.inf
            for at, go, most in zip(here, step, size, strict=True)
        ]
        axis = 0 if parts[0] <= parts[1] else 1
        part = min(1.0, parts[axis])
        place = [x + part * step[0], y + part * step[1]]
        place[axis] = size[axis] if step[axis] > 0 else 0.0
        return place[0], place[1]


@dataclass(frozen=True, eq=False)
class Perpendiculars:
    """The perpendiculars from some nodes, and from the nodes that these come to: all that end."""

    ridges: Ridges
    paths: Sequence[Perpendicular]

    @cached_property
    def ridge_lines(self) -> int:
        """How many straight folds the ridges are."""
        ridges = self.ridges
        at: dict[int, list[Point]] = defaultdict(list)
        count = 0
        for a, b in ridges.edges:
            if ridges.on_sheet_part(a, b) is not None:
                count += 1
                way = _direction(ridges.places[a], ridges.places[b])
                at[a].append(way)
                at[b].append((-way[0], -way[1]))
        return count - sum(
            _are_opposite(*two)
            for node, ways in at.items()
            if ridges.on_sheet(ridges.places[node])
            for two in combinations(ways, 2)
        )

    @cached_property
    def lines(self) -> list[int]:
        """How many straight folds each perpendicular adds to the ridges: a piece that goes straight on adds none."""
        ridges = self.ridges
        at: dict[int, list[Point]] = defaultdict(list)
        for a, b in ridges.edges:
            way = _direction(ridges.places[a], ridges.places[b])
            at[a].append(way)
            at[b].append((-way[0], -way[1]))
        return [
            1
            + sum(not _are_opposite((-x, -y), way) for (x, y), way in pairwise(map(_way, path.pieces)))
            - sum(any(_are_opposite(way, ridge) for ridge in at[node]) for node, way in path.ends)
            for path in self.paths
        ]

    @cached_property
    def straight_on(self) -> list[tuple[int, int]]:
        """Twos of perpendiculars that are one straight fold where they meet in a node."""
        at: dict[int, list[tuple[int, Point]]] = defaultdict(list)
        for number, path in enumerate(self.paths):
            for node, way in path.ends:
                at[node].append((number, way))
        return [
            (one, other)
            for ways in at.values()
            for (one, way), (other, back) in combinations(ways, 2)
            if _are_opposite(way, back)
        ]

    def line_count(self, taken: Collection[int]) -> int:
        """Return how many straight folds some perpendiculars, by number, add to the ridges."""
        joined = sum(one in taken and other in taken for one, other in self.straight_on)
        return sum(self.lines[k] for k in taken) - joined

    def shortest(self, taken: Iterable[int]) -> float:
        """Return the length in mm of the shortest crease of some perpendiculars, infinite without any."""
        return min((self._shortest[k] for k in taken), default=math.inf)

    @cached_property
    def _shortest(self) -> list[float]:
        return [min(math.dist(start, end) for start, end in path.creases(self.ridges.skeleton)) for path in self.paths]

    def require_ends(self) -> None:
        """Raise ``UnfoldableError`` if there is a node that needs a perpendicular, and none of its own ends."""
        ending = {node for path in self.paths for node in (path.start, path.end)}
        for node in self.ridges.odd:
            if node not in ending:
                remedy = "move a line or leave one out" if self.ridges.skeleton.is_graph else "try a larger --adjust"
                raise UnfoldableWhereError(
                    "no perpendicular from the skeleton's node at ({x:.1f}, {y:.1f}) mm ends within "
                    f"{MOST_CROSSINGS} crossings; {remedy}",
                    self.ridges.skeleton.points[node].tolist(),
                )


def _direction(start: Point, end: Point) -> Point:
    """Return the unit direction from one place to another."""
    x, y = end[0] - start[0], end[1] - start[1]
    length = math.hypot(x, y) or 1.0
    return x / length, y / length


def _way(piece: Piece) -> Point:
    return _direction(piece.start, piece.end)


def _are_opposite(one: Point, other: Point) -> bool:
    """Return whether two unit directions are opposite."""
    return math.hypot(one[0] + other[0], one[1] + other[1]) < STRAIGHT


def trace(ridges: Ridges, nodes: Sequence[int]) -> Perpendiculars:
    """Return the perpendiculars from some nodes, and from the nodes that these come to, as far as they end."""
    paths: list[Perpendicular] = []
    arrivals: set[Place] = set()  # a perpendicular between two nodes is taken from one of its ends only
    around: dict[int, list[int]] = defaultdict(list)
    for number, face in enumerate(ridges.skeleton.faces):
        for node in face.vertices:
            around[node].append(number)
    queue, seen = deque(nodes), set(nodes)
    while queue:
        node = queue.popleft()
        for number in around[node]:
            face = ridges.skeleton.faces[number]
            for chain, vertices in enumerate((face.lower, face.upper)):
                start = Place(node, number, chain)
                if node not in vertices or start in arrivals:
                    continue
                found = _followed(ridges, start)
                if found is None:
                    continue
                path, arrival = found
                paths.append(path)
                if arrival is not None:
                    arrivals.add(arrival)
                    if path.end not in seen:
                        seen.add(path.end)
                        queue.append(path.end)
    return Perpendiculars(ridges, paths)


def _followed(ridges: Ridges, start: Place) -> tuple[Perpendicular, Place | None] | None:
    """Return the perpendicular that begins at a place, and the place that it comes to, if that is a node.

    None where no perpendicular begins there, or where it does not end.
    """
    node, face, chain = start
    u = ridges.u(face, node)
    here = ridges.places[node]
    pieces: list[Piece] = []
    while len(pieces) < MOST_CROSSINGS:
        hit = ridges.hit(face, u, 1 - chain)
        if hit is None or (not pieces and math.dist(hit.place, here) < ridges.snap):
            return None
        exit_at = ridges.exit_of(here, hit.place)
        if exit_at is not None:
            pieces.append(Piece(face, u, here, exit_at, None))
            return Perpendicular(node, -1, tuple(pieces)), None
        pieces.append(Piece(face, u, here, hit.place, hit.edge))
        if hit.edge is None:
            return Perpendicular(node, hit.vertex, tuple(pieces)), Place(hit.vertex, face, 1 - chain)
        face = ridges.beyond(hit.edge, face)
        if face < 0:
            return None
        here = hit.place
        u = ridges.along(face, here)
        chain = ridges.chain_with(hit.edge, face)
        if chain < 0:
            return None
    return None
