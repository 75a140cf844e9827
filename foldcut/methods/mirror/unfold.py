"""Unfold the pattern of a half or a quarter of the sheet to that of the whole sheet.

``Half``, and the pattern that folds it -> the whole pattern.

The sheet is folded along its axes first, so what folds the half folds all layers there at once: behind each face goes
its mirror image, on the side of its back. The order of layers is that of a folded sheet of double thickness, so nothing
needs to be shown about it. Mountains and valleys are read off the order, also along the axes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Bools, Floats, points_array
from foldcut.core.model import CreasePattern, FoldedState, Region, Sheet
from foldcut.geometry.vectors import signed_area
from foldcut.methods.sheet_part import SheetPart
from foldcut.pattern.assemble import assemble, creases_of_stack


@dataclass(frozen=True, eq=False)
class Half(SheetPart):
    """A half or a quarter of the sheet, and a loop to fold it by.

    ``axes`` are the axes that are folded first: 0 is the sheet's upright middle line, 1 the level one. ``sheet`` is the
    part to the right of the upright axis, above the level one, or both. ``loop`` ``(n, 2)`` mm, counter-clockwise, is
    in the coordinates of that part and reaches beyond its border at the axes. ``shape`` is the whole shape, on the
    whole sheet.
    """

    loop: Floats
    sheet: Sheet
    axes: tuple[int, ...]

    @property
    def first_folds(self) -> tuple[Floats, ...]:
        """The axes as lines on the whole sheet, ``(2, 2)`` mm each, in the order in which they are folded."""
        size = np.array([self.sheet.width, self.sheet.height]) * np.where(np.isin([0, 1], self.axes), 2.0, 1.0)
        lines = []
        for axis in reversed(self.axes):
            line = np.array([(0.0, 0.0), size])
            line[:, axis] = size[axis] / 2
            lines.append(points_array(line))
        return tuple(lines)

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
        size = np.array([self.sheet.width, self.sheet.height])
        at = np.zeros(2)
        for axis in self.axes:
            at[axis] = size[axis]
            creases, folded = _doubled(creases, folded, axis, self.tie)
        moved = points_array(creases.vertices_coords + at)
        return CreasePattern(moved, creases.edges_vertices, creases.edges_assignment, creases.faces_vertices), folded

    def unfold_regions(self, regions: tuple[Region, ...]) -> tuple[Region, ...]:
        """Return the regions of the whole sheet: those of the half, each with its mirror images as outlines."""
        at = np.where(np.isin([0, 1], self.axes), [self.sheet.width, self.sheet.height], 0.0)
        signs = [np.ones(2)]
        for axis in self.axes:
            signs += [sign * np.where(np.arange(2) == axis, -1.0, 1.0) for sign in signs]
        return tuple(
            Region(
                tuple(points_array(outline * sign + at) for outline in region.outlines for sign in signs), region.parent
            )
            for region in regions
        )


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
