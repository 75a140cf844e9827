"""Holding tabs: what is left of the outline, on every machine that cuts, and what is refused."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import shapely
from support.folded import folded_sample

from foldcut.core.model import Sheet
from foldcut.exporters import export_job
from foldcut.jobs.errors import JobError
from foldcut.jobs.instructions import instructions
from foldcut.jobs.job import check_job, make_jobs
from foldcut.jobs.tabs import CORNER_MM, Tabs, cut_around_tabs, parse_tabs
from foldcut.output.render import job_files
from foldcut.profiles import load_profile, profile_names

MACHINES = [name for name in profile_names() if load_profile(name).operations]
CUTTING = [name for name in MACHINES if load_profile(name).kind in ("laser", "cutter")]
SHEETS = [(210.0, 297.0), (100.0, 100.0), (300.0, 40.0), (61.3, 97.7)]


def outline(width: float, height: float) -> np.ndarray:
    return np.array([[0, 0], [width, 0], [width, height], [0, height], [0, 0]], dtype=np.float64)


@pytest.mark.parametrize("kerf", [0.0, 0.2])
@pytest.mark.parametrize("count", [1, 2, 3, 4, 7, 12])
@pytest.mark.parametrize("size", SHEETS)
def test_what_is_not_cut_are_even_tabs_away_from_corners(size: tuple[float, float], count: int, kerf: float) -> None:
    whole, width = outline(*size), 0.8
    pieces = cut_around_tabs(whole, Tabs(count, width), kerf)
    line, cut = shapely.LineString(whole), shapely.MultiLineString(pieces)
    assert shapely.covers(line.buffer(1e-6), cut)
    left = shapely.get_parts(shapely.line_merge(shapely.difference(line, cut.buffer(1e-7, cap_style="flat"))))
    assert len(left) == count == len(pieces)
    # what the kerf eats at both ends leaves the width that was asked for
    assert shapely.length(left) - kerf == pytest.approx(width, abs=1e-5)
    corners = shapely.MultiPoint(whole[:-1])
    assert min(shapely.distance(part, corners) for part in left) >= CORNER_MM - 1e-5
    around = np.sort([shapely.line_locate_point(line, part.centroid) for part in left])
    ways = np.diff([*around, around[0] + line.length])
    assert ways == pytest.approx(line.length / count, abs=1e-4)


def test_no_other_even_tabs_are_farther_from_the_corners() -> None:
    whole = outline(61.3, 97.7)
    line, corners = shapely.LineString(whole), shapely.MultiPoint(whole[:-1])

    def room(first: float, count: int) -> float:
        places = (first + line.length / count * np.arange(count)) % line.length
        return min(shapely.distance(shapely.line_interpolate_point(line, place), corners) for place in places.tolist())

    for count in (2, 3, 5):
        pieces = cut_around_tabs(whole, Tabs(count, 1.0))
        first = shapely.line_locate_point(line, shapely.Point(pieces[0][0])) - 0.5
        best = max(room(start, count) for start in np.linspace(0, line.length / count, 400).tolist())
        assert room(first, count) >= best - 0.01


@pytest.mark.parametrize("machine", CUTTING)
def test_every_machine_that_cuts_leaves_tabs_in_its_file(machine: str) -> None:
    profile = load_profile(machine)
    pattern = folded_sample("star", "180x250mm")
    (plain,), (job,) = make_jobs(pattern, profile), make_jobs(pattern, profile, tabs=Tabs(4, 3.0))
    assert [step.role for step in job.steps] == [step.role for step in plain.steps]
    assert plain.steps[-1].length - job.steps[-1].length == pytest.approx(4 * 3.0)
    assert len(job.steps[-1].strokes) == 4
    suffix = f".{profile.format}"
    for name, part in job_files(job, Path(f"job{suffix}"), profile).items():
        assert export_job(part, suffix, profile), name
    told = " ".join(instructions(profile, (job,)))
    assert "is not cut at 4 tabs of 3 mm" in told
    assert "tab" not in " ".join(instructions(profile, (plain,)))


@pytest.mark.parametrize("machine", [name for name in MACHINES if name not in CUTTING])
def test_what_cuts_nothing_has_no_tabs(machine: str) -> None:
    with pytest.raises(JobError, match="cuts nothing; leave them out"):
        check_job(Sheet(180.0, 250.0), load_profile(machine), tabs=Tabs(4, 3.0))


def test_tabs_are_on_the_side_that_cuts_the_sheet_out() -> None:
    profile, pattern = load_profile("laser-dxf"), folded_sample("star", "180x250mm")
    for registration, sides in (("jig", (True, False)), ("holes", (False, True))):
        jobs = make_jobs(pattern, profile, two_sided=True, registration=registration, tabs=Tabs(4, 1.0))  # type: ignore[arg-type]
        assert tuple(job.tabs is not None for job in jobs) == sides
        told = instructions(profile, jobs)
        cut, turned = (
            next(n for n, line in enumerate(told) if words in line) for words in ("4 tabs of 1 mm", "turn the sheet ")
        )
        assert sum("4 tabs of 1 mm" in line for line in told) == 1
        # nothing is turned over in a jig while tabs hold it
        assert (cut < turned) == ("before you turn it over" in told[cut]) == (registration == "jig")


@pytest.mark.parametrize("machine", [name for name in CUTTING if load_profile(name).blade is not None])
def test_a_blade_that_would_tear_narrow_tabs_is_told_how_wide_they_have_to_be(machine: str) -> None:
    profile = load_profile(machine)
    with pytest.raises(JobError, match="tears tabs of 0.1 mm; use --tabs ") as caught:
        check_job(Sheet(180.0, 250.0), profile, tabs=Tabs(4, 0.1))
    remedy = re.search(r"--tabs (\S+) or wider", str(caught.value))
    assert remedy
    check_job(Sheet(180.0, 250.0), profile, tabs=parse_tabs(remedy[1]))


@pytest.mark.parametrize(
    ("size", "tabs"),
    [((210, 297), Tabs(400, 3.0)), ((210, 297), Tabs(1, 500.0)), ((30, 30), Tabs(2, 29.0)), ((9, 9), Tabs(3, 4.5))],
)
def test_the_remedy_for_too_many_tabs_works(size: tuple[float, float], tabs: Tabs) -> None:
    whole = outline(*size)
    with pytest.raises(
        JobError, match="has no room for them between its corners; |for more than half of that; "
    ) as caught:
        cut_around_tabs(whole, tabs, 0.2)
    remedy = re.search(r"use --tabs (\S+)", str(caught.value))
    assert remedy, caught.value
    assert len(cut_around_tabs(whole, parse_tabs(remedy[1]), 0.2)) == parse_tabs(remedy[1]).count


@pytest.mark.parametrize("machine", ["grbl-laser", "glowforge", "drag-knife"])
@pytest.mark.parametrize("tabs", ["4x1e-9", "4x0.05mm", "1x1000mm", "4x100mm", "2x20.1mm", "26x10mm", "40x7mm"])
def test_tabs_hold_the_sheet_and_leave_half_of_its_outline_or_more_to_be_cut(machine: str, tabs: str) -> None:
    profile, sheet = load_profile(machine), Sheet(148.0, 105.0)
    with pytest.raises(JobError, match="--tabs") as caught:
        check_job(sheet, profile, tabs=parse_tabs(tabs))
    remedy = re.search(r"use --tabs (\S+)", str(caught.value))
    assert remedy
    check_job(sheet, profile, tabs=parse_tabs(remedy[1]))


def test_a_sheet_without_room_for_any_tab_says_so() -> None:
    with pytest.raises(JobError, match="leave --tabs out"):
        cut_around_tabs(outline(3, 3), Tabs(1, 0.5))


@pytest.mark.parametrize(
    ("text", "tabs"), [("4x0.5mm", Tabs(4, 0.5)), (" 2 X .1cm", Tabs(2, 1.0)), ("3×2", Tabs(3, 2))]
)
def test_tabs_are_read(text: str, tabs: Tabs) -> None:
    assert parse_tabs(text) == tabs


@pytest.mark.parametrize("text", ["4", "x2", "0x2mm", "4x0", "4.5x2", "-4x2", "4x2x1", "4x2foot", "1e9x2", "nan", ""])
def test_what_are_no_tabs_is_told(text: str) -> None:
    with pytest.raises(JobError, match="such as 4x0.5mm"):
        parse_tabs(text)
