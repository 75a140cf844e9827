"""Short creases are gaps between events that nearly fall together: move the turns until they do, or are far apart.

Solution -> solutions near it, with fewer and longer creases.

The length of a crease is a smooth function of the images of the turns as long as the events keep their order; its
derivatives come from ``slopes``. Newton's method on the lengths of the shortest creases finds images for which they
vanish; on the way the order may change, then others are short in the same places, and the next step takes these. What
has vanished is kept so, to first order, while the shortest of the others is made as long as it can be, by a linear
program for each step. Where it gets no longer, a shortest crease is sent through zero, which changes the order of two
events, and the next steps go on from there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from copy import copy
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from foldcut.core.arrays import Bools, Floats, Numbers
from foldcut.core.model import CreasePattern
from foldcut.methods.compact.pattern import Molecules
from foldcut.methods.compact.sensitivity import vertex_slopes
from foldcut.methods.compact.turns import Outline, Program, Solution, Solver

CLEARANCE = 0.003
"""The clearance, relative to distances, that is left to turns that see each other."""

NEWTON_STEPS = 4

TRUST = 0.05
"""How far images may move in one step, as a part of the shape's size."""

SHORT, MOST_CROSSINGS = 1.1, 8
"""Creases up to this many times as long as the shortest are made to go through zero, so many at most."""


@dataclass(frozen=True, eq=False)
class _Lengths:
    """The creases of a pattern, for comparison with those of another, and their lengths in mm."""

    edges: Numbers
    length: Floats

    @classmethod
    def of(cls, creases: CreasePattern, some: Bools) -> _Lengths:
        edges = creases.edges_vertices[some]
        ends = creases.vertices_coords[edges]
        return cls(edges, np.hypot(*(ends[:, 1] - ends[:, 0]).T))


class Mover:
    """Moves the turns of a solution so that its creases get longer, or so that short ones vanish.

    ``fold`` returns the molecules and the creases of a solution, or None; ``creased`` which edges count as creases;
    ``careful`` as for ``Program``; ``solution``: where it is now.
    """

    def __init__(
        self,
        outline: Outline,
        solution: Solution,
        fold: Callable[[Solution], tuple[Molecules, CreasePattern] | None],
        creased: Callable[[CreasePattern], Bools],
        *,
        careful: bool,
    ) -> None:
        self.solution, self._fold, self._creased = solution, fold, creased
        self._program = Program(outline, solution.turns, careful=careful)
        count = len(solution.turns)
        rows = [self._program.ends[:, :count], np.eye(1, count), _levels(outline, solution)]
        self._basis = _null_space(np.vstack(rows))
        self._kept = np.zeros((0, self._basis.shape[1]))
        self._trust = TRUST * outline.size
        self._folded = fold(solution)

    def lengthen(self, target: float) -> bool:
        """Make the shortest crease as long as possible, or ``target`` mm; return whether anything has moved."""
        if self._folded is None or not self._basis.shape[1]:
            return False
        now = self._now(self._folded[1])
        slopes = self._slopes(now, np.arange(len(now.length)))
        while self._trust > 1e-4 * self._program.outline.size:
            found = self._longest(now, slopes, target)
            if found is not None and self._go(found[1]):
                return True
            self._trust /= 4
        return False

    def lengths(self) -> Floats:
        """The lengths of the creases in mm, shortest first."""
        return np.zeros(0) if self._folded is None else np.sort(self._now(self._folded[1]).length)

    def _now(self, creases: CreasePattern) -> _Lengths:
        return _Lengths.of(creases, self._creased(creases))

    def without(self, number: int, limit: float) -> Mover | None:
        """Return a mover for which the crease that is so manyth in length has vanished, or None.

        Creases shorter than ``limit`` mm, which had vanished and come back on the way, vanish, too.
        """
        mover = copy(self)
        if not mover._vanish(limit, number):
            return None
        for _ in range(NEWTON_STEPS):
            lengths = mover.lengths()
            if lengths[0] >= limit:
                return mover
            if not mover._vanish(limit):
                return None
        return None

    def _vanish(self, limit: float, number: int | None = None) -> bool:
        """Take a step for which creases shorter than ``limit`` vanish, and one more; return whether it was taken."""
        if self._folded is None or not self._basis.shape[1]:
            return False
        now = self._now(self._folded[1])
        order = np.argsort(now.length, kind="stable")
        gone = order[now.length[order] < limit]
        if number is not None:
            gone = np.union1d(gone, order[number : number + 1])
        slopes = self._slopes(now, gone)
        rows = np.vstack([slopes, self._kept])
        move = np.linalg.lstsq(rows, np.append(-now.length[gone], np.zeros(len(self._kept))), rcond=1e-4)[0]
        if np.abs(move).max() > 0.1 * self._program.outline.size or not self._go(move):
            return False
        self._kept = np.vstack([self._kept, slopes])
        return True

    def _go(self, move: Floats) -> bool:
        other = self._moved(self._basis @ move)
        folded = self._fold(other)
        if folded is None:
            return False
        self.solution, self._folded = other, folded
        return True

    def _moved(self, by: Floats) -> Solution:
        """The solution with other images."""
        x = self.solution.x + by
        return replace(self.solution, x=x, along=self._program.walked[:, : len(x)] @ x)

    def _slopes(self, now: _Lengths, some: Numbers) -> Floats:
        """The derivatives of lengths by the directions of the basis."""
        assert self._folded is not None
        molecules, creases = self._folded
        count = len(self.solution.x)
        along = self._program.walked[:, :count] @ self._basis
        direction = self._program.outline.direction[self.solution.turns.side]
        slopes = vertex_slopes(molecules, direction[:, :, None] * along[:, None], self._basis)
        slopes = np.concatenate([slopes, np.zeros_like(slopes[:1])])  # the last is for the sheet's corners
        number = {place: vertex for vertex, place in enumerate(molecules.vertices.flat)}
        place = creases.vertices_coords
        vertex = np.array([number.get((x, y), -1) for x, y in place.tolist()])
        start, end = now.edges[some].T
        unit = (place[end] - place[start]) / now.length[some, None]
        changes: Floats = np.einsum("ij,ijm->im", unit, slopes[vertex[end]] - slopes[vertex[start]])
        return changes

    def across(self, target: float) -> Iterator[Mover]:
        """Yield movers for which shortest creases have gone through zero: some events have changed their order.

        Those first for which the shortest crease promises to become longest.
        """
        if self._folded is None or not self._basis.shape[1]:
            return
        now = self._now(self._folded[1])
        slopes = self._slopes(now, np.arange(len(now.length)))
        mover = copy(self)
        mover._trust = TRUST * self._program.outline.size
        # creases that vanish together are between the same two events
        order = np.argsort(now.length, kind="stable")
        short = order[now.length[order] < SHORT * now.length[order[0]]]
        rates = slopes[short] / now.length[short, None]
        left = np.ones(len(short), dtype=bool)
        found: list[tuple[float, int, Floats]] = []
        while left.any() and len(found) < MOST_CROSSINGS:
            first = int(np.flatnonzero(left)[0])
            together = np.abs(rates - rates[first]).max(axis=1) < 1e-3 * np.abs(rates[first]).max()
            together[first] = True
            left &= ~together
            step = mover._longest(now, slopes, target, short[together])
            if step is not None:
                found.append((-step[0], len(found), step[1]))
        for _, _, move in sorted(found, key=lambda item: item[:2]):
            other = copy(mover)
            if other._go(move):
                yield other

    def _longest(
        self, now: _Lengths, slopes: Floats, target: float, crossed: Numbers | None = None
    ) -> tuple[float, Floats] | None:
        """Return how long the shortest crease can be, and the step within reach for that, by a linear program.

        ``crossed``: creases that go through zero.
        """
        width, trust = slopes.shape[1], self._trust
        cost = np.zeros(width + 1)
        cost[width] = -1.0
        low, up = np.full(width + 1, -trust), np.full(width + 1, trust)
        low[width], up[width] = -np.inf, target
        solver = Solver(cost, low, up)

        def wide(rows: Floats, last: float) -> Floats:
            return np.pad(rows, ((0, 0), (0, 1)), constant_values=last)

        way = np.ones(len(now.length))
        if crossed is not None:
            way[crossed] = -1.0
        near = np.flatnonzero(now.length < target + 2 * trust)
        rows, lengths = way[near, None] * slopes[near], way[near] * now.length[near]
        solver.add(wide(rows, -1.0), -lengths, np.full(len(near), np.inf))
        if len(self._kept):
            # what has vanished stays so, as far as these agree with each other
            _, size, rows = np.linalg.svd(self._kept, full_matrices=False)
            rows = rows[size > 1e-6 * size[0]]
            solver.add(wide(rows, 0.0), np.zeros(len(rows)), np.zeros(len(rows)))
        rows, bounds = self._program.conditions(self.solution, CLEARANCE)
        solver.add(wide(rows[:, : len(self._basis)] @ self._basis, 0.0), np.full(len(rows), -np.inf), bounds)
        found = solver.run()
        return None if found is None else (float(found[width]), found[:width])


def _null_space(matrix: Floats) -> Floats:
    """Return orthonormal columns that span what ``matrix`` takes to zero, as ``scipy.linalg.null_space`` does."""
    _, singular, right = np.linalg.svd(matrix)
    rank = int((singular > np.finfo(np.float64).eps * max(matrix.shape) * singular.max(initial=0.0)).sum())
    basis: Floats = right[rank:].T
    return basis


def _levels(outline: Outline, solution: Solution) -> Floats:
    """Rows that keep valleys on one level that are on one, and peaks: they are one hub of the tree."""
    rows = []
    for kind in (solution.turns.peak, ~solution.turns.peak):
        some = np.flatnonzero(kind)
        some = some[np.argsort(solution.x[some], kind="stable")]
        for a, b in pairwise(some.tolist()):
            if solution.x[b] - solution.x[a] < 1e-7 * outline.size:
                row = np.zeros(len(solution.x))
                row[a], row[b] = -1.0, 1.0
                rows.append(row)
    return np.array(rows).reshape(len(rows), len(solution.x))
