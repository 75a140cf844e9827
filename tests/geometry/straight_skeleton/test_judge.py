"""The judge of straight skeletons finds what is wrong: each of its rules can fail."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from support.planar_graphs import of_loops, of_paths
from support.skeleton_cases import CASES
from support.skeleton_judge import judge

from foldcut.core.arrays import Ragged
from foldcut.geometry.straight_skeleton import StraightSkeleton, straight_skeleton

L = straight_skeleton(*CASES["L"])
RECTANGLE = straight_skeleton(*CASES["rectangle"])


def moved(node: int, x: float, y: float, later: float = 0.0) -> StraightSkeleton:
    nodes, time = L.nodes.copy(), L.time.copy()
    nodes[node] += x, y
    time[node] += later
    return replace(L, nodes=nodes, time=time)


def with_face(side: int, nodes: list[int]) -> StraightSkeleton:
    rows = L.face_nodes.to_lists()
    rows[side] = nodes
    return replace(L, face_nodes=Ragged.from_rows(rows))


def with_arc(arc: int, name: str, value: tuple[float, float], skeleton: StraightSkeleton = L) -> StraightSkeleton:
    array = getattr(skeleton, name).copy()
    array[arc] = value
    return replace(skeleton, **{name: array})


def crossing_nowhere() -> StraightSkeleton:
    """The L with two nodes exchanged: all distances are right, but faces are not simple."""
    first, second = (len(L.graph.points) + k for k in (0, 1))
    swap = {first: second, second: first}
    return replace(
        L,
        face_nodes=Ragged.from_rows([[swap.get(node, node) for node in face] for face in L.face_nodes.to_lists()]),
        arcs=np.array([[swap.get(node, node) for node in arc] for arc in L.arcs.tolist()]),
    )


def twice() -> StraightSkeleton:
    """The plane of the L once more on top of itself: every rule but that of areas holds in each of the two."""
    beside = L.graph.points + np.array([20, 0])
    skeleton, other = straight_skeleton(*of_loops([L.graph.points, beside])), straight_skeleton(*of_loops([beside]))
    count, nodes = len(L.graph.points), len(L.nodes)
    number = np.concatenate([count + np.arange(count), 2 * count + nodes - count + np.arange(len(other.nodes) - count)])
    mine = np.concatenate([np.arange(count), 2 * count + np.arange(nodes - count)])
    order = np.append(mine, -1), np.append(number, -1)
    return replace(
        skeleton,
        nodes=np.concatenate([L.nodes[:count], other.nodes[:count], L.nodes[count:], other.nodes[count:]]),
        time=np.concatenate([L.time[:count], other.time[:count], L.time[count:], other.time[count:]]),
        arcs=np.concatenate([order[0][L.arcs], order[1][other.arcs]]),
        arc_sides=np.concatenate([L.arc_sides, other.arc_sides + 2 * count]),
        arc_velocity=np.concatenate([L.arc_velocity, other.arc_velocity]),
        face_nodes=Ragged.from_rows(
            [order[0][face].tolist() for face in L.face_nodes] + [order[1][face].tolist() for face in other.face_nodes]
        ),
    )


INNER = len(L.graph.points)
LEVEL = int(np.flatnonzero((RECTANGLE.arc_velocity == 0).all(axis=1))[0])
FOR_EVER = int(np.flatnonzero(L.arcs[:, 1] < 0)[0])
ENDS = int(np.flatnonzero(L.arcs[:, 1] >= 0)[0])

SPOILED: dict[str, tuple[Callable[[], StraightSkeleton], str]] = {
    "a node moved": (lambda: moved(INNER, 1e-9, 0), "is .* from side"),
    "a node later": (lambda: moved(INNER, 0, 0, 1e-9), "is .* from side"),
    "a node at time 0": (lambda: moved(INNER, 0, 0, -L.time[INNER]), "has no time"),
    "a corner at a time": (lambda: moved(0, 0, 0, 1e-9), "has a time other than 0"),
    "a corner moved": (lambda: moved(0, 1e-9, 0), "not the graph's points"),
    "a node not finite": (lambda: moved(INNER, np.nan, 0), "not finite"),
    "a face without a node": (lambda: with_face(0, L.face(0).tolist()[:-1]), "where no arc is"),
    "a face the other way around": (lambda: with_face(0, [0, 1, *L.face(0).tolist()[:1:-1]]), "where no arc is"),
    "a face that begins elsewhere": (lambda: with_face(0, np.roll(L.face(0), 1).tolist()), "does not begin with it"),
    "a face without nodes": (lambda: with_face(0, [0, 1]), "too few nodes"),
    "a node that does not exist": (lambda: with_face(0, [0, 1, 99]), "a node that does not exist"),
    "a node in no face": (
        lambda: replace(L, nodes=np.vstack([L.nodes, [1, 1]]), time=np.append(L.time, 1)),
        "is in no face",
    ),
    "sides of an arc exchanged": (
        lambda: with_arc(ENDS, "arc_sides", tuple(L.arc_sides[ENDS, ::-1])),
        "does not have the arc",
    ),
    "an arc between others": (lambda: with_arc(ENDS, "arc_sides", (0, 0)), "has the same side twice"),
    "an arc back": (lambda: with_arc(ENDS, "arcs", tuple(L.arcs[ENDS, ::-1])), "goes back in time"),
    "an arc that ends too early": (lambda: with_arc(FOR_EVER, "arcs", (L.arcs[FOR_EVER, 0], INNER)), "lead to its end"),
    "a velocity askew": (
        lambda: with_arc(ENDS, "arc_velocity", tuple(L.arc_velocity[ENDS] + (1e-9, 0))),
        "loses the side",
    ),
    "a level arc that moves": (lambda: with_arc(LEVEL, "arc_velocity", (0, 1), RECTANGLE), "loses the side"),
    "an arc that does not move": (lambda: with_arc(ENDS, "arc_velocity", (0, 0)), "not face to face"),
    "an arc that never leaves": (lambda: with_arc(FOR_EVER, "arc_velocity", (0, 0)), "goes nowhere"),
    "a plane on top of another": (twice, "cover the plane 2 times"),
    "nodes exchanged": (crossing_nowhere, "from side"),
}


@pytest.mark.parametrize("what", SPOILED)
def test_what_is_spoiled_is_found(what: str) -> None:
    make, words = SPOILED[what]
    found = judge(make())
    assert any(re.search(words, text) for text in found), found


def test_the_skeletons_that_are_spoiled_were_right() -> None:
    assert judge(L) == []
    assert judge(RECTANGLE) == []


def test_a_roof_that_is_not_the_wavefronts_is_found() -> None:
    """Two edges whose caps meet: everywhere equally far, but the arc behind the gap is slanted instead of square."""
    gap = straight_skeleton(*of_paths([[(0, 0), (4, 0)], [(6, 0), (10, 0)]]))
    slanted = gap.arc_velocity.copy()
    behind = np.flatnonzero((gap.arcs[:, 1] < 0) & (gap.arcs[:, 0] >= len(gap.graph.points)))
    slanted[behind, 0] += 0.5
    found = judge(replace(gap, arc_velocity=slanted))
    assert len(found) == 2
    assert all("has a wrong speed" in text for text in found)


def halved(at: float) -> StraightSkeleton:
    """The L with a node on the arc that begins in the dent, at a time; where that arc ends it is 1."""
    dent = L.graph.points.tolist().index([2.0, 2.0])
    inside = L.arcs[:, 1] >= 0
    (arc,) = np.flatnonzero((L.arcs[:, 0] == dent) & inside).tolist()
    end, new = int(L.arcs[arc, 1]), len(L.nodes)
    assert L.time[end] == 1
    rows = L.face_nodes.to_lists()
    for side in L.arc_sides[arc].tolist():
        row = rows[side] = list(rows[side])
        places = [k for k in range(len(row)) if {row[k], row[(k + 1) % len(row)]} == {dent, end}]
        row.insert(places[0] + 1, new)
    arcs = L.arcs.copy()
    arcs[arc, 1] = new
    return replace(
        L,
        nodes=np.vstack([L.nodes, L.nodes[dent] + at * L.arc_velocity[arc]]),
        time=np.append(L.time, at),
        arcs=np.vstack([arcs, [new, end]]),
        arc_sides=np.vstack([L.arc_sides, L.arc_sides[arc]]),
        arc_velocity=np.vstack([L.arc_velocity, L.arc_velocity[arc]]),
        face_nodes=Ragged.from_rows(rows),
    )


def test_a_node_within_an_arc_is_nothing_wrong() -> None:
    assert judge(halved(0.5)) == []


def test_a_face_that_begins_in_the_air_is_found() -> None:
    spoiled = halved(0.5)
    found = judge(replace(spoiled, time=np.append(L.time, 1.5)))
    assert sum("goes back in time" in text for text in found) == 1
    assert sum("begins anew at" in text for text in found) == 2


def test_a_face_that_begins_at_a_level_arc_is_found() -> None:
    spoiled = halved(0.5)
    velocity = spoiled.arc_velocity.copy()
    velocity[-1] = 0
    found = judge(replace(spoiled, arc_velocity=velocity))
    assert sum("begins at the level arc" in text for text in found) == 2


def test_a_region_or_contour_that_is_wrong_is_found() -> None:
    skeleton = straight_skeleton(*CASES["square with a hole"])
    graph = skeleton.graph
    region, contour = graph.side_region.copy(), graph.side_contour.copy()
    region[0], contour[0] = 77, 88
    spoiled = replace(graph)
    spoiled.__dict__.update(side_region=region, side_contour=contour)
    found = " ".join(judge(replace(skeleton, graph=spoiled)))
    assert "is between regions" in found
    assert "4 regions are told, and there are 3" in found
    assert "on another contour than the next" in found
    assert "5 contours are told, and there are 4" in found
