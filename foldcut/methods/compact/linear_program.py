"""Where the turns of a walk land on the cut line, by linear programming.

Outline, ``Turns`` and wishes -> ``Solution``.

The unknowns are the images of all turns. From one turn to the next x changes by as much as there is of the side between
them, so the images also tell how far along its side each turn is that is not a corner. The molecules close if no two
turns that see each other are nearer on the sheet than in the tree (see ``pairs``). These conditions are linear in the
images. There are many, so only those that a solution breaks are added, until it breaks none. The distance between turns
on sides is a convex function of the images; its tangent at the last solution is used, which is on the safe side.

As long as the turns do not suffice, parts of the outline are left out; there more turns are needed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.methods.compact.outline import Outline
from foldcut.methods.compact.pairs import Pairs, later_pairs, tree_paths, visible_pairs
from foldcut.methods.compact.turns import Solution, Turns

ROUNDS = 120
"""How often conditions are added before the program is given up."""

MOST_ROWS = 400
"""How many conditions of one kind are added in one round: those that are broken most."""

AMPLITUDE = 0.03
"""The least by which x changes between two turns, as a part of an even share of their side."""

BROKEN = 1e-9
"""By how much a condition has to be broken to count, as a part of the shape's size."""

NOTHING = 1e-7
"""How much of the outline may be left out and counts as nothing, as a part of the shape's size."""

ENOUGH = 1e-6
"""By how much the clearance may fall short of the one asked for."""


@dataclass(frozen=True, eq=False)
class Wishes:
    """What a solution should come near to.

    ``along`` ``(n,)`` mm: where along their sides turns should be, NaN for no wish; ``weight`` ``(n,)``: how much each
    wish counts; ``clearance``: up to this much clearance is worth something, too, None for no more than is required.
    """

    along: Floats
    weight: Floats
    clearance: float | None = None


class Program:
    """The linear program of some turns around an outline.

    Its columns are the images of the n turns, then how much of the outline is left out after each of them, then the
    clearance, then one deviation for each wish. These matrices have the first 2 n columns only: ``stretch``
    ``(n, 2 n)`` gives how far it is along the side from each turn to the next; ``amplitude`` the same without what is
    left out; ``walked`` how far along its side each turn is; and ``sides`` ``(s, 2 n)`` the lengths of the sides.
    """

    def __init__(self, outline: Outline, turns: Turns) -> None:
        self.outline, self.turns = outline, turns
        count = self.count = len(turns)
        row = np.arange(count)
        up = np.where(turns.crest, 1.0, -1.0)
        self.stretch = np.zeros((count, 2 * count))
        self.stretch[row, row] = up
        self.stretch[row, (row + 1) % count] = -up
        self.amplitude = self.stretch.copy()
        self.stretch[row, count + row] = 1.0
        self.walked = np.zeros((count, 2 * count))
        first = int(np.flatnonzero(turns.corner)[0])
        for n in range(1, count):
            k = (first + n) % count
            if not turns.corner[k]:
                self.walked[k] = self.walked[k - 1] + self.stretch[k - 1]
        self.sides = np.zeros((len(outline.loop), 2 * count))
        np.add.at(self.sides, turns.side, self.stretch)
        self.per_side = np.bincount(turns.side, minlength=len(outline.loop))
        self.least_amplitude = AMPLITUDE * (outline.length / self.per_side)[turns.side]
        self.levels = turns.levels(outline)

    def evenly(self) -> Floats:
        """Return how far along their sides the turns are if they are spread evenly, ``(n,)`` mm."""
        turns = self.turns
        first = int(np.flatnonzero(turns.corner)[0])
        along = np.zeros(self.count)
        number = 0
        for n in range(self.count):
            k = (first + n) % self.count
            number = 0 if turns.corner[k] else number + 1
            s = turns.side[k]
            along[k] = self.outline.length[s] * number / self.per_side[s]
        return along

    def solve(
        self,
        along: Floats,
        *,
        clearance: float,
        wishes: Wishes | None = None,
        steps: int = 3,
        whole: bool = False,
    ) -> Solution | None:
        """Return the images that leave out least of the outline, and then come nearest to the wishes.

        ``along`` ``(n,)`` mm: where along their sides the turns are to begin with. ``clearance``: the path of each
        pair in the tree has to be shorter than its distance on the sheet by this part of it. ``steps``: how often
        the tangents to distances are computed anew. ``whole``: leave nothing out. Returns None if there is no solution.
        """
        found: Solution | None = None
        for _ in range(steps):
            x = self._minimise(along, clearance, wishes, whole)
            if x is None:
                return None
            found = self._solution(x, clearance)
            if self.true_clearance(found) >= clearance - ENOUGH:
                return found
            along = found.along
        return None if whole else found

    def _solution(self, x: Floats, clearance: float) -> Solution:
        count = self.count
        both = x[: 2 * count].copy()
        small = both[count:] < NOTHING * self.outline.size
        both[count:][small] = 0.0
        if small.all():
            # the solver leaves 1e-9 in the equations: project onto them, so that ties stay ties
            rows = self.sides[:, :count]
            missing = rows @ both[:count] - self.outline.length
            fixed = np.zeros(count)
            fixed[0] = 1.0
            rows = np.vstack([rows, fixed])
            both[:count] -= np.linalg.lstsq(rows, np.append(missing, both[0]), rcond=None)[0]
        along = self.walked @ both
        return Solution(self.turns, both[:count], along, both[count:], clearance)

    def true_clearance(self, solution: Solution) -> float:
        """Return the least clearance of all pairs of turns that see each other, from their true distances."""
        pairs = visible_pairs(self.outline, self.turns, solution.along)
        _, path = tree_paths(solution.x, pairs, self.levels)
        return float(np.min(1 - path / pairs.distance, initial=math.inf))

    def _all_pairs(self, along: Floats) -> list[Pairs]:
        now = visible_pairs(self.outline, self.turns, along)
        return [now, *(later_pairs(self.outline, self.turns, along) if self.turns.careful else [])]

    def _minimise(self, along: Floats, clearance: float, wishes: Wishes | None, whole: bool) -> Floats | None:
        """Minimise under all conditions, with distances from their tangents where turns are ``along`` their sides."""
        count, outline = self.count, self.outline
        wished = np.flatnonzero(~np.isnan(wishes.along)) if wishes is not None else np.zeros(0, dtype=np.int64)
        width = 2 * count + 1 + len(wished)
        left_out, clear, deviations = slice(count, 2 * count), 2 * count, slice(2 * count + 1, None)
        cost = np.zeros(width)
        low, up = np.zeros(width), np.full(width, np.inf)
        up[0] = 0.0  # the root is at x = 0
        low[clear] = up[clear] = clearance
        cost[left_out] = 1.0
        if whole:
            up[left_out] = 0.0
        if wishes is not None:
            up[clear] = max(clearance, wishes.clearance or 0.0)
            cost[deviations] = wishes.weight[wished]
            cost[clear] = -outline.size
        solver = Solver(cost, low, up)
        solver.add(_widened(self.sides, width), outline.length, outline.length)
        solver.add(_widened(self.amplitude, width), self.least_amplitude, np.full(count, np.inf))
        solver.add(*self._falling(width))
        if wishes is not None and len(wished):
            rows = _widened(self.walked[wished], width)
            deviation = np.zeros_like(rows)
            deviation[np.arange(len(wished)), 2 * count + 1 + np.arange(len(wished))] = 1.0
            wish = wishes.along[wished]
            solver.add(rows - deviation, np.full(len(wished), -np.inf), wish)
            solver.add(rows + deviation, wish, np.full(len(wished), np.inf))
        every = self._all_pairs(along)
        for _ in range(ROUNDS):
            x = solver.run()
            if x is None:
                return None
            broken = [self._rows(x, along, pairs, width) for pairs in every]
            if not any(len(bound) for _, bound in broken):
                return x
            for row, bound in broken:
                solver.add(row, np.full(len(bound), -np.inf), bound)
        return None

    def _rows(
        self, x: Floats, along: Floats, pairs: Pairs, width: int, *, everything: bool = False
    ) -> tuple[Floats, Floats]:
        """The conditions that ``x`` breaks, or all, as rows and upper bounds, with tangents at ``along``."""
        count, direction = self.count, self.outline.direction[self.turns.side]
        level_inside, level_outside = self.levels
        clear = 2 * count
        clearance = x[clear]
        if pairs.shift is not None:
            clearance = 0.0
            at, path = tree_paths(x[:count] + pairs.shift, pairs, self.levels)
        else:
            at, path = tree_paths(x[:count], pairs, self.levels)
        now = self.walked @ x[: 2 * count] - along
        toward_i = (pairs.direction * direction[pairs.i]).sum(axis=1)
        toward_j = (pairs.direction * direction[pairs.j]).sum(axis=1)
        moved = toward_i * now[pairs.i] - toward_j * now[pairs.j]
        excess = path - pairs.distance * (1 - clearance) - moved
        if pairs.still is not None:
            own = (at == pairs.i) | (at == pairs.j)
            excess = np.where(pairs.still[at] & own, excess, -np.inf)
        broken = np.flatnonzero(np.isfinite(excess) if everything else excess > BROKEN * self.outline.size)
        if len(broken) > MOST_ROWS and not everything:
            broken = broken[np.argsort(-excess[broken], kind="stable")[:MOST_ROWS]]
        i, j, at = pairs.i[broken], pairs.j[broken], at[broken]
        sign = np.where(pairs.turned[broken], -1.0, 1.0)
        rows = np.zeros((len(broken), width))
        n = np.arange(len(broken))
        np.add.at(rows, (n, i), sign)
        np.add.at(rows, (n, j), sign)
        np.add.at(rows, (n, at), -2 * sign)
        slope_i, slope_j = toward_i[broken], toward_j[broken]
        rows[:, : 2 * count] -= slope_i[:, None] * self.walked[i] - slope_j[:, None] * self.walked[j]
        bound = pairs.distance[broken] - slope_i * along[i] + slope_j * along[j]
        if pairs.shift is None:
            rows[:, clear] = pairs.distance[broken]
            bound += 2 * sign * np.where(pairs.turned[broken], level_outside[at], level_inside[at])
        else:
            bound -= sign * (pairs.shift[i] + pairs.shift[j] - 2 * pairs.shift[at])
        return rows, bound

    def conditions(self, solution: Solution, clearance: float) -> tuple[Floats, Floats]:
        """Return all conditions on small changes of a solution, as rows ``(m, 2 n)`` and upper bounds ``(m,)``.

        They hold to first order. Where the solution itself breaks a condition, the change may not make that worse.
        """
        along = solution.along
        x = np.concatenate([solution.x, solution.left_out, [clearance]])
        all_rows, all_bounds = [], []
        for pairs in self._all_pairs(along):
            rows, bounds = self._rows(x, along, pairs, len(x), everything=True)
            all_rows.append(rows[:, :-1])
            all_bounds.append(np.maximum(bounds - rows @ x, 0.0))
        falling, least, _ = self._falling(2 * self.count)
        all_rows += [-falling, -self.amplitude]
        all_bounds.append(np.maximum(falling @ x[:-1] - least, 0.0))
        all_bounds.append(np.maximum(self.amplitude @ x[:-1] - self.least_amplitude, 0.0))
        return np.vstack(all_rows), np.concatenate(all_bounds)

    def _falling(self, width: int) -> tuple[Floats, Floats, Floats]:
        """Rows and bounds: no reflex corner that is a dip may fall below the root, unless the root falls as well."""
        turns = self.turns
        falling = turns.corner & ~turns.crest & self.outline.reflex[turns.side]
        some = np.flatnonzero(falling[1:]) + 1
        rows = np.zeros((len(some), width))
        rows[np.arange(len(some)), some] = 1.0
        rows[:, 0] = -1.0
        least = np.zeros(len(some)) if falling[0] else self.outline.falls[turns.side[some]]
        return rows, least, np.full(len(some), np.inf)


def _widened(rows: Floats, width: int) -> Floats:
    return np.pad(rows, ((0, 0), (0, width - rows.shape[1])))


class Solver:
    """The solver HiGHS, to which rows are added as they are needed; each run starts from the result of the last.

    It minimises the sum of ``cost`` times the unknowns, ``(n,)``, which are between ``low`` and ``up``.
    """

    def __init__(self, cost: Floats, low: Floats, up: Floats) -> None:
        import highspy  # here, so that patterns that need no search do not load it

        self.optimal: Any = highspy.HighsModelStatus.kOptimal
        self.highs: Any = highspy.Highs()  # type: ignore[no-untyped-call]
        self.highs.setOptionValue("output_flag", False)
        self.highs.setOptionValue("threads", 1)
        none = np.zeros(0, dtype=np.int32)
        self.highs.addCols(len(cost), cost, low, up, 0, none, none, np.zeros(0))

    def add(self, rows: Floats, low: Floats, up: Floats) -> None:
        """Require that ``rows`` ``(m, n)`` times the unknowns are between ``low`` and ``up``, ``(m,)`` each."""
        if not len(rows):
            return
        at, columns = np.nonzero(rows)
        starts = np.searchsorted(at, np.arange(len(rows))).astype(np.int32)
        self.highs.addRows(len(rows), low, up, len(at), starts, columns.astype(np.int32), rows[at, columns])

    def run(self) -> Floats | None:
        """Return the best unknowns, ``(n,)``, or None when nothing satisfies all rows."""
        self.highs.run()
        if self.highs.getModelStatus() != self.optimal:
            return None
        return np.asarray(self.highs.getSolution().col_value)
