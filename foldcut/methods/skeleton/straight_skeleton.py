"""The straight skeleton of the whole plane around a shape, computed by CGAL.

``Shape`` on its sheet -> ``Skeleton``.

Let each side of the shape move sideways at unit speed, to its left and to its right at once. These two wavefronts sweep
the whole plane, inside and outside the shape. What one side sweeps on one of its flanks is a *skeleton face*; two faces
meet along a *ridge*, which lies on the bisector of their sides; ridges meet in *nodes*, which are equally far from the
lines of all sides whose faces meet there.

CGAL takes polygons with holes, so it gets each face of the drawing by itself; the unbounded one is closed by a frame
far beyond the sheet. What it returns is drawn as one planar graph and taken apart into skeleton faces again.
Source: Cacciola, "2D Straight Skeleton and Polygon Offsetting", CGAL manual.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import shapely

from foldcut.core.arrays import Floats, index_array
from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.geometry.planar_graph import trace_faces
from foldcut.geometry.union_find import groups
from foldcut.geometry.vectors import left_normal

Edge = tuple[int, int]
"""Two vertices."""

Vertices = list[int]
"""The vertices around a face, or along a chain, in order."""

TIES = (1e-6, 1e-8, 1e-10)
"""Nodes closer to each other than this, relative to the sheet's diagonal, are joined; tried one after the other."""

EXACT = 1e-11
"""How much a node's distances from its sides may differ, relative to the sheet's diagonal."""

PARALLEL = 1e-9
"""How much the unit directions of two sides on one line may differ."""

FRAME = 6.0
"""How far from the middle of the sheet the frame is, in diagonals: too far to change anything on the sheet."""

FAR_AWAY = 2.0
"""Nodes farther than this from their side, in diagonals, need not be exact: no crease on the sheet depends on them."""

BOUNDARY_EDGE = 2
"""CGAL's kind of skeleton edges that are sides of the polygon."""


class Flank(NamedTuple):
    """One of the two flanks of a side: the one on its left, or the one on its right."""

    side: int
    left: bool


@dataclass(frozen=True, eq=False)
class SkeletonFace:
    """The skeleton face on one flank of a side, in the side's own coordinates.

    ``u`` is the distance along the side from its start, ``h`` the distance from its line. ``vertices`` go around with
    the side below: ``lower`` and ``upper`` are the chains of them from the least u to the greatest.
    """

    side: int
    sign: int  # 1 inside the shape, -1 outside
    vertices: Vertices
    lower: Vertices
    upper: Vertices


@dataclass(frozen=True, eq=False)
class Skeleton:
    """The straight skeleton of the plane around a shape.

    ``points`` ``(n, 2)`` mm; ``height`` ``(n,)`` mm, the distance from the nearest sides; ``starts`` ``(s, 2)`` mm and
    ``along`` ``(s, 2)``, the first corner and the unit direction of every side; ``faces``; ``base``, the number of the
    side that an edge is.
    """

    points: Floats
    height: Floats
    starts: Floats
    along: Floats
    faces: Sequence[SkeletonFace]
    base: dict[Edge, int]

    def u(self, side: int, vertex: int) -> float:
        """Return how far along a side a vertex is, in mm."""
        return float((self.points[vertex] - self.starts[side]) @ self.along[side])

    def is_side(self, edge: Edge) -> bool:
        """Return whether an edge, in either direction, is a side of the shape."""
        return edge in self.base or edge[::-1] in self.base


def straight_skeleton(shape: Shape, sheet: Sheet) -> Skeleton:
    """Return the straight skeleton of the plane around a shape on its sheet, as far as a frame far beyond the sheet.

    Raises ``UnfoldableError`` where CGAL's result is not exact enough.
    """
    problem = ""
    for tie in TIES:
        try:
            return RawSkeleton(shape, sheet, tie).skeleton()
        except UnfoldableError as error:
            problem = problem or str(error)
    raise UnfoldableError(problem)


class RawSkeleton:
    """The skeleton as CGAL draws it: points and edges, in which nodes less than ``tie`` diagonals apart are joined.

    The first ``count`` points are the shape's corners, in the order of its sides.
    """

    def __init__(self, shape: Shape, sheet: Sheet, tie: float) -> None:
        self.diagonal = sheet.diagonal
        self.tie = tie * self.diagonal
        self.exact = EXACT * self.diagonal
        self.starts = np.concatenate(shape.loops)
        following = np.concatenate([np.roll(loop, -1, axis=0) for loop in shape.loops])
        self.count = len(self.starts)
        length = np.hypot(*(following - self.starts).T)
        if not (length > 0).all():
            raise UnfoldableError("the shape has a side of no length, so it has no straight skeleton")
        self.along = (following - self.starts) / length[:, None]
        self.inside_is_left = np.concatenate(
            [[shape.depth(k) % 2 == 0] * len(loop) for k, loop in enumerate(shape.loops)]
        )
        first = np.cumsum([0, *(len(loop) for loop in shape.loops)])
        self.sides = {
            (int(a + k), int(a + (k + 1) % (b - a))): int(a + k) for a, b in pairwise(first) for k in range(b - a)
        }
        middle, half = np.array([sheet.width, sheet.height]) / 2, FRAME * self.diagonal
        frame = middle + half * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
        self.points = [*self.starts]
        self.edges: list[Edge] = list(self.sides)
        for outer in (-1, *range(len(shape.loops))):
            holes = [shape.loops[k][::-1] for k, above in enumerate(shape.parent) if above == outer]
            self._add(frame if outer < 0 else shape.loops[outer], holes)

    def _add(self, outer: Floats, holes: Sequence[Floats]) -> None:
        """Add CGAL's skeleton of one face of the drawing; its corners are known already."""
        points, edges = _cgal_skeleton(outer, holes)
        known = {tuple(point): k for k, point in enumerate(self.starts.tolist())}
        numbers = []
        for point in points:
            number = known.get(tuple(point.tolist()))
            if number is None:
                number = len(self.points)
                self.points.append(point)
            numbers.append(number)
        self.edges += [(numbers[a], numbers[b]) for a, b in edges]

    def skeleton(self) -> Skeleton:
        """Return the skeleton with every node moved onto the bisectors that meet there.

        Raises ``UnfoldableError`` where a face is missing, or where that cannot be done exactly enough.
        """
        points, faces = self.faces()
        points, height = self._exact(points, faces)
        bare = Skeleton(points, height, self.starts, self.along, (), self.sides)
        return replace(bare, faces=[self._face(bare, flank, vertices) for flank, vertices in faces])

    def faces(self) -> tuple[Floats, list[tuple[Flank, Vertices]]]:
        """Return the points ``(n, 2)``, and for each skeleton face its flank and its vertices, counter-clockwise.

        Sides on one line with no corner between them share a face, which gets the flank of the first. Raises
        ``UnfoldableError`` where a flank has no face.
        """
        points, edges = self._joined()
        owned = self._owned(points, edges)
        owner = {pair: k for k, (_, face) in enumerate(owned) for pair in half_edges(face)}
        # behind the gap between two sides on one line their faces are one, and CGAL may draw any edge there
        needless = {
            (a, b)
            for a, b in edges
            if (a, b) in owner
            and (b, a) in owner
            and owner[a, b] != owner[b, a]
            and self._on_one_line(owned[owner[a, b]][0][0], owned[owner[b, a]][0][0])
        }
        if needless:
            owned = self._owned(points, [edge for edge in edges if edge not in needless])
        if sum(len(flanks) for flanks, _ in owned) != 2 * self.count or not all(
            self._on_one_line(flanks[0], flank) for flanks, _ in owned for flank in flanks
        ):
            raise UnfoldableError("the straight skeleton is incomplete; move a corner of the drawing a little")
        return points, [(flanks[0], face) for flanks, face in owned]

    def _owned(self, points: Floats, edges: list[Edge]) -> list[tuple[list[Flank], Vertices]]:
        """Return the flanks and the vertices of every face that borders on a side: of all but the frame's outside."""
        owned = []
        for face in trace_faces(points, index_array(edges)).to_lists():
            pairs = half_edges(face)
            flanks = [Flank(self.sides[pair], True) for pair in pairs if pair in self.sides]
            flanks += [Flank(self.sides[b, a], False) for a, b in pairs if (b, a) in self.sides]
            if flanks:
                owned.append((flanks, face))
        return owned

    def _on_one_line(self, one: Flank, other: Flank) -> bool:
        """Return whether two sides lie on one line, with these flanks on the same side of it."""
        a, b = one.side, other.side
        away = np.abs(left_normal(self.along[a]) @ (self.starts[b] - self.starts[a]))
        turn = self.along[a] - (1 if one.left == other.left else -1) * self.along[b]
        return bool(away <= self.exact and np.hypot(*turn) <= PARALLEL)

    def _joined(self) -> tuple[Floats, list[Edge]]:
        """Return points and edges, none of these shorter than the tie, through another point, or there twice."""
        points = np.array(self.points)
        edges = _divided(points, self.edges, self.tie)
        ends = np.array(edges)
        short = ends[np.hypot(*(points[ends[:, 0]] - points[ends[:, 1]]).T) <= self.tie]
        first = groups(len(points), short.tolist())
        joined = {(min(first[a], first[b]), max(first[a], first[b])) for a, b in edges}
        kept = [(a, b) for a, b in sorted(joined) if a != b]
        if not joined >= {(min(side), max(side)) for side in self.sides}:
            raise UnfoldableError("the shape has a side that is too short for its straight skeleton")
        used = sorted({k for edge in kept for k in edge})
        place = {k: n for n, k in enumerate(used)}
        return points[used], [(place[a], place[b]) for a, b in kept]

    def _exact(self, points: Floats, faces: Sequence[tuple[Flank, Vertices]]) -> tuple[Floats, Floats]:
        """Return the points, with nodes moved to where they are equally far from all their sides, and how far that is.

        Raises ``UnfoldableError`` with the worst node where there is no such place.
        """
        flanks: dict[int, list[Flank]] = defaultdict(list)
        for flank, vertices in faces:
            for vertex in vertices:
                flanks[vertex].append(flank)
        points, height = points.copy(), np.zeros(len(points))
        worst, at = 0.0, 0
        for vertex, around in flanks.items():
            if vertex < self.count or len({flank.side for flank in around}) < 2:
                continue
            points[vertex], height[vertex], off = self._equidistant(points[vertex], around)
            away = np.hypot(*(points[vertex] - self.starts[around[0].side]))
            if away < FAR_AWAY * self.diagonal and off > worst:
                worst, at = off, vertex
        if worst > self.exact:
            x, y = points[at]
            raise UnfoldableError(
                f"the straight skeleton is too fine near ({x:.4g}, {y:.4g}) mm; simplify the drawing there"
            )
        return points, height

    def _equidistant(self, point: Floats, flanks: Sequence[Flank]) -> tuple[Floats, float, float]:
        """Return the place near a point that is equally far from sides, by least squares, how far, and the error."""
        sides = [flank.side for flank in flanks]
        turn = np.where([flank.left for flank in flanks], 1.0, -1.0)[:, None]
        inward = turn * left_normal(self.along[sides])
        rows = np.concatenate([inward, -np.ones((len(sides), 1))], axis=1)
        away = (inward * (point - self.starts[sides])).sum(axis=1)
        middle = float(away.mean())
        change = np.linalg.lstsq(rows, middle - away, rcond=1e-12)[0]
        off = float(np.abs(rows @ change + away - middle).max())
        return point + change[:2], middle + change[2], off

    def _face(self, skeleton: Skeleton, flank: Flank, vertices: Vertices) -> SkeletonFace:
        sign = 1 if flank.left == self.inside_is_left[flank.side] else -1
        vertices = vertices if flank.left else vertices[::-1]
        u = [skeleton.u(flank.side, vertex) for vertex in vertices]
        low, high = int(np.argmin(u)), int(np.argmax(u))
        lower, upper = _way(vertices, low, high), _way(vertices, high, low)[::-1]
        return SkeletonFace(flank.side, sign, vertices, lower, upper)


def half_edges(vertices: Vertices) -> list[Edge]:
    """Return the directed edges around a face."""
    return list(zip(vertices, vertices[1:] + vertices[:1], strict=True))


def _way(vertices: Vertices, first: int, last: int) -> Vertices:
    """Return the vertices from one place in a closed row on to another, both included."""
    count = len(vertices)
    return [vertices[k % count] for k in range(first, last + 1 if last >= first else last + count + 1)]


def _cgal_skeleton(outer: Floats, holes: Sequence[Floats]) -> tuple[Floats, list[Edge]]:
    """Return the points and the ridges of the straight skeleton of a polygon with holes."""
    # only the compiled part: the module around it takes 0.3 s to import, for graphs that are not needed here
    from compas_cgal import _straight_skeleton_2 as cgal
    from compas_cgal import _types_std  # noqa: F401  # the types that it returns

    if not shapely.Polygon(outer, holes).is_valid:  # CGAL may crash on it
        raise UnfoldableError("sides of the shape cross or touch, so it has no straight skeleton")
    flat = [np.column_stack([loop, np.zeros(len(loop))]) for loop in (outer, *holes)]
    try:
        points, numbers, edges, kinds = cgal.create_interior_straight_skeleton_with_holes(flat[0], flat[1:])
    except (RuntimeError, ValueError) as error:
        raise UnfoldableError(f"the straight skeleton cannot be computed: {error}") from error
    if not np.isfinite(points).all():
        raise UnfoldableError("the straight skeleton cannot be computed: it has a node at infinity")
    place = {number: k for k, number in enumerate(numbers)}
    ridges = [(place[a], place[b]) for (a, b), kind in zip(edges.tolist(), kinds, strict=True) if kind != BOUNDARY_EDGE]
    return points[:, :2], ridges


def _divided(points: Floats, edges: Sequence[Edge], tie: float) -> list[Edge]:
    """Divide edges at the points that lie on them, or no farther away than the tie."""
    lines = shapely.linestrings(points[np.array(edges)])
    point, line = shapely.STRtree(lines).query(shapely.points(points), predicate="dwithin", distance=tie)
    on: dict[int, list[int]] = defaultdict(list)
    for vertex, number in zip(point.tolist(), line.tolist(), strict=True):
        if vertex not in edges[number]:
            on[number].append(vertex)
    divided: list[Edge] = []
    for number, (a, b) in enumerate(edges):
        step = points[b] - points[a]
        way = sorted(on[number], key=lambda vertex: float((points[vertex] - points[a]) @ step))
        divided += pairwise([a, *way, b])
    return divided
