"""How turns move as a part of a molecule is inset, and when two of them come as near as they may.

Turns -> ``TurnTable`` -> ``Motion`` at one height -> ``Meetings``.

A *turn* is a corner of a part's border where the border, folded onto the cut line, changes direction; its *image* is
the coordinate x on the cut line where it lands. Insetting the part moves each turn along the bisector of its two sides
at a constant velocity. Time and height are one: after a time t all turns are t mm higher above the cut line.

Two turns i and j may never be nearer to each other on the sheet than along the tree that their images are heights in.
That *path* goes down from i to the lowest turn m between them, its *bend*, and up to j: x_i + x_j - 2 x_m. In a turned
pocket the tree hangs from its crests: the bend is the highest turn between them, and the path 2 x_m - x_i - x_j.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Floats, Numbers, index_array
from foldcut.geometry.vectors import cross

SPIKE = 1e-9
"""A turn whose inside angle is less than this, in radians, is a spike: its two sides run back on each other."""

LOST = 1e3
"""Two turns that are nearer than their path by more than this many ties never make a gusset."""

SEEN = 1e-9
"""A line of sight leaves a turn's sides by at least this angle, in radians."""


class TurnRow(NamedTuple):
    """What is known of one turn for good, in mm; rates are per mm of height."""

    position_x: float
    position_y: float
    """Where it was on the sheet when it was made."""
    velocity_x: float
    velocity_y: float
    """How fast it moves."""
    x: float
    """Its image when it was made."""
    slope: float
    """How fast its image changes."""
    height: float
    """The height at which it was made."""
    shrink: float
    """How fast the sides on either side of it shrink at this end; negative at a reflex corner."""
    up: float
    """+1 for a crest, -1 for a dip."""
    level: float
    """Where a gusset crease that wraps it lands while its image moves outwards: as far out as that will ever be."""

    def image_at(self, height: float) -> float:
        """Where the turn lands at a height."""
        return self.x + self.slope * (height - self.height)


ROW = np.dtype([("position", float, 2), ("velocity", float, 2), *((name, float) for name in TurnRow._fields[4:])])
"""A ``TurnRow`` as numpy has it: the same ten numbers, in the same order."""

Rows = NDArray[np.void]
"""Turns as an array of ``ROW``."""


@dataclass(eq=False)
class Turn:
    """A turn of a part's border: where it was when it was made, how it moves, and the facets on either side of it."""

    position: Floats
    height: float
    x: float
    crest: bool
    arriving: Floats
    """The direction of the side before it."""
    leaving: Floats
    """The direction of the side after it."""
    before: int
    """The facet between it and the turn before."""
    after: int
    """The facet between it and the turn after."""
    vertex: int
    pockets: int
    """The pockets that it belongs to, as bits."""
    level: float
    number: int = -1
    """Its row in the molecule's ``TurnTable``; -1 if it has none yet."""

    def __post_init__(self) -> None:
        (a, b), (c, d) = self.arriving.tolist(), self.leaving.tolist()
        left = math.atan2(a * d - b * c, a * c + b * d)
        self.angle = math.pi - left
        self.spike = self.angle < SPIKE
        self.shrink = 0.0 if self.spike else math.tan(left / 2)

    def row(self) -> TurnRow:
        """What is known of it for good."""
        (x, y), (c, d) = self.position.tolist(), self.leaving.tolist()
        shrink, up = self.shrink, 1.0 if self.crest else -1.0
        velocity_x, velocity_y = c * shrink - d, d * shrink + c
        return TurnRow(x, y, velocity_x, velocity_y, self.x, -up * shrink, self.height, shrink, up, self.level)


class TurnTable:
    """All turns of a molecule, ``count``, by number."""

    def __init__(self) -> None:
        self.count = 0
        self._numbers = np.empty((64, len(TurnRow._fields)))

    @property
    def room(self) -> int:
        """For how many turns there is room; their numbers are less."""
        return len(self._numbers)

    def numbers(self, turns: Sequence[Turn]) -> Numbers:
        """Return the turns' numbers; turns that have none get the next ones."""
        for turn in turns:
            if turn.number < 0:
                if self.count == self.room:
                    self._numbers = np.concatenate([self._numbers, np.empty_like(self._numbers)])
                self._numbers[self.count] = turn.row()
                turn.number = self.count
                self.count += 1
        return index_array([turn.number for turn in turns])

    def row(self, number: int) -> TurnRow:
        """Return what is known of one turn."""
        return TurnRow._make(self._numbers[number].tolist())

    def rows(self, numbers: Numbers | list[int]) -> Rows:
        """Return what is known of some turns, ``(k,)``."""
        return self._numbers.take(numbers, axis=0).view(ROW)[:, 0]


@dataclass(frozen=True)
class Gusset:
    """When a gusset crease forms from turn ``first`` to turn ``last``: its path turns at ``bend``, and lands on ``x``.

    Turns are counted along the part's border; where ``last`` is less, the crease wraps the turns around the border's
    end.
    """

    time: float
    first: int
    last: int
    bend: int
    x: float


class Motion:
    """Some turns at one height: positions ``(n, 2)``, images ``x`` ``(n,)``, how fast they change, and the like."""

    def __init__(self, rows: Rows, height: float) -> None:
        self.velocity: Floats = rows["velocity"]
        self.slope: Floats = rows["slope"]
        self.shrink: Floats = rows["shrink"]
        self.up: Floats = rows["up"]
        rise = height - rows["height"]
        self.position: Floats = rows["position"] + self.velocity * rise[:, None]
        self.x: Floats = rows["x"] + self.slope * rise
        outwards = (self.shrink < 0) & (self.up * (rows["level"] - self.x) > 0)
        self.level = np.where(outwards, rows["level"], self.x)
        self.level_slope = np.where(outwards, 0.0, self.slope)

    def positions(self, time: float) -> Floats:
        """Where the turns are after a time, ``(n, 2)`` mm."""
        moved: Floats = self.position + self.velocity * time
        return moved

    def images(self, time: float) -> Floats:
        """Where the turns land after a time, ``(n,)`` mm."""
        images: Floats = self.x + self.slope * time
        return images


def positions_after(rows: Rows, height: float, time: float) -> Floats:
    """Where turns are some time after a height, ``(n, 2)`` mm, number for number as ``Motion`` has it."""
    velocity = rows["velocity"]
    places: Floats = rows["position"] + velocity * (height - rows["height"][:, None]) + velocity * time
    return places


class Meetings:
    """When turns ``i`` and ``j`` come as near to each other as their path, which turns at ``bend``: ``(k,)`` each.

    ``sign``: +1, or -1 for pairs in turned pockets. ``time``: infinite for pairs that never meet. ``gap`` mm: the
    distance less the path. ``a``, ``b``, ``c``: the square of the distance less that of the path is a t^2 + b t + c.
    """

    def __init__(self, motion: Motion, i: Numbers, j: Numbers, bend: Numbers, sign: Floats | float, tie: float) -> None:
        self.tie = tie
        self.apart, self.parting = motion.position[j] - motion.position[i], motion.velocity[j] - motion.velocity[i]
        distance = np.hypot(self.apart[:, 0], self.apart[:, 1])
        own = (bend == i) | (bend == j)
        self.level = np.where(own, motion.x[bend], motion.level[bend])
        self.level_slope = np.where(own, motion.slope[bend], motion.level_slope[bend])
        self.path = sign * (motion.x[i] + motion.x[j] - 2 * self.level)
        self.path_slope = sign * (motion.slope[i] + motion.slope[j] - 2 * self.level_slope)
        (apart_x, apart_y), (parting_x, parting_y) = self.apart.T, self.parting.T
        self.a = parting_x * parting_x + parting_y * parting_y - self.path_slope * self.path_slope
        self.b = 2 * (apart_x * parting_x + apart_y * parting_y - self.path * self.path_slope)
        self.c = (distance - self.path) * (distance + self.path)
        with np.errstate(all="ignore"):
            q = -self.b + np.sqrt(self.b * self.b - 4 * self.a * self.c)
            time = np.where(q > 0, 2 * self.c / q, np.inf)
        self.gap = distance - self.path
        time = np.where(self.gap <= tie, np.where(self.b < 0, 0.0, np.inf), time)
        # nearer than their path already at the start: no event will change that
        time[distance < self.path - LOST * tie] = np.inf
        self.time = time

    def before(self, before: float) -> list[int]:
        """Return which of them are before a time, in order of time."""
        some = np.flatnonzero((self.time >= 0) & (self.time <= before) & np.isfinite(self.time))
        if math.isfinite(before) and len(some):
            # where a meeting and a collapse tie, it is a collapse
            then = self.apart[some] + self.parting[some] * before
            some = some[self.path[some] + self.path_slope[some] * before - np.hypot(then[:, 0], then[:, 1]) > self.tie]
        first: list[int] = some[np.argsort(self.time[some], kind="stable")].tolist()
        return first

    def x(self, number: int) -> float:
        """Where the bend of one of them lands, when the two turns meet."""
        return float(self.level[number] + self.level_slope[number] * self.time[number])


def looks_inside(turn: Turn, toward: Floats) -> bool:
    """Whether a vector from a turn points into the part."""
    angle = math.atan2(float(cross(turn.leaving, toward)), float(turn.leaving @ toward)) % (2 * math.pi)
    return SEEN < angle < turn.angle - SEEN


def crosses(origin: Floats, line: Floats, start: Floats, end: Floats) -> Bools:
    """Which segments start-end meet the segment from ``origin`` along ``line``, ``(k,)``.

    Segments on one line with it do not count.
    """
    side_start, side_end = cross(line, start - origin), cross(line, end - origin)
    along = end - start
    near, far = cross(along, origin - start), cross(along, origin + line - start)
    level = 1e-10 * np.hypot(along[:, 0], along[:, 1]) * math.hypot(*line)
    in_line = (np.abs(side_start) <= level) & (np.abs(side_end) <= level)
    return (side_start * side_end <= 0) & (near * far <= 0) & ~in_line
