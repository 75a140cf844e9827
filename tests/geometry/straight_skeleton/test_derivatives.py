"""Derivatives of nodes against central differences, where the skeleton keeps its arcs."""

from __future__ import annotations

import numpy as np
import pytest
from support.planar_graphs import random_graph, random_polygon

from foldcut.core.arrays import Floats
from foldcut.geometry.straight_skeleton import Solver, StraightSkeleton, graph_of
from foldcut.geometry.straight_skeleton.derivatives import node_derivatives

STEP = 1e-5
"""How far points are moved, in parts of the drawing's size."""

HALF = [(0, 0), (4, 0), (4, 3), (2.25, 3), (1, 3), (0, 2.5)]  # (2.25, 3) is a corner of 180 degrees

GRAPHS = {
    "one edge: two caps on either side": ([(0, 0), (3, 1)], [(0, 1)]),
    "a corner of 180 degrees": (HALF, [(k, (k + 1) % 6) for k in range(6)]),
    "an open path and a triangle": (
        [(0, 0), (3, 1), (4, 4), (6, 0), (9, 1), (7, 3.5)],
        [(0, 1), (1, 2), (3, 4), (4, 5), (5, 3)],
    ),
    "a triangle with a hole": (
        [(0, 0), (11, 1), (4, 9), (4, 2), (4.3, 4), (6, 2.2)],
        [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3)],
    ),
    "three edges at a point": ([(0, 0), (3, 1), (-2, 3), (-1, -4)], [(0, 1), (0, 2), (0, 3)]),
    "a polygon": random_polygon(24, 1),
    **{f"graph {seed}": random_graph(seed) for seed in (0, 1, 11, 12, 13, 21)},
}


def places_in(other: StraightSkeleton, skeleton: StraightSkeleton) -> Floats | None:
    """Return (x, y, time) of the nodes of another skeleton in this one's order; None if its faces are different."""
    if other.face_nodes.offsets.tolist() != skeleton.face_nodes.offsets.tolist():
        return None
    pairs = set(zip(skeleton.face_nodes.values.tolist(), other.face_nodes.values.tolist(), strict=True)) - {(-1, -1)}
    if len(pairs) != len(skeleton.nodes) or len(dict(pairs)) != len(pairs) or len(other.nodes) != len(pairs):
        return None
    order = [number for _, number in sorted(pairs)]
    return np.column_stack([other.nodes, other.time])[order]


@pytest.mark.parametrize("name", GRAPHS)
def test_derivatives_are_what_small_steps_show(name: str) -> None:
    points, edges = GRAPHS[name]
    points = np.array(points, dtype=float)
    solver = Solver(graph_of(points, edges))
    skeleton = solver.solve_one()
    derivatives = node_derivatives(skeleton)
    step = STEP * float(np.ptp(points, axis=0).max())
    full = derivatives.dense()
    assert full.shape == (len(skeleton.nodes), 3, len(points), 2)
    compared = 0
    for point in range(len(points)):
        for axis in range(2):
            move = np.zeros_like(points)
            move[point, axis] = step
            ahead, back = solver.solve_one(points + move), solver.solve_one(points - move)
            one, other = places_in(ahead, skeleton), places_in(back, skeleton)
            if one is None or other is None:
                continue
            found = (one - other) / (2 * step)
            expected = full[:, :, point, axis]
            # the error of the differences themselves grows with the cube of how fast a node moves
            off = np.abs(found - expected).max(axis=1) / (1 + np.abs(expected).max(axis=1)) ** 3
            assert off.max() < 1e-6, (point, axis, int(off.argmax()))
            assert np.allclose(derivatives.changes(move), step * expected, rtol=1e-12, atol=1e-15 * step)
            compared += 1
    assert compared >= len(points)


def test_the_gradient_is_the_transpose_of_the_changes() -> None:
    points, edges = GRAPHS["a polygon"]
    derivatives = node_derivatives(Solver(graph_of(points, edges)).solve_one())
    rng = np.random.default_rng(0)
    by_node, steps = rng.normal(size=(derivatives.node_count, 3)), rng.normal(size=points.shape)
    one, other = (by_node * derivatives.changes(steps)).sum(), (derivatives.gradient(by_node) * steps).sum()
    assert abs(one - other) < 1e-11 * np.abs(by_node * derivatives.changes(steps)).sum()
