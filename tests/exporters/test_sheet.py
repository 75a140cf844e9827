"""The printed sheet: what it says of what to do, only for printers, and all lines where they were; and the kit."""

from __future__ import annotations

import dataclasses
import io
from pathlib import Path

import pikepdf
import pypdfium2
import pytest
from support.folded import folded_sample

from foldcut.cli.main import main
from foldcut.exporters import export_job
from foldcut.exporters.job.pictograms import PICTOGRAMS
from foldcut.exporters.pictures.guide import export_pdf
from foldcut.folding_steps.hints import hints
from foldcut.jobs.job import Job
from foldcut.output.render import JobOptions, Maker
from foldcut.pipeline import fold
from foldcut.profiles import load_profile

PRINTER = load_profile("printer-a4")


def text_of(data: bytes, page: int = 0) -> str:
    """Return the words on a page, a space between lines."""
    return " ".join(pypdfium2.PdfDocument(data)[page].get_textpage().get_text_range().split())


def without_hints(job: Job) -> Job:
    return dataclasses.replace(job, subtitle="", hints=())


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("star", ["Fold straight across, 4 times, always through all layers.", "all grey lines lie on each other now"]),
        ("snowflake", ["First fold along the lines between", "6 times in all, some of them not through all layers."]),
        ("heart", ["First fold the sheet along the line between the arrowheads", "Fold all lines sharply"]),
        ("fish", ["Fold all lines sharply, each by itself", "Let all lines close at once"]),
    ],
)
def test_the_sheet_says_what_to_do_in_numbered_lines_and_how_difficult_it_is(name: str, words: list[str]) -> None:
    pattern = folded_sample(name)
    (job,) = JobOptions().jobs(pattern, PRINTER)
    text = text_of(export_job(job, ".pdf", PRINTER))
    subtitle, lines = hints(pattern)
    assert all(word in text for word in words)
    assert f"{len(lines)}. Cut once, straight, along the grey line." in text
    assert subtitle in text
    assert {hint.picture for hint in lines} <= PICTOGRAMS.keys()


def test_the_cut_is_named_by_the_colour_that_it_is_printed_in() -> None:
    mark = PRINTER.operations["mark"].model_copy(update={"colour": "#ff00ff"})
    profile = PRINTER.model_copy(update={"operations": {**PRINTER.operations, "mark": mark}})
    (job,) = JobOptions().jobs(folded_sample("star"), profile)
    assert "along the magenta line" in text_of(export_job(job, ".pdf", profile))


def test_every_line_of_the_sheet_is_where_it_is_without_the_words() -> None:
    (job,) = JobOptions().jobs(folded_sample("heart"), PRINTER)
    pages = []
    for one in (job, without_hints(job)):
        with pikepdf.open(io.BytesIO(export_job(one, ".pdf", PRINTER))) as pdf:
            (page,) = pdf.pages
            pages.append((page.Contents.read_bytes().split(b"/L3 BDC")[0], [float(edge) for edge in page.mediabox]))
    assert pages[0] == pages[1]


@pytest.mark.parametrize("machine", ["lightburn-co2", "axidraw-a4", "cricut-maker", "plain"])
def test_no_machine_that_cuts_or_draws_gets_words(machine: str) -> None:
    profile = load_profile(machine)
    if not profile.operations:
        return
    (job,) = JobOptions().jobs(folded_sample("star"), profile)
    assert (job.subtitle, job.hints) == ("", ())


def test_a_page_that_is_too_small_has_no_words_and_several_pages_have_them_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    small, large = folded_sample("star", "50x50mm"), folded_sample("star", "a3")
    tiny = PRINTER.model_copy(
        update={"bed": PRINTER.bed and PRINTER.bed.model_copy(update={"width_mm": 50.0, "height_mm": 50.0})}
    )
    (job,) = JobOptions().jobs(small, tiny)
    assert "Cut once" not in text_of(export_job(job, ".pdf", tiny))
    (job,) = JobOptions(tile=True).jobs(large, PRINTER)
    data = export_job(job, ".pdf", PRINTER)
    count = len(pypdfium2.PdfDocument(data))
    assert count > 1
    assert ["Cut once" in text_of(data, page) for page in range(count)] == [True] + [False] * (count - 1)


def test_a_kit_is_the_sheet_as_it_is_and_the_guide_behind_it() -> None:
    pattern, maker = folded_sample("star"), Maker(folded_sample("star"), PRINTER, JobOptions())
    (sheet,) = maker.files(Path("star.pdf")).values()
    (kit,) = maker.kit(Path("star-kit.pdf")).values()
    assert maker.kit(Path("star-kit.pdf")) == {Path("star-kit.pdf"): kit}
    with pikepdf.open(io.BytesIO(sheet)) as one, pikepdf.open(io.BytesIO(kit)) as all_pages:
        guide = pypdfium2.PdfDocument(export_pdf(pattern, PRINTER))
        assert len(all_pages.pages) == len(one.pages) + len(guide)
        assert one.pages[0].Contents.read_bytes() == all_pages.pages[0].Contents.read_bytes()
        assert one.pages[0].mediabox == all_pages.pages[0].mediabox
        names = [str(group.Name) for group in all_pages.Root.OCProperties.OCGs]
        assert names == [str(group.Name) for group in one.Root.OCProperties.OCGs]
        assert str(all_pages.Root.ViewerPreferences.PrintScaling) == "/None"
    assert "how to fold it" in text_of(kit, 1)
    assert "Cut" in text_of(kit, len(guide))


def test_the_command_makes_a_kit_with_both_sides_if_asked_and_makes_it_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["make", "triangle", "-o", "t-kit.pdf", "-o", "t.pdf", "--quiet"]) == 0
    pages = {name: len(pypdfium2.PdfDocument(Path(name))) for name in ("t-kit.pdf", "t.pdf")}
    assert pages["t-kit.pdf"] > pages["t.pdf"] == 1
    assert main(["make", "t-kit.pdf", "--again", "--quiet"]) == 0
    (tmp_path / "python").mkdir()
    fold("triangle").save(tmp_path / "python" / "t-kit.pdf")
    assert Path("python/t-kit.pdf").read_bytes() == Path("t-kit.pdf").read_bytes()
    assert main(["make", "triangle", "--profile", "printer-a4", "--two-sided", "-o", "two-KIT.PDF", "--quiet"]) == 0
    assert len(pypdfium2.PdfDocument(Path("two-KIT.PDF"))) == pages["t-kit.pdf"] + 1
