"""The search for an outline: what is tried, what is kept, and when it ends."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
import shapely
from support.outlines import corners_of, engine_for, random_outline

from foldcut.core.arrays import Floats
from foldcut.redraw.proxy import Assessment, Engine
from foldcut.redraw.search import EARLY, LEAST_GAIN, Search, _renumbered, candidates

pytestmark = pytest.mark.usefixtures("kernels_are_loaded")

WORK = 800


def start(seed: int, kind: str = "star", tolerance: float = 3.0) -> tuple[Engine, Assessment]:
    shape = random_outline(kind, seed)
    engine = engine_for(shape, tolerance=tolerance)
    one = Search(engine, WORK).assess(*corners_of(shape))
    assert one is not None
    return engine, one


def is_in_order(engine: Engine, one: Assessment) -> bool:
    """Whether an outline is simple, within the tolerance, and costs what it says."""
    loops = np.split(one.points, np.cumsum(one.loop_sizes)[:-1])
    again = engine.assess(one.points, one.loop_sizes)
    rings = shapely.MultiLineString([shapely.LinearRing(loop) for loop in loops])
    return (
        rings.is_simple
        and engine.is_good(one.points, one.loop_sizes)
        and again is not None
        and (one.is_believed or again.cost == one.cost)
    )


@pytest.mark.parametrize("seed", range(4))
def test_ties_make_outlines_cheaper_and_they_stay_within_the_tolerance(seed: int) -> None:
    engine, one = start(seed)
    found = Search(engine, 4 * WORK).greedy(one, 60)
    assert found.cost <= one.cost
    assert found is one or found.cost < one.cost - LEAST_GAIN
    assert is_in_order(engine, found)


def test_ties_save_folds_on_the_whole() -> None:
    before = after = 0
    for seed in range(6):
        engine, one = start(seed)
        before += one.cost
        after += Search(engine, 4 * WORK).greedy(one, 60).cost
    assert after < 0.9 * before


@pytest.mark.parametrize(("kind", "seed"), [("star", 1), ("tour", 2), ("apart", 1)])
def test_the_best_is_at_least_as_good_as_every_start(kind: str, seed: int) -> None:
    shape = random_outline(kind, seed)
    engine = engine_for(shape, tolerance=2.0)
    points, sizes = corners_of(shape)
    starts = [(points, sizes), (points + np.random.default_rng(0).uniform(-0.5, 0.5, points.shape), sizes)]
    costs = [one.cost for some, sizes in starts if (one := engine.assess(some, sizes)) is not None]
    search = Search(engine, WORK)
    best = search.run(starts)
    assert best is not None
    assert best.cost <= min(costs)
    assert is_in_order(engine, best)


@pytest.mark.parametrize("seed", [3])
def test_the_same_seed_gives_the_same_outline_and_another_seed_another(seed: int) -> None:
    def found(of: int) -> bytes:
        shape = random_outline("tour", seed)
        best = Search(engine_for(shape, tolerance=2.0), WORK // 2, seed=of).run([corners_of(shape)])
        assert best is not None
        return best.points.tobytes()

    first = found(1)
    assert first == found(1)
    assert {first} != {found(2), found(3)}


def test_the_search_does_no_more_than_it_may() -> None:
    shape = random_outline("star", 1)
    engine = engine_for(shape)
    Search(engine, 200).run([corners_of(shape)])
    assert engine.assessed + 6 * engine.solved + 10 * engine.tightened < 200 + 200


def test_it_ends_when_it_is_told_to() -> None:
    shape = random_outline("star", 1)
    engine = engine_for(shape)
    parts: list[float] = []
    search = Search(engine, 10**9, ends=lambda part: (parts.append(part), len(parts) > 20)[1])
    assert search.run([corners_of(shape)]) is not None
    assert len(parts) <= 23
    assert parts == sorted(parts)


def test_it_ends_when_nothing_becomes_better_for_a_third_of_the_work() -> None:
    shape = random_outline("star", 9)
    engine = engine_for(shape, tolerance=0.01)  # nothing can be moved
    search = Search(engine, 3000)
    search.run([corners_of(shape)])
    assert search.spent < 2000 + search.last_gain


def test_outlines_that_cannot_be_folded_are_not_the_best() -> None:
    """What is refused costs more from then on, and each outline is asked about once."""
    shape = random_outline("tour", 5)
    asked: list[Assessment] = []

    def believe(one: Assessment) -> float:
        asked.append(one)
        return 100.0 if len(asked) == 1 else 0.0

    search = Search(engine_for(shape, tolerance=2.0), 2 * WORK, believe=believe)
    best = search.run([corners_of(shape)])
    assert best is not None
    assert len({id(one) for one in asked}) == len(asked)
    assert best is not asked[0]


def test_an_outline_is_believed_before_all_outlines_to_begin_with_are_made() -> None:
    """So there soon is a first pattern."""
    shape = random_outline("tour", 5)
    points, sizes = corners_of(shape)
    made: list[int] = []
    believed_after: list[int] = []

    def starts() -> Iterator[tuple[Floats, tuple[int, ...]]]:
        for number in range(EARLY[0] + 4):
            made.append(number)
            yield points + np.random.default_rng(number).uniform(-0.3, 0.3, points.shape), sizes

    def believe(_: Assessment) -> float:
        believed_after.append(len(made))
        return 0.0

    Search(engine_for(shape, tolerance=2.0), WORK, believe=believe).run(starts())
    assert believed_after[0] == EARLY[0]
    assert len(made) == EARLY[0] + 4


@pytest.mark.parametrize(("part", "given_up"), [(0.2, True), (2.0, False)])
def test_a_search_that_seems_to_end_with_far_more_than_is_wanted_is_given_up(part: float, given_up: bool) -> None:
    shape = random_outline("star", 9)
    engine = engine_for(shape, tolerance=0.01)  # nothing can be moved, so the cost stays
    points, sizes = corners_of(shape)
    cost = Search(engine, WORK).assess(points, sizes)
    assert cost is not None
    engine.assessed = engine.solved = engine.tightened = 0
    search = Search(engine, 1200, wanted=part * cost.cost)
    best = search.run([(points, sizes)])
    assert best is not None
    assert search.is_given_up == given_up
    assert (search.spent < 400) == given_up


def test_nothing_comes_of_no_starts() -> None:
    shape = random_outline("star", 1)
    assert Search(engine_for(shape), WORK).run([]) is None


def test_candidates_come_in_order_and_say_something_new() -> None:
    _, one = start(2)
    found = candidates(one, 20.0)
    assert found
    assert [one.weight for one in found] == sorted(one.weight for one in found)
    known = {frozenset(sides) for sides in one.details.sides.values()}
    for candidate in found:
        assert (candidate.tie is None) != (candidate.meeting is None)
        if candidate.tie is not None:
            assert len(candidate.tie) > 3
            assert frozenset(candidate.tie) not in known
            assert list(candidate.tie) == sorted(set(candidate.tie))


@pytest.mark.parametrize("kind", ["star", "holes"])
def test_changed_outlines_have_as_many_corners_as_their_loops_say_and_ties_of_their_sides(kind: str) -> None:
    moves = (
        "_without_corner",
        "_with_corner_across",
        "_shaken",
        "_slid",
        "_without_sides",
        "_with_bend",
        "_without_bend",
    )
    made = dict.fromkeys(moves, 0)
    for seed in range(2):
        engine, one = start(seed, kind)
        one = Search(engine, 4 * WORK).greedy(one, 40)
        search = Search(engine, WORK, seed)
        for move in moves:
            for _ in range(15):
                outline = getattr(search, move)(one)
                if outline is None:
                    continue
                made[move] += 1
                assert len(outline.points) == sum(outline.loop_sizes), move
                assert len(outline.loop_sizes) == len(one.loop_sizes), move
                assert min(outline.loop_sizes) >= 3, move
                for tie in outline.ties:
                    assert list(tie) == sorted(set(tie)), move
                    assert 0 <= tie[0] <= tie[-1] < 2 * len(outline.points), move
    needed = set(moves) - {"_without_bend"}
    assert all(made[move] for move in needed), made


def test_ties_are_renumbered_with_their_sides() -> None:
    ties = [(0, 3, 4, 8), (2, 4, 6, 9)]
    # edge 1 (sides 2 and 3) goes, the edges after it count one less
    number = {k: k - (k > 1) for k in range(6) if k != 1}
    assert _renumbered(ties, number) == []
    assert _renumbered([(0, 3, 4, 8, 10)], number) == [(0, 2, 6, 8)]
