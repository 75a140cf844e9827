"""How much work a search may do.

Work is counted in seconds by a model of what each step takes, not by the clock. So an effort means the same trials, and
the same pattern, on every machine. Only a limit in seconds is measured by the clock.
"""

from __future__ import annotations

import time

EFFORT_SECONDS = {"fast": 0.42, "normal": 5.2, "best": 60.0}
"""How many seconds each effort may take, by the model of this module."""

PATIENCE = 2
"""How many times the allowed work may be spent as long as there is no pattern."""


class Spent(Exception):  # noqa: N818  # not an error
    """The work or the time allowed is used up."""


def program_cost(turns: int) -> float:
    """Return what one linear program takes, in seconds."""
    return 0.002 + 2e-7 * turns**3


def fold_cost(turns: int) -> float:
    """Return what it takes to fold a walk, in seconds."""
    return 0.002 + 0.0003 * turns + 3e-6 * turns**2


def step_cost(turns: int) -> float:
    """Return what one step of lengthening creases takes besides folding, in seconds."""
    return 0.002 + 1.2e-5 * turns**2


class Budget:
    """The work that a search may do, and has done.

    ``allowed``: seconds by the model; ``seconds``: a limit by the clock instead, from when the budget is made.
    """

    def __init__(self, allowed: float, seconds: float | None = None) -> None:
        self.allowed, self.seconds = allowed, seconds
        self.spent = 0.0
        self.started = time.monotonic()

    @property
    def part(self) -> float:
        """The part of the budget that is spent."""
        if self.seconds is not None:
            return (time.monotonic() - self.started) / self.seconds
        return self.spent / self.allowed

    def spend(self, cost: float) -> None:
        """Count some work."""
        self.spent += cost

    def extend(self, part: float) -> None:
        """Allow more work from now on: this part of what was allowed so far."""
        self.allowed = max(self.spent, self.allowed) + part * self.allowed

    def is_over(self, *, found: bool) -> bool:
        """Tell whether the search has to end. Without a limit in seconds it goes on for longer if nothing is found."""
        part = self.part
        return part >= 1 and (found or self.seconds is not None or part >= PATIENCE)

    def allows_program(self, turns: int) -> bool:
        """Tell whether one linear program is affordable, however much of a limit in seconds there is."""
        allowed = self.allowed if self.seconds is None else min(self.seconds, EFFORT_SECONDS["best"])
        return program_cost(turns) <= PATIENCE * allowed
