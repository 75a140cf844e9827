"""A sheet with some of its creases folded, its layers in an order that the verifier accepts."""

from __future__ import annotations

import heapq
from dataclasses import replace

import numpy as np

from foldcut.core.arrays import Bools, index_array
from foldcut.folding_steps.state import SheetData, SheetState, kept_together
from foldcut.pattern.face_maps import fold_faces
from foldcut.proof.verify import verify

__all__ = ["partly_folded"]


def partly_folded(sheet: SheetData, folded: Bools, end: SheetState) -> SheetState | None:
    """Return the sheet with the creases ``folded``, ``(e,)``, or None if the verifier accepts no order that is found.

    The order of the layers follows from the mountains and valleys, and from the order in ``end`` where faces lie on
    each other as they do there. Whatever is still free is ordered as in ``end``.
    """
    kinds = np.where(folded | ~sheet.creased, sheet.pattern.edges_assignment, "F")
    pattern = replace(sheet.pattern, edges_assignment=kinds)
    maps = fold_faces(pattern, sheet.beside)
    at = np.empty_like(sheet.flat)
    at[sheet.faces.values] = maps.apply(sheet.faces.rows, sheet.flat[sheet.faces.values])
    count = len(sheet.faces)
    state = SheetState(sheet, at, np.arange(count), folded)
    parts, part = state.parts(folded, None)
    left, right = sheet.beside[folded].T
    rising = state.up[left] == sheet.valley[folded]
    below = [(np.where(rising, left, right), np.where(rising, right, left))]
    one, other = np.nonzero(np.triu(state.meet))
    kept, same = kept_together(state, end, one, other)
    one, other = one[kept], other[kept]
    rising = (end.rank[one] < end.rank[other]) == same[one]
    below.append((np.where(rising, one, other), np.where(rising, other, one)))
    low, high = (part[np.concatenate(side)] for side in zip(*below, strict=True))
    largest = np.full(parts, -1)
    for face in np.argsort(sheet.areas).tolist():
        largest[part[face]] = face
    order = _sorted_parts(low.tolist(), high.tolist(), end.rank[largest].tolist())
    if order is None:
        return None
    rank = np.argsort(np.lexsort((np.arange(count), np.argsort(order)[part])))
    if verify(pattern, index_array(np.argsort(rank))):
        return None
    return SheetState(sheet, at, rank, folded, state.meet)


def _sorted_parts(low: list[int], high: list[int], wish: list[int]) -> list[int] | None:
    """Sort parts so that each of ``low`` comes before its ``high``, and else by ``wish``; None if that is circular."""
    after: list[set[int]] = [set() for _ in wish]
    for a, b in zip(low, high, strict=True):
        if a != b:
            after[a].add(b)
    waits = [0] * len(wish)
    for some in after:
        for b in some:
            waits[b] += 1
    ready = [(wish[k], k) for k in range(len(wish)) if not waits[k]]
    heapq.heapify(ready)
    order = []
    while ready:
        _, k = heapq.heappop(ready)
        order.append(k)
        for b in after[k]:
            waits[b] -= 1
            if not waits[b]:
                heapq.heappush(ready, (wish[b], b))
    return order if len(order) == len(wish) else None
