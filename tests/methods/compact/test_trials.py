"""Trials of single solutions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from support.compact import A4, covered, loop_of
from support.strategies import regular, star_shaped

from foldcut.core.model import Shape
from foldcut.methods.compact import trials as module
from foldcut.methods.compact.molecule import NotClosedError
from foldcut.methods.compact.trials import Attempt, Trials
from foldcut.methods.compact.turns import Solution
from foldcut.methods.sheet_part import SheetPart


def trials_of(points: list[tuple[float, float]], **options: Any) -> tuple[Trials, Solution]:
    loop = loop_of(points)
    outline, _, solution = covered(loop)
    return Trials(outline, A4, SheetPart(Shape((loop,), (-1,))), **options), solution


def free(_: float) -> None:
    """Charge nothing."""


def test_the_best_pattern_is_kept() -> None:
    trials, solution = trials_of(star_shaped(np.random.default_rng(1), 8))
    first = trials.attempt(solution, free)
    assert first.folds
    best = trials.best
    assert best is not None
    assert best.solution is solution
    assert first.cost >= best.creases.crease_count
    assert trials.attempt(solution, free) == first
    assert trials.best is best, "no better, so not taken"
    assert trials.count == 2


def test_what_is_not_verified_is_not_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "verify", lambda *_: ["a finding"])
    trials, solution = trials_of(regular(5))
    assert trials.attempt(solution, free) == Attempt(np.inf, set())
    assert trials.best is None


def test_events_on_the_ribbon_are_refused() -> None:
    trials, solution = trials_of(regular(5), ribbon=100.0)
    assert not trials.attempt(solution, free).folds
    assert trials.creases(solution, free) is None


def test_a_molecule_that_does_not_close_is_no_pattern_but_a_bug_is_a_bug(monkeypatch: pytest.MonkeyPatch) -> None:
    trials, solution = trials_of(regular(5))
    errors: list[Exception] = [NotClosedError("no", {1}), AssertionError(), KeyError(1), StopIteration()]

    def failing(*_: Any) -> None:
        raise errors[0]

    monkeypatch.setattr(module, "build_molecules", failing)
    assert trials.attempt(solution, free) == Attempt(np.inf)
    assert trials.creases(solution, free) is None
    while errors[1:]:
        errors.pop(0)
        with pytest.raises(type(errors[0])):
            trials.attempt(solution, free)
        with pytest.raises(type(errors[0])):
            trials.creases(solution, free)
