"""What of an SVG is not read is told, with a remedy that works."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
import shapely

from foldcut.core.errors import BadInputError, FileFormatError
from foldcut.readers import Drawing, ReadOptions, read_shape
from foldcut.readers.svg import CUT_STROKES, TEXTS

KITE = '<path d="M 10 10 L 90 20 L 70 85 L 30 60 Z"/>'
LINE = '<path d="M10 50H90" fill="none" stroke="black" stroke-width="{}" stroke-linecap="{}"/>'


def read(folder: Path, body: str, **options: str) -> Drawing:
    size = 'width="100mm" height="100mm" viewBox="0 0 100 100"'
    (folder / "a.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{body}</svg>')
    return read_shape(folder / "a.svg", ReadOptions(**options))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "rule",
    [
        "rect::part(x) { fill: none }",
        "@supports (fill: red) { path { fill: none } }",
        "rect { stroke-width: calc(1px + 1mm) }",
        "@media (min-width: 9px) { path { fill: none } }",
        "path { fill: color(nonsense) }",
        "} rect { fill: red }",
    ],
)
def test_a_rule_that_is_not_understood_is_told(tmp_path: Path, rule: str) -> None:
    assert "1 unreadable style rule" in read(tmp_path, f"<style>{rule}</style>{KITE}").ignored


@pytest.mark.parametrize(
    "rule",
    [
        "path { stroke-dashoffset: 3 }",
        "@font-face { font-family: x }",
        "/* x */",
        "path { fill: red !important; }",
        "path {}",
    ],
)
def test_a_rule_that_does_not_matter_is_not_told(tmp_path: Path, rule: str) -> None:
    assert read(tmp_path, f"<style>{rule}</style>{KITE}").ignored == ()


def test_sheets_from_outside_are_told(tmp_path: Path) -> None:
    assert read(tmp_path, f'<style>@import "a.css";</style>{KITE}').ignored == ("1 external style sheet",)


def test_texts_name_the_remedy(tmp_path: Path) -> None:
    assert read(tmp_path, f"<text>A</text>{KITE}").notes == (TEXTS,)
    with pytest.raises(FileFormatError, match="make texts into paths, or draw a text with --text"):
        read(tmp_path, "<text>A</text>")


def test_hidden_outlines_are_told_where_there_is_nothing_else(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match="all outlines of the file are hidden or have an opacity of 0"):
        read(tmp_path, f'<g opacity="0">{KITE}</g>')


@pytest.mark.parametrize(("cap", "area"), [("butt", 80 * 8), ("square", 88 * 8), ("round", 80 * 8 + math.pi * 16)])
def test_strokes_that_are_no_outline_name_the_remedy_and_it_works(tmp_path: Path, cap: str, area: float) -> None:
    with pytest.raises(FileFormatError, match=rf"a line ends at \(10, 50\).*; or {CUT_STROKES}"):
        read(tmp_path, LINE.format(8, cap))
    (loop,) = read(tmp_path, LINE.format(8, cap), strokes="outline").loops
    assert shapely.Polygon(loop).area == pytest.approx(area, rel=2e-3)
    with pytest.raises(FileFormatError) as caught:
        read(tmp_path, LINE.format(0.1, cap))
    assert CUT_STROKES not in str(caught.value)


def test_wide_strokes_of_an_outline_are_told(tmp_path: Path) -> None:
    circle = '<circle cx="50" cy="50" r="30" fill="none" stroke="black" stroke-width="4"/>'
    assert read(tmp_path, circle).notes == (f"strokes of up to 4 mm were read as lines without width; {CUT_STROKES}",)
    drawing = read(tmp_path, circle, strokes="outline")
    assert (len(drawing.loops), drawing.notes) == (2, ())


def test_there_are_two_ways_to_read_strokes() -> None:
    with pytest.raises(BadInputError, match="there is no way 'wide' to read strokes; give lines or outline"):
        ReadOptions(strokes="wide")


DASHED = '<path d="M10 10h40v40h-40z" fill="none" stroke="black" {}/>'


@pytest.mark.parametrize(
    ("body", "told"),
    [
        (DASHED.format('stroke-dasharray="4 2"'), ("1 stroke-dasharray",)),
        (f'<g style="stroke-dasharray: 5%">{DASHED.format("")}</g>', ("1 stroke-dasharray",)),
        (DASHED.format('stroke-dasharray="none"'), ()),
        ('<path d="M10 10h40v40h-40z" stroke-dasharray="4 2"/>', ()),
    ],
)
def test_dashes_are_read_as_whole_lines_and_told(tmp_path: Path, body: str, told: tuple[str, ...]) -> None:
    assert read(tmp_path, body).ignored == told
