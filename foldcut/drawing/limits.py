"""How large a drawing may be: what is larger is refused before it costs much time or memory.

Bytes of a file, or loops -> nothing, or ``FileFormatError``. Points are counted twice: as numbers in the bytes, before
anything is parsed, which takes a fraction of a second for the largest file, and exactly, once they are loops.
"""

from __future__ import annotations

import builtins
import re
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import ArrayLike

from foldcut.core.errors import BadInputError, FileFormatError

__all__ = ["Limits", "parse_limits"]


DEEPEST = 500
"""Python's recursion ends at 1000 by default; GEOS's, at many times that, in a crash."""


@dataclass(frozen=True)
class Limits:
    """The largest drawing: ``bytes`` of its file, ``points``, ``loops`` and ``pixels`` in it, and its ``nesting``.

    The defaults are far beyond what anybody folds, and take less than 10 s and 1 GB to read or to refuse. ``nesting``
    is how deep groups, clones, blocks, collections or brackets are in each other. It is never more than ``DEEPEST``:
    libraries that read by recursion go that deep.
    """

    bytes: int = 20 * 2**20
    points: int = 100_000
    loops: int = 1_000
    pixels: int = 40_000_000
    nesting: int = 100

    def __post_init__(self) -> None:
        if self.nesting > DEEPEST:
            raise BadInputError(f"a nesting of {self.nesting:,} is too deep; give at most {DEEPEST}")

    def check_size(self, size: int) -> None:
        """Raise for a file of so many bytes."""
        if size > self.bytes:
            raise FileFormatError(self._message(f"the file has {size:,} bytes", "bytes", "give a smaller one"))

    def check_nesting(self, depth: int) -> None:
        """Raise for things that are so deep in each other."""
        if depth > self.nesting:
            raise self.too_deep()

    def too_deep(self) -> FileFormatError:
        """Return the error for things that are too deep in each other."""
        return FileFormatError(self._message("things are nested too deep", "nesting", "give a flat drawing"))

    def check_pixels(self, pixels: int) -> None:
        """Raise for a picture of so many pixels."""
        if pixels > self.pixels:
            raise FileFormatError(self._message(f"the picture has {pixels:,} pixels", "pixels", "give a smaller one"))

    def check_numbers(self, data: builtins.bytes) -> None:
        """Raise for a text that has too many numbers to be that few points; images embedded as base64 do not count."""
        if len(data) < 4 * self.points:  # a point takes "1,2 "
            return
        text = np.frombuffer(re.sub(rb"base64,[^\"')]*", b"", data), dtype=np.uint8)
        digits = ((text >= ord("0")) & (text <= ord("9"))) | (text == ord("."))
        runs = np.count_nonzero(digits[1:] & ~digits[:-1]) + bool(digits[:1].any())
        points = int(max(runs, np.count_nonzero(text == ord(".")))) // 2  # ".5.5" is two numbers, and one run
        if points > self.points:
            raise FileFormatError(self._message(f"the file has about {points:,} points", "points", "simplify it"))

    def check_loops(self, loops: Sequence[ArrayLike]) -> None:
        """Raise for too many loops, or too many points in them."""
        points = sum(len(np.asarray(loop)) for loop in loops)
        for what, count, remedy in (
            ("points", points, "simplify the drawing"),
            ("loops", len(loops), "draw fewer outlines"),
        ):
            if count > getattr(self, what):
                raise FileFormatError(self._message(f"the drawing has {count:,} {what}", what, remedy))

    def _message(self, fault: str, what: str, remedy: str) -> str:
        most = getattr(self, what)
        return f"{fault}, and at most {most:,} are allowed; {remedy}, or allow more with --limit {what}=NUMBER"


def parse_limits(texts: Sequence[str]) -> Limits:
    """Return the limits that ``NAME=NUMBER`` change; raises ``BadInputError`` for what is none."""
    limits, names = Limits(), [field.name for field in fields(Limits)]
    for text in texts:
        name, _, number = text.partition("=")
        if name not in names or not re.fullmatch("[0-9]{1,15}", number) or int(number) == 0:
            raise BadInputError(
                f"--limit {text} is no limit; give NAME=NUMBER, where NAME is {', '.join(names[:-1])} or {names[-1]}"
            )
        limits = replace(limits, **{name: int(number)})
    return limits
