"""What SECURITY.md promises: no command opens a connection, and none a file that a drawing refers to."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

WATCHED = """
import sys

def watch(event, arguments):
    connects = event in ("socket.connect", "socket.bind", "socket.getaddrinfo", "urllib.Request")
    if connects or (event == "open" and "/secret." in f"/{arguments[0]}"):
        print("SEEN", event, arguments[0], file=sys.stderr)

sys.addaudithook(watch)
from foldcut.cli.main import main
sys.exit(main(sys.argv[1:]))
"""

DRAWING = """<svg xmlns="http://www.w3.org/2000/svg" xmlns:x="http://www.w3.org/1999/xlink" viewBox="0 0 9 9">
<style>@import url("secret.css"); @import url("http://127.0.0.1:9/secret.css");
path {{ fill: url(secret.svg#a) }}</style>
<image href="secret.png" width="3" height="3"/><image x:href="http://127.0.0.1:9/secret.png" width="3" height="3"/>
<use x:href="secret.svg#a"/><use href="file://{folder}/secret.svg#a"/><path d="M1 1L8 1L8 8Z"/></svg>"""
ENTITY = '<!DOCTYPE svg [<!ENTITY e SYSTEM "secret.txt">]><svg viewBox="0 0 9 9"><path d="M1 1L8 1L8 8Z"/>&e;</svg>'


def watched(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run a command that tells of connections, and of files that are called secret."""
    command = [sys.executable, "-c", WATCHED, *words, "--exact", "--sheet", "60x60"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=120)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Give a folder with what the drawings refer to."""
    for name in ("secret.css", "secret.png", "secret.svg", "secret.txt"):
        (tmp_path / name).write_text('<svg viewBox="0 0 9 9"><path id="a" d="M1 1L8 1L8 8Z"/></svg>')
    (tmp_path / "d.svg").write_text(DRAWING.format(folder=tmp_path))
    (tmp_path / "e.svg").write_text(ENTITY)
    return tmp_path


def test_no_reference_is_followed_and_no_connection_is_opened(folder: Path) -> None:
    outputs = [word for ending in ("svg", "fold", "html", "pdf", "dxf") for word in ("-o", f"o.{ending}")]
    done = watched(folder, "make", "d.svg", *outputs)
    assert (done.returncode, done.stderr) == (0, "")
    assert "external reference" in done.stdout
    assert "external style sheet" in done.stdout
    for ending in ("svg", "html"):
        assert "127.0.0.1" not in (folder / f"o.{ending}").read_text()


def test_an_entity_in_another_file_is_refused(folder: Path) -> None:
    done = watched(folder, "make", "e.svg")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "XML entities that are in other files" in done.stderr


def test_what_is_opened_would_be_seen(folder: Path) -> None:
    assert "SEEN open secret.svg" in watched(folder, "make", "secret.svg").stderr
