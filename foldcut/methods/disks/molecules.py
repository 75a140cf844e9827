"""Molecules: how the polygon of each gap folds into a star of flaps whose border lies on one line.

``Packing`` -> ``Molecules`` (paper section 3). ``templates`` has the creases and facets of each sort of molecule,
``inner_points`` their geometry; here they become one mesh with common vertices.

A corner of radius r folds to (r, z0), a tangency point to (0, z0), and a point at distance h from its side to height
z0 + h: x is the distance from the spine. The height is positive inside the shape and negative outside; z0 is the
ribbon's half-width.

A molecule with k corners has *parts*: one for a rabbit ear, two for a gusset, joined across the gusset's diagonal. Each
part has one centre where its *tangency edges* meet, one from each of its sides; the diagonal is a side of both parts. A
*foot* is the tangency point on a side.

Invariants: the facets of a molecule tile its polygon; every edge has the same length flat and folded.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import BLOCK, Bools, Bytes, Floats, Ints, Numbers, Ragged, points_array, sealed
from foldcut.core.model import Region
from foldcut.geometry.planar_graph import pair_keys
from foldcut.geometry.vectors import signed_area
from foldcut.methods.disks.inner_points import InnerPoints, inner_points
from foldcut.methods.disks.packing import Packing
from foldcut.methods.disks.templates import GUSSET, TEMPLATES, Kind, Template
from foldcut.methods.disks.tolerance import Tolerance

__all__ = ["Kind", "Molecules", "build_molecules", "molecule_faults", "regions"]


@dataclass(frozen=True, eq=False)
class Molecules:
    """All molecules of a packing on common vertices.

    ``vertices`` and ``folded`` ``(v, 2)`` mm. ``corners`` and ``feet`` ragged per molecule: the vertices at its disk
    centres, counter-clockwise, and the tangency point on the side after each. ``facets`` ragged: vertices
    counter-clockwise, with ``facet_molecule`` (-1 for the ribbon) and ``facet_corner`` (position in the molecule);
    a molecule's facets are listed around it, corner after corner, in the order in which they are stacked.
    ``creases`` ``(c, 2)`` vertices, each crease once, with ``crease_kind``; ``crease_molecule``, ``crease_part`` and
    ``crease_side`` (the side's position, or k for the diagonal) are set for tangency edges and -1 for the rest.
    ``face`` ``(m,)``: the face of the plane that a molecule lies in. ``side_part`` ragged: the part behind each side.
    ``boundary_sides``: rows (corner, tangency point, corner, loop) of the sides along loops, in loop order, with the
    face on their left. ``disk_vertex`` ``(disks,)``: the vertex at each disk's centre, or -1.
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

    Raises ``UnfoldableError`` with the place where a quadrilateral has no gusset (this does not happen in a valid
    packing). Source: paper section 3, Figures 2 to 4; section 5, Figure 7 for the ribbon.
    """
    shapes = list(inner_points(packing, tolerance))
    sort = np.empty(len(packing.gaps), dtype=np.int8)
    for shape in shapes:
        sort[shape.molecules] = shape.sort
    sides = _Sides.of(packing)
    numbers = _Numbers.of(packing, sides, sort)
    points, folded = _placed(packing, sides, numbers, shapes)
    boundary_sides, right = _boundaries(packing, sides, numbers)
    ribbon_facets, ribbon_creases = _ribbon(boundary_sides, numbers.of_sides(sides, right))
    creases = _creases(sides, numbers, sort, ribbon_creases)
    facets, facet_molecule, facet_corner = _facets(sides, numbers, sort, ribbon_facets)
    parts = np.zeros(len(sides.disk), dtype=np.int32)
    for number, template in enumerate(TEMPLATES[GUSSET:], start=GUSSET):
        parts[sides.first[sort == number][:, None] + np.arange(4)] = template.side_part
    disk_vertex = np.full(len(packing.radii), -1, dtype=np.int32)
    disk_vertex[sides.disk] = numbers.corner_vertex
    offsets = packing.gaps.offsets
    return Molecules(
        vertices=sealed(points),
        folded=sealed(folded),
        corners=Ragged(sealed(numbers.corner_vertex), offsets),
        feet=Ragged(sealed(numbers.foot_vertex), offsets),
        facets=facets,
        facet_molecule=sealed(facet_molecule),
        facet_corner=sealed(facet_corner),
        creases=sealed(creases.vertices),
        crease_kind=sealed(creases.kind),
        crease_molecule=sealed(creases.molecule),
        crease_part=sealed(creases.part),
        crease_side=sealed(creases.side),
        face=packing.gap_face,
        side_part=Ragged(sealed(parts), offsets),
        boundary_sides=sealed(boundary_sides),
        disk_vertex=sealed(disk_vertex),
    )


@dataclass(frozen=True, eq=False)
class _Sides:
    """The sides of all molecules, one after the other.

    By side: the ``disk`` at its start, the ``next_side`` around the molecule, the disk ``following`` at its end, and
    the ``molecule``. By molecule: its ``first`` side and its ``size``.
    """

    disk: Ints
    next_side: Numbers
    following: Ints
    molecule: Ints
    first: Ints
    size: Ints

    @classmethod
    def of(cls, packing: Packing) -> _Sides:
        gaps = packing.gaps
        next_side = gaps.following
        return cls(gaps.values, next_side, gaps.values[next_side], gaps.rows, gaps.offsets[:-1], gaps.lengths)


@dataclass(frozen=True, eq=False)
class _Numbers:
    """The numbers of the vertices.

    Vertices are numbered as they come when one molecule is drawn after the other, each with its corners, its feet and
    its inner vertices; a vertex gets its number where it comes first. ``count``: of all vertices; by side the vertices
    at its corner and foot, and whether each is new there; by molecule its first inner vertex.
    """

    count: int
    corner_vertex: Ints
    foot_vertex: Ints
    inner_vertex: Ints
    new_corner: Bools
    new_foot: Bools

    @classmethod
    def of(cls, packing: Packing, sides: _Sides, sort: Bytes) -> _Numbers:
        """Number all vertices; without a ribbon two disks of a node share their vertices."""
        own = np.array([template.inner for template in TEMPLATES])[sort]
        events = 2 * sides.size + own
        ends = np.cumsum(events, dtype=np.int64)
        start = ends - events
        place = np.arange(len(sides.disk)) - sides.first[sides.molecule]
        corner_event = start[sides.molecule] + place
        foot_event = corner_event + sides.size[sides.molecule]
        key = packing.node[sides.disk] if packing.ribbon == 0 else sides.disk
        first_corner = _first_with(key)
        other = key[sides.next_side]
        pair = pair_keys(np.minimum(key, other), np.maximum(key, other))
        _, at, inverse = np.unique(pair, return_index=True, return_inverse=True)
        first_foot = at[inverse]
        side = np.arange(len(sides.disk))
        new_corner, new_foot = first_corner == side, first_foot == side
        number = np.zeros(int(ends[-1]) + 1, dtype=np.int32)
        number[corner_event[new_corner] + 1] = 1
        number[foot_event[new_foot] + 1] = 1
        inner = start + 2 * sides.size
        for k in range(max(template.inner for template in TEMPLATES)):
            number[inner[own > k] + k + 1] = 1
        number = np.cumsum(number, dtype=np.int32)
        corner_vertex, foot_vertex = number[corner_event[first_corner]], number[foot_event[first_foot]]
        return cls(int(number[-1]), corner_vertex, foot_vertex, number[inner], new_corner, new_foot)

    def of_molecules(self, sides: _Sides, which: Numbers, template: Template) -> Ints:
        """Return the vertices of molecules of one sort, a row for each: corners, feet, inner ones."""
        mine = sides.first[which][:, None] + np.arange(len(template.side_part))
        inner = self.inner_vertex[which][:, None] + np.arange(template.inner, dtype=np.int32)
        return np.concatenate([self.corner_vertex[mine], self.foot_vertex[mine], inner], axis=1)

    def of_sides(self, sides: _Sides, which: Numbers) -> Ints:
        """Return the corner, foot and next corner of sides, ``(n, 3)``."""
        vertices = (self.corner_vertex[which], self.foot_vertex[which], self.corner_vertex[sides.next_side[which]])
        return np.stack(vertices, axis=1)


def _placed(packing: Packing, sides: _Sides, numbers: _Numbers, shapes: list[InnerPoints]) -> tuple[Floats, Floats]:
    """Return where the vertices lie on the sheet and folded; ``shapes`` is emptied, to free memory on the way."""
    centres, radii = packing.centres, packing.radii
    height = np.where(packing.face_inside, 1.0, -1.0)[packing.gap_face] * packing.ribbon  # of each molecule's sides
    points, folded = np.empty((numbers.count, 2)), np.empty((numbers.count, 2))
    new = numbers.new_corner
    at, disk = numbers.corner_vertex[new], sides.disk[new]
    points[at] = centres[disk]
    folded[at, 0], folded[at, 1] = radii[disk], height[sides.molecule[new]]
    new = numbers.new_foot
    at, disk, other = numbers.foot_vertex[new], sides.disk[new], sides.following[new]
    part = radii[disk] / (radii[disk] + radii[other])
    points[at] = centres[disk] + (centres[other] - centres[disk]) * part[:, None]
    folded[at, 0], folded[at, 1] = 0.0, height[sides.molecule[new]]
    while shapes:
        shape = shapes.pop()
        inner = numbers.inner_vertex[shape.molecules][:, None] + np.arange(shape.flat.shape[1])
        points[inner], folded[inner] = shape.flat, shape.folded
    return points, folded


@dataclass(frozen=True, eq=False)
class _Creases:
    """The creases, as in ``Molecules``."""

    vertices: Ints
    kind: Bytes
    molecule: Ints
    part: Bytes
    side: Bytes


def _creases(sides: _Sides, numbers: _Numbers, sort: Bytes, ribbon: Ints) -> _Creases:
    """Put the templates' creases together, those of a side only where its foot is new; the ribbon's come last."""
    many = np.array([len(template.creases) for template in TEMPLATES])
    total = int(many[sort].sum()) - 2 * int((~numbers.new_foot).sum()) + len(ribbon)
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
            rows, corners = template.creases, len(template.side_part)
            at = start[which][:, None] + np.arange(len(rows))
            pairs[at] = numbers.of_molecules(sides, low + which, template)[:, rows[:, :2]]
            columns[at] = rows[:, 2:]
            tangency = rows[:, 2] == Kind.TANGENCY
            owner[at[:, tangency]] = low + which[:, None]
            kept[at[:, : 2 * corners]] = np.repeat(
                numbers.new_foot[sides.first[low + which][:, None] + np.arange(corners)], 2, axis=1
            )
        new = slice(end, end + int(kept.sum()))
        creases[new], molecule[new] = pairs[kept], owner[kept]
        kind[new], part[new], side[new] = columns[kept].T
        end = new.stop
    creases[end:], kind[end:] = ribbon, Kind.RIBBON
    return _Creases(creases, kind, molecule, part, side)


def _facets(sides: _Sides, numbers: _Numbers, sort: Bytes, ribbon: Ints) -> tuple[Ragged, Ints, Bytes]:
    """Put the templates' facets together, with their molecule and corner; the ribbon's, ``(n, 4)``, come last."""
    lengths = [np.array([len(outline) for outline, _ in template.facets]) for template in TEMPLATES]
    many, size = np.array([len(its) for its in lengths]), np.array([its.sum() for its in lengths])
    molecule = np.repeat(np.arange(len(sort), dtype=np.int32), many[sort])
    own, count = len(molecule), int(size[sort].sum())
    molecule = np.concatenate([molecule, np.full(len(ribbon), -1, dtype=np.int32)])
    corner = np.full(len(molecule), -1, dtype=np.int8)
    offsets = np.zeros(len(molecule) + 1, dtype=np.int32)
    flat = np.empty(count + ribbon.size, dtype=np.int32)
    facet = place = 0
    for low in range(0, len(sort), BLOCK):
        sorts = sort[low : low + BLOCK]
        start, first = facet + np.cumsum(many[sorts]) - many[sorts], place + np.cumsum(size[sorts]) - size[sorts]
        for number, template in enumerate(TEMPLATES):
            which = np.flatnonzero(sorts == number)
            order = [vertex for outline, _ in template.facets for vertex in outline]
            vertices = numbers.of_molecules(sides, low + which, template)
            flat[first[which][:, None] + np.arange(len(order))] = vertices[:, order]
            at = start[which][:, None] + np.arange(len(template.facets))
            offsets[at + 1] = first[which][:, None] + np.cumsum(lengths[number])
            corner[at] = [its_corner for _, its_corner in template.facets]
        facet, place = facet + int(many[sorts].sum()), place + int(size[sorts].sum())
    flat[count:] = ribbon.ravel()
    offsets[own + 1 :] = count + 4 * np.arange(1, len(ribbon) + 1)
    return Ragged(sealed(flat), sealed(offsets)), molecule, corner


def _boundaries(packing: Packing, sides: _Sides, numbers: _Numbers) -> tuple[Ints, Numbers]:
    """Return ``Molecules.boundary_sides``, and with a ribbon the sides across it from those of the shape's loops."""
    nodes = packing.loop_nodes.values
    following = packing.loop_nodes.following
    loop = packing.loop_nodes.rows
    count = int(nodes.max(initial=-1)) + 1
    mine, other = packing.node[sides.disk], packing.node[sides.following]
    along = np.flatnonzero((mine < count) & (other < count))
    keys = pair_keys(mine[along], other[along])
    along, keys = along[np.argsort(keys, kind="stable")], np.sort(keys)

    def found(one: Ints, following: Ints) -> Numbers:
        at = np.searchsorted(keys, pair_keys(one, following), side="right") - 1
        return along[at]

    left = found(nodes, nodes[following])
    right = found(nodes[following], nodes)[loop > 0] if packing.ribbon > 0 else np.empty(0, dtype=np.intp)
    return np.column_stack([numbers.of_sides(sides, left), loop]).astype(np.int32), right


def _ribbon(boundary_sides: Ints, across: Ints) -> tuple[Ints, Ints]:
    """Return the ribbon's facets, two between each side on its left border and the one across, and its creases.

    ``across`` ``(n, 3)``: the vertices of the sides on the right border.
    """
    if not len(across):
        return np.empty((0, 4), dtype=np.int32), np.empty((0, 2), dtype=np.int32)
    rows = boundary_sides[boundary_sides[:, 3] > 0]
    start, middle, end, loop = rows.T
    end_right, middle_right, start_right = across.T
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


def regions(molecules: Molecules, parent: Sequence[int]) -> tuple[Region, ...]:
    """Return the molecules as regions of the sheet; ``parent`` ``(m,)``: their parents in T_M."""
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
