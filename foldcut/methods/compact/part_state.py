"""A part of a molecule on its way up: its turns, and what happens to it next."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Floats, Numbers
from foldcut.methods.compact.event_queue import Queue
from foldcut.methods.compact.motion import Gusset, Meetings, Motion, Table, crosses, looks_inside

# Sides that differ by less than this angle in radians run back on each other.
SPIKE = 1e-9


# Parts of more turns than this look for gussets among pairs that are near each other only.
FEW = 100


# Parts of no more turns look for them one by one.
VERY_FEW = 12


@dataclass(eq=False)
class _Turn:
    """A turn of a part's border: where it was when it was made, how it moves, and the facets on either side of it."""

    position: Floats
    height: float
    x: float
    peak: bool
    arriving: Floats  # direction of the side before it
    leaving: Floats  # direction of the side after it
    before: int  # facet
    after: int
    vertex: int
    pockets: int  # bits
    level: float
    number: int = -1  # in the molecule's table

    def __post_init__(self) -> None:
        (a, b), (c, d) = self.arriving.tolist(), self.leaving.tolist()
        turn = math.atan2(a * d - b * c, a * c + b * d)
        self.angle = math.pi - turn
        self.spike = self.angle < SPIKE
        shrink = 0.0 if self.spike else math.tan(turn / 2)  # of a side, at this end, per unit of height
        up = 1.0 if self.peak else -1.0
        velocity = c * shrink - d, d * shrink + c
        self.row = (*self.position.tolist(), *velocity, self.x, -up * shrink, self.height, shrink, up, self.level)


@dataclass
class _Part:
    """A polygon on its way up: its turns counter-clockwise from the one where the list of its layers is cut.

    ``near``: what is known of its pairs of turns, if it has many; ``queue``: its events to come, if they are queued;
    ``patience``: for how many steps they are not.
    """

    turns: list[_Turn]
    height: float
    unbounded: bool
    near: _Near | None = None
    number: int = -1
    queue: Queue | None = None
    patience: int = 0


@dataclass(frozen=True, eq=False)
class _Near:
    """Pairs of turns that may come too near before a height, and since when they may: those and no others.

    ``first``, ``last`` ``(k,)`` numbers of turns, ``height`` ``(k,)`` ascending, from ``start`` on; the ``active``
    pairs ``(2, m)`` are past that. Turns from ``count`` on are newer than that. Pairs of turns that have met, or are in
    different parts, stay in the lists.

    Two turns whose disks, of radius x less the least x of all, do not overlap are not too near, whatever the tree.
    """

    first: Numbers
    last: Numbers
    height: Floats
    start: int
    active: Numbers
    until: float
    count: int


class _State(Motion):
    """A part's turns as arrays, at its own height."""

    def __init__(self, part: _Part, turned: int, table: Table) -> None:
        self.part, self.table = part, table
        turns = part.turns
        self.numbers = table.numbers(turns)
        super().__init__(table.rows[self.numbers], part.height)
        self.peak = self.up > 0
        self.after = np.arange(1, len(turns) + 1)
        self.after[-1] = 0
        self.turned = np.zeros(len(turns), dtype=np.int64)
        if turned:
            self.turned = np.array([t.pockets for t in turns]) & turned

    def lengths(self, time: float) -> Floats:
        """The lengths of the stretches of border after the turns."""
        x = self.images(time)
        lengths: Floats = self.up * (x - x[self.after])
        return lengths

    def next_collapse(self, tie: float) -> float:
        """When the next stretches of border vanish."""
        length = self.lengths(0.0)
        rate = self.shrink + self.shrink[self.after]
        with np.errstate(all="ignore"):
            time = np.where(rate > 0, np.maximum(length, 0.0) / rate, np.inf)
        return float(np.where(length <= tie, 0.0, time).min())

    def next_crossing(self, tie: float) -> float:
        """When the next of two valleys, or of two peaks, passes the other's image: paths in the tree change."""
        if not (self.level_slope[~self.peak].any() or self.turned.any()):
            return math.inf
        best = math.inf
        for kind in (self.peak, ~self.peak) if self.turned.any() else (~self.peak,):
            # many valleys are of one hub
            x, slope = np.unique(np.stack([self.level[kind], self.level_slope[kind]]), axis=1)
            apart, closing = x[:, None] - x, slope - slope[:, None]
            with np.errstate(all="ignore"):
                time = np.where((apart > tie) & (closing > 0), apart / closing, np.inf)
            best = min(best, float(time.min(initial=np.inf)))
        return best

    def coincident(self, tie: float) -> tuple[int, int] | None:
        """Two turns, not neighbours, that are in the same place now, both on the sheet and when folded."""
        count = len(self.x)
        if count <= VERY_FEW:
            peak = self.peak.tolist()
            places = list(zip(*self.position.T.tolist(), self.x.tolist(), strict=True))
            for i in range(count - 2):
                x, y, image = places[i]
                for j in range(i + 2, count if i else count - 1):
                    other_x, other_y, other_image = places[j]
                    if (
                        abs(x - other_x) <= tie
                        and abs(y - other_y) <= tie
                        and abs(image - other_image) <= tie
                        and peak[i] == peak[j]
                    ):
                        return i, j
            return None
        # only turns that some line's direction does not tell apart are worth a closer look
        along = self.position @ (0.8, 0.6)
        order = np.argsort(along)
        equal = np.diff(along[order]) <= 2 * tie
        some = np.unique(np.concatenate([order[:-1][equal], order[1:][equal]]))
        x, y = self.position[some].T
        near = np.abs(x[:, None] - x) <= tie
        near &= np.abs(y[:, None] - y) <= tie
        near &= np.abs(self.x[some][:, None] - self.x[some]) <= tie
        for i, j in some[np.argwhere(np.triu(near, 1))].tolist():
            if j > i + 1 and (i or j < len(self.x) - 1) and self.peak[i] == self.peak[j]:
                return i, j
        return None

    def _pairs(self, tie: float, until: float) -> tuple[Numbers, Numbers, Numbers]:
        """Pairs of turns that may come too near before a time, and the turn between them where the tree's path turns.

        A pair goes from the first on to the last and around what lies between. Pairs with the turn 0, where the list
        of the layers is cut, go both ways.
        """
        count = len(self.x)
        bent = np.abs(self.shrink) > 1e-12
        over, under = ~self.peak | bent, self.peak | bent
        # the root is a leaf, too, when it alone is the lowest
        under[0] |= bool((self.x[1:] > self.x[0] + tie).all())
        if not self.turned.any():
            if count > FEW:
                return self._near_pairs(under, until)
            if count <= VERY_FEW:
                return self._few_pairs(under)
        place = np.arange(count + 1) % count
        x, step = self.level[place], np.arange(count + 1)
        ahead = step >= step[:-1, None]
        way = np.where(ahead, x, np.inf)
        at = np.maximum.accumulate(np.where(way <= np.minimum.accumulate(way, axis=1), step, 0), axis=1)
        keep = under[:, None] & under[place]
        if self.turned.any():
            turned = (self.turned[:, None] & self.turned[place]) != 0
            way = np.where(ahead, x, -np.inf)
            highest = np.maximum.accumulate(np.where(way >= np.maximum.accumulate(way, axis=1), step, 0), axis=1)
            at = np.where(turned, highest, at)
            keep = np.where(turned, over[:, None] & over[place], keep)
        keep &= step >= step[:-1, None] + 2
        keep[0, count - 1 :] = False
        i, j = np.nonzero(keep)
        return i, place[j], place[at[i, j]]

    def _few_pairs(self, under: Bools) -> tuple[Numbers, Numbers, Numbers]:
        """The same where there are so few turns that arrays are not worth it, and no pocket is turned."""
        count = len(self.x)
        level, leaf = self.level.tolist(), under.tolist()
        first, last, lowest = [], [], []
        for i in range(count):
            if not leaf[i]:
                continue
            at, least = i, level[i]
            for step in range(i + 1, count + 1 if i else count - 1):
                j = step % count
                if level[j] <= least:
                    at, least = j, level[j]
                if step >= i + 2 and leaf[j]:
                    first.append(i)
                    last.append(j)
                    lowest.append(at)
        return np.array(first, dtype=np.intp), np.array(last, dtype=np.intp), np.array(lowest, dtype=np.intp)

    def _near_pairs(self, under: Bools, until: float) -> tuple[Numbers, Numbers, Numbers]:
        """The same where there are many turns, and no pocket is turned: of all pairs only those that are near."""
        count = len(self.x)
        near = self._known(until)
        end = near.start + int(np.searchsorted(near.height[near.start :], self.part.height + until, side="right"))
        place = np.full(self.table.count, -1)
        place[self.numbers] = np.arange(count)
        active = np.concatenate([near.active, [near.first[near.start : end], near.last[near.start : end]]], axis=1)
        here = place[active]
        alive = (here >= 0).all(axis=0)
        self.part.near = replace(near, start=end, active=active[:, alive])
        i, j = np.sort(here[:, alive], axis=0)
        keep = under[i] & under[j]
        i, j = i[keep], j[keep]
        around = (i == 0) & (j <= count - 2)
        straight = (j >= i + 2) & ~((i == 0) & (j == count - 1))
        i, j = np.concatenate([i[straight], j[around]]), np.concatenate([j[straight], np.full(around.sum(), count)])
        order = np.lexsort([j, i])
        i, j = i[order], j[order]
        return i, j % count, _lowest(np.append(self.level, self.level[0]), i, j) % count

    def _known(self, until: float) -> _Near:
        """The pairs that may come too near before a time, as far as that is known; looked for where it is not."""
        near, height = self.part.near, self.part.height
        if near is None or height + until > near.until:
            ahead = self._ahead(until)
            boxes = self._boxes(ahead)
            pairs = shapely.STRtree(boxes).query(boxes)
            pairs = pairs[:, pairs[0] < pairs[1]]
            first, last, since = self._since(pairs, ahead)
            empty = np.empty((2, 0), dtype=np.int64)
            return _Near(first, last, since, 0, empty, height + ahead, self.table.count)
        new = np.flatnonzero(self.numbers >= near.count)
        if not len(new):
            return near
        pairs = np.stack([np.repeat(new, len(self.x)), np.tile(np.arange(len(self.x)), len(new))])
        pairs = pairs[:, (pairs[0] < pairs[1]) | (self.numbers[pairs[1]] < near.count)]
        first, last, since = self._since(pairs, near.until - height)
        at = near.start + np.searchsorted(near.height[near.start :], since, side="right")
        return _Near(
            np.insert(near.first, at, first),
            np.insert(near.last, at, last),
            np.insert(near.height, at, since),
            near.start,
            near.active,
            near.until,
            self.table.count,
        )

    def _ahead(self, until: float) -> float:
        """How far ahead it is best to look for pairs, at least to a time: about as far as most disks are large."""
        radius, speed = self._reach()
        ahead = max(until, 2 * float(np.median(radius[self.peak]) / np.median(speed)))
        return ahead if math.isfinite(ahead) else float(np.ptp(self.position, axis=0).sum())

    def _reach(self) -> tuple[Floats, Floats]:
        """The radii of the turns' disks, and by how much they and their centres may grow and move per unit of time."""
        lowest = min(float(self.x.min()), float(self.level.min()))
        speed = np.hypot(*self.velocity.T) + np.abs(self.slope)
        return self.x - lowest, speed + float(np.abs(self.slope[~self.peak]).max(initial=0.0))

    def _boxes(self, ahead: float) -> NDArray[np.object_]:
        """What each turn's disk may reach until then, as polygons."""
        radius, speed = self._reach()
        reach = radius + speed * ahead
        x, y = self.position.T
        boxes: NDArray[np.object_] = shapely.box(x - reach, y - reach, x + reach, y + reach)
        return boxes

    def _since(self, pairs: Numbers, ahead: float) -> tuple[Numbers, Numbers, Floats]:
        """The numbers of pairs that may come too near by then, and the heights from which on they may, ascending."""
        radius, speed = self._reach()
        i, j = pairs
        apart = np.hypot(*(self.position[j] - self.position[i]).T)
        since = (apart - radius[i] - radius[j]) / (speed[i] + speed[j])
        some = np.flatnonzero(since <= ahead)
        some = some[np.argsort(since[some], kind="stable")]
        # a little sooner: what is equal but for rounding may not be missed
        heights = self.part.height + since[some] * (1 - 1e-9) - 1e-9 * radius.max()
        return self.numbers[i[some]], self.numbers[j[some]], heights

    def next_gusset(self, before: float, tie: float) -> Gusset | None:
        """The first pair that comes too near before the given time."""
        if len(self.x) < 4 or (self.part.unbounded and (self.shrink <= 0).all()):
            return None  # around a convex polygon no two turns see each other
        i, j, at = self._pairs(tie, before)
        sign = np.where((self.turned[i] & self.turned[j]) != 0, -1.0, 1.0)
        meetings = Meetings(self, i, j, at, sign, tie)
        for n in meetings.before(before):
            time = float(meetings.time[n])
            if self.sees(time, int(i[n]), int(j[n])):
                return Gusset(time, int(i[n]), int(j[n]), int(at[n]), meetings.x(n))
        return None

    def sees(self, time: float, i: int, j: int) -> bool:
        """Whether the segment between two turns lies inside the part."""
        turns, place = self.part.turns, self.positions(time)
        line = place[j] - place[i]
        if not line.any():
            return False
        if not (looks_inside(turns[i], line) and looks_inside(turns[j], -line)):
            return False
        others = np.ones(len(turns), dtype=bool)
        others[[i, i - 1, j, j - 1]] = False
        start, end = place[others], place[self.after[others]]
        return not bool(crosses(place[i], line, start, end).any())


def _lowest(level: Floats, i: Numbers, j: Numbers) -> Numbers:
    """Where the least of ``level[i]`` to ``level[j]`` is, the last of equal ones."""
    step = np.arange(len(level))
    tables = [step]
    while 2 ** len(tables) <= len(level):
        before = tables[-1]
        half = 2 ** (len(tables) - 1)
        one, other = before[:-half], before[half:]
        tables.append(np.where(level[other] <= level[one], other, one))
    size = np.frexp(j - i + 1)[1] - 1
    lowest = np.empty_like(i)
    for power in np.unique(size).tolist():
        some = size == power
        one, other = tables[power][i[some]], tables[power][j[some] + 1 - 2**power]
        lowest[some] = np.where(level[other] <= level[one], other, one)
    return lowest
