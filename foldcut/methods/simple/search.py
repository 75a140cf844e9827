"""Look for a sequence of simple folds that brings all sides of a drawing onto one line.

Shape on its sheet -> sequences of lines, or ``UnfoldableError`` with the corner that stops them.

Each fold brings two lines with sides together, so no sequence is longer than there are lines. All folds are tried,
those that leave the fewest lines first, and what was reached before is not tried again. A fold at most halves the
number of lines, so a sequence that cannot become shorter than the best one is given up.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.methods.simple.drawing import FoldedDrawing, drawing_on
from foldcut.methods.simple.lines import Line, fold_lines

__all__ = ["MOST_FOLDS_TRIED", "sequences"]

MOST_FOLDS_TRIED = 1500
"""How many folds are tried in all, each about a millisecond."""

MORE = 200
"""How many folds are tried at most once there is a sequence."""

ENOUGH = 8
"""Of sequences that are as short as the number of lines allows, so many are looked at."""

MOST_SIDES = 200
"""Drawings with more sides than this are not tried."""

Folds = tuple[Line, ...]
"""Lines in the order in which they are folded; what is to the right of each is turned over."""


def sequences(
    shape: Shape, sheet: Sheet, symmetry: float = 0.0, tries: int = MOST_FOLDS_TRIED
) -> list[tuple[Folds, Line]]:
    """Return the shortest sequences that were found, each with the line of the cut; the inside is to its left.

    ``symmetry``: how far, in mm, what lies on each other may be apart. Raises ``UnfoldableError`` where there is none,
    and where none was found within so many ``tries``.
    """
    if shape.corner_count > MOST_SIDES:
        raise UnfoldableError(f"the drawing has {shape.corner_count} sides; simple folds are tried for {MOST_SIDES}")
    drawing = drawing_on(shape, sheet, symmetry)
    search = _Search(tries, _fewest(drawing.line_count))
    search.run(drawing, ())
    if not search.found:
        raise UnfoldableError(_reason(shape, search))
    return search.found


class _Search:
    """A search in depth, with a memory of what was reached.

    ``found``: the shortest sequences; ``left``: how many folds may still be tried; ``least``: no sequence is shorter;
    ``nearest``: the drawing with the fewest lines that was reached, and after how many folds.
    """

    def __init__(self, tries: int, least: int) -> None:
        self.left, self.least = tries, least
        self.found: list[tuple[Folds, Line]] = []
        self.nearest: tuple[FoldedDrawing, int] | None = None
        self.reached: dict[tuple[tuple[int, ...], ...], int] = {}

    @property
    def most(self) -> int:
        """How long a sequence may be."""
        return min((len(folds) for folds, _ in self.found), default=10**9)

    def run(self, drawing: FoldedDrawing, folds: Folds) -> None:
        """Find the sequences that begin with some folds, after which the drawing lies as it does."""
        if self.nearest is None or drawing.line_count < self.nearest[0].line_count:
            self.nearest = drawing, len(folds)
        if drawing.is_cut:
            self._keep(folds, drawing.cut_line())
            return
        if self.reached.get(drawing.key, 10**9) <= len(folds):
            return
        self.reached[drawing.key] = len(folds)
        after = sorted(self._folded(drawing), key=lambda one: (one[0].line_count, one[0].length))
        for folded, line in after:
            if len(folds) + 1 + _fewest(folded.line_count) > self.most or self.left <= 0:
                continue
            self.run(folded, (*folds, line))

    def _keep(self, folds: Folds, cut: Line) -> None:
        """Keep a sequence that is as short as the shortest."""
        if not self.found:
            self.left = min(self.left, MORE)
        if len(folds) < self.most:
            self.found.clear()
        self.found.append((folds, cut))
        if len(self.found) >= ENOUGH and len(folds) <= self.least:
            self.left = 0

    def _folded(self, drawing: FoldedDrawing) -> Iterator[tuple[FoldedDrawing, Line]]:
        """Yield what one fold makes of the drawing, for every fold that is possible."""
        for line in fold_lines(drawing.sides, drawing.line, drawing.paper, drawing.tie):
            if self.left <= 0:
                return
            self.left -= 1
            line = _smaller_right(line, drawing)
            folded = drawing.fold(line)
            if folded is not None and folded.line_count < drawing.line_count:
                yield folded, line


def _fewest(lines: int) -> int:
    """Return how many folds bring so many lines together at least: a fold lays no more than two on each other."""
    return math.ceil(math.log2(lines))


def _smaller_right(line: Line, drawing: FoldedDrawing) -> Line:
    """Return a line in the direction in which the smaller part of the paper is to its right."""
    left, right = (drawing.paper.intersection(side).area for side in line.half_plane(4 * drawing.reach))
    return line.reverse if left < right * (1 - 1e-9) else line


def _reason(shape: Shape, search: _Search) -> str:
    """Say which corner stops the folds, or that not all were tried."""
    assert search.nearest is not None
    drawing, folds = search.nearest
    if search.left <= 0:
        return "no sequence of simple folds was found soon enough; there may be one; try --method auto"
    x, y = _stopping_corner(shape, drawing).tolist()
    before = f"after {folds} simple fold{'s' * (folds != 1)} " if folds else ""
    return (
        f"{before}no straight fold through all layers lays the drawing on itself and joins the sides at the corner at "
        f"({x:.4g}, {y:.4g}) mm; try --method auto, which also folds fewer than all layers"
    )


def _stopping_corner(shape: Shape, drawing: FoldedDrawing) -> Floats:
    """Return a corner of the shape whose two sides lie on different lines."""
    corners = np.concatenate(shape.loops)
    following = np.concatenate(
        [
            np.roll(np.arange(len(loop)), -1) + start
            for loop, start in zip(
                shape.loops, np.cumsum([0, *(len(loop) for loop in shape.loops)])[:-1].tolist(), strict=True
            )
        ]
    )
    line = dict(zip(drawing.origins.tolist(), drawing.line.tolist(), strict=True))
    for side, after in enumerate(following.tolist()):
        if side in line and after in line and line[side] != line[after]:
            return np.asarray(corners[after])
    return np.asarray(corners[min(line)])
