"""The words of a command line -> the command and its options.

Only the command that is asked for is imported, so ``foldcut --help`` and a mistyped name are answered at once.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import NoReturn

from foldcut.cli.commands import COMMANDS, Command, load
from foldcut.core.errors import BadInputError

KEEP_LINES = argparse.RawDescriptionHelpFormatter
"""Examples are printed line by line, as they are written."""

DESCRIPTION = "Fold a sheet flat so that one straight cut cuts out any drawing with straight edges."

EPILOG = """\
examples:
  foldcut make fish                        the sample "fish" on A4, as fish-creases.svg and fish-creases.fold
  foldcut make logo.svg -o logo.fold       your own drawing
  foldcut make fish --profile glowforge    the job for a machine, in its format
  foldcut view fish                        a page to fold and cut it on the screen
  foldcut batch icons -o out               every drawing in a folder, on all cores
  foldcut profiles                         the machines that foldcut knows
  foldcut check logo.fold                  does this pattern fold flat?
  foldcut COMMAND --help                   all options of a command, with examples

exit status: 0 done and verified, 1 not foldable or not verified, 2 bad input, 3 not decided (check)
"""


class Parser(argparse.ArgumentParser):
    """A parser that raises BadInputError where argparse would print its usage and exit."""

    def error(self, message: str) -> NoReturn:
        """Raise what argparse found wrong."""
        raise BadInputError(f"{message}; see {self.prog} --help")

    def options(self) -> list[argparse.Action]:
        """Return all options and arguments, in their order."""
        return self._actions

    def option_strings(self) -> list[str]:
        """Return every option, as it is typed."""
        return [option for action in self._actions for option in action.option_strings]


class Version(argparse.Action):
    """Print the installed version, which is looked up only now."""

    def __init__(self, option_strings: Sequence[str], dest: str, help: str) -> None:
        super().__init__(option_strings, dest, nargs=0, help=help)

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        """Print the version and exit."""
        from importlib.metadata import version

        print(f"foldcut {version('foldcut')}")
        parser.exit()


def parse(argv: Sequence[str]) -> tuple[Command, argparse.Namespace]:
    """Return the command and its options; raises BadInputError, with the nearest known name, for unknown ones."""
    words = with_joined_values(argv)
    if words and words[0][:1] != "-" and words[0] not in COMMANDS:
        of_all = f"choose one of {', '.join(COMMANDS)}, such as foldcut make {words[0]}"
        raise BadInputError(f"there is no command {words[0]!r}; {nearest(words[0], list(COMMANDS)) or of_all}")
    parser, commands = _parsers(next((word for word in words if word in COMMANDS), None))
    args, unknown = parser.parse_known_args(words)
    if unknown:
        options = commands[args.command]
        known = options.option_strings()
        question = nearest(unknown[0].partition("=")[0], known) if unknown[0].startswith("--") else ""
        remedy = question or f"see {options.prog} --help"
        if args.command == "make" and unknown[0][:1] != "-":
            remedy = "give one drawing, or give all of them to foldcut batch"
        raise BadInputError(f"unrecognized arguments: {' '.join(unknown)}; {remedy}")
    return load(args.command), args


def _parsers(chosen: str | None) -> tuple[Parser, dict[str, Parser]]:
    """Return the parser of all commands, and the parser of each; only the chosen one is given its options."""
    parser = Parser(prog="foldcut", description=DESCRIPTION, epilog=EPILOG, formatter_class=KEEP_LINES)
    parser.add_argument("--version", action=Version, help="show the version and exit")
    table = parser.add_subparsers(dest="command", required=True, metavar="COMMAND", title="commands")
    commands = {name: table.add_parser(name, help=entry.summary) for name, entry in COMMANDS.items()}
    if chosen is not None:
        command, options = load(chosen), commands[chosen]
        options.description, options.epilog = command.description, command.examples
        options.formatter_class = KEEP_LINES
        command.add_options(options)
    return parser, commands


def output_name(text: str) -> str:
    """Return the name of an output; an empty one, which would be the current folder, is an error."""
    if not text:
        raise argparse.ArgumentTypeError("its name is empty; give a name")
    return text


def nearest(name: str, known: Sequence[str], what: str = "") -> str:
    """Return "did you mean ...?" with the known name that is most like this one; an empty text if none is."""
    from difflib import get_close_matches

    return "".join(f"did you mean {what}{match}?" for match in get_close_matches(name, known, n=1))


def with_joined_values(argv: Sequence[str]) -> list[str]:
    """Return the arguments with ``--offset -5,3`` or ``--text -A`` as one: argparse takes such values for options."""
    joined: list[str] = []
    for argument in argv:
        before = joined[-1] if joined and "--" not in joined else ""  # after -- there are no options
        negative = argument[:1] == "-" and argument[1:2].isdigit() and before[:2] == "--" and "=" not in before
        if negative or (before in ("--offset", "--text") and argument[:2] != "--"):
            joined[-1] = f"{before}={argument}"
        else:
            joined.append(argument)
    return joined
