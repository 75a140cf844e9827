"""A sheet that is folded in part: where its faces lie, what lies on what, and which straight folds are possible.

``SheetData`` is what never changes; a ``SheetState`` is one position of the sheet, and a ``Turn`` leads from one to
another.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from foldcut.core.arrays import Bools, Floats, Indices, index_array, points_array
from foldcut.core.model import FoldedPattern, FoldedState
from foldcut.geometry.planar_graph import edge_faces, signed_areas
from foldcut.geometry.union_find import groups
from foldcut.geometry.vectors import cross
from foldcut.pattern.face_maps import folded_edges

__all__ = ["SheetData", "SheetState", "Turn", "is_one_sheet", "kept_together"]

FEW_PAIRS = 500
"""Parts that hang together by so few pairs of faces are found without scipy, which takes longer to import."""

TOUCHING = 1e-7
"""Places that are this near each other, relative to the sheet's diagonal, count as one."""


@dataclass(frozen=True, eq=False)
class Turn:
    """A straight fold, or its reverse: some faces turn over a line through half a turn.

    ``faces`` ``(f,)`` are those that turn, ``edges`` ``(e,)`` the creases that this folds or unfolds. The line goes
    through ``origin`` in the direction ``along``. ``over``: the faces go over the others, not under them.
    """

    faces: Bools
    origin: Floats
    along: Floats
    over: bool
    edges: Bools


class SheetData:
    """What does not change while the sheet is folded: the pattern, and what follows from it alone."""

    def __init__(self, pattern: FoldedPattern) -> None:
        creases = pattern.creases
        self.flat = creases.vertices_coords
        self.faces = creases.faces_vertices
        self.ends = creases.edges_vertices
        self.beside = edge_faces(creases)
        self.inner = (self.beside >= 0).all(axis=1)
        self.pattern = creases
        self.creased = folded_edges(creases)
        self.valley = creases.edges_assignment == "V"
        self.areas = signed_areas(self.flat, self.faces)
        self.tolerance = TOUCHING * pattern.sheet.diagonal
        lengths = self.flat[self.ends[:, 1]] - self.flat[self.ends[:, 0]]
        self.lengths = np.hypot(*lengths.T)
        self.first_lines = [self._along(*line) for line in pattern.first_folds]
        self.first = np.logical_or.reduce([np.zeros_like(self.creased), *self.first_lines])

    def _along(self, start: Floats, end: Floats) -> Bools:
        """Return which creases lie along a line through two points."""
        off = np.abs(cross(end - start, self.flat[self.ends] - start)) / math.dist(start, end)
        return self.creased & (off < self.tolerance).all(axis=1)


class SheetState:
    """One position of the sheet, folded in part.

    ``at`` ``(v, 2)`` mm: where the vertices are. ``rank`` ``(f,)``: the layer of each face, 0 at the bottom. ``folded``
    ``(e,)``: which creases are folded. ``up`` ``(f,)``: which faces show their front. ``meet`` ``(f, f)``: which faces
    lie on each other.
    """

    def __init__(self, sheet: SheetData, at: Floats, rank: Indices, folded: Bools, meet: Bools | None = None) -> None:
        self.sheet, self.at, self.rank, self.folded = sheet, at, rank, folded
        self.up = signed_areas(at, sheet.faces) > 0
        polygons = shapely.polygons(shapely.linearrings(at[sheet.faces.values], indices=sheet.faces.rows))
        # Shrunk by the tolerance, faces that only touch are apart.
        self.bodies = shapely.buffer(polygons, -sheet.tolerance, join_style="mitre")
        self.meet = self._meetings() if meet is None else meet

    def _meetings(self) -> Bools:
        """Return which faces lie on each other."""
        meet = np.zeros((len(self.bodies),) * 2, dtype=np.bool_)
        one, other = shapely.STRtree(self.bodies).query(self.bodies, predicate="intersects")
        meet[one, other] = one != other
        return meet

    @property
    def public(self) -> FoldedState:
        """The state as ``core.model`` describes it."""
        return FoldedState(points_array(self.at), index_array(np.argsort(self.rank)))

    @property
    def place(self) -> bytes:
        """What is the same for states with the same creases folded and the same faces turned over."""
        return self.folded.tobytes() + self.up.tobytes()

    def turned(self, turn: Turn) -> SheetState:
        """Return the state after a turn."""
        sheet = self.sheet
        moving = np.unique(sheet.faces.values[turn.faces[sheet.faces.rows]])
        at = self.at.copy()
        away = at[moving] - turn.origin
        at[moving] = turn.origin + 2 * (away @ turn.along)[:, None] * turn.along - away
        most = len(self.rank)
        rank = np.where(turn.faces, (2 * most if turn.over else -1) - self.rank, self.rank)
        order = np.empty(most, dtype=np.intp)
        order[np.argsort(rank)] = np.arange(most)
        return SheetState(sheet, at, order, self.folded ^ turn.edges)

    def laid_on(self, other: SheetState) -> SheetState:
        """Return this state, moved and perhaps turned over, so that its largest face lies as it does in ``other``."""
        face = int(self.sheet.areas.argmax())
        turn, shift, same = (value[face] for value in _motion(self, other))
        z = self.at[:, 0] + 1j * self.at[:, 1]
        moved = turn * (z if same else z.conj()) + shift
        rank = self.rank if same else len(self.rank) - 1 - self.rank
        return SheetState(self.sheet, np.stack([moved.real, moved.imag], axis=1), rank, self.folded, self.meet)

    def folds(self, allowed: Bools) -> Iterator[Turn]:
        """Yield the possible straight folds of creases that are ``allowed``, ``(e,)``."""
        open_creases = allowed & ~self.folded
        rising = self.sheet.valley == self.up[self.sheet.beside[:, 0]]  # these fold over, not under
        for over in (True, False):
            yield from self._turns(open_creases & (rising == over), over, None)

    def unfolds(self, glued: Bools) -> Iterator[Turn]:
        """Yield the possible straight unfolds in which no two ``glued`` faces, ``(f, f)``, slide on each other."""
        for over in (True, False):
            yield from self._turns(self.folded, over, glued)

    def _turns(self, movable: Bools, over: bool, glued: Bools | None) -> Iterator[Turn]:
        """Yield the possible turns around lines on which there are ``movable`` creases."""
        for edges, origin, along in self.lines(movable):
            sides = self.sides(origin, along)
            count, part = self.parts(edges, glued)
            if count == 1:
                continue
            member = np.zeros((count, len(part)))
            member[part, np.arange(len(part))] = 1
            above = self.meet & ((self.rank[:, None] < self.rank) == over)  # [f, g]: face g is in the way of face f
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
                    yield Turn(faces, origin, along, over, hinge)

    def simple_folds(self, among: Bools) -> Iterator[Turn]:
        """Yield the folds of the whole sheet as it lies, through all layers, along lines with creases ``among`` these.

        There are creases only on such a line, and the smaller part of the sheet goes over the rest.
        """
        sheet = self.sheet
        for _, origin, along in self.lines(among & ~self.folded):
            low, high = self.sides(origin, along).T
            if ((low < 0) & (high > 0)).any():
                continue
            faces = high > 0
            faces = faces if sheet.areas[faces].sum() <= sheet.areas[~faces].sum() else ~faces
            hinge = sheet.inner & (faces[sheet.beside[:, 0]] != faces[sheet.beside[:, 1]])
            if hinge.any() and not (hinge & (self.folded | ~sheet.creased)).any():
                yield Turn(faces, origin, along, True, hinge)

    def lines(self, movable: Bools) -> Iterator[tuple[Bools, Floats, Floats]]:
        """Yield each line on which there are ``movable`` creases: those creases, a point on it, and its direction."""
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
        """Return on which sides of a line each face is, ``(f, 2)``: -1 or 0 for the right, 0 or 1 for the left."""
        off = (self.at - origin) @ np.array([-along[1], along[0]])
        side = np.where(np.abs(off) < self.sheet.tolerance, 0, np.sign(off)).astype(np.int64)
        starts = self.sheet.faces.offsets[:-1]
        values = side[self.sheet.faces.values]
        return np.stack([np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)], axis=1)

    def parts(self, hinges: Bools, glued: Bools | None) -> tuple[int, Indices]:
        """Return in how many parts the sheet falls without these creases, and the part of each face."""
        one, other = self.sheet.beside[self.sheet.inner & ~hinges].T
        if glued is not None:
            more = np.nonzero(glued)
            one, other = np.concatenate([one, more[0]]), np.concatenate([other, more[1]])
        count = len(self.rank)
        if len(one) <= FEW_PAIRS:
            pairs = list(zip(one.tolist(), other.tolist(), strict=True))
            least, numbers = np.unique(groups(count, pairs), return_inverse=True)
            return len(least), numbers
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        graph = coo_array((np.ones(len(one)), (one, other)), shape=(count, count))
        parts, part = connected_components(graph, directed=False)
        return int(parts), part.astype(np.intp)


def is_one_sheet(state: SheetState, end: SheetState) -> bool:
    """Whether no two faces that lie on each other slide, or change places, on the way to ``end``."""
    one, other = np.nonzero(np.triu(state.meet))
    if not len(one):
        return True
    still, same = kept_together(state, end, one, other)
    ordered = (state.rank[one] < state.rank[other]) == ((end.rank[one] < end.rank[other]) == same[one])
    return bool((still & ordered).all())


def kept_together(state: SheetState, end: SheetState, one: Indices, other: Indices) -> tuple[Bools, Bools]:
    """Return which pairs of faces keep their relative place on the way to ``end``, and which faces do not turn over.

    ``one`` and ``other`` are ``(n,)`` face numbers; the results are ``(n,)`` and ``(f,)``.
    """
    turn, shift, same = _motion(state, end)
    near = 10 * state.sheet.tolerance
    kept = (same[one] == same[other]) & (np.abs(turn[one] - turn[other]) * np.abs(state.at).max() < near)
    return kept & (np.abs(shift[one] - shift[other]) < near), same


def _motion(state: SheetState, end: SheetState) -> tuple[NDArray[np.complex128], NDArray[np.complex128], Bools]:
    """Return for each face the isometry from its place in one state to its place in the other.

    It is ``turn * z + shift`` for a complex z, or for its conjugate where the face turns over. The result is ``turn``,
    ``shift``, and whether the face keeps its side up, each ``(f,)``.
    """
    first = state.sheet.faces.offsets[:-1]
    faces = state.sheet.faces
    # To be accurate, each face is aligned by its first vertex and the one farthest from it.
    start = faces.values[first]
    away = np.hypot(*(state.sheet.flat[faces.values] - state.sheet.flat[start][faces.rows]).T)
    order = np.lexsort((away, faces.rows))
    far = faces.values[order[faces.offsets[1:] - 1]]
    same = state.up == end.up
    z = [s.at[:, 0] + 1j * s.at[:, 1] for s in (state, end)]
    a, b = z[0][start], z[0][far]
    a, b = np.where(same, a, a.conj()), np.where(same, b, b.conj())
    turn = (z[1][far] - z[1][start]) / (b - a)
    return turn, z[1][start] - turn * a, same
