"""The data that passes between the stages: frozen dataclasses around read-only numpy arrays.

Points are ``(n, 2)`` float64, indices int32, -1 means none. Ragged lists are values with offsets.
Lengths are millimetres once a shape is on its sheet; before that they are the drawing's own units.
FOLD's field names are used where FOLD has one (FOLD specification 1.2).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Numbers = NDArray[np.signedinteger[Any]]
Bools = NDArray[np.bool_]
Chars = NDArray[np.str_]
Bytes = NDArray[np.int8]
Scalar = TypeVar("Scalar", bound=np.generic)

# So many rows are done at a time where results are large and what leads to them is larger.
BLOCK = 1 << 13


def points_array(points: ArrayLike) -> Floats:
    """Return ``points`` as a read-only ``(n, 2)`` float64 array of its own."""
    array = np.array(points, dtype=np.float64)
    array.setflags(write=False)
    return array.reshape(-1, 2)


def sealed(array: NDArray[Scalar]) -> NDArray[Scalar]:
    """Return the very same array, read-only from now on: for an array that nobody else has."""
    array.setflags(write=False)
    return array


def index_array(indices: ArrayLike) -> Ints:
    """Return ``indices`` as a read-only int32 array of its own."""
    array = np.array(indices, dtype=np.int32)
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)
class Ragged:
    """A list of integer lists of different lengths, as values and offsets.

    ``values`` is ``(m,)`` int32, ``offsets`` ``(n + 1,)`` int32; row i is ``values[offsets[i]:offsets[i + 1]]``.
    """

    values: Ints
    offsets: Ints

    @classmethod
    def from_rows(cls, rows: Iterable[Iterable[int]]) -> Ragged:
        """Build from any iterable of iterables of integers."""
        lists = [list(row) for row in rows]
        offsets = np.zeros(len(lists) + 1, dtype=np.int32)
        np.cumsum([len(row) for row in lists], out=offsets[1:])
        flat = [value for row in lists for value in row]
        return cls(index_array(flat), index_array(offsets))

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def __getitem__(self, row: int) -> Ints:
        if not 0 <= row < len(self):
            raise IndexError(row)
        return self.values[self.offsets[row] : self.offsets[row + 1]]

    def __iter__(self) -> Iterator[Ints]:
        for start, end in pairwise(self.offsets):
            yield self.values[start:end]

    def to_lists(self) -> list[list[int]]:
        """Return plain Python lists, for loops and for JSON."""
        flat = self.values.tolist()
        ends = self.offsets.tolist()
        return [flat[start:end] for start, end in pairwise(ends)]

    def take(self, rows: Numbers) -> Ragged:
        """Return these rows, ``(k,)``, in this order."""
        offsets = np.zeros(len(rows) + 1, dtype=np.int32)
        np.cumsum(self.lengths[rows], out=offsets[1:])
        values = np.empty(offsets[-1], dtype=np.int32)
        for low in range(0, len(rows), BLOCK):
            ends = offsets[low : low + BLOCK + 1]
            back = self.offsets[:-1][rows[low : low + BLOCK]] - ends[:-1]
            places = np.arange(ends[0], ends[-1]) + np.repeat(back, np.diff(ends))
            values[ends[0] : ends[-1]] = self.values[places]
        return Ragged(sealed(values), sealed(offsets))

    @property
    def lengths(self) -> Ints:
        """The length of every row, ``(n,)``."""
        return np.diff(self.offsets)

    @property
    def following(self) -> Numbers:
        """For every value the place of the next one in its row, after the last the first, ``(m,)``; no row is empty."""
        following = np.arange(1, len(self.values) + 1)
        following[self.offsets[1:] - 1] = self.offsets[:-1]
        return following

    @property
    def rows(self) -> Ints:
        """The row number of every value, ``(m,)``."""
        return np.repeat(np.arange(len(self), dtype=np.int32), self.lengths)


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
