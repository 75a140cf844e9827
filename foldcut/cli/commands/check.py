"""``foldcut check``: whether a FOLD file folds flat, of foldcut's or of any other program."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from foldcut.cli import options
from foldcut.cli.commands import Command
from foldcut.core.errors import BadInputError
from foldcut.core.files import is_standard_input

if TYPE_CHECKING:
    from foldcut.cli.console import Console
    from foldcut.core.arrays import Floats
    from foldcut.core.model import Shape
    from foldcut.foldfile.decide import Decision
    from foldcut.foldfile.read import FoldFile

EXAMPLES = """\
examples:
  foldcut check fish.fold
  foldcut check star.fold --shape star     also check that the cut gives this shape
  foldcut check crane.fold --tolerance 1e-3   of coordinates that are good to a thousandth of the sheet
  foldcut check crane.fold --states        in how many layer orders does it fold flat?
  foldcut check fish.fold --json
exit status: 0 it folds flat, 1 it does not, 2 the file cannot be read, 3 not decided
"""

MOST_TOLERANCE = 0.01
"""The largest ``--tolerance``: a pattern that is farther off than this is another pattern."""

CUT_WRONG = "is not cut as the drawing"
"""What is said of a pattern of which only the cut is wrong."""

MOST_MOVED = 0.02
"""An outline that was moved by more than this part of a drawing's diagonal is not taken as that drawing's."""


def add_options(command: ArgumentParser) -> None:
    """Add the FOLD file, the drawing that its cut must give, and how exact its coordinates have to be."""
    add_pattern(command)
    command.add_argument("--shape", metavar="SHAPE", help="the drawing that the cut must give, or the name of a sample")
    add_tolerance(command)
    command.add_argument("--states", action="store_true", help="also count the layer orders in which it folds flat")
    options.add_reading(command)
    options.add_timeout(command)
    options.add_console(command)


def add_pattern(command: ArgumentParser) -> None:
    """Add the crease pattern."""
    command.add_argument("file", metavar="PATTERN", help=".fold, .cp, .opx, .svg with lines, or - for a .fold")


def add_tolerance(command: ArgumentParser) -> None:
    """Add how exact coordinates have to be."""
    command.add_argument(
        "--tolerance",
        metavar="SHARE",
        help=(
            "how far vertices may be from a pattern that folds flat exactly, relative to the sheet's diagonal "
            "(default: 3e-5, which accepts coordinates rounded to 1e-5 of the sheet)"
        ),
    )


def tolerance_of(args: Namespace) -> float:
    """Return how exact coordinates have to be."""
    from foldcut.foldfile.decide import TOLERANCE

    return TOLERANCE if args.tolerance is None else share(args.tolerance)


def check(args: Namespace) -> int:
    """Decide whether the pattern of a FOLD file folds flat."""
    from foldcut.cli import report
    from foldcut.drawing.graph import make_graph, shapes_of
    from foldcut.drawing.mend import Preparation, prepare
    from foldcut.foldfile.decide import decide, states_of
    from foldcut.foldfile.patterns import read_pattern_apart

    tolerance = tolerance_of(args)
    if args.shape and is_standard_input(args.file) and is_standard_input(args.shape):
        raise BadInputError("the pattern and --shape cannot both be standard input; give one of them as a file")
    read = read_pattern_apart(Path(args.file))
    shapes: list[Shape] = []
    notes = read.notes
    if args.shape:
        drawing = options.named_source(args.shape).read(options.reading(args))
        notes += drawing.repairs
        loops, lines = drawing.own_coordinates(), drawing.own_coordinates(drawing.lines)
        if read.placement is not None:
            loops, lines = (tuple(map(read.placement.apply, drawn)) for drawn in (loops, lines))
            unit = read.placement.scale
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
    shape = shapes[0] if shapes else None
    decision = decide(read, shape, tolerance)
    for other in shapes[1:]:  # of a graph, the file need not have the sides of the cut that come first
        if all(finding.check != "cut" for finding in decision.findings):
            break
        decision = decide(read, other, tolerance)
    findings = decision.findings
    are_loops = shape is not None and not shape.is_graph and read.loops and not read.lines
    if findings and shape is not None and are_loops and all(finding.check == "cut" for finding in findings):
        decision, more = judge_moved(read, shape.loops, decision, tolerance)
        notes += more
    checked = report.decision_report(decision, shape is not None, notes + decision.notes)
    if args.states and decision.folds:
        checked |= report.states_report(states_of(read, decision))
    return tell(options.console(args), checked, report.decision_lines(checked), decision, with_shape=bool(args.shape))


def share(text: str) -> float:
    """Return a tolerance: a part of the sheet's diagonal."""
    try:
        number = float(text)
    except ValueError:
        number = -1.0
    if not 0 <= number <= MOST_TOLERANCE:
        raise BadInputError(
            f"--tolerance {text}: give a part of the sheet's diagonal from 0 to {MOST_TOLERANCE:g}, such as 1e-4"
        )
    return number


def tell(
    console: Console, report: dict[str, Any], lines: Sequence[str], decision: Decision, *, with_shape: bool
) -> int:
    """Print the report and, unless the pattern folds, an error that sums it up; return the exit status."""
    from foldcut.cli.console import DONE, FAILED, UNDECIDED, print_error

    if decision.folds:
        console.report(report, lines)
        return DONE
    message, kind, status = decision.sentence, "UndecidedError", UNDECIDED
    if decision.folds is False:
        more = f" (and {len(decision.findings) - 1} more)" if len(decision.findings) > 1 else ""
        remedy = "mend the pattern"
        if with_shape:
            remedy += ", or give the drawing it was made from, with no corners moved (foldcut make --exact)"
        message, kind, status = f"the pattern {decision.sentence}{more}; {remedy}", "VerificationError", FAILED
    console.report(report | {"error": {"type": kind, "message": message}}, lines)
    print_error(message)
    return status


def judge_moved(
    read: FoldFile, drawing: Sequence[Floats], before: Decision, tolerance: float
) -> tuple[Decision, tuple[str, ...]]:
    """Judge the outline that a file cuts out instead of the drawing, if it is as near to it as the file states.

    Returns the decision and notes; ``before`` is the decision if the drawing itself is to be cut out.
    """
    from dataclasses import replace

    from foldcut.core.model import Finding
    from foldcut.foldfile.decide import decide
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
        first = before.findings[0]
        what = f"the outline was moved from the drawing by {moved:.3g} mm, and the file {said}; {first.message}"
        finding = Finding("cut", what, first.place, moved)
        return replace(before, sentence=f"{CUT_WRONG}: {finding}", findings=(finding,)), notes
    notes += (f"the outline is at most {moved:.3g} mm off the drawing, as the file states",)
    far = left_out(read.loops, drawing, moved)
    if far:
        notes += (f"parts of the drawing narrower than {2 * moved:.3g} mm are left out, up to {far:.3g} mm from it",)
    return decide(read, read.shape, tolerance), notes


CHECK = Command(
    "Decide whether a crease pattern folds flat, and with --shape also whether its cut is right.",
    EXAMPLES,
    add_options,
    check,
)
