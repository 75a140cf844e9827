"""Several loops, or one, with few creases: along the straight skeleton, the layers ordered by a solver.

``Shape`` on its sheet -> ``Skeletal``: a verified pattern (Demaine, Demaine and Lubiw 1998; docs/several-loops.md).

Which perpendiculars are folded is chosen in several ways, see ``perpendiculars``; for each of these choices
``ordersolver`` looks for a layer order, and ``verify`` has the last word. The pattern that is easiest to fold is taken.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from foldcut.errors import UnfoldableError
from foldcut.faces import assemble, creases_of_stack
from foldcut.foldability import crease_numbers
from foldcut.model import CreasePattern, FoldedState, Shape, Sheet
from foldcut.ordersolver import layer_order
from foldcut.perpendiculars import Perpendiculars, divide_sheet, straight_skeleton, tie_nodes
from foldcut.search import Rank, rank, shortest_crease
from foldcut.verify import verify

__all__ = ["Skeletal", "fold_skeletal"]

SECONDS = {"fast": 5.0, "normal": 20.0, "best": 120.0}
"""How long choices are tried, by effort; the first is always looked at."""

FEWEST = 4
"""So many of the sets of perpendiculars with the fewest pieces are tried."""

MOST_CREASES = 1000
"""Patterns with more creases are not looked at."""


@dataclass(frozen=True, eq=False)
class Skeletal:
    """What the method made.

    ``shape`` is the drawing with nodes tied, ``moved_mm`` how far its corners were moved for that at most;
    ``perpendiculars`` how many there are.
    """

    shape: Shape
    moved_mm: float
    perpendiculars: int
    creases: CreasePattern
    folded: FoldedState


def fold_skeletal(
    shape: Shape,
    sheet: Sheet,
    *,
    near: float = 0.0,
    effort: str = "normal",
    seconds: float | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> Skeletal:
    """Fold a shape along its straight skeleton.

    ``shape`` is in the sheet's mm; corners may be moved by ``near`` mm where that joins nodes of the skeleton.
    Raises ``UnfoldableError`` with the reason where perpendiculars do not end, creases are too many, or no choice has
    a layer order.
    """
    limit = seconds if seconds is not None else SECONDS[effort]
    start = time.monotonic()
    shape, moved = tie_nodes(shape, sheet, near) if near else (shape, 0.0)
    perpendiculars = Perpendiculars(straight_skeleton(shape, sheet), sheet)
    best: tuple[Rank, Skeletal] | None = None
    problem = ""
    for taken in _choices(perpendiculars):
        spent = time.monotonic() - start
        if progress is not None:
            progress("perpendiculars", min(1.0, spent / limit))
        if spent > limit and (best or problem):
            break
        try:
            made = _ordered(shape, moved, perpendiculars, taken, max(limit - spent, 1.0))
        except UnfoldableError as error:
            problem = problem or str(error)
            continue
        key = rank(crease_numbers(made.creases).lines, shortest_crease(made.creases))
        if best is None or key < best[0]:
            best = key, made
    if best is None:
        raise UnfoldableError(problem or "no set of perpendiculars makes the creases at every node even")
    return best[1]


def _choices(perpendiculars: Perpendiculars) -> Iterator[list[int]]:
    """Set up and yield choices of perpendiculars: the fewest, then those that fold away from a root."""
    perpendiculars.trace(perpendiculars.odd)
    perpendiculars.require_ends()
    seen: set[tuple[int, ...]] = set()
    for taken in perpendiculars.fewest(FEWEST):
        seen.add(tuple(taken))
        yield taken
    for taken in perpendiculars.rooted():
        if tuple(taken) not in seen:
            yield taken
    if len(perpendiculars.nodes) > len(perpendiculars.odd):
        perpendiculars.trace(perpendiculars.nodes)
        yield from perpendiculars.rooted()


def _ordered(
    shape: Shape, moved: float, perpendiculars: Perpendiculars, taken: list[int], seconds: float
) -> Skeletal:
    facets = divide_sheet(perpendiculars, taken)
    if len(facets.creases) > MOST_CREASES:
        raise UnfoldableError(f"the pattern has {len(facets.creases):,} creases; at most {MOST_CREASES:,} are looked at")
    order = layer_order(facets.folded, facets.rings, facets.creases, facets.up, seconds=seconds)
    rings = [facets.rings[k] for k in order]
    edges, kinds = creases_of_stack(facets.folded, rings)
    creases, folded = assemble(facets.flat, facets.folded, rings, edges, kinds, facets.sheet_corners)
    findings = verify(creases, folded.layers, shape)
    if findings:
        raise UnfoldableError(f"the pattern fails verification ({findings[0]})")
    return Skeletal(shape, moved, len(taken), creases, folded)
