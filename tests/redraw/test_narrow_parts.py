"""Parts of a target that are smaller than a tolerance: found, named, left out, made larger."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from foldcut.core.errors import ShapeError
from foldcut.drawing.shape import make_shape, polygon_loops
from foldcut.geometry.curves import Arc, CurvedLoop
from foldcut.redraw.narrow_parts import SmallPart, enlarged, small_parts, treated, without
from foldcut.redraw.target import Target

PLATE = shapely.box(0, 0, 100, 100)
TOLERANCE = 2.0

Case = tuple[shapely.Geometry, str, float, tuple[float, float]]


def cases() -> dict[str, Case]:
    """By name: an area with one small part, its kind, its width, and about where it is."""
    found: dict[str, Case] = {}
    for width in (0.3, 0.8, 1.5):
        half = width / 2
        found |= {
            f"hole {width}": (PLATE - shapely.Point(30, 40).buffer(half), "hole", width, (30, 40)),
            f"long hole {width}": (PLATE - shapely.box(20, 30, 70, 30 + width), "hole", width, (45, 30)),
            f"dot {width}": (PLATE | shapely.Point(120, 40).buffer(half), "part", width, (120, 40)),
            f"slit {width}": (PLATE - shapely.box(40, 60, 40 + width, 101), "slit", width, (40, 80)),
            f"gap {width}": (PLATE | shapely.box(100 + width, 0, 150, 100), "gap", width, (100, 50)),
            f"bent gap {width}": (
                PLATE - shapely.LineString([(-1, 20), (50, 50), (101, 30)]).buffer(half, join_style="mitre"),
                "gap",
                width,
                (50, 50),
            ),
            f"neck {width}": (
                shapely.union_all([PLATE, shapely.box(110, 0, 150, 60), shapely.box(99, 20, 111, 20 + width)]),
                "neck",
                width,
                (105, 20),
            ),
            f"hair {width}": (PLATE | shapely.box(99, 40, 130, 40 + width), "tail", width, (115, 40)),
        }
    return found


CASES = cases()


def of(area: shapely.Geometry) -> Target:
    return Target.of(make_shape(polygon_loops(shapely.get_parts(area))))


def topology(target: Target) -> tuple[int, int]:
    depths = [target.shape.depth(number) for number in range(len(target.loops))]
    return sum(depth % 2 == 0 for depth in depths), sum(depth % 2 for depth in depths)


@pytest.mark.parametrize("name", sorted(CASES))
def test_small_parts_are_found_and_named(name: str) -> None:
    area, kind, width, place = CASES[name]
    (part,) = small_parts(of(area), TOLERANCE)
    assert part.kind == kind
    assert part.width == pytest.approx(width, rel=0.05)
    assert part.place == pytest.approx(place, abs=9 if "bent" in name else 1.6)
    assert f"{part.width:.2g} mm wide at (" in part.name
    assert f"{3 * part.width:.2g} mm wide at (7, 8)" in part.named(np.array([7.0, 8.0]), 3.0)


@pytest.mark.parametrize("name", sorted(CASES))
def test_nothing_small_is_left_without_them(name: str) -> None:
    area, kind, *_ = CASES[name]
    target = of(area)
    left = without(target, small_parts(target, TOLERANCE))
    assert small_parts(left, TOLERANCE) == []
    change = left.area.symmetric_difference(area)
    assert change.difference(small_parts(target, TOLERANCE)[0].area.buffer(1e-3)).area < 1e-2
    paper, space = topology(target)
    expected = {
        "hole": (paper, space - 1),
        "part": (paper - 1, space),
        "slit": (paper, space),
        "gap": (1, space),
        "neck": (2, space),
        "tail": (paper, space),
    }
    assert topology(left) == expected[kind]


@pytest.mark.parametrize("name", sorted(CASES))
def test_what_is_enlarged_is_as_wide_as_asked_for(name: str) -> None:
    area, kind, *_ = CASES[name]
    target = of(area)
    larger, left = enlarged(target, small_parts(target, TOLERANCE), 2 * TOLERANCE)
    assert left == []
    assert topology(larger) == topology(target)
    assert small_parts(larger, TOLERANCE) == []
    if kind in ("slit", "gap", "tail", "neck"):
        assert small_parts(larger, 1.9 * TOLERANCE) == []


@pytest.mark.parametrize(
    "area",
    [
        shapely.Polygon([(0, 0), (50, 10), (100, 0), (60, 40), (50, 140), (40, 40)]),
        PLATE - shapely.Polygon([(40, 101), (60, 101), (50, 20)]),
        PLATE - shapely.Polygon([(45, 101), (55, 101), (50, 50)]),
        PLATE - shapely.Point(50, 50).buffer(2.2),
        shapely.Point(0, 0).buffer(50),
        PLATE | shapely.box(99, 40, 130, 42.5),
    ],
    ids=["star", "notch", "sharp notch", "hole", "disc", "bar"],
)
def test_corners_and_what_is_large_enough_are_no_small_parts(area: shapely.Geometry) -> None:
    assert small_parts(of(area), TOLERANCE) == []


def test_what_lies_in_a_small_hole_goes_with_it() -> None:
    ring = shapely.Point(40, 40).buffer(1.8) - shapely.Point(40, 40).buffer(1.0)
    target = of(PLATE - ring)
    (part,) = small_parts(target, TOLERANCE)
    assert (part.kind, part.loop is not None) == ("hole", True)
    assert len(without(target, [part]).loops) == 1


def test_loops_that_are_not_touched_keep_their_curves() -> None:
    plate = CurvedLoop.of_points(np.array([(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)]))
    eye, dot = CurvedLoop((Arc.of_circle((30, 30), 12),)), CurvedLoop((Arc.of_circle((70, 70), 0.5),))
    target = Target.of_curves([plate, eye, dot], [-1, 0, 0])
    parts = small_parts(target, TOLERANCE)
    assert [part.loop for part in parts] == [2]
    left = without(target, parts)
    assert left.curves[1] is target.curves[1]
    assert left.parent == (-1, 0)
    larger, _ = enlarged(target, parts, 4.0)
    assert [curve.is_straight for curve in larger.curves] == [True, False, True]


def test_what_has_no_room_stays_as_it_is() -> None:
    target = of(PLATE - shapely.Point(30, 98.5).buffer(0.4))
    hole = [part for part in small_parts(target, 1.0) if part.kind == "hole"]
    larger, left = enlarged(target, hole, 4.0)
    assert left == hole
    assert larger is target


def test_nothing_is_left_of_a_drawing_of_small_parts() -> None:
    target = of(shapely.union_all([shapely.Point(x, 0).buffer(0.5) for x in (0, 40, 90)]))
    parts = small_parts(target, TOLERANCE)
    assert len(parts) == 3
    with pytest.raises(ShapeError, match="smaller than the tolerance"):
        without(target, parts)


@pytest.mark.parametrize(("treatment", "loops"), [("drop", 1), ("keep", 3), ("enlarge", 3)])
def test_treatments(treatment: str, loops: int) -> None:
    target = of(PLATE - shapely.MultiPoint([(30, 40), (60, 70)]).buffer(0.4))
    other, parts = treated(target, TOLERANCE, treatment)
    assert len(parts) == 2
    assert len(other.loops) == loops
    assert (small_parts(other, TOLERANCE) == []) == (treatment != "keep")


def test_the_widest_of_small_parts_stays() -> None:
    target = of(shapely.union_all([shapely.Point(x, 0).buffer(0.5 + x / 200) for x in (0, 40, 90)]))
    other, parts = treated(target, TOLERANCE, "drop")
    assert len(parts) == 2
    assert [round(loop.mean(axis=0)[0]) for loop in other.loops] == [90]


def test_parts_come_from_the_narrowest_to_the_widest() -> None:
    area = PLATE - shapely.union_all([shapely.Point(20 * k, 50).buffer(0.2 * k) for k in range(1, 5)])
    widths = [part.width for part in small_parts(of(area), TOLERANCE)]
    assert widths == sorted(widths)
    assert len(widths) == 4


def test_the_comparison_can_fail() -> None:
    area, *_ = CASES["hole 0.8"]
    target = of(area)
    wrong = SmallPart("hole", 0.8, np.array([70.0, 70.0]), shapely.Point(70, 70).buffer(0.4), None)
    assert small_parts(without(target, [wrong]), TOLERANCE) != []
