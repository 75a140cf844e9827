"""Read WKB, binary or as hexadecimal digits (OGC 06-103r4, section 8): all that WKT can say; y up, without a unit."""

from __future__ import annotations

import re
import struct

import numpy as np
import shapely

from foldcut.core.errors import FileFormatError
from foldcut.readers.base import Drawing, ReadOptions, Source
from foldcut.readers.wkt import read_geometry

_HEX = re.compile(rb"\s*+0[01](?:[0-9A-Fa-f]{2})++\s*+")
_POINT, _LINES, _POLYGON, _COLLECTIONS = 1, (2, 8), 3, (4, 5, 6, 7, 9, 10, 11, 12)
_Z, _M, _SRID = 0x80000000, 0x40000000, 0x20000000
_BYTE_ORDERS = {0: ">", 1: "<"}


class _NotWkbError(Exception):
    """The bytes are not a geometry."""


def read(source: Source, options: ReadOptions) -> Drawing:
    """Return the drawing in a WKB file; its title is the name of the file."""
    data = source.data
    if _HEX.fullmatch(data):
        data = bytes.fromhex(data.decode().strip())
    try:
        options.limits.check_nesting(_depth(data))  # GEOS parses collections recursively
        with np.errstate(all="ignore"):
            geometry = shapely.from_wkb(data)
    except (shapely.errors.ShapelyError, NotImplementedError, struct.error, _NotWkbError) as error:
        about = str(error) if isinstance(error, shapely.errors.ShapelyError) else "its bytes are not a geometry"
        raise FileFormatError(f"not WKB: {about}; give a POLYGON or MULTIPOLYGON with closed rings") from None
    return read_geometry(geometry, source.name, options)


def _depth(data: bytes) -> int:
    """Return how deep geometries are nested; raises ``struct.error`` or ``_NotWkbError`` if the bytes are not WKB."""
    position, deepest, left = 0, 0, [1]
    while left:
        if not left[-1]:
            left.pop()
            continue
        left[-1] -= 1
        (first,) = struct.unpack_from("B", data, position)
        if first not in _BYTE_ORDERS:
            raise _NotWkbError
        order = _BYTE_ORDERS[first]
        (kind,) = struct.unpack_from(f"{order}I", data, position + 1)
        position += 9 if kind & _SRID else 5
        form, family = (kind & 0xFFFF) % 1000, (kind & 0xFFFF) // 1000
        size = 8 * (2 + bool(kind & _Z or family in (1, 3)) + bool(kind & _M or family in (2, 3)))
        if form == _POINT:
            position += size
            continue
        (count,) = struct.unpack_from(f"{order}I", data, position)
        position += 4
        if form in _COLLECTIONS:
            left.append(count)
            deepest = max(deepest, len(left) - 1)
        elif form == _POLYGON:
            for _ in range(count):
                (points,) = struct.unpack_from(f"{order}I", data, position)
                position += 4 + points * size
        elif form in _LINES:
            position += count * size
        else:
            raise _NotWkbError
    return deepest
