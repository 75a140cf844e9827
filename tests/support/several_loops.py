"""Random shapes with several loops, by seed."""

from __future__ import annotations

import numpy as np

from foldcut.core.arrays import Floats


def star(random: np.random.Generator, count: int, x: float, y: float, radius: float, least: float) -> Floats:
    """A star-shaped polygon whose corners are ``least`` to 1 times ``radius`` from (x, y)."""
    angle = (np.arange(count) + random.uniform(0.1, 0.9, count)) * 2 * np.pi / count
    reach = radius * random.uniform(least, 1, count)
    return np.stack([x + reach * np.cos(angle), y + reach * np.sin(angle)], axis=1)


def random_loops(seed: int, *, holes: bool) -> list[Floats]:
    """A nearly convex outline with 1 to 3 convex or star-shaped holes, or 2 to 3 such components apart."""
    random = np.random.default_rng(seed)
    count = int(random.integers(1, 4) if holes else random.integers(2, 4))
    loops = [star(random, int(random.integers(5, 10)), 0, 0, 100, 0.85)] if holes else []
    away, size = (0.0 if count == 1 else 45.0, (40, 24, 20)[count - 1]) if holes else (60.0, 35)
    for k in range(count):
        turn = 2 * np.pi * k / count + random.uniform(-0.2, 0.2)
        x, y = away * np.cos(turn), away * np.sin(turn)
        corners, radius = int(random.integers(3, 7)), size * random.uniform(0.6, 1)
        loops.append(star(random, corners, x, y, radius, random.choice([0.5, 0.9])))
    return loops
