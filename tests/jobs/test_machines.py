"""What files for machines must hold for every profile: layers the operator is told of, both sides, reach, tools."""

from __future__ import annotations

import io
import itertools
import math
import re
import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pikepdf
import pypdfium2
import pytest
import shapely
import svgelements
from support.folded import folded_sample
from support.patterns import build_pattern

from foldcut.core.arrays import Floats
from foldcut.core.model import FoldedPattern
from foldcut.exporters import export_job
from foldcut.exporters.job.lbrn2 import PALETTE
from foldcut.jobs.bed import Lay, TurnedOver
from foldcut.jobs.blade import holder_path
from foldcut.jobs.coupon import make_coupon
from foldcut.jobs.dashes import Cuts, perforations, sines
from foldcut.jobs.errors import JobError
from foldcut.jobs.instructions import instructions
from foldcut.jobs.job import Job, make_jobs
from foldcut.output.render import job_files
from foldcut.profiles import Blade, Dash, Profile, load_profile, profile_names

MACHINES = [name for name in profile_names() if load_profile(name).operations]
CUTTING = [name for name in MACHINES if load_profile(name).kind in ("laser", "cutter")]
TREATMENTS = ("score", "perforate", "draw")


@cache
def folded(sample: str, sheet: str = "180x250mm") -> FoldedPattern:
    return folded_sample(sample, sheet)


def files(jobs: tuple[Job, ...], profile: Profile) -> dict[str, bytes]:
    """The files of jobs in the machine's own format, by name."""
    suffix = f".{profile.format}"
    parts = [job_files(job, Path(f"{job.side}{suffix}"), profile) for job in jobs]
    return {str(name): export_job(job, suffix, profile) for some in parts for name, job in some.items()}


# Layers: what is in a file, as programs that are not ours see it, and what the operator is told


def layers_in(data: bytes, profile: Profile) -> set[str]:
    """The layers of a DXF or PDF, the colours of an SVG, the pens of HPGL, the layers that comments in G-code name."""
    if profile.format == "dxf":
        return {entity.dxf.layer for entity in ezdxf.read(io.StringIO(data.decode())).modelspace()}
    if profile.format == "svg":
        svg = svgelements.SVG.parse(io.BytesIO(data), ppi=25.4)
        return {path.stroke.hex for path in svg.elements(lambda found: isinstance(found, svgelements.Path))}
    if profile.format == "lbrn2":
        settings = {one.find("index"): one.find("name") for one in ET.fromstring(data).iter("CutSetting")}
        names = {index.get("Value"): name.get("Value") for index, name in settings.items()}  # type: ignore[union-attr]
        return {str(names[shape.get("CutIndex")]) for shape in ET.fromstring(data).iter("Shape")}
    if profile.format == "pdf":
        with pikepdf.open(io.BytesIO(data)) as pdf:
            return {str(group.Name) for group in pdf.Root.OCProperties.OCGs}
    if profile.format == "hpgl":
        return set(re.findall(r"SP([1-9])", data.decode()))
    return set(re.findall(r"^; (?:pen \d: )?(?!foldcut)(.*)", data.decode(), re.M))


def layers_told(lines: list[str], profile: Profile) -> set[str]:
    """What the operator's steps speak of, in the words by which the file's layers are told apart."""
    pattern = {"svg": r"\([a-z ]*(#[0-9a-f]{6})", "hpgl": r", pen (\d)\)"}.get(
        profile.format, r"^(?:Front: |Back: )?([^:(]+) \((?:[a-z]+ )?#"
    )
    told = {found for line in lines for found in re.findall(pattern, line)}
    return told | ({"Legend"} if any(line.startswith("Legend: ") for line in lines) else set())


@pytest.mark.parametrize("machine", MACHINES)
def test_the_steps_speak_of_every_layer_in_the_file_and_of_no_other(machine: str) -> None:
    profile = load_profile(machine)
    kinds = ["corners", "holes", *(["jig"] if not profile.draws else [])]
    sides: list[dict[str, Any]] = [{"two_sided": True, "registration": kind} for kind in kinds]
    one_sided = itertools.product(TREATMENTS, [{}], (None, ("title", "outline")))
    two_sided = itertools.product(("perforate",), sides, (None, ("outline",)))
    for treatment, side, marks in (*one_sided, *two_sided):
        jobs = make_jobs(folded("star"), profile, treatment=treatment, marks=marks, **side)  # type: ignore[arg-type]
        check_layers(jobs, profile)
    check_layers((make_coupon(profile)[0],), profile)


def check_layers(jobs: tuple[Job, ...], profile: Profile) -> None:
    found = set().union(*(layers_in(data, profile) for data in files(jobs, profile).values()))
    told = layers_told(instructions(profile, jobs), profile)
    assert found == told
    assert found


@pytest.mark.parametrize("machine", MACHINES)
def test_every_action_of_a_machine_is_in_words(machine: str) -> None:
    profile = load_profile(machine)
    assert set(profile.does) == {"mark", "score", "perforate", "draw", "cut"}
    jobs = make_jobs(folded("star"), profile, marks=("outline",))
    lines = instructions(profile, jobs)
    assert all(any(line.startswith(f"{step.operation.layer} (") for line in lines) for step in jobs[0].steps)
    assert all(line in lines for line in profile.instructions)


@pytest.mark.parametrize("machine", MACHINES)
def test_a_setting_is_in_the_file_or_told(machine: str) -> None:
    profile = load_profile(
        machine,
        [f"materials.paper-80g.cut.{name}" for name in ("speed_mm_s=33", "power_percent=44", "force_g=55", "passes=3")],
    )
    if not profile.cut_outline:
        return
    jobs = make_jobs(folded("star"), profile)
    (words,) = (
        line for line in instructions(profile, jobs) if line.startswith(f"{jobs[0].steps[-1].operation.layer} (")
    )
    text = b"\n".join(files(jobs, profile).values()).decode("latin-1")
    if profile.format == "lbrn2":
        values = {one.tag: one.get("Value") for one in ET.fromstring(text).findall("CutSetting")[-1]}
        assert (values["speed"], values["maxPower"], values["minPower"], values["numPasses"]) == ("33", "44", "44", "3")
        assert "33 mm/s" not in words
        assert "44 %" not in words
        return
    cut = text.rpartition("CUT")[2] if profile.format == "gcode" else text.rpartition("SP2")[2]
    assert "33 mm/s" in words or "VS3;" in cut or f"F{33 * 60}" in cut
    assert "44 %" in words or "S440" in cut
    assert "55 g" in words or "FS55;" in cut
    assert "3 passes" in words or len(re.findall(r"^G0 X0 |^PU", cut, re.M)) >= 3


@pytest.mark.parametrize("machine", [name for name in MACHINES if load_profile(name).materials["paper-80g"].cut])
def test_a_setting_is_told_unless_every_file_has_room_for_it(machine: str) -> None:
    profile = load_profile(machine)
    jobs = make_jobs(folded("star"), profile)
    setting = jobs[0].steps[-1].setting
    assert setting is not None
    told = {name: " ".join(instructions(profile, jobs, [name])) for name in ("svg", "dxf", "lbrn2", "gcode", "hpgl")}
    for name in ("svg", "dxf"):
        assert f"{setting.speed_mm_s:g} mm/s" in told[name]
        assert f"{setting.speed_mm_s:g} mm/s" in " ".join(instructions(profile, jobs, [name, "lbrn2"]))
    for name, lines in told.items():  # how to load a file is said of the machine's own format only
        assert (profile.instructions[0] in lines) == (name == profile.format)
    assert not any("mm/s" in told[name] for name in ("lbrn2", "gcode", "hpgl"))
    if setting.power_percent is not None:
        power = f"{setting.power_percent:g} % of the power"
        assert power in told["svg"]
        assert power not in told["lbrn2"]
    elif setting.force_g is not None:
        assert f"{setting.force_g:g} g" in told["svg"]
        assert f"{setting.force_g:g} g" not in told["hpgl"]


# The back


def mirrored(strokes: tuple[Floats, ...], job: Job, turned_over: TurnedOver) -> list[Floats]:
    width, height = job.size
    if turned_over == "left to right":
        return [stroke * (-1, 1) + (width, 0) for stroke in strokes]
    return [stroke * (1, -1) + (0, height) for stroke in strokes]


def lines_of(strokes: Any, inside: shapely.Geometry) -> shapely.Geometry:
    return shapely.union_all([shapely.LineString(stroke) for stroke in strokes]).intersection(inside)


def apart(one: shapely.Geometry, other: shapely.Geometry) -> float:
    return float(shapely.hausdorff_distance(shapely.normalize(one), shapely.normalize(other)))


TOLD: set[tuple[str, bool]] = set()


@pytest.mark.parametrize("sheet", ["210x297mm", "297x210mm"])
@pytest.mark.parametrize("machine", MACHINES)
def test_the_back_turned_over_as_told_lies_on_the_front(machine: str, sheet: str) -> None:
    profile = load_profile(machine)
    if profile.sheet == "letter":  # no A4 fits
        sheet = sheet.replace("297", "279.4")
    pattern = folded("star", sheet)
    (both,) = make_jobs(pattern, profile)
    for kind in ("corners", "holes", "pins"):
        front, back = make_jobs(pattern, profile, two_sided=True, registration=kind, marks=())  # type: ignore[arg-type]
        assert front.turned_over == back.turned_over is not None
        by_role = {step.role: mirrored(step.strokes, back, back.turned_over) for step in back.steps}
        reached = Lay.for_machine(pattern.sheet, profile).place(corners(pattern, profile))
        inside = shapely.box(*reached.min(axis=0), *reached.max(axis=0))
        valleys = next(step.strokes for step in both.steps if step.role == "valley")
        assert apart(lines_of(by_role["valley"], inside), lines_of(valleys, inside)) < 1e-6
        if kind == "corners":
            marks = next(step.strokes for step in front.steps if step.role == "mark")
            assert apart(lines_of(by_role["mark"], inside), lines_of(marks, inside)) < 1e-6
            continue
        assert front.holes is not None
        assert back.holes is not None
        crosses = np.array([stroke.mean(axis=0) for stroke in by_role["mark"]])
        away = np.hypot(*(crosses[:, None] - front.holes[None]).transpose(2, 0, 1)).min(axis=1)
        assert away.max() < 1e-6
        holes = [stroke for step in front.steps if step.role == "cut" for stroke in step.strokes]
        middles = np.array([hole[:-1].mean(axis=0) for hole in holes])
        assert np.hypot(*(middles[:, None] - front.holes[None]).transpose(2, 0, 1)).min(axis=0).max() < 1e-6
        told = " ".join(instructions(profile, (front, back)))
        assert f"turn the sheet over {back.turned_over}" in told
        for job in (front, back):
            x, y = (job.holes + job.at)[0]  # type: ignore[operator]
            y = profile.bed.height_mm - y if profile.bed and profile.bed.origin == "upper-left" else y
            assert f"({x:.2f}, {y:.2f})" in told
    assert front.turned == (front.turned_over == "top to bottom")


def corners(pattern: FoldedPattern, profile: Profile) -> Floats:
    """The corners of what the machine reaches on both sides of the sheet."""
    left, low, right, high = Lay.for_machine(pattern.sheet, profile).room
    return np.array([(left, low), (right, high)])


def test_sheets_are_turned_over_both_ways() -> None:
    ways = {
        make_jobs(folded("star", sheet), load_profile(machine), two_sided=True)[1].turned_over
        for machine, sheet in (("cricut-maker", "297x210mm"), ("cricut-maker", "210x297mm"), ("glowforge", "210x297mm"))
    }
    assert ways == {"left to right", "top to bottom"}


@pytest.mark.parametrize("machine", CUTTING)
def test_a_jig_is_the_outline_that_the_front_cuts_last(machine: str) -> None:
    profile = load_profile(machine)
    front, back = make_jobs(folded("star"), profile, two_sided=True)
    assert [step.role for step in front.steps] == ["mountain", "cut"]
    assert [step.role for step in back.steps] == ["valley"]
    assert "lay the sheet back into the hole" in " ".join(instructions(profile, (front, back)))
    with pytest.raises(JobError, match="cuts no jig .* use --registration corners"):
        make_jobs(folded("star"), load_profile("axidraw-a4"), two_sided=True, registration="jig")


@pytest.mark.parametrize("machine", [name for name in MACHINES if load_profile(name).format == "pdf"])
def test_the_page_of_the_back_says_which_way_a_valley_folds_on_that_side(machine: str) -> None:
    profile = load_profile(machine)
    front, back = (
        pypdfium2.PdfDocument(export_job(job, ".pdf", profile))[0].get_textpage().get_text_range()
        for job in make_jobs(folded("star"), profile, two_sided=True)
    )
    assert "mountain: fold away from you" in front
    assert "valley, seen from behind: fold away from you" in back
    assert "toward you" not in back


# Plotters: where the paper is, and what the pen reaches of it. The numbers are those of vpype 1.15, vpype_config.toml:
# origin from the upper left corner, limits in units, PS, the last place of the pen.

PLOTTERS = {
    ("hp-7475a", "a4"): ((10, 206), (11040, 7721), 4, (11040, 7721), 0.02488),
    ("hp-7475a", "a3"): ((15, 287), (16158, 11040), 0, (0, 11040), 0.02488),
    ("hp-7475a", "letter"): ((10, 211), (10365, 7962), 4, (10365, 7962), 0.02488),
    ("hp-7550a", "a4"): ((12, 206), (10870, 7600), 4, (10870, 7600), 0.025),
    ("hp-7550a", "a3"): ((20, 285), (15970, 10870), 0, (0, 10870), 0.025),
    ("hp-7550a", "letter"): ((12, 211), (10170, 7840), 4, (10170, 7840), 0.025),
    ("roland-dxy", "a4"): ((0, 210), (11880, 8400), None, (0, 6040), 0.025),
    ("roland-dxy", "a3"): ((0, 297), (16800, 11880), None, (0, 6040), 0.025),
}


def plotted(data: bytes) -> Floats:
    """All places that a pen goes to, in units."""
    numbers = re.findall(r"P[UD](-?\d[^;]*);", data.decode())
    return np.array([pair for some in numbers for pair in np.array(some.split(","), dtype=int).reshape(-1, 2)])


@pytest.mark.parametrize("landscape", [False, True])
@pytest.mark.parametrize(("machine", "paper"), PLOTTERS)
def test_a_plot_is_where_it_belongs_on_its_paper(machine: str, paper: str, landscape: bool) -> None:
    (right, down), limits, selects, last, unit = PLOTTERS[machine, paper]
    sizes = {"a4": (297.0, 210.0), "a3": (420.0, 297.0), "letter": (279.4, 215.9)}
    width, height = sizes[paper]
    sheet = f"{width}x{height}mm" if landscape else f"{height}x{width}mm"
    pattern, profile = folded("star", sheet), load_profile(machine)
    (job,) = make_jobs(pattern, profile, marks=("outline",))
    data = export_job(job, ".hpgl", profile)
    points = plotted(data)
    assert (points >= 0).all()
    assert (points <= limits).all(), "nothing is beyond the hard clip"
    assert tuple(points[-1]) == last
    assert (f"PS{selects};" in data.decode()) if selects is not None else ("PS" not in data.decode())
    # the corners of the shape lie where the sheet's corner at the lower left of the paper puts them
    loop = pattern.shape.loops[0] if landscape else pattern.shape.loops[0] @ np.array([[0, 1], [-1, 0]]) + (width, 0)
    want = (loop - (right, height - down)) / unit
    want = want[((want >= 0) & (want <= limits)).all(axis=1)]
    assert len(want) >= 6
    away = np.hypot(*(points[None] - want[:, None]).transpose(2, 0, 1)).min(axis=1)
    assert away.max() < 1


def test_a_sheet_that_is_no_paper_is_drawn_with_its_outline_on_the_first_that_holds_it() -> None:
    profile = load_profile("hp-7475a")
    (job,) = make_jobs(folded("star"), profile)
    assert (job.paper, job.steps[-1].role) == ("a4", "cut")
    assert plotted(export_job(job, ".hpgl", profile)).min() >= 0
    with pytest.raises(JobError, match=r"600 x 600 mm is larger .* use --sheet a3, or 274x402mm or smaller"):
        make_jobs(folded("star", "600x600mm"), profile)


@pytest.mark.parametrize("machine", [name for name in MACHINES if load_profile(name).draws])
def test_what_is_not_reached_is_told_and_creases_go_on_to_the_edge(machine: str) -> None:
    profile = load_profile(machine)
    pattern = folded("star", f"{load_profile(machine).sheet}")
    (job,) = make_jobs(pattern, profile, marks=("outline", "first-folds", "title", "ruler"))
    lay = Lay.for_machine(pattern.sheet, profile)
    told = " ".join(instructions(profile, (job,)))
    assert ("Not reached" in told) == (max(job.missed) > 0.1)
    whole = shapely.union_all(shapely.linestrings([lay.place(line) for line in creases(pattern)]))
    drawn = shapely.union_all([shapely.LineString(s) for step in job.steps[1:3] for s in step.strokes])
    reach = shapely.box(*(lay.reach or (0, 0, *lay.size)))
    assert drawn.within(whole.intersection(reach).buffer(1e-6))
    if profile.treatment == "score":
        assert drawn.length == pytest.approx(whole.intersection(reach).length, rel=1e-6)


def creases(pattern: FoldedPattern) -> Floats:
    inner = pattern.creases.edges_assignment != "B"
    lines: Floats = pattern.creases.vertices_coords[pattern.creases.edges_vertices[inner]]
    return lines


# Beds, kerf


@pytest.mark.parametrize("machine", CUTTING)
def test_a_wide_kerf_is_part_of_what_has_to_fit_the_bed(machine: str) -> None:
    profile = load_profile(machine, ["kerf_mm=0.4"])
    (job,) = make_jobs(folded("star"), profile, marks=("outline", "title"))
    points = np.concatenate([stroke for step in job.steps for stroke in step.strokes])
    assert (points >= 0).all()
    assert (points <= job.size).all()
    assert profile.bed is not None
    assert ((points + job.at) <= (profile.bed.width_mm, profile.bed.height_mm)).all()
    sheet = f"{profile.bed.width_mm}x{profile.bed.height_mm}mm"
    tight = load_profile(machine, ["bed.width_mm=180.3", "bed.height_mm=250.3"])
    with pytest.raises(JobError, match="around it"):
        make_jobs(folded("star"), tight.model_copy(update={"kerf_mm": 0.4}))
    assert sheet


# Pens and lasers by G-code


def test_a_servo_goes_to_its_own_places_and_waits_there() -> None:
    values = ["gcode.servo_up=111", "gcode.servo_down=222", "gcode.dwell_s=0.5"]
    profile = load_profile("grbl-plotter", ["gcode.tool=servo", *values])
    (job,) = make_jobs(folded("star"), profile)
    lines = export_job(job, ".gcode", profile).decode().splitlines()
    places = [n for n, line in enumerate(lines) if line.startswith("M3")]
    assert {lines[n] for n in places} == {"M3 S111", "M3 S222"}
    assert {lines[n + 1] for n in places} == {"G4 P0.5"}
    down = False
    for line in lines:
        down = line == "M3 S222" or (down and line != "M3 S111")
        assert not (line.startswith("G0 X") and down), "the pen is up where it travels"
        assert not (line.startswith("G1 X") and not down), "and down where it draws"
    usual = load_profile("grbl-plotter", ["gcode.tool=servo"]).gcode
    assert usual is not None
    assert abs(usual.servo_up - usual.servo_down) >= 100


def test_a_pen_on_a_z_axis_plunges_at_its_own_speed_and_draws_as_often_as_asked() -> None:
    profile = load_profile("grbl-plotter", ["gcode.plunge_mm_s=3", "gcode.draw_mm_s=20"])
    (job,) = make_jobs(folded("star"), profile)
    text = export_job(job, ".gcode", profile).decode()
    assert set(re.findall(r"G1 Z0 .*", text)) == {"G1 Z0 F180"}
    assert set(re.findall(r"G1 X\S+ Y\S+ (.*)", text)) == {"F1200"}
    twice = profile.model_copy(update={"materials": {"x": profile.materials["paper-80g"].model_copy()}})
    stuff = twice.materials["x"].model_copy(update={"score": load_profile("drag-knife").materials["card-300g"].cut})
    (again,) = make_jobs(folded("star"), profile.model_copy(update={"materials": {"x": stuff}}))
    assert export_job(again, ".gcode", profile).decode().count("G1 Z0") > text.count("G1 Z0")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (["gcode.tool=servo", "gcode.servo_up=700"], "the pen would never move"),
        (["gcode.pen_up=0"], "pen_up has to be above pen_down"),
        (["gcode.travel_mm_s=80"], "unknown key gcode.travel_mm_s"),
    ],
)
def test_a_pen_that_cannot_move_is_an_error(change: list[str], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        load_profile("grbl-plotter", change)


# Drag knives


def trail(path: Floats, offset: float, start: Floats) -> Floats:
    """Where a blade goes that is dragged ``offset`` behind its holder, in small steps of the holder."""
    tip, found = start, []
    for a, b in itertools.pairwise(path):
        for share in np.linspace(0, 1, max(2, math.ceil(math.dist(a, b) / 0.01)))[1:]:
            holder = a + share * (b - a)
            pull = tip - holder
            tip = holder + pull * (offset / math.hypot(*pull))
            found.append(tip)
    return np.array(found)


@pytest.mark.parametrize(
    "stroke",
    [
        [(0, 0), (20, 0)],
        [(0, 0), (10, 0), (10, 10), (20, 12)],
        [(5, 5), (25, 5), (25, 25), (5, 25), (5, 5)],
        [(0, 0), (10, 0), (0, 1)],
    ],
)
def test_a_blade_behind_its_holder_follows_the_line(stroke: list[tuple[float, float]]) -> None:
    blade = Blade(offset_mm=0.25, overcut_mm=0.5, compensate=True)
    points = np.array(stroke, dtype=float)
    path = holder_path(points, blade)
    tip = trail(path, blade.offset_mm, points[0])
    line = shapely.LineString(points)
    assert shapely.distance(shapely.points(tip), line).max() < 0.03
    assert shapely.distance(line.segmentize(0.1), shapely.LineString(tip).buffer(0.03)) == 0
    assert line.within(shapely.LineString(np.concatenate([points[:1], tip])).buffer(0.03)), "and cuts all of it"
    if points[0].tolist() == points[-1].tolist():
        assert shapely.LineString(tip).length > line.length + 0.4, "and beyond its start"
    uncompensated = trail(points, blade.offset_mm, points[0] - (blade.offset_mm, 0))
    if len(points) > 2:
        assert shapely.distance(shapely.points(uncompensated), line).max() > 0.1


def test_a_cutter_with_one_holder_gets_a_file_for_each_tool_with_its_force_and_speed() -> None:
    profile = load_profile("drag-knife")
    setting = profile.materials["card-300g"]
    jobs = make_jobs(folded("star"), profile, material="card-300g")
    by_name = {name: data.decode() for name, data in files(jobs, profile).items()}
    assert set(by_name) == {"both-score.hpgl", "both-cut.hpgl"}
    score, cut = by_name["both-score.hpgl"], by_name["both-cut.hpgl"]
    assert setting.score is not None
    assert setting.cut is not None
    assert set(re.findall(r"FS(\d+)", score)) == {f"{setting.score.force_g:.0f}"}
    assert set(re.findall(r"FS(\d+)", cut)) == {f"{setting.cut.force_g:.0f}"}
    assert set(re.findall(r"VS(\d+)", cut)) == {"4"}
    assert set(re.findall(r"SP([1-9])", score)) == {"1"}
    assert set(re.findall(r"SP([1-9])", cut)) == {"2"}
    assert len(re.findall(r"PU\d", cut)) == 2, "two passes"
    perforated = make_jobs(folded("star"), profile, treatment="perforate")
    ((name, data),) = files(perforated, profile).items()
    assert name == "both-cut.hpgl", "perforations are cut"
    assert set(re.findall(r"SP([1-9])", data.decode())) == {"2"}


def test_a_cutter_that_changes_tools_waits_in_between_if_it_is_told_to() -> None:
    profile = load_profile("drag-knife", ["hpgl.tools=select", "hpgl.pause=NR;"])
    ((name, data),) = files(make_jobs(folded("star"), profile), profile).items()
    assert name == "both.hpgl"
    assert re.search(r"PU;\nNR;\nSP2;\nFS80;", data.decode())
    assert data.count(b"NR;") == 1


# Layers as importers see them


@pytest.mark.parametrize("machine", [name for name in MACHINES if load_profile(name).format == "svg"])
def test_a_step_is_one_object(machine: str) -> None:
    profile = load_profile(machine)
    for treatment in ("score", "perforate"):
        (job,) = make_jobs(folded("fish"), profile, treatment=treatment)  # type: ignore[arg-type]
        svg = svgelements.SVG.parse(io.BytesIO(export_job(job, ".svg", profile)), ppi=25.4)
        paths = list(svg.elements(lambda found: isinstance(found, svgelements.Path)))
        assert len(paths) == len(job.steps)
        assert {round(float(path.stroke_width), 6) for path in paths} == {profile.stroke_mm}
    assert profile.kind != "laser" or profile.stroke_mm == 0.025, "wider lines are engraved as pictures"


@pytest.mark.parametrize("machine", CUTTING)
def test_names_survive_every_importer_and_the_cut_sorts_last(machine: str) -> None:
    operations = load_profile(machine).operations
    assert all(re.fullmatch(r"[A-Z][A-Z0-9_]{0,30}", operation.layer) for operation in operations.values())
    by_colour = sorted(operations, key=lambda role: operations[role].colour)
    by_index = sorted(operations, key=lambda role: PALETTE[operations[role].colour])
    assert by_colour[-1] == by_index[-1] == "cut"
    profile = load_profile(machine)
    (job,) = make_jobs(folded("star"), profile, marks=("outline",))
    old = ezdxf.read(io.StringIO(export_job(job, ".dxf", profile.model_copy(update={"dxf_version": "R12"})).decode()))
    assert {entity.dxf.layer for entity in old.modelspace()} == {step.operation.layer for step in job.steps}


@pytest.mark.parametrize("machine", ["axidraw-a4", "axidraw-a3"])
def test_an_axidraw_stops_before_each_layer_but_the_first(machine: str) -> None:
    profile = load_profile(machine)
    for marks in (None, ()):
        (job,) = make_jobs(folded("star"), profile, marks=marks)
        first, *rest = [step.operation.layer for step in job.steps]
        assert re.match(r"\d", first)
        assert rest
        assert all(re.match(r"!\d", name) for name in rest)
        assert [name.lstrip("!")[0] for name in (first, *rest)] == sorted(
            name.lstrip("!")[0] for name in (first, *rest)
        )


@pytest.mark.parametrize("machine", [name for name in MACHINES if load_profile(name).kind == "plotter"])
def test_lines_are_unbroken_where_pens_tell_mountains_from_valleys(machine: str) -> None:
    profile = load_profile(machine)
    assert profile.operations["mountain"].pen != profile.operations["valley"].pen
    (job,) = make_jobs(folded("star"), profile)
    assert {step.action for step in job.steps} >= {"score"}
    assert sum(len(step.strokes) for step in job.steps if step.action == "score") < 12


# Perforations


@pytest.mark.parametrize(("sample", "kerf"), [("fish", 0.0), ("letter-a", 0.3), ("swan", 0.1)])
@pytest.mark.parametrize("machine", ["laser-dxf", "drag-knife"])
def test_cuts_of_two_creases_stay_apart(machine: str, sample: str, kerf: float) -> None:
    profile = load_profile(machine, [f"kerf_mm={kerf}"])
    for name in ("paper-80g", "card-300g"):
        material = profile.materials[name]
        (job,) = make_jobs(folded(sample), profile, treatment="perforate", material=name)
        strokes = [stroke for step in job.steps if step.action == "perforate" for stroke in step.strokes]
        lines = shapely.linestrings(np.array(strokes))
        first, second = shapely.STRtree(lines).query(lines, "dwithin", distance=kerf + material.web_mm - 1e-6)
        near = {(a, b) for a, b in zip(first.tolist(), second.tolist(), strict=True) if a < b}
        assert all(in_line(strokes[a], strokes[b]) for a, b in near), "only cuts of one crease are nearer"
        if profile.blade is not None:
            assert shapely.length(lines).min() >= profile.blade.offset_mm - 1e-9
        assert len(strokes) > 30


def test_the_clearance_of_a_cut_grows_with_1_by_the_sine_of_the_angle() -> None:
    angle = math.radians(20)
    ends = [(0, 0), (100, 0), (100 * math.cos(angle), 100 * math.sin(angle)), (100, 60), (0, 60)]
    edges = [(0, 1, "B"), (1, 2, "B"), (2, 3, "B"), (3, 4, "B"), (4, 0, "B"), (0, 2, "M")]
    pattern = build_pattern(ends, ends, edges, [(0, 1, 2), (0, 2, 3, 4)], [0, 1])
    assert sines(pattern.creases)[-1, 0] == pytest.approx(math.sin(angle))
    assert sines(pattern.creases)[3, 1] == 1.0, "at a right angle"
    dash = Dash(dash_mm=1.0, gap_mm=1.0, clearance_mm=0.5)
    cuts, uncut = perforations(pattern.creases, Cuts({"M": dash}, apart_mm=0.4))
    assert (uncut, math.hypot(*cuts["M"][0][0][0])) == (0, pytest.approx(0.4 / math.sin(angle)))


def test_cuts_that_are_too_near_without_a_vertex_between_them_are_left_out() -> None:
    x = [0, 40, 40.2, 100]
    ends = [(a, b) for a in x for b in (0, 60)]
    edges = [(0, 1, "B"), (6, 7, "B"), (2, 3, "M"), (4, 5, "V")]
    edges += [(low, low + 2, "B") for low in range(6)]
    pattern = build_pattern(ends, ends, edges, [(n, n + 2, n + 3, n + 1) for n in (0, 2, 4)], [0, 1, 2])
    dash = Dash(dash_mm=1.0, gap_mm=1.0, clearance_mm=0.5)
    for apart, left in ((0.1, 2), (0.4, 1)):
        cuts, uncut = perforations(pattern.creases, Cuts({"M": dash, "V": dash}, apart_mm=apart))
        assert (len(cuts["M"]) + len(cuts["V"]), uncut) == (left, 2 - left)


def in_line(one: Floats, other: Floats) -> bool:
    """Whether two cuts lie on one straight line."""
    along = one[1] - one[0]
    across = np.array([-along[1], along[0]]) / math.hypot(*along)
    return bool(np.abs((other - one[0]) @ across).max() < 1e-6)


def test_creases_that_are_left_uncut_are_counted_and_told() -> None:
    profile = load_profile("cricut-maker")
    (job,) = make_jobs(folded("fish"), profile, treatment="perforate")
    assert job.uncut > 0
    assert f"{job.uncut} creases are too short to perforate" in " ".join(instructions(profile, (job,)))
    cuts = shapely.multilinestrings(
        [stroke for step in job.steps if step.action == "perforate" for stroke in step.strokes]
    )
    lay = Lay.for_machine(folded("fish").sheet, profile)
    without = [line for line in creases(folded("fish")) if shapely.LineString(lay.place(line)).distance(cuts) > 1e-6]
    assert len(without) == job.uncut


# Strokes that go on where another ends


@pytest.mark.parametrize("machine", MACHINES)
def test_no_stroke_begins_where_the_last_one_ended(machine: str) -> None:
    profile = load_profile(machine)
    (job,) = make_jobs(folded("fish"), profile, treatment="score")
    for step in job.steps:
        if step.role in ("mountain", "valley"):
            assert not any((a[-1] == b[0]).all() for a, b in itertools.pairwise(step.strokes))
    if profile.kind == "laser":
        lines = sum(len(step.strokes) for step in job.steps[:2])
        assert lines < 0.9 * len(list(creases(folded("fish"))))
