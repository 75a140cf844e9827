"""Reopening a FOLD file: what foldcut wrote comes back to the byte, and files by others are recognised."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.folded import folded_sample
from support.patterns import square_out_of_square
from support.recipes import without_recipe

from foldcut.cli.main import main
from foldcut.core.errors import BadInputError
from foldcut.core.model import FoldedPattern
from foldcut.exporters import export
from foldcut.foldfile.read import read_fold
from foldcut.foldfile.reopen import Reopened, reopen


def reopened(tmp_path: Path, pattern: FoldedPattern, **changes: object) -> Reopened:
    """Write a pattern as FOLD with some keys changed (None leaves one out), and open it."""
    document: dict[str, Any] = {**json.loads(export(pattern, ".fold")), **changes}
    path = tmp_path / "pattern.fold"
    path.write_text(json.dumps({key: value for key, value in document.items() if value is not None}))
    return reopen(read_fold(path))


@pytest.mark.parametrize("sample", ["fish", "letter-a", "two-triangles"])
def test_what_foldcut_wrote_comes_back_to_the_byte(sample: str, tmp_path: Path) -> None:
    pattern = folded_sample(sample)
    again = reopened(tmp_path, pattern)
    assert again.verified
    for ending in (".fold", ".html", ".svg"):
        assert export(again.folded_pattern, ending) == export(pattern, ending)


def moved_frame(by: tuple[float, float], turn: float = 0.0) -> list[dict[str, Any]]:
    """Return the square's folded frame, turned and moved."""
    c, s = np.cos(turn), np.sin(turn)
    places = square_out_of_square().folded.vertices_coords @ np.array([[c, s], [-s, c]]) + by
    return [{"frame_classes": ["foldedForm"], "vertices_coords": places.tolist()}]


@pytest.mark.parametrize(
    ("frames", "said"),
    [
        (moved_frame((3, 0)), ""),
        (moved_frame((0, 1e-3)), "the cut does not lie along y = 0"),
        (moved_frame((0, 0), np.pi), "the cut does not lie along y = 0"),
        (moved_frame((0, 0), 1e-4), "the cut does not lie along y = 0"),
    ],
)
def test_the_cut_of_the_folded_form_lies_along_the_x_axis(
    frames: list[dict[str, Any]], said: str, tmp_path: Path
) -> None:
    findings = reopened(tmp_path, square_out_of_square(), file_frames=frames).findings
    assert said in str(findings[0] if findings else "")
    assert bool(findings) == bool(said)


def test_a_vertex_of_the_folded_form_that_is_elsewhere_is_found(tmp_path: Path) -> None:
    frames = moved_frame((0, 0))
    frames[0]["vertices_coords"][3][0] += 0.01
    (finding,) = reopened(tmp_path, square_out_of_square(), file_frames=frames).findings
    assert "vertices_coords[3] is " in str(finding)


def test_a_flipped_crease_is_found(tmp_path: Path) -> None:
    pattern = square_out_of_square()
    letters = ["VM"["MV".index(x)] if x in "MV" else x for x in pattern.creases.edges_assignment.tolist()]
    again = reopened(tmp_path, pattern, edges_assignment=letters)
    assert {finding.check for finding in again.findings} == {"mountain-valley"}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"foldcut:layers": None, "faceOrders": None}, "no foldcut:layers or faceOrders, which face lies on which"),
        ({"file_frames": []}, "no foldedForm frame"),
        ({"foldcut:shape": None}, "no foldcut:shape, what the cut cuts out"),
        ({"foldcut:placement": None}, "no foldcut:placement"),
        ({"foldcut:shape": [[[0, 0], [1, 1]]]}, "foldcut:shape[0]: 2 points; give at least 3"),
    ],
)
def test_what_is_missing_is_named(changes: dict[str, object], words: str, tmp_path: Path) -> None:
    with pytest.raises(BadInputError) as error:
        reopened(tmp_path, square_out_of_square(), **changes)
    assert words in str(error.value)


def test_view_make_and_draw_take_a_fold_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["make", "triangle", "--profile", "laser-dxf", "-o", "a.fold", "-o", "a.dxf", "-o", "a.html"]) == 0
    assert main(["view", "a.fold", "-o", "b.html"]) == 0
    assert main(["make", "a.fold", "--profile", "laser-dxf", "-o", "b.dxf"]) == 0
    for ending in ("html", "dxf"):
        a, b = (without_recipe(Path(f"{name}.{ending}").read_bytes()) for name in "ab")
        assert a == b
    assert main(["draw", "a.fold"]) == 0
    assert main(["guide", "a.fold"]) == 0
    capsys.readouterr()
    assert main(["view", "a.fold", "--force", "--sheet", "a3", "--mirror"]) == 2
    assert "--sheet, --mirror: only for drawings" in capsys.readouterr().err
    assert main(["draw", "a.fold", "--force", "--show", "packing"]) == 2


def test_a_pattern_that_is_not_verified_gives_no_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    document = json.loads(export(square_out_of_square(), ".fold"))
    document["foldcut:layers"] = document["foldcut:layers"][::-1]
    Path("a.fold").write_text(json.dumps(document))
    assert main(["view", "a.fold"]) == 1
    assert "not verified" in capsys.readouterr().err
    assert not Path("a.html").exists()
