"""Where on the cut line the boundary of a shape turns to and fro, by linear programming.

Outline, turns, wishes -> ``Walk`` (see ``compact`` and ``universal``).

The unknowns are the images x of all turns. Between two turns x changes by what lies between them on the side of the
shape; so the images say where on their sides the turns are that are no corners. What is needed for the molecules to
close is that turns that see each other, inside or outside, are no nearer to each other than their images along the
tree. For turns i and j that is x_i + x_j - 2 x_m for the lowest turn m between them, on the side away from the root;
in pockets that are turned, 2 x_m - x_i - x_j for the highest. These conditions are linear, and are added where a
solution breaks one. The distance between turns that are no corners is a convex function of the images, so its tangent
at the last solution is on the safe side.

As long as there is no solution, stretches of the boundary are left out: they are the places where turns are missing.

Source: Lang's tree method (*Origami Design Secrets*, chapter 11); trees whose leaves are on a closed walk, in order,
are heights over the root.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, Numbers
from foldcut.geometry.vectors import cross
from foldcut.geometry.wavefront import Node, corner_lives, side_nodes
from foldcut.methods.compact.pattern import Walk

ROUNDS = 120
MOST_ROWS = 400  # of conditions that are added in one round
LATER = (0.2, 0.45, 0.7, 0.93)  # heights at which falling corners are looked at, as parts of the longest life
AMPLITUDE = 0.03  # the least that x changes between two turns, as a part of an even share of their side
SEEN = 1e-9  # radians
MOST_POCKETS = 62


@dataclass(frozen=True, eq=False)
class Outline:
    """The boundary of a shape, ``loop`` ``(n, 2)`` mm counter-clockwise, and what is known of it."""

    loop: Floats

    @cached_property
    def along(self) -> Floats:
        """The sides as vectors, ``(n, 2)``."""
        vectors: Floats = np.roll(self.loop, -1, axis=0) - self.loop
        return vectors

    @cached_property
    def length(self) -> Floats:
        """The lengths of the sides."""
        lengths: Floats = np.hypot(*self.along.T)
        return lengths

    @cached_property
    def direction(self) -> Floats:
        """Unit vectors of the sides."""
        return np.asarray(self.along / self.length[:, None])

    @cached_property
    def turning(self) -> Floats:
        """By how much the boundary turns left at each corner, in radians."""
        before = np.roll(self.direction, 1, axis=0)
        turning: Floats = np.arctan2(cross(before, self.direction), (before * self.direction).sum(axis=1))
        return turning

    @cached_property
    def reflex(self) -> Bools:
        """Which corners are reflex."""
        return np.asarray(self.turning < 0)

    @cached_property
    def size(self) -> float:
        """The larger side of the bounding box in mm."""
        return float(np.ptp(self.loop, axis=0).max())

    @cached_property
    def falls(self) -> Floats:
        """How far each reflex corner's image falls inside, if it is a valley, until its wavefront meets another."""
        return self.inside_lives[1]

    @cached_property
    def rises(self) -> Floats:
        """How far each convex corner's image rises outside, if it is a peak, until its wavefront meets another."""
        return np.minimum(self.outside_lives[1], self.size)

    @cached_property
    def inside_lives(self) -> tuple[Floats, Floats]:
        """When each corner's wavefront inside meets another, and its growth: see ``corner_lives``."""
        return corner_lives(self.loop)

    @cached_property
    def outside_lives(self) -> tuple[Floats, Floats]:
        """When each corner's wavefront outside meets another, and its growth: see ``corner_lives``."""
        return corner_lives(self.loop, outside=True)

    @cached_property
    def nodes(self) -> list[list[Node]]:
        """For each side, the nodes of the straight skeletons inside and outside over it."""
        nodes: list[list[Node]] = [[] for _ in self.loop]
        for node in (*side_nodes(self.loop), *side_nodes(self.loop, outside=True)):
            if 0 < node.along < self.length[node.side]:
                nodes[node.side].append(node)
        return nodes

    def front(self, height: float, outside: bool) -> shapely.Geometry:
        """The region that the wavefront has left free at a height, a little larger."""
        key = (height, outside)
        if key not in self._fronts:
            shape = shapely.Polygon(self.loop)
            slack = 1e-7 * self.size
            if outside:
                box = shapely.box(*shape.buffer(2 * height + self.size).bounds)
                front = box.difference(shape.buffer(height - slack, join_style="mitre", mitre_limit=1e3))
            else:
                front = shape.buffer(slack - height, join_style="mitre", mitre_limit=1e3)
            shapely.prepare(front)
            self._fronts[key] = front
        return self._fronts[key]

    @cached_property
    def _fronts(self) -> dict[tuple[float, bool], shapely.Geometry]:
        return {}

    def places(self, turns: Turns, along: Floats) -> Floats:
        """Where turns are, ``(n, 2)`` mm."""
        places: Floats = self.loop[turns.side] + self.direction[turns.side] * along[:, None]
        return places

    def pockets_at(self, turns: Turns) -> Numbers:
        """The pockets that turns belong to, as bits."""
        pockets = self.pockets[turns.side]
        return np.where(turns.corner, pockets | self.pockets[turns.side - 1], pockets)

    def levels(self, turns: Turns, *, careful: bool) -> Floats:
        """How far turns will go on falling inside, and rising outside, ``(2, n)`` mm; 0 unless ``careful``."""
        if not careful:
            return np.zeros((2, len(turns)))
        inside = np.where(turns.corner & ~turns.peak, -self.falls[turns.side], 0.0)
        outside = np.where(turns.corner & turns.peak, self.rises[turns.side], 0.0)
        return np.stack([inside, outside])

    def width_at(self, point: Floats, side: int) -> float:
        """The distance of a point on a side from the nearest of the other sides that are not beside it."""
        along = np.sum((point - self.loop) * self.direction, axis=1)
        foot = self.loop + self.direction * np.clip(along, 0.0, self.length)[:, None]
        away: Floats = np.hypot(*(foot - point).T)
        count = len(self.loop)
        away[[side, (side - 1) % count, (side + 1) % count]] = np.inf
        return float(away.min(initial=self.size))

    @cached_property
    def pockets(self) -> Numbers:
        """The pocket of the convex hull that each side is beside, as a bit, or 0."""
        count = len(self.loop)
        corners = shapely.get_coordinates(shapely.convex_hull(shapely.multipoints(self.loop)))
        hull = np.flatnonzero((self.loop[:, None] == corners).all(axis=2).any(axis=1))
        pockets = np.zeros(count, dtype=np.int64)
        number = 0
        for a, b in zip(hull.tolist(), [*hull[1:].tolist(), int(hull[0]) + count], strict=True):
            if b - a > 1:
                pockets[np.arange(a, b) % count] = 1 << min(number, MOST_POCKETS - 1)
                number += 1
        return pockets


@dataclass(frozen=True, eq=False)
class Turns:
    """The turns of a walk around an outline, from its root on.

    ``side`` ``(n,)``: the side that a turn lies on or, a corner, begins; ``corner``, ``peak`` ``(n,)``: which are
    corners and which are peaks; ``turned``: the pockets, as bits, folded with the tree over the peaks.
    """

    side: Numbers
    corner: Bools
    peak: Bools
    turned: int = 0

    def __len__(self) -> int:
        return len(self.side)

    @classmethod
    def build(cls, corner_peaks: Bools, root: int, *, at_corner: bool, turned: int = 0) -> Turns:
        """As few turns as corners that are peaks or valleys allow, from a corner or the turn on a side on."""
        side, corner = [], []
        count = len(corner_peaks)
        for s in range(count):
            side.append(s)
            corner.append(True)
            if corner_peaks[s] == corner_peaks[(s + 1) % count]:
                side.append(s)
                corner.append(False)
        sides, corners = np.array(side), np.array(corner)
        peaks = np.where(corners, corner_peaks[sides], ~corner_peaks[sides])
        first = int(np.flatnonzero((sides == root) & (corners == at_corner))[0])
        return cls(np.roll(sides, -first), np.roll(corners, -first), np.roll(peaks, -first), turned)

    def inserted(self, at: int) -> Turns:
        """Return the turns with two more after turn ``at``, on the same side."""
        kind = self.peak[at]
        side = np.insert(self.side, at + 1, [self.side[at]] * 2)
        corner = np.insert(self.corner, at + 1, [False, False])
        return replace(self, side=side, corner=corner, peak=np.insert(self.peak, at + 1, [not kind, kind]))

    def removed(self, at: int) -> Turns:
        """Return the turns without ``at`` and the next, neither of which may be a corner or the root."""
        keep = np.ones(len(self), dtype=bool)
        keep[[at, at + 1]] = False
        return replace(self, side=self.side[keep], corner=self.corner[keep], peak=self.peak[keep])


@dataclass(frozen=True, eq=False)
class Solution:
    """Images of turns: ``x``, where they are ``along`` their sides, and what is left out after them, ``(n,)`` mm."""

    turns: Turns
    x: Floats
    along: Floats
    left_out: Floats
    clearance: float

    def walk(self, outline: Outline, *, careful: bool = True) -> Walk:
        """The walk, when nothing is left out."""
        turns = self.turns
        points, pockets = outline.places(turns, self.along), outline.pockets_at(turns)
        levels = self.x + outline.levels(turns, careful=careful)
        return Walk(points, self.x, turns.peak, outline.direction[turns.side], pockets, levels, turns.turned)


class Program:
    """The linear program of some turns around an outline.

    Inside, a reflex corner that is a valley falls as the molecule grows; in a turned pocket a convex corner that is a
    peak rises. A gusset crease that wraps one must land beyond all that: ``level_inside``, ``level_outside`` ``(n,)``
    say by how much.
    """

    def __init__(self, outline: Outline, turns: Turns, *, careful: bool = True) -> None:
        """``careful``: heed corners that go on falling or rising; else no pattern may come of it, or a simpler one."""
        self.careful = careful
        self.outline, self.turns = outline, turns
        count = self.count = len(turns)
        # stretches after turns, as rows over the unknowns: images, then what is left out
        row = np.arange(count)
        up = np.where(turns.peak, 1.0, -1.0)
        self.stretch = np.zeros((count, 2 * count))
        self.stretch[row, row] = up
        self.stretch[row, (row + 1) % count] = -up
        self.amplitude = self.stretch.copy()
        self.stretch[row, count + row] = 1.0
        # walk along each side from its corner
        self.walked = np.zeros((count, 2 * count))
        first = int(np.flatnonzero(turns.corner)[0])
        for n in range(1, count):
            k = (first + n) % count
            if not turns.corner[k]:
                self.walked[k] = self.walked[k - 1] + self.stretch[k - 1]
        self.ends = np.zeros((len(outline.loop), 2 * count))
        np.add.at(self.ends, turns.side, self.stretch)
        self.per_side = np.bincount(turns.side, minlength=len(outline.loop))
        self.level_inside, self.level_outside = outline.levels(turns, careful=careful)
        self.pockets = outline.pockets_at(turns)

    def evenly(self) -> Floats:
        """The turns evenly along their sides."""
        turns = self.turns
        first = int(np.flatnonzero(turns.corner)[0])
        along = np.zeros(self.count)
        number = 0
        for n in range(self.count):
            k = (first + n) % self.count
            number = 0 if turns.corner[k] else number + 1
            s = turns.side[k]
            along[k] = self.outline.length[s] * number / self.per_side[s]
        return along

    def solve(
        self,
        along: Floats,
        *,
        clearance: float,
        weight: Floats | None = None,
        wish: Floats | None = None,
        most_clearance: float | None = None,
        steps: int = 3,
        whole: bool = False,
    ) -> Solution | None:
        """Return the images for which least is left out of the boundary, or the wishes are met best.

        ``along`` ``(n,)``: where turns are to begin with; ``clearance``: by how much nearer than their distance two
        turns' images must be, relative; ``weight`` ``(n,)`` of what is left out after turns, or of wishes; ``wish``
        ``(n,)``: where along their sides turns should be, NaN for no wish; ``whole``: leave nothing out, else None;
        ``most_clearance``: with wishes, clearance up to this is worth something, too.
        """
        found: Solution | None = None
        for _ in range(steps):
            x = self._minimise(along, clearance, weight, wish, most_clearance, whole)
            if x is None:
                return None
            found = self._solution(x, clearance)
            if self.true_clearance(found) >= clearance - 1e-6:
                return found
            along = found.along
        return None if whole else found

    def _solution(self, x: Floats, clearance: float) -> Solution:
        count = self.count
        both = x[: 2 * count].copy()
        small = both[count:] < 1e-7 * self.outline.size
        both[count:][small] = 0.0
        if small.all():
            # the solver leaves 1e-9 in the equations: project onto them, so that ties stay ties
            rows = self.ends[:, :count]
            missing = rows @ both[:count] - self.outline.length
            fixed = np.zeros(count)
            fixed[0] = 1.0
            rows = np.vstack([rows, fixed])
            both[:count] -= np.linalg.lstsq(rows, np.append(missing, both[0]), rcond=None)[0]
        along = self.walked @ both
        return Solution(self.turns, both[:count], along, both[count:], clearance)

    def true_clearance(self, solution: Solution) -> float:
        """The clearance that turns that see each other really have."""
        pairs = self._pairs(solution.along)
        _, path = self._paths(solution.x, pairs)
        return float(np.min(1 - path / pairs.distance, initial=math.inf))

    def _paths(self, x: Floats, pairs: _Pairs) -> tuple[Numbers, Floats]:
        """For each pair the turn where its path in the tree turns, and the path's length."""
        count = self.count
        steps = np.arange(count)
        low, high = x + self.level_inside, x + self.level_outside
        if pairs.shift is not None:
            low = high = x
        ahead = steps >= steps[:, None]
        way = np.where(ahead, low, np.inf)
        lowest = np.maximum.accumulate(np.where(way <= np.minimum.accumulate(way, axis=1), steps, 0), axis=1)
        highest = lowest
        if pairs.turned.any():
            way = np.where(ahead, high, -np.inf)
            highest = np.maximum.accumulate(np.where(way >= np.maximum.accumulate(way, axis=1), steps, 0), axis=1)
        at = np.where(pairs.turned, highest[pairs.i, pairs.j], lowest[pairs.i, pairs.j])
        # the root is at both ends of the walk; over the peaks the lower way counts
        from_root = pairs.turned & (pairs.i == 0)
        if from_root.any():
            back = np.maximum.accumulate(np.where(high[::-1] >= np.maximum.accumulate(high[::-1]), steps, 0))
            other = count - 1 - back[count - 1 - pairs.j]
            at = np.where(from_root & (high[other] < high[at]), other, at)
        level = np.where(pairs.turned, high[at], low[at])
        path = x[pairs.i] + x[pairs.j] - 2 * level
        path = np.where(pairs.turned, -path, path)
        # a turn that goes on falling is no bound for pairs of its own: those are looked at later
        own = ((at == pairs.i) | (at == pairs.j)) & (np.abs(level - x[at]) > 0)
        return at, np.where(own, -np.inf, path)

    def _pairs(self, along: Floats) -> _Pairs:
        """Pairs i < j of turns that see each other and whose images may be too far apart."""
        turns, outline = self.turns, self.outline
        place = self.outline.places(self.turns, along)
        i, j = np.triu_indices(self.count, 1)
        inside, outside = sees_each_other(outline, place, turns, i, j)
        turned = outside & (self.pockets[i] & self.pockets[j] & turns.turned != 0)
        leaf = turns.peak | turns.corner
        leaf[0] = True
        under = turns.corner | ~turns.peak
        inner = inside & leaf[i] & leaf[j]
        outer = outside & np.where(turned, under[i] & under[j], leaf[i] & leaf[j])
        i, j = np.concatenate([i[inner], i[outer]]), np.concatenate([j[inner], j[outer]])
        turned = np.concatenate([np.zeros(int(inner.sum()), dtype=bool), turned[outer]])
        apart = place[i] - place[j]
        distance = np.hypot(apart[:, 0], apart[:, 1])
        return _Pairs(i, j, turned, distance, apart / np.maximum(distance, 1e-300)[:, None])

    def _later(self, along: Floats) -> list[_Pairs]:
        """Pairs at some later heights, where a crease between them would wrap a corner that goes on falling.

        Inside, reflex corners that are valleys fall, in turned pockets convex corners that are peaks rise; no gusset
        may end in them while they do.
        """
        turns, outline = self.turns, self.outline
        bend = np.where(turns.corner, outline.turning[turns.side], 0.0)
        up = np.where(turns.peak, 1.0, -1.0)
        place = self.outline.places(self.turns, along)
        arriving = outline.direction[np.where(turns.corner, turns.side - 1, turns.side)]
        middle = arriving + outline.direction[turns.side]
        middle /= np.maximum(np.hypot(*middle.T), 1e-9)[:, None]
        sideways = np.stack([-middle[:, 1], middle[:, 0]], axis=-1) / np.cos(bend / 2)[:, None]
        first, second = np.triu_indices(self.count, 2)
        found = []
        for out in (False, True):
            sign = -1.0 if out else 1.0
            shrink = np.tan(sign * bend / 2)
            falling = turns.corner & (turns.peak if out else ~turns.peak) & (shrink < 0)
            if out:
                falling &= self.pockets & turns.turned != 0
            if not falling.any():
                continue
            life = np.where(
                turns.corner, (outline.outside_lives if out else outline.inside_lives)[0][turns.side], np.inf
            )
            longest = min(float(np.max(life[falling])), outline.size / 2)
            leaf = (~turns.peak if out else turns.peak) | turns.corner
            leaf[0] = True
            some = leaf[first] & leaf[second]
            if out:
                some &= self.pockets[first] & self.pockets[second] & turns.turned != 0
            for part in LATER:
                time = part * longest
                then = place + sign * sideways * time
                i, j = first[some], second[some]
                seen = shapely.covers(
                    outline.front(time, out), shapely.linestrings(np.stack([then[i], then[j]], axis=1))
                )
                i, j = i[seen], j[seen]
                apart = then[i] - then[j]
                distance = np.hypot(apart[:, 0], apart[:, 1])
                unit = apart / np.maximum(distance, 1e-300)[:, None]
                still = falling & (life >= time)
                found.append(_Pairs(i, j, np.full(len(i), out), distance, unit, -up * shrink * time, still))
        return found

    def _minimise(
        self,
        along: Floats,
        clearance: float,
        weight: Floats | None,
        wish: Floats | None,
        most_clearance: float | None,
        whole: bool,
    ) -> Floats | None:
        """Minimise with all conditions, distances by their tangents where turns are ``along`` their sides."""
        count, outline, turns = self.count, self.outline, self.turns
        wishes = np.flatnonzero(~np.isnan(wish)) if wish is not None else np.zeros(0, dtype=np.int64)
        width = 2 * count + 1 + len(wishes)
        cost = np.zeros(width)
        low, up = np.zeros(width), np.full(width, np.inf)
        up[0] = 0.0
        low[2 * count], up[2 * count] = clearance, max(clearance, most_clearance or 0.0)
        if whole:
            up[count : 2 * count] = 0.0
        cost[count : 2 * count] = 1.0 if weight is None or wish is not None else weight
        if wish is not None:
            cost[2 * count + 1 :] = 1.0 if weight is None else weight[wishes]
            cost[2 * count] = -outline.size
        solver = Solver(cost, low, up)

        def wide(rows: Floats) -> Floats:
            return np.pad(rows, ((0, 0), (0, width - rows.shape[1])))

        solver.add(wide(self.ends), outline.length, outline.length)
        least = AMPLITUDE * (outline.length / self.per_side)[turns.side]
        solver.add(wide(self.amplitude), least, np.full(count, np.inf))
        solver.add(*self._falling(width))
        if len(wishes):
            assert wish is not None
            rows = wide(self.walked[wishes])
            deviation = np.zeros_like(rows)
            deviation[np.arange(len(wishes)), 2 * count + 1 + np.arange(len(wishes))] = 1.0
            solver.add(rows - deviation, np.full(len(wishes), -np.inf), wish[wishes])
            solver.add(rows + deviation, wish[wishes], np.full(len(wishes), np.inf))
        pairs = self._pairs(along)
        later = self._later(along) if self.careful else []
        for _ in range(ROUNDS):
            x = solver.run()
            if x is None:
                return None
            broken = [self._rows(x, along, some, width) for some in (pairs, *later)]
            if not any(len(bound) for _, bound in broken):
                return x
            for row, bound in broken:
                solver.add(row, np.full(len(bound), -np.inf), bound)
        return None

    def _rows(
        self, x: Floats, along: Floats, pairs: _Pairs, width: int, *, everything: bool = False
    ) -> tuple[Floats, Floats]:
        """The conditions that a solution breaks, as rows and bounds, distances by their tangents at ``along``."""
        count, direction = self.count, self.outline.direction[self.turns.side]
        clearance = x[2 * count]
        if pairs.shift is not None:
            clearance = 0.0
            at, path = self._paths(x[:count] + pairs.shift, pairs)
        else:
            at, path = self._paths(x[:count], pairs)
        now = self.walked @ x[: 2 * count] - along
        toward_i = (pairs.direction * direction[pairs.i]).sum(axis=1)
        toward_j = (pairs.direction * direction[pairs.j]).sum(axis=1)
        moved = toward_i * now[pairs.i] - toward_j * now[pairs.j]
        excess = path - pairs.distance * (1 - clearance) - moved
        if pairs.still is not None:
            own = (at == pairs.i) | (at == pairs.j)
            excess = np.where(pairs.still[at] & own, excess, -np.inf)
        broken = np.flatnonzero(np.isfinite(excess) if everything else excess > 1e-9 * self.outline.size)
        if len(broken) > MOST_ROWS and not everything:
            broken = broken[np.argsort(-excess[broken], kind="stable")[:MOST_ROWS]]
        i, j, at = pairs.i[broken], pairs.j[broken], at[broken]
        sign = np.where(pairs.turned[broken], -1.0, 1.0)
        rows = np.zeros((len(broken), width))
        n = np.arange(len(broken))
        np.add.at(rows, (n, i), sign)
        np.add.at(rows, (n, j), sign)
        np.add.at(rows, (n, at), -2 * sign)
        slope_i, slope_j = toward_i[broken], toward_j[broken]
        rows[:, : 2 * count] -= slope_i[:, None] * self.walked[i] - slope_j[:, None] * self.walked[j]
        bound = pairs.distance[broken] - slope_i * along[i] + slope_j * along[j]
        if pairs.shift is None:
            rows[:, 2 * count] = pairs.distance[broken]
            bound += 2 * sign * np.where(pairs.turned[broken], self.level_outside[at], self.level_inside[at])
        else:
            bound -= sign * (pairs.shift[i] + pairs.shift[j] - 2 * pairs.shift[at])
        return rows, bound

    def conditions(self, solution: Solution, clearance: float) -> tuple[Floats, Floats]:
        """All conditions as rows, ``(m, 2 n)``, over changes of a solution, and the bounds that these keep to.

        To first order; a condition that the solution itself breaks may not be broken more.
        """
        along = solution.along
        x = np.concatenate([solution.x, solution.left_out, [clearance]])
        pairs = self._pairs(along)
        all_rows, all_bounds = [], []
        for some in [pairs, *(self._later(along) if self.careful else [])]:
            rows, bounds = self._rows(x, along, some, len(x), everything=True)
            all_rows.append(rows[:, :-1])
            all_bounds.append(np.maximum(bounds - rows @ x, 0.0))
        falling, least, _ = self._falling(2 * self.count)
        all_rows += [-falling, -self.amplitude]
        short = AMPLITUDE * (self.outline.length / self.per_side)[self.turns.side]
        all_bounds += [np.maximum(falling @ x[:-1] - least, 0.0), np.maximum(self.amplitude @ x[:-1] - short, 0.0)]
        return np.vstack(all_rows), np.concatenate(all_bounds)

    def _falling(self, width: int) -> tuple[Floats, Floats, Floats]:
        """Reflex corners that are valleys fall inside: none may fall below the root, unless that falls, too."""
        turns = self.turns
        falling = turns.corner & ~turns.peak & self.outline.reflex[turns.side]
        some = np.flatnonzero(falling[1:]) + 1
        rows = np.zeros((len(some), width))
        rows[np.arange(len(some)), some] = 1.0
        rows[:, 0] = -1.0
        least = np.zeros(len(some)) if falling[0] else self.outline.falls[turns.side[some]]
        return rows, least, np.full(len(some), np.inf)


@dataclass(frozen=True, eq=False)
class _Pairs:
    """Pairs of turns, over the peaks or under the valleys, their distance and the direction from the second."""

    i: Numbers
    j: Numbers
    turned: Bools
    distance: Floats
    direction: Floats
    shift: Floats | None = None
    still: Bools | None = None


class Solver:
    """HiGHS with rows added as they are needed; each run goes on from the last."""

    def __init__(self, cost: Floats, low: Floats, up: Floats) -> None:
        import highspy  # here: patterns that need no search do without

        self.optimal: Any = highspy.HighsModelStatus.kOptimal
        self.highs: Any = highspy.Highs()  # type: ignore[no-untyped-call]
        self.highs.setOptionValue("output_flag", False)
        self.highs.setOptionValue("threads", 1)
        none = np.zeros(0, dtype=np.int32)
        self.highs.addCols(len(cost), cost, low, up, 0, none, none, np.zeros(0))

    def add(self, rows: Floats, low: Floats, up: Floats) -> None:
        """Add dense rows."""
        if not len(rows):
            return
        at, columns = np.nonzero(rows)
        starts = np.searchsorted(at, np.arange(len(rows))).astype(np.int32)
        self.highs.addRows(len(rows), low, up, len(at), starts, columns.astype(np.int32), rows[at, columns])

    def run(self) -> Floats | None:
        """Solve, or return None when nothing satisfies all rows."""
        self.highs.run()
        if self.highs.getModelStatus() != self.optimal:
            return None
        return np.asarray(self.highs.getSolution().col_value)


def sees_each_other(outline: Outline, place: Floats, turns: Turns, i: Numbers, j: Numbers) -> tuple[Bools, Bools]:
    """Whether the segments between turns i and j lie inside the outline, and whether outside, ``(m,)`` each."""
    count = len(outline.loop)
    side = turns.side
    before = np.where(turns.corner, (side - 1) % count, side)
    leaving = outline.direction[side]
    opening = np.where(turns.corner, math.pi - outline.turning[side], math.pi)

    def looks(a: Numbers, line: Floats) -> tuple[Bools, Bools]:
        angle = np.arctan2(cross(leaving[a], line), (leaving[a] * line).sum(axis=1)) % (2 * math.pi)
        return (angle > SEEN) & (angle < opening[a] - SEEN), (angle > opening[a] + SEEN) & (angle < math.tau - SEEN)

    line = place[j] - place[i]
    (in_i, out_i), (in_j, out_j) = looks(i, line), looks(j, -line)
    inside, outside = in_i & in_j, out_i & out_j
    candidates = np.flatnonzero(inside | outside)
    start, along = outline.loop, outline.along
    row = np.arange(count)
    for n in range(0, len(candidates), 4096):
        some = candidates[n : n + 4096]
        a, b = i[some], j[some]
        ray = line[some][:, None]
        scale = 1e-10 * np.hypot(*line[some].T)[:, None] * outline.length
        from_start = cross(ray, start[None] - place[a][:, None])
        from_end = from_start + cross(ray, along[None])
        near = cross(along[None], place[a][:, None] - start[None])
        far = near + cross(along[None], ray)
        meets = (from_start * from_end <= scale**2) & (near * far <= scale**2)
        meets &= (np.abs(from_start) > scale) | (np.abs(from_end) > scale)  # one on a line with the ray does not
        own = (row == side[a][:, None]) | (row == side[b][:, None]) | (row == before[a][:, None])
        own |= row == before[b][:, None]
        blocked = (meets & ~own).any(axis=1)
        inside[some] &= ~blocked
        outside[some] &= ~blocked
    return inside, outside
