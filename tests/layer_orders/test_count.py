"""The layer orders that are counted, against numbers that others have found."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.flat_patterns import Document, stamps, strip, twist

from foldcut.cli.main import main
from foldcut.foldfile.decide import decide, states_of
from foldcut.foldfile.read import read_fold
from foldcut.layer_orders import count


def counted(document: Document, folder: Path) -> tuple[int, tuple[int, ...]] | None:
    path = folder / "counted.fold"
    path.write_text(json.dumps(document))
    file = read_fold(path)
    decision = decide(file)
    assert decision.folds
    states = states_of(file, decision)
    return states and (states.number, states.parts)


@pytest.mark.parametrize(
    ("columns", "rows", "ways"),
    # OEIS A000136 and A001415: ways of folding a strip, or two strips side by side, of labelled stamps
    [(2, 1, 2), (3, 1, 6), (4, 1, 16), (5, 1, 50), (6, 1, 144), (2, 2, 8), (3, 2, 60), (4, 2, 320), (3, 3, 1368)],
)
def test_stamps_are_folded_in_as_many_ways_as_are_known(columns: int, rows: int, ways: int, tmp_path: Path) -> None:
    found = counted(stamps(columns, rows), tmp_path)
    assert found is not None
    assert found[0] == ways


def test_parts_that_do_not_depend_on_each_other_are_counted_apart(tmp_path: Path) -> None:
    assert counted(strip((10, 30, 10), "VV"), tmp_path) == (1, ())
    assert counted(strip((20, 30, 20), "VV"), tmp_path) == (2, (2,))  # two flaps, one over the other or under it
    assert counted(strip((20, 30, 20, 100, 20, 30, 20), "VVMMVV"), tmp_path) == (4, (2, 2))
    assert counted(twist(4, 45, "MVM"), tmp_path) == (1, ())


def test_what_is_listed_and_what_is_counted_is_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(count, "MOST_LISTED", 3)
    for columns, rows, ways in ((5, 1, 50), (2, 2, 8), (3, 2, 60)):
        found = counted(stamps(columns, rows), tmp_path)
        assert found is not None
        assert found[0] == ways


def test_a_count_is_given_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(count, "MOST_LISTED", 3)
    monkeypatch.setattr(count, "MOST_NODES", 3)
    assert counted(stamps(6, 1), tmp_path) is None
    monkeypatch.setattr(count, "MOST_TRIPLES", 3)
    assert counted(stamps(5, 1), tmp_path) is None


def test_states_are_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a.fold"
    path.write_text(json.dumps(stamps(4, 1)))
    assert main(["check", str(path), "--states"]) == 0
    assert "states    16" in capsys.readouterr().out
    assert main(["check", str(path), "--states", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["states"] == 16
