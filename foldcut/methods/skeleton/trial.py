"""One trial: a set of perpendiculars is folded, its layers are ordered, and the pattern is verified.

``Drawing``, and the perpendiculars to fold -> ``Trial``.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import CreasePattern, FoldedState, Shape
from foldcut.methods.sheet_part import SheetPart
from foldcut.methods.skeleton.budget import Budget
from foldcut.methods.skeleton.facets import Facets, divide_sheet
from foldcut.methods.skeleton.layer_order import NO_ORDER, OrderConditions, layer_order
from foldcut.methods.skeleton.perpendiculars import Perpendiculars
from foldcut.pattern.assemble import assemble, creases_of_stack
from foldcut.pattern.foldability import crease_numbers
from foldcut.pattern.ranking import rank, shortest_crease
from foldcut.proof.verify import verify

NOT_BETTER = "another pattern is easier to fold"


@dataclass(frozen=True, eq=False)
class Skeletal:
    """What the method made.

    ``shape`` is the drawing that was folded, and ``moved_mm`` how far its corners were moved for that at most;
    ``perpendiculars`` how many are folded; ``creases`` and ``folded`` are those of the whole sheet, ``part`` has the
    creases of the part of it that was folded (see ``SheetPart``); ``interrupted``: Ctrl-C ended the search early.
    """

    shape: Shape
    moved_mm: float
    perpendiculars: int
    creases: CreasePattern
    folded: FoldedState
    part: CreasePattern
    interrupted: bool = False


@dataclass(frozen=True, eq=False)
class Drawing:
    """The part of a sheet that is folded, how far in mm corners were ``moved`` at most, and its perpendiculars."""

    part: SheetPart
    moved: float
    perpendiculars: Perpendiculars


@dataclass(frozen=True, eq=False)
class Trial:
    """A set of perpendiculars that was tried, and what it ``made``, if anything, else the ``problem``.

    ``contradictory`` counts its contradictions as ``OrderConditions`` does, and is infinite where these are not known.
    ``cause`` is a set of perpendiculars: unless one of them changes, some contradiction stays; ``causes`` are more such
    sets.
    """

    drawing: Drawing
    taken: frozenset[int]
    made: Skeletal | None
    problem: str
    contradictory: tuple[float, float]
    cause: frozenset[int]
    causes: tuple[frozenset[int], ...] = ()

    @cached_property
    def quality(self) -> tuple[float, ...]:
        """Less is better: first all that have a pattern, those that are easy to fold before others."""
        if self.made is None:
            return (1.0, *self.contradictory)
        return (0.0, *rank(crease_numbers(self.made.part).lines, shortest_crease(self.made.creases)))


def promise(drawing: Drawing, taken: frozenset[int], shortest: float = np.inf) -> tuple[float, ...]:
    """Return the quality, as a ``Trial`` has it, of a set of perpendiculars if it can be folded, or of a better one.

    ``shortest`` is what is known about the length of its shortest crease, in mm.
    """
    perpendiculars = drawing.perpendiculars
    lines = perpendiculars.ridge_lines + perpendiculars.line_count(taken)
    return (0.0, *rank(lines, min(shortest, perpendiculars.shortest(taken))))


def attempt(drawing: Drawing, taken: frozenset[int], budget: Budget, to_beat: tuple[float, ...] | None = None) -> Trial:
    """Try a set of perpendiculars, and spend what that costs.

    No order is looked for if the pattern would not be better than ``to_beat``, another trial's quality.
    """
    contradictory: tuple[float, float] = (np.inf, np.inf)
    cause = frozenset(range(len(drawing.perpendiculars.paths)))
    try:
        budget.start_division()
        facets = divide_sheet(drawing.perpendiculars, sorted(taken))
        budget.divided(len(facets.facets))
        conditions = conditions_of(facets)
        contradictory = conditions.contradictory
        if contradictory[0]:
            found = conditions.facets_of_contradictions()
            causes = tuple(perpendiculars_in(drawing.perpendiculars, facets, some) for some in found)
            return Trial(drawing, taken, None, NO_ORDER, contradictory, causes[0], causes)
        if any(contradictory):
            return Trial(drawing, taken, None, NO_ORDER, contradictory, cause)
        if to_beat is not None and promise(drawing, taken, facets.shortest) >= to_beat:
            return Trial(drawing, taken, None, NOT_BETTER, contradictory, cause)
        try:
            made = ordered(drawing.part, drawing.moved, facets, conditions, len(taken))
        finally:
            budget.ordered(len(facets.facets), conditions.rounds)
    except UnfoldableError as error:
        return Trial(drawing, taken, None, str(error), contradictory, cause)
    return Trial(drawing, taken, made, "", contradictory, cause)


def conditions_of(facets: Facets) -> OrderConditions:
    """Return the conditions on the layer order of facets."""
    return OrderConditions(facets.folded, facets.facets, facets.creases, facets.up)


def ordered(
    part: SheetPart, moved: float, facets: Facets, conditions: OrderConditions, perpendiculars: int
) -> Skeletal:
    """Find a layer order for a part of a sheet, and return the pattern that it makes of the whole sheet.

    Raises ``UnfoldableError`` where no order is found, and where the pattern fails verification.
    """
    order = layer_order(conditions)
    stack = [facets.facets[k] for k in order]
    edges, kinds = creases_of_stack(facets.folded, stack)
    of_part, folded = assemble(facets.flat, facets.folded, stack, edges, kinds, facets.sheet_corners)
    creases, folded = part.unfold(of_part, folded)
    findings = verify(creases, folded.layers, part.shape)
    if findings:
        raise UnfoldableError(f"the pattern fails verification ({findings[0]})")
    return Skeletal(part.shape, moved, perpendiculars, creases, folded, of_part)


def perpendiculars_in(perpendiculars: Perpendiculars, facets: Facets, within: Iterable[int]) -> frozenset[int]:
    """Return the perpendiculars that border on some of the facets, or would divide them if they were folded."""
    outlines = [facets.flat[facets.facets[k]] for k in within]
    tree = shapely.STRtree(shapely.polygons([shapely.linearrings(outline) for outline in outlines]))
    number = [k for k, path in enumerate(perpendiculars.paths) for _ in path.pieces]
    ends = np.array([(*piece.start, *piece.end) for path in perpendiculars.paths for piece in path.pieces])
    ends = ends.reshape(-1, 4)
    middles = shapely.points((ends[:, :2] + ends[:, 2:]) / 2)
    found = tree.query(middles, predicate="dwithin", distance=perpendiculars.ridges.snap)[0]
    return frozenset(number[k] for k in found.tolist())
