"""The straight skeleton by a plain loop over events, with a hundred digits: slow, simple, and for comparison only.

The wavefront is a set of closed rows of vertices. Between a vertex and the next lies a piece of one side's wavefront.
Every vertex moves in a straight line, so the time when it reaches the line of any side is known when it begins; the
earliest one that is met within a piece is the next event. All that happens at one time is one step: the places where
vertices touch pieces, or pieces vanish, divide all pieces that they lie on. Pieces of no length are gone, and so are
two that lie on each other face to face. At each place, the pieces that are left are joined again in the order of their
angles, each one that leaves the place with the next, counter-clockwise, that arrives.

With n sides there are O(n) steps, O(n) new vertices, and O(n) work for each of these and each piece: O(n^3) at most.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator
from dataclasses import dataclass, field
from decimal import Decimal, localcontext
from functools import cmp_to_key
from itertools import count, pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

DIGITS = 100

EXACT = 1e-40
"""Times, places and directions of doubles that differ by less are really the same."""

ROUNDED = (1e-13, 1e-12, 1e-11)
"""Times, places and directions that differ by less may be meant to be the same: in rising order of doubt."""

Place = tuple[Decimal, Decimal]


@dataclass(frozen=True)
class Node:
    """A place where the wavefront changes: how far it is from its sides, and which these are."""

    x: float
    y: float
    time: float
    sides: frozenset[int]


@dataclass(frozen=True)
class Oracle:
    """Nodes, and the pairs of sides (left, right) whose arcs go on for ever."""

    nodes: list[Node]
    unbounded: list[tuple[int, int]]


@dataclass(eq=False)
class Vertex:
    """A vertex of the wavefront, between the pieces of two sides."""

    left: int
    right: int
    born: Decimal
    place: Place
    velocity: Place
    after: Vertex = field(init=False)
    is_alive: bool = True

    def at(self, time: Decimal) -> Place:
        """Return where the vertex is at a time."""
        wait = time - self.born
        return self.place[0] + wait * self.velocity[0], self.place[1] + wait * self.velocity[1]


@dataclass(frozen=True)
class Side:
    """A side: a point of its line, its unit direction, and its unit normal, in which it moves."""

    start: Place
    along: Place
    normal: Place


def straight_skeleton(points: ArrayLike, edges: NDArray, following: ArrayLike, same: float = EXACT) -> Oracle:
    """Return nodes and unbounded arcs of the straight skeleton of a plane graph.

    Side 2k is the left flank of edge k, 2k + 1 the right one; then come caps. ``following`` ``(s,)`` is the side after
    each, around the same region; a cap is what follows both ways at a dead end. ``same``: times and places that differ
    by less than this part of the drawing's size are the same, and so are directions that differ by less in radians.
    Raises ``ArithmeticError`` where so much is the same that the rest does not fit together.
    """
    with localcontext() as context:
        context.prec = DIGITS
        corners = [(float(x), float(y)) for x, y in np.asarray(points)]
        return Wavefront(corners, edges.tolist(), [int(side) for side in following], Decimal(same)).run()


class Wavefront:
    """The wavefront at one time, and what may happen next."""

    def __init__(
        self, points: list[tuple[float, float]], edges: list[list[int]], following: list[int], same: Decimal
    ) -> None:
        self.sides, heads = _sides(points, edges, following)
        xs, ys = zip(*points, strict=True)
        self.turn, self.same = same, same * Decimal(max(max(xs) - min(xs), max(ys) - min(ys)))
        self.now = Decimal(0)
        self.queue: list[tuple[Decimal, int, Vertex, int]] = []
        self.number = count()
        self.vertices: list[Vertex] = []
        self.nodes: list[Node] = []
        arriving = {side: self._vertex(side, after, heads[side]) for side, after in enumerate(following)}
        for side, after in enumerate(following):
            arriving[side].after = arriving[after]
        for vertex in list(arriving.values()):
            self._expect(vertex)

    def run(self) -> Oracle:
        """Let the wavefront move until nothing happens any more."""
        while True:
            contacts = list(self._contacts())
            if not contacts:
                return Oracle(self.nodes, [(vertex.left, vertex.right) for vertex in self.vertices])
            self._step(contacts)

    # --- what may happen -------------------------------------------------------------------------------------------

    def _vertex(self, left: int, right: int, place: Place) -> Vertex:
        one, other = self.sides[left], self.sides[right]
        if abs(_cross(one.along, other.along)) <= self.turn:
            velocity = one.normal  # on one line; what lies face to face has no vertex
        else:
            (a, b), (c, d) = one.normal, other.normal
            velocity = (d - b) / (a * d - b * c), (a - c) / (a * d - b * c)
        vertex = Vertex(left, right, self.now, place, velocity)
        self.vertices.append(vertex)
        return vertex

    def _expect(self, vertex: Vertex) -> None:
        """Note when a new vertex reaches the line of each side; and when the pieces beside it vanish."""
        for number, side in enumerate(self.sides):
            if number in (vertex.left, vertex.right):
                continue
            rate = 1 - _dot(vertex.velocity, side.normal)
            if rate > self.turn:
                gap = _dot(_minus(vertex.place, side.start), side.normal) - vertex.born
                self._note(vertex.born + gap / rate, vertex, number)
        self._note_vanishing(vertex)

    def _note_vanishing(self, vertex: Vertex) -> None:
        after, along = vertex.after, self.sides[vertex.right].along
        rate = _dot(_minus(vertex.velocity, after.velocity), along)
        if rate > self.turn:
            length = _dot(_minus(after.at(self.now), vertex.at(self.now)), along)
            self._note(self.now + length / rate, vertex, vertex.right)

    def _note(self, time: Decimal, vertex: Vertex, side: int) -> None:
        if time > self.now + self.same:
            heapq.heappush(self.queue, (time, next(self.number), vertex, side))

    def _contacts(self) -> Iterator[Place]:
        """Go on to the next time when something happens, and yield where."""
        first = None
        while self.queue and (first is None or self.queue[0][0] <= first + self.same):
            time, _, vertex, side = heapq.heappop(self.queue)
            if vertex.is_alive and self._is_met(time, vertex, side):
                first = self.now = time if first is None else first
                yield vertex.at(time)

    def _is_met(self, time: Decimal, vertex: Vertex, side: int) -> bool:
        """Return whether a vertex that is on the line of a side at a time is on a piece of its wavefront."""
        place = vertex.at(time)
        if side == vertex.right:
            return self._is_close(place, vertex.after.at(time))
        return any(
            piece.right == side and self._is_on(place, piece.at(time), piece.after.at(time), side)
            for piece in self.vertices
        )

    def _is_on(self, place: Place, start: Place, end: Place, side: int) -> bool:
        """Return whether a place is on a piece of a side's wavefront, ends included."""
        along, normal = self.sides[side].along, self.sides[side].normal
        return (
            abs(_dot(_minus(place, start), normal)) <= self.same
            and _dot(_minus(place, start), along) >= -self.same
            and _dot(_minus(end, place), along) >= -self.same
        )

    def _is_close(self, one: Place, other: Place) -> bool:
        return abs(one[0] - other[0]) <= self.same and abs(one[1] - other[1]) <= self.same

    # --- what happens ----------------------------------------------------------------------------------------------

    def _step(self, contacts: list[Place]) -> None:
        """Do all that happens now, in these places."""
        places: list[Place] = []
        for contact in contacts:
            if not any(self._is_close(contact, place) for place in places):
                places.append(contact)
        where = {id(v): self._place_of(v.at(self.now), places) for v in self.vertices}
        # the pieces between places, and between these and vertices that nothing happens to: (start, side, end)
        pieces: list[tuple[int | Vertex, int, int | Vertex]] = []
        touched: list[set[int]] = [set() for _ in places]
        for vertex in self.vertices:
            start, end, side = vertex.at(self.now), vertex.after.at(self.now), vertex.right
            on = [k for k, place in enumerate(places) if self._is_on(place, start, end, side)]
            on.sort(key=lambda k, side=side: _dot(places[k], self.sides[side].along))
            for k in on:
                touched[k].add(side)
            row: list[int | Vertex] = [*on]
            if where[id(vertex)] is None:
                row.insert(0, vertex)
            if where[id(vertex.after)] is None:
                row.append(vertex.after)
            pieces += [(a, side, b) for a, b in pairwise(row)]
        # two that lie on each other are gone
        between = {(a, b) for a, _, b in pieces if isinstance(a, int) and isinstance(b, int)}
        pieces = [(a, side, b) for a, side, b in pieces if (b, a) not in between]
        for place, sides in zip(places, touched, strict=True):
            self.nodes.append(Node(float(place[0]), float(place[1]), float(self.now), frozenset(sides)))
        before = self.vertices
        self.vertices = []
        for vertex in before:
            vertex.is_alive = where[id(vertex)] is None
            if vertex.is_alive:
                self.vertices.append(vertex)
        self._join(places, pieces)

    def _place_of(self, position: Place, places: list[Place]) -> int | None:
        return next((k for k, place in enumerate(places) if self._is_close(position, place)), None)

    def _by_angle(self, one: tuple[Place, bool, int], other: tuple[Place, bool, int]) -> int:
        """Compare rays by their angles; of two with the same, what arrives comes first: nothing is between them."""
        turn = _cross(one[0], other[0])
        if abs(turn) <= self.turn and _dot(one[0], other[0]) > 0:
            return other[1] - one[1]
        halves = [(vector[1], vector[0]) < (0, 0) for vector in (one[0], other[0])]
        if halves[0] != halves[1]:
            return 1 if halves[0] else -1
        return -1 if turn > 0 else 1

    def _join(self, places: list[Place], pieces: list[tuple[int | Vertex, int, int | Vertex]]) -> None:
        """Join the pieces at each place, and all pieces to their vertices."""
        leaving: dict[int, Vertex] = {}  # by number of the piece
        arriving: dict[int, Vertex] = {}
        new = []
        for k, place in enumerate(places):
            rays = [(self.sides[side].along, False, n) for n, (a, side, _) in enumerate(pieces) if a == k]
            rays += [(_back(self.sides[side].along), True, n) for n, (_, side, b) in enumerate(pieces) if b == k]
            rays.sort(key=cmp_to_key(self._by_angle))
            for (_, arrives, one), (_, then_arrives, other) in zip(rays, rays[1:] + rays[:1], strict=True):
                if arrives == then_arrives:
                    raise ArithmeticError("the wavefront crosses itself")
                if not arrives:
                    vertex = self._vertex(pieces[other][1], pieces[one][1], place)
                    leaving[one] = arriving[other] = vertex
                    new.append(vertex)
        changed = []
        for n, (start, _, end) in enumerate(pieces):
            vertex = start if isinstance(start, Vertex) else leaving[n]
            after = end if isinstance(end, Vertex) else arriving[n]
            if isinstance(start, Vertex) and vertex.after is not after:
                changed.append(vertex)
            vertex.after = after
        for vertex in new:
            self._expect(vertex)
        for vertex in changed:
            self._note_vanishing(vertex)


def _sides(
    points: list[tuple[float, float]], edges: list[list[int]], following: list[int]
) -> tuple[list[Side], list[Place]]:
    """Return all sides, and the place of each one's head."""
    exact = [(Decimal(x), Decimal(y)) for x, y in points]
    sides, heads = [], []
    for a, b in edges:
        for start, end in ((exact[a], exact[b]), (exact[b], exact[a])):
            dx, dy = _minus(end, start)
            length = (dx * dx + dy * dy).sqrt()
            sides.append(_side(start, (dx / length, dy / length)))
            heads.append(end)
    before = {after: side for side, after in enumerate(following)}
    for cap in range(len(sides), len(following)):
        x, y = sides[before[cap]].along
        sides.append(_side(heads[before[cap]], (y, -x)))
        heads.append(heads[before[cap]])
    return sides, heads


def _side(start: Place, along: Place) -> Side:
    return Side(start, along, (-along[1], along[0]))


def _dot(one: Place, other: Place) -> Decimal:
    return one[0] * other[0] + one[1] * other[1]


def _minus(one: Place, other: Place) -> Place:
    return one[0] - other[0], one[1] - other[1]


def _cross(one: Place, other: Place) -> Decimal:
    return one[0] * other[1] - one[1] * other[0]


def _back(vector: Place) -> Place:
    return -vector[0], -vector[1]
