"""First folds that a FOLD file names are proven, or left out: nothing else of them reaches a machine or a reader."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.folded import folded_sample
from support.patterns import book_fold, square_out_of_square

import foldcut
from foldcut.cli.main import main
from foldcut.core.model import FoldedPattern, Sheet
from foldcut.exporters import export
from foldcut.foldfile.first_folds import why_not_first
from foldcut.foldfile.read import read_fold
from foldcut.foldfile.reopen import Reopened, reopen


def reopened(pattern: FoldedPattern, folder: Path, **changes: object) -> Reopened:
    document: dict[str, Any] = {**json.loads(export(pattern, ".fold")), **changes}
    path = folder / "pattern.fold"
    path.write_text(json.dumps(document))
    return reopen(read_fold(path))


@pytest.mark.parametrize(("sample", "count"), [("triangle", 1), ("ring", 2), ("star", 5)])
def test_the_first_folds_that_foldcut_wrote_are_proven(sample: str, count: int, tmp_path: Path) -> None:
    pattern = folded_sample(sample, method="mirror")
    assert len(pattern.first_folds) == count
    again = reopened(pattern, tmp_path)
    assert len(again.folded_pattern.first_folds) == count
    assert again.notes == ()


def test_the_first_folds_of_a_wedge_are_proven(tmp_path: Path) -> None:
    pattern = folded_sample("rosette")
    again = reopened(pattern, tmp_path)
    assert (len(again.folded_pattern.first_folds), again.notes) == (8, ())


@pytest.mark.parametrize("count", [3, 7])
def test_a_wedge_of_other_lines_or_other_creases_is_refused(count: int) -> None:
    tooth = (-0.2, 1.0), (0.2, 1.0), (math.pi / count, 0.5)
    places = [(k * 2 * math.pi / count + turn, away) for k in range(count) for turn, away in tooth]
    star = [(away * math.cos(turn), away * math.sin(turn)) for turn, away in places]
    pattern = foldcut.fold([star], method="mirror", effort="fast").folded_pattern
    creases, sheet, lines = pattern.creases, pattern.sheet, pattern.first_folds
    assert why_not_first(creases, sheet, lines) == ""
    assert "not folded all along" in why_not_first(creases, sheet, lines[::-1])
    assert "through one point" in why_not_first(creases, sheet, [lines[0] + 1e-3, *lines[1:]])
    assert "equal angles" in why_not_first(creases, sheet, [lines[0] + [(0, 0), (1, -1)], *lines[1:]])
    middles = creases.vertices_coords[creases.edges_vertices].mean(axis=1)
    on_axes = np.zeros(len(middles), dtype=bool)
    for start, end in lines:
        along = (end - start) / np.hypot(*(end - start))
        on_axes |= np.abs((middles - start) @ (-along[1], along[0])) < 1e-6
    for on, words in ((True, "not folded all along"), (False, "no mirror images")):
        letters = creases.edges_assignment.copy()
        some = np.flatnonzero((on_axes == on) & np.isin(letters, ["M", "V"]))[0]
        letters[some] = {"M": "V", "V": "M"}[letters[some]]
        assert words in why_not_first(replace(creases, edges_assignment=letters), sheet, lines)


def ring_lines() -> tuple[list[list[float]], list[list[float]]]:
    first, second = (line.tolist() for line in folded_sample("ring", method="mirror").first_folds)
    return first, second


def test_lines_that_are_no_middle_lines_are_left_out(tmp_path: Path) -> None:
    pattern = folded_sample("ring", method="mirror")
    first, second = ring_lines()
    far, same = [[1e6, 0], [0, 1e6]], [[5, 5], [5, 5]]
    diagonal = [[0, 0], [pattern.sheet.width, pattern.sheet.height]]
    short = [first[0], [(a + b) / 2 for a, b in zip(*first, strict=True)]]
    for lines in ([far], [same], [diagonal], [short], [first, far], [first, first], [[*first, *second]], [first] * 3):
        again = reopened(pattern, tmp_path, **{"foldcut:firstFolds": lines})
        assert again.verified
        assert again.folded_pattern.first_folds == ()
        assert "foldcut:firstFolds is left out: " in again.notes[-1]


def test_the_second_fold_cannot_be_the_first(tmp_path: Path) -> None:
    first, second = ring_lines()
    again = reopened(folded_sample("ring", method="mirror"), tmp_path, **{"foldcut:firstFolds": [second, first]})
    assert "line 0 is not folded away from you all along" in again.notes[-1]


def test_a_middle_line_of_a_pattern_without_symmetry_is_no_first_fold() -> None:
    book = book_fold("M")
    line = np.array([(50.0, 0.0), (50.0, 60.0)])
    assert why_not_first(book.creases, book.sheet, [line]) == ""
    valley = book_fold("V")
    assert "not folded away" in why_not_first(valley.creases, valley.sheet, [line])
    square = square_out_of_square()  # creases on its middle lines, some mountains and some valleys
    for line in (np.array([(24.0, 0.0), (24.0, 48.0)]), np.array([(0.0, 24.0), (48.0, 24.0)])):
        assert why_not_first(square.creases, Sheet(48, 48), [line])


def test_a_crease_without_a_mirror_image_is_found() -> None:
    pattern = folded_sample("triangle", method="mirror")
    letters = pattern.creases.edges_assignment.copy()
    ends = pattern.creases.vertices_coords[pattern.creases.edges_vertices]
    (line,) = pattern.first_folds
    axis = 0 if line[0, 0] == line[1, 0] else 1
    beside = np.abs(ends[:, :, axis] - line[0, axis]).max(axis=1) > 1
    changed = int(np.flatnonzero(np.isin(letters, ("M", "V")) & beside)[0])
    letters[changed] = "VM"["MV".index(letters[changed])]
    creases = type(pattern.creases)(
        pattern.creases.vertices_coords, pattern.creases.edges_vertices, letters, pattern.creases.faces_vertices
    )
    assert why_not_first(pattern.creases, pattern.sheet, [line]) == ""
    assert "no mirror images" in why_not_first(creases, pattern.sheet, [line])


def test_a_laser_is_not_sent_where_a_file_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    document = json.loads(export(folded_sample("triangle", "180x250mm"), ".fold"))
    for number, line in enumerate(([[1e6, 0], [0, 1e6]], [[5, 5], [5, 5]], [[1e14, 1e14], [1e14, 0]])):
        Path("a.fold").write_text(json.dumps(document | {"foldcut:firstFolds": [line]}))
        assert main(["make", "a.fold", "--profile", "grbl-laser", "-o", f"{number}.gcode"]) == 0
        assert "foldcut:firstFolds is left out" in capsys.readouterr().out
        places = re.findall(r"X(\S+) Y(\S+)", Path(f"{number}.gcode").read_text())
        points = np.array(places, dtype=np.float64)
        assert len(points) > 10
        assert np.all((points >= 0) & (points <= 250))  # NaN is neither


def test_a_drawing_that_is_not_on_the_sheet_is_left_out(tmp_path: Path) -> None:
    pattern = square_out_of_square()
    loop = [[4.0, 4.0], [44.0, 4.0], [44.0, 44.0]]
    assert len(reopened(pattern, tmp_path, **{"foldcut:drawn": [loop]}).folded_pattern.drawn) == 1
    loop[1][0] = 1e12
    again = reopened(pattern, tmp_path, **{"foldcut:drawn": [loop]})
    assert again.folded_pattern.drawn == ()
    assert "foldcut:drawn is left out" in again.notes[-1]
