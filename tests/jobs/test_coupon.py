"""The test card of a machine."""

from __future__ import annotations

import io

import ezdxf
import numpy as np
import pypdfium2
import pytest
import shapely

from foldcut.exporters import export_job
from foldcut.jobs.coupon import DASHES, POWERS, make_coupon
from foldcut.jobs.errors import JobError
from foldcut.profiles import load_profile, profile_names

MACHINES = [name for name in profile_names() if load_profile(name).operations]


@pytest.mark.parametrize("name", MACHINES)
def test_every_machine_has_a_test_card(name: str) -> None:
    profile = load_profile(name)
    job, rows = make_coupon(profile)
    assert len({step.operation.layer for step in job.steps}) == len(job.steps) == len(rows) + 2
    assert job.steps[-1].role == "cut"
    points = np.concatenate([stroke for step in job.steps for stroke in step.strokes])
    assert (points >= 0).all()
    assert (points <= job.size).all()
    assert len(export_job(job, f".{profile.format}", profile)) > 1000


@pytest.mark.parametrize("name", MACHINES)
def test_no_two_rows_of_a_card_are_alike(name: str) -> None:
    job, rows = make_coupon(load_profile(name))
    assert len(rows) >= 5
    made = set()
    for step in job.steps[1:-1]:
        strokes = np.concatenate(step.strokes)
        made.add((str(step.setting), np.round(strokes - strokes.mean(axis=0), 6).tobytes()))
    assert len(made) == len(rows)


def test_rows_that_would_be_alike_are_an_error() -> None:
    with pytest.raises(JobError, match=r"rows 5 and 6 of the test card would be the same .*--set"):
        make_coupon(load_profile("grbl-laser", ["materials.paper-80g.score.power_percent=95"]))
    with pytest.raises(JobError, match="rows 1 and 2"):
        make_coupon(load_profile("drag-knife", ["materials.paper-80g.score.force_g=1"]))


@pytest.mark.parametrize("name", MACHINES)
def test_no_palette_takes_one_row_of_a_card_for_another(name: str) -> None:
    profile = load_profile(name)
    job, _ = make_coupon(profile)
    colours = [step.operation.colour for step in job.steps]
    nearest = [min(profile.palette or colours, key=lambda known: distance(known, colour)) for colour in colours]
    assert len(set(nearest)) == len(colours)
    document = ezdxf.read(io.StringIO(export_job(job, ".dxf", profile).decode()))
    numbers = [document.layers.get(step.operation.layer).color for step in job.steps]
    assert len(set(numbers)) == len(job.steps), "nor do programs that know the numbered colours only"


def distance(one: str, other: str) -> int:
    return sum((int(one[n : n + 2], 16) - int(other[n : n + 2], 16)) ** 2 for n in (1, 3, 5))


def test_strips_are_free_but_for_their_left_ends() -> None:
    job, rows = make_coupon(load_profile("laser-dxf"), "card-160g")
    assert len(rows) == len(POWERS) + len(DASHES)
    cuts = shapely.union_all([shapely.linestrings(stroke) for stroke in job.steps[-1].strokes])
    for number, step in enumerate(job.steps[1:-1], 1):
        fold = shapely.linestrings([step.strokes[0][0], step.strokes[-1][-1]])
        gap = 1.6 if step.action == "perforate" else 1e-9
        assert shapely.distance(shapely.Point(fold.coords[0]), cuts) <= gap
        assert shapely.distance(shapely.Point(fold.coords[1]), cuts) <= gap
        assert len(job.steps[0].strokes) == sum(range(1, len(rows) + 1))
        assert step.operation.layer.startswith(f"{number:02d}_")
    powers = [step.setting.power_percent for step in job.steps[1 : 1 + len(POWERS)] if step.setting]
    assert powers == sorted(powers, key=float)
    assert powers[0] != powers[-1]


def test_a_printed_card_says_what_each_row_is() -> None:
    profile = load_profile("printer-a4")
    job, rows = make_coupon(profile)
    text = pypdfium2.PdfDocument(export_job(job, ".pdf", profile))[0].get_textpage().get_text_range()
    assert all(row in text for row in rows)
    assert "fold away" not in text


@pytest.mark.parametrize("origin", ["lower-left", "upper-left"])
def test_a_card_that_fits_turned_only_lies_on_the_bed(origin: str) -> None:
    profile = load_profile("laser-dxf", ["bed.height_mm=100", f"bed.origin={origin}"])
    job, _ = make_coupon(profile)
    assert job.turned
    points = np.concatenate([stroke for step in job.steps for stroke in step.strokes]) + job.at
    assert (points >= 0).all()
    assert (points <= (600, 100)).all()


def test_a_card_that_does_not_fit_is_an_error() -> None:
    with pytest.raises(JobError, match="does not fit .* with --set, or take a larger machine with --profile"):
        make_coupon(load_profile("laser-dxf", ["bed.width_mm=50"]))
    with pytest.raises(JobError, match="see foldcut profiles"):
        make_coupon(load_profile("plain"))
