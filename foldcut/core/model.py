"""The data that passes between the stages: frozen dataclasses around read-only numpy arrays.

A drawing becomes a ``Shape`` (package ``drawing``), which is laid on a ``Sheet`` by a ``Placement``. A method returns
a ``CreasePattern`` and its ``FoldedState``, and perhaps the ``Region`` of each molecule. All together are a
``FoldedPattern``, which exporters take. ``verify`` (package ``proof``) returns ``Finding``.

The types of the arrays are in ``core.arrays``. Lengths are in the drawing's own units until a shape is on its sheet,
and in mm from then on. Fields have the names that FOLD gives them, where it has one (FOLD specification 1.2).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from foldcut.core.arrays import Chars, Floats, Ints, Ragged, points_array


@dataclass(frozen=True, eq=False)
class Shape:
    """What the one cut cuts: closed loops, filled by the even-odd rule, or any planar graph of straight edges.

    ``loops`` are ``(n, 2)`` arrays without a repeated last point. All run counter-clockwise, no two cross or touch, and
    no three points in a row are collinear. ``parent[i]`` is the innermost loop around loop i, or -1.

    Of a graph, ``loops`` are the edges whose two sides go to opposite sides of the cut line. These loops may touch at
    corners (``touching``), and there may be none. ``lines``, ``(n, 2)`` each, are the edges whose two sides go to the
    same side of the cut line, so that the paper is folded along them; they meet each other and the loops in corners.
    """

    loops: tuple[Floats, ...]
    parent: tuple[int, ...]
    lines: tuple[Floats, ...] = ()
    touching: bool = False

    def depth(self, loop: int) -> int:
        """Return how many loops surround ``loop``: an even number for an outer boundary, an odd one for a hole."""
        around = self.parent[loop]
        return 0 if around < 0 else 1 + self.depth(around)

    @property
    def corner_count(self) -> int:
        """The number of corners of all loops and lines together."""
        return sum(len(line) for line in (*self.loops, *self.lines))

    @property
    def is_graph(self) -> bool:
        """Whether this is more than loops that lie apart."""
        return bool(self.lines) or self.touching

    @property
    def points(self) -> Floats:
        """The corners of all loops, and then those of all lines, ``(k, 2)``."""
        return np.concatenate([*self.loops, *self.lines])

    @property
    def strokes(self) -> tuple[Floats, ...]:
        """Where the cut goes, as lines ``(n, 2)``: the loops, which end where they begin, and the lines."""
        return (*(np.concatenate([loop, loop[:1]]) for loop in self.loops), *self.lines)

    @property
    def closed_strokes(self) -> tuple[Floats, ...]:
        """The same as closed polygons, for what draws only these: the loops, and each line there and back."""
        return (*self.loops, *(np.concatenate([line, line[-2:0:-1]]) for line in self.lines))

    def with_points(self, points: Floats) -> Shape:
        """Return the shape with its corners, in the order of ``points``, at other places ``(k, 2)``."""
        ends = np.cumsum([len(line) for line in (*self.loops, *self.lines)])[:-1]
        moved = tuple(points_array(part) for part in np.split(points, ends))
        return replace(self, loops=moved[: len(self.loops)], lines=moved[len(self.loops) :])


@dataclass(frozen=True)
class Sheet:
    """A rectangle of paper with its lower left corner at (0, 0); ``width`` and ``height`` in mm.

    ``either_way``: the user has not said whether it lies in portrait or in landscape, so either will do.
    """

    width: float
    height: float
    name: str = ""
    either_way: bool = field(default=False, compare=False)

    @property
    def corners(self) -> Floats:
        """The four corners, ``(4, 2)``, counter-clockwise from the lower left."""
        return points_array([(0, 0), (self.width, 0), (self.width, self.height), (0, self.height)])

    @property
    def diagonal(self) -> float:
        """The length of the diagonal, in mm. Tolerances are relative to it."""
        return float(np.hypot(self.width, self.height))

    def __str__(self) -> str:
        size = f"{self.width:g} x {self.height:g} mm"
        return f"{self.name} ({size})" if self.name else size


@dataclass(frozen=True, eq=False)
class Placement:
    """The similarity from the drawing's coordinates to the sheet's mm; it mirrors if the drawing's y axis points down.

    ``matrix`` is ``(2, 3)``: ``sheet = matrix[:, :2] @ drawing + matrix[:, 2]``.
    """

    matrix: Floats

    def apply(self, points: Floats) -> Floats:
        """Return ``points`` of the drawing, ``(n, 2)``, on the sheet."""
        return points_array(points @ self.matrix[:, :2].T + self.matrix[:, 2])

    def from_y_down(self) -> Placement:
        """Return the same placement for a drawing whose y axis points down."""
        return Placement(self.matrix * (1.0, -1.0, 1.0))

    @property
    def scale(self) -> float:
        """Millimetres per unit of the drawing."""
        return float(np.hypot(*self.matrix[:, 0]))


@dataclass(frozen=True, eq=False)
class CreasePattern:
    """A sheet that creases divide into faces, in FOLD's arrays.

    ``vertices_coords`` ``(v, 2)`` mm; ``edges_vertices`` ``(e, 2)``; ``edges_assignment`` ``(e,)`` of "B", "M", "V"
    (and, in foreign files, "F" and "U"); ``faces_vertices`` ragged, every face counter-clockwise.
    """

    vertices_coords: Floats
    edges_vertices: Ints
    edges_assignment: Chars
    faces_vertices: Ragged

    @property
    def crease_count(self) -> int:
        """The number of mountains and valleys."""
        return int(np.isin(self.edges_assignment, ("M", "V")).sum())


@dataclass(frozen=True, eq=False)
class FoldedState:
    """Where every vertex lands, and which face lies on which.

    ``vertices_coords`` ``(v, 2)`` mm: y is the height over the cut line, so that the cut runs along y = 0, and x is
    measured along it, away from the spine. ``layers`` ``(f,)``: the face numbers from bottom to top. Up is where the
    front of face 0 looks when folded; ``vertices_coords`` never turn face 0 over.
    """

    vertices_coords: Floats
    layers: Ints


@dataclass(frozen=True, eq=False)
class Region:
    """The place on the sheet of a molecule, or of a part of one that is folded inside it.

    ``outlines``: each ``(n, 2)`` mm; there are several if the sheet is first folded along an axis. ``parent``: the
    region that this one lies in or hangs on, as an index into the same list, or -1.
    """

    outlines: tuple[Floats, ...]
    parent: int


@dataclass(frozen=True, eq=False)
class FoldedPattern:
    """All that an exporter needs: the creases, how they fold, the sheet, the shape on it, and its name.

    ``first_folds``: straight lines across the whole sheet, each ``(2, 2)`` mm, to be folded away from you one after
    another before anything else; three or more go through one point and fold the sheet into a wedge
    (``pattern/first_folds.py``). ``regions``: where the molecules lie, as a tree, if that is known. ``drawn``: the
    loops of the drawing, ``(n, 2)`` mm on the sheet, if ``shape`` is another outline that was drawn near to them.
    ``moved_by``: by how many mm ``shape`` was moved from the drawing (see ``redraw.deviation``); None: nobody knows.
    """

    creases: CreasePattern
    folded: FoldedState
    sheet: Sheet
    shape: Shape
    placement: Placement
    title: str
    first_folds: tuple[Floats, ...] = ()
    regions: tuple[Region, ...] = ()
    drawn: tuple[Floats, ...] = ()
    moved_by: float | None = None


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong with a pattern.

    ``check`` names the invariant that is broken. ``place`` is a point of the sheet in mm, or None. ``size`` says by how
    much, in the unit that the message gives.
    """

    check: str
    message: str
    place: tuple[float, float] | None = None
    size: float = 0.0

    def __str__(self) -> str:
        at = f" at ({self.place[0]:.4g}, {self.place[1]:.4g})" if self.place else ""
        return f"{self.check}{at}: {self.message}"
