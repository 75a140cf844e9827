"""Fold along the straight skeleton: its ridges, and perpendiculars through all of the paper, as few as are needed.

``Shape`` on its sheet -> facets with their folded places (Demaine, Demaine and Lubiw 1999).

Every face of the plane, inside and outside, is divided by its straight skeleton into regions, one beside each side of
the shape. Folded at all ridges, every side comes to lie on the cut line, and a point at distance z from its side at
height z. What is left open is how the regions lie along that line: x runs one way or the other, and neighbours run
opposite ways. Where an odd number of ridges meet in a node, that cannot be, and a perpendicular has to begin: a crease
along which x turns back. In the next region it goes on at a right angle to that region's side, and so on, until it
leaves the sheet or comes to another node. Which of a node's perpendiculars are folded is free as long as their number
makes the creases at each node even; those that cross the fewest regions are taken.

Nothing ensures that a perpendicular ends: it can go around for ever. Then there is no such pattern.
"""

from __future__ import annotations

from collections import Counter, defaultdict, deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
import shapely

from foldcut.core.arrays import Floats, index_array
from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Sheet
from foldcut.geometry.planar_graph import trace_faces
from foldcut.geometry.union_find import groups
from foldcut.geometry.vectors import left_normal, signed_area
from foldcut.methods.skeleton.straight_skeleton import Edge, Region, Ring, Skeleton

SNAP = 1e-9
"""A perpendicular that comes so near to a node, relative to the sheet's diagonal, comes to it."""


MOST_CROSSINGS = 600
"""A perpendicular that crosses more regions is given up."""


@dataclass(frozen=True)
class Step:
    """A perpendicular's piece in one region, from ``start`` to ``end``: where it is on the way."""

    region: int
    u: float
    start: Floats
    end: Floats
    edge: Edge | None  # the edge it leaves the region by, None at a node and at the sheet's border


@dataclass(frozen=True)
class Path:
    """A perpendicular from a node to a node, or with ``end`` -1 to the sheet's border."""

    start: int
    end: int
    steps: tuple[Step, ...]


class Perpendiculars:
    """All perpendiculars from a skeleton's nodes, and which of them to fold."""

    def __init__(self, skeleton: Skeleton, sheet: Sheet) -> None:
        self.skeleton = skeleton
        self.sheet = sheet
        self.size = np.array([sheet.width, sheet.height])
        self.snap = SNAP * sheet.diagonal
        regions = skeleton.regions
        self.region_of: dict[Edge, int] = {}
        for number, region in enumerate(regions):
            ring = region.ring if self.is_left(region) else region.ring[::-1]
            for pair in zip(ring, ring[1:] + ring[:1], strict=True):
                self.region_of[pair] = number
        self.chains = [
            [(chain, np.array([skeleton.u(r.side, v) for v in chain])) for chain in (r.lower, r.upper)] for r in regions
        ]
        self.degree: dict[int, int] = defaultdict(int)
        for a, b in self.ridges():
            self.degree[a] += 1
            self.degree[b] += 1
        corners = {vertex for side in skeleton.base for vertex in side}
        self.nodes = [v for v in self.degree if v not in corners and self.on_sheet(skeleton.points[v])]
        self.odd = [v for v, count in self.degree.items() if count % 2 and self.on_sheet(skeleton.points[v])]
        self.tree = shapely.STRtree([shapely.Polygon(skeleton.points[region.ring]) for region in regions])
        self.shape_at_left = [float(r.sign if self.is_left(r) else -r.sign) for r in regions]
        self.paths: list[Path] = []
        self.endless = 0

    def is_left(self, region: Region) -> bool:
        """Whether a region is at the left of its side: its ring is then counter-clockwise on the sheet."""
        return signed_area(self.skeleton.points[region.ring]) > 0

    def ridges(self) -> list[Edge]:
        """The edges between two regions that are no side."""
        return [
            (a, b)
            for a, b in self.region_of
            if a < b
            and (b, a) in self.region_of
            and (a, b) not in self.skeleton.base
            and (b, a) not in self.skeleton.base
        ]

    def on_sheet(self, point: Floats) -> bool:
        """Whether a point is strictly on the sheet."""
        return bool(((point > self.snap) & (point < self.size - self.snap)).all())

    def trace(self, nodes: Sequence[int]) -> None:
        """Find the perpendiculars from nodes, and from the nodes that these come to, as far as they end."""
        self.paths = []
        self.endless = 0
        known: set[tuple[int, int, int]] = set()  # the ends' node, region and chain of paths between two nodes
        around: dict[int, list[int]] = defaultdict(list)
        for number, region in enumerate(self.skeleton.regions):
            for node in region.ring:
                around[node].append(number)
        queue, seen = deque(nodes), set(nodes)
        while queue:
            node = queue.popleft()
            for number in around[node]:
                region = self.skeleton.regions[number]
                for chain, row in enumerate((region.lower, region.upper)):
                    if node not in row or (node, number, chain) in known:
                        continue
                    path, arrived = self._trace(node, number, chain)
                    if path is None:
                        continue
                    self.paths.append(path)
                    if path.end >= 0:
                        known.add(arrived)
                        if path.end not in seen:
                            seen.add(path.end)
                            queue.append(path.end)

    def _trace(self, node: int, number: int, chain: int) -> tuple[Path | None, tuple[int, int, int]]:
        """Follow the perpendicular of a region from a node on one of its chains."""
        none = (-1, -1, -1)
        skeleton = self.skeleton
        u = skeleton.u(skeleton.regions[number].side, node)
        here = skeleton.points[node]
        steps: list[Step] = []
        while len(steps) < MOST_CROSSINGS:
            there, edge, vertex = self._across(number, u, 1 - chain)
            if there is None or (not steps and np.hypot(*(there - here)) < self.snap):
                return None, none
            exit_at = self._leaves_sheet(here, there)
            if exit_at is not None:
                steps.append(Step(number, u, here, exit_at, None))
                return Path(node, -1, tuple(steps)), none
            steps.append(Step(number, u, here, there, edge))
            if vertex >= 0:
                return Path(node, vertex, tuple(steps)), (vertex, number, 1 - chain)
            assert edge is not None
            left = self.region_of.get(edge)
            number = self.region_of.get((edge[1], edge[0]), -1) if left == number else (-1 if left is None else left)
            if number < 0:
                return None, none
            u = float(
                (there - skeleton.starts[skeleton.regions[number].side]) @ skeleton.along[skeleton.regions[number].side]
            )
            chain = next((k for k in (0, 1) if self._on_chain(number, k, edge)), -1)
            if chain < 0:
                return None, none
            here = there
        self.endless += 1
        return None, none

    def _on_chain(self, number: int, chain: int, edge: Edge) -> bool:
        row = self.chains[number][chain][0]
        return any(set(pair) == set(edge) for pair in pairwise(row))

    def _across(self, number: int, u: float, chain: int) -> tuple[Floats | None, Edge | None, int]:
        """Where the perpendicular at u meets a chain of a region: the place, the edge, and the node if it is one."""
        row, places = self.chains[number][chain]
        if not places[0] + self.snap < u < places[-1] - self.snap:
            return None, None, -1
        points = self.skeleton.points
        nearest = int(np.abs(places - u).argmin())
        if abs(places[nearest] - u) <= self.snap:
            return points[row[nearest]], None, row[nearest]
        k = int(np.searchsorted(places, u))
        a, b = row[k - 1], row[k]
        part = (u - places[k - 1]) / (places[k] - places[k - 1])
        return points[a] + part * (points[b] - points[a]), (a, b), -1

    def _leaves_sheet(self, here: Floats, there: Floats) -> Floats | None:
        """Where a segment from a point on the sheet leaves it, or None."""
        if self.on_sheet(there):
            return None
        step = there - here
        with np.errstate(divide="ignore", invalid="ignore"):
            part = np.where(step > 0, (self.size - here) / step, np.where(step < 0, -here / step, np.inf))
        axis = int(part.argmin())
        place: Floats = here + min(1.0, float(part[axis])) * step
        place[axis] = self.size[axis] if step[axis] > 0 else 0.0
        return place

    def require_ends(self) -> None:
        """Raise ``UnfoldableError`` with a node that needs a perpendicular when none of its perpendiculars ends."""
        ending = {node for path in self.paths for node in (path.start, path.end)}
        for node in self.odd:
            if node not in ending:
                x, y = self.skeleton.points[node]
                raise UnfoldableError(
                    f"no perpendicular from the skeleton's node at ({x:.1f}, {y:.1f}) mm ends within "
                    f"{MOST_CROSSINGS} crossings; try a larger --adjust"
                )

    def fewest(self, count: int) -> Iterator[list[int]]:
        """Yield so many sets of perpendiculars that make the creases at every node even, the fewest pieces first."""
        cost = np.array([float(len(path.steps)) for path in self.paths])
        cuts: list[tuple[Floats, float]] = []
        for _ in range(count):
            taken = self._even(cost, cuts)
            if taken is None:
                return
            yield taken
            sign = np.full(len(self.paths), -1.0)
            sign[taken] = 1.0
            cuts.append((sign, len(taken) - 1.0))

    def _even(self, cost: Floats, cuts: Sequence[tuple[Floats, float]] = ()) -> list[int] | None:
        """The cheapest set of perpendiculars that makes the creases at every node even, or None."""
        nodes = sorted({node for path in self.paths for node in (path.start, path.end) if node >= 0} | set(self.odd))
        if not self.odd and (cost >= 0).all():
            return None if cuts else []
        from scipy.optimize import Bounds, LinearConstraint, milp
        from scipy.sparse import coo_array

        row = {node: k for k, node in enumerate(nodes)}
        n, m = len(self.paths), len(nodes)
        entries = [(row[v], k, 1.0) for k, path in enumerate(self.paths) for v in (path.start, path.end) if v >= 0]
        entries += [(k, n + k, -2.0) for k in range(m)]
        i, j, value = zip(*entries, strict=True)
        wanted = np.array([self.degree[node] % 2 for node in nodes], dtype=np.float64)
        rules = [LinearConstraint(coo_array((value, (i, j)), shape=(m, n + m)).tocsr(), wanted, wanted)]
        rules += [LinearConstraint(np.append(sign, np.zeros(m))[None], -np.inf, most) for sign, most in cuts]
        found = milp(
            np.append(cost, np.zeros(m)),
            constraints=rules,
            integrality=np.ones(n + m, dtype=np.int64),
            bounds=Bounds(0, np.append(np.ones(n), np.full(m, float(n)))),
        )
        return None if found.x is None else np.flatnonzero(found.x[:n] > 0.5).tolist()

    def rooted(self) -> list[list[int]]:
        """Return the sets of perpendiculars that fold all paper away from one corridor, those with the fewest first.

        A corridor is a strip of paper between perpendiculars; where these all end, corridors hang together like a tree.
        Folded away from the root, each as far from it as the way along the tree is, no corridor comes back to where
        it is joined to the last one, so that the folds there hold nothing that runs across them.
        """
        division = _Division(self, range(len(self.paths)))
        rings, creases = division.planar()
        corridor = groups(len(rings), [facets for edge, facets in creases if edge not in division.path_of])
        beside: dict[int, set[int]] = defaultdict(set)
        for edge, facets in creases:
            if edge in division.path_of:
                beside[division.path_of[edge]] |= {corridor[facet] for facet in facets}
        joint = self._joints()
        around: dict[int, set[int]] = defaultdict(set)
        joints: dict[int, set[int]] = defaultdict(set)
        for path, mine in beside.items():
            around[joint[path]] |= mine
            for one in mine:
                joints[one].add(joint[path])
        found: dict[frozenset[int], float] = {}
        for root in sorted(joints):
            above = _parents(root, joints, around)
            folded = {path for path, mine in beside.items() if len(mine) == 1 or above.get(joint[path]) not in mine}
            cost = np.array([len(path.steps) / 1e4 for path in self.paths])
            cost += np.where(np.isin(np.arange(len(cost)), list(folded)), -1.0, 1.0)
            taken = sorted(folded) if self._is_even(folded) else self._even(cost) or []
            if taken or not self.odd:
                found[frozenset(taken)] = sum(len(self.paths[k].steps) for k in taken)
        return [sorted(taken) for taken in sorted(found, key=lambda taken: (found[taken], sorted(taken)))]

    def exchanges(self) -> list[frozenset[int]]:
        """Return twos and threes of perpendiculars that may change together: each node keeps an even number of creases.

        They are closed ways, all of the sheet's border being one place: those of the two or three that are folded are
        not any more, and the others are.
        """
        at: dict[int, set[int]] = defaultdict(set)
        for number, path in enumerate(self.paths):
            at[path.start].add(number)
            at[path.end].add(number)
        found: set[frozenset[int]] = set()
        for node in sorted(at.keys() - {-1}):
            for one, other in combinations(sorted(at[node]), 2):
                ends = [path.start + path.end - node for path in (self.paths[one], self.paths[other])]
                if ends[0] == ends[1]:
                    found.add(frozenset({one, other}))
                else:
                    found |= {frozenset({one, other, third}) for third in at[ends[0]] & at[ends[1]]}
        return sorted((ways for ways in found if len(ways) > 1), key=sorted)

    def _is_even(self, taken: set[int]) -> bool:
        count = Counter(v for k in taken for v in (self.paths[k].start, self.paths[k].end) if v >= 0)
        return all((count[v] + self.degree[v]) % 2 == 0 for v in {*count, *self.odd})

    def _joints(self) -> list[int]:
        """For each perpendicular a number that those have in common which are joined by nodes."""
        at: dict[int, int] = {}
        ends = [
            (number, node) for number, path in enumerate(self.paths) for node in (path.start, path.end) if node >= 0
        ]
        return groups(len(self.paths), [(k, at.setdefault(node, k)) for k, node in ends])


def _parents(root: int, joints: dict[int, set[int]], around: dict[int, set[int]]) -> dict[int, int]:
    """For each joint the corridor through which it is reached from a root."""
    above: dict[int, int] = {}
    seen, stack = {root}, [root]
    while stack:
        here = stack.pop()
        for joint in joints[here]:
            if joint not in above:
                above[joint] = here
                following = around[joint] - seen
                seen |= following
                stack += following
    return above


@dataclass(frozen=True, eq=False)
class Facets:
    """The sheet divided by creases, and where each part of it comes to lie.

    ``flat`` and ``folded`` ``(v, 2)`` mm; ``rings`` counter-clockwise on the sheet; ``creases`` with the two facets at
    their left and right; ``up`` whether a facet shows its upper side; ``sheet_corners`` vertices.
    """

    flat: Floats
    folded: Floats
    rings: list[Ring]
    creases: list[tuple[Edge, tuple[int, int]]]
    up: list[bool]
    sheet_corners: set[int]


def divide_sheet(perpendiculars: Perpendiculars, paths: Sequence[int]) -> Facets:
    """Divide the sheet by the skeleton's ridges and some perpendiculars, by number, and fold it.

    Raises ``UnfoldableError`` where it does not hold together.
    """
    return _Division(perpendiculars, paths).facets()


class _Division:
    def __init__(self, perpendiculars: Perpendiculars, paths: Sequence[int]) -> None:
        self.all = perpendiculars
        self.skeleton = perpendiculars.skeleton
        self.points = [*self.skeleton.points]
        self.edges: list[Edge] = []
        self.path_of: dict[Edge, int] = {}
        self.corners = [self._add(corner) for corner in perpendiculars.sheet.corners]
        self.border = list(self.corners)
        on_ridge: dict[Edge, list[int]] = defaultdict(list)
        for number in paths:
            self._draw(number, on_ridge)
        for ridge in perpendiculars.ridges():
            self._draw_ridge(ridge, on_ridge)
        self._draw_border()

    def _add(self, point: Floats) -> int:
        self.points.append(point)
        return len(self.points) - 1

    def _add_on_border(self, point: Floats) -> int:
        for vertex in self.border:
            if np.hypot(*(self.points[vertex] - point)) <= self.all.snap:
                return vertex
        self.border.append(self._add(point))
        return self.border[-1]

    def _draw(self, number: int, on_ridge: dict[Edge, list[int]]) -> None:
        path = self.all.paths[number]
        vertex = path.start
        base = self.skeleton.base
        for k, step in enumerate(path.steps):
            if k == len(path.steps) - 1:
                following = path.end if path.end >= 0 else self._add_on_border(step.end)
            elif step.edge is None or step.edge in base or step.edge[::-1] in base:
                continue
            else:
                following = self._add(step.end)
                on_ridge[min(step.edge, step.edge[::-1])].append(following)
            self.edges.append((vertex, following))
            self.path_of[min(vertex, following), max(vertex, following)] = number
            vertex = following

    def _draw_ridge(self, ridge: Edge, on_ridge: dict[Edge, list[int]]) -> None:
        a, b = ridge
        start, step = self.points[a], self.points[b] - self.points[a]
        low, high = 0.0, 1.0
        size, snap = self.all.size, self.all.snap
        for axis in (0, 1):
            if abs(step[axis]) <= snap:
                if not snap < start[axis] < size[axis] - snap:
                    return
                continue
            parts = sorted([-start[axis] / step[axis], (size[axis] - start[axis]) / step[axis]])
            low, high = max(low, parts[0]), min(high, parts[1])
        if (high - low) * np.hypot(*step) <= snap:
            return
        first = a if low == 0.0 else self._add_on_border(start + low * step)
        last = b if high == 1.0 else self._add_on_border(start + high * step)
        between = sorted(on_ridge[ridge], key=lambda v: float((self.points[v] - start) @ step))
        self.edges += pairwise([first, *between, last])

    def _draw_border(self) -> None:
        middle = self.all.size / 2
        away = np.array([self.points[v] for v in self.border]) / middle - 1
        order = np.argsort(_around_square(away))
        ring = [self.border[k] for k in order.tolist()]
        self.edges += zip(ring, ring[1:] + ring[:1], strict=True)

    def planar(self) -> tuple[list[Ring], list[tuple[Edge, tuple[int, int]]]]:
        """The facets' rings, and the creases, their lesser vertex first, with the facets at their left and right."""
        used, edges = np.unique(np.array(self.edges), return_inverse=True)
        rings = trace_faces(np.array(self.points)[used], index_array(edges.reshape(-1, 2))).to_lists()
        rings = [used[ring].tolist() for ring in rings]
        beside = {pair: k for k, ring in enumerate(rings) for pair in zip(ring, ring[1:] + ring[:1], strict=True)}
        return rings, [((a, b), (k, beside[b, a])) for (a, b), k in beside.items() if a < b and (b, a) in beside]

    def facets(self) -> Facets:
        points = np.array(self.points)
        rings, creases = self.planar()
        folded, up = self._fold(points, rings, creases, self._maps(points, rings))
        return Facets(points, folded, rings, creases, up, set(self.corners))

    def _maps(self, points: Floats, rings: list[Ring]) -> list[tuple[int, float]]:
        """For each facet, its side, and 1.0 where the shape is at the left of it, else -1.0."""
        full = shapely.polygons([shapely.linearrings(points[ring]) for ring in rings])
        near = self.all.tree.nearest(shapely.point_on_surface(full)).tolist()
        return [(self.skeleton.regions[number].side, self.all.shape_at_left[number]) for number in near]

    def _fold(
        self,
        points: Floats,
        rings: list[Ring],
        creases: list[tuple[Edge, tuple[int, int]]],
        maps: list[tuple[int, float]],
    ) -> tuple[Floats, list[bool]]:
        skeleton = self.skeleton
        beside: dict[int, list[tuple[int, int]]] = defaultdict(list)
        for (a, _), (one, two) in creases:
            beside[one].append((two, a))
            beside[two].append((one, a))
        folded = np.full((len(points), 2), np.nan)
        placed: dict[int, tuple[float, float]] = {0: (1.0, 0.0)}
        queue = deque([0])
        worst = 0.0
        while queue:
            facet = queue.popleft()
            turn, shift = placed[facet]
            side, left = maps[facet]
            away = points[rings[facet]] - skeleton.starts[side]
            z = left * (away @ left_normal(skeleton.along[side]))
            place = np.column_stack([turn * (away @ skeleton.along[side]) + shift, z])
            old = folded[rings[facet]]
            known = ~np.isnan(old[:, 0])
            worst = max(worst, float(np.abs(old[known] - place[known]).max(initial=0.0)))
            folded[rings[facet]] = np.where(known[:, None], old, place)
            for other, vertex in beside[facet]:
                if other not in placed:
                    other_side, other_left = maps[other]
                    turned = -turn * left * other_left
                    u = float((points[vertex] - skeleton.starts[other_side]) @ skeleton.along[other_side])
                    placed[other] = turned, float(folded[vertex, 0]) - turned * u
                    queue.append(other)
        if len(placed) < len(rings) or worst > 1e3 * self.all.snap:
            raise UnfoldableError("the facets do not meet when they are folded")
        folded[:, 0] -= np.nanmin(folded[:, 0])
        folded[np.isnan(folded)] = 0.0  # of vertices that are not on the sheet
        up = [placed[k][0] * maps[k][1] > 0 for k in range(len(rings))]
        return folded, up


def _around_square(away: Floats) -> Floats:
    """Return numbers that grow counter-clockwise along the square of half side 1."""
    x, y = away.T
    flat = np.abs(y) >= np.abs(x)
    quarter: Floats = np.where(flat & (y < 0), x, np.where(~flat & (x > 0), 2 + y, np.where(flat, 4 - x, 6 - y)))
    return quarter
