"""A tree over a row of boxes: finds which boxes in a run of the row, from one place to another, meet a query's box.

The row is the layer order, and what could lie between two layers is a run of it. Eight neighbouring boxes, or nodes,
are joined into one node of the next level, so a run that stays on one side of a fold is dismissed after one comparison,
however many layers it has. In flat-folded patterns nearly everything overlaps nearly everything, and this keeps the
layer checks fast. A query begins on the level where a few nodes cover its run, so short runs never use the tree.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Floats, Numbers
from foldcut.core.compiled import COMPILED
from foldcut.geometry.polygons import runs

__all__ = ["LayerTree"]

Indices = NDArray[np.intp]

BATCH = 1 << 17
"""How many pairs are compared together; it bounds the memory and does not change the result."""

MANY_BOXES = 100_000
"""From this many boxes on, compiled code saves more time than loading it takes."""

MANY_BOXES_ONCE_LOADED = 10_000
"""From this many boxes on, compiled code is faster, loading aside."""

SHIFT = 3
"""Each node joins 2 ** SHIFT boxes, or nodes of the level below."""


def _compiled_search() -> Callable[..., tuple[int, int]] | None:
    """Return the search in compiled code, or None where numba does not work."""
    try:
        from foldcut.geometry.box_tree_compiled import search
    except ImportError:
        return None
    found: Callable[..., tuple[int, int]] = search
    return found


class LayerTree:
    """Boxes in a row, given by their least and greatest coordinates ``low`` and ``high``, ``(n, k)`` each.

    Both arrays are kept, not copied.
    """

    def __init__(self, low: Floats, high: Floats) -> None:
        self._levels = [(low, high)]  # level 0: the boxes themselves
        while len(low) > 1 << SHIFT:
            low, high = _joined(low, np.minimum), _joined(high, np.maximum)
            self._levels.append((low, high))
        pays = COMPILED.pays(len(self._levels[0][0]), MANY_BOXES, MANY_BOXES_ONCE_LOADED)
        self._compiled = _compiled_search() if pays else None
        if self._compiled:
            joined = self._levels[1:] or self._levels
            self._starts = np.cumsum([0] + [len(low) for low, _ in joined])
            self._lows, self._highs = (np.concatenate(boxes) for boxes in zip(*joined, strict=True))

    @property
    def is_compiled(self) -> bool:
        """Whether compiled code searches this tree."""
        return self._compiled is not None

    def meetings(self, low: Floats, high: Floats, first: Numbers, last: Numbers) -> Iterator[tuple[Indices, Indices]]:
        """Yield (query, item) index arrays: the boxes ``first <= item < last`` that meet a query's box.

        ``low`` and ``high`` are ``(q, k)``. Boxes meet unless some column keeps them apart.
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
        """Return (level, queries, nodes): each query's run, covered on the lowest level where few nodes suffice."""
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
        """Find the meetings with compiled code."""
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
    """Return the least, or greatest, of every eight rows."""
    whole = len(boxes) >> SHIFT << SHIFT
    joined = least.reduce(boxes[:whole].reshape(-1, 1 << SHIFT, boxes.shape[1]), axis=1)
    if whole < len(boxes):
        joined = np.concatenate([joined, least.reduce(boxes[whole:], axis=0)[None]])
    return np.asarray(joined)
