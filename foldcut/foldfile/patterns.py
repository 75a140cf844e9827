"""Read a crease pattern of any format: FOLD, .cp of ORIPA and Orihime, .opx of ORIPA, or the lines of an SVG.

File -> ``FoldFile``. Formats of bare lines have no faces and no layers: ``lines`` makes a pattern of them. One unit is
taken as 1 mm where the file does not say. ORIPA's types: 0 and 4 are auxiliary lines, 1 the border, 2 mountains, 3
valleys. In SVG red lines are mountains, blue ones valleys, grey and yellow ones flat, and all others unassigned.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from foldcut.core.arrays import Chars, Floats
from foldcut.core.errors import FileFormatError
from foldcut.core.files import read_bytes
from foldcut.drawing.limits import Limits
from foldcut.foldfile.lines import pattern_of_lines
from foldcut.foldfile.read import LARGEST_FILE, FoldFile, read_apart, read_fold
from foldcut.readers.base import ReadOptions, decoded
from foldcut.readers.svg import lines_of_svg
from foldcut.readers.svg_style import colour_of
from foldcut.readers.svg_text import root_of, text_of

__all__ = ["FORMATS", "read_pattern", "read_pattern_apart"]

TYPES = {0: "F", 1: "B", 2: "M", 3: "V", 4: "F"}
"""The letters of ORIPA's types of lines."""

STRONG = 0.6
"""How much stronger red or blue has to be than the other two colours, of 1, for a mountain or a valley."""

GREY = 0.15
"""Red, green and blue of a grey differ by less than this; grey that is darker is black."""


class _Lines(NamedTuple):
    """Lines, ``(n, 2, 2)``, y up, with their letters, ``(n,)``, and the length of their unit; None if nobody says."""

    ends: Floats
    letters: Chars
    unit_mm: float | None


def read_pattern(path: Path) -> FoldFile:
    """Read the crease pattern of a file.

    Raises ``FileFormatError`` for a file that cannot be opened, and for one that has no crease pattern.
    """
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        return read_fold(path)
    try:
        data = read_bytes(path, LARGEST_FILE)
        if len(data) > LARGEST_FILE:
            raise FileFormatError(f"the file is larger than {LARGEST_FILE >> 20} MiB; give a smaller one")
        lines = reader(data)
        if not np.isfinite(lines.ends).all():
            raise FileFormatError("a line ends at a place that is not finite; give numbers below 1e15")
        unit_mm = lines.unit_mm or 1.0
        pattern, notes = pattern_of_lines(lines.ends * unit_mm, lines.letters)
    except FileFormatError as error:
        raise FileFormatError(f"{path}: {error}") from None
    except OSError as error:
        raise FileFormatError(f"{path}: {error.strerror}; check the path and its permissions") from None
    if lines.unit_mm is None:
        notes = ("no unit of length is given; one unit is taken as 1 mm", *notes)
    return FoldFile(pattern, None, None, unit_mm, notes, path.stem)


def read_pattern_apart(path: Path) -> FoldFile:
    """Do as ``read_pattern``, in a process of its own with as much time and memory as a file of this size may take."""
    return read_apart(read_pattern, path)


def _of_numbers(types: list[int], ends: list[list[float]]) -> _Lines:
    """Return lines of ORIPA, whose y axis points down."""
    if not ends:
        raise FileFormatError("the file has no lines; give the border and the creases of a pattern")
    return _Lines(np.array(ends).reshape(-1, 2, 2) * (1.0, -1.0), np.array([TYPES[one] for one in types]), None)


def _cp(data: bytes) -> _Lines:
    """Read lines of text: type, x, y, x, y."""
    types, lines = list[int](), list[list[float]]()
    for number, line in enumerate(decoded(data).splitlines(), 1):
        words = line.replace(",", " ").split()
        if not words:
            continue
        try:
            kind, ends = int(words[0]), [float(word) for word in words[1:]]
            if len(ends) != 4 or kind not in TYPES:
                raise ValueError
        except ValueError:
            raise FileFormatError(
                f"line {number}: {line.strip()[:40]!r} is not a type from 0 to 4 and x y x y"
            ) from None
        types.append(kind)
        lines.append(ends)
    return _of_numbers(types, lines)


def _opx(data: bytes) -> _Lines:
    """Read ORIPA's XML: an object ``OriLineProxy`` with properties for each line; 0 where there is none."""
    root = root_of(text_of(data), Limits())
    types, ends = list[int](), list[list[float]]()
    for line in root.iter("object"):
        if line.get("class") != "oripa.OriLineProxy":
            continue
        values = {prop.get("property", ""): _value(prop) for prop in line.iter("void")}
        kind = values.get("type", 0.0)
        if kind not in TYPES:
            raise FileFormatError(f"line {len(ends) + 1}: {kind:g} is not a type from 0 to 4")
        types.append(int(kind))
        ends.append([values.get(name, 0.0) for name in ("x0", "y0", "x1", "y1")])
    return _of_numbers(types, ends)


def _value(prop: ET.Element) -> float:
    """Return the number of a property; 0 if it has none."""
    text = next((child.text for child in prop if child.tag in ("int", "double")), None)
    try:
        return float(text or 0)
    except ValueError:
        raise FileFormatError(f"{prop.get('property')}: {str(text)[:40]!r} is not a number") from None


def _svg(data: bytes) -> _Lines:
    """Read the lines of an SVG as browsers draw them, by the colours of their strokes."""
    root = root_of(text_of(data), Limits())
    found, unit_mm = lines_of_svg(root, ReadOptions())
    ends, letters = [np.empty((0, 2, 2))], list[str]()
    for points, style in found:
        parts = np.stack([points[:-1], points[1:]], axis=1)
        ends.append(parts)
        letters += [_letter(style.get("stroke", ""))] * len(parts)
    return _Lines(np.concatenate(ends), np.array(letters, dtype="<U1"), unit_mm)


def _letter(stroke: str) -> str:
    """Return the letter that the colour of a stroke stands for."""
    colour = colour_of(stroke)
    if colour is None:
        return "U"
    red, green, blue = (float(part) for part in colour[:3])
    if red - max(green, blue) > STRONG:
        return "M"
    if blue - max(red, green) > STRONG:
        return "V"
    is_grey = max(red, green, blue) - min(red, green, blue) < GREY and red > 2 * GREY
    return "F" if is_grey or min(red, green) - blue > STRONG else "U"


READERS: dict[str, Callable[[bytes], _Lines]] = {".cp": _cp, ".opx": _opx, ".svg": _svg}

FORMATS = (".fold", *READERS)
"""The endings of crease patterns that are read."""
