"""The wavefront of a polygon that is inset, or outset: where its sides vanish, and how long its corners live.

Loop -> the nodes of its straight skeleton, as seen from the sides; or the lives of its corners.

The perpendicular from a node meets its side at a foot. At such a foot the molecule above the side closes without a
gusset (see ``methods.compact.molecule``): the two corners of the side come down to the foot at the same time. This only
guides a search; nothing depends on its being exact.
Source: Aichholzer and Aurenhammer, "Straight Skeletons for General Polygonal Figures", 1996 (the wavefront).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.geometry.vectors import cross, left_normal

TIE = 1e-9
"""Events less far apart than this, relative to the loop's size, happen at the same height."""

PARALLEL = 1e-12
"""Speeds below this are 0: sides that close in on each other so slowly never meet."""

REFLEX = 1e-9
"""A corner is reflex if it turns back by more than this, as the sine of its angle."""

MOST_STEPS = 20
"""How many events a wavefront may have for each corner: it has fewer, unless rounding sends it around in circles."""


@dataclass(frozen=True)
class Node:
    """A node above a side: ``along`` mm from the side's start, ``height`` mm; ``split`` if the side goes on there."""

    side: int
    along: float
    height: float
    split: bool


@dataclass
class _Corner:
    """A corner of the wavefront between two sides: ``position`` at ``height``, moving by ``velocity`` mm a mm."""

    arriving: int
    leaving: int
    position: Floats
    height: float
    velocity: Floats
    reflex: bool
    first: int = -1  # the corner of the loop that this one still is, -1 if none
    falling: tuple[int, ...] = ()  # the corners of the loop that this one comes from, if all on the way were reflex


@dataclass(frozen=True)
class _Event:
    """What happens next to a wavefront: after ``wait`` mm side k vanishes, or corner ``split`` hits it (else -1)."""

    wait: float
    k: int
    split: int


def side_nodes(loop: Floats, *, outside: bool = False) -> list[Node]:
    """Return the nodes above the sides of a counter-clockwise loop, ``(n, 2)`` mm, lowest first.

    ``outside``: those of the unbounded region around the loop.
    """
    return _Wavefront(np.asarray(loop, dtype=np.float64), outside).run().nodes


def corner_lives(loop: Floats, *, outside: bool = False) -> tuple[Floats, Floats]:
    """Return how long each corner of a counter-clockwise loop, ``(n, 2)`` mm, lives, and by how much its sides grow.

    The first, ``(n,)``, is the height in mm at which the corner meets another part of the wavefront, infinite if never.
    The second, ``(n,)`` mm, is by how much the sides at it have got longer until then, for corners that are reflex in
    the region, inside or ``outside``; 0 for others.
    """
    front = _Wavefront(np.asarray(loop, dtype=np.float64), outside).run()
    lives, falls = front.lives, front.falls
    lost = ~np.isfinite(lives)
    if lost.any() and not outside:
        # the wavefront of a region with parallel sides may end early; inside, no corner outlives all others
        lives[lost] = np.max(lives[~lost], initial=0.0) or float(np.ptp(loop, axis=0).max()) / 2
        before = np.roll(front.direction, 1, axis=0)
        turning = np.arctan2(cross(before, front.direction), (before * front.direction).sum(axis=1))
        falls[lost] = np.where(turning < 0, np.tan(np.abs(turning) / 2) * lives, 0.0)[lost]
    return lives, falls


class _Wavefront:
    """The wavefront of a loop, into its inside or its outside: ``run`` fills in ``nodes``, ``lives`` and ``falls``."""

    def __init__(self, loop: Floats, outside: bool) -> None:
        count = len(loop)
        self.start = loop
        along = np.roll(loop, -1, axis=0) - loop
        self.direction = along / np.hypot(*along.T)[:, None]
        self.normal = left_normal(self.direction) * (-1 if outside else 1)
        self.offset = np.sum(self.normal * loop, axis=1)
        self.turn = -1 if outside else 1
        self.tie = TIE * float(np.ptp(loop, axis=0).max())
        self.nodes: list[Node] = []
        self.falls = np.zeros(count)
        self.lives = np.full(count, np.inf)

    def run(self) -> _Wavefront:
        """Move the wavefront until it has vanished, or until nothing more happens to it."""
        count = len(self.start)
        stack = [(self._corners(), 0.0)]
        steps = 0
        while stack and steps < MOST_STEPS * count + 50:
            steps += 1
            stack += self._step(*stack.pop())
        self.nodes.sort(key=lambda node: node.height)
        return self

    def _corners(self) -> list[_Corner]:
        """Return the loop's corners, with the region on the left: outside, the sides follow each other backwards."""
        count, outside = len(self.start), self.turn < 0
        sides = list(range(count - 1, -1, -1)) if outside else list(range(count))
        corners = []
        for before, after in zip(sides[-1:] + sides[:-1], sides, strict=True):
            first = before if outside else after
            corner = self._corner(before, after, self.start[first], 0.0)
            corner.first = first
            if corner.reflex:
                corner.falling = (first,)
            corners.append(corner)
        return corners

    def _corner(self, before: int, after: int, position: Floats, height: float) -> _Corner:
        arriving, leaving = self.direction[before] * self.turn, self.direction[after] * self.turn
        across, dot = float(cross(arriving, leaving)), float(arriving @ leaving)
        half = math.tan(math.atan2(across, dot) / 2)
        velocity = left_normal(leaving) + leaving * half
        return _Corner(before, after, position, height, velocity, across < -REFLEX)

    def _note(self, side: int, place: Floats, height: float, *, split: bool = False) -> None:
        self.nodes.append(Node(side, float((place - self.start[side]) @ self.direction[side]), height, split))

    def _end(self, corner: _Corner, height: float) -> None:
        """Note that a corner's life ends, and by how much its sides have grown."""
        if corner.first >= 0:
            self.lives[corner.first] = height
        if corner.reflex:
            across = left_normal(self.direction[corner.leaving]) * self.turn
            shrink = float((corner.velocity - across) @ self.direction[corner.leaving]) * self.turn
            self.falls[list(corner.falling)] += abs(shrink) * (height - corner.height)

    def _step(self, corners: list[_Corner], height: float) -> list[tuple[list[_Corner], float]]:
        """Move one closed wavefront on to its next event; return what it becomes, none, one or two, and the height."""
        if len(corners) < 3:
            for corner in corners:
                self._note(corner.leaving, corner.position + corner.velocity * (height - corner.height), height)
                self._end(corner, height)
            return []
        velocity = np.array([c.velocity for c in corners])
        place = (
            np.array([c.position for c in corners])
            + velocity * (height - np.array([c.height for c in corners]))[:, None]
        )
        event = self._next_event(corners, height, place, velocity)
        if not math.isfinite(event.wait):
            return []
        height += event.wait
        now = place + velocity * event.wait
        if event.split < 0:
            return [(self._without_side(corners, event.k, now[event.k], height), height)]
        return [(part, height) for part in self._split(corners, event.split, event.k, now[event.split], height)]

    def _next_event(self, corners: list[_Corner], height: float, place: Floats, velocity: Floats) -> _Event:
        count = len(corners)
        sides = np.array([c.leaving for c in corners])
        direction = self.direction[sides] * self.turn
        length = np.sum((np.roll(place, -1, axis=0) - place) * direction, axis=1)
        rate = -np.sum((np.roll(velocity, -1, axis=0) - velocity) * direction, axis=1)
        with np.errstate(all="ignore"):
            times = np.where(rate > PARALLEL, np.maximum(length, 0) / rate, np.inf)
        k = int(times.argmin())
        best, split = float(times[k]), -1
        # splits are rare: pairs of a corner and a side that may come first are found at once, and checked one by one
        some = np.array([v for v, corner in enumerate(corners) if corner.reflex], dtype=np.int64)
        closing = 1 - velocity[some] @ self.normal[sides].T
        with np.errstate(all="ignore"):
            until = (place[some] @ self.normal[sides].T - self.offset[sides] - height) / closing
        until[closing <= PARALLEL] = np.inf
        near = np.argwhere((until >= -self.tie) & (until < best - self.tie))
        for row, s in near.tolist():
            v, time = int(some[row]), float(until[row, s])
            if s in (v, (v - 1) % count) or time >= best - self.tie:
                continue
            hit = place[v] + velocity[v] * time
            left = (hit - place[s] - velocity[s] * time) @ direction[s]
            end = (s + 1) % count
            right = (place[end] + velocity[end] * time - hit) @ direction[s]
            if min(left, right) > self.tie:
                best, k, split = max(0.0, time), s, v
        return _Event(best, k, split)

    def _without_side(self, corners: list[_Corner], k: int, place: Floats, height: float) -> list[_Corner]:
        """Return the wavefront after the side behind corner ``k`` has vanished: the two corners there become one."""
        after = (k + 1) % len(corners)
        self._note(corners[k].leaving, place, height)
        new = self._corner(corners[k].arriving, corners[after].leaving, place, height)
        self._end(corners[k], height)
        self._end(corners[after], height)
        if new.reflex:
            new.falling = corners[k].falling + corners[after].falling
        rest = [c for n, c in enumerate(corners) if n not in (k, after)]
        place_of_new = k if after else 0
        rest.insert(min(place_of_new, len(rest)), new)
        return rest

    def _split(
        self, corners: list[_Corner], v: int, s: int, place: Floats, height: float
    ) -> tuple[list[_Corner], list[_Corner]]:
        """Return the two wavefronts after corner ``v`` has hit the side behind corner ``s``."""
        count = len(corners)
        self._note(corners[s].leaving, place, height, split=True)
        self._end(corners[v], height)
        one = self._corner(corners[v].arriving, corners[s].leaving, place, height)
        two = self._corner(corners[s].leaving, corners[v].leaving, place, height)
        after_s = [corners[n % count] for n in range(s + 1, (v if v > s else v + count))]
        after_v = [corners[n % count] for n in range(v + 1, (s if s > v else s + count) + 1)]
        return [one, *after_s], [two, *after_v]
