"""What ``check`` decides about Flat-Folder's examples, beside Flat-Folder's own tables and its own time in node.

Run it with a checkout of origamimagiro/flat-folder: ``python tests/bench/flat_folder.py FOLDER [--beside 40]``. One
line a file in ``out/flat-folder.tsv``: folder, number, faces, decision, seconds of the processor, number of orders, and
that of the table; then how many there are of each. ``--beside`` times so many files, drawn at random, by both programs
in turn, one order asked for, in processes that have decided a file before; it prints the ratios and their geometric
mean.
"""

from __future__ import annotations

import argparse
import csv
import json
import random
import subprocess
import tempfile
import time
from collections import Counter
from pathlib import Path

import numpy as np

from foldcut.core.errors import FoldcutError
from foldcut.drawing.limits import Limits
from foldcut.foldfile.decide import decide, states_of
from foldcut.foldfile.read import read_fold
from foldcut.readers.apart import apart

MOST_FACES = {"grids": 500, "instagram": 500, "unsatisfiable": 1000}
"""Files with more faces are passed over."""

LIMITS = Limits(seconds=60, megabytes=4096)
"""What deciding a file, or counting its orders, may take."""

WARM = "examples/instagram/001_traditional_Sailboat.fold"
"""The file that each process decides first."""

NODE = """
import { BATCH } from "./src/batch.js"; import { CON } from "./src/constraints.js";
import { NOTE } from "./src/note.js"; import * as fs from "fs";
NOTE.show = false; CON.build();
for (const name of process.argv.slice(2)) {
  const fold = JSON.parse(fs.readFileSync(name)); fold.number = 0;
  const log = console.log; console.log = () => {};
  const before = process.cpuUsage();
  await BATCH.process_file(fold, 1);
  const used = process.cpuUsage(before); console.log = log;
  console.log((used.user + used.system) / 1e6);
}
"""
"""Decides files by Flat-Folder and prints the seconds of the processor for each."""


def files_of(folder: Path, kind: str) -> list[tuple[Path, int]]:
    """Return the files of a folder of examples that are not too large, with the number of their faces."""
    found = []
    for path in sorted((folder / "examples" / kind).glob("*.fold")):
        faces = len(json.loads(path.read_text()).get("faces_vertices", []))
        if faces <= MOST_FACES[kind]:
            found.append((path, faces))
    return found


def decided(path: Path) -> tuple[str, float]:
    """Return what is decided about a file, and the seconds of the processor that it takes."""

    def work() -> tuple[str, float]:
        start = time.process_time()
        folds = decide(read_fold(path)).folds
        return {True: "folds", False: "does not fold", None: "not decided"}[folds], time.process_time() - start

    try:
        return apart(work, LIMITS, path.name, option=False)
    except FoldcutError as error:
        return str(error), float(LIMITS.seconds)


def counted(path: Path) -> str:
    """Return the number of layer orders of a file, or that they are too many."""

    def work() -> str:
        read = read_fold(path)
        states = states_of(read, decide(read))
        return "too many" if states is None else str(states.number)

    try:
        return apart(work, LIMITS, path.name, option=False)
    except FoldcutError:
        return "given up"


def table(folder: Path, kind: str) -> dict[str, dict[str, str]]:
    """Return the rows of Flat-Folder's own table by number."""
    path = folder / "examples" / f"{kind}_data.csv"
    if not path.exists():
        return {}
    with path.open() as file:
        return {row["number"]: row for row in csv.DictReader(file)}


def compare(folder: Path, out: Path, kinds: list[str]) -> None:
    """Decide all files and count their orders."""
    with out.open("w") as lines:
        for kind in kinds:
            rows, answers, counts, longest = table(folder, kind), Counter[str](), Counter[str](), 0.0
            for path, faces in files_of(folder, kind):
                number = path.name[:3]
                answer, seconds = decided(path)
                answers[answer] += 1
                longest = max(longest, seconds)
                count, theirs = "", rows.get(number, {})
                if answer == "folds" and theirs:
                    count = counted(path)
                    is_whole = theirs["limited"] == "no limit"
                    told = "equal" if count == theirs["states"] else count if not count.isdigit() else "another number"
                    counts[f"{told}, {'the whole number' if is_whole else 'a part of it'} in the table"] += 1
                words = (kind, number, faces, answer, f"{seconds:.3f}", count, theirs.get("states", ""))
                print(*words, theirs.get("limited", ""), sep="\t", file=lines, flush=True)
            print(f"{kind}: {dict(answers)}, the longest {longest:.1f} s; orders: {dict(counts)}", flush=True)


def beside(folder: Path, count: int, seed: int) -> None:
    """Time files by both programs."""
    every = [path for kind in ("grids", "instagram") for path, _ in files_of(folder, kind)]
    decide(read_fold(folder / WARM))
    ratios = list[float]()
    with tempfile.NamedTemporaryFile("w", suffix=".mjs", dir=folder) as script:
        script.write(NODE)
        script.flush()
        for path in random.Random(seed).sample(every, count):
            start = time.process_time()
            decide(read_fold(path))
            ours = time.process_time() - start
            command = ["node", script.name, WARM, str(path.relative_to(folder))]
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
            theirs = float(done.stdout.split()[-1])
            ratios.append(ours / theirs)
            print(f"{path.parent.name}/{path.name}\t{ours:.3f} s\t{theirs:.3f} s\t{ratios[-1]:.2f}", flush=True)
    mean = float(np.exp(np.log(ratios).mean()))
    print(f"{len(ratios)} files: geometric mean of the ratios {mean:.3f}, the largest {max(ratios):.2f}")


def main() -> None:
    """Do what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--beside", type=int, default=0, metavar="COUNT", help="only time so many files by both")
    parser.add_argument("--seed", type=int, default=22)
    parser.add_argument("--kinds", default="unsatisfiable,grids,instagram")
    parser.add_argument("--out", type=Path, default=Path("out", "flat-folder.tsv"))
    args = parser.parse_args()
    folder = args.folder.resolve()
    if args.beside:
        beside(folder, args.beside, args.seed)
        return
    args.out.parent.mkdir(parents=True, exist_ok=True)
    compare(folder, args.out, args.kinds.split(","))


if __name__ == "__main__":
    main()
