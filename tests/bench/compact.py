"""Compare the creases and folds of a method with those of the paper's method, and of another program if known.

Run it with ``make bench-compact`` or ``python tests/bench/compact.py [--method M] [--effort E] [--out OUT.json]
[FOLDER ...]``. It folds all samples, and then every JSON shape below the folders. Each line of a file ``peer.tsv`` in a
folder has a class, the name of a shape, and the number of creases that another program makes, or ``fails``. Times are
wall-clock times of one shape after the other: compare them only within one run.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from pathlib import Path
from typing import Any

import foldcut
from foldcut.drawing.shape import make_shape
from foldcut.readers import read_shape
from foldcut.samples import sample_names, sample_path


def peers(folders: list[Path]) -> dict[str, str]:
    """Return the creases that another program makes, or ``fails``, by the name of the shape."""
    lines = [line for folder in folders for file in folder.rglob("peer.tsv") for line in file.read_text().splitlines()]
    rows = [line.split("\t") for line in lines if not line.startswith("#")]
    return {row[1]: row[2].strip() for row in rows if len(row) == 3}


def measure(path: Path, method: str, effort: str) -> dict[str, Any]:
    """Fold one shape on A4 with a method, and if it has one loop, with the paper's method."""
    loops = make_shape(read_shape(path).loops).loops
    start = time.perf_counter()
    try:
        result = foldcut.fold(path, method=method, effort=effort, min_crease=0)
    except foldcut.UnfoldableError as error:
        return {"loops": len(loops), "refused": str(error)}
    seconds = time.perf_counter() - start
    paper = foldcut.fold(path, method="paper") if len(loops) == 1 else None
    numbers = result.foldability
    return {
        "loops": len(loops),
        "method": result.method,
        "folds": result.actions,
        "corners": result.folded_pattern.shape.corner_count,
        "creases": numbers.creases,
        "lines": numbers.lines,
        "shortest_mm": numbers.shortest_crease_mm,
        "layers_at_cut": numbers.layers_at_cut,
        "paper_creases": paper.folded_pattern.creases.crease_count if paper else None,
        "verified": result.verified and (paper is None or paper.verified),
        "seconds": seconds,
    }


def mean_ratio(rows: list[dict[str, Any]], below: str) -> float:
    """Return the geometric mean of the ratios of creases to another column."""
    return math.exp(sum(math.log(row["creases"] / row[below]) for row in rows) / max(1, len(rows)))


def main() -> None:
    """Print a line for each shape, and the means."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="*", type=Path)
    parser.add_argument("--method", default="auto")
    parser.add_argument("--effort", default="normal")
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    known = peers(args.folders)
    paths = [sample_path(name) for name in sample_names()]
    paths += [path for folder in args.folders for path in sorted(folder.rglob("*.json"))]
    rows: list[dict[str, Any]] = []
    for path in paths:
        row = {"shape": path.stem, **measure(path, args.method, args.effort)}
        rows.append(row)
        peer = known.get(path.stem, "")
        if peer.isdigit():
            row["peer_creases"] = int(peer)
        print(f"{row['shape']:30s} {line_of(row)}  peer {peer}", flush=True)
    folded = [row for row in rows if "refused" not in row]
    one = [row for row in folded if row["loops"] == 1]
    small = [row for row in one if row["corners"] <= 15]
    long = sum(row["shortest_mm"] >= 3 for row in small)
    print(f"creases / the paper's method's, geometric mean of {len(one)}: {mean_ratio(one, 'paper_creases'):.3f}")
    print(f"one loop, up to 15 corners: shortest crease at least 3 mm in {long} of {len(small)}")
    print(f"shortest crease at least 0.5 mm in {sum(row['shortest_mm'] >= 0.5 for row in folded)} of {len(folded)}")
    print(f"several loops: {len(folded) - len(one)} of {len([row for row in rows if row['loops'] > 1])} verified")
    against = [row for row in one if "peer_creases" in row]
    if against:
        print(f"creases / the other program's, mean of {len(against)}: {mean_ratio(against, 'peer_creases'):.3f}")
    if args.out:
        args.out.write_text(json.dumps(rows, indent=1))


def line_of(row: dict[str, Any]) -> str:
    """Return a line with what was measured for a shape."""
    if "refused" in row:
        return f"{row['loops']} loops, refused: {row['refused'].split(':')[1].strip()}"
    ratio = f"paper {row['paper_creases']:6d}" if row["paper_creases"] else f"{row['loops']} loops     "
    return (
        f"{row['corners']:3d} corners {row['method']:7s} {row['creases']:5d} creases {row['folds']:5d} folds "
        f"shortest {row['shortest_mm']:8.4f} mm  {row['layers_at_cut']:3d} layers  {ratio}  {row['seconds']:5.1f} s  "
        f"{'verified' if row['verified'] else 'NOT VERIFIED'}"
    )


if __name__ == "__main__":
    main()
