"""Which perpendiculars are folded: sets that make the number of creases at every node even.

``Ridges`` -> sets of perpendiculars, by number, the most promising first.

Few of these sets can be folded without paper that passes through paper, so two kinds are tried: those with the fewest
folds, and those that fold all paper away from one corridor. ``exchanges`` leads from one set to others near to it.
"""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Collection, Iterable, Iterator, Sequence
from itertools import combinations

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.geometry.union_find import groups
from foldcut.methods.skeleton.even_sets import cheapest_even_sets
from foldcut.methods.skeleton.facets import Division, divide_sheet
from foldcut.methods.skeleton.perpendiculars import Perpendiculars, Point, Ridges, trace
from foldcut.pattern.ranking import FOLDABLE_MM

FEWEST = 4
"""How many of the sets with the fewest folds are tried."""

COMPARED = 8
"""From how many of the sets with the least sums of folds these are taken."""

TIE = 1e-3
"""What a crease of no length counts, compared with one that is foldable: it only decides between equal numbers."""


def promising_sets(ridges: Ridges) -> Iterator[tuple[Perpendiculars, list[int]]]:
    """Yield perpendiculars and a set of them to fold, the most promising first.

    First come sets of the perpendiculars at odd nodes: those with the fewest folds, and those away from a root, in
    turns; then sets away from a root with the perpendiculars of all nodes. Raises ``UnfoldableError`` where a node
    needs a perpendicular and none of its own ends, and where even the fewest folds make too many creases.
    """
    perpendiculars = trace(ridges, ridges.odd)
    perpendiculars.require_ends()
    fewest = fewest_folds(perpendiculars, FEWEST)
    if fewest:
        divide_sheet(perpendiculars, fewest[0])  # if this set has too many creases, the others have, too
    rooted = away_from_roots(perpendiculars)
    seen: set[tuple[int, ...]] = set()
    for taken in [*fewest[:1], *rooted[:1], *fewest[1:], *rooted[1:]]:
        if tuple(taken) not in seen:
            seen.add(tuple(taken))
            yield perpendiculars, taken
    if len(ridges.nodes) > len(ridges.odd):
        perpendiculars = trace(ridges, ridges.nodes)
        for taken in away_from_roots(perpendiculars):
            yield perpendiculars, taken


def fewest_folds(perpendiculars: Perpendiculars, count: int) -> list[list[int]]:
    """Return up to ``count`` sets of perpendiculars that make every node even, those with the fewest folds first.

    A straight line is one fold. Of sets with as many, those come first that have less to do with creases that are hard
    to fold. What two perpendiculars save that go straight on at a node is only seen in the best few.
    """
    if not perpendiculars.ridges.odd:
        return [[]]
    skeleton = perpendiculars.ridges.skeleton
    hard = [_hardness(path.creases(skeleton)) for path in perpendiculars.paths]
    cost = [lines + own for lines, own in zip(perpendiculars.lines, hard, strict=True)]
    found = _cheapest(perpendiculars, cost, max(count, COMPARED))
    return sorted(found, key=lambda taken: perpendiculars.line_count(taken) + sum(hard[k] for k in taken))[:count]


def _hardness(creases: Iterable[tuple[Point, Point]]) -> float:
    """Return a small number that grows with the creases that are too short to be folded easily."""
    return TIE * sum(max(0.0, 1.0 - math.dist(*crease) / FOLDABLE_MM) for crease in creases)


def away_from_roots(perpendiculars: Perpendiculars) -> list[list[int]]:
    """Return the sets of perpendiculars that fold all paper away from one corridor, those with the fewest folds first.

    A *corridor* is a strip of paper between perpendiculars; nodes' perpendiculars are the *joints* between corridors.
    Where all perpendiculars end, corridors and joints form a tree. Any corridor may be its root: of a joint's
    perpendiculars only those are folded that do not border on the corridor towards the root. Then no corridor comes
    back to the joint that it hangs on, so nothing runs across the folds there.
    """
    corridors = Corridors(perpendiculars)
    return corridors.away_from(({one} for one in sorted(corridors.joints_at)), needs_even=False)


def away_from_joints(perpendiculars: Perpendiculars) -> list[list[int]]:
    """Return the sets of perpendiculars that fold all paper away from one joint, those with the fewest folds first.

    No node of that joint needs a perpendicular, and of its own none are folded: its corridors lie on its left and on
    its right in turns. These sets have fewer folds than those away from a corridor, but fewer of them can be folded.
    """
    corridors = Corridors(perpendiculars)
    return corridors.away_from((corridors.corridors_at[one] for one in sorted(corridors.corridors_at)), needs_even=True)


class Corridors:
    """The corridors between perpendiculars, and the joints between corridors: a tree, if all perpendiculars end.

    ``beside``: the corridors on which each perpendicular borders; ``joint``: a number for each perpendicular that it
    shares with those of its joint; ``corridors_at`` and ``joints_at``: which border on which.
    """

    def __init__(self, perpendiculars: Perpendiculars) -> None:
        self.perpendiculars = perpendiculars
        division = Division(perpendiculars, range(len(perpendiculars.paths)))
        facets, creases = division.planar()
        corridor = groups(len(facets), [pair for edge, pair in creases if edge not in division.path_of])
        self.beside: dict[int, set[int]] = defaultdict(set)
        for edge, pair in creases:
            if edge in division.path_of:
                self.beside[division.path_of[edge]] |= {corridor[facet] for facet in pair}
        self.joint = _joints(perpendiculars)
        self.corridors_at: dict[int, set[int]] = defaultdict(set)
        self.joints_at: dict[int, set[int]] = defaultdict(set)
        for path, mine in self.beside.items():
            self.corridors_at[self.joint[path]] |= mine
            for one in mine:
                self.joints_at[one].add(self.joint[path])

    def away_from(self, roots: Iterable[set[int]], *, needs_even: bool) -> list[list[int]]:
        """Return the sets that fold all paper away from roots: a corridor each, or all corridors of a joint.

        With ``needs_even`` sets that do not make every node even are left out, else the nearest that does is taken.
        """
        perpendiculars = self.perpendiculars
        found: dict[frozenset[int], int] = {}
        for root in roots:
            folded = self._away_from(root)
            if is_even(perpendiculars, folded):
                taken = sorted(folded)
            elif needs_even:
                continue
            else:
                # the set nearest to that one; of several, that with the fewest folds
                cost = [lines / 1e4 + (-1.0 if k in folded else 1.0) for k, lines in enumerate(perpendiculars.lines)]
                taken = next(iter(_cheapest(perpendiculars, cost, 1)), [])
            if taken or not perpendiculars.ridges.odd:
                found[frozenset(taken)] = perpendiculars.line_count(taken)
        return [sorted(taken) for taken in sorted(found, key=lambda taken: (found[taken], sorted(taken)))]

    def _away_from(self, root: set[int]) -> set[int]:
        """Return the perpendiculars that do not border on the corridor through which the way from the root comes."""
        middle = {one for one, mine in self.corridors_at.items() if mine == root} if len(root) > 1 else set()
        above: dict[int, int] = {}
        seen, stack = set(root), sorted(root)
        while stack:
            here = stack.pop()
            for joint in self.joints_at[here] - middle:
                if joint not in above:
                    above[joint] = here
                    following = self.corridors_at[joint] - seen
                    seen |= following
                    stack += following
        return {
            path
            for path, mine in self.beside.items()
            if self.joint[path] not in middle and (len(mine) == 1 or above.get(self.joint[path]) not in mine)
        }


def exchanges(perpendiculars: Perpendiculars) -> list[frozenset[int]]:
    """Return twos and threes of perpendiculars that may change together: every even node stays even.

    They form closed ways, for which the sheet's whole border counts as one place. To change means that those of them
    that are folded no longer are, and the others are.
    """
    paths = perpendiculars.paths
    at: dict[int, set[int]] = defaultdict(set)
    for number, path in enumerate(paths):
        at[path.start].add(number)
        at[path.end].add(number)
    found: set[frozenset[int]] = set()
    for node in sorted(at.keys() - {-1}):
        for one, other in combinations(sorted(at[node]), 2):
            ends = [path.start + path.end - node for path in (paths[one], paths[other])]
            if ends[0] == ends[1]:
                found.add(frozenset({one, other}))
            else:
                found |= {frozenset({one, other, third}) for third in at[ends[0]] & at[ends[1]]}
    return sorted((ways for ways in found if len(ways) > 1), key=sorted)


def is_even(perpendiculars: Perpendiculars, taken: Iterable[int]) -> bool:
    """Return whether the number of creases is even at every node if these perpendiculars are folded."""
    paths, ridges = perpendiculars.paths, perpendiculars.ridges
    count = Counter(v for k in taken for v in (paths[k].start, paths[k].end) if v >= 0)
    return all((count[v] + ridges.degree[v]) % 2 == 0 for v in {*count, *ridges.odd})


def _cheapest(perpendiculars: Perpendiculars, cost: Sequence[float], count: int) -> Iterable[list[int]]:
    """Return up to ``count`` sets of perpendiculars that make every node even, the cheapest first."""
    ends = [(path.start, path.end) for path in perpendiculars.paths]
    odd = {node for node, degree in perpendiculars.ridges.degree.items() if degree % 2} & {
        v for two in ends for v in two
    }
    if not odd.issuperset(perpendiculars.ridges.odd):
        return []
    found = cheapest_even_sets(ends, cost, odd, count)
    return _by_programming(ends, np.array(cost), odd, count) if found is None else found


class CheapestSets:
    """The sets with the fewest folds, cheapest first, by integer programming: what is known to fail is left out.

    ``forbid`` tells that nothing can be folded unless one of some perpendiculars changes.
    """

    def __init__(self, perpendiculars: Perpendiculars) -> None:
        skeleton = perpendiculars.ridges.skeleton
        self._ends = [(path.start, path.end) for path in perpendiculars.paths]
        self._odd = {node for node, degree in perpendiculars.ridges.degree.items() if degree % 2}
        self._saved = perpendiculars.straight_on
        hard = (_hardness(path.creases(skeleton)) for path in perpendiculars.paths)
        self._cost = [lines + own for lines, own in zip(perpendiculars.lines, hard, strict=True)]
        self._forbidden: list[tuple[frozenset[int], frozenset[int]]] = []

    def forbid(self, taken: frozenset[int], cause: frozenset[int]) -> None:
        """Leave out all sets that take the same of the perpendiculars in ``cause`` as ``taken`` does."""
        self._forbidden.append((cause & taken, cause - taken))

    def cheapest(self) -> frozenset[int] | None:
        """Return the cheapest set that is not forbidden, None if there is none."""
        if not self._ends:
            return None if self._forbidden else frozenset()
        from scipy.optimize import Bounds, LinearConstraint, milp
        from scipy.sparse import coo_array

        # the unknowns: 0 or 1 for every perpendicular; for every node, half of how many are folded there beyond its
        # parity; for two that are one straight line, at most 1, and only where both are folded
        nodes = sorted({node for two in self._ends for node in two if node >= 0})
        row = {node: k for k, node in enumerate(nodes)}
        n, m, s = len(self._ends), len(nodes), len(self._saved)
        entries = [(row[v], k, 1.0) for k, two in enumerate(self._ends) for v in two if v >= 0]
        entries += [(k, n + k, -2.0) for k in range(m)]
        low = [float(node in self._odd) for node in nodes]
        high = [*low]
        for k, two in enumerate(self._saved):
            for one in two:
                entries += [(len(low), n + m + k, 1.0), (len(low), one, -1.0)]
                low.append(-np.inf)
                high.append(0.0)
        for folded, free in self._forbidden:
            entries += [(len(low), k, 1.0) for k in folded] + [(len(low), k, -1.0) for k in free]
            low.append(-np.inf)
            high.append(len(folded) - 1.0)
        i, j, value = zip(*entries, strict=True)
        most = np.concatenate([np.ones(n), np.full(m, float(n)), np.ones(s)])
        found = milp(
            np.concatenate([self._cost, np.zeros(m), np.full(s, -1.0)]),
            constraints=LinearConstraint(coo_array((value, (i, j)), shape=(len(low), n + m + s)).tocsr(), low, high),
            integrality=np.concatenate([np.ones(n + m, dtype=np.int64), np.zeros(s, dtype=np.int64)]),
            bounds=Bounds(0, most),
        )
        return None if found.x is None else frozenset(np.flatnonzero(found.x[:n] > 0.5).tolist())


def _by_programming(
    ends: Sequence[tuple[int, int]], cost: Floats, odd: Collection[int], count: int
) -> Iterator[list[int]]:
    """Yield the same as ``cheapest_even_sets``, by integer programming."""
    from scipy.optimize import Bounds, LinearConstraint, milp
    from scipy.sparse import coo_array

    # the unknowns: 0 or 1 for every perpendicular; for every node, half of how many are folded there beyond its parity
    nodes = sorted({node for two in ends for node in two if node >= 0})
    row = {node: k for k, node in enumerate(nodes)}
    n, m = len(ends), len(nodes)
    entries = [(row[v], k, 1.0) for k, two in enumerate(ends) for v in two if v >= 0]
    entries += [(k, n + k, -2.0) for k in range(m)]
    i, j, value = zip(*entries, strict=True)
    wanted = np.array([float(node in odd) for node in nodes])
    rules = [LinearConstraint(coo_array((value, (i, j)), shape=(m, n + m)).tocsr(), wanted, wanted)]
    for _ in range(count):
        found = milp(
            np.append(cost, np.zeros(m)),
            constraints=rules,
            integrality=np.ones(n + m, dtype=np.int64),
            bounds=Bounds(0, np.append(np.ones(n), np.full(m, float(n)))),
        )
        if found.x is None:
            return
        taken = np.flatnonzero(found.x[:n] > 0.5).tolist()
        yield taken
        # next time, of its perpendiculars one less, or of the others one more
        sign = np.full(n + m, 0.0)
        sign[:n] = -1.0
        sign[taken] = 1.0
        rules.append(LinearConstraint(sign[None], -np.inf, len(taken) - 1.0))


def _joints(perpendiculars: Perpendiculars) -> list[int]:
    """Return a number for each perpendicular that it shares with those to which nodes join it."""
    at: dict[int, int] = {}
    ends = [
        (number, node)
        for number, path in enumerate(perpendiculars.paths)
        for node in (path.start, path.end)
        if node >= 0
    ]
    return groups(len(perpendiculars.paths), [(k, at.setdefault(node, k)) for k, node in ends])
