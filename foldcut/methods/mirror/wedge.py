"""Fold the sheet into a wedge along all mirror axes of a drawing that has several through one point.

``Shape`` with ``count`` axes on its sheet -> ``Wedge``: the paper of one sector, and what lies around it, to fold; its
pattern -> that of the whole sheet.

*The fan.* The axes divide the sheet into 2 ``count`` sectors. The sheet is folded in half along one axis, and what is
then a row of ``count`` sectors is folded again and again so that one sector less than half of them, or half, goes under
the others: through all layers each time, and so that the first sector stays on top. So 1 + log2(``count``) folds,
rounded up, make the wedge (six axes: in half, in half, in thirds). No fewer can, as a fold at most doubles the layers.

*The wedge.* All sectors fold alike, but the sheet is no disk: what each has of it differs. The wedge that is folded is
the convex hull of all of these on each other. Ridges and perpendiculars that come to its borders end there.

*Unfolding.* Each face has an image in every sector. In the fan these lie on each other, and this pile takes the place
of the face in the wedge's order of layers, turned over where the face is: the order of a folded sheet as thick as the
fan. Then all is cut off that is beyond the sheet. So nothing needs to be shown about the order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, index_array, points_array
from foldcut.core.errors import UnfoldableError
from foldcut.core.model import CreasePattern, FoldedState, Region, Shape, Sheet
from foldcut.geometry.convex_sheet import ConvexSheet
from foldcut.geometry.dihedral import sector_maps
from foldcut.geometry.vectors import signed_area
from foldcut.methods.mirror.unfold import Half, LoopedPart
from foldcut.pattern.crop import crop_stack
from foldcut.pattern.first_folds import axis_order, fan, fan_folds
from foldcut.pattern.foldability import crease_numbers

TIE = 1e-9
"""What is nearer than this to an axis lies on it, relative to the sheet's diagonal."""

GRID = 1e-11
"""Creases of different sectors are compared with places rounded to this, relative to the sheet's diagonal."""


@dataclass(frozen=True, eq=False)
class Wedge(LoopedPart):
    """A sector of the sheet, and loops to fold it by.

    ``shape`` is the whole shape on ``whole``, the whole sheet, symmetric about ``count`` axes through ``centre``
    ``(2,)`` mm; ``angle`` is the direction of the first of them in radians, and the sector lies counter-clockwise of
    it. ``loops``, ``(n, 2)`` mm each, are in the coordinates of ``sheet``; in it they agree with ``shape``.
    """

    loops: tuple[Floats, ...]
    whole: Sheet
    centre: Floats
    count: int
    angle: float

    @classmethod
    def of(cls, shape: Shape, whole: Sheet, centre: Floats, count: int, angle: float) -> Wedge:
        """Return a sector with all loops of the whole shape."""
        bare = cls(shape, (), whole, centre, count, angle)
        return replace(bare, loops=tuple(bare.in_sector(loop) for loop in shape.loops))

    @cached_property
    def sheet(self) -> ConvexSheet:
        """The sector: its tip at (0, 0), the first axis along x, as large as to cover the sheet's part in any sector.

        Raises ``UnfoldableError`` where the centre is not on the sheet.
        """
        tie = TIE * self.whole.diagonal
        if not (np.minimum(self.centre, [self.whole.width, self.whole.height] - self.centre) > tie).all():
            x, y = self.centre.tolist()
            raise UnfoldableError(f"the point where the mirror axes meet, ({x:.4g}, {y:.4g}) mm, is not on the sheet")
        step, far = math.pi / self.count, 2 * self.whole.diagonal
        sector = shapely.Polygon([(0, 0), (far, 0), (far * math.cos(step), far * math.sin(step))])
        paper = self.in_sector(self.whole.corners)
        parts = [
            shapely.intersection(shapely.Polygon(paper @ matrix.T), sector) for matrix in sector_maps(self.count, 0.0)
        ]
        hull = shapely.get_coordinates(shapely.MultiPolygon(parts).convex_hull)[:-1]
        hull = hull if signed_area(hull) > 0 else hull[::-1]
        return ConvexSheet.of(_tidied(self._on_borders(hull), tie))

    @property
    def borders(self) -> Floats:
        """The unit directions of both borders, ``(2, 2)``, in the coordinates of ``sheet``."""
        step = math.pi / self.count
        return np.array([(1.0, 0.0), (math.cos(step), math.sin(step))])

    @property
    def fold_count(self) -> int:
        """How many straight folds make the wedge."""
        return fan_folds(self.count)

    def creased(self, creases: CreasePattern) -> Bools:
        """Return which edges of the wedge's pattern are creases of the whole: those on its borders are, too."""
        first, last = self.on_border(creases.vertices_coords)
        ends = creases.edges_vertices
        return np.asarray((creases.edges_assignment != "B") | first[ends].all(axis=1) | last[ends].all(axis=1))

    def unfold(self, creases: CreasePattern, folded: FoldedState) -> tuple[CreasePattern, FoldedState]:
        """Return the pattern of the whole sheet, from that of the wedge."""
        count, sectors = len(creases.vertices_coords), 2 * self.count
        flat = self._on_borders(creases.vertices_coords)
        first, last = self.on_border(flat)
        number = np.arange(sectors)[:, None]
        # a vertex on a border has one image for two sectors: that of the one that is not a reflection
        owner = np.where(first, number + number % 2, np.where(last, number - number % 2, number)) % sectors
        owner = np.where(first & last, 0, owner)
        image = owner * count + np.arange(count)
        places = np.concatenate([flat @ matrix for matrix in sector_maps(self.count, 0.0)])
        landing = np.tile(folded.vertices_coords, (sectors, 1))
        faces = creases.faces_vertices.to_lists()
        pile = fan(self.count)
        stack: list[list[int]] = []
        for face in (faces[k] for k in folded.layers.tolist()):
            up = signed_area(folded.vertices_coords[face]) > 0
            stack += [
                image[sector, face if sector % 2 == 0 else face[::-1]].tolist()
                for sector in (pile[::-1] if up else pile)
            ]
        size = np.array([self.whole.width, self.whole.height])
        return crop_stack(self.on_whole(places), landing, stack, np.zeros(2), size)

    @property
    def named(self) -> str:
        """The wedge in words."""
        return f"a wedge of {180 / self.count:.4g} degrees"

    def with_outline(self, outline: Shape) -> Wedge:
        """Return the wedge for another shape with the same axes, given in the coordinates of ``sheet``."""
        shape = Shape(tuple(points_array(self.on_whole(loop)) for loop in outline.loops), outline.parent)
        return replace(self, shape=shape, loops=outline.loops)

    def unfold_regions(self, regions: tuple[Region, ...]) -> tuple[Region, ...]:
        """Return the regions of the whole sheet: those of the wedge, with their images in all sectors as outlines."""
        maps = sector_maps(self.count, 0.0)
        return tuple(
            Region(
                tuple(points_array(self.on_whole(outline @ one)) for outline in region.outlines for one in maps),
                region.parent,
            )
            for region in regions
        )

    @property
    def first_folds(self) -> tuple[Floats, ...]:
        """The axes as lines across the whole sheet, ``(2, 2)`` mm each, in the order in which they are creased."""
        lines = []
        sheet, far = shapely.Polygon(self.whole.corners), 2 * self.whole.diagonal
        for axis in axis_order(self.count):
            angle = self.angle + axis * math.pi / self.count
            along = np.array([math.cos(angle), math.sin(angle)])
            line = shapely.LineString([self.centre - far * along, self.centre + far * along])
            lines.append(points_array(shapely.get_coordinates(line.intersection(sheet))))
        return tuple(lines)

    def in_sector(self, points: Floats) -> Floats:
        """Return points of the whole sheet, ``(n, 2)`` mm, in the coordinates of ``sheet``."""
        cosine, sine = math.cos(self.angle), math.sin(self.angle)
        return points_array((points - self.centre) @ np.array([(cosine, -sine), (sine, cosine)]))

    def on_whole(self, points: Floats) -> Floats:
        """Return points in the coordinates of ``sheet``, ``(n, 2)`` mm, on the whole sheet."""
        cosine, sine = math.cos(self.angle), math.sin(self.angle)
        turned: Floats = points @ np.array([(cosine, sine), (-sine, cosine)])
        return turned + self.centre

    def in_wedge(self, segments: Floats) -> Floats:
        """Return segments of the whole sheet, ``(n, 2, 2)`` mm, as they lie in the wedge; none goes across an axis."""
        placed = self.in_sector(segments.reshape(-1, 2)).reshape(-1, 2, 2)
        x, y = placed.mean(axis=1).T
        sector = np.floor(np.arctan2(y, x) % math.tau / (math.pi / self.count)).astype(int) % (2 * self.count)
        back = sector_maps(self.count, 0.0).transpose(0, 2, 1)
        folded: Floats = np.einsum("nki,nij->nkj", placed, back[sector])
        return folded

    def on_border(self, points: Floats) -> tuple[Bools, Bools]:
        """Return which points in the wedge's coordinates lie on its first border, and which on its last."""
        x, y = points.T
        step, tie = math.pi / self.count, TIE * self.whole.diagonal
        return np.abs(y) <= tie, np.abs(y * math.cos(step) - x * math.sin(step)) <= tie

    def _on_borders(self, points: Floats) -> Floats:
        """Return points with those that lie on the wedge's borders exactly there."""
        first, last = self.on_border(points)
        step = math.pi / self.count
        away = np.hypot(*points.T)
        placed = points.copy()
        placed[first, 1] = 0.0
        placed[last] = away[last, None] * (math.cos(step), math.sin(step))
        placed[first & last] = 0.0
        return placed


Part = Half | Wedge
"""What is left of the sheet once its axes are folded."""


def wedge_lines(creases: CreasePattern, wedge: Wedge) -> int:
    """Return how many straight folds a pattern of the whole sheet has in the wedge, those on its borders left out.

    Creases of all sectors are laid on each other: one that is cut off by the sheet's edge is longer in another sector.
    """
    ends = wedge.in_wedge(creases.vertices_coords[creases.edges_vertices[creases.edges_assignment != "B"]])
    first, last = wedge.on_border(ends.reshape(-1, 2))
    inside = ~(first.reshape(-1, 2).all(axis=1) | last.reshape(-1, 2).all(axis=1))
    if not inside.any():
        return 0
    grid = GRID * wedge.whole.diagonal
    drawn = shapely.unary_union(shapely.linestrings(ends[inside]), grid_size=grid)
    pieces = [
        np.stack([line[:-1], line[1:]], axis=1) for line in map(shapely.get_coordinates, shapely.get_parts(drawn))
    ]
    points, edges = np.unique(np.concatenate(pieces).reshape(-1, 2), axis=0, return_inverse=True)
    pairs = index_array(edges.reshape(-1, 2))
    return crease_numbers(CreasePattern(points, pairs, np.full(len(pairs), "M"), creases.faces_vertices)).lines


def _tidied(outline: Floats, tie: float) -> Floats:
    """Return an outline without corners that are nearer to the one before than ``tie`` mm, or straight."""
    outline = outline[np.hypot(*(outline - np.roll(outline, 1, axis=0)).T) > tie]
    before, after = np.roll(outline, 1, axis=0), np.roll(outline, -1, axis=0)
    chord = after - before
    away = (outline[:, 0] - before[:, 0]) * chord[:, 1] - (outline[:, 1] - before[:, 1]) * chord[:, 0]
    kept: Floats = np.maximum(outline[np.abs(away) > tie * np.hypot(*chord.T)], 0.0)
    return kept
