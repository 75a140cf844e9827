"""What people bring, folded by the default command: how many drawings become patterns for two hands, and how soon.

Run it with ``make bench-redraw`` or ``python tests/bench/redraw.py [PART ...] [--shapes FOLDER] [--sets FOLDER]
[--fewest] [--share K/N] [--limit S] [--out OUT]``. The parts, all of them by default:

- ``icons``: 20 icons of each of three npm sets, which ``npm pack`` fetches into the folder SETS; none of them is in the
  repository. Chosen are names of one word, with or without ``-fill`` or ``-outline``, with at most two loops, in the
  order that a seed gives, as they come.
- ``letters``: the 62 letters and digits of DejaVu Sans, which fontconfig has to know.
- ``font``: those of foldcut's own font, which have to take at most 25 folds each, with no crease under 3 mm.
- ``prototype``: the drawings and tolerances of a prototype's table, beside its folds, shortest creases and seconds.
- ``before``: all samples, and every shape in FOLDER and below, with a tolerance of 0.25 mm beside what foldcut made of
  them before it could redraw (``before_redraw.json``).
- ``random``: 200 drawings from a seed: is the tolerance held, is the topology kept, do symmetric drawings stay so?

Everything is folded in this process, after one drawing so that compiled code is loaded; seconds are of the processor.
``--fewest`` folds icons and letters once more, for the fewest folds within 2 mm, since the default command stops at the
most exact outline for two hands. ``--share 1/4`` takes every fourth drawing, from the first on. OUT gets redraw.json
and redraw.md, also when the bench is interrupted.
"""

from __future__ import annotations

import argparse
import json
import math
import random
import re
import shutil
import signal
import subprocess
import sys
import tarfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import shapely

import foldcut
from foldcut.core.errors import FoldcutError
from foldcut.drawing.mend import Preparation, prepare
from foldcut.drawing.shape import make_shape
from foldcut.readers import read_shape
from foldcut.readers.base import Drawing
from foldcut.readers.typed_text import draw_text, find_font
from foldcut.samples import sample_names, sample_path

HERE = Path(__file__).parent

SEED = 19

ICONS_EACH = 20
MOST_LOOPS = 2

SETS = {
    "@mdi/svg@7.4.47": "svg",
    "bootstrap-icons@1.13.2": "icons",
    "@tabler/icons@3.52.0": "icons/filled",
}
"""The folder of the icons in each package."""

LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789"
FONT = "DejaVu Sans"

FONT_FOLDS = 25
"""The most folds that a letter of foldcut's own font may take."""

HANDS_FOLDS = 60
HANDS_CREASE_MM = 3.0
MOST_FOLDS = 120
MANY_LAYERS = 30

PROTOTYPE: tuple[tuple[str, float, int | None, float | None, float], ...] = (
    ("U", 1, 47, 8.9, 18),
    ("U", 2, 34, 17.3, 18),
    ("U", 3, 33, 6.0, 18),
    ("S", 1, 142, 0.7, 22),
    ("S", 2, 90, 4.4, 22),
    ("S", 3, 69, 10.9, 22),
    ("e", 1, None, None, 20),
    ("e", 2, 66, 5.6, 20),
    ("e", 3, 56, 7.1, 20),
    ("5", 2, 85, 6.2, 26),
    ("R", 2, 87, 1.8, 19),
    ("a", 2, 130, 1.2, 27),
    ("heart", 1, 29, 10.1, 16),
    ("heart", 2, 19, 22.6, 16),
    ("moon-waning-crescent", 2, 28, 24.9, 15),
    ("crown", 2, 25, 20.7, 15),
    ("leaf", 2, 65, 6.0, 18),
    ("dog-side", 2, 96, 4.0, 17),
    ("bat", 2, 159, 1.2, 20),
    ("key", 2, 121, 0.4, 20),
    ("umbrella", 2, None, None, 20),
    ("8", 2, None, None, 60),
    ("cat", 2, None, None, 60),
    ("fish", 2, None, None, 60),
)
"""Letter or icon of @mdi/svg, tolerance in mm, and the prototype's folds, shortest crease in mm and seconds.

Without folds, the prototype had no pattern, or none in 60 s.
"""

RANDOM_DRAWINGS = 200

SAME_MM = 1e-3
"""Corners are mirror images of each other if they are no farther off than this."""

DENSE = 2000
"""So many points are laid along an outline to measure distances on a second way."""

Row = dict[str, Any]


class OutOfTimeError(BaseException):
    """A drawing took longer than it may; not an Exception, so that nothing takes it for an error of its own."""


# --- what is measured


def measure(drawing: Drawing, limit: float = math.inf, **options: Any) -> Row:
    """Fold a drawing on A4 and return its ladder, with seconds of the processor; without a failure, that is empty."""
    return folded(drawing, limit, **options)[0]


def folded(drawing: Drawing, limit: float, **options: Any) -> tuple[Row, foldcut.Result | None]:
    """Do as ``measure``, and also return the result."""
    row: Row = {"failure": "", "levels": [], "first_s": None}
    result = None
    started = time.process_time()

    def first(_: object) -> None:
        if row["first_s"] is None:
            row["first_s"] = time.process_time() - started

    def stop(_signal: int, _frame: FrameType | None) -> None:
        raise OutOfTimeError

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, min(limit, 1e6))
    try:
        result = foldcut.fold(drawing, "a4", preparation=Preparation(), on_pattern=first, **options)
    except FoldcutError as error:
        row["failure"] = f"{type(error).__name__}: {' '.join(str(error).split())}"
    except OutOfTimeError:
        row["failure"] = f"not done in {limit:g} s"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)
        row["seconds"] = time.process_time() - started
    return (row if result is None else row | ladder_row(result)), result


def ladder_row(result: foldcut.Result) -> Row:
    """Return the ladder of a result; tolerances and distances are in mm of a drawing that is as large as A4 allows."""
    ladder = result.ladder
    assert ladder is not None
    levels = [
        {
            "tolerance_mm": round(level.tolerance_mm / level.scale, 6),
            "off_by_mm": level.off_by_mm / level.scale,
            "corners": level.corners,
            "folds": level.folds,
            "shortest_mm": level.shortest_mm,
            "layers": level.layers,
            "verified": level.verified,
            "failure": level.failure,
        }
        for level in ladder.levels
    ]
    warned = any("layers" in warning for warning in result.foldability.warnings)
    return {
        "levels": levels,
        "taken": ladder.taken,
        "failure": "; ".join(map(str, result.findings)),
        "warned_of_layers": warned,
    }


def for_hands(level: Row) -> bool:
    """Whether a level's pattern is one for two hands."""
    few = level["verified"] and level["folds"] <= HANDS_FOLDS
    return bool(few and (level["shortest_mm"] is None or level["shortest_mm"] >= HANDS_CREASE_MM))


def within(row: Row, tolerance: float) -> list[Row]:
    """Return the levels of a row that have a pattern and are within a tolerance."""
    return [level for level in row["levels"] if level["verified"] and level["tolerance_mm"] <= tolerance + 1e-6]


def fewest(row: Row, tolerance: float) -> float:
    """Return the fewest folds within a tolerance, infinity if there is no pattern."""
    return min((level["folds"] for level in within(row, tolerance)), default=math.inf)


def shares(rows: Sequence[Row], fewer: Sequence[Row]) -> list[str]:
    """Return what must hold, and what holds, in lines of a table; ``fewer``: rows of ``--fewest``, or none."""

    def share(true: Callable[[Row], bool]) -> float:
        return 100 * sum(map(true, rows)) / len(rows)

    lines = [
        f"| for two hands within {tolerance} mm | at least {least} % | "
        f"{share(lambda row, t=tolerance: any(map(for_hands, within(row, t)))):.0f} % |"
        for tolerance, least in ((2, 70), (4, 90))
    ]
    refused = [row["name"] for row in rows if row["failure"]]
    many = [row["name"] for row in rows if not row["failure"] and fewest(row, 4) > MOST_FOLDS]
    thick = [row["name"] for row in rows if not row["failure"] and is_thick(row) and not row["warned_of_layers"]]
    lines.append(f"| refused | none | {len(refused)}: {', '.join(refused)} |")
    lines.append(f"| more than {MOST_FOLDS} folds within 4 mm | none | {len(many)}: {', '.join(many)} |")
    lines.append(
        f"| over {MANY_LAYERS} layers at the cut without a warning | none | {len(thick)}: {', '.join(thick)} |"
    )
    for kind, most in (("letters", 35), ("icons", 45)):
        folds = [fewest(row, 2) for row in fewer or rows if row["kind"] == kind]
        how = "fewest folds" if fewer else "folds of what the default tried"
        if folds:
            lines.append(f"| {how} within 2 mm, median of {kind} | at most {most} | {np.median(folds):g} |")
    return [*lines, *times(rows)]


def is_thick(row: Row) -> bool:
    """Whether the cut of the pattern that was taken goes through many layers."""
    return bool((row["levels"][row["taken"]]["layers"] or 0) > MANY_LAYERS)


def times(rows: Sequence[Row]) -> list[str]:
    """Return the seconds of the processor to the first pattern and in all, and what they may be."""
    lines = []
    for key, name, goals in (("first_s", "first verified pattern", (1, 4)), ("seconds", "whole search", (6, 15))):
        seconds = [math.inf if row[key] is None else row[key] for row in rows]
        low, high = np.quantile(seconds, (0.5, 0.95), method="higher")
        lines.append(f"| {name}, p50 and p95 | at most {goals[0]} and {goals[1]} s | {low:.2f} and {high:.2f} s |")
    return lines


def line_of(row: Row) -> str:
    """Return a row of the ladder for people: tolerance, folds and shortest crease of each level."""
    parts = []
    for number, level in enumerate(row["levels"]):
        mark = "*" if number == row.get("taken") else ""
        if level["verified"]:
            short = "-" if level["shortest_mm"] is None else f"{level['shortest_mm']:.1f}"
            parts.append(f"{level['tolerance_mm']:g}{mark}: {level['corners']}c {level['folds']}f {short}")
        else:
            parts.append(f"{level['tolerance_mm']:g}{mark}: {level['failure'][:30] or 'not verified'}")
    first = "-" if row["first_s"] is None else f"{row['first_s']:.2f}"
    return f"{row['name']:28s} {first:>6s} {row['seconds']:6.2f} s  {'; '.join(parts)} {row['failure'][:100]}"


# --- the drawings


def is_simple(stem: str) -> bool:
    """Whether an icon's name is one word, with or without "fill" or "outline"."""
    return re.fullmatch("[a-z]+", re.sub("-(fill|outline)$", "", stem)) is not None


def fetched(folder: Path) -> dict[str, Path]:
    """Return the folder of each set's icons; packages that are not in ``folder`` yet are fetched with npm."""
    found = {}
    for package, below in SETS.items():
        place = folder / re.sub(r"[@/]+", "-", package).strip("-")
        if not (place / "package" / below).is_dir():
            if shutil.which("npm") is None:
                sys.exit("icons need npm, which is not installed; name other parts, such as letters")
            place.mkdir(parents=True, exist_ok=True)
            subprocess.run(["npm", "pack", "--silent", package], cwd=place, check=True, stdout=subprocess.DEVNULL)
            with tarfile.open(next(place.glob("*.tgz"))) as archive:
                archive.extractall(place, filter="data")
        found[package] = place / "package" / below
    return found


def chosen_icons(folder: Path) -> Iterator[tuple[str, Drawing]]:
    """Yield the icons and their names."""
    for package, icons in fetched(folder).items():
        name = package.rpartition("@")[0]
        stems = sorted(path.stem for path in icons.glob("*.svg") if is_simple(path.stem))
        random.Random(f"{SEED} {name}").shuffle(stems)
        count = 0
        for stem in stems:
            drawing = usable(icons / f"{stem}.svg")
            if drawing is not None and count < ICONS_EACH:
                count += 1
                yield f"{name.strip('@').partition('/')[0].removesuffix('-icons')}/{stem}", drawing


def usable(path: Path) -> Drawing | None:
    """Return the drawing in a file if it can be read, is a shape, and has few loops."""
    try:
        drawing = read_shape(path)
        loops = prepare([loop * (180 / max(drawing.size)) for loop in drawing.loops], Preparation()).loops
        return drawing if len(make_shape(loops).loops) <= MOST_LOOPS else None
    except FoldcutError:
        return None


def letters() -> Iterator[tuple[str, Drawing]]:
    """Yield the letters and digits."""
    font = str(find_font(FONT))
    for letter in LETTERS:
        yield letter, draw_text(letter, font)


# --- the parts


def usual(drawings: Iterator[tuple[str, Drawing]], kind: str, args: argparse.Namespace) -> tuple[list[Row], list[Row]]:
    """Fold drawings by the default command; and again for the fewest folds within 2 mm, if asked to."""
    rows, fewer = [], []
    for name, drawing in shared(drawings, args.share):
        rows.append({"name": name, "kind": kind} | measure(drawing, args.limit))
        print(line_of(rows[-1]), flush=True)
        if args.fewest:
            fewer.append({"name": name, "kind": kind} | fewest_within(drawing, 2.0, args.limit))
            print(f"{'':28s} fewest within 2 mm: {fewest(fewer[-1], 2)}", flush=True)
    return rows, fewer


def shared(items: Iterator[Any], share: tuple[int, int]) -> Iterator[Any]:
    """Yield every n-th of items, beginning with the k-th, for a share (k, n)."""
    return (item for number, item in enumerate(items) if number % share[1] == share[0] - 1)


def fewest_within(drawing: Drawing, tolerance: float, limit: float) -> Row:
    """Fold a drawing on A4 at all tolerances up to one in mm: no pattern has so few folds that the search ends."""
    return measure(drawing, limit, tolerance=tolerance, folds=1)


def own_font(args: argparse.Namespace) -> list[Row]:
    """Fold the letters of foldcut's own font."""
    rows = []
    for letter in shared(iter(LETTERS), args.share):
        row = {"name": letter} | measure(draw_text(letter, "foldcut"), args.limit)
        level = row["levels"][row["taken"]] if row["levels"] else None
        good = level is not None and level["tolerance_mm"] == 0 and for_hands(level) and level["folds"] <= FONT_FOLDS
        rows.append(row | {"good": good})
        print(line_of(row), "" if good else "NOT GOOD", flush=True)
    return rows


def prototype(icons: Path | None, args: argparse.Namespace) -> list[Row]:
    """Fold what the prototype folded at its tolerances."""
    rows = []
    for name, tolerance, folds, shortest, seconds in shared(iter(PROTOTYPE), args.share):
        if len(name) > 1 and icons is None:
            continue
        drawing = draw_text(name, str(find_font(FONT))) if len(name) == 1 else read_shape(icons / f"{name}.svg")
        row = {"name": f"{name} at {tolerance:g} mm"} | fewest_within(drawing, tolerance, args.limit)
        levels = within(row, tolerance)
        best = min(levels, key=lambda level: (level["folds"], -(level["shortest_mm"] or 0)), default=None)
        row |= {"was": {"folds": folds, "shortest_mm": shortest, "seconds": seconds}, "best": best}
        row["beaten"] = best is not None and (
            folds is None or (best["folds"] <= folds and best["shortest_mm"] >= min(shortest or 0, HANDS_CREASE_MM))
        )
        row["beaten"] = row["beaten"] and row["seconds"] < seconds
        rows.append(row)
        print(line_of(row), "| was", folds, shortest, seconds, "s", "" if row["beaten"] else "NOT BEATEN", flush=True)
    return rows


def never_worse(args: argparse.Namespace) -> list[Row]:
    """Fold samples, and shapes of a folder, with a tolerance of 0.25 mm, and compare them with what was before."""
    before = json.loads((HERE / "before_redraw.json").read_text())
    paths = {name: sample_path(name) for name in sample_names()}
    if args.shapes:
        paths |= {path.relative_to(args.shapes).as_posix(): path for path in sorted(args.shapes.rglob("*.json"))}
    rows = []
    for name, path in shared(iter(paths.items()), args.share):
        if name not in before:
            continue
        row = {"name": name} | measure(read_shape(path), args.limit, tolerance=0.25)
        taken = row["levels"][row["taken"]] if row["levels"] else None
        row |= {"was": before[name], "worse": worse(taken, before[name])}
        rows.append(row)
        was = before[name]
        print(line_of(row), "| was", was.get("folds"), was.get("shortest_mm"), row["worse"], flush=True)
    return rows


def worse(level: Row | None, was: Row) -> str:
    """Return what is worse than before, in words, or nothing."""
    if was["failure"]:
        return ""
    if level is None or not level["verified"]:
        return "no pattern"
    faults = []
    if level["folds"] > was["folds"]:
        faults.append(f"{level['folds']} folds instead of {was['folds']}")
    if (level["shortest_mm"] or 0) < (was["shortest_mm"] or 0) * (1 - 1e-3):
        faults.append(f"shortest crease {level['shortest_mm']:.2f} mm instead of {was['shortest_mm']:.2f}")
    return "; ".join(faults)


def random_drawings(count: int = RANDOM_DRAWINGS, seed: int = SEED) -> Iterator[tuple[str, Drawing, bool]]:
    """Yield round and angular drawings from a seed, and whether each is mirror-symmetric; some have a hole.

    Angular ones have 5 to 12 corners; round ones are closed curves of a few waves, sampled densely.
    """
    for number in range(count):
        rng = np.random.default_rng([seed, number])
        kind, symmetric, holed = ("round", "angular")[number % 2], number % 4 >= 2, number % 8 >= 6
        outline = _round(rng, symmetric=symmetric) if kind == "round" else _angular(rng, symmetric=symmetric)
        loops = [outline]
        if holed:
            loops.append(0.4 * outline[::-1])
        name = f"{kind} {number}{' symmetric' * symmetric}{' holed' * holed}"
        yield name, Drawing(tuple(loops), None, name), symmetric


def _round(rng: np.random.Generator, *, symmetric: bool) -> np.ndarray:
    angle = np.linspace(-np.pi, np.pi, 240, endpoint=False) + np.pi / 240
    radius = np.full(angle.shape, 100.0)
    for wave in range(1, 5):
        radius += rng.uniform(0, 30 / wave) * np.cos(wave * angle + (0 if symmetric else rng.uniform(0, 6.28)))
    return _polar(angle, np.maximum(radius, 30.0), symmetric=symmetric)


def _angular(rng: np.random.Generator, *, symmetric: bool) -> np.ndarray:
    corners = int(rng.integers(5, 13))
    if symmetric:
        half = (np.arange(corners // 2 + 1) + rng.uniform(0.3, 0.7, corners // 2 + 1)) * np.pi / (corners // 2 + 1)
        radius = rng.uniform(40, 120, len(half))
        angle, radius = np.concatenate([-half[::-1], half]), np.concatenate([radius[::-1], radius])
    else:
        angle = (np.arange(corners) + rng.uniform(0.2, 0.8, corners)) * 2 * np.pi / corners
        radius = rng.uniform(40, 120, corners)
    return _polar(angle, radius, symmetric=symmetric)


def _polar(angle: np.ndarray, radius: np.ndarray, *, symmetric: bool) -> np.ndarray:
    points = np.stack([radius * np.sin(angle), radius * np.cos(angle)], axis=1)
    if symmetric:  # exactly
        points = (points + points[::-1] * (-1.0, 1.0)) / 2
    return points


def randomly(args: argparse.Namespace) -> list[Row]:
    """Fold random drawings by the default command, and check the outlines of all levels."""
    rows = []
    for name, drawing, symmetric in shared(random_drawings(), args.share):
        row, result = folded(drawing, args.limit)
        row |= {"name": name, "faults": [row["failure"]] if row["failure"] else []}
        if result is not None:
            assert result.ladder is not None
            for level in result.ladder.levels:
                if level.verified and level.drawn:
                    assert level.shape is not None
                    found = faults(level.shape.loops, level.drawn, level.tolerance_mm, symmetric=symmetric)
                    row["faults"] += [f"{level.tolerance_mm:g} mm: {fault}" for fault in found]
        rows.append(row)
        print(line_of(row), "; ".join(row["faults"]), flush=True)
    return rows


def faults(
    outline: Sequence[np.ndarray], drawn: Sequence[np.ndarray], tolerance: float, *, symmetric: bool
) -> list[str]:
    """Return what is wrong with a redrawn outline, by code that shares nothing with foldcut's own checks.

    Its distance from the drawing is measured between points laid densely along both, and by GEOS.
    """
    found = []
    spacing = max(shapely.length(ring_of(loop)) for loop in drawn) / DENSE
    allowed = tolerance + 0.02
    ours, theirs = (dense(loops, spacing) for loops in (outline, drawn))
    lines = [shapely.multilinestrings([ring_of(loop) for loop in loops]) for loops in (outline, drawn)]
    for what, points, line in (("outline", ours, lines[1]), ("drawing", theirs, lines[0])):
        off = float(shapely.distance(shapely.points(points), line).max())
        if off > allowed:
            found.append(f"the {what} is {off:.3f} mm off, allowed are {tolerance:g}")
    off = float(shapely.hausdorff_distance(lines[0], lines[1], densify=0.01))
    if off > allowed:
        found.append(f"by GEOS it is {off:.3f} mm off, allowed are {tolerance:g}")
    if len(outline) != len(drawn):
        found.append(f"{len(outline)} loops were {len(drawn)}")
    elif levels_of(outline) != levels_of(drawn):
        found.append("loops lie in each other in another way")
    for number, loop in enumerate(outline):
        if not shapely.Polygon(loop).is_valid:
            found.append(f"loop {number + 1} crosses itself")
        if any(shapely.intersects(ring_of(loop), ring_of(other)) for other in outline[number + 1 :]):
            found.append("two loops touch")
    if symmetric and not any(is_symmetric(outline, drawn, axis) for axis in (0, 1)):
        found.append("the drawing is symmetric, the outline is not")
    return found


def is_symmetric(outline: Sequence[np.ndarray], drawn: Sequence[np.ndarray], axis: int) -> bool:
    """Whether a drawing and its outline are both symmetric about the line through the drawing's middle."""
    points = np.concatenate(drawn)
    middle = (points[:, axis].min() + points[:, axis].max()) / 2

    def same(loops: Sequence[np.ndarray]) -> bool:
        corners = np.concatenate(loops)
        image = corners.copy()
        image[:, axis] = 2 * middle - image[:, axis]
        corners_at = shapely.STRtree(shapely.points(corners))
        nearest = corners_at.query_nearest(shapely.points(image), all_matches=False)[1]
        return bool(np.abs(corners[nearest] - image).max() < SAME_MM)

    return same(outline) and same(drawn)


def ring_of(loop: np.ndarray) -> Any:
    """Return a loop as a ring of shapely."""
    return shapely.linearrings(loop)


def dense(loops: Sequence[np.ndarray], spacing: float) -> np.ndarray:
    """Return points along loops."""
    return shapely.get_coordinates([shapely.segmentize(ring_of(loop), spacing) for loop in loops])


def levels_of(loops: Sequence[np.ndarray]) -> list[int]:
    """Return how many loops each loop lies in, sorted."""
    polygons = [shapely.Polygon(loop) for loop in loops]
    return sorted(
        sum(a is not b and b.contains(shapely.Point(a.exterior.coords[0])) for b in polygons) for a in polygons
    )


# --- the report


def report(results: dict[str, Any]) -> list[str]:
    """Return the report as Markdown."""
    lines = ["# Drawings as people bring them", ""]
    usual_rows = [*results.get("icons", []), *results.get("letters", [])]
    if usual_rows:
        lines += ["| | must be | is |", "| --- | --- | --- |"]
        fewer = [*results.get("icons, fewest", []), *results.get("letters, fewest", [])]
        lines += [*shares(usual_rows, fewer), "", *ladder_table(usual_rows), ""]
    if rows := results.get("font"):
        bad = ", ".join(row["name"] for row in rows if not row["good"])
        lines += [f"Letters of the font foldcut that take too many folds: {bad or 'none'} of {len(rows)}.", ""]
    if rows := results.get("prototype"):
        lines += ["| drawing | was: folds | shortest mm | s | is: folds | shortest mm | s | |", "| --- " * 8 + "|"]
        lines += [prototype_line(row) for row in rows]
        lines += ["", f"Beaten: {sum(row['beaten'] for row in rows)} of {len(rows)}.", ""]
    if rows := results.get("before"):
        bad = [f"- {row['name']}: {row['worse']}" for row in rows if row["worse"]]
        lines += [f"Worse than before: {len(bad)} of {len(rows)}.", "", *bad, ""]
        seconds = [(row["seconds"], row["was"]["seconds"]) for row in rows if "seconds" in row["was"]]
        lines += [f"Seconds in all: {sum(s for s, _ in seconds):.1f}, were {sum(s for _, s in seconds):.1f}.", ""]
    if rows := results.get("random"):
        bad = [f"- {row['name']}: {'; '.join(row['faults'])}" for row in rows if row["faults"]]
        lines += [f"Random drawings with faults: {len(bad)} of {len(rows)}.", "", *bad, ""]
        if timed := [row for row in rows if "first_s" in row]:
            lines += ["| | must be | is |", "| --- | --- | --- |", *times(timed), ""]
    return lines


def ladder_table(rows: Sequence[Row]) -> list[str]:
    """Return the ladder of every drawing as a table of Markdown."""
    lines = ["| drawing | level | off by mm | corners | folds | shortest mm | layers | first s | all s |"]
    lines.append("| --- " * 9 + "|")
    for row in rows:
        if row["failure"]:
            lines.append(f"| {row['name']} | {row['failure'][:80]} | | | | | | | {row['seconds']:.1f} |")
        for number, level in enumerate(row["levels"]):
            taken = number == row.get("taken")
            name = row["name"] if not number else ""
            mark = " (taken)" if taken else ""
            first = f"{row['first_s']:.2f} | {row['seconds']:.1f}" if taken and row["first_s"] is not None else "| "
            if not level["verified"]:
                lines.append(f"| {name} | {level['tolerance_mm']:g} | {level['failure'][:60]} | | | | | | |")
                continue
            short = "" if level["shortest_mm"] is None else f"{level['shortest_mm']:.1f}"
            lines.append(
                f"| {name} | {level['tolerance_mm']:g}{mark} | {level['off_by_mm']:.2f} | {level['corners']} | "
                f"{level['folds']} | {short} | {level['layers']} | {first} |"
            )
    return lines


def prototype_line(row: Row) -> str:
    """Return a row of the table beside the prototype's."""
    was, best = row["was"], row["best"]
    before = " | ".join("-" if was[key] is None else f"{was[key]:g}" for key in ("folds", "shortest_mm", "seconds"))
    now = "- | -" if best is None else f"{best['folds']} | {best['shortest_mm']:.1f}"
    return f"| {row['name']} | {before} | {now} | {row['seconds']:.1f} | {'' if row['beaten'] else 'not beaten'} |"


# --- the command


PARTS = ("icons", "letters", "font", "prototype", "before", "random")


def main() -> int:
    """Run the parts, print a line for each drawing, and write the report."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    parser.add_argument("--shapes", type=Path, help="a folder of JSON shapes for the part before")
    parser.add_argument("--sets", type=Path, default=Path("out/icons"), help="where the sets of icons are kept")
    parser.add_argument("--fewest", action="store_true", help="also search for the fewest folds within 2 mm")
    parser.add_argument("--share", type=share_of, default=(1, 1), metavar="K/N", help="every N-th from the K-th on")
    parser.add_argument("--limit", type=float, default=120.0, help="seconds of the processor for a drawing")
    parser.add_argument("--out", type=Path, default=Path("out"))
    args = parser.parse_args()
    parts = args.parts or PARTS
    if unknown := set(parts) - set(PARTS):
        parser.error(f"there is no part {', '.join(unknown)}; choose from {', '.join(PARTS)}")
    foldcut.fold(sample_path("square"), effort="fast")  # compiled code is loaded
    results: dict[str, Any] = {}
    try:
        if "icons" in parts:
            results["icons"], results["icons, fewest"] = usual(chosen_icons(args.sets), "icons", args)
        if "letters" in parts:
            results["letters"], results["letters, fewest"] = usual(letters(), "letters", args)
        if "font" in parts:
            results["font"] = own_font(args)
        if "prototype" in parts:
            results["prototype"] = prototype(fetched(args.sets)["@mdi/svg@7.4.47"], args)
        if "before" in parts:
            results["before"] = never_worse(args)
        if "random" in parts:
            results["random"] = randomly(args)
    finally:
        args.out.mkdir(parents=True, exist_ok=True)
        (args.out / "redraw.json").write_text(json.dumps(results, indent=1))
        (args.out / "redraw.md").write_text("\n".join(report(results)))
    print("\n".join(line for line in report(results) if " must be " in line or "at " in line or "none |" in line))
    return 0


def share_of(text: str) -> tuple[int, int]:
    """Return the share (k, n) that is meant by "k/n"."""
    k, _, n = text.partition("/")
    if not 1 <= int(k) <= int(n):
        raise argparse.ArgumentTypeError(f"{text} is not a share; give K/N such as 1/4")
    return int(k), int(n)


if __name__ == "__main__":
    sys.exit(main())
