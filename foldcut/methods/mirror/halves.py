"""Cut a symmetric shape at its mirror axes, and close what is left to loops: what has to be folded is a half or less.

``Shape`` on its sheet, symmetric about the sheet's own axes -> ``Half`` candidates.

The loops are cut at the axes. In the half sheet this leaves *chains*, which run from border to border with the shape on
their left, and the loops that meet no axis. What lies beyond the border does not matter, so there the ends of chains
are joined by arcs, in any way in which they do not cross:

- to form one loop, for the method ``compact``: its pattern of that loop, clipped at the half sheet, folds the half;
- to form any loops, for the straight skeleton. There each chain goes straight on until it meets the next one or is far
  away, so that nothing that begins beyond the border comes back to the half sheet. Its skeleton is then that of the
  whole shape, and its ridges and perpendiculars end at the axis.

An axis is one fold through a single layer; every other fold then goes through two layers, or through four.
See docs/several-loops.md.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import islice, pairwise

import numpy as np
import shapely

from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.geometry.vectors import cross, signed_area
from foldcut.methods.mirror.unfold import Half
from foldcut.methods.mirror.wedge import Wedge

FAR = (1.0, 0.35)
"""How far beyond the border chains may be joined, as parts of the half sheet's diagonal."""

NEAR = (0.55, 1.2, 0.25)
"""The same, as parts of the distance between the ends."""

MOST_CHAINS = 12
"""Shapes with more chains are refused."""

MOST_MATCHINGS = 4
"""How many ways to join the chains are tried."""

STRAIGHT = 1e-9
"""Directions whose cross product is no larger than this are parallel."""

JUST_BEYOND = 2e-3
"""How far beyond a border of a wedge loops are closed that are closed near to it, as a part of the wedge's size."""

NESTED = 1.5
"""An arc around another one reaches this many times as far."""

FLAT = 3.0
"""A side that runs on along the border goes on for no longer than this many times the distance that is asked for."""

CLOSED = (None, (False, True), (True, False), (True, True))
"""How the loops of a wedge may be closed beyond its borders, as for ``closed_wedge``."""

QUARTER = (0, 1)
"""Both borders of a quarter of the plane, as axes."""

Arc = tuple[int, int]
"""The two ends of chains that an arc joins: 2 n is the start of the nth chain, 2 n + 1 its end."""


def halves_of(shape: Shape, sheet: Sheet, axes: tuple[int, ...]) -> Iterator[Half]:
    """Yield loops by whose straight skeleton a half or a quarter of the sheet can be folded, the simplest first.

    ``shape`` is symmetric about each of ``axes``: 0 is the sheet's upright middle line, 1 the level one. Its loops may
    meet the axes as often as they like, or not at all. The last that is yielded are the loops of the whole shape.
    """
    half, middle = _part(sheet, axes)
    chains, closed = _chains(shape, middle, axes)
    for part in FAR:
        loops = _straight_on(chains, axes, part * half.diagonal)
        if loops is not None:
            loops += closed
            if _are_disjoint(loops):
                yield Half(shape, tuple(_counter_clockwise(loop) for loop in loops), half, axes)
                break
    yield whole(shape, sheet, axes)


def whole(shape: Shape, sheet: Sheet, axes: tuple[int, ...]) -> Half:
    """Return a half or a quarter of the sheet with the loops of the whole shape, which is symmetric about ``axes``."""
    half, middle = _part(sheet, axes)
    return Half(shape, tuple(points_array(loop - middle) for loop in shape.loops), half, axes)


def one_loop_halves(shape: Shape, sheet: Sheet, axes: tuple[int, ...]) -> Iterator[Half]:
    """Yield single loops by which a half or a quarter of the sheet can be folded, the simplest first.

    ``shape`` is symmetric about each of ``axes``: 0 is the sheet's upright middle line, 1 the level one. Raises
    ``UnfoldableError`` where a loop meets no axis, and where the shape crosses the axes too often.
    """
    half, middle = _part(sheet, axes)
    chains, closed = _chains(shape, middle, axes)
    for loop in _one_loop(chains, closed, axes, half.diagonal, lambda place: place + middle):
        yield Half(shape, (points_array(loop),), half, axes)


def closed_wedge(wedge: Wedge, near: tuple[bool, bool] | None) -> Wedge | None:
    """Return a wedge with loops that are closed straight beyond its last border, its first one, or both.

    ``near`` says for the last border and for the first one whether that is just beyond it, or far away; with None the
    loops stay those of the whole shape. None where loops would cross. The straight skeleton of these loops differs from
    that of the whole shape: near a border it has the ridges between the shape and a side along the border, where
    otherwise the ridges of both sides of it meet.
    """
    if near is None:
        return wedge
    borders = wedge.borders
    chains, closed, size = _in_quarter(wedge)
    away = np.where(near, JUST_BEYOND, FAR[0]) * size
    loops = _cut_off(chains, QUARTER, away)
    if loops is None:
        return None
    loops = [loop @ borders for loop in (*loops, *closed)]
    return replace(wedge, loops=tuple(map(_counter_clockwise, loops))) if _are_disjoint(loops) else None


def _in_quarter(wedge: Wedge) -> tuple[list[Floats], list[Floats], float]:
    """Return the chains and loops of a wedge as ``_chains`` does, and its size, in coordinates along its two borders.

    In these it is a quarter of a plane, and straight lines stay straight.
    """
    to_quarter = np.linalg.inv(wedge.borders)
    oblique = Shape(tuple(points_array(loop @ to_quarter) for loop in wedge.outline.loops), wedge.outline.parent)
    size = float(np.hypot(*np.max(wedge.sheet.corners @ to_quarter, axis=0)))
    return *_chains(oblique, np.zeros(2), QUARTER), size


def one_loop_wedges(wedge: Wedge) -> Iterator[Wedge]:
    """Do as ``one_loop_halves`` with a wedge."""
    borders = wedge.borders
    chains, closed, size = _in_quarter(wedge)
    for loop in _one_loop(chains, closed, QUARTER, size, lambda place: wedge.on_whole(place[None] @ borders)[0]):
        yield replace(wedge, loops=(points_array(loop @ borders),))


def _one_loop(
    chains: list[Floats],
    closed: list[Floats],
    axes: tuple[int, ...],
    size: float,
    on_whole: Callable[[Floats], Floats],
) -> Iterator[Floats]:
    """Yield single loops, ``(n, 2)``, that have all chains in them, the simplest first.

    ``size`` is that of the part of the sheet, ``on_whole`` tells where on the whole sheet a place is.
    """
    if closed and (chains or len(closed) > 1):
        x, y = on_whole(closed[0].mean(axis=0))
        raise UnfoldableError(f"the loop around ({x:.1f}, {y:.1f}) mm does not meet the mirror axis")
    if len(chains) > MOST_CHAINS:
        raise UnfoldableError(f"the drawing crosses the mirror axis {2 * len(chains)} times; too often to be folded")
    if closed:
        yield closed[0]
        return
    ends = np.array([(_along_border(chain[0], axes), _along_border(chain[-1], axes)) for chain in chains])
    order = np.argsort(ends.ravel(), kind="stable")
    ways = list(islice((arcs for arcs in matchings(order.tolist()) if _is_one_loop(arcs)), MOST_MATCHINGS))
    # long arms of several chains would need many turns
    far, near = [(0.0, part * size) for part in FAR], [(part, 0.0) for part in NEAR]
    for margins in far + near if len(chains) == 1 else near + far:
        for arcs in ways:
            loop = _joined(chains, arcs, axes, *margins)
            if loop is not None:
                yield loop


def _part(sheet: Sheet, axes: tuple[int, ...]) -> tuple[Sheet, Floats]:
    """Return the half or quarter of a sheet above and to the right of its axes, and where on the sheet it begins."""
    size = np.array([sheet.width, sheet.height])
    middle = np.where(np.isin([0, 1], axes), size / 2, 0.0)
    return Sheet(*(size - middle).tolist()), middle


def _chains(shape: Shape, middle: Floats, axes: Sequence[int]) -> tuple[list[Floats], list[Floats]]:
    """Return the chains in the half sheet, ``(n, 2)`` each, and the loops that lie in it as a whole.

    The shape is on their left.
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
    """Return the ends of what is left of a side, exactly on the axes where these cut it; None if nothing is left."""
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
    """Return how far along the axes a point on them is, walking with the half sheet on the right, in mm."""
    return float(point[1]) if 0 in axes and point[0] == 0 else -float(point[0])


def matchings(places: Sequence[int]) -> Iterator[list[Arc]]:
    """Yield all ways to join places on a line in pairs by arcs on one side of it that do not cross."""
    if not places:
        yield []
        return
    for k in range(1, len(places), 2):
        for inner in matchings(places[1:k]):
            for outer in matchings(places[k + 1 :]):
                yield [(places[0], places[k]), *inner, *outer]


def _is_one_loop(arcs: Sequence[Arc]) -> bool:
    """Return whether arcs join each end of a chain to a start, and all chains to one loop."""
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
    """Join chains to one loop beyond the border, or return None where they would cross.

    Arcs reach ``far`` mm beyond the border, and ``near`` times the distance between their ends.
    """
    place = {}
    for number, chain in enumerate(chains):
        place[2 * number], place[2 * number + 1] = (_along_border(chain[k], axes) for k in (0, -1))
    reach = _reaches(arcs, place, near, far)
    joins: dict[int, tuple[int, list[Floats]]] = {}
    for arc in arcs:
        end, start = arc if arc[0] % 2 else (arc[1], arc[0])
        away = reach[arc]
        one, other = chains[end // 2], chains[start // 2]
        first, last = extended(one[-2], one[-1], axes, away), extended(other[1], other[0], axes, away)
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


def _straight_on(chains: Sequence[Floats], axes: Sequence[int], away: float) -> list[Floats] | None:
    """Let chains go straight on beyond the border, ``away`` mm far, and close them to loops; None where that fails.

    Of neighbouring ends whose sides meet there, those are joined first that meet nearest to the border. What is left is
    closed far away, where the shape is between neighbours. The loops have the shape on their left.
    """
    place: dict[int, Floats] = {}
    far: dict[int, Floats] = {}
    for number, chain in enumerate(chains):
        for end, (before, last) in ((2 * number, (chain[1], chain[0])), (2 * number + 1, (chain[-2], chain[-1]))):
            place[end], far[end] = last, extended(before, last, axes, away)
    ends = sorted(place, key=lambda end: _along_border(place[end], axes))
    joins: dict[int, tuple[int, list[Floats]]] = {}

    def join(a: int, b: int, between: list[Floats]) -> None:
        if b % 2:
            a, b, between = b, a, between[::-1]
        joins[a] = (b, between)

    while ends:
        met = []
        for a, b in pairwise(ends):
            apex = _meeting(place[a], far[a], place[b], far[b])
            if apex is not None:
                met.append((max(float(-apex[list(axes)].min()), 0.0), a, b, apex))
        if not met:
            break
        _, a, b, apex = min(met, key=lambda one: one[0])
        join(a, b, [apex])
        ends = [end for end in ends if end not in (a, b)]
    for a, b in zip(ends[::2], ends[1::2], strict=True):
        around = len(axes) == 2 and _along_border(place[a], axes) * _along_border(place[b], axes) < 0
        join(a, b, [far[a], *([np.array([-away, -away])] if around else []), far[b]])
    return _loops_of(chains, joins)


def _cut_off(chains: Sequence[Floats], axes: Sequence[int], away: Floats) -> list[Floats] | None:
    """Let chains go straight on to ``away`` ``(2,)`` mm beyond the border at each axis, and close them there to loops.

    They are closed where the shape is between neighbours. None where that fails.
    """
    place: dict[int, Floats] = {}
    far: dict[int, Floats] = {}
    for number, chain in enumerate(chains):
        for end, (before, last) in ((2 * number, (chain[1], chain[0])), (2 * number + 1, (chain[-2], chain[-1]))):
            axis = next(axis for axis in axes if last[axis] == 0)
            place[end], far[end] = last, extended(before, last, axes, float(away[axis]))
    ends = sorted(place, key=lambda end: _along_border(place[end], axes))
    joins: dict[int, tuple[int, list[Floats]]] = {}
    for a, b in zip(ends[::2], ends[1::2], strict=True):
        around = _along_border(place[a], axes) * _along_border(place[b], axes) < 0
        between = [far[a], *([-away] if around else []), far[b]]
        joins[b if b % 2 else a] = (a, between[::-1]) if b % 2 else (b, between)
    return _loops_of(chains, joins)


def _loops_of(chains: Sequence[Floats], joins: dict[int, tuple[int, list[Floats]]]) -> list[Floats] | None:
    """Return the loops that chains make with what joins their ends to starts, None where these are not all joined."""
    if len(joins) < len(chains) or any(not a % 2 or b % 2 for a, (b, _) in joins.items()):
        return None
    loops = []
    left = set(range(len(chains)))
    while left:
        points: list[Floats] = []
        at = min(left)
        while at in left:
            left.remove(at)
            points += list(chains[at][1:-1])  # an end on the border is in the middle of a straight side
            following, between = joins[2 * at + 1]
            at, points = following // 2, points + between
        loops.append(_without_straight(np.array(points)))
    return loops


def _are_disjoint(loops: Sequence[Floats]) -> bool:
    """Return whether loops neither cross nor touch, and have three corners or more."""
    if any(len(loop) < 3 for loop in loops):
        return False
    return bool(shapely.multilinestrings([shapely.linearrings(loop) for loop in loops]).is_simple)


def _counter_clockwise(loop: Floats) -> Floats:
    return points_array(loop if signed_area(loop) > 0 else loop[::-1])


def _reaches(arcs: Sequence[Arc], place: dict[int, float], near: float, far: float) -> dict[Arc, float]:
    """Return how far beyond the border each arc reaches, in mm; ``place`` of ends is along the border."""
    reach: dict[Arc, float] = {}
    spans = {arc: tuple(sorted(place[end] for end in arc)) for arc in arcs}
    for arc in sorted(arcs, key=lambda arc: spans[arc][1] - spans[arc][0]):
        low, high = spans[arc]
        within = [reach[other] for other in reach if low < spans[other][0] and spans[other][1] < high]
        reach[arc] = max([far + near * (high - low), *(NESTED * inner for inner in within)])
    return reach


def extended(before: Floats, end: Floats, axes: Sequence[int], away: float) -> Floats:
    """Return where a chain's last side, from ``before`` to ``end``, is ``away`` mm beyond the border.

    ``end`` lies on the border at one of the axes, ``before`` does not. A flat side stops sooner.
    """
    axis = next(axis for axis in axes if end[axis] == 0)
    along = end - before
    reach = away / -along[axis]
    reach = min(reach, FLAT * away / float(np.hypot(*along)))
    place: Floats = end + along * reach
    return place


def _meeting(a: Floats, a_far: Floats, b: Floats, b_far: Floats) -> Floats | None:
    """Return where the segments from a to a_far and from b to b_far meet, None if they do not."""
    one, other, between = a_far - a, b_far - b, b - a
    slope = float(cross(one, other))
    if abs(slope) <= STRAIGHT * np.hypot(*one) * np.hypot(*other):  # or one of them has no length
        return None
    s, t = float(cross(between, other)) / slope, float(cross(between, one)) / slope
    place: Floats = a + one * s
    return place if 0 < s < 1 and 0 < t < 1 else None


def _without_straight(loop: Floats) -> Floats:
    """Return a loop without the points where it goes straight on."""
    before, after = loop - np.roll(loop, 1, axis=0), np.roll(loop, -1, axis=0) - loop
    bent: Floats = loop[np.abs(cross(before, after)) > STRAIGHT * np.hypot(*before.T) * np.hypot(*after.T)]
    return bent
