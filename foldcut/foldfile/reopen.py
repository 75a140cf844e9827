"""Reopen a finished pattern: what foldcut wrote to a FOLD file comes back as it was, and is verified anew.

``FoldFile`` -> ``Reopened``. Nothing in the file is taken on trust: ``judge`` checks all that other programs read, and
the cut must lie along y = 0 of the folded form, with the shape above it. What else foldcut wrote there, first folds and
the drawing, is proven or left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.errors import BadInputError
from foldcut.core.model import CreasePattern, Finding, FoldedPattern, FoldedState, Shape, Sheet
from foldcut.drawing.placement import SHEET_LIMITS_MM
from foldcut.foldfile.first_folds import why_not_first
from foldcut.foldfile.judge import judge
from foldcut.foldfile.read import FoldFile
from foldcut.geometry.planar_graph import edge_faces, signed_areas
from foldcut.jobs.last_door import DRAWN_BEYOND
from foldcut.pattern.cut_line import contains, fold_boundary
from foldcut.pattern.face_maps import fold_faces
from foldcut.proof.tolerance import COINCIDENT

__all__ = ["Reopened", "reopen"]

Loops = tuple[Floats, ...]
"""Lines or closed loops on the sheet, ``(n, 2)`` mm each."""


@dataclass(frozen=True, eq=False)
class Reopened:
    """A pattern that was read, what verification found, and the notes of the reader."""

    folded_pattern: FoldedPattern
    findings: tuple[Finding, ...]
    notes: tuple[str, ...]

    @property
    def verified(self) -> bool:
        """Whether verification found nothing wrong."""
        return not self.findings


def reopen(file: FoldFile) -> Reopened:
    """Return the pattern of a FOLD file that foldcut wrote, verified.

    Raises ``BadInputError`` for a file that does not say how the sheet lies when folded, or what the cut cuts out; the
    error names what is missing.
    """
    creases = file.pattern
    missing = {
        "foldcut:layers or faceOrders, which face lies on which": file.layers,
        "foldedForm frame, where the vertices land": file.folded,
        "foldcut:shape, what the cut cuts out": file.loops or file.lines or None,
        "foldcut:placement, where the drawing lies on the sheet": file.placement,
    }
    absent = [what for what, value in missing.items() if value is None]
    shape = file.shape
    if file.layers is None or file.folded is None or shape is None or file.placement is None:
        raise BadInputError(
            f"the file has no {'; no '.join(absent)}. Only FOLD files that foldcut wrote have these and can be "
            "reopened; `foldcut check` judges any crease pattern, and `foldcut solve` writes it"
        )
    sheet = _sheet(creases)
    findings = judge(file, shape) or _check_folded(creases, file.folded, shape, sheet)
    folded = FoldedState(file.folded, file.layers)
    first: Loops = ()
    drawn: Loops = ()
    notes = file.notes
    if not findings:
        first, about_first = _proven_first_folds(creases, sheet, file.first_folds or ())
        drawn, about_drawn = _shown_drawing(sheet, file.drawn or ())
        notes += about_first + about_drawn
    pattern = FoldedPattern(
        creases, folded, sheet, shape, file.placement, file.title, first, drawn=drawn, moved_by=file.moved_by
    )
    return Reopened(pattern, tuple(findings), notes)


def _proven_first_folds(creases: CreasePattern, sheet: Sheet, lines: Loops) -> tuple[Loops, tuple[str, ...]]:
    """Return the first folds of a file and no note, or none and a note that says why."""
    why = why_not_first(creases, sheet, lines)
    return ((), (f"foldcut:firstFolds is left out: {why}",)) if why else (lines, ())


def _shown_drawing(sheet: Sheet, loops: Loops) -> tuple[Loops, tuple[str, ...]]:
    """Return the drawing of a file, which is shown beside the outline, and no note, or none of it and why."""
    points = np.concatenate([np.zeros((0, 2)), *loops])
    beyond = DRAWN_BEYOND * sheet.diagonal
    if (points < -beyond).any() or (points > np.array([sheet.width, sheet.height]) + beyond).any():
        return (), ("foldcut:drawn is left out: it is not on the sheet",)
    return loops, ()


def _sheet(creases: CreasePattern) -> Sheet:
    """Return the rectangle that the faces cover; raises ``BadInputError`` if they do not cover one from (0, 0)."""
    least, most = creases.vertices_coords.min(axis=0), creases.vertices_coords.max(axis=0)
    sheet = Sheet(*most.tolist())
    shortest, longest = SHEET_LIMITS_MM
    if not (shortest <= min(most) and max(most) <= longest):
        raise BadInputError(
            f"the sheet is {sheet} large; foldcut folds sheets with sides between {shortest:g} and {longest:g} mm: "
            "check frame_unit"
        )
    slack = COINCIDENT[0] * sheet.diagonal
    area = float(signed_areas(creases.vertices_coords, creases.faces_vertices).sum())
    if (np.abs(least) > slack).any() or abs(area - sheet.width * sheet.height) > slack * sheet.diagonal:
        raise BadInputError(
            "the sheet is not a rectangle with its lower left corner at (0, 0), as those of foldcut are"
        )
    return sheet


def _check_folded(creases: CreasePattern, folded: Floats, shape: Shape, sheet: Sheet) -> list[Finding]:
    """Find a vertex that is not where the creases put it, or a cut that is not along y = 0 with the shape above it."""
    tolerance = 2 * COINCIDENT[0] * sheet.diagonal
    maps = fold_faces(creases, edge_faces(creases))
    face = np.zeros(len(folded), dtype=np.int32)
    face[creases.faces_vertices.values] = creases.faces_vertices.rows
    ours, theirs = _complex(maps.apply(face, creases.vertices_coords)), _complex(folded)
    centre, there = ours.mean(), theirs.mean()
    turn = np.vdot(ours - centre, theirs - there)
    turn = turn / abs(turn) if abs(turn) else 1.0
    off = np.abs(turn * (ours - centre) + there - theirs)
    if off.max() > tolerance:
        vertex = int(off.argmax())
        x, y = creases.vertices_coords[vertex].tolist()
        message = f"the folded form has vertex {vertex} {off[vertex]:.3g} mm from where the creases put it"
        return [Finding("folded form", message, (x, y), float(off[vertex]))]
    _, _, landed = fold_boundary(creases, maps, shape, tolerance)
    heights = (turn * (_complex(landed.reshape(-1, 2)) - centre) + there).imag
    highest = np.abs(folded[:, 1]).argmax()
    above = (folded[highest, 1] > 0) == contains(shape, creases.vertices_coords[[highest]])[0]
    if np.abs(heights).max() > tolerance or not above:
        return [Finding("folded form", "the cut does not lie along y = 0 with the shape above it")]
    return []


def _complex(points: Floats) -> np.ndarray[tuple[int], np.dtype[np.complex128]]:
    return points[:, 0] + 1j * points[:, 1]
