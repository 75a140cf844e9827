"""``--so-far``: patterns that are found while the search goes on."""

from __future__ import annotations

from pathlib import Path

import pytest

from foldcut.cli.main import main


def test_the_pattern_so_far_is_written_and_can_be_opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "so.fold").write_text("an earlier one")
    words = ["make", "triangle", "--effort", "fast", "--quiet", "-o", "t.fold"]
    assert main([*words, "--so-far", "so.fold"]) == 0
    assert main(["check", "so.fold", "--quiet"]) == 0
    with_it = (tmp_path / "t.fold").read_bytes()
    assert main([*words, "--force"]) == 0
    assert (tmp_path / "t.fold").read_bytes() == with_it, "it has no part in the recipe"


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["make", "triangle", "--so-far", "x.dxf"], "--so-far x.dxf: give a name that ends in one of .fold, .svg"),
        (["make", "t.json", "--so-far", "t.svg"], "t.svg"),
        (["make", "triangle", "--so-far", "none/x.svg"], "none"),
        (["make", "triangle", "--so-far", "out.svg"], "out.svg is named twice"),
        (["draw", "triangle", "--so-far", "out.svg"], "out.svg is named twice"),
        (["make", "p.fold", "--so-far", "x.svg"], "--so-far: only for drawings"),
        (["make", "p.fold", "--again", "--so-far", "x.svg"], "--so-far: --again takes all options from the file"),
    ],
)
def test_so_far_is_refused(
    words: list[str], told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "t.json").write_text("[[0,0],[1,0],[0,1]]")
    (tmp_path / "t.svg").symlink_to("t.json")
    assert main(["make", "triangle", "--effort", "fast", "--quiet", "-o", "p.fold"]) == 0
    assert main([*words, "-o", "out.svg"]) == 2
    assert told in capsys.readouterr().err
    assert not (tmp_path / "out.svg").exists()
    assert (tmp_path / "t.json").read_text() == "[[0,0],[1,0],[0,1]]"
