"""The method ``mirror``: the sheet is folded along the drawing's mirror axes first, the rest through all layers."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape
from foldcut.drawing.laying import AS_IT_IS, Laid
from foldcut.geometry.mirror_axes import ROUNDING, mirror_axes, sheet_axes, symmetric
from foldcut.methods.base import Effort, Made, Problem, straight_folds
from foldcut.methods.compact.method import search_told
from foldcut.methods.frame import ADJUST, frame_scale
from foldcut.methods.mirror.halves import halves
from foldcut.methods.mirror.search import fold_mirrored
from foldcut.methods.mirror.unfold import Half
from foldcut.proof.tolerance import COINCIDENT

__all__ = ["fold"]

NEARLY = 0.01
"""Corners that are off by less than this, relative to the shape's size, are worth a hint."""


def fold(problem: Problem, effort: Effort) -> Made:
    """Fold a shape that has a mirror axis; the pattern is verified.

    Raises ``UnfoldableError`` where the shape has no axis, a loop does not meet it, or no pattern is found.
    """
    stages, ribbon = problem.stages, problem.wishes.free_ribbon
    with stages("mirror axes", 0.02):
        candidates = list(_candidates(problem))
    with stages("searching half"):
        made = fold_mirrored(
            [half for half, _ in candidates],
            ribbon=ribbon,
            near=ADJUST * frame_scale(problem.laid) if problem.wishes.adjust is None else problem.wishes.adjust,
            effort=effort.name,
            seconds=effort.seconds,
            goal=effort.goal,
            progress=stages.tell,
        )
    half, found = made.half, made.found
    laid = next(laid for candidate, laid in candidates if candidate is made.candidate)
    if made.moved > COINCIDENT[0] * laid.sheet.diagonal:
        notes = (*laid.notes, f"corners moved by at most {made.moved:.2g} mm, so that creases meet")
        laid = replace(laid, shape=half.shape, notes=notes)
    return Made(
        "mirror",
        made.creases,
        made.folded,
        laid,
        ribbon,
        actions=len(half.axes) + straight_folds(found.part),
        told=search_told("mirror", found.tried, interrupted=found.interrupted),
        numbers={"tried": found.tried, "interrupted": found.interrupted},
        first_folds=half.first_folds,
        regions=made.regions,
        interrupted=found.interrupted,
        detail=made,
    )


def _candidates(problem: Problem) -> Iterator[tuple[Half, Laid]]:
    """Yield the halves of the sheet by which the shape can be folded, and how the shape lies for each."""
    wishes = problem.wishes
    refused = ""
    found = False
    for turn, axes in sheet_axes(problem.shape, wishes.symmetry, may_turn=problem.may_turn):
        on = problem.lay(turn) if turn else problem.laid
        if on.quarter != problem.laid.quarter:
            axes = tuple(1 - axis for axis in axes)
        middle = np.array([on.sheet.width, on.sheet.height]) / 2
        shape, moved = symmetric(on.shape, middle, axes)
        if moved > max(wishes.symmetry, ROUNDING * on.sheet.diagonal):
            refused = "the drawing's mirror axis is not in the middle of the sheet; leave out --offset and --rotate"
            continue
        notes = on.notes
        if moved > COINCIDENT[0] * on.sheet.diagonal:
            notes = (*notes, f"made symmetric: corners moved by at most {moved:.2g} mm")
        on = Laid(on.sheet, shape, on.placement, notes, on.quarter, shape, AS_IT_IS)
        try:
            for half in halves(shape, on.sheet, axes):
                found = True
                yield half, on
        except UnfoldableError as error:
            refused = str(error)
    if not found:
        raise UnfoldableError(refused or _no_axis(problem.shape, wishes.symmetry))


def _no_axis(shape: Shape, symmetry: float) -> str:
    """Say why a shape on the sheet has no axis to fold along, or how near it comes to having one, in mm."""
    if mirror_axes(shape, symmetry):
        return "no mirror axis of the drawing lies along the sheet; leave out --offset and --rotate"
    near = mirror_axes(shape, NEARLY * float(np.ptp(np.concatenate(shape.loops), axis=0).max()))
    if not near:
        return f"the drawing is not mirror-symmetric{f' within {symmetry:g} mm' if symmetry else ''}"
    off = min(axis.deviation for axis in near)
    return (
        f"the drawing is not mirror-symmetric, but nearly: corners are {off:.2g} mm off; "
        f"make it so with --symmetry {math.ceil(off * 100) / 100:g}mm"
    )
