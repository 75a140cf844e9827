"""How the checks write down what they find: a ``Finding`` with its place on the sheet."""

from __future__ import annotations

import numpy as np

from foldcut.core.arrays import Bools, Floats
from foldcut.core.model import CreasePattern, Finding

__all__ = ["MOST_FINDINGS", "at_edge", "finding", "first"]

MOST_FINDINGS = 1_000
"""No check writes down more of one kind: a file can be made so that there are as many as pairs of its edges."""


def first(wrong: Bools) -> list[int]:
    """Return where a mask is true, in order, but no more places than are written down."""
    places: list[int] = np.flatnonzero(wrong)[:MOST_FINDINGS].tolist()
    return places


def finding(check: str, message: str, place: Floats, size: float = 0.0) -> Finding:
    """Return a finding at a point of the sheet, ``(2,)``."""
    return Finding(check, message, (float(place[0]), float(place[1])), float(size))


def at_edge(pattern: CreasePattern, edge: int | np.integer, check: str, message: str, size: float = 0.0) -> Finding:
    """Return a finding at the middle of an edge."""
    middle = pattern.vertices_coords[pattern.edges_vertices[edge]].mean(axis=0)
    return finding(check, message, middle, size)
