"""No command replaces a file that it reads, and none waits for a device or a pipe."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.places import ROOT

from foldcut.cli.main import main
from foldcut.core.errors import FileFormatError
from foldcut.foldfile.read import read_fold

TRIANGLE = '<svg viewBox="0 0 9 9"><path d="M1 1L8 1L8 8Z"/></svg>'
FAST = ("--exact", "--sheet", "60x60")
READ = "it is read"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Run in a folder with a drawing, links to it, and a profile of the user's own."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "d.svg").write_text(TRIANGLE)
    (tmp_path / "d.pdf").symlink_to("d.svg")
    (tmp_path / "d.html").hardlink_to("d.svg")
    profile = (ROOT / "profiles/laser-dxf.toml").read_text()
    (tmp_path / "mine.toml").write_text(profile)
    (tmp_path / "job.dxf").symlink_to("mine.toml")
    (tmp_path / "Mine.ttf").write_bytes(b"font")
    (tmp_path / "font.svg").symlink_to("Mine.ttf")
    (tmp_path / "out").mkdir()
    (tmp_path / "out/d.svg").symlink_to("../d.svg")
    return tmp_path


COMMANDS = [
    ("make", "d.svg", "-o", "d.svg"),
    ("make", "d.svg", "-o", "."),
    ("make", "d.svg", "-o", "out"),
    ("make", "d.svg", "-o", "o.svg", "--preview", "d.svg"),
    ("make", "d.svg", "-o", "o.svg", "--preview", "out/d.svg"),
    ("make", "d.svg", "-o", "o.fold", "-o", "d.pdf"),
    ("make", "d.svg", "--profile", "mine.toml", "-o", "job.dxf"),
    ("make", "--text", "A", "--font", "Mine.ttf", "-o", "font.svg"),
    ("view", "d.svg"),
    ("draw", "d.svg", "-o", "d.svg"),
    ("draw", "d.svg", "-o", "out/../d.svg"),
    ("guide", "d.svg", "-o", "d.pdf"),
    ("coupon", "--profile", "mine.toml", "-o", "job.dxf"),
]


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
@pytest.mark.parametrize("force", [True, False])
def test_no_command_replaces_what_it_reads(
    words: tuple[str, ...], force: bool, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    fast = () if words[0] == "coupon" else FAST
    assert main([*words, *fast, *(["--force"] if force else [])]) == 2
    error = capsys.readouterr().err
    assert READ in error
    assert error.count("\n") == 1
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before


def test_the_file_behind_standard_input_is_not_replaced(folder: Path) -> None:
    for name in ("-", "/dev/stdin"):
        with (folder / "d.svg").open("rb") as file:
            ran = subprocess.run(
                [sys.executable, "-m", "foldcut.cli", "make", name, "--from", "svg", *FAST, "-o", "d.svg", "--force"],
                stdin=file,
                capture_output=True,
                text=True,
                check=False,
            )
        assert (ran.returncode, READ in ran.stderr, ran.stderr.count("\n")) == (2, True, 1)
    assert (folder / "d.svg").read_text() == TRIANGLE


def test_a_pattern_is_not_replaced_by_what_is_made_of_it(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["make", "d.svg", *FAST, "-o", "p.fold", "--quiet"]) == 0
    whole = (folder / "p.fold").read_bytes()
    (folder / "p.html").hardlink_to("p.fold")
    for words in (["make", "p.fold", "-o", "p.fold"], ["make", "p.fold", "-o", "."], ["view", "p.fold"]):
        assert main([*words, "--force"]) == 2
        assert READ in capsys.readouterr().err
    assert (folder / "p.fold").read_bytes() == whole


@pytest.mark.parametrize("path", ["/dev/zero", "/dev/null", "pipe.svg", "pipe.fold"])
def test_devices_and_pipes_are_refused_at_once(path: str, capsys: pytest.CaptureFixture[str]) -> None:
    if path.startswith("pipe"):
        os.mkfifo(path)
    for words in (["make", path], ["make", path, "--from", "svg"], ["check", path], ["check", path, "--shape", path]):
        assert main(words) == 2
        error = capsys.readouterr().err
        assert "is not an ordinary file; give one, or - for standard input" in error
        assert error.count("\n") == 1


def test_standard_input_goes_by_its_other_name_too(folder: Path) -> None:
    for name in ("-", "/dev/stdin"):
        made = [sys.executable, "-m", "foldcut.cli", "make", name, "--from", "svg", *FAST, "-o", "o.fold", "--force"]
        subprocess.run(made, input=TRIANGLE.encode(), check=True, stdout=subprocess.DEVNULL)
        checked = [sys.executable, "-m", "foldcut.cli", "check", name]
        subprocess.run(checked, input=(folder / "o.fold").read_bytes(), check=True, stdout=subprocess.DEVNULL)


def test_a_fold_file_without_end_is_not_read_whole(tmp_path: Path) -> None:
    with (tmp_path / "huge.fold").open("wb") as file:
        file.truncate(2**40)
    with pytest.raises(FileFormatError, match="give one of at most 128 MiB"):
        read_fold(tmp_path / "huge.fold")


def test_a_number_of_thousands_of_digits_is_told_without_a_remedy_for_programmers(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "n.json").write_text('{"loops": [[[0, 0], [%s, 0], [0, 1]]]}' % ("9" * 5000))
    shutil.copy("n.json", "n.fold")
    (folder / "deep.fold").write_text("[" * 100_000)
    for words, says in (
        (["make", "n.json"], "a number has thousands of digits"),
        (["check", "n.fold"], "a number has thousands of digits"),
        (["check", "deep.fold"], "brackets are nested too deep"),
    ):
        assert main([*words, "--json"]) == 2
        out, error = capsys.readouterr()
        assert says in error
        assert "sys.set_int" not in error
        assert json.loads(out)["error"]["type"] == "FileFormatError"
