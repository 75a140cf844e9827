"""``foldcut view`` opens the page where somebody can see it, and nowhere else."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from foldcut.cli.main import main


@pytest.fixture
def opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Give the addresses that the browser was sent to, on a machine with a terminal and a screen."""
    addresses: list[str] = []
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    monkeypatch.setattr("webbrowser.open", lambda address: addresses.append(address) or True)
    return addresses


def test_view_opens_the_page_that_it_wrote(opened: list[str], tmp_path: Path) -> None:
    assert main(["view", "triangle", "--effort", "fast"]) == 0
    assert opened == [(tmp_path / "triangle.html").resolve().as_uri()]
    assert (tmp_path / "triangle.html").is_file()


@pytest.mark.parametrize("words", [["--no-open"], ["-o", "page.html"], ["--json"], ["--quiet"], ["-o", "t.svg"]])
def test_view_opens_nothing_where_that_is_not_wanted(opened: list[str], words: list[str]) -> None:
    assert main(["view", "triangle", "--effort", "fast", *words]) == 0
    assert opened == []


def test_nothing_is_opened_without_a_screen_or_a_terminal(opened: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY")
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    assert main(["view", "triangle", "--effort", "fast"]) == 0
    monkeypatch.setenv("WAYLAND_DISPLAY", "wayland-0")
    monkeypatch.setattr(sys.stdout, "isatty", lambda: False, raising=False)
    assert main(["view", "triangle", "--effort", "fast", "--force"]) == 0
    assert opened == []


def test_nothing_is_opened_where_nothing_was_written(opened: list[str], tmp_path: Path) -> None:
    (tmp_path / "triangle.html").write_text("mine")
    assert main(["view", "triangle", "--effort", "fast"]) == 2
    assert main(["make", "triangle", "--effort", "fast"]) == 0
    assert opened == []


def test_a_browser_that_is_not_there_is_no_error(opened: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    import webbrowser

    def fails(address: str) -> bool:
        raise webbrowser.Error("could not locate runnable browser")

    monkeypatch.setattr("webbrowser.open", fails)
    assert main(["view", "triangle", "--effort", "fast"]) == 0
