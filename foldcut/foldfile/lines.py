"""A crease pattern from its lines: what .cp, .opx and SVG files have.

Lines with letters -> ``CreasePattern``. Ends that are nearly at one point are joined there, lines are divided where
others cross them or end on them, lines that lie on each other become one, and ends that hang free are left out. What
has a face on one side only is the border.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Chars, Floats, Indices, Numbers, Ragged, index_array, points_array, sealed
from foldcut.core.errors import FileFormatError
from foldcut.core.model import CreasePattern
from foldcut.geometry.planar_graph import edge_faces, trace_faces
from foldcut.geometry.union_find import groups

__all__ = ["pattern_of_edges", "pattern_of_lines"]

NEAR = 1 / 300
"""Points are joined if they are nearer than this part of the shortest line, the length that Flat-Folder takes."""

NEAREST, FARTHEST = 1e-9, 1e-4
"""How near points are that are joined, at least and at most, relative to the size of the pattern."""

MOST_LINES = 100_000
"""Files with more lines are refused."""

STRAYS = 0.05
"""Lines with a free end are left out if they are at most this part of the length of all creases."""

FIRST = "BMVUF"
"""Of lines that lie on each other the one with the first of these letters counts."""


def pattern_of_lines(ends: Floats, letters: Chars) -> tuple[CreasePattern, tuple[str, ...]]:
    """Return the pattern of lines, ``(n, 2, 2)`` mm and ``(n,)``, and notes on what was mended.

    Raises ``FileFormatError`` where there are no faces, far too many lines, or too many with a free end.
    """
    if len(ends) > MOST_LINES:
        raise FileFormatError(f"the file has {len(ends):,} lines; give at most {MOST_LINES:,}")
    length = np.hypot(*(ends[:, 1] - ends[:, 0]).T) if len(ends) else np.zeros(0)
    size = float(np.hypot(*np.ptp(ends.reshape(-1, 2), axis=0))) if len(ends) else 0.0
    kept = length > NEAREST * size
    ends, letters, length = ends[kept], letters[kept], length[kept]
    if not len(ends):
        raise FileFormatError("the file has no lines; give the border and the creases of a pattern")
    near = float(np.clip(NEAR * length.min(), NEAREST * size, FARTHEST * size))
    points = _joined(np.concatenate([ends.reshape(-1, 2), _crossings(ends)]), near)
    edges, letters = _divided(ends, letters, points, near)
    notes = []
    left = _without_free_ends(edges, len(points))
    if not left.all():
        gone = int((~left).sum())
        x, y = points[edges[~left][0]].mean(axis=0).tolist()
        what, where = f"{gone} line{'s' * (gone != 1)} with a free end", f"the first at ({x:.4g}, {y:.4g})"
        creases = np.isin(letters, ("M", "V", "U"))
        long = np.hypot(*(points[edges[:, 1]] - points[edges[:, 0]]).T)
        if long[creases & ~left].sum() > STRAYS * long[creases].sum():
            raise FileFormatError(
                f"{what}, {where}: no crease ends inside the sheet; give a .fold, or whole lines without dashes"
            )
        notes.append(f"{what} left out, {where}")
    bare = pattern_of_edges(points, edges[left], letters[left])
    letters, outer = bare.edges_assignment, (edge_faces(bare) < 0).any(axis=1)
    inside = int(((letters == "B") & ~outer).sum())
    if inside:
        notes.append(f"{inside} line{'s' * (inside != 1)} of the border inside the sheet: taken as flat")
    letters = np.where(outer, "B", np.where(letters == "B", "F", letters)).astype("<U1")
    return replace(bare, edges_assignment=sealed(letters)), tuple(notes)


def pattern_of_edges(points: Floats, edges: Numbers, letters: Chars) -> CreasePattern:
    """Return the pattern of edges, ``(n, 2)``, that do not cross, with the faces between them and no other points.

    Raises ``FileFormatError`` where there are no faces.
    """
    used, renumbered = np.unique(edges, return_inverse=True)
    coords, ends = points_array(points[used]), index_array(renumbered.reshape(-1, 2))
    faces = trace_faces(coords, ends) if len(ends) else Ragged.from_rows([])
    if not len(faces):
        raise FileFormatError("the lines enclose no face; close the border")
    return CreasePattern(coords, ends, sealed(letters), faces)


def _crossings(ends: Floats) -> Floats:
    """Return the points at which lines cross, ``(k, 2)``."""
    lines = shapely.linestrings(ends)
    one, other = shapely.STRtree(lines).query(lines, predicate="crosses")
    one, other = one[one < other], other[one < other]
    a, b = ends[one, 0], ends[one, 1] - ends[one, 0]
    c, d = ends[other, 0], ends[other, 1] - ends[other, 0]
    across = b[:, 0] * d[:, 1] - b[:, 1] * d[:, 0]
    clear = np.abs(across) > 1e-12 * np.hypot(*b.T) * np.hypot(*d.T)
    away = (c - a)[clear]
    share = (away[:, 0] * d[clear, 1] - away[:, 1] * d[clear, 0]) / across[clear]
    crossings: Floats = a[clear] + share[:, None] * b[clear]
    return crossings


def _joined(points: Floats, near: float) -> Floats:
    """Return the points with those that are near to each other made one: the first of them."""
    spots = shapely.points(points)
    one, other = shapely.STRtree(spots).query(spots, predicate="dwithin", distance=near)
    pairs = np.stack([one, other], axis=1)[one < other]
    return points[np.unique(np.array(groups(len(points), pairs.tolist()), dtype=np.intp))]


def _divided(ends: Floats, letters: Chars, points: Floats, near: float) -> tuple[Indices, Chars]:
    """Return the parts of lines between the points on them, as pairs of points, once each."""
    spots = shapely.points(points)
    line, point = shapely.STRtree(spots).query(shapely.linestrings(ends), predicate="dwithin", distance=near)
    along = ends[line, 1] - ends[line, 0]
    place = ((points[point] - ends[line, 0]) * along).sum(axis=1)
    order = np.lexsort((place, line))
    line, point = line[order], point[order]
    following = np.flatnonzero(line[1:] == line[:-1])
    parts = np.sort(np.stack([point[following], point[following + 1]], axis=1), axis=1)
    rank = np.array([FIRST.index(letter) for letter in letters.tolist()], dtype=np.intp)[line[following]]
    order = np.lexsort((rank, parts[:, 1], parts[:, 0]))
    parts, rank = parts[order], rank[order]
    first = np.append(True, (np.diff(parts, axis=0) != 0).any(axis=1))
    return parts[first], np.array(list(FIRST))[rank[first]]


def _without_free_ends(edges: Indices, count: int) -> Bools:
    """Return which edges are left when those with an end on no other edge are taken away, again and again."""
    left = np.ones(len(edges), dtype=np.bool_)
    while True:
        degree = np.bincount(edges[left].ravel(), minlength=count)
        free = left & (degree[edges] == 1).any(axis=1)
        if not free.any():
            return left
        left &= ~free
