"""``foldcut make FILE --again``: the same bytes from the recipe in a file, or one line that says why not."""

from __future__ import annotations

import io
import json
import shlex
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from support.places import ROOT

from foldcut.cli.main import main
from foldcut.exporters.recipe_place import with_recipe
from foldcut.output.recipe import Recipe

SQUARE = '<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="40mm" viewBox="0 0 40 40">%s</svg>'
DRAWING = SQUARE % '<path d="M0 0 H40 V40 H0 Z"/>'
QUICK = ("--effort", "fast", "--quiet")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("logo.svg").write_text(DRAWING)
    return tmp_path


def make(*words: str) -> None:
    assert main([*words, *QUICK]) == 0


def again(*words: str, capsys: pytest.CaptureFixture[str]) -> dict[str, object]:
    """The report of making a file again."""
    capsys.readouterr()
    assert main(["make", *words, "--json"]) == 0
    report: dict[str, object] = json.loads(capsys.readouterr().out)
    return report


def refused(*words: str, capsys: pytest.CaptureFixture[str]) -> str:
    """The error of a command that writes nothing."""
    before = {path: path.read_bytes() for path in Path().rglob("*") if path.is_file()}
    capsys.readouterr()
    assert main(["make", *words]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert before == {path: path.read_bytes() for path in Path().rglob("*") if path.is_file()}
    return error


def test_files_of_several_outputs_are_each_made_again(capsys: pytest.CaptureFixture[str]) -> None:
    names = [f"a.{ending}" for ending in ("svg", "fold", "pdf", "dxf", "html", "zip")]
    make("make", "logo.svg", "--sheet", "a5", "--rotate", "10", *(word for name in names for word in ("-o", name)))
    make("guide", "logo.svg", "-o", "guide.html")
    make("draw", "logo.svg", "--show", "folded", "-o", "picture.svg")
    assert main(["view", "a.fold", "-o", "view.html", "--quiet"]) == 0
    assert main(["coupon", "--profile", "laser-dxf", "-o", "card.zip", "--quiet"]) == 0
    for name in [*names, "guide.html", "picture.svg", "view.html", "card.zip"]:
        assert again(name, "--again", capsys=capsys)["same"] is True, name
        assert str(Path().absolute()).encode() not in Path(name).read_bytes(), "no folder of this machine"


def test_the_locale_does_not_change_what_is_made_again(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("LC_ALL", "de_DE.UTF-8")
    make("make", "logo.svg", "-o", "a.pdf")
    monkeypatch.setenv("LC_ALL", "en_US.UTF-8")
    assert again("a.pdf", "--again", capsys=capsys)["same"] is True


def test_one_side_brings_back_the_other(capsys: pytest.CaptureFixture[str]) -> None:
    make("make", "logo.svg", "--profile", "laser-dxf", "--two-sided", "-o", "a.dxf")
    back = Path("a-back.dxf").read_bytes()
    Path("a-back.dxf").unlink()
    Path("a-front.dxf").rename("front.dxf")
    report = again("front.dxf", "--again", capsys=capsys)
    assert [Path(file["path"]).name for file in report["files"]] == ["a-back.dxf"]  # type: ignore[attr-defined]
    assert Path("a-back.dxf").read_bytes() == back


def test_drawings_that_are_not_beside_the_file_are_given(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(DRAWING.encode())))
    make("make", "-", "--from", "svg", "-o", "piped.svg")
    assert "say where it is: foldcut make piped.svg --again DRAWING" in refused("piped.svg", "--again", capsys=capsys)
    assert again("piped.svg", "--again", "logo.svg", capsys=capsys)["same"] is True
    make("make", "--text", "L", "-o", "letter.svg")
    assert again("--again", "letter.svg", capsys=capsys)["same"] is True
    assert "leave logo.svg out" in refused("letter.svg", "--again", "logo.svg", capsys=capsys)
    make("make", "triangle", "-o", "sample.svg")
    assert again("sample.svg", "--again", capsys=capsys)["same"] is True


def test_own_profiles_and_fonts_have_to_be_as_they_were(capsys: pytest.CaptureFixture[str]) -> None:
    text = (ROOT / "profiles/laser-dxf.toml").read_text()
    Path("own").mkdir()
    Path("own/mine.toml").write_text(text)
    make("make", "logo.svg", "--profile", "own/mine.toml", "-o", "a.dxf")
    assert "mine.toml, for --profile of a.dxf, is not there" in refused("a.dxf", "--again", capsys=capsys)
    Path("mine.toml").write_text(text)
    assert again("a.dxf", "--again", capsys=capsys)["same"] is True
    Path("mine.toml").write_text(text + "\n")
    assert "has changed since" in refused("a.dxf", "--again", capsys=capsys)


def test_what_has_changed_is_told_and_nothing_is_replaced(capsys: pytest.CaptureFixture[str]) -> None:
    make("make", "logo.svg", "-o", "a.svg")
    data = Path("a.svg").read_bytes()
    Path("logo.svg").write_text(SQUARE % '<path d="M0 0 H40 V30 H0 Z"/>')
    assert "logo.svg has changed since a.svg was made of it" in refused("a.svg", "--again", capsys=capsys)
    Path("logo.svg").write_text(DRAWING)
    Path("a.svg").write_bytes(data + b"<!-- mine -->\n")
    assert "it was changed since" in refused("a.svg", "--again", capsys=capsys)
    Path("a.svg").write_bytes(data.replace(b'"foldcut":"', b'"foldcut":"0.0.'))
    assert "made with foldcut 0.0." in refused("a.svg", "--again", capsys=capsys)
    assert again("a.svg", "--again", "-o", "b.svg", capsys=capsys)["same"] is False
    assert Path("b.svg").read_bytes() == data
    again("a.svg", "--again", "--force", capsys=capsys)
    assert Path("a.svg").read_bytes() == data


def test_errors_say_what_to_do(capsys: pytest.CaptureFixture[str]) -> None:
    make("make", "logo.svg", "-o", "a.svg", "-o", "a.cp", "-o", "a.stl")
    assert "a .cp file has no comments" in refused("a.cp", "--again", capsys=capsys)
    assert "no more than the drawing's hash" in refused("a.stl", "--again", capsys=capsys)
    assert "or give the drawing and its options" in refused("a.stl", "--again", capsys=capsys)
    assert "foldcut did not write it" in refused("logo.svg", "--again", capsys=capsys)
    assert "there is no such file" in refused("b.svg", "--again", capsys=capsys)
    assert "--sheet: --again takes all options" in refused("a.svg", "--again", "--sheet", "a3", capsys=capsys)
    assert "give a name that ends in it" in refused("a.svg", "--again", "-o", "a.pdf", capsys=capsys)
    assert "foldcut make FILE --again" in refused("--again", capsys=capsys)


@pytest.mark.parametrize(
    "recipe",
    [
        {"command": "serve", "output": "a.svg"},
        {"command": "make", "output": "../a.svg", "drawing": "logo.svg"},
        {"command": "make", "output": "a.svg", "drawing": "/etc/hosts"},
        {"command": "make", "output": "a.svg", "drawing": "\ud800"},
        {"command": "make", "output": "a.svg", "drawing": "logo.svg", "options": ["output=../b.svg"]},
        {"command": "make", "output": "a.svg", "drawing": "logo.svg", "options": ["preview=../b.svg"]},
        {"command": "make", "output": "a.svg", "drawing": "logo.svg", "options": ["outpu=../b.svg"]},
        {"command": "make", "output": "a.svg", "options": ["text=A", "font=/etc/hosts"]},
        {"command": "make", "output": "a.svg", "drawing": "logo.svg", "options": ["profile=../x.toml"]},
        {"command": "make", "output": "..", "drawing": "logo.svg"},
        {"command": "make", "output": "a.svg", "drawing": "a\0b.svg"},
        {"command": "make", "output": "a.svg", "drawing": "logo.svg", "options": ["title=a\0b"]},
    ],
)
def test_a_recipe_that_others_wrote_reaches_no_other_files(
    recipe: dict[str, object], capsys: pytest.CaptureFixture[str]
) -> None:
    Path("sub").mkdir()
    data = with_recipe(DRAWING.replace("><", ">\n<").encode(), ".svg", json.dumps(recipe))
    Path("sub/a.svg").write_bytes(data)
    error = refused("sub/a.svg", "--again", "logo.svg", capsys=capsys)
    assert "recipe" in error


def test_a_profile_beside_the_file_is_not_replaced_by_what_is_made_of_it(capsys: pytest.CaptureFixture[str]) -> None:
    Path("mine.toml").write_text((ROOT / "profiles/laser-dxf.toml").read_text())
    make("make", "logo.svg", "--profile", "mine.toml", "--two-sided", "-o", "a.dxf")
    Path("a-back.dxf").unlink()
    Path("a-back.dxf").symlink_to("mine.toml")
    assert "it is read" in refused("a-front.dxf", "--again", "--force", capsys=capsys)


def test_a_file_beside_it_with_other_bytes_is_told_and_left(capsys: pytest.CaptureFixture[str]) -> None:
    make("make", "logo.svg", "--profile", "laser-dxf", "--two-sided", "-o", "a.dxf")
    front, back = Path("a-front.dxf"), Path("a-back.dxf")
    whole = front.read_bytes()
    back.write_bytes(b"mine")
    error = refused("a-front.dxf", "--again", capsys=capsys)
    assert "a-front.dxf is the same, but a-back.dxf beside it, made by the same command, has other bytes" in error
    front.write_bytes(whole + b"999\nmine\n")
    assert "a-front.dxf is not what its recipe makes here" in refused("a-front.dxf", "--again", capsys=capsys)
    assert again("a-front.dxf", "--again", "--force", capsys=capsys)["changed"] == ["a-back.dxf"]
    assert (front.read_bytes(), back.read_bytes()) == (whole, b"mine")
    back.unlink()
    assert again("a-front.dxf", "--again", capsys=capsys)["changed"] == []
    assert back.read_bytes() != b"mine"


def test_the_drawing_may_be_a_sample_or_come_from_standard_input(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def pipe(data: str) -> None:
        monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(data.encode())))

    make("make", "logo.svg", "-o", "a.svg")
    Path("logo.svg").unlink()
    pipe(DRAWING)
    assert again("a.svg", "--again", "-", capsys=capsys)["same"] is True
    pipe("another")
    assert "standard input is another drawing, or has changed" in refused("a.svg", "--again", "-", capsys=capsys)
    assert "is another drawing, or has changed" in refused("a.svg", "--again", "star", capsys=capsys)
    assert "there is no such file" in refused("a.svg", "--again", "b.svg", capsys=capsys)
    make("make", "triangle", "-o", "t.svg")
    assert again("t.svg", "--again", "triangle", capsys=capsys)["same"] is True


def test_the_line_of_a_recipe_runs_as_it_is_written(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("--x--.svg", "-.svg", "a b.svg"):
        Path(name).write_text(DRAWING)
        make("make", f"./{name}", "-o", "out.svg")
        run_line("out.svg", capsys=capsys)
        Path("out.svg").unlink()
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(DRAWING.encode())))
    make("make", "-", "--from", "svg", "-o", "p.svg")
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(DRAWING.encode())))
    run_line("p.svg", "logo.svg", capsys=capsys)
    make("make", "triangle", "-o", "t.svg")
    run_line("t.svg", capsys=capsys)
    Path("triangle.svg").write_text(DRAWING)
    make("make", "triangle.svg", "-o", "own.svg")
    run_line("own.svg", capsys=capsys)
    assert Recipe("solve").lines()[0].endswith("foldcut solve -")
    assert Recipe("coupon").lines()[0].endswith("foldcut coupon")


def test_a_pattern_solved_from_standard_input_is_not_made_again(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    make("make", "logo.svg", "-o", "a.fold")
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(Path("a.fold").read_bytes())))
    assert main(["solve", "-", "-o", "s.svg", "--quiet"]) == 0
    assert "give the pattern and its options instead: foldcut solve -" in refused("s.svg", "--again", capsys=capsys)


def run_line(name: str, *drawing: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Run the line that the report of ``--again`` says a file was made with."""
    data = Path(name).read_bytes()
    capsys.readouterr()
    assert main(["make", name, "--again", *drawing]) == 0
    line = next(line for line in capsys.readouterr().out.splitlines() if "Made by foldcut" in line)
    Path(name).unlink()
    make(*shlex.split(line.partition(": ")[2])[1:], "-o", name)
    assert Path(name).read_bytes() == data
