"""The search for few creases."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import pytest
from support.compact import A4, loop_of
from support.folded import fold_sample
from support.strategies import cross, rectangle, regular, star, star_shaped, two_opt

import foldcut
from foldcut.methods.compact import trials
from foldcut.methods.compact.pattern import Molecules
from foldcut.methods.compact.search import fold_compact
from foldcut.pattern.foldability import crease_numbers
from foldcut.samples import sample_path


@pytest.mark.parametrize(
    ("shape", "most"),
    [
        ([(0, 0), (4, 0), (2, 3.4641016151377544)], 4),
        ([(0, 0), (4, 0), (1, 3)], 4),
        *((regular(n), 2 * n - 2) for n in range(3, 13)),
        (rectangle(3, 1), 10),
        (star(5, 0.4), 10),
        (star(6, 0.5), 12),
        ([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)], 12),
    ],
)
def test_simple_shapes_need_as_few_creases_as_measured(shape: list[tuple[float, float]], most: int) -> None:
    found = fold_compact(loop_of(shape), A4, effort="fast")
    if found.creases.crease_count > most:  # a short look is not enough for some
        found = fold_compact(loop_of(shape), A4, effort="normal")
    assert found.creases.crease_count <= most


@pytest.mark.parametrize(
    ("shape", "most"),
    [
        (cross(), 80),
        ([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)], 10),
        ([(0, 3), (0, 2), (1, 2), (1, 0), (2, 0), (2, 2), (3, 2), (3, 3)], 30),
    ],
)
def test_straight_lines_are_as_few_as_the_plan_asks(shape: list[tuple[float, float]], most: int) -> None:
    assert crease_numbers(fold_compact(loop_of(shape), A4, effort="fast").creases).lines <= most


@pytest.mark.parametrize("name", ["arrow", "fish", "heart", "kite", "letter-l", "letter-t", "swan"])
def test_samples_are_folded_verified_and_cut_exactly(name: str) -> None:
    result = fold_sample(name, method="compact")
    assert result.findings == ()
    paper = foldcut.fold(sample_path(name), method="paper")
    assert result.folded_pattern.creases.crease_count < 0.5 * paper.folded_pattern.creases.crease_count


def test_the_same_input_gives_the_same_pattern() -> None:
    loop = loop_of(star_shaped(np.random.default_rng(5), 9))
    one, two = (fold_compact(loop, A4, effort="fast") for _ in range(2))
    assert np.array_equal(one.creases.vertices_coords, two.creases.vertices_coords)
    assert one.tried == two.tried


def test_ctrl_c_returns_the_best_so_far(monkeypatch: pytest.MonkeyPatch) -> None:
    real, calls = trials.build_molecules, 0

    def interrupted(*args: Any) -> Molecules:
        nonlocal calls
        calls += 1
        if calls == 4:
            raise KeyboardInterrupt
        return real(*args)

    monkeypatch.setattr(trials, "build_molecules", interrupted)
    found = fold_compact(loop_of(regular(5)), A4, effort="best")
    assert found.interrupted
    assert found.creases.crease_count <= 10


def test_ctrl_c_before_the_first_pattern_is_passed_on(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(trials, "build_molecules", interrupted)
    with pytest.raises(KeyboardInterrupt):
        fold_compact(loop_of(regular(5)), A4, effort="fast")


def test_progress_shows_the_best_count_so_far() -> None:
    seen: list[tuple[str, float]] = []
    fold_compact(loop_of(regular(6)), A4, effort="fast", progress=lambda text, part: seen.append((text, part)))
    assert seen[-1][0] == "searching: 10 creases"
    assert all(0 <= part < 1 for _, part in seen)


def test_a_ribbon_keeps_the_strip_beside_the_cut_free_of_events() -> None:
    found = fold_compact(loop_of(star_shaped(np.random.default_rng(1), 8)), A4, ribbon=0.5, effort="fast")
    heights = np.abs(found.folded.vertices_coords[:, 1])
    assert heights.min() >= 0.5


def test_a_shape_without_room_for_the_ribbon_is_refused() -> None:
    with pytest.raises(foldcut.UnfoldableError, match="no compact pattern was found"):
        fold_compact(loop_of(star(5, 0.4)), A4, ribbon=80.0, effort="fast")


@pytest.mark.parametrize("seed", range(int(os.environ.get("FOLDCUT_RANDOM_COMPACT", "24"))))
def test_random_polygons_are_folded_and_verified(seed: int) -> None:
    rng = np.random.default_rng(seed)
    corners = int(rng.integers(4, 61 if "FOLDCUT_RANDOM_COMPACT" in os.environ else 31))
    points = (star_shaped, two_opt)[seed % 2](rng, corners)
    result = foldcut.fold([points], method="compact", effort="fast", min_crease=0)
    assert result.findings == ()
