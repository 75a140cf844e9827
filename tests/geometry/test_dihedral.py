"""Several mirror axes through one point: found, made exact, and told from turns."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support.dihedral_shapes import COUNTS, dihedral_shape
from support.strategies import Points, rectangle, regular

from foldcut.core.model import Shape
from foldcut.drawing.shape import make_shape
from foldcut.geometry.dihedral import Dihedral, dihedral, made_dihedral, sector_maps, turns_of

PINWHEEL: Points = [(1, 0), (4, 1), (0, 1), (-1, 4), (-1, 0), (-4, -1), (0, -1), (1, -4)]


def turned(loop: Points, degrees: float) -> Points:
    angle = math.radians(degrees)
    cosine, sine = math.cos(angle), math.sin(angle)
    return [(cosine * x - sine * y, sine * x + cosine * y) for x, y in loop]


def shaken(shape: Shape, by: float) -> Shape:
    random = np.random.default_rng(0)
    return make_shape([loop + random.uniform(-by, by, loop.shape) for loop in shape.loops])


@pytest.mark.parametrize("kind", ["star", "snowflake", "rosette"])
@pytest.mark.parametrize("count", COUNTS)
def test_all_axes_are_found_however_the_shape_is_turned(kind: str, count: int) -> None:
    drawn = dihedral_shape(kind, count, 5)
    for degrees in (0.0, 17.0, 180 / count):
        found = dihedral(make_shape([turned(loop, degrees) for loop in drawn.loops]))
        assert found is not None
        assert found.count == count
        step = math.pi / count
        assert 0 <= found.angle < step
        assert math.remainder(found.angle - math.radians(degrees), step) == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize(
    ("loops", "count"),
    [
        ([rectangle(4, 3)], 2),
        ([regular(7)], 7),
        ([regular(24)], 12),  # of 24 axes, 12 that are evenly spaced
        ([regular(13)], None),  # 13 are too many, and no two of them are evenly spaced
        ([[(0, 0), (4, 0), (5, 2)]], None),
        ([PINWHEEL], None),
    ],
)
def test_so_many_axes_are_taken(loops: list[Points], count: int | None) -> None:
    found = dihedral(make_shape(loops))
    assert (found.count if found else None) == count


def test_axes_need_corners_on_corners_and_sides_on_sides() -> None:
    # the same corners as a star's, joined in another order
    points = [(math.cos(k * math.pi / 3), math.sin(k * math.pi / 3)) for k in range(6)]
    hexagon = make_shape([points])
    assert dihedral(hexagon) is not None
    inner = [(0.5 * x, 0.5 * y) for x, y in points]
    gear = make_shape([[p for one, other in zip(points, inner, strict=True) for p in (one, other)]])
    assert dihedral(gear) is None or dihedral(gear).count != 6  # type: ignore[union-attr]


def test_a_shape_that_is_nearly_symmetric_is_made_so_about_all_axes_at_once() -> None:
    shape = shaken(make_shape(dihedral_shape("snowflake", 6, 10).loops), 0.002)
    assert dihedral(shape) is None
    found = dihedral(shape, 0.02)
    assert found is not None
    assert found.count == 6
    assert 0.001 < found.deviation < 0.01
    made = made_dihedral(shape, found)
    assert made is not None
    exact, centre, moved = made
    assert 0.0005 < moved < 0.005
    points = np.concatenate(exact.loops) - centre
    for matrix in sector_maps(6, found.angle):
        images = points @ matrix
        nearest = np.hypot(*(images[:, None] - points).transpose(2, 0, 1)).min(axis=1)
        assert nearest.max() < 1e-12
    again = dihedral(exact)
    assert again is not None
    assert (again.count, again.deviation < 1e-12) == (6, True)


def test_what_has_no_partners_is_not_made_symmetric() -> None:
    shape = make_shape(dihedral_shape("star", 5, 6).loops)
    found = dihedral(shape)
    assert found is not None
    assert made_dihedral(shape, found) is not None
    assert made_dihedral(shape, Dihedral(6, found.angle, 0.0)) is None


@pytest.mark.parametrize(
    ("loops", "turns"),
    [([PINWHEEL], 4), ([turned(PINWHEEL, 20)], 4), ([regular(5)], 5), ([[(0, 0), (4, 0), (5, 2)]], 1)],
)
def test_turns_without_axes_are_recognised(loops: list[Points], turns: int) -> None:
    assert turns_of(make_shape(loops)) == turns


def test_the_maps_of_neighbouring_sectors_agree_on_the_border_between() -> None:
    for count, angle in ((3, 0.0), (6, 0.2), (7, 1.1)):
        maps, step = sector_maps(count, angle), math.pi / count
        first, last = (np.array([math.cos(way), math.sin(way)]) for way in (angle, angle + step))
        for number in range(2 * count):
            border = last if number % 2 == 0 else first
            following = maps[(number + 1) % (2 * count)]
            assert border @ maps[number] == pytest.approx(border @ following, abs=1e-12)
            way = angle + (number + 1) * step
            assert border @ maps[number] == pytest.approx([math.cos(way), math.sin(way)], abs=1e-12)
