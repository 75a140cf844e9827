"""How many outlines are assessed in a second: by the proxy of the search, and the way its prototype did it.

Run it with ``make bench-outlines`` or ``python tests/bench/outlines.py [--seconds S] [--out OUT]``. The prototype's way
is a skeleton, perpendiculars traced in Python, the cheapest set of them, and the pattern's lines and lengths. Both ways
assess the same outlines in this process, in turns, each outline moved by a little every time; seconds are of the
processor. OUT gets outlines.json.

Nothing here can fail for being slow: the figure to look at is the ratio.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from support.outlines import A4, KINDS, corners_of, engine_for, random_outline, sample_outline
from support.slow_proxy import as_many_crossings, counted

from foldcut.core.arrays import Floats
from foldcut.core.errors import FoldcutError
from foldcut.core.model import Shape, Sheet
from foldcut.methods.skeleton.choices import fewest_folds
from foldcut.methods.skeleton.perpendiculars import trace
from foldcut.methods.skeleton.search import ridges_of
from foldcut.samples import sample_names

MOVED_MM = 0.05
"""How far corners are moved from one assessment to the next."""

REACH_MM = 5.0
"""How far perpendiculars may pass a node for the search to be told, which is a part of an assessment."""


def prototypes_way(shape: Shape, sheet: Sheet) -> None:
    """Assess an outline as the prototype did."""
    try:
        ridges = ridges_of(shape, sheet, 0.0)
        with as_many_crossings():
            perpendiculars = trace(ridges, ridges.odd)
        for taken in fewest_folds(perpendiculars, 1):
            counted(perpendiculars, taken, sheet)
    except FoldcutError:
        pass  # it has no skeleton, or has nodes without perpendiculars that end: that costs time, too


def seconds_each(assess: Callable[[Floats], Any], points: Floats, least: float, seed: int) -> float:
    """Return the seconds that an assessment takes, measured for ``least`` seconds or more."""
    rng = np.random.default_rng(seed)
    moved = [points + rng.uniform(-MOVED_MM, MOVED_MM, points.shape) for _ in range(50)]
    assess(moved[0])
    count, start = 0, time.process_time()
    while time.process_time() - start < least or count < 3:
        assess(moved[count % len(moved)])
        count += 1
    return (time.process_time() - start) / count


def measured(name: str, shape: Shape, sheet: Sheet, least: float) -> dict[str, Any]:
    """Return how many assessments a second of one outline both ways make."""
    points, sizes = corners_of(shape)
    engine = engine_for(shape, sheet)

    def slow(moved: Floats) -> None:
        prototypes_way(Shape(tuple(np.split(moved, np.cumsum(sizes)[:-1])), shape.parent), sheet)

    fast = 1 / seconds_each(lambda moved: engine.assess(moved, sizes, REACH_MM), points, least, 1)
    cost = 1 / seconds_each(lambda moved: engine.assess(moved, sizes), points, least, 1)
    before = 1 / seconds_each(slow, points, least, 1)
    return {
        "name": name, "corners": len(points), "prototype": before, "proxy": fast, "cost_only": cost,
        "ratio": fast / before, "ratio_cost_only": cost / before,
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=0.2, help="for each outline and way")
    parser.add_argument("--out", type=Path, default=Path("out"))
    options = parser.parse_args()
    outlines = [(name, *sample_outline(name)) for name in sample_names()]
    outlines += [(f"{kind} {seed}", random_outline(kind, seed), A4) for kind in KINDS for seed in range(4)]
    rows = []
    print(f"{'outline':16} {'corners':>7} {'prototype':>10} {'proxy':>8} {'ratio':>6} {'cost only':>10} {'ratio':>6}")
    for name, shape, sheet in outlines:
        row = measured(name, shape, sheet, options.seconds)
        rows.append(row)
        print(
            f"{name:16} {row['corners']:7} {row['prototype']:8.0f}/s {row['proxy']:6.0f}/s {row['ratio']:6.0f} "
            f"{row['cost_only']:8.0f}/s {row['ratio_cost_only']:6.0f}",
            flush=True,
        )
    medians = {key: float(np.median([row[key] for row in rows])) for key in ("ratio", "ratio_cost_only")}
    print(f"median ratio {medians['ratio']:.0f}, without what moves begin with {medians['ratio_cost_only']:.0f}")
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "outlines.json").write_text(json.dumps({"medians": medians, "outlines": rows}, indent=1))


if __name__ == "__main__":
    main()
