"""How fast the vertices of a compact pattern move when the turns of its walk do.

``Molecules``, derivatives of the turns' places and images -> derivatives of all vertices' places.

Facets stay rigid, so a vertex lands where each of its facets takes it. A facet that begins at the border keeps to its
side of the shape and to the cut line. A facet that begins at a gusset crease begins level, and the middle of the crease
lands where the turn at which its path bends has come to. These equations are linear, and have one solution as long as
the events keep their order. Where several events share a vertex they have a solution only for directions that do not
part these events. How far a crease goes that ends beyond the sheet is left open.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Bools, Floats, Numbers
from foldcut.geometry.vectors import cross
from foldcut.methods.compact.molecule import Molecule
from foldcut.methods.compact.pattern import Molecules

SOFT = 1e-13
"""Added to the diagonal of the normal equations, which is zero for vertices of no facet."""

MOST_DENSE = 500
"""Up to this many unknowns, solving a full matrix takes less time than importing scipy's sparse matrices."""

Entries = tuple[Numbers, Numbers, Floats]


def vertex_slopes(molecules: Molecules, places: Floats, images: Floats) -> Floats:
    """Return the derivatives of the vertices' places on the sheet, ``(v, 2, m)``, by ``m`` directions.

    ``places`` ``(n, 2, m)``, ``images`` ``(n, m)``: the derivatives of the turns' places and images.
    """
    vertices = molecules.vertices
    whole = len(vertices.flat) - len(vertices.cuts)
    flat, folded = np.array(vertices.flat), np.array(vertices.folded)
    system = _System(flat[:whole], folded[:whole])
    for molecule in (molecules.inside, molecules.outside):
        system.add(molecule)
    known = np.concatenate([places, images[:, None], np.zeros_like(images)[:, None]], axis=1)
    slopes = np.zeros((len(flat), 2, images.shape[1]))
    slopes[:whole] = system.solve(known)
    for vertex, a, b, normal in vertices.cuts:
        edge = flat[b] - flat[a]
        across = edge @ normal
        part = ((flat[vertex] - flat[a]) @ normal) / across
        moved = slopes[a] + (slopes[b] - slopes[a]) * part
        slopes[vertex] = moved - edge[:, None] / across * (np.array(normal) @ moved)
    return slopes


@dataclass(frozen=True, eq=False)
class _Facets:
    """Facets as rigid motions from the sheet: ``linear`` ``(f, 2, 2)`` about ``centre`` to ``landing`` ``(f, 2)``."""

    linear: Floats
    centre: Floats
    landing: Floats


class _System:
    """The linear equations between derivatives.

    A vertex has four unknowns, in ``4 vertex + n``: its place x, y and where it lands, x, height. After those of all
    vertices, a facet has three: its rotation when folded, and where it lands, x, height. ``entries`` are rows, columns
    and values of the matrix.
    """

    def __init__(self, flat: Floats, folded: Floats) -> None:
        self.flat, self.folded = flat, folded
        self.width = 4 * len(flat)
        self.height = 0
        self.entries: list[Entries] = []

    def add(self, molecule: Molecule) -> None:
        """Add the equations of a molecule."""
        polygons = molecule.polygons()
        some = np.array([number for number, polygon in enumerate(polygons) if polygon])
        size = np.array([len(polygons[number]) for number in some])
        vertex = np.array([v for polygon in polygons for v in polygon])
        facet = np.repeat(np.arange(len(some)), size)
        facets = self._facets(vertex, size)
        first = self.width
        self.width += 3 * len(some)
        self._rigid(facets, facet, self.folded[vertex], 4 * vertex, first)
        border = first + 3 * np.flatnonzero(some < molecule.border_facets)
        self._equations(border[:, None], np.ones((len(border), 1)))  # does not turn
        self._equations(border[:, None] + 2, np.ones((len(border), 1)))  # does not leave the cut line
        base = [(f.start[0], f.end[0]) for f in molecule.facets[molecule.border_facets :]]
        level = 4 * np.array(base, dtype=np.int64).reshape(-1, 2) + 3
        self._equations(level, np.tile([1.0, -1.0], (len(level), 1)))
        number = np.full(len(polygons), -1)
        number[some] = np.arange(len(some))
        for middle in molecule.middles:
            if middle.level is not None:
                self._equations(np.array([[4 * middle.vertex + 2, 4 * middle.level + 2]]), np.array([[1.0, -1.0]]))
                continue
            # a point of the turn's trajectory that lands in the middle
            beside = number[[middle.before, middle.after]]
            beside = beside[beside >= 0]
            lands = self.folded[middle.vertex]
            point = np.full(len(beside), self.width)
            self.width += 2
            middles = np.full(len(beside), 4 * middle.vertex)
            self._rigid(facets, beside, np.tile(lands, (len(beside), 1)), middles, first, point)

    def _facets(self, vertex: Numbers, size: Numbers) -> _Facets:
        start = np.cumsum([0, *size[:-1]])

        def centred(points: Floats) -> tuple[Floats, Floats]:
            centre = np.add.reduceat(points, start) / size[:, None]
            return centre, points - centre.repeat(size, axis=0)

        centre, flat = centred(self.flat[vertex])
        landing, folded = centred(self.folded[vertex])

        def turned_over(points: Floats) -> Bools:
            after = np.arange(len(points)) + 1
            after[start + size - 1] = start
            return np.asarray(np.add.reduceat(cross(points, points[after]), start) < 0)

        over = turned_over(folded) != turned_over(flat)
        mirror = np.where(over, -1.0, 1.0)
        flat = flat * np.stack([np.ones(len(flat)), mirror.repeat(size)], axis=1)
        cosine = np.add.reduceat((flat * folded).sum(axis=1), start)
        sine = np.add.reduceat(cross(flat, folded), start)
        cosine, sine = np.stack([cosine, sine]) / np.hypot(cosine, sine)
        linear = np.stack(
            [np.stack([cosine, -sine * mirror], axis=1), np.stack([sine, cosine * mirror], axis=1)], axis=1
        )
        return _Facets(linear, centre, landing)

    def _rigid(
        self,
        facets: _Facets,
        facet: Numbers,
        lands: Floats,
        column: Numbers,
        first: int,
        point: Numbers | None = None,
    ) -> None:
        """Points land where their facets take them.

        ``facet`` ``(k,)``, with their unknowns from column ``first`` on; ``lands`` ``(k, 2)``: where the points land
        now; ``column`` ``(k,)``: the first unknown of the vertices that they land on, and ``point`` that of the points
        themselves if these are no vertices.
        """
        point = column if point is None else point
        from_centre = lands - facets.landing[facet]
        turning = np.stack([-from_centre[:, 1], from_centre[:, 0]], axis=1)
        for axis in (0, 1):
            columns = np.stack(
                [column + 2 + axis, point, point + 1, first + 3 * facet, first + 3 * facet + 1 + axis], axis=1
            )
            linear = facets.linear[facet, axis]
            ones = np.ones(len(facet))
            self._equations(columns, np.stack([ones, -linear[:, 0], -linear[:, 1], -turning[:, axis], -ones], axis=1))

    def _equations(self, columns: Numbers, values: Floats) -> None:
        rows = np.repeat(self.height + np.arange(len(columns)), columns.shape[1])
        self.entries.append((rows, columns.ravel(), values.ravel()))
        self.height += len(columns)

    def solve(self, known: Floats) -> Floats:
        """Return the derivatives of all vertices' places; ``known`` ``(n, 4, m)``: of the first n, all four."""
        rows, columns, values = (np.concatenate(part) for part in zip(*self.entries, strict=True))
        given = known.reshape(-1, known.shape[2])
        solve = solve_dense if self.width <= MOST_DENSE else solve_sparse
        found: Floats = solve((rows, columns, values), (self.height, self.width), given)
        return np.concatenate([given, found])[: 4 * len(self.flat)].reshape(len(self.flat), 4, -1)[:, :2]


def solve_dense(entries: Entries, shape: tuple[int, int], given: Floats) -> Floats:
    """Return the least squares solution for the columns after those ``given``, by a full matrix."""
    rows, columns, values = entries
    matrix = np.zeros(shape)
    np.add.at(matrix, (rows, columns), values)
    sought, right = matrix[:, len(given) :], -(matrix[:, : len(given)] @ given)
    normal = sought.T @ sought + SOFT * np.eye(sought.shape[1])
    found = np.linalg.solve(normal, sought.T @ right)
    better: Floats = found + np.linalg.solve(normal, sought.T @ (right - sought @ found))
    return better


def solve_sparse(entries: Entries, shape: tuple[int, int], given: Floats) -> Floats:
    """Return the same by sparse matrices."""
    from scipy import sparse
    from scipy.sparse.linalg import splu

    rows, columns, values = entries
    matrix = sparse.csc_matrix((values, (rows, columns)), shape=shape)
    sought, right = matrix[:, len(given) :], -np.asarray(matrix[:, : len(given)] @ given)
    solver = splu((sought.T @ sought + SOFT * sparse.eye(sought.shape[1])).tocsc())
    found = solver.solve(np.asarray(sought.T @ right))
    better: Floats = found + solver.solve(np.asarray(sought.T @ (right - sought @ found)))
    return better
