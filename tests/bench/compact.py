"""Creases of the compact method against those of the paper's, and of another program's where these are known.

Run it with ``make bench-compact`` or ``python tests/bench/compact.py [--effort E] [--out OUT.json] [FOLDER ...]``:
samples first, then every JSON shape with one loop below the folders. A file ``peer.tsv`` in a folder has, in each line,
a class, a shape's name, and the creases of another program, or ``fails``. Times are wall-clock, one shape at a time:
compare them within one run.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from pathlib import Path
from typing import Any

import foldcut
from foldcut.readers import read_shape
from foldcut.samples import sample_names, sample_path
from foldcut.shape import make_shape


def peers(folders: list[Path]) -> dict[str, str]:
    """Return what is known of another program, by the shape's name."""
    lines = [line for folder in folders for file in folder.rglob("peer.tsv") for line in file.read_text().splitlines()]
    rows = [line.split("\t") for line in lines if not line.startswith("#")]
    return {row[1]: row[2].strip() for row in rows if len(row) == 3}


def measure(path: Path, effort: str) -> dict[str, Any]:
    """Fold one shape on A4 by both methods."""
    start = time.perf_counter()
    compact = foldcut.fold(path, effort=effort, min_crease=0)
    seconds = time.perf_counter() - start
    paper = foldcut.fold(path, method="paper")
    numbers = compact.foldability
    return {
        "corners": compact.folded_pattern.shape.corner_count,
        "creases": numbers.creases,
        "lines": numbers.lines,
        "shortest_mm": numbers.shortest_crease_mm,
        "layers_at_cut": numbers.layers_at_cut,
        "paper_creases": paper.folded_pattern.creases.crease_count,
        "verified": compact.verified and paper.verified,
        "seconds": seconds,
    }


def mean_ratio(rows: list[dict[str, Any]], below: str) -> float:
    """Return the geometric mean of creases over another column."""
    return math.exp(sum(math.log(row["creases"] / row[below]) for row in rows) / max(1, len(rows)))


def main() -> None:
    """Print a row for each shape, and the means."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="*", type=Path)
    parser.add_argument("--effort", default="normal")
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    known = peers(args.folders)
    paths = [sample_path(name) for name in sample_names()]
    paths += [path for folder in args.folders for path in sorted(folder.rglob("*.json"))]
    rows = []
    for path in paths:
        if len(make_shape(read_shape(path).loops).loops) > 1:
            continue
        row = {"shape": path.stem, **measure(path, args.effort)}
        rows.append(row)
        peer = known.get(path.stem, "")
        if peer.isdigit():
            row["peer_creases"] = int(peer)
        print(
            f"{row['shape']:30s} {row['corners']:3d} corners {row['creases']:5d} creases {row['lines']:5d} lines "
            f"shortest {row['shortest_mm']:8.4f} mm  {row['layers_at_cut']:3d} layers  paper {row['paper_creases']:6d} "
            f"ratio {row['creases'] / row['paper_creases']:.3f}  {row['seconds']:5.1f} s  "
            f"{'verified' if row['verified'] else 'NOT VERIFIED'}  peer {peer}",
            flush=True,
        )
    small = [row for row in rows if row["corners"] <= 15]
    long = sum(row["shortest_mm"] >= 3 for row in small)
    print(f"compact / paper, geometric mean of {len(rows)}: {mean_ratio(rows, 'paper_creases'):.3f}")
    print(f"up to 15 corners: shortest crease at least 3 mm in {long} of {len(small)}")
    against = [row for row in rows if "peer_creases" in row]
    if against:
        print(f"compact / peer, geometric mean of {len(against)}: {mean_ratio(against, 'peer_creases'):.3f}")
    if args.out:
        args.out.write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
