"""The cheapest sets of edges that make nodes even: the same as by trying all sets."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from foldcut.methods.skeleton import even_sets
from foldcut.methods.skeleton.choices import _by_programming
from foldcut.methods.skeleton.even_sets import cheapest_even_sets

Edges = list[tuple[int, int]]


def is_even(edges: Edges, taken: tuple[int, ...], odd: set[int]) -> bool:
    ends = [node for number in taken for node in edges[number]]
    return all(ends.count(node) % 2 == (node in odd) for two in edges for node in two if node >= 0)


def by_trying_all(edges: Edges, cost: list[float], odd: set[int]) -> list[float]:
    sets = (taken for size in range(len(edges) + 1) for taken in combinations(range(len(edges)), size))
    return sorted(sum(cost[k] for k in taken) for taken in sets if is_even(edges, taken, odd))


def random_graph(seed: int) -> tuple[Edges, list[float], set[int]]:
    random = np.random.default_rng(seed)
    nodes = int(random.integers(2, 6))
    edges = [(int(random.integers(nodes)), int(random.integers(-2, nodes))) for _ in range(int(random.integers(4, 10)))]
    edges = [(a, max(b, -1)) for a, b in edges]
    cost = [float(x) for x in random.integers(-2 if seed % 2 else 1, 9, len(edges))]
    touched = sorted({node for two in edges for node in two if node >= 0})
    return edges, cost, {node for node in touched if random.random() < 0.5}


@pytest.mark.parametrize("seed", range(40))
def test_the_cheapest_sets_cost_what_they_do_by_trying_all(seed: int) -> None:
    edges, cost, odd = random_graph(seed)
    found = cheapest_even_sets(edges, cost, odd, 4)
    assert found is not None
    assert all(is_even(edges, tuple(taken), odd) for taken in found)
    assert len({tuple(taken) for taken in found}) == len(found)
    assert [sum(cost[k] for k in taken) for taken in found] == by_trying_all(edges, cost, odd)[:4]


@pytest.mark.parametrize("seed", range(3))
def test_integer_programming_finds_sets_of_the_same_cost(seed: int) -> None:
    edges, cost, odd = random_graph(2 * seed)
    edges = [(a, b if a != b else -1) for a, b in edges]
    found = cheapest_even_sets(edges, cost, odd, 3)
    assert found is not None
    other = list(_by_programming(edges, np.array(cost), odd, 3))
    assert [sum(cost[k] for k in taken) for taken in other] == [sum(cost[k] for k in taken) for taken in found]


def test_an_odd_node_without_edges_has_no_set_and_too_many_states_give_up(monkeypatch: pytest.MonkeyPatch) -> None:
    assert cheapest_even_sets([(0, -1)], [1.0], {1}) == []
    assert cheapest_even_sets([(0, 1)], [1.0], {0}) == []
    every = list(combinations(range(8), 2))
    assert cheapest_even_sets(every, [1.0] * len(every), {0, 1}) == [[every.index((0, 1))]]
    monkeypatch.setattr(even_sets, "MOST_STATES", 16)
    assert cheapest_even_sets(every, [1.0] * len(every), {0, 1}) is None
