"""Sets of creases that can be folded while the others are not, by the theorems of Kawasaki and Maekawa.

These look at one vertex at a time: whether the whole sheet can lie so is for the verifier to say.
"""

from __future__ import annotations

import math

import numpy as np

from foldcut.core.arrays import Bools, Floats, Indices
from foldcut.folding_steps.state import SheetData

__all__ = ["CreaseSets"]

STRAIGHT = 1e-7
"""The error that is allowed in the sum of every other angle around a vertex, in radians."""

MOST_SPOKES = 12
"""At a vertex with more creases than this, all have to be folded at once."""


class CreaseSets:
    """Finds sets of creases that can be folded while the others are not, as far as each vertex tells.

    The creases ``fixed``, ``(e,)``, are in every set; ``every`` are all that there are in the end.
    """

    def __init__(self, sheet: SheetData, fixed: Bools, every: Bools) -> None:
        self.every = every
        self.alone = np.zeros_like(every)  # creases that need all others to be folded
        border = np.unique(sheet.ends[~sheet.inner])
        spokes: dict[int, list[tuple[float, int]]] = {}
        for edge in np.flatnonzero(every).tolist():
            for here, there in (sheet.ends[edge].tolist(), sheet.ends[edge].tolist()[::-1]):
                dx, dy = (sheet.flat[there] - sheet.flat[here]).tolist()
                spokes.setdefault(here, []).append((math.atan2(dy, dx), edge))
        for vertex in border.tolist():
            spokes.pop(vertex, None)
        self.at: list[tuple[Indices, Bools]] = []
        self.vertices: dict[int, list[int]] = {}
        for around in spokes.values():
            edges = np.array([edge for _, edge in sorted(around)])
            angles = np.array([angle for angle, _ in sorted(around)])
            for edge in edges.tolist():
                self.vertices.setdefault(edge, []).append(len(self.at))
            self.at.append((edges, _flat_subsets(angles, sheet.valley[edges], fixed[edges])))

    def supersets(self, folded: Bools) -> list[Bools]:
        """Return sets that contain the creases ``folded`` and more, but not all creases; the smallest first."""
        found: dict[bytes, Bools] = {}
        for edge in np.flatnonzero(self.every & ~folded).tolist():
            whole = self._closed(folded, edge)
            found[whole.tobytes()] = whole
        return sorted((w for w in found.values() if (w != self.every).any()), key=lambda w: int(w.sum()))

    def _closed(self, folded: Bools, edge: int) -> Bools:
        """Return a small set that contains the creases ``folded`` and one more, and that every vertex allows."""
        if self.alone[edge]:
            return self.every
        whole = folded.copy()
        whole[edge] = True
        todo = list(self.vertices.get(edge, ()))
        while todo:
            edges, subsets = self.at[todo.pop()]
            now = whole[edges]
            larger = subsets[(subsets >= now).all(axis=1)]
            if (larger == now).all(axis=1).any():
                continue
            forced = larger.all(axis=0)
            grown = forced if (forced != now).any() else larger[larger.sum(axis=1).argmin()]
            for new in edges[grown & ~now].tolist():
                if self.alone[new]:
                    self.alone[edge] = True
                    return self.every
                whole[new] = True
                todo += self.vertices[new]
        self.alone[edge] = bool((whole == self.every).all())
        return whole


def _flat_subsets(angles: Floats, valley: Bools, fixed: Bools) -> Bools:
    """Return all sets of the k creases around a vertex that fold flat without the others, ``(n, k)``.

    The creases are sorted by their ``angles``. Those that are ``fixed`` are in each of the sets.
    """
    count = len(angles)
    if count > MOST_SPOKES:
        return np.stack([fixed, np.ones(count, dtype=np.bool_)])
    subsets = (np.arange(1 << count)[:, None] >> np.arange(count)) % 2 == 1
    subsets = subsets[(subsets >= fixed).all(axis=1)]
    surplus = np.abs(np.where(subsets, np.where(valley, 1, -1), 0).sum(axis=1))
    place = np.cumsum(subsets, axis=1)
    turned = np.where(subsets, np.where(place % 2, -angles, angles), 0.0).sum(axis=1)
    size = place[:, -1]
    good = (size == 0) | ((size % 2 == 0) & (surplus == 2) & (np.abs(turned - math.pi) < STRAIGHT))
    flat: Bools = subsets[good]
    return flat
