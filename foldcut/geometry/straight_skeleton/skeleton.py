"""The straight skeleton of a planar graph, on the whole plane.

``straight_skeleton(points, edges)`` -> ``StraightSkeleton``; ``Solver`` for many placements of one graph.
Source: Aichholzer and Aurenhammer, "Straight Skeletons for General Polygonal Figures", 1996.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property
from time import process_time
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from foldcut.core.arrays import Floats, Indices, Ints, Ragged, index_array, sealed
from foldcut.core.compiled import COMPILED, compiled_copy, forget_unreadable, is_ready
from foldcut.geometry.straight_skeleton import wavefront
from foldcut.geometry.straight_skeleton.decimals import ZERO, decimal_copy
from foldcut.geometry.straight_skeleton.decimals import run_with_decimals as run_decimal
from foldcut.geometry.straight_skeleton.frame import Frame
from foldcut.geometry.straight_skeleton.graph import Graph, graph_of
from foldcut.geometry.straight_skeleton.tables import Arrays, Graphs, Lists, Tables, faces_of, front_of

__all__ = ["Solver", "StraightSkeleton", "compile_ahead", "straight_skeleton"]

SPARE = 3
"""For how many new vertices of the wavefront there is room, for each side."""

MOST_DECIMAL = 500
"""Graphs with more sides are not computed once more with decimals, unless doubles fail: it takes more than a second."""

MOST_DECIMAL_IF_WRONG = 3000
"""The same where a face is seen to be wrong; it takes up to half a minute."""

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
    ``face_nodes``: the nodes of each side's face, counter-clockwise: the side's tail, its head, and so on; -1 stands
    for the infinite. A cap has its point only once.
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


def straight_skeleton(points: ArrayLike, edges: ArrayLike, *, tables: Tables | None = None) -> StraightSkeleton:
    """Return the straight skeleton of the graph of edges ``(m, 2)`` between points ``(n, 2)``.

    ``tables``: where the work is done, ``Arrays()`` or ``Lists()``; the bits are the same.
    Raises ``ValueError`` with the place where points and edges are no planar graph.
    """
    return Solver(graph_of(points, edges), tables).solve_one()


class Solver:
    """Makes the straight skeletons of one graph with its points at many places.

    ``tables``: where the work is done: ``Arrays()`` (compiled), ``Lists()``
    (plain Python), or what is faster for the time that this process has spent on skeletons so far. The bits are the
    same. A solver is for one thread at a time.
    """

    def __init__(self, graph: Graph, tables: Tables | None = None) -> None:
        self.graph = graph
        self.choice = tables
        self.workspace: Workspace | None = None

    def solve(self, candidates: ArrayLike) -> list[StraightSkeleton]:
        """Return the skeleton for each of the candidates ``(c, n, 2)``: places of all points."""
        return [self.solve_one(points) for points in np.asarray(candidates, dtype=np.float64)]

    def solve_one(self, points: Any = None) -> StraightSkeleton:
        """Return the skeleton of the graph, with its points at other places ``(n, 2)`` if these are given.

        Edges must not cross there, which is not checked.
        """
        graph = self.graph if points is None else self.graph.moved_to(points)
        tables = self.choice or DEFAULT.tables()
        if self.workspace is None or self.workspace.tables is not tables:
            self.workspace = Workspace(graph, tables)
        started = 0.0 if tables.compiled else process_time()
        frame, workspace = Frame(graph.points), self.workspace
        if not workspace.run(frame.x, frame.y, frame.noise) or workspace.wants_decimals:
            workspace = Workspace(graph, Lists(ZERO))
            if not workspace.run_with_decimals(frame):
                raise ArithmeticError("the straight skeleton does not come to an end: a fault of this program")
        if not tables.compiled:
            DEFAULT.spent += process_time() - started
        return workspace.result(graph, frame)


class Workspace:
    """The tables for a graph, which its skeletons use one after the other."""

    def __init__(self, graph: Graph, tables: Tables) -> None:
        self.graph = graph
        self.tables = tables
        self.kernel: Any = compiled_copy(wavefront) if tables.compiled else wavefront
        if isinstance(tables, Lists) and tables.zero is ZERO:
            self.kernel = decimal_copy()
        lists = (graph.tail, graph.head, graph.following, graph.source)
        self.sides = Graphs(*lists) if tables.compiled else Graphs(*(array.tolist() for array in lists))
        self._make_room(graph.side_count * (1 + SPARE) + 16)

    def _make_room(self, room: int) -> None:
        count, points = self.graph.side_count, len(self.graph.points)
        cells = 1 if count <= wavefront.FEW else 2 * math.isqrt(room // (1 + SPARE)) + 2
        self.room = room
        self.front = front_of(self.tables, count, points, room, cells)
        self.faces = faces_of(self.tables, count, points, room)

    @property
    def wants_decimals(self) -> bool:
        """Whether doubles may have been too coarse, and decimals do not take too long."""
        counts, count = self.front.counts, self.graph.side_count
        most = MOST_DECIMAL_IF_WRONG if counts[wavefront.WRONG_FACES] else MOST_DECIMAL
        return count <= most and bool(counts[wavefront.WRONG_FACES] or counts[wavefront.UNSURE])

    def run(self, x: Any, y: Any, noise: float) -> bool:
        """Move the wavefront to its end and make the faces; return whether that could be done."""
        if not self.tables.compiled:
            x, y = x.tolist(), y.tolist()
        while (status := self.kernel.run(self.front, self.sides, x, y, noise)) == wavefront.NO_ROOM:
            self._make_room(2 * self.room)
        return bool(status == wavefront.DONE and self.kernel.gather_faces(self.front, self.sides, self.faces))

    def run_with_decimals(self, frame: Frame) -> bool:
        """Do as ``run``, with decimal numbers; nodes that are the same for doubles are joined at the end."""
        for near in (8 * Decimal(frame.noise), ZERO):
            while (status := run_decimal(self.front, self.sides, frame)) == wavefront.NO_ROOM:
                self._make_room(2 * self.room)
            self.kernel.join_near_nodes(self.front, near)
            if status == wavefront.DONE and self.kernel.gather_faces(self.front, self.sides, self.faces):
                return True
        return False

    def result(self, graph: Graph, frame: Frame) -> StraightSkeleton:
        """Return the skeleton that was made last."""
        counts = self.front.counts
        arcs = fields(self.front.arcs, counts[wavefront.ARCS], "start end left right vx vy")
        nodes = fields(self.front.nodes, counts[wavefront.NODES], "x y time same_as")
        (offsets,) = fields(self.faces.sides, graph.side_count + 1, "offset")
        (values,) = fields(self.faces.items, offsets[-1], "value")
        ends, sides, velocity = np.stack(arcs[:2]), np.stack(arcs[2:4]), np.stack(arcs[4:])
        kept = np.flatnonzero(ends[0] != ends[1])
        if len(kept) < ends.shape[1]:
            ends, sides, velocity = ends[:, kept], sides[:, kept], velocity[:, kept]
        places, time, same = np.stack(nodes[:2], axis=1) * frame.scale + frame.middle, nodes[2] * frame.scale, nodes[3]
        numbers = np.arange(len(same))
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
            Ragged(sealed(values.astype(np.int32)), index_array(offsets)),
        )


def fields(table: Any, count: int, names: str) -> list[Any]:
    """Return the first entries of some fields of a table, each as a new array."""
    if isinstance(table, np.ndarray):
        return [table[name][:count].copy() for name in names.split()]
    columns = [np.array([getattr(row, name) for row in table[:count]]) for name in names.split()]
    return [column.astype(np.float64) if column.dtype == object else column for column in columns]


class Default:
    """Where the work is done if nobody says: in lists at first, and in compiled code once it has been worth loading.

    Compiled code is only used if it is in numba's cache (``foldcut compile`` puts it there), so nobody waits for the
    compiler.
    """

    def __init__(self) -> None:
        self.spent = 0.0
        self.made: Tables = Lists()
        self.is_decided = False

    def tables(self) -> Tables:
        """Return what to use now."""
        if not self.is_decided and (COMPILED.many_drawings or self.spent > PATIENCE):
            self.is_decided = True
            kernel: Any = compiled_copy(wavefront)
            if is_ready(kernel.run) and is_ready(kernel.gather_faces):
                self.made = Arrays()
        return self.made

    def use_compiled(self) -> None:
        """Use compiled code from now on: it has been loaded for something else."""
        self.made, self.is_decided = Arrays(), True


DEFAULT = Default()
"""The choice of this process."""


def use_compiled() -> None:
    """Let this process make all skeletons in compiled code from now on."""
    DEFAULT.use_compiled()


def compile_ahead() -> None:
    """Compile the wavefront and keep it in numba's cache.

    It takes about 20 s of the processor, or a second if that was done before.
    """
    forget_unreadable(compiled_copy(wavefront))
    straight_skeleton([(0, 0), (1, 0), (0, 1)], [(0, 1), (1, 2), (2, 0)], tables=Arrays())
