"""``foldcut samples``: the drawings that come with foldcut."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from foldcut.cli.commands import Command
from foldcut.cli.console import DONE, Console

EXAMPLES = """\
examples:
  foldcut samples
  foldcut samples --long           with how difficult each is, the easiest first
  foldcut make "$(foldcut samples | head -n 1)"
"""


def add_options(command: ArgumentParser) -> None:
    """Add how to print the list."""
    command.add_argument("--long", action="store_true", help="say how difficult each is to fold, the easiest first")
    command.add_argument("--json", action="store_true", help="print the list as JSON, for programs")


def samples(args: Namespace) -> int:
    """List the samples."""
    from foldcut.samples import sample_names

    names = sample_names(lines=True)
    if not (args.long or args.json):
        Console(as_json=False).report({}, list(names))
        return DONE
    from foldcut.pattern.difficulty import GRADES, difficulty
    from foldcut.samples import fold_counts

    counts = fold_counts()
    known = {name: difficulty(*counts[name]) for name in names if name in counts}
    keys = {name: (one.level, one.minutes or 0, counts[name].folds) for name, one in known.items()}
    easiest_first = sorted(names, key=lambda name: (keys.get(name, (len(GRADES), 0, 0)), name))
    width = max(map(len, names)) + 2
    lines = [f"{name:<{width}}{known.get(name, '')}".rstrip() for name in easiest_first]
    told = {name: one.short for name, one in known.items()}
    Console(args.json).report({"ok": True, "samples": list(names), "difficulty": told}, lines)
    return DONE


SAMPLES = Command(
    "List the drawings that come with foldcut; `foldcut make` takes their names as SHAPE.",
    EXAMPLES,
    add_options,
    samples,
)
