"""Fold all samples by the default command and write what that takes: the table behind ``foldcut samples --long``.

Run it with ``python tests/bench/difficulty.py [SAMPLE ...]``; it writes samples/difficulty.toml, all of it in
some ten minutes.
"""

from __future__ import annotations

import sys

from support.places import ROOT

from foldcut.pipeline import Result, fold
from foldcut.samples import FoldCounts, fold_counts, sample_names, sample_path

TABLE = ROOT / "samples/difficulty.toml"

HEAD = """\
# What it takes to fold each sample on A4 by the default command: how many folds, how many of them close together,
# how many layers the cut goes through, and the shortest crease. Written by tests/bench/difficulty.py.
"""


def counts_of(result: Result) -> FoldCounts:
    """Return what it takes to fold a pattern."""
    shortest = result.foldability.shortest_crease_mm
    assert shortest is not None
    phases = result.phases
    together = sum(phase.count for phase in phases if phase.together) if phases else result.actions
    folds = sum(phase.count for phase in phases) if phases else result.actions
    return FoldCounts(folds, together, result.foldability.layers_at_cut, float(f"{shortest:.3g}"))


def row(name: str, counts: FoldCounts) -> str:
    """Return a line of the table."""
    return f"{name} = {{ {', '.join(f'{field} = {value}' for field, value in counts._asdict().items())} }}\n"


def main() -> None:
    """Count, and write the table."""
    names = sys.argv[1:] or sample_names(lines=True)
    table = fold_counts() if sys.argv[1:] else {}
    for name in names:
        table[name] = counts_of(fold(sample_path(name), symmetry="auto", next_level=False))
        print(row(name, table[name]), end="", flush=True)
        lines = [row(one, counts) for one, counts in sorted(table.items())]
        TABLE.write_text(HEAD + "".join(lines), encoding="utf-8")


if __name__ == "__main__":
    main()
