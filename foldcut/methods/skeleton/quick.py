"""Fold one outline exactly as it is, soon: for outlines that were drawn so that they fold.

``Shape`` on its sheet -> ``Skeletal``: a verified pattern. No corner is moved, and the first set of perpendiculars that
has a layer order is taken: those with the fewest pieces come first.
"""

from __future__ import annotations

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.methods.compact.part import SheetPart
from foldcut.methods.skeleton.budget import Budget
from foldcut.methods.skeleton.choices import promising_sets
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
    refused. ``part``: the part of the whole sheet that ``sheet`` is, if it is not all of it: a half, and ``shape`` may
    reach beyond its border at the axis. The pattern is that of the part; the whole is verified.
    Raises ``UnfoldableError`` with the first reason where none of the sets can be folded.
    """
    problem = "no set of perpendiculars makes the creases at every node even"
    budget = Budget(float("inf"))
    ridges = ridges_of(shape, sheet, ribbon)
    for number, (perpendiculars, taken) in enumerate(promising_sets(ridges)):
        if number == tries:
            break
        trial = attempt(Drawing(shape, 0.0, perpendiculars, part), frozenset(taken), budget)
        if trial.made is not None:
            return trial.made
        if not number:
            problem = trial.problem
    raise UnfoldableError(problem)
