"""Cut drawn loops into the chains that sides are fitted to, and put loops together again from fitted chains.

A *chain* is a row of samples of one loop, with the paper of the shape on its left: a whole loop, cut open at a corner,
or, in a drawing with mirror axes, the part of a loop from one axis to the next. Only as many chains are fitted as are
needed: the others are mirror images.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats
from foldcut.core.model import Shape

__all__ = ["Axis", "Chain", "Chains", "Line", "chains_of", "loop_corners"]

MOST = 500
"""The largest number of samples of a chain, corners aside."""

SHARP = math.radians(28)
"""Where a drawn line turns by more than this at one point, it has a true corner."""

APART = 1.5
"""Of corners nearer to each other along the line than this many tolerances, only the sharpest is kept."""

SAME_MM = 1e-4
"""Points of a row that are nearer to each other than this, in mm, are one: a direction between them means nothing."""

MEET = math.sin(math.radians(2.5))
"""Lines with a smaller sine of the angle between them do not make a corner."""


@dataclass(frozen=True, eq=False)
class Axis:
    """A mirror axis: a place on it ``(2,)`` in mm, and its direction in radians."""

    place: Floats
    angle: float

    @property
    def along(self) -> Floats:
        """Its unit direction."""
        return np.array([math.cos(self.angle), math.sin(self.angle)])

    @property
    def normal(self) -> Floats:
        """Its left unit normal."""
        return np.array([-math.sin(self.angle), math.cos(self.angle)])

    def side(self, points: Floats) -> Floats:
        """Return how far points ``(n, 2)`` are to the left of it, in mm."""
        distances: Floats = (points - self.place) @ self.normal
        return distances

    def mirrored(self, points: Floats) -> Floats:
        """Return the mirror images of points ``(n, 2)``."""
        images: Floats = points - 2 * self.side(points)[:, None] * self.normal
        return images


@dataclass(frozen=True, eq=False)
class Chain:
    """A row of samples, ``points`` ``(m, 2)``, of loop number ``loop``, with the shape's paper on its left.

    ``corners`` ``(m,)``: which samples are true corners. ``ends``: the axes on which the chain begins and ends; both
    None where it is a whole loop, whose last sample is the first once more.
    """

    loop: int
    points: Floats
    corners: Bools
    ends: tuple[Axis | None, Axis | None]

    @property
    def is_closed(self) -> bool:
        """Whether it is a whole loop."""
        return self.ends[0] is None


@dataclass(frozen=True, eq=False)
class Line:
    """A fitted side: the line ``normal @ p == offset``, paper on its left, for samples ``start`` to ``end``."""

    start: int
    end: int
    normal: Floats
    offset: float


@dataclass(frozen=True, eq=False)
class Chains:
    """All chains of a drawing, and for each loop the chain it is made from, and by which axes that is mirrored."""

    chains: tuple[Chain, ...]
    source: tuple[tuple[int, tuple[Axis, ...]], ...]
    axes: tuple[Axis, ...]

    def loops(
        self, lines: Sequence[Sequence[Line]], reach: float, *, true_corners: bool = False
    ) -> list[Floats] | None:
        """Return the loops that fitted lines, chain by chain, make; None where lines do not meet.

        A corner that would be farther than ``reach`` mm from the drawn line is put between both lines there;
        with ``true_corners`` one that would be as far from a true corner is put there.
        """
        made = []
        for chain, fitted in zip(self.chains, lines, strict=True):
            loop = loop_corners(chain, fitted, reach, true_corners=true_corners)
            if loop is None or len(loop) < 3:
                return None
            made.append(loop)
        loops = []
        for number, axes in self.source:
            loop = made[number]
            for axis in axes:
                loop = axis.mirrored(loop)[::-1]
            loops.append(loop)
        return loops


def chains_of(drawn: Shape, tolerance: float, axes: Sequence[Axis] = ()) -> Chains | None:
    """Return the chains of a drawing's dense loops; ``tolerance`` in mm decides how dense their samples are.

    ``axes``: none, one, two at right angles, or several through one point, evenly spaced and in order of their
    directions. None if the drawing is not symmetric enough about them for its loops to be taken apart.
    """
    loops = [loop if drawn.depth(k) % 2 == 0 else loop[::-1] for k, loop in enumerate(drawn.loops)]
    crossing = [[axis for axis in axes if _crosses(axis, loop)] for loop in loops]
    chains: list[Chain] = []
    source: list[tuple[int, tuple[Axis, ...]] | None] = [None] * len(loops)
    for k, loop in enumerate(loops):
        if source[k] is not None:
            continue
        chain = _chain(k, loop, tolerance, crossing[k])
        if chain is None:
            return None
        chains.append(chain)
        for ways in _ways(axes, crossing[k]):
            image = loop
            for axis in ways:
                image = axis.mirrored(image)[::-1]
            which = _same_loop(image, loops, tolerance)
            if which is None:
                return None
            if source[which] is None:
                source[which] = (len(chains) - 1, ways)
    return Chains(tuple(chains), tuple(one for one in source if one is not None), tuple(axes))


def _ways(axes: Sequence[Axis], crossed: Sequence[Axis]) -> list[tuple[Axis, ...]]:
    """Return the products of reflections, in one or two axes, that may bring a loop to another place.

    ``crossed`` are the axes that it crosses: it is its own image in these.
    """
    if len(axes) > 2:
        return [(), *((axis,) for axis in axes), *((axes[0], axis) for axis in axes[1:])]
    axes = [axis for axis in axes if axis not in crossed]
    if not axes:
        return [()]
    if len(axes) == 1:
        return [(), (axes[0],)]
    return [(), (axes[0],), (axes[1],), (axes[0], axes[1])]


def _crosses(axis: Axis, loop: Floats) -> bool:
    sides = axis.side(loop)
    return bool(min(sides.max(), -sides.min()) > 0.25 * np.abs(sides).max())


def _same_loop(image: Floats, loops: Sequence[Floats], tolerance: float) -> int | None:
    """Return the number of the loop whose box is that of ``image``."""
    box = np.concatenate([image.min(axis=0), image.max(axis=0)])
    off = [float(np.abs(np.concatenate([q.min(axis=0), q.max(axis=0)]) - box).max()) for q in loops]
    best = int(np.argmin(off))
    return best if off[best] <= 2 * tolerance else None


def _chain(number: int, loop: Floats, tolerance: float, axes: Sequence[Axis]) -> Chain | None:
    if not axes:
        turned = np.roll(loop, -_cut_open(loop), axis=0)
        points = np.concatenate([turned, turned[:1]])
        return _sampled(number, points, tolerance, (None, None))
    half = _part(loop, axes[0])
    if half is None:
        return None
    points = half
    ends = (axes[0], axes[0])
    if len(axes) > 2:  # of the half, the part between the first two axes
        axes = [axes[0], Axis(axes[1].place, axes[1].angle + math.pi)]
    if len(axes) == 2:
        # of the half, the part on the left of the other axis
        halved = _open_part(points, axes[1])
        if halved is None:
            return None
        points, at_start = halved
        ends = (axes[0], axes[1]) if at_start else (axes[1], axes[0])
    return _sampled(number, points, tolerance, ends)


def _part(loop: Floats, axis: Axis) -> Floats | None:
    """Return the longest part of a closed loop on the left of an axis, with both ends on the axis."""
    sides = axis.side(loop)
    start = int(np.argmin(sides))
    turned, sides = np.roll(loop, -start, axis=0), np.roll(sides, -start)
    turned, sides = np.concatenate([turned, turned[:1]]), np.concatenate([sides, sides[:1]])
    up = np.flatnonzero((sides[:-1] <= 0) & (sides[1:] > 0))
    down = np.flatnonzero((sides[:-1] > 0) & (sides[1:] <= 0))
    if not len(up) or len(up) != len(down):
        return None
    best = int(np.argmax(down - up)) if len(up) > 1 else 0
    if len(up) > 1:
        heights = [sides[a + 1 : b + 1].max() for a, b in zip(up, down, strict=True)]
        best = int(np.argmax(heights))
    a, b = int(up[best]), int(down[best])
    return np.concatenate([[_at(turned, sides, a)], turned[a + 1 : b + 1], [_at(turned, sides, b)]])


def _open_part(points: Floats, axis: Axis) -> tuple[Floats, bool] | None:
    """Return the part of a row that is on the left of an axis which it crosses once, and whether its start is there."""
    sides = axis.side(points)
    cross = np.flatnonzero((sides[:-1] > 0) != (sides[1:] > 0))
    if len(cross) != 1:
        return None
    k = int(cross[0])
    place = _at(points, sides, k)
    if sides[0] > 0:
        return np.concatenate([points[: k + 1], [place]]), True
    return np.concatenate([[place], points[k + 1 :]]), False


def _at(points: Floats, sides: Floats, k: int) -> Floats:
    """Return where the line from point k to the next crosses the axis."""
    part = sides[k] / (sides[k] - sides[k + 1])
    place: Floats = points[k] + part * (points[k + 1] - points[k])
    return place


def _cut_open(loop: Floats) -> int:
    """Return where to cut a loop open: at its sharpest corner, or at its highest point if it has none."""
    turns = np.abs(_turns(np.concatenate([loop[-1:], loop, loop[:1]])))
    best = int(turns.argmax())
    return best if turns[best] > SHARP else int(loop[:, 1].argmax())


def _turns(points: Floats) -> Floats:
    """Return the turn at all points of a row but the first and the last, in radians, to the left."""
    steps = np.diff(points, axis=0)
    a, b = steps[:-1], steps[1:]
    turns: Floats = np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], (a * b).sum(axis=1))
    return turns


def _sampled(number: int, points: Floats, tolerance: float, ends: tuple[Axis | None, Axis | None]) -> Chain:
    """Return a chain of samples of a dense row of points, true corners among them."""
    keep = np.concatenate([[True], np.hypot(*np.diff(points, axis=0).T) > SAME_MM])
    points = points[keep]
    turns = np.zeros(len(points))
    turns[1:-1] = np.abs(_turns(points))
    if ends[0] is None:
        turns[[0, -1]] = abs(float(_turns(np.concatenate([points[-2:-1], points[:1], points[1:2]]))[0]))
    sharp = _sharp(points, turns, APART * tolerance, closed=ends[0] is None)
    bounds = sorted({0, *np.flatnonzero(sharp).tolist(), len(points) - 1})
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    step = max(min(1.0 + tolerance, 3.0), float(along[-1]) / MOST)
    rows, corners = [], []
    for a, b in pairwise(bounds):
        count = max(2, math.ceil((along[b] - along[a]) / step))
        where = np.linspace(along[a], along[b], count + 1)[:-1]
        rows.append(np.column_stack([np.interp(where, along, points[:, k]) for k in (0, 1)]))
        corners.append(np.arange(count) == 0)
        corners[-1][0] = sharp[a]
    rows.append(points[-1:])
    corners.append(np.array([bool(sharp[-1])]))
    return Chain(number, np.concatenate(rows), np.concatenate(corners), ends)


def _sharp(points: Floats, turns: Floats, apart: float, *, closed: bool) -> Bools:
    """Return which points are corners: the sharpest ones, and none nearer to a sharper one than ``apart`` mm."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    sharp = np.zeros(len(points), dtype=bool)
    taken: list[float] = []
    for k in sorted(np.flatnonzero(turns > SHARP).tolist(), key=lambda k: -turns[k]):
        off = [abs(along[k] - other) for other in taken]
        if closed:
            off = [min(one, along[-1] - one) for one in off]
        if min(off, default=apart) >= apart:
            sharp[k] = True
            taken.append(float(along[k]))
    if closed:
        sharp[[0, -1]] = sharp[0] or sharp[-1]
    return sharp


def loop_corners(chain: Chain, lines: Sequence[Line], reach: float, *, true_corners: bool = False) -> Floats | None:
    """Return the corners of the loop that a chain's fitted lines make, mirrored as its ends say; None without lines.

    ``reach``, ``true_corners``: as for ``Chains.loops``.
    """
    lines = _merged(chain, lines)
    if not lines:
        return None
    corners = []
    for a, b in pairwise(lines):
        corners.append(_corner(chain, a, b, reach, true_corners))
    if chain.is_closed:
        return np.array([_corner(chain, lines[-1], lines[0], reach, true_corners), *corners])
    start, end = chain.ends
    assert start is not None
    assert end is not None
    row = np.array(corners).reshape(-1, 2)
    tips = [_on_axis(lines[0], start), _on_axis(lines[-1], end)]
    if true_corners:
        for k, place in ((0, chain.points[:1]), (1, chain.points[-1:])):
            if len(tips[k]) and float(np.hypot(*(tips[k] - place)[0])) > reach:
                tips[k] = place
    row = np.concatenate([tips[0], row, tips[1]])
    half = np.concatenate([row, _image(row, end)])
    if start is end:
        return half
    sectors = round(math.pi / abs(math.remainder(end.angle - start.angle, math.pi)))
    if sectors == 2:
        return np.concatenate([half, _image(half, start)])
    once = half[: len(half) - len(tips[0])]  # the corner on the first axis comes again at the other end
    turns = 2 * (end.angle - start.angle) * np.arange(sectors)
    return np.concatenate([_turned(once, start.place, turn) for turn in turns.tolist()])


def _corner(chain: Chain, a: Line, b: Line, reach: float, true_corners: bool) -> Floats:
    """Return where two lines that follow each other meet, or a place between them if that is too far from the chain."""
    corner = _meeting(a.normal, a.offset, b.normal, b.offset)
    place: Floats = chain.points[b.start]
    if corner is not None:
        if float(np.hypot(*(corner - place))) <= reach:
            return corner
        if true_corners and chain.corners[b.start]:
            return place
        low, high = min(a.start, b.start - 1), max(b.end, b.start + 1)
        some = chain.points[low : high + 1] if low < high else chain.points
        if float(shapely.distance(shapely.points(corner), shapely.linestrings(some))) <= reach:
            return corner
    feet = [place + (line.offset - float(line.normal @ place)) * line.normal for line in (a, b)]
    between: Floats = (feet[0] + feet[1]) / 2
    return between


def _turned(points: Floats, about: Floats, turn: float) -> Floats:
    """Return points, ``(n, 2)``, turned by so many radians about a place."""
    cosine, sine = math.cos(turn), math.sin(turn)
    turned: Floats = (points - about) @ np.array([(cosine, sine), (-sine, cosine)]) + about
    return turned


def _image(row: Floats, axis: Axis) -> Floats:
    """Return the mirror image of a row that ends at an axis, backwards, without the corners on the axis."""
    off = np.abs(axis.side(row)) > 1e-9
    return axis.mirrored(row[off])[::-1]


def _on_axis(line: Line, axis: Axis) -> Floats:
    """Return where a line meets an axis, ``(1, 2)``, or nothing if it does so at a right angle."""
    if abs(float(line.normal @ axis.normal)) < 1e-6:
        return np.empty((0, 2))
    corner = _meeting(line.normal, line.offset, axis.normal, float(axis.normal @ axis.place))
    return np.empty((0, 2)) if corner is None else corner[None]


def _merged(chain: Chain, lines: Sequence[Line]) -> list[Line]:
    """Return lines of which no two that follow each other are parallel, where those are on one line nearly."""
    kept: list[Line] = []
    for line in lines:
        if kept and abs(_sine(kept[-1].normal, line.normal)) < MEET:
            a = kept[-1]
            longer = a if a.end - a.start >= line.end - line.start else line
            kept[-1] = Line(a.start, line.end, longer.normal, longer.offset)
        else:
            kept.append(line)
    if chain.is_closed and len(kept) > 3 and abs(_sine(kept[-1].normal, kept[0].normal)) < MEET:
        a, b = kept.pop(), kept[0]
        longer = a if a.end - a.start >= b.end - b.start else b
        kept[0] = Line(a.start, b.end, longer.normal, longer.offset)
    return kept


def _sine(a: Floats, b: Floats) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def _meeting(a: Floats, c: float, b: Floats, d: float) -> Floats | None:
    """Return where the lines ``a @ p == c`` and ``b @ p == d`` meet, or None if they hardly do."""
    sine = _sine(a, b)
    if abs(sine) < MEET:
        return None
    return np.array([c * b[1] - d * a[1], a[0] * d - b[0] * c]) / sine
