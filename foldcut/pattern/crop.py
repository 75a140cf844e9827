"""Cut a pattern down to a part of its sheet: what folds flat still does when some of the paper is missing.

``CreasePattern``, ``FoldedState`` and a rectangle -> the pattern of the paper inside it.

The faces of a pattern that folds flat are convex, as no angle between neighbouring creases is above a half turn. So a
rectangle leaves one piece of a face at most, and the order of layers stays what it was.
"""

from __future__ import annotations

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.model import CreasePattern, FoldedState
from foldcut.pattern.assemble import Polygon, assemble, creases_of_stack

__all__ = ["crop", "crop_stack"]

ON_BORDER = 1e-9
"""Vertices this close to the border, relative to the rectangle's diagonal, lie on it."""


def crop(creases: CreasePattern, folded: FoldedState, low: Floats, high: Floats) -> tuple[CreasePattern, FoldedState]:
    """Return what is left of a pattern, and of its folded state, in a rectangle that lies on its sheet.

    ``low`` and ``high`` ``(2,)`` are the rectangle's lower left and upper right corner, in the pattern's mm. Raises
    ``NoFaceUpError`` if all that is left looks down.
    """
    faces = creases.faces_vertices.to_lists()
    stack = [faces[k] for k in folded.layers.tolist()]
    return crop_stack(creases.vertices_coords, folded.vertices_coords, stack, low, high)


def crop_stack(
    flat: Floats, landing: Floats, stack: list[Polygon], low: Floats, high: Floats
) -> tuple[CreasePattern, FoldedState]:
    """Do as ``crop`` with faces in a ``stack``, from bottom to top.

    Their vertices are ``flat``, and fold to ``landing``, both ``(v, 2)`` mm.
    """
    piece = _Pieces(flat, landing, stack)
    tie = ON_BORDER * float(np.hypot(*(high - low)))
    for axis in (0, 1):
        piece.cut(axis, 1.0, float(low[axis]), tie)
        piece.cut(axis, -1.0, float(high[axis]), tie)
    flat, landed = piece.flat, piece.folded
    edges, kinds = creases_of_stack(landed, piece.stack)
    at_corner = ((flat == low) | (flat == high)).all(axis=1)
    landed = landed - (landed[np.unique(edges), 0].min(), 0.0)
    return assemble(flat, landed, piece.stack, edges, kinds, set(np.flatnonzero(at_corner).tolist()))


class _Pieces:
    """Faces, cut along one line after another.

    ``flat`` and ``folded`` ``(v, 2)`` mm: the vertices on the sheet and where they land; ``stack``: what is left of the
    faces, from bottom to top.
    """

    def __init__(self, flat: Floats, folded: Floats, stack: list[Polygon]) -> None:
        self.flat, self.folded, self.stack = flat, folded, stack

    def cut(self, axis: int, sign: float, border: float, tie: float) -> None:
        """Keep what lies at ``border`` on an axis or beyond, if ``sign`` is 1, else what lies before it."""
        beyond = sign * (self.flat[:, axis] - border)
        flat = self.flat.copy()
        on = np.abs(beyond) <= tie
        flat[on, axis] = border
        side = np.where(on, 0, np.sign(beyond)).astype(int).tolist()
        crossing: dict[tuple[int, int], int] = {}
        stack = []
        for face in self.stack:
            if max(side[vertex] for vertex in face) <= 0:
                continue
            kept = []
            for a, b in zip(face, face[1:] + face[:1], strict=True):
                if side[a] >= 0:
                    kept.append(a)
                if side[a] * side[b] < 0:
                    kept.append(crossing.setdefault((min(a, b), max(a, b)), len(flat) + len(crossing)))
            stack.append(kept)
        ends = np.array(list(crossing), dtype=np.intp).reshape(-1, 2)
        part = beyond[ends[:, 0]] / (beyond[ends[:, 0]] - beyond[ends[:, 1]])
        new = flat[ends[:, 0]] + part[:, None] * (flat[ends[:, 1]] - flat[ends[:, 0]])
        new[:, axis] = border
        landed = self.folded
        there = landed[ends[:, 0]] + part[:, None] * (landed[ends[:, 1]] - landed[ends[:, 0]])
        self.flat, self.folded, self.stack = np.concatenate([flat, new]), np.concatenate([landed, there]), stack
