"""``foldcut guide``: how a person folds the pattern, step by step."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from foldcut.cli import options
from foldcut.cli.commands import Command
from foldcut.cli.making import fold_and_write
from foldcut.cli.parser import output_name

if TYPE_CHECKING:
    from foldcut.foldfile.reopen import Reopened
    from foldcut.pipeline import Result

EXAMPLES = """\
examples:
  foldcut guide letter-a                   letter-a-guide.pdf
  foldcut guide logo.svg -o logo.html
  foldcut guide star -o star-folds.svg     it folds, in any browser
"""


def add_options(command: ArgumentParser) -> None:
    """Add the output, the drawing and the search."""
    command.add_argument(
        "-o",
        "--output",
        type=output_name,
        metavar="OUT",
        help="a .pdf, .html or animated .svg (default: NAME-guide.pdf)",
    )
    options.add_request(command)
    options.add_console(command)


def guide(args: Namespace) -> int:
    """Fold a drawing and write how a person folds it."""
    from foldcut.output.saving import guide_exporter

    request, recipe = options.request(args), options.recipe(args)
    output = Path(args.output or f"{request.source.stem}-guide.pdf")
    export = guide_exporter(output)

    def written(result: Result | Reopened) -> bytes:
        return export(result.folded_pattern)

    return fold_and_write(request, output, written, options.console(args), recipe, replace=args.force)


GUIDE = Command(
    "Compute the pattern as `foldcut make` does and write a folding guide with a picture of each step: straight folds, "
    "which creases to press and which to collapse all at once, the layers, where to cut.",
    EXAMPLES,
    add_options,
    guide,
)
