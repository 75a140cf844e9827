"""Crease patterns of bare lines are read as the programs that write them mean them."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from support.flat_patterns import Document, stamps, strip, twist
from support.patterns import letter_fold, square_out_of_square

from foldcut.core.errors import FileFormatError
from foldcut.exporters import export
from foldcut.foldfile.decide import decide
from foldcut.foldfile.patterns import read_pattern
from foldcut.foldfile.read import FoldFile
from foldcut.profiles import load_profile


def read(name: str, text: str | bytes, folder: Path) -> FoldFile:
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return read_pattern(path)


def lines_of(document: Document) -> list[tuple[str, list[float]]]:
    """Return the letter and the ends, x y x y, of each edge."""
    points = document["vertices_coords"]
    return [
        (letter, [*points[one], *points[other]])
        for (one, other), letter in zip(document["edges_vertices"], document["edges_assignment"], strict=True)
    ]


def as_cp(document: Document) -> str:
    return "".join(f"{'FBMV'.find(letter) % 4} {' '.join(map(str, ends))}\n" for letter, ends in lines_of(document))


def as_svg(document: Document) -> str:
    colours = {"B": "black", "M": "#f00", "V": "rgb(0, 0, 255)", "F": "gray", "U": "black"}
    lines = (
        f'<line x1="{a}" y1="{b}" x2="{c}" y2="{d}" stroke="{colours[letter]}"/>'
        for letter, (a, b, c, d) in lines_of(document)
    )
    return f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-50 -50 100 100">{"".join(lines)}</svg>'


@pytest.mark.parametrize("ending", [".cp", ".opx", ".svg"])
def test_what_foldcut_writes_is_read_again(ending: str, tmp_path: Path) -> None:
    for pattern in (letter_fold(), square_out_of_square()):
        profile = load_profile("origami-software" if ending == ".svg" else "plain")
        file = read(f"a{ending}", export(pattern, ending, profile), tmp_path)
        again, before = file.pattern, pattern.creases
        assert len(again.faces_vertices) == len(before.faces_vertices)
        assert Counter(again.edges_assignment.tolist()) == Counter(before.edges_assignment.tolist())
        assert np.ptp(again.vertices_coords, axis=0) == pytest.approx(np.ptp(before.vertices_coords, axis=0))
        assert decide(file).folds is True


@pytest.mark.parametrize("document", [strip((20, 20, 20), "MV"), twist(4, 45, "VMV"), twist(6, 30, "MVM")])
def test_lines_of_other_programs_are_read_the_right_way_up(document: Document, tmp_path: Path) -> None:
    # y points down in both: the pattern is mirrored, mountains stay mountains
    for name, text in (("a.cp", as_cp(document)), ("a.svg", as_svg(document))):
        file = read(name, text, tmp_path)
        wanted = Counter(document["edges_assignment"])
        assert Counter(file.pattern.edges_assignment.tolist()) == wanted
        assert file.pattern.vertices_coords[:, 1].min() == -max(y for _, y in document["vertices_coords"])


def test_black_lines_inside_are_unassigned(tmp_path: Path) -> None:
    file = read("a.svg", as_svg(stamps(3, 2)), tmp_path)
    assert Counter(file.pattern.edges_assignment.tolist()) == {"B": 10, "U": 7}
    assert decide(file).folds is True


BORDER = "1 0 0 100 0\n1 100 0 100 100\n1 100 100 0 100\n1 0 100 0 0\n"


def test_lines_are_divided_and_joined(tmp_path: Path) -> None:
    # a square whose sides meet in ends that are slightly apart, two diagonals drawn whole, one of them twice,
    # a line with a free end, and a point
    text = """
        1 0 0 100 0
        1 100.00004 0 100 100
        1 100 100 0 100
        1 0 100 0 0
        2 0 0 100 100
        2 100 100 0 0
        3 0 100 100 0
        3 50 50 60 52
        4 7 7 7 7
        """
    file = read("a.cp", text, tmp_path)
    assert len(file.pattern.faces_vertices) == 4
    assert Counter(file.pattern.edges_assignment.tolist()) == {"B": 4, "M": 2, "V": 2}
    assert "1 line with a free end left out, the first at (55, -51)" in file.notes
    decision = decide(file)
    assert decision.folds is False
    assert "2 mountains and 2 valleys; they must differ by two" in decision.sentence


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.cp", "2 0 0 1 1\n2 0 0 1", "line 2: '2 0 0 1' is not a type from 0 to 4 and x y x y"),
        ("a.cp", "9 0 0 1 1", "line 1: '9 0 0 1 1' is not a type"),
        ("a.cp", "2 0 0 nan 1", "not finite"),
        ("a.cp", "2 0 0 1 1", "no crease ends inside the sheet; give a .fold, or whole lines without dashes"),
        (
            "a.cp",
            f"{BORDER}2 0 50 40 50\n2 60 50 100 50",
            "2 lines with a free end, the first at (20, -50): no crease ends",
        ),
        ("a.cp", f"{BORDER}0 0 50 40 50\n3 0 0 50 50\n3 60 60 100 100", "no crease ends inside the sheet"),
        ("a.cp", " ", "the file is empty"),
        ("a.opx", "<java/>", "no lines"),
        ("a.opx", "<java", "not XML"),
        (
            "a.opx",
            '<java><object class="oripa.OriLineProxy"><void property="x0"><double>one</double></void></object></java>',
            "x0: 'one' is not a number",
        ),
        ("a.svg", '<svg xmlns="http://www.w3.org/2000/svg"><rect width="9" height="9"/></svg>', "no lines"),
        ("b.cp", None, "No such file"),
    ],
)
def test_what_is_no_pattern_is_refused(name: str, text: str | None, words: str, tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match=re.escape(words)):
        read(name, text, tmp_path) if text is not None else read_pattern(tmp_path / name)
