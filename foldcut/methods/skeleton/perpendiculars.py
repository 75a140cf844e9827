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

from collections import Counter, defaultdict, deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import shapely

from foldcut.core.arrays import Floats
from foldcut.core.errors import UnfoldableWhereError
from foldcut.core.model import Sheet
from foldcut.methods.skeleton.skeleton_faces import Edge, Skeleton, Vertices, half_edges

SNAP = 1e-9
"""A perpendicular that passes a node this closely, relative to the sheet's diagonal, comes to it."""

MOST_CROSSINGS = 600
"""A perpendicular that crosses more skeleton faces is given up."""


@dataclass(frozen=True, eq=False)
class Chain:
    """One of the two chains of a skeleton face: its vertices, and ``u`` ``(n,)`` mm, how far along the side each is."""

    vertices: Vertices
    u: Floats


class Hit(NamedTuple):
    """Where a perpendicular meets a chain: the place, and there the edge, or the vertex (else -1)."""

    place: Floats
    edge: Edge | None
    vertex: int


class Place(NamedTuple):
    """A node, on one of the two chains of a skeleton face."""

    node: int
    face: int
    chain: int


@dataclass(frozen=True)
class Piece:
    """What lies in one skeleton face of a perpendicular: from ``start`` to ``end``, ``u`` mm along the face's side."""

    face: int
    u: float
    start: Floats
    end: Floats
    edge: Edge | None  # by which it leaves the face; None at a node and at the sheet's border


@dataclass(frozen=True)
class Perpendicular:
    """A perpendicular from a node to a node, or with ``end`` -1 to the sheet's border."""

    start: int
    end: int
    pieces: tuple[Piece, ...]


class Ridges:
    """The ridges of a straight skeleton on its sheet, and the nodes at which perpendiculars begin.

    ``size`` ``(2,)`` mm is the sheet's; ``snap`` in mm: points less far apart are one. ``shape_at_left`` is for each
    skeleton face 1.0 where the shape is on the left of its side, else -1.0. ``edges`` are the ridges, ``degree`` is how
    many of them meet in a vertex. ``nodes`` are the vertices strictly on the sheet that are no corners of the shape; at
    those in ``odd`` an odd number of ridges meet.
    """

    def __init__(self, skeleton: Skeleton, sheet: Sheet) -> None:
        self.skeleton = skeleton
        self.sheet = sheet
        self.size = np.array([sheet.width, sheet.height])
        self.snap = SNAP * sheet.diagonal
        faces = skeleton.faces
        self.shape_at_left = [float(face.sign if face.flank.left else -face.sign) for face in faces]
        self._face_of: dict[Edge, int] = {}
        for number, face in enumerate(faces):
            for pair in half_edges(face.vertices if face.flank.left else face.vertices[::-1]):
                self._face_of[pair] = number
        self._chains = [
            tuple(Chain(chain, np.array([skeleton.u(f.side, v) for v in chain])) for chain in (f.lower, f.upper))
            for f in faces
        ]
        self._tree = shapely.STRtree([shapely.Polygon(skeleton.points[face.vertices]) for face in faces])
        self.edges = [
            (a, b) for a, b in self._face_of if a < b and (b, a) in self._face_of and not skeleton.is_side((a, b))
        ]
        self.degree = Counter(vertex for edge in self.edges for vertex in edge)
        corners = {vertex for side in skeleton.base for vertex in side}
        self.nodes = [v for v in self.degree if v not in corners and self.on_sheet(skeleton.points[v])]
        self.odd = [v for v, count in self.degree.items() if count % 2 and self.on_sheet(skeleton.points[v])]

    def on_sheet(self, point: Floats) -> bool:
        """Return whether a point is strictly on the sheet, off its border."""
        return bool(((point > self.snap) & (point < self.size - self.snap)).all())

    def faces_at(self, places: Sequence[object]) -> list[int]:
        """Return the number of the skeleton face on which each of some shapely points lies."""
        numbers: list[int] = self._tree.nearest(places).tolist()
        return numbers

    def beyond(self, edge: Edge, face: int) -> int:
        """Return the skeleton face on the other side of an edge, -1 if there is none."""
        a, b = edge
        left, right = self._face_of.get((a, b), -1), self._face_of.get((b, a), -1)
        return right if left == face else left

    def chain_with(self, edge: Edge, face: int) -> int:
        """Return which of a face's two chains has an edge, -1 if neither."""
        for number, chain in enumerate(self._chains[face]):
            if any(set(pair) == set(edge) for pair in pairwise(chain.vertices)):
                return number
        return -1

    def hit(self, face: int, u: float, chain: int) -> Hit | None:
        """Return where the perpendicular at ``u`` mm along a face's side meets a chain, None if it passes it by."""
        vertices, places = self._chains[face][chain].vertices, self._chains[face][chain].u
        if not places[0] + self.snap < u < places[-1] - self.snap:
            return None
        points = self.skeleton.points
        nearest = int(np.abs(places - u).argmin())
        if abs(places[nearest] - u) <= self.snap:
            return Hit(points[vertices[nearest]], None, vertices[nearest])
        k = int(np.searchsorted(places, u))  # places[k - 1] < u <= places[k], so what is divided by is not 0
        a, b = vertices[k - 1], vertices[k]
        part = (u - places[k - 1]) / (places[k] - places[k - 1])
        return Hit(points[a] + part * (points[b] - points[a]), (a, b), -1)

    def exit_of(self, here: Floats, there: Floats) -> Floats | None:
        """Return where the segment from a point on the sheet leaves it, None if it does not."""
        if self.on_sheet(there):
            return None
        step = there - here
        with np.errstate(divide="ignore", invalid="ignore"):  # of what is divided by 0 nothing is taken
            part = np.where(step > 0, (self.size - here) / step, np.where(step < 0, -here / step, np.inf))
        axis = int(part.argmin())
        place: Floats = here + min(1.0, float(part[axis])) * step
        place[axis] = self.size[axis] if step[axis] > 0 else 0.0
        return place


@dataclass(frozen=True, eq=False)
class Perpendiculars:
    """The perpendiculars from some nodes, and from the nodes that these come to: all that end."""

    ridges: Ridges
    paths: Sequence[Perpendicular]

    def pieces(self, taken: Iterable[int]) -> int:
        """Return how many pieces some perpendiculars, by number, have together."""
        return sum(len(self.paths[k].pieces) for k in taken)

    def require_ends(self) -> None:
        """Raise ``UnfoldableError`` if there is a node that needs a perpendicular, and none of its own ends."""
        ending = {node for path in self.paths for node in (path.start, path.end)}
        for node in self.ridges.odd:
            if node not in ending:
                raise UnfoldableWhereError(
                    "no perpendicular from the skeleton's node at ({x:.1f}, {y:.1f}) mm ends within "
                    f"{MOST_CROSSINGS} crossings; try a larger --adjust",
                    self.ridges.skeleton.points[node].tolist(),
                )


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
    skeleton = ridges.skeleton
    node, face, chain = start
    u = skeleton.u(skeleton.faces[face].side, node)
    here = skeleton.points[node]
    pieces: list[Piece] = []
    while len(pieces) < MOST_CROSSINGS:
        hit = ridges.hit(face, u, 1 - chain)
        if hit is None or (not pieces and np.hypot(*(hit.place - here)) < ridges.snap):
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
        side = skeleton.faces[face].side
        u = float((here - skeleton.starts[side]) @ skeleton.along[side])
        chain = ridges.chain_with(hit.edge, face)
        if chain < 0:
            return None
    return None
