"""Straight skeletons that one can check in one's head, and those of drawings."""

from __future__ import annotations

import numpy as np
import pytest
from support import cgal
from support.planar_graphs import Graph, hilbert, koch, random_polygon
from support.skeleton_cases import CASES, drawings
from support.skeleton_judge import judge
from support.skeleton_nodes import unlike_the_oracle

from foldcut.geometry.straight_skeleton import StraightSkeleton, straight_skeleton

DRAWINGS = drawings()


def inner_nodes(skeleton: StraightSkeleton) -> list[tuple[float, float, float, int]]:
    """Return place, time and number of sides of all nodes but the graph's points, in order."""
    found = []
    for node in range(len(skeleton.graph.points), len(skeleton.nodes)):
        x, y = skeleton.nodes[node].tolist()
        found.append((x, y, float(skeleton.time[node]), len(skeleton.node_sides(node))))
    return sorted(found)


def level_arcs(skeleton: StraightSkeleton) -> list[tuple[int, int]]:
    """Return the arcs that the wavefront reaches all at once."""
    level = (skeleton.arc_velocity == 0).all(axis=1)
    return [(a, b) for a, b in skeleton.arcs[level].tolist()]


@pytest.mark.parametrize("name", CASES)
def test_the_judge_finds_nothing(name: str) -> None:
    assert judge(straight_skeleton(*CASES[name])) == []


@pytest.mark.parametrize("name", CASES)
def test_the_oracle_finds_the_same(name: str) -> None:
    assert unlike_the_oracle(straight_skeleton(*CASES[name])) == []


@pytest.mark.parametrize(
    ("name", "expected", "level"),
    [
        ("square", [(2, 2, 2, 4)], 0),
        ("rectangle", [(1, 1, 1, 3), (5, 1, 1, 3)], 1),
        ("edge", [], 0),
        ("straight path", [], 0),
        # the caps between the edges meet face to face; then the flanks go on beside each other
        ("two edges on one line", [(5, -1, 1, 4), (5, 1, 1, 4)], 1),
        ("two squares side by side", [(2, 2, 2, 4), (5, -1, 1, 4), (5, 5, 1, 4), (8, 2, 2, 4)], 1),
        # a ring of four level arcs, and the middle of the hole
        ("square with a hole", [(-2, -2, 1, 4), (-2, 2, 1, 4), (0, 0, 1, 4), (2, -2, 1, 4), (2, 2, 1, 4)], 4),
        # four level arcs from the middle, where the dents meet when the sides of the arms do
        ("plus", [(-1, 0, 0.5, 3), (0, -1, 0.5, 3), (0, 0, 0.5, 8), (0, 1, 0.5, 3), (1, 0, 0.5, 3)], 4),
        ("T", [], 0),
    ],
)
def test_nodes_are_where_one_expects_them(name: str, expected: list[tuple[float, ...]], level: int) -> None:
    skeleton = straight_skeleton(*CASES[name])
    found = inner_nodes(skeleton)
    assert [sides for *_, sides in found] == [sides for *_, sides in expected]
    assert np.array(found) == pytest.approx(np.array(expected), abs=1e-15)
    assert len(level_arcs(skeleton)) == level


@pytest.mark.parametrize("corners", range(3, 13))
def test_all_sides_of_a_regular_polygon_meet_in_one_node(corners: int) -> None:
    skeleton = straight_skeleton(*CASES[f"regular polygon with {corners} corners"])
    ((x, y, time, sides),) = inner_nodes(skeleton)
    assert (x, y, time) == pytest.approx((0, 0, np.cos(np.pi / corners)), abs=1e-15)
    assert sides == corners


def test_a_dead_end_has_a_cap_that_goes_on_for_ever() -> None:
    skeleton = straight_skeleton(*CASES["edge"])
    assert [face.tolist() for face in skeleton.face_nodes] == [[0, 1, -1], [1, 0, -1], [1, -1], [0, -1]]
    assert np.abs(skeleton.arc_velocity).tolist() == [[1, 1]] * 4  # around the corners of a rectangle


def test_between_neighbours_around_a_point_two_flanks_and_two_caps_meet() -> None:
    found = inner_nodes(straight_skeleton(*CASES["seven edges around a point"]))
    sine, cosine = np.sin(np.pi / 7), np.cos(np.pi / 7)
    assert [time for *_, time, _ in found] == pytest.approx([sine / (cosine - sine)] * 7)
    assert [sides for *_, sides in found] == [4] * 7


def test_around_a_straight_corner_the_faces_are_apart() -> None:
    skeleton = straight_skeleton(*CASES["straight path"])
    middle = skeleton.arcs[:, 0] == 1
    assert sorted(skeleton.arc_velocity[middle].tolist()) == [[0, -1], [0, 1]]


def test_regions_are_the_faces_of_the_plane() -> None:
    graph = straight_skeleton(*CASES["square with a hole"]).graph
    inside, outside = graph.side_region[::2], graph.side_region[1::2]
    assert set(outside[:4]) == {0}
    assert set(inside[:4]) == set(outside[4:])  # the ring: contours of the outer square and of the hole
    assert len({*inside[:4], *inside[4:], 0}) == 3
    assert len(set(graph.side_contour)) == 4


def test_a_node_knows_the_contours_that_meet_there() -> None:
    skeleton = straight_skeleton(*CASES["square with a hole"])
    contour = skeleton.graph.side_contour
    ring = sorted({int(contour[0]), int(contour[9])})  # inside of the outer square, outside of the hole
    found = [skeleton.node_contours(node).tolist() for node in range(8, len(skeleton.nodes))]
    assert ring in found
    assert [int(contour[8])] in found, "the middle of the hole"


@pytest.mark.parametrize("name", DRAWINGS)
def test_drawings_are_judged_right(name: str) -> None:
    assert judge(straight_skeleton(*DRAWINGS[name])) == []


def test_drawings_have_the_nodes_that_cgal_finds() -> None:
    pytest.importorskip("compas_cgal")
    # at the nodes of the snowflake, events follow each other within the rounding of its corners
    names = [name for name in DRAWINGS if _is_loops(DRAWINGS[name]) and name != "snowflake"]
    assert len(names) >= 20
    for name, nodes in zip(names, cgal.cgal_nodes([DRAWINGS[name] for name in names]), strict=True):
        assert not isinstance(nodes, str), (name, nodes)
        assert cgal.differences(straight_skeleton(*DRAWINGS[name]), nodes) == [], name


def _is_loops(graph: Graph) -> bool:
    return bool((np.bincount(graph[1].ravel()) == 2).all())


@pytest.mark.parametrize(
    "curve", [koch(1000), hilbert(1000), random_polygon(1000, 3)], ids=["koch", "hilbert", "random"]
)
def test_a_thousand_corners_are_judged_right(curve: Graph) -> None:
    assert judge(straight_skeleton(*curve)) == []
