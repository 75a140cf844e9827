"""The straight skeleton of the plane around a shape, in the form that creases need: its faces, seen from their sides.

``Shape`` on its sheet -> ``Skeleton``.

The shape's loops and a frame far beyond the sheet are given to ``foldcut.geometry.straight_skeleton``. What one side
sweeps on one of its flanks is a *skeleton face*; two faces meet along a *ridge*, which lies on the bisector of their
sides; ridges meet in *nodes*, which are equally far from the lines of all sides whose faces meet there. Here two things
are done to that:

- Nodes that would be one if the drawing had no rounding errors are joined. Otherwise each such gap would get creases.
- Two sides on one line, whose wavefronts have become one behind the gap between them, share a face: paper that is
  swept by either of them is folded in the same way, so there is no ridge between.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from foldcut.core.arrays import Bools, Floats, Numbers
from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.drawing.graph import edges_of
from foldcut.geometry.straight_skeleton import StraightSkeleton, straight_skeleton
from foldcut.geometry.union_find import groups
from foldcut.geometry.vectors import left_normal
from foldcut.pattern.cut_line import contains

Edge = tuple[int, int]
"""Two vertices."""

Vertices = list[int]
"""The vertices around a face, or along a chain, in order."""

NEAR = 1e-6
"""The ends of ridges shorter than this, relative to the sheet's diagonal, are joined where that is exact enough."""

EXACT = 1e-11
"""How much a joined node's distances from its sides may differ, relative to the sheet's diagonal."""

PARALLEL = 1e-9
"""How much the unit directions of two sides on one line may differ."""

FRAME = 6.0
"""How far from the middle of the sheet the frame is, in diagonals: too far to change anything on the sheet."""


class Flank(NamedTuple):
    """One of the two flanks of a side: the one on its left, or the one on its right."""

    side: int
    left: bool


@dataclass(frozen=True, eq=False)
class SkeletonFace:
    """The skeleton face on one flank of a side, in the side's own coordinates.

    ``flanks`` are its own and those of the sides on the same line that share the face.
    ``u`` is the distance along the side from its start, ``h`` the distance from its line. ``vertices`` go around with
    the side below: ``lower`` and ``upper`` are the chains of them from the least u to the greatest. ``sign`` is 1
    inside the shape, -1 outside.
    """

    flanks: tuple[Flank, ...]
    sign: int
    vertices: Vertices
    lower: Vertices
    upper: Vertices

    @property
    def flank(self) -> Flank:
        """The flank whose face it is; where sides on one line share it, that of the first of them."""
        return self.flanks[0]

    @property
    def side(self) -> int:
        """The side of that flank."""
        return self.flank.side


@dataclass(frozen=True, eq=False)
class Skeleton:
    """The straight skeleton of the plane around a shape.

    ``points`` ``(n, 2)`` mm, the shape's corners first, in the order of its sides; ``height`` ``(n,)`` mm, the distance
    from the nearest sides; ``starts`` ``(s, 2)`` mm and ``along`` ``(s, 2)``, the first corner and the unit direction
    of every side; ``faces``; ``base``, the number of the side that an edge is. Of a graph, ``folded`` are the sides
    that are creases, in both directions; each dead end adds a side without length, square to the edge that ends there.
    ``is_graph``: corners cannot be moved.
    """

    points: Floats
    height: Floats
    starts: Floats
    along: Floats
    faces: Sequence[SkeletonFace]
    base: Mapping[Edge, int]
    folded: frozenset[Edge] = frozenset()
    is_graph: bool = False

    def u(self, side: int, vertex: int) -> float:
        """Return how far along a side a vertex is, in mm."""
        return float((self.points[vertex] - self.starts[side]) @ self.along[side])

    def is_side(self, edge: Edge) -> bool:
        """Return whether an edge, in either direction, is a side of the shape that is not folded."""
        return (edge in self.base or edge[::-1] in self.base) and edge not in self.folded

    @cached_property
    def flanks_at(self) -> Mapping[int, frozenset[Flank]]:
        """The flanks of the faces around each vertex."""
        around: dict[int, set[Flank]] = defaultdict(set)
        for face in self.faces:
            for vertex in face.vertices:
                around[vertex] |= {*face.flanks}
        return {vertex: frozenset(flanks) for vertex, flanks in around.items()}


@lru_cache(maxsize=32)  # drawings are looked at several times
def skeleton_of(shape: Shape, sheet: Sheet) -> Skeleton:
    """Return the straight skeleton of the plane around a shape on its sheet, as far as a frame far beyond the sheet.

    Raises ``UnfoldableError`` where sides of the shape cross or touch.
    """
    if shape.is_graph:
        return _skeleton_of_graph(shape, sheet)
    starts = np.concatenate(shape.loops)
    count = len(starts)
    first = np.cumsum([0, *(len(loop) for loop in shape.loops)]).tolist()
    edges = [(a + k, a + (k + 1) % (b - a)) for a, b in pairwise([*first, count + 4]) for k in range(b - a)]
    plane = _plane(starts, edges, sheet)
    points, height, outlines = _exact(plane, sheet)
    inside_is_left = np.repeat([shape.depth(k) % 2 == 0 for k in range(len(shape.loops))], np.diff(first))
    base = {edge: number for number, edge in enumerate(edges[:count])}
    bare = Skeleton(points, height, starts, plane.graph.side_along[: 2 * count : 2], (), base)
    faces = []
    for sides, outline in outlines:
        flanks = tuple(Flank(side // 2, side % 2 == 0) for side in sides)
        if flanks[0].side < count:
            sign = 1 if flanks[0].left == inside_is_left[flanks[0].side] else -1
            faces.append(_face(bare, flanks, sign, outline))
    return replace(bare, faces=faces)


def _skeleton_of_graph(shape: Shape, sheet: Sheet) -> Skeleton:
    """Return the same for a graph: every side has its own two flanks, and what is inside is found by looking there."""
    graph = edges_of(shape)
    count = len(graph.edges)
    frame = [(len(graph.points) + k, len(graph.points) + (k + 1) % 4) for k in range(4)]
    plane = _plane(graph.points, [*graph.edges, *frame], sheet)
    points, height, outlines = _exact(plane, sheet)
    caps_from = 2 * (count + len(frame))
    places = np.concatenate([np.arange(0, 2 * count, 2), np.arange(caps_from, plane.graph.side_count)])
    base = {edge: number for number, edge in enumerate(graph.edges)}
    folded = frozenset(edge for a, b in graph.folded for edge in ((a, b), (b, a)))
    starts, along = plane.graph.side_start[places], plane.graph.side_along[places]
    bare = Skeleton(points, height, starts, along, (), base, folded, is_graph=True)
    inside = _regions_inside(plane, shape, sheet)
    faces = []
    for sides, outline in outlines:
        of_edges, of_caps = ([k for k in sides if k < 2 * count], [k for k in sides if k >= caps_from])
        if not of_edges and not of_caps:
            continue  # of the frame
        flanks = (
            *(Flank(side // 2, side % 2 == 0) for side in of_edges),
            *(Flank(count + side - caps_from, True) for side in of_caps),
        )
        faces.append(_face(bare, flanks, 1 if inside[plane.graph.side_region[sides[0]]] else -1, outline))
    return replace(bare, faces=faces)


def _regions_inside(plane: StraightSkeleton, shape: Shape, sheet: Sheet) -> Bools:
    """Return which faces of the plane are inside the shape: a point beside a long side of each tells."""
    graph = plane.graph
    length = np.hypot(*(graph.points[graph.head] - graph.points[graph.tail]).T)
    order = np.argsort(length, kind="stable")
    longest = np.zeros(int(graph.side_region.max()) + 1, dtype=np.intp)
    longest[graph.side_region[order]] = order
    middles = (graph.points[graph.tail[longest]] + graph.points[graph.head[longest]]) / 2
    return contains(shape, middles + NEAR * sheet.diagonal * left_normal(graph.side_along[longest]))


def _plane(points: Floats, edges: Sequence[Edge], sheet: Sheet) -> StraightSkeleton:
    """Return the straight skeleton of edges between points and of a frame, whose edges are the last four."""
    middle, half = np.array([sheet.width, sheet.height]) / 2, FRAME * sheet.diagonal
    frame = middle + half * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    try:
        return straight_skeleton(np.concatenate([points, frame]), np.array(edges))
    except ValueError as error:
        raise UnfoldableError(f"the shape has no straight skeleton: {error}") from error


def _exact(plane: StraightSkeleton, sheet: Sheet) -> tuple[Floats, Floats, list[tuple[list[int], Vertices]]]:
    """Return the points and their heights with near ones joined, and the outlines of the faces."""
    near, exact = NEAR * sheet.diagonal, EXACT * sheet.diagonal
    points, height, joined = _joined(plane, near, exact)
    return points, height, _outlines(plane, _faces(plane, points, height, joined, near, exact), exact)


def _joined(plane: StraightSkeleton, near: float, exact: float) -> tuple[Floats, Floats, Numbers]:
    """Join the ends of short arcs, the shortest first, as far as there is a place equally far from all their sides.

    Returns points ``(k, 2)``, their heights ``(k,)``, and the number of the point that each node has become ``(k,)``.
    """
    points, height = plane.nodes.copy(), plane.time.copy()
    corners = len(plane.graph.points)
    arcs = plane.arcs[(plane.arcs >= corners).all(axis=1)]
    length = np.hypot(*(points[arcs[:, 0]] - points[arcs[:, 1]]).T)
    short = arcs[np.argsort(length, kind="stable")][: np.count_nonzero(length <= near)].tolist()
    members = {node: [node] for pair in short for node in pair}
    for one, other in short:
        together = sorted({*members[one], *members[other]})
        place = _equidistant(plane, points[together[0]], together, exact)
        if place is not None:
            points[together], height[together] = place[:2], place[2]
            members.update(dict.fromkeys(together, together))
    joined = np.arange(len(points))
    for node, together in members.items():
        joined[node] = together[0]
    return points, height, joined


def _equidistant(plane: StraightSkeleton, point: Floats, nodes: Vertices, exact: float) -> Floats | None:
    """Return the place near a point that is equally far from all sides of some nodes, and how far, ``(3,)``.

    It is the one with the least squares of errors; None where an error is more than ``exact``.
    """
    sides = sorted({side for node in nodes for side in plane.node_sides(node)})
    rows = np.column_stack([left_normal(plane.graph.side_along[sides]), -np.ones(len(sides))])
    away = _distances(plane, point, sides)
    middle = away.mean()
    change = np.linalg.lstsq(rows, middle - away, rcond=1e-12)[0]
    if np.abs(rows @ change + away - middle).max() > exact:
        return None
    place: Floats = np.array([*point, middle]) + change
    return place


def _distances(plane: StraightSkeleton, point: Floats, sides: Sequence[int]) -> Floats:
    """Return how far a point is from the lines of some sides, on their left, ``(s,)``."""
    away: Floats = (left_normal(plane.graph.side_along[sides]) * (point - plane.graph.side_start[sides])).sum(axis=1)
    return away


def _faces(
    plane: StraightSkeleton, points: Floats, height: Floats, joined: Numbers, near: float, exact: float
) -> dict[int, Vertices]:
    """Return the vertices of the face of every side within the frame, counter-clockwise.

    Where a node lies on an arc, the arc is divided: a part of a face that is no wider than rounding errors then goes to
    and fro along one line. Such parts arise between sides that are on one line except for rounding errors.
    """
    inside = [side for side in range(len(plane.graph.side_along)) if plane.face(side).min() >= 0]
    faces = {side: [a for a, b in half_edges(joined[plane.face(side)].tolist()) if a != b] for side in inside}
    finite = (plane.arcs >= 0).all(axis=1)
    ends, sides = joined[plane.arcs[finite]], plane.arc_sides[finite]
    nodes = np.unique(ends[ends >= len(plane.graph.points)])
    start, step = points[ends[:, 0]], points[ends[:, 1]] - points[ends[:, 0]]
    away = points[nodes] - start[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):  # the arcs whose ends are joined
        part = (away * step[:, None]).sum(axis=-1) / (step**2).sum(axis=-1)[:, None]
    apart = np.hypot(*(away - part[..., None] * step[:, None]).transpose(2, 0, 1))
    on: dict[Edge, list[tuple[float, int]]] = defaultdict(list)
    for arc, k in np.argwhere((part > 0) & (part < 1) & (apart < near)).tolist():
        if (
            nodes[k] not in ends[arc]
            and np.abs(_distances(plane, points[nodes[k]], sides[arc]) - height[nodes[k]]).max() <= exact
        ):
            a, b = ends[arc].tolist()
            on[a, b].append((float(part[arc, k]), int(nodes[k])))
            on[b, a].append((1 - float(part[arc, k]), int(nodes[k])))
    return {
        side: [vertex for pair in half_edges(face) for vertex in (pair[0], *(node for _, node in sorted(on[pair])))]
        for side, face in faces.items()
    }


def _outlines(plane: StraightSkeleton, faces: Mapping[int, Vertices], exact: float) -> list[tuple[list[int], Vertices]]:
    """Return the sides whose face it is and the vertices, counter-clockwise, of each face.

    Sides on one line whose faces border on each other share a face. A node in which no more than two faces meet, since
    others share one, lies on a straight ridge and is left out.
    """
    owner = {pair: side for side, face in faces.items() for part in outlines_of([face]) for pair in half_edges(part)}
    bordering = [(side, owner[b, a]) for (a, b), side in owner.items() if (b, a) in owner]
    one, other = np.array(bordering).T
    along, start = plane.graph.side_along, plane.graph.side_start
    turn = np.hypot(*(along[one] - along[other]).T)
    away = (left_normal(along[one]) * (start[other] - start[one])).sum(axis=1)
    same = np.column_stack([one, other])[(turn <= PARALLEL) & (np.abs(away) <= exact)]
    first = groups(len(along), same.tolist())
    sharing: dict[int, list[int]] = defaultdict(list)
    for side in faces:
        sharing[first[side]].append(side)
    outlines = [
        (sides, outline) for sides in sharing.values() for outline in outlines_of([faces[side] for side in sides])
    ]
    meeting = Counter(vertex for _, outline in outlines for vertex in outline)
    corners = len(plane.graph.points)
    return [(sides, [v for v in outline if v < corners or meeting[v] > 2]) for sides, outline in outlines]


def outlines_of(faces: Sequence[Vertices]) -> list[Vertices]:
    """Return the vertices around faces that border on each other, counter-clockwise, without what is between them.

    There are several outlines where a face comes to itself, since nodes of it have been joined.
    """
    pairs = dict.fromkeys((a, b) for face in faces for a, b in half_edges(face) if a != b)
    following: dict[int, list[int]] = defaultdict(list)
    for a, b in pairs:
        if (b, a) not in pairs:
            following[a].append(b)
    outlines = []
    for start in list(following):
        way = [start]
        while following[way[-1]]:
            vertex = following[way[-1]].pop()
            if vertex in way:
                first = way.index(vertex)
                outlines.append(way[first:])
                del way[first + 1 :]
            else:
                way.append(vertex)
    return outlines


def _face(skeleton: Skeleton, flanks: tuple[Flank, ...], sign: int, vertices: Vertices) -> SkeletonFace:
    """Return a face whose vertices are given counter-clockwise."""
    side, left = flanks[0]
    vertices = vertices if left else vertices[::-1]
    u = [skeleton.u(side, vertex) for vertex in vertices]
    low, high = int(np.argmin(u)), int(np.argmax(u))
    return SkeletonFace(flanks, sign, vertices, _way(vertices, low, high), _way(vertices, high, low)[::-1])


def half_edges(vertices: Vertices) -> list[Edge]:
    """Return the directed edges around a face."""
    return list(zip(vertices, vertices[1:] + vertices[:1], strict=True))


def _way(vertices: Vertices, first: int, last: int) -> Vertices:
    """Return the vertices from one place in a closed row on to another, both included."""
    count = len(vertices)
    return [vertices[k % count] for k in range(first, last + 1 if last >= first else last + count + 1)]
