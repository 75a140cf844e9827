"""Legends: where they find room, and that nothing lies under their words in a printed file."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pypdfium2
import pytest
import shapely
from support.folded import folded_sample

from foldcut.core.arrays import Floats
from foldcut.core.model import FoldedPattern
from foldcut.core.units import MM_PER_INCH
from foldcut.exporters import export, export_job
from foldcut.exporters.legend import Ground
from foldcut.jobs.job import make_jobs
from foldcut.jobs.marks import MARKS
from foldcut.profiles import load_profile

SVG = "{http://www.w3.org/2000/svg}"
POINTS_A_MM = 72 / MM_PER_INCH
PRINTER = load_profile("printer-a4")


def grid(width: float, height: float, gap: float) -> Floats:
    """Return lines up and across a page, ``(n, 2, 2)``, so far from each other."""
    up = [[(x, 0.0), (x, height)] for x in np.arange(0.0, width + 1e-9, gap)]
    across = [[(0.0, y), (width, y)] for y in np.arange(0.0, height + 1e-9, gap)]
    return np.array(up + across)


def test_an_empty_page_has_its_legend_in_the_lower_left_corner() -> None:
    place = Ground(200, 100, 5).place([(60, 20), (30, 40)], 1.0)
    assert (place.box, place.x, place.y) == (0, 5, 5)


def test_a_gap_in_a_grid_is_found_by_the_box_that_fits_it() -> None:
    ground = Ground(200, 100, 5)
    lines = grid(200, 100, 5)
    hole = shapely.box(121, 41, 159, 64)
    ground.add_lines(np.array([line for line in lines if not shapely.LineString(line).intersects(hole)]))
    for low, high in ((0, 120), (160, 200)):  # what is left of the lines through the gap
        ground.add_lines(np.array([[(low, y), (high, y)] for y in range(45, 65, 5)], dtype=np.float64))
    for low, high in ((0, 40), (65, 100)):
        ground.add_lines(np.array([[(x, low), (x, high)] for x in range(125, 160, 5)], dtype=np.float64))
    place = ground.place([(60, 20), (30, 20)])
    assert place.box == 1
    assert shapely.box(120, 40, 160, 65).contains(shapely.box(place.x, place.y, place.x + 30, place.y + 20))
    assert ground.lines_under(place.x, place.y, 30, 20) == 0
    assert ground.lines_under(40, 40, 20, 20) == pytest.approx(2 * 5 * 20, rel=0.2)


def test_beside_the_shape_is_better_than_in_it_and_a_filled_box_is_left_free() -> None:
    ground = Ground(100, 100, 0)
    centres = ground.centres()
    ground.set_shape(centres[:, 0] < 50)
    place = ground.place([(20, 10)])
    assert place.x >= 50 - ground.cell
    ground.fill(place.x, place.y, 20, 10)
    other = ground.place([(20, 10)])
    assert other.x >= 50 - ground.cell
    assert not shapely.box(other.x, other.y, other.x + 20, other.y + 10).overlaps(
        shapely.box(place.x, place.y, place.x + 20, place.y + 10)
    )


def test_a_page_with_no_room_has_its_legend_in_the_corner_all_the_same() -> None:
    place = Ground(12, 4, 5).place([(60, 20), (30, 40)])
    assert (place.box, place.x, place.y) == (1, 5, 5)


def folded(name: str, sheet: str = "a4") -> FoldedPattern:
    return folded_sample(name, sheet)


@pytest.mark.parametrize("name", ["house", "star"])
def test_no_line_goes_through_the_words_of_a_drawings_legend(name: str) -> None:
    pattern = folded(name)
    creases = pattern.creases
    inner = creases.edges_vertices[creases.edges_assignment != "B"]
    loops = [shapely.LinearRing(loop) for loop in pattern.shape.loops]
    lines = shapely.union_all([*shapely.linestrings(creases.vertices_coords[inner]), *loops])
    legend = ET.fromstring(export(pattern, ".svg")).findall(f"{SVG}g")[-1]
    words = list(legend.iter(f"{SVG}text"))
    assert len(words) >= 5
    for text in words:
        x, y, size = (float(text.attrib[key]) for key in ("x", "y", "font-size"))
        y = pattern.sheet.height - y
        assert not shapely.box(x, y, x + 0.6 * size * len(text.text or ""), y + size).intersects(lines), text.text
    assert not legend.findall(f"{SVG}rect"), "and so there is nothing to back"


def test_where_no_room_is_for_all_the_ruler_lies_apart_from_what_lines_mean() -> None:
    legend = ET.fromstring(export(folded("fish"), ".svg")).findall(f"{SVG}g")[-1]
    heights = {text.text: float(text.attrib["y"]) for text in legend.iter(f"{SVG}text")}
    ruler, key = heights["50 mm"], [y for text, y in heights.items() if text not in ("50 mm", "Fish")]
    assert min(abs(y - ruler) for y in key) > 50
    backed = [float(box.attrib["y"]) + float(box.attrib["height"]) for box in legend.iter(f"{SVG}rect")]
    assert all(abs(y - ruler) < 2 for y in backed), "nothing lies under the key"


def words_in_pdf(data: bytes) -> list[tuple[str, tuple[float, float, float, float]]]:
    """Return the texts on the first page, and where they are in mm: left, bottom, right, top."""
    page = pypdfium2.PdfDocument(data)[0].get_textpage()
    boxes = [page.get_rect(number) for number in range(page.count_rects())]
    return [(page.get_text_bounded(*box), tuple(edge / POINTS_A_MM for edge in box)) for box in boxes]


@pytest.mark.parametrize("name", ["house", "fish", "star"])
def test_no_mark_crease_or_ruler_goes_through_the_words_of_a_printed_legend(name: str) -> None:
    (job,) = make_jobs(folded(name), PRINTER, marks=tuple(MARKS))
    lines = shapely.union_all([shapely.LineString(stroke) for step in job.steps for stroke in step.strokes])
    assert job.size == (210, 297)
    words = words_in_pdf(export_job(job, ".pdf", PRINTER))
    legend = [box for text, box in words if "mm" not in text]
    assert len(legend) == 4  # the sheet's edge is the paper's, which no printer reaches
    for left, bottom, right, top in legend:
        assert not shapely.box(left, bottom, right, top).intersects(lines)
    (ruler,) = (box for text, box in words if "mm" in text)
    assert not any(shapely.box(ruler[0] - 102, *ruler[1:]).intersects(shapely.box(*box)) for box in legend)


def test_a_printed_legend_lies_beside_a_sheet_that_leaves_room_on_the_page() -> None:
    (job,) = make_jobs(folded("star", "148x105mm"), PRINTER, marks=tuple(MARKS))
    left, low = (210 - 148) / 2, (297 - 105) / 2
    sheet = shapely.box(left, low, left + 148, low + 105)
    words = words_in_pdf(export_job(job, ".pdf", PRINTER))
    assert len(words) == 6
    assert not any(shapely.box(*box).intersects(sheet) for _, box in words)


def test_words_with_lines_under_them_have_a_backing_through_which_these_are_seen() -> None:
    pattern = folded("fish", "60x45mm")
    legend = ET.fromstring(export(pattern, ".svg")).findall(f"{SVG}g")[-1]
    backings = legend.findall(f"{SVG}rect")
    assert backings
    assert all(float(backing.attrib["fill-opacity"]) < 1 for backing in backings)
    assert legend[: len(backings)] == backings, "they lie under the words"
