"""The test card of a machine: one sheet with scores and perforations in many settings, to fold and compare.

``Profile`` -> ``Job``. Each row is a strip, free except at its left end, with a fold line across it, so that it can be
folded by itself. First come scores of increasing power or force, then perforations with longer and longer dashes. The
number of ticks at its left end is the row's number. Each row is a step of its own, with its own layer, colour and
setting; no two rows are alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.model import Sheet
from foldcut.jobs.bed import Lay
from foldcut.jobs.dashes import perforation
from foldcut.jobs.errors import JobError, TooLargeError
from foldcut.jobs.job import Job, JobStep, check_job, within
from foldcut.jobs.model import operation_for
from foldcut.jobs.pen_path import travel
from foldcut.profiles import Action, Dash, Material, Operation, Profile, Setting

WIDTH_MM = 60.0
"""The width of the card."""

ROW_MM = 14.0
"""The height of a row."""

EDGE_MM = 8.0
"""The margin above and below the rows; strips end this far from the right edge."""

TICK_MM = 2.0
"""The length of a tick."""

POWERS = (0.5, 0.7, 0.85, 1.0, 1.2, 1.5)
"""The power or the force of each scored row, as a multiple of the profile's for scores."""

DASHES = ((0.5, 1.5), (0.5, 1.0), (1.0, 1.0), (1.0, 0.5), (2.0, 1.0), (2.0, 0.5))
"""Dash and gap of each perforated row, as multiples of the profile's for mountains."""

ROW_COLOURS = (
    "#000000",
    "#0000ff",
    "#ff0000",
    "#d0d000",
    "#00e0e0",
    "#b4b4b4",
    "#0000a0",
    "#a00000",
    "#00a000",
    "#c08000",
    "#00a0ff",
    "#a000a0",
)
"""The colours of rows where the profile has no palette: LightBurn's own, so that it does not take one for another."""


@dataclass(frozen=True)
class Row:
    """A row of the card: what it is called, what is done, its setting, and its dashes if it is perforated."""

    text: str
    action: Action
    setting: Setting | None
    dash: Dash | None = None


def make_coupon(profile: Profile, material: str | None = None) -> tuple[Job, list[str]]:
    """Return the job of the test card for a material, by default the profile's first, and what each row is.

    Raises JobError: the card does not fit the bed, the profile has no such material or is only for drawings, or two
    rows would come out alike.
    """
    if not profile.operations:
        raise JobError(f"{profile.title!r} is for drawings: name a machine with --profile; see foldcut profiles")
    check_job(Sheet(1.0, 1.0, "test card"), replace_papers(profile), material=material)
    name = material or next(iter(profile.materials))
    stuff = profile.materials[name]
    colours = _colours(profile)
    rows = _rows(profile, stuff, len(colours))
    _require_different(rows)
    height = 2 * EDGE_MM + ROW_MM * len(rows)
    sheet = Sheet(WIDTH_MM, height, "test card")
    try:
        lay = Lay.for_machine(sheet, profile)
    except TooLargeError as error:
        remedy = "give the size that its bed really has with --set, or take a larger machine with --profile"
        raise JobError(f"{error.what}; a test card has one size: {remedy}") from None
    steps, marks = [], list[Floats]()
    for number, (row, colour) in enumerate(zip(rows, colours, strict=False), 1):
        y = height - EDGE_MM - (number - 0.5) * ROW_MM
        steps.append(_step(profile, row, number, colour, y))
        left = EDGE_MM / 2
        marks += [
            np.array([[left, y - ROW_MM / 3 + n * 0.7], [left + TICK_MM, y - ROW_MM / 3 + n * 0.7]])
            for n in range(number)
        ]
    # rows that are made with the tool of the outline come right before it
    steps.insert(0, JobStep("mark", profile.operations["mark"], stuff.mark, tuple(marks), "mark"))
    cuts = [
        np.array([[1.5 * EDGE_MM, y], [WIDTH_MM - EDGE_MM, y]])
        for y in height - EDGE_MM - ROW_MM * np.arange(len(rows) + 1)
    ]
    slit = np.array([[WIDTH_MM - EDGE_MM, EDGE_MM], [WIDTH_MM - EDGE_MM, height - EDGE_MM]])
    outline = np.concatenate([sheet.corners, sheet.corners[:1]])
    steps.append(JobStep("cut", profile.operations["cut"], stuff.cut, (*cuts, slit, outline), "cut"))
    laid = [replace(step, strokes=_laid(step.strokes, lay)) for step in steps]
    way = travel([step.strokes for step in laid], np.zeros(2))
    job = Job(f"Test card: {name}", lay.size, lay.at, lay.turned, "both", tuple(laid), way, way, lay.paper)
    return job, [step.words for step in laid if step.words]


def replace_papers(profile: Profile) -> Profile:
    """Return a profile that any sheet fits, to check all but the size of the sheet."""
    return profile.model_copy(update={"papers": {}, "bed": None, "page": None})


def _laid(strokes: Sequence[Floats], lay: Lay) -> tuple[Floats, ...]:
    return tuple(stroke for run in within([[lay.place(stroke)] for stroke in strokes], lay.reach) for stroke in run)


def _step(profile: Profile, row: Row, number: int, colour: str, y: float) -> JobStep:
    line = np.array([[WIDTH_MM / 2, y - ROW_MM / 2], [WIDTH_MM / 2, y + ROW_MM / 2]])
    strokes = [line] if row.dash is None else perforation(line, row.dash)
    layer = f"{number:02d}_{'PERFORATE' if row.dash else 'SCORE'}"
    pen = operation_for(profile, "mountain", row.action).pen
    operation = Operation(layer=layer, colour=colour, pen=pen)
    return JobStep("mountain", operation, row.setting, tuple(strokes), row.action, f"{number:02d} {row.text}")


def _colours(profile: Profile) -> list[str]:
    """Return colours for the rows that the machine's software tells apart from one another, marks and cuts."""
    taken = {profile.operations[role].colour for role in ("mark", "cut")}
    usual = [colour for colour in ROW_COLOURS if not profile.palette or colour in profile.palette]
    known = [*usual, *(colour for colour in profile.palette if colour not in usual)]
    return [colour for colour in known if colour not in taken]


def _rows(profile: Profile, stuff: Material, most: int) -> list[Row]:
    """Return at most so many rows: scores if the machine scores, then perforations."""
    scores = [] if profile.draws else _scores(stuff.score)
    least = profile.blade.offset_mm if profile.blade is not None else 0.0
    cuts = [_perforation(stuff.perforate, stuff.mountain, parts, least) for parts in DASHES]
    if len(scores) + len(cuts) > most:
        half = min(len(scores), most // 2)
        scores, cuts = _some(scores, half), _some(cuts, min(len(cuts), most - half))
    return [*scores, *cuts]


def _some(rows: list[Row], count: int) -> list[Row]:
    """Return so many of the rows, evenly spread."""
    return [rows[place] for place in np.linspace(0, len(rows) - 1, count).round().astype(int).tolist()]


def _scores(setting: Setting | None) -> list[Row]:
    """Return the scored rows: of several powers or forces, or one if the operator sets them."""
    if setting is None or (setting.power_percent is None and setting.force_g is None):
        return [Row("score, as the machine is set", "score", setting)]
    rows = []
    for part in POWERS:
        power = setting.power_percent and min(100.0, round(part * setting.power_percent, 1))
        force = setting.force_g and float(max(1, round(part * setting.force_g)))
        what = f"{power:g} %" if power is not None else f"{force:g} g"
        text = f"score, {what} at {setting.speed_mm_s:g} mm a second"
        rows.append(Row(text, "score", setting.model_copy(update={"power_percent": power, "force_g": force})))
    return rows


def _perforation(setting: Setting | None, usual: Dash, parts: tuple[float, float], least: float) -> Row:
    dash, gap = max(least, round(parts[0] * usual.dash_mm, 2)), round(parts[1] * usual.gap_mm, 2)
    cut = Dash(dash_mm=dash, gap_mm=gap, clearance_mm=usual.clearance_mm)
    return Row(f"perforation, {dash:g} mm cut, {gap:g} mm gap", "perforate", setting, cut)


def _require_different(rows: Sequence[Row]) -> None:
    """Raise JobError if two rows would be made in the same way."""
    seen: dict[tuple[Action, Setting | None, Dash | None], int] = {}
    for number, row in enumerate(rows, 1):
        first = seen.setdefault((row.action, row.setting, row.dash), number)
        if first != number:
            raise JobError(
                f"rows {first} and {number} of the test card would be the same ({row.text}); change the material's "
                "settings with --set, for example a lower score.power_percent or a longer mountain.dash_mm"
            )
