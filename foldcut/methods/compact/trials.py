"""Trials: each folds a solution, verifies the pattern if it is better than the best, and keeps it then.

``Solution`` -> ``Attempt``; ``Trials.best`` is the best verified pattern so far, ``Found``.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Set
from dataclasses import dataclass

import numpy as np

from foldcut.core.errors import CreaseTooShortError
from foldcut.core.model import CreasePattern, FoldedState, Sheet
from foldcut.geometry.planar_graph import edge_lengths
from foldcut.methods.compact.budget import Spent, fold_cost
from foldcut.methods.compact.molecule import NotClosedError
from foldcut.methods.compact.outline import Outline
from foldcut.methods.compact.pattern import Molecules, Walk, build_molecules, fold_molecules, molecule_faults
from foldcut.methods.compact.turns import Solution
from foldcut.methods.sheet_part import SheetPart
from foldcut.pattern.assemble import NoFaceUpError
from foldcut.pattern.ranking import Rank, rank, shortest_crease
from foldcut.proof.tolerance import COINCIDENT
from foldcut.proof.verify import verify

MANY_TURNS = 400
"""Walks with more turns than this take long to fold: they report their progress, and why they fail."""

MOLECULES = 0.6
"""The part of the time for folding many turns after which the molecules are done."""

PATTERN = 0.85
"""The part of that time after which the pattern is done, except for its proof."""

UNFOLDABLE = 1e4
"""How much more a pattern costs that has a crease too short for anybody to fold."""

Charge = Callable[[float], None]
"""Is told the cost of the work that comes next; raises ``Spent`` where there is no budget for it."""


@dataclass(frozen=True, eq=False)
class Found:
    """A verified pattern, ``creases`` and ``folded``, and what it was made of.

    ``part``: the pattern of the part of the sheet that was folded, see ``SheetPart``.
    """

    rank: Rank
    solution: Solution
    creases: CreasePattern
    folded: FoldedState
    part: CreasePattern
    walk: Walk
    molecules: Molecules


@dataclass(frozen=True)
class Attempt:
    """What a trial has shown: the ``cost`` of the pattern, about its number of creases, or infinity if there is none.

    If there is no pattern for many turns, ``stretches`` are where it failed: numbers of the turns before the stretches
    of the walk concerned, empty if unknown; ``open``: whether it failed because a molecule did not close.
    """

    cost: float
    stretches: Set[int] = frozenset()
    open: bool = False

    @property
    def folds(self) -> bool:
        """Whether there is a pattern."""
        return self.cost < np.inf


@dataclass(frozen=True, eq=False)
class _Folded:
    walk: Walk
    molecules: Molecules
    creases: CreasePattern
    folded: FoldedState


class Trials:
    """Folds one solution after the other, counts them and keeps the best verified pattern.

    ``part``: the part of the sheet that is folded, of the size ``sheet``. ``ribbon``: a half-width in mm beside the cut
    line that has to stay free of events. ``least``: with many turns, a crease shorter than this in mm ends the folding.
    ``report`` is called with a text and the part done. ``deadline``: the time, by ``time.monotonic``, at which the
    folding of many turns ends.
    """

    def __init__(
        self,
        outline: Outline,
        sheet: Sheet,
        part: SheetPart,
        *,
        ribbon: float = 0.0,
        least: float = 0.0,
        report: Callable[[str, float], None] = lambda _text, _part: None,
    ) -> None:
        self.outline, self.sheet, self.part = outline, sheet, part
        self.ribbon, self.least, self.report = ribbon, least, report
        self.deadline = np.inf
        self.best: Found | None = None
        self.count = 0

    def attempt(self, solution: Solution, charge: Charge) -> Attempt:
        """Fold a solution; keep the pattern if it is verified and better than the best.

        Raises ``CreaseTooShortError`` for a crease shorter than ``least``, and ``Spent`` at the deadline.
        """
        self.count += 1
        charge(fold_cost(len(solution.turns)))
        many = len(solution.turns) > MANY_TURNS
        try:
            made = self._folded(solution)
        except NotClosedError as error:
            return Attempt(np.inf, error.stretches, open=True) if many else Attempt(np.inf)
        except NoFaceUpError:
            return Attempt(np.inf)
        if made is None:
            return Attempt(np.inf)
        coarse, *_, fine = (share * self.sheet.diagonal for share in COINCIDENT)
        if many and (near := stretches_too_near(made.molecules, made.creases, fine)):
            return Attempt(np.inf, near)
        creases, folded = self.part.unfold(made.creases, made.folded)
        key = rank(made.creases.crease_count, shortest_crease(creases))
        better = self.best is None or key < self.best.rank
        self._tell(solution, PATTERN)
        # about half of the plans with turned pockets do not fold: verify them all, so that none is searched around
        if (better or solution.turns.turned) and verify(creases, folded.layers, self.part.shape):
            near = stretches_too_near(made.molecules, made.creases, coarse) if many else set()
            return Attempt(np.inf, near)
        if better:
            self.best = Found(key, solution, creases, folded, made.creases, made.walk, made.molecules)
        return Attempt(key.creases + UNFOLDABLE * key.unfoldable)

    def creases(self, solution: Solution, charge: Charge) -> tuple[Molecules, CreasePattern] | None:
        """Return the molecules and the creases of a solution, not verified, or None if it does not fold."""
        charge(fold_cost(len(solution.turns)))
        try:
            made = self._folded(solution)
        except (NotClosedError, NoFaceUpError):
            return None
        return None if made is None else (made.molecules, made.creases)

    def _folded(self, solution: Solution) -> _Folded | None:
        """Fold a solution; None if its molecules leave no room for the ribbon, or are distorted."""
        walk = solution.walk(self.outline)
        least = self.least if len(solution.turns) > MANY_TURNS else 0.0
        try:
            molecules = build_molecules(walk, self.sheet, lambda part: self._tell(solution, MOLECULES * part), least)
        except CreaseTooShortError as error:
            raise CreaseTooShortError(
                f"with {len(self.outline.loop):,} corners creases get too short", error.length, error.place
            ) from None
        lowest = min(molecules.inside.lowest_event, molecules.outside.lowest_event)
        if lowest <= self.ribbon or molecule_faults(molecules):
            return None
        self._tell(solution, MOLECULES)
        return _Folded(walk, molecules, *fold_molecules(molecules, self.sheet))

    def _tell(self, solution: Solution, part: float) -> None:
        """Report how far the folding of many turns is; end it at the deadline, unless only the proof is left."""
        count = len(solution.turns)
        if count > MANY_TURNS:
            if part < PATTERN and time.monotonic() > self.deadline:
                raise Spent
            again = f", trial {self.count}" if self.count > 1 else ""
            self.report(f"folding: {count:,} turns{again}", part)


def stretches_too_near(molecules: Molecules, creases: CreasePattern, apart: float) -> set[int]:
    """Return the stretches of the walk from which vertices come that are no more than ``apart`` mm from another."""
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
