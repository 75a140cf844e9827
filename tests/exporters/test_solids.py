"""The scored sheet as a solid, read back by admesh, lib3mf and FreeCAD."""

from __future__ import annotations

import json
import math
import re
import sys
import zipfile
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely
from support.folded import folded_sample
from support.patterns import book_fold
from support.programs import require_program, run_program

from foldcut.cli.main import main
from foldcut.core.errors import FileFormatError
from foldcut.core.model import FoldedPattern, Sheet
from foldcut.exporters import check_suffix, export
from foldcut.exporters.solids import folded_stack, step
from foldcut.exporters.solids.scored_sheet import sheet_solid
from foldcut.jobs.errors import JobError, TooLargeError
from foldcut.profiles import load_profile

SHEET = load_profile("scored-sheet")


@cache
def folded(name: str) -> FoldedPattern:
    return folded_sample(name)


def admesh_faults(data: bytes, pattern: FoldedPattern, path: Path) -> list[str]:
    """List what admesh finds otherwise than in the sheet: size, parts, open edges, volume."""
    path.write_bytes(data)
    said = run_program(require_program("admesh"), "--no-check", path)
    seen = run_program(require_program("admesh"), path)
    size = [float(value) for value in re.findall(r"Max [XYZ] *= *([-\d.]+)", said)]
    volume = float(re.findall(r"Volume *: *([-\d.]+)", seen)[0])
    right = {
        "size": size == pytest.approx([pattern.sheet.width, pattern.sheet.height, 0.4], abs=1e-4),
        "parts": re.search(r"Number of parts *: +1\b", seen),
        "edges": re.search(r"Facets with 1 disconnected edge *: +0 +0", seen),
        "volume": volume == pytest.approx(sheet_solid(pattern, SHEET).volume(), rel=1e-3),
    }
    return [name for name, good in right.items() if not good]


@pytest.mark.parametrize("name", ["star", "bolt", "plus", "letter-a"])
def test_admesh_finds_one_closed_solid_of_the_right_size(name: str, tmp_path: Path) -> None:
    pattern = folded(name)
    assert admesh_faults(export(pattern, ".stl", SHEET), pattern, tmp_path / "sheet.stl") == []


def test_the_comparison_sees_a_lost_facet_and_another_thickness(tmp_path: Path) -> None:
    pattern = folded("star")
    data = export(pattern, ".stl", SHEET)
    count = int.from_bytes(data[80:84], "little")
    lost = data[:80] + (count - 1).to_bytes(4, "little") + data[84:-50]
    assert "edges" in admesh_faults(lost, pattern, tmp_path / "lost.stl")
    thick = export(pattern, ".stl", load_profile("scored-sheet", ["solid.thickness_mm=0.5"]))
    assert {"size", "volume"} <= set(admesh_faults(thick, pattern, tmp_path / "thick.stl"))


def test_lib3mf_reads_the_same_closed_mesh(tmp_path: Path) -> None:
    lib3mf = pytest.importorskip("lib3mf")
    pattern = folded("bolt")
    path = tmp_path / "sheet.3mf"
    path.write_bytes(export(pattern, ".3mf", SHEET))
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.ReadFromFile(str(path))
    assert reader.GetWarningCount() == 0
    assert model.GetUnit() == lib3mf.ModelUnit.MilliMeter
    meshes = model.GetMeshObjects()
    assert meshes.MoveNext()
    mesh = meshes.GetCurrentMeshObject()
    assert mesh.IsManifoldAndOriented()
    ours = sheet_solid(pattern, SHEET).to_mesh64()
    assert (mesh.GetVertexCount(), mesh.GetTriangleCount()) == (len(ours.vert_properties), len(ours.tri_verts))
    seen = np.array([list(place.Coordinates) for place in mesh.GetVertices()])
    assert np.abs(seen - np.asarray(ours.vert_properties)[:, :3]).max() < 1e-4  # it reads single precision
    assert not meshes.MoveNext()


@pytest.mark.parametrize("name", ["star", "bolt", "tree"])
def test_freecad_reads_one_valid_solid_of_the_meshs_volume(name: str, tmp_path: Path) -> None:
    pytest.importorskip("build123d")
    freecad = require_program("freecadcmd")
    pattern = folded(name)
    path, script = tmp_path / "sheet.step", tmp_path / "read.py"
    path.write_bytes(export(pattern, ".step", SHEET))
    script.write_text(
        "import json, Part\n"
        f"shape = Part.read({str(path)!r})\n"
        "box = shape.BoundBox\n"
        "seen = [shape.isValid(), len(shape.Solids), shape.Volume, box.XLength, box.YLength, box.ZLength]\n"
        "print('SEEN', json.dumps(seen))\n"
    )
    (said,) = re.findall(r"SEEN (.*)", run_program(freecad, script))
    valid, count, volume, *size = json.loads(said)
    assert (valid, count) == (True, 1)
    assert volume == pytest.approx(sheet_solid(pattern, SHEET).volume(), rel=1e-3)
    assert size == pytest.approx([pattern.sheet.width, pattern.sheet.height, 0.4], abs=1e-6)


def test_faces_of_step_are_plane_and_share_their_sides() -> None:
    pattern = folded("bolt")
    mesh = sheet_solid(pattern, SHEET).simplify(step.FLAT_MM[0]).to_mesh64()
    points = np.asarray(mesh.vert_properties)[:, :3]
    triangles = np.asarray(mesh.tri_verts).astype(np.int64)
    faces = step.plane_faces(triangles, np.asarray(mesh.face_id))
    assert len(faces) < len(triangles) / 2
    sides = [side for loops in faces for loop in loops for side in zip(loop, loop[1:] + loop[:1], strict=True)]
    assert len(set(sides)) == len(sides)
    assert {(b, a) for a, b in sides} == set(sides)
    for loops in faces:
        corners = points[[corner for loop in loops for corner in loop]]
        assert np.linalg.svd(corners - corners.mean(axis=0))[1][-1] < 1e-4


def test_planes_of_faces_are_those_of_their_outer_loops() -> None:
    square = np.array([[0, 0, 1], [9, 0, 1], [9, 9, 1], [0, 9, 1]], dtype=np.float64)
    hole = np.array([[2, 2, 1], [2, 3, 1], [3, 3, 1], [3, 2, 1]], dtype=np.float64)
    wall = np.array([[5, 0, 0], [5, 4, 0], [5, 4, 2]], dtype=np.float64)
    line = np.array([[0, 0, 0], [1, 1, 1], [2, 2, 2]], dtype=np.float64)
    points = np.concatenate([square, hole, wall, line])
    faces = [[[4, 5, 6, 7], [0, 1, 2, 3]], [[8, 9, 10]], [[11, 12, 13]]]
    places, normals = step.planes(points, faces)
    assert faces[0] == [[0, 1, 2, 3], [4, 5, 6, 7]]
    assert normals.tolist() == [[0, 0, 1], [1, 0, 0], [0, 0, 0]]
    assert places[0].tolist() == [4.5, 4.5, 1]
    assert step.max_off(points, faces, places, normals) == 0
    points[6, 2] += 1e-3
    assert step.max_off(points, faces, places, normals) == pytest.approx(1e-3)


def test_faces_that_are_not_plane_are_made_finer_before_open_cascade_sees_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pytest.importorskip("build123d")
    pattern = folded("star")
    data = export(pattern, ".step", SHEET)
    assert b"PCURVE" not in data, "planes need none"
    built = []
    solid = step.Builder.solid
    monkeypatch.setattr(step.Builder, "solid", lambda self, *rest: built.append(1) or solid(self, *rest))
    monkeypatch.setattr(step, "FLAT_MM", (1e-2, 1e-8))
    assert export(pattern, ".step", SHEET)
    assert len(built) == 1


@pytest.mark.parametrize("sample", ["house", "swan", "cat"])
def test_an_edge_too_short_for_open_cascade_is_no_traceback(sample: str) -> None:
    pytest.importorskip("build123d")
    try:
        data = export(folded_sample(sample, method="skeleton"), ".step", SHEET)
    except FileFormatError as error:
        assert "no valid solid for STEP; try .stl" in str(error)
    else:
        assert data.startswith(b"ISO-10303-21;")


@pytest.mark.parametrize("letter", ["M", "V"])
def test_a_groove_is_where_its_crease_is_and_as_deep(letter: str) -> None:
    pattern = book_fold(letter)
    solid = sheet_solid(pattern, SHEET)
    length = pattern.sheet.height
    # a V 0.4 mm wide at the surface and 0.16 mm deep, from edge to edge
    missing = pattern.sheet.width * pattern.sheet.height * 0.4 - solid.volume()
    assert missing == pytest.approx(0.4 * 0.16 / 2 * length, rel=1e-3)
    for height, cut in ((0.39, letter == "M"), (0.01, letter == "V"), (0.2, False)):
        through = solid.slice(height).area() < pattern.sheet.width * pattern.sheet.height - 1
        assert through == cut


def test_grooves_that_leave_no_web_are_an_error() -> None:
    with pytest.raises(JobError, match=r"--set solid.groove_depth_mm=0.16"):
        export(book_fold(), ".stl", load_profile("scored-sheet", ["solid.groove_depth_mm=0.2"]))
    with pytest.raises(JobError, match="has no solid"):
        export(book_fold(), ".stl", load_profile("glowforge"))


@pytest.mark.parametrize(
    ("package", "suffix"), [("manifold3d", ".stl"), ("manifold3d", ".3mf"), ("build123d", ".step")]
)
def test_a_missing_extra_is_named_before_there_is_a_pattern(
    package: str, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(FileFormatError, match=rf"{package}: pip install 'foldcut\[solids\]'"):
        check_suffix(suffix)
    with pytest.raises(FileFormatError, match=package):
        export(book_fold(), suffix, SHEET)


@pytest.mark.parametrize("suffix", [".stl", ".3mf", ".step"])
def test_the_same_sheet_has_the_same_bytes(suffix: str) -> None:
    pattern = folded("star")
    assert export(pattern, suffix, SHEET) == export(pattern, suffix, SHEET)


@pytest.mark.parametrize(
    ("change", "area"),
    [
        ("solid.groove=v", 0.4 * 0.16 / 2),
        ("solid.groove_angle_deg=90", 0.16**2),
        ("solid.groove_angle_deg=120", 0.16**2 * math.tan(math.radians(60))),
        ("solid.groove=u", math.pi / 4 * 0.4 * 0.16),
    ],
)
def test_grooves_have_the_section_that_is_asked_for(change: str, area: float) -> None:
    pattern = book_fold()
    solid = sheet_solid(pattern, load_profile("scored-sheet", [change]))
    missing = pattern.sheet.width * pattern.sheet.height * 0.4 - solid.volume()
    # a U is a polygon of eight sides within the half ellipse
    assert missing == pytest.approx(area * pattern.sheet.height, rel=0.03 if change.endswith("=u") else 1e-3)
    assert len(solid.decompose()) == 1


@pytest.mark.parametrize("change", ["solid.groove=u", "solid.groove_angle_deg=60", "solid.one_sided=true"])
def test_other_grooves_are_closed_solids_too(change: str, tmp_path: Path) -> None:
    pattern, profile = folded("star"), load_profile("scored-sheet", [change])
    path = tmp_path / "sheet.stl"
    path.write_bytes(export(pattern, ".stl", profile))
    seen = run_program(require_program("admesh"), path)
    assert re.search(r"Number of parts *: +1\b", seen)
    assert re.search(r"Facets with 1 disconnected edge *: +0 +0", seen)
    below = sheet_solid(pattern, profile).slice(0.01).area()
    assert (below == pytest.approx(pattern.sheet.width * pattern.sheet.height)) == ("one_sided" in change)


def heights_by_hand(pattern: FoldedPattern) -> list[int]:
    """The level of each face, by shapely: one above the highest of those under it that it overlaps."""
    faces = [
        shapely.Polygon(pattern.folded.vertices_coords[face]) for face in pattern.creases.faces_vertices.to_lists()
    ]
    found: dict[int, int] = {}
    for face in pattern.folded.layers.tolist():
        under = [level for other, level in found.items() if faces[other].intersection(faces[face]).area > 1e-6]
        found[face] = max(under, default=-1) + 1
    return [found[face] for face in range(len(faces))]


@pytest.mark.parametrize("name", ["star", "bolt", "letter-a"])
def test_the_folded_sheet_is_a_closed_stack_of_its_layers(name: str, tmp_path: Path) -> None:
    pattern = folded(name)
    profile = load_profile("scored-sheet", ["solid.folded=true", "solid.thickness_mm=0.25"])
    levels = folded_stack.levels(pattern)
    assert levels.tolist() == heights_by_hand(pattern)
    path = tmp_path / "stack.stl"
    path.write_bytes(export(pattern, ".stl", profile))
    said, seen = (run_program(require_program("admesh"), *words, path) for words in (["--no-check"], []))
    size = [float(value) for value in re.findall(r"Max [XYZ] *= *([-\d.]+)", said)]
    points = pattern.folded.vertices_coords
    assert size == pytest.approx([*np.ptp(points, axis=0), 0.25 * (levels.max() + 1)], abs=1e-3)
    assert re.search(r"Number of parts *: +1\b", seen)
    assert re.search(r"Facets with 1 disconnected edge *: +0 +0", seen)
    volume = pattern.sheet.width * pattern.sheet.height * 0.25
    assert float(re.findall(r"Volume *: *([-\d.]+)", seen)[0]) == pytest.approx(volume, rel=1e-5)
    solid = folded_stack.stack_solid(pattern, profile)
    assert solid.volume() == pytest.approx(volume, rel=1e-9)
    areas = [solid.slice(0.25 * (level + 0.5)).area() for level in range(int(levels.max()) + 1)]
    assert sum(areas) == pytest.approx(pattern.sheet.width * pattern.sheet.height, rel=1e-9)


@pytest.mark.parametrize("name", ["star", "fish"])
def test_step_of_the_folded_sheet_is_one_valid_solid(name: str, tmp_path: Path) -> None:
    build123d = pytest.importorskip("build123d")
    pattern = folded(name)
    path = tmp_path / "stack.step"
    path.write_bytes(export(pattern, ".step", load_profile("scored-sheet", ["solid.folded=true"])))
    read = build123d.import_step(path)
    assert len(read.solids()) == 1
    assert read.is_valid
    assert read.volume == pytest.approx(pattern.sheet.width * pattern.sheet.height * 0.4, rel=1e-9)


def test_too_small_a_bed_is_an_error_before_there_is_a_pattern() -> None:
    bed = ["bed.width_mm=120", "bed.height_mm=200"]
    small, large = Sheet(200.0, 120.0), Sheet(200.0, 121.0)
    check_suffix(".stl", profile=load_profile("scored-sheet", bed), sheet=small)
    with pytest.raises(
        TooLargeError, match=r"200 x 121 mm does not fit the bed of 120 x 200 mm; use a smaller --sheet"
    ):
        check_suffix(".stl", profile=load_profile("scored-sheet", bed), sheet=large)
    check_suffix(".stl", profile=load_profile("scored-sheet", [*bed, "solid.folded=true"]), sheet=large)
    with pytest.raises(TooLargeError, match="the folded sheet of"):
        export(
            folded("star"),
            ".stl",
            load_profile("scored-sheet", ["bed.width_mm=50", "bed.height_mm=50", "solid.folded=true"]),
        )


def test_one_sided_grooves_may_be_deeper_than_half_of_the_sheet() -> None:
    deep = ["solid.groove_depth_mm=0.25"]
    with pytest.raises(JobError, match="from both sides leave nothing"):
        export(book_fold(), ".stl", load_profile("scored-sheet", deep))
    assert export(book_fold(), ".stl", load_profile("scored-sheet", [*deep, "solid.one_sided=true"]))
    with pytest.raises(JobError, match=r"on top leave nothing of 0.4 mm; --set solid.groove_depth_mm=0.32"):
        export(book_fold(), ".stl", load_profile("scored-sheet", ["solid.groove_depth_mm=0.4", "solid.one_sided=true"]))


def test_the_options_for_solids_are_those_of_the_profile(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    quick = ("--effort", "fast", "--quiet")
    options = ("--groove", "v90", "--one-sided")
    assert main(["make", "star", *quick, *options, "-o", "a.stl", "-o", "a.svg"]) == 0
    profile = ("--profile", "scored-sheet", "--set", "solid.groove_angle_deg=90", "--set", "solid.one_sided=true")
    assert main(["make", "star", *quick, *profile, "-o", "b.stl"]) == 0
    assert Path("a.stl").read_bytes() == Path("b.stl").read_bytes()
    assert main(["make", "a.svg", "--again", "--quiet"]) == 0
    assert main(["make", "star", *quick, "--folded", "-o", "c.3mf", "-o", "c.svg"]) == 0
    assert main(["make", "c.3mf", "--again", "--quiet"]) == 0
    capsys.readouterr()
    for wrong, message in (
        (("--folded",), "--folded is for solids"),
        (("--groove", "w", "-o", "d.stl"), "--groove w is no form"),
        (("--groove", "v9", "-o", "d.stl"), "10 to 170"),
        (("--folded", "--groove", "v", "-o", "d.stl"), "--groove is for the flat sheet"),
        (("--folded", "--one-sided", "-o", "d.step"), "--one-sided is for the flat sheet"),
        (("--profile", "scored-sheet", "--set", "solid.folded=true", "--groove", "u"), "--groove is for the flat"),
        (("--folded", "-o", "d.zip"), "--folded is for solids"),
        (("--folded", "--profile", "scored-sheet", "-o", "d.svg"), "--folded is for solids"),
        (("--profile", "printer-a4", "--groove", "v90", "-o", "d.stl"), "printer-a4 makes no solids"),
        (("--profile", "glowforge", "--folded", "-o", "d.3mf", "-o", "d.svg"), "glowforge makes no solids"),
    ):
        assert main(["make", "star", *wrong]) == 2
        assert message in capsys.readouterr().err


def test_solids_of_another_form_are_made_where_the_profile_names_the_format(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("folder").mkdir()
    usual, other = ("--profile", "scored-sheet"), ("--groove", "v90")
    make = ("make", "star", "--effort", "fast", "--quiet")
    assert main([*make, *usual, "-o", "plain.stl"]) == 0
    assert main([*make, *usual, *other, "-o", "a.stl"]) == 0
    assert main([*make, *usual, *other]) == 0
    assert main([*make, *usual, *other, "-o", "a.zip", "-o", "folder"]) == 0
    wanted = Path("a.stl").read_bytes()
    assert wanted != Path("plain.stl").read_bytes()
    assert Path("star-scored-sheet.stl").read_bytes() == wanted
    assert Path("folder/star.stl").read_bytes() == wanted
    with zipfile.ZipFile("a.zip") as archive:
        assert archive.read("a.stl") == wanted
        assert "--groove=v90" in archive.read("README.txt").decode()
    assert main(["make", "a.zip", "--again", "--quiet"]) == 0
    assert main([*make, *usual, "--folded", "-o", "b.zip"]) == 0
    assert main(["make", "b.zip", "--again", "--quiet"]) == 0
