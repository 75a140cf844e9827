"""Unfold the pattern of a half or a quarter of the sheet to that of the whole sheet.

``Half``, and the pattern that folds it -> the whole pattern.

The sheet is folded along its axes first, so what folds the half folds all layers there at once: behind each face goes
its mirror image, on the side of its back. The order of layers is that of a folded sheet of double thickness, so nothing
needs to be shown about it. Mountains and valleys are read off the order, also along the axes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, points_array
from foldcut.core.model import CreasePattern, FoldedState, Region, Shape, Sheet
from foldcut.geometry.vectors import signed_area
from foldcut.methods.sheet_part import SheetPart
from foldcut.pattern.assemble import assemble, creases_of_stack


class LoopedPart(SheetPart):
    """A part of the sheet with loops of its own to fold it by: ``loops``, ``(n, 2)`` mm each."""

    loops: tuple[Floats, ...]

    @cached_property
    def outline(self) -> Shape:
        """The loops as a shape, in the coordinates of the part."""
        polygons = shapely.polygons([shapely.linearrings(loop) for loop in self.loops])
        inside, around = shapely.STRtree(polygons).query(polygons, predicate="within")
        depth = np.bincount(inside, minlength=len(polygons))
        pairs = zip(inside.tolist(), around.tolist(), strict=True)
        parent = {one: other for one, other in pairs if depth[one] == depth[other] + 1}
        return Shape(self.loops, tuple(parent.get(number, -1) for number in range(len(polygons))))


@dataclass(frozen=True, eq=False)
class Half(LoopedPart):
    """A half or a quarter of the sheet, and loops to fold it by.

    ``axes`` are the axes that are folded first: 0 is the sheet's upright middle line, 1 the level one. ``sheet`` is the
    part to the right of the upright axis, above the level one, or both. ``loops``, ``(n, 2)`` mm each, are in the
    coordinates of that part; they run counter-clockwise, no two cross or touch, and they may reach beyond the border at
    the axes. On the part they agree with ``shape``, which is the whole shape, on the whole sheet.
    """

    loops: tuple[Floats, ...]
    sheet: Sheet
    axes: tuple[int, ...]

    @property
    def fold_count(self) -> int:
        """How many straight folds make the half or the quarter of the sheet."""
        return len(self.axes)

    @property
    def _middle(self) -> Floats:
        """The place of the part's lower left corner on the whole sheet, in mm."""
        return np.where(np.isin([0, 1], self.axes), [self.sheet.width, self.sheet.height], 0.0)

    @property
    def first_folds(self) -> tuple[Floats, ...]:
        """The axes as lines on the whole sheet, ``(2, 2)`` mm each, in the order in which they are folded."""
        width, height = self._middle.tolist()
        return axis_lines(Sheet(self.sheet.width + width, self.sheet.height + height), self.axes)

    def creased(self, creases: CreasePattern) -> Bools:
        """Return which edges of the half's pattern are creases of the whole: those on the axes are, too."""
        ends = np.abs(creases.vertices_coords[creases.edges_vertices]) <= self.tie
        on_axis = np.logical_and(ends[:, 0], ends[:, 1])[:, list(self.axes)].any(axis=1)
        return np.asarray((creases.edges_assignment != "B") | on_axis)

    @property
    def tie(self) -> float:
        """How near to an axis a vertex lies on it, in mm."""
        return 1e-9 * self.sheet.diagonal

    def unfold(self, creases: CreasePattern, folded: FoldedState) -> tuple[CreasePattern, FoldedState]:
        """Return the pattern of the whole sheet, from that of the half."""
        for axis in self.axes:
            creases, folded = _doubled(creases, folded, axis, self.tie)
        moved = points_array(creases.vertices_coords + self._middle)
        return CreasePattern(moved, creases.edges_vertices, creases.edges_assignment, creases.faces_vertices), folded

    def unfold_regions(self, regions: tuple[Region, ...]) -> tuple[Region, ...]:
        """Return the regions of the whole sheet: those of the half, each with its mirror images as outlines."""
        at = self._middle
        signs = [np.ones(2)]
        for axis in self.axes:
            signs += [sign * np.where(np.arange(2) == axis, -1.0, 1.0) for sign in signs]
        return tuple(
            Region(
                tuple(points_array(outline * sign + at) for outline in region.outlines for sign in signs), region.parent
            )
            for region in regions
        )


def axis_lines(sheet: Sheet, axes: Sequence[int]) -> tuple[Floats, ...]:
    """Return axes of a sheet as lines on it, ``(2, 2)`` mm each, in the order in which they are folded."""
    lines = []
    for axis in reversed(axes):
        line = np.array([(0.0, 0.0), (sheet.width, sheet.height)])
        line[:, axis] /= 2
        line[0, axis] = line[1, axis]
        lines.append(points_array(line))
    return tuple(lines)


def _doubled(creases: CreasePattern, folded: FoldedState, axis: int, tie: float) -> tuple[CreasePattern, FoldedState]:
    """Unfold a pattern about the axis on which this coordinate is 0; vertices nearer to it than ``tie`` are on it."""
    flat = creases.vertices_coords.copy()
    on_axis = np.abs(flat[:, axis]) <= tie
    flat[on_axis, axis] = 0.0
    image = np.where(on_axis, np.arange(len(flat)), len(flat) + np.cumsum(~on_axis) - 1)
    sign = np.where(np.arange(2) == axis, -1.0, 1.0)
    every = np.concatenate([flat, flat[~on_axis] * sign])
    landing = np.concatenate([folded.vertices_coords, folded.vertices_coords[~on_axis]])
    stack: list[list[int]] = []
    faces = creases.faces_vertices.to_lists()
    for number in folded.layers.tolist():
        face = faces[number]
        mirrored = image[face[::-1]].tolist()
        up = signed_area(folded.vertices_coords[face]) > 0
        stack += [mirrored, face] if up else [face, mirrored]
    edges, kinds = creases_of_stack(landing, stack)
    low, high = every.min(axis=0), every.max(axis=0)
    at_corner = ((np.abs(every - low) <= tie) | (np.abs(every - high) <= tie)).all(axis=1)
    return assemble(every, landing, stack, edges, kinds, set(np.flatnonzero(at_corner).tolist()))
