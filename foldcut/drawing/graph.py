"""Any planar graph of straight edges as a shape: slits, crossing lines, figures that touch (docs/graphs.md).

Loops and open lines in the drawing's units -> ``CutGraph`` -> ``Shape``s of it. Lines are divided where they meet or
cross; ends that nearly meet are joined. Each face of the graph goes to one side of the cut line. So an edge between
faces on opposite sides is not folded, and any other edge is: these become ``Shape.lines``. Which faces go to which side
is free: ``CutGraph.shapes`` yields the choices, those with the fewest folded edges first.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, Indices, points_array, sealed
from foldcut.core.errors import ShapeError, TouchError
from foldcut.core.model import Shape
from foldcut.drawing.shape import COLLINEAR_TOLERANCE, SHARPEST_CORNER, make_shape, parents_of
from foldcut.geometry.straight_skeleton.graph import Graph, graph_of
from foldcut.geometry.union_find import groups
from foldcut.geometry.vectors import signed_area

__all__ = ["JOIN", "CutGraph", "Edges", "edges_of", "make_graph", "shape_of_parts", "shapes_of"]

JOIN = 2.5e-4
"""Ends of lines that are nearer than this are joined, relative to the size of the drawing: 0.05 mm at 200 mm."""

SAME = 1e-9
"""Corners of a shape that are nearer than this are one, relative to its size."""

MOST_EDGES = 2000
"""Graphs with more edges are refused."""

ROUNDS = 20
"""How many times lines are divided where they meet: dividing one moves it by less than what is joined."""

FEW_FACES = 16
"""With at most this many faces besides the unbounded one, all choices of sides are compared; else by a program."""

MOST_TURNS = 12
"""Symmetry under more turns than this is not looked for."""

MOST_CHOICES = 64
"""How many choices of sides are kept."""

Edge = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Edges:
    """The edges of a graph between ``points`` ``(n, 2)``, and which of them are ``folded``."""

    points: Floats
    edges: tuple[Edge, ...]
    folded: frozenset[Edge]


def edges_of(shape: Shape) -> Edges:
    """Return the edges of a shape: those of its loops, and then those of its lines, which are folded."""
    points = shape.points
    number = np.array(_same_places(points, SAME * _size(points)))
    _, first, number = np.unique(number, return_index=True, return_inverse=True)
    ends = np.split(number, np.cumsum([len(line) for line in (*shape.loops, *shape.lines)])[:-1])
    rows = [row.tolist() for row in ends]
    loops = [pair for row in rows[: len(shape.loops)] for pair in pairwise([*row, row[0]])]
    lines = [pair for row in rows[len(shape.loops) :] for pair in pairwise(row)]
    return Edges(points_array(points[first]), (*loops, *lines), frozenset(lines))


def shape_of_parts(loops: Sequence[Floats], lines: Sequence[Floats]) -> Shape:
    """Return the shape of loops, which may touch at corners, and lines, as another shape had them."""
    counted = [_counter_clockwise(loop) for loop in loops]
    corners = [len(_distinct(loop)) for loop in counted]
    touching = bool(counted) and len(_distinct(np.concatenate(counted))) < sum(corners)
    return Shape(tuple(counted), parents_of(counted), tuple(points_array(line) for line in lines), touching)


@dataclass(frozen=True, eq=False)
class CutGraph:
    """A planar graph: ``graph`` has its points, its edges, and the face of the plane on each side of every edge.

    ``moved``: how far an end was moved at most to be joined, in the drawing's units. ``drawn``: how many sides the
    loops and lines had.
    """

    graph: Graph
    moved: float = 0.0
    drawn: int = 0

    @classmethod
    def of(cls, shape: Shape) -> CutGraph:
        """Return the graph of a shape."""
        found = edges_of(shape)
        return cls(graph_of(found.points, np.array(found.edges)), drawn=len(found.edges))

    def mirrored(self) -> CutGraph:
        """Return the graph with left and right swapped."""
        mirrored = graph_of(self.graph.points * (-1.0, 1.0), self.graph.edges)
        return replace(self, graph=mirrored)

    def simplified(self, tolerance: float) -> CutGraph:
        """Return the graph with points left out where lines stay within ``tolerance`` of it, in the drawing's units.

        Points stay where lines end or meet (Douglas and Peucker 1973). Raises ``ShapeError`` where lines come to cross.
        """
        points, edges = self.graph.points, self.graph.edges.tolist()
        kept: set[Edge] = set()
        for chain in _polylines(edges, set()):
            for part in _open_parts(points, chain):
                line = shapely.simplify(shapely.linestrings(points[part]), tolerance, preserve_topology=False)
                number = {(x, y): vertex for vertex, (x, y) in zip(part, points[part].tolist(), strict=True)}
                found = [number[x, y] for x, y in shapely.get_coordinates(line).tolist()]
                kept |= {(min(pair), max(pair)) for pair in pairwise(found)}
        used = sorted({vertex for edge in kept for vertex in edge})
        place = {vertex: k for k, vertex in enumerate(used)}
        try:
            graph = graph_of(points[used], np.array([(place[a], place[b]) for a, b in sorted(kept)]))
        except ValueError as error:
            raise ShapeError(
                f"simplified by {tolerance:.3g}, {error}; allow less, or draw lines farther apart"
            ) from error
        return replace(self, graph=graph)

    def symmetric(self, allowed: float) -> CutGraph:
        """Return the graph made exactly symmetric under as many turns about its middle as it has, if it has any.

        Drawings have rounded numbers, and creases of symmetric ones meet only if these are exact. ``allowed``: by how
        much a point may be off, in the drawing's units.
        """
        middle = self.graph.points.mean(axis=0)
        points = self.graph.points - middle
        for count in range(MOST_TURNS, 1, -1):
            angle = math.tau / count
            turn = np.array([(math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))])
            images = _images(points, self.graph.edges, turn, allowed)
            if images is None:
                continue
            exact = _exactly_turned(points, images, turn, count)
            if np.abs(exact - points).max() <= SAME * self.size:
                return self
            try:
                return replace(self, graph=graph_of(exact + middle, self.graph.edges))
            except ValueError:
                return self
        return self

    @property
    def is_as_drawn(self) -> bool:
        """Whether no line had to be divided and none was there twice."""
        return len(self.graph.edges) == self.drawn

    @property
    def faces(self) -> Indices:
        """The faces of the plane on the left and on the right of every edge, ``(m, 2)``; 0 is the unbounded one."""
        return self.graph.side_region[: 2 * len(self.graph.edges)].reshape(-1, 2)

    @property
    def size(self) -> float:
        """The length of the diagonal of the box around it."""
        return _size(self.graph.points)

    @property
    def face_count(self) -> int:
        """How many faces of the plane there are, the unbounded one among them: the pieces that the cut makes."""
        return int(self.faces.max()) + 1

    def shapes(self) -> Iterator[Shape]:
        """Yield the graph as a shape for each choice of sides, those with the fewest folded edges first.

        Choices come first that have all folded edges on one side of the cut line: a cut a hair beside the line, on that
        side, then parts all edges.
        """
        for inside in self._choices():
            yield self._shape(inside)

    def _choices(self) -> Iterator[Bools]:
        """Yield which faces are inside, the unbounded one never."""
        one_sided, free = (_sides(self.faces, self.face_count, self._weights(), k) for k in (True, False))
        first = next(one_sided)
        yield first
        seen = {first.tobytes()}
        for choice in _in_turns(free, one_sided):
            if choice.tobytes() not in seen:
                seen.add(choice.tobytes())
                yield choice

    def _weights(self) -> Floats:
        """What a folded edge costs, ``(m,)``: 1, and a little for its length."""
        ends = self.graph.points[self.graph.edges]
        length = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
        return np.asarray(np.round(1 + 0.01 * length / length.max(), 6))

    def _shape(self, inside: Bools) -> Shape:
        points, edges = self.graph.points, self.graph.edges.tolist()
        left, right = inside[self.faces].T
        between = left != right
        border = [(a, b) if at_left else (b, a) for (a, b), at_left, on in zip(edges, left, between, strict=True) if on]
        loops = [_counter_clockwise(points[loop]) for loop in _loops(points, border)]
        ends = {vertex for edge in border for vertex in edge}
        folded = [(a, b) for (a, b), on in zip(edges, between, strict=True) if not on]
        lines = tuple(points_array(points[line]) for line in _polylines(folded, ends))
        return Shape(tuple(loops), parents_of(loops), lines, touching=sum(map(len, loops)) > len(ends))


def make_graph(
    loops: Sequence[Floats], lines: Sequence[Floats], *, join: float | None = None, y_down: bool = False
) -> CutGraph:
    """Return the graph of closed loops and open lines, ``(n, 2)`` each, divided where they meet.

    ``join``: ends that are no farther apart are joined; None: than ``JOIN`` of the drawing's size. ``y_down``: as for
    ``make_shape``. Raises ``ShapeError`` with the place for what is no graph that can be cut.
    """
    drawn = [*(np.concatenate([loop, loop[:1]]) for loop in loops), *lines]
    drawn = [line for line in drawn if len(line) > 1]
    if not drawn or not all(np.isfinite(line).all() for line in drawn):
        raise ShapeError("the drawing has no lines with finite coordinates; draw at least one line")
    points = np.concatenate(drawn)
    size = _size(points)
    near = max(JOIN * size if join is None else join, SAME * size)
    if not 1e-100 < near < 1e100:
        raise ShapeError("all points of the drawing are at one place, or too far apart; draw at least one line")
    divided = _Divided(points, _pairs(drawn), near, size)
    graph_points, edges = divided.result()
    own_y = -1.0 if y_down else 1.0
    if not edges:
        why = "have no length" if join is None else f"are no longer than {join:.3g}, which --join joins"
        remedy = "draw at least one line" + ("" if join is None else ", or join ends that are nearer")
        raise ShapeError(f"the lines of the drawing {why}; {remedy}")
    if len(edges) > MOST_EDGES:
        raise ShapeError(
            f"the drawing has {len(edges)} straight pieces of lines; at most {MOST_EDGES} can be cut: draw "
            "fewer, or divide curves into fewer with --flatten 1mm"
        )
    _refuse_sharp(graph_points, edges, own_y)
    try:
        return CutGraph(graph_of(graph_points, np.array(edges)), divided.moved, divided.drawn)
    except ValueError as error:
        raise ShapeError(f"the lines of the drawing are no graph: {error}; draw them farther apart") from error


def shapes_of(loops: Sequence[Floats], *, y_down: bool = False) -> list[Shape]:
    """Return the shape that loops make, or all shapes of the graph that they are where they touch.

    Raises ``ShapeError`` as ``make_shape`` and ``make_graph`` do.
    """
    try:
        return [make_shape(loops, y_down=y_down)]
    except TouchError:
        return list(make_graph(loops, (), y_down=y_down).shapes())


class _Divided:
    """Lines that are divided, again and again, where they meet a point or cross another line.

    ``near``: points are joined, and are on a line, if they are no farther apart than this; ``size`` is the drawing's.
    """

    def __init__(self, points: Floats, pairs: Sequence[Edge], near: float, size: float) -> None:
        self.drawn = sum(bool((points[a] != points[b]).any()) for a, b in pairs)
        self._straight = COLLINEAR_TOLERANCE * size
        first = _same_places(points, near)
        self.moved = float(np.hypot(*(points - points[first]).T).max())
        self.points: list[tuple[float, float]] = [(x, y) for x, y in points.tolist()]
        self.near = near
        self.edges = self._cleaned([(first[a], first[b]) for a, b in pairs])
        for _ in range(ROUNDS):
            if not self.edges or not (self._divide_at_points() or self._divide_at_crossings()):
                break

    def result(self) -> tuple[Floats, list[Edge]]:
        """Return the points that have edges, and the edges, without points in the middle of a straight line."""
        edges = self._without_straight()
        used = sorted({vertex for edge in edges for vertex in edge})
        number = {vertex: k for k, vertex in enumerate(used)}
        places = points_array([self.points[vertex] for vertex in used]) if used else points_array(np.empty((0, 2)))
        return sealed(places), sorted((number[a], number[b]) for a, b in edges)

    @staticmethod
    def _cleaned(edges: Sequence[Edge]) -> list[Edge]:
        return sorted({(min(edge), max(edge)) for edge in edges if edge[0] != edge[1]})

    def _divide_at_points(self) -> bool:
        """Divide edges at points that are on them, and return whether there were any."""
        used = sorted({vertex for edge in self.edges for vertex in edge})
        ends = np.array([[self.points[a], self.points[b]] for a, b in self.edges]).reshape(-1, 2, 2)
        places = shapely.points([self.points[vertex] for vertex in used])
        tree = shapely.STRtree(shapely.linestrings(ends))
        point, edge = tree.query(places, predicate="dwithin", distance=self.near)
        on: dict[int, list[int]] = defaultdict(list)
        for vertex, number in zip(point.tolist(), edge.tolist(), strict=True):
            if used[vertex] not in self.edges[number]:
                on[number].append(used[vertex])
        for number, inner in on.items():
            for vertex in inner:
                away = shapely.distance(shapely.linestrings(ends[number]), shapely.Point(self.points[vertex]))
                self.moved = max(self.moved, float(away))
        return self._divide(on)

    def _divide_at_crossings(self) -> bool:
        """Divide edges that cross, at new points, and return whether there were any."""
        ends = np.array([[self.points[a], self.points[b]] for a, b in self.edges]).reshape(-1, 2, 2)
        lines = shapely.linestrings(ends)
        one, other = shapely.STRtree(lines).query(lines, predicate="crosses")
        on: dict[int, list[int]] = defaultdict(list)
        for first, second in zip(one.tolist(), other.tolist(), strict=True):
            if first < second and not {*self.edges[first]} & {*self.edges[second]}:
                x, y = shapely.get_coordinates(shapely.intersection(lines[first], lines[second]))[0].tolist()
                known = [v for v in (*on[first], *on[second]) if math.dist(self.points[v], (x, y)) <= self.near]
                vertex = known[0] if known else len(self.points)
                if not known:
                    self.points.append((x, y))
                on[first].append(vertex)
                on[second].append(vertex)
        return self._divide(on)

    def _divide(self, on: Mapping[int, Sequence[int]]) -> bool:
        """Divide edges, by their numbers, at the points that are ``on`` them, and return whether there were any."""
        divided: list[Edge] = []
        for number, (a, b) in enumerate(self.edges):
            inner = sorted(dict.fromkeys(on.get(number, ())), key=lambda v: math.dist(self.points[a], self.points[v]))
            divided += pairwise([a, *inner, b])
        self.edges = self._cleaned(divided)
        return bool(on)

    def _without_straight(self) -> list[Edge]:
        """Return the edges with those joined that go straight on at a point with no others."""
        beside: dict[int, set[int]] = defaultdict(set)
        for a, b in self.edges:
            beside[a].add(b)
            beside[b].add(a)
        for vertex in sorted(beside):
            if len(beside[vertex]) != 2:
                continue
            a, b = sorted(beside[vertex])
            along = shapely.LineString([self.points[a], self.points[b]])
            if b not in beside[a] and shapely.distance(along, shapely.Point(self.points[vertex])) <= self._straight:
                beside[a] = (beside[a] - {vertex}) | {b}
                beside[b] = (beside[b] - {vertex}) | {a}
                beside[vertex] = set()
        return self._cleaned([(a, b) for a, many in beside.items() for b in many])


def _pairs(lines: Sequence[Floats]) -> list[Edge]:
    """Return the numbers of the ends of all pieces of lines, whose points are numbered one line after the other."""
    first = np.cumsum([0, *(len(line) for line in lines)]).tolist()
    return [pair for a, b in pairwise(first) for pair in pairwise(range(a, b))]


def _size(points: Floats) -> float:
    """Return the length of the diagonal of the box around points."""
    return float(np.hypot(*np.ptp(points, axis=0)))


def _same_places(points: Floats, near: float) -> list[int]:
    """Return for each point the first of those that are joined with it, since they are not farther apart than this."""
    tree = shapely.STRtree(shapely.points(points))
    one, other = tree.query(tree.geometries, predicate="dwithin", distance=near)
    group = groups(len(points), [(a, b) for a, b in zip(one.tolist(), other.tolist(), strict=True) if a < b])
    first: dict[int, int] = {}
    return [first.setdefault(name, number) for number, name in enumerate(group)]


def _counter_clockwise(loop: Floats) -> Floats:
    """Return a loop that runs counter-clockwise and begins where it began."""
    return points_array(loop if signed_area(loop) > 0 else np.roll(loop[::-1], 1, axis=0))


def _distinct(points: Floats) -> Floats:
    """Return points without those that are the same as one before."""
    return points[np.unique(_same_places(points, SAME * _size(points)))]


def _refuse_sharp(points: Floats, edges: Sequence[Edge], own_y: float) -> None:
    """Raise ``ShapeError`` where two edges leave a point in nearly the same direction."""
    around: dict[int, list[float]] = defaultdict(list)
    for a, b in edges:
        for one, other in ((a, b), (b, a)):
            x, y = points[other] - points[one]
            around[one].append(math.degrees(math.atan2(y, x)))
    for vertex, angles in around.items():
        angles.sort()
        if len(angles) > 1:
            least = min(b - a for a, b in pairwise([*angles, angles[0] + 360.0]))
            if least < SHARPEST_CORNER:
                x, y = points[vertex] * (1.0, own_y) + 0.0
                raise ShapeError(
                    f"two lines leave ({x:.6g}, {y:.6g}) with {least:.2g} degrees between them; draw one of them only, "
                    f"or open the angle to at least {SHARPEST_CORNER} degrees"
                )


# ---- which face goes to which side ----


def _sides(faces: Indices, count: int, weights: Floats, one_sided: bool) -> Iterator[Bools]:
    """Yield which faces are inside, ``(count,)``, the unbounded face never, those with the cheapest folded edges first.

    ``faces`` ``(m, 2)``, ``weights`` ``(m,)``. ``one_sided``: all folded edges are inside, or all are outside.
    """
    if count <= FEW_FACES + 1:
        yield from _all_sides(faces, count, weights, one_sided)
    else:
        yield from _sides_by_programming(faces, count, weights, one_sided)


def _all_sides(faces: Indices, count: int, weights: Floats, one_sided: bool) -> Iterator[Bools]:
    number = np.arange(1 << (count - 1))
    cost, folds_inside, folds_outside = np.zeros(len(number)), *np.zeros((2, len(number)), dtype=np.bool_)
    bits = [np.zeros(len(number), dtype=np.bool_), *(number >> k & 1 == 1 for k in range(count - 1))]
    for (left, right), weight in zip(faces.tolist(), weights.tolist(), strict=True):
        folded = bits[left] == bits[right]
        cost += weight * folded
        folds_inside |= folded & bits[left]
        folds_outside |= folded & ~bits[left]
    allowed = np.flatnonzero(~(folds_inside & folds_outside)) if one_sided else number
    best = allowed[np.argsort(np.round(cost[allowed], 9), kind="stable")][:MOST_CHOICES]
    for choice in best.tolist():
        yield np.array([False, *((choice >> k & 1) == 1 for k in range(count - 1))])


def _sides_by_programming(faces: Indices, count: int, weights: Floats, one_sided: bool) -> Iterator[Bools]:
    """Yield the same by integer programming."""
    from scipy.optimize import Bounds, LinearConstraint, milp

    # the unknowns: 1 for every face that is inside; for every edge 1 if it is folded; 1 if folded edges are inside
    edges = len(faces)
    rows: list[tuple[dict[int, float], float]] = [({0: 1.0}, 0.0)]  # each: a sum is at most a number
    side = count + edges
    for k, (left, right) in enumerate(faces.tolist()):
        if left == right:
            rows.append(({count + k: -1.0}, -1.0))
            both = {left: 1.0}
            most_inside, most_outside = ({**both, side: -1.0}, 0.0), ({left: -1.0, side: 1.0}, 0.0)
        else:
            both = {left: 1.0, right: 1.0}
            rows.append(({**both, count + k: -1.0}, 1.0))
            rows.append(({left: -1.0, right: -1.0, count + k: -1.0}, -1.0))
            most_inside = ({**both, side: -1.0}, 1.0)
            most_outside = ({left: -1.0, right: -1.0, side: 1.0}, 0.0)
        if one_sided:
            rows += [most_inside, most_outside]
    cost = np.concatenate([np.zeros(count), weights, [0.0]])
    for _ in range(MOST_CHOICES):
        matrix = np.zeros((len(rows), side + 1))
        for k, (row, _most) in enumerate(rows):
            matrix[k, list(row)] = list(row.values())
        found = milp(
            cost,
            constraints=LinearConstraint(matrix, -np.inf, [most for _, most in rows]),
            integrality=np.ones(side + 1, dtype=np.int64),
            bounds=Bounds(0, 1),
        )
        if found.x is None:
            return
        inside = found.x[:count] > 0.5
        yield inside
        rows.append(({k: 1.0 if inside[k] else -1.0 for k in range(1, count)}, float(inside.sum()) - 1.0))


def _in_turns(one: Iterator[Bools], other: Iterator[Bools]) -> Iterator[Bools]:
    """Yield from two iterators in turns until both are exhausted."""
    waiting = [one, other]
    while waiting:
        iterator = waiting.pop(0)
        found = next(iterator, None)
        if found is not None:
            yield found
            waiting.append(iterator)


# ---- from edges to loops and lines ----


def _loops(points: Floats, border: Sequence[Edge]) -> list[list[int]]:
    """Return simple loops of directed edges with the inside on their left; they may touch at corners."""
    leaving: dict[int, list[int]] = defaultdict(list)
    for a, b in border:
        leaving[a].append(b)

    def turn(back: int, vertex: int, ahead: int) -> float:
        """Return the angle, clockwise, from the way back to a way ahead."""
        way_back, way_ahead = (points[v] - points[vertex] for v in (back, ahead))
        angles = math.atan2(way_back[1], way_back[0]) - math.atan2(way_ahead[1], way_ahead[0])
        return angles % math.tau or math.tau

    loops: list[list[int]] = []
    for start, first in border:
        if first not in leaving[start]:
            continue
        leaving[start].remove(first)
        way = [start, first]
        while True:
            vertex = way[-1]
            if vertex in way[:-1]:  # a simple loop is complete; go on with what was walked before it
                at = way.index(vertex)
                loops.append(way[at:-1])
                del way[at + 1 :]
                if at == 0:
                    break
            back = way[-2] if len(way) > 1 else start
            ahead = min(leaving[vertex], key=lambda v: turn(back, vertex, v))
            leaving[vertex].remove(ahead)
            way.append(ahead)
    return loops


def _polylines(edges: Sequence[Edge], stops: set[int]) -> list[list[int]]:
    """Return edges as lines as long as can be, which end where others meet them and at ``stops``."""
    beside: dict[int, list[int]] = defaultdict(list)
    for a, b in edges:
        beside[a].append(b)
        beside[b].append(a)
    ends = [vertex for vertex in sorted(beside) if len(beside[vertex]) != 2 or vertex in stops]
    lines: list[list[int]] = []
    for start in [*ends, *sorted(beside)]:  # closed lines come last
        while beside[start]:
            line = [start]
            while beside[line[-1]]:
                vertex = line[-1]
                following = beside[vertex].pop(0)
                beside[following].remove(vertex)
                line.append(following)
                if following in ends:
                    break
            lines.append(line)
    return lines


def _images(points: Floats, edges: Indices, turn: Floats, allowed: float) -> Indices | None:
    """Return for each point the one that it is turned onto; None if some edge is not turned onto an edge."""
    away = np.hypot(*((points @ turn)[:, None] - points[None]).transpose(2, 0, 1))
    images: Indices = away.argmin(axis=1)
    if away[np.arange(len(points)), images].max() > allowed or len(np.unique(images)) < len(points):
        return None
    before, after = ({tuple(row) for row in np.sort(some, axis=1).tolist()} for some in (edges, images[edges]))
    return images if before == after else None


def _exactly_turned(points: Floats, images: Indices, turn: Floats, count: int) -> Floats:
    """Return the means of all images of each point, turned back, so that they agree to the last digits."""
    turns = [np.linalg.matrix_power(turn, number) for number in range(count)]
    orbits = [np.arange(len(points))]
    for _ in range(count - 1):
        orbits.append(images[orbits[-1]])
    means = np.mean([points[orbit] @ back.T for orbit, back in zip(orbits, turns, strict=True)], axis=0)
    exact, done = points.copy(), np.zeros(len(points), dtype=np.bool_)
    for point in range(len(points)):
        if not done[point]:
            for orbit, ahead in zip(orbits, turns, strict=True):
                exact[orbit[point]] = means[point] @ ahead
                done[orbit[point]] = True
    return exact


def _open_parts(points: Floats, chain: list[int]) -> list[list[int]]:
    """Return a chain of points, or if it is closed, two parts of it, from its first point to the farthest one."""
    if chain[0] != chain[-1]:
        return [chain]
    middle = int(np.hypot(*(points[chain] - points[chain[0]]).T).argmax())
    return [chain[: middle + 1], chain[middle:]]
