"""Seeded loops for the bench: ``star`` is star-shaped with a rough outline, ``koch`` a fractal.

``koch`` is a Koch snowflake whose every bump is turned and sized at random.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

DISKS_A_CORNER = {"star": 4.0, "koch": 5.2}
"""About how many boundary disks a loop gets for each of its corners."""


def star_loop(corners: int, seed: int) -> np.ndarray:
    """Return a loop, ``(corners, 2)``, seen whole from the origin, as rough on every scale."""
    rng = np.random.default_rng(seed)
    turn = (np.arange(corners) + 0.4 * (rng.random(corners) - 0.5)) / corners
    radius = np.full(corners, 1.0)
    waves = 3
    while waves < corners / 4:
        radius += 0.5 / waves * np.sin(2 * math.pi * (waves * turn + rng.random()))
        waves *= 2
    radius += 1.5 / corners * (rng.random(corners) - 0.5)
    return np.column_stack([radius * np.cos(2 * math.pi * turn), radius * np.sin(2 * math.pi * turn)])


def koch_loop(corners: int, seed: int) -> np.ndarray:
    """Return a snowflake, about ``(corners, 2)``: each round the longest edges get a bump of random height."""
    rng = np.random.default_rng(seed)
    points = np.exp(2j * math.pi * np.arange(3) / 3)
    while len(points) < corners:
        along = np.roll(points, -1) - points
        bumps = min(len(points), math.ceil((corners - len(points)) / 3))
        chosen = np.zeros(len(points), dtype=bool)
        chosen[np.argsort(-np.abs(along), kind="stable")[:bumps]] = True
        place, height = 0.5 + 0.1 * (rng.random(len(points)) - 0.5), 0.22 + 0.06 * rng.random(len(points))
        one, tip, other = (
            points + (place - 0.15) * along,
            points + (place - 1j * height) * along,
            points + (place + 0.15) * along,
        )
        rows = np.stack([points, one, tip, other], axis=1)
        keep = np.stack([np.ones(len(points), dtype=bool), chosen, chosen, chosen], axis=1)
        points = rows[keep]
    return np.column_stack([points.real, points.imag])


LOOPS: dict[str, Callable[[int, int], np.ndarray]] = {"star": star_loop, "koch": koch_loop}


def loop_of(kind: str, disks: int, seed: int) -> np.ndarray:
    """Return a loop, ``(corners, 2)``, that gets about so many boundary disks."""
    return LOOPS[kind](max(3, round(disks / DISKS_A_CORNER[kind])), seed)
