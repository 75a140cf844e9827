"""Jobs, and every format of theirs read back by programs that are not ours: the same strokes, where they belong."""

from __future__ import annotations

import contextlib
import dataclasses
import io
import itertools
import re
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import ezdxf
import numpy as np
import pytest
import shapely
import svgelements
from numpy.testing import assert_allclose
from scipy.optimize import linear_sum_assignment
from support.folded import folded_sample
from support.patterns import book_fold
from support.places import TESTS
from support.programs import missing, require_program, run_node, run_program
from support.samples import TESTED

from foldcut.core.arrays import Floats
from foldcut.core.model import FoldedPattern
from foldcut.exporters import export_job
from foldcut.jobs.bed import Side
from foldcut.jobs.blade import holder_path
from foldcut.jobs.errors import JobError
from foldcut.jobs.job import Job, make_jobs
from foldcut.jobs.pages import tiles
from foldcut.pattern.straight_lines import straight_lines
from foldcut.pipeline import fold
from foldcut.profiles import Profile, load_profile, profile_names
from foldcut.samples import sample_path

MACHINES = [name for name in profile_names() if load_profile(name).operations]
MACHINES_OF = {
    kind: [name for name in MACHINES if load_profile(name).format == kind] for kind in ("dxf", "gcode", "hpgl", "pdf")
}
NEAR_MM = {".svg": 0.001, ".dxf": 0.001, ".gcode": 0.001, ".hpgl": 0.025, ".pdf": 0.001, ".lbrn2": 0.001}


@cache
def folded(name: str, method: str = "auto") -> FoldedPattern:
    sheet = "180x250mm"  # fits every machine
    return folded_sample(name, sheet, method)


def export_jobs(pattern: FoldedPattern, suffix: str, profile: Profile, **options: Any) -> dict[Side, tuple[Job, bytes]]:
    """Make the jobs, and their files, by the side of the sheet."""
    return {job.side: (job, export_job(job, suffix, profile)) for job in make_jobs(pattern, profile, **options)}


@cache
def made(machine: str, sample: str = "bolt", two_sided: bool = False) -> dict[Side, tuple[Job, bytes]]:
    profile = load_profile(machine)
    return export_jobs(folded(sample), f".{profile.format}", profile, two_sided=two_sided)


# What the readers see: strokes by layer, colour, pen or comment, in mm, y up from the sheet's lower left corner.

Strokes = dict[str, list[Floats]]


def read_dxf(data: bytes, job: Job) -> Strokes:
    """Read DXF with ezdxf: strokes by layer."""
    document = ezdxf.read(io.StringIO(data.decode()))
    found: Strokes = {}
    for entity in document.modelspace():
        if entity.dxftype() == "LINE":
            points = [entity.dxf.start, entity.dxf.end]
        else:
            vertices = (
                [v.dxf.location for v in entity.vertices] if entity.dxftype() == "POLYLINE" else entity.vertices()
            )
            points = [*vertices]
            if entity.is_closed if entity.dxftype() == "POLYLINE" else entity.closed:
                points.append(points[0])
        found.setdefault(entity.dxf.layer, []).append(np.array([(p[0], p[1]) for p in points]))
    return found


def read_svg(data: bytes, job: Job) -> Strokes:
    """Read SVG with svgelements at 25.4 pixels an inch: strokes by colour."""
    svg = svgelements.SVG.parse(io.BytesIO(data), ppi=25.4)
    found: Strokes = {}
    for compound in svg.elements(lambda element: isinstance(element, svgelements.Path)):
        assert compound.stroke.hex not in found, "one path for each step"
        for path in map(list, compound.as_subpaths()):
            points = [(path[0].end.x, path[0].end.y), *((piece.end.x, piece.end.y) for piece in path[1:])]
            flipped = np.array(points) * (1, -1) + (0, job.size[1])
            found.setdefault(compound.stroke.hex, []).append(flipped)
    return found


def read_gcode(data: bytes, job: Job) -> Strokes:
    """Read G-code by GRBL's rules for X, Y, Z, S, G0, G1: strokes by the comment before them."""
    found: Strokes = {}
    name, here, stroke = "", np.zeros(2), [np.zeros(2)]
    stroke_name = name
    for line in data.decode().splitlines():
        if line.startswith(";"):
            name = line[2:].partition(": ")[2] or line[2:]
        words = dict(re.findall(r"([GXYZSFMP])(-?[\d.]+)", line))
        if "X" not in words:
            continue
        to = np.array([float(words["X"]), float(words["Y"])])
        if words["G"] == "0":
            if len(stroke) > 1:
                found.setdefault(stroke_name, []).append(np.array(stroke))
            stroke, stroke_name = [to], name
        else:
            stroke.append(to)
        here = to
    assert_allclose(here, 0)
    return {name: [stroke - job.at for stroke in strokes] for name, strokes in found.items()}


def named(job: Job, suffix: str) -> Strokes:
    """The job's own strokes, by what a reader of the format tells them apart by."""
    found: Strokes = {}
    for step in job.steps:
        name = step.operation.colour if suffix == ".svg" else step.operation.layer
        found.setdefault(name, []).extend(step.strokes)
    return found


def differences(seen: Strokes, job: Job, suffix: str, near: float | None = None) -> list[str]:
    """List what a reader sees otherwise than the job has it; ``near`` in mm is what the reader itself rounds.

    Every point where it belongs: the length of each operation and the bounding box are right, too.
    """
    faults = []
    for name, strokes in named(job, suffix).items():
        there = seen.get(name, [])
        if len(there) != len(strokes):
            faults.append(f"{name}: {len(there)} strokes for {len(strokes)}")
            continue
        away = max(
            float(np.abs(a - b).max()) if a.shape == b.shape else np.inf for a, b in zip(there, strokes, strict=True)
        )
        if away > (near or NEAR_MM[suffix]):
            faults.append(f"{name}: off by {away} mm")
    faults += [f"{name}: not in the job" for name in seen.keys() - named(job, suffix).keys()]
    return faults


def read_pdf(data: bytes, folder: Path) -> list[Strokes]:
    """Read PDF with mutool: for each page strokes by layer, in mm from its lower left corner."""
    path = folder / "job.pdf"
    path.write_bytes(data)
    run_program(require_program("qpdf"), "--check", path)
    pages = []
    for page in ET.fromstring(run_program(require_program("mutool"), "trace", path)).iter("page"):
        height = float(page.attrib["mediabox"].split()[3])
        found: Strokes = {}
        layer = ""
        for element in page:
            if element.tag == "layer":
                layer = element.attrib["name"]
            elif element.tag == "end_layer":
                layer = ""
            elif element.tag == "stroke_path" and layer not in ("", "Legend"):
                a, b, c, d, e, f = map(float, element.attrib["transform"].split())
                points = np.array(
                    [[float(part.attrib["x"]), float(part.attrib["y"])] for part in element if "x" in part.attrib]
                )
                placed = points @ np.array([[a, b], [c, d]]) + (e, f)
                found.setdefault(layer, []).append((placed * (1, -1) + (0, height)) / 72 * 25.4)
        pages.append(found)
    return pages


READERS = {".dxf": read_dxf, ".svg": read_svg, ".gcode": read_gcode}


def read_with_node(script: str, kind: str, sample: str, folder: Path) -> list[tuple[str, Any]]:
    """Read a sample's files for all machines of a format with one start of node: machine and what the script says."""
    paths = [folder / f"{machine}.{kind}" for machine in MACHINES_OF[kind]]
    for path in paths:
        ((_, data),) = made(path.stem, sample).values()
        path.write_bytes(data)
    return list(zip(MACHINES_OF[kind], run_node(script, *paths), strict=True))


@pytest.mark.parametrize("sample", sorted({*TESTED} - {"marlin"}))  # it has the strokes of ten others
def test_every_stroke_is_read_back_on_every_machine(sample: str) -> None:
    for machine in MACHINES:
        suffix = f".{load_profile(machine).format}"
        if suffix in READERS:
            ((job, data),) = made(machine, sample).values()
            assert differences(READERS[suffix](data, job), job, suffix) == [], machine


@pytest.mark.parametrize("sample", sorted({*TESTED} - {"marlin"}))
def test_dxf_parser_reads_every_stroke_in_mm(sample: str, tmp_path: Path) -> None:
    for machine, seen in read_with_node("dxf_parser.cjs", "dxf", sample, tmp_path):
        ((job, _),) = made(machine, sample).values()
        # INSUNITS 4 is mm; R12 has no such header
        assert seen["unit"] == (None if load_profile(machine).dxf_version == "R12" else 4)
        layers = {name: [np.array(stroke) for stroke in strokes] for name, strokes in seen["layers"].items()}
        assert differences(layers, job, ".dxf") == []
        assert differences({name: strokes[1:] for name, strokes in layers.items()}, job, ".dxf")


def test_inkscapes_importer_reads_dxf_at_true_size(tmp_path: Path) -> None:
    require_program("inkscape")
    importer = Path("/usr/share/inkscape/extensions/dxf_input.py")
    if not importer.is_file():
        missing("inkscape", "its DXF importer is not there")
    ((job, data),) = made("laser-dxf").values()
    path = tmp_path / "job.dxf"
    path.write_bytes(data)
    # its own Python packages are the system's
    root = ET.fromstring(run_program("/usr/bin/python3", importer, path))
    label = "{http://www.inkscape.org/namespaces/inkscape}label"
    height = float(root.attrib["height"])
    seen: Strokes = {}
    for layer in root.iter("{http://www.w3.org/2000/svg}g"):
        for drawn in layer.iter("{http://www.w3.org/2000/svg}path"):
            points = np.array(re.findall(r"-?[\d.]+", drawn.attrib["d"]), dtype=float).reshape(-1, 2)
            if drawn.attrib["d"].rstrip().lower().endswith("z") and (points[0] != points[-1]).any():
                points = np.concatenate([points, points[:1]])
            seen.setdefault(layer.attrib[label], []).append((points * (1, -1) + (0, height)) * 25.4 / 96)
    assert differences(seen, job, ".dxf", near=0.005) == []


def test_librecad_prints_dxf_at_true_size(tmp_path: Path) -> None:
    librecad, mutool = require_program("librecad"), require_program("mutool")
    ((job, data),) = made("laser-dxf").values()
    path = tmp_path / "job.dxf"
    path.write_bytes(data)
    width, height = job.size
    paper = f"{width:g}x{height:g}"
    run_program("env", "QT_QPA_PLATFORM=offscreen", librecad, "dxf2pdf", "-p", paper, "-f", "0,0,0,0", "-s", "1", path)
    seen = []
    for page in ET.fromstring(run_program(mutool, "trace", path.with_suffix(".pdf"))).iter("page"):
        top = float(page.attrib["mediabox"].split()[3]) / 72 * 25.4
        for drawn in page.iter("stroke_path"):
            scale = float(drawn.attrib["transform"].split()[0]) / 72 * 25.4
            points = np.array([[float(part.attrib["x"]), float(part.attrib["y"])] for part in drawn]) * scale
            seen.append(points * (1, -1) + (0, top))
    ours = np.concatenate([np.stack([s[:-1], s[1:]], axis=1) for step in job.steps for s in step.strokes])
    assert len(seen) == len(ours)
    # its PDF has 1200 dots an inch, and ends are rounded more than once
    assert_allclose(np.sort(np.array(seen).reshape(-1, 4), axis=0), np.sort(ours.reshape(-1, 4), axis=0), atol=0.1)


@pytest.mark.parametrize("sample", TESTED)
def test_gcode_toolpath_reads_every_stroke(sample: str, tmp_path: Path) -> None:
    for machine, moves in read_with_node("gcode_toolpath.cjs", "gcode", sample, tmp_path):
        ((job, _),) = made(machine, sample).values()
        drawn = np.array([[x, y, u, v] for rapid, x, y, _, u, v, _ in moves if not rapid and (x, y) != (u, v)])
        ours = np.concatenate([np.hstack([s[:-1], s[1:]]) for step in job.steps for s in step.strokes])
        assert len(drawn) == len(ours)
        assert_allclose(drawn, ours + np.tile(job.at, 2), atol=NEAR_MM[".gcode"], rtol=0)
        with pytest.raises(AssertionError):
            assert_allclose(drawn + 0.01, ours + np.tile(job.at, 2), atol=NEAR_MM[".gcode"], rtol=0)


@pytest.mark.parametrize("machine", ["laser-dxf", "glowforge", "grbl-laser"])
def test_the_comparison_sees_what_is_lost_moved_or_in_the_wrong_layer(machine: str) -> None:
    suffix = f".{load_profile(machine).format}"
    ((job, data),) = made(machine).values()
    seen = READERS[suffix](data, job)
    one, other, *_ = seen
    lost = {**seen, one: seen[one][1:]}
    moved = {**seen, one: [seen[one][0] + 0.002, *seen[one][1:]]}
    swapped = {**seen, one: seen[other], other: seen[one]}
    extra = {**seen, "extra": seen[one]}
    assert all(differences(wrong, job, suffix) for wrong in (lost, moved, swapped, extra))


def read_hpgl(data: bytes, tmp_path: Path) -> dict[int, Floats]:
    """Read HPGL with hp2xx: by pen the ends of lines, ``(n, 2, 2)`` in mm of 40 units each."""
    hp2xx = require_program("hp2xx")
    plot, drawing = tmp_path / "job.hpgl", tmp_path / "job.dxf"
    plot.write_bytes(data)
    run_program(hp2xx, "-q", "-t", "-S", 1, "-m", "dxf", "-f", drawing, plot)  # -S 1: the pen's number is the colour
    ends: dict[int, list[list[list[float]]]] = {}
    lines = drawing.read_text().split()
    for n, word in enumerate(lines):
        if word == "LINE":
            codes = dict(zip(lines[n + 1 : n + 17 : 2], lines[n + 2 : n + 18 : 2], strict=True))
            end = [[float(codes["10"]), float(codes["20"])], [float(codes["11"]), float(codes["21"])]]
            ends.setdefault(int(codes["62"]), []).append(end)
    return {pen: np.array(some) for pen, some in ends.items()}


def plot_differs(seen: dict[int, Floats], job: Job, profile: Profile) -> bool:
    """Whether hp2xx sees other lines than the job has, or with another pen; a blade's holder is led."""
    assert profile.hpgl is not None
    unit_mm = profile.hpgl.unit_mm
    blade = profile.blade if profile.blade is not None and profile.blade.compensate else None
    drawn: dict[int, list[Floats]] = {}
    for step in job.steps:
        assert step.operation.pen is not None
        paths = step.strokes if blade is None else [holder_path(stroke, blade) for stroke in step.strokes]
        some = [np.stack([s[:-1], s[1:]], axis=1) for s in paths]
        drawn.setdefault(step.operation.pen, []).extend(some)
    corner = np.min([some.min(axis=(0, 1)) for strokes in drawn.values() for some in strokes], axis=0)
    if drawn.keys() != seen.keys():
        return True
    for pen, strokes in drawn.items():
        ours = np.concatenate(strokes)
        units = np.rint((ours + job.at) / unit_mm)
        ours = ours[(units[:, 0] != units[:, 1]).any(axis=1)]  # hp2xx leaves points out
        # hp2xx moves the plot to its own corner, and takes 0.025 mm for every plotter's unit
        theirs = seen[pen] * unit_mm / 0.025 + corner
        # both the corner and the end are rounded
        if theirs.shape != ours.shape or float(np.abs(theirs - ours).max()) > NEAR_MM[".hpgl"]:
            return True
    return False


@pytest.mark.parametrize("sample", TESTED)
def test_hp2xx_reads_every_stroke_of_a_plot(sample: str, tmp_path: Path) -> None:
    for machine in MACHINES_OF["hpgl"]:
        ((job, data),) = made(machine, sample).values()
        profile = load_profile(machine)
        seen = read_hpgl(data, tmp_path)
        assert not plot_differs(seen, job, profile), machine
        one, other, *_ = seen
        lost = {**seen, one: seen[one][1:]}
        moved = {**seen, one: seen[one] + 0.06}
        swapped = {**seen, one: seen[other], other: seen[one]}
        assert all(plot_differs(wrong, job, profile) for wrong in (lost, moved, swapped))


@pytest.mark.parametrize("sample", TESTED)
def test_mutool_reads_every_stroke_of_a_page(sample: str, tmp_path: Path) -> None:
    for machine in MACHINES_OF["pdf"]:
        ((job, data),) = made(machine, sample).values()
        (page,) = read_pdf(data, tmp_path)
        bed = load_profile(machine).bed
        assert bed is not None
        corner = (np.array([bed.width_mm, bed.height_mm]) - job.size) / 2
        assert differences({name: [s - corner for s in strokes] for name, strokes in page.items()}, job, ".pdf") == []
        assert differences({name: [s * 1.001 for s in strokes] for name, strokes in page.items()}, job, ".pdf")


def test_pages_of_a_large_sheet_show_all_of_it_where_it_is(tmp_path: Path) -> None:
    pattern = fold(sample_path("star"), "a2", effort="fast").require_verified()
    profile = load_profile("printer-a4")
    ((job, data),) = export_jobs(pattern, ".pdf", profile, tile=True).values()
    pages, places = read_pdf(data, tmp_path), list(tiles(job, profile))
    assert len(pages) == len(places) == 8
    for page, tile in zip(pages, places, strict=True):
        shifted = {name: [s + np.array([tile.x, tile.y]) for s in strokes] for name, strokes in page.items()}
        assert differences(shifted, job, ".pdf") == []
    printed = shapely.union_all(
        [
            shapely.box(
                tile.x + tile.inset,
                tile.y + tile.inset,
                tile.x + tile.inset + tile.clear_width,
                tile.y + tile.inset + tile.clear_height,
            )
            for tile in places
        ]
    )
    assert printed.buffer(1e-6).contains(shapely.box(0, 0, *job.size))
    with pytest.raises(JobError, match="--tile on a printer"):
        export_jobs(pattern, ".pdf", profile)
    with pytest.raises(JobError, match="only printers take several pages"):
        export_jobs(pattern, ".dxf", load_profile("laser-dxf"), tile=True)


class _Node:
    """What meerk40t's reader builds its trees of; it keeps what is added, with the operations that refer to it."""

    def __init__(self, **values: Any) -> None:
        self.values, self.children, self.references = values, [], []

    def add(self, **values: Any) -> _Node:
        self.children.append(_Node(**values))
        return self.children[-1]

    def add_reference(self, node: _Node) -> None:
        self.references.append(node)

    def remove_all_children(self) -> None:
        self.children.clear()

    def focus(self) -> None:
        """Nothing to show."""


@pytest.mark.parametrize("sample", TESTED)
@pytest.mark.parametrize("machine", ["lightburn-diode", "lightburn-co2"])
def test_meerk40t_reads_every_stroke_of_a_lightburn_project(machine: str, sample: str) -> None:
    lbrn = pytest.importorskip("meerk40t.extra.lbrn")
    from meerk40t.core.units import UNITS_PER_MM

    profile = load_profile(machine)
    job, data = export_jobs(folded(sample), ".lbrn2", profile)["both"]
    operations, elements = _Node(), _Node()
    lock = contextlib.nullcontext()
    lbrn.LbrnLoader.parse(
        "job.lbrn2", io.BytesIO(data), SimpleNamespace(op_branch=operations, elem_branch=elements, node_lock=lock)
    )
    seen: Strokes = {}
    for operation, step in zip(operations.children, job.steps, strict=True):
        assert step.setting is not None
        assert operation.values["speed"] == step.setting.speed_mm_s
        assert operation.values["power"] == pytest.approx(10 * step.setting.power_percent)
        for node in operation.references:
            starts, ends = node.values["geometry"].segments[: node.values["geometry"].index, [0, 4]].T
            points = np.append(starts, ends[-1]) / UNITS_PER_MM
            seen.setdefault(operation.values["label"], []).append(np.stack([points.real, points.imag], axis=1) - job.at)
    assert differences(seen, job, ".lbrn2") == []
    assert differences({name: strokes[1:] for name, strokes in seen.items()}, job, ".lbrn2")


def test_dxf_is_clean_and_has_its_unit() -> None:
    for machine, version in (("laser-dxf", "AC1015"), ("silhouette-cameo", "AC1009")):
        ((job, data),) = made(machine).values()
        document = ezdxf.read(io.StringIO(data.decode()))
        assert document.dxfversion == version
        assert not document.audit().errors
        assert document.header["$EXTMAX"][:2] == job.size
        if version != "AC1009":
            assert (document.header["$INSUNITS"], document.header["$MEASUREMENT"]) == (4, 1)


def test_nothing_is_said_on_standard_error() -> None:
    code = "from support.patterns import book_fold; from foldcut.exporters import export_job; "
    code += "from foldcut.jobs.job import make_jobs; from foldcut.profiles import load_profile; "
    code += "laser = load_profile('silhouette-cameo'); export_job(make_jobs(book_fold(), laser)[0], '.dxf', laser)"
    folder = TESTS
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=folder, check=True)
    assert (done.stdout, done.stderr) == ("", "")


def test_inkscape_sees_a_job_at_true_size(tmp_path: Path) -> None:
    inkscape = require_program("inkscape")
    path = tmp_path / "job.svg"
    ((job, data),) = made("glowforge").values()
    path.write_bytes(data)
    seen = run_program(inkscape, "--query-all", path).splitlines()
    boxes = {row.split(",")[0]: [float(v) * 25.4 / 96 for v in row.split(",")[1:]] for row in seen}
    stroke = load_profile("glowforge").drawing.crease_stroke_mm
    for count, step in enumerate(job.steps, 1):
        x, y, width, height = boxes[f"step-{count}-{step.role}"]
        points = np.concatenate(step.strokes)
        low, high = points.min(axis=0), points.max(axis=0)
        assert_allclose([x, job.size[1] - y - height], low, atol=stroke)
        assert_allclose([width, height], high - low, atol=2 * stroke)


# The job itself


@pytest.mark.parametrize("machine", MACHINES)
def test_no_crease_is_lost_and_none_is_there_twice(machine: str) -> None:
    pattern = folded("plus")
    (job,) = make_jobs(pattern, load_profile(machine), treatment="score")
    creases = pattern.creases
    for step in job.steps:
        lines = shapely.multilinestrings([shapely.linestrings(stroke) for stroke in step.strokes])
        assert shapely.union_all(lines).length == pytest.approx(step.length)  # none twice
        if step.role in ("mountain", "valley"):
            some = creases.edges_assignment == step.role[0].upper()
            ends = creases.vertices_coords[creases.edges_vertices[some]]
            assert step.length == pytest.approx(np.hypot(*(ends[:, 1] - ends[:, 0]).T).sum())
    profile = load_profile(machine)
    marked = ["mark"] if profile.draws else []
    cut = ["cut"] if profile.cut_outline or job.paper is not None else []  # the sheet is smaller than any paper
    assert [step.role for step in job.steps] == [*marked, "mountain", "valley", *cut]


@pytest.mark.parametrize("machine", MACHINES)
def test_marks_are_there_by_default_only_where_nothing_is_cut(machine: str) -> None:
    profile = load_profile(machine)
    (usual,), (without,), (asked,) = (
        make_jobs(folded("bolt"), profile, marks=marks) for marks in (None, (), ("outline",))
    )
    assert ("mark" in {step.role for step in usual.steps}) == profile.draws
    assert "mark" not in {step.role for step in without.steps}
    assert asked.steps[0].role == "mark"


def test_creases_that_go_straight_on_are_one_line() -> None:
    points = np.array([(0, 0), (1, 0), (3, 0), (3, 2), (3, -1), (5, 0)], dtype=float)
    assert straight_lines(points, [(0, 1), (1, 2), (2, 3), (2, 4), (5, 2)]) == [(0, 5), (4, 3)]


def test_perforations_never_cross() -> None:
    (job,) = make_jobs(folded("bolt"), load_profile("laser-dxf"), treatment="perforate")
    cuts = [shapely.linestrings(s) for step in job.steps if step.role in ("mountain", "valley") for s in step.strokes]
    tree = shapely.STRtree(cuts)
    first, second = tree.query(cuts, predicate="intersects")
    assert (first == second).all()


def test_two_sides_lie_on_each_other() -> None:
    pattern = folded("bolt")
    front, back = make_jobs(pattern, load_profile("laser-dxf"), two_sided=True)
    assert [step.role for step in front.steps] == ["mountain", "cut"], (
        "the sheet is cut out, and turned over in the hole"
    )
    assert [step.role for step in back.steps] == ["valley"]
    front, back = make_jobs(pattern, load_profile("laser-dxf"), two_sided=True, registration="corners")
    assert {step.role for step in front.steps} == {"mark", "mountain"}
    assert {step.role for step in back.steps} == {"mark", "valley", "cut"}
    (both,) = make_jobs(pattern, load_profile("laser-dxf"))
    for step in back.steps:
        if step.role == "valley":
            mirrored = [stroke * (-1, 1) + (pattern.sheet.width, 0) for stroke in step.strokes]
            want = next(other for other in both.steps if other.role == "valley")
            one, other = (
                sorted(tuple(np.round(np.sort(s, axis=0).ravel(), 6).tolist()) for s in some)
                for some in (mirrored, want.strokes)
            )
            assert one == other


def test_the_sheet_is_turned_where_it_fits_only_so_and_refused_where_it_does_not() -> None:
    pattern = folded("bolt")
    (job,) = make_jobs(pattern, load_profile("laser-dxf", ["bed.height_mm=200"]))
    assert job.turned
    assert job.size == (250.0, 180.0)
    (upper,) = make_jobs(pattern, load_profile("glowforge", ["bed.height_mm=260"]))
    assert upper.at == (0.0, 10.0)
    with pytest.raises(JobError, match=r"180 x 250 mm does not fit the machine's 100 x 400 mm; use --sheet 100x400mm"):
        make_jobs(pattern, load_profile("laser-dxf", ["bed.width_mm=100"]))
    with pytest.raises(JobError, match="no material 'felt'; choose one of paper-80g"):
        make_jobs(pattern, load_profile("laser-dxf"), material="felt")
    with pytest.raises(JobError, match="no operation 'mark'"):
        make_jobs(pattern, load_profile("plain"))


def test_what_a_format_needs_and_a_profile_lacks_is_an_error() -> None:
    with pytest.raises(JobError, match=r"hpgl\.unit_mm"):
        export_jobs(book_fold(), ".hpgl", load_profile("glowforge"))
    with pytest.raises(JobError, match=r"gcode\.tool"):
        export_jobs(book_fold(), ".gcode", load_profile("glowforge"))


def test_the_kerf_is_on_cuts_only() -> None:
    pattern = book_fold()
    (plain,) = make_jobs(pattern, load_profile("laser-dxf"))
    (wide,) = make_jobs(pattern, load_profile("laser-dxf", ["kerf_mm=0.2"]))
    for one, other in zip(plain.steps, wide.steps, strict=True):
        if one.role == "cut":
            assert other.length == pytest.approx(one.length + 8 * 0.1)
        else:  # the sheet lies half a kerf inside the bed
            assert_allclose(np.concatenate(one.strokes) + 0.1, np.concatenate(other.strokes))


def test_a_laser_is_off_between_strokes_and_at_the_end() -> None:
    text = made("grbl-laser")["both"][1].decode().splitlines()
    assert "M4 S0" in text
    assert text[-3:] == ["M5", "G0 X0 Y0 S0", "M2"]
    moves = [line for line in text if line.startswith("G0")]
    assert len(moves) > 10
    assert all(line.endswith(" S0") for line in moves), "a controller that is not in laser mode is off as well"
    assert all(
        re.search(r"S\d+ F", line)
        for before, line in itertools.pairwise(text)
        if before.startswith("G0 X") and line.startswith("G1")
    )


def test_gcode_is_ascii_whatever_layers_are_called() -> None:
    profile = load_profile("grbl-laser", ["operations.cut.layer=Außenrand"])
    ((_, data),) = export_jobs(folded("bolt"), ".gcode", profile).values()
    assert b"; Au?enrand\n" in data


def test_the_way_between_strokes_is_short() -> None:
    pattern = folded("triangle", "paper")
    assert pattern.creases.crease_count > 500
    start = time.perf_counter()
    (job,) = make_jobs(pattern, load_profile("laser-dxf"))
    seconds = time.perf_counter() - start
    assert job.travel * 5 < job.travel_before
    assert seconds < 30  # a bound for what hangs, no measurement
    assert dataclasses.replace(job).steps


def shortest_travel(job: Job) -> float:
    """Bound from below the way between strokes that any order needs.

    An operation is one walk along strokes and ways between them, so all ends where an odd number of strokes meet,
    but the walk's own two, are joined in pairs by ways. Half of the cheapest assignment of these ends to one another
    is less than any such pairing; two ends more that are near to all stand for the walk's own.
    """
    least = 0.0
    for step in job.steps:
        ends, counts = np.unique(
            np.round([stroke[end] for stroke in step.strokes for end in (0, -1)], 4), axis=0, return_counts=True
        )
        odd = ends[counts % 2 == 1]
        away = np.zeros((len(odd) + 2, len(odd) + 2))
        away[:-2, :-2] = np.hypot(*(odd[:, None] - odd[None]).transpose(2, 0, 1))
        np.fill_diagonal(away, 1e6)
        least += away[linear_sum_assignment(away)].sum() / 2
    return float(least)


@pytest.mark.parametrize("sample", ["fish", "marlin", "boat"])
def test_the_way_is_near_the_shortest_that_any_order_could_have(sample: str) -> None:
    (job,) = make_jobs(folded(sample), load_profile("laser-dxf"))
    assert shortest_travel(job) <= job.travel < 3 * shortest_travel(job)


def test_no_order_makes_the_way_of_the_fish_seven_times_shorter() -> None:
    (job,) = make_jobs(folded("fish", "compact"), load_profile("laser-dxf"))
    assert job.travel_before < 7 * shortest_travel(job)


def test_jobs_have_the_same_bytes_each_time() -> None:
    for machine in ("laser-dxf", "glowforge", "roland-dxy", "grbl-laser", "printer-a4"):
        profile = load_profile(machine)
        one, other = (export_jobs(folded("bolt"), f".{profile.format}", profile)["both"][1] for _ in range(2))
        assert one == other
        if profile.format == "svg":
            ET.fromstring(one)
