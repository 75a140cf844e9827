"""In which ways a drawing may be folded that is redrawn within a tolerance: as a whole, or along its mirror axes first.

``Problem``, its curves and a tolerance -> ``Plan``s: the drawing in a frame, with the axes in the middle of the sheet.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import shapely

from foldcut.core.arrays import Floats
from foldcut.core.errors import ShapeError
from foldcut.core.model import Shape, Sheet
from foldcut.drawing.laying import Laid
from foldcut.drawing.shape import make_shape, polygon_loops
from foldcut.geometry.curves import CurvedLoop
from foldcut.geometry.mirror_axes import symmetric
from foldcut.methods.base import Problem
from foldcut.methods.frame import Frame, frames
from foldcut.methods.mirror.halves import halves_of
from foldcut.methods.mirror.unfold import Half
from foldcut.redraw.proxy import Field
from foldcut.redraw.starts import Axis as StartAxis
from foldcut.redraw.starts import all_starts
from foldcut.redraw.symmetry import Axis, symmetry
from foldcut.redraw.target import Target

ALIGNED = 1e-5
"""An axis whose direction differs by less than this from that of a side of the sheet, in radians, is parallel to it."""

SQUARE = 1e-4
"""Two axes are at right angles if the angle between them differs from that by less than this, in radians."""

FAR = 1e4
"""More than the size of any sheet of a frame, in mm."""

LEAST_SIDE = 0.05
"""Outlines with shorter sides are no good beginning, in mm."""

Corners = tuple[Floats, tuple[int, ...]]
"""The corners of several loops, ``(n, 2)`` mm, and how many each loop has."""


@dataclass(frozen=True, eq=False)
class Plan:
    """A drawing in a frame, and the axes along which the sheet is folded first: 0 its upright middle line, 1 the level one.

    ``laid``: how the drawing lies on the sheet that is asked for, turned perhaps; ``target`` is in mm of the frame, with
    the axes in the middle of the frame's sheet.
    """

    laid: Laid
    frame: Frame
    target: Target
    axes: tuple[int, ...]

    @cached_property
    def middle(self) -> Floats:
        """Where the part of the frame's sheet begins that is left after the axes are folded, ``(2,)`` mm."""
        size = np.array([self.frame.sheet.width, self.frame.sheet.height])
        return np.where(np.isin([0, 1], self.axes), size / 2, 0.0)

    @cached_property
    def part(self) -> Sheet:
        """That part of the frame's sheet."""
        size = np.array([self.frame.sheet.width, self.frame.sheet.height]) - self.middle
        return Sheet(*size.tolist())

    def field(self, tolerance: float) -> Field:
        """Return what outlines are compared with, within ``tolerance`` mm, on that part of the sheet."""
        loops = tuple(loop - self.middle for loop in self.target.loops)
        return Field(loops, self.part.width, self.part.height, tolerance, self.axes)

    def starts(self, tolerance: float) -> Iterator[Corners]:
        """Yield outlines to begin a search with, on that part of the sheet."""
        middle = np.array([self.frame.sheet.width, self.frame.sheet.height]) / 2
        axes = [StartAxis(middle, math.pi / 2 if axis == 0 else 0.0) for axis in self.axes]
        for start in all_starts(self.target.shape, tolerance, axes):
            if len(start.axes) < len(axes):
                return
            loops = start.shape.loops
            if min(float(np.hypot(*(np.roll(loop, -1, axis=0) - loop).T).min()) for loop in loops) < LEAST_SIDE:
                continue
            if axes:
                exact, moved = symmetric(start.shape, middle, self.axes)
                if moved > 0.1 * tolerance:
                    continue
                loops = next(halves_of(exact, self.frame.sheet, self.axes)).loops
            yield np.concatenate(loops), tuple(map(len, loops))

    def outline(self, corners: Floats, sizes: tuple[int, ...]) -> tuple[Shape, Half | None]:
        """Return the whole shape of an outline on its part of the sheet, and the half to fold it by, if there are axes.

        Raises ``ShapeError`` where it is no shape, or its loops are not nested as in the drawing.
        """
        loops = tuple(np.split(corners, np.cumsum(sizes)[:-1]))
        if not self.axes:
            shape = make_shape(loops)
            if len(shape.parent) != len(self.target.parent) or shape.corner_count != len(corners):
                raise ShapeError("the redrawn outline is no shape")
            return shape, None
        area = shapely.Polygon()
        for loop in loops:
            area = area.symmetric_difference(shapely.Polygon(loop))
        low = [0.0 if axis in self.axes else -FAR for axis in (0, 1)]
        area = area.intersection(shapely.box(*low, FAR, FAR))
        for axis in self.axes:
            sign = np.where(np.arange(2) == axis, -1.0, 1.0)
            area = area.union(shapely.transform(area, lambda points, sign=sign: points * sign))
        polygons = [one for one in getattr(area, "geoms", [area]) if one.area > 0]
        shape = make_shape([loop + self.middle for loop in polygon_loops(polygons)])
        if len(shape.parent) != len(self.target.parent):
            raise ShapeError("the redrawn outline is no shape")
        return shape, Half(shape, loops, self.part, self.axes)


def plans(problem: Problem, curves: Sequence[CurvedLoop], tolerance: float) -> Iterator[Plan]:
    """Yield plans for a drawing that may be off by ``tolerance`` mm of the frame: those with most axes come first.

    ``curves`` are the loops of ``problem.laid.drawn`` where they are known.
    """
    laid = problem.laid
    frame = next(frames(laid))
    target = Target.of_frame(frame, curves)
    found = symmetry(target, tolerance)
    sets = [pair for pair in _pairs(found.axes)] + [(axis,) for axis in (*found.axes, *found.others)]
    turns: list[tuple[float, tuple[Axis, ...]]] = []
    for axes in sets:
        turn = -math.remainder(axes[0].angle, math.pi / 2)
        turn = 0.0 if abs(turn) < ALIGNED else turn
        if turn == 0.0 or problem.may_turn:
            turns.append((turn, axes))
    for turn, axes in turns[:4]:
        on = problem.lay(_degrees(turn, frame)) if turn else laid
        again = next(frames(on)) if turn else frame
        there = Target.of_frame(again, curves) if turn else target
        plan = _with_axes_in_the_middle(on, again, there, len(axes), tolerance, axes, turn)
        if plan is not None:
            yield plan
    yield Plan(laid, frame, target, ())


def _degrees(turn: float, frame: Frame) -> float:
    """Return a turn in degrees on the sheet; a quarter turn of the frame does not change it."""
    del frame
    return math.degrees(turn)


def _pairs(axes: Sequence[Axis]) -> Iterator[tuple[Axis, Axis]]:
    """Yield pairs of axes at right angles."""
    for k, one in enumerate(axes):
        for other in axes[k + 1 :]:
            if abs(abs(math.remainder(one.angle - other.angle, math.pi)) - math.pi / 2) < SQUARE:
                yield one, other


def _with_axes_in_the_middle(
    laid: Laid, frame: Frame, target: Target, count: int, tolerance: float, axes: Sequence[Axis], turn: float
) -> Plan | None:
    """Return the plan with the drawing moved so that its axes are in the middle of the frame's sheet, None if not near."""
    middle = np.array([frame.sheet.width, frame.sheet.height]) / 2
    if turn:
        again = symmetry(target, tolerance)
        axes = [
            axis
            for axis in (*again.axes, *again.others)
            if abs(math.remainder(axis.angle, math.pi / 2)) < 1e-3
        ][:2]
        if len(axes) < count:
            return None
        axes = axes if count == 2 else [min(axes, key=lambda axis: axis.off)]
    numbers = tuple(sorted({0 if abs(math.cos(axis.angle)) < 0.5 else 1 for axis in axes}))
    if len(numbers) != count:
        return None
    step = np.zeros(2)
    for axis in axes:
        number = 0 if abs(math.cos(axis.angle)) < 0.5 else 1
        place = axis.offset / axis.normal[number]
        step[number] = middle[number] - place
    if np.abs(step).max() > max(2 * tolerance, 1.0):
        return None
    matrix = np.column_stack([np.eye(2), step])
    moved = Target.of_curves([one.transformed(matrix) for one in target.curves], target.parent)
    return Plan(laid, frame, moved, numbers)


def on_the_sheet(plan: Plan, shape: Shape, notes: Sequence[str] = ()) -> Laid:
    """Return how a redrawn shape of the frame lies on the sheet that is asked for."""
    laid = plan.laid
    return replace(laid, shape=plan.frame.on_sheet(shape), notes=(*laid.notes, *notes))
