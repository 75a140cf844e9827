"""Curves: points, tangents, boxes, maps, flattening, and how far they are from polygons (against shapely)."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest
import shapely

from foldcut.core.arrays import Floats
from foldcut.geometry.curves import Arc, Bezier, CurvedLoop, Line, Segment, farthest_apart, is_within

TURNED = np.array([(0.6, -0.8, 3.0), (0.8, 0.6, -2.0)])
MIRRORED = np.array([(-1.5, 0.0, 1.0), (0.0, 1.5, 4.0)])
SHEARED = np.array([(1.0, 0.4, 0.0), (0.2, 2.0, 5.0)])

SEGMENTS = {
    "line": Line(np.array([1.0, 2.0]), np.array([7.0, -3.0])),
    "quadratic": Bezier(np.array([(0.0, 0.0), (5.0, 9.0), (11.0, 1.0)])),
    "cubic": Bezier(np.array([(0.0, 0.0), (9.0, 12.0), (-4.0, 11.0), (6.0, 1.0)])),
    "circle": Arc.of_circle((3.0, 4.0), 5.0, 0.3, 4.0),
    "ellipse": Arc(np.array([1.0, 1.0]), np.array([4.0, 1.0]), np.array([-1.0, 7.0]), -2.5),
}


@pytest.fixture(params=sorted(SEGMENTS))
def segment(request: pytest.FixtureRequest) -> Segment:
    return SEGMENTS[request.param]


def dense(segment: Segment, count: int = 20_001) -> Floats:
    return segment.points(np.linspace(0, 1, count))


@pytest.mark.parametrize("matrix", [TURNED, MIRRORED, SHEARED], ids=["turned", "mirrored", "sheared"])
def test_points_of_the_moved_segment_are_the_moved_points(segment: Segment, matrix: Floats) -> None:
    t = np.linspace(0, 1, 17)
    assert segment.transformed(matrix).points(t) == pytest.approx(segment.points(t) @ matrix[:, :2].T + matrix[:, 2])


def test_tangents_are_those_of_differences(segment: Segment) -> None:
    t = np.linspace(0.05, 0.95, 9)
    step = segment.points(t + 1e-6) - segment.points(t - 1e-6)
    assert segment.tangents(t) == pytest.approx(step / np.hypot(*step.T)[:, None], abs=1e-6)


def test_reversed_and_parts(segment: Segment) -> None:
    t = np.linspace(0, 1, 9)
    assert segment.reversed().points(t) == pytest.approx(segment.points(1 - t))
    assert segment.between(0.2, 0.7).points(t) == pytest.approx(segment.points(0.2 + 0.5 * t))


def test_boxes_are_exact(segment: Segment) -> None:
    low, high = segment.box
    points = dense(segment)
    assert low == pytest.approx(points.min(axis=0), abs=1e-5)
    assert high == pytest.approx(points.max(axis=0), abs=1e-5)


@pytest.mark.parametrize("tolerance", [1.0, 0.1, 0.003])
def test_chords_are_within_the_tolerance(segment: Segment, tolerance: float) -> None:
    chords = shapely.linestrings(np.concatenate([segment.flattened(tolerance), [segment.end]]))
    assert shapely.distance(chords, shapely.points(dense(segment))).max() <= tolerance * (1 + 1e-9)


def test_cubics_are_the_segment(segment: Segment) -> None:
    points = np.concatenate([Bezier(one).points(np.linspace(0, 1, 50)) for one in segment.cubics])
    line = shapely.linestrings(dense(segment))
    assert shapely.distance(line, shapely.points(points)).max() < 1e-6


@pytest.mark.parametrize("sweep", [-90.0, -20.0, 45.0, 90.0, 120.0])
def test_cubics_that_stand_for_arcs(sweep: float) -> None:
    angle = math.radians(sweep)
    pull = 4 / 3 * math.tan(angle / 4)
    cosine, sine = math.cos(angle), math.sin(angle)
    unit = np.array([(1, 0), (1, pull), (cosine + pull * sine, sine - pull * cosine), (cosine, sine)])
    control = 7 * unit @ np.array([(0.6, 0.8), (-0.8, 0.6)]) + (3.0, 4.0)
    arc = Arc.of_cubic(control)
    assert arc is not None
    assert (arc.radius, *arc.centre, arc.sweep) == pytest.approx((7.0, 3.0, 4.0, angle))
    assert arc.points([0.0, 1.0]) == pytest.approx(control[[0, 3]])
    assert Arc.of_cubic(control + np.array([(0, 0), (0.01, 0), (0, 0), (0, 0)])) is None
    assert Arc.of_cubic(control * (1.0, 1.01)) is None


def test_a_tangent_where_control_points_coincide() -> None:
    cusp = Bezier(np.array([(0.0, 0.0), (0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]))
    assert cusp.tangents([0.0])[0] == pytest.approx((1.0, 0.0), abs=1e-3)
    assert cusp.tangents([1.0])[0] == pytest.approx((0.0, 1.0), abs=1e-3)


def test_turns_of_a_loop() -> None:
    half = Arc.of_circle((0.0, 0.0), 2.0, 0.0, math.pi)
    turns = CurvedLoop((half, Line(half.end, half.start))).turns
    assert turns == pytest.approx([math.pi / 2, math.pi / 2])
    smooth = CurvedLoop((half, Arc.of_circle((0.0, 0.0), 2.0, math.pi, math.pi)))
    assert smooth.turns == pytest.approx([0.0, 0.0], abs=1e-12)
    assert smooth.reversed().turns == pytest.approx([0.0, 0.0], abs=1e-12)


@pytest.mark.parametrize(("first", "last"), [(0.3, 2.6), (2.5, 4.2), (3.0, 1.0), (-0.4, 0.7), (1.2, 1.7)])
def test_parts_of_a_loop(first: float, last: float) -> None:
    loop = blob(np.random.default_rng(3), 3, "cubic")
    part = loop.part(first, last)
    places = np.linspace(0, 1, 7)
    ends = np.array([(one.start, one.end) for one in part])
    assert ends[:-1, 1] == pytest.approx(ends[1:, 0])
    assert (ends[0, 0], ends[-1, 1]) == (pytest.approx(loop.points([first])[0]), pytest.approx(loop.points([last])[0]))
    line = shapely.linestrings(loop.flattened(1e-6))
    assert shapely.distance(line, shapely.points(np.concatenate([one.points(places) for one in part]))).max() < 1e-3


def ring(points: Floats) -> shapely.Geometry:
    return shapely.linestrings(np.concatenate([points, points[:1]]))


def by_shapely(loops: list[CurvedLoop], polygons: list[Floats], tolerance: float = 4e-5) -> float:
    """The Hausdorff distance of finely flattened and densified lines."""
    one = shapely.segmentize(shapely.multilinestrings([ring(loop.flattened(tolerance)) for loop in loops]), 0.02)
    other = shapely.segmentize(shapely.multilinestrings([ring(polygon) for polygon in polygons]), 0.02)
    trees = shapely.STRtree(shapely.get_parts(one)), shapely.STRtree(shapely.get_parts(other))
    ends = []
    for points, tree in ((shapely.get_coordinates(one), trees[1]), (shapely.get_coordinates(other), trees[0])):
        _, distance = tree.query_nearest(shapely.points(points), return_distance=True, all_matches=False)
        ends.append(float(distance.max()))
    return max(ends)


def blob(rng: np.random.Generator, count: int, kind: str) -> CurvedLoop:
    """A closed loop of ``count`` curves around the origin, about 20 across."""
    angles = np.linspace(0, math.tau, count, endpoint=False) + rng.uniform(-0.2, 0.2, count) * math.tau / count
    corners = rng.uniform(7, 13, count)[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    ends = np.roll(corners, -1, axis=0)
    if kind == "lines":
        return CurvedLoop.of_points(corners)
    if kind == "quadratic":
        bends = (corners + ends) * rng.uniform(0.4, 0.7, count)[:, None]
        return CurvedLoop(tuple(Bezier(np.array(one)) for one in zip(corners, bends, ends, strict=True)))
    pulls = rng.normal(0, 3, (2, count, 2))
    return CurvedLoop(
        tuple(
            Bezier(np.array([a, a + (b - a) / 3 + p, b - (b - a) / 3 + q, b]))
            for a, b, p, q in zip(corners, ends, *pulls, strict=True)
        )
    )


@pytest.mark.parametrize("kind", ["lines", "quadratic", "cubic"])
@pytest.mark.parametrize("seed", range(3))
def test_farthest_apart_is_the_distance_that_shapely_finds(kind: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    loops = [blob(rng, 5 + seed, kind), blob(rng, 7, kind).transformed(np.array([(0.3, 0, 1.0), (0, 0.3, 0.5)]))]
    polygons = [loop.flattened(0.3) + rng.normal(0, 0.2, 2) for loop in loops]
    distance, place = farthest_apart(loops, polygons)
    assert distance == pytest.approx(by_shapely(loops, polygons), abs=2e-4)
    sets = [
        shapely.multilinestrings([ring(one) for one in lines])
        for lines in ([loop.flattened(1e-5) for loop in loops], polygons)
    ]
    ends = [float(shapely.distance(one, shapely.Point(place))) for one in sets]
    assert min(ends) < 1e-3
    assert max(ends) == pytest.approx(distance, abs=2e-4)


@pytest.mark.parametrize("kind", ["lines", "quadratic", "cubic"])
@pytest.mark.parametrize("seed", range(3))
def test_is_within_agrees_with_the_distance(kind: str, seed: int) -> None:
    rng = np.random.default_rng(seed + 20)
    loop = blob(rng, 6, kind)
    polygon = loop.flattened(0.2) + rng.normal(0, 0.1, 2)
    distance, _ = farthest_apart([loop], [polygon], 1e-6)
    assert is_within([loop], [polygon], distance + 2e-4)
    assert not is_within([loop], [polygon], distance - 1e-6)
    assert not is_within([loop], [polygon], distance / 3)
    assert is_within([loop], [polygon], 3 * distance)
    assert is_within([CurvedLoop.of_points(polygon)], [polygon], 1e-4)


def test_both_directions_count() -> None:
    square = np.array([(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)])
    spike = np.array([(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (5.0, 17.0), (4.9, 10.0), (0.0, 10.0)])
    assert farthest_apart([CurvedLoop.of_points(square)], [spike])[0] == pytest.approx(7.0, abs=1e-4)
    assert farthest_apart([CurvedLoop.of_points(spike)], [square])[0] == pytest.approx(7.0, abs=1e-4)


def test_a_loop_that_is_missing_is_far() -> None:
    one = CurvedLoop((Arc.of_circle((0.0, 0.0), 10.0),))
    hole = CurvedLoop((Arc.of_circle((0.0, 0.0), 2.0),))
    polygon = one.flattened(1e-3)
    assert farthest_apart([one, hole], [polygon])[0] == pytest.approx(8.0, abs=2e-3)
    assert farthest_apart([one], [polygon])[0] <= 1e-3


@pytest.mark.parametrize("sides", [3, 6, 17])
def test_a_circle_from_the_polygon_in_it(sides: int) -> None:
    circle = CurvedLoop((Arc.of_circle((1.0, 2.0), 50.0),))
    angles = math.tau * np.arange(sides) / sides
    polygon = np.array([1.0, 2.0]) + 50 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    distance, _ = farthest_apart([circle], [polygon])
    assert 50 * (1 - math.cos(math.pi / sides)) - 1e-4 <= distance <= 50 * (1 - math.cos(math.pi / sides)) + 1e-9


@pytest.mark.parametrize("matrix", [TURNED, MIRRORED, SHEARED], ids=["turned", "mirrored", "sheared"])
def test_nothing_is_apart_from_itself(matrix: Floats) -> None:
    points = blob(np.random.default_rng(4), 9, "lines").transformed(matrix).flattened(1.0)
    assert farthest_apart([CurvedLoop.of_points(points)], [points])[0] < 1e-12


def test_the_comparison_can_fail() -> None:
    rng = np.random.default_rng(0)
    loop = blob(rng, 6, "cubic")
    polygon = loop.flattened(0.05)
    moved = polygon.copy()
    moved[3] += 0.2
    assert farthest_apart([loop], [moved])[0] > farthest_apart([loop], [polygon])[0] + 0.05


def test_fifty_curves_from_forty_sides_take_no_time() -> None:
    loop = blob(np.random.default_rng(7), 50, "cubic").transformed(np.array([(10.0, 0, 0), (0, 10.0, 0)]))
    polygon = loop.points(np.linspace(0, 50, 40, endpoint=False))
    farthest_apart([loop], [polygon])
    start = time.process_time()
    for _ in range(5):
        farthest_apart([loop], [polygon])
    assert (time.process_time() - start) / 5 < 0.1
