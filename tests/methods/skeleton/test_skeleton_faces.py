"""The straight skeleton as the method sees it: closed faces in their sides' coordinates, near nodes joined."""

from __future__ import annotations

from collections import Counter
from functools import reduce
from itertools import pairwise

import numpy as np
import pytest
import shapely
from support.several_loops import random_loops
from support.strategies import Points, rectangle, star

from foldcut.core.model import Shape, Sheet
from foldcut.drawing.placement import parse_sheet, place
from foldcut.drawing.shape import make_shape
from foldcut.methods.skeleton.skeleton_faces import (
    EXACT,
    NEAR,
    Flank,
    Skeleton,
    SkeletonFace,
    half_edges,
    outlines_of,
    skeleton_of,
)

SHEET = parse_sheet("a4-portrait")
WIDE = make_shape([[(40.0, 60.0), (160.0, 60.0), (160.0, 140.0), (40.0, 140.0)]])
HOLED: list[Points] = [rectangle(12, 9), [(-2.1, -1.6), (1.9, -2.0), (2.2, 1.7), (-1.8, 2.0)]]
ROOF: list[Points] = [[(0, 0), (10, 0), (10, 4), (7, 4), (7, 7), (5, 7), (5, 4), (0, 4)]]
SHAPES = [HOLED, ROOF, [star(5, 0.4)], random_loops(0, holes=True), random_loops(2, holes=False)]


def placed(loops: list[Points]) -> Shape:
    return place(make_shape(loops), SHEET, margin=30.0)[0]


def hexagon(off: float) -> Shape:
    """A regular hexagon, two corners of which are ``off`` mm off."""
    corners = [(100 + 50 * np.cos(k * np.pi / 3), 100 + 50 * np.sin(k * np.pi / 3)) for k in range(6)]
    return make_shape([[(x + off * (k in (1, 2)), y) for k, (x, y) in enumerate(corners)]])


def face_of(skeleton: Skeleton, side: int, *, left: bool) -> SkeletonFace:
    return next(face for face in skeleton.faces if Flank(side, left) in face.flanks)


def inner_nodes(skeleton: Skeleton) -> set[int]:
    inside = {vertex for face in skeleton.faces if face.sign > 0 for vertex in face.vertices}
    return {vertex for vertex in inside if vertex >= len(skeleton.starts)}


def test_the_face_of_a_rectangles_side_is_a_trapezium_with_the_side_below() -> None:
    skeleton = skeleton_of(WIDE, Sheet(200.0, 200.0))
    inside, outside = (face_of(skeleton, 0, left=left) for left in (True, False))
    assert (inside.sign, outside.sign) == (1, -1)
    assert (inside.side, inside.lower) == (0, [0, 1])
    np.testing.assert_allclose(skeleton.points[inside.upper], [(40, 60), (80, 100), (120, 100), (160, 60)], atol=1e-12)
    np.testing.assert_allclose(skeleton.height[inside.upper], [0, 40, 40, 0], atol=1e-12)
    assert skeleton.u(0, inside.upper[1]) == pytest.approx(40)
    assert [skeleton.is_side((a, b)) for a, b in ((0, 1), (1, 0), (0, 2))] == [True, True, False]
    assert skeleton.flanks_at[inside.upper[1]] == {Flank(side, True) for side in (0, 2, 3)}


@pytest.mark.parametrize("loops", SHAPES)
def test_nodes_are_equally_far_from_all_sides_around_them(loops: list[Points]) -> None:
    skeleton = skeleton_of(placed(loops), SHEET)
    for face in skeleton.faces:
        for side, _ in face.flanks:
            away = skeleton.points[face.vertices] - skeleton.starts[side]
            x, y = skeleton.along[side]
            height = np.abs(away @ (-y, x))
            near = np.hypot(*away.T) < SHEET.diagonal
            np.testing.assert_allclose(height[near], skeleton.height[face.vertices][near], atol=1e-8)


@pytest.mark.parametrize("loops", SHAPES)
def test_faces_cover_the_sheet_once_and_each_edge_between_two_is_in_both(loops: list[Points]) -> None:
    shape = placed(loops)
    skeleton = skeleton_of(shape, SHEET)
    assert {flank for face in skeleton.faces for flank in face.flanks} == {
        Flank(side, left) for side in range(shape.corner_count) for left in (True, False)
    }
    sheet = shapely.box(0, 0, SHEET.width, SHEET.height)
    faces = [shapely.Polygon(skeleton.points[face.vertices]) for face in skeleton.faces]
    assert shapely.union_all(faces).contains(sheet.buffer(-1e-6))
    assert sum(face.intersection(sheet).area for face in faces) == pytest.approx(sheet.area)
    inside = reduce(shapely.symmetric_difference, map(shapely.Polygon, shape.loops))
    for number, face in enumerate(faces):
        assert inside.contains(face.representative_point()) == (skeleton.faces[number].sign > 0)
    around = (face.vertices if face.flank.left else face.vertices[::-1] for face in skeleton.faces)
    count = Counter(pair for vertices in around for pair in half_edges(vertices))
    assert set(count.values()) == {1}
    for face in skeleton.faces:
        for chain in (face.lower, face.upper):
            u = [skeleton.u(face.side, vertex) for vertex in chain]
            assert all(b - a > -1e-9 for a, b in pairwise(u))


def test_sides_on_one_line_share_the_face_behind_the_gap_between_them() -> None:
    skeleton = skeleton_of(placed(ROOF), SHEET)
    assert len(skeleton.faces) == 2 * 8 - 1
    assert face_of(skeleton, 2, left=True).flanks == (Flank(2, True), Flank(6, True))
    assert [face_of(skeleton, side, left=False).flanks for side in (2, 6)] == [(Flank(2, False),), (Flank(6, False),)]


@pytest.mark.parametrize("tilt", [0.0, 1e-8])
@pytest.mark.parametrize("off", [1e-13, 1e-10])
def test_sides_that_are_on_one_line_but_for_rounding_share_it_and_leave_no_slivers(off: float, tilt: float) -> None:
    # the chimney's walls then reach as slivers far beyond the place where the two halves of the roof meet
    exact = placed(ROOF).loops[0]
    for seed in range(5):
        random = np.random.default_rng(seed)
        loop = exact + random.uniform(-off, off, exact.shape)
        loop[2:4, 0] += tilt * random.uniform(-1, 1, 2)
        skeleton = skeleton_of(Shape((loop,), (-1,)), SHEET)
        assert len(skeleton.faces) == 2 * 8 - 1
        assert face_of(skeleton, 2, left=True).flanks == (Flank(2, True), Flank(6, True))


def test_nodes_that_differ_by_rounding_are_one_and_others_are_not() -> None:
    rounding, hair = EXACT * SHEET.diagonal / 100, 1e3 * EXACT * SHEET.diagonal
    assert hair < NEAR * SHEET.diagonal
    middle = {off: inner_nodes(skeleton_of(hexagon(off), SHEET)) for off in (0.0, rounding, hair)}
    assert [len(nodes) for nodes in middle.values()] == [1, 1, 4]
    skeleton = skeleton_of(hexagon(rounding), SHEET)
    (node,) = inner_nodes(skeleton)
    assert skeleton.flanks_at[node] == {Flank(side, True) for side in range(6)}
    assert skeleton.height[node] == pytest.approx(50 * np.sqrt(3) / 2)


def test_faces_that_border_on_each_other_have_one_outline_and_one_that_comes_to_itself_has_two() -> None:
    assert outlines_of([[0, 1, 2, 3]]) == [[0, 1, 2, 3]]
    assert outlines_of([[0, 1, 1, 2, 2, 0]]) == [[0, 1, 2]]
    assert outlines_of([[0, 1, 4, 5], [1, 2, 3, 4]]) == [[0, 1, 2, 3, 4, 5]]
    assert sorted(map(sorted, outlines_of([[0, 1, 2, 3, 4, 2]]))) == [[0, 1, 2], [2, 3, 4]]
    assert outlines_of([[0, 1, 2, 3, 2]]) == [[0, 1, 2]]  # a way to and fro
