"""The journal: records survive, a line cut short does not, and a batch has it for itself."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from foldcut.batch.journal import Journal
from foldcut.core.errors import BadInputError


def test_the_last_record_of_a_stem_counts_and_a_line_cut_short_is_removed(tmp_path: Path) -> None:
    path = tmp_path / "journal"
    with Journal(path, "recipe", replace=False) as journal:
        assert journal.rows == {}
        journal.add("a", {"status": "error"})
        journal.add("b", {"status": "made"})
        journal.add("a", {"status": "made", "name": "ü"})
        assert [*journal.added()] == ["a", "b"]
    whole = path.read_bytes()
    path.write_bytes(whole + b'{"stem": "c", "sta')
    with Journal(path, "recipe", replace=False) as journal:
        assert {stem: record["status"] for stem, record in journal.rows.items()} == {"a": "made", "b": "made"}
        assert journal.added() == {}
    assert path.read_bytes() == whole
    assert json.loads(whole.splitlines()[0]) == {"foldcut_batch": 1, "recipe": "recipe"}


def test_a_garbled_line_costs_only_itself(tmp_path: Path) -> None:
    path = tmp_path / "journal"
    with Journal(path, "recipe", replace=False) as journal:
        journal.add("a", {})
    path.write_bytes(path.read_bytes() + b"\x00\xff\n" + b'{"stem": "b"}\n')
    with Journal(path, "recipe", replace=False) as journal:
        assert [*journal.rows] == ["a", "b"]


def test_a_journal_is_one_recipes_and_one_batchs(tmp_path: Path) -> None:
    path = tmp_path / "journal"
    with Journal(path, "recipe", replace=False), pytest.raises(BadInputError, match="another batch is writing"):
        Journal(path, "recipe", replace=False)
    with pytest.raises(BadInputError, match="made with other options"):
        Journal(path, "other", replace=False)
    with Journal(path, "other", replace=True) as journal:
        assert journal.rows == {}
