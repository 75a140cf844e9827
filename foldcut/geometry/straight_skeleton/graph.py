"""The planar graph whose straight skeleton is made, and its sides.

Points and edges -> ``Graph``. The edges are straight and meet at their ends only; nothing else is asked of them: loops,
holes, islands, open paths, single edges, and points with any number of edges.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import ArrayLike

from foldcut.core.arrays import Floats, Indices, sealed
from foldcut.geometry.planar_graph import following_half_edges
from foldcut.geometry.union_find import groups

__all__ = ["Graph", "graph_of"]


@dataclass(frozen=True, eq=False)
class Graph:
    """A planar graph, and its sides.

    ``points`` ``(n, 2)``; ``edges`` ``(m, 2)``. A *side* is one of the two flanks of an edge: side 2k runs along edge k
    with its region on the left, side 2k + 1 against it, again with its region on the left. After these come the *caps*,
    one for each point with a single edge: a side of no length, square to the edge, from which the wavefront of the dead
    end starts. ``tail``, ``head`` ``(s,)``: the points where a side starts and ends. ``following`` ``(s,)``: the side
    that goes on at its head, around the same region. ``source`` ``(s,)``: the side itself, and for a cap the one that
    arrives at it.
    """

    points: Floats
    edges: Indices
    tail: Indices
    head: Indices
    following: Indices
    source: Indices

    @property
    def side_count(self) -> int:
        """How many sides there are, caps included."""
        return len(self.tail)

    @cached_property
    def side_start(self) -> Floats:
        """Where each side starts, ``(s, 2)``."""
        return sealed(self.points[self.tail])

    @cached_property
    def side_along(self) -> Floats:
        """The unit direction of each side, ``(s, 2)``."""
        along = self.points[self.head[self.source]] - self.points[self.tail[self.source]]
        along /= np.sqrt((along * along).sum(axis=1))[:, None]
        caps = self.source != np.arange(self.side_count)
        along[caps] = np.stack([along[caps, 1], -along[caps, 0]], axis=1)
        return sealed(along)

    @cached_property
    def side_edge(self) -> Indices:
        """The edge of each side, ``(s,)``; -1 for caps."""
        numbers = np.arange(self.side_count)
        return sealed(np.where(self.source == numbers, numbers // 2, -1))

    @cached_property
    def side_contour(self) -> Indices:
        """Which closed walk of sides each side belongs to, ``(s,)``; the walks are numbered by their first sides."""
        contour = [-1] * self.side_count
        following = self.following.tolist()
        count = 0
        for first in range(self.side_count):
            side = first
            while contour[side] < 0:
                contour[side] = count
                side = following[side]
            count += contour[first] == count
        return sealed(np.array(contour, dtype=np.intp))

    @cached_property
    def side_region(self) -> Indices:
        """Which face of the plane each side borders on, ``(s,)``; 0 is the unbounded one."""
        contour, x, y = self.side_contour, *self.points.T
        part = np.array(groups(len(self.points), self.edges.tolist()))
        angle = np.arctan2(*self.side_along.T[::-1])
        # of each connected part, at its leftmost point, the side that has the region around the part on its left
        order = np.lexsort((-angle, y[self.tail], x[self.tail]))
        order = order[self.source[order] == order]
        _, first = np.unique(part[self.tail[order]], return_index=True)
        around = order[np.sort(first)]
        region = np.full(int(contour.max()) + 1, -1)
        region[contour[around]] = 0
        region[region < 0] = np.arange(1, int((region < 0).sum()) + 1)
        low, high = self.points[self.edges[:, 0]], self.points[self.edges[:, 1]]
        for side in around.tolist():
            # look to the left, and find the side that looks back
            px, py = self.points[self.tail[side]]
            crossing = np.flatnonzero((low[:, 1] <= py) != (high[:, 1] <= py))
            slope = (high[crossing, 0] - low[crossing, 0]) / (high[crossing, 1] - low[crossing, 1])
            at = low[crossing, 0] + (py - low[crossing, 1]) * slope
            seen = (at < px) & (part[self.edges[crossing, 0]] != part[self.tail[side]])
            if seen.any():
                edge = crossing[seen][np.lexsort((slope[seen], at[seen]))[-1]]
                facing = 2 * edge + (high[edge, 1] > low[edge, 1])
                region[contour[side]] = region[contour[facing]]
        return sealed(region[contour])

    def moved_to(self, points: ArrayLike) -> Graph:
        """Return the graph with its points moved, ``(n, 2)``; edges must not come to cross, which is not checked."""
        moved = np.array(points, dtype=np.float64)
        if moved.shape != self.points.shape:
            raise ValueError(f"the graph has {len(self.points)} points, but {len(moved)} places were given")
        return Graph(sealed(moved), self.edges, self.tail, self.head, self.following, self.source)


def graph_of(points: ArrayLike, edges: ArrayLike) -> Graph:
    """Return the graph of edges ``(m, 2)`` between points ``(n, 2)``.

    Raises ``ValueError``, which says where, if a point has no edge or is not finite, if two points are the same, or if
    edges cross, overlap, pass through a point, or are there twice.
    """
    points = np.array(points, dtype=np.float64).reshape(-1, 2)
    edges = np.array(edges, dtype=np.intp).reshape(-1, 2)
    _require_planar(points, edges)
    tail, head = edges.reshape(-1), edges[:, ::-1].reshape(-1)
    count = len(tail)
    following = following_half_edges(points, edges)
    degree = np.bincount(tail, minlength=len(points))
    source = np.arange(count)
    ends = np.flatnonzero(degree[head] == 1)
    if len(ends):
        following[ends] = count + np.arange(len(ends))
        following = np.concatenate([following, ends ^ 1])
        source = np.concatenate([source, ends])
        tail, head = np.concatenate([tail, head[ends]]), np.concatenate([head, head[ends]])
    return Graph(sealed(points), sealed(edges), sealed(tail), sealed(head), sealed(following), sealed(source))


def _require_planar(points: Floats, edges: Indices) -> None:
    """Raise ``ValueError`` where points and edges are no planar graph."""
    if not len(edges):
        raise ValueError("the graph has no edges, so it has no straight skeleton")
    if edges.min() < 0 or edges.max() >= len(points):
        raise ValueError(f"an edge has a point that is not one of the {len(points)} that there are")
    if not np.isfinite(points).all():
        raise ValueError("a point is not finite")
    used = np.zeros(len(points), dtype=bool)
    used[edges] = True
    if not used.all():
        raise ValueError(f"the point at {_place(points[int(np.argmin(used))])} has no edge")
    order = np.lexsort(points.T)
    same = (points[order[1:]] == points[order[:-1]]).all(axis=1)
    if same.any():
        raise ValueError(f"two points are at {_place(points[order[int(np.argmax(same))]])}")
    short = edges[:, 0] == edges[:, 1]
    if short.any():
        raise ValueError(f"the edge at {_place(points[edges[int(np.argmax(short)), 0]])} has no length")
    ends = points[edges]
    lines = shapely.linestrings(ends.reshape(-1, 2), indices=np.repeat(np.arange(len(edges)), 2))
    if shapely.is_simple(shapely.multilinestrings(lines)):
        return
    one, other = shapely.STRtree(lines).query(lines, predicate="intersects")
    for a, b in zip(one.tolist(), other.tolist(), strict=True):
        if a < b:
            common = shapely.intersection(lines[a], lines[b])
            shared = set(edges[a].tolist()) & set(edges[b].tolist())
            if len(shared) == 1 and common.geom_type == "Point":
                continue
            x, y = shapely.get_coordinates(common)[0]
            raise ValueError(f"edges {a} and {b} cross, overlap or touch at {_place(np.array([x, y]))}")
    raise ValueError("edges touch or cross each other")


def _place(point: Floats) -> str:
    return f"({point[0]:.6g}, {point[1]:.6g})"
