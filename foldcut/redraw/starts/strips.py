"""Find strips: pairs of pieces of the outline that face each other at a nearly constant distance.

Between the two edges of a strip lies paper of the shape (the stroke of a letter), or paper around it (the gap between
two arcs). If both edges get the same bends, mitred, the straight skeleton between them has nodes of even degree.

For each sample the largest disk is sought that touches the outline there, on the paper's side, and has no other sample
within; where it touches the outline once more is the sample's *partner* (a sampled medial axis). A strip is a run of
samples whose partners run along another piece, or the same loop elsewhere, backwards.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Bools, Floats, Indices
from foldcut.redraw.starts.chains import Chain, Chains

__all__ = ["Pairs", "Strip", "find_strips", "recut_chains"]

FACING = math.cos(math.radians(32))
"""How exactly opposite the outline has to run at both edges of a strip."""

END = 1.2
"""How far beyond its last pair a strip may go on to a corner, in widths."""

JUMP = 8.0
"""By how much more than twice the distance of two samples their partners may be apart, in mm."""

GAP = 25.0
"""Strips that follow each other are one if both edges go on after no more than this, in mm."""


@dataclass(frozen=True, eq=False)
class Strip:
    """Two edges that face each other: columns of ``places`` ``(m, 2)``, the samples of the first and the second edge.

    The first edge runs along chain ``chains[0]``, the second backwards along ``chains[1]``. ``disks`` ``(m, 3)`` mm:
    middle and diameter of the disk that touches both edges there;
    ``inside``: paper of the shape lies between the edges; else paper around it. From column ``paired[0]`` to column
    ``paired[1]`` the edges face each other; beyond, they run on to the corners where they end.
    """

    chains: tuple[int, int]
    places: Indices
    disks: Floats
    inside: bool
    length: float
    paired: tuple[int, int]

    @property
    def widths(self) -> Floats:
        """The width at each column, ``(m,)`` mm."""
        widths: Floats = self.disks[:, 2]
        return widths

    @property
    def width(self) -> float:
        """The width in the middle of its range, in mm."""
        return float(self.widths.min() + self.widths.max()) / 2

    @property
    def can_be_trimmed(self) -> bool:
        """Whether enough is left if its ends are trimmed."""
        return self.paired[1] - self.paired[0] > 12

    def trimmed(self) -> Strip:
        """Return the strip without its unpaired ends, or, if it has none, without an eighth at each end."""
        start, end = self.paired
        if start == 0 and end == len(self.places) - 1:
            eighth = max(1, len(self.places) // 8)
            start, end = eighth, len(self.places) - 1 - eighth
        some = slice(start, end + 1)
        part = self.length * (end + 1 - start) / len(self.places)
        return Strip(self.chains, self.places[some], self.disks[some], self.inside, part, (0, end - start))

    def rows(self, chains: Sequence[Chain]) -> Floats:
        """The samples of both edges, ``(2, m, 2)``, in the direction of the first."""
        a, b = self.chains
        return np.stack([chains[a].points[self.places[:, 0]], chains[b].points[self.places[:, 1]]])

    def intervals(self) -> list[tuple[int, int, int]]:
        """The chain, first and last sample of each edge."""
        (a, b), places = self.chains, self.places
        return [(a, int(places[0, 0]), int(places[-1, 0])), (b, int(places[-1, 1]), int(places[0, 1]))]


@dataclass(frozen=True, eq=False)
class _Samples:
    """All samples of all chains, the last of closed ones left out, and mirror images behind them."""

    points: Floats
    tangents: Floats
    chain: Indices
    place: Indices
    corner: Bools
    count: int


def _samples(chains: Chains) -> _Samples:
    points, tangents, numbers, places, corners = [], [], [], [], []
    for k, chain in enumerate(chains.chains):
        row = chain.points
        steps = np.diff(row, axis=0)
        steps /= np.maximum(np.hypot(*steps.T), 1e-12)[:, None]
        tangent = np.zeros_like(row)
        tangent[:-1] += steps
        tangent[1:] += steps
        if chain.is_closed and not chain.corners[0]:
            tangent[0] = tangent[-1] = steps[0] + steps[-1]
        tangent /= np.maximum(np.hypot(*tangent.T), 1e-12)[:, None]
        points.append(row)
        tangents.append(tangent)
        numbers.append(np.full(len(row), k))
        places.append(np.arange(len(row)))
        corner = chain.corners.copy()
        corners.append(corner)
    count = sum(len(row) for row in points)
    every, along = np.concatenate(points), np.concatenate(tangents)
    for axis in chains.axes:
        every = np.concatenate([every, axis.mirrored(every)])
        image = along - 2 * (along @ axis.normal)[:, None] * axis.normal
        along = np.concatenate([along, -image])
    return _Samples(every, along, np.concatenate(numbers), np.concatenate(places), np.concatenate(corners), count)


def _partners(samples: _Samples, inside: bool) -> tuple[Indices, Floats]:
    """Return for each sample its partner, -1 for none, and the diameter of the disk between them."""
    n = samples.count
    points, tangents = samples.points, samples.tangents
    sign = 1.0 if inside else -1.0
    normals = sign * np.column_stack([-tangents[:n, 1], tangents[:n, 0]])
    away_x = points[None, :, 0] - points[:n, None, 0]
    away_y = points[None, :, 1] - points[:n, None, 1]
    square = away_x**2 + away_y**2
    ahead = away_x * normals[:, :1] + away_y * normals[:, 1:]
    # a sample that faces away or lies beside in the same direction is no partner, but limits the disk
    with np.errstate(all="ignore"):
        diameter = np.where(ahead > 0.05 * np.sqrt(square) + 1e-9, square / ahead, np.inf)
    partner = diameter.argmin(axis=1)
    width = diameter[np.arange(n), partner]
    facing = (tangents[:n] * tangents[partner]).sum(axis=1) < -FACING
    good = np.isfinite(width) & facing & (partner < n) & ~samples.corner
    good &= ~samples.corner[np.minimum(partner, n - 1)]  # a disk that rests on a corner says nothing of a width
    return np.where(good, partner, -1), width


class Pairs:
    """The samples of all chains and their partners, with paper of the shape between them or paper around it."""

    def __init__(self, chains: Chains) -> None:
        self.chains = chains
        self.samples = _samples(chains)
        self._partners: dict[bool, tuple[Indices, Floats]] = {}

    def partners(self, inside: bool) -> tuple[Indices, Floats]:
        """Return for each sample its partner, -1 for none, and the diameter of the disk between them."""
        if inside not in self._partners:
            self._partners[inside] = _partners(self.samples, inside)
        return self._partners[inside]


def find_strips(pairs: Pairs, *, inside: bool, shortest: float = 0.8) -> list[Strip]:
    """Return strips, the longest first, of which no two share a piece of the outline.

    ``inside``: of paper of the shape, else of paper around it. ``shortest``: how long an edge is at least, in widths.
    """
    runs = sorted(_runs(pairs, inside), key=lambda run: -run.length)
    runs = sorted(_apart(runs), key=lambda run: (run.chains, int(run.places[0, 0])))
    joined: list[Strip] = []
    for run in runs:
        whole = _joined(pairs.chains, joined[-1], run) if joined else None
        if whole is None:
            joined.append(run)
        else:
            joined[-1] = whole
    long = [_lengthened(pairs.chains, one) for one in joined if one.length > shortest * one.width]
    return _apart(sorted(long, key=lambda strip: -strip.length))


def _runs(pairs: Pairs, inside: bool) -> list[Strip]:
    """Return the runs of samples whose partners follow each other, each seen from both of its edges."""
    samples, (partner, width) = pairs.samples, pairs.partners(inside)
    found: list[Strip] = []
    start = 0
    while start < samples.count:
        if partner[start] < 0:
            start += 1
            continue
        end = start
        while end + 1 < samples.count and _goes_on(samples, partner, end):
            end += 1
        run = _run(pairs, partner, width, start, end, inside) if end - start > 1 else None
        if run is not None:
            found.append(run)
        start = end + 1
    return found


def _goes_on(samples: _Samples, partner: Indices, here: int) -> bool:
    """Tell whether the partners of a sample and the next one follow each other."""
    there = here + 1
    a, b = int(partner[here]), int(partner[there])
    if b < 0 or samples.chain[there] != samples.chain[here] or samples.chain[a] != samples.chain[b]:
        return False
    if samples.place[b] > samples.place[a]:
        return False
    step = float(np.hypot(*(samples.points[there] - samples.points[here])))
    jump = float(np.hypot(*(samples.points[a] - samples.points[b])))
    return jump <= JUMP + 2 * step and not samples.corner[b + 1 : a].any()


def _run(pairs: Pairs, partner: Indices, width: Floats, start: int, end: int, inside: bool) -> Strip | None:
    """Return the strip of samples from ``start`` to ``end`` and their partners, the lower edge first."""
    samples = pairs.samples
    columns: list[tuple[int, int]] = []
    disks: list[Floats] = []
    sign = 0.5 if inside else -0.5
    for here in range(start, end + 1):
        i, j = int(samples.place[here]), int(samples.place[partner[here]])
        across = np.array([-samples.tangents[here, 1], samples.tangents[here, 0]])
        disk = np.append(samples.points[here] + sign * width[here] * across, width[here])
        if columns:
            last_i, last_j = columns[-1]
            between = range(last_j - 1, j, -1)
            columns += [(last_i, k) for k in between]
            disks += list(np.linspace(disks[-1], disk, len(between) + 2)[1:-1])
        columns.append((i, j))
        disks.append(disk)
    places, among = np.array(columns), np.array(disks)
    numbers = (int(samples.chain[start]), int(samples.chain[partner[start]]))
    if numbers[0] == numbers[1] and places[0, 0] < places[0, 1] and places[-1, 0] > places[-1, 1]:
        # both edges are seen as one: around the end of a strip
        keep = places[:, 0] < places[:, 1]
        places, among = places[keep], among[keep]
    if (numbers[0], places[0, 0]) > (numbers[1], places[-1, 1]):
        numbers, places, among = numbers[::-1], places[::-1, ::-1], among[::-1]
    return _made(pairs.chains, numbers, places, among, inside)


def _made(chains: Chains, numbers: tuple[int, int], places: Indices, disks: Floats, inside: bool) -> Strip | None:
    """Return a strip of paired samples, if there are enough of them."""
    if len(places) < 3 or places[0, 0] >= places[-1, 0] or places[0, 1] <= places[-1, 1]:
        return None
    rows = [chains.chains[number].points[places[:, k]] for k, number in enumerate(numbers)]
    length = float(np.mean([np.hypot(*np.diff(row, axis=0).T).sum() for row in rows]))
    return Strip(numbers, places, disks, inside, length, (0, len(places) - 1))


def _joined(chains: Chains, one: Strip, other: Strip) -> Strip | None:
    """Return both strips as one, if the other goes on soon after the one ends, on both edges."""
    if one.chains != other.chains:
        return None
    (i0, j0), (i1, j1) = one.places[-1].tolist(), other.places[0].tolist()
    if not (i0 <= i1 and j1 <= j0):
        return None
    a, b = (chains.chains[number] for number in one.chains)
    if a.corners[i0 : i1 + 1].any() or b.corners[j1 : j0 + 1].any():
        return None
    for chain, low, high in ((a, i0, i1), (b, j1, j0)):
        if float(np.hypot(*np.diff(chain.points[low : high + 1], axis=0).T).sum()) > GAP:
            return None
    between = _columns(list(range(i0 + 1, i1)), list(range(j0 - 1, j1, -1)), i0, j0)
    disks = np.linspace(one.disks[-1], other.disks[0], len(between) + 2)[1:-1]
    places = np.array([*one.places.tolist(), *between, *other.places.tolist()])
    return _made(chains, one.chains, places, np.concatenate([one.disks, disks, other.disks]), one.inside)


def _lengthened(chains: Chains, strip: Strip) -> Strip:
    """Return a strip whose edges go on to the corners at its ends, where these are near."""
    one, other = (chains.chains[number] for number in strip.chains)
    places, widths = strip.places, strip.widths
    (i0, j0), (i1, j1) = places[0].tolist(), places[-1].tolist()
    reach = END * widths[0], END * widths[-1]
    before = _columns(_to_corner(one, i0, -1, reach[0]), _to_corner(other, j0, 1, reach[0]), i0, j0)[::-1]
    after = _columns(_to_corner(one, i1, 1, reach[1]), _to_corner(other, j1, -1, reach[1]), i1, j1)
    whole = np.array([*before, *places.tolist(), *after])
    disks = np.repeat(strip.disks, [len(before) + 1, *[1] * (len(places) - 2), len(after) + 1], axis=0)
    paired = len(before), len(before) + len(places) - 1
    return Strip(strip.chains, whole, disks, strip.inside, strip.length, paired)


def _to_corner(chain: Chain, place: int, step: int, reach: float) -> list[int]:
    """Return the samples after ``place`` up to the next corner in a direction, none if it is farther than ``reach``."""
    found: list[int] = []
    gone = 0.0
    while not chain.corners[place]:
        following = place + step
        if not 0 <= following < len(chain.points):
            return [] if chain.is_closed else found
        gone += float(np.hypot(*(chain.points[following] - chain.points[place])))
        if gone > reach:
            return []
        found.append(following)
        place = following
    return found


def _columns(one: list[int], other: list[int], i: int, j: int) -> list[tuple[int, int]]:
    """Return columns that go on along both edges at once."""
    count = max(len(one), len(other))
    first, second = [i, *one], [j, *other]
    return [(first[round(k * len(one) / count)], second[round(k * len(other) / count)]) for k in range(1, count + 1)]


def _apart(strips: Sequence[Strip]) -> list[Strip]:
    """Return strips of which no two share a piece of the outline: each is cut where an earlier one has been."""
    taken: dict[int, list[tuple[int, int]]] = {}
    kept: list[Strip] = []
    for strip in strips:
        free = np.ones(len(strip.places), dtype=bool)
        for k, number in enumerate(strip.chains):
            for a, b in taken.get(number, ()):
                free &= (strip.places[:, k] <= a) | (strip.places[:, k] >= b)
        run = _longest_run(free)
        if run is None or run[1] - run[0] < 3:
            continue
        part = strip
        if run != (0, len(free)):
            paired = max(strip.paired[0] - run[0], 0), min(strip.paired[1], run[1] - 1) - run[0]
            if paired[1] - paired[0] < 2:
                continue
            some, length = slice(*run), strip.length * (run[1] - run[0]) / len(free)
            part = Strip(strip.chains, strip.places[some], strip.disks[some], strip.inside, length, paired)
        if any(b <= a for _, a, b in part.intervals()):
            continue
        if any(a < d and c < b for number, a, b in part.intervals() for c, d in taken.get(number, ())):
            continue
        if part.length < 0.5 * part.width and part.length < 0.7 * strip.length:
            continue
        for number, a, b in part.intervals():
            taken.setdefault(number, []).append((a, b))
        kept.append(part)
    return kept


def _longest_run(free: Bools) -> tuple[int, int] | None:
    """Return the longest run of true values, as a range."""
    padded = np.concatenate([[False], free, [False]])
    change = np.flatnonzero(padded[1:] != padded[:-1])
    if not len(change):
        return None
    starts, ends = change[::2], change[1::2]
    best = int((ends - starts).argmax())
    return int(starts[best]), int(ends[best])


def recut_chains(chains: Chains, strips: Sequence[Strip]) -> Chains:
    """Return chains of which those without corners are cut open where no strip is, rather than within one."""
    made = list(chains.chains)
    for number, chain in enumerate(made):
        if not chain.is_closed or chain.corners.any():
            continue
        count = len(chain.points) - 1
        covered = np.zeros(count, dtype=bool)
        for strip in strips:
            for k, a, b in strip.intervals():
                if k == number:
                    covered[a + 1 : b] = True
        if not (covered[1:3].any() and covered[-2:].any()):
            continue
        inner = np.flatnonzero(~covered)
        inner = inner[(inner > 2) & (inner < count - 2)]
        if not len(inner):
            continue
        place = int(inner[len(inner) // 2])
        turned = np.roll(chain.points[:-1], -place, axis=0)
        points = np.concatenate([turned, turned[:1]])
        made[number] = Chain(chain.loop, points, chain.corners, chain.ends)
    if all(a is b for a, b in zip(made, chains.chains, strict=True)):
        return chains
    return Chains(tuple(made), chains.source, chains.axes)
