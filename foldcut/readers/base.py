"""What every reader takes and returns, ``Source`` and ``ReadOptions`` -> ``Drawing``, and what several share."""

from __future__ import annotations

import json
import re
from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.errors import BadInputError, FileFormatError, needed_extra
from foldcut.drawing.limits import Limits
from foldcut.geometry.curves import CurvedLoop

_JSON_STRING = re.compile(r'"(?:[^"\\]++|\\.)*+"?', re.DOTALL)

USUAL_SIZE_MM = 200.0
"""Curves are flattened as if the drawing were enlarged to this size, which is about that of "fit" on A4."""

USUAL_JOIN_MM = 0.05
"""Ends of lines that are nearer than this are joined, unless the user says how near they have to be."""

STROKES = ("lines", "outline")
"""How strokes are read: as lines without width, or as the area that they cover."""


@dataclass(frozen=True)
class ReadOptions:
    """How to read a file.

    ``flatten_mm``: how far a curve may be from the straight segments that replace it, both at the size that the file
    states and with the drawing enlarged to 200 mm. ``join_mm``: ends of lines that are nearer than this are joined,
    at the size that the file states, or in drawing units where it states none; None: than 0.05, measured like
    ``flatten_mm``. ``layers`` and ``ids``: read only these. ``suffix``: the format, whatever the file is
    called. ``threshold``: how light a pixel of the shape may be in a picture, from 0 for black to 1 for white.
    ``strokes``: "lines" reads strokes as lines without width, "outline" as the area that they cover. ``open_lines``:
    all lines are to be cut as they are drawn, open ones too; otherwise outlines are, and open lines are left out.
    """

    flatten_mm: float = 0.05
    join_mm: float | None = None
    layers: tuple[str, ...] = ()
    ids: tuple[str, ...] = ()
    suffix: str = ""
    threshold: float = 0.5
    strokes: str = "lines"
    open_lines: bool = False
    limits: Limits = field(default_factory=Limits)

    def __post_init__(self) -> None:
        if not 0 < self.flatten_mm < float("inf"):
            raise BadInputError(f"curves cannot be flattened to {self.flatten_mm:g} mm; give a length above 0")
        if not 0 <= self.threshold <= 1:
            raise BadInputError(f"the threshold is {self.threshold:g}; give a number from 0, black, to 1, white")
        if self.strokes not in STROKES:
            raise BadInputError(f"there is no way {self.strokes!r} to read strokes; give {' or '.join(STROKES)}")

    def units(self, length_mm: float, unit_mm: float | None, extent: float) -> float:
        """Return ``flatten_mm`` or ``USUAL_JOIN_MM`` in drawing units; ``extent``: the longer side of the drawing."""
        enlarged = length_mm * extent / USUAL_SIZE_MM
        return enlarged if unit_mm is None else min(length_mm / unit_mm, enlarged)

    def join_gap(self, unit_mm: float | None, extent: float) -> float:
        """Return how far ends of lines may be apart that are joined, in drawing units."""
        if self.join_mm is None:
            return self.units(USUAL_JOIN_MM, unit_mm, extent)
        return self.join_mm / (unit_mm or 1.0)


@dataclass(frozen=True)
class Source:
    """The bytes of a file and its name without the suffix."""

    data: bytes
    name: str

    def text(self) -> str:
        """Return the text; raises ``FileFormatError`` if it is not UTF-8 or if it is empty."""
        return decoded(self.data)


@dataclass(frozen=True, eq=False)
class Drawing:
    """The closed loops of a file, as drawn. They are lists of points, and nothing else about them has been checked.

    ``loops`` are ``(n, 2)``, y up, in drawing units of ``unit_mm`` mm each (None if the file does not say). ``ignored``
    names what was passed over in the file ("2 texts"), ``notes`` say how the rest was understood, and ``repairs`` what
    had to be mended, which ``--strict`` refuses. ``y_down``: the y axis of the file points down, so y has changed sign.
    ``curves``: what the loops were flattened from, in the same order; empty if all of them are straight lines, or if
    that is not known. ``lost``: outlines that the file has and that are not among the loops, since others cover them.
    ``sha256``: the hash of the file's bytes, "" if there is no file. ``lines``: if all lines are to be cut as they are
    drawn, these, ``(n, 2)``, and no loops; ``join``: how far ends of lines may be apart that are joined then, in
    drawing units, None for a small part of the drawing's size.
    """

    loops: tuple[Floats, ...]
    unit_mm: float | None
    title: str
    notes: tuple[str, ...] = ()
    y_down: bool = False
    ignored: tuple[str, ...] = ()
    repairs: tuple[str, ...] = ()
    curves: tuple[CurvedLoop, ...] = ()
    lost: tuple[Floats, ...] = ()
    sha256: str = ""
    lines: tuple[Floats, ...] = ()
    join: float | None = None

    @property
    def size(self) -> tuple[float, float]:
        """Width and height in drawing units."""
        if not self.loops and not self.lines:
            return 0.0, 0.0
        width, height = np.ptp(np.concatenate([*self.loops, *self.lines]), axis=0).tolist()
        return width, height

    @property
    def size_mm(self) -> tuple[float, float] | None:
        """Width and height in mm, or None if the file does not say."""
        width, height = self.size
        return None if self.unit_mm is None else (width * self.unit_mm, height * self.unit_mm)

    def own_coordinates(self, loops: tuple[Floats, ...] | None = None) -> tuple[Floats, ...]:
        """Return the loops, or others in the units of the drawing, in the coordinates of the file."""
        loops = self.loops if loops is None else loops
        return tuple(loop * (1.0, -1.0) for loop in loops) if self.y_down else loops


def counted(what: Counter[str]) -> tuple[str, ...]:
    """Return counts in words: ("1 image", "2 texts")."""
    return tuple(f"{count} {name}{'s' * (count != 1)}" for name, count in sorted(what.items()) if count)


def missing(option: str, extra: str) -> FileFormatError:
    """Return the error for a reader (``option`` is what it reads, a plural) whose library is not installed."""
    return FileFormatError(needed_extra(option, extra))


def json_of(source: Source, options: ReadOptions, example: str) -> Any:
    """Return the document in a JSON file, nested no deeper than allowed; errors give ``example`` as the remedy."""
    text = source.text()
    options.limits.check_nesting(brackets_depth(_JSON_STRING.sub("", text), "[{", "]}"))
    try:
        return json.loads(text)
    except ValueError as error:
        raise FileFormatError(f"not JSON: {why_not_json(error)}; {example}") from None


def why_not_json(error: Exception) -> str:
    """Return what is wrong with a text that ``json.loads`` refused."""
    if isinstance(error, json.JSONDecodeError):
        return str(error)
    if isinstance(error, RecursionError):
        return "brackets are nested too deep"
    digits = "Exceeds the limit" in str(error)  # of Python's own, with a remedy for programmers
    return "a number has thousands of digits" if digits else str(error)


def brackets_depth(text: str, opening: str, closing: str) -> int:
    """Return how deep brackets are nested in a text, even if they are not all closed."""
    codes = np.frombuffer(text.encode("utf-32-le"), dtype=np.uint32)
    steps = np.isin(codes, list(map(ord, opening))).astype(np.int64) - np.isin(codes, list(map(ord, closing)))
    return int(steps.cumsum().max(initial=0))


def decoded(data: bytes) -> str:
    """Return the text of a UTF-8 file; raises ``FileFormatError`` if it is not UTF-8 or if it is empty."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise FileFormatError(f"byte {error.start} is not UTF-8; save the file as UTF-8 text") from None
    if not text.strip():
        raise FileFormatError("the file is empty; give a file with at least one closed loop")
    return text
