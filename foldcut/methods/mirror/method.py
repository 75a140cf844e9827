"""The method ``mirror``: the sheet is folded along the drawing's mirror axes first, the rest through all layers.

The part that is left, a half, a quarter or a wedge, is folded along its straight skeleton, and by the method
``compact``; the easier pattern is taken. The shape is laid in all ways in which one of its axes or two lie along the
sheet, and if it has three axes or more through one point, so that these are all folded first. Each of these ways gets a
quick look at its straight skeleton, and the best ones a search.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import chain
from typing import Protocol

import numpy as np

from foldcut.core.errors import BadInputError, UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.drawing.laying import AS_IT_IS, Laid
from foldcut.geometry.dihedral import Dihedral, dihedral, made_dihedral, turns_of
from foldcut.geometry.mirror_axes import ROUNDING, mirror_axes, sheet_axes, symmetric
from foldcut.geometry.partial_symmetry import partial_axis
from foldcut.methods.base import Effort, Made, Problem, straight_folds
from foldcut.methods.compact.method import search_told
from foldcut.methods.frame import ADJUST, Frame, frame_scale, frames, in_frame
from foldcut.methods.mirror.halves import CLOSED, closed_wedge, halves_of, one_loop_halves, one_loop_wedges
from foldcut.methods.mirror.search import fold_mirrored
from foldcut.methods.mirror.skeletal import (
    fold_part,
    made_of_half,
    made_of_wedge,
    search_half,
    search_wedge,
)
from foldcut.methods.mirror.wedge import Part, Wedge
from foldcut.methods.progress import Progress
from foldcut.methods.skeleton.search import SECONDS
from foldcut.methods.skeleton.trial import Skeletal
from foldcut.pattern.first_folds import FEWEST_OF_WEDGE, layers_after
from foldcut.pattern.foldability import crease_numbers
from foldcut.pattern.ranking import FOLDABLE_MM, Rank, rank, shortest_crease
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

TILTS = (1 / 4, 1 / 3, 1 / 2, 1 / 6)
"""How far wedges are turned, in parts of their angle, where creases are short with an axis along the sheet."""

WORSE = 1.5
"""A way to lay the shape is not searched further if its first pattern has more folds than this many times the best."""


class _Way(Protocol):
    """A way to lay the shape and to fold some of its mirror axes first; ``laid.shape`` is symmetric about these."""

    @property
    def laid(self) -> Laid:
        """The shape on its sheet."""

    def look(self, frame: Frame, ribbon: float) -> Rank:
        """Return the rank of a pattern found soon; raises ``UnfoldableError`` where none is."""

    def search(self, frame: Frame, *, near: float, ribbon: float, seconds: float, progress: Progress) -> Skeletal:
        """Return the best pattern of a search, as ``search_half`` does."""

    def one_loop_parts(self) -> Iterator[Part]:
        """Yield what is left of the sheet, with single loops to fold it by, as ``one_loop_halves`` does."""

    def made(self, found: Skeletal, laid: Laid, ribbon: float) -> Made:
        """Return what the method made, ``found`` being the pattern of the whole sheet."""


@dataclass(frozen=True, eq=False)
class _AlongSheet:
    """A way to lay the shape with mirror ``axes`` along the sheet: 0 is its upright middle line, 1 the level one."""

    laid: Laid
    axes: tuple[int, ...]

    def shape(self, frame: Frame) -> Shape:
        """Return the shape of a frame of the laid shape: symmetric, too, without rounding errors."""
        return symmetric(frame.shape, np.array([frame.sheet.width, frame.sheet.height]) / 2, self.axes)[0]

    def look(self, frame: Frame, ribbon: float) -> Rank:
        half = next(halves_of(self.shape(frame), frame.sheet, self.axes))
        found = fold_part(half, ribbon=ribbon)
        return rank(len(self.axes) + crease_numbers(found.part).lines, shortest_crease(found.creases))

    def search(self, frame: Frame, *, near: float, ribbon: float, seconds: float, progress: Progress) -> Skeletal:
        shape = self.shape(frame)
        return search_half(shape, frame.sheet, self.axes, near=near, ribbon=ribbon, seconds=seconds, progress=progress)

    def one_loop_parts(self) -> Iterator[Part]:
        return one_loop_halves(self.laid.shape, self.laid.sheet, self.axes)

    def made(self, found: Skeletal, laid: Laid, ribbon: float) -> Made:
        return made_of_half(self.axes, found, laid, ribbon=ribbon)


@dataclass(frozen=True, eq=False)
class _Around:
    """A way to lay the shape with three ``axes`` or more through one point.

    ``near``: whether loops are closed near to the wedge's last border and to its first one (``closed_wedge``), None for
    the loops of the whole shape.
    """

    laid: Laid
    axes: Dihedral
    near: tuple[bool, bool] | None = None

    def loops(self, frame: Frame) -> Wedge:
        """Return the wedge of a frame's sheet, with the loops to fold it by."""
        whole = self.wedge(frame.shape, frame.sheet)
        closed = closed_wedge(whole, self.near)
        if closed is None:
            raise UnfoldableError("the shape cannot be cut off at the wedge's borders")
        return closed

    def wedge(self, shape: Shape, sheet: Sheet) -> Wedge:
        """Return a sector of a sheet with a shape that is as the laid one, but for its size and its place."""
        exact = made_dihedral(shape, self.axes)
        if exact is None:
            raise UnfoldableError("the drawing's mirror axes do not agree")
        return Wedge.of(exact[0], sheet, exact[1], self.axes.count, self.axes.first)

    def look(self, frame: Frame, ribbon: float) -> Rank:
        wedge = self.loops(frame)
        found = fold_part(wedge, ribbon=ribbon)
        return rank(wedge.fold_count + crease_numbers(found.part).lines, shortest_crease(found.creases))

    def search(self, frame: Frame, *, near: float, ribbon: float, seconds: float, progress: Progress) -> Skeletal:
        wedge = self.loops(frame)
        return search_wedge(wedge, near=near, ribbon=ribbon, seconds=seconds, progress=progress)

    def one_loop_parts(self) -> Iterator[Part]:
        if self.near is None:
            yield from one_loop_wedges(self.wedge(self.laid.shape, self.laid.sheet))

    def made(self, found: Skeletal, laid: Laid, ribbon: float) -> Made:
        return made_of_wedge(self.wedge(laid.shape, laid.sheet), found, laid, ribbon=ribbon)


def fold(problem: Problem, effort: Effort) -> Made:
    """Fold a shape that has a mirror axis; the pattern is verified.

    Raises ``UnfoldableError`` where the shape has no axis, or no pattern is found.
    """
    stages, made, failed = problem.stages, list[Made](), list[str]()
    with stages("mirror axes", 0.02):
        ways = _ways(problem)
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
    corners = made.laid.shape.corner_count / layers_after(made.first_folds)
    return not key.unfoldable and key.creases <= FEW * corners


def _along_skeleton(problem: Problem, effort: Effort, ways: Sequence[_Way]) -> Made:
    """Fold the half, or another part, along its straight skeleton.

    If the best pattern of a wedge has short creases, it is also laid so that none of its axes lies along the sheet, and
    its loops are closed in other ways, until there is a pattern without.
    """
    ranked = _looks(problem, ways)
    finalists = [number for key, number in ranked if key.creases <= WORSE * ranked[0][0].creases][:FINALISTS] or [0]
    seconds = SKELETON_PART * effort.share * (SECONDS[effort.name] if effort.seconds is None else effort.seconds)
    made: list[Made] = []
    problems: list[UnfoldableError] = []
    scale = frame_scale(problem.laid)

    def others() -> Iterator[_Way]:
        if effort.name != "fast" and isinstance(ways[0], _Around):
            yield from (way for number, way in enumerate(ways) if isinstance(way, _Around) and number not in finalists)
            yield from _tilted(problem)

    for done, way in enumerate(chain((ways[number] for number in finalists), others())):
        is_other = done >= len(finalists)
        if is_other and made and max(shortest_crease(one.creases) for one in made) >= FOLDABLE_MM * scale:
            break

        def tell(text: str, part: float, before: int = min(done, len(finalists) - 1)) -> None:
            problem.stages.tell(f"half of the sheet: {text}", (before + part) / len(finalists))

        try:
            made.append(_searched(problem, way, seconds / len(finalists), tell, retry=bool(ranked) and not is_other))
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
    best = min(made, key=lambda one: rank(one.actions, shortest_crease(one.creases) / scale))
    return replace(best, interrupted=made[-1].interrupted)


def _looks(problem: Problem, ways: Sequence[_Way]) -> list[tuple[Rank, int]]:
    """Return the ranks of what a quick look finds, and the numbers of the ways, the best first."""
    ranked: list[tuple[Rank, int]] = []
    for number, way in enumerate(ways):
        frame = next(frames(way.laid))
        with suppress(UnfoldableError):
            ranked.append((way.look(frame, problem.wishes.free_ribbon / frame.scale), number))
    return sorted(ranked)


def _searched(problem: Problem, way: _Way, seconds: float, tell: Progress, *, retry: bool) -> Made:
    """Return the best pattern that a search along the straight skeleton finds for one way to lay the shape.

    With ``retry``, larger frames are tried, too, where there is none (see ``in_frame``).
    """
    wishes, laid = problem.wishes, way.laid

    def in_this(frame: Frame) -> Made:
        ribbon = wishes.free_ribbon / frame.scale
        near = ADJUST if wishes.adjust is None else wishes.adjust / frame.scale
        found = way.search(frame, near=near, ribbon=ribbon, seconds=seconds, progress=tell)
        creases, folded = frame.pattern(found.creases, found.folded, found.shape)
        moved, notes = found.moved_mm * frame.scale, laid.notes
        if moved > COINCIDENT[0] * laid.sheet.diagonal:
            notes = (*notes, f"corners moved by at most {moved:.2g} mm, so that creases meet")
        on = replace(laid, shape=frame.on_sheet(found.shape), notes=notes)
        found = replace(found, creases=creases, folded=folded, shape=on.shape, moved_mm=moved)
        return way.made(found, on, wishes.free_ribbon)

    return in_frame(laid, in_this, retry=retry)


def _compact(problem: Problem, effort: Effort, ways: Sequence[_Way]) -> Made:
    """Fold the half by the method ``compact``."""
    ribbon = problem.wishes.free_ribbon
    candidates: list[tuple[Part, Laid]] = []
    refused = ""
    for way in ways:
        try:
            candidates += [(part, way.laid) for part in way.one_loop_parts()]
        except UnfoldableError as error:
            refused = str(error)
    if not candidates:
        raise UnfoldableError(refused or "the loops cannot be joined to one beyond the mirror axes")
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
        actions=half.fold_count + straight_folds(found.part),
        told=search_told("mirror", found.tried, interrupted=found.interrupted),
        numbers={"tried": found.tried, "interrupted": found.interrupted},
        first_folds=half.first_folds,
        regions=made.regions,
        interrupted=found.interrupted,
        detail=made,
    )


def _ways(problem: Problem) -> list[_Way]:
    """Return how the shape can be laid, first with all of its axes through one point if these are more than two.

    Raises ``UnfoldableError`` where it has no axis that can be folded first.
    """
    ways: list[_Way] = []
    around = _all_axes(problem)
    if around is not None:
        ways += [replace(around, near=near) for near in CLOSED]
    try:
        ways += _along_sheet(problem)
    except UnfoldableError:
        if not ways:
            raise
    return ways


def _tilted(problem: Problem) -> list[_Way]:
    """Return ways in which none of three axes or more lies along the sheet, so that creases end elsewhere at its edge.

    Turned by the angle between two axes, or less by as much, the shape would lie as before.
    """
    ways: list[_Way] = []
    for part in TILTS if problem.may_turn else ():
        around = _all_axes(problem, part)
        if around is not None:
            ways += [replace(around, near=near) for near in CLOSED]
    return ways


def _all_axes(problem: Problem, tilt: float = 0.0) -> _Around | None:
    """Return how the shape lies with three axes or more to be folded first, None if it has not so many.

    Unless it may not be turned, one axis lies along the sheet, or ``tilt`` off that, in parts of the angle between two.
    """
    allowed = problem.wishes.axes_off(float(np.ptp(np.concatenate(problem.shape.loops), axis=0).max()))
    found = dihedral(problem.shape, allowed)
    if found is None or found.count < FEWEST_OF_WEDGE:
        return None
    on, turn = problem.laid, found.upright_turn if problem.may_turn else 0.0
    turn += tilt * math.pi / found.count
    if turn:
        try:
            on = problem.lay(math.degrees(turn))
            found = found.turned(turn)
        except BadInputError:  # at the size that is asked for, it does not fit on the sheet like this
            if tilt:
                return None
    if on.quarter != problem.laid.quarter:
        found = found.turned(math.pi / 2)
    exact = made_dihedral(on.shape, found)
    if exact is None or exact[2] > max(allowed, ROUNDING * on.sheet.diagonal):
        return None
    notes = on.notes
    if tilt:
        why = f"turned by {math.degrees(turn):.4g} degrees, so that creases are longer at the sheet's edge"
        notes = (why, *notes[1:])
    if exact[2] > COINCIDENT[0] * on.sheet.diagonal:
        notes = (*notes, f"made symmetric: corners moved by at most {exact[2]:.2g} mm")
    return _Around(Laid(on.sheet, exact[0], on.placement, notes, on.quarter, exact[0], AS_IT_IS), found)


def _along_sheet(problem: Problem) -> Iterator[_AlongSheet]:
    """Yield how the shape can be laid with mirror axes along the sheet.

    Raises ``UnfoldableError`` where it cannot.
    """
    wishes = problem.wishes
    refused = ""
    found = False
    for turn, axes in sheet_axes(problem.shape, wishes.symmetry, may_turn=problem.may_turn):
        try:
            on = problem.lay(turn) if turn else problem.laid
        except BadInputError as error:  # at the size that is asked for, it does not fit on the sheet like this
            refused = str(error)
            continue
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
        yield _AlongSheet(Laid(on.sheet, shape, on.placement, notes, on.quarter, shape, AS_IT_IS), axes)
    if not found:
        raise UnfoldableError(refused or _no_axis(problem.shape, wishes.symmetry))


def _no_axis(shape: Shape, symmetry: float) -> str:
    """Say why a shape on the sheet has no axis to fold along, or how near it comes to having one, in mm."""
    if mirror_axes(shape, symmetry):
        return "no mirror axis of the drawing lies along the sheet; leave out --offset and --rotate"
    near = mirror_axes(shape, NEARLY * float(np.ptp(np.concatenate(shape.loops), axis=0).max()))
    if not near:
        within = f" within {symmetry:.3g} mm" if symmetry else ""
        return f"the drawing is not mirror-symmetric{within}{_instead_of_axis(shape, symmetry)} use another method"
    off = min(axis.deviation for axis in near)
    return (
        f"the drawing is not mirror-symmetric, but nearly: corners are {off:.2g} mm off; "
        f"make it so with --symmetry {math.ceil(off * 100) / 100:g}mm"
    )


def _instead_of_axis(shape: Shape, symmetry: float) -> str:
    """Say what a shape on the sheet without a mirror axis has instead: turns, or an axis for most of it.

    The text ends where a remedy can follow.
    """
    turns = turns_of(shape, symmetry)
    if turns > 1:
        return f"; {turns} equal turns bring it onto itself, but without an axis nothing can be folded first;"
    most = partial_axis(shape)
    if most is None:
        return ";"
    x, y = most.place
    rest = f"{max(round(100 * (1 - most.share)), 1)}% of its outline"
    where = f"the axis at {math.degrees(most.angle):.4g} degrees through ({x:.4g}, {y:.4g}) mm"
    off = f"up to {most.off:.2g} mm off"
    return f", but all except {rest} is so about {where}; draw the rest, which is {off}, alike, or"
