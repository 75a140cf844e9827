"""The folded state: which layer lies on which, and the faces of the finished crease pattern.

``Molecules``, ``Assignment`` -> ``CreasePattern``, ``FoldedState`` (paper section 4, the book of flaps).

Walking T_M from its root around each molecule gives a list of facets: after each corner's facets come those of the
molecule across the next side. The list of the inside face, top to bottom, and the reversed list of the outside face are
merged where they meet: the facets that are joined across the shape's boundary, which is not folded, are one face, and
both lists have them in the same order.

Invariants: the order is linear; faces joined by a crease face opposite ways; a crease is a valley exactly when the face
that looks up has its neighbour above it.
"""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from foldcut.assignment import Assignment
from foldcut.faces import assemble, merge_stacks, outlines
from foldcut.model import CreasePattern, FoldedState, Ints
from foldcut.molecules import Molecules


def fold_layers(molecules: Molecules, assignment: Assignment) -> tuple[CreasePattern, FoldedState]:
    """Return the crease pattern with facets merged into faces, and its folded state with the layer order.

    Vertices that only lie on a straight line (two creases of one kind, or none on the border) are left out.
    Source: paper section 4.
    """
    inside_root, outside_root = assignment.roots
    entry, parent = assignment.entry_side.tolist(), assignment.parent.tolist()
    inside = walk(molecules, entry, parent, inside_root)
    outside = walk(molecules, entry, parent, outside_root)[::-1]
    joined, face_of = join_unfolded(molecules, molecules.creases[assignment.crease_assignment == "F"])
    shared = {face for face, parts in joined.items() if len(parts) > 1}
    order = merge_stacks([face_of[f] for f in inside], [face_of[f] for f in outside], shared)[::-1]
    rings = [ring for face in order for ring in outlines([molecules.facets[f].tolist() for f in joined[face]])]
    keep = np.isin(assignment.crease_assignment, ("M", "V", "B"))
    edges = [(a, b) for a, b in molecules.creases[keep].tolist()]
    kinds = assignment.crease_assignment[keep].tolist()
    return assemble(molecules.vertices, molecules.folded, rings, edges, kinds, sheet_corners(molecules))


def walk(molecules: Molecules, entry: list[int], parent: list[int], root: int) -> list[int]:
    """The facets of one face of the plane, top to bottom: preorder of T_M, from each entry side counter-clockwise."""
    around: dict[tuple[int, int], list[int]] = defaultdict(list)
    for facet, place in enumerate(zip(molecules.facet_molecule.tolist(), molecules.facet_corner.tolist(), strict=True)):
        around[place].append(facet)
    feet = molecules.feet.to_lists()
    child: dict[tuple[int, int], int] = {}
    for number, above in enumerate(parent):
        if above >= 0:
            child[above, feet[above].index(feet[number][entry[number]])] = number
    order: list[int] = []
    stack: list[tuple[int, int]] = [(root, 0)]  # molecule, corners walked
    while stack:
        number, walked = stack.pop()
        sides = len(feet[number])
        if walked == sides:
            continue
        corner = (entry[number] + 1 + walked) % sides
        order += around[number, corner]
        stack.append((number, walked + 1))
        if (number, corner) in child and walked + 1 < sides:
            stack.append((child[number, corner], 0))
    return order


def join_unfolded(molecules: Molecules, sides: Ints) -> tuple[dict[int, list[int]], list[int]]:
    """Facets joined across sides that are not folded, ``(n, 2)``: facets by face, and the face of each facet."""
    unfolded = {frozenset(pair) for pair in sides.tolist()}
    face_of = list(range(len(molecules.facets)))

    def face(facet: int) -> int:
        while face_of[facet] != facet:
            facet = face_of[facet]
        return facet

    owner: dict[frozenset[int], int] = {}
    for facet, ring in enumerate(molecules.facets.to_lists()):
        for pair in zip(ring, ring[1:] + ring[:1], strict=True):
            side = frozenset(pair)
            if side in unfolded:
                face_of[face(facet)] = face(owner.setdefault(side, facet))
    joined: dict[int, list[int]] = defaultdict(list)
    for facet in range(len(face_of)):
        joined[face(facet)].append(facet)
    return joined, [face(facet) for facet in range(len(face_of))]


def sheet_corners(molecules: Molecules) -> set[int]:
    """The vertices at the corners of the sheet."""
    border = molecules.boundary_sides[molecules.boundary_sides[:, 3] == 0]
    points = molecules.vertices[border[:, 0]]
    before, after = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    sharp = turn > 0.5 * np.hypot(*before.T) * np.hypot(*after.T)
    return set(border[sharp, 0].tolist())
