"""The straight skeleton of a planar graph, on the whole plane.

``straight_skeleton(points, edges)`` -> ``StraightSkeleton``; ``Solver`` for many placements of one graph.
Source: Aichholzer and Aurenhammer, "Straight Skeletons for General Polygonal Figures", 1996.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from time import process_time
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from foldcut.core.arrays import Floats, Indices, Ints, Ragged, index_array, sealed
from foldcut.core.compiled import COMPILED, compiled_copy, is_installed, is_ready
from foldcut.geometry.straight_skeleton import wavefront
from foldcut.geometry.straight_skeleton.graph import Graph, graph_of
from foldcut.geometry.straight_skeleton.tables import Arrays, Columns, Faces, Front, Lists, Sides, faces_of, front_of

__all__ = ["Solver", "StraightSkeleton", "straight_skeleton"]

SPARE = 3
"""For how many new vertices of the wavefront there is room, for each side."""

PATIENCE = 1.0
"""After so many seconds of the processor without it, compiled code is loaded, which takes about half as long."""


@dataclass(frozen=True, eq=False)
class StraightSkeleton:
    """The straight skeleton of a graph.

    ``nodes`` ``(k, 2)``: the first n are the graph's points. ``time`` ``(k,)``: how far each is from the lines of its
    sides. ``arcs`` ``(a, 2)``: the nodes where an arc starts and ends, -1 where it goes on for ever; ``arc_sides``
    ``(a, 2)``: the sides on its left and its right, as the wavefront moves; ``arc_velocity`` ``(a, 2)``: while t goes
    from ``time[start]`` to ``time[end]`` the wavefront's vertex is at ``nodes[start] + (t - time[start]) * velocity``.
    Where two sides come to lie on each other face to face, the arc between them is level, with velocity 0.
    ``face_nodes``: the nodes of each side's face, counter-clockwise: the side's tail, its head, and so on; -1 stands for
    the infinite. A cap has its point only once.
    """

    graph: Graph
    nodes: Floats
    time: Floats
    arcs: Indices
    arc_sides: Indices
    arc_velocity: Floats
    face_nodes: Ragged

    def face(self, side: int) -> Ints:
        """Return the nodes of a side's face, counter-clockwise from its tail; -1 stands for the infinite."""
        return self.face_nodes[side]

    @cached_property
    def sides_of_nodes(self) -> Ragged:
        """The sides whose faces have a node, for each node."""
        order = np.argsort(self.face_nodes.values, kind="stable")
        order = order[self.face_nodes.values[order] >= 0]
        count = np.bincount(self.face_nodes.values[order], minlength=len(self.nodes))
        return Ragged(sealed(self.face_nodes.rows[order]), index_array(np.concatenate([[0], np.cumsum(count)])))

    def node_sides(self, node: int) -> Ints:
        """Return the sides whose faces have a node, in ascending order."""
        return self.sides_of_nodes[node]

    def node_contours(self, node: int) -> Indices:
        """Return the contours of a node's sides, in ascending order; several where parts of the graph meet."""
        contours: Indices = np.unique(self.graph.side_contour[self.node_sides(node)])
        return contours


def straight_skeleton(points: ArrayLike, edges: ArrayLike, *, columns: Columns | None = None) -> StraightSkeleton:
    """Return the straight skeleton of the graph of edges ``(m, 2)`` between points ``(n, 2)``.

    ``columns``: where the work is done, ``Arrays()`` or ``Lists()``; the bits are the same.
    Raises ``ValueError`` with the place where points and edges are no planar graph.
    """
    return Solver(graph_of(points, edges), columns).solve_one()


class Solver:
    """Makes the straight skeletons of one graph with its points at many places.

    ``columns``: where the work is done: ``Arrays()`` (compiled; ``ImportError`` without the extra ``fast``), ``Lists()``
    (plain Python), or what is faster for the time that this process has spent on skeletons so far. The bits are the
    same. A solver is for one thread at a time.
    """

    def __init__(self, graph: Graph, columns: Columns | None = None) -> None:
        self.graph = graph
        self.choice = columns
        self.columns: Columns = Lists()
        self.room = 0
        self.front: Front
        self.faces: Faces
        self.sides: Sides

    def solve(self, candidates: ArrayLike) -> list[StraightSkeleton]:
        """Return the skeleton for each of the candidates ``(c, n, 2)``: places of all points."""
        return [self.solve_one(points) for points in np.asarray(candidates, dtype=np.float64)]

    def solve_one(self, points: Any = None) -> StraightSkeleton:
        """Return the skeleton of the graph, with its points at other places ``(n, 2)`` if these are given.

        Edges must not cross there, which is not checked.
        """
        graph = self.graph if points is None else self.graph.moved_to(points)
        columns = self.choice or DEFAULT.columns()
        if not self.room or columns.compiled != self.columns.compiled:
            self._make_room(columns, graph.side_count * (1 + SPARE) + 16)
        kernel: Any = compiled_copy(wavefront) if columns.compiled else wavefront
        started = 0.0 if columns.compiled else process_time()
        # a frame in which coordinates are within -1 and 1, a power of two smaller or larger, so nothing is rounded
        low, high = graph.points.min(axis=0), graph.points.max(axis=0)
        middle = (low + high) / 2
        scale = 2.0 ** math.frexp(float((high - low).max()))[1]
        local = (graph.points - middle) / scale
        noise = 2.0**-52 * max(1.0, float(np.abs(graph.points).max()) / scale)
        x, y = local.T
        xs, ys = (np.ascontiguousarray(x), np.ascontiguousarray(y)) if columns.compiled else (x.tolist(), y.tolist())
        while True:
            status = kernel.run(self.front, self.sides, xs, ys, noise)
            if status == wavefront.DONE and kernel.gather_faces(self.front, self.sides, self.faces):
                break
            if status != wavefront.NO_ROOM:
                raise ArithmeticError("the straight skeleton does not come to an end: a fault of this program")
            self._make_room(columns, 2 * self.room)
        if not columns.compiled:
            DEFAULT.spent += process_time() - started
        return self._result(graph, middle, scale)

    def _make_room(self, columns: Columns, room: int) -> None:
        graph = self.graph
        count = graph.side_count
        cells = 1 if count <= wavefront.FEW else 2 * math.isqrt(room // (1 + SPARE)) + 2
        self.columns, self.room = columns, room
        self.front = front_of(columns, count, len(graph.points), room, cells)
        self.faces = faces_of(columns, count, len(graph.points), room)
        lists = (graph.tail, graph.head, graph.following, graph.source)
        self.sides = Sides(*lists) if columns.compiled else Sides(*(array.tolist() for array in lists))

    def _result(self, graph: Graph, middle: Floats, scale: float) -> StraightSkeleton:
        front, faces = self.front, self.faces
        arcs, nodes = front.counts[wavefront.ARCS], front.counts[wavefront.NODES]
        filled = faces.offsets[graph.side_count]
        ends = np.array([front.arc_start[:arcs], front.arc_end[:arcs]], dtype=np.intp)
        sides = np.array([front.arc_left[:arcs], front.arc_right[:arcs]], dtype=np.intp)
        velocity = np.array([front.arc_vx[:arcs], front.arc_vy[:arcs]])
        kept = np.flatnonzero(ends[0] != ends[1])
        if len(kept) < arcs:
            ends, sides, velocity = ends[:, kept], sides[:, kept], velocity[:, kept]
        places = np.array([front.node_x[:nodes], front.node_y[:nodes]]).T * scale + middle
        time = np.array(front.node_time[:nodes]) * scale
        values = np.array(faces.values[:filled], dtype=np.intp)
        same = np.array(front.same_as[:nodes], dtype=np.intp)
        numbers = np.arange(nodes)
        if (same != numbers).any():
            unique = same == numbers
            place = np.append(np.cumsum(unique) - 1, -1)  # -1 stays -1
            places, time, ends, values = places[unique], time[unique], place[ends], place[values]
        places[: len(graph.points)] = graph.points
        return StraightSkeleton(
            graph,
            sealed(places),
            sealed(time),
            sealed(np.ascontiguousarray(ends.T)),
            sealed(np.ascontiguousarray(sides.T)),
            sealed(np.ascontiguousarray(velocity.T)),
            Ragged(sealed(values.astype(np.int32)), index_array(faces.offsets[: graph.side_count + 1])),
        )


class Default:
    """Where the work is done if nobody says: in lists at first, and in compiled code once it has been worth loading.

    Compiled code is only used if it is in numba's cache (``foldcut compile`` puts it there), so nobody waits for the
    compiler.
    """

    def __init__(self) -> None:
        self.spent = 0.0
        self.made: Columns = Lists()
        self.is_decided = False
        self.lock = threading.Lock()

    def columns(self) -> Columns:
        """Return what to use now."""
        if not self.is_decided and (COMPILED.many_drawings or self.spent > PATIENCE):
            with self.lock:
                self.is_decided = True
                if is_installed() and is_ready(compiled_copy(wavefront).run):
                    self.made = Arrays()
        return self.made


DEFAULT = Default()
"""The choice of this process."""
