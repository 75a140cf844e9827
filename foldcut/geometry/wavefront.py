"""Where the sides of a polygon vanish when it is inset: the nodes of its straight skeleton, seen from the sides.

Loop -> for each side, where along it the perpendiculars from the nodes stand in which it vanishes or is split.

A foot at such a place lets the molecule above the side close without a gusset (see ``universal``): the two corners of
the side come down to the foot just when they meet. Only a guide for the search: nothing depends on its being exact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.geometry.vectors import cross, left_normal

TIE = 1e-9


@dataclass(frozen=True)
class Node:
    """A node above a side: ``along`` the side from its start in mm, ``height`` in mm, ``split`` if the side goes on."""

    side: int
    along: float
    height: float
    split: bool


@dataclass
class _Corner:
    """A corner of the wavefront between two sides."""

    arriving: int
    leaving: int
    position: Floats
    height: float
    velocity: Floats
    reflex: bool
    first: int = -1  # the loop's corner that this one is still
    falling: tuple[int, ...] = ()  # corners of the loop that this one comes from, reflex all the way


def side_nodes(loop: Floats, *, outside: bool = False) -> list[Node]:
    """Return the nodes above the sides of a counter-clockwise loop, ``(n, 2)``, lowest first.

    ``outside``: of the unbounded region around it. Source: Aichholzer and Aurenhammer 1996 (the wavefront).
    """
    return _Wavefront(np.asarray(loop, dtype=np.float64), outside).nodes


def corner_lives(loop: Floats, *, outside: bool = False) -> tuple[Floats, Floats]:
    """Return for each corner of a counter-clockwise loop, ``(n, 2)``, when its wavefront meets another, and its growth.

    The first ``(n,)`` in mm of height, infinite where it meets none; the second ``(n,)``: by how much the sides at it
    have got longer until then, for corners that are reflex in the region, inside or ``outside``; 0 for others.
    """
    front = _Wavefront(np.asarray(loop, dtype=np.float64), outside)
    lives, falls = front.lives, front.falls
    lost = ~np.isfinite(lives)
    if lost.any() and not outside:
        # the front of a region with parallel sides may end early; inside, nothing lives longer than the rest
        lives[lost] = np.max(lives[~lost], initial=0.0) or float(np.ptp(loop, axis=0).max()) / 2
        before = np.roll(front.direction, 1, axis=0)
        turning = np.arctan2(cross(before, front.direction), (before * front.direction).sum(axis=1))
        falls[lost] = np.where(turning < 0, np.tan(np.abs(turning) / 2) * lives, 0.0)[lost]
    return lives, falls


class _Wavefront:
    def __init__(self, loop: Floats, outside: bool) -> None:
        count = len(loop)
        self.start = loop
        along = np.roll(loop, -1, axis=0) - loop
        self.length = np.hypot(*along.T)
        self.direction = along / self.length[:, None]
        self.normal = left_normal(self.direction) * (-1 if outside else 1)
        self.offset = np.sum(self.normal * loop, axis=1)
        self.turn = -1 if outside else 1
        self.tie = TIE * float(np.ptp(loop, axis=0).max())
        self.nodes: list[Node] = []
        self.falls = np.zeros(count)
        self.lives = np.full(count, np.inf)
        # seen with the region on the left: outside the sides follow each other backwards
        sides = list(range(count - 1, -1, -1)) if outside else list(range(count))
        corners = []
        for before, after in zip(sides[-1:] + sides[:-1], sides, strict=True):
            place = loop[before] if outside else loop[after]
            corner = self._corner(before, after, place, 0.0)
            corner.first = before if outside else after
            if corner.reflex:
                corner.falling = (corner.first,)
            corners.append(corner)
        stack = [(corners, 0.0)]
        steps = 0
        while stack and steps < 20 * count + 50:
            steps += 1
            stack += self._step(*stack.pop())
        self.nodes.sort(key=lambda node: node.height)

    def _corner(self, before: int, after: int, position: Floats, height: float) -> _Corner:
        arriving, leaving = self.direction[before] * self.turn, self.direction[after] * self.turn
        across, dot = float(cross(arriving, leaving)), float(arriving @ leaving)
        half = math.tan(math.atan2(across, dot) / 2)
        velocity = left_normal(leaving) + leaving * half
        return _Corner(before, after, position, height, velocity, across < -1e-9)

    def _note(self, side: int, place: Floats, height: float, *, split: bool = False) -> None:
        self.nodes.append(Node(side, float((place - self.start[side]) @ self.direction[side]), height, split))

    def _end(self, corner: _Corner, height: float) -> None:
        if corner.first >= 0:
            self.lives[corner.first] = height
        if corner.reflex:
            across = left_normal(self.direction[corner.leaving]) * self.turn
            shrink = float((corner.velocity - across) @ self.direction[corner.leaving]) * self.turn
            self.falls[list(corner.falling)] += abs(shrink) * (height - corner.height)

    def _step(self, corners: list[_Corner], height: float) -> list[tuple[list[_Corner], float]]:
        count = len(corners)
        if count < 3:
            for corner in corners:
                self._note(corner.leaving, corner.position + corner.velocity * (height - corner.height), height)
                self._end(corner, height)
            return []
        velocity = np.array([c.velocity for c in corners])
        place = (
            np.array([c.position for c in corners])
            + velocity * (height - np.array([c.height for c in corners]))[:, None]
        )
        sides = np.array([c.leaving for c in corners])
        direction = self.direction[sides] * self.turn
        length = np.sum((np.roll(place, -1, axis=0) - place) * direction, axis=1)
        rate = -np.sum((np.roll(velocity, -1, axis=0) - velocity) * direction, axis=1)
        with np.errstate(all="ignore"):
            times = np.where(rate > 1e-12, np.maximum(length, 0) / rate, np.inf)
        k = int(times.argmin())
        best, split = float(times[k]), -1
        # a split is rare: the pairs that may come first are told at once, and looked at one by one
        some = np.array([v for v, corner in enumerate(corners) if corner.reflex], dtype=np.int64)
        closing = 1 - velocity[some] @ self.normal[sides].T
        with np.errstate(all="ignore"):
            until = (place[some] @ self.normal[sides].T - self.offset[sides] - height) / closing
        until[closing <= 1e-12] = np.inf
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
        if not math.isfinite(best):
            return []
        height += best
        now = place + velocity * best
        if split < 0:
            after = (k + 1) % count
            self._note(int(sides[k]), now[k], height)
            new = self._corner(corners[k].arriving, corners[after].leaving, now[k], height)
            self._end(corners[k], height)
            self._end(corners[after], height)
            if new.reflex:
                new.falling = corners[k].falling + corners[after].falling
            rest = [c for n, c in enumerate(corners) if n not in (k, after)]
            place_of_new = k if after else 0
            rest.insert(min(place_of_new, len(rest)), new)
            return [(rest, height)]
        self._note(int(sides[k]), now[split], height, split=True)
        v, s = split, k
        self._end(corners[v], height)
        one = self._corner(corners[v].arriving, corners[s].leaving, now[v], height)
        two = self._corner(corners[s].leaving, corners[v].leaving, now[v], height)
        after_s = [corners[n % count] for n in range(s + 1, (v if v > s else v + count))]
        after_v = [corners[n % count] for n in range(v + 1, (s if s > v else s + count) + 1)]
        return [([one, *after_s], height), ([two, *after_v], height)]
