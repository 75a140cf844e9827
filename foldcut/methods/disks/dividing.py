"""Dividing a gap: place the largest disk that helps, and find the gaps around it.

A disk *helps* if it overlaps none, touches at least three visits and leaves smaller gaps: it merges chains or divides
the only one. An *ear* is a disk that touches only three visits in a row, so that a gap as large as before would remain.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import chain as chained

import numpy as np

from foldcut.core.arrays import Floats, Ints, Numbers
from foldcut.geometry.planar_graph import pair_keys
from foldcut.geometry.vectors import contains_point, signed_area
from foldcut.methods.disks.chains import (
    TURN,
    Chain,
    Leaf,
    Places,
    StuckError,
    Visit,
    angle_between,
    arc,
    places_of_disk,
    places_of_disks,
    walk_from,
)
from foldcut.methods.disks.disk_pairs import touching_disks
from foldcut.methods.disks.rolling import Candidate, GrowingDisks, RolledDisks, largest_first
from foldcut.methods.disks.tolerance import Tolerance

__all__ = ["NEARLY", "Divider"]

NEARLY = 1e-3
"""A disk within this fraction of the smaller radius nearly touches: the creases would be far too short, so another
disk is preferred."""


@dataclass(frozen=True)
class _Placement:
    """A disk to place and the visits that it touches; ``nearly``: it nearly touches one more disk."""

    centre: Floats
    radius: float
    visits: list[Visit]
    nearly: bool


class Divider:
    """Divides gaps of any number of chains and adds the new disks to ``disks``."""

    def __init__(self, disks: GrowingDisks, rolled: RolledDisks, tolerance: Tolerance) -> None:
        self.disks = disks
        self.rolled = rolled
        self.tolerance = tolerance
        self._ears: set[Leaf] = set()  # leaves whose disk does not help; this stays so as long as the disk
        self._lonely: set[Leaf] = set()  # leaves whose disk touches only one chain, until a new disk touches it

    def split_at_touching_disks(self, chains: list[Chain]) -> list[list[Chain]]:
        """Add the tangency edges between boundary disks that touch across a face; return the gaps that result."""
        disks = np.concatenate(chains).astype(np.int32)
        following = np.concatenate([chain[1:] + chain[:1] for chain in chains]).astype(np.int32)
        left, right = touching_disks(
            self.disks.centres[disks], self.disks.radii[disks], np.zeros(len(disks), dtype=np.int32), self.tolerance
        )
        one, other = disks[left], disks[right]
        across = ~np.isin(_unordered_keys(one, other), _unordered_keys(disks, following))
        gaps = [chains]
        members = [set(disks.tolist())]  # of each gap
        for a, b in zip(one[across].tolist(), other[across].tolist(), strict=True):
            for number, gap in enumerate(gaps):
                if a not in members[number] or b not in members[number]:
                    continue
                visit_a = self._visit(gap, a, self.disks.centres[b])
                visit_b = self._visit(gap, b, self.disks.centres[a])
                if visit_a is not None and visit_b is not None:
                    parts = self._add_edge(gap, visit_a, visit_b)
                    gaps[number : number + 1] = parts
                    if len(parts) > 1:  # else the disks are the same
                        members[number : number + 1] = [set(chained.from_iterable(part)) for part in parts]
                    break
        return gaps

    def divide(self, gap: list[Chain]) -> list[list[Chain]]:
        """Place the largest disk that helps and return the gaps around it. Raises ``StuckError``."""
        disks = np.unique(np.concatenate(gap))
        placement = self._best_leaf(gap, disks) or self._best_inner(gap, disks)
        if placement is None:
            raise StuckError(gap, self.middle(gap))
        return self._place(gap, placement)

    def middle(self, gap: list[Chain]) -> tuple[float, float]:
        """Return the mean of the centres that the first chain visits."""
        x, y = self.disks.centres[gap[0]].mean(axis=0)
        return float(x), float(y)

    # --- the choice of the disk

    def _best_leaf(self, gap: list[Chain], disks: Ints) -> _Placement | None:
        """Return the largest disk rolled in from a leaf that merges chains or divides the only one."""
        places = places_of_disks(gap) if len(gap) > 1 else None
        if places is not None:
            for candidate, leaf in self.rolled.largest_first(gap, disks, {*self._ears, *self._lonely}):
                placement = self._fit_leaf(gap, disks, candidate, leaf, places)
                if placement is not None and not placement.nearly and leaf not in self._lonely:
                    return placement
        second_best = None
        for candidate, leaf in self.rolled.largest_first(gap, disks, self._ears):
            placement = self._fit_leaf(gap, disks, candidate, leaf, places)
            if placement is not None and not placement.nearly and len(gap) == 1:
                return placement
            second_best = second_best or placement
        return second_best

    def _fit_leaf(
        self, gap: list[Chain], disks: Ints, candidate: Candidate, leaf: Leaf, places: Places | None
    ) -> _Placement | None:
        """Fit a leaf's disk, and note ears and lonely disks, which need not be tried again."""
        placement = self._fit(gap, disks, candidate, places)
        if placement is None:
            self._ears.add(leaf)
        elif len({number for number, _ in placement.visits}) == 1:
            self._lonely.add(leaf)
        return placement

    def _best_inner(self, gap: list[Chain], disks: Ints) -> _Placement | None:
        """Return the largest disk that helps where every leaf's disk is an ear: one met beyond an ear.

        An ear touches the visits i, j, k in a row. Growing on between i and k, away from j, it meets the next disk.
        """
        found: list[tuple[Candidate, Leaf]] = []
        for chain in gap:
            for i, j, k in zip(chain, chain[1:] + chain[:1], chain[2:] + chain[:2], strict=True):
                ear = self.rolled.known((i, j))
                if ear is not None and i != k and self.disks.touches(ear, k):
                    found += [(candidate, (i, j)) for candidate in self.disks.beyond(ear, i, j, k, disks)]
        for candidate, _ in largest_first(found):
            placement = self._fit(gap, disks, candidate)
            if placement is not None:
                return placement
        return None

    def _fit(
        self, gap: list[Chain], disks: Ints, candidate: Candidate, places: Places | None = None
    ) -> _Placement | None:
        """Return where ``candidate`` touches the gap, or None if it does not help."""
        centre, radius = np.array(candidate[:2]), candidate.radius
        x, y = self.disks.centres[disks, 0] - centre[0], self.disks.centres[disks, 1] - centre[1]
        radii = self.disks.radii[disks]
        slack = np.sqrt(x * x + y * y) - radii - radius
        allowed = self.tolerance.touching(radii, np.full(len(disks), radius))
        if (slack < -allowed).any():
            return None
        visits = [self._visit(gap, int(disk), centre, places) for disk in disks[slack <= allowed]]
        seen = [visit for visit in visits if visit is not None]
        if len(seen) < 3 or len(seen) < len(visits):
            return None
        if len({number for number, _ in seen}) == 1:
            size = len(gap[seen[0][0]])
            positions = sorted(position for _, position in seen)
            arcs = [(b - a) % size for a, b in zip(positions, positions[1:] + positions[:1], strict=True)]
            if max(arcs) + 2 >= size:
                return None  # an ear
        close = (slack > allowed) & (slack < NEARLY * np.minimum(radii, radius))
        return _Placement(centre, radius, seen, bool(close.any()))

    def _visit(self, gap: list[Chain], disk: int, toward: Floats, places: Places | None = None) -> Visit | None:
        """Find the visit to ``disk`` whose sector of the gap contains the direction toward a point.

        Returns None if there is no such visit. ``places``: the visits to all disks of the gap, if they are known.
        """
        best: tuple[float, Visit] | None = None
        x, y = self.disks.centres[disk].tolist()
        to_x, to_y = toward.tolist()
        for number, position in places_of_disk(gap, disk) if places is None else places.get(disk, ()):
            chain = gap[number]
            start_x, start_y = self.disks.centres[chain[(position + 1) % len(chain)]].tolist()
            end_x, end_y = self.disks.centres[chain[position - 1]].tolist()
            start = start_x - x, start_y - y
            turn = angle_between(start, (to_x - x, to_y - y))
            excess = turn - (angle_between(start, (end_x - x, end_y - y)) or TURN)
            outside = 0.0 if excess <= 0 else min(excess, TURN - turn)
            if best is None or outside < best[0]:
                best = (outside, (number, position))
        return best[1] if best and best[0] < 1e-6 else None

    # --- the gaps around the disk

    def _place(self, gap: list[Chain], placement: _Placement) -> list[list[Chain]]:
        """Add the disk with its tangency edges and return the gaps around it."""
        visited = [gap[number][position] for number, position in placement.visits]
        disk = self.disks.append(*self._polish(placement, np.array(visited)))
        blocked, touched = self.rolled.forget_blocked(gap, disk)
        self._ears.difference_update(blocked)
        self._lonely.difference_update(touched)
        away = self.disks.centres[visited] - self.disks.centres[disk]
        counter_clockwise = np.argsort(np.arctan2(away[:, 1], away[:, 0])).tolist()
        spokes = [placement.visits[k] for k in counter_clockwise]
        number_of = {visit: k for k, visit in enumerate(spokes)}
        left = set(range(len(spokes)))
        parts = []
        while left:
            start = spoke = min(left)
            part: Chain = []
            while spoke in left:
                left.discard(spoke)
                number, position = spokes[spoke]
                chain = gap[number]
                stops = [at for which, at in spokes if which == number]
                stop = min(stops, key=lambda at: (at - position - 1) % len(chain))
                part += [disk, *arc(chain, position, stop, whole=stop == position)]
                spoke = (number_of[number, stop] - 1) % len(spokes)
            assert spoke == start
            parts.append(part)
        crossed = {number for number, _ in spokes}
        return self._share(parts, [chain for number, chain in enumerate(gap) if number not in crossed])

    def _polish(self, placement: _Placement, touched: Ints | Numbers) -> tuple[Floats, float]:
        """Improve the disk by Newton's method on |c - c_k| = r + r_k, so that rounding does not add up.

        Each step is the least-squares solution for the movement and the growth: the growth is what remains of the mean,
        the movement is found by Gram-Schmidt.
        """
        x, y = placement.centre.tolist()
        radius = placement.radius
        around = [*zip(*self.disks.centres[touched].T.tolist(), self.disks.radii[touched].tolist(), strict=True)]
        count = len(around)
        for _ in range(2):
            rows = []
            for x_k, y_k, r_k in around:
                away_x, away_y = x - x_k, y - y_k
                distance = math.sqrt(away_x * away_x + away_y * away_y)
                rows.append((away_x / distance, away_y / distance, radius + r_k - distance))
            mean = [0.0, 0.0, 0.0]
            for row in rows:
                mean = [mean[0] + row[0], mean[1] + row[1], mean[2] + row[2]]
            mean = [mean[0] / count, mean[1] / count, mean[2] / count]
            rows = [(row[0] - mean[0], row[1] - mean[1], row[2] - mean[2]) for row in rows]
            first = second = mixed = to_first = to_second = 0.0
            for u, v, _ in rows:
                first, mixed = first + u * u, mixed + u * v
            if first == 0.0:
                return placement.centre, placement.radius
            share = mixed / first
            for u, v, off in rows:
                rest = v - share * u
                second, to_first, to_second = second + rest * rest, to_first + u * off, to_second + rest * off
            if second == 0.0:
                return placement.centre, placement.radius
            step_y = to_second / second
            step_x = to_first / first - share * step_y
            growth = mean[0] * step_x + mean[1] * step_y - mean[2]
            if not max(abs(step_x), abs(step_y), abs(growth)) < 1e-3 * radius:
                return placement.centre, placement.radius
            x, y, radius = x + step_x, y + step_y, radius + growth
        return np.array([x, y]), radius

    def _add_edge(self, gap: list[Chain], a: Visit, b: Visit) -> list[list[Chain]]:
        """Join two visits of a gap: within one chain this splits the gap, between two it merges them."""
        others = [chain for number, chain in enumerate(gap) if number not in (a[0], b[0])]
        if a[0] != b[0]:
            return [[walk_from(gap[a[0]], a[1]) + walk_from(gap[b[0]], b[1]), *others]]
        chain = gap[a[0]]
        return self._share([arc(chain, a[1], b[1]), arc(chain, b[1], a[1])], others)

    def _share(self, parts: list[Chain], others: list[Chain]) -> list[list[Chain]]:
        """Give each of the remaining chains to the part of the gap that it lies in.

        If the gap surrounds the divided chain, one of the parts still runs clockwise: it gets the chains that lie in
        none of the other parts.
        """
        gaps = [[part] for part in parts]
        if not others:
            return gaps
        areas = [signed_area(self.disks.centres[part] - self.disks.centres[part[0]]) for part in parts]
        rest = areas.index(min(areas))
        starts = self.disks.centres[[chain[0] for chain in others]]
        place = np.full(len(others), rest)
        for number, part in enumerate(parts):
            if number != rest and areas[number] > 0:
                polygon = self.disks.centres[part]
                near = ((starts >= polygon.min(axis=0)) & (starts <= polygon.max(axis=0))).all(axis=1)
                for at in np.flatnonzero(near & (place == rest)):
                    if contains_point(polygon, starts[at]):
                        place[at] = number
        for number, chain in zip(place.tolist(), others, strict=True):
            gaps[number].append(chain)
        return gaps


def _unordered_keys(one: Ints, other: Ints) -> Numbers:
    """A number for each pair of disks, whichever of the two comes first."""
    return pair_keys(np.minimum(one, other), np.maximum(one, other))
