"""FOLD 1.2: the pattern, how it folds and which face lies on which, for other origami programs.

Input: a ``FoldedPattern``; output: JSON, one key per line. Frame 0 is the crease pattern in mm on the sheet; frame 1 is
the folded form, which inherits everything except the coordinates. Coordinates have all the digits of a float64, because
layer solvers fail on lines that nearly coincide.

Our own keys: ``foldcut:layers``, the faces from bottom to top; ``foldcut:placement``, the 2 x 3 matrix from the
drawing's coordinates (an SVG's y points down) to the sheet's, y up; ``foldcut:shape``, the loops on the sheet that the
cut cuts out, even-odd; ``foldcut:firstFolds``, the lines that are folded first; ``foldcut:drawn``, the drawing's loops
on the sheet, if the shape is another outline near to them; ``foldcut:movedBy``, by how many mm the shape was moved from
the drawing at most (see ``redraw.deviation``); ``foldcut:faceOrders`` = "adjacent" if only faces that share
a crease are ordered (see ``face_orders``). The command line adds ``foldcut:recipe`` (see ``recipe_place``).
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from foldcut.core.arrays import Ints, Ragged
from foldcut.core.model import FoldedPattern
from foldcut.geometry.planar_graph import half_edges, pair_keys
from foldcut.pattern.overlaps import OVERLAP_TOLERANCE, distinct, doubled_areas, overlaps
from foldcut.profiles import Profile

FOLD_ANGLES = {"M": -180, "V": 180}
"""The fold angle of a crease in degrees; 0 for other edges."""

MOST_FACE_ORDERS = 2_000_000
"""With more pairs only neighbouring faces are ordered: a list of tens of megabytes is read by few programs."""

ROWS = 8192
"""This many rows of an array are written at once: more would take memory, fewer would take time."""


def export(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return ``pattern`` as a FOLD file; nothing in it depends on the profile."""
    creases = pattern.creases
    orders, adjacent_only = face_orders(pattern)
    fold: dict[str, object] = {
        "file_spec": 1.2,
        "file_creator": f"foldcut {version('foldcut')}",
        "file_title": pattern.title,
        "file_classes": ["singleModel"],
        "frame_classes": ["creasePattern"],
        "frame_unit": "mm",
        "vertices_coords": creases.vertices_coords,
        "edges_vertices": creases.edges_vertices,
        "edges_assignment": creases.edges_assignment,
        "edges_foldAngle": _fold_angles(creases.edges_assignment),
        "faces_vertices": creases.faces_vertices,
        "faceOrders": orders,
        "file_frames": [
            {
                "frame_classes": ["foldedForm"],
                "frame_parent": 0,
                "frame_inherit": True,
                "vertices_coords": pattern.folded.vertices_coords,
            }
        ],
        "foldcut:placement": pattern.placement.matrix,
        "foldcut:layers": pattern.folded.layers,
        "foldcut:shape": list(pattern.shape.loops),
        "foldcut:firstFolds": list(pattern.first_folds),
    }
    if pattern.shape.lines:
        fold["foldcut:lines"] = list(pattern.shape.lines)
    if pattern.drawn:
        fold["foldcut:drawn"] = list(pattern.drawn)
    if pattern.moved_by is not None:
        fold["foldcut:movedBy"] = pattern.moved_by
    if adjacent_only:
        fold["foldcut:faceOrders"] = "adjacent"
    return _to_json(fold)


def face_orders(pattern: FoldedPattern, most: int = MOST_FACE_ORDERS) -> tuple[Ints, bool]:
    """Return FOLD's ``faceOrders``, and whether they are limited to faces that share a crease.

    There is a row ``(f, g, s)``, ``(m, 3)`` int32 with f < g, for each two faces that overlap when folded: s = 1 if f
    lies on the side of g to which g's normal points in the folded state, otherwise -1 (FOLD specification 1.2,
    faceOrders). If there are more than ``most`` overlaps, only faces that share a crease are listed.
    """
    pairs = overlapping_faces(pattern, most)
    adjacent_only = pairs is None
    if pairs is None:
        pairs = _faces_across_creases(pattern.creases.faces_vertices)
    f, g = pairs.T
    rank = np.empty(len(pattern.folded.layers), dtype=np.int32)
    rank[pattern.folded.layers] = np.arange(len(rank))
    above = rank[f] > rank[g]
    # Layers are counted along the normal of face 0, so a face turned like face 0 has its normal up.
    turned = doubled_areas(pattern.folded.vertices_coords, pattern.creases.faces_vertices) < 0
    normal_up = turned == turned[0]
    signs = np.where(above == normal_up[g], 1, -1)
    return np.column_stack([f, g, signs]).astype(np.int32), adjacent_only


def overlapping_faces(pattern: FoldedPattern, most: int = MOST_FACE_ORDERS) -> Ints | None:
    """Return the pairs of faces that overlap when folded, ``(m, 2)`` with f < g, or None if more than ``most`` do."""
    tolerance = OVERLAP_TOLERANCE * pattern.sheet.diagonal
    return overlaps(pattern.folded.vertices_coords, pattern.creases.faces_vertices, tolerance, most)


def _faces_across_creases(faces: Ragged) -> Ints:
    """Return the pairs of faces that share an edge, ``(m, 2)`` with f < g."""
    one, other = half_edges(faces)
    ends = pair_keys(np.minimum(one, other), np.maximum(one, other))
    order = np.argsort(ends, kind="stable")
    shared = np.flatnonzero(np.diff(ends[order]) == 0)
    f, g = (faces.rows[order[shared + n]].astype(np.int64) for n in (0, 1))
    return np.column_stack(np.divmod(distinct(f * len(faces) + g), len(faces))).astype(np.int32)


def _fold_angles(assignment: NDArray[np.str_]) -> Ints:
    """Return the fold angle of every edge in degrees, ``(n,)``."""
    angles = np.zeros(len(assignment), dtype=np.int32)
    for letter, angle in FOLD_ANGLES.items():
        angles[assignment == letter] = angle
    return angles


def _to_json(fold: dict[str, object]) -> bytes:
    """Return compact JSON with one top-level key per line; infinity and NaN are errors."""
    lines = []
    for key, value in fold.items():
        lines.append(f"{json.dumps(key)}: ".encode() + b"".join(part.encode() for part in _parts(value)))
    return b"{\n" + b",\n".join(lines) + b"\n}\n"


def _parts(value: object) -> Iterator[str]:
    """Yield a value as JSON, in parts; ``json.dumps`` of millions of lists would take time and memory."""
    if isinstance(value, np.ndarray | Ragged):
        yield "["
        for low in range(0, len(value), ROWS):
            yield "," * (low > 0) + _rows(value, low, min(low + ROWS, len(value)))
        yield "]"
    elif isinstance(value, dict):
        for number, (key, item) in enumerate(value.items()):
            yield f"{',' if number else '{'}{json.dumps(key)}:"
            yield from _parts(item)
        yield "}" if value else "{}"
    elif isinstance(value, list):
        yield "["
        for number, item in enumerate(value):
            yield "," * (number > 0)
            yield from _parts(item)
        yield "]"
    else:
        yield json.dumps(value, allow_nan=False)


def _rows(array: NDArray[Any] | Ragged, low: int, high: int) -> str:
    """Return some rows as JSON, with commas between them."""
    if isinstance(array, Ragged):
        lengths = array.lengths[low:high].tolist()
        rows = {length: f"[{','.join(['%d'] * length)}]" for length in set(lengths)}
        values = array.values[array.offsets[low] : array.offsets[high]]
        return ",".join([rows[length] for length in lengths]) % tuple(values.tolist())
    values = array[low:high]
    if values.dtype.kind == "f" and not np.isfinite(values).all():
        raise ValueError("JSON has no numbers for infinity and NaN")
    one = {"f": "%r", "i": "%d", "U": '"%s"'}[values.dtype.kind]
    row = one if values.ndim == 1 else f"[{','.join([one] * values.shape[1])}]"
    return ",".join([row] * len(values)) % tuple(values.ravel().tolist())
