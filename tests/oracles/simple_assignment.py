"""Joining the molecules: which creases are mountains, which valleys, and how the molecules hang together.

``Packing``, ``Molecules`` -> ``Assignment`` (paper section 4, corrected: see docs/assignment.md).

Two trees decide it, in every face of the plane by itself. T_C is a spanning tree of side edges over the corners that
are not on the shape's boundary loop, which is contracted to its root; in the outside face the sheet's border,
contracted, is one more node. T_M joins the molecules across the sides that are not in T_C, and is rooted at the
molecule behind one and the same boundary side in both faces. Bisectors are mountains, all other creases valleys, but

- every corner in T_C reverses the half of its tree side that ends at the corner;
- every part of a molecule reverses its tangency edge toward its parent part, the two roots toward the boundary side.

Sides on the shape's loop are not folded. This holds inside and outside alike, and for one boundary loop only.

Invariants: both trees span; every interior vertex has two more mountains than valleys, or two fewer.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Iterable

import numpy as np

from foldcut.core.arrays import Chars, index_array
from foldcut.core.errors import UnfoldableError
from foldcut.methods.disks.molecules import Kind, Molecules
from foldcut.methods.disks.trees import Assignment

Vertices = tuple[int, int]
SHAPE, BORDER = -1, -2  # the nodes of T_C that stand for a whole boundary


def assign_creases(molecules: Molecules, face_inside: Iterable[bool]) -> Assignment:
    """Choose mountain or valley for every crease, for a shape with one boundary loop.

    ``face_inside`` says of each face of the plane whether it is part of the shape. Raises ``UnfoldableError`` when a
    tree does not span. Source: paper section 4, Figures 5 and 6, with the correction of docs/assignment.md.
    """
    inside = list(face_inside)
    corners, feet = molecules.corners.to_lists(), molecules.feet.to_lists()
    face = molecules.face.tolist()
    on_border: set[int] = set()
    on_shape: set[int] = set()
    loop_of_foot: dict[int, int] = {}
    for start, foot, end, loop in molecules.boundary_sides.tolist():
        (on_shape if loop else on_border).update((start, end))
        loop_of_foot[foot] = loop
    loop_of_foot |= _right_feet(molecules, loop_of_foot)
    on_shape |= _right_corners(molecules)

    corner_tree = _corner_tree(corners, feet, face, loop_of_foot, on_border, on_shape)
    tree_feet = {foot for _, foot in corner_tree}
    behind: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for number, row in enumerate(feet):
        for side, foot in enumerate(row):
            behind[foot].append((number, side))

    roots = _roots(molecules, behind, face, inside)
    entry_side, parent = molecule_tree(feet, behind, roots, tree_feet, loop_of_foot)
    assignment = _assign(molecules, corner_tree, entry_side, loop_of_foot)
    order = sorted((number for number, _ in roots), key=lambda number: not inside[face[number]])
    return Assignment(
        assignment,
        index_array(entry_side),
        index_array(parent),
        (order[0], order[1]),
        index_array(corner_tree),
    )


def ribbon_partners(molecules: Molecules) -> dict[int, int]:
    """Vertices on the left border of the ribbon to their like on the right one."""
    return dict(molecules.creases[molecules.crease_kind == Kind.RIBBON].tolist())


def _right_feet(molecules: Molecules, loop_of_foot: dict[int, int]) -> dict[int, int]:
    partners = ribbon_partners(molecules)
    return {partners[foot]: loop for foot, loop in loop_of_foot.items() if foot in partners}


def _right_corners(molecules: Molecules) -> set[int]:
    return set(ribbon_partners(molecules).values())


def _corner_tree(
    corners: list[list[int]],
    feet: list[list[int]],
    face: list[int],
    loop_of_foot: dict[int, int],
    on_border: set[int],
    on_shape: set[int],
) -> list[Vertices]:
    """T_C by breadth-first search in each face, as (child corner, tangency point of the side to its parent)."""
    tree: list[Vertices] = []
    contracted = dict.fromkeys(on_border, BORDER) | dict.fromkeys(on_shape, SHAPE)
    for its_face in sorted(set(face)):
        graph: dict[int, list[tuple[int, int, int]]] = defaultdict(list)
        for number, row in enumerate(corners):
            if face[number] != its_face:
                continue
            for side, corner in enumerate(row):
                foot, following = feet[number][side], row[side + 1 - len(row)]
                one, other = contracted.get(corner, corner), contracted.get(following, following)
                if foot in loop_of_foot or one == other:
                    continue
                graph[one].append((other, following, foot))
                graph[other].append((one, corner, foot))
        reached = {SHAPE}
        queue = deque(reached)
        while queue:
            for following, child, foot in graph[queue.popleft()]:
                if following not in reached:
                    reached.add(following)
                    queue.append(following)
                    tree.append((child, foot))
        if not graph.keys() <= reached:
            raise UnfoldableError("the tree of corners does not reach every corner; move the drawing a little")
    return tree


def _roots(
    molecules: Molecules, behind: dict[int, list[tuple[int, int]]], face: list[int], inside: list[bool]
) -> list[tuple[int, int]]:
    """The molecule and side on either side of the boundary side with the largest disks, first in order of ties."""
    sides = molecules.boundary_sides[molecules.boundary_sides[:, 3] > 0]
    lengths = molecules.folded[sides[:, 0], 0] + molecules.folded[sides[:, 2], 0]
    start, foot, _, _ = sides[int(np.argmax(lengths > lengths.max() * (1 - 1e-9)))].tolist()
    partner = ribbon_partners(molecules).get(foot, foot)
    places = behind[foot] + (behind[partner] if partner != foot else [])
    assert len(places) == 2, (start, foot)
    return sorted(places, key=lambda place: not inside[face[place[0]]])


def molecule_tree(
    feet: list[list[int]],
    behind: dict[int, list[tuple[int, int]]],
    roots: list[tuple[int, int]],
    tree_feet: set[int],
    loop_of_foot: dict[int, int],
) -> tuple[list[int], list[int]]:
    """T_M: the entry side and the parent of every molecule."""
    entry_side, parent = [-1] * len(feet), [-1] * len(feet)
    for number, side in roots:
        entry_side[number] = side
    queue = deque(number for number, _ in roots)
    while queue:
        number = queue.popleft()
        for foot in feet[number]:
            if foot in tree_feet or foot in loop_of_foot:
                continue
            for following, side in behind[foot]:
                if entry_side[following] < 0:
                    entry_side[following], parent[following] = side, number
                    queue.append(following)
    if min(entry_side) < 0:
        raise UnfoldableError("the tree of molecules does not reach every molecule; move the drawing a little")
    return entry_side, parent


def _assign(
    molecules: Molecules, corner_tree: list[Vertices], entry_side: list[int], loop_of_foot: dict[int, int]
) -> Chars:
    kinds = molecules.crease_kind
    assignment = np.where(kinds == Kind.BISECTOR, "M", "V").astype("<U1")
    reversed_half = {(min(pair), max(pair)) for pair in corner_tree}
    side_part = molecules.side_part.to_lists()
    feet_of_roots = set()
    for number in np.flatnonzero(kinds == Kind.SIDE).tolist():
        a, b = molecules.creases[number].tolist()
        loop = loop_of_foot.get(a, loop_of_foot.get(b))
        if loop is not None:
            assignment[number] = "F" if loop else "B"
        elif (min(a, b), max(a, b)) in reversed_half:
            assignment[number] = "M"
    for number in np.flatnonzero(kinds == Kind.TANGENCY).tolist():
        molecule, part, side = (
            int(column[number]) for column in (molecules.crease_molecule, molecules.crease_part, molecules.crease_side)
        )
        entry = entry_side[molecule]
        toward_parent = entry if side_part[molecule][entry] == part else len(side_part[molecule])
        if side == toward_parent:
            assignment[number] = "M"
            feet_of_roots.add(int(molecules.creases[number, 0]))
    # Across the ribbon: mountains at corners; at a tangency point the crease goes on as it is on either side.
    for number in np.flatnonzero(kinds == Kind.RIBBON).tolist():
        foot = int(molecules.creases[number, 0])
        if foot not in loop_of_foot or foot in feet_of_roots:
            assignment[number] = "M"
    return assignment
