"""Names of any kind, files of any kind, and inputs that a batch would write over."""

from __future__ import annotations

import csv
import json
import os
from pathlib import Path

import pytest

from foldcut.batch.drawings import find_drawings
from foldcut.batch.journal import JOURNAL, Journal
from foldcut.batch.results import RESULTS
from foldcut.batch.run import run_batch
from foldcut.batch.worker import Outcome, Process, Recipe, Task, work
from foldcut.core.errors import BadInputError
from foldcut.output.atomic import InputError

FOLD = Recipe({"sheet": "60x60", "effort": "fast", "exact": True}, endings=(".json",))
SQUARE = b'{"loops": [[[0, 0], [20, 0], [20, 20], [0, 20]]]}'
NAMES = (b"caf\xe9.json", b"\xff\xfe.json", b"a\x1b[31m.json", b"line\nbreak.json", b"\xed\xa0\x80.json")


@pytest.fixture(autouse=True)
def here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make files at once, with the name of the drawing in them."""
    monkeypatch.setattr(Process, "run", lambda _self, _recipe, task, _timeout: outcome_of(task))


def outcome_of(task: Task) -> Outcome:
    """Return an outcome with a file and an error that have the drawing's name."""
    return Outcome("made", f"{task.name}: \ud800", files={f"{task.stem}.json": b"made"})


def draw(folder: Path, *names: bytes) -> Path:
    """Write a square under each name."""
    folder.mkdir(parents=True)
    for name in names:
        with open(os.fsencode(folder) + b"/" + name, "wb") as file:
            file.write(SQUARE)
    return folder


def statuses(out: Path) -> dict[str, str]:
    """Return the status of each drawing by the last part of its path, as the table has it."""
    with (out / RESULTS).open(newline="", encoding="utf-8") as file:
        return {row["file"].rpartition("/")[2]: row["status"] for row in csv.DictReader(file)}


def test_names_that_are_no_text_have_their_row_and_are_not_done_twice(tmp_path: Path) -> None:
    icons, out = draw(tmp_path / "icons", *NAMES), tmp_path / "out"
    first = run_batch([icons], out, FOLD, jobs=1)
    assert first.counts == {"made": len(NAMES)}
    assert len(statuses(out)) == len(NAMES)
    assert len(list(out.glob("*.json"))) == len(NAMES)
    again = run_batch([icons], out, FOLD, jobs=1)
    assert again.resumed == len(NAMES)
    assert [row["file"] for row in again.rows] == [row["file"] for row in first.rows]
    for line in (out / JOURNAL).read_bytes().splitlines():
        json.loads(line)  # any program can read it


def test_a_journal_of_an_earlier_version_with_such_names_is_read(tmp_path: Path) -> None:
    head = b'{"foldcut_batch": 1, "recipe": "r"}\n'
    (tmp_path / JOURNAL).write_bytes(head + b'{"stem": "caf\xe9"}\n[]\n7\n{"stem": 7}\n{"stem": "b"}\n')
    with Journal(tmp_path / JOURNAL, "r", replace=False) as journal:
        assert [*journal.rows] == ["caf\udce9", "b"]


@pytest.mark.parametrize("text", [b"notes of mine\n", b"notes of mine", b"[]\n", b'{"a": 1}\n', b"\xff\n"])
def test_a_file_that_is_no_journal_is_left_alone(text: bytes, tmp_path: Path) -> None:
    (tmp_path / JOURNAL).write_bytes(text)
    with pytest.raises(BadInputError, match="is no journal of a batch; move it away"):
        Journal(tmp_path / JOURNAL, "r", replace=False)
    assert (tmp_path / JOURNAL).read_bytes() == text


def test_a_pattern_of_names_with_dots_writes_inside_the_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    draw(tmp_path / "here/deep/icons", b"a.json")
    draw(tmp_path / "b", b"b.json")
    monkeypatch.chdir(tmp_path / "here")
    for pattern in ("*/../../b/*.json", "deep/*/../../../b/*.json", "d*/icons/../../../*/b.json", "../*/b.json"):
        items = find_drawings([pattern], tmp_path / "out")
        assert items
        assert all(".." not in Path(item.stem).parts and not Path(item.stem).is_absolute() for item in items)


def test_pipes_and_devices_get_their_row(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.json")
    draw(tmp_path / "icons", b"a.json")
    run_batch([tmp_path / "icons", tmp_path / "pipe.json", "/dev/zero"], tmp_path / "out", FOLD, jobs=1)
    assert statuses(tmp_path / "out") == {"a.json": "made", "pipe.json": "bad-input", "zero": "bad-input"}
    with pytest.raises(BadInputError, match="a batch cannot read standard input"):
        run_batch(["/dev/stdin"], tmp_path / "out", FOLD)


def test_no_drawing_of_a_batch_is_replaced(tmp_path: Path) -> None:
    icons, out = draw(tmp_path / "icons", b"a.json", b"b.json", b"c.json"), tmp_path / "out"
    out.mkdir()
    (out / "a.json").symlink_to(icons / "a.json")
    (out / "b.json").hardlink_to(icons / "c.json")
    run_batch([icons], out, FOLD, jobs=1, replace=True)
    assert statuses(out) == {"a.json": "bad-input", "b.json": "bad-input", "c.json": "made"}
    assert all((icons / name).read_bytes() == SQUARE for name in ("a.json", "b.json", "c.json"))


@pytest.mark.parametrize("name", [JOURNAL, RESULTS, "contact-sheet.svg"])
def test_no_drawing_is_replaced_by_the_table_the_journal_or_the_contact_sheet(name: str, tmp_path: Path) -> None:
    icons, out = draw(tmp_path / "icons", b"a.json"), tmp_path / "out"
    out.mkdir()
    (out / name).symlink_to(icons / "a.json")
    with pytest.raises(InputError):
        run_batch([icons], out, FOLD, jobs=1, replace=True)
    assert (icons / "a.json").read_bytes() == SQUARE


def test_a_batch_into_its_own_folder_says_so(tmp_path: Path) -> None:
    icons = draw(tmp_path / "icons", b"a.json")
    (tmp_path / "link").symlink_to(icons)
    for out in (icons, tmp_path / "link"):
        with pytest.raises(BadInputError, match="no drawings but those in .*, where files are written to"):
            find_drawings([icons / "*.json"], out)


def test_the_real_work_takes_such_names(tmp_path: Path) -> None:
    done = work(Recipe({"sheet": "60x60", "exact": True}), Task("caf\udce9\x1b.json", "caf\udce9\x1b", SQUARE))
    assert (done.status, [*done.files]) == ("made", ["caf\udce9\x1b.svg", "caf\udce9\x1b.fold"])
    for data in done.files.values():
        assert "\x1b" not in data.decode()
