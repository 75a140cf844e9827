"""A straight skeleton that follows small movements of its graph's points.

``StraightSkeleton``, points and their new places -> ``StraightSkeleton``. ``motion`` does the work.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from foldcut.core.arrays import Floats, Indices, sealed
from foldcut.core.compiled import compiled_copy, forget_unreadable, is_ready
from foldcut.geometry.straight_skeleton import motion
from foldcut.geometry.straight_skeleton import skeleton as skeletons
from foldcut.geometry.straight_skeleton.frame import Frame
from foldcut.geometry.straight_skeleton.graph import Graph, graph_of
from foldcut.geometry.straight_skeleton.skeleton import DEFAULT, Solver, StraightSkeleton, fields
from foldcut.geometry.straight_skeleton.tables import Arrays, Lists, Tables

__all__ = ["MovingSkeleton", "compile_ahead"]


class MovingSkeleton:
    """The straight skeleton of a graph whose points move by little.

    ``start``: a graph, or its skeleton. ``tables``: where the work is done, as for ``Solver``; the bits are the same.
    A moving skeleton is for one thread at a time.
    """

    points: Floats
    """Where the points are now, ``(n, 2)``; they are moved by ``move`` only."""

    _start: StraightSkeleton  # as it was made last
    _now: StraightSkeleton | None  # as it is now, if somebody has asked

    def __init__(self, start: Graph | StraightSkeleton, tables: Tables | None = None) -> None:
        if tables is None:
            tables = DEFAULT.tables()
            if tables.compiled and not is_ready(compiled_copy(motion).move):
                tables = Lists()
        self.tables = tables
        self.kernel: Any = compiled_copy(motion) if tables.compiled else motion
        self._set(start if isinstance(start, StraightSkeleton) else Solver(start, tables).solve_one())

    def move(self, points: ArrayLike, places: ArrayLike) -> bool:
        """Move some points ``(k,)`` to places ``(k, 2)``; return whether the skeleton is the same but for its places.

        If it is, only the nodes and faces beside the movement were computed again. If not, or where rounding leaves
        that open, all of it was made again, and nodes and arcs have new numbers. Raises ``IndexError`` for a point that
        is not there, ``ValueError`` if there are not as many places or if edges come to cross; then nothing has moved.
        """
        # new arrays: for those that are read-only or have gaps, numba would have to compile once more
        numbers: Any = np.array(points, dtype=np.int64).ravel()
        flat: Any = np.array(places, dtype=np.float64).ravel()
        count = len(numbers)
        if len(flat) != 2 * count:
            raise ValueError(f"there are {count} points to be moved, but {len(flat) / 2:g} places")
        if not self.tables.compiled:
            numbers, flat = numbers.tolist(), flat.tolist()
        status = self.kernel.move(self.motion, numbers, flat, count)
        if status == motion.NO_POINT:
            raise IndexError(f"a point is not one of the {len(self.points)} that there are")
        old = self.points if status == motion.STAYED else self.points.copy()
        self.points[numbers] = np.reshape(flat, (count, 2))
        if status == motion.STAYED:
            self._now = None
            return True
        self._make_again(old)
        return False

    @property
    def skeleton(self) -> StraightSkeleton:
        """The skeleton with the points where they are now."""
        if self._now is None:
            self._now = self._result()
        return self._now

    @property
    def computed(self) -> tuple[int, int]:
        """How many nodes and faces the last movement looked at, unless it made everything again."""
        counts = self.motion.counts
        return int(counts[motion.NODES_MOVED]), int(counts[motion.FACES_SEEN])

    def _make_again(self, old: Floats) -> None:
        """Make the skeleton from the points; if that fails, from the old ones."""
        edges = self._start.graph.edges
        try:
            self._set(Solver(graph_of(self.points, edges), self.tables).solve_one())
        except (ArithmeticError, ValueError):
            self._set(Solver(self._start.graph.moved_to(old), self.tables).solve_one())
            raise

    def _set(self, skeleton: StraightSkeleton) -> None:
        """Put a skeleton into the tables."""
        self._start = skeleton
        self._now = skeleton
        graph, faces = skeleton.graph, skeleton.face_nodes
        self.points = graph.points.copy()
        self.frame = frame = Frame(graph.points)
        count, sides, nodes = len(graph.points), graph.side_count, len(skeleton.nodes)
        ends = np.concatenate([graph.tail[graph.source], graph.head[graph.source]])
        at_points = np.argsort(ends, kind="stable")
        self.motion = made = motion.room_for(
            self.tables, count, sides, nodes, len(skeleton.arcs), len(faces.values), len(at_points)
        )
        first = np.concatenate([[0], np.cumsum(np.bincount(ends, minlength=count))])
        _fill(made.points, x=frame.x, y=frame.y, first=first)
        _fill(made.sides, tail=graph.tail, head=graph.head, source=graph.source, first=faces.offsets)
        x, y = (skeleton.nodes - frame.middle).T / frame.scale
        _fill(made.nodes, x=x, y=y, time=skeleton.time / frame.scale, first=skeleton.sides_of_nodes.offsets)
        is_level = (skeleton.arc_velocity == 0).all(axis=1)
        (start, end), (left, right) = skeleton.arcs.T, skeleton.arc_sides.T
        _fill(made.arcs, start=start, end=end, left=left, right=right, is_level=is_level)
        _fill(made.steps, node=faces.values, arc=_arcs_of_outlines(skeleton))
        for column, values in (
            (made.point_sides, at_points % sides),
            (made.node_sides, skeleton.sides_of_nodes.values),
            (made.counts, [0] * motion.POINTS + [count]),
            (made.numbers, [frame.noise, *frame.middle, frame.scale]),
        ):
            column[: len(values)] = values if self.tables.compiled else np.asarray(values).tolist()
        self.kernel.prepare(made)

    def _result(self) -> StraightSkeleton:
        start, frame = self._start, self.frame
        self.kernel.set_velocities(self.motion)
        x, y, time, moved = fields(self.motion.nodes, len(start.nodes), "x y time moved")
        places = np.stack([x, y], axis=1) * frame.scale + frame.middle
        places = np.where(moved[:, None] > 0, places, start.nodes)
        places[: len(self.points)] = self.points
        return StraightSkeleton(
            start.graph.moved_to(self.points),
            sealed(places),
            sealed(np.where(moved > 0, time * frame.scale, start.time)),
            start.arcs,
            start.arc_sides,
            sealed(np.stack(fields(self.motion.arcs, len(start.arcs), "vx vy"), axis=1)),
            start.face_nodes,
        )


def _fill(table: Any, **columns: ArrayLike) -> None:
    """Write the first entries of some fields of a table."""
    for name, values in columns.items():
        column = np.asarray(values)
        if isinstance(table, np.ndarray):
            table[name][: len(column)] = column
        else:
            for row, value in zip(table, column.tolist(), strict=False):
                setattr(row, name, value)


def _arcs_of_outlines(skeleton: StraightSkeleton) -> Indices:
    """Return the arc from each node of the faces to the next, -1 for the sides themselves."""
    faces, nodes = skeleton.face_nodes, len(skeleton.nodes)
    node, side = faces.values.astype(np.intp), faces.rows.astype(np.intp)
    (start, end), (left, right) = skeleton.arcs.T, skeleton.arc_sides.T
    number = np.arange(len(start))
    # a step is known by its face and the node where it starts, or, if it comes from the infinite, where it ends
    comes = np.where(end < 0, start + nodes, end)
    known = np.concatenate([left * 2 * nodes + start, right * 2 * nodes + comes])
    order = np.argsort(known)
    arcs = np.concatenate([number, number])[order]
    wanted = side * 2 * nodes + np.where(node < 0, node[faces.following] + nodes, node)
    place = np.minimum(np.searchsorted(known[order], wanted), len(order) - 1)
    found: Indices = np.where(known[order][place] == wanted, arcs[place], -1)
    return found


def compile_ahead() -> None:
    """Compile all that straight skeletons have to be compiled, and keep it in numba's cache.

    It takes about half a minute of the processor, or a second if that was done before.
    """
    skeletons.compile_ahead()
    forget_unreadable(compiled_copy(motion))
    moving = MovingSkeleton(graph_of([(0, 0), (1, 0), (0, 1)], [(0, 1), (1, 2), (2, 0)]), Arrays())
    moving.move(0, (-0.5, 0))
    moving._result()
