"""Fold a row of figures, such as a paper chain, along parallel lines first, and the rest through all layers.

Shape on its sheet -> ``Made``, by the straight skeleton of the figure at the end of the row.

A row in which each figure is the mirror image of the next one is folded along the lines between the figures, and along
their own axes if they have any: each fold lays the row on itself. The fold that lays the most of the paper on the rest
comes first. In the end the whole row lies under its last piece, from the last fold to the border of the sheet. That
piece is one side of a symmetric figure, and folds as such. Then it is unfolded again, one fold after the other.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import shapely

from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import ShapeError, UnfoldableError
from foldcut.core.model import CreasePattern, FoldedState, Shape, Sheet
from foldcut.drawing.shape import make_shape
from foldcut.geometry.vectors import signed_area
from foldcut.methods.mirror.skeletal import search_half
from foldcut.methods.simple.drawing import drawing_on, filled
from foldcut.methods.simple.lines import Line, fold_lines
from foldcut.pattern.assemble import assemble, creases_of_stack
from foldcut.pattern.crop import crop
from foldcut.pattern.foldability import crease_numbers

__all__ = ["Chain", "FoldedChain", "chain_of", "fold_chain"]

FEWEST = 2
"""With fewer parallel folds than this a row is no chain: the method ``mirror`` folds a single axis."""


@dataclass(frozen=True, eq=False)
class Chain:
    """A row of figures: ``folds``, where it is folded, in mm along the coordinate ``axis``, one after another.

    ``shape`` is symmetric about all of them as far as paper lies on paper. Each fold turns over what is before it.
    ``turned``: all this is seen after the sheet has been turned round by 180 degrees.
    """

    shape: Shape
    sheet: Sheet
    axis: int
    folds: tuple[float, ...]
    turned: bool = False

    @property
    def drawn(self) -> Shape:
        """The shape as it lies on the sheet that has not been turned round."""
        return _turned(self.shape, self.sheet) if self.turned else self.shape

    @property
    def piece(self) -> float:
        """How long the last piece is, in mm."""
        return float(_size(self.sheet)[self.axis]) - self.folds[-1]

    @property
    def figure(self) -> tuple[Shape, Sheet]:
        """The last piece with its mirror image, on a sheet that has the last fold in the middle."""
        size = _size(self.sheet)
        low = np.where(np.arange(2) == self.axis, self.folds[-1], 0.0)
        piece = shapely.intersection(filled(self.shape), shapely.box(*low, *size))
        sign = np.where(np.arange(2) == self.axis, -1.0, 1.0)
        at_zero = shapely.transform(piece, lambda points: points - low)
        both = shapely.union(at_zero, shapely.transform(at_zero, lambda points: points * sign))
        middle = np.where(np.arange(2) == self.axis, self.piece, 0.0)
        rings = [ring for part in shapely.get_parts(both) for ring in (part.exterior, *part.interiors)]
        loops = [shapely.get_coordinates(ring)[:-1] + middle for ring in rings]
        return make_shape(loops), Sheet(*(np.where(np.arange(2) == self.axis, 2 * self.piece, size)).tolist())


@dataclass(frozen=True, eq=False)
class FoldedChain:
    """The pattern of a chain.

    ``actions``: how many folds a person makes; ``perpendiculars``: how many of them the last piece has.
    """

    creases: CreasePattern
    folded: FoldedState
    actions: int
    perpendiculars: int
    interrupted: bool


def chain_of(shape: Shape, sheet: Sheet, symmetry: float = 0.0) -> Chain:
    """Return a shape as a chain, made exactly symmetric.

    ``symmetry``: how far, in mm, what lies on each other may be apart. Raises ``UnfoldableError`` where there are not
    enough parallel folds.
    """
    best = Chain(shape, sheet, 0, ())
    for turned in (False, True):  # what is turned over must not be larger than the rest
        seen = _turned(shape, sheet) if turned else shape
        for axis in (0, 1):
            folds, tie = _parallel_folds(seen, sheet, symmetry, axis)
            if len(folds) > max(len(best.folds), FEWEST - 1):
                best = Chain(_symmetric(seen, axis, folds, tie), sheet, axis, folds, turned)
    if not best.folds:
        raise UnfoldableError("the drawing is no row of figures that are mirror images of each other")
    return best


def fold_chain(
    chain: Chain, *, ribbon: float, seconds: float, progress: Callable[[str, float], None] | None = None
) -> FoldedChain:
    """Return the pattern of a chain that a search for some ``seconds``, those of the budget's model, finds.

    ``ribbon`` is in mm. Raises ``UnfoldableError`` where none is found.
    """
    try:
        figure, sheet = chain.figure
    except ShapeError as error:
        raise UnfoldableError(f"the end of the row is no figure to fold: {error}") from error
    found = search_half(figure, sheet, (chain.axis,), near=0.0, ribbon=ribbon, seconds=seconds, progress=progress)
    low = np.where(np.arange(2) == chain.axis, chain.piece, 0.0)
    creases, folded = crop(found.creases, found.folded, low, _size(sheet))
    lines = crease_numbers(creases).lines
    creases = _shifted(creases, -low)
    before = (0.0, *chain.folds[:-1])
    for fold, last in zip(reversed(chain.folds), reversed(before), strict=True):
        creases, folded = _unfolded(creases, folded, chain.axis, fold - last)
    if chain.turned:
        round_again = points_array(_size(chain.sheet) - creases.vertices_coords)
        creases = replace(creases, vertices_coords=round_again)
    return FoldedChain(creases, folded, len(chain.folds) + lines, found.perpendiculars, found.interrupted)


def _size(sheet: Sheet) -> Floats:
    return np.array([sheet.width, sheet.height])


def _turned(shape: Shape, sheet: Sheet) -> Shape:
    """Return a shape as it lies when its sheet has been turned round by 180 degrees."""
    return Shape(tuple(points_array(_size(sheet) - loop) for loop in shape.loops), shape.parent)


def _parallel_folds(shape: Shape, sheet: Sheet, symmetry: float, axis: int) -> tuple[tuple[float, ...], float]:
    """Return folds across a coordinate axis, each of which lays the drawing on itself, and what counts as the same."""
    drawing = drawing_on(shape, sheet, symmetry)
    along = np.array([(0.0, -1.0), (1.0, 0.0)][axis])
    high = _size(sheet)[axis]
    folds: list[float] = []
    while True:
        lines = fold_lines(drawing.sides, drawing.line, drawing.paper, drawing.tie, along)
        low = folds[-1] if folds else 0.0
        places = [line.origin[axis] for line in lines]
        for place in sorted((p for p in places if 2 * p <= low + high + drawing.tie), reverse=True):
            origin = np.where(np.arange(2) == axis, place, 0.0)
            folded = drawing.fold(Line(origin, along))
            if folded is not None:
                drawing = folded
                folds.append(float(place))
                break
        else:
            return tuple(folds), drawing.tie


def _symmetric(shape: Shape, axis: int, folds: tuple[float, ...], tie: float) -> Shape:
    """Return a shape with each corner moved to where the last piece has it, as seen through the folds."""
    corners = np.concatenate(shape.loops).copy()
    turned = np.zeros((len(folds), len(corners)), dtype=np.bool_)
    at = corners.copy()
    for number, fold in enumerate(folds):
        turned[number] = at[:, axis] < fold - tie
        at[turned[number], axis] = 2 * fold - at[turned[number], axis]
    at[np.abs(at[:, axis] - folds[-1]) <= 2 * tie, axis] = folds[-1]
    own = np.flatnonzero(~turned.any(axis=0))
    nearest = own[shapely.STRtree(shapely.points(at[own])).nearest(shapely.points(at))]
    near = np.hypot(*(at[nearest] - at).T) <= 4 * tie
    at[near] = at[nearest[near]]
    for number in reversed(range(len(folds))):
        at[turned[number], axis] = 2 * folds[number] - at[turned[number], axis]
    ends = np.cumsum([len(loop) for loop in shape.loops])[:-1]
    return Shape(tuple(points_array(loop) for loop in np.split(at, ends)), shape.parent)


def _shifted(creases: CreasePattern, step: Floats) -> CreasePattern:
    return replace(creases, vertices_coords=points_array(creases.vertices_coords + step))


def _unfolded(
    creases: CreasePattern, folded: FoldedState, axis: int, width: float
) -> tuple[CreasePattern, FoldedState]:
    """Unfold a pattern about the border at which a coordinate is 0; ``width`` mm of its mirror image are kept.

    Behind each face goes its mirror image, on the side of its back. The new border is at 0 again.
    """
    flat = creases.vertices_coords
    size = np.ptp(flat, axis=0)
    on_border = np.abs(flat[:, axis]) <= 1e-9 * float(np.hypot(*size))
    image = np.where(on_border, np.arange(len(flat)), len(flat) + np.cumsum(~on_border) - 1)
    sign = np.where(np.arange(2) == axis, -1.0, 1.0)
    at = np.where((np.arange(2) == axis) & on_border[:, None], 0.0, flat)
    every = np.concatenate([at, at[~on_border] * sign])
    landed = np.concatenate([folded.vertices_coords, folded.vertices_coords[~on_border]])
    stack: list[list[int]] = []
    faces = creases.faces_vertices.to_lists()
    for number in folded.layers.tolist():
        face = faces[number]
        up = signed_area(folded.vertices_coords[face]) > 0
        mirrored = image[face[::-1]].tolist()
        stack += [mirrored, face] if up else [face, mirrored]
    edges, kinds = creases_of_stack(landed, stack)
    low, high = every.min(axis=0), every.max(axis=0)
    corners = set(np.flatnonzero(((every == low) | (every == high)).all(axis=1)).tolist())
    both, state = assemble(every, landed, stack, edges, kinds, corners)
    low = np.where(np.arange(2) == axis, -width, low)
    if size[axis] > width * (1 + 1e-12):
        both, state = crop(both, state, low, high)
    return _shifted(both, np.where(np.arange(2) == axis, width, 0.0)), state
