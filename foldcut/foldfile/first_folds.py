"""Whether a pattern can be folded in half first: what a file says about first folds is proven, or it is dropped.

Crease pattern and lines, mm -> the reason why these are no first folds, or nothing. foldcut writes one or two, the
sheet's upright and level middle lines, to be folded one after the other, away from the reader; or three or more through
one point, which make a wedge (``pattern.first_folds``).

It is enough that the pattern is its own mirror image in each line, mountains for valleys, and that each line is creased
all along; only the first line itself keeps its mountains beside the second, since it is folded through one layer. Then
any stacking of one half, with the mirror image of each face behind it, is one of the whole sheet, as if the half were
of thicker paper; and a stacking of the half is part of that of the whole, which is verified.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, Indices
from foldcut.core.model import CreasePattern, Sheet
from foldcut.geometry.planar_graph import pair_keys
from foldcut.pattern.face_maps import folded_edges
from foldcut.pattern.first_folds import is_wedge, letters_of_wedge
from foldcut.proof.tolerance import COINCIDENT

__all__ = ["why_not_first"]

WEDGE_NEAR = 1e-7
"""How far creases of a wedge may be from mirror images of others, as a part of the sheet's diagonal."""

PIECES = 100
"""How many times this length may be left over in pieces at ends of creases."""

SWAPPED = {"M": "V", "V": "M"}
"""What a crease is in the mirror image of a pattern that is folded behind it."""


def why_not_first(creases: CreasePattern, sheet: Sheet, lines: Sequence[Floats]) -> str:
    """Return why ``lines``, ``(n, 2)`` mm each, cannot be folded first in this order; an empty text if they can."""
    if is_wedge(lines):
        return _why_no_wedge(creases, sheet, lines)
    near = 2 * COINCIDENT[0] * sheet.diagonal
    size = np.array([sheet.width, sheet.height])
    axes: list[int] = []
    for number, line in enumerate(lines):
        axis = _axis(line, size, near)
        if axis is None or axis in axes:
            return f"line {number} is no middle line of the sheet, from edge to edge, or comes twice"
        axes.append(axis)
    for number, axis in enumerate(axes):
        if not _is_creased_along(creases, size, axis, axes[:number], near):
            return f"line {number} is not folded away from you all along"
        if not _is_mirrored(creases, size, axis, axes[:number], near):
            return f"the creases on the two sides of line {number} are no mirror images"
    return ""


def _why_no_wedge(creases: CreasePattern, sheet: Sheet, lines: Sequence[Floats]) -> str:
    """Return why lines do not fold the sheet into a wedge first; an empty text if they do.

    The sheet need not be symmetric: of the mirror image in each line, what lies on the sheet has to be creased.
    """
    count, near = len(lines), WEDGE_NEAR * sheet.diagonal
    along = np.array([line[1] - line[0] for line in lines]).reshape(-1, 2)
    if any(len(line) != 2 for line in lines) or not np.hypot(*along.T).all():
        return "each has to have two ends"
    turns = np.sort((np.arctan2(along[:, 1], along[:, 0]) - math.atan2(along[0, 1], along[0, 0])) % math.pi)
    turns[turns > math.pi * (1 - 0.5 / count)] -= math.pi
    if np.abs(np.sort(turns) - math.pi / count * np.arange(count)).max() > near / sheet.diagonal:
        return f"the {count} lines of a wedge have to have equal angles between them"
    normals = np.column_stack([-along[:, 1], along[:, 0]]) / np.hypot(*along.T)[:, None]
    offsets = (normals * [line[0] for line in lines]).sum(axis=1)
    centre = np.linalg.lstsq(normals, offsets, rcond=None)[0]
    if np.abs(normals @ centre - offsets).max() > near:
        return f"the {count} lines of a wedge have to go through one point"
    paper = shapely.box(0, 0, sheet.width, sheet.height)
    creased = {
        letter: shapely.multilinestrings(list(creases.vertices_coords[creases.edges_vertices[letters]]))
        for letter in SWAPPED
        if (letters := creases.edges_assignment == letter).any()
    }
    first = math.atan2(along[0, 1], along[0, 0])
    rays = []
    for number, letter in letters_of_wedge(count).items():
        angle = first + number * math.pi / count
        end = centre + sheet.diagonal * np.array([math.cos(angle), math.sin(angle)])
        rays.append(shapely.intersection(shapely.linestrings([centre, end]), paper))
        if not _covers(creased.get(letter), rays[-1], near):
            return f"the line at {math.degrees(angle) % 180:.4g} degrees is not folded all along as a wedge needs it"
    apart = shapely.buffer(shapely.union_all(rays), near)
    for number, (normal, offset) in enumerate(zip(normals, offsets.tolist(), strict=True)):
        for letter, some in creased.items():
            image = shapely.transform(some, lambda p, n=normal, d=offset: p - 2 * (p @ n - d)[:, None] * n)
            image = shapely.difference(shapely.intersection(image, paper), apart)
            if not _covers(creased.get(SWAPPED[letter]), image, near):
                return f"the creases on the two sides of line {number} are no mirror images"
    return ""


def _covers(lines: shapely.Geometry | None, others: shapely.Geometry, near: float) -> bool:
    """Return whether each of ``others`` lies on ``lines``, but for pieces about as long as ``near``."""
    rest = others if lines is None else shapely.difference(others, shapely.buffer(lines, near))
    return bool(shapely.length(rest) <= PIECES * near)


def _axis(line: Floats, size: Floats, near: float) -> int | None:
    """Return 0 for the upright middle line of a sheet, 1 for the level one, None for any other."""
    if len(line) != 2:
        return None
    for axis in (0, 1):
        along = 1 - axis
        ends = sorted(line[:, along].tolist())
        middle = np.abs(line[:, axis] - size[axis] / 2).max() <= near
        if middle and abs(ends[0]) <= near and abs(ends[1] - size[along]) <= near:
            return axis
    return None


def _is_creased_along(creases: CreasePattern, size: Floats, axis: int, before: Sequence[int], near: float) -> bool:
    """Whether a middle line is creased all along: mountains where the front is up, valleys where it was turned over.

    ``before`` are the axes that were folded before it: what lies to the left or below them has been turned over.
    """
    ends = creases.vertices_coords[creases.edges_vertices]
    on_line = folded_edges(creases) & (np.abs(ends[:, :, axis] - size[axis] / 2) <= near).all(axis=1)
    middles = ends[on_line].mean(axis=1)
    turned = np.zeros(len(middles), dtype=np.int64)
    for other in before:
        turned += middles[:, other] < size[other] / 2
    right = np.where(turned % 2 == 0, "M", "V") == creases.edges_assignment[on_line]
    covered = np.abs(np.diff(ends[on_line][:, :, 1 - axis], axis=1)).sum()
    return bool(right.all() and abs(covered - size[1 - axis]) <= near * max(1, len(middles)))


def _is_mirrored(creases: CreasePattern, size: Floats, axis: int, before: Sequence[int], near: float) -> bool:
    """Whether the mirror image in a middle line has the same creases, with mountains for valleys.

    Those on the line itself and on the axes ``before`` it keep what they are.
    """
    image = _images(creases.vertices_coords, size, axis, near)
    if image is None:
        return False
    some = folded_edges(creases)
    ends, letters = np.sort(creases.edges_vertices[some], axis=1), creases.edges_assignment[some]
    mirrored = np.sort(image[ends], axis=1)
    keys, wanted = pair_keys(*ends.T), pair_keys(*mirrored.T)
    order = np.argsort(keys)
    found = order[np.minimum(np.searchsorted(keys[order], wanted), len(keys) - 1)]
    off = np.abs(creases.vertices_coords[ends] - size / 2)
    on_line: Bools = np.all(off <= near, axis=1)  # by axis
    kept = on_line[:, [axis, *before]].any(axis=1)
    swapped = np.array([SWAPPED[letter] for letter in letters.tolist()])
    same = letters[found] == np.where(kept, letters, swapped)
    return bool((keys[found] == wanted).all() and same.all())


def _images(points: Floats, size: Floats, axis: int, near: float) -> Indices | None:
    """Return for each point the one that is its mirror image, or None if one has none."""
    from scipy.spatial import KDTree

    across = points.copy()
    across[:, axis] = size[axis] - across[:, axis]
    found = KDTree(points).query(across)
    return np.asarray(found[1]) if np.all(found[0] <= near) else None
