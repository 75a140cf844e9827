"""The corner tree T_C of every part: a path from each ring to the loop above and to its own loop, then all the rest.

In every part T_C is rooted at the part's own loop, and the ring, contracted, is a leaf of it. In the main part and in
the collar the ring's path begins at the same disk, the *gate*.
"""

from __future__ import annotations

from collections import defaultdict, deque
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from foldcut.core.arrays import Floats, Ints, index_array
from foldcut.core.errors import UnfoldableError
from foldcut.methods.gate.places import Places, is_ring, loop_node
from foldcut.methods.gate.rings import HEIGHT, Ring

__all__ = ["CornerTree", "corner_tree"]

DETOUR = 10.0
"""What a path pays for a corner whose facets stick out of the crevice triangle, in steps between corners."""

DETOUR_BY_EXCESS = 100.0
"""What it pays on top, times the excess."""


class Step(NamedTuple):
    """A step of a path in T_C: from a corner to its parent, and the tangency point of the side between them."""

    child: int
    parent: int
    foot: int


class PathEnds(NamedTuple):
    """The corners at which a ring's two paths end: on the loop above, and on the ring's own loop."""

    above: int
    own: int


@dataclass(frozen=True, eq=False)
class CornerTree:
    """T_C of all parts.

    ``feet``: the tangency points of its sides. ``ends``: by loop, where its ring's paths end. ``excess``: by how much
    the facets beside the paths exceed the crevice triangles, relative to these.
    """

    feet: Ints
    ends: dict[int, PathEnds]
    excess: float


@dataclass(frozen=True, eq=False)
class _Graph:
    """The corners of a part, and the sides between them, each in both directions.

    ``vertices`` ``(n,)``; corner k's sides are ``target[offsets[k] : offsets[k + 1]]``, numbers of corners, with their
    tangency points ``foot``, in the order of the molecules; ``source`` is k. ``reach`` ``(n,)``: the radius of a ring
    whose crevice triangle is just large enough for the corner's facets.
    """

    vertices: Ints
    source: Ints
    target: Ints
    foot: Ints
    offsets: Ints
    reach: Floats

    def excess(self, ring: Ring) -> Floats:
        """Return how far each corner's facets stick out of the ring's crevice triangle, relative to it."""
        return np.maximum(0.0, self.reach / ring.radius - 1)


@dataclass(frozen=True, eq=False)
class _Paths:
    """The cost of going from the root to each corner of a part, and to each disk of a ring; infinite without a way.

    ``disks`` are numbers of corners, -1 for disks that no side leads to.
    """

    distance: Floats
    disks: Ints
    ends: Floats


def corner_tree(places: Places, rings: list[Ring], collars: dict[int, int], root: int, parts: int) -> CornerTree:
    """Return T_C of all ``parts``; ``collars``: by loop, the part around it; ``root``: the root loop.

    Raises ``UnfoldableError`` where no way leads through a ring, or a tree does not span.
    """
    roots = {collar: loop for loop, collar in collars.items()}  # the loop that a collar's tree is rooted at
    needed = _needed_radii(places)
    graphs = [_graph(places, part, needed) for part in range(parts)]
    forced: dict[int, list[Step]] = defaultdict(list)
    path_ends: dict[int, PathEnds] = {}
    most = 0.0
    for ring in rings:
        two = (ring.face, collars[ring.loop])
        found = [_paths(places, graphs[part], roots.get(part, part or root), ring, forced[part]) for part in two]
        costs = found[0].ends + found[1].ends
        if not np.isfinite(costs).any():
            raise UnfoldableError(f"no way leads from loop {ring.loop} to loop {ring.above} through its ring")
        gate = int(np.argmin(costs))
        last = []
        for part, paths in zip(two, found, strict=True):
            steps = _trace(places, graphs[part], paths, gate)
            forced[part] += steps
            along = np.isin(graphs[part].vertices, [step.parent for step in steps])
            most = max(most, float(graphs[part].excess(ring)[along].max()))
            last.append(steps[-1].parent)
        path_ends[ring.loop] = PathEnds(last[0], last[1])
    feet = [
        foot
        for part in range(parts)
        for foot in _spanning(places, graphs[part], roots.get(part, part or root), forced[part])
    ]
    return CornerTree(index_array(feet), path_ends, most)


def _needed_radii(places: Places) -> Floats:
    """By place, the radius of a ring whose crevice triangle is just large enough for the facets at the corner."""
    molecules = places.molecules
    base = float(np.abs(molecules.folded[places.corner[0], 1]))
    x, y = np.abs(molecules.folded).T
    facets = np.maximum.reduceat((x + (y - base) / HEIGHT)[molecules.facets.values], molecules.facets.offsets[:-1])
    # the molecules' facets come first, and every place has some
    return np.maximum.reduceat(facets[: int(places.facet_count.sum())], places.first_facet)


def _graph(places: Places, part: int, needed: Floats) -> _Graph:
    mine = places.part == part
    one, other = places.node[places.corner], places.node[places.next_corner]
    side = np.flatnonzero(mine & ~places.barrier[places.foot] & (one != other))
    ends = np.stack([places.corner[side], places.next_corner[side]], axis=1).ravel()
    # corners are numbered in the order in which the sides name them
    vertices, first, number = np.unique(ends, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(order), dtype=np.int32)
    rank[order] = np.arange(len(order))
    source = rank[number]
    target = source.reshape(-1, 2)[:, ::-1].ravel()
    by = np.argsort(source, kind="stable")
    reach = np.zeros(len(places.node))
    np.maximum.at(reach, places.corner[mine], needed[mine])
    offsets = np.searchsorted(source[by], np.arange(len(vertices) + 1)).astype(np.int32)
    return _Graph(vertices[order], source[by], target[by], places.foot[side][by >> 1], offsets, reach[vertices[order]])


def _paths(places: Places, graph: _Graph, root: int, ring: Ring, taken: list[Step]) -> _Paths:
    """Find the cheapest paths from a part's root loop to the disks of a ring, off the paths that are taken."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import dijkstra

    count = len(graph.vertices)
    node = places.node[graph.vertices]
    blocked = np.isin(graph.vertices, [vertex for step in taken for vertex in (step.child, step.parent)])
    at_root = (node == loop_node(root)) & ~blocked
    between = (node >= 0) & ~blocked
    excess = graph.excess(ring)
    costs = np.where(excess > 0, 1 + (DETOUR + DETOUR_BY_EXCESS * excess), 1.0)
    # the paths start at one more node, in front of all corners of the loop
    start = np.flatnonzero(at_root)
    along = (at_root | between)[graph.source] & between[graph.target]
    begin, end = np.append(graph.source[along], np.full(len(start), count)), np.append(graph.target[along], start)
    begin, end = np.divmod(np.unique(begin.astype(np.int64) * (count + 1) + end), count + 1)
    steps = csr_array((costs[end], (begin, end)), shape=(count + 1, count + 1))
    distance: Floats = dijkstra(steps, indices=np.array([count]))[0, :count]
    ends = np.full(count, np.inf)
    np.minimum.at(ends, graph.target, distance[graph.source])
    ends[blocked] = np.inf
    numbers = {vertex: number for number, vertex in enumerate(graph.vertices.tolist())}
    disks = [numbers.get(vertex, -1) for vertex in places.ring_vertices[ring.loop]]
    return _Paths(distance, index_array(disks), np.where(np.array(disks) >= 0, ends[disks], np.inf))


def _trace(places: Places, graph: _Graph, paths: _Paths, gate: int) -> list[Step]:
    """Follow the path from a ring's disk to the root; of corners equally far the one with the lowest vertex is next."""
    steps: list[Step] = []
    at = int(paths.disks[gate])
    while places.node[graph.vertices[at]] >= 0 or not steps:
        target = graph.target[graph.offsets[at] : graph.offsets[at + 1]]
        after = int(target[np.lexsort((graph.vertices[target], paths.distance[target]))[0]])
        back = slice(int(graph.offsets[after]), int(graph.offsets[after + 1]))
        foot = graph.foot[back][int(np.argmax(graph.target[back] == at))]
        steps.append(Step(int(graph.vertices[at]), int(graph.vertices[after]), int(foot)))
        at = after
    return steps


def _spanning(places: Places, graph: _Graph, root: int, forced: list[Step]) -> set[int]:
    """Return the tangency points of T_C of a part: the given paths, and a breadth-first tree of all other corners.

    Sides that hang on the paths are used only where nothing else is left.
    """
    on_path = np.isin(graph.vertices, [corner for step in forced for corner in (step.child, step.parent)])
    beside = on_path[graph.source] | on_path[graph.target]
    node = places.node[graph.vertices]
    source, target = node[graph.source], node[graph.target]
    open_sides = ~is_ring(target) & ~is_ring(source)  # a ring has only the side of its path
    away, beside_path = (
        _by_node(source[which], target[which], graph.foot[which])
        for which in (open_sides & ~beside, open_sides & beside)
    )
    tree = {step.foot for step in forced}
    reached = {loop_node(root), *(int(places.node[step.child]) for step in forced)}
    queue = deque([loop_node(root)])
    late = deque(one for one in reached if not is_ring(one))
    while queue or late:
        at, sides = (queue.popleft(), away) if queue else (late.popleft(), beside_path)
        for following, foot in sides.get(at, ()):
            if following not in reached:
                reached.add(following)
                tree.add(foot)
                queue.append(following)
                late.append(following)
    if not set(node.tolist()) <= reached:
        raise UnfoldableError("the tree of corners does not reach every corner; move the drawing a little")
    return tree


def _by_node(source: Ints, target: Ints, foot: Ints) -> dict[int, list[tuple[int, int]]]:
    """By node, its neighbours and the tangency points of the sides to them."""
    beside: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for one, other, between in zip(source.tolist(), target.tolist(), foot.tolist(), strict=True):
        beside[one].append((other, between))
    return beside
