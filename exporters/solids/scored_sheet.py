"""The scored sheet as a solid, with a V-shaped groove for each crease, mountains on top and valleys below.

``FoldedPattern`` and a ``Profile`` with ``solid`` -> a mesh in mm, z up, the sheet's lower left corner at (0, 0, 0).
Grooves end in cones, so that those at a vertex meet without slivers. Where grooves of both sides cross, a web of
material is left between them.
Needs the extra ``solids``.
"""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

import numpy as np

from foldcut.core.arrays import Floats, Numbers
from foldcut.core.errors import FileFormatError
from foldcut.core.model import FoldedPattern
from foldcut.jobs.errors import JobError
from foldcut.pattern.straight_lines import straight_lines
from foldcut.profiles import Profile, Solid

CORNERS = 12
"""The number of corners of the polygon that stands for the base of a cone."""


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
    if 2 * solid.groove_depth_mm >= solid.thickness_mm:
        raise JobError(
            f"grooves of {solid.groove_depth_mm:g} mm from both sides leave nothing of {solid.thickness_mm:g} mm; "
            f"--set solid.groove_depth_mm={0.4 * solid.thickness_mm:.2g}"
        )


def sheet_solid(pattern: FoldedPattern, profile: Profile) -> Any:
    """Return the scored sheet as a ``manifold3d.Manifold``.

    Raises JobError: the profile has no ``solid``, or its grooves leave no web. Raises FileFormatError: the extra is
    missing, or the grooves cut the sheet into parts.
    """
    check_solid(profile)
    from manifold3d import Manifold, OpType

    solid = profile.solid
    assert solid is not None
    creases = pattern.creases
    grooves = []
    for letter, top in (("M", True), ("V", False)):
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
    """Return the corners of two cones that stand on their tips, ``(n, 3)``; the groove is their convex hull."""
    angle = np.arange(CORNERS) * 2 * np.pi / CORNERS
    # as high above the sheet as it is deep, so that no face of the groove lies in the sheet's surface
    radius, depth = solid.groove_width_mm, solid.groove_depth_mm
    circle = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    surface, inwards = (solid.thickness_mm, -1.0) if top else (0.0, 1.0)
    corners = [np.column_stack([end + circle, np.full(CORNERS, surface - inwards * depth)]) for end in line]
    tips = [np.append(end, surface + inwards * depth)[None] for end in line]
    return np.concatenate([*corners, *tips])


def corners_and_triangles(mesh: Any) -> tuple[Floats, Numbers]:
    """Return the corners of a ``manifold3d`` mesh, ``(v, 3)`` mm, and its triangles, ``(t, 3)``, facing outwards."""
    return np.asarray(mesh.vert_properties, dtype=np.float64)[:, :3], np.asarray(mesh.tri_verts, dtype=np.int64)
