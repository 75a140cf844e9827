"""Fold one outline exactly as it is, soon: for outlines that were drawn so that they fold.

``Shape`` on its sheet -> ``Skeletal``: a verified pattern. No corner is moved, and the first set of perpendiculars that
has a layer order is taken: those with the fewest pieces come first.
"""

from __future__ import annotations

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.methods.sheet_part import SheetPart
from foldcut.methods.skeleton.budget import Budget
from foldcut.methods.skeleton.choices import CheapestSets, promising_sets
from foldcut.methods.skeleton.search import ridges_of
from foldcut.methods.skeleton.trial import Drawing, Skeletal, Trial, attempt

__all__ = ["TRIES", "fold_outline"]

TRIES = 12
"""How many sets of perpendiculars are tried of each kind: those with the fewest folds, and the promising ones."""


def fold_outline(
    shape: Shape, sheet: Sheet, *, ribbon: float = 0.0, tries: int = TRIES, part: SheetPart | None = None
) -> Skeletal:
    """Return the pattern of the first set of perpendiculars that can be folded, the fewest folds first.

    ``tries``: how many sets with the fewest folds are tried, and then how many other promising ones.

    ``shape`` is in the sheet's mm; ``ribbon`` is a half-width in mm: creases that meet this near to the cut are
    refused. ``part``: the part of the whole sheet that ``sheet`` is, if it is not all of it: a half, and ``shape`` may
    reach beyond its border at the axis. The pattern is that of the part; the whole is verified.
    Raises ``UnfoldableError`` with the first reason where none of the sets can be folded.
    """
    problem = "no set of perpendiculars makes the creases at every node even"
    budget = Budget(float("inf"))
    ridges = ridges_of(shape, sheet, ribbon)
    for number, (perpendiculars, taken) in enumerate(promising_sets(ridges)):
        if number == tries:
            break
        drawing = Drawing(shape, 0.0, perpendiculars, part)
        trial = attempt(drawing, frozenset(taken), budget)
        if not number:
            problem = trial.problem
            trial = _learned(drawing, trial, budget, tries - 1)
        if trial.made is not None:
            return trial.made
    raise UnfoldableError(problem)


def _learned(drawing: Drawing, trial: Trial, budget: Budget, tries: int) -> Trial:
    """Try the cheapest sets that do not repeat what has failed, until one can be folded; return the last trial."""
    sets = CheapestSets(drawing.perpendiculars)
    for _ in range(tries):
        if trial.made is not None:
            break
        for cause in trial.causes or (frozenset(range(len(drawing.perpendiculars.paths))),):
            sets.forbid(trial.taken, cause)
        taken = sets.cheapest()
        if taken is None:
            break
        trial = attempt(drawing, taken, budget)
    return trial
