"""Brute force over all layer orders at one vertex: the oracle for what can fold there at all."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, permutations

EPSILON = 1e-9


def folds_flat(sectors: Sequence[float], creases: Sequence[str]) -> bool:
    """Tell whether any order of the sectors folds a vertex flat.

    ``sectors`` are the angles around the vertex in degrees, their alternating sum 0; ``creases`` "M" or "V", the i-th
    before sector i. Paper may neither pass through a crease nor two creases on one line through each other.
    """
    return any(_is_valid(sectors, creases, order) for order in permutations(range(len(sectors))))


def _is_valid(sectors: Sequence[float], creases: Sequence[str], order: Sequence[int]) -> bool:
    count = len(sectors)
    rank = {sector: place for place, sector in enumerate(order)}
    at = [0.0]
    for number, angle in enumerate(sectors):
        at.append(at[-1] + (angle if number % 2 == 0 else -angle))
    assert abs(at[-1]) < 1e-6, "Kawasaki's theorem does not hold"
    span = [(min(at[k], at[k + 1]), max(at[k], at[k + 1])) for k in range(count)]
    hinges = [(at[k], (k - 1) % count, k) for k in range(count)]
    for (place, one, two), kind in zip(hinges, creases, strict=True):
        up, down = (two, one) if two % 2 == 0 else (one, two)
        if (kind == "V") != (rank[down] > rank[up]):
            return False
        low, high = sorted((rank[one], rank[two]))
        if any(low < rank[k] < high and span[k][0] + EPSILON < place < span[k][1] - EPSILON for k in range(count)):
            return False
    for (place, a, b), (other, c, d) in combinations(hinges, 2):
        same_line = abs(place - other) < EPSILON and not {a, b} & {c, d}
        if same_line and (span[a][0] < place - EPSILON) == (span[c][0] < place - EPSILON):
            low, high = sorted((rank[a], rank[b]))
            if (low < rank[c] < high) != (low < rank[d] < high):
                return False
    return True
