"""Solutions that cover the whole outline of a shape, by linear programs.

``Plan`` -> ``Solution`` with nothing left out. Turns are added where something is left out until nothing is; turns
that turn out not to be needed are removed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.methods.compact.budget import Budget, program_cost
from foldcut.methods.compact.linear_program import ENOUGH, Program, Wishes
from foldcut.methods.compact.outline import Outline
from foldcut.methods.compact.plans import Plan
from foldcut.methods.compact.turns import Solution, Turns

CLEARANCES = (0.02, 0.008, 0.03, 0.004, 0.05)
"""Clearances, see ``Program.solve``, in the order in which they are tried."""

ROUNDS = 60
"""How often turns are added before a plan is given up."""

RANKING = 0.1
"""The part of the budget that may be spent on ranking plans, once one has a solution."""

THINNING = 0.1
"""The part of the budget that may be spent on removing turns of one solution."""


class Cover:
    """Finds solutions for an outline.

    ``charge`` is told the cost of each linear program before it is solved, and may raise ``Spent``.
    """

    def __init__(self, outline: Outline, budget: Budget, charge: Callable[[float], None]) -> None:
        self.outline, self.budget, self.charge = outline, budget, charge

    def solve(
        self,
        program: Program,
        along: Floats,
        *,
        clearance: float,
        wishes: Wishes | None = None,
        steps: int = 3,
        whole: bool = False,
    ) -> Solution | None:
        """Solve a program, see ``Program.solve``, and charge for it."""
        self.charge(program_cost(len(program.turns)))
        return program.solve(along, clearance=clearance, wishes=wishes, steps=steps, whole=whole)

    def ranked(self, plans: Iterable[Plan]) -> list[Plan]:
        """Return plans in the order of how little of the outline they leave out before turns are added."""
        ranked: list[tuple[float, int, Plan]] = []
        start = self.budget.part
        for plan in plans:
            program = Program(self.outline, plan.turns())
            solution = self.solve(program, program.evenly(), clearance=CLEARANCES[0])
            if solution is not None:
                left = solution.left_out
                missing = float(left.sum()) / self.outline.size + 0.1 * int((left > 0).sum())
                ranked.append((missing + 0.02 * len(program.turns), len(ranked), plan))
            if self.budget.part > start + RANKING and ranked:
                break
        ranked.sort(key=lambda item: item[:2])
        return [plan for _, _, plan in ranked]

    def whole(self, plan: Plan, most: int) -> Solution | None:
        """Return a solution that leaves nothing out, or None; no turns are added to ``most`` or more."""
        clearance = CLEARANCES[0]
        program = Program(self.outline, plan.turns())
        along = program.evenly()
        for _ in range(ROUNDS):
            solution = self.solve(program, along, clearance=clearance)
            if solution is None:
                return None
            if not solution.left_out.any():
                return self._cleared(program, solution, clearance)
            if len(program.turns) >= most:
                return None
            turns, along = with_more_turns(self.outline, program.turns, solution)
            program = Program(self.outline, turns)
        return None

    def _cleared(self, program: Program, solution: Solution, clearance: float) -> Solution | None:
        """Return a solution that really has the clearance, or most of it, if there is one near ``solution``."""
        if program.true_clearance(solution) >= clearance - ENOUGH:
            return solution
        better = self.solve(program, solution.along, clearance=clearance, steps=8)
        if better is None or better.left_out.any() or program.true_clearance(better) <= 0.3 * clearance:
            return None
        return better

    def thinned(self, solution: Solution) -> Solution:
        """Remove turns on sides, two at a time, that the solution can do without."""
        at = 1
        most = self.budget.part + THINNING
        while at < len(solution.turns) - 1 and self.budget.part < most:
            turns = solution.turns
            if turns.corner[at] or turns.corner[at + 1]:
                at += 1
                continue
            program = Program(self.outline, turns.removed(at))
            along = np.delete(solution.along, [at, at + 1])
            fewer = self.solve(program, along, clearance=CLEARANCES[0], whole=True)
            if fewer is None:
                at += 1
            else:
                solution = fewer
        return solution


def under_nodes(outline: Outline, turns: Turns, random: np.random.Generator | None = None) -> Wishes:
    """Return the wish, for each turn that is alone on its side, to be under a node of the straight skeleton.

    That is where events coincide. The lowest node is chosen, if there is one inside, and all weights are 1; given
    ``random``, nodes and weights are chosen at random.
    """
    along = np.full(len(turns), np.nan)
    per_side = np.bincount(turns.side, minlength=len(outline.loop))
    for k in np.flatnonzero(~turns.corner & (per_side[turns.side] == 2)).tolist():
        nodes = outline.nodes[int(turns.side[k])]
        if nodes:
            along[k] = nodes[0 if random is None else int(random.integers(len(nodes)))].along
    weight = np.ones(len(turns)) if random is None else random.uniform(0.1, 1.9, len(turns)) ** 2
    return Wishes(along, weight)


def with_more_turns(outline: Outline, turns: Turns, solution: Solution) -> tuple[Turns, Floats]:
    """Add turns, two at a time, to the stretches that leave most out; also return where to begin, ``(n,)`` mm.

    A stretch is what lies between a turn and the next. It gets more turns the narrower the shape is there.
    """
    count = len(turns)
    left = solution.left_out.copy()
    # what is left out before and after a turn on a side is one piece
    for k in range(count):
        if not turns.corner[k] and k and left[k - 1] > 0 and left[k] > 0:
            left[k - 1] += left[k]
            left[k] = 0.0
    along = solution.along
    for k in np.flatnonzero(left > 0.35 * left.max())[::-1].tolist():
        reach = abs(float(solution.x[k] - solution.x[(k + 1) % count]))
        begin = along[k] + (reach if turns.crest[k] else 0.0)
        side = int(turns.side[k])
        middle = outline.loop[side] + outline.direction[side] * (begin + left[k] / 2)
        more = int(np.clip(left[k] / (2.2 * outline.width_at(middle, side)), 1, 8))
        for number in reversed(range(more)):
            turns = turns.inserted(k)
            at = begin + left[k] * (number + 0.5) / more
            along = np.insert(along, k + 1, [at - 0.2 * left[k] / more, at])
    return turns, along
