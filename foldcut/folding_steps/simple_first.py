"""Of the mountains, valleys and layer orders that the creases of a pattern allow, one that begins with simple folds.

``FoldedPattern`` -> the same creases with other mountains and valleys, and another order of layers, or None.

A *simple fold* goes along one straight line across the whole sheet as it lies, through all of its layers. First a
sequence of such folds is looked for, along creases of the pattern, after which faces that lie on each other never slide
any more: the folded sheet is like one thicker sheet. Then a solver orders the layers for all that is left, with the
order in which those faces lie given. The verifier decides about the result.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice, product

import numpy as np

from foldcut.core.arrays import Ints, index_array
from foldcut.core.errors import UnfoldableError
from foldcut.core.model import CreasePattern, FoldedPattern, FoldedState
from foldcut.folding_steps.phases import Phase, phases
from foldcut.folding_steps.state import SheetData, SheetState, Turn, is_one_sheet, kept_together
from foldcut.folding_steps.steps import folding_steps
from foldcut.geometry.planar_graph import edge_faces
from foldcut.methods.skeleton.layer_order import OrderConditions, layer_order
from foldcut.proof.verify import verify

__all__ = ["MOST_CREASES", "Easier", "easier", "with_simple_folds_first"]

MOST_CREASES = 400
"""Patterns with more creases than this are left as they are."""

MOST_COUNTED = 120
"""In patterns with more creases than this folds are not counted unless they were changed: it takes too long."""

MOST_STATES = 3000
"""Beginnings are looked for in this many states of the sheet, divided by the number of its faces."""

MOST_BEGINNINGS = 4
"""For how many beginnings, the longest first, the solver is asked."""

MOST_WAYS = 4
"""In how many ways each of them is folded, over or under the rest."""


@dataclass(frozen=True, eq=False)
class Easier:
    """A pattern as it is easiest to fold, and the phases of folding it."""

    pattern: FoldedPattern
    phases: tuple[Phase, ...]

    @property
    def actions(self) -> int:
        """How many folds a person makes, through one layer or more."""
        return sum(phase.count for phase in self.phases)


def easier(pattern: FoldedPattern) -> Easier | None:
    """Return a pattern with the same creases, folded so that the fewest are left to close together.

    None where no simple fold can begin it, and where a pattern with more than ``MOST_COUNTED`` creases begins with as
    many as it can: then nothing is changed, and nothing was counted.
    """
    other = with_simple_folds_first(pattern)
    if other is None or (other is pattern and pattern.creases.crease_count > MOST_COUNTED):
        return None
    both = (pattern,) if other is pattern else (pattern, other)
    found = [Easier(one, phases(one, folding_steps(one))) for one in both]
    return min(found, key=lambda one: (sum(p.count for p in one.phases if p.together), one.actions))


def with_simple_folds_first(pattern: FoldedPattern) -> FoldedPattern | None:
    """Return a pattern with the same creases that begins with as many simple folds as are found, None without any.

    Its ``first_folds`` come first, away from you. A pattern that begins with as many as it can is returned itself.
    """
    creases = pattern.creases
    if creases.crease_count > MOST_CREASES:
        return None
    sheet = SheetData(pattern)
    count = len(sheet.faces)
    end = SheetState(sheet, pattern.folded.vertices_coords, np.argsort(pattern.folded.layers), sheet.creased)
    flat = SheetState(sheet, sheet.flat, np.arange(count), np.zeros_like(sheet.creased), np.zeros((count, count), bool))
    found = sorted(_beginnings(flat, end), key=lambda one: (-int(one.state.folded.sum()), len(one.turns)))
    if not found:
        return None
    conditions: OrderConditions | None = None
    for beginning in found[:MOST_BEGINNINGS]:
        if any(is_one_sheet(state, end) for state in _stacked(flat, beginning)):
            return pattern
        conditions = conditions or _conditions(end)
        for order in _orders(flat, end, beginning, conditions):
            made = _reordered(pattern, end, order)
            if not verify(made.creases, made.folded.layers, made.shape):
                return made
    return None


@dataclass(frozen=True, eq=False)
class _Beginning:
    """Simple folds, one after another, and the state after them."""

    turns: tuple[Turn, ...]
    state: SheetState


def _beginnings(flat: SheetState, end: SheetState) -> Iterator[_Beginning]:
    """Yield sequences of simple folds that cannot go on, and their parts; those that fold the most creases first."""
    tries = max(1, MOST_STATES // len(flat.rank))
    reached: set[bytes] = set()
    waiting = [_Beginning((), flat)]
    while waiting:
        now = waiting.pop()
        if now.turns:
            yield now
        onward: list[_Beginning] = []
        for turn in _simple_folds(now.state):
            after = now.state.turned(turn)
            tries -= 1
            if tries < 0:
                return
            if after.folded.tobytes() not in reached and _is_glued(after, end):
                reached.add(after.folded.tobytes())
                onward.append(_Beginning((*now.turns, turn), after))
        waiting += sorted(onward, key=lambda one: int(one.state.folded.sum()))


def _simple_folds(state: SheetState) -> Iterator[Turn]:
    """Yield the simple folds of a state; while there are ``first_folds``, only these, away from you."""
    sheet = state.sheet
    first = next((some for some in sheet.first_lines if (some & ~state.folded).any()), None)
    for turn in state.simple_folds(sheet.creased if first is None else first):
        yield turn if first is None else replace(turn, over=False)


def _is_glued(state: SheetState, end: SheetState) -> bool:
    """Whether no two faces that lie on each other slide on the way to ``end``."""
    one, other = np.nonzero(np.triu(state.meet))
    return bool(kept_together(state, end, one, other)[0].all())


def _conditions(end: SheetState) -> OrderConditions:
    """Return the conditions on the order of the layers of a folded state."""
    sheet = end.sheet
    creases = []
    for edge in np.flatnonzero(sheet.creased).tolist():
        (a, b), (left, right) = sheet.ends[edge].tolist(), sheet.beside[edge].tolist()
        creases.append(((a, b), (left, right)) if a < b else ((b, a), (right, left)))
    return OrderConditions(end.at, sheet.faces.to_lists(), creases, end.up.tolist())


def _orders(flat: SheetState, end: SheetState, beginning: _Beginning, conditions: OrderConditions) -> Iterator[Ints]:
    """Yield orders of the layers, from bottom to top, in which the sheet can begin with these folds."""
    for state in _stacked(flat, beginning):
        one, other = np.nonzero(np.triu(state.meet))
        same = state.up == end.up
        rising = (state.rank[one] < state.rank[other]) == same[one]
        above, below = np.where(rising, other, one), np.where(rising, one, other)
        try:
            yield index_array(layer_order(conditions, np.stack([above, below], axis=1)))
        except UnfoldableError:
            continue


def _stacked(flat: SheetState, beginning: _Beginning) -> Iterator[SheetState]:
    """Yield the sheet after the folds of a beginning, the layers in one order and another."""
    either = sum(turn.over for turn in beginning.turns)
    for ways in islice(product((True, False), repeat=max(0, either - 1)), MOST_WAYS):
        state, way = flat, iter((True, *ways))
        for turn in beginning.turns:
            state = state.turned(replace(turn, over=turn.over and next(way)))
        yield state


def _reordered(pattern: FoldedPattern, end: SheetState, layers: Ints) -> FoldedPattern:
    """Return a pattern with its layers in another order, from bottom to top, and mountains and valleys to match."""
    creases = pattern.creases
    rank = np.argsort(layers)
    left, right = edge_faces(creases).T
    valley = (rank[right] > rank[left]) == end.up[left]
    kinds = np.where(end.sheet.creased, np.where(valley, "V", "M"), creases.edges_assignment)
    changed = CreasePattern(creases.vertices_coords, creases.edges_vertices, kinds, creases.faces_vertices)
    return replace(pattern, creases=changed, folded=FoldedState(pattern.folded.vertices_coords, layers))
