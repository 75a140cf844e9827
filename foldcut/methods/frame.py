"""Fold a shape at one and the same size and place, however large it is to be, and carry the pattern back.

``Problem`` -> ``Frame``s, in which the shape is as large as fits on A4 -> the pattern on the problem's sheet.

What ties, which creases are too short and which pattern is best would otherwise depend on the size in mm, and the least
difference decides what a search finds. So methods search in a frame: the shape has a size of its own there, made from
the drawing's own numbers and the same to the last bit for every size, and the sheet is one of a few (``SHEETS``), the
least that covers the problem's sheet. The pattern is then scaled, moved, and cut down to the problem's sheet: what
folds flat still does when some of the paper is missing. What has no pattern on one sheet is tried on the next larger
one, and then on the problem's own.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np

from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import CreaseTooShortError, UnfoldableError, UnfoldableWhereError
from foldcut.core.model import CreasePattern, FoldedState, Region, Shape, Sheet
from foldcut.drawing.laying import Laid
from foldcut.drawing.placement import Layout, parse_sheet
from foldcut.pattern.crop import crop
from foldcut.proof.verify import verify

__all__ = ["ADJUST", "Frame", "cut_down", "frame_scale", "in_frame"]

ADJUST = 0.5
"""How far corners are moved at most unless told otherwise, in mm of the frame: 1/500 of a drawing's longer side, or a
little more."""

SHEETS = (1.0, 1.6, 3.0, 16.0)
"""The sheets of a frame: A4 as it lies best for the shape, enlarged by these factors around its middle."""

MOST_LEFT = 0.9
"""A sheet is not cut down if more than this part of it would be left."""

MARGIN_LEFT = 0.9
"""The part of the margin around the shape that is asked for on a sheet that was cut down: a little less than there is,
so that the shape is as large as it was."""

COVERS = 1e-9
"""How far the problem's sheet may reach beyond the frame's, relative to the diagonal of the latter."""

Found = TypeVar("Found")


@dataclass(frozen=True, eq=False)
class Frame:
    """A shape at its own size in the middle of a sheet, and how it lies on the sheet that is asked for.

    ``shape`` and ``sheet`` are those of the frame; ``laid`` is what was asked for. ``scale``: mm for each mm of the
    frame. ``turn`` ``(2, 2)`` is the quarter turn from the frame to the sheet.
    """

    shape: Shape
    sheet: Sheet
    laid: Laid
    scale: float
    turn: Floats

    @cached_property
    def is_same(self) -> bool:
        """Whether the frame is what was asked for, to the last bit."""
        on, size = self.laid.sheet, (self.sheet.width, self.sheet.height)
        same = np.array_equal(self.shape.points, self.laid.shape.points)
        return same and (on.width, on.height) == size

    @property
    def covers(self) -> bool:
        """Whether the frame's sheet covers the one that was asked for; the shape lies in its middle."""
        most = _middle_of_sheet(self.sheet) + COVERS * self.sheet.diagonal
        return bool((np.abs(self.window) <= most).all())

    @property
    def window(self) -> Floats:
        """The corners, ``(2, 2)``, of the sheet that was asked for, as seen from the middle of the frame's shape."""
        corners = (self.laid.sheet.corners - _middle(self.laid.shape)) @ self.turn / self.scale
        return np.array([corners.min(axis=0), corners.max(axis=0)])

    def points(self, points: Floats) -> Floats:
        """Return points of the frame, ``(n, 2)``, on the sheet that was asked for."""
        if self.is_same:
            return points
        return points_array((points - _middle(self.shape)) @ self.turn.T * self.scale + _middle(self.laid.shape))

    def on_sheet(self, shape: Shape) -> Shape:
        """Return a shape of the frame on the sheet that was asked for."""
        if shape is self.shape:
            return self.laid.shape
        loops, lines = (tuple(map(self.points, parts)) for parts in (shape.loops, shape.lines))
        return replace(shape, loops=loops, lines=lines)

    def regions(self, regions: Sequence[Region]) -> tuple[Region, ...]:
        """Return regions of the frame on the sheet that was asked for, the first of them the whole sheet."""
        moved = [Region(tuple(self.points(outline) for outline in one.outlines), one.parent) for one in regions[1:]]
        return Region((self.laid.sheet.corners,), -1), *moved

    def reason(self, error: UnfoldableError) -> UnfoldableError:
        """Return an error of the frame with its place and lengths on the sheet that was asked for."""
        if isinstance(error, CreaseTooShortError):
            x, y = self.points(np.array([error.place]))[0].tolist()
            return CreaseTooShortError(str(error), error.length * self.scale, (x, y))
        if isinstance(error, UnfoldableWhereError):
            place = self.points(np.array([error.place]))[0].tolist()
            return UnfoldableWhereError(error.reason, place, [length * self.scale for length in error.lengths])
        return error

    def pattern(self, creases: CreasePattern, folded: FoldedState, shape: Shape) -> tuple[CreasePattern, FoldedState]:
        """Return a pattern of the frame, and how it folds, on the sheet that was asked for.

        ``shape`` is that of the frame which the pattern folds. Raises ``UnfoldableError`` where what is left of it on
        that sheet fails verification.
        """
        if self.is_same:
            return creases, folded
        moved = self.points(creases.vertices_coords)
        creases = CreasePattern(moved, creases.edges_vertices, creases.edges_assignment, creases.faces_vertices)
        folded = FoldedState(points_array(folded.vertices_coords * self.scale), folded.layers)
        on = self.laid.sheet
        creases, folded = crop(creases, folded, np.zeros(2), np.array([on.width, on.height]))
        findings = verify(creases, folded.layers, self.on_sheet(shape))
        if findings:
            raise UnfoldableError(f"the pattern fails verification ({findings[0]})")
        return creases, folded


def in_frame(laid: Laid, fold: Callable[[Frame], Found], *, retry: bool = True) -> Found:
    """Return what ``fold`` makes in the first frame in which it can.

    Raises the first ``UnfoldableError`` where it cannot in any, with places and lengths on the sheet that was asked
    for. Without ``retry`` only one frame is tried.
    """
    problem: UnfoldableError | None = None
    for frame in frames(laid):
        try:
            return fold(frame)
        except UnfoldableError as error:
            problem = problem or frame.reason(error)
            if not retry:
                break
    assert problem is not None
    raise problem


def frames(laid: Laid) -> Iterator[Frame]:
    """Yield the frames to search in: the first two whose sheet covers the one that is asked for, and that one itself.

    The last has no more paper than was asked for. It may fold what no other does, but not at one size as at another.
    """
    page, count = _page(laid), 0
    for factor in SHEETS:
        sheet = Sheet(factor * page.sheet.width, factor * page.sheet.height)
        shape = _moved(page.shape, (factor - 1) * _middle_of_sheet(page.sheet))
        frame = replace(page, sheet=sheet, shape=shape)
        if frame.covers and count < 2:
            yield frame
            count += 1
    low, high = page.window
    if not np.allclose(high - low, 2 * _middle_of_sheet(page.sheet), rtol=COVERS):
        shape = _moved(page.shape, -low - _middle(page.shape))
        yield replace(page, sheet=Sheet(*(high - low).tolist()), shape=shape)


def frame_scale(laid: Laid) -> float:
    """Return how large a shape lies on its sheet: mm for each mm of its frame."""
    return _page(laid).scale


def cut_down(laid: Laid) -> tuple[Sheet, float] | None:
    """Return the sheet that is left if a larger one is cut down to the frame's, and the margin around the shape, in mm.

    None where there is little to cut off.
    """
    page = _page(laid)
    width, height = (np.abs(page.turn) @ [page.sheet.width, page.sheet.height]) * page.scale
    sheet = Sheet(min(_rounded_down(width), laid.sheet.width), min(_rounded_down(height), laid.sheet.height))
    if sheet.width * sheet.height > MOST_LEFT * laid.sheet.width * laid.sheet.height:
        return None
    size = np.ptp(laid.shape.points, axis=0)
    margin = float(min(sheet.width - size[0], sheet.height - size[1])) / 2
    return sheet, MARGIN_LEFT * margin


def _rounded_down(length: float) -> float:
    """Return a length in whole tenths of a millimetre."""
    return math.floor(10 * length) / 10


def _page(laid: Laid) -> Frame:
    """Return the frame whose sheet is A4."""
    drawn, turn = laid.drawn, np.eye(2)
    linear, scale = laid.similarity.matrix[:, :2], laid.similarity.scale
    if np.count_nonzero(linear) == 2:  # a quarter turn, if it is turned at all
        turn = np.round(linear / scale)
    else:
        drawn, scale = laid.shape, 1.0
    sheet, shape, placement, _ = Layout(parse_sheet("a4"), rotation=0.0).place(drawn)
    return Frame(shape, sheet, laid, scale / placement.scale, turn)


def _moved(shape: Shape, step: Floats) -> Shape:
    return shape.with_points(shape.points + step) if step.any() else shape


def _middle_of_sheet(sheet: Sheet) -> Floats:
    return np.array([sheet.width, sheet.height]) / 2


def _middle(shape: Shape) -> Floats:
    """Return the middle of the rectangle around a shape."""
    points = shape.points
    middle: Floats = (points.min(axis=0) + points.max(axis=0)) / 2
    return middle
