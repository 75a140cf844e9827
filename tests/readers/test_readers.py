"""Drawings read from files: SVG, WKT and JSON loops, and what is refused in each."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from functools import reduce
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given
from support.strategies import Points, simple_polygons

from foldcut.cli.main import main
from foldcut.core.errors import BadInputError, FileFormatError
from foldcut.drawing.limits import DEEPEST, Limits
from foldcut.drawing.shape import make_shape
from foldcut.readers import READERS, Drawing, ReadOptions, read_shape
from foldcut.readers.svg import TEXTS

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
    body = '<path fill-rule="evenodd" d="M0 0H9V9H0ZM2 2H4V4H2Z"/>' + others
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
      <script>alert(1)</script><use href="other.svg#a"/><use href="http://example.org/#a"/>
      <g display="none"><circle r="3"/></g><path style="fill: red; display: none" d="M 0 0 C"/>
      <rect visibility="hidden" width="1" height="1"/>
      <polygon clip-path="url(#c)" points="0,0 4,0 0,3"/><!-- a comment --><?and-an instruction?>
    """
    drawing = read(".svg", svg(body))
    assert loops_of(drawing) == [TRIANGLE]
    assert drawing.ignored == (
        "1 clip-path",
        "2 external references",
        "3 hidden elements",
        "1 image",
        "1 script",
        "2 texts",
    )
    assert drawing.notes == (TEXTS,)


def test_an_svg_without_a_namespace_or_with_a_prefix_is_read(read: Reading) -> None:
    plain = '<svg><polygon points="0,0 4,0 0,3"/></svg>'
    prefixed = '<s:svg xmlns:s="http://www.w3.org/2000/svg"><s:polygon points="0,0 4,0 0,3"/></s:svg>'
    doctype = '<?xml version="1.0"?><!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://example.org/svg11.dtd">'
    for text in (plain, prefixed, doctype + plain, "\ufeff" + plain):
        assert loops_of(read(".svg", text)) == [TRIANGLE]


@pytest.mark.parametrize("suffix", [".svg", ".json", ".geojson", ".wkt"])
def test_nesting_is_limited_and_the_limit_is_an_option(tmp_path: Path, suffix: str) -> None:
    def text(depth: int) -> str:
        collection = '{"type": "GeometryCollection", "geometries": ['
        square = '{"type": "Polygon", "coordinates": [[[0, 0], [4, 0], [0, 3], [0, 0]]]}'
        return {
            ".svg": lambda: svg("<g>" * (depth - 1) + POLYGON + "</g>" * (depth - 1)),
            ".json": lambda: '{"a":' * (depth - 1) + "[[]]" + "}" * (depth - 1),
            ".geojson": lambda: collection * (depth // 2 - 2) + square + "]}" * (depth // 2 - 2),
            ".wkt": lambda: "GEOMETRYCOLLECTION (" * (depth - 2) + "POLYGON ((0 0, 4 0, 0 3, 0 0))" + ")" * (depth - 2),
        }[suffix]()

    path = tmp_path / f"deep{suffix}"
    for depth, deepest in ((50, 100), (499, DEEPEST), (99, 50), (1000, DEEPEST), (60_000, DEEPEST)):
        path.write_text(text(depth))
        options = ReadOptions(limits=Limits(nesting=deepest))
        if depth > deepest:
            with pytest.raises(FileFormatError, match="nested too deep, and at most .*--limit nesting=NUMBER"):
                read_shape(path, options)
        elif suffix == ".json":
            with pytest.raises(FileFormatError, match="the file has no loops"):
                read_shape(path, options)
        else:
            assert len(read_shape(path, options).loops) == 1


def test_brackets_in_strings_are_not_nested(read: Reading) -> None:
    text = json.dumps({"loops": [TRIANGLE], "title": '["\\' * 400})
    assert loops_of(read(".json", text)) == [TRIANGLE]


def test_a_chain_of_clones_is_nested(read: Reading) -> None:
    chain = "".join(f'<g id="a{n}"><use href="#a{n + 1}"/></g>' for n in range(60)) + f'<g id="a60">{POLYGON}</g>'
    with pytest.raises(FileFormatError, match="nested too deep"):
        read(".svg", svg(f'<defs>{chain}</defs><use href="#a0"/>'))


def test_a_path_of_twenty_thousand_corners_is_read(read: Reading) -> None:
    points = np.random.default_rng(1).random((20_000, 2))
    data = "M" + " ".join(f"{x} {y}" for x, y in points.tolist()) + "Z"
    np.testing.assert_array_equal(read(".svg", svg(f'<path d="{data}"/>')).loops[0], points * [1, -1])


POLYGON = '<polygon points="0,0 4,0 0,3"/>'


def clones(number: int) -> str:
    return f'<use href="#l{number}"/>' * 10


BAD_SVG = [
    ("<svg><polygon</svg>", "not XML: "),
    ("<html/>", "the outermost element is 'html', not svg"),
    ('<!DOCTYPE svg [<!ENTITY a "b"><!ENTITY c "&a;">]><svg>&c;</svg>', "the file declares XML entities such as 'c'"),
    (
        '<!DOCTYPE svg [<!ENTITY a SYSTEM "/etc/passwd">]><svg><title>&a;</title></svg>',
        "declares XML entities",
    ),
    (f"<svg>&undefined;{POLYGON}</svg>", "not XML: undefined entity"),
    (svg(""), "the file has no polygon, polyline, rect or path"),
    (
        svg("<text>A</text>"),
        "the file has no polygon, polyline, rect or path; draw a closed outline, and make texts into paths",
    ),
    (svg(POLYGON, 'viewBox="0 0 10"'), "the viewBox is '0 0 10'"),
    (svg(POLYGON, 'viewBox="0 0 0 10"'), "the viewBox is '0 0 0 10'"),
    (svg(POLYGON, 'viewBox="0 0 ten 10"'), "the viewBox has something other than numbers"),
    (svg(POLYGON, 'width="0"'), "the width of the file is '0'"),
    (svg(POLYGON, 'height="3 ells"'), "the height of the file is '3 ells'"),
    (svg('<use href="#a"/>'), "use number 1 shows '#a', which is not in the file; correct"),
    (svg('<g id="a"><use href="#a"/></g>'), "use number 2 shows #a, which it is part of; remove the clone"),
    (
        "<svg><defs>"
        + "".join(f'<g id="l{n}">{clones(n + 1)}</g>' for n in range(9))
        + f'<g id="l9">{POLYGON}</g></defs><use href="#l0"/></svg>',
        "more than 100,000 elements are shown; give a simpler drawing",
    ),
    (svg('<use href="file:///etc/passwd"/>'), "the file has no polygon"),
    (svg('<path d="M0 0H5"/><polyline points="1,1 2,2"/>'), "the outlines of the file enclose no area; draw"),
    (svg('<polygon points="%s"/>' % ("1 2 " * 500_000)), "about 500,004 points, and at most 100,000 are allowed"),
    (svg('<circle r="1e999"/>'), "r of circle number 1 is '1e999'; give a finite number"),
    (svg('<circle cx="5" r="1e308"/>'), "circle number 1 has path data that cannot be drawn; correct its numbers"),
    ("<svg>" + '<rect width="50%" height="3"/>' + "</svg>", "'50%' of a size that the file does not give; add a"),
    (svg('<rect width="5em" height="3"/>'), "width of rect number 1 is '5em'; give a number, or one with mm"),
    (svg('<path d="M 0 0 C 1 1 2 2 Z"/>'), "unreadable path data at 'C 1 1 2 2 Z'"),
    (svg('<path d="M0 0A1 1 0 2 1 2 2z"/>'), "unreadable path data at 'A1 1 0 2 1 2 2z'"),
    (
        svg('<path fill="none" d="M 0 0 4 0 0 3"/>'),
        "a line ends at (0, 0), 3 from the next end; close the outline, or join ends that are farther apart",
    ),
    (svg('<g style="fill:none"><path d="M 5 5 H 9 V 9"/></g>'), "a line ends at (5, 5)"),
    (svg('<line x2="3"/><line x2="3" y2="1"/><line x2="3" y2="2"/>'), "a line ends at (3, 0)"),
    (
        svg('<g stroke="red" fill="none"><path d="M0 0H3V3"/><path d="M0 0V3H3"/><path d="M0 0L3 3"/></g>'),
        "3 lines end",
    ),
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


def area(drawing: Drawing) -> float:
    polygons = [shapely.Polygon(loop) for loop in drawing.loops]
    return float(reduce(shapely.symmetric_difference, polygons).area)


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ('<circle cx="9" cy="9" r="10"/>', math.pi * 100),
        ('<ellipse rx="10" ry="4"/>', math.pi * 40),
        ('<ellipse rx="10"/>', math.pi * 100),
        ('<rect width="30" height="20" rx="5"/>', 600 - (4 - math.pi) * 25),
        ('<rect width="30" height="20" rx="50" ry="4"/>', 600 - (4 - math.pi) * 60),
        ('<path d="M0 0A10 10 0 0 1 20 0Z"/>', math.pi * 50),
        ('<path d="M0 0a10 10 0 1 0 20 0"/>', math.pi * 50),
        ('<path d="M0 0Q10 20 20 0Z"/>', 400 / 3),
        ('<path d="M0 0Q5 10 10 0T20 0"/>', 200 / 3),
        ('<path d="M0 0C0 10 20 10 20 0Z"/>', 120),
        ('<path d="M0 0C0 5 10 5 10 0S20-5 20 0Z"/>', 60),
    ],
)
def test_curves_become_segments_within_the_tolerance(tmp_path: Path, body: str, expected: float) -> None:
    (tmp_path / "a.svg").write_text(svg(body))
    corners = []
    for tolerance in (0.05, 0.0005):
        drawing = read_shape(tmp_path / "a.svg", ReadOptions(flatten_mm=tolerance))
        assert area(drawing) == pytest.approx(expected, abs=tolerance * 80)
        corners.append(sum(map(len, drawing.loops)))
    assert 5 * corners[0] < corners[1] < 20 * corners[0]


def test_a_flattened_circle_is_symmetric_and_within_the_tolerance(read: Reading) -> None:
    (loop,) = read(".svg", svg('<circle r="40"/>')).loops
    assert len(loop) % 4 == 0
    np.testing.assert_allclose(np.hypot(*loop.T), 40, rtol=1e-12)
    assert np.hypot(*((loop + np.roll(loop, 1, axis=0)) / 2).T).min() > 40 - 0.05


SQUARES = "M0 0H9V9H0Z M2 2H4V4H2Z"  # both in the same direction


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        (f'<path d="{SQUARES}"/>', 81),
        (f'<path d="{SQUARES}" fill-rule="evenodd"/>', 77),
        (f'<g style="fill-rule:evenodd"><path d="{SQUARES}"/></g>', 77),
        (f'<style>/* a */ .hole, #x {{ fill-rule: evenodd }}</style><path class="a hole" d="{SQUARES}"/>', 77),
        (f'<path d="{SQUARES}" fill="none" stroke="red"/>', 77),
        ('<path d="M0 0H9V9H0Z M2 2V4H4V2Z"/>', 77),
        ('<path d="M0 0H4V4H0Z M2 2H6V6H2Z"/>', 28),
        ('<path d="M0 0H4V4H0Z M2 2H6V6H2Z" fill-rule="evenodd"/>', 24),
        ('<rect width="4" height="4"/><rect x="2" y="2" width="4" height="4"/>', 28),
        ('<rect width="4" height="4"/><rect x="4" width="4" height="4"/>', 32),
        ('<rect width="4" height="4"/><rect width="4" height="4"/>', 16),
        ('<rect width="9" height="9"/><rect x="2" y="2" width="4" height="4" fill="white"/>', 65),
        ('<path d="M0 0 4 0 4 4 0 4"/>', 16),
    ],
)
def test_outlines_fill_what_the_file_says(read: Reading, body: str, expected: float) -> None:
    assert area(read(".svg", svg(body))) == pytest.approx(expected)


def test_a_pentagram_is_filled_by_its_own_rule(read: Reading) -> None:
    star = '<polygon points="0,-10 6,8 -9.5,-3 9.5,-3 -6,8" {}/>'
    assert [len(loop) for loop in read(".svg", svg(star.format(""))).loops] == [10]
    hollow = read(".svg", svg(star.format('fill-rule="evenodd"')))
    assert sorted(len(loop) for loop in hollow.loops) == [3] * 5


def test_lines_are_joined_end_to_end(read: Reading) -> None:
    lines = '<line x2="4"/><line x1="4" y1="0.00001" x2="0" y2="3"/><path fill="none" stroke="red" d="M0 3V0"/>'
    (loop,) = read(".svg", svg(lines)).loops
    assert sorted((loop.round(3) + 0.0).tolist()) == [[0, -3], [0, 0], [4, 0]]


@pytest.mark.parametrize(
    ("suffix", "text"),
    [
        (".svg", svg('<polyline fill="none" stroke="red" points="0,0 4,0 0,3 0.0005,0"/>')),
        (".svg", svg('<path d="M0 0H4L0 3L0 0.0005Z"/>')),
        (".csv", "0,0\n4,0\n0,-3\n0,0.0005\n"),
        (".json", '{"loops": [[[0, 0], [4, 0], [0, -3], [0, 0.0005]]], "units": "mm"}'),
        (".geojson", '{"type": "Polygon", "coordinates": [[[0, 0], [4, 0], [0, -3], [0, 0.0005]]]}'),
        (".geojson", '{"type": "LineString", "coordinates": [[0, 0], [4, 0], [0, -3], [0, 0.0005]]}'),
        (".wkt", "POLYGON ((0 0, 4 0, 0 -3, 0 0.0005))"),
        (".wkt", "LINESTRING (0 0, 4 0, 0 -3, 0 0.0005)"),
        (".wkt", "MULTILINESTRING ((0 0, 4 0, 0 -3), (0 -3, 0 0.0005))"),
    ],
)
def test_a_small_gap_is_closed_and_told(tmp_path: Path, suffix: str, text: str) -> None:
    path = tmp_path / f"a{suffix}"
    path.write_text(text)
    drawing = read_shape(path)
    assert sorted((drawing.loops[0] + 0.0).tolist()) == sorted(TRIANGLE)
    assert re.fullmatch(r"closed 1 gap of at most 0\.0005( mm)? between ends of lines", drawing.repairs[-1])
    # a smaller tolerance leaves it as it is, or refuses it
    try:
        assert not any("gap" in repair for repair in read_shape(path, ReadOptions(join_mm=0.0001)).repairs)
    except FileFormatError as error:
        assert "a line ends at" in str(error)
    # rounding is not told
    path.write_text(text.replace("0.0005", "0.0000001"))
    assert not any("gap" in repair for repair in read_shape(path).repairs)


def test_rings_that_do_not_repeat_their_first_point_are_closed_and_told(read: Reading) -> None:
    told = "that did not repeat the first point"
    ring = '{"type": "Polygon", "coordinates": [[[0, 0], [4, 0], [0, -3]]]}'
    assert read(".geojson", ring).repairs == (f"closed 1 ring {told}",)
    assert read(".wkt", "POLYGON ((0 0, 4 0, 0 -3))").repairs == (f"closed rings {told}",)
    assert loops_of(read(".wkt", "POLYGON ((0 0, 4 0, 0 -3))")) == [TRIANGLE]


STROKED = '<g fill="none" stroke="red">{}</g>'


@pytest.mark.parametrize(
    ("body", "told"),
    [
        ('<path d="M5 5H6"/>', "left out a line that ends where no other continues, at (5, 5), 1 from the next end"),
        ('<path d="M4 0H9V9"/>', "left out a line that ends where no other continues, at ("),
        ('<path d="M5 5H6"/><path d="M6 5V7"/>', "left out 2 lines that end where no other continues, at (5, 5), "),
        ('<path d="M5 5H6Z"/>', "left out 1 outline without area"),
        ('<path d="M5 5H6V6H6V5Z"/>', "left out 1 outline without area"),
        ('<path d="M5 5H6"/><path d="M6 5H5"/>', "left out 1 line drawn twice; left out a line that ends"),
    ],
)
def test_strays_beside_an_outline_are_left_out_and_told(read: Reading, body: str, told: str) -> None:
    closed = read(".svg", svg(STROKED.format(POLYGON + body)))
    assert loops_of(closed) == [TRIANGLE]
    (repair,) = closed.repairs
    assert repair.startswith(told)
    joined = '<path d="M0 0H4"/><path d="M4 0L0 3"/><path d="M0 3V0"/>'
    (loop,) = read(".svg", svg(STROKED.format(joined + body))).loops
    assert sorted((loop + 0.0).tolist()) == sorted(TRIANGLE)


def test_a_line_drawn_twice_counts_once(read: Reading) -> None:
    lines = '<path d="M0 0H4"/><path d="M4 0L0 3"/><path d="M0 3V0"/><path d="M0 3L4 0"/>'
    drawing = read(".svg", svg(STROKED.format(lines)))
    assert (len(drawing.loops), drawing.repairs) == (1, ("left out 1 line drawn twice",))


def test_very_many_lines_from_one_place_are_refused_soon(read: Reading) -> None:
    rays = "".join(f'<path d="M0 0L{n} {n % 7}"/>' for n in range(1, 20_000))
    with pytest.raises(FileFormatError, match="too many lines end at the same places; draw an outline"):
        read(".svg", svg(STROKED.format(rays)))


def test_strict_refuses_what_the_reader_mends(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a.svg"
    path.write_text(svg(STROKED.format('<path d="M0 0H40V30L0 0.02"/><path d="M5 5H6"/>')))
    command = ["make", str(path), "-o", str(tmp_path / "a.fold"), "--effort", "fast", "--join", "0.1mm"]
    assert main([*command, "--strict"]) == 2
    error = capsys.readouterr().err
    assert "has to be mended: closed 1 gap of at most 0.02 mm between ends of lines; left out a line" in error
    assert main(command) == 0
    assert "note      closed 1 gap of at most 0.02 mm between ends of lines" in capsys.readouterr().out


@pytest.mark.parametrize(
    "body",
    [
        '<rect x="5%" y="10%" width="50%" height="60%"/>',
        '<svg x="4" y="6" width="50%" height="60%"><rect width="100%" height="100%"/></svg>',
        '<svg x="4" y="6" width="50%" height="60%" viewBox="9 9 4 3.6">'
        '<rect x="9" y="9" width="4" height="3.6"/></svg>',
        '<svg x="5%" y="10%" width="40" height="36" viewBox="0 0 10 9"><rect width="100%" height="100%"/></svg>',
        '<symbol id="s" viewBox="0 0 80 60"><rect x="5%" y="10%" width="50%" height="60%"/></symbol><use href="#s"/>',
        '<symbol id="s"><rect width="100%" height="100%"/></symbol>'
        '<use href="#s" x="5%" y="10%" width="50%" height="60%"/>',
    ],
)
def test_percentages_are_of_the_nearest_viewport(read: Reading, body: str) -> None:
    for attributes in ('viewBox="0 0 80 60"', 'width="80" height="60"', 'viewBox="1 2 80 60" width="50%"'):
        (loop,) = read(".svg", svg(body, attributes)).loops
        np.testing.assert_allclose(loop, [[4, -6], [44, -6], [44, -42], [4, -42]], atol=1e-9)


def test_a_percentage_of_a_radius_is_of_the_diagonal(read: Reading) -> None:
    (loop,) = read(".svg", svg('<circle cx="50%" cy="50%" r="10%"/>', 'viewBox="0 0 80 60"')).loops
    np.testing.assert_allclose(np.hypot(*(loop - (40, -30)).T), 0.1 * math.sqrt((80**2 + 60**2) / 2))


RULES = "<style>#a {fill: none} .b {fill: red} rect, * {fill: red}</style>"


@pytest.mark.parametrize(
    ("body", "told"),
    [
        (f'<path d="M0 0H24V24H0Z" fill="none"/>{POLYGON}<path d="M5 5v0z"/>', ("1 outline without fill and stroke",)),
        (f'<g fill="none"><rect style="fill: inherit" width="9" height="9"/></g>{POLYGON}', None),
        (f'{RULES}{POLYGON}<rect id="a" class="b" width="9" height="9"/>', None),
        (f'<rect width="100%" height="100%" fill="#FFF"/>{POLYGON}', ("1 white background",)),
        ('<g fill="none"><polygon points="0,0 4,0 0,3"/></g>', ()),
        ('<polygon fill="white" points="0,0 4,0 0,3"/>', ()),
    ],
)
def test_what_is_not_seen_is_no_outline_beside_what_is(read: Reading, body: str, told: tuple[str, ...] | None) -> None:
    drawing = read(".svg", svg(body))
    assert loops_of(drawing) == [TRIANGLE]
    assert drawing.ignored == (("1 outline without fill and stroke",) if told is None else told)


@pytest.mark.parametrize(
    "body",
    [
        '<defs>{}</defs><use href="#p"/>',
        '<defs>{}</defs><g transform="scale(2)"><use x="1" href="#p" transform="scale(.5) translate(-1 0)"/></g>',
        '<symbol id="s" viewBox="0 0 8 8">{}</symbol><use xlink:href="#s" width="8" height="8"/>',
        '<symbol id="s" viewBox="8 8 8 8"><g transform="translate(8 8)">{}</g></symbol>'
        '<use href="#s" width="16" height="8" x="-4"/>',
        '<svg x="2" y="1" overflow="visible"><g transform="translate(-2 -1)">{}</g></svg>',
        '<svg viewBox="0 0 8 8" width="16" height="16"><g transform="scale(.5)">{}</g></svg>',
    ],
)
def test_clones_symbols_and_nested_svgs_are_shown_where_they_lie(read: Reading, body: str) -> None:
    polygon = POLYGON.replace("<polygon", '<polygon id="p"')
    names = 'xmlns:xlink="http://www.w3.org/1999/xlink" viewBox="0 0 9 9"'
    assert sorted(loops_of(read(".svg", svg(body.format(polygon), names)))[0]) == sorted(TRIANGLE)


def test_layers_and_ids_select(tmp_path: Path) -> None:
    label = 'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" inkscape:label="Cut me"'
    body = f'<g id="one" {label}>{POLYGON}</g><g id="two"><circle id="c" r="3"/><rect id="r" width="1" height="2"/></g>'
    (tmp_path / "a.svg").write_text(svg(body))

    def sizes(**options: tuple[str, ...]) -> list[int]:
        return [len(loop) for loop in read_shape(tmp_path / "a.svg", ReadOptions(**options)).loops]  # type: ignore

    assert sizes(layers=("Cut me",)) == sizes(layers=("one",)) == sizes(ids=("one",)) == [3]
    assert sizes(ids=("r",)) == sizes(layers=("two",), ids=("r",)) == [4]
    with pytest.raises(FileFormatError, match="no outline is in --layer three; the file has Cut me, two"):
        sizes(layers=("three",))
    with pytest.raises(FileFormatError, match="no outline is in --id x; the file has c, one, r, two"):
        sizes(ids=("x",))


@pytest.mark.parametrize(
    "body",
    [
        '<path style="fill:none" d="M0 0t5 1e308z"/><rect width="3" height="1e308" x="1e308"/>',
        '<ellipse rx="5" ry="1e9"/><path fill="none" d="M0 0t1e999 1e999M0 1A5 10 5 0 0 1e999 1e9 "/>',
        '<path transform="scale(0)" d="M0 0L5 1A.5 10 5 1 1 .5 .5M1e308 1M0 1e9L1e308 1e308C1 10 0 1e308 5 -7 "/>',
    ],
)
def test_numbers_at_the_ends_of_float64_are_refused_by_reader_or_shape(read: Reading, body: str) -> None:
    with pytest.raises(BadInputError):
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
    ("POLYGON EMPTY", "POLYGON is empty"),
    ("MULTIPOLYGON (((0 0, 4 0, 0 3, 0 0)), EMPTY)", "MULTIPOLYGON > POLYGON 2 is empty"),
    ("LINESTRING (0 0, 4 0)", "a line ends at (0, 0), 4 from the next end; close the outline"),
    ("GEOMETRYCOLLECTION (POINT (0 3), MULTIPOINT (1 1))", "GEOMETRYCOLLECTION bounds no area; give a POLYGON"),
    ("CURVEPOLYGON ((0 0, 4 0, 0 3, 0 0))", "not WKT: Nonlinear geometry types"),
    (
        "GEOMETRYCOLLECTION (" * 200_000 + "POINT (1 1)" + ")" * 200_000,
        "things are nested too deep, and at most 100 are allowed",
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
    ("[" * 100_000, "things are nested too deep"),
    ('{"loops": [[[0, 0], [' + "9" * 5000 + ", 0], [0, 1]]]}", "not JSON: a number has thousands of digits"),
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


@pytest.mark.parametrize("suffix", [".svg", ".json", ".wkt"])
def test_a_text_file_that_is_not_utf_8_is_refused(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"latin{suffix}"
    path.write_bytes("<svg>Füße</svg>".encode("latin-1"))
    with pytest.raises(FileFormatError, match="byte 6 is not UTF-8; save the file as UTF-8 text"):
        read_shape(path)


def test_a_suffix_is_known_in_either_case(tmp_path: Path) -> None:
    (tmp_path / "A.SVG").write_text(svg(POLYGON))
    assert loops_of(read_shape(str(tmp_path / "A.SVG"))) == [TRIANGLE]


def test_paths_that_lead_to_no_drawing_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match=r"drawings do not end in '\.gif'; give a file that ends in \.svg, "):
        read_shape(tmp_path / "fish.gif")
    with pytest.raises(FileFormatError, match=r"fish: there is no such file; check the path, or take a sample"):
        read_shape(tmp_path / "fish")
    (tmp_path / "star").write_bytes(b"")
    with pytest.raises(FileFormatError, match=r"drawings do not end in ''; give a file that ends in \.svg"):
        read_shape(tmp_path / "star")
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
