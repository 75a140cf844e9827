"""The last door: no job and no pattern with a point that is not finite, or off the sheet or the bed, becomes a file."""

from __future__ import annotations

import dataclasses
import re
from typing import Any

import numpy as np
import pytest
from support.patterns import book_fold

from foldcut.core.errors import BadInputError
from foldcut.core.model import Sheet
from foldcut.exporters import JOB_EXPORTERS, PATTERN_EXPORTERS, SOLIDS, check_job_export, export, export_job
from foldcut.jobs.coupon import make_coupon
from foldcut.jobs.errors import JobError
from foldcut.jobs.job import Job, make_jobs
from foldcut.profiles import Profile, load_profile, profile_names

MACHINE_OF = {
    ".svg": "glowforge",
    ".dxf": "laser-dxf",
    ".hpgl": "hp-7475a",
    ".gcode": "grbl-laser",
    ".pdf": "printer-a4",
    ".lbrn2": "lightburn-co2",
}
FAR = [(999_999.0, 5.0), (5.0, -4.0), (np.nan, 5.0), (5.0, np.inf), (101.0, 5.0)]


def job_with(point: tuple[float, float], profile: Profile) -> Job:
    """Return the job of a sheet of 100 x 60 mm to which a stroke to this point was added."""
    (job,) = make_jobs(book_fold(), profile)
    last = job.steps[-1]
    step = dataclasses.replace(last, strokes=(*last.strokes, np.array([(5.0, 5.0), point])))
    return dataclasses.replace(job, steps=(*job.steps[:-1], step))


def test_every_format_of_a_job_is_tried() -> None:
    assert MACHINE_OF.keys() == JOB_EXPORTERS.keys()


@pytest.mark.parametrize("suffix", JOB_EXPORTERS)
@pytest.mark.parametrize("point", FAR)
def test_no_stroke_leaves_the_sheet_in_any_format(point: tuple[float, float], suffix: str) -> None:
    profile = load_profile(MACHINE_OF[suffix])
    with pytest.raises(JobError, match=re.escape(f"({point[0]:.6g}, {point[1]:.6g}) mm, beyond the sheet")):
        export_job(job_with(point, profile), suffix, profile)
    assert export_job(job_with((99.0, 59.0), profile), suffix, profile)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"at": (np.nan, 0.0)}, "give finite numbers"),
        ({"size": (np.inf, 60.0)}, "give finite numbers"),
        ({"at": (301.0, 0.0)}, "reaches (401, 60) mm, beyond the machine's 400 x 400 mm"),
        ({"at": (0.0, -2.0)}, "beyond the machine's"),
    ],
)
def test_a_job_lies_on_the_bed(changes: dict[str, Any], words: str) -> None:
    profile = load_profile("grbl-laser")
    (job,) = make_jobs(book_fold(), profile)
    with pytest.raises(JobError, match=re.escape(words)):
        export_job(dataclasses.replace(job, **changes), ".gcode", profile)


def test_a_stroke_has_two_points_and_a_setting_finite_numbers() -> None:
    profile = load_profile("grbl-laser")
    (job,) = make_jobs(book_fold(), profile)
    step = job.steps[-1]
    assert step.setting is not None
    dot = dataclasses.replace(step, strokes=(np.array([(5.0, 5.0)]),))
    fast = dataclasses.replace(step, setting=step.setting.model_copy(update={"speed_mm_s": float("inf")}))
    for wrong, words in ((dot, "has 1 points"), (fast, "give finite numbers with --set")):
        with pytest.raises(JobError, match=words):
            export_job(dataclasses.replace(job, steps=(wrong,)), ".gcode", profile)


def coordinates(gcode: bytes) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.array(re.findall(rb"X([\d.-]+) Y([\d.-]+)", gcode), dtype=np.float64)


@pytest.mark.parametrize("origin", ["lower-left", "upper-left"])
def test_a_kerf_moves_the_job_onto_the_bed(origin: str) -> None:
    profile = load_profile("grbl-laser", ["kerf_mm=0.4", f"bed.origin={origin}"])
    (job,) = make_jobs(book_fold(), profile)
    points = coordinates(export_job(job, ".gcode", profile))
    assert points.min() == 0.0
    assert points.max() <= 400.0
    assert np.ptp(points[points[:, 1] > 10, 0]) == pytest.approx(100.4)  # as wide as without a bed
    plain = load_profile("grbl-laser", [f"bed.origin={origin}"])
    (job,) = make_jobs(book_fold(), plain)
    assert coordinates(export_job(job, ".gcode", plain)).max(axis=0).tolist()[0] == 100.0


def test_a_kerf_that_the_bed_has_no_room_for_is_told() -> None:
    profile = load_profile("grbl-laser", ["kerf_mm=0.4", "bed.width_mm=100", "bed.height_mm=60"])
    (job,) = make_jobs(book_fold(), load_profile("grbl-laser", ["kerf_mm=0.4"]))
    with pytest.raises(JobError, match=r"with a kerf of 0\.4 mm, beyond the machine's 100 x 60 mm"):
        export_job(job, ".gcode", profile)


@pytest.mark.parametrize("name", [name for name in profile_names() if load_profile(name).materials])
def test_the_test_card_of_every_machine_passes(name: str) -> None:
    profile = load_profile(name)
    job, _ = make_coupon(profile)
    assert export_job(job, f".{profile.format}", profile)


LINE = np.array([(50.0, 0.0), (50.0, 60.0)])
CHANGES: list[tuple[dict[str, Any], str]] = [
    ({"first_folds": (LINE + np.array([1e6, 0.0]),)}, "a first fold of the pattern is at (1.00005e+06, 0) mm"),
    ({"first_folds": (LINE * np.nan,)}, "a first fold of the pattern is at (nan, nan) mm"),
    ({"drawn": (LINE * 1e9,)}, "the drawing of the pattern is at "),
]


@pytest.mark.parametrize("suffix", [suffix for suffix in PATTERN_EXPORTERS if suffix not in SOLIDS])
@pytest.mark.parametrize(("changes", "words"), CHANGES, ids=[words for _, words in CHANGES])
def test_no_pattern_leaves_its_sheet_in_any_format(changes: dict[str, Any], words: str, suffix: str) -> None:
    pattern = book_fold()
    with pytest.raises(BadInputError, match=re.escape(words)):
        export(dataclasses.replace(pattern, **changes), suffix)
    assert export(dataclasses.replace(pattern, first_folds=(LINE,)), suffix)


@pytest.mark.parametrize("name", [name for name in profile_names() if "cut" in load_profile(name).operations])
def test_a_sheet_that_fits_when_turned_passes_before_there_is_a_pattern(name: str) -> None:
    profile = load_profile(name)
    reach = profile.bed or max(profile.papers.values(), key=lambda paper: paper.width_mm)
    sides = np.array([reach.width_mm, reach.height_mm]) - 60
    for width, height in (sides, sides[::-1]):
        check_job_export(f".{profile.format}", profile, Sheet(float(width), float(height)))
