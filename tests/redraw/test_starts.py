"""Outlines to begin the search with: near enough, of the same topology, symmetric, and with matched bends."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
import shapely

from foldcut.core.arrays import Floats, points_array
from foldcut.core.model import Shape, Sheet
from foldcut.drawing.shape import invariant_faults, make_shape
from foldcut.methods.skeleton.perpendiculars import Ridges
from foldcut.methods.skeleton.skeleton_faces import skeleton_of
from foldcut.redraw.starts import Axis, Start, all_starts, arcs, disks, fitting, starts
from foldcut.redraw.starts.arcs import fit_bends
from foldcut.redraw.starts.bends import lead_in_bends
from foldcut.redraw.starts.chains import chains_of
from foldcut.redraw.starts.disks import fit_disks
from foldcut.redraw.starts.fitting import fit
from foldcut.redraw.starts.following import follow, lead_of
from foldcut.redraw.starts.near import Near
from foldcut.redraw.starts.strips import Pairs, find_strips

SHEET = Sheet(210.0, 297.0)
MIDDLE = np.array([105.0, 148.5])
UPRIGHT, LEVEL = Axis(MIDDLE, math.pi / 2), Axis(MIDDLE, 0.0)


def arc(middle: tuple[float, float], radius: float, start: float, end: float, count: int = 80) -> Floats:
    angles = np.radians(np.linspace(start, end, count))
    return np.array(middle) + radius * np.column_stack([np.cos(angles), np.sin(angles)])


def letter_u() -> Shape:
    outer, inner = arc((105, 110), 70, 180, 360), arc((105, 110), 44, 360, 180)
    return make_shape([np.concatenate([[(35, 250)], outer, [(175, 250), (149, 250)], inner, [(61, 250)]])])


def letter_s() -> Shape:
    line = np.concatenate([arc((105, 195), 45, 20, 270), arc((105, 105), 45, 90, -160)])
    return make_shape([shapely.get_coordinates(shapely.LineString(line).buffer(12, cap_style="flat"))[:-1]])


def letter_c(middle: tuple[float, float] = (105, 148.5)) -> Shape:
    return make_shape([np.concatenate([arc(middle, 80, 40, 320), arc(middle, 52, 320, 40)])])


def ring() -> Shape:
    return make_shape([arc((105, 148.5), 80, 0, 360, 241)[:-1], arc((105, 148.5), 50, 0, 360, 241)[:-1]])


def wavy_leaf() -> Shape:
    angles = np.linspace(0, 2 * math.pi, 300, endpoint=False)
    radii = 70 + 12 * np.cos(3 * angles) + 5 * np.sin(5 * angles)
    return make_shape([MIDDLE + radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])])


def two_parts_with_holes() -> Shape:
    square = np.array([(20, 20), (90, 20), (90, 120), (20, 120)])
    return make_shape(
        [square, arc((55, 70), 25, 0, 359, 200), arc((140, 200), 50, 0, 359, 300), arc((140, 200), 20, 0, 359)]
    )


DRAWINGS = {
    "u": letter_u(),
    "s": letter_s(),
    "c": letter_c(),
    "ring": ring(),
    "leaf": wavy_leaf(),
    "parts": two_parts_with_holes(),
}


def every(name: str, tolerance: float, axes: tuple[Axis, ...] = ()) -> list[Start]:
    return list(all_starts(DRAWINGS[name], tolerance, axes))


def apart(one: Shape, other: Shape) -> float:
    """The Hausdorff distance by densified lines, by shapely."""
    lines = [shapely.multilinestrings([shapely.linearrings(loop) for loop in shape.loops]) for shape in (one, other)]
    return float(shapely.hausdorff_distance(*(shapely.segmentize(line, 0.3) for line in lines)))


def odd_nodes(shape: Shape) -> int:
    return len(Ridges(skeleton_of(shape, SHEET), SHEET).odd)


@pytest.mark.parametrize("name", DRAWINGS)
@pytest.mark.parametrize("tolerance", [1.0, 4.0])
def test_outlines_are_near_enough_and_of_the_same_topology(name: str, tolerance: float) -> None:
    drawn, found = DRAWINGS[name], every(name, tolerance)
    assert len(found) >= 3
    for start in found:
        assert not invariant_faults(start.shape), str(start.kind)
        assert start.shape.parent == drawn.parent
        assert apart(start.shape, drawn) <= 1.02 * tolerance, str(start.kind)


def test_the_check_of_distances_can_fail() -> None:
    drawn = DRAWINGS["u"]
    moved = [loop + np.array([0, 1.0]) for loop in drawn.loops]
    near = Near(drawn)
    assert near.shape(drawn.loops, 0.5) is not None
    assert near.shape(moved, 0.5) is None
    assert near.distance(moved) == pytest.approx(1.0, abs=0.02)
    assert near.shape([drawn.loops[0][::40]], 0.5) is None  # the drawing is far from it, not it from the drawing
    crossed = drawn.loops[0].copy()
    crossed[[3, 4]] = crossed[[4, 3]]
    assert near.shape([crossed], 5.0) is None


def test_loops_that_are_nested_in_another_way_are_no_outlines() -> None:
    drawn = DRAWINGS["ring"]
    near = Near(drawn)
    assert near.shape(drawn.loops, 40.0) is not None
    assert near.shape([drawn.loops[0], drawn.loops[1] + (110, 0)], 400.0) is None
    assert near.shape([drawn.loops[1], drawn.loops[0]], 400.0) is None


def test_outlines_differ_from_each_other() -> None:
    found = every("s", 2.0)
    corners = [np.concatenate(start.shape.loops) for start in found]
    for k, one in enumerate(corners):
        for other in corners[:k]:
            assert one.shape != other.shape or np.abs(np.sort(one, axis=0) - np.sort(other, axis=0)).max() > 0.01


@pytest.mark.parametrize(("name", "tolerance", "most_odd"), [("u", 2.0, 8), ("s", 2.0, 16), ("c", 4.0, 8)])
def test_the_first_outline_has_matched_bends(name: str, tolerance: float, most_odd: int) -> None:
    first = next(starts(DRAWINGS[name], tolerance))
    plain = next(start.shape for start in every(name, tolerance) if start.kind.edges == "" and not start.kind.step)
    assert odd_nodes(first) <= most_odd
    assert odd_nodes(first) < odd_nodes(plain)


@pytest.mark.parametrize(("name", "axes"), [("u", (UPRIGHT,)), ("c", (LEVEL,)), ("ring", (UPRIGHT, LEVEL))])
def test_axes_are_kept_exactly(name: str, axes: tuple[Axis, ...]) -> None:
    found = [start for start in every(name, 2.0, axes) if start.axes]
    assert len(found) >= 2
    for start in found:
        corners = np.concatenate(start.shape.loops)
        for axis in start.axes:
            images = axis.mirrored(corners)
            off = np.hypot(*(images[:, None] - corners[None]).transpose(2, 0, 1)).min(axis=1)
            assert off.max() < 1e-9, str(start.kind)


def test_sides_across_an_axis_make_no_corner_there() -> None:
    found = [start.shape for start in every("u", 2.0, (UPRIGHT,)) if start.axes]
    assert any(np.abs(UPRIGHT.side(np.concatenate(shape.loops))).min() > 1.0 for shape in found)


def test_an_axis_that_is_none_is_left_out() -> None:
    assert all(not start.axes for start in every("leaf", 0.5, (Axis(MIDDLE, 0.3),)))


def test_circles_become_regular_polygons_of_an_even_number_of_sides() -> None:
    regular = [start for start in every("ring", 2.0) if start.kind.regular]
    assert regular
    outer, inner = regular[0].shape.loops
    assert len(outer) == len(inner)
    assert len(outer) % 2 == 0
    for loop in (outer, inner):
        radii = np.hypot(*(loop - MIDDLE).T)
        assert np.ptp(radii) < 0.05
        sides = np.hypot(*(np.roll(loop, -1, axis=0) - loop).T)
        assert np.ptp(sides) < 0.1
    assert odd_nodes(regular[0].shape) == 0


def test_true_corners_stay_corners() -> None:
    drawn = make_shape([[(20, 20), (190, 20), (190, 150), *arc((120, 150), 70, 0, 90).tolist(), (20, 220)]])
    for shape in starts(drawn, 2.0):
        for corner in [(20, 20), (190, 20), (20, 220)]:
            assert np.hypot(*(shape.loops[0] - corner).T).min() < 2.9


def test_the_result_is_the_same_each_time() -> None:
    one, other = every("s", 1.0), every("s", 1.0)
    assert [start.kind for start in one] == [start.kind for start in other]
    for a, b in zip(one, other, strict=True):
        assert all(np.array_equal(p, q) for p, q in zip(a.shape.loops, b.shape.loops, strict=True))


def test_the_fewest_lines_for_an_arc_are_as_many_as_its_sagitta_asks_for() -> None:
    for radius, tolerance in [(50.0, 1.0), (80.0, 0.5), (30.0, 2.0)]:
        row = arc((0, 0), radius, 0, 180, 400)
        sides = fit(row, tolerance)
        assert sides is not None
        step = 2 * math.acos(1 - 2 * tolerance / radius)  # of a line whose piece is as far off on both sides
        assert len(sides.normals[0]) == math.ceil(math.pi / step - 1e-9)
        for s, (a, b) in enumerate(zip(sides.cuts[:-1], sides.cuts[1:], strict=True)):
            heights = row[a : b + 1] @ sides.normals[0, s] - sides.offsets[0, s]
            assert np.abs(heights).max() <= tolerance + 1e-9


def test_lines_of_given_directions_have_them() -> None:
    row = arc((0, 0), 60, 10, 170, 300)
    angles = np.radians(np.arange(0, 360, 30))
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    sides = fit(row, 2.5, directions=directions)
    assert sides is not None
    assert np.abs(sides.normals[0] @ directions.T).max(axis=1) == pytest.approx(1.0)


def test_sides_around_a_bend_touch_one_circle() -> None:
    row = np.concatenate([[(100.0, -60.0)], arc((0, 0), 100, 0, 140, 200), [(-180.0, -59.0)]])
    row = np.concatenate([np.linspace(p, q, 6)[:-1] for p, q in pairwise(row)])
    sides = fit_bends(row, 1.5)
    assert sides is not None
    # all interior lines are equally far from a point: normal @ middle - offset == radius
    system = np.column_stack([sides.normals[0], -np.ones(len(sides.normals[0]))])
    found, *_ = np.linalg.lstsq(system, sides.offsets[0], rcond=None)
    assert len(system) >= 4
    assert np.abs(system @ found - sides.offsets[0]).max() < 1.0
    assert np.abs((system @ found - sides.offsets[0])[1:-1]).max() < 0.9


@pytest.mark.parametrize("name", ["u", "s", "c"])
def test_a_stroke_is_one_strip(name: str) -> None:
    chains = chains_of(DRAWINGS[name], 2.0)
    assert chains is not None
    strips = find_strips(Pairs(chains), inside=True)
    assert len(strips) == 1
    width = {"u": 26, "s": 24, "c": 28}[name]
    assert strips[0].widths == pytest.approx(width, abs=1.0)
    assert strips[0].length > 0.8 * shapely.linearrings(DRAWINGS[name].loops[0]).length / 2 - width


def test_a_square_has_no_strip_with_bends() -> None:
    chains = chains_of(make_shape([[(0, 0), (100, 0), (100, 100), (0, 100)]]), 2.0)
    assert chains is not None
    assert all(strip.length <= 100 for strip in find_strips(Pairs(chains), inside=True))


@pytest.mark.parametrize("edge", [0, 1])
def test_the_edge_that_follows_makes_nodes_with_the_one_that_leads(edge: int) -> None:
    rows = np.stack([arc((0, 0), 80, 0, 150, 200), arc((0, 0), 60 + 5, 0, 150, 200)])
    middle = arc((0, 0), 72.5, 0, 150, 200)
    along = np.column_stack([middle, np.full(200, 7.5)])
    lead = fit(rows[edge], 1.4)
    assert lead is not None
    sides = follow(rows, along, lead_of(lead, edge), 1.9)
    assert sides is not None
    for s in range(len(lead.normals[0]) - 1):
        # four lines, two of each edge, equally far from one point
        system = [[*sides.normals[k, s + d], (-1.0, 1.0)[k]] for k in (0, 1) for d in (0, 1)]
        value = [sides.offsets[k, s + d] for k in (0, 1) for d in (0, 1)]
        found, *_ = np.linalg.lstsq(np.array(system), np.array(value), rcond=None)
        assert np.abs(np.array(system) @ found - value).max() < 1e-9
    assert follow(rows, along, lead_of(lead, edge), 0.2) is None


def test_in_every_bend_the_inner_edge_leads() -> None:
    middle = np.concatenate([arc((0, 0), 50, 200, 0, 150), arc((100, 0), 50, 180, 380, 150)[1:]])
    steps = np.gradient(middle, axis=0)
    left = np.column_stack([-steps[:, 1], steps[:, 0]]) / np.hypot(*steps.T)[:, None]
    rows = np.stack([middle - 10 * left, middle + 10 * left])
    lead = lead_in_bends(rows, 1.5, 1.5, 0.3)
    assert lead is not None
    assert lead.known[0, 0]  # the first bend is to the right, and the first row is on the right
    assert lead.known[1, -1]
    assert lead.known.all(axis=0).sum() == 1
    assert lead.cuts[0] == 0
    assert lead.cuts[-1] == len(middle) - 1


def test_compiled_code_fits_the_same_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    row = np.concatenate([arc((0, 0), 40, 180, 0, 25), arc((70, 0), 30, 180, 330, 20)[1:]])
    angles = np.radians(np.arange(0, 360, 20))
    fits = (
        lambda: fit(row, 1.0),
        lambda: fit(row, 2.0, directions=np.column_stack([np.cos(angles), np.sin(angles)])),
        lambda: fit_bends(row, 1.0),
        lambda: fit_disks(
            np.stack([row[:25], 0.7 * row[:25]]), np.column_stack([0.85 * row[:25], np.full(25, -6.0)]), 1.5
        ),
    )
    as_it_is = [one() for one in fits]
    for module in (fitting, arcs, disks):
        monkeypatch.setattr(module, "compiled_copy", lambda plain: plain)
    for one, other in zip(as_it_is, [one() for one in fits], strict=True):
        assert one is not None
        assert other is not None
        assert np.array_equal(one.cuts, other.cuts)
        assert one.normals == pytest.approx(other.normals, abs=1e-9)
        assert one.offsets == pytest.approx(other.offsets, abs=1e-9)


def test_a_sharp_tip_is_kept_where_lines_would_miss_it() -> None:
    tip = make_shape(
        [[(20, 100), *arc((100, 40), 100, 143, 60).tolist(), *arc((100, 160), 100, 300, 217).tolist()[1:-1]]]
    )
    for start in all_starts(tip, 2.0):
        assert apart(start.shape, tip) <= 2.04


def test_outlines_are_arrays_that_cannot_be_written_to() -> None:
    loop = next(starts(DRAWINGS["u"], 2.0)).loops[0]
    assert loop.dtype == points_array(loop).dtype
    assert not loop.flags.writeable
