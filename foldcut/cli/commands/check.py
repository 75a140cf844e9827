"""``foldcut check``: whether a FOLD file folds flat, of foldcut's or of any other program."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from foldcut.cli import options
from foldcut.cli.commands import Command
from foldcut.cli.parser import output_name
from foldcut.core.errors import BadInputError
from foldcut.core.files import is_standard_input

if TYPE_CHECKING:
    from foldcut.cli.console import Console
    from foldcut.foldfile.decide import Decision

EXAMPLES = """\
examples:
  foldcut check fish.fold
  foldcut check star.fold --shape star     also check that the cut gives this shape
  foldcut check crane.fold --tolerance 1e-3   of coordinates that are good to a thousandth of the sheet
  foldcut check crane.fold --states        in how many layer orders does it fold flat?
  foldcut check crane.fold --tolerance 1e-3 --repair    also write it as it folds exactly, to crane-repaired.fold
  foldcut check fish.fold --json
exit status: 0 it folds flat, 1 it does not, 2 the file cannot be read, 3 not decided
"""

MOST_TOLERANCE = 0.01
"""The largest ``--tolerance``: a pattern that is farther off than this is another pattern."""


def add_options(command: ArgumentParser) -> None:
    """Add the FOLD file, the drawing that its cut must give, and how exact its coordinates have to be."""
    add_pattern(command)
    command.add_argument("--shape", metavar="SHAPE", help="the drawing that the cut must give, or the name of a sample")
    add_tolerance(command)
    command.add_argument("--states", action="store_true", help="also count the layer orders in which it folds flat")
    command.add_argument(
        "--repair",
        action="store_true",
        help="also write the pattern with its vertices where it folds flat exactly, and say how far they were moved",
    )
    command.add_argument(
        "-o",
        "--output",
        type=output_name,
        metavar="OUT",
        help="the .fold file that --repair writes (default: NAME-repaired.fold)",
    )
    options.add_force(command)
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
    from foldcut.checking import decide_cut
    from foldcut.cli import report
    from foldcut.foldfile.decide import states_of
    from foldcut.foldfile.patterns import read_pattern_apart
    from foldcut.foldfile.repaired import repaired_file
    from foldcut.output.atomic import Inputs, check_targets, write_files

    tolerance = tolerance_of(args)
    if args.shape and is_standard_input(args.file) and is_standard_input(args.shape):
        raise BadInputError("the pattern and --shape cannot both be standard input; give one of them as a file")
    repaired = target_of(args)
    inputs = Inputs([Path(args.file), *([] if args.shape is None else [Path(args.shape)])])
    if repaired is not None:
        check_targets([repaired], replace=args.force, inputs=inputs)
    read = read_pattern_apart(Path(args.file))
    drawing = options.named_source(args.shape).read(options.reading(args)) if args.shape else None
    decision = decide_cut(read, drawing, tolerance)
    checked = report.decision_report(decision, drawing is not None, decision.notes)
    if args.states and decision.folds:
        checked |= report.states_report(states_of(read, decision))
    if repaired is not None and decision.folds:
        data = repaired_file(read, decision)
        files = [{"path": str(repaired), "bytes": len(data), "replaced": repaired.exists()}]
        write_files({repaired: data}, replace=args.force, inputs=inputs)
        checked |= {"files": files, "next": []}
    return tell(options.console(args), checked, report.decision_lines(checked), decision, with_shape=bool(args.shape))


def target_of(args: Namespace) -> Path | None:
    """Return the file to which the repaired pattern is written, None if it is not."""
    if not args.repair:
        if args.output or args.force:
            raise BadInputError(
                f"{'-o' if args.output else '--force'} is for --repair, which writes the pattern; add it"
            )
        return None
    path = Path(args.file)
    stem = "pattern" if is_standard_input(path) else path.stem
    target = Path(args.output or f"{stem}-repaired.fold")
    if target.suffix.lower() != ".fold":
        raise BadInputError(
            f"{target}: --repair writes .fold; for other formats give that file to foldcut solve with -o {target.name}"
        )
    return target


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


CHECK = Command(
    "Decide whether a crease pattern folds flat, and with --shape also whether its cut is right.",
    EXAMPLES,
    add_options,
    check,
)
