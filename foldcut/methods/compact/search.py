"""The search for the compact pattern with the fewest creases.

A loop on the sheet -> the best verified ``Compact`` pattern.

1. Plans (``plans``) are ranked by how much of the outline their linear program leaves out; the least first.
2. ``cover``: turns are added where something is left out until nothing is.
3. The turns are moved to where events coincide: under nodes of the straight skeleton, for many choices of nodes and
   weights. Each solution is folded, counted and, if it is the best so far, verified (``trials``).
4. ``short_creases``: short creases are lengthened or made to vanish.

Where even one linear program would take too long, ``many_disks`` covers the outline without any. The number of creases
comes first; a pattern with a crease that nobody can fold is taken only if there is no other.

The search is deterministic unless a time is given: what is tried depends on the effort and the number of corners alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import partial

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.errors import UnfoldableError, UnfoldableWhereError
from foldcut.core.model import CreasePattern, FoldedState, Shape, Sheet
from foldcut.methods.compact.budget import EFFORT_SECONDS, Budget, Spent
from foldcut.methods.compact.cover import CLEARANCES, Cover, under_nodes
from foldcut.methods.compact.linear_program import Program, Wishes
from foldcut.methods.compact.many_disks import fold_many_disks
from foldcut.methods.compact.outline import Outline
from foldcut.methods.compact.pattern import Molecules, Walk
from foldcut.methods.compact.plans import Plan, neighbours, plans
from foldcut.methods.compact.short_creases import ShortCreases
from foldcut.methods.compact.trials import MANY_TURNS, Attempt, Trials
from foldcut.methods.compact.turns import Solution
from foldcut.methods.sheet_part import SheetPart
from foldcut.pattern.foldability import crease_numbers
from foldcut.pattern.ranking import FOLDABLE_MM, Goal

STALLED = 1 / 3
"""The part of the budget after which the search ends if nothing has become better, or the goal is far."""

FIRST = 1 / 5
"""The part of the budget after which it also ends if the first patterns are very far from the goal."""

FAR = 3.0
"""That is, if the best of them takes more than this many times what the one takes that is to be beaten."""

FOLLOWING = 0.3
"""The part of the budget after which, with a pattern found, no more plans are followed in their order."""

CLIMBING = 0.5
"""The part of the budget after which no more neighbours of the best plan are followed."""

VARIATIONS = 4
"""How many variations are tried between two solutions whose short creases are lengthened."""

POLISHINGS = 3
"""How many choices of wishes are tried for each new solution."""

OVERTIME = 0.3
"""The part by which the budget is extended if the best pattern has creases that are hard to fold."""

APART = 0.8
"""How often, in variations of such patterns, turns are moved at random, not under nodes."""

SPREAD = 0.15
"""How far they are moved then: the standard deviation, as a part of their side."""

BEST_FIRST = 0.4
"""How often the best candidate is the one that is varied, how often of all others the next, and so on."""

BEST_FIRST_APART = 0.2
"""The same if the best pattern has creases that are hard to fold."""

POLISHED_CLEARANCE = 0.06
"""In every other choice of wishes for a new solution, clearance up to this is worth something."""

VARIED_CLEARANCE = 0.1
"""In every other variation, clearance up to a random part of this is worth something."""

MORE_TURNS = 1.15
"""A plan is given up if it needs more turns than the best candidate by this factor, and two."""


@dataclass(frozen=True, eq=False)
class Compact:
    """What the search has found: the pattern, ``creases`` and ``folded``, its walk and its molecules.

    ``part``: the creases of the part of the sheet that was folded, see ``SheetPart``. ``tried``: the number of trials.
    """

    creases: CreasePattern
    folded: FoldedState
    part: CreasePattern
    walk: Walk
    molecules: Molecules
    tried: int
    interrupted: bool


def fold_compact(
    loop: Floats,
    sheet: Sheet,
    *,
    ribbon: float = 0.0,
    effort: str = "normal",
    seconds: float | None = None,
    progress: Callable[[str, float], None] | None = None,
    share: float = 1.0,
    part: SheetPart | None = None,
    least: float = 0.0,
    goal: Goal | None = None,
    first_folds: int = 0,
) -> Compact:
    """Return the verified pattern with the fewest creases that the search finds.

    ``loop`` ``(n, 2)`` is the outline of the shape on the sheet in mm, counter-clockwise. ``ribbon`` is a half-width in
    mm beside the cut line that has to stay free of all but straight creases. ``effort`` is one of ``EFFORT_SECONDS``;
    ``seconds`` is a time limit instead; ``share`` is the part of either that may be spent. ``progress`` is called with
    a text and the part done. ``part`` tells what part of the whole sheet ``sheet`` is, if it is not all of it: the
    whole sheet is what is verified. ``goal`` tells when there is no use in going on; ``first_folds`` are folds that
    come before those of the part. Ctrl-C ends the search with the best pattern so far.

    Raises ``UnfoldableError`` when no pattern is found, and ``CreaseTooShortError`` as soon as a walk with very many
    turns is found to have a crease shorter than ``least`` mm.
    """
    outline = Outline(loop)
    budget = Budget(share * EFFORT_SECONDS[effort], None if seconds is None else share * seconds)
    report = progress or (lambda _text, _part: None)
    trials = Trials(outline, sheet, part or SheetPart(Shape((loop,), (-1,))), ribbon=ribbon, least=least, report=report)
    random = np.random.default_rng(len(loop))
    search = Search(trials, budget, random, goal or Goal(), first_folds)
    interrupted = False
    try:
        if budget.allows_program(2 * len(loop)):
            with suppress(Spent):
                search.run()
        if trials.best is None and (goal is None or goal.beat is None):
            _fold_many_disks(trials, budget, random)
        elif trials.best is not None and seconds is None and not search.is_in_vain:
            with suppress(Spent):
                search.finish()
    except KeyboardInterrupt:
        if trials.best is None:
            raise
        interrupted = True
    best = trials.best
    if best is None:
        raise UnfoldableWhereError(
            f"no compact pattern was found in {trials.count} trials for the shape around ({{x:.1f}}, {{y:.1f}}) mm; "
            "try a higher effort, --simplify, or the paper's method",
            loop.mean(axis=0).tolist(),
        )
    return Compact(best.creases, best.folded, best.part, best.walk, best.molecules, trials.count, interrupted)


def _fold_many_disks(trials: Trials, budget: Budget, random: np.random.Generator) -> None:
    """Cover the outline with many small disks, without a limit other than the seconds."""
    if budget.seconds is not None:
        trials.deadline = budget.started + budget.seconds

    def charge(_: float) -> None:
        trials.report("searching: no pattern yet", 0.0)

    try:
        fold_many_disks(trials.outline, CLEARANCES[0], random, partial(trials.attempt, charge=charge))
    except Spent:
        raise UnfoldableError(
            f"folding {len(trials.outline.loop):,} corners takes longer than {budget.seconds or 0:.3g} s; allow more "
            "with --seconds, or leave out small corners with --simplify"
        ) from None


@dataclass(frozen=True, eq=False)
class Candidate:
    """A solution with what it costs, see ``Attempt``, and the plan that it comes from."""

    cost: float
    solution: Solution
    plan: Plan


class Search:
    """Searches for the best pattern of an outline until the budget is spent; the best is ``trials.best``.

    ``candidates``: solutions so far, the best first. All methods raise ``Spent`` when the budget is spent.
    """

    def __init__(
        self, trials: Trials, budget: Budget, random: np.random.Generator, goal: Goal, first_folds: int = 0
    ) -> None:
        self.goal, self.first_folds = goal, first_folds
        self.is_in_vain = False
        self._improved = 0.0  # the part of the budget at which the best pattern was found
        self._is_near = False  # whether that may still come to beat the one that it is to beat
        self.outline, self.trials, self.budget, self.random = trials.outline, trials, budget, random
        self.cover = Cover(self.outline, budget, self.charge)
        self.short_creases = ShortCreases(trials, budget, self.attempt, self.charge)
        self.candidates: list[Candidate] = []
        self.settled: set[Solution] = set()

    def charge(self, cost: float) -> None:
        """Count work that comes next, report the progress, and raise ``Spent`` when the budget is spent."""
        self.budget.spend(cost)
        best = self.trials.best
        count = f"{best.creases.crease_count} creases" if best else "no pattern yet"
        self.trials.report(f"searching: {count}", min(0.99, self.budget.part))
        if self.is_in_vain or self.budget.is_over(found=best is not None):
            raise Spent
        if self._is_hopeless:
            self._give_up()

    def _give_up(self) -> None:
        self.is_in_vain = True
        raise Spent

    @property
    def _is_hopeless(self) -> bool:
        """Whether nothing has become better for long, or the goal is far."""
        best, part, beat = self.trials.best, self.budget.part, self.goal.beat
        if best is not None and not best.rank.unfoldable and part - self._improved > STALLED:
            return True
        if beat is None or (self.goal.patient and best is None):
            return False
        is_far = best is not None and best.rank.creases > FAR * beat.creases and not self.goal.patient
        return (is_far and part > FIRST) or (not self._is_near and part > STALLED)

    def attempt(self, solution: Solution) -> Attempt:
        """Fold a solution, and keep the pattern if it is the best; raise ``Spent`` if it cannot be beaten."""
        before = self.trials.best
        made = self.trials.attempt(solution, self.charge)
        best = self.trials.best
        if best is not None and best is not before:
            self._improved = self.budget.part
            folds, shortest = self.first_folds + crease_numbers(best.part).lines, -best.rank.minus_shortest
            self._is_near = self.goal.is_near(folds, shortest)
            if self.goal.is_reached(folds, shortest):
                self._give_up()
        return made

    def run(self) -> None:
        """Search until the budget is spent; return earlier only if no plan has a solution."""
        plain = self.cover.ranked(plans(self.outline, turned=False))
        turned = self.cover.ranked(plans(self.outline, turned=True))
        while (plain or turned) and (self.trials.best is None or self.budget.part < FOLLOWING):
            for ranked, share in ((plain, 1), (turned, 3)):
                for _ in range(share):
                    if ranked:
                        self._follow(ranked.pop(0))
        self._climb()
        while self.candidates:
            self._settle_and_vary()

    def finish(self) -> None:
        """Extend the budget, and spend that as long as the best pattern has creases that are hard to fold."""
        self.budget.extend(OVERTIME)
        self._improved = self.budget.part
        while self._has_short_creases and self.candidates:
            self._settle_and_vary()

    @property
    def _has_short_creases(self) -> bool:
        """Whether the best pattern has creases that are hard to fold."""
        best = self.trials.best
        return best is not None and best.rank.minus_shortest > -FOLDABLE_MM

    def _climb(self) -> None:
        """Turn one pocket of the best plan after the other, or turn it back, as long as that gets better."""
        tried: set[tuple[int, int, bool, bool]] = set()
        better = True
        while better and self.candidates and self.budget.part < CLIMBING:
            best = self.candidates[0]
            for plan in neighbours(self.outline, best.plan):
                if plan.choices not in tried and self.budget.part < CLIMBING:
                    tried.add(plan.choices)
                    self._follow(plan)
            better = self.candidates[0].cost < best.cost

    def _follow(self, plan: Plan) -> None:
        """Find a solution for a plan, and patterns."""
        known = [round(MORE_TURNS * len(one.solution.turns)) + 2 for one in self.candidates[:1] if one.cost < np.inf]
        solution = self.cover.whole(plan, min([MANY_TURNS, *known]))
        if solution is not None:
            self._polish(self.cover.thinned(solution), plan)

    def _polish(self, solution: Solution, plan: Plan) -> None:
        """Fold a solution, and others with the same turns that are nearer to what is simple."""
        best = plain = Candidate(self.attempt(solution).cost, solution, plan)
        for number in range(POLISHINGS):
            nodes = under_nodes(self.outline, solution.turns, self.random if number else None)
            wishes = Wishes(nodes.along, nodes.weight, POLISHED_CLEARANCE if number % 2 else None)
            moved = self._moved(solution, CLEARANCES[number], wishes)
            if moved is not None:
                other = Candidate(self.attempt(moved).cost, moved, plan)
                best = min(best, other, key=lambda one: one.cost)
        self.candidates += [best] if best is plain else [best, plain]
        self._sort()

    def _sort(self) -> None:
        self.candidates.sort(key=lambda one: one.cost)

    def _moved(self, solution: Solution, clearance: float, wishes: Wishes) -> Solution | None:
        program = Program(self.outline, solution.turns)
        return self.cover.solve(program, solution.along, clearance=clearance, wishes=wishes, whole=True)

    def _settle_and_vary(self) -> None:
        self._settle_next()
        for _ in range(VARIATIONS):
            self._vary()

    def _settle_next(self) -> None:
        """Lengthen the short creases of the best solution for which that has not been done yet, if there is one."""
        for solution in self._folding():
            if solution not in self.settled:
                self.settled.add(solution)
                self.short_creases.settle(solution)
                if self.trials.best is not None:
                    self.settled.add(self.trials.best.solution)
                return

    def _folding(self) -> Iterator[Solution]:
        """Yield the solutions that fold, the best first."""
        if self.trials.best is not None:
            yield self.trials.best.solution
        for one in self.candidates:
            if one.cost < np.inf:
                yield one.solution

    def _vary(self) -> None:
        """Try other wishes for one of the best candidates so far."""
        apart = self._has_short_creases and self.random.random() < APART
        folding = sum(one.cost < np.inf for one in self.candidates)
        number = (
            min(int(self.random.geometric(BEST_FIRST_APART if apart else BEST_FIRST)), folding or len(self.candidates))
            - 1
        )
        before = self.candidates[number]
        solution = before.solution
        nodes = under_nodes(self.outline, solution.turns, self.random)
        along = nodes.along
        if apart:
            # turns that are connected by one hub of the tree cannot be moved far: move them apart from each other
            share = self.random.normal(0.0, SPREAD, len(along)) * self.outline.length[solution.turns.side]
            along = np.where(solution.turns.corner, np.nan, solution.along + share)
        clearance = float(self.random.choice(CLEARANCES))
        most = VARIED_CLEARANCE * float(self.random.random()) if self.random.random() < 0.5 else None
        moved = self._moved(solution, clearance, Wishes(along, nodes.weight, most))
        if moved is None:
            return
        cost = self.attempt(moved).cost
        if apart:
            self.short_creases.lengthen(self.short_creases.mover(moved))
        if cost < before.cost:
            self.candidates[number] = Candidate(cost, moved, before.plan)
        self._sort()
