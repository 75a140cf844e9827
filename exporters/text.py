"""Numbers and titles as every text format writes them."""

from __future__ import annotations

DIGITS = 4
"""Digits after the point, in mm: far below what any machine resolves."""


def number(value: float, digits: int = DIGITS) -> str:
    """Return a number of mm in the shortest form, without exponent or negative zero."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def printable(text: str) -> str:
    """Return the text without the characters that XML forbids or nobody sees."""
    return "".join(filter(str.isprintable, text))
