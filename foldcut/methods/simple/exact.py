"""Make a drawing exactly as symmetric as its folds take it to be.

Shape, its folds and the line of the cut -> the same with every corner, every fold and the cut moved a little, so that
the boundary of the shape lands on the cut to the last digits.

Where a side lies on a face of the folded sheet, the face's reflections take both of its ends onto the cut. Where three
lines, folds or borders of the sheet, go through one point, they still do afterwards. These are equations for the
corners, the folds, the cut and those points. Newton's method solves them, with the shortest step of each round.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, Indices, points_array
from foldcut.core.model import Shape, Sheet
from foldcut.methods.simple.lines import Line
from foldcut.methods.simple.stack import Stack, flat_sheet
from foldcut.pattern.cut_line import sides_of

__all__ = ["exactly"]

ROUNDS = 8
"""How many steps are made at most; each squares the error."""

EXACT = 1e-13
"""What is off by less than this, relative to the sheet's diagonal, is exact."""

SAME = 1e-11
"""What is off by less than this, relative to the sheet's diagonal, needs no change."""

STEP = 1e-6
"""The step of numerical derivatives, relative to the sheet's diagonal."""

WEAK = 1e-6
"""Directions in which the equations hardly change, relative to the strongest, are left alone."""

Folds = tuple[Line, ...]


def exactly(shape: Shape, sheet: Sheet, folds: Folds, cut: Line, tie: float) -> tuple[Shape, Folds, Line] | None:
    """Return a shape, its folds and the line of the cut, all moved so that they match; None where that fails.

    ``tie`` is how far off they are at most, in mm. What matches but for the last digits is returned as it is.
    """
    stack = flat_sheet(sheet)
    for line in folds:
        stack = stack.fold(line.origin, line.along, tie)
    equations = _equations(shape, sheet, stack, len(folds), tie)
    middle = np.array([sheet.width, sheet.height]) / 2
    lines = np.array([_numbers(line, middle, sheet.diagonal) for line in (*folds, cut)])
    corners = np.concatenate(shape.loops)
    x = np.concatenate([(corners - middle).ravel(), lines.ravel(), (stack.flat[equations.meeting] - middle).ravel()])
    off = equations.off(x)
    if np.abs(off).max() <= SAME * sheet.diagonal:
        return shape, folds, cut
    for _ in range(ROUNDS):
        if np.abs(off).max() <= EXACT * sheet.diagonal:
            break
        x = x - np.linalg.lstsq(equations.slopes(x, off), off, rcond=WEAK)[0]
        off = equations.off(x)
    if not np.abs(off).max() <= 100 * EXACT * sheet.diagonal:
        return None
    moved, numbers, _ = equations.parts(x)
    ends = np.cumsum([len(loop) for loop in shape.loops])[:-1]
    loops = tuple(points_array(loop) for loop in np.split(moved + middle, ends))
    straight = [_line(one, middle, sheet.diagonal) for one in numbers]
    return Shape(loops, shape.parent), tuple(straight[:-1]), straight[-1]


def _numbers(line: Line, middle: Floats, size: float) -> tuple[float, float]:
    """Return the direction of a line, as an angle times ``size``, and how far to its right the middle is."""
    return float(np.arctan2(line.along[1], line.along[0])) * size, -float(line.off(middle))


def _line(numbers: Floats, middle: Floats, size: float) -> Line:
    """Return the line with such numbers."""
    angle, level = numbers[0] / size, numbers[1]
    along = np.array([np.cos(angle), np.sin(angle)])
    return Line(middle + level * np.array([-along[1], along[0]]), along)


@dataclass(frozen=True, eq=False)
class _Equations:
    """What has to be 0: how far points are off lines once some of the folds are made.

    The unknowns, in mm from the middle of the sheet, are ``corners`` corners, ``lines`` lines (angle times ``size``,
    and level), the cut last, and the points ``meeting`` ``(m,)``, vertices of the stack. Equation n takes ``point[n]``,
    turns it over with those folds of which ``turned[n]`` has the bit, and asks how far it is off line ``on[n]``; those
    ``on`` a negative number are to stay at ``place`` in coordinate -1 - ``on``.
    """

    corners: int
    lines: int
    size: float
    meeting: Indices
    point: Indices
    turned: Indices
    on: Indices
    place: Floats

    def parts(self, x: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the corners, the lines' numbers and the points."""
        a, b = 2 * self.corners, 2 * (self.corners + self.lines)
        return x[:a].reshape(-1, 2), x[a:b].reshape(-1, 2), x[b:].reshape(-1, 2)

    def off(self, x: Floats) -> Floats:
        """Return how far off each equation is, in mm."""
        corners, lines, points = self.parts(x)
        at = np.concatenate([corners, points])[self.point]
        angle = lines[:, 0] / self.size
        normal, level = np.stack([-np.sin(angle), np.cos(angle)], axis=1), lines[:, 1]
        for k in range(self.lines - 1):
            turning: Bools = (self.turned >> k) % 2 == 1
            away = at[turning] @ normal[k] - level[k]
            at[turning] -= 2 * away[:, None] * normal[k]
        on = np.maximum(self.on, 0)
        off: Floats = (at * normal[on]).sum(axis=1) - level[on]
        border = self.on < 0
        off[border] = at[border, -1 - self.on[border]] - self.place[border]
        return off

    def slopes(self, x: Floats, off: Floats) -> Floats:
        """Return the derivatives of ``off`` by all unknowns, ``(equations, unknowns)``."""
        step = STEP * self.size
        columns = [(self.off(x + step * unit) - off) / step for unit in np.eye(len(x))]
        return np.stack(columns, axis=1)


def _equations(shape: Shape, sheet: Sheet, stack: Stack, count: int, tie: float) -> _Equations:
    """Return the equations for a shape and a stack that was folded ``count`` times."""
    sides = sides_of(shape)
    following = np.concatenate([np.roll(loop, -1) for loop in _numbers_of_corners(shape)])
    side, turned = _faces_of_sides(sides, stack, tie)
    point, on = np.concatenate([side, following[side]]), np.full(2 * len(side), count)
    size = np.array([sheet.width, sheet.height])
    border = [(axis, end) for axis in (0, 1) for end in (0.0, float(size[axis]))]
    at_border = np.stack([np.abs(stack.flat[:, axis] - end) <= tie for axis, end in border], axis=1)
    on_fold = (stack.on[:, None] >> np.arange(count)) % 2 == 1
    meeting = np.flatnonzero((at_border.sum(axis=1) + on_fold.sum(axis=1) > 2) & on_fold.any(axis=1))
    vertex, fold = np.nonzero(on_fold[meeting])
    held, which = np.nonzero(at_border[meeting])
    corners = len(sides)
    axes, ends = np.array([axis for axis, _ in border]), np.array([end for _, end in border])
    return _Equations(
        corners,
        count + 1,
        sheet.diagonal,
        meeting,
        np.concatenate([point, corners + vertex, corners + held]),
        # before its own fold a point is turned over by the earlier ones only
        np.concatenate([turned, turned, stack.turned[meeting[vertex]] & ((1 << fold) - 1), np.zeros_like(held)]),
        np.concatenate([on, fold, -1 - axes[which]]),
        np.concatenate([np.zeros(len(point) + len(vertex)), ends[which] - size[axes[which]] / 2]),
    )


def _numbers_of_corners(shape: Shape) -> list[Indices]:
    """Return the numbers of the corners of each loop."""
    ends = np.cumsum([len(loop) for loop in shape.loops])
    return np.split(np.arange(int(ends[-1])), ends[:-1])


def _faces_of_sides(sides: Floats, stack: Stack, tie: float) -> tuple[Indices, Indices]:
    """Return which sides lie on which faces in part: the side's number, and the folds that turn the face over."""
    faces = shapely.polygons([shapely.linearrings(stack.flat[face]) for face in stack.faces])
    lines = shapely.linestrings(sides)
    side, face = shapely.STRtree(faces).query(lines, predicate="intersects")
    length = shapely.length(shapely.intersection(lines[side], faces[face]))
    kept = length > np.minimum(20 * tie, shapely.length(lines[side]) / 4)
    turned = np.array([np.bitwise_or.reduce(stack.turned[vertices]) for vertices in stack.faces])
    pairs = np.unique(np.stack([side[kept], turned[face[kept]]], axis=1), axis=0)
    return pairs[:, 0], pairs[:, 1]
