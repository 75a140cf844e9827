"""A crease pattern of anybody's, solved and proven, as what exporters take.

Crease pattern that folds flat -> ``FoldedPattern`` without a shape: no cut goes with it. Lines that stay flat are left
out, the sheet is moved into the corner, and the layers are put into one list; where they lie on each other in circles,
there is none, and only formats without layers can be written.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from foldcut.core.arrays import Floats, Indices, Ints, index_array, sealed
from foldcut.core.errors import BadInputError, UnfoldableError
from foldcut.core.model import CreasePattern, Finding, FoldedPattern, FoldedState, Placement, Shape, Sheet
from foldcut.drawing.placement import SHEET_LIMITS_MM
from foldcut.foldfile.decide import Decision, decide
from foldcut.foldfile.lines import pattern_of_edges
from foldcut.foldfile.read import FoldFile
from foldcut.geometry.planar_graph import edge_faces, signed_areas
from foldcut.layer_orders.orders import find_list, layers_of
from foldcut.pattern.face_maps import fold_faces
from foldcut.proof.tolerance import COINCIDENT
from foldcut.proof.verify import verify

__all__ = [
    "CIRCULAR",
    "Solved",
    "as_json",
    "completed",
    "face_orders_of",
    "is_rectangle",
    "solve",
    "without_flat_lines",
]

LOOSE = (1e-4, 1e-5, 1e-6, 1e-7)
"""The list of layers is proven with one of these tolerances, relative to the sheet's diagonal, if not a finer one."""

RECTANGULAR = 1e-6
"""The sheet is a rectangle if the faces cover all of its box but this part of it."""

CIRCULAR = "its layers lie on each other in a circle, so there is no list of layers from bottom to top"


@dataclass(frozen=True, eq=False)
class Solved:
    """A pattern that folds flat, in mm from the sheet's lower left corner; ``in_a_circle``: it has no list of layers.

    ``folded_pattern.folded.layers`` is then any order of the faces, and nothing that shows layers may be made of it.
    ``pairs`` ``(n, 2)``: the faces that lie on each other, the upper one first. ``repaired_by``: how far vertices were
    moved so that their angles fold flat, in mm.
    """

    folded_pattern: FoldedPattern
    pairs: Indices
    in_a_circle: bool
    repaired_by: float


def without_flat_lines(file: FoldFile) -> FoldFile:
    """Return a pattern without the lines that stay flat, with faces traced anew; its layer order is left out too."""
    pattern = file.pattern
    kept = pattern.edges_assignment != "F"
    if kept.all():
        return file
    bare = pattern_of_edges(pattern.vertices_coords, pattern.edges_vertices[kept], pattern.edges_assignment[kept])
    return FoldFile(bare, None, None, file.unit_mm, file.notes, file.title, repaired_by=file.repaired_by)


def solve(file: FoldFile, tolerance: float, width_mm: float | None = None) -> tuple[Solved | None, Decision]:
    """Return the solved pattern, or None if it does not fold flat or that is not decided, and the decision.

    ``width_mm``: the sheet is made as wide as this. Raises ``BadInputError`` if the sheet is too small or too large.
    """
    file = without_flat_lines(file)
    decision = decide(file, None, tolerance)
    if not decision.folds:
        return None, decision
    pattern, layers = _with_list(file, decision)
    pairs = np.empty((0, 2), dtype=np.intp) if decision.pairs is None else decision.pairs
    in_a_circle = layers is None
    coords = pattern.vertices_coords - pattern.vertices_coords.min(axis=0)
    scale = 1.0 if width_mm is None else width_mm / float(coords[:, 0].max())
    coords = coords * scale
    pattern = replace(pattern, vertices_coords=sealed(coords))
    sheet = Sheet(*coords.max(axis=0).tolist())
    shortest, longest = SHEET_LIMITS_MM
    if not (shortest <= min(sheet.width, sheet.height) and max(sheet.width, sheet.height) <= longest):
        raise BadInputError(
            f"the sheet is {sheet} large; sheets have sides between {shortest:g} and {longest:g} mm: say how wide it "
            "is with --width, such as --width 150mm"
        )
    count = len(pattern.faces_vertices)
    any_order = np.arange(count, dtype=np.int32) if layers is None else layers
    folded = FoldedState(_landed(pattern), index_array(any_order))
    placement = Placement(np.array([(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]))
    made = FoldedPattern(pattern, folded, sheet, Shape((), ()), placement, file.title)
    moved_mm = file.repaired_by if decision.moved is None else decision.moved.most
    return Solved(made, pairs, in_a_circle, scale * moved_mm), decision


def _with_list(file: FoldFile, decision: Decision) -> tuple[CreasePattern, Ints | None]:
    """Return the pattern and a list of its layers that is proven, None if it has none."""
    pattern = decision.pattern
    if decision.pairs is None:  # as the file says
        return pattern, file.layers
    layers = layers_of(decision.pairs, len(pattern.faces_vertices))
    if layers is None:
        free = file.pattern.edges_assignment == "U"
        letters = np.where(free & (pattern.edges_assignment != "F"), "U", pattern.edges_assignment)
        assert decision.tolerance is not None
        found = find_list(replace(pattern, edges_assignment=letters), decision.tolerance)
        if found is None:
            return pattern, None
        pattern, layers = found
    findings: list[Finding] = verify(pattern, layers, None, (*LOOSE, *COINCIDENT))
    if findings:
        raise UnfoldableError(f"the list of layers is not proven: {findings[0]}; give coordinates with more digits")
    return pattern, layers


def _landed(pattern: CreasePattern) -> Floats:
    """Return where the vertices land, ``(v, 2)``, with face 0 as it lies on the sheet."""
    maps = fold_faces(pattern, edge_faces(pattern))
    face = np.zeros(len(pattern.vertices_coords), dtype=np.int32)
    face[pattern.faces_vertices.values] = pattern.faces_vertices.rows
    return sealed(maps.apply(face, pattern.vertices_coords))


def is_rectangle(solved: Solved) -> bool:
    """Whether the sheet is a rectangle, as machines and printers have it."""
    creases, sheet = solved.folded_pattern.creases, solved.folded_pattern.sheet
    area = float(signed_areas(creases.vertices_coords, creases.faces_vertices).sum())
    return abs(area - sheet.width * sheet.height) <= RECTANGULAR * sheet.width * sheet.height


def completed(data: bytes, solved: Solved) -> bytes:
    """Return a FOLD file with what its exporter does not know of.

    That is by how much vertices were moved and, of a pattern whose layers are in a circle, the order of pairs in place
    of the list.
    """
    if not solved.in_a_circle and not solved.repaired_by:
        return data
    document = json.loads(data)
    if solved.repaired_by:
        document["foldcut:repairedBy"] = solved.repaired_by
    if solved.in_a_circle:
        document["faceOrders"] = face_orders_of(solved.folded_pattern.creases, solved.pairs)
        document.pop("foldcut:layers")
    return as_json(document)


def face_orders_of(creases: CreasePattern, pairs: Indices) -> list[list[int]]:
    """Return the rows of ``faceOrders`` for pairs of faces, the upper one first."""
    up = fold_faces(creases, edge_faces(creases)).up
    upper, lower = pairs.T
    orders: list[list[int]] = np.column_stack([upper, lower, np.where(up[lower], 1, -1)]).tolist()
    return orders


def as_json(document: dict[str, Any]) -> bytes:
    """Return a JSON object with one line for each key."""
    lines = [f"{json.dumps(key)}: {json.dumps(value)}" for key, value in document.items()]
    return ("{\n" + ",\n".join(lines) + "\n}\n").encode()
