"""Whether the creases around every vertex fold flat: the theorems of Kawasaki and Maekawa.

Pattern whose faces tile the sheet -> findings. ``check_vertices`` names what is wrong at each vertex;
``is_flat_at_vertices`` is the faster question whether it would find anything.
"""

from __future__ import annotations

import numpy as np

from foldcut.core.arrays import Ints, blocks
from foldcut.core.model import CreasePattern, Finding
from foldcut.pattern.face_maps import FaceMaps, folded_edges
from foldcut.proof.findings import finding, first

__all__ = ["check_vertices", "is_flat_at_vertices"]


def is_flat_at_vertices(pattern: CreasePattern, faces_of_edges: Ints, maps: FaceMaps, tolerance: float) -> bool:
    """Whether ``check_vertices`` is sure to find nothing in a pattern whose faces, folded, meet their neighbours.

    In such a pattern, the two faces at a crease show different sides. So the number of creases around every inner
    vertex is even, as it has to be, and every other angle belongs to a face that shows the same side.
    """
    coords, faces, edges = pattern.vertices_coords, pattern.faces_vertices, pattern.edges_vertices
    excess = np.zeros(len(coords))  # twice the amount by which every other angle exceeds a half turn
    for some, outlines in faces.alike():
        following = np.append(np.arange(1, len(outlines)), 0)
        x, y = np.moveaxis(coords[outlines], 2, 0)
        ax, ay = x[following] - x, y[following] - y
        bx, by = ax[following], ay[following]
        angle = np.pi - np.arctan2(ax * by - ay * bx, ax * bx + ay * by)
        np.add.at(excess, outlines[following], np.where(maps.up[some], angle, -angle))
    excess = np.abs(excess) / 2
    inner = np.ones(len(coords), dtype=np.bool_)
    inner[edges[(faces_of_edges[:, 0] < 0) | (faces_of_edges[:, 1] < 0)]] = False
    surplus = np.zeros(len(coords), dtype=np.int32)
    creased = np.zeros(len(coords), dtype=np.bool_)
    flat = np.zeros(len(coords), dtype=np.bool_)
    for kind, sign in (("M", 1), ("V", -1)):
        crease = edges[pattern.edges_assignment == kind]
        surplus += sign * np.bincount(crease.ravel(), minlength=len(coords)).astype(np.int32)
        for block in blocks(len(crease)):
            some = crease[block]
            along = coords[some[:, 1]] - coords[some[:, 0]]
            length = np.hypot(along[:, 0], along[:, 1])
            creased[some] = True
            # One crease that is short enough will do. The margin allows for rounding, which depends on the order.
            flat[some[excess[some] * length[:, None] <= tolerance / 2]] = True
    return bool((flat & (np.abs(surplus) == 2))[inner & creased].all())


def check_vertices(pattern: CreasePattern, faces_of_edges: Ints, tolerance: float) -> list[Finding]:
    """Find inner vertices that cannot fold flat because of their angles, or of their mountains and valleys.

    Kawasaki: every other angle adds up to a half turn; an error is allowed that moves the end of the vertex's shortest
    crease by no more than ``tolerance``, in mm. Maekawa: the numbers of mountains and of valleys differ by two.
    """
    coords = pattern.vertices_coords
    inner = np.ones(len(coords), dtype=np.bool_)
    inner[pattern.edges_vertices[(faces_of_edges < 0).any(axis=1)]] = False
    crease = folded_edges(pattern)
    tail, head = np.concatenate([pattern.edges_vertices[crease], pattern.edges_vertices[crease][:, ::-1]]).T
    kind = np.tile(np.where(pattern.edges_assignment[crease] == "M", 1, -1), 2)
    dx, dy = (coords[head] - coords[tail]).T
    angle, length = np.arctan2(dy, dx), np.hypot(dx, dy)
    # Sort by vertex, then by angle. Angles that differ by less than 6e-12 may come in either order.
    order = np.argsort(
        (tail.astype(np.int64) << 40) + ((angle + np.pi) * ((2**40 - 1) / (2 * np.pi + 1e-9))).astype(np.int64)
    )
    tail, angle, kind, length = tail[order], angle[order], kind[order], length[order]

    count = len(coords)
    degree = np.bincount(tail, minlength=count)
    position = np.arange(len(tail)) - (np.cumsum(degree) - degree)[tail]
    # The sum of the angles a0 <= a1 <= ..., with alternating signs, is minus a half turn.
    alternating = np.bincount(tail, weights=np.where(position % 2, -angle, angle), minlength=count)
    excess = alternating + np.pi
    shortest = np.full(count, np.inf)
    starts = np.flatnonzero(np.append(True, tail[1:] != tail[:-1])) if len(tail) else np.empty(0, dtype=np.intp)
    if len(tail):
        shortest[tail[starts]] = np.minimum.reduceat(length, starts)
    surplus = np.bincount(tail, weights=kind, minlength=count)

    creased = inner & (degree > 0)
    findings = []
    for vertex in first(creased & (degree % 2 == 1)):
        message = f"{degree[vertex]} creases meet; an even number must"
        findings.append(finding("kawasaki", message, coords[vertex], 1.0))
    off = creased & (degree % 2 == 0)
    bent = off & (np.abs(excess) * np.where(off, shortest, 0) > tolerance)
    for vertex in first(bent):
        degrees = float(np.degrees(abs(excess[vertex])))
        message = f"every other angle adds up to {degrees:.3g} degrees more or less than 180"
        findings.append(finding("kawasaki", message, coords[vertex], degrees))
    for vertex in first(off & (np.abs(surplus) != 2)):
        mountains = int(degree[vertex] + surplus[vertex]) // 2
        message = f"{mountains} mountains and {degree[vertex] - mountains} valleys; they must differ by two"
        findings.append(finding("maekawa", message, coords[vertex], abs(abs(surplus[vertex]) - 2)))
    return findings
