"""The folding guide: it has every step, the words say what is true, and programs that are not ours open it."""

from __future__ import annotations

import io
import math
import re
from pathlib import Path

import numpy as np
import pikepdf
import pytest
import shapely
import svgelements
from support.folded import folded_sample
from support.programs import require_program, run_program

from foldcut.cli.main import main
from foldcut.core.model import FoldedPattern
from foldcut.exporters.pictures.guide import (
    BACK,
    FRONT,
    MOVED,
    MOVED_BACK,
    NOW,
    Instruction,
    export_html,
    export_pdf,
    instructions,
)
from foldcut.exporters.pictures.panels import laid_out
from foldcut.folding_steps import folding_steps
from foldcut.profiles import load_profile


@pytest.fixture(scope="module", params=["letter-a", "fish", "triangle"])
def pattern(request: pytest.FixtureRequest) -> FoldedPattern:
    """Give patterns with one first fold, without, and with few creases."""
    made: FoldedPattern = folded_sample(request.param)
    return made


MADE: dict[int, list[Instruction]] = {}


def made_of(pattern: FoldedPattern) -> list[Instruction]:
    """Return the instructions for a pattern, made once."""
    if id(pattern) not in MADE:  # patterns of samples are kept, so that no other gets the same id
        MADE[id(pattern)] = instructions(pattern, load_profile().drawing)
    return MADE[id(pattern)]


def paths(step: Instruction) -> list[svgelements.Path]:
    """Return what is drawn over the legend."""
    drawing = svgelements.SVG.parse(io.BytesIO(laid_out([("it", step.panel)], "")[0]), ppi=25.4)
    (group,) = drawing.elements(lambda e: isinstance(e, svgelements.Group) and e.id == "it")
    return [path for path in group.select() if isinstance(path, svgelements.Path)]


def strokes(step: Instruction, colour: str) -> list[svgelements.Path]:
    """Return what is drawn in a colour."""
    return [path for path in paths(step) if path.stroke.hex == colour]


def test_the_steps_are_those_of_the_folding_order(pattern: FoldedPattern) -> None:
    titles = [step.title for step in made_of(pattern)]
    expected = ["The sheet"]
    folds = 0
    for step in folding_steps(pattern):
        if step.line is not None:
            folds += 1
            expected.append(f"Fold {folds}")
        else:
            count = len(step.groups)
            expected += ["The groups"] if count > 1 else []
            expected += [f"Press group {k + 1} of {count}" for k in range(count)] if count > 1 else ["Press creases"]
            expected += ["Collapse", "Closing", "Collapsed"]
    if expected[-1] == "Collapsed":
        expected.pop()  # as the next picture shows it
    assert titles[: len(expected)] == expected
    assert titles[len(expected)] in ("Turn over", "Turn", "Folded")
    assert titles[len(expected) + 1 :] == ["Check the layers", "Cut", "Unfold"]


def test_every_crease_is_marked_in_its_group(pattern: FoldedPattern) -> None:
    made = [step for step in made_of(pattern) if step.title.startswith("Press")]
    groups = [group for step in folding_steps(pattern) for group in step.groups]
    at = pattern.creases.vertices_coords[pattern.creases.edges_vertices]
    if all(step.line is None for step in folding_steps(pattern)):  # else several layers are creased at once
        scale = 100 / max(pattern.sheet.width, pattern.sheet.height)
        for step, edges in zip(made, groups, strict=True):
            (marked,) = strokes(step, NOW)
            expected = sum(math.dist(*at[edge]) for edge in edges.tolist()) * scale
            assert marked.length() == pytest.approx(expected, rel=1e-3)
            count = int(re.findall(r"the (?:(\d+) )?marked", step.text)[0] or 1)
            assert count == len(list(marked.as_subpaths())) <= len(edges)
    assert all(strokes(step, NOW) for step in made)


def test_a_fold_is_marked_on_the_sheet_and_what_moves_is_coloured(pattern: FoldedPattern) -> None:
    made = [step for step in made_of(pattern) if step.title.startswith("Fold")]
    assert bool(made) == any(step.line is not None for step in folding_steps(pattern))
    for step in made:
        assert strokes(step, NOW)
        fills = {path.fill.hex for path in paths(step) if path.fill.value is not None}
        assert fills & {MOVED, MOVED_BACK}
        assert fills & {FRONT, BACK}


def test_the_cut_is_where_the_guide_says(pattern: FoldedPattern) -> None:
    (cut,) = [step for step in made_of(pattern) if step.title == "Cut"]
    under, over = map(float, re.findall(r"([\d.]+) mm", cut.text))
    heights = pattern.folded.vertices_coords[:, 1]
    assert (under, over) == pytest.approx((heights.max(), -heights.min()), abs=0.051)
    assert under + over == pytest.approx(np.ptp(heights), abs=0.11)


def test_what_collapses_is_shown_as_mountains_and_valleys_and_then_as_it_comes_out() -> None:
    pattern = folded_sample("fish")
    made = made_of(pattern)
    number = [step.title for step in made].index("Collapse")
    assert "one movement" in made[number].text
    look, kinds = load_profile().drawing, pattern.creases.edges_assignment
    at = pattern.creases.vertices_coords[pattern.creases.edges_vertices]
    longest = {}
    for letter, colour in (("M", look.mountain_colour), ("V", look.valley_colour)):
        drawn = sum(path.length() for path in strokes(made[number], colour))
        longest[letter] = drawn / np.hypot(*(at[kinds == letter, 1] - at[kinds == letter, 0]).T).sum()
    assert longest["M"] == pytest.approx(longest["V"], rel=0.2), "dashes and dots cover less, in the same proportion"
    filled = [path for path in paths(made[number + 1]) if path.fill.value is not None]
    assert len(filled) >= len(pattern.creases.faces_vertices)


def test_creases_through_several_layers_are_told_with_those_on_their_own_line() -> None:
    made = made_of(folded_sample("paper-chain"))
    first, second = [step for step in made if step.title == "Collapse"]
    (press,) = [step for step in made if step.title == "Press creases"]
    assert "these creases through 6 layers close together" in first.text
    layers = re.findall(r"through (\d+) layers", press.text + second.text)
    assert layers == ["6", "6"]
    assert "this crease" in second.text


@pytest.mark.parametrize("name", ["star", "tree", "plus"])
def test_a_fold_is_told_with_the_layers_that_move_beside_its_line(name: str) -> None:
    pattern = folded_sample(name)
    folds = [step for step in folding_steps(pattern) if step.line is not None]
    texts = [step.text for step in made_of(pattern) if step.title.startswith("Fold ")]
    at = pattern.creases.vertices_coords
    for step, text in zip(folds, texts, strict=True):
        assert step.line is not None
        assert step.moved is not None
        bodies = [shapely.Polygon(at[pattern.creases.faces_vertices[face]]) for face in step.moved]
        along = (step.line[1] - step.line[0]) / math.dist(*step.line)
        across = np.array([-along[1], along[0]])
        middle = np.asarray(shapely.union_all(bodies).centroid.coords[0])
        start = step.line[0] + 0.02 * across * np.sign((middle - step.line[0]) @ across)
        places = shapely.points(start + np.linspace(0.01, 0.99, 99)[:, None] * (step.line[1] - step.line[0]))
        most = int(shapely.contains(np.array(bodies)[:, None], places).sum(axis=0).max())
        said = re.findall(r"(\d+) layers", text.partition(".")[0])
        assert most == (int(said[0]) if said else 2 if "both layers" in text else 1)
        at = step.state.vertices_coords


def test_the_arrows_are_those_of_valleys_and_mountains_and_lines_are_dashed_like_them() -> None:
    pattern = folded_sample("tree")
    steps = [step for step in folding_steps(pattern) if step.line is not None]
    made = [step for step in made_of(pattern) if step.title.startswith("Fold ")]
    assert {step.over for step in steps} == {True, False}
    for step, told in zip(steps, made, strict=True):
        (head,) = [path for path in paths(told) if path.fill.hex in ("#000", "#000000") or hollow(path)]
        assert hollow(head) != step.over
        assert ("valley" in told.panel.keys[0].text) == step.over
        assert ("toward you" in told.text) == step.over


def hollow(path: svgelements.Path) -> bool:
    """Whether this is the head of a mountain fold's arrow: half of a triangle, white with a black border."""
    return path.fill.hex in ("#fff", "#ffffff") and path.stroke.hex in ("#000", "#000000")


def test_html_has_every_step_and_loads_nothing(pattern: FoldedPattern) -> None:
    page = export_html(pattern).decode()
    assert page.count("<section>") == len(made_of(pattern))
    assert all(url.startswith("http://www.w3.org/") for url in re.findall(r"https?://[^\"]*", page))  # namespaces
    assert "<script" not in page


def test_qpdf_and_mutool_read_the_pdf(pattern: FoldedPattern, tmp_path: Path) -> None:
    path = tmp_path / "guide.pdf"
    path.write_bytes(export_pdf(pattern))
    assert path.read_bytes() == export_pdf(pattern)
    run_program(require_program("qpdf"), "--check", path)
    text = run_program(require_program("mutool"), "draw", "-F", "txt", "-o", "-", path)
    for step in made_of(pattern):
        assert f". {step.title}" in text
    with pikepdf.open(path) as pdf:
        assert {tuple(map(round, map(float, page.mediabox[2:]))) for page in pdf.pages} == {(595, 842)}


def test_the_command_writes_what_the_name_says(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("a.pdf", "a.html", "a.svg"):
        assert main(["guide", "triangle", "--effort", "fast", "--quiet", "-o", str(tmp_path / name)]) == 0
        assert (tmp_path / name).stat().st_size > 5000
    assert main(["guide", "triangle", "-o", str(tmp_path / "a.png")]) == 2
    assert "guides are PDF, HTML or animated SVG" in capsys.readouterr().err
