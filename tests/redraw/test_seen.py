"""What was drawn anew can be seen: in pictures, on the page, on the contact sheet, in reports and in FOLD files."""

from __future__ import annotations

import csv
import io
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import svgelements
from numpy.testing import assert_allclose

import foldcut
from foldcut.batch.results import COLUMNS
from foldcut.cli.main import main
from foldcut.cli.report import level_report, make_lines, make_report
from foldcut.core.errors import BadInputError
from foldcut.exporters import export
from foldcut.exporters.pictures import pictures
from foldcut.exporters.pictures.contact_sheet import contact_sheet, thumbnail
from foldcut.foldfile.read import read_fold
from foldcut.foldfile.reopen import reopen
from foldcut.folding_steps.phases import Phase
from foldcut.pipeline import Result
from foldcut.profiles import load_profile
from foldcut.redraw.distance import apart

HEIGHTS = [0, 0.5, -0.1, 0.3, 0.1, 0.6, -0.2, 0.2, 0]
BUMPY = np.concatenate([np.column_stack([np.linspace(0, 100, 9), HEIGHTS]), [(100, 60), (0, 60)]])
"""A rectangle with a side that is not straight."""


@pytest.fixture(scope="module")
def result() -> Result:
    found = foldcut.fold([BUMPY], effort="fast", folds=10)
    assert found.folded_pattern.drawn
    return found


@pytest.fixture(scope="module")
def as_drawn() -> Result:
    found = foldcut.fold([BUMPY], effort="fast", exact=True)
    assert not found.folded_pattern.drawn
    return found


def strokes(data: bytes, panel: str, colour: str) -> list[svgelements.Path]:
    drawing = svgelements.SVG.parse(io.BytesIO(data), ppi=25.4)
    (group,) = drawing.elements(lambda e: isinstance(e, svgelements.Group) and e.id == panel)
    paths = [path for path in group.select() if isinstance(path, svgelements.Path)]
    return [
        path for path in paths if path.stroke.value is not None and path.stroke.hex == svgelements.Color(colour).hex
    ]


@pytest.mark.parametrize("panel", ["pattern", "outline"])
def test_pictures_have_the_drawing_in_grey(result: Result, as_drawn: Result, panel: str) -> None:
    both = [pictures.draw(one.folded_pattern, [panel], load_profile())[0] for one in (result, as_drawn)]
    (grey,) = strokes(both[0], panel, pictures.DRAWN)
    assert len({(round(p.x, 3), round(p.y, 3)) for p in grey.as_points()}) == len(BUMPY)
    assert not strokes(both[1], panel, pictures.DRAWN)
    assert (b"the drawing" in both[0], b"the drawing" in both[1]) == (True, False)


def test_the_outline_is_black_and_where_the_pattern_has_it(result: Result) -> None:
    pattern = result.folded_pattern
    data, _ = pictures.draw(pattern, ["outline"], load_profile())
    (black,) = strokes(data, "outline", pictures.CUT_OUT)
    points = {(round(p.x, 3), round(p.y, 3)) for p in black.as_points()}
    assert len(points) == pattern.shape.corner_count


def test_the_ladder_has_a_picture_of_each_tolerance_with_its_cost(result: Result) -> None:
    ladder = result.ladder
    assert ladder is not None
    data, _ = pictures.draw(result.folded_pattern, ["ladder"], load_profile(), None, ladder)
    text = data.decode()
    assert re.findall(r'id="(ladder-\d+)"', text) == [f"ladder-{n + 1}" for n in range(len(ladder.levels))]
    for number, level in enumerate(ladder.levels):
        if level.folds is None:
            assert level.failure.split()[0] in text
        else:
            assert f"{level.off_by_mm:.2g} mm off, {level.folds} folds, shortest {level.shortest_mm:.3g} mm" in text
        assert bool(strokes(data, f"ladder-{number + 1}", pictures.DRAWN)) == bool(level.drawn)
    assert ladder.level.folds is not None
    assert text.count(": taken") == 1
    assert text.count(": no pattern") == sum(level.folds is None for level in ladder.levels)
    with pytest.raises(BadInputError, match="no ladder"):
        pictures.draw(result.folded_pattern, ["ladder"], load_profile())


def test_an_outline_without_a_pattern_is_drawn_with_the_reason(result: Result) -> None:
    from dataclasses import replace

    ladder = result.ladder
    assert ladder is not None
    failed = replace(ladder.level, tried=None, folds=None, failure="it does not fold " * 40)
    nowhere = replace(failed, laid=None, drawn=())
    data, _ = pictures.draw(
        result.folded_pattern, ["ladder"], load_profile(), None, replace(ladder, levels=(failed, nowhere), taken=0)
    )
    assert data.decode().count("no pattern") == 2
    assert data.decode().count("it does not fold") < 20, "and not all of its 680 letters"
    assert strokes(data, "ladder-1", pictures.CUT_OUT)
    assert not strokes(data, "ladder-2", pictures.CUT_OUT)


def test_the_page_has_the_drawing(result: Result, as_drawn: Result) -> None:
    pages = [export(one.folded_pattern, ".html").decode() for one in (result, as_drawn)]
    data = [json.loads(page.split('id="data">')[1].split("</script>")[0]) for page in pages]
    assert_allclose(data[0]["drawn"][0], result.folded_pattern.drawn[0], atol=1e-6)
    assert "drawn" not in data[1]


def test_the_contact_sheet_has_both_outlines(result: Result, as_drawn: Result) -> None:
    look = load_profile().drawing
    both = [thumbnail(one.folded_pattern) for one in (result, as_drawn)]
    assert both[0].drawn
    assert both[1].drawn == ""
    redrawn, plain = (contact_sheet([("it", one)], "", look)[0].decode() for one in both)
    assert both[0].drawn in redrawn
    assert (">drawing<" in redrawn, ">drawing<" in plain) == (True, False)


def test_fold_files_keep_the_drawing(result: Result, as_drawn: Result, tmp_path: Path) -> None:
    for name, one in (("redrawn", result), ("as-drawn", as_drawn)):
        path = tmp_path / f"{name}.fold"
        path.write_bytes(export(one.folded_pattern, ".fold"))
        again = reopen(read_fold(path))
        assert again.verified
        assert len(again.folded_pattern.drawn) == len(one.folded_pattern.drawn)
        for loop, other in zip(again.folded_pattern.drawn, one.folded_pattern.drawn, strict=True):
            np.testing.assert_array_equal(loop, other)
    assert b"foldcut:drawn" not in path.read_bytes()


def test_folds_are_the_sum_of_the_phases_whatever_the_search_took_them_for(as_drawn: Result) -> None:
    assert as_drawn.ladder is not None
    level = as_drawn.ladder.level
    assert level.folds is not None
    ladder = replace(as_drawn.ladder, levels=(replace(level, folds=level.folds + 7),))
    report = make_report(replace(as_drawn, actions=as_drawn.actions + 7, ladder=ladder), [])
    total = sum(phase["count"] for phase in report["phases"])
    assert report["actions"] == report["ladder"]["levels"][0]["folds"] == total


def test_the_report_has_the_ladder_and_says_what_was_taken(result: Result, as_drawn: Result) -> None:
    report = make_report(result, [])
    ladder = result.ladder
    assert ladder is not None
    json.dumps(report)
    assert [level["tolerance_mm"] for level in report["ladder"]["levels"]] == [
        one.tolerance_mm for one in ladder.levels
    ]
    assert report["ladder"]["levels"][report["ladder"]["taken"]]["folds"] == result.folds
    text = "\n".join(make_lines(report))
    rows = [line for line in text.splitlines() if " mm  " in line and "outline" not in line]
    assert len(rows) >= sum(level.tried is not None for level in ladder.levels)
    assert sum(line.strip().startswith(">") for line in text.splitlines()) == 1
    assert "taken     the outline" in text
    assert "for two hands, with at most 10 folds" in text
    alone = "\n".join(make_lines(make_report(as_drawn, [])))
    assert "outline   as drawn; " in alone
    assert "taken" not in alone


def test_the_report_says_plainly_that_none_is_for_two_hands() -> None:
    found = foldcut.fold([BUMPY], effort="fast", folds=2, tolerance=3)
    text = "\n".join(make_lines(make_report(found, [])))
    assert "it is not for two hands (more than 2 folds)" in text


@pytest.fixture
def bumpy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.chdir(tmp_path)
    Path("bumpy.json").write_text(json.dumps({"loops": [BUMPY.tolist()], "units": "mm"}))
    return "bumpy.json"


def test_the_preview_has_the_drawing_where_it_lies_on_the_sheet(bumpy: str) -> None:
    options = ["--effort", "fast", "--folds", "10", "--quiet", "--mirror", "--preview", "both.svg"]
    assert main(["make", bumpy, *options, "-o", "bumpy.fold"]) == 0
    text = Path("both.svg").read_text()
    after, before = (
        np.array([pair.split(",") for pair in data.strip("MZ ").split(" ")], dtype=float)
        for data in re.findall(r'd="([^"]*)"', text)
    )
    assert len(before) == len(BUMPY)
    assert len(after) < len(BUMPY)
    assert 0 < apart([before], [after]) < 4, "both are where they lie on the sheet, and mirrored"


def test_options_that_contradict_each_other_are_refused(bumpy: str, capsys: pytest.CaptureFixture[str]) -> None:
    for options, message in (
        (["--exact", "--tolerance", "1mm"], "exact forbids to move the outline"),
        (["--exact", "--level", "easy"], "exact forbids to move the outline"),
        (["--exact", "--simplify", "1mm"], "exact forbids to move corners"),
        (["--level", "exact", "--adjust", "1mm"], "exact forbids to move corners"),
        (["--tolerance", "wide"], "'wide' is not a length"),
        (["--folds", "0"], "with 0 folds"),
    ):
        assert main(["make", bumpy, *options, "-o", "x.fold"]) == 2
        assert message in capsys.readouterr().err


def test_lines_for_programs_tell_of_each_pattern(bumpy: str, capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--effort", "fast", "--folds", "10", "--quiet", "--progress", "-o", "bumpy.fold"]
    assert main(["make", bumpy, *options]) == 0
    told = [json.loads(line) for line in capsys.readouterr().err.splitlines()]
    found = [line["pattern"] for line in told if "pattern" in line]
    assert len(found) >= 2
    assert [one["for_hands"] for one in found] == sorted(one["for_hands"] for one in found)
    assert found[0]["tolerance_mm"] == 0
    assert all({"stage", "fraction"} <= line.keys() for line in told), "so that programs which know no patterns go on"
    assert [line["fraction"] for line in told] == sorted(line["fraction"] for line in told)


def test_a_batch_tells_how_far_outlines_are_off(bumpy: str) -> None:
    assert {"off_by_mm", "for_hands"} <= set(COLUMNS)
    options = ["--effort", "fast", "--folds", "10", "--quiet", "--jobs", "1"]
    assert main(["batch", bumpy, "-o", "out", *options]) == 0
    with Path("out/results.csv").open(newline="") as file:
        (values,) = csv.DictReader(file)
    assert 0 < float(values["off_by_mm"]) < 4
    assert values["for_hands"] == "True"
    assert ">drawing<" in Path("out/contact-sheet.svg").read_text()


def test_what_was_not_tried_has_no_numbers_and_as_many_folds_are_said_so(result: Result) -> None:
    ladder = result.ladder
    assert ladder is not None
    not_tried = replace(ladder.level, folds=None, tried=None, laid=None, corners=0, off_by_mm=0.0, failure="not tried")
    row = level_report(not_tried, quick=True)
    assert row["off_by_mm"] is None
    assert row["corners"] is None
    same = replace(ladder, levels=(ladder.level, ladder.level), taken=0)
    text = "\n".join(make_lines(make_report(replace(result, ladder=same), [])))
    assert "would take as many folds, the shortest crease" in text
    one_fold = replace(ladder.level, folds=1, known=(Phase(1, together=False),))
    one = replace(ladder, levels=(ladder.level, one_fold), taken=0)
    text = "\n".join(make_lines(make_report(replace(result, ladder=one), [])))
    assert "would take 1 fold instead of " in text


def test_corners_that_moved_in_the_drawing_as_it_is_are_said(as_drawn: Result) -> None:
    ladder = as_drawn.ladder
    assert ladder is not None
    moved = replace(ladder, levels=(replace(ladder.level, off_by_mm=0.411),), taken=0)
    text = "\n".join(make_lines(make_report(replace(as_drawn, ladder=moved), [])))
    assert "outline   as drawn, but for corners moved by up to 0.411 mm; " in text
