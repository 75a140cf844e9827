"""The molecules one by one, as simply as can be: what ``disks.molecules`` makes all at once, number by number."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Floats, Ragged, index_array, points_array
from foldcut.core.errors import UnfoldableError
from foldcut.methods.disks.molecules import Kind, Molecules
from foldcut.methods.disks.packing import Packing
from foldcut.methods.disks.tolerance import Tolerance


def build_molecules(packing: Packing, tolerance: Tolerance) -> Molecules:
    """Fold the triangles with rabbit ears, the quadrilaterals with gussets, and lay the ribbon between.

    Raises ``UnfoldableError`` with the place when a quadrilateral has no gusset (it does not happen in a valid
    packing). Source: paper section 3, Figures 2 to 4; section 5, Figure 7 for the ribbon.
    """
    builder = _Builder(packing, tolerance)
    for gap, face in zip(packing.gaps.to_lists(), packing.gap_face.tolist(), strict=True):
        builder.add_molecule(gap, face)
    builder.add_boundaries()
    return builder.finish()


class _Builder:
    """Collects vertices, facets and creases; each vertex and crease is made once."""

    def __init__(self, packing: Packing, tolerance: Tolerance) -> None:
        self.packing = packing
        self.tolerance = tolerance
        self.centres = packing.centres.tolist()
        self.radii = packing.radii.tolist()
        sign = np.where(packing.face_inside, 1.0, -1.0)
        self.face_sign: list[float] = sign.tolist()
        self.vertices: list[tuple[float, float]] = []
        self.folded: list[tuple[float, float]] = []
        self.disk_vertex = [-1] * len(self.radii)
        self.node_vertex: dict[int, int] = {}
        self.foot_vertex: dict[tuple[int, int], int] = {}
        self.crease_number: dict[tuple[int, int], int] = {}
        self.creases: list[tuple[int, int, Kind, int, int, int]] = []
        self.corners: list[list[int]] = []
        self.feet: list[list[int]] = []
        self.side_part: list[list[int]] = []
        self.face: list[int] = []
        self.facets: list[list[int]] = []
        self.facet_owner: list[tuple[int, int]] = []
        self.boundary_sides: list[tuple[int, int, int, int]] = []

    def vertex(self, flat: tuple[float, float], folded: tuple[float, float]) -> int:
        self.vertices.append(flat)
        self.folded.append(folded)
        return len(self.vertices) - 1

    def corner(self, disk: int, face: int) -> int:
        """The vertex at a disk's centre; without a ribbon the two disks of a boundary node share it."""
        if self.disk_vertex[disk] < 0:
            node = int(self.packing.node[disk])
            shared = self.node_vertex.get(node, -1) if self.packing.ribbon == 0 else -1
            if shared < 0:
                height = self.face_sign[face] * self.packing.ribbon
                shared = self.vertex((self.centres[disk][0], self.centres[disk][1]), (self.radii[disk], height))
                self.node_vertex[node] = shared
            self.disk_vertex[disk] = shared
        return self.disk_vertex[disk]

    def foot(self, disk: int, following: int, face: int) -> int:
        """The vertex at the tangency point of two disks."""
        a, b = self.corner(disk, face), self.corner(following, face)
        key = (min(a, b), max(a, b))
        if key not in self.foot_vertex:
            (ax, ay), (bx, by) = self.centres[disk], self.centres[following]
            part = self.radii[disk] / (self.radii[disk] + self.radii[following])
            height = self.face_sign[face] * self.packing.ribbon
            self.foot_vertex[key] = self.vertex((ax + (bx - ax) * part, ay + (by - ay) * part), (0.0, height))
        return self.foot_vertex[key]

    def crease(self, a: int, b: int, kind: Kind, molecule: int = -1, part: int = -1, side: int = -1) -> None:
        key = (min(a, b), max(a, b))
        if key not in self.crease_number:
            self.crease_number[key] = len(self.creases)
            self.creases.append((a, b, kind, molecule, part, side))

    def facet(self, vertices: list[int], molecule: int, corner: int) -> None:
        self.facets.append(vertices)
        self.facet_owner.append((molecule, corner))

    def add_molecule(self, gap: list[int], face: int) -> None:
        number = len(self.corners)
        corners = [self.corner(disk, face) for disk in gap]
        feet = [self.foot(disk, gap[k + 1 - len(gap)], face) for k, disk in enumerate(gap)]
        self.corners.append(corners)
        self.feet.append(feet)
        self.face.append(face)
        for k, foot in enumerate(feet):
            self.crease(corners[k], foot, Kind.SIDE)
            self.crease(foot, corners[k + 1 - len(gap)], Kind.SIDE)
        centres = np.array([self.centres[disk] for disk in gap])
        radii = np.array([self.radii[disk] for disk in gap])
        if len(gap) == 3:
            centre = _radical_centre(centres, radii)
            assert centre is not None
            self._add_ear(number, face, corners, feet, centre, _height(centre, centres[0], centres[1]))
            return
        gusset = _choose_gusset(centres, radii)
        if gusset is None:
            x, y = centres.mean(axis=0)
            raise UnfoldableError(
                f"the quadrilateral of disks near ({x:.3f}, {y:.3f}) mm has no gusset; move the drawing a little"
            )
        if gusset.distance <= self.tolerance.tie * float(radii.min()) + self.tolerance.rounding:
            middle = (gusset.first_centre + gusset.second_centre) / 2
            self._add_ear(number, face, corners, feet, middle, (gusset.first_height + gusset.second_height) / 2)
        else:
            self._add_gusset(number, face, corners, feet, centres, radii, gusset)

    def _folded(self, face: int, x: float, height: float) -> tuple[float, float]:
        return x, self.face_sign[face] * (self.packing.ribbon + height)

    def _add_ear(
        self, number: int, face: int, corners: list[int], feet: list[int], centre: Floats, height: float
    ) -> None:
        """All creases meet in one point: the rabbit ear, or a gusset whose perpendicular points coincide."""
        self.side_part.append([0] * len(corners))
        apex = self.vertex((float(centre[0]), float(centre[1])), self._folded(face, 0.0, height))
        for k, (corner, foot) in enumerate(zip(corners, feet, strict=True)):
            self.crease(corner, apex, Kind.BISECTOR)
            self.crease(foot, apex, Kind.TANGENCY, number, 0, k)
            self.facet([feet[k - 1], corner, apex], number, k)
            self.facet([corner, foot, apex], number, k)

    def _add_gusset(
        self,
        number: int,
        face: int,
        corners: list[int],
        feet: list[int],
        centres: Floats,
        radii: Floats,
        gusset: _Gusset,
    ) -> None:
        r"""Two rabbit ears on the inset quadrilateral, joined along its diagonal p - r.

        ::

              d --------- c        u, v: perpendicular points (centres of the parts a b c and c d a)
              | \   v   / |        p, r: corners of the inset quadrilateral, on the bisectors at a and c
              |  p--m--r  |        m: where the diagonal p r meets u v
              | /   u   \ |
              a --------- b
        """
        a, b, c, d = ((gusset.first + k) % 4 for k in range(4))
        h = (gusset.first_height + gusset.second_height - gusset.distance) / 2
        u = self._point(gusset.first_centre, self._folded(face, 0.0, gusset.first_height))
        v = self._point(gusset.second_centre, self._folded(face, 0.0, gusset.second_height))
        along = (gusset.second_centre - gusset.first_centre) / gusset.distance
        m = self._point(gusset.first_centre + along * (gusset.first_height - h), self._folded(face, 0.0, h))
        p = self._inset_corner(centres, radii, a, h, face)
        r = self._inset_corner(centres, radii, c, h, face)
        parts = [0] * 4
        parts[c] = parts[d] = 1
        self.side_part.append(parts)
        for start, end in ((corners[a], p), (corners[c], r), (corners[b], u), (corners[d], v)):
            self.crease(start, end, Kind.BISECTOR)
        for start, end in ((p, u), (p, v), (r, u), (r, v)):
            self.crease(start, end, Kind.BISECTOR)
        self.crease(p, m, Kind.DIAGONAL)
        self.crease(m, r, Kind.DIAGONAL)
        for side, (part, apex) in enumerate((x, (u, v)[x]) for x in parts):
            self.crease(feet[side], apex, Kind.TANGENCY, number, part, side)
        self.crease(m, u, Kind.TANGENCY, number, 0, 4)
        self.crease(m, v, Kind.TANGENCY, number, 1, 4)
        around = {
            a: [[feet[d], corners[a], p, v], [v, p, m], [m, p, u], [corners[a], feet[a], u, p]],
            b: [[feet[a], corners[b], u], [corners[b], feet[b], u]],
            c: [[feet[b], corners[c], r, u], [u, r, m], [m, r, v], [corners[c], feet[c], v, r]],
            d: [[feet[c], corners[d], v], [corners[d], feet[d], v]],
        }
        for corner in range(4):
            for vertices in around[corner]:
                self.facet(vertices, number, corner)

    def _point(self, flat: Floats, folded: tuple[float, float]) -> int:
        return self.vertex((float(flat[0]), float(flat[1])), folded)

    def _inset_corner(self, centres: Floats, radii: Floats, k: int, h: float, face: int) -> int:
        """The corner k of the inset polygon at height h: on the bisector, its radius smaller by h cot(alpha / 2)."""
        x, y = centres[k].tolist()
        (ax, ay), (bx, by) = _direction(centres[k], centres[(k + 1) % 4]), _direction(centres[k], centres[k - 1])
        sine = math.sqrt((ax - bx) * (ax - bx) + (ay - by) * (ay - by)) / 2
        cosine = math.sqrt((ax + bx) * (ax + bx) + (ay + by) * (ay + by)) / 2
        if ax * by - ay * bx < 0:
            cosine = -cosine
        reach = h / sine
        flat = (x + reach * (ax * cosine - ay * sine), y + reach * (ax * sine + ay * cosine))
        return self.vertex(flat, self._folded(face, float(radii[k]) - h * (cosine / sine), h))

    def add_boundaries(self) -> None:
        """List the sides along the loops and fill the ribbon with a facet for each half side."""
        packing = self.packing
        gap_sides = {}
        for number, gap in enumerate(packing.gaps.to_lists()):
            for k, disk in enumerate(gap):
                gap_sides[int(packing.node[disk]), int(packing.node[gap[k + 1 - len(gap)]])] = (number, k)
        for loop, nodes in enumerate(packing.loop_nodes.to_lists()):
            for k, node in enumerate(nodes):
                following = nodes[k + 1 - len(nodes)]
                left = self._side(*gap_sides[node, following])
                self.boundary_sides.append((*left, loop))
                if loop > 0 and packing.ribbon > 0:
                    self._add_ribbon(left, self._side(*gap_sides[following, node]))

    def _side(self, number: int, k: int) -> tuple[int, int, int]:
        corners = self.corners[number]
        return corners[k], self.feet[number][k], corners[k + 1 - len(corners)]

    def _add_ribbon(self, left: tuple[int, int, int], right: tuple[int, int, int]) -> None:
        """Two facets between a side on the left border of the ribbon and its like on the right one."""
        start, middle, end = left
        end_right, middle_right, start_right = right
        self.facet([start_right, middle_right, middle, start], -1, -1)
        self.facet([middle_right, end_right, end, middle], -1, -1)
        self.crease(start, start_right, Kind.RIBBON)
        self.crease(middle, middle_right, Kind.RIBBON)
        self.crease(end, end_right, Kind.RIBBON)

    def finish(self) -> Molecules:
        creases = np.array(self.creases, dtype=np.int32).reshape(-1, 6)
        owner = np.array(self.facet_owner, dtype=np.int32).reshape(-1, 2)
        kind, part, side = (creases[:, k].astype(np.int8) for k in (2, 4, 5))
        return Molecules(
            points_array(self.vertices),
            points_array(self.folded),
            Ragged.from_rows(self.corners),
            Ragged.from_rows(self.feet),
            Ragged.from_rows(self.facets),
            index_array(owner[:, 0]),
            owner[:, 1].astype(np.int8),
            index_array(creases[:, :2]),
            kind,
            index_array(creases[:, 3]),
            part,
            side,
            index_array(self.face),
            Ragged.from_rows(self.side_part),
            index_array(self.boundary_sides),
            index_array(self.disk_vertex),
        )


@dataclass(frozen=True, eq=False)
class _Gusset:
    """A choice of diagonal: from corner ``first`` to the one opposite."""

    first: int
    first_centre: Floats
    second_centre: Floats
    first_height: float
    second_height: float
    distance: float


def _choose_gusset(centres: Floats, radii: Floats) -> _Gusset | None:
    """Of the two diagonals take the one whose perpendicular points exist, lie inside, and give the lower inset."""
    best: tuple[float, _Gusset] | None = None
    for first in (0, 1):
        a, b, c, d = ((first + k) % 4 for k in range(4))
        u = _radical_centre(centres[[a, b, c]], radii[[a, b, c]])
        v = _radical_centre(centres[[c, d, a]], radii[[c, d, a]])
        if u is None or v is None:
            continue
        u_height, v_height = _height(u, centres[a], centres[b]), _height(v, centres[c], centres[d])
        if u_height <= 0 or v_height <= 0:
            continue
        x, y = (v - u).tolist()
        distance = math.sqrt(x * x + y * y)
        inset = u_height + v_height - distance
        if best is None or inset < best[0]:
            best = (inset, _Gusset(first, u, v, u_height, v_height, distance))
    return best[1] if best else None


def _radical_centre(centres: Floats, radii: Floats) -> Floats | None:
    """The point of equal power to three circles, or None when their centres are collinear."""
    (x, y), (ux, uy), (vx, vy) = centres[0], centres[1] - centres[0], centres[2] - centres[0]
    determinant = ux * vy - uy * vx
    if abs(determinant) <= 1e-12 * (ux * ux + uy * uy + vx * vx + vy * vy):
        return None
    u = (ux * ux + uy * uy + radii[0] * radii[0] - radii[1] * radii[1]) / 2
    v = (vx * vx + vy * vy + radii[0] * radii[0] - radii[2] * radii[2]) / 2
    return np.array([x + (u * vy - v * uy) / determinant, y + (ux * v - vx * u) / determinant])


def _height(point: Floats, start: Floats, end: Floats) -> float:
    """The distance of a point to the left of the line from ``start`` to ``end``."""
    (ax, ay), (bx, by) = end - start, point - start
    return float((ax * by - ay * bx) / math.sqrt(ax * ax + ay * ay))


def _direction(start: Floats, end: Floats) -> tuple[float, float]:
    x, y = (end - start).tolist()
    length = math.sqrt(x * x + y * y)
    return x / length, y / length
