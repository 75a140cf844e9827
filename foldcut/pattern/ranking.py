"""Which of two patterns is easier to fold.

The number of creases and the length of the shortest in mm -> ``Rank``; the lower rank is the better pattern.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from foldcut.core.model import CreasePattern

FOLDABLE_MM = 3.0
"""Creases at least this long are easy to fold by hand."""

SHORTEST_MM = 0.5
"""Creases shorter than this cannot be folded by hand."""

TOO_SHORT = 1.65
"""What each crease counts if the shortest is only just not easy to fold."""

STILL_SHORTER = 0.6
"""What each crease counts in addition if the shortest has no length; less, in proportion, if it has some."""


class Rank(NamedTuple):
    """The rank of a pattern.

    ``unfoldable``: whether it has a crease that nobody can fold; ``creases``: the number of its creases, increased if
    the shortest is hard to fold; ``minus_shortest``: the negative length of the shortest in mm.
    """

    unfoldable: bool
    creases: float
    minus_shortest: float


@dataclass(frozen=True)
class Goal:
    """What ends a search early: the rank that it has to ``beat``, and how many folds are ``enough``.

    No pattern has fewer folds than what is enough; 0 where that is not known. A search that after a third of its time
    takes more than ``hopeful`` times what is to be beaten is given up, and if it is not ``patient``, also one that has
    nothing by then, or what is very far off after a fifth.
    """

    beat: Rank | None = None
    enough: int = 0
    hopeful: float = 1.5
    patient: bool = False

    def is_reached(self, folds: float, shortest: float) -> bool:
        """Return whether no pattern beats one with these folds, the shortest crease of which is so long in mm."""
        return folds <= self.enough and shortest >= FOLDABLE_MM

    def is_near(self, folds: float, shortest: float) -> bool:
        """Return whether a pattern beats what is to be beaten, or may still lead to one that does."""
        if self.beat is None:
            return True
        mine = rank(folds, shortest)
        return mine < self.beat or (
            mine.unfoldable <= self.beat.unfoldable and mine.creases < self.hopeful * self.beat.creases
        )


def shortest_crease(creases: CreasePattern) -> float:
    """Return the length of the shortest crease in mm."""
    ends = creases.vertices_coords[creases.edges_vertices[creases.edges_assignment != "B"]]
    return float(np.hypot(*(ends[:, 1] - ends[:, 0]).T).min())


def rank(count: float, shortest: float) -> Rank:
    """Return the rank of a pattern with ``count`` creases, the shortest of which is ``shortest`` mm long.

    Patterns without creases that nobody can fold come first, then those with fewer creases, then those with longer
    ones.
    """
    if shortest < FOLDABLE_MM:
        count *= TOO_SHORT + STILL_SHORTER * (1 - shortest / FOLDABLE_MM)
    return Rank(shortest < SHORTEST_MM, count, -shortest)
