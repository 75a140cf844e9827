"""The search of a ``LayerTree``, compiled: each query walks down the tree by itself.

Needs numba (extra ``fast``); imported only for many queries.
"""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["search"]


@njit(cache=True, nogil=True)
def search(lows, highs, starts, low, high, first, last, queries, at, out):
    """Write (query, item) pairs to ``out``, ``(n, 2)``, until it is full; return how many, and which query is next.

    ``lows`` and ``highs`` are all levels of the tree, the lowest first, each from its ``starts`` on. A query is only
    begun where there is room for all items it could meet, or ``out`` is empty: then it must be larger.
    """
    columns = low.shape[1]
    levels = len(starts)
    path = np.empty(2 * levels + 2, dtype=np.int64)
    height = np.empty(2 * levels + 2, dtype=np.int64)
    count = 0
    while at < len(queries):
        query = queries[at]
        if count + (last[query] - first[query]) > len(out):
            return count, at
        path[0], height[0] = 0, levels - 1
        depth = 1
        while depth > 0:
            depth -= 1
            node, level = path[depth], height[depth]
            if (node << level) >= last[query] or ((node + 1) << level) <= first[query]:
                continue
            place = starts[level] + node
            meets = True
            for column in range(columns):
                if lows[place, column] > high[query, column] or highs[place, column] < low[query, column]:
                    meets = False
                    break
            if not meets:
                continue
            if level == 0:
                out[count, 0], out[count, 1] = query, node
                count += 1
            else:
                path[depth], height[depth] = 2 * node + 1, level - 1
                path[depth + 1], height[depth + 1] = 2 * node, level - 1
                depth += 2
        at += 1
    return count, at
