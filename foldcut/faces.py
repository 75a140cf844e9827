"""From stacked facets to the finished crease pattern: what every method does last.

Rings of vertices in layer order, and creases -> ``CreasePattern``, ``FoldedState``.

Invariants: no vertex lies on a straight crease or border but for the sheet's corners; face 0 looks up; each edge is
beside one face on the border and beside two inside.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from foldcut.model import (
    CreasePattern,
    Floats,
    FoldedState,
    Ints,
    Ragged,
    index_array,
    points_array,
)
from foldcut.plane import signed_area

Ring = list[int]
Edge = tuple[int, int]


def outlines(rings: Sequence[Ring]) -> list[Ring]:
    """Return the outlines of counter-clockwise rings joined side to side: one for each piece that hangs together."""
    if len(rings) == 1:
        return [*rings]
    sides = {pair for ring in rings for pair in zip(ring, ring[1:] + ring[:1], strict=True)}
    following = {a: b for a, b in sides if (b, a) not in sides}
    pieces = []
    while following:
        start = vertex = min(following)
        piece: Ring = []
        while not piece or vertex != start:
            piece.append(vertex)
            vertex = following.pop(vertex)
        pieces.append(piece)
    return pieces


def merge_stacks(inside: Sequence[int], outside: Sequence[int], shared: set[int]) -> list[int]:
    """Merge two stacks that have the shared faces in the same order; before each, first what ``outside`` has."""
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


def creases_of_stack(folded: Floats, rings: Sequence[Ring]) -> tuple[list[Edge], list[str]]:
    """Read edges and their assignment off a stack of faces, bottom to top.

    A crease is a valley exactly when the face that looks up has its neighbour above it. ``folded`` ``(v, 2)``.
    """
    beside = {side: face for face, ring in enumerate(rings) for side in zip(ring, ring[1:] + ring[:1], strict=True)}
    up = [signed_area(folded[ring]) > 0 for ring in rings]
    edges, kinds = [], []
    for (a, b), face in beside.items():
        other = beside.get((b, a))
        if other is None:
            edges.append((a, b))
            kinds.append("B")
        elif a < b:
            edges.append((a, b))
            kinds.append("V" if (other > face) == up[face] else "M")
    return edges, kinds


def assemble(
    flat: Floats,
    folded: Floats,
    rings: Sequence[Ring],
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
