"""A file that is read is never replaced, by whatever path it is named."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from foldcut.core.files import identity, read_bytes
from foldcut.output.atomic import InputError, Inputs, check_targets, write_files


def named_otherwise(way: str, folder: Path) -> Path:
    """Return another path to the file ``d.svg`` of a folder."""
    drawing, other = folder / "d.svg", folder / "other.svg"
    if way == "as it is":
        return drawing
    if way == "through a folder":
        (folder / "sub").mkdir()
        return folder / "sub" / ".." / "d.svg"
    if way == "a link":
        other.symlink_to(drawing)
    elif way == "a link to a link":
        (folder / "between").symlink_to("d.svg")
        other.symlink_to(folder / "between")
    elif way == "a hard link":
        other.hardlink_to(drawing)
    elif way == "a link to the folder":
        (folder / "door").symlink_to(folder, target_is_directory=True)
        return folder / "door" / "d.svg"
    return other


WAYS = ("as it is", "through a folder", "a link", "a link to a link", "a hard link", "a link to the folder")


@pytest.mark.parametrize("way", WAYS)
def test_an_input_is_not_replaced(way: str, tmp_path: Path) -> None:
    drawing = tmp_path / "d.svg"
    drawing.write_bytes(b"drawing")
    target = named_otherwise(way, tmp_path)
    inputs = Inputs([drawing, tmp_path / "there is none"])
    for act in (check_targets, write_files):
        with pytest.raises(InputError, match=r"it is read.*, and would be lost; write to another name or folder"):
            act({tmp_path / "new.fold": b"new", target: b"new"}, replace=True, inputs=inputs)  # type: ignore[operator]
    assert drawing.read_bytes() == b"drawing"
    assert not (tmp_path / "new.fold").exists()
    write_files({target.with_name("new.svg"): b"new"}, replace=True, inputs=inputs)  # the remedy


def test_an_input_is_told_as_such_without_force_too(tmp_path: Path) -> None:
    (tmp_path / "d.svg").write_bytes(b"drawing")
    with pytest.raises(InputError):  # not that --force would help
        check_targets([tmp_path / "d.svg"], inputs=Inputs([tmp_path / "d.svg"]))


def test_an_output_that_becomes_the_input_meanwhile_is_not_written(tmp_path: Path) -> None:
    drawing, output = tmp_path / "d.svg", tmp_path / "o.svg"
    drawing.write_bytes(b"drawing")
    inputs = Inputs([drawing])
    check_targets([output], replace=True, inputs=inputs)
    output.symlink_to(drawing)
    with pytest.raises(InputError):
        write_files({output: b"new"}, replace=True, inputs=inputs)
    assert drawing.read_bytes() == b"drawing"


def test_names_that_differ_in_case_alone_are_one_file_where_the_system_says_so(tmp_path: Path) -> None:
    (tmp_path / "d.svg").write_bytes(b"drawing")
    same = (tmp_path / "D.SVG").exists()
    assert (identity(tmp_path / "d.svg") == identity(tmp_path / "D.SVG")) == same


@pytest.mark.parametrize("kind", ["pipe", "device", "endless device"])
def test_what_is_no_ordinary_file_is_not_read(kind: str, tmp_path: Path) -> None:
    path = {"pipe": tmp_path / "pipe", "device": Path("/dev/null"), "endless device": Path("/dev/zero")}[kind]
    if kind == "pipe":
        os.mkfifo(path)
    with pytest.raises(ValueError, match="is not an ordinary file; give one, or - for standard input"):
        read_bytes(path, 10)


def test_no_more_is_read_than_is_allowed(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"1234567")
    assert read_bytes(tmp_path / "a", 3) == b"1234"
