"""``foldcut make``: fold a drawing and write the pattern, or the job for a machine; ``foldcut view``: write a page."""

from __future__ import annotations

import os
from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from foldcut.cli import options
from foldcut.cli.commands import Command
from foldcut.cli.console import DONE
from foldcut.cli.making import fold_or_open, recipe_of, write_and_report
from foldcut.cli.options import PATTERN_STEM, FoldRequest, Machine, Request, Source
from foldcut.cli.outputs import Outputs, is_bundle
from foldcut.cli.parser import output_name
from foldcut.core.errors import BadInputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from foldcut.cli.outputs import MadeFor
    from foldcut.core.arrays import Floats
    from foldcut.core.model import Sheet
    from foldcut.pipeline import Result

MAKE_EXAMPLES = """\
examples:
  foldcut make fish -o fish.svg -o fish.fold
  foldcut make logo.svg --sheet letter --margin 15mm
  foldcut make logo.svg --layer Cut --flatten 0.2mm
  foldcut make part.dxf --layer OUTLINE --join 0.2mm
  foldcut make card.svg --open
  cat fish.svg | foldcut make - --from svg -o fish.fold
  foldcut make --text A --font MyFont.ttf
  foldcut make photo.png --threshold 0.4 --simplify 1mm
  foldcut make star.json --sheet 200x200mm --scale 1:2 --offset 30,40 --rotate 45
  foldcut make logo.svg --width 80mm --sheet 100x150mm
  foldcut make fish -o fish.fold --json > report.json
  foldcut make swan --effort best --seconds 60
  foldcut make map.svg --sheet a3 --simplify 0.5mm --min-crease 2mm
  foldcut make fish --method paper --ribbon 0.4mm
  foldcut make fish --profile laser-dxf --material card-160g --treatment perforate
  foldcut make swan --sheet a2 --profile printer-a4 --tile
  foldcut make fish --profile laser-dxf --two-sided --registration pins -o fish.zip
  foldcut make fish -o fish.pdf -o fish.dxf -o fish.fold
  foldcut make fish --profile axidraw-a4 --marks outline,numbers,title
  foldcut make fish --profile grbl-laser --two-sided --set bed.width_mm=300
  foldcut make star --sheet a6 --profile grbl-laser --copies 4 --tabs 4x0.5mm --frame -o stars.zip
  foldcut make star --sheet a6 --profile xtool-s1 --at 30mm,2cm
  foldcut make fish --groove v90 -o fish.step
  foldcut make fish --folded -o fish-folded.stl
  foldcut make fish-creases.svg --again

Without -o it writes NAME-creases.svg and, unless SHAPE is a .fold, NAME-creases.fold into the current folder, or with
--profile NAME-PROFILE with the ending of the machine's format.
Existing files are replaced only with --force. Ctrl-C ends the search and goes on with the best pattern found so far.
"""

VIEW_EXAMPLES = """\
examples:
  foldcut view fish                        writes fish.html and opens it in the browser
  foldcut view fish --no-open              only writes it
  foldcut view logo.svg --sheet a5 -o out/logo.html
  foldcut view logo.fold                   a pattern that foldcut made before
"""


def add_options(command: ArgumentParser) -> None:
    """Add the outputs, the drawing, the search and the machine."""
    command.add_argument(
        "-o",
        "--output",
        type=output_name,
        metavar="OUT",
        action="append",
        help="a file to write, in the format that its ending names, or a folder or a .zip for all files of a job and a "
        "README.txt; NAME-kit.pdf is the sheet to print with the guide behind it (repeatable)",
    )
    command.add_argument(
        "--preview",
        type=output_name,
        metavar="FILE.svg",
        help="also draw the drawing before (red) and after (black) it was mended and drawn anew, and outlines that "
        "others cover (blue)",
    )
    command.add_argument(
        "--again",
        metavar="DRAWING",
        nargs="?",
        const="",
        help="SHAPE is a file that foldcut wrote: make it again from the recipe in it, and say whether it is the same; "
        "the drawing is beside it, or is given here",
    )
    options.add_request(command)
    options.add_machine(command)
    options.add_solid(command)
    options.add_console(command)


def add_view_options(command: ArgumentParser) -> None:
    """Add the options of ``make``, and whether the page is opened."""
    add_options(command)
    command.add_argument(
        "--no-open",
        action="store_true",
        help="do not open the page in the browser (it is not opened, either, with -o, --json or --quiet, where the "
        "output is no terminal, and on a machine without a screen)",
    )


def view(args: Namespace) -> int:
    """Fold a drawing, write its page and open it in the browser."""
    from foldcut.cli.browser import has_screen, open_page

    status = make(args)
    wanted = not (args.no_open or args.output or args.json or args.quiet or args.again is not None)
    if status == DONE and wanted and has_screen():
        open_page(Path(page_name(options.source(args))))
    return status


def page_name(source: Source) -> str:
    """Return the name of the page of a drawing, unless another is given."""
    return f"{source.stem}.html"


def make(args: Namespace) -> int:
    """Fold a drawing and write its files."""
    if args.again is not None:
        from foldcut.cli.again import make_again

        return make_again(args)
    from foldcut.foldfile.reopen import Reopened
    from foldcut.jobs.errors import TooLargeError
    from foldcut.output.atomic import Inputs, check_targets

    console, request = options.console(args), options.request(args)
    source = request.source
    usual = options.usual_machines(args, (Path(out).suffix for out in args.output or ()))
    machine = options.no_machine() if usual else options.machine(args)
    default = [page_name(source)] if args.command == "view" else default_names(source, machine)
    paths = output_paths(args.output or default)
    bundles = [path.suffix.lower() for path in paths if is_bundle(path)]
    solids = options.solid_machines(args, [path.suffix for path in paths], bundles)
    outputs = Outputs(paths, source.stem, machine, usual | solids)
    inputs = Inputs([*source.files(), *outputs.profile_files()])
    outputs.check_formats(request_sheet(request))
    preview_path = None if not args.preview else Path(args.preview)
    if preview_path is not None and preview_path.suffix.lower() != ".svg":
        raise BadInputError(f"{args.preview}: a preview is SVG; give a name that ends in .svg")
    targets = [*outputs.targets(), *([preview_path] if preview_path else [])]
    check_targets(targets, replace=args.force, inputs=inputs)

    result = fold_or_open(request, console, targets)
    contents: dict[Path, bytes] = {}
    made: list[MadeFor] = outputs.machines()
    if result.verified:
        recipe = recipe_of(options.recipe(args), request, result)
        try:
            contents, made = outputs.contents(result.folded_pattern, recipe)
        except TooLargeError as error:
            if not source.is_pattern:
                raise
            remedy = f"{error.keeping}, or fold the drawing again with --sheet"
            raise BadInputError(f"{error.what}; a pattern has its sheet already: {remedy}") from None
        if preview_path is not None and not isinstance(result, Reopened):
            contents[preview_path] = _preview_of(result)
    return write_and_report(result, contents, console, replace=args.force, inputs=inputs, made=made)


def request_sheet(request: Request) -> Sheet:
    """Return the sheet that a drawing is folded on; for a pattern, whose sheet is not known yet, the smallest."""
    from foldcut.core.model import Sheet
    from foldcut.drawing.placement import SHEET_LIMITS_MM

    least = SHEET_LIMITS_MM[0]
    return request.folding.paper if isinstance(request, FoldRequest) else Sheet(least, least)


def _preview_of(result: Result) -> bytes:
    """Return the preview of a drawing that was folded: as it was drawn, and as it is cut."""
    from foldcut.drawing.mend import preview

    pattern, drawing = result.folded_pattern, result.drawing
    if pattern.shape.is_graph:
        return preview(*_lines_before_and_after(result))
    assert result.prepared is not None  # what the command line folds is always mended
    before, after = result.prepared.drawn, result.prepared.loops
    if pattern.drawn and drawing is not None:  # both as they lie on the sheet
        before = tuple(map(pattern.placement.apply, drawing.own_coordinates()))
        after = pattern.shape.loops
    return preview(before, after, _lost(result, before))


def _lines_before_and_after(result: Result) -> tuple[list[Floats], list[Floats]]:
    """Return the lines of a graph as they were drawn and as they are cut, on the sheet; open ones there and back."""
    from foldcut.core.arrays import points_array

    def there_and_back(line: Floats) -> Floats:
        return points_array([*line, *line[-2:0:-1]])

    pattern, drawing = result.folded_pattern, result.drawing
    after = [*pattern.shape.loops, *map(there_and_back, pattern.shape.lines)]
    if drawing is None:
        return [], after
    drawn = drawing.own_coordinates((*drawing.loops, *map(there_and_back, drawing.lines)))
    return list(map(pattern.placement.apply, drawn)), after


def _lost(result: Result, before: Sequence[Floats]) -> list[Floats]:
    """Return the outlines that the drawing lost while it was read, where and as large as ``before``, its loops."""
    drawing, pattern = result.drawing, result.folded_pattern
    if drawing is None or not drawing.lost:
        return []
    if pattern.drawn:
        return [pattern.placement.apply(loop) for loop in drawing.own_coordinates(drawing.lost)]
    width, size = (
        max(float(loop[:, 0].max()) for loop in loops) - min(float(loop[:, 0].min()) for loop in loops)
        for loops in (before, drawing.loops)
    )
    return [loop * (width / size) for loop in drawing.lost]


def default_names(source: Source, machine: Machine) -> list[str]:
    """Return the outputs when none are asked for; never the drawing's own name."""
    own = machine.output_name(source.stem)
    if own:
        return [own]
    pattern = f"{source.stem}{PATTERN_STEM}"
    return [f"{pattern}.svg"] if source.is_pattern else [f"{pattern}.svg", f"{pattern}.fold"]


def output_paths(names: list[str]) -> tuple[Path, ...]:
    """Return the paths of the outputs; raises BadInputError for folders that do not exist."""
    for name in names:
        if name.endswith(("/", os.sep)) and not Path(name).is_dir():
            raise BadInputError(f"cannot write into {name}: there is no such folder; create it first")
    return tuple(map(Path, names))


MAKE = Command(
    "Compute how to fold a sheet so that one straight cut gives the drawing.", MAKE_EXAMPLES, add_options, make
)
VIEW = Command(
    "Compute the pattern as `foldcut make` does, write NAME.html and open it in the browser: the pattern, and the "
    "sheet in 3D with a player that folds it step by step, cuts it and opens the shape. The page is one file, needs no "
    "network, and works in any browser.",
    VIEW_EXAMPLES,
    add_view_options,
    view,
)
