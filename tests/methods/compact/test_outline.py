"""The outline of a shape."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from foldcut.methods.compact.outline import MOST_POCKETS, Outline

U = np.array([(0, 0), (3, 0), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)], dtype=float)


def test_the_sides_of_a_pocket_have_its_bit() -> None:
    outline = Outline(U)
    assert outline.pockets.tolist() == [0, 0, 1, 1, 1, 1, 1, 0]
    assert outline.pocket_bits == [1]
    assert np.flatnonzero(outline.reflex).tolist() == [4, 5]


def test_more_pockets_than_bits_share_the_last() -> None:
    angles = np.arange(160) * 2 * np.pi / 160
    reach = np.where(np.arange(160) % 2, 1.0, 1.2)
    outline = Outline(np.stack([reach * np.cos(angles), reach * np.sin(angles)], axis=1))
    assert len(outline.pocket_bits) == MOST_POCKETS
    assert (outline.pockets > 0).all()


def test_the_width_is_measured_to_sides_that_are_not_beside() -> None:
    outline = Outline(U)
    assert outline.width_at(np.array([1.5, 0.0]), 0) == pytest.approx(1.0)
    assert outline.width_at(np.array([1.5, 1.0]), 4) == pytest.approx(1.0)


def test_the_free_region_shrinks_inside_and_outside() -> None:
    outline = Outline(U)
    assert outline.front(0.25, False).area == pytest.approx(2 * 0.5 * 2.5 + 1.5 * 0.5, rel=1e-5)
    beside = shapely.Point(3.3, 1.0)
    assert [outline.front(height, True).covers(beside) for height in (0.25, 0.5)] == [True, False]
    assert outline.front(0.25, False) is outline.front(0.25, False), "kept"
