"""Read JSON loops: ``{"loops": [[[x, y], ...], ...], "units": "mm"}``, y up, even-odd.

``units`` (mm, cm, in or px) and ``title`` are optional; other keys are ignored. A file that ends in .json but holds
GeoJSON is passed to the reader of GeoJSON.
"""

from __future__ import annotations

import json

from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import FileFormatError
from foldcut.core.units import MM_PER_UNIT
from foldcut.readers import geojson
from foldcut.readers.base import Drawing, ReadOptions, Source, json_of
from foldcut.readers.join_outlines import closed_loops

_EXAMPLE = 'give {"loops": [[[0, 0], [40, 0], [0, 30]]], "units": "mm"}'
_UNITS = ("mm", "cm", "in", "px")


def read(source: Source, options: ReadOptions) -> Drawing:
    """Return the drawing in a file of JSON loops."""
    document = json_of(source, options, _EXAMPLE)
    if isinstance(document, dict) and "type" in document and "loops" not in document:
        return geojson.read(source, options)
    if not isinstance(document, dict) or "loops" not in document:
        raise FileFormatError(f"the file has no loops; {_EXAMPLE}")
    loops = document["loops"]
    if not isinstance(loops, list) or not loops:
        raise FileFormatError(f"loops is not a list with at least one loop; {_EXAMPLE}")
    unit = document.get("units")
    if unit is not None and unit not in _UNITS:
        raise FileFormatError(f"units is {unit!r}; give {', '.join(_UNITS)}, or leave it out")
    title, unit_mm = document.get("title"), None if unit is None else MM_PER_UNIT[unit]
    closed, repairs = closed_loops(
        [_loop(loop, f"loops[{number}]") for number, loop in enumerate(loops)], options, unit_mm
    )
    return Drawing(closed, unit_mm, title if isinstance(title, str) and title else source.name, repairs=repairs)


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
