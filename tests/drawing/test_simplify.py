"""Simplification: fewer corners within the tolerance, and the same topology."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from support.strategies import regular, simple_polygons, star

from foldcut.core.errors import BadInputError
from foldcut.core.model import Shape
from foldcut.drawing.shape import invariant_faults, make_shape
from foldcut.drawing.simplify import Simplified, simplify

BUMPY = [(0, 0), (50, 0.3), (100, 0), (100, 60), (0, 60)]


def simplification_faults(before: Shape, done: Simplified, tolerance: float) -> list[str]:
    """Return which invariants a simplified shape breaks."""
    after = done.shape
    faults = invariant_faults(after)
    if after.parent != before.parent:
        faults.append("loops lie within others than before")
    if (done.corners_before, done.corners_after) != (before.corner_count, after.corner_count):
        faults.append("corners are counted wrong")
    if done.deviation > tolerance:
        faults.append(f"the deviation is {done.deviation:.3g}")
    farthest = 0.0
    for old, new in zip(before.loops, after.loops, strict=True):
        if not set(map(tuple, new.tolist())) <= set(map(tuple, old.tolist())):
            faults.append("a corner was moved")
        farthest = max(
            farthest, shapely.hausdorff_distance(shapely.linearrings(old), shapely.linearrings(new), densify=0.05)
        )
    if farthest > done.deviation + 1e-6:
        faults.append(f"boundaries are {farthest:.3g} apart, not {done.deviation:.3g}")
    return faults


def test_a_corner_within_the_tolerance_is_left_out_and_reported() -> None:
    done = simplify(make_shape([BUMPY]), 0.5)
    assert (done.corners_before, done.corners_after) == (5, 4)
    assert done.deviation == pytest.approx(0.3)
    assert str(done) == "simplified: 5 -> 4 corners, at most 0.3 mm off"


def test_a_corner_beyond_the_tolerance_stays() -> None:
    done = simplify(make_shape([BUMPY]), 0.29)
    assert done.corners_after == 5
    assert done.deviation == 0
    assert str(done) == "simplified: none of the 5 corners can be left out"


def test_deviations_do_not_add_up_along_a_bow() -> None:
    # Each corner is 0.1 off its neighbours' line, the middle 10 off the ends'.
    bow = [(x, 10 - x * x / 10) for x in range(10, -11, -1)]
    shape = make_shape([[*bow, (0, -50)]])
    done = simplify(shape, 0.5)
    assert simplification_faults(shape, done, 0.5) == []
    assert 5 <= done.corners_after <= 10


def test_a_regular_polygon_stays_regular() -> None:
    corners = simplify(make_shape([regular(48)]), 0.01).shape.loops[0]
    assert len(corners) == 24
    sides = np.hypot(*(corners - np.roll(corners, 1, axis=0)).T)
    assert np.ptp(sides) < 1e-12


def test_a_mirrored_shape_stays_mirrored() -> None:
    right = [(math.sin(t), math.cos(t)) for t in np.linspace(0.2, 2.9, 16)]
    corners = simplify(make_shape([[*right, *((-x, y) for x, y in right[::-1])]]), 0.02).shape.loops[0]
    rows = sorted((round(x, 9), round(y, 9)) for x, y in corners.tolist())
    assert rows == sorted((-x, y) for x, y in rows)
    assert len(rows) < 20


def test_a_mirrored_pair_goes_together_or_stays() -> None:
    notched = [(0, 0), (45, 0.1), (55, 0.1), (100, 0), (100, 60), (0, 60)]
    assert simplify(make_shape([notched]), 0.5).corners_after == 4
    cut_off = [(0, 0), (45, -3), (55, -3), (100, 0), (100, 60), (0, 60)]
    assert simplify(make_shape([cut_off]), 0.6).corners_after == 6  # one alone would be 0.54 off, both 3


def test_three_corners_stay_however_large_the_tolerance() -> None:
    assert simplify(make_shape([star(5, 0.4)]), 100.0).corners_after == 3


def test_loops_do_not_come_to_touch() -> None:
    # The dent at (50, 40) leaves room for a hole; without the dent the edge would cross it.
    outer = [(0, 0), (100, 0), (100, 40), (50, 50), (0, 40)]
    hole = [(30, 43), (50, 48), (70, 43), (50, 20)]
    shape = make_shape([outer, hole])
    done = simplify(shape, 12.0)
    assert simplification_faults(shape, done, 12.0) == []
    assert (50, 50) in set(map(tuple, done.shape.loops[0].tolist()))


@settings(max_examples=60)
@given(simple_polygons(4, 40), st.sampled_from([0.0, 1e-3, 0.02, 0.1, 0.5, 3.0]))
def test_every_polygon_keeps_the_invariants(polygon: list[tuple[float, float]], tolerance: float) -> None:
    shape = make_shape([polygon])
    assert simplification_faults(shape, simplify(shape, tolerance), tolerance) == []


def test_the_checker_sees_a_wrong_deviation_and_a_moved_corner() -> None:
    shape = make_shape([BUMPY])
    done = simplify(shape, 0.5)
    wrong = Simplified(done.shape, 5, 4, 0.1)
    assert simplification_faults(shape, wrong, 0.5)
    moved = Simplified(make_shape([[(0, 0.1), *BUMPY[1:]]]), 5, 5, 0.2)
    assert "a corner was moved" in simplification_faults(shape, moved, 0.5)


@pytest.mark.parametrize("tolerance", [-1.0, float("nan"), float("inf")])
def test_a_tolerance_that_is_none_is_refused(tolerance: float) -> None:
    with pytest.raises(BadInputError, match="tolerance to simplify with"):
        simplify(make_shape([BUMPY]), tolerance)
