"""Both sides of a sheet in one PDF: turned over as the file asks, what is behind each page is its back."""

from __future__ import annotations

import io
import itertools
from functools import cache
from pathlib import Path

import numpy as np
import pikepdf
import pytest
import shapely

from foldcut.core.arrays import Floats
from foldcut.core.model import FoldedPattern
from foldcut.jobs.bed import Lay
from foldcut.jobs.instructions import instructions
from foldcut.jobs.pages import tiles
from foldcut.output.render import JobOptions, Maker
from foldcut.pipeline import fold
from foldcut.profiles import load_profile
from foldcut.samples import sample_path

MM = 72 / 25.4
Layers = dict[str, list[Floats]]


def pages_of(data: bytes) -> tuple[list[tuple[Floats, Layers]], str]:
    """Return the size of each page and its strokes by layer, in mm, as pikepdf parses them, and the edge to flip on."""
    pages = []
    with pikepdf.open(io.BytesIO(data)) as pdf:
        for page in pdf.pages:
            names = {key: str(group.Name) for key, group in page.Resources.Properties.items()}
            found: Layers = {}
            layer, line = "", []
            for operands, operator in pikepdf.parse_content_stream(page):
                word = str(operator)
                if word == "BDC":
                    layer = names[str(operands[1])]
                elif word == "EMC":
                    layer = ""
                elif word in ("m", "l"):
                    line = (line if word == "l" else []) + [[float(operands[0]) / MM, float(operands[1]) / MM]]
                elif word == "S" and layer and line:
                    found.setdefault(layer, []).append(np.array(line))
            pages.append((np.array([float(n) for n in page.MediaBox[2:]]) / MM, found))
        asked = pdf.Root.ViewerPreferences.get("/Duplex", "")
    return pages, str(asked)


def seen_through(strokes: list[Floats], size: Floats, asked: str) -> list[Floats]:
    """Return the strokes of a page as they are seen through the paper, turned over on the edge that is asked for."""
    upright = size[1] >= size[0]
    left_to_right = upright == (asked == "/DuplexFlipLongEdge")
    axis = 0 if left_to_right else 1
    flipped = [stroke.copy() for stroke in strokes]
    for stroke in flipped:
        stroke[:, axis] = size[axis] - stroke[:, axis]
    return flipped


CASES = list(itertools.product(("180x250mm", "250x180mm", "280x400mm", "400x280mm"), ("printer-a4", "print-shop-a3")))


@cache
def leaning_star(sheet: str) -> FoldedPattern:
    """A star that is symmetric about no axis of its sheet."""
    return fold(sample_path("star"), sheet, effort="fast", rotation=20.0).require_verified()


@pytest.mark.parametrize(("sheet", "machine"), CASES)
def test_the_back_of_each_page_is_behind_it(sheet: str, machine: str) -> None:
    profile, pattern = load_profile(machine), leaning_star(sheet)
    large = max(pattern.sheet.width, pattern.sheet.height) > 300 and machine == "printer-a4"
    maker = Maker(pattern, profile, JobOptions(two_sided=True, tile=large))
    ((name, data),) = maker.files(Path("x.pdf")).items()
    assert name == Path("x.pdf")
    pages, asked = pages_of(data)
    front, back = maker.jobs["front"], maker.jobs["back"]
    assert len(pages) == 2 * len(list(tiles(front, profile)))
    assert (len(pages) > 2) == large
    lay = Lay.for_machine(pattern.sheet, profile, tile=large)
    creases = pattern.creases
    ends = creases.vertices_coords[creases.edges_vertices[creases.edges_assignment == "V"]]
    valleys = shapely.union_all([shapely.LineString(lay.place(line)) for line in ends]).buffer(1e-3)
    shown = 0.0
    for (size, ahead), (other, behind), tile in zip(pages[::2], pages[1::2], tiles(front, profile), strict=True):
        assert (size == other).all()
        assert "3 valley" not in ahead
        assert "2 mountain" not in behind
        through = [stroke + np.array([tile.x, tile.y]) for stroke in seen_through(behind["3 valley"], size, asked)]
        laid = shapely.union_all([shapely.LineString(stroke) for stroke in through])
        assert shapely.difference(laid, valleys).length < 1e-6, "valleys are where the pattern has them"
        shown += laid.length
    assert shown > 300
    words = "flip on long edge" if asked == "/DuplexFlipLongEdge" else "flip on short edge"
    assert any(words in line and back.turned_over in line for line in instructions(profile, [front, back]))


@pytest.mark.parametrize("tile", [False, True])
def test_several_pages_are_told_only_where_there_are_several(tile: bool) -> None:
    profile, pattern = load_profile("printer-a4"), leaning_star("a2" if tile else "180x250mm")
    maker = Maker(pattern, profile, JobOptions(tile=True))
    (data,) = maker.files(Path("x.pdf")).values()
    told = [line for line in instructions(profile, list(maker.jobs.values())) if "pages" in line]
    assert told == (
        ["8 pages: glue them cross on cross; the small picture on each shows where it goes."] if tile else []
    )
    with pikepdf.open(io.BytesIO(data)) as pdf:
        rectangles = [
            [str(operator) for _, operator in pikepdf.parse_content_stream(page)].count("re") for page in pdf.pages
        ]
    # the clip, eight pages of which one is filled, and the sheet; perhaps the white behind words
    assert all(count >= 10 for count in rectangles) if tile else max(rectangles) <= 2
