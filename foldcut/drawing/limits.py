"""How large a drawing may be. A larger one is refused before it costs much time or memory.

Bytes of a file, or loops -> nothing, or ``FileFormatError``. Points are counted twice: roughly, as numbers in the
bytes, before anything is parsed (a fraction of a second for the largest file), and exactly, once there are loops.
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


LARGEST = 1e15
"""Limits are smaller than this."""

DEEPEST = 500
"""The deepest ``nesting`` that may be set: Python stops recursion at 1000 by default, and deeper still GEOS crashes."""


@dataclass(frozen=True)
class Limits:
    """The largest drawing: ``bytes`` of its file, ``points``, ``loops`` and ``pixels`` in it, and its ``nesting``.

    The defaults are far beyond what anybody folds, and reading or refusing a file takes less than 10 s and 1 GB:
    ``seconds`` of the processor and ``megabytes`` of memory bound the process that reads it (``readers.apart``).
    ``nesting`` is how deep groups, clones, blocks, collections or brackets may lie within each other. It is never more
    than ``DEEPEST``, since some libraries read them by recursion.
    """

    bytes: int = 20 * 2**20
    points: int = 100_000
    loops: int = 1_000
    pixels: int = 40_000_000
    nesting: int = 100
    seconds: int = 10
    megabytes: int = 1024

    def __post_init__(self) -> None:
        if self.nesting > DEEPEST:
            raise BadInputError(f"a nesting of {self.nesting:,} is too deep; give at most {DEEPEST}")

    def check_size(self, size: int) -> None:
        """Raise ``FileFormatError`` if a file of ``size`` bytes is too large."""
        if size > self.bytes:
            raise FileFormatError(self._message(f"the file has {size:,} bytes", "bytes", "give a smaller one"))

    def check_nesting(self, depth: int) -> None:
        """Raise ``FileFormatError`` if a nesting of this ``depth`` is too deep."""
        if depth > self.nesting:
            raise self.too_deep()

    def too_deep(self) -> FileFormatError:
        """Return the error for a nesting that is too deep."""
        return FileFormatError(self._message("things are nested too deep", "nesting", "give a flat drawing"))

    def check_pixels(self, pixels: int) -> None:
        """Raise ``FileFormatError`` if a picture has too many ``pixels``."""
        if pixels > self.pixels:
            raise FileFormatError(self._message(f"the picture has {pixels:,} pixels", "pixels", "give a smaller one"))

    def check_numbers(self, data: builtins.bytes) -> None:
        """Raise ``FileFormatError`` if a text has too many numbers, two for each point; base64 images do not count."""
        if len(data) < 4 * self.points:  # a point takes four bytes at least: "1,2 "
            return
        text = np.frombuffer(re.sub(rb"base64,[^\"')]*", b"", data), dtype=np.uint8)
        digits = ((text >= ord("0")) & (text <= ord("9"))) | (text == ord("."))
        runs = np.count_nonzero(digits[1:] & ~digits[:-1]) + bool(digits[:1].any())
        points = int(max(runs, np.count_nonzero(text == ord(".")))) // 2  # ".5.5" is two numbers, and one run
        if points > self.points:
            raise FileFormatError(self._message(f"the file has about {points:,} points", "points", "simplify it"))

    def check_loops(self, loops: Sequence[ArrayLike]) -> None:
        """Raise ``FileFormatError`` if there are too many loops, or too many points in them."""
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
    """Return the default limits, changed by texts such as ``points=5000``; raises ``BadInputError`` for other texts."""
    limits, names = Limits(), [field.name for field in fields(Limits)]
    for text in texts:
        name, _, number = text.partition("=")
        said = " ".join(text.split())
        if name not in names:
            raise BadInputError(
                f"--limit {said:.60} is not a limit; give NAME=NUMBER, where NAME is {', '.join(names[:-1])} or "
                f"{names[-1]}"
            )
        value = float(number) if re.fullmatch(r"[0-9]{1,15}([.][0-9]{1,9})?(e[0-9]{1,2})?", number) else 0.0
        if not 1 <= value < LARGEST or value != int(value):
            raise BadInputError(f"--limit {said:.60}: give a whole number from 1 up, such as {name}=5000 or {name}=1e6")
        limits = replace(limits, **{name: int(value)})
    return limits
