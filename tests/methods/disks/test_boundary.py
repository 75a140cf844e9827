"""Disks on the boundaries."""

from __future__ import annotations

import numpy as np
import pytest
from support.stages import Stages, run_stages
from support.strategies import DISK_SHAPES, rectangle, star

from foldcut.core.errors import RibbonError
from foldcut.methods.disks.boundary import boundary_disks
from foldcut.methods.disks.disk_pairs import near_disks, overlapping_disks
from foldcut.methods.disks.ribbon import default_ribbon, largest_ribbon


def boundary_faults(stages: Stages) -> list[str]:
    """List what breaks the invariants of the boundary disks."""
    boundary, tolerance = stages.boundary, stages.tolerance
    faults = []
    for row in boundary.chains:
        step = boundary.centres[np.roll(row, -1)] - boundary.centres[row]
        radii = boundary.radii[row]
        off = np.abs(np.hypot(*step.T) - radii - np.roll(radii, -1))
        if (off > tolerance.touching(radii, np.roll(radii, -1))).any():
            faults.append(f"consecutive disks are {off.max():.3g} mm from touching")
    for face in range(len(boundary.face_inside)):
        mine = np.concatenate([row for row, f in zip(boundary.chains, boundary.chain_face, strict=True) if f == face])
        pairs, _ = overlapping_disks(
            boundary.centres[mine], boundary.radii[mine], np.zeros(len(mine), dtype=np.int32), tolerance
        )
        if len(pairs):
            faults.append(f"{len(pairs)} pairs overlap in face {face}")
    return faults


@pytest.mark.parametrize("name", DISK_SHAPES)
@pytest.mark.parametrize("ribbon", [0.0, 0.3])
def test_edges_are_unions_of_diameters_and_disks_do_not_overlap(name: str, ribbon: float) -> None:
    if name == "needle" and ribbon:
        ribbon = 0.02
    assert boundary_faults(run_stages(DISK_SHAPES[name], ribbon=ribbon)) == []


def test_the_checker_sees_a_disk_that_is_too_large() -> None:
    stages = run_stages(DISK_SHAPES["star"])
    stages.boundary.radii.setflags(write=True)
    stages.boundary.radii[len(stages.boundary.radii) // 2] *= 1.01
    assert boundary_faults(stages) != []


def test_a_symmetric_shape_gets_symmetric_disks() -> None:
    boundary = run_stages([rectangle(1, 1)]).boundary
    inside = boundary.chains[list(boundary.chain_face).index(1)]
    disks = {tuple(row) for row in np.round(np.c_[boundary.centres, boundary.radii][inside], 9)}
    assert disks == {(148 - x, y, r) for x, y, r in disks} == {(x, 210 - y, r) for x, y, r in disks}


def test_disks_that_would_nearly_touch_are_kept_apart() -> None:
    # The foot of (0, 10) on the bottom edge is just beside its end (0.01, 0): half the distance to the edge and half
    # the distance to the corner differ by 2e-6. Found by a random polygon, whose gusset was 1e-7 mm high.
    corners = [(-10, 0), (0.01, 0), (14, -8), (16, 19), (0, 10), (-9, 14)]
    stages = run_stages([corners])
    boundary = stages.boundary
    inside = boundary.chains[list(boundary.chain_face).index(1)]
    i, j, slack = near_disks(boundary.centres[inside], boundary.radii[inside], np.zeros(len(inside), dtype=np.int32))
    radii = boundary.radii[inside]
    touching = stages.tolerance.touching(radii[i], radii[j])
    assert np.all((slack <= touching) | (slack > 1e-3 * np.minimum(radii[i], radii[j])))


def test_disks_on_either_side_of_the_ribbon_face_each_other() -> None:
    boundary = run_stages([star(5, 0.4)], ribbon=0.4).boundary
    left, right = (row for row, loop in zip(boundary.chains, boundary.chain_loop, strict=True) if loop == 1)
    assert boundary.node[left].tolist() == boundary.node[right[::-1]].tolist()
    across = boundary.centres[left] - boundary.centres[right[::-1]]
    straight = np.isclose(boundary.radii[left], boundary.radii[right[::-1]], rtol=1e-12)
    assert straight.any(), "disks in the middle of an edge keep their radius"
    assert not straight.all(), "disks at corners do not"
    assert np.allclose(np.hypot(*across[straight].T), 0.8, rtol=1e-9)


def test_a_ribbon_that_is_too_wide_is_refused_with_the_largest_width_that_works() -> None:
    with pytest.raises(RibbonError, match=r"largest half-width that works is [\d.e-]+ mm") as caught:
        run_stages([star(5, 0.4)], ribbon=20)
    widest = float(str(caught.value).split("works is ")[1].split()[0])
    stages = run_stages([star(5, 0.4)], ribbon=widest)
    assert boundary_faults(stages) == []
    with pytest.raises(RibbonError):
        boundary_disks(stages.shape, stages.sheet, widest * 1.02, stages.tolerance)


@pytest.mark.parametrize("ribbon", [1e-300, 1e-9, 2e-5])
def test_a_ribbon_that_is_too_narrow_to_verify_is_refused_with_the_least_width(ribbon: float) -> None:
    with pytest.raises(RibbonError, match=r"it needs 2\.6e-05 mm"):
        run_stages([star(5, 0.4)], ribbon=ribbon)
    assert boundary_faults(run_stages([star(5, 0.4)], ribbon=2.6e-5)) == []


@pytest.mark.parametrize("name", DISK_SHAPES)
def test_there_is_room_for_the_default_ribbon(name: str) -> None:
    plain = run_stages(DISK_SHAPES[name])
    width = default_ribbon(plain.shape, plain.sheet)
    assert width == (pytest.approx(largest_ribbon(plain.shape, plain.sheet, 0.5) / 2) if name == "needle" else 0.25)
    assert 0 < width <= 0.25
    assert boundary_faults(run_stages(DISK_SHAPES[name], ribbon=width)) == []


def test_the_largest_ribbon_is_no_more_than_asked_for_and_no_more_than_works() -> None:
    stages = run_stages([star(5, 0.4)])
    assert largest_ribbon(stages.shape, stages.sheet, 0.1) == 0.1
    widest = largest_ribbon(stages.shape, stages.sheet, 100.0)
    assert widest == pytest.approx(largest_ribbon(stages.shape, stages.sheet, 1000.0), rel=1e-6)
    boundary_disks(stages.shape, stages.sheet, widest, stages.tolerance)
    with pytest.raises(RibbonError):
        boundary_disks(stages.shape, stages.sheet, widest * 1.001, stages.tolerance)
