"""The search for the compact pattern with the fewest creases.

Loop on the sheet -> the best verified ``Compact`` pattern.

A *plan* says which corners are peaks and which valleys, which pockets are turned, and where the root is. Its linear
program tells how much of the boundary it leaves out; plans that leave out least are taken first. Turns are added where
something is left out until nothing is. Then the turns are moved to where events coincide: under the nodes of the
straight skeleton, for many choices of nodes and weights. Every answer is folded and counted and, if it is the best so
far, verified. The number of creases comes first; a pattern with a crease that nobody can fold is taken only if there
is no other.

Deterministic unless a time is given: what is tried depends on the effort and the number of corners alone.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from copy import copy
from dataclasses import dataclass
from itertools import islice

import numpy as np

from foldcut.core.arrays import Bools, Floats
from foldcut.core.errors import CreaseTooShortError, UnfoldableError
from foldcut.core.model import CreasePattern, FoldedState, Shape, Sheet
from foldcut.geometry.planar_graph import edge_lengths
from foldcut.methods.compact.lengthen import Mover
from foldcut.methods.compact.many_disks import crowded_solution
from foldcut.methods.compact.molecule import NotClosedError
from foldcut.methods.compact.pattern import Molecules, Walk, build_molecules, fold_molecules, molecule_faults
from foldcut.methods.compact.turns import Outline, Program, Solution, Turns
from foldcut.pattern.ranking import FOLDABLE_MM, Rank, rank, shortest_crease
from foldcut.proof.tolerance import COINCIDENT
from foldcut.proof.verify import verify

EFFORTS = {"fast": 0.42, "normal": 5.2, "best": 60.0}
"""Seconds that an effort is meant to take, by the model of ``_Budget``."""

CLEARANCES = (0.02, 0.008, 0.03, 0.004, 0.05)
"""How much nearer than their distance the images of two turns must be, relative; they are tried in turn."""

LONG_MM = 3.3  # what short creases are made as long as, a little more than foldable
VANISH_MM, TINY_MM = 3.0, 0.05  # what may be made to vanish, and what is as good as gone
IN_VAIN = 3  # creases that would not vanish, before the search goes on elsewhere
CROSSINGS = 2  # orders of events that are tried before the shortest crease is left as it is
VARIATIONS = 4
OVERTIME = 0.3
PATIENCE = 2  # how many times what an effort allows may be spent as long as there is no pattern

MOST_TURNS = 400
MOLECULES, PATTERN = 0.6, 0.85
"""Parts of the time for folding many turns: when the molecules are done, and when the pattern is, but for its proof."""
MENDS = 10  # how often events that are nearly one are moved apart
SHAKEN = 0.15, 0.6  # by what part of the disks that they come from, and where that was not enough


@dataclass(frozen=True, eq=False)
class Whole:
    """The whole that a sheet is part of: here it is all of it.

    ``shape`` is what is cut out.
    """

    shape: Shape

    def unfold(self, creases: CreasePattern, folded: FoldedState) -> tuple[CreasePattern, FoldedState]:
        """Return the pattern of the whole, from that of the part."""
        return creases, folded

    def creased(self, creases: CreasePattern) -> Bools:
        """Which edges of the part's pattern are creases of the whole, ``(e,)``."""
        return np.asarray(creases.edges_assignment != "B")


@dataclass(frozen=True, eq=False)
class Compact:
    """What the search found: the pattern, its walk and molecules, and how many trials it took.

    ``part``: the creases before they were unfolded, see ``fold_compact``.
    """

    creases: CreasePattern
    folded: FoldedState
    part: CreasePattern
    walk: Walk
    molecules: Molecules
    tried: int
    interrupted: bool


@dataclass(frozen=True, eq=False)
class _Found:
    key: Rank
    solution: Solution
    plan: _Plan
    creases: CreasePattern
    folded: FoldedState
    part: CreasePattern
    walk: Walk
    molecules: Molecules


def fold_compact(
    loop: Floats,
    sheet: Sheet,
    *,
    ribbon: float = 0.0,
    effort: str = "normal",
    seconds: float | None = None,
    progress: Callable[[str, float], None] | None = None,
    share: float = 1.0,
    whole: Whole | None = None,
    least: float = 0.0,
) -> Compact:
    """Return the verified pattern with the fewest creases that the search finds.

    ``loop`` ``(n, 2)`` is the shape's boundary on the sheet in mm, counter-clockwise; ``ribbon`` a half-width in mm
    that has to stay free of all but straight creases; ``effort`` one of ``EFFORTS``; ``seconds`` a time limit instead.
    ``progress`` is called with a text and the part done. Ctrl-C ends the search with the best pattern so far.
    ``share``: the part of the effort, or of the seconds, that may be spent. ``whole``: what ``sheet`` is part of, which
    is what is verified. ``least``: where very many turns are folded, a crease shorter than so many mm ends that.
    Raises ``UnfoldableError`` when no pattern is found, ``CreaseTooShortError`` for a crease that is too short.
    """
    budget = _Budget(share * EFFORTS[effort], None if seconds is None else share * seconds)
    search = _Search(loop, sheet, ribbon, budget, progress, whole or Whole(Shape((loop,), (-1,))), least)
    interrupted = False
    try:
        for stage in (search.run, search.crowd, search.finish):
            with suppress(_Spent):
                stage()
    except KeyboardInterrupt:
        if search.best is None:
            raise
        interrupted = True
    best = search.best
    if best is None and search.late:
        raise UnfoldableError(
            f"folding {len(loop):,} corners takes longer than {share * (seconds or 0):.3g} s; allow more with "
            "--seconds, or leave out small corners with --simplify"
        )
    if best is None:
        x, y = loop.mean(axis=0)
        raise UnfoldableError(
            f"no compact pattern was found in {search.tried} trials for the shape around ({x:.1f}, {y:.1f}) mm; "
            "try a higher effort, --simplify, or the paper's method"
        )
    return Compact(best.creases, best.folded, best.part, best.walk, best.molecules, search.tried, interrupted)


class _Spent(Exception):  # noqa: N818  # not an error
    """The search has taken what it may take."""


class _Budget:
    """Counts work by a model of what it takes, so that an effort means the same trials on every machine."""

    def __init__(self, allowed: float, seconds: float | None) -> None:
        self.allowed, self.seconds = allowed, seconds
        self.spent = 0.0
        self.started = time.monotonic()

    @property
    def part(self) -> float:
        """The part of the budget that is spent."""
        if self.seconds is not None:
            return (time.monotonic() - self.started) / self.seconds
        return self.spent / self.allowed  # no clock: what is found must not depend on the machine

    def more(self, part: float) -> None:
        """Allow more, as a part of what was allowed."""
        self.allowed = max(self.spent, self.allowed) + part * self.allowed
        self.started = time.monotonic()

    def is_less_than_program(self, turns: int) -> bool:
        """Whether all that may be spent, or what the highest effort may, would not be enough for one linear program."""
        allowed = self.allowed if self.seconds is None else min(self.seconds, EFFORTS["best"])
        return self.program_cost(turns) > PATIENCE * allowed

    @staticmethod
    def program_cost(turns: int) -> float:
        return 0.002 + 2e-7 * turns**3

    def program(self, turns: int) -> None:
        self.spent += self.program_cost(turns)

    def fold(self, turns: int) -> None:
        self.spent += 0.002 + 0.0003 * turns + 3e-6 * turns**2

    def step(self, turns: int) -> None:
        self.spent += 0.002 + 1.2e-5 * turns**2


@dataclass(frozen=True, eq=False)
class _Plan:
    """Which corners are peaks, the root, and what else a walk begins with."""

    peaks: Bools
    root: int
    at_corner: bool
    turned: int
    careful: bool = True  # see ``Program``

    def turns(self) -> Turns:
        return Turns.build(self.peaks, self.root, at_corner=self.at_corner, turned=self.turned)


class _Search:
    def __init__(
        self,
        loop: Floats,
        sheet: Sheet,
        ribbon: float,
        budget: _Budget,
        progress: Callable[[str, float], None] | None,
        whole: Whole,
        least: float,
    ) -> None:
        self.outline = Outline(loop)
        self.whole, self.least = whole, least
        self.sheet, self.ribbon, self.budget, self.progress = sheet, ribbon, budget, progress
        self.rng = np.random.default_rng(len(loop))
        self.best: _Found | None = None
        self.tried = 0
        self.failed: set[int] = set()  # the stretches of the last walk where it failed,
        self.open = False  # because a molecule did not close
        self.deadline = np.inf  # of folding very many turns
        self.late = False
        self.settled: set[Solution] = set()
        self.solved: list[tuple[float, Solution, _Plan]] = []

    def run(self) -> None:
        """Search until the budget is spent, if it is enough for one linear program."""
        if self.budget.is_less_than_program(2 * len(self.outline.loop)):
            return
        plain, turned = self._ranked(self._plans(turned=False)), self._ranked(self._plans(turned=True))
        while (plain or turned) and (self.best is None or self.budget.part < 0.3):
            for plans, share in ((plain, 1), (turned, 3)):
                for _ in range(share):
                    if plans:
                        self._follow(plans.pop(0))
        self._climb()
        while self.solved:
            self._settle_next()
            for _ in range(VARIATIONS):
                self._vary()

    def crowd(self) -> None:
        """Where the programs took too long, fold many small disks instead."""
        if self.best is not None:
            return
        if self.budget.seconds is not None:
            self.deadline = self.budget.started + self.budget.seconds
        self.budget.seconds = None
        self.budget.more(np.inf)
        # all corners are peaks and no pocket is turned, so no corner falls
        plan = _Plan(np.ones(len(self.outline.loop), dtype=bool), 0, at_corner=False, turned=0, careful=False)
        count = len(self.outline.loop)
        for shrunk in (0.0, 0.01, 0.03, 0.06):
            # the exact ties of symmetric shapes are where a molecule may not close; a little noise undoes them
            noise, shaken = shrunk * self.rng.random(count), np.full(count, SHAKEN[0])
            for _ in range(MENDS):
                solution = crowded_solution(self.outline, CLEARANCES[0], noise)
                if self._try(solution, plan) < np.inf:
                    return
                if not self.failed or (self.open and not shrunk):
                    break
                # of very many events some happen to be nearly at one place: move what they come from, and no more
                corners = np.unique(solution.turns.side[list(self.failed)])
                noise[corners] = shaken[corners] * self.rng.random(len(corners))
                shaken[corners] = SHAKEN[1]

    def _too_near(self, molecules: Molecules, creases: CreasePattern, apart: float) -> set[int]:
        """The stretches of the walk that vertices come from that are as good as one: no more than ``apart`` mm."""
        short = creases.edges_vertices[edge_lengths(creases) <= apart]
        if not len(short):
            return set()
        places = set(map(tuple, creases.vertices_coords[short].reshape(-1, 2).tolist()))
        vertices = {number for number, place in enumerate(molecules.vertices.flat) if place in places}
        for cut, one, other, _ in molecules.vertices.cuts:
            if cut in vertices:
                vertices |= {one, other}
        stretches: set[int] = set()
        for molecule in (molecules.inside, molecules.outside) if vertices else ():
            facets = {
                number
                for number, chains in enumerate(molecule.facets)
                if not (vertices.isdisjoint(chains.start) and vertices.isdisjoint(chains.end))
            }
            stretches |= molecule.stretches(facets)
        return stretches

    def finish(self) -> None:
        """Spend more as long as the best pattern has creases that are hard to fold."""
        if self.budget.seconds is not None or self.budget.allowed == np.inf:
            return
        self.budget.more(OVERTIME)
        while self._short and self.solved:
            self._settle_next()
            for _ in range(VARIATIONS):
                self._vary()

    @property
    def _short(self) -> bool:
        """Whether the best pattern has creases that are hard to fold."""
        return self.best is not None and self.best.key[2] > -FOLDABLE_MM

    def _settle_next(self) -> bool:
        """Settle the best solution that has not been settled yet, if there is one."""
        best = [] if self.best is None else [(0.0, self.best.solution, self.best.plan)]
        for key, solution, plan in best + self.solved:
            if key < np.inf and solution not in self.settled:
                self.settled.add(solution)
                self._settle(solution, plan)
                if self.best is not None:
                    self.settled.add(self.best.solution)
                return True
        return False

    # --- plans

    def _ranked(self, plans: Iterator[_Plan]) -> list[_Plan]:
        """Return plans, those first that leave out least of the boundary."""
        ranked: list[tuple[float, int, _Plan]] = []
        start = self.budget.part
        for plan in plans:
            program = Program(self.outline, plan.turns(), careful=plan.careful)
            solution = self._solve(program, program.evenly(), clearance=CLEARANCES[0])
            if solution is not None:
                left = solution.left_out
                missing = float(left.sum()) / self.outline.size + 0.1 * int((left > 0).sum())
                ranked.append((missing + 0.02 * len(program.turns), len(ranked), plan))
            if self.budget.part > start + 0.1 and ranked:
                break
        ranked.sort(key=lambda item: item[:2])
        return [plan for _, _, plan in ranked]

    def _plans(self, *, turned: bool) -> Iterator[_Plan]:
        """Yield plans with no pocket turned, or with all, or one."""
        outline = self.outline
        reflex = outline.reflex
        bits = self._bits()
        modes = [0]
        if turned:
            modes = [sum(bits), *bits] if len(bits) > 1 else bits
        heights = np.zeros(len(reflex))
        for side, nodes in enumerate(outline.nodes):
            heights[side] = max((node.height for node in nodes), default=0.0)
        for side in np.argsort(-heights, kind="stable").tolist():
            for mode in modes:
                for careful in (True, False) if mode else (True,):
                    for at_corner in (False, True):
                        plan = self._plan(mode, side, at_corner, careful)
                        if plan is not None:
                            yield plan

    def _bits(self) -> list[int]:
        return [1 << n for n in range(int(self.outline.pockets.max()).bit_length())]

    def _plan(self, turned: int, root: int, at_corner: bool, careful: bool) -> _Plan | None:
        """Return the plan with these pockets turned, if there is one."""
        outline = self.outline
        pockets = outline.pockets | np.roll(outline.pockets, 1)
        valley = outline.reflex & (pockets & turned != 0)
        peaks = ~valley
        after = (root + 1) % len(peaks)
        if at_corner:
            peaks[root] = False
            if not (peaks[root - 1] and peaks[after]):
                return None
        elif not (peaks[root] and peaks[after]):
            return None
        return _Plan(peaks, root, at_corner, turned, careful)

    def _climb(self) -> None:
        """Turn one pocket of the best plan after the other, or turn it back."""
        tried: set[tuple[int, int, bool, bool]] = set()
        better = True
        while better and self.solved and self.budget.part < 0.5:
            key, _, plan = self.solved[0]
            for turned in (plan.turned ^ bit for bit in self._bits()):
                for careful in (True, False):
                    name = (turned, plan.root, plan.at_corner, careful)
                    other = self._plan(*name)
                    if other is not None and name not in tried and self.budget.part < 0.5:
                        tried.add(name)
                        self._follow(other)
            better = self.solved[0][0] < key

    def _follow(self, plan: _Plan) -> None:
        """Find a solution for a plan, and patterns."""
        solution = self._cover(plan, CLEARANCES[0])
        if solution is not None:
            self._polish(self._thinned(solution, plan), plan)

    def _thinned(self, solution: Solution, plan: _Plan) -> Solution:
        """Take turns on sides away again that are not needed."""
        at = 1
        most = self.budget.part + 0.1
        while at < len(solution.turns) - 1 and self.budget.part < most:
            turns = solution.turns
            if turns.corner[at] or turns.corner[at + 1]:
                at += 1
                continue
            program = Program(self.outline, turns.removed(at), careful=plan.careful)
            along = np.delete(solution.along, [at, at + 1])
            fewer = self._solve(program, along, clearance=CLEARANCES[0], whole=True)
            if fewer is None:
                at += 1
            else:
                solution = fewer
        return solution

    # --- solutions

    def _report(self, text: str, part: float) -> None:
        if self.progress is not None:
            self.progress(text, part)

    def _tell_folding(self, solution: Solution, part: float) -> None:
        """Tell how far many turns are folded: that takes long, and is no search. ``--seconds`` ends it, too."""
        count = len(solution.turns)
        if count > MOST_TURNS:
            self.late = part < PATTERN and time.monotonic() > self.deadline
            if self.late:
                raise _Spent
            again = f", trial {self.tried}" if self.tried > 1 else ""
            self._report(f"folding: {count:,} turns{again}", part)

    def _tell(self) -> None:
        part = self.budget.part
        count = f"{self.best.creases.crease_count} creases" if self.best else "no pattern yet"
        self._report(f"searching: {count}", min(0.99, part))
        if part >= 1 and (self.best is not None or self.budget.seconds is not None or part >= PATIENCE):
            raise _Spent

    def _solve(self, program: Program, along: Floats, **options: object) -> Solution | None:
        self.budget.program(len(program.turns))
        self._tell()
        return program.solve(along, **options)  # type: ignore[arg-type]

    def _cover(self, plan: _Plan, clearance: float) -> Solution | None:
        """Add turns where something is left out until nothing is."""
        program = Program(self.outline, plan.turns(), careful=plan.careful)
        along = program.evenly()
        most = min([MOST_TURNS, *(round(1.15 * len(s.turns)) + 2 for key, s, _ in self.solved[:1] if key < np.inf)])
        for _ in range(60):
            solution = self._solve(program, along, clearance=clearance)
            if solution is None:
                return None
            if not solution.left_out.any():
                if program.true_clearance(solution) >= clearance - 1e-6:
                    return solution
                along = solution.along
                solution = self._solve(program, along, clearance=clearance, steps=8)
                if (
                    solution is not None
                    and not solution.left_out.any()
                    and program.true_clearance(solution) > 0.3 * clearance
                ):
                    return solution
                return None
            if len(program.turns) >= most:
                return None
            turns, along = _with_more_turns(self.outline, program.turns, solution)
            program = Program(self.outline, turns, careful=plan.careful)
        return None

    def _polish(self, solution: Solution, plan: _Plan) -> None:
        """Fold a solution, and others with the same turns that are nearer to what is simple."""
        best = plain = (self._try(solution, plan), solution, plan)
        for number in range(3):
            wish, weight = self._wishes(solution.turns, plain=number == 0)
            program = Program(self.outline, solution.turns, careful=plan.careful)
            moved = self._solve(
                program,
                solution.along,
                clearance=CLEARANCES[number],
                wish=wish,
                weight=weight,
                whole=True,
                most_clearance=0.06 if number % 2 else None,
            )
            if moved is not None:
                best = min(best, (self._try(moved, plan), moved, plan), key=lambda item: item[0])
        self.solved += [best] if best is plain else [best, plain]
        self.solved.sort(key=lambda item: item[0])

    def _vary(self) -> None:
        """Try other wishes for one of the best plans so far."""
        apart = self._short and self.rng.random() < 0.8
        folding = sum(key < np.inf for key, *_ in self.solved)
        number = min(int(self.rng.geometric(0.2 if apart else 0.4)), folding or len(self.solved)) - 1
        key, solution, plan = self.solved[number]
        wish, weight = self._wishes(solution.turns, plain=False)
        if apart:
            # apart from each other: what hangs together in one hub cannot be moved much
            share = self.rng.normal(0.0, 0.15, len(wish)) * self.outline.length[solution.turns.side]
            wish = np.where(solution.turns.corner, np.nan, solution.along + share)
        program = Program(self.outline, solution.turns, careful=plan.careful)
        moved = self._solve(
            program,
            solution.along,
            clearance=float(self.rng.choice(CLEARANCES)),
            wish=wish,
            weight=weight,
            whole=True,
            most_clearance=0.1 * float(self.rng.random()) if self.rng.random() < 0.5 else None,
        )
        if moved is None:
            return
        found = self._try(moved, plan)
        if apart:
            self._lengthen(self._mover(moved, plan), plan)
        if found < key:
            self.solved[number] = (found, moved, plan)
        self.solved.sort(key=lambda item: item[0])

    def _settle(self, solution: Solution, plan: _Plan) -> None:
        """Let short creases get longer, or vanish."""
        mover = self._mover(solution, plan)
        self._lengthen(mover, plan)
        if self.best is None or self.best.key[0]:
            return  # first one that can be folded at all
        mover = self._mover(solution, plan)
        number = 0
        while number < IN_VAIN and len(lengths := mover.lengths()) > number and lengths[number] < VANISH_MM:
            less = mover.without(number, TINY_MM)
            if less is None or len(less.lengths()) >= len(lengths) or self._try(less.solution, plan) == np.inf:
                number += 1
            else:
                mover, number = less, 0
        if mover.solution is not solution:
            self._lengthen(mover, plan)

    def _mover(self, solution: Solution, plan: _Plan) -> Mover:
        return Mover(self.outline, solution, lambda s: self._creases(s, plan), self.whole.creased, careful=plan.careful)

    def _lengthen(self, mover: Mover, plan: _Plan) -> None:
        """Make the shortest creases longer, and where they do not get longer, let them go through zero."""
        longest, mover = self._stretch(mover, plan)
        better = True
        while better and 0 < longest < LONG_MM:
            better = False
            for other in islice(mover.across(LONG_MM), CROSSINGS):
                length, other = self._stretch(other, plan)
                if length > 1.05 * longest:
                    mover, longest, better = other, length, True
                    break

    def _stretch(self, mover: Mover, plan: _Plan) -> tuple[float, Mover]:
        """Make the shortest creases as long as they get while events keep their order.

        Returns the length of the shortest, 0 if nothing can move, and the mover.
        """
        longest, stalled = 0.0, 0.0
        best = mover
        while stalled < 2 and longest < LONG_MM and mover.lengthen(LONG_MM):
            self.budget.step(len(mover.solution.x))
            shortest = float(mover.lengths()[0])
            # a step may make things worse before the next makes them better
            stalled = 0.0 if shortest > 1.05 * longest else stalled + (0.4 if shortest > 1.003 * longest else 1.0)
            if shortest > longest:
                longest, best = shortest, copy(mover)
        if longest:
            self._try(best.solution, plan)
        return longest, best

    def _creases(self, solution: Solution, plan: _Plan) -> tuple[Molecules, CreasePattern] | None:
        """The molecules and creases of a solution, not verified, or None."""
        self.budget.fold(len(solution.turns))
        self._tell()
        made = self._build(solution, plan)
        return None if made is None else (made[1], made[2])

    def _build(self, solution: Solution, plan: _Plan) -> tuple[Walk, Molecules, CreasePattern, FoldedState] | None:
        walk = solution.walk(self.outline, careful=plan.careful)
        least = self.least if len(solution.turns) > MOST_TURNS else 0.0
        try:
            molecules = build_molecules(
                walk, self.sheet, lambda part: self._tell_folding(solution, MOLECULES * part), least
            )
            lowest = min(molecules.inside.lowest_event, molecules.outside.lowest_event)
            if lowest <= self.ribbon or molecule_faults(molecules):
                return None
            self._tell_folding(solution, MOLECULES)
            return walk, molecules, *fold_molecules(molecules, self.sheet)
        except CreaseTooShortError as error:
            raise self._too_short(error.length, error.place) from None
        except NotClosedError as error:
            if len(solution.turns) > MOST_TURNS:
                self.failed, self.open = error.stretches, True
            return None
        except (UnfoldableError, AssertionError, KeyError, StopIteration):
            return None

    def _too_short(self, length: float, place: tuple[float, float]) -> CreaseTooShortError:
        """Say what is to be done about the first crease of very many that is found to be too short."""
        x, y = place
        return CreaseTooShortError(
            f"with {len(self.outline.loop):,} corners creases get too short: the first one found, at ({x:.4g}, "
            f"{y:.4g}), is {length:.2g} mm long, shorter than {self.least:g} mm; leave out small corners with "
            "--simplify, use a larger sheet with the drawing larger to match, or allow all with --min-crease 0",
            length,
            place,
        )

    def _wishes(self, turns: Turns, *, plain: bool) -> tuple[Floats, Floats]:
        """For each turn on a side with no other: a node over it; for each turn a weight."""
        wish = np.full(len(turns), np.nan)
        per_side = np.bincount(turns.side, minlength=len(self.outline.loop))
        for k in np.flatnonzero(~turns.corner & (per_side[turns.side] == 2)).tolist():
            nodes = self.outline.nodes[int(turns.side[k])]
            if nodes:
                wish[k] = nodes[0 if plain else int(self.rng.integers(len(nodes)))].along
        weight = np.ones(len(turns)) if plain else self.rng.uniform(0.1, 1.9, len(turns)) ** 2
        return wish, weight

    # --- patterns

    def _try(self, solution: Solution, plan: _Plan) -> float:
        """Fold a solution, keep it if it is verified and better than the best; return its number of creases."""
        self.tried += 1
        self.failed, self.open = set(), False
        self.budget.fold(len(solution.turns))
        self._tell()
        made = self._build(solution, plan)
        if made is None:
            return np.inf
        walk, molecules, part, folded = made
        coarse, *_, fine = (share * self.sheet.diagonal for share in COINCIDENT)
        many = len(solution.turns) > MOST_TURNS
        if many and (near := self._too_near(molecules, part, fine)):
            self.failed = near
            return np.inf
        creases, folded = self.whole.unfold(part, folded)
        key = rank(part.crease_count, shortest_crease(creases))
        better = self.best is None or key < self.best.key
        # with pockets turned about half do not fold: none of these may be searched around
        self._tell_folding(solution, PATTERN)
        if (better or plan.turned) and verify(creases, folded.layers, self.whole.shape):
            self.failed = self._too_near(molecules, part, coarse) if many else set()
            return np.inf
        if better:
            self.best = _Found(key, solution, plan, creases, folded, part, walk, molecules)
        return key[1] + 1e4 * key[0]


def _with_more_turns(outline: Outline, turns: Turns, solution: Solution) -> tuple[Turns, Floats]:
    """Add two turns on each stretch that leaves much out, and say where they are to begin with."""
    count = len(turns)
    left = solution.left_out.copy()
    start = solution.along.copy()
    # both stretches at a turn on a side leave out one piece there
    for k in range(count):
        if not turns.corner[k] and k and left[k - 1] > 0 and left[k] > 0:
            left[k - 1] += left[k]
            start[k] += left[k]
            left[k] = 0.0
    along = solution.along
    for k in np.flatnonzero(left > 0.35 * left.max())[::-1].tolist():
        reach = abs(float(solution.x[k] - solution.x[(k + 1) % count]))
        begin = along[k] + (reach if turns.peak[k] else 0.0)
        side = int(turns.side[k])
        middle = outline.loop[side] + outline.direction[side] * (begin + left[k] / 2)
        more = int(np.clip(left[k] / (2.2 * outline.width_at(middle, side)), 1, 8))
        for number in reversed(range(more)):
            turns = turns.inserted(k)
            at = begin + left[k] * (number + 0.5) / more
            along = np.insert(along, k + 1, [at - 0.2 * left[k] / more, at])
    return turns, along
