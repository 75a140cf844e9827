"""The folded state: the order of the layers, and the faces of the finished crease pattern.

``Molecules``, ``Assignment`` -> ``CreasePattern``, ``FoldedState`` (paper section 4, the book of flaps).

A walk along T_M from its root, around each molecule, gives a list of facets: after each corner's facets come those of
the molecule across the next side. The shape's boundary is not folded, so the facets on its two sides are one face. The
list of the inside face of the plane, top to bottom, and the reversed list of the outside face both have these faces in
the same order, and are merged there.

Invariants: the order is linear; faces joined by a crease face opposite ways; a crease is a valley exactly when the face
that looks up has its neighbour above it.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable

import numpy as np

from foldcut.core.arrays import Bools, Ints, Numbers, Ragged
from foldcut.core.model import CreasePattern, FoldedState
from foldcut.geometry.planar_graph import half_edges, pair_keys
from foldcut.geometry.polygons import runs
from foldcut.methods.disks.molecules import Molecules
from foldcut.methods.disks.trees import Assignment, opposite_sides
from foldcut.pattern.assemble import assemble, outlines


def fold_layers(molecules: Molecules, assignment: Assignment) -> tuple[CreasePattern, FoldedState]:
    """Return the crease pattern with facets merged into faces, and its folded state with the layer order.

    Vertices in the middle of a straight crease or border are left out.
    Source: paper section 4.
    """
    kept = np.isin(assignment.crease_assignment, ("M", "V", "B"))
    # memory use peaks while the pattern is assembled, so nothing but the arguments is held
    return assemble(
        molecules.vertices,
        molecules.folded,
        _stacked(molecules, assignment),
        molecules.creases[kept],
        assignment.crease_assignment[kept],
        sheet_corners(molecules),
    )


def _stacked(molecules: Molecules, assignment: Assignment) -> Ragged:
    """The outlines of the faces from bottom to top."""
    inside, outside = walks(molecules, assignment.entry_side, assignment.parent, assignment.roots)
    face, shared = join_facets(molecules, molecules.creases[assignment.crease_assignment == "F"])
    order = merge_layers(face[inside], face[outside[::-1]], shared)[::-1]
    del inside, outside
    return face_outlines(molecules.facets, face, shared, order)


def walks(molecules: Molecules, entry_side: Numbers, parent: Ints, roots: Iterable[int]) -> list[Ints]:
    """Return the facets of each face of the plane, top to bottom: preorder of T_M from each of its ``roots``.

    ``entry_side`` ``(m,)``: the side through which a molecule is entered; its corners are walked counter-clockwise from
    there. ``parent`` ``(m,)``: its parent, -1 at roots.

    After a corner comes the first corner of the child across the next side, or, if there is no child, the next corner
    of the same molecule. After a molecule's last corner comes the corner of its parent after the side between them. So
    every corner has exactly one successor.
    """
    feet = molecules.feet
    first = feet.offsets[:-1].astype(np.int64)
    following = feet.following
    entry = first + entry_side
    begin = following[entry]
    child = np.flatnonzero(parent >= 0)
    above = opposite_sides(feet.values)[entry[child]]
    after = following.copy()
    after[entry] = -1
    after[entry[child]] = following[above]
    after[above] = begin[child]
    follow: list[int] = after.tolist()
    start, count = facets_at_places(molecules)
    found = []
    for root in roots:
        places = []
        place = int(begin[root])
        while place >= 0:
            places.append(place)
            place = follow[place]
        at = np.array(places)
        found.append(runs(start[at], count[at]).astype(np.int32))
    return found


def facets_at_places(molecules: Molecules) -> tuple[Numbers, Numbers]:
    """Return the first facet at each corner of each molecule, and how many there are; in the order of ``corners``."""
    own = molecules.facet_molecule >= 0
    places = molecules.feet.offsets[:-1].astype(np.int64)[molecules.facet_molecule[own]] + molecules.facet_corner[own]
    count = np.bincount(places, minlength=len(molecules.feet.values))
    return np.cumsum(count) - count, count


def join_facets(molecules: Molecules, unfolded: Ints) -> tuple[Ints, Bools]:
    """Join the facets across sides that are not folded, ``(n, 2)`` vertices.

    Returns the face of every facet, named by the face's first facet, and which facets name a face of several.
    """
    on_side = np.zeros(len(molecules.vertices), dtype=np.bool_)
    on_side[unfolded] = True
    start, end = half_edges(molecules.facets)
    at = np.flatnonzero(on_side[start] & on_side[end])
    one, other = start[at], end[at]
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    keys = pair_keys(np.minimum(one, other), np.maximum(one, other))
    at = at[np.isin(keys, pair_keys(unfolded.min(axis=1), unfolded.max(axis=1)))]
    keys = pair_keys(np.minimum(start[at], end[at]), np.maximum(start[at], end[at]))
    order = np.argsort(keys, kind="stable")
    facet = np.searchsorted(molecules.facets.offsets, at[order], side="right") - 1
    pair = np.flatnonzero(keys[order][1:] == keys[order][:-1])
    some, numbers = np.unique(facet, return_inverse=True)
    graph = coo_array((np.ones(len(pair)), (numbers[pair], numbers[pair + 1])), shape=(len(some), len(some)))
    _, label = connected_components(graph, directed=False)
    lowest = np.full(label.max(initial=-1) + 1, len(molecules.facets))
    np.minimum.at(lowest, label, some)
    face = np.arange(len(molecules.facets), dtype=np.int32)
    face[some] = lowest[label]
    shared = np.zeros(len(face), dtype=np.bool_)
    shared[lowest[np.bincount(label) > 1]] = True
    return face, shared


def merge_layers(inside: Ints, outside: Ints, shared: Bools) -> Ints:
    """Merge two stacks that have the shared faces in the same order: ``assemble.merge_stacks`` on arrays."""
    in_both, out_both = shared[inside], shared[outside]
    same = np.array_equal(inside[in_both], outside[out_both])
    assert same, "the layers inside and outside do not match along the shape's boundary"
    # before each shared face come first the faces of the inside, then those of the outside
    keys = np.concatenate(
        [
            3 * (np.cumsum(in_both) - in_both) + 2 * in_both,
            3 * np.cumsum(out_both)[~out_both] + 1,
        ]
    )
    faces: Ints = np.concatenate([inside, outside[~out_both]])[np.argsort(keys, kind="stable")]
    return faces


def face_outlines(facets: Ragged, face: Ints, shared: Bools, order: Ints) -> Ragged:
    """Return the outlines of the faces in ``order``: a facet's own, or the outline of all the facets of a face."""
    joined = _joined(facets, face, shared)
    if joined is None:
        members = defaultdict(list)
        for one, its_face in enumerate(face.tolist()):
            members[its_face].append(one)
        every = [outlines([facets[f].tolist() for f in members[its_face]]) for its_face in order.tolist()]
        return Ragged.from_rows(outline for pieces in every for outline in pieces)
    # one list of outlines: first the facets, then the joined ones
    names, counts, flat = joined
    offsets = np.concatenate([facets.offsets, facets.offsets[-1] + np.cumsum(counts, dtype=np.int32)])
    number = np.arange(len(face), dtype=np.int32)
    number[names] = len(face) + np.arange(len(names))
    return Ragged(np.concatenate([facets.values, flat]), offsets).take(number[order])


def _joined(facets: Ragged, face: Ints, shared: Bools) -> tuple[Numbers, Numbers, Ints] | None:
    """The faces of several facets, how many sides each has, and their outlines; None if an outline touches itself.

    All outlines are walked at once, each from its lowest vertex.
    """
    facet = np.flatnonzero(shared[face])
    joined = facets.take(facet)
    start, end = half_edges(joined)
    owner = face[facet][joined.rows].astype(np.int64)
    # a side is inside a face that also has it in the other direction
    low, high = np.minimum(start, end), np.maximum(start, end)
    by = np.lexsort((high, low, owner))
    twice = (np.diff(owner[by]) == 0) & (np.diff(low[by]) == 0) & (np.diff(high[by]) == 0)
    gone = np.zeros(len(start), dtype=np.bool_)
    gone[by[1:][twice]] = gone[by[:-1][twice]] = True
    left = ~gone
    key, to = pair_keys(owner[left], start[left]), end[left]
    way = np.argsort(key, kind="stable")
    key, to = key[way], to[way]
    names, first, counts = np.unique(key >> 32, return_index=True, return_counts=True)
    vertex = (key[first] & 0xFFFFFFFF).astype(np.int32)
    longest = int(counts.max(initial=0))
    walked = np.full((len(names), longest), -1, dtype=np.int32)
    here = vertex.copy()
    for step in range(longest):
        going = np.flatnonzero(step < counts)
        walked[going, step] = here[going]
        at = np.searchsorted(key, pair_keys(names[going], here[going]))
        here[going] = to[np.minimum(at, len(to) - 1)]
    if not np.array_equal(here, vertex) or (np.diff(key) == 0).any() or _repeats(walked):
        return None
    return names, counts, walked[np.arange(longest) < counts[:, None]]


def _repeats(rows: Ints) -> bool:
    """Whether some row contains a number other than -1 twice."""
    ordered = np.sort(rows, axis=1)
    return bool(((ordered[:, 1:] == ordered[:, :-1]) & (ordered[:, 1:] >= 0)).any())


def sheet_corners(molecules: Molecules) -> set[int]:
    """The vertices at the corners of the sheet."""
    border = molecules.boundary_sides[molecules.boundary_sides[:, 3] == 0]
    points = molecules.vertices[border[:, 0]]
    before, after = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    sharp = turn > 0.5 * np.hypot(*before.T) * np.hypot(*after.T)
    return set(border[sharp, 0].tolist())
