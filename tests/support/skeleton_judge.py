"""Whether a straight skeleton is right, found out from the skeleton alone: it does not matter how it was made.

What is checked, and why that is enough. Let T be the function whose value on a side's face is the distance from the
side's line. The rules say:

1. *Sides and beginnings*: sides are the flanks of the edges, with a cap at each dead end; where one side ends and the
   next around the same region begins, one arc begins, and no other arc begins at a point of the graph.
2. *Joints*: every piece of the border of a face is its side or an arc that names the face, once from the left and once
   from the right.
3. *Nodes* are equally far, namely their time, from the lines of all sides whose faces have them; *arcs* go forward in
   time along bisectors. So T has no jumps.
4. *Faces* are simple, counter-clockwise, on the left of their side and monotone in its direction; their areas in a box
   around everything add up to the area of the box. With 2, they tile the plane.
5. On the lower chain of a face, which leads from the side to the ends of the face, time only rises, and no arc is
   level. So every place of a face is reached straight away from the side: T has no minimum in a face but the side.

By these, T's level sets are the wavefront at every time, so the skeleton is the straight skeleton, and no side is
nearer in its wavefront. They are so just after time 0 (1). As time goes on, every piece of a level set moves away from
its side at unit speed, and two that meet do so on their bisector (3), until a node. After a node, no side has a piece
that had none there before (5), and the level set does not cross itself (4), so beyond the node each two neighbours in
the order of angles are followed by their bisector, or end face to face. That is how the wavefront is defined.

All is measured in ulps of the drawing's coordinates. An ulp turns a short side, so it moves the side's line in
proportion to how many lengths of the side one is away; and along the bisector of nearly parallel sides it moves a node
farther than it changes the node's distances.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from fractions import Fraction
from functools import cached_property, cmp_to_key
from itertools import chain

import numpy as np
import shapely
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Floats, Indices
from foldcut.geometry.straight_skeleton import StraightSkeleton

ULPS = 256.0
"""How many ulps of the largest coordinate a node may be off from a side that is one length of the side away."""

ULP = 2.0**-52

MOST_TOLD = 4
"""How many findings of one kind are told."""

FAR = 1e9
"""What is farther away than this, in sizes of the drawing, is not looked at: whether arcs that never end cross there,
and, if a node is there, what shape the faces have that go on for ever."""

BOX = 4.0
"""Half the width of the box around everything, by the distance of the farthest node from the middle."""


def judge(skeleton: StraightSkeleton) -> list[str]:
    """Return what is wrong with a straight skeleton, in words, with places; nothing if it is right."""
    found = Case(skeleton)
    damage = list(found.damage())
    if damage:
        return damage
    rules = (found.sides, found.beginnings, found.joints, found.nodes, found.arcs, found.faces, found.areas)
    return list(chain.from_iterable(rule() for rule in rules))


def _few(texts: Iterable[str]) -> Iterator[str]:
    """Yield the first texts, and how many more there are."""
    left = iter(texts)
    for _, text in zip(range(MOST_TOLD), left, strict=False):
        yield text
    more = sum(1 for _ in left)
    if more:
        yield f"... and {more} more of this kind"


def _dot(one: Floats, other: Floats) -> Floats:
    return (one * other).sum(axis=-1)


class Case:
    """A skeleton that is judged, with what several rules need."""

    def __init__(self, skeleton: StraightSkeleton) -> None:
        graph = skeleton.graph
        self.skeleton, self.graph = skeleton, graph
        self.places, self.time = skeleton.nodes, skeleton.time
        self.count, self.side_count = len(graph.points), len(skeleton.face_nodes)
        low, high = graph.points.min(axis=0), graph.points.max(axis=0)
        self.middle, self.size = (low + high) / 2, float(np.hypot(*(high - low)))
        self.grain = ULPS * ULP * (self.size + float(np.abs(graph.points).max()))
        # the rows of the faces' nodes: whose face, where from, where to
        self.values = skeleton.face_nodes.values.astype(np.int64)
        self.owner = skeleton.face_nodes.rows.astype(np.int64)
        self.begin = skeleton.face_nodes.offsets.astype(np.int64)

    # --- words -----------------------------------------------------------------------------------------------------

    def side(self, side: int) -> str:
        a, b = self.graph.points[[self.tail[side], self.head[side]]]
        if self.tail[side] == self.head[side]:
            return f"the cap {side} at ({a[0]:.6g}, {a[1]:.6g})"
        return f"side {side} from ({a[0]:.6g}, {a[1]:.6g}) to ({b[0]:.6g}, {b[1]:.6g})"

    def node(self, node: int) -> str:
        if node < 0:
            return "the infinite"
        x, y = self.places[node]
        return f"node {node} at ({x:.9g}, {y:.9g}), time {self.time[node]:.9g}"

    def arc(self, arc: int) -> str:
        a, b = self.skeleton.arcs[arc].tolist()
        left, right = self.skeleton.arc_sides[arc].tolist()
        return f"arc {arc} from {self.node(a)} to {self.node(b)}, between sides {left} and {right}"

    # --- what can be read at all -----------------------------------------------------------------------------------

    def damage(self) -> Iterator[str]:
        """Yield what makes it impossible to go on."""
        skeleton, nodes = self.skeleton, len(self.places)
        if len(self.time) != nodes or not np.isfinite(self.places).all() or not np.isfinite(self.time).all():
            yield "nodes or their times are not finite"
        elif nodes < self.count or not (self.places[: self.count] == self.graph.points).all():
            yield "the first nodes are not the graph's points"
        if self.side_count != len(self.tail):
            yield f"there are {self.side_count} faces for {len(self.tail)} sides"
            return
        if len(self.values) and (self.values.min() < -1 or self.values.max() >= nodes):
            yield "a face has a node that does not exist"
        ends, sides = skeleton.arcs, skeleton.arc_sides
        if ends.shape != sides.shape or ends.shape != skeleton.arc_velocity.shape or ends.ndim != 2:
            yield "arcs, their sides and velocities differ in number"
            return
        if len(ends) and (ends[:, 0].min() < 0 or ends[:, 1].min() < -1 or ends.max() >= nodes):
            yield "an arc has a node that does not exist"
        if len(sides) and (sides.min() < 0 or sides.max() >= self.side_count):
            yield "an arc has a side that does not exist"
        if not np.isfinite(skeleton.arc_velocity).all():
            yield "an arc's velocity is not finite"
        cap = self.tail == self.head
        wrong = np.flatnonzero(np.diff(self.begin) < np.where(cap, 2, 3))
        yield from _few(f"the face of {self.side(s)} has too few nodes" for s in wrong.tolist())
        if len(wrong) == 0:
            first, second = self.values[self.begin[:-1]], self.values[self.begin[:-1] + 1]
            wrong = np.flatnonzero((first != self.tail) | (~cap & (second != self.head)))
            yield from _few(f"the face of {self.side(s)} does not begin with it" for s in wrong.tolist())

    # --- rule 1 ----------------------------------------------------------------------------------------------------

    @cached_property
    def tail(self) -> Indices:
        """Where each side starts: both ends of every edge, then the points with one edge."""
        return np.concatenate([self.graph.edges.reshape(-1), self._tips])

    @cached_property
    def head(self) -> Indices:
        return np.concatenate([self.graph.edges[:, ::-1].reshape(-1), self._tips])

    @cached_property
    def _tips(self) -> Indices:
        """The points of the caps, in the order of the graph."""
        edges, tips = self.graph.edges, self.graph.tail[2 * len(self.graph.edges) :]
        degree = np.bincount(edges.reshape(-1), minlength=self.count)
        return tips if sorted(tips.tolist()) == np.flatnonzero(degree == 1).tolist() else np.flatnonzero(degree == 1)

    @cached_property
    def along(self) -> Floats:
        """The unit direction of each side, ``(s, 2)``."""
        points, edges = self.graph.points, self.graph.edges
        step = points[edges[:, 1]] - points[edges[:, 0]]
        step = step / np.hypot(*step.T)[:, None]
        flanks = np.stack([step, -step], axis=1).reshape(-1, 2)
        arriving = np.full(self.count, -1)
        arriving[self.head[: len(flanks)]] = np.arange(len(flanks))
        x, y = flanks[arriving[self._tips]].T
        return np.concatenate([flanks, np.stack([y, -x], axis=1)])

    @cached_property
    def normal(self) -> Floats:
        """The unit direction in which each side's wavefront moves: to its left."""
        x, y = self.along.T
        return np.stack([-y, x], axis=1)

    @cached_property
    def following(self) -> Indices:
        """The side that goes on at the head of each, around the same region."""
        flanks = 2 * len(self.graph.edges)
        leaving = np.arange(flanks)
        angle = np.arctan2(self.along[:flanks, 1], self.along[:flanks, 0])
        order = np.lexsort((angle, self.tail[:flanks]))
        bounds = np.searchsorted(self.tail[order], np.arange(self.count + 1))
        gap = np.abs(np.diff(angle[order])) < 1e-9
        gap |= np.abs(np.diff(angle[order])) > 2 * np.pi - 1e-9
        alike = (self.tail[order[1:]] == self.tail[order[:-1]]) & gap
        for point in np.unique(self.tail[order[1:][alike]]).tolist():
            some = slice(bounds[point], bounds[point + 1])
            order[some] = self._by_angle(order[some].tolist())
        place = np.empty(flanks, dtype=np.int64)
        place[order] = np.arange(flanks)
        first, degree = bounds[:-1][self.head[:flanks]], np.diff(bounds)[self.head[:flanks]]
        following = order[first + (place[leaving ^ 1] - first - 1) % degree]
        cap_of = np.full(self.count, -1)
        cap_of[self._tips] = flanks + np.arange(len(self._tips))
        ends = cap_of[self.head[:flanks]]
        back = np.zeros(self.count, dtype=np.int64)
        back[self.tail[:flanks]] = leaving
        return np.concatenate([np.where(ends >= 0, ends, following), back[self._tips]])

    def _by_angle(self, sides: list[int]) -> list[int]:
        """Sort sides from one point by their angle, exactly."""

        def compare(one: int, other: int) -> int:
            # the lower half of a turn comes first
            half, other_half = (self.exact_direction(side)[::-1] > (0, 0) for side in (one, other))
            if half != other_half:
                return 1 if half else -1
            turn = self.turn(one, other)
            return -1 if turn > 0 else int(turn < 0)

        return sorted(sides, key=cmp_to_key(compare))

    def exact_direction(self, side: int) -> tuple[Fraction, Fraction]:
        """Return the direction of a side exactly, in any length."""
        cap = self.tail[side] == self.head[side]
        flank = int(np.flatnonzero(self.following == side)[0]) if cap else side
        (ax, ay), (bx, by) = self.graph.points[[self.tail[flank], self.head[flank]]].tolist()
        x, y = Fraction(bx) - Fraction(ax), Fraction(by) - Fraction(ay)
        return (y, -x) if cap else (x, y)

    def turn(self, one: int, other: int) -> Fraction:
        """Return the cross product of two sides' exact directions: 0 if they are parallel."""
        (ax, ay), (bx, by) = self.exact_direction(one), self.exact_direction(other)
        return ax * by - ay * bx

    def sides(self) -> Iterator[str]:
        """The graph's sides are what its points and edges say."""
        graph = self.graph
        start = graph.points[self.tail]
        for name, ours, theirs in (
            ("tail", self.tail, graph.tail),
            ("head", self.head, graph.head),
            ("start", start, graph.side_start),
        ):
            wrong = np.flatnonzero((np.asarray(theirs) != ours).reshape(len(ours), -1).any(axis=1))
            yield from _few(f"the {name} of {self.side(s)} is wrong" for s in wrong.tolist())
        wrong = np.flatnonzero(np.abs(graph.side_along - self.along).max(axis=1) > 1e-15)
        yield from _few(f"the direction of {self.side(s)} is wrong" for s in wrong.tolist())
        edge = np.where(self.tail == self.head, -1, np.arange(self.side_count) // 2)
        if not (graph.side_edge == edge).all():
            yield "side_edge is wrong"
        contour, region = graph.side_contour, graph.side_region
        wrong = np.flatnonzero(contour != contour[self.following])
        yield from _few(f"{self.side(s)} is on another contour than the next" for s in wrong.tolist())
        walks = _cycle_count(self.following)
        if len(np.unique(contour)) != walks:
            yield f"{len(np.unique(contour))} contours are told, and there are {walks}"
        # a region is in one piece, and its faces are joined by arcs: so these have one number, and Euler says how many
        left, right = self.skeleton.arc_sides.T
        wrong = np.flatnonzero(region[left] != region[right])
        yield from _few(f"{self.arc(k)} is between regions" for k in wrong.tolist())
        pieces = _piece_count(self.count, graph.edges)
        regions = 1 + pieces - self.count + len(graph.edges)
        if len(np.unique(region)) != regions:
            yield f"{len(np.unique(region))} regions are told, and there are {regions}"

    def beginnings(self) -> Iterator[str]:
        """One arc begins between each side and the next; all nodes but the points have a time."""
        start = self.skeleton.arcs[:, 0]
        left, right = self.skeleton.arc_sides.T
        at_points = start < self.count
        begun = np.bincount(left[at_points], minlength=self.side_count)
        wrong = np.flatnonzero(begun != 1)
        yield from _few(f"{begun[s]} arcs begin at the head of {self.side(s)}" for s in wrong.tolist())
        wrong = np.flatnonzero(at_points & ((start != self.head[left]) | (right != self.following[left])))
        yield from _few(f"{self.arc(k)} does not begin between neighbours" for k in wrong.tolist())
        ends = self.skeleton.arcs[:, 1]
        wrong = np.flatnonzero((ends >= 0) & (ends < self.count))
        yield from _few(f"{self.arc(k)} ends in a point of the graph" for k in wrong.tolist())
        if (self.time[: self.count] != 0).any():
            yield "a point of the graph has a time other than 0"
        wrong = self.count + np.flatnonzero(~(self.time[self.count :] > 0))
        yield from _few(f"{self.node(k)} has no time" for k in wrong.tolist())

    # --- rule 2 ----------------------------------------------------------------------------------------------------

    @cached_property
    def after(self) -> Indices:
        """The place of the next node in its face, for every place in the faces."""
        return self.skeleton.face_nodes.following.astype(np.int64)

    def joints(self) -> Iterator[str]:
        """The borders of faces are sides and arcs, each arc once from either side."""
        borders = np.stack([self.owner, self.values, self.values[self.after]], axis=1)
        (start, end), (left, right) = self.skeleton.arcs.T, self.skeleton.arc_sides.T
        sides = np.flatnonzero(self.tail != self.head)
        expected = np.concatenate(
            [
                np.stack([left, start, end], axis=1),
                np.stack([right, end, start], axis=1),
                np.stack([sides, self.tail[sides], self.head[sides]], axis=1),
            ]
        )
        numbered = {}
        for name, rows in (("border", borders), ("arc", expected)):
            unique, count = np.unique(rows, axis=0, return_counts=True)
            twice = unique[count > 1]
            yield from _few(
                f"the {name} from {self.node(a)} to {self.node(b)} is there {'more than once'} for {self.side(s)}"
                for s, a, b in twice.tolist()
            )
            numbered[name] = {tuple(row) for row in unique.tolist()}
        for s, a, b in _firsts(numbered["border"] - numbered["arc"]):
            yield f"the face of {self.side(s)} has a border from {self.node(a)} to {self.node(b)} where no arc is"
        for s, a, b in _firsts(numbered["arc"] - numbered["border"]):
            yield f"the face of {self.side(s)} does not have the arc from {self.node(a)} to {self.node(b)}"

    # --- rule 3 ----------------------------------------------------------------------------------------------------

    @cached_property
    def length(self) -> Floats:
        """The length of each side, ``(s,)``; of a cap, that of its edge."""
        lengths = np.hypot(*(self.graph.points[self.graph.edges[:, 1]] - self.graph.points[self.graph.edges[:, 0]]).T)
        flanks = np.repeat(lengths, 2)
        edge = np.zeros(self.count)
        edge[self.head[: len(flanks)]] = flanks
        return np.concatenate([flanks, edge[self._tips]])

    @cached_property
    def allowed(self) -> Floats:
        """How much the distances of each node from its sides may be off."""
        there = self.values >= 0
        allowed = np.zeros(len(self.places))
        np.maximum.at(allowed, self.values[there], self._allowed_of(self.values[there], self.owner[there]))
        return allowed

    def _allowed_of(self, nodes: Indices, sides: Indices) -> Floats:
        away = np.hypot(*(self.places[nodes] - self.graph.points[self.tail[sides]]).T)
        return self.grain * (1 + away / self.length[sides])

    @cached_property
    def spread(self) -> Floats:
        """How far rounding may move each node: ``allowed`` by the condition of its sides' equations."""
        # the smallest singular value of the rows (normal, -1) of a node's sides
        there = self.values >= 0
        node, side = self.values[there], self.owner[there]
        rows = np.concatenate([self.normal[side], -np.ones((len(side), 1))], axis=1)
        squares = np.zeros((len(self.places), 3, 3))
        np.add.at(squares, node, rows[:, :, None] * rows[:, None, :])
        least = np.sqrt(np.maximum(np.linalg.eigvalsh(squares)[:, 0], 1e-17))
        spread: Floats = self.allowed / np.minimum(least, 1)
        spread[: self.count] = self.allowed[: self.count]
        return spread

    def nodes(self) -> Iterator[str]:
        """Every node is as far from the lines of its sides as its time says."""
        there = self.values >= 0
        node, side = self.values[there], self.owner[there]
        unused = np.flatnonzero(np.bincount(node, minlength=len(self.places)) == 0)
        yield from _few(f"{self.node(k)} is in no face" for k in unused.tolist())
        away = _dot(self.normal[side], self.places[node] - self.graph.points[self.tail[side]])
        off = np.abs(away - self.time[node])
        wrong = np.flatnonzero(off > self._allowed_of(node, side))
        yield from _few(
            f"{self.node(int(node[k]))} is {away[k]:.17g} from {self.side(int(side[k]))}: {off[k] / self.size:.1e} off"
            for k in wrong[np.argsort(-off[wrong])].tolist()
        )

    def arcs(self) -> Iterator[str]:
        """Arcs go forward in time, along the bisectors of their sides."""
        (start, end), (left, right) = self.skeleton.arcs.T, self.skeleton.arc_sides.T
        velocity = self.skeleton.arc_velocity
        speed = np.hypot(*velocity.T)
        level, ends = speed == 0, end >= 0
        yield from self._wrong_arcs(left == right, "has the same side twice")
        yield from self._wrong_arcs(~ends & level, "goes nowhere")
        # from end to end
        allowed = self.allowed[start] + np.where(ends, self.allowed[end], 0)
        step = np.where(ends[:, None], self.places[end] - self.places[start], 0)
        wait = np.where(ends, self.time[end] - self.time[start], 0)
        yield from self._wrong_arcs(wait < -allowed, "goes back in time")
        yield from self._wrong_arcs(ends & (step == 0).all(axis=1), "has no length")
        # the bisector: both sides move along with it, and, should they be parallel, it is square to them
        turn = ULPS * ULP + self.grain / self.length  # how much the direction of each side may be off
        together, apart = _dot(self.normal[left], self.normal[right]), self.normal[left] + self.normal[right]
        for sides, which in ((left, "left"), (right, "right")):
            off = np.abs(_dot(velocity, self.normal[sides]) - 1)
            yield from self._wrong_arcs(~level & (off > turn[sides] * (1 + speed)), f"loses the side on its {which}")
        off = np.abs(speed**2 * (1 + together) / 2 - 1)
        yield from self._wrong_arcs(~level & (together > 0) & (off > turn[left] + turn[right]), "has a wrong speed")
        off = np.hypot(*(step - wait[:, None] * velocity).T)
        far = off > self.spread[start] + self.spread[end] + speed * (allowed + wait * (turn[left] + turn[right]))
        yield from self._wrong_arcs(ends & ~level & far, "does not lead to its end")
        yield from self._wrong_arcs(level & (wait > allowed), "is level, but its ends differ in time")
        off = np.hypot(*apart.T)
        far = (off > turn[left] + turn[right]) & (off * np.hypot(*step.T) > allowed)
        yield from self._wrong_arcs(ends & level & far, "is level, but its sides are not face to face")

    def _wrong_arcs(self, wrong: Bools, what: str) -> Iterator[str]:
        return _few(f"{self.arc(k)} {what}" for k in np.flatnonzero(wrong).tolist())

    # --- rules 4 and 5 ---------------------------------------------------------------------------------------------

    @cached_property
    def outlines(self) -> tuple[Floats, Indices, Indices, Floats, Floats]:
        """The faces within the box: places, whose faces, which nodes (-1 on the box), how exact, times.

        Where a face goes off to infinity, it goes on along the box.
        """
        half = BOX * max(self.size, float(np.abs(self.places - self.middle).max()))
        self.half = half
        ray = {}
        for k in np.flatnonzero(self.skeleton.arcs[:, 1] < 0).tolist():
            for flank, side in enumerate(self.skeleton.arc_sides[k].tolist()):
                ray[int(self.skeleton.arcs[k, 0]), side, flank] = k
        fence = self.grain * (2 + 2 * half / self.length.min()) if half <= BOX * FAR * self.size else np.inf
        corners = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)])
        extra: dict[int, list[Floats]] = {}
        before = np.empty_like(self.after)
        before[self.after] = np.arange(len(self.after))
        for place in np.flatnonzero(self.values < 0).tolist():
            side = int(self.owner[place])
            out = ray.get((int(self.values[before[place]]), side, 0))
            back = ray.get((int(self.values[self.after[place]]), side, 1))
            if out is None or back is None:
                extra[place] = []
                continue
            first, last = self._on_box(out, half), self._on_box(back, half)
            turn = (_along_box(last - self.middle, half) - _along_box(first - self.middle, half)) % 8
            at = _along_box(first - self.middle, half)
            passed = [k for k in range(1, 17, 2) if at < k < at + turn] if turn < 7.9 else []
            extra[place] = [first, *(self.middle + half * corners[(k // 2) % 4] for k in passed), last]
        if not extra:
            return self.places[self.values], self.owner, self.values, self.spread[self.values], self.time[self.values]
        many = np.ones(len(self.values), dtype=np.int64)
        for place, points in extra.items():
            many[place] = len(points)
        where = np.repeat(np.arange(len(self.values)), many)
        nodes = self.values[where]
        places = self.places[nodes]
        places[nodes < 0] = np.concatenate([np.reshape(extra[k], (-1, 2)) for k in sorted(extra)])
        spread, time = self.spread[nodes], self.time[nodes]
        spread[nodes < 0], time[nodes < 0] = fence, np.inf
        return places, self.owner[where], nodes, spread, time

    def _on_box(self, arc: int, half: float) -> Floats:
        """Return where an arc that goes on for ever leaves the box."""
        place = self.places[self.skeleton.arcs[arc, 0]] - self.middle
        velocity = self.skeleton.arc_velocity[arc]
        with np.errstate(all="ignore"):
            steps = np.where(velocity != 0, (np.copysign(half, velocity) - place) / velocity, np.inf)
        reached: Floats = place + float(steps.min()) * velocity if np.isfinite(steps.min()) else place
        return reached + self.middle

    def faces(self) -> Iterator[str]:
        """Faces are on the left of their side, monotone, simple, and rise along their lower chains."""
        places, owner, nodes, spread, time = self.outlines
        start = np.searchsorted(owner, np.arange(self.side_count + 1))
        after = np.arange(1, len(owner) + 1)
        after[start[1:] - 1] = start[:-1]
        from_tail = places - self.graph.points[self.tail[owner]]
        u, v = _dot(from_tail, self.along[owner]), _dot(from_tail, self.normal[owner])
        wrong = np.unique(owner[v < -spread])
        yield from _few(f"the face of {self.side(s)} reaches behind it" for s in wrong.tolist())
        # monotone: it goes forth once and back once
        step = u[after] - u
        some = spread + spread[after]
        turns = _sign_changes(np.where(np.abs(step) <= some, 0, np.sign(step)), owner, self.side_count)
        wrong = np.flatnonzero(turns > 2)
        yield from _few(f"the face of {self.side(s)} goes to and fro along it" for s in wrong.tolist())
        yield from self._lower_chains(owner, start, u, time, nodes)
        # simple: found out by shapely, and where rounding may have spoiled it, chain by chain
        flat = np.diff(start) < 3
        yield from _few(f"the face of {self.side(s)} has no area" for s in np.flatnonzero(flat).tolist())
        full = ~flat[owner]
        rings = shapely.linearrings(places[full], indices=np.cumsum(~flat)[owner[full]] - 1)
        doubtful = ~shapely.is_valid(shapely.polygons(rings)) | ~shapely.is_ccw(rings)
        sides = np.flatnonzero(~flat)[doubtful].tolist()
        crossed = [s for s in sides if self._crossed(s, u, v, spread, start)]
        yield from _few(f"the face of {self.side(s)} crosses itself, or is clockwise" for s in crossed)

    def _lower_chains(self, owner: Indices, start: Indices, u: Floats, time: Floats, nodes: Indices) -> Iterator[str]:
        """Yield faces with time falling, or standing still, on the way from the side to either end."""
        count = np.diff(start)
        place = np.arange(len(owner)) - start[owner]  # 0 is the tail
        cap = self.tail == self.head
        order = np.lexsort((place, -u, owner))
        rightmost = place[order[start[:-1]]]  # of several the first
        order = np.lexsort((-place, u, owner))
        leftmost = place[order[start[:-1]]]
        leftmost[leftmost == 0] = count[leftmost == 0]
        levels = {tuple(ends) for ends in self.skeleton.arcs[(self.skeleton.arc_velocity == 0).all(axis=1)].tolist()}
        levels |= {ends[::-1] for ends in levels}
        after = place + 1
        to = start[owner] + after % count[owner]
        rising = (after <= rightmost[owner]) & (place >= np.where(cap, 0, 1)[owner])
        falling = (place >= leftmost[owner]) & ~((after == count[owner]) & (place == 0))
        with np.errstate(invalid="ignore"):
            change = np.where(np.isinf(time) & np.isinf(time[to]), 0, time[to] - time)
        allowed = self._allowed_at(nodes) + self._allowed_at(nodes[to])
        wrong = (rising & (change < -allowed)) | (falling & (change > allowed))
        yield from _few(
            f"the face of {self.side(int(owner[k]))} begins anew at {self.node(int(nodes[k if rising[k] else to[k]]))}"
            for k in np.flatnonzero(wrong).tolist()
        )
        flat = np.array([(a, b) in levels for a, b in zip(nodes.tolist(), nodes[to].tolist(), strict=True)], dtype=bool)
        long = np.abs(u[to] - u) > self._spread_at(nodes) + self._spread_at(nodes[to])
        wrong = (rising | falling) & flat & long
        yield from _few(
            f"the face of {self.side(int(owner[k]))} begins at the level arc from {self.node(int(nodes[k]))}"
            for k in np.flatnonzero(wrong).tolist()
        )

    def _allowed_at(self, nodes: Indices) -> Floats:
        return np.where(nodes < 0, np.inf, self.allowed[nodes])

    def _spread_at(self, nodes: Indices) -> Floats:
        return np.where(nodes < 0, np.inf, self.spread[nodes])

    def _crossed(self, side: int, u: Floats, v: Floats, spread: Floats, start: Indices) -> bool:
        """Return whether a face's lower chain is above its upper one, by more than rounding explains."""
        some = slice(start[side], start[side + 1])
        x, y, off = u[some], v[some], 2 * spread[some].max()
        if np.ptp(x) <= off:
            return False  # nobody can tell
        left, right = int(np.argmin(x)), int(np.argmax(x))
        numbers = np.arange(len(x))
        lower = np.roll(numbers, -left)[: (right - left) % len(x) + 1]
        upper = np.roll(numbers, -right)[: (left - right) % len(x) + 1][::-1]
        return any(
            sign * y[k] > sign * extreme + off
            for chain_a, chain_b, sign in ((lower, upper, 1), (upper, lower, -1))
            for k in chain_a.tolist()
            if (extreme := _extreme(x[chain_b], y[chain_b], x[k], off, sign)) is not None
        )

    def areas(self) -> Iterator[str]:
        """The faces fill the box once."""
        places, owner, *_ = self.outlines
        start = np.searchsorted(owner, np.arange(self.side_count + 1))
        after = np.arange(1, len(owner) + 1)
        after[start[1:] - 1] = start[:-1]
        (x, y), (xx, yy) = ((some - self.middle).T / self.half for some in (places, places[after]))
        covered = float((x * yy - xx * y).sum()) / 8
        if abs(covered - 1) > 1e-6:
            yield f"the faces cover the plane {covered:.6g} times"
        goes_on = np.flatnonzero(self.skeleton.arcs[:, 1] < 0)
        out: dict[int, list[int]] = defaultdict(list)
        for k in goes_on.tolist():
            for side in self.skeleton.arc_sides[k].tolist():
                out[side].append(k)
        velocity = self.skeleton.arc_velocity
        turned = velocity / np.maximum(np.hypot(*velocity.T), 1e-300)[:, None]
        # the face on the left of an arc that goes out is counter-clockwise of it
        left = {int(self.skeleton.arc_sides[k, 0]): k for k in goes_on.tolist()}
        far = np.hypot(*(self.places[self.skeleton.arcs[:, 0]] - self.middle).T) > FAR * self.size
        for side, arcs in out.items():
            if len(arcs) == 2 and side in left:
                one, other = left[side], next((k for k in arcs if k != left[side]), left[side])
                cross = turned[one, 0] * turned[other, 1] - turned[one, 1] * turned[other, 0]
                if cross < -1 / FAR and not (far[one] or far[other]):
                    yield f"{self.arc(one)} crosses {self.arc(other)} far away"


def _along_box(place: Floats, half: float) -> float:
    """Return how far around the box a place on it is, from 0 to 8, counter-clockwise from the middle of its right."""
    x, y = (place / half).tolist()
    if abs(x) >= abs(y):
        return y % 8 if x > 0 else 4 - y
    return 2 - x if y > 0 else 6 + x


def _extreme(x: Floats, y: Floats, at: float, off: float, sign: int) -> float | None:
    """Return the greatest (sign 1) or least y of a chain where its x is within ``off`` of a place."""
    found = [float(value) for value in y[np.abs(x - at) <= off]]
    for place in (at - off, at, at + off):
        for a in np.flatnonzero((np.minimum(x[:-1], x[1:]) <= place) & (np.maximum(x[:-1], x[1:]) >= place)).tolist():
            share = (place - x[a]) / (x[a + 1] - x[a]) if x[a + 1] != x[a] else 0.0
            found.append(float(y[a] + share * (y[a + 1] - y[a])))
    return sign * max(sign * value for value in found) if found else None


def _sign_changes(signs: Floats, owner: Indices, count: int) -> Indices:
    """Return how often signs change around each row, zeros left out."""
    kept = signs != 0
    signs, owner = signs[kept], owner[kept]
    if len(signs) == 0:
        return np.zeros(count, dtype=np.int64)
    start = np.searchsorted(owner, np.arange(count + 1))
    after = np.arange(1, len(signs) + 1)
    full = start[1:] > start[:-1]
    after[start[1:][full] - 1] = start[:-1][full]
    return np.bincount(owner[signs != signs[after]], minlength=count)


def _cycle_count(following: Indices) -> int:
    numbers, left = following.tolist(), np.ones(len(following), dtype=bool).tolist()
    count = 0
    for first in range(len(numbers)):
        count += left[first]
        side = first
        while left[side]:
            left[side] = False
            side = numbers[side]
    return count


def _piece_count(count: int, edges: NDArray[np.signedinteger]) -> int:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    matrix = coo_array((np.ones(len(edges)), tuple(edges.T)), shape=(count, count))
    return int(connected_components(matrix, directed=False)[0])


def _firsts(rows: set[tuple[int, ...]]) -> list[tuple[int, ...]]:
    return sorted(rows)[:MOST_TOLD]
