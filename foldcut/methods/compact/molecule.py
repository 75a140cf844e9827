r"""The k-cornered molecule: how a polygon with creases across its sides folds with its whole border on one line.

A walk around the border -> ``Molecule``. It is the gusset molecule for any number of corners (Lang calls it the
universal molecule, in *Origami Design Secrets*, for convex polygons); here corners may be reflex, the polygon may be
the unbounded outside of a loop, and the tree that it is folded along may be any planar one.

Folded, the border goes to and fro on the cut line: it turns back at its *turns*, alternately *peaks* (x is largest)
and *valleys* (x is smallest). Corners are turns; so are points on sides, from which a perpendicular crease goes up.
Inset to the height h, turns move along their bisectors, and the sides between them shrink. On the way up,

- *collapse*: stretches of border shrink to nothing, all at one place; what is left there is one turn;
- *gusset*: two turns have come as near to each other as their images along the tree: the polygon splits along a
  crease between them;
- *pinch*: two turns that are not neighbours meet in a point, and the polygon falls in two.

Events at the same height need no special care: they follow each other at once and share their vertices.

The tree is what is left of a thin strip when equal places of the walk are joined over the valleys between them. The
order of the layers is the walk, cut at one place, the root, where x is smallest; a gusset crease adds its facets beside
those of its ends. That is possible because it wraps a stretch of the walk that lies at one side of it. In a
*pocket* of the outside the same is true with peaks for valleys: there the tree of the strip's other side may be taken.

Rabbit ear and gusset are the cases k = 3 and k = 4 with all valleys at x = 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Floats, Numbers
from foldcut.core.errors import CreaseTooShortError, UnfoldableError
from foldcut.methods.compact.events import Gusset, Meetings, Motion, Queue, Table, crosses, looks_inside

# Distances that differ by less than this part of the shape's size are equal.
TIE = 1e-9
# The same for borders of many turns: so many are so near each other, by chance, that fewer must count as equal.
SMALL_TIE = 3e-11
# Sides that differ by less than this angle in radians run back on each other.
SPIKE = 1e-9
# Parts of more turns than this look for gussets among pairs that are near each other only.
FEW = 100
# Parts of no more turns look for them one by one.
VERY_FEW = 12
# Borders of more turns than this have their events queued as far as that can be: more than any search finds.
MANY = 500
# Steps by the simple code before a queue is tried again.
PATIENCE = 10
# Gussets between two reports of progress.
REPORT = 200


@dataclass
class Vertices:
    """The growing list of vertices: where they are on the sheet, and where they land.

    ``cuts``: vertices where an edge is cut off at the sheet's border, with the edge's ends and the border's axis.
    """

    flat: list[tuple[float, float]] = field(default_factory=list)
    folded: list[tuple[float, float]] = field(default_factory=list)
    cuts: list[tuple[int, int, int, int]] = field(default_factory=list)

    def add(self, flat: Floats, folded: tuple[float, float]) -> int:
        """Add a vertex and return its number."""
        self.flat.append((float(flat[0]), float(flat[1])))
        self.folded.append(folded)
        return len(self.flat) - 1


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
class _Facet:
    """Two chains of vertices going up from the ends of a stretch of the border; closed when they meet."""

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


class _Order:
    """The order of the facets: who comes after whom."""

    def __init__(self, count: int) -> None:
        self.after = [*range(1, count), -1]
        self.before = [-1, *range(count - 1)]
        self.first = 0

    def insert(self, new: list[int], before: int, after: int) -> None:
        """Put new facets between two that follow each other, or at an end, which is -1."""
        more = [-1] * (max(new) + 1 - len(self.after))
        self.after += more
        self.before += more
        chain = [before, *new, after]
        for one, other in pairwise(chain):
            if one < 0:
                self.first = other
            else:
                self.after[one] = other
            if other >= 0:
                self.before[other] = one

    def list(self) -> list[int]:
        """The facets in order."""
        facets = [self.first]
        while (after := self.after[facets[-1]]) >= 0:
            facets.append(after)
        return facets


@dataclass(frozen=True, eq=False)
class Border:
    """The border of a molecule, its turns counter-clockwise from the root.

    ``vertices`` their numbers, ``peaks`` ``(n,)`` which of them are peaks, alternately; ``directions`` ``(n, 2)`` unit
    vectors of the sides after them; ``pockets`` ``(n,)`` for each a set of pockets that it belongs to, as bits;
    ``levels`` ``(n,)`` mm: where creases land that wrap a turn while it moves outwards, as far as it ever goes.
    """

    vertices: list[int]
    peaks: Bools
    directions: Floats
    pockets: Numbers
    levels: Floats


class NotClosedError(UnfoldableError):
    """A molecule does not close; ``stretches``: those of its border that what failed comes from."""

    def __init__(self, message: str, stretches: set[int]) -> None:
        super().__init__(message)
        self.stretches = stretches


class Molecule:
    """The facets of a molecule and their order from top to bottom, going around from the root.

    Facet k begins at the border between turns k and k + 1. ``sign`` is +1 when heights count upwards; ``limit`` is
    where an unbounded molecule ends, None for a bounded one; ``size`` is what ties are relative to; ``turned``: the
    pockets, as bits, that are folded with the tree over the peaks. ``lowest_event``: the height in mm up to which
    nothing happens, the room for a ribbon; ``border_facets``: how many facets begin at the border; ``middles``: see
    there; ``parts``: the outlines of the bounded parts that it falls into, where they begin, and the number of the part
    that each was of, or -1. Raises ``NotClosedError`` when the molecule does not close, and ``CreaseTooShortError`` as
    soon as a gusset has a crease shorter than ``least`` mm.
    """

    def __init__(
        self,
        vertices: Vertices,
        border: Border,
        *,
        sign: int,
        limit: float | None,
        size: float,
        turned: int = 0,
        least: float = 0.0,
        progress: Callable[[float], None] | None = None,
    ) -> None:
        self.vertices = vertices
        self.sign = sign
        self.limit = math.inf if limit is None else limit
        count = self.border_facets = len(border.vertices)
        self.tie = (TIE if count <= MANY else SMALL_TIE) * size
        self.turned = turned
        self.least = least
        self.gussets = 0
        self.middles: list[Middle] = []
        self.parts: list[tuple[Floats, int]] = []
        self._levels = dict(zip(border.levels.tolist(), border.vertices, strict=True))
        self.lowest_event = math.inf
        self._places: dict[tuple[int, int], list[int]] = {}  # this molecule's vertices, by small squares
        self.origin = list(range(count))  # of each facet, a facet at the border that it comes from
        self.facets = [_Facet([a], [b]) for a, b in zip(border.vertices, _after(border.vertices), strict=True)]
        self._order = _Order(count)
        turns = [
            _Turn(
                np.array(vertices.flat[v]),
                0.0,
                vertices.folded[v][0],
                bool(border.peaks[k]),
                border.directions[k - 1],
                border.directions[k],
                (k - 1) % count,
                k,
                v,
                int(border.pockets[k]),
                float(border.levels[k]),
            )
            for k, v in enumerate(border.vertices)
        ]
        self._table = Table()
        self._many = count > MANY and not turned
        stack = [_Part(turns, 0.0, limit is not None)]
        steps = 0
        while stack:
            part = stack.pop()
            stack += self._numbered(self._step(part), part)
            steps += 1
            if steps > 50 * count + 100:
                raise self._lost(part, "no end of events", [])
            if progress is not None and steps % REPORT == 0:
                progress(min(1.0, 2 * self.gussets / count))
        self.order = self._order.list()

    def _numbered(self, parts: list[_Part], whole: _Part) -> list[_Part]:
        """Number what a part has become, and keep the outlines of what it has fallen into.

        Of a large part pieces come off, one after the other: what is left of it is still that part.
        """
        for part in parts:
            part.number = whole.number
            part.patience = max(0, whole.patience - 1)
            if len(parts) > 1 and not part.unbounded and not (self._many and len(part.turns) > FEW):
                part.number = len(self.parts)
                self.parts.append((np.array([turn.position for turn in part.turns]), whole.number))
        return parts

    def rings(self) -> list[list[int]]:
        """The outlines of the facets, by facet number; not to be changed."""
        return self._rings

    @cached_property
    def _rings(self) -> list[list[int]]:
        return [facet.ring() for facet in self.facets]

    def _facet(self, start: int, end: int, beside: int) -> int:
        self.origin.append(self.origin[beside])
        self.facets.append(_Facet([start], [end]))
        return len(self.facets) - 1

    def _lost(self, part: _Part, why: str, turns: list[_Turn]) -> NotClosedError:
        x, y = part.turns[0].position
        message = f"the molecule of {len(part.turns)} turns near ({x:.3f}, {y:.3f}) mm: {why}"
        return NotClosedError(message, self.stretches({facet for t in turns for facet in (t.before, t.after)}))

    def stretches(self, facets: set[int]) -> set[int]:
        """Stretches of the border that some facets come from, as they follow each other around the inside."""
        border = {self.origin[facet] for facet in facets}
        return border if self.sign > 0 else {self.border_facets - 1 - facet for facet in border}

    def _step(self, part: _Part) -> list[_Part]:
        """Move a part up to its next event and return what becomes of it."""
        if len(part.turns) == 2:
            self._raise(part, _State(part, self.turned, self._table), 0.0)
            return []
        if self._many and len(part.turns) > FEW and not part.patience:
            parts = self._queued(part)
            if parts:
                return parts
            part.patience = PATIENCE
        state = _State(part, self.turned, self._table)
        for k, turn in enumerate(part.turns):
            if turn.spike:
                return [self._zip(part, state, k)]
        collapse = state.next_collapse(self.tie)
        if collapse > 0 and (pair := state.coincident(self.tie)):
            return self._pinch(part, state, *pair)
        crossing = state.next_crossing(self.tie)
        gusset = state.next_gusset(min(collapse, crossing, self.limit - part.height), self.tie)
        if gusset is None and crossing < collapse and part.height + crossing <= self.limit:
            return [_Part(part.turns, part.height + crossing, part.unbounded, part.near)]
        event = part.height + (collapse if gusset is None else gusset.time)
        self.lowest_event = min(self.lowest_event, event)
        if event > self.limit:
            self._raise(part, state, self.limit - part.height)
            return []
        if gusset is not None:
            return self._split(part, state.positions(gusset.time), state.images(gusset.time), gusset)
        if not math.isfinite(collapse):
            raise self._lost(part, "no event", [])
        return self._collapse(part, state, collapse)

    def _queued(self, part: _Part) -> list[_Part]:
        """Do the same by the queue of a part's events; nothing where it cannot tell what is next."""
        queue, part.queue = part.queue, None
        if queue is None and Queue.fits(self._table, part.turns):
            queue = Queue(self._table, part.turns, part.height, self.limit, self.tie)
        gusset = None if queue is None else queue.next_gusset(part.height)
        if queue is None or gusset is None:
            return []
        height = part.height + gusset.time
        self.lowest_event = min(self.lowest_event, height)
        parts = self._split(part, *queue.places(gusset, part.height), gusset)
        larger = queue.split(gusset, height, parts[0].turns, parts[1].turns)
        if larger >= 0:
            parts[larger].queue = queue
        return parts

    def _vertex_at(self, position: Floats, x: float, height: float) -> int:
        """The vertex of this molecule at a place, or a new one; events at one place share it."""
        at_x, at_y = float(position[0]), float(position[1])
        # squares of some ties: what is within one tie is in the same or the next
        tie, size, floor = self.tie, 8 * self.tie, math.floor
        column, last_column = floor((at_x - tie) / size), floor((at_x + tie) / size)
        row, last_row = floor((at_y - tie) / size), floor((at_y + tie) / size)
        latest = -1
        for square in (
            ((column, row),)
            if column == last_column and row == last_row
            else [(c, r) for c in range(column, last_column + 1) for r in range(row, last_row + 1)]
        ):
            for number in self._places.get(square, ()):
                there = self.vertices.flat[number]
                if abs(there[0] - at_x) <= tie and abs(there[1] - at_y) <= tie:
                    latest = max(latest, number)
        if latest < 0:
            latest = self.vertices.add(position, (float(x), self.sign * height))
            square = floor(at_x / size), floor(at_y / size)
            self._places.setdefault(square, []).append(latest)
        return latest

    def _push(self, turn: _Turn, vertex: int) -> None:
        """Let a turn's trajectory go on to ``vertex``."""
        for chain in (self.facets[turn.before].end, self.facets[turn.after].start):
            if chain[-1] != vertex:
                chain.append(vertex)
        turn.vertex = vertex

    def _raise(self, part: _Part, state: _State, time: float) -> None:
        """Let all turns go on to the same height, and end there."""
        for turn, position, x in zip(part.turns, state.positions(time), state.images(time), strict=True):
            self._push(turn, self._vertex_at(position, x, part.height + time))

    def _joined(self, run: list[_Turn], position: Floats, x: float, height: float) -> _Turn:
        """The one turn that is left of some in a row that have met, the outer of which are of one kind."""
        vertex = self._vertex_at(position, x, height)
        for turn in run:
            self._push(turn, vertex)
        first, last = run[0], run[-1]
        pockets = 0
        for turn in run:
            pockets |= turn.pockets
        return _Turn(
            position,
            height,
            x,
            first.peak,
            first.arriving,
            last.leaving,
            first.before,
            last.after,
            vertex,
            pockets,
            _outermost(run),
        )

    def _collapse(self, part: _Part, state: _State, time: float) -> list[_Part]:
        """Join the turns between which there is nothing left."""
        turns, height = part.turns, part.height + time
        position, x = state.positions(time), state.images(time)
        gone = state.lengths(time) <= self.tie
        count = len(turns)
        if gone.sum() >= count - 1:
            self._raise(part, state, time)
            return []
        start = int(np.flatnonzero(~gone)[0]) + 1  # the first turn of a run
        runs: list[list[int]] = []
        for n in range(count):
            k = (start + n) % count
            if n and gone[k - 1]:
                runs[-1].append(k)
            else:
                runs.append([k])
        left: list[_Turn] = []
        cut = 0
        for run in runs:
            if len(run) % 2 == 0:
                raise self._lost(part, "a flap has no length left", [turns[k] for k in run])
            if 0 in run:
                cut = len(left)
            if len(run) == 1:
                left.append(turns[run[0]])
            else:
                middle = position[run].mean(axis=0)
                left.append(self._joined([turns[k] for k in run], middle, float(x[run].mean()), height))
        return [_Part(left[cut:] + left[:cut], height, part.unbounded, part.near)]

    def _zip(self, part: _Part, state: _State, k: int) -> _Part:
        """The sides at a spike lie on each other: join them along a ridge up to the turns next to it."""
        turns, count = part.turns, len(part.turns)
        before, after = (k - 1) % count, (k + 1) % count
        position, length = state.positions(0.0), state.lengths(0.0)
        x = state.images(0.0)
        if abs(length[before] - length[k]) > self.tie:
            raise self._lost(part, "turns do not match along a ridge", [turns[before], turns[k], turns[after]])
        self._push(turns[k], self._vertex_at(position[k], x[k], part.height))
        place = (position[before] + position[after]) / 2
        joined = self._joined([turns[before], turns[after]], place, float(x[before]), part.height)
        rest = [turns[(after + n) % count] for n in range(1, count - 2)]
        ring = [joined, *rest]
        cut = 0 if {before, k, after} & {0} else ring.index(turns[0])
        return _Part(ring[cut:] + ring[:cut], part.height, part.unbounded, part.near)

    def _split(
        self, part: _Part, position: Floats | dict[int, Floats], x: Floats | dict[int, float], gusset: Gusset
    ) -> list[_Part]:
        r"""Split a part along the crease between turns i and j, which wraps the turns between them.

        ``position`` and ``x``: where these turns, and the one where the tree's path turns, are by then.

        ::

              i --- m --- j        the perpendicular crease through m is where the tree's path turns; if it does not,
                                   i is the path's one end and j the other, and there is no m
        """
        turns, height = part.turns, part.height + gusset.time
        i, j = gusset.first, gusset.last
        one, other = turns[i], turns[j]
        self.gussets += 1
        for k in (i, j):
            self._push(turns[k], self._vertex_at(position[k], x[k], height))
        along = (position[j] - position[i]) / math.dist(position[i], position[j])
        far_i, far_j = (abs(float(x[k]) - gusset.x) for k in (i, j))
        middle: _Turn | None = None
        if min(far_i, far_j) > self.tie:
            if one.peak != other.peak:
                raise self._lost(part, "a gusset between a peak and a valley", [one, other])
            place = position[i] + along * far_i
            vertex = self._vertex_at(place, gusset.x, height)
            if min(far_i, far_j) < self.least:
                end, length = (i, far_i) if far_i <= far_j else (j, far_j)
                middle_x, middle_y = ((position[end] + place) / 2).tolist()
                raise CreaseTooShortError("the crease of a gusset is too short", length, (middle_x, middle_y))
            lowest = turns[gusset.at]
            level = self._levels[lowest.level] if abs(float(x[gusset.at]) - gusset.x) > self.tie else None
            self.middles.append(Middle(vertex, lowest.before, lowest.after, position[gusset.at], level))
            # after j, before i
            wrapped = [self._facet(other.vertex, vertex, other.before), self._facet(vertex, one.vertex, one.after)]
            # after i, before j
            around = [self._facet(one.vertex, vertex, one.before), self._facet(vertex, other.vertex, other.after)]
            self._order.insert([around[0], wrapped[1]], self._order.before[one.after], one.after)
            self._order.insert([wrapped[0], around[1]], other.before, self._order.after[other.before])
            middle = _Turn(
                place, height, gusset.x, not one.peak, along, along, around[0], around[1], vertex, 0, gusset.x
            )
        else:
            if one.peak == other.peak:
                raise self._lost(part, "a flap has no length left", [one, other])
            wrapped = [self._facet(other.vertex, one.vertex, one.after)] * 2
            around = [self._facet(one.vertex, other.vertex, one.before)] * 2
            if far_i <= self.tie:
                self._order.insert([wrapped[0], around[1]], other.before, self._order.after[other.before])
            else:
                self._order.insert([around[0], wrapped[1]], self._order.before[one.after], one.after)

        def turn(k: int, arriving: Floats, leaving: Floats, before: int, after: int) -> _Turn:
            old = turns[k]
            return _Turn(
                position[k],
                height,
                float(x[k]),
                old.peak,
                arriving,
                leaving,
                before,
                after,
                old.vertex,
                old.pockets,
                old.level,
            )

        count = len(turns)
        between = [turns[k % count] for k in range(i + 1, j if j > i else j + count)]
        inner = [turn(i, -along, one.leaving, wrapped[1], one.after), *between]
        inner.append(turn(j, other.arriving, -along, other.before, wrapped[0]))
        if middle is not None:
            inner.insert(
                0,
                _Turn(
                    middle.position,
                    height,
                    middle.x,
                    middle.peak,
                    -along,
                    -along,
                    wrapped[0],
                    wrapped[1],
                    vertex,
                    0,
                    gusset.x,
                ),
            )
        elif far_i > self.tie:
            inner.insert(0, inner.pop())
        last, first = (
            turn(i, one.arriving, along, one.before, around[0]),
            turn(j, along, other.leaving, around[1], other.after),
        )
        new = [last, first] if middle is None else [last, middle, first]
        if i < j:
            outer = turns  # nobody needs the old list: a new one of many turns for each gusset would take long
            outer[i : j + 1] = new
        else:
            outer = [new[-1], *turns[1:i], *new[:-1]]
        return self._parts(inner, outer, height, part)

    def _parts(self, inner: list[_Turn], outer: list[_Turn], height: float, whole: _Part) -> list[_Part]:
        """What a part falls into; the turning number tells the unbounded one from a pocket."""
        fewer = min(inner, outer, key=len)
        unbounded = sum(math.pi - turn.angle for turn in fewer) < 0
        return [
            _Part(turns, height, whole.unbounded and (turns is fewer) == unbounded, whole.near)
            for turns in (inner, outer)
        ]

    def _pinch(self, part: _Part, state: _State, i: int, j: int) -> list[_Part]:
        """Two turns i < j that are not neighbours meet in a point: the part falls in two, and no crease is needed."""
        turns, height = part.turns, part.height
        one, other = turns[i], turns[j]
        place, x = state.positions(0.0)[i], float(state.images(0.0)[i])
        vertex = self._vertex_at(place, x, height)
        self._push(one, vertex)
        self._push(other, vertex)

        def joined(last: _Turn, first: _Turn) -> _Turn:
            return _Turn(
                place,
                height,
                x,
                first.peak,
                last.arriving,
                first.leaving,
                last.before,
                first.after,
                vertex,
                0,
                _outermost([first, last]),
            )

        inner = [joined(other, one), *turns[i + 1 : j]]
        outer = [*turns[:i], joined(one, other), *turns[j + 1 :]]
        return self._parts(inner, outer, height, part)


@dataclass(frozen=True, eq=False)
class Middle:
    """The vertex of a gusset crease where its path in the tree turns: it lands where another turn has come to.

    ``position`` ``(2,)`` mm: where that turn was at the time; ``before``, ``after``: the facets on either side of it.
    ``level``: the border's vertex of the turn that it keeps its distance from instead, if it lands on a level.
    """

    vertex: int
    before: int
    after: int
    position: Floats
    level: int | None


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


def _outermost(turns: list[_Turn]) -> float:
    """The level of the outermost of some turns, of those of the first one's kind."""
    levels = [turn.level for turn in turns if turn.peak == turns[0].peak]
    return max(levels) if turns[0].peak else min(levels)


def _after(numbers: list[int]) -> list[int]:
    return numbers[1:] + numbers[:1]
