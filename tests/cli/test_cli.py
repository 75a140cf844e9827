"""The command line: what it prints and writes, its exit status, and that no error leaves anything behind."""

from __future__ import annotations

import io
import json
import os
import signal
import subprocess
import sys
import time
import zipfile
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from support.patterns import square_out_of_square
from support.places import ROOT
from support.recipes import without_recipe

from foldcut import pipeline
from foldcut.cli.console import Console
from foldcut.cli.main import main
from foldcut.cli.progress import ProgressBar, ProgressLines, progress_for
from foldcut.core.arrays import points_array
from foldcut.core.model import Finding, Sheet
from foldcut.exporters import export
from foldcut.methods import METHODS
from foldcut.proof.verify import CHECKS
from foldcut.redraw import ladder
from foldcut.samples import sample_names

SQUARE = {"loops": [[[0, 0], [40, 0], [40, 40], [0, 40]]], "title": "Square"}
SMALL = ["--sheet", "60x60"]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Run in an empty folder of its own."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def drawing(folder: Path) -> str:
    """Give a drawing that folds fast."""
    (folder / "box.json").write_text(json.dumps(SQUARE))
    return "box.json"


def names(folder: Path) -> set[str]:
    """Return the names of all files in a folder, hidden ones too."""
    return {path.name for path in folder.iterdir()}


def run_json(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, dict[str, Any]]:
    """Run a command with --json and return its status and what it printed."""
    status = main([*arguments, "--json"])
    report: dict[str, Any] = json.loads(capsys.readouterr().out)
    return status, report


def assert_one_line(error: str) -> None:
    """Check that standard error has one line, in the form that programs look for."""
    assert error.startswith("foldcut: error: ")
    assert error.count("\n") == 1


def test_make_writes_the_files_and_says_what_was_verified(
    folder: Path, drawing: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["make", drawing, *SMALL, "-o", "box.svg", "-o", "box.fold"]) == 0
    out, error = capsys.readouterr()
    assert error == ""
    assert "  verified  arrays, planar, kawasaki, maekawa, closure, layers, " in out
    assert f"box.svg ({(folder / 'box.svg').stat().st_size:,} bytes)" in out
    assert names(folder) == {"box.json", "box.svg", "box.fold"}


def test_make_without_output_names_files_after_the_drawing(
    folder: Path, drawing: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["make", drawing, *SMALL]) == 0
    assert "box-creases.svg" in capsys.readouterr().out
    assert names(folder) == {"box.json", "box-creases.svg", "box-creases.fold"}


def test_what_is_made_of_a_pattern_is_named_after_its_drawing(folder: Path, drawing: str) -> None:
    assert main(["make", drawing, *SMALL, "--quiet"]) == 0
    (folder / "box-creases.svg").unlink()
    for command in ("make", "view", "draw", "guide"):
        assert main([command, "box-creases.fold", "--quiet"]) == 0
    assert names(folder) == {
        "box.json",
        "box-creases.fold",
        "box-creases.svg",
        "box.html",
        "box-pictures.svg",
        "box-guide.pdf",
    }


def test_make_says_which_file_it_replaced(drawing: str, capsys: pytest.CaptureFixture[str]) -> None:
    _, first = run_json(capsys, "make", drawing, *SMALL, "-o", "box.svg")
    _, second = run_json(capsys, "make", drawing, *SMALL, "-o", "box.svg", "--force")
    assert [report["files"][0]["replaced"] for report in (first, second)] == [False, True]
    main(["make", drawing, *SMALL, "-o", "box.svg", "--force"])
    assert "bytes, replaced)" in capsys.readouterr().out


def test_nothing_is_replaced_without_force(
    folder: Path, drawing: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(pipeline, "fold", lambda *_, **__: pytest.fail("folded first"))
    (folder / "box.svg").write_text("old")
    (folder / "out").mkdir()
    (folder / "out/box.fold").write_text("old")
    (folder / "coupon-glowforge.svg").write_text("old")
    for arguments in (
        ["make", drawing, "-o", "new.fold", "-o", "box.svg"],
        ["make", drawing, "-o", "out"],
        ["coupon", "--profile", "glowforge"],
    ):
        assert main(arguments) == 2
        error = capsys.readouterr().err
        assert_one_line(error)
        assert "it is there already; replace it with --force" in error
    assert (folder / "box.svg").read_text() == (folder / "out/box.fold").read_text() == "old"
    assert names(folder) == {drawing, "box.svg", "out", "coupon-glowforge.svg"}
    assert main(["coupon", "--profile", "glowforge", "--force", "--quiet"]) == 0


def test_what_make_writes_again_says_force() -> None:
    lines = (ROOT / "Makefile").read_text().splitlines()
    assert all("--force" in line for line in lines if "foldcut make" in line and " -o " in line)


def test_make_takes_a_sample_by_name_even_beside_a_folder_of_that_name(folder: Path) -> None:
    (folder / "triangle").mkdir()
    assert main(["make", "triangle", "-o", "t.svg", "--quiet"]) == 0


def test_report_for_programs_agrees_with_the_file(drawing: str, capsys: pytest.CaptureFixture[str]) -> None:
    status, report = run_json(capsys, "make", drawing, *SMALL, "-o", "box.fold", "--sheet", "80x60", "--scale", "1:2")
    fold = json.loads(Path("box.fold").read_text())
    assert (status, report["ok"], report["findings"]) == (0, True, [])
    assert report["title"] == fold["file_title"] == "Square"
    assert report["mountains"] == fold["edges_assignment"].count("M")
    assert report["valleys"] == fold["edges_assignment"].count("V")
    assert report["creases"] == report["mountains"] + report["valleys"]
    assert report["faces"] == len(fold["faces_vertices"])
    assert report["sheet"] == {"name": "", "width_mm": 80.0, "height_mm": 60.0}
    assert report["scale_mm_per_unit"] == pytest.approx(0.5)
    assert report["files"][0]["bytes"] == Path("box.fold").stat().st_size
    assert report["seconds"].keys() >= {"build", "verify"}
    assert report["verified"] == list(CHECKS)
    ends = np.array(fold["vertices_coords"])[fold["edges_vertices"]]
    lengths = np.hypot(*(ends[:, 0] - ends[:, 1]).T)[np.array(fold["edges_assignment"]) != "B"]
    assert report["shortest_crease_mm"] == pytest.approx(lengths.min())


def test_placement_options_move_the_shape(drawing: str) -> None:
    options = ["--offset", "-1,2cm", "--margin", "0mm", "--scale", "0.5", "--rotate", "90"]
    assert main(["make", drawing, *SMALL, "-o", "a.svg", "--quiet", *options]) == 2
    options[1] = "15,2cm"
    assert main(["make", drawing, *SMALL, "-o", "a.fold", "--quiet", *options]) == 0
    placement = np.array(json.loads(Path("a.fold").read_text())["foldcut:placement"])
    corners = np.array(SQUARE["loops"][0]) @ placement[:, :2].T + placement[:, 2]
    np.testing.assert_allclose(corners.min(axis=0), [15, 20], atol=1e-9)
    np.testing.assert_allclose(corners.max(axis=0), [35, 40], atol=1e-9)


def test_quiet_prints_nothing(drawing: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["make", drawing, *SMALL, "-o", "box.svg", "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")


BAD_INPUT = {
    "there is no such file; give a drawing or one of the samples": ["make", "nowhere.svg"],
    "nosample: there is no such file": ["make", "nosample"],
    "is a folder": ["make", "."],
    "cannot write .xyz files; use one of .fold, .svg": ["make", "box.json", "-o", "a.xyz"],
    "needs an ending": ["make", "box.json", "-o", "a"],
    "its folder does not exist": ["make", "box.json", "-o", "a.svg", "-o", "missing/a.fold"],
    "is named twice": ["make", "box.json", "-o", "a.svg", "-o", "./a.svg"],
    "own.svg: it is read, and would be lost": ["make", "own.svg", "-o", "own.svg"],
    "is not a sheet": ["make", "box.json", "--sheet", "a99"],
    "is not a length": ["make", "box.json", "--margin", "wide"],
    "is not a scale": ["make", "box.json", "--scale", "1:0"],
    "is not a pair": ["make", "box.json", "--offset", "3"],
    "--rotate left is not an angle; give degrees such as 45, or best": ["make", "box.json", "--rotate", "left"],
    "invalid choice: 'origami'": ["make", "box.json", "--method", "origami"],
    "invalid choice: 'some'": ["make", "box.json", "--effort", "some"],
    "time to search is -1.0 s": ["make", "box.json", "--seconds", "-1"],
    "'thin' is not a length": ["make", "box.json", "--simplify", "thin"],
    "'short' is not a length": ["make", "box.json", "--min-crease", "short"],
    "unrecognized arguments: --colour": ["make", "box.json", "--colour", "red"],
    "unrecognized arguments: --shet a4; did you mean --sheet?": ["make", "box.json", "--shet", "a4"],
    "fihs: there is no such file; did you mean the sample fish?": ["make", "fihs"],
    "out/: there is no such folder; create it first": ["make", "box.json", "-o", "out/"],
    "with --profile, .svg, .dxf": ["make", "box.json", "-o", "a.docx"],
    "'-5mm' is not a length": ["make", "box.json", "--margin", "-5mm"],
    "--rotate -45deg is not an angle": ["make", "box.json", "--rotate", "-45deg"],
    "nowhere.ttf: there is no such font file": ["make", "--font", "nowhere.ttf", "--text", "-Z"],
    "the threshold is 2; give a number from 0": ["make", "box.json", "--threshold", "2"],
    "--two-sided goes with a machine": ["make", "box.json", "--two-sided"],
    "--tile is for a machine, and plain is not one": ["make", "box.json", "--profile", "plain", "--tile"],
    "own.svg is a file, and a batch is written into a folder": ["batch", "box.json", "-o", "own.svg"],
    "there is no command 'maek'; did you mean make?": ["maek", "box.json"],
    "there is no command 'box.json'; choose one of make, view,": ["box.json"],
    "such as foldcut make own.svg": ["own.svg", "--sheet", "a5"],
    "unrecognized arguments: b.svg; give one drawing": ["make", "own.svg", "b.svg"],
    "unrecognized arguments: b.fold; see foldcut check --help": ["check", "a.fold", "b.fold"],
    "-5.json: there is no such file": ["make", "--quiet", "--", "-5.json"],
    "a preview is SVG": ["make", "box.json", "--preview", "p.txt"],
    "give a SHAPE or a --text": ["make", ""],
    "required: COMMAND": [],
    "broken.json: ": ["make", "broken.json"],
    "broken.fold: ": ["check", "broken.fold"],
    "missing.fold: ": ["check", "missing.fold"],
}


@pytest.mark.parametrize("message", BAD_INPUT)
def test_bad_input_is_one_line_and_status_2_and_writes_nothing(
    message: str, folder: Path, drawing: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "broken.json").write_text("{")
    (folder / "broken.fold").write_text("{")
    (folder / "own.svg").write_text('<svg viewBox="0 0 9 9"><path d="M1 1L8 1L8 8Z"/></svg>')
    before = names(folder)
    assert main(BAD_INPUT[message]) == 2
    out, error = capsys.readouterr()
    assert out == ""
    assert_one_line(error)
    assert message in error
    assert names(folder) == before


@pytest.mark.parametrize(
    ("loop", "words"),
    [
        ([[0, 0], [1, 1]], "fewer than 3 corners"),
        ([[0, 0], [10, 0], [20, 0]], "encloses no area"),
        ([[0, 0], [10, 0], [1e308, 1e308]], "below 1e+100"),
        ([[0, 0], [1, 0], [0, "one"]], "two numbers"),
    ],
)
def test_what_is_wrong_in_a_drawing_is_told_with_its_name(
    folder: Path, loop: list[object], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "wrong.json").write_text(json.dumps({"loops": [loop]}))
    assert main(["make", "wrong.json"]) == 2
    error = capsys.readouterr().err
    assert_one_line(error)
    assert error.startswith("foldcut: error: wrong.json: ")
    assert words in error
    assert error.count("wrong.json") == 1


def test_errors_are_reported_to_programs_too(capsys: pytest.CaptureFixture[str]) -> None:
    status, report = run_json(capsys, "make", "nowhere.svg")
    assert (status, report["ok"], report["findings"]) == (2, False, [])
    assert report["error"]["type"] == "BadInputError"
    assert "nowhere.svg" in report["error"]["message"]
    status, report = run_json(capsys, "make")
    assert (status, report["ok"]) == (2, False)
    assert "SHAPE" in report["error"]["message"]


def test_bad_paths_of_the_outputs_are_found_before_the_long_work(drawing: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pipeline, "fold", lambda *_, **__: pytest.fail("folded first"))
    Path("mine").mkdir()
    Path("mine/README.txt").write_text("not foldcut's")
    for output in ("a.xyz", "missing/a.svg", "mine", "missing/a.zip"):
        assert main(["make", drawing, *SMALL, "-o", output]) == 2
    for options in (["--marks", "stars"], ["--registration", "pins"], ["--two-sided", "--registration", "pins"]):
        assert main(["make", drawing, *SMALL, *options]) == 2


def test_a_folder_and_an_archive_hold_all_files_and_say_what_they_are(
    folder: Path, drawing: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("out").mkdir()
    job = ["--profile", "laser-dxf", "--two-sided", "--registration", "holes", "--marks", "outline,title"]
    assert main(["make", drawing, *SMALL, *job, "-o", "out", "-o", "both.zip"]) == 0
    stem = Path(drawing).stem
    assert {path.name for path in Path("out").iterdir()} == {f"{stem}-front.dxf", f"{stem}-back.dxf", "README.txt"}
    with zipfile.ZipFile("both.zip") as archive:
        assert set(archive.namelist()) == {"both-front.dxf", "both-back.dxf", "README.txt"}
        alone = Path(f"out/{stem}-front.dxf").read_bytes()
        assert without_recipe(archive.read("both-front.dxf")) == without_recipe(alone)
        text = archive.read("README.txt").decode()
    for words in ("1. both-front.dxf: front", "2. both-back.dxf: back", "Do the front first", "Import the DXF"):
        assert words in text
    capsys.readouterr()
    assert main(["make", drawing, *SMALL, "-o", "out", "--force"]) == 0, "its own README.txt may be replaced"
    assert {f"{stem}.svg", f"{stem}.fold", f"{stem}.png"} <= {path.name for path in Path("out").iterdir()}
    text = Path("out/README.txt").read_text()
    assert f"1. {stem}.svg: the pattern, at true size" in text
    assert "in the order" not in text, "none comes before another"


def break_verification(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let verification find something in every pattern."""
    finding = Finding("layers", "faces 3 and 4 cross", (12.5, 7.0), 0.25)
    for module in (pipeline, ladder):
        monkeypatch.setattr(module, "verify", lambda *_: [finding, finding])


def test_a_pattern_that_is_not_verified_is_not_written(
    folder: Path, drawing: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    break_verification(monkeypatch)
    assert main(["make", drawing, *SMALL, "-o", "box.svg"]) == 1
    out, error = capsys.readouterr()
    assert "NOT VALID layers at (12.5, 7): faces 3 and 4 cross" in out
    assert_one_line(error)
    assert "nothing is written" in error
    assert names(folder) == {drawing}
    status, report = run_json(capsys, "make", drawing, *SMALL, "-o", "box.svg")
    assert (status, report["ok"], report["verified"], report["files"]) == (1, False, [], [])
    assert report["error"]["type"] == "VerificationError"
    assert report["findings"][0] == {
        "check": "layers",
        "message": "faces 3 and 4 cross",
        "place": [12.5, 7.0],
        "size": 0.25,
    }


@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)], ids=["ctrl-c", "sigterm"])
def test_an_interrupt_while_writing_leaves_the_old_files_and_no_others(
    folder: Path,
    drawing: str,
    number: signal.Signals,
    status: int,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (folder / "box.svg").write_text("old")
    monkeypatch.setattr(os, "fsync", lambda _: signal.raise_signal(number))
    before = signal.getsignal(signal.SIGTERM)
    assert main(["make", drawing, *SMALL, "-o", "box.svg", "-o", "box.fold", "--force"]) == status
    assert_one_line(capsys.readouterr().err)
    assert (folder / "box.svg").read_text() == "old"
    assert names(folder) == {drawing, "box.svg"}
    assert signal.getsignal(signal.SIGTERM) is before


IGNORING = """
import os, signal, sys
signal.signal(signal.SIGINT, signal.SIG_IGN)  # as a shell without job control does for what it runs in the background
from foldcut.cli.main import main
os.fsync = lambda _: signal.raise_signal(signal.SIGINT)
sys.exit(main(sys.argv[1:]))
"""


def test_ctrl_c_works_where_the_parent_ignores_it(folder: Path, drawing: str) -> None:
    command = [sys.executable, "-c", IGNORING, "make", drawing, *SMALL, "-o", "box.svg"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 130
    assert_one_line(done.stderr)
    assert names(folder) == {drawing}


def test_check_accepts_what_make_wrote_and_rejects_another_shape(
    drawing: str, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["make", drawing, *SMALL, "-o", "box.fold", "--quiet"])
    assert main(["check", "box.fold"]) == 0
    assert "taco-taco\n" in capsys.readouterr().out  # the check before the cut
    status, report = run_json(capsys, "check", "box.fold", "--shape", drawing)
    assert (status, report["ok"], report["verified"][-1]) == (0, True, "cut")
    assert main(["check", "box.fold", "--shape", "triangle"]) == 1
    out, error = capsys.readouterr()
    assert "NOT VALID cut" in out
    assert_one_line(error)


def test_check_says_how_far_an_outline_that_was_drawn_anew_is_from_the_drawing(
    drawing: str, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["make", drawing, *SMALL, "-o", "box.fold", "--quiet"])
    data = json.loads(Path("box.fold").read_text())
    x, y = data["foldcut:placement"][0][2], data["foldcut:placement"][1][2]
    data["foldcut:placement"][0][2], data["foldcut:placement"][1][2] = x + 0.3, y + 0.4
    Path("moved.fold").write_text(json.dumps(data))
    assert main(["check", "moved.fold", "--shape", drawing]) == 1
    error = capsys.readouterr().err
    assert "the outline was moved from the drawing by 0.5 mm, and the file states " in error


def test_check_finds_a_flipped_crease(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    fold = json.loads(export(square_out_of_square(), ".fold"))
    path = folder / "pattern.fold"
    path.write_text(json.dumps(fold))
    assert main(["check", "pattern.fold", "--quiet"]) == 0
    fold["edges_assignment"][fold["edges_assignment"].index("M")] = "V"
    path.write_text(json.dumps(fold))
    status, report = run_json(capsys, "check", "pattern.fold")
    assert (status, report["ok"], report["verified"]) == (1, False, [])
    assert report["findings"]
    assert report["error"]["message"].startswith("the pattern does not fold flat: maekawa")


def test_report_says_how_hard_the_pattern_is_to_fold(drawing: str, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["make", drawing, *SMALL, "--method", "paper", "-o", "box.fold", "--force"]
    status, report = run_json(capsys, *arguments)
    assert status == 0
    assert report["lines"] <= report["creases"]
    assert report["thickness_mm"] == pytest.approx(report["layers"] * 0.1)
    assert report["layers"] >= report["layers_at_cut"] > 0
    assert report["sheet_used"] == pytest.approx(40**2 / 60**2)
    assert report["ribbon_mm"] == 0.25
    short, thick, many = report["warnings"]
    assert short.startswith("the shortest crease, at ")
    assert thick.startswith(f"the cut goes through {report['layers_at_cut']} layers")
    assert main(arguments) == 0
    out = capsys.readouterr().out
    assert "ribbon 0.25 mm (this method needs one)" in out
    assert "44% of it is the shape" in out
    assert f"; on {report['lines']} lines\n" in out
    assert f"{report['layers']} at the thickest place, about {report['thickness_mm']:.3g} mm of office paper" in out
    assert many.startswith(f"nobody folds {report['actions']:,} folds by hand; they come of --method paper: without it")
    assert report["difficulty"]["grade"] == "not for hands"
    assert f"  warning   {short}\n  warning   {thick}\n  warning   {many}\n" in out
    _, report = run_json(capsys, "make", drawing, *SMALL, "-o", "box.fold", "--force")
    assert (report["warnings"], report["difficulty"]["grade"]) == ([], "beginner")


def test_simplification_is_reported(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "bumpy.json").write_text(json.dumps({"loops": [[[0, 0], [20, 0.2], [40, 0], [40, 40], [0, 40]]]}))
    arguments = ["make", "bumpy.json", *SMALL, "--scale", "1", "--method", "paper", "-o", "b.fold"]
    assert main([*arguments, "--simplify", "0.05cm"]) == 0
    assert "  note      simplified: 5 -> 4 corners, at most 0.2 mm off\n" in capsys.readouterr().out


def test_too_short_a_crease_is_status_1_and_writes_nothing(
    folder: Path, drawing: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["make", drawing, *SMALL, "--method", "paper", "--min-crease", "2cm"]) == 1
    error = capsys.readouterr().err
    assert_one_line(error)
    assert "shorter than 20 mm" in error
    assert names(folder) == {drawing}


def fake_search(monkeypatch: pytest.MonkeyPatch, *, interrupted: bool = False) -> dict[str, Any]:
    """Let the search for a compact pattern find the square of ``patterns``; return what it was called with."""
    seen: dict[str, Any] = {}
    pattern = square_out_of_square()

    def fold_compact(loop: np.ndarray, sheet: Sheet, **options: Any) -> Any:
        seen.update(options, loop=loop, sheet=sheet)
        options["progress"]("searching: 8 creases", 0.5)
        tried = 3
        try:
            if interrupted:
                signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt:
            tried = 2
        # as large as the square is in the frame, and around it
        scale, middle = np.ptp(loop, axis=0).max() / 40, loop.mean(axis=0)
        coords = points_array((pattern.creases.vertices_coords - 24) * scale + middle)
        return SimpleNamespace(
            creases=replace(pattern.creases, vertices_coords=coords),
            folded=replace(pattern.folded, vertices_coords=points_array(pattern.folded.vertices_coords * scale)),
            walk=None,
            molecules=None,
            tried=tried,
            interrupted=interrupted,
        )

    monkeypatch.setattr("foldcut.methods.compact.method.fold_compact", fold_compact)
    monkeypatch.setattr("foldcut.methods.compact.method.regions", lambda *_: ())
    return seen


COMPACT = ["--sheet", "48x48", "--margin", "4mm", "--method", "compact", "-o", "box.fold", "--force"]


def test_the_search_is_given_the_options(
    drawing: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    seen = fake_search(monkeypatch)
    status, report = run_json(capsys, "make", drawing, *COMPACT, "--effort", "fast", "--seconds", "2.5")
    assert status == 0
    assert (seen["effort"], seen["ribbon"]) == ("fast", 0.0)
    assert 0 < float(seen["seconds"]) < 2.5  # the rest is for other tolerances  # type: ignore[arg-type]
    run_json(capsys, "make", drawing, *COMPACT, "--seconds", "2.5", "--exact")
    assert seen["seconds"] == 2.5
    assert np.ptp(seen["loop"], axis=0).tolist() == [190, 190]  # as large as fits on A4
    assert (report["method"], report["tried"], report["interrupted"], report["creases"]) == ("compact", 3, False, 8)
    assert report["ribbon_mm"] == 0
    fake_search(monkeypatch)
    assert main(["make", drawing, *COMPACT]) == 0
    assert "best of 3 tried" in capsys.readouterr().out


def test_an_interrupted_search_goes_on_to_verify_and_write(
    folder: Path, drawing: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    fake_search(monkeypatch, interrupted=True)
    assert main(["make", drawing, *COMPACT]) == 0
    out = capsys.readouterr().out
    assert "interrupted: compact, best of 2 tried" in out
    assert "  verified  " in out
    assert names(folder) == {drawing, "box.fold"}


def test_compact_patterns_have_a_shortest_crease_by_default(
    drawing: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(METHODS, "compact", replace(METHODS["compact"], min_crease_mm=30.0))
    fake_search(monkeypatch)
    assert main(["make", drawing, *COMPACT]) == 1
    assert "is only 24 mm long, shorter than 30 mm" in capsys.readouterr().err
    assert main(["make", drawing, *COMPACT, "--min-crease", "24mm"]) == 0


def test_progress_shows_the_best_count_so_far(monkeypatch: pytest.MonkeyPatch) -> None:
    fake_search(monkeypatch)
    seen: list[tuple[str, float]] = []
    pipeline.fold(
        SQUARE["loops"],  # type: ignore[arg-type]
        "48x48",
        margin=4,
        method="compact",
        progress=lambda stage, part: seen.append((stage, part)),
    )
    parts = dict(seen)
    assert parts["reading"] < parts["searching: 8 creases"] < parts["searching"] < 1
    assert seen[-1] == ("verify", 1.0)


def test_check_takes_the_drawing_as_it_lies_when_the_file_has_no_placement(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pattern = square_out_of_square()
    fold = json.loads(export(pattern, ".fold"))
    del fold["foldcut:placement"]
    (folder / "pattern.fold").write_text(json.dumps(fold))
    loops = [(loop / 10).tolist() for loop in pattern.shape.loops]
    (folder / "cm.json").write_text(json.dumps({"loops": loops, "units": "cm"}))
    status, report = run_json(capsys, "check", "pattern.fold", "--shape", "cm.json")
    assert (status, report["ok"]) == (0, True)
    assert report["notes"] == [
        "foldcut:placement is missing: the drawing is taken to lie on the sheet as drawn, in mm, y up"
    ]


def test_samples_lists_names_that_make_takes(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["samples"]) == 0
    listed = capsys.readouterr().out.split()
    assert {"fish", "triangle"} <= set(listed)
    status, report = run_json(capsys, "samples")
    assert (status, report["ok"], report["samples"]) == (0, True, listed)
    assert report["difficulty"]["star"] == "5 minutes, beginner"


def test_the_long_list_of_samples_has_the_easiest_first_and_each_once(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["samples", "--long"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert sorted(line.split()[0] for line in lines) == list(sample_names(lines=True))
    order = [line.split()[0] for line in lines]
    assert (
        order.index("triangle") < order.index("star") < order.index("tree") < order.index("heart") < order.index("fish")
    )


@pytest.mark.parametrize("name", ["triangle", "star", "heart"])
def test_what_the_list_of_samples_says_is_what_folding_them_takes(
    name: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    _, listed = run_json(capsys, "samples")
    status, report = run_json(capsys, "make", name, "-o", "sample.fold")
    assert (status, report["difficulty"]["text"].partition(" (")[0]) == (0, listed["difficulty"][name])


def test_view_writes_a_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["view", "triangle", "--effort", "fast", "--quiet"]) == 0
    assert [path.name for path in tmp_path.iterdir()] == ["triangle.html"]
    assert (tmp_path / "triangle.html").read_bytes().startswith(b"<!DOCTYPE html>")


@pytest.mark.parametrize("command", [[], ["make"], ["view"], ["draw"], ["guide"], ["serve"], ["check"], ["samples"]])
def test_help_has_examples(command: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main([*command, "--help"])
    assert stop.value.code == 0
    assert f"examples:\n  foldcut {(command or ['make'])[0]}" in capsys.readouterr().out


def foldcut(*arguments: str, **options: Any) -> subprocess.CompletedProcess[str]:
    """Run the command line as a process of its own."""
    command = [sys.executable, "-m", "foldcut.cli", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False, **options)


def test_the_process_exits_with_the_status_and_prints_no_traceback(drawing: str) -> None:
    done = foldcut("make", drawing, *SMALL, "-o", "box.svg")
    assert (done.returncode, done.stderr) == (0, "")
    failed = foldcut("make", "ring-that-is-not-there")
    assert failed.returncode == 2
    assert_one_line(failed.stderr)


def test_nothing_but_the_report_is_printed_not_even_by_libraries(drawing: str) -> None:
    done = foldcut("make", drawing, *SMALL, "-o", "box.svg", "--effort", "fast", "--json")
    assert json.loads(done.stdout)["ok"] is True
    assert done.stderr == ""


def test_titles_print_on_terminals_without_unicode(folder: Path) -> None:
    (folder / "u.json").write_text(json.dumps({**SQUARE, "title": "方"}))
    done = foldcut("make", "u.json", *SMALL, "-o", "u.svg", env={**os.environ, "PYTHONIOENCODING": "ascii"})
    assert (done.returncode, done.stderr) == (0, "")


def test_a_reader_that_stops_reading_causes_no_traceback() -> None:
    read, write = os.pipe()
    os.close(read)
    command = [sys.executable, "-m", "foldcut.cli", "samples"]
    done = subprocess.run(command, stdout=write, stderr=subprocess.PIPE, text=True, timeout=60, check=False)
    os.close(write)
    assert done.stderr == ""


def test_start_up_imports_nothing_slow() -> None:
    program = "import sys, foldcut.cli.main; print(sorted({'numpy', 'scipy', 'shapely', 'rich'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_progress_is_drawn_on_stderr_only_when_it_takes_long(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with ProgressBar(enabled=True) as bar:
        bar("packing", 0.5)
    assert capsys.readouterr() == ("", "")
    monkeypatch.setattr("foldcut.cli.progress.PATIENCE_S", -1.0)
    monkeypatch.setenv("FORCE_COLOR", "1")  # rich takes any stream for a terminal then
    with ProgressBar(enabled=False) as bar:
        bar("packing", 0.5)
    assert capsys.readouterr() == ("", "")
    with ProgressBar(enabled=True) as bar:
        bar("packing", 0.5)
        bar("layers", 1.0)
    out, error = capsys.readouterr()
    assert out == ""
    assert "layers" in error


def test_without_a_terminal_a_line_tells_the_progress_every_few_seconds(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("FOLDCUT_NO_PROGRESS")
    with progress_for(Console(as_json=False)) as progress:
        progress("packing", 0.25)
    assert capsys.readouterr() == ("", ""), "it was done soon"
    monkeypatch.setattr("foldcut.cli.progress.EVERY_S", 0.001)
    with progress_for(Console(as_json=False)) as progress:
        progress("packing", 0.25)
        time.sleep(0.05)  # nothing new is told, and it does not look as if it hung
    out, error = capsys.readouterr()
    assert out == ""
    assert error.startswith("foldcut:   0 s, 25%: packing\n" * 2)
    monkeypatch.setenv("FOLDCUT_NO_PROGRESS", "1")
    with progress_for(Console(as_json=False)) as progress:
        progress("packing", 0.25)
        time.sleep(0.01)
    assert capsys.readouterr() == ("", "")
    monkeypatch.delenv("FOLDCUT_NO_PROGRESS")
    for silent in (Console(as_json=True), Console(as_json=False, quiet=True)):
        with progress_for(silent) as progress:
            progress("packing", 0.25)
            time.sleep(0.01)
    assert capsys.readouterr() == ("", "")


def test_lines_say_at_once_that_something_is_compiled(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("FOLDCUT_NO_PROGRESS")
    with progress_for(Console(as_json=False)) as progress:
        progress("compiling: a minute", 0.0)
    assert capsys.readouterr().err == "foldcut:   0 s,  0%: compiling: a minute\n"


@pytest.mark.parametrize(
    ("sample", "words", "phases"),
    [
        ("kite", "folds     2 simple folds\n", [{"count": 2, "together": False}]),
        (
            "letter-t",
            "folds     8: 2 simple folds, then 6 creases that close together\n"
            "            all but the first through 2 layers\n",
            [{"count": 2, "together": False}, {"count": 6, "together": True}],
        ),
    ],
)
def test_simple_folds_are_counted_and_what_is_left_to_close(
    sample: str, words: str, phases: list[dict[str, object]], capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["make", sample, "--exact", "--effort", "fast", "-o", "a.fold", "--force"]
    assert main(arguments) == 0
    assert words in capsys.readouterr().out
    assert main([*arguments, "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["phases"] == phases
    assert report["actions"] == sum(phase["count"] for phase in report["phases"])


def test_progress_for_programs_is_lines_of_json_with_every_stage(
    folder: Path, drawing: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["make", drawing, *SMALL, "--progress", "--quiet", "-o", "a.fold"]) == 0
    told = [json.loads(line) for line in capsys.readouterr().err.splitlines()]
    stages = [line["stage"].partition(":")[0] for line in told]
    assert (stages[0], stages[-1]) == ("reading", "verify")
    assert "simple folds" in stages
    found = [line["pattern"] for line in told if "pattern" in line]
    assert [(one["tolerance_mm"], one["corners"], one["failure"]) for one in found] == [(0, 4, "")]
    parts = [line["fraction"] for line in told]
    assert parts == sorted(parts)
    assert parts[0] == 0
    assert parts[-1] >= 0.98


def test_progress_for_programs_tells_a_stage_once_in_a_while(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("foldcut.cli.progress.BETWEEN_LINES_S", 1e6)
    out = io.StringIO()
    tell = ProgressLines(out)
    for step in range(1000):
        tell(f"searching: {step} creases", step / 1000)
    tell("verify", 0.0)
    assert [json.loads(line)["stage"] for line in out.getvalue().splitlines()] == ["searching: 0 creases", "verify"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--profile", "grbl-laser", "-o", "x.pdf"], "lacks what PDF needs"),
        (["--profile", "glowforge", "-o", "x.hpgl"], "lacks what HPGL needs"),
        (["--profile", "plain", "-o", "x.dxf"], ".dxf files are for a machine"),
        (["--profile", "plain", "--two-sided"], "plain is not one"),
        (["--two-sided"], "name it with --profile"),
        (["--profile", "glowforge", "--sheet", "a2"], "does not fit the machine's"),
        (["--profile", "glowforge", "--material", "felt"], "no material 'felt'"),
        (["--profile", "glowforge", "--tile"], "only printers take several pages"),
    ],
)
def test_what_is_wrong_with_a_job_is_said_before_the_search(
    arguments: list[str],
    message: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("foldcut.pipeline.fold", lambda *args, **kwargs: pytest.fail("it searched"))
    assert main(["make", "star", *arguments]) == 2
    assert message in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_job_is_written_in_the_machines_format_and_reported(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["make", "star", "--effort", "fast", "--profile", "laser-dxf", "--two-sided"]) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["star-laser-dxf-back.dxf", "star-laser-dxf-front.dxf"]
    said = capsys.readouterr().out
    assert "Any laser that takes DXF" in said
    assert "between strokes" in said


def test_thickness_is_that_of_the_material(drawing: str, capsys: pytest.CaptureFixture[str]) -> None:
    card = ["--profile", "laser-dxf", "--material", "card-300g", "-o", "box.dxf", "--force"]
    _, office = run_json(capsys, "make", drawing, *SMALL, "-o", "box.fold")
    _, thick = run_json(capsys, "make", drawing, *SMALL, *card)
    assert (office["paper"], thick["paper"]) == ("office paper", "card-300g")
    assert thick["layers"] == office["layers"]
    assert thick["thickness_mm"] == pytest.approx(4 * office["thickness_mm"])
    assert main(["make", drawing, *SMALL, *card]) == 0
    assert "mm of card-300g; " in capsys.readouterr().out


def test_profiles_are_listed_and_shown(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["profiles", "list", "AxiDraw"]) == 0
    assert {line.split("-")[0] for line in capsys.readouterr().out.split("\n\n")[0].split("\n")} == {"axidraw"}
    assert main(["profiles", "list", "nothing"]) == 2
    assert "foldcut profiles lists all" in capsys.readouterr().err
    assert main(["profiles"]) == 0
    assert "glowforge" in capsys.readouterr().out
    assert main(["profiles", "show", "glowforge", "--set", "kerf_mm=0.1"]) == 0
    assert '"kerf_mm": 0.1' in capsys.readouterr().out
    assert main(["profiles", "validate"]) == 2
    assert "needs the name" in capsys.readouterr().err


def test_a_drawing_is_as_wide_or_high_as_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "box.json").write_text('{"loops": [[[0, 0], [40, 0], [40, 20], [0, 20]]]}')
    command = ["make", "box.json", "--effort", "fast", "-o", "box.fold", "--force", "--sheet", "100x220mm"]
    for options, width, height in (
        (["--width", "5cm", "--rotate", "0"], 50, 25),
        (["--height", "30", "--width", "70mm"], 60, 30),
        ([], 80, 160),
    ):
        assert main([*command, *options]) == 0
        report = capsys.readouterr().out
        assert ("turned by a quarter, so that it has more room on the sheet" in report) == (not options)
        placed = (
            np.array([[0, 0], [40, 20]])
            @ np.array(json.loads((tmp_path / "box.fold").read_text())["foldcut:placement"])[:, :2].T
        )
        assert np.abs(np.diff(placed, axis=0)[0]).tolist() == pytest.approx([width, height])
    assert main([*command, "--rotate", "best", "--quiet"]) == 0
    for options, fault in (
        (["--scale", "2", "--height", "30"], "--scale and --height both say how large the drawing is; give one"),
        (["--width", "0mm"], "the width of the drawing is 0 mm; give a length above 0"),
        (["--width", "95mm", "--rotate", "0"], "the sheet 100 x 220 mm leaves 80.0 x 200.0 mm"),
        (["--rotate", "half"], "--rotate half is not an angle; give degrees such as 45, or best"),
    ):
        assert main([*command, *options]) == 2
        assert fault in capsys.readouterr().err
