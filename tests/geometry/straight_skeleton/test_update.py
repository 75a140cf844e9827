"""A skeleton of which only some faces are made again is the same as one that is made anew."""

from __future__ import annotations

import numpy as np
import pytest
from support.planar_graphs import Graph, joined, random_graph, random_polygon
from support.same_skeleton import differences
from support.skeleton_judge import judge

from foldcut.geometry.straight_skeleton import StraightSkeleton, straight_skeleton
from foldcut.geometry.straight_skeleton.update import UpdatedSkeleton, with_corner, with_points, without_corner

STEPS = (1e-8, 1e-5, 1e-3, 0.03, 0.3)
"""How far points are moved, in parts of the drawing's size."""


def with_holes(corners: int, seed: int) -> Graph:
    """Return a random polygon with a ring around it, so that it is a hole, and with three triangles beside it."""
    points, edges = random_polygon(corners, seed)
    low, high = points.min(axis=0), points.max(axis=0)
    width, height = high - low
    ring = low + np.array([(-0.2, -0.2), (1.6, -0.15), (1.63, 0.45), (1.55, 1.2), (-0.2, 1.25)]) * (width, height)
    places = [np.add(low, (1.25 * width, part * height)) for part in (0.1, 0.5, 0.9)]
    triangles = [np.array([(0, 0), (0.13, 0.02), (0.05, 0.12)]) * width + place for place in places]
    loops = [(loop, np.stack([np.arange(len(loop)), np.roll(np.arange(len(loop)), -1)], axis=1)) for loop in triangles]
    return joined([(points, edges), (ring, np.array([(k, (k + 1) % 5) for k in range(5)])), *loops])


GRAPHS = {
    **{f"polygon {seed}": random_polygon(30 + 25 * seed, seed) for seed in range(4)},
    **{f"polygon with holes {seed}": with_holes(30 + 30 * seed, seed) for seed in range(3)},
    **{f"graph {seed}": random_graph(seed) for seed in (0, 1, 11, 12, 13, 14)},
}


def require_same(updated: UpdatedSkeleton) -> None:
    """Require that a skeleton is the one made anew."""
    graph = updated.graph
    assert differences(updated, straight_skeleton(graph.points, graph.edges)) == []


@pytest.mark.parametrize("name", GRAPHS)
def test_moved_points_give_what_is_made_anew(name: str) -> None:
    points, edges = GRAPHS[name]
    skeleton: StraightSkeleton = straight_skeleton(points, edges)
    rng = np.random.default_rng(len(points))
    size = float(np.ptp(points, axis=0).max())
    done = 0
    for step in STEPS:
        places = skeleton.graph.points.copy()
        moved = rng.choice(len(points), 1 + int(rng.integers(2)), replace=False)
        places[moved] += step * size * rng.uniform(-1, 1, (len(moved), 2))
        try:
            skeleton = updated = with_points(skeleton, places)
        except ValueError:
            continue  # edges would cross
        require_same(updated)
        done += 1
    assert done >= 2
    assert judge(skeleton) == []


@pytest.mark.parametrize("name", GRAPHS)
def test_corners_put_in_and_taken_out_give_what_is_made_anew(name: str) -> None:
    points, edges = GRAPHS[name]
    skeleton: StraightSkeleton = straight_skeleton(points, edges)
    rng = np.random.default_rng(len(points))
    for _ in range(3):
        graph = skeleton.graph
        edge = int(rng.integers(len(graph.edges)))
        a, b = graph.points[graph.edges[edge]]
        place = a + (b - a) * rng.uniform(0.2, 0.8) + 0.1 * np.hypot(*(b - a)) * rng.uniform(-1, 1, 2)
        try:
            updated = with_corner(skeleton, edge, place)
        except ValueError:
            continue
        assert updated.graph.points[-1].tolist() == place.tolist()
        assert updated.graph.edges[edge].tolist() == [graph.edges[edge, 0], len(graph.points)]
        assert updated.graph.edges[-1].tolist() == [len(graph.points), graph.edges[edge, 1]]
        require_same(updated)
        back = without_corner(updated, len(graph.points))
        assert back.graph.edges.tolist() == graph.edges.tolist()
        require_same(back)
        skeleton = updated
    twos = np.flatnonzero(np.bincount(skeleton.graph.edges.ravel()) == 2)
    for point in rng.permutation(twos)[:2].tolist():
        try:
            skeleton = updated = without_corner(skeleton, min(point, len(skeleton.graph.points) - 1))
        except ValueError:
            continue
        require_same(updated)


def test_on_a_large_polygon_only_a_few_faces_are_made() -> None:
    points, edges = random_polygon(300, 3)
    skeleton = straight_skeleton(points, edges)
    places = points.copy()
    places[100] += 0.05
    for updated in (with_points(skeleton, places), with_corner(skeleton, 40, points[40:42].mean(axis=0) + 0.02)):
        sides = updated.graph.side_count
        assert sides >= 590
        assert 4 <= len(updated.made_again) < 60
        assert updated.work < 250
        require_same(updated)


def test_faces_that_are_not_made_again_keep_their_nodes_to_the_last_bit() -> None:
    points, edges = random_polygon(120, 3)
    skeleton = straight_skeleton(points, edges)
    places = points.copy()
    places[50] += 0.05
    updated = with_points(skeleton, places)
    kept = np.setdiff1d(np.arange(skeleton.graph.side_count), updated.made_again)
    assert len(kept) > 100
    for side in kept.tolist():
        before, after = skeleton.face(side), updated.face(side)
        assert (before < 0).tolist() == (after < 0).tolist()
        assert skeleton.nodes[before[before >= 0]].tolist() == updated.nodes[after[after >= 0]].tolist()


def test_a_point_moved_far_makes_faces_at_both_places() -> None:
    """A small triangle jumps from one end of a long room to the other."""
    room = np.array([(x, 0.1 * (x % 3)) for x in range(40)] + [(x, 6 + 0.1 * (x % 3)) for x in range(39, -1, -1)])
    edges = [(k, (k + 1) % 80) for k in range(80)] + [(80, 81), (81, 82), (82, 80)]
    triangle = np.array([(3, 3), (3.6, 3.1), (3.2, 3.5)])
    skeleton = straight_skeleton(np.concatenate([room, triangle]), edges)
    updated = with_points(skeleton, np.concatenate([room, np.add(triangle, (32, 0.05))]))
    require_same(updated)


def test_points_that_stay_make_nothing_again() -> None:
    points, edges = random_polygon(60, 3)
    updated = with_points(straight_skeleton(points, edges), points)
    assert updated.work == 0
    assert len(updated.made_again) == 0
    require_same(updated)


def test_a_dead_end_grows_and_is_taken_back() -> None:
    points = np.array([(0, 0), (8, 0.3), (8.2, 6), (0.1, 6.2), (3, 2), (4, 3.1), (4.2, 4.4)])
    edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6)]
    skeleton = straight_skeleton(points, edges)
    longer = with_corner(skeleton, 5, (4.9, 3.6))
    require_same(longer)
    require_same(without_corner(longer, 5))
    require_same(with_points(longer, longer.graph.points + np.eye(8)[6, :, None] * (0.1, 0.2)))


def test_what_cannot_be_is_refused() -> None:
    points, edges = random_polygon(40, 3)
    skeleton = straight_skeleton(points, edges)
    with pytest.raises(ValueError, match="places were given"):
        with_points(skeleton, points[1:])
    with pytest.raises(ValueError, match="cross"):
        with_points(skeleton, np.where(np.arange(len(points))[:, None] == 3, points + 3.3, points))
    with pytest.raises(IndexError, match="edge"):
        with_corner(skeleton, len(edges), (0, 0))
    with pytest.raises(IndexError, match="point"):
        without_corner(skeleton, -1)
    star = straight_skeleton([(0, 0), (1, 0), (-1, 1), (-1, -1)], [(0, 1), (0, 2), (0, 3)])
    with pytest.raises(ValueError, match="3 edges"):
        without_corner(star, 0)
