"""Which of many boxes in a row meet a query's box, when only a run of the row counts.

The row is the layer order: what could lie between two layers is a run of it. Boxes are joined two by two into
a binary tree over the row, so a run that stays on one side of a fold is dismissed at a glance, however many
layers it has; on flat-folded patterns, where nearly everything overlaps nearly everything, this is what keeps
the layer checks fast.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from foldcut.model import Bools, Floats

__all__ = ["LayerTree"]

Indices = NDArray[np.intp]

BATCH = 1 << 17
"""Pairs looked at together; bounds the memory, not the result."""


MANY_QUERIES = 200_000
"""With more, loading compiled code takes less time than it saves."""


def _compiled_search() -> Callable[..., tuple[int, int]] | None:
    """Return the search in compiled code, or None without numba (extra ``fast``)."""
    try:
        from foldcut.layersearch import search
    except ImportError:
        return None
    found: Callable[..., tuple[int, int]] = search
    return found


class LayerTree:
    """Boxes in a row: their least and greatest coordinates ``low`` and ``high``, ``(n, k)`` each."""

    def __init__(self, low: Floats, high: Floats) -> None:
        size = 1 << max(len(low) - 1, 0).bit_length()
        self._lows = np.full((2 * size - 1, low.shape[1]), np.inf)
        self._highs = np.full((2 * size - 1, low.shape[1]), -np.inf)
        self._lows[: len(low)], self._highs[: len(low)] = low, high
        self._starts = np.zeros(1, dtype=np.int64)  # of the levels, boxes by themselves first
        low, high = self._lows[:size], self._highs[:size]
        self._levels = [(low, high)]
        while size > 1:
            start, size = int(self._starts[-1]) + size, size // 2
            self._starts = np.append(self._starts, start)
            np.minimum(low[::2], low[1::2], out=self._lows[start : start + size])
            np.maximum(high[::2], high[1::2], out=self._highs[start : start + size])
            low, high = self._lows[start : start + size], self._highs[start : start + size]
            self._levels.append((low, high))

    def meetings(self, low: Floats, high: Floats, first: Indices, last: Indices) -> Iterator[tuple[Indices, Indices]]:
        """Yield (query, item) index arrays for the boxes ``first <= item < last`` that meet a query's box.

        ``low``, ``high`` are ``(q, k)``; boxes meet when no column keeps them apart.
        """
        queries = np.flatnonzero(first < last)
        if len(queries) >= MANY_QUERIES and (search := _compiled_search()):
            yield from self._search(search, low, high, first, last, queries)
            return
        todo = [(len(self._levels) - 1, queries, np.zeros_like(queries))]
        while todo:
            level, query, node = todo.pop()
            if len(query) > BATCH:
                todo += [(level, query[:BATCH], node[:BATCH]), (level, query[BATCH:], node[BATCH:])]
                continue
            keep = (node << level < last[query]) & (node + 1 << level > first[query])
            query, node = query[keep], node[keep]
            for column in range(low.shape[1]):
                keep = self._meet(level, column, node, low[query, column], high[query, column])
                query, node = query[keep], node[keep]
            if level == 0:
                yield query, node
            elif len(query):
                children = np.repeat(2 * node, 2)
                children[1::2] += 1
                todo.append((level - 1, np.repeat(query, 2), children))

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
        out = np.empty((max(BATCH, int((last - first).max())), 2), dtype=np.intp)
        at = 0
        low, high = np.ascontiguousarray(low), np.ascontiguousarray(high)
        while at < len(queries):
            count, at = search(self._lows, self._highs, self._starts, low, high, first, last, queries, at, out)
            if count:
                yield out[:count, 0].copy(), out[:count, 1].copy()

    def _meet(self, level: int, column: int, node: Indices, low: Floats, high: Floats) -> Bools:
        lows, highs = self._levels[level]
        meet: Bools = (lows[node, column] <= high) & (highs[node, column] >= low)
        return meet
