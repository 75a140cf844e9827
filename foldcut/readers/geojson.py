"""Read GeoJSON (RFC 7946): Polygon, MultiPolygon, and features and collections of them; y up, no unit.

Coordinates are taken as plane ones: longitude and latitude are not projected. ``read`` is called by the reader of JSON
loops too, which tells the two apart.
"""

from __future__ import annotations

import json
from collections import Counter
from typing import Any

from foldcut.errors import FileFormatError
from foldcut.model import Floats, points_array
from foldcut.readers.base import Drawing, ReadOptions, Source, counted

_DEEPEST = 50
_EXAMPLE = 'give {"type": "Polygon", "coordinates": [[[0, 0], [40, 0], [0, 30], [0, 0]]]}'
_NO_AREA = {"Point", "MultiPoint", "LineString", "MultiLineString"}


def read(source: Source, options: ReadOptions) -> Drawing:
    """Return the drawing in a GeoJSON file; its title is the file's stem."""
    try:
        document = json.loads(source.text())
    except (ValueError, RecursionError) as error:
        raise FileFormatError(f"not JSON: {error}; {_EXAMPLE}") from None
    loops: list[Floats] = []
    ignored: Counter[str] = Counter()
    waiting: list[tuple[Any, str, int]] = [(document, "the file", 0)]
    while waiting:
        geometry, place, depth = waiting.pop()
        if depth > _DEEPEST:
            raise FileFormatError(f"collections are nested more than {_DEEPEST} deep; give one flat collection")
        kind = str(geometry.get("type")) if isinstance(geometry, dict) else "none"
        if kind == "Feature":
            if geometry.get("geometry") is not None:
                waiting.append((geometry["geometry"], f"{place} > geometry", depth + 1))
        elif kind in ("FeatureCollection", "GeometryCollection"):
            key = "features" if kind == "FeatureCollection" else "geometries"
            members = enumerate(_list(geometry.get(key), f"{key} of {place}"))
            waiting += [(one, f"{place} > {key}[{number}]", depth + 1) for number, one in members][::-1]
        elif kind in ("Polygon", "MultiPolygon"):
            rings = _list(geometry.get("coordinates"), f"coordinates of {place}")
            if kind == "MultiPolygon":
                rings = [ring for polygon in rings for ring in _list(polygon, f"coordinates of {place}")]
            loops += [_loop(ring, f"ring {number} of {place}") for number, ring in enumerate(rings)]
        elif kind in _NO_AREA:
            ignored[kind] += 1
        else:
            raise FileFormatError(f"{place} is no GeoJSON: its type is {kind[:40]!r}; {_EXAMPLE}")
    if not loops:
        raise FileFormatError(f"the file has no polygon; {_EXAMPLE}")
    return Drawing(tuple(loops), None, source.name, ignored=counted(ignored))


def _list(value: Any, place: str) -> list[Any]:
    if not isinstance(value, list) or not value:
        raise FileFormatError(f"{place} is no list with something in it; {_EXAMPLE}")
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
