"""A drawing on a sheet that is folded through all layers: what is left of the sheet, and where the sides lie.

``FoldedDrawing.fold`` -> the drawing after one more fold, or None where that fold would lay sides on blank paper.

Layers that lie on each other stay so from then on. So the one cut goes through all of them, and at every place either
all layers have a side of the drawing or none has. A fold is possible where what it lays on each other is alike: the
paper that is turned, on the paper where it comes to lie. Source: Demaine, Demaine, Hawksley, Ito, Loh, Manber and
Stephens, "Making Polygons by Simple Folds and One Straight Cut", LNCS 7033, 2011; there the sheet is a polygon, too.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from foldcut.core.arrays import Floats, Indices
from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.geometry.mirror_axes import ROUNDING
from foldcut.geometry.vectors import cross
from foldcut.methods.simple.lines import Line, line_of, merged_sides
from foldcut.pattern.cut_line import sides_of

__all__ = ["FoldedDrawing", "drawing_on", "filled"]

GRID = 1e-10
"""The outlines of paper are rounded to this part of the sheet's diagonal, so that pieces that touch are joined."""

MOST_OFF = 0.25
"""Corners may be off by no more than this part of a drawing's smaller side."""

QUARTER_CIRCLE = 2
"""The number of segments with which a quarter of a circle is drawn where outlines are shrunk."""


@dataclass(frozen=True, eq=False)
class FoldedDrawing:
    """A drawing on a sheet that is folded in part, as seen from above.

    ``paper``: what the sheet covers; ``inside``: the part of it that is inside the shape, in all layers. ``sides``
    ``(n, 2, 2)`` mm: where sides of the drawing lie, those of all layers joined; ``line`` ``(n,)``: the number of the
    straight line that each is on, and ``origins`` ``(n,)`` a side of the drawing that lies there. ``tie``: what is this
    near, in mm, counts as the same place; ``grid``: to how many mm outlines are rounded.
    """

    paper: BaseGeometry
    inside: BaseGeometry
    sides: Floats
    line: Indices
    origins: Indices
    tie: float
    grid: float

    @cached_property
    def line_count(self) -> int:
        """The number of straight lines on which sides lie; in the end it is 1."""
        return int(self.line.max()) + 1

    @cached_property
    def length(self) -> float:
        """How long all sides are together, in mm."""
        return float(np.hypot(*(self.sides[:, 1] - self.sides[:, 0]).T).sum())

    @cached_property
    def key(self) -> tuple[tuple[int, ...], ...]:
        """Where the sides lie, for comparisons: alike for drawings that are the same but for rounding errors."""
        ends = np.round(self.sides.reshape(-1, 4) / (4 * self.tie)).astype(np.int64)
        return (*sorted(map(tuple, ends.tolist())), (round(self.paper.area / max(1.0, self.length) / self.tie),))

    def fold(self, line: Line) -> FoldedDrawing | None:
        """Return the drawing after what lies to the right of a line has been turned over, None where it cannot be."""
        half = line.half_plane(4 * self.reach)
        staying, turned = (_common(self.paper, side, self.grid) for side in half)
        if staying.is_empty or turned.is_empty:
            return None
        inside, other = (_common(self.inside, side, self.grid) for side in half)
        turned, other = line.mirrored(turned), line.mirrored(other)
        both = _common(staying, turned, self.grid)
        differing = shapely.symmetric_difference(_common(inside, both, self.grid), _common(other, both, self.grid))
        if not shapely.buffer(differing, -self.tie, quad_segs=QUARTER_CIRCLE).is_empty:
            return None
        sides, origins = line.folded(self.sides, self.origins, self.tie)
        sides, numbers, origins = merged_sides(sides, origins, self.tie)
        return FoldedDrawing(
            _areas(shapely.union(staying, turned, grid_size=self.grid)),
            _areas(shapely.union(inside, other, grid_size=self.grid)),
            sides,
            numbers,
            origins,
            self.tie,
            self.grid,
        )

    @property
    def is_cut(self) -> bool:
        """Whether all sides lie on one line, and no other paper does."""
        if self.line_count > 1:
            return False
        cut = self.cut_line()
        ends = cut.origin + np.array([[-1.0], [1.0]]) * 4 * self.reach * cut.along
        on_paper = shapely.intersection(shapely.buffer(self.paper, -self.tie), shapely.LineString(ends))
        return bool(on_paper.length < self.length + 4 * self.tie * len(self.sides))

    @property
    def reach(self) -> float:
        """The diagonal of the rectangle around the paper, in mm."""
        return float(np.hypot(*np.ptp(np.reshape(self.paper.bounds, (2, 2)), axis=0)))

    def cut_line(self) -> Line:
        """Return the line of the longest side, with the inside of the shape to its left."""
        longest = self.sides[np.hypot(*(self.sides[:, 1] - self.sides[:, 0]).T).argmax()]
        cut = line_of(*longest)
        point = np.asarray(self.inside.representative_point().coords[0])
        return cut if cross(cut.along, point - cut.origin) > 0 else Line(cut.origin, -cut.along)


def _common(one: BaseGeometry, other: BaseGeometry, grid: float) -> BaseGeometry:
    """Return the area that two geometries have in common."""
    return _areas(shapely.intersection(one, other, grid_size=grid))


def _areas(geometry: BaseGeometry) -> BaseGeometry:
    """Return a geometry without its lines and points."""
    return shapely.MultiPolygon([part for part in shapely.get_parts(geometry) if isinstance(part, shapely.Polygon)])


def drawing_on(shape: Shape, sheet: Sheet, symmetry: float = 0.0) -> FoldedDrawing:
    """Return a shape on its sheet before the first fold; ``symmetry``: how far corners may be off, in mm.

    Raises UnfoldableError: that is much of the shape, whose sides would be nothing.
    """
    sides = sides_of(shape)
    tie = max(symmetry, ROUNDING * float(np.ptp(sides.reshape(-1, 2), axis=0).max()))
    least = float(np.ptp(sides.reshape(-1, 2), axis=0).min())
    if tie > MOST_OFF * least:
        raise UnfoldableError(
            f"--symmetry lets corners be {tie:.3g} mm off, too far where the drawing is {least:.3g} mm"
        )
    joined, line, origins = merged_sides(sides, np.arange(len(sides)), tie)
    return FoldedDrawing(
        shapely.Polygon(sheet.corners), filled(shape), joined, line, origins, tie, GRID * sheet.diagonal
    )


def filled(shape: Shape) -> BaseGeometry:
    """Return the area that is inside a shape."""
    area: BaseGeometry = shapely.Polygon()
    for loop in sorted(range(len(shape.loops)), key=shape.depth):
        area = area.symmetric_difference(shapely.Polygon(shape.loops[loop]))
    return area
