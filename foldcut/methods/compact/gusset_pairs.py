"""Which pairs of turns may make the next gusset of a part, and where the path between them bends.

A part's turns at one height -> ``Pairs``.

A pair goes from turn i on to turn j and around what lies between; pairs with turn 0, where the list of the layers is
cut, go both ways. There are three ways to find them, for few, some and many turns. They give the same gussets.

A gusset joins two leaves of the tree or two turns where the border bends: elsewhere the border is straight, and what is
on either side of it comes no nearer.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Floats, Numbers
from foldcut.methods.compact.motion import Motion


class Pairs(NamedTuple):
    """Pairs of turns and the bends of their paths, by place on the border, ``(k,)`` each."""

    i: Numbers
    j: Numbers
    bend: Numbers


def few_pairs(level: Floats, ends: Bools) -> Pairs:
    """Return the pairs of turns that are ``ends``, ``(n,)``, one by one: for so few turns arrays are slower.

    ``level`` ``(n,)``: where a gusset crease that wraps a turn lands; the bend is where it is lowest.
    """
    count = len(level)
    levels, is_end = level.tolist(), ends.tolist()
    first, last, bends = [], [], []
    for i in range(count):
        if not is_end[i]:
            continue
        bend, least = i, levels[i]
        for step in range(i + 1, count + 1 if i else count - 1):
            j = step % count
            if levels[j] <= least:
                bend, least = j, levels[j]
            if step >= i + 2 and is_end[j]:
                first.append(i)
                last.append(j)
                bends.append(bend)
    return Pairs(np.array(first, dtype=np.intp), np.array(last, dtype=np.intp), np.array(bends, dtype=np.intp))


def all_pairs(level: Floats, ends: Bools, turned: Numbers, turned_ends: Bools) -> Pairs:
    """Return the same by arrays, with turned pockets.

    ``turned`` ``(n,)``: the turned pockets of each turn, as bits. Two turns of one such pocket are a pair if they are
    ``turned_ends``, and their path bends where ``level`` is highest.
    """
    count = len(level)
    place = np.arange(count + 1) % count
    x, step = level[place], np.arange(count + 1)
    ahead = step >= step[:-1, None]
    way = np.where(ahead, x, np.inf)
    bend = np.maximum.accumulate(np.where(way <= np.minimum.accumulate(way, axis=1), step, 0), axis=1)
    keep = ends[:, None] & ends[place]
    if turned.any():
        both = (turned[:, None] & turned[place]) != 0
        way = np.where(ahead, x, -np.inf)
        highest = np.maximum.accumulate(np.where(way >= np.maximum.accumulate(way, axis=1), step, 0), axis=1)
        bend = np.where(both, highest, bend)
        keep = np.where(both, turned_ends[:, None] & turned_ends[place], keep)
    keep &= step >= step[:-1, None] + 2
    keep[0, count - 1 :] = False
    i, j = np.nonzero(keep)
    return Pairs(i, place[j], place[bend[i, j]])


@dataclass(frozen=True, eq=False)
class NearPairs:
    """Pairs of turns that may come too near to each other below a height, ``until``: those and no others.

    ``first``, ``last`` ``(k,)``: numbers of turns. ``height`` ``(k,)``, ascending: from where on they may. The pairs
    before ``start`` have come to that; ``active``, ``(2, m)``, are those of them whose turns are still there. Turns
    from number ``count`` on are newer than all this. Other pairs stay in the lists even if their turns have met.

    The disk of a turn has as its radius its image less the least image of all. Two turns whose disks do not overlap are
    not too near to each other, whatever the tree.
    """

    first: Numbers
    last: Numbers
    height: Floats
    start: int
    active: Numbers
    until: float
    count: int

    @classmethod
    def find(cls, motion: Motion, numbers: Numbers, height: float, time: float, count: int) -> NearPairs:
        """Find the pairs that turns may make from a height on for at least a time; ``numbers`` ``(n,)`` are theirs."""
        reach = _Reach(motion)
        ahead = reach.worth_looking_ahead(time)
        boxes = reach.boxes(ahead)
        pairs = shapely.STRtree(boxes).query(boxes)
        first, last, since = reach.since(pairs[:, pairs[0] < pairs[1]], ahead, numbers, height)
        return cls(first, last, since, 0, np.empty((2, 0), dtype=np.int64), height + ahead, count)

    def with_new(self, motion: Motion, numbers: Numbers, height: float, count: int) -> NearPairs:
        """Return these and the pairs of turns that were not there before."""
        new = np.flatnonzero(numbers >= self.count)
        if not len(new):
            return self
        pairs = np.stack([np.repeat(new, len(numbers)), np.tile(np.arange(len(numbers)), len(new))])
        pairs = pairs[:, (pairs[0] < pairs[1]) | (numbers[pairs[1]] < self.count)]
        first, last, since = _Reach(motion).since(pairs, self.until - height, numbers, height)
        at = self.start + np.searchsorted(self.height[self.start :], since, side="right")
        return replace(
            self,
            first=np.insert(self.first, at, first),
            last=np.insert(self.last, at, last),
            height=np.insert(self.height, at, since),
            count=count,
        )

    def up_to(self, height: float, place: Numbers) -> tuple[NearPairs, Numbers]:
        """Make those pairs active that are due by a height; return all that are active, ``(2, m)``, by place.

        ``place``: of each turn by number, -1 for those that are not in the part.
        """
        end = self.start + int(np.searchsorted(self.height[self.start :], height, side="right"))
        due = [self.first[self.start : end], self.last[self.start : end]]
        active = np.concatenate([self.active, due], axis=1)
        here = place[active]
        alive = (here >= 0).all(axis=0)
        return replace(self, start=end, active=active[:, alive]), here[:, alive]


def near_pairs(level: Floats, ends: Bools, near: Numbers) -> Pairs:
    """Return the pairs among some, ``near`` ``(2, m)`` by place, as ``few_pairs`` does among all."""
    count = len(level)
    i, j = np.sort(near, axis=0)
    keep = ends[i] & ends[j]
    i, j = i[keep], j[keep]
    around = (i == 0) & (j <= count - 2)
    straight = (j >= i + 2) & ~((i == 0) & (j == count - 1))
    i, j = np.concatenate([i[straight], j[around]]), np.concatenate([j[straight], np.full(around.sum(), count)])
    order = np.lexsort([j, i])
    i, j = i[order], j[order]
    return Pairs(i, j % count, last_lowest(np.append(level, level[0]), i, j) % count)


def last_lowest(level: Floats, i: Numbers, j: Numbers) -> Numbers:
    """Where the least of ``level[i]`` to ``level[j]`` is, ``(k,)``: the last place if some are equal.

    By a sparse table: the least of each stretch whose length is a power of two is found from two of half that length.
    """
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


class _Reach:
    """The radii of turns' disks, and by how much these and their centres may grow and move per mm of height."""

    def __init__(self, motion: Motion) -> None:
        self.motion = motion
        self.crest = motion.up > 0
        lowest = min(float(motion.x.min()), float(motion.level.min()))
        speed = np.hypot(*motion.velocity.T) + np.abs(motion.slope)
        self.radius = motion.x - lowest
        self.speed = speed + float(np.abs(motion.slope[~self.crest]).max(initial=0.0))

    def worth_looking_ahead(self, time: float) -> float:
        """How far ahead it is best to look for pairs, at least a time: about as long as most disks last."""
        ahead = max(time, 2 * float(np.median(self.radius[self.crest]) / np.median(self.speed)))
        return ahead if np.isfinite(ahead) else float(np.ptp(self.motion.position, axis=0).sum())

    def boxes(self, ahead: float) -> NDArray[np.object_]:
        """What each turn's disk may cover within a time, as polygons."""
        reach = self.radius + self.speed * ahead
        x, y = self.motion.position.T
        boxes: NDArray[np.object_] = shapely.box(x - reach, y - reach, x + reach, y + reach)
        return boxes

    def since(self, pairs: Numbers, ahead: float, numbers: Numbers, height: float) -> tuple[Numbers, Numbers, Floats]:
        """The numbers of pairs that may come too near within a time, and since which height, ascending."""
        i, j = pairs
        apart = np.hypot(*(self.motion.position[j] - self.motion.position[i]).T)
        since = (apart - self.radius[i] - self.radius[j]) / (self.speed[i] + self.speed[j])
        some = np.flatnonzero(since <= ahead)
        some = some[np.argsort(since[some], kind="stable")]
        # a little sooner: what is equal but for rounding may not be missed
        heights = height + since[some] * (1 - 1e-9) - 1e-9 * self.radius.max()
        return numbers[i[some]], numbers[j[some]], heights
