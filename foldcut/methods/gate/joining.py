"""Joining the molecules of a shape with several loops: the equal-disk gate.

``Molecules`` of the parts, rings -> ``CreasePattern``, ``FoldedState`` (docs/several-loops.md).

In every part T_C is rooted at the part's own loop, and the contracted ring is a leaf of it; in main part and collar the
ring's path begins at the same disk. Each loop has one hinge, the root of T_M on both of its sides. The parts' walks are
merged along the loops; at a ring the two layers of each crevice triangle next to the ring's side are moved from the
collar's walk into the main part's; a loop's block goes into that of the loop above, beside the layer where the path
ends. Mountain and valley are read off the order.

Nothing here proves that the layers do not cross: ``verify`` must say so. They do not if all that lies between the gate
and the moved layers fits into a crevice triangle.
"""

from __future__ import annotations

import time
from collections import defaultdict, deque
from dataclasses import dataclass, replace

import numpy as np

from foldcut.core.arrays import Floats, Ints, Ragged, index_array
from foldcut.core.errors import UnfoldableError
from foldcut.core.model import CreasePattern, FoldedState, Shape, Sheet
from foldcut.geometry.tolerance import Tolerance
from foldcut.methods.disks.boundary import boundary_disks
from foldcut.methods.disks.disk_pairs import overlapping_disks
from foldcut.methods.disks.layers import (
    face_outlines,
    facets_at_places,
    join_facets,
    merge_layers,
    sheet_corners,
    walks,
)
from foldcut.methods.disks.molecules import Kind, Molecules, build_molecules
from foldcut.methods.disks.packing import Packing, fill_gaps
from foldcut.methods.disks.trees import molecule_tree, opposite_sides
from foldcut.methods.gate.rings import HEIGHT, Parts, Ring, divide_faces, plan_rings, small_at_gates
from foldcut.pattern.assemble import assemble, creases_of_stack
from foldcut.proof.verify import verify

# The room of a ring on either side, in radii of its disks, that is tried.
ROOMS = (2.6, 3.5, 5.0)
MOST_DISKS = {"fast": 10_000, "normal": 20_000, "best": 60_000}
"""So many disks of rings and on boundaries, by effort, are packed for all sizes of rings that are tried together.

A disk makes some 33 creases; 4,000 take about a second, with verification.
"""
RINGS = 1_000_000
Step = tuple[int, int, int]  # child corner, parent corner, tangency point


@dataclass(frozen=True, eq=False)
class Gated:
    """What the method made.

    ``excess`` is by how much, relative to it, the paths' surroundings exceed the gate; ``parent`` ``(m,)`` the
    molecules' parents in T_M, -1 at roots.
    """

    packing: Packing
    molecules: Molecules
    rings: list[Ring]
    creases: CreasePattern
    folded: FoldedState
    excess: float
    parent: Ints


def fold_gated(
    shape: Shape, sheet: Sheet, ribbon: float, effort: str = "normal", seconds: float | None = None
) -> Gated:
    """Fold a shape with several loops by rings of equal disks: the first that is verified, with ever smaller disks.

    ``shape`` is in the sheet's mm, ``ribbon`` the half-width in mm; ``effort`` is one of ``MOST_DISKS``, ``seconds`` a
    time limit instead. Raises ``UnfoldableError`` with the loops and the reason where there is no room, the layers
    cross, or too many disks are needed.
    """
    if len(shape.loops) < 2:
        raise UnfoldableError("the shape has one boundary loop; a gate joins several")
    budget = _Budget(effort, seconds)
    reasons = []
    for room in ROOMS:
        try:
            made = build_gated(shape, sheet, ribbon, room, budget=budget)
        except UnfoldableError as error:
            reasons.append(str(error))
            if budget.over:
                break
            continue
        findings = verify(made.creases, made.folded.layers, shape)
        if not findings:
            return made
        reasons.append(f"the pattern fails verification ({findings[0]})")
    why = reasons[0] if len(reasons) == 1 or not budget.over else f"{reasons[0]}; with smaller rings {reasons[-1]}"
    raise UnfoldableError(f"the shape's {len(shape.loops)} loops cannot be joined by gates: {why}")


class _Budget:
    """How many disks may be packed, and for how long."""

    def __init__(self, effort: str, seconds: float | None) -> None:
        self.effort, self.seconds = effort, seconds
        self.most = self.left = MOST_DISKS["best" if seconds is not None else effort]
        self.start = time.perf_counter()
        self.over = False

    def take(self, disks: int) -> None:
        """Raise ``UnfoldableError`` if so many more disks are too many."""
        self.left -= disks
        if self.left < 0:
            self.over = True
            more = "" if self.most == MOST_DISKS["best"] else "give --effort best, "
            raise UnfoldableError(
                f"{disks:,} disks would be needed, and all that is tried may have {self.most:,}; {more}"
                "move the loops apart, or use a bigger sheet or fewer corners"
            )
        self.look()

    def look(self, _: float = 0.0, __: str = "") -> None:
        """Raise ``UnfoldableError`` if the time is over."""
        if self.seconds is not None and time.perf_counter() - self.start > self.seconds:
            self.over = True
            raise UnfoldableError(f"the {self.seconds:g} seconds are over; give more --seconds")


def build_gated(
    shape: Shape, sheet: Sheet, ribbon: float, room: float, *, move_layers: bool = True, budget: _Budget | None = None
) -> Gated:
    """Build the pattern with one size of ring, not verified; without ``move_layers`` it has no gate (for tests)."""
    tolerance = Tolerance.for_sheet(sheet)
    root, rings = plan_rings(shape, sheet, ribbon, room)
    most = budget.left if budget else MOST_DISKS["best"]
    boundary = boundary_disks(shape, sheet, ribbon, tolerance, small_at_gates(rings), most)
    parts = divide_faces(boundary, rings)
    _require_apart(parts, tolerance)
    if budget is not None:
        budget.take(len(parts.boundary.radii))
    packed = fill_gaps(parts.boundary, tolerance, budget.look if budget else None)
    packing = with_molecules(packed, parts)
    molecules = build_molecules(packing, tolerance)
    joined = _Joined(molecules, packing, parts, root, rings)
    creases, folded = joined.fold(move_layers=move_layers)
    return Gated(packing, molecules, rings, creases, folded, joined.excess, joined.parent)


def _require_apart(parts: Parts, tolerance: Tolerance) -> None:
    """Raise ``UnfoldableError`` where disks that are there before packing overlap: no pattern comes of it."""
    boundary = parts.boundary
    each = np.stack([boundary.chain_face[boundary.chains.rows], boundary.chains.values], axis=1)
    face, disk = np.unique(each, axis=0).T
    one, _ = overlapping_disks(boundary.centres[disk], boundary.radii[disk], face, tolerance)
    if len(one):
        x, y = boundary.centres[disk[one[0]]]
        raise UnfoldableError(
            f"disks of the rings overlap near ({x:.4g}, {y:.4g}); move the loops apart or use a bigger sheet"
        )


def with_molecules(packing: Packing, parts: Parts) -> Packing:
    """Return the packing with the triangles at the rings."""
    triangles = 3 * np.arange(1, len(parts.molecules) + 1)
    offsets = np.append(packing.gaps.offsets, packing.gaps.offsets[-1] + triangles)
    return replace(
        packing,
        gaps=Ragged(np.append(packing.gaps.values, parts.molecules), index_array(offsets)),
        gap_face=np.append(packing.gap_face, parts.parts),
    )


class _Joined:
    """The trees and the order, step by step.

    A *place* is a corner of a molecule and the side after it, numbered as in ``corners.values``; ``row`` ``(places,)``
    is its molecule, ``corner`` and ``foot`` are its vertices, ``following`` is the next place around the molecule.
    """

    def __init__(self, molecules: Molecules, packing: Packing, parts: Parts, root: int, rings: list[Ring]) -> None:
        self.molecules, self.rings, self.root = molecules, rings, root
        self.collar = parts.collar
        self.inside = packing.face_inside.tolist()
        self.corner, self.foot, self.row = molecules.corners.values, molecules.feet.values, molecules.corners.rows
        self.following = molecules.corners.following
        self.next_corner = self.corner[self.following]
        self.part = molecules.face[self.row]
        self.opposite = opposite_sides(self.foot)
        self.ring_vertices = {
            loop: molecules.disk_vertex[np.array(disks)].tolist() for loop, disks in parts.ring_disks.items()
        }
        self._label_vertices()
        self.first_facet, self.facet_count = facets_at_places(molecules)
        self.graphs: list[_Graph] = []
        self.excess = 0.0
        self.parent = index_array([])
        self.ends: dict[int, tuple[int, int]] = {}  # by loop: the path's end on the loop above, and on the loop

    def _label_vertices(self) -> None:
        """Note which vertices lie on which loop or ring: each is one node of T_C."""
        molecules = self.molecules
        count = len(molecules.vertices)
        self.partner = np.arange(count, dtype=np.int32)  # on the ribbon's other border
        across = molecules.creases[molecules.crease_kind == Kind.RIBBON]
        self.partner[across[:, 0]] = across[:, 1]
        self.node = np.arange(count, dtype=np.int32)  # on loops and rings: -1 - loop, or loop - RINGS
        self.loop_of_foot = np.full(count, -1, dtype=np.int32)
        start, foot, end, loop = molecules.boundary_sides.T
        for vertex in (start, end):
            self.node[vertex] = self.node[self.partner[vertex]] = -1 - loop
        self.loop_of_foot[foot] = self.loop_of_foot[self.partner[foot]] = loop
        self.ring_of_foot = np.full(count, -1, dtype=np.int32)
        for number, vertices in self.ring_vertices.items():
            self.node[vertices] = number - RINGS
            on_ring = (self.node[self.corner] == number - RINGS) & (self.node[self.next_corner] == number - RINGS)
            self.ring_of_foot[self.foot[on_ring]] = number
        self.barrier = (self.loop_of_foot >= 0) | (self.ring_of_foot >= 0)

    def fold(self, *, move_layers: bool) -> tuple[CreasePattern, FoldedState]:
        molecules = self.molecules
        needed = self._needed()
        self.graphs = [self._graph(part, needed) for part in range(len(self.inside))]
        tree = self._corner_tree()
        roots = self._roots()
        closed = self.barrier.copy()
        closed[tree] = True
        entry, self.parent = molecule_tree(molecules, np.array([*roots.values()]), ~closed[self.foot])
        entry = entry - molecules.feet.offsets[:-1]
        walked = walks(molecules, entry, self.parent, self.row[[*roots.values()]].tolist())
        layers = dict(zip(roots, walked, strict=True))
        if move_layers:
            for ring in self.rings:
                self._move(ring, layers)
        sides = molecules.creases[molecules.crease_kind == Kind.SIDE]
        self.face, self.shared = join_facets(molecules, sides[(self.loop_of_foot[sides] > 0).any(axis=1)])
        order = self._block(self.root, layers)[::-1]
        rings = face_outlines(molecules.facets, self.face, self.shared, order)
        edges, kinds = creases_of_stack(molecules.folded, rings)
        return assemble(molecules.vertices, molecules.folded, rings, edges, kinds, sheet_corners(molecules))

    def _graph(self, part: int, needed: Floats) -> _Graph:
        """The graph of a part; ``needed`` by place is the radius of a ring whose crevice triangle its facets fit."""
        mine = self.part == part
        one, other = self.node[self.corner], self.node[self.next_corner]
        side = np.flatnonzero(mine & ~self.barrier[self.foot] & (one != other))
        ends = np.stack([self.corner[side], self.next_corner[side]], axis=1).ravel()
        # corners are numbered as they come
        vertices, first, number = np.unique(ends, return_index=True, return_inverse=True)
        order = np.argsort(first)
        rank = np.empty(len(order), dtype=np.int32)
        rank[order] = np.arange(len(order))
        source = rank[number]
        target = source.reshape(-1, 2)[:, ::-1].ravel()
        by = np.argsort(source, kind="stable")
        reach = np.zeros(len(self.node))
        np.maximum.at(reach, self.corner[mine], needed[mine])
        offsets = np.searchsorted(source[by], np.arange(len(vertices) + 1)).astype(np.int32)
        return _Graph(
            vertices[order], source[by], target[by], self.foot[side][by >> 1], offsets, reach[vertices[order]]
        )

    def _needed(self) -> Floats:
        """By place, the radius of a ring whose crevice triangle the facets of the corner there fit into."""
        molecules = self.molecules
        base = float(np.abs(molecules.folded[self.corner[0], 1]))
        x, y = np.abs(molecules.folded).T
        facets = np.maximum.reduceat((x + (y - base) / HEIGHT)[molecules.facets.values], molecules.facets.offsets[:-1])
        # the facets of molecules come first, each place has some
        return np.maximum.reduceat(facets[: int(self.facet_count.sum())], self.first_facet)

    def _above(self, part: int) -> int:
        """The loop that a part's T_C is rooted at."""
        collared = {collar: loop for loop, collar in self.collar.items()}
        return collared.get(part, part or self.root)

    def _corner_tree(self) -> Ints:
        """The tangency points of T_C's sides in all parts."""
        forced: dict[int, list[Step]] = defaultdict(list)
        for ring in self.rings:
            two = (ring.face, self.collar[ring.loop])
            found = [self._paths(part, ring, forced[part]) for part in two]
            costs = found[0].ends + found[1].ends
            if not np.isfinite(costs).any():
                raise UnfoldableError(f"no way leads from loop {ring.loop} to loop {ring.above} through its ring")
            gate = int(np.argmin(costs))
            last = []
            for part, paths in zip(two, found, strict=True):
                steps = self._trace(self.graphs[part], paths, gate)
                forced[part] += steps
                to = np.isin(self.graphs[part].vertices, [step[1] for step in steps])
                self.excess = max(self.excess, float(self._excess(self.graphs[part], ring)[to].max()))
                last.append(steps[-1][1])
            self.ends[ring.loop] = (last[0], last[1])
        return index_array([foot for part in range(len(self.inside)) for foot in self._spanning(part, forced[part])])

    def _excess(self, graph: _Graph, ring: Ring) -> Floats:
        """By how much each corner's facets in a part stick out of the ring's crevice triangle, relative to it."""
        return np.maximum(0.0, graph.reach / ring.radius - 1)

    def _paths(self, part: int, ring: Ring, taken: list[Step]) -> _Paths:
        """The best paths from the disks of a ring to the loop of the part's root."""
        from scipy.sparse import csr_array
        from scipy.sparse.csgraph import dijkstra

        graph = self.graphs[part]
        count = len(graph.vertices)
        node = self.node[graph.vertices]
        blocked = np.isin(graph.vertices, [vertex for step in taken for vertex in step[:2]])
        at_root = (node == -1 - self._above(part)) & ~blocked
        between = (node >= 0) & ~blocked
        excess = self._excess(graph, ring)
        costs = np.where(excess > 0, 1 + (10 + 100 * excess), 1.0)
        # the paths start at one more node, before all corners of the loop
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
        disks = [numbers.get(vertex, -1) for vertex in self.ring_vertices[ring.loop]]
        return _Paths(distance, index_array(disks), np.where(np.array(disks) >= 0, ends[disks], np.inf))

    def _trace(self, graph: _Graph, paths: _Paths, gate: int) -> list[Step]:
        """The steps of the path from a ring's disk; of corners equally far the first goes on."""
        steps: list[Step] = []
        at = int(paths.disks[gate])
        while self.node[graph.vertices[at]] >= 0 or not steps:
            target = graph.target[graph.offsets[at] : graph.offsets[at + 1]]
            after = int(target[np.lexsort((graph.vertices[target], paths.distance[target]))[0]])
            back = slice(int(graph.offsets[after]), int(graph.offsets[after + 1]))
            foot = graph.foot[back][int(np.argmax(graph.target[back] == at))]
            steps.append((int(graph.vertices[at]), int(graph.vertices[after]), int(foot)))
            at = after
        return steps

    def _spanning(self, part: int, forced: list[Step]) -> set[int]:
        """T_C of a part: the given paths, and a breadth-first tree that hangs on them as little as possible."""
        graph = self.graphs[part]
        along = np.isin(graph.vertices, [corner for step in forced for corner in step[:2]])
        beside = along[graph.source] | along[graph.target]
        node = self.node[graph.vertices]
        source, target = node[graph.source], node[graph.target]
        # all that is left of a ring is its path
        open_sides = (target > -RINGS // 2) & (source > -RINGS // 2)
        away, beside_path = (
            _by_node(source[which], target[which], graph.foot[which])
            for which in (open_sides & ~beside, open_sides & beside)
        )
        root = -1 - self._above(part)
        tree = {foot for _, _, foot in forced}
        reached = {root, *(int(self.node[child]) for child, _, _ in forced)}
        queue = deque([root])
        late = deque(one for one in reached if one > -RINGS // 2)
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

    def _places(self, foot: int) -> list[int]:
        """The places on both sides of a side of molecules, or of the ribbon along it."""
        places = np.flatnonzero(self.foot == foot)
        if self.partner[foot] != foot:
            places = np.append(places, np.flatnonzero(self.foot == self.partner[foot]))
        return [int(place) for place in places]

    def _roots(self) -> dict[int, int]:
        """By part, the place that T_M is rooted at."""
        roots: dict[int, int] = {}
        sides = self.molecules.boundary_sides
        for loop in (self.root, *self.collar):
            mine = sides[sides[:, 3] == loop]
            if loop == self.root:
                x = self.molecules.folded[:, 0]
                foot = int(mine[int(np.argmax(x[mine[:, 0]] + x[mine[:, 2]])), 1])
            else:
                ends = (self.part == self.collar[loop]) & (self.next_corner == self.ends[loop][1])
                foot = next(int(foot) for foot in mine[:, 1] if (self.foot[ends] == self.partner[foot]).any())
            roots |= {int(self.part[place]): place for place in self._places(foot)}
        return roots

    def _move(self, ring: Ring, layers: dict[int, Ints]) -> None:
        """Move the layers of the crevice triangles at the ring's sides from the collar's walk to the main part's."""
        collar = self.collar[ring.loop]
        there = np.flatnonzero((self.ring_of_foot[self.foot] == ring.loop) & (self.part == collar))
        last = self.first_facet + self.facet_count - 1
        moved = np.stack([self.first_facet[self.following[there]], last[there]], axis=1).astype(np.int32)
        after = last[self.opposite[there]]
        layers[collar] = layers[collar][~np.isin(layers[collar], moved)]
        main = layers[ring.face]
        at = np.flatnonzero(np.isin(main, after))
        by = np.argsort(after)
        which = by[np.searchsorted(after[by], main[at])]
        layers[ring.face] = np.insert(main, np.repeat(at + 1, 2), moved[which].ravel())

    def _block(self, loop: int, layers: dict[int, Ints]) -> Ints:
        """The faces of a loop's two parts and of all that is reached through them, top to bottom."""
        parts = (loop, 0 if loop == self.root else self.collar[loop])
        inside, outside = sorted(parts, key=lambda part: not self.inside[part])
        order = merge_layers(self.face[layers[inside]], self.face[layers[outside][::-1]], self.shared)
        for ring in self.rings:
            if ring.above == loop:
                face = self.face[self._layer_after(ring)]
                at = int(np.flatnonzero(order == face)[0]) + (1 if self.inside[ring.face] else 0)
                order = np.insert(order, at, self._block(ring.loop, layers))
        return order

    def _layer_after(self, ring: Ring) -> int:
        """The facet of the main part, on the loop above, right after the end of the path."""
        ends = (self.part == ring.face) & (self.corner == self.ends[ring.loop][0]) & (self.loop_of_foot[self.foot] >= 0)
        place = int(np.flatnonzero(ends)[0])
        return int(self.first_facet[place] + self.facet_count[place] - 1)


@dataclass(frozen=True, eq=False)
class _Graph:
    """The corners of a part, and the sides between them, each both ways.

    ``vertices`` ``(n,)``; corner k's sides are ``target[offsets[k] : offsets[k + 1]]``, numbers of corners, with their
    tangency points ``foot``, in the order of the molecules; ``source`` is k. ``reach`` ``(n,)``: the radius of a ring
    whose crevice triangle the corner's facets fit into.
    """

    vertices: Ints
    source: Ints
    target: Ints
    foot: Ints
    offsets: Ints
    reach: Floats


@dataclass(frozen=True, eq=False)
class _Paths:
    """The cost of going to each corner of a part, ``(n,)``, and to each disk of a ring: infinite where none leads.

    ``disks`` are numbers of corners, -1 where no side leads to the disk.
    """

    distance: Floats
    disks: Ints
    ends: Floats


def _by_node(source: Ints, target: Ints, foot: Ints) -> dict[int, list[tuple[int, int]]]:
    """By node, the nodes next to it and the tangency points between."""
    beside: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for one, other, between in zip(source.tolist(), target.tolist(), foot.tolist(), strict=True):
        beside[one].append((other, between))
    return beside
