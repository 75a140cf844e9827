"""Outlines covered with many small disks, and the folding of very many turns."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import shapely
from support.compact import A4, loop_of, many_corners
from support.strategies import star_shaped

import foldcut
from foldcut.core.model import Finding, Shape
from foldcut.methods.compact import budget, trials
from foldcut.methods.compact import many_disks as disks
from foldcut.methods.compact.linear_program import Program
from foldcut.methods.compact.many_disks import corner_distances, many_disks
from foldcut.methods.compact.molecule import NotClosedError
from foldcut.methods.compact.outline import Outline
from foldcut.methods.compact.pattern import Molecules, Walk
from foldcut.methods.compact.search import Compact, fold_compact
from foldcut.pattern.ranking import shortest_crease
from foldcut.proof.verify import verify


def test_many_small_disks_always_fit() -> None:
    for seed in range(4):
        outline = Outline(loop_of(star_shaped(np.random.default_rng(seed), 10 + 5 * seed)))
        solution = many_disks(outline, 0.02)
        assert Program(outline, solution.turns).true_clearance(solution) >= 0.02
        step = np.abs(solution.x - np.roll(solution.x, -1))
        assert np.allclose(np.bincount(solution.turns.side, step), outline.length)


def test_corners_are_as_far_from_other_sides_as_the_nearest_of_all() -> None:
    for seed in range(4):
        outline = Outline(loop_of(star_shaped(np.random.default_rng(seed), 12)))
        count = len(outline.loop)
        sides = shapely.linestrings(np.stack([outline.loop, np.roll(outline.loop, -1, axis=0)], axis=1))
        away = shapely.distance(shapely.points(outline.loop)[:, None], sides)
        away[np.arange(count), np.arange(count)] = away[np.arange(count), np.arange(count) - 1] = np.inf
        nearest = away.min(axis=1)
        assert np.allclose(corner_distances(outline, 1.5 * nearest), nearest)
        assert np.isinf(corner_distances(outline, 0.5 * nearest)).all(), "nothing farther is looked at"


def test_a_shape_that_takes_too_long_is_folded_with_many_disks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(budget, "PATIENCE", 0)
    monkeypatch.setitem(budget.EFFORT_SECONDS, "fast", 1e-6)
    loop = loop_of(star_shaped(np.random.default_rng(3), 20))
    found = fold_compact(loop, A4, effort="fast")
    assert len(found.walk.x) > 60
    assert verify(found.creases, found.folded.layers, Shape((loop,), (-1,))) == []


def walks_of(found: Callable[[], object], monkeypatch: pytest.MonkeyPatch) -> list[Walk]:
    """The walks that are folded on the way."""
    walks: list[Walk] = []
    build = trials.build_molecules

    def noting(walk: Walk, *rest: Any) -> Molecules:
        walks.append(walk)
        return build(walk, *rest)

    monkeypatch.setattr(trials, "build_molecules", noting)
    found()
    return walks


def test_creases_that_are_too_short_to_be_told_apart_are_mended_where_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(budget, "PATIENCE", 0)
    loop = many_corners()
    shortest = shortest_crease(fold_compact(loop, A4, effort="fast").creases)
    least = 1.001 * shortest / A4.diagonal
    monkeypatch.setattr(trials, "COINCIDENT", (least, 0.0))
    as_it_is = fold_compact(loop, A4, effort="fast")
    assert (as_it_is.tried, shortest_crease(as_it_is.creases)) == (1, shortest), "verified, so left as it is"
    monkeypatch.setattr(trials, "COINCIDENT", (least, least))
    found: list[Compact] = []
    first, *_, last = walks_of(lambda: found.append(fold_compact(loop, A4, effort="fast")), monkeypatch)
    assert shortest_crease(found[0].creases) > 1.001 * shortest
    assert verify(found[0].creases, found[0].folded.layers, Shape((loop,), (-1,))) == []
    same = (last.points[:, None] == first.points).all(axis=2).any(axis=1)
    assert 0.9 < same.mean() < 1


def test_short_creases_are_mended_where_verification_finds_something(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(budget, "PATIENCE", 0)
    loop = many_corners()
    shortest = shortest_crease(fold_compact(loop, A4, effort="fast").creases)
    monkeypatch.setattr(trials, "COINCIDENT", (1.001 * shortest / A4.diagonal, 0.0))
    answers = iter([[Finding("planar", "too near")], []])
    monkeypatch.setattr(trials, "verify", lambda *_: next(answers))
    found: list[Compact] = []
    first, last = walks_of(lambda: found.append(fold_compact(loop, A4, effort="fast")), monkeypatch)
    assert shortest_crease(found[0].creases) > 1.001 * shortest
    same = (last.points[:, None] == first.points).all(axis=2).any(axis=1)
    assert 0.9 < same.mean() < 1, "only what they come from is moved"


def test_a_molecule_that_does_not_close_is_mended_where_it_does_not(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(budget, "PATIENCE", 0)
    loop, build = many_corners(), trials.build_molecules
    calls: list[Walk] = []

    def failing(walk: Walk, *rest: Any) -> Molecules:
        calls.append(walk)
        if len(calls) < 3:
            raise NotClosedError("no", {17})
        return build(walk, *rest)

    monkeypatch.setattr(trials, "build_molecules", failing)
    fold_compact(loop, A4, effort="fast")
    _, second, third = calls
    moved = np.flatnonzero(~(third.points[:, None] == second.points).all(axis=2).any(axis=1))
    assert 0 < len(moved) < 20
    assert np.hypot(*(third.points[moved] - second.points[17]).T).max() < 20


def test_a_time_too_short_for_one_program_is_not_spent_on_it(monkeypatch: pytest.MonkeyPatch) -> None:
    def program(*_: Any) -> None:
        raise AssertionError("no time for this")

    monkeypatch.setattr(Program, "__init__", program)
    monkeypatch.setattr(budget, "PATIENCE", 0)
    found = fold_compact(many_corners(), A4, seconds=100.0)
    assert len(found.walk.x) > 400


def test_the_time_allowed_ends_the_folding_of_very_many_turns() -> None:
    seen: list[float] = []
    with pytest.raises(foldcut.UnfoldableError, match=r"folding 160 corners takes longer than 0.001 s; .*--seconds"):
        fold_compact(many_corners(), A4, seconds=0.001, progress=lambda _, part: seen.append(part))
    assert max(seen) < 0.5


def test_ctrl_c_ends_the_folding_of_very_many_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(budget, "PATIENCE", 0)

    def interrupting(*_: object) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fold_compact(many_corners(), A4, effort="fast", progress=interrupting)


def test_a_crease_of_very_many_that_is_too_short_ends_the_folding(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(budget, "PATIENCE", 0)
    loop = many_corners()
    creases = fold_compact(loop, A4, effort="fast").creases
    parts: list[float] = []
    with pytest.raises(foldcut.CreaseTooShortError, match="with 160 corners creases get too short") as no:
        fold_compact(loop, A4, effort="fast", least=0.5, progress=lambda _, part: parts.append(part))
    assert parts == [0.0], "at once"
    assert 0 < no.value.length < 0.5
    ends = creases.vertices_coords[creases.edges_vertices]
    lengths = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    at = int(np.hypot(*(ends.mean(axis=1) - no.value.place).T).argmin())
    assert lengths[at] == pytest.approx(no.value.length, abs=1e-9), "the whole pattern has that crease"
    assert fold_compact(loop, A4, effort="fast", least=float(lengths.min())).tried == 1
    with pytest.raises(foldcut.CreaseTooShortError, match="with 160 corners .* than 0.5 mm; .*--simplify"):
        foldcut.fold([loop], A4, method="compact", effort="fast")


def test_progress_of_many_turns_goes_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(budget, "PATIENCE", 0)
    told: list[tuple[str, float]] = []
    found = fold_compact(many_corners(), A4, effort="fast", progress=lambda *told_now: told.append(told_now))
    folding = [part for text, part in told if text == f"folding: {len(found.walk.x)} turns"]
    assert len(folding) > 4
    assert folding == sorted(folding)
    assert 0 < folding[0] < folding[-1] < 1


def test_a_feature_that_is_too_fine_is_refused_with_its_place(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(disks, "MOST_DISKS", 20)
    with pytest.raises(foldcut.UnfoldableError, match=r"feature near \(.* mm is so fine"):
        many_disks(Outline(loop_of([(0, 0), (40, 0), (0, 1)])), 0.02)
