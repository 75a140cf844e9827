"""Plane graphs: half-edges, the two faces of every edge, and faces traced from the edges alone.

A half-edge is one side of one face, walked with the face on its left. In a proper crease pattern the two
half-edges of a crease point in opposite directions and each appears once.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from foldcut.core.arrays import Floats, Indices, Ints, Numbers, Ragged
from foldcut.core.model import CreasePattern

__all__ = [
    "edge_faces",
    "edge_lengths",
    "edge_sides",
    "faces_of_sides",
    "following_half_edges",
    "half_edges",
    "pair_keys",
    "signed_areas",
    "trace_faces",
]

Keys = NDArray[np.int64]

BATCH = 1 << 13
"""How many edges are measured together; it bounds the memory and does not change the result."""

MANY_EDGES = 6000
"""With more edges, scipy's sparse matrix saves more time than importing scipy takes."""


def half_edges(faces: Ragged) -> tuple[Ints, Ints]:
    """Return the start and end vertex of every side, each ``(m,)``, in the order of ``faces.values``.

    No face may be empty.
    """
    return faces.values, faces.values[faces.following]


def pair_keys(start: Numbers, end: Numbers) -> Keys:
    """Return one number for each directed pair of vertices."""
    return (start.astype(np.int64) << 32) | end


def edge_lengths(pattern: CreasePattern) -> Floats:
    """Return the length of every edge, ``(e,)``."""
    edges = pattern.edges_vertices
    lengths = np.empty(len(edges))
    for first in range(0, len(edges), BATCH):
        tail, head = edges[first : first + BATCH].T
        along = pattern.vertices_coords[head] - pattern.vertices_coords[tail]
        np.hypot(along[:, 0], along[:, 1], out=lengths[first : first + BATCH])
    return lengths


def edge_faces(pattern: CreasePattern) -> Ints:
    """Return the faces on the left and on the right of every edge, ``(e, 2)``, -1 where there is none.

    Left and right as seen from ``edges_vertices[:, 0]`` to ``edges_vertices[:, 1]``, on the sheet.
    """
    return faces_of_sides(pattern, edge_sides(pattern))


def edge_sides(pattern: CreasePattern) -> Numbers:
    """Return the half-edges on the left and on the right of every edge, ``(e, 2)``, -1 where there is none.

    Half-edges are places in ``half_edges(faces_vertices)``; if several are equal, any of them may be returned.
    """
    start, end = half_edges(pattern.faces_vertices)
    if len(pattern.edges_vertices) > MANY_EDGES and min(start.min(), pattern.edges_vertices.min()) >= 0:
        from scipy.sparse import coo_array

        size = max(start.max(), pattern.edges_vertices.max()) + 1
        number = np.arange(1, len(start) + 1, dtype=np.int32)
        matrix = coo_array((number, (start, end)), shape=(size, size)).tocsr()
        if matrix.nnz == len(start):  # otherwise equal half-edges have been added up
            tail, head = pattern.edges_vertices.T
            return np.stack([matrix[tail, head], matrix[head, tail]], axis=1) - np.int32(1)
    keys = pair_keys(start, end)
    order = np.argsort(keys)
    keys = keys[order]
    sides = np.empty((len(pattern.edges_vertices), 2), dtype=np.int64)
    for column, (tail, head) in enumerate((pattern.edges_vertices.T, pattern.edges_vertices.T[::-1])):
        wanted = pair_keys(tail, head)
        by = np.argsort(wanted)  # searching in ascending order is much faster
        at = np.minimum(np.searchsorted(keys, wanted[by]), len(keys) - 1)
        sides[by, column] = np.where(keys[at] == wanted[by], order[at], -1)
    return sides


def faces_of_sides(pattern: CreasePattern, sides: Numbers) -> Ints:
    """Return the faces that half-edges, -1 for none, belong to; -1 for none."""
    faces: Ints = np.where(sides >= 0, pattern.faces_vertices.rows[sides], np.int32(-1))
    return faces


def signed_areas(vertices_coords: Floats, faces: Ragged) -> Floats:
    """Return the area of every face, ``(f,)``, positive where it runs counter-clockwise."""
    start, end = half_edges(faces)
    # measured from each face's own first vertex, so that small faces far from the origin keep their digits
    base = np.repeat(vertices_coords[faces.values[faces.offsets[:-1]]], faces.lengths, axis=0)
    (ax, ay), (bx, by) = (vertices_coords[start] - base).T, (vertices_coords[end] - base).T
    return np.bincount(faces.rows, weights=ax * by - ay * bx, minlength=len(faces)) / 2


def following_half_edges(vertices_coords: Floats, edges_vertices: Numbers) -> Indices:
    """Return for each half-edge the one that goes on at its end around the same face, on its left.

    Half-edge 2k runs along edge k, 2k + 1 against it. At a vertex with a single edge it is the same edge backwards.
    """
    tail = edges_vertices.reshape(-1)
    head = edges_vertices[:, ::-1].reshape(-1)
    dx, dy = (vertices_coords[head] - vertices_coords[tail]).T
    order = np.lexsort((np.arctan2(dy, dx), tail))
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order))
    degree = np.bincount(tail, minlength=len(vertices_coords))
    first = np.cumsum(degree) - degree
    # at its end, the face on the left of a half-edge continues along the next edge in clockwise order
    opposite = np.arange(len(tail)) ^ 1
    clockwise = first[head] + (place[opposite] - first[head] - 1) % degree[head]
    following: Indices = order[clockwise]
    return following


def trace_faces(vertices_coords: Floats, edges_vertices: Ints) -> Ragged:
    """Return the bounded faces of a plane graph, counter-clockwise.

    The edges must not cross. The outline that runs clockwise around each connected part is left out, and so are
    outlines without area.
    """
    tail = edges_vertices.reshape(-1)
    following: list[int] = following_half_edges(vertices_coords, edges_vertices).tolist()

    outlines, seen = [], [False] * len(following)
    for start in range(len(following)):
        outline = []
        here = start
        while not seen[here]:
            seen[here] = True
            outline.append(here)
            here = following[here]
        if len(outline) > 2:
            outlines.append(tail[outline].tolist())
    faces = Ragged.from_rows(outlines)
    bounded = signed_areas(vertices_coords, faces) > 0
    return Ragged.from_rows(outline for outline, keep in zip(outlines, bounded, strict=True) if keep)
