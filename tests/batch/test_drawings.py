"""A drawing of a batch: its bytes and their hash, or what is wrong with its file."""

from __future__ import annotations

import hashlib
from pathlib import Path

import pytest

from foldcut.batch.drawings import Item, find_drawings
from foldcut.core.errors import BadInputError


def test_a_drawing_is_read_no_further_than_its_size_matters(tmp_path: Path) -> None:
    path = tmp_path / "a.svg"
    path.write_bytes(b"0123456789")
    task, digest, error = Item(path, "a").read(4)
    assert task is not None
    assert (task.name, task.stem, task.data, error) == (str(path), "a", b"01234", "")
    assert digest == hashlib.sha256(b"01234").hexdigest()


def test_a_drawing_that_is_gone_says_so(tmp_path: Path) -> None:
    task, digest, error = Item(tmp_path / "gone.svg", "gone").read(4)
    assert (task, digest) == (None, "")
    assert "No such file or directory; check the path" in error


def test_patterns_of_names_keep_the_folders_below_the_fixed_part(tmp_path: Path) -> None:
    for name in ("x/a.svg", "x/y/b.svg", "x/y/.hidden.svg", "x/notes.txt"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    out = tmp_path / "out"
    assert [item.stem for item in find_drawings([str(tmp_path / "x/**/*.svg")], out)] == ["a", "y/b"]
    assert [item.stem for item in find_drawings([tmp_path / "x"], out)] == ["a", "y/b"]
    with pytest.raises(BadInputError, match="no drawings"):
        find_drawings([tmp_path / "x"], tmp_path / "x")
