"""Whether the layers can lie in the given order: what angles around vertices cannot tell.

Layer order and maps of the faces -> findings. After Justin, nothing passes through anything if:

- each crease is the mountain or valley that the order of its two faces makes it;
- no face that a crease runs across lies between the two faces of the crease (taco-tortilla), and no face lies across
  an unfolded edge between its two faces (tortilla-tortilla);
- where two edges coincide, their faces do not interleave: not ``a c b d`` with folds a-b and c-d on the same side
  (taco-taco), nor ``a c b`` where c runs on across the fold a-b (taco-tortilla), nor two pairs of faces at unfolded
  edges that change places (tortilla-tortilla).

The layer order is one linear order of all faces, so transitivity needs no check. A crease whose faces are neighbours
in it has nothing between them: no face, and not just one of the two faces of another fold. Most creases of most
patterns are like that, and they are left out.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np

from foldcut.core.arrays import Bools, Floats, Indices, Ints, Numbers, blocks
from foldcut.core.model import CreasePattern, Finding
from foldcut.geometry.box_tree import LayerTree
from foldcut.geometry.polygons import Outlines
from foldcut.geometry.segments import collinear_overlap
from foldcut.pattern.face_maps import FaceMaps, folded_edges
from foldcut.proof.findings import at_edge

__all__ = ["check_layer_order", "check_mountains", "check_stacking"]

SHORTEST_OVERLAP = 6
"""Edges coincide if they overlap by at least this many tolerances; with less, they only end at the same point."""

BATCH = 1 << 16
"""The number of edges handled at a time; it bounds the memory, not the result."""

ENDLESS = np.iinfo(np.int32).max
"""A number above that of every layer."""

MOST_FINDINGS = 100
"""Each kind of crossing is reported for this many creases at most; a shuffled order has them everywhere."""


@dataclass(frozen=True, eq=False)
class _Folds:
    """The inner edges, in the folded state, that something may pass through.

    ``edges`` ``(n,)`` are edge numbers, ``ends`` ``(n, 2, 2)`` where they land. ``ranks`` ``(n, 2)`` are the layers of
    the faces left and right of the edge on the sheet, and ``left`` ``(n, 2)`` tells whether these lie left of the
    folded edge. ``folded`` ``(n,)`` marks the mountains and valleys.
    """

    edges: Indices
    ends: Floats
    ranks: Ints
    left: Bools
    folded: Bools

    @property
    def low(self) -> Ints:
        """The lower of the two layers."""
        low: Ints = np.minimum(self.ranks[:, 0], self.ranks[:, 1])
        return low

    @property
    def high(self) -> Ints:
        """The upper of the two layers."""
        high: Ints = np.maximum(self.ranks[:, 0], self.ranks[:, 1])
        return high


def check_layer_order(layers: Ints, face_count: int) -> list[Finding]:
    """Find faces that the layer order leaves out or repeats."""
    layers = np.asarray(layers)
    if layers.ndim == 1 and np.array_equal(np.sort(layers), np.arange(face_count)):
        return []
    return [
        Finding(
            "layers",
            f"the layer order is not a permutation of the {face_count} faces; name each face exactly once",
            size=float(abs(layers.size - face_count)),
        )
    ]


def check_mountains(pattern: CreasePattern, faces_of_edges: Ints, maps: FaceMaps, layers: Ints) -> list[Finding]:
    """Find creases whose assignment is not what the layer order makes them.

    Seen from above, a face that shows its front makes a valley with a neighbour that lies above it.
    """
    rank = _ranks(layers)
    crease = np.flatnonzero(folded_edges(pattern))
    left, right = faces_of_edges[crease].T
    # At a valley, the upper of the two faces shows its back.
    valley = (rank[left] < rank[right]) == maps.up[left]
    wrong = np.flatnonzero(valley != (pattern.edges_assignment[crease] == "V"))
    findings = []
    for at in wrong.tolist():
        edge = crease[at]
        x, y = pattern.vertices_coords[pattern.edges_vertices[edge]].mean(axis=0)
        message = (
            f"edge {edge} is {pattern.edges_assignment[edge]}, but the order of its faces {left[at]} and "
            f"{right[at]} folds it {'V' if valley[at] else 'M'}; swap the layers or the assignment"
        )
        findings.append(Finding("mountain-valley", message, (float(x), float(y))))
    return findings


def check_stacking(
    pattern: CreasePattern, faces_of_edges: Ints, maps: FaceMaps, layers: Ints, tolerance: float
) -> list[Finding]:
    """Find layers that pass through each other.

    ``faces_of_edges`` is ``edge_faces(pattern)``, ``maps`` is ``fold_faces`` of both, and ``layers`` is a permutation.
    Overlaps that are no deeper than ``tolerance``, in mm, do not count.
    """
    rank = _ranks(layers)
    folds = _open_edges(pattern, faces_of_edges, maps, rank)
    if not len(folds.edges):
        return []
    axes = _axes(folds)
    return [
        *_faces_between(pattern, folds, maps, layers, rank, axes, tolerance),
        *_interleaved_folds(pattern, folds, axes, tolerance),
        *_swapped_sheets(pattern, folds, axes, tolerance),
    ]


def _ranks(layers: Ints) -> Ints:
    """Return the layer of every face, ``(f,)``, 0 at the bottom."""
    rank = np.empty(len(layers), dtype=np.int32)
    rank[layers] = np.arange(len(layers), dtype=np.int32)
    return rank


def _open_edges(pattern: CreasePattern, faces_of_edges: Ints, maps: FaceMaps, rank: Ints) -> _Folds:
    """Return the inner edges, except creases between neighbouring layers."""
    folded = folded_edges(pattern)
    left, right = rank[faces_of_edges].T
    inner = (faces_of_edges[:, 0] >= 0) & (faces_of_edges[:, 1] >= 0)
    edges = np.flatnonzero(inner & (~folded | (np.abs(left - right) > 1)))
    faces = faces_of_edges[edges]
    ends = np.empty((len(edges), 2, 2))
    for some in blocks(len(edges), BATCH):
        ends[some] = maps.apply(faces[some, 0, None], pattern.vertices_coords[pattern.edges_vertices[edges[some]]])
    # Turning a face over swaps its sides of the edge.
    sides = maps.up[faces] == np.array([True, False])
    return _Folds(edges, ends, rank[faces], sides, folded[edges])


def _axes(folds: _Folds) -> Floats:
    """Return the directions, ``(4, 2)``, along which boxes are measured.

    Two run along and across the direction in which the folded creases are longest altogether (that of the spine or the
    cut line), so that layers which only touch that line do not meet the boxes of the creases on it. The others are the
    two diagonals between them.
    """
    along = folds.ends[:, 1] - folds.ends[:, 0]
    length = np.hypot(*along.T)
    turn = np.arctan2(along[:, 1], along[:, 0]) % np.pi
    bins = np.minimum((turn * (4096 / np.pi)).astype(np.intp), 4095)
    common = np.flatnonzero(bins == np.bincount(bins, weights=length).argmax())
    best = common[length[common].argmax()]
    x, y = along[best] / length[best]
    half = np.sqrt(0.5)
    return np.array([(x, y), (-y, x), ((x - y) * half, (x + y) * half), ((x + y) * half, (y - x) * half)])


def _bounds(pattern: CreasePattern, maps: FaceMaps, rank: Ints, axes: Floats, inset: float) -> tuple[Floats, Floats]:
    """Return how far the folded faces reach along the axes, in the order of their layers.

    The result is low and high, each ``(f, k)``; ``inset`` is taken off at both ends.
    """
    faces = pattern.faces_vertices
    low, high = np.empty((2, len(faces), len(axes)))
    for some, outlines in faces.alike():
        rows = rank[some]
        x, y = np.moveaxis(maps.apply(some, pattern.vertices_coords[outlines]), 2, 0)
        for column, (along_x, along_y) in enumerate(axes.tolist()):
            along = along_x * x + along_y * y
            low[rows, column], high[rows, column] = along.min(axis=0) + inset, along.max(axis=0) - inset
    return low, high


def _folded_faces(pattern: CreasePattern, maps: FaceMaps, faces: Numbers, tolerance: float) -> Outlines:
    """Return some faces, ``(n,)``, in the folded state."""
    outlines = pattern.faces_vertices.take(faces)
    corners = maps.apply(faces[outlines.rows], pattern.vertices_coords[outlines.values])
    return Outlines(corners, outlines.offsets, tolerance)


def _meetings_between(tree: LayerTree, folds: _Folds, axes: Floats) -> Iterator[tuple[Indices, Indices]]:
    """Yield pairs of a fold and a layer between its faces whose boxes meet."""
    low, high = folds.low, folds.high
    for some in blocks(len(low), BATCH):
        for query, item in tree.meetings(*_extents(folds.ends[some], axes), low[some] + 1, high[some]):
            yield query + some.start, item


def _faces_between(
    pattern: CreasePattern,
    folds: _Folds,
    maps: FaceMaps,
    layers: Ints,
    rank: Ints,
    axes: Floats,
    tolerance: float,
) -> list[Finding]:
    """Find faces that lie across an edge and between its two faces."""
    tree = LayerTree(*_bounds(pattern, maps, rank, axes, tolerance))
    reports = _Reports()
    for query, item in _meetings_between(tree, folds, axes):
        faces, number = np.unique(layers[item], return_inverse=True)
        bad = _folded_faces(pattern, maps, faces, tolerance).crossed(folds.ends[query], number)
        if reports.add(query[bad], item[bad]):
            break
    findings = []
    for fold, layer in reports:
        one, other = layers[folds.low[fold]], layers[folds.high[fold]]
        edge = folds.edges[fold]
        if folds.folded[fold]:
            message = f"face {layers[layer]} runs across crease {edge}, between its faces {one} and {other}"
            findings.append(at_edge(pattern, edge, "taco-tortilla", message))
        else:
            message = f"face {layers[layer]} cuts through the sheet of faces {one} and {other} at edge {edge}"
            findings.append(at_edge(pattern, edge, "tortilla-tortilla", message))
    return findings


def _interleaved_folds(pattern: CreasePattern, folds: _Folds, axes: Floats, tolerance: float) -> list[Finding]:
    """Find folds between whose two faces there is one face of a coinciding edge, but not the other one.

    An unfolded edge has one face on either side of the line of the crease. The one on the same side as the faces of the
    crease may not lie between these at all.
    """
    flat = np.repeat(np.flatnonzero(~folds.folded), 2)
    taco = np.flatnonzero(folds.folded)
    fold = np.concatenate([taco, flat])
    side = np.tile([0, 1], len(flat) // 2)
    low = np.concatenate([folds.low[taco], folds.ranks[flat, side]])
    high = np.concatenate([folds.high[taco], np.full(len(flat), ENDLESS)])
    left = np.concatenate([folds.left[taco, 0], folds.left[flat, side]])
    order = np.argsort(low)
    fold, low, high, left = fold[order], low[order], high[order], left[order]
    reports = _Reports()
    for one, other in _meetings_of_folds(folds, fold, low, high, axes, tolerance):
        length, same_way = collinear_overlap(folds.ends[fold[one]], folds.ends[fold[other]], 2 * tolerance)
        same_side = (left[one] == left[other]) == same_way
        bad = (length > SHORTEST_OVERLAP * tolerance) & same_side & (high[one] < high[other])
        if reports.add(fold[one[bad]], fold[other[bad]]):
            break
    findings = []
    for first, second in reports:
        check = "taco-taco" if folds.folded[second] else "taco-tortilla"
        message = f"the faces of edges {folds.edges[first]} and {folds.edges[second]} interleave where they coincide"
        findings.append(at_edge(pattern, folds.edges[first], check, message))
    return findings


def _meetings_of_folds(
    folds: _Folds, fold: Indices, low: Ints, high: Ints, axes: Floats, tolerance: float
) -> Iterator[tuple[Indices, Indices]]:
    """Yield pairs of folds, sorted by their low layers: the second begins within the first, and their boxes meet.

    The last column of the boxes keeps only the second folds that end above the first: in a valid state, none meets it.
    """
    box_low, box_high = np.empty((2, len(fold), len(axes) + 1))
    for some in blocks(len(fold), BATCH):
        box_low[some, :-1], box_high[some, :-1] = _boxes(folds.ends[fold[some]], axes, tolerance)
    box_low[:, -1], box_high[:, -1] = high, high
    tree = LayerTree(box_low, box_high)
    taco = np.flatnonzero(folds.folded[fold])
    for some in blocks(len(taco), BATCH):
        at = taco[some]
        query_low, query_high = box_low[at], box_high[at]
        query_low[:, -1] += 1
        query_high[:, -1] = ENDLESS
        begin, end = np.searchsorted(low, low[at], side="right"), np.searchsorted(low, high[at], side="left")
        for query, item in tree.meetings(query_low, query_high, begin, end):
            yield at[query], item


def _swapped_sheets(pattern: CreasePattern, folds: _Folds, axes: Floats, tolerance: float) -> list[Finding]:
    """Find pairs of unfolded edges that coincide, where the faces of one and of the other change places."""
    flat = np.flatnonzero(~folds.folded)
    if not len(flat):
        return []
    flat = flat[np.argsort(folds.low[flat], kind="stable")]
    low, high = folds.low[flat], folds.high[flat]
    box_low, box_high = _boxes(folds.ends[flat], axes, tolerance)
    # They can only change places where their layers overlap: search from the edge whose layers start lower.
    meetings = LayerTree(box_low, box_high).meetings(
        box_low, box_high, np.searchsorted(low, low, side="right"), np.searchsorted(low, high, side="left")
    )
    reports = _Reports()
    for query, item in meetings:
        one, other = flat[query], flat[item]
        length, same_way = collinear_overlap(folds.ends[one], folds.ends[other], 2 * tolerance)
        aligned = (folds.left[one, 0] == folds.left[other, 0]) == same_way
        beside = np.where(aligned[:, None], folds.ranks[other], folds.ranks[other][:, ::-1])
        below = folds.ranks[one] < beside
        bad = (length > SHORTEST_OVERLAP * tolerance) & (below[:, 0] != below[:, 1])
        if reports.add(one[bad], other[bad]):
            break
    findings = []
    for first, second in reports:
        edges = f"edges {folds.edges[first]} and {folds.edges[second]}"
        message = f"the sheets at {edges} change places where they coincide"
        findings.append(at_edge(pattern, folds.edges[first], "tortilla-tortilla", message))
    return findings


class _Reports:
    """The conflicts found so far, one for each fold: pairs of a fold and what it conflicts with."""

    def __init__(self) -> None:
        self._pairs: dict[int, int] = {}

    def add(self, folds: Indices, others: Indices) -> bool:
        """Add conflicts, and return whether there are enough."""
        self._pairs |= dict(zip(folds.tolist(), others.tolist(), strict=True))
        return len(self._pairs) >= MOST_FINDINGS

    def __iter__(self) -> Iterator[tuple[int, int]]:
        return islice(self._pairs.items(), MOST_FINDINGS)


def _boxes(ends: Floats, axes: Floats, tolerance: float) -> tuple[Floats, Floats]:
    """Return boxes that meet if edges coincide, and mostly do not if edges only end at the same point."""
    along = ends[:, 1] - ends[:, 0]
    unit = along / np.hypot(*along.T)[:, None]
    shorter = ends + 3 * tolerance * np.stack([unit, -unit], axis=1)
    low, high = _extents(shorter, axes)
    return low - tolerance, high + tolerance


def _extents(ends: Floats, axes: Floats) -> tuple[Floats, Floats]:
    """Return how far segments, ``(n, 2, 2)``, reach along the axes: low and high, each ``(n, k)``."""
    low, high = np.empty((2, len(ends), len(axes)))
    (x, y), (to_x, to_y) = ends[:, 0].T, ends[:, 1].T
    for column, (along_x, along_y) in enumerate(axes.tolist()):
        one, other = along_x * x + along_y * y, along_x * to_x + along_y * to_y
        low[:, column], high[:, column] = np.minimum(one, other), np.maximum(one, other)
    return low, high
