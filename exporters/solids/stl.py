"""STL: the scored sheet, or the folded one, as triangles, for 3D printers and CAD.

Input: a ``FoldedPattern`` and a ``Profile`` with ``solid``; output: binary STL, mm. Needs the extra ``solids``.
"""

from __future__ import annotations

import numpy as np

from foldcut.core.model import FoldedPattern
from foldcut.profiles import Profile

from .folded_stack import solid_of
from .scored_sheet import corners_and_triangles


def export(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return the sheet as an STL file; errors as for ``solid_of``."""
    points, triangles = corners_and_triangles(solid_of(pattern, profile).to_mesh64())
    corners = points[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    facets = np.zeros(len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    facets["normal"], facets["corners"] = normal, corners
    folded = profile.solid is not None and profile.solid.folded
    name = b"foldcut folded sheet, mm" if folded else b"foldcut scored sheet, mm"
    return name.ljust(80) + np.uint32(len(corners)).tobytes() + facets.tobytes()
