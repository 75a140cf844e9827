"""The skeleton method's parts by themselves: ridges, perpendiculars, moved corners, conditions, the budget."""

from __future__ import annotations

import numpy as np
import pytest
from support.strategies import rectangle

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.drawing.shape import make_shape
from foldcut.methods.skeleton.budget import Budget, division_cost, order_cost
from foldcut.methods.skeleton.facets import Division, divide_sheet
from foldcut.methods.skeleton.layer_order import OrderConditions
from foldcut.methods.skeleton.move_corners import DIFFERENCE, Meeting, with_corners_moved
from foldcut.methods.skeleton.perpendiculars import Perpendiculars, Ridges, trace
from foldcut.methods.skeleton.skeleton_faces import Flank, skeleton_of

SHEET = Sheet(200.0, 200.0)
WIDE = make_shape([[(40.0, 60.0), (160.0, 60.0), (160.0, 140.0), (40.0, 140.0)]])
INSIDE = [Flank(side, True) for side in range(4)]  # of WIDE: its sides follow each other counter-clockwise


def ridges_of_wide() -> Ridges:
    return Ridges(skeleton_of(WIDE, SHEET), SHEET)


def test_two_nodes_of_a_rectangle_need_a_perpendicular_and_its_chains_are_hit_where_they_are() -> None:
    ridges = ridges_of_wide()
    points = ridges.skeleton.points
    assert sorted(points[ridges.odd].round(9).tolist()) == [[80, 100], [120, 100]]
    assert all(ridges.degree[node] == 3 for node in ridges.odd)
    number = next(k for k, face in enumerate(ridges.skeleton.faces) if (face.side, face.sign) == (0, 1))
    chains = (ridges.hit(number, 60.0, chain) for chain in (0, 1))
    assert [pytest.approx(hit.place) for hit in chains if hit is not None] == [(100, 60), (100, 100)]
    middle = ridges.hit(number, 60.0, 1)
    assert middle is not None
    assert middle.edge is not None
    assert ridges.chain_with(middle.edge, number) == 1
    assert ridges.skeleton.faces[ridges.beyond(middle.edge, number)].side == 2
    node = ridges.hit(number, 40.0 + 1e-8, 1)
    assert node is not None
    assert node.vertex in ridges.odd
    assert ridges.hit(number, 121.0, 1) is None


def test_a_segment_leaves_the_sheet_where_it_crosses_the_border() -> None:
    ridges = ridges_of_wide()
    leaves = ridges.exit_of((100.0, 100.0), (100.0, 500.0))
    assert leaves is not None
    assert leaves == (100.0, 200.0)
    assert ridges.exit_of((100.0, 100.0), (10.0, 10.0)) is None


def test_from_each_node_of_a_rectangle_perpendiculars_run_to_the_border_of_the_sheet() -> None:
    ridges = ridges_of_wide()
    found = trace(ridges, ridges.odd)
    assert sorted(path.start for path in found.paths) == sorted([*ridges.odd] * 3)
    assert {path.end for path in found.paths} == {-1}
    assert {*found.lines} == {0, 1}  # one that goes on along the ridge between the nodes makes no fold of its own
    upright = [number for number, path in enumerate(found.paths) if path.start == ridges.odd[0] and found.lines[number]]
    assert found.straight_on == [tuple(upright), *found.straight_on[1:]]
    assert found.line_count(upright) == 1
    division = Division(found, [0])
    assert set(division.path_of.values()) == {0}
    facets, creases = division.planar()
    assert sum(len({*pair}) for _, pair in creases) == 2 * len(creases)
    assert {facet for _, pair in creases for facet in pair} == set(range(len(facets)))


def test_without_any_of_its_perpendiculars_a_node_is_named() -> None:
    with pytest.raises(UnfoldableError, match=r"at \((80|120)\.0, 100\.0\) mm ends"):
        Perpendiculars(ridges_of_wide(), []).require_ends()


def test_too_many_creases_are_refused_only_where_a_bound_is_asked_for() -> None:
    found = trace(ridges_of_wide(), ridges_of_wide().odd)
    assert len(divide_sheet(found, [0, 3], most_creases=np.inf).creases) > 5
    with pytest.raises(UnfoldableError, match="this method takes at most 5"):
        divide_sheet(found, [0, 3], most_creases=5)


def test_all_four_sides_of_a_rectangle_tied_make_it_a_square() -> None:
    moved = with_corners_moved(WIDE, SHEET, [frozenset(INSIDE)], [])
    assert moved is not None
    width, height = np.ptp(moved.loops[0], axis=0)
    assert width == pytest.approx(height)
    assert 80 < width < 120


def test_sides_on_a_line_that_is_to_be_kept_stay_on_it() -> None:
    # nearly a square, with a bay that divides its right side in two, 1 and 5; the square's sides are tied
    loop = [(0, 0), (90, 0), (90, 40), (121, 40), (121, 70), (90, 70), (90, 95), (0, 95)]
    tie = frozenset(Flank(side, True) for side in (0, 1, 6, 7))
    off = []
    for lines in ([], [(1, 5)]):
        moved = with_corners_moved(make_shape([loop]), SHEET, [tie], [], lines)
        assert moved is not None
        right = moved.loops[0][[1, 2, 5, 6]]
        off.append(np.linalg.svd(right - right.mean(axis=0), compute_uv=False)[1])
    assert off[1] < 1e-9 < 0.1 < off[0]


def test_a_side_that_vanishes_where_derivatives_are_taken_is_no_error() -> None:
    # moved by that difference, the last corner comes to lie exactly on the first
    tiny = DIFFERENCE * SHEET.diagonal
    loop = np.array([(0.0, 0.0), (90.0, 0.0), (80.0, 70.0), (3.0, 60.0), (-tiny, 0.0)])
    meeting = Meeting(frozenset({Flank(0, True), Flank(1, True), Flank(4, True)}), (Flank(0, True),), frozenset(INSIDE))
    assert with_corners_moved(Shape((loop,), (-1,)), SHEET, [], [meeting]) is None


def test_a_side_of_no_length_has_no_skeleton_and_is_not_moved() -> None:
    loop = np.array([(40.0, 60.0), (160.0, 60.0), (160.0, 60.0), (160.0, 140.0)])
    flat = Shape((loop,), (-1,))
    with pytest.raises(UnfoldableError, match=r"no straight skeleton: two points are at \(160, 60\)"):
        skeleton_of(flat, SHEET)
    assert with_corners_moved(flat, SHEET, [frozenset(INSIDE[:3])], []) is None


def test_a_crease_of_no_length_has_no_layer_order() -> None:
    folded = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (1.0, 0.0)])
    with pytest.raises(UnfoldableError, match="a crease has no length"):
        OrderConditions(folded, [[0, 1, 2], [0, 3, 2]], [((1, 3), (0, 1))], [True, False])


def test_a_trial_costs_what_its_facets_do_and_a_failed_one_what_is_typical() -> None:
    budget = Budget(2.0)
    budget.start_division()
    failed = budget.spent
    assert failed == division_cost(400)
    budget.divided(120)
    assert budget.spent == pytest.approx(division_cost(120))
    budget.ordered(240, 3)
    assert budget.spent == pytest.approx(division_cost(120) + order_cost(240, 3))
    assert budget.part == pytest.approx(budget.spent / 2)
    budget.ordered(10_000, 3)
    assert budget.part == 1.0


def test_the_needed_perpendiculars_of_a_square_are_none() -> None:
    square = make_shape([[(x + 100, y + 100) for x, y in rectangle(80, 80)]])
    assert Ridges(skeleton_of(square, SHEET), SHEET).odd == []
