"""Read a drawing from a file: one module per format, found by the file's suffix.

Input: a path. Output: a ``Drawing``: loops in drawing units, y up. A reader takes a path and returns a
``Drawing`` or raises ``FileFormatError`` about the file's content; whether the loops are a valid shape is for
``make_shape`` to say. To add a format, add its module and a line in ``READERS``.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from foldcut.errors import FileFormatError
from foldcut.limits import Limits
from foldcut.readers.base import Drawing
from foldcut.readers.json_loops import read_json
from foldcut.readers.svg import read_svg
from foldcut.readers.wkt import read_wkt

__all__ = ["READERS", "Drawing", "read_shape"]

READERS: dict[str, Callable[[Path], Drawing]] = {
    ".svg": read_svg,
    ".json": read_json,
    ".wkt": read_wkt,
}


def read_shape(path: str | Path, limits: Limits | None = None) -> Drawing:
    """Return the drawing in the file ``path``; raises ``FileFormatError`` with the path and the remedy."""
    path, limits = Path(path), limits or Limits()
    try:
        if path.is_dir():
            raise FileFormatError("is a folder; give a file in it")
        if path.suffix.lower() not in READERS:
            known = ", ".join(READERS)
            raise FileFormatError(f"drawings do not end in {path.suffix!r}; give a file that ends in {known}")
        if not path.exists():
            raise FileFormatError("there is no such file; check the path")
        limits.check_size(path.stat().st_size)
        limits.check_numbers(path.read_bytes())
        drawing = READERS[path.suffix.lower()](path)
        limits.check_loops(drawing.loops)
        return drawing
    except FileFormatError as error:
        raise FileFormatError(f"{path}: {error}") from None
    except OSError as error:
        raise FileFormatError(f"{path}: {error.strerror}; check the path and its permissions") from None
