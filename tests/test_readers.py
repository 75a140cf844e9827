"""Drawings read from files: SVG, WKT and JSON loops, and what is refused in each."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from strategies import Points, simple_polygons

from foldcut.errors import BadInputError, FileFormatError
from foldcut.readers import READERS, Drawing, read_shape
from foldcut.shape import make_shape

Reading = Callable[[str, str], Drawing]  # of a suffix and a text

TRIANGLE = [[0.0, 0.0], [4.0, 0.0], [0.0, -3.0]]  # as read: y up


@pytest.fixture
def read(tmp_path: Path) -> Reading:
    def read_text_as(suffix: str, text: str) -> Drawing:
        path = tmp_path / f"drawing{suffix}"
        path.write_text(text, encoding="utf-8")
        return read_shape(path)

    return read_text_as


def svg(body: str, attributes: str = 'width="80mm" height="60mm" viewBox="0 0 80 60"') -> str:
    return f'<svg xmlns="http://www.w3.org/2000/svg" {attributes}>{body}</svg>'


def loops_of(drawing: Drawing) -> list[list[list[float]]]:
    return [loop.tolist() for loop in drawing.loops]


# --- SVG


@pytest.mark.parametrize(
    "body",
    [
        '<polygon points="0,0 4,0 0,3"/>',
        '<polygon points=" 0 0,4 0\n0 3 "/>',
        '<polygon points="0-0+4 0 0 3e0"/>',
        '<polyline points="0,0 4,0 0,3 0,0"/>',
        '<polyline points="0,0 4,0 0,3 0.0001,0"/>',
        '<path d="M 0 0 L 4 0 L 0 3 Z"/>',
        '<path d="M0,0 4,0 0,3z"/>',
        '<path d="m0 0l4 0l-4 3z"/>',
        '<path d="m0 0 4 0-4 3 0-3"/>',
        '<path d="M 0 0 H 4 L 0 3 V 0 Z M 1 1"/>',
        '<path d="M 0,0 h 4 l -4,3 v -3 z"/>',
        '<path d="M0 0 2 0 4 0L0 3Z"/>',
        '<g><g transform="translate(1 2)"><polygon points="-1,-2 3,-2 -1,1"/></g></g>',
        '<g transform="scale(2)"><a><polygon transform="translate(-1,0)" points="1,0 3,0 1,1.5"/></a></g>',
        '<polygon transform="matrix(0 1 -1 0 4 0)" points="0,4 0,0 3,4"/>',
        '<polygon transform="rotate(90 2 2)" points="0,4 0,0 3,4"/>',
        '<polygon transform="rotate(-90) skewX(0), scale(1 1)" points="0,0 0,4 -3,0"/>',
    ],
)
def test_every_way_to_write_a_triangle_gives_the_same_shape(read: Reading, body: str) -> None:
    drawing = read(".svg", svg(body))
    corners = make_shape(drawing.loops).loops[0].round(12) + 0.0
    assert sorted(corners.tolist()) == sorted(TRIANGLE)
    assert drawing.unit_mm == 1.0
    assert drawing.notes == ()


def test_a_rect_is_a_loop_in_any_unit(read: Reading) -> None:
    drawing = read(".svg", svg('<rect x="10" y="5" width="1in" height="48px"/>'))
    assert loops_of(drawing) == [[[10, -5], [106, -5], [106, -53], [10, -53]]]


def test_the_numbers_of_an_svg_are_kept_to_the_last_digit(read: Reading) -> None:
    drawing = read(".svg", svg('<g><path d="M 0.1 0.2 L 33.333333333333336 0.3 L 1e-3 7.7 Z"/></g>'))
    assert loops_of(drawing) == [[[0.1, -0.2], [33.333333333333336, -0.3], [1e-3, -7.7]]]


def test_all_outlines_of_an_svg_are_one_set_of_loops_in_their_order(read: Reading) -> None:
    others = '<g><rect x="20" width="5" height="5"/></g><polygon points="5,5 8,5 5,8"/>'
    body = '<path d="M0 0H9V9H0ZM2 2H4V4H2Z"/>' + others
    drawing = read(".svg", svg(body))
    assert [len(loop) for loop in drawing.loops] == [4, 4, 4, 3]
    assert make_shape(drawing.loops).parent == (-1, 0, -1, 0)


@pytest.mark.parametrize(
    ("attributes", "unit_mm"),
    [
        ('width="80mm" height="60mm" viewBox="0 0 80 60"', 1),
        ('width="8cm" height="6cm" viewBox="0 0 80 60"', 1),
        ('width="2in" height="1in" viewBox="0,0,2,1"', 25.4),
        ('width="96" height="96" viewBox="0 0 96 96"', 25.4 / 96),
        ('width="96px" viewBox="-5 -5 48 96"', 2 * 25.4 / 96),
        ('width="72pt" height="6pc" viewBox="0 0 1 1"', 25.4),
        ('height="100mm" viewBox="0 0 10 10"', 10),
        ('width="100mm" height="50mm" viewBox="0 0 10 10"', 5),
        ('width="100mm" height="50mm" viewBox="0 0 10 10" preserveAspectRatio="xMinYMin slice"', 10),
        ('width="100mm" height="100mm"', 25.4 / 96),
        ("", 25.4 / 96),
        ('viewBox="0 0 24 24"', None),
        ('width="100%" height="100%" viewBox="0 0 24 24"', None),
    ],
)
def test_the_unit_follows_from_width_height_and_viewbox(read: Reading, attributes: str, unit_mm: float | None) -> None:
    drawing = read(".svg", svg('<polygon points="0,0 4,0 0,3"/>', attributes))
    assert drawing.unit_mm == (None if unit_mm is None else pytest.approx(unit_mm, rel=1e-15))


def test_a_stretched_viewbox_stretches_the_drawing(read: Reading) -> None:
    attributes = 'width="100mm" height="50mm" viewBox="0 0 10 10" preserveAspectRatio="none"'
    drawing = read(".svg", svg('<polygon points="0,0 4,0 0,4"/>', attributes))
    assert drawing.unit_mm == 10
    assert loops_of(drawing) == [[[0, 0], [4, 0], [0, -2]]]


def test_the_title_of_an_svg_is_its_own_or_the_stem(read: Reading) -> None:
    outline = '<polygon points="0,0 4,0 0,3"/>'
    assert read(".svg", svg(f"<title>\n A  fish\n</title>{outline}")).title == "A fish"
    assert read(".svg", svg(f"<g><title>group</title>{outline}</g>")).title == "drawing"
    assert read(".svg", svg(f"<title/>{outline}")).title == "drawing"


def test_what_is_not_an_outline_is_ignored_and_noted(read: Reading) -> None:
    body = """
      <defs><circle r="3"/><g><polygon points="0,0 1,0 0,1"/></g></defs>
      <text>Hello</text><text>you</text><image href="http://example.org/x.png"/>
      <metadata><x xmlns="http://example.org/">1</x></metadata><x:y xmlns:x="http://example.org/"/>
      <g display="none"><circle r="3"/></g><path style="fill: red; display: none" d="M 0 0 C"/>
      <rect visibility="hidden" width="1" height="1"/>
      <polygon clip-path="url(#c)" points="0,0 4,0 0,3"/><!-- a comment --><?and-an instruction?>
    """
    drawing = read(".svg", svg(body))
    assert loops_of(drawing) == [TRIANGLE]
    assert drawing.notes == (
        "ignored: 1 clip-path",
        "ignored: 3 hidden element",
        "ignored: 1 image",
        "ignored: 2 text",
    )


def test_an_svg_without_a_namespace_or_with_a_prefix_is_read(read: Reading) -> None:
    plain = '<svg><polygon points="0,0 4,0 0,3"/></svg>'
    prefixed = '<s:svg xmlns:s="http://www.w3.org/2000/svg"><s:polygon points="0,0 4,0 0,3"/></s:svg>'
    doctype = '<?xml version="1.0"?><!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://example.org/svg11.dtd">'
    for text in (plain, prefixed, doctype + plain, "\ufeff" + plain):
        assert loops_of(read(".svg", text)) == [TRIANGLE]


def test_groups_may_nest_deeper_than_python_recurses(read: Reading) -> None:
    depth = 3 * sys.getrecursionlimit()
    drawing = read(".svg", svg("<g>" * depth + '<polygon points="0,0 4,0 0,3"/>' + "</g>" * depth))
    assert loops_of(drawing) == [TRIANGLE]


def test_a_path_of_twenty_thousand_corners_is_read(read: Reading) -> None:
    points = np.random.default_rng(1).random((20_000, 2))
    data = "M" + " ".join(f"{x} {y}" for x, y in points.tolist()) + "Z"
    np.testing.assert_array_equal(read(".svg", svg(f'<path d="{data}"/>')).loops[0], points * [1, -1])


POLYGON = '<polygon points="0,0 4,0 0,3"/>'
BAD_SVG = [
    ("<svg><polygon</svg>", "not XML: "),
    ("<html/>", "the outermost element is 'html', not svg"),
    ('<!DOCTYPE svg [<!ENTITY a "b">]><svg>&a;</svg>', "the file declares XML entities"),
    (
        '<!DOCTYPE svg [<!ENTITY a SYSTEM "/etc/passwd">]><svg><title>&a;</title></svg>',
        "declares XML entities",
    ),
    (f"<svg>&undefined;{POLYGON}</svg>", "not XML: undefined entity"),
    (svg(""), "the file has no polygon, polyline, rect or path"),
    (svg("<text>A</text>"), "the file has no polygon, polyline, rect or path"),
    (svg(POLYGON, 'viewBox="0 0 10"'), "the viewBox is '0 0 10'"),
    (svg(POLYGON, 'viewBox="0 0 0 10"'), "the viewBox is '0 0 0 10'"),
    (svg(POLYGON, 'viewBox="0 0 ten 10"'), "the viewBox has something other than numbers"),
    (svg(POLYGON, 'width="0"'), "the width of the file is '0'"),
    (svg(POLYGON, 'height="3 ells"'), "the height of the file is '3 ells'"),
    (
        svg(f'<svg x="3">{POLYGON}</svg>'),
        "svg number 1 is not an outline of straight segments; move its content",
    ),
    (
        svg('<circle id="eye" r="3"/>'),
        'circle "eye" is not an outline of straight segments; draw it as a polygon',
    ),
    (svg('<g><ellipse rx="3"/></g>'), "ellipse number 1"),
    (svg('<line x2="3"/>'), "line number 1 is not an outline of straight segments; join the lines"),
    (svg('<use href="#a"/>'), "use number 1 is not an outline of straight segments; replace the clone"),
    (svg('<use href="file:///etc/passwd"/>'), "use number 1"),
    (svg('<rect width="3" height="3" rx="1"/>'), "rect number 1 has round corners"),
    (svg('<rect width="50%" height="3"/>'), "width of rect number 1 is '50%'"),
    (
        svg('<path d="M 0 0 L 4 0 C 1 1 2 2 3 3 Z"/>'),
        "path number 1 has a curve ('C 1 1 2 2 3 3 Z'); flatten it",
    ),
    (svg(POLYGON + '<path/><path id="fin" d="M0 0A1 1 0 0 1 2 2z"/>'), 'path "fin" has a curve'),
    (svg('<path d="M 0 0 Q 1 1 2 2 Z"/>'), "has a curve"),
    (
        svg('<path d="M 0 0 4 0 0 3"/>'),
        "path number 1 is open: it starts at (0, 0) and ends at (0, 3), 3 away; close",
    ),
    (svg('<path d="M 0 0 H 4 V 3 Z M 5 5 H 9 V 9"/>'), "is open: it starts at (5, 5)"),
    (svg('<polyline points="0,0 4,0 0,3 1,1"/>'), "polyline number 1 is open"),
    (svg('<path d="M 0 0 L 4"/>'), "unreadable path data at 'L 4'"),
    (svg('<path d="M 0 0 L 4 0 X 3 Z"/>'), "unreadable path data at 'X 3 Z'"),
    (svg('<path d="M 0 0 L 4 0 0 #"/>'), "unreadable path data"),
    (svg('<path d="M 0 0 H V 3 Z"/>'), "unreadable path data"),
    (svg('<path d="L 4 0 0 3 Z"/>'), "unreadable path data at 'L 4 0 0 3 Z'"),
    (svg('<polygon points="0,0 4,0 0"/>'), "polygon number 1 has 5 numbers in points"),
    (svg("<polygon/>"), "polygon number 1 has 0 numbers in points"),
    (svg('<polygon points="0,0 4,zero"/>'), "points of polygon number 1 has something other than numbers"),
    (svg(f'<g transform="turn(3)">{POLYGON}</g>'), "g number 1 has the transform 'turn(3)'"),
    (svg('<polygon transform="matrix(1 2 3)" points="0,0 4,0 0,3"/>'), "has the transform 'matrix(1 2 3)'"),
    (svg('<polygon transform="scale()" points="0,0 4,0 0,3"/>'), "has the transform 'scale()'"),
    (svg('<polygon transform="rotate(1 2)" points="0,0 4,0 0,3"/>'), "has the transform 'rotate(1 2)'"),
    (svg('<polygon transform="rotate(1e999)" points="0,0 4,0 0,3"/>'), "has the transform 'rotate(1e999)'"),
]


def test_numbers_with_very_many_digits_are_read_in_linear_time(read: Reading) -> None:
    with pytest.raises(FileFormatError, match="unreadable path data"):
        read(".svg", svg(f'<path d="M{"1" * 100_000}x"/>'))


def test_numbers_beyond_float64_are_left_for_make_shape_to_refuse(read: Reading) -> None:
    for body in ('<polygon points="0,0 4,0 0,1e999"/>', f'<g transform="scale(1e999)">{POLYGON}</g>'):
        with pytest.raises(BadInputError, match=r"of loop 1 is .*; give finite numbers"):
            make_shape(read(".svg", svg(body)).loops)


# --- WKT


@pytest.mark.parametrize(
    ("text", "sizes"),
    [
        ("POLYGON ((0 0, 4 0, 0 -3, 0 0))", [4]),
        ("polygon((0 0,9 0,9 9,0 9,0 0),(1 1,2 1,1 2,1 1))\n", [5, 4]),
        (
            "MULTIPOLYGON (((0 0, 4 0, 0 -3, 0 0)), ((9 0, 9 9, 19 9, 9 0), (10 5, 11 6, 10 6, 10 5)))",
            [4, 4, 4],
        ),
        (
            "GEOMETRYCOLLECTION (POLYGON ((0 0, 4 0, 0 -3, 0 0)), MULTIPOLYGON (((9 0, 9 9, 19 9, 9 0))))",
            [4, 4],
        ),
    ],
)
def test_all_rings_of_a_wkt_file_are_loops(read: Reading, text: str, sizes: list[int]) -> None:
    drawing = read(".wkt", text)
    assert [len(loop) for loop in drawing.loops] == sizes
    assert (drawing.unit_mm, drawing.title, drawing.notes) == (None, "drawing", ())


def test_the_z_of_a_wkt_file_is_ignored_and_noted(read: Reading) -> None:
    drawing = read(".wkt", "POLYGON Z ((0 0 7, 4 0 7, 0 -3 7, 0 0 7))")
    assert loops_of(drawing) == [[*TRIANGLE, TRIANGLE[0]]]
    assert drawing.notes == ("the z coordinates were ignored",)


BAD_WKT = [
    ("hello", "not WKT: ParseException: Unknown type: 'HELLO'"),
    ("POLYGON ((0 0, 4 0, 0 3", "not WKT: "),
    (
        "POLYGON ((0 0, 4 0, 0 3))",
        "not WKT: IllegalArgumentException: Points of LinearRing do not form a closed",
    ),
    ("POLYGON EMPTY", "POLYGON is empty"),
    ("MULTIPOLYGON (((0 0, 4 0, 0 3, 0 0)), EMPTY)", "MULTIPOLYGON > POLYGON 2 is empty"),
    ("LINESTRING (0 0, 4 0)", "LINESTRING bounds no area; give a POLYGON"),
    (
        "GEOMETRYCOLLECTION (POLYGON ((0 0, 4 0, 0 3, 0 0)), POINT (1 1))",
        "GEOMETRYCOLLECTION > POINT 2 bounds no area",
    ),
    ("CURVEPOLYGON ((0 0, 4 0, 0 3, 0 0))", "not WKT: Nonlinear geometry types"),
    (
        "GEOMETRYCOLLECTION (" * 200_000 + "POINT (1 1)" + ")" * 200_000,
        "brackets are nested more than 50 deep",
    ),
]


def test_senseless_numbers_of_a_wkt_file_are_left_for_make_shape_to_refuse(read: Reading) -> None:
    for number in ("nan", "1e999"):
        with pytest.raises(BadInputError, match=r"point 2 of loop 1 is .*; give finite numbers"):
            make_shape(read(".wkt", f"POLYGON ((0 0, {number} 0, 0 3, 0 0))").loops)


# --- JSON loops


@pytest.mark.parametrize(
    ("units", "unit_mm"), [({}, None), ({"units": "mm"}, 1), ({"units": "cm"}, 10), ({"units": "in"}, 25.4)]
)
def test_json_loops_are_read_with_their_unit(read: Reading, units: dict[str, str], unit_mm: float | None) -> None:
    text = json.dumps({"loops": [TRIANGLE, [[9, 9], [8, 9], [8, 8]]], "source": {"any": ["thing"]}, **units})
    drawing = read(".json", text)
    assert loops_of(drawing) == [TRIANGLE, [[9, 9], [8, 9], [8, 8]]]
    assert (drawing.unit_mm, drawing.title) == (unit_mm, "drawing")


def test_json_loops_may_have_a_title(read: Reading) -> None:
    assert read(".json", json.dumps({"loops": [TRIANGLE], "title": "Fin"})).title == "Fin"


BAD_JSON = [
    ("{", "not JSON: Expecting property name enclosed in double quotes: line 1 column 2 (char 1); give"),
    ("[" * 100_000, "not JSON: "),
    ('{"loops": [[[0, 0], [' + "9" * 5000 + ", 0], [0, 1]]]}", "not JSON: Exceeds the limit"),
    ("[]", "the file has no loops"),
    ("{}", "the file has no loops"),
    ('{"loops": {}}', "loops is not a list with at least one loop"),
    ('{"loops": []}', "loops is not a list with at least one loop"),
    ('{"loops": [[]]}', "loops[0] is not a list of points"),
    ('{"loops": [[[0, 0], [1, 0], [0, 1]], 7]}', "loops[1] is not a list of points"),
    ('{"loops": [[0, 0], [1, 0], [0, 1]]}', "loops[0][0] is 0; give [x, y]"),
    ('{"loops": [[[0, 0], [1, 0], [0, 1, 2]]]}', "loops[0][2] is [0, 1, 2]; give [x, y] with two numbers"),
    ('{"loops": [[[0, 0], [1, "0"], [0, 1]]]}', 'loops[0][1] is [1, "0"]; give [x, y] with two numbers'),
    ('{"loops": [[[0, 0], [1, true], [0, 1]]]}', "loops[0][1] is [1, true]"),
    ('{"loops": [[[0, 0], [1, null], [0, 1]]]}', "loops[0][1] is [1, null]"),
    ('{"loops": [[[0, 0], [1' + "0" * 400 + ", 0], [0, 1]]]}", "loops[0] has a number too large for float64"),
    ('{"loops": [[[0, 0], [1, 0], [0, 1]]], "units": "ells"}', "units is 'ells'; give mm, cm, in, px"),
    ('{"loops": [[[0, 0], [1, 0], [0, 1]]], "units": ["mm"]}', "units is ['mm']"),
]


# --- all formats

BAD_TEXTS = [
    (suffix, text, fragment)
    for suffix, cases in ((".svg", BAD_SVG), (".wkt", BAD_WKT), (".json", BAD_JSON))
    for text, fragment in [*cases, ("", "the file is empty"), (" \n\t", "the file is empty")]
]


@pytest.mark.parametrize(("suffix", "text", "fragment"), BAD_TEXTS, ids=lambda value: str(value)[:50])
def test_a_bad_file_is_refused_with_its_name_the_fault_and_a_remedy(
    tmp_path: Path, suffix: str, text: str, fragment: str
) -> None:
    path = tmp_path / f"bad{suffix}"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(FileFormatError) as caught:
        read_shape(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert fragment in message
    assert ";" in message, "no remedy"
    assert len(message) < 400 + len(str(path))


@pytest.mark.parametrize("suffix", READERS)
def test_a_file_that_is_not_utf_8_is_refused(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"latin{suffix}"
    path.write_bytes("<svg>Füße</svg>".encode("latin-1"))
    with pytest.raises(FileFormatError, match="byte 6 is not UTF-8; save the file as UTF-8 text"):
        read_shape(path)


def test_a_suffix_is_known_in_either_case(tmp_path: Path) -> None:
    (tmp_path / "A.SVG").write_text(svg(POLYGON))
    assert loops_of(read_shape(str(tmp_path / "A.SVG"))) == [TRIANGLE]


def test_paths_that_lead_to_no_drawing_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match=r"drawings do not end in '\.png'; give a file that ends in \.svg, "):
        read_shape(tmp_path / "fish.png")
    with pytest.raises(FileFormatError, match=r"drawings do not end in ''; give a file that ends in \.svg"):
        read_shape("fish")
    with pytest.raises(FileFormatError, match=r"fish\.svg: there is no such file; check the path"):
        read_shape(tmp_path / "fish.svg")
    with pytest.raises(FileFormatError, match="is a folder; give a file in it"):
        read_shape(tmp_path)
    with pytest.raises(FileFormatError, match=r"File name too long; check the path"):
        read_shape(tmp_path / ("x" * 5000 + ".svg"))


@given(simple_polygons(4, 30))
def test_all_formats_give_back_the_same_numbers(tmp_path_factory: pytest.TempPathFactory, points: Points) -> None:
    folder = tmp_path_factory.mktemp("formats")
    pairs = [f"{x!r} {y!r}" for x, y in points]
    flipped = " ".join(f"{x!r} {-y!r}" for x, y in points)
    texts = {
        ".json": json.dumps({"loops": [points]}),
        ".wkt": f"POLYGON (({', '.join([*pairs, pairs[0]])}))",
        ".svg": svg(f'<path d="M {flipped} Z"/>'),
    }
    assert set(texts) <= set(READERS)
    for suffix, text in texts.items():
        (folder / f"p{suffix}").write_text(text)
        drawing = read_shape(folder / f"p{suffix}")
        assert make_shape(drawing.loops).loops[0].tolist() == [list(point) for point in points]
