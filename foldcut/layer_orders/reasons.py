"""Why a folded sheet has no layer order: the few creases that cannot go together.

``FoldedSheet`` -> a ``Reason``. The question is asked of a SAT solver again, with a switch for each crease's mountain
or valley and for each given order; of the switches that cannot all be on, one after the other is left out, as long as
there is still no order. Where no switch is needed, the pattern folds in no way at all, and the place is told where the
edges begin to contradict each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Chars, Numbers
from foldcut.layer_orders.conditions import Conditions, given_by_creases
from foldcut.layer_orders.folded_sheet import FoldedSheet
from foldcut.layer_orders.search import OrderSearch

__all__ = ["Reason", "why_none"]

MOST_TRIES = 60
"""How many switches it is tried to leave out, one after the other."""

FEW_CONFLICTS, FEW_ROUNDS = 3_000, 6
"""For how long it is tried whether there is still no order without one of the switches."""

MOST_NAMED = 6
"""How many creases a reason names at most."""


@dataclass(frozen=True)
class Reason:
    """Why there is no order, as a sentence, and the place on the sheet, in mm, where it begins."""

    text: str
    place: tuple[float, float] | None


def why_none(sheet: FoldedSheet, letters: Chars, given: Numbers) -> Reason:
    """Return why there is no order: ``letters`` ``(e,)`` of the pattern's edges, and ``given`` pairs of faces."""
    creases, folded = given_by_creases(sheet, letters)
    free = Conditions(sheet, np.empty((0, 2), dtype=np.intp))
    if free.contradictory:
        return _whatever(sheet)
    names = np.concatenate([creases, -1 - np.arange(len(given))])
    switches = free.literals(*np.concatenate([folded, given]).T).tolist() if len(names) else []
    search = OrderSearch(free)
    try:
        search.find(switches)
        kept = _of_core(switches, search.core())
        if not kept:
            return _whatever(sheet)
        search.most_conflicts, search.most_rounds = FEW_CONFLICTS, FEW_ROUNDS
        for at in list(kept)[:MOST_TRIES]:
            fewer = [other for other in kept if other != at]
            if at in kept and search.find([switches[other] for other in fewer]) is None and search.decided:
                kept = [other for other in fewer if switches[other] in set(search.core())]
    finally:
        search.close()
    return _named(sheet, letters, [int(names[at]) for at in kept]) if kept else _whatever(sheet)


def _of_core(switches: Sequence[int], core: Sequence[int]) -> list[int]:
    """Return for each literal of a core a switch that is this literal."""
    first = {literal: at for at, literal in reversed(list(enumerate(switches)))}
    return sorted(first[literal] for literal in set(core))


def _named(sheet: FoldedSheet, letters: Chars, names: Sequence[int]) -> Reason:
    """Return the reason that these cannot go together: places in ``sheet.edges``, or -1, -2, ... for given orders."""
    pattern = sheet.pattern
    texts, places = [], []
    for name in sorted(names, key=lambda name: (name < 0, abs(name))):
        if name < 0:
            texts.append(f"the order of faces that is given as number {-1 - name}")
            continue
        edge = int(sheet.edges[name])
        x, y = sheet.point(pattern.vertices_coords[pattern.edges_vertices[edge]].mean(axis=0))
        places.append((x, y))
        texts.append(f"{letters[edge]} at ({x:.4g}, {y:.4g})")
    more = f" and {len(texts) - MOST_NAMED} more" if len(texts) > MOST_NAMED else ""
    listed = ", ".join(texts[:MOST_NAMED]) + more
    these = f"these {len(texts)} cannot all be folded as assigned" if len(texts) > 1 else "this cannot be folded"
    return Reason(f"no layer order: {these}, paper would pass through paper: {listed}", places[0] if places else None)


def _whatever(sheet: FoldedSheet) -> Reason:
    """Return the reason of a pattern that folds in no way, with the place where conditions contradict each other."""
    place = sheet.middle_of(_first_blocked(sheet))
    x, y = place
    text = f"no layer order, whichever creases are mountains: paper would pass through paper near ({x:.4g}, {y:.4g})"
    return Reason(text, place)


def _first_blocked(sheet: FoldedSheet) -> int:
    """Return a face at whose edges no order is left, when edges are taken into account one after the other."""
    edges = np.arange(len(sheet.edges))
    low, high = 0, len(edges)  # the first ``high`` edges leave no order, the first ``low`` do
    while high - low > 1:
        middle = (low + high) // 2
        part = Conditions(sheet, np.empty((0, 2), dtype=np.intp), only=edges < middle)
        search = OrderSearch(part)
        blocked = search.find() is None
        search.close()
        low, high = (low, middle) if blocked else (middle, high)
    return int(sheet.beside[high - 1, 0])
