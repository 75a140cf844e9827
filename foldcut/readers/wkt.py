"""Read WKT (OGC 06-103r4, section 7): POLYGON, MULTIPOLYGON, and collections of them; y up, no unit.

All rings of the file are loops of one even-odd set.
"""

from __future__ import annotations

import numpy as np
import shapely

from foldcut.errors import FileFormatError
from foldcut.model import points_array
from foldcut.readers.base import Drawing, ReadOptions, Source

#: GEOS parses collections recursively: brackets nested too deep would overflow the stack.
_DEEPEST = 50


def read(source: Source, options: ReadOptions) -> Drawing:
    """Return the drawing in a WKT file; its title is the file's stem."""
    text = source.text()
    if _depth(text) > _DEEPEST:
        raise FileFormatError(f"brackets are nested more than {_DEEPEST} deep; give one flat MULTIPOLYGON")
    try:
        with np.errstate(all="ignore"):  # "nan" and "1e999" come back as such; make_shape refuses them by place
            geometry = shapely.from_wkt(text)
    except (shapely.errors.ShapelyError, NotImplementedError) as error:
        raise FileFormatError(f"not WKT: {error}; give a POLYGON or MULTIPOLYGON with closed rings") from None
    return drawing_of(geometry, source.name)


def drawing_of(geometry: shapely.Geometry, title: str, ignored: tuple[str, ...] = ()) -> Drawing:
    """Return the rings of a geometry's polygons as a drawing; other parts of it are a ``FileFormatError``."""
    polygons = _polygons(geometry, geometry.geom_type.upper())
    rings = [ring for polygon in polygons for ring in (polygon.exterior, *polygon.interiors)]
    loops = tuple(points_array(shapely.get_coordinates(ring)) for ring in rings)
    notes = ("the z coordinates were ignored",) if shapely.has_z(geometry) else ()
    return Drawing(loops, None, title, notes, ignored=ignored)


def _depth(text: str) -> int:
    steps = [(character == "(") - (character == ")") for character in text if character in "()"]
    return int(np.cumsum(steps).max()) if steps else 0


def _polygons(geometry: shapely.Geometry, place: str) -> list[shapely.Polygon]:
    """Return the polygons of a geometry, ``place`` being its path in the file."""
    if geometry.is_empty:
        raise FileFormatError(f"{place} is empty; give at least one ring")
    if isinstance(geometry, shapely.Polygon):
        return [geometry]
    if isinstance(geometry, shapely.MultiPolygon | shapely.GeometryCollection) and hasattr(geometry, "geoms"):
        return [
            polygon
            for number, part in enumerate(geometry.geoms, start=1)
            for polygon in _polygons(part, f"{place} > {part.geom_type.upper()} {number}")
        ]
    raise FileFormatError(f"{place} bounds no area; give a POLYGON or MULTIPOLYGON instead")
