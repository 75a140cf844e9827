"""What a FOLD file says about its pattern beside the creases: all the fields that other programs read.

JSON objects of the frames -> ``Claims``. Only their form is checked here; ``judge`` compares them with the pattern.
(FOLD specification 1.2.)
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from foldcut.core.arrays import Chars, Floats, Ints, sealed
from foldcut.foldfile.parts import fail, indices, numbers, rows_of

__all__ = ["INCIDENCES", "Claims", "Frames", "read_claims"]

Frames = Iterable[tuple[str, Mapping[str, Any]]]
"""The key frame and the folded frames of a file, each with its place in it: "" or ``"file_frames[0]."``."""

INCIDENCES = ("vertices_vertices", "vertices_edges", "vertices_faces", "edges_faces", "faces_edges", "faces_faces")
"""The fields that say what lies beside what: a list of numbers, or null for none, for each vertex, edge or face."""

NOT_JUDGED = ("edgeOrders", "faces_edgesOrders")
"""Fields about which nothing is found out; a note says so."""


@dataclass(frozen=True, eq=False)
class Claims:
    """Fields by their place in the file.

    ``orders`` ``(m, 3)``: rows of ``faceOrders``. ``angles`` ``(e,)`` in degrees, NaN where the file says nothing.
    ``letters`` ``(e,)``: ``edges_assignment`` of frames after the first. ``lengths`` ``(e,)``: ``edges_length``, in the
    file's unit. ``folded`` ``(v, 2)``: where flat folded frames have the vertices, in the file's unit.
    ``beside``: for each of ``INCIDENCES`` a set of numbers for each element.
    """

    orders: dict[str, Ints] = field(default_factory=dict)
    angles: dict[str, Floats] = field(default_factory=dict)
    letters: dict[str, Chars] = field(default_factory=dict)
    lengths: dict[str, Floats] = field(default_factory=dict)
    folded: dict[str, Floats] = field(default_factory=dict)
    beside: dict[str, list[set[int]]] = field(default_factory=dict)


def read_claims(frames: Frames, counts: Mapping[str, int]) -> tuple[Claims, tuple[str, ...]]:
    """Return what the frames of a file say, and notes on what is not judged.

    ``counts``: the number of "vertices", "edges" and "faces" of the pattern. A frame that divides the sheet in another
    way is left out. Raises ``FileFormatError`` for a field that has not the form that FOLD gives it.
    """
    claims = Claims()
    notes: list[str] = []
    first: Mapping[str, Any] | None = None
    for place, frame in frames:
        first = frame if first is None else first
        other = [
            name for name in ("edges_vertices", "faces_vertices") if frame.get(name, 0) not in (0, first.get(name))
        ]
        if other:
            notes.append(f"{place}{other[0]} is not that of the first frame: this frame is left out")
            continue
        _read_frame(place, frame, counts, claims, notes)
    return claims, tuple(notes)


def _read_frame(
    place: str, frame: Mapping[str, Any], counts: Mapping[str, int], claims: Claims, notes: list[str]
) -> None:
    """Add what one frame says to ``claims`` and ``notes``."""
    edges = counts["edges"]
    if "faceOrders" in frame:
        name = f"{place}faceOrders"
        claims.orders[name] = _orders(name, frame["faceOrders"], counts["faces"])
    is_flat = not place or _flat_coords(place, frame, counts["vertices"], claims, notes)
    if "edges_foldAngle" in frame and is_flat:  # a frame that is folded in part has other angles
        name = f"{place}edges_foldAngle"
        claims.angles[name] = _one_each(name, frame["edges_foldAngle"], edges)
    if place and "edges_assignment" in frame:
        name = f"{place}edges_assignment"
        letters = frame["edges_assignment"]
        if not isinstance(letters, list) or len(letters) != edges or not all(isinstance(one, str) for one in letters):
            fail(name, f"must be a list of one letter for each of the {edges} edges")
        claims.letters[name] = np.array(["F" if one == "J" else one for one in letters], dtype=np.str_)
    if not place and "edges_length" in frame:
        claims.lengths["edges_length"] = _one_each("edges_length", frame["edges_length"], edges)
    for name in INCIDENCES:
        if not place and name in frame:
            claims.beside[name] = _beside(name, frame[name], counts)
    notes += [f"{place}{name} is not judged" for name in NOT_JUDGED if frame.get(name)]


def _orders(place: str, orders: object, count: int) -> Ints:
    """Return the rows of ``faceOrders``."""
    rows = []
    if not isinstance(orders, list):
        fail(place, "must be a list")
    for at, row in enumerate(orders):
        here = f"{place}[{at}]"
        if not isinstance(row, list) or len(row) != 3:
            fail(here, "must be [face, face, 1, 0 or -1]")
        f, g = indices(here, row[:2], count)
        if type(row[2]) is not int or row[2] not in (-1, 0, 1):
            fail(f"{here}[2]", f"{row[2]!r} is not 1, 0 or -1")
        rows.append((f, g, row[2]))
    return sealed(np.array(rows, dtype=np.int32).reshape(-1, 3))


def _flat_coords(place: str, frame: Mapping[str, Any], count: int, claims: Claims, notes: list[str]) -> bool:
    """Add where a folded frame has the vertices, if that is flat; return whether the frame may be judged."""
    if "vertices_coords" not in frame:
        return True  # it has those of the first frame, and says nothing about the folded form
    name = f"{place}vertices_coords"
    points = [numbers(here, row) for here, row in rows_of(name, frame["vertices_coords"])]
    if len(points) != count or any(len(point) not in (2, 3) or any(point[2:]) for point in points):
        notes.append(f"{name}: not {count} places in one plane: this folded form is not judged")
        return False
    claims.folded[name] = np.array([point[:2] for point in points]).reshape(-1, 2)
    return True


def _one_each(place: str, values: object, count: int) -> Floats:
    """Return a list of one number or null for each edge, with NaN for null."""
    if not isinstance(values, list) or len(values) != count:
        fail(place, f"must be a list of one number for each of the {count} edges")
    given = [0 if value is None else value for value in values]
    found = np.array(numbers(place, given))
    found[[value is None for value in values]] = np.nan
    return sealed(found)


def _beside(name: str, rows: object, counts: Mapping[str, int]) -> list[set[int]]:
    """Return what a field of ``INCIDENCES`` lists, without nulls."""
    of, what = name.split("_")
    found = []
    for place, row in rows_of(name, rows):
        found.append(set(indices(place, [number for number in row if number is not None], counts[what])))
    if len(found) != counts[of]:
        fail(name, f"must be a list of one list for each of the {counts[of]} {of}")
    return found
