"""Fold a half, a quarter or a wedge of the sheet along the straight skeleton of its loops.

``Half`` or ``Wedge`` -> ``Skeletal``: a verified pattern of the whole sheet -> ``Made``.

Ridges and perpendiculars that come to an axis end there: the sheet is folded along the axes first, and everything else
through all layers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.model import CreasePattern, Shape, Sheet
from foldcut.drawing.laying import Laid
from foldcut.geometry.dihedral import Dihedral, made_dihedral
from foldcut.geometry.mirror_axes import symmetric
from foldcut.methods import METHODS
from foldcut.methods.base import Made
from foldcut.methods.mirror.halves import halves_of
from foldcut.methods.mirror.unfold import Half, axis_lines
from foldcut.methods.mirror.wedge import Part, Wedge, wedge_lines
from foldcut.methods.skeleton.budget import Budget
from foldcut.methods.skeleton.quick import TRIES, fold_outline
from foldcut.methods.skeleton.search import MOST_CORNERS, Search, adjusted
from foldcut.methods.skeleton.trial import Skeletal
from foldcut.pattern.first_folds import first_fold_count
from foldcut.pattern.foldability import crease_numbers

__all__ = ["fold_part", "made_of_half", "made_of_wedge", "search_half", "search_wedge"]

PATIENCE = 0.5
"""While there is no pattern, shapes with moved corners are tried for this part of the time, each."""

MOST_MOVED = 40
"""Corners of a shape with several axes are moved only if it has no more than this: the time grows with the cube."""

SYMMETRIC = 1e-8
"""How far corners that were moved may be off from symmetry, relative to the sheet's diagonal."""


def fold_part(part: Part, *, ribbon: float = 0.0, tries: int = TRIES) -> Skeletal:
    """Return the pattern of the first promising set of perpendiculars, of at most ``tries``, that can be folded.

    The loops are folded exactly as they are. ``ribbon`` is a half-width in mm: creases that meet this near to the cut
    are refused. Raises ``UnfoldableError`` with the first reason where none of the sets can be folded.
    """
    return fold_outline(part.outline, part.sheet, ribbon=ribbon, tries=tries, part=part)


def search_half(
    shape: Shape,
    sheet: Sheet,
    axes: tuple[int, ...],
    *,
    near: float,
    ribbon: float = 0.0,
    seconds: float,
    progress: Callable[[str, float], None] | None = None,
) -> Skeletal:
    """Return the pattern of the sheet that is easiest to fold, of all that a search for some seconds finds.

    ``shape`` is symmetric about the sheet's ``axes``, as for ``Half``. Its corners may be moved by ``near`` mm, as by
    ``fold_skeletal``, if they are not too many; the shape as it is is tried first. ``seconds`` are those of the
    budget's model. Raises ``UnfoldableError`` with the first reason where no pattern is found. Ctrl-C ends the search
    with the best so far.
    """

    def moved() -> Iterator[tuple[Half, float]]:
        if shape.corner_count > MOST_CORNERS:
            return  # to move the corners of so many would take minutes
        for variant, most in adjusted(shape, sheet, near)[:-1]:
            variant, off = symmetric(variant, np.array([sheet.width, sheet.height]) / 2, axes)
            if off <= SYMMETRIC * sheet.diagonal:
                yield next(halves_of(variant, sheet, axes)), most

    return _searched(next(halves_of(shape, sheet, axes)), moved(), ribbon, seconds, progress)


def search_wedge(
    wedge: Wedge,
    *,
    near: float,
    ribbon: float = 0.0,
    seconds: float,
    progress: Callable[[str, float], None] | None = None,
) -> Skeletal:
    """Do as ``search_half`` with a wedge."""

    def moved() -> Iterator[tuple[Wedge, float]]:
        if wedge.outline.corner_count > MOST_MOVED:
            return
        for variant, most in adjusted(wedge.outline, wedge.sheet, near)[:-1]:
            exact = made_dihedral(variant, Dihedral(wedge.count, 0.0, 0.0))
            if exact is not None and exact[2] <= SYMMETRIC * wedge.whole.diagonal:
                yield wedge.with_outline(exact[0]), most

    return _searched(wedge, moved(), ribbon, seconds, progress)


def _searched(
    part: Part,
    moved: Iterator[tuple[Part, float]],
    ribbon: float,
    seconds: float,
    progress: Callable[[str, float], None] | None,
) -> Skeletal:
    """Search a part of the sheet as it is, and then with corners moved by so many mm."""
    search = Search(part.sheet, ribbon, Budget(seconds), progress)

    def fold_variants() -> None:
        search.fold(part.outline, 0.0, seconds, part)
        for other, most in moved:
            search.fold(other.outline, most, PATIENCE * seconds, other)

    return search.run(fold_variants)


def made_of_wedge(wedge: Wedge, found: Skeletal, laid: Laid, *, ribbon: float = 0.0) -> Made:
    """Return what the method made of a shape: ``found`` is the pattern of its whole sheet, ``laid`` how it lies there.

    ``wedge`` is on that sheet; ``ribbon`` is in mm.
    """
    made = _made(wedge.named, wedge.first_folds, wedge_lines(found.creases, wedge), found, laid, ribbon)
    return replace(made, numbers={**made.numbers, "axes": wedge.count})


def made_of_half(axes: tuple[int, ...], found: Skeletal, laid: Laid, *, ribbon: float = 0.0) -> Made:
    """Return what the method made of a shape: ``found`` is the pattern of its whole sheet, ``laid`` how it lies there.

    ``axes`` are the sheet's middle lines that are folded first, as for ``Half``; ``ribbon`` is in mm.
    """
    lines = lines_beside(found.creases, laid.sheet, axes)
    return _made(_named(axes), axis_lines(laid.sheet, axes), lines, found, laid, ribbon)


def _made(part: str, first_folds: tuple[Floats, ...], lines: int, found: Skeletal, laid: Laid, ribbon: float) -> Made:
    """Return what the method made by the straight skeleton of a part of the sheet, in words, with so many lines."""
    count = found.perpendiculars
    return Made(
        "mirror",
        found.creases,
        found.folded,
        laid,
        ribbon,
        actions=first_fold_count(first_folds) + lines,
        told=(f"mirror: the straight skeleton of {part}, {count} perpendicular{'s' * (count != 1)}",),
        numbers={"perpendiculars": count, "moved_mm": found.moved_mm},
        first_folds=first_folds,
        min_crease_mm=METHODS["skeleton"].min_crease_mm,
        interrupted=found.interrupted,
        detail=found,
    )


def _named(axes: tuple[int, ...]) -> str:
    return "a quarter of the sheet" if len(axes) == 2 else "half of the sheet"


def lines_beside(creases: CreasePattern, sheet: Sheet, axes: tuple[int, ...]) -> int:
    """Return how many straight folds a pattern has to the right of the upright axis, above the level one, or both."""
    away = creases.vertices_coords[creases.edges_vertices].mean(axis=1) - np.array([sheet.width, sheet.height]) / 2
    kept = (away[:, list(axes)] > 1e-9 * sheet.diagonal).all(axis=1)
    edges, kinds = creases.edges_vertices[kept], creases.edges_assignment[kept]
    return crease_numbers(CreasePattern(creases.vertices_coords, edges, kinds, creases.faces_vertices)).lines
