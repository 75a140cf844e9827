"""What the command line does for machines: the usual ones, their sheets, margins and test cards."""

from __future__ import annotations

import io
import re
import zipfile
from argparse import Namespace
from pathlib import Path

import pypdfium2
import pytest
from support.recipes import without_recipe

from foldcut.cli import options
from foldcut.cli.main import main
from foldcut.cli.parser import Parser, parse
from foldcut.drawing.placement import parse_sheet
from foldcut.exporters import JOB_EXPORTERS, check_job_export
from foldcut.jobs.bed import Lay
from foldcut.jobs.errors import JobError
from foldcut.output.render import JOB_WORDS
from foldcut.profiles import load_profile, profile_names
from foldcut.samples import sample_path


def arguments(*words: str) -> Namespace:
    """Return what ``foldcut make`` parses."""
    return parse(["make", *words])[1]


def made_with(folder: Path, *options: str) -> dict[str, bytes]:
    folder.mkdir()
    assert main(["make", "star", "--effort", "fast", "--quiet", *options]) == 0
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_a_dxf_without_a_machine_is_for_any_laser_whatever_else_is_written(tmp_path: Path) -> None:
    one = made_with(tmp_path / "one", "-o", str(tmp_path / "one/a.dxf"))
    named = made_with(tmp_path / "named", "--profile", "laser-dxf", "-o", str(tmp_path / "named/a.dxf"))
    outputs = [word for ending in ("dxf", "fold", "svg") for word in ("-o", str(tmp_path / f"both/a.{ending}"))]
    both = made_with(tmp_path / "both", *outputs)
    plain = made_with(tmp_path / "plain", "-o", str(tmp_path / "plain/a.svg"))
    assert one["a.dxf"] == named["a.dxf"] == both["a.dxf"]
    assert both["a.svg"] == plain["a.svg"], "the drawing is for nobody in particular"
    assert sorted(both) == ["a.dxf", "a.fold", "a.svg"]


@pytest.mark.parametrize(
    ("locale", "sheet", "profile"),
    [
        ({"LANG": "de_DE.UTF-8"}, (), "printer-a4"),
        ({"LANG": "en_US.UTF-8"}, (), "printer-letter"),
        ({"LANG": "en_US.UTF-8", "LC_PAPER": "en_GB.UTF-8"}, (), "printer-a4"),
        ({"LANG": "de_DE.UTF-8", "LC_ALL": "es_MX"}, (), "printer-letter"),
        ({"LC_ALL": "C"}, (), "printer-a4"),
        ({"LANG": "de_DE.UTF-8"}, ("--sheet", "letter"), "printer-letter"),
        ({"LANG": "en_US.UTF-8"}, ("--sheet", "a3"), "print-shop-a3"),
    ],
)
def test_a_pdf_without_a_machine_is_for_the_home_printer(
    locale: dict[str, str], sheet: tuple[str, ...], profile: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("LC_ALL", "LC_PAPER", "LANG"):
        monkeypatch.delenv(name, raising=False)
    for name, value in locale.items():
        monkeypatch.setenv(name, value)
    pdf = made_with(tmp_path / "usual", *sheet, "-o", str(tmp_path / "usual/a.pdf"))["a.pdf"]
    page = pypdfium2.PdfDocument(pdf)[0].get_size()
    bed = load_profile(profile).bed
    assert bed is not None
    assert sorted(page) == pytest.approx(sorted(side / 25.4 * 72 for side in (bed.width_mm, bed.height_mm)), abs=0.01)


def test_a_machines_own_sheet_is_the_usual_one() -> None:
    for profile in profile_names():
        made = options.folding(arguments("star", "--profile", profile))
        assert made.sheet == parse_sheet(load_profile(profile).sheet)
        other = options.folding(arguments("star", "--profile", profile, "--sheet", "a5", "--margin", "3mm"))
        assert (other.sheet, other.margin) == (parse_sheet("a5"), 3.0)
    assert load_profile("printer-letter").sheet == "letter"
    assert load_profile("print-shop-a3").sheet == "a3"


def test_with_a_pdf_among_the_files_the_sheet_is_the_printers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LC_ALL", "en_US.UTF-8")
    assert options.folding(arguments("star", "-o", "a.dxf", "-o", "a.pdf")).sheet == parse_sheet("letter")
    assert options.folding(arguments("star", "-o", "a.dxf")).sheet == parse_sheet("a4")


@pytest.mark.parametrize("profile", [name for name in profile_names() if load_profile(name).operations])
def test_the_usual_margin_is_as_wide_as_what_the_machine_does_not_reach(profile: str) -> None:
    made = options.folding(arguments("star", "--profile", profile))
    left, low, right, high = Lay.for_machine(made.sheet, load_profile(profile)).room
    missed = max(left, low, made.sheet.width - right, made.sheet.height - high)
    assert missed <= made.margin
    assert made.margin == pytest.approx(max(10.0, missed), abs=0.1)


@pytest.mark.parametrize(("ending", "names"), [("gcode", "grbl-laser or grbl-plotter"), ("hpgl", "drag-knife or hp-")])
def test_a_format_of_several_machines_asks_for_one_of_them(
    ending: str, names: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["make", "star", "-o", str(tmp_path / f"a.{ending}")]) == 2
    assert f"name it with --profile {names}" in capsys.readouterr().err


def test_profiles_are_listed_with_what_is_unverified(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["profiles"]) == 0
    lines = capsys.readouterr().out.splitlines()
    for name in profile_names():
        profile = load_profile(name)
        (line,) = (line for line in lines if line.split()[:1] == [name])
        assert all(key in line for key in profile.unverified)
        assert ("unverified" in line) == bool(profile.unverified)
        for key, source in profile.sources.items():
            vague = any(word in source for word in ("memory", "not checked", "not looked up"))
            assert not vague or key in profile.unverified, "what nobody compared says so"
    assert load_profile("epilog").unverified


def test_a_card_for_a_cutter_with_one_holder_is_a_file_for_each_tool(tmp_path: Path) -> None:
    assert main(["coupon", "--profile", "drag-knife", "-o", str(tmp_path / "card.hpgl"), "--quiet"]) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["card-cut.hpgl", "card-mark.hpgl", "card-score.hpgl"]
    assert main(["coupon", "--profile", "drag-knife", "-o", str(tmp_path / "card.hpgl"), "--quiet"]) == 2


def test_copies_with_tabs_and_a_frame_go_into_an_archive_that_explains_them(tmp_path: Path) -> None:
    options = ["--sheet", "100x70mm", "--profile", "grbl-laser", "--copies", "3", "--tabs", "2x1mm", "--frame"]
    (data,) = made_with(tmp_path / "zip", *options, "-o", str(tmp_path / "zip/a.zip")).values()
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        assert archive.namelist() == ["README.txt", "a-frame.gcode", "a.gcode"]
        text = " ".join(archive.read("README.txt").decode().split())
    assert "1. a-frame.gcode: goes round the job with the tool off 2. a.gcode" in text
    assert "3 sheets lie with their lower left corners at (0, 0), (102, 0), (204, 0)" in text
    assert "The outline of each sheet is not cut at 2 tabs of 1 mm" in text
    assert "Together about " in text


def test_a_pattern_that_is_opened_is_placed_like_a_drawing(tmp_path: Path) -> None:
    sheet, pattern = ("--sheet", "100x70mm"), tmp_path / "one/a.fold"
    placed = ("--profile", "laser-dxf", "--at", "1cm,20", "--tabs", "4x1")
    files = made_with(tmp_path / "one", *sheet, *placed, "-o", str(pattern), "-o", str(tmp_path / "one/a.dxf"))
    again = tmp_path / "again.dxf"
    assert main(["make", str(pattern), *placed, "--quiet", "-o", str(again)]) == 0
    assert without_recipe(again.read_bytes()) == without_recipe(files["a.dxf"])


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--profile", "laser-dxf", "--at", "3"), "--at 3 is not a pair; give X,Y"),
        (("--profile", "laser-dxf", "--frame"), "--frame needs moves with the tool off"),
        (("--profile", "printer-a4", "--copies", "2"), "are for a bed, and Home printer, A4 prints pages"),
        (("--profile", "grbl-laser", "--copies", "5"), "use --copies 1, or a smaller --sheet"),
        (("--at", "3,3"), "--at goes with a machine"),
    ],
)
def test_what_cannot_be_placed_is_told_before_the_search(
    options: tuple[str, ...],
    words: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["make", "star", *options]) == 2
    assert words in capsys.readouterr().err
    assert not [*tmp_path.iterdir()]


def error_of(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    capsys.readouterr()
    assert main([*words]) == 2
    return capsys.readouterr().err


def test_a_format_of_another_machine_is_refused_with_machines_that_take_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for machine, other, first in (("grbl-laser", "hpgl", "drag-knife"), ("axidraw-a4", "gcode", "grbl-laser")):
        error = error_of(capsys, "make", "star", "--profile", machine, "-o", "a.svg", "-o", f"b.{other}")
        assert f"make .{other} files by a command of their own, with --profile {first} or" in error
        assert main(["make", "star", "--effort", "fast", "--quiet", "--profile", first, "-o", f"b.{other}"]) == 0
    assert not Path("a.svg").exists()


@pytest.mark.parametrize("machine", [name for name in profile_names() if load_profile(name).operations])
def test_what_a_profile_lacks_for_a_format_is_named_and_enough(machine: str) -> None:
    profile, sheet = load_profile(machine), parse_sheet("100x80mm")
    for suffix in JOB_EXPORTERS:
        try:
            check_job_export(suffix, profile, sheet)
        except JobError as error:
            assert re.search(rf"[;,] (or )?make {suffix} files by a command of their own, with --profile ", str(error))
            assert "; or " not in str(error)
            lacking = re.findall(r"--set (\S+?)(?=[ ,;]|$)", str(error))
            assert lacking or suffix == ".lbrn2"
            if lacking:
                assert not {value.split(".")[0] for value in lacking} & {name for name in ("bed",) if profile.bed}
                check_job_export(suffix, load_profile(machine, lacking), sheet)


def test_a_laser_without_power_is_told_which_materials_lack_it() -> None:
    profile = load_profile("grbl-laser")
    some = {name: one.model_copy(update={"score": None}) for name, one in profile.materials.items()}
    profile = profile.model_copy(update={"materials": some})
    for suffix in (".gcode", ".lbrn2"):
        with pytest.raises(JobError, match="no power for valley .*; add it with --set ") as caught:
            check_job_export(suffix, profile, parse_sheet("100x80mm"))
        assert all(f"materials.{name}.score.power_percent=10" in str(caught.value) for name in some)


def test_a_pattern_on_too_large_a_sheet_is_told_what_it_can_still_do(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["make", "star", "--sheet", "a1", "--effort", "fast", "--quiet", "-o", "a.fold"]) == 0
    for machine in ("hp-7475a", "glowforge", "printer-a4"):
        error = error_of(capsys, "make", "a.fold", "--profile", machine)
        assert "fold the drawing again with --sheet" in error
        assert "use --sheet" not in error
    bed = [part for side in ("width", "height") for part in ("--set", f"bed.{side}_mm=100")]
    error = error_of(capsys, "make", "a.fold", "--profile", "scored-sheet", *bed)
    remedy = re.search(r"take a larger bed: ((?:--set \S+ ?){2}), or", error)
    assert remedy
    load_profile("scored-sheet", remedy[1].split()[1::2])
    assert "--tile" not in error
    bed = ["--set", "bed.width_mm=900", "--set", "bed.height_mm=1200"]
    error = error_of(capsys, "make", "a.fold", "--profile", "laser-dxf", *bed, "--copies", "7")
    assert "its sheet already: use --copies 2, or fold the drawing again with --sheet" in error
    assert main(["make", "a.fold", "--profile", "laser-dxf", *bed, "--copies", "2", "--quiet"]) == 0
    error = error_of(capsys, "solve", "a.fold", "--profile", "laser-dxf", *bed, "--copies", "7", "-o", "b.dxf")
    assert "use --copies 2, or make the sheet smaller with --width" in error
    assert main(["make", "a.fold", "--profile", "printer-a4", "--tile", "--quiet"]) == 0


def test_a_test_card_in_an_archive_has_all_its_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("folder").mkdir()
    assert main(["coupon", "--profile", "drag-knife", "-o", "card.zip", "--quiet"]) == 0
    assert main(["coupon", "--profile", "drag-knife", "-o", "card.hpgl", "--quiet"]) == 0
    with zipfile.ZipFile("card.zip") as archive:
        names = [name for name in archive.namelist() if name != "README.txt"]
        assert sorted(names) == sorted(path.name for path in Path().glob("*.hpgl"))
        assert all(archive.read(name) == Path(name).read_bytes() for name in names)
        text = archive.read("README.txt").decode()
    assert all(name in text for name in names)
    assert "foldcut coupon --profile=drag-knife" in text
    assert main(["coupon", "--profile", "drag-knife", "-o", "folder"]) == 2


def test_job_options_without_a_job_are_refused_and_not_in_recipes_of_patterns(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ("--sheet", "a6", "--profile", "grbl-laser", "--frame", "--tabs", "4x1mm")
    for names in (("a.fold",), ("a.png", "a.html"), ("a.cp",)):
        error = error_of(capsys, "make", "star", *words, *(word for name in names for word in ("-o", name)))
        assert "--tabs and --frame are for a job" in error
        assert "-o NAME.gcode" in error
    error = error_of(capsys, "batch", str(sample_path("star")), "-o", "out", "--format", "fold", *words)
    assert "are for a job" in error
    assert not [*tmp_path.iterdir()]
    quick = ("--effort", "fast", "--quiet")
    assert main(["make", "star", *words, *quick, "-o", "a.fold", "-o", "a.gcode"]) == 0
    assert b"tabs" not in Path("a.fold").read_bytes()
    assert main(["make", "a.fold", "--again", "--quiet"]) == 0
    assert main(["make", "a.gcode", "--again", "--quiet"]) == 0


def test_job_words_are_all_options_of_a_machine_but_the_profile() -> None:
    parser = Parser(add_help=False)
    options.add_machine(parser)
    assert {*parser.option_strings()} - {"--profile", "--set"} == {*JOB_WORDS}


@pytest.mark.parametrize(
    "words",
    [
        ("make", "star", "--profile", "laser-dxf"),
        ("batch", "*.svg"),
        ("solve", "a.fold"),
        ("guide", "star"),
        ("draw", "star"),
        ("coupon", "--profile", "laser-dxf"),
    ],
)
def test_an_output_without_a_name_is_refused(
    words: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for empty in (("-o", ""), ("--output=",), *([("--preview", "")] if words[0] == "make" else [])):
        assert "its name is empty" in error_of(capsys, *words, *empty)
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("grbl-laser", "--set", "bed.width_mm=20"), "with --set, or take a larger machine with --profile"),
        (("printer-a4", "--set", "bed.height_mm=50"), "with --set, or take a larger machine with --profile"),
        (("plain",), "name a machine with --profile; see foldcut profiles"),
        (("scored-sheet",), "name a machine with --profile; see foldcut profiles"),
        (("grbl-laser", "-o", "missing/"), "missing/ is a folder; give a file in it, or a .zip"),
        (("hp-7475a", "-o", "card.lbrn2"), "by a command of their own, with --profile lightburn-co2 or"),
        (("grbl-laser", "-o", "card"), "an output file needs an ending that names its format"),
    ],
)
def test_a_test_card_is_told_only_of_options_that_it_has(
    options: tuple[str, ...],
    words: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    error = error_of(capsys, "coupon", "--profile", *options)
    assert words in error
    assert not {"--sheet", "--tile", "leave"} & set(re.split(r"[\s,;]+", error))
    assert not [*tmp_path.iterdir()]
