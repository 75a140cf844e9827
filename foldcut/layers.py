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
from foldcut.model import CreasePattern, FoldedState, Ints, Ragged, index_array, points_array
from foldcut.molecules import Molecules


def fold_layers(molecules: Molecules, assignment: Assignment) -> tuple[CreasePattern, FoldedState]:
    """Return the crease pattern with facets merged into faces, and its folded state with the layer order.

    Vertices that only lie on a straight line (two creases of one kind, or none on the border) are left out.
    Source: paper section 4.
    """
    inside_root, outside_root = assignment.roots
    inside = _walk(molecules, assignment, inside_root)
    outside = _walk(molecules, assignment, outside_root)[::-1]
    joined, face_of = _join_unfolded(molecules, assignment)
    shared = {face for face, parts in joined.items() if len(parts) > 1}
    order = _merge([face_of[f] for f in inside], [face_of[f] for f in outside], shared)[::-1]
    rings = [_outline([molecules.facets[f].tolist() for f in joined[face]]) for face in order]

    keep = np.isin(assignment.crease_assignment, ("M", "V", "B"))
    edges, kinds = molecules.creases[keep].tolist(), assignment.crease_assignment[keep].tolist()
    edges, kinds, straight = _dissolve_straight(edges, kinds, molecules)
    rings = [[v for v in ring if v not in straight] for ring in rings]
    return _assemble(molecules, rings, edges, kinds)


def _walk(molecules: Molecules, assignment: Assignment, root: int) -> list[int]:
    """The facets of one face of the plane, top to bottom: preorder of T_M, from each entry side counter-clockwise."""
    around: dict[tuple[int, int], list[int]] = defaultdict(list)
    for facet, place in enumerate(zip(molecules.facet_molecule.tolist(), molecules.facet_corner.tolist(), strict=True)):
        around[place].append(facet)
    feet = molecules.feet.to_lists()
    entry, parent = assignment.entry_side.tolist(), assignment.parent.tolist()
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


def _join_unfolded(molecules: Molecules, assignment: Assignment) -> tuple[dict[int, list[int]], list[int]]:
    """Facets joined across sides that are not folded: facets by face, and the face of each facet."""
    unfolded = {frozenset(pair) for pair in molecules.creases[assignment.crease_assignment == "F"].tolist()}
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


def _merge(inside: list[int], outside: list[int], shared: set[int]) -> list[int]:
    """Merge two lists that have the shared faces in the same order; before each, first what ``outside`` has."""
    order: list[int] = []
    rest = iter(outside)
    for face in inside:
        if face in shared:
            for other in rest:
                if other == face:
                    break
                assert other not in shared, "the layers inside and outside do not match along the shape's boundary"
                order.append(other)
        order.append(face)
    return order + list(rest)


def _outline(rings: list[list[int]]) -> list[int]:
    """The outline of counter-clockwise facets joined side to side."""
    if len(rings) == 1:
        return rings[0]
    sides = {pair for ring in rings for pair in zip(ring, ring[1:] + ring[:1], strict=True)}
    following = {a: b for a, b in sides if (b, a) not in sides}
    start = min(following)
    outline = [start]
    while (vertex := following[outline[-1]]) != start:
        outline.append(vertex)
    return outline


def _dissolve_straight(
    edges: list[list[int]], kinds: list[str], molecules: Molecules
) -> tuple[list[list[int]], list[str], set[int]]:
    """Join the two edges at every vertex where nothing turns: by Kawasaki's theorem two creases alone are one line."""
    at: dict[int, list[int]] = defaultdict(list)
    for number, (a, b) in enumerate(edges):
        at[a].append(number)
        at[b].append(number)
    corners = _sheet_corners(molecules)
    straight = {v for v, mine in at.items() if len(mine) == 2 and v not in corners}
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
        joined.append([start, vertex])
        types.append(kinds[first])
    return joined, types, straight


def _sheet_corners(molecules: Molecules) -> set[int]:
    """The vertices at the corners of the sheet."""
    border = molecules.boundary_sides[molecules.boundary_sides[:, 3] == 0]
    points = molecules.vertices[border[:, 0]]
    before, after = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    sharp = turn > 0.5 * np.hypot(*before.T) * np.hypot(*after.T)
    return set(border[sharp, 0].tolist())


def _assemble(
    molecules: Molecules, rings: list[list[int]], edges: list[list[int]], kinds: list[str]
) -> tuple[CreasePattern, FoldedState]:
    """Number the vertices anew; face 0 is one that looks up, the others follow the layer order."""
    used = np.unique(np.array(edges, dtype=np.int32))
    number = np.full(len(molecules.vertices), -1, dtype=np.int32)
    number[used] = np.arange(len(used), dtype=np.int32)
    renumber = number.tolist()
    folded = molecules.folded[used]
    faces = [[renumber[v] for v in ring] for ring in rings]
    first = next(k for k, ring in enumerate(faces) if _looks_up(folded[ring]))
    layers: Ints = np.arange(len(faces), dtype=np.int32)
    layers[[0, first]] = layers[[first, 0]]
    faces[0], faces[first] = faces[first], faces[0]
    pattern = CreasePattern(
        points_array(molecules.vertices[used]),
        index_array([[renumber[a], renumber[b]] for a, b in edges]),
        np.array(kinds, dtype="<U1"),
        Ragged.from_rows(faces),
    )
    return pattern, FoldedState(points_array(folded), index_array(layers))


def _looks_up(polygon: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> bool:
    following = np.roll(polygon, -1, axis=0)
    return bool((polygon[:, 0] * following[:, 1] - following[:, 0] * polygon[:, 1]).sum() > 0)
