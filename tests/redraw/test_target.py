"""The target of redrawing: dense loops, true corners, samples, and how it lies in the frame."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from foldcut.core.arrays import Floats
from foldcut.core.model import Shape
from foldcut.drawing.curved import curves_of
from foldcut.drawing.laying import Laying
from foldcut.drawing.mend import Preparation, prepare
from foldcut.drawing.placement import Layout, parse_sheet
from foldcut.drawing.shape import make_shape
from foldcut.geometry.curves import Arc, Bezier, CurvedLoop, Line, farthest_apart
from foldcut.geometry.vectors import signed_area
from foldcut.methods.frame import frames
from foldcut.readers import Drawing, read_shape
from foldcut.readers.typed_text import draw_text
from foldcut.redraw.narrow_parts import small_parts
from foldcut.redraw.target import Target

SQUARE = np.array([(0.0, 0.0), (60.0, 0.0), (60.0, 60.0), (0.0, 60.0)])


def around(count: int, radius: float, start: float = 0.1) -> Floats:
    angles = start + math.tau * np.arange(count) / count
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def svg(path: str) -> Drawing:
    return read_shape("a.svg", data=f'<svg viewBox="0 0 100 100"><path d="{path}"/></svg>'.encode())


def of_path(path: str) -> Target:
    drawing = svg(path)
    shape = make_shape(drawing.loops)
    return Target.of(shape, curves_of(shape, drawing.loops, drawing.curves))


def of_points(*loops: Floats) -> Target:
    return Target.of(make_shape(loops))


def corner_points(target: Target, number: int = 0) -> Floats:
    return target.loops[number][target.true_corners[number]]


@pytest.mark.parametrize(
    ("path", "corners"),
    [
        ("M50 20A25 25 0 0 1 90 50Q80 70 50 95Q20 70 10 50A25 25 0 0 1 50 20Z", [(50, -20), (50, -95)]),
        ("M20 10H70A10 10 0 0 1 80 20V70A10 10 0 0 1 70 80H20A10 10 0 0 1 10 70V20A10 10 0 0 1 20 10Z", []),
        ("M20 10V90A40 40 0 0 0 20 10Z", [(20, -10), (20, -90)]),
        ("M10 50C10 10 90 10 90 50C60 45 40 45 10 50Z", [(10, -50), (90, -50)]),
    ],
    ids=["heart", "rounded", "D", "moon"],
)
def test_true_corners_of_curves(path: str, corners: list[tuple[float, float]]) -> None:
    found = sorted(map(tuple, corner_points(of_path(path)).round(6).tolist()))
    assert found == sorted((float(x), float(y)) for x, y in corners)


@pytest.mark.parametrize("radius", [0.5, 2.0, 20.0, 130.0])
@pytest.mark.parametrize("tolerance", [0.02, 0.07])
def test_flattened_circles_have_no_corners(radius: float, tolerance: float) -> None:
    loop = CurvedLoop((Arc.of_circle((3.0, 4.0), radius),)).flattened(tolerance)
    assert len(of_points(SQUARE * 10 - 200, loop).true_corners[1]) == 0


@pytest.mark.parametrize("count", [3, 5, 8, 12])
def test_regular_polygons_have_all_their_corners(count: int) -> None:
    assert len(of_points(around(count, 60.0)).true_corners[0]) == count


def test_a_straight_side_that_ends_in_a_flattened_curve_has_its_corner() -> None:
    """The end of a long line at a small half disc that meets it at right angles."""
    bump = np.array([(60.0, 27.0), (60.0, 33.0)])
    arc = Arc.of_circle((60.0, 30.0), 3.0, -math.pi / 2, math.pi).flattened(0.01)
    target = of_points(np.concatenate([SQUARE[:2], arc, bump[1:], SQUARE[2:]]))
    corners = corner_points(target)
    assert sorted(map(tuple, corners.tolist())) == sorted(map(tuple, [*SQUARE.tolist(), *bump.tolist()]))


def test_tiny_segments_between_two_others_hide_no_corner() -> None:
    """Programs close paths with lines of no length."""
    points = np.array([(0, 0), (50, 0), (50.0, 0.0), (50, 50), (0.001, 0.0005)], dtype=np.float64)
    loop = CurvedLoop(tuple(Line(a, b) for a, b in zip(points, np.roll(points, -1, axis=0), strict=True)))
    assert len(Target.of_curves([loop], [-1]).true_corners[0]) == 3


def test_all_loops_run_counter_clockwise_and_lie_on_their_curves() -> None:
    target = of_path("M20 50A30 30 0 1 1 80 50A30 30 0 1 1 20 50ZM40 50A10 10 0 1 0 60 50A10 10 0 1 0 40 50Z")
    assert target.parent == (-1, 0)
    for loop, curve, places in zip(target.loops, target.curves, target.places, strict=True):
        assert signed_area(loop) > 0
        assert signed_area(curve.flattened(0.5)) > 0
        assert curve.points(places) == pytest.approx(loop)
        assert farthest_apart([curve], [loop])[0] < 0.02
    assert target.area.area == pytest.approx(math.pi * (900 - 100), rel=2e-3)


@pytest.mark.parametrize("step", [0.7, 3.0, 40.0])
def test_samples_are_evenly_apart_and_have_all_corners(step: float) -> None:
    target = of_path("M50 20A25 25 0 0 1 90 50Q80 70 50 95Q20 70 10 50A25 25 0 0 1 50 20Z")
    (samples,) = target.samples(step)
    assert samples.points[samples.corner] == pytest.approx(corner_points(target))
    gaps = np.diff(np.append(samples.along, samples.along[0] + samples.length))
    assert gaps.min() > 0
    assert gaps.max() <= step + 1e-9
    assert gaps.max() < 2 * gaps.min()
    assert target.curves[0].points(samples.places) == pytest.approx(samples.points)
    assert np.hypot(*samples.tangents.T) == pytest.approx(1.0)


@pytest.mark.parametrize("sheet", ["a4", "a3-landscape", "120x80"])
@pytest.mark.parametrize("what", ["S", "B"])
def test_curves_lie_on_the_shape_in_its_frame(sheet: str, what: str) -> None:
    drawing = draw_text(what)
    shape = make_shape(drawing.loops)
    curves = curves_of(shape, drawing.loops, drawing.curves)
    frame = next(frames(Laying(shape, Layout(parse_sheet(sheet))).lay()))
    target = Target.of_frame(frame, curves)
    assert not all(curve.is_straight for curve in target.curves)
    assert target.off_by(frame.shape.loops)[0] < 0.05 * 277 / 200
    assert Target.of_frame(frame).off_by(frame.shape.loops)[0] < 1e-9


def test_a_target_without_curves_is_the_shape() -> None:
    shape = Shape((SQUARE,), (-1,))
    target = Target.of(shape)
    assert np.array_equal(target.loops[0], SQUARE)
    assert isinstance(target.curves[0].segments[0], Line)


@pytest.mark.parametrize(
    "matrix",
    [
        np.array([(0.6, -0.8, 3.0), (0.8, 0.6, -2.0)]),
        np.array([(1.0, 0.0, 3.0), (0.0, 1.0, 9.0)]),
        np.array([(-1.0, 0.0, 3.0), (0.0, 1.0, 9.0)]),
    ],
    ids=["turned", "moved", "mirrored"],
)
def test_a_target_may_be_moved(matrix: Floats) -> None:
    target = of_path("M50 20A25 25 0 0 1 90 50Q80 70 50 95Q20 70 10 50A25 25 0 0 1 50 20Z")
    moved = target.transformed(matrix)
    polygons = [loop @ matrix[:, :2].T + matrix[:, 2] for loop in target.loops]
    assert moved.off_by(polygons)[0] < 0.02
    assert signed_area(moved.loops[0]) > 0
    assert moved.curves[0].points(moved.places[0]) == pytest.approx(moved.loops[0])
    expected = corner_points(target) @ matrix[:, :2].T + matrix[:, 2]
    assert sorted(map(tuple, corner_points(moved).round(6))) == sorted(map(tuple, expected.round(6)))


def test_off_by_is_measured_on_the_curves() -> None:
    bow = Bezier(np.array([(0.0, 0.0), (30.0, -20.0), (60.0, 0.0)]))
    loop = CurvedLoop((bow, *(Line(a, b) for a, b in zip(SQUARE[1:], np.roll(SQUARE, -1, axis=0)[1:], strict=True))))
    off, place = Target.of_curves([loop], [-1]).off_by([SQUARE])
    assert off == pytest.approx(10.0, abs=2e-4)
    assert place == pytest.approx((30.0, -10.0), abs=0.1)


@pytest.mark.parametrize(
    "path",
    [
        "M50 10a40 40 0 1 0 30 66L60 50L52 9.95L49.997994 10.000047z",
        "M50 10A40 40 0 0 0 50 90L60 50L53 9.9L49.999233 10.000025z",
        "M50 10C27.9 10 10 27.9 10 50C10 72 28 90 50 90L90 50L51.5 9.98L49.996928 10.000045z",
    ],
)
def test_curves_that_cross_by_a_hair_where_the_path_is_closed_are_not_used(path: str) -> None:
    drawing = svg(path)
    shape = make_shape(prepare(drawing.loops, Preparation()).loops)
    curves = curves_of(shape, drawing.loops, drawing.curves)
    assert not shapely.is_simple(Target.of_curves(curves, shape.parent).outline)
    target = Target.of(shape, curves)
    assert shapely.is_simple(target.outline)
    assert all(curve.is_straight for curve in target.curves)
    small_parts(target, 0.2)
