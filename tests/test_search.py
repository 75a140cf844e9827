"""The choice of reaches and the search for few creases."""

from __future__ import annotations

import numpy as np
import pytest
from strategies import cross, rectangle, regular, star, star_shaped

import foldcut
from foldcut import search
from foldcut.model import Floats, Sheet
from foldcut.reaches import Layout, Program, corner_places, sees_each_other
from foldcut.samples import sample_path
from foldcut.search import crowded_chain, fold_compact
from foldcut.shape import make_shape
from foldcut.sheet import parse_sheet, place
from foldcut.skeleton import side_nodes

A4 = parse_sheet("a4")


def loop_of(points: list[tuple[float, float]], sheet: Sheet = A4) -> Floats:
    return place(make_shape([points]), sheet)[0].loops[0]


@pytest.mark.parametrize(
    ("shape", "most"),
    [
        ([(0, 0), (4, 0), (2, 3.4641016151377544)], 4),
        ([(0, 0), (4, 0), (1, 3)], 4),
        *((regular(n), 2 * n - 2) for n in range(3, 13)),
        (rectangle(3, 1), 10),
        (star(5, 0.4), 10),
        (star(6, 0.5), 12),
        (cross(), 90),
        ([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)], 12),
    ],
)
def test_simple_shapes_need_as_few_creases_as_measured(shape: list[tuple[float, float]], most: int) -> None:
    found = fold_compact(loop_of(shape), A4, effort="fast")
    assert found.creases.crease_count <= most


@pytest.mark.parametrize("name", ["arrow", "fish", "heart", "kite", "letter-l", "letter-t", "swan"])
def test_samples_are_folded_verified_and_cut_exactly(name: str) -> None:
    result = foldcut.fold(sample_path(name), method="compact", effort="fast", min_crease=0)
    assert result.findings == ()
    paper = foldcut.fold(sample_path(name), method="paper")
    assert result.folded_pattern.creases.crease_count < 0.5 * paper.folded_pattern.creases.crease_count


def test_the_same_input_gives_the_same_pattern() -> None:
    loop = loop_of(star_shaped(np.random.default_rng(5), 9))
    one, two = (fold_compact(loop, A4, effort="fast") for _ in range(2))
    assert np.array_equal(one.creases.vertices_coords, two.creases.vertices_coords)
    assert one.tried == two.tried


def test_ctrl_c_returns_the_best_so_far(monkeypatch: pytest.MonkeyPatch) -> None:
    real, calls = search._fold, 0

    def interrupted(*arguments: object) -> object:
        nonlocal calls
        calls += 1
        if calls == 4:
            raise KeyboardInterrupt
        return real(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(search, "_fold", interrupted)
    found = fold_compact(loop_of(regular(5)), A4, effort="best")
    assert found.interrupted
    assert found.creases.crease_count <= 10


def test_ctrl_c_before_the_first_pattern_is_passed_on(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(search, "_fold", interrupted)
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


def test_the_crowded_chain_keeps_its_clearance() -> None:
    for seed in range(4):
        loop = loop_of(star_shaped(np.random.default_rng(seed), 10 + 5 * seed))
        start = crowded_chain(loop, 0.02)
        assert np.allclose(corner_places(start.layout, start.reach, start.depth)[start.layout.place == 0], loop)
        assert Program(start.layout, start.root, 0, clearance=0.02).keeps(start)


def test_taking_a_corner_away_keeps_the_clearance() -> None:
    start = crowded_chain(loop_of(rectangle(5, 1)), 0.02)
    corner = int(np.flatnonzero(start.layout.place > 0)[0])
    program = Program(start.layout, len(start.reach) - 1, corner + 2, clearance=0.02)
    fewer = program.without(start, corner)
    assert fewer is not None
    assert len(fewer.layout) == len(start.layout) - 1
    assert fewer.clearance == 0.02


def test_reaches_go_to_and_fro_as_long_as_the_sides_are() -> None:
    loop = loop_of(star_shaped(np.random.default_rng(2), 7))
    layout = Layout.build(loop, [0] * 7)
    solution = Program(layout, 0, 3, clearance=0.01).solve()
    assert solution is not None
    length = solution.reach + np.roll(solution.reach, -1) - 2 * solution.depth
    assert np.allclose(length, np.hypot(*(np.roll(loop, -1, axis=0) - loop).T))
    assert solution.depth[[0, 3]] == pytest.approx(0, abs=1e-9)
    assert solution.depth.min() > -1e-9


def test_corners_behind_a_side_are_not_seen() -> None:
    c = np.array([(0, 0), (6, 0), (6, 1), (1, 1), (1, 2), (6, 2), (6, 3), (0, 3)], dtype=float)
    i, j = np.array([0, 1, 1, 2], dtype=np.int32), np.array([3, 6, 5, 5], dtype=np.int32)
    assert sees_each_other(c, i, j).tolist() == [True, False, False, True]


def test_the_skeletons_nodes_stand_over_the_sides_that_vanish() -> None:
    nodes = side_nodes(np.array([(0, 0), (3, 0), (3, 1), (0, 1)], dtype=float))
    assert {(node.side, round(node.along, 9), round(node.height, 9)) for node in nodes} >= {
        (1, 0.5, 0.5),
        (3, 0.5, 0.5),
    }
    triangle = side_nodes(np.array([(0, 0), (4, 0), (0, 3)], dtype=float))
    assert sorted((node.side, round(node.along, 9)) for node in triangle) == [(0, 1.0), (1, 3.0), (2, 2.0)]


def test_a_feature_that_is_too_fine_is_refused_with_its_place(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "MOST_DISKS", 20)
    with pytest.raises(foldcut.UnfoldableError, match=r"feature near \(.* mm is so fine"):
        crowded_chain(loop_of([(0, 0), (40, 0), (0, 1)]), 0.02)


@pytest.mark.parametrize("seed", range(10))
def test_random_polygons_are_folded_and_verified(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    loop = loop_of(star_shaped(rng, int(rng.integers(4, 16)), min_feature=0.05))
    assert fold_compact(loop, A4, effort="fast").creases.crease_count > 0
