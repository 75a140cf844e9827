"""The straight skeleton of a graph that has changed in a few places: only the faces near these are made again.

``StraightSkeleton`` and what has changed -> ``UpdatedSkeleton``.

The sides at points that have changed, and those whose faces share a node with theirs, are the *core*. The skeleton of
the edges near it is made, and of it only the faces of the core are used. If the arcs between the core and all other
sides are the same as before, then the new faces of the core and the old faces of all others fit together and cover the
plane; all of them are faces of a wavefront of their sides, so it is the skeleton. Otherwise more edges are taken, and
then a larger core, until it is half of all sides; then all is made again.

A skeleton of 60 corners is made anew by compiled code in less time than this takes; in plain Python this is faster.
Source: Aichholzer and Aurenhammer, "Straight Skeletons for General Polygonal Figures", 1996 (a skeleton is known by its
faces: each arc is on the bisector of the two sides that it is between).
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from foldcut.core.arrays import Bools, Floats, Indices, Numbers, Ragged, index_array, sealed
from foldcut.geometry.straight_skeleton.graph import Graph, graph_of
from foldcut.geometry.straight_skeleton.skeleton import Solver, StraightSkeleton
from foldcut.geometry.straight_skeleton.tables import Tables

__all__ = ["UpdatedSkeleton", "with_corner", "with_points", "without_corner"]

NEAR = 2.0**-40
"""Nodes this near to each other are the same: in parts of the size of the graph and of their times."""


@dataclass(frozen=True, eq=False)
class UpdatedSkeleton(StraightSkeleton):
    """A straight skeleton, and how it was made from an older one.

    ``made_again`` ``(j,)``: the sides whose faces were made again. ``work``: how many sides there were in all graphs
    whose skeletons were made for that.
    """

    made_again: Indices
    work: int


def with_points(skeleton: StraightSkeleton, points: ArrayLike, *, tables: Tables | None = None) -> UpdatedSkeleton:
    """Return the skeleton of the graph with its points at other places ``(n, 2)``.

    ``tables``: where the work is done, as for ``Solver``. Raises ``ValueError``, which says where, if edges come to
    cross or points to coincide.
    """
    old = skeleton.graph
    points = np.array(points, dtype=np.float64)
    if points.shape != old.points.shape:
        raise ValueError(f"the graph has {len(old.points)} points, but {len(points)} places were given")
    return _updated(skeleton, graph_of(points, old.edges), np.arange(len(points)), tables)


def with_corner(
    skeleton: StraightSkeleton, edge: int, place: ArrayLike, *, tables: Tables | None = None
) -> UpdatedSkeleton:
    """Return the skeleton of the graph with one more point, at a place ``(2,)``, on an edge.

    The edge from a to b becomes the edge from a to the new point; the edge from there to b is the last edge, and the
    point the last point. ``tables`` and errors are as for ``with_points``; ``IndexError`` if there is no such edge.
    """
    old = skeleton.graph
    new = len(old.points)
    if not 0 <= edge < len(old.edges):
        raise IndexError(f"edge {edge} is not one of the {len(old.edges)} that there are")
    edges = np.concatenate([old.edges, [(new, old.edges[edge, 1])]])
    edges[edge, 1] = new
    points = np.concatenate([old.points, np.asarray(place, dtype=np.float64).reshape(1, 2)])
    return _updated(skeleton, graph_of(points, edges), np.arange(new), tables)


def without_corner(skeleton: StraightSkeleton, point: int, *, tables: Tables | None = None) -> UpdatedSkeleton:
    """Return the skeleton of the graph without a point that has two edges, which become one.

    The first of the two keeps its number and its direction, and reaches to the other end of the second. The numbers of
    all later edges and points become smaller by one. It takes back what ``with_corner`` has done. ``tables`` and errors
    are as for ``with_points``; ``IndexError`` if there is no such point, ``ValueError`` if it has not two edges.
    """
    old = skeleton.graph
    if not 0 <= point < len(old.points):
        raise IndexError(f"point {point} is not one of the {len(old.points)} that there are")
    at = np.flatnonzero((old.edges == point).any(axis=1))
    if len(at) != 2:
        raise ValueError(f"point {point} has {len(at)} edges; only a point with two can be taken out")
    first, second = at.tolist()
    edges = old.edges.copy()
    edges[first][edges[first] == point] = edges[second].sum() - point
    edges = np.delete(edges, second, axis=0)
    number = np.arange(len(old.points))
    number[point:] -= 1
    graph = graph_of(np.delete(old.points, point, axis=0), number[edges])
    number[point] = -1
    return _updated(skeleton, graph, number, tables)


def _updated(old: StraightSkeleton, graph: Graph, number: Indices, tables: Tables | None) -> UpdatedSkeleton:
    """Return the skeleton of a graph; ``number`` ``(n,)``: the points of the old graph in the new one, -1 for none."""
    new_side, core = _changed_sides(old.graph, graph, number)
    work = 0
    around = core = _with_neighbours(old, core)
    while core.any() and 2 * core.sum() <= old.graph.side_count:
        around = _with_neighbours(old, around)
        in_core = np.ones(graph.side_count, dtype=bool)
        in_core[new_side[~core]] = False
        near = in_core.copy()
        near[new_side[around & (new_side >= 0)]] = True
        part, side = _part(graph, near, tables)
        merged = _merged(old, graph, number, new_side, core, part, side, in_core)
        if merged is not None:
            return UpdatedSkeleton(graph, *merged, sealed(np.flatnonzero(in_core)), work + len(side))
        if work:  # at first, more of what is around may be enough
            core = _with_neighbours(old, core)
        work += len(side)
    new, made = (Solver(graph, tables).solve_one(), graph.side_count) if core.any() else (old, 0)
    return UpdatedSkeleton(
        graph,
        new.nodes,
        new.time,
        new.arcs,
        new.arc_sides,
        new.arc_velocity,
        new.face_nodes,
        sealed(np.arange(made)),
        work + made,
    )


def _changed_sides(old: Graph, new: Graph, number: Indices) -> tuple[Indices, Bools]:
    """Return the numbers of the old sides in the new graph, -1 for none, and which of them are gone or have moved.

    What else changes are the sides that follow these, and the caps of edges of which the other end has moved; they
    share a node with a side that has moved.
    """
    count = len(new.points)
    tail, head = number[old.tail], number[old.head]
    known = new.tail * count + new.head
    order = np.argsort(known)
    wanted = tail * count + head
    place = np.minimum(np.searchsorted(known[order], wanted), len(order) - 1)
    is_there = (tail >= 0) & (head >= 0) & (known[order][place] == wanted)
    has_moved = number < 0
    has_moved[~has_moved] = (old.points[~has_moved] != new.points[number[~has_moved]]).any(axis=1)
    return np.where(is_there, order[place], -1), ~is_there | has_moved[old.tail] | has_moved[old.head]


def _with_neighbours(skeleton: StraightSkeleton, sides: Bools) -> Bools:
    """Return these sides and those whose faces share a node with theirs."""
    faces = skeleton.face_nodes
    at = np.zeros(len(skeleton.nodes) + 1, dtype=bool)
    at[faces.values[sides[faces.rows]]] = True
    at[-1] = False  # the infinite
    found = sides.copy()
    found[faces.rows[at[faces.values]]] = True
    return found


def _part(graph: Graph, near: Bools, tables: Tables | None) -> tuple[StraightSkeleton, Indices]:
    """Return the skeleton of the edges of some sides, and the number of each of its sides in the graph.

    Caps that the graph has not have the number -1.
    """
    chosen = np.zeros(len(graph.edges), dtype=bool)
    chosen[graph.source[near] >> 1] = True
    edges = np.flatnonzero(chosen)
    points, ends = np.unique(graph.edges[edges], return_inverse=True)
    part = Solver(graph_of(graph.points[points], ends.reshape(-1, 2)), tables).solve_one()
    caps = np.full(len(graph.points), -1)
    first = 2 * len(graph.edges)
    caps[graph.tail[first:]] = np.arange(first, graph.side_count)
    side = np.concatenate(
        [2 * np.repeat(edges, 2) + np.tile([0, 1], len(edges)), caps[points[part.graph.tail[2 * len(edges) :]]]]
    )
    return part, side


def _merged(
    old: StraightSkeleton,
    graph: Graph,
    number: Indices,
    new_side: Indices,
    core: Bools,
    part: StraightSkeleton,
    side: Indices,
    in_core: Bools,
) -> tuple[Floats, Floats, Indices, Indices, Floats, Ragged] | None:
    """Return nodes, time, arcs, sides of arcs, velocities and faces: of the part in the core, of the old one elsewhere.

    ``core`` says which old sides are in it, ``in_core`` which new ones. Returns None if they do not fit together.
    """
    of_part = (side >= 0) & in_core[side]
    inside, inside_part = core[old.arc_sides], of_part[part.arc_sides]
    border, border_part = (np.flatnonzero(both[:, 0] != both[:, 1]) for both in (inside, inside_part))
    same = _same_nodes(old, border, new_side, part, border_part, side)
    if same is None:
        return None
    points = len(graph.points)
    kept = np.flatnonzero(~core)
    made = np.flatnonzero(of_part)
    old_faces, part_faces = old.face_nodes.take(kept), part.face_nodes.take(made)
    # the new numbers of the old nodes and of the part's; the last place is for the infinite
    of_old = _numbers(old_faces.values, len(old.nodes), len(old.graph.points), points)
    of_old[: len(number)] = number
    of_new = np.full(len(part.nodes) + 1, -1)
    own = np.unique(graph.edges[side[: 2 * len(part.graph.edges) : 2] >> 1])
    of_new[: len(own)] = own
    of_new[list(same)] = of_old[list(same.values())]
    last = int(of_old.max(initial=points - 1)) + 1
    fresh = np.unique(part_faces.values[part_faces.values >= 0])
    fresh = fresh[of_new[fresh] < 0]
    of_new[fresh] = np.arange(last, last + len(fresh))
    nodes, time = np.empty((last + len(fresh), 2)), np.zeros(last + len(fresh))
    used = np.flatnonzero(of_old[:-1] >= points)
    nodes[of_old[used]], time[of_old[used]] = old.nodes[used], old.time[used]
    nodes[of_new[fresh]], time[of_new[fresh]] = part.nodes[fresh], part.time[fresh]
    nodes[:points] = graph.points

    arcs, arcs_part = np.flatnonzero(~inside.all(axis=1)), np.flatnonzero(inside_part.all(axis=1))
    values = np.concatenate([of_old[old_faces.values], of_new[part_faces.values]])
    offsets = np.concatenate([old_faces.offsets, part_faces.offsets[1:] + old_faces.offsets[-1]])
    faces = Ragged(index_array(values), index_array(offsets))
    return (
        sealed(nodes),
        sealed(time),
        sealed(np.concatenate([of_old[old.arcs[arcs]], of_new[part.arcs[arcs_part]]])),
        sealed(np.concatenate([new_side[old.arc_sides[arcs]], side[part.arc_sides[arcs_part]]])),
        sealed(np.concatenate([old.arc_velocity[arcs], part.arc_velocity[arcs_part]])),
        faces.take(np.argsort(np.concatenate([new_side[kept], side[made]]))),
    )


def _numbers(used: Numbers, count: int, points: int, first: int) -> Indices:
    """Return new numbers from ``first`` on for those of the nodes after the points that are used; -1 for others."""
    is_used = np.zeros(count + 1, dtype=bool)
    is_used[used] = True
    is_used[:points] = is_used[-1] = False
    return np.where(is_used, first - 1 + np.cumsum(is_used), -1)


def _same_nodes(
    old: StraightSkeleton,
    border: Indices,
    new_side: Indices,
    part: StraightSkeleton,
    border_part: Indices,
    side: Indices,
) -> dict[int, int] | None:
    """Return for each node of some arcs of a part the node of the old skeleton, if these have the same arcs.

    Returns None if there is an arc, between two sides and from one place to another, that is only in one of them.
    """
    if len(border) != len(border_part):
        return None
    waiting: defaultdict[tuple[int, int], list[tuple[int, int]]] = defaultdict(list)
    for arc, sides in zip(border.tolist(), new_side[old.arc_sides[border]].tolist(), strict=True):
        start, end = old.arcs[arc].tolist()
        waiting[sides[0], sides[1]].append((start, end))
        if not old.arc_velocity[arc].any():  # level arcs have no direction
            waiting[sides[1], sides[0]].append((end, start))
    size = float(np.ptp(old.graph.points, axis=0).max() + np.abs(old.graph.points).max())
    same: dict[int, int] = {}
    taken: dict[int, int] = {}
    for arc, sides in zip(border_part.tolist(), side[part.arc_sides[border_part]].tolist(), strict=True):
        start, end = part.arcs[arc].tolist()
        for ends in waiting[sides[0], sides[1]]:
            if all(
                (one < 0 and other < 0)
                or (
                    one >= 0
                    and other >= 0
                    and np.abs(part.nodes[one] - old.nodes[other]).max() <= NEAR * (size + old.time[other])
                    and abs(part.time[one] - old.time[other]) <= NEAR * (size + old.time[other])
                )
                for one, other in zip((start, end), ends, strict=True)
            ):
                break
        else:
            return None
        for one, other in zip((start, end), ends, strict=True):
            if one >= 0 and (same.setdefault(one, other) != other or taken.setdefault(other, one) != one):
                return None
    return same
