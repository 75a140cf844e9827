"""Halves of the sheet that are folded along their straight skeletons."""

from __future__ import annotations

import numpy as np
import pytest
from support.strategies import Points, rectangle

import foldcut
from foldcut.core.model import Shape
from foldcut.drawing.placement import parse_sheet, place
from foldcut.drawing.shape import make_shape
from foldcut.geometry.mirror_axes import mirror_axes
from foldcut.methods.base import straight_folds
from foldcut.methods.mirror.along_skeleton import along_skeletons, with_corners_moved
from foldcut.methods.mirror.halves import halves, whole_loops
from foldcut.methods.skeleton.quick import fold_outline
from foldcut.proof.verify import verify
from foldcut.samples import sample_path

SHEET = parse_sheet("a4-portrait")
ARROW: list[Points] = [[(-2, 0), (2, 0), (2, 6), (4, 6), (0, 11), (-4, 6), (-2, 6)]]
FRAME: list[Points] = [rectangle(12, 9), rectangle(6, 5)]
HEXAGON: list[Points] = [[(3, 0), (1.6, 2.4), (-1.6, 2.4), (-3, 0), (-1.6, -2.4), (1.6, -2.4)]]


def placed(loops: list[Points]) -> Shape:
    shape = place(make_shape(loops), SHEET, margin=30.0)[0]
    corners = np.concatenate(shape.loops)
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
    return Shape(tuple(loop + SHEET.corners.mean(axis=0) - middle for loop in shape.loops), shape.parent)


@pytest.mark.parametrize(("loops", "axes"), [(ARROW, (0,)), (FRAME, (0, 1)), (HEXAGON, (0, 1))])
def test_the_whole_of_a_half_is_the_shape(loops: list[Points], axes: tuple[int, ...]) -> None:
    shape = placed(loops)
    half = next(halves(shape, SHEET, axes))
    at = np.where(np.isin([0, 1], axes), [half.sheet.width, half.sheet.height], 0.0)
    found = [one + at for one in whole_loops(half.loop, half.axes)]
    assert len(found) == len(shape.loops)
    every = np.concatenate(found)
    for corner in np.concatenate(shape.loops):
        assert np.hypot(*(every - corner).T).min() < 1e-9
    assert len(every) == shape.corner_count


@pytest.mark.parametrize(("loops", "axes"), [(ARROW, (0,)), (FRAME, (0, 1)), (HEXAGON, (0, 1))])
def test_what_is_found_for_halves_folds_the_whole_with_fewer_folds(loops: list[Points], axes: tuple[int, ...]) -> None:
    shape = placed(loops)
    folds = []
    for half, made in along_skeletons(list(halves(shape, SHEET, axes))):
        assert verify(made.creases, made.folded.layers, shape) == []
        folds.append(len(half.axes) + straight_folds(made.part))
    assert min(folds) <= straight_folds(fold_outline(shape, SHEET).creases)


def test_moved_corners_of_a_half_leave_the_shape_symmetric() -> None:
    result = foldcut.fold(sample_path("heart"), method="mirror")
    assert result.findings == ()
    assert result.actions <= 17
    assert any("corners moved by at most 0." in note for note in result.notes)
    assert mirror_axes(result.folded_pattern.shape, 1e-6)
    exact = foldcut.fold(sample_path("heart"), method="mirror", adjust=0.0)
    assert not any("so that creases meet" in note for note in exact.notes)


@pytest.mark.parametrize("near", [0.1, 0.5])
def test_corners_move_no_farther_than_they_may(near: float) -> None:
    drawn = [(0, 0), (3, 3.01), (3.5, 5), (2.4, 6), (0, 4.9)]
    shape = placed([[*drawn, *[(-x, y) for x, y in drawn[:0:-1] if x]]])
    half = next(halves(shape, SHEET, (0,)))
    for moved, way in with_corners_moved(half, near):
        assert 0 < way <= near
        assert np.hypot(*(moved.loop - half.loop).T).max() == pytest.approx(way)
