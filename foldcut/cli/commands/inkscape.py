"""``foldcut inkscape-extension``: write an extension for Inkscape that calls this foldcut."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path

from foldcut.cli import options
from foldcut.cli.commands import Command
from foldcut.cli.console import DONE
from foldcut.cli.parser import output_name
from foldcut.core.errors import BadInputError

EXAMPLES = """\
examples:
  foldcut inkscape-extension -o ~/.config/inkscape/extensions
  foldcut inkscape-extension -o "$(inkscape --user-data-directory)/extensions"
Then start Inkscape anew: Extensions > Foldcut > Fold and Cut.
"""

NAMES = ("foldcut.inx", "foldcut_extension.py")
"""What Inkscape needs: what the extension is called and can be told, and what is run."""
CALLED = 'PROGRAM = ["foldcut"]'
"""The line of what is run that says how foldcut is called."""


def add_options(command: ArgumentParser) -> None:
    """Add the folder."""
    command.add_argument(
        "-o",
        "--output",
        type=output_name,
        metavar="DIR",
        required=True,
        help="the folder of Inkscape's extensions; Inkscape names it under Edit > Preferences > System",
    )
    options.add_force(command)
    options.add_console(command)


def write_extension(args: Namespace) -> int:
    """Write the files of the extension."""
    from importlib.resources import files

    from foldcut.output.atomic import write_files

    folder = Path(args.output)
    if not folder.is_dir():
        raise BadInputError(f"{folder}: there is no such folder; create it first")
    source = files("foldcut.plugins") / "inkscape"
    called = f"PROGRAM = {[sys.executable, '-m', 'foldcut.cli']!r}"
    contents = {folder / name: (source / name).read_text("utf-8").replace(CALLED, called).encode() for name in NAMES}
    write_files(contents, replace=args.force)
    lines = [f"written {path}" for path in contents]
    lines.append("start Inkscape anew: it is under Extensions > Foldcut > Fold and Cut")
    options.console(args).report({"ok": True, "files": [str(path) for path in contents]}, lines)
    return DONE


INKSCAPE_EXTENSION = Command(
    "Write an extension for Inkscape that calls this foldcut: the drawing, or what is selected of it, becomes the "
    "crease pattern.",
    EXAMPLES,
    add_options,
    write_extension,
)
