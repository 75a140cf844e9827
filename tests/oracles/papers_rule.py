"""The paper's own assignment, to the letter of its section 4, on our molecules: it satisfies every local theorem
and does not fold (docs/assignment.md).
"""

from __future__ import annotations

from collections import defaultdict, deque

import numpy as np

from foldcut.core.arrays import Bools, Chars
from foldcut.methods.disks.molecules import Kind, Molecules


def papers_assignment(molecules: Molecules, face_inside: Bools) -> Chars:
    """Return the paper's mountains and valleys, "F" on the shape's boundary and "B" on the sheet's border."""
    corners, feet = molecules.corners.to_lists(), molecules.feet.to_lists()
    loop_of_foot = {foot: loop for _, foot, _, loop in molecules.boundary_sides.tolist()}
    border = {corner for a, _, b, loop in molecules.boundary_sides.tolist() if loop == 0 for corner in (a, b)}

    # T_C: all interior corners and exactly one on the sheet's border, no edges along boundaries
    graph = defaultdict(list)
    for row, its_feet in zip(corners, feet, strict=True):
        for side, corner in enumerate(row):
            following, foot = row[side + 1 - len(row)], its_feet[side]
            if foot not in loop_of_foot:
                graph[corner].append((following, foot))
                graph[following].append((corner, foot))
    root = min(corner for corner in border if graph[corner])
    reached, queue, tree = {root}, deque([root]), []
    while queue:
        for following, foot in graph[queue.popleft()]:
            if following not in reached and following not in border:
                reached.add(following)
                queue.append(following)
                tree.append((following, foot))
    assert reached == (set(graph) - border) | {root}, "this shape has no T_C as the paper wants it"

    # T_M: across all other sides, the shape's boundary included
    in_tree = {foot for _, foot in tree}
    behind = defaultdict(list)
    for number, row in enumerate(feet):
        for side, foot in enumerate(row):
            behind[foot].append((number, side))
    first = next(n for n, row in enumerate(corners) if root in row)
    entry = {first: next(s for s, foot in enumerate(feet[first]) if loop_of_foot.get(foot) == 0)}
    queue = deque([first])
    while queue:
        number = queue.popleft()
        for foot in feet[number]:
            if foot not in in_tree:
                for following, side in behind[foot]:
                    if following not in entry:
                        entry[following] = side
                        queue.append(following)
    assert len(entry) == len(corners)

    face_of_vertex: dict[int, int] = {}
    for number, row in enumerate(molecules.facets.to_lists()):
        for vertex in row:
            face_of_vertex.setdefault(vertex, int(molecules.face[molecules.facet_molecule[number]]))
    inside_crease = np.array(
        [
            face_inside[face_of_vertex[b if kind in (Kind.BISECTOR, Kind.TANGENCY) else a]]
            for (a, b), kind in zip(molecules.creases.tolist(), molecules.crease_kind.tolist(), strict=True)
        ]
    )
    # a side edge lies in the face of the molecules beside it
    side_face = {foot: bool(face_inside[molecules.face[number]]) for number, row in enumerate(feet) for foot in row}
    halves = {(min(pair), max(pair)) for pair in tree}
    side_part = molecules.side_part.to_lists()
    assignment = []
    for number, ((a, b), kind) in enumerate(
        zip(molecules.creases.tolist(), molecules.crease_kind.tolist(), strict=True)
    ):
        foot = next((v for v in (a, b) if v in side_face), -1)
        if kind == Kind.SIDE and foot in loop_of_foot:
            assignment.append("F" if loop_of_foot[foot] else "B")
            continue
        inside = side_face[foot] if kind == Kind.SIDE else bool(inside_crease[number])
        mountain = (kind == Kind.BISECTOR) == inside
        if kind == Kind.SIDE:
            mountain ^= (min(a, b), max(a, b)) in halves
        elif kind == Kind.TANGENCY:
            molecule, part = int(molecules.crease_molecule[number]), int(molecules.crease_part[number])
            enters_here = side_part[molecule][entry[molecule]] == part
            mountain ^= int(molecules.crease_side[number]) == (
                entry[molecule] if enters_here else len(side_part[molecule])
            )
        assignment.append("M" if mountain else "V")
    return np.array(assignment, dtype="<U1")
