"""How far outlines are apart."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from support.strategies import rectangle, regular, star

from foldcut.redraw.distance import apart


def test_distances_that_are_known() -> None:
    square = np.array(rectangle(10, 10), dtype=float)
    assert apart([square], [square]) == 0
    assert apart([square], [square + np.array([3, 0])]) == pytest.approx(3)
    notch = np.array([(0, 0), (10, 0), (10, 10), (5, 4), (0, 10)], dtype=float)
    whole = np.array([(0, 0), (10, 0), (10, 10), (0, 10)], dtype=float)
    assert 4 < apart([whole], [notch]) < 5, "the middle of the bridged side is farther from the notch than its corner"


@pytest.mark.parametrize(
    ("some", "others"),
    [
        (regular(40), regular(7)),
        (star(6, 0.5), star(6, 0.55)),
        (np.array(star(9, 0.7)) * (1.0, 0.6), np.array(regular(30)) * (0.9, 0.6)),
    ],
)
def test_the_distance_is_that_of_points_close_together(some: np.ndarray, others: np.ndarray) -> None:
    some, others = (np.array(loop, dtype=float) * 50 for loop in (some, others))
    dense = [shapely.segmentize(shapely.LinearRing(loop), 0.02) for loop in (some, others)]
    assert apart([some], [others]) == pytest.approx(shapely.hausdorff_distance(*dense), abs=0.03)
    assert apart([some], [others]) == apart([others], [some])
