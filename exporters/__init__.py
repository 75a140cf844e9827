"""Writers of finished patterns: one module per format, one table of them.

Stage: after verification. Input: a ``FoldedPattern`` and a ``Profile``; output: the bytes of a file. An
exporter opens no file, prints nothing and changes no geometry; the same input gives the same bytes.
"""

from __future__ import annotations

from collections.abc import Callable

from foldcut.errors import FileFormatError
from foldcut.model import FoldedPattern
from foldcut.profiles import Profile, load_profile

from . import fold, svg

Exporter = Callable[[FoldedPattern, Profile], bytes]

EXPORTERS: dict[str, Exporter] = {
    ".fold": fold.export,
    ".svg": svg.export,
}


def find_exporter(suffix: str) -> Exporter:
    """Return the exporter for a file name's ending, such as ``".svg"``; upper or lower case.

    Raises FileFormatError: no exporter writes such files.
    """
    try:
        return EXPORTERS[suffix.lower()]
    except KeyError:
        known = ", ".join(EXPORTERS)
        what = (
            f"foldcut cannot write {suffix} files" if suffix else "an output file needs an ending that names its format"
        )
        raise FileFormatError(f"{what}; use one of {known}") from None


def export(pattern: FoldedPattern, suffix: str, profile: Profile | None = None) -> bytes:
    """Return ``pattern`` as the bytes of a file with this ending; ``profile`` is "plain" unless given.

    Raises FileFormatError: no exporter writes such files.
    """
    return find_exporter(suffix)(pattern, profile or load_profile())
