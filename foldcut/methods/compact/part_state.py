"""A part of a molecule on its way up, and what happens to it next.

``Part`` -> ``PartState`` -> the next ``Event``.

The inside of a shape, or its outside, is one *part* to begin with: a polygon whose corners are turns. Insetting it
moves all turns at once until something happens. The events, in order of precedence where they fall together:

- ``Zip``: the two sides at a turn lie on each other, so the part has no width there; they are joined along a ridge.
- ``Pinch``: two turns that are not neighbours are in one point; the part falls in two.
- ``Collapse``: stretches of the border shrink to nothing.
- ``Crossing``: two dips, or two crests, pass each other's image. The part stays as it is, but paths bend elsewhere.
- ``Gusset``: two turns come as near to each other as their path; a crease between them splits the part.
- ``End``: the part has reached the height where an unbounded molecule ends, or is only a ridge between two turns.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Bools, Floats, Numbers
from foldcut.methods.compact.event_queue import EventQueue
from foldcut.methods.compact.gusset_pairs import NearPairs, Pairs, all_pairs, few_pairs, near_pairs
from foldcut.methods.compact.motion import Gusset, Meetings, Motion, Turn, TurnTable, crosses, looks_inside

Place = tuple[float, float, float]
"""A place on the sheet, and an image, in mm."""


@dataclass(frozen=True)
class Thresholds:
    """How many turns decide by what means a part's next event is found. By none of them does another event come next.

    ``one_by_one``: up to so many, pairs are looked at one by one. ``near_only``: beyond, only pairs of turns that are
    near each other are looked at. ``queued``: borders with more have their events queued as far as possible; that is
    more turns than any search finds. ``patience``: how many events a part is spared the queue after that has failed.
    """

    one_by_one: int = 12
    near_only: int = 100
    queued: int = 500
    patience: int = 10


THRESHOLDS = Thresholds()


@dataclass
class Part:
    """A polygon on its way up: its turns counter-clockwise from the one where the list of its layers is cut.

    ``unbounded``: whether it is what is left of the plane outside its border. ``number``: in ``Molecule.parts``, or -1.
    ``near``: what is known of its pairs of turns, if it has many; ``queue``: its events to come, if they are queued;
    ``patience``: for how many events they are not.
    """

    turns: list[Turn]
    height: float
    unbounded: bool
    near: NearPairs | None = None
    number: int = -1
    queue: EventQueue | None = None
    patience: int = 0


@dataclass(frozen=True)
class Zip:
    """The two sides at ``turn`` lie on each other."""

    turn: int


@dataclass(frozen=True)
class Pinch:
    """Turns ``first`` < ``last`` are in one point."""

    first: int
    last: int


@dataclass(frozen=True)
class Collapse:
    """Stretches of the border have shrunk to nothing after a time."""

    time: float


@dataclass(frozen=True)
class Crossing:
    """Two dips or two crests pass each other's image after a time."""

    time: float


@dataclass(frozen=True)
class End:
    """All turns go on for a time, and end there."""

    time: float


Event = Zip | Pinch | Collapse | Crossing | Gusset | End


class PartState(Motion):
    """A part's turns as arrays, at its own height; ``turned``: the turned pockets of the molecule, as bits."""

    def __init__(self, part: Part, turned: int, table: TurnTable, thresholds: Thresholds = THRESHOLDS) -> None:
        self.part, self.table, self.thresholds = part, table, thresholds
        turns = part.turns
        self.numbers = table.numbers(turns)
        super().__init__(table.rows(self.numbers), part.height)
        self.crest = self.up > 0
        self.after = np.arange(1, len(turns) + 1)
        self.after[-1] = 0
        self.turned = np.zeros(len(turns), dtype=np.int64)
        if turned:
            self.turned = np.array([t.pockets for t in turns]) & turned

    def next_event(self, limit: float, tie: float) -> Event | None:
        """Return what happens next up to the height ``limit``; None if nothing ever does, and the part never closes.

        Places and images that differ by no more than ``tie`` mm are equal.
        """
        height, turns = self.part.height, self.part.turns
        if len(turns) == 2:
            return End(0.0)
        for k, turn in enumerate(turns):
            if turn.spike:
                return Zip(k)
        collapse = self.next_collapse(tie)
        if collapse > 0 and (pair := self.coincident(tie)):
            return Pinch(*pair)
        crossing = self.next_crossing(tie)
        gusset = self.next_gusset(min(collapse, crossing, limit - height), tie)
        if gusset is None and crossing < collapse and height + crossing <= limit:
            return Crossing(crossing)
        if height + (collapse if gusset is None else gusset.time) > limit:
            return End(limit - height)
        if gusset is not None:
            return gusset
        return Collapse(collapse) if math.isfinite(collapse) else None

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
        """When the next of two dips, or of two crests, passes the other's image, so that paths bend elsewhere."""
        if not (self.level_slope[~self.crest].any() or self.turned.any()):
            return math.inf
        best = math.inf
        for kind in (self.crest, ~self.crest) if self.turned.any() else (~self.crest,):
            # many dips are of one hub
            x, slope = np.unique(np.stack([self.level[kind], self.level_slope[kind]]), axis=1)
            apart, closing = x[:, None] - x, slope - slope[:, None]
            with np.errstate(all="ignore"):
                time = np.where((apart > tie) & (closing > 0), apart / closing, np.inf)
            best = min(best, float(time.min(initial=np.inf)))
        return best

    def coincident(self, tie: float) -> tuple[int, int] | None:
        """Two turns, not neighbours, that are in the same place now, both on the sheet and when folded."""
        few = len(self.x) <= self.thresholds.one_by_one
        return (coincident_of_few if few else coincident_of_many)(self.position, self.x, self.crest, tie)

    def pairs(self, tie: float, until: float) -> Pairs:
        """The pairs of turns that may make a gusset within a time."""
        bent = np.abs(self.shrink) > 1e-12
        ends, turned_ends = self.crest | bent, ~self.crest | bent
        # turn 0 is a leaf of the tree, too, when no other is as low
        ends[0] |= bool((self.x[1:] > self.x[0] + tie).all())
        count = len(self.x)
        if not self.turned.any():
            if count > self.thresholds.near_only:
                return near_pairs(self.level, ends, self._near(until))
            if count <= self.thresholds.one_by_one:
                return few_pairs(self.level, ends)
        return all_pairs(self.level, ends, self.turned, turned_ends)

    def _near(self, until: float) -> Numbers:
        """The places of pairs that may come too near within a time; what is found on the way is kept in the part."""
        near, height, newest = self.part.near, self.part.height, self.table.count
        if near is None or height + until > near.until:
            near = NearPairs.find(self, self.numbers, height, until, newest)
        else:
            near = near.with_new(self, self.numbers, height, newest)
        place = np.full(newest, -1)
        place[self.numbers] = np.arange(len(self.numbers))
        self.part.near, here = near.up_to(height + until, place)
        return here

    def next_gusset(self, before: float, tie: float) -> Gusset | None:
        """The first pair of turns that comes as near as its path before the given time."""
        if len(self.x) < 4 or (self.part.unbounded and (self.shrink <= 0).all()):
            return None  # around a convex polygon no two turns see each other
        i, j, bend = self.pairs(tie, before)
        sign = np.where((self.turned[i] & self.turned[j]) != 0, -1.0, 1.0)
        meetings = Meetings(self, i, j, bend, sign, tie)
        for n in meetings.before(before):
            time = float(meetings.time[n])
            if self.sees(time, int(i[n]), int(j[n])):
                return Gusset(time, int(i[n]), int(j[n]), int(bend[n]), meetings.x(n))
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


def coincident_of_few(position: Floats, x: Floats, crest: Bools, tie: float) -> tuple[int, int] | None:
    """Return the first two turns of one kind, not neighbours, in one place with one image, by looking at every pair.

    ``position`` ``(n, 2)``, ``x`` and ``crest`` ``(n,)``.
    """
    count = len(x)
    crests = crest.tolist()
    places: list[Place] = list(zip(*position.T.tolist(), x.tolist(), strict=True))
    for i in range(count - 2):
        at_x, at_y, image = places[i]
        for j in range(i + 2, count if i else count - 1):
            other_x, other_y, other_image = places[j]
            if (
                abs(at_x - other_x) <= tie
                and abs(at_y - other_y) <= tie
                and abs(image - other_image) <= tie
                and crests[i] == crests[j]
            ):
                return i, j
    return None


def coincident_of_many(position: Floats, x: Floats, crest: Bools, tie: float) -> tuple[int, int] | None:
    """Return the same, by looking only at turns that some line's direction does not tell apart."""
    along = position @ (0.8, 0.6)
    order = np.argsort(along)
    equal = np.diff(along[order]) <= 2 * tie
    some = np.unique(np.concatenate([order[:-1][equal], order[1:][equal]]))
    at_x, at_y = position[some].T
    near = np.abs(at_x[:, None] - at_x) <= tie
    near &= np.abs(at_y[:, None] - at_y) <= tie
    near &= np.abs(x[some][:, None] - x[some]) <= tie
    for i, j in some[np.argwhere(np.triu(near, 1))].tolist():
        if j > i + 1 and (i or j < len(x) - 1) and crest[i] == crest[j]:
            return i, j
    return None


def outermost(turns: Sequence[Turn]) -> float:
    """Return the level of the outermost of some turns, of those of the first one's kind."""
    levels = [turn.level for turn in turns if turn.crest == turns[0].crest]
    return max(levels) if turns[0].crest else min(levels)
