"""The choice of reaches: how far from the root each corner of the boundary lands, by linear programming.

Loop, added corners, wishes -> ``Chain`` (see ``compact`` and ``universal``).

With the root on one side, a chain of k corners has 2 k unknowns, reaches and depths, and one equation for each side of
the shape: what goes to and fro on it is its length. Corners i and j that see each other, inside or outside, must not be
nearer than their way along the tree, reach_i + reach_j - 2 depth, for the lowest depth between them. These conditions
are linear, and are added where a solution breaks one. Corners added on a side may lie anywhere on it; distances to
them are convex, so their tangents at the last solution are on the safe side.

Source: Lang's tree method; the tree here is planar and its leaves are the corners in order around the shape, so heights
over the root on a closed walk are all there is to it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import csr_matrix

from foldcut.compact import Chain
from foldcut.model import Bools, Floats, Ints
from foldcut.plane import cross

ROUNDS = 60
TANGENT_ROUNDS = 8
Tangent = tuple[int, int, Ints, Floats, float]  # two corners, and a row but for the depth between them
Row = tuple[Ints, Floats, float]  # columns, values, bound: sum of values times unknowns is at most the bound


@dataclass(frozen=True, eq=False)
class Layout:
    """The corners of a chain: the shape's own and those added on its sides.

    ``side`` ``(k,)``: the shape's side that a corner starts or lies on; ``place`` ``(k,)``: 0 at its start, 1, 2, ...
    for the corners added on it.
    """

    loop: Floats
    added: tuple[int, ...]
    side: Ints
    place: Ints

    @classmethod
    def build(cls, loop: Floats, added: Sequence[int]) -> Layout:
        """Lay out a loop, ``(n, 2)`` counter-clockwise, with ``added[s]`` corners on side s."""
        side = np.repeat(np.arange(len(loop)), 1 + np.asarray(added))
        place = np.concatenate([np.arange(1 + a) for a in added])
        return cls(loop, tuple(int(a) for a in added), side.astype(np.int32), place.astype(np.int32))

    def __len__(self) -> int:
        return len(self.side)


@dataclass(frozen=True, eq=False)
class Solution:
    """Reaches and depths, ``(k,)`` each, in mm, and the clearance they keep, relative to distances.

    ``valleys``: corners that are no peaks, where the depths beside them are their reach.
    """

    layout: Layout
    reach: Floats
    depth: Floats
    clearance: float
    root: int
    valleys: frozenset[int]

    def corners(self) -> Floats:
        """Where the corners are, ``(k, 2)`` mm."""
        return corner_places(self.layout, self.reach, self.depth)

    def chain(self) -> Chain:
        """The chain, turned so that the root is on the last side."""
        first = (self.root + 1) % len(self.layout)
        depth = np.where(self.depth < 1e-10 * float(np.ptp(self.layout.loop)), 0.0, self.depth)
        for valley in self.valleys:
            depth[[valley - 1, valley]] = np.inf
        return Chain(np.roll(self.corners(), -first, axis=0), np.roll(self.reach, -first), np.roll(depth, -first))


def corner_places(layout: Layout, reach: Floats, depth: Floats) -> Floats:
    """Return the corners' places, ``(k, 2)``: added corners lie as far along their side as the walk to them."""
    length = reach + np.roll(reach, -1) - 2 * depth
    walked = np.concatenate([[0.0], np.cumsum(length)[:-1]])
    starts = walked[layout.place == 0]
    along = walked - starts[layout.side]
    following = np.roll(layout.loop, -1, axis=0) - layout.loop
    direction = following / np.hypot(*following.T)[:, None]
    places: Floats = layout.loop[layout.side] + direction[layout.side] * along[:, None]
    return places


class Program:
    """The linear program of one layout with the root on one side and a second way to it on another."""

    def __init__(
        self,
        layout: Layout,
        root: int,
        second: int,
        *,
        clearance: float,
        valleys: frozenset[int] = frozenset(),
        free: bool = False,
    ) -> None:
        """``valleys``: corners that are to be valleys; ``free``: leave the conditions between corners out."""
        self.layout, self.root, self.second = layout, root, second
        self.wanted, self.valleys, self.free = clearance, valleys, free
        loop = layout.loop
        along = np.roll(loop, -1, axis=0) - loop
        self.length = np.hypot(*along.T)
        self.direction = along / self.length[:, None]
        count = len(layout)
        self.count = count
        self.size = float(np.ptp(loop, axis=0).max())
        equal = np.zeros((len(loop) + 2 + 2 * len(valleys), 2 * count))
        for corner in range(count):
            side = layout.side[corner]
            equal[side, corner] += 1
            equal[side, (corner + 1) % count] += 1
            equal[side, count + corner] -= 2
        equal[len(loop), count + root] = equal[len(loop) + 1, count + second] = 1
        for n, valley in enumerate(sorted(valleys)):
            for m, side in enumerate(((valley - 1) % count, valley)):
                equal[len(loop) + 2 + 2 * n + m, [valley, count + side]] = 1, -1
        self.equal, self.equal_to = equal, np.zeros(len(equal))
        self.equal_to[: len(loop)] = self.length
        self.on_one_side = self._on_one_side()

    def _on_one_side(self) -> Bools:
        """Pairs of corners that lie on one side of the shape, ``(k, k)``."""
        sides = [
            {int(s)} | ({int(s - 1) % len(self.layout.loop)} if p == 0 else set())
            for s, p in zip(self.layout.side, self.layout.place, strict=True)
        ]
        return np.array([[bool(a & b) for a in sides] for b in sides])

    def solve(
        self, wish: Floats | None = None, weight: Floats | None = None, start: Solution | None = None
    ) -> Solution | None:
        """Return the reaches and depths with the wanted clearance nearest to a wish, or with the most clearance.

        ``wish`` ``(k,)``: how far the foot on the side after each corner should be from it, NaN for no wish, with
        ``weight`` ``(k,)``; the sum of the weighted differences is least. Without a wish the clearance is largest, and
        may be negative; with one None is returned when the wanted clearance cannot be kept. ``start``: a solution of
        the same layout to go on from.
        """
        goal = _Goal.build(self, wish, weight)
        if self.free:
            x = goal.minimise([])
            return None if x is None else self._solution(x)
        if any(self.layout.added):
            return self._solve_by_tangents(goal, start)
        x = self._minimise_near(goal, np.zeros(2 * self.count + 1))
        return None if x is None else self._solution(x)

    def _solve_by_tangents(self, goal: _Goal, start: Solution | None) -> Solution | None:
        """Where added corners may move along their sides: from evenly divided sides, tangents at the last places."""
        if start is None:
            share = self.length / (1 + np.asarray(self.layout.added)) / 2
            x = _Goal.build(self, share[self.layout.side], None, clearance=(0.0, 0.0)).minimise([])
        else:
            x = np.concatenate([start.reach, start.depth, [start.clearance]])
        best: tuple[float, Floats] | None = None
        for _ in range(TANGENT_ROUNDS):
            if x is None:
                break
            moved = self._minimise_near(goal, x)
            if moved is None:
                break
            true_clearance = self._clearance(moved)
            value = true_clearance if goal.wishes is None else -float(goal.cost @ moved)
            if goal.wishes is not None and true_clearance < self.wanted - 1e-7:
                value = -np.inf
            improved = best is None or value > best[0] + 1e-4 * max(1e-2, abs(best[0]))
            if best is None or value > best[0]:
                best = (value, moved)
            if not improved or (goal.wishes is None and true_clearance >= self.wanted - 1e-9):
                break
            x = moved
        if best is None or not np.isfinite(best[0]):
            return None
        found = best[1]
        if goal.wishes is None:
            found = found.copy()
            found[2 * self.count] = min(self.wanted, self._clearance(found), found[2 * self.count])
        return self._solution(found)

    def without(self, start: Solution, corner: int) -> Solution | None:
        """Go on from a solution to one without an added corner: its flap is made shorter until nothing is left.

        Returns a solution of the smaller layout, or None when the flap does not vanish. The root must not be beside it.
        """
        count = self.count
        goal = _Goal.build(self, None, None, clearance=(self.wanted, self.wanted))
        goal.rows = [row for row in goal.rows if row[0][1] != corner]
        goal.rows += [
            (np.array([count + side, corner], dtype=np.int32), np.array([1.0, -1.0]), 0.0)
            for side in (corner - 1, corner)
        ]
        goal.cost = np.zeros(2 * count + 1)
        goal.cost[[corner, count + corner - 1, count + corner]] = 2.0, -1.0, -1.0
        x = np.concatenate([start.reach, start.depth, [self.wanted]])
        length = float(goal.cost @ x)
        for _ in range(TANGENT_ROUNDS):
            moved = self._minimise_near(goal, x)
            if moved is None:
                return None
            before, length, x = length, float(goal.cost @ moved), moved
            if length <= 1e-7 * self.size or length > 0.9 * before:
                break
        if length > 1e-7 * self.size:
            return None
        added = list(self.layout.added)
        added[int(self.layout.side[corner])] -= 1
        smaller = Layout.build(self.layout.loop, added)
        root, second = (side - (side >= corner) for side in (self.root, self.second))
        program = Program(smaller, root, second, clearance=self.wanted)
        reach = np.delete(x[:count], corner)
        depth = np.delete(x[count : 2 * count], corner)
        both = np.concatenate([reach, depth])
        both -= np.linalg.lstsq(program.equal, program.equal @ both - program.equal_to, rcond=None)[0]
        solution = Solution(smaller, both[: count - 1], both[count - 1 :], self.wanted, root, frozenset())
        return solution if program.keeps(solution) else None

    def keeps(self, solution: Solution) -> bool:
        """Whether a solution has the wanted clearance, but for rounding."""
        x = np.concatenate([solution.reach, solution.depth, [solution.clearance]])
        return self._clearance(x) >= self.wanted * (1 - 1e-4)

    def _solution(self, x: Floats) -> Solution:
        count = self.count
        # the solver leaves 1e-9 in the equations: project onto them, so that ties stay ties
        both = x[: 2 * count]
        both = both - np.linalg.lstsq(self.equal, self.equal @ both - self.equal_to, rcond=None)[0]
        return Solution(self.layout, both[:count], both[count:], float(x[2 * count]), self.root, self.valleys)

    def _clearance(self, x: Floats) -> float:
        """The clearance that corners that see each other really have."""
        lowest, _ = self._lowest_between(x[self.count : 2 * self.count])
        i, j, distance, _ = self._pairs(x)
        slack = distance - (x[i] + x[j] - 2 * lowest[i, j])
        return float(np.min(slack / distance, initial=np.inf))

    def _pairs(self, x: Floats) -> tuple[Ints, Ints, Floats, Ints]:
        """Corners that see each other, their distance, and the lowest foot between them."""
        depth = x[self.count : 2 * self.count]
        place = corner_places(self.layout, x[: self.count], depth)
        _, where = self._lowest_between(depth)
        i, j = (pair.astype(np.int32) for pair in np.nonzero(np.triu(~self.on_one_side, 2)))
        apart = place[i] - place[j]
        distance = np.hypot(apart[:, 0], apart[:, 1])
        seen = (distance > 1e-9 * self.size) & sees_each_other(place, i, j)
        if self.valleys:
            seen &= ~self._over_valley(place, i, j, where[i, j])
        return i[seen], j[seen], distance[seen], where[i[seen], j[seen]]

    def _over_valley(self, place: Floats, i: Ints, j: Ints, low: Ints) -> Bools:
        """Pairs that see each other outside, over a valley: there the valley rises between them, and nothing else."""
        valley = np.zeros(self.count, dtype=bool)
        valley[list(self.valleys)] = True
        after, before = np.roll(place, -1, axis=0) - place, np.roll(place, 1, axis=0) - place
        line = place[j] - place[i]
        angle = np.arctan2(cross(after[i], before[i]), (after[i] * before[i]).sum(axis=1)) % (2 * np.pi)
        turn = np.arctan2(cross(after[i], line), (after[i] * line).sum(axis=1)) % (2 * np.pi)
        over: Bools = (turn > angle) & (valley[low] | valley[(low + 1) % self.count])
        return over

    def _minimise_near(self, goal: _Goal, base: Floats) -> Floats | None:
        """Minimise with all conditions, distances by their tangents at ``base``; conditions are added as needed."""
        tangents = self._tangents(base)
        rows: list[Row] = []
        for _ in range(ROUNDS):
            x = goal.minimise(rows)
            if x is None:
                return None
            new = self._broken(tangents, x)
            if not new:
                return x
            rows += new
        return None

    def _tangents(self, base: Floats) -> list[Tangent]:
        """For corners that see each other at ``base``: their numbers, and their distance as a linear function."""
        count = self.count
        place = corner_places(self.layout, base[:count], base[count : 2 * count])
        found: list[Tangent] = []
        for a, b, distance, low in zip(*(column.tolist() for column in self._pairs(base)), strict=True):
            del low
            columns: list[int] = [a, b, 2 * count]
            values: list[float] = [1.0, 1.0, distance]
            bound = distance
            if self.layout.place[a] or self.layout.place[b]:
                direction = (place[a] - place[b]) / distance
                for corner, sign in ((a, 1.0), (b, -1.0)):
                    slope = sign * float(direction @ self.direction[self.layout.side[corner]])
                    for column, value in self._walk(corner):
                        columns.append(column)
                        values.append(-slope * value)
                        bound -= slope * value * float(base[column])
            found.append((a, b, np.array(columns, dtype=np.int32), np.array(values), bound))
        return found

    def _broken(self, tangents: list[Tangent], x: Floats) -> list[Row]:
        """The conditions that a solution breaks, as rows: with the foot that is lowest in this solution."""
        lowest, where = self._lowest_between(x[self.count : 2 * self.count])
        rows: list[Row] = []
        for a, b, columns, values, bound in tangents:
            if float(values @ x[columns]) - 2 * lowest[a, b] > bound + 1e-9 * self.size:
                low = self.count + int(where[a, b])
                rows.append((np.append(columns, low).astype(np.int32), np.append(values, -2.0), bound))
        return rows

    def _walk(self, corner: int) -> list[tuple[int, float]]:
        """How far an added corner is along its side, as coefficients of the unknowns."""
        terms = []
        for before in range(corner - int(self.layout.place[corner]), corner):
            terms += [(before, 1.0), (before + 1, 1.0), (self.count + before, -2.0)]
        return terms

    def _lowest_between(self, depth: Floats) -> tuple[Floats, Ints]:
        """The lowest depth between two corners on the way that does not pass the root, and whose it is."""
        count = self.count
        lowest = np.full((count, count), np.inf)
        where = np.zeros((count, count), dtype=np.int32)
        first = (self.root + 1) % count
        order = (first + np.arange(count)) % count
        for n in range(count - 1):
            way = depth[order[n : count - 1]]
            low = np.minimum.accumulate(way)
            at = np.maximum.accumulate(np.where(way <= low, np.arange(len(way)), 0))
            lowest[order[n], order[n + 1 :]] = lowest[order[n + 1 :], order[n]] = low
            where[order[n], order[n + 1 :]] = where[order[n + 1 :], order[n]] = order[n + at]
        return lowest, where


class _Goal:
    """What a program minimises, and the rows that it always has."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.cost: Floats = np.empty(0)
        self.wishes: Ints | None = None
        self.limits: Floats = np.empty((0, 2))
        self.rows: list[Row] = []

    @classmethod
    def build(
        cls,
        program: Program,
        wish: Floats | None,
        weight: Floats | None,
        clearance: tuple[float | None, float] | None = None,
    ) -> _Goal:
        """Unknowns: reaches, depths, the clearance, and the deviation from each wish."""
        goal, count, layout = cls(program), program.count, program.layout
        wishes = np.flatnonzero(~np.isnan(wish)).astype(np.int32) if wish is not None else np.empty(0, dtype=np.int32)
        width = 2 * count + 1 + len(wishes)
        for corner in range(count):
            side = layout.side[corner]
            room = 0.5 * float(program.length[side]) / (1 + layout.added[side])
            goal.rows += [
                (np.array([count + corner, peak, 2 * count], dtype=np.int32), np.array([1.0, -1.0, room]), 0.0)
                for peak in (corner, (corner + 1) % count)
                if peak not in program.valleys
            ]
        for n, corner in enumerate(wishes.tolist()):
            columns = np.array([corner, count + corner, 2 * count + 1 + n], dtype=np.int32)
            target = float(wish[corner]) if wish is not None else 0.0
            goal.rows.append((columns, np.array([1.0, -1.0, -1.0]), target))
            goal.rows.append((columns, np.array([-1.0, 1.0, -1.0]), -target))
        goal.cost = np.zeros(width)
        if wish is None:
            goal.cost[2 * count] = -1.0
        else:
            goal.wishes = wishes
            goal.cost[2 * count + 1 :] = 1.0 if weight is None else weight[wishes]
        if clearance is None:
            clearance = (None if wish is None else program.wanted, program.wanted)
        goal.limits = np.tile([0.0, np.inf], (width, 1))
        goal.limits[2 * count] = (-np.inf if clearance[0] is None else clearance[0], clearance[1])
        return goal

    def minimise(self, more: list[Row]) -> Floats | None:
        """Solve with more rows; None when nothing satisfies them all."""
        width, program = len(self.cost), self.program
        rows = self.rows + more
        equal = np.hstack([program.equal, np.zeros((len(program.equal), width - 2 * program.count))])
        result: Any = linprog(  # type: ignore[call-overload]  # the stubs know no sparse rows
            self.cost,
            A_ub=_matrix(rows, width),
            b_ub=np.array([bound for _, _, bound in rows]),
            A_eq=equal,
            b_eq=program.equal_to,
            bounds=np.array(
                [[-np.inf if low is None else low, np.inf if up is None else up] for low, up in self.limits]
            ),
            method="highs",
        )
        if result.status != 0:
            return None
        x: Floats = np.asarray(result.x)
        return x


def _matrix(rows: list[Row], width: int) -> csr_matrix:
    number = np.repeat(np.arange(len(rows)), [len(columns) for columns, _, _ in rows])
    columns = np.concatenate([columns for columns, _, _ in rows])
    values = np.concatenate([values for _, values, _ in rows])
    return csr_matrix((values, (number, columns)), shape=(len(rows), width))


def sees_each_other(place: Floats, i: Ints, j: Ints) -> Bools:
    """Whether the segments between corners ``i`` and ``j`` of a closed chain meet no other side of it, ``(m,)``.

    Corners in a straight row hide each other: the nearer pairs among them say enough.
    """
    count = len(place)
    start, end = place, np.roll(place, -1, axis=0)
    seen = np.ones(len(i), dtype=bool)
    side = np.arange(count)
    for n in range(0, len(i), 2048):
        a, b = i[n : n + 2048, None], j[n : n + 2048, None]
        line, along = place[b] - place[a], (end - start)[None]
        scale = 1e-12 * np.hypot(line[..., 0], line[..., 1]) * np.hypot(along[..., 0], along[..., 1])
        from_start, from_end = cross(line, start[None] - place[a]), cross(line, end[None] - place[a])
        near, far = cross(along, place[a] - start[None]), cross(along, place[b] - start[None])
        meets = (from_start * from_end <= scale**2) & (near * far <= scale**2)
        own = (side == a) | (side == b) | ((side + 1) % count == a) | ((side + 1) % count == b)
        seen[n : n + 2048] = ~(meets & ~own).any(axis=1)
    return seen
