"""Whether a pattern folds flat in some layer order: the front of this package.

Crease pattern -> ``Found``: an order of the overlapping faces, or why there is none. Edges assigned U are creases that
may be folded either way; what they become is read off the order.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from foldcut.core.arrays import Chars, Indices, Numbers, sealed
from foldcut.core.model import CreasePattern
from foldcut.geometry.planar_graph import edge_faces
from foldcut.layer_orders.conditions import Conditions, given_by_creases
from foldcut.layer_orders.count import States, count_states
from foldcut.layer_orders.folded_sheet import FoldedSheet, tolerance_of
from foldcut.layer_orders.reasons import Reason, why_none
from foldcut.layer_orders.search import OrderSearch
from foldcut.pattern.face_maps import fold_faces

__all__ = ["MOST_PAIRS", "Found", "count_orders", "find_order", "with_folds"]

MOST_PAIRS = 1_000_000
"""With more pairs of overlapping faces than this, no order is looked for."""

CLEAR = 20.0
"""A gap between errors and features that is narrower than this says nothing about what has no order."""


@dataclass(frozen=True, eq=False)
class Found:
    """The answer: ``folds`` is None where none was found, with ``reason`` why.

    ``pattern`` has a mountain or valley for each U; ``pairs`` ``(n, 2)`` are the faces that lie on each other, the
    upper one first. ``tolerance``, relative to the sheet's diagonal: what lies closer together counts as touching.
    """

    folds: bool | None
    pattern: CreasePattern
    tolerance: float
    pairs: Indices
    reason: Reason | None = None


def with_folds(pattern: CreasePattern, letter: str = "M") -> CreasePattern:
    """Return the pattern with another letter for U: M to fold these edges whichever way, F to leave them flat."""
    letters = np.where(pattern.edges_assignment == "U", letter, pattern.edges_assignment)
    return replace(pattern, edges_assignment=sealed(letters))


def find_order(pattern: CreasePattern, given: Numbers, error: float = 0.0) -> Found:
    """Return an order of the faces of a pattern, the faces of which tile a sheet and meet when they are folded.

    ``given`` ``(n, 2)``: pairs of faces, the first of which has to be above the second. ``error``: by how many mm the
    coordinates are known to be off.
    """
    letters = pattern.edges_assignment
    sheet, gap = _folded(pattern, error)
    share = sheet.tolerance / float(np.hypot(*np.ptp(pattern.vertices_coords, axis=0)))
    none = np.empty((0, 2), dtype=np.intp)
    if len(sheet.overlapping) > MOST_PAIRS:
        text = f"{len(sheet.overlapping):,} pairs of faces lie on each other; more than {MOST_PAIRS:,} are not ordered"
        return Found(None, pattern, share, none, Reason(text, None))
    conditions = Conditions(sheet, np.concatenate([given_by_creases(sheet, letters)[1], given]))
    search = OrderSearch(conditions)
    try:
        over = search.find()
    finally:
        search.close()
    if over is not None:
        pairs = np.where(over[:, None], conditions.pairs, conditions.pairs[:, ::-1])
        assigned = replace(pattern, edges_assignment=_read_off(sheet, letters, pairs))
        return Found(True, assigned, share, pairs)
    if not search.decided:
        text = "the search for a layer order was given up; there may be one"
        return Found(None, pattern, share, none, Reason(text, None))
    reason = why_none(sheet, letters, given)
    if gap < CLEAR:
        text = f"its coordinates are too coarse to tell what lies on what when it is folded; as they are, {reason.text}"
        return Found(None, pattern, share, none, Reason(text, reason.place))
    return Found(False, pattern, share, none, reason)


def count_orders(pattern: CreasePattern, error: float = 0.0) -> States | None:
    """Return how many layer orders a pattern that folds flat has, or None if they are too many to be counted.

    Edges assigned U may be folded either way. ``error`` as in ``find_order``.
    """
    sheet, _ = _folded(pattern, error)
    if len(sheet.overlapping) > MOST_PAIRS:
        return None
    conditions = Conditions(sheet, given_by_creases(sheet, pattern.edges_assignment)[1])
    search = OrderSearch(conditions)
    try:
        if search.find() is None:
            return None if not search.decided else States((0,))
        return count_states(conditions, search)
    finally:
        search.close()


def _folded(pattern: CreasePattern, error: float) -> tuple[FoldedSheet, float]:
    """Return the folded sheet, and how clear the gap between errors and features is."""
    folding = with_folds(pattern)
    faces_of_edges = edge_faces(pattern)
    maps = fold_faces(folding, faces_of_edges)
    tolerance, gap = tolerance_of(folding, faces_of_edges, maps, error)
    return FoldedSheet(folding, faces_of_edges, maps, tolerance), gap


def _read_off(sheet: FoldedSheet, letters: Chars, pairs: Indices) -> Chars:
    """Return the letters with mountains and valleys for the unassigned, as the order of their faces makes them."""
    found: Chars = letters.copy()
    unassigned = np.flatnonzero((letters[sheet.edges] == "U") & sheet.folded)
    left, right = sheet.beside[unassigned].T
    right_above = np.isin(right * sheet.count + left, pairs[:, 0] * sheet.count + pairs[:, 1])
    found[sheet.edges[unassigned]] = np.where(right_above == sheet.up[left], "V", "M")
    return sealed(found)
