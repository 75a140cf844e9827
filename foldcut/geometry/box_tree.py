"""Which of many boxes in a row meet a query's box, when only a run of the row counts.

The row is the layer order: what could lie between two layers is a run of it. Boxes are joined eight by eight into
a tree over the row, so a run that stays on one side of a fold is dismissed at a glance, however many
layers it has; on flat-folded patterns, where nearly everything overlaps nearly everything, this is what keeps
the layer checks fast. A query begins where its run takes a few nodes, so that short runs never see the tree.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Floats, Numbers
from foldcut.geometry.polygons import runs

__all__ = ["LayerTree"]

Indices = NDArray[np.intp]

BATCH = 1 << 17
"""Pairs looked at together; bounds the memory, not the result."""

MANY_BOXES = 100_000
"""With more, loading compiled code takes less time than it saves; once loaded, it is used for a tenth of them."""

SHIFT = 3
"""The power of two of boxes that are joined."""


def _compiled_search() -> Callable[..., tuple[int, int]] | None:
    """Return the search in compiled code, or None without numba (extra ``fast``)."""
    try:
        from foldcut.geometry.box_tree_compiled import search
    except ImportError:
        return None
    found: Callable[..., tuple[int, int]] = search
    return found


class LayerTree:
    """Boxes in a row: their least and greatest coordinates ``low`` and ``high``, ``(n, k)`` each, which are kept."""

    def __init__(self, low: Floats, high: Floats) -> None:
        self._levels = [(low, high)]  # boxes by themselves first
        while len(low) > 1 << SHIFT:
            low, high = _joined(low, np.minimum), _joined(high, np.maximum)
            self._levels.append((low, high))
        few = MANY_BOXES // 10 if "foldcut.geometry.box_tree_compiled" in sys.modules else MANY_BOXES
        self._compiled = _compiled_search() if len(self._levels[0][0]) >= few else None
        if self._compiled:
            joined = self._levels[1:] or self._levels
            self._starts = np.cumsum([0] + [len(low) for low, _ in joined])
            self._lows, self._highs = (np.concatenate(boxes) for boxes in zip(*joined, strict=True))

    def meetings(self, low: Floats, high: Floats, first: Numbers, last: Numbers) -> Iterator[tuple[Indices, Indices]]:
        """Yield (query, item) index arrays for the boxes ``first <= item < last`` that meet a query's box.

        ``low``, ``high`` are ``(q, k)``; boxes meet when no column keeps them apart.
        """
        queries = np.flatnonzero(first < last)
        first, last = first.astype(np.intp), last.astype(np.intp)
        if self._compiled:
            yield from self._search(self._compiled, low, high, first, last, queries)
            return
        todo = self._begin(queries, first, last)
        while todo:
            level, query, node = todo.pop()
            if len(query) > BATCH:
                todo += [(level, query[BATCH:], node[BATCH:]), (level, query[:BATCH], node[:BATCH])]
                continue
            begin = node << SHIFT * level
            keep = (begin < last[query]) & (begin + (1 << SHIFT * level) > first[query])
            query, node = query[keep], node[keep]
            for column in range(low.shape[1]):
                keep = self._meet(level, column, node, low[query, column], high[query, column])
                query, node = query[keep], node[keep]
            if level == 0:
                yield query, node
            elif len(query):
                start = node << SHIFT
                count = np.minimum(len(self._levels[level - 1][0]) - start, 1 << SHIFT)
                todo.append((level - 1, np.repeat(query, count), runs(start, count)))

    def _begin(self, queries: Indices, first: Indices, last: Indices) -> list[tuple[int, Indices, Indices]]:
        """Return (level, queries, nodes): the nodes of each query's run, on the lowest level where they are few."""
        todo = []
        begin, end = first[queries], last[queries] - 1
        for level in range(len(self._levels)):
            few = (end - begin < 1 << SHIFT) | (level == len(self._levels) - 1)
            count = end[few] - begin[few] + 1
            todo.append((level, np.repeat(queries[few], count), runs(begin[few], count)))
            queries, begin, end = queries[~few], begin[~few] >> SHIFT, end[~few] >> SHIFT
        return todo

    def _search(
        self,
        search: Callable[..., tuple[int, int]],
        low: Floats,
        high: Floats,
        first: Indices,
        last: Indices,
        queries: Indices,
    ) -> Iterator[tuple[Indices, Indices]]:
        """Do the same with compiled code."""
        out = np.empty((max(BATCH, int((last - first).max(initial=0))), 2), dtype=np.intp)
        at = 0
        low, high = np.ascontiguousarray(low), np.ascontiguousarray(high)
        own_low, own_high = self._levels[0]
        while at < len(queries):
            count, at = search(
                own_low, own_high, self._lows, self._highs, self._starts, low, high, first, last, queries, at, out
            )
            if count:
                yield out[:count, 0].copy(), out[:count, 1].copy()

    def _meet(self, level: int, column: int, node: Indices, low: Floats, high: Floats) -> Bools:
        lows, highs = self._levels[level]
        meet: Bools = (lows[node, column] <= high) & (highs[node, column] >= low)
        return meet


def _joined(boxes: Floats, least: np.ufunc) -> Floats:
    """Return the least (or greatest) of every eight rows."""
    whole = len(boxes) >> SHIFT << SHIFT
    joined = least.reduce(boxes[:whole].reshape(-1, 1 << SHIFT, boxes.shape[1]), axis=1)
    if whole < len(boxes):
        joined = np.concatenate([joined, least.reduce(boxes[whole:], axis=0)[None]])
    return np.asarray(joined)
