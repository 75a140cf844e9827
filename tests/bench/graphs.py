"""How many graphs are folded and verified, with how many folds: the table of ``docs/graphs.md``.

    python tests/bench/graphs.py                      # all parts
    python tests/bench/graphs.py random --seeds 50    # one part, and fewer graphs
    python tests/bench/graphs.py fnc --folder .       # the .fnc files of a program of 2010, which are not part of this

    python tests/bench/graphs.py random --seeds 20 --flat-folder ~/flat-folder     # judged by Flat-Folder, too, in node

Each drawing is folded on A4 as ``foldcut make`` does. Parts: figures, letters (strokes of the font made for folding),
hershey (those of ``hershey-fonts``, if that is installed), random, fnc.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
from support.cut_graphs import GRAPHS, TANGRAM, Lines, chessboard, random_lines

import foldcut
from foldcut.core.arrays import points_array
from foldcut.core.errors import FoldcutError
from foldcut.exporters.pattern import fold as fold_file
from foldcut.pattern.cut_line import pieces_of, sides_of_lines
from foldcut.profiles import load_profile
from foldcut.readers import Drawing

NODE = """
import { BATCH } from "./src/batch.js"; import { CON } from "./src/constraints.js";
import { NOTE } from "./src/note.js"; import * as fs from "fs";
NOTE.show = false; CON.build();
const fold = JSON.parse(fs.readFileSync(process.argv[2])); fold.number = 0;
const log = console.log; console.log = () => {};
let states = 0;
try { states = (await BATCH.process_file(fold, 1)).states; } catch { }
log(String(states));
"""
"""Looks for one folded state by Flat-Folder and prints how many there are."""

LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"


def figures(_: argparse.Namespace) -> Iterator[tuple[str, Lines]]:
    """Yield the figures of the tests, and boards."""
    yield from GRAPHS.items()
    yield "chessboard 4 x 4", chessboard(4)
    yield "tangram", TANGRAM


def letters(_: argparse.Namespace) -> Iterator[tuple[str, Lines]]:
    """Yield the centre lines of the letters of the font made for folding."""
    font = tomllib.loads(files("foldcut.readers").joinpath("folding_font.toml").read_text("utf-8"))
    for letter in LETTERS:
        yield letter, [points_array(stroke) for stroke in font["glyphs"][letter]["strokes"]]


def hershey(_: argparse.Namespace) -> Iterator[tuple[str, Lines]]:
    """Yield the letters of a font of single strokes."""
    from HersheyFonts import HersheyFonts

    font = HersheyFonts()
    font.load_default_font("futural")
    for letter in LETTERS:
        yield letter, [points_array(stroke) * (1.0, -1.0) for stroke in font.strokes_for_text(letter)]


def at_random(args: argparse.Namespace) -> Iterator[tuple[str, Lines]]:
    """Yield planar graphs of up to 12 edges."""
    for seed in range(args.seeds):
        yield f"seed {seed}", random_lines(seed)


def fnc(args: argparse.Namespace) -> Iterator[tuple[str, Lines]]:
    """Yield the graphs in the files of a folder: a box, points, and pairs of points, each after its number."""
    for path in sorted(args.folder.glob("*.fnc")):
        rows = [row.split() for row in path.read_text().splitlines() if row.strip()]
        count = int(rows[1][0])
        points = np.array(rows[2 : 2 + count], dtype=np.float64) * (1.0, -1.0)
        pairs = np.array(rows[3 + count :], dtype=np.intp) - 1
        yield path.name, [points_array(points[pair]) for pair in pairs]


PARTS = {"figures": figures, "letters": letters, "hershey": hershey, "random": at_random, "fnc": fnc}


def flat_folder_folds(result: foldcut.Result, folder: Path) -> bool:
    """Return whether Flat-Folder, in a folder, finds a folded state for the creases, mountains and valleys alone."""
    fold = json.loads(fold_file.export(result.folded_pattern, load_profile()))
    bare = {key: fold[key] for key in ("edges_assignment", "faces_vertices")}
    bare["edges_vertices"] = [sorted(edge) for edge in fold["edges_vertices"]]  # it looks edges up like this
    bare["vertices_coords"] = (np.array(fold["vertices_coords"]) / result.folded_pattern.sheet.diagonal).tolist()
    with tempfile.TemporaryDirectory(dir=folder) as place:
        script, file = folder / f"{Path(place).name}.mjs", Path(place) / "a.fold"
        script.write_text(NODE)
        file.write_text(json.dumps(bare))
        try:
            done = subprocess.run(
                ["node", script.name, file], cwd=folder, capture_output=True, text=True, check=True, timeout=600
            )
        finally:
            script.unlink()
    return int(done.stdout) > 0


def main(args: argparse.Namespace) -> None:
    for part in args.parts:
        verified, folds, sides, count, agreed = 0, [], 0, 0, 0
        started = time.process_time()
        for name, drawn in PARTS[part](args):
            count += 1
            before = time.process_time()
            try:
                result = foldcut.fold(Drawing((), None, name, lines=tuple(drawn)), effort=args.effort)
            except FoldcutError as error:
                print(f"{part:8} {name:20} {time.process_time() - before:6.1f} s  {str(error)[:110]}", flush=True)
                continue
            pattern, told = result.folded_pattern, "NOT VERIFIED"
            if result.verified:
                verified, told = verified + 1, f"{result.actions} folds, {len(pattern.shape.lines)} folded lines"
                folds.append(result.actions)
                inside = sides_of_lines(pattern.shape)
                sides += bool(inside.any() and not inside.all())
                if args.flat_folder:
                    folds_too = flat_folder_folds(result, args.flat_folder)
                    agreed += folds_too
                    told += f", Flat-Folder finds {'a' if folds_too else 'NO'} folded state"
                told += f", {len(pieces_of(pattern.shape, pattern.sheet))} pieces"
            print(f"{part:8} {name:20} {time.process_time() - before:6.1f} s  {told}", flush=True)
        seconds = time.process_time() - started
        middle = int(np.median(folds)) if folds else 0
        print(
            f"| {part} | {count} | {verified} | {middle} | {max(folds, default=0)} | {sides} | {seconds:.0f} |",
            flush=True,
        )
        if args.flat_folder:
            print(f"Flat-Folder agrees about {agreed} of {verified}", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", default=["figures", "letters", "random"])
    parser.add_argument("--seeds", type=int, default=200)
    parser.add_argument("--effort", default="normal")
    parser.add_argument("--flat-folder", type=Path, help="a checkout of origamimagiro/flat-folder")
    parser.add_argument("--folder", type=Path, default=Path())
    main(parser.parse_args())
