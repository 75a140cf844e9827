"""Any loops with few creases: fold along the straight skeleton, and let a solver order the layers.

``Shape`` on its sheet -> ``Skeletal``: a verified pattern (Demaine, Demaine and Lubiw 1999; docs/several-loops.md).

The drawing is tried as it is, and with corners moved by hairs (``snap``). For each of these, sets of perpendiculars are
tried (``choices``), and from the best one the search walks to others near to it. Of all patterns the one that is
easiest to fold is taken.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from foldcut.core.errors import UnfoldableError, UnfoldableWhereError
from foldcut.core.model import Shape, Sheet
from foldcut.methods.sheet_part import SheetPart
from foldcut.methods.skeleton.budget import Budget, order_cost
from foldcut.methods.skeleton.choices import CheapestSets, exchanges, promising_sets
from foldcut.methods.skeleton.facets import divide_sheet
from foldcut.methods.skeleton.perpendiculars import Perpendiculars, Ridges
from foldcut.methods.skeleton.skeleton_faces import skeleton_of
from foldcut.methods.skeleton.snap import tie_nodes, tie_perpendiculars
from foldcut.methods.skeleton.trial import Drawing, Skeletal, Trial, attempt, conditions_of, ordered, promise

__all__ = ["Skeletal", "fold_ridges", "fold_skeletal"]

SECONDS = {"fast": 1.0, "normal": 8.0, "best": 60.0}
"""How long sets of perpendiculars are tried, by effort, in seconds of the budget's model."""

PATIENCE = 3.0
"""While there is no pattern, the unmoved drawing is tried this many times as long."""

LEAST_PATIENCE = 3.0
"""While there is no pattern, each drawing with moved corners is tried for at least this many seconds."""

SETS_PART = 3 / 4
"""The part of that time for the promising sets; the rest is for the walk from the best of them."""

LEAST_SETS = 2
"""How many sets of each drawing are tried even if nothing is left to spend: one of both kinds (``promising_sets``)."""

MOST_LESSONS = 12
"""How many times the cheapest set is tried that does not repeat what has failed, while there is no pattern."""

STALLED = 1 / 3
"""A walk from a pattern ends when nothing has become better in this part of its time."""

PARTS = (1.0, 0.5, 0.1)
"""Corners are moved by no more than these parts of what is allowed: less is sometimes better."""

MOST_CORNERS = 120
"""Drawings with more corners are refused."""


def fold_skeletal(
    shape: Shape,
    sheet: Sheet,
    *,
    ribbon: float = 0.0,
    near: float,
    effort: str = "normal",
    seconds: float | None = None,
    share: float = 1.0,
    progress: Callable[[str, float], None] | None = None,
) -> Skeletal:
    """Fold a shape along its straight skeleton.

    ``shape`` is in the sheet's mm, and as large as a ``Frame`` has it; its corners may be moved by ``near`` mm, where
    that joins nodes of the skeleton or takes perpendiculars to them. ``ribbon`` is a half-width in mm: this near to the
    cut, creases only run straight across it or along a corner's bisector. ``effort`` is one of ``SECONDS``, ``seconds``
    replaces it, and ``share`` is the part of either that may be spent. ``progress`` is called with a text and the part
    done. Ctrl-C ends the search with the best pattern so far.
    Raises ``UnfoldableError`` with the reason where perpendiculars do not end, where there are too many corners or
    creases, and where no set of perpendiculars has a layer order.
    """
    if shape.corner_count > MOST_CORNERS:
        raise UnfoldableError(f"the drawing has {shape.corner_count} corners; this method takes at most {MOST_CORNERS}")
    budget = Budget(share * (seconds if seconds is not None else SECONDS[effort]))
    search = Search(sheet, ribbon, budget, progress)
    patience = PATIENCE * budget.limit
    variants = adjusted(shape, sheet, near)

    def fold_variants() -> None:
        for number, (variant, moved) in enumerate(variants, start=1):
            is_last = number == len(variants)
            search.fold(variant, moved, patience if is_last else max(budget.limit, LEAST_PATIENCE))

    return search.run(fold_variants)


def fold_ridges(shape: Shape, sheet: Sheet, *, ribbon: float = 0.0, near: float) -> Skeletal:
    """Fold a shape along the ridges of its straight skeleton alone; the options are those of ``fold_skeletal``.

    Raises ``UnfoldableError`` with the reason where perpendiculars are needed, or where there is no layer order.
    """
    tied, moved = tie_nodes(shape, sheet, near) if near else (shape, 0.0)
    ridges = ridges_of(tied, sheet, ribbon)
    if ridges.odd:
        raise UnfoldableError("some nodes of the straight skeleton need perpendiculars")
    facets = divide_sheet(Perpendiculars(ridges, []), [])
    return ordered(SheetPart(tied), moved, facets, conditions_of(facets), 0)


def ridges_of(shape: Shape, sheet: Sheet, ribbon: float) -> Ridges:
    """Return the ridges of a shape's straight skeleton; raise ``UnfoldableError`` if some meet within the ribbon."""
    skeleton = skeleton_of(shape, sheet)
    ridges = Ridges(skeleton, sheet)
    heights = (float(skeleton.height[node]) for node in ridges.nodes if node not in ridges.corners)
    lowest = min(heights, default=np.inf)
    if lowest <= ribbon:
        raise UnfoldableWhereError(
            "creases of the straight skeleton meet {0:.2g} mm from the cut, within the ribbon of {1:.6g} mm",
            lengths=(lowest, ribbon),
        )
    return ridges


def adjusted(shape: Shape, sheet: Sheet, near: float) -> list[tuple[Shape, float]]:
    """Return variants of a shape, and how far in mm their corners were moved: the shape itself comes last."""
    if not near:
        return [(shape, 0.0)]
    moved = [tie_perpendiculars(shape, sheet, part * near) for part in PARTS]
    moved = [(one, way) for one, way in [*moved, tie_nodes(shape, sheet, near)] if way]
    different: list[tuple[Shape, float]] = []
    for one, way in [*moved, (shape, 0.0)]:
        if all(any((a != b).any() for a, b in zip(one.loops, other.loops, strict=True)) for other, _ in different):
            different.append((one, way))
    return different


@dataclass
class Search:
    """The search for the pattern that is easiest to fold: ``best`` is the best trial so far that made one.

    ``ribbon`` in mm; ``problem`` is the first reason why something failed.
    """

    sheet: Sheet
    ribbon: float
    budget: Budget
    progress: Callable[[str, float], None] | None = None
    best: Trial | None = None
    problem: UnfoldableError | None = None

    @property
    def made(self) -> Skeletal | None:
        """The best pattern so far."""
        return self.best.made if self.best is not None else None

    def run(self, fold_variants: Callable[[], None]) -> Skeletal:
        """Fold some variants of a shape, look for a better pattern near to the best, and return the best of all.

        Ctrl-C ends the search with the best so far. Raises ``UnfoldableError`` with the first reason where there is
        none.
        """
        interrupted = False
        try:
            fold_variants()
            self.improve()
        except KeyboardInterrupt:
            if self.made is None:
                raise
            interrupted = True
        if self.made is None:
            raise self.problem or UnfoldableError("no set of perpendiculars makes the creases at every node even")
        return replace(self.made, interrupted=interrupted)

    def fold(self, shape: Shape, moved: float, patience: float, part: SheetPart | None = None) -> None:
        """Try sets of perpendiculars of a shape, and while none has a pattern, walk on from the best of them.

        ``moved`` is how far corners were moved, in mm; ``patience`` for how many seconds there may be no pattern.
        ``part``: what the sheet is a part of, if it is not all of it; then ``shape`` has the loops to fold it by.
        """
        if self.best is None:
            self.budget.spent = 0.0
        try:
            nearest = self._try_sets(shape, moved, patience, part or SheetPart(shape))
        except UnfoldableError as error:
            self.problem = self.problem or error
            return
        if self.best is None and nearest is not None:
            self.walk(nearest, patience)

    def _try_sets(self, shape: Shape, moved: float, patience: float, part: SheetPart) -> Trial | None:
        """Try promising sets, and return the best trial of this shape.

        Raises ``UnfoldableError`` where there are no sets, or none with few enough creases.
        """
        nearest: Trial | None = None
        first: Trial | None = None
        for number, (perpendiculars, taken) in enumerate(promising_sets(ridges_of(shape, self.sheet, self.ribbon))):
            spent = self.budget.spent > (self.budget.limit / 2 if self.best else SETS_PART * patience)
            if spent and number >= LEAST_SETS:
                break
            drawing = Drawing(part, moved, perpendiculars)
            if self.best is not None and promise(drawing, frozenset(taken)) >= self.best.quality:
                continue
            trial = self.attempt(drawing, frozenset(taken))
            first = first or trial
            if number == 1 and self.best is None:
                trial = min(trial, self._learn(first, patience), key=lambda one: one.quality)
            if nearest is None or trial.quality < nearest.quality:
                nearest = trial
        return nearest

    def _learn(self, first: Trial, patience: float) -> Trial:
        """Try the cheapest set that does not repeat what has failed, again and again; return the best trial.

        From each failure it is learned what has to change.
        """
        sets = CheapestSets(first.drawing.perpendiculars)
        nearest = trial = first
        for _ in range(MOST_LESSONS):
            if trial.made is not None or self.budget.spent > patience:
                break
            for cause in trial.causes or (frozenset(range(len(first.drawing.perpendiculars.paths))),):
                sets.forbid(trial.taken, cause)
            taken = sets.cheapest()
            if taken is None:
                break
            trial = self.attempt(first.drawing, taken)
            nearest = min(nearest, trial, key=lambda one: one.quality)
        return nearest

    def improve(self) -> None:
        """Look for a better pattern near to the best one."""
        if self.best is not None:
            self.walk(self.best, self.budget.spent + self.budget.limit / 2)

    def walk(self, here: Trial, end: float) -> None:
        """Go on from one set of perpendiculars to another that differs in two or three of them and is no worse.

        While no set has a pattern, one with no more contradictions is no worse, each step changes something in the
        cause of a contradiction, and the walk ends at the first pattern. From a pattern it only goes to patterns that
        are no harder to fold, and tries sets with the fewest folds first. It ends when ``end`` seconds are spent.
        """
        perpendiculars, folds = here.drawing.perpendiculars, here.made is not None
        every = exchanges(perpendiculars)
        random, seen = np.random.default_rng(0), {here.taken}
        stalled, patience = self.budget.spent, (end - self.budget.spent) * STALLED
        while self.budget.spent + (order_cost(len(here.made.creases.faces_vertices)) if here.made else 0.0) <= end:
            ways = [one for one in every if one & here.cause and here.taken ^ one not in seen]
            if folds and ways:
                promises = [promise(here.drawing, here.taken ^ one) for one in ways]
                most = min(promises)[:3]
                ways = [
                    one for one, best in zip(ways, promises, strict=True) if best < here.quality and best[:3] <= most
                ]
            if not ways or (folds and self.budget.spent - stalled > patience):
                break
            taken = here.taken ^ ways[int(random.integers(len(ways)))]
            seen.add(taken)
            trial = self.attempt(here.drawing, taken)
            if trial.quality < here.quality:
                stalled = self.budget.spent
            if trial.quality <= here.quality:
                here = trial
            if trial.made and not folds:
                break

    def attempt(self, drawing: Drawing, taken: frozenset[int]) -> Trial:
        """Try a set of perpendiculars, and keep the trial if it is the best."""
        if self.progress is not None:
            self.progress("layer orders", self.budget.part)
        to_beat = self.best.quality if self.best is not None else None
        trial = attempt(drawing, taken, self.budget, to_beat)
        if trial.problem and self.problem is None:
            self.problem = UnfoldableError(trial.problem)
        if trial.made and (self.best is None or trial.quality < self.best.quality):
            self.best = trial
        return trial
