"""How difficult patterns are, in words: each number alone can make one harder, and none makes it easier."""

from __future__ import annotations

import pytest

from foldcut.folding_steps.phases import Phase, difficulty_of
from foldcut.pattern.difficulty import GRADES, NOT_FOR_HANDS, difficulty
from foldcut.pattern.foldability import Foldability


def test_few_simple_folds_are_for_beginners_and_take_minutes() -> None:
    star = difficulty(5, 0, 10, 40.0)
    assert (star.grade, star.minutes, star.reasons) == ("beginner", 5, ())
    assert str(star) == "5 minutes, beginner"


def test_thousands_of_folds_are_not_for_hands_and_no_time_is_told() -> None:
    found = difficulty(2433, None, 120, 0.0003)
    assert (found.grade, found.minutes) == (NOT_FOR_HANDS, None)
    assert str(found) == (
        "not for hands (2,433 folds; 2,433 creases close together; a crease of 0.0003 mm; 120 layers to cut through)"
    )


@pytest.mark.parametrize(
    ("numbers", "grade", "reason"),
    [
        ((9, 0, 4, 20.0), "easy", "9 folds"),
        ((8, 5, 4, 20.0), "easy", "5 creases close together"),
        ((4, 0, 4, 3.5), "intermediate", "a crease of 3.5 mm"),
        ((4, 0, 17, 20.0), "intermediate", "17 layers to cut through"),
        ((4, 0, 41, 20.0), "advanced", "41 layers to cut through"),
        ((60, 30, 4, 20.0), "advanced", "30 creases close together"),
        ((61, 0, 4, 20.0), NOT_FOR_HANDS, "61 folds"),
        ((4, 0, 4, 1.4), NOT_FOR_HANDS, "a crease of 1.4 mm"),
    ],
)
def test_each_number_alone_makes_a_pattern_harder_and_is_named(
    numbers: tuple[int, int, int, float], grade: str, reason: str
) -> None:
    found = difficulty(*numbers)
    assert (found.grade, GRADES.index(found.grade)) == (grade, found.level)
    assert reason in found.reasons


def test_what_closes_together_takes_longer_than_simple_folds_and_hours_are_told_as_hours() -> None:
    assert difficulty(20, 0, 4, 20.0).minutes == 15
    assert difficulty(20, 20, 4, 20.0).minutes == 30
    assert difficulty(60, 60, 4, 20.0).short == "1.5 hours, advanced"
    assert difficulty(50, 50, 4, 20.0).short == "1 hour, advanced"
    assert difficulty(0, 0, 0, None).short == "3 minutes, beginner"


def test_phases_are_counted_and_where_there_are_none_all_folds_close_together() -> None:
    numbers = Foldability(40, 25, 20, 20, 9.0, (1.0, 2.0), 30.0, 8, 8, 0.8, 0.3, ())
    counted = difficulty_of([Phase(4, together=False), Phase(10, together=True)], numbers)
    assert counted == difficulty(14, 10, 8, 9.0)
    assert difficulty_of([], numbers) == difficulty(25, 25, 8, 9.0)
    assert difficulty_of([], numbers, 30) == difficulty(30, 30, 8, 9.0)
