"""Hostile and odd files, and how foldcut has to treat each: add a row to add a case.

``CASES`` are by file name, whose suffix tells the format. ``words``: part of the report on the drawing if it is taken
(a repair, or something left out; empty if neither), or part of the error if it is refused.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Case:
    """The bytes of a file, whether it is taken or refused, and the words that say so."""

    data: bytes
    taken: bool
    words: str = ""


CASES: dict[str, Case] = {}


def taken(name: str, data: str | bytes, words: str = "") -> None:
    """Add a file that is taken; ``words`` are in the report's notes."""
    _add(name, data, words, is_taken=True)


def refused(name: str, data: str | bytes, words: str) -> None:
    """Add a file that is refused; ``words`` are in the error."""
    _add(name, data, words, is_taken=False)


def _add(name: str, data: str | bytes, words: str, *, is_taken: bool) -> None:
    assert name not in CASES, name
    CASES[name] = Case(data.encode() if isinstance(data, str) else data, is_taken, words)


def svg(body: str, attributes: str = 'viewBox="0 0 100 100"') -> str:
    return f'<svg xmlns="http://www.w3.org/2000/svg" {attributes}>{body}</svg>'


def path(data: str) -> str:
    return svg(f'<path d="{data}"/>')


def stroked(*paths: str) -> str:
    return svg("".join(f'<path fill="none" stroke="red" d="{one}"/>' for one in paths))


def loops(*drawn: Any, **more: Any) -> str:
    return json.dumps({"loops": drawn, **more})


BOX = "M0 0H40V40H0Z"
SQUARE = [[0, 0], [40, 0], [40, 40], [0, 40]]
WKT_SQUARE = "(0 0, 40 0, 40 40, 0 40, 0 0)"

# --- any format -----------------------------------------------------------------------------------------------------
EMPTY = "the file is empty"
TOO_DEEP = "things are nested too deep, and at most 100 are allowed; give a flat drawing, or allow more with --limit"
GAP = "closed 1 gap of at most "
STRAY = "left out a line that ends where no other continues, at (5, "
for suffix in ("svg", "json", "wkt", "fold"):
    refused(f"nothing.{suffix}", b"", EMPTY)
    refused(f"blank.{suffix}", b" \n\t\r\n", EMPTY)
    refused(f"zeros.{suffix}", bytes(1000), "not ")
    refused(f"high-bytes.{suffix}", bytes(range(128, 256)), "byte 0 is not UTF-8")
    if suffix != "svg":  # whose encoding may be declared
        refused(f"utf-16.{suffix}", "<svg/>".encode("utf-16"), "byte 0 is not UTF-8")
    refused(f"png-inside.{suffix}", b"\x89PNG\r\n\x1a\n" + bytes(99), "byte 0 is not UTF-8")
    refused(f"html.{suffix}", "<!doctype html><html><body>404</body></html>", "not ")
    refused(f"words.{suffix}", "this is not a drawing", "not ")
for suffix in ("svg", "json", "wkt"):
    refused(f"too-large.{suffix}", b" " * (20 * 2**20 + 1), "has 20,971,521 bytes, and at most 20,971,520 are allowed")
    refused(f"too-many-numbers.{suffix}", b"1 " * 500_000, "has about 250,000 points, and at most 100,000 are allowed")

# --- SVG ------------------------------------------------------------------------------------------------------------
taken("box.svg", path(BOX))
taken("utf-16.svg", path(BOX).encode("utf-16"))
latin = '<?xml version="1.0" encoding="ISO-8859-1"?>' + svg(f'<title>\xe9</title><path d="{BOX}"/>')
taken("latin-1.svg", latin.encode("latin-1"))
taken("bom.svg", b"\xef\xbb\xbf" + path(BOX).encode())
taken("crlf.svg", path(BOX.replace("H", "\r\nH")))
taken("no-namespace.svg", '<svg viewBox="0 0 9 9"><rect width="9" height="9"/></svg>')
taken("declaration.svg", '<?xml version="1.0" encoding="UTF-8"?>' + path(BOX))
taken("comment.svg", svg(f'<!-- <path d="C"/> --><path d="{BOX}"/>'))
taken("metadata.svg", svg(f'<metadata><a xmlns="x:y">1</a></metadata><path d="{BOX}"/>'))
taken("script.svg", svg(f'<script>while(true){{}}</script><path d="{BOX}"/>'))
taken("style-import.svg", svg(f'<style>@import url("file:///etc/passwd");</style><path d="{BOX}"/>'))
taken("remote-image.svg", svg(f'<image href="http://127.0.0.1:9/x.png"/><path d="{BOX}"/>'), "1 image")
taken("file-image.svg", svg(f'<image href="file:///etc/passwd"/><path d="{BOX}"/>'), "1 image")
taken("text.svg", svg(f'<text>hello</text><path d="{BOX}"/>'), "1 text")
taken("hidden.svg", svg(f'<path display="none" d="M0 0C1 1 2 2 3 3"/><path d="{BOX}"/>'), "1 hidden element")
taken("groups.svg", svg("<g>" * 99 + f'<path d="{BOX}"/>' + "</g>" * 99))
refused("deep-groups.svg", svg("<g>" * 2_000 + f'<path d="{BOX}"/>' + "</g>" * 2_000), TOO_DEEP)
clones = "".join(f'<g id="a{n}"><use href="#a{n + 1}"/></g>' for n in range(1_000))
refused("clones-of-clones.svg", svg(f'<defs>{clones}</defs><use href="#a0"/>'), TOO_DEEP)
taken("many-attributes.svg", svg("<g " + " ".join(f'a{n}="1"' for n in range(5_000)) + f'><path d="{BOX}"/></g>'))
taken("title-of-control-signs.svg", svg(f'<title>a&#9;b&#10;c</title><path d="{BOX}"/>'))
taken("title-is-a-path.svg", svg(f'<title>../../etc/passwd</title><path d="{BOX}"/>'))
taken("tiny-scale.svg", svg('<g transform="scale(1e-6)"><path d="M0 0H40V40H0Z"/></g>'))
taken("huge-scale.svg", svg('<g transform="scale(1e6)"><path d="M0 0H40V40H0Z"/></g>'))
taken("mirrored.svg", svg(f'<g transform="scale(-1 1)"><path d="{BOX}"/></g>'))
taken("many-close.svg", path(BOX + "Z" * 1000))
taken("many-more-close.svg", path(BOX + "Z" * 40_000))
refused("close-without-end.svg", path(BOX + "Z" * 500_000), "has more than 100,000 points")
taken("lines-in-one-place.svg", path(BOX + "L9 9Z" * 10_000), "left out")
taken("many-moves.svg", path("M1 1" * 1000 + BOX))
taken("relative.svg", path("m0 0h40v40h-40z"))
taken("repeated-points.svg", path("M0 0" + "L40 0" * 50 + "L40 40L40 40L0 40Z"))
taken("collinear-points.svg", path("M0 0" + "".join(f"H{n}" for n in range(1, 41)) + "V40H0Z"))
taken("twice.svg", svg(f'<path d="{BOX}"/><path d="{BOX}"/>'), "2 outlines that overlap or touch were united")
taken(
    "overlap.svg",
    svg('<rect width="40" height="40"/><rect x="20" width="40" height="40"/>'),
    "2 outlines that overlap or touch were united",
)
taken("needle-spike.svg", path("M0 0H40V20H80H40V40H0Z"))
taken("a-stray-line.svg", svg(f'<path d="{BOX}"/><path d="M5 5L6 6Z"/>'), "left out 1 outline without area")
taken("a-stray-open-line.svg", stroked(BOX, "M5 5L6 6"), STRAY)
taken("a-tail.svg", stroked("M0 0H40", "M40 0V40H0", "M0 40V0", "M40 0L50 -5"), "left out a line that ends where")
taken("drawn-twice.svg", stroked("M0 0H40", "M40 0V40H0", "M0 40V0", "M40 0H0"), "left out 1 line drawn twice")
taken("a-gap.svg", stroked("M0 0H40", "M40 0.003V40H0V0"), GAP)
refused(
    "a-wide-gap.svg", stroked("M0 0H40", "M40 0.5V40H0V0"), "0.5 from the next end; close the outline, or join ends"
)
refused("a-crossroads.svg", stroked("M0 0H40V40", "M0 0V40H40", "M0 0L40 40"), "3 lines end at (0, 0); keep only two")
refused("rays.svg", stroked(*(f"M0 0L{n} 1" for n in range(1, 2_000))), "too many lines end at the same places")
taken("unpainted-box.svg", svg(f'<path fill="none" d="M-9 -9H99V99H-9Z"/><path d="{BOX}"/>'), "without fill and stroke")
taken("white-background.svg", svg(f'<rect width="100%" height="100%" fill="#fff"/><path d="{BOX}"/>'), "1 white backg")
taken("percentages.svg", svg('<rect x="10%" y="5%" width="50%" height="40%"/>'))
taken("percentages-of-a-nested-svg.svg", svg('<svg width="50%" height="20"><rect width="100%" height="100%"/></svg>'))
refused(
    "percentages-of-nothing.svg", svg('<rect width="50%" height="9"/>', ""), "of a size that the file does not give"
)
refused("percentage-of-letters.svg", svg('<rect width="a%" height="9"/>'), "width of rect number 1 is 'a%'")
refused("cut-off.svg", path(BOX)[:60], "not XML: ")
refused("two-roots.svg", path(BOX) * 2, "not XML: ")
refused("other-root.svg", "<html/>", "the outermost element is 'html', not svg")
refused("nothing-drawn.svg", svg(""), "the file has no polygon")
bomb = "".join(f'<!ENTITY a{n} "{f"&a{n - 1};" * 10}">' for n in range(1, 10))
refused("laughs.svg", f'<!DOCTYPE svg [<!ENTITY a0 "lol">{bomb}]><svg>&a9;</svg>', "declares XML entities")
refused("external-entity.svg", '<!DOCTYPE svg [<!ENTITY x SYSTEM "file:///etc/passwd">]><svg>&x;</svg>', "XML entities")
refused("parameter-entity.svg", '<!DOCTYPE svg [<!ENTITY % x SYSTEM "http://127.0.0.1:9/">%x;]><svg/>', "XML entities")
refused("unknown-entity.svg", svg("&nowhere;"), "not XML: undefined entity")
refused("unknown-prefix.svg", svg("<a:b/>"), "not XML: unbound prefix")
refused("repeated-attribute.svg", '<svg a="1" a="2"/>', "not XML: duplicate attribute")
refused("use-of-itself.svg", svg('<g id="a"><use href="#a"/></g>'), "which it is part of; remove the clone")
refused("use-of-a-file.svg", svg('<use href="/etc/passwd#a"/>'), "the file has no polygon")
refused("nested-svg.svg", svg(svg("")), "the file has no polygon")
refused("curve.svg", path("M0 0C1 1 2 2 3 3Z"), "enclose no area")
refused("path-of-letters.svg", path("M0 0LxyzZ"), "unreadable path data at 'LxyzZ'")
refused("path-of-nan.svg", path("M0 0LNaN 1L2 2Z"), "unreadable path data")
refused("infinite.svg", path("M0 0H1e999V40Z"), "give finite numbers")
refused("overflow.svg", path("M0 0H1e200V1e200Z"), "1e+200")
refused("far-away.svg", svg('<g transform="translate(1e15 0)"><path d="M0 0H1V1Z"/></g>'), "1e+15")
taken("open.svg", path("M0 0H40V40"))
refused("a-point.svg", path("M0 0Z"), "enclose no area")
refused("a-line.svg", path("M0 0L40 40Z"), "enclose no area")
refused("odd-points.svg", svg('<polygon points="0 0 40 0 40"/>'), "has 5 numbers in points")
refused("no-points.svg", svg("<polygon/>"), "has 0 numbers in points")
refused("points-of-words.svg", svg('<polygon points="a b c"/>'), "something other than numbers")
refused("bad-transform.svg", svg(f'<g transform="scale("><path d="{BOX}"/></g>'), "has the transform 'scale('")
refused("scale-zero.svg", svg(f'<g transform="scale(0)"><path d="{BOX}"/></g>'), "enclose no area")
refused("nan-transform.svg", svg(f'<g transform="scale(nan)"><path d="{BOX}"/></g>'), "has the transform")
refused("huge-angle.svg", svg(f'<g transform="rotate(1e999)"><path d="{BOX}"/></g>'), "has the transform")
refused("bad-view-box.svg", svg("", 'viewBox="0 0 0 0"'), "the viewBox is '0 0 0 0'")
refused("short-view-box.svg", svg("", 'viewBox="0 0 9"'), "the viewBox is '0 0 9'")
refused("negative-width.svg", svg("", 'width="-9mm" viewBox="0 0 9 9"'), "give a positive length")
taken("round-corners.svg", svg('<rect width="9" height="9" rx="1"/>'))
refused("digits-without-end.svg", path("M0 0L" + "1" * 100_000 + " 1Z"), "give finite numbers")
refused("slow-number.svg", path("M0 0L" + "1" * 50_000 + "x"), "unreadable path data")
refused("slow-transform.svg", svg(f'<g transform="{"(" * 50_000}"/>'), "has the transform")
refused("deep-cut-off.svg", "<svg>" + "<g>" * 100_000, "not XML: ")
taken("bow-tie.svg", path("M0 0L40 40V0L0 40Z"))
taken("touching-corners.svg", path("M0 0H40V40H0ZM40 40H80V80H40Z"))
refused("many-loops.svg", path("".join(f"M{n} 0h.5v.5z" for n in range(1_001))), "has 1,001 loops, and at most 1,000")

# --- JSON -----------------------------------------------------------------------------------------------------------
taken("box.json", loops(SQUARE))
taken("bom.json", b"\xef\xbb\xbf" + loops(SQUARE).encode())
taken("clockwise.json", loops(SQUARE[::-1]))
taken("closed.json", loops([*SQUARE, SQUARE[0]]))
taken("other-keys.json", loops(SQUARE, author={"file": "/etc/passwd"}))
taken("title-is-a-number.json", loops(SQUARE, title=7))
taken("long-title.json", loops(SQUARE, title="a" * 100_000))
taken("title-of-signs.json", loops(SQUARE, title="\u202e\x00\x1b[2J<&\"'>"))
taken("small.json", loops([[x * 1e-6, y * 1e-6] for x, y in SQUARE]))
taken("large.json", loops([[x * 1e6, y * 1e6] for x, y in SQUARE]))
taken("key-twice.json", '{"loops": 1, "loops": [[[0, 0], [40, 0], [0, 40]]]}')
taken(
    "almost-straight.json",
    loops([[0, 0], [21, 8e-6], [27, 4e-6], [38, 1.2e-5], [40, 0], [40, 40], [0, 40]]),
)
taken(
    "hairline.json",
    loops([[0, 0], [40, 0], [40, 20], [47, 27], [40, 20.00000000000001], [40, 40], [0, 40]]),
    "dropped 1 point of spikes without width",
)
taken("repeated-loop.json", loops(SQUARE, SQUARE), "dropped loop 2: it repeats loop 1")
taken("overlapping.json", loops(SQUARE, [[20, -10], [60, -10], [60, 50], [20, 50]]), "2 -> 2 loops")
taken("common-side.json", loops(SQUARE, [[40, 0], [60, 0], [60, 40], [40, 40]]), "2 -> 1 loops")
taken("empty-beside.json", loops(SQUARE, [[1, 1]]), "dropped loop 2: it bounds no area")
taken("sliver.json", loops(SQUARE, [[39, 0], [79, 0], [79, 1e-3], [39, 1e-3]]), "dropped 1 sliver")
refused("cut-off.json", loops(SQUARE)[:-3], "not JSON: ")
taken("a-gap.json", loops([*SQUARE, [0, 0.003]]), GAP)
taken("brackets-in-a-title.json", loops(SQUARE, title="[{" * 1_000))
refused("deep.json", '{"loops":' + "[" * 100_000, TOO_DEEP)
refused("deep-closed.json", '{"loops":' + "[" * 100_000 + "]" * 100_000 + "}", TOO_DEEP)
refused("a-list.json", "[]", "the file has no loops")
refused("null.json", "null", "the file has no loops")
refused("no-loops.json", "{}", "the file has no loops")
refused("loops-empty.json", loops(), "loops is not a list with at least one loop")
refused("loops-null.json", '{"loops": null}', "loops is not a list")
refused("loop-null.json", loops(None), "loops[0] is not a list of points")
refused("loop-text.json", loops("abc"), "loops[0] is not a list of points")
refused("point-text.json", loops([["a", "b"]]), 'loops[0][0] is ["a", "b"]; give [x, y]')
refused("point-3d.json", loops([[0, 0, 0]]), "loops[0][0] is [0, 0, 0]")
refused("point-true.json", loops([[True, False]]), "loops[0][0] is [true, false]")
refused("nan.json", '{"loops": [[[NaN, 0], [1, 0], [0, 1]]]}', "nan")
refused("infinity.json", '{"loops": [[[Infinity, 0], [1, 0], [0, 1]]]}', "inf")
refused("digits.json", '{"loops": [[[1' + "0" * 400 + ", 0], [1, 0], [0, 1]]]}", "too large for float64")
refused("more-digits.json", '{"loops": [[[1' + "0" * 5_000 + ", 0], [1, 0], [0, 1]]]}", "not JSON: ")
refused("unit.json", loops(SQUARE, units="furlong"), "units is 'furlong'")
refused("unit-list.json", loops(SQUARE, units=["mm"]), "units is ['mm']")
refused("one-point.json", loops([[1, 1]]), "has fewer than 3 corners near")
refused("same-points.json", loops([[1, 1]] * 9), "has fewer than 3 corners near")
refused("on-a-line.json", loops([[0, 0], [1, 1], [2, 2]]), "its points lie on one line")
refused("overflowing.json", loops([[0, 0], [1e300, 0], [0, 1e300]]), "1e+300")
refused("far.json", loops([[1e12, 0], [1e12 + 1, 0], [1e12, 1]]), "1e+12")
taken("star-of-touching-corners.json", loops(*([[0, 0], [9, n], [9, n + 0.5]] for n in range(3))))
ZIGZAG = [[0, 0], [30, 40], [60, 0], [90, 40]]
taken("zigzag.json", json.dumps({"lines": [ZIGZAG]}))
taken("square-with-a-slit.json", loops(SQUARE, lines=[[[10, 10], [30, 20]]]))
refused("lines-of-one-point.json", json.dumps({"lines": [[[1, 1]]]}), "draw at least one line")
refused("lines-without-length.json", json.dumps({"lines": [[[1, 1], [1, 1]]]}), "draw at least one line")
refused("lines-not-finite.json", '{"lines": [[[0, 0], [1e999, 0]]]}', "finite coordinates")
refused("no-lines.json", json.dumps({"lines": []}), "lines is not a list with at least one line")

# --- WKT ------------------------------------------------------------------------------------------------------------
taken("box.wkt", f"POLYGON ({WKT_SQUARE})")
taken("z.wkt", "POLYGON Z ((0 0 1, 40 0 2, 0 40 3, 0 0 1))", "the z coordinates were ignored")
taken("lower-case.wkt", f"polygon({WKT_SQUARE})")
taken("collection.wkt", f"GEOMETRYCOLLECTION (POLYGON ({WKT_SQUARE}))")
taken("same-polygons.wkt", f"MULTIPOLYGON (({WKT_SQUARE}), ({WKT_SQUARE}))", "dropped loop 2: it repeats loop 1")
taken("spike.wkt", "POLYGON ((0 0, 40 0, 40 20, 80 20, 40 20, 40 40, 0 40, 0 0))", "by the even-odd rule")
taken("open.wkt", "POLYGON ((0 0, 40 0, 40 40))", "closed rings that did not repeat the first point")
taken("a-gap.wkt", "POLYGON ((0 0, 40 0, 40 40, 0.003 0))", GAP)
taken("closed-line.wkt", "LINESTRING (0 0, 40 0, 40 40, 0 0)")
taken("lines.wkt", "MULTILINESTRING ((0 0, 40 0), (40 0.003, 40 40, 0 0), (5 1, 6 1))", STRAY)
taken("line-beside.wkt", f"GEOMETRYCOLLECTION (POLYGON ({WKT_SQUARE}), LINESTRING (0 0, 1 1))", "1 line")
refused("cut-off.wkt", "POLYGON ((0 0, 40", "not WKT: ")
refused("empty-polygon.wkt", "POLYGON EMPTY", "POLYGON is empty")
refused("empty-collection.wkt", "GEOMETRYCOLLECTION EMPTY", "GEOMETRYCOLLECTION is empty")
refused("point.wkt", "POINT (1 1)", "POINT bounds no area")
refused("line.wkt", "LINESTRING (0 0, 1 1)", "a line ends at (0, 0), 1.41 from the next end")
taken("point-within.wkt", f"GEOMETRYCOLLECTION (POLYGON ({WKT_SQUARE}), POINT (1 1))", "1 point")
refused("curves-in-it.wkt", "GEOMETRYCOLLECTION (CIRCULARSTRING (0 0, 1 1, 2 0))", "has curves, which are not read")
refused(
    "curves-beside.wkt",
    "GEOMETRYCOLLECTION (POLYGON ((0 0, 9 0, 9 9, 0 0)), CURVEPOLYGON ((0 0, 9 0, 9 9, 0 0)))",
    "GEOMETRYCOLLECTION has curves",
)
refused(
    "curves-deep.wkb",
    bytes.fromhex(
        "010700000001000000" * 2
        + "010a00000001000000010200000004000000"
        + "00000000000000000000000000000000"
        + "00000000000022400000000000000000"
        + "00000000000022400000000000002240"
        + "00000000000000000000000000000000"
    ),
    "has curves, which are not read",
)
refused("curve.wkt", "CURVEPOLYGON (CIRCULARSTRING (0 0, 4 0, 4 4, 0 4, 0 0))", "not WKT: ")
refused("brackets.wkt", "(" * 100_000, TOO_DEEP)
refused("collections.wkt", "GEOMETRYCOLLECTION (" * 100 + "POINT (1 1)" + ")" * 100, TOO_DEEP)
refused("nan.wkt", "POLYGON ((nan 0, 1 0, 0 1, nan 0))", "not WKT: ")
refused("infinite.wkt", "POLYGON ((1e999 0, 1 0, 0 1, 1e999 0))", "inf")
refused("flat.wkt", "POLYGON ((0 0, 1 1, 2 2, 0 0))", "its points lie on one line")

# --- FOLD, by `foldcut check` ----------------------------------------------------------------------------------------
FOLD: dict[str, Any] = {
    "vertices_coords": [[0, 0], [1, 0], [1, 1], [0, 1]],
    "edges_vertices": [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2]],
    "edges_assignment": ["B", "B", "B", "B", "M"],
}


def fold(**changed: Any) -> str:
    return json.dumps(FOLD | changed)


WHOLE = {"faces_vertices": [[0, 1, 2], [0, 2, 3]], "faceOrders": [[0, 1, -1]]}
taken("diagonal.fold", fold(**WHOLE))
taken("file-path.fold", fold(**WHOLE, file_title="/etc/passwd", file_author="../.."))
taken("no-layers.fold", fold())
refused("list.fold", "[]", "holds one JSON object, not a list")
refused("no-keys.fold", "{}", "vertices_coords: missing")
refused("deep.fold", "[" * 100_000, "not JSON")
refused("no-vertices.fold", fold(vertices_coords=[]), "edges_vertices[0][0]: 0 is not a number")
refused(
    "vertex-nan.fold", fold(vertices_coords=[[float("nan"), 0], [1, 0], [1, 1], [0, 1]]), "NaN is not a JSON number"
)
refused("vertex-text.fold", fold(vertices_coords=["a", "b", "c", "d"]), "vertices_coords")
refused("vertex-raised.fold", fold(vertices_coords=[[0, 0, 1], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), "vertices_coords")
refused(
    "vertex-large.fold",
    fold(vertices_coords=[[0, 0], [1e308, 0], [1e308, 1e308], [0, 1e308]]),
    "1e+308 is not a number below 1e15",
)
refused("edge-to-nowhere.fold", fold(edges_vertices=[[0, 1], [1, 2], [2, 3], [3, 0], [0, 9]]), "edges_vertices")
refused("edge-negative.fold", fold(edges_vertices=[[0, 1], [1, 2], [2, 3], [3, 0], [0, -1]]), "edges_vertices")
refused(
    "edge-to-itself.fold", fold(edges_vertices=[[0, 1], [1, 2], [2, 3], [3, 0], [2, 2]]), "edge 4 is only 0 mm long"
)
refused("edge-huge.fold", fold(edges_vertices=[[0, 1], [1, 2], [2, 3], [3, 0], [0, 10**30]]), "edges_vertices")
refused("assignment-short.fold", fold(edges_assignment=["B"]), "edges_assignment")
refused("assignment-unknown.fold", fold(edges_assignment=["B", "B", "B", "B", "Q"]), "edges_assignment")
refused("assignment-list.fold", fold(edges_assignment=[["B"]] * 5), "edges_assignment")
refused("unit.fold", fold(frame_unit="parsec"), "frame_unit")
refused("faces-nowhere.fold", fold(faces_vertices=[[0, 1, 2], [0, 2, 99]]), "faces_vertices")
refused("orders-nowhere.fold", fold(faces_vertices=[[0, 1, 2], [0, 2, 3]], faceOrders=[[0, 7, 1]]), "faceOrders")

# Other formats: DXF, GeoJSON, WKB, CSV, PDF and pictures.
taken("box.csv", "0,0\n40,0\n40,40\n0,40\n")
refused("words.csv", "a,b\nc,d\n", "")
refused("one-column.csv", "1\n2\n3\n", "")
refused("empty.csv", " \n", "the file is empty")
taken("box.geojson", '{"type":"Polygon","coordinates":[[[0,0],[40,0],[40,40],[0,40],[0,0]]]}')
refused("point.geojson", '{"type":"Point","coordinates":[0,0]}', "")
refused("cut-off.geojson", '{"type":"Polygon","coordinates":[[[0,0],', "")
refused("deep.geojson", '{"type":"GeometryCollection","geometries":[' * 20_000, TOO_DEEP)
taken("a-gap.csv", "0,0\n40,0\n40,40\n0,40\n0,0.003\n", GAP)
taken("open.geojson", '{"type":"Polygon","coordinates":[[[0,0],[40,0],[40,40],[0,40]]]}', "closed 1 ring that did not")
taken("a-gap.geojson", '{"type":"Polygon","coordinates":[[[0,0],[40,0],[40,40],[0,0.003]]]}', GAP)
taken("closed-line.geojson", '{"type":"LineString","coordinates":[[0,0],[40,0],[40,40],[0,0]]}')
taken("lines.geojson", '{"type":"MultiLineString","coordinates":[[[0,0],[40,0],[40,40],[0,0]],[[5,1],[6,1]]]}', STRAY)
refused("open-line.geojson", '{"type":"LineString","coordinates":[[0,0],[40,0],[40,40]]}', "a line ends at (0, 0)")
for kind in ("07000000", "ef030000", "07000020ffff0000", "04000000"):
    refused(f"collections-{kind}.wkb", f"01{kind}01000000" * 50_000 + "0101000000" + "00" * 16, TOO_DEEP)
refused("cut-off-collections.wkb", "010700000001000000" * 50_000, "not WKB: its bytes are not a geometry")
refused("rubbish.wkb", "\x01\x03rubbish", "")
refused("empty.dxf", " ", "the file is empty")
refused("words.dxf", "this is no drawing\n" * 50, "")
refused("cut-off.dxf", "0\nSECTION\n2\nENTITIES\n0\nLWPOLYLINE\n90\n", "")
refused("words.pdf", "%PDF-1.4 and no more", "")
refused("words.png", "\x89PNG and no more", "")
refused("words.jpg", "no picture", "")


def dxf(*lines: tuple[float, float, float, float], blocks: int = 0) -> str:
    """Return a DXF with lines, and if there are blocks, with the lines in the last of blocks in blocks."""
    drawn = [f"LINE,8,0,10,{x},20,{y},11,{to_x},21,{to_y}" for x, y, to_x, to_y in lines]
    parts = [f"INSERT,8,0,2,B{n},10,0,20,0" for n in range(blocks)]
    around = [
        f"BLOCK,8,0,2,B{n},70,0,10,0,20,0,0,{part},0,ENDBLK"
        for n, part in enumerate([*parts[1:], ",0,".join(drawn)] if blocks else [])
    ]
    text = [
        "SECTION,2,BLOCKS", *around, "ENDSEC", "SECTION,2,ENTITIES", *(parts[:1] if blocks else drawn), "ENDSEC", "EOF"
    ]  # fmt: skip
    return "0\n" + "\n0\n".join(text).replace(",", "\n") + "\n"


SIDES = ((0, 0, 40, 0), (40, 0, 40, 40), (40, 40, 0, 40), (0, 40, 0, 0))
taken("box.dxf", dxf(*SIDES))
taken("blocks.dxf", dxf(*SIDES, blocks=50))
refused("deep-blocks.dxf", dxf(*SIDES, blocks=1_000), TOO_DEEP)
taken("a-gap.dxf", dxf((0, 0, 40, 0.003), *SIDES[1:]), GAP)
taken("a-stray-line.dxf", dxf(*SIDES, (5, 5, 6, 6)), STRAY)
taken("drawn-twice.dxf", dxf(*SIDES, SIDES[2], SIDES[0][2:] + SIDES[0][:2]), "left out 2 lines drawn twice")
taken("a-dot.dxf", dxf(*SIDES, (5, 5, 5, 5)), "left out 1 outline without area")
refused("open.dxf", dxf(*SIDES[:3]), "a line ends at (0, 0), 40 from the next end; close the outline, or join")
