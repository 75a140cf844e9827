"""The scored sheet as a solid, read back by admesh."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np
import pytest
from patterns import book_fold
from programs import require_program, run_program

from foldcut.errors import FileFormatError
from foldcut.exporters import export
from foldcut.exporters.stl import sheet_solid
from foldcut.job import JobError
from foldcut.model import FoldedPattern
from foldcut.pipeline import fold
from foldcut.profiles import load_profile
from foldcut.samples import sample_path

SHEET = load_profile("scored-sheet")


def folded(name: str) -> FoldedPattern:
    return fold(sample_path(name), effort="fast", min_crease=0).require_verified()


@pytest.mark.parametrize("name", ["star", "bolt", "plus"])
def test_admesh_finds_one_closed_solid_of_the_right_size(name: str, tmp_path: Path) -> None:
    pattern = folded(name)
    path = tmp_path / "sheet.stl"
    path.write_bytes(export(pattern, ".stl", SHEET))
    said = run_program(require_program("admesh"), "--no-check", path)
    seen = run_program(require_program("admesh"), path)
    size = [float(value) for value in re.findall(r"Max [XYZ] *= *([-\d.]+)", said)]
    assert size == pytest.approx([pattern.sheet.width, pattern.sheet.height, 0.4], abs=1e-4)
    assert re.search(r"Number of parts *: +1\b", seen)
    assert re.search(r"Facets with 1 disconnected edge *: +0 +0", seen)
    volume = float(re.findall(r"Volume *: *([-\d.]+)", seen)[0])
    assert volume == pytest.approx(sheet_solid(pattern, SHEET).volume(), rel=1e-3)


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


def test_a_missing_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "manifold3d", None)
    with pytest.raises(FileFormatError, match=r"foldcut\[solids\]"):
        export(book_fold(), ".stl", SHEET)


def test_the_same_sheet_has_the_same_bytes() -> None:
    pattern = folded("star")
    one, other = (np.frombuffer(export(pattern, ".stl", SHEET)[84:], dtype=np.uint8) for _ in range(2))
    assert (one == other).all()
