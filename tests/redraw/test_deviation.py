"""By how much an outline was moved: known lengths, and what may be left out."""

from __future__ import annotations

import numpy as np
import pytest

from foldcut.redraw.deviation import left_out, moved_by

SQUARE = np.array([(0.0, 0.0), (40.0, 0.0), (40.0, 40.0), (0.0, 40.0)])
EYE = np.array([(18.0, 18.0), (20.0, 18.0), (20.0, 20.0), (18.0, 20.0)])


def test_lengths_that_are_known() -> None:
    assert moved_by([SQUARE], [SQUARE]) == 0
    assert moved_by([SQUARE + np.array([3.0, 0.0])], [SQUARE]) == pytest.approx(3, abs=1e-3)
    assert moved_by([SQUARE * (1.0, 0.5)], [SQUARE]) == pytest.approx(20, abs=0.1)


def test_a_hole_that_is_left_out_counts_by_half_its_width() -> None:
    moved = moved_by([SQUARE], [SQUARE, EYE])
    assert moved == pytest.approx(1, abs=0.01)
    assert left_out([SQUARE], [SQUARE, EYE], moved) > 15
    assert left_out([SQUARE], [SQUARE], 0.0) == 0
