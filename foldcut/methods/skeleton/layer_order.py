"""Which facet lies on which: a layer order found by a SAT solver.

Folded facets and their creases -> a linear order from bottom to top, or ``UnfoldableError``.

For each pair of facets that overlap, which one is the upper is an unknown. Two kinds of conditions relate these:

- taco-tortilla: a facet that a crease runs across is above both of the crease's facets or below both;
- taco-taco: of two creases that coincide and have their facets on the same side, neither has just one of the other's
  facets between its own. Of the four pairs between them, an even number has its first facet above.

Both are equations modulo 2, so most contradictions are found without the solver. Facets must not lie on each other in a
circle, either: circles are looked for in what the solver proposes, and forbidden, until there are none.
Source: Akitaya, Demaine and Ku, "Computing Flat-Folded States", 2024 (the unknowns and the conditions).
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Floats
from foldcut.core.errors import UnfoldableError
from foldcut.geometry.segments import collinear_overlap
from foldcut.methods.skeleton.facets import Crease
from foldcut.methods.skeleton.skeleton_faces import Vertices

Ints = NDArray[np.intp]

OVERLAP = 1e-9
"""Facets overlap where they reach into each other by more than this, relative to the size of the folded sheet."""

NEARLY_PARALLEL = 0.1
"""Creases whose unit directions have a larger cross product do not coincide, however short they are."""

MOST_CONFLICTS = 100_000
"""How many conflicts the solver may run into before it gives up."""

MOST_CIRCLES = 20_000
"""How many circles are forbidden at a time."""

MOST_ROUNDS = 40
"""How many times circles are forbidden before the search gives up; 460 facets needed 26."""

WAYS = 8
"""For how many of the pairs that would have to lie both ways the reason is looked for."""

LONGER = 2
"""Chains of taco-tortillas that are this many times as long as the shortest one are left out."""

MOST_PAIRS = 400_000
"""With more pairs of overlapping facets no order is looked for."""

NO_ORDER = "the facets cannot be put in an order in which no paper passes through paper"


class OrderConditions:
    """The conditions on the order of folded facets.

    ``folded`` ``(v, 2)`` mm; ``facets`` their vertices; ``creases`` with the facets on their left and right; ``up``
    whether a facet shows its upper side.

    ``across`` ``(n, 3)`` are the taco-tortillas: a facet that a crease runs across, and the crease's two facets.
    ``coinciding`` ``(n, 4)`` are the taco-tacos: the two facets of one crease, and those of the other. ``number``
    ``(count, count)`` numbers the pairs of facets in conditions, and once they are ``complete`` all that overlap, from
    1, with the lesser facet first; 0 means none.

    ``contradictory`` has two counts: of pairs that would have to lie both ways because of the taco-tortillas, and if
    there are none, of taco-tacos that contradict those before them. Unless both are 0, there is no order.
    Raises ``UnfoldableError`` where a crease has no length.
    """

    def __init__(
        self, folded: Floats, facets: Sequence[Vertices], creases: Sequence[Crease], up: Sequence[bool]
    ) -> None:
        self.count = len(facets)
        self.rounds = 0  # how many the solver took
        self._beside: Ints = np.array([pair for _, pair in creases], dtype=np.intp).reshape(-1, 2)
        self._tolerance = OVERLAP * float(np.hypot(*np.ptp(folded, axis=0)))
        self._ends = folded[np.array([edge for edge, _ in creases], dtype=np.intp).reshape(-1, 2)]
        if not (np.hypot(*(self._ends[:, 1] - self._ends[:, 0]).T) > 0).all():
            raise UnfoldableError("a crease has no length when it is folded")
        sizes = [len(facet) for facet in facets]
        corners = folded[np.concatenate([np.asarray(facet, dtype=np.intp) for facet in facets])]
        rings = shapely.linearrings(corners, indices=np.repeat(np.arange(self.count), sizes))
        inset = shapely.buffer(shapely.polygons(rings), -self._tolerance, join_style="mitre")
        self._tree = shapely.STRtree(inset)
        self.across = self._find_across()
        self.coinciding = self._find_coinciding(np.array(up, dtype=np.bool_))
        self._relate(np.empty((0, 2), dtype=np.intp))
        self.contradictory = len(self._both_ways), 0
        if not any(self.contradictory):
            self.contradictory = 0, _contradictory_equations(self._even)

    def complete(self) -> None:
        """Also number the pairs of facets that overlap without being in any condition: they may be on circles.

        Raises ``UnfoldableError`` if there are too many pairs.
        """
        overlapping = self._tree.query(self._tree.geometries, predicate="intersects").T
        count = int((overlapping[:, 0] < overlapping[:, 1]).sum())
        if count > MOST_PAIRS:
            raise UnfoldableError(f"{count:,} pairs of facets overlap when they are folded; too many to order")
        self._relate(overlapping)

    def _relate(self, overlapping: Ints) -> None:
        """Number all pairs of facets that overlap or are in a condition, and write the conditions with them."""
        self._number_pairs(overlapping)
        self._unite_pairs()
        a, b, c, d = self.coinciding.T
        self._even: Ints = np.stack([self.literals(*pair) for pair in ((a, c), (b, c), (a, d), (b, d))], axis=1)

    def _number_pairs(self, overlapping: Ints) -> None:
        """Number all pairs that overlap; the facets of one condition always count as overlapping."""
        pairs = [overlapping, self._beside, self.across[:, [0, 1]], self.across[:, [0, 2]]]
        pairs += [self.coinciding[:, [k, m]] for k in (0, 1) for m in (2, 3)]
        low, high = np.sort(np.concatenate(pairs), axis=1).T
        self.number: Ints = np.zeros((self.count, self.count), dtype=np.intp)
        self.number[low, high] = low < high
        self._pair = np.nonzero(self.number)
        self.number[self._pair] = np.arange(1, len(self._pair[0]) + 1)

    def _unite_pairs(self) -> None:
        """Make one unknown of all pairs that lie the same way, or opposite ways, because of taco-tortillas."""
        # every pair twice: number k for the lesser facet below, n + k for the lesser facet above
        n = len(self._pair[0]) + 1
        one, other = (self._signed(self.across[:, 0], self.across[:, k]) for k in (1, 2))
        i, j = (np.concatenate([np.where(x > 0, x, n - x), np.where(x > 0, n + x, -x)]) for x in (one, other))
        self._alike: tuple[Ints, Ints] = i, j
        group = _connected(2 * n, i, j)
        straight, turned = group[:n], group[n:]
        _, unknown = np.unique(np.minimum(straight, turned), return_inverse=True)
        self._unknown = np.where(straight < turned, 1, -1) * (unknown + 1)
        self._both_ways = np.flatnonzero(straight[1:] == turned[1:]) + 1

    def facets_of_contradictions(self) -> list[Ints]:
        """Return for some pairs of facets that would have to lie both ways the facets that make them do so.

        ``contradictory`` counts such pairs. Those with the shortest chains of taco-tortillas come first.
        """
        n = len(self._pair[0]) + 1
        graph = _Graph(2 * n, *self._alike)
        tried = np.unique(self._both_ways[np.linspace(0, len(self._both_ways) - 1, WAYS).astype(np.intp)])
        most, ways = 2 * n, list[Ints]()
        for pair in tried.tolist():
            way = graph.shortest_way(pair, pair + n, most)
            if way is not None:
                ways.append(way)
                most = min(most, LONGER * len(way))
        ways.sort(key=len)
        return [np.unique(np.concatenate([side[way % n - 1] for side in self._pair])) for way in ways]

    def _signed(self, above: Ints, below: Ints) -> Ints:
        """Return the numbers of pairs, negative where the first facet is the lesser one."""
        number = self.number[np.minimum(above, below), np.maximum(above, below)]
        return np.where(above > below, number, -number)

    def literals(self, above: Ints, below: Ints) -> Ints:
        """Return the solver's literals for "the first facet is above the second", for two arrays of facets."""
        signed = self._signed(above, below)
        return np.sign(signed) * self._unknown[np.abs(signed)]

    def clauses(self) -> list[list[int]]:
        """Return the taco-tacos as clauses: lists of literals, of each of which one has to be true."""
        odd = [signs for signs in itertools.product((1, -1), repeat=4) if np.prod(signs) < 0]
        return _different(np.concatenate([self._even * signs for signs in odd]))

    def _find_across(self) -> Ints:
        """Find the facets that creases run across by more than the tolerance."""
        along = self._ends[:, 1] - self._ends[:, 0]
        length = np.hypot(*along.T)
        inset = (np.minimum(2 * self._tolerance, length / 3) / length)[:, None] * along
        lines = shapely.linestrings(np.stack([self._ends[:, 0] + inset, self._ends[:, 1] - inset], axis=1))
        crease, facet = self._tree.query(lines, predicate="intersects")
        found = np.column_stack([facet, self._beside[crease]])
        kept: Ints = found[(found[:, :1] != found[:, 1:]).all(axis=1)]
        return kept

    def _find_coinciding(self, up: Bools) -> Ints:
        """Find the creases that coincide with their facets on the same side."""
        low, high = self._ends.min(axis=1) - self._tolerance, self._ends.max(axis=1) + self._tolerance
        boxes = shapely.box(*low.T, *high.T)
        one, other = shapely.STRtree(boxes).query(boxes)
        along = self._ends[:, 1] - self._ends[:, 0]
        along /= np.hypot(*along.T)[:, None]
        keep = one < other
        one, other = one[keep], other[keep]
        keep = np.abs(along[one, 0] * along[other, 1] - along[one, 1] * along[other, 0]) < NEARLY_PARALLEL
        one, other = one[keep], other[keep]
        length, same_way = collinear_overlap(self._ends[one], self._ends[other], self._tolerance)
        left = up[self._beside[:, 0]]
        bad = (length > 6 * self._tolerance) & ((left[one] == left[other]) == same_way)
        first, second = self._beside[one[bad]], self._beside[other[bad]]
        apart = (first[:, :, None] != second[:, None, :]).all(axis=(1, 2))
        return np.concatenate([first[apart], second[apart]], axis=1)

    def above(self, model: Sequence[int]) -> Bools:
        """Return whether facet a is above facet b in a model of the solver, ``(count, count)``."""
        true = np.zeros(int(np.abs(self._unknown).max()) + 1, dtype=np.bool_)
        true[[x for x in model if 0 < x < len(true)]] = True
        unknown = self._unknown[1:]
        over = true[np.abs(unknown)] == (unknown > 0)
        low, high = self._pair
        order = np.zeros((self.count, self.count), dtype=np.bool_)
        order[high[over], low[over]] = True
        order[low[~over], high[~over]] = True
        return order


class _Graph:
    """Undirected edges between ``count`` nodes, ``one[k]`` to ``other[k]``."""

    def __init__(self, count: int, one: Ints, other: Ints) -> None:
        start, end = np.concatenate([one, other]), np.concatenate([other, one])
        order = np.argsort(start, kind="stable")
        self._ends = end[order]
        self._first = np.searchsorted(start[order], np.arange(count + 1))

    def shortest_way(self, start: int, end: int, most: int) -> Ints | None:
        """Return the nodes on a shortest way from one node to another, None if they are more than ``most``."""
        before = np.full(len(self._first) - 1, -1)
        before[start] = start
        row: Ints = np.array([start])
        steps = 1
        while before[end] < 0:
            steps += 1
            if steps > most or not len(row):
                return None
            count = self._first[row + 1] - self._first[row]
            at = np.repeat(self._first[row] - np.cumsum(count) + count, count) + np.arange(int(count.sum()))
            reached, origin = self._ends[at], np.repeat(row, count)
            new = before[reached] < 0
            reached, kept = np.unique(reached[new], return_index=True)
            before[reached] = origin[new][kept]
            row = reached
        way = [end]
        while way[-1] != start:
            way.append(int(before[way[-1]]))
        return np.array(way)


def _connected(count: int, one: Ints, other: Ints) -> Ints:
    """Return for each of ``count`` nodes the least node that edges from ``one[k]`` to ``other[k]`` join it to."""
    least: Ints = np.arange(count)
    while True:
        a, b = least[one], least[other]
        apart = a != b
        if not apart.any():
            return least
        one, other, a, b = one[apart], other[apart], a[apart], b[apart]
        np.minimum.at(least, np.maximum(a, b), np.minimum(a, b))
        while True:
            farther = least[least]
            if np.array_equal(farther, least):
                break
            least = farther


def layer_order(conditions: OrderConditions, given: Ints | None = None) -> list[int]:
    """Return the facets from bottom to top, in an order in which no paper passes through paper.

    ``given`` ``(n, 2)``: pairs of facets that overlap, the first of which has to be above the second. Raises
    ``UnfoldableError`` when there is no such order, and when none is found soon enough.
    """
    from pysat.solvers import Solver

    if any(conditions.contradictory):
        raise UnfoldableError(NO_ORDER)
    conditions.complete()
    clauses = conditions.clauses()
    if given is not None:
        clauses += conditions.literals(*given.T)[:, None].tolist()
    with Solver(name="minisat22", bootstrap_with=clauses) as solver:
        for conditions.rounds in range(1, MOST_ROUNDS + 1):
            solver.conf_budget(MOST_CONFLICTS)
            found = solver.solve_limited()
            if found is False:
                raise UnfoldableError(NO_ORDER)
            if found is None:
                break
            order = conditions.above(solver.get_model() or [])
            circles = _circles(order, conditions)
            if not circles:
                return _sorted(order)
            for clause in circles:
                solver.add_clause(clause)
    raise UnfoldableError(f"no order of the {conditions.count} facets was found; there may be one")


def _contradictory_equations(even: Ints) -> int:
    """Return how many equations contradict those before them, by Gaussian elimination modulo 2.

    Each of ``even`` ``(n, 4)`` says that an even number of four literals is true.
    """
    rows = np.sort(np.abs(even), axis=1)
    rows = np.unique(np.column_stack([rows, (even < 0).sum(axis=1) % 2]), axis=0)
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


def _different(clauses: Ints) -> list[list[int]]:
    """Return clauses of the same number of literals once each, without those that are always true."""
    rows = np.sort(clauses, axis=1)
    most = int(np.abs(rows).max(initial=0))
    keys = np.zeros(len(rows), dtype=np.int64)
    if (2 * most + 1) ** rows.shape[1] < 2**63:
        for column in rows.T:
            keys = keys * (2 * most + 1) + (column + most)
        rows = rows[np.unique(keys, return_index=True)[1]]
    else:
        rows = np.unique(rows, axis=0)
    return [row for row in (list(set(row)) for row in rows.tolist()) if not any(-x in row for x in row)]


def _on_circles(order: Bools) -> Ints:
    """Return the facets that are left when all are taken away, one after the other, with nothing above or below them.

    All that are on circles of facets are among them.
    """
    left: Ints = np.arange(len(order))
    while len(left):
        among = order[np.ix_(left, left)]
        kept = among.any(axis=0) & among.any(axis=1)
        if kept.all():
            break
        left = left[kept]
    return left


def _reaches(order: Bools) -> Bools:
    """Return which facets are above which others, directly or by others between, ``(count, count)``."""
    reach = order
    while True:
        further = reach | ((reach.astype(np.float32) @ reach.astype(np.float32)) > 0)
        if np.array_equal(further, reach):
            return reach
        reach = further


def _circles(order: Bools, conditions: OrderConditions) -> list[list[int]]:
    """Return clauses that forbid circles: those of three facets, and where there are none, the shortest ones."""
    some = _on_circles(order)
    if not len(some):
        return []
    reach = _reaches(order[np.ix_(some, some)])
    both = np.zeros_like(order)
    both[np.ix_(some, some)] = reach & reach.T  # pairs of facets that are on one circle
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
    """Return a shortest circle of facets through one that is on a circle, each above the next one."""
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
    raise AssertionError(f"facet {start} is on no circle")


def _sorted(order: Bools) -> list[int]:
    """Return the facets so that those above come later."""
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
