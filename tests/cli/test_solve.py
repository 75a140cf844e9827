"""``foldcut solve`` writes what it has found and proven."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.flat_patterns import Document, stamps, strip, twist

from foldcut.cli.main import main
from foldcut.foldfile.judge import judge
from foldcut.foldfile.read import read_fold


def sheet(document: Document) -> Document:
    """Return the pattern on a sheet that machines take."""
    document["vertices_coords"] = [[40 * x, 40 * y] for x, y in document["vertices_coords"]]
    return document


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("stamps.fold").write_text(json.dumps(sheet(stamps(3, 2))))
    Path("twist.fold").write_text(json.dumps(twist(4, 45, "MVM")))
    return tmp_path


def test_a_pattern_without_letters_is_solved_and_valid_for_everybody(folder: Path) -> None:
    assert main(["solve", "stamps.fold"]) == 0
    solved = read_fold(folder / "stamps-solved.fold")
    assert judge(solved) == []
    assert solved.own_layers
    assert "U" not in solved.pattern.edges_assignment
    document = json.loads((folder / "stamps-solved.fold").read_text())
    del document["foldcut:layers"]
    (folder / "other.fold").write_text(json.dumps(document))
    assert judge(read_fold(folder / "other.fold")) == []  # faceOrders alone prove it


def test_every_kind_of_file_is_written(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    names = ["a.fold", "a.svg", "a.cp", "a.opx", "a.png", "a.html", "a.pdf", "a.dxf", "a.zip"]
    outputs = [word for name in names for word in ("-o", name)]
    assert main(["solve", "stamps.fold", *outputs]) == 0
    assert all((folder / name).stat().st_size > 300 for name in names)
    for name in ("a.cp", "a.opx"):
        assert main(["check", name]) == 0
    assert main(["solve", "stamps.fold", "-o", "b.gcode", "--profile", "grbl-laser", "--width", "9cm"]) == 0
    assert main(["solve", "stamps.fold", "-o", "c.svg", "--profile", "axidraw-a4", "--two-sided"]) == 0
    assert (folder / "c-front.svg").exists()
    assert main(["solve", "stamps.fold", "-o", "a.fold"]) == 2
    assert "--force" in capsys.readouterr().err


def test_layers_in_a_circle_are_written_pair_by_pair(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", "twist.fold"]) == 0
    document = json.loads((folder / "twist-solved.fold").read_text())
    assert "foldcut:layers" not in document
    capsys.readouterr()
    assert main(["check", "twist-solved.fold"]) == 0
    assert "folds flat as the file says" in capsys.readouterr().out
    turned = [[f, g, -side] for f, g, side in document["faceOrders"]]
    (folder / "turned.fold").write_text(json.dumps(document | {"faceOrders": turned}))
    assert main(["check", "turned.fold"]) == 1
    for name, words in (("a.html", "lie on each other in a circle"), ("a.zip", "in a circle")):
        assert main(["solve", "twist.fold", "-o", name]) == 1
        assert words in capsys.readouterr().err
    assert main(["solve", "twist.fold", "-o", "a.svg"]) == 2
    assert "no rectangle; write .fold" in capsys.readouterr().err


def test_nothing_is_written_of_what_does_not_fold(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("blocked.fold").write_text(json.dumps(strip((20, 10, 20), "VV")))
    assert main(["solve", "blocked.fold"]) == 1
    assert not Path("blocked-solved.fold").exists()
    assert "paper would pass through paper" in capsys.readouterr().err
    Path("small.fold").write_text(json.dumps(stamps(2, 1) | {"frame_unit": "um"}))
    assert main(["solve", "small.fold"]) == 2
    assert "--width 150mm" in capsys.readouterr().err
    assert main(["solve", "small.fold", "--width", "150mm"]) == 0
    assert main(["solve", "small.fold", "-o", "small.fold", "--force"]) == 2
    assert main(["solve", "small.fold", "-o", "a.dxf", "--profile", "axidraw-a4", "--width", "100cm"]) == 2
    assert "with --width" in capsys.readouterr().err


def test_a_solved_pattern_cannot_be_cut(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", "stamps.fold"]) == 0
    assert main(["make", "stamps-solved.fold", "-o", "b.svg"]) == 2
    assert "what the cut cuts out" in capsys.readouterr().err


def test_with_a_machine_and_no_output_its_own_format_is_written(folder: Path) -> None:
    before = {*folder.iterdir()}
    for machine, name in (("grbl-laser", "gcode"), ("printer-a4", "pdf"), ("hp-7475a", "hpgl")):
        assert main(["solve", "stamps.fold", "--width", "9cm", "--profile", machine, "--quiet"]) == 0
        assert (folder / f"stamps-{machine}.{name}").exists()
    assert len({*folder.iterdir()} - before) == 3
