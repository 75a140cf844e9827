"""The extension for Inkscape: what is written, what it makes of Inkscape's arguments, and that Inkscape runs it."""

from __future__ import annotations

import os
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from support.programs import require_program

from foldcut.cli.main import main
from foldcut.readers import read_shape
from foldcut.samples import sample_path

QUICK = ("--sheet=a5", "--margin=15.0", "--level=", "--seconds=60")
INX = "{http://www.inkscape.org/namespace/inkscape/extension}"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "extensions"
    made.mkdir()
    assert main(["inkscape-extension", "-o", str(made), "--quiet"]) == 0
    return made


def called(folder: Path, *arguments: object) -> subprocess.CompletedProcess[bytes]:
    """Call the extension as Inkscape does."""
    command = [sys.executable, folder / "foldcut_extension.py", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, timeout=120, check=False)


def test_every_parameter_is_an_option_of_make(folder: Path) -> None:
    root = ET.parse(folder / "foldcut.inx").getroot()
    names = [param.get("name") for param in root.iter(f"{INX}param") if param.get("type") != "description"]
    assert names == [word.partition("=")[0].removeprefix("--") for word in QUICK]
    for level in root.iter(f"{INX}option"):
        assert level.get("value") is not None
    assert root.findtext(f"{INX}script/{INX}command") == "foldcut_extension.py"


def test_what_is_selected_becomes_its_pattern_and_nothing_else_is_printed(folder: Path, tmp_path: Path) -> None:
    drawing = tmp_path / "two drawings.svg"
    triangle, other = '<path id="a" d="M10 10H40L25 40Z"/>', '<path id="b" d="M60 60H90V90H60Z"/>'
    drawing.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="99mm" height="99mm">{triangle}{other}</svg>')
    done = called(folder, "--id=a", *QUICK, drawing)
    assert done.stderr == b""
    pattern = tmp_path / "pattern.svg"
    pattern.write_bytes(done.stdout)
    (shape,) = read_shape(pattern).loops[:1]
    assert len(shape) == 3
    assert b'id="shape"' in done.stdout


def test_errors_are_foldcuts_one_line(folder: Path, tmp_path: Path) -> None:
    done = called(folder, *QUICK, tmp_path / "none.svg")
    assert (done.returncode, done.stdout) == (2, b"")
    assert done.stderr.startswith(b"foldcut: error: ")
    assert done.stderr.count(b"\n") == 1
    script = folder / "foldcut_extension.py"
    script.write_text(script.read_text().replace(repr(sys.executable), repr(str(tmp_path / "gone"))))
    done = called(folder, *QUICK, sample_path("star"))
    assert done.returncode == 1
    assert b"gone: No such file or directory; run foldcut inkscape-extension again" in done.stderr


def test_inkscape_runs_it(folder: Path, tmp_path: Path) -> None:
    require_program("inkscape")
    require_program("Xvfb")
    actions = f"org.foldcut.fold.noprefs;export-filename:{tmp_path}/out.svg;export-plain-svg;export-do"
    command = ["xvfb-run", "-a", "inkscape", "--batch-process", f"--actions={actions}", str(sample_path("star"))]
    own = {**os.environ, "INKSCAPE_PROFILE_DIR": str(tmp_path)}
    subprocess.run(command, env=own, capture_output=True, timeout=120, check=True)
    text = (tmp_path / "out.svg").read_text("utf-8")
    assert 'width="297mm"' in text
    assert all(f'id="{layer}"' in text for layer in ("shape", "valley", "cut"))


def test_the_folder_has_to_be_there_and_nothing_is_replaced(
    folder: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert main(["inkscape-extension", "-o", str(tmp_path / "none")]) == 2
    assert "there is no such folder; create it first" in capsys.readouterr().err
    assert main(["inkscape-extension", "-o", str(folder)]) == 2
    assert "replace it with --force" in capsys.readouterr().err
    assert main(["inkscape-extension", "-o", str(folder), "--force"]) == 0
    assert "Extensions > Foldcut > Fold and Cut" in capsys.readouterr().out
