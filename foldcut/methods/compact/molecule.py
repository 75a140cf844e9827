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
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from foldcut.core.arrays import Bools, Floats, Numbers
from foldcut.core.errors import CreaseTooShortError, UnfoldableError
from foldcut.methods.compact.event_queue import Queue
from foldcut.methods.compact.facets import Vertices, _Facet, _Order
from foldcut.methods.compact.motion import Gusset, Table
from foldcut.methods.compact.part_state import FEW, _Part, _State, _Turn

# Distances that differ by less than this part of the shape's size are equal.
TIE = 1e-9
# The same for borders of many turns: so many are so near each other, by chance, that fewer must count as equal.
SMALL_TIE = 3e-11
# Borders of more turns than this have their events queued as far as that can be: more than any search finds.
MANY = 500
# Steps by the simple code before a queue is tried again.
PATIENCE = 10
# Gussets between two reports of progress.
REPORT = 200


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


def _outermost(turns: list[_Turn]) -> float:
    """The level of the outermost of some turns, of those of the first one's kind."""
    levels = [turn.level for turn in turns if turn.peak == turns[0].peak]
    return max(levels) if turns[0].peak else min(levels)


def _after(numbers: list[int]) -> list[int]:
    return numbers[1:] + numbers[:1]
