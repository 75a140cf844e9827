"""Whether layers can lie as an order of pairs says: for orders that need not be one list from bottom to top.

Pairs of faces, the upper one first -> findings. In a square twist, four pleats lie on each other in a circle, so no
list of layers describes it; above and below is transitive only where faces share a place. The conditions are those of
``proof.layers``, asked of pairs:

- faces that lie on each other have an order, and only one;
- each crease is the mountain or valley that the order of its two faces makes it;
- a face that an inner edge runs across is above both faces of that edge or below both;
- where two edges coincide, their faces do not interleave or change places;
- no three faces that share a place lie on each other in a circle.

This relies on nothing that found the order; it finds all pairs, crossings and circles anew, mostly by other means.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import shapely
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Indices, Ints, Numbers
from foldcut.core.model import CreasePattern, Finding
from foldcut.geometry.polygons import Outlines
from foldcut.geometry.segments import collinear_overlap
from foldcut.pattern.face_maps import FaceMaps, folded_edges
from foldcut.pattern.overlaps import overlaps
from foldcut.proof.findings import at_edge, finding
from foldcut.proof.layers import MOST_FINDINGS, SHORTEST_OVERLAP

__all__ = ["check_pairs"]

MOST_PAIRS = 5_000_000
"""Orders of more pairs of faces than this are not judged."""

TRIMMED = 3
"""How many tolerances are left out at each end of an edge when it is looked what it crosses."""

BOTH_WAYS = "faces {} and {} lie on each other both ways round; give one order"

Orders = NDArray[np.int8]


def check_pairs(
    pattern: CreasePattern, faces_of_edges: Ints, maps: FaceMaps, pairs: Numbers, tolerance: float
) -> list[Finding]:
    """Find all that keeps layers from lying as ``pairs`` ``(n, 2)`` say, in each of which the first face is above.

    ``faces_of_edges`` is ``edge_faces(pattern)``, ``maps`` is ``fold_faces`` of both. Overlaps that are no deeper than
    ``tolerance``, in mm, do not count.
    """
    judge = _Judge(pattern, faces_of_edges, maps, pairs, tolerance)
    return [found for check in (judge.pairs, judge.mountains, judge.edges, judge.circles) for found in _few(check())]


def _few(findings: Iterator[Finding]) -> list[Finding]:
    return [found for found, _ in zip(findings, range(MOST_FINDINGS), strict=False)]


class _Judge:
    """One order of one folded pattern: ``over[f, g]`` is 1 if f is above g, -1 if below, 0 if nothing is said."""

    def __init__(
        self, pattern: CreasePattern, faces_of_edges: Ints, maps: FaceMaps, pairs: Numbers, tolerance: float
    ) -> None:
        self.pattern, self.maps, self.tolerance = pattern, maps, tolerance
        self.count = len(pattern.faces_vertices)
        self.given = pairs
        self.over: Orders = np.zeros((self.count, self.count), dtype=np.int8)
        upper, lower = pairs.T
        self.over[lower, upper] = -1
        self.over[upper, lower] = 1
        self.inner: Indices = np.flatnonzero((faces_of_edges >= 0).all(axis=1))
        self.beside = faces_of_edges[self.inner]
        self.ends = maps.apply(self.beside[:, :1], pattern.vertices_coords[pattern.edges_vertices[self.inner]])
        self.folded: Bools = folded_edges(pattern)[self.inner]
        face = np.zeros(len(pattern.vertices_coords), dtype=np.int32)
        face[pattern.faces_vertices.values] = pattern.faces_vertices.rows
        places = maps.apply(face, pattern.vertices_coords)
        self.overlapping = overlaps(places, pattern.faces_vertices, 2 * tolerance, MOST_PAIRS)
        outlines = pattern.faces_vertices
        corners = maps.apply(outlines.rows, pattern.vertices_coords[outlines.values])
        self.outlines = Outlines(corners, outlines.offsets, tolerance)
        self.faces = shapely.polygons(shapely.linearrings(corners, indices=outlines.rows))

    def pairs(self) -> Iterator[Finding]:
        """Find pairs that have two orders, and faces that lie on each other without one."""
        upper, lower = self.given.T
        for at in np.flatnonzero((self.over[upper, lower] != 1) | (self.over[lower, upper] != -1)).tolist():
            yield self.at_face(int(upper[at]), "layers", BOTH_WAYS.format(upper[at], lower[at]))
        if self.overlapping is None:
            yield Finding("layers", f"more than {MOST_PAIRS:,} pairs of faces lie on each other: too many to judge")
            return
        for one, other in self.overlapping[self.over[tuple(self.overlapping.T)] == 0].tolist():
            yield self.at_face(one, "layers", f"faces {one} and {other} lie on each other, and have no order")

    def mountains(self) -> Iterator[Finding]:
        """Find creases that the order of their faces folds the other way."""
        left, right = self.beside.T
        valley = (self.over[right, left] > 0) == self.maps.up[left]
        letters = self.pattern.edges_assignment[self.inner]
        for at in np.flatnonzero(self.folded & (valley != (letters == "V"))).tolist():
            message = f"edge {self.inner[at]} is {letters[at]}, but the order of its faces folds it the other way"
            yield at_edge(self.pattern, self.inner[at], "mountain-valley", message)

    def edges(self) -> Iterator[Finding]:
        """Find faces that lie across edges, and edges that interleave where they coincide."""
        yield from self._crossings()
        (one, other), aligned = self._coinciding()
        a, b = self.beside[one].T
        c, d = self.beside[other].T
        ac, ad, bc, bd = (self.over[pair] for pair in ((a, c), (a, d), (b, c), (b, d)))
        folds = self.folded[one].astype(int) + self.folded[other]
        bad = (folds == 2) & aligned & (ac * bc * ad * bd < 0)
        # the faces beside each other: a and c, b and d if aligned, or else a and d, b and c
        bad |= (folds == 0) & np.where(aligned, ac != bd, ad != bc)
        fold_first = self.folded[one]
        beside_fold = np.where(fold_first, np.where(aligned, ac != bc, ad != bd), np.where(aligned, ac != ad, bc != bd))
        bad |= (folds == 1) & beside_fold
        for at in np.flatnonzero(bad).tolist():
            edges = f"edges {self.inner[one[at]]} and {self.inner[other[at]]}"
            check = ("tortilla-tortilla", "taco-tortilla", "taco-taco")[folds[at]]
            yield at_edge(self.pattern, self.inner[one[at]], check, f"the faces of {edges} interleave there")

    def _crossings(self) -> Iterator[Finding]:
        """Find faces that an edge runs across and that lie between its two faces."""
        left, right = self.beside.T
        edge, face = np.nonzero(self.over[left] != self.over[right])  # only such may lie between
        apart = (self.beside[edge] != face[:, None]).all(axis=1)
        edge, face = edge[apart], face[apart]
        along = self.ends[:, 1] - self.ends[:, 0]
        length = np.hypot(*along.T)
        trim = (np.minimum(TRIMMED * self.tolerance, length / 3) / length)[:, None] * along
        lines = np.stack([self.ends[:, 0] + trim, self.ends[:, 1] - trim], axis=1)
        bad = self.outlines.crossed(lines[edge], face)
        for number, other in zip(edge[bad].tolist(), face[bad].tolist(), strict=True):
            check = "taco-tortilla" if self.folded[number] else "tortilla-tortilla"
            message = f"face {other} runs across edge {self.inner[number]}, between its two faces"
            yield at_edge(self.pattern, self.inner[number], check, message)

    def _coinciding(self) -> tuple[tuple[Indices, Indices], Bools]:
        """Return pairs of edges that coincide, and whether their left faces lie on the same side there."""
        lines = shapely.linestrings(self.ends)
        tree = shapely.STRtree(lines)
        one, other = tree.query(lines, predicate="dwithin", distance=2 * self.tolerance)
        one, other = one[one < other], other[one < other]
        length, same_way = collinear_overlap(self.ends[one], self.ends[other], 2 * self.tolerance)
        kept = length > SHORTEST_OVERLAP * self.tolerance
        kept &= (self.beside[one][:, :, None] != self.beside[other][:, None, :]).all(axis=(1, 2))
        one, other, same_way = one[kept], other[kept], same_way[kept]
        left = self.maps.up[self.beside[:, 0]]
        return (one, other), (left[one] == left[other]) == same_way

    def circles(self) -> Iterator[Finding]:
        """Find three faces that share a place and lie on each other in a circle."""
        above = self.over > 0
        dense = above.astype(np.float32)
        closing = ((dense @ dense) > 0) & above.T  # from a, back to a by one face between
        for a in np.flatnonzero(closing.any(axis=1)).tolist():
            last = np.flatnonzero(closing[a])
            last = last[last > a]
            between = np.flatnonzero(above[a])
            between = between[between > a]
            b, c = np.nonzero(above[np.ix_(between, last)])
            b, c = between[b], last[c]
            common = shapely.intersection(shapely.intersection(self.faces[a], self.faces[b]), self.faces[c])
            room = ~shapely.is_empty(shapely.buffer(common, -self.tolerance))
            for at in np.flatnonzero(room).tolist():
                message = f"faces {a}, {b[at]} and {c[at]} share a place and lie on each other in a circle"
                yield self.at_face(a, "layers", message)

    def at_face(self, face: int, check: str, message: str) -> Finding:
        """Return a finding in the middle of a face."""
        return finding(check, message, self.pattern.vertices_coords[self.pattern.faces_vertices[face]].mean(axis=0))
