"""Every method keeps to one contract, whatever it does inside: ``foldcut.methods.base`` says what."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from importlib import import_module

import numpy as np
import pytest
from support.strategies import RING, Points, rectangle, star

from foldcut.core.errors import CreaseTooShortError, RibbonError, UnfoldableError
from foldcut.drawing.laying import Laying
from foldcut.drawing.placement import Layout, parse_sheet
from foldcut.drawing.shape import make_shape
from foldcut.geometry.planar_graph import edge_faces
from foldcut.methods import AUTO, CHOICES, METHODS, auto, check_choice, fewer_creases, last_resort
from foldcut.methods.base import Effort, Made, Problem, Wishes
from foldcut.methods.progress import Stages
from foldcut.pattern.cut_line import fold_boundary
from foldcut.pattern.face_maps import fold_faces
from foldcut.pattern.foldability import crease_numbers
from foldcut.pipeline import fold
from foldcut.proof.verify import verify

TWO_SQUARES: list[Points] = [rectangle(4, 4), [(7, 0), (11, 0), (11, 4), (7, 4)]]
LOPSIDED: list[Points] = [[(0, 0), (6, 0), (4, 3), (1, 4)]]
SHAPES: dict[str, list[Points]] = {
    "square": [rectangle(4, 4)],
    "star": [star(5, 0.4)],
    "lopsided": LOPSIDED,
    "ring": RING,
    "two squares": TWO_SQUARES,
}
FOLDABLE = {
    "mirror": "square",
    "simple": "star",
    "compact": "lopsided",
    "paper": "lopsided",
    "skeleton": "lopsided",
    "gate": "ring",
}
"""By method, a shape that it folds."""

FAST = Effort("fast")


def problem(loops: list[Points], wishes: Wishes | None = None, stages: Stages | None = None) -> Problem:
    """Lay loops on a sheet of 150 mm, as the pipeline does."""
    laying = Laying(make_shape(loops), Layout(parse_sheet("150x150"), 30.0, "fit", None, None, None, None))
    return Problem(laying.lay(), laying.lay, wishes or Wishes(min_crease=0.0), may_turn=True, stages=stages or Stages())


def folded(name: str, shape: str, **wishes: float) -> Made | None:
    """Return what a method makes of a shape, or None where it says that it cannot fold it."""
    try:
        return METHODS[name].fold(problem(SHAPES[shape], Wishes(**{"min_crease": 0.0, **wishes})), FAST)
    except UnfoldableError as error:
        assert str(error).strip()
        return None


def test_every_method_folds_a_shape_here() -> None:
    assert FOLDABLE.keys() == METHODS.keys()


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("name", METHODS)
def test_a_pattern_is_verified_or_the_shape_is_unfoldable(name: str, shape: str) -> None:
    made = folded(name, shape)
    assert made is not None or FOLDABLE[name] != shape
    if made is None:
        return
    assert verify(made.creases, made.folded.layers, made.laid.shape) == []
    assert made.method == name
    assert 0 < made.actions <= crease_numbers(made.creases).creases
    assert len(made.laid.shape.loops) == len(SHAPES[shape])
    assert made.ribbon > 0 or not METHODS[name].needs_ribbon
    assert all(line.strip() for line in made.told)
    assert made.told
    assert all(isinstance(value, int | float) for value in made.numbers.values())
    assert all(line.shape == (2, 2) for line in made.first_folds)
    assert all(-1 <= region.parent < len(made.regions) for region in made.regions)
    assert not made.interrupted


@pytest.mark.parametrize("name", METHODS)
def test_the_same_problem_gives_the_same_pattern(name: str) -> None:
    one, other = (folded(name, FOLDABLE[name]) for _ in range(2))
    assert one is not None
    assert other is not None
    for field in ("vertices_coords", "edges_vertices", "edges_assignment"):
        assert (getattr(one.creases, field) == getattr(other.creases, field)).all()
    assert (one.folded.layers == other.folded.layers).all()


@pytest.mark.parametrize("name", METHODS)
def test_within_the_ribbon_nothing_but_straight_creases_is_found(name: str) -> None:
    ribbon = 0.3
    made = folded(name, FOLDABLE[name], ribbon=ribbon)
    assert made is not None
    assert made.ribbon == ribbon
    creases = made.creases
    height = np.abs(made.folded.vertices_coords[:, 1])
    at_cut = height < 1e-6 * made.laid.sheet.diagonal
    assert (height[~at_cut] >= 0.99 * ribbon).all(), "a vertex within the ribbon"
    maps = fold_faces(creases, edge_faces(creases))
    assert len(fold_boundary(creases, maps, made.laid.shape, 1e-6)[0]) > 0


@pytest.mark.parametrize("name", METHODS)
def test_a_crease_that_is_too_short_is_refused_with_its_length_and_place(name: str) -> None:
    shape = SHAPES[FOLDABLE[name]]
    with pytest.raises(CreaseTooShortError, match=r"--min-crease") as refused:
        fold(shape, "150x150", margin=30, method=name, effort="fast", min_crease=140.0)
    assert 0 < refused.value.length < 140
    assert all(0 <= coordinate <= 150 for coordinate in refused.value.place)


@pytest.mark.parametrize("name", CHOICES)
def test_progress_never_steps_back_and_ends_with_all(name: str) -> None:
    seen: list[float] = []
    shape = SHAPES[FOLDABLE.get(name, "lopsided")]
    fold(
        shape,
        "150x150",
        margin=30,
        method=name,
        effort="fast",
        min_crease=0,
        progress=lambda _, part: seen.append(part),
    )
    assert seen == sorted(seen)
    assert 0 <= seen[0] <= seen[-1] == 1


class Interrupting(Stages):
    """Raises what Ctrl-C does when so much has been told."""

    def __init__(self, after: int) -> None:
        super().__init__(self.count)
        self.left = after

    def count(self, _text: str, _part: float) -> None:
        self.left -= 1
        if self.left == 0:
            raise KeyboardInterrupt


@pytest.mark.parametrize("after", [1, 3, 6, 12])
@pytest.mark.parametrize("name", METHODS)
def test_ctrl_c_gives_the_best_pattern_so_far_or_goes_on_up(name: str, after: int) -> None:
    stages = Interrupting(after)
    try:
        made = METHODS[name].fold(problem(SHAPES[FOLDABLE[name]], stages=stages), FAST)
    except KeyboardInterrupt:
        return
    assert verify(made.creases, made.folded.layers, made.laid.shape) == []
    assert made.numbers.get("interrupted", made.interrupted) or stages.left > 0


@pytest.mark.parametrize("seconds", [0.01, 1.0])
@pytest.mark.parametrize("name", METHODS)
def test_seconds_bound_the_search_and_do_not_make_it_fail_otherwise(name: str, seconds: float) -> None:
    try:
        made = METHODS[name].fold(problem(SHAPES[FOLDABLE[name]]), Effort("normal", seconds))
    except UnfoldableError as error:
        assert str(error).strip()
        return
    assert verify(made.creases, made.folded.layers, made.laid.shape) == []


@pytest.mark.parametrize("name", METHODS)
def test_a_method_is_a_package_with_one_function(name: str) -> None:
    module = import_module(f"foldcut.methods.{METHODS[name].package}.method")
    assert list(inspect.signature(module.fold).parameters) == ["problem", "effort"]
    assert module.__doc__.startswith(f"The method ``{name}``")
    assert METHODS[name].summary


def test_the_table_of_tries_has_all_methods_but_those_of_thousands_of_folds() -> None:
    assert {row.method for row in auto.TRIES} == METHODS.keys() - {last_resort(1), last_resort(2)}
    assert [row.until for row in auto.TRIES] == sorted(row.until for row in auto.TRIES)


def failing(reason: str) -> Callable[..., Made]:
    def fold(*_: Problem | Effort) -> Made:
        raise UnfoldableError(reason)

    return fold


@pytest.fixture
def nothing_folds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let every method of the table fail."""
    for method in METHODS.values():
        monkeypatch.setattr(f"foldcut.methods.{method.package}.method.fold", failing(f"no {method.name}"))
    monkeypatch.setattr("foldcut.methods.skeleton.method.fold_ridges_alone", failing("no ridges"))
    monkeypatch.setattr("foldcut.methods.simple.method.fold_simply", failing("no simple folds"))
    monkeypatch.setattr("foldcut.methods.simple.method.fold_row", failing("no row"))


@pytest.mark.usefixtures("nothing_folds")
def test_where_nothing_folds_the_error_has_every_reason() -> None:
    with pytest.raises(UnfoldableError) as one:
        auto.run(AUTO, problem(LOPSIDED), FAST)
    assert str(one.value) == "mirror: no mirror; skeleton: no skeleton; compact: no compact"
    with pytest.raises(UnfoldableError) as several:
        auto.run(AUTO, problem(TWO_SQUARES), FAST)
    assert str(several.value) == "mirror: no mirror; skeleton: no skeleton; compact: no compact"


def test_what_is_asked_for_must_make_sense() -> None:
    check_choice("auto")
    with pytest.raises(ValueError, match="unknown method 'magic'; known: auto, mirror"):
        check_choice("magic")
    with pytest.raises(ValueError, match="unknown effort 'lots'"):
        Effort("lots")
    with pytest.raises(ValueError, match="give a positive number"):
        Effort("fast", 0.0)
    with pytest.raises(RibbonError):
        Wishes(ribbon=-1.0)
    for name in ("min_crease", "symmetry", "adjust"):
        with pytest.raises(ValueError, match="give 0 or a positive number"):
            Wishes(**{name: float("nan")})
    assert fewer_creases() in METHODS
    assert fewer_creases(METHODS) == ""
