"""What every reader gives, and how every reader of text gets its text."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from foldcut.errors import FileFormatError
from foldcut.model import Floats


@dataclass(frozen=True, eq=False)
class Drawing:
    """The closed loops of a file, as drawn: nothing is checked but that they are lists of points.

    ``loops`` are ``(n, 2)``, y up, in drawing units of ``unit_mm`` mm each (None: the file does not say).
    ``notes`` say what in the file was ignored. ``y_down``: the file's own y axis points down, and y here is minus its.
    """

    loops: tuple[Floats, ...]
    unit_mm: float | None
    title: str
    notes: tuple[str, ...] = ()
    y_down: bool = False

    def own_coordinates(self) -> tuple[Floats, ...]:
        """The loops in the file's own coordinates."""
        return tuple(loop * (1.0, -1.0) for loop in self.loops) if self.y_down else self.loops


def read_text(path: Path) -> str:
    """Return the text of a UTF-8 file; raises ``FileFormatError`` where it is none or has nothing in it."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise FileFormatError(f"byte {error.start} is not UTF-8; save the file as UTF-8 text") from None
    if not text.strip():
        raise FileFormatError("the file is empty; give a file with at least one closed loop")
    return text
