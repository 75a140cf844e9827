"""The method ``skeleton``: any loops with few creases, along the straight skeleton."""

from __future__ import annotations

from dataclasses import replace

from foldcut.methods.base import Effort, Made, Problem, straight_folds
from foldcut.methods.skeleton.search import Skeletal, fold_ridges, fold_skeletal
from foldcut.proof.tolerance import COINCIDENT

__all__ = ["fold", "fold_ridges_alone"]

STAGE = "straight skeleton"


def fold(problem: Problem, effort: Effort) -> Made:
    """Fold a shape along its straight skeleton and some of the perpendiculars to its sides; the pattern is verified.

    Raises ``UnfoldableError`` where perpendiculars do not end, creases are too many, or none of the choices that are
    tried has a layer order.
    """
    wishes = problem.wishes
    with problem.stages(STAGE):
        made = fold_skeletal(
            problem.shape,
            problem.sheet,
            ribbon=wishes.free_ribbon,
            near=wishes.adjust,
            effort=effort.name,
            seconds=effort.seconds,
            share=effort.share,
            progress=problem.stages.tell,
        )
    return _made(problem, made)


def fold_ridges_alone(problem: Problem) -> Made:
    """Fold a shape along the ridges of its straight skeleton alone; the pattern is verified.

    Raises ``UnfoldableError`` where this needs perpendiculars, too, or has no layer order.
    """
    wishes = problem.wishes
    with problem.stages(STAGE):
        made = fold_ridges(problem.shape, problem.sheet, ribbon=wishes.free_ribbon, near=wishes.adjust)
        return _made(problem, made)


def _made(problem: Problem, made: Skeletal) -> Made:
    laid = problem.laid
    notes = laid.notes
    if made.moved_mm > COINCIDENT[0] * laid.sheet.diagonal:
        notes = (*notes, f"corners moved by at most {made.moved_mm:.2g} mm, so that creases meet")
    count = made.perpendiculars
    return Made(
        "skeleton",
        made.creases,
        made.folded,
        replace(laid, shape=made.shape, notes=notes),
        problem.wishes.free_ribbon,
        straight_folds(made.creases),
        told=(f"skeleton: {count} perpendicular{'s' * (count != 1)}",),
        numbers={"perpendiculars": count, "moved_mm": made.moved_mm},
        interrupted=made.interrupted,
        detail=made,
    )
