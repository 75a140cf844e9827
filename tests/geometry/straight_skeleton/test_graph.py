"""Graphs that have no straight skeleton are refused, with the place; sides are the flanks of edges, then caps."""

from __future__ import annotations

import numpy as np
import pytest
from support.planar_graphs import KINDS, random_graph
from support.skeleton_cases import CASES

from foldcut.geometry.straight_skeleton import graph_of, straight_skeleton

TRIANGLE = [(0, 0), (4, 0), (0, 3)]


@pytest.mark.parametrize(
    ("points", "edges", "words"),
    [
        (TRIANGLE, [], "no edges"),
        (TRIANGLE, [(0, 1), (1, 2), (2, 2)], r"at \(0, 3\) has no length"),
        ([*TRIANGLE, (7, 7.5)], [(0, 1), (1, 2), (2, 0)], r"the point at \(7, 7.5\) has no edge"),
        ([*TRIANGLE, (4, 0)], [(0, 1), (1, 2), (2, 3)], r"two points are at \(4, 0\)"),
        (TRIANGLE, [(0, 1), (1, 2), (2, 3)], "one of the 3"),
        (TRIANGLE, [(0, 1), (1, 2), (2, -1)], "one of the 3"),
        ([(0, 0), (4, np.nan), (0, 3)], [(0, 1), (1, 2), (2, 0)], "not finite"),
        ([(0, 0), (4, np.inf), (0, 3)], [(0, 1), (1, 2), (2, 0)], "not finite"),
        ([(0, 0), (2, 2), (0, 2), (2, 0)], [(0, 1), (2, 3)], r"edges 0 and 1 .* at \(1, 1\)"),  # they cross
        ([(0, 0), (4, 0), (2, 0), (2, 3)], [(0, 1), (2, 3)], r"edges 0 and 1 .* at \(2, 0\)"),  # one ends on the other
        ([(0, 0), (4, 0), (2, 0), (6, 0)], [(0, 1), (2, 3)], "edges 0 and 1"),  # they overlap
        ([(0, 0), (4, 0), (6, 0)], [(0, 1), (0, 2)], "edges 0 and 1"),  # from a common point
        (TRIANGLE, [(0, 1), (1, 0), (1, 2)], "edges 0 and 1"),  # the same edge twice
        ([(0, 0), (4, 0), (2, 5e-324), (2, 3)], [(0, 1), (3, 2), (2, 0)], None),  # as close as can be, but apart
    ],
)
def test_what_is_no_plane_graph_is_refused(points: list, edges: list, words: str | None) -> None:
    if words is None:
        assert graph_of(points, edges).side_count == 2 * len(edges) + 2
    else:
        with pytest.raises(ValueError, match=words):
            straight_skeleton(points, edges)


@pytest.mark.parametrize("seed", range(len(KINDS)))
def test_sides_run_around_their_regions(seed: int) -> None:
    graph = graph_of(*random_graph(seed))
    edges = len(graph.edges)
    assert (graph.tail[0 : 2 * edges : 2] == graph.edges[:, 0]).all()
    assert (graph.tail[1 : 2 * edges : 2] == graph.edges[:, 1]).all()
    assert (graph.head == graph.tail[graph.following]).all()
    assert sorted(graph.following.tolist()) == list(range(graph.side_count))
    caps = graph.tail == graph.head
    assert sorted(graph.tail[caps].tolist()) == np.flatnonzero(np.bincount(graph.edges.ravel()) == 1).tolist()
    assert (graph.side_edge == np.where(caps, -1, np.arange(graph.side_count) // 2)).all()


def test_the_graph_keeps_a_copy_that_nobody_can_change() -> None:
    points, edges = CASES["square"]
    given = points.copy()
    graph = graph_of(given, edges)
    given[0] = 9
    assert graph.points.tolist() == points.tolist()
    with pytest.raises(ValueError, match="read-only"):
        graph.points[0] = 9
