"""The straight skeleton of the plane around a shape, from CGAL."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely

from foldcut.core.arrays import Floats, index_array
from foldcut.core.errors import UnfoldableError, needed_extra
from foldcut.core.model import Shape, Sheet
from foldcut.geometry.planar_graph import trace_faces
from foldcut.geometry.union_find import groups
from foldcut.geometry.vectors import left_normal

Edge = tuple[int, int]


Ring = list[int]


TIES = (1e-6, 1e-8, 1e-10)
"""Nodes that are so near to each other, relative to the sheet's diagonal, are one if that is exact enough."""


EXACT = 1e-11
"""How far, relative to the sheet's diagonal, a node's distances from its sides may differ."""


FRAME = 6.0
"""How far around the sheet the paper is taken to go on, in diagonals: so far that its border changes nothing on it."""


@dataclass(frozen=True, eq=False)
class Region:
    """What is nearest to one side of the shape: its skeleton face, in the side's own coordinates.

    ``u`` is the distance along the side from its start, ``h`` that from its line. ``ring`` are vertices, with the side
    below: ``lower`` and ``upper`` are chains of them from the least u to the greatest.
    """

    side: int
    sign: int  # 1 inside the shape, -1 outside
    ring: Ring
    lower: Ring
    upper: Ring


@dataclass(frozen=True, eq=False)
class Skeleton:
    """The straight skeleton of the plane around a shape.

    ``points`` ``(n, 2)`` mm; ``height`` ``(n,)`` the distance from the nearest sides; ``starts``, ``along`` ``(s, 2)``
    the sides' first corners and unit directions; ``base`` the sides' edges by side; ``regions``.
    """

    points: Floats
    height: Floats
    starts: Floats
    along: Floats
    regions: list[Region]
    base: dict[Edge, int]

    def u(self, side: int, vertex: int) -> float:
        """How far along a side a vertex is."""
        return float((self.points[vertex] - self.starts[side]) @ self.along[side])


def straight_skeleton(shape: Shape, sheet: Sheet) -> Skeleton:
    """Return the straight skeleton of all faces of a shape on its sheet, those of the paper far beyond it left out.

    Raises ``UnfoldableError`` without the extra, and where the skeleton cannot be had exactly.
    Source: Cacciola, 2D straight skeleton, in CGAL.
    """
    problem = ""
    for tie in TIES:
        try:
            return DrawnSkeleton(shape, sheet, tie).skeleton()
        except UnfoldableError as error:
            problem = problem or str(error)
    raise UnfoldableError(problem)


class DrawnSkeleton:
    """The skeleton's edges as CGAL gives them; nodes nearer to each other than ``tie`` diagonals are one."""

    def __init__(self, shape: Shape, sheet: Sheet, tie: float) -> None:
        self.diagonal = sheet.diagonal
        self.tie = tie * self.diagonal
        self.exact = EXACT * self.diagonal
        self.starts = np.concatenate(shape.loops)
        following = np.concatenate([np.roll(loop, -1, axis=0) for loop in shape.loops])
        self.count = len(self.starts)
        self.along = (following - self.starts) / np.hypot(*(following - self.starts).T)[:, None]
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
        """Return it with nodes moved onto the bisectors that meet there."""
        points, rings = self.faces()
        points, height = self._exact(points, rings)
        skeleton = Skeleton(points, height, self.starts, self.along, [], self.sides)
        for side, left, ring in rings:
            skeleton.regions.append(self._region(skeleton, side, left, ring))
        return skeleton

    def faces(self) -> tuple[Floats, list[tuple[int, bool, Ring]]]:
        """Return points, and each face's side, whether it is at the side's left, and its ring."""
        points, edges = self._joined()
        owned = self._owned(points, edges)
        owner = {pair: k for k, (_, ring) in enumerate(owned) for pair in zip(ring, ring[1:] + ring[:1], strict=True)}
        # behind a gap between sides on one line their faces are one; any edge may be drawn between them
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
        if sum(len(sides) for sides, _ in owned) != 2 * self.count or not all(
            sides and all(self._on_one_line(sides[0], side) for side in sides) for sides, _ in owned
        ):
            raise UnfoldableError("the straight skeleton is not complete; move a corner a little")
        return points, [(*sides[0], ring) for sides, ring in owned if sides]

    def _owned(self, points: Floats, edges: list[Edge]) -> list[tuple[list[tuple[int, bool]], Ring]]:
        """Return the sides, and whether it is at their left, and the ring of each face that is not the frame's."""
        owned = []
        for ring in trace_faces(points, index_array(edges)).to_lists():
            pairs = list(zip(ring, ring[1:] + ring[:1], strict=True))
            sides = [(self.sides[pair], True) for pair in pairs if pair in self.sides]
            sides += [(self.sides[b, a], False) for a, b in pairs if (b, a) in self.sides]
            if sides:
                owned.append((sides, ring))
        return owned

    def _on_one_line(self, one: tuple[int, bool], other: tuple[int, bool]) -> bool:
        """Whether two sides are on one line and have their faces on the same side of it."""
        (a, left), (b, other_left) = one, other
        away = np.abs(left_normal(self.along[a]) @ (self.starts[b] - self.starts[a]))
        turn = self.along[a] - (1 if left == other_left else -1) * self.along[b]
        return bool(away <= self.exact and np.hypot(*turn) <= 1e-9)

    def _joined(self) -> tuple[Floats, list[Edge]]:
        """Return points and edges, these at least as long as a tie, and none of them through a point or twice."""
        points = np.array(self.points)
        self.edges = _divided(points, self.edges, self.tie)
        ends = np.array(self.edges)
        short = ends[np.hypot(*(points[ends[:, 0]] - points[ends[:, 1]]).T) <= self.tie]
        first = groups(len(points), short.tolist())
        joined = {(min(first[a], first[b]), max(first[a], first[b])) for a, b in self.edges}
        kept = [(a, b) for a, b in sorted(joined) if a != b]
        if not joined >= {(min(side), max(side)) for side in self.sides}:
            raise UnfoldableError("the shape has a side that is too short for its straight skeleton")
        used = sorted({k for edge in kept for k in edge})
        place = {k: n for n, k in enumerate(used)}
        return points[used], [(place[a], place[b]) for a, b in kept]

    def _exact(self, points: Floats, rings: Sequence[tuple[int, bool, Ring]]) -> tuple[Floats, Floats]:
        """Return nodes moved to where they are equally far from all of their sides, and how far that is."""
        beside: dict[int, list[tuple[int, bool]]] = defaultdict(list)
        for side, left, ring in rings:
            for vertex in ring:
                beside[vertex].append((side, left))
        points, height = points.copy(), np.zeros(len(points))
        normal = left_normal(self.along)
        worst, at = 0.0, 0
        for vertex, around in beside.items():
            if vertex < self.count or len({side for side, _ in around}) < 2:
                continue
            number = [side for side, _ in around]
            turn = np.where([left for _, left in around], 1.0, -1.0)[:, None]
            rows = np.concatenate([turn * normal[number], -np.ones((len(number), 1))], axis=1)
            away = (turn * normal[number] * (points[vertex] - self.starts[number])).sum(axis=1)
            middle = float(away.mean())
            change = np.linalg.lstsq(rows, middle - away, rcond=1e-12)[0]
            points[vertex] += change[:2]
            height[vertex] = middle + change[2]
            off = float(np.abs(rows @ change + away - middle).max())
            if np.hypot(*(points[vertex] - self.starts[number[0]])) < 2 * self.diagonal and off > worst:
                worst, at = off, vertex
        if worst > self.exact:
            x, y = points[at]
            raise UnfoldableError(
                f"the straight skeleton is too fine near ({x:.4g}, {y:.4g}) mm; simplify the drawing there"
            )
        return points, height

    def _region(self, skeleton: Skeleton, side: int, left: bool, ring: Ring) -> Region:
        sign = 1 if left == self.inside_is_left[side] else -1
        ring = ring if left else ring[::-1]
        u = [skeleton.u(side, vertex) for vertex in ring]
        low, high = int(np.argmin(u)), int(np.argmax(u))
        lower = [ring[k % len(ring)] for k in range(low, high + 1 if high >= low else high + len(ring) + 1)]
        upper = [ring[k % len(ring)] for k in range(high, low + 1 if low >= high else low + len(ring) + 1)][::-1]
        return Region(side, sign, ring, lower, upper)


def _cgal_skeleton(outer: Floats, holes: Sequence[Floats]) -> tuple[Floats, list[Edge]]:
    """Return the points of a polygon with holes' straight skeleton, and its edges that are not sides."""
    try:
        # the compiled part by itself: the module around it takes 0.3 s to import, for graphs that are not needed here
        from compas_cgal import _straight_skeleton_2 as cgal
        from compas_cgal import _types_std  # noqa: F401  # what it returns
    except ImportError as error:
        raise UnfoldableError(needed_extra("straight skeletons", "skeleton")) from error
    if not shapely.Polygon(outer, holes).is_valid:  # CGAL's code does not survive it
        raise UnfoldableError("sides of the shape cross or touch, so it has no straight skeleton")
    flat = [np.column_stack([loop, np.zeros(len(loop))]) for loop in (outer, *holes)]
    try:
        points, numbers, edges, kinds = cgal.create_interior_straight_skeleton_with_holes(flat[0], flat[1:])
    except (RuntimeError, ValueError) as error:
        raise UnfoldableError(f"the straight skeleton cannot be computed: {error}") from error
    place = {number: k for k, number in enumerate(numbers)}
    ridges = [(place[a], place[b]) for (a, b), kind in zip(edges.tolist(), kinds, strict=True) if kind != 2]
    return points[:, :2], ridges


def _divided(points: Floats, edges: Sequence[Edge], tie: float) -> list[Edge]:
    """Divide edges at points that lie on them."""
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
