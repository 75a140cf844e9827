"""The paper's method, its verification and every exporter on loops of 1e2 to 1e6 boundary disks, against yardsticks.

    python tests/bench/bench.py [--largest 1e5] [--sizes 1e2,1e3] [--kinds star,koch] [--without .step,.stl]
        [--limit SECONDS] [--seed N] [--out FOLDER]

``make bench``, or ``make bench LARGEST=1e6``. The folder gets bench.json, bench.md (tables) and bench.svg (a log-log
plot). What the yardsticks are is said in yardsticks.py; those that are not installed (extra ``bench``) are left out.

Each loop is folded in a process of its own, and what is done with the pattern after that, in a copy of the process
(fork), so that peak memory is its own. Times are the processor's, for the machine may be busy with other things: what
is done in less than a fifth of a second is done again and again as long. Shape and sheet are made beforehand and not
timed, nor is the import of what is used, nor the loading of compiled code, which is given by itself. Compare ratios
within one run.

Patterns are folded up to the largest size. Anything else goes on to the next size as long as it is expected to be done
within the limit there, by how it grew so far, and in proportion to the disks at least; it is ended after twice the
limit. Verification has six times as long. The tables end there, and bench.md says why.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import math
import os
import platform
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from items import EXPORTERS, VERIFY, Item, Subject
from loops import LOOPS, loop_of
from report import markdown, plot
from yardsticks import YARDSTICKS

import foldcut
from foldcut.core.compiled import COMPILED, expect_many_drawings
from foldcut.core.model import FoldedPattern
from foldcut.drawing.placement import parse_sheet, place
from foldcut.drawing.shape import make_shape
from foldcut.geometry import box_tree as layertree
from foldcut.methods.disks import packing
from foldcut.methods.disks.boundary import boundary_disks
from foldcut.methods.disks.layers import fold_layers
from foldcut.methods.disks.molecules import build_molecules
from foldcut.methods.disks.tolerance import Tolerance
from foldcut.methods.disks.trees import assign_creases
from foldcut.pattern import face_maps as flatfold

ITEMS = {item.name: item for item in (VERIFY, *EXPORTERS, *YARDSTICKS)}
STAGES = ("boundary", "packing", "molecules", "assignment", "layers")
SHEET = "180x180mm"
RIBBON = 0.05
"""Of the shortest edge, and at most 0.25 mm: the half-width of the ribbon, which has to fit the finest features."""
LIMIT = 12.0
ENDED = 2.0
"""In limits: when something that was expected to be done within the limit is ended."""
LOADING = 15
"""Seconds that an item may take beside, to import and to prepare."""
PACKAGES = ("numpy", "scipy", "shapely", "numba", "triangle", "py-straight-skeleton", "shapely-polyskel")


def measure(kind: str, size: int, seed: int, names: list[str], limit: float) -> dict[str, Any]:
    """Fold a loop of about ``size`` boundary disks, do the items with the pattern, and return the numbers of all."""
    sheet = parse_sheet(SHEET)
    shape, placement = place(make_shape([loop_of(kind, size, seed)]), sheet, margin=12.0)
    corners = shape.loops[0]
    ribbon = min(0.25, RIBBON * float(np.hypot(*(np.roll(corners, -1, axis=0) - corners).T).min()))
    tolerance = Tolerance.for_sheet(sheet)
    small, load = _small(compiled=may_be_compiled(size))
    seconds: dict[str, float] = {}

    @contextmanager
    def stage(name: str) -> Iterator[None]:
        start = time.process_time()
        yield
        seconds[name] = time.process_time() - start

    before = peak_bytes()
    with stage("boundary"):
        boundary = boundary_disks(shape, sheet, ribbon, tolerance)
    with stage("packing"):
        packed = packing.fill_gaps(boundary, tolerance)
    boundary_count = len(boundary.radii)
    del boundary
    with stage("molecules"):
        molecules = build_molecules(packed, tolerance)
    with stage("assignment"):
        assignment = assign_creases(molecules, packed.face_inside)
    with stage("layers"):
        creases, folded = fold_layers(molecules, assignment)
    peak = peak_bytes()
    del molecules, assignment
    pattern = FoldedPattern(creases, folded, sheet, shape, placement, f"{kind} of {boundary_count:,} boundary disks")
    subject = Subject(pattern, packed.centres.copy())
    disks = len(packed.radii)
    del packed
    build = sum(seconds.values())
    return {
        "corners": len(corners),
        "boundary_disks": boundary_count,
        "disks": disks,
        "creases": creases.crease_count,
        "faces": subject.faces,
        "compiled": COMPILED.pays(boundary_count, packing.MANY_DISKS) and may_be_compiled(size),
        **{f"{name}_s": seconds[name] for name in STAGES},
        "build_s": build,
        "load_s": load,
        "peak_mb": peak / 1e6,
        "kb_a_disk": (peak - before) / 1e3 / disks if peak > before else None,
        "items": {name: in_a_copy(partial(_do, ITEMS[name], subject, small, limit)) for name in names},
    }


def may_be_compiled(size: int) -> bool:
    """Whether a loop of about this size may be packed by compiled code."""
    return 2 * size >= packing.MANY_DISKS and importlib.util.find_spec("numba") is not None


def _small(*, compiled: bool) -> tuple[Subject, float]:
    """Return a pattern of few creases, with all loaded that folding takes, and what loading compiled code took."""
    triangle = [[(0, 0), (3, 0), (0, 2)]]

    def by_the_paper() -> foldcut.Result:
        return foldcut.fold(triangle, SHEET, method="paper", min_crease=0)

    by_the_paper()
    load = 0.0
    if compiled:
        nothing_is_few = {packing: "MANY_DISKS", layertree: "MANY_BOXES", flatfold: "MANY_FACES"}
        with ExitStack() as stack:
            for module, name in nothing_is_few.items():
                stack.enter_context(patch.object(module, name, 0))
            load = timed(by_the_paper, runs=1)[0] - timed(by_the_paper, runs=1)[0]
        expect_many_drawings()
    pattern = foldcut.fold(triangle, SHEET, method="compact", effort="fast", min_crease=0).folded_pattern
    return Subject(pattern, np.random.default_rng(0).random((100, 2))), load


def in_a_copy(do: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """Return what a function says in a copy of this process; or "failed" and why."""
    read, write = os.pipe()
    child = os.fork()
    if not child:
        os.close(read)
        try:
            said = json.dumps(do())
        except BaseException as error:
            said = json.dumps({"failed": f"{type(error).__name__}: {error}".splitlines()[0][:200]})
        with os.fdopen(write, "w") as pipe:
            pipe.write(said)
        os._exit(0)
    os.close(write)
    with os.fdopen(read) as pipe:
        said = pipe.read()
    _, status, used = os.wait4(child, 0)
    if said:
        numbers: dict[str, Any] = json.loads(said)
        return numbers
    if os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGXCPU:
        return {"failed": f"ended after {used.ru_utime + used.ru_stime:.0f} s"}
    return {"failed": f"ended with status {status}"}


def _do(item: Item, subject: Subject, small: Subject, limit: float) -> dict[str, Any]:
    if math.isfinite(item.limit):
        end_after(ENDED * item.limit * limit + LOADING)
    item.prepare(small)()
    before = peak_bytes()
    seconds, result = timed(item.prepare(subject))
    peak = peak_bytes()
    return {"s": seconds, "peak_mb": peak / 1e6, "added_mb": (peak - before) / 1e6, **item.numbers(result)}


def end_after(seconds: float) -> None:
    """Let this process be ended once it has taken so many more seconds of the processor."""
    most = math.ceil(time.process_time() + seconds)
    resource.setrlimit(resource.RLIMIT_CPU, (most, most + 5))


def timed(do: Callable[[], Any], runs: int = 100) -> tuple[float, Any]:
    """Return the seconds of the processor that something takes, the mean of the runs in a fifth of a second."""
    start, spent, done = time.process_time(), 0.0, 0
    while done < runs and spent < 0.2:
        result = do()
        spent, done = time.process_time() - start, done + 1
    return spent / done, result


def peak_bytes() -> int:
    """Return this process's greatest memory so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def expected(rows: list[dict[str, Any]], name: str, size: int) -> float | None:
    """Return what an item is going to take for ``size`` disks, by how it grew so far; None: nothing is known yet."""
    known = [(row["size"], row["items"][name]["s"]) for row in rows if "s" in row["items"].get(name, {})]
    if not known:
        return None
    power = 1.0
    if len(known) > 1:
        (n0, s0), (n1, s1) = known[-2:]
        power = min(max(math.log(s1 / s0) / math.log(n1 / n0), 1.0), 2.5)
    last, took = known[-1]
    return float(took * (size / last) ** power)


def choose(
    rows: list[dict[str, Any]], size: int, wanted: list[str], limit: float, left_out: dict[str, str]
) -> list[str]:
    """Return the items for the next size, and note why an item is left out from there on."""
    chosen = []
    for name in wanted:
        if name in left_out:
            continue
        last = rows[-1]["items"].get(name, {}) if rows else {}
        seconds = expected(rows, name, size)
        if "failed" in last:
            left_out[name] = f"{last['failed']}, at {rows[-1]['boundary_disks']:,} boundary disks"
        elif seconds is not None and seconds > ITEMS[name].limit * limit:
            left_out[name] = (
                f"{last['s']:.2g} s at {rows[-1]['boundary_disks']:,} boundary disks; "
                f"some {seconds:.1f} s expected at {size:,}, more than {ITEMS[name].limit * limit:g} s"
            )
        else:
            chosen.append(name)
    return chosen


def sizes_up_to(largest: float) -> list[int]:
    """Return 100, 300, 1,000, 3,000 and so on."""
    return [size for power in range(2, 10) for size in (10**power, 3 * 10**power) if size <= largest]


def run(kind: str, size: int, names: list[str], args: argparse.Namespace) -> dict[str, Any] | None:
    """Measure a loop in a new process; None: it failed."""
    command = [sys.executable, __file__, "--one", kind, str(size), ",".join(names)]
    command += ["--seed", str(args.seed), "--limit", str(args.limit)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        said = done.stderr.strip().splitlines()
        print(f"{kind} {size}: {said[-1] if said else f'status {done.returncode}'}", flush=True)
        return None
    return {"kind": kind, "size": size, **json.loads(done.stdout)}


def installed(package: str) -> str | None:
    """Return a package's version."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def main() -> None:
    """Print a line for each loop, and write the three files."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--largest", type=float, default=1e5, help="boundary disks of the largest loops (1e5)")
    parser.add_argument("--sizes", help="these sizes instead of 1e2, 3e2, 1e3, ...")
    parser.add_argument("--kinds", default=",".join(LOOPS))
    parser.add_argument("--without", default="", help=f"leave these out, with commas: {', '.join(ITEMS)}")
    parser.add_argument("--limit", type=float, default=LIMIT, help=f"seconds that an item may take ({LIMIT:g})")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("out"))
    parser.add_argument("--one", nargs=3, help=argparse.SUPPRESS)
    parser.add_argument("--load", action="store_true", help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.load:
        _small(compiled=True)
        return
    if args.one:
        kind, size, names = args.one
        names = names.split(",") if names else []
        print(json.dumps(measure(kind, int(size), args.seed, names, args.limit)))
        return
    started = time.perf_counter()
    sizes = [round(float(size)) for size in args.sizes.split(",")] if args.sizes else sizes_up_to(args.largest)
    without = args.without.split(",") if args.without else []
    if unknown := set(without) - set(ITEMS):
        parser.error(f"unknown: {', '.join(unknown)}; known: {', '.join(ITEMS)}")
    wanted = [name for name in ITEMS if name not in without]
    missing = [name for name in wanted if (needs := ITEMS[name].needs) and not importlib.util.find_spec(needs)]
    for name in missing:
        print(f"{name} is not installed and left out: pip install '.[bench]'", flush=True)
    if may_be_compiled(max(sizes)):  # the first use on a machine compiles, which is not what is measured
        subprocess.run([sys.executable, __file__, "--load"], check=True)
    kinds = args.kinds.split(",")
    rows: dict[str, list[dict[str, Any]]] = {kind: [] for kind in kinds}
    left_out = {kind: dict.fromkeys(missing, "not installed: extra bench") for kind in kinds}
    for size in sizes:
        for kind in list(kinds):
            row = run(kind, size, choose(rows[kind], size, wanted, args.limit, left_out[kind]), args)
            if row is None:
                kinds.remove(kind)
                continue
            rows[kind].append(row)
            print(
                f"{kind}  {row['boundary_disks']:,} boundary disks  {row['creases']:,} creases  "
                f"build {row['build_s']:.3g} s  "
                + "  ".join(f"{name} {item['s']:.3g} s" for name, item in row["items"].items() if "s" in item)
                + "".join(f"  {name}: {item['failed']}" for name, item in row["items"].items() if "failed" in item),
                flush=True,
            )
            result = {
                "python": platform.python_version(),
                "machine": platform.machine(),
                "packages": {name: installed(name) for name in PACKAGES},
                "seed": args.seed,
                "limit_s": args.limit,
                "took_s": time.perf_counter() - started,
                "processor_s": sum(os.times()[:4]),
                "rows": [row for some in rows.values() for row in some],
                "left_out": left_out,
            }
            write(result, args.out)
    if kinds != args.kinds.split(","):
        sys.exit("not all loops could be measured")
    print(f"{args.out / 'bench.md'}, .json, .svg; {time.perf_counter() - started:.0f} s")


def write(result: dict[str, Any], folder: Path) -> None:
    """Write the three files, after every loop, so that an end before the end leaves what there is."""
    yardsticks = [item.name for item in YARDSTICKS]
    text, exponents = markdown(result, [f"{name}_s" for name in STAGES], yardsticks)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "bench.json").write_text(json.dumps(result | {"exponents": exponents}, indent=1) + "\n")
    (folder / "bench.md").write_text(text)
    (folder / "bench.svg").write_text(plot(result["rows"], yardsticks))


if __name__ == "__main__":
    main()
