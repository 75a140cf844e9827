"""A queue of the events to come in a part of many turns.

A part's border -> its next ``Gusset``, and the queue of the larger of the two parts that this leaves.

A gusset changes a part at two turns only, so looking at all turns again for each would take quadratic time. The queue
keeps what is known of all others: one heap tells when sides vanish, another when two crests come as near to each other
as their path in the tree; R-trees hold the boxes that crests' disks and sides stay within for some time ahead, and what
is new after an event is looked up in these. Heaps and trees only choose what is computed. It is computed by the
formulas of ``PartState``, so the queue finds what ``PartState`` finds, number for number.

All this needs dips whose images do not change, as those of touching disks do. Then a path's length changes at its ends
alone, and no two dips meet before the crests beside them have come too near to each other. Where that is not so, or
where something else than a gusset may come next, the queue finds nothing and ``PartState`` must look.

Invariants: a heap's entry is never later than the event it stands for; an entry whose turns have gone is skipped.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from heapq import heapify, heappop, heappush

import numpy as np

from foldcut.core.arrays import Floats, Numbers
from foldcut.methods.compact.growing_boxes import GrowingBoxes
from foldcut.methods.compact.motion import (
    LOST,
    Gusset,
    Meetings,
    Motion,
    Turn,
    TurnTable,
    crosses,
    looks_inside,
    positions_after,
)

Pair = tuple[int, int]
"""The numbers of two turns."""

MARGIN = 10.0
"""An event is looked at this many ties before it is due: far more than rounding makes of it."""

MOST_NEW = 300
"""Everything is looked up anew when this many turns have been added, and a part of all turns besides:"""

MOST_NEW_PART = 16
"""one for each this many of them."""


class PartBorder:
    """The border of a part, counter-clockwise from where its layers begin; turns by place and by number.

    ``turns`` and ``numbers`` ``(n,)``: in order. ``dips`` ``(n,)`` mm: the images of dips, infinite for crests.
    ``alive``, ``following``, ``place``, by number: whether a turn is on the border, the turn after it, and its place
    in the order, as of the last ``update_places``.
    """

    def __init__(self, table: TurnTable, turns: Sequence[Turn]) -> None:
        self.table, self.turns = table, turns
        self.numbers = table.numbers(turns)
        self._witness = -1

    def link(self, motion: Motion) -> None:
        """Set everything but the order, for turns that move so."""
        size = self.table.room
        self.alive = np.zeros(size, dtype=bool)
        self.alive[self.numbers] = True
        self.following = np.full(size, -1)
        self.following[self.numbers] = np.roll(self.numbers, -1)
        self.place = np.full(size, -1)
        self.dips = np.where(motion.up > 0, np.inf, motion.x)

    def update_places(self) -> None:
        """Set the turns' places in the order."""
        self.place[self.numbers] = np.arange(len(self.numbers))

    def lowest_is_shared(self) -> bool:
        """Whether another dip is as low as turn 0, so that no path in the tree ends at turn 0."""
        if self._witness < 0 or not self.alive[self._witness] or self._witness == self.numbers[0]:
            place = 1 + int(self.dips[1:].argmin())
            if self.dips[place] > self.dips[0]:
                return False
            self._witness = int(self.numbers[place])
        return True

    def bends(self, pairs: Numbers) -> Numbers:
        """The places of the bends of the paths between places ``(k, 2)``, ascending: the last where some are equal."""
        return np.array([j - int(self.dips[i : j + 1][::-1].argmin()) for i, j in pairs.tolist()])

    def add(self, turns: Sequence[Turn]) -> Numbers:
        """Give new turns their numbers; they are not on the border yet."""
        added = self.table.numbers(turns)
        more = self.table.room - len(self.alive)
        if more > 0:
            self.alive = np.append(self.alive, np.zeros(more, dtype=bool))
            self.following = np.append(self.following, np.full(more, -1))
            self.place = np.append(self.place, np.full(more, -1))
        return added

    def keep_outer(self, gusset: Gusset, turns: Sequence[Turn], added: Numbers, dip: float) -> Numbers:
        """Replace what a gusset wraps, and its ends, by an end, a dip and an end; return these and what is beside."""
        i, j = gusset.first, gusset.last
        self.alive[self.numbers[i : j + 1]] = False
        self.numbers = np.concatenate([self.numbers[:i], added, self.numbers[j + 1 :]])
        self.dips = np.concatenate([self.dips[:i], [np.inf, dip, np.inf], self.dips[j + 1 :]])
        self.turns = turns
        return self._join(added, [i - 1, i, i + 1, i + 2, (i + 3) % len(turns)])

    def keep_inner(self, gusset: Gusset, turns: Sequence[Turn], added: Numbers, dip: float) -> Numbers:
        """Keep only what a gusset wraps, and an end, a dip and an end; return these and what is beside."""
        between = slice(gusset.first + 1, gusset.last)
        kept = self.numbers[between]
        self.alive[self.numbers] = False
        self.alive[kept] = True
        first, middle, last = added
        self.numbers = np.concatenate([[middle, first], kept, [last]])
        self.dips = np.concatenate([[dip, np.inf], self.dips[between], [np.inf]])
        self.turns = turns
        return self._join(added, [-2, -1, 0, 1, 2])

    def _join(self, added: Numbers, places: list[int]) -> Numbers:
        self.alive[added] = True
        chain = self.numbers[places]
        self.following[chain[:-1]] = chain[1:]
        return chain


class QueuedSides:
    """When the sides of a border vanish, and where they are until ``ahead`` mm above ``height``."""

    def __init__(self, border: PartBorder, motion: Motion, height: float, ahead: float, tie: float) -> None:
        self._border, self._tie = border, tie
        numbers = border.numbers
        after = np.roll(np.arange(len(numbers)), -1)
        length, rate = motion.up * (motion.x - motion.x[after]), motion.shrink + motion.shrink[after]
        with np.errstate(all="ignore"):
            since = np.where(rate > 0, np.maximum(length - 2 * tie, 0.0) / rate, np.inf)
        since[length <= tie] = 0.0
        some = np.flatnonzero(np.isfinite(since))
        self._heap: list[tuple[float, int, int]] = list(
            zip((height + since[some]).tolist(), numbers[some].tolist(), numbers[after[some]].tolist(), strict=True)
        )
        heapify(self._heap)
        swept = _swept_boxes(motion, ahead, MARGIN * tie)
        boxes = np.concatenate(
            [np.minimum(swept[:, :2], swept[after, :2]), np.maximum(swept[:, 2:], swept[after, 2:])], 1
        )
        self._boxes = GrowingBoxes(boxes, np.stack([numbers, numbers[after]], axis=1))

    def add(self, chain: Numbers, motion: Motion, height: float, ahead: float) -> None:
        """Add the sides between turns that follow each other and move so."""
        swept = _swept_boxes(motion, ahead, MARGIN * self._tie)
        length, rate = motion.up[:-1] * -np.diff(motion.x), motion.shrink[:-1] + motion.shrink[1:]
        for k in range(len(chain) - 1):
            a, b = swept[k], swept[k + 1]
            self._boxes.add(np.append(np.minimum(a[:2], b[:2]), np.maximum(a[2:], b[2:])), chain[k : k + 2])
            if length[k] <= self._tie or rate[k] > 0:
                since = 0.0 if length[k] <= 2 * self._tie else float((length[k] - 2 * self._tie) / rate[k])
                heappush(self._heap, (height + since, int(chain[k]), int(chain[k + 1])))

    def next_collapse(self, height: float) -> float:
        """When, after a height, the next sides vanish; infinite if never."""
        border = self._border
        best = math.inf
        looked = []
        while self._heap and self._heap[0][0] <= height + best:
            entry = heappop(self._heap)
            _, start, end = entry
            if not border.alive[start] or border.following[start] != end:
                continue
            looked.append(entry)
            one, other = border.table.row(start), border.table.row(end)
            length = one.up * (one.image_at(height) - other.image_at(height))
            rate = one.shrink + other.shrink
            if length <= self._tie:
                best = 0.0
            elif rate > 0:
                best = min(best, length / rate)
        for entry in looked:
            heappush(self._heap, entry)
        return best

    def hide(self, pair: Pair, height: float, time: float) -> bool:
        """Whether a side that neither of two turns is an end of lies between them some time after a height."""
        border, table = self._border, self._border.table
        start, end = positions_after(table.rows(list(pair)), height, time)
        line = end - start
        sides = self._boxes.meeting(np.concatenate([np.minimum(start, end), np.maximum(start, end)]))
        first, last = sides.T
        there = border.alive[first] & (border.following[first] == last)
        for number in pair:
            there &= (first != number) & (last != number)
        count = int(there.sum())
        ends = positions_after(table.rows(np.concatenate([first[there], last[there]])), height, time)
        return bool(crosses(start, line, ends[:count], ends[count:]).any())


class QueuedPairs:
    """Pairs of crests, and when they come as near to each other as their path; known up to a height, ``until``.

    The disk of a crest has as its radius the height of its image over the lowest: disks that do not overlap belong to
    crests that are not too near to each other, whatever the tree.
    """

    def __init__(self, border: PartBorder, motion: Motion, height: float, ahead: float, tie: float) -> None:
        self._border, self._tie = border, tie
        self._lowest = float(motion.x.min())
        crest = motion.up > 0
        self._on_one_level = bool((motion.x[~crest] == self._lowest).all())
        self.until = height + ahead
        boxes = self._disk_boxes(motion, ahead)
        self._boxes = GrowingBoxes(boxes[crest], border.numbers[crest])
        self._waiting: list[Pair] = []
        self._heap = self._due(*self._boxes.first_pairs(), height)
        heapify(self._heap)

    def _disk_boxes(self, motion: Motion, ahead: float) -> Floats:
        """The boxes ``(n, 4)`` of the turns' disks, as far as they reach within a time."""
        speed = np.hypot(*motion.velocity.T) + np.abs(motion.slope)
        reach = (motion.x - self._lowest + speed * ahead + MARGIN * self._tie)[:, None]
        return np.concatenate([motion.position - reach, motion.position + reach], axis=1)

    def _due(self, one: Numbers, other: Numbers, height: float) -> list[tuple[float, int, int]]:
        """Those pairs that may come too near before ``until``, and since when.

        The two crests beside one dip keep their distance. No dip is lower than the lowest turn: pairs come too near
        when their path would be as long over that, or later.
        """
        border = self._border
        beside = border.following[border.following]
        keep = (beside[one] != other) & (beside[other] != one)
        one, other = one[keep], other[keep]
        count = len(one)
        if not count:
            return []
        motion = Motion(border.table.rows(np.concatenate([one, other])), height)
        apart_x, apart_y = (motion.position[count:] - motion.position[:count]).T
        parting_x, parting_y = (motion.velocity[count:] - motion.velocity[:count]).T
        path = motion.x[:count] + motion.x[count:] - 2 * self._lowest
        slope = motion.slope[:count] + motion.slope[count:]
        distance = np.hypot(apart_x, apart_y)
        a = parting_x * parting_x + parting_y * parting_y - slope * slope
        b = 2 * (apart_x * parting_x + apart_y * parting_y - path * slope)
        c = (distance - path) * (distance + path)
        root = b * b - 4 * a * c
        grazing = np.abs(root) <= 1e-6 * b * b
        with np.errstate(all="ignore"):
            q = -b + np.sqrt(np.where(grazing, 0.0, root))
            time = np.where(q > 0, 2 * c / q, np.inf)
        # when two only just touch is a matter of rounding: look in good time
        time = np.where(grazing, time * (1 - 2e-3), time)
        time[distance - path <= MARGIN * self._tie] = 0.0
        if self._on_one_level:
            time[(distance - path < -2 * LOST * self._tie) & ~((a < 0) & (b > 0))] = np.inf
        some = np.flatnonzero(height + time <= self.until)
        return list(zip((height + time[some]).tolist(), one[some].tolist(), other[some].tolist(), strict=True))

    def add(self, crests: Numbers, chain: Numbers, motion: Motion, height: float) -> None:
        """Add two crests beside one dip, which are on a chain of turns that move so."""
        reached = self._disk_boxes(motion, self.until - height)
        disks = [reached[chain == number][0] for number in crests]
        near = [found[self._border.alive[found]] for found in map(self._boxes.meeting, disks)]
        for entry in self._due(np.repeat(crests, [len(found) for found in near]), np.concatenate(near), height):
            heappush(self._heap, entry)
        for number, disk in zip(crests, disks, strict=True):
            self._boxes.add(disk, number)

    def first(self, height: float, before: float, sees: Callable[[Pair, float, float], bool]) -> Gusset | None:
        """Return the first gusset within a time ``before`` after a height, as far as is known; ``sees`` as the queue.

        Pairs come off the heap as they may be next. Those that are then found to meet later go back to it; those that
        must be looked at again at once, since they are very near or do not see each other, wait outside it.
        """
        alive, slack = self._border.alive, MARGIN * self._tie
        horizon = min(height + before, self.until) + slack
        pairs = [pair for pair in self._waiting if alive[pair[0]] and alive[pair[1]]]
        unseen: set[Pair] = set()
        while True:
            reach = self._heap[0][0] + slack if self._heap else math.inf
            if pairs:
                pairs, meetings, places = self._meetings(pairs, height)
                for n in meetings.before(before):
                    time = float(meetings.time[n])
                    if pairs[n] in unseen:
                        continue
                    if self._heap and self._heap[0][0] <= height + time + slack:
                        reach = height + time + slack  # what may come before it is looked at first
                        break
                    if sees(pairs[n], height, time):
                        self._waiting = self._put_back(pairs, meetings, height, height + time, but=n)
                        return Gusset(time, *places[n], meetings.x(n))
                    unseen.add(pairs[n])
                pairs = self._put_back(pairs, meetings, height, reach)
            if not self._heap or self._heap[0][0] > horizon:
                self._waiting = pairs
                return None
            while self._heap and self._heap[0][0] <= reach:
                _, one, other = heappop(self._heap)
                if alive[one] and alive[other]:
                    pairs.append((one, other))

    def _meetings(self, pairs: list[Pair], height: float) -> tuple[list[Pair], Meetings, list[tuple[int, int, int]]]:
        """When pairs meet, in the order of their turns; with the places of their turns and of their bends."""
        border = self._border
        border.update_places()
        both = np.sort(border.place[np.array(pairs)], axis=1)
        order = np.lexsort([both[:, 1], both[:, 0]])
        both = both[order]
        places = np.concatenate([both.T, [border.bends(both)]])
        i, j, bend = np.arange(places.size).reshape(places.shape)
        motion = Motion(border.table.rows(border.numbers[places.ravel()]), height)
        meetings = Meetings(motion, i, j, bend, 1.0, self._tie)
        first, last = border.numbers[both].T.tolist()
        return list(zip(first, last, strict=True)), meetings, list(zip(*places.tolist(), strict=True))

    def _put_back(
        self, pairs: list[Pair], meetings: Meetings, height: float, reach: float, but: int | None = None
    ) -> list[Pair]:
        """Return those pairs that must be looked at again at once; put back into the heap those that meet later."""
        waiting = []
        for n, pair in enumerate(pairs):
            if n == but:
                continue
            due = self._next_look(meetings, n, height)
            if due is None:
                continue
            if due > reach:
                heappush(self._heap, (due, *pair))
            else:
                waiting.append(pair)
        return waiting

    def _next_look(self, meetings: Meetings, n: int, height: float) -> float | None:
        """The height at which a pair must be looked at again: -infinity for at once, None for never."""
        time, gap = float(meetings.time[n]), float(meetings.gap[n])
        if math.isfinite(time):
            return height + time - self._tie
        if gap < -LOST * self._tie:
            a, b, c = float(meetings.a[n]), float(meetings.b[n]), float(meetings.c[n])
            root = b * b - 4 * a * c
            if a < 0 < b and root > 0:  # the two part, and come near again
                return height + 2 * c / (-b - math.sqrt(root)) * (1 - 1e-9)
            return None
        return -math.inf if gap <= self._tie else None


class EventQueue:
    """The events to come in a part of many turns; ``limit``: the height where the molecule ends."""

    def __init__(self, table: TurnTable, turns: Sequence[Turn], height: float, limit: float, tie: float) -> None:
        self._table, self._limit, self._tie = table, limit, tie
        self.border = PartBorder(table, turns)
        self._look_ahead(height, 0.0)

    @staticmethod
    def fits(table: TurnTable, turns: Sequence[Turn]) -> bool:
        """Whether the events of a part can be queued: its dips stay, and another dip is as low as turn 0."""
        numbers = table.numbers(turns)
        rows = table.rows(numbers)
        dip, shrink, x = rows["up"] < 0, rows["shrink"], rows["x"]
        if any(turn.spike for turn in turns) or shrink[dip].any() or (shrink <= 0).all():
            return False
        return bool(dip[0] and (x[1:][dip[1:]] <= x[0]).any())

    def _look_ahead(self, height: float, ahead: float) -> None:
        """Find all events from a height on, for at least a time ``ahead``: about as long as most disks last."""
        motion = Motion(self._table.rows(self.border.numbers), height)
        self.border.link(motion)
        crest = motion.up > 0
        speed = np.hypot(*motion.velocity[crest].T) + np.abs(motion.slope[crest])
        usual = 2 * float(np.median(motion.x[crest] - float(motion.x.min())) / np.median(speed))
        ahead = max(ahead, usual) if math.isfinite(usual) and usual > 0 else max(ahead, float(np.ptp(motion.x)))
        self._ahead = ahead
        self._added = 0
        self._sides = QueuedSides(self.border, motion, height, ahead, self._tie)
        self._pairs = QueuedPairs(self.border, motion, height, ahead, self._tie)

    def next_gusset(self, height: float) -> Gusset | None:
        """Return the next event after a height if it is a gusset; None if it is not, or if ``PartState`` must look."""
        if not self.border.lowest_is_shared() or self.border.turns[0].spike:
            return None
        most = MOST_NEW + len(self.border.numbers) // MOST_NEW_PART
        if height >= self._pairs.until or self._added > most:
            # look far enough ahead to make it worth the trouble
            self._look_ahead(height, 2 * self._ahead if self._added < most / 3 else 0.0)
        while True:
            collapse = self._sides.next_collapse(height)
            if collapse <= 0:
                return None
            before = min(collapse, self._limit - height)
            gusset = self._pairs.first(height, before, self.sees)
            if gusset is not None or height + before <= self._pairs.until:
                return gusset
            self._look_ahead(height, 2 * self._ahead)

    def sees(self, pair: Pair, height: float, time: float) -> bool:
        """Whether the segment between two turns lies inside the part some time after a height.

        The border's places must be up to date.
        """
        border = self.border
        start, end = positions_after(border.table.rows(list(pair)), height, time)
        line = end - start
        if not line.any():
            return False
        for number, toward in zip(pair, (line, -line), strict=True):
            if not looks_inside(border.turns[int(border.place[number])], toward):
                return False
        return not self._sides.hide(pair, height, time)

    def motion(self, gusset: Gusset, height: float) -> Motion:
        """Return how the ends of a gusset and its bend move, in this order."""
        places = [gusset.first, gusset.last, gusset.bend]
        return Motion(self._table.rows(self.border.numbers[places]), height)

    def split(self, gusset: Gusset, height: float, inner: Sequence[Turn], outer: Sequence[Turn]) -> int | None:
        """Go on with the larger of the two parts that a gusset makes at a height; return which, 0 for the inner.

        ``inner``: the gusset's middle, its first end, the turns between, its other end. ``outer``: the border with
        end, middle and end in place of what is wrapped. Returns None if the queue cannot go on, as there is no middle.
        """
        i, j, border = gusset.first, gusset.last, self.border
        if len(inner) != j - i + 2 or len(outer) != len(border.numbers) - (j - i) + 2:
            return None
        larger = int(len(outer) > len(inner))
        one, middle, other = new = outer[i : i + 3] if larger else [inner[1], inner[0], inner[-1]]
        if one.spike or other.spike:
            return None
        added = border.add(new)
        if larger:
            chain = border.keep_outer(gusset, outer, added, middle.x)
        else:
            chain = border.keep_inner(gusset, inner, added, middle.x)
        self._added += len(added)
        if self._pairs.until > height:
            motion = Motion(self._table.rows(chain), height)
            self._sides.add(chain, motion, height, self._pairs.until - height)
            self._pairs.add(added[[0, 2]], chain, motion, height)
        return larger


def _swept_boxes(motion: Motion, ahead: float, margin: float) -> Floats:
    """The boxes ``(n, 4)`` of where turns come to within a time."""
    then = motion.positions(ahead)
    low, high = np.minimum(motion.position, then) - margin, np.maximum(motion.position, then) + margin
    return np.concatenate([low, high], axis=1)
