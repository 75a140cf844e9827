"""Exporters: the bytes of the files, the convention of faceOrders, and dashes as geometry."""

from __future__ import annotations

import dataclasses
import io
import itertools
import json
import re
import time
import tracemalloc
import xml.etree.ElementTree as ET
from functools import cache
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest
import shapely
import svgelements
from numpy.testing import assert_allclose
from PIL import Image
from support.folded import folded_sample
from support.patterns import book_fold, build_pattern, letter_fold, notched_sheet, square_out_of_square
from support.places import TESTS
from support.samples import TESTED

from foldcut.core.arrays import Floats
from foldcut.core.errors import BadInputError, FileFormatError
from foldcut.core.model import FoldedPattern
from foldcut.exporters import PATTERN_EXPORTERS, check_suffix, export
from foldcut.exporters.pattern.fold import export as fold_export
from foldcut.exporters.pattern.fold import face_orders, overlapping_faces
from foldcut.pipeline import fold
from foldcut.profiles import load_profile
from foldcut.samples import sample_path

# triangles are up to manifold3d, pixels to the fonts that are there, and a page to its template
GOLDEN_KINDS = sorted(PATTERN_EXPORTERS.keys() - {".stl", ".3mf", ".step", ".png", ".html"})
GOLDEN = TESTS / "golden"
SVG = "{http://www.w3.org/2000/svg}"
INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
PLAIN = load_profile().drawing


def same_as_golden(data: bytes, name: str) -> bool:
    """Compare with a golden file, in which the version is written as VERSION."""
    creator = f'"foldcut {version("foldcut")}"'.encode()
    return data.replace(creator, b'"foldcut VERSION"') == (GOLDEN / name).read_bytes()


@pytest.mark.parametrize("suffix", GOLDEN_KINDS)
def test_bytes_are_those_of_the_golden_file(suffix: str) -> None:
    assert same_as_golden(export(book_fold(), suffix), f"book{suffix}")


@pytest.mark.parametrize("suffix", GOLDEN_KINDS)
def test_golden_comparison_sees_a_flipped_crease_and_a_moved_vertex(suffix: str) -> None:
    pattern = book_fold()
    coords = np.array(pattern.creases.vertices_coords)
    coords[4, 0] += 0.001
    moved = dataclasses.replace(pattern, creases=dataclasses.replace(pattern.creases, vertices_coords=coords))
    assert not same_as_golden(export(book_fold("M"), suffix), f"book{suffix}")
    assert not same_as_golden(export(moved, suffix), f"book{suffix}")


@pytest.mark.parametrize("suffix", GOLDEN_KINDS)
def test_the_same_pattern_gives_the_same_bytes(suffix: str) -> None:
    assert export(letter_fold(), suffix) == export(letter_fold(), suffix)


def test_a_picture_has_the_drawings_size_and_says_its_resolution() -> None:
    pattern = square_out_of_square()
    picture = Image.open(io.BytesIO(export(pattern, ".png")))
    assert picture.info["dpi"] == pytest.approx((200, 200), abs=0.1)
    expected = np.array([pattern.sheet.width, pattern.sheet.height]) / 25.4 * 200
    assert np.abs(np.array(picture.size) - expected).max() <= 1
    pixels = np.asarray(picture.convert("RGB")).reshape(-1, 3).astype(int)
    assert (pixels == 255).all(axis=1).any(), "the background is white"
    for red, blue in ((1, 0), (0, 1)):
        coloured = (pixels[:, 0] > 150) == red, (pixels[:, 2] > 150) == blue, pixels[:, 1] < 100
        assert np.logical_and.reduce(coloured).any(), "mountains are red, valleys blue"


def test_a_picture_has_the_words_of_the_legend() -> None:
    def ink(title: str) -> int:
        pattern = dataclasses.replace(square_out_of_square(), title=title)
        pixels = np.asarray(Image.open(io.BytesIO(export(pattern, ".png"))).convert("L"))
        return int((pixels < 200).sum())

    assert ink("WWWWWWWW") > ink("W") > ink("")


@pytest.mark.parametrize(("suffix", "most"), [(".fold", 6), (".svg", 8), (".opx", 6)])
def test_a_file_of_many_creases_takes_a_few_times_its_size_in_memory(suffix: str, most: float) -> None:
    # measured 3 to 7 times; with an object for each number or element 9 to 45 times
    pattern = many_creases()
    export(letter_fold(), suffix)
    tracemalloc.start()
    data = export(pattern, suffix)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < most * len(data) + 2e6 * (suffix == ".svg"), "a legend takes the same for any pattern"


@cache
def many_creases() -> FoldedPattern:
    """Return a sheet of 4,000 narrow strips, folded to and fro."""
    strips = 4_000
    x = np.arange(strips + 1) / 7
    flat = np.stack([np.column_stack([x, 0 * x]), np.column_stack([x, 0 * x + 2])], axis=1).reshape(-1, 2)
    folded = np.column_stack([np.arange(len(flat)) // 2 % 2 / 7, flat[:, 1]])
    rows = 2 * np.arange(strips)
    edges = [(0, 1, "B"), *((a, a + 2, "B") for low in rows.tolist() for a in (low, low + 1))]
    edges += [(a, a + 1, "MV"[a // 2 % 2]) for a in rows[1:].tolist()] + [(2 * strips, 2 * strips + 1, "B")]
    faces = [(a, a + 2, a + 3, a + 1) for a in rows.tolist()]
    loop = [(20, 0.5), (40, 0.5), (40, 1.5), (20, 1.5)]
    return build_pattern(flat.tolist(), folded.tolist(), edges, faces, range(strips), loop)


def test_an_unknown_ending_is_an_error_that_lists_the_known_ones() -> None:
    with pytest.raises(FileFormatError, match=r"\.xyz files; use one of \.fold, \.svg, \.cp, \.opx, \.png, \.html"):
        check_suffix(".xyz")
    with pytest.raises(FileFormatError, match="needs an ending"):
        check_suffix("")
    with pytest.raises(FileFormatError, match="--profile"):
        check_suffix(".dxf")
    check_suffix(".SVG")


# FOLD


def read(pattern: FoldedPattern) -> dict[str, object]:
    """Export to FOLD and parse what came out."""
    fold: dict[str, object] = json.loads(export(pattern, ".fold"))
    return fold


def test_fold_coordinates_keep_every_bit() -> None:
    third, awkward = 1 / 3, np.nextafter(60.0, 61.0)
    pattern = build_pattern(
        flat=[(0, 0), (100, 0), (100 * third, awkward)],
        folded=[(0.1, 0.2), (100.1, 0.2), (1e-17, 2 / 3)],
        edges=[(0, 1, "B"), (1, 2, "B"), (2, 0, "B")],
        faces=[(0, 1, 2)],
        layers=[0],
    )
    fold = read(pattern)
    assert fold["vertices_coords"] == pattern.creases.vertices_coords.tolist()
    assert fold["file_frames"][0]["vertices_coords"] == pattern.folded.vertices_coords.tolist()


def test_fold_angles_follow_the_assignment() -> None:
    assert read(book_fold("V"))["edges_foldAngle"][-1] == 180
    assert read(book_fold("M"))["edges_foldAngle"][-1] == -180
    assert read(book_fold())["edges_foldAngle"][:-1] == [0] * 6


def test_fold_refuses_numbers_that_json_has_not() -> None:
    pattern = book_fold()
    coords = np.full_like(pattern.folded.vertices_coords, np.nan)
    broken = dataclasses.replace(pattern, folded=dataclasses.replace(pattern.folded, vertices_coords=coords))
    with pytest.raises(ValueError, match="JSON"):
        fold_export(broken, load_profile())
    with pytest.raises(BadInputError, match="not at a finite place"):
        export(broken, ".fold")


def test_both_faces_of_a_valley_lie_on_the_side_of_the_others_normal() -> None:
    # Faces touch front to front in a valley, back to back in a mountain, whichever is above.
    assert read(book_fold("V"))["faceOrders"] == [[0, 1, 1]]
    assert read(book_fold("M"))["faceOrders"] == [[0, 1, -1]]


def test_face_orders_follow_the_normal_of_the_second_face() -> None:
    # Bottom to top: 0 with its normal up, then 1 and 2 with theirs down. 1 lies where the normal of 2 points.
    orders = {(f, g): s for f, g, s in read(letter_fold())["faceOrders"]}
    assert orders == {(0, 1): 1, (0, 2): 1, (1, 2): 1}
    # Now 1 lies above 2, behind the normal of 2.
    swapped = dataclasses.replace(
        letter_fold(),
        folded=dataclasses.replace(letter_fold().folded, layers=np.array([0, 2, 1], dtype=np.int32)),
    )
    assert {(f, g): s for f, g, s in read(swapped)["faceOrders"]} == {(0, 1): 1, (0, 2): 1, (1, 2): -1}


def test_turning_the_folded_state_over_changes_no_face_order() -> None:
    pattern = letter_fold()
    mirrored = pattern.folded.vertices_coords * [-1, 1]
    turned = dataclasses.replace(pattern, folded=dataclasses.replace(pattern.folded, vertices_coords=mirrored))
    assert face_orders(turned)[0].tolist() == face_orders(pattern)[0].tolist()


def test_faces_that_only_touch_have_no_order() -> None:
    assert read(notched_sheet())["faceOrders"] == []


def test_too_many_overlaps_leave_the_neighbours_only() -> None:
    orders, adjacent_only = face_orders(letter_fold(), most=2)
    assert adjacent_only
    assert orders.tolist() == [[0, 1, 1], [0, 2, 1]]
    assert not face_orders(letter_fold(), most=3)[1]


def stack_of_polygons(seed: int, count: int) -> FoldedPattern:
    """Return random polygons, convex and other: no sheet folds so, but overlap is defined all the same."""
    rng = np.random.default_rng(seed)
    points: list[Floats] = []
    faces: list[list[int]] = []
    for face in range(count):
        corners = int(rng.integers(3, 8))
        angles = np.sort(rng.uniform(0, 2 * np.pi, corners))
        radius = rng.uniform(2, 10, corners if face % 2 else 1)
        star = rng.uniform(0, 50, 2) + np.column_stack([np.cos(angles), np.sin(angles)]) * np.reshape(radius, (-1, 1))
        order = 1 if rng.random() < 0.5 else -1
        faces.append([len(points) + at for at in range(corners)][::order])
        points += list(star)
    coords = [(float(x), float(y)) for x, y in points]
    return build_pattern(coords, coords, [(0, 1, "B")], faces, range(count))


@pytest.mark.parametrize("seed", range(4))
def test_overlapping_faces_are_those_that_shapely_finds(seed: int) -> None:
    pattern = stack_of_polygons(seed, 60)
    points = pattern.folded.vertices_coords
    polygons = [shapely.Polygon(points[ring]) for ring in pattern.creases.faces_vertices]
    valid = [face for face, polygon in enumerate(polygons) if polygon.is_valid]
    assert len(valid) > 30
    expected = {
        (f, g) for f, g in itertools.combinations(valid, 2) if polygons[f].intersection(polygons[g]).area > 1e-9
    }
    found = overlapping_faces(pattern)
    assert found is not None
    assert {(f, g) for f, g in found.tolist() if {f, g} <= set(valid)} == expected


def test_overlaps_do_not_depend_on_how_the_work_is_cut_up(monkeypatch: pytest.MonkeyPatch) -> None:
    pattern = stack_of_polygons(7, 80)
    whole = overlapping_faces(pattern)
    monkeypatch.setattr("foldcut.pattern.overlaps.CHUNK", 7)
    parts = overlapping_faces(pattern)
    assert whole is not None
    assert parts is not None
    assert whole.tolist() == parts.tolist()


@pytest.mark.parametrize("seed", range(4))
def test_faces_at_a_glance_are_never_more_than_there_are(seed: int) -> None:
    pattern = stack_of_polygons(seed, 60)
    found = overlapping_faces(pattern)
    assert found is not None
    again = overlapping_faces(pattern, len(found))
    assert again is not None
    assert again.tolist() == found.tolist()
    assert overlapping_faces(pattern, len(found) - 1) is None


def test_too_many_overlaps_are_seen_without_comparing_faces(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("foldcut.pattern.overlaps.wholly_outside", None)
    assert overlapping_faces(letter_fold(), 2) is None


def test_fold_files_are_what_the_json_module_writes(monkeypatch: pytest.MonkeyPatch) -> None:
    pattern = fold(sample_path("square"), "a4", method="paper", min_crease=0).folded_pattern
    monkeypatch.setattr("foldcut.exporters.pattern.fold.ROWS", 3)
    data = export(pattern, ".fold")
    document = json.loads(data)
    lines = (f"{json.dumps(key)}: {json.dumps(value, separators=(',', ':'))}" for key, value in document.items())
    assert data.decode() == "{\n" + ",\n".join(lines) + "\n}\n"
    creases = pattern.creases
    assert document["vertices_coords"] == creases.vertices_coords.tolist()
    assert document["edges_vertices"] == creases.edges_vertices.tolist()
    assert document["edges_assignment"] == creases.edges_assignment.tolist()
    assert document["faces_vertices"] == creases.faces_vertices.to_lists()
    assert len({len(ring) for ring in document["faces_vertices"]}) > 1


def test_ordering_900_faces_takes_no_noticeable_time() -> None:
    pattern = stack_of_polygons(1, 900)
    start = time.perf_counter()
    face_orders(pattern)
    # Measured 0.05 s; the bound only catches a loop over pairs.
    assert time.perf_counter() - start < 5


# SVG


def layers(data: bytes) -> dict[str, list[str]]:
    """Return the path data of every layer, by label, in the file's order."""
    groups = ET.fromstring(data).findall(f"{SVG}g")
    return {g.attrib[f"{INKSCAPE}label"]: [p.attrib["d"] for p in g.iter(f"{SVG}path")] for g in groups}


def ends(data: str) -> Floats:
    """Return the points of path data, ``(n, 2)``."""
    return np.array([float(number) for number in re.findall(r"-?[\d.]+", data)]).reshape(-1, 2)


def test_svg_is_as_large_as_the_sheet_in_mm() -> None:
    root = ET.fromstring(export(book_fold(), ".svg"))
    assert (root.attrib["width"], root.attrib["height"]) == ("100mm", "60mm")
    assert root.attrib["viewBox"] == "0 0 100 60"


def test_svg_layers_come_in_drawing_order_with_one_path_per_crease() -> None:
    found = layers(export(letter_fold(), ".svg"))
    assert list(found) == ["Shape", "Valley", "Mountain", "Cut", "Legend"]
    assert [len(found[label]) for label in ("Shape", "Valley", "Mountain", "Cut")] == [1, 2, 0, 1]


def test_svg_has_y_down() -> None:
    pattern = build_pattern(
        flat=[(0, 0), (80, 0), (80, 60)],
        folded=[(0, 0), (80, 0), (80, 60)],
        edges=[(0, 1, "B"), (1, 2, "B"), (2, 0, "B")],
        faces=[(0, 1, 2)],
        layers=[0],
        loop=[(10, 5), (30, 5), (30, 25)],
    )
    assert ends(layers(export(pattern, ".svg"))["Shape"][0]).tolist() == [[10, 55], [30, 55], [30, 35]]


def test_svg_has_no_styles_that_machines_drop() -> None:
    data = export(letter_fold(), ".svg")
    for word in (b"stroke-dasharray", b"transform", b"<style", b"class="):
        assert word not in data


@pytest.mark.parametrize("size", [(15, 15), (40, 40), (59, 80), (60, 60), (61, 500), (210, 297), (2000, 100)])
def test_legend_lies_inside_the_sheet(size: tuple[float, float]) -> None:
    width, height = size
    flat = [(0, 0), (width, 0), (width, height), (0, height)]
    rim = [(0, 1, "B"), (1, 2, "B"), (2, 3, "B"), (3, 0, "B")]
    pattern = build_pattern(
        flat, flat, rim, [(0, 1, 2, 3)], [0], loop=flat, title="a title of forty-five letters 方 & <more> x"
    )
    root = ET.fromstring(export(pattern, ".svg"))
    legend = root.findall(f"{SVG}g")[-1]
    for text in legend.iter(f"{SVG}text"):
        x, y, size_mm = (float(text.attrib[key]) for key in ("x", "y", "font-size"))
        assert x > 0
        assert x + 0.6 * size_mm * len(text.text or "") < width + 1e-6
        assert size_mm < y < height
    for label, data in layers(export(pattern, ".svg")).items():
        if label == "Legend":
            for path in data:
                numbers = [float(n) for n in re.findall(r"[\d.]+", path)]
                assert max(numbers) < max(width, height)


@pytest.mark.parametrize(("width", "ruler"), [(59.0, "10 mm"), (60.0, "50 mm"), (210.0, "50 mm")])
def test_ruler_is_shorter_on_small_sheets(width: float, ruler: str) -> None:
    flat = [(0, 0), (width, 0), (width, 80), (0, 80)]
    pattern = build_pattern(flat, flat, [(0, 1, "B")], [(0, 1, 2, 3)], [0])
    texts = [text.text for text in ET.fromstring(export(pattern, ".svg")).iter(f"{SVG}text")]
    assert ruler in texts


def test_a_title_with_markup_and_control_characters_gives_valid_xml() -> None:
    pattern = book_fold(title='a <b> & "c" \x00\x1b\ud800 ü')
    root = ET.fromstring(export(pattern, ".svg"))
    assert root.findtext(f"{SVG}title") == 'a <b> & "c"  ü'
    assert json.loads(export(pattern, ".fold"))["file_title"] == pattern.title


# Bare lines


def lines_of(data: bytes, kind: str) -> list[tuple[str, list[float]]]:
    """Read bare lines by the rules of Flat-Folder's reader: letter and x1, y1, x2, y2."""
    if kind == ".cp":
        rows = [line.split() for line in data.decode().splitlines()]
        return [("UBMVF"[int(row[0])], [float(value) for value in row[1:]]) for row in rows]
    root = ET.fromstring(data)
    if kind == ".opx":
        found = []
        for element in root.iter("object"):
            if element.get("class") == "oripa.OriLineProxy":
                values = {child.get("property"): float(child[0].text or "nan") for child in element}
                found.append(("UBMV"[int(values["type"])], [values[name] for name in ("x0", "y0", "x1", "y1")]))
        return found
    colours = {"#000000": "B", "#ff0000": "M", "#0000ff": "V"}
    return [
        (
            colours[dict(pair.split(":") for pair in line.attrib["style"].split(";"))["stroke"]],
            [float(line.attrib[name]) for name in ("x1", "y1", "x2", "y2")],
        )
        for line in root.iter(f"{SVG}line")
    ]


@pytest.mark.parametrize("kind", [".svg", ".cp", ".opx"])
def test_bare_lines_are_all_edges_with_y_down(kind: str) -> None:
    pattern = letter_fold()
    data = export(pattern, kind, load_profile("origami-software"))
    creases = pattern.creases
    points = creases.vertices_coords * (1, -1) + (0, pattern.sheet.height)
    want = [
        (letter, points[edge].ravel().tolist())
        for letter, edge in zip(creases.edges_assignment.tolist(), creases.edges_vertices, strict=True)
    ]
    assert lines_of(data, kind) == want
    assert lines_of(data, kind)[1:] != want


def read_by_others(data: bytes, kind: str, folder: Path) -> list[tuple[str, list[float]]]:
    """Read bare lines with svgelements or the creasepattern package: letter and x1, y1, x2, y2, y down."""
    path = folder / f"pattern{kind}"
    path.write_bytes(data)
    if kind == ".svg":
        svg = svgelements.SVG.parse(path, ppi=25.4)
        colours = {"#000000": "B", "#ff0000": "M", "#0000ff": "V"}
        lines = svg.elements(lambda element: isinstance(element, svgelements.SimpleLine))
        return [(colours[line.stroke.hex], [line.x1, line.y1, line.x2, line.y2]) for line in lines]
    readers = pytest.importorskip("creasepattern")
    letters = {"EDGE": "B", "MOUNTAIN": "M", "VALLEY": "V"}
    read = readers.from_cp if kind == ".cp" else readers.from_opx
    return [(letters[line.type.name], [line.x1, line.y1, line.x2, line.y2]) for line in read(path).lines]


@pytest.mark.parametrize("sample", TESTED)
def test_others_read_every_edge_of_bare_lines_where_it_is(sample: str, tmp_path: Path) -> None:
    pattern = folded_sample(sample)
    creases = pattern.creases
    points = creases.vertices_coords * (1, -1) + (0, pattern.sheet.height)
    for kind in (".svg", ".cp", ".opx"):
        seen = read_by_others(export(pattern, kind, load_profile("origami-software")), kind, tmp_path)
        letters, ends = zip(*seen, strict=True)
        assert list(letters) == creases.edges_assignment.tolist(), kind
        assert_allclose(ends, points[creases.edges_vertices].reshape(-1, 4), rtol=0, atol=1e-3, err_msg=kind)
        with pytest.raises(AssertionError):
            assert_allclose(ends, points[creases.edges_vertices[::-1]].reshape(-1, 4), rtol=0, atol=1e-3)
