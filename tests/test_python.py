"""foldcut in Python: what it offers, what ``fold`` takes, and that a result saves what the command line writes."""

from __future__ import annotations

import doctest
from dataclasses import replace
from pathlib import Path

import pytest

import foldcut
from foldcut import options
from foldcut.cli.main import main
from foldcut.exporters import export
from foldcut.jobs.arrange import BedLayout
from foldcut.jobs.tabs import Tabs
from foldcut.profiles import load_profile
from foldcut.samples import sample_path

QUICK = foldcut.Options(sheet="a5", margin="15mm", effort="fast")


@pytest.fixture(scope="module")
def star() -> foldcut.Result:
    return foldcut.fold("star", QUICK)


def test_the_package_shows_what_it_offers() -> None:
    assert {"fold", "check", "Result", "Options", "JobOptions", "FoldcutError"} <= set(dir(foldcut))
    for name in dir(foldcut):
        assert getattr(foldcut, name).__doc__


@pytest.mark.parametrize("module", [foldcut, options])
def test_the_examples_in_docstrings_are_true(module: object) -> None:
    done = doctest.testmod(module)  # type: ignore[arg-type]
    assert done.attempted
    assert not done.failed


def test_a_sample_a_path_and_loops_are_folded_alike(star: foldcut.Result, tmp_path: Path) -> None:
    own = tmp_path / "star"  # a file goes before the sample of its name
    own.write_bytes(b"[[[0,0],[40,0],[0,30]]]")
    drawing = foldcut.fold(sample_path("star"), "a5", margin=15, effort="fast")
    assert export(drawing.folded_pattern, ".fold") == export(star.folded_pattern, ".fold")
    assert star.drawing is not None
    loops = foldcut.fold(star.drawing.loops, replace(QUICK, margin=15.0))
    assert loops.folded_pattern.creases.crease_count == star.folded_pattern.creases.crease_count
    with pytest.raises(foldcut.FileFormatError, match="star: drawings do not end in ''"):
        foldcut.fold(str(own))
    with pytest.raises(foldcut.FileFormatError, match="triangel: there is no such file; did you mean the sample"):
        foldcut.fold("triangel")


def test_what_is_given_by_name_goes_before_the_options() -> None:
    asked = QUICK.but({"sheet": "a6", "margin": "1cm"})
    assert (asked.sheet, asked.margin, asked.effort) == ("a6", "1cm", "fast")
    assert foldcut.fold("star", "a5", sheet="a6", effort="fast").options.sheet == "a6"
    with pytest.raises(TypeError, match=r"no option 'mergin'; did you mean 'margin'\?"):
        foldcut.fold("star", mergin=3)
    with pytest.raises(foldcut.SheetError, match="'3 ells' is not a length"):
        foldcut.fold("star", margin="3 ells")
    with pytest.raises(foldcut.SheetError, match="1:0 is not a scale"):
        foldcut.fold("star", scale="1:0")


def test_a_result_is_told_in_one_line(star: foldcut.Result) -> None:
    assert (
        repr(star)
        == "<Result Five-pointed star on A5 landscape (210 x 148 mm): 4 folds, 10 creases by simple, verified>"
    )
    assert "<svg" in (star._repr_svg_() or "")
    assert "<iframe" in star._repr_html_()


@pytest.mark.parametrize(
    ("name", "machine", "job", "words"),
    [
        ("a.svg", None, None, ()),
        ("a.fold", None, None, ()),
        ("a.html", None, None, ()),
        ("a.pdf", None, None, ()),
        ("a.dxf", "lightburn-co2", None, ("--profile=lightburn-co2",)),
        ("a.dxf", None, foldcut.JobOptions(treatment="perforate"), ("--profile=laser-dxf", "--treatment=perforate")),
        (
            "a.gcode",
            "grbl-laser",
            foldcut.JobOptions(material="card-160g", layout=BedLayout((10.0, 25.5), 1), tabs=Tabs(4, 0.5), framed=True),
            ("--profile=grbl-laser", "--material=card-160g", "--at=10mm,25.5mm", "--tabs=4x0.5mm", "--frame"),
        ),
        (
            "a.svg",
            "axidraw-a4",
            foldcut.JobOptions(marks=("outline", "title"), two_sided=True, registration="corners"),
            ("--profile=axidraw-a4", "--two-sided", "--registration=corners", "--marks=outline,title"),
        ),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_saved_files_have_the_bytes_of_the_command_line(
    star: foldcut.Result,
    name: str,
    machine: str | None,
    job: foldcut.JobOptions | None,
    words: tuple[str, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("foldcut.pipeline.fold", lambda *_, **__: star)  # it is folded already
    written = {path.name: path.read_bytes() for path in star.save(tmp_path / name, machine, job)}
    (tmp_path / "line").mkdir()
    asked = ("star", "--sheet=a5", "--margin=15mm", "--effort=fast", "-o", str(tmp_path / "line" / name))
    assert main(["make", *asked, *words]) == 0
    assert written == {path.name: path.read_bytes() for path in (tmp_path / "line").iterdir()}


def test_a_guide_is_saved_as_the_command_line_writes_it(
    star: foldcut.Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("foldcut.pipeline.fold", lambda *_, **__: star)
    guide = star.save_guide(tmp_path / "a.html")
    (tmp_path / "line").mkdir()
    made = tmp_path / "line" / "a.html"
    assert main(["guide", "star", "--sheet=a5", "--margin=15mm", "--effort=fast", "-o", str(made)]) == 0
    assert guide.read_bytes() == made.read_bytes()
    with pytest.raises(foldcut.BadInputError, match="guides are PDF, HTML or animated SVG"):
        star.save_guide(tmp_path / "a.png")


def test_what_is_saved_is_made_again_and_never_replaced_by_itself(star: foldcut.Result, tmp_path: Path) -> None:
    (saved,) = star.save(tmp_path / "a.svg")
    assert main(["make", str(saved), "--again"]) == 0
    with pytest.raises(foldcut.BadInputError, match=r"a\.svg: it is there already; replace it with force=True"):
        star.save(saved)
    assert star.save(saved, force=True) == (saved,)


def test_what_cannot_be_saved_is_refused_before_a_byte_is_written(star: foldcut.Result, tmp_path: Path) -> None:
    for name, machine, job, error in (
        ("a.xyz", None, None, "cannot write .xyz files"),
        ("a.gcode", None, None, "name it with --profile"),
        ("a.svg", None, foldcut.JobOptions(tile=True), "needs a machine; name one, such as profile='laser-dxf'"),
        ("a.dxf", "laser-xyz", None, "laser-xyz"),
    ):
        with pytest.raises(foldcut.BadInputError, match=error):
            star.save(tmp_path / name, machine, job)
    wrong = replace(star, findings=(foldcut.Finding("cut", "it is wrong", (1.0, 2.0), 1.0),))
    assert "not verified" in repr(wrong)
    with pytest.raises(foldcut.VerificationError):
        wrong.save(tmp_path / "a.svg")
    assert list(tmp_path.iterdir()) == []


def test_a_profile_that_was_changed_is_in_no_recipe(star: foldcut.Result, tmp_path: Path) -> None:
    (saved,) = star.save(tmp_path / "a.dxf", load_profile("laser-dxf", ["kerf_mm=0.3"]))
    assert b"foldcut recipe" not in saved.read_bytes()
    (saved,) = star.save(tmp_path / "b.dxf", "laser-dxf")
    assert b"profile=laser-dxf" in saved.read_bytes().replace(b"\n999\n", b"")


def test_patterns_are_checked_with_and_without_their_drawing(star: foldcut.Result, tmp_path: Path) -> None:
    (saved,) = star.save(tmp_path / "a.fold")
    assert foldcut.check(saved).folds
    assert foldcut.check(saved, "star").folds
    other = foldcut.check(saved, "heart")
    assert other.folds is False
    assert repr(other).startswith("<Decision: ")
    assert len(repr(other)) < 400
