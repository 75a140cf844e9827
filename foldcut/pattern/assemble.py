"""From stacked faces to the finished crease pattern: the last step of every method.

Outlines of faces in layer order, and creases -> ``CreasePattern``, ``FoldedState``.

Invariants: no vertex lies in the middle of a straight crease or border, except the sheet's corners; face 0 looks up;
each edge has one face beside it on the border and two inside.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from foldcut.core.arrays import BLOCK, Bools, Chars, Floats, Ints, Ragged, sealed
from foldcut.core.errors import UnfoldableError
from foldcut.core.model import CreasePattern, FoldedState
from foldcut.geometry.planar_graph import half_edges, pair_keys, signed_areas
from foldcut.geometry.vectors import signed_area

Polygon = list[int]
"""The vertices around a face, or around several that hang together, by number."""


class NoFaceUpError(UnfoldableError):
    """A folded state cannot be written down because none of its faces looks up."""


def outlines(polygons: Sequence[Polygon]) -> list[Polygon]:
    """Join counter-clockwise polygons side to side; return the outline of each connected piece."""
    if len(polygons) == 1:
        return [*polygons]
    sides = {pair for polygon in polygons for pair in zip(polygon, polygon[1:] + polygon[:1], strict=True)}
    following = {a: b for a, b in sides if (b, a) not in sides}
    pieces = []
    while following:
        start = vertex = min(following)
        piece: Polygon = []
        while not piece or vertex != start:
            piece.append(vertex)
            vertex = following.pop(vertex)
        pieces.append(piece)
    return pieces


def merge_stacks(inside: Sequence[int], outside: Sequence[int], shared: set[int]) -> list[int]:
    """Merge two stacks that have the shared faces in the same order; between these ``inside``'s faces come first."""
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


def creases_of_stack(folded: Floats, polygons: Sequence[Polygon] | Ragged) -> tuple[Ints, Chars]:
    """Read the edges, ``(e, 2)``, and their assignment, ``(e,)``, off a stack of faces, bottom to top.

    A crease is a valley exactly when the face that looks up has its neighbour above it. ``folded`` ``(v, 2)``.
    """
    polygons = polygons if isinstance(polygons, Ragged) else Ragged.from_rows(polygons)
    start, end = half_edges(polygons)
    face, keys, back = polygons.rows, pair_keys(start, end), pair_keys(end, start)
    order = np.argsort(keys)
    at = np.minimum(np.searchsorted(keys, back, sorter=order), len(keys) - 1)
    border = keys[order[at]] != back
    valley = (face[order[at]] > face) == (signed_areas(folded, polygons) > 0)[face]
    kept = border | (start < end)
    kinds: Chars = np.where(border, "B", np.where(valley, "V", "M"))[kept]
    return np.stack([start, end], axis=1)[kept], kinds


def assemble(
    flat: Floats,
    folded: Floats,
    polygons: Sequence[Polygon] | Ragged,
    edges: Ints,
    kinds: Chars,
    sheet_corners: set[int],
) -> tuple[CreasePattern, FoldedState]:
    """Return the pattern and its folded state.

    ``flat`` and ``folded`` ``(v, 2)`` mm; ``polygons``: the faces from bottom to top, counter-clockwise on the sheet;
    ``edges`` with their ``kinds`` "M", "V", "B"; ``sheet_corners``: vertices that stay. Other vertices in the
    middle of a straight line are left out and the rest is renumbered. Face 0 is the lowest one that looks up; the
    others are in layer order. Raises ``NoFaceUpError`` if none looks up.
    """
    polygons = polygons if isinstance(polygons, Ragged) else Ragged.from_rows(polygons)
    joined, types, straight = _dissolve_straight(edges, kinds, sheet_corners, len(flat))
    used = np.zeros(len(flat), dtype=np.bool_)
    used[joined[:, 0]] = used[joined[:, 1]] = True
    renumber = np.where(used, np.cumsum(used, dtype=np.int32) - 1, -1).astype(np.int32)
    faces = _without(straight, polygons)
    del polygons, edges, kinds  # these may be the last references: frees the memory
    _look_up(renumber, joined.reshape(-1))
    _look_up(renumber, faces.values)
    landed = folded[used]
    first = next((k for k in range(len(faces)) if signed_area(landed[faces[k]]) > 0), None)
    if first is None:
        raise NoFaceUpError("no face of the pattern looks up")
    layers: Ints = np.arange(len(faces), dtype=np.int32)
    layers[[0, first]] = layers[[first, 0]]
    begin = faces.take(layers[: first + 1])
    faces.values[: len(begin.values)], faces.offsets[: first + 2] = begin.values, begin.offsets
    faces = Ragged(sealed(faces.values), sealed(faces.offsets))
    pattern = CreasePattern(sealed(flat[used]), sealed(joined), sealed(types), faces)
    return pattern, FoldedState(sealed(landed), sealed(layers))


def _without(gone: Bools, polygons: Ragged) -> Ragged:
    """The outlines without some of their vertices; some vertices of each remain."""
    kept = np.empty(len(polygons.values), dtype=np.bool_)
    for low in range(0, len(kept), BLOCK):
        kept[low : low + BLOCK] = ~gone[polygons.values[low : low + BLOCK]]
    offsets = np.zeros(len(polygons) + 1, dtype=np.int32)
    np.cumsum(np.add.reduceat(kept, polygons.offsets[:-1], dtype=np.int32), out=offsets[1:])
    return Ragged(polygons.values[kept], offsets)


def _look_up(numbers: Ints, places: Ints) -> None:
    """Replace each place, ``(n,)``, by the number at this place."""
    for low in range(0, len(places), BLOCK):
        places[low : low + BLOCK] = numbers[places[low : low + BLOCK]]


def _dissolve_straight(edges: Ints, kinds: Chars, sheet_corners: set[int], count: int) -> tuple[Ints, Chars, Bools]:
    """Join the two edges at every vertex that has only two: by Kawasaki's theorem they are one straight line.

    Returns the edges, each in place of the first of its parts that ends at a vertex that stays, their kinds, and which
    of ``count`` vertices are left out.
    """
    start, end = edges.T
    straight = np.bincount(start, minlength=count) + np.bincount(end, minlength=count) == 2
    straight[list(sheet_corners)] = False
    start_turns, end_turns = ~straight[start], ~straight[end]
    whole = start_turns & end_turns
    parts = np.flatnonzero(~whole)
    # 2 k + e stands for part k, walked toward its end e; at a straight vertex the walk continues along the other part
    toward = edges[parts].ravel()
    following = np.arange(len(toward))
    goes_on = np.flatnonzero(straight[toward])
    one, other = goes_on[np.argsort(toward[goes_on], kind="stable")].reshape(-1, 2).T
    following[one], following[other] = other ^ 1, one ^ 1
    for _ in range(len(toward).bit_length()):  # twice as far each time, until all walks end at a vertex that stays
        farther = following[following]
        if np.array_equal(farther, following):
            break
        following = farther
    from_start, from_end = (np.flatnonzero(turns[parts]) for turns in (start_turns, end_turns))
    first = np.concatenate([2 * from_start + 1, 2 * from_end])
    last = following[first]
    first, last = first[first < last], last[first < last]  # of a line's two ends, take the one at the lower part
    lines = parts[first >> 1]
    whole[lines] = True
    joined = edges[whole]
    joined[(np.cumsum(whole, dtype=np.int32) - 1)[lines]] = np.stack([toward[first ^ 1], toward[last]], axis=1)
    return joined, kinds[whole], straight
