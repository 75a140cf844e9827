"""Face maps: where each face of a crease pattern folds to, from its creases alone.

Face 0 stays where it is. Every other face is reached from it across edges: it is mirrored at mountains and valleys, and
moves along at edges that are not folded. Whether the result is consistent is left to ``verify``.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Floats, Ints, Numbers
from foldcut.core.model import CreasePattern
from foldcut.geometry.planar_graph import edge_lengths

__all__ = ["FaceMaps", "compiled_fold", "fold_faces", "folded_edges", "short_paths"]

FEW_FACES = 3000
"""Up to this many faces, finding the paths takes less time than importing scipy."""

MANY_FACES = 100_000
"""From this many faces on, compiled code saves more time than loading it takes.

It takes another tree of faces, so the last bits differ: this does not depend on ``COMPILED``.
"""

TINY = float(np.finfo(np.float64).tiny)
"""Edges no longer than this have no direction."""


@dataclass(frozen=True, eq=False)
class FaceMaps:
    """The isometry of every face: z -> ``turn * z + shift``, with the conjugate of z if the face is turned over.

    ``turn`` and ``shift`` are ``(f,)`` complex; ``up`` ``(f,)``: whether the face shows the same side as face 0.
    """

    turn: NDArray[np.complex128]
    shift: NDArray[np.complex128]
    up: Bools

    def apply(self, faces: NDArray[np.integer[Any]], points: Floats) -> Floats:
        """Return where ``points``, ``(..., 2)``, of the sheet fold to as points of ``faces``, ``(...,)``."""
        z = np.empty(points.shape[:-1], dtype=np.complex128)
        z.real = points[..., 0]
        np.multiply(points[..., 1], np.where(self.up[faces], 1.0, -1.0), out=z.imag)
        z *= self.turn[faces]
        z += self.shift[faces]
        return z.view(np.float64).reshape(points.shape)


def folded_edges(pattern: CreasePattern) -> Bools:
    """Return which edges are folded, ``(e,)``: the mountains and valleys."""
    return np.isin(pattern.edges_assignment, ("M", "V"))


def fold_faces(pattern: CreasePattern, faces_of_edges: Ints) -> FaceMaps:
    """Return the map of every face, face 0 staying in place.

    ``faces_of_edges`` is ``planar_graph.edge_faces(pattern)``. Faces that no path joins to face 0 stay, too.
    """
    count = len(pattern.faces_vertices)
    if count >= MANY_FACES and (compiled := compiled_fold()):
        return _fold_with(compiled, pattern, faces_of_edges, count)
    parent, via = _steady_tree(pattern, faces_of_edges, count)
    ends = pattern.vertices_coords[pattern.edges_vertices]
    tail = ends[:, 0, 0] + 1j * ends[:, 0, 1]
    head = ends[:, 1, 0] + 1j * ends[:, 1, 1]
    length = np.abs(head - tail)
    axis = np.divide(head - tail, length, out=np.ones_like(tail), where=length > TINY)
    mirror = axis * axis
    offset = tail - mirror * tail.conj()  # the reflection is z -> mirror * conj(z) + offset
    folds = folded_edges(pattern)

    turn = np.ones(count, dtype=np.complex128)
    shift = np.zeros(count, dtype=np.complex128)
    up = np.ones(count, dtype=np.bool_)
    for face, before, edge in _generations(parent[0], parent[1], via, count):
        turn[face], shift[face], up[face] = turn[before], shift[before], up[before]
        fold = folds[edge]
        face, before, edge = face[fold], before[fold], edge[fold]
        m, c = mirror[edge], offset[edge]
        down = ~up[before]
        m[down], c[down] = m[down].conj(), c[down].conj()
        turned = turn[before] * m
        turn[face] = turned / np.abs(turned)
        shift[face] = turn[before] * c + shift[before]
        up[face] = down
    return FaceMaps(turn, shift, up)


def compiled_fold() -> Callable[..., None] | None:
    """Return the function that folds faces in compiled code, or None where numba does not work."""
    try:
        from foldcut.pattern.face_maps_compiled import fold
    except ImportError:
        return None
    found: Callable[..., None] = fold
    return found


def _fold_with(fold: Callable[..., None], pattern: CreasePattern, faces_of_edges: Ints, count: int) -> FaceMaps:
    """Fold faces with compiled code."""
    turn, shift = np.ones(count, dtype=np.complex128), np.zeros(count, dtype=np.complex128)
    up = np.ones(count, dtype=np.bool_)
    left, right = np.ascontiguousarray(faces_of_edges.T)
    pairs = (turn.view(np.float64).reshape(-1, 2), shift.view(np.float64).reshape(-1, 2))
    # compiled code is made for arrays that may be written to, so none may be read-only
    edges, coords = pattern.edges_vertices.copy(), pattern.vertices_coords.copy()
    fold(left, right, edges, coords, folded_edges(pattern), *pairs, up, TINY)
    return FaceMaps(turn, shift, up)


def _generations(face: Ints, before: Ints, via: Ints, count: int) -> Iterator[tuple[Ints, Ints, Ints]]:
    """Yield the rows of a tree, one generation after the other, parents first."""
    # count the steps to the root, going twice as far in every round
    ancestor, steps = np.arange(count), np.zeros(count, dtype=np.intp)
    ancestor[face], steps[face] = before, 1
    while steps[ancestor].any():
        steps, ancestor = steps + steps[ancestor], ancestor[ancestor]
    order = np.argsort(steps[face], kind="stable")
    ends = np.cumsum(np.bincount(steps[face]))
    for start, end in pairwise(ends.tolist()):
        rows = order[start:end]
        yield face[rows], before[rows], via[rows]


def _steady_tree(pattern: CreasePattern, faces_of_edges: Ints, count: int) -> tuple[tuple[Ints, Ints], Ints]:
    """Return ((face, the face before it), the edge between them), nearest to face 0 first.

    A crease of length l turns everything behind it by a rounding error of about 1 / l. So the tree minimises the sum
    of 1 / l: it takes few steps, across long creases.
    """
    inner = np.flatnonzero((faces_of_edges >= 0).all(axis=1))
    cost = 1 / np.maximum(edge_lengths(pattern)[inner], TINY)
    low, high = np.sort(faces_of_edges[inner], axis=1).T.astype(np.int64)
    pair = low * count + high
    order = np.argsort(pair, kind="stable")
    if (np.diff(pair[order]) == 0).any():
        order = np.lexsort((cost, pair))
    best = order[np.diff(pair[order], prepend=-1) != 0]  # the longest edge of two faces
    paths = short_paths if count <= FEW_FACES else paths_by_scipy
    distance, before = paths(low[best], high[best], cost[best], count)
    face = np.argsort(distance, kind="stable").astype(np.int32)
    face = face[before[face] >= 0]
    via = np.full(count, -1, dtype=np.int64)
    for child, above in ((low[best], high[best]), (high[best], low[best])):
        mine = before[child] == above
        via[child[mine]] = inner[best[mine]]
    return (face, before[face].astype(np.int32)), via[face].astype(np.int32)


def short_paths(low: Numbers, high: Numbers, cost: Floats, count: int) -> tuple[Floats, Numbers]:
    """Return how far each of ``count`` nodes is from node 0, and its predecessor, -1 for none (Dijkstra's algorithm).

    Node ``low[k]`` is joined to ``high[k]`` at ``cost[k]``.
    """
    beside: list[list[tuple[int, float]]] = [[] for _ in range(count)]
    for one, other, price in zip(low.tolist(), high.tolist(), cost.tolist(), strict=True):
        beside[one].append((other, price))
        beside[other].append((one, price))
    distance, before = [math.inf] * count, [-1] * count
    distance[0] = 0.0
    waiting = [(0.0, 0)]
    while waiting:
        far, node = heapq.heappop(waiting)
        if far > distance[node]:
            continue
        for other, price in beside[node]:
            if far + price < distance[other]:
                distance[other], before[other] = far + price, node
                heapq.heappush(waiting, (far + price, other))
    return np.array(distance), np.array(before, dtype=np.intp)


def paths_by_scipy(low: Numbers, high: Numbers, cost: Floats, count: int) -> tuple[Floats, Numbers]:
    """Do the same for many nodes with scipy; of two paths of equal length it may choose the other."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import dijkstra

    graph = coo_array((cost, (low, high)), shape=(count, count)).tocsr()
    distance, before = dijkstra(graph, directed=False, indices=[0], return_predecessors=True)
    return distance[0], before[0]
