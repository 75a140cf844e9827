"""Mirror axes are found, and shapes made exactly symmetric."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support.strategies import Points, cross, rectangle, regular, star

from foldcut.core.model import Shape
from foldcut.drawing.shape import make_shape
from foldcut.geometry.mirror_axes import mirror_axes, sheet_axes, symmetric

LETTER_F: Points = [(0, 0), (1, 0), (1, 2), (2, 2), (2, 3), (1, 3), (1, 4), (3, 4), (3, 5), (0, 5)]


def angles(shape: Shape, allowed: float = 0.0) -> list[float]:
    return [round(math.degrees(axis.angle), 6) for axis in mirror_axes(shape, allowed)]


@pytest.mark.parametrize(
    ("points", "degrees"),
    [
        (rectangle(3, 1), [0, 90]),
        (cross(), [0, 45, 90, 135]),
        (star(5, 0.4), [0, 36, 72, 108, 144]),
        *((regular(n), [180 * k / n for k in range(n)]) for n in (3, 4, 7, 12)),
        ([(0, 0), (2, 0), (3, 1), (1, 1)], []),  # a parallelogram is only turned onto itself
        (LETTER_F, []),
    ],
)
@pytest.mark.parametrize("turn", [0.0, 17.0])
def test_all_axes_are_found(points: Points, degrees: list[float], turn: float) -> None:
    angle = math.radians(turn)
    turned = np.array(points) @ [(math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))]
    expected = sorted((degree + turn) % 180 for degree in degrees)
    assert angles(make_shape([turned])) == pytest.approx(expected, abs=1e-5)


def test_a_hole_that_is_not_symmetric_spoils_the_axis() -> None:
    square = rectangle(10, 10)
    assert angles(make_shape([square, rectangle(2, 2)])) == [0, 45, 90, 135]
    assert angles(make_shape([square, [(x + 1, y) for x, y in rectangle(2, 2)]])) == [0]
    assert angles(make_shape([square, [(x + 1, y + 2) for x, y in rectangle(2, 2)]])) == []


def test_corners_alone_do_not_make_a_symmetry() -> None:
    # the same corners joined in another order: the corners are symmetric, the outline is not
    corners: Points = [(-2, 0), (2, 0), (2, 3), (-1, 1), (1, 1), (-2, 3)]
    assert angles(make_shape([[corners[k] for k in (0, 1, 2, 4, 3, 5)]])) == [90]
    assert angles(make_shape([[(-2, 0), (2, 0), (2, 3), (-1, 1), (-2, 3), (-1.5, 1)]])) == []


def test_near_symmetry_is_taken_on_request_and_the_deviation_told() -> None:
    points = np.array(star(4, 0.4)) * 50
    points[1] += 0.2
    shape = make_shape([points])
    assert angles(shape) == [45.0]  # it was moved along this axis
    found = mirror_axes(shape, 0.3)
    assert len(found) > 1
    assert 0.05 < max(axis.deviation for axis in found) < 0.3


def test_a_shape_is_made_exactly_symmetric() -> None:
    points = np.array(rectangle(20, 10)) + np.array([30.0, 40.0])
    points[0] += (0.02, -0.01)
    shape, moved = symmetric(make_shape([points]), np.array([30.0, 40.0]), (0, 1))
    (loop,) = shape.loops
    for sign in ((-1, 1), (1, -1)):
        image = (loop - (30, 40)) * sign + (30, 40)
        assert np.abs(image[:, None] - loop[None]).max(axis=2).min(axis=1).max() < 1e-14 * 40
    assert 0.005 < moved < 0.03


def test_axes_along_the_sheet_come_first_and_both_before_one() -> None:
    ways = list(sheet_axes(make_shape([cross()]), 0.0, may_turn=True))
    assert ways[:3] == [(0.0, (0, 1)), (0.0, (0,)), (0.0, (1,))]
    assert [axes for turn, axes in ways[3:]] == [(0, 1), (0,), (1,)]
    assert [abs(turn) for turn, _ in ways[3:]] == pytest.approx([45.0] * 3)
    assert list(sheet_axes(make_shape([cross()]), 0.0, may_turn=False)) == ways[:3]
    assert list(sheet_axes(make_shape([LETTER_F]), 0.0, may_turn=True)) == []
