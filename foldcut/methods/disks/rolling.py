"""Disks that roll into a gap: the largest disk that touches the two disks of a leaf and a third one.

A growing disk that touches both disks of a leaf starts at their point of tangency and rolls into the gap until it meets
another disk. ``RolledDisks`` remembers the result for each leaf until a new disk is in its way. There are two
implementations, with the same results bit for bit: ``RolledOneByOne`` in numpy, ``RolledTogether`` with compiled code.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from foldcut.core.arrays import Bools, Floats, Ints, Numbers
from foldcut.methods.disks.chains import Chain, Leaf, leaves
from foldcut.methods.disks.tolerance import Tolerance

if TYPE_CHECKING:
    from foldcut.methods.disks.packing_compiled import GapFiller

__all__ = ["EQUAL", "Candidate", "GrowingDisks", "RolledDisks", "RolledOneByOne", "RolledTogether", "largest_first"]

EQUAL = 1e-9
"""Radii that differ by less than this fraction are equal: the choice between them must not depend on rounding."""


class Candidate(NamedTuple):
    """A disk that could be placed: it touches the leaf's two disks and at least one other."""

    x: float
    y: float
    radius: float


class GrowingDisks:
    """The disks placed so far: the first ``count`` rows of ``centres`` ``(m, 2)`` and ``radii`` ``(m,)``, in mm."""

    def __init__(self, centres: Floats, radii: Floats) -> None:
        self.count = len(radii)
        self.centres = np.concatenate([centres, np.empty((self.count + 16, 2))])
        self.radii = np.concatenate([radii, np.empty(self.count + 16)])

    def append(self, centre: Floats, radius: float) -> int:
        """Add a disk and return its number."""
        disk = self.count
        self._make_room(disk + 1)
        self.centres[disk], self.radii[disk] = centre, radius
        self.count += 1
        return disk

    def extend(self, centres: Floats, radii: Floats) -> None:
        """Add several disks."""
        end = self.count + len(radii)
        self._make_room(end)
        self.centres[self.count : end], self.radii[self.count : end] = centres, radii
        self.count = end

    def _make_room(self, count: int) -> None:
        if count > len(self.radii):
            more = max(len(self.radii), count - len(self.radii))
            self.centres = np.concatenate([self.centres, np.empty((more, 2))])
            self.radii = np.concatenate([self.radii, np.empty(more)])

    def overlaps(self, disk: int, centres: Floats, radii: Floats, tolerance: Tolerance) -> tuple[Bools, Bools]:
        """Tell of other disks whether they overlap ``disk``, and whether they overlap or touch it."""
        x, y = centres[:, 0] - self.centres[disk, 0], centres[:, 1] - self.centres[disk, 1]
        slack = np.sqrt(x * x + y * y) - radii - self.radii[disk]
        allowed = tolerance.touching(radii, np.full(len(radii), self.radii[disk]))
        return slack < -allowed, slack <= allowed

    def touches(self, candidate: Candidate, disk: int) -> bool:
        """Tell whether ``candidate`` touches ``disk``, up to a millionth of the smaller radius."""
        radius = float(self.radii[disk])
        x, y = candidate.x - float(self.centres[disk, 0]), candidate.y - float(self.centres[disk, 1])
        slack = math.sqrt(x * x + y * y) - candidate.radius - radius
        return abs(slack) <= 1e-6 * min(candidate.radius, radius)

    def roll(self, i: int, j: int, disks: Ints) -> Candidate | None:
        """Return the largest disk left of i -> j that touches both and overlaps none of ``disks``, if there is one.

        Inversion about the tangency point of i and j maps the two disks to the borders of a strip. Every disk tangent
        to both becomes a circle as wide as the strip, of width W. The growing disk first meets the disk (x', y', r')
        with the largest y' + sqrt((W / 2 + r')^2 - (x' - middle)^2).
        """
        (x_i, y_i), r_i = self.centres[i].tolist(), float(self.radii[i])
        (x_j, y_j), r_j = self.centres[j].tolist(), float(self.radii[j])
        along_x, along_y = x_j - x_i, y_j - y_i
        length = math.sqrt(along_x * along_x + along_y * along_y)
        along_x, along_y = along_x / length, along_y / length
        origin_x, origin_y = x_i + along_x * r_i, y_i + along_y * r_i
        others = disks[(disks != i) & (disks != j)]
        off_x, off_y = self.centres[others, 0] - origin_x, self.centres[others, 1] - origin_y
        x, y, r = off_x * along_x + off_y * along_y, off_y * along_x - off_x * along_y, self.radii[others]
        power = x * x + y * y - r * r
        middle, half_width = (1 / r_j - 1 / r_i) / 4, (1 / r_j + 1 / r_i) / 4
        with np.errstate(all="ignore"):
            reach = (half_width + r / power) ** 2 - (x / power - middle) ** 2
            height = np.where((reach > 0) & (power > 0), y / power + np.sqrt(reach), -np.inf)
        top = float(height.max(initial=-math.inf))
        denominator = middle * middle + top * top - half_width * half_width
        if not math.isfinite(top) or denominator <= 0 or top <= 0:
            return None
        forward, left = middle / denominator, top / denominator
        x_new, y_new = origin_x + along_x * forward - along_y * left, origin_y + along_y * forward + along_x * left
        return Candidate(x_new, y_new, half_width / denominator)

    def beyond(self, ear: Candidate, i: int, j: int, k: int, disks: Ints) -> list[Candidate]:
        """Return the first of ``disks`` met by a disk that grows away from ``ear`` and always touches i and k.

        The very first is the answer; where rounding makes that doubtful, the one after it may be. So there are up to
        two candidates, the nearer first.
        """
        x, y = (self.centres[k] - self.centres[i]).tolist()  # the gap is on the left of i -> j -> k
        others = disks[(disks != i) & (disks != j) & (disks != k)]
        centres, radii = self._apollonius(i, k, others)
        ahead = (centres[:, 1] - ear.y) * x - (centres[:, 0] - ear.x) * y
        usable = np.isfinite(radii) & (radii > 0) & (ahead > 1e-6 * ear.radius * math.sqrt(x * x + y * y))
        order = np.argsort(np.where(usable, ahead, np.inf), kind="stable")[: min(2, int(usable.sum()))]
        return [Candidate(float(centres[n, 0]), float(centres[n, 1]), float(radii[n])) for n in order]

    def _apollonius(self, i: int, j: int, others: Ints) -> tuple[Floats, Floats]:
        """Return centres and radii of the disks that touch i, j and one of ``others`` from outside.

        Where there is none the radius is negative or not finite.
        """
        a, r_a = self.centres[i], self.radii[i]
        to_j, r_j = self.centres[j] - a, self.radii[j] - r_a
        to_k, r_k = self.centres[others] - a, self.radii[others] - r_a
        determinant = to_j[0] * to_k[:, 1] - to_j[1] * to_k[:, 0]
        with np.errstate(all="ignore"):
            # |c| = r + r_a and |c - to| = r + r_a + dr give two equations linear in c and R = r + r_a: c = p + q R
            b_j = (to_j[0] * to_j[0] + to_j[1] * to_j[1] - r_j * r_j) / 2
            b_k = (np.sum(to_k * to_k, axis=1) - r_k * r_k) / 2
            p = np.stack([b_j * to_k[:, 1] - b_k * to_j[1], b_k * to_j[0] - b_j * to_k[:, 0]], axis=1)
            q = np.stack([r_k * to_j[1] - r_j * to_k[:, 1], r_j * to_k[:, 0] - r_k * to_j[0]], axis=1)
            p, q = p / determinant[:, None], q / determinant[:, None]
            square, half_linear, constant = (q * q).sum(axis=1) - 1, (p * q).sum(axis=1), (p * p).sum(axis=1)
            root = np.sqrt(half_linear**2 - square * constant)
            reach = np.concatenate([(-half_linear + root) / square, (-half_linear - root) / square])
            return a + np.tile(p, (2, 1)) + np.tile(q, (2, 1)) * reach[:, None], reach - r_a


def largest_first(found: list[tuple[Candidate, Leaf]]) -> Iterator[tuple[Candidate, Leaf]]:
    """Yield the largest candidates first; among radii equal up to rounding, the lowest leaf first."""
    found.sort(key=lambda item: -item[0].radius)
    start = 0
    while start < len(found):
        smallest = found[start][0].radius * (1 - EQUAL)
        end = next((k for k in range(start, len(found)) if found[k][0].radius < smallest), len(found))
        yield from sorted(found[start:end], key=lambda item: item[1])
        start = end


class RolledDisks(Protocol):
    """The disk that rolls in from each leaf, remembered until a new disk is in its way."""

    def largest_first(self, gap: list[Chain], disks: Ints, without: set[Leaf]) -> Iterator[tuple[Candidate, Leaf]]:
        """Yield the disks of the gap's leaves, the largest first, except the leaves in ``without``.

        ``disks``: the disks that the gap's chains visit, each once, in ascending order.
        """

    def known(self, leaf: Leaf) -> Candidate | None:
        """Return the disk of a leaf, if one is known."""

    def forget_blocked(self, gap: list[Chain], disk: int) -> tuple[Iterable[Leaf], Iterable[Leaf]]:
        """Drop the gap's disks that overlap a new disk.

        Returns the leaves of these, and the leaves of all that overlap or touch the new disk.
        """


class RolledOneByOne:
    """``RolledDisks`` in numpy: each leaf against all disks of its gap."""

    def __init__(self, disks: GrowingDisks, tolerance: Tolerance) -> None:
        self._disks = disks
        self._tolerance = tolerance
        self._rolled: dict[Leaf, Candidate | None] = {}

    def largest_first(self, gap: list[Chain], disks: Ints, without: set[Leaf]) -> Iterator[tuple[Candidate, Leaf]]:
        """See ``RolledDisks``."""
        rolled: list[tuple[Candidate, Leaf]] = []
        for leaf in leaves(gap):
            if leaf in without:
                continue
            if leaf not in self._rolled:
                self._rolled[leaf] = self._disks.roll(*leaf, disks)
            candidate = self._rolled[leaf]
            if candidate is not None:
                rolled.append((candidate, leaf))
        return largest_first(rolled)

    def known(self, leaf: Leaf) -> Candidate | None:
        """See ``RolledDisks``."""
        return self._rolled.get(leaf)

    def forget_blocked(self, gap: list[Chain], disk: int) -> tuple[Iterable[Leaf], Iterable[Leaf]]:
        """See ``RolledDisks``."""
        its_leaves = [leaf for leaf in leaves(gap) if self._rolled.get(leaf)]
        rolled = [candidate for leaf in its_leaves if (candidate := self._rolled[leaf])]
        rows = np.array(rolled).reshape(-1, 3)
        blocked, touched = self._disks.overlaps(disk, rows[:, :2], rows[:, 2], self._tolerance)
        gone = [its_leaves[k] for k in np.flatnonzero(blocked)]
        for leaf in gone:
            del self._rolled[leaf]
        return gone, [its_leaves[k] for k in np.flatnonzero(touched)]


class RolledTogether:
    """``RolledDisks`` by compiled code: all new leaves at once.

    Leaves are numbers, in the same order as the pairs that they stand for. A radius that is not positive says that no
    disk rolls in.
    """

    def __init__(self, disks: GrowingDisks, tolerance: Tolerance, filler: GapFiller) -> None:
        self._disks = disks
        self._tolerance = tolerance
        self._filler = filler
        self._leaves: Numbers = np.empty(0, dtype=np.int64)  # ascending
        self._centres = np.empty((0, 2))
        self._radii = np.empty(0)

    def largest_first(self, gap: list[Chain], disks: Ints, without: set[Leaf]) -> Iterator[tuple[Candidate, Leaf]]:
        """See ``RolledDisks``."""
        its_leaves = _leaf_numbers(gap)
        new = its_leaves[self._rows(its_leaves) < 0]
        self._filler.add(self._disks.centres, self._disks.radii, self._disks.count)
        self._add(new, *self._filler.roll(_pairs(new).astype(np.int32)))
        left_out = np.fromiter((_number(*leaf) for leaf in without), dtype=np.int64)
        rows = self._rows(its_leaves[~np.isin(its_leaves, left_out)])
        return self._largest_rows_first(rows[self._radii[rows] > 0])

    def known(self, leaf: Leaf) -> Candidate | None:
        """See ``RolledDisks``."""
        row = int(self._rows(np.array([_number(*leaf)]))[0])
        return self._candidate(row) if row >= 0 and self._radii[row] > 0 else None

    def forget_blocked(self, gap: list[Chain], disk: int) -> tuple[Iterable[Leaf], Iterable[Leaf]]:
        """See ``RolledDisks``."""
        rows = self._rows(_leaf_numbers(gap))
        rows = rows[(rows >= 0) & (self._radii[rows] > 0)]
        blocked, touched = self._disks.overlaps(disk, self._centres[rows], self._radii[rows], self._tolerance)
        gone, near = self._leaves[rows[blocked]], self._leaves[rows[touched]]
        self._drop(rows[blocked])
        return map(tuple, _pairs(gone).tolist()), map(tuple, _pairs(near).tolist())

    def _rows(self, its_leaves: Numbers) -> Numbers:
        """The rows of leaves, -1 for those not known."""
        if not len(self._leaves):
            return np.full(len(its_leaves), -1)
        at = np.minimum(np.searchsorted(self._leaves, its_leaves), len(self._leaves) - 1)
        return np.where(self._leaves[at] == its_leaves, at, -1)

    def _candidate(self, row: int) -> Candidate:
        return Candidate(float(self._centres[row, 0]), float(self._centres[row, 1]), float(self._radii[row]))

    def _add(self, new: Numbers, centres: Floats, radii: Floats) -> None:
        every = np.concatenate([self._leaves, new])
        order = np.argsort(every, kind="stable")
        self._leaves = every[order]
        self._centres = np.concatenate([self._centres, centres])[order]
        self._radii = np.concatenate([self._radii, radii])[order]

    def _drop(self, rows: Numbers) -> None:
        self._leaves, self._radii = np.delete(self._leaves, rows), np.delete(self._radii, rows)
        self._centres = np.delete(self._centres, rows, axis=0)

    def _largest_rows_first(self, rows: Numbers) -> Iterator[tuple[Candidate, Leaf]]:
        """Do for rows what ``largest_first`` does for candidates."""
        rows = rows[np.argsort(-self._radii[rows], kind="stable")]
        smallness, start = -self._radii[rows], 0
        while start < len(rows):
            end = int(np.searchsorted(smallness, smallness[start] * (1 - EQUAL), side="right"))
            for row in np.sort(rows[start:end]).tolist():
                i, j = _pairs(self._leaves[row : row + 1])[0].tolist()
                yield self._candidate(row), (i, j)
            start = end


def _number(i: int, j: int) -> int:
    return i << 32 | j


def _leaf_numbers(gap: list[Chain]) -> Numbers:
    chains = [np.array(chain, dtype=np.int64) for chain in gap if len(chain) > 1]
    return np.concatenate([np.empty(0, dtype=np.int64), *(chain << 32 | np.roll(chain, -1) for chain in chains)])


def _pairs(numbers: Numbers) -> Numbers:
    """The leaves with these numbers, ``(n, 2)``."""
    return np.stack([numbers >> 32, numbers & 0xFFFFFFFF], axis=1)
