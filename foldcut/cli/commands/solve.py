"""``foldcut solve``: mountains, valleys and layers of anybody's crease pattern, and files of it."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from foldcut.cli import options
from foldcut.cli.commands import Command
from foldcut.cli.commands.check import add_pattern, add_tolerance, tell, tolerance_of
from foldcut.cli.outputs import Outputs, is_bundle
from foldcut.cli.parser import output_name
from foldcut.core.errors import BadInputError, UnfoldableError
from foldcut.core.files import hash_of, is_standard_input

if TYPE_CHECKING:
    from foldcut.foldfile.solved import Solved
    from foldcut.output.recipe import Recipe

EXAMPLES = """\
examples:
  foldcut solve twist.svg                       mountains, valleys and layers, to twist-solved.fold
  foldcut solve crane.cp -o crane.fold --width 150mm
  foldcut solve crane.opx --width 180mm --profile laser-dxf -o crane.dxf
  foldcut solve crane.fold --width 150mm -o crane.pdf -o crane.html
In .svg files red lines are mountains, blue ones valleys, grey ones stay flat, and all others are unassigned.
exit status: 0 it folds flat and is written, 1 it does not, 2 the file cannot be read, 3 not decided
"""

SHOWS_LAYERS = (".html",)
"""The formats that show how layers lie on each other, as a list."""


def add_options(command: ArgumentParser) -> None:
    """Add the pattern, the outputs and the machine."""
    add_pattern(command)
    command.add_argument(
        "-o",
        "--output",
        type=output_name,
        metavar="OUT",
        action="append",
        help="a file to write, in the format that its ending names (default: NAME-solved.fold, or with "
        "--profile NAME-PROFILE in the machine's format; repeatable)",
    )
    add_judging(command)
    options.add_force(command)
    options.add_timeout(command)
    options.add_machine(command)
    options.add_console(command)


def add_judging(command: ArgumentParser) -> None:
    """Add how large the sheet is, and how exact coordinates have to be."""
    command.add_argument("--width", metavar="LENGTH", help="how wide the sheet is (default: as the file says)")
    add_tolerance(command)


def solve(args: Namespace) -> int:
    """Solve a crease pattern and write it."""
    from foldcut.cli import report
    from foldcut.core.units import parse_length
    from foldcut.foldfile.patterns import read_pattern_apart
    from foldcut.foldfile.solved import completed
    from foldcut.foldfile.solved import solve as solve_file
    from foldcut.jobs.errors import TooLargeError
    from foldcut.output.atomic import Inputs, check_targets, write_files

    console, path = options.console(args), Path(args.file)
    width_mm = None if args.width is None else parse_length(args.width)
    stem = "pattern" if is_standard_input(path) else path.stem
    args.sheet = None
    usual = options.usual_machines(args, (Path(name).suffix for name in args.output or ()))
    machine = options.no_machine() if usual else options.machine(args)
    names = [Path(name) for name in args.output or [machine.output_name(stem) or f"{stem}-solved.fold"]]
    outputs = Outputs(tuple(names), stem, machine, usual)
    inputs = Inputs([path, *outputs.profile_files()])
    check_targets(outputs.targets(), replace=args.force, inputs=inputs)
    file = read_pattern_apart(path)
    solved, decision = solve_file(file, tolerance_of(args), width_mm)
    told = report.decision_report(decision, False, file.notes + decision.notes)
    if solved is None:
        return tell(console, told, report.decision_lines(told), decision, with_shape=False)
    check_kinds(names, solved)
    try:
        outputs.check_formats(solved.folded_pattern.sheet)
        contents, made = outputs.contents(solved.folded_pattern, recipe_of(args, path))
    except TooLargeError as error:
        raise BadInputError(f"{error.what}; {error.keeping}, or make the sheet smaller with --width") from None
    contents = {p: completed(data, solved) if p.suffix == ".fold" else data for p, data in contents.items()}
    files = [{"path": str(p), "bytes": len(data), "replaced": p.exists()} for p, data in contents.items()]
    write_files(contents, replace=args.force, inputs=inputs)
    console.report(*report.solved_report(told, files, made))
    return 0


def recipe_of(args: Namespace, path: Path) -> Recipe:
    """Return how the files are made, but for their machine."""
    from foldcut.output.recipe import Recipe

    made = Recipe("solve").also(*options.words(args, add_judging))
    if is_standard_input(path):
        return made
    return replace(made, drawing=path.name, sha256=hash_of(path))


def check_kinds(names: Sequence[Path], solved: Solved) -> None:
    """Raise what cannot be written of this pattern."""
    from foldcut.foldfile.solved import CIRCULAR, is_rectangle

    for name in names:
        if solved.in_a_circle and (name.suffix.lower() in SHOWS_LAYERS or is_bundle(name)):
            raise UnfoldableError(f"{name}: {CIRCULAR}; write .fold, .svg, .cp, or a machine's file")
        if name.suffix.lower() != ".fold" and not is_rectangle(solved):
            raise BadInputError(f"{name}: the sheet is no rectangle; write .fold, or draw the border as a rectangle")


SOLVE = Command(
    "Find mountains, valleys and layers of a crease pattern, prove that it folds flat, and write it as FOLD or for a "
    "machine. Edges that are assigned stay as they are.",
    EXAMPLES,
    add_options,
    solve,
)
