"""The ladder: which tolerances are tried, what is asked of the methods, and which outline is taken."""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any
from unittest import mock

import numpy as np
import pytest
from support.patterns import square_out_of_square
from support.strategies import rectangle, regular, star

import foldcut
from foldcut.core.arrays import points_array
from foldcut.core.errors import BadInputError, CreaseTooShortError, UnfoldableError
from foldcut.core.model import CreasePattern, FoldedState, Shape
from foldcut.core.units import rounded_up
from foldcut.drawing.laying import Laid, Laying
from foldcut.drawing.placement import Layout, parse_sheet
from foldcut.drawing.shape import make_shape
from foldcut.drawing.simplify import simplify
from foldcut.methods.base import Effort, Made, Wishes
from foldcut.methods.progress import Stages
from foldcut.pattern.ranking import shortest_crease
from foldcut.redraw.bounds import Bounds
from foldcut.redraw.distance import apart
from foldcut.redraw.ladder import (
    CORNERS_FOR_A_FOLD,
    FAR_OFF,
    FEWER_CORNERS_FOR_A_FOLD,
    Drawn,
    Ladder,
    Level,
    Tried,
    redraw_and_fold,
)
from foldcut.redraw.plans import Drawing
from foldcut.redraw.redrawing import LESS_WORK, WORK, Redrawn

A4 = parse_sheet("a4")


def uneven(seed: int, wide: float, high: float, waves: float = 0.0, count: int = 60) -> np.ndarray:
    """Return an oval with corners at angles that are not even, so that each tolerance leaves another number."""
    angles = np.sort(np.random.default_rng(seed).uniform(0, 2 * np.pi, count))
    return np.column_stack([wide * np.cos(angles), high * np.sin(angles)]) * (1 + waves * np.cos(5 * angles))[:, None]


CIRCLES = {"circle": uneven(1, 1.0, 1.0), "oval": uneven(2, 1.0, 0.6), "flower": uneven(3, 0.9, 1.0, 0.1)}
"""Drawings with many corners, which lose some at every tolerance."""


def drawn(loop: Any, sheet: str = "a4", **layout: Any) -> Drawn:
    shape = loop if isinstance(loop, Shape) else make_shape([np.array(loop, dtype=float)])
    return Drawn(shape, Laying(shape, Layout(parse_sheet(sheet), rotation=0.0, **layout)), "it")


class Folder:
    """Stands for the methods: a pattern with ``folds(corners)`` folds and creases of ``shortest(corners)`` mm."""

    def __init__(self, folds: Callable[[int], int | None], shortest: Callable[[int], float] = lambda _: 5.0) -> None:
        self.folds, self.shortest = folds, shortest
        self.asked: list[tuple[int, Wishes, Effort]] = []
        self.interrupted = False

    def __call__(self, laying: Laying, wishes: Wishes, effort: Effort, stages: Stages) -> Tried:
        stages.up_to(1.0)
        with stages("pretending"):
            return self.fold(laying.lay(), wishes, effort)

    def fold(self, laid: Laid, wishes: Wishes, effort: Effort) -> Tried:
        corners = laid.shape.corner_count
        self.asked.append((corners, wishes, effort))
        count = self.folds(corners)
        if count is None:
            raise UnfoldableError(f"{corners} corners do not fold")
        pattern = square_out_of_square()
        ends = pattern.creases.vertices_coords[pattern.creases.edges_vertices[pattern.creases.edges_assignment != "B"]]
        size = self.shortest(corners) / np.hypot(*(ends[:, 1] - ends[:, 0]).T).min()
        creases = CreasePattern(
            points_array(pattern.creases.vertices_coords * size),
            pattern.creases.edges_vertices,
            pattern.creases.edges_assignment,
            pattern.creases.faces_vertices,
        )
        folded = FoldedState(points_array(pattern.folded.vertices_coords * size), pattern.folded.layers)
        made = Made("compact", creases, folded, laid, 0.0, count, (), {}, interrupted=self.interrupted)
        return Tried(made, ())


def pretended(folder: Folder) -> Callable[..., None]:
    """Return what stands for the search for outlines: it leaves out corners, and ``folder`` folds what is left."""

    def redraw(drawing: Drawing, tolerance: float, *, found: Callable[[Redrawn], None], **_: Any) -> None:
        shape = simplify(drawing.frame.shape, tolerance).shape
        laid = replace(drawing.laid, shape=drawing.frame.on_sheet(shape))
        try:
            made = folder.fold(laid, Wishes(), Effort("fast")).made
        except UnfoldableError:
            return
        off = apart(shape.loops, drawing.frame.shape.loops)
        plan: Any = SimpleNamespace(laid=laid)
        found(Redrawn(plan, shape, made, made.actions, shortest_crease(made.creases) / drawing.frame.scale, off))

    return redraw


def climb(what: Drawn, folder: Folder, effort: Effort | None = None, **bounds: Any) -> Ladder:
    wishes = bounds.pop("wishes", Wishes())
    on_pattern = bounds.pop("on_pattern", None)
    effort = effort or Effort("fast")
    redrawn = mock.patch("foldcut.redraw.redrawing.redraw", bounds.pop("redraw", pretended(folder)))
    fewer = mock.patch("foldcut.redraw.ladder.FEWER_CORNERS_FOR_A_FOLD", bounds.pop("fewer", CORNERS_FOR_A_FOLD))
    as_it_is = mock.patch("foldcut.folding_steps.simple_first.easier", return_value=None)  # it takes most of the time
    with redrawn, fewer, as_it_is, mock.patch("foldcut.redraw.ladder.verify", return_value=[]):
        return redraw_and_fold(what, Bounds(**bounds), wishes, folder, effort, Stages(), on_pattern=on_pattern)


def told(ladder: Ladder) -> list[float]:
    return [round(level.tolerance_mm, 6) for level in ladder.levels]


def test_a_drawing_for_two_hands_is_taken_as_it_is_and_nothing_else_is_tried() -> None:
    ladder = climb(drawn(CIRCLES["circle"]), Folder(lambda corners: corners // 2))
    assert (told(ladder), ladder.taken) == ([0], 0)
    assert ladder.level.off_by_mm == 0
    assert ladder.level.drawn == ()
    assert ladder.after is None


def test_one_more_tolerance_says_what_it_would_cost() -> None:
    what = drawn(CIRCLES["circle"])
    folder = Folder(lambda corners: 999 if corners == what.whole.corner_count else corners // 2)
    ladder = climb(what, folder)
    assert ladder.taken > 0
    assert ladder.after is not None
    assert ladder.after.folds is not None
    assert ladder.level.folds is not None
    assert ladder.after.folds <= ladder.level.folds
    assert len(climb(what, folder, next_level=False).levels) == ladder.taken + 1


@pytest.mark.parametrize("name", CIRCLES)
def test_the_most_exact_outline_for_two_hands_is_taken(name: str) -> None:
    corners = [level.corners for level in climb(drawn(CIRCLES[name]), Folder(lambda _: 999)).levels]
    assert corners == sorted(corners, reverse=True), "each tolerance leaves fewer corners"
    middle = sorted(set(corners))[len(set(corners)) // 2]
    ladder = climb(drawn(CIRCLES[name]), Folder(lambda count: 60 if count <= middle else 61))
    assert ladder.level.corners == middle
    assert ladder.level.for_hands
    assert len(ladder.levels) == ladder.taken + 2 or ladder.level.tolerance_mm == 4
    before = ladder.levels[: ladder.taken]
    assert before
    assert not any(level.for_hands for level in before)


def test_a_larger_tolerance_is_taken_if_its_outline_is_nearer_to_the_drawing() -> None:
    def redraw(drawing: Drawing, tolerance: float, *, found: Callable[[Redrawn], None], **_: Any) -> None:
        def far(one: Redrawn) -> None:
            found(replace(one, off=0.2 if tolerance < 0.5 else 0.1))

        pretended(folder)(drawing, tolerance, found=far)

    folder = Folder(lambda count: 10 if count < 50 else 61)
    ladder = climb(drawn(CIRCLES["circle"]), folder, redraw=redraw)
    assert [level.for_hands for level in ladder.levels][-2:] == [True, True]
    assert ladder.levels[-2].off_by_mm > ladder.levels[-1].off_by_mm
    assert ladder.level is ladder.levels[-1]


@pytest.mark.parametrize(
    ("length", "text"), [(0.9036, "0.904"), (0.25, "0.25"), (1.001, "1.01"), (0.0, "0"), (12.31, "12.4")]
)
def test_a_length_is_rounded_up_so_that_at_most_is_true(length: float, text: str) -> None:
    assert rounded_up(length) == text


def test_an_outline_that_is_off_by_rounding_errors_only_is_not_off() -> None:
    def redraw(drawing: Drawing, tolerance: float, *, found: Callable[[Redrawn], None], **_: Any) -> None:
        pretended(folder)(drawing, tolerance, found=lambda one: found(replace(one, off=3e-14)))

    folder = Folder(lambda count: 10 if count < 50 else 61)
    ladder = climb(drawn(CIRCLES["circle"]), folder, redraw=redraw)
    assert ladder.level.tolerance_mm > 0
    assert ladder.level.off_by_mm == 0
    assert any("at most 0 mm off" in note for note in ladder.level.notes)


def test_a_crease_under_3_mm_of_the_frame_is_not_for_hands_on_any_sheet() -> None:
    many = CIRCLES["circle"]
    few = 30
    for sheet, times in (("a4", 1.0), ("a2", 2.0)):
        folder = Folder(lambda _: 10, lambda corners, t=times: (3.0 if corners <= few else 2.99) * t)  # type: ignore[misc]
        ladder = climb(drawn(many, sheet, margin=10.0 * times), folder)
        assert ladder.level.corners <= few
        assert ladder.level.tolerance_mm > 0
        assert not ladder.levels[0].for_hands


def test_where_none_is_for_hands_the_easiest_to_fold_is_taken() -> None:
    ladder = climb(drawn(CIRCLES["oval"]), Folder(lambda corners: 100 + corners))
    assert told(ladder) == [0, 0.25, 0.5, 1, 2, 4]
    assert ladder.taken == 5
    assert not ladder.level.for_hands
    assert ladder.after is None


def test_the_number_of_folds_can_be_asked_for() -> None:
    easy, hard = (climb(drawn(CIRCLES["circle"]), Folder(lambda count: 2 * count), folds=n) for n in (40, 80))
    assert easy.level.folds is not None
    assert hard.level.folds is not None
    assert easy.level.folds <= 40 < hard.level.folds <= 80
    assert easy.level.off_by_mm > hard.level.off_by_mm


def test_levels_have_names_and_the_easy_one_takes_the_fewest_folds() -> None:
    folder = Folder(lambda corners: corners // 2)
    assert told(climb(drawn(CIRCLES["circle"]), folder, level="exact")) == [0]
    assert told(climb(drawn(CIRCLES["circle"]), Folder(lambda _: 99), level="fine")) == [0, 0.25, 0.5]
    assert told(climb(drawn(CIRCLES["circle"]), Folder(lambda _: 99), level="normal")) == [0, 0.25, 0.5, 1, 2]
    easy = climb(drawn(CIRCLES["circle"]), folder, level="easy")
    assert told(easy) == [0, 0.25, 0.5, 1, 2, 4]
    assert easy.taken == 5
    assert climb(drawn(CIRCLES["circle"]), folder).taken == 0


@pytest.mark.parametrize("tolerance", [0.25, 0.7, 1.5, 6.0])
@pytest.mark.parametrize("name", CIRCLES)
def test_no_outline_is_farther_from_the_drawing_than_the_bound(name: str, tolerance: float) -> None:
    what = drawn(CIRCLES[name], "a3")
    ladder = climb(what, Folder(lambda _: 99), tolerance=tolerance)
    assert max(told(ladder)) == pytest.approx(tolerance) or ladder.levels[-1].off_by_mm <= tolerance
    for level in ladder.levels:
        assert level.laid is not None
        loops = what.laying.on_sheet(what.whole.loops, level.laid)
        assert apart(level.laid.shape.loops, loops) == pytest.approx(level.off_by_mm, abs=0.05)
        assert level.off_by_mm <= level.tolerance_mm * (1 + 1e-9)


def test_tolerances_are_in_proportion_to_the_sheet() -> None:
    small, large = (
        climb(drawn(CIRCLES["circle"], sheet, margin=margin), Folder(lambda _: 99))
        for sheet, margin in (("210x297", 10.0), ("420x594", 20.0))
    )
    assert told(large) == pytest.approx([2 * tolerance for tolerance in told(small)], rel=1e-6)
    assert [level.corners for level in large.levels] == [level.corners for level in small.levels]


def test_exact_moves_no_corner() -> None:
    for bounds in ({"exact": True}, {"level": "exact"}, {"tolerance": 0.0}):
        folder = Folder(lambda _: 99)
        ladder = climb(drawn(CIRCLES["circle"]), folder, wishes=Wishes(symmetry=1.0), **bounds)
        assert told(ladder) == [0]
        (asked,) = folder.asked
        assert (asked[1].adjust, asked[1].symmetry) == (0.0, 0.0)


def test_a_small_bound_also_bounds_what_is_moved_in_the_drawing_as_it_is() -> None:
    folder = Folder(lambda _: 99)
    climb(drawn(CIRCLES["circle"]), folder, tolerance=0.1, wishes=Wishes(symmetry=3.0))
    assert (folder.asked[0][1].adjust, folder.asked[0][1].symmetry) == pytest.approx((0.1, 0.1))


def test_the_first_pattern_is_handed_over_at_once_and_only_better_ones_after_it() -> None:
    found: list[tuple[float, int]] = []
    folds = iter([200, 150, 170, 90, 50, 10])
    folder = Folder(lambda _: next(folds))

    def on_pattern(level: Level) -> None:
        found.append((level.tolerance_mm, len(folder.asked)))
        assert level.verified
        assert level.pattern is not None

    ladder = climb(drawn(CIRCLES["circle"]), folder, on_pattern=on_pattern)
    assert found == [(0, 1), (0.25, 2), (1, 4), (2, 5)], "each before the next one was begun; 0.5 was worse"
    assert [level.folds for level in ladder.levels] == [200, 150, 170, 90, 50, 10]
    assert ladder.level.folds == 50


@pytest.mark.parametrize("at", [2, 3, 5])
def test_ctrl_c_takes_the_best_so_far(at: int) -> None:
    folder = Folder(lambda _: 99)

    def folds(corners: int) -> int:
        if len(folder.asked) == at:
            raise KeyboardInterrupt
        return 100 + corners

    folder.folds = folds
    ladder = climb(drawn(CIRCLES["oval"]), folder)
    assert len(ladder.levels) == at - 1
    assert ladder.interrupted
    assert ladder.taken == at - 2


def test_ctrl_c_takes_the_pattern_of_the_short_look_at_the_drawing_as_it_is() -> None:
    class Impatient(Folder):
        def fold(self, laid: Laid, wishes: Wishes, effort: Effort) -> Tried:
            if effort.name != "fast":
                raise KeyboardInterrupt
            return super().fold(laid, wishes, effort)

    ladder = climb(drawn(CIRCLES["circle"]), Impatient(lambda _: 65), Effort("normal"))
    assert ladder.interrupted
    assert (ladder.level.tolerance_mm, ladder.level.folds) == (0, 65)
    with pytest.raises(KeyboardInterrupt):
        climb(drawn(CIRCLES["circle"]), Impatient(lambda _: 999), Effort("normal"), level="exact")


@pytest.mark.parametrize("tolerance", [0, 0.25, 1])
def test_ctrl_c_takes_the_pattern_that_was_told_a_moment_ago(tolerance: float) -> None:
    folds = iter([200, 150, 100, 90, 80, 70])

    def interrupted(level: Level) -> None:
        if level.tolerance_mm == tolerance:
            raise KeyboardInterrupt

    ladder = climb(drawn(CIRCLES["circle"]), Folder(lambda _: next(folds)), on_pattern=interrupted)
    assert ladder.interrupted
    assert ladder.level.tolerance_mm == tolerance


def test_ctrl_c_ends_the_command_where_there_is_nothing_to_take() -> None:
    def folds(corners: int) -> int:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        climb(drawn(CIRCLES["oval"]), Folder(folds))


def test_a_method_that_was_interrupted_ends_the_search() -> None:
    folder = Folder(lambda _: 99)
    folder.interrupted = True
    ladder = climb(drawn(CIRCLES["oval"]), folder)
    assert (len(ladder.levels), ladder.interrupted) == (1, True)


def test_a_limit_in_seconds_takes_the_best_so_far(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    folder = Folder(lambda _: 99)

    def folds(corners: int) -> int:
        now[0] += 2.0
        return 100 + corners

    folder.folds = folds
    ladder = climb(drawn(CIRCLES["oval"]), folder, Effort("fast", 5.0))
    assert (len(ladder.levels), ladder.interrupted, ladder.taken) == (3, True, 2)
    given = [effort.seconds for _, _, effort in folder.asked]
    assert given[0] == 2.0, "not all of it is for the drawing as it is"


def test_if_there_is_no_pattern_when_the_seconds_are_over_that_is_said_plainly() -> None:
    many = regular(400)
    with pytest.raises(UnfoldableError, match=r"^no pattern was found in 0.001 s; allow more with --seconds"):
        climb(drawn(many), Folder(lambda _: None), Effort("fast", 0.001))


@pytest.mark.parametrize("sheet", ["a4", "a3"])
def test_if_nothing_folds_the_error_has_a_larger_tolerance_that_does(sheet: str) -> None:
    oval = drawn(CIRCLES["oval"], sheet)
    folder = Folder(lambda corners: 30 if corners <= 8 else None)
    with pytest.raises(UnfoldableError, match="has no pattern, either; allow more: --tolerance") as caught:
        climb(oval, folder)
    found = re.search("--tolerance ([0-9.]+)mm gives a pattern of 30 folds; --method paper may fold", str(caught.value))
    assert found is not None
    ladder = climb(oval, folder, tolerance=float(found[1]))
    assert (ladder.level.tolerance_mm, ladder.level.folds) == (pytest.approx(float(found[1])), 30)


def test_what_helps_where_nothing_folds_is_only_what_was_asked_for() -> None:
    oval = drawn(CIRCLES["oval"])
    with pytest.raises(UnfoldableError, match=r"do not fold; leave out --exact: --tolerance 8mm gives a pattern of 9"):
        climb(oval, Folder(lambda corners: 9 if corners <= 12 else None), exact=True)
    with pytest.raises(UnfoldableError, match=r"no pattern, either; --method paper may fold the drawing as it is"):
        climb(oval, Folder(lambda _: None))
    with pytest.raises(UnfoldableError, match=r"corners do not fold$"):
        climb(oval, Folder(lambda _: None), method="compact")


def test_a_drawing_with_too_many_corners_is_not_tried_as_it_is_unless_it_is_asked_for() -> None:
    many = uneven(4, 1.0, 0.8, count=70)
    folder = Folder(lambda _: 50)
    ladder = climb(drawn(many), folder)
    assert ladder.levels[0].failure.startswith("not tried: 70 corners")
    assert folder.asked[0][0] < 70
    assert climb(drawn(many), folder, exact=True).level.corners == 70
    assert climb(drawn(many), folder, folds=80).level.corners == 70
    half = uneven(4, 1.0, 0.8, count=90)
    half = half[half[:, 1] > 0.02]
    symmetric = {"one axis": np.concatenate([half, half[::-1] * (1, -1)]), "many": np.array(regular(240))}
    assert len(symmetric["one axis"]) > 60
    for name, loop in symmetric.items():
        assert climb(drawn(loop), folder).taken == 0, name


def test_drawings_that_may_be_drawn_far_off_are_tried_as_they_are_only_with_fewer_corners() -> None:
    """Of 60 folds that are allowed, half as many corners, unless no outline may be far from the drawing."""
    given = drawn(uneven(1, 1.0, 1.0, count=45))
    for tolerance, tried in ((None, False), (FAR_OFF, False), (0.9 * FAR_OFF, True)):
        folder = Folder(lambda _: 61)
        climb(given, folder, fewer=FEWER_CORNERS_FOR_A_FOLD, tolerance=tolerance)
        assert (folder.asked[0][0] == 45) == tried, tolerance
    assert climb(drawn(uneven(1, 1.0, 1.0, count=29)), Folder(lambda _: 1), fewer=FEWER_CORNERS_FOR_A_FOLD).taken == 0


def test_the_short_look_moves_corners_only_if_no_outline_may_be_far_off() -> None:
    """With 60 corners that may take more than a minute."""
    given = drawn(uneven(1, 1.0, 1.0, count=35))
    for tolerance, adjusts in ((None, False), (0.9 * FAR_OFF, True)):
        folder = Folder(lambda _: 61)
        climb(given, folder, Effort("normal"), tolerance=tolerance)
        (_, look, effort), (_, earnest, _) = folder.asked[:2]
        assert effort.name == "fast"
        assert (look.adjust == 0) == (not adjusts), tolerance
        assert earnest.adjust != 0


def test_what_is_searched_at_each_tolerance() -> None:
    """More where a larger tolerance is not to come; less where there is an outline for two hands already."""
    asked: list[tuple[float, float, bool, int]] = []
    drawing = Drawing.of(drawn(CIRCLES["circle"]).laying, (), 2.0, may_turn=False)
    few = simplify(drawing.frame.shape, 2.0).shape.corner_count
    folder = Folder(lambda corners: 60 if corners <= few else 61)
    search = pretended(folder)

    def redraw(drawing: Drawing, tolerance: float, **options: Any) -> None:
        asked.append((tolerance, options["wanted"], options["thorough"], options["work"]))
        search(drawing, tolerance, **options)

    climb(drawn(CIRCLES["circle"]), folder, redraw=redraw)
    all_work, less = WORK["fast"], int(LESS_WORK * WORK["fast"])
    tried = [(tolerance, 60, tolerance >= 2, all_work) for tolerance in (0.25, 0.5, 1, 2)]
    assert asked == [*tried[-len(asked) + 1 :], (4, math.inf, False, less)]
    assert len(asked) > 2
    asked.clear()
    climb(drawn(CIRCLES["circle"]), Folder(lambda _: 61), redraw=redraw, tolerance=0.5)
    assert [one[1:3] for one in asked] == [(60, False), (math.inf, True)]


def test_an_outline_has_no_more_corners_than_were_asked_for() -> None:
    ladder = climb(drawn(CIRCLES["oval"]), Folder(lambda _: 99), corners=30)
    assert all(level.corners <= 30 for level in ladder.levels[1:] if level.folds)
    assert any(level.failure == "no outline with a pattern was found" for level in ladder.levels)


def test_bounds_that_make_no_sense_are_refused() -> None:
    for bounds, message in (
        ({"tolerance": -1.0}, "tolerance is -1.0 mm"),
        ({"tolerance": float("nan")}, "tolerance is nan mm"),
        ({"level": "rough"}, "no level 'rough'"),
        ({"folds": 0}, "with 0 folds"),
        ({"small_parts": "eat"}, "small parts cannot be 'eat'"),
        ({"exact": True, "tolerance": 1.0}, "exact forbids"),
        ({"exact": True, "level": "easy"}, "exact forbids"),
    ):
        with pytest.raises(BadInputError, match=message):
            Bounds(**bounds)
    with pytest.raises(BadInputError, match="exact forbids to move corners"):
        foldcut.fold([rectangle(3, 1)], exact=True, simplify=1.0)


# ---- with the methods themselves ----


def test_what_folds_well_as_it_is_stays_as_it_is_to_the_last_bit() -> None:
    for loop in (star(5, 0.4), rectangle(3, 1), regular(6)):
        plain, exact = (foldcut.fold([loop], effort="fast", **more) for more in ({}, {"exact": True}))  # type: ignore[arg-type]
        assert plain.ladder is not None
        assert plain.ladder.taken == 0
        ours, theirs = plain.folded_pattern, exact.folded_pattern
        np.testing.assert_array_equal(ours.creases.vertices_coords, theirs.creases.vertices_coords)
        np.testing.assert_array_equal(ours.shape.loops[0], theirs.shape.loops[0])
        assert ours.drawn == ()


def test_bumps_are_drawn_straight_where_that_makes_the_pattern_one_for_hands() -> None:
    heights = [0, 0.5, -0.1, 0.3, 0.1, 0.6, -0.2, 0.2, 0]
    bumpy = np.concatenate([np.column_stack([np.linspace(0, 100, 9), heights]), [(100, 60), (0, 60)]])
    exact = foldcut.fold([bumpy], effort="fast", exact=True)
    plain = foldcut.fold([bumpy], effort="fast", folds=10)
    assert plain.verified
    assert plain.ladder is not None
    assert not plain.ladder.levels[0].for_hands
    assert plain.ladder.level.for_hands
    assert plain.actions <= exact.actions / 4
    assert 0 < plain.ladder.level.off_by_mm <= plain.ladder.level.tolerance_mm
    pattern = plain.folded_pattern
    assert len(pattern.drawn) == 1
    assert apart(pattern.drawn, pattern.shape.loops) == pytest.approx(plain.ladder.level.off_by_mm, abs=0.03)
    assert any(note.startswith("the outline was drawn anew") for note in plain.notes)


def test_the_same_is_found_again() -> None:
    once, again = (foldcut.fold([star(12, 0.9)], effort="fast", folds=10, tolerance=1.0) for _ in range(2))
    np.testing.assert_array_equal(
        once.folded_pattern.creases.vertices_coords, again.folded_pattern.creases.vertices_coords
    )


def test_the_papers_method_is_exact_unless_a_tolerance_is_given() -> None:
    loop = regular(36)
    exact = foldcut.fold([loop], method="paper")
    assert exact.ladder is not None
    assert len(exact.ladder.levels) == 1
    assert exact.folded_pattern.shape.corner_count == 36
    near = foldcut.fold([loop], method="paper", tolerance=4.0, folds=1)
    assert near.folded_pattern.shape.corner_count < 36
    assert near.method == "paper"


OVAL = np.array(regular(36)) * (1.0, 0.6)


@pytest.mark.parametrize("method", ["mirror", "skeleton"])
def test_redrawn_outlines_are_folded_by_the_method_that_is_asked_for(method: str) -> None:
    found = foldcut.fold([OVAL], method=method, effort="fast", folds=9)
    assert found.ladder is not None
    assert any(level.made is not None for level in found.ladder.levels[1:])
    assert {level.made.method for level in found.ladder.levels if level.made is not None} == {method}


def test_redrawn_outlines_have_no_crease_shorter_than_is_asked_for() -> None:
    ladder = foldcut.fold([OVAL], effort="fast", folds=9).ladder
    assert ladder is not None
    longest = max(level.shortest_mm for level in ladder.levels[1:] if level.shortest_mm is not None)
    with pytest.raises(CreaseTooShortError, match="no pattern, either"):
        foldcut.fold([OVAL], effort="fast", folds=9, min_crease=longest + 1)
