"""Read any FOLD file: its crease pattern, and its layer order if it has one.

FOLD file -> ``FoldFile``, lengths in mm. The first frame, called the key frame, is the crease pattern. Folded frames
are read for a layer order, and for the places of the vertices if these are the same. Faces are traced from the edges if
the file has none. foldcut's own keys (see ``exporters/pattern/fold.py``) are read if they are there. Only the form is
checked: whether the pattern folds is for ``verify`` to say. (FOLD specification 1.1 and 1.2.)
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from heapq import heapify, heappop, heappush
from itertools import islice
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from foldcut.core.arrays import Bools, Chars, Floats, Ints, Ragged, index_array, points_array
from foldcut.core.errors import FileFormatError
from foldcut.core.model import CreasePattern, Placement
from foldcut.core.units import MM_PER_UNIT
from foldcut.geometry.planar_graph import edge_faces, signed_areas, trace_faces
from foldcut.pattern.face_maps import fold_faces
from foldcut.readers.base import read_text

__all__ = ["FoldFile", "read_fold"]

LARGEST_FILE = 128 * 2**20
"""The size of the largest file, in bytes. 20,000 creases take 4 million, and two million face orders ten times that."""

UNITS_MM = {
    **{unit: MM_PER_UNIT[unit] for unit in ("mm", "cm", "in", "pt")},
    **{"m": 1e3, "um": 1e-3, "nm": 1e-6, "unit": 1.0},
}
"""Millimetres per ``frame_unit``; a bare "unit" is taken as 1 mm."""

ASSIGNMENTS = ("B", "M", "V", "F", "U")
"""The assignments that are read: border, mountain, valley, flat, unassigned."""


@dataclass(frozen=True, eq=False)
class FoldFile:
    """What a FOLD file says, in mm; whatever it does not say is None.

    ``layers`` ``(f,)`` are face numbers from bottom to top. ``folded`` ``(v, 2)`` are the places of the vertices in the
    first folded frame. ``placement``, ``loops`` (the shape on the sheet), ``first_folds`` and ``drawn`` (the drawing
    there) are foldcut's own entries.
    ``unit_mm`` is the length that was assumed for the unit of the file. ``notes`` say what was left out or assumed.
    """

    pattern: CreasePattern
    layers: Ints | None
    placement: Placement | None
    unit_mm: float
    notes: tuple[str, ...] = ()
    title: str = ""
    folded: Floats | None = None
    loops: tuple[Floats, ...] | None = None
    first_folds: tuple[Floats, ...] | None = None
    drawn: tuple[Floats, ...] | None = None


def read_fold(path: Path | str) -> FoldFile:
    """Read the crease pattern of a FOLD file.

    Raises ``FileFormatError`` for a file that cannot be opened, and for anything that is not a flat crease pattern with
    assignments; the error names the place in the file.
    """
    try:
        return _Reader(_load(Path(path))).read()
    except FileFormatError as error:
        raise FileFormatError(f"{path}: {error}") from None
    except OSError as error:
        raise FileFormatError(f"{path}: {error.strerror}; check the path and its permissions") from None


def _load(path: Path) -> dict[str, Any]:
    """Return the JSON object in a file."""
    size = path.stat().st_size
    if size > LARGEST_FILE:
        limit = f"{LARGEST_FILE / 2**20:.0f} MiB"
        raise FileFormatError(f"the file has {size / 2**20:.0f} MiB; give one of at most {limit}")

    def refuse(name: str) -> NoReturn:
        raise ValueError(f"{name} is not a JSON number")

    text = read_text(path)
    try:
        data = json.loads(text, parse_constant=refuse)
    except (ValueError, RecursionError) as error:
        raise FileFormatError(f"not JSON, as a FOLD file has to be: {error}") from None
    if not isinstance(data, dict):
        raise FileFormatError(f"a FOLD file holds one JSON object, not a {type(data).__name__}")
    return data


class _Reader:
    """Reads one file, whose JSON object is ``data``, and collects notes."""

    def __init__(self, data: dict[str, Any]) -> None:
        self.data = data
        self.notes: list[str] = []

    def read(self) -> FoldFile:
        classes = self.data.get("frame_classes", [])
        if isinstance(classes, list) and "foldedForm" in classes and "creasePattern" not in classes:
            self.fail("frame_classes", "the first frame is a folded form; put the crease pattern first")
        unit_mm = self.unit()
        coords = self.vertices(unit_mm)
        edges = self.edges(len(coords))
        assignment = self.assignment(len(edges))
        given = "faces_vertices" in self.data
        if given:
            faces, turned = self.faces(coords)
        else:
            faces = trace_faces(coords, edges)
            turned = np.zeros(len(faces), dtype=np.bool_)
        if not len(faces):
            self.fail("faces_vertices" if given else "edges_vertices", "there are no faces; close the border")
        pattern = CreasePattern(coords, edges, assignment, faces)
        if given:
            layers = self.layers(pattern, turned)
        else:
            layers = None
            self.notes.append("faces_vertices is missing: faces traced from the edges, any layer order left out")
        return FoldFile(
            pattern,
            layers,
            self.placement(),
            unit_mm,
            tuple(self.notes),
            self.title(),
            self.folded(len(coords), unit_mm),
            self.point_lists("foldcut:shape", unit_mm, least=3),
            self.point_lists("foldcut:firstFolds", unit_mm, least=2),
            self.point_lists("foldcut:drawn", unit_mm, least=3),
        )

    def fail(self, place: str, problem: str) -> NoReturn:
        raise FileFormatError(f"{place}: {problem}")

    def unit(self) -> float:
        """Return how many mm one unit is."""
        unit = self.data.get("frame_unit", "unit")
        if not isinstance(unit, str) or unit not in UNITS_MM:
            self.fail("frame_unit", f"{unit!r} is not one of {', '.join(UNITS_MM)}")
        if unit == "unit":
            self.notes.append("no unit of length is given; one unit is taken as 1 mm")
        return UNITS_MM[unit]

    def title(self) -> str:
        title = self.data.get("file_title", "")
        return title if isinstance(title, str) else ""

    def vertices(self, unit_mm: float) -> Floats:
        return self.points(self.rows("vertices_coords"), unit_mm)

    def points(self, rows: Iterator[tuple[str, list[Any]]], unit_mm: float) -> Floats:
        points = []
        for place, row in rows:
            numbers = self.numbers(place, row)
            if len(numbers) not in (2, 3):
                self.fail(place, f"{len(numbers)} coordinates; give x and y")
            if any(numbers[2:]):
                self.fail(f"{place}[2]", f"z is {numbers[2]:g}; a crease pattern lies flat, with z = 0")
            points.append(numbers[:2])
        return points_array(np.array(points, dtype=np.float64).reshape(-1, 2) * unit_mm)

    def folded(self, vertex_count: int, unit_mm: float) -> Floats | None:
        """Return the places of the vertices in the first folded frame that is flat and has as many vertices."""
        for place, frame in islice(self.frames(), 1, None):
            rows = frame.get("vertices_coords")
            if isinstance(rows, list) and len(rows) == vertex_count:
                try:
                    return self.points(self.rows_of(f"{place}vertices_coords", rows), unit_mm)
                except FileFormatError as error:
                    self.notes.append(f"{error}: that folded frame is left out")
        return None

    def point_lists(self, name: str, unit_mm: float, least: int) -> tuple[Floats, ...] | None:
        """Return lists with at least ``least`` points each, or None if the file does not have this entry."""
        if name not in self.data:
            return None
        lists = tuple(self.points(self.rows_of(place, row), unit_mm) for place, row in self.rows(name))
        for at, points in enumerate(lists):
            if len(points) < least:
                self.fail(f"{name}[{at}]", f"{len(points)} points; give at least {least}")
        return lists

    def edges(self, vertex_count: int) -> Ints:
        edges = []
        for place, row in self.rows("edges_vertices"):
            ends = self.indices(place, row, vertex_count)
            if len(ends) != 2:
                self.fail(place, f"{len(ends)} vertices; an edge has two")
            edges.append(ends)
        return index_array(np.array(edges, dtype=np.int32).reshape(-1, 2))

    def assignment(self, edge_count: int) -> Chars:
        if "edges_assignment" not in self.data:
            self.fail("edges_assignment", "missing; assign B, M, V, F or U to every edge")
        letters = self.data["edges_assignment"]
        if not isinstance(letters, list) or len(letters) != edge_count:
            self.fail("edges_assignment", f"must be a list of one letter for each of the {edge_count} edges")
        for at, letter in enumerate(letters):
            if letter in ("C", "J"):
                what = "cuts (C)" if letter == "C" else "joins (J)"
                self.fail(f"edges_assignment[{at}]", f"{what} in the sheet are not supported; leave them out")
            if letter not in ASSIGNMENTS:
                self.fail(f"edges_assignment[{at}]", f"{letter!r} is not one of B, M, V, F, U")
        assignment = np.array(letters, dtype="<U1")
        assignment.setflags(write=False)
        return assignment

    def faces(self, coords: Floats) -> tuple[Ragged, Bools]:
        """Return the faces, counter-clockwise, and which of them are clockwise in the file."""
        rows = []
        for place, row in self.rows("faces_vertices"):
            outline = self.indices(place, row, len(coords))
            if len(outline) < 3:
                self.fail(place, f"{len(outline)} vertices; a face has at least three")
            rows.append(outline)
        clockwise = signed_areas(coords, Ragged.from_rows(rows)) < 0
        turned = zip(rows, clockwise, strict=True)
        return Ragged.from_rows(outline[::-1] if back else outline for outline, back in turned), clockwise

    def layers(self, pattern: CreasePattern, turned: Bools) -> Ints | None:
        """Return the layer order: foldcut's own entry, or else an order that agrees with the first faceOrders."""
        count = len(pattern.faces_vertices)
        if "foldcut:layers" in self.data:
            layers = self.indices("foldcut:layers", self.data["foldcut:layers"], count)
            if len(layers) != count or len(set(layers)) != count:
                self.fail("foldcut:layers", f"must name each of the {count} faces once")
            return index_array(layers)
        for place, frame in self.frames():
            if "faceOrders" not in frame:
                continue
            own = frame.get("faces_vertices", self.data["faces_vertices"])
            if own == self.data["faces_vertices"]:
                return self.sorted_layers(f"{place}faceOrders", frame["faceOrders"], pattern, turned)
            self.notes.append(f"{place}faceOrders: left out, since that frame has other faces")
        return None

    def frames(self) -> Iterator[tuple[str, dict[str, Any]]]:
        """Yield the key frame, then every folded frame."""
        yield "", self.data
        frames = self.data.get("file_frames", [])
        if not isinstance(frames, list):
            self.fail("file_frames", "must be a list of frames")
        for at, frame in enumerate(frames):
            if not isinstance(frame, dict):
                self.fail(f"file_frames[{at}]", "must be an object")
            classes = frame.get("frame_classes", [])
            if isinstance(classes, list) and "foldedForm" in classes:
                yield f"file_frames[{at}].", frame

    def sorted_layers(self, place: str, orders: object, pattern: CreasePattern, turned: Bools) -> Ints:
        """Return a linear order of all faces, bottom to top, that agrees with ``orders``.

        ``[f, g, s]`` says that f lies on the side of g that the normal of g points to (s = 1), or on the other side
        (s = -1). Faces that nothing compares come in the order of their numbers. ``turned`` are the faces that the file
        has clockwise, so that their normals point the other way.
        """
        if not isinstance(orders, list):
            self.fail(place, "must be a list")
        up = fold_faces(pattern, edge_faces(pattern)).up != turned
        count = len(pattern.faces_vertices)
        above: list[list[int]] = [[] for _ in range(count)]
        below = [0] * count
        for at, row in enumerate(orders):
            here = f"{place}[{at}]"
            if not isinstance(row, list) or len(row) != 3:
                self.fail(here, "must be [face, face, 1, 0 or -1]")
            f, g = self.indices(here, row[:2], count)
            if type(row[2]) is not int or row[2] not in (-1, 0, 1):
                self.fail(f"{here}[2]", f"{row[2]!r} is not 1, 0 or -1")
            if row[2]:
                low, high = (g, f) if (row[2] > 0) == up[g] else (f, g)
                above[low].append(high)
                below[high] += 1
        ready = [face for face in range(count) if not below[face]]
        heapify(ready)
        layers = []
        while ready:
            face = heappop(ready)
            layers.append(face)
            for over in above[face]:
                below[over] -= 1
                if not below[over]:
                    heappush(ready, over)
        if len(layers) < count:
            faces = ", ".join(map(str, _circle(above, below)))
            self.fail(place, f"circular: faces {faces} each lie on the one before; give an order without circles")
        return index_array(layers)

    def placement(self) -> Placement | None:
        place = "foldcut:placement"
        if place not in self.data:
            return None
        matrix = [self.numbers(here, row) for here, row in self.rows(place)]
        if [len(row) for row in matrix] != [3, 3]:
            self.fail(place, "must be a 2 x 3 matrix")
        array = np.array(matrix)
        array.setflags(write=False)
        return Placement(array)

    def rows(self, name: str) -> Iterator[tuple[str, list[Any]]]:
        """Yield the place in the file and the row, for each row of an entry that is a list of lists."""
        rows = self.data.get(name)
        if not isinstance(rows, list):
            self.fail(name, "missing" if rows is None else "must be a list of lists")
        return self.rows_of(name, rows)

    def rows_of(self, name: str, rows: list[Any]) -> Iterator[tuple[str, list[Any]]]:
        """Yield the place in the file and the row, for each of these rows."""
        for at, row in enumerate(rows):
            if not isinstance(row, list):
                self.fail(f"{name}[{at}]", "must be a list")
            yield f"{name}[{at}]", row

    def numbers(self, place: str, row: list[Any]) -> list[float]:
        for at, number in enumerate(row):
            if type(number) not in (int, float) or not abs(number) < 1e15:
                self.fail(f"{place}[{at}]", f"{number!r} is not a number below 1e15")
        return [float(number) for number in row]

    def indices(self, place: str, row: object, count: int) -> list[int]:
        if not isinstance(row, list):
            self.fail(place, "must be a list")
        for at, index in enumerate(row):
            if type(index) is not int or not 0 <= index < count:
                self.fail(f"{place}[{at}]", f"{index!r} is not a number from 0 to {count - 1}")
        return row


def _circle(above: list[list[int]], below: list[int]) -> list[int]:
    """Return a circle of faces: each lies on the one before, and the first on the last."""
    under = {over: face for face, overs in enumerate(above) if below[face] for over in overs if below[over]}
    walk = [next(iter(under))]
    while under[walk[-1]] not in walk:
        walk.append(under[walk[-1]])
    return walk[walk.index(under[walk[-1]]) :][::-1]
