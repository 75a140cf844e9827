"""How the paper's method grows: seconds of each stage and peak memory for loops of 1e2 to 1e6 boundary disks.

Run it with ``make bench-scale``, or ``python tests/bench/scale.py [--sizes 1e2,1e3,1e4,1e5] [--kinds star,koch]
[--seed N] [--repeat N] [--no-verify] [--out FOLDER]``. Loops are seeded: ``star`` is star-shaped with a rough outline,
``koch`` a Koch snowflake whose every bump is turned and sized at random. Every loop runs in a process of its own, so
that peak memory is its own. Shape and sheet are made beforehand and are not timed; nor is the import of the stages and
the loading of compiled code, which is given by itself. Times are the process's own seconds (one thread), as the machine
may be busy with other things.

``scipy.spatial.Delaunay`` on the centres of the same disks is timed in the same process: the floor for touching that
many points. Compare ratios within one run. The folder gets scale.json, scale.md (the table) and scale.svg (the plot).
"""

from __future__ import annotations

import argparse
import html
import json
import math
import platform
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

SIZES = (1e2, 1e3, 1e4, 1e5)
KINDS = ("star", "koch")
STAGES = ("boundary", "packing", "molecules", "assignment", "layers")
DISKS_A_CORNER = {"star": 4.0, "koch": 5.2}
RIBBON = 0.05
"""Of the shortest edge: the half-width of the ribbon, which has to fit the finest features."""


def star_loop(corners: int, seed: int) -> np.ndarray:
    """Return a loop, ``(corners, 2)``, seen whole from the origin, as rough on every scale."""
    rng = np.random.default_rng(seed)
    turn = (np.arange(corners) + 0.4 * (rng.random(corners) - 0.5)) / corners
    radius = np.full(corners, 1.0)
    waves = 3
    while waves < corners / 4:
        radius += 0.5 / waves * np.sin(2 * math.pi * (waves * turn + rng.random()))
        waves *= 2
    radius += 1.5 / corners * (rng.random(corners) - 0.5)
    return np.column_stack([radius * np.cos(2 * math.pi * turn), radius * np.sin(2 * math.pi * turn)])


def koch_loop(corners: int, seed: int) -> np.ndarray:
    """Return a snowflake, about ``(corners, 2)``: each round the longest edges get a bump of random height."""
    rng = np.random.default_rng(seed)
    points = np.exp(2j * math.pi * np.arange(3) / 3)
    while len(points) < corners:
        along = np.roll(points, -1) - points
        bumps = min(len(points), math.ceil((corners - len(points)) / 3))
        chosen = np.zeros(len(points), dtype=bool)
        chosen[np.argsort(-np.abs(along), kind="stable")[:bumps]] = True
        place, height = 0.5 + 0.1 * (rng.random(len(points)) - 0.5), 0.22 + 0.06 * rng.random(len(points))
        one, tip, other = (
            points + (place - 0.15) * along,
            points + (place - 1j * height) * along,
            points + (place + 0.15) * along,
        )
        rows = np.stack([points, one, tip, other], axis=1)
        keep = np.stack([np.ones(len(points), dtype=bool), chosen, chosen, chosen], axis=1)
        points = rows[keep]
    return np.column_stack([points.real, points.imag])


LOOPS: dict[str, Callable[[int, int], np.ndarray]] = {"star": star_loop, "koch": koch_loop}


def measure(kind: str, size: int, seed: int, *, with_verify: bool) -> dict[str, Any]:
    """Fold one loop of about ``size`` boundary disks and return its numbers."""
    from scipy.spatial import Delaunay

    from foldcut.assignment import assign_creases
    from foldcut.boundary import boundary_disks
    from foldcut.layers import fold_layers
    from foldcut.molecules import build_molecules
    from foldcut.packing import MANY_DISKS, fill_gaps
    from foldcut.shape import make_shape
    from foldcut.sheet import parse_sheet, place
    from foldcut.tolerance import Tolerance
    from foldcut.verify import verify

    sheet = parse_sheet("300x300mm")
    loop = LOOPS[kind](max(3, round(size / DISKS_A_CORNER[kind])), seed)
    shape, _ = place(make_shape([loop]), sheet, margin=20.0)
    corners = shape.loops[0]
    ribbon = RIBBON * float(np.hypot(*(np.roll(corners, -1, axis=0) - corners).T).min())
    tolerance = Tolerance.for_sheet(sheet)
    Delaunay(np.random.default_rng(0).random((100, 2)))
    seconds: dict[str, float] = {}

    @contextmanager
    def stage(name: str) -> Iterator[None]:
        start = time.process_time()
        yield
        seconds[name] = time.process_time() - start

    load = 0.0
    if size >= MANY_DISKS:
        from foldcut import packing as module

        small, _ = place(make_shape([star_loop(8, 0)]), sheet)
        disks = boundary_disks(small, sheet, 0.0, tolerance)
        module.MANY_DISKS = 0
        load = _seconds(lambda: fill_gaps(disks, tolerance)) - _seconds(lambda: fill_gaps(disks, tolerance))
        module.MANY_DISKS = MANY_DISKS
    before = peak_bytes()
    with stage("boundary"):
        boundary = boundary_disks(shape, sheet, ribbon, tolerance)
    with stage("packing"):
        packing = fill_gaps(boundary, tolerance)
    boundary_count, disks = len(boundary.radii), len(packing.radii)
    del boundary
    with stage("molecules"):
        molecules = build_molecules(packing, tolerance)
    with stage("assignment"):
        assignment = assign_creases(molecules, packing.face_inside)
    with stage("layers"):
        creases, folded = fold_layers(molecules, assignment)
    used = peak_bytes() - before
    del molecules, assignment
    centres = packing.centres.copy()
    del packing
    yardstick = min(_seconds(lambda: Delaunay(centres)) for _ in range(2))
    build = sum(seconds.values())
    numbers = {
        "corners": len(corners),
        "boundary_disks": boundary_count,
        "disks": disks,
        "creases": creases.crease_count,
        **{f"{name}_s": seconds[name] for name in STAGES},
        "build_s": build,
        "load_s": load,
        "delaunay_s": yardstick,
        "build_to_delaunay": build / yardstick,
        "kb_a_disk": used / 1000 / disks,
    }
    if with_verify:
        numbers["verify_s"] = _seconds(lambda: numbers.update(findings=len(verify(creases, folded.layers, shape))))
        numbers["verify_to_build"] = numbers["verify_s"] / build
    return numbers


def peak_bytes() -> int:
    """Return this process's greatest memory so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def _seconds(do: Callable[[], object]) -> float:
    start = time.process_time()
    do()
    return time.process_time() - start


def exponent(rows: list[dict[str, Any]], column: str, least: float = 700) -> float:
    """Return the slope of log(column) over log(boundary disks), by least squares, from ``least`` disks on."""
    used = [row for row in rows if row["boundary_disks"] >= least and row.get(column)]
    if len(used) < 2:
        return math.nan
    x, y = np.log([row["boundary_disks"] for row in used]), np.log([row[column] for row in used])
    return float(np.polyfit(x, y, 1)[0])


COLUMNS = (
    "boundary_disks",
    "disks",
    "creases",
    *(f"{name}_s" for name in STAGES),
    "build_s",
    "load_s",
    "delaunay_s",
    "build_to_delaunay",
    "verify_s",
    "verify_to_build",
    "kb_a_disk",
)


def table(rows: list[dict[str, Any]], exponents: dict[str, dict[str, float]]) -> str:
    """Return what was measured as a table in Markdown."""
    lines = ["| loop | " + " | ".join(name.replace("_", " ") for name in COLUMNS) + " |"]
    lines.append("| --- |" + " ---: |" * len(COLUMNS))
    for row in rows:
        cells = [_cell(row.get(name)) for name in COLUMNS]
        lines.append(f"| {row['kind']} | " + " | ".join(cells) + " |")
    for kind, values in exponents.items():
        cells = [f"{values[name]:.2f}" if name in values else "" for name in COLUMNS]
        lines.append(f"| exponent, {kind} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _cell(value: float | None) -> str:
    if value is None:
        return ""
    return f"{value:,}" if isinstance(value, int) else f"{value:.3g}"


def plot(rows: list[dict[str, Any]]) -> str:
    """Return seconds over boundary disks, both logarithmic, as an SVG."""
    width, height, left, bottom = 640.0, 420.0, 60.0, 40.0
    lines = {
        f"{kind} {column[:-2]}": [
            (row["boundary_disks"], row[column]) for row in rows if row["kind"] == kind and row.get(column)
        ]
        for kind in dict.fromkeys(row["kind"] for row in rows)
        for column in ("build_s", "verify_s", "delaunay_s")
    }
    points = [point for line in lines.values() for point in line]
    x0, x1 = (f(math.log10(x) for x, _ in points) for f in (min, max))
    y0, y1 = (f(math.log10(y) for _, y in points) for f in (min, max))
    x0, x1, y0, y1 = math.floor(x0), math.ceil(x1), math.floor(y0), math.ceil(y1)

    def at(x: float, y: float) -> tuple[float, float]:
        return (
            left + (math.log10(x) - x0) / (x1 - x0) * (width - left - 160),
            height - bottom - (math.log10(y) - y0) / (y1 - y0) * (height - bottom - 20),
        )

    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" '
        'font-family="sans-serif" font-size="11">',
        f'<rect width="{width:g}" height="{height:g}" fill="white"/>',
    ]
    for power in range(x0, x1 + 1):
        (x, low), (_, high) = at(10.0**power, 10.0**y0), at(10.0**power, 10.0**y1)
        out.append(
            f'<path d="M{x:.1f} {low:.1f}V{high:.1f}" stroke="#ddd"/>'
            f'<text x="{x - 8:.1f}" y="{low + 16:.1f}">1e{power}</text>'
        )
    for power in range(y0, y1 + 1):
        (low, y), (high, _) = at(10.0**x0, 10.0**power), at(10.0**x1, 10.0**power)
        out.append(
            f'<path d="M{low:.1f} {y:.1f}H{high:.1f}" stroke="#ddd"/>'
            f'<text x="{low - 34:.1f}" y="{y + 4:.1f}">1e{power}</text>'
        )
    colours = ("#c0392b", "#e67e22", "#7f8c8d", "#2471a3", "#17a589", "#34495e")
    for number, ((name, line), colour) in enumerate(zip(lines.items(), colours, strict=False)):
        if not line:
            continue
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in (at(*point) for point in line))
        out.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="1.5"/>')
        out += [
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.5" fill="{colour}"/>' for x, y in (at(*point) for point in line)
        ]
        x, y = width - 145, 30 + 16 * number
        out.append(
            f'<path d="M{x:g} {y - 4:g}h18" stroke="{colour}" stroke-width="2"/>'
            f'<text x="{x + 24:g}" y="{y:g}">{html.escape(name)}</text>'
        )
    out.append(
        f'<text x="{(width - 160) / 2:g}" y="{height - 6:g}">boundary disks</text>'
        '<text x="4" y="14">seconds</text></svg>'
    )
    return "\n".join(out) + "\n"


def main() -> None:
    """Print a row for each loop, and write the files where asked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", default=",".join(f"{size:g}" for size in SIZES))
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--repeat", type=int, default=1, help="take the fastest of so many runs")
    parser.add_argument("--no-verify", action="store_true")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--one", nargs=2, help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.one:
        print(json.dumps(measure(args.one[0], int(args.one[1]), args.seed, with_verify=not args.no_verify)))
        return
    rows = []
    for kind in args.kinds.split(","):
        for size in args.sizes.split(","):
            command = [sys.executable, __file__, "--one", kind, str(round(float(size))), "--seed", str(args.seed)]
            command += ["--no-verify"] * args.no_verify
            runs = [subprocess.run(command, capture_output=True, text=True) for _ in range(args.repeat)]
            failed = next((run.stderr.strip().splitlines()[-1] for run in runs if run.returncode), None)
            if failed:
                print(f"{kind} {size}: {failed}", flush=True)
                continue
            row = {"kind": kind, **min((json.loads(run.stdout) for run in runs), key=lambda one: one["build_s"])}
            rows.append(row)
            print(
                kind,
                "  ".join(f"{name} {_cell(row.get(name))}" for name in COLUMNS),
                f"findings {row.get('findings')}",
                flush=True,
            )
    kinds = dict.fromkeys(row["kind"] for row in rows)
    exponents = {
        kind: {
            name: exponent([row for row in rows if row["kind"] == kind], name)
            for name in COLUMNS
            if name.endswith("_s") and name != "load_s"
        }
        for kind in kinds
    }
    print(json.dumps(exponents))
    if args.out:
        args.out.mkdir(parents=True, exist_ok=True)
        report = {
            "python": platform.python_version(),
            "machine": platform.machine(),
            "rows": rows,
            "exponents": exponents,
        }
        (args.out / "scale.json").write_text(json.dumps(report, indent=1) + "\n")
        (args.out / "scale.md").write_text(table(rows, exponents))
        (args.out / "scale.svg").write_text(plot(rows))


if __name__ == "__main__":
    main()
