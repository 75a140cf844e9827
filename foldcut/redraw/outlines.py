"""The outlines that are tried for a tolerance, better and better ones.

The one place where the ladder asks for outlines: a search replaces what is here.
"""

from __future__ import annotations

from collections.abc import Iterator

from foldcut.core.errors import ShapeError
from foldcut.core.model import Shape
from foldcut.drawing.simplify import simplify

__all__ = ["WORK", "redrawn"]

WORK = {"fast": 30, "normal": 120, "best": 1200}
"""How many steps the search for an outline may take, by effort. A step is about the same work everywhere."""


def redrawn(target: Shape, tolerance: float, work: int) -> Iterator[Shape | None]:
    """Yield outlines within ``tolerance`` of ``target``, each better than those before, and None for a step without.

    ``target`` and ``tolerance`` are in mm of the frame; ``work`` is how many steps there may be at most. The order is
    the same on every machine. The caller may stop at any time.
    """
    for share in (1.0, 0.5)[: max(1, work)]:
        try:
            yield simplify(target, share * tolerance).shape
            return
        except ShapeError:
            yield None
