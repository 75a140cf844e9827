"""Disks, creases, seconds and peak memory for every sample, and how the work grows with the size of the input.

Run it with ``make bench``, or ``python tests/bench/bench.py [OUT.json]``. Every shape runs in a process of its own, so
that peak memory is its own; times are wall-clock on whatever machine this is, so compare ratios within one run.
"""

from __future__ import annotations

import json
import math
import platform
import resource
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).parent
SIZES = (20, 40, 80, 160, 320)


def measure(shape: object) -> dict[str, float]:
    """Fold one shape on A4 and return its numbers."""
    import foldcut
    from foldcut.pipeline import PaperStages

    result = foldcut.fold(shape, method="paper")  # type: ignore[arg-type]
    assert isinstance(result.stages, PaperStages)
    creases = result.folded_pattern.creases
    return {
        "boundary_disks": int(result.stages.packing.boundary_count),
        "disks": len(result.stages.packing.radii),
        "creases": creases.crease_count,
        "build_s": result.seconds["build"],
        "verify_s": result.seconds["verify"],
        "verify_to_build": result.seconds["verify"] / result.seconds["build"],
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        "verified": result.verified,
    }


def wavy_disc(corners: int) -> list[tuple[float, float]]:
    """A gear with rounded-off random teeth: its number of boundary disks grows with its corners."""
    points = []
    for k in range(corners):
        radius = 1.0 + 0.6 * math.pi / corners * (1 if k % 2 else -1) * (1 + 0.3 * math.sin(7.0 * k))
        points.append((radius * math.cos(2 * math.pi * k / corners), radius * math.sin(2 * math.pi * k / corners)))
    return points


def in_own_process(what: str) -> dict[str, float]:
    """Measure a sample's name, or "wavy:N", in a new interpreter."""
    run = subprocess.run([sys.executable, __file__, "--one", what], capture_output=True, text=True, check=True)
    return json.loads(run.stdout)


def exponent(rows: list[dict[str, float]]) -> float:
    """The slope of log(build seconds) over log(boundary disks) between 100 and 1,000 disks, by least squares."""
    used = [row for row in rows if 90 <= row["boundary_disks"] <= 1300]
    x = [math.log(row["boundary_disks"]) for row in used]
    y = [math.log(row["build_s"]) for row in used]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y, strict=True)) / sum((a - mean_x) ** 2 for a in x)


def main(argv: list[str]) -> None:
    if argv[:1] == ["--one"]:
        from foldcut.samples import sample_path

        what = argv[1]
        shape = [wavy_disc(int(what[5:]))] if what.startswith("wavy:") else sample_path(what)
        print(json.dumps(measure(shape)))
        return
    from foldcut.samples import sample_names

    started = time.perf_counter()
    report: dict[str, object] = {"python": platform.python_version(), "machine": platform.machine()}
    columns = ("boundary_disks", "disks", "creases", "build_s", "verify_s", "verify_to_build", "peak_mb")
    print(f"{'shape':<16}" + "".join(f"{name:>16}" for name in columns))

    def row(name: str, what: str) -> dict[str, float]:
        numbers = in_own_process(what)
        cells = "".join(
            f"{numbers[c]:>16.2f}" if isinstance(numbers[c], float) else f"{numbers[c]:>16}" for c in columns
        )
        print(f"{name:<16}{cells}{'' if numbers['verified'] else '  NOT VERIFIED'}", flush=True)
        return numbers

    samples = {}
    for name in sample_names():
        try:
            samples[name] = row(name, name)
        except subprocess.CalledProcessError as error:
            print(f"{name:<16}  refused: {error.stderr.strip().splitlines()[-1][:90]}")
    growth = [row(f"gear of {n}", f"wavy:{n}") for n in SIZES]
    report |= {"samples": samples, "growth": growth, "build_exponent": exponent(growth)}
    print(f"build time grows as boundary disks to the power {report['build_exponent']:.2f}")
    print(f"done in {time.perf_counter() - started:.0f} s")
    if argv:
        Path(argv[0]).write_text(json.dumps(report, indent=1) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
