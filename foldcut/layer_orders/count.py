"""How many layer orders a folded sheet has.

``Conditions`` and a search that has found an order -> the number of orders, and that of each part. Parts are unknowns
that no condition joins to others, so their numbers are multiplied. Each part is counted by trying both values of one
unknown, which falls into parts again; what was counted once is remembered. Parts with few orders, as most have, are
counted by listing these, which is faster.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Indices, Ints
from foldcut.layer_orders.conditions import TRUE, Conditions
from foldcut.layer_orders.search import OrderSearch, circle_clauses, circle_literals, one_of_each, parity_clauses

__all__ = ["States", "count_states"]

MOST_TRIPLES = 20_000_000
"""With more triples of faces to look at than this, orders are not counted."""

MOST_LISTED = 4_000
"""The orders of a part are listed as long as they are not more than this."""

MOST_NODES = 40_000
"""How many times an unknown is tried both ways before the count is given up."""

BLOCK = 2000
"""For this many pairs of faces at once the third faces are listed."""


@dataclass(frozen=True)
class States:
    """The number of orders: the product of the ``parts``, each of which has at least two."""

    parts: tuple[int, ...]

    @property
    def number(self) -> int:
        """How many orders there are."""
        return math.prod(self.parts)


def count_states(conditions: Conditions, search: OrderSearch) -> States | None:
    """Return how many orders there are, or None if they are too many to be counted.

    ``search`` has found an order; ``conditions`` are changed: what follows from them is taken as true.
    """
    conditions.assume(search.implied())
    triples = _all_circles(conditions)
    if triples is None:
        return None
    rows: Ints = np.array([[TRUE, 0, 0, 0]], dtype=np.int32)
    for clauses in (parity_clauses(conditions.even), circle_clauses(conditions, triples)):
        for size in (3, 4):
            some = np.array([clause for clause in clauses if len(clause) == size], dtype=np.int32).reshape(-1, size)
            rows = np.concatenate([rows, np.pad(some, ((0, 0), (0, 4 - size)))])
    counter = _Counter()
    try:
        parts = counter.parts(rows, conditions.unknowns)
    except _TooManyError:
        return None
    return States(tuple(sorted(part for part in parts if part > 1)))


def _all_circles(conditions: Conditions) -> Indices | None:
    """Return triples of faces that share a place: one for each clause that says something about an unknown."""
    pairs, count = conditions.pairs, conditions.count
    beside = np.zeros((count, count), dtype=np.bool_)
    beside[pairs[:, 0], pairs[:, 1]] = beside[pairs[:, 1], pairs[:, 0]] = True
    free = pairs[np.abs(conditions.literal[1:]) != TRUE]
    found: list[Indices] = []
    number = 0
    for first in range(0, len(free), BLOCK):
        some = free[first : first + BLOCK]
        at, third = np.nonzero(beside[some[:, 0]] & beside[some[:, 1]])
        number += len(at)
        if number > MOST_TRIPLES:
            return None
        triples = np.sort(np.column_stack([some[at], third]), axis=1)
        literals = circle_literals(conditions, triples)
        # if two are opposites, there is no circle
        says = (literals[:, 0] != -literals[:, 1]) & (literals[:, 1] != -literals[:, 2])
        says &= literals[:, 0] != -literals[:, 2]
        found.append(_one_that_shares(conditions, triples[says], literals[says]))
    return np.concatenate([np.empty((0, 3), dtype=np.intp), *found])


def _one_that_shares(conditions: Conditions, triples: Indices, literals: Indices) -> Indices:
    """Return for each different row of literals one of its triples that shares a place, if there is one."""
    literals = np.sort(literals, axis=1)
    turned = -literals[:, ::-1]
    literals = np.where((np.sign(literals).sum(axis=1) < 0)[:, None], turned, literals)  # both ways are one clause
    found = [np.empty((0, 3), dtype=np.intp)]
    while len(triples):
        first = one_of_each(literals)
        share = conditions.sheet.share_area(triples[first])
        found.append(triples[first[share]])
        done = {row.tobytes() for row in literals[first[share]]}
        left = np.array([row.tobytes() not in done for row in literals], dtype=np.bool_)
        left[first] = False
        triples, literals = triples[left], literals[left]
    return np.concatenate(found)


class _TooManyError(Exception):
    """The count was given up."""


class _Counter:
    """Counts the solutions of clauses, rows of four literals with 0 for none."""

    def __init__(self) -> None:
        self._known: dict[bytes, int] = {}
        self._nodes = 0

    def parts(self, rows: Ints, unknowns: int) -> list[int]:
        """Return the number of solutions of each part of ``unknowns`` unknowns; a single 0 if there are none."""
        simple = _propagated(rows)
        if simple is None:
            return [0]
        rows, fixed = simple
        left = np.unique(np.abs(rows))
        left = left[left > 0]
        free = unknowns - fixed - len(left)
        return [2] * free + [self._of_part(part) for part in _parts(rows)]

    def _of_part(self, rows: Ints) -> int:
        """Return the number of solutions of one part: listed if they are few, or else counted."""
        if self._nodes:  # it is within a part with many
            return self._count(rows)
        number = _listed(rows)
        if number is not None:
            return number
        number, self._nodes = self._count(rows), 0
        return number

    def _count(self, rows: Ints) -> int:
        """Return the number of solutions of one part."""
        key = rows.tobytes()
        if key in self._known:
            return self._known[key]
        self._nodes += 1
        if self._nodes > MOST_NODES:
            raise _TooManyError
        names, counts = np.unique(np.abs(rows), return_counts=True)
        names, counts = names[names > 0], counts[names > 0]
        unknown = int(names[counts.argmax()])
        total = 0
        for literal in (unknown, -unknown):
            unit = np.array([[literal, 0, 0, 0]], dtype=rows.dtype)
            total += math.prod(self.parts(np.concatenate([rows, unit]), len(names)))
        self._known[key] = total
        return total


def _listed(rows: Ints) -> int | None:
    """Return the number of solutions of clauses by finding one after the other, or None if they are many."""
    from pysat.solvers import Solver

    names, at = np.unique(np.abs(rows), return_inverse=True)
    numbers = at.reshape(rows.shape) + (0 if names[0] == 0 else 1)
    clauses = [[literal for literal in row if literal] for row in (np.sign(rows) * numbers).tolist()]
    with Solver(name="minisat22", bootstrap_with=clauses) as solver:
        for number in range(MOST_LISTED + 1):
            if not solver.solve():
                return number
            solver.add_clause([-literal for literal in solver.get_model() or []])
    return None


def _propagated(rows: Ints) -> tuple[Ints, int] | None:
    """Return what is left of clauses when single literals are taken as true, and how many; None if one fails."""
    fixed: set[int] = set()
    while True:
        size = (rows != 0).sum(axis=1)
        if (size == 0).any():
            return None
        units = np.unique(rows[size == 1].sum(axis=1))
        if not len(units):
            return rows, len(fixed)
        if np.isin(-units, units).any():
            return None
        fixed.update(np.abs(units).tolist())
        rows = rows[~np.isin(rows, units).any(axis=1)]
        rows = np.where(np.isin(rows, -units), 0, rows)


def _parts(rows: Ints) -> list[Ints]:
    """Return the clauses of each part, in an order that does not depend on where they came from."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    if not len(rows):
        return []
    rows = np.unique(np.sort(rows, axis=1), axis=0)
    names, at = np.unique(np.abs(rows), return_inverse=True)
    at = at.reshape(rows.shape)
    row, column = np.nonzero(rows)
    nodes = at[row, column]
    count = len(names) + len(rows)
    graph = coo_array((np.ones(len(row), dtype=np.int8), (nodes, len(names) + row)), shape=(count, count))
    part = connected_components(graph, directed=False)[1][len(names) :]
    order = np.argsort(part, kind="stable")
    return [rows[some] for some in np.split(order, np.flatnonzero(np.diff(part[order])) + 1)]
