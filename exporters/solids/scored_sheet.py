"""The scored sheet as a solid, with a groove for each crease, mountains on top and valleys below, or all on top.

``FoldedPattern`` and a ``Profile`` with ``solid`` -> a mesh in mm, z up, the sheet's lower left corner at (0, 0, 0).
Grooves are V- or U-shaped and end in cones or half balls, so that those at a vertex meet without slivers. Where grooves
of both sides cross, a web of material is left between them.
Needs the extra ``solids``.
"""

from __future__ import annotations

import math
from importlib.util import find_spec
from typing import Any

import numpy as np

from foldcut.core.arrays import Floats, Numbers
from foldcut.core.errors import FileFormatError
from foldcut.core.model import FoldedPattern
from foldcut.jobs.bed import SLACK_MM
from foldcut.jobs.errors import JobError, TooLargeError
from foldcut.pattern.straight_lines import straight_lines
from foldcut.profiles import Profile, Solid

CORNERS = 12
"""The number of corners of the polygon that stands for a circle around the end of a groove."""

RINGS = 4
"""The number of such polygons between the rim and the bottom of a U-shaped groove."""


def needs(package: str) -> None:
    """Raise FileFormatError, which names the extra, unless ``package`` is installed."""
    if find_spec(package) is None:
        raise FileFormatError(f"solids need {package}: pip install 'foldcut[solids]'")


def check_solid(profile: Profile) -> None:
    """Raise, before there is a pattern, what ``sheet_solid`` would for any."""
    needs("manifold3d")
    solid = profile.solid
    if solid is None:
        raise JobError(f"the profile {profile.title!r} has no solid; leave --profile out, or use scored-sheet")
    sides = 1 if solid.one_sided else 2
    if not solid.folded and sides * solid.groove_depth_mm >= solid.thickness_mm:
        where = "on top" if solid.one_sided else "from both sides"
        raise JobError(
            f"grooves of {solid.groove_depth_mm:g} mm {where} leave nothing of {solid.thickness_mm:g} mm; "
            f"--set solid.groove_depth_mm={0.8 / sides * solid.thickness_mm:.2g}"
        )


def check_bed(width: float, height: float, profile: Profile, what: str) -> None:
    """Raise TooLargeError if a solid of this size, in mm, does not fit a profile's bed either way, if it has one."""
    bed = profile.bed
    if bed is None:
        return
    room, size = sorted((bed.width_mm, bed.height_mm)), sorted((width, height))
    if size[0] > room[0] + SLACK_MM or size[1] > room[1] + SLACK_MM:
        raise TooLargeError(
            f"{what} of {width:.6g} x {height:.6g} mm does not fit the bed of {bed.width_mm:g} x {bed.height_mm:g} mm",
            f"use a smaller --sheet, such as {room[0]:g}x{room[1]:g}mm",
            f"take a larger bed: --set bed.width_mm={math.ceil(width)} --set bed.height_mm={math.ceil(height)}",
        )


def sheet_solid(pattern: FoldedPattern, profile: Profile) -> Any:
    """Return the scored sheet as a ``manifold3d.Manifold``.

    Raises JobError: the profile has no ``solid``, its grooves leave no web, or its bed is too small. Raises
    FileFormatError: the extra is missing, or the grooves cut the sheet into parts.
    """
    check_solid(profile)
    check_bed(pattern.sheet.width, pattern.sheet.height, profile, "the sheet")
    from manifold3d import Manifold, OpType

    solid = profile.solid
    assert solid is not None
    creases = pattern.creases
    grooves = []
    for letter, top in (("M", True), ("V", solid.one_sided)):
        edges = creases.edges_vertices[creases.edges_assignment == letter].tolist()
        for a, b in straight_lines(creases.vertices_coords, edges):
            grooves.append(Manifold.hull_points(_groove(creases.vertices_coords[[a, b]], solid, top)))
    sheet = Manifold.cube((pattern.sheet.width, pattern.sheet.height, solid.thickness_mm))
    scored = Manifold.batch_boolean([sheet, *grooves], OpType.Subtract)
    parts = len(scored.decompose())
    if scored.is_empty() or parts != 1:
        raise FileFormatError(f"the scored sheet falls into {parts} parts: make the grooves narrower or flatter")
    return scored


def _groove(line: Floats, solid: Solid, top: bool) -> Floats:
    """Return the corners of what is cut away at the ends of a groove, ``(n, 3)``; the groove is their convex hull."""
    depth = solid.groove_depth_mm
    angle = np.arange(CORNERS) * 2 * np.pi / CORNERS
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    # as high above the sheet as it is deep, so that no face of the groove lies in the sheet's surface
    if solid.groove == "v":  # cones that stand on their tips
        rings = [(-depth, solid.width_mm)]
    else:  # half balls, and straight walls above them
        turns = np.arange(RINGS) * np.pi / 2 / RINGS
        rings = [(-depth, solid.width_mm / 2)]
        rings += [(depth * np.sin(turn), solid.width_mm / 2 * np.cos(turn)) for turn in turns]
    surface, inwards = (solid.thickness_mm, -1.0) if top else (0.0, 1.0)
    corners = [
        np.column_stack([end + radius * circle, np.full(CORNERS, surface + inwards * deep)])
        for end in line
        for deep, radius in rings
    ]
    tips = [np.append(end, surface + inwards * depth)[None] for end in line]
    return np.concatenate([*corners, *tips])


def corners_and_triangles(mesh: Any) -> tuple[Floats, Numbers]:
    """Return the corners of a ``manifold3d`` mesh, ``(v, 3)`` mm, and its triangles, ``(t, 3)``, facing outwards."""
    return np.asarray(mesh.vert_properties, dtype=np.float64)[:, :3], np.asarray(mesh.tri_verts, dtype=np.int64)
