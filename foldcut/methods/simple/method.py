"""The method ``simple``: a sequence of folds along straight lines across the whole sheet, each through all layers.

The lines come from ``search``; folding a sheet of paper along them gives creases, mountains and valleys, and the order
of the layers at once. Of the shortest sequences, the one with the fewest creases is taken, then the one whose shortest
crease is the longest.
"""

from __future__ import annotations

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import CreasePattern, FoldedState, Sheet
from foldcut.methods.base import Effort, Made, Problem
from foldcut.methods.simple.lines import Line
from foldcut.methods.simple.search import Folds, sequences
from foldcut.methods.simple.stack import flat_sheet
from foldcut.pattern.ranking import rank, shortest_crease
from foldcut.proof.tolerance import COINCIDENT
from foldcut.proof.verify import verify

__all__ = ["fold", "paper_folded"]


def fold(problem: Problem, effort: Effort) -> Made:
    """Fold a shape by simple folds through all layers; the pattern is verified.

    Raises ``UnfoldableError`` with the reason where no such folds are found.
    """
    del effort  # the search is bounded by a number of folds
    laid = problem.laid
    with problem.stages("simple folds"):
        found = sequences(laid.shape, laid.sheet)
        made = [(len(folds), *paper_folded(laid.sheet, folds, cut)) for folds, cut in found]
    made.sort(key=lambda one: _key(one[0], one[1]))
    for count, creases, folded in made:
        findings = verify(creases, folded.layers, laid.shape)
        if not findings:
            return Made(
                "simple",
                creases,
                folded,
                laid,
                problem.wishes.free_ribbon,
                actions=count,
                told=(f"simple: {count} simple fold{'s' * (count != 1)}, each through all layers",),
                numbers={"simple_folds": count},
            )
    raise UnfoldableError(f"the pattern of the simple folds fails verification ({findings[0]})")


def _key(folds: int, creases: CreasePattern) -> tuple[bool, float, int, float]:
    """Return what patterns are sorted by, the best first."""
    unfoldable, count, minus_shortest = rank(folds, shortest_crease(creases))
    return unfoldable, count, creases.crease_count, round(minus_shortest, 6)


def paper_folded(sheet: Sheet, folds: Folds, cut: Line) -> tuple[CreasePattern, FoldedState]:
    """Return the pattern of a sheet that is folded along lines, one after another, and how it lies for the cut."""
    stack = flat_sheet(sheet)
    for line in folds:
        stack = stack.fold(line.origin, line.along, COINCIDENT[0] * sheet.diagonal)
    return stack.pattern(cut.origin, cut.along)
