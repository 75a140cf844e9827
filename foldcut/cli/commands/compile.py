"""``foldcut compile``: compile once what folding spends most of its time in."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from time import perf_counter

from foldcut.cli.commands import Command
from foldcut.cli.console import DONE, Console
from foldcut.core.errors import BadInputError, needed_extra

EXAMPLES = """\
examples:
  foldcut compile
  foldcut compile --json
"""


def add_options(command: ArgumentParser) -> None:
    """Add how to report."""
    command.add_argument("--json", action="store_true", help="print JSON, for programs")


def compile_(args: Namespace) -> int:
    """Compile, and say how long it took."""
    from foldcut.geometry.straight_skeleton.skeleton import compile_ahead

    console = Console(args.json)
    started = perf_counter()
    try:
        compile_ahead()
    except ImportError as error:
        raise BadInputError(needed_extra("compiled functions", "fast")) from error
    seconds = perf_counter() - started
    console.report({"ok": True, "seconds": seconds}, [f"compiled in {seconds:.1f} s, and kept for later"])
    return DONE


COMPILE = Command(
    "Compile once, for this machine, what folding spends most of its time in: half a minute. Patterns are the same "
    "without it; only long searches take longer. It needs the extra fast.",
    EXAMPLES,
    add_options,
    compile_,
)
