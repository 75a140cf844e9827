"""Joining the molecules of several parts into one pile of layers: the equal-disk gate.

``Molecules`` of the parts, rings -> ``CreasePattern``, ``FoldedState`` (docs/several-loops.md).

Each loop has one hinge, the side at which T_M is rooted in the parts on both sides of it. The parts' walks are merged
along the loops. At a ring, the two layers of each crevice triangle next to the ring's side move from the collar's walk
to the main part's. A loop's block of layers goes into the block of the loop above, beside the layer where the path
ends. Mountains and valleys are read off the order.

Nothing here proves that the layers do not cross; ``verify`` must tell. They do not cross if everything that lies
between the gate and the moved layers fits into a crevice triangle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Bools, Ints
from foldcut.core.model import CreasePattern, FoldedState
from foldcut.methods.disks.layers import face_outlines, join_facets, merge_layers, sheet_corners, walks
from foldcut.methods.disks.molecules import Kind, Molecules
from foldcut.methods.disks.trees import molecule_tree
from foldcut.methods.gate.corner_tree import CornerTree, corner_tree
from foldcut.methods.gate.parts import Parts
from foldcut.methods.gate.places import Places
from foldcut.methods.gate.rings import Ring
from foldcut.pattern.assemble import assemble, creases_of_stack

__all__ = ["Joined", "join"]


@dataclass(frozen=True, eq=False)
class Joined:
    """The pattern, not verified.

    ``excess``: by how much the facets beside the paths exceed the crevice triangles, relative to these;
    ``parent`` ``(m,)``: the molecules' parents in T_M, -1 at roots.
    """

    creases: CreasePattern
    folded: FoldedState
    excess: float
    parent: Ints


def join(
    molecules: Molecules, inside: list[bool], parts: Parts, root: int, rings: list[Ring], *, move_layers: bool = True
) -> Joined:
    """Join the molecules of all parts; ``inside``: by part, whether it belongs to the shape; ``root``: the root loop.

    Without ``move_layers`` the pattern has no gate (for tests). Raises ``UnfoldableError`` where a tree does not span.
    """
    places = Places.of(molecules, parts.ring_disks)
    tree = corner_tree(places, rings, parts.collar, root, len(inside))
    roots = _roots(places, tree, parts.collar, root)
    closed = places.barrier.copy()
    closed[tree.feet] = True
    entry, parent = molecule_tree(molecules, np.array([*roots.values()]), ~closed[places.foot])
    entry = entry - molecules.feet.offsets[:-1]
    walked = walks(molecules, entry, parent, places.row[[*roots.values()]].tolist())
    layers = dict(zip(roots, walked, strict=True))  # by part
    if move_layers:
        for ring in rings:
            _move(places, ring, parts.collar[ring.loop], layers)
    sides = molecules.creases[molecules.crease_kind == Kind.SIDE]
    face, shared = join_facets(molecules, sides[(places.loop_of_foot[sides] > 0).any(axis=1)])
    blocks = _Blocks(places, tree, rings, parts.collar, inside, root, layers, face, shared)
    order = blocks.of(root)[::-1]
    outlines = face_outlines(molecules.facets, face, shared, order)
    edges, kinds = creases_of_stack(molecules.folded, outlines)
    creases, folded = assemble(molecules.vertices, molecules.folded, outlines, edges, kinds, sheet_corners(molecules))
    return Joined(creases, folded, tree.excess, parent)


def _roots(places: Places, tree: CornerTree, collars: dict[int, int], root: int) -> dict[int, int]:
    """By part, the place at which T_M is rooted."""
    roots: dict[int, int] = {}
    sides = places.molecules.boundary_sides
    for loop in (root, *collars):
        mine = sides[sides[:, 3] == loop]
        if loop == root:
            x = places.molecules.folded[:, 0]
            foot = int(mine[int(np.argmax(x[mine[:, 0]] + x[mine[:, 2]])), 1])
        else:
            ends = (places.part == collars[loop]) & (places.next_corner == tree.ends[loop].own)
            at_end = (int(foot) for foot in mine[:, 1] if (places.foot[ends] == places.partner[foot]).any())
            foot = next(at_end, -1)
            assert foot >= 0, f"no side of loop {loop} ends where its path does"
        roots |= {int(places.part[place]): place for place in places.beside(foot)}
    return roots


def _move(places: Places, ring: Ring, collar: int, layers: dict[int, Ints]) -> None:
    """Move the layers of the crevice triangles at the ring's sides from the collar's walk to the main part's."""
    there = np.flatnonzero((places.ring_of_foot[places.foot] == ring.loop) & (places.part == collar))
    last = places.last_facet
    moved = np.stack([places.first_facet[places.following[there]], last[there]], axis=1).astype(np.int32)
    after = last[places.opposite[there]]
    layers[collar] = layers[collar][~np.isin(layers[collar], moved)]
    main = layers[ring.face]
    at = np.flatnonzero(np.isin(main, after))
    by = np.argsort(after)
    which = by[np.searchsorted(after[by], main[at])]
    layers[ring.face] = np.insert(main, np.repeat(at + 1, 2), moved[which].ravel())


@dataclass(frozen=True, eq=False)
class _Blocks:
    """The layers of each loop: its two parts, and everything that is reached through them.

    ``layers``: by part, its facets, top to bottom; ``face`` and ``shared`` as ``join_facets`` returns them.
    """

    places: Places
    tree: CornerTree
    rings: list[Ring]
    collars: dict[int, int]
    inside: list[bool]
    root: int
    layers: dict[int, Ints]
    face: Ints
    shared: Bools

    def of(self, loop: int) -> Ints:
        """Return the faces of a loop's block, top to bottom."""
        parts = (loop, 0 if loop == self.root else self.collars[loop])
        inside, outside = sorted(parts, key=lambda part: not self.inside[part])
        order = merge_layers(self.face[self.layers[inside]], self.face[self.layers[outside][::-1]], self.shared)
        for ring in self.rings:
            if ring.above == loop:
                face = self.face[self._facet_at_path_end(ring)]
                at = int(np.flatnonzero(order == face)[0]) + (1 if self.inside[ring.face] else 0)
                order = np.insert(order, at, self.of(ring.loop))
        return order

    def _facet_at_path_end(self, ring: Ring) -> int:
        """The last facet of the main part at the corner of the loop above where the path ends."""
        places = self.places
        at_end = (places.part == ring.face) & (places.corner == self.tree.ends[ring.loop].above)
        place = int(np.flatnonzero(at_end & (places.loop_of_foot[places.foot] >= 0))[0])
        return int(places.last_facet[place])
