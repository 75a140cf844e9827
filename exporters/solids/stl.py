"""STL: the scored sheet as triangles, for 3D printers and CAD.

Input: a ``FoldedPattern`` and a ``Profile`` with ``solid``; output: binary STL, mm. Needs the extra ``solids``.
"""

from __future__ import annotations

import numpy as np

from foldcut.core.model import FoldedPattern
from foldcut.profiles import Profile

from .scored_sheet import corners_and_triangles, sheet_solid


def export(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return the scored sheet as an STL file; errors as for ``sheet_solid``."""
    points, triangles = corners_and_triangles(sheet_solid(pattern, profile).to_mesh64())
    corners = points[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    facets = np.zeros(len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    facets["normal"], facets["corners"] = normal, corners
    return b"foldcut scored sheet, mm".ljust(80) + np.uint32(len(corners)).tobytes() + facets.tobytes()
