"""How turns move, and when two of them meet."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from foldcut.core.arrays import Bools, Floats, Numbers, index_array
from foldcut.geometry.vectors import cross

LOST = 1e3
"""Pairs that are nearer than they should be by more ties than this will not become a gusset."""


class Turn(Protocol):
    """What is asked of a turn."""

    number: int
    angle: float
    spike: bool
    leaving: Floats
    row: tuple[float, ...]


class Table:
    """What is known of all turns of a molecule, a row each.

    Position (2), velocity (2), image, slope of the image, height, by how much sides shrink at it, +1 for peaks and -1
    for valleys, level.
    """

    def __init__(self) -> None:
        self.rows = np.empty((64, 10))
        self.count = 0

    def numbers(self, turns: Sequence[Turn]) -> Numbers:
        """The turns' numbers; new ones get theirs."""
        for turn in turns:
            if turn.number < 0:
                if self.count == len(self.rows):
                    self.rows = np.concatenate([self.rows, np.empty_like(self.rows)])
                self.rows[self.count] = turn.row
                turn.number = self.count
                self.count += 1
        return index_array([turn.number for turn in turns])


@dataclass(frozen=True)
class Gusset:
    """When a gusset crease forms, from turn ``first`` on to turn ``last``, and the x where its path turns."""

    time: float
    first: int
    last: int
    at: int
    x: float


class Motion:
    """Some turns as arrays, at one height."""

    def __init__(self, rows: Floats, height: float) -> None:
        columns = rows.T
        self.velocity = columns[2:4].T.copy()
        self.slope, since, self.shrink, self.up, level = columns[5:].copy()
        rise = height - since
        self.position = columns[:2].T + self.velocity * rise[:, None]
        self.x = columns[4] + self.slope * rise
        # a turn that moves outwards is wrapped at the level that it comes to
        outwards = (self.shrink < 0) & (self.up * (level - self.x) > 0)
        self.level = np.where(outwards, level, self.x)
        self.level_slope = np.where(outwards, 0.0, self.slope)

    def positions(self, time: float) -> Floats:
        """Where the turns are after a time, ``(n, 2)`` mm."""
        moved: Floats = self.position + self.velocity * time
        return moved

    def images(self, time: float) -> Floats:
        """Where the turns land after a time, ``(n,)`` mm."""
        images: Floats = self.x + self.slope * time
        return images


def _places(rows: Floats, height: float, time: float) -> Floats:
    """Where turns are some time after a height, ``(n, 2)`` mm: as ``Motion`` has it."""
    velocity = rows[:, 2:4]
    places: Floats = rows[:, :2] + velocity * (height - rows[:, 6:7]) + velocity * time
    return places


class Meetings:
    """When turns ``i`` and ``j`` come as near as their way in the tree, which turns at ``at``: ``(k,)`` each.

    ``time``: infinite if never; ``gap`` mm: the distance less the way; ``a``, ``b``, ``c``: the square of the distance
    less that of the way, as a polynomial of time.
    """

    def __init__(self, motion: Motion, i: Numbers, j: Numbers, at: Numbers, sign: Floats | float, tie: float) -> None:
        self.tie = tie
        self.apart, self.parting = motion.position[j] - motion.position[i], motion.velocity[j] - motion.velocity[i]
        distance = np.hypot(self.apart[:, 0], self.apart[:, 1])
        own = (at == i) | (at == j)
        self.level = np.where(own, motion.x[at], motion.level[at])
        self.level_slope = np.where(own, motion.slope[at], motion.level_slope[at])
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
        time[distance < self.path - LOST * tie] = np.inf  # it was too near from the start: see the search
        self.time = time

    def before(self, before: float) -> list[int]:
        """Which of them are before a time, the first ones first."""
        some = np.flatnonzero((self.time >= 0) & (self.time <= before) & np.isfinite(self.time))
        if math.isfinite(before) and len(some):
            # a tie with a collapse is the collapse's
            then = self.apart[some] + self.parting[some] * before
            some = some[self.path[some] + self.path_slope[some] * before - np.hypot(then[:, 0], then[:, 1]) > self.tie]
        first: list[int] = some[np.argsort(self.time[some], kind="stable")].tolist()
        return first

    def x(self, number: int) -> float:
        """Where the way of one of them turns, at its time."""
        return float(self.level[number] + self.level_slope[number] * self.time[number])


def looks_inside(turn: Turn, toward: Floats) -> bool:
    """Whether a vector from a turn points into the part."""
    angle = math.atan2(float(cross(turn.leaving, toward)), float(turn.leaving @ toward)) % (2 * math.pi)
    return 1e-9 < angle < turn.angle - 1e-9


def crosses(origin: Floats, line: Floats, start: Floats, end: Floats) -> Bools:
    """Which segments start-end meet the segment from ``origin`` along ``line``; those on one line with it do not."""
    side_start, side_end = cross(line, start - origin), cross(line, end - origin)
    along = end - start
    near, far = cross(along, origin - start), cross(along, origin + line - start)
    level = 1e-10 * np.hypot(along[:, 0], along[:, 1]) * math.hypot(*line)
    in_line = (np.abs(side_start) <= level) & (np.abs(side_end) <= level)
    return (side_start * side_end <= 0) & (near * far <= 0) & ~in_line
