"""The path of the pen: every stroke is made once, runs stay together, and 2-opt only ever shortens."""

from __future__ import annotations

import numpy as np
import pytest

from foldcut.core.arrays import Floats
from foldcut.jobs import pen_path
from foldcut.jobs.pen_path import nearest_next, nearest_next_by_tree, ordered, travel, two_opt

HERE = np.zeros(2)


def segments(count: int) -> Floats:
    """Return short random segments, ``(n, 2, 2)``."""
    random = np.random.default_rng(0)
    starts = random.uniform(0, 300, (count, 1, 2))
    return np.concatenate([starts, starts + random.uniform(-9, 9, (count, 1, 2))], axis=1)


def path_length(ends: Floats, order: list[int], reverse: list[bool]) -> float:
    return travel([[ends[run][::-1] if back else ends[run]] for run, back in zip(order, reverse, strict=True)], HERE)


def test_many_lines_are_ordered_as_few_are() -> None:
    ends = segments(2000)
    for count in (1, 2, 3, 50, 2000):
        assert nearest_next_by_tree(ends[:count], HERE) == nearest_next(ends[:count], HERE)


def test_travel_is_what_the_pen_moves_between_strokes() -> None:
    runs = [[np.array([[3.0, 4.0], [5.0, 4.0]]), np.array([[6.0, 4.0], [9.0, 4.0]])], [np.array([[9.0, 2.0], [0, 0]])]]
    assert travel(runs, HERE) == 5 + 1 + 2


@pytest.mark.parametrize("most", [10, pen_path.MOST_RUNS])
def test_every_stroke_is_made_once_and_runs_stay_together(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pen_path, "MOST_RUNS", most)
    dashes = [[a + (b - a) * np.array([[k / 3], [(k + 0.5) / 3]]) for k in range(3)] for a, b in segments(40)]
    numbers = {stroke.tobytes(): (run, k) for run, some in enumerate(dashes) for k, stroke in enumerate(some)}
    seen = []
    for run in ordered(dashes, HERE):
        found = [numbers.get(stroke.tobytes()) or numbers[stroke[::-1].tobytes()] for stroke in run]
        assert [k for _, k in found] in ([0, 1, 2], [2, 1, 0])
        assert len({number for number, _ in found}) == 1
        seen.append(found[0][0])
    assert sorted(seen) == list(range(40))


def test_two_opt_keeps_every_run_and_shortens_the_path() -> None:
    ends = segments(200)
    order, reverse = nearest_next(ends, HERE)
    better, turned = two_opt(ends, order, reverse, HERE)
    assert sorted(better) == sorted(order)
    assert path_length(ends, better, turned) < 0.95 * path_length(ends, order, reverse)


def test_two_opt_finds_the_path_along_a_row() -> None:
    ends = np.array([[[x, 0.0], [x + 1.0, 0.0]] for x in range(0, 20, 2)])
    order, reverse = two_opt(ends, [0, 3, 2, 1, *range(4, 10)], [False, True, True, True, *[False] * 6], HERE)
    assert (order, reverse) == (list(range(10)), [False] * 10)
