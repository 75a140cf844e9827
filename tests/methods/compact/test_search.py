"""The choice of turns and the search for few creases."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import shapely
from support.folded import fold_sample
from support.strategies import Points, cross, rectangle, regular, star, star_shaped, two_opt

import foldcut
from foldcut.core.arrays import Floats
from foldcut.core.model import CreasePattern, Finding, Shape, Sheet
from foldcut.drawing.placement import parse_sheet, place
from foldcut.drawing.shape import make_shape
from foldcut.geometry.wavefront import corner_lives, side_nodes
from foldcut.methods.compact import many_disks as crowded
from foldcut.methods.compact import search
from foldcut.methods.compact.lengthen import Mover
from foldcut.methods.compact.many_disks import crowded_solution
from foldcut.methods.compact.molecule import NotClosedError
from foldcut.methods.compact.pattern import Molecules, Walk, build_molecules, fold_molecules
from foldcut.methods.compact.search import Compact, fold_compact
from foldcut.methods.compact.sensitivity import vertex_slopes
from foldcut.methods.compact.turns import Outline, Program, Solution, Turns, sees_each_other
from foldcut.pattern.foldability import crease_numbers
from foldcut.proof.verify import verify
from foldcut.samples import sample_path

A4 = parse_sheet("a4")


def loop_of(points: list[tuple[float, float]], sheet: Sheet = A4) -> Floats:
    return place(make_shape([points]), sheet)[0].loops[0]


@pytest.mark.parametrize(
    ("shape", "most"),
    [
        ([(0, 0), (4, 0), (2, 3.4641016151377544)], 4),
        ([(0, 0), (4, 0), (1, 3)], 4),
        *((regular(n), 2 * n - 2) for n in range(3, 13)),
        (rectangle(3, 1), 10),
        (star(5, 0.4), 10),
        (star(6, 0.5), 12),
        ([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)], 12),
    ],
)
def test_simple_shapes_need_as_few_creases_as_measured(shape: list[tuple[float, float]], most: int) -> None:
    found = fold_compact(loop_of(shape), A4, effort="fast")
    if found.creases.crease_count > most:  # a short look is not enough for some
        found = fold_compact(loop_of(shape), A4, effort="normal")
    assert found.creases.crease_count <= most


@pytest.mark.parametrize(
    ("shape", "most"),
    [
        (cross(), 80),
        ([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)], 10),
        ([(0, 3), (0, 2), (1, 2), (1, 0), (2, 0), (2, 2), (3, 2), (3, 3)], 30),
    ],
)
def test_straight_lines_are_as_few_as_the_plan_asks(shape: list[tuple[float, float]], most: int) -> None:
    assert crease_numbers(fold_compact(loop_of(shape), A4, effort="fast").creases).lines <= most


@pytest.mark.parametrize("name", ["arrow", "fish", "heart", "kite", "letter-l", "letter-t", "swan"])
def test_samples_are_folded_verified_and_cut_exactly(name: str) -> None:
    result = fold_sample(name, method="compact")
    assert result.findings == ()
    paper = foldcut.fold(sample_path(name), method="paper")
    assert result.folded_pattern.creases.crease_count < 0.5 * paper.folded_pattern.creases.crease_count


def test_the_same_input_gives_the_same_pattern() -> None:
    loop = loop_of(star_shaped(np.random.default_rng(5), 9))
    one, two = (fold_compact(loop, A4, effort="fast") for _ in range(2))
    assert np.array_equal(one.creases.vertices_coords, two.creases.vertices_coords)
    assert one.tried == two.tried


def test_ctrl_c_returns_the_best_so_far(monkeypatch: pytest.MonkeyPatch) -> None:
    real, calls = search.build_molecules, 0

    def interrupted(*args: Any) -> Molecules:
        nonlocal calls
        calls += 1
        if calls == 4:
            raise KeyboardInterrupt
        return real(*args)

    monkeypatch.setattr(search, "build_molecules", interrupted)
    found = fold_compact(loop_of(regular(5)), A4, effort="best")
    assert found.interrupted
    assert found.creases.crease_count <= 10


def test_ctrl_c_before_the_first_pattern_is_passed_on(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(search, "build_molecules", interrupted)
    with pytest.raises(KeyboardInterrupt):
        fold_compact(loop_of(regular(5)), A4, effort="fast")


def test_progress_shows_the_best_count_so_far() -> None:
    seen: list[tuple[str, float]] = []
    fold_compact(loop_of(regular(6)), A4, effort="fast", progress=lambda text, part: seen.append((text, part)))
    assert seen[-1][0] == "searching: 10 creases"
    assert all(0 <= part < 1 for _, part in seen)


def test_a_ribbon_keeps_the_strip_beside_the_cut_free_of_events() -> None:
    found = fold_compact(loop_of(star_shaped(np.random.default_rng(1), 8)), A4, ribbon=0.5, effort="fast")
    heights = np.abs(found.folded.vertices_coords[:, 1])
    assert heights.min() >= 0.5


def test_a_shape_without_room_for_the_ribbon_is_refused() -> None:
    with pytest.raises(foldcut.UnfoldableError, match="no compact pattern was found"):
        fold_compact(loop_of(star(5, 0.4)), A4, ribbon=80.0, effort="fast")


def plain_turns(loop: Floats, root: int = 0) -> Turns:
    return Turns.build(np.ones(len(loop), dtype=bool), root, at_corner=False)


def covered(loop: Floats, clearance: float = 0.02) -> tuple[Outline, Program, Solution]:
    """A solution that leaves nothing of the boundary out, by adding turns as the search does."""
    outline = Outline(loop)
    program = Program(outline, plain_turns(loop))
    solution = program.solve(program.evenly(), clearance=clearance)
    while solution is not None and solution.left_out.any():
        turns, along = search._with_more_turns(outline, program.turns, solution)
        program = Program(outline, turns)
        solution = program.solve(along, clearance=clearance)
    assert solution is not None
    return outline, program, solution


@pytest.mark.parametrize("seed", range(4))
def test_turns_are_added_until_nothing_is_left_out(seed: int) -> None:
    outline, program, solution = covered(loop_of(star_shaped(np.random.default_rng(seed), 10 + 5 * seed)))
    assert program.true_clearance(solution) > 0.01
    step = np.abs(solution.x - np.roll(solution.x, -1))
    assert np.allclose(np.bincount(solution.turns.side, step), outline.length)
    assert (solution.x >= -1e-9).all()
    assert solution.x[0] == pytest.approx(0, abs=1e-9)
    assert (solution.turns.peak == (np.arange(len(step)) % 2 == 1)).all()


def test_a_narrow_bar_needs_more_turns_only_where_it_bends() -> None:
    assert len(covered(loop_of(rectangle(20, 1)), clearance=0.0005)[2].turns) == 8


def test_what_was_added_can_be_taken_away() -> None:
    turns = plain_turns(loop_of(regular(5)))
    more = turns.inserted(1)
    assert len(more) == len(turns) + 2
    fewer = more.removed(2)
    assert np.array_equal(fewer.side, turns.side)
    assert np.array_equal(fewer.peak, turns.peak)


def test_turns_in_a_pocket_that_is_turned_are_a_fan() -> None:
    outline = Outline(loop_of(star(5, 0.4)))
    peaks = ~outline.reflex
    turns = Turns.build(peaks, int(np.flatnonzero(outline.reflex)[0]), at_corner=True, turned=31)
    program = Program(outline, turns, careful=False)
    solution = program.solve(program.evenly(), clearance=0.01)
    assert solution is not None
    assert not solution.left_out.any()
    assert len(turns) == 10


def test_many_small_disks_always_fit() -> None:
    for seed in range(4):
        outline = Outline(loop_of(star_shaped(np.random.default_rng(seed), 10 + 5 * seed)))
        solution = crowded_solution(outline, 0.02)
        assert Program(outline, solution.turns).true_clearance(solution) >= 0.02
        step = np.abs(solution.x - np.roll(solution.x, -1))
        assert np.allclose(np.bincount(solution.turns.side, step), outline.length)


def test_corners_are_as_far_from_other_sides_as_the_nearest_of_all() -> None:
    for seed in range(4):
        outline = Outline(loop_of(star_shaped(np.random.default_rng(seed), 12)))
        count = len(outline.loop)
        sides = shapely.linestrings(np.stack([outline.loop, np.roll(outline.loop, -1, axis=0)], axis=1))
        away = shapely.distance(shapely.points(outline.loop)[:, None], sides)
        away[np.arange(count), np.arange(count)] = away[np.arange(count), np.arange(count) - 1] = np.inf
        nearest = away.min(axis=1)
        assert np.allclose(crowded._away(outline, 1.5 * nearest), nearest)
        assert np.isinf(crowded._away(outline, 0.5 * nearest)).all(), "nothing farther is looked at"


def test_a_shape_that_takes_too_long_is_folded_with_many_disks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "PATIENCE", 0)
    monkeypatch.setitem(search.EFFORTS, "fast", 1e-6)
    loop = loop_of(star_shaped(np.random.default_rng(3), 20))
    found = fold_compact(loop, A4, effort="fast")
    assert len(found.walk.x) > 60
    assert verify(found.creases, found.folded.layers, Shape((loop,), (-1,))) == []


def many_corners() -> Floats:
    random = np.random.default_rng(1)
    angles = (np.arange(160) + random.uniform(0.1, 0.9, 160)) * 2 * np.pi / 160
    reach = 80 + 15 * np.sin(7 * angles)
    return loop_of(list(zip(reach * np.cos(angles), reach * np.sin(angles), strict=True)))


def walks_of(found: Callable[[], object], monkeypatch: pytest.MonkeyPatch) -> list[Walk]:
    """The walks that are folded on the way."""
    walks: list[Walk] = []
    build = search.build_molecules

    def noting(walk: Walk, *rest: Any) -> Molecules:
        walks.append(walk)
        return build(walk, *rest)

    monkeypatch.setattr(search, "build_molecules", noting)
    found()
    return walks


def test_creases_that_are_too_short_to_be_told_apart_are_mended_where_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "PATIENCE", 0)
    loop = many_corners()
    shortest = search.shortest_crease(fold_compact(loop, A4, effort="fast").creases)
    least = 1.001 * shortest / A4.diagonal
    monkeypatch.setattr(search, "COINCIDENT", (least, 0.0))
    as_it_is = fold_compact(loop, A4, effort="fast")
    assert (as_it_is.tried, search.shortest_crease(as_it_is.creases)) == (1, shortest), "verified, so left as it is"
    monkeypatch.setattr(search, "COINCIDENT", (least, least))
    found: list[Compact] = []
    first, *_, last = walks_of(lambda: found.append(fold_compact(loop, A4, effort="fast")), monkeypatch)
    assert search.shortest_crease(found[0].creases) > 1.001 * shortest
    assert verify(found[0].creases, found[0].folded.layers, Shape((loop,), (-1,))) == []
    same = (last.points[:, None] == first.points).all(axis=2).any(axis=1)
    assert 0.9 < same.mean() < 1


def test_short_creases_are_mended_where_verification_finds_something(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "PATIENCE", 0)
    loop = many_corners()
    shortest = search.shortest_crease(fold_compact(loop, A4, effort="fast").creases)
    monkeypatch.setattr(search, "COINCIDENT", (1.001 * shortest / A4.diagonal, 0.0))
    answers = iter([[Finding("planar", "too near")], []])
    monkeypatch.setattr(search, "verify", lambda *_: next(answers))
    found: list[Compact] = []
    first, last = walks_of(lambda: found.append(fold_compact(loop, A4, effort="fast")), monkeypatch)
    assert search.shortest_crease(found[0].creases) > 1.001 * shortest
    same = (last.points[:, None] == first.points).all(axis=2).any(axis=1)
    assert 0.9 < same.mean() < 1, "only what they come from is moved"


def test_a_molecule_that_does_not_close_is_mended_where_it_does_not(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "PATIENCE", 0)
    loop, build = many_corners(), search.build_molecules
    calls: list[Walk] = []

    def failing(walk: Walk, *rest: Any) -> Molecules:
        calls.append(walk)
        if len(calls) < 3:
            raise NotClosedError("no", {17})
        return build(walk, *rest)

    monkeypatch.setattr(search, "build_molecules", failing)
    fold_compact(loop, A4, effort="fast")
    _, second, third = calls
    moved = np.flatnonzero(~(third.points[:, None] == second.points).all(axis=2).any(axis=1))
    assert 0 < len(moved) < 20
    assert np.hypot(*(third.points[moved] - second.points[17]).T).max() < 20


def test_a_time_too_short_for_one_program_is_not_spent_on_it(monkeypatch: pytest.MonkeyPatch) -> None:
    def program(*_: Any, **__: Any) -> Program:
        raise AssertionError("no time for this")

    monkeypatch.setattr(search, "Program", program)
    monkeypatch.setattr(search, "PATIENCE", 0)
    found = fold_compact(many_corners(), A4, seconds=100.0)
    assert len(found.walk.x) > 400


def test_the_time_allowed_ends_the_folding_of_very_many_turns() -> None:
    seen: list[float] = []
    with pytest.raises(foldcut.UnfoldableError, match=r"folding 160 corners takes longer than 0.001 s; .*--seconds"):
        fold_compact(many_corners(), A4, seconds=0.001, progress=lambda _, part: seen.append(part))
    assert max(seen) < 0.5


def test_ctrl_c_ends_the_folding_of_very_many_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "PATIENCE", 0)

    def interrupting(*_: object) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fold_compact(many_corners(), A4, effort="fast", progress=interrupting)


def test_a_crease_of_very_many_that_is_too_short_ends_the_folding(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "PATIENCE", 0)
    loop = many_corners()
    creases = fold_compact(loop, A4, effort="fast").creases
    parts: list[float] = []
    with pytest.raises(foldcut.CreaseTooShortError, match="with 160 corners .* than 0.5 mm; .*--simplify") as no:
        fold_compact(loop, A4, effort="fast", least=0.5, progress=lambda _, part: parts.append(part))
    assert parts == [0.0], "at once"
    assert 0 < no.value.length < 0.5
    ends = creases.vertices_coords[creases.edges_vertices]
    lengths = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    at = int(np.hypot(*(ends.mean(axis=1) - no.value.place).T).argmin())
    assert lengths[at] == pytest.approx(no.value.length, abs=1e-9), "the whole pattern has that crease"
    assert fold_compact(loop, A4, effort="fast", least=float(lengths.min())).tried == 1


def test_progress_of_many_turns_goes_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "PATIENCE", 0)
    told: list[tuple[str, float]] = []
    found = fold_compact(many_corners(), A4, effort="fast", progress=lambda *told_now: told.append(told_now))
    folding = [part for text, part in told if text == f"folding: {len(found.walk.x)} turns"]
    assert len(folding) > 4
    assert folding == sorted(folding)
    assert 0 < folding[0] < folding[-1] < 1


def test_a_feature_that_is_too_fine_is_refused_with_its_place(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crowded, "MOST_DISKS", 20)
    with pytest.raises(foldcut.UnfoldableError, match=r"feature near \(.* mm is so fine"):
        crowded_solution(Outline(loop_of([(0, 0), (40, 0), (0, 1)])), 0.02)


def test_turns_see_each_other_inside_or_outside_or_not_at_all() -> None:
    c = np.array([(0, 0), (6, 0), (6, 1), (1, 1), (1, 2), (6, 2), (6, 3), (0, 3)], dtype=float)
    turns = Turns(np.arange(8), np.ones(8, dtype=bool), np.ones(8, dtype=bool))
    i, j = np.array([0, 1, 2, 2, 3]), np.array([3, 6, 5, 4, 7])
    inside, outside = sees_each_other(Outline(c), c, turns, i, j)
    assert inside.tolist() == [True, False, False, False, True]
    assert outside.tolist() == [False, False, True, True, False]


def test_a_reflex_corner_falls_until_its_wavefront_meets_another() -> None:
    lives, falls = corner_lives(np.array([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)], dtype=float))
    assert lives[3] == pytest.approx(0.5)
    assert falls.tolist() == pytest.approx([0, 0, 0, 0.5, 0, 0])


def mover_of(points: Points) -> tuple[Mover, Callable[[Solution], tuple[Molecules, CreasePattern]]]:
    outline, _, solution = covered(loop_of(points))

    def folded(some: Solution) -> tuple[Molecules, CreasePattern]:
        molecules = build_molecules(some.walk(outline), A4)
        return molecules, fold_molecules(molecules, A4)[0]

    return Mover(outline, solution, folded, lambda creases: creases.edges_assignment != "B", careful=True), folded


def test_short_creases_are_made_longer() -> None:
    # this swan has a crease of 0.006 mm at first
    mover, _ = mover_of(two_opt(np.random.default_rng(3), 12))
    before = mover.lengths()[0]
    assert mover.lengthen(3.3)
    assert mover.lengths()[0] > 1.5 * before


def test_a_shortest_crease_goes_through_zero() -> None:
    mover, folded = mover_of(two_opt(np.random.default_rng(3), 12))
    for _ in range(4):
        mover.lengthen(3.3)
    number = len(mover.lengths())
    others = list(mover.across(3.3))
    assert others
    # not merely moved: with events in another order there are other creases, or others are the shortest
    edges = [folded(other.solution)[1].edges_vertices.tolist() for other in others]
    assert folded(mover.solution)[1].edges_vertices.tolist() not in edges
    assert all(abs(len(other.lengths()) - number) < 20 for other in others)


@pytest.mark.parametrize("seed", [3, 5, 11])
def test_slopes_of_vertices_are_what_differences_say(seed: int) -> None:
    mover, folded = mover_of(two_opt(np.random.default_rng(seed), 12))
    molecules, _ = folded(mover.solution)
    images = mover._basis
    program, solution = mover._program, mover.solution
    along = program.walked[:, : len(solution.x)] @ images
    direction = program.outline.direction[solution.turns.side]
    slopes = vertex_slopes(molecules, direction[:, :, None] * along[:, None], images)
    # where creases end beyond the sheet is left open
    on_sheet = (np.abs(np.array(molecules.vertices.flat) - A4.corners.mean(axis=0)) < A4.corners[2] / 2 + 1e-6).all(
        axis=1
    )
    step = 1e-7
    compared = 0
    for column in range(images.shape[1]):
        there, back = (folded(mover._moved(way * images[:, column]))[0].vertices for way in (step, -step))
        if len(there.flat) == len(molecules.vertices.flat) == len(back.flat):
            difference = (np.array(there.flat) - np.array(back.flat)) / (2 * step)
            same = on_sheet & (np.abs(difference).max(axis=1) < 1e3)  # events in another order number them otherwise
            assert same.sum() > 0.9 * on_sheet.sum()
            assert slopes[same, :, column] == pytest.approx(difference[same], rel=1e-3, abs=1e-3)
            compared += 1
    assert compared > images.shape[1] / 2


def test_the_skeletons_nodes_stand_over_the_sides_that_vanish() -> None:
    nodes = side_nodes(np.array([(0, 0), (3, 0), (3, 1), (0, 1)], dtype=float))
    assert {(node.side, round(node.along, 9), round(node.height, 9)) for node in nodes} >= {
        (1, 0.5, 0.5),
        (3, 0.5, 0.5),
    }
    triangle = side_nodes(np.array([(0, 0), (4, 0), (0, 3)], dtype=float))
    assert sorted((node.side, round(node.along, 9)) for node in triangle) == [(0, 1.0), (1, 3.0), (2, 2.0)]


@pytest.mark.parametrize("seed", range(int(os.environ.get("FOLDCUT_RANDOM_COMPACT", "24"))))
def test_random_polygons_are_folded_and_verified(seed: int) -> None:
    rng = np.random.default_rng(seed)
    corners = int(rng.integers(4, 61 if "FOLDCUT_RANDOM_COMPACT" in os.environ else 31))
    points = (star_shaped, two_opt)[seed % 2](rng, corners)
    result = foldcut.fold([points], method="compact", effort="fast", min_crease=0)
    assert result.findings == ()
