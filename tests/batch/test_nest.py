"""Sheets of a batch together on beds: none overlaps, none is lost, and every bed's file is read back."""

from __future__ import annotations

import itertools
import json
import re
from pathlib import Path

import numpy as np
import pytest
from support.folded import folded_sample

from foldcut.batch.nest import NestedBed, Nesting, nest, nested_files, pack
from foldcut.cli.main import main
from foldcut.core.errors import BadInputError
from foldcut.exporters import export
from foldcut.jobs.arrange import APART_MM, BedLayout, from_zero
from foldcut.jobs.bed import tool_border
from foldcut.jobs.errors import JobError
from foldcut.jobs.job import make_jobs
from foldcut.jobs.tabs import Tabs
from foldcut.output.render import JobOptions
from foldcut.profiles import Bed, load_profile, profile_names
from foldcut.samples import sample_path

MACHINES = [name for name in profile_names() if load_profile(name).bed and load_profile(name).operations]
WITH_BED = [name for name in MACHINES if not load_profile(name).page]
SHEETS = {"star": "100x70mm", "square": "148x105mm", "sub/kite": "60x90mm"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the pattern of each drawing, as a batch writes them."""
    made = tmp_path_factory.mktemp("patterns")
    (made / "sub").mkdir()
    for stem, sheet in SHEETS.items():
        (made / f"{stem}.fold").write_bytes(export(folded_sample(stem.rpartition("/")[2], sheet), ".fold"))
    return made


def boxes(sizes: list[tuple[float, float]], packed: list[tuple[int, float, float, bool]]) -> list[tuple[float, ...]]:
    found = []
    for number, x, y, turned in packed:
        width, height = sizes[number][::-1] if turned else sizes[number]
        found.append((x, y, x + width, y + height))
    return found


@pytest.mark.parametrize("seed", range(6))
def test_sheets_are_apart_on_their_beds_and_none_is_lost(seed: int) -> None:
    random = np.random.default_rng(seed)
    bed = Bed(width_mm=400.0, height_mm=300.0)
    sizes = [(float(a), float(b)) for a, b in random.uniform(20, 200, size=(40, 2)).round(3)]
    beds = pack(sizes, bed)
    assert sorted(number for packed in beds for number, *_ in packed) == list(range(40))
    assert beds == pack(sizes, bed)
    assert len(beds) <= 2 * np.ceil(sum(a * b for a, b in sizes) / (400 * 300))
    for packed in beds:
        for one in boxes(sizes, packed):
            assert min(one) >= 0
            assert one[2] <= 400 + 1e-3
            assert one[3] <= 300 + 1e-3
        for a, b in itertools.combinations(boxes(sizes, packed), 2):
            assert max(a[0] - b[2], b[0] - a[2], a[1] - b[3], b[1] - a[3]) >= APART_MM - 2e-3


def test_a_sheet_as_large_as_the_bed_has_a_bed_of_its_own() -> None:
    bed = Bed(width_mm=304.8, height_mm=297.0)
    beds = pack([(304.8, 297.0), (297.0, 304.8), (10.0, 10.0)], bed)
    assert [len(packed) for packed in beds] == [1, 1, 1]
    # two A5 sheets, 2 mm apart, on a bed that holds just these
    assert len(pack([(148.0, 210.0)] * 2, Bed(width_mm=298.0, height_mm=210.0))) == 1
    assert len(pack([(148.0, 210.0)] * 2, Bed(width_mm=297.9, height_mm=210.0))) == 2
    with pytest.raises(JobError, match="does not fit the machine's 298 x 210 mm; use a smaller --sheet"):
        pack([(300.0, 210.0)], Bed(width_mm=298.0, height_mm=210.0))


@pytest.mark.parametrize("machine", WITH_BED)
def test_each_stroke_is_on_its_sheet_and_each_layer_is_as_long_as_all_sheets_need(machine: str, folder: Path) -> None:
    profile = load_profile(machine)
    assert profile.bed is not None
    stems = ["star", "square", "sub/kite", "star"]
    options = JobOptions(layout=BedLayout(copies=2), tabs=None if profile.draws else Tabs(2, 3.0))
    beds = nest(folder, stems, [f".{profile.format}"], profile, options)
    length: dict[str, float] = {}
    for bed in beds:
        for step in bed.job.steps:
            length[step.role] = length.get(step.role, 0.0) + step.length
        rectangles = lying(bed, machine)
        for stroke in (stroke for step in bed.job.steps for stroke in step.strokes):
            inside = [(stroke >= low - 1e-6).all() and (stroke <= high + 1e-6).all() for low, high in rectangles]
            assert inside.count(True) == 1
        assert all(data for data in bed.files.values())
        assert [step.role for step in bed.job.steps][-1:] == (["cut"] if profile.cut_outline else ["valley"])
    for role, found in length.items():
        single = [
            step.length
            for stem in stems
            for step in make_jobs(folded_sample(stem.rpartition("/")[2], SHEETS[stem]), profile, tabs=options.tabs)[
                0
            ].steps
            if step.role == role
        ]
        assert found == pytest.approx(2 * sum(single))
    assert sorted(sheet.drawing for bed in beds for sheet in bed.sheets) == sorted(2 * stems)
    assert [bed.files for bed in nest(folder, stems[::-1], [f".{profile.format}"], profile, options)] == [
        bed.files for bed in beds
    ]


def lying(bed: NestedBed, machine: str) -> list[tuple[np.ndarray, np.ndarray]]:
    """The rectangles in which the sheets of a bed lie, with the tool's border, from its lower left corner."""
    profile = load_profile(machine)
    border = tool_border(profile)
    assert profile.bed is not None
    found = []
    for sheet in bed.sheets:
        size = folded_sample(sheet.drawing.rpartition("/")[2], SHEETS[sheet.drawing]).sheet
        width, height = (size.height, size.width) if sheet.turned else (size.width, size.height)
        low = np.array(from_zero(sheet.at, (width, height), profile.bed))
        found.append((low - border, low + np.array([width, height]) + border))
    return found


def test_strokes_in_the_gcode_of_a_bed_are_those_of_its_job(folder: Path) -> None:
    profile = load_profile("grbl-laser")
    (bed,) = nest(folder, ["star", "square"], [".gcode"], profile, JobOptions(framed=True))
    text = bed.files["bed-1.gcode"].decode()
    moves = re.findall(r"^G([01]) X([\d.]+) Y([\d.]+)", text, re.M)[:-1]
    seen = np.array([(float(x), float(y)) for _, x, y in moves])
    strokes = [stroke for step in bed.job.steps for stroke in step.strokes]
    assert seen == pytest.approx(np.concatenate(strokes), abs=1e-3)
    assert sum(kind == "0" for kind, *_ in moves) == len(strokes)
    assert text.index("SCORE_VALLEY") < text.index("; CUT")
    assert text.count("; CUT") == 1
    assert "M5" in bed.files["bed-1-frame.gcode"].decode()


def test_a_drawing_with_the_name_of_a_bed_is_told(folder: Path) -> None:
    records = [{"stem": "star", "status": "made", "outputs": {"star.fold": 1, "bed-1.gcode": 1}}]
    with pytest.raises(BadInputError, match="call the drawing otherwise"):
        nested_files(folder, records, Nesting((".gcode",)), load_profile("grbl-laser"), JobOptions())


def test_a_batch_lays_its_sheets_on_beds_and_removes_those_of_before(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    drawings, out = tmp_path / "drawings", tmp_path / "out"
    drawings.mkdir()
    for name in ("square", "triangle"):
        (drawings / f"{name}.svg").write_bytes(sample_path(name).read_bytes())
    words = [
        "batch",
        str(drawings),
        "-o",
        str(out),
        "--sheet",
        "a5",
        "--effort",
        "fast",
        "--profile",
        "grbl-laser",
        "--nest",
    ]
    assert main([*words, "--copies", "2", "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert [len(bed["sheets"]) for bed in report["beds"]] == [3, 1]
    assert {path.name for path in out.glob("bed*")} == {"bed-1.gcode", "bed-2.gcode", "beds.txt"}
    assert "4 sheets on 2 beds" in (out / "beds.txt").read_text()
    first = (out / "bed-1.gcode").read_bytes()
    assert main([*words, "--copies", "2", "--quiet"]) == 0  # nothing is folded again
    assert (out / "bed-1.gcode").read_bytes() == first
    assert main([*words, "--force", "--quiet"]) == 0
    assert {path.name for path in out.glob("bed*")} == {"bed-1.gcode", "beds.txt"}
    (out / "bed-7.txt").write_text("mine")
    assert main([*words, "--force", "--quiet", "--format", "svg"]) == 0
    assert {path.name for path in out.glob("bed*")} == {"bed-1.svg", "bed-7.txt", "beds.txt"}
    assert main([*words[:-1], "--force", "--quiet"]) == 0
    assert {path.name for path in out.glob("bed*")} == {"bed-7.txt"}


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ((), "name it with --profile"),
        (("--profile", "printer-a4"), "are for a bed"),
        (("--profile", "hp-7475a"), "are for a bed"),
        (("--profile", "grbl-laser", "--two-sided"), "leave --two-sided out"),
        (("--profile", "grbl-laser", "--at", "3,3"), "--nest chooses where each lies"),
        (("--profile", "grbl-laser", "--format", "fold"), "--nest writes jobs"),
        (("--profile", "grbl-laser", "--copies", "0"), "give a number from 1"),
        (("--profile", "grbl-laser", "--sheet", "a2"), "does not fit the machine's 400 x 400 mm"),
    ],
)
def test_what_cannot_be_nested_is_told_before_anything_is_folded(
    options: tuple[str, ...], words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert main(["batch", str(sample_path("star")), "-o", str(out), "--nest", *options]) == 2
    assert words in capsys.readouterr().err
    assert not out.exists()
