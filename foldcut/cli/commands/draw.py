"""``foldcut draw``: pictures of a pattern, of the folded sheet, and of how the pattern is constructed."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from foldcut.cli import options
from foldcut.cli.commands import Command
from foldcut.cli.making import fold_and_write
from foldcut.cli.parser import output_name
from foldcut.core.errors import BadInputError
from foldcut.methods import METHODS

if TYPE_CHECKING:
    from foldcut.foldfile.reopen import Reopened
    from foldcut.pipeline import Result

EXAMPLES = """\
examples:
  foldcut draw fish                        fish-pictures.svg
  foldcut draw triangle --method paper --show packing,molecules,trees,ribbon --ribbon 1mm
  foldcut draw logo.svg --show folded,layers -o folded.png
  foldcut draw logo.svg --show ladder      what each tolerance makes of the outline, and what it costs to fold
"""


def add_options(command: ArgumentParser) -> None:
    """Add the output, what to show, the drawing and the search."""
    command.add_argument(
        "-o", "--output", type=output_name, metavar="OUT", help="a .svg or .png (default: NAME-pictures.svg)"
    )
    add_show(command)
    options.add_request(command)
    options.add_console(command)


def add_show(command: ArgumentParser) -> None:
    """Add what to show."""
    constructed = " or ".join(method.name for method in METHODS.values() if method.construction)
    command.add_argument(
        "--show",
        metavar="NAME,...",
        default="pattern,folded,layers,pieces",
        help="pattern; folded: flat, from the front, with the cut; layers: drawn apart, from the side; pieces: "
        "unfolded after the cut (default: these); outline: what is cut out, over the drawing; ladder: the tolerances "
        f"that were tried, side by side; and with --method {constructed} also packing, molecules, "
        "rabbit-ear, gusset, inset, trees, matching, ribbon",
    )


def draw(args: Namespace) -> int:
    """Fold a drawing and draw pictures of it."""
    from foldcut.exporters.pattern.png import rendered
    from foldcut.exporters.pictures import pictures
    from foldcut.foldfile.reopen import Reopened
    from foldcut.profiles import load_profile

    request = options.request(args)
    recipe = options.recipe(args).also(*options.words(args, add_show))
    output = Path(args.output or f"{request.source.stem}-pictures.svg")
    if output.suffix.lower() not in (".svg", ".png"):
        raise BadInputError(f"{output}: pictures are SVG or PNG; give a name that ends in .svg or .png")
    show = tuple(name.strip() for name in args.show.split(","))
    if pictures.LADDER in show and request.source.is_pattern:
        raise BadInputError("a pattern that was folded before has no ladder; give the drawing")
    pictures.check(show, construction=args.method in METHODS and METHODS[args.method].construction)

    def drawn(result: Result | Reopened) -> bytes:
        stages, ladder = (None, None) if isinstance(result, Reopened) else (result.construction, result.ladder)
        svg, size = pictures.draw(result.folded_pattern, show, load_profile(), stages, ladder)
        return svg if output.suffix.lower() == ".svg" else rendered(svg, size)

    return fold_and_write(request, output, drawn, options.console(args), recipe, replace=args.force)


DRAW = Command(
    "Compute the pattern as `foldcut make` does and draw pictures to look at, side by side.",
    EXAMPLES,
    add_options,
    draw,
)
