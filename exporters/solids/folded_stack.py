"""The folded sheet as a solid: its layers as flat plates, each on those that it lies on, to see how thick it gets.

``FoldedPattern`` and a ``Profile`` with ``solid`` -> a mesh in mm, z up, from (0, 0, 0). The plates are as thick as the
sheet and come in the order of the layers that was proven; each lies as low as the ones below it allow. Creases are not
rounded, so the volume is that of the flat sheet. Needs the extra ``solids``.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from foldcut.core.arrays import Floats, Ints
from foldcut.core.errors import FileFormatError
from foldcut.core.model import FoldedPattern
from foldcut.geometry.union_find import groups
from foldcut.profiles import Profile

from ..pattern.fold import overlapping_faces
from .scored_sheet import check_bed, check_solid, sheet_solid

SAME_MM = 1e-6
"""Corners that are nearer to each other than this are one."""

GRID_MM = 1e-8
"""Corners, and where sides cross, are put on a grid this fine: sides that pass a corner more closely go through it."""


def solid_of(pattern: FoldedPattern, profile: Profile) -> Any:
    """Return the solid that a profile asks for, as a ``manifold3d.Manifold``: the scored sheet or the folded one.

    Errors as for ``sheet_solid`` and ``stack_solid``.
    """
    check_solid(profile)
    make = stack_solid if profile.solid is not None and profile.solid.folded else sheet_solid
    return make(pattern, profile)


def stack_solid(pattern: FoldedPattern, profile: Profile) -> Any:
    """Return the folded sheet as a ``manifold3d.Manifold``.

    Raises JobError: the profile has no ``solid``, or its bed is too small. Raises FileFormatError: the extra is
    missing, or too many faces overlap.
    """
    check_solid(profile)
    from manifold3d import CrossSection, FillRule, Manifold, OpType

    solid = profile.solid
    assert solid is not None
    points = _merged(pattern.folded.vertices_coords - pattern.folded.vertices_coords.min(axis=0))
    width, height = points.max(axis=0).tolist()
    check_bed(width, height, profile, "the folded sheet")
    outlines = [points[face] for face in pattern.creases.faces_vertices.to_lists()]
    plates = [
        Manifold.extrude(CrossSection(_loops(plate), FillRule.EvenOdd), 1.0).translate((0, 0, number))
        for number, plate in enumerate(_plates(outlines, levels(pattern)))
        if not plate.is_empty
    ]
    # whole numbers until here, so that each plate lies exactly on the next
    return Manifold.batch_boolean(plates, OpType.Add).scale((1.0, 1.0, solid.thickness_mm))


def _merged(points: Floats) -> Floats:
    """Return the points with those that are nearer than ``SAME_MM`` at one place."""
    places = shapely.points(points)
    pairs = shapely.STRtree(places).query(places, predicate="dwithin", distance=SAME_MM).T
    merged: Floats = points[groups(len(points), pairs[pairs[:, 0] < pairs[:, 1]].tolist())]
    return merged


def _plates(outlines: list[Floats], level: Ints) -> list[shapely.Geometry]:
    """Return what faces with these outlines cover on each level.

    The sides of all faces divide the plane into cells, of which each level is made: so sides that lie on each other,
    but for rounding errors, have the same corners on all levels, and no slivers come between them.
    """
    faces = shapely.polygons([shapely.linearrings(outline) for outline in outlines])
    sides = shapely.union_all(shapely.boundary(faces), grid_size=GRID_MM)
    cells = shapely.get_parts(shapely.polygonize(shapely.get_parts(sides)))
    cell, face = shapely.STRtree(faces).query(shapely.point_on_surface(cells), predicate="within")
    of_level = [np.unique(cell[level[face] == number]) for number in range(int(level.max()) + 1)]
    return [shapely.coverage_union_all(cells[some]) for some in of_level]


def _loops(plate: shapely.Geometry) -> list[Floats]:
    """Return the outer and inner boundaries of an area, ``(n, 2)`` mm each."""
    parts = [part for part in shapely.get_parts(plate) if isinstance(part, shapely.Polygon)]
    return [np.asarray(ring.coords)[:-1] for part in parts for ring in (part.exterior, *part.interiors)]


def levels(pattern: FoldedPattern) -> Ints:
    """Return on which level each face lies, ``(f,)``, from 0: one above the highest face under it.

    Raises FileFormatError: too many faces overlap to tell.
    """
    pairs = overlapping_faces(pattern)
    if pairs is None:
        raise FileFormatError("too many faces lie on each other for a solid of the folded sheet; leave --folded out")
    layers = pattern.folded.layers
    rank = np.empty(len(layers), dtype=np.int64)
    rank[layers] = np.arange(len(layers))
    ordered = np.sort(rank[pairs], axis=1)  # the lower one first
    ordered = ordered[np.argsort(ordered[:, 1], kind="stable")]
    starts = np.searchsorted(ordered[:, 1], np.arange(len(layers) + 1))
    at_rank = np.zeros(len(layers), dtype=np.int32)
    for number in range(len(layers)):
        below = ordered[starts[number] : starts[number + 1], 0]
        if len(below):
            at_rank[number] = at_rank[below].max() + 1
    return at_rank[rank]
