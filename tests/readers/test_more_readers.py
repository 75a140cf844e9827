"""Drawings read from DXF, GeoJSON, WKB and CSV, and from standard input; what is refused in each."""

from __future__ import annotations

import io
import json
import math
import struct
import subprocess
import sys
from collections.abc import Callable
from functools import reduce
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import shapely

from foldcut import fold
from foldcut.core.errors import FileFormatError
from foldcut.drawing.limits import Limits
from foldcut.drawing.shape import make_shape
from foldcut.readers import READERS, Drawing, ReadOptions, read_shape

SQUARE = [(0.0, 0.0), (20.0, 0.0), (20.0, 10.0), (0.0, 10.0)]


def area(drawing: Drawing) -> float:
    polygons = [shapely.Polygon(loop) for loop in drawing.loops]
    return float(reduce(shapely.symmetric_difference, polygons).area)


def read(folder: Path, name: str, data: str | bytes, **options: Any) -> Drawing:
    path = folder / name
    path.write_bytes(data.encode() if isinstance(data, str) else data)
    return read_shape(path, ReadOptions(**options))


# --- DXF


def dxf(draw: Callable[[Any], object], units: int = 4, version: str = "R2010") -> str:
    document = ezdxf.new(version, units=units)
    draw(document.modelspace())
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue()


def four_lines(space: Any, gap: float = 0.0) -> None:
    for one, other in zip(SQUARE, SQUARE[1:] + SQUARE[:1], strict=True):
        space.add_line((one[0] + gap, one[1]), other)


def insert(space: Any) -> None:
    block = space.doc.blocks.new("B")
    block.add_lwpolyline([(x / 2, y / 2) for x, y in SQUARE], close=True)
    outer = space.doc.blocks.new("C")
    outer.add_blockref("B", (0, 0), dxfattribs={"xscale": 2, "yscale": 2})
    space.add_blockref("C", (5, 5), dxfattribs={"rotation": 90})


def hatch(space: Any) -> None:
    paths = space.add_hatch().paths
    paths.add_polyline_path(SQUARE, is_closed=True)
    paths.add_polyline_path([(5, 5), (6, 5), (6, 6)], is_closed=True)


@pytest.mark.parametrize(
    ("draw", "expected"),
    [
        (lambda space: space.add_lwpolyline(SQUARE, close=True), 200),
        (lambda space: space.add_lwpolyline([*SQUARE, SQUARE[0]]), 200),
        (lambda space: space.add_polyline2d(SQUARE, close=True), 200),
        (lambda space: space.add_polyline3d([(*point, 0) for point in SQUARE], close=True), 200),
        (lambda space: space.add_lwpolyline([(0, 0, 1), (10, 0, 1)], format="xyb", close=True), math.pi * 25),
        (four_lines, 200),
        (lambda space: four_lines(space, 0.001), 200),
        (lambda space: space.add_circle((3, 3), 10), math.pi * 100),
        (lambda space: space.add_ellipse((3, 3), (10, 0), 0.5), math.pi * 50),
        (lambda space: (space.add_arc((0, 0), 10, 0, 180), space.add_line((-10, 0), (10, 0))), math.pi * 50),
        (lambda space: space.add_spline([(0, 0), (10, 0), (10, 10), (0, 10), (0, 0)]), None),
        (insert, 200),
        (hatch, 199.5),
        (lambda space: (space.add_circle((0, 0), 10), space.add_circle((0, 0), 5)), math.pi * 75),
        (lambda space: (space.add_lwpolyline(SQUARE, close=True), hatch(space)), 200),
        (lambda space: [space.add_lwpolyline([(x + d, y) for x, y in SQUARE], close=True) for d in (0, 10)], 300),
    ],
)
def test_every_outline_of_a_dxf_is_read(tmp_path: Path, draw: Callable[[Any], object], expected: float) -> None:
    text = dxf(draw)
    drawing = read(tmp_path, "a.dxf", text)
    make_shape(drawing.loops)
    assert drawing.unit_mm == 1.0
    if expected is not None:
        assert area(drawing) == pytest.approx(expected, abs=1)


def test_an_old_dxf_has_no_unit(tmp_path: Path) -> None:
    drawing = read(tmp_path, "a.dxf", dxf(lambda space: space.add_polyline2d(SQUARE, close=True), version="R12"))
    assert (area(drawing), drawing.unit_mm) == (200, None)


@pytest.mark.parametrize(("units", "unit_mm"), [(0, None), (1, 25.4), (4, 1), (5, 10), (6, 1000)])
def test_the_unit_of_a_dxf_is_honoured(tmp_path: Path, units: int, unit_mm: float | None) -> None:
    drawing = read(tmp_path, "a.dxf", dxf(four_lines, units))
    assert drawing.unit_mm == (None if unit_mm is None else pytest.approx(unit_mm))
    assert drawing.size == pytest.approx((20, 10))


def test_layers_of_a_dxf_select_and_hidden_ones_are_told(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.doc.layers.add("OFF").off()
        space.doc.layers.add("FROZEN").freeze()
        space.add_circle((0, 0), 3, dxfattribs={"layer": "OFF"})
        space.add_circle((0, 0), 3, dxfattribs={"layer": "FROZEN"})
        space.add_text("hello")
        space.add_lwpolyline(SQUARE, close=True, dxfattribs={"layer": "CUT"})
        space.add_line((1, 1), (2, 2), dxfattribs={"layer": "Notes"})

    drawing = read(tmp_path, "a.dxf", dxf(draw), layers=("cut",))
    assert (area(drawing), drawing.ignored) == (200, ("2 hidden objects",))
    assert drawing.repairs == ()
    with pytest.raises(FileFormatError, match="a line ends at .1, 1., .* join ends that are farther apart with --join"):
        read(tmp_path, "a.dxf", dxf(draw), layers=("Notes",))
    stray = read(tmp_path, "a.dxf", dxf(draw))
    assert area(stray) == 200
    left_out = "left out a line that ends where no other continues, at (1, 1), 1.41 from the next end"
    assert stray.repairs == (f"{left_out} (cut along open lines, too, with --open)",)
    with pytest.raises(FileFormatError, match="no outline in --layer x; the file has the layers 0, CUT, Notes"):
        read(tmp_path, "a.dxf", dxf(draw), layers=("x",))
    assert "1 TEXT" in read(tmp_path, "a.dxf", dxf(draw), layers=("CUT", "0")).ignored


def test_a_dxf_with_a_gap_is_joined_on_request(tmp_path: Path) -> None:
    text = dxf(lambda space: four_lines(space, 0.5))
    with pytest.raises(FileFormatError, match="0.5 from the next end"):
        read(tmp_path, "a.dxf", text)
    assert area(read(tmp_path, "a.dxf", text, join_mm=6)) == pytest.approx(200, abs=15)


def test_a_block_bomb_is_refused(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        for level in range(7):
            block = space.doc.blocks.new(f"L{level}")
            for _ in range(10):
                block.add_blockref(f"L{level + 1}", (0, 0))
        space.doc.blocks.new("L7").add_circle((0, 0), 1)
        space.add_blockref("L0", (0, 0))

    with pytest.raises(FileFormatError, match="more than 100,000 entities|nested"):
        read(tmp_path, "a.dxf", dxf(draw))


# --- GeoJSON, WKB, CSV

RING = [[0, 0], [20, 0], [20, 10], [0, 10], [0, 0]]
HOLE = [[5, 5], [6, 5], [6, 6], [5, 5]]
POLYGON = {"type": "Polygon", "coordinates": [RING, HOLE]}


@pytest.mark.parametrize(
    "document",
    [
        POLYGON,
        {"type": "MultiPolygon", "coordinates": [[RING, HOLE]]},
        {"type": "Feature", "properties": None, "geometry": POLYGON},
        {"type": "FeatureCollection", "features": [{"type": "Feature", "geometry": POLYGON}]},
        {"type": "GeometryCollection", "geometries": [{"type": "Point", "coordinates": [1, 2]}, POLYGON]},
    ],
)
@pytest.mark.parametrize("suffix", [".geojson", ".json"])
def test_polygons_of_a_geojson_file_are_loops(tmp_path: Path, document: dict[str, Any], suffix: str) -> None:
    drawing = read(tmp_path, f"a{suffix}", json.dumps(document))
    assert [loop.tolist() for loop in drawing.loops] == [RING, HOLE]
    assert drawing.ignored == (("1 point",) if "geometries" in document else ())


@pytest.mark.parametrize("form", ["binary", "hex", "big-endian", "z"])
def test_wkb_gives_what_wkt_gives(tmp_path: Path, form: str) -> None:
    shape = shapely.Polygon(RING, [HOLE])
    data = {
        "binary": shapely.to_wkb(shape),
        "hex": shapely.to_wkb(shape, hex=True) + "\n",
        "big-endian": shapely.to_wkb(shape, byte_order=0, include_srid=True),
        "z": shapely.to_wkb(shapely.force_3d(shape)),
    }[form]
    drawing = read(tmp_path, "a.wkb", data)
    assert [loop.tolist() for loop in drawing.loops] == [RING, HOLE]
    assert len(drawing.notes) == (form == "z")


@pytest.mark.parametrize(
    "text",
    [
        "0,0\n20,0\n20,10\n0,10\n\n5,5\n6,5\n6,6\n",
        "\ufeffx;y\r\n0;0\r\n20;0\r\n20;10\r\n0;10\r\n;\r\n5;5\r\n6;5\r\n6;6\r\n",
        "# a comment\na 0 0\na 20 0\na 20 10\na 0 10\nb 5 5\nb 6 5\nb 6 6\n",
        "Y\tX\tLoop\n0\t0\t1\n0\t20\t1\n10\t20\t1\n10\t0\t1\n5\t5\t2\n5\t6\t2\n6\t6\t2\n",
        '"0","0"\n"20","0"\n"20","10"\n"0","10"\n\n\n\n"5","5"\n"6","5"\n"6","6"',
    ],
)
def test_points_of_a_csv_file_are_loops(tmp_path: Path, text: str) -> None:
    drawing = read(tmp_path, "a.csv", text)
    assert [loop.tolist() for loop in drawing.loops] == [RING[:-1], HOLE[:-1]]


DEEP = {"type": "GeometryCollection", "geometries": [POLYGON]}
for _ in range(100):
    DEEP = {"type": "GeometryCollection", "geometries": [DEEP]}

POINT = shapely.to_wkb(shapely.Point(1, 2))

BAD = [
    ("a.dxf", "hello", "not a DXF file that can be read"),
    ("a.dxf", b"\x00\xff" * 1000, "not a DXF file that can be read"),
    ("a.dxf", dxf(lambda space: None), "there is no outline; the file has the layers none"),
    ("a.dxf", dxf(lambda space: space.add_text("A")), "there is no outline"),
    ("a.geojson", "{", "not JSON"),
    ("a.geojson", "[]", "the file is not GeoJSON"),
    ("a.geojson", '{"type": "Circle"}', "the file is not GeoJSON: its type is 'Circle'"),
    ("a.geojson", '{"type": ["Polygon"]}', "the file is not GeoJSON"),
    ("a.geojson", '{"type": "Polygon"}', "coordinates of the file is not a list"),
    ("a.geojson", '{"type": "Polygon", "coordinates": [[[0, 0], [1, "a"]]]}', 'point 1 is [1, "a"]'),
    ("a.geojson", '{"type": "Point", "coordinates": [0, 0]}', "the file has no polygon"),
    ("a.geojson", '{"type": "FeatureCollection", "features": []}', "features of the file is not a list"),
    ("a.geojson", json.dumps(DEEP), "nested too deep, and at most 100 are allowed"),
    ("a.geojson", '{"type": "Polygon", "coordinates": [[[0, 0], [1' + "0" * 400 + ", 0]]]}", "too large for float64"),
    ("a.wkb", b"\x01\x02", "not WKB"),
    ("a.wkb", "zz", "not WKB"),
    ("a.wkb", "0101", "not WKB"),
    ("a.wkb", (b"\x01\xef\x03\0\0\x01\0\0\0" * 100_000 + POINT), "nested too deep"),
    ("a.wkb", (b"\0\0\0\0\x05\0\0\0\x01" * 100_000 + POINT), "nested too deep"),
    ("a.wkb", POINT, "POINT bounds no area"),
    ("a.wkb", (b"\x01\x07\0\0\0\x01\0\0\0" * 100_000 + POINT), "nested too deep"),
    ("a.wkb", b"\x01\x03\0\0\0" + struct.pack("<II", 1, 2**31), "not WKB"),
    ("a.csv", "a,b\n", "line 1 is 'a,b'"),
    ("a.csv", "0,0\n1\n", "line 2 is '1'"),
    ("a.csv", "0,0\n1,2,3\n", "line 2 has 3 columns, not 2"),
    ("a.csv", "x,y\n", "the file has no points"),
]


@pytest.mark.parametrize(("name", "data", "fragment"), BAD, ids=lambda value: str(value)[:40])
def test_a_bad_file_is_refused_in_one_line(tmp_path: Path, name: str, data: str | bytes, fragment: str) -> None:
    with pytest.raises(FileFormatError) as caught:
        read(tmp_path, name, data)
    message = str(caught.value)
    assert fragment in message
    assert ";" in message, "no remedy"
    assert len(message) < 400 + len(str(tmp_path))


@pytest.mark.parametrize("suffix", READERS)
def test_no_bytes_get_anything_but_a_format_error_out_of_a_reader(tmp_path: Path, suffix: str) -> None:
    random = np.random.default_rng(7)
    good = {
        ".dxf": dxf(hatch).encode(),
        ".geojson": json.dumps(POLYGON).encode(),
        ".wkb": shapely.to_wkb(shapely.Polygon(RING, [HOLE])),
        ".csv": b"0,0\n1,0\n\n1,1\n",
        ".wkt": b"POLYGON ((0 0, 4 0, 0 -3, 0 0))",
        ".json": b'{"loops": [[[0, 0], [1, 0], [0, 1]]]}',
        ".svg": b'<svg viewBox="0 0 9 9"><path d="M0 0A3 4 0 0 1 5 5C1 2 3 4 5 6z"/><use href="#a" x="3"/></svg>',
    }.get(suffix, b"")
    for number in range(60):
        data = bytearray(good or random.bytes(100))
        for place in random.integers(0, len(data), size=1 + number % 5).tolist():
            data[place] = random.integers(256)
        try:
            read(tmp_path, f"a{suffix}", bytes(data[: random.integers(1, len(data) + 1)] if number % 3 == 0 else data))
        except FileFormatError as error:
            assert len(str(error).splitlines()) == 1


def test_a_mended_dxf_says_nothing_on_standard_error(tmp_path: Path) -> None:
    path = tmp_path / "a.dxf"
    path.write_bytes(dxf(hatch).encode().replace(b"297.0", b"297D0\xf2", 1))
    command = [
        sys.executable,
        "-c",
        "import sys; from foldcut.readers import read_shape; read_shape(sys.argv[1])",
        path,
    ]
    assert subprocess.run(command, capture_output=True, check=True, text=True).stderr == ""


def test_a_file_may_be_called_anything_and_come_from_standard_input(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert area(read(tmp_path, "a.txt", "0,0\n20,0\n20,10\n0,10", suffix="csv")) == 200
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(b"0,0\n20,0\n20,10\n0,10")))
    drawing = read_shape("-", ReadOptions(suffix=".CSV"))
    assert (area(drawing), drawing.title) == (200, "drawing")
    with pytest.raises(FileFormatError, match=r"^-: standard input has no suffix; give the format with --from"):
        read_shape("-")
    with pytest.raises(FileFormatError, match=r"there is no format 'doc'; give --from one of \.svg"):
        read_shape("-", ReadOptions(suffix="doc"))


def test_sizes_are_bounded(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match="the file has 19 bytes, and at most 10 are allowed"):
        read(tmp_path, "a.csv", "0,0\n20,0\n20,10\n0,10", limits=Limits(bytes=10))
    with pytest.raises(FileFormatError, match="about 4 points, and at most 3 are allowed"):
        read(tmp_path, "a.csv", "0,0\n20,0\n20,10\n0,10", limits=Limits(points=3))


def test_the_same_drawing_gives_the_same_pattern_through_every_format(tmp_path: Path) -> None:
    points = [(0.1, 0.2), (33.3, 3.7), (41.25, 30.5), (17.3, 22.9), (3.3, 38.125)]
    ring = [*points, points[0]]
    pairs = [f"{x!r} {y!r}" for x, y in ring]
    flipped = " ".join(f"{x!r},{-y!r}" for x, y in points)
    files: dict[str, str | bytes] = {
        ".svg": f'<svg width="50mm" height="50mm" viewBox="0 0 50 50"><polygon points="{flipped}"/></svg>',
        ".dxf": dxf(lambda space: space.add_lwpolyline(points, close=True)),
        ".geojson": json.dumps({"type": "Polygon", "coordinates": [ring]}),
        ".wkt": f"POLYGON (({', '.join(pairs)}))",
        ".wkb": shapely.to_wkb(shapely.Polygon(ring)),
        ".csv": "\n".join(f"{x!r},{y!r}" for x, y in points),
        ".json": json.dumps({"loops": [points]}),
    }
    patterns = {}
    for suffix, data in files.items():
        drawing = read(tmp_path, f"a{suffix}", data)
        result = fold(drawing, "a5", effort="fast")
        assert result.verified
        patterns[suffix] = result.folded_pattern.creases
    for creases in patterns.values():
        np.testing.assert_allclose(creases.vertices_coords, patterns[".svg"].vertices_coords, rtol=0, atol=1e-9)
        np.testing.assert_array_equal(creases.edges_vertices, patterns[".svg"].edges_vertices)
        np.testing.assert_array_equal(creases.edges_assignment, patterns[".svg"].edges_assignment)
