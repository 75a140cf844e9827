"""Drawings with three mirror axes or more through one point: their outlines keep all axes and fold as a wedge."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
import shapely

from foldcut.core.arrays import Floats
from foldcut.core.model import Shape
from foldcut.drawing.laying import Laying
from foldcut.drawing.placement import Layout, parse_sheet
from foldcut.drawing.shape import make_shape
from foldcut.proof.verify import verify
from foldcut.redraw.plans import Drawing
from foldcut.redraw.redrawing import Redrawn, redraw
from foldcut.redraw.starts.chains import Axis, chains_of
from foldcut.redraw.wedges import around

pytestmark = pytest.mark.usefixtures("kernels_are_loaded")

TURN = math.tau * np.arange(360) / 360


def wave(count: int, depth: float, size: float = 45.0, turn: float = 0.0) -> Floats:
    """A smooth loop around the middle with ``count`` petals."""
    radius = size * (1 + depth * np.cos(count * TURN))
    return np.stack([radius * np.cos(TURN + turn), radius * np.sin(TURN + turn)], axis=1)


def petals(count: int) -> list[Floats]:
    """Ellipses around the middle that do not touch."""
    ellipse = np.stack([32 + 15 * np.cos(TURN), 9 * np.sin(TURN)], axis=1)
    turns = [math.tau * k / count for k in range(count)]
    return [ellipse @ np.array([(math.cos(t), math.sin(t)), (-math.sin(t), math.cos(t))]) for t in turns]


DRAWINGS = {
    "flower": (5, [wave(5, 0.3)], 2.0),
    "ring of petals with a hole": (6, [wave(6, 0.2), wave(6, 0.0, 15.0)], 2.0),
    "petals apart": (5, petals(5), 2.0),
    "turned": (3, [wave(3, 0.3, turn=0.3)], 1.0),
}


def drawing(loops: list[Floats], tolerance: float, *, may_turn: bool = False) -> Drawing:
    laying = Laying(make_shape(loops), Layout(parse_sheet("a4"), rotation=0.0))
    return Drawing.of(laying, (), tolerance, may_turn=may_turn)


@cache
def found(name: str) -> tuple[Drawing, Redrawn]:
    _, loops, tolerance = DRAWINGS[name]
    drawn = drawing(loops, tolerance)
    best = redraw(drawn, tolerance, work=1)
    assert best is not None
    return drawn, best


@pytest.mark.parametrize("name", DRAWINGS)
def test_curved_drawings_with_many_axes_become_patterns_for_two_hands(name: str) -> None:
    count, _, tolerance = DRAWINGS[name]
    _, best = found(name)
    assert best.is_for_hands
    assert best.folds <= 16
    assert best.off <= tolerance
    assert len(best.made.first_folds) == count
    assert not verify(best.made.creases, best.made.folded.layers, best.made.laid.shape)


@pytest.mark.parametrize("name", DRAWINGS)
def test_outlines_are_within_the_tolerance_by_another_measure_and_exactly_symmetric(name: str) -> None:
    count, _, tolerance = DRAWINGS[name]
    drawn, best = found(name)
    lines = [
        shapely.segmentize(shapely.multilinestrings([shapely.linestrings([*loop, loop[0]]) for loop in loops]), 0.2)
        for loops in (best.shape.loops, drawn.target.loops)
    ]
    assert shapely.hausdorff_distance(*lines) <= tolerance + 0.05
    corners = np.concatenate(best.shape.loops)
    turned = (corners - corners.mean(axis=0)) @ rotation(math.tau / count) + corners.mean(axis=0)
    away = shapely.distance(shapely.points(turned), shapely.multipoints(corners))
    assert away.max() < 1e-9


def rotation(angle: float) -> Floats:
    return np.array([(math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))])


def test_a_windmill_a_ring_and_a_drawing_with_two_axes_are_no_wedges() -> None:
    blade = np.array([(5, 0), (40, 0), (40, 10), (12, 14)])
    windmill = [blade @ rotation(math.tau * k / 4) for k in range(4)]
    assert around(drawing(windmill, 1.0)) is None
    assert around(drawing([wave(2, 0.3)], 1.0)) is None
    assert around(drawing([wave(2, 0.0), wave(2, 0.0, 20.0)], 1.0)) is None
    twelve = around(drawing([wave(12, 0.2)], 1.0))
    assert twelve is not None
    assert twelve.axes.count == 12


def test_a_drawing_may_be_turned_until_an_axis_is_along_the_sheet() -> None:
    loops = [wave(5, 0.3, turn=0.1)]
    still, turned = around(drawing(loops, 1.0)), around(drawing(loops, 1.0, may_turn=True))
    assert still is not None
    assert turned is not None
    assert still.axes.upright_turn != 0
    assert turned.axes.upright_turn == 0


@pytest.mark.parametrize("count", [3, 5, 8])
def test_the_chain_of_one_sector_makes_the_whole_loop_again(count: int) -> None:
    loop = wave(count, 0.2)
    axes = [Axis(np.zeros(2), math.pi * k / count) for k in range(count)]
    chains = chains_of(Shape((loop,), (-1,)), 0.5, axes)
    assert chains is not None
    (chain,) = chains.chains
    angle = np.arctan2(*chain.points.T[::-1])
    assert np.ptp(angle) == pytest.approx(math.pi / count, abs=1e-6)


@pytest.mark.parametrize("count", [3, 6])
def test_loops_beside_the_middle_are_images_of_one(count: int) -> None:
    loops = petals(count)
    axes = [Axis(np.zeros(2), math.pi * k / count) for k in range(count)]
    chains = chains_of(Shape(tuple(loops), (-1,) * count), 0.5, axes)
    assert chains is not None
    assert len(chains.chains) == 1
    assert len(chains.source) == count
