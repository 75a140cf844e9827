"""How far an outline may be drawn anew, and when its pattern is one for two hands: what the user asks of the search.

Tolerances are lengths on the sheet where the user gives them, and in mm of the frame where the search tries them: in
the frame the drawing is as large as fits on A4, whatever sheet is asked for.
"""

from __future__ import annotations

from dataclasses import dataclass

from foldcut.core.errors import BadInputError

__all__ = [
    "ANY_METHOD",
    "FEWEST",
    "FOLD_REDRAWN",
    "HANDS_CREASE_MM",
    "HANDS_FOLDS",
    "LEVELS",
    "SMALL_PARTS",
    "TOLERANCES",
    "Bounds",
]

ANY_METHOD = "auto"

FOLD_REDRAWN = (ANY_METHOD, "mirror", "skeleton")
"""The methods that fold outlines drawn anew; by others, drawings are folded as they are."""

TOLERANCES = (0.25, 0.5, 1.0, 2.0, 4.0)
"""The tolerances that are tried after the drawing as it is, in mm of the frame."""

LEVELS = {"exact": 0.0, "fine": 0.5, "normal": 2.0, "easy": 4.0}
"""How far the outline may be from the drawing at each level that has a name, in mm of the frame."""

FEWEST = "easy"
"""The level at which all tolerances are tried and the one with the fewest folds is taken, not the most exact one."""

HANDS_FOLDS = 60
"""A pattern for two hands has at most this many folds."""

HANDS_CREASE_MM = 3.0
"""A pattern for two hands has no crease that is shorter than this, in mm of the frame."""

SMALL_PARTS = ("drop", "keep", "enlarge")
"""What may become of parts of a drawing that are smaller than the tolerance."""

SAME = 1e-6
"""Tolerances that differ by less than this, in mm of the frame, are the same."""


@dataclass(frozen=True)
class Bounds:
    """What a search for an outline must keep to.

    ``tolerance``: how far the outline may be from the drawing, in mm on the sheet, None for as far as ``level`` says,
    which is one of ``LEVELS`` or empty for the last of ``TOLERANCES``. ``exact``: the drawing's corners stay where they
    are. ``folds``: how many folds a pattern for two hands has at most. ``corners``: how many corners an outline has at
    most, None for any number. ``small_parts``: one of ``SMALL_PARTS``. ``next_level``: once there is an outline for two
    hands, one more tolerance is tried, to say what it would cost, unless the drawing folds as it is. ``method``:
    the one that is asked for, or ``ANY_METHOD``.

    Raises ``BadInputError`` for what makes no sense.
    """

    tolerance: float | None = None
    level: str = ""
    exact: bool = False
    folds: int = HANDS_FOLDS
    corners: int | None = None
    small_parts: str = "drop"
    next_level: bool = True
    method: str = ANY_METHOD

    def __post_init__(self) -> None:
        if self.tolerance is not None and not 0 <= self.tolerance < float("inf"):
            raise BadInputError(f"the tolerance is {self.tolerance} mm; give 0 or a positive number")
        if self.level and self.level not in LEVELS:
            raise BadInputError(f"there is no level {self.level!r}; choose from {', '.join(LEVELS)}")
        if self.small_parts not in SMALL_PARTS:
            raise BadInputError(f"small parts cannot be {self.small_parts!r}; choose from {', '.join(SMALL_PARTS)}")
        if self.folds < 1:
            raise BadInputError(f"a pattern with {self.folds} folds is asked for; allow at least 1")
        if self.exact and (self.tolerance or self.level not in ("", "exact")):
            raise BadInputError("--exact forbids to move the outline; leave out --tolerance and --level, or --exact")

    @property
    def is_exact(self) -> bool:
        """Whether no corner may move."""
        return self.exact or self.level == "exact" or self.tolerance == 0

    @property
    def takes_fewest(self) -> bool:
        """Whether the fewest folds are asked for, and not the most exact outline for two hands."""
        return self.level == FEWEST

    def most(self, scale: float) -> float:
        """Return how far the outline may be from the drawing, in mm of the frame.

        ``scale``: mm on the sheet for each mm of the frame.
        """
        if self.is_exact or self.method not in FOLD_REDRAWN:
            return 0.0
        most = LEVELS[self.level] if self.level else TOLERANCES[-1]
        return most if self.tolerance is None else min(most if self.level else float("inf"), self.tolerance / scale)

    def tolerances(self, scale: float) -> tuple[float, ...]:
        """Return the tolerances to try, in mm of the frame, the drawing as it is first."""
        most = self.most(scale)
        within = tuple(tolerance for tolerance in TOLERANCES if tolerance < most - SAME)
        return (0.0, *within, most) if most > SAME else (0.0,)
