r"""The k-cornered molecule: how a polygon with feet on its sides folds into flaps with its border on one line.

Corners with reaches and sides with feet -> ``Molecule`` (the gusset molecule for any number of corners; Lang calls it
the universal molecule, in *Origami Design Secrets*, for convex polygons. Here corners may be reflex, the polygon may be
the unbounded outside of a chain, and the tree below it may be any).

Folded, the polygon's border lies on the cut line and goes to and fro: a corner lands on x = its *reach*, a local
maximum (a *peak*), a foot on x = its *depth*, a local minimum between two corners. As the polygon is inset to the
height h the corners move along their bisectors and their reaches shrink by h cot(alpha / 2); feet stay where they are.
Corners i and j that see each other must stay as far apart as their images along the tree, l_ij = reach_i + reach_j -
2 depth, where depth is the lowest foot between them (on the side away from the root). What happens on the way up:

- *merge*: a side shrinks to a point, its two corners become one;
- *gusset*: two corners that are not neighbours come as near as l_ij: the polygon splits along a crease between them;
- *turn*: a peak whose two feet are the lowest of all reaches their depth, and becomes a valley.

A polygon of two corners is done: what is left of it is the ridge between them. Events at the same height need no
special care: they follow each other at once, merges first, and share their vertices.

Rabbit ear and gusset are the cases k = 3 and k = 4 with all depths 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from foldcut.errors import UnfoldableError
from foldcut.model import Bools, Floats
from foldcut.plane import cross, left_normal

# Distances that differ by less than this part of the shape's size are equal.
TIE = 1e-9
NO_FOOT = math.inf
# Sides that differ by less than this angle in radians run back on each other.
SPIKE = 1e-9


@dataclass
class Vertices:
    """The growing list of vertices: where they are on the sheet, and where they land."""

    flat: list[tuple[float, float]] = field(default_factory=list)
    folded: list[tuple[float, float]] = field(default_factory=list)

    def add(self, flat: Floats, folded: tuple[float, float]) -> int:
        """Add a vertex and return its number."""
        self.flat.append((float(flat[0]), float(flat[1])))
        self.folded.append(folded)
        return len(self.flat) - 1

    def at(self, flat: Floats, folded: tuple[float, float], tie: float, first: int) -> int:
        """Return the vertex at a place, looking back as far as vertex ``first``, or add it."""
        x, y = float(flat[0]), float(flat[1])
        for number in range(len(self.flat) - 1, first - 1, -1):
            there = self.flat[number]
            if abs(there[0] - x) <= tie and abs(there[1] - y) <= tie:
                return number
        return self.add(flat, folded)


@dataclass(eq=False)
class _Corner:
    """A corner of a part: where it was when it was made, how it moves, and the facets on either side of it."""

    position: Floats
    height: float
    reach: float
    arriving: Floats  # direction of the side before it
    leaving: Floats  # direction of the side after it
    before: int  # facet
    after: int
    vertex: int
    valley: bool = False

    def __post_init__(self) -> None:
        turn = math.atan2(float(cross(self.arriving, self.leaving)), float(self.arriving @ self.leaving))
        self.angle = math.pi - turn
        self.spike = self.angle < SPIKE
        self.shrink = 0.0 if self.spike else math.tan(turn / 2)  # of a side, at this end, per unit of height
        self.velocity = left_normal(self.leaving) + self.leaving * self.shrink

    @property
    def slope(self) -> float:
        """Change of the reach per unit of height."""
        return self.shrink if self.valley else -self.shrink


@dataclass
class _Facet:
    """Two chains of vertices going up from the ends of a stretch of a side; closed when they meet."""

    start: list[int]
    end: list[int]

    def ring(self) -> list[int]:
        """The outline, counter-clockwise, without slits; empty if nothing is left of the facet."""
        ring: list[int] = []
        for vertex in (self.start[0], *self.end, *reversed(self.start[1:])):
            if len(ring) > 1 and ring[-2] == vertex:
                ring.pop()
            elif not ring or ring[-1] != vertex:
                ring.append(vertex)
        while len(ring) > 2 and (ring[0] == ring[-1] or ring[1] == ring[-1] or ring[0] == ring[-2]):
            ring = ring[1:] if ring[1] == ring[-1] else ring[:-1]
        return ring if len(ring) > 2 else []


@dataclass
class _Part:
    """A polygon on its way up: corners counter-clockwise, the depth of the foot on the side after each (or none)."""

    corners: list[_Corner]
    depth: list[float]
    height: float
    unbounded: bool


class Molecule:
    """The facets of a molecule and their order from top to bottom, going around from the first corner.

    ``corners``, ``feet``: vertex numbers at the border, the foot on the side after each corner, -1 where a side goes
    straight from a valley to a peak; ``directions`` the ``(k, 2)`` unit vectors of the sides; ``reach`` and ``depth``
    ``(k,)`` mm, the depth infinite where there is no foot; the root is the foot on the last side, or corner 0 where
    there is none. ``sign`` is +1 when heights count upwards; ``limit`` is where an unbounded molecule ends, None for a
    bounded one; ``size`` is what ties are relative to. ``side_facets``: the one or two facets of every side at the
    border. ``lowest_event``: the height in mm up to which nothing happens, the room for a ribbon.
    """

    def __init__(
        self,
        vertices: Vertices,
        corners: list[int],
        feet: list[int],
        directions: Floats,
        reach: Floats,
        depth: Floats,
        *,
        sign: int,
        limit: float | None,
        size: float,
    ) -> None:
        self.vertices = vertices
        self.sign = sign
        self.limit = math.inf if limit is None else limit
        self.tie = TIE * size
        self.facets: list[_Facet] = []
        self.gussets = 0
        self.lowest_event = math.inf
        self.first_vertex = len(vertices.flat)
        self.side_facets: list[list[int]] = []
        count = len(corners)
        for k, corner in enumerate(corners):
            following = corners[(k + 1) % count]
            if feet[k] < 0:
                self.side_facets.append([self._facet([corner], [following])])
            else:
                self.side_facets.append([self._facet([corner], [feet[k]]), self._facet([feet[k]], [following])])
        if feet[-1] < 0:
            self.order = [facet for side in self.side_facets for facet in side]
        else:
            around = [self.side_facets[-1][1], *(facet for side in self.side_facets for facet in side)]
            self.order = around[:-1]
        first = []
        for k, corner in enumerate(corners):
            position = np.array(vertices.flat[corner])
            before, after = self.side_facets[k - 1][-1], self.side_facets[k][0]
            valley = feet[k] < 0 and reach[(k + 1) % count] > reach[k]
            first.append(
                _Corner(position, 0.0, float(reach[k]), directions[k - 1], directions[k], before, after, corner, valley)
            )
        stack = [_Part(first, [float(d) for d in depth], 0.0, limit is not None)]
        steps = 0
        while stack:
            part = stack.pop()
            stack += self._step(part)
            steps += 1
            if steps > 50 * len(corners) + 100:
                raise self._lost(part, "no end of events")

    def rings(self) -> list[list[int]]:
        """The outlines of the facets, by facet number."""
        return [facet.ring() for facet in self.facets]

    def _facet(self, start: list[int], end: list[int]) -> int:
        self.facets.append(_Facet(start, end))
        return len(self.facets) - 1

    def _lost(self, part: _Part, why: str) -> UnfoldableError:
        x, y = part.corners[0].position
        return UnfoldableError(f"the molecule of {len(part.corners)} corners near ({x:.3f}, {y:.3f}) mm: {why}")

    # --- one event

    def _step(self, part: _Part) -> list[_Part]:
        """Move a part up to its next event and return what becomes of it."""
        if len(part.corners) == 2:
            self._close(part)
            return []
        state = _State(part)
        for k, corner in enumerate(part.corners):
            if corner.spike:
                return [self._zip(part, state, k)]
        merge, merge_time = state.next_merge(self.tie)
        turn, turn_time = state.next_turn(self.tie)
        first = min(merge_time, turn_time)
        if first > 0 and (pair := state.coincident(self.tie)):
            return self._pinch(part, state, *pair)
        gusset = state.next_gusset(first, self.tie)
        event = part.height + min(first, gusset[0] if gusset else math.inf)
        self.lowest_event = min(self.lowest_event, event)
        if gusset is not None and part.height + gusset[0] <= self.limit:
            return self._split(part, state, *gusset)
        if part.height + first > self.limit:
            self._end(part, state)
            return []
        if not math.isfinite(first):
            raise self._lost(part, "no event")
        if merge_time <= turn_time:
            return [self._merge(part, state, merge, merge_time)]
        return [self._turn(part, state, turn, turn_time)]

    def _vertex_at(self, position: Floats, x: float, height: float) -> int:
        """The vertex of this molecule at a place, or a new one; events at one place share it."""
        return self.vertices.at(position, (x, self.sign * height), self.tie, self.first_vertex)

    def _push(self, corner: _Corner, vertex: int) -> None:
        """Let a corner's trajectory go on to ``vertex``."""
        for chain in (self.facets[corner.before].end, self.facets[corner.after].start):
            if chain[-1] != vertex:
                chain.append(vertex)
        corner.vertex = vertex

    def _merge(self, part: _Part, state: _State, k: int, time: float) -> _Part:
        corners = part.corners
        after = (k + 1) % len(corners)
        one, other = corners[k], corners[after]
        position, reach = state.positions(time), state.reaches(time)
        height = part.height + time
        place, x = (position[k] + position[after]) / 2, float(reach[k] + reach[after]) / 2
        vertex = self._vertex_at(place, x, height)
        self._push(one, vertex)
        self._push(other, vertex)
        rest = corners[k + 2 :] + corners[:k] if after else corners[1:k]
        depth = part.depth[k + 1 :] + part.depth[:k] if after else part.depth[:k]
        merged = _Corner(place, height, x, one.arriving, other.leaving, one.before, other.after, vertex)
        # a valley if the walk goes up from here; the way there tells where the side after is without length
        nearest = [(depth[0], state.reaches(time)[(k + 2) % len(corners)]), (depth[-1], state.reaches(time)[k - 1])]
        merged.valley = any(d == NO_FOOT and r > x + self.tie for d, r in nearest)
        return _Part([merged, *rest], depth, height, part.unbounded)

    def _zip(self, part: _Part, state: _State, k: int) -> _Part:
        r"""The two sides at a spike lie on each other: join them along a ridge as far as the shorter one goes.

        ::

              a --------w---- c        the ridge from c to a, with w where the feet of both sides end
              b ------------ /
        """
        corners, count = part.corners, len(part.corners)
        place, reach = state.positions(0.0), state.reaches(0.0)
        spike = corners[k]
        lengths = [math.dist(place[k - 1], place[k]), math.dist(place[k], place[(k + 1) % count])]
        forward = lengths[0] <= lengths[1]  # then the side before the spike is used up
        near, far = (k - 1) % count if forward else (k + 1) % count, (k + 1) % count if forward else (k - 1) % count
        used, left = ((k - 1) % count, k) if forward else (k, (k - 1) % count)  # sides
        self._push(corners[near], self._vertex_at(place[near], float(reach[near]), part.height))
        end = corners[near].vertex
        depth = part.depth.copy()

        def facets(side: int) -> tuple[_Facet, _Facet]:
            return self.facets[corners[side].after], self.facets[corners[(side + 1) % count].before]

        level = float(reach[near]) if depth[used] == NO_FOOT else depth[used]
        direction = (place[near] - place[k]) / max(min(lengths), 1e-300)
        foot = end
        if depth[used] != NO_FOOT:
            foot = self._vertex_at(place[k] + direction * (float(reach[k]) - level), level, part.height)
        rest = spike.after if forward else spike.before
        if depth[left] != NO_FOOT and abs(depth[left] - level) <= self.tie:
            rest = corners[far].before if forward else corners[far].after
        for side in (used, left):
            if depth[side] != NO_FOOT and abs(depth[side] - level) <= self.tie:
                before, after = facets(side)
                before.end.append(foot)
                after.start.append(foot)
                depth[side] = NO_FOOT
        chain = self.facets[rest].start if forward else self.facets[rest].end
        if chain[-1] != end:
            chain.append(end)
        old = corners[near]
        if forward:
            new = _Corner(
                place[near], part.height, float(reach[near]), old.arriving, spike.leaving, old.before, rest, end
            )
        else:
            new = _Corner(
                place[near], part.height, float(reach[near]), spike.arriving, old.leaving, rest, old.after, end
            )
        new.valley = old.valley
        kept = [c for n, c in enumerate(corners) if n != k]
        kept[kept.index(old)] = new
        depth = [depth[left if forward and n == near else n] for n in range(count) if n != k]
        return _Part(kept, depth, part.height, part.unbounded)

    def _turn(self, part: _Part, state: _State, k: int, time: float) -> _Part:
        corners = part.corners
        corner, height = corners[k], part.height + time
        before, after = corners[k - 1], corners[(k + 1) % len(corners)]
        place, x = state.positions(time)[k], part.depth[k]
        vertex = self._vertex_at(place, x, height)
        self._push(corner, vertex)
        self.facets[before.after].end.append(vertex)
        self.facets[after.before].start.append(vertex)
        turned = _Corner(
            place, height, x, corner.arriving, corner.leaving, before.after, after.before, vertex, valley=True
        )
        depth = part.depth.copy()
        depth[k - 1] = depth[k] = NO_FOOT
        return _Part([*corners[:k], turned, *corners[k + 1 :]], depth, height, part.unbounded)

    def _split(self, part: _Part, state: _State, time: float, i: int, j: int, depth: float) -> list[_Part]:
        """Split a part along the crease between corners i < j."""
        corners, height = part.corners, part.height + time
        one, other = corners[i], corners[j]
        position, reach = state.positions(time), state.reaches(time)
        self.gussets += 1
        for k in (i, j):
            self._push(corners[k], self._vertex_at(position[k], float(reach[k]), height))
        along = (position[j] - position[i]) / math.dist(position[i], position[j])
        from_i, from_j = float(reach[i]) - depth, float(reach[j]) - depth
        if min(from_i, from_j) > self.tie:
            foot = self._vertex_at(position[i] + along * from_i, depth, height)
            near_i = [self._facet([foot], [one.vertex]), self._facet([one.vertex], [foot])]  # in A, in B
            near_j = [self._facet([other.vertex], [foot]), self._facet([foot], [other.vertex])]
            side = depth
        elif one.valley or other.valley:
            in_a = self._facet([other.vertex], [one.vertex])
            in_b = self._facet([one.vertex], [other.vertex])
            near_i = near_j = [in_a, in_b]
            side = NO_FOOT
        else:
            raise self._lost(part, "a flap has no length left")
        if not one.valley:
            self._insert(one.before, [near_i[1], near_i[0]])
        if not other.valley and not (near_i is near_j and not one.valley):
            self._insert(other.before, near_j)

        def corner(k: int, arriving: Floats, leaving: Floats, before: int, after: int) -> _Corner:
            old = corners[k]
            return _Corner(
                position[k], height, float(reach[k]), arriving, leaving, before, after, old.vertex, old.valley
            )

        a = [corner(i, -along, one.leaving, near_i[0], one.after), *corners[i + 1 : j]]
        a.append(corner(j, other.arriving, -along, other.before, near_j[0]))
        b = [corner(j, along, other.leaving, near_j[1], other.after), *corners[j + 1 :], *corners[:i]]
        b.append(corner(i, one.arriving, along, one.before, near_i[1]))
        parts = []
        for some, depths in (
            (a, [*part.depth[i:j], side]),
            (b, [*part.depth[j:], *part.depth[:i], side]),
        ):
            # The turning number tells the unbounded part of the outside from a pocket.
            unbounded = part.unbounded and sum(math.pi - c.angle for c in some) < 0
            parts.append(_Part(some, depths, height, unbounded))
        return parts

    def _pinch(self, part: _Part, state: _State, i: int, j: int) -> list[_Part]:
        """Two corners that are not neighbours meet in a point: the part falls in two, and no crease is needed."""
        corners, height = part.corners, part.height
        one, other = corners[i], corners[j]
        place, reach = state.positions(0.0)[i], state.reaches(0.0)
        x = float(reach[i])
        vertex = self._vertex_at(place, x, height)
        self._push(one, vertex)
        self._push(other, vertex)
        parts = []
        for first, last, rest, depth, steps in (
            (one, other, corners[i + 1 : j], part.depth[i:j], (i + 1, j - 1)),
            (
                other,
                one,
                [*corners[j + 1 :], *corners[:i]],
                [*part.depth[j:], *part.depth[:i]],
                ((j + 1) % len(corners), i - 1),
            ),
        ):
            corner = _Corner(place, height, x, last.arriving, first.leaving, last.before, first.after, vertex)
            ways = ((depth[0], reach[steps[0]]), (depth[-1], reach[steps[1]]))
            corner.valley = any(d == NO_FOOT and r > x + self.tie for d, r in ways)
            some = [corner, *rest]
            unbounded = part.unbounded and sum(math.pi - c.angle for c in some) < 0
            parts.append(_Part(some, list(depth), height, unbounded))
        return parts

    def _insert(self, before: int, facets: list[int]) -> None:
        place = self.order.index(before) + 1
        self.order[place:place] = facets

    def _close(self, part: _Part) -> None:
        """Two corners are left: the ridge between them, with a point where feet end on it."""
        one, other = part.corners
        state = _State(part)
        position, reach = state.positions(0.0), state.reaches(0.0)
        length = math.dist(position[0], position[1])
        for corner, place, x in zip(part.corners, position, reach, strict=True):
            self._push(corner, self._vertex_at(place, float(x), part.height))
        depth = min(part.depth)
        if depth == NO_FOOT:
            return
        from_one = float(reach[0]) - depth
        if from_one <= self.tie or length <= self.tie:
            foot = one.vertex
        elif length - from_one <= self.tie:
            foot = other.vertex
        else:
            place = position[0] + (position[1] - position[0]) * (from_one / length)
            foot = self._vertex_at(place, depth, part.height)
        for k, (start, end) in enumerate(((one, other), (other, one))):
            if part.depth[k] != NO_FOOT:
                self.facets[start.after].end.append(foot)
                self.facets[end.before].start.append(foot)

    def _end(self, part: _Part, state: _State) -> None:
        """The unbounded part has reached its limit: corners and feet go on to there."""
        time = self.limit - part.height
        position, reach = state.positions(time), state.reaches(time)
        for k, corner in enumerate(part.corners):
            self._push(corner, self.vertices.add(position[k], (float(reach[k]), self.sign * self.limit)))
        for k, corner in enumerate(part.corners):
            if part.depth[k] == NO_FOOT:
                continue
            following = part.corners[(k + 1) % len(part.corners)]
            foot = self.facets[corner.after].end[-1]
            rise = self.limit - abs(self.vertices.folded[foot][1])
            place = np.array(self.vertices.flat[foot]) + left_normal(corner.leaving) * rise
            end = self.vertices.add(place, (part.depth[k], self.sign * self.limit))
            self.facets[corner.after].end.append(end)
            self.facets[following.before].start.append(end)


class _State:
    """A part's corners as arrays, at its own height."""

    def __init__(self, part: _Part) -> None:
        self.part = part
        corners = part.corners
        rise = np.array([part.height - c.height for c in corners])
        self.velocity = np.array([c.velocity for c in corners])
        self.slope = np.array([c.slope for c in corners])
        self.shrink = np.array([c.shrink for c in corners])
        self.position = np.array([c.position for c in corners]) + self.velocity * rise[:, None]
        self.reach = np.array([c.reach for c in corners]) + self.slope * rise
        self.valley = np.array([c.valley for c in corners])
        self.depth = np.array(part.depth)

    def positions(self, time: float) -> Floats:
        moved: Floats = self.position + self.velocity * time
        return moved

    def reaches(self, time: float) -> Floats:
        reaches: Floats = self.reach + self.slope * time
        return reaches

    def next_merge(self, tie: float) -> tuple[int, float]:
        """The side that vanishes first, and when."""
        following = np.roll(self.reach, -1)
        lowest = np.where(np.isinf(self.depth), np.minimum(self.reach, following), self.depth)
        length = self.reach + following - 2 * lowest
        rate = self.shrink + np.roll(self.shrink, -1)
        with np.errstate(all="ignore"):
            time = np.where(rate > 0, np.maximum(length, 0.0) / rate, np.inf)
        time = np.where(length <= tie, 0.0, time)
        k = int(time.argmin())
        return k, float(time[k])

    def coincident(self, tie: float) -> tuple[int, int] | None:
        """Two corners, not neighbours, that are in the same place now, both on the sheet and when folded."""
        count = len(self.reach)
        for i in range(count):
            for j in range(i + 2, count - (i == 0)):
                apart = np.abs(self.position[i] - self.position[j])
                if apart.max() <= tie and abs(self.reach[i] - self.reach[j]) <= tie:
                    return i, j
        return None

    def next_turn(self, tie: float) -> tuple[int, float]:
        """The peak that comes down to its two feet, if these are lower than all others, and when."""
        if self.valley.any() or len(self.depth) < 3:
            return -1, math.inf
        before = np.roll(self.depth, 1)
        lowest = float(self.depth.min())
        level = np.flatnonzero(self.depth <= lowest + tie)
        if len(level) != 2:
            return -1, math.inf
        for k in np.flatnonzero((before <= lowest + tie) & (self.depth <= lowest + tie)):
            if self.shrink[k] > 0:
                return int(k), max(0.0, float((self.reach[k] - lowest) / self.shrink[k]))
        return -1, math.inf

    def tree_depths(self, time: float) -> Floats:
        """The depth where the paths from two corners meet in the tree, ``(k, k)``: the higher of the lowest ways."""
        count = len(self.depth)
        low = np.full((count, count), np.inf)
        own = np.where(self.valley, self.reaches(time), np.inf)
        for i in range(count):
            # going round from corner i: its foot, the next corner if a valley, its foot, ...
            way = np.empty(2 * count)
            way[0::2] = np.roll(self.depth, -i)
            way[1::2] = np.roll(own, -i - 1)
            low[i, (i + 1 + np.arange(count)) % count] = np.minimum.accumulate(way)[0::2]
        meet = np.maximum(low, low.T)
        lowest: Floats = np.minimum(meet, np.minimum(own[:, None], own[None]))
        return lowest

    def next_gusset(self, before: float, tie: float) -> tuple[float, int, int, float] | None:
        """The first pair that comes too near before the given time: (time, i, j, depth of the foot between)."""
        count = len(self.depth)
        if count < 4:
            return None
        i, j = np.triu_indices(count, 2)
        inner = ~((i == 0) & (j == count - 1))
        i, j = i[inner], j[inner]
        meet = self.tree_depths(0.0)[i, j]
        apart, parting = self.position[j] - self.position[i], self.velocity[j] - self.velocity[i]
        soon = 1e3 * tie
        meet_slope = np.zeros(len(i))
        if self.valley.any():
            known = np.isfinite(meet)
            meet_slope[known] = (self.tree_depths(soon)[i, j][known] - meet[known]) / soon
        path = self.reach[i] + self.reach[j] - 2 * meet
        path_slope = self.slope[i] + self.slope[j] - 2 * meet_slope
        distance = np.hypot(apart[:, 0], apart[:, 1])
        a = (parting**2).sum(axis=1) - path_slope**2
        b = 2 * ((apart * parting).sum(axis=1) - path * path_slope)
        c = (distance - path) * (distance + path)
        with np.errstate(all="ignore"):
            q = -b + np.sqrt(b * b - 4 * a * c)
            time = np.where(q > 0, 2 * c / q, np.inf)
        time = np.where(distance - path <= tie, np.where(b < 0, 0.0, np.inf), time)
        time[distance < path - 1e3 * tie] = np.inf  # it was too near from the start: see the search
        time[np.isnan(time) | (time < 0)] = np.inf
        if math.isfinite(before):
            # a tie with a merge or a turn is theirs
            then = apart + parting * before
            time[path + path_slope * before - np.hypot(then[:, 0], then[:, 1]) <= tie] = np.inf
        for n in np.argsort(time, kind="stable"):
            if time[n] > before or not math.isfinite(time[n]):
                break
            if self.sees(float(time[n]), int(i[n]), int(j[n])):
                depth = float(meet[n] + meet_slope[n] * time[n])
                return float(time[n]), int(i[n]), int(j[n]), depth
        return None

    def sees(self, time: float, i: int, j: int) -> bool:
        """Whether the segment between two corners lies inside the part."""
        corners, place = self.part.corners, self.positions(time)
        line = place[j] - place[i]
        if not line.any():
            return False
        for k, toward in ((i, line), (j, -line)):
            leaving = corners[k].leaving
            turn = math.atan2(float(cross(leaving, toward)), float(leaving @ toward)) % (2 * math.pi)
            if not 1e-9 < turn < corners[k].angle - 1e-9:
                return False
        count = len(corners)
        others = np.array(
            [k for k in range(count) if k not in (i, j) and (k + 1) % count not in (i, j)], dtype=np.int64
        )
        start, end = place[others], place[(others + 1) % count]
        return not bool(_crosses(place[i], line, start, end).any())


def _crosses(origin: Floats, line: Floats, start: Floats, end: Floats) -> Bools:
    """Which segments start-end meet the segment from ``origin`` along ``line``."""
    side_start, side_end = cross(line, start - origin), cross(line, end - origin)
    along = end - start
    near, far = cross(along, origin - start), cross(along, origin + line - start)
    return (side_start * side_end <= 0) & (near * far <= 0)


def partners(inside: Molecule, outside: Molecule) -> dict[int, int]:
    """For each facet of the outside molecule at the border, the facet inside that it is one face with."""
    joined: dict[int, int] = {}
    last = -1 if len(inside.side_facets[-1]) == 1 else -2  # the side of the reversed chain that is our side 0
    for k, facets in enumerate(inside.side_facets):
        joined.update(zip(reversed(outside.side_facets[(last - k) % len(inside.side_facets)]), facets, strict=True))
    return joined
