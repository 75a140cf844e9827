"""The conditions under which no paper passes through paper, with one unknown for each pair of faces that overlap.

``FoldedSheet`` and what is given -> ``Conditions``. An unknown is whether the lesser face of a pair lies above the
greater one; a literal is the number of an unknown, from 1, negative if it is the other way round.

- A face that an inner edge runs across lies above both faces of that edge or below both (taco-tortilla).
- Of two folded creases that coincide with their faces on the same side, neither has just one face of the other between
  its own: of the four pairs between them an even number has its first face above (taco-taco).
- Where a folded and an unfolded edge coincide, the face beside the fold lies above both of its faces or below both;
  where two unfolded edges coincide, the faces on both sides lie the same way round (tortilla-tortilla).
- Above and below is transitive where three faces share a place, and only there: orders need not be linear.

All but the last are equations modulo 2. Those of two pairs make one unknown of both; this is repeated with what then
remains of the others. The last are found when an order is looked for, in ``search``.
Source: Akitaya, Demaine and Ku, "Computing Flat-Folded States", 2024.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Chars, Indices, Numbers
from foldcut.layer_orders.folded_sheet import FoldedSheet

__all__ = ["TRUE", "Conditions", "given_by_creases"]

TRUE = 1
"""The literal that is always true, among those of united unknowns."""


def given_by_creases(sheet: FoldedSheet, letters: Chars) -> tuple[Indices, Indices]:
    """Return the mountains and valleys, and the order of their two faces: the upper one first, ``(n, 2)``.

    ``letters`` ``(e,)`` are the assignments of all edges of the pattern; creases are given by their places in
    ``sheet.edges``. Seen from above, a face that shows its front makes a valley with a neighbour that lies above it.
    """
    letters = letters[sheet.edges]
    folds = np.flatnonzero(np.isin(letters, ("M", "V")) & sheet.folded)
    left, right = sheet.beside[folds].T
    right_above = (letters[folds] == "V") == sheet.up[left]
    return folds, np.stack([np.where(right_above, right, left), np.where(right_above, left, right)], axis=1)


class Conditions:
    """The conditions on the order of the faces of a folded sheet, with ``given`` pairs: the first above the second.

    ``pairs`` ``(n, 2)`` are the overlapping faces, ascending. ``literal`` ``(n + 1,)`` is for each of these pairs,
    numbered from 1, the literal of the united unknown; ``unknowns`` how many of these there are, ``TRUE`` among them.
    ``even`` ``(m, 4)``: an even number of these literals is true; 0 is none. ``contradictory``: whether some pair would
    have to lie both ways. With ``only``, ``(e,)`` of the sheet's inner edges, nothing is asked of the other edges.
    """

    def __init__(self, sheet: FoldedSheet, given: Indices, only: Bools | None = None) -> None:
        self.sheet, self.count = sheet, sheet.count
        only = np.ones(len(sheet.edges), dtype=np.bool_) if only is None else only
        alike, four = _alike(sheet, only), _interleaved(sheet, only)
        parts = [sheet.overlapping, sheet.beside[sheet.folded], given, *alike]
        parts += [four[:, [k, m]] for k in (0, 1) for m in (2, 3)]
        low, high = np.sort(np.concatenate([part.reshape(-1, 2) for part in parts]), axis=1).T
        self._keys = np.unique(low.astype(np.int64) * self.count + high)
        self.pairs: Indices = np.stack(np.divmod(self._keys, self.count), axis=1)
        first, second = (self.numbers(*side.T) for side in alike)
        facts = self.numbers(*given.T)
        a, b, c, d = four.T
        even = np.stack([self.numbers(*pair) for pair in ((a, c), (b, c), (a, d), (b, d))], axis=1)
        self._begin(first, second, facts, even)

    def numbers(self, above: Numbers, below: Numbers) -> Indices:
        """Return the numbers of pairs, from 1, negative where the upper face is the greater one."""
        low, high = np.minimum(above, below), np.maximum(above, below)
        keys = low.astype(np.int64) * self.count + high
        number = np.searchsorted(self._keys, keys) + 1
        return np.where(above < below, number, -number)

    def known(self, one: Numbers, other: Numbers) -> Bools:
        """Return which pairs of faces are among ``pairs``."""
        keys = np.minimum(one, other).astype(np.int64) * self.count + np.maximum(one, other)
        at = np.minimum(np.searchsorted(self._keys, keys), len(self._keys) - 1)
        found: Bools = self._keys[at] == keys
        return found

    def literals(self, above: Numbers, below: Numbers) -> Indices:
        """Return the literals for "the first face is above the second", for two arrays of faces."""
        return self.of_numbers(self.numbers(above, below))

    def of_numbers(self, numbers: Numbers) -> Indices:
        """Return the literals of numbers of pairs."""
        return np.sign(numbers) * self.literal[np.abs(numbers)]

    def _begin(self, first: Indices, second: Indices, facts: Indices, even: Indices) -> None:
        """Make one unknown of all pairs that lie the same way, or opposite ways; all are numbers of pairs."""
        self.unknowns = len(self.pairs) + 1
        self.literal: Indices = np.arange(1, self.unknowns + 1)
        self.even, self.contradictory = self.of_numbers(even), False
        self._unite(
            np.concatenate([self.of_numbers(first), self.of_numbers(facts)]),
            np.concatenate([self.of_numbers(second), np.full(len(facts), TRUE)]),
        )

    def assume(self, literals: Indices) -> None:
        """Take literals as true."""
        self._unite(literals, np.full(len(literals), TRUE))

    def _unite(self, one: Indices, other: Indices) -> None:
        """Make one unknown of literals that are the same, and again of those that equations then make the same."""
        while True:
            renamed = _united(self.unknowns, one, other)
            if renamed is None:
                self.contradictory = True
                return
            self.unknowns = int(np.abs(renamed).max())
            self.literal = np.sign(self.literal) * renamed[np.abs(self.literal)]
            even = np.sign(self.even) * renamed[np.abs(self.even)]
            self.even, one, other, wrong = _simplified(even)
            self.contradictory = self.contradictory or wrong
            if not len(one):
                return


def _alike(sheet: FoldedSheet, only: Bools) -> tuple[Indices, Indices]:
    """Return pairs of faces, ``(n, 2)`` twice, of which both or neither have the first face above the second."""
    edge, face = sheet.across[only[sheet.across[:, 0]]].T
    one = [np.stack([face, sheet.beside[edge, 0]], axis=1)]
    other = [np.stack([face, sheet.beside[edge, 1]], axis=1)]
    (first, second), aligned = _coinciding(sheet, only)
    folded = sheet.folded
    # a fold (of edge a) at an unfolded edge b: both of its faces lie on the side of one face of b
    for a, b in ((first, second), (second, first)):
        at = np.flatnonzero(folded[a] & ~folded[b])
        fold, flat = a[at], b[at]
        beside = np.where(aligned[at], sheet.beside[flat, 0], sheet.beside[flat, 1])
        one.append(np.stack([beside, sheet.beside[fold, 0]], axis=1))
        other.append(np.stack([beside, sheet.beside[fold, 1]], axis=1))
    at = np.flatnonzero(~folded[first] & ~folded[second])
    a, b = sheet.beside[first[at]], sheet.beside[second[at]]
    b = np.where(aligned[at, None], b, b[:, ::-1])
    one.append(np.stack([a[:, 0], b[:, 0]], axis=1))
    other.append(np.stack([a[:, 1], b[:, 1]], axis=1))
    return np.concatenate(one), np.concatenate(other)


def _coinciding(sheet: FoldedSheet, only: Bools) -> tuple[Indices, Bools]:
    """Return the coinciding edges, ``(2, n)``, of which something is asked, and which are aligned."""
    pairs, aligned = sheet.coinciding
    kept = only[pairs].all(axis=1)
    return pairs[kept].T, aligned[kept]


def _interleaved(sheet: FoldedSheet, only: Bools) -> Indices:
    """Return the faces of two folds that coincide with their faces on the same side, ``(n, 4)``."""
    (first, second), aligned = _coinciding(sheet, only)
    both = aligned & sheet.folded[first] & sheet.folded[second]
    return np.concatenate([sheet.beside[first[both]], sheet.beside[second[both]]], axis=1)


def _united(unknowns: int, one: Indices, other: Indices) -> Indices | None:
    """Return new literals, ``(unknowns + 1,)``, where each of ``one`` is the same as that of ``other``.

    ``TRUE`` stays what it is. None means that an unknown would be the opposite of itself.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    i, j = 2 * np.abs(one) + (one < 0), 2 * np.abs(other) + (other < 0)
    start, end = np.concatenate([i, i ^ 1]), np.concatenate([j, j ^ 1])
    size = 2 * unknowns + 2
    graph = coo_array((np.ones(len(start), dtype=np.int8), (start, end)), shape=(size, size))
    group = connected_components(graph, directed=False)[1]
    straight, turned = group[2::2], group[3::2]
    if (straight == turned).any():
        return None
    # the group of a united unknown is named after the first unknown in it, so TRUE comes first
    _, first, name = np.unique(np.minimum(straight, turned), return_index=True, return_inverse=True)
    rank = np.empty(len(first), dtype=np.intp)
    rank[np.argsort(first)] = np.arange(1, len(first) + 1)
    sign = np.where(straight == straight[first][name], 1, -1)
    literals: Indices = np.concatenate([[0], sign * rank[name]])
    return literals


def _simplified(even: Indices) -> tuple[Indices, Indices, Indices, bool]:
    """Return equations modulo 2 of at least three literals, and what the others say.

    These are pairs of literals that are the same, and whether an equation is wrong whatever the unknowns are.
    """
    rows: NDArray[np.intp] = np.sort(np.abs(even), axis=1)
    odd = (even < 0).sum(axis=1) % 2
    odd = (odd + (rows == TRUE).sum(axis=1)) % 2
    rows[rows == TRUE] = 0
    for k in (0, 1, 2):  # two of the same cancel each other
        same = (rows[:, k] == rows[:, k + 1]) & (rows[:, k] > 0)
        rows[same, k] = rows[same, k + 1] = 0
    rows = -np.sort(-rows, axis=1)
    rows = np.unique(np.column_stack([rows, odd]), axis=0)
    rows, odd = rows[:, :4], rows[:, 4]
    size = (rows > 0).sum(axis=1)
    sign = np.where(odd, -1, 1)
    wrong = bool(((size == 0) & (odd > 0)).any())
    single, double, rest = size == 1, size == 2, size > 2
    # an even number of one unknown: it is false
    one = np.concatenate([-rows[single, 0] * sign[single], rows[double, 0]])
    other = np.concatenate([np.full(int(single.sum()), TRUE), rows[double, 1] * sign[double]])
    kept = rows[rest].copy()
    kept[:, 0] *= sign[rest]
    return kept, one, other, wrong
