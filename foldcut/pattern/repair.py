"""The nearest pattern whose angles fold flat exactly: for coordinates that were rounded, or drawn by hand.

Crease pattern -> the same creases with vertices moved as little as possible, so that around every inner vertex
alternate angles add up to a half turn (Kawasaki). It is found by Newton's method, each step of which is the shortest
one, so that the sum of the squared movements is least for small errors. The sheet keeps its outline: its corners stay,
and other vertices on the border stay on the line between their neighbours there.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from foldcut.core.arrays import Bools, Floats, Indices, Ints, sealed
from foldcut.core.model import CreasePattern
from foldcut.pattern.face_maps import folded_edges

if TYPE_CHECKING:
    from scipy.sparse import csr_array

__all__ = ["Repaired", "nearest_foldable"]

EXACT = 1e-13
"""Angles, in radians, fold flat if alternate ones add up to a half turn within this."""

MOST_STEPS = 12
"""More steps of Newton's method than this never help."""

STRAIGHT = 1e-3
"""A vertex of the border where it turns by less, in radians, is no corner of the sheet."""

FARTHEST = 0.1
"""A vertex that has to move farther than this part of the sheet's diagonal is not repaired."""

DAMPING = 1e-13
"""Added to the matrix of a step, relative to its diagonal: some conditions may follow from others."""


@dataclass(frozen=True, eq=False)
class Repaired:
    """A pattern whose angles fold flat, and how far each vertex was moved, ``(v,)`` mm."""

    pattern: CreasePattern
    moved: Floats

    @property
    def most(self) -> float:
        """The largest movement, in mm."""
        return float(self.moved.max(initial=0.0))

    @property
    def where(self) -> tuple[float, float]:
        """The vertex that was moved farthest, where it was moved to."""
        x, y = self.pattern.vertices_coords[int(self.moved.argmax())].tolist()
        return x, y


def nearest_foldable(pattern: CreasePattern, faces_of_edges: Ints) -> Repaired | None:
    """Return the nearest pattern that fulfils Kawasaki's condition at every inner vertex, or None if none is found.

    ``faces_of_edges`` is ``edge_faces(pattern)``. Mountains and valleys count as folded. None is found where a vertex
    has an odd number of them.
    """
    border: Bools = np.any(faces_of_edges < 0, axis=1)
    conditions = _Conditions.of(pattern, border)
    if conditions is None:
        return None
    free = _free_directions(pattern, border)
    coords = pattern.vertices_coords.copy()
    diagonal = float(np.hypot(*np.ptp(coords, axis=0)))
    for _ in range(MOST_STEPS):
        excess = conditions.excess(coords)
        if np.abs(excess).max(initial=0.0) <= EXACT:
            break
        step = _shortest_step(conditions.derivative(coords) @ free, excess)
        if step is None:
            return None
        before, coords = coords, coords + (free @ step).reshape(-1, 2)
        moved = np.hypot(*(coords - pattern.vertices_coords).T)
        if not np.isfinite(moved).all() or moved.max() > FARTHEST * diagonal:
            return None
        if np.abs(coords - before).max() <= np.finfo(np.float64).eps * diagonal:
            break
    moved = np.hypot(*(coords - pattern.vertices_coords).T)
    if np.abs(conditions.excess(coords)).max(initial=0.0) > 100 * EXACT:
        return None
    return Repaired(replace(pattern, vertices_coords=sealed(coords)), moved)


@dataclass(frozen=True, eq=False)
class _Conditions:
    """Kawasaki's conditions: ``row`` ``(n,)`` the number of the vertex's condition, for each crease at each vertex.

    ``tail`` is that vertex, ``head`` the crease's other end, ``sign`` 1 or -1 by turns around a vertex; ``first``
    ``(m,)`` is where each vertex begins.
    """

    row: Indices
    tail: Indices
    head: Indices
    sign: Floats
    first: Indices

    @classmethod
    def of(cls, pattern: CreasePattern, border: Bools) -> _Conditions | None:
        """Return the conditions of a pattern, or None where a vertex has an odd number of creases."""
        inner = np.ones(len(pattern.vertices_coords), dtype=np.bool_)
        inner[pattern.edges_vertices[border]] = False
        creases = pattern.edges_vertices[folded_edges(pattern)].astype(np.intp)
        tail, head = np.concatenate([creases, creases[:, ::-1]]).T
        kept = inner[tail]
        tail, head = tail[kept], head[kept]
        along = pattern.vertices_coords[head] - pattern.vertices_coords[tail]
        order = np.lexsort((np.arctan2(along[:, 1], along[:, 0]), tail))
        tail, head = tail[order], head[order]
        _, first, row, count = np.unique(tail, return_index=True, return_inverse=True, return_counts=True)
        if (count % 2).any():
            return None
        place = np.arange(len(tail)) - first[row]
        return cls(row, tail, head, np.where(place % 2, 1.0, -1.0), first)

    def excess(self, coords: Floats) -> Floats:
        """Return by how much every other angle around each vertex exceeds a half turn, ``(m,)``, in radians."""
        along = coords[self.head] - coords[self.tail]
        angle = np.arctan2(along[:, 1], along[:, 0])
        angle = np.where(angle < angle[self.first][self.row] - np.pi * 1e-3, angle + 2 * np.pi, angle)
        excess = np.full(len(self.first), -np.pi)
        np.add.at(excess, self.row, self.sign * angle)
        return excess

    def derivative(self, coords: Floats) -> csr_array:
        """Return how the excess grows with the coordinates of the vertices, ``(m, 2 v)``."""
        from scipy.sparse import coo_array

        along = coords[self.head] - coords[self.tail]
        square = (along * along).sum(axis=1)
        by_x, by_y = -self.sign * along[:, 1] / square, self.sign * along[:, 0] / square
        columns = [2 * self.head, 2 * self.head + 1, 2 * self.tail, 2 * self.tail + 1]
        values = np.concatenate([by_x, by_y, -by_x, -by_y])
        shape = (len(self.first), 2 * len(coords))
        return coo_array((values, (np.tile(self.row, 4), np.concatenate(columns))), shape=shape).tocsr()


def _free_directions(pattern: CreasePattern, border: Bools) -> csr_array:
    """Return the directions in which vertices may move, ``(2 v, k)``: one on the border, none at corners."""
    from scipy.sparse import coo_array

    coords, edges = pattern.vertices_coords, pattern.edges_vertices[border]
    count = len(coords)
    beside: list[list[int]] = [[] for _ in range(count)]
    for one, other in edges.tolist():
        beside[one].append(other)
        beside[other].append(one)
    rows, columns, values, width = [], [], [], 0
    for vertex, around in enumerate(beside):
        if not around:
            rows += [2 * vertex, 2 * vertex + 1]
            columns += [width, width + 1]
            values += [1.0, 1.0]
            width += 2
        elif len(around) == 2:
            one, other = coords[vertex] - coords[around[0]], coords[around[1]] - coords[vertex]
            if abs(np.arctan2(one[0] * other[1] - one[1] * other[0], one @ other)) < STRAIGHT:
                along = coords[around[1]] - coords[around[0]]
                rows += [2 * vertex, 2 * vertex + 1]
                columns += [width, width]
                values += (along / np.hypot(*along)).tolist()
                width += 1
    return coo_array((values, (rows, columns)), shape=(2 * count, width)).tocsr()


def _shortest_step(derivative: csr_array, excess: Floats) -> Floats | None:
    """Return the shortest step after which, to first order, nothing is in excess; None if there is none."""
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import splu

    square = (derivative @ derivative.T).tocsc()
    diagonal = square.diagonal()
    if not len(diagonal) or diagonal.min() <= 0:
        return None
    try:
        weights = splu((square + diags_array(DAMPING * diagonal)).tocsc()).solve(-excess)
    except RuntimeError:  # singular
        return None
    step: Floats = derivative.T @ weights
    return step
