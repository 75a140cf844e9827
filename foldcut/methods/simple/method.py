"""The method ``simple``: a sequence of folds along straight lines across the whole sheet, each through all layers.

The lines come from ``search``; folding a sheet of paper along them gives creases, mountains and valleys, and the order
of the layers at once. Of the shortest sequences, the one with the fewest creases is taken, then the one whose shortest
crease is the longest. A drawing that is symmetric but for rounding, or within ``Wishes.symmetry``, is made exactly so.

A row of figures that are mirror images of each other, such as a paper chain, is folded so as far as parallel folds go,
and the rest along its straight skeleton, through all layers (``chain``).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import CreasePattern, FoldedState, Shape, Sheet
from foldcut.drawing.laying import AS_IT_IS, Laid
from foldcut.geometry.mirror_axes import ROUNDING
from foldcut.methods.base import Effort, Made, Problem
from foldcut.methods.simple.chain import chain_of, fold_chain
from foldcut.methods.simple.exact import exactly
from foldcut.methods.simple.lines import Line
from foldcut.methods.simple.search import MOST_FOLDS_TRIED, Folds, sequences
from foldcut.methods.simple.stack import flat_sheet
from foldcut.methods.skeleton.search import SECONDS
from foldcut.pattern.ranking import rank, shortest_crease
from foldcut.proof.tolerance import COINCIDENT
from foldcut.proof.verify import verify

__all__ = ["fold", "fold_row", "fold_simply", "paper_folded"]


def fold(problem: Problem, effort: Effort) -> Made:
    """Fold a shape by simple folds through all layers, or a row of figures by parallel ones first.

    The pattern is verified. Raises ``UnfoldableError`` with the reason where no such folds are found.
    """
    problem.stages.up_to(0.3)
    try:
        return fold_simply(problem)
    except UnfoldableError as error:
        problem.stages.up_to(1.0)
        try:
            return fold_row(problem, effort)
        except UnfoldableError as row:
            raise UnfoldableError(f"{error}; {row}") from row


def fold_row(problem: Problem, effort: Effort) -> Made:
    """Fold a row of figures along parallel lines, and the rest through all layers; the pattern is verified.

    Raises ``UnfoldableError`` where the drawing is no such row, or no pattern is found for the figure at its end.
    """
    laid, ribbon = problem.laid, problem.wishes.free_ribbon
    seconds = effort.share * (SECONDS[effort.name] if effort.seconds is None else effort.seconds)
    with problem.stages("parallel folds"):
        chain = chain_of(laid.shape, laid.sheet, problem.wishes.symmetry)
        made = fold_chain(chain, ribbon=ribbon, seconds=seconds, progress=problem.stages.tell)
    findings = verify(made.creases, made.folded.layers, chain.drawn)
    if findings:
        raise UnfoldableError(f"the pattern of the row fails verification ({findings[0]})")
    count = len(chain.folds)
    return Made(
        "simple",
        made.creases,
        made.folded,
        _with_shape(laid, chain.drawn),
        ribbon,
        actions=made.actions,
        told=(
            f"simple: {count} parallel folds, then the straight skeleton of the last piece of the row, "
            f"{made.perpendiculars} perpendicular{'s' * (made.perpendiculars != 1)}",
        ),
        numbers={"simple_folds": count, "perpendiculars": made.perpendiculars, "interrupted": made.interrupted},
        interrupted=made.interrupted,
        detail=made,
    )


def fold_simply(problem: Problem, tries: int = MOST_FOLDS_TRIED) -> Made:
    """Do as ``fold``; ``tries`` is how many folds may be tried."""
    laid, symmetry = problem.laid, problem.wishes.symmetry
    with problem.stages("simple folds", 0.7):
        found = sequences(laid.shape, laid.sheet, symmetry, tries)
    with problem.stages("folding paper"):
        return _best(problem, found)


def _best(problem: Problem, found: Sequence[tuple[Folds, Line]]) -> Made:
    """Return the best pattern of some sequences; raises ``UnfoldableError`` where none is verified."""
    made: list[Made] = []
    failures: list[str] = []
    for folds, cut in found:
        try:
            made.append(_made(problem, folds, cut))
        except UnfoldableError as error:
            failures.append(str(error))
    for one in sorted(made, key=_key):
        findings = verify(one.creases, one.folded.layers, one.laid.shape)
        low = _lowest(one.creases, one.folded, problem.sheet)
        if findings:
            failures.append(f"the pattern of the simple folds fails verification ({findings[0]})")
        elif one.ribbon > 0 and low <= one.ribbon:
            failures.append(f"simple folds meet {low:.2g} mm from the cut, within the ribbon of {one.ribbon:.6g} mm")
        else:
            return one
    raise UnfoldableError(failures[0])


def _key(made: Made) -> tuple[bool, float, int, float]:
    """Return what patterns are sorted by, the best first."""
    unfoldable, count, minus_shortest = rank(made.actions, shortest_crease(made.creases))
    return unfoldable, count, made.creases.crease_count, round(minus_shortest, 6)


def _made(problem: Problem, folds: Folds, cut: Line) -> Made:
    """Return the pattern of a sequence, of the shape made as symmetric as it takes it to be.

    Raises ``UnfoldableError`` where corners would have to move too far.
    """
    laid, count = problem.laid, len(folds)
    corners = np.concatenate(laid.shape.loops)
    tie = max(problem.wishes.symmetry, ROUNDING * float(np.ptp(corners, axis=0).max()))
    found = exactly(laid.shape, laid.sheet, folds, cut, tie)
    if found is None:
        raise UnfoldableError("the drawing cannot be made as symmetric as its simple folds take it to be")
    shape, folds, cut = found
    moved = float(np.hypot(*(np.concatenate(shape.loops) - corners).T).max())
    if moved > tie:
        raise UnfoldableError(
            f"the drawing is only nearly symmetric: simple folds would move its corners by up to {moved:.2g} mm; "
            f"allow it with --symmetry {math.ceil(moved * 100) / 100:g}mm"
        )
    return Made(
        "simple",
        *paper_folded(laid.sheet, folds, cut),
        _with_shape(laid, shape),
        problem.wishes.free_ribbon,
        actions=count,
        told=(f"simple: {count} simple fold{'s' * (count != 1)}, each through all layers",),
        numbers={"simple_folds": count},
    )


def _with_shape(laid: Laid, shape: Shape) -> Laid:
    """Return how a shape lies whose corners were moved; a note says how far, unless nobody could measure it."""
    moved = float(np.hypot(*(np.concatenate(shape.loops) - np.concatenate(laid.shape.loops)).T).max())
    if not moved:
        return laid
    notes = laid.notes
    if moved > COINCIDENT[0] * laid.sheet.diagonal:
        notes = (*notes, f"made symmetric: corners moved by at most {moved:.2g} mm")
    return replace(laid, shape=shape, notes=notes, drawn=shape, similarity=AS_IT_IS)


def _lowest(creases: CreasePattern, folded: FoldedState, sheet: Sheet) -> float:
    """Return how near to the cut creases meet, in mm."""
    size = np.array([sheet.width, sheet.height])
    tie = COINCIDENT[0] * sheet.diagonal
    inside = ((creases.vertices_coords > tie) & (creases.vertices_coords < size - tie)).all(axis=1)
    return float(np.abs(folded.vertices_coords[inside, 1]).min(initial=np.inf))


def paper_folded(sheet: Sheet, folds: Folds, cut: Line) -> tuple[CreasePattern, FoldedState]:
    """Return the pattern of a sheet that is folded along lines, one after another, and how it lies for the cut."""
    stack = flat_sheet(sheet)
    for line in folds:
        stack = stack.fold(line.origin, line.along, COINCIDENT[0] * sheet.diagonal)
    return stack.pattern(cut.origin, cut.along)
