"""The scored sheet as a solid, read back by admesh, lib3mf and FreeCAD."""

from __future__ import annotations

import json
import re
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from support.folded import folded_sample
from support.patterns import book_fold
from support.programs import require_program, run_program

from foldcut.core.errors import FileFormatError
from foldcut.core.model import FoldedPattern
from foldcut.exporters import check_suffix, export
from foldcut.exporters.solids import step
from foldcut.exporters.solids.scored_sheet import sheet_solid
from foldcut.jobs.errors import JobError
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
