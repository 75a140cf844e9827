"""``foldcut check --repair`` writes the nearest pattern that folds flat exactly, and says how far that is."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from support.flat_patterns import Document, stamps, twist
from support.folded import folded_sample

from foldcut.cli.main import main
from foldcut.exporters import export
from foldcut.foldfile.read import read_fold
from foldcut.geometry.planar_graph import edge_faces
from foldcut.pattern.repair import nearest_foldable
from foldcut.profiles import load_profile


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def rounded(document: Document, digits: int) -> Document:
    """Return a pattern with rounded coordinates and without the folded form, which would be rounded as well."""
    coords = np.round(np.array(document["vertices_coords"]), digits)
    return {**document, "vertices_coords": coords.tolist(), "file_frames": []}


def tilted_twist() -> Document:
    """Return a square twist at an angle, with four digits."""
    document = twist(4, 45, "MVM")
    turn = np.array([(np.cos(0.3), -np.sin(0.3)), (np.sin(0.3), np.cos(0.3))])
    coords = np.array(document["vertices_coords"]) @ turn.T
    return rounded({**document, "vertices_coords": coords.tolist()}, 4)


def write(name: str, document: Document) -> None:
    Path(name).write_text(json.dumps(document))


def off(name: str) -> float:
    """Return how far a pattern is from one whose angles fold flat exactly, in mm."""
    pattern = read_fold(name).pattern
    moved = nearest_foldable(pattern, edge_faces(pattern))
    assert moved is not None
    return moved.most


def test_a_twist_with_few_digits_is_written_exactly(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write("a.fold", tilted_twist())
    assert main(["check", "a.fold", "--tolerance", "1e-4", "--repair", "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["moved_mm"] == pytest.approx(off("a.fold"))
    assert report["files"][0]["path"] == "a-repaired.fold"
    assert off("a.fold") > 1e-5
    assert off("a-repaired.fold") < 1e-9
    assert main(["check", "a-repaired.fold"]) == 0
    assert "no pattern near" not in capsys.readouterr().err


@pytest.mark.parametrize("digits", [3, 5])
def test_one_of_our_own_is_accepted_once_more_after_it_is_repaired(digits: int, folder: Path) -> None:
    document = json.loads(export(folded_sample("fish"), ".fold", load_profile("plain")))
    write("fish.fold", rounded(document, digits))
    assert main(["check", "fish.fold", "--repair", "-o", "b.fold"]) == 0
    assert main(["check", "b.fold"]) == 0
    assert off("fish.fold") > 1e-7
    assert off("b.fold") < 1e-9
    before, after = read_fold("fish.fold"), read_fold("b.fold")
    assert (before.pattern.edges_vertices == after.pattern.edges_vertices).all()
    assert (before.pattern.edges_assignment == after.pattern.edges_assignment).all()
    assert before.loops is not None
    assert after.loops is not None
    assert after.repaired_by == pytest.approx(off("fish.fold"), rel=0.1)


def test_unassigned_edges_stay_unassigned(folder: Path) -> None:
    document = stamps(2, 2)
    document["vertices_coords"][4] = [1.00001, 1.00002]
    write("a.fold", document)
    assert main(["check", "a.fold", "--repair", "--tolerance", "1e-3"]) == 0
    written = json.loads((folder / "a-repaired.fold").read_text())
    assert "U" in written["edges_assignment"]
    assert not {"faceOrders", "foldcut:layers"} & set(written)


def test_that_a_file_was_repaired_gives_no_more_slack_than_the_tolerance(folder: Path) -> None:
    document = json.loads(export(folded_sample("fish"), ".fold", load_profile("plain")))
    write("fish.fold", {**rounded(document, 1), "foldcut:repairedBy": 1e9})
    assert main(["check", "fish.fold"]) == 1
    write("fish.fold", {**rounded(document, 1), "foldcut:repairedBy": -1})
    assert main(["check", "fish.fold"]) == 2


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["-o", "b.fold"], "-o is for --repair, which writes the pattern; add it"),
        (["--repair", "-o", "b.cp"], "--repair writes .fold; for other formats give that file to foldcut solve"),
        (["--repair", "-o", "a.fold", "--force"], "it is read, and would be lost"),
        (["--repair", "-o", "there.fold"], "replace it with --force"),
        (["--repair", "--tolerance", "1e-9"], "would have to move by"),
    ],
)
def test_what_cannot_be_written_is_told_and_not_written(
    words: list[str], told: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write("a.fold", tilted_twist())
    Path("there.fold").write_text("mine")
    before = (folder / "a.fold").read_bytes()
    assert main(["check", "a.fold", *words]) in (1, 2)
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1
    assert (folder / "a.fold").read_bytes() == before
    assert sorted(path.name for path in folder.iterdir()) == ["a.fold", "there.fold"]
    assert Path("there.fold").read_text() == "mine"


def test_an_unassigned_edge_that_the_list_of_layers_folds_the_other_way_is_told(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    document = json.loads(export(folded_sample("star"), ".fold", load_profile("plain")))
    document.pop("edges_foldAngle")
    letters = document["edges_assignment"]
    for edge in [at for at, letter in enumerate(letters) if letter == "V"][:3]:
        write("a.fold", {**document, "edges_assignment": [*letters[:edge], "U", *letters[edge + 1 :]]})
        assert main(["check", "a.fold"]) in (0, 1)
        assert "a mistake in foldcut" not in capsys.readouterr().err
