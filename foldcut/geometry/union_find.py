"""Union-find: the groups into which things fall when some pairs of them belong together."""

from __future__ import annotations

from collections.abc import Sequence


def groups(count: int, pairs: Sequence[Sequence[int]]) -> list[int]:
    """Return for each of ``count`` things, numbered from 0, the least number in its group.

    The two things of each of ``pairs`` are in one group.
    """
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
