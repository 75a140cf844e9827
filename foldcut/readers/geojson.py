"""Read GeoJSON (RFC 7946): polygons or closed lines, and features and collections of them; y up, without a unit.

Longitude and latitude are not projected but taken as plane coordinates. The reader of JSON loops calls ``read`` if a
.json file holds GeoJSON.
"""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np

from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import FileFormatError
from foldcut.readers.base import Drawing, ReadOptions, Source, json_of
from foldcut.readers.join_outlines import drawing_of

_EXAMPLE = 'give {"type": "Polygon", "coordinates": [[[0, 0], [40, 0], [0, 30], [0, 0]]]}'


def read(source: Source, options: ReadOptions) -> Drawing:
    """Return the drawing in a GeoJSON file; its title is the name of the file."""
    document = json_of(source, options, _EXAMPLE)
    rings: list[Floats] = []
    lines: list[Floats] = []
    ignored: Counter[str] = Counter()
    waiting: list[tuple[Any, str]] = [(document, "the file")]
    while waiting:
        geometry, place = waiting.pop()
        kind = str(geometry.get("type")) if isinstance(geometry, dict) else "none"
        if kind == "Feature":
            if geometry.get("geometry") is not None:
                waiting.append((geometry["geometry"], f"{place} > geometry"))
        elif kind in ("FeatureCollection", "GeometryCollection"):
            key = "features" if kind == "FeatureCollection" else "geometries"
            members = enumerate(_list(geometry.get(key), f"{key} of {place}"))
            waiting += [(one, f"{place} > {key}[{number}]") for number, one in members][::-1]
        elif kind in ("Polygon", "MultiPolygon", "LineString", "MultiLineString"):
            drawn = _list(geometry.get("coordinates"), f"coordinates of {place}")
            if kind == "LineString":
                drawn = [drawn]
            elif kind == "MultiPolygon":
                drawn = [ring for polygon in drawn for ring in _list(polygon, f"coordinates of {place}")]
            found = [_loop(line, f"ring {number} of {place}") for number, line in enumerate(drawn)]
            rings, lines = (rings + found, lines) if kind.endswith("Polygon") else (rings, lines + found)
        elif kind in ("Point", "MultiPoint"):
            ignored["point"] += 1
        else:
            raise FileFormatError(f"{place} is not GeoJSON: its type is {kind[:40]!r}; {_EXAMPLE}")
    if not rings and not lines:
        raise FileFormatError(f"the file has no polygon; {_EXAMPLE}")
    drawing = drawing_of(rings, lines, source.name, options, ignored)
    if unclosed := sum(not np.array_equal(ring[0], ring[-1]) for ring in rings):
        told = f"closed {unclosed} ring{'s' * (unclosed > 1)} that did not repeat the first point"
        return replace(drawing, repairs=(told, *drawing.repairs))
    return drawing


def _list(value: Any, place: str) -> list[Any]:
    if not isinstance(value, list) or not value:
        raise FileFormatError(f"{place} is not a list, or it is empty; {_EXAMPLE}")
    return value


def _loop(ring: Any, place: str) -> Floats:
    points = _list(ring, place)
    for number, point in enumerate(points):
        long = isinstance(point, list) and len(point) >= 2
        if not long or not all(type(value) in (int, float) for value in point[:2]):
            raise FileFormatError(f"{place}: point {number} is {json.dumps(point)[:40]}; give [x, y]")
    try:
        return points_array([point[:2] for point in points])
    except OverflowError:
        raise FileFormatError(f"{place} has a number too large for float64; scale the drawing down") from None
