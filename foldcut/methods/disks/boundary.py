"""Disks on the boundaries: every edge of the shape and of the sheet becomes a union of disk diameters.

Shape and sheet -> ``BoundaryDisks`` (paper section 2, first half; section 5 for the ribbon).

The loops are numbered with the sheet's border as loop 0 and the shape's loops after it; face f of the plane is the
region right inside loop f. A loop's point (a *node*) carries one disk in the face on its left and one in the face on
its right, the sheet's border only the left one. Without a ribbon the two are the same disk twice.

Without a ribbon, sides of molecules between corners on the shape's boundary fold onto the cut line itself, and the cut
severs the paper there; ``default_ribbon`` is the remedy.

Invariants: along a loop each disk touches the next one; disks of one face do not overlap.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, Ints, Ragged, index_array
from foldcut.core.errors import RibbonError, UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.geometry.tolerance import Tolerance
from foldcut.geometry.vectors import cross, left_normal

# A vertex disk may shrink to this part of its size to make room for the ribbon.
RIBBON_SLACK = 0.2
# Narrower ribbons, relative to the sheet's diagonal, have creases that verification takes for points on the cut line.
NARROWEST_RIBBON = 1e-7
# Disks that nearly touch, by this part of the smaller one, leave gaps that fold to creases far too short: vertex disks
# are shrunk then, others split. (Vertex disks do so often: half the distance to an edge is nearly half the distance to
# that edge's end.)
NEARLY = 0.02
MAX_DISKS = 1_000_000
Limit = Callable[[Floats, Floats], Floats]
"""Of disks with these centres and radii, the largest radius that each may have."""
# A pencil line's width on either side: less is hard to crease, more is a visible strip.
DEFAULT_RIBBON_MM = 0.25


@dataclass(frozen=True, eq=False)
class BoundaryDisks:
    """The disks on the loops, and the chains they form around each face.

    ``centres`` ``(n, 2)`` mm, ``radii`` ``(n,)`` mm, ``node`` ``(n,)``: the boundary point a disk belongs to.
    ``chains`` ragged: disks with the face on their left; ``chain_face`` and ``chain_loop`` say whose.
    ``face_inside`` ``(faces,)``: whether the face is part of the shape. ``loop_nodes`` ragged: nodes in loop order.
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


@dataclass(frozen=True, eq=False)
class _Loop:
    """A loop's corners with what the ribbon needs to know of them."""

    corners: Floats
    lengths: Floats
    directions: Floats
    outward_cot: Floats  # cot(theta / 2) of the inside angle: a corner's shift along its edges per unit of inset
    inset: Floats  # movement of a corner per unit of inset to the left
    half_width: float
    sides: tuple[tuple[int, int], ...]  # (face, sign): +1 left of the loop, -1 right of it

    @classmethod
    def build(cls, corners: Floats, half_width: float, sides: tuple[tuple[int, int], ...]) -> _Loop:
        edges = np.roll(corners, -1, axis=0) - corners
        lengths = np.hypot(*edges.T)
        directions = edges / lengths[:, None]
        before = np.roll(directions, 1, axis=0)
        cot = cross(before, directions) / (1.0 + np.sum(before * directions, axis=1))
        inset = left_normal(directions) + directions * cot[:, None]
        return cls(corners, lengths, directions, cot, inset, half_width, sides)

    def offset(self, sign: int) -> Floats:
        """The corners moved to the ribbon's border on one side."""
        return self.corners + sign * self.half_width * self.inset

    def shift(self, sign: int) -> Floats:
        """How much shorter the radius is at the ribbon's border than at the corner itself."""
        return sign * self.half_width * self.outward_cot


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
    ``limit`` keeps disks small where it matters; edges are divided into at most about ``most`` pieces.
    Raises ``RibbonError`` with the largest, or the least, width that works, ``UnfoldableError`` when a feature needs
    too many disks.
    Source: paper section 2 (vertex disks, crowded edges) and section 5.
    """
    least = NARROWEST_RIBBON * sheet.diagonal
    if 0 < ribbon < least:
        raise RibbonError(
            f"a ribbon of half-width {ribbon:.2g} mm is too narrow to tell its two borders apart; it needs "
            f"{least:.2g} mm: ask for a wider one, or leave more room between the drawing's edges and to the border"
        )
    loops = _loops(shape, sheet, ribbon)
    radii = _vertex_radii(loops)
    if radii is None:
        raise RibbonError(_too_wide(shape, sheet, ribbon))
    if limit is not None:
        radii = [_limited(loop, radius, limit) for loop, radius in zip(loops, radii, strict=True)]
    radii = _separate_vertex_disks(loops, radii, tolerance)
    pieces = _split_crowded(loops, radii, tolerance, limit, most)
    inside = np.array([False] + [shape.depth(i) % 2 == 0 for i in range(len(shape.loops))])
    return _assemble(loops, radii, pieces, inside, ribbon)


def largest_ribbon(shape: Shape, sheet: Sheet, at_most: float) -> float:
    """Return the largest half-width, up to ``at_most``, of a ribbon that the shape has room for; all in mm."""
    if _vertex_radii(_loops(shape, sheet, at_most)) is not None:
        return at_most
    low, high = 0.0, at_most
    for _ in range(40):
        middle = (low + high) / 2
        if _vertex_radii(_loops(shape, sheet, middle)) is None:
            high = middle
        else:
            low = middle
    return low


def default_ribbon(shape: Shape, sheet: Sheet) -> float:
    """Return the half-width in mm of a ribbon that keeps creases off the cut line and changes little else.

    ``shape`` is in the sheet's mm. It is ``DEFAULT_RIBBON_MM``, or half the largest that works where that is less.
    """
    return largest_ribbon(shape, sheet, 2 * DEFAULT_RIBBON_MM) / 2


def _loops(shape: Shape, sheet: Sheet, ribbon: float) -> list[_Loop]:
    loops = [_Loop.build(sheet.corners, 0.0, ((0, +1),))]
    for number, (corners, parent) in enumerate(zip(shape.loops, shape.parent, strict=True), start=1):
        loops.append(_Loop.build(corners, ribbon, ((number, +1), (parent + 1, -1))))
    return loops


def _vertex_radii(loops: list[_Loop]) -> list[Floats] | None:
    """Radii of the vertex disks, or None when the ribbon leaves no room.

    A vertex disk reaches half-way to the nearest edge not incident to it, on either side's own border.
    """
    limits = [np.full(len(loop.corners), np.inf) for loop in loops]
    for face in range(len(loops)):
        around = [(number, sign) for number, loop in enumerate(loops) for f, sign in loop.sides if f == face]
        starts = [loops[number].offset(sign) for number, sign in around]
        ends = [np.roll(points, -1, axis=0) for points in starts]
        for (number, _), start, end in zip(around, starts, ends, strict=True):
            if (np.sum((end - start) * loops[number].directions, axis=1) <= 0).any():
                return None
        for (number, sign), reach in zip(around, _distances_to_edges(starts, ends), strict=True):
            np.minimum(limits[number], reach / 2 + loops[number].shift(sign), out=limits[number])
        if any(loops[number].half_width > 0 for number, _ in around) and not _is_simple(starts):
            return None
    for loop, radius in zip(loops, limits, strict=True):
        if loop.half_width > 0 and (radius - np.abs(loop.shift(1)) < RIBBON_SLACK * radius).any():
            return None
    return limits


def _is_simple(loops: list[Floats]) -> bool:
    largest = max(range(len(loops)), key=lambda i: float(np.ptp(loops[i], axis=0).max()))
    holes = [points for i, points in enumerate(loops) if i != largest]
    return bool(shapely.Polygon(loops[largest], holes).is_valid)


def _distances_to_edges(starts: list[Floats], ends: list[Floats]) -> list[Floats]:
    """Distances from the corners of loops to the nearest edge, of any of the loops, that does not end there.

    The edge after the next is no farther than its start, the next corner: only edges in this circle are looked at.
    """
    counts = [len(points) for points in starts]
    start, end = np.concatenate(starts), np.concatenate(ends)
    before = np.concatenate(
        [first + np.roll(np.arange(n), 1) for first, n in zip(_firsts(counts), counts, strict=True)]
    )
    length = np.hypot(*(end - start).T)
    tree = shapely.STRtree(shapely.linestrings(np.stack([start, end], axis=1)))
    reach = np.minimum(length, length[before]) * (1 + 1e-9)
    corner, edge = tree.query(shapely.points(start), predicate="dwithin", distance=reach)
    apart = (corner != edge) & (edge != before[corner])
    corner, edge = corner[apart], edge[apart]
    distances = np.full(len(start), np.inf)
    np.minimum.at(distances, corner, _point_segment_distances(start[corner], start[edge], end[edge]))
    return np.split(distances, np.cumsum(counts)[:-1])


def _firsts(counts: list[int]) -> list[int]:
    return [0, *np.cumsum(counts)[:-1].tolist()]


def _point_segment_distances(points: Floats, starts: Floats, ends: Floats) -> Floats:
    """Distances from points to segments, ``(n,)``."""
    along = ends - starts
    to_point = points - starts
    part = np.clip(np.sum(to_point * along, axis=1) / np.sum(along * along, axis=1), 0.0, 1.0)
    away = to_point - part[:, None] * along
    distances: Floats = np.hypot(away[:, 0], away[:, 1])
    return distances


def _too_wide(shape: Shape, sheet: Sheet, ribbon: float) -> str:
    widest = float(f"{largest_ribbon(shape, sheet, ribbon) * 0.999:.2e}")
    return (
        f"a ribbon of half-width {ribbon:g} mm is too wide for the shape's smallest feature or its distance from the "
        f"sheet's border; the largest half-width that works is {widest:g} mm"
    )


def _vertex_disks(loops: list[_Loop], radii: list[Floats]) -> tuple[Floats, Floats, Ints, Ints]:
    """Centres, radii, faces of the vertex disks on both sides of the loops, and the corner each one belongs to."""
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


def _separate_vertex_disks(loops: list[_Loop], radii: list[Floats], tolerance: Tolerance) -> list[Floats]:
    """Shrink vertex disks that nearly touch, so that they either touch or leave room."""
    ends = np.cumsum([len(radius) for radius in radii])[:-1]
    smallest = np.concatenate([np.abs(loop.shift(1)) * 1.1 for loop in loops])
    for _ in range(20):
        centres, sizes, face, corner = _vertex_disks(loops, radii)
        i, j, slack = near_disks(centres, sizes, face)
        nearly = _nearly_touching(slack, sizes[i], sizes[j], tolerance)
        if not nearly.any():
            break
        shrunk = np.concatenate(radii)
        shrunk[np.unique(corner[np.concatenate([i[nearly], j[nearly]])])] *= 1 - 2 * NEARLY
        radii = np.split(np.maximum(shrunk, smallest), ends)
    return radii


def _limited(loop: _Loop, radii: Floats, limit: Limit) -> Floats:
    """Shrink vertex disks to what is allowed on either border of the ribbon."""
    for _, sign in loop.sides:
        shift = loop.shift(sign)
        radii = np.minimum(radii, limit(loop.offset(sign), radii - shift) + shift)
    return np.maximum(radii, np.abs(loop.shift(1)) * 1.1)


def _nearly_touching(slack: Floats, a: Floats, b: Floats, tolerance: Tolerance) -> Bools:
    return (slack > tolerance.touching(a, b)) & (slack < NEARLY * np.minimum(a, b))


@dataclass(eq=False)
class _Pieces:
    """The stretches of the edges between vertex disks: loop, edge, and start and end along the edge."""

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


def _first_pieces(loops: list[_Loop], radii: list[Floats], tolerance: Tolerance) -> _Pieces:
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


def _piece_disks(loops: list[_Loop], pieces: _Pieces, sign: int) -> tuple[Floats, Floats]:
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
    loops: list[_Loop], radii: list[Floats], tolerance: Tolerance, limit: Limit | None, most: int
) -> _Pieces:
    """Halve edges until no diameter disk overlaps another disk of its face; of two, the larger is halved."""
    pieces = _first_pieces(loops, radii, tolerance)
    face_of = {sign: np.array([{s: f for f, s in loop.sides}.get(sign, -1) for loop in loops]) for sign in (1, -1)}
    fixed_centres, fixed_radii, fixed_face, _ = _vertex_disks(loops, radii)
    fresh = 0  # from here on pieces are new; of the others no two crowd each other
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
        crowd = (slack < -tolerance.touching(sizes[i], sizes[j])) | _nearly_touching(
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


def overlapping_disks(centres: Floats, radii: Floats, face: Ints, tolerance: Tolerance) -> tuple[Ints, Ints]:
    """Return the pairs i < j of disks of one face that overlap by more than the tie tolerance."""
    i, j, slack = near_disks(centres, radii, face)
    crowded = slack < -tolerance.touching(radii[i], radii[j])
    return i[crowded], j[crowded]


def touching_disks(centres: Floats, radii: Floats, face: Ints, tolerance: Tolerance) -> tuple[Ints, Ints]:
    """Return the pairs i < j of disks of one face that touch within the tie tolerance."""
    i, j, slack = near_disks(centres, radii, face)
    touching = np.abs(slack) <= tolerance.touching(radii[i], radii[j])
    return i[touching], j[touching]


def near_disks(centres: Floats, radii: Floats, face: Ints, chosen: Bools | None = None) -> tuple[Ints, Ints, Floats]:
    """Return pairs i < j of disks of one face whose boxes meet, and the free distance between them.

    ``chosen`` keeps only pairs with at least one of these disks.
    """
    used = np.flatnonzero(face >= 0)
    reach = radii[used, None] * (1 + NEARLY)
    low, high = centres[used] - reach, centres[used] + reach
    boxes = shapely.linestrings(np.stack([low, high], axis=1))  # their diagonals: made sooner, and as good here
    if chosen is None:
        left, right = shapely.STRtree(boxes).query(boxes)
        kept = left < right
    else:
        asked = np.flatnonzero(chosen[used])
        left, right = shapely.STRtree(boxes).query(boxes[asked])
        left = asked[left]
        kept = (left < right) | ~chosen[used[right]]
    i, j = used[np.minimum(left[kept], right[kept])], used[np.maximum(left[kept], right[kept])]
    same = face[i] == face[j]
    i, j = i[same].astype(np.int32), j[same].astype(np.int32)
    away = centres[i] - centres[j]
    return i, j, np.hypot(away[:, 0], away[:, 1]) - radii[i] - radii[j]


def _assemble(loops: list[_Loop], radii: list[Floats], pieces: _Pieces, inside: Bools, ribbon: float) -> BoundaryDisks:
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
        # corner k sorts before the pieces of edge k
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
