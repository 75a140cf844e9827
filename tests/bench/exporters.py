"""Seconds that each format takes for one job, and the way between strokes: ``make bench-exporters``, or with a drawing.

    python tests/bench/exporters.py [DRAWING] [--out OUT.json]

Times are wall-clock on whatever machine this is; "to_fold" is the ratio to the search of ``--effort fast`` in this run.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path

import foldcut
from foldcut.exporters import PATTERN_EXPORTERS, export, export_job
from foldcut.job import make_jobs
from foldcut.marks import MARKS
from foldcut.profiles import load_profile
from foldcut.samples import sample_path

MACHINES = ("laser-dxf", "silhouette-cameo", "glowforge", "grbl-laser", "grbl-plotter", "roland-dxy", "printer-a4")


def seconds(do: Callable[[], object]) -> float:
    """Return how long the second run takes: the first imports."""
    do()
    start = time.perf_counter()
    do()
    return time.perf_counter() - start


def main() -> None:
    """Print the table, and write it as JSON where asked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("drawing", nargs="?", type=Path, default=sample_path("boat"))
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    start = time.perf_counter()
    pattern = foldcut.fold(args.drawing, "180x250mm", effort="fast", min_crease=0).require_verified()
    fold = time.perf_counter() - start
    (job,) = make_jobs(pattern, load_profile("laser-dxf"))
    rows: dict[str, float] = {}
    for name in MACHINES:
        profile = load_profile(name)
        suffix = f".{profile.format}"
        rows[f"{name} {suffix}"] = seconds(lambda s=suffix, p=profile: export_job(make_jobs(pattern, p)[0], s, p))  # type: ignore[misc]
    laser = load_profile("laser-dxf")
    rows["job with all marks"] = seconds(lambda: make_jobs(pattern, laser, marks=tuple(MARKS)))
    for suffix in PATTERN_EXPORTERS:
        rows[suffix] = seconds(lambda s=suffix: export(pattern, s))  # type: ignore[misc]
    print(f"{pattern.creases.crease_count} creases, folded in {fold:.2f} s")
    for name, took in rows.items():
        print(f"{name:28s} {took:7.3f} s  {took / fold:6.3f} of the fold")
    print(f"way between strokes {job.travel:.0f} mm, in the pattern's order {job.travel_before:.0f} mm")
    if args.out:
        result = {
            "creases": pattern.creases.crease_count,
            "fold_s": fold,
            "to_fold": {name: took / fold for name, took in rows.items()},
            "travel_mm": job.travel,
            "travel_before_mm": job.travel_before,
        }
        args.out.write_text(json.dumps(result, indent=2))


if __name__ == "__main__":
    main()
