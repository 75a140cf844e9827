"""How many simple folds drawings take, and how many creases are left to close together: the table of a page in docs.

    python tests/bench/simple_folds.py                             # the table of this version
    python tests/bench/simple_folds.py --save out/simple.json      # and keep the numbers
    python tests/bench/simple_folds.py --beside out/simple.json    # beside those of another version

``docs/simple-folds.md`` has the table. The drawings are folded as they are, on A4, by the default command.
"""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path

from foldcut.core.errors import UnfoldableError
from foldcut.folding_steps import folding_steps
from foldcut.pipeline import fold
from foldcut.samples import sample_path

Points = list[tuple[float, float]]
Row = tuple[str, int, int, int]
"""The method, how many folds in all, how many of them are simple, and creases left to close together."""


def polygon(corners: int) -> Points:
    """Return a regular polygon with a corner on top."""
    turns = [2 * math.pi * k / corners for k in range(corners)]
    return [(50 * math.sin(turn), 50 * math.cos(turn)) for turn in turns]


def star(points: int, ratio: float) -> Points:
    """Return a star with a point on top; ``ratio``: how far its inner corners are from the middle."""
    turns = [math.pi * k / points for k in range(2 * points)]
    reach = [50 * (1 if k % 2 == 0 else ratio) for k in range(2 * points)]
    return [(r * math.sin(turn), r * math.cos(turn)) for r, turn in zip(reach, turns, strict=True)]


SAMPLES = (
    "star",
    "hexagon",
    "square",
    "plus",
    "kite",
    "ring",
    "two-triangles",
    "tree",
    "arrow",
    "heart",
    "paper-chain",
)
DRAWINGS: dict[str, list[Points] | Path] = {
    **{f"sample {name}": sample_path(name) for name in SAMPLES if name != "paper-chain"},
    "sample paper-chain": Path(__file__).parents[2] / "samples" / "paper-chain.svg",
    "rhombus": [[(0, 60), (35, 0), (0, -60), (-35, 0)]],
    "rectangle": [[(0, 0), (80, 0), (80, 50), (0, 50)]],
    "house with an axis": [[(-40, -30), (40, -30), (40, 30), (0, 65), (-40, 30)]],
    "house with a low roof": [[(-40, -30), (40, -30), (40, 30), (0, 45), (-40, 30)]],
    **{f"regular {n}-gon": [polygon(n)] for n in range(3, 13)},
    **{f"star with {n} points": [star(n, 0.5)] for n in (3, 4, 6, 8, 12)},
    "hexagon with a hole": [polygon(6), [(0.4 * x, 0.4 * y) for x, y in polygon(6)]],
    "triangle of no symmetry": [[(0, 0), (70, 10), (25, 60)]],
}


def measure(drawing: list[Points] | Path) -> Row | str:
    """Return the numbers of a drawing, or why it is not folded."""
    try:
        result = fold(drawing, "a4", exact=True)
    except UnfoldableError as error:
        return str(error).partition(";")[0]
    pattern = result.require_verified()
    steps = folding_steps(pattern)
    straight = sum(step.line is not None for step in steps)
    together = sum(len(step.edges) for step in steps if step.line is None)
    return result.method, result.actions, straight, together


def table(rows: dict[str, Row | str], beside: dict[str, Row | str]) -> list[str]:
    """Return the lines of the table in Markdown."""
    before = ["before: folds", "simple", "creases left"] if beside else []
    head = ["drawing", *before, "method", "folds", "simple", "creases left"]
    lines = [head, ["---"] * len(head)]
    for name, row in rows.items():
        other = beside.get(name)
        cells = [] if not beside else [str(x) for x in other[1:]] if isinstance(other, tuple | list) else ["-"] * 3
        lines.append([name, *cells, *(map(str, row) if not isinstance(row, str) else [row, "", "", ""])])
    return ["| " + " | ".join(line) + " |" for line in lines]


def main() -> None:
    """Measure all drawings and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--save", type=Path, help="write the numbers to this file")
    parser.add_argument("--beside", type=Path, help="show the numbers of this file, too")
    arguments = parser.parse_args()
    beside = json.loads(arguments.beside.read_text()) if arguments.beside else {}
    rows = {name: measure(drawing) for name, drawing in DRAWINGS.items()}
    if arguments.save:
        arguments.save.write_text(json.dumps(rows))
    print("\n".join(table(rows, beside)))


if __name__ == "__main__":
    main()
