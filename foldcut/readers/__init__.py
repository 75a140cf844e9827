"""Read a drawing from a file: one module for each format, chosen by the suffix of the file.

A path, or ``-`` for standard input -> ``Drawing``: loops in drawing units, y up. A reader takes the bytes and the
options, and returns a ``Drawing`` or raises ``FileFormatError`` about the content; it opens no file. Whether the loops
are a valid shape is for ``make_shape`` to say. To add a format, add a module with a function ``read``, and a row in
``READERS``.
"""

from __future__ import annotations

import hashlib
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import NamedTuple

from shapely.errors import ShapelyError

from foldcut.core.errors import BadInputError, FileFormatError
from foldcut.core.files import is_standard_input, read_bytes
from foldcut.core.text import as_title
from foldcut.readers.base import Drawing, ReadOptions, Source

__all__ = ["READERS", "Drawing", "ReadOptions", "read_shape"]


class Reader(NamedTuple):
    """A row of ``READERS``: a module of this package, imported when it is first used, and whether it reads text."""

    module: str
    is_text: bool = True


READERS = {
    ".svg": Reader("svg", is_text=False),
    ".json": Reader("json_loops"),
    ".wkt": Reader("wkt"),
    ".dxf": Reader("dxf"),
    ".geojson": Reader("geojson"),
    ".wkb": Reader("wkb", is_text=False),
    ".csv": Reader("csv_points"),
    ".pdf": Reader("pdf", is_text=False),
    ".png": Reader("image", is_text=False),
    ".jpg": Reader("image", is_text=False),
    ".jpeg": Reader("image", is_text=False),
}
"""By suffix. In text, numbers are counted before anything is parsed; an SVG, in any encoding, counts its own."""


def read_shape(path: str | Path, options: ReadOptions | None = None, data: bytes | None = None) -> Drawing:
    """Return the drawing in the file ``path``; raises ``FileFormatError`` with the path and the remedy.

    ``data``: the bytes of the file, if they have been read already; then nothing is opened.
    """
    options = options or ReadOptions()
    path = Path(path)
    try:
        suffix = _suffix(path, options)
        source = _source(path, options, data)
        reader = READERS[suffix]
        if reader.is_text:
            options.limits.check_numbers(source.data)
        drawing: Drawing = import_module(f"foldcut.readers.{reader.module}").read(source, options)
        options.limits.check_loops((*drawing.loops, *drawing.lines))
        drawing = replace(drawing, title=as_title(drawing.title))
    except FileFormatError as error:
        raise FileFormatError(f"{path}: {' '.join(str(error).split())}") from None
    except OSError as error:
        raise FileFormatError(f"{path}: {error.strerror}; check the path and its permissions") from None
    except BadInputError:
        raise
    except (ArithmeticError, ShapelyError) as error:  # from GEOS or a division, with numbers at the limits of float64
        about = " ".join(str(error).split())[:100]
        raise FileFormatError(
            f"{path}: its numbers are too large to compute with ({about}); keep them below 1e100"
        ) from None
    except MemoryError:
        raise FileFormatError(
            f"{path}: the drawing takes more memory than there is; give a simpler one, or allow "
            "more with --limit megabytes=NUMBER"
        ) from None
    return replace(drawing, sha256=hashlib.sha256(source.data).hexdigest())


def _suffix(path: Path, options: ReadOptions) -> str:
    """Return the suffix that tells the format."""
    known = ", ".join(READERS)
    if options.suffix:
        suffix = "." + options.suffix.lower().removeprefix(".")
        if suffix not in READERS:
            raise FileFormatError(f"there is no format {options.suffix!r}; give --from one of {known}")
        return suffix
    if is_standard_input(path):
        raise FileFormatError(f"standard input has no suffix; give the format with --from, one of {known}")
    if path.is_dir():
        raise FileFormatError("is a folder; give a file in it")
    if path.suffix.lower() not in READERS:
        if not path.suffix and not path.exists():
            raise FileFormatError("there is no such file; check the path, or take a sample that foldcut samples lists")
        raise FileFormatError(f"drawings do not end in {path.suffix!r}; give a file that ends in {known}")
    return path.suffix.lower()


def _source(path: Path, options: ReadOptions, data: bytes | None) -> Source:
    """Return the bytes of a file, or of standard input, without reading more of them than the limit."""
    most = options.limits.bytes
    if data is not None:
        size, name = len(data), path.stem
    elif is_standard_input(path):
        data = read_bytes(path, most)
        size, name = len(data), "drawing"
    elif not path.exists():
        raise FileFormatError("there is no such file; check the path")
    else:
        data = read_bytes(path, most)
        size, name = path.stat().st_size, path.stem
    options.limits.check_size(size)
    if not data.strip():
        raise FileFormatError("the file is empty; give a file with at least one closed loop")
    return Source(data, name)
