"""Straight skeletons of random plane graphs: judged, and compared with the oracle, CGAL, and their own likenesses.

``FOLDCUT_RANDOM_SKELETON`` says how many graphs are tried; `make sweep-skeleton` tries 5,000.
"""

from __future__ import annotations

import os
from functools import cache

import numpy as np
import pytest
from support import cgal
from support.planar_graphs import KINDS, Graph, kind_of, random_graph, turned
from support.skeleton_judge import judge
from support.skeleton_nodes import as_oracle, differences, unlike_the_oracle

from foldcut.geometry.straight_skeleton import StraightSkeleton, straight_skeleton

SEEDS = range(int(os.environ.get("FOLDCUT_RANDOM_SKELETON", "150")))
SHARD = 50
SHARDS = [SEEDS[first : first + SHARD] for first in range(0, len(SEEDS), SHARD)]

shards = pytest.mark.parametrize("seeds", SHARDS, ids=[f"{some[0]}-{some[-1]}" for some in SHARDS])


@cache
def skeleton_of(seed: int) -> StraightSkeleton:
    return straight_skeleton(*random_graph(seed))


def told(seed: int, found: list[str]) -> list[str]:
    return [f"{kind_of(seed)} {seed}: {text}" for text in found]


@shards
def test_the_judge_finds_nothing(seeds: range) -> None:
    assert [text for seed in seeds for text in told(seed, judge(skeleton_of(seed)))] == []


@shards
def test_the_oracle_finds_the_same(seeds: range) -> None:
    assert [text for seed in seeds for text in told(seed, unlike_the_oracle(skeleton_of(seed)))] == []


@shards
def test_cgal_finds_the_same(seeds: range) -> None:
    pytest.importorskip("compas_cgal")
    some = [(seed, random_graph(seed)) for seed in seeds]
    loops = [(seed, graph) for seed, graph in some if (np.bincount(graph[1].ravel()) == 2).all()]
    answers = cgal.cgal_nodes([graph for _, graph in loops])
    found = []
    for (seed, _), nodes in zip(loops, answers, strict=True):
        if isinstance(nodes, str):
            print(f"{kind_of(seed)} {seed}: {nodes}")  # no fault of ours
        else:
            found += told(seed, cgal.differences(skeleton_of(seed), nodes))
    assert found == []


@shards
def test_the_same_graph_turned_scaled_moved_or_numbered_anew_has_the_same_skeleton(seeds: range) -> None:
    found = []
    for seed in seeds:
        graph, skeleton = random_graph(seed), skeleton_of(seed)
        size = float(np.hypot(*np.ptp(graph[0], axis=0)))
        found += told(seed, unlike_when_placed(skeleton, graph, 0, (1e-6, 1e6)[seed // len(KINDS) % 2], (0, 0), 1e-9))
        found += told(seed, unlike_when_numbered_anew(skeleton, graph, seed))
        if kind_of(seed) in SURE:
            found += told(seed, unlike_when_placed(skeleton, graph, 2.0, 1, (0, 0), 1e-9))
            found += told(seed, unlike_when_placed(skeleton, graph, 0, 1, (1e6 * size, -1e6 * size), 1e-6))
    assert found == []


SURE = ("star_shaped", "holes_and_islands", "grid_polygon", "polyomino", "regular", "grid_subdivision", "maze")
"""Kinds whose graphs have no nearly parallel sides, and no coincidences of moving vertices that rounding decides."""


def unlike_when_placed(
    skeleton: StraightSkeleton, graph: Graph, angle: float, scale: float, shift: tuple[float, float], near: float
) -> list[str]:
    """Return what is different where the graph is turned, scaled and moved; ``near`` is as for ``differences``."""
    placed = straight_skeleton(*turned(graph, angle, scale, shift))
    expected = as_oracle(
        skeleton,
        range(skeleton.graph.side_count),
        lambda nodes: turned((nodes, graph[1]), angle, scale, shift)[0],
        scale,
    )
    found = [*judge(placed), *differences(placed, expected, near)]
    return [f"turned by {angle}, scaled by {scale}, moved by {shift}: {text}" for text in found]


def unlike_when_numbered_anew(skeleton: StraightSkeleton, graph: Graph, seed: int) -> list[str]:
    """Return what is different when points and edges have other numbers, and edges other directions."""
    rng = np.random.default_rng(seed)
    points, edges = graph
    point_of, edge_of, flipped = rng.permutation(len(points)), rng.permutation(len(edges)), rng.random(len(edges)) < 0.5
    place = np.argsort(point_of)
    renumbered = place[edges[edge_of]]
    renumbered = np.where(flipped[:, None], renumbered[:, ::-1], renumbered)
    other = straight_skeleton(points[point_of], renumbered)
    # what was side 2e or 2e + 1 is the flank of another edge, perhaps of its other side; caps are known by their points
    sides = np.empty(skeleton.graph.side_count, dtype=int)
    for number, (edge, flip) in enumerate(zip(edge_of.tolist(), flipped.tolist(), strict=True)):
        sides[2 * edge], sides[2 * edge + 1] = 2 * number + flip, 2 * number + 1 - flip
    first = 2 * len(edges)
    cap_at = {int(point): first + k for k, point in enumerate(other.graph.tail[first:])}
    for k, point in enumerate(skeleton.graph.tail[first:].tolist()):
        sides[first + k] = cap_at[int(place[point])]
    expected = as_oracle(skeleton, sides.tolist(), lambda nodes: nodes)
    return [f"numbered anew: {text}" for text in (*judge(other), *differences(other, expected))]
