"""Mirror axes and turns of a target: exact ones, those within a tolerance, and those that are none."""

from __future__ import annotations

import math

import numpy as np
import pytest

from foldcut.core.arrays import Floats
from foldcut.drawing.shape import make_shape
from foldcut.geometry.curves import Arc, Bezier, CurvedLoop, Line, farthest_apart
from foldcut.redraw.symmetry import Symmetry, symmetries, symmetry
from foldcut.redraw.target import Target


def turned(points: Floats, degrees: float, by: tuple[float, float] = (0.0, 0.0)) -> Floats:
    cosine, sine = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return points @ np.array([(cosine, sine), (-sine, cosine)]) + np.array(by)


def star(count: int, outer: float = 90.0, inner: float = 40.0) -> Floats:
    angles = math.pi / 2 + math.pi * np.arange(2 * count) / count
    return np.where(np.arange(2 * count) % 2, inner, outer)[:, None] * np.stack(
        [np.cos(angles), np.sin(angles)], axis=1
    )


def half(seed: int) -> Floats:
    """The right half of an outline without symmetry, from bottom to top."""
    rng = np.random.default_rng(seed)
    heights = np.linspace(-90, 90, 9)
    widths = rng.uniform(15, 80, 9)
    widths[[0, -1]] = 0
    return np.stack([widths, heights], axis=1)


def mirrored(seed: int) -> Floats:
    right = half(seed)
    return np.concatenate([right, right[-2:0:-1] * (-1.0, 1.0)])


def of(*loops: Floats) -> Target:
    return Target.of(make_shape(loops))


def degrees(found: Symmetry) -> list[float]:
    return [math.degrees(angle) for angle in found.angles]


def faults(target: Target, found: Symmetry, tolerance: float) -> list[str]:
    """What is wrong with a symmetry: images that are too far off, or not as far as it says."""
    wrong = []
    for axis in found.axes:
        images = [axis.image(loop) for loop in target.loops]
        off, _ = farthest_apart([CurvedLoop.of_points(loop) for loop in target.loops], images)
        if off > max(tolerance / 2, 1e-3) + 0.045:
            wrong.append(f"the axis at {math.degrees(axis.angle):g} degrees is off by {off:g} mm")
        if abs(off - axis.off) > 0.045:  # twice the flattening
            wrong.append(f"the axis at {math.degrees(axis.angle):g} degrees says {axis.off:g} mm, but it is {off:g}")
        if abs(axis.normal @ found.centre - axis.offset) > 1e-6:
            wrong.append(f"the axis at {math.degrees(axis.angle):g} degrees misses the centre")
    for count in range(1, found.order):
        images = [turned(loop - found.centre, 360 * count / found.order, tuple(found.centre)) for loop in target.loops]
        off, _ = farthest_apart([CurvedLoop.of_points(loop) for loop in target.loops], images)
        if off > max(tolerance, 1e-3) + 0.045:  # of two axes, each with half of the tolerance
            wrong.append(f"turn {count} of {found.order} is off by {off:g} mm")
    return wrong


@pytest.mark.parametrize("angle", [0.0, 90.0, 37.3, 158.2])
@pytest.mark.parametrize("seed", range(3))
def test_an_exact_axis_is_found_exactly_in_any_direction(seed: int, angle: float) -> None:
    target = of(turned(mirrored(seed), angle, (103.0, 57.0)))
    found = symmetry(target, 0.25)
    assert found.order == 1
    assert degrees(found) == pytest.approx([(90 + angle) % 180], abs=1e-7)
    axis = found.axes[0]
    assert axis.offset == pytest.approx(axis.normal @ (103.0, 57.0), abs=1e-7)
    assert faults(target, found, 0.25) == []


@pytest.mark.parametrize("angle", [0.0, 11.0, 45.0])
@pytest.mark.parametrize("count", [2, 3, 4, 5, 6, 8, 12])
def test_all_axes_of_stars_go_through_their_centre(count: int, angle: float) -> None:
    target = of(turned(star(count), angle, (100.0, 150.0)))
    found = symmetry(target, 1.0)
    assert found.order == count
    assert degrees(found) == pytest.approx(sorted((90 + angle + 180 * k / count) % 180 for k in range(count)), abs=1e-6)
    assert found.centre == pytest.approx((100.0, 150.0), abs=1e-6)
    assert faults(target, found, 1.0) == []


@pytest.mark.parametrize("count", [2, 3, 5, 7])
def test_pinwheels_turn_without_axes(count: int) -> None:
    angles = math.tau * np.arange(3 * count) / (3 * count)
    points = np.tile([90.0, 35.0, 60.0], count)[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    target = of(turned(points, 17.0, (90.0, 120.0)))
    found = symmetry(target, 0.5)
    assert (found.order, found.axes) == (count, ())
    assert found.centre == pytest.approx((90.0, 120.0), abs=1e-6)
    assert faults(target, found, 0.5) == []


@pytest.mark.parametrize("seed", range(4))
def test_axes_within_the_tolerance_only(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = mirrored(seed) + rng.uniform(-0.25, 0.25, (16, 2))
    target = of(turned(points, 28.0))
    near = symmetry(target, 2.0)
    assert len(near.axes) == 1
    assert near.axes[0].off <= 1.0
    assert abs(math.degrees(near.axes[0].angle) - 118) < 1
    assert faults(target, near, 2.0) == []
    assert symmetry(target, 0.02).axes == ()


@pytest.mark.parametrize("seed", range(4))
def test_what_is_nearly_upright_is_upright(seed: int) -> None:
    target = of(mirrored(seed) + np.random.default_rng(seed).uniform(-0.1, 0.1, (16, 2)))
    assert degrees(symmetry(target, 4.0)) == [90.0]


@pytest.mark.parametrize("seed", range(4))
def test_outlines_without_symmetry_have_none(seed: int) -> None:
    rng = np.random.default_rng(seed + 10)
    angles = np.sort(rng.uniform(0, math.tau, 11))
    points = rng.uniform(30, 90, 11)[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    found = symmetry(of(points), 2.0)
    assert (found.axes, found.order) == ((), 1)


def test_a_hole_may_take_axes_away() -> None:
    square = np.array([(-50.0, -50.0), (50.0, -50.0), (50.0, 50.0), (-50.0, 50.0)])
    assert symmetry(of(square, square / 4), 1.0).order == 4
    assert degrees(symmetry(of(square, square / 4 + np.array([20.0, 0.0])), 1.0)) == [0.0]
    assert degrees(symmetry(of(square, square / 4 + np.array([15.0, 15.0])), 1.0)) == pytest.approx([45.0])
    assert symmetry(of(square, square / 4 + np.array([20.0, 8.0])), 1.0).axes == ()


def test_curves_drawn_the_same_way_around_are_symmetric() -> None:
    """The left half of a heart is no mirror image of the right half, point by point: it is drawn from top to bottom."""
    top, bottom = np.array([0.0, 40.0]), np.array([0.0, -60.0])
    right = Bezier(np.array([bottom, (60.0, -20.0), (90.0, 90.0), top]))
    left = Bezier(np.array([top, (-90.0, 90.0), (-60.0, -20.0), bottom]))
    parts = (right, left.between(0, 0.3), left.between(0.3, 1))
    turn = np.array([(0.8, -0.6, 5.0), (0.6, 0.8, 7.0)])
    target = Target.of_curves([CurvedLoop(parts).transformed(turn)], [-1])
    found = symmetry(target, 0.25)
    assert degrees(found) == pytest.approx([math.degrees(math.atan2(0.8, -0.6))], abs=1e-3)
    assert found.axes[0].off < 0.005


def test_circles_have_the_axes_of_twelve() -> None:
    circle = CurvedLoop((Arc.of_circle((50.0, 60.0), 40.0, 0.3),))
    found = symmetry(Target.of_curves([circle, circle.transformed(np.array([(0.5, 0, 25), (0, 0.5, 30)]))], [-1, 0]), 1)
    assert found.order == 12
    assert degrees(found) == pytest.approx([15.0 * k for k in range(12)])
    half_disc = CurvedLoop((Arc.of_circle((0.0, 0.0), 40.0, 0.3, math.pi),))
    arc = half_disc.segments[0]
    found = symmetry(Target.of_curves([CurvedLoop((arc, Line(arc.end, arc.start)))], [-1]), 1)
    assert degrees(found) == pytest.approx([math.degrees(0.3) + 90], abs=1e-3)


@pytest.mark.parametrize("turn", [0.0, -13.0, 90.0, 200.0])
def test_symmetry_moves_with_the_drawing(turn: float) -> None:
    target = of(turned(star(3), 13.0))
    matrix = np.column_stack([turned(np.eye(2), turn).T, (5.0, -7.0)])
    moved = symmetry(target, 0.5).transformed(matrix)
    there = target.transformed(matrix)
    assert faults(there, moved, 0.5) == []
    again = symmetry(there, 0.5)
    assert degrees(moved) == pytest.approx(degrees(again), abs=1e-6)
    assert moved.centre == pytest.approx(again.centre, abs=1e-6)


def test_several_tolerances_at_once() -> None:
    target = of(mirrored(1) + np.random.default_rng(1).uniform(-0.3, 0.3, (16, 2)))
    assert [len(found.axes) for found in symmetries(target, [0.02, 4.0])] == [0, 1]


def test_the_comparison_can_fail() -> None:
    target = of(mirrored(0))
    found = symmetry(target, 0.25)
    other = of(turned(mirrored(0), 2.0))
    assert faults(other, found, 0.25) != []
    assert faults(target, Symmetry(found.centre, (), 2), 0.25) != []
