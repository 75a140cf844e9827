"""Text that comes from files and names of files: what may be shown on a terminal, or stand in another file.

Control characters, escape sequences among them, can change what a terminal shows. Lone surrogates cannot be encoded;
Python puts them where a name of a file is no UTF-8, and JSON may have them.
"""

from __future__ import annotations

import unicodedata

__all__ = ["LONGEST_TITLE", "as_title", "is_control", "shown"]

LONGEST_TITLE = 200
"""The most letters of a title; more is cut off."""

TURNING = frozenset("\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069\u061c")
"""Letters that nobody sees, and that change the direction of others (Unicode Standard Annex 9)."""

CONTROL = frozenset(("Cc", "Cs", "Zl", "Zp"))
"""Control characters, surrogates, separators of lines and paragraphs: general categories of Unicode."""


def is_control(letter: str) -> bool:
    """Whether a character is none that is read, but one that changes how others are shown, or cannot be encoded."""
    return letter in TURNING or unicodedata.category(letter) in CONTROL


def shown(text: str) -> str:
    """Return a text as it may be printed: control characters and surrogates become their escapes in Python."""
    if text.isprintable():
        return text
    return "".join(_escaped(letter) if is_control(letter) else letter for letter in text)


def as_title(text: str) -> str:
    """Return a text that a file gives as its title: on one line, without control characters, and not too long."""
    if not text.isprintable():
        text = "".join(" " if letter.isspace() else "" if is_control(letter) else letter for letter in text)
        text = " ".join(text.split())
    return text if len(text) <= LONGEST_TITLE else f"{text[:LONGEST_TITLE]}..."


def _escaped(letter: str) -> str:
    return letter.encode("unicode_escape").decode()
