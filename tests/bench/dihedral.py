"""How many folds random shapes with several mirror axes through one point take: a table, one shape a row.

Run it with ``python tests/bench/dihedral.py [FIRST LAST [EFFORT]]``; 60 shapes by default. ``most`` is what they may
take: the folds that make the wedge, and three for each corner in the wedge. Exits with 1 if one takes more, or is not
verified.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import foldcut

sys.path.insert(0, str(Path(__file__).parents[1]))
from support.dihedral_shapes import DihedralShape, dihedral_shapes

from foldcut.pattern.first_folds import fan_folds

COLUMNS = "{:<32} {:>7} {:>9} {:>5} {:>5} {:>5} {:>8} {:>11} {:>7}  {}"


def main(first: int = 0, last: int = 60, effort: str = "normal") -> int:
    """Fold the random shapes on A4, just as they are."""
    head = ("shape", "corners", "in wedge", "axes", "folds", "most", "creases", "shortest mm", "seconds", "")
    print(COLUMNS.format(*head))
    rows = [_row(shape, effort) for shape in dihedral_shapes(range(first, last))]
    bad = sum(row[-1] != "" for row in rows)
    print(f"{len(rows)} shapes, {bad} of them not verified or with too many folds")
    return bad > 0


def _row(shape: DihedralShape, effort: str) -> tuple[object, ...]:
    """Fold a shape, and print and return its row."""
    start = time.perf_counter()
    most = fan_folds(shape.axes) + 3 * shape.sector_corners
    corners = sum(map(len, shape.loops)), shape.sector_corners
    numbers: tuple[object, ...] = ("", most, "", "")
    try:
        made = foldcut.fold(list(shape.loops), method="mirror", exact=True, effort=effort, min_crease=0.0)
        shortest = made.foldability.shortest_crease_mm
        numbers = made.actions, most, made.folded_pattern.creases.crease_count, f"{shortest:.2f}"
        wrong = "NOT VERIFIED" if made.findings else "TOO MANY" if made.actions > most else ""
    except foldcut.UnfoldableError as error:
        wrong = str(error)
    row = (shape.name, *corners, shape.axes, *numbers, f"{time.perf_counter() - start:.1f}", wrong)
    print(COLUMNS.format(*row), flush=True)
    return row


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:3]), *sys.argv[3:]))
