"""Filling the gaps: disks are added until every gap between them has three or four sides.

``BoundaryDisks`` -> ``Packing`` (paper section 2, second half).

A gap is a set of *chains*: cyclic sequences of visits to disks that touch in a row, with the gap on their left; one
disk may be visited more than once. A *leaf* is a pair of consecutive visits; rolling a growing disk from their point
of tangency into the gap gives the largest disk that touches both and a third. Of these the largest that helps is
placed, with a tangency edge to every disk it touches.

Invariants: consecutive disks of a gap touch; disks of a face do not overlap; every gap has 3 or 4 visits; the polygons
of the gaps tile the sheet (less the ribbon).
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain as chained
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from foldcut.core.arrays import Bools, Floats, Ints, Numbers, Ragged, index_array, points_array
from foldcut.core.errors import UnfoldableError
from foldcut.geometry.planar_graph import pair_keys
from foldcut.geometry.tolerance import Tolerance
from foldcut.geometry.vectors import contains_point, signed_area
from foldcut.methods.disks.boundary import BoundaryDisks, overlapping_disks, touching_disks

if TYPE_CHECKING:
    from foldcut.methods.disks.packing_compiled import GapFiller

Chain = list[int]
Leaf = tuple[int, int]
Places = dict[int, list[tuple[int, int]]]  # by disk the visits to it: chain, position
TURN = 2 * math.pi
# A disk that nearly touches another, by this part of the smaller one, makes creases far too short: take another disk.
NEARLY = 1e-3
# Radii that differ by less than this part are equal: the choice between them must not depend on rounding.
EQUAL = 1e-9
# From so many disks on boundaries on, loading compiled code takes less time than it saves; once loaded it does all.
MANY_DISKS = 1_000
COMPILING = "compiling, once on this machine"
Progress = Callable[[float, str], None]


@dataclass(frozen=True, eq=False)
class Packing:
    """The finished packing.

    ``centres`` ``(n, 2)`` and ``radii`` ``(n,)`` in mm; ``node`` ``(n,)``: two disks on either side of one boundary
    point share a node; ``gaps`` ragged: the disks of each gap counter-clockwise, ``gap_face`` ``(gaps,)``;
    ``boundary_count``: how many disks lie on boundaries (they come first).
    """

    centres: Floats
    radii: Floats
    node: Ints
    gaps: Ragged
    gap_face: Ints
    face_inside: Bools
    loop_nodes: Ragged
    ribbon: float
    boundary_count: int


class _Candidate(NamedTuple):
    """A disk that touches the leaf's two disks and at least one other."""

    x: float
    y: float
    radius: float


@dataclass(frozen=True)
class _Placement:
    """A disk to place and the visits, ``(chain, position)``, it touches; ``nearly``: and one more, all but."""

    centre: Floats
    radius: float
    visits: list[tuple[int, int]]
    nearly: bool


def fill_gaps(boundary: BoundaryDisks, tolerance: Tolerance, progress: Progress | None = None) -> Packing:
    """Add disks until all gaps are 3-gaps or 4-gaps.

    ``progress`` is called with the part done, 0 to 1 (an estimate), and what is done besides, mostly "". Raises
    ``UnfoldableError`` with the place when a gap cannot be divided further. Source: paper section 2; Bern, Mitchell
    and Ruppert 1995 for the choice of disks.
    """
    filler = _Filler(boundary, tolerance, progress)
    values: list[Ints] = []
    lengths: list[Ints] = []
    faces: list[Ints] = []
    for face in range(len(boundary.face_inside)):
        chains = [
            row.tolist() for row, its_face in zip(boundary.chains, boundary.chain_face, strict=True) if its_face == face
        ]
        for its_values, its_lengths in filler.fill(chains):
            values.append(its_values)
            lengths.append(its_lengths)
            faces.append(np.full(len(its_lengths), face, dtype=np.int32))
    count = filler.count
    offsets = np.concatenate([[0], np.cumsum(np.concatenate(lengths))])
    new_nodes = np.arange(count - len(boundary.node), dtype=np.int32) + int(boundary.node.max()) + 1
    return Packing(
        points_array(filler.centres[:count]),
        filler.radii[:count].copy(),
        index_array(np.concatenate([boundary.node, new_nodes])),
        Ragged(index_array(np.concatenate(values)), index_array(offsets)),
        index_array(np.concatenate(faces)),
        boundary.face_inside,
        boundary.loop_nodes,
        boundary.ribbon,
        len(boundary.radii),
    )


class _Filler:
    """The growing arrays of disks, and what divides gaps."""

    def __init__(self, boundary: BoundaryDisks, tolerance: Tolerance, progress: Progress | None) -> None:
        self.tolerance = tolerance
        self.progress = progress
        self.count = self.boundary_count = len(boundary.radii)
        self.compiled = _compiled_filler(tolerance) if self.count >= MANY_DISKS or _is_loaded() else None
        self.rolled: dict[Leaf, _Candidate | None] = {}  # by leaf, until a disk is placed in its way
        self.many_rolled = _ManyRolled()  # the same where code is compiled
        self.ears: set[Leaf] = set()  # leaves whose disk would not help; this lasts as long as the disk
        self.lonely: set[Leaf] = set()  # leaves whose disk touches one chain only, until a new disk touches it
        self.centres = np.concatenate([boundary.centres, np.empty((self.count + 16, 2))])
        self.radii = np.concatenate([boundary.radii, np.empty(self.count + 16)])

    def fill(self, chains: list[Chain]) -> Iterator[tuple[Ints, Ints]]:
        """Yield the finished gaps of the face between ``chains``: their disks, and how many each has."""
        if self.compiled:
            disks = np.concatenate(chains).astype(np.int32)
            if self.compiled.start(np.unique(disks), self.centres, self.radii, self.count):
                self._report(COMPILING)
        stack = self._split_at_touching_disks(chains)
        done: list[Chain] = []
        while stack:
            gap = stack.pop()
            if len(gap) == 1 and len(gap[0]) <= 4:
                if len(gap[0]) < 3:
                    raise self._stuck(gap)
                done.append(gap[0])
                if len(done) % 64 == 0:
                    self._report()
            elif len(gap) == 1 and self.compiled:
                yield _flat(done)
                done = []
                yield self._fill_compiled(self.compiled, gap[0])
            else:
                stack.extend(self._divide(gap))
        yield _flat(done)

    def _fill_compiled(self, filler: GapFiller, chain: Chain) -> tuple[Ints, Ints]:
        """Fill the gap of one chain with compiled code, which does as ``_divide`` does."""
        filler.add(self.centres, self.radii, self.count)
        try:
            centres, radii, values, offsets = filler.fill(np.array(chain, dtype=np.int32), self._report)
        except ValueError as error:
            raise self._stuck([list(error.args[0])]) from None
        end = self.count + len(radii)
        self._make_room(end)
        self.centres[self.count : end], self.radii[self.count : end] = centres, radii
        self.count = end
        return values, np.diff(offsets)

    def _report(self, doing: str = "") -> None:
        if self.progress is not None:  # about as many disks are added as are on boundaries
            self.progress(min(0.99, (self.count - self.boundary_count) / max(1, self.boundary_count)), doing)

    def _stuck(self, chains: list[Chain]) -> UnfoldableError:
        x, y = self.centres[chains[0]].mean(axis=0)
        sizes = " and ".join(str(len(chain)) for chain in chains)
        return UnfoldableError(
            f"no disk divides the gap of {sizes} disks near ({x:.3f}, {y:.3f}) mm; "
            "move the drawing or its corners a little, or use a bigger sheet"
        )

    def _split_at_touching_disks(self, chains: list[Chain]) -> list[list[Chain]]:
        """Add the tangency edges between boundary disks that touch across the face."""
        disks = np.concatenate(chains).astype(np.int32)
        following = np.concatenate([chain[1:] + chain[:1] for chain in chains]).astype(np.int32)
        left, right = touching_disks(
            self.centres[disks], self.radii[disks], np.zeros(len(disks), dtype=np.int32), self.tolerance
        )
        one, other = disks[left], disks[right]
        across = ~np.isin(_pair_keys(one, other), _pair_keys(disks, following))
        gaps = [chains]
        members = [set(disks.tolist())]  # of each gap
        for a, b in zip(one[across].tolist(), other[across].tolist(), strict=True):
            for number, gap in enumerate(gaps):
                if a not in members[number] or b not in members[number]:
                    continue
                visit_a, visit_b = self._visit(gap, a, self.centres[b]), self._visit(gap, b, self.centres[a])
                if visit_a is not None and visit_b is not None:
                    parts = self._add_edge(gap, visit_a, visit_b)
                    gaps[number : number + 1] = parts
                    if len(parts) > 1:  # else the disks are the same
                        members[number : number + 1] = [set(chained.from_iterable(part)) for part in parts]
                    break
        return gaps

    def _add_edge(self, gap: list[Chain], a: tuple[int, int], b: tuple[int, int]) -> list[list[Chain]]:
        """Join two visits of a gap: inside one chain this splits the gap, between two it merges them."""
        others = [chain for number, chain in enumerate(gap) if number not in (a[0], b[0])]
        if a[0] != b[0]:
            return [[_walk_from(gap[a[0]], a[1]) + _walk_from(gap[b[0]], b[1]), *others]]
        chain = gap[a[0]]
        return self._share([_arc(chain, a[1], b[1]), _arc(chain, b[1], a[1])], others)

    def _share(self, parts: list[Chain], others: list[Chain]) -> list[list[Chain]]:
        """Give each of the remaining chains to the part of the gap it lies in.

        Of the parts of a chain that the gap surrounds, one still runs clockwise: it has what is in none of the others.
        """
        gaps = [[part] for part in parts]
        if not others:
            return gaps
        areas = [signed_area(self.centres[part] - self.centres[part[0]]) for part in parts]
        rest = areas.index(min(areas))
        starts = self.centres[[chain[0] for chain in others]]
        place = np.full(len(others), rest)
        for number, part in enumerate(parts):
            if number != rest and areas[number] > 0:
                polygon = self.centres[part]
                near = ((starts >= polygon.min(axis=0)) & (starts <= polygon.max(axis=0))).all(axis=1)
                for at in np.flatnonzero(near & (place == rest)):
                    if contains_point(polygon, starts[at]):
                        place[at] = number
        for number, chain in zip(place.tolist(), others, strict=True):
            gaps[number].append(chain)
        return gaps

    def _visit(
        self, gap: list[Chain], disk: int, toward: Floats, places: Places | None = None
    ) -> tuple[int, int] | None:
        """Find the visit to ``disk`` whose sector of the gap looks toward a point; None if there is none.

        ``places`` are those of all disks of the gap, if they are known.
        """
        best: tuple[float, tuple[int, int]] | None = None
        x, y = self.centres[disk].tolist()
        to_x, to_y = toward.tolist()
        for number, position in _places(gap, disk) if places is None else places.get(disk, ()):
            chain = gap[number]
            start_x, start_y = self.centres[chain[(position + 1) % len(chain)]].tolist()
            end_x, end_y = self.centres[chain[position - 1]].tolist()
            start = start_x - x, start_y - y
            turn = _angle(start, (to_x - x, to_y - y))
            excess = turn - (_angle(start, (end_x - x, end_y - y)) or TURN)
            outside = 0.0 if excess <= 0 else min(excess, TURN - turn)
            if best is None or outside < best[0]:
                best = (outside, (number, position))
        return best[1] if best and best[0] < 1e-6 else None

    # --- dividing one gap

    def _divide(self, gap: list[Chain]) -> list[list[Chain]]:
        """Place the largest disk that helps and return the gaps around it."""
        disks = np.unique(np.concatenate(gap))
        placement = self._best_leaf(gap, disks) or self._best_inner(gap, disks)
        if placement is None:
            raise self._stuck(gap)
        return self._place(gap, placement)

    def _best_leaf(self, gap: list[Chain], disks: Ints) -> _Placement | None:
        """Return the largest disk rolled in from a leaf that merges chains or divides the only one."""
        places = _places_of_disks(gap) if len(gap) > 1 else None
        if places is not None:
            for candidate, leaf in self._rolled(gap, disks, {*self.ears, *self.lonely}):
                placement = self._tried(gap, disks, candidate, leaf, places)
                if placement is not None and not placement.nearly and leaf not in self.lonely:
                    return placement
        second_best = None
        for candidate, leaf in self._rolled(gap, disks, self.ears):
            placement = self._tried(gap, disks, candidate, leaf, places)
            if placement is not None and not placement.nearly and len(gap) == 1:
                return placement
            second_best = second_best or placement
        return second_best

    def _tried(
        self, gap: list[Chain], disks: Ints, candidate: _Candidate, leaf: Leaf, places: Places | None
    ) -> _Placement | None:
        """Try a leaf's disk and note what will not change."""
        placement = self._try(gap, disks, candidate, places)
        if placement is None:
            self.ears.add(leaf)
        elif len({number for number, _ in placement.visits}) == 1:
            self.lonely.add(leaf)
        return placement

    def _rolled(self, gap: list[Chain], disks: Ints, without: set[Leaf]) -> Iterator[tuple[_Candidate, Leaf]]:
        """Yield the disks of the leaves but for some, the largest first; those not known yet are rolled."""
        return self._roll_all(self.compiled, gap, without) if self.compiled else self._roll_each(gap, disks, without)

    def _roll_each(self, gap: list[Chain], disks: Ints, without: set[Leaf]) -> Iterator[tuple[_Candidate, Leaf]]:
        rolled: list[tuple[_Candidate, Leaf]] = []
        for leaf in _leaves(gap):
            if leaf in without:
                continue
            if leaf not in self.rolled:
                self.rolled[leaf] = self._roll(*leaf, disks)
            candidate = self.rolled[leaf]
            if candidate is not None:
                rolled.append((candidate, leaf))
        return _largest_first(rolled)

    def _roll_all(self, filler: GapFiller, gap: list[Chain], without: set[Leaf]) -> Iterator[tuple[_Candidate, Leaf]]:
        """Do the same by compiled code and arrays."""
        known, leaves = self.many_rolled, _leaf_numbers(gap)
        new = leaves[known.rows(leaves) < 0]
        filler.add(self.centres, self.radii, self.count)
        known.add(new, *filler.roll(_pairs(new).astype(np.int32)))
        left_out = np.fromiter((_number(*leaf) for leaf in without), dtype=np.int64)
        rows = known.rows(leaves[~np.isin(leaves, left_out)])
        return known.largest_first(rows[known.radii[rows] > 0])

    def _forget_blocked(self, gap: list[Chain], disk: int) -> None:
        """Drop the rolled disks of a gap that overlap a new disk."""
        if self.compiled:
            known = self.many_rolled
            rows = known.rows(_leaf_numbers(gap))
            rows = rows[(rows >= 0) & (known.radii[rows] > 0)]
            blocked, touched = self._overlaps(disk, known.centres[rows], known.radii[rows])
            self.ears.difference_update(map(tuple, _pairs(known.leaves[rows[blocked]]).tolist()))
            self.lonely.difference_update(map(tuple, _pairs(known.leaves[rows[touched]]).tolist()))
            known.drop(rows[blocked])
            return
        leaves = [leaf for leaf in _leaves(gap) if self.rolled.get(leaf)]
        rolled = [candidate for leaf in leaves if (candidate := self.rolled[leaf])]
        disks = np.array(rolled).reshape(-1, 3)
        blocked, touched = self._overlaps(disk, disks[:, :2], disks[:, 2])
        for k in np.flatnonzero(blocked):
            del self.rolled[leaves[k]]
            self.ears.discard(leaves[k])
        self.lonely.difference_update(leaves[k] for k in np.flatnonzero(touched))

    def _overlaps(self, disk: int, centres: Floats, radii: Floats) -> tuple[Bools, Bools]:
        """Whether disks overlap a disk that is there, and whether they do or touch it."""
        x, y = centres[:, 0] - self.centres[disk, 0], centres[:, 1] - self.centres[disk, 1]
        slack = np.sqrt(x * x + y * y) - radii - self.radii[disk]
        allowed = self.tolerance.touching(radii, np.full(len(radii), self.radii[disk]))
        return slack < -allowed, slack <= allowed

    def _roll(self, i: int, j: int, disks: Ints) -> _Candidate | None:
        """Return the largest disk left of i -> j that touches both and overlaps none of ``disks``.

        Inversion about the tangency point of i and j makes the two a strip; every disk tangent to both becomes a
        circle of the strip's width W, and the first one met by the growing disk is the one with the largest
        y' + sqrt((W / 2 + r')^2 - (x' - middle)^2).
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
        return _Candidate(x_new, y_new, half_width / denominator)

    def _best_inner(self, gap: list[Chain], disks: Ints) -> _Placement | None:
        """Return the largest disk that helps where every leaf's is an ear: the next one met beyond an ear.

        An ear touches the visits i, j, k in a row; going on between i and k, away from j, leads to the next disk.
        """
        found: list[tuple[_Candidate, Leaf]] = []
        for chain in gap:
            for i, j, k in zip(chain, chain[1:] + chain[:1], chain[2:] + chain[:2], strict=True):
                ear = self.many_rolled.get(i, j) if self.compiled else self.rolled.get((i, j))
                if ear is not None and i != k and self._touches(ear, k):
                    found += [(candidate, (i, j)) for candidate in self._beyond(ear, i, j, k, disks)]
        for candidate, _ in _largest_first(found):
            placement = self._try(gap, disks, candidate)
            if placement is not None:
                return placement
        return None

    def _touches(self, candidate: _Candidate, disk: int) -> bool:
        radius = float(self.radii[disk])
        x, y = candidate.x - float(self.centres[disk, 0]), candidate.y - float(self.centres[disk, 1])
        slack = math.sqrt(x * x + y * y) - candidate.radius - radius
        return abs(slack) <= 1e-6 * min(candidate.radius, radius)

    def _beyond(self, ear: _Candidate, i: int, j: int, k: int, disks: Ints) -> list[_Candidate]:
        """Return the first disks met by one that grows away from ``ear``, always touching i and k.

        The very first is the one; when rounding makes that doubtful, the next ones are.
        """
        x, y = (self.centres[k] - self.centres[i]).tolist()  # the gap is left of i -> j -> k
        others = disks[(disks != i) & (disks != j) & (disks != k)]
        centres, radii = self._apollonius(i, k, others)
        ahead = (centres[:, 1] - ear.y) * x - (centres[:, 0] - ear.x) * y
        usable = np.isfinite(radii) & (radii > 0) & (ahead > 1e-6 * ear.radius * math.sqrt(x * x + y * y))
        order = np.argsort(np.where(usable, ahead, np.inf), kind="stable")[: min(2, int(usable.sum()))]
        return [_Candidate(float(centres[n, 0]), float(centres[n, 1]), float(radii[n])) for n in order]

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

    def _try(
        self, gap: list[Chain], disks: Ints, candidate: _Candidate, places: Places | None = None
    ) -> _Placement | None:
        """Return where ``candidate`` touches the gap if it is free and leaves smaller gaps, else None."""
        centre, radius = np.array(candidate[:2]), candidate.radius
        x, y = self.centres[disks, 0] - centre[0], self.centres[disks, 1] - centre[1]
        radii = self.radii[disks]
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
                return None  # an ear: a gap as large as this one would remain
        close = (slack > allowed) & (slack < NEARLY * np.minimum(radii, radius))
        return _Placement(centre, radius, seen, bool(close.any()))

    def _place(self, gap: list[Chain], placement: _Placement) -> list[list[Chain]]:
        """Add the disk with its tangency edges and return the gaps around it."""
        visited = [gap[number][position] for number, position in placement.visits]
        disk = self._add_disk(placement, np.array(visited))
        self._forget_blocked(gap, disk)
        away = self.centres[visited] - self.centres[disk]
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
                part += [disk, *_arc(chain, position, stop, whole=stop == position)]
                spoke = (number_of[number, stop] - 1) % len(spokes)
            assert spoke == start
            parts.append(part)
        touched = {number for number, _ in spokes}
        return self._share(parts, [chain for number, chain in enumerate(gap) if number not in touched])

    def _add_disk(self, placement: _Placement, touched: Ints) -> int:
        self._make_room(self.count + 1)
        disk = self.count
        self.centres[disk], self.radii[disk] = self._polish(placement, touched)
        self.count += 1
        return disk

    def _make_room(self, count: int) -> None:
        if count > len(self.radii):
            more = max(len(self.radii), count - len(self.radii))
            self.centres = np.concatenate([self.centres, np.empty((more, 2))])
            self.radii = np.concatenate([self.radii, np.empty(more)])

    def _polish(self, placement: _Placement, touched: Ints) -> tuple[Floats, float]:
        """Newton's method on |c - c_k| = r + r_k, so that rounding does not add up from disk to disk.

        Each step is least squares for the movement and the growth; the growth is what the mean leaves over, the
        movement is found by Gram and Schmidt.
        """
        x, y = placement.centre.tolist()
        radius = placement.radius
        around = [*zip(*self.centres[touched].T.tolist(), self.radii[touched].tolist(), strict=True)]
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


class _ManyRolled:
    """The disks rolled in from leaves, as arrays in the order of the leaves' numbers; a radius of at most 0: none."""

    def __init__(self) -> None:
        self.leaves: Numbers = np.empty(0, dtype=np.int64)
        self.centres = np.empty((0, 2))
        self.radii = np.empty(0)

    def rows(self, leaves: Numbers) -> Numbers:
        """The rows of leaves, -1 where nothing is known."""
        if not len(self.leaves):
            return np.full(len(leaves), -1)
        at = np.minimum(np.searchsorted(self.leaves, leaves), len(self.leaves) - 1)
        return np.where(self.leaves[at] == leaves, at, -1)

    def get(self, i: int, j: int) -> _Candidate | None:
        row = int(self.rows(np.array([_number(i, j)]))[0])
        return self._candidate(row) if row >= 0 and self.radii[row] > 0 else None

    def _candidate(self, row: int) -> _Candidate:
        return _Candidate(float(self.centres[row, 0]), float(self.centres[row, 1]), float(self.radii[row]))

    def add(self, leaves: Numbers, centres: Floats, radii: Floats) -> None:
        leaves = np.concatenate([self.leaves, leaves])
        order = np.argsort(leaves, kind="stable")
        self.leaves = leaves[order]
        self.centres = np.concatenate([self.centres, centres])[order]
        self.radii = np.concatenate([self.radii, radii])[order]

    def drop(self, rows: Numbers) -> None:
        self.leaves, self.radii = np.delete(self.leaves, rows), np.delete(self.radii, rows)
        self.centres = np.delete(self.centres, rows, axis=0)

    def largest_first(self, rows: Numbers) -> Iterator[tuple[_Candidate, Leaf]]:
        """Do as ``_largest_first``."""
        rows = rows[np.argsort(-self.radii[rows], kind="stable")]
        smallness, start = -self.radii[rows], 0
        while start < len(rows):
            end = int(np.searchsorted(smallness, smallness[start] * (1 - EQUAL), side="right"))
            for row in np.sort(rows[start:end]).tolist():
                i, j = _pairs(self.leaves[row : row + 1])[0].tolist()
                yield self._candidate(row), (i, j)
            start = end


def _compiled_filler(tolerance: Tolerance) -> GapFiller | None:
    """Return what fills large gaps in compiled code, or None without numba (extra ``fast``)."""
    try:
        from foldcut.methods.disks.packing_compiled import GapFiller
    except ImportError:
        return None
    return GapFiller(tolerance.tie, tolerance.rounding, NEARLY, EQUAL)


def _is_loaded() -> bool:
    return "foldcut.methods.disks.packing_compiled" in sys.modules


def _pair_keys(one: Ints, other: Ints) -> Numbers:
    """A number for each pair of disks, whichever comes first."""
    return pair_keys(np.minimum(one, other), np.maximum(one, other))


def _flat(gaps: list[Chain]) -> tuple[Ints, Ints]:
    """Return rows as values and lengths."""
    values = np.fromiter((disk for gap in gaps for disk in gap), dtype=np.int32)
    return values, np.fromiter(map(len, gaps), dtype=np.int32, count=len(gaps))


def _largest_first(found: list[tuple[_Candidate, Leaf]]) -> Iterator[tuple[_Candidate, Leaf]]:
    """Yield the largest candidates first; of those equal up to rounding, as in symmetric shapes, the lower leaf."""
    found.sort(key=lambda item: -item[0].radius)
    start = 0
    while start < len(found):
        smallest = found[start][0].radius * (1 - EQUAL)
        end = next((k for k in range(start, len(found)) if found[k][0].radius < smallest), len(found))
        yield from sorted(found[start:end], key=lambda item: item[1])
        start = end


def _leaves(gap: list[Chain]) -> list[Leaf]:
    """The pairs of consecutive visits of all chains; a disk by itself has none."""
    return [leaf for chain in gap if len(chain) > 1 for leaf in zip(chain, chain[1:] + chain[:1], strict=True)]


def _places(gap: list[Chain], disk: int) -> Iterator[tuple[int, int]]:
    """The visits to a disk."""
    for number, chain in enumerate(gap):
        position = -1
        for _ in range(chain.count(disk)):
            position = chain.index(disk, position + 1)
            yield number, position


def _places_of_disks(gap: list[Chain]) -> Places:
    """The visits to each disk of a gap."""
    places: Places = {}
    for number, chain in enumerate(gap):
        for position, disk in enumerate(chain):
            places.setdefault(disk, []).append((number, position))
    return places


def _number(i: int, j: int) -> int:
    """A number for a leaf; they are in the order of leaves."""
    return i << 32 | j


def _leaf_numbers(gap: list[Chain]) -> Numbers:
    chains = [np.array(chain, dtype=np.int64) for chain in gap if len(chain) > 1]
    return np.concatenate([np.empty(0, dtype=np.int64), *(chain << 32 | np.roll(chain, -1) for chain in chains)])


def _pairs(numbers: Numbers) -> Numbers:
    """The leaves with these numbers, ``(n, 2)``."""
    return np.stack([numbers >> 32, numbers & 0xFFFFFFFF], axis=1)


def _angle(start: tuple[float, float], end: tuple[float, float]) -> float:
    """The counter-clockwise angle from one vector to another, in [0, 2 pi)."""
    across = start[0] * end[1] - start[1] * end[0]
    return math.atan2(across, start[0] * end[0] + start[1] * end[1]) % TURN


def _walk_from(chain: Chain, position: int) -> Chain:
    """The chain once around, from a visit back to the same disk."""
    if len(chain) == 1:
        return chain
    return chain[position:] + chain[: position + 1]


def _arc(chain: Chain, start: int, stop: int, *, whole: bool = False) -> Chain:
    """The visits from ``start`` to ``stop``, both included; ``whole`` goes once around."""
    if whole:
        return _walk_from(chain, start)
    return chain[start : stop + 1] if start <= stop else chain[start:] + chain[: stop + 1]


def packing_faults(packing: Packing, area: float, tolerance: Tolerance) -> list[str]:
    """List what breaks the packing's invariants; ``area`` in mm^2 is what the gaps must tile.

    The invariants are those of the module's docstring; empty means valid.
    """
    faults = []
    total = 0.0
    for number, gap in enumerate(packing.gaps):
        polygon = packing.centres[gap]
        total += signed_area(polygon)
        if len(gap) not in (3, 4):
            faults.append(f"gap {number} has {len(gap)} sides")
        if signed_area(polygon) <= 0:
            faults.append(f"gap {number} is not counter-clockwise")
        side = np.roll(polygon, -1, axis=0) - polygon
        radii = packing.radii[gap]
        off = np.hypot(side[:, 0], side[:, 1]) - radii - np.roll(radii, -1)
        if np.abs(off).max() > 4 * tolerance.touching(radii, np.roll(radii, -1)).max():
            faults.append(f"gap {number}: consecutive disks are {np.abs(off).max():.3g} mm from touching")
    if abs(total - area) > 1e-9 * area:
        faults.append(f"the gaps cover {total:.9g} of {area:.9g} mm^2")
    for face in range(len(packing.face_inside)):
        mine = np.unique(packing.gaps.values[np.isin(packing.gaps.rows, np.flatnonzero(packing.gap_face == face))])
        left, _ = overlapping_disks(
            packing.centres[mine], packing.radii[mine], np.zeros(len(mine), dtype=np.int32), tolerance
        )
        if len(left):
            faults.append(f"{len(left)} pairs of disks overlap in face {face}")
    return faults
