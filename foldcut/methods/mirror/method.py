"""The method ``mirror``: the sheet is folded along the drawing's mirror axes first, the rest through all layers.

The half that is left is folded along its straight skeleton, and by the method ``compact``; the easier pattern is taken.
The shape is laid in all ways in which its axes lie along the sheet. Each of them gets a quick look at its straight
skeleton, and the best ones a search.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape
from foldcut.drawing.laying import AS_IT_IS, Laid
from foldcut.geometry.mirror_axes import ROUNDING, mirror_axes, sheet_axes, symmetric
from foldcut.methods.base import Effort, Made, Problem, straight_folds
from foldcut.methods.compact.method import search_told
from foldcut.methods.frame import ADJUST, Frame, frame_scale, frames, in_frame
from foldcut.methods.mirror.halves import halves_of, one_loop_halves
from foldcut.methods.mirror.search import fold_mirrored
from foldcut.methods.mirror.skeletal import fold_half, made_of_half, search_half
from foldcut.methods.mirror.unfold import Half
from foldcut.methods.progress import Progress
from foldcut.methods.skeleton.search import SECONDS
from foldcut.methods.skeleton.trial import Skeletal
from foldcut.pattern.foldability import crease_numbers
from foldcut.pattern.ranking import Rank, rank, shortest_crease
from foldcut.proof.tolerance import COINCIDENT

__all__ = ["fold"]

NEARLY = 0.01
"""Corners that are off by less than this, relative to the shape's size, are worth a hint."""

SKELETON_PART = 0.3
"""The part of the effort for all searches along straight skeletons."""

COMPACT_PART = 0.3
"""The part of the effort for the method ``compact`` once there is a pattern."""

FEW = 2.0
"""With no more folds than this for each corner of the half, ``compact``, which makes more, is not tried any more."""

FINALISTS = 2
"""How many ways to lay the shape are searched further."""

WORSE = 1.5
"""A way to lay the shape is not searched further if its first pattern has more folds than this many times the best."""


@dataclass(frozen=True, eq=False)
class _Way:
    """A way to lay the shape with its mirror ``axes`` along the sheet; ``laid.shape`` is symmetric about these."""

    laid: Laid
    axes: tuple[int, ...]

    def shape(self, frame: Frame) -> Shape:
        """Return the shape of a frame of the laid shape: symmetric, too, without rounding errors."""
        return symmetric(frame.shape, np.array([frame.sheet.width, frame.sheet.height]) / 2, self.axes)[0]


def fold(problem: Problem, effort: Effort) -> Made:
    """Fold a shape that has a mirror axis; the pattern is verified.

    Raises ``UnfoldableError`` where the shape has no axis, or no pattern is found.
    """
    stages, made, failed = problem.stages, list[Made](), list[str]()
    with stages("mirror axes", 0.02):
        ways = list(_ways(problem))
    interrupted = False
    with stages("straight skeleton of half", 0.4):
        try:
            made.append(_along_skeleton(problem, effort, ways))
        except UnfoldableError as error:
            failed.append(str(error))
    scale, rest, is_done = frame_scale(problem.laid), effort, False
    if made:
        shortest = shortest_crease(made[0].creases) / scale
        key = rank(made[0].actions, shortest)
        goal = replace(effort.goal, beat=min(key, effort.goal.beat or key))
        rest = replace(effort.part(COMPACT_PART), goal=goal)
        is_done = made[0].interrupted or goal.is_reached(made[0].actions, shortest) or _has_few_folds(made[0], key)
    if not is_done:
        with stages("searching half"):
            try:
                made.append(_compact(problem, rest, ways))
            except UnfoldableError as error:
                failed.append(str(error))
            except KeyboardInterrupt:
                if not made:
                    raise
                interrupted = True
    if not made:
        raise UnfoldableError("; ".join(dict.fromkeys(failed)))
    best = min(made, key=lambda one: rank(one.actions, shortest_crease(one.creases) / scale))
    return replace(best, interrupted=interrupted or any(one.interrupted for one in made))


def _has_few_folds(made: Made, key: Rank) -> bool:
    corners = made.laid.shape.corner_count / 2 ** len(made.first_folds)
    return not key.unfoldable and key.creases <= FEW * corners


def _along_skeleton(problem: Problem, effort: Effort, ways: Sequence[_Way]) -> Made:
    """Fold the half along its straight skeleton."""
    ranked: list[tuple[Rank, int]] = []
    for number, way in enumerate(ways):
        frame = next(frames(way.laid))
        with suppress(UnfoldableError):
            half = next(halves_of(way.shape(frame), frame.sheet, way.axes))
            ranked.append((_rank(half, fold_half(half, ribbon=problem.wishes.free_ribbon / frame.scale)), number))
    ranked.sort()
    finalists = [number for key, number in ranked if key.creases <= WORSE * ranked[0][0].creases][:FINALISTS] or [0]
    seconds = SKELETON_PART * effort.share * (SECONDS[effort.name] if effort.seconds is None else effort.seconds)
    made: list[Made] = []
    problems: list[UnfoldableError] = []
    for done, number in enumerate(finalists):

        def tell(text: str, part: float, before: int = done) -> None:
            problem.stages.tell(f"half of the sheet: {text}", (before + part) / len(finalists))

        try:
            made.append(_searched(problem, ways[number], seconds / len(finalists), tell, retry=bool(ranked)))
        except UnfoldableError as error:
            problems.append(error)
        except KeyboardInterrupt:
            if not made:
                raise
            made[-1] = replace(made[-1], interrupted=True)
        if made and made[-1].interrupted:
            break
    if not made:
        raise problems[0]
    scale = frame_scale(problem.laid)
    best = min(made, key=lambda one: rank(one.actions, shortest_crease(one.creases) / scale))
    return replace(best, interrupted=made[-1].interrupted)


def _rank(half: Half, found: Skeletal) -> Rank:
    return rank(len(half.axes) + crease_numbers(found.part).lines, shortest_crease(found.creases))


def _searched(problem: Problem, way: _Way, seconds: float, tell: Progress, *, retry: bool) -> Made:
    """Return the best pattern that a search along the straight skeleton finds for one way to lay the shape.

    With ``retry``, larger frames are tried, too, where there is none (see ``in_frame``).
    """
    wishes, laid = problem.wishes, way.laid

    def in_this(frame: Frame) -> Made:
        ribbon = wishes.free_ribbon / frame.scale
        near = ADJUST if wishes.adjust is None else wishes.adjust / frame.scale
        shape = way.shape(frame)
        found = search_half(shape, frame.sheet, way.axes, near=near, ribbon=ribbon, seconds=seconds, progress=tell)
        creases, folded = frame.pattern(found.creases, found.folded, found.shape)
        moved, notes = found.moved_mm * frame.scale, laid.notes
        if moved > COINCIDENT[0] * laid.sheet.diagonal:
            notes = (*notes, f"corners moved by at most {moved:.2g} mm, so that creases meet")
        on = replace(laid, shape=frame.on_sheet(found.shape), notes=notes)
        found = replace(found, creases=creases, folded=folded, shape=on.shape, moved_mm=moved)
        return made_of_half(way.axes, found, on, ribbon=wishes.free_ribbon)

    return in_frame(laid, in_this, retry=retry)


def _compact(problem: Problem, effort: Effort, ways: Sequence[_Way]) -> Made:
    """Fold the half by the method ``compact``."""
    ribbon = problem.wishes.free_ribbon
    candidates: list[tuple[Half, Laid]] = []
    refused = ""
    for way in ways:
        try:
            candidates += [(half, way.laid) for half in one_loop_halves(way.laid.shape, way.laid.sheet, way.axes)]
        except UnfoldableError as error:
            refused = str(error)
    if not candidates:
        raise UnfoldableError(refused)
    made = fold_mirrored(
        [half for half, _ in candidates],
        ribbon=ribbon,
        effort=effort.name,
        seconds=effort.seconds,
        whole=effort.share,
        goal=effort.goal,
        progress=problem.stages.tell,
    )
    half, laid = next(one for one in candidates if one[0] is made.half)
    found = made.found
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


def _ways(problem: Problem) -> Iterator[_Way]:
    """Yield how the shape can be laid with mirror axes along the sheet.

    Raises ``UnfoldableError`` where it cannot.
    """
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
        found = True
        yield _Way(Laid(on.sheet, shape, on.placement, notes, on.quarter, shape, AS_IT_IS), axes)
    if not found:
        raise UnfoldableError(refused or _no_axis(problem.shape, wishes.symmetry))


def _no_axis(shape: Shape, symmetry: float) -> str:
    """Say why a shape on the sheet has no axis to fold along, or how near it comes to having one, in mm."""
    if mirror_axes(shape, symmetry):
        return "no mirror axis of the drawing lies along the sheet; leave out --offset and --rotate"
    near = mirror_axes(shape, NEARLY * float(np.ptp(np.concatenate(shape.loops), axis=0).max()))
    if not near:
        return f"the drawing is not mirror-symmetric{f' within {symmetry:.3g} mm' if symmetry else ''}"
    off = min(axis.deviation for axis in near)
    return (
        f"the drawing is not mirror-symmetric, but nearly: corners are {off:.2g} mm off; "
        f"make it so with --symmetry {math.ceil(off * 100) / 100:g}mm"
    )
