"""What a printed sheet says: how difficult it is, and in three short lines what to do with it.

``FoldedPattern`` -> a subtitle and ``Hint`` after ``Hint``, for a job that is printed.
"""

from __future__ import annotations

from foldcut.core.model import FoldedPattern
from foldcut.folding_steps.phases import Phase, difficulty_of, phases
from foldcut.folding_steps.steps import FoldingStep, folding_steps, goes_through_all
from foldcut.jobs.model import Hint
from foldcut.pattern.foldability import foldability

__all__ = ["hints"]

MOST_COUNTED = 300
"""In patterns with more creases than this nobody counts simple folds; they are not for hands."""


def hints(pattern: FoldedPattern, colour: str = "grey") -> tuple[str, tuple[Hint, ...]]:
    """Return how difficult a pattern is, in a few words, and what to do with the sheet.

    ``colour``: that of the printed outline, which is where the cut goes.
    """
    few = pattern.creases.crease_count <= MOST_COUNTED
    steps = folding_steps(pattern) if few else ()
    some = phases(pattern, steps)
    told = difficulty_of(some, foldability(pattern))
    cut = Hint("cut", f"Cut once, straight, along the {colour} line.")
    every = "always through all layers" if _through_all(pattern, steps) else "some of them not through all layers"
    return told.short, (*_first(pattern), *_folding(some, colour, bool(pattern.first_folds), every), cut)


def _first(pattern: FoldedPattern) -> list[Hint]:
    """Return what the arrowheads at the sheet's edge mean, if there are any."""
    count = len(pattern.first_folds)
    if not count:
        return []
    if count == 1:
        return [Hint("first", "First fold the sheet along the line between the arrowheads, away from you.")]
    return [Hint("first", "First fold along the lines between arrowheads, away from you.")]


def _through_all(pattern: FoldedPattern, steps: tuple[FoldingStep, ...]) -> bool:
    """Return whether all straight folds go through all layers."""
    at = pattern.creases.vertices_coords
    for step in steps:
        if step.line is not None and not goes_through_all(pattern, at, step.line):
            return False
        at = step.state.vertices_coords
    return True


def _folding(some: tuple[Phase, ...], colour: str, begun: bool, every: str) -> list[Hint]:
    """Return how all other creases are folded, ``every`` time, and that the sheet has to be flat then."""
    if some and not any(phase.together for phase in some):
        count = sum(phase.count for phase in some)
        how = "once" if count == 1 else f"{count} times{' in all' * begun}, {every}"
        flat = f"Press it flat; all {colour} lines lie on each other now."
        return [Hint("fold", f"Fold straight across, {how}."), Hint("flatten", flat)]
    return [
        Hint("press", "Fold all lines sharply, each by itself, and open them again."),
        Hint("flatten", "Let all lines close at once, and press the sheet flat."),
    ]
