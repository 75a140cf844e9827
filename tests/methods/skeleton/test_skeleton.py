"""Folding along the straight skeleton: skeletons, perpendiculars, layer orders, whole patterns."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable
from itertools import islice, product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from support.several_loops import random_loops
from support.strategies import Points, rectangle, star

import foldcut
from foldcut.cli.main import main
from foldcut.core.arrays import index_array
from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape
from foldcut.drawing.placement import parse_sheet, place
from foldcut.drawing.shape import make_shape
from foldcut.geometry.planar_graph import edge_faces
from foldcut.methods.skeleton import search, trial
from foldcut.methods.skeleton.choices import away_from_roots, exchanges, fewest_folds, is_even, promising_sets
from foldcut.methods.skeleton.facets import Facets, divide_sheet
from foldcut.methods.skeleton.layer_order import OrderConditions, layer_order
from foldcut.methods.skeleton.perpendiculars import Perpendiculars, Ridges, trace
from foldcut.methods.skeleton.search import Skeletal, fold_skeletal
from foldcut.methods.skeleton.skeleton_faces import skeleton_of
from foldcut.methods.skeleton.snap import tie_nodes, tie_perpendiculars
from foldcut.pattern.ranking import shortest_crease
from foldcut.proof.verify import verify
from foldcut.readers import read_shape
from foldcut.samples import sample_path

SHEET = parse_sheet("a4-portrait")
# No side is on a line with another: the hole turned by a little.
HOLED: list[Points] = [rectangle(12, 9), [(-2.1, -1.6), (1.9, -2.0), (2.2, 1.7), (-1.8, 2.0)]]
ROOF: list[Points] = [[(0, 0), (10, 0), (10, 4), (7, 4), (7, 7), (5, 7), (5, 4), (0, 4)]]


def placed(loops: list[Points], margin: float = 30.0) -> Shape:
    return place(make_shape(loops), SHEET, margin=margin)[0]


def perpendiculars(loops: list[Points]) -> Perpendiculars:
    ridges = Ridges(skeleton_of(placed(loops), SHEET), SHEET)
    return trace(ridges, ridges.odd)


def rough(loops: list[Points], off: float, seed: int = 0) -> list[Points]:
    """The loops with corners moved at random, relative to the shape's size."""
    random = np.random.default_rng(seed)
    size = np.ptp(np.concatenate(loops), axis=0).max()
    return [(np.array(loop) + random.uniform(-off, off, (len(loop), 2)) * size).tolist() for loop in loops]


@pytest.mark.parametrize("loops", [HOLED, random_loops(1, holes=True), random_loops(1, holes=False)])
def test_perpendiculars_are_at_right_angles_to_their_sides_and_make_the_creases_at_nodes_even(
    loops: list[Points],
) -> None:
    found = perpendiculars(loops)
    skeleton = found.ridges.skeleton
    for path in found.paths:
        for piece in path.pieces:
            along = skeleton.along[skeleton.faces[piece.face].side]
            assert abs(np.subtract(piece.end, piece.start) @ along) < 1e-9 * SHEET.diagonal
    for taken in [*fewest_folds(found, 3), *away_from_roots(found)]:
        count = dict.fromkeys(found.ridges.odd, 0)
        for number in taken:
            for node in (found.paths[number].start, found.paths[number].end):
                if node >= 0:
                    count[node] = count.get(node, 0) + 1
        assert all((found.ridges.degree[node] + number) % 2 == 0 for node, number in count.items())


@pytest.mark.parametrize("loops", [HOLED, random_loops(3, holes=True), random_loops(3, holes=False)])
def test_folded_facets_keep_their_form_and_the_shape_is_above_the_cut_line(loops: list[Points]) -> None:
    found = perpendiculars(loops)
    facets = divide_sheet(found, fewest_folds(found, 1)[0])
    ends = np.array([edge for edge, _ in facets.creases])
    for points in (facets.flat, facets.folded):
        assert np.isfinite(points[ends]).all()
    flat, folded = (np.hypot(*(points[ends[:, 0]] - points[ends[:, 1]]).T) for points in (facets.flat, facets.folded))
    np.testing.assert_allclose(flat, folded, atol=1e-9)
    for facet, up in zip(facets.facets, facets.up, strict=True):
        x, y = facets.folded[facet].T
        area = (x * np.roll(y, -1) - y * np.roll(x, -1)).sum()
        assert (area > 0) == up


def test_corners_are_moved_so_that_nodes_of_a_roughly_drawn_star_meet() -> None:
    drawn = placed(rough([star(5, 0.4)], 1e-4))
    tied, moved = tie_nodes(drawn, SHEET, 0.1)
    assert 0 < moved <= 0.1
    assert moved == pytest.approx(np.hypot(*(tied.loops[0] - drawn.loops[0]).T).max())
    assert len(Ridges(skeleton_of(drawn, SHEET), SHEET).odd) > 0
    assert Ridges(skeleton_of(tied, SHEET), SHEET).odd == []
    # not farther than allowed
    same, none = tie_nodes(drawn, SHEET, 1e-4)
    assert none <= 1e-4
    assert Ridges(skeleton_of(same, SHEET), SHEET).odd != []


def test_a_rough_star_has_ten_creases_once_its_nodes_are_tied() -> None:
    made = fold_skeletal(placed(rough([star(5, 0.4)], 1e-4)), SHEET, near=0.1)
    assert made.creases.crease_count == 10
    assert verify(made.creases, made.folded.layers, made.shape) == []


def test_corners_are_moved_so_that_perpendiculars_come_to_the_nodes_that_they_nearly_pass() -> None:
    sheet = parse_sheet("a4-landscape")
    swan = place(make_shape(read_shape(sample_path("swan")).loops), sheet)[0]

    def met(shape: Shape) -> int:
        ridges = Ridges(skeleton_of(shape, sheet), sheet)
        return sum(path.end >= 0 for path in trace(ridges, ridges.odd).paths)

    tied, moved = tie_perpendiculars(swan, sheet, 0.5)
    assert 0 < moved <= 0.5
    assert moved == pytest.approx(np.hypot(*(tied.loops[0] - swan.loops[0]).T).max())
    assert met(tied) > met(tie_nodes(swan, sheet, 0.5)[0])
    assert tie_perpendiculars(swan, sheet, 1e-3) == (swan, 0.0)  # not farther than allowed
    made, other = (fold_skeletal(swan, sheet, near=near, effort="fast") for near in (0.5, 0.0))
    assert verify(made.creases, made.folded.layers, made.shape) == []
    assert made.creases.crease_count < other.creases.crease_count
    assert shortest_crease(made.creases) > 3 > shortest_crease(other.creases)


def test_corners_are_not_moved_so_that_sides_cross() -> None:
    # two corners that nearly touch: they would be joined, and sides would cross
    slit = [(105, 246), (33, 215), (10, 172), (25, 91), (91.92, 50.80), (42, 174)]
    slit += [(130, 212), (174, 145), (91.94, 50.81), (176, 81), (200, 172), (152, 234)]
    shape = make_shape([slit])
    for near in (0.05, 0.25, 1.0):
        for tie in (tie_nodes, tie_perpendiculars):
            tied, moved = tie(shape, SHEET, near)
            assert moved <= near
            assert shapely.Polygon(tied.loops[0]).is_valid
    crossing = np.array([(0.0, 0), (9, 9), (9, 0), (0, 8)])
    with pytest.raises(UnfoldableError, match="no straight skeleton: edges 0 and 2 cross"):
        skeleton_of(Shape((crossing,), (-1,)), SHEET)


def test_sides_on_one_line_stay_there_when_corners_are_moved() -> None:
    sheet = parse_sheet("a4-landscape")
    house = place(make_shape(read_shape(sample_path("house")).loops), sheet)[0]
    tied, moved = tie_perpendiculars(house, sheet, 0.25)
    assert moved > 0.01
    shared = [
        [face.flanks for face in skeleton_of(shape, sheet).faces if len(face.flanks) > 1] for shape in (house, tied)
    ]
    assert len(shared[0]) == 2  # the roof beside the chimney, the ground beside the door
    assert shared[0] == shared[1]


def test_a_node_that_nearly_is_on_another_ridge_is_put_there() -> None:
    shape = place(make_shape(read_shape(sample_path("letter-a")).loops), SHEET)[0]
    made = fold_skeletal(shape, SHEET, near=0.2)
    other = fold_skeletal(shape, SHEET, near=0.05)
    assert made.moved_mm <= 0.2
    assert made.creases.crease_count < other.creases.crease_count
    assert shortest_crease(made.creases) > 1 > shortest_crease(other.creases)


def test_choices_without_a_layer_order_are_refused_by_the_solver() -> None:
    found = perpendiculars([loop.tolist() for loop in random_loops(0, holes=True)])
    first = divide_sheet(found, fewest_folds(found, 1)[0])
    with pytest.raises(UnfoldableError, match="cannot be put in an order"):
        layer_order(trial.conditions_of(first))
    rooted = divide_sheet(found, away_from_roots(found)[0])
    order = layer_order(trial.conditions_of(rooted))
    assert sorted(order) == list(range(len(rooted.facets)))


def conditions_of(found: Perpendiculars, taken: Iterable[int]) -> tuple[Facets, OrderConditions]:
    facets = divide_sheet(found, sorted(taken))
    return facets, trial.conditions_of(facets)


def may_have_order(conditions: OrderConditions) -> bool:
    """Whether the conditions on pairs can be kept, circles left aside, with an unknown for every pair."""
    from pysat.solvers import Solver

    def literal(above: int, below: int) -> int:
        number = int(conditions.number[min(above, below), max(above, below)])
        return number if above > below else -number

    with Solver(name="minisat22") as solver:
        for facet, left, right in conditions.across.tolist():
            one, other = literal(facet, left), literal(facet, right)
            solver.add_clause([one, -other])
            solver.add_clause([-one, other])
        for a, b, c, d in conditions.coinciding.tolist():
            four = [literal(a, c), literal(b, c), literal(a, d), literal(b, d)]
            for signs in product((1, -1), repeat=4):
                if np.prod(signs) < 0:
                    solver.add_clause([sign * one for sign, one in zip(signs, four, strict=True)])
        return bool(solver.solve())


@pytest.mark.parametrize("seed", [0, 1, 4])
def test_contradictions_are_found_just_where_a_solver_with_an_unknown_for_every_pair_finds_no_order(seed: int) -> None:
    found = perpendiculars([loop.tolist() for loop in random_loops(seed, holes=True)])
    start = frozenset(fewest_folds(found, 1)[0])
    said = set()
    for taken in [start, *map(frozenset, away_from_roots(found)[:6]), *(start ^ one for one in exchanges(found)[:6])]:
        _, conditions = conditions_of(found, taken)
        said.add(may_have_order(conditions))
        assert may_have_order(conditions) == (conditions.contradictory == (0, 0))
    assert said == {True, False}


@pytest.mark.parametrize("seed", [0, 1, 4])
def test_without_a_change_in_its_cause_a_contradiction_stays(seed: int) -> None:
    found = perpendiculars([loop.tolist() for loop in random_loops(seed, holes=True)])
    start = frozenset(fewest_folds(found, 1)[0])
    facets, conditions = conditions_of(found, start)
    assert conditions.contradictory[0]
    cause = trial.perpendiculars_in(found, facets, conditions.facets_of_contradictions()[0])
    elsewhere = [one for one in exchanges(found) if not one & cause]
    assert elsewhere
    for one in exchanges(found):
        assert is_even(found, start ^ one)
    for one in elsewhere:
        assert conditions_of(found, start ^ one)[1].contradictory[0]


def test_from_a_set_without_an_order_the_search_walks_to_one_that_has(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "promising_sets", lambda ridges: islice(promising_sets(ridges), 1))
    shape, _ = place(make_shape(random_loops(4, holes=True)), SHEET, margin=40)
    made = fold_skeletal(shape, SHEET, near=0.0, effort="fast")
    assert verify(made.creases, made.folded.layers, made.shape) == []
    monkeypatch.setattr(search.Search, "walk", lambda *_: None)
    with pytest.raises(UnfoldableError, match="cannot be put in an order"):
        fold_skeletal(shape, SHEET, near=0.0, effort="fast")


def test_of_each_variant_of_a_drawing_a_set_of_both_kinds_is_tried_with_nothing_left_to_spend(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    sheet, tried = parse_sheet("a4-landscape"), Counter[float]()

    def counted(drawing: trial.Drawing, *arguments: Any) -> trial.Trial:
        tried[drawing.moved] += 1
        return trial.attempt(drawing, *arguments)

    monkeypatch.setattr(search, "attempt", counted)
    monkeypatch.setattr(search, "promise", lambda *_: (0.0,))  # as if any set could be better
    swan = place(make_shape(read_shape(sample_path("swan")).loops), sheet)[0]
    fold_skeletal(swan, sheet, near=0.5, seconds=0.1)
    assert len(tried) > 2
    assert min(tried.values()) == search.LEAST_SETS


def test_an_order_with_one_pair_the_other_way_is_rejected() -> None:
    result = foldcut.fold(HOLED, method="skeleton")
    creases, layers = result.folded_pattern.creases, result.folded_pattern.folded.layers
    shape = result.folded_pattern.shape
    assert verify(creases, layers, shape) == []
    rank = np.argsort(layers)
    for one, other in edge_faces(creases).tolist():
        if min(one, other) >= 0:
            swapped = layers.copy()
            swapped[[rank[one], rank[other]]] = other, one
            assert verify(creases, index_array(swapped), shape) != []


@pytest.mark.parametrize(("name", "creases"), [("ring", 12), ("two-triangles", 9), ("letter-a", 46)])
def test_samples_are_verified_with_few_creases(name: str, creases: int) -> None:
    result = foldcut.fold(sample_path(name), method="skeleton")
    assert result.findings == ()
    assert result.folded_pattern.creases.crease_count <= creases


@pytest.mark.parametrize("holes", [True, False], ids=["holes", "components"])
@pytest.mark.parametrize("seed", [3, 6, 9])
def test_random_shapes_are_verified(seed: int, holes: bool) -> None:
    result = foldcut.fold(random_loops(seed, holes=holes), method="skeleton", margin=40, effort="fast")
    assert result.findings == ()
    assert result.folded_pattern.creases.crease_count < 300


def test_where_no_perpendicular_ends_the_reason_names_the_node() -> None:
    with pytest.raises(
        UnfoldableError, match=r"no perpendicular from the skeleton's node at \(.*\) mm ends within 600"
    ):
        fold_skeletal(placed(rough([star(5, 0.4)], 1e-4)), SHEET, near=0.0)


def test_what_would_take_too_long_is_refused_at_once() -> None:
    with pytest.raises(UnfoldableError, match=r"the drawing has 130 corners; this method takes at most 120"):
        fold_skeletal(placed([star(65, 0.8)]), SHEET, near=0.0)
    shape, _ = place(make_shape(random_loops(2, holes=False)), SHEET, margin=40)
    with pytest.raises(UnfoldableError, match=r"the pattern has 1,\d+ creases; this method takes at most 1,000"):
        fold_skeletal(shape, SHEET, near=0.0)


def test_a_ribbon_wider_than_the_skeleton_is_refused() -> None:
    assert foldcut.fold(HOLED, method="skeleton", ribbon=1.0).findings == ()
    with pytest.raises(UnfoldableError, match="within the ribbon of 60 mm"):
        foldcut.fold(HOLED, method="skeleton", ribbon=60.0)


def test_auto_takes_the_skeleton_for_several_loops_and_the_command_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    drawing = tmp_path / "holed.json"
    drawing.write_text(json.dumps({"loops": HOLED}))
    assert main(["make", str(drawing), "--effort", "fast", "-o", str(tmp_path / "holed.fold")]) == 0
    said = capsys.readouterr().out
    assert "skeleton: " in said
    assert "verified  " in said
    assert main(["check", str(tmp_path / "holed.fold"), "--shape", str(drawing)]) == 0


def test_moved_corners_are_told_and_how_far_they_may_move_can_be_said() -> None:
    loops = rough([rectangle(12, 12), rectangle(6, 6)], 5e-5)
    result = foldcut.fold(loops, method="skeleton")
    assert result.findings == ()
    assert any("corners moved by at most 0.0" in note for note in result.notes)
    exactly = foldcut.fold(loops, method="skeleton", adjust=0.0)
    assert exactly.notes == ()
    assert exactly.folded_pattern.creases.crease_count > result.folded_pattern.creases.crease_count
    with pytest.raises(foldcut.BadInputError, match="how far corners may be moved is -1"):
        foldcut.fold(loops, method="skeleton", adjust=-1)


def test_the_command_moves_corners_as_far_as_it_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    drawing = tmp_path / "star.json"
    drawing.write_text(json.dumps({"loops": rough([star(5, 0.4)], 1e-4)}))
    command = ["make", str(drawing), "--method", "skeleton", "-o", str(tmp_path / "star.fold")]
    assert main([*command, "--adjust", "0mm"]) != 0
    assert "try a larger --adjust" in capsys.readouterr().err
    assert main([*command, "--adjust", "0.1mm"]) == 0
    assert "corners moved by at most 0.0" in capsys.readouterr().out


def test_ctrl_c_takes_the_best_so_far_and_tries_no_other_method(monkeypatch: pytest.MonkeyPatch) -> None:
    ordered, made = trial.ordered, list[Skeletal]()

    def once(*arguments: Any) -> Skeletal:
        if made:
            raise KeyboardInterrupt
        made.append(ordered(*arguments))
        return made[-1]

    monkeypatch.setattr(trial, "ordered", once)
    for module in (trial, search):
        monkeypatch.setattr(module, "promise", lambda *_: (0.0,))  # as if any set could be better
    result = foldcut.fold(HOLED)
    assert result.findings == ()
    assert result.folded_pattern.creases is made[0].creases
    assert [attempt.method for attempt in result.attempts] == ["mirror", "skeleton"]


@pytest.mark.parametrize("degrees", [0.2, 0.5, 1.0, 2.0])
@pytest.mark.parametrize("margin", [10.0, 60.0, 90.0])
def test_a_needle_whose_sides_would_vanish_is_left_as_it_is(degrees: float, margin: float) -> None:
    tip = 100 * np.tan(np.radians(degrees / 2))
    shape = placed([[(0, 0), (100, -tip), (100, tip)]], margin)
    for near in (0.25, 0.05):
        moved, farthest = tie_perpendiculars(shape, SHEET, near)  # a division by nothing would be a RuntimeWarning
        assert farthest <= near
        assert all(np.hypot(*(np.roll(loop, -1, axis=0) - loop).T).min() > 1e-9 for loop in moved.loops)
