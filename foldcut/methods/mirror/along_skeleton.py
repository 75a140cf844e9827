"""Fold a half of the sheet along the straight skeleton of its loop: soon, and often with the fewest folds.

``Half`` candidates -> the best ``AlongSkeleton``, a verified pattern of the whole sheet.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import CreasePattern, FoldedState, Shape
from foldcut.methods.mirror.unfold import Half
from foldcut.methods.skeleton.quick import fold_outline

__all__ = ["AlongSkeleton", "along_skeletons"]


@dataclass(frozen=True, eq=False)
class AlongSkeleton:
    """A pattern of the whole sheet, ``creases`` and ``folded``, and of its half, ``part``.

    ``perpendiculars``: how many of them are folded in the half; ``tried``: how many halves have been tried.
    """

    creases: CreasePattern
    folded: FoldedState
    part: CreasePattern
    perpendiculars: int
    tried: int
    interrupted: bool = False


def along_skeletons(halves: Sequence[Half], ribbon: float = 0.0) -> Iterator[tuple[Half, AlongSkeleton]]:
    """Yield what can be folded of halves; ``ribbon`` is a half-width in mm, see ``fold_outline``."""
    for number, half in enumerate(halves, start=1):
        with suppress(UnfoldableError):
            shape = Shape((half.loop,), (-1,))
            made = fold_outline(shape, half.sheet, ribbon=ribbon, part=half)
            creases, folded = half.unfold(made.creases, made.folded)
            yield half, AlongSkeleton(creases, folded, made.creases, made.perpendiculars, number)
