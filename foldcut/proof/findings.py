"""How the checks write down what they find: a ``Finding`` with its place on the sheet."""

from __future__ import annotations

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.model import CreasePattern, Finding

__all__ = ["at_edge", "finding"]


def finding(check: str, message: str, place: Floats, size: float = 0.0) -> Finding:
    """Return a finding at a point of the sheet, ``(2,)``."""
    return Finding(check, message, (float(place[0]), float(place[1])), float(size))


def at_edge(pattern: CreasePattern, edge: int | np.integer, check: str, message: str, size: float = 0.0) -> Finding:
    """Return a finding at the middle of an edge."""
    middle = pattern.vertices_coords[pattern.edges_vertices[edge]].mean(axis=0)
    return finding(check, message, middle, size)
