"""Convex sheets: what lies on them, and where lines leave them, compared with shapely."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from foldcut.geometry.convex_sheet import ConvexBorder, ConvexSheet

OUTLINE = np.array([(0, 0), (90, 0), (100, 30), (60, 60)], dtype=np.float64)
SHEET = ConvexSheet.of(OUTLINE)
BORDER = ConvexBorder(SHEET, 1e-7)
POLYGON = shapely.Polygon(OUTLINE)


def test_a_convex_sheet_is_as_large_as_the_rectangle_around_it() -> None:
    assert (SHEET.width, SHEET.height) == (100, 60)
    assert SHEET.corners.tolist() == OUTLINE.tolist()
    assert SHEET.diagonal == math.hypot(100, 60)
    assert ConvexSheet.of(OUTLINE) == SHEET
    assert hash(SHEET) == hash(ConvexSheet.of(OUTLINE))
    assert ConvexSheet.of(OUTLINE[[0, 1, 2]]) != SHEET


def test_points_on_the_border_are_not_inside() -> None:
    random = np.random.default_rng(0)
    for x, y in random.uniform(-10, 110, (300, 2)).tolist():
        assert BORDER.has_inside((x, y)) == POLYGON.contains(shapely.Point(x, y))
    assert not BORDER.has_inside((40, 1e-8))
    assert BORDER.has_inside((40, 1e-6))


def test_segments_are_cut_off_at_the_border() -> None:
    random = np.random.default_rng(1)
    inside = 0
    for (x, y), (to_x, to_y) in random.uniform(-20, 120, (300, 2, 2)).tolist():
        part = BORDER.part_inside((x, y), (to_x, to_y))
        line = shapely.LineString([(x, y), (to_x, to_y)])
        kept = line.intersection(POLYGON).length
        assert (0.0 if part is None else part[1] - part[0]) * line.length == pytest.approx(kept, abs=1e-6)
        inside += part is not None
    assert 50 < inside < 290
    assert BORDER.part_inside((10, 0), (50, 0)) is None
    assert BORDER.part_inside((10, 5), (50, 5)) == (0.0, 1.0)


def test_lines_leave_the_sheet_where_they_cross_its_border() -> None:
    random = np.random.default_rng(2)
    left = 0
    for to_x, to_y in random.uniform(-50, 150, (200, 2)).tolist():
        place = BORDER.exit_of((60.0, 20.0), (to_x, to_y))
        if POLYGON.contains(shapely.Point(to_x, to_y)):
            assert place is None
            continue
        left += 1
        assert place is not None
        kept = shapely.LineString([(60, 20), (to_x, to_y)]).intersection(POLYGON)
        assert place == pytest.approx(kept.coords[-1], abs=1e-9)
    assert left > 100
    assert BORDER.exit_of((60.0, 20.0), (60.0, 0.0)) == (60.0, 0.0)
