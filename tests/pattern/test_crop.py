"""Patterns that are cut down to a part of their sheet."""

from __future__ import annotations

import numpy as np
import pytest

import foldcut
from foldcut.pattern.crop import crop
from foldcut.proof.verify import verify
from foldcut.samples import sample_path


@pytest.mark.parametrize("name", ["swan", "ring"])
def test_what_is_left_of_a_pattern_is_verified_and_has_the_same_creases_there(name: str) -> None:
    made = foldcut.fold(sample_path(name), method="skeleton", effort="fast").folded_pattern
    corners = np.concatenate(made.shape.loops)
    low, high = corners.min(axis=0) - 4.0, corners.max(axis=0) + 6.0
    creases, folded = crop(made.creases, made.folded, low, high)
    assert verify(creases, folded.layers, made.shape) == []
    assert creases.vertices_coords.min(axis=0).tolist() == low.tolist()
    assert creases.vertices_coords.max(axis=0).tolist() == high.tolist()
    assert folded.vertices_coords[:, 0].min() == 0.0
    whole = made.creases.vertices_coords
    well_within = ((whole > low + 1e-6) & (whole < high - 1e-6)).all(axis=1)
    kept = ((creases.vertices_coords > low + 1e-6) & (creases.vertices_coords < high - 1e-6)).all(axis=1)
    np.testing.assert_array_equal(
        np.unique(creases.vertices_coords[kept], axis=0), np.unique(whole[well_within], axis=0)
    )
    assert 0 < creases.crease_count <= made.creases.crease_count


def test_without_a_part_of_the_shape_the_pattern_is_no_longer_that_of_the_shape() -> None:
    made = foldcut.fold(sample_path("ring"), method="skeleton", effort="fast").folded_pattern
    middle = np.concatenate(made.shape.loops).mean(axis=0)
    creases, folded = crop(made.creases, made.folded, np.zeros(2), middle + 1.0)
    assert verify(creases, folded.layers) == []
    assert {finding.check for finding in verify(creases, folded.layers, made.shape)} == {"cut"}


def test_vertices_that_all_but_lie_on_the_border_are_put_there() -> None:
    made = foldcut.fold(sample_path("square"), method="skeleton", effort="fast").folded_pattern
    sheet = made.sheet
    creases, folded = crop(made.creases, made.folded, np.full(2, 1e-8), np.array([sheet.width, sheet.height]) - 1e-8)
    assert verify(creases, folded.layers, made.shape) == []
    assert len(creases.vertices_coords) == len(made.creases.vertices_coords)
