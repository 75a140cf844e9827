"""Whether the pattern in a file folds flat, and whether its cut gives a drawing.

A file with a crease pattern and, if wanted, a drawing -> a ``Decision``: the file is decided by ``foldfile.decide``;
here the drawing is laid where the pattern has it, and an outline that was moved is judged as far as the file states.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path

from foldcut.core.arrays import Floats
from foldcut.core.model import Finding
from foldcut.drawing.graph import make_graph, shapes_of
from foldcut.drawing.mend import Preparation, prepare
from foldcut.foldfile.decide import TOLERANCE, Decision, decide
from foldcut.foldfile.patterns import read_pattern
from foldcut.foldfile.read import FoldFile
from foldcut.readers import Drawing, ReadOptions, read_shape
from foldcut.redraw.deviation import EXACT, drawing_size, left_out, moved_by
from foldcut.samples import drawing_path

__all__ = ["check", "decide_cut"]

CUT_WRONG = "is not cut as the drawing"
"""What is said of a pattern of which only the cut is wrong."""

MOST_MOVED = 0.02
"""An outline that was moved by more than this part of a drawing's diagonal is not taken as that drawing's."""


def check(
    pattern: str | PathLike[str], shape: str | PathLike[str] | None = None, *, tolerance: float = TOLERANCE
) -> Decision:
    """Decide whether a crease pattern (.fold, .cp, .opx, .svg with lines) of any program folds flat.

    With a ``shape``, a drawing's path or the name of a sample, also whether the cut gives that. ``tolerance``: how far
    vertices may be from a pattern that folds flat exactly, relative to the sheet's diagonal. ``Decision.folds`` is
    True, False or, where that is not decided, None, and ``Decision.findings`` say where it does not.

    Raises ``BadInputError`` for a file that cannot be read.
    """
    drawing = None if shape is None else read_shape(drawing_path(shape), ReadOptions())
    return decide_cut(read_pattern(Path(pattern)), drawing, tolerance)


def decide_cut(read: FoldFile, drawing: Drawing | None, tolerance: float) -> Decision:
    """Decide whether a pattern folds flat and, with a ``drawing``, whether the cut gives that; notes say what was done.

    Raises ``ShapeError`` for a drawing that is none.
    """
    if drawing is None:
        decision = decide(read, None, tolerance)
        return replace(decision, notes=read.notes + decision.notes)
    notes = read.notes + drawing.repairs
    if read.placement is not None:
        unit = read.placement.scale
        loops, lines = (
            tuple(map(read.placement.apply, drawing.own_coordinates(drawn))) for drawn in (drawing.loops, drawing.lines)
        )
    else:
        unit = drawing.unit_mm or 1.0
        loops, lines = (tuple(line * unit for line in drawn) for drawn in (drawing.loops, drawing.lines))
        notes += ("foldcut:placement is missing: the drawing is taken to lie on the sheet as drawn, in mm, y up",)
    if lines:
        shapes = list(make_graph((), lines, join=drawing.join and drawing.join * unit).shapes())
    else:
        prepared = prepare(loops, Preparation())
        notes += prepared.changes
        shapes = shapes_of(prepared.loops)
    shape = shapes[0]
    decision = decide(read, shape, tolerance)
    for other in shapes[1:]:  # of a graph, the file need not have the sides of the cut that come first
        if all(finding.check != "cut" for finding in decision.findings):
            break
        decision = decide(read, other, tolerance)
    findings = decision.findings
    are_loops = read.loops and not read.lines and not shape.is_graph
    if findings and are_loops and all(finding.check == "cut" for finding in findings):
        decision, more = _judge_moved(read, shape.loops, decision, tolerance)
        notes += more
    return replace(decision, notes=notes + decision.notes)


def _judge_moved(
    read: FoldFile, drawing: Sequence[Floats], before: Decision, tolerance: float
) -> tuple[Decision, tuple[str, ...]]:
    """Judge the outline that a file cuts out instead of the drawing, if it is as near to it as the file states.

    Returns the decision and notes; ``before`` is the decision if the drawing itself is to be cut out.
    """
    assert read.loops is not None
    moved, most = moved_by(read.loops, drawing), MOST_MOVED * drawing_size(drawing)
    stated = read.moved_by
    notes: tuple[str, ...] = ()
    if stated is not None and stated > most:
        notes = (f"the file states that it was moved by {stated:.3g} mm, over 2 % of the drawing's size: too much",)
    slack = 2 * EXACT * drawing_size(drawing)
    if stated is None or moved > min(stated, most) + slack:
        said = "does not state by how much" if stated is None else f"states {stated:.3g} mm"
        first = before.findings[0]
        what = f"the outline was moved from the drawing by {moved:.3g} mm, and the file {said}; {first.message}"
        finding = Finding("cut", what, first.place, moved)
        return replace(before, sentence=f"{CUT_WRONG}: {finding}", findings=(finding,)), notes
    notes += (f"the outline is at most {moved:.3g} mm off the drawing, as the file states",)
    far = left_out(read.loops, drawing, moved)
    if far:
        notes += (f"parts of the drawing narrower than {2 * moved:.3g} mm are left out, up to {far:.3g} mm from it",)
    return decide(read, read.shape, tolerance), notes
