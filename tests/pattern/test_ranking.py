"""Which of two patterns is easier to fold."""

from __future__ import annotations

from foldcut.pattern.ranking import FOLDABLE_MM, SHORTEST_MM, TOO_SHORT, rank


def test_a_pattern_that_nobody_can_fold_comes_after_all_others() -> None:
    assert rank(1000, SHORTEST_MM) < rank(10, 0.9 * SHORTEST_MM)


def test_fewer_creases_come_first_and_then_longer_ones() -> None:
    assert rank(10, 4.0) < rank(11, 5.0)
    assert rank(10, 5.0) < rank(10, 4.0)


def test_creases_that_are_hard_to_fold_count_as_more() -> None:
    assert rank(100, FOLDABLE_MM).creases == 100
    assert rank(100, 0.999 * FOLDABLE_MM).creases > 100 * TOO_SHORT
    assert rank(100, 1.0).creases > rank(100, 2.0).creases
