"""Units of length: how many millimetres each is, and lengths as users write them.

1 in = 25.4 mm exactly (International Yard and Pound, 1959); px, pt and pc are those of CSS Values 3, section
6.2: 96, 72 and 6 to the inch.
"""

from __future__ import annotations

import math
import re
from typing import overload

from foldcut.core.errors import SheetError

__all__ = ["LENGTH", "LONGEST_MM", "MM_PER_INCH", "MM_PER_UNIT", "Length", "in_mm", "parse_length", "rounded_up"]

Length = float | str
"""A length in mm, or a text such as "10mm", "1cm" or "0.5in"."""

MM_PER_INCH = 25.4
"""Millimetres per inch."""

MM_PER_UNIT = {
    "mm": 1.0,
    "cm": 10.0,
    "in": MM_PER_INCH,
    "px": MM_PER_INCH / 96,
    "pt": MM_PER_INCH / 72,
    "pc": MM_PER_INCH / 6,
}
"""Millimetres per unit, for every unit that a file or a user may name."""

LONGEST_MM = 1e6
"""Nobody means a longer length: a kilometre. A sheet is far smaller."""

LENGTH = r"([+-]?(?:[0-9]++\.?+[0-9]*+|\.[0-9]++)(?:e[+-]?[0-9]++)?+)\s*+(mm|cm|in)?"
"""A regular expression for a length in lower case: its groups are the number and the unit, if there is one."""


def parse_length(text: str) -> float:
    """Return the length that ``text`` names, in mm: a number with mm, cm or in; a number without a unit is in mm.

    Zero is allowed. Raises ``SheetError``.
    """
    match = re.fullmatch(LENGTH, text.strip().lower())
    length = float(match[1]) * MM_PER_UNIT[match[2] or "mm"] if match else math.nan
    if length > LONGEST_MM:
        raise SheetError(f"{text!r} is longer than a kilometre; give a shorter length")
    if not length >= 0:
        raise SheetError(
            f"{text!r} is not a length; give a number from 0 up with mm, cm or in, such as 10mm, 1cm, 0.5in or 12"
        )
    return length


@overload
def in_mm(length: Length) -> float: ...
@overload
def in_mm(length: Length | None) -> float | None: ...
def in_mm(length: Length | None) -> float | None:
    """Return a length in mm; raises ``SheetError`` for a text that is none."""
    return parse_length(length) if isinstance(length, str) else length


def rounded_up(length: float) -> str:
    """Return a length rounded up to three digits, so that "at most" is true."""
    if length <= 0:
        return "0"
    digits = 2 - math.floor(math.log10(length))
    return f"{math.ceil(round(length * 10.0**digits, 6)) / 10.0**digits:.3g}"
