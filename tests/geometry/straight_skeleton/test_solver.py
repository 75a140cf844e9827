"""One implementation: the bits are the same in plain Python and compiled, once and many at a time."""

from __future__ import annotations

import numpy as np
import pytest
from support.planar_graphs import KINDS, hilbert, koch, random_graph, random_polygon
from support.skeleton_judge import judge

from foldcut.geometry.straight_skeleton import Solver, StraightSkeleton, graph_of, straight_skeleton, wavefront
from foldcut.geometry.straight_skeleton.tables import Arrays, Lists


def bits(skeleton: StraightSkeleton) -> list[bytes]:
    """Return all that a skeleton consists of, as bytes."""
    faces = skeleton.face_nodes
    arrays = (skeleton.nodes, skeleton.time, skeleton.arcs, skeleton.arc_sides, skeleton.arc_velocity)
    return [array.tobytes() for array in (*arrays, faces.values, faces.offsets)]


@pytest.mark.parametrize("seed", range(2 * len(KINDS)))
def test_compiled_code_gives_the_same_bits(seed: int) -> None:
    pytest.importorskip("numba")
    graph = random_graph(seed)
    assert bits(straight_skeleton(*graph, tables=Arrays())) == bits(straight_skeleton(*graph, tables=Lists()))


@pytest.mark.parametrize("curve", [koch, hilbert, lambda corners: random_polygon(corners, 4)])
def test_compiled_code_gives_the_same_bits_for_a_thousand_corners(curve) -> None:
    pytest.importorskip("numba")
    graph = curve(1000)
    assert bits(straight_skeleton(*graph, tables=Arrays())) == bits(straight_skeleton(*graph, tables=Lists()))


@pytest.mark.parametrize("seed", range(len(KINDS)))
def test_the_same_graph_gives_the_same_bits_again(seed: int) -> None:
    solver = Solver(graph_of(*random_graph(seed)))
    one, two = solver.solve_one(), solver.solve_one()
    assert bits(one) == bits(two)
    assert bits(one) == bits(straight_skeleton(*random_graph(seed)))


@pytest.mark.parametrize("seed", range(0, 3 * len(KINDS), len(KINDS)))
def test_many_candidates_give_what_each_gives_by_itself(seed: int) -> None:
    points, edges = random_graph(seed)  # star-shaped: corners may move a little
    rng = np.random.default_rng(seed)
    candidates = points + rng.uniform(-0.01, 0.01, (8, *points.shape))
    found = Solver(graph_of(points, edges)).solve(candidates)
    assert len(found) == 8
    for skeleton, candidate in zip(found, candidates, strict=True):
        assert judge(skeleton) == []
        assert skeleton.graph.points.tolist() == candidate.tolist()
        assert bits(skeleton) == bits(straight_skeleton(candidate, edges))


def test_candidates_with_other_points_are_refused() -> None:
    points, edges = random_graph(0)
    with pytest.raises(ValueError, match="points"):
        Solver(graph_of(points, edges)).solve_one(points[1:])


@pytest.mark.parametrize("seed", range(2 * len(KINDS)))
def test_small_graphs_come_out_right_with_the_grid_for_large_ones(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(wavefront, "FEW", 0)
    assert judge(straight_skeleton(*random_graph(seed), tables=Lists())) == []
