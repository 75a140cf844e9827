r"""The molecule with any number of corners: how a polygon is creased so that its whole border folds onto one line.

A walk around the border -> ``Molecule``. It is the gusset molecule for any number of corners. Lang calls it the
universal molecule (*Origami Design Secrets*), for convex polygons; here corners may be reflex, the polygon may be the
unbounded outside of a loop, and the tree that it is folded along may be any planar one.

Folded, the border goes to and fro on the cut line: it changes direction at its *turns*, alternately *crests* (x is
largest) and *dips* (x is smallest). Corners are turns; so are points on sides, from which a perpendicular crease goes
up. The border between two turns is a *stretch*. When the polygon is inset to the height h, its turns move along their
bisectors, and the stretches between them shrink. On the way up (see ``part_state`` for all that can happen),

- *collapse*: stretches of border shrink to nothing, all at one place; what is left there is one turn;
- *gusset*: two turns have come as near to each other as their images along the tree: the polygon splits along a
  crease between them;
- *pinch*: two turns that are not neighbours meet in a point, and the polygon falls in two.

Events at the same height need no special care: they follow each other at once and share their vertices.

The tree is what is left of a thin strip when places of the walk with the same x are joined across the dips between
them. The layers lie in the order of the walk, cut at one place, the *root*, where x is smallest; a gusset crease adds
its facets beside those of its ends. That is possible because it *wraps* a stretch of the walk that lies on one side of
it. In a *pocket*, a part of the outside between the shape and its convex hull, the same is true with crests for dips:
there the tree of the strip's other side may be taken. Such a pocket is *turned*.

Rabbit ear and gusset molecule are the cases k = 3 and k = 4 with all dips at x = 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from foldcut.core.arrays import Bools, Floats, Numbers
from foldcut.core.errors import CreaseTooShortError, UnfoldableError
from foldcut.methods.compact.event_queue import EventQueue
from foldcut.methods.compact.facets import Facet, LayerList, SharedVertices, Vertices
from foldcut.methods.compact.motion import Gusset, Motion, Turn, TurnTable
from foldcut.methods.compact.part_state import (
    THRESHOLDS,
    Collapse,
    Crossing,
    End,
    Part,
    PartState,
    Pinch,
    Thresholds,
    Zip,
    outermost,
)

TIE = 1e-9
"""Places and images that differ by less than this, as a part of the shape's size, are equal."""

SMALL_TIE = 3e-11
"""The same for borders of more than ``MANY`` turns: so many come nearer than ``TIE`` to each other by chance."""

MANY = 500
"""A border of more turns than this has the small tie."""

REPORT = 200
"""Events between two reports of progress."""


@dataclass(frozen=True, eq=False)
class Border:
    """The border of a molecule: its turns, counter-clockwise from the root.

    ``vertices``: their numbers. ``crests`` ``(n,)``: which of them are crests, alternately. ``directions`` ``(n, 2)``:
    unit vectors of the stretches after them. ``pockets`` ``(n,)``: the pockets that each belongs to, as bits.
    ``levels`` ``(n,)`` mm: where a gusset crease that wraps a turn lands while the turn's image moves outwards (a dip's
    down, a crest's up): as far out as that image ever comes.
    """

    vertices: list[int]
    crests: Bools
    directions: Floats
    pockets: Numbers
    levels: Floats


class NotClosedError(UnfoldableError):
    """A molecule does not close; ``stretches``: the stretches of its border that what failed comes from."""

    def __init__(self, message: str, stretches: set[int]) -> None:
        super().__init__(message)
        self.stretches = stretches


@dataclass(frozen=True, eq=False)
class Middle:
    """The vertex of a gusset crease where its path bends: it lands where another turn, the bend, has come to.

    ``position`` ``(2,)`` mm: where the bend was then; ``before``, ``after``: the facets on either side of the bend.
    ``level``: the vertex of the border whose ``Border.levels`` it lands on, if it lands on a level instead.
    """

    vertex: int
    before: int
    after: int
    position: Floats
    level: int | None


@dataclass(frozen=True, eq=False)
class Molecule:
    """The facets of a molecule, and their ``order`` from top to bottom, going around from the root.

    Facet k begins at the border between turns k and k + 1 for k < ``border_facets``; all others begin at a gusset
    crease. ``origin``: for each facet one at the border that it comes from. ``sign``: +1 when heights count upwards.
    ``lowest_event``: the height in mm up to which nothing happens, which is the room for a ribbon. ``gussets``: how
    many there are; ``middles``: of those whose path bends. ``parts``: of each bounded part that the molecule falls into
    the outline, ``(n, 2)`` mm, where the part begins, and the number of the part that it was split off from, or -1.
    """

    sign: int
    border_facets: int
    facets: list[Facet]
    origin: list[int]
    order: list[int]
    lowest_event: float
    gussets: int
    middles: list[Middle]
    parts: list[tuple[Floats, int]]

    def polygons(self) -> list[list[int]]:
        """The outlines of the facets, by facet number; not to be changed."""
        return self._rings

    @cached_property
    def _rings(self) -> list[list[int]]:
        return [facet.polygon() for facet in self.facets]

    def stretches(self, facets: set[int]) -> set[int]:
        """The stretches of the border that some facets come from, numbered counter-clockwise around the inside."""
        return _stretches(facets, self.origin, self.border_facets, self.sign)


def build_molecule(
    vertices: Vertices,
    border: Border,
    *,
    sign: int,
    limit: float | None,
    size: float,
    turned: int = 0,
    least: float = 0.0,
    progress: Callable[[float], None] | None = None,
    thresholds: Thresholds = THRESHOLDS,
) -> Molecule:
    """Build the molecule of a border; its vertices are added to ``vertices``.

    ``sign``: +1 when heights count upwards, else -1. ``limit`` mm: where an unbounded molecule ends; None for a bounded
    one. ``size`` mm: what ties are relative to. ``turned``: the turned pockets, as bits. ``progress`` is told how much
    is done, from 0 to 1. Raises ``NotClosedError`` when the molecule does not close, and ``CreaseTooShortError`` as
    soon as a gusset has a crease shorter than ``least`` mm.
    """
    builder = MoleculeBuilder(
        vertices, border, sign=sign, limit=limit, size=size, turned=turned, least=least, thresholds=thresholds
    )
    return builder.run(progress)


class MoleculeBuilder:
    """Builds a molecule event by event: ``step`` moves one part up to its next event and returns what becomes of it.

    Arguments are those of ``build_molecule``; ``first`` is the part that all begins with.
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
        thresholds: Thresholds = THRESHOLDS,
    ) -> None:
        count = self.border_facets = len(border.vertices)
        self.sign, self.turned, self.least, self.thresholds = sign, turned, least, thresholds
        self.limit = math.inf if limit is None else limit
        self.tie = (TIE if count <= MANY else SMALL_TIE) * size
        self.gussets = 0
        self.middles: list[Middle] = []
        self.parts: list[tuple[Floats, int]] = []
        self.lowest_event = math.inf
        self.origin = [*range(count)]
        after = border.vertices[1:] + border.vertices[:1]
        self.facets = [Facet([a], [b]) for a, b in zip(border.vertices, after, strict=True)]
        self.layers = LayerList(count)
        self.table = TurnTable()
        self.queued = count > thresholds.queued and not turned
        self.first = Part(_border_turns(vertices, border), 0.0, limit is not None)
        self._vertices = SharedVertices(vertices, self.tie, sign)
        self._levels = dict(zip(border.levels.tolist(), border.vertices, strict=True))

    def run(self, progress: Callable[[float], None] | None = None) -> Molecule:
        """Go on until nothing is left of any part, and return the molecule."""
        count = self.border_facets
        stack = [self.first]
        steps = 0
        while stack:
            part = stack.pop()
            stack += self._numbered(self.step(part), part)
            steps += 1
            if steps > 50 * count + 100:
                raise self._failure(part, "no end of events", [])
            if progress is not None and steps % REPORT == 0:
                progress(min(1.0, 2 * self.gussets / count))
        return Molecule(
            self.sign,
            count,
            self.facets,
            self.origin,
            self.layers.facets(),
            self.lowest_event,
            self.gussets,
            self.middles,
            self.parts,
        )

    def _numbered(self, parts: list[Part], whole: Part) -> list[Part]:
        """Number what a part has become, and keep the outlines of what it has fallen into.

        Of a part with a queue small pieces come off, one after the other: what is left of it is still that part.
        """
        for part in parts:
            part.number = whole.number
            part.patience = max(0, whole.patience - 1)
            if len(parts) > 1 and not part.unbounded and not self._may_queue(part):
                part.number = len(self.parts)
                self.parts.append((np.array([turn.position for turn in part.turns]), whole.number))
        return parts

    def _may_queue(self, part: Part) -> bool:
        return self.queued and len(part.turns) > self.thresholds.near_only

    def step(self, part: Part) -> list[Part]:
        """Move a part up to its next event and return what becomes of it."""
        if self._may_queue(part) and not part.patience:
            parts = self._queued_step(part)
            if parts:
                return parts
            part.patience = self.thresholds.patience
        state = PartState(part, self.turned, self.table, self.thresholds)
        event = state.next_event(self.limit, self.tie)
        if isinstance(event, (Collapse, Gusset)):
            self.lowest_event = min(self.lowest_event, part.height + event.time)
        match event:
            case Zip(turn):
                return [self._zip(part, state, turn)]
            case Pinch(first, last):
                return self._pinch(part, state, first, last)
            case Crossing(time):
                return [Part(part.turns, part.height + time, part.unbounded, part.near)]
            case Gusset():
                places = [event.first, event.last, event.bend]
                return self._split(part, state.positions(event.time)[places], state.images(event.time)[places], event)
            case Collapse(time):
                return self._collapse(part, state, time)
            case End(time):
                self._finish(part, state, time)
                return []
            case None:
                raise self._failure(part, "no event", [])

    def _queued_step(self, part: Part) -> list[Part]:
        """Do the same by the queue of a part's events; return nothing where it cannot tell what comes next."""
        queue, part.queue = part.queue, None
        if queue is None and EventQueue.fits(self.table, part.turns):
            queue = EventQueue(self.table, part.turns, part.height, self.limit, self.tie)
        gusset = None if queue is None else queue.next_gusset(part.height)
        if queue is None or gusset is None:
            return []
        height = part.height + gusset.time
        self.lowest_event = min(self.lowest_event, height)
        motion = queue.motion(gusset, part.height)
        parts = self._split(part, motion.positions(gusset.time), motion.images(gusset.time), gusset)
        larger = queue.split(gusset, height, parts[0].turns, parts[1].turns)
        if larger is not None:
            parts[larger].queue = queue
        return parts

    # --- what events do

    def _finish(self, part: Part, state: Motion, time: float) -> None:
        """Let all turns go on to the same height, and end there."""
        for turn, position, x in zip(part.turns, state.positions(time), state.images(time), strict=True):
            self._push(turn, self._vertices.at(position, x, part.height + time))

    def _collapse(self, part: Part, state: PartState, time: float) -> list[Part]:
        """Join the turns between which there is nothing left."""
        turns, height = part.turns, part.height + time
        position, x = state.positions(time), state.images(time)
        gone = state.lengths(time) <= self.tie
        if gone.sum() >= len(turns) - 1:
            self._finish(part, state, time)
            return []
        left: list[Turn] = []
        cut = 0
        for run in runs_of_turns(gone):
            if len(run) % 2 == 0:
                raise self._failure(part, "a flap has no length left", [turns[k] for k in run])
            if 0 in run:
                cut = len(left)
            if len(run) == 1:
                left.append(turns[run[0]])
            else:
                middle = position[run].mean(axis=0)
                left.append(self._joined([turns[k] for k in run], middle, float(x[run].mean()), height))
        return [Part(left[cut:] + left[:cut], height, part.unbounded, part.near)]

    def _zip(self, part: Part, state: PartState, k: int) -> Part:
        """The sides at a spike lie on each other: join them along a ridge up to the turns next to it."""
        turns, count = part.turns, len(part.turns)
        before, after = (k - 1) % count, (k + 1) % count
        position, length = state.positions(0.0), state.lengths(0.0)
        x = state.images(0.0)
        if abs(length[before] - length[k]) > self.tie:
            raise self._failure(part, "turns do not match along a ridge", [turns[before], turns[k], turns[after]])
        self._push(turns[k], self._vertices.at(position[k], x[k], part.height))
        place = (position[before] + position[after]) / 2
        joined = self._joined([turns[before], turns[after]], place, float(x[before]), part.height)
        rest = [turns[(after + n) % count] for n in range(1, count - 2)]
        polygon = [joined, *rest]
        cut = 0 if {before, k, after} & {0} else polygon.index(turns[0])
        return Part(polygon[cut:] + polygon[:cut], part.height, part.unbounded, part.near)

    def _pinch(self, part: Part, state: PartState, i: int, j: int) -> list[Part]:
        """Two turns i < j that are not neighbours meet in a point: the part falls in two, and no crease is needed."""
        turns, height = part.turns, part.height
        one, other = turns[i], turns[j]
        place, x = state.positions(0.0)[i], float(state.images(0.0)[i])
        vertex = self._vertices.at(place, x, height)
        self._push(one, vertex)
        self._push(other, vertex)

        def joined(last: Turn, first: Turn) -> Turn:
            return Turn(
                place,
                height,
                x,
                first.crest,
                last.arriving,
                first.leaving,
                last.before,
                first.after,
                vertex,
                pockets=0,
                level=outermost([first, last]),
            )

        inner = [joined(other, one), *turns[i + 1 : j]]
        outer = [*turns[:i], joined(one, other), *turns[j + 1 :]]
        return _fallen_in_two(inner, outer, height, part)

    def _split(self, part: Part, position: Floats, x: Floats, gusset: Gusset) -> list[Part]:
        r"""Split a part along the crease between turns i and j, which wraps the turns between them.

        ``position`` ``(3, 2)`` and ``x`` ``(3,)``: where i, j and the bend of their path are by then, and land. Returns
        the inner part, which is wrapped, and the outer one.

        ::

              i --- m --- j        the perpendicular crease through m is where the path bends; if it does not bend,
                                   i is the path's one end and j the other, and there is no m
        """
        turns, height = part.turns, part.height + gusset.time
        i, j = gusset.first, gusset.last
        one, other = turns[i], turns[j]
        self.gussets += 1
        for turn, place, image in ((one, position[0], x[0]), (other, position[1], x[1])):
            self._push(turn, self._vertices.at(place, image, height))
        along = (position[1] - position[0]) / math.dist(position[0], position[1])
        far_one, far_other = (abs(float(image) - gusset.x) for image in x[:2])
        bends = min(far_one, far_other) > self.tie
        if bends:
            if one.crest != other.crest:
                raise self._failure(part, "a gusset between a crest and a dip", [one, other])
            place = position[0] + along * far_one
            vertex = self._vertices.at(place, gusset.x, height)
            if min(far_one, far_other) < self.least:
                nearer, length = (position[0], far_one) if far_one <= far_other else (position[1], far_other)
                middle_x, middle_y = ((nearer + place) / 2).tolist()
                raise CreaseTooShortError("the crease of a gusset is too short", length, (middle_x, middle_y))
            self._note_middle(vertex, turns[gusset.bend], position[2], float(x[2]), gusset.x)
            wrapped, around = self._bent_gusset_facets(one, other, vertex)
        else:
            if one.crest == other.crest:
                raise self._failure(part, "a flap has no length left", [one, other])
            wrapped, around = self._straight_gusset_facets(one, other, one_is_bend=far_one <= self.tie)

        def end(k: int, old: Turn, arriving: Floats, leaving: Floats, before: int, after: int) -> Turn:
            image, vertex = float(x[k]), old.vertex
            return Turn(
                position[k], height, image, old.crest, arriving, leaving, before, after, vertex, old.pockets, old.level
            )

        def middle(direction: Floats, before: int, after: int) -> Turn:
            image, crest = gusset.x, not one.crest
            return Turn(place, height, image, crest, direction, direction, before, after, vertex, 0, level=image)

        count = len(turns)
        between = [turns[k % count] for k in range(i + 1, j if j > i else j + count)]
        inner = [end(0, one, -along, one.leaving, wrapped[1], one.after), *between]
        inner.append(end(1, other, other.arriving, -along, other.before, wrapped[0]))
        new = [
            end(0, one, one.arriving, along, one.before, around[0]),
            end(1, other, along, other.leaving, around[1], other.after),
        ]
        if bends:
            inner.insert(0, middle(-along, wrapped[0], wrapped[1]))
            new.insert(1, middle(along, around[0], around[1]))
        elif far_one > self.tie:
            inner.insert(0, inner.pop())
        if i < j:
            outer = turns  # nobody needs the old list: a new one of many turns for each gusset would take long
            outer[i : j + 1] = new
        else:
            outer = [new[-1], *turns[1:i], *new[:-1]]
        return _fallen_in_two(inner, outer, height, part)

    def _note_middle(self, vertex: int, bend: Turn, position: Floats, image: float, x: float) -> None:
        """Keep what the middle of a gusset crease that lands on ``x`` lands on: its bend, or that turn's level."""
        level: int | None = None
        if abs(image - x) > self.tie:
            level = self._levels.get(bend.level)
            if level is None:
                raise NotClosedError(f"no turn of the border has the level {bend.level:g} mm of a wrapped turn", set())
        self.middles.append(Middle(vertex, bend.before, bend.after, position, level))

    def _bent_gusset_facets(self, one: Turn, other: Turn, middle: int) -> tuple[list[int], list[int]]:
        """Add the four facets beside a gusset crease whose path bends at the vertex ``middle``.

        Returns two for the inner part, after j and before i, and two for the outer one, after i and before j.
        """
        wrapped = [self._facet(other.vertex, middle, other.before), self._facet(middle, one.vertex, one.after)]
        around = [self._facet(one.vertex, middle, one.before), self._facet(middle, other.vertex, other.after)]
        self.layers.insert_before(one.after, [around[0], wrapped[1]])
        self.layers.insert_after(other.before, [wrapped[0], around[1]])
        return wrapped, around

    def _straight_gusset_facets(self, one: Turn, other: Turn, *, one_is_bend: bool) -> tuple[list[int], list[int]]:
        """Add the two facets beside a gusset crease whose path does not bend; return each twice, as for one that does.

        They lie beside the facets of the end that is not the bend.
        """
        wrapped = self._facet(other.vertex, one.vertex, one.after)
        around = self._facet(one.vertex, other.vertex, one.before)
        if one_is_bend:
            self.layers.insert_after(other.before, [wrapped, around])
        else:
            self.layers.insert_before(one.after, [around, wrapped])
        return [wrapped] * 2, [around] * 2

    # --- what steps are made of

    def _facet(self, start: int, end: int, beside: int) -> int:
        """Add a facet that begins between two vertices, and comes from where another comes from."""
        self.origin.append(self.origin[beside])
        self.facets.append(Facet([start], [end]))
        return len(self.facets) - 1

    def _push(self, turn: Turn, vertex: int) -> None:
        """Let a turn's trajectory go on to ``vertex``."""
        for chain in (self.facets[turn.before].end, self.facets[turn.after].start):
            if chain[-1] != vertex:
                chain.append(vertex)
        turn.vertex = vertex

    def _joined(self, run: list[Turn], position: Floats, x: float, height: float) -> Turn:
        """The one turn that is left of some in a row that have met; the first and the last are of one kind."""
        vertex = self._vertices.at(position, x, height)
        for turn in run:
            self._push(turn, vertex)
        first, last = run[0], run[-1]
        pockets = 0
        for turn in run:
            pockets |= turn.pockets
        return Turn(
            position,
            height,
            x,
            first.crest,
            first.arriving,
            last.leaving,
            first.before,
            last.after,
            vertex,
            pockets,
            level=outermost(run),
        )

    def _failure(self, part: Part, why: str, turns: list[Turn]) -> NotClosedError:
        x, y = part.turns[0].position
        message = f"the molecule of {len(part.turns)} turns near ({x:.3f}, {y:.3f}) mm: {why}"
        facets = {facet for turn in turns for facet in (turn.before, turn.after)}
        return NotClosedError(message, _stretches(facets, self.origin, self.border_facets, self.sign))


def runs_of_turns(gone: Bools) -> list[list[int]]:
    """Return the turns in runs with no border left between them; ``gone`` ``(n,)``: stretches that are not left.

    The first run begins after the first stretch that is left; a run may go around the end of the border.
    """
    count = len(gone)
    start = int(np.flatnonzero(~gone)[0]) + 1
    runs: list[list[int]] = []
    for n in range(count):
        k = (start + n) % count
        if n and gone[k - 1]:
            runs[-1].append(k)
        else:
            runs.append([k])
    return runs


def _border_turns(vertices: Vertices, border: Border) -> list[Turn]:
    count = len(border.vertices)
    return [
        Turn(
            np.array(vertices.flat[v]),
            0.0,
            vertices.folded[v][0],
            bool(border.crests[k]),
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


def _fallen_in_two(inner: list[Turn], outer: list[Turn], height: float, whole: Part) -> list[Part]:
    """The two parts that a part falls into; the turning number tells the unbounded one from a pocket."""
    fewer = min(inner, outer, key=len)
    unbounded = sum(math.pi - turn.angle for turn in fewer) < 0
    return [
        Part(turns, height, whole.unbounded and (turns is fewer) == unbounded, whole.near) for turns in (inner, outer)
    ]


def _stretches(facets: set[int], origin: list[int], count: int, sign: int) -> set[int]:
    """The stretches of a border of ``count`` that facets come from, numbered counter-clockwise around the inside."""
    border = {origin[facet] for facet in facets}
    return border if sign > 0 else {count - 1 - facet for facet in border}
