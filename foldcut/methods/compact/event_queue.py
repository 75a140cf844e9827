"""What happens next in a part of a molecule: when turns meet, and for parts of many turns a queue of their events.

Turns as rows of a ``Table`` -> the next ``Gusset``.

A gusset changes a part at two turns only. So a ``Queue`` keeps what is known of all others: in a heap when sides
vanish, in another when pairs of peaks come as near as their images along the tree; in R-trees where peaks and sides
may come to until then. What is new after an event is looked for in these. It finds what the simple code finds by
looking at all turns at each step, number for number: heaps and trees only choose, and what is chosen is computed by the
same formulas.

It needs valleys that stay where they are on the cut line, as those of crowded disks do: then a pair's way in the tree
changes by its ends alone, and two valleys do not meet before peaks beside them have come too near each other. For all
else there is the simple code.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from heapq import heapify, heappop, heappush

import numpy as np
import shapely
from numpy.typing import NDArray

from foldcut.core.arrays import Floats, Numbers
from foldcut.methods.compact.motion import LOST, Gusset, Meetings, Motion, Table, Turn, _places, crosses, looks_inside

Pair = tuple[int, int]
MARGIN = 10.0
"""How many ties sooner than they may happen events are looked at: far more than rounding makes of them."""

MOST_NEW, MOST_NEW_PART = 300, 16
"""All is looked for anew when this many turns, and this part of all turns, have been added."""


def _boxes(corners: Floats) -> NDArray[np.object_]:
    """What has these boxes, ``(n, 4)``: their diagonals, which are made faster than polygons."""
    boxes: NDArray[np.object_] = shapely.linestrings(corners.reshape(-1, 2, 2))
    return boxes


class _Grown:
    """Boxes in an R-tree, and more that were added later; each has some numbers of turns, ``(k,)``."""

    def __init__(self, boxes: Floats, names: Numbers) -> None:
        self.tree = shapely.STRtree(_boxes(boxes))
        self.old = names
        self.boxes = np.empty((256, 4))
        self.new = np.empty((256, *names.shape[1:]), dtype=np.int64)
        self.count = 0

    def add(self, box: Floats, name: Numbers | int) -> None:
        if self.count == len(self.boxes):
            self.boxes = np.concatenate([self.boxes, np.empty_like(self.boxes)])
            self.new = np.concatenate([self.new, np.empty_like(self.new)])
        self.boxes[self.count], self.new[self.count] = box, name
        self.count += 1

    def pairs(self) -> tuple[Numbers, Numbers]:
        """The pairs of those that were there from the start whose boxes meet."""
        one, other = self.tree.query(self.tree.geometries)
        keep = one < other
        return self.old[one[keep]], self.old[other[keep]]

    def meeting(self, box: Floats) -> Numbers:
        """What has a box that meets this one."""
        x0, y0, x1, y1 = self.boxes[: self.count].T
        low_x, low_y, high_x, high_y = box.tolist()
        late = (x0 <= high_x) & (y0 <= high_y) & (x1 >= low_x) & (y1 >= low_y)
        return np.concatenate([self.old[self.tree.query(_boxes(box)[0])], self.new[: self.count][late]])


class Queue:
    """The events to come in a part of many turns.

    ``numbers`` ``(n,)``: the turns, in order from the root; ``limit``: the height where the molecule ends.
    """

    def __init__(self, table: Table, turns: Sequence[Turn], height: float, limit: float, tie: float) -> None:
        self.table, self.limit, self.tie = table, limit, tie
        self.turns = turns
        self.numbers = table.numbers(turns)
        self.witness = -1
        self._look(height, 0.0)

    @staticmethod
    def fits(table: Table, turns: Sequence[Turn]) -> bool:
        """Whether the events of a part can be queued: its valleys stay, and the root is not the lowest by itself."""
        numbers = table.numbers(turns)
        rows = table.rows[numbers]
        valley = rows[:, 8] < 0
        if any(turn.spike for turn in turns) or rows[valley, 7].any() or (rows[:, 7] <= 0).all():
            return False
        return bool(valley[0] and (rows[1:, 4][valley[1:]] <= rows[0, 4]).any())

    # --- looking ahead

    def _look(self, height: float, ahead: float) -> None:
        """Find all events up to a height, at least so far ahead."""
        numbers = self.numbers
        self.alive = np.zeros(len(self.table.rows), dtype=bool)
        self.alive[numbers] = True
        self.following = np.full(len(self.table.rows), -1)
        self.following[numbers] = np.roll(numbers, -1)
        self.place = np.full(len(self.table.rows), -1)
        motion = Motion(self.table.rows[numbers], height)
        peak = motion.up > 0
        self.lows = np.where(peak, np.inf, motion.x)
        self.lowest = float(motion.x.min())
        self.exact = bool((motion.x[~peak] == self.lowest).all())
        speed = np.hypot(*motion.velocity[peak].T) + np.abs(motion.slope[peak])
        usual = 2 * float(np.median(motion.x[peak] - self.lowest) / np.median(speed))
        ahead = max(ahead, usual) if math.isfinite(usual) and usual > 0 else max(ahead, float(np.ptp(motion.x)))
        self.ahead, self.until = ahead, height + ahead
        self.added = 0
        # sides that vanish
        after = np.roll(np.arange(len(numbers)), -1)
        length, rate = motion.up * (motion.x - motion.x[after]), motion.shrink + motion.shrink[after]
        with np.errstate(all="ignore"):
            since = np.where(rate > 0, np.maximum(length - 2 * self.tie, 0.0) / rate, np.inf)
        since[length <= self.tie] = 0.0
        some = np.flatnonzero(np.isfinite(since))
        self.sides = list(
            zip((height + since[some]).tolist(), numbers[some].tolist(), numbers[after[some]].tolist(), strict=True)
        )
        heapify(self.sides)
        # where they are until then
        swept = self._swept(motion, ahead)
        both = np.concatenate(
            [np.minimum(swept[:, :2], swept[after, :2]), np.maximum(swept[:, 2:], swept[after, 2:])], 1
        )
        self.side_boxes = _Grown(both, np.stack([numbers, numbers[after]], axis=1))
        self.disk_boxes = _Grown(self._disks(motion, ahead)[peak], numbers[peak])
        # pairs
        self.waiting: list[Pair] = []
        self.heap = self._pairs(*self.disk_boxes.pairs(), height)
        heapify(self.heap)

    def _swept(self, motion: Motion, ahead: float) -> Floats:
        """The boxes ``(n, 4)`` of where turns come to within a time."""
        then, tie = motion.positions(ahead), MARGIN * self.tie
        low, high = np.minimum(motion.position, then) - tie, np.maximum(motion.position, then) + tie
        return np.concatenate([low, high], axis=1)

    def _disks(self, motion: Motion, ahead: float) -> Floats:
        """The boxes ``(n, 4)`` of the turns' disks, as far as they reach within a time."""
        speed = np.hypot(*motion.velocity.T) + np.abs(motion.slope)
        reach = (motion.x - self.lowest + speed * ahead + MARGIN * self.tie)[:, None]
        return np.concatenate([motion.position - reach, motion.position + reach], axis=1)

    def _pairs(self, one: Numbers, other: Numbers, height: float) -> list[tuple[float, int, int]]:
        """Those pairs of peaks that may come too near, and since when.

        The two beside one valley stay as near as they are. Nothing in the tree is lower than the lowest turn: pairs
        come too near then, or later.
        """
        beside = self.following[self.following]
        keep = (beside[one] != other) & (beside[other] != one)
        one, other = one[keep], other[keep]
        count = len(one)
        if not count:
            return []
        motion = Motion(self.table.rows[np.concatenate([one, other])], height)
        apart_x, apart_y = (motion.position[count:] - motion.position[:count]).T
        parting_x, parting_y = (motion.velocity[count:] - motion.velocity[:count]).T
        path, slope = motion.x[:count] + motion.x[count:] - 2 * self.lowest, motion.slope[:count] + motion.slope[count:]
        distance = np.hypot(apart_x, apart_y)
        a = parting_x * parting_x + parting_y * parting_y - slope * slope
        b = 2 * (apart_x * parting_x + apart_y * parting_y - path * slope)
        c = (distance - path) * (distance + path)
        root = b * b - 4 * a * c
        grazing = np.abs(root) <= 1e-6 * b * b
        with np.errstate(all="ignore"):
            q = -b + np.sqrt(np.where(grazing, 0.0, root))
            time = np.where(q > 0, 2 * c / q, np.inf)
        # where they only just touch rounding tells when: look in good time
        time = np.where(grazing, time * (1 - 2e-3), time)
        time[distance - path <= MARGIN * self.tie] = 0.0
        if self.exact:
            time[(distance - path < -2 * LOST * self.tie) & ~((a < 0) & (b > 0))] = np.inf
        some = np.flatnonzero(height + time <= self.until)
        return list(zip((height + time[some]).tolist(), one[some].tolist(), other[some].tolist(), strict=True))

    # --- the next event

    def next_gusset(self, height: float) -> Gusset | None:
        """The next event, if it is a gusset; None where the simple code must look."""
        if not self._has_witness() or self.turns[0].spike:
            return None
        most = MOST_NEW + len(self.numbers) // MOST_NEW_PART
        if height >= self.until or self.added > most:
            # far enough that it is worth the trouble
            self._look(height, 2 * self.ahead if self.added < most / 3 else 0.0)
        while True:
            collapse = self._next_collapse(height)
            if collapse <= 0:
                return None
            before = min(collapse, self.limit - height)
            gusset = self._first(height, before)
            if gusset is not None or height + before <= self.until:
                return gusset
            self._look(height, 2 * self.ahead)

    def _has_witness(self) -> bool:
        """Whether another valley is as low as the root."""
        if self.witness < 0 or not self.alive[self.witness] or self.witness == self.numbers[0]:
            at = 1 + int(self.lows[1:].argmin())
            if self.lows[at] > self.lows[0]:
                return False
            self.witness = int(self.numbers[at])
        return True

    def _next_collapse(self, height: float) -> float:
        """When the next stretches of border vanish."""
        best = math.inf
        looked = []
        while self.sides and self.sides[0][0] <= height + best:
            entry = heappop(self.sides)
            _, start, end = entry
            if not self.alive[start] or self.following[start] != end:
                continue
            looked.append(entry)
            one, other = self.table.rows[start].tolist(), self.table.rows[end].tolist()
            length = one[8] * ((one[4] + one[5] * (height - one[6])) - (other[4] + other[5] * (height - other[6])))
            rate = one[7] + other[7]
            if length <= self.tie:
                best = 0.0
            elif rate > 0:
                best = min(best, length / rate)
        for entry in looked:
            heappush(self.sides, entry)
        return best

    def _first(self, height: float, before: float) -> Gusset | None:
        """The first pair that comes too near before the given time, as far as is known."""
        slack = MARGIN * self.tie
        horizon = min(height + before, self.until) + slack
        pairs = [pair for pair in self.waiting if self.alive[pair[0]] and self.alive[pair[1]]]
        unseen: set[Pair] = set()
        while True:
            reach = self.heap[0][0] + slack if self.heap else math.inf
            if pairs:
                pairs, meetings, places = self._meetings(pairs, height)
                for n in meetings.before(before):
                    time = float(meetings.time[n])
                    if pairs[n] in unseen:
                        continue
                    if self.heap and self.heap[0][0] <= height + time + slack:
                        reach = height + time + slack  # what may come before it is looked at first
                        break
                    if self._sees(pairs[n], height, time):
                        self.waiting = self._kept(pairs, meetings, height, height + time, but=n)
                        return Gusset(time, *places[n], meetings.x(n))
                    unseen.add(pairs[n])
                pairs = self._kept(pairs, meetings, height, reach)
            if not self.heap or self.heap[0][0] > horizon:
                self.waiting = pairs
                return None
            while self.heap and self.heap[0][0] <= reach:
                _, one, other = heappop(self.heap)
                if self.alive[one] and self.alive[other]:
                    pairs.append((one, other))

    def _meetings(self, pairs: list[Pair], height: float) -> tuple[list[Pair], Meetings, list[tuple[int, int, int]]]:
        """When pairs meet, in the order of their turns: these, the meetings, and the places of ``i, j, at``."""
        self.place[self.numbers] = np.arange(len(self.numbers))
        both = np.sort(self.place[np.array(pairs)], axis=1)
        order = np.lexsort([both[:, 1], both[:, 0]])
        both = both[order]
        at = [j - int(self.lows[i : j + 1][::-1].argmin()) for i, j in both.tolist()]
        three = np.concatenate([both.T, [at]])
        i, j, k = np.arange(three.size).reshape(three.shape)
        motion = Motion(self.table.rows[self.numbers[three.ravel()]], height)
        meetings = Meetings(motion, i, j, k, 1.0, self.tie)
        first, last = self.numbers[both].T.tolist()
        return list(zip(first, last, strict=True)), meetings, list(zip(*three.tolist(), strict=True))

    def _kept(
        self, pairs: list[Pair], meetings: Meetings, height: float, reach: float, but: int | None = None
    ) -> list[Pair]:
        """Those pairs that must be looked at again at once; others go back into the heap or are done with."""
        waits = []
        for n, (one, other) in enumerate(pairs):
            if n == but:
                continue
            time, gap = float(meetings.time[n]), float(meetings.gap[n])
            if math.isfinite(time):
                if height + time - self.tie > reach:
                    heappush(self.heap, (height + time - self.tie, one, other))
                else:
                    waits.append((one, other))
            elif gap < -LOST * self.tie:
                a, b, c = float(meetings.a[n]), float(meetings.b[n]), float(meetings.c[n])
                root = b * b - 4 * a * c
                if a < 0 < b and root > 0:  # they part, and come near again
                    later = height + 2 * c / (-b - math.sqrt(root)) * (1 - 1e-9)
                    if later > reach:
                        heappush(self.heap, (later, one, other))
                    else:
                        waits.append((one, other))
            elif gap <= self.tie:
                waits.append((one, other))
        return waits

    def _sees(self, pair: Pair, height: float, time: float) -> bool:
        """Whether the segment between two turns lies inside the part."""
        rows = self.table.rows
        start, end = _places(rows[list(pair)], height, time)
        line = end - start
        if not line.any():
            return False
        for number, toward in zip(pair, (line, -line), strict=True):
            if not looks_inside(self.turns[int(self.place[number])], toward):
                return False
        sides = self.side_boxes.meeting(np.concatenate([np.minimum(start, end), np.maximum(start, end)]))
        first, last = sides.T
        there = self.alive[first] & (self.following[first] == last)
        for number in pair:
            there &= (first != number) & (last != number)
        count = int(there.sum())
        ends = _places(rows[np.concatenate([first[there], last[there]])], height, time)
        return not bool(crosses(start, line, ends[:count], ends[count:]).any())

    def places(self, gusset: Gusset, height: float) -> tuple[dict[int, Floats], dict[int, float]]:
        """Where the turns of a gusset are when it forms, and where they land."""
        some = [gusset.first, gusset.last, gusset.at]
        motion = Motion(self.table.rows[self.numbers[some]], height)
        position, x = motion.positions(gusset.time), motion.images(gusset.time).tolist()
        return dict(zip(some, position, strict=True)), dict(zip(some, x, strict=True))

    # --- what becomes of the part

    def split(self, gusset: Gusset, height: float, inner: Sequence[Turn], outer: Sequence[Turn]) -> int:
        """Go on with the larger of the two parts that a gusset makes at a height: 0 or 1, or -1 if that cannot be.

        ``inner``: the gusset's middle, its first end, the turns between, its other end; ``outer``: all three in place.
        """
        i, j = gusset.first, gusset.last
        if len(inner) != j - i + 2 or len(outer) != len(self.numbers) - (j - i) + 2:
            return -1
        larger = int(len(outer) > len(inner))
        one, middle, other = new = outer[i : i + 3] if larger else [inner[1], inner[0], inner[-1]]
        if one.spike or other.spike:
            return -1
        first, mid, last = added = self.table.numbers(new)
        if len(self.alive) < len(self.table.rows):
            more = len(self.table.rows) - len(self.alive)
            self.alive = np.append(self.alive, np.zeros(more, dtype=bool))
            self.following = np.append(self.following, np.full(more, -1))
            self.place = np.append(self.place, np.full(more, -1))
        lows = np.array([np.inf, middle.row[4], np.inf])
        between = slice(i + 1, j)
        if larger:
            self.alive[self.numbers[i : j + 1]] = False
            self.numbers = np.concatenate([self.numbers[:i], added, self.numbers[j + 1 :]])
            self.lows = np.concatenate([self.lows[:i], lows, self.lows[j + 1 :]])
            here = [i - 1, i, i + 1, i + 2, (i + 3) % len(outer)]
        else:
            kept = self.numbers[between]
            self.alive[self.numbers] = False
            self.alive[kept] = True
            self.numbers = np.concatenate([[mid, first], kept, [last]])
            self.lows = np.concatenate([[lows[1], np.inf], self.lows[between], [np.inf]])
            here = [-2, -1, 0, 1, 2]
        self.turns = outer if larger else inner
        self.alive[added] = True
        ring = self.numbers[here]
        self.following[ring[:-1]] = ring[1:]
        self.added += 3
        if self.until > height:
            self._add(np.array([first, last]), ring, height)
        return larger

    def _add(self, new: Numbers, ring: Numbers, height: float) -> None:
        """Look for the events of new peaks, and of the sides along ``ring``."""
        rows, ahead = self.table.rows, self.until - height
        motion = Motion(rows[ring], height)
        swept, reached = self._swept(motion, ahead), self._disks(motion, ahead)
        length, rate = motion.up[:-1] * -np.diff(motion.x), motion.shrink[:-1] + motion.shrink[1:]
        for k in range(len(ring) - 1):
            a, b = swept[k], swept[k + 1]
            self.side_boxes.add(np.append(np.minimum(a[:2], b[:2]), np.maximum(a[2:], b[2:])), ring[k : k + 2])
            if length[k] <= self.tie or rate[k] > 0:
                since = 0.0 if length[k] <= 2 * self.tie else float((length[k] - 2 * self.tie) / rate[k])
                heappush(self.sides, (height + since, int(ring[k]), int(ring[k + 1])))
        # the two are beside one valley, so no pair
        disks = [reached[ring == number][0] for number in new]
        near = [found[self.alive[found]] for found in map(self.disk_boxes.meeting, disks)]
        for entry in self._pairs(np.repeat(new, [len(found) for found in near]), np.concatenate(near), height):
            heappush(self.heap, entry)
        for number, disk in zip(new, disks, strict=True):
            self.disk_boxes.add(disk, number)
