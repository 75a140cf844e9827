"""Short creases are gaps between events that nearly coincide: move the turns until they do, or are far apart.

``Solution`` -> solutions near it, with fewer and longer creases.

The length of a crease is a smooth function of the images of the turns as long as the events keep their order; its
derivatives come from ``sensitivity``. There are three kinds of steps.

- *Vanish*: Newton's method on the lengths of the shortest creases finds images for which they are zero. On the way the
  order of events may change; then other creases are short in the same places, and the next step takes these.
- *Lengthen*: a linear program makes the shortest crease as long as possible, within a region in which the derivatives
  can be trusted. Creases that have vanished stay so, to first order.
- *Across*: where the shortest crease gets no longer, it is sent through zero. That changes the order of two events, and
  the next steps go on from there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from copy import copy
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from foldcut.core.arrays import Bools, Floats, Numbers
from foldcut.core.model import CreasePattern
from foldcut.methods.compact.linear_program import Program, Solver
from foldcut.methods.compact.outline import Outline
from foldcut.methods.compact.pattern import Molecules
from foldcut.methods.compact.sensitivity import vertex_slopes
from foldcut.methods.compact.turns import Solution

CLEARANCE = 0.003
"""The clearance, see ``Program.solve``, that pairs of turns keep."""

NEWTON_STEPS = 4
"""How many steps a crease may take to vanish."""

TRUST = 0.05
"""How far images may move in the first step, as a part of the shape's size."""

LEAST_TRUST = 1e-4
"""A step that does not fold is made smaller, until images move no more than by this part of the shape's size."""

LEAP = 0.1
"""How far images may move for a crease to vanish, as a part of the shape's size."""

SHORT = 1.1
"""Creases up to this many times as long as the shortest are sent through zero."""

MOST_CROSSINGS = 8
"""How many creases, or groups of them, are sent through zero at most."""

SAME_LEVEL = 1e-7
"""Turns whose images differ by less than this part of the shape's size are on one level."""


@dataclass(frozen=True, eq=False)
class _Lengths:
    """The creases of a pattern: the numbers of their ends, ``(m, 2)``, and their lengths, ``(m,)`` mm."""

    edges: Numbers
    length: Floats

    @classmethod
    def of(cls, creases: CreasePattern, some: Bools) -> _Lengths:
        edges = creases.edges_vertices[some]
        ends = creases.vertices_coords[edges]
        return cls(edges, np.hypot(*(ends[:, 1] - ends[:, 0]).T))

    @property
    def order(self) -> Numbers:
        """The creases, shortest first."""
        return np.argsort(self.length, kind="stable")


class Mover:
    """Moves the turns of a solution so that its short creases get longer, or vanish.

    ``solution``: where the turns are now. ``fold`` returns the molecules and the creases of a solution, or None if it
    does not fold; ``creased`` tells which edges of a pattern count as creases. Turns move along the columns of
    ``basis``, ``(n, m)``: those are all changes of their images for which sides keep their lengths and turns on one
    level stay on one level.
    """

    def __init__(
        self,
        outline: Outline,
        solution: Solution,
        fold: Callable[[Solution], tuple[Molecules, CreasePattern] | None],
        creased: Callable[[CreasePattern], Bools],
    ) -> None:
        self.solution, self._fold, self._creased = solution, fold, creased
        self.program = Program(outline, solution.turns)
        count = len(solution.turns)
        rows = [self.program.sides[:, :count], np.eye(1, count), _levels(outline, solution)]
        self.basis = null_space(np.vstack(rows))
        self._kept = np.zeros((0, self.basis.shape[1]))
        self._trust = TRUST * outline.size
        self._folded = fold(solution)

    def lengthen(self, target: float) -> bool:
        """Make the shortest crease as long as possible, up to ``target`` mm; return whether anything has moved."""
        if self._folded is None or not self.basis.shape[1]:
            return False
        now = self._now(self._folded[1])
        slopes = self._slopes(now, np.arange(len(now.length)))
        while self._trust > LEAST_TRUST * self.program.outline.size:
            found = self._longest(now, slopes, target)
            if found is not None and self._go(found[1]):
                return True
            self._trust /= 4
        return False

    def lengths(self) -> Floats:
        """Return the lengths of the creases in mm, shortest first; none if the solution does not fold."""
        return np.zeros(0) if self._folded is None else np.sort(self._now(self._folded[1]).length)

    def _now(self, creases: CreasePattern) -> _Lengths:
        return _Lengths.of(creases, self._creased(creases))

    def without(self, number: int, limit: float) -> Mover | None:
        """Return a mover for which the crease at place ``number`` in the order of length has vanished, or None.

        Creases shorter than ``limit`` mm vanish as well: they may have vanished before, and have come back on the way.
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
        """Take a step that makes crease ``number`` and all shorter than ``limit`` vanish; return whether it folds."""
        if self._folded is None or not self.basis.shape[1]:
            return False
        now = self._now(self._folded[1])
        order = now.order
        gone = order[now.length[order] < limit]
        if number is not None:
            gone = np.union1d(gone, order[number : number + 1])
        slopes = self._slopes(now, gone)
        rows = np.vstack([slopes, self._kept])
        move = np.linalg.lstsq(rows, np.append(-now.length[gone], np.zeros(len(self._kept))), rcond=1e-4)[0]
        if np.abs(move).max() > LEAP * self.program.outline.size or not self._go(move):
            return False
        self._kept = np.vstack([self._kept, slopes])
        return True

    def _go(self, move: Floats) -> bool:
        """Move along the basis, if the pattern still folds then; return whether it does."""
        other = self.moved(self.basis @ move)
        folded = self._fold(other)
        if folded is None:
            return False
        self.solution, self._folded = other, folded
        return True

    def moved(self, by: Floats) -> Solution:
        """Return the solution with its images changed ``by`` ``(n,)`` mm."""
        x = self.solution.x + by
        return replace(self.solution, x=x, along=self.program.walked[:, : len(x)] @ x)

    def _slopes(self, now: _Lengths, some: Numbers) -> Floats:
        """The derivatives of some lengths along the columns of the basis, ``(k, m)``."""
        assert self._folded is not None
        molecules, creases = self._folded
        count = len(self.solution.x)
        along = self.program.walked[:, :count] @ self.basis
        direction = self.program.outline.direction[self.solution.turns.side]
        slopes = vertex_slopes(molecules, direction[:, :, None] * along[:, None], self.basis)
        # the last row is for the sheet's corners, which stay where they are
        slopes = np.concatenate([slopes, np.zeros_like(slopes[:1])])
        number = {place: vertex for vertex, place in enumerate(molecules.vertices.flat)}
        place = creases.vertices_coords
        vertex = np.array([number.get((x, y), -1) for x, y in place.tolist()])
        start, end = now.edges[some].T
        unit = (place[end] - place[start]) / now.length[some, None]
        changes: Floats = np.einsum("ij,ijm->im", unit, slopes[vertex[end]] - slopes[vertex[start]])
        return changes

    def across(self, target: float) -> Iterator[Mover]:
        """Yield movers for which the shortest creases have gone through zero: some events have changed their order.

        Those come first for which the shortest crease promises to become longest.
        """
        if self._folded is None or not self.basis.shape[1]:
            return
        now = self._now(self._folded[1])
        slopes = self._slopes(now, np.arange(len(now.length)))
        mover = copy(self)
        mover._trust = TRUST * self.program.outline.size
        # creases that vanish together are between the same two events
        order = now.order
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
        """Return how long the shortest crease can become, at most ``target`` mm, and the step for that, or None.

        The step is one that can be trusted, found by a linear program. ``crossed``: creases that go through zero.
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
            # what has vanished stays so, as far as these rows do not contradict each other
            _, size, rows = np.linalg.svd(self._kept, full_matrices=False)
            rows = rows[size > 1e-6 * size[0]]
            solver.add(wide(rows, 0.0), np.zeros(len(rows)), np.zeros(len(rows)))
        rows, bounds = self.program.conditions(self.solution, CLEARANCE)
        solver.add(wide(rows[:, : len(self.basis)] @ self.basis, 0.0), np.full(len(rows), -np.inf), bounds)
        found = solver.run()
        return None if found is None else (float(found[width]), found[:width])


def null_space(matrix: Floats) -> Floats:
    """Return orthonormal columns that span what ``matrix`` takes to zero, as ``scipy.linalg.null_space`` does."""
    _, singular, right = np.linalg.svd(matrix)
    rank = int((singular > np.finfo(np.float64).eps * max(matrix.shape) * singular.max(initial=0.0)).sum())
    basis: Floats = right[rank:].T
    return basis


def _levels(outline: Outline, solution: Solution) -> Floats:
    """Rows that keep dips on one level if they are on one now, and crests: they form one hub of the tree."""
    rows = []
    for kind in (solution.turns.crest, ~solution.turns.crest):
        some = np.flatnonzero(kind)
        some = some[np.argsort(solution.x[some], kind="stable")]
        for a, b in pairwise(some.tolist()):
            if solution.x[b] - solution.x[a] < SAME_LEVEL * outline.size:
                row = np.zeros(len(solution.x))
                row[a], row[b] = -1.0, 1.0
                rows.append(row)
    return np.array(rows).reshape(len(rows), len(solution.x))
