"""Fold one outline exactly as it is, soon: for outlines that were drawn so that they fold.

``Shape`` on its sheet -> ``Skeletal``: a verified pattern. No corner is moved, and the first set of perpendiculars that
has a layer order is taken: those with the fewest pieces come first.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice, zip_longest

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.methods.sheet_part import SheetPart
from foldcut.methods.skeleton.budget import Budget
from foldcut.methods.skeleton.choices import FEWEST, away_from_joints, away_from_roots, fewest_folds
from foldcut.methods.skeleton.perpendiculars import Perpendiculars, Ridges, trace
from foldcut.methods.skeleton.search import ridges_of
from foldcut.methods.skeleton.trial import Drawing, Skeletal, attempt

__all__ = ["TRIES", "fold_outline"]

TRIES = 8
"""How many sets of perpendiculars are tried."""


def fold_outline(
    shape: Shape, sheet: Sheet, *, ribbon: float = 0.0, tries: int = TRIES, part: SheetPart | None = None
) -> Skeletal:
    """Return the pattern of the first promising set of perpendiculars, of at most ``tries``, that can be folded.

    ``shape`` is in the sheet's mm; ``ribbon`` is a half-width in mm: creases that meet this near to the cut are
    refused. Where ``sheet`` is a part of a sheet, ``part`` says how the pattern of the whole sheet comes from it. Raises
    ``UnfoldableError`` with the first reason where none of the sets can be folded.
    """
    problem = "no set of perpendiculars makes the creases at every node even"
    budget = Budget(float("inf"))
    ridges = ridges_of(shape, sheet, ribbon)
    for number, (perpendiculars, taken) in enumerate(islice(_sets(ridges), tries)):
        trial = attempt(Drawing(part or SheetPart(shape), 0.0, perpendiculars), frozenset(taken), budget)
        if trial.made is not None:
            return trial.made
        if not number:
            problem = trial.problem
    raise UnfoldableError(problem)


def _sets(ridges: Ridges) -> Iterator[tuple[Perpendiculars, list[int]]]:
    """Yield sets of perpendiculars: of those with the fewest folds, away from a joint, and away from a corridor, in turns.

    The last two are taken from the perpendiculars of all nodes; where all of these end, the last can mostly be folded.
    """
    odd = trace(ridges, ridges.odd)
    odd.require_ends()
    every = trace(ridges, ridges.nodes) if len(ridges.nodes) > len(ridges.odd) else odd
    for fewest, *rooted in zip_longest(fewest_folds(odd, FEWEST), away_from_joints(every), away_from_roots(every)):
        if fewest is not None:
            yield odd, fewest
        for taken in rooted:
            if taken is not None:
                yield every, taken
