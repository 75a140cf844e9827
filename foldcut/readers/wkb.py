"""Read WKB, binary or as hexadecimal digits (OGC 06-103r4, section 8): what WKT can say, y up, no unit."""

from __future__ import annotations

import re

import numpy as np
import shapely

from foldcut.errors import FileFormatError
from foldcut.readers.base import Drawing, ReadOptions, Source
from foldcut.readers.wkt import drawing_of

_HEX = re.compile(rb"\s*0[01](?:[0-9A-Fa-f]{2})+\s*")
_COLLECTION = re.compile(rb"(?:\x01\x07\0\0.|\0..\0\x07)", re.DOTALL)
_DEEPEST = 1000


def read(source: Source, options: ReadOptions) -> Drawing:
    """Return the drawing in a WKB file; its title is the file's stem."""
    data: bytes | str = source.data
    if _HEX.fullmatch(source.data):
        data = source.data.decode().strip()
    raw = bytes.fromhex(data) if isinstance(data, str) else data
    if len(_COLLECTION.findall(raw)) > _DEEPEST:  # GEOS parses collections recursively
        raise FileFormatError(f"there are more than {_DEEPEST} collections; give one flat MULTIPOLYGON")
    try:
        with np.errstate(all="ignore"):
            geometry = shapely.from_wkb(raw)
    except (shapely.errors.ShapelyError, NotImplementedError, ValueError, TypeError) as error:
        raise FileFormatError(f"not WKB: {error}; give a POLYGON or MULTIPOLYGON with closed rings") from None
    return drawing_of(geometry, source.name)
