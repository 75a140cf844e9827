"""Strips, circles and arcs that are recognised in a target."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
import shapely

from foldcut.core.arrays import Floats
from foldcut.drawing.shape import make_shape, polygon_loops
from foldcut.geometry.curves import Arc, Bezier, CurvedLoop, Line
from foldcut.readers import read_shape
from foldcut.redraw.strips import Piece, Strip, concentric, rounds, strips
from foldcut.redraw.target import Target

U_SHAPE = [(40, 200), (40, 100)], [(160, 100), (160, 200)]


def of(area: shapely.Geometry) -> Target:
    return Target.of(make_shape(polygon_loops(shapely.get_parts(area))))


def arc(centre: tuple[float, float], radius: float, start: float, sweep: float) -> Floats:
    one = Arc.of_circle(centre, radius, math.radians(start), math.radians(sweep))
    return one.points(np.linspace(0, 1, 200))


def stroke(line: Floats, half: float) -> shapely.Geometry:
    return shapely.LineString(line).buffer(half, cap_style="flat", join_style="mitre")


CENTRE_LINES = {
    "U": np.concatenate([[(40.0, 200.0)], arc((100, 100), 60, 180, 180), [(160.0, 200.0)]]),
    "S": np.concatenate([arc((100, 150), 50, 0, 270), arc((100, 50), 50, 90, -270)]),
    "wave": np.stack([np.linspace(0, 250, 300), 25 * np.sin(np.linspace(0, 9, 300))], axis=1),
    "straight": np.array([(20.0, 20.0), (200.0, 120.0)]),
}


def along(target: Target, piece: Piece, count: int = 50) -> Floats:
    """Points of a piece."""
    loop = target.loops[piece.loop]
    line = shapely.linestrings(np.concatenate([loop, loop[:1], loop[1:], loop[:1]]))
    return shapely.get_coordinates(shapely.line_interpolate_point(line, np.linspace(piece.first, piece.last, count)))


def faults(target: Target, strip: Strip, tolerance: float) -> list[str]:
    """What is wrong with a strip: sides off the outline, not half its width away, swapped, or none of its pieces."""
    wrong = []
    outline = target.outline
    shapely.prepare(outline)
    for name, points, piece in zip(("left", "right"), (strip.left, strip.right), strip.pieces, strict=True):
        if shapely.distance(outline, shapely.points(points)).max() > 0.03:
            wrong.append(f"{name} is not on the outline")
        away = np.hypot(*(points - strip.line).T)
        if np.abs(away - strip.half_width).max() > strip.off + 0.25 or strip.off > tolerance / 2 + 1e-9:
            wrong.append(f"{name} is not at half the width")
        whole = shapely.linestrings(along(target, piece, 400))
        if shapely.distance(whole, shapely.points(points)).max() > 0.5:
            wrong.append(f"{name} is not in its piece")
        if shapely.distance(shapely.linestrings(strip.line), shapely.points(along(target, piece))).max() > (
            strip.half_width + strip.off + 2
        ):
            wrong.append(f"the piece of {name} reaches beyond the strip")
    ahead = (np.roll(strip.line, -1, axis=0) - strip.line)[:-1]
    across = (strip.left - strip.right)[:-1]
    if (ahead[:, 0] * across[:, 1] - ahead[:, 1] * across[:, 0]).min() < -1e-9:
        wrong.append("left is right")
    inside = shapely.contains(target.area, shapely.points(strip.line))
    if not (inside if strip.inside else ~inside).all():
        wrong.append("the centre line is on the wrong side of the outline")
    return wrong


@pytest.mark.parametrize("half", [1.0, 5.0, 14.0])
@pytest.mark.parametrize("name", sorted(CENTRE_LINES))
def test_strokes_are_strips(name: str, half: float) -> None:
    line = CENTRE_LINES[name]
    target = of(stroke(line, half))
    found = strips(target, 1.0)
    assert [fault for strip in found for fault in faults(target, strip, 1.0)] == []
    assert len(found) == 1
    assert found[0].half_width == pytest.approx(half, abs=0.3)
    assert found[0].off < 0.4
    length = shapely.LineString(line).length
    assert length - 2.5 * half - 2 <= found[0].length <= length * 1.01
    assert shapely.distance(shapely.LineString(line), shapely.points(found[0].line)).max() < 0.3


@pytest.mark.parametrize("seed", range(3))
def test_a_stroke_of_uneven_width_is_a_strip_within_the_tolerance_only(seed: int) -> None:
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 1, 200)
    swell = 1.2 * np.sin(t * rng.uniform(6, 9) + rng.uniform(0, 6))
    points = np.stack([250 * t, 12 + swell], axis=1)
    target = of(shapely.Polygon(np.concatenate([points, points[::-1] * (1, -1)])))
    wide = strips(target, 4.0)
    assert len(wide) == 1
    assert faults(target, wide[0], 4.0) == []
    narrow = strips(target, 0.5)
    assert all(strip.off <= 0.25 for strip in narrow)
    assert sum(strip.length for strip in narrow) < 0.6 * wide[0].length


@pytest.mark.parametrize("inside", [True, False])
def test_rings_are_closed_strips(inside: bool) -> None:
    circles = [CurvedLoop((Arc.of_circle((100.0, 100.0), radius),)) for radius in (90.0, 70.0, 62.0)]
    target = Target.of_curves(circles, [-1, 0, 1])
    found = strips(target, 1.0, inside=inside)
    ring = found[0]
    assert faults(target, ring, 1.0) == []
    assert ring.closed
    assert all(piece.whole for piece in ring.pieces)
    assert ring.half_width == pytest.approx(10.0 if inside else 4.0, abs=0.2)
    assert ring.length == pytest.approx(math.tau * (80.0 if inside else 66.0), rel=0.01)
    assert {piece.loop for piece in ring.pieces} == ({0, 1} if inside else {1, 2})


def test_gaps_are_strips_outside() -> None:
    two = shapely.union_all([shapely.box(0, 0, 50, 120), shapely.box(58, 10, 100, 120)])
    found = strips(of(two), 1.0, inside=False)
    assert [strip.half_width for strip in found] == pytest.approx([4.0], abs=0.02)
    assert faults(of(two), found[0], 1.0) == []
    assert {piece.loop for piece in found[0].pieces} == {0, 1}


@pytest.mark.parametrize(
    "area",
    [
        shapely.box(0, 0, 60, 60),
        shapely.Point(0, 0).buffer(60, quad_segs=32),
        shapely.Polygon([(0, 0), (100, 0), (50, 60)]),
    ],
    ids=["square", "disc", "triangle"],
)
def test_what_is_as_wide_as_long_is_no_strip(area: shapely.Geometry) -> None:
    assert strips(of(area), 1.0) == []


def test_pieces_of_different_strips_do_not_overlap() -> None:
    letter = shapely.union_all([shapely.box(0, 0, 20, 150), shapely.box(0, 0, 90, 18), shapely.box(0, 70, 80, 90)])
    target = of(letter)
    found = strips(target, 1.0)
    assert len(found) >= 3
    pieces = sorted((piece.first, piece.last) for strip in found for piece in strip.pieces)
    assert all(one[1] <= other[0] + 2 for one, other in pairwise(pieces))


def test_arcs_of_a_rounded_rectangle() -> None:
    text = '<svg viewBox="0 0 100 100"><rect x="10" y="20" width="70" height="50" rx="12"/></svg>'
    target = Target.of_curves(read_shape("a.svg", data=text.encode()).curves, [-1])
    found = rounds(target)
    assert [one.radius for one in found] == pytest.approx([12.0] * 4)
    assert [math.degrees(one.sweep) for one in found] == pytest.approx([90.0] * 4, abs=0.5)
    expected = {(22, -32), (68, -32), (22, -58), (68, -58)}
    assert {(round(one.centre[0], 6), round(one.centre[1], 6)) for one in found} == expected
    for one in found:
        points = along(target, one.piece)
        assert np.hypot(*(points - one.centre).T) == pytest.approx(12.0, abs=0.05)


@pytest.mark.parametrize("radius", [5.0, 40.0, 130.0])
def test_whole_circles_however_they_are_drawn(radius: float) -> None:
    bow = 4 / 3 * math.tan(math.pi / 8)
    quarter = radius * np.array([(1, 0), (1, bow), (bow, 1), (0, 1)])
    turn = np.array([(0.0, -1.0), (1.0, 0.0)])
    cubics = CurvedLoop(tuple(Bezier(quarter @ np.linalg.matrix_power(turn, k).T) for k in range(4)))
    arcs = CurvedLoop((Arc.of_circle((0, 0), radius, 1.0, 4.0), Arc.of_circle((0, 0), radius, 5.0, math.tau - 4.0)))
    lines = CurvedLoop.of_points(arcs.flattened(0.07))
    for loop in (cubics, arcs, lines):
        (one,) = rounds(Target.of_curves([loop], [-1]))
        assert one.piece.whole
        assert one.radius == pytest.approx(radius, rel=3e-4)
        assert one.centre == pytest.approx((0.0, 0.0), abs=0.01)
        assert one.sweep == pytest.approx(math.tau)


def test_a_bay_goes_the_other_way_around_its_centre() -> None:
    bay = Arc.of_circle((50.0, 0.0), 30.0, math.pi, -math.pi)
    corners = np.array([(80.0, 0.0), (100.0, 0.0), (100.0, 90.0), (0.0, 90.0), (0.0, 0.0), (20.0, 0.0)])
    lines = [Line(a, b) for a, b in pairwise(corners)]
    (one,) = rounds(Target.of_curves([CurvedLoop((bay, *lines))], [-1]))
    assert one.sweep == pytest.approx(-math.pi)
    assert (one.radius, *one.centre) == pytest.approx((30.0, 50.0, 0.0), abs=1e-6)


def test_concentric_arcs_are_together() -> None:
    area = stroke(arc((100, 100), 60, 180, 180), 12).union(shapely.box(140, 95, 170, 180))
    target = of(area.difference(shapely.Point(153, 160).buffer(6)))
    groups = concentric(rounds(target), 0.5)
    assert sorted(round(one.radius) for one in groups[0]) == [48, 72]
    assert [round(one.radius) for one in groups[1]] == [6]


@pytest.mark.parametrize(
    "points",
    [
        [(0, 0), (60, 0), (60, 60), (0, 60)],
        [(0, 0), (50, 3), (100, 0), (90, 60), (50, 66), (10, 60)],
        np.stack([np.cos(np.arange(6)), np.sin(np.arange(6))], axis=1) * 80,
    ],
    ids=["square", "blunt", "hexagon"],
)
def test_polygons_have_no_arcs(points: Floats) -> None:
    assert rounds(of(shapely.Polygon(points))) == []


def test_the_comparison_can_fail() -> None:
    target = of(stroke(CENTRE_LINES["U"], 10.0))
    (strip,) = strips(target, 1.0)
    swapped = Strip(strip.line, strip.right, strip.left, *list(vars(strip).values())[3:])
    shifted = Strip(strip.line + 3, strip.left, strip.right, *list(vars(strip).values())[3:])
    other = of(stroke(CENTRE_LINES["U"], 8.0))
    assert all(faults(target, wrong, 1.0) != [] for wrong in (swapped, shifted))
    assert faults(other, strip, 1.0) != []
