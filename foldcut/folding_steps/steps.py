"""In what order a person folds a pattern: straight folds where there are any, and what must collapse at once.

``FoldedPattern`` -> ``Step`` after ``Step``, from the flat sheet to the folded one.

A *fold* turns some of the paper over a straight line through half a turn. Two kinds of them are looked for, and each is
checked on the paper as it lies then: nothing lies on what moves but what moves with it (or under it, when it goes
under), and what moves hangs on the rest only along the line.

- At the beginning, folds after which no two layers that have come to lie on each other ever slide any more: they are
  one sheet of several layers from then on. A mirror axis is such a fold.
- At the end, found backwards, unfolding the finished sheet.

What is between them *collapses*: all its creases close together.

Invariants: each crease is in one step; the first begins with the flat sheet, its front up; after the last the sheet is
the pattern's folded state, moved or turned over.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from foldcut.core.arrays import Bools, Floats, Ints, index_array, points_array
from foldcut.core.model import FoldedPattern, FoldedState, Region
from foldcut.geometry.planar_graph import edge_faces, signed_areas
from foldcut.geometry.vectors import cross
from foldcut.pattern.face_maps import fold_faces, folded_edges
from foldcut.proof.verify import verify

TOUCHING = 1e-7
"""Places this near, relative to the sheet's diagonal, are one."""

STRAIGHT = 1e-7
"""Every other angle around a vertex adds up to a half turn when it is off by less than this, in radians."""

MOST_CREASES, MOST_SPOKES, MOST_TRIES = 1000, 12, 40
"""Larger patterns, and vertices of more creases, are folded at once; so many states between are tried."""

LEAST_GROUP, MOST_GROUPS = 12, 8
"""Groups of creases that collapse are joined until there are no more, each of at least so many."""

ALONG = (0.02, 0.5, 0.98)
"""A crease reaches into a region when one of these places on it is there."""

Indices = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Step:
    """One movement.

    ``edges``: the creases that it folds, edge numbers; ``state``: the sheet after it, layers from bottom to top. A fold
    has its ``line``, ``(2, 2)`` mm, where it lies on the sheet as folded before, the faces that are ``moved``, and
    whether these go ``over`` the others, as seen from the top, or under them. A collapse has no line; its ``groups``
    divide its creases by the molecules, what is inside others first.
    """

    edges: Ints
    state: FoldedState
    line: Floats | None = None
    moved: Ints | None = None
    over: bool = True
    groups: tuple[Ints, ...] = ()


@dataclass(frozen=True, eq=False)
class _Turn:
    """Faces that turn over a line, and the creases that are folded or unfolded by it."""

    faces: Bools
    origin: Floats
    along: Floats
    over: bool
    edges: Bools


class _Sheet:
    """What does not change while the sheet is folded."""

    def __init__(self, pattern: FoldedPattern) -> None:
        creases = pattern.creases
        self.flat = creases.vertices_coords
        self.rings = creases.faces_vertices
        self.ends = creases.edges_vertices
        self.beside = edge_faces(creases)
        self.inner = (self.beside >= 0).all(axis=1)
        self.pattern = creases
        self.creased = folded_edges(creases)
        self.valley = creases.edges_assignment == "V"
        self.areas = signed_areas(self.flat, self.rings)
        self.tolerance = TOUCHING * pattern.sheet.diagonal
        lengths = self.flat[self.ends[:, 1]] - self.flat[self.ends[:, 0]]
        self.lengths = np.hypot(*lengths.T)
        self.first = np.zeros(len(self.ends), dtype=np.bool_)
        for start, end in pattern.first_folds:
            off = np.abs(cross(end - start, self.flat[self.ends] - start)) / math.dist(start, end)
            self.first |= self.creased & (off < self.tolerance).all(axis=1)


class _State:
    """The sheet, folded in part: where vertices are, the rank of each face, and which creases are folded."""

    def __init__(self, sheet: _Sheet, at: Floats, rank: Indices, folded: Bools, meet: Bools | None = None) -> None:
        self.sheet, self.at, self.rank, self.folded = sheet, at, rank, folded
        self.up = signed_areas(at, sheet.rings) > 0
        polygons = shapely.polygons(shapely.linearrings(at[sheet.rings.values], indices=sheet.rings.rows))
        # what is left of faces that only touch each other is apart
        self.bodies = shapely.buffer(polygons, -sheet.tolerance, join_style="mitre")
        self.meet = self._meetings() if meet is None else meet

    def _meetings(self) -> Bools:
        """Return which faces lie on each other, ``(f, f)``."""
        meet = np.zeros((len(self.bodies),) * 2, dtype=np.bool_)
        one, other = shapely.STRtree(self.bodies).query(self.bodies, predicate="intersects")
        meet[one, other] = one != other
        return meet

    @property
    def public(self) -> FoldedState:
        """The state as other stages know it."""
        return FoldedState(points_array(self.at), index_array(np.argsort(self.rank)))

    def turned(self, turn: _Turn) -> _State:
        """Return the state after some faces have turned over."""
        sheet = self.sheet
        moving = np.unique(sheet.rings.values[turn.faces[sheet.rings.rows]])
        at = self.at.copy()
        away = at[moving] - turn.origin
        at[moving] = turn.origin + 2 * (away @ turn.along)[:, None] * turn.along - away
        most = len(self.rank)
        rank = np.where(turn.faces, (2 * most if turn.over else -1) - self.rank, self.rank)
        order = np.empty(most, dtype=np.intp)
        order[np.argsort(rank)] = np.arange(most)
        return _State(sheet, at, order, self.folded ^ turn.edges)

    def laid_on(self, other: _State) -> _State:
        """Return this state, moved and turned over so that its largest face lies where it lies in another."""
        face = int(self.sheet.areas.argmax())
        turn, shift, same = (value[face] for value in _motion(self, other))
        z = self.at[:, 0] + 1j * self.at[:, 1]
        moved = turn * (z if same else z.conj()) + shift
        rank = self.rank if same else len(self.rank) - 1 - self.rank
        return _State(self.sheet, np.stack([moved.real, moved.imag], axis=1), rank, self.folded, self.meet)

    def folds(self, allowed: Bools) -> Iterator[_Turn]:
        """Yield the straight folds of creases that are allowed."""
        open_creases = allowed & ~self.folded
        rising = self.sheet.valley == self.up[self.sheet.beside[:, 0]]  # folded over, not under
        for over in (True, False):
            yield from self._turns(open_creases & (rising == over), over, None)

    def unfolds(self, glued: Bools) -> Iterator[_Turn]:
        """Yield straight folds backwards, of which no two faces that are glued slide on each other."""
        for over in (True, False):
            yield from self._turns(self.folded, over, glued)

    def _turns(self, movable: Bools, over: bool, glued: Bools | None) -> Iterator[_Turn]:
        for edges, origin, along in self._lines(movable):
            sides = self.sides(origin, along)
            count, part = self.parts(edges, glued)
            if count == 1:
                continue
            member = np.zeros((count, len(part)))
            member[part, np.arange(len(part))] = 1
            above = self.meet & ((self.rank[:, None] < self.rank) == over)  # [f, g]: g is in the way of f
            needs = (member @ above @ member.T > 0) | np.eye(count, dtype=np.bool_)
            while not np.array_equal(further := needs @ needs, needs):
                needs = further
            low, high = np.full(count, 2), np.full(count, -2)
            np.minimum.at(low, part, sides[:, 0])
            np.maximum.at(high, part, sides[:, 1])
            for side in (1, -1):
                on_side = (low >= 0) if side > 0 else (high <= 0)
                free = [k for k in range(count) if on_side[k] and on_side[needs[k]].all() and not needs[k].all()]
                groups = [needs[k] for k in free]
                if len(groups) > 1:
                    groups.append(np.logical_or.reduce(groups))
                for group in groups:
                    faces = group[part]
                    hinge = edges & (faces[self.sheet.beside[:, 0]] != faces[self.sheet.beside[:, 1]])
                    if not hinge.any() or group.all():
                        continue
                    yield _Turn(faces, origin, along, over, hinge)

    def _lines(self, movable: Bools) -> Iterator[tuple[Bools, Floats, Floats]]:
        """Yield each line on which there are creases that may move: these, a point on it, and its direction."""
        left = movable.copy()
        ends = self.at[self.sheet.ends]
        while left.any():
            longest = int(np.where(left, self.sheet.lengths, 0).argmax())
            origin = ends[longest, 0]
            along = (ends[longest, 1] - origin) / self.sheet.lengths[longest]
            off = np.abs((ends - origin) @ np.array([-along[1], along[0]]))
            on_line = left & (off < self.sheet.tolerance).all(axis=1)
            left &= ~on_line
            yield on_line, origin, along

    def sides(self, origin: Floats, along: Floats) -> NDArray[np.signedinteger]:
        """Return how far each face reaches to the right, -1 or 0, and to the left, 0 or 1, of a line, ``(f, 2)``."""
        off = (self.at - origin) @ np.array([-along[1], along[0]])
        side = np.where(np.abs(off) < self.sheet.tolerance, 0, np.sign(off)).astype(np.int64)
        starts = self.sheet.rings.offsets[:-1]
        values = side[self.sheet.rings.values]
        return np.stack([np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)], axis=1)

    def parts(self, hinges: Bools, glued: Bools | None) -> tuple[int, Indices]:
        """Return in how many parts the sheet falls without these creases, and the part of each face."""
        one, other = self.sheet.beside[self.sheet.inner & ~hinges].T
        if glued is not None:
            more = np.nonzero(glued)
            one, other = np.concatenate([one, more[0]]), np.concatenate([other, more[1]])
        count = len(self.rank)
        graph = coo_array((np.ones(len(one)), (one, other)), shape=(count, count))
        parts, part = connected_components(graph, directed=False)
        return int(parts), part.astype(np.intp)


def folding_steps(pattern: FoldedPattern) -> tuple[Step, ...]:
    """Return the steps from the flat sheet to ``pattern.folded``."""
    sheet = _Sheet(pattern)
    if sheet.creased.sum() > MOST_CREASES:
        every = np.flatnonzero(sheet.creased)
        return (Step(index_array(every), pattern.folded, groups=_groups(pattern, every)),)
    count = len(sheet.rings)
    rank = np.argsort(pattern.folded.layers)
    end = _State(sheet, pattern.folded.vertices_coords, rank, sheet.creased)
    flat = _State(sheet, sheet.flat, np.arange(count), np.zeros_like(sheet.creased), np.zeros((count, count), bool))
    state = flat
    moves: list[_Move] = []
    while found := _best(
        (turn for turn in state.folds(sheet.creased) if _is_one_sheet(state.turned(turn), end)), sheet.first
    ):
        moves.append(_Move(state, state.turned(found), found))
        state = moves[-1].after
    last: list[_Move] = []
    target = end
    while (target.folded != state.folded).any() and (found := _best(target.unfolds(state.meet))):
        last.append(_Move(target.turned(found), target, found))
        target = last[-1].before
    moves += [*_collapses(sheet, state, target), *reversed(last)]
    return tuple(_replayed(pattern, flat, moves))


@dataclass(frozen=True, eq=False)
class _Move:
    """What happens between two states, straight over a line or not; they may lie anywhere, front or back up."""

    before: _State
    after: _State
    turn: _Turn | None


def _collapses(sheet: _Sheet, state: _State, target: _State) -> Iterator[_Move]:
    """Yield what happens between two states: as often as there are sets of creases that fold flat by themselves.

    Whether the sheet can lie flat with only some of the creases folded is left to the verifier.
    """
    wholes = _Closures(sheet, state.folded, target.folded)
    tries = MOST_TRIES
    while (target.folded != state.folded).any():
        after = target
        for folded in wholes.supersets(state.folded):
            tries -= 1
            if tries < 0:
                break
            part = _between(sheet, folded, target)
            if part is not None and _is_one_sheet(part, target):
                after = part
                break
        yield _Move(state, after, None)
        state = after


def _replayed(pattern: FoldedPattern, state: _State, moves: Sequence[_Move]) -> Iterator[Step]:
    """Yield the moves as steps, each where the last has left the sheet: the larger part of it stays in place."""
    sheet = state.sheet
    for move in moves:
        edges = np.flatnonzero(move.after.folded & ~move.before.folded)
        if move.turn is None:
            state = move.after.laid_on(state)
            yield Step(index_array(edges), state.public, groups=_groups(pattern, edges))
            continue
        hinge = state.at[sheet.ends[edges[sheet.lengths[edges].argmax()]]]
        along = (hinge[1] - hinge[0]) / math.dist(*hinge)
        faces = move.turn.faces
        rest = state.sides(hinge[0], along)[~faces]
        if sheet.areas[faces].sum() > sheet.areas[~faces].sum() and (rest.min() >= 0 or rest.max() <= 0):
            faces = ~faces
        over = bool(sheet.valley[edges[0]] == state.up[sheet.beside[edges[0], 0]])
        places = (state.at[sheet.ends[edges]].reshape(-1, 2) - hinge[0]) @ along
        line = hinge[0] + np.array([[places.min()], [places.max()]]) * along
        state = state.turned(_Turn(faces, hinge[0], along, over, move.turn.edges))
        moved = index_array(np.flatnonzero(faces))
        yield Step(index_array(edges), state.public, points_array(line), moved, over)


class _Closures:
    """Sets of creases that can be folded while the others are not, as far as angles and mountains tell at vertices."""

    def __init__(self, sheet: _Sheet, fixed: Bools, every: Bools) -> None:
        self.every = every
        self.alone = np.zeros_like(every)  # creases that need all others
        border = np.unique(sheet.ends[~sheet.inner])
        spokes: dict[int, list[tuple[float, int]]] = {}
        for edge in np.flatnonzero(every).tolist():
            for here, there in (sheet.ends[edge].tolist(), sheet.ends[edge].tolist()[::-1]):
                dx, dy = (sheet.flat[there] - sheet.flat[here]).tolist()
                spokes.setdefault(here, []).append((math.atan2(dy, dx), edge))
        for vertex in border.tolist():
            spokes.pop(vertex, None)
        self.at: list[tuple[Indices, Bools]] = []
        self.vertices: dict[int, list[int]] = {}
        for around in spokes.values():
            edges = np.array([edge for _, edge in sorted(around)])
            angles = np.array([angle for angle, _ in sorted(around)])
            for edge in edges.tolist():
                self.vertices.setdefault(edge, []).append(len(self.at))
            self.at.append((edges, _flat_subsets(angles, sheet.valley[edges], fixed[edges])))

    def supersets(self, folded: Bools) -> list[Bools]:
        """Return sets of creases with these and more, but not all, the smallest first."""
        found: dict[bytes, Bools] = {}
        for edge in np.flatnonzero(self.every & ~folded).tolist():
            whole = self._closed(folded, edge)
            found[whole.tobytes()] = whole
        return sorted((w for w in found.values() if (w != self.every).any()), key=lambda w: int(w.sum()))

    def _closed(self, folded: Bools, edge: int) -> Bools:
        """Return a small set of creases with these and one more that has no vertex at which it cannot be folded."""
        if self.alone[edge]:
            return self.every
        whole = folded.copy()
        whole[edge] = True
        todo = list(self.vertices.get(edge, ()))
        while todo:
            edges, subsets = self.at[todo.pop()]
            now = whole[edges]
            larger = subsets[(subsets >= now).all(axis=1)]
            if (larger == now).all(axis=1).any():
                continue
            forced = larger.all(axis=0)
            grown = forced if (forced != now).any() else larger[larger.sum(axis=1).argmin()]
            for new in edges[grown & ~now].tolist():
                if self.alone[new]:
                    self.alone[edge] = True
                    return self.every
                whole[new] = True
                todo += self.vertices[new]
        self.alone[edge] = bool((whole == self.every).all())
        return whole


def _flat_subsets(angles: Floats, valley: Bools, fixed: Bools) -> Bools:
    """Return which of the creases around a vertex, sorted by their angles, fold flat without the others, ``(n, k)``.

    Those that are ``fixed`` are in each of the sets. By Kawasaki's and Maekawa's theorems.
    """
    count = len(angles)
    if count > MOST_SPOKES:
        return np.stack([fixed, np.ones(count, dtype=np.bool_)])
    subsets = (np.arange(1 << count)[:, None] >> np.arange(count)) % 2 == 1
    subsets = subsets[(subsets >= fixed).all(axis=1)]
    surplus = np.abs(np.where(subsets, np.where(valley, 1, -1), 0).sum(axis=1))
    place = np.cumsum(subsets, axis=1)
    turned = np.where(subsets, np.where(place % 2, -angles, angles), 0.0).sum(axis=1)
    size = place[:, -1]
    good = (size == 0) | ((size % 2 == 0) & (surplus == 2) & (np.abs(turned - math.pi) < STRAIGHT))
    flat: Bools = subsets[good]
    return flat


def _groups(pattern: FoldedPattern, edges: Indices) -> tuple[Ints, ...]:
    """Divide creases by the regions that they are in or reach into, what is in or hangs on a region before it.

    Where nothing is known of regions, the longest creases are first. Groups are joined until there are few.
    """
    ends = pattern.creases.vertices_coords[pattern.creases.edges_vertices[edges]]
    length = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    key = _places_in_tree(pattern.regions, ends) if pattern.regions else np.argsort(np.argsort(-length, kind="stable"))
    order = np.lexsort((-length, key))
    size = max(LEAST_GROUP, math.ceil(len(edges) / MOST_GROUPS))
    groups: list[list[int]] = []
    for at, before in zip(order.tolist(), [-1, *order.tolist()], strict=False):
        if not groups or (len(groups[-1]) >= size and key[at] != key[before]):
            groups.append([])
        groups[-1].append(int(edges[at]))
    return tuple(index_array(sorted(group)) for group in groups)


def _places_in_tree(regions: Sequence[Region], ends: Floats) -> Indices:
    """Return for each crease its smallest region's place in the tree, children first, ``(n,)``."""
    rings = [(outline, number) for number, region in enumerate(regions) for outline in region.outlines]
    rings = [(outline, number) for outline, number in rings if len(outline) > 2]
    polygons = np.array([shapely.Polygon(outline) for outline, _ in rings])
    largest_first = np.argsort(-shapely.area(polygons), kind="stable")
    owner = np.array([number for _, number in rings])[largest_first]
    places = np.concatenate([ends[:, 0] * (1 - share) + ends[:, 1] * share for share in ALONG])
    polygon, place = shapely.STRtree(shapely.points(places)).query(polygons[largest_first], predicate="intersects")
    children: list[list[int]] = [[] for _ in regions]
    todo: list[int] = []
    for number, region in enumerate(regions):
        (children[region.parent] if region.parent >= 0 else todo).append(number)
    preorder = []
    while todo:
        preorder.append(todo.pop())
        todo += children[preorder[-1]]
    rank = np.empty(len(regions), dtype=np.intp)
    rank[preorder[::-1]] = np.arange(len(regions))
    found = np.full(len(ends), -1)
    np.maximum.at(found, place % len(ends), polygon)
    return np.where(found < 0, len(regions), rank[owner[found]])


def _between(sheet: _Sheet, folded: Bools, end: _State) -> _State | None:
    """Return the sheet with some creases folded, its layers in an order that the verifier finds good, or None.

    The order follows from the mountains and valleys, and from that of ``end`` where layers lie on each other as there;
    where nothing follows from these, it is that of ``end``.
    """
    kinds = np.where(folded | ~sheet.creased, sheet.pattern.edges_assignment, "F")
    pattern = replace(sheet.pattern, edges_assignment=kinds)
    maps = fold_faces(pattern, sheet.beside)
    at = np.empty_like(sheet.flat)
    at[sheet.rings.values] = maps.apply(sheet.rings.rows, sheet.flat[sheet.rings.values])
    count = len(sheet.rings)
    state = _State(sheet, at, np.arange(count), folded)
    parts, part = state.parts(folded, None)
    left, right = sheet.beside[folded].T
    rising = state.up[left] == sheet.valley[folded]
    below = [(np.where(rising, left, right), np.where(rising, right, left))]
    one, other = np.nonzero(np.triu(state.meet))
    kept, same = _kept_together(state, end, one, other)
    one, other = one[kept], other[kept]
    rising = (end.rank[one] < end.rank[other]) == same[one]
    below.append((np.where(rising, one, other), np.where(rising, other, one)))
    low, high = (part[np.concatenate(side)] for side in zip(*below, strict=True))
    largest = np.full(parts, -1)
    for face in np.argsort(sheet.areas).tolist():
        largest[part[face]] = face
    order = _sorted_parts(low.tolist(), high.tolist(), end.rank[largest].tolist())
    if order is None:
        return None
    rank = np.argsort(np.lexsort((np.arange(count), np.argsort(order)[part])))
    if verify(pattern, index_array(np.argsort(rank))):
        return None
    return _State(sheet, at, rank, folded, state.meet)


def _sorted_parts(low: list[int], high: list[int], wish: list[int]) -> list[int] | None:
    """Sort parts so that each of ``low`` comes before its ``high``, else as they wish; None when that goes round."""
    after: list[set[int]] = [set() for _ in wish]
    for a, b in zip(low, high, strict=True):
        if a != b:
            after[a].add(b)
    waits = [0] * len(wish)
    for some in after:
        for b in some:
            waits[b] += 1
    ready = [(wish[k], k) for k in range(len(wish)) if not waits[k]]
    heapq.heapify(ready)
    order = []
    while ready:
        _, k = heapq.heappop(ready)
        order.append(k)
        for b in after[k]:
            waits[b] -= 1
            if not waits[b]:
                heapq.heappush(ready, (wish[b], b))
    return order if len(order) == len(wish) else None


def _best(turns: Iterator[_Turn], first: Bools | None = None) -> _Turn | None:
    """Return the fold of most creases, of few faces; one of creases that are to be ``first`` before all others."""

    def key(turn: _Turn) -> tuple[bool, int, int]:
        return first is not None and bool(first[turn.edges].all()), int(turn.edges.sum()), -int(turn.faces.sum())

    return max(turns, key=key, default=None)


def _is_one_sheet(state: _State, end: _State) -> bool:
    """Whether no two layers that lie on each other slide, or change places, on the way to ``end``."""
    one, other = np.nonzero(np.triu(state.meet))
    if not len(one):
        return True
    still, same = _kept_together(state, end, one, other)
    ordered = (state.rank[one] < state.rank[other]) == ((end.rank[one] < end.rank[other]) == same[one])
    return bool((still & ordered).all())


def _kept_together(state: _State, end: _State, one: Indices, other: Indices) -> tuple[Bools, Bools]:
    """Return which pairs of faces do not move against each other on the way to ``end``, and the faces that stay up."""
    turn, shift, same = _motion(state, end)
    near = 10 * state.sheet.tolerance
    kept = (same[one] == same[other]) & (np.abs(turn[one] - turn[other]) * np.abs(state.at).max() < near)
    return kept & (np.abs(shift[one] - shift[other]) < near), same


def _motion(state: _State, end: _State) -> tuple[NDArray[np.complex128], NDArray[np.complex128], Bools]:
    """Return the isometry from each face's place in one state to that in the other, and whether it keeps its side up.

    ``turn * z + shift`` for a complex z, conjugate where it is turned over.
    """
    first = state.sheet.rings.offsets[:-1]
    rings = state.sheet.rings
    # the vertex farthest from the first one
    start = rings.values[first]
    away = np.hypot(*(state.sheet.flat[rings.values] - state.sheet.flat[start][rings.rows]).T)
    order = np.lexsort((away, rings.rows))
    far = rings.values[order[rings.offsets[1:] - 1]]
    same = state.up == end.up
    z = [s.at[:, 0] + 1j * s.at[:, 1] for s in (state, end)]
    a, b = z[0][start], z[0][far]
    a, b = np.where(same, a, a.conj()), np.where(same, b, b.conj())
    turn = (z[1][far] - z[1][start]) / (b - a)
    return turn, z[1][start] - turn * a, same
