"""The path of the pen: the order and direction of strokes that makes the travel between them short.

Runs -> the same runs in another order, some of them reversed. A *run* is the strokes of one crease or mark, ``(n, 2)``
each, which stay together in their order: one stroke, or the dashes of a line. *Travel* is how far the pen, the laser
head or the knife moves between strokes, in mm.

Strokes that go on where another ends are joined first. The nearest free end comes next (greedy), and then stretches of
the path are reversed for as long as that shortens it (2-opt). docs/jobs.md has how near to the shortest path that
comes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely

from foldcut.core.arrays import Floats

Run = list[Floats]

PASSES = 20
"""2-opt goes over the whole path this often at most."""

MOST_RUNS = 4000
"""Above this many runs the nearest end is looked up in a tree, and 2-opt, whose time grows with the square, is left
out."""


def travel(runs: Sequence[Sequence[Floats]], start: Floats) -> float:
    """Return the length of the moves between strokes in mm, the one from ``start`` to the first stroke included."""
    strokes = [stroke for run in runs for stroke in run]
    ways = [math.dist(start, strokes[0][0]), *(math.dist(a[-1], b[0]) for a, b in pairwise(strokes))]
    return sum(ways)


def ordered(runs: list[Run], start: Floats) -> list[Run]:
    """Return the runs, some of them reversed, in an order that makes the travel from ``start`` on short."""
    ends = np.array([[run[0][0], run[-1][-1]] for run in runs])
    order, reverse = nearest_next(ends, start) if len(runs) <= MOST_RUNS else nearest_next_by_tree(ends, start)
    if len(runs) <= MOST_RUNS:
        order, reverse = two_opt(ends, order, reverse, start)
    reversed_runs = ([stroke[::-1] for stroke in reversed(run)] for run in runs)
    both = list(zip(runs, reversed_runs, strict=True))
    return [both[run][back] for run, back in zip(order, reverse, strict=True)]


def joined(runs: list[Run]) -> list[Run]:
    """Return the runs with strokes joined that end where one other begins or ends; dashes are left as they are."""
    single = [run[0] for run in runs if len(run) == 1]
    if len(single) < 2:
        return runs
    merged = shapely.get_parts(shapely.line_merge(shapely.multilinestrings([shapely.linestrings(s) for s in single])))
    return [*([shapely.get_coordinates(line)] for line in merged), *(run for run in runs if len(run) > 1)]


def chained(runs: list[Run]) -> list[Run]:
    """Return ordered runs with each stroke joined to the one before it, if it begins where that ends."""
    chain: list[Run] = []
    for run in runs:
        if chain and len(run) == len(chain[-1]) == 1:
            before, after = chain[-1][0], run[0]
            closed = any((stroke[0] == stroke[-1]).all() for stroke in (before, after))
            if not closed and (before[-1] == after[0]).all():
                chain[-1] = [np.concatenate([before, after[1:]])]
                continue
        chain.append(run)
    return chain


def nearest_next(ends: Floats, start: Floats) -> tuple[list[int], list[bool]]:
    """Return an order of runs in which the one with the nearest end comes next, and which of them are reversed.

    ``ends``, ``(n, 2, 2)``: where each run starts and ends.
    """
    left = np.ones(len(ends), dtype=bool)
    here, order, reverse = start, [], []
    for _ in ends:
        away = np.where(left[:, None], ((ends - here) ** 2).sum(axis=2), np.inf)
        run, end = divmod(int(away.argmin()), 2)
        left[run] = False
        order.append(run)
        reverse.append(bool(end))
        here = ends[run, 1 - end]
    return order, reverse


def nearest_next_by_tree(ends: Floats, start: Floats) -> tuple[list[int], list[bool]]:
    """Do as ``nearest_next`` in less time for many runs; of ends that are equally near it takes any.

    The tree is made anew whenever half of its runs are used up.
    """
    from scipy.spatial import KDTree

    order: list[int] = []
    reverse: list[bool] = []
    here, left = start, np.ones(len(ends), dtype=bool)
    while len(order) < len(ends):
        runs = np.flatnonzero(left)
        tree = KDTree(ends[runs].reshape(-1, 2))
        for _ in range((len(runs) + 1) // 2):
            count = 2
            while True:
                near = runs[(found := np.atleast_1d(tree.query(here, k=min(count, tree.n))[1])) // 2]
                if left[near].any():
                    break
                count *= 4
            first = int(np.argmax(left[near]))
            run, end = int(near[first]), int(found[first]) % 2
            left[run] = False
            order.append(run)
            reverse.append(bool(end))
            here = ends[run, 1 - end]
    return order, reverse


def two_opt(ends: Floats, order: list[int], reverse: list[bool], start: Floats) -> tuple[list[int], list[bool]]:
    """Reverse stretches of the path for as long as that makes it shorter, in at most ``PASSES`` passes."""
    path = np.where(np.array(reverse)[:, None, None], ends[order][:, ::-1], ends[order])  # (n, 2, 2): in, out
    number, turned = np.array(order), np.array(reverse)
    count = len(number)
    for _ in range(PASSES):
        better = False
        for i in range(count):
            before = path[i - 1, 1] if i else start
            # the stretch from i to j reversed; after the last run the path may end anywhere
            joined = np.hypot(*(path[i:, 1] - before).T)
            after = np.append(np.hypot(*(path[i + 1 :, 0] - path[i, 0]).T), 0.0)
            now = np.append(np.hypot(*(path[i + 1 :, 0] - path[i:-1, 1]).T), 0.0)
            gain = math.dist(before, path[i, 0]) + now - joined - after
            j = int(gain.argmax())
            if gain[j] > 1e-6:
                some = slice(i, i + j + 1)
                path[some] = path[some][::-1, ::-1].copy()
                number[some] = number[some][::-1].copy()
                turned[some] = ~turned[some][::-1]
                better = True
        if not better:
            break
    return number.tolist(), turned.tolist()
