"""Pictures of the disk method's construction: disks and gaps, single molecules, trees, matching, ribbon.

Input: what the stages of the method made; output: a ``Panel`` for each of ``CONSTRUCTION``. They show what Figures 1 to
5 and 7 of the paper show, for any shape. A *starfish* is a folded molecule, seen in space: flaps around a spine.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, Ints
from foldcut.core.errors import BadInputError
from foldcut.geometry.vectors import left_normal
from foldcut.methods.disks.molecules import Kind, Molecules
from foldcut.profiles import LineStyle

from .panels import BOLD, EDGE, EDGE_COLOUR, PANEL_MM, Item, Key, Label, Panel, faces, fine, mountain, valley

if TYPE_CHECKING:
    from foldcut.methods.disks.method import DiskStages

OFF_MM = 0.02
"""How far a circle may be, on a panel, from the polygon that it is drawn as."""


def _circle(radius_mm: float) -> Floats:
    """Return a circle of radius 1 as a closed polygon, fine enough for this radius on a panel."""
    count = max(12, math.ceil(math.pi * math.sqrt(radius_mm / (2 * OFF_MM))))
    angle = np.linspace(0, 2 * math.pi, count + 1)
    circle: Floats = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    circle[-1] = circle[0]
    return circle


DOT = _circle(2.0)
"""A circle of radius 1, fine enough for a dot."""

THREE = "#dcebdc"
"""The colour of gaps with three sides."""

FOUR = "#f6d9c9"
"""The colour of gaps with four sides, and of gussets."""

PLAIN = "#ffffff"
"""The colour of faces that nothing sets apart."""

STRIP = "#ffe08a"
"""The colour of the ribbon."""

SEA = "#e8eef5"
"""The colour of the plane on which a starfish stands."""

ARMS = ("#ffe9b0", "#f3cf7a")
"""The colours of a starfish's flaps, in turn."""

RED = "#b3001b"
"""The colour of bisectors and gussets, and of creases across the ribbon."""

BLUE = "#0b4f9e"
"""The colour of tangency edges and of the tree of molecules."""

GREEN = "#117733"
"""The colour of the diagonals of gussets and of inset quadrilaterals."""

GREY = "#888888"
"""The colour of disks that fill gaps."""

SIDE = "#666666"
"""The colour of the sides of molecules."""

OUTLINE = "#c00000"
"""The colour of the shape's outline over disks."""

DISK = "#1b5e9e"
"""The colour of disks on the boundary."""

TANGENT = "#e08a4a"
"""The colour of circles through tangency points."""

TREE = "#c00000"
"""The colour of the tree of corners."""

MARKED = 0.25
"""The least width of the lines that the trees reverse, in mm on the panel."""

AROUND = math.radians(-35)
"""How far the viewer of a starfish is turned about its spine."""

TILT = math.radians(28)
"""How far above the horizon the viewer of a starfish is."""


def packing(stages: DiskStages, look: LineStyle) -> Panel:
    """Draw the disks, the gaps between them, and circles through the tangency points: paper section 2, Figure 1."""
    made = stages.packing
    gaps = [(made.centres[gap], made.radii[gap]) for gap in made.gaps]
    sheet = shapely.box(*made.centres.min(axis=0), *made.centres.max(axis=0))
    disks = [_arcs(centre, radius, sheet) for centre, radius in zip(made.centres, made.radii, strict=True)]
    count = made.boundary_count
    first, filling = ([arc for arcs in some for arc in arcs] for some in (disks[:count], disks[count:]))
    size = _extent(made.centres)
    width = fine(_segments([*first, *filling]), size)
    tangent = []
    for centres, radii in gaps:
        if len(centres) == 4:
            middle, radius = _circle_of_tangency(centres, radii)
            tangent += _arcs(middle, radius, sheet)
    items = [
        *(faces([centres], THREE if len(centres) == 3 else FOUR) for centres, _ in gaps),
        Item(tangent, stroke=TANGENT, width=0.5 * width),
        Item(filling, stroke=GREY, width=width),
        Item(first, stroke=DISK, width=width),
        Item(_loops(stages), stroke=OUTLINE, width=1.5 * width),
    ]
    keys = [
        Key("disks on the boundary", stroke=DISK),
        Key("disks that fill gaps", stroke=GREY),
        Key("the shape", stroke=OUTLINE, width=BOLD),
        Key("gap with three sides", fill=THREE),
        Key("with four", fill=FOUR),
        Key("and the circle of its tangency points", stroke=TANGENT),
    ]
    return Panel([item for item in items if item.lines], keys)


def _extent(points: Floats) -> float:
    return float(np.ptp(points, axis=0).max())


def _segments(lines: Sequence[Floats]) -> Floats:
    """Return a line for each polyline, ``(n, 2, 2)``: the diagonal of its bounding box."""
    return np.array([[line.min(axis=0), line.max(axis=0)] for line in lines]).reshape(-1, 2, 2)


def _arcs(centre: Floats, radius: float, area: shapely.Polygon) -> list[Floats]:
    """Return the parts of a circle that lie in an area; a single polyline if they are connected."""
    x, y, to_x, to_y = area.bounds
    circle = centre + radius * _circle(radius * PANEL_MM / max(to_x - x, to_y - y))
    arcs = shapely.intersection(shapely.LineString(circle), area.buffer(1e-9 * radius))
    if isinstance(arcs, shapely.MultiLineString):
        arcs = shapely.line_merge(arcs)
    return [shapely.get_coordinates(arc) for arc in shapely.get_parts(arcs) if isinstance(arc, shapely.LineString)]


def _circle_of_tangency(centres: Floats, radii: Floats) -> tuple[Floats, float]:
    """Return the circle through the tangency points of disks that touch in a cycle."""
    following = np.roll(centres, -1, axis=0)
    points = centres + (following - centres) * (radii / (radii + np.roll(radii, -1)))[:, None]
    equations = np.hstack([2 * points, np.ones((len(points), 1))])
    solved = np.linalg.lstsq(equations, (points**2).sum(axis=1), rcond=None)[0]
    middle: Floats = solved[:2]
    return middle, math.dist(middle, points[0])


def _loops(stages: DiskStages) -> list[Floats]:
    """Return the loops of the shape: halfway between the disks of each node on either side of the ribbon."""
    made = stages.packing
    on_loop = made.node >= 0
    count = np.bincount(made.node[on_loop])
    sums = [np.bincount(made.node[on_loop], weights=made.centres[on_loop, axis]) for axis in (0, 1)]
    centre = np.stack(sums, axis=1) / np.maximum(count, 1)[:, None]
    return [centre[[*loop, loop[0]]] for loop in made.loop_nodes.to_lists()[1:]]


def molecules(stages: DiskStages, look: LineStyle) -> Panel:
    """Draw all molecules with their bisectors, tangency edges and gussets: paper section 3."""
    made = stages.molecules
    lines = made.vertices[made.creases]
    width = fine(lines[made.crease_kind == Kind.TANGENCY], _extent(made.vertices))
    kinds = (
        (Kind.SIDE, SIDE, "sides"),
        (Kind.BISECTOR, RED, "bisectors and gussets"),
        (Kind.TANGENCY, BLUE, "tangency edges"),
        (Kind.DIAGONAL, GREEN, "diagonals of gussets"),
    )
    gaps = [faces([made.vertices[row]], THREE if len(row) == 3 else FOUR) for row in made.corners]
    drawn = [Item(list(lines[made.crease_kind == kind]), stroke=colour, width=width) for kind, colour, _ in kinds]
    keys = [Key(text, stroke=colour) for _, colour, text in kinds]
    return Panel([*gaps, *(item for item in drawn if item.lines)], keys)


class _Molecule:
    """The molecule with this many sides that is best to draw: its creases and corners.

    That is the one whose shortest crease is longest; inside the shape, lengths count ten times.
    """

    def __init__(self, stages: DiskStages, sides: int) -> None:
        made = stages.molecules
        best: tuple[float, int, Ints] | None = None
        inside = list(stages.packing.face_inside)
        for number, row in enumerate(made.corners):
            mine = np.flatnonzero(made.facet_molecule == number).tolist() if len(row) == sides else []
            if len(mine) != (2 * sides if sides == 3 else 12):  # a gusset without a diagonal is no gusset
                continue
            pairs = np.unique(np.sort(np.concatenate([_sides(made.facets[f]) for f in mine]), axis=1), axis=0)
            lengths = np.hypot(*(made.vertices[pairs[:, 1]] - made.vertices[pairs[:, 0]]).T)
            good = float(lengths.min()) * (10 if inside[int(made.face[number])] else 1)
            if best is None or good > best[0]:
                best = good, number, pairs
        if best is None:
            raise BadInputError(f"there is no molecule with {sides} sides to draw; take another shape or sheet")
        _, self.number, self.pairs = best
        self.made, self.stages = made, stages
        self.corners = made.vertices[made.corners[self.number]]
        kinds = {
            frozenset(pair): kind for pair, kind in zip(made.creases.tolist(), made.crease_kind.tolist(), strict=True)
        }
        self.kinds = [Kind(kinds[frozenset(pair)]) for pair in self.pairs.tolist()]
        feet = made.vertices[made.feet[self.number]]
        self.radii = np.hypot(*(feet - self.corners).T)

    def lines(self, *kinds: Kind) -> list[Floats]:
        """Return the creases of these kinds, ``(2, 2)`` each."""
        return [self.made.vertices[p] for p, kind in zip(self.pairs, self.kinds, strict=True) if kind in kinds]

    def flat(self, look: LineStyle, fill: str) -> list[Item]:
        """Return the molecule unfolded: bisectors are mountains, all other creases valleys."""
        polygon = shapely.Polygon(self.corners)
        arcs = [
            arc
            for centre, radius in zip(self.corners, self.radii, strict=True)
            for arc in _arcs(centre, radius, polygon)
        ]
        items = [
            faces([self.corners], fill),
            Item(arcs, stroke=GREY, width=EDGE),
            Item(self.lines(Kind.BISECTOR), stroke=look.mountain_colour, dash=mountain(look)),
            Item(self.lines(Kind.TANGENCY), stroke=look.valley_colour, dash=valley(look)),
            Item(self.lines(Kind.DIAGONAL), stroke=GREEN, dash=valley(look)),
        ]
        return [item for item in items if item.lines]

    def starfish(self) -> list[Item]:
        """Return the molecule folded, to the right of the unfolded one: flaps around the spine, standing on a plane."""
        made = self.made
        mine = np.flatnonzero(made.facet_molecule == self.number).tolist()
        away = self.corners - made.vertices[made.feet[self.number]].mean(axis=0)
        angle = np.arctan2(away[:, 1], away[:, 0]) + AROUND
        flaps: list[tuple[float, int, Floats]] = []
        reach = 1.12 * float(np.abs(made.folded[made.corners[self.number]][:, 0]).max())
        right, (low, high) = self.corners[:, 0].max(), (self.corners[:, 1].min(), self.corners[:, 1].max())
        at = np.array([right + 1.1 * reach, low + 0.35 * (high - low)])
        ground = float(np.abs(made.folded[made.feet[self.number]][:, 1]).min())
        for facet in mine:
            corner = int(made.facet_corner[facet])
            x, z = np.abs(made.folded[made.facets[facet]]).T
            z = z - ground
            across, depth = x * math.cos(angle[corner]), x * math.sin(angle[corner])
            flaps.append(
                (
                    math.sin(angle[corner]),
                    corner,
                    np.stack([across, z * math.cos(TILT) + depth * math.sin(TILT)], axis=1),
                )
            )
        sea = Item([at + reach * _circle(PANEL_MM) * (1, math.sin(TILT))], fill=SEA, closed=True)
        flaps.sort(key=lambda flap: -flap[0])
        return [sea, *(faces([at + outline], ARMS[corner % 2]) for _, corner, outline in flaps)]


def _sides(outline: Ints) -> Ints:
    return np.column_stack([outline, np.roll(outline, -1)])


def _keys(look: LineStyle) -> list[Key]:
    return [
        Key("mountain", stroke=look.mountain_colour, dash=mountain(look)),
        Key("valley", stroke=look.valley_colour, dash=valley(look)),
    ]


def rabbit_ear(stages: DiskStages, look: LineStyle) -> Panel:
    """Draw the largest rabbit ear, flat and as a starfish of three arms: paper section 3, Figure 2."""
    ear = _Molecule(stages, 3)
    items = [*ear.flat(look, THREE), *ear.starfish()]
    return Panel(items, [*_keys(look), Key("disks", stroke=GREY), Key("the plane of the paper", fill=SEA)])


class _Gusset(_Molecule):
    """A gusset molecule, with its points named as in the paper."""

    def __init__(self, stages: DiskStages) -> None:
        super().__init__(stages, 4)
        vertices = self.made.vertices
        diagonal = [set(p.tolist()) for p, kind in zip(self.pairs, self.kinds, strict=True) if kind is Kind.DIAGONAL]
        (middle,) = diagonal[0] & diagonal[1]
        ends = [next(iter(half - {middle})) for half in diagonal]
        centres = [
            next(iter(set(p.tolist()) - {middle}))
            for p, kind in zip(self.pairs, self.kinds, strict=True)
            if kind is Kind.TANGENCY and middle in p
        ]
        row = self.made.corners[self.number].tolist()
        bisectors = [p.tolist() for p, k in zip(self.pairs, self.kinds, strict=True) if k is Kind.BISECTOR]

        def over(end: int) -> int:
            return next(corner for pair in bisectors if end in pair for corner in range(4) if row[corner] in pair)

        self.first = over(ends[0])  # a: the diagonal runs from p, on the bisector of a, to r, on that of c
        opposite = (self.first + 1) % 4
        if over(centres[0]) != opposite:
            centres.reverse()
        self.order = [(self.first + k) % 4 for k in range(4)]
        self.p, self.r, self.u, self.v, self.m = (vertices[k] for k in (*ends, *centres, middle))
        self.diamond = np.array([self.p, self.u, self.r, self.v])

    def inset(self) -> Floats:
        """Return the inset quadrilateral p q r s, ``(4, 2)``: the sides of a b c d moved inwards until they meet p."""
        a, b = self.corners[self.order[0]], self.corners[self.order[1]]
        along = (b - a) / math.dist(a, b)
        height = float((self.p - a) @ left_normal(along))
        outline = self.corners[self.order]
        moved = []
        for k in range(4):
            before, here, after = outline[k - 1], outline[k], outline[(k + 1) % 4]
            one, two = (here - before) / math.dist(here, before), (after - here) / math.dist(after, here)
            normals = np.stack([left_normal(one), left_normal(two)])
            moved.append(np.linalg.solve(normals, normals @ here + height))
        return np.array(moved)


def _dot(at: Floats, size: float) -> Item:
    return Item([at + 0.012 * size * DOT], fill="#1a1a1a", closed=True)


def gusset(stages: DiskStages, look: LineStyle) -> Panel:
    """Draw the largest gusset molecule, flat and as a starfish of four arms: paper section 3, Figure 3."""
    made = _Gusset(stages)
    sheet, *lines = made.flat(look, PLAIN)
    shaded = Item([made.diamond], fill=FOUR, closed=True)
    size = _extent(made.corners)
    star = made.starfish()
    dots = [_dot(point, size) for point in (made.u, made.v)]
    keys = [
        *_keys(look),
        Key("the gusset's diagonal, a valley", stroke=GREEN, dash=valley(look)),
        Key("the gusset", fill=FOUR),
        Key("dots: the perpendicular points"),
        Key("the plane of the paper", fill=SEA),
    ]
    return Panel([sheet, shaded, *lines, *dots, *star], keys)


def inset(stages: DiskStages, look: LineStyle) -> Panel:
    """Draw the inset quadrilateral and the two rabbit ears that it is folded as: paper section 3, Figure 4."""
    made = _Gusset(stages)
    outline, inner = made.corners[made.order], made.inset()
    size = _extent(outline)
    low, extent = inner.min(axis=0), np.ptp(inner, axis=0)
    scale = 0.9 * size / float(extent.max())
    at = np.array([outline[:, 0].max() + 0.22 * size, outline[:, 1].mean() - scale * extent[1] / 2])

    def larger(points: Floats) -> Floats:
        moved: Floats = (points - low) * scale + at
        return moved

    p, q, r, s = inner
    ears = [
        [np.array(pair) for pair in ((p, made.u), (q, made.u), (r, made.u), (p, made.v), (s, made.v), (r, made.v))],
        [np.array([made.u, _foot(made.u, *side)]) for side in ((p, q), (q, r), (p, r))]
        + [np.array([made.v, _foot(made.v, *side)]) for side in ((r, s), (s, p))]
        + [np.array([made.v, _foot(made.v, p, r)])],
    ]
    across = np.array([p, r])
    items = [
        faces([outline], PLAIN),
        Item([made.diamond], fill=FOUR, closed=True),
        Item(
            [np.stack([corner, point]) for corner, point in zip(outline, inner, strict=True)], stroke=GREY, width=EDGE
        ),
        Item([np.vstack([inner, inner[:1]]), across], stroke=GREEN),
        *(_dot(point, size) for point in (made.u, made.v, p, r)),
        faces([larger(inner)], PLAIN),
        Item([larger(line) for line in ears[0]], stroke=look.mountain_colour, dash=mountain(look)),
        Item([larger(line) for line in ears[1]], stroke=look.valley_colour, dash=valley(look)),
        Item([larger(across)], stroke=GREEN, dash=valley(look)),
    ]
    labels = []
    for points, names, moved, away in (
        (outline, "abcd", None, 0.9),
        (inner, "pqrs", larger, 0.9),
        (inner, "pqrs", None, -1.1),
    ):
        middle = points.mean(axis=0)
        for point, name in zip(points, names, strict=True):
            out = away * (point - middle) / math.dist(point, middle)
            labels.append(Label(name, moved(point) if moved else point, (float(out[0]), float(out[1]))))
    labels += [
        Label(name, point, (0.0, 1.0 if point[1] > inner[:, 1].mean() else -1.1))
        for name, point in (("u", made.u), ("v", made.v))
    ]
    keys = [
        Key("inset quadrilateral and its diagonal", stroke=GREEN),
        Key("the gusset", fill=FOUR),
        *_keys(look),
        Key("left: dots are the perpendicular points, and p and r"),
        Key("right: the inset quadrilateral, larger, and its two rabbit ears"),
    ]
    return Panel(items, keys, labels)


def _foot(point: Floats, start: Floats, end: Floats) -> Floats:
    along = (end - start) / math.dist(start, end)
    foot: Floats = start + along * float((point - start) @ along)
    return foot


def _middles(made: Molecules) -> Floats:
    return np.array([made.vertices[row].mean(axis=0) for row in made.feet])


def trees(stages: DiskStages, look: LineStyle) -> Panel:
    """Draw T_C, the tree of corners, and T_M, the tree of molecules: paper section 4, Figure 5(a)."""
    made, assignment = stages.molecules, stages.assignment
    gaps = faces([made.vertices[row] for row in made.corners], PLAIN)
    middles = _middles(made)
    children = np.flatnonzero(assignment.parent >= 0)
    of_molecules = np.stack([middles[children], middles[assignment.parent[children]]], axis=1)
    feet = set(assignment.corner_tree[:, 1].tolist())
    sides = made.creases[made.crease_kind == Kind.SIDE]
    halves = np.array([side for side in sides.tolist() if feet & set(side)], dtype=int).reshape(-1, 2)
    size = _extent(made.vertices)
    width = 1.5 * fine(of_molecules, size)
    items = [
        gaps,
        Item(list(made.vertices[halves]), stroke=TREE, width=2 * width),
        Item(list(of_molecules), stroke=BLUE, width=width),
        *(Item([middles[root] + 0.008 * size * DOT], fill=BLUE, closed=True) for root in assignment.roots),
        Item(_loops(stages), stroke="#1a1a1a", width=width),
    ]
    keys = [
        Key("tree of corners", stroke=TREE, width=BOLD),
        Key("tree of molecules", stroke=BLUE),
        Key("dots: its roots"),
        Key("the shape", stroke="#1a1a1a"),
    ]
    return Panel([item for item in items if item.lines], keys)


def matching(stages: DiskStages, look: LineStyle) -> Panel:
    """Draw the edges that the trees reverse, which makes them mountains: paper section 4, Figure 5(b)."""
    made, kinds = stages.molecules, stages.assignment.crease_assignment
    lines = made.vertices[made.creases]
    of_trees = np.isin(made.crease_kind, (Kind.SIDE, Kind.TANGENCY))
    width = fine(lines[of_trees], _extent(made.vertices))
    bold = max(2 * width, MARKED)

    def some(which: Bools) -> list[Floats]:
        return list(lines[which])

    items = [
        Item([made.vertices[row] for row in made.corners], PLAIN, EDGE_COLOUR, width / 2, closed=True),
        Item(some(of_trees & (kinds == "V")), stroke="#9db8d6", width=width),
        Item(some((made.crease_kind == Kind.SIDE) & (kinds == "M")), stroke=TREE, width=bold),
        Item(some((made.crease_kind == Kind.TANGENCY) & (kinds == "M")), stroke=BLUE, width=bold),
        Item(_loops(stages), stroke="#1a1a1a", width=width),
    ]
    keys = [
        Key("reversed: from a corner to its parent", stroke=TREE, width=BOLD),
        Key("from a molecule to its parent", stroke=BLUE, width=BOLD),
        Key("other sides and tangency edges: valleys", stroke="#9db8d6"),
        Key("the shape", stroke="#1a1a1a"),
    ]
    return Panel([item for item in items if item.lines], keys)


def ribbon(stages: DiskStages, look: LineStyle) -> Panel:
    """Draw the strip along the boundary without creases along it: paper section 5, Figure 7."""
    made = stages.molecules
    strip = [
        made.vertices[row] for row, owner in zip(made.facets, made.facet_molecule.tolist(), strict=True) if owner < 0
    ]
    across = made.vertices[made.creases[made.crease_kind == Kind.RIBBON]]
    items = [
        faces([made.vertices[row] for row in made.corners], PLAIN),
        faces(strip, STRIP),
        Item(list(across), stroke=RED, width=fine(across, _extent(made.vertices))),
        Item(_loops(stages), stroke="#1a1a1a"),
    ]
    keys = [
        Key("the ribbon", fill=STRIP),
        Key("creases across it", stroke=RED),
        Key("the cut", stroke="#1a1a1a"),
    ]
    return Panel([item for item in items if item.lines], keys)


CONSTRUCTION: dict[str, Callable[[DiskStages, LineStyle], Panel]] = {
    "packing": packing,
    "molecules": molecules,
    "rabbit-ear": rabbit_ear,
    "gusset": gusset,
    "inset": inset,
    "trees": trees,
    "matching": matching,
    "ribbon": ribbon,
}
"""The pictures of the construction, by name."""
