"""Read JSON loops: ``{"loops": [[[x, y], ...], ...], "units": "mm"}``, y up, even-odd.

``units`` (mm, cm, in or px) and ``title`` are optional; other keys are ignored. ``lines``, beside or instead of
``loops``, are cut along as they are drawn, open or not. A file that ends in .json but holds
GeoJSON is passed to the reader of GeoJSON.
"""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import FileFormatError
from foldcut.core.units import MM_PER_UNIT
from foldcut.readers import geojson
from foldcut.readers.base import Drawing, ReadOptions, Source, json_of
from foldcut.readers.join_outlines import Outline, closed_loops, loops_of

_EXAMPLE = 'give {"loops": [[[0, 0], [40, 0], [0, 30]]], "units": "mm"}'
_UNITS = ("mm", "cm", "in", "px")


def read(source: Source, options: ReadOptions) -> Drawing:
    """Return the drawing in a file of JSON loops."""
    document = json_of(source, options, _EXAMPLE)
    keys = {"loops", "lines"} & document.keys() if isinstance(document, dict) else set()
    if isinstance(document, dict) and "type" in document and not keys:
        return geojson.read(source, options)
    if not keys:
        raise FileFormatError(f"the file has no loops; {_EXAMPLE}")
    loops, lines = (_list(document, name) for name in ("loops", "lines"))
    unit = document.get("units")
    if unit is not None and unit not in _UNITS:
        raise FileFormatError(f"units is {unit!r}; give {', '.join(_UNITS)}, or leave it out")
    title, unit_mm = document.get("title"), None if unit is None else MM_PER_UNIT[unit]
    drawn = [_loop(loop, f"loops[{number}]") for number, loop in enumerate(loops)]
    title = title if isinstance(title, str) and title else source.name
    if lines or options.open_lines:
        open_lines = [_loop(line, f"lines[{number}]") for number, line in enumerate(lines)]
        outline = Outline([*((loop, True) for loop in drawn), *((line, False) for line in open_lines)])
        found = loops_of([outline], replace(options, open_lines=True), unit_mm, 0.0)
        return Drawing((), unit_mm, title, lines=found.lines, join=found.join)
    closed, repairs = closed_loops(drawn, options, unit_mm)
    return Drawing(closed, unit_mm, title, repairs=repairs)


def _list(document: dict[str, Any], name: str) -> list[Any]:
    """Return a list of the document, which may be missing."""
    if name not in document:
        return []
    value = document[name]
    if not isinstance(value, list) or not value:
        raise FileFormatError(f"{name} is not a list with at least one {name.removesuffix('s')}; {_EXAMPLE}")
    return value


def _loop(loop: object, place: str) -> Floats:
    if not isinstance(loop, list) or not loop:
        raise FileFormatError(f"{place} is not a list of points; give [[x, y], ...]")
    for number, point in enumerate(loop):
        pair = isinstance(point, list) and len(point) == 2
        if not pair or not all(type(value) in (int, float) for value in point):
            raise FileFormatError(f"{place}[{number}] is {json.dumps(point)[:40]}; give [x, y] with two numbers")
    try:
        return points_array(loop)
    except OverflowError:
        raise FileFormatError(f"{place} has a number too large for float64; scale the drawing down") from None
