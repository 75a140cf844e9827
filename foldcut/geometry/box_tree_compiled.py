"""The search of ``box_tree.LayerTree``, compiled: each query walks down the tree on its own.

It imports numba, so it is imported only for many boxes.
"""

from __future__ import annotations

import numpy as np

from foldcut.core.compiled import compiler

__all__ = ["search"]

njit = compiler()

SHIFT = 3
"""The same as ``box_tree.SHIFT``: each node joins 2 ** SHIFT of the level below."""


@njit(cache=True, nogil=True)
def search(own_low, own_high, lows, highs, starts, low, high, first, last, queries, at, out):
    """Write (query, item) pairs to ``out``, ``(n, 2)``, until it is full; return how many, and the next query.

    ``own_low`` and ``own_high`` are the boxes themselves; ``lows`` and ``highs`` are the nodes, level by level, with
    level l starting at ``starts[l - 1]``. A query begins only if ``out`` still has room for every item it could meet:
    ``out`` must have room for the longest run.
    """
    columns = low.shape[1]
    top = len(starts) - 1 if len(own_low) > (1 << SHIFT) else 0
    path = np.empty((SHIFT * (top + 1)) * (1 << SHIFT), dtype=np.int64)
    height = np.empty(len(path), dtype=np.int64)
    count = 0
    while at < len(queries):
        query = queries[at]
        start, stop = first[query], last[query] - 1
        if count + (stop + 1 - start) > len(out):
            return count, at
        level = 0
        begin, end = start, stop
        while end - begin >= (1 << SHIFT) and level < top:
            begin, end, level = begin >> SHIFT, end >> SHIFT, level + 1
        depth = 0
        while True:
            # visit this level's nodes from last to first, so that they come off the stack in order
            for node in range(end, begin - 1, -1) if level > 0 else range(begin, end + 1):
                meets = True
                if level > 0:
                    place = starts[level - 1] + node
                    for column in range(columns):
                        if lows[place, column] > high[query, column] or highs[place, column] < low[query, column]:
                            meets = False
                            break
                    if meets:
                        path[depth], height[depth] = node, level
                        depth += 1
                else:
                    for column in range(columns):
                        if own_low[node, column] > high[query, column] or own_high[node, column] < low[query, column]:
                            meets = False
                            break
                    if meets:
                        out[count, 0], out[count, 1] = query, node
                        count += 1
            if depth == 0:
                break
            depth -= 1
            node, level = path[depth], height[depth] - 1
            begin, end = (
                max(node << SHIFT, start >> (SHIFT * level)),
                min(((node + 1) << SHIFT) - 1, stop >> (SHIFT * level)),
            )
        at += 1
    return count, at
