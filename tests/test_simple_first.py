"""Patterns that begin with simple folds: other mountains, valleys and layers for the same creases."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.folded import folded_sample
from support.patterns import book_fold
from support.strategies import star

from foldcut.core.model import FoldedPattern, Sheet
from foldcut.drawing.laying import AS_IT_IS
from foldcut.drawing.shape import make_shape
from foldcut.folding_steps import Phase, folding_steps, in_words, phases, simple_first
from foldcut.folding_steps.simple_first import easier, with_simple_folds_first
from foldcut.methods.skeleton.quick import fold_outline
from foldcut.proof.verify import verify


def along_skeleton(name: str) -> FoldedPattern:
    """Return the pattern of a sample's straight skeleton with the order of layers that the solver finds first."""
    pattern = folded_sample(name, method="skeleton")
    made = fold_outline(pattern.shape, pattern.sheet)
    return replace(pattern, creases=made.creases, folded=made.folded)


@pytest.mark.parametrize(("name", "before", "after"), [("star", 2, 5), ("plus", 3, 5), ("kite", 0, 2)])
def test_the_same_creases_begin_with_more_simple_folds(name: str, before: int, after: int) -> None:
    pattern = along_skeleton(name)
    assert sum(step.line is not None for step in folding_steps(pattern)) == before
    found = easier(pattern)
    assert found is not None
    assert found.phases == (Phase(after, together=False),)
    other = found.pattern
    assert verify(other.creases, other.folded.layers, other.shape) == []
    assert np.array_equal(other.creases.edges_vertices, pattern.creases.edges_vertices)
    assert np.array_equal(other.creases.vertices_coords, pattern.creases.vertices_coords)
    assert (other.creases.edges_assignment != pattern.creases.edges_assignment).any()


def test_a_star_with_eight_points_is_left_with_nothing_to_close_together() -> None:
    sheet, z = Sheet(210, 210), np.array(star(8, 0.6)) @ (1, 1j) * 20 + 105 + 105j
    shape = make_shape([np.stack([z.real, z.imag], axis=1)])
    made = fold_outline(shape, sheet)
    found = easier(FoldedPattern(made.creases, made.folded, sheet, shape, AS_IT_IS, ""))
    assert found is not None
    assert found.phases == (Phase(5, together=False),)


def test_first_folds_stay_first_and_go_away_from_you() -> None:
    pattern = folded_sample("letter-a", method="mirror")
    first, *_ = folding_steps(with_simple_folds_first(pattern) or pattern)
    assert first.line is not None
    assert not first.over
    assert {tuple(np.round(point, 6)) for point in first.line} == {
        tuple(np.round(point, 6)) for point in pattern.first_folds[0]
    }


def test_what_begins_so_already_is_left_alone_and_what_cannot_too() -> None:
    book = book_fold()
    assert with_simple_folds_first(book) is book
    assert with_simple_folds_first(folded_sample("swan", method="skeleton")) is None


def test_an_order_that_the_verifier_refuses_is_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    pattern = along_skeleton("star")
    monkeypatch.setattr(simple_first, "verify", lambda *_: ["no"])
    assert with_simple_folds_first(pattern) is None


def test_large_patterns_are_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    pattern = along_skeleton("star")
    monkeypatch.setattr(simple_first, "MOST_CREASES", pattern.creases.crease_count - 1)
    assert easier(pattern) is None


def test_phases_are_counted_through_all_layers_and_said_in_words() -> None:
    pattern = folded_sample("heart", method="mirror")
    fold, rest = phases(pattern, folding_steps(pattern))
    assert (fold, rest.together) == (Phase(1, together=False), True)
    creases = pattern.creases.crease_count
    assert rest.count < creases / 2
    assert in_words((fold, rest)) == f"1 simple fold, then {rest.count} creases that close together"
    assert in_words((Phase(5, together=False),)) == "5 simple folds"
