"""The bed: a sheet lies upright where it fits, otherwise a quarter turn round, and points go with it."""

from __future__ import annotations

import numpy as np
import pytest

from foldcut.core.model import Sheet
from foldcut.jobs.bed import Lay
from foldcut.jobs.errors import JobError
from foldcut.profiles import Bed

SHEET = Sheet(100.0, 60.0, "test")
CORNERS = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 60.0], [0.0, 60.0]])


def test_a_sheet_lies_upright_where_it_fits_and_in_the_corner_of_the_origin() -> None:
    lay = Lay.on(SHEET, Bed(width_mm=300, height_mm=200))
    assert (lay.size, lay.at, lay.turned) == ((100.0, 60.0), (0.0, 0.0), False)
    assert lay.place(CORNERS).tolist() == CORNERS.tolist()
    assert Lay.on(SHEET, Bed(width_mm=300, height_mm=200, origin="upper-left")).at == (0.0, 140.0)
    assert Lay.on(SHEET, None).size == (100.0, 60.0)


def test_a_turned_sheet_lies_a_quarter_turn_counter_clockwise() -> None:
    lay = Lay.on(SHEET, Bed(width_mm=60, height_mm=200))
    assert (lay.size, lay.turned) == ((60.0, 100.0), True)
    assert lay.place(CORNERS).tolist() == [[60, 0], [60, 100], [0, 100], [0, 0]]


def test_the_back_is_turned_over_left_to_right() -> None:
    lay = Lay.on(SHEET, None)
    assert lay.place(CORNERS, "back").tolist() == [[100, 0], [0, 0], [0, 60], [100, 60]]
    assert lay.place(lay.place(CORNERS, "back"), "back").tolist() == CORNERS.tolist()


def test_a_sheet_that_exceeds_the_bed_by_rounding_only_fits() -> None:
    assert not Lay.on(SHEET, Bed(width_mm=100 - 1e-9, height_mm=60)).turned
    with pytest.raises(JobError, match=r"use --sheet 60x99\.9mm or smaller"):
        Lay.on(SHEET, Bed(width_mm=99.9, height_mm=60))
