"""Fold the mirror axes of a symmetric shape first: what is left to fold is a half or a quarter of it.

``Shape`` on its sheet, symmetric about the sheet's own axes -> ``Half`` loops; the folded half -> the whole pattern.

The loops are cut off at the axes. What is left are chains that begin and end on the border of the half sheet, inside
and outside of the shape on either side of them. What is beyond the border does not matter: there the chains are joined
to one loop, in any way in which they do not cross. The compact pattern of that loop, clipped at the half sheet, folds
the half; behind every face then goes its mirror image. Holes and several components need nothing else, as long as all
loops meet an axis.

A straight line across all of the sheet that is folded first is a fold through one layer; each other fold goes through
two, or four. Why the order of the layers is right: it is that of a folded sheet of double thickness.
See docs/several-loops.md.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, points_array
from foldcut.core.errors import UnfoldableError
from foldcut.core.model import CreasePattern, FoldedState, Region, Shape, Sheet
from foldcut.geometry.vectors import cross, signed_area
from foldcut.methods.compact.budget import EFFORT_SECONDS
from foldcut.methods.compact.part import SheetPart
from foldcut.methods.compact.pattern import regions
from foldcut.methods.compact.search import Compact, fold_compact
from foldcut.pattern.assemble import Ring, assemble, creases_of_stack
from foldcut.pattern.ranking import Rank, rank, shortest_crease

FAR = (1.0, 0.35)
"""How far beyond the border chains may be joined, as parts of the half sheet's diagonal."""

NEAR = (0.55, 1.2, 0.25)
"""The same as parts of how far the ends are from each other."""

MOST_CHAINS = 12
MOST_MATCHINGS = 4

SCAN, MOST_SCAN, FINAL, FINALISTS = 0.4, 0.08, 0.3, 2
"""Parts of the effort: for a first look at loops, for each of them at most, and for so many of the best."""

LOOK_S, FEWEST_LOOKS, MOST_LOOKS = 0.25, 3, 16
"""What a first look takes at least, in seconds of effort; and how many loops are looked at."""

Arc = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Half(SheetPart):
    """A part of the sheet, and one loop to fold it by.

    ``sheet`` is the part to the right of the upright axis, 0, or above the level one, 1, or both: see ``axes``;
    ``loop`` ``(n, 2)`` mm on it, counter-clockwise, reaches beyond it at the axes; ``shape`` is the whole one on the
    whole sheet.
    """

    loop: Floats
    sheet: Sheet
    axes: tuple[int, ...]

    @property
    def first_folds(self) -> tuple[Floats, ...]:
        """The axes on the whole sheet, ``(2, 2)`` mm each, in the order in which they are folded."""
        size = np.array([self.sheet.width, self.sheet.height]) * np.where(np.isin([0, 1], self.axes), 2.0, 1.0)
        lines = []
        for axis in reversed(self.axes):
            line = np.array([(0.0, 0.0), size])
            line[:, axis] = size[axis] / 2
            lines.append(points_array(line))
        return tuple(lines)

    def creased(self, creases: CreasePattern) -> Bools:
        """Which edges of the half's pattern are creases of the whole: those on the axes are, too."""
        ends = np.abs(creases.vertices_coords[creases.edges_vertices]) <= self.tie
        on_axis = np.logical_and(ends[:, 0], ends[:, 1])[:, list(self.axes)].any(axis=1)
        return np.asarray((creases.edges_assignment != "B") | on_axis)

    @property
    def tie(self) -> float:
        """How near a vertex is to an axis that it is on, in mm."""
        return 1e-9 * self.sheet.diagonal

    def unfold(self, creases: CreasePattern, folded: FoldedState) -> tuple[CreasePattern, FoldedState]:
        """Unfold the pattern of the half sheet to that of the whole one."""
        size = np.array([self.sheet.width, self.sheet.height])
        at = np.zeros(2)
        for axis in self.axes:
            at[axis] = size[axis]
            creases, folded = _doubled(creases, folded, axis, self.tie)
        moved = points_array(creases.vertices_coords + at)
        return CreasePattern(moved, creases.edges_vertices, creases.edges_assignment, creases.faces_vertices), folded

    def unfold_regions(self, regions: tuple[Region, ...]) -> tuple[Region, ...]:
        """Unfold the regions of the half sheet: behind each goes its mirror image, which is folded with it."""
        at = np.where(np.isin([0, 1], self.axes), [self.sheet.width, self.sheet.height], 0.0)
        signs = [np.ones(2)]
        for axis in self.axes:
            signs += [sign * np.where(np.arange(2) == axis, -1.0, 1.0) for sign in signs]
        return tuple(
            Region(
                tuple(points_array(outline * sign + at) for outline in region.outlines for sign in signs), region.parent
            )
            for region in regions
        )


@dataclass(frozen=True, eq=False)
class Mirrored:
    """The pattern of a sheet that is folded along its axes first: what the search found for the half, and the half."""

    found: Compact
    half: Half

    @property
    def creases(self) -> CreasePattern:
        """The creases of the whole sheet."""
        return self.found.creases

    @property
    def folded(self) -> FoldedState:
        """How the whole sheet folds."""
        return self.found.folded

    @property
    def regions(self) -> tuple[Region, ...]:
        """The regions of the whole sheet."""
        return self.half.unfold_regions(regions(self.found.walk, self.found.molecules, self.half.sheet))


def fold_mirrored(
    candidates: Sequence[Half],
    *,
    ribbon: float = 0.0,
    effort: str = "normal",
    seconds: float | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> Mirrored:
    """Return the verified pattern that is easiest to fold: see ``fold_compact`` for the options and Ctrl-C.

    The most promising of ``candidates`` get a first look, the best of these more. Raises ``UnfoldableError`` when none
    folds.
    """
    best: tuple[Rank, Mirrored] | None = None
    part = 0.0

    def tell(text: str, done: float) -> None:
        if progress is not None:
            progress(f"half of the sheet: {text}", part + share * done)

    def look(half: Half) -> Rank | None:
        nonlocal best, part
        try:
            found = fold_compact(
                half.loop,
                half.sheet,
                ribbon=ribbon,
                effort=effort,
                seconds=seconds,
                progress=tell,
                share=share,
                part=half,
            )
        except UnfoldableError:
            return None
        finally:
            part += share
        key = rank(len(half.axes) + found.part.crease_count, shortest_crease(found.creases))
        if best is None or key < best[0]:
            best = key, Mirrored(found, half)
        if found.interrupted:
            raise KeyboardInterrupt
        return key

    try:
        looks = min(max(round(SCAN * (seconds or EFFORT_SECONDS[effort]) / LOOK_S), FEWEST_LOOKS), MOST_LOOKS)
        candidates = _by_promise(candidates)[:looks]
        share = min(MOST_SCAN, SCAN / max(1, len(candidates)))
        ranked = [(key, number) for number, half in enumerate(candidates) if (key := look(half)) is not None]
        finalists = sorted(ranked)[:FINALISTS]
        share = FINAL / max(1, len(finalists))
        for _, number in finalists:
            look(candidates[number])
    except KeyboardInterrupt:
        if best is None:
            raise
        return Mirrored(replace(best[1].found, interrupted=True), best[1].half)
    if best is None:
        raise UnfoldableError("no pattern was found for the half sheet; try a higher effort")
    return best[1]


def _by_promise(candidates: Sequence[Half]) -> list[Half]:
    """Return those first that promise most: few corners and two axes; ways to lay the shape take turns."""
    seen: Counter[tuple[int, tuple[int, ...]]] = Counter()
    keys = []
    for number, half in enumerate(candidates):
        way = id(half.shape), half.axes
        keys.append((len(half.loop) - 2 * len(half.axes), seen[way], number))
        seen[way] += 1
    return [candidates[number] for *_, number in sorted(keys)]


def halves(shape: Shape, sheet: Sheet, axes: tuple[int, ...]) -> Iterator[Half]:
    """Yield loops for the part of ``sheet`` on one side of its axes, the simplest first.

    ``shape`` is symmetric about each of ``axes``: 0 is the sheet's upright middle line, 1 the level one. Raises
    ``UnfoldableError`` when a loop meets no axis.
    """
    size = np.array([sheet.width, sheet.height])
    middle = np.where(np.isin([0, 1], axes), size / 2, 0.0)
    half = Sheet(*(size - middle).tolist())
    chains, closed = _chains(shape, middle, axes)
    if closed and (chains or len(closed) > 1):
        x, y = closed[0].mean(axis=0) + middle
        raise UnfoldableError(f"the loop around ({x:.1f}, {y:.1f}) mm does not meet the mirror axis")
    if len(chains) > MOST_CHAINS:
        raise UnfoldableError(f"the drawing crosses the mirror axis {2 * len(chains)} times; too often to be folded")
    if closed:
        yield Half(shape, points_array(closed[0]), half, axes)
        return
    ends = np.array([(_along_border(chain[0], axes), _along_border(chain[-1], axes)) for chain in chains])
    order = np.argsort(ends.ravel(), kind="stable")
    matchings = list(islice((arcs for arcs in _matchings(order.tolist()) if _is_one_loop(arcs)), MOST_MATCHINGS))
    # the arms of several chains are best cut off soon
    far, near = [(0.0, part * half.diagonal) for part in FAR], [(part, 0.0) for part in NEAR]
    for margins in far + near if len(chains) == 1 else near + far:
        for arcs in matchings:
            loop = _joined(chains, arcs, axes, *margins)
            if loop is not None:
                yield Half(shape, points_array(loop), half, axes)


def _chains(shape: Shape, middle: Floats, axes: Sequence[int]) -> tuple[list[Floats], list[Floats]]:
    """Return the pieces of loops in the half sheet, from border to border, and the loops that are there whole.

    The shape is at their left.
    """
    chains: list[Floats] = []
    closed: list[Floats] = []
    for number, drawn in enumerate(shape.loops):
        loop = (drawn[::-1] if shape.depth(number) % 2 else drawn) - middle
        tie = 1e-9 * float(np.ptp(loop, axis=0).max())
        pieces: list[list[Floats]] = []
        for start, end in zip(loop, np.roll(loop, -1, axis=0), strict=True):
            clipped = _clipped(start, end, axes, tie)
            if clipped is None:
                continue
            if pieces and np.array_equal(pieces[-1][-1], clipped[0]):
                pieces[-1].append(clipped[1])
            else:
                pieces.append([*clipped])
        if len(pieces) > 1 and np.array_equal(pieces[-1][-1], pieces[0][0]):
            pieces[0] = pieces.pop() + pieces[0][1:]
        for piece in pieces:
            if (piece[0][list(axes)] == 0).any():
                chains.append(np.array(piece))
            else:
                closed.append(np.array(piece[:-1]))
    return chains, closed


def _clipped(start: Floats, end: Floats, axes: Sequence[int], tie: float) -> tuple[Floats, Floats] | None:
    """Return what is left of a side on the right of the axes, its ends there exactly, or None."""
    a, b = start.copy(), end.copy()
    for axis in axes:
        for point in (a, b):
            if abs(point[axis]) <= tie:
                point[axis] = 0.0
        if a[axis] <= 0 and b[axis] <= 0:
            return None
        if a[axis] < 0 or b[axis] < 0:
            place = a + (b - a) * (a[axis] / (a[axis] - b[axis]))
            place[axis] = 0.0
            a, b = (place, b) if a[axis] < 0 else (a, place)
    return None if np.hypot(*(b - a)) <= tie else (a, b)


def _along_border(point: Floats, axes: Sequence[int]) -> float:
    """Where a point of the half sheet's border is: a number that grows along the axes with the sheet at the right."""
    return float(point[1]) if 0 in axes and point[0] == 0 else -float(point[0])


def _matchings(places: Sequence[int]) -> Iterator[list[Arc]]:
    """Yield all ways to join places on a line in pairs by arcs on one side of it that do not cross."""
    if not places:
        yield []
        return
    for k in range(1, len(places), 2):
        for inner in _matchings(places[1:k]):
            for outer in _matchings(places[k + 1 :]):
                yield [(places[0], places[k]), *inner, *outer]


def _is_one_loop(arcs: Sequence[Arc]) -> bool:
    """Whether chains, 2 n and 2 n + 1 the ends of the nth, are one loop when they are joined by arcs, end to start."""
    following = {}
    for a, b in arcs:
        if a % 2 == b % 2:
            return False
        end, start = (a, b) if a % 2 else (b, a)
        following[end // 2] = start // 2
    chain, count = following[0], 1
    while chain:
        chain, count = following[chain], count + 1
    return count == len(arcs)


def _joined(
    chains: Sequence[Floats], arcs: Sequence[Arc], axes: Sequence[int], near: float, far: float
) -> Floats | None:
    """Join chains to one loop beyond the border, or return None if there is no room so far out.

    ``near`` times the distance of ends and ``far`` mm away.
    """
    place = {}
    for number, chain in enumerate(chains):
        place[2 * number], place[2 * number + 1] = (_along_border(chain[k], axes) for k in (0, -1))
    reach: dict[Arc, float] = {}
    spans = {arc: tuple(sorted(place[end] for end in arc)) for arc in arcs}
    for arc in sorted(arcs, key=lambda arc: spans[arc][1] - spans[arc][0]):
        low, high = spans[arc]
        within = [reach[other] for other in reach if low < spans[other][0] and spans[other][1] < high]
        reach[arc] = max([far + near * (high - low), *(1.5 * inner for inner in within)])
    joins: dict[int, tuple[int, list[Floats]]] = {}
    for arc in arcs:
        end, start = arc if arc[0] % 2 else (arc[1], arc[0])
        away = reach[arc]
        one, other = chains[end // 2], chains[start // 2]
        first, last = _beyond(one[-2], one[-1], axes, away), _beyond(other[1], other[0], axes, away)
        between: list[Floats] = [first, last]
        if len(axes) == 2 and place[end] * place[start] < 0:
            between.insert(1, np.array([-away, -away]))
        else:
            apex = _meeting(one[-1], first, other[0], last)
            if apex is not None:
                between = [apex]
        joins[end // 2] = (start // 2, between)
    points: list[Floats] = []
    at = 0
    for _ in chains:
        points += list(chains[at][1:-1])  # an end on the border is in the middle of a straight side
        at, between = joins[at]
        points += between
    loop = _without_straight(np.array(points))
    polygon = shapely.Polygon(loop)
    good = len(loop) > 2 and polygon.is_valid and signed_area(loop) > 0
    return loop if good else None


def _beyond(before: Floats, end: Floats, axes: Sequence[int], away: float) -> Floats:
    """Where a chain's last side, from ``before`` to ``end``, goes on to so far beyond the border."""
    axis = next(axis for axis in axes if end[axis] == 0)
    along = end - before
    reach = away / -along[axis]
    # a flat side does not go far
    reach = min(reach, 3 * away / float(np.hypot(*along)))
    place: Floats = end + along * reach
    return place


def _meeting(a: Floats, a_far: Floats, b: Floats, b_far: Floats) -> Floats | None:
    """Where the lines from a to a_far and from b to b_far meet on the way, or None."""
    one, other, between = a_far - a, b_far - b, b - a
    slope = float(cross(one, other))
    if abs(slope) < 1e-9 * np.hypot(*one) * np.hypot(*other):
        return None
    s, t = float(cross(between, other)) / slope, float(cross(between, one)) / slope
    place: Floats = a + one * s
    return place if 0 < s < 1 and 0 < t < 1 else None


def _without_straight(loop: Floats) -> Floats:
    """Leave out points where the loop goes straight on."""
    before, after = loop - np.roll(loop, 1, axis=0), np.roll(loop, -1, axis=0) - loop
    bent: Floats = loop[np.abs(cross(before, after)) > 1e-9 * np.hypot(*before.T) * np.hypot(*after.T)]
    return bent


def _doubled(creases: CreasePattern, folded: FoldedState, axis: int, tie: float) -> tuple[CreasePattern, FoldedState]:
    """Unfold a pattern about the axis on which this coordinate is 0: behind each face goes its mirror image."""
    flat = creases.vertices_coords.copy()
    on_axis = np.abs(flat[:, axis]) <= tie
    flat[on_axis, axis] = 0.0
    image = np.where(on_axis, np.arange(len(flat)), len(flat) + np.cumsum(~on_axis) - 1)
    sign = np.where(np.arange(2) == axis, -1.0, 1.0)
    every = np.concatenate([flat, flat[~on_axis] * sign])
    landing = np.concatenate([folded.vertices_coords, folded.vertices_coords[~on_axis]])
    stack: list[Ring] = []
    faces = creases.faces_vertices.to_lists()
    for face in folded.layers.tolist():
        ring = faces[face]
        mirrored = image[ring[::-1]].tolist()
        up = signed_area(folded.vertices_coords[ring]) > 0
        stack += [mirrored, ring] if up else [ring, mirrored]
    edges, kinds = creases_of_stack(landing, stack)
    low, high = every.min(axis=0), every.max(axis=0)
    at_corner = ((np.abs(every - low) <= tie) | (np.abs(every - high) <= tie)).all(axis=1)
    return assemble(every, landing, stack, edges, kinds, set(np.flatnonzero(at_corner).tolist()))
