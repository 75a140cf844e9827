"""The order of strokes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from foldcut.core.arrays import Floats

PASSES, MOST_LINES = 20, 4000
"""How often the whole way is gone through to make it shorter, and for how many lines at most; of more lines the nearest
ends are looked for in a tree."""


def travel(lines: Sequence[Sequence[Floats]], start: Floats) -> float:
    """The way between strokes in mm, from ``start`` on."""
    pieces = [piece for line in lines for piece in line]
    ways = [math.dist(start, pieces[0][0]), *(math.dist(a[-1], b[0]) for a, b in pairwise(pieces))]
    return sum(ways)


def _ordered(lines: list[list[Floats]], start: Floats) -> list[list[Floats]]:
    """Order lines, and turn them round, so that each begins near where the last one ended."""
    ends = np.array([[line[0][0], line[-1][-1]] for line in lines])
    order, back = _greedy(ends, start) if len(lines) <= MOST_LINES else _greedy_by_tree(ends, start)
    order, back = _two_opt(ends, order, back, start)
    turned = ([piece[::-1] for piece in reversed(line)] for line in lines)
    both = list(zip(lines, turned, strict=True))
    return [both[line][end] for line, end in zip(order, back, strict=True)]


def _greedy(ends: Floats, start: Floats) -> tuple[list[int], list[bool]]:
    """The line whose end is nearest next, and whether it is turned round; ``ends`` are ``(n, 2, 2)``."""
    left = np.ones(len(ends), dtype=bool)
    here, order, back = start, [], []
    for _ in ends:
        away = np.where(left[:, None], ((ends - here) ** 2).sum(axis=2), np.inf)
        line, end = divmod(int(away.argmin()), 2)
        left[line] = False
        order.append(line)
        back.append(bool(end))
        here = ends[line, 1 - end]
    return order, back


def _greedy_by_tree(ends: Floats, start: Floats) -> tuple[list[int], list[bool]]:
    """Do as ``_greedy`` for many lines, of ends equally far off any; the tree is made anew when half of it is gone."""
    from scipy.spatial import KDTree

    order: list[int] = []
    back: list[bool] = []
    here, left = start, np.ones(len(ends), dtype=bool)
    while len(order) < len(ends):
        lines = np.flatnonzero(left)
        tree = KDTree(ends[lines].reshape(-1, 2))
        for _ in range((len(lines) + 1) // 2):
            count = 2
            while True:
                near = lines[(found := np.atleast_1d(tree.query(here, k=min(count, tree.n))[1])) // 2]
                if left[near].any():
                    break
                count *= 4
            first = int(np.argmax(left[near]))
            line, end = int(near[first]), int(found[first]) % 2
            left[line] = False
            order.append(line)
            back.append(bool(end))
            here = ends[line, 1 - end]
    return order, back


def _two_opt(ends: Floats, order: list[int], back: list[bool], start: Floats) -> tuple[list[int], list[bool]]:
    """Turn stretches of the way round as long as that makes it shorter."""
    way = np.where(np.array(back)[:, None, None], ends[order][:, ::-1], ends[order])  # (n, 2, 2): in, out
    number, turned = np.array(order), np.array(back)
    count = len(number)
    for _ in range(PASSES if count <= MOST_LINES else 0):
        better = False
        for i in range(count):
            before = way[i - 1, 1] if i else start
            # the stretch from i to j turned round; after the last line the way ends anywhere
            joined = np.hypot(*(way[i:, 1] - before).T)
            after = np.append(np.hypot(*(way[i + 1 :, 0] - way[i, 0]).T), 0.0)
            now = np.append(np.hypot(*(way[i + 1 :, 0] - way[i:-1, 1]).T), 0.0)
            gain = math.dist(before, way[i, 0]) + now - joined - after
            j = int(gain.argmax())
            if gain[j] > 1e-6:
                some = slice(i, i + j + 1)
                way[some] = way[some][::-1, ::-1].copy()
                number[some] = number[some][::-1].copy()
                turned[some] = ~turned[some][::-1]
                better = True
        if not better:
            break
    return number.tolist(), turned.tolist()
