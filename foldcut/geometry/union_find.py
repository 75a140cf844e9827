"""Which things hang together, from pairs that do."""

from __future__ import annotations

from collections.abc import Sequence


def groups(count: int, pairs: Sequence[Sequence[int]]) -> list[int]:
    """For each of so many things the first of those that hang together with it by pairs."""
    first = list(range(count))

    def find(one: int) -> int:
        while first[one] != one:
            first[one] = first[first[one]]
            one = first[one]
        return one

    for one, other in pairs:
        low, high = sorted((find(one), find(other)))
        first[high] = low
    return [find(one) for one in range(count)]
