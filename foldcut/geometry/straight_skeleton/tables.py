"""The tables in which the wavefront is kept: arrays of records for compiled code, plain lists without it.

``wavefront`` only ever reads and writes single fields of single rows, ``front.vertices[vertex].x``, which numba does
fastest in arrays of records, and Python in lists of objects. The same operations on the same doubles give the same
bits.
"""

from __future__ import annotations

from decimal import Decimal
from functools import cache
from typing import Any, NamedTuple

import numpy as np

__all__ = ["Arrays", "Faces", "Front", "Graphs", "Lists", "Tables", "faces_of", "front_of"]

Table = Any
"""An array or a list, of numbers or of rows with fields."""

SIDE = "dx dy ox oy turn"
"""Unit direction, a point of its line at time 0, and how uncertain the direction is, in radians."""

VERTEX = (
    "x y born vx vy error drift shrinks hits key entered "
    "left: right: prev: next: node: state: target: target_end: mark: heap_place: live_place: sibling: "
    "passed: passed_end:"
)
"""Of a vertex of the wavefront, from its birth to its end.

Place and time of birth, velocity, how uncertain place and velocity are; when the fragment from here to the next vertex
has no length left, when this vertex hits a fragment, and the earlier of the two; until when
its path is in the grid; the sides that arrive and leave, the
neighbours, the node of birth, the state; start and end of the fragment to be hit; the last meeting that it was part of;
where it is in the columns ``heap`` and ``live`` of the slots; the one that was born at the same node before it;
a fragment that it has passed without hitting it, -1 if none.
"""

NODE = "x y time error same_as: born: beside:"
"""``same_as`` is the node itself, or an older one at the same place; the newest vertex that was born there; the next
node in its bucket."""

ARC = "vx vy start: end: left: right: beyond:"
"""Velocity; nodes, and the sides on its left and right; where it is unbounded, the arc next to it at the infinite."""

RAY = "angle side: far: out:"
"""A fragment that arrives at a meeting, or leaves it: its direction there, its side, the vertex at its other end."""

SLOT = "heap: live: group: order: stack:"
"""Five columns: vertices in a binary heap by key, those that live, those that meet; rays by angle, rays to pair."""

CELL = "fragments: vertices:"
"""The first entry of each list."""

ENTRY = "next: item:"
"""The next entry of the list, and the fragment or vertex."""

FACE = "first: offset:"
"""Half-edges: the first of a list; then where the nodes of the side's face begin in ``values``."""

HALF_EDGE = "following: at_node: face: value:"
"""Of half-edges the next of the list; of nodes the half-edge that leaves it in a face, and which; nodes of faces."""


class Graphs(NamedTuple):
    """The sides of a graph, as lists or arrays of integers; see ``graph.Graph``."""

    tail: Table
    head: Table
    following: Table
    source: Table


class Front(NamedTuple):
    """The wavefront while it moves, and the skeleton that it has left behind.

    A *fragment* is a part of a side's wavefront between two consecutive vertices; it is known by the vertex at which it
    starts. ``buckets`` holds the newest node of each; ``counts`` and
    ``numbers`` are what there is once.
    """

    sides: Table
    vertices: Table
    nodes: Table
    arcs: Table
    rays: Table
    slots: Table
    cells: Table
    entries: Table
    buckets: Table
    counts: Table
    numbers: Table


class Faces(NamedTuple):
    """The faces of the sides, and what is needed to put them together."""

    sides: Table
    items: Table


ENTRIES = 8
"""For how many entries of the grid there is room, for each vertex that there is room for."""

ONCE = 16
"""How many counts and numbers there are, and some more."""


class Tables:
    """How to make tables."""

    compiled: bool

    def numbers(self, size: int) -> Table:
        """Return zeros."""
        raise NotImplementedError

    def integers(self, size: int) -> Table:
        """Return zeros."""
        raise NotImplementedError

    def rows(self, fields: str, size: int) -> Table:
        """Return rows of zeros with some fields; a colon after its name makes a field an integer."""
        raise NotImplementedError


class Lists(Tables):
    """Tables as lists; ``zero`` is of the kind of numbers to be used."""

    compiled = False

    def __init__(self, zero: float | Decimal = 0.0) -> None:
        self.zero = zero

    def numbers(self, size: int) -> Table:
        """Return zeros."""
        return [self.zero] * size

    def integers(self, size: int) -> Table:
        """Return zeros."""
        return [0] * size

    def rows(self, fields: str, size: int) -> Table:
        """Return rows of zeros with some fields."""
        row = _row_type(fields, self.zero)
        return [row() for _ in range(size)]


class Arrays(Tables):
    """Tables as arrays."""

    compiled = True

    def numbers(self, size: int) -> Table:
        """Return zeros."""
        return np.zeros(size)

    def integers(self, size: int) -> Table:
        """Return zeros."""
        return np.zeros(size, dtype=np.int64)

    def rows(self, fields: str, size: int) -> Table:
        """Return rows of zeros with some fields."""
        return np.zeros(size, dtype=_record(fields))


@cache
def _record(fields: str) -> np.dtype[np.void]:
    """Return the type of an array's rows with some fields."""
    return np.dtype([(name.strip(":"), np.int64 if name.endswith(":") else np.float64) for name in fields.split()])


@cache
def _row_type(fields: str, number: float | Decimal) -> type:
    """Return the class of a list's rows with some fields; ``number`` is the zero of those that are no integers."""
    names = [name.strip(":") for name in fields.split()]
    zeros = [0 if name.endswith(":") else number for name in fields.split()]

    def __init__(self: Any) -> None:  # noqa: N807
        for name, zero in zip(names, zeros, strict=True):
            setattr(self, name, zero)

    return type("Row", (), {"__slots__": names, "__init__": __init__})


def front_of(tables: Tables, sides: int, points: int, vertices: int, cells: int) -> Front:
    """Return an empty front with room for so many sides, points, vertices in all, and cells along the grid's side."""
    return Front(
        sides=tables.rows(SIDE, sides),
        vertices=tables.rows(VERTEX, vertices),
        nodes=tables.rows(NODE, points + vertices),
        arcs=tables.rows(ARC, vertices),
        rays=tables.rows(RAY, vertices),
        slots=tables.rows(SLOT, vertices),
        cells=tables.rows(CELL, cells * cells),
        entries=tables.rows(ENTRY, ENTRIES * vertices if cells > 1 else 1),
        buckets=tables.integers(1 << (points + vertices).bit_length()),
        counts=tables.integers(ONCE),
        numbers=tables.numbers(ONCE),
    )


def faces_of(tables: Tables, sides: int, points: int, vertices: int) -> Faces:
    """Return room for the faces of a front with so many sides, points and vertices in all."""
    return Faces(tables.rows(FACE, sides + 1), tables.rows(HALF_EDGE, 2 * sides + points + 3 * vertices))
