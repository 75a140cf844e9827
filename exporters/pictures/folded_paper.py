"""The sheet as it lies during folding, drawn so that its layers can be seen: lower ones stand out a little.

A ``FoldedPattern`` and one of its states -> ``Item`` after ``Item``, from the lowest layer to the highest. What is on
top is drawn where it lies. A layer under others is moved away from the middle of the picture, the farther the more lie
on it, except where it hangs on a layer above by a crease.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, Indices, Ints, Ragged, index_array
from foldcut.core.model import CreasePattern, FoldedPattern, FoldedState
from foldcut.folding_steps.references import CORNERS, corner_vertices
from foldcut.geometry.planar_graph import edge_faces, signed_areas
from foldcut.geometry.union_find import groups

from . import panels
from .panels import EDGE, EDGE_COLOUR, PANEL_MM, Item, Key, Label

FRONT = "#ffffff"
"""The colour of the sheet's printed side."""

BACK = "#cfd8e3"
"""The colour of the sheet's back."""

MOVED = "#fde0c8"
"""The colour of the printed side of the part that moves."""

MOVED_BACK = "#eeb58a"
"""The colour of the back of the part that moves."""

STEP_MM = 0.7
"""How far a layer stands out beyond the next, in mm on the panel."""

MOST_MM = 3.5
"""How far the lowest layer stands out at most."""

MOST_FACES = 400
"""Patterns with more faces are drawn without this."""

SAME_AREA = 1e-4
"""The topmost layer covers the sheet as it lies if its area is off by less than this, as a fraction."""

TOUCHING = 1e-7
"""Faces that overlap by less than this, relative to the sheet's diagonal, lie beside each other."""


class FoldedPaper:
    """A sheet, and the pictures of its states."""

    def __init__(self, pattern: FoldedPattern) -> None:
        creases = pattern.creases
        self.sheet, self.faces, self.ends = pattern.sheet, creases.faces_vertices, creases.edges_vertices
        self.beside = edge_faces(creases)
        self.flat, self.kinds = creases.vertices_coords, creases.edges_assignment
        self.corners = corner_vertices(pattern)
        self.unfolded = FoldedState(self.flat, index_array(np.arange(len(self.faces))))

    def drawn(self, state: FoldedState, folded: Bools, moved: Ints | None = None) -> list[Item]:
        """Return the sheet with the creases ``folded``, ``(e,)``; its border and folded creases are drawn as edges."""
        if not folded.any() and moved is None:
            return [panels.faces([self.sheet.corners], FRONT)]
        seen: Bools = folded | (self.beside < 0).any(axis=1)
        edges: list[list[int]] = [[] for _ in range(len(self.faces))]
        for edge in np.flatnonzero(seen).tolist():
            for face in self.beside[edge].tolist():
                if face >= 0:
                    edges[face].append(edge)
        moving: Collection[int] = set() if moved is None else set(moved.tolist())
        at, front = self.apart(state, folded), self.front_up(state)
        items = []
        for face in state.layers.tolist():
            fill = (MOVED if front[face] else MOVED_BACK) if face in moving else FRONT if front[face] else BACK
            items.append(Item([at[self.faces[face]]], fill=fill, stroke=fill, width=EDGE / 2, closed=True))
            lines = [at[self.ends[edge]] for edge in edges[face]]
            items += [Item(lines, stroke=EDGE_COLOUR, width=EDGE)] if lines else []
        return items

    def front_up(self, state: FoldedState) -> Bools:
        """Return which faces have their printed side up, ``(f,)``."""
        return np.asarray(signed_areas(state.vertices_coords, self.faces) > 0)

    def apart(self, state: FoldedState, folded: Bools) -> Floats:
        """Return where the vertices are drawn, ``(v, 2)``: those of lower layers a little outside."""
        at = state.vertices_coords
        if len(self.faces) > MOST_FACES or not folded.any():
            return at
        under = self.depths(state, folded)
        least = np.full(len(at), len(self.faces))
        np.minimum.at(least, self.faces.values, under[self.faces.rows])
        low, high = at.min(axis=0), at.max(axis=0)
        away = at - (low + high) / 2
        away = away / np.maximum(np.hypot(*away.T), 1e-9)[:, None]
        step = min(STEP_MM, MOST_MM / max(1, int(least.max()))) * float((high - low).max()) / PANEL_MM
        apart: Floats = at + away * (least * step)[:, None]
        return apart

    def depths(self, state: FoldedState, folded: Bools) -> Indices:
        """Return for each face how many layers lie on it at most, one on another, ``(f,)``.

        Faces between which there is no folded crease are one layer.
        """
        count = len(self.faces)
        flat = (self.beside >= 0).all(axis=1) & ~folded
        _, part = np.unique(groups(count, list(map(tuple, self.beside[flat].tolist()))), return_inverse=True)
        polygons = shapely.polygons(
            shapely.linearrings(state.vertices_coords[self.faces.values], indices=self.faces.rows)
        )
        bodies = shapely.buffer(polygons, -TOUCHING * self.sheet.diagonal, join_style="mitre")
        one, other = shapely.STRtree(bodies).query(bodies, predicate="intersects")
        rank = np.argsort(state.layers)
        lower = (rank[one] < rank[other]) & (part[one] != part[other])
        low, high = part[one[lower]], part[other[lower]]
        under = np.zeros(int(part.max()) + 1, dtype=np.intp)
        for _ in range(len(under)):  # the longest row of parts, each on the one before
            more = under.copy()
            np.maximum.at(more, low, under[high] + 1)
            if np.array_equal(more, under):
                break
            under = np.minimum(more, len(under))
        return under[part]

    def top(self, state: FoldedState, folded: Bools, closing: Ints) -> tuple[CreasePattern, bool] | None:
        """Return the sheet as it lies as if it were one layer, with the creases that are ``closing``, seen from above.

        With it comes whether its printed side is up. None where it is no such sheet: the topmost layer does not cover
        all others.
        """
        on_top = np.flatnonzero(self.depths(state, folded) == 0) if folded.any() else np.arange(len(self.faces))
        rings, at = self.faces.to_lists(), state.vertices_coords
        areas = signed_areas(at, self.faces)
        shown = shapely.union_all([shapely.Polygon(at[ring]).buffer(TOUCHING * self.sheet.diagonal) for ring in rings])
        if abs(np.abs(areas[on_top]).sum() - shown.area) > SAME_AREA * shown.area or len(set(areas[on_top] > 0)) > 1:
            return None
        up = bool(areas[on_top[0]] > 0)
        faces = [rings[face] if up else rings[face][::-1] for face in on_top.tolist()]
        beside = np.isin(self.beside, on_top)
        some = beside.any(axis=1)
        kinds = np.where(beside.all(axis=1), "F", "B")
        seen = self.kinds if up else np.where(self.kinds == "M", "V", np.where(self.kinds == "V", "M", self.kinds))
        here = np.zeros(len(kinds), dtype=np.bool_)
        here[closing] = True
        kinds = np.where((kinds == "F") & here, seen, kinds)[some]
        return CreasePattern(at, self.ends[some], kinds, Ragged.from_rows(faces)), up

    def names(self, state: FoldedState, folded: Bools) -> list[Label]:
        """Return labels for the sheet's corners where they lie; several at one place share one."""
        at = self.apart(state, folded)
        middle = (at.min(axis=0) + at.max(axis=0)) / 2
        labels: list[tuple[Floats, str]] = []
        near = 0.02 * self.sheet.diagonal
        for name, corner in zip(CORNERS, self.corners, strict=True):
            place = at[corner]
            same = next((k for k, (there, _) in enumerate(labels) if np.hypot(*(there - place)) < near), None)
            if same is None:
                labels.append((place, name))
            else:
                labels[same] = (labels[same][0], labels[same][1] + name)
        made = []
        for place, text in labels:
            away = place - middle
            away = away / max(float(np.hypot(*away)), 1e-9)
            made.append(Label(text, place, (1.1 * float(away[0]), 1.1 * float(away[1])), colour="#666666"))
        return made

    def back(self, state: FoldedState) -> list[Key]:
        """Return a key for the sheet's back, if it can be seen."""
        return [] if self.front_up(state).all() else [Key("the back", fill=BACK)]
