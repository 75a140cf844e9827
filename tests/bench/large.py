"""How long the compact method takes for polygons with many corners, and how many creases it makes.

Run it with ``python tests/bench/large.py [CORNERS ...]``. It folds star-shaped polygons and prints a line of JSON for
each: ``seconds`` of processor time; ``exponent``, the power of the number of corners with which the time has grown
since the polygon before; ``tries``, how often the polygon was folded until no two vertices were too near each other.
5,000 corners take half a minute.
"""

from __future__ import annotations

import json
import math
import resource
import sys
import time

import numpy as np

import foldcut
from foldcut.core.arrays import Floats, points_array


def polygon(corners: int) -> Floats:
    """Return a wavy star-shaped polygon with uneven sides, always the same for the same number of corners."""
    random = np.random.default_rng(0)
    angles = (np.arange(corners) + random.uniform(0.1, 0.9, corners)) * 2 * np.pi / corners
    reach = 80 + 15 * np.sin(7 * angles) + 5 * np.sin(31 * angles)
    return points_array(np.stack([reach * np.cos(angles), reach * np.sin(angles)], axis=1))


def main(sizes: list[int]) -> None:
    """Fold a polygon of each size on A4 with the effort ``fast``, and print what that took."""
    before: tuple[int, float] | None = None
    for corners in sizes:
        start = time.process_time()
        result = foldcut.fold([polygon(corners)], method="compact", effort="fast", min_crease=0)
        seconds = time.process_time() - start
        row = {
            "corners": corners,
            "creases": result.folded_pattern.creases.crease_count,
            "verified": result.verified,
            "tries": int(result.numbers["tried"]),
            "seconds": round(seconds, 2),
            "exponent": round(math.log(seconds / before[1]) / math.log(corners / before[0]), 2) if before else None,
            "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024,
        }
        before = corners, seconds
        print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main([int(text) for text in sys.argv[1:]] or [100, 300, 1000])
