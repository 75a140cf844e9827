"""Fold a half or a quarter of the sheet along the straight skeleton of its loops.

``Half`` -> ``Skeletal``: a verified pattern of the whole sheet -> ``Made``.

Ridges and perpendiculars that come to an axis end there: the sheet is folded along the axes first, and everything else
through both layers, or all four.
"""

from __future__ import annotations

import numpy as np

from foldcut.core.model import CreasePattern, Sheet
from foldcut.drawing.laying import Laid
from foldcut.methods.base import Made
from foldcut.methods.mirror.unfold import Half, axis_lines
from foldcut.methods.skeleton.quick import TRIES, fold_outline
from foldcut.methods.skeleton.trial import Skeletal
from foldcut.pattern.foldability import crease_numbers

__all__ = ["fold_half", "made_of_half"]

def fold_half(half: Half, *, ribbon: float = 0.0, tries: int = TRIES) -> Skeletal:
    """Return the pattern of the first promising set of perpendiculars, of at most ``tries``, that can be folded.

    The loops are folded exactly as they are. ``ribbon`` is a half-width in mm: creases that meet this near to the cut
    are refused. Raises ``UnfoldableError`` with the first reason where none of the sets can be folded.
    """
    return fold_outline(half.outline, half.sheet, ribbon=ribbon, tries=tries, part=half)


def made_of_half(axes: tuple[int, ...], found: Skeletal, laid: Laid, *, ribbon: float = 0.0) -> Made:
    """Return what the method made of a shape: ``found`` is the pattern of its whole sheet, ``laid`` how it lies there.

    ``axes`` are the sheet's middle lines that are folded first, as for ``Half``; ``ribbon`` is in mm.
    """
    count = found.perpendiculars
    return Made(
        "mirror",
        found.creases,
        found.folded,
        laid,
        ribbon,
        actions=len(axes) + lines_beside(found.creases, laid.sheet, axes),
        told=(f"mirror: half of the sheet along the straight skeleton, {count} perpendicular{'s' * (count != 1)}",),
        numbers={"perpendiculars": count, "moved_mm": found.moved_mm},
        first_folds=axis_lines(laid.sheet, axes),
        interrupted=found.interrupted,
        detail=found,
    )


def lines_beside(creases: CreasePattern, sheet: Sheet, axes: tuple[int, ...]) -> int:
    """Return how many straight folds a pattern has to the right of the upright axis, above the level one, or both."""
    away = creases.vertices_coords[creases.edges_vertices].mean(axis=1) - np.array([sheet.width, sheet.height]) / 2
    kept = (away[:, list(axes)] > 1e-9 * sheet.diagonal).all(axis=1)
    edges, kinds = creases.edges_vertices[kept], creases.edges_assignment[kept]
    return crease_numbers(CreasePattern(creases.vertices_coords, edges, kinds, creases.faces_vertices)).lines
