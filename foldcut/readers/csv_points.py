"""Read CSV points: x and y in each row, y up, without a unit.

A new loop begins after a blank line, and where the value in a loop column changes. Columns are separated by commas,
semicolons, tabs or blanks. A first row of words may name them: x, y and perhaps loop. Without it, they are x, y or
loop, x, y. Lines that begin with # are passed over.
"""

from __future__ import annotations

import re

from foldcut.core.arrays import points_array
from foldcut.core.errors import FileFormatError
from foldcut.readers.base import Drawing, ReadOptions, Source
from foldcut.readers.join_outlines import closed_loops

_EXAMPLE = 'give rows such as "40,0", with a blank line between loops'
_SEPARATOR = re.compile(r"\s*[,;\t]\s*|\s+")


def read(source: Source, options: ReadOptions) -> Drawing:
    """Return the drawing in a file of points; its title is the name of the file."""
    loops: list[list[tuple[float, float]]] = []
    columns: list[str] | None = None
    last: str | None = None
    new = True
    for number, line in enumerate(source.text().splitlines(), start=1):
        if line.lstrip().startswith("#"):
            continue
        cells = [cell.strip("\"'") for cell in _SEPARATOR.split(line.strip())]
        if not any(cells):
            new = True
            continue
        if columns is None:
            names = [cell.casefold() for cell in cells]
            columns = names if {"x", "y"} <= set(names) else (["loop"] if len(cells) == 3 else []) + ["x", "y"]
            if columns == names:
                continue
        row = dict(zip(columns, cells, strict=False))
        try:
            point = float(row["x"]), float(row["y"])
        except (KeyError, ValueError):
            raise FileFormatError(f"line {number} is {line.strip()[:40]!r}; {_EXAMPLE}") from None
        if len(cells) != len(columns):
            raise FileFormatError(f"line {number} has {len(cells)} columns, not {len(columns)}; {_EXAMPLE}")
        if new or row.get("loop") != last:
            loops.append([])
        loops[-1].append(point)
        last, new = row.get("loop"), False
    if not loops:
        raise FileFormatError(f"the file has no points; {_EXAMPLE}")
    closed, repairs = closed_loops(list(map(points_array, loops)), options, None)
    return Drawing(closed, None, source.name, repairs=repairs)
