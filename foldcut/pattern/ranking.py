"""Which of two patterns is easier to fold."""

from __future__ import annotations

import numpy as np

from foldcut.core.model import CreasePattern

FOLDABLE_MM, SHORTEST_MM = 3.0, 0.5


TOO_SHORT, STILL_SHORTER = 1.65, 0.6  # what creases count when the shortest is nearly foldable, and what more at 0 mm


Rank = tuple[bool, float, float]


def shortest_crease(creases: CreasePattern) -> float:
    """Return the length of the shortest crease in mm."""
    ends = creases.vertices_coords[creases.edges_vertices[creases.edges_assignment != "B"]]
    return float(np.hypot(*(ends[:, 1] - ends[:, 0]).T).min())


def rank(count: float, shortest: float) -> Rank:
    """Patterns in order: those with all creases long enough to fold at all, then fewer creases, then longer ones.

    ``count`` of creases, ``shortest`` in mm.
    """
    if shortest < FOLDABLE_MM:
        count *= TOO_SHORT + STILL_SHORTER * (1 - shortest / FOLDABLE_MM)
    return shortest < SHORTEST_MM, count, -shortest
