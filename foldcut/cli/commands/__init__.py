"""The commands of ``foldcut``: one module each, and one row in ``COMMANDS``.

A module is imported when its command is chosen. Its top imports nothing slow, so ``foldcut COMMAND --help`` is
answered at once; what takes long to import is imported by the functions that do the work.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Callable
from importlib import import_module
from typing import NamedTuple


class Command(NamedTuple):
    """One command: the text of its help, its options, and what it does.

    ``run`` is the only function that sees the parsed arguments: it turns them into the values of ``cli.options``, and
    returns the exit status.
    """

    description: str
    examples: str
    add_options: Callable[[ArgumentParser], None]
    run: Callable[[Namespace], int]


class Entry(NamedTuple):
    """A row of ``COMMANDS``: "module:NAME" of the command, and its line in ``foldcut --help``."""

    home: str
    summary: str


COMMANDS = {
    "make": Entry("make:MAKE", "compute the crease pattern of a drawing and write it"),
    "view": Entry(
        "make:VIEW", "compute the crease pattern and write a page to look at, to fold and to cut on the screen"
    ),
    "draw": Entry("draw:DRAW", "draw the pattern, the folded sheet, its layers, and what the cut leaves"),
    "guide": Entry("guide:GUIDE", "write step-by-step instructions to fold it by hand"),
    "batch": Entry("batch:BATCH", "compute the crease patterns of many drawings, on all cores or a cluster"),
    "serve": Entry(
        "serve:SERVE", "serve a page for the browser that folds drawings and makes their files, on this machine"
    ),
    "check": Entry("check:CHECK", "decide whether a crease pattern folds flat"),
    "solve": Entry("solve:SOLVE", "find mountains, valleys and layers of a crease pattern, and write it"),
    "coupon": Entry("coupon:COUPON", "write a test card of scores and perforations for a machine"),
    "profiles": Entry("profiles:PROFILES", "list, show and validate the machines' profiles"),
    "samples": Entry("samples:SAMPLES", "list the drawings that come with foldcut"),
    "inkscape-extension": Entry("inkscape:INKSCAPE_EXTENSION", "write an extension for Inkscape that calls foldcut"),
    "compile": Entry("compile:COMPILE", "compile once what folding spends most of its time in"),
}
"""The commands by name, in the order of ``foldcut --help``."""


def load(name: str) -> Command:
    """Import the module of a command in ``COMMANDS`` and return the command."""
    module, _, attribute = COMMANDS[name].home.partition(":")
    command: Command = getattr(import_module(f"{__name__}.{module}"), attribute)
    return command
