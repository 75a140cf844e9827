"""The compact pattern: one molecule inside the shape, one outside it, and nothing else.

A walk along the boundary -> ``CreasePattern``, ``FoldedState``.

The outside is the molecule of the reversed walk. Its wavefront grows until it has left the sheet, and is clipped
there: a flat-folded sheet that is trimmed stays folded flat. The two stacks of layers are merged along the shape's
boundary, where a facet inside and one outside are one face; mountains and valleys are read off the stack.

Invariants: those of ``foldcut.pattern.assemble``; every edge has the same length flat and folded.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Bools, Floats, Numbers, points_array
from foldcut.core.model import CreasePattern, FoldedState, Region, Sheet
from foldcut.geometry.convex_sheet import ConvexSheet
from foldcut.geometry.vectors import cross, left_normal
from foldcut.methods.compact.facets import Vertices
from foldcut.methods.compact.molecule import Border, Molecule, NotClosedError, build_molecule
from foldcut.methods.compact.part_state import THRESHOLDS, Thresholds
from foldcut.pattern.assemble import Polygon, assemble, creases_of_stack, merge_stacks, outlines


@dataclass(frozen=True, eq=False)
class Walk:
    """How the boundary of a shape goes to and fro on the cut line when folded: its turns, counter-clockwise.

    A *turn* is a point of the boundary where it changes direction on the cut line: a corner of the shape, or a point on
    a side where a perpendicular crease begins. Turns are alternately *crests*, whose image x on the cut line is a local
    maximum, and *dips*. Turn 0 is the *root*, a dip that no other dip is lower than. A *pocket* is a part of the
    outside between the shape and its convex hull; a *turned* pocket is folded along the tree that is joined across the
    crests, not across the dips: see ``molecule``.

    ``points`` ``(n, 2)`` mm on the sheet; ``x`` ``(n,)`` mm: where they land; ``crests`` ``(n,)``: which are crests;
    ``directions`` ``(n, 2)``: unit vectors of the sides after them. ``pockets`` ``(n,)``: the pockets that a turn
    belongs to, as bits. ``levels`` ``(2, n)`` mm: where gusset creases that wrap a turn land, inside and outside: as
    far out as the turn's image ever comes. ``turned``: the turned pockets, as bits.
    """

    points: Floats
    x: Floats
    crests: Bools
    directions: Floats
    pockets: Numbers
    levels: Floats
    turned: int = 0


@dataclass(frozen=True, eq=False)
class Molecules:
    """The two molecules of a compact pattern, on common vertices."""

    vertices: Vertices
    inside: Molecule
    outside: Molecule


def build_molecules(
    walk: Walk,
    sheet: Sheet,
    progress: Callable[[float], None] | None = None,
    least: float = 0.0,
    thresholds: Thresholds = THRESHOLDS,
) -> Molecules:
    """Fold the inside and the outside of ``walk``; ``progress`` is told the part done where there is much to do.

    Raises ``UnfoldableError`` with the place when a molecule does not close, and ``CreaseTooShortError`` as soon as the
    crease of a gusset inside is shorter than ``least`` mm. ``thresholds``: by how many turns what is found how.
    """
    vertices = Vertices()
    numbers = [vertices.add(p, (float(x), 0.0)) for p, x in zip(walk.points, walk.x, strict=True)]
    size = float(np.ptp(walk.points, axis=0).max())
    nowhere = np.zeros_like(walk.pockets)
    inside = build_molecule(
        vertices,
        Border(numbers, walk.crests, walk.directions, nowhere, walk.levels[0]),
        sign=1,
        limit=None,
        size=size,
        least=least,
        progress=None if progress is None else lambda part: progress(part / 2),
        thresholds=thresholds,
    )
    back = -np.arange(len(numbers)) % len(numbers)  # the reversed walk begins at the root, too
    outside = build_molecule(
        vertices,
        Border(
            [numbers[k] for k in back],
            walk.crests[back],
            -walk.directions[back - 1],
            walk.pockets[back],
            walk.levels[1, back],
        ),
        sign=-1,
        limit=2 * sheet.diagonal,
        size=size,
        turned=walk.turned,
        progress=None if progress is None else lambda part: progress((1 + part) / 2),
        thresholds=thresholds,
    )
    return Molecules(vertices, inside, outside)


def fold_molecules(molecules: Molecules, sheet: Sheet) -> tuple[CreasePattern, FoldedState]:
    """Clip the outside at the sheet, stack all layers, and read off the creases.

    Raises ``NotClosedError`` when the layers inside and outside do not match.
    """
    inside, outside = molecules.inside, molecules.outside
    count, sides = len(inside.facets), inside.border_facets
    # facet k of the reversed walk begins at the border where facet sides - 1 - k of the walk does: they are one face
    number = [sides - 1 - facet if facet < sides else count + facet for facet in range(len(outside.facets))]
    shared = set(range(sides))
    outer_order = [number[facet] for facet in reversed(outside.order)]
    if [face for face in inside.order if face in shared] != [face for face in outer_order if face in shared]:
        raise NotClosedError("the layers inside and outside do not match along the shape's boundary", set())
    order = merge_stacks(inside.order, outer_order, shared)[::-1]
    clip = _Clip(molecules.vertices, sheet)
    polygons: dict[int, list[Polygon]] = {facet: clip.clip(polygon) for facet, polygon in enumerate(inside.polygons())}
    for facet, polygon in enumerate(outside.polygons()):
        polygons.setdefault(number[facet], []).extend(clip.clip(polygon))
    flat, folded = np.array(molecules.vertices.flat), np.array(molecules.vertices.folded)
    faces = [polygon for face in order for polygon in outlines(polygons[face])]
    edges, kinds = creases_of_stack(folded, faces)
    return assemble(flat, folded, faces, edges, kinds, clip.corners())


def regions(walk: Walk, molecules: Molecules, sheet: Sheet) -> tuple[Region, ...]:
    """Return the whole sheet, the inside of the shape in it, and the parts that inside and outside fall into."""
    found = [Region((sheet.corners,), -1), Region((points_array(walk.points),), 0)]
    for whole, molecule in ((1, molecules.inside), (0, molecules.outside)):
        first = len(found)
        found += [
            Region((points_array(outline),), whole if parent < 0 else first + parent)
            for outline, parent in molecule.parts
        ]
    return tuple(found)


class _Clip:
    """Cuts the outlines of facets, polygons of vertices, off at the sheet's four sides; a common edge is cut once."""

    def __init__(self, vertices: Vertices, sheet: Sheet) -> None:
        self.vertices = vertices
        self.sheet = sheet
        self.tie = 1e-11 * sheet.diagonal
        self.sides = _sides(sheet)
        self.cuts: dict[tuple[int, int, int], int] = {}
        flat = np.array(vertices.flat)
        beyond = np.max([flat @ outward - limit for outward, limit in self.sides], axis=0)
        self.within, self.well_within = (beyond <= self.tie).tolist(), (beyond < -self.tie).tolist()

    def clip(self, polygon: Polygon) -> list[Polygon]:
        """Return what is left of a polygon inside the sheet: none or one polygon."""
        if all(self.within[v] for v in polygon) and any(self.well_within[v] for v in polygon):
            return [polygon]
        for side, ((x, y), limit) in enumerate(self.sides):
            if not polygon:
                break
            beyond = [self.vertices.flat[v][0] * x + self.vertices.flat[v][1] * y - limit for v in polygon]
            kept: Polygon = []
            for k, (v, d) in enumerate(zip(polygon, beyond, strict=True)):
                after = (k + 1) % len(polygon)
                if d <= self.tie:
                    kept.append(v)
                if (d < -self.tie and beyond[after] > self.tie) or (d > self.tie and beyond[after] < -self.tie):
                    kept.append(self._cut(v, polygon[after], side))
            polygon = kept if any(d < -self.tie for d in beyond) else []
        return [polygon] if len(polygon) > 2 else []

    def _cut(self, a: int, b: int, side: int) -> int:
        key = (min(a, b), max(a, b), side)
        if key not in self.cuts:
            outward, limit = np.array(self.sides[side][0]), self.sides[side][1]
            start, end = np.array(self.vertices.flat[key[0]]), np.array(self.vertices.flat[key[1]])
            part = float((limit - start @ outward) / ((end - start) @ outward))
            place = start + (end - start) * part
            place += (limit - place @ outward) * outward
            (x0, z0), (x1, z1) = self.vertices.folded[key[0]], self.vertices.folded[key[1]]
            self.cuts[key] = self.vertices.add(place, (x0 + (x1 - x0) * part, z0 + (z1 - z0) * part))
            self.vertices.cuts.append((self.cuts[key], *key[:2], self.sides[side][0]))
        return self.cuts[key]

    def corners(self) -> set[int]:
        """The vertices at the sheet's corners."""
        flat = np.array(self.vertices.flat)
        return {
            int(v)
            for corner in self.sheet.corners
            for v in np.flatnonzero(np.abs(flat - corner).max(axis=1) <= self.tie)
        }


def _sides(sheet: Sheet) -> list[tuple[tuple[float, float], float]]:
    """Return the lines that bound a sheet: the unit normal outwards, and how far in this direction the line is."""
    if not isinstance(sheet, ConvexSheet):
        return [((-1.0, 0.0), 0.0), ((1.0, 0.0), sheet.width), ((0.0, -1.0), 0.0), ((0.0, 1.0), sheet.height)]
    sides = []
    for start, end in zip(sheet.corners, np.roll(sheet.corners, -1, axis=0), strict=True):
        x, y = (-left_normal(end - start) / np.hypot(*(end - start))).tolist()
        sides.append(((x, y), float(start @ (x, y))))
    return sides


def molecule_faults(molecules: Molecules) -> list[str]:
    """List edges of facets that do not keep their length when folded, and facets turned over."""
    flat, folded = np.array(molecules.vertices.flat), np.array(molecules.vertices.folded)
    limit = 1e-9 * float(np.ptp(flat, axis=0).max())
    faults = []
    for name, molecule in (("inside", molecules.inside), ("outside", molecules.outside)):
        polygons = [(number, polygon) for number, polygon in enumerate(molecule.polygons()) if polygon]
        start = np.array([v for _, polygon in polygons for v in polygon])
        end = np.array([v for _, polygon in polygons for v in (*polygon[1:], polygon[0])])
        first = np.cumsum([0, *(len(polygon) for _, polygon in polygons[:-1])])
        stretch = np.abs(np.hypot(*(flat[end] - flat[start]).T) - np.hypot(*(folded[end] - folded[start]).T))
        stretch = np.maximum.reduceat(stretch, first)
        origin = flat[start[first]].repeat(np.diff([*first, len(start)]), axis=0)
        area = np.add.reduceat(cross(flat[start] - origin, flat[end] - flat[start]), first)
        faults += [
            f"facet {polygons[k][0]} {name} is stretched by {stretch[k]:.3g} mm"
            for k in np.flatnonzero(stretch > limit).tolist()
        ]
        faults += [
            f"facet {polygons[k][0]} {name} is not counter-clockwise" for k in np.flatnonzero(area <= 0).tolist()
        ]
    return faults
