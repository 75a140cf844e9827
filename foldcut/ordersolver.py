"""Which facet lies on which: a layer order found by a SAT solver.

Folded facets and their creases -> a linear order from bottom to top, or ``UnfoldableError``.

Which of two facets is the upper one is an unknown for each pair that overlaps. A facet that a crease runs across is
above both of the crease's facets or below both (taco-tortilla); of two creases that coincide, with their facets on one
side, neither has just one of the other's facets between its own (taco-taco). Facets must not lie on each other in a
circle: such circles are looked for in what the solver proposes, and forbidden, until there are none.
Source: Akitaya, Demaine and Ku, "Computing Flat-Folded States", 2024 (the unknowns and the conditions).
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from foldcut.errors import UnfoldableError, needed_extra
from foldcut.model import Bools, Floats
from foldcut.stacking import collinear_overlap

Edge = tuple[int, int]
Ring = list[int]
Crease = tuple[Edge, tuple[int, int]]

OVERLAP = 1e-9
"""Facets overlap when they do so by more than this, relative to the size of the folded sheet."""

MOST_CONFLICTS, MOST_CIRCLES = 100_000, 20_000
"""What the solver may run into before it gives up, and how many circles are forbidden at a time."""

MOST_PAIRS = 400_000
"""With more pairs of overlapping facets no order is looked for."""


class OrderSolver:
    """The conditions on the order of folded facets.

    ``folded`` ``(v, 2)`` mm, ``rings`` of vertices, ``creases`` with the facets at their left and right, ``up`` whether
    a facet shows its upper side.
    """

    def __init__(self, folded: Floats, rings: Sequence[Ring], creases: Sequence[Crease], up: Sequence[bool]) -> None:
        self.count = len(rings)
        self.creases = creases
        self.up = up
        self.tolerance = OVERLAP * float(np.hypot(*np.ptp(folded, axis=0)))
        full = shapely.polygons([shapely.linearrings(folded[ring]) for ring in rings])
        self.polygons = shapely.buffer(full, -self.tolerance, join_style="mitre")
        self.ends = folded[np.array([edge for edge, _ in creases])]
        self.tree = shapely.STRtree(self.polygons)
        one, other = self.tree.query(self.polygons, predicate="intersects")
        once = one < other
        self.number: NDArray[np.int64] = np.zeros((self.count, self.count), dtype=np.int64)
        pairs = int(once.sum())
        if pairs > MOST_PAIRS:
            raise UnfoldableError(f"{pairs:,} pairs of facets overlap when folded; too many to order")
        self.number[one[once], other[once]] = np.arange(1, pairs + 1)
        self.pairs = pairs
        for left, right in {crease[1] for crease in creases}:
            self.literal(left, right)  # the facets of a crease always count as overlapping

    def literal(self, above: int, below: int) -> int:
        """The solver's name for "the first facet is above the second"."""
        low, high = sorted((above, below))
        if not self.number[low, high]:
            self.pairs += 1
            self.number[low, high] = self.pairs
        number = int(self.number[low, high])
        return number if above > below else -number

    def clauses(self) -> Iterator[list[int]]:
        """Yield the conditions, each a list of literals one of which is true."""
        yield from self._across()
        yield from self._coinciding()

    def _across(self) -> Iterator[list[int]]:
        """A facet that a crease runs across is not between the crease's facets."""
        along = self.ends[:, 1] - self.ends[:, 0]
        length = np.hypot(*along.T)
        unit = along / length[:, None]
        inset = np.minimum(2 * self.tolerance, length / 3)[:, None] * unit
        lines = shapely.linestrings(np.stack([self.ends[:, 0] + inset, self.ends[:, 1] - inset], axis=1))
        crease, facet = self.tree.query(lines, predicate="intersects")
        for k, other in zip(crease.tolist(), facet.tolist(), strict=True):
            left, right = self.creases[k][1]
            if other not in (left, right):
                one, two = self.literal(other, left), self.literal(other, right)
                yield [one, -two]
                yield [-one, two]

    def _coinciding(self) -> Iterator[list[int]]:
        """Facets of creases that coincide do not interleave."""
        lines = shapely.linestrings(self.ends)
        tree = shapely.STRtree(lines)
        one, other = tree.query(lines, predicate="dwithin", distance=self.tolerance)
        keep = one < other
        one, other = one[keep], other[keep]
        length, same_way = collinear_overlap(self.ends[one], self.ends[other], self.tolerance)
        left = np.array([self.up[facets[0]] for _, facets in self.creases])
        bad = (length > 6 * self.tolerance) & ((left[one] == left[other]) == same_way)
        for k, m in zip(one[bad].tolist(), other[bad].tolist(), strict=True):
            (a, b), (c, d) = self.creases[k][1], self.creases[m][1]
            if len({a, b, c, d}) < 4:
                continue
            ac, bc, ad, bd = (self.literal(*pair) for pair in ((a, c), (b, c), (a, d), (b, d)))
            for signs in range(16):
                row = [-x if signs >> k & 1 else x for k, x in enumerate((ac, bc, ad, bd))]
                if signs.bit_count() % 2:
                    yield row

    def above(self, model: Sequence[int]) -> Bools:
        """Which facet is above which in a model, ``(n, n)``."""
        order = np.zeros((self.count, self.count), dtype=np.bool_)
        true = np.zeros(self.pairs + 1, dtype=np.bool_)
        true[[x for x in model if 0 < x <= self.pairs]] = True
        low, high = np.nonzero(self.number)
        over = true[self.number[low, high]]
        order[high[over], low[over]] = True
        order[low[~over], high[~over]] = True
        return order


def layer_order(
    folded: Floats,
    rings: Sequence[Ring],
    creases: Sequence[Crease],
    up: Sequence[bool],
    *,
    seconds: float = 20.0,
) -> list[int]:
    """Return the facets from bottom to top, in an order in which no paper passes through paper.

    Raises ``UnfoldableError`` when there is no such linear order, when none is found in ``seconds``, or without the
    extra.
    """
    try:
        from pysat.solvers import Solver
    except ImportError as error:
        raise UnfoldableError(needed_extra("layer orders", "skeleton")) from error
    end = time.monotonic() + seconds
    conditions = OrderSolver(folded, rings, creases, up)
    with Solver(name="minisat22", bootstrap_with=list(conditions.clauses())) as solver:
        while True:
            solver.conf_budget(MOST_CONFLICTS)
            found = solver.solve_limited()
            if found is False:
                raise UnfoldableError("the facets cannot be put in an order in which no paper passes through paper")
            if found is None or time.monotonic() > end:
                raise UnfoldableError(f"no order of the {len(rings)} facets was found; there may be one")
            order = conditions.above(solver.get_model() or [])
            circles = list(_circles(order, conditions))
            if not circles:
                return _sorted(order)
            for clause in circles:
                solver.add_clause(clause)


def _reaches(order: Bools) -> Bools:
    """Which facets are above which others in the order, directly or by others between."""
    reach = order
    while True:
        further = reach | ((reach.astype(np.float32) @ reach.astype(np.float32)) > 0)
        if np.array_equal(further, reach):
            return reach
        reach = further


def _circles(order: Bools, conditions: OrderSolver) -> Iterator[list[int]]:
    """Yield clauses that forbid circles: those of three facets, else shortest ones."""
    count = 0
    reach = _reaches(order)
    both = reach & reach.T  # facets on one circle
    inside = both.any(axis=1)
    for a in np.flatnonzero(inside).tolist():
        mine = both[a]
        below = np.flatnonzero(order[a] & mine)
        back = order[:, a] & mine
        b, c = np.nonzero(order[np.ix_(below, np.flatnonzero(back))])
        b, c = below[b], np.flatnonzero(back)[c]
        keep = (b > a) & (c > a)
        for x, y in zip(b[keep].tolist(), c[keep].tolist(), strict=True):
            yield [-conditions.literal(a, x), -conditions.literal(x, y), -conditions.literal(y, a)]
            count += 1
            if count >= MOST_CIRCLES:
                return
    if count:
        return
    for a in np.flatnonzero(inside).tolist():
        circle = _shortest_circle(order, a)
        yield [-conditions.literal(x, y) for x, y in zip(circle, circle[1:] + circle[:1], strict=True)]


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
