"""``foldcut compile``: compile once what folding spends most of its time in."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from time import perf_counter

from foldcut.cli.commands import Command
from foldcut.cli.console import DONE, Console

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
    from foldcut.cli.progress import progress_for
    from foldcut.geometry.straight_skeleton import moving
    from foldcut.redraw import compiling

    console = Console(args.json)
    started = perf_counter()
    with progress_for(console) as progress:
        if not compiling.is_compiled():
            progress(compiling.COMPILING, 0.0)
        moving.compile_ahead()
        compiling.compile_ahead()
    seconds = perf_counter() - started
    console.report({"ok": True, "seconds": seconds}, [f"compiled in {seconds:.1f} s, and kept for later"])
    return DONE


COMPILE = Command(
    "Compile once, for this machine, what folding spends most of its time in: about a minute. Otherwise that is done "
    "when the first outline is drawn anew.",
    EXAMPLES,
    add_options,
    compile_,
)
