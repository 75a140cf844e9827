"""The method ``skeleton``: any loops with few creases, along the straight skeleton."""

from __future__ import annotations

from dataclasses import replace

from foldcut.core.model import Shape
from foldcut.drawing.laying import Laid
from foldcut.methods.base import Effort, Made, Problem, straight_folds
from foldcut.methods.frame import ADJUST, Frame, in_frame
from foldcut.methods.skeleton.graphs import fold_graph
from foldcut.methods.skeleton.search import Skeletal, fold_ridges, fold_skeletal
from foldcut.pattern.cut_line import sides_of_lines
from foldcut.proof.tolerance import COINCIDENT

__all__ = ["fold", "fold_ridges_alone", "made_of_whole"]

STAGE = "straight skeleton"


def fold(problem: Problem, effort: Effort) -> Made:
    """Fold a shape along its straight skeleton and some of the perpendiculars to its sides; the pattern is verified.

    Raises ``UnfoldableError`` where perpendiculars do not end, creases are too many, or none of the choices that are
    tried has a layer order.
    """

    def graph_in(frame: Frame) -> Made:
        ribbon = problem.wishes.free_ribbon / frame.scale
        made = fold_graph(
            frame.shape,
            frame.sheet,
            ribbon=ribbon,
            effort=effort.name,
            seconds=effort.seconds,
            progress=problem.stages.tell,
        )
        return _made(problem, frame, made)

    def in_this(frame: Frame) -> Made:
        made = fold_skeletal(
            frame.shape,
            frame.sheet,
            ribbon=problem.wishes.free_ribbon / frame.scale,
            near=_near(problem, frame),
            effort=effort.name,
            seconds=effort.seconds,
            share=effort.share,
            progress=problem.stages.tell,
        )
        return _made(problem, frame, made)

    with problem.stages(STAGE):
        return in_frame(problem.laid, graph_in if problem.shape.is_graph else in_this)


def fold_ridges_alone(problem: Problem) -> Made:
    """Fold a shape along the ridges of its straight skeleton alone; the pattern is verified.

    Raises ``UnfoldableError`` where this needs perpendiculars, too, or has no layer order.
    """

    def in_this(frame: Frame) -> Made:
        ribbon = problem.wishes.free_ribbon / frame.scale
        return _made(problem, frame, fold_ridges(frame.shape, frame.sheet, ribbon=ribbon, near=_near(problem, frame)))

    with problem.stages(STAGE):
        return in_frame(problem.laid, in_this)


def _near(problem: Problem, frame: Frame) -> float:
    """Return how far corners may be moved, in mm of the frame."""
    adjust = problem.wishes.adjust
    return ADJUST if adjust is None else adjust / frame.scale


def _made(problem: Problem, frame: Frame, made: Skeletal) -> Made:
    laid = problem.laid
    notes, moved = laid.notes, made.moved_mm * frame.scale
    if moved > COINCIDENT[0] * laid.sheet.diagonal:
        notes = (*notes, f"corners moved by at most {moved:.2g} mm, so that creases meet")
    creases, folded = frame.pattern(made.creases, made.folded, made.shape)
    laid = replace(laid, shape=frame.on_sheet(made.shape), notes=notes)
    ribbon = problem.wishes.free_ribbon
    whole = made_of_whole(replace(made, creases=creases, folded=folded), laid, ribbon=ribbon, moved_mm=moved)
    return replace(whole, told=(*whole.told, *_told_of_lines(laid.shape)))


def _told_of_lines(shape: Shape) -> tuple[str, ...]:
    """Say how to cut where the paper is folded along lines of a graph."""
    if not shape.lines:
        return ()
    inside = sides_of_lines(shape)
    count = sum(len(line) - 1 for line in shape.lines)
    of = f"{count} of the lines to cut {'are' if count > 1 else 'is'} folded on the cut line"
    if inside.any() and not inside.all():
        return (f"{of}, with paper on both sides of it: cut exactly along the folds",)
    side = "above" if inside.all() else "below"
    return (f"{of}, with paper {side} it: cut along the folds or a hair {side} them, which takes off a rim that thin",)


def made_of_whole(found: Skeletal, laid: Laid, *, ribbon: float = 0.0, moved_mm: float) -> Made:
    """Return what the method made of a shape: ``found`` is the pattern of its sheet, ``laid`` how it lies there.

    ``ribbon`` and ``moved_mm``, how far corners were moved at most, are in mm.
    """
    count = found.perpendiculars
    return Made(
        "skeleton",
        found.creases,
        found.folded,
        laid,
        ribbon,
        straight_folds(found.creases),
        told=(f"skeleton: {count} perpendicular{'s' * (count != 1)}",),
        numbers={"perpendiculars": count, "moved_mm": moved_mm},
        interrupted=found.interrupted,
        detail=found,
    )
