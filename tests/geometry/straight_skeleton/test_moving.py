"""A skeleton that follows the movements of points is the one that is made anew, and knows when it has to be."""

from __future__ import annotations

import numpy as np
import pytest
from support.planar_graphs import Graph, random_graph, random_polygon
from support.same_skeleton import differences

from foldcut.geometry.straight_skeleton import StraightSkeleton, graph_of, motion, straight_skeleton
from foldcut.geometry.straight_skeleton.moving import MovingSkeleton
from foldcut.geometry.straight_skeleton.tables import Arrays, Lists

SEEDS = (0, 1, 10, 11, 12, 13, 14, 21, 33)


def uneven(seed: int) -> Graph:
    """Return a random graph with all points moved a little, so that nothing in it is by accident the same."""
    points, edges = random_graph(seed)
    rng = np.random.default_rng(seed)
    return points + 1e-4 * np.ptp(points) * rng.uniform(-1, 1, points.shape), edges


def all_of(skeleton: StraightSkeleton) -> list[bytes]:
    faces = skeleton.face_nodes
    arrays = (skeleton.nodes, skeleton.time, skeleton.arcs, skeleton.arc_sides, skeleton.arc_velocity, faces.values)
    return [array.tobytes() for array in arrays]


@pytest.mark.parametrize("seed", SEEDS)
def test_after_each_movement_it_is_the_skeleton_made_anew(seed: int) -> None:
    points, edges = uneven(seed)
    moving = MovingSkeleton(graph_of(points, edges))
    rng = np.random.default_rng(seed)
    size = float(np.ptp(points, axis=0).max())
    stayed = 0
    for trial in range(12):
        moved = rng.choice(len(points), 2, replace=False)
        step = size * 10.0 ** rng.uniform(-3, -1) if trial % 2 else 1e-6 * size
        old = moving.points.copy()
        places = old[moved] + step * rng.uniform(-1, 1, (2, 2))
        try:
            stayed += moving.move(moved, places)
        except ValueError:
            assert moving.points.tolist() == old.tolist()
        else:
            assert moving.points[moved].tolist() == places.tolist()
        assert differences(moving.skeleton, straight_skeleton(moving.points, edges)) == []
    assert stayed > 0


@pytest.mark.parametrize("seed", range(4))
def test_small_movements_of_an_uneven_polygon_do_not_make_it_again(seed: int) -> None:
    points, edges = random_polygon(60, seed)
    moving = MovingSkeleton(graph_of(points, edges))
    rng = np.random.default_rng(seed)
    for point in range(0, len(points), 4):
        assert moving.move([point], [points[point] + 1e-9 * rng.uniform(-1, 1, 2)])


@pytest.mark.parametrize("seed", SEEDS)
def test_compiled_code_gives_the_same_bits(seed: int) -> None:
    pytest.importorskip("numba")
    points, edges = uneven(seed)
    one, other = (MovingSkeleton(graph_of(points, edges), tables) for tables in (Lists(), Arrays()))
    rng = np.random.default_rng(seed)
    for point in range(8):
        place = points[point % len(points)] + 1e-3 * rng.uniform(-1, 1, 2)
        assert one.move(point % len(points), place) == other.move(point % len(points), place)
        assert all_of(one.skeleton) == all_of(other.skeleton)


def test_on_a_large_polygon_only_what_is_near_is_computed() -> None:
    points, edges = random_polygon(300, 2)
    moving = MovingSkeleton(graph_of(points, edges))
    assert moving.move(150, points[150] + 1e-7)
    nodes, faces = moving.computed
    assert 3 < nodes < 60
    assert 4 < faces < 60


def test_a_node_of_four_sides_that_falls_apart_is_noticed() -> None:
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    moving = MovingSkeleton(graph_of(square, [(0, 1), (1, 2), (2, 3), (3, 0)]))
    assert len(moving.skeleton.nodes) == 5
    assert not moving.move(2, (1.25, 1))
    assert len(moving.skeleton.nodes) == 6


def test_a_node_of_four_sides_that_stays_together_is_kept() -> None:
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    moving = MovingSkeleton(graph_of(square, [(0, 1), (1, 2), (2, 3), (3, 0)]))
    assert moving.move(range(4), 1.5 * square)
    assert moving.skeleton.nodes[4].tolist() == [0.75, 0.75]
    assert moving.skeleton.time[4] == 0.75


def test_a_corner_that_becomes_reflex_may_keep_the_arcs() -> None:
    points, edges = [(0, 0), (4, -0.001), (8, 0), (8, 4), (0, 4.5)], [(k, (k + 1) % 5) for k in range(5)]
    moving = MovingSkeleton(graph_of(points, edges))
    moving.move(1, (4, 0.001))
    assert differences(moving.skeleton, straight_skeleton(moving.points, edges)) == []


def test_a_pentagon_does_not_become_a_star() -> None:
    """All faces of the star would be triangles the right way round, but they would go around the middle twice."""
    angles = 2 * np.pi * np.arange(5) / 5
    moving = MovingSkeleton(
        graph_of(np.stack([np.cos(angles), np.sin(angles)], axis=1), [(k, (k + 1) % 5) for k in range(5)])
    )
    with pytest.raises(ValueError, match="cross"):
        moving.move(range(5), np.stack([np.cos(2 * angles), np.sin(2 * angles)], axis=1))


def test_a_level_arc_that_does_not_stay_level_is_noticed() -> None:
    moving = MovingSkeleton(graph_of([(0, 0), (4, 0), (4, 2), (0, 2)], [(0, 1), (1, 2), (2, 3), (3, 0)]))
    assert not moving.skeleton.arc_velocity.any(axis=1).all()
    assert not moving.move(1, (4, -0.1))
    assert moving.skeleton.arc_velocity.any(axis=1).all()


def test_unbounded_arcs_that_come_to_meet_far_away_are_noticed() -> None:
    """A step in the lower border of a polygon: outside, its wavefront grows as it moves away, or shrinks."""
    points = np.array([(0, 0), (5, 0), (6, -1), (11, -1.001), (11, 5), (0, 4)])
    edges = [(k, (k + 1) % 6) for k in range(6)]
    for first, then in ((-1.001, -0.999), (-0.999, -1.001)):
        points[3, 1] = first
        moving = MovingSkeleton(graph_of(points, edges))
        assert not moving.move(3, (11, then))
        assert differences(moving.skeleton, straight_skeleton(moving.points, edges)) == []


def test_a_face_that_is_open_at_two_places_may_move() -> None:
    points = np.array([(-30, 0), (31, 0.3), (-1, 2), (1, 2.1), (0.2, 3)])
    edges = [(0, 1), (2, 3), (3, 4), (4, 2)]
    moving = MovingSkeleton(graph_of(points, edges))
    assert (moving.skeleton.face(0) < 0).sum() == 2
    for point, place in ((4, (0.21, 3.02)), (0, (-30.1, 0.01)), (2, (-1.01, 2))):
        assert moving.move(point, place)
        assert differences(moving.skeleton, straight_skeleton(moving.points, edges)) == []


@pytest.mark.parametrize(
    ("outline", "is_right"),
    [
        ([(0, 0), (4, 0), (4, 2), (0, 2)], True),
        ([(0, 0), (0, 2), (4, 2), (4, 0)], False),  # clockwise
        ([(0, 0), (4, 0), (0, 2), (4, 2)], False),  # crosses itself
        ([(0, 0), (4, 0), (4, 2), (5, 2), (4, 2), (0, 2)], False),  # there and back
        ([(0, 0), (4, 0), (2, 1e-13)], False),  # no wider than rounding
        ([(0, 0), (4, 0), (3, 2), (2, 1), (1, 2)], True),  # another wavefront comes down to it
        ([(0, 0), (4, 0), (4, 4), (6, 2), (6, 5), (0, 5)], False),  # begins by itself at (6, 2)
        ([(0, 0), (4, 0), (2, 3), (2, 0.0), (1, 3)], False),  # touches itself
    ],
)
def test_what_is_not_the_outline_of_a_face_is_refused(outline: list[tuple[float, float]], is_right: bool) -> None:
    """The side is on the axis of x, so times are heights."""
    tables = motion.room_for(Lists(), 1, 1, 1, 1, len(outline), 1)
    for corner, (x, y) in zip(tables.corners, outline, strict=False):
        corner.x, corner.y, corner.time, corner.moved = x, y, y, 1
    assert motion.is_simple(tables, len(outline), 1e-12, 1) == is_right


@pytest.mark.parametrize("step", [(0.0, 3.5), (1.0, 0.2), (9.0, 9.0), (0.0, 400.0)])
def test_edges_that_come_to_cross_are_refused(step: tuple[float, float]) -> None:
    points, edges = [(0, 0), (4, 0), (4, 4), (0, 4), (1, 1), (2, 1.2), (1.5, 2)], [(0, 1), (1, 2), (2, 3), (3, 0)]
    edges = [*edges, (4, 5), (5, 6), (6, 4)]
    moving = MovingSkeleton(graph_of(points, edges))
    before = moving.skeleton
    with pytest.raises(ValueError, match=r"cross|touch|same|two points|no length"):
        moving.move(4, np.add(points[4], step))
    assert moving.points.tolist() == before.graph.points.tolist()
    assert differences(moving.skeleton, before) == []
    assert moving.move(4, (1.001, 1))


def test_arrays_of_any_kind_do_not_make_the_compiler_work_again() -> None:
    pytest.importorskip("numba")
    points, edges = random_polygon(20, 1)
    moving = MovingSkeleton(graph_of(points, edges), Arrays())
    moving.move(0, points[0])
    signatures = list(moving.kernel.move.signatures)
    moving.move(np.arange(20, dtype=np.int32)[::2], moving.skeleton.graph.points[::2])
    moving.move([3], points[3:4].T)
    assert moving.kernel.move.signatures == signatures


def test_points_that_are_not_there_and_missing_places_are_refused() -> None:
    points, edges = random_polygon(20, 1)
    moving = MovingSkeleton(graph_of(points, edges))
    for point in (-1, len(points)):
        with pytest.raises(IndexError):
            moving.move(point, (0, 0))
    with pytest.raises(ValueError, match="places"):
        moving.move([0, 1], [(0, 0)])
    assert moving.points.tolist() == points.tolist()
