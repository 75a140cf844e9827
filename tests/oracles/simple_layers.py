"""The folded state, face by face: what ``disks.layers`` and ``pattern.assemble`` do on arrays."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from foldcut.core.arrays import Floats, Ints, Ragged, index_array, points_array
from foldcut.core.model import CreasePattern, FoldedState
from foldcut.geometry.vectors import signed_area
from foldcut.methods.disks.layers import sheet_corners
from foldcut.methods.disks.molecules import Molecules
from foldcut.methods.disks.trees import Assignment
from foldcut.pattern.assemble import Polygon, merge_stacks, outlines

Edge = tuple[int, int]


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


def assemble(
    flat: Floats,
    folded: Floats,
    rings: Sequence[Polygon],
    edges: Sequence[Edge],
    kinds: Sequence[str],
    sheet_corners: set[int],
) -> tuple[CreasePattern, FoldedState]:
    """Return the pattern and its folded state.

    ``flat`` and ``folded`` ``(v, 2)`` mm; ``rings`` the faces from bottom to top, counter-clockwise on the sheet;
    ``edges`` with their ``kinds`` "M", "V", "B". Vertices on which nothing turns are left out, the rest numbered anew;
    face 0 is the lowest that looks up, the others follow the layer order.
    """
    joined, types, straight = _dissolve_straight(edges, kinds, sheet_corners)
    used = np.unique(np.array(joined, dtype=np.int32))
    renumber = np.full(len(flat), -1, dtype=np.int32)
    renumber[used] = np.arange(len(used), dtype=np.int32)
    faces = [renumber[[v for v in ring if v not in straight]].tolist() for ring in rings]
    first = next(k for k, ring in enumerate(faces) if signed_area(folded[used][ring]) > 0)
    layers: Ints = np.arange(len(faces), dtype=np.int32)
    layers[[0, first]] = layers[[first, 0]]
    faces[0], faces[first] = faces[first], faces[0]
    pattern = CreasePattern(
        points_array(flat[used]),
        index_array(renumber[np.array(joined, dtype=np.int32)]),
        np.array(types, dtype="<U1"),
        Ragged.from_rows(faces),
    )
    pattern.edges_assignment.setflags(write=False)
    return pattern, FoldedState(points_array(folded[used]), index_array(layers))


def _dissolve_straight(
    edges: Sequence[Edge], kinds: Sequence[str], sheet_corners: set[int]
) -> tuple[list[Edge], list[str], set[int]]:
    """Join the two edges at every vertex where nothing turns: by Kawasaki's theorem two creases alone are one line."""
    at: dict[int, list[int]] = defaultdict(list)
    for number, (a, b) in enumerate(edges):
        at[a].append(number)
        at[b].append(number)
    straight = {v for v, mine in at.items() if len(mine) == 2 and v not in sheet_corners}
    joined, types = [], []
    done: set[int] = set()
    for first, (a, b) in enumerate(edges):
        if first in done or (a in straight and b in straight):
            continue
        vertex, number = (b, first) if a not in straight else (a, first)
        start = a if vertex == b else b
        done.add(number)
        while vertex in straight:
            number = next(other for other in at[vertex] if other != number)
            done.add(number)
            one, other_end = edges[number]
            vertex = other_end if one == vertex else one
        joined.append((start, vertex))
        types.append(kinds[first])
    return joined, types, straight


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
