"""Numbers and titles as all text formats write them."""

from __future__ import annotations

DIGITS = 4
"""Digits of a length in mm after the point: far finer than any machine."""


def number(value: float, digits: int = DIGITS) -> str:
    """Return a length in mm in its shortest form, without an exponent or a negative zero."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def printable(text: str) -> str:
    """Return the text without characters that XML forbids or that are invisible."""
    return "".join(filter(str.isprintable, text))
