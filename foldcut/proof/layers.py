"""Can the layers lie in the given order? The checks of a flat-folded state that angles cannot make.

Layer order and folded faces -> findings. Following Justin, nothing passes through anything when:

- a crease's mountain or valley is what the order of its two faces makes it;
- no face that a crease runs across lies between the crease's two faces (taco-tortilla; across an edge that is
  not folded, tortilla-tortilla);
- where two edges coincide, their faces do not interleave: ``a c b d`` with folds a-b and c-d on the same side
  (taco-taco), ``a c b`` with c running on across the fold a-b (taco-tortilla), or two unfolded sheets that
  change places (tortilla-tortilla).

One linear order of all faces is given, so that "lies over" is transitive needs no check. And a crease whose faces are
neighbours in it has nothing between them: no face, and of no other fold one face without the other. Of most patterns
that is the greater part, and it is left out.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Floats, Ints, Numbers
from foldcut.core.model import CreasePattern, Finding
from foldcut.geometry.box_tree import LayerTree
from foldcut.geometry.polygons import Outlines
from foldcut.geometry.segments import collinear_overlap
from foldcut.pattern.face_maps import FaceMaps, folded_edges

__all__ = ["check_layer_order", "check_mountains", "check_stacking"]

Indices = NDArray[np.intp]

SHORTEST_OVERLAP = 6
"""Edges coincide on at least so many tolerances of length; with less they only end at the same point."""

BATCH = 1 << 16
"""Edges, or faces, looked at together; bounds the memory, not the result."""

ENDLESS = np.iinfo(np.int32).max
"""A layer above all."""

MOST_FINDINGS = 100
"""Each kind of crossing is reported for so many creases; a shuffled order has them everywhere."""


@dataclass(frozen=True, eq=False)
class _Folds:
    """The inner edges in the folded state that something can pass through: what the crossing checks look at.

    ``edges`` ``(n,)`` are edge numbers, ``ends`` ``(n, 2, 2)`` folded, ``ranks`` ``(n, 2)`` the layers of the
    faces left and right of the edge on the sheet, ``left`` ``(n, 2)`` whether they lie left of the folded
    edge, ``folded`` ``(n,)`` mountains and valleys.
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

    Seen from above, the face that shows its upper side makes a valley with a partner above it.
    """
    rank = _ranks(layers)
    crease = np.flatnonzero(folded_edges(pattern))
    left, right = faces_of_edges[crease].T
    # a valley where the upper of two neighbours shows its lower side
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

    ``faces_of_edges`` is ``planar.edge_faces(pattern)``, ``layers`` a permutation, ``tolerance`` in mm:
    overlaps that are no deeper do not count.
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
    """Return the layer of every face, 0 at the bottom."""
    rank = np.empty(len(layers), dtype=np.int32)
    rank[layers] = np.arange(len(layers), dtype=np.int32)
    return rank


def _open_edges(pattern: CreasePattern, faces_of_edges: Ints, maps: FaceMaps, rank: Ints) -> _Folds:
    """Return the inner edges but for the creases of neighbouring layers."""
    folded = folded_edges(pattern)
    left, right = rank[faces_of_edges].T
    inner = (faces_of_edges[:, 0] >= 0) & (faces_of_edges[:, 1] >= 0)
    edges = np.flatnonzero(inner & (~folded | (np.abs(left - right) > 1)))
    faces = faces_of_edges[edges]
    ends = np.empty((len(edges), 2, 2))
    for first in range(0, len(edges), BATCH):
        some = slice(first, first + BATCH)
        ends[some] = maps.apply(faces[some, 0, None], pattern.vertices_coords[pattern.edges_vertices[edges[some]]])
    # Turning a face over swaps its sides of the edge.
    sides = maps.up[faces] == np.array([True, False])
    return _Folds(edges, ends, rank[faces], sides, folded[edges])


def _axes(folds: _Folds) -> Floats:
    """Return the directions, ``(4, 2)``, along which boxes are measured.

    Along and across the line that most creases fold onto (the spine, or the cut line), so that layers which
    only touch it do not meet the boxes of the creases on it; and the two diagonals.
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
    """Return how far the folded faces' insides reach along the axes, ``(f, k)``, low and high, by their layers."""
    faces = pattern.faces_vertices
    low, high = np.empty((2, len(faces), len(axes)))
    lengths = faces.lengths
    for count in np.flatnonzero(np.bincount(lengths)).tolist():
        alike = np.flatnonzero(lengths == count)
        batch = max(1, BATCH // count)
        for first in range(0, len(alike), batch):
            some = alike[first : first + batch]
            rows = rank[some]
            rings = faces.values[faces.offsets[some] + np.arange(count)[:, None]]
            x, y = np.moveaxis(maps.apply(some, pattern.vertices_coords[rings]), 2, 0)
            for column, (along_x, along_y) in enumerate(axes.tolist()):
                along = along_x * x + along_y * y
                low[rows, column], high[rows, column] = along.min(axis=0) + inset, along.max(axis=0) - inset
    return low, high


def _folded_faces(pattern: CreasePattern, maps: FaceMaps, faces: Numbers, tolerance: float) -> Outlines:
    """Return some faces in the folded state."""
    rings = pattern.faces_vertices.take(faces)
    corners = maps.apply(faces[rings.rows], pattern.vertices_coords[rings.values])
    return Outlines(corners, rings.offsets, tolerance)


def _meetings_between(tree: LayerTree, folds: _Folds, axes: Floats) -> Iterator[tuple[Indices, Indices]]:
    """Yield folds and layers between their faces whose boxes meet."""
    low, high = folds.low, folds.high
    for first in range(0, len(low), BATCH):
        some = slice(first, first + BATCH)
        for query, item in tree.meetings(*_extents(folds.ends[some], axes), low[some] + 1, high[some]):
            yield query + first, item


def _faces_between(
    pattern: CreasePattern,
    folds: _Folds,
    maps: FaceMaps,
    layers: Ints,
    rank: Ints,
    axes: Floats,
    tolerance: float,
) -> list[Finding]:
    """Find faces that an edge runs across while they lie between its two faces."""
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
            findings.append(_finding("taco-tortilla", pattern, edge, message))
        else:
            message = f"face {layers[layer]} cuts through the sheet of faces {one} and {other} at edge {edge}"
            findings.append(_finding("tortilla-tortilla", pattern, edge, message))
    return findings


def _interleaved_folds(pattern: CreasePattern, folds: _Folds, axes: Floats, tolerance: float) -> list[Finding]:
    """Find a fold whose two faces have, between them, one face of a coinciding edge and not the other.

    An edge that is not folded has one face on either side of the crease's line; what is on the crease's side
    may not lie between its faces at all.
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
        findings.append(_finding(check, pattern, folds.edges[first], message))
    return findings


def _meetings_of_folds(
    folds: _Folds, fold: Indices, low: Ints, high: Ints, axes: Floats, tolerance: float
) -> Iterator[tuple[Indices, Indices]]:
    """Yield, of folds sorted by their low ends, each one with those that begin within it and whose boxes meet its own.

    A last column keeps only what ends above it: in a valid state, nothing that meets its box.
    """
    box_low, box_high = np.empty((2, len(fold), len(axes) + 1))
    for first in range(0, len(fold), BATCH):
        some = slice(first, first + BATCH)
        box_low[some, :-1], box_high[some, :-1] = _boxes(folds.ends[fold[some]], axes, tolerance)
    box_low[:, -1], box_high[:, -1] = high, high
    tree = LayerTree(box_low, box_high)
    taco = np.flatnonzero(folds.folded[fold])
    for first in range(0, len(taco), BATCH):
        at = taco[first : first + BATCH]
        query_low, query_high = box_low[at], box_high[at]
        query_low[:, -1] += 1
        query_high[:, -1] = ENDLESS
        begin, end = np.searchsorted(low, low[at], side="right"), np.searchsorted(low, high[at], side="left")
        for query, item in tree.meetings(query_low, query_high, begin, end):
            yield at[query], item


def _swapped_sheets(pattern: CreasePattern, folds: _Folds, axes: Floats, tolerance: float) -> list[Finding]:
    """Find two unfolded edges that coincide, and whose sheets change places there."""
    flat = np.flatnonzero(~folds.folded)
    if not len(flat):
        return []
    flat = flat[np.argsort(folds.low[flat], kind="stable")]
    low, high = folds.low[flat], folds.high[flat]
    box_low, box_high = _boxes(folds.ends[flat], axes, tolerance)
    # Sheets can only change places where their layers overlap: search from the one that starts lower.
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
        findings.append(_finding("tortilla-tortilla", pattern, folds.edges[first], message))
    return findings


class _Reports:
    """What is wrong, once for each fold: (fold, what it conflicts with)."""

    def __init__(self) -> None:
        self._pairs: dict[int, int] = {}

    def add(self, folds: Indices, others: Indices) -> bool:
        """Note conflicts, and return whether there are enough."""
        self._pairs |= dict(zip(folds.tolist(), others.tolist(), strict=True))
        return len(self._pairs) >= MOST_FINDINGS

    def __iter__(self) -> Iterator[tuple[int, int]]:
        return islice(self._pairs.items(), MOST_FINDINGS)


def _boxes(ends: Floats, axes: Floats, tolerance: float) -> tuple[Floats, Floats]:
    """Return boxes that meet where edges coincide, and mostly not where they only end at the same point."""
    along = ends[:, 1] - ends[:, 0]
    unit = along / np.hypot(*along.T)[:, None]
    shorter = ends + 3 * tolerance * np.stack([unit, -unit], axis=1)
    low, high = _extents(shorter, axes)
    return low - tolerance, high + tolerance


def _extents(ends: Floats, axes: Floats) -> tuple[Floats, Floats]:
    """Return how far segments reach, low and high, along the axes."""
    low, high = np.empty((2, len(ends), len(axes)))
    (x, y), (to_x, to_y) = ends[:, 0].T, ends[:, 1].T
    for column, (along_x, along_y) in enumerate(axes.tolist()):
        one, other = along_x * x + along_y * y, along_x * to_x + along_y * to_y
        low[:, column], high[:, column] = np.minimum(one, other), np.maximum(one, other)
    return low, high


def _finding(check: str, pattern: CreasePattern, edge: np.integer[Any], message: str) -> Finding:
    x, y = pattern.vertices_coords[pattern.edges_vertices[edge]].mean(axis=0).tolist()
    return Finding(check, message, (x, y))
