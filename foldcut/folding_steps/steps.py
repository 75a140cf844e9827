"""In what order a person folds a pattern: straight folds where there are any, and the rest in collapses.

``FoldedPattern`` -> ``FoldingStep`` after ``FoldingStep``, from the flat sheet to the folded one.

A *fold* turns some faces over a straight line, through half a turn. Two kinds of folds are looked for. Each is checked
on the sheet as it lies at that time: everything that lies on the moving faces moves with them (or everything under
them, if they go under), and they hang on the rest only along the line.

- At the beginning: folds after which faces that lie on each other never slide any more, so that they are like one
  thicker sheet from then on. A fold along a mirror axis is one.
- At the end: these are found backwards, by unfolding the finished sheet.

What remains between them *collapses*: many creases close at the same time.

Invariants: each crease is in one step; the first step begins with the flat sheet, its front up; after the last step,
the sheet is in the folded state of the pattern, perhaps moved or turned over.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from foldcut.core.arrays import Bools, Floats, Ints, index_array, points_array
from foldcut.core.model import FoldedPattern, FoldedState
from foldcut.folding_steps.crease_sets import CreaseSets
from foldcut.folding_steps.groups import groups_of
from foldcut.folding_steps.partly_folded import partly_folded
from foldcut.folding_steps.state import SheetData, SheetState, Turn, is_one_sheet
from foldcut.geometry.vectors import left_normal

__all__ = ["FoldingStep", "folding_steps", "goes_through_all"]

MOST_CREASES = 1000
"""A pattern with more creases than this is folded in one step."""

SIMPLE_STATES = 10_000
"""A beginning of folds through all layers is looked for in this many states of the sheet, divided by the number of its
faces."""

ABREAST = 6
"""Of rows of as many folds through all layers, so many are gone on with."""

MOST_STATES = 3000
"""The same for folds through fewer layers."""

MOST_TRIES = 40
"""The number of states between the first folds and the last ones that are tried."""

TIE = 1e-6
"""A corner of a face that is nearer to the line of a fold than this, relative to the sheet's diagonal, is on it."""


@dataclass(frozen=True, eq=False)
class FoldingStep:
    """One movement: a fold or a collapse.

    ``edges``: the numbers of the creases that it folds. ``state``: the sheet after it, layers from bottom to top. A
    fold has a ``line``, ``(2, 2)`` mm, as it lies on the sheet before the step, the faces that are ``moved``, and
    whether these go ``over`` the others, as seen from above, or under them. A collapse has no line; its ``groups``
    divide its creases by molecules, the inner ones first.
    """

    edges: Ints
    state: FoldedState
    line: Floats | None = None
    moved: Ints | None = None
    over: bool = True
    groups: tuple[Ints, ...] = ()


def folding_steps(pattern: FoldedPattern) -> tuple[FoldingStep, ...]:
    """Return the steps from the flat sheet to ``pattern.folded``."""
    sheet = SheetData(pattern)
    if sheet.creased.sum() > MOST_CREASES:
        every = np.flatnonzero(sheet.creased)
        return (FoldingStep(index_array(every), pattern.folded, groups=groups_of(pattern, every)),)
    count = len(sheet.faces)
    rank = np.argsort(pattern.folded.layers)
    end = SheetState(sheet, pattern.folded.vertices_coords, rank, sheet.creased)
    flat = SheetState(sheet, sheet.flat, np.arange(count), np.zeros_like(sheet.creased), np.zeros((count, count), bool))
    moves = _beginning(flat, end)
    state = moves[-1].after if moves else flat
    last: list[_Move] = []
    target = end
    while (target.folded != state.folded).any() and (found := _best(target.unfolds(state.meet))):
        last.append(_Move(target.turned(found), target, found))
        target = last[-1].before
    moves += [*_collapses(sheet, state, target), *reversed(last)]
    return tuple(_replayed(pattern, flat, moves))


def goes_through_all(pattern: FoldedPattern, at: Floats, line: Floats) -> bool:
    """Return whether a straight fold bends all layers on its ``line``, ``(2, 2)``: no face lies on both sides of it.

    ``at``: where the vertices are before the fold, ``(v, 2)``.
    """
    along = (line[1] - line[0]) / math.dist(*line)
    off = (at - line[0]) @ left_normal(along)
    tie = TIE * pattern.sheet.diagonal
    return not any(off[face].min() < -tie and off[face].max() > tie for face in pattern.creases.faces_vertices)


@dataclass(frozen=True, eq=False)
class _Move:
    """What happens between two states, which may lie anywhere: a straight fold, or without a ``turn`` a collapse."""

    before: SheetState
    after: SheetState
    turn: Turn | None


def _beginning(flat: SheetState, end: SheetState) -> list[_Move]:
    """Return straight folds of the flat sheet after which nothing slides any more; they fold as many creases as can be.

    Folds through all layers are tried first, and the rest is tried after those of them that fold the most creases. Of
    either kind those of the pattern's ``first_folds`` come before all, then what folds the most creases; then others
    are tried, for as many states as the size of the pattern allows: they may fold more creases, or as many by fewer
    folds.
    """
    simple = _fewest_simple(flat, end)
    if not simple or _folds(simple[-1].after) < _folds(end):
        simple = _longest(simple, flat, end, _simple_turns, SIMPLE_STATES)
    return _longest(simple, flat, end, lambda state: state.folds(state.sheet.creased), MOST_STATES)


def _fewest_simple(flat: SheetState, end: SheetState) -> list[_Move]:
    """Return few folds through all layers that fold many creases: of as many folds, only the best are gone on with."""
    tries = max(1, SIMPLE_STATES // len(flat.rank))
    best: list[_Move] = []
    row: list[tuple[list[_Move], SheetState]] = [([], flat)]
    while row:
        following: dict[bytes, tuple[list[_Move], SheetState]] = {}
        for moves, state in row:
            for turn in _simple_turns(state):
                tries -= 1
                if tries < 0:
                    return best
                after = state.turned(turn)
                if after.place not in following and is_one_sheet(after, end):
                    following[after.place] = [*moves, _Move(state, after, turn)], after
        row = sorted(following.values(), key=lambda one: -_folds(one[1]))[:ABREAST]
        if row and _folds(row[0][1]) > (_folds(best[-1].after) if best else 0):
            best = row[0][0]
        if best and _folds(best[-1].after) == _folds(end):
            break
    return best


def _simple_turns(state: SheetState) -> Iterator[Turn]:
    """Yield the folds through all layers that the pattern's mountains and valleys allow."""
    sheet = state.sheet
    for turn in state.simple_folds(sheet.creased):
        rising = (sheet.valley == state.up[sheet.beside[:, 0]])[turn.edges]
        if rising.all() or not rising.any():
            yield replace(turn, over=bool(rising.all()))


def _longest(
    best: list[_Move],
    flat: SheetState,
    end: SheetState,
    turns: Callable[[SheetState], Iterator[Turn]],
    states: int,
) -> list[_Move]:
    """Return folds that fold the most creases by the fewest folds, as far as they are found; ``best`` is a beginning.

    What comes after ``best`` is tried first. ``states``: how many are tried, divided by the number of faces.
    """
    tries = max(1, states // len(flat.rank))
    reached = {move.after.place: number for number, move in enumerate(best, start=1)}
    waiting = _onward([], flat, turns)
    if best:
        waiting += _onward(best, best[-1].after, turns)
    while waiting and (tries > 0 or not best):
        tries -= 1
        moves, state, turn = waiting.pop()
        if best and _folds(best[-1].after) == _folds(end) and len(moves) + 1 >= len(best):
            continue
        after = state.turned(turn)
        if reached.get(after.place, MOST_CREASES) <= len(moves) + 1 or not is_one_sheet(after, end):
            continue
        reached[after.place] = len(moves) + 1
        moves = [*moves, _Move(state, after, turn)]
        if (_folds(after), -len(moves)) > (_folds(best[-1].after) if best else 0, -len(best)):
            best = moves
        waiting += _onward(moves, after, turns)
    return best


def _onward(
    moves: list[_Move], state: SheetState, turns: Callable[[SheetState], Iterator[Turn]]
) -> list[tuple[list[_Move], SheetState, Turn]]:
    """Return the turns that are possible in a state, the best last, each with what comes before it."""
    found = sorted(turns(state), key=lambda turn: _key(turn, state.sheet.first))
    return [(moves, state, turn) for turn in found]


def _folds(state: SheetState) -> int:
    """Return how many creases are folded."""
    return int(state.folded.sum())


def _best(turns: Iterator[Turn]) -> Turn | None:
    """Return the turn of the most creases, then of the fewest faces."""
    return max(turns, key=_key, default=None)


def _key(turn: Turn, first: Bools | None = None) -> tuple[bool, int, int]:
    """Return what turns are compared by, the best last; one of ``first`` creases only comes after all."""
    return first is not None and bool(first[turn.edges].all()), int(turn.edges.sum()), -int(turn.faces.sum())


def _collapses(sheet: SheetData, state: SheetState, target: SheetState) -> Iterator[_Move]:
    """Yield the collapses between two states: one for each set of creases that folds flat without the others.

    The verifier decides whether the sheet can lie flat with only these creases folded.
    """
    wholes = CreaseSets(sheet, state.folded, target.folded)
    tries = MOST_TRIES
    while (target.folded != state.folded).any():
        after = target
        for folded in wholes.supersets(state.folded):
            tries -= 1
            if tries < 0:
                break
            part = partly_folded(sheet, folded, target)
            if part is not None and is_one_sheet(part, target):
                after = part
                break
        yield _Move(state, after, None)
        state = after


def _replayed(pattern: FoldedPattern, state: SheetState, moves: Sequence[_Move]) -> Iterator[FoldingStep]:
    """Yield the moves as steps, each from where the last one left the sheet; the larger part of it stays in place."""
    sheet = state.sheet
    for move in moves:
        edges = np.flatnonzero(move.after.folded & ~move.before.folded)
        if move.turn is None:
            state = move.after.laid_on(state)
            yield FoldingStep(index_array(edges), state.public, groups=groups_of(pattern, edges))
            continue
        hinge = state.at[sheet.ends[edges[sheet.lengths[edges].argmax()]]]
        along = (hinge[1] - hinge[0]) / math.dist(*hinge)
        faces = move.turn.faces
        rest = state.sides(hinge[0], along)[~faces]
        if sheet.areas[faces].sum() > sheet.areas[~faces].sum() and (rest.min() >= 0 or rest.max() <= 0):
            faces = ~faces
        over = bool(sheet.valley[edges[0]] == state.up[sheet.beside[edges[0], 0]])
        places = (state.at[sheet.ends[edges]].reshape(-1, 2) - hinge[0]) @ along
        line = hinge[0] + np.array([[places.min()], [places.max()]]) * along
        state = state.turned(Turn(faces, hinge[0], along, over, move.turn.edges))
        moved = index_array(np.flatnonzero(faces))
        yield FoldingStep(index_array(edges), state.public, points_array(line), moved, over)
