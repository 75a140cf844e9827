"""``foldcut check``: verify a FOLD file, of foldcut's or of any other program."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from foldcut.cli import options
from foldcut.cli.commands import Command

if TYPE_CHECKING:
    from foldcut.core.arrays import Floats
    from foldcut.core.model import Finding
    from foldcut.foldfile.read import FoldFile

EXAMPLES = """\
examples:
  foldcut check fish.fold
  foldcut check star.fold --shape star     also check that the cut gives this shape
  foldcut check fish.fold --json
"""

MOST_MOVED = 0.02
"""An outline that was moved by more than this part of a drawing's diagonal is not taken as that drawing's."""


def add_options(command: ArgumentParser) -> None:
    """Add the FOLD file, and the drawing that its cut must give."""
    command.add_argument("file", metavar="FILE.fold", help="the crease pattern")
    command.add_argument("--shape", metavar="SHAPE", help="the drawing that the cut must give, or the name of a sample")
    options.add_reading(command)
    options.add_timeout(command)
    options.add_console(command)


def check(args: Namespace) -> int:
    """Verify a FOLD file."""
    from foldcut.cli import report
    from foldcut.drawing.mend import Preparation, prepare
    from foldcut.drawing.shape import make_shape
    from foldcut.foldfile.judge import judge
    from foldcut.foldfile.read import read_fold_apart

    read = read_fold_apart(Path(args.file))
    shape, notes = None, read.notes
    if args.shape:
        drawing = options.named_source(args.shape).read(options.reading(args))
        notes += drawing.repairs
        if read.placement is not None:
            loops = [read.placement.apply(loop) for loop in drawing.own_coordinates()]
        else:
            loops = [loop * (drawing.unit_mm or 1.0) for loop in drawing.loops]
            notes += ("foldcut:placement is missing: the drawing is taken to lie on the sheet as drawn, in mm, y up",)
        prepared = prepare(loops, Preparation())
        notes += prepared.changes
        shape = make_shape(prepared.loops)
    findings = judge(read, shape)
    if findings and shape is not None and read.loops and all(finding.check == "cut" for finding in findings):
        findings, more = judge_moved(read, shape.loops, findings)
        notes += more
    checked = report.check_report(read.pattern, findings, shape is not None, notes)
    remedy = "mend the pattern"
    if args.shape:
        remedy += ", or give the drawing it was made from, with no corners moved (foldcut make --exact)"
    return options.console(args).verdict(checked, report.check_lines(checked), findings, remedy)


def judge_moved(
    read: FoldFile, drawing: Sequence[Floats], before: list[Finding]
) -> tuple[list[Finding], tuple[str, ...]]:
    """Judge the outline that a file cuts out instead of the drawing, if it is as near to it as the file states.

    Returns what is wrong and notes; ``before`` is what is wrong if the drawing itself is to be cut out.
    """
    from foldcut.core.model import Finding
    from foldcut.drawing.shape import make_shape
    from foldcut.foldfile.judge import judge
    from foldcut.redraw.deviation import EXACT, drawing_size, left_out, moved_by

    assert read.loops is not None
    moved, most = moved_by(read.loops, drawing), MOST_MOVED * drawing_size(drawing)
    stated = read.moved_by
    notes: tuple[str, ...] = ()
    if stated is not None and stated > most:
        notes = (f"the file states that it was moved by {stated:.3g} mm, over 2 % of the drawing's size: too much",)
    slack = 2 * EXACT * drawing_size(drawing)
    if stated is None or moved > min(stated, most) + slack:
        said = "does not state by how much" if stated is None else f"states {stated:.3g} mm"
        what = f"the outline was moved from the drawing by {moved:.3g} mm, and the file {said}; {before[0].message}"
        return [Finding("cut", what, before[0].place, moved)], notes
    notes += (f"the outline is at most {moved:.3g} mm off the drawing, as the file states",)
    far = left_out(read.loops, drawing, moved)
    if far:
        notes += (f"parts of the drawing narrower than {2 * moved:.3g} mm are left out, up to {far:.3g} mm from it",)
    return judge(read, make_shape(read.loops)), notes


CHECK = Command(
    "Verify that a crease pattern folds flat as it says, and with --shape also its cut.", EXAMPLES, add_options, check
)
