"""Golden bytes: whether a change to the code leaves every output as it was, byte for byte.

All samples by all methods (with bounded effort), in all formats, for all machines, and what the other commands write::

    python tests/golden_bytes.py record out/golden.json     # before the change
    python tests/golden_bytes.py compare out/golden.json    # after it: prints what differs, exits with 1 if anything

The hashes hold on one machine with one set of libraries only, so they are not kept in the repository. ``--quick`` does
three samples by all methods and takes a tenth of the time; ``--only WORD`` does the tasks whose name has this word.
Everything goes through the command line, which is all that this script knows of the code.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import io
import json
import os
import re
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

METHODS = ("auto", "mirror", "simple", "compact", "skeleton", "gate", "paper")
PATTERN_FORMATS = ("fold", "svg", "cp", "opx", "png", "html", "stl", "3mf", "step")
SOLID_FORMATS = ("stl", "3mf", "step")
JOB_FORMATS = ("svg", "dxf", "hpgl", "gcode", "pdf", "lbrn2")
FOLDING = ("--effort", "fast", "--min-crease", "0mm", "--force", "--json")
MOST_SOLID = 700
"""Creases of the largest pattern that solids are made of: they take minutes beyond it."""
MOST_JOBS = 1000
"""Creases of the largest pattern that every machine gets; of larger ones only the machines in ``FEW_MACHINES``."""
FEW_MACHINES = ("laser-dxf", "axidraw-a4", "hp-7475a", "grbl-laser", "printer-a4", "lightburn-co2")
QUICK_SAMPLES = ("star", "fish", "letter-a")
VARIANTS = {
    "two-sided": ("--two-sided", "--registration", "holes"),
    "pins": ("--two-sided", "--registration", "pins"),
    "perforated": ("--treatment", "perforate"),
    "drawn": ("--treatment", "draw", "--marks", "outline,first-folds,cut-line,numbers,title,ruler"),
    "scored": ("--treatment", "score", "--marks", "none"),
}
CONSTRUCTION = "packing,molecules,rabbit-ear,gusset,inset,trees,matching,ribbon"
OPTIONS = {
    "simplified": ("swan", "--simplify", "1mm"),
    "placed": ("fish", "--scale", "1:4", "--offset", "40,50", "--rotate", "30", "--sheet", "a3-landscape"),
    "ribbon": ("boat", "--ribbon", "0.4mm", "--method", "paper"),
    "free-ribbon": ("arrow", "--ribbon", "0.4mm"),
    "symmetric": ("tree", "--symmetry", "0.5mm", "--width", "90mm"),
    "corners": ("marlin", "--corners", "16", "--min-feature", "0.5mm", "--mirror"),
    "unmoved": ("house", "--adjust", "0mm", "--method", "skeleton"),
    "long": ("cat", "--min-crease", "0.5mm"),
    "normal": ("bolt", "--effort", "normal"),
    "text": ("--text", "L", "--corners", "12"),
}

IN_WORDS = ("seconds", "notes", "next", "error", "files", "told")
"""Keys of the report that are not compared: times, paths, and what is in words."""

Found = dict[str, str]


def run(arguments: list[str]) -> tuple[int, str]:
    """Run one command in this process; return its exit status and what it prints on standard output."""
    from foldcut.cli.main import main

    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()):
        try:
            status = main(arguments)
        except SystemExit as error:
            status = int(error.code or 0)
        except Exception as error:  # a fault, but the same one before and after
            return 99, json.dumps({"raised": type(error).__name__})
    return status, out.getvalue()


def hashed(name: str, arguments: list[str], *, report: bool = True) -> tuple[Found, dict[str, object]]:
    """Run a command in a new folder; return the hash of each file that it writes and of its report, and the report."""
    here = os.getcwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            status, text = run(arguments)
            found = {f"{name} status": str(status)}
            for path in sorted(path for path in Path().rglob("*") if path.is_file()):
                found[f"{name} {path}"] = hashlib.sha256(path.read_bytes()).hexdigest()[:16]
        finally:
            os.chdir(here)
    told: dict[str, object] = {}
    with contextlib.suppress(ValueError):
        told = json.loads(text)
    # what is said in words may be said better; what is said in numbers may not change
    numbers = {key: value for key, value in told.items() if key not in IN_WORDS}
    numbers["attempts"] = [{**one, "failure": ""} for one in told.get("attempts", ())]  # type: ignore[attr-defined]
    if report and told:
        found[f"{name} report"] = hashlib.sha256(json.dumps(numbers, sort_keys=True).encode()).hexdigest()[:16]
    return found, told


def files(stem: str, formats: tuple[str, ...] | list[str]) -> list[str]:
    return [word for name in formats for word in ("-o", f"{stem}.{name}")]


def fold(sample: str, method: str) -> Found:
    """Fold a sample by a method and write all formats, for no machine and for every machine."""
    name = f"{sample} {method}"
    with tempfile.TemporaryDirectory() as folder:
        pattern = str(Path(folder) / f"{sample}.fold")
        status, text = run(["make", sample, "--method", method, *FOLDING, "-o", pattern])
        if status:
            return {f"{name} status": str(status)}
        told = json.loads(text)
        creases = int(told["creases"])
        formats = [one for one in PATTERN_FORMATS if one not in SOLID_FORMATS or creases <= MOST_SOLID]
        found, _ = hashed(name, ["make", sample, "--method", method, *FOLDING, *files("x", formats)])
        for machine, allowed in machine_formats().items():
            if not allowed or (creases > MOST_JOBS and machine not in FEW_MACHINES):
                continue
            variants = {"": ()} | (VARIANTS if method == "auto" else {})
            for variant, options in variants.items():
                command = ["make", pattern, "--profile", machine, "--json", *options, *files("x", allowed)]
                found |= hashed(f"{name} {machine} {variant}".strip(), command, report=False)[0]
    return found


def machine_formats() -> dict[str, list[str]]:
    """Return, by machine, the formats of jobs that it takes; found once a process by trying them on a star."""
    if not MACHINES:
        names = [one["name"] for one in json.loads(run(["profiles", "--json"])[1])["profiles"]]
        here = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            run(["make", "star", "--effort", "fast", "-o", "star.fold"])
            for machine in names:
                MACHINES[machine] = [
                    one
                    for one in JOB_FORMATS
                    if run(["make", "star.fold", "--profile", machine, "-o", f"x-{machine}.{one}"])[0] == 0
                ]
            os.chdir(here)
    return MACHINES


MACHINES: dict[str, list[str]] = {}


def machines() -> Found:
    """Say which machine takes which formats, its profile, and its test cards."""
    found: Found = {}
    for machine, allowed in machine_formats().items():
        found[f"machine {machine} formats"] = ",".join(allowed)
        _, text = run(["profiles", "show", machine, "--json"])
        found[f"machine {machine} profile"] = hashlib.sha256(text.encode()).hexdigest()[:16]
        if allowed:
            found |= hashed(f"coupon {machine}", ["coupon", "--profile", machine, "--json"], report=False)[0]
        for one in ("svg", "stl", "png"):
            command = ["make", "star", "--effort", "fast", "--profile", machine, "-o", f"x.{one}"]
            found |= hashed(f"star for {machine} as {one}", command, report=False)[0]
    return found


def about(sample: str) -> Found:
    """Write what else there is about a sample: pictures, guides, the page, and archives."""
    found: Found = {}
    for ending in ("svg", "png"):
        found |= hashed(f"draw {sample} {ending}", ["draw", sample, "--effort", "fast", "-o", f"x.{ending}"])[0]
    for ending in ("pdf", "html"):
        found |= hashed(f"guide {sample} {ending}", ["guide", sample, "--effort", "fast", "-o", f"x.{ending}"])[0]
    found |= hashed(f"view {sample}", ["view", sample, "--effort", "fast"])[0]
    found |= hashed(f"zip {sample}", ["make", sample, "--effort", "fast", "-o", "x.zip"])[0]
    found |= hashed(f"default {sample}", ["make", sample, "--effort", "fast"])[0]
    zipped = ["make", sample, "--effort", "fast", "--profile", "laser-dxf", "--two-sided", "-o", "x.zip"]
    return found | hashed(f"zip of jobs {sample}", zipped)[0]


def construction() -> Found:
    """Draw how the paper's method builds a pattern."""
    command = ["draw", "triangle", "--method", "paper", "--show", CONSTRUCTION, "--ribbon", "3mm", "-o", "x.svg"]
    return hashed("construction", [*command, "--sheet", "200x180mm", "--margin", "55mm"])[0]


def options(name: str) -> Found:
    effort = () if "--effort" in OPTIONS[name] else ("--effort", "fast")
    allowing = () if "--min-crease" in OPTIONS[name] else ("--min-crease", "0mm")
    return hashed(
        f"options {name}", ["make", *OPTIONS[name], *effort, *allowing, "--json", *files("x", ["fold", "svg"])]
    )[0]


def batch() -> Found:
    """Fold several samples at once; of the journal and the table only the times differ."""
    samples = json.loads(run(["samples", "--json"])[1])["samples"]
    with tempfile.TemporaryDirectory() as folder:
        where = Path(__file__).parents[1] / "samples"
        for path in sorted(where.glob("*.svg")):
            if path.stem in samples[:6]:
                (Path(folder) / path.name).write_bytes(path.read_bytes())
        command = ["batch", folder, "-o", "out", "--effort", "fast", "--profile", "laser-dxf", "--format", "dxf,fold"]
        found, _ = hashed("batch", command, report=False)
    return {key: value for key, value in found.items() if not re.search(r"results\.csv|\.jsonl", key)}


def work(task: tuple[str, ...]) -> tuple[tuple[str, ...], float, Found]:
    """Do one task; return it with the seconds that it took."""
    started = time.monotonic()
    kind, *rest = task
    found = {"fold": fold, "about": about, "options": options, "machines": machines, "construction": construction}.get(
        kind, batch
    )(*rest)
    return task, time.monotonic() - started, found


def tasks(*, quick: bool) -> list[tuple[str, ...]]:
    names = json.loads(run(["samples", "--json"])[1])["samples"]
    samples = [name for name in names if not quick or name in QUICK_SAMPLES]
    every = [("machines",), ("construction",), *(("about", sample) for sample in samples)]
    every += [("options", name) for name in OPTIONS]
    every += [("fold", sample, method) for method in METHODS for sample in samples]
    return every if quick else [("batch",), *every]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("action", choices=("record", "compare"))
    parser.add_argument("file", type=Path, help="the hashes, as JSON")
    parser.add_argument("--quick", action="store_true", help="three samples only")
    parser.add_argument("--only", default="", help="tasks whose name has this word")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--verbose", action="store_true", help="tell how long each task took")
    arguments = parser.parse_args()
    before = json.loads(arguments.file.read_text()) if arguments.action == "compare" else {}
    if arguments.action == "record":
        arguments.file.parent.mkdir(parents=True, exist_ok=True)
    chosen = [task for task in tasks(quick=arguments.quick) if arguments.only in " ".join(task)]
    found: dict[str, Found] = {}
    with ProcessPoolExecutor(arguments.processes) as pool:
        for task, seconds, some in pool.map(work, chosen):
            found[" ".join(task)] = some
            if arguments.action == "record":
                arguments.file.write_text(json.dumps(found, indent=1, sort_keys=True))
            if arguments.verbose:
                print(f"{seconds:7.1f} s  {' '.join(task)}: {len(some)}", flush=True)
    files_now = sum(len(some) for some in found.values())
    if arguments.action == "record":
        print(f"{files_now} outputs of {len(found)} tasks recorded in {arguments.file}")
        return 0
    differ = []
    for task, now in found.items():
        if task not in before:
            differ.append(f"{task}: not recorded before")
            continue
        then = before[task]
        differ += [
            f"{key}: {then.get(key)} -> {now.get(key)}"
            for key in sorted({*then, *now})
            if then.get(key) != now.get(key)
        ]
    print("\n".join(differ[:200]))
    print(f"{files_now} outputs of {len(found)} tasks compared: {len(differ)} differ")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
