"""What an outline costs to fold, and how its corners are moved: the compiled kernels behind Python objects.

``Field`` (the drawing to stay near to, on its sheet) -> ``Engine`` -> ``Assessment`` of an outline, moved outlines.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.compiled import compiled_copy
from foldcut.geometry.straight_skeleton import wavefront
from foldcut.geometry.straight_skeleton.graph import graph_of
from foldcut.geometry.straight_skeleton.skeleton import Workspace
from foldcut.geometry.straight_skeleton.tables import Arrays, Lists
from foldcut.redraw import proxy_kernel, ties_kernel
from foldcut.redraw.bounds import HANDS_CREASE_MM

LEAST_CREASE_MM = HANDS_CREASE_MM
"""Shorter creases cost more."""

SHORT_COST = 3.0, 7.0
"""What a crease costs that is shorter than that, in lines, and what more it costs, in proportion, the shorter it is."""

ENDLESS_COST = 25.0
"""What a node costs whose perpendiculars do not end: more lines than they would have."""

FITS = 2
"""How many steps the corners are fitted to the drawing while they are moved; then nothing but the ties counts."""

LOOSE_COST = 6.0
"""What each perpendicular costs that does not end, even if it is not folded: what lies beyond it is not known."""

FRAME = 6.0
"""How far from the middle of the sheet the frame is that ends the skeleton, in diagonals."""

SNAP = 1e-9
"""Points less far apart are one, relative to the sheet's diagonal."""

NEAR = 1e-6
"""Nodes less far apart are taken as one, relative to the sheet's diagonal."""

EXACT = 1e-12
"""How exactly ties are made, relative to the sheet's diagonal."""

SAMPLE_MM = 1.0
"""How far apart the points of the drawing are that outlines are compared with."""

MOST_SAMPLES = 500
"""How many such points there are at most."""

MOST_NOTED = 4000
"""How many faces on the ways of perpendiculars, and how many nodes that they nearly come to, are noted at most."""

Tie = tuple[int, ...]
"""Sides that are equally far from one point, in ascending order: side 2k runs along edge k with its face on the left,
side 2k + 1 against it."""


class Meeting(NamedTuple):
    """A perpendicular that is to come to a node.

    It has the sides of the node it starts at, of the faces on its way, and of the node that it is to come to.
    """

    start: Tie
    way: Tie
    end: Tie


class Work(NamedTuple):
    """The tables of ``proxy_kernel``."""

    counts: Any
    numbers: Any
    sizes: Any
    ints: Any
    place: Any
    x: Any
    y: Any
    root: Any
    degree: Any
    at_node: Any
    level_at: Any
    spoke_at: Any
    first: Any
    ax: Any
    ay: Any
    sx: Any
    sy: Any
    tail: Any
    head: Any
    face: Any
    twin: Any
    kind: Any
    u0: Any
    u1: Any
    cut_at: Any
    next_at_node: Any
    key: Any
    value: Any
    path_half: Any
    path_start: Any
    path_end: Any
    path_cost: Any
    path_taken: Any
    path_last: Any
    path_angle: Any
    path_next: Any
    path_before: Any
    path_mate: Any
    path_group: Any
    path_sector: Any
    path_point: Any
    point_x: Any
    point_y: Any
    node_path: Any
    group_first: Any
    group_best: Any
    sector_cost: Any
    member: Any
    stuck: Any
    taken: Any
    way_first: Any
    way: Any
    miss: Any
    miss_path: Any
    miss_step: Any
    miss_node: Any
    spoke_x: Any
    spoke_y: Any
    spoke_next: Any
    cut_part: Any
    cut_next: Any
    exit_x: Any
    exit_y: Any
    ridge: Any
    ridge_length: Any


REALS = {
    "numbers", "sizes", "place", "x", "y", "ax", "ay", "sx",
    "sy", "u0", "u1", "ridge_length", "path_cost", "path_angle", "sector_cost", "exit_x",
    "exit_y", "spoke_x", "spoke_y", "cut_part", "point_x", "point_y", "miss",
}  # fmt: skip
"""Which of the tables hold real numbers; the others hold integers."""


def _zeros(*shape: int) -> Any:
    return np.zeros(shape)


def _numbers(*shape: int) -> Any:
    return np.zeros(shape, dtype=np.int64)


def _work(nodes: int, sides: int) -> Work:
    """Return tables with room for so many nodes and sides."""
    halves, paths = 4 * (nodes + sides) + 64, 4 * nodes + 64
    buckets = 1 << (2 * halves).bit_length()
    rows = (
        (2, "place"),
        (8, "numbers"),
        (12, "sizes"),
        (16, "ints"),
        (20, "counts"),
        (nodes + 1, "x y root degree at_node level_at spoke_at node_path"),
        (sides + 1, "first ax ay sx sy"),
        (halves + 1, "tail head face twin kind u0 u1 cut_at next_at_node ridge ridge_length taken way_first"),
        (paths + 1, "path_half path_start path_end path_cost path_taken path_last path_angle path_next path_before"),
        (paths + 1, "path_mate path_group path_sector path_point group_first group_best sector_cost member stuck"),
        (paths + 1, "exit_x exit_y"),
        (8 * paths, "spoke_x spoke_y spoke_next cut_part cut_next"),
        (16 * paths, "point_x point_y"),
        (MOST_NOTED, "way miss miss_path miss_step miss_node"),
        (buckets, "key value"),
    )
    tables = {name: _zeros(n) if name in REALS else _numbers(n) for n, names in rows for name in names.split()}
    return Work(**tables)


class Moving(NamedTuple):
    """The tables of ``ties_kernel``."""

    sizes: Any
    node: Any
    x: Any
    y: Any
    dx: Any
    dy: Any
    length: Any
    mark: Any
    following: Any
    before: Any
    tie_first: Any
    member: Any
    meeting: Any
    basis: Any
    g: Any
    value: Any
    h: Any
    slope: Any
    change: Any
    sample_x: Any
    sample_y: Any
    grid: Any
    cell_first: Any
    cell_item: Any
    line: Any
    row: Any
    row_side: Any
    kept_g: Any
    kept_value: Any


@dataclass(frozen=True, eq=False)
class Field:
    """What outlines are compared with: a drawing on its sheet, both in mm.

    ``loops``: dense polylines, ``(n, 2)`` each. What lies beyond the sheet, which is ``width`` by ``height``, does not
    count. ``tolerance``: how far the outline may be from the drawing, and the drawing from the outline. ``axes``: the
    sheet is the part to the right of an upright axis (0), above a level one (1), or both; it is folded there first.
    """

    loops: tuple[Floats, ...]
    width: float
    height: float
    tolerance: float
    axes: tuple[int, ...] = ()

    @property
    def diagonal(self) -> float:
        """The sheet's diagonal."""
        return math.hypot(self.width, self.height)

    @cached_property
    def samples(self) -> Floats:
        """Points of the drawing on the sheet, evenly spaced, and its corners, ``(k, 2)``."""
        length = sum(float(np.hypot(*(np.roll(loop, -1, axis=0) - loop).T).sum()) for loop in self.loops)
        step = max(SAMPLE_MM, length / MOST_SAMPLES)
        points = np.concatenate([_dense(loop, step) for loop in self.loops])
        return np.ascontiguousarray(points[self._is_on(points)])

    def _is_on(self, points: Floats) -> Any:
        return ((points >= 0) & (points <= (self.width, self.height))).all(axis=1)

    @cached_property
    def grid(self) -> tuple[Floats, Any, Any, Floats]:
        """The drawing's segments by the cells of a grid that they are near to."""
        start = np.concatenate(self.loops)
        step = np.concatenate([np.roll(loop, -1, axis=0) - loop for loop in self.loops])
        kept = np.hypot(*step.T) > 0
        start, step = start[kept], step[kept]
        reach = 2.5 * self.tolerance
        low, high = start.min(axis=0) - reach - 1, start.max(axis=0) + reach + 1
        size = max(2.0, 2 * self.tolerance, float((high - low).max()) / 150)
        columns, rows = (int(count) + 1 for count in (high - low) / size)
        a, b = np.minimum(start, start + step) - reach, np.maximum(start, start + step) + reach
        first, last = ((a - low) / size).astype(int), ((b - low) / size).astype(int)
        across, up = (last - first + 1).T
        count = across * up
        item = np.repeat(np.arange(len(start)), count)
        k = np.arange(len(item)) - np.repeat(np.cumsum(count) - count, count)
        cell = (first[item, 1] + k // across[item]) * columns + first[item, 0] + k % across[item]
        order = np.argsort(cell, kind="stable")
        offsets = np.concatenate([[0], np.cumsum(np.bincount(cell, minlength=columns * rows))])
        lines = np.ascontiguousarray(np.concatenate([start, step], axis=1))
        return np.array([*low, size, columns, rows], dtype=np.float64), offsets, item[order], lines


def _dense(loop: Floats, step: float) -> Floats:
    """Return a loop's points, and more between them, no farther apart than ``step``; fewer where they are dense."""
    after = np.roll(loop, -1, axis=0)
    length = np.hypot(*(after - loop).T)
    before = np.roll(loop, 1, axis=0)
    a, b = loop - before, after - loop
    turn = np.abs(np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], (a * b).sum(axis=1)))
    along = np.concatenate([[0.0], np.cumsum(length)])
    places = np.arange(max(3, math.ceil(along[-1] / step))) * along[-1] / max(3, math.ceil(along[-1] / step))
    places = np.concatenate([places, along[:-1][turn > math.radians(20)]])
    k = np.clip(np.searchsorted(along, places, side="right") - 1, 0, len(loop) - 1)
    part = (places - along[k]) / np.maximum(length[k], 1e-300)
    return np.asarray(loop[k] + part[:, None] * (after[k] - loop[k]), dtype=np.float64)


@dataclass(eq=False)
class Assessment:
    """What an outline costs to fold.

    ``points`` ``(n, 2)``, the corners of loops of ``loop_sizes``. ``cost``: all of it in one number, to which what
    folding the outline has shown is added (``is_believed``). ``lines``: straight folds; ``shortest`` crease in mm, and
    how many are ``short``; ``endless``: nodes whose perpendiculars do not end; ``odd`` nodes; perpendiculars ``taken``.
    ``details``: a ``Details`` if they were asked for.
    """

    points: Floats
    loop_sizes: tuple[int, ...]
    cost: float
    lines: int
    shortest: float
    short: int
    endless: int
    odd: int
    taken: int
    details: Any = None
    is_believed: bool = False

    @property
    def structure(self) -> tuple[object, ...]:
        """What the creases of the outline have in common with those of outlines of nearly the same corners."""
        details = self.details
        return self.loop_sizes, tuple(sorted((path[:3] for path in details.paths if path[3]), key=str)), details.ties()

    @property
    def key(self) -> tuple[float, float]:
        """Less is better."""
        return self.cost, -self.shortest


class _Place:
    """The tables for outlines with loops of certain sizes."""

    def __init__(self, engine: Engine, loop_sizes: tuple[int, ...], points: Floats) -> None:
        count = sum(loop_sizes)
        first = np.cumsum([0, *loop_sizes]).tolist()
        edges = [(a + k, a + (k + 1) % (b - a)) for a, b in pairwise([*first, count + 4]) for k in range(b - a)]
        self.count = count
        graph = graph_of(np.concatenate([points, engine.frame]), np.array(edges))
        self.workspace = Workspace(graph, engine.tables)
        self.work = _work(count + 4 + self.workspace.room, 2 * count + 8)
        width, height = engine.field.width, engine.field.height
        diagonal = engine.field.diagonal
        self.work.sizes[:] = (
            width, height, SNAP * diagonal, NEAR * diagonal, engine.least_crease, ENDLESS_COST, 0.0, *engine.short_cost,
            *(float(axis in engine.field.axes) for axis in (0, 1)), LOOSE_COST,
        )  # fmt: skip
        samples = engine.field.samples
        grid, cell_first, cell_item, lines = engine.field.grid
        following = np.array([b for _, b in edges[:count]])
        before = np.empty_like(following)
        before[following] = np.arange(count)
        rows = 4 * count + 60
        f, i = _zeros, _numbers
        self.moving = Moving(
            f(8), f(3), f(count), f(count), f(count), f(count), f(count), i(count), following, before,
            i(4 * count + 60), i(60 * count + 2000), i(64, 4), f(40, 40), f(rows, 2 * count), f(rows),
            f(2 * count, 2 * count), f(2 * count), f(2 * count),
            np.ascontiguousarray(samples[:, 0]), np.ascontiguousarray(samples[:, 1]), grid, cell_first, cell_item,
            lines, f(len(samples) + count, 5), i(len(samples) + count), f(rows, 2 * count), f(rows),
        )  # fmt: skip
        self.moving.sizes[:5] = engine.field.tolerance, EXACT * diagonal, FITS, width, height
        self.samples = len(samples)


class Engine:
    """Assesses and moves outlines of one drawing on one sheet."""

    def __init__(
        self,
        field: Field,
        *,
        least_crease: float = LEAST_CREASE_MM,
        short_cost: tuple[float, float] = SHORT_COST,
        compiled: bool = True,
    ) -> None:
        self.field = field
        self.short_cost = short_cost
        self.least_crease = least_crease
        self.tables = Arrays() if compiled else Lists()
        self.proxy: Any = compiled_copy(proxy_kernel) if compiled else proxy_kernel
        self.ties: Any = compiled_copy(ties_kernel) if compiled else ties_kernel
        middle = np.array([field.width, field.height]) / 2
        self.frame = middle + FRAME * field.diagonal * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
        span = 2 * FRAME * field.diagonal
        self.middle = middle
        self.scale = 2.0 ** math.frexp(span)[1]
        self.noise = 2.0**-52 * max(1.0, float(np.abs(self.frame).max()) / self.scale)
        self.places: dict[tuple[int, ...], _Place] = {}
        self.assessed = 0
        self.solved = 0
        self.tightened = 0

    def place(self, points: Floats, loop_sizes: tuple[int, ...]) -> _Place | None:
        """Return the tables for outlines of these sizes; None where these sides cross."""
        found = self.places.get(loop_sizes)
        if found is None:
            try:
                found = self.places[loop_sizes] = _Place(self, loop_sizes, points)
            except ValueError:
                return None
        return found

    def assess(
        self, points: Floats, loop_sizes: tuple[int, ...], reach: float = 0.0, most: float = math.inf
    ) -> Assessment | None:
        """Return what an outline costs; None where it has no skeleton.

        With ``reach`` the details are kept, too, if it costs less than ``most``: copying them takes time.
        """
        at = self.place(points, loop_sizes)
        if at is None:
            return None
        self.assessed += 1
        x, y = (np.concatenate([points, self.frame]) - self.middle).T / self.scale
        space, work = at.workspace, at.work
        if not space.run(x, y, self.noise) or space.front.counts[wavefront.WRONG_FACES]:
            return None
        work.sizes[proxy_kernel.REACH] = reach
        status = self.proxy.assess(
            space.front, space.sides, space.faces, work, at.count, 2 * at.count, self.scale, *self.middle
        )
        if status < 0:
            return None
        counts, numbers = work.counts, work.numbers
        found = Assessment(
            points, loop_sizes, float(numbers[proxy_kernel.COST]), int(counts[proxy_kernel.LINES]),
            float(numbers[proxy_kernel.SHORTEST]), int(counts[proxy_kernel.SHORT]), int(counts[proxy_kernel.ENDLESS]),
            int(counts[proxy_kernel.DEGREES]), int(counts[proxy_kernel.TAKEN]),
        )  # fmt: skip
        if reach and found.cost < most:
            found.details = Details(work, at.count)
        return found

    def load(self, at: _Place, points: Floats) -> None:
        """Put corners into the tables."""
        at.moving.x[:], at.moving.y[:] = points.T

    def is_good(self, points: Floats, loop_sizes: tuple[int, ...], slack: float = 1.0) -> bool:
        """Return whether an outline is simple and within the tolerance."""
        return self.deviation(points, loop_sizes, slack * self.field.tolerance) <= slack * self.field.tolerance

    def deviation(self, points: Floats, loop_sizes: tuple[int, ...], most: float = 1e9) -> float:
        """Return how far outline and drawing are apart, both ways; infinite if more than ``most`` or sides cross."""
        at = self.place(points, loop_sizes)
        if at is None:
            return math.inf
        self.load(at, points)
        if not self.ties.is_simple(at.moving, at.count):
            return math.inf
        return float(self.ties.deviation(at.moving, at.count, at.samples, most))

    def solve(
        self,
        points: Floats,
        loop_sizes: tuple[int, ...],
        ties: Sequence[Tie],
        meetings: Sequence[Meeting] = (),
        fits: int = FITS,
    ) -> Floats | None:
        """Return the corners moved so that ties and meetings hold, None where that fails.

        They are fitted to the drawing in the first ``fits`` steps: more are needed where corners were left out.
        """
        at = self._constrained(points, loop_sizes, ties, meetings)
        if at is None:
            return None
        self.solved += 1
        at.moving.sizes[ties_kernel.FITS] = fits
        if not self.ties.solve(at.moving, at.count, len(ties), len(meetings), at.samples):
            return None
        return np.stack([at.moving.x, at.moving.y], axis=1)

    def tighten(
        self, points: Floats, loop_sizes: tuple[int, ...], ties: Sequence[Tie], meetings: Sequence[Meeting] = ()
    ) -> Floats | None:
        """Return corners of an outline within the tolerance, so that ties and meetings hold, or None where that fails.

        It takes ten times as long as ``solve``, and finds outlines where the best fit by least squares is too far off.
        """
        at = self._constrained(points, loop_sizes, ties, meetings)
        if at is None:
            return None
        self.tightened += 1
        if not self.ties.tighten(at.moving, at.count, len(ties), len(meetings), at.samples):
            return None
        found = np.stack([at.moving.x, at.moving.y], axis=1)
        if ties or meetings:
            exact = self.solve(found, loop_sizes, ties, meetings, fits=0)
            if exact is None:
                return None
            found = exact
        return found if self.is_good(found, loop_sizes) else None

    def _constrained(
        self, points: Floats, loop_sizes: tuple[int, ...], ties: Sequence[Tie], meetings: Sequence[Meeting]
    ) -> _Place | None:
        """Put corners, ties and meetings into the tables, and return these; None where there is no room."""
        at = self.place(points, loop_sizes)
        if at is None or len(meetings) > len(at.moving.meeting) or len(ties) >= len(at.moving.tie_first):
            return None
        self.load(at, points)
        moving, filled = at.moving, 0
        for k, tie in enumerate(ties):
            moving.tie_first[k] = filled
            moving.member[filled : filled + len(tie)] = tie
            filled += len(tie)
        moving.tie_first[len(ties)] = filled
        for k, meeting in enumerate(meetings):
            sides = (*meeting.start, *meeting.way, *meeting.end)
            if filled + len(sides) > len(moving.member):
                return None
            a, b = filled + len(meeting.start), filled + len(meeting.start) + len(meeting.way)
            moving.meeting[k] = filled, a, b, filled + len(sides)
            moving.member[filled : filled + len(sides)] = sides
            filled += len(sides)
        return at


class Details:
    """What moves begin with: copies of the tables after an assessment."""

    def __init__(self, work: Work, corners: int) -> None:
        counts = work.counts
        self.corners = corners
        halves = int(counts[proxy_kernel.HALVES])
        tails, faces = work.tail[:halves].tolist(), work.face[:halves].tolist()
        around: dict[int, set[int]] = {}
        for node, side in zip(tails, faces, strict=True):
            around.setdefault(node, set()).add(side)
        self.sides: dict[int, Tie] = {node: tuple(sorted(sides)) for node, sides in around.items() if node >= corners}
        nodes = int(counts[proxy_kernel.NODES])
        x, y, snap = work.x[:nodes], work.y[:nodes], work.sizes[proxy_kernel.SNAP]
        width, height = work.sizes[proxy_kernel.WIDTH], work.sizes[proxy_kernel.HEIGHT]
        on = (x > snap) & (x < width - snap) & (y > snap) & (y < height - snap)
        self.on_sheet = on.tolist()
        self.x, self.y = x.tolist(), y.tolist()
        self.degree = work.degree[:nodes].tolist()
        ridges = work.ridge[: counts[proxy_kernel.RIDGES]]
        self.ridges = list(
            zip(
                work.tail[ridges].tolist(),
                work.head[ridges].tolist(),
                work.ridge_length[: len(ridges)].tolist(),
                work.face[ridges].tolist(),
                work.face[work.twin[ridges]].tolist(),
                strict=True,
            )
        )
        taken = int(counts[proxy_kernel.TAKEN])
        every = int(work.ints[proxy_kernel.NOTED])
        first = work.way_first[: every + 1].tolist()
        way = work.way[: first[-1] if every else 0].tolist()
        self.paths: list[tuple[int, int, Tie, bool]] = []  # start, end (-1 border), sides of the faces, whether taken
        for k in range(every):
            number = int(work.taken[k])
            stuck = number < 0
            start = int(work.tail[-1 - number]) if stuck else int(work.path_start[number])
            end = -1 if stuck else int(work.path_end[number])
            self.paths.append((start, end, tuple(way[first[k] : first[k + 1]]), k < taken))
        misses = int(counts[proxy_kernel.MISSES])
        self.misses = list(
            zip(
                work.miss[:misses].tolist(),
                work.miss_path[:misses].tolist(),
                work.miss_step[:misses].tolist(),
                work.miss_node[:misses].tolist(),
                strict=True,
            )
        )

    def ties(self) -> list[Tie]:
        """Return the sides of all nodes on the sheet that have four or more."""
        return [tie for node, tie in self.sides.items() if len(tie) > 3 and self.on_sheet[node]]

    def meetings(self) -> list[Meeting]:
        """Return the perpendiculars between two nodes that are folded."""
        return [
            Meeting(self.sides[start], way, self.sides[end])
            for start, end, way, taken in self.paths
            if taken and end >= self.corners and start >= self.corners
        ]
