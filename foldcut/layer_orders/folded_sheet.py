"""A sheet that is folded flat, as geometry: which faces lie on each other, which creases coincide, what crosses what.

Crease pattern and its face maps -> a ``FoldedSheet``, which answers with pairs and rows of face numbers. All answers
depend on one tolerance. Coordinates of patterns are rounded, so points that should coincide when folded do not quite;
``tolerance_of`` looks how far apart points and lines are, and takes the widest gap between errors and real features.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, Indices, Ints, Numbers
from foldcut.core.model import CreasePattern
from foldcut.geometry.segments import collinear_overlap
from foldcut.pattern.face_maps import FaceMaps, folded_edges

__all__ = ["FoldedSheet", "tolerance_of"]

FINEST, COARSEST = 1e-12, 1e-3
"""Distances below the first are errors, distances above the second are features, relative to the diagonal."""

LONG = 6
"""Edges coincide if they overlap by at least this many tolerances; with less, they only end at the same point."""

TRIMMED = 3
"""How many tolerances are taken off each end of a crease before it is looked what it crosses."""

DIGITS = 9
"""Places are told with this many decimals at most."""

NEARLY_PARALLEL = 0.1
"""Edges whose unit directions have a larger cross product do not coincide, however short they are."""


class FoldedSheet:
    """The folded faces and inner edges of a pattern.

    ``beside`` ``(e, 2)`` are the faces left and right of each inner edge, ``edges`` its number in the pattern,
    ``ends`` ``(e, 2, 2)`` where it lands, ``folded`` whether it is a crease that folds. ``up`` ``(f,)``: whether a face
    shows the same side as face 0. What overlaps by less than ``tolerance``, in mm, only touches.
    """

    def __init__(self, pattern: CreasePattern, faces_of_edges: Ints, maps: FaceMaps, tolerance: float) -> None:
        self.pattern, self.up, self.tolerance = pattern, maps.up, tolerance
        self.count = len(pattern.faces_vertices)
        self.edges: Indices = np.flatnonzero((faces_of_edges >= 0).all(axis=1))
        self.beside = faces_of_edges[self.edges].astype(np.intp)
        self.folded: Bools = folded_edges(pattern)[self.edges]
        corners = pattern.vertices_coords[pattern.edges_vertices[self.edges]]
        self.ends = maps.apply(self.beside[:, :1], corners)
        outlines = pattern.faces_vertices
        self._places = maps.apply(outlines.rows, pattern.vertices_coords[outlines.values])
        rings = shapely.linearrings(self._places, indices=outlines.rows)
        self._inside = shapely.buffer(shapely.polygons(rings), -tolerance, join_style="mitre")
        shapely.prepare(self._inside)
        self._tree = shapely.STRtree(self._inside)
        self._shared: dict[int, shapely.Geometry] = {}

    @cached_property
    def overlapping(self) -> Indices:
        """The pairs of faces that lie on each other, ``(n, 2)``, the lesser one first."""
        one, other = self._tree.query(self._inside, predicate="intersects")
        once = one < other
        return np.stack([one[once], other[once]], axis=1)

    @cached_property
    def across(self) -> Indices:
        """Rows of an inner edge and a face that it runs across, ``(n, 2)``; edges by their place in ``edges``."""
        along = self.ends[:, 1] - self.ends[:, 0]
        length = np.hypot(*along.T)
        trim = (np.minimum(TRIMMED * self.tolerance, length / 3) / np.where(length > 0, length, 1))[:, None] * along
        lines = shapely.linestrings(np.stack([self.ends[:, 0] + trim, self.ends[:, 1] - trim], axis=1))
        edge, face = self._tree.query(lines, predicate="intersects")
        apart = (self.beside[edge] != face[:, None]).all(axis=1)
        return np.stack([edge[apart], face[apart]], axis=1)

    @cached_property
    def coinciding(self) -> tuple[Indices, Bools]:
        """Pairs of inner edges that coincide, ``(n, 2)``, and whether their left faces lie on the same side there."""
        low, high = self.ends.min(axis=1) - self.tolerance, self.ends.max(axis=1) + self.tolerance
        boxes = shapely.box(*low.T, *high.T)
        one, other = shapely.STRtree(boxes).query(boxes)
        once = one < other
        one, other = one[once], other[once]
        along = self.ends[:, 1] - self.ends[:, 0]
        along = along / np.maximum(np.hypot(*along.T), np.finfo(np.float64).tiny)[:, None]
        near = np.abs(along[one, 0] * along[other, 1] - along[one, 1] * along[other, 0]) < NEARLY_PARALLEL
        one, other = one[near], other[near]
        length, same_way = collinear_overlap(self.ends[one], self.ends[other], 2 * self.tolerance)
        left = self.up[self.beside[:, 0]]
        long = length > LONG * self.tolerance
        one, other, same_way = one[long], other[long], same_way[long]
        apart = (self.beside[one][:, :, None] != self.beside[other][:, None, :]).all(axis=(1, 2))
        aligned = (left[one] == left[other]) == same_way
        return np.stack([one[apart], other[apart]], axis=1), aligned[apart]

    def share_area(self, faces: Numbers) -> Bools:
        """Return for rows of three faces that overlap in pairs, ``(n, 3)`` ascending, whether one place is in all."""
        keys = faces[:, 0].astype(np.int64) * self.count + faces[:, 1]
        pairs, at = np.unique(keys, return_inverse=True)
        new = np.array([key for key in pairs.tolist() if key not in self._shared], dtype=np.int64)
        if len(new):
            one, other = np.divmod(new, self.count)
            both = shapely.intersection(self._inside[one], self._inside[other])
            shapely.prepare(both)
            self._shared.update(zip(new.tolist(), both, strict=True))
        both = np.array([self._shared[key] for key in pairs.tolist()], dtype=object)
        found: Bools = shapely.intersects(both[at], self._inside[faces[:, 2]])
        return found

    def middle_of(self, face: int) -> tuple[float, float]:
        """Return the middle of the corners of a face, on the sheet."""
        return self.point(self.pattern.vertices_coords[self.pattern.faces_vertices[face]].mean(axis=0))

    def point(self, place: Floats) -> tuple[float, float]:
        """Return a point of the sheet, ``(2,)``, without digits that mean nothing."""
        x, y = (np.round(place, DIGITS) + 0.0).tolist()
        return x, y


def tolerance_of(
    pattern: CreasePattern, faces_of_edges: Ints, maps: FaceMaps, error: float = 0.0
) -> tuple[float, float]:
    """Return the tolerance for a folded sheet, in mm, and how wide the gap is that it lies in: largest to smallest.

    Distances between folded vertices and edges are either errors of coordinates or features of the pattern. The
    tolerance is the middle, in ratios, of the widest gap between any two of them that follow each other, above the
    ``error`` that the coordinates are known to have, in mm.
    """
    coords, edges = pattern.vertices_coords, pattern.edges_vertices
    diagonal = float(np.hypot(*np.ptp(coords, axis=0)))
    face = np.zeros(len(coords), dtype=np.intp)
    face[pattern.faces_vertices.values] = pattern.faces_vertices.rows
    places = maps.apply(face, coords)
    ends = maps.apply(faces_of_edges.max(axis=1)[:, None], coords[edges])
    tree = shapely.STRtree(shapely.linestrings(ends))
    points = shapely.points(places)
    vertex, edge = tree.query(points, predicate="dwithin", distance=COARSEST * diagonal)
    away = shapely.distance(points[vertex], tree.geometries[edge]) / diagonal
    finest = max(FINEST, error / diagonal)
    steps = np.concatenate([[finest], np.sort(away[away > finest]), [max(COARSEST, 2 * finest)]])
    ratio = steps[1:] / steps[:-1]
    at = int(ratio.argmax())
    return float(np.sqrt(steps[at] * steps[at + 1])) * diagonal, float(ratio[at])
