"""``auto``: which methods are tried, in which order, and whose pattern is taken.

``TRIES`` is the table. Of all patterns that are made the one that is easiest to fold is taken (``pattern.ranking``).
"paper" and "gate" are not in it: their patterns have thousands of folds, and are made only where they are asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from foldcut.core.errors import UnfoldableError
from foldcut.methods import AUTO, METHODS
from foldcut.methods.base import Effort, Made, Problem
from foldcut.methods.fewest_folds import Fewest, fewest_folds
from foldcut.methods.frame import ADJUST, frame_scale
from foldcut.pattern.foldability import COMFORTABLE_LAYERS, layers_at_cut
from foldcut.pattern.ranking import FOLDABLE_MM, Goal, rank, shortest_crease

__all__ = ["FOLDED", "Attempt", "run"]

FOLDED = 0.98
"""The part of the whole progress, from 0 to 1, that is reached once there is a pattern; the rest is verification."""

AFTER_OTHERS = 0.3
"""The part of the effort that a method gets when another one has made a pattern."""

SMALL = 6
"""Patterns with no more folds than this are found so soon that all methods are tried."""

SOON = 300
"""How many simple folds are tried, in about half a second."""

FEW_CORNERS = 100
"""Simple folds are tried for drawings with at most this many corners."""

USUAL = 2.0
"""Straight skeletons of a whole sheet have folds on at least this many lines for each that bisects a corner, unless
many of their ridges are in line."""


@dataclass(frozen=True)
class Attempt:
    """What came of a method: how many creases and folding actions, the shortest crease in mm, or why it failed."""

    method: str
    creases: int | None
    actions: int | None
    shortest_mm: float | None
    failure: str


def run(method: str, problem: Problem, effort: Effort) -> tuple[Made, tuple[Attempt, ...]]:
    """Return what a method makes, or with ``auto`` the best of what several make, and what came of each.

    Raises ``UnfoldableError`` with the reason of each that was tried where none makes a pattern.
    """
    if method == AUTO and problem.shape.is_graph:
        method = next(name for name, row in METHODS.items() if row.graphs)
    if method == AUTO:
        return _best(problem, effort)
    problem.stages.up_to(FOLDED)
    made = METHODS[method].fold(problem, effort)
    return made, (_attempt(made),)


def _best(problem: Problem, effort: Effort) -> tuple[Made, tuple[Attempt, ...]]:
    """Go through the table of tries."""
    made: list[Made] = []
    attempts: list[Attempt] = []
    interrupted = False
    scale = frame_scale(problem.laid)
    effort = replace(effort, goal=Goal(enough=_fewest(problem).folds))
    for row in TRIES:
        if not row.when(problem) or (made and row.unless(problem, made)):
            continue
        problem.stages.up_to(row.until)
        try:
            one = row.fold(problem, effort.part(AFTER_OTHERS) if made else effort)
        except UnfoldableError as error:
            if not row.unsaid:
                attempts.append(Attempt(row.method, None, None, None, str(error)))
            continue
        except KeyboardInterrupt:
            if not made:
                raise
            interrupted = True
            break
        made.append(one)
        attempts.append(_attempt(one))
        interrupted = one.interrupted
        shortest = shortest_crease(one.creases) / scale
        if row.is_best(problem, one) or interrupted or effort.goal.is_reached(one.actions, shortest):
            break
        beat = rank(one.actions, shortest)
        if effort.goal.beat is None or beat < effort.goal.beat:
            effort = replace(effort, goal=replace(effort.goal, beat=beat))
    if not made:
        raise UnfoldableError("; ".join(f"{attempt.method}: {attempt.failure}" for attempt in attempts))
    best = min(made, key=lambda one: rank(one.actions, shortest_crease(one.creases) / scale))
    return replace(best, interrupted=interrupted), tuple(attempts)


def _attempt(made: Made) -> Attempt:
    return Attempt(made.method, made.creases.crease_count, made.actions, shortest_crease(made.creases), "")


def _for_hands(problem: Problem, _: Effort) -> Made:
    """Return a pattern of simple folds alone that can be cut at once.

    Raises ``UnfoldableError`` where none is found soon.
    """
    from foldcut.methods.simple.method import fold_simply

    made = fold_simply(problem, SOON)
    layers = layers_at_cut(made.creases.faces_vertices, made.folded)
    if layers > COMFORTABLE_LAYERS:
        raise UnfoldableError(f"after simple folds the cut would go through {layers} layers")
    return made


def _row(problem: Problem, effort: Effort) -> Made:
    """Return the pattern of a row of figures; raises ``UnfoldableError`` where the drawing is none."""
    from foldcut.methods.simple.method import fold_row

    return fold_row(problem, effort)


def _is_row(problem: Problem, made: Sequence[Made]) -> bool:
    """Return whether a row of figures has a pattern with so few folds that one with a single axis has more."""
    scale = frame_scale(problem.laid)
    rows = [one for one in made if one.method == "simple" and "perpendiculars" in one.numbers]
    ranks = [rank(one.actions, shortest_crease(one.creases) / scale) for one in rows]
    return bool(ranks) and not min(ranks).unfoldable and min(ranks).creases <= USUAL * _fewest(problem).bisectors


def _has_long_creases(problem: Problem, made: Made) -> bool:
    """Return whether all creases are easy to fold; no pattern is easier than one of simple folds, then."""
    return shortest_crease(made.creases) >= FOLDABLE_MM * frame_scale(problem.laid)


def _proven_fewest(problem: Problem, _: Effort) -> Made:
    """Return the pattern of the straight skeleton's ridges alone where it is proven that none has fewer folds.

    Raises ``UnfoldableError`` where it is not.
    """
    from foldcut.methods.skeleton.method import fold_ridges_alone

    scale, least = frame_scale(problem.laid), _fewest(problem)
    if not least.bisectors <= least.folds < least.corners:
        raise UnfoldableError("a pattern of ridges alone is unlikely, or has more folds than are needed")
    made = fold_ridges_alone(problem)
    too_short, folds, _shortest = rank(made.actions, shortest_crease(made.creases) / scale)
    if too_short or folds > least.folds:
        raise UnfoldableError("the pattern of ridges alone is not proven to have the fewest folds")
    return made


def _fewest(problem: Problem) -> Fewest:
    """Return how many folds are needed at least, even if corners move as far as they may."""
    wishes = problem.wishes
    near = ADJUST * frame_scale(problem.laid) if wishes.adjust is None else wishes.adjust
    size = float(np.ptp(np.concatenate(problem.shape.loops), axis=0).max())
    return fewest_folds(problem.shape, problem.sheet, near, wishes.symmetry, wishes.axes_off(size))


@dataclass(frozen=True)
class _Try:
    """A row of the table.

    ``when``: whether the method is worth a try. ``unless``: what has been made is so good that it is not. ``until``:
    the progress that is reached after it. ``instead``: what to call instead of the method. ``is_best``: no other
    pattern can be better than one that it made, so nothing more is tried. ``unsaid``: if it fails, that is not
    reported.
    """

    method: str
    until: float
    when: Callable[[Problem], bool] = lambda _: True
    unless: Callable[[Problem, Sequence[Made]], bool] = lambda *_: False
    instead: Callable[[Problem, Effort], Made] | None = None
    is_best: Callable[[Problem, Made], bool] = lambda *_: False
    unsaid: bool = False

    def fold(self, problem: Problem, effort: Effort) -> Made:
        return (self.instead or METHODS[self.method].fold)(problem, effort)


def _has_few_corners(problem: Problem) -> bool:
    return problem.shape.corner_count <= FEW_CORNERS


def _halves_are_simpler(problem: Problem, made: Sequence[Made]) -> bool:
    """Return whether a pattern for a half of the sheet has so few folds that one for all of it will not have fewer.

    What folds all of the sheet also folds the half, with the axis and about half as many folds. So only where a pattern
    of the half has more folds than others usually have, may a search on all of the sheet do better.
    """
    scale = frame_scale(problem.laid)
    ranks = [rank(one.actions, shortest_crease(one.creases) / scale) for one in made if one.first_folds]
    if not ranks or min(ranks).unfoldable or min(ranks).creases <= SMALL:
        return False
    return min(ranks).creases <= USUAL * _fewest(problem).bisectors


def _parts_are_simpler(problem: Problem, made: Sequence[Made]) -> bool:
    """Return whether a pattern for a part of the sheet has so few folds that one for all of it will not have fewer."""
    return _halves_are_simpler(problem, made) or _is_row(problem, made)


TRIES = (
    _Try("simple", until=0.03, when=_has_few_corners, instead=_for_hands, is_best=_has_long_creases, unsaid=True),
    _Try("skeleton", until=0.04, instead=_proven_fewest, is_best=lambda *_: True, unsaid=True),
    _Try("simple", until=0.08, when=_has_few_corners, instead=_row, unsaid=True),
    _Try("mirror", until=0.6, unless=_is_row),
    _Try("skeleton", until=0.75, unless=_parts_are_simpler),
    _Try("compact", until=FOLDED, unless=_parts_are_simpler),
)
