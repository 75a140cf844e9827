"""The cheapest sets of edges of a graph with which the number of edges at every node is as wanted, even or odd.

Edges between nodes, or from a node to the *open* one (-1), at which any number may end -> such sets.

Known as T-joins; the cheapest come first. The nodes are taken one after the other, and with each of them its edges that
are left. Of two sets of the edges so far that leave the same nodes odd among those with edges to come, only the cheaper
one matters. These nodes are few, since all that is joined through the open node alone is independent.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Sequence

__all__ = ["cheapest_even_sets"]

OPEN = -1
"""The node at which any number of edges may end."""

MOST_STATES = 20_000
"""With more sets to remember than this at a time, the search is given up."""


def cheapest_even_sets(
    edges: Sequence[tuple[int, int]], cost: Sequence[float], odd: Collection[int], count: int = 1
) -> list[list[int]] | None:
    """Return up to ``count`` sets of edges, by number, with an odd number of ends at the ``odd`` nodes alone.

    The cheapest come first; of sets that cost the same, those with fewer edges, then those with lesser numbers.
    ``cost`` is one number for each edge, and may be negative. Returns None where the graph is too entangled for this.
    """
    order = _nodes_in_order(edges)
    if not set(odd) <= set(order):
        return []
    bit = {node: 1 << k for k, node in enumerate(order)}
    at: dict[int, list[int]] = defaultdict(list)
    for number, ends in enumerate(edges):
        for node in {*ends} - {OPEN}:
            at[node].append(number)
    target = sum(bit[node] for node in odd)
    # nodes that are not yet as wanted, as bits -> the cheapest sets: cost, how many edges, and the edges in reverse
    states: dict[int, list[_Found]] = {target: [(0.0, 0, ())]}
    free = [number for number, ends in enumerate(edges) if ends[0] == ends[1]]  # these change no node
    done: set[int] = set()
    for node in order:
        for number in at[node]:
            if number in done:
                continue
            done.add(number)
            if edges[number][0] == edges[number][1]:
                continue
            one, other = edges[number]
            change = bit.get(one, 0) ^ bit.get(other, 0)
            states = _with_edge(states, change, number, float(cost[number]), count)
            if len(states) * count > MOST_STATES:
                return None
        states = {left: found for left, found in states.items() if not left & bit[node]}
    for number in free:
        states = _with_edge(states, 0, number, float(cost[number]), count)
    return [sorted(numbers) for _, _, numbers in states.get(0, [])]


_Found = tuple[float, int, tuple[int, ...]]


def _with_edge(
    states: dict[int, list[_Found]], change: int, number: int, price: float, count: int
) -> dict[int, list[_Found]]:
    """Return the cheapest sets with and without one more edge."""
    grown: dict[int, list[_Found]] = {left: [*found] for left, found in states.items()}
    for left, found in states.items():
        grown.setdefault(left ^ change, []).extend(
            (paid + price, size + 1, (*numbers, number)) for paid, size, numbers in found
        )
    for found in grown.values():
        if len(found) > 1:
            found.sort()
            del found[count:]
    return grown


def _nodes_in_order(edges: Sequence[tuple[int, int]]) -> list[int]:
    """Return the nodes, each time the one that joins the fewest new ones to those that have been seen."""
    beside: dict[int, set[int]] = defaultdict(set)
    for one, other in edges:
        for a, b in ((one, other), (other, one)):
            if a != OPEN:
                beside[a] |= {b} - {OPEN, a}
    order: list[int] = []
    waiting = sorted(beside)
    near: set[int] = set()
    while waiting:
        pool = [node for node in waiting if node in near] or waiting
        node = min(pool, key=lambda one: (len(beside[one] - near - {one}), one))
        order.append(node)
        near |= {node} | beside[node]
        waiting.remove(node)
    return order
