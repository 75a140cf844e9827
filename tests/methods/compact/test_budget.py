"""The budget of a search."""

from __future__ import annotations

import time

import pytest

from foldcut.methods.compact.budget import EFFORT_SECONDS, Budget, fold_cost, program_cost


def test_work_is_counted_by_the_model_and_not_by_the_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    budget = Budget(2.0)
    monkeypatch.setattr(time, "monotonic", lambda: 1e9)
    budget.spend(0.5)
    assert budget.part == 0.25


def test_seconds_are_counted_by_the_clock_and_not_by_the_model(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    budget = Budget(2.0, seconds=10.0)
    budget.spend(5.0)
    assert budget.part == 0
    now[0] = 111.0
    assert budget.is_over(found=False)


def test_twice_as_much_may_be_spent_until_a_pattern_is_found() -> None:
    budget = Budget(1.0)
    budget.spend(1.5)
    assert budget.is_over(found=True)
    assert not budget.is_over(found=False)
    budget.spend(0.5)
    assert budget.is_over(found=False)


def test_an_extended_budget_goes_on_from_what_is_spent() -> None:
    budget = Budget(1.0)
    budget.spend(1.25)
    budget.extend(0.5)
    assert budget.allowed == 1.75
    assert not budget.is_over(found=True)


@pytest.mark.parametrize(("effort", "most"), [("fast", 160), ("normal", 373), ("best", 843)])
def test_the_turns_for_which_a_program_is_affordable(effort: str, most: int) -> None:
    budget = Budget(EFFORT_SECONDS[effort])
    assert budget.allows_program(most)
    assert not budget.allows_program(most + 10)
    assert Budget(1.0, seconds=1e9).allows_program(843)
    assert not Budget(1.0, seconds=1e9).allows_program(853), "no more than the highest effort allows"


def test_more_turns_cost_more() -> None:
    for cost in (program_cost, fold_cost):
        assert 0 < cost(10) < cost(20)
