"""The straight skeleton beside CGAL's and others', how it grows, and the patterns made from it.

    python tests/bench/skeleton.py [--parts cgal,growth,python,small,shapes,widths] [--largest 1e5] [--limit SECONDS]
        [--effort fast] [--shapes FOLDER] [--beside FILE] [--drawings fish,FILE.svg] [--sheet a3]
        [--widths 50] [--out FOLDER]

``make bench-skeleton``. What is measured is printed and written to skeleton.md in the folder; creases and folds of the
shapes also to skeleton.tsv: name, creases, folds, shortest crease in mm, layers at the cut, "verified", "findings" or
why there is no pattern, and seconds. ``--beside`` takes such a file of another version.

Times are the processor's, medians of rounds in which each thing has its turn, so compare ratios within one run. Each
graph is measured in a copy of the process (fork): what crashes there, or is ended after the limit, is named. Compiled
code is loaded before, and its loading is not timed. Nothing here can fail for being slow.
"""

from __future__ import annotations

import argparse
import hashlib
import math
import os
import platform
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from itertools import count, cycle
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
import shapely

sys.path.insert(0, str(Path(__file__).parents[1]))
from bench import end_after, in_a_copy, installed, timed
from loops import koch_loop, star_loop
from support.planar_graphs import hilbert, koch, of_cycle, random_polygon
from yardsticks import check_polyskel, check_py_straight_skeleton, polyskel, py_straight_skeleton

import foldcut
from foldcut.core.model import FoldedPattern, Sheet
from foldcut.geometry.straight_skeleton import Solver, graph_of, straight_skeleton
from foldcut.geometry.straight_skeleton.moving import MovingSkeleton
from foldcut.geometry.straight_skeleton.tables import Arrays, Lists
from foldcut.samples import sample_names, sample_path

Graph = tuple[np.ndarray, np.ndarray]
Calls = dict[str, Callable[[], Any]]
Row = dict[str, Any]
Section = Iterator[str]

COMPILED, PLAIN = Arrays(), Lists()
ROUNDS = 3
SHORTEST = 0.03
"""Seconds for which short calls are repeated in each round."""
LONG = 1.0
"""What takes more seconds is done once."""
SEEDS = (1, 2, 3)
STEP = 1e-3
"""How far a corner moves in a small change, in lengths of one of its edges."""
SIZES = (10, 30, 100, 300, 1000)
BOUNDARY = 2
"""What compas_cgal calls the kind of an edge of the polygon itself."""
NEAR = 0.02
"""How far around the shape creases are compared, in widths of the shape."""
DIGITS = 1e5
"""Places are compared rounded to the width of the shape divided by this."""
OFF_GRID = 0.3183
"""Added before rounding, since many places are halves of round numbers, which would be rounded up or down by chance."""


def spikes(corners: int, seed: int) -> np.ndarray:
    """Return a loop around the origin with corners 0.3 to 1 away from it, ``(corners, 2)``."""
    rng = np.random.default_rng(seed)
    angle = 2 * math.pi * (np.arange(corners) + 0.8 * rng.random(corners)) / corners
    return rng.uniform(0.3, 1, corners)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])


def snowflake(corners: int, seed: int) -> np.ndarray:
    """Return ``koch_loop`` of the first seed from 1,000 times this one on with no crossing, ``(corners, 2)``."""
    loops = (koch_loop(corners, other) for other in count(1000 * seed))
    return next(loop for loop in loops if shapely.LinearRing(loop).is_simple)


RANDOM: dict[str, Callable[[int, int], Graph]] = {
    "maze": random_polygon,
    "rough star": lambda corners, seed: of_cycle(star_loop(corners, seed)),
    "random snowflake": lambda corners, seed: of_cycle(snowflake(corners, seed)),
    "spikes": lambda corners, seed: of_cycle(spikes(corners, seed)),
}
CURVES: dict[str, Callable[[int, int], Graph]] = {
    "Koch": lambda corners, _: koch(corners),
    "Hilbert": lambda corners, _: hilbert(corners),
    **RANDOM,
}


# --- what is timed -----------------------------------------------------------------------------------------------


def ours(graph: Graph) -> Calls:
    """Return our ways to the skeleton of the whole plane: the whole call, and once the graph's sides are known."""
    solver = Solver(graph_of(*graph), COMPILED)
    return {
        "compiled": lambda: straight_skeleton(*graph, tables=COMPILED),
        "plain": lambda: straight_skeleton(*graph, tables=PLAIN),
        "solver": lambda: solver.solve_one(graph[0]),
    }


def small_changes(graph: Graph) -> Calls:
    """Return a corner's way forth and back, by ``STEP`` of its edge, in turns; then the same with its skeleton read."""
    points, edges = graph
    moving = MovingSkeleton(graph_of(*graph), COMPILED)
    corner = np.array([edges[0, 0]])
    home = points[corner]
    steps = cycle([home + STEP * (points[edges[0, 1]] - home), home])

    def read() -> None:
        moving.move(corner, next(steps))
        _ = moving.skeleton

    return {"move": lambda: moving.move(corner, next(steps)), "move and read": read}


def cgal(graph: Graph) -> Calls:
    """Return compas_cgal's ways: its compiled call for the inside, for inside and outside, and its public call.

    The outside goes up to a frame, as far away as the polygon is large. The public call is for the inside.
    """
    from compas_cgal import _straight_skeleton_2, _types_std  # noqa: F401  # the types that it returns
    from compas_cgal.straight_skeleton_2 import interior_straight_skeleton

    points = graph[0] if shapely.LinearRing(graph[0]).is_ccw else graph[0][::-1]
    flat = np.column_stack([points, np.zeros(len(points))])
    low, high = points.min(axis=0), points.max(axis=0)
    frame = np.array(shapely.box(*(2 * low - high), *(2 * high - low), ccw=True).exterior.coords[:-1])
    around = np.column_stack([frame, np.zeros(4)])
    hole = np.ascontiguousarray(flat[::-1])
    corners = flat.tolist()

    def inside() -> None:
        _straight_skeleton_2.create_interior_straight_skeleton(flat)

    def both() -> None:
        inside()
        _straight_skeleton_2.create_interior_straight_skeleton_with_holes(around, [hole])

    return {"CGAL": both, "CGAL inside": inside, "CGAL public": lambda: interior_straight_skeleton(corners)}


def in_turns(calls: Calls, limit: float) -> dict[str, float]:
    """Return the median processor seconds of each call, in rounds in which each has its turn; ended after the limit."""
    end_after(limit)
    spent = {name: [seconds_of(call)] for name, call in calls.items()}
    for _ in range(ROUNDS):
        for name, call in calls.items():
            if spent[name][0] < LONG:
                spent[name].append(seconds_of(call))
    return {name: median(seconds[-ROUNDS:]) for name, seconds in spent.items()}


def seconds_of(call: Callable[[], Any]) -> float:
    """Return the processor seconds of a call, the mean of as many as take ``SHORTEST`` or more.

    The thread's clock is taken: that of a process whose time is limited may stand still for milliseconds.
    """
    calls = 1
    while True:
        start = time.thread_time()
        for _ in range(calls):
            call()
        spent = time.thread_time() - start
        if spent >= SHORTEST:
            return spent / calls
        calls *= 2


def load() -> None:
    """Load, or on the first use on this machine compile, what is compiled."""
    for call in (ours(random_polygon(20, 1)) | small_changes(random_polygon(20, 1))).values():
        call()


# --- the parts ---------------------------------------------------------------------------------------------------


def beside_cgal(args: argparse.Namespace) -> Section:
    """Compare with compas_cgal on random polygons."""
    yield "## Beside compas_cgal"
    yield (
        "Milliseconds for random polygons, medians of three seeds. *Compiled*, *plain*: the whole call with `Arrays()` "
        "and `Lists()`, for the whole plane; *solver*: compiled, when the graph's sides are known and nothing is "
        "checked. *CGAL*: compas_cgal's compiled call for the inside and for the outside up to a frame; *inside*: for "
        "the inside only; *public*: `interior_straight_skeleton`, the inside as a graph."
    )
    rows, failed = [], []
    for size in SIZES:
        for kind, make in RANDOM.items():
            for seed in SEEDS:
                graph = make(size, seed)
                found = in_a_copy(lambda graph=graph: in_turns(ours(graph) | cgal(graph), args.limit))
                if "failed" in found:
                    failed.append(f"{kind}, {size} corners, seed {seed}: {found['failed']}")
                else:
                    rows.append({"kind": kind, "size": size, **found})
    columns = ("compiled", "plain", "solver", "CGAL", "CGAL inside", "CGAL public")
    lines = [["polygon", "corners", *columns, "compiled / CGAL", "plain / CGAL"]]
    for size in SIZES:
        for kind in RANDOM:
            some = [row for row in rows if (row["kind"], row["size"]) == (kind, size)]
            if some:
                times = [f"{1e3 * median(row[name] for row in some):.3g}" for name in columns]
                ratios = [f"{mean_ratio(some, name, 'CGAL'):.2f}" for name in ("compiled", "plain")]
                lines.append([kind, f"{size:,}", *times, *ratios])
    yield table(lines)
    yield f"Geometric means of the ratios of {len(rows)} polygons of up to {SIZES[-1]:,} corners:"
    ratios = [["", *(f"to {name}" for name in columns[3:])]]
    for name in columns[:3]:
        ratios.append([name, *(f"{mean_ratio(rows, name, other):.3f}" for other in columns[3:])])
    yield table(ratios)
    yield listed("Not measured", failed)


def growth(args: argparse.Namespace) -> Section:
    """Fit exponents to curves and random polygons of a thousand corners and more."""
    yield "## Growth"
    sizes = [size for size in (1000, 3000, 10_000, 30_000, 100_000, 300_000, 1_000_000) if size <= args.largest]
    yield (
        "Seconds of `straight_skeleton(points, edges)`, compiled, medians of three; in brackets, the corners. The "
        "exponent is fitted to all sizes by least squares of the logarithms."
    )
    lines = [["curve", *(f"{size:,}" for size in sizes), "exponent"]]
    failed = []
    for kind, make in CURVES.items():
        known: dict[int, float] = {}
        cells = []
        for size in sizes:
            graph = make(size, 1)
            corners = len(graph[0])
            if corners in known:
                cells.append("")
                continue
            call = {"s": partial(straight_skeleton, *graph, tables=COMPILED)}
            found = in_a_copy(lambda call=call: in_turns(call, args.limit))
            if "failed" in found:
                failed.append(f"{kind}, {corners:,} corners: {found['failed']}")
                cells.append("")
            else:
                known[corners] = found["s"]
                cells.append(f"{found['s']:.3g} ({corners:,})")
        fitted = np.polyfit(*np.log([list(known), list(known.values())]), 1)[0] if len(known) > 1 else math.nan
        lines.append([kind, *cells, f"{fitted:.2f}"])
    yield table(lines)
    yield listed("Not measured", failed)


def beside_python(args: argparse.Namespace) -> Section:
    """Compare with the two packages in Python at a thousand corners."""
    yield "## Beside py-straight-skeleton and shapely-polyskel"
    yield (
        f"Seconds for polygons of about a thousand corners; theirs for the inside only, in at most {args.limit:g} s. "
        "There must be one face for each side, and they must fill the polygon."
    )
    others: dict[str, tuple[Any, Any]] = {
        "py-straight-skeleton": (py_straight_skeleton, check_py_straight_skeleton),
        "shapely-polyskel": (polyskel, check_polyskel),
    }

    def measure(graph: Graph, name: str) -> Row:
        end_after(args.limit)
        prepare, check = others[name]
        seconds, result = timed(prepare([shapely.orient_polygons(shapely.Polygon(graph[0]))]), runs=1)
        try:
            check(result)
        except Exception as error:  # what others raise is theirs; what it took is known already
            return {"s": seconds, "wrong": f"{type(error).__name__}: {error}"}
        return {"s": seconds}

    lines = [
        [
            "polygon",
            "compiled",
            "plain",
            *others,
            *(f"{name} / {how}" for how in ("compiled", "plain") for name in others),
        ]
    ]
    failed = []
    for kind, make in CURVES.items():
        graph = make(1000, 1)
        own = in_a_copy(lambda graph=graph: in_turns(ours(graph), args.limit))
        theirs = {name: in_a_copy(partial(measure, graph, name)) for name in others}
        for name, said in {"ours": own, **theirs}.items():
            if wrong := said.get("failed") or said.get("wrong"):
                failed.append(f"{kind}, {name}: {wrong}")
        ratios = [ratio_cell(said.get("s"), own.get(how)) for how in ("compiled", "plain") for said in theirs.values()]
        times = [own.get("compiled"), own.get("plain"), *(said.get("s") for said in theirs.values())]
        lines.append([kind, *(f"{seconds:.3g}" if seconds else "" for seconds in times), *ratios])
    yield table(lines)
    yield listed("What failed", failed)


def small(args: argparse.Namespace) -> Section:
    """Compare with compas_cgal at 20 corners."""
    yield "## Twenty corners"
    yield (
        f"Milliseconds, medians of polygons of all kinds; ratios are geometric means. *Move*: `MovingSkeleton.move` of "
        f"a corner by {STEP:g} of an edge, forth and back; *and read*: with its `skeleton` after each."
    )
    rows, failed = [], []
    for kind, make in RANDOM.items():
        for seed in range(5):
            graph = make(20, seed)
            calls = partial(lambda graph: ours(graph) | small_changes(graph) | cgal(graph), graph)
            found = in_a_copy(lambda calls=calls: in_turns(calls(), args.limit))
            if "failed" in found:
                failed.append(f"{kind}, seed {seed}: {found['failed']}")
            else:
                rows.append(found)
    others = ("CGAL", "CGAL inside", "CGAL public")
    lines = [["", "ms", *(f"/ {other}" for other in others)]]
    for name in rows[0] if rows else []:
        ratios = [f"{mean_ratio(rows, name, other):.3f}" for other in others]
        lines.append([name, f"{1e3 * median(row[name] for row in rows):.3f}", *ratios])
    yield table(lines)
    yield listed("Not measured", failed)


def shapes(args: argparse.Namespace) -> Section:
    """Fold the samples and shapes by the skeleton, and compare creases and folds with an earlier record."""
    yield f"## Creases and folds of the method skeleton, effort {args.effort}"
    before = read_record(args.beside) if args.beside else {}
    paths = [sample_path(name) for name in sample_names()]
    paths += sorted(args.shapes.rglob("*.json")) if args.shapes else []
    record = []
    lines = [["shape", "creases", "before", "folds", "before", "shortest mm", "s", ""]]
    for path in paths:
        row = in_a_copy(partial(fold_row, path, args.effort, args.patience))
        if "failed" in row:
            row = dict(zip(FIELDS, ["-", "-", "-", "-", row["failed"], "-"], strict=True))
        record.append({"name": path.stem, **row})
        was = before.get(path.stem, {})
        said = [row["outcome"]] if row["outcome"] != "verified" else []
        said += [f"more {name}" for name in ("creases", "folds") if is_more(row[name], was.get(name))]
        compared = [row["creases"], was.get("creases", ""), row["folds"], was.get("folds", "")]
        lines.append([path.stem, *compared, row["shortest"], row["seconds"], "; ".join(said)])
        print("\t".join(record[-1].values()), flush=True)
    args.out.mkdir(parents=True, exist_ok=True)
    (args.out / "skeleton.tsv").write_text("".join("\t".join(row.values()) + "\n" for row in record))
    yield table(lines)
    for name in ("creases", "folds"):
        known = [(row, before[row["name"]]) for row in record if row["name"] in before]
        both = [(int(row[name]), int(was[name])) for row, was in known if "-" not in (row[name], was[name])]
        if both:
            mean = math.exp(sum(math.log(now / was) for now, was in both) / len(both))
            more = sum(now > was for now, was in both)
            yield f"{name}: more for {more} of {len(both)}; geometric mean of the ratio {mean:.3f}."
    yield (
        f"Verified: {sum(row['outcome'] == 'verified' for row in record)} of {len(record)}"
        + (
            f"; before, {sum(was['outcome'] == 'verified' for was in before.values())} of {len(before)}."
            if before
            else "."
        )
    )


FIELDS = ("creases", "folds", "shortest", "layers", "outcome", "seconds")


def fold_row(path: Path, effort: str, patience: float) -> Row:
    """Return a shape's row of the record: what the skeleton makes of it on A4."""
    end_after(patience)
    start = time.process_time()
    try:
        result = foldcut.fold(path, method="skeleton", effort=effort, min_crease=0)
    except foldcut.UnfoldableError as error:
        told: list[Any] = ["-", "-", "-", "-", str(error)]
    else:
        numbers = result.foldability
        outcome = "verified" if result.verified else "findings"
        told = [numbers.creases, result.actions, f"{numbers.shortest_crease_mm:.4f}", numbers.layers_at_cut, outcome]
    return dict(zip(FIELDS, map(str, [*told, f"{time.process_time() - start:.1f}"]), strict=True))


def read_record(path: Path) -> dict[str, Row]:
    """Return the rows of an earlier skeleton.tsv by the name of the shape."""
    rows = [line.split("\t") for line in path.read_text().splitlines()]
    return {row[0]: dict(zip(FIELDS, row[1:], strict=True)) for row in rows}


def is_more(now: str, before: str | None) -> bool:
    """Whether there is more than before, or nothing where there was something."""
    if before in (None, "-"):
        return False
    return now == "-" or int(now) > int(before)


def widths(args: argparse.Namespace) -> Section:
    """Fold drawings at many widths, and count how many patterns there are up to scale."""
    for drawing in args.drawings.split(","):
        path = sample_path(drawing) if drawing in sample_names() else Path(drawing)
        rows = []
        for width in np.linspace(40, 260, args.widths).tolist():
            row = in_a_copy(partial(fold_wide, path, width, args.sheet, args.effort, args.patience))
            rows.append({"width": width, "pattern": row.get("failed", ""), "method": "", "s": 0.0, **row})
            print(*(f"{value:.4g}" if isinstance(value, float) else value for value in rows[-1].values()), flush=True)
        counts = Counter(row["pattern"] for row in rows)
        yield f"## {path.stem} at {args.widths} widths from 40 to 260 mm, sheet {args.sheet}, effort {args.effort}"
        yield (
            f"{len(counts)} different pattern(s) up to scale, compared within {NEAR:g} widths around the shape to "
            f"{1 / DIGITS:g} of its width; {sum(row['s'] for row in rows):.1f} s of the processor in all, "
            f"{median(row['s'] for row in rows):.2f} s in the median."
        )
        lines = [["pattern", "widths", "how many", "method", "creases", "folds"]]
        for pattern, times in counts.most_common():
            some = [row for row in rows if row["pattern"] == pattern]
            numbers = [", ".join(sorted({str(row.get(name, "")) for row in some})) for name in ("creases", "folds")]
            at = ", ".join(f"{row['width']:.0f}" for row in some[:8]) + (" ..." if times > 8 else "")
            lines.append([pattern, at, str(times), some[0]["method"], *numbers])
        yield table(lines)


def fold_wide(path: Path, width: float, sheet: str, effort: str, patience: float) -> Row:
    """Return what comes of a drawing that is so many mm wide: a pattern's hash, or why there is none.

    ``sheet`` is a name, or the side of a square sheet in widths of the drawing.
    """
    end_after(patience)
    square = sheet.replace(".", "").isdigit()
    paper = Sheet(width * float(sheet), width * float(sheet)) if square else sheet
    margin = 0.0 if square else 10.0
    start = time.process_time()
    try:
        result = foldcut.fold(path, paper, margin=margin, width=width, effort=effort, min_crease=0)
    except foldcut.FoldcutError as error:
        return {"pattern": str(error)[:100], "s": time.process_time() - start}
    pattern = result.folded_pattern
    return {
        "pattern": pattern_hash(pattern) if result.verified else f"not verified: {result.findings[0]}"[:100],
        "method": result.method,
        "creases": pattern.creases.crease_count,
        "folds": result.actions,
        "s": time.process_time() - start,
    }


def pattern_hash(pattern: FoldedPattern) -> str:
    """Return a name for a pattern's creases near the shape, the same if patterns differ in size and place only."""
    corners = np.concatenate(pattern.shape.loops)
    low, high = corners.min(axis=0), corners.max(axis=0)
    creases, width = pattern.creases, float(high[0] - low[0])
    inner = creases.edges_assignment != "B"
    places = (creases.vertices_coords - low) / width
    lines = shapely.linestrings(places[creases.edges_vertices[inner]])
    cut = shapely.intersection(lines, shapely.box(-NEAR, -NEAR, 1 + NEAR, (high[1] - low[1]) / width + NEAR))
    kept = shapely.length(cut) > 2 / DIGITS
    ends = np.floor(shapely.get_coordinates(cut[kept]) * DIGITS + OFF_GRID).astype(int).reshape(-1, 2, 2)
    kinds = creases.edges_assignment[inner][kept].tolist()
    rows = sorted((*sorted(pair), str(kind)) for pair, kind in zip(ends.tolist(), kinds, strict=True))
    return hashlib.sha256(repr(rows).encode()).hexdigest()[:8]


# --- what is written ---------------------------------------------------------------------------------------------


def mean_ratio(rows: list[Row], name: str, below: str) -> float:
    """Return the geometric mean of the ratios of two columns."""
    return math.exp(sum(math.log(row[name] / row[below]) for row in rows) / max(1, len(rows)))


def ratio_cell(above: float | None, below: float | None) -> str:
    """Return a ratio, or nothing where one of the two is not known."""
    return f"{above / below:.0f}" if above and below else ""


def table(lines: list[list[str]]) -> str:
    """Return lines of cells as a table in Markdown; the first line is its head."""
    head, *rest = ["| " + " | ".join(cell.replace("|", "/") for cell in line) + " |" for line in lines]
    return "\n".join([head, "|" + " --- |" * len(lines[0]), *rest])


def listed(title: str, lines: list[str]) -> str:
    """Return lines as a list in Markdown, or that there are none."""
    return f"{title}: nothing." if not lines else f"{title}:\n\n" + "\n".join(f"- {line}" for line in lines)


PARTS: dict[str, Callable[[argparse.Namespace], Section]] = {
    "cgal": beside_cgal,
    "growth": growth,
    "python": beside_python,
    "small": small,
    "shapes": shapes,
    "widths": widths,
}
PACKAGES = ("numpy", "numba", "compas-cgal", "py-straight-skeleton", "shapely-polyskel")


def main() -> None:
    """Print each part when it is measured, and write skeleton.md after each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--parts", default=",".join(PARTS), help="with commas; all unless given")
    parser.add_argument("--largest", type=float, default=1e5, help="corners of the largest curves (1e5)")
    parser.add_argument("--limit", type=float, default=60.0, help="seconds for a graph or another package (60)")
    parser.add_argument("--effort", default="fast", help="for the patterns (fast)")
    parser.add_argument("--patience", type=float, default=600.0, help="seconds for a pattern (600)")
    parser.add_argument("--shapes", type=Path, help="a folder of JSON shapes to be folded after the samples")
    parser.add_argument("--beside", type=Path, help="an earlier skeleton.tsv to compare creases and folds with")
    parser.add_argument("--drawings", default="fish", help="samples and files to be folded at many widths (fish)")
    parser.add_argument(
        "--sheet", default="a3", help="for these: a name, or a square's side in widths of a drawing (a3)"
    )
    parser.add_argument("--widths", type=int, default=50, help="how many widths (50)")
    parser.add_argument("--out", type=Path, default=Path("out"))
    args = parser.parse_args()
    chosen = args.parts.split(",")
    if unknown := set(chosen) - set(PARTS):
        parser.error(f"unknown: {', '.join(unknown)}; known: {', '.join(PARTS)}")
    versions = ", ".join(f"{name} {installed(name) or 'not installed'}" for name in PACKAGES)
    texts: list[str] = []

    def tell(text: str) -> None:
        print(text + "\n", flush=True)
        texts.append(text)
        args.out.mkdir(parents=True, exist_ok=True)
        (args.out / "skeleton.md").write_text("\n\n".join(texts) + "\n")

    tell("# The straight skeleton")
    tell(
        f"Python {platform.python_version()} on {platform.machine()}, {os.cpu_count()} cores, load "
        f"{os.getloadavg()[0]:.1f}; {versions}. Times are the processor's."
    )
    load()
    for name in chosen:
        for text in PARTS[name](args):
            tell(text)


if __name__ == "__main__":
    main()
