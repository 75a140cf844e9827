"""Disks on the boundaries: every edge of the shape and of the sheet becomes a union of disk diameters.

Shape and sheet -> ``BoundaryDisks`` (paper section 2, first half; section 5 for the ribbon).

A point of a loop (a *node*) carries one disk in the face on its left and one in the face on its right; the sheet's
border has only the left one. Without a ribbon the two are the same disk twice.

Invariants: along a loop each disk touches the next one; disks of one face do not overlap.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Bools, Floats, Ints, Ragged, index_array
from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.geometry.vectors import left_normal
from foldcut.methods.disks.disk_pairs import NEARLY_TOUCHING, near_disks, nearly_touching
from foldcut.methods.disks.loops import Loop, loops_of, vertex_radii
from foldcut.methods.disks.ribbon import require_tellable, too_wide
from foldcut.methods.disks.tolerance import Tolerance

__all__ = ["MAX_DISKS", "BoundaryDisks", "Limit", "boundary_disks"]

MAX_DISKS = 1_000_000
"""Into more pieces than this the edges are not divided."""

Limit = Callable[[Floats, Floats], Floats]
"""Given disks' centres ``(n, 2)`` and radii ``(n,)``, the largest radius that each may have, ``(n,)``."""


@dataclass(frozen=True, eq=False)
class BoundaryDisks:
    """The disks on the loops, and the chains that they form around each face.

    ``centres`` ``(n, 2)`` mm, ``radii`` ``(n,)`` mm, ``node`` ``(n,)``: the boundary point a disk belongs to.
    ``chains`` ragged: disks with the face on their left; ``chain_face`` and ``chain_loop`` are the face and
    loop of each.
    ``face_inside`` ``(faces,)``: whether the face is part of the shape. ``loop_nodes`` ragged: nodes in loop order.
    ``ribbon``: its half-width in mm.
    """

    centres: Floats
    radii: Floats
    node: Ints
    chains: Ragged
    chain_face: Ints
    chain_loop: Ints
    face_inside: Bools
    loop_nodes: Ragged
    ribbon: float


def boundary_disks(
    shape: Shape,
    sheet: Sheet,
    ribbon: float,
    tolerance: Tolerance,
    limit: Limit | None = None,
    most: int = MAX_DISKS,
) -> BoundaryDisks:
    """Cover every edge of ``shape`` and ``sheet`` with disks centred on it.

    ``shape`` is in the sheet's mm; ``ribbon`` is the half-width in mm of the unfolded strip along the shape's boundary;
    ``limit`` bounds the radii; edges are divided into at most about ``most`` pieces.
    Raises ``RibbonError`` with the largest, or the least, half-width that works, and ``UnfoldableError`` where a
    feature needs too many disks. Source: paper section 2 (vertex disks, crowded edges) and section 5.
    """
    require_tellable(sheet, ribbon)
    loops = loops_of(shape, sheet, ribbon)
    radii = vertex_radii(loops)
    if radii is None:
        raise too_wide(shape, sheet, ribbon)
    if limit is not None:
        radii = [_limited(loop, radius, limit) for loop, radius in zip(loops, radii, strict=True)]
    radii = _separate_vertex_disks(loops, radii, tolerance)
    pieces = _split_crowded(loops, radii, tolerance, limit, most)
    inside = np.array([False] + [shape.depth(i) % 2 == 0 for i in range(len(shape.loops))])
    return _assemble(loops, radii, pieces, inside, ribbon)


def _vertex_disks(loops: list[Loop], radii: list[Floats]) -> tuple[Floats, Floats, Ints, Ints]:
    """Centres, radii and faces of the vertex disks on both sides of the loops, and the corner that each belongs to."""
    centres, sizes, faces, corners = [], [], [], []
    first = 0
    for loop, radius in zip(loops, radii, strict=True):
        for face, sign in loop.sides:
            centres.append(loop.offset(sign))
            sizes.append(radius - loop.shift(sign))
            faces.append(np.full(len(radius), face))
            corners.append(np.arange(first, first + len(radius)))
        first += len(radius)
    return np.concatenate(centres), np.concatenate(sizes), np.concatenate(faces), np.concatenate(corners)


def _separate_vertex_disks(loops: list[Loop], radii: list[Floats], tolerance: Tolerance) -> list[Floats]:
    """Shrink vertex disks that nearly touch, so that they either touch or leave room."""
    ends = np.cumsum([len(radius) for radius in radii])[:-1]
    smallest = np.concatenate([np.abs(loop.shift(1)) * 1.1 for loop in loops])
    for _ in range(20):
        centres, sizes, face, corner = _vertex_disks(loops, radii)
        i, j, slack = near_disks(centres, sizes, face)
        nearly = nearly_touching(slack, sizes[i], sizes[j], tolerance)
        if not nearly.any():
            break
        shrunk = np.concatenate(radii)
        shrunk[np.unique(corner[np.concatenate([i[nearly], j[nearly]])])] *= 1 - 2 * NEARLY_TOUCHING
        radii = np.split(np.maximum(shrunk, smallest), ends)
    return radii


def _limited(loop: Loop, radii: Floats, limit: Limit) -> Floats:
    """Shrink vertex disks to what ``limit`` allows on either border of the ribbon."""
    for _, sign in loop.sides:
        shift = loop.shift(sign)
        radii = np.minimum(radii, limit(loop.offset(sign), radii - shift) + shift)
    return np.maximum(radii, np.abs(loop.shift(1)) * 1.1)


@dataclass(eq=False)
class _Pieces:
    """Pieces of the edges between vertex disks: loop, edge, and where along the edge each starts and ends, in mm."""

    loop: Ints
    edge: Ints
    start: Floats
    end: Floats

    def split(self, chosen: Bools) -> _Pieces:
        """Halve the chosen pieces; the halves come last."""
        middle = (self.start[chosen] + self.end[chosen]) / 2
        kept = ~chosen
        return _Pieces(
            np.concatenate([self.loop[kept], self.loop[chosen], self.loop[chosen]]),
            np.concatenate([self.edge[kept], self.edge[chosen], self.edge[chosen]]),
            np.concatenate([self.start[kept], self.start[chosen], middle]),
            np.concatenate([self.end[kept], middle, self.end[chosen]]),
        )


def _first_pieces(loops: list[Loop], radii: list[Floats], tolerance: Tolerance) -> _Pieces:
    number, edge, start, end = [], [], [], []
    for i, (loop, radius) in enumerate(zip(loops, radii, strict=True)):
        following = np.roll(radius, -1)
        stretch = loop.lengths - radius - following
        uncovered = np.flatnonzero(stretch > tolerance.tie * np.minimum(radius, following))
        number.append(np.full(len(uncovered), i))
        edge.append(uncovered)
        start.append(radius[uncovered])
        end.append((loop.lengths - following)[uncovered])
    return _Pieces(
        np.concatenate(number).astype(np.int32),
        np.concatenate(edge).astype(np.int32),
        np.concatenate(start),
        np.concatenate(end),
    )


def _piece_disks(loops: list[Loop], pieces: _Pieces, sign: int) -> tuple[Floats, Floats]:
    """Centres and radii of the pieces' diameter disks on one side of their loops."""
    centres = np.empty((len(pieces.loop), 2))
    for i, loop in enumerate(loops):
        mine = np.flatnonzero(pieces.loop == i)
        edge = pieces.edge[mine]
        middle = (pieces.start[mine] + pieces.end[mine]) / 2
        centres[mine] = loop.corners[edge] + loop.directions[edge] * middle[:, None]
        centres[mine] += sign * loop.half_width * left_normal(loop.directions[edge])
    return centres, (pieces.end - pieces.start) / 2


def _split_crowded(
    loops: list[Loop], radii: list[Floats], tolerance: Tolerance, limit: Limit | None, most: int
) -> _Pieces:
    """Halve pieces until no diameter disk overlaps another disk of its face; of two, the larger one is halved."""
    pieces = _first_pieces(loops, radii, tolerance)
    face_of = {sign: np.array([{s: f for f, s in loop.sides}.get(sign, -1) for loop in loops]) for sign in (1, -1)}
    fixed_centres, fixed_radii, fixed_face, _ = _vertex_disks(loops, radii)
    fresh = 0  # the pieces from here on are new; the others do not crowd each other
    while True:
        count = len(pieces.loop)
        if count > most:
            raise UnfoldableError(
                f"the shape's features are so small that over {most:,} disks would be needed; simplify it"
            )
        sides = [(face_of[sign][pieces.loop], *_piece_disks(loops, pieces, sign)) for sign in (1, -1)]
        face = np.concatenate([sides[0][0], sides[1][0], fixed_face])
        centres = np.concatenate([sides[0][1], sides[1][1], fixed_centres])
        sizes = np.concatenate([sides[0][2], sides[1][2], fixed_radii])
        owner = np.concatenate([np.arange(count), np.arange(count), np.full(len(face) - 2 * count, -1)])
        i, j, slack = near_disks(centres, sizes, face, owner >= fresh if fresh else None)
        crowd = (slack < -tolerance.touching(sizes[i], sizes[j])) | nearly_touching(
            slack, sizes[i], sizes[j], tolerance
        )
        i, j = i[crowd], j[crowd]
        larger_is_fixed = np.minimum(owner[i], owner[j]) < 0
        take_i = (owner[i] >= 0) & (larger_is_fixed | (sizes[i] >= sizes[j] * (1 - tolerance.tie)))
        take_j = (owner[j] >= 0) & (larger_is_fixed | (sizes[j] >= sizes[i] * (1 - tolerance.tie)))
        crowded = np.zeros(count, dtype=bool)
        crowded[owner[i[take_i]]] = True
        crowded[owner[j[take_j]]] = True
        if limit is not None:
            for _, side_centres, side_radii in sides:
                crowded |= side_radii > limit(side_centres, side_radii)
        if not crowded.any():
            return pieces
        fresh = count - int(crowded.sum())
        pieces = pieces.split(crowded)


def _assemble(loops: list[Loop], radii: list[Floats], pieces: _Pieces, inside: Bools, ribbon: float) -> BoundaryDisks:
    """Number nodes and disks along the loops and list each face's chains."""
    piece_sides = {sign: _piece_disks(loops, pieces, sign) for sign in (1, -1)}
    order = np.lexsort((pieces.start, pieces.edge, pieces.loop))
    centres, sizes, nodes = [], [], []
    chains: list[Ints] = []
    chain_face, chain_loop, loop_nodes = [], [], []
    node_count = disk_count = 0
    for number, (loop, radius) in enumerate(zip(loops, radii, strict=True)):
        mine = order[pieces.loop[order] == number]
        corner_count = len(radius)
        # corner k comes before the pieces of edge k
        rank = np.lexsort(
            (
                np.concatenate([np.full(corner_count, -1.0), pieces.start[mine]]),
                np.concatenate([np.arange(corner_count), pieces.edge[mine]]),
            )
        )
        node = np.arange(node_count, node_count + len(rank), dtype=np.int32)
        node_count += len(rank)
        loop_nodes.append(node)
        for face, sign in loop.sides:
            piece_centres, piece_radii = piece_sides[sign]
            centres.append(np.concatenate([loop.offset(sign), piece_centres[mine]])[rank])
            sizes.append(np.concatenate([radius - loop.shift(sign), piece_radii[mine]])[rank])
            nodes.append(node)
            disks = np.arange(disk_count, disk_count + len(rank), dtype=np.int32)
            disk_count += len(rank)
            chains.append(disks if sign > 0 else disks[::-1])
            chain_face.append(face)
            chain_loop.append(number)
    return BoundaryDisks(
        np.concatenate(centres),
        np.concatenate(sizes),
        index_array(np.concatenate(nodes)),
        Ragged.from_rows(chain.tolist() for chain in chains),
        index_array(chain_face),
        index_array(chain_loop),
        inside,
        Ragged.from_rows(row.tolist() for row in loop_nodes),
        ribbon,
    )
