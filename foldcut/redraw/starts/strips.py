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

__all__ = ["Strip", "find_strips", "without_overlap"]

FACING = math.cos(math.radians(32))
"""How exactly opposite the outline has to run at both edges of a strip."""

JUMP = 8.0
"""By how much a partner may jump from one sample to the next, in mm, and this many times as far as the samples are apart."""


@dataclass(frozen=True, eq=False)
class Strip:
    """Two edges that face each other: columns of ``places`` ``(m, 2)``, the samples of the first and the second edge.

    The first edge runs along chain ``chains[0]``, the second backwards along ``chains[1]``. ``widths`` ``(m,)`` mm;
    ``inside``: paper of the shape lies between the edges; else paper around it.
    """

    chains: tuple[int, int]
    places: Indices
    widths: Floats
    inside: bool
    length: float

    @property
    def width(self) -> float:
        """The width in the middle of its range, in mm."""
        return float(self.widths.min() + self.widths.max()) / 2

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
    return _Samples(
        every, along, np.concatenate(numbers), np.concatenate(places), np.concatenate(corners), count
    )


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
    return np.where(good, partner, -1), width


def find_strips(chains: Chains, variation: float, *, inside: bool, shortest: float = 0.8) -> list[Strip]:
    """Return the strips whose width varies by at most ``variation`` mm, the longest first.

    ``shortest``: how long an edge is at least, in widths.
    """
    samples = _samples(chains)
    partner, width = _partners(samples, inside)
    found: list[Strip] = []
    start = 0
    n = samples.count
    while start < n:
        if partner[start] < 0:
            start += 1
            continue
        end, low, high = start, width[start], width[start]
        while end + 1 < n and _goes_on(samples, partner, end):
            low, high = min(low, width[end + 1]), max(high, width[end + 1])
            if high - low > variation:
                break
            end += 1
        strip = _strip(chains, samples, partner, width, start, end, inside)
        if strip is not None and strip.length > shortest * strip.width:
            found.append(strip)
        start = end + 1
    return sorted(found, key=lambda strip: -strip.length)


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
    if jump > JUMP + 2 * step:
        return False
    return not samples.corner[b + 1 : a].any()


def _strip(
    chains: Chains, samples: _Samples, partner: Indices, width: Floats, start: int, end: int, inside: bool
) -> Strip | None:
    if end - start < 2:
        return None
    columns: list[tuple[int, int]] = []
    wide: list[float] = []
    for here in range(start, end + 1):
        i, j = int(samples.place[here]), int(samples.place[partner[here]])
        if columns:
            last_i, last_j = columns[-1]
            between = range(last_j - 1, j, -1)
            columns += [(last_i, k) for k in between]
            wide += np.linspace(wide[-1], width[here], len(between) + 2)[1:-1].tolist()
        columns.append((i, j))
        wide.append(float(width[here]))
    places, widths = np.array(columns), np.array(wide)
    numbers = (int(samples.chain[start]), int(samples.chain[partner[start]]))
    # corners within limits of the same chain must not overlap
    (a, a0, a1), (b, b0, b1) = (
        (numbers[0], places[0, 0], places[-1, 0]),
        (numbers[1], places[-1, 1], places[0, 1]),
    )
    if b1 <= b0 or (a == b and a0 < b1 and b0 < a1):
        if a == b and a0 < b1 and b0 < a1:
            # the strip is seen from both edges: keep the half up to where they meet
            keep = places[:, 0] < places[:, 1]
            return _half(chains, numbers, places[keep], widths[keep], inside)
        return None
    return _made(chains, numbers, places, widths, inside)


def _half(
    chains: Chains, numbers: tuple[int, int], places: Indices, widths: Floats, inside: bool
) -> Strip | None:
    return _made(chains, numbers, places, widths, inside) if len(places) > 2 else None


def _made(
    chains: Chains, numbers: tuple[int, int], places: Indices, widths: Floats, inside: bool
) -> Strip | None:
    rows = [chains.chains[number].points[places[:, k]] for k, number in enumerate(numbers)]
    length = float(np.mean([np.hypot(*np.diff(row, axis=0).T).sum() for row in rows]))
    return Strip(numbers, places, widths, inside, length)


def without_overlap(strips: Sequence[Strip]) -> list[Strip]:
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
        places = strip.places[run[0] : run[1]]
        part = Strip(strip.chains, places, strip.widths[run[0] : run[1]], strip.inside, strip.length * len(places) / len(free))
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
