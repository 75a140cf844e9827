"""Which facet lies on which: a layer order found by a SAT solver.

Folded facets and their creases -> a linear order from bottom to top, or ``UnfoldableError``.

Which of two facets is the upper one is an unknown for each pair that overlaps. A facet that a crease runs across is
above both of the crease's facets or below both (taco-tortilla); of two creases that coincide, with their facets on one
side, neither has just one of the other's facets between its own (taco-taco): of four pairs an even number is true.
Facets must not lie on each other in a circle: such circles are looked for in what the solver proposes, and forbidden,
until there are none.
Source: Akitaya, Demaine and Ku, "Computing Flat-Folded States", 2024 (the unknowns and the conditions).
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Floats
from foldcut.core.errors import UnfoldableError, needed_extra
from foldcut.geometry.segments import collinear_overlap

Edge = tuple[int, int]
Ring = list[int]
Crease = tuple[Edge, tuple[int, int]]
Ints = NDArray[np.intp]

OVERLAP = 1e-9
"""Facets overlap when they do so by more than this, relative to the size of the folded sheet."""

MOST_CONFLICTS, MOST_CIRCLES = 100_000, 20_000
"""What the solver may run into before it gives up, and how many circles are forbidden at a time."""

NO_ORDER = "the facets cannot be put in an order in which no paper passes through paper"

MOST_ROUNDS = 40
"""So many times circles are forbidden; 26 were needed for 460 facets."""

WAYS = 8
"""Of so many pairs that would have to lie both ways the reason is looked for."""

MOST_PAIRS = 400_000
"""With more pairs of overlapping facets no order is looked for."""


class OrderSolver:
    """The conditions on the order of folded facets.

    ``folded`` ``(v, 2)`` mm, ``rings`` of vertices, ``creases`` with the facets at their left and right, ``up`` whether
    a facet shows its upper side. ``contradictory``: how many pairs would have to lie both ways because of the facets
    that creases run across, and if there are none, how many conditions of creases that coincide contradict others; with
    any there is no order, and that is quickly known: all these conditions are equations modulo 2.
    Raises ``UnfoldableError`` without the extra, or with too many facets.
    """

    def __init__(self, folded: Floats, rings: Sequence[Ring], creases: Sequence[Crease], up: Sequence[bool]) -> None:
        try:
            import pysat.solvers  # noqa: F401  # used only where there may be an order
        except ImportError as error:
            raise UnfoldableError(needed_extra("layer orders", "skeleton")) from error
        self.count = len(rings)
        self.rounds = 0  # how many the solver took
        self.beside: Ints = np.array([facets for _, facets in creases], dtype=np.intp).reshape(-1, 2)
        self.tolerance = OVERLAP * float(np.hypot(*np.ptp(folded, axis=0)))
        full = shapely.polygons([shapely.linearrings(folded[ring]) for ring in rings])
        self.polygons = shapely.buffer(full, -self.tolerance, join_style="mitre")
        self.ends = folded[np.array([edge for edge, _ in creases], dtype=np.intp).reshape(-1, 2)]
        self.tree = shapely.STRtree(self.polygons)
        overlapping = self.tree.query(self.polygons, predicate="intersects").T
        count = int((overlapping[:, 0] < overlapping[:, 1]).sum())
        if count > MOST_PAIRS:
            raise UnfoldableError(f"{count:,} pairs of facets overlap when folded; too many to order")
        across = self._across()
        self.coinciding = self._coinciding(np.array(up, dtype=np.bool_))
        # the facets of a crease always count as overlapping
        pairs = [overlapping, self.beside, across[:, [0, 1]], across[:, [0, 2]]]
        pairs += [self.coinciding[:, [k, m]] for k in (0, 1) for m in (2, 3)]
        low, high = np.sort(np.concatenate(pairs), axis=1).T
        self.number: Ints = np.zeros((self.count, self.count), dtype=np.intp)
        self.number[low, high] = low < high
        self.pair = np.nonzero(self.number)
        self.number[self.pair] = np.arange(1, len(self.pair[0]) + 1)
        self._unite(across)

    def _unite(self, across: Ints) -> None:
        """Make one unknown of all pairs that are known to lie the same way, or opposite ways."""
        # every pair twice: the lesser facet below, and above
        n = len(self.pair[0]) + 1
        group: Ints = np.arange(2 * n)
        if len(across):  # scipy takes a while to load
            from scipy.sparse import coo_array
            from scipy.sparse.csgraph import connected_components

            one, other = (self._signed(across[:, 0], across[:, k]) for k in (1, 2))
            i, j = (np.concatenate([np.where(x > 0, x, n - x), np.where(x > 0, n + x, -x)]) for x in (one, other))
            self.alike = coo_array((np.ones(len(i)), (i, j)), shape=(2 * n, 2 * n)).tocsr()
            group = connected_components(self.alike, directed=False)[1].astype(np.intp)
        straight, turned = group[:n], group[n:]
        _, unknown = np.unique(np.minimum(straight, turned), return_inverse=True)
        self.unknown = np.where(straight < turned, 1, -1) * (unknown + 1)
        self.both_ways = np.flatnonzero(straight[1:] == turned[1:]) + 1
        self.contradictory = len(self.both_ways), 0
        a, b, c, d = self.coinciding.T
        self.even: Ints = np.stack([self.literals(*pair) for pair in ((a, c), (b, c), (a, d), (b, d))], axis=1)
        if not any(self.contradictory):
            self.contradictory = 0, self._contradictory_equations()

    def facets_of_contradiction(self) -> Ints:
        """The facets by which a pair would have to lie both ways: the shortest way there of a few pairs' ways."""
        from scipy.sparse.csgraph import shortest_path

        n = len(self.pair[0]) + 1
        tried = self.both_ways[np.linspace(0, len(self.both_ways) - 1, WAYS).astype(np.intp)]
        steps, before = shortest_path(
            self.alike, directed=False, indices=tried, unweighted=True, return_predecessors=True
        )
        least = int(steps[np.arange(WAYS), tried + n].argmin())
        way = [int(tried[least]) + n]
        while way[-1] != tried[least]:
            way.append(int(before[least, way[-1]]))
        pairs = np.array(way) % n - 1
        return np.unique(np.concatenate([side[pairs] for side in self.pair]))

    def _contradictory_equations(self) -> int:
        """How many conditions of coinciding creases contradict those before them: Gaussian elimination modulo 2."""
        rows = np.sort(np.abs(self.even), axis=1)
        rows = np.unique(np.column_stack([rows, (self.even < 0).sum(axis=1) % 2]), axis=0)
        pivots: dict[int, int] = {}
        count = 0
        for *unknowns, odd in rows.tolist():
            equation = odd  # bit k for unknown k, bit 0 for the right side
            for unknown in unknowns:
                equation ^= 1 << unknown
            while equation > 1 and (pivot := pivots.get(equation.bit_length())):
                equation ^= pivot
            if equation > 1:
                pivots[equation.bit_length()] = equation
            count += equation == 1
        return count

    def _signed(self, above: Ints, below: Ints) -> Ints:
        """The numbers of pairs, negative where the first facet is the lesser one."""
        number = self.number[np.minimum(above, below), np.maximum(above, below)]
        return np.where(above > below, number, -number)

    def literals(self, above: Ints, below: Ints) -> Ints:
        """The solver's names for "the first facet is above the second"; arrays of facets."""
        signed = self._signed(above, below)
        return np.sign(signed) * self.unknown[np.abs(signed)]

    def clauses(self) -> list[list[int]]:
        """Return what is left to be kept, each a list of literals one of which is true."""
        odd = [signs for signs in itertools.product((1, -1), repeat=4) if np.prod(signs) < 0]
        return _different(np.concatenate([self.even * signs for signs in odd]))

    def _across(self) -> Ints:
        """Facets that creases run across, and the facets of these, ``(n, 3)``: the first is not between the others."""
        along = self.ends[:, 1] - self.ends[:, 0]
        length = np.hypot(*along.T)
        inset = (np.minimum(2 * self.tolerance, length / 3) / length)[:, None] * along
        lines = shapely.linestrings(np.stack([self.ends[:, 0] + inset, self.ends[:, 1] - inset], axis=1))
        crease, facet = self.tree.query(lines, predicate="intersects")
        found = np.column_stack([facet, self.beside[crease]])
        kept: Ints = found[(found[:, :1] != found[:, 1:]).all(axis=1)]
        return kept

    def _coinciding(self, up: Bools) -> Ints:
        """The facets of creases that coincide, ``(n, 4)``: the first two and the last two do not interleave."""
        lines = shapely.linestrings(self.ends)
        tree = shapely.STRtree(lines)
        one, other = tree.query(lines, predicate="dwithin", distance=self.tolerance)
        keep = one < other
        one, other = one[keep], other[keep]
        length, same_way = collinear_overlap(self.ends[one], self.ends[other], self.tolerance)
        left = up[self.beside[:, 0]]
        bad = (length > 6 * self.tolerance) & ((left[one] == left[other]) == same_way)
        first, second = self.beside[one[bad]], self.beside[other[bad]]
        apart = (first[:, :, None] != second[:, None, :]).all(axis=(1, 2))
        return np.concatenate([first[apart], second[apart]], axis=1)

    def above(self, model: Sequence[int]) -> Bools:
        """Which facet is above which in a model, ``(n, n)``."""
        true = np.zeros(int(np.abs(self.unknown).max()) + 1, dtype=np.bool_)
        true[[x for x in model if 0 < x < len(true)]] = True
        unknown = self.unknown[1:]
        over = true[np.abs(unknown)] == (unknown > 0)
        low, high = self.pair
        order = np.zeros((self.count, self.count), dtype=np.bool_)
        order[high[over], low[over]] = True
        order[low[~over], high[~over]] = True
        return order


def _different(clauses: Ints) -> list[list[int]]:
    """Return clauses of as many literals once each, without those that are always true."""
    rows = np.unique(np.sort(clauses, axis=1), axis=0)
    return [row for row in (list(set(row)) for row in rows.tolist()) if not any(-x in row for x in row)]


def layer_order(conditions: OrderSolver) -> list[int]:
    """Return the facets from bottom to top, in an order in which no paper passes through paper.

    Raises ``UnfoldableError`` when there is no such linear order, or when none is found soon.
    """
    from pysat.solvers import Solver

    if any(conditions.contradictory):
        raise UnfoldableError(NO_ORDER)
    with Solver(name="minisat22", bootstrap_with=conditions.clauses()) as solver:
        for conditions.rounds in range(1, MOST_ROUNDS + 1):
            solver.conf_budget(MOST_CONFLICTS)
            found = solver.solve_limited()
            if found is False:
                raise UnfoldableError(NO_ORDER)
            if found is None:
                break
            order = conditions.above(solver.get_model() or [])
            circles = list(_circles(order, conditions))
            if not circles:
                return _sorted(order)
            for clause in circles:
                solver.add_clause(clause)
    raise UnfoldableError(f"no order of the {conditions.count} facets was found; there may be one")


def _reaches(order: Bools) -> Bools:
    """Which facets are above which others in the order, directly or by others between."""
    reach = order
    while True:
        further = reach | ((reach.astype(np.float32) @ reach.astype(np.float32)) > 0)
        if np.array_equal(further, reach):
            return reach
        reach = further


def _circles(order: Bools, conditions: OrderSolver) -> list[list[int]]:
    """Return clauses that forbid circles: those of three facets, else shortest ones."""
    reach = _reaches(order)
    both = reach & reach.T  # facets on one circle
    inside = np.flatnonzero(both.any(axis=1)).tolist()
    found: list[Ints] = []
    count = 0
    for a in inside:
        below = np.flatnonzero(order[a] & both[a])
        back = np.flatnonzero(order[:, a] & both[a])
        below, back = below[below > a], back[back > a]
        b, c = np.nonzero(order[np.ix_(below, back)])
        b, c = below[b], back[c]
        pairs = ((np.full(len(b), a), b), (b, c), (c, np.full(len(b), a)))
        found.append(np.stack([-conditions.literals(*pair) for pair in pairs], axis=1))
        count += len(b)
        if count >= MOST_CIRCLES:
            break
    if count:
        return _different(np.concatenate(found))
    circles = [np.array(_shortest_circle(order, a)) for a in inside]
    return [row for circle in circles for row in _different(-conditions.literals(circle, np.roll(circle, -1))[None])]


def _shortest_circle(order: Bools, start: int) -> list[int]:
    before = {start: -1}
    row = [start]
    while row:
        following = []
        for a in row:
            if order[a, start]:
                circle = [a]
                while before[circle[-1]] >= 0:
                    circle.append(before[circle[-1]])
                return circle[::-1]
            for b in np.flatnonzero(order[a]).tolist():
                if b not in before:
                    before[b] = a
                    following.append(b)
        row = following
    raise AssertionError("no circle")


def _sorted(order: Bools) -> list[int]:
    """Sort facets so that those above come later."""
    below = order.sum(axis=1)
    ready = [int(k) for k in np.flatnonzero(below == 0)]
    result = []
    while ready:
        facet = ready.pop()
        result.append(facet)
        above = np.flatnonzero(order[:, facet])
        below[above] -= 1
        ready += [int(k) for k in above if below[k] == 0]
    return result
