"""Fold one outline exactly as it is, soon: for outlines that were drawn so that they fold.

``Shape`` on its sheet -> ``Skeletal``: a verified pattern. No corner is moved, and the first set of perpendiculars that
has a layer order is taken: those with the fewest folds come first.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import zip_longest

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.methods.sheet_part import SheetPart
from foldcut.methods.skeleton.budget import Budget
from foldcut.methods.skeleton.choices import CheapestSets, away_from_joints, away_from_roots, fewest_folds
from foldcut.methods.skeleton.perpendiculars import Perpendiculars, trace
from foldcut.methods.skeleton.search import ridges_of
from foldcut.methods.skeleton.trial import Drawing, Skeletal, Trial, attempt

__all__ = ["TRIES", "fold_outline"]

TRIES = 8
"""How many sets of perpendiculars are tried."""


def fold_outline(
    shape: Shape,
    sheet: Sheet,
    *,
    ribbon: float = 0.0,
    tries: int = TRIES,
    part: SheetPart | None = None,
    most_folds: float = math.inf,
    cheaper_tries: float = math.inf,
) -> Skeletal:
    """Return the pattern of the first set of perpendiculars, of at most ``tries``, that can be folded.

    The set with the fewest folds is tried first. Then these take turns: sets that fold all paper away from a corridor
    or from a joint, which can mostly be folded, and the cheapest sets that do not repeat what has failed. Once one of
    the former can be folded, only cheaper ones of the latter are tried, ``cheaper_tries`` at most.

    ``shape`` is in the sheet's mm; ``ribbon`` is a half-width in mm: creases that meet this near to the cut are
    refused. Where ``sheet`` is a part of a sheet, ``part`` says how the pattern of the whole sheet comes from it.
    Sets with more than ``most_folds`` are not tried: it may take minutes to order the layers of a thousand creases.
    Raises ``UnfoldableError`` with the first reason where none of the sets can be folded.
    """
    budget = Budget(float("inf"))
    ridges = ridges_of(shape, sheet, ribbon)
    odd = trace(ridges, ridges.odd)
    odd.require_ends()
    fewest = fewest_folds(odd, 1)
    if not (fewest and tries):
        raise UnfoldableError("no set of perpendiculars makes the creases at every node even")

    def fold(perpendiculars: Perpendiculars, taken: frozenset[int]) -> Trial:
        return attempt(Drawing(part or SheetPart(shape), 0.0, perpendiculars), taken, budget)

    folds = odd.ridge_lines + odd.line_count(fewest[0])
    if folds > most_folds:
        raise UnfoldableError(f"the pattern has {folds:,} folds; at most {most_folds:g} are wanted")
    first = fold(odd, frozenset(fewest[0]))
    if first.made is not None:
        return first.made
    every = trace(ridges, ridges.nodes) if len(ridges.nodes) > len(ridges.odd) else odd
    most = most_folds - odd.ridge_lines
    others = (taken for taken in _away(every) if every.line_count(taken) <= most)
    lessons = _Lessons(odd)
    lessons.learn(first)
    made, lines = None, 0
    for number in range(tries - 1):
        if made is not None:
            cheaper_tries -= 1
            if cheaper_tries < 0:
                break
        taken = lessons.cheapest
        if taken is not None and odd.line_count(taken) > most:
            taken = None
        other = next(others, None) if made is None and (number % 2 == 0 or taken is None) else None
        if other is not None:
            trial, count = fold(every, other), every.line_count(other)
        elif taken is not None and (made is None or odd.line_count(taken) < lines):
            trial, count = fold(odd, taken), odd.line_count(taken)
            lessons.learn(trial)
        else:
            break
        if trial.made is not None:
            if made is not None or other is None:
                return trial.made
            made, lines = trial.made, count
    if made is None:
        raise UnfoldableError(first.problem)
    return made


def _away(perpendiculars: Perpendiculars) -> Iterator[frozenset[int]]:
    """Yield sets that fold all paper away from a corridor and away from a joint, in turns, each once."""
    seen: set[frozenset[int]] = set()
    for both in zip_longest(away_from_roots(perpendiculars), away_from_joints(perpendiculars)):
        for one in both:
            if one is not None and (taken := frozenset(one)) not in seen:
                seen.add(taken)
                yield taken


class _Lessons:
    """What failed trials teach: the cheapest set that repeats none of what has failed."""

    def __init__(self, perpendiculars: Perpendiculars) -> None:
        self._sets = CheapestSets(perpendiculars)
        self._every = frozenset(range(len(perpendiculars.paths)))
        self.cheapest: frozenset[int] | None = None

    def learn(self, trial: Trial) -> None:
        """Leave out from now on what made a trial fail."""
        for cause in trial.causes or (self._every,):
            self._sets.forbid(trial.taken, cause)
        self.cheapest = self._sets.cheapest()
