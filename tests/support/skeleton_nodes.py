"""Compare the nodes of a straight skeleton with those that something else found."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from itertools import combinations

import numpy as np
from oracles.straight_skeleton import EXACT, ROUNDED, Node, Oracle, straight_skeleton
from scipy.spatial import KDTree

from foldcut.core.arrays import Floats
from foldcut.geometry.straight_skeleton import StraightSkeleton
from foldcut.geometry.union_find import groups
from support.skeleton_judge import Case

NEAR = 1e-9
"""Nodes closer to each other than this, relative to the drawing's size, are compared as one: rounding may have made
one of several, or several of one."""


NEARLY_PARALLEL = (1e-12, 1e-7)
"""The sine of the angle between two sides that are so nearly parallel that rounding decides where they meet."""

FAR = 1e8
"""Nodes farther away than this, by the size of the drawing, are not compared."""


def unlike_the_oracle(skeleton: StraightSkeleton) -> list[str]:
    """Return where a skeleton differs from the oracle's: from the exact one, and from those in which ties are wider.

    Where many parts of the wavefront come together, a rounding decides what goes on from there. A skeleton in doubles
    is right if it is what one gets by taking events as one that are within rounding.
    """
    graph = skeleton.graph
    found: list[str] = []
    for same in (EXACT, *ROUNDED):
        try:
            differ = differences(skeleton, straight_skeleton(graph.points, graph.edges, graph.following, same))
        except ArithmeticError as error:
            differ = [f"the oracle fails: {error}"]
        if not differ:
            return []
        found = found or differ
    return found


def differences(skeleton: StraightSkeleton, oracle: Oracle, near: float = NEAR) -> list[str]:
    """Return where a skeleton and what the oracle found differ, in words: places, times, sides, arcs that never end.

    From the time on of the first node that has two sides which are nearly parallel, several skeletons are right, so
    only what is earlier is compared.
    """
    case = Case(skeleton)
    first = case.count
    ours, theirs = skeleton.nodes[first:], np.array([(node.x, node.y) for node in oracle.nodes]).reshape(-1, 2)
    sides = [frozenset(skeleton.node_sides(node).tolist()) for node in range(first, len(skeleton.nodes))]
    sides += [node.sides for node in oracle.nodes]
    time = np.concatenate([skeleton.time[first:], [node.time for node in oracle.nodes]])
    reach = np.concatenate([case.spread[first:], np.zeros(len(theirs))])
    certain = min((time[k] for k in range(len(time)) if _has_nearly_parallel(case, sides[k])), default=np.inf)
    certain = min(certain, FAR * case.size)
    found = []
    for cluster in clusters(np.concatenate([ours, theirs]), time, reach + near * case.size):
        if time[cluster].max() >= certain - near * case.size:
            continue
        here = [k for k in cluster if k < len(ours)]
        there = [k for k in cluster if k >= len(ours)]
        if here and there:
            one, other = (frozenset().union(*(sides[k] for k in some)) for some in (here, there))
            if one != other:
                found.append(
                    f"{case.node(first + here[0])} has sides {sorted(one)}, and there should be {sorted(other)}"
                )
        elif here:
            found.append(f"{case.node(first + here[0])} with sides {sorted(sides[here[0]])} should not be there")
        else:
            node = oracle.nodes[there[0] - len(ours)]
            found.append(f"there should be a node at ({node.x:.9g}, {node.y:.9g}) with sides {sorted(node.sides)}")
    if time.max(initial=0) >= certain:
        return found
    unbounded = sorted(map(tuple, skeleton.arc_sides[skeleton.arcs[:, 1] < 0].tolist()))
    if unbounded != sorted(oracle.unbounded):
        wrong = sorted(set(unbounded) ^ set(oracle.unbounded))
        found.append(f"of the arcs that never end these are only here, or only there: {wrong}")
    return found


def _has_nearly_parallel(case: Case, sides: frozenset[int]) -> bool:
    low, high = NEARLY_PARALLEL
    return any(low < abs(case.along[one] @ case.normal[other]) < high for one, other in combinations(sorted(sides), 2))


def clusters(places: Floats, time: Floats, reach: Floats) -> Iterator[list[int]]:
    """Yield the numbers of nodes in groups: those that are within each other's reach in place and in time."""
    pairs: list[tuple[int, int]] = []
    if len(places):
        tree = KDTree(places)
        for node, near in enumerate(tree.query_ball_point(places, reach)):
            pairs += [(node, other) for other in near if abs(time[node] - time[other]) <= reach[node]]
    found = defaultdict(list)
    for node, group in enumerate(groups(len(places), pairs)):
        found[group].append(node)
    yield from found.values()


def as_oracle(
    skeleton: StraightSkeleton, sides: Sequence[int], place: Callable[[Floats], Floats], scale: float = 1.0
) -> Oracle:
    """Return a skeleton as the oracle of another, for ``differences``.

    ``sides`` ``(s,)``: what each of its sides is called there; ``place`` takes its nodes ``(k, 2)`` there; ``scale`` is
    what times are multiplied by.
    """
    first = len(skeleton.graph.points)
    nodes = [
        Node(x, y, scale * time, frozenset(sides[side] for side in skeleton.node_sides(first + k).tolist()))
        for k, ((x, y), time) in enumerate(
            zip(place(skeleton.nodes[first:]).tolist(), skeleton.time[first:].tolist(), strict=True)
        )
    ]
    ends = skeleton.arc_sides[skeleton.arcs[:, 1] < 0].tolist()
    return Oracle(nodes, [(sides[left], sides[right]) for left, right in ends])
