"""Fold a half of the sheet along the straight skeleton of its loop: soon, and often with the fewest folds.

``Half`` candidates -> the best ``AlongSkeleton``, a verified pattern of the whole sheet.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from foldcut.core.errors import ShapeError, UnfoldableError
from foldcut.core.model import CreasePattern, FoldedState, Shape
from foldcut.drawing.shape import make_shape
from foldcut.methods.mirror.halves import whole_loops
from foldcut.methods.mirror.unfold import Half
from foldcut.methods.skeleton.quick import fold_outline
from foldcut.methods.skeleton.search import adjusted

__all__ = ["AlongSkeleton", "along_skeletons", "with_corners_moved"]


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
            made = fold_outline(Shape((half.loop,), (-1,)), half.sheet, ribbon=ribbon, part=half)
            creases, folded = half.unfold(made.creases, made.folded)
            yield half, AlongSkeleton(creases, folded, made.creases, made.perpendiculars, number)


def with_corners_moved(half: Half, near: float) -> Iterator[tuple[Half, float]]:
    """Yield variants of a half with corners moved by up to ``near`` mm so that creases meet, and how far they moved.

    The whole shape is moved with it, so it stays symmetric.
    """
    at = np.where(np.isin([0, 1], half.axes), [half.sheet.width, half.sheet.height], 0.0)
    for moved, way in adjusted(Shape((half.loop,), (-1,)), half.sheet, near)[:-1]:
        loop = moved.loops[0]
        with suppress(ShapeError):
            whole = make_shape([one + at for one in whole_loops(loop, half.axes)])
            yield replace(half, shape=whole, loop=loop), way
