"""Fold silhouettes of icon sets and count what is verified, and why the rest is not.

Run it with ``make sweep-icons`` or ``python tests/bench/icons.py [--count 200] [--corners 60] [--effort E] [--seed 1]
[--out OUT.json] [FOLDER ...]``: icons of one path with one subpath, in an order that the seed gives, out of the
folders, or else out of the sets that tests/tools.sh installs. Those with more than one loop when they are read are
left out. Seconds are of the processor.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent))

from support.icons import fold_icon, icon_folders, silhouettes


def main() -> int:
    """Print a row for each icon, and the sums; return 1 if one is not verified."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="*", type=Path)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--corners", type=int, default=60)
    parser.add_argument("--effort", default="fast")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    folders = args.folders or icon_folders()
    if not folders:
        parser.error("no icon sets are installed; run make tools, or name folders of SVG files")
    rows: list[dict[str, Any]] = []
    for path in silhouettes(folders, args.seed):
        if len(rows) == args.count:
            break
        row = fold_icon(path, args.corners, args.effort)
        if row.get("loops", 1) == 1:
            rows.append(row)
            print(f"{row['icon']:34s} {line_of(row)}", flush=True)
    print("\n".join(table(rows)))
    if args.out:
        args.out.write_text(json.dumps(rows, indent=1))
    return int(any(row["failure"] for row in rows))


def line_of(row: dict[str, Any]) -> str:
    """Return what was measured of an icon, in a line."""
    if row["failure"]:
        return row["failure"]
    return (
        f"{row['points']:4d} -> {row['corners']:2d} corners, {row['off_mm']:5.2f} mm off  {row['method']:7s} "
        f"{row['creases']:5d} creases, shortest {row['shortest_mm']:7.4f} mm  {row['seconds']:5.1f} s"
    )


def table(rows: list[dict[str, Any]]) -> list[str]:
    """Return the sums."""
    good = [row for row in rows if not row["failure"]]
    lines = [f"verified: {len(good)} of {len(rows)}"]
    lines += [f"{count} x {reason}" for reason, count in Counter(r["failure"] for r in rows if r["failure"]).items()]
    methods = Counter(row["method"] for row in good)
    lines.append("methods: " + ", ".join(f"{method} {count}" for method, count in methods.most_common()))
    for key, unit in (("corners", ""), ("off_mm", "mm"), ("creases", ""), ("shortest_mm", "mm"), ("seconds", "s")):
        low, median, high = np.quantile([row[key] for row in good], [0, 0.5, 1])
        lines.append(f"{key.removesuffix('_mm')}: {low:.4g} to {high:.4g} {unit}, half up to {median:.4g}")
    lines.append(f"shortest crease at least 0.5 mm in {sum(row['shortest_mm'] >= 0.5 for row in good)}")
    return lines


if __name__ == "__main__":
    sys.exit(main())
