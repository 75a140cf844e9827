"""The columns in which the wavefront is kept: arrays for compiled code, plain lists without it.

Every column has one entry for each side, vertex of the wavefront, node, arc or cell of the grid. The code in
``wavefront`` only ever reads and writes single entries, ``front.x[vertex]``, which numba does fastest in arrays and
Python fastest in lists. The same operations on the same doubles give the same bits.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

__all__ = ["Arrays", "Columns", "Faces", "Front", "Lists", "Sides", "faces_of", "front_of"]

Column = Any
"""An array, or a list of numbers."""


class Sides(NamedTuple):
    """The sides of a graph, one entry each; a cap is a side of no length at a dead end.

    ``tail`` and ``head`` are points; ``following`` is the side that goes on at the head, around the same region.
    ``source`` is the side itself, and for a cap the side that arrives at its dead end.
    """

    tail: Column
    head: Column
    following: Column
    source: Column


class Front(NamedTuple):
    """The wavefront while it moves, and the skeleton that it has left behind.

    A *fragment* is a part of a side's wavefront between two consecutive vertices; it is known by the vertex at which it
    starts.
    """

    # of sides: unit direction, a point of its line at time 0, and how uncertain the direction is in radians
    dx: Column
    dy: Column
    ox: Column
    oy: Column
    turn: Column
    # of vertices: place and time of birth, velocity, and how uncertain place and velocity are
    x: Column
    y: Column
    born: Column
    vx: Column
    vy: Column
    error: Column
    drift: Column
    # of vertices: when the fragment from here to the next has no length left; when this one hits a fragment; the earlier
    shrinks: Column
    hits: Column
    key: Column
    # of vertices: the sides that arrive and leave, the neighbours, the node of birth, a state, the fragment to be hit
    left: Column
    right: Column
    prev: Column
    next: Column
    node: Column
    state: Column
    target: Column
    target_end: Column
    mark: Column
    # vertices in a binary heap by key, and where each is; vertices that live, and where each is
    heap: Column
    heap_place: Column
    live: Column
    live_place: Column
    # of nodes; same_as is the node itself or another at the same place
    node_x: Column
    node_y: Column
    node_time: Column
    node_error: Column
    same_as: Column
    # of arcs; beyond is, where an arc is unbounded, the arc next to it around the infinite
    arc_start: Column
    arc_end: Column
    arc_left: Column
    arc_right: Column
    arc_vx: Column
    arc_vy: Column
    arc_beyond: Column
    # the vertices that meet at one place, and the ends of fragments around it
    group: Column
    ray_side: Column
    ray_far: Column
    ray_out: Column
    ray_angle: Column
    order: Column
    stack: Column
    # of cells: the first of the entries; of entries: the next, and the fragment or the vertex
    cell_fragments: Column
    cell_vertices: Column
    entry_next: Column
    entry_item: Column
    # what there is once
    counts: Column
    numbers: Column


class Faces(NamedTuple):
    """The faces of the sides, and what is needed to put them together.

    The nodes of face k are ``values[offsets[k] : offsets[k + 1]]``.
    """

    offsets: Column
    values: Column
    first: Column
    following: Column
    at_node: Column
    node_face: Column


FLOATS = frozenset(
    [
        *("dx", "dy", "ox", "oy", "turn", "x", "y", "born", "vx", "vy", "error", "drift", "shrinks", "hits", "key"),
        *("node_x", "node_y", "node_time", "node_error", "arc_vx", "arc_vy", "ray_angle", "numbers"),
    ]
)
OF_SIDES = frozenset(["dx", "dy", "ox", "oy", "turn"])
OF_NODES = frozenset(["node_x", "node_y", "node_time", "node_error", "same_as"])
OF_CELLS = frozenset(["cell_fragments", "cell_vertices"])
OF_ENTRIES = frozenset(["entry_next", "entry_item"])
ONCE = frozenset(["counts", "numbers"])

HOW_MANY_ONCE = 16
"""How many entries the columns ``counts`` and ``numbers`` have."""

ENTRIES = 24
"""For how many entries of the grid there is room, for each side."""


class Columns:
    """How to make columns."""

    compiled: bool

    def floats(self, size: int) -> Column:
        """Return a column of zeros."""
        raise NotImplementedError

    def integers(self, size: int) -> Column:
        """Return a column of zeros."""
        raise NotImplementedError


class Lists(Columns):
    """Columns as lists."""

    compiled = False

    def floats(self, size: int) -> Column:
        return [0.0] * size

    def integers(self, size: int) -> Column:
        return [0] * size


class Arrays(Columns):
    """Columns as arrays."""

    compiled = True

    def floats(self, size: int) -> Column:
        return np.zeros(size)

    def integers(self, size: int) -> Column:
        return np.zeros(size, dtype=np.int64)


def front_of(columns: Columns, sides: int, points: int, vertices: int, cells: int) -> Front:
    """Return an empty front with room for so many sides, points, vertices in all, and cells along the grid's side."""
    made = []
    for name in Front._fields:
        if name in OF_SIDES:
            size = sides
        elif name in OF_NODES:
            size = points + vertices
        elif name in OF_CELLS:
            size = cells * cells
        elif name in OF_ENTRIES:
            size = ENTRIES * sides if cells > 1 else 1
        elif name in ONCE:
            size = HOW_MANY_ONCE
        else:
            size = vertices
        made.append(columns.floats(size) if name in FLOATS else columns.integers(size))
    return Front(*made)


def faces_of(columns: Columns, sides: int, points: int, vertices: int) -> Faces:
    """Return room for the faces of a front with so many sides, points and vertices in all."""
    sizes = {
        "offsets": sides + 1,
        "values": 2 * sides + 3 * vertices,
        "first": sides,
        "following": 2 * vertices,
        "at_node": points + vertices,
        "node_face": points + vertices,
    }
    return Faces(*(columns.integers(sizes[name]) for name in Faces._fields))
