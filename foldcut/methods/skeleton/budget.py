"""How long sets of perpendiculars are tried.

The seconds are those of a model, so that the result does not depend on the machine.
"""

from __future__ import annotations

from dataclasses import dataclass

USUAL_ROUNDS = 10
"""How many rounds of the solver an order is taken to need before it is known."""

TYPICAL_FACETS = 400
"""How many facets a division of the sheet is taken to have before it is known, and if it has too many creases."""


@dataclass
class Budget:
    """A number of seconds that may be spent, and how many are."""

    limit: float
    spent: float = 0.0

    def start_division(self) -> None:
        """Spend what dividing the sheet is likely to cost: it may fail before the number of facets is known."""
        self.spent += division_cost(TYPICAL_FACETS)

    def divided(self, facets: int) -> None:
        """Spend what the division that was started last has cost, in place of what was likely."""
        self.spent += division_cost(facets) - division_cost(TYPICAL_FACETS)

    def ordered(self, facets: int, rounds: int) -> None:
        """Spend what it has cost to order facets in some rounds of the solver."""
        self.spent += order_cost(facets, rounds)

    @property
    def part(self) -> float:
        """The part of the limit that is spent, 1 at most."""
        return min(1.0, self.spent / self.limit)


def division_cost(facets: int) -> float:
    """Return about how many seconds it takes to divide the sheet into facets and to look for contradictions."""
    return float((facets / 120) ** 1.5) / 30


def order_cost(facets: int, rounds: int = USUAL_ROUNDS) -> float:
    """Return about how many seconds it takes to order facets in some rounds, and to verify the pattern."""
    return (facets / 120) * (0.05 + 0.02 * rounds)
