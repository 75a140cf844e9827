"""The data that passes between the stages: frozen dataclasses around read-only numpy arrays.

Points are ``(n, 2)`` float64, indices int32, -1 means none. Ragged lists are values with offsets.
Lengths are millimetres once a shape is on its sheet; before that they are the drawing's own units.
FOLD's field names are used where FOLD has one (FOLD specification 1.2).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from foldcut.core.arrays import Chars, Floats, Ints, Ragged, points_array


@dataclass(frozen=True, eq=False)
class Shape:
    """Closed loops with even-odd filling: what the one cut cuts out.

    ``loops`` are ``(n, 2)`` arrays without a repeated last point, all counter-clockwise, no two of which
    cross or touch, without three collinear points in a row. ``parent[i]`` is the loop right around loop i, or -1.
    """

    loops: tuple[Floats, ...]
    parent: tuple[int, ...]

    def depth(self, loop: int) -> int:
        """Return how many loops lie around ``loop``: even = an outer boundary, odd = a hole."""
        around = self.parent[loop]
        return 0 if around < 0 else 1 + self.depth(around)

    @property
    def corner_count(self) -> int:
        """The number of corners of all loops together."""
        return sum(len(loop) for loop in self.loops)


@dataclass(frozen=True)
class Sheet:
    """A rectangle of paper with its lower left corner at (0, 0); ``width`` and ``height`` in mm.

    ``either_way``: it may be turned a quarter, nobody has said how it lies.
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
        """The length of the diagonal, in mm: the scale that tolerances are relative to."""
        return float(np.hypot(self.width, self.height))

    def __str__(self) -> str:
        size = f"{self.width:g} x {self.height:g} mm"
        return f"{self.name} ({size})" if self.name else size


@dataclass(frozen=True, eq=False)
class Placement:
    """The similarity, or with a y axis that points down its mirror image, from the drawing's to the sheet's mm.

    ``matrix`` is ``(2, 3)``: ``sheet = matrix[:, :2] @ drawing + matrix[:, 2]``.
    """

    matrix: Floats

    def apply(self, points: Floats) -> Floats:
        """Return ``points``, ``(n, 2)``, moved to the sheet."""
        return points_array(points @ self.matrix[:, :2].T + self.matrix[:, 2])

    def from_y_down(self) -> Placement:
        """Return the same for a drawing whose y axis points down."""
        return Placement(self.matrix * (1.0, -1.0, 1.0))

    @property
    def scale(self) -> float:
        """Millimetres per unit of the drawing."""
        return float(np.hypot(*self.matrix[:, 0]))


@dataclass(frozen=True, eq=False)
class CreasePattern:
    """A sheet divided into faces by its creases: FOLD's arrays.

    ``vertices_coords`` ``(v, 2)`` mm; ``edges_vertices`` ``(e, 2)``; ``edges_assignment`` ``(e,)`` of "B", "M", "V"
    (and, in foreign files, "F" and "U"); ``faces_vertices`` ragged, every face counter-clockwise.
    """

    vertices_coords: Floats
    edges_vertices: Ints
    edges_assignment: Chars
    faces_vertices: Ragged

    @property
    def crease_count(self) -> int:
        """The number of mountain and valley edges."""
        return int(np.isin(self.edges_assignment, ("M", "V")).sum())


@dataclass(frozen=True, eq=False)
class FoldedState:
    """Where every vertex lands, and which face lies on which.

    ``vertices_coords`` ``(v, 2)`` mm: x along the cut line away from the spine, y the height over the cut line, so
    the cut is along y = 0. ``layers`` ``(f,)``: the face numbers from bottom to top, up being the normal of face 0
    in its folded place (faces counter-clockwise on the sheet; face 0 is not turned over by ``vertices_coords``).
    """

    vertices_coords: Floats
    layers: Ints


@dataclass(frozen=True, eq=False)
class Region:
    """A molecule, or a part of one that is folded inside it, and where it is on the sheet.

    ``outlines``: each ``(n, 2)`` mm; several where the sheet is folded along an axis first. ``parent``: the number of
    the region that it is in or hangs on, in the list that it is part of, or -1.
    """

    outlines: tuple[Floats, ...]
    parent: int


@dataclass(frozen=True, eq=False)
class FoldedPattern:
    """All that an exporter needs: the creases, how they fold, the sheet, the shape on it, and its name.

    ``first_folds``: straight lines across all of the sheet, each ``(2, 2)`` mm, that are folded away from you in turn
    before all else. ``regions``: how the molecules hang together, if it is known.
    """

    creases: CreasePattern
    folded: FoldedState
    sheet: Sheet
    shape: Shape
    placement: Placement
    title: str
    first_folds: tuple[Floats, ...] = ()
    regions: tuple[Region, ...] = ()


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong with a pattern.

    ``check`` names the invariant; ``place`` is a point of the sheet in mm, or None; ``size`` how far off it is, in
    the unit the message gives.
    """

    check: str
    message: str
    place: tuple[float, float] | None = None
    size: float = 0.0

    def __str__(self) -> str:
        at = f" at ({self.place[0]:.4g}, {self.place[1]:.4g})" if self.place else ""
        return f"{self.check}{at}: {self.message}"
