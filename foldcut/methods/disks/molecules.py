"""Molecules: how the polygon of each gap folds into a star of flaps with its border on one line.

``Packing`` -> ``Molecules`` (paper section 3; the choice of the gusset's diagonal and the coincident case follow from
the requirement that both perpendicular points lie inside).

Folded, a corner of radius r lands on (r, z0), a tangency point on (0, z0), and a point at distance h from its side on
height z0 + h: x is the distance from the spine. The height is positive inside the shape and negative outside; z0 is the
ribbon's half-width.

A molecule with k corners has *parts*: one for a rabbit ear, two for a gusset, joined across the gusset's diagonal. Each
part has one centre where its *tangency edges* meet, one from each of its sides; the diagonal is a side of both parts.

Invariants: the facets of a molecule tile its polygon; every edge has the same length flat and folded.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from foldcut.core.arrays import BLOCK, Bools, Bytes, Floats, Ints, Numbers, Ragged, index_array, points_array, sealed
from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Region
from foldcut.geometry.planar_graph import pair_keys
from foldcut.geometry.tolerance import Tolerance
from foldcut.geometry.vectors import signed_area
from foldcut.methods.disks.packing import Packing


class Kind(IntEnum):
    """What a crease is in its molecule."""

    BISECTOR = 0  # from a corner, and the four sides of the gusset
    TANGENCY = 1  # from a side's tangency point, or the diagonal's midpoint, to the centre of a part
    DIAGONAL = 2  # the halves of a gusset's diagonal
    SIDE = 3  # the halves of a molecule's side
    RIBBON = 4  # across the ribbon, at a corner or at a tangency point


@dataclass(frozen=True, eq=False)
class Molecules:
    """All molecules of a packing on common vertices.

    ``vertices`` and ``folded`` ``(v, 2)`` mm. ``corners`` and ``feet`` ragged per molecule: the vertices at its disk
    centres, counter-clockwise, and the tangency point on the side after each. ``facets`` ragged: vertices
    counter-clockwise, with ``facet_molecule`` (-1 for the ribbon) and ``facet_corner`` (position in the molecule);
    a molecule's facets are listed around it, corner after corner, in the order the fold stacks them.
    ``creases`` ``(c, 2)`` vertices, each crease once, with ``crease_kind``; of a tangency crease ``crease_molecule``,
    ``crease_part`` and ``crease_side`` (the side's position, or k for the diagonal) are set, else -1.
    ``face`` ``(m,)``: the face of the plane a molecule lies in. ``side_part`` ragged: the part behind each side.
    ``boundary_sides``: rows (corner, tangency point, corner, loop) of the sides along loops, in loop order, with the
    face on their left. ``disk_vertex`` ``(disks,)``.
    """

    vertices: Floats
    folded: Floats
    corners: Ragged
    feet: Ragged
    facets: Ragged
    facet_molecule: Ints
    facet_corner: Bytes
    creases: Ints
    crease_kind: Bytes
    crease_molecule: Ints
    crease_part: Bytes
    crease_side: Bytes
    face: Ints
    side_part: Ragged
    boundary_sides: Ints
    disk_vertex: Ints

    def __len__(self) -> int:
        return len(self.corners)


def build_molecules(packing: Packing, tolerance: Tolerance) -> Molecules:
    """Fold the triangles with rabbit ears, the quadrilaterals with gussets, and lay the ribbon between.

    Raises ``UnfoldableError`` with the place when a quadrilateral has no gusset (it does not happen in a valid
    packing). Source: paper section 3, Figures 2 to 4; section 5, Figure 7 for the ribbon.
    """
    return _Builder(packing, tolerance).build()


@dataclass(frozen=True)
class _Template:
    """The creases and facets of one sort of molecule, in numbers of its own vertices.

    Its corners come first, then the feet, then what it has inside. ``creases`` rows: two vertices, kind, part, side;
    ``facets``: vertices and the corner each belongs to.
    """

    creases: Ints
    facets: tuple[tuple[tuple[int, ...], int], ...]
    side_part: tuple[int, ...]
    inner: int

    @classmethod
    def make(
        cls,
        corners: int,
        inner: list[tuple[int, int, Kind, int, int]],
        facets: list[tuple[list[int], int]],
        side_part: list[int],
        own: int,
    ) -> _Template:
        sides = []
        for k in range(corners):
            sides += [(k, corners + k, Kind.SIDE, -1, -1), (corners + k, (k + 1) % corners, Kind.SIDE, -1, -1)]
        rows = index_array(np.array([*sides, *inner], dtype=np.int32))
        return cls(rows, tuple((tuple(ring), corner) for ring, corner in facets), tuple(side_part), own)


def _ear_template(corners: int) -> _Template:
    """All creases meet in one point: the rabbit ear, or a gusset whose perpendicular points coincide."""
    apex = 2 * corners
    inner: list[tuple[int, int, Kind, int, int]] = []
    facets: list[tuple[list[int], int]] = []
    for k in range(corners):
        foot = corners + k
        inner += [(k, apex, Kind.BISECTOR, -1, -1), (foot, apex, Kind.TANGENCY, 0, k)]
        facets += [([corners + (k - 1) % corners, k, apex], k), ([k, foot, apex], k)]
    return _Template.make(corners, inner, facets, [0] * corners, 1)


def _gusset_template(first: int) -> _Template:
    r"""Two rabbit ears on the inset quadrilateral, joined along its diagonal p - r.

    ::

          d --------- c        u, v: perpendicular points (centres of the parts a b c and c d a)
          | \   v   / |        p, r: corners of the inset quadrilateral, on the bisectors at a and c
          |  p--m--r  |        m: where the diagonal p r meets u v
          | /   u   \ |
          a --------- b
    """
    a, b, c, d = ((first + k) % 4 for k in range(4))
    u, v, m, p, r = range(8, 13)
    feet = [4, 5, 6, 7]
    parts = [0] * 4
    parts[c] = parts[d] = 1
    inner = [(start, end, Kind.BISECTOR, -1, -1) for start, end in ((a, p), (c, r), (b, u), (d, v))]
    inner += [(start, end, Kind.BISECTOR, -1, -1) for start, end in ((p, u), (p, v), (r, u), (r, v))]
    inner += [(p, m, Kind.DIAGONAL, -1, -1), (m, r, Kind.DIAGONAL, -1, -1)]
    inner += [(feet[side], (u, v)[part], Kind.TANGENCY, part, side) for side, part in enumerate(parts)]
    inner += [(m, u, Kind.TANGENCY, 0, 4), (m, v, Kind.TANGENCY, 1, 4)]
    around = {
        a: [[feet[d], a, p, v], [v, p, m], [m, p, u], [a, feet[a], u, p]],
        b: [[feet[a], b, u], [b, feet[b], u]],
        c: [[feet[b], c, r, u], [u, r, m], [m, r, v], [c, feet[c], v, r]],
        d: [[feet[c], d, v], [d, feet[d], v]],
    }
    return _Template.make(4, inner, [(ring, corner) for corner in range(4) for ring in around[corner]], parts, 5)


TRIANGLE, COINCIDENT, GUSSET = 0, 1, 2  # the sorts of molecules; GUSSET + 1 has the other diagonal
TEMPLATES = (_ear_template(3), _ear_template(4), _gusset_template(0), _gusset_template(1))


class _Builder:
    """Makes all molecules at once.

    Vertices and creases are numbered as they come when one molecule is drawn after the other, each with its corners,
    its feet, what it has inside, its sides' creases and those inside; each vertex and crease where it first comes.
    """

    def __init__(self, packing: Packing, tolerance: Tolerance) -> None:
        self.packing = packing
        self.tolerance = tolerance
        self.disk = packing.gaps.values
        self.first = packing.gaps.offsets[:-1]
        self.size = packing.gaps.lengths
        self.molecule = packing.gaps.rows  # of each side
        self.next_side = packing.gaps.following
        self.following = self.disk[self.next_side]
        self.sign = np.where(packing.face_inside, 1.0, -1.0)[packing.gap_face]
        self.height = self.sign * packing.ribbon  # of a molecule's sides

    def build(self) -> Molecules:
        shapes = list(self._shapes())
        sort = np.empty(len(self.size), dtype=np.int8)
        for number, which, _, _ in shapes:
            sort[which] = number
        self._number_vertices(sort)
        points, folded = np.empty((self.count, 2)), np.empty((self.count, 2))
        self._draw_sides(points, folded)
        while shapes:
            _, which, flat, landed = shapes.pop()
            inner = self.inner_vertex[which][:, None] + np.arange(flat.shape[1])
            points[inner], folded[inner] = flat, landed
        boundary_sides, right = self._boundaries()
        ribbon_facets, ribbon_creases = self._ribbon(boundary_sides, right)
        creases, kinds, owner, part, side = self._creases(sort, ribbon_creases)
        facets, facet_molecule, facet_corner = self._facets(sort, ribbon_facets)
        parts = np.zeros(len(self.disk), dtype=np.int32)
        for number, template in enumerate(TEMPLATES[GUSSET:], start=GUSSET):
            parts[self.first[sort == number][:, None] + np.arange(4)] = template.side_part
        disk_vertex = np.full(len(self.packing.radii), -1, dtype=np.int32)
        disk_vertex[self.disk] = self.corner_vertex
        offsets = self.packing.gaps.offsets
        return Molecules(
            sealed(points),
            sealed(folded),
            Ragged(sealed(self.corner_vertex), offsets),
            Ragged(sealed(self.foot_vertex), offsets),
            facets,
            sealed(facet_molecule),
            sealed(facet_corner),
            sealed(creases),
            sealed(kinds),
            sealed(owner),
            sealed(part),
            sealed(side),
            self.packing.gap_face,
            Ragged(sealed(parts), offsets),
            sealed(boundary_sides),
            sealed(disk_vertex),
        )

    # --- where the inner vertices lie

    def _shapes(self) -> Iterator[tuple[int, Numbers, Floats, Floats]]:
        """Yield molecules of one sort each: the sort, which, their inner points ``(n, k, 2)``, and where these land."""
        for low in range(0, len(self.size), BLOCK):
            size = self.size[low : low + BLOCK]
            yield TRIANGLE, *self._triangles(low + np.flatnonzero(size == 3))
            yield from self._quadrilaterals(low + np.flatnonzero(size == 4))

    def _triangles(self, which: Numbers) -> tuple[Numbers, Floats, Floats]:
        centres, radii = self._disks(which, 3)
        apex, _ = _radical_centre(centres, radii)
        height = _height(apex, centres[:, 0], centres[:, 1])
        return which, apex[:, None], self._folded(which, np.zeros((len(which), 1)), height[:, None])

    def _quadrilaterals(self, which: Numbers) -> Iterator[tuple[int, Numbers, Floats, Floats]]:
        """Those with one inner point, and those with a gusset from corner 0, or 1."""
        centres, radii = self._disks(which, 4)
        choices = [_gusset(centres, radii, first) for first in (0, 1)]
        insets = np.stack([choice[0] for choice in choices])
        chosen = (insets[1] < insets[0]).astype(np.intp)
        bad = np.flatnonzero(np.isinf(insets.min(axis=0)))
        if len(bad):
            x, y = centres[bad[0]].mean(axis=0)
            raise UnfoldableError(
                f"the quadrilateral of disks near ({x:.3f}, {y:.3f}) mm has no gusset; move the drawing a little"
            )
        row = np.arange(len(which))
        u, v, u_height, v_height, distance = (
            np.stack([choice[k] for choice in choices])[chosen, row] for k in range(1, 6)
        )
        one_point = distance <= self.tolerance.tie * radii.min(axis=1, initial=np.inf) + self.tolerance.rounding
        middle, height = (u + v) / 2, (u_height + v_height) / 2
        at = which[one_point]
        landed = self._folded(at, np.zeros((len(at), 1)), height[one_point, None])
        yield COINCIDENT, at, middle[one_point, None], landed
        for first in (0, 1):
            mine = ~one_point & (chosen == first)
            at = which[mine]
            heights = (u_height[mine] + v_height[mine] - distance[mine]) / 2
            along = (v[mine] - u[mine]) / distance[mine, None]
            m = u[mine] + along * (u_height[mine] - heights)[:, None]
            p, p_x = _inset_corner(centres[mine], radii[mine], first, heights)
            r, r_x = _inset_corner(centres[mine], radii[mine], (first + 2) % 4, heights)
            zero = np.zeros(len(at))
            x = np.stack([zero, zero, zero, p_x, r_x], axis=1)
            z = np.stack([u_height[mine], v_height[mine], heights, heights, heights], axis=1)
            yield GUSSET + first, at, np.stack([u[mine], v[mine], m, p, r], axis=1), self._folded(at, x, z)

    def _disks(self, which: Numbers, sides: int) -> tuple[Floats, Floats]:
        disks = self.disk[self.first[which][:, None] + np.arange(sides)]
        return self.packing.centres[disks], self.packing.radii[disks]

    def _folded(self, which: Numbers, x: Floats, height: Floats) -> Floats:
        return np.stack([x, self.sign[which, None] * (self.packing.ribbon + height)], axis=2)

    # --- numbers

    def _number_vertices(self, sort: Numbers) -> None:
        """Find each corner's, foot's and molecule's vertices; without a ribbon two disks of a node share theirs."""
        own = np.array([template.inner for template in TEMPLATES])[sort]
        events = 2 * self.size + own
        ends = np.cumsum(events, dtype=np.int64)
        start = ends - events
        place = np.arange(len(self.disk)) - self.first[self.molecule]
        corner_event = start[self.molecule] + place
        foot_event = corner_event + self.size[self.molecule]
        key = self.packing.node[self.disk] if self.packing.ribbon == 0 else self.disk
        first_corner = _first_with(key)
        other = key[self.next_side]
        pair = pair_keys(np.minimum(key, other), np.maximum(key, other))
        _, at, inverse = np.unique(pair, return_index=True, return_inverse=True)
        first_foot = at[inverse]
        side = np.arange(len(self.disk))
        self.new_corner, self.new_foot = first_corner == side, first_foot == side
        number = np.zeros(int(ends[-1]) + 1, dtype=np.int32)
        number[corner_event[self.new_corner] + 1] = 1
        number[foot_event[self.new_foot] + 1] = 1
        inner = start + 2 * self.size
        for k in range(5):
            number[inner[own > k] + k + 1] = 1
        number = np.cumsum(number, dtype=np.int32)
        self.count = int(number[-1])
        self.corner_vertex = number[corner_event[first_corner]]
        self.foot_vertex = number[foot_event[first_foot]]
        self.inner_vertex = number[inner]

    def _draw_sides(self, points: Floats, folded: Floats) -> None:
        centres, radii = self.packing.centres, self.packing.radii
        at, disk = self.corner_vertex[self.new_corner], self.disk[self.new_corner]
        points[at] = centres[disk]
        folded[at, 0], folded[at, 1] = radii[disk], self.height[self.molecule[self.new_corner]]
        at, disk, other = self.foot_vertex[self.new_foot], self.disk[self.new_foot], self.following[self.new_foot]
        part = radii[disk] / (radii[disk] + radii[other])
        points[at] = centres[disk] + (centres[other] - centres[disk]) * part[:, None]
        folded[at, 0], folded[at, 1] = 0.0, self.height[self.molecule[self.new_foot]]

    def _local(self, which: Numbers, template: _Template) -> Ints:
        """The vertices of molecules of one sort: corners, feet, inner ones."""
        sides = self.first[which][:, None] + np.arange(len(template.side_part))
        inner = self.inner_vertex[which][:, None] + np.arange(template.inner, dtype=np.int32)
        return np.concatenate([self.corner_vertex[sides], self.foot_vertex[sides], inner], axis=1)

    def _creases(self, sort: Numbers, more: Ints) -> tuple[Ints, Bytes, Ints, Bytes, Bytes]:
        """Creases, and their kind, molecule, part and side; a side's only where its foot is new. ``more``: ribbon."""
        many = np.array([len(template.creases) for template in TEMPLATES])
        total = int(many[sort].sum()) - 2 * int((~self.new_foot).sum()) + len(more)
        creases, molecule = np.empty((total, 2), dtype=np.int32), np.full(total, -1, dtype=np.int32)
        kind, part, side = np.full((3, total), -1, dtype=np.int8)
        end = 0
        for low in range(0, len(sort), BLOCK):
            sorts = sort[low : low + BLOCK]
            start = np.cumsum(many[sorts]) - many[sorts]
            size = int(many[sorts].sum())
            pairs, columns = np.empty((size, 2), dtype=np.int32), np.empty((size, 3), dtype=np.int8)
            owner, kept = np.full(size, -1, dtype=np.int32), np.ones(size, dtype=np.bool_)
            for number, template in enumerate(TEMPLATES):
                which = np.flatnonzero(sorts == number)
                rows, sides = template.creases, len(template.side_part)
                at = start[which][:, None] + np.arange(len(rows))
                pairs[at] = self._local(low + which, template)[:, rows[:, :2]]
                columns[at] = rows[:, 2:]
                tangency = rows[:, 2] == Kind.TANGENCY
                owner[at[:, tangency]] = low + which[:, None]
                kept[at[:, : 2 * sides]] = np.repeat(
                    self.new_foot[self.first[low + which][:, None] + np.arange(sides)], 2, axis=1
                )
            new = slice(end, end + int(kept.sum()))
            creases[new], molecule[new] = pairs[kept], owner[kept]
            kind[new], part[new], side[new] = columns[kept].T
            end = new.stop
        creases[end:], kind[end:] = more, Kind.RIBBON
        return creases, kind, molecule, part, side

    def _facets(self, sort: Numbers, more: Ints) -> tuple[Ragged, Ints, Bytes]:
        """Facets, and their molecule and corner; ``more``: those of the ribbon, of four vertices each."""
        lengths = [np.array([len(ring) for ring, _ in template.facets]) for template in TEMPLATES]
        many, size = np.array([len(its) for its in lengths]), np.array([its.sum() for its in lengths])
        molecule = np.repeat(np.arange(len(sort), dtype=np.int32), many[sort])
        own, count = len(molecule), int(size[sort].sum())
        molecule = np.concatenate([molecule, np.full(len(more), -1, dtype=np.int32)])
        corner = np.full(len(molecule), -1, dtype=np.int8)
        offsets = np.zeros(len(molecule) + 1, dtype=np.int32)
        flat = np.empty(count + more.size, dtype=np.int32)
        facet = place = 0
        for low in range(0, len(sort), BLOCK):
            sorts = sort[low : low + BLOCK]
            start, first = facet + np.cumsum(many[sorts]) - many[sorts], place + np.cumsum(size[sorts]) - size[sorts]
            for number, template in enumerate(TEMPLATES):
                which = np.flatnonzero(sorts == number)
                order = [vertex for ring, _ in template.facets for vertex in ring]
                flat[first[which][:, None] + np.arange(len(order))] = self._local(low + which, template)[:, order]
                at = start[which][:, None] + np.arange(len(template.facets))
                offsets[at + 1] = first[which][:, None] + np.cumsum(lengths[number])
                corner[at] = [its_corner for _, its_corner in template.facets]
            facet, place = facet + int(many[sorts].sum()), place + int(size[sorts].sum())
        flat[count:] = more.ravel()
        offsets[own + 1 :] = count + 4 * np.arange(1, len(more) + 1)
        return Ragged(sealed(flat), sealed(offsets)), molecule, corner

    # --- the boundaries

    def _boundaries(self) -> tuple[Ints, Numbers]:
        """The sides along the loops, and of those with a ribbon the sides across it."""
        packing = self.packing
        nodes = packing.loop_nodes.values
        following = packing.loop_nodes.following
        loop = packing.loop_nodes.rows
        count = int(nodes.max(initial=-1)) + 1
        mine, other = packing.node[self.disk], packing.node[self.following]
        sides = np.flatnonzero((mine < count) & (other < count))
        keys = pair_keys(mine[sides], other[sides])
        sides, keys = sides[np.argsort(keys, kind="stable")], np.sort(keys)

        def found(one: Ints, following: Ints) -> Numbers:
            at = np.searchsorted(keys, pair_keys(one, following), side="right") - 1
            return sides[at]

        left = found(nodes, nodes[following])
        right = found(nodes[following], nodes)[loop > 0] if packing.ribbon > 0 else np.empty(0, dtype=np.intp)
        return np.column_stack([self._side(left), loop]).astype(np.int32), right

    def _side(self, sides: Numbers) -> Ints:
        """The corner, foot and next corner of sides, ``(n, 3)``."""
        vertices = (self.corner_vertex[sides], self.foot_vertex[sides], self.corner_vertex[self.next_side[sides]])
        return np.stack(vertices, axis=1)

    def _ribbon(self, boundary_sides: Ints, across: Numbers) -> tuple[Ints, Ints]:
        """Two facets between each side on the left border of the ribbon and its like on the right one, and creases."""
        if not len(across):
            return np.empty((0, 4), dtype=np.int32), np.empty((0, 2), dtype=np.int32)
        rows = boundary_sides[boundary_sides[:, 3] > 0]
        start, middle, end, loop = rows.T
        end_right, middle_right, start_right = self._side(across).T
        one = np.stack([start_right, middle_right, middle, start], axis=1)
        facets = np.stack([one, np.stack([middle_right, end_right, end, middle], axis=1)], axis=1).reshape(-1, 4)
        three = np.stack([start, start_right, middle, middle_right, end, end_right], axis=1).reshape(-1, 3, 2)
        first = np.append(True, loop[1:] != loop[:-1])
        new = np.stack([first, np.ones(len(rows), dtype=np.bool_), np.append(~first[1:], False)], axis=1)
        return facets, three[new]


def _first_with(keys: Numbers) -> Numbers:
    """For every place, the first place with the same key; keys are small numbers."""
    first = np.empty(int(keys.max()) + 1, dtype=np.int64)
    first[keys[::-1]] = np.arange(len(keys) - 1, -1, -1)
    return first[keys]


def _gusset(centres: Floats, radii: Floats, first: int) -> tuple[Floats, Floats, Floats, Floats, Floats, Floats]:
    """What the diagonal from corner ``first`` gives: inset height, perpendicular points, their heights and distance.

    The inset is infinite where the perpendicular points do not exist or do not lie inside.
    """
    a, b, c, d = ((first + k) % 4 for k in range(4))
    u, u_exists = _radical_centre(centres[:, [a, b, c]], radii[:, [a, b, c]])
    v, v_exists = _radical_centre(centres[:, [c, d, a]], radii[:, [c, d, a]])
    u_height, v_height = _height(u, centres[:, a], centres[:, b]), _height(v, centres[:, c], centres[:, d])
    x, y = (v - u).T
    distance = np.sqrt(x * x + y * y)
    good = u_exists & v_exists & (u_height > 0) & (v_height > 0)
    with np.errstate(invalid="ignore"):
        inset = np.where(good, u_height + v_height - distance, np.inf)
    return inset, u, v, u_height, v_height, distance


def _radical_centre(centres: Floats, radii: Floats) -> tuple[Floats, Bools]:
    """The points of equal power to three circles each, and whether there is one: not where centres are collinear."""
    (x, y), (ux, uy), (vx, vy) = centres[:, 0].T, (centres[:, 1] - centres[:, 0]).T, (centres[:, 2] - centres[:, 0]).T
    determinant = ux * vy - uy * vx
    exists = np.abs(determinant) > 1e-12 * (ux * ux + uy * uy + vx * vx + vy * vy)
    square = radii * radii
    u = (ux * ux + uy * uy + square[:, 0] - square[:, 1]) / 2
    v = (vx * vx + vy * vy + square[:, 0] - square[:, 2]) / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.stack([x + (u * vy - v * uy) / determinant, y + (ux * v - vx * u) / determinant], axis=1), exists


def _height(point: Floats, start: Floats, end: Floats) -> Floats:
    """The distances of points to the left of the lines from ``start`` to ``end``."""
    (ax, ay), (bx, by) = (end - start).T, (point - start).T
    with np.errstate(invalid="ignore"):
        heights: Floats = (ax * by - ay * bx) / np.sqrt(ax * ax + ay * ay)
    return heights


def _inset_corner(centres: Floats, radii: Floats, k: int, h: Floats) -> tuple[Floats, Floats]:
    """Corners k of the inset polygons at height h: on the bisector, their radius smaller by h cot(alpha / 2).

    The half angle's sine and cosine are half the lengths of the difference and the sum of the sides' directions.
    """
    corner = centres[:, k]
    (ax, ay), (bx, by) = _directions(corner, centres[:, (k + 1) % 4]), _directions(corner, centres[:, k - 1])
    apart_x, apart_y, sum_x, sum_y = ax - bx, ay - by, ax + bx, ay + by
    sine = np.sqrt(apart_x * apart_x + apart_y * apart_y) / 2
    cosine = np.where(ax * by - ay * bx >= 0, 1.0, -1.0) * np.sqrt(sum_x * sum_x + sum_y * sum_y) / 2
    reach = h / sine
    x = corner[:, 0] + reach * (ax * cosine - ay * sine)
    y = corner[:, 1] + reach * (ax * sine + ay * cosine)
    return np.stack([x, y], axis=1), radii[:, k] - h * (cosine / sine)


def _directions(start: Floats, end: Floats) -> tuple[Floats, Floats]:
    x, y = (end - start).T
    length = np.sqrt(x * x + y * y)
    return x / length, y / length


def regions(molecules: Molecules, parent: Sequence[int]) -> tuple[Region, ...]:
    """Return the molecules with their parents in T_M as regions of the sheet."""
    return tuple(
        Region((points_array(molecules.vertices[row]),), above)
        for row, above in zip(molecules.corners, parent, strict=True)
    )


def molecule_faults(molecules: Molecules, area: float, tolerance: Tolerance) -> list[str]:
    """List what breaks the molecules' invariants; ``area`` in mm^2 is what the facets must tile."""
    faults = []
    limit = 1e4 * tolerance.rounding
    edges = np.concatenate(
        [np.column_stack([row, np.roll(row, -1)]) for row in molecules.facets] or [np.empty((0, 2), dtype=np.int32)]
    )
    flat = molecules.vertices[edges[:, 1]] - molecules.vertices[edges[:, 0]]
    folded = molecules.folded[edges[:, 1]] - molecules.folded[edges[:, 0]]
    off = np.abs(np.hypot(flat[:, 0], flat[:, 1]) - np.hypot(folded[:, 0], folded[:, 1]))
    if off.max() > limit:
        x, y = molecules.vertices[edges[off.argmax(), 0]]
        faults.append(f"an edge near ({x:.4f}, {y:.4f}) changes its length by {off.max():.3g} mm when folded")
    areas = [signed_area(molecules.vertices[row]) for row in molecules.facets]
    if min(areas) <= 0:
        faults.append(f"{sum(a <= 0 for a in areas)} facets are not counter-clockwise")
    if abs(sum(areas) - area) > 1e-9 * area:
        faults.append(f"the facets cover {sum(areas):.9g} of {area:.9g} mm^2")
    return faults
