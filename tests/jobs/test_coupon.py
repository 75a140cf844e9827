"""The test card of a machine."""

from __future__ import annotations

import numpy as np
import pypdfium2
import pytest
import shapely

from foldcut.exporters import export_job
from foldcut.jobs.coupon import DASHES, POWERS, make_coupon
from foldcut.jobs.errors import JobError
from foldcut.profiles import load_profile, profile_names


@pytest.mark.parametrize("name", [name for name in profile_names() if load_profile(name).operations])
def test_every_machine_has_a_test_card(name: str) -> None:
    profile = load_profile(name)
    job, rows = make_coupon(profile)
    assert len(rows) == len(POWERS) + len(DASHES)
    assert len({step.operation.layer for step in job.steps}) == len(job.steps) == len(rows) + 2
    assert job.steps[-1].role == "cut"
    points = np.concatenate([stroke for step in job.steps for stroke in step.strokes])
    assert (points >= 0).all()
    assert (points <= job.size).all()
    assert len(export_job(job, f".{profile.format}", profile)) > 1000


def test_strips_are_free_but_for_their_left_ends() -> None:
    job, rows = make_coupon(load_profile("laser-dxf"), "card-160g")
    cuts = shapely.union_all([shapely.linestrings(stroke) for stroke in job.steps[-1].strokes])
    for number, step in enumerate(job.steps[1:-1], 1):
        fold = shapely.linestrings([step.strokes[0][0], step.strokes[-1][-1]])
        gap = 1.6 if "perforation" in step.operation.layer else 1e-9
        assert shapely.distance(shapely.Point(fold.coords[0]), cuts) <= gap
        assert shapely.distance(shapely.Point(fold.coords[1]), cuts) <= gap
        assert len(job.steps[0].strokes) == sum(range(1, len(rows) + 1))
        assert step.operation.layer.startswith(f"{number:02d} ")
    powers = [step.setting.power_percent for step in job.steps[1 : 1 + len(POWERS)] if step.setting]
    assert powers == sorted(powers)
    assert powers[0] < powers[-1]


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
    with pytest.raises(JobError, match="does not fit"):
        make_coupon(load_profile("laser-dxf", ["bed.width_mm=50"]))
    with pytest.raises(JobError, match="for a drawing"):
        make_coupon(load_profile("plain"))
