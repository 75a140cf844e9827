"""The search for an outline within the tolerance that folds with few and long creases.

Outlines to begin with -> ``Assessment``s, better and better ones.

Nodes of the straight skeleton are tied together one after the other (``greedy``), as long as that makes the outline
cheaper; then corners are left out, put in, and moved at random, each time followed by ties (``anneal``).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from random import Random
from typing import NamedTuple

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.redraw.proxy import FITS, Assessment, Engine, Meeting, Tie

REACH = 10.0, 10.0
"""Ridges up to so many tolerances, and so many mm more, are tried to be shrunk to nothing."""

LEAST_GAIN = 0.05
"""A change that saves less than this is not made."""

LOOKS = (0.3, 1000), (0.25, 12), (0.35, 4)
"""The part of the work that is left for a look at outlines to begin with, and how many of the best get it."""

EARLY = 6, 0.03
"""From so many outlines to begin with, the cheapest one gets this part of the work before the others are made."""

HOPELESS = 1.8, 1.4
"""After the first and the second look a search is given up whose best outline costs so many times what is allowed."""

MORE_KEPT = 8
"""So many more may be the best so far, where those that look the best turn out to cost more."""

FAR_MISS = 0.6
"""Perpendiculars are moved to nodes that they miss by up to this part of the reach."""

MOST_TIES = 400
"""How many ties and meetings are tried in an outline at most."""

TIES_AFTER_A_CHANGE = 12
"""The same after a random change."""

FAR_OFF = 2.5
"""Outlines that are farther off than so many tolerances are not tightened."""

WORK_OF_A_SOLUTION, WORK_OF_A_TIGHTENED_ONE = 6, 10
"""How much work it is to move the corners, in assessments; and how much to tighten an outline."""

HOPEFUL = 15
"""A change that costs more than this is given up."""

MORE_FITS = 8
"""How many steps corners are fitted to the drawing after a change of their number."""


class Candidate(NamedTuple):
    """A tie or a meeting that would mend something; the less its ``weight``, the sooner it is tried."""

    weight: float
    tie: Tie | None
    meeting: Meeting | None


class Outline(NamedTuple):
    """Corners ``(n, 2)`` of loops of some sizes, the ties that they keep, and for how many steps they are fitted."""

    points: Floats
    loop_sizes: tuple[int, ...]
    ties: list[Tie]
    fits: int = MORE_FITS


class Search:
    """A search in the field of an engine; ``best`` is the best outline so far; ``is_given_up``: it is hopeless.

    ``most``: how much work may be done. ``believe`` is asked for each outline that seems to be the best: it returns
    what has to be added to its cost. ``ends`` is told the part done now and then, and says whether to stop. Outlines
    that are too far off are tightened, unless ``tightens`` is false: then they are dropped. ``wanted``: what an outline
    may cost; a search that seems to end with far more is given up (``HOPELESS``).
    """

    def __init__(
        self,
        engine: Engine,
        most: int,
        seed: int = 0,
        believe: Callable[[Assessment], float] | None = None,
        ends: Callable[[float], bool] = lambda _: False,
        *,
        tightens: bool = True,
        wanted: float = math.inf,
    ) -> None:
        self.engine = engine
        self.wanted = wanted
        self.most = most
        self.random = Random(seed)
        self.believe = believe
        self.ends = ends
        self.far_off = FAR_OFF * engine.field.tolerance if tightens else engine.field.tolerance
        self.all = most
        self.best: Assessment | None = None
        self.last_gain = 0
        self.is_given_up = False
        self.promised = math.inf  # what the cheapest outline seemed to cost before it was folded
        self.refused: dict[str, float] = {}
        self.reach = REACH[0] * engine.field.tolerance + REACH[1]

    @property
    def spent(self) -> int:
        """How much of the search is done, in assessments."""
        engine = self.engine
        return engine.assessed + WORK_OF_A_SOLUTION * engine.solved + WORK_OF_A_TIGHTENED_ONE * engine.tightened

    @property
    def is_over(self) -> bool:
        """Whether all is spent, or nothing has become better for a third of that."""
        if self.spent >= self.most or (self.best is not None and self.spent - self.last_gain > self.all / 3):
            return True
        return self.ends(min(1.0, self.spent / self.all))

    def assess(self, points: Floats, loop_sizes: tuple[int, ...], most: float = math.inf) -> Assessment | None:
        """Assess an outline, with the details that moves need if it costs less than ``most``."""
        return self.engine.assess(points, loop_sizes, self.reach * FAR_MISS, most)

    def keep(self, one: Assessment) -> None:
        """Remember an outline if it is among the best."""
        if self.believe is not None and not one.is_believed and (self.best is None or one.key < self.best.key):
            self.promised = min(self.promised, one.cost)
            structure = str(one.structure)
            if structure in self.refused:
                one.cost += self.refused[structure]
            else:
                more = self.believe(one)
                one.cost += more
                if more > 0:
                    self.refused[structure] = more
            one.is_believed = True
        if self.best is None or one.key < self.best.key:
            self.best = one
            self.last_gain = self.spent

    def run(self, starts: Iterable[tuple[Floats, tuple[int, ...]]]) -> Assessment | None:
        """Search from some outlines; returns the best one."""
        begun: list[Assessment] = []
        for points, sizes in starts:
            if (one := self._begun(points, sizes)) is not None:
                begun.append(one)
                if len(begun) == EARLY[0] and self.believe is not None:
                    self._look_early(begun)
        if not begun:
            return None
        begun.sort(key=_promise)
        end, first = self.most, self.spent
        others: list[Assessment] = []
        for number_of_look, (share, few) in enumerate(LOOKS):
            begun.sort(key=lambda one: one.key)
            others, begun = begun[few:] + others, begun[:few]
            for number, one in enumerate(begun):
                self.most = first + int(share * (end - first) * (number + 1) / len(begun))
                begun[number] = self.greedy(one, MOST_TIES)
                if self.ends(min(1.0, self.spent / self.all)):
                    break
            first = self.spent
            self.keep(min(begun, key=lambda one: one.key))
            self.last_gain = first
            promised = min(self.promised, min(one.cost for one in begun))
            if number_of_look < len(HOPELESS) and promised > HOPELESS[number_of_look] * self.wanted:
                self.is_given_up = True
                return self.best
        self.most = end
        begun.sort(key=lambda one: one.key)
        for one in begun + others[:MORE_KEPT]:  # the latter where the former cannot be folded
            self.keep(one)
        self.last_gain = self.spent
        self.anneal(begun)
        return self.best

    def _look_early(self, begun: list[Assessment]) -> None:
        """Tie nodes of the cheapest outline so far, so that there soon is a first pattern."""
        number = min(range(len(begun)), key=lambda number: _promise(begun[number]))
        end = self.most
        self.most = self.spent + int(EARLY[1] * self.all)
        begun[number] = self.greedy(begun[number], MOST_TIES)
        self.most = end
        self.keep(begun[number])

    def _begun(self, points: Floats, sizes: tuple[int, ...]) -> Assessment | None:
        """Return an outline to begin with, tightened if it is farther off than the tolerance."""
        one = self.assess(points, sizes)
        if one is None or self.engine.is_good(points, sizes):
            return one
        if self.engine.deviation(points, sizes, self.far_off) > self.far_off:
            return None
        tight = self.engine.tighten(points, sizes, one.details.ties())
        if tight is None:
            tight = self.engine.tighten(points, sizes, [])
        return None if tight is None else self.assess(tight, sizes)

    def greedy(self, here: Assessment, tries: int) -> Assessment:
        """Add ties and meetings one after the other as long as that makes an outline cheaper."""
        refused: set[Tie | Meeting] = set()
        count = 0
        while count < tries and self.spent < self.most:
            found = None
            have, meetings = here.details.ties(), here.details.meetings()
            for candidate in candidates(here, self.reach):
                new = candidate.tie or candidate.meeting
                if new is None or new in refused:
                    continue
                refused.add(new)
                count += 1
                found = self._with(here, have, meetings, candidate)
                if found is not None or count >= tries or self.spent >= self.most:
                    break
            if found is None:
                break
            here = found
        return here

    def _with(
        self, here: Assessment, have: Sequence[Tie], meetings: Sequence[Meeting], new: Candidate
    ) -> Assessment | None:
        """Return the outline with one tie or meeting more if that is cheaper."""
        ties = list(have)
        if new.tie is not None:
            tie = set(new.tie)
            ties = [one for one in ties if not tie.issuperset(one)] + [new.tie]
        most = here.cost - LEAST_GAIN
        for kept in (meetings, ()) if meetings else ((),):
            wanted = [*kept, new.meeting] if new.meeting is not None else kept
            found, is_near = self._moved(Outline(here.points, here.loop_sizes, ties, FITS), wanted, most)
            if found is not None:
                return found
            if is_near:
                break
        return None

    def _moved(
        self, outline: Outline, meetings: Sequence[Meeting] = (), most: float = math.inf
    ) -> tuple[Assessment | None, bool]:
        """Return the outline moved so that ties and meetings hold, and whether that left it within the tolerance.

        It is None where that fails, or costs ``most`` or more. One that is too far off is tightened if it would cost
        less.
        """
        engine, (points, sizes, ties, fits) = self.engine, outline
        moved = engine.solve(points, sizes, ties, meetings, fits)
        if moved is None:
            return None, False
        tolerance = engine.field.tolerance
        off = engine.deviation(moved, sizes, self.far_off)
        if off > self.far_off:
            return None, False
        if off <= tolerance:
            found = self.assess(moved, sizes, most)
        else:
            found = engine.assess(moved, sizes)
            if found is not None and found.cost < most:
                tight = engine.tighten(moved, sizes, ties, meetings)
                found = None if tight is None else self.assess(tight, sizes, most)
        return found if found is not None and found.cost < most else None, off <= tolerance

    def anneal(self, starts: Sequence[Assessment]) -> None:
        """Leave out, put in and move corners at random, and tie again."""
        if not starts:
            return
        here = starts[0]
        others = list(starts[1:4])
        moves = (
            self._without_corner, self._with_corner_across, self._shaken, self._slid,
            self._without_sides, self._without_sides, self._with_bend, self._without_bend, self._with_side_shifted,
        )  # fmt: skip
        first = self.spent
        while not self.is_over:
            left = 1 - (self.spent - first) / max(1, self.most - first)
            move = moves[self.random.randrange(len(moves))]
            if others and self.random.random() < 0.002:
                here = others.pop(0)
            outline = move(here)
            before = self.spent
            found = self._realised(outline, here.cost + HOPEFUL) if outline is not None else None
            if found is None:
                if self.spent == before:
                    self.engine.assessed += 1  # a move that finds nothing is not for free
                continue
            found = self.greedy(found, TIES_AFTER_A_CHANGE)
            warmth = 1.5 * left
            gain = here.cost - found.cost
            if gain > 1e-9 or self.random.random() < math.exp((gain - 1e-9) / max(warmth, 1e-3)):
                here = found
                self.keep(here)

    def _realised(self, outline: Outline, most: float = math.inf) -> Assessment | None:
        """Return a changed outline with as many of its ties as can be had; None where it costs ``most`` or more."""
        for ties in (outline.ties, [])[: 1 + bool(outline.ties)]:
            found, _ = self._moved(outline._replace(ties=ties), most=most)
            if found is not None:
                return found
        return None

    # changes: each returns an outline, or None

    def _loop_of(self, sizes: tuple[int, ...], corner: int) -> tuple[int, int, int]:
        """Return a corner's loop, where it begins, and how many corners it has."""
        first = 0
        for number, size in enumerate(sizes):
            if corner < first + size:
                return number, first, size
            first += size
        raise IndexError(corner)

    def _without_corner(self, here: Assessment) -> Outline | None:
        """Leave out a corner, or a side whose neighbours are made longer until they meet."""
        corner = self.random.randrange(len(here.points))
        return self._without(here, [corner], here.details.ties(), chord=self.random.random() < 0.5)

    def _without_sides(self, here: Assessment) -> Outline | None:
        """Leave out the two sides that face each other across a ridge, and make their neighbours longer.

        Where those neighbours were matched across the same strip, they still are.
        """
        details = here.details
        inner = [ridge for ridge in details.ridges if ridge[0] >= details.corners and ridge[1] >= details.corners]
        if not inner:
            return None
        _, _, _, one, other = inner[self.random.randrange(len(inner))]
        ties = details.ties()
        gone = {one >> 1, other >> 1}
        beside = {
            (self._beside(here.loop_sizes, side >> 1, step), side & 1) for side in (one, other) for step in (-1, 1)
        }
        if len(gone) == 2 and not gone & {edge for edge, _ in beside}:
            ties = [*ties, tuple(sorted(2 * edge + flank for edge, flank in beside))]
        return self._without(here, sorted(gone, reverse=True), ties, chord=False)

    def _without_bend(self, here: Assessment) -> Outline | None:
        """Leave out the two corners of a bend of a strip: corners whose bisectors are one line."""
        details = here.details
        count = len(here.points)
        bends = []
        for node, tie in details.sides.items():
            if len(tie) == 4 and details.on_sheet[node]:
                edges = {side >> 1 for side in tie}
                corners = [edge for edge in edges if self._beside(here.loop_sizes, edge, -1) in edges]
                if len(corners) == 2:
                    bends.append(corners)
        if not bends or count < 8:
            return None
        corners = bends[self.random.randrange(len(bends))]
        return self._without(here, sorted(corners, reverse=True), details.ties(), chord=True)

    def _without(self, here: Assessment, gone: Sequence[int], ties: Sequence[Tie], *, chord: bool) -> Outline | None:
        """Leave out sides, or with ``chord`` corners, in descending order."""
        points, sizes = here.points, here.loop_sizes
        for corner in gone:
            loop, _, size = self._loop_of(sizes, corner)
            if size <= 3:
                return None
            if not chord:
                shortened = self._meeting_place(points, sizes, corner)
                if shortened is None:
                    return None
                points = points.copy()
                points[self._beside(sizes, corner, 1)] = shortened
            number = {side: side - (side > corner) for side in range(len(points)) if side != corner}
            ties = _renumbered(ties, number)
            sizes = tuple(n - (k == loop) for k, n in enumerate(sizes))
            points = np.delete(points, corner, axis=0)
        return Outline(points, sizes, list(ties))

    def _meeting_place(self, points: Floats, sizes: tuple[int, ...], corner: int) -> Floats | None:
        """Return where the sides before and after the one from a corner meet, None if that is far away."""
        before, after, beyond = (self._beside(sizes, corner, step) for step in (-1, 1, 2))
        one, other = points[corner] - points[before], points[beyond] - points[after]
        area = one[0] * other[1] - one[1] * other[0]
        if abs(area) <= 1e-6 * math.hypot(*one) * math.hypot(*other):
            return None
        away = points[after] - points[corner]
        part = (away[0] * other[1] - away[1] * other[0]) / area
        place: Floats = points[corner] + part * one
        if math.hypot(*(place - (points[corner] + points[after]) / 2)) > 15 * self.engine.field.tolerance:
            return None
        return place

    def _beside(self, sizes: tuple[int, ...], edge: int, step: int) -> int:
        """Return the edge, or the corner, so many steps from another one around its loop."""
        _, first, size = self._loop_of(sizes, edge)
        return first + (edge - first + step) % size

    def _with_bend(self, here: Assessment) -> Outline | None:
        """Put a corner into each of the two sides that face each other across a ridge, opposite each other."""
        details = here.details
        inner = [ridge for ridge in details.ridges if ridge[0] >= details.corners and ridge[1] >= details.corners]
        if not inner:
            return None
        a, b, _, one, other = inner[self.random.randrange(len(inner))]
        if one >> 1 == other >> 1:
            return None
        part = self.random.uniform(0.25, 0.75)
        x = details.x[a] + part * (details.x[b] - details.x[a])
        y = details.y[a] + part * (details.y[b] - details.y[a])
        points, sizes, ties = here.points, here.loop_sizes, details.ties()
        tie: set[int] = set()
        for side in sorted((one, other), reverse=True):
            edge = side >> 1
            loop, _, _ = self._loop_of(sizes, edge)
            start, end = points[edge], points[self._beside(sizes, edge, 1)]
            along = end - start
            u = float(((x, y) - start) @ along / (along @ along))
            if not 0.05 < u < 0.95:
                return None
            number = {k: k + (k > edge) for k in range(len(points))}
            ties = _renumbered(ties, number)
            tie = {2 * number[s >> 1] + (s & 1) for s in tie} | {side, side + 2}
            points = np.insert(points, edge + 1, start + u * along, axis=0)
            sizes = tuple(n + (k == loop) for k, n in enumerate(sizes))
        return Outline(points, sizes, [*ties, tuple(sorted(tie))])

    def _with_corner_across(self, here: Assessment) -> Outline | None:
        """Follow a corner's bisector to the side across, on either flank, and put a corner there."""
        points, sizes = here.points, here.loop_sizes
        corner = self.random.randrange(len(points))
        before, after = self._beside(sizes, corner, -1), self._beside(sizes, corner, 1)
        here_at = points[corner]
        one, other = points[before] - here_at, points[after] - here_at
        if not (one.any() and other.any()):
            return None
        one, other = one / math.hypot(*one), other / math.hypot(*other)
        bisector = one + other
        if math.hypot(*bisector) < 1e-6:
            bisector = np.array([-other[1], other[0]])
        bisector = bisector / math.hypot(*bisector) * (1 if self.random.random() < 0.5 else -1)
        start = points
        following = np.concatenate([np.roll(np.arange(a, a + n), -1) for a, n in _spans(sizes)])
        step = points[following] - start
        area = bisector[0] * -step[:, 1] + step[:, 0] * bisector[1]
        away = start - here_at
        with np.errstate(all="ignore"):
            reach = (away[:, 0] * -step[:, 1] + step[:, 0] * away[:, 1]) / area
            part = (bisector[0] * away[:, 1] - bisector[1] * away[:, 0]) / area
            hit = (reach > 2) & (part > 0.02) & (part < 0.98) & np.isfinite(reach)
        if not hit.any():
            return None
        side = int(np.flatnonzero(hit)[np.argmin(reach[hit])])
        if reach[side] > 100:
            return None
        place = points[side] + part[side] * step[side]
        loop, _, _ = self._loop_of(sizes, side)
        number = {k: k + (k > side) for k in range(len(points))}
        new = np.insert(points, side + 1, place, axis=0)
        ties = _renumbered(here.details.ties(), number)
        flanks = self._flanks_between(points, corner, before, side, here_at, place, following)
        if flanks is not None:
            near, far = flanks
            tie = {2 * number[before] + near, 2 * number[corner] + near, 2 * side + far, 2 * (side + 1) + far}
            ties = [*ties, tuple(sorted(tie))]
        return Outline(new, tuple(n + (k == loop) for k, n in enumerate(sizes)), ties)

    def _flanks_between(
        self, points: Floats, corner: int, before: int, side: int, here: Floats, there: Floats, following: Floats
    ) -> tuple[int, int] | None:
        """Return on which flank (0 left, 1 right) the way from a corner to a side leaves and arrives."""
        way = there - here
        into, out = points[corner] - points[before], points[int(following[corner])] - points[corner]
        left = into[0] * way[1] - into[1] * way[0] > 0
        also = out[0] * way[1] - out[1] * way[0] > 0
        convex = into[0] * out[1] - into[1] * out[0] > 0
        near = 0 if ((left and also) if convex else (left or also)) else 1
        along = points[int(following[side])] - points[side]
        far = 0 if along[0] * -way[1] - along[1] * -way[0] > 0 else 1
        return near, far

    def _shaken(self, here: Assessment) -> Outline | None:
        """Move one corner, or all, by a little."""
        size = self.engine.field.tolerance * self.random.choice((0.15, 0.4, 0.8))
        points = here.points.copy()
        which = [self.random.randrange(len(points))] if self.random.random() < 0.5 else range(len(points))
        for k in which:
            points[k] += (self.random.gauss(0, size), self.random.gauss(0, size))
        return Outline(points, here.loop_sizes, here.details.ties())

    def _with_side_shifted(self, here: Assessment) -> Outline | None:
        """Move a side sideways, its corners along the sides beside it; sometimes all that are parallel and nearby."""
        points, sizes = here.points.copy(), here.loop_sizes
        edge = self.random.randrange(len(points))
        before, after = self._beside(sizes, edge, -1), self._beside(sizes, edge, 1)
        beyond = self._beside(sizes, after, 1)
        along = points[after] - points[edge]
        length = math.hypot(*along)
        shift = self.engine.field.tolerance * self.random.uniform(-1, 1)
        normal = np.array([-along[1], along[0]]) / length
        moved = []
        for start, end in ((before, edge), (beyond, after)):
            way = points[end] - points[start]
            across = float(way @ normal)
            if abs(across) < 0.1 * math.hypot(*way):
                return None
            moved.append((end, points[end] + way * shift / across))
        for corner, place in moved:
            points[corner] = place
        return Outline(points, sizes, here.details.ties(), 0)

    def _slid(self, here: Assessment) -> Outline | None:
        """Move a corner along one of its sides."""
        points = here.points.copy()
        corner = self.random.randrange(len(points))
        other = self._beside(here.loop_sizes, corner, self.random.choice((-1, 1)))
        points[corner] += (points[other] - points[corner]) * self.random.uniform(-0.35, 0.35)
        return Outline(points, here.loop_sizes, here.details.ties(), self.random.choice((0, MORE_FITS)))


def _promise(one: Assessment) -> float:
    """Return less for outlines that are likely to become cheaper."""
    return one.cost + 0.7 * len(one.points)


def _spans(sizes: Sequence[int]) -> Iterator[tuple[int, int]]:
    first = 0
    for size in sizes:
        yield first, size
        first += size


def _renumbered(ties: Iterable[Tie], number: dict[int, int]) -> list[Tie]:
    """Return ties with their sides' edges renumbered, without sides that are gone and ties that then say nothing."""
    new = [tuple(sorted(2 * number[s >> 1] + (s & 1) for s in tie if s >> 1 in number)) for tie in ties]
    return [tie for tie in new if len(tie) > 3]


def candidates(here: Assessment, reach: float) -> list[Candidate]:
    """Return ties and meetings that would mend something, the most promising first."""
    d = here.details
    found: list[Candidate] = []
    corners = d.corners
    for a, b, length, _, _ in d.ridges:
        if a >= corners and b >= corners and length < reach:
            odd = d.degree[a] % 2 + d.degree[b] % 2
            tie = tuple(sorted({*d.sides[a], *d.sides[b]}))
            found.append(Candidate(length * (3.0, 2.5, 1.0)[odd], tie, None))
    for miss, path, step, node in d.misses:
        start, end, way, taken = d.paths[path]
        if node in (start, end) or start < corners or node not in d.sides or miss > FAR_MISS * reach:
            continue
        odd = d.degree[node] % 2
        weight = miss * ((1.2 if odd else 3.0) if taken else (0.6 if odd else 1.5))
        found.append(Candidate(weight, None, Meeting(d.sides[start], way[: step + 1], d.sides[node])))
    for start, end, way, taken in d.paths:
        if taken and len(way) > 1:
            for node, beyond in ((start, way[1]), (end, way[-2])):
                if node >= corners and beyond not in d.sides[node]:
                    found.append(Candidate(4.0, tuple(sorted({*d.sides[node], beyond})), None))
    found.sort(key=lambda one: one.weight)
    return found
