"""How many random shapes with several loops the gate, or the skeleton, folds, and with how many creases.

Run it with ``python tests/bench/gate.py [FIRST LAST [METHOD]]``: one line a seed, for holes and for components.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import foldcut

sys.path.insert(0, str(Path(__file__).parents[1]))
from support.several_loops import random_loops


def main(first: int = 0, last: int = 25, method: str = "gate") -> None:
    """Fold the random shapes by a method, on A4 with a margin of 40 mm."""
    for seed in range(first, last):
        for holes in (True, False):
            loops = random_loops(seed, holes=holes)
            start = time.perf_counter()
            try:
                result = foldcut.fold(loops, method=method, margin=40)
                outcome = f"{result.folded_pattern.creases.crease_count} creases"
            except (foldcut.UnfoldableError, foldcut.BadInputError) as error:
                outcome = str(error)
            kind = "holes" if holes else "components"
            print(seed, kind, f"{len(loops)} loops: {outcome}, {time.perf_counter() - start:.1f} s", flush=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]), *sys.argv[3:])
