"""The trees that join the molecules, and which creases are mountains and valleys.

``Molecules`` -> ``Assignment`` (paper section 4, corrected: see docs/assignment.md).

In each face of the plane there are two trees. T_C, the corner tree, is a spanning tree of side edges over the corners
that are not on the shape's boundary loop; the loop, contracted, is its root, and in the outside face the sheet's
border, contracted, is one more node. T_M, the molecule tree, joins the molecules across the sides that are not in T_C.
Its roots in the two faces are the molecules on either side of one boundary side. Bisectors are mountains, all other
creases are valleys, except that

- every corner in T_C reverses the half of its tree side that ends at the corner;
- every part of a molecule reverses its tangency edge toward its parent part; the two roots reverse theirs toward the
  boundary side.

Sides on the shape's loop are not folded. The rule is the same inside and outside, and holds for one boundary loop only.

Invariants: both trees span; at every interior vertex, mountains and valleys differ by two.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import BLOCK, Bools, Chars, Ints, Numbers, index_array
from foldcut.core.errors import UnfoldableError
from foldcut.methods.disks.molecules import Kind, Molecules

SHAPE = 0
"""The node of T_C for the shape's boundary; it is numbered from the end of the vertices on."""

BORDER = 1
"""The node of T_C for the sheet's border, numbered likewise."""


@dataclass(frozen=True, eq=False)
class Assignment:
    """How the molecules are joined.

    ``crease_assignment`` ``(c,)``: "M", "V", "B" on the sheet's border, "F" where the shape's boundary is not folded.
    ``entry_side`` ``(m,)``: the side through which T_M enters a molecule; ``parent`` ``(m,)``: its parent, -1 at roots.
    ``roots``: the two root molecules, inside first. ``corner_tree`` ``(t, 2)``: T_C as the reversed halves of its
    sides, each (corner, tangency point).
    """

    crease_assignment: Chars
    entry_side: Ints
    parent: Ints
    roots: tuple[int, int]
    corner_tree: Ints


def assign_creases(molecules: Molecules, face_inside: Iterable[bool]) -> Assignment:
    """Choose mountain or valley for every crease, for a shape with one boundary loop.

    ``face_inside`` says of each face of the plane whether it is part of the shape. Raises ``UnfoldableError`` where a
    tree does not span. Source: paper section 4, Figures 5 and 6, with the correction of docs/assignment.md.
    """
    inside = np.array(list(face_inside), dtype=np.bool_)
    loops = _Loops.of(molecules)
    corner_tree = _corner_tree(molecules, loops)
    feet = molecules.feet.values
    reversed_corner = np.full(len(molecules.vertices), -1, dtype=np.int32)
    reversed_corner[corner_tree[:, 1]] = corner_tree[:, 0]
    open_sides = (reversed_corner[feet] < 0) & (loops.of_vertex[feet] < 0)
    roots = _roots(molecules, inside)
    entry_side, parent = molecule_tree(molecules, roots, open_sides)
    assignment = _assign(molecules, reversed_corner, entry_side, loops)
    return Assignment(
        assignment,
        index_array(entry_side - molecules.feet.offsets[:-1]),
        index_array(parent),
        (int(molecules.feet.rows[roots[0]]), int(molecules.feet.rows[roots[1]])),
        index_array(corner_tree),
    )


def opposite_sides(feet: Ints) -> Numbers:
    """Return, for the side with each foot, the other side with the same foot, or -1."""
    order = np.argsort(feet, kind="stable")
    pair = np.flatnonzero(feet[order[1:]] == feet[order[:-1]])
    opposite = np.full(len(feet), -1, dtype=np.int64)
    opposite[order[pair]], opposite[order[pair + 1]] = order[pair + 1], order[pair]
    return opposite


@dataclass(frozen=True, eq=False)
class _Loops:
    """By vertex: the loop that it is a foot on, or -1; and the node of T_C that it is contracted to, or itself."""

    of_vertex: Ints
    contracted: Ints

    @classmethod
    def of(cls, molecules: Molecules) -> _Loops:
        count = len(molecules.vertices)
        start, foot, end, loop = molecules.boundary_sides.T
        across = molecules.creases[molecules.crease_kind == Kind.RIBBON]
        of_vertex, contracted = np.full(count, -1, dtype=np.int32), np.arange(count, dtype=np.int32)
        of_vertex[foot] = loop
        right = across[of_vertex[across[:, 0]] >= 0]
        of_vertex[right[:, 1]] = of_vertex[right[:, 0]]
        for corner in (start, end):
            contracted[corner[loop == 0]] = count + BORDER
        for corner in (start, end):
            contracted[corner[loop > 0]] = count + SHAPE
        contracted[across[:, 1]] = count + SHAPE
        return cls(of_vertex, contracted)


def _corner_tree(molecules: Molecules, loops: _Loops) -> Ints:
    """Find T_C by breadth-first search in each face: rows (child corner, tangency point of the side to its parent)."""
    corner, foot, rows = molecules.corners.values, molecules.feet.values, molecules.corners.rows
    other = corner[molecules.corners.following]
    one_node, other_node = loops.contracted[corner], loops.contracted[other]
    usable = (loops.of_vertex[foot] < 0) & (one_node != other_node)
    face = molecules.face[rows]
    trees = []
    for its_face in np.unique(molecules.face):
        side = np.flatnonzero(usable & (face == its_face))
        # each side leads in both directions; the entries of a node keep the order of the sides
        source = np.stack([one_node[side], other_node[side]], axis=1).ravel()
        child = np.stack([other[side], corner[side]], axis=1).ravel()
        is_node = np.zeros(len(loops.contracted) + 2, dtype=np.bool_)
        is_node[source] = is_node[len(loops.contracted) + SHAPE] = True
        numbers = np.cumsum(is_node, dtype=np.int32) - 1
        source, root, count = numbers[source], int(numbers[len(loops.contracted) + SHAPE]), int(numbers[-1]) + 1
        target = source.reshape(-1, 2)[:, ::-1].ravel()
        order = np.argsort(source, kind="stable")
        source, target, child = source[order], target[order], child[order]
        reached, before = _breadth_first(source, target, count, root)
        if len(reached) < np.count_nonzero(np.bincount(source)):
            raise UnfoldableError("the tree of corners does not reach every corner; move the drawing a little")
        entry = _first_of(target, np.flatnonzero(before[target] == source), count)[reached[1:]]
        trees.append(np.column_stack([child[entry], foot[side][order[entry] >> 1]]))
    return np.concatenate(trees).astype(np.int32)


def _breadth_first(source: Numbers, target: Numbers, count: int, root: int) -> tuple[Numbers, Numbers]:
    """Return the nodes that edges reach from the root, nearest first, and the predecessor of each (negative: none).

    ``source`` is sorted; a node's edges are followed in their order.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import breadth_first_order

    offsets = np.searchsorted(source, np.arange(count + 1))
    graph = csr_array((np.ones(len(target)), target.astype(np.int32), offsets.astype(np.int32)), shape=(count, count))
    reached, before = breadth_first_order(graph, root, directed=True, return_predecessors=True)
    return reached, before


def _first_of(keys: Numbers, places: Numbers, count: int) -> Numbers:
    """For every key, the first of the ascending ``places`` that has it."""
    first = np.full(count, -1, dtype=np.int64)
    first[keys[places[::-1]]] = places[::-1]
    return first


def _roots(molecules: Molecules, inside: Bools) -> Numbers:
    """The two molecules' sides along the boundary side with the largest disks, the first of equals; inside first."""
    sides = molecules.boundary_sides[molecules.boundary_sides[:, 3] > 0]
    lengths = molecules.folded[sides[:, 0], 0] + molecules.folded[sides[:, 2], 0]
    start, foot, _, _ = sides[int(np.argmax(lengths > lengths.max() * (1 - 1e-9)))].tolist()
    across = molecules.creases[molecules.crease_kind == Kind.RIBBON]
    partner = int(across[across[:, 0] == foot, 1].max(initial=-1))
    places = np.flatnonzero(molecules.feet.values == foot)
    if partner >= 0:
        places = np.append(places, np.flatnonzero(molecules.feet.values == partner))
    assert len(places) == 2, (start, foot)
    outside = ~inside[molecules.face[molecules.feet.rows[places]]]
    return np.asarray(places[np.argsort(outside, kind="stable")])


def molecule_tree(molecules: Molecules, roots: Numbers, open_sides: Bools) -> tuple[Numbers, Ints]:
    """Return T_M: the entry side and the parent, -1 at roots, of every molecule, each ``(m,)``.

    Sides are places in ``feet.values``: ``roots`` has one for each face of the plane; ``open_sides`` tells which sides
    the tree may cross. Raises ``UnfoldableError`` where it does not span.
    """
    rows, count = molecules.feet.rows, len(molecules.feet)
    opposite = opposite_sides(molecules.feet.values)
    entry, parent = np.full(count, -1, dtype=np.int64), np.full(count, -1, dtype=np.int32)
    entry[rows[roots]] = roots
    side = np.flatnonzero(open_sides & (opposite >= 0))
    source, target = rows[side], rows[opposite[side]]
    for root in rows[roots].tolist():
        reached, before = _breadth_first(source, target, count, root)
        children = reached[1:]
        parent[children] = before[children]
        gone = np.flatnonzero(before[target] == source)
        entry[children] = opposite[side[_first_of(target, gone, count)[children]]]
    if entry.min() < 0:
        raise UnfoldableError("the tree of molecules does not reach every molecule; move the drawing a little")
    return entry, parent


def _assign(molecules: Molecules, reversed_corner: Ints, entry_side: Numbers, loops: _Loops) -> Chars:
    """Choose mountains and valleys; ``reversed_corner``: by foot in T_C the corner of the reversed half, or -1."""
    kinds = molecules.crease_kind
    mountain = kinds == Kind.BISECTOR
    of_root = np.zeros(len(molecules.vertices), dtype=np.bool_)
    assignment: Chars = np.full(len(kinds), "V", dtype="<U1")
    first, entry_part = molecules.feet.offsets, molecules.side_part.values[entry_side]
    blocks = [slice(low, low + BLOCK) for low in range(0, len(kinds), BLOCK)]
    for block in blocks:
        # toward the parent: through the entry side; from the part that is not behind it, across the diagonal
        molecule = molecules.crease_molecule[block]
        same_part = entry_part[molecule] == molecules.crease_part[block]
        toward = np.where(same_part, entry_side[molecule], first[molecule + 1]) - first[molecule]
        reverses = (kinds[block] == Kind.TANGENCY) & (molecules.crease_side[block] == toward)
        mountain[block] |= reverses
        of_root[molecules.creases[block][reverses, 0]] = True
    for block in blocks:
        a, b = molecules.creases[block].T
        its_kinds, of_loop = kinds[block], loops.of_vertex[a]
        side = its_kinds == Kind.SIDE
        mountain[block] |= side & ((reversed_corner[a] == b) | (reversed_corner[b] == a))
        # across the ribbon: mountains at corners; at a tangency point the crease continues the ones on either side
        mountain[block] |= (its_kinds == Kind.RIBBON) & ((of_loop < 0) | of_root[a])
        its = assignment[block]
        its[mountain[block]] = "M"
        of_loop = np.where(of_loop >= 0, of_loop, loops.of_vertex[b])
        its[side & (of_loop == 0)] = "B"
        its[side & (of_loop > 0)] = "F"
    return assignment
