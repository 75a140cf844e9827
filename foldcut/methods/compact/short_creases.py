"""Getting rid of short creases: the turns of a solution are moved until its short creases are longer, or vanish.

``Solution`` -> solutions near it, each of which is tried.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from itertools import islice

from foldcut.methods.compact.budget import Budget, step_cost
from foldcut.methods.compact.lengthen import Mover
from foldcut.methods.compact.trials import Attempt, Charge, Trials
from foldcut.methods.compact.turns import Solution

LONG_MM = 3.3
"""The length up to which short creases are lengthened: a little more than is easy to fold."""

VANISH_MM = 3.0
"""Creases shorter than this are made to vanish, if possible."""

TINY_MM = 0.05
"""Creases shorter than this are as good as gone."""

IN_VAIN = 3
"""After how many creases that do not vanish the others are left as they are."""

CROSSINGS = 2
"""How many other orders of events are tried before the shortest crease is left as it is."""

FASTER = 1.05
"""A step that lengthens the shortest crease by this factor is worth the next step."""

SLOWER = 1.003
"""After a few steps that lengthen it by no more than ``FASTER`` but by this factor, the steps end."""


class ShortCreases:
    """Lengthens the short creases of solutions, or makes them vanish.

    ``attempt`` tries a solution; ``charge`` is told the cost of what is folded in between.
    """

    def __init__(self, trials: Trials, budget: Budget, attempt: Callable[[Solution], Attempt], charge: Charge) -> None:
        self.trials, self.budget, self.attempt, self.charge = trials, budget, attempt, charge

    def settle(self, solution: Solution) -> None:
        """Lengthen the short creases of a solution; then let one after the other vanish, and lengthen what is left."""
        mover = self.mover(solution)
        self.lengthen(mover)
        if self.trials.best is None or self.trials.best.rank.unfoldable:
            return  # a pattern that can be folded at all comes first
        mover = self.mover(solution)
        number = 0
        while number < IN_VAIN and len(lengths := mover.lengths()) > number and lengths[number] < VANISH_MM:
            fewer = mover.without(number, TINY_MM)
            if fewer is None or len(fewer.lengths()) >= len(lengths) or not self.attempt(fewer.solution).folds:
                number += 1
            else:
                mover, number = fewer, 0
        if mover.solution is not solution:
            self.lengthen(mover)

    def mover(self, solution: Solution) -> Mover:
        """Return a mover for the turns of a solution."""
        trials = self.trials
        return Mover(trials.outline, solution, lambda some: trials.creases(some, self.charge), trials.part.creased)

    def lengthen(self, mover: Mover) -> None:
        """Lengthen the shortest creases; when that ends, send them through zero and go on from there."""
        longest, mover = self._stretched(mover)
        better = True
        while better and 0 < longest < LONG_MM:
            better = False
            for other in islice(mover.across(LONG_MM), CROSSINGS):
                length, other = self._stretched(other)
                if length > FASTER * longest:
                    mover, longest, better = other, length, True
                    break

    def _stretched(self, mover: Mover) -> tuple[float, Mover]:
        """Make the shortest creases as long as possible while events keep their order.

        Returns the length of the shortest in mm, 0 if nothing can move, and the mover.
        """
        longest, stalled = 0.0, 0.0
        best = mover
        while stalled < 2 and longest < LONG_MM and mover.lengthen(LONG_MM):
            self.budget.spend(step_cost(len(mover.solution.x)))
            shortest = float(mover.lengths()[0])
            # a step may make things worse before the next makes them better
            stalled = 0.0 if shortest > FASTER * longest else stalled + (0.4 if shortest > SLOWER * longest else 1.0)
            if shortest > longest:
                longest, best = shortest, copy(mover)
        if longest:
            self.attempt(best.solution)
        return longest, best
