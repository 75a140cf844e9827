"""The folding guide: all lines are pressed once, the words say what is true, and programs that are not ours open it."""

from __future__ import annotations

import io
import re
from pathlib import Path

import numpy as np
import pikepdf
import pytest
import svgelements
from programs import require_program, run_program

from foldcut.cli import main
from foldcut.exporters.guide import NOW, export_html, export_pdf, steps
from foldcut.marks import pressing_order
from foldcut.model import FoldedPattern
from foldcut.pipeline import fold
from foldcut.profiles import load_profile
from foldcut.samples import sample_path


@pytest.fixture(scope="module", params=["letter-a", "fish", "triangle"])
def pattern(request: pytest.FixtureRequest) -> FoldedPattern:
    """Give patterns with one first fold, without, and with few creases."""
    made: FoldedPattern = fold(sample_path(request.param), effort="fast", min_crease=0).require_verified()
    return made


def test_every_line_is_marked_in_one_step(pattern: FoldedPattern) -> None:
    firsts, rest = pressing_order(pattern)
    longest = max(pattern.sheet.width, pattern.sheet.height)
    lengths = []
    for step in steps(pattern, load_profile().drawing):
        drawing = svgelements.SVG.parse(io.BytesIO(step.picture), ppi=25.4)
        marked = [p for p in drawing.elements() if isinstance(p, svgelements.Path) and p.stroke.hex == NOW]
        lengths += [path.length() * longest / 100 for path in marked]
    expected = [float(np.hypot(*(line[1] - line[0]))) for line in [*firsts, *rest]]
    assert lengths == pytest.approx(expected, abs=0.02)


def test_the_cut_is_where_the_guide_says(pattern: FoldedPattern) -> None:
    (cut,) = [step for step in steps(pattern, load_profile().drawing) if step.title == "Cut"]
    under, over = map(float, re.findall(r"([\d.]+) mm", cut.text))
    heights = pattern.folded.vertices_coords[:, 1]
    assert (under, over) == pytest.approx((heights.max(), -heights.min()), abs=0.051)
    assert under + over == pytest.approx(np.ptp(heights), abs=0.11)


def test_it_says_that_the_collapse_is_one_movement_and_shows_what_comes_out(pattern: FoldedPattern) -> None:
    made = {step.title: step for step in steps(pattern, load_profile().drawing)}
    assert "one movement" in made["Collapse"].text
    assert made["Collapse"].picture == made["Cut"].picture != made["Unfold"].picture


def test_html_has_every_step_and_loads_nothing(pattern: FoldedPattern) -> None:
    page = export_html(pattern).decode()
    assert page.count("<section>") == len(steps(pattern, load_profile().drawing))
    assert all(url.startswith("http://www.w3.org/") for url in re.findall(r"https?://[^\"]*", page))  # namespaces
    assert "<script" not in page


def test_qpdf_and_mutool_read_the_pdf(pattern: FoldedPattern, tmp_path: Path) -> None:
    path = tmp_path / "guide.pdf"
    path.write_bytes(export_pdf(pattern))
    assert path.read_bytes() == export_pdf(pattern)
    run_program(require_program("qpdf"), "--check", path)
    text = run_program(require_program("mutool"), "draw", "-F", "txt", "-o", "-", path)
    for step in steps(pattern, load_profile().drawing):
        assert f". {step.title}" in text
    with pikepdf.open(path) as pdf:
        assert {tuple(map(round, map(float, page.mediabox[2:]))) for page in pdf.pages} == {(595, 842)}


def test_the_command_writes_pdf_or_html(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("a.pdf", "a.html"):
        assert main(["guide", "triangle", "--effort", "fast", "--quiet", "-o", str(tmp_path / name)]) == 0
        assert (tmp_path / name).stat().st_size > 5000
    assert main(["guide", "triangle", "-o", str(tmp_path / "a.svg")]) == 2
    assert "guides are PDF or HTML" in capsys.readouterr().err
