"""How difficult a pattern is, in words that people use: how long it takes, for whom it is, and why.

Counts and lengths -> ``Difficulty``. The minutes are an estimate by the rates below, for a person who has
folded before: an order of magnitude, for which nobody has been timed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from foldcut.pattern.foldability import SCISSORS_LAYERS

__all__ = ["GRADES", "NOT_FOR_HANDS", "Difficulty", "difficulty"]

NOT_FOR_HANDS = "not for hands"
"""The grade of what nobody folds by hand."""

GRADES = ("beginner", "easy", "intermediate", "advanced", NOT_FOR_HANDS)
"""The grades, the easiest first."""

MOST_FOLDS = (8, 20, 36, 60)
"""A pattern of each grade but the last has at most so many folds."""

MOST_TOGETHER = (4, 14, 28, 60)
"""Of these at most so many close together."""

LEAST_MM = (8.0, 4.0, 3.0, 1.5)
"""No crease of it is shorter than this."""

MOST_LAYERS = (SCISSORS_LAYERS, SCISSORS_LAYERS, 40, 80)
"""The cut goes through no more layers than this."""

MINUTES_TO_BEGIN = 2.0
"""Cutting the sheet out, and the one cut at the end."""

MINUTES_OF_A_FOLD = 0.5
"""A simple fold, pressed flat."""

MINUTES_OF_A_PRESSED_CREASE = 0.75
"""A crease that closes together with others: it is pressed both ways first."""

MINUTES_OF_A_COLLAPSE = 0.25
"""What each of these takes again when they close."""

ROUND_MINUTES = (3, 5, 10, 15, 20, 30, 45, 60, 90, 120)
"""The estimates that are told: the least that is not below what was computed."""


@dataclass(frozen=True)
class Difficulty:
    """How difficult a pattern is: one of ``GRADES``, about how many ``minutes`` it takes, and in ``reasons`` why.

    ``minutes`` is None for what is not for hands. There are no reasons for the easiest grade.
    """

    grade: str
    minutes: int | None
    reasons: tuple[str, ...]

    @property
    def level(self) -> int:
        """The place of the grade in ``GRADES``, 0 for the easiest: what lists are sorted by."""
        return GRADES.index(self.grade)

    @property
    def short(self) -> str:
        """The difficulty in a few words, such as "5 minutes, beginner"."""
        if self.minutes is None:
            return self.grade
        hours = self.minutes / 60
        time = f"{self.minutes} minutes" if hours < 1 else f"{hours:g} hour{'s' * (hours > 1)}"
        return f"{time}, {self.grade}"

    def __str__(self) -> str:
        return f"{self.short} ({'; '.join(self.reasons)})" if self.reasons else self.short


def difficulty(folds: int, together: int | None, layers_at_cut: int, shortest_mm: float | None) -> Difficulty:
    """Return how difficult a pattern is.

    ``folds``: how many straight folds a person makes, of which so many close ``together`` with others; None, if nobody
    has counted them: then all do. ``layers_at_cut``: the layers that the cut goes through; ``shortest_mm``: the length
    of the shortest crease, None without creases.
    """
    together = folds if together is None else together
    short = -LEAST_MM[0] if shortest_mm is None else -shortest_mm
    measured: list[tuple[int, str]] = [
        (_grade(folds, MOST_FOLDS), f"{folds:,} folds"),
        (_grade(together, MOST_TOGETHER), f"{together:,} creases close together"),
        (_grade(short, [-least for least in LEAST_MM]), f"a crease of {-short:.2g} mm"),
        (_grade(layers_at_cut, MOST_LAYERS), f"{layers_at_cut:,} layers to cut through"),
    ]
    worst = max(grade for grade, _ in measured)
    reasons = tuple(text for grade, text in measured if grade == worst > 0)
    return Difficulty(GRADES[worst], None if GRADES[worst] == NOT_FOR_HANDS else _minutes(folds, together), reasons)


def _grade(value: float, most: Sequence[float]) -> int:
    """Return the first grade that allows as much as ``value``, or the last one."""
    return next((grade for grade, allowed in enumerate(most) if value <= allowed), len(most))


def _minutes(folds: int, together: int) -> int:
    """Return about how long folding and cutting take."""
    takes = MINUTES_TO_BEGIN + MINUTES_OF_A_FOLD * (folds - together)
    takes += (MINUTES_OF_A_PRESSED_CREASE + MINUTES_OF_A_COLLAPSE) * together
    return next((told for told in ROUND_MINUTES if takes <= told), ROUND_MINUTES[-1])
