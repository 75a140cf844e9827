"""Sheets on the bed: at a place, in several copies, and the frame around them; read back in every format."""

from __future__ import annotations

import io
import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path
from typing import Any, get_args

import ezdxf
import numpy as np
import pytest
import shapely
import svgelements
from support.folded import folded_sample

from foldcut.core.arrays import Floats
from foldcut.core.errors import FileFormatError
from foldcut.core.model import FoldedPattern, Sheet
from foldcut.exporters import FRAME_EXPORTERS, JOB_EXPORTERS, export_frame, export_job
from foldcut.jobs.arrange import APART_MM, BedLayout, laid_out, quarter_turned
from foldcut.jobs.bed import tool_border
from foldcut.jobs.errors import JobError
from foldcut.jobs.instructions import instructions
from foldcut.jobs.job import Job, check_job, make_jobs
from foldcut.output.render import JobOptions, Maker, job_files
from foldcut.profiles import Profile, Registration, load_profile, profile_names

MACHINES = [name for name in profile_names() if load_profile(name).operations]
WITH_BED = [name for name in MACHINES if load_profile(name).bed and not load_profile(name).page]
SMALL = "100x70mm"
SIZE = (100.0, 70.0)


def star() -> FoldedPattern:
    return folded_sample("star", SMALL)


def from_lower_left(corner: tuple[float, float], size: tuple[float, float], profile: Profile) -> tuple[float, float]:
    assert profile.bed is not None
    y = profile.bed.height_mm - corner[1] - size[1] if profile.bed.origin == "upper-left" else corner[1]
    return corner[0], y


def points_in(data: bytes, suffix: str, profile: Profile) -> Floats:
    """All points of a file, by a reader that is not ours, from the bed's lower left corner."""
    assert profile.bed is not None
    text = data.decode("latin-1")
    if suffix == ".dxf":
        found = []
        for entity in ezdxf.read(io.StringIO(text)).modelspace():
            if entity.dxftype() == "LINE":
                found += [entity.dxf.start, entity.dxf.end]
            else:
                is_old = entity.dxftype() == "POLYLINE"
                found += [v.dxf.location for v in entity.vertices] if is_old else [*entity.vertices()]
        return np.array([(point[0], point[1]) for point in found])
    if suffix == ".svg":
        svg = svgelements.SVG.parse(io.BytesIO(data), ppi=25.4)
        assert (svg.width, svg.height) == pytest.approx((profile.bed.width_mm, profile.bed.height_mm))
        ends = [piece.end for path in svg.elements(lambda one: isinstance(one, svgelements.Path)) for piece in path]
        return np.array([(end.x, profile.bed.height_mm - end.y) for end in ends if end is not None])
    if suffix == ".lbrn2":
        vertices = " ".join(one.text or "" for one in ET.fromstring(text).iter("VertList"))
        return np.array([tuple(map(float, pair)) for pair in re.findall(r"V([\d.e-]+) ([\d.e-]+)c0", vertices)])
    if suffix == ".gcode":
        moves = re.findall(r"^G[01] X([\d.-]+) Y([\d.-]+)", text, re.M)[:-1]  # the last goes to zero
        return np.array([tuple(map(float, pair)) for pair in moves])
    assert profile.hpgl is not None
    pairs = re.findall(r"(?<=[UD,])(\d+),(\d+)(?=[,;])", text)
    return np.array([(int(x), int(y)) for x, y in pairs]) * profile.hpgl.unit_mm


def box(points: Floats) -> list[float]:
    return [*points.min(axis=0), *points.max(axis=0)]


@pytest.mark.parametrize("machine", WITH_BED)
def test_the_sheet_lies_where_it_was_asked_for_in_every_format(machine: str) -> None:
    profile, border = load_profile(machine), tool_border(load_profile(machine))
    (job,) = make_jobs(star(), profile, layout=BedLayout(at=(40.0, 25.0)), marks=("outline",))
    (usual,) = make_jobs(star(), profile, marks=("outline",))
    x, y = from_lower_left((40.0, 25.0), SIZE, profile)
    before = np.concatenate([stroke for step in usual.steps for stroke in step.strokes]) - border + (x, y)
    for suffix in JOB_EXPORTERS:
        if (
            suffix == ".pdf"
            or (suffix == ".gcode" and profile.gcode is None)
            or (suffix == ".hpgl" and not profile.hpgl)
        ):
            continue
        if suffix == ".lbrn2" and profile.kind != "laser":
            continue
        files = job_files(job, Path(f"job{suffix}"), profile)
        seen = np.concatenate(
            [points_in(export_job(part, suffix, profile), suffix, profile) for part in files.values()]
        )
        swivel = 2 * border if suffix == ".hpgl" else 0.0  # the blade's holder goes round corners
        assert box(seen) == pytest.approx(box(before), abs=0.03 + swivel), suffix
    told = " ".join(instructions(profile, (job,)))
    assert "corner at (40, 25), in mm from the " in told
    assert ("upper left" in told.partition("at (40, 25)")[0]) == (
        profile.bed is not None and profile.bed.origin != "lower-left"
    )


@pytest.mark.parametrize("machine", WITH_BED)
def test_copies_are_alike_and_apart_and_tools_are_taken_once(machine: str) -> None:
    profile = load_profile(machine)
    one, four = (make_jobs(star(), profile, layout=BedLayout(copies=count))[0] for count in (1, 4))
    assert [step.operation for step in four.steps] == [step.operation for step in one.steps]
    for step, single in zip(four.steps, one.steps, strict=True):
        assert len(step.strokes) == 4 * len(single.strokes)
        assert step.length == pytest.approx(4 * single.length)
        parts = [step.strokes[n : n + len(single.strokes)] for n in range(0, len(step.strokes), len(single.strokes))]
        for part, corner in zip(parts, four.corners, strict=True):
            moved = np.subtract(part[0][0], single.strokes[0][0])
            up = -1 if profile.bed is not None and profile.bed.origin == "upper-left" else 1
            first = np.subtract(corner, four.corners[0]) * (1, up)
            start = np.subtract(parts[0][0][0], single.strokes[0][0])
            assert moved - start == pytest.approx(first)
    border = tool_border(profile)
    width, height = (SIZE[1], SIZE[0]) if four.turned else SIZE
    boxes = [(x - border, y - border, x + width + border, y + height + border) for x, y in four.corners]
    for n, (a, b, c, d) in enumerate(boxes):
        assert a >= -1e-6
        assert b >= -1e-6
        for e, f, g, h in boxes[:n]:
            assert max(a - g, e - c, b - h, f - d) >= APART_MM - 1e-6
    lines = instructions(profile, (four,))
    assert any(line.startswith("4 sheets lie with their ") for line in lines)


@pytest.mark.parametrize("machine", WITH_BED)
@pytest.mark.parametrize("changes", [[], ["kerf_mm=0.4"]])
def test_the_remedies_for_sheets_that_do_not_fit_work(machine: str, changes: list[str]) -> None:
    profile, sheet = load_profile(machine, changes), Sheet(100.0, 70.0)
    with pytest.raises(JobError, match="use --copies ") as caught:
        check_job(sheet, profile, layout=BedLayout(copies=999))
    (most,) = re.findall(r"--copies (\d+),", str(caught.value))
    check_job(sheet, profile, layout=BedLayout(copies=int(most)))
    with pytest.raises(JobError):
        check_job(sheet, profile, layout=BedLayout(copies=int(most) + 1))
    assert profile.bed is not None
    far = (profile.bed.width_mm - 20, profile.bed.height_mm - 20)
    with pytest.raises(JobError, match="use --at ") as caught:
        check_job(sheet, profile, layout=BedLayout(at=far))
    ((x, y),) = re.findall(r"--at ([\d.]+),([\d.]+)", str(caught.value))
    _, corners = laid_out(sheet, profile, BedLayout(at=(float(x), float(y))))
    assert len(corners) == 1
    for off in ((-1.0, 5.0), (5.0, -1.0)):
        with pytest.raises(JobError, match="is off the bed") as caught:
            check_job(sheet, profile, layout=BedLayout(at=off))
        ((x, y),) = re.findall(r"use --at ([\d.]+),([\d.]+)", str(caught.value))
        check_job(sheet, profile, layout=BedLayout(at=(float(x), float(y))))


def test_copies_are_turned_where_only_that_has_room_for_them() -> None:
    profile = load_profile("laser-dxf", ["bed.width_mm=215", "bed.height_mm=101"])
    assert not make_jobs(star(), profile, layout=BedLayout(copies=2))[0].turned
    assert make_jobs(star(), profile, layout=BedLayout(copies=3))[0].turned


def test_a_sheet_that_is_turned_is_not_mirrored() -> None:
    pattern = folded_sample("bolt", SMALL)
    (upright,) = make_jobs(pattern, load_profile("laser-dxf"))
    (lying,) = make_jobs(pattern, load_profile("laser-dxf", ["bed.width_mm=75", "bed.height_mm=110"]))
    assert (upright.turned, lying.turned) == (False, True)
    turned = quarter_turned(upright)
    assert (turned.size, turned.turned) == (lying.size, True)
    for step, other in zip(turned.steps, lying.steps, strict=True):
        assert lines_apart(step.strokes, other.strokes) < 1e-6
    mirrored = [stroke * (-1, 1) + (lying.size[0], 0) for stroke in lying.steps[0].strokes]
    assert lines_apart(turned.steps[0].strokes, mirrored) > 1, "the sample is not symmetric"
    assert lines_apart(quarter_turned(quarter_turned(turned)).steps[0].strokes, turned.steps[0].strokes) > 1


def lines_apart(some: Sequence[Floats], others: Sequence[Floats]) -> float:
    one, other = (shapely.MultiLineString([*strokes]) for strokes in (some, others))
    return float(shapely.hausdorff_distance(one, other, densify=0.1))


@pytest.mark.parametrize("machine", [name for name in MACHINES if name not in WITH_BED])
def test_what_has_no_bed_places_nothing(machine: str) -> None:
    for layout in (BedLayout(at=(5.0, 5.0)), BedLayout(copies=2)):
        with pytest.raises(JobError, match="are for a bed"):
            check_job(Sheet(100.0, 70.0), load_profile(machine), layout=layout)


def test_copies_of_two_sides_lie_in_their_own_holes() -> None:
    profile = load_profile("grbl-laser")
    layout = BedLayout(at=(10.0, 20.0), copies=6)
    front, back = make_jobs(star(), profile, two_sided=True, registration="holes", layout=layout)
    assert front.holes is not None
    assert back.holes is not None
    assert front.corners == back.corners
    # turned over left to right in its own place, each sheet's holes are where the back has its crosses
    for n, (x, _) in enumerate(front.corners):
        some, other = front.holes[3 * n : 3 * n + 3], back.holes[3 * n : 3 * n + 3]
        assert other == pytest.approx(some * (-1, 1) + (2 * x + SIZE[0], 0))
    # and so they are where all of the stock is turned over in one piece
    ends = np.array(front.corners)[:, 0]
    turned = front.holes * (-1, 1) + (ends.min() + ends.max() + SIZE[0], 0)
    assert shapely.hausdorff_distance(shapely.MultiPoint(turned), shapely.MultiPoint(back.holes)) < 1e-6


@pytest.mark.parametrize("sheet", [Sheet(100.0, 70.0), Sheet(60.0, 40.0), Sheet(55.0, 130.0)])
@pytest.mark.parametrize("machine", ["grbl-laser", "xtool-s1", "axidraw-a4", "grbl-plotter", "drag-knife"])
def test_copies_that_are_turned_over_together_lie_on_copies(machine: str, sheet: Sheet) -> None:
    profile, refused = load_profile(machine, ["bed.width_mm=290", "bed.height_mm=280"]), 0
    quarter = Sheet(sheet.height, sheet.width)
    for copies in range(1, 7):
        layout = BedLayout(copies=copies)
        lay, corners = laid_out(sheet, profile, layout, full_rows=True)
        assert lay.turned_over == ("top to bottom" if lay.turned else "left to right")
        places = np.array(corners)
        middle = (places.min(axis=0) + places.max(axis=0)) / 2
        for registration in get_args(Registration):
            try:
                check_job(sheet, profile, layout=layout, registration=registration)
            except JobError as error:
                refused += 1
                # a drawing may turn its sheet by a quarter after this was told
                with pytest.raises(JobError, match=re.escape(str(error).rpartition("; use ")[2])):
                    check_job(quarter, profile, layout=layout, registration=registration)
                for remedy in str(error).rpartition("; use ")[2].split(", "):
                    words = dict(re.findall(r"--(registration|copies) (\w+)", remedy))
                    assert words, error
                    kept: Any = words.get("registration", "corners" if words.get("copies") == "1" else registration)
                    fewer = BedLayout(copies=int(words.get("copies", copies)))
                    check_job(sheet, profile, layout=fewer, registration=kept)
                continue
            assert copies == 1 or registration != "corners"
            if registration != "jig":
                for over in ((-1, 1), (1, -1)):
                    turned = shapely.MultiPoint((places - middle) * over + middle)
                    assert shapely.hausdorff_distance(turned, shapely.MultiPoint(places)) < 1e-6
    assert refused >= 5


@pytest.mark.parametrize("machine", [n for n in MACHINES if f".{load_profile(n).format}" in FRAME_EXPORTERS])
@pytest.mark.parametrize("changes", [[], ["gcode.tool=servo"]])
def test_a_frame_goes_round_everything_with_the_tool_off(machine: str, changes: list[str]) -> None:
    if changes and machine != "grbl-plotter":
        return
    profile = load_profile(machine, changes)
    options = JobOptions(layout=BedLayout(copies=2) if machine in WITH_BED else BedLayout(), framed=True)
    maker = Maker(star(), profile, options)
    path = Path(f"job.{profile.format}")
    files = maker.files(path)
    assert {*files} <= {*options.targets(path, profile)}
    assert next(iter(files)).stem == "job-frame"
    text = files[Path(f"job-frame.{profile.format}")].decode()
    job = maker.jobs["both"]
    if profile.format == "hpgl":
        assert "PD" not in text
        pairs = re.findall(r"PU(\d+),(\d+);", text)
        assert profile.hpgl is not None
        seen = np.array([(int(x), int(y)) for x, y in pairs])[:5] * profile.hpgl.unit_mm
    else:
        seen = np.array([tuple(map(float, pair)) for pair in re.findall(r"X([\d.-]+) Y([\d.-]+)", text)])[:-1]
        assert profile.gcode is not None
        if profile.gcode.tool == "laser":
            assert "M3" not in text
            assert "M4" not in text
            assert {*re.findall(r"S(\d+)", text)} == {"0"}
        elif profile.gcode.tool == "servo":
            assert {*re.findall(r"S(\d+)", text)} == {str(profile.gcode.servo_up)}
        else:
            assert {*re.findall(r"Z([\d.]+)", text)} == {f"{profile.gcode.pen_up:g}"}
    everything = np.concatenate([stroke for step in job.steps for stroke in step.strokes]) + job.at
    assert box(seen) == pytest.approx(box(everything), abs=0.03)
    assert "in -frame goes round the job" in " ".join(instructions(profile, (job,)))


@pytest.mark.parametrize("suffix", [suffix for suffix in JOB_EXPORTERS if suffix not in FRAME_EXPORTERS])
def test_a_format_without_moves_has_no_frame(suffix: str) -> None:
    job = Job("", (1.0, 1.0), (0.0, 0.0), False, "both", (), 0.0, 0.0)
    with pytest.raises(FileFormatError, match=r"--frame needs moves with the tool off"):
        export_frame(job, suffix, load_profile("laser-dxf"))
