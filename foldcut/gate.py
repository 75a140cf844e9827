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

import heapq
from collections import defaultdict, deque
from dataclasses import dataclass, replace

import numpy as np

from foldcut.assignment import molecule_tree, ribbon_partners
from foldcut.boundary import boundary_disks
from foldcut.errors import UnfoldableError
from foldcut.faces import assemble, creases_of_stack, merge_stacks, outlines
from foldcut.layers import join_unfolded, sheet_corners, walk
from foldcut.model import CreasePattern, FoldedState, Ints, Ragged, Shape, Sheet, index_array
from foldcut.molecules import Kind, Molecules, build_molecules
from foldcut.packing import Packing, fill_gaps
from foldcut.ring import HEIGHT, Parts, Ring, divide_faces, plan_rings, small_at_gates
from foldcut.tolerance import Tolerance
from foldcut.verify import verify

# The room of a ring on either side, in radii of its disks, that is tried.
ROOMS = (2.6, 3.5, 5.0)
RINGS = 1_000_000
Graph = dict[int, list[tuple[int, int]]]  # corner -> (corner next to it, tangency point between)
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


def fold_gated(shape: Shape, sheet: Sheet, ribbon: float) -> Gated:
    """Fold a shape with several loops by rings of equal disks: the first that is verified, with ever smaller disks.

    ``shape`` is in the sheet's mm, ``ribbon`` the half-width in mm. Raises ``UnfoldableError`` with the loops and the
    reason where there is no room or the layers cross.
    """
    if len(shape.loops) < 2:
        raise UnfoldableError("the shape has one boundary loop; a gate joins several")
    reasons = []
    for room in ROOMS:
        try:
            made = build_gated(shape, sheet, ribbon, room)
        except UnfoldableError as error:
            reasons.append(str(error))
            continue
        findings = verify(made.creases, made.folded.layers, shape)
        if not findings:
            return made
        reasons.append(f"the pattern fails verification ({findings[0]})")
    raise UnfoldableError(f"the shape's {len(shape.loops)} loops cannot be joined by gates: {reasons[0]}")


def build_gated(shape: Shape, sheet: Sheet, ribbon: float, room: float, *, move_layers: bool = True) -> Gated:
    """Build the pattern with one size of ring, not verified; without ``move_layers`` it has no gate (for tests)."""
    tolerance = Tolerance.for_sheet(sheet)
    root, rings = plan_rings(shape, sheet, ribbon, room)
    boundary = boundary_disks(shape, sheet, ribbon, tolerance, small_at_gates(rings))
    parts = divide_faces(boundary, rings)
    packing = with_molecules(fill_gaps(parts.boundary, tolerance), parts)
    molecules = build_molecules(packing, tolerance)
    joined = _Joined(molecules, packing, parts, root, rings)
    creases, folded = joined.fold(move_layers=move_layers)
    return Gated(packing, molecules, rings, creases, folded, joined.excess, index_array(joined.parent))


def with_molecules(packing: Packing, parts: Parts) -> Packing:
    """Return the packing with the triangles at the rings."""
    return replace(
        packing,
        gaps=Ragged.from_rows([*packing.gaps.to_lists(), *parts.molecules]),
        gap_face=index_array([*packing.gap_face.tolist(), *parts.parts]),
    )


class _Joined:
    """The trees and the order, step by step."""

    def __init__(self, molecules: Molecules, packing: Packing, parts: Parts, root: int, rings: list[Ring]) -> None:
        self.molecules, self.rings, self.root = molecules, rings, root
        self.collar = parts.collar
        self.inside = packing.face_inside.tolist()
        self.corners, self.feet = molecules.corners.to_lists(), molecules.feet.to_lists()
        self.part = molecules.face.tolist()
        self.ring_vertices = {
            loop: [int(molecules.disk_vertex[disk]) for disk in disks] for loop, disks in parts.ring_disks.items()
        }
        self.behind: dict[int, list[tuple[int, int]]] = defaultdict(list)
        for number, row in enumerate(self.feet):
            for side, foot in enumerate(row):
                self.behind[foot].append((number, side))
        self.partners = ribbon_partners(molecules)
        self.loop_of_foot: dict[int, int] = {}
        self.label: dict[int, int] = {}  # corners on loops and rings: -1 - loop, or loop - RINGS
        for start, foot, end, loop in molecules.boundary_sides.tolist():
            for vertex in (start, end):
                self.label[vertex] = self.label[self.partners.get(vertex, vertex)] = -1 - loop
            self.loop_of_foot[foot] = self.loop_of_foot[self.partners.get(foot, foot)] = loop
        self.barrier = dict(self.loop_of_foot)
        for loop, vertices in self.ring_vertices.items():
            self.label |= dict.fromkeys(vertices, loop - RINGS)
            ring = set(vertices)
            for row, feet in zip(self.corners, self.feet, strict=True):
                for side, foot in enumerate(feet):
                    if row[side] in ring and row[side + 1 - len(row)] in ring:
                        self.barrier[foot] = loop - RINGS
        self.reach = self._reaches()
        self.excess = 0.0
        self.parent: list[int] = []
        self.ends: dict[int, tuple[int, int]] = {}  # by loop: the path's end on the loop above, and on the loop

    def fold(self, *, move_layers: bool) -> tuple[CreasePattern, FoldedState]:
        self.graphs = [self._graph(part) for part in range(len(self.inside))]
        tree = self._corner_tree()
        roots = self._roots()
        entry, parent = molecule_tree(self.feet, self.behind, list(roots.values()), tree, self.barrier)
        self.parent = parent
        walks = {part: walk(self.molecules, entry, parent, number) for part, (number, _) in roots.items()}
        if move_layers:
            for ring in self.rings:
                self._move(ring, walks)
        unfolded = [
            pair
            for pair in self.molecules.creases[self.molecules.crease_kind == Kind.SIDE].tolist()
            if any(self.loop_of_foot.get(vertex) for vertex in pair)
        ]
        joined, self.face_of = join_unfolded(self.molecules, np.array(unfolded))
        self.shared = {face for face, members in joined.items() if len(members) > 1}
        order = self._block(self.root, walks)[::-1]
        molecules = self.molecules
        rings = [ring for face in order for ring in outlines([molecules.facets[f].tolist() for f in joined[face]])]
        edges, kinds = creases_of_stack(molecules.folded, rings)
        return assemble(molecules.vertices, molecules.folded, rings, edges, kinds, sheet_corners(molecules))

    def _graph(self, part: int) -> Graph:
        graph: Graph = defaultdict(list)
        for number, (row, feet) in enumerate(zip(self.corners, self.feet, strict=True)):
            if self.part[number] == part:
                for side, (corner, foot) in enumerate(zip(row, feet, strict=True)):
                    following = row[side + 1 - len(row)]
                    if foot not in self.barrier and self._node(corner) != self._node(following):
                        graph[corner].append((following, foot))
                        graph[following].append((corner, foot))
        return graph

    def _node(self, vertex: int) -> int:
        return self.label.get(vertex, vertex)

    def _above(self, part: int) -> int:
        """The loop that a part's T_C is rooted at."""
        collared = {collar: loop for loop, collar in self.collar.items()}
        return collared.get(part, part or self.root)

    def _corner_tree(self) -> set[int]:
        """The tangency points of T_C's sides in all parts."""
        forced: dict[int, list[Step]] = defaultdict(list)
        for ring in self.rings:
            two = (ring.face, self.collar[ring.loop])
            found = [self._paths(part, ring, forced[part]) for part in two]
            vertices = [v for v in self.ring_vertices[ring.loop] if v in found[0] and v in found[1]]
            if not vertices:
                raise UnfoldableError(f"no way leads from loop {ring.loop} to loop {ring.above} through its ring")
            gate = min(vertices, key=lambda v: found[0][v][0] + found[1][v][0])
            for part, paths in zip(two, found, strict=True):
                forced[part] += paths[gate][1]
                self.excess = max(self.excess, *(self._excess(part, s[1], ring) for s in paths[gate][1]))
            self.ends[ring.loop] = (found[0][gate][1][-1][1], found[1][gate][1][-1][1])
        tree: set[int] = set()
        for part in range(len(self.inside)):
            tree |= self._spanning(part, forced[part])
        return tree

    def _excess(self, part: int, vertex: int, ring: Ring) -> float:
        """By how much a corner's facets in a part stick out of the ring's crevice triangle, relative to it."""
        return max(0.0, self.reach[part, vertex] / ring.radius - 1)

    def _reaches(self) -> dict[tuple[int, int], float]:
        """By part and corner, the radius of a ring whose crevice triangle the corner's facets fit into."""
        molecules = self.molecules
        base = float(np.abs(molecules.folded[molecules.corners[0][0], 1]))
        x, y = np.abs(molecules.folded).T
        needed = x + (y - base) / HEIGHT
        reach: dict[tuple[int, int], float] = defaultdict(float)
        owners = zip(molecules.facet_molecule.tolist(), molecules.facet_corner.tolist(), strict=True)
        for facet, (number, place) in enumerate(owners):
            if number >= 0:
                key = self.part[number], self.corners[number][place]
                reach[key] = max(reach[key], float(needed[molecules.facets[facet]].max()))
        return reach

    def _paths(self, part: int, ring: Ring, taken: list[Step]) -> dict[int, tuple[float, list[Step]]]:
        """The best path from each disk of a ring to the loop of the part's root: its cost and its steps."""
        root = -1 - self._above(part)
        blocked = {vertex for step in taken for vertex in step[:2]}
        graph = self.graphs[part]
        towards: dict[int, tuple[int, int]] = {}
        heap = [(self._cost(part, v, ring), v) for v in graph if self._node(v) == root and v not in blocked]
        distance = {v: d for d, v in heap}
        heapq.heapify(heap)
        found: dict[int, tuple[float, list[Step]]] = {}
        while heap:
            d, vertex = heapq.heappop(heap)
            if d > distance[vertex]:
                continue
            if self._node(vertex) == ring.loop - RINGS:
                steps, at = [], vertex
                while at in towards:
                    steps.append((at, *towards[at]))
                    at = towards[at][0]
                found[vertex] = (d, steps)
                continue
            for following, foot in graph[vertex]:
                node = self._node(following)
                if following in blocked or (node < 0 and node != ring.loop - RINGS):
                    continue
                cost = d + (0.0 if node < 0 else self._cost(part, following, ring))
                if cost < distance.get(following, np.inf):
                    distance[following], towards[following] = cost, (vertex, foot)
                    heapq.heappush(heap, (cost, following))
        return found

    def _cost(self, part: int, vertex: int, ring: Ring) -> float:
        excess = self._excess(part, vertex, ring)
        return 1 + (10 + 100 * excess if excess else 0)

    def _spanning(self, part: int, forced: list[Step]) -> set[int]:
        """T_C of a part: the given paths, and a breadth-first tree that hangs on them as little as possible."""
        along = {corner for step in forced for corner in step[:2]}
        graph: dict[int, list[tuple[int, int]]] = defaultdict(list)
        beside_path: dict[int, list[tuple[int, int]]] = defaultdict(list)
        for corner, beside in self.graphs[part].items():
            for following, foot in beside:
                sides = beside_path if corner in along or following in along else graph
                sides[self._node(corner)].append((self._node(following), foot))
        root = -1 - self._above(part)
        tree = {foot for _, _, foot in forced}
        reached = {root, *(self._node(child) for child, _, _ in forced)}
        queue = deque([root])
        late = deque(node for node in reached if node > -RINGS // 2)
        while queue or late:
            at, sides = (queue.popleft(), graph) if queue else (late.popleft(), beside_path)
            for node, foot in sides[at]:
                if node not in reached and node > -RINGS // 2:
                    reached.add(node)
                    tree.add(foot)
                    queue.append(node)
                    late.append(node)
        if not graph.keys() | beside_path.keys() <= reached:
            raise UnfoldableError("the tree of corners does not reach every corner; move the drawing a little")
        return tree

    def _roots(self) -> dict[int, tuple[int, int]]:
        """By part, the molecule and the side that T_M is rooted at."""
        roots: dict[int, tuple[int, int]] = {}
        sides = self.molecules.boundary_sides.tolist()
        for loop in (self.root, *self.collar):
            mine = [side for side in sides if side[3] == loop]
            if loop == self.root:
                foot = max(mine, key=lambda s: float(self.molecules.folded[[s[0], s[2]], 0].sum()))[1]
            else:
                foot = next(
                    foot
                    for _, foot, _, _ in mine
                    for number, side in self.behind[self.partners.get(foot, foot)]
                    if self.part[number] == self.collar[loop]
                    and self.corners[number][side + 1 - len(self.corners[number])] == self.ends[loop][1]
                )
            places = self.behind[foot] + (self.behind[self.partners[foot]] if foot in self.partners else [])
            roots |= {self.part[number]: (number, side) for number, side in places}
        return roots

    def _move(self, ring: Ring, walks: dict[int, list[int]]) -> None:
        """Move the layers of the crevice triangles at the ring's sides from the collar's walk to the main part's."""
        around: dict[tuple[int, int], list[int]] = defaultdict(list)
        molecules = self.molecules
        for facet, place in enumerate(
            zip(molecules.facet_molecule.tolist(), molecules.facet_corner.tolist(), strict=True)
        ):
            around[place].append(facet)
        after: dict[int, list[int]] = {}
        for foot, loop in self.barrier.items():
            if loop == ring.loop - RINGS:
                by_part = {self.part[number]: (number, side) for number, side in self.behind[foot]}
                number, side = by_part[self.collar[ring.loop]]
                moved = [around[number, (side + 1) % 3][0], around[number, side][-1]]
                after[around[by_part[ring.face]][-1]] = moved
        gone = {facet for moved in after.values() for facet in moved}
        collar = self.collar[ring.loop]
        walks[collar] = [facet for facet in walks[collar] if facet not in gone]
        walks[ring.face] = [one for facet in walks[ring.face] for one in (facet, *after.get(facet, ()))]

    def _block(self, loop: int, walks: dict[int, list[int]]) -> list[int]:
        """The faces of a loop's two parts and of all that is reached through them, top to bottom."""
        parts = (loop, 0 if loop == self.root else self.collar[loop])
        inside, outside = sorted(parts, key=lambda part: not self.inside[part])
        order = merge_stacks(
            [self.face_of[f] for f in walks[inside]], [self.face_of[f] for f in walks[outside][::-1]], self.shared
        )
        for ring in self.rings:
            if ring.above == loop:
                face = self.face_of[self._layer_after(ring)]
                at = order.index(face) + (1 if self.inside[ring.face] else 0)
                order[at:at] = self._block(ring.loop, walks)
        return order

    def _layer_after(self, ring: Ring) -> int:
        """The facet of the main part, on the loop above, right after the end of the path."""
        corner = self.ends[ring.loop][0]
        number, place = next(
            (number, place)
            for number, row in enumerate(self.corners)
            if self.part[number] == ring.face
            for place, vertex in enumerate(row)
            if vertex == corner and self.feet[number][place] in self.loop_of_foot
        )
        owners = zip(self.molecules.facet_molecule.tolist(), self.molecules.facet_corner.tolist(), strict=True)
        return max(facet for facet, owner in enumerate(owners) if owner == (number, place))
