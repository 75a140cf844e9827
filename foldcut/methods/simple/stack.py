"""A sheet that is folded along one straight line after another, through all of its layers.

``Stack``: the faces, from bottom to top, where they are on the sheet, and where they lie. Each fold divides the faces
that the line crosses and turns all that is on one side of it over the rest, or under it. So no paper ever passes
through paper, and the order of the layers needs no search.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Floats, Indices
from foldcut.core.model import CreasePattern, FoldedState, Sheet
from foldcut.geometry.vectors import cross
from foldcut.pattern.assemble import Polygon, assemble, creases_of_stack

__all__ = ["Stack", "flat_sheet"]


@dataclass(frozen=True, eq=False)
class Stack:
    """The faces of a sheet, folded in part.

    ``flat`` and ``folded`` ``(v, 2)`` mm: the vertices on the sheet, and where they lie. ``faces``: their vertices,
    counter-clockwise on the sheet, from the lowest face to the highest. The sheet's corners are the first four.
    ``turned`` and ``on`` ``(v,)``: which folds turned a vertex over, and which it lies on: bit k for fold k, of
    ``folds`` so far. What lies on a fold is not turned.
    """

    flat: Floats
    folded: Floats
    faces: list[Polygon]
    turned: Indices
    on: Indices
    folds: int = 0

    def fold(self, origin: Floats, along: Floats, tie: float, *, over: bool = True) -> Stack:
        """Return the stack after what lies to the right of a line has been turned over the rest, or under it.

        The line goes through ``origin`` in the direction ``along``, a unit vector; vertices that are nearer to it than
        ``tie`` lie on it.
        """
        off = cross(along, self.folded - origin)
        side = np.where(np.abs(off) <= tie, 0, np.sign(off)).astype(int).tolist()
        crossing: dict[tuple[int, int], int] = {}
        staying: list[Polygon] = []
        moving: list[Polygon] = []
        for face in self.faces:
            for part, sign in ((staying, 1), (moving, -1)):
                if kept := self._part(face, side, sign, crossing):
                    part.append(kept)
        ends = np.array(list(crossing), dtype=np.intp).reshape(-1, 2)
        share = (off[ends[:, 0]] / (off[ends[:, 0]] - off[ends[:, 1]]))[:, None]
        flat, at = (
            np.concatenate([points, points[ends[:, 0]] * (1 - share) + points[ends[:, 1]] * share])
            for points in (self.flat, self.folded)
        )
        sides = np.concatenate([np.array(side), np.zeros(len(ends), dtype=np.intp)])
        moved = sides < 0
        # what lies between two vertices was turned with either of them, and lies on what both lie on
        turned = np.concatenate([self.turned, self.turned[ends[:, 0]] | self.turned[ends[:, 1]]])
        on = np.concatenate([self.on, self.on[ends[:, 0]] & self.on[ends[:, 1]]])
        away = at[moved] - origin
        at[moved] = origin + 2 * (away @ along)[:, None] * along - away
        faces = [*staying, *moving[::-1]] if over else [*moving[::-1], *staying]
        turned += moved.astype(np.intp) << self.folds
        on += (sides == 0).astype(np.intp) << self.folds
        return Stack(flat, at, faces, turned, on, self.folds + 1)

    def _part(self, face: Polygon, side: list[int], sign: int, crossing: dict[tuple[int, int], int]) -> Polygon:
        """Return what of a face is on one side of the line; where its edges cross the line there are new vertices."""
        if not any(side[vertex] == sign for vertex in face):
            return []
        kept = []
        for a, b in zip(face, face[1:] + face[:1], strict=True):
            if side[a] * sign >= 0:
                kept.append(a)
            if side[a] * side[b] < 0:
                kept.append(crossing.setdefault((min(a, b), max(a, b)), len(self.flat) + len(crossing)))
        return kept

    def pattern(self, origin: Floats, along: Floats) -> tuple[CreasePattern, FoldedState]:
        """Return the pattern of all folds, and the folded state with the cut on the line through ``origin``.

        The inside of the shape is to the left of the direction ``along``, a unit vector.
        """
        away = self.folded - origin
        landed = np.stack([away @ along, cross(along, away)], axis=1)
        landed[:, 0] -= landed[:, 0].min()
        edges, kinds = creases_of_stack(landed, self.faces)
        return assemble(self.flat, landed, self.faces, edges, kinds, {0, 1, 2, 3})


def flat_sheet(sheet: Sheet) -> Stack:
    """Return a sheet before the first fold."""
    none = np.zeros(4, dtype=np.intp)
    return Stack(sheet.corners.copy(), sheet.corners.copy(), [[0, 1, 2, 3]], none, none)
