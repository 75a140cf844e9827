"""The parts of a FOLD file's JSON: rows, numbers and indices, each checked where it is read.

Errors name the place in the file, as in ``edges_vertices[3][1]``.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NoReturn

from foldcut.core.errors import FileFormatError

__all__ = ["LARGEST", "fail", "indices", "numbers", "rows_of", "shown"]

LARGEST = 1e15
"""Numbers in a file are smaller than this."""

MOST_LETTERS = 40
"""How much of a wrong value an error shows."""


def fail(place: str, problem: str) -> NoReturn:
    """Raise ``FileFormatError`` about a place in the file."""
    raise FileFormatError(f"{place}: {problem}")


def shown(value: object) -> str:
    """Return a value as an error shows it: cut short, and on one line."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):  # a number of thousands of digits, or a list in lists without end
        return f"a very long {type(value).__name__}"
    return text if len(text) <= MOST_LETTERS else f"{text[:MOST_LETTERS]}..."


def rows_of(name: str, rows: object) -> Iterator[tuple[str, list[Any]]]:
    """Yield the place in the file and the row, for each row of an entry that is a list of lists."""
    if not isinstance(rows, list):
        fail(name, "missing" if rows is None else "must be a list of lists")
    for at, row in enumerate(rows):
        if not isinstance(row, list):
            fail(f"{name}[{at}]", "must be a list")
        yield f"{name}[{at}]", row


def numbers(place: str, row: list[Any]) -> list[float]:
    """Return a list of numbers."""
    for at, number in enumerate(row):
        if type(number) not in (int, float) or not abs(number) < LARGEST:
            fail(f"{place}[{at}]", f"{shown(number)} is not a number below 1e15")
    return [float(number) for number in row]


def indices(place: str, row: object, count: int) -> list[int]:
    """Return a list of indices from 0 to ``count`` - 1."""
    if not isinstance(row, list):
        fail(place, "must be a list")
    for at, index in enumerate(row):
        if type(index) is not int or not 0 <= index < count:
            fail(f"{place}[{at}]", f"{shown(index)} is not a number from 0 to {count - 1}")
    return row
