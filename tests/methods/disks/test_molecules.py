"""Rabbit ears and gussets."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from support.molecules import one_molecule
from support.stages import run_stages
from support.strategies import DISK_SHAPES, rectangle, star, star_shaped

from foldcut.methods.disks.molecules import Kind, Molecules, molecule_faults
from foldcut.methods.disks.tolerance import Tolerance


def kite(rise: float = 2.0) -> Molecules:
    """Four tangent disks about a symmetric quadrilateral whose perpendicular points differ."""
    r_b, r_a = 1.5, 1.0
    half = np.sqrt((r_a + r_b) ** 2 - (rise / 2) ** 2)
    return one_molecule([(0, -rise / 2), (half, 0), (0, rise / 2), (-half, 0)], [r_a, r_b, r_a, r_b])


@pytest.mark.parametrize("name", DISK_SHAPES)
@pytest.mark.parametrize("ribbon", [0.0, 0.25])
def test_facets_tile_the_sheet_and_fold_without_stretching(name: str, ribbon: float) -> None:
    if name == "needle" and ribbon:
        ribbon = 0.02
    stages = run_stages(DISK_SHAPES[name], ribbon=ribbon)
    assert molecule_faults(stages.molecules, stages.area, stages.tolerance) == []


def test_the_centre_of_a_rabbit_ear_is_the_incentre() -> None:
    molecules = one_molecule([(0, 0), (3, 0), (0, 4)], [1, 2, 3])
    apex = molecules.vertices[molecules.creases[molecules.crease_kind == Kind.BISECTOR][:, 1]]
    assert np.allclose(apex, [1, 1], atol=1e-12)
    assert len(molecules.facets) == 6


def test_gusset_halves_meet_on_the_diagonal() -> None:
    molecules = kite(rise=2.2)
    diagonal = molecules.creases[molecules.crease_kind == Kind.DIAGONAL]
    p, m, r = diagonal[0, 0], diagonal[0, 1], diagonal[1, 1]
    line = molecules.vertices[r] - molecules.vertices[p]
    across = molecules.creases[(molecules.crease_kind == Kind.TANGENCY) & (molecules.crease_side == 4)]
    for a, b in across:
        assert a == m
        assert abs((molecules.vertices[b] - molecules.vertices[a]) @ line) < 1e-12
    assert np.allclose(molecules.folded[[p, m, r], 1], molecules.folded[m, 1])
    assert molecules.folded[m, 0] == 0


def test_the_diagonal_with_the_lower_inset_is_taken() -> None:
    flat, tall = kite(rise=2.05), kite(rise=4.2)
    for molecules, horizontal in ((flat, False), (tall, True)):
        p, m = molecules.creases[molecules.crease_kind == Kind.DIAGONAL][0]
        along = np.abs(molecules.vertices[m] - molecules.vertices[p])
        assert (along[0] > along[1]) == horizontal


def test_creases_meet_in_one_point_when_the_perpendicular_points_coincide() -> None:
    molecules = one_molecule([(0, 0), (2, 0), (2, 2), (0, 2)], [1, 1, 1, 1])
    assert not (molecules.crease_kind == Kind.DIAGONAL).any()
    assert (molecules.crease_kind == Kind.TANGENCY).sum() == 4


def test_a_quadrilateral_with_a_straight_corner_has_a_gusset() -> None:
    # b lies on the line from a to c: the other diagonal has no radical centre
    molecules = one_molecule(
        [(0, 0), (2, 0), (4, 0), (2, 2 * np.sqrt(3) - 0.5)], [1, 1, 1, np.hypot(2, 2 * np.sqrt(3) - 0.5) - 1]
    )
    assert molecule_faults(molecules, np.hypot(0, 4) * (2 * np.sqrt(3) - 0.5) / 2, Tolerance(1e-8, 1e-12)) == []


@pytest.mark.parametrize("seed", range(6))
def test_random_molecules_are_sound(seed: int) -> None:
    stages = run_stages([star_shaped(np.random.default_rng(seed), 12 + 3 * seed)])
    assert molecule_faults(stages.molecules, stages.area, stages.tolerance) == []


def test_boundary_corners_fold_to_the_cut_line_and_the_ribbon_to_its_borders() -> None:
    for ribbon in (0.0, 0.4):
        molecules = run_stages([star(5, 0.4)], ribbon=ribbon).molecules
        sides = molecules.boundary_sides[molecules.boundary_sides[:, 3] > 0]
        assert np.all(molecules.folded[sides[:, :3], 1] == ribbon)
        border = molecules.boundary_sides[molecules.boundary_sides[:, 3] == 0]
        assert np.all(molecules.folded[border[:, :3], 1] == -ribbon)


def test_the_checker_sees_a_moved_vertex() -> None:
    stages = run_stages([rectangle(2, 1)])
    moved = stages.molecules.vertices.copy()
    moved[7] += 1e-6
    faults = molecule_faults(dataclasses.replace(stages.molecules, vertices=moved), stages.area, stages.tolerance)
    assert any("changes its length" in fault for fault in faults)
