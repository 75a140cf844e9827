"""Sheets by name and by size, and where a shape lands on one."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from support.strategies import Points, cross, moved, rectangle, regular, similarities, simple_polygons, star

from foldcut.core.errors import FoldcutError, ShapeError, SheetError
from foldcut.core.model import Placement, Shape, Sheet
from foldcut.core.units import parse_length
from foldcut.drawing.placement import NAMED_SHEETS, Layout, parse_sheet, place
from foldcut.drawing.shape import invariant_faults, make_shape

A4 = parse_sheet("a4")
WIDE = make_shape([[(0, 0), (230, 0), (230, 80), (0, 80)]])
SMALL = make_shape([[(0, 0), (40, 0), (40, 20), (0, 20)], [(10, 5), (20, 5), (15, 12)]])


def bounds(shape: Shape) -> list[float]:
    points = np.concatenate(shape.loops)
    return [*points.min(axis=0).tolist(), *points.max(axis=0).tolist()]


# --- lengths and sheets


@pytest.mark.parametrize(
    ("text", "mm"),
    [
        ("10mm", 10),
        ("1cm", 10),
        ("0.5in", 12.7),
        ("12", 12),
        (" 3 MM ", 3),
        (".5cm", 5),
        ("1e1", 10),
        ("0", 0),
        ("+2", 2),
    ],
)
def test_a_length_is_in_mm_unless_it_names_a_unit(text: str, mm: float) -> None:
    assert parse_length(text) == pytest.approx(mm, rel=1e-15)


@pytest.mark.parametrize(
    "text", ["", "mm", "-1", "-1mm", "nan", "inf", "1e999", "3px", "3 m", "1,5", "1 2", "0x10", "1_0"]
)
def test_no_length_is_refused_with_what_is_allowed(text: str) -> None:
    with pytest.raises(
        SheetError, match="give a number from 0 up with mm, cm or in|longer than a kilometre; give a shorter length"
    ):
        parse_length(text)


@pytest.mark.parametrize(
    ("text", "width", "height", "name"),
    [
        ("a4", 210, 297, "A4"),
        ("A4", 210, 297, "A4"),
        ("a0-portrait", 841, 1189, "A0"),
        ("A6-Landscape", 148, 105, "A6 landscape"),
        ("letter", 215.9, 279.4, "letter"),
        ("Legal", 215.9, 355.6, "legal"),
        ("tabloid-landscape", 431.8, 279.4, "tabloid landscape"),
        ("200x300", 200, 300, ""),
        ("20cmx30cm", 200, 300, ""),
        ("8.5x11in", 215.9, 279.4, ""),
        ("200 mm x 300 mm", 200, 300, ""),
        ("10cm×30mm", 100, 30, ""),
        ("300X200", 300, 200, ""),
    ],
)
def test_a_sheet_by_name_or_by_size(text: str, width: float, height: float, name: str) -> None:
    sheet = parse_sheet(text)
    assert (sheet.width, sheet.height) == pytest.approx((width, height))
    assert sheet.name == name


def test_an_iso_sheet_is_half_the_next_larger_one() -> None:
    for larger, smaller in zip("012345", "123456", strict=True):
        (short, long), (width, height) = NAMED_SHEETS[f"a{larger}"], NAMED_SHEETS[f"a{smaller}"]
        assert height == short
        assert width == long // 2


@pytest.mark.parametrize(
    "text",
    ["", "a7", "a4-sideways", "letters", "200", "200x", "x200", "-5x10", "nanx10", "200x300m", "1x2x3"],
)
def test_no_sheet_is_refused_with_what_is_allowed(text: str) -> None:
    with pytest.raises(SheetError, match="; give "):
        parse_sheet(text)


@pytest.mark.parametrize("text", ["0x100", "100x0", "0.01x100", "1e9x100", "1e999x1"])
def test_a_sheet_of_a_senseless_size_is_refused(text: str) -> None:
    with pytest.raises(SheetError, match="give sides between 1 and 100000 mm"):
        parse_sheet(text)


# --- placing


def test_fit_fills_the_sheet_up_to_the_margin_and_centres() -> None:
    placed, placement = place(WIDE, A4)
    left, bottom, right, top = bounds(placed)
    assert (left, right) == pytest.approx((10, 200))
    assert bottom + top == pytest.approx(297)
    assert placement.scale == pytest.approx(190 / 230)


def test_a_number_is_the_true_size_in_mm_per_unit() -> None:
    placed, placement = place(SMALL, A4, scale=2.0)
    assert bounds(placed) == pytest.approx([65, 128.5, 145, 168.5])
    assert placement.scale == 2.0


def test_an_offset_is_where_the_lower_left_corner_of_the_turned_box_goes() -> None:
    placed, _ = place(SMALL, A4, scale=1.0, offset=(30, 50), rotation=90)
    assert bounds(placed) == pytest.approx([30, 50, 50, 90])
    placed, _ = place(make_shape([regular(4)]), A4, scale=10.0, offset=(30, 50), rotation=45)
    assert bounds(placed)[:2] == pytest.approx([30, 50])


def test_rotation_is_counter_clockwise() -> None:
    placed, _ = place(make_shape([[(0, 0), (4, 0), (0, 3)]]), A4, rotation=90, scale=1.0)
    right_angle, along_x, along_y = placed.loops[0]
    assert along_x - right_angle == pytest.approx([0, 4])
    assert along_y - right_angle == pytest.approx([-3, 0])


@pytest.mark.parametrize("turns", [-4, -1, 0, 1, 2, 3, 4, 41])
def test_quarter_turns_are_exact(turns: int) -> None:
    _, placement = place(SMALL, A4, scale=1.0, rotation=90.0 * turns)
    assert set(np.abs(placement.matrix[:, :2]).ravel()) == {0.0, 1.0}


def test_the_placement_takes_the_drawing_to_the_placed_shape() -> None:
    for rotation in (0, 17, 90, -200):
        placed, placement = place(SMALL, A4, rotation=rotation)
        for drawn, loop in zip(SMALL.loops, placed.loops, strict=True):
            assert np.abs(placement.apply(drawn) - loop).max() < 1e-9
        assert placed.parent == SMALL.parent
        assert invariant_faults(placed) == []


@pytest.mark.parametrize("points", [regular(6), regular(7), star(5, 0.4), cross(), rectangle(3, 2)], ids=len)
@pytest.mark.parametrize("sheet", ["a4", "letter-landscape", "123.4x56.7"])
def test_a_symmetric_drawing_stays_symmetric_to_the_last_digits(points: Points, sheet: str) -> None:
    paper = parse_sheet(sheet)
    placed, _ = place(make_shape([points]), paper, margin=3)
    low, high = bounds(placed)[1], bounds(placed)[3]
    assert abs(low + high - paper.height) <= 4 * np.spacing(paper.height)
    mirrored = placed.loops[0] * [1, -1] + [0, paper.height]
    distances = np.hypot(*(placed.loops[0][:, None] - mirrored[None]).transpose(2, 0, 1))
    assert distances.min(axis=1).max() <= 4 * np.spacing(paper.diagonal)


@given(simple_polygons(4, 20), similarities())
def test_the_placed_shape_does_not_depend_on_the_drawing_s_size_and_place(
    points: Points, similarity: tuple[float, float, tuple[float, float]]
) -> None:
    scale, angle, (x, y) = similarity
    expected, _ = place(make_shape([points]), A4)
    other, placement = place(make_shape([moved(points, similarity)]), A4, rotation=-math.degrees(angle))
    # The drawing's own coordinates are only as exact as its distance from the origin allows.
    rounding = np.spacing(max(abs(x), abs(y)) + scale) / scale
    assert np.abs(expected.loops[0] - other.loops[0]).max() < 277 * (1e-12 + 8 * rounding)
    assert placement.scale * scale == pytest.approx(place(make_shape([points]), A4)[1].scale, rel=1e-8)


@given(simple_polygons(4, 20))
def test_fit_touches_the_margin_and_nothing_crosses_it(points: Points) -> None:
    placed, _ = place(make_shape([points]), A4, margin=12.5)
    left, bottom, right, top = bounds(placed)
    room = [left - 12.5, bottom - 12.5, 210 - 12.5 - right, 297 - 12.5 - top]
    assert min(room) == pytest.approx(0, abs=1e-10)


# --- what is refused

NAN, INF = math.nan, math.inf
REFUSED: list[tuple[dict[str, object], type[FoldcutError], str]] = [
    ({"margin": -1}, SheetError, "a margin of -1 mm"),
    ({"margin": NAN}, SheetError, "a margin of nan mm"),
    ({"margin": 105}, SheetError, "give one from 0 to below 105 mm"),
    ({"margin": INF}, SheetError, "a margin of inf mm"),
    ({"scale": 0}, SheetError, "the scale is 0"),
    ({"scale": -2.0}, SheetError, "the scale is -2.0"),
    ({"scale": NAN}, SheetError, "the scale is nan"),
    ({"scale": INF}, SheetError, "the scale is inf"),
    ({"scale": "fill"}, SheetError, "the scale is 'fill'; give 'fit' or a number"),
    ({"rotation": NAN}, SheetError, "the rotation is nan degrees"),
    ({"rotation": INF}, SheetError, "the rotation is inf degrees"),
    ({"offset": (NAN, 0)}, SheetError, "the offset is (nan, 0) mm"),
    (
        {"offset": (20, 0), "scale": 0.5},
        ShapeError,
        "reaches from (20.0, 0.0) to (135.0, 40.0), over the 10 mm margin",
    ),
    ({"offset": (90, 20), "scale": 0.5}, ShapeError, "use an offset from (10, 10) to (85.0, 247.0)"),
    ({"offset": (-300, 20), "scale": 0.5}, ShapeError, "over the 10 mm margin"),
    (
        {"scale": 1.0},
        ShapeError,
        "the shape is 230.0 x 80.0 mm, the sheet A4 (210 x 297 mm) leaves 190.0 x 277.0 mm inside a 10 mm "
        "margin; use --scale fit, a larger sheet or a smaller margin",
    ),
    ({"scale": 1e308}, ShapeError, "the shape is inf x inf mm"),
    ({"scale": 1e-5}, ShapeError, "the shape is only 0.0023 x 0.0008 mm"),
    ({"margin": 0}, ShapeError, "touches the border of the sheet"),
    ({"margin": 0, "scale": 0.5, "offset": (0, 50)}, ShapeError, "use a margin above 0, or a smaller scale"),
]


@pytest.mark.parametrize(("options", "error", "fragment"), REFUSED, ids=lambda value: str(value)[:50])
def test_what_does_not_fit_is_refused_with_sizes_and_remedy(
    options: dict[str, object], error: type[FoldcutError], fragment: str
) -> None:
    with pytest.raises(error) as caught:
        place(WIDE, A4, **options)  # type: ignore[arg-type]
    assert fragment in str(caught.value)
    assert "; " in str(caught.value)


def test_no_margin_is_accepted_where_the_shape_stays_inside() -> None:
    placed, _ = place(SMALL, A4, margin=0, scale=1.0, offset=(0.01, 0.01))
    assert bounds(placed)[:2] == pytest.approx([0.01, 0.01])


def test_a_shape_that_just_fills_the_room_is_accepted_at_its_true_size() -> None:
    shape = make_shape([rectangle(190, 277)])
    placed, placement = place(shape, A4, scale=1.0)
    assert bounds(placed) == pytest.approx([10, 10, 200, 287])
    assert isinstance(placement, Placement)
    assert not placement.matrix.flags.writeable


def test_the_sheet_is_not_turned_for_a_wide_shape() -> None:
    assert place(WIDE, A4)[1].scale < place(WIDE, Sheet(297, 210))[1].scale


# --- how a drawing is to lie


def size(shape: Shape) -> list[float]:
    return np.ptp(np.concatenate(shape.loops), axis=0).tolist()


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"width": 100.0}, [100, 50]),
        ({"height": 30.0}, [60, 30]),
        ({"width": 100.0, "height": 30.0}, [60, 30]),
        ({"width": 30.0, "height": 100.0}, [30, 15]),
        ({"width": 30.0, "rotation": 90.0}, [30, 60]),
    ],
)
def test_a_drawing_is_scaled_to_a_width_or_a_height(options: dict[str, float], expected: list[float]) -> None:
    _, placed, _, _ = Layout(A4, **options).place(SMALL)  # type: ignore[arg-type]
    assert size(placed) == pytest.approx(expected)
    # an additional turn, made for a mirror axis, does not change the size
    _, turned, _, _ = Layout(A4, **options).place(SMALL, 90)  # type: ignore[arg-type]
    assert size(turned) == pytest.approx(expected[::-1])


def test_a_drawing_is_turned_a_quarter_where_that_gives_it_more_room() -> None:
    sheet = Sheet(100, 220)
    on, placed, placement, quarter = Layout(sheet).place(SMALL)
    assert (on, quarter, size(placed)) == (sheet, True, pytest.approx([80, 160]))
    np.testing.assert_allclose(placement.apply(SMALL.loops[1]), placed.loops[1], atol=1e-9)
    assert not Layout(sheet, scale=1.0).place(SMALL)[3]
    assert Layout(sheet, scale=3.0).place(SMALL)[3]
    assert Layout(sheet, width=120.0).place(SMALL)[3]
    assert not Layout(sheet, rotation=0.0).place(SMALL)[3]
    assert not Layout(parse_sheet("a4")).place(SMALL)[3], "the sheet lies as the drawing does"
    for wrong in ({"scale": 9.0}, {"scale": 3.0, "offset": (10.0, 10.0)}, {"margin": 50.0}):
        with pytest.raises(FoldcutError):
            Layout(sheet, **wrong).place(SMALL)  # type: ignore[arg-type]


def test_the_best_rotation_leaves_no_larger_one() -> None:
    stick = make_shape([rectangle(200, 1)])
    for drawn, sheet in ((stick, A4), (stick, Sheet(100, 100)), (make_shape([star(5, 0.4)]), Sheet(200, 190))):
        best = Layout(sheet, rotation="best").place(drawn)[2].scale
        others = [Layout(sheet, rotation=degrees).place(drawn)[2].scale for degrees in np.arange(0, 180, 0.25)]
        assert best >= max(others) * (1 - 1e-9)
    assert size(Layout(Sheet(100, 100), rotation="best").place(stick)[1])[0] == pytest.approx(80)


@pytest.mark.parametrize("options", [{"width": 0.0}, {"height": math.inf}, {"width": 9.0, "scale": 2.0}])
def test_a_size_that_makes_no_sense_is_refused(options: dict[str, float]) -> None:
    with pytest.raises(SheetError, match="give a length above 0|give one or the other"):
        Layout(A4, **options).place(SMALL)  # type: ignore[arg-type]
    with pytest.raises(SheetError, match="the rotation is 'beast'; give degrees, or 'best'"):
        Layout(A4, rotation="beast")
    with pytest.raises(SheetError, match="the rotation is nan degrees; give a finite number"):
        Layout(A4, rotation=math.nan).place(SMALL)
