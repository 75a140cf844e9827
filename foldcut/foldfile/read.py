"""Read any FOLD file: its crease pattern, and its layer order if it has one.

FOLD file -> ``FoldFile``, lengths in mm. The first frame, called the key frame, is the crease pattern, or else the
first of the other frames that is one (``frames``); a file that has a folded form only is unfolded. Folded frames are
read for a layer order, and for the places of the vertices if these are the same. Faces are traced from the edges if
the file has none. foldcut's own keys (see ``exporters/pattern/fold.py``) are read if they are there. Only the form is
checked: whether the pattern folds is for ``verify`` to say. (FOLD specification 1.1 and 1.2.)
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from heapq import heapify, heappop, heappush
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from foldcut.core.arrays import Bools, Chars, Floats, Ints, Ragged, index_array, points_array, sealed
from foldcut.core.errors import FileFormatError, TouchError
from foldcut.core.files import is_standard_input, read_bytes
from foldcut.core.model import CreasePattern, Placement, Shape
from foldcut.core.text import as_title
from foldcut.core.units import MM_PER_UNIT
from foldcut.drawing.graph import make_graph, shape_of_parts
from foldcut.drawing.limits import Limits
from foldcut.drawing.shape import make_shape
from foldcut.foldfile.claims import Claims, read_claims
from foldcut.foldfile.frames import is_folded_form, with_pattern_first
from foldcut.foldfile.parts import LARGEST, fail, indices, numbers, rows_of, shown
from foldcut.geometry.planar_graph import edge_faces, signed_areas, trace_faces
from foldcut.pattern.face_maps import fold_faces
from foldcut.readers.apart import apart
from foldcut.readers.base import decoded, why_not_json

__all__ = ["FoldFile", "read_fold", "read_fold_apart"]

LARGEST_FILE = 128 * 2**20
"""The size of the largest file, in bytes. 20,000 creases take 4 million, and two million face orders ten times that."""

UNITS_MM = {
    **{unit: MM_PER_UNIT[unit] for unit in ("mm", "cm", "in", "pt")},
    **{"m": 1e3, "um": 1e-3, "nm": 1e-6, "unit": 1.0},
}
"""Millimetres per ``frame_unit``; a bare "unit" is taken as 1 mm."""

SIMILAR = 1e-9
"""How far the two axes of a placement may be from equally long and from a right angle, relative to their length."""

SMALLEST_SCALE = 1e-15
"""Fewer mm a unit than this make a point of any drawing."""

ASSIGNMENTS = ("B", "M", "V", "F", "U", "C", "J")
"""The assignments that are read: border, mountain, valley, flat, unassigned, cut, join."""


@dataclass(frozen=True, eq=False)
class FoldFile:
    """What a FOLD file says, in mm; whatever it does not say is None.

    ``layers`` ``(f,)`` are face numbers from bottom to top. ``folded`` ``(v, 2)`` are the places of the vertices in the
    first folded frame. ``placement``, ``loops`` (the shape on the sheet), ``first_folds`` and ``drawn`` (the drawing
    there) are foldcut's own entries.
    ``unit_mm`` is the length that was assumed for the unit of the file. ``notes`` say what was left out or assumed.
    ``repaired_by``: how many mm the vertices were moved, at most, so that their angles fold flat, as the file says.
    ``claims`` are all the other fields about the pattern; ``turned`` ``(f,)``: which faces the file has clockwise;
    ``own_layers``: whether ``layers`` are foldcut's own entry and not sorted from faceOrders. ``moved_by``: by how
    many mm ``loops`` were moved from the drawing, as the file says. ``lines``: what the cut follows besides ``loops``,
    on the sheet.
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
    claims: Claims = field(default_factory=Claims)
    turned: Bools | None = None
    own_layers: bool = False
    moved_by: float | None = None
    repaired_by: float = 0.0
    lines: tuple[Floats, ...] = ()

    @property
    def shape(self) -> Shape | None:
        """The shape on the sheet, if the file says what the cut cuts; raises ``ShapeError`` where it is none."""
        loops = self.loops or ()
        if not loops and not self.lines:
            return None
        if not self.lines:
            try:
                return make_shape(loops)
            except TouchError:
                pass
        make_graph(loops, self.lines)  # refuses what is no graph
        return shape_of_parts(loops, self.lines)


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


def read_fold_apart(path: Path | str) -> FoldFile:
    """Do as ``read_fold``, in a process of its own with as much time and memory as a file of this size may take."""
    return read_apart(read_fold, Path(path))


def read_apart(read: Callable[[Path], FoldFile], path: Path) -> FoldFile:
    """Read a pattern by a function, in a process of its own, as ``read_fold_apart`` does."""
    usual = Limits()
    size = path.stat().st_size if path.is_file() else LARGEST_FILE
    share = max(1, math.ceil(size / usual.bytes))
    limits = replace(usual, seconds=share * usual.seconds, megabytes=share * usual.megabytes)
    return apart(lambda: read(path), limits, str(path), option=False)


def _load(path: Path) -> dict[str, Any]:
    """Return the JSON object in a file."""
    limit = f"{LARGEST_FILE / 2**20:.0f} MiB"
    if not is_standard_input(path) and (size := path.stat().st_size) > LARGEST_FILE:
        raise FileFormatError(f"the file has {size / 2**20:.0f} MiB; give one of at most {limit}")
    data = read_bytes(path, LARGEST_FILE)
    if len(data) > LARGEST_FILE:
        raise FileFormatError(f"the file has more than {limit}; give a smaller one")

    def refuse(name: str) -> NoReturn:
        raise ValueError(f"{name} is not a JSON number")

    text = decoded(data)
    try:
        parsed = json.loads(text, parse_constant=refuse)
    except (ValueError, RecursionError) as error:
        raise FileFormatError(f"not JSON, as a FOLD file has to be: {why_not_json(error)}") from None
    if not isinstance(parsed, dict):
        raise FileFormatError(f"a FOLD file holds one JSON object, not a {type(parsed).__name__}")
    return parsed


class _Reader:
    """Reads one file, whose JSON object is ``data``, and collects notes."""

    def __init__(self, data: dict[str, Any]) -> None:
        self.data, self.notes = with_pattern_first(data)

    def read(self) -> FoldFile:
        unit_mm = self.unit()
        coords = self.vertices(unit_mm)
        edges = self.edges(len(coords))
        given = "faces_vertices" in self.data
        if is_folded_form(self.data):
            coords = self.unfolded(coords, edges)
        if given:
            faces, turned = self.faces(coords)
        else:
            faces = trace_faces(coords, edges)
            turned = np.zeros(len(faces), dtype=np.bool_)
        if not len(faces):
            fail("faces_vertices" if given else "edges_vertices", "there are no faces; close the border")
        pattern = CreasePattern(coords, edges, self.assignment(coords, edges, faces), faces)
        claims = self.claims(pattern, given=given)
        if given:
            layers = self.layers(pattern, claims, turned)
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
            next((points_array(places * unit_mm) for places in claims.folded.values()), None),
            self.point_lists("foldcut:shape", unit_mm, least=3),
            self.point_lists("foldcut:firstFolds", unit_mm, least=2),
            self.point_lists("foldcut:drawn", unit_mm, least=3),
            claims,
            turned,
            given and "foldcut:layers" in self.data,
            self.length("foldcut:movedBy"),
            self.length("foldcut:repairedBy") or 0.0,
            self.point_lists("foldcut:lines", unit_mm, least=2) or (),
        )

    def claims(self, pattern: CreasePattern, *, given: bool) -> Claims:
        """Return what the fields beside the creases say; without ``given`` faces, what is about faces is left out."""
        counts = {
            "vertices": len(pattern.vertices_coords),
            "edges": len(pattern.edges_vertices),
            "faces": len(pattern.faces_vertices),
        }
        frames = self.frames()
        if not given:
            about_faces = {name for _, frame in self.frames() for name in frame if "face" in name}
            frames = (
                (place, {name: value for name, value in frame.items() if name not in about_faces})
                for place, frame in self.frames()
            )
        claims, notes = read_claims(frames, counts)
        self.notes += notes
        return claims

    def unit(self) -> float:
        """Return how many mm one unit is."""
        unit = self.data.get("frame_unit", "unit")
        if not isinstance(unit, str) or unit not in UNITS_MM:
            fail("frame_unit", f"{shown(unit)} is not one of {', '.join(UNITS_MM)}")
        if unit == "unit":
            self.notes.append("no unit of length is given; one unit is taken as 1 mm")
        return UNITS_MM[unit]

    def title(self) -> str:
        title = self.data.get("file_title", "")
        return as_title(title) if isinstance(title, str) else ""

    def vertices(self, unit_mm: float) -> Floats:
        return self.points(self.rows("vertices_coords"), unit_mm)

    def points(self, rows: Iterator[tuple[str, list[Any]]], unit_mm: float) -> Floats:
        points = []
        for place, row in rows:
            point = numbers(place, row)
            if len(point) not in (2, 3):
                fail(place, f"{len(point)} coordinates; give x and y")
            if any(point[2:]):
                fail(f"{place}[2]", f"z is {point[2]:g}; a crease pattern lies flat, with z = 0")
            points.append(point[:2])
        return points_array(np.array(points, dtype=np.float64).reshape(-1, 2) * unit_mm)

    def point_lists(self, name: str, unit_mm: float, least: int) -> tuple[Floats, ...] | None:
        """Return lists with at least ``least`` points each, or None if the file does not have this entry."""
        if name not in self.data:
            return None
        lists = tuple(self.points(rows_of(place, row), unit_mm) for place, row in self.rows(name))
        for at, points in enumerate(lists):
            if len(points) < least:
                fail(f"{name}[{at}]", f"{len(points)} points; give at least {least}")
        return lists

    def edges(self, vertex_count: int) -> Ints:
        edges = []
        for place, row in self.rows("edges_vertices"):
            ends = indices(place, row, vertex_count)
            if len(ends) != 2:
                fail(place, f"{len(ends)} vertices; an edge has two")
            edges.append(ends)
        return index_array(np.array(edges, dtype=np.int32).reshape(-1, 2))

    def letters(self, edge_count: int) -> Chars | None:
        """Return the assignments as the file has them, or None if it has none."""
        if "edges_assignment" not in self.data:
            return None
        letters = self.data["edges_assignment"]
        if not isinstance(letters, list) or len(letters) != edge_count:
            fail("edges_assignment", f"must be a list of one letter for each of the {edge_count} edges")
        for at, letter in enumerate(letters):
            if letter not in ASSIGNMENTS:
                fail(f"edges_assignment[{at}]", f"{shown(letter)} is not one of B, M, V, F, U, C, J")
        return np.array(letters, dtype="<U1")

    def assignment(self, coords: Floats, edges: Ints, faces: Ragged) -> Chars:
        """Return the assignment of every edge.

        Where the file has no letters, or U, the fold angles say it. Joins (J) are flat, and cuts (C) that have a face
        on one side only are the border.
        """
        found = self.letters(len(edges))
        letters = np.full(len(edges), "U", dtype="<U1") if found is None else found
        outer = (edge_faces(CreasePattern(coords, edges, letters, faces)) < 0).any(axis=1)
        if found is None:
            letters[outer] = "B"
        angles = self.data.get("edges_foldAngle")
        if isinstance(angles, list) and len(angles) == len(edges):
            for edge in np.flatnonzero(letters == "U").tolist():
                angle = angles[edge]
                if type(angle) in (int, float) and (found is None or angle):
                    letters[edge] = "V" if angle > 0 else "M" if angle < 0 else "F"
        if found is None:
            by = "edges_foldAngle" if angles else "its faces: mountains and valleys are not known"
            self.notes.append(f"edges_assignment is missing: it is taken from {by}")
        letters[letters == "J"] = "F"
        letters[(letters == "C") & outer] = "B"
        letters.setflags(write=False)
        return letters

    def unfolded(self, folded: Floats, edges: Ints) -> Floats:
        """Return the vertices of a folded form on the flat sheet: folding it once more along its creases unfolds it."""
        if "faces_vertices" not in self.data:
            fail("faces_vertices", "missing; a folded form has to name its faces, or give the crease pattern as well")
        letters = self.letters(len(edges))
        if letters is None:
            fail("edges_assignment", "missing; a folded form has to say which edges are creases")
        rows = [indices(place, row, len(folded)) for place, row in self.rows("faces_vertices")]
        if not rows or min(map(len, rows)) < 3:
            fail("faces_vertices", "a face has at least three vertices, and there has to be one")
        creases = np.where(letters == "U", "M", letters)
        form = CreasePattern(folded, edges, creases, Ragged.from_rows(rows))
        face = np.zeros(len(folded), dtype=np.int32)
        face[form.faces_vertices.values] = form.faces_vertices.rows
        flat = fold_faces(form, edge_faces(form)).apply(face, folded)
        turned = signed_areas(flat, form.faces_vertices).sum() < 0
        self.notes.append("the file has the folded form only: the crease pattern is unfolded from it")
        return points_array(flat * (-1, 1) if turned else flat)

    def faces(self, coords: Floats) -> tuple[Ragged, Bools]:
        """Return the faces, counter-clockwise, and which of them are clockwise in the file."""
        rows = []
        for place, row in self.rows("faces_vertices"):
            outline = indices(place, row, len(coords))
            if len(outline) < 3:
                fail(place, f"{len(outline)} vertices; a face has at least three")
            rows.append(outline)
        clockwise = signed_areas(coords, Ragged.from_rows(rows)) < 0
        turned = zip(rows, clockwise, strict=True)
        return Ragged.from_rows(outline[::-1] if back else outline for outline, back in turned), clockwise

    def layers(self, pattern: CreasePattern, claims: Claims, turned: Bools) -> Ints | None:
        """Return the layer order: foldcut's own entry, or else an order that agrees with the first faceOrders."""
        count = len(pattern.faces_vertices)
        if "foldcut:layers" in self.data:
            layers = indices("foldcut:layers", self.data["foldcut:layers"], count)
            if len(layers) != count or len(set(layers)) != count:
                fail("foldcut:layers", f"must name each of the {count} faces once")
            self.notes += [
                f"{place} is empty: other programs find no layer order there"
                for place, orders in claims.orders.items()
                if not len(orders) and count > 1
            ]
            return index_array(layers)
        for place, orders in claims.orders.items():
            return self.sorted_layers(place, orders, pattern, turned)
        return None

    def frames(self) -> Iterator[tuple[str, dict[str, Any]]]:
        """Yield the key frame, then every folded frame."""
        yield "", self.data
        frames = self.data.get("file_frames", [])
        if not isinstance(frames, list):
            fail("file_frames", "must be a list of frames")
        for at, frame in enumerate(frames):
            if not isinstance(frame, dict):
                fail(f"file_frames[{at}]", "must be an object")
            classes = frame.get("frame_classes", [])
            if isinstance(classes, list) and "foldedForm" in classes:
                yield f"file_frames[{at}].", frame

    def sorted_layers(self, place: str, orders: Ints, pattern: CreasePattern, turned: Bools) -> Ints | None:
        """Return a linear order of all faces, bottom to top, that agrees with ``orders``.

        ``[f, g, s]`` says that f lies on the side of g that the normal of g points to (s = 1), or on the other side
        (s = -1). Faces that nothing compares come in the order of their numbers. None means that they lie in a circle.
        ``turned`` are the faces that the file has clockwise, so that their normals point the other way.
        """
        up = fold_faces(pattern, edge_faces(pattern)).up != turned
        count = len(pattern.faces_vertices)
        above: list[list[int]] = [[] for _ in range(count)]
        below = [0] * count
        for f, g, side in orders.tolist():
            if side:
                low, high = (g, f) if (side > 0) == up[g] else (f, g)
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
            circle = _circle(above, below)
            faces = ", ".join(map(str, circle))
            if len(circle) < 3:
                fail(place, f"circular: faces {faces} each lie on the one before; give an order without circles")
            self.notes.append(f"{place}: faces {faces} each lie on the one before: they are judged pair by pair")
            return None
        return index_array(layers)

    def placement(self) -> Placement | None:
        place = "foldcut:placement"
        if place not in self.data:
            return None
        matrix = [numbers(here, row) for here, row in self.rows(place)]
        if [len(row) for row in matrix] != [3, 3]:
            fail(place, "must be a 2 x 3 matrix")
        array = sealed(np.array(matrix))
        (a, b), (c, d) = array[:, :2].tolist()
        one, other = math.hypot(a, c), math.hypot(b, d)
        if (
            not SMALLEST_SCALE < one < LARGEST
            or abs(one - other) > SIMILAR * one
            or abs(a * b + c * d) > SIMILAR * one**2
        ):
            fail(
                place,
                f"is no similarity: {one:.6g} and {other:.6g} mm a unit along the drawing's axes, which must be equal, "
                "above 0 and at right angles",
            )
        return Placement(array)

    def length(self, name: str) -> float | None:
        """Return an entry that is a length in mm, or None if the file does not have it."""
        if name not in self.data:
            return None
        (length,) = numbers(name, [self.data[name]])
        if length < 0:
            fail(name, f"{length:g} is not a length in mm from 0 up")
        return length

    def rows(self, name: str) -> Iterator[tuple[str, list[Any]]]:
        """Yield the place in the file and the row, for each row of an entry that is a list of lists."""
        return rows_of(name, self.data.get(name))


def _circle(above: list[list[int]], below: list[int]) -> list[int]:
    """Return a circle of faces: each lies on the one before, and the first on the last."""
    under = {over: face for face, overs in enumerate(above) if below[face] for over in overs if below[over]}
    face, walk = next(iter(under)), dict[int, int]()
    while face not in walk:
        walk[face] = len(walk)
        face = under[face]
    return list(walk)[walk[face] :][::-1]
