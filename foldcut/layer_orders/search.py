"""An order of the faces of a folded sheet, found by a SAT solver, or the answer that there is none.

``Conditions`` -> which face of each pair is above. Transitivity is asked for where it fails: in what the solver
proposes, circles of three faces that share a place are looked for and forbidden, until there are none.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from foldcut.core.arrays import Bools, Indices, Numbers
from foldcut.layer_orders.conditions import TRUE, Conditions

if TYPE_CHECKING:
    from pysat.solvers import Solver

__all__ = ["OrderSearch"]

MOST_CONFLICTS = 2_000_000
"""How many conflicts the solver may run into, all together, before it gives up."""

MOST_CIRCLES = 4_000
"""How many circles are looked at in a round."""

MOST_ROUNDS = 400
"""How many times circles are forbidden before the search gives up."""


class OrderSearch:
    """Looks for an order that fulfils conditions; what it has learnt is kept for further questions.

    ``most_conflicts`` and ``most_rounds`` are when it gives up. Close it after use.
    """

    def __init__(self, conditions: Conditions) -> None:
        from pysat.solvers import Solver

        self.conditions = conditions
        self.rounds = 0
        self.most_conflicts, self.most_rounds = MOST_CONFLICTS, MOST_ROUNDS
        self._solver: Solver = Solver(name="minisat22")
        self._solver.add_clause([TRUE])
        self._solver.append_formula(parity_clauses(conditions.even))
        self._apart: Indices = np.empty(0, dtype=np.intp)
        self.triples: list[Indices] = []

    def close(self) -> None:
        """Free what the solver holds."""
        self._solver.delete()

    def find(self, assumptions: Sequence[int] = ()) -> Bools | None:
        """Return for each pair whether the lesser face is above, ``(n,)``; None if there is none.

        Unless it is ``decided``, the search was given up, and there may be an order. ``assumptions`` are literals.
        """
        self.decided = True
        if self.conditions.contradictory:
            return None
        for _ in range(self.most_rounds):
            self.rounds += 1
            self._solver.conf_budget(self.most_conflicts)
            found = self._solver.solve_limited(assumptions=list(assumptions))
            if found is False:
                return None
            if found is None:
                break
            over = self._model()
            circles = self._circles(over)
            if not len(circles):
                return over
            self.forbid_circles(circles)
        self.decided = False
        return None

    def implied(self) -> Indices:
        """Return the literals that follow without any search."""
        found: Indices = np.array(self._solver.propagate()[1], dtype=np.intp)
        return found

    def core(self) -> list[int]:
        """Return assumptions that cannot hold together, after ``find`` has found that they cannot."""
        return list(self._solver.get_core() or [])

    def forbid_circles(self, triples: Indices) -> None:
        """Ask for transitivity among rows of three faces that share a place."""
        self.triples.append(triples)
        self._solver.append_formula(circle_clauses(self.conditions, triples))

    def _model(self) -> Bools:
        """Return which pairs have the lesser face above in what the solver proposes."""
        model = np.zeros(self.conditions.unknowns + 1, dtype=np.bool_)
        values = np.array(self._solver.get_model() or [], dtype=np.intp)
        values = values[(values > 0) & (values < len(model))]
        model[values] = True
        literal = self.conditions.literal[1:]
        over: Bools = model[np.abs(literal)] == (literal > 0)
        return over

    def _circles(self, over: Bools) -> Indices:
        """Return the triples of faces, ascending, that share a place and lie on each other in a circle."""
        pairs, count = self.conditions.pairs, self.conditions.count
        above = np.zeros((count, count), dtype=np.bool_)
        above[pairs[over, 0], pairs[over, 1]] = True
        above[pairs[~over, 1], pairs[~over, 0]] = True
        dense = above.astype(np.float32)
        on_circle = ((dense @ dense) > 0) & above.T
        found: list[Indices] = []
        number = 0
        for a in np.flatnonzero(on_circle.any(axis=1)).tolist():
            below, back = np.flatnonzero(above[a]), np.flatnonzero(on_circle[a])
            below, back = below[below > a], back[back > a]
            b, c = np.nonzero(above[np.ix_(below, back)])
            b, c = below[b], back[c]
            triples = np.stack([np.full(len(b), a), np.minimum(b, c), np.maximum(b, c)], axis=1)
            triples = triples[~np.isin(self._keys(triples), self._apart)]
            while len(triples):  # of those that would be forbidden by the same clause, one is enough
                first = one_of_each(circle_literals(self.conditions, triples))
                some = triples[first]
                share = self.conditions.sheet.share_area(some)
                self._apart = np.union1d(self._apart, self._keys(some[~share]))
                found.append(some[share])
                number += int(share.sum())
                if share.any():
                    break
                triples = np.delete(triples, first, axis=0)
            if number >= MOST_CIRCLES:
                break
        return np.concatenate(found) if found else np.empty((0, 3), dtype=np.intp)

    def _keys(self, triples: Indices) -> Indices:
        """Return one number for each triple of faces."""
        count = self.conditions.count
        keys: Indices = (triples[:, 0] * count + triples[:, 1]) * count + triples[:, 2]
        return keys


def parity_clauses(even: Indices) -> list[list[int]]:
    """Return equations, an even number of literals of each row is true, as clauses; 0 is no literal."""
    clauses: list[list[int]] = []
    for size in (3, 4):
        rows = even[(even != 0).sum(axis=1) == size][:, :size]
        for signs in itertools.product((1, -1), repeat=size):
            # what may not be: an odd number of true literals, so one of the opposites of each such case holds
            if (signs.count(1)) % 2:
                clauses += (-rows * np.array(signs)).tolist()
    return clauses


def one_of_each(literals: Indices) -> Indices:
    """Return the places of rows of literals, ``(n, k)``, that stand for all with the same literals."""
    first: Indices = np.unique(np.sort(literals, axis=1), axis=0, return_index=True)[1]
    return first


def circle_literals(conditions: Conditions, triples: Numbers) -> Indices:
    """Return for triples of faces, a, b and c, the literals for a above b, b above c, and c above a."""
    a, b, c = triples.T
    return np.stack([conditions.literals(*pair) for pair in ((a, b), (b, c), (c, a))], axis=1)


def circle_clauses(conditions: Conditions, triples: Numbers) -> list[list[int]]:
    """Return clauses that keep triples of faces from lying on each other in a circle, either way around."""
    one = circle_literals(conditions, triples)
    rows = np.concatenate([one, -one])
    rows = np.unique(np.sort(rows, axis=1), axis=0)
    true = (rows == TRUE).any(axis=1)
    for k, m in ((0, 1), (1, 2), (0, 2)):
        true |= rows[:, k] == -rows[:, m]
    clauses: list[list[int]] = rows[~true].tolist()
    return clauses
