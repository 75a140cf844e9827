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
    Bools,
    Chars,
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
    rings: Sequence[Ring] | Ragged,
    edges: Sequence[Edge] | Ints,
    kinds: Sequence[str] | Chars,
    sheet_corners: set[int],
) -> tuple[CreasePattern, FoldedState]:
    """Return the pattern and its folded state.

    ``flat`` and ``folded`` ``(v, 2)`` mm; ``rings`` the faces from bottom to top, counter-clockwise on the sheet;
    ``edges`` with their ``kinds`` "M", "V", "B". Vertices on which nothing turns are left out, the rest numbered anew;
    face 0 is the lowest that looks up, the others follow the layer order.
    """
    rings = rings if isinstance(rings, Ragged) else Ragged.from_rows(rings)
    edges, kinds = np.asarray(edges, dtype=np.int32).reshape(-1, 2), np.asarray(kinds, dtype="<U1")
    joined, types, straight = _dissolve_straight(edges, kinds, sheet_corners, len(flat))
    used = np.zeros(len(flat), dtype=np.bool_)
    used[joined] = True
    renumber = np.where(used, np.cumsum(used) - 1, -1).astype(np.int32)
    kept = ~straight[rings.values]
    ends = np.concatenate([[0], np.cumsum(kept, dtype=np.int32)])[rings.offsets]
    faces = Ragged(renumber[rings.values[kept]], ends.astype(np.int32))
    landed = folded[used]
    first = next(k for k in range(len(faces)) if signed_area(landed[faces[k]]) > 0)
    layers: Ints = np.arange(len(faces), dtype=np.int32)
    layers[[0, first]] = layers[[first, 0]]
    faces = faces.take(layers)
    types.setflags(write=False)
    pattern = CreasePattern(points_array(flat[used]), index_array(renumber[joined]), types, faces)
    return pattern, FoldedState(points_array(landed), index_array(layers))


def _dissolve_straight(edges: Ints, kinds: Chars, sheet_corners: set[int], count: int) -> tuple[Ints, Chars, Bools]:
    """Join the two edges at every vertex where nothing turns: by Kawasaki's theorem two creases alone are one line.

    Returns the edges, each in place of the first of its parts that ends where something turns, their kinds, and which
    of ``count`` vertices are straight.
    """
    straight = np.bincount(edges.ravel(), minlength=count) == 2
    straight[list(sheet_corners)] = False
    at_straight = straight[edges]
    parts = np.flatnonzero(at_straight.any(axis=1))
    beside: dict[int, list[int]] = defaultdict(list)
    ends = dict(zip(parts.tolist(), edges[parts].tolist(), strict=True))
    for number, pair in ends.items():
        for vertex in pair:
            beside[vertex].append(number)
    is_straight = set(np.unique(edges[parts][at_straight[parts]]).tolist())
    whole = ~at_straight.any(axis=1)
    joined = edges.copy()
    done: set[int] = set()
    for first, (a, b) in ends.items():
        if first in done or (a in is_straight and b in is_straight):
            continue
        vertex, number = (b, first) if a not in is_straight else (a, first)
        start = a if vertex == b else b
        done.add(number)
        while vertex in is_straight:
            one, other = beside[vertex]
            number = other if one == number else one
            done.add(number)
            one, other = ends[number]
            vertex = other if one == vertex else one
        joined[first] = start, vertex
        whole[first] = True
    return joined[whole], kinds[whole], straight
