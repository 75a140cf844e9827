"""Corners moved so that nodes meet, and how far outlines are from their drawing."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest
import shapely
from support.outlines import A4, corners_of, engine_for, on_a4, random_outline

from foldcut.core.arrays import Floats
from foldcut.core.model import Shape, Sheet
from foldcut.redraw.proxy import Assessment, Engine, Field, Meeting, Tie
from foldcut.redraw.search import candidates

pytestmark = pytest.mark.usefixtures("kernels_are_loaded")

EXACT_MM = 1e-8

REACH = 20.0


def spread(points: Floats, sizes: Sequence[int], tie: Tie) -> float:
    """How far the sides of a tie are from being equally far from one point, in mm: by least squares over lines."""
    ends = np.concatenate([np.roll(loop, -1, axis=0) for loop in np.split(points, np.cumsum(sizes)[:-1])])
    rows, values = [], []
    for side in tie:
        start, end = points[side // 2], ends[side // 2]
        normal = np.array([start[1] - end[1], end[0] - start[0]]) / math.dist(start, end) * (1 if side % 2 == 0 else -1)
        rows.append([*normal, -1.0])
        values.append(normal @ start)
    found = np.linalg.lstsq(np.array(rows), np.array(values), rcond=None)[0]
    return float(np.abs(np.array(rows) @ found - values).max())


def solved(engine: Engine, one: Assessment, most: int) -> list[tuple[Tie | None, Meeting | None, Floats]]:
    """Ties and meetings of an outline that could be made, and the corners they lead to."""
    found = []
    for candidate in candidates(one, REACH)[:most]:
        ties = [candidate.tie] if candidate.tie else []
        meetings = [candidate.meeting] if candidate.meeting else []
        points = engine.solve(one.points, one.loop_sizes, ties, meetings)
        if points is not None:
            found.append((candidate.tie, candidate.meeting, points))
    return found


def start(kind: str, seed: int, tolerance: float = 3.0) -> tuple[Engine, Assessment]:
    shape = random_outline(kind, seed)
    engine = engine_for(shape, tolerance=tolerance)
    one = engine.assess(*corners_of(shape), reach=REACH)
    assert one is not None
    return engine, one


@pytest.mark.parametrize("kind", ["star", "tour", "apart"])
def test_ties_hold_and_corners_stay_near(kind: str) -> None:
    made = 0
    for seed in range(6):
        engine, one = start(kind, seed)
        for tie, _, points in solved(engine, one, 40):
            if tie is None:
                continue
            made += 1
            assert spread(one.points, one.loop_sizes, tie) > EXACT_MM, "it held before"
            assert spread(points, one.loop_sizes, tie) < EXACT_MM
            assert np.hypot(*(points - one.points).T).max() < 60
    assert made >= 10


@pytest.mark.parametrize("seed", range(4))
def test_what_is_tied_is_one_node_of_the_skeleton(seed: int) -> None:
    engine, one = start("star", seed)
    seen = 0
    for tie, _, points in solved(engine, one, 30):
        if tie is None or not engine.is_good(points, one.loop_sizes):
            continue
        after = engine.assess(points, one.loop_sizes, reach=REACH)
        assert after is not None
        nodes = [set(sides) for sides in after.details.sides.values()]
        seen += any(node.issuperset(tie) for node in nodes)
    assert seen >= 1


def test_meetings_hold() -> None:
    """The perpendicular's end is looked up in a new skeleton: it comes to the node, and passed it by before."""
    made = 0
    for seed in range(6):
        engine, one = start("star", seed)
        for _, meeting, points in solved(engine, one, 60):
            if meeting is None or not engine.is_good(points, one.loop_sizes):
                continue
            after = engine.assess(points, one.loop_sizes, reach=REACH)
            if after is None:
                continue
            sides = after.details.sides
            if sorted(meeting.start) not in map(sorted, sides.values()):
                continue
            if sorted(meeting.end) not in map(sorted, sides.values()):
                continue  # the skeleton is another: nothing to look up
            for begin, end, way, _ in after.details.paths:
                if tuple(sides.get(begin, ())) == meeting.start and way[: len(meeting.way)] == meeting.way:
                    made += end >= 0 and sides.get(end) == meeting.end
    assert made >= 3


def test_several_ties_hold_at_once_and_those_before_are_kept() -> None:
    engine, one = start("tour", 2)
    ties: list[Tie] = []
    points = one.points
    for candidate in candidates(one, REACH):
        if candidate.tie is None or any(set(candidate.tie) & set(tie) for tie in ties):
            continue
        moved = engine.solve(points, one.loop_sizes, [*ties, candidate.tie])
        if moved is not None:
            points, ties = moved, [*ties, candidate.tie]
    assert len(ties) >= 2
    assert max(spread(points, one.loop_sizes, tie) for tie in ties) < EXACT_MM


def test_without_ties_corners_go_to_the_drawing() -> None:
    """A shaken outline is fitted to the drawing again: what is asked for is nothing but the best fit."""
    shape = random_outline("star", 5)
    points, sizes = corners_of(shape)
    engine = engine_for(shape, tolerance=2.0)
    shaken = points + np.random.default_rng(1).uniform(-1, 1, points.shape)
    fitted = engine.solve(shaken, sizes, [])
    assert fitted is not None
    assert engine.deviation(fitted, sizes) < 0.5 * engine.deviation(shaken, sizes)


def test_tightened_outlines_are_within_a_tolerance_that_the_best_fit_does_not_keep_to() -> None:
    """A polygon of eight sides about a circle of 80 mm can be 3.2 mm off, uneven ones by least squares are farther."""
    turns = math.tau * np.arange(300) / 300
    circle = Shape((np.stack([150 + 80 * np.cos(turns), 150 + 80 * np.sin(turns)], axis=1),), (-1,))
    engine = engine_for(circle, Sheet(300.0, 300.0), tolerance=3.3)
    uneven = math.tau * (np.arange(8) + np.random.default_rng(2).uniform(-0.15, 0.15, 8)) / 8
    points = 150 + 80 * np.stack([np.cos(uneven), np.sin(uneven)], axis=1)
    fitted, tight = engine.solve(points, (8,), []), engine.tighten(points, (8,), [])
    assert fitted is not None
    assert tight is not None
    assert engine.deviation(fitted, (8,)) > 3.3
    assert engine.deviation(tight, (8,)) <= 3.3
    assert engine_for(circle, Sheet(300.0, 300.0), tolerance=3.1).tighten(points, (8,), []) is None


def test_tightened_outlines_keep_their_ties() -> None:
    """Ties that the best fit can only hold beyond the tolerance are held within it, exactly."""
    made = 0
    for seed in range(8):
        engine, one = start("star", seed, tolerance=2.0)
        for tie, meeting, points in solved(engine, one, 20):
            off = engine.deviation(points, one.loop_sizes, 5.0)
            if tie is None or not 2.0 < off < math.inf:
                continue
            tight = engine.tighten(points, one.loop_sizes, [tie], [meeting] if meeting else [])
            if tight is not None:
                made += 1
                assert spread(tight, one.loop_sizes, tie) < EXACT_MM
                assert engine.is_good(tight, one.loop_sizes)
    assert made >= 5


@pytest.mark.parametrize(
    ("points", "tie"),
    [
        # one corner to be as far from two parallel sides that face away from it: no such node within reach
        ([(0, 0), (100, 0), (100, 20), (0, 20)], (0, 1, 2, 3)),
        ([(0, 0), (100, 0), (100, 20), (0, 20)], (0, 1, 4, 5)),
        ([(0, 0), (100, 0), (100, 100), (0, 100)], (0, 1, 6, 7)),
    ],
)
def test_what_has_no_solution_is_refused(points: list[tuple[float, float]], tie: Tie) -> None:
    shape = on_a4([np.array(points, dtype=float)])
    engine = engine_for(shape)
    found = engine.solve(*corners_of(shape), [tie])
    assert found is None or spread(found, (len(points),), tie) < EXACT_MM


def test_what_would_move_corners_far_beyond_the_tolerance_is_refused() -> None:
    """The four sides of a long rectangle have one node only if it is a square."""
    shape = on_a4([np.array([(0, 0), (100, 0), (100, 40), (0, 40)], dtype=float)])
    tie = (0, 2, 4, 6)
    assert engine_for(shape, tolerance=1.0).solve(*corners_of(shape), [tie]) is None
    nearly = on_a4([np.array([(0, 0), (100, 0), (100, 99), (0, 99)], dtype=float)])
    found = engine_for(nearly, tolerance=2.0).solve(*corners_of(nearly), [tie])
    assert found is not None
    assert spread(found, (4,), tie) < EXACT_MM


def test_meetings_of_parallel_sides_are_refused() -> None:
    shape = on_a4([np.array([(0, 0), (100, 0), (100, 40), (0, 40)], dtype=float)])
    meeting = Meeting((0, 2, 6), (0, 4), (0, 4, 4))
    assert engine_for(shape).solve(*corners_of(shape), [], [meeting]) is None


def test_more_than_there_is_room_for_is_refused() -> None:
    shape = on_a4([np.array([(0, 0), (100, 0), (100, 40), (0, 60)], dtype=float)])
    engine = engine_for(shape)
    points, sizes = corners_of(shape)
    meeting = Meeting((0, 2, 6), (0, 4), (2, 4, 6))
    assert engine.solve(points, sizes, [], [meeting] * 65) is None
    assert engine.solve(points, sizes, [(0, 2, 4, 6)] * 100) is None


def test_compiled_and_plain_kernels_move_corners_alike() -> None:
    for seed in range(3):
        shape = random_outline("star", seed)
        engines = [engine_for(shape, tolerance=3.0, compiled=one) for one in (False, True)]
        points, sizes = corners_of(shape)
        one = engines[1].assess(points, sizes, reach=REACH)
        assert one is not None
        for candidate in candidates(one, REACH)[:5]:
            ties = [candidate.tie] if candidate.tie else []
            meetings = [candidate.meeting] if candidate.meeting else []
            plain, compiled = (engine.solve(points, sizes, ties, meetings) for engine in engines)
            assert (plain is None) == (compiled is None)
            if plain is not None and compiled is not None:
                assert plain == pytest.approx(compiled, abs=1e-9)
            if seed == 0 and candidate == candidates(one, REACH)[0]:
                plain, compiled = (engine.tighten(points, sizes, ties, meetings) for engine in engines)
                assert (plain is None) == (compiled is None)
                if plain is not None and compiled is not None:
                    assert plain == pytest.approx(compiled, abs=1e-6)
        shaken = points + np.random.default_rng(seed).normal(0, 1, points.shape)
        plain_off, compiled_off = (engine.deviation(shaken, sizes) for engine in engines)
        assert plain_off == pytest.approx(compiled_off, abs=1e-9)


def hausdorff(some: Sequence[Floats], others: Sequence[Floats]) -> float:
    """The Hausdorff distance by an independent library, of outlines with a point every 0.2 mm."""
    lines = [shapely.segmentize(shapely.MultiLineString([np.concatenate([loop, loop[:1]]) for loop in loops]), 0.2)
             for loops in (some, others)]  # fmt: skip
    return float(shapely.hausdorff_distance(*lines))


def blob(seed: int, count: int = 400) -> Shape:
    """A smooth closed curve as a dense polygon."""
    rng = np.random.default_rng(seed)
    angles = math.tau * np.arange(count) / count
    radius = 1 + sum(rng.uniform(-0.25, 0.25) / k * np.cos(k * angles + rng.uniform(0, 6)) for k in range(2, 6))
    return on_a4([np.stack([radius * np.cos(angles), radius * np.sin(angles)], axis=1)])


@pytest.mark.parametrize("seed", range(6))
def test_the_deviation_is_the_distance_between_outline_and_drawing(seed: int) -> None:
    """It is taken at points of both, so it may be a little less than the true distance, and never more."""
    rng = np.random.default_rng(seed)
    shape = blob(seed)
    field = Field(shape.loops, A4.width, A4.height, 4.0)
    engine = Engine(field)
    compared = 0
    for count in (9, 14, 30, 40, 50):
        points = shape.loops[0][np.sort(rng.choice(len(shape.loops[0]), count, replace=False))]
        points = points + rng.normal(0, 0.5, points.shape)
        off, true = engine.deviation(points, (count,)), hausdorff([points], shape.loops)
        if math.isinf(off):
            ring = shapely.LinearRing(points)
            # beyond 2.5 tolerances the distance is not looked for; too sharp corners are refused, too
            assert true > 2 * field.tolerance or not ring.is_simple or _sharpest(points) < 2.0
            continue
        assert off >= true - max(0.6, 0.1 * true)
        if true < 2 * field.tolerance:  # beyond that, it may say more
            assert off <= true + 0.2
            compared += 1
    assert compared


def _sharpest(points: Floats) -> float:
    """The smallest angle between neighbouring sides, in degrees."""
    one, other = np.roll(points, 1, axis=0) - points, np.roll(points, -1, axis=0) - points
    return float(np.degrees(np.abs(np.angle((one @ (1, 1j)) * (other @ (1, 1j)).conj()))).min())


def test_a_drawing_that_is_left_out_counts_and_so_does_an_outline_where_nothing_is_drawn() -> None:
    square = np.array([(0, 0), (100, 0), (100, 100), (0, 100)], dtype=float)
    hole = square * 0.3 + 35
    both, alone = on_a4([square, hole]), on_a4([square])
    assert engine_for(both).deviation(*corners_of(alone)) > 40
    assert not engine_for(both).is_good(*corners_of(alone))
    assert math.isinf(engine_for(alone).deviation(*corners_of(both)))


def test_outlines_that_cross_or_touch_are_not_good() -> None:
    shape = on_a4([np.array([(0, 0), (100, 0), (100, 100), (50, 50.4), (0, 100)], dtype=float)])
    points, sizes = corners_of(shape)
    engine = engine_for(shape, tolerance=200.0)
    assert engine.is_good(points, sizes)
    for y in (points[0, 1], points[0, 1] - 5):  # the inner corner on the lowest side, and below it
        moved = points.copy()
        moved[3, 1] = y
        assert not engine.is_good(moved, sizes)
    for seed in range(30):
        shaken = points + np.random.default_rng(seed).normal(0, 40, points.shape)
        if not shapely.LinearRing(shaken).is_simple:
            assert not engine.is_good(shaken, sizes), seed


def test_the_comparison_can_fail() -> None:
    engine, one = start("star", 0)
    tie, points = next((tie, points) for tie, _, points in solved(engine, one, 40) if tie is not None)
    moved = points.copy()
    moved[tie[0] // 2] += 0.001
    assert spread(moved, one.loop_sizes, tie) > EXACT_MM
