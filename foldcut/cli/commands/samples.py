"""``foldcut samples``: the drawings that come with foldcut."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from foldcut.cli.commands import Command
from foldcut.cli.console import DONE, Console

EXAMPLES = """\
examples:
  foldcut samples
  foldcut make "$(foldcut samples | head -n 1)"
"""


def add_options(command: ArgumentParser) -> None:
    """Add how to print the list."""
    command.add_argument("--json", action="store_true", help="print the list as JSON, for programs")


def samples(args: Namespace) -> int:
    """List the samples."""
    from foldcut.samples import sample_names

    names = sample_names()
    Console(args.json).report({"ok": True, "samples": list(names)}, names)
    return DONE


SAMPLES = Command(
    "List the drawings that come with foldcut; `foldcut make` takes their names as SHAPE.",
    EXAMPLES,
    add_options,
    samples,
)
