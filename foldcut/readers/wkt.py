"""Read WKT (OGC 06-103r4, section 7): polygons or closed lines, and collections of them; y up, without a unit.

All rings of the file, in WKT's sense of the word, are loops of one even-odd set.
"""

from __future__ import annotations

import warnings
from collections import Counter
from dataclasses import replace

import numpy as np
import shapely

from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import FileFormatError
from foldcut.readers.base import Drawing, ReadOptions, Source, brackets_depth
from foldcut.readers.join_outlines import drawing_of


def read(source: Source, options: ReadOptions) -> Drawing:
    """Return the drawing in a WKT file; its title is the name of the file."""
    text = source.text()
    options.limits.check_nesting(brackets_depth(text, "(", ")"))  # GEOS parses collections recursively
    repairs: tuple[str, ...] = ()
    try:
        with np.errstate(all="ignore"):  # "nan" and "1e999" are kept; make_shape refuses them and says where
            try:
                geometry = shapely.from_wkt(text)
            except shapely.errors.GEOSException:
                with warnings.catch_warnings(action="ignore"):
                    geometry = shapely.from_wkt(text, on_invalid="fix")  # which closes rings
                if geometry is None:
                    raise
                repairs = ("closed rings that did not repeat the first point",)
    except (shapely.errors.ShapelyError, NotImplementedError) as error:
        raise FileFormatError(f"not WKT: {error}; give a POLYGON or MULTIPOLYGON with closed rings") from None
    drawing = read_geometry(geometry, source.name, options, closed=not repairs)
    return replace(drawing, repairs=(*repairs, *drawing.repairs))


def read_geometry(geometry: shapely.Geometry, title: str, options: ReadOptions, *, closed: bool = True) -> Drawing:
    """Return the rings of a geometry's polygons, or if it has none, its lines, as a drawing.

    ``closed``: the file repeats the first point of every ring.
    """
    rings: list[Floats] = []
    lines: list[Floats] = []
    ignored: Counter[str] = Counter()
    waiting = [(geometry, geometry.geom_type.upper())]
    while waiting:
        part, place = waiting.pop()
        if isinstance(part, shapely.Point | shapely.MultiPoint):
            ignored["point"] += 1
        elif part.is_empty:
            raise FileFormatError(f"{place} is empty; give at least one ring")
        elif isinstance(part, shapely.Polygon):
            around = [shapely.get_coordinates(ring) for ring in (part.exterior, *part.interiors)]
            rings += [points_array(ring if closed else ring[:-1]) for ring in around]
        elif isinstance(part, shapely.LineString):
            lines.append(points_array(shapely.get_coordinates(part)))
        elif isinstance(part, shapely.geometry.base.BaseMultipartGeometry):
            try:
                parts = list(enumerate(part.geoms, start=1))
            except NotImplementedError:
                what = f"{place} has curves, which are not read"
                raise FileFormatError(f"{what}; give polygons instead, as PostGIS makes with ST_CurveToLine") from None
            waiting += [(one, f"{place} > {one.geom_type.upper()} {number}") for number, one in parts][::-1]
        else:
            raise FileFormatError(f"{place} cannot be read; give a POLYGON or MULTIPOLYGON instead")
    if not rings and not lines:
        raise FileFormatError(f"{geometry.geom_type.upper()} bounds no area; give a POLYGON or MULTIPOLYGON instead")
    notes = ("the z coordinates were ignored",) if shapely.has_z(geometry) else ()
    return replace(drawing_of(rings, lines, title, options, ignored), notes=notes)
