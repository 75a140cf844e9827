"""Filling the gaps."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from support.stages import run_stages
from support.strategies import DISK_SHAPES, cross, rectangle, regular, star, star_shaped, two_opt

from foldcut.core.model import Sheet
from foldcut.drawing.shape import make_shape
from foldcut.methods.disks.boundary import boundary_disks
from foldcut.methods.disks.packing import fill_gaps, packing_faults
from foldcut.methods.disks.rolling import Candidate, GrowingDisks
from foldcut.methods.disks.tolerance import Tolerance


@pytest.mark.parametrize("name", DISK_SHAPES)
def test_every_gap_ends_with_three_or_four_sides_and_they_tile_the_sheet(name: str) -> None:
    stages = run_stages(DISK_SHAPES[name])
    assert packing_faults(stages.packing, stages.area, stages.tolerance) == []


@pytest.mark.parametrize("seed", range(12))
def test_random_polygons_are_packed(seed: int) -> None:
    make = (star_shaped, two_opt)[seed % 2]
    stages = run_stages([make(np.random.default_rng(seed), 5 + 4 * seed)])
    assert packing_faults(stages.packing, stages.area, stages.tolerance) == []


@pytest.mark.parametrize("shape", [*(regular(n) for n in range(3, 13)), cross(), rectangle(3, 1), star(6, 0.5)])
def test_ties_of_symmetric_shapes_are_taken_together(shape: np.ndarray) -> None:
    # Four disks that touch one new disk at once must all get their tangency edge: else the number of disks explodes.
    stages = run_stages([shape])
    assert packing_faults(stages.packing, stages.area, stages.tolerance) == []
    assert len(stages.packing.radii) - stages.packing.boundary_count < 3 * stages.packing.boundary_count


def test_a_neck_exactly_two_radii_wide_splits_into_touching_disks() -> None:
    # the corners of the neck are opposite each other: their disks touch across it
    neck = [
        (0, 0),
        (20, 0),
        (20, 8),
        (24, 8),
        (24, 0),
        (44, 0),
        (44, 20),
        (24, 20),
        (24, 12),
        (20, 12),
        (20, 20),
        (0, 20),
    ]
    stages = run_stages([neck])
    assert packing_faults(stages.packing, stages.area, stages.tolerance) == []


def test_the_border_goes_to_the_outer_part_when_a_disk_splits_the_chain_around_a_small_shape() -> None:
    # It once went to the last part, a finished gap of three disks, and nothing could divide the two.
    sheet = Sheet(745.0, 216.0)
    shape = make_shape([[(682.43, 79.09), (682.4, 80.67), (682.14, 80.3), (682.01, 80.33)]])
    tolerance = Tolerance.for_sheet(sheet)
    packing = fill_gaps(boundary_disks(shape, sheet, 0.005, tolerance), tolerance)
    ribbon = 0.01 * np.hypot(*(np.roll(shape.loops[0], -1, axis=0) - shape.loops[0]).T).sum()
    faults = packing_faults(packing, sheet.width * sheet.height - ribbon, tolerance)
    assert faults == []


def test_a_turned_shape_needs_as_many_disks() -> None:
    points = np.array(star_shaped(np.random.default_rng(11), 20))
    turn = np.deg2rad(17)
    turned = points @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    sheet = "300x300"
    one = run_stages([points * 0.001], sheet=sheet)
    two = run_stages([points + 1e4], sheet=sheet)
    assert len(one.packing.radii) == len(two.packing.radii)
    assert packing_faults(run_stages([turned]).packing, 148 * 210, one.tolerance) == []


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (lambda radii: radii * np.r_[np.ones(len(radii) - 1), 1.01], "from touching"),
        (lambda radii: radii * 1.01, "overlap"),
    ],
)
def test_the_checker_sees_wrong_disks(change, fault: str) -> None:
    stages = run_stages([star(5, 0.4)])
    wrong = dataclasses.replace(stages.packing, radii=change(stages.packing.radii))
    assert any(fault in text for text in packing_faults(wrong, stages.area, stages.tolerance))


def test_the_checker_sees_a_missing_gap() -> None:
    stages = run_stages([star(5, 0.4)])
    assert any("cover" in text for text in packing_faults(stages.packing, stages.area * 1.001, stages.tolerance))


def test_beyond_an_ear_the_next_two_disks_are_candidates_the_nearer_first() -> None:
    centres = np.array([(-2.0, 0.0), (0.0, -1.5), (2.0, 0.0), (0.3, 14.0), (0.1, 5.0), (-0.2, 9.0), (0.0, -6.0)])
    radii = np.array([1.0, 0.5, 1.0, 1.0, 1.2, 0.8, 1.0])
    found = GrowingDisks(centres, radii).beyond(Candidate(0.0, 0.3, 1.02), 0, 1, 2, np.arange(7))
    gaps = [np.hypot(*(centres - candidate[:2]).T) - radii - candidate.radius for candidate in found]
    assert [np.flatnonzero(np.abs(gap) < 1e-9).tolist() for gap in gaps] == [[0, 2, 4], [0, 2, 5]]
    assert found[0].y < found[1].y
