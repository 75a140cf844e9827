"""Outlines to fold on A4, by seed: polygons, several loops, symmetric ones and parts of them, and those of samples."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.errors import ShapeError
from foldcut.core.model import Shape, Sheet
from foldcut.drawing.laying import Laying
from foldcut.drawing.placement import Layout, parse_sheet
from foldcut.drawing.shape import make_shape
from foldcut.methods.frame import frames
from foldcut.methods.mirror.halves import halves_of
from foldcut.methods.mirror.unfold import Half
from foldcut.readers import read_shape
from foldcut.redraw.proxy import Engine, Field
from foldcut.samples import sample_path
from support.several_loops import random_loops
from support.strategies import star_shaped, two_opt

A4 = Sheet(210.0, 297.0)

MARGIN = 15.0
"""What is left free around an outline, in mm."""

KINDS = ("star", "tour", "holes", "apart")
"""Random outlines: one loop seen whole from a point, one loop through random points, one with holes, several apart."""


def on_a4(loops: Sequence[Floats]) -> Shape:
    """Return loops as large as fits on A4."""
    points = np.concatenate([np.asarray(loop, dtype=float) for loop in loops])
    low, high = points.min(axis=0), points.max(axis=0)
    size = np.array([A4.width, A4.height])
    scale = float(((size - 2 * MARGIN) / (high - low)).min())
    return make_shape([(np.asarray(loop, dtype=float) - (low + high) / 2) * scale + size / 2 for loop in loops])


def random_outline(kind: str, seed: int) -> Shape:
    """Return an outline of one of ``KINDS`` on A4."""
    if kind in ("holes", "apart"):
        while True:
            try:
                return on_a4(random_loops(seed, holes=kind == "holes"))
            except ShapeError:
                seed += 1000
    rng = np.random.default_rng(seed)
    make = {"star": star_shaped, "tour": two_opt}[kind]
    return on_a4([np.array(make(rng, int(rng.integers(4, 13)), 0.03))])


def mirrored_outline(seed: int, axes: tuple[int, ...]) -> Shape:
    """Return an outline that is symmetric about the sheet's upright middle line (0), the level one (1), or both."""
    rng = np.random.default_rng(seed)
    span = np.pi / 2 if len(axes) == 2 else np.pi
    count = int(rng.integers(3, 7))
    angles = span * (np.arange(count) + rng.uniform(0.2, 0.8, count)) / count
    points = (rng.uniform(0.35, 1.0, count) * np.exp(1j * angles)).tolist()  # above the level axis
    if axes == (0,):
        points = [-1j * z for z in points]  # to the right of the upright one
    for axis in axes:
        image = [-z.conjugate() if axis == 0 else z.conjugate() for z in reversed(points)]
        points = points + image
    return on_a4([np.array([(z.real, z.imag) for z in points])])


def half_of(shape: Shape, axes: tuple[int, ...], sheet: Sheet = A4) -> Half:
    """Return the part of the sheet that is left to fold for a symmetric shape, once it is folded along its axes."""
    return next(halves_of(shape, sheet, axes))


@cache
def sample_outline(name: str) -> tuple[Shape, Sheet]:
    """Return a sample in its frame, and the frame's sheet."""
    shape = make_shape(read_shape(sample_path(name)).loops)
    frame = next(frames(Laying(shape, Layout(parse_sheet("a4"))).lay()))
    return frame.shape, frame.sheet


def corners_of(shape: Shape) -> tuple[Floats, tuple[int, ...]]:
    """Return the corners of a shape, ``(n, 2)``, and how many each loop has."""
    return np.concatenate(shape.loops), tuple(map(len, shape.loops))


def engine_for(
    shape: Shape,
    sheet: Sheet = A4,
    tolerance: float = 1.0,
    axes: tuple[int, ...] = (),
    *,
    compiled: bool | None = None,
) -> Engine:
    """Return an engine for outlines near to a shape."""
    return Engine(Field(shape.loops, sheet.width, sheet.height, tolerance, axes), compiled=compiled)
