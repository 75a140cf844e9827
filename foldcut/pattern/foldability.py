"""How hard a pattern is to fold by hand and to cut: counts, lengths, angles, layers, and what would help.

``FoldedPattern`` -> ``Foldability``. Nothing is decided here: a pattern with warnings still folds flat.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Floats, Indices, Ints, Ragged
from foldcut.core.model import CreasePattern, FoldedPattern, FoldedState, Shape, Sheet
from foldcut.geometry.planar_graph import half_edges
from foldcut.pattern.face_maps import folded_edges
from foldcut.pattern.first_folds import is_wedge

__all__ = [
    "COMFORTABLE_CREASE_MM",
    "COMFORTABLE_LAYERS",
    "PAPER_MM",
    "SCISSORS_LAYERS",
    "CreaseNumbers",
    "Foldability",
    "crease_numbers",
    "foldability",
    "layers_at_cut",
    "most_layers",
    "remedies",
]

PAPER_MM = 0.1
"""The thickness of office paper of 80 g/m2."""

COMFORTABLE_CREASE_MM = 3.0
"""Creases that are shorter than this are hard to fold by hand."""

COMFORTABLE_LAYERS = 30
"""Patterns of simple folds alone are not looked for further if the cut would go through more layers than this."""

SCISSORS_LAYERS = 16
"""Scissors give up at some 16 to 20 layers of office paper."""

LARGEST_FACTOR = 10.0
"""No sheet is proposed that is more than this many times as large as the present one."""

STRAIGHT = 1e-6
"""Two creases count as one line if the angle between them is less than this, in radians."""

ROUNDING = 1e-9
"""They also count as one line if the shorter one leaves it by less than this, relative to the sheet's diagonal."""

SIMPLER = "fold a simpler outline with --level easy"
"""What helps where the cut goes through too many layers."""
FEWER_AXES = "draw it with fewer mirror axes"
"""What helps where the sheet is a wedge of many layers before anything else is folded."""
FEWER_LINES = "draw fewer lines"
"""What helps where lines are cut along."""

HAIR = 1e-6
"""How far beside the cut line layers are counted, relative to the size of the folded sheet."""

MOST_LINES = 100
"""The number of lines across the folded sheet, in each direction, along which the thickest place is looked for."""


@dataclass(frozen=True)
class CreaseNumbers:
    """What can be counted and measured on the sheet; creases are mountains and valleys only.

    ``lines``: the number of creases if those that go straight on through a vertex count once, mountain or valley.
    ``shortest_crease_at`` is the middle of the shortest crease, in mm; it is None without creases. The smallest angle
    between creases is None if no two of them meet.
    """

    creases: int
    lines: int
    mountains: int
    valleys: int
    shortest_crease_mm: float | None
    shortest_crease_at: tuple[float, float] | None
    smallest_angle_deg: float | None


@dataclass(frozen=True)
class Foldability(CreaseNumbers):
    """How hard a pattern is to fold and to cut.

    ``layers`` and ``thickness_mm`` are those of the thickest place that was found (see ``most_layers``),
    ``layers_at_cut`` those of the thickest place on the cut line. ``sheet_used``: the share of the sheet that the shape
    takes, from 0 to 1. ``warnings`` say what is hard, and the remedy.
    """

    layers: int
    layers_at_cut: int
    thickness_mm: float
    sheet_used: float
    warnings: tuple[str, ...]


def foldability(pattern: FoldedPattern, paper_mm: float = PAPER_MM, method: str = "") -> Foldability:
    """Return how hard ``pattern`` is to fold and to cut, if the paper is ``paper_mm`` thick.

    ``method``: the name of a method that makes fewer creases, if there is one, for the warnings to suggest.
    """
    faces, folded = pattern.creases.faces_vertices, pattern.folded
    numbers = crease_numbers(pattern.creases)
    at_cut = layers_at_cut(faces, folded, beside=bool(pattern.shape.lines))
    layers = max(most_layers(faces, folded), at_cut)
    return Foldability(
        **vars(numbers),
        layers=layers,
        layers_at_cut=at_cut,
        thickness_mm=layers * paper_mm,
        sheet_used=_area(pattern.shape) / (pattern.sheet.width * pattern.sheet.height),
        warnings=_warnings(numbers, at_cut, at_cut * paper_mm, pattern, method),
    )


def crease_numbers(creases: CreasePattern) -> CreaseNumbers:
    """Return what can be counted and measured in a crease pattern."""
    edges = creases.edges_vertices[folded_edges(creases)]
    ends = creases.vertices_coords[edges]
    lengths = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    shortest = int(lengths.argmin()) if len(lengths) else None
    spokes = _Spokes(creases, edges)
    return CreaseNumbers(
        creases=len(edges),
        lines=spokes.line_count(),
        mountains=int((creases.edges_assignment == "M").sum()),
        valleys=int((creases.edges_assignment == "V").sum()),
        shortest_crease_mm=None if shortest is None else float(lengths[shortest]),
        shortest_crease_at=None if shortest is None else _point(ends[shortest].mean(axis=0)),
        smallest_angle_deg=spokes.smallest_angle(),
    )


def remedies(sheet: Sheet, factor: float, loops: int, method: str = "", *, simplify: bool = True) -> str:
    """Return a sentence on what would make the shortest crease ``factor`` times as long.

    ``loops`` is the number of loops in the drawing. ``method``: the name of a method to suggest, which makes fewer
    creases and has not been tried, if there is one. ``simplify``: corners of the drawing may be left out.
    """
    if not simplify:
        return "use a larger sheet with the drawing larger to match, or draw fewer lines"
    if factor > LARGEST_FACTOR:
        other = f"try --method {method} or a higher --effort" if method else "try a higher --effort"
        other = other if loops == 1 else "fold fewer loops at a time"
        return f"leave out small corners with --simplify, or {other}"
    factor = math.ceil(factor * 10 - 1e-9) / 10
    size = f"{math.ceil(sheet.width * factor)} x {math.ceil(sheet.height * factor)} mm"
    return (
        f"use a sheet {factor:.1f} times as large (about {size}) with the drawing larger to match, or leave out small "
        "corners with --simplify"
    )


def layers_at_cut(faces: Ragged, folded: FoldedState, *, beside: bool = False) -> int:
    """Return how many layers the cut goes through at the thickest place on the cut line, y = 0.

    Faces that only touch this line from above or below do not count, unless it is also looked a hair ``beside`` it:
    along lines of a graph, the paper is folded on the cut line.
    """
    lines = _Lines(faces, folded.vertices_coords)
    hair = HAIR * float(np.ptp(folded.vertices_coords, axis=0).max())
    return max(map(lines.layers, (0.0, hair, -hair) if beside else (0.0,)))


def most_layers(faces: Ragged, folded: FoldedState) -> int:
    """Return how many layers lie on each other at the thickest place that is found on the folded sheet.

    Layers are counted exactly along lines halfway between neighbouring coordinates of vertices, upright and level, but
    not along more than ``MOST_LINES`` of each. The result is a lower bound: a thicker place between these lines is
    missed.
    """
    most = 0
    for axis in (1, 0):
        lines = _Lines(faces, folded.vertices_coords[:, [1 - axis, axis]])
        places = np.unique(np.round(folded.vertices_coords[:, axis] / lines.tolerance)) * lines.tolerance
        levels = (places[1:] + places[:-1]) / 2
        if len(levels) > MOST_LINES:
            levels = levels[np.linspace(0, len(levels) - 1, MOST_LINES).round().astype(np.intp)]
        most = max([most, *map(lines.layers, levels.tolist())])
    return most


class _Lines:
    """Counts layers along lines of constant y through folded faces."""

    def __init__(self, faces: Ragged, coords: Floats) -> None:
        self.tolerance = 1e-9 * float(np.ptp(coords, axis=0).max())
        self.first, self.rows = faces.offsets[:-1], faces.rows
        start, end = half_edges(faces)
        self.x, self.y = coords[start].T
        self.to_x, self.to_y = coords[end].T

    def layers(self, level: float) -> int:
        """Return the layers at the thickest place along y = ``level``; faces that only touch it do not count."""
        y, to_y = (np.where(np.abs(side - level) < self.tolerance, 0.0, side - level) for side in (self.y, self.to_y))
        reaches_below = np.minimum.reduceat(y, self.first)[self.rows] < 0
        at = np.flatnonzero(((y > 0) != (to_y > 0)) & reaches_below)
        crossings = self.x[at] + (self.to_x[at] - self.x[at]) * y[at] / (y[at] - to_y[at])
        # Rounded, so that one face ends exactly where the next begins.
        place = np.round(crossings / self.tolerance)
        # A face is entered and left in turn along the line, and at one place faces end before others begin.
        place = place[np.lexsort((place, self.rows[at]))]
        step = np.tile([1, -1], len(place) // 2)
        return int(np.cumsum(step[np.lexsort((step, place))]).max(initial=0))


class _Spokes:
    """The creases as they leave their vertices: each crease twice, sorted by vertex and counter-clockwise around it."""

    def __init__(self, creases: CreasePattern, edges: Ints) -> None:
        count = len(edges)
        self.edge_count = count
        tail, head = np.concatenate([edges, edges[:, ::-1]]).T
        along = creases.vertices_coords[head] - creases.vertices_coords[tail]
        angle = np.arctan2(along[:, 1], along[:, 0])
        order = np.lexsort((angle, tail))
        self.edge = np.tile(np.arange(count), 2)[order]
        self.tail, self.angle, self.along = tail[order], angle[order], along[order]
        self.first = np.searchsorted(self.tail, self.tail)
        self.degree = np.searchsorted(self.tail, self.tail, side="right") - self.first
        self.error = ROUNDING * float(np.hypot(*np.ptp(creases.vertices_coords, axis=0)))

    def smallest_angle(self) -> float | None:
        """Return the smallest angle between neighbouring creases, in degrees."""
        shared = np.flatnonzero(self.degree > 1)
        if not len(shared):
            return None
        first, degree = self.first[shared], self.degree[shared]
        following = first + (shared - first + 1) % degree
        return float(np.degrees(((self.angle[following] - self.angle[shared]) % math.tau).min()))

    def line_count(self) -> int:
        """Return the number of creases when those that go straight on through a vertex count once."""
        opposite = self._opposite()
        going_on = np.flatnonzero(opposite >= 0)
        pairs = np.sort(np.stack([self.edge[going_on], self.edge[opposite[going_on]]], axis=1), axis=1)
        # Straight chains of edges do not close, so each pair joins two chains.
        return self.edge_count - len(np.unique(pairs, axis=0))

    def _opposite(self) -> Indices:
        """Return for each spoke the one that continues it straight on, or -1."""
        if not self.edge_count:
            return np.zeros(0, dtype=np.intp)
        # Angles are in (-pi, pi], so adding 8 times the vertex keeps those of different vertices apart.
        sought = self.angle + np.where(self.angle > 0, -math.pi, math.pi)
        after = np.searchsorted(self.tail * 8.0 + self.angle, self.tail * 8.0 + sought) - self.first
        best = np.full(len(self.edge), -1)
        least = np.full(len(self.edge), np.inf)
        reach = np.hypot(*self.along.T)
        for step in (-1, 0):  # the nearest angle comes just before or after the one sought
            other = self.first + (after + step) % self.degree
            across = np.abs(self.along[:, 0] * self.along[other, 1] - self.along[:, 1] * self.along[other, 0])
            shorter, longer = np.minimum(reach, reach[other]), np.maximum(reach, reach[other])
            straight = across <= np.maximum(STRAIGHT * shorter, self.error) * longer
            ahead = (self.along * self.along[other]).sum(axis=1) < 0
            better = straight & ahead & (across < least)
            best[better], least[better] = other[better], across[better]
        return best


def _area(shape: Shape) -> float:
    """Return the area of a shape: loops within an odd number of others are holes."""
    area = 0.0
    for number, loop in enumerate(shape.loops):
        x, y = (loop - loop[0]).T
        enclosed = abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2
        area += enclosed if shape.depth(number) % 2 == 0 else -enclosed
    return area


def thickness(mm: float) -> str:
    """Return a thickness as text, with three significant figures."""
    return f"{mm:.3g} mm" if mm < 999.5 else f"{mm:,.0f} mm"


def _warnings(
    numbers: CreaseNumbers, at_cut: int, cut_mm: float, pattern: FoldedPattern, method: str
) -> tuple[str, ...]:
    warnings = []
    shortest = numbers.shortest_crease_mm
    if shortest is not None and numbers.shortest_crease_at is not None and shortest < COMFORTABLE_CREASE_MM:
        x, y = numbers.shortest_crease_at
        factor, may_simplify = COMFORTABLE_CREASE_MM / max(shortest, 1e-6), not pattern.shape.is_graph
        remedy = remedies(pattern.sheet, factor, len(pattern.shape.loops), method, simplify=may_simplify)
        warnings.append(
            f"the shortest crease, at ({x:.4g}, {y:.4g}), is {shortest:.2g} mm long; creases under "
            f"{COMFORTABLE_CREASE_MM:g} mm are hard to fold by hand; {remedy}"
        )
    fewer = FEWER_LINES if pattern.shape.is_graph else FEWER_AXES if is_wedge(pattern.first_folds) else SIMPLER
    if cut_mm > SCISSORS_LAYERS * PAPER_MM * (1 + 1e-9):
        warnings.append(
            f"the cut goes through {at_cut} layers, about {thickness(cut_mm)} of paper; scissors give up at "
            f"{SCISSORS_LAYERS} to 20 layers of office paper; cut with a knife along a ruler, in several strokes, use "
            f"thinner paper, or {fewer}"
        )
    return tuple(warnings)


def _point(place: Floats) -> tuple[float, float]:
    return float(place[0]), float(place[1])
