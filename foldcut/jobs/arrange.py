"""Where sheets lie on the bed: one where the user wants it, copies beside each other, or different sheets together.

``Sheet``, ``Profile`` and ``BedLayout`` -> a ``Lay`` and the corner of each copy; jobs and their corners -> one ``Job``
as large as the bed, in the bed's coordinates. Its steps are those of all sheets together, role by role: everything is
scored before anything is cut, and each tool is taken once.

Corners are told from the bed's zero, which is the lower left or the upper left corner, as the machine's software shows
it: x to the right, y away from the zero. Inside, y points up from the bed's lower left corner.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import get_args

import numpy as np

from foldcut.core.model import Sheet
from foldcut.jobs.bed import SLACK_MM, Lay, tool_border
from foldcut.jobs.errors import JobError, TooLargeError
from foldcut.jobs.model import Job, JobStep, operation_after
from foldcut.jobs.pen_path import travel
from foldcut.profiles import Bed, Profile, Registration, Role

__all__ = [
    "APART_MM",
    "IN_THE_CORNER",
    "BedLayout",
    "arranged",
    "check_bed",
    "check_copies",
    "check_sides",
    "from_zero",
    "laid_out",
    "quarter_turned",
]

APART_MM = 2.0
"""What stays of the stock between two sheets, beside what the tool takes."""

MOST_COPIES = 1000
"""The most copies that can be asked for."""


@dataclass(frozen=True)
class BedLayout:
    """Where on the bed a sheet lies, and how many copies of it.

    ``at``: the corner of the first one that is next to the bed's zero, in mm from there; None: as near as can be.
    """

    at: tuple[float, float] | None = None
    copies: int = 1

    @property
    def asked_for(self) -> bool:
        """Whether this is anything else than one sheet in the bed's corner."""
        return self.at is not None or self.copies != 1


IN_THE_CORNER = BedLayout()
"""One sheet, in the corner of the bed's zero."""


def check_bed(profile: Profile) -> Bed:
    """Return the bed of a machine on which sheets can be placed; raise JobError if it has none."""
    if profile.page is not None:
        raise JobError(
            f"--at, --copies and --nest are for a bed, and {profile.title} prints pages; print several copies, or give "
            "--offset to move the drawing on its sheet"
        )
    if profile.bed is None:
        raise JobError(
            f"--at, --copies and --nest are for a bed, and {profile.title} takes one paper at a time, at its stops; "
            "give --offset to move the drawing on its sheet, and load another paper for each copy"
        )
    return profile.bed


def check_copies(layout: BedLayout) -> None:
    """Raise JobError if there are no copies, or too many."""
    if not 1 <= layout.copies <= MOST_COPIES:
        raise JobError(f"--copies {layout.copies}: give a number from 1 to {MOST_COPIES}")


def laid_out(
    sheet: Sheet, profile: Profile, layout: BedLayout, *, full_rows: bool = False
) -> tuple[Lay, list[tuple[float, float]]]:
    """Return how all copies of a sheet lie, and the lower left corner of each on the bed, with the tool's border.

    The first is next to the bed's zero. All lie upright if there is room for them, otherwise all turned by a quarter.
    ``full_rows``: rather as all rows are full, if they are in one of the two. Raises JobError: they do not fit.
    """
    bed, border = check_bed(profile), tool_border(profile)
    check_copies(layout)
    x, y = (border, border) if layout.at is None else layout.at
    if min(x, y) < border - SLACK_MM:
        around = f", and the tool goes {border:g} mm beyond the sheet" if border else ""
        raise JobError(
            f"--at {x:g},{y:g} is off the bed, which begins at 0,0{around}; "
            f"use --at {max(x, border):g},{max(y, border):g}"
        )
    Lay.on(sheet, bed, border)  # one sheet has to fit by itself
    lays, fitting = [], []
    for turned in (False, True):
        width, height = (sheet.height, sheet.width) if turned else (sheet.width, sheet.height)
        lay = Lay(sheet, (width + 2 * border, height + 2 * border), (0.0, 0.0), turned, border)
        columns, rows = (
            _fitting(room - start + border, size)
            for room, start, size in zip((bed.width_mm, bed.height_mm), (x, y), lay.size, strict=True)
        )
        lays.append((lay, columns, rows))
        if columns * rows >= layout.copies:
            places = [divmod(number, columns) for number in range(layout.copies)]
            step = (lay.size[0] + APART_MM, lay.size[1] + APART_MM)
            corners = [(x - border + column * step[0], y - border + row * step[1]) for row, column in places]
            found = lay, [from_zero(corner, lay.size, bed) for corner in corners]
            if not full_rows or _rows_are_full(found[1]):
                return found
            fitting.append(found)
    if fitting:
        return fitting[0]
    raise _no_room(sheet, bed, border, layout, max(columns * rows for _, columns, rows in lays))


def check_sides(sheet: Sheet, profile: Profile, layout: BedLayout, registration: Registration) -> None:
    """Raise JobError if sheets cannot be turned over as ``registration`` has it.

    Out of jigs, which only machines that cut make, each sheet is turned over by itself. With holes or pins all of the
    stock is, in one piece: copies lie on the places of copies only where all rows are full.
    """
    if registration == "jig" and not profile.draws:
        return
    no_jig = f"{profile.title} cuts no jig to turn the sheet over in"
    if layout.copies == 1:
        if registration == "jig":
            raise JobError(f"{no_jig}; use --registration corners")
        return
    counts = range(layout.copies, 0, -1)
    full = next(
        count
        for count in counts
        if _rows_are_full(laid_out(sheet, profile, replace(layout, copies=count), full_rows=True)[1])
    )
    if registration == "jig":
        what = no_jig
    elif registration == "corners":
        what = "corner marks line up one sheet at a time"
    elif full == layout.copies:
        return
    else:
        what = f"{layout.copies} copies on {registration} are turned over together, and lie on other places then"
    remedies = [] if profile.draws else ["--registration jig"]
    if full > 1:
        fewer = f" --copies {full}" if full < layout.copies else ""
        kept = registration if registration in ("holes", "pins") else "holes"
        remedies.append(f"--registration {kept}{fewer}")
    raise JobError(f"{what}; use {', '.join([*remedies, ''])}or --copies 1")


def _rows_are_full(corners: Sequence[tuple[float, float]]) -> bool:
    """Return whether as many copies lie in each row as in any other."""
    return len(set(Counter(y for _, y in corners).values())) == 1


def from_zero(corner: tuple[float, float], size: tuple[float, float], bed: Bed) -> tuple[float, float]:
    """Return a corner counted from the bed's zero as one from its lower left, or the other way round."""
    x, y = corner
    return (x, bed.height_mm - y - size[1]) if bed.origin == "upper-left" else (x, y)


def arranged(parts: Sequence[tuple[Job, tuple[float, float]]], profile: Profile) -> Job:
    """Return one job, as large as the bed, of the jobs of several sheets for the same side.

    Each comes with the lower left corner of the sheet on the bed, with the tool's border.
    """
    bed, border = check_bed(profile), tool_border(profile)
    first = parts[0][0]
    steps: list[JobStep] = []
    for role in get_args(Role):
        some = [(step, corner) for job, corner in parts for step in job.steps if step.role == role]
        if some:
            step, _ = some[0]
            operation = operation_after(steps[-1] if steps else None, profile, role, step.action)
            strokes = tuple(stroke + corner for step, corner in some for stroke in step.strokes)
            steps.append(replace(step, operation=operation, strokes=strokes))
    way = travel([step.strokes for step in steps], np.zeros(2))
    holes = [job.holes + corner for job, corner in parts if job.holes is not None]
    return replace(
        first,
        size=(bed.width_mm, bed.height_mm),
        at=(0.0, 0.0),
        steps=tuple(steps),
        travel_before=sum(job.travel_before for job, _ in parts) + way - sum(job.travel for job, _ in parts),
        travel=way,
        holes=np.concatenate(holes) if holes else None,
        uncut=sum(job.uncut for job, _ in parts),
        corners=tuple(_sheet_corner(job, corner, bed, border) for job, corner in parts),
    )


def _sheet_corner(job: Job, corner: tuple[float, float], bed: Bed, border: float) -> tuple[float, float]:
    """Return the corner of a sheet itself that is next to the bed's zero, counted from there."""
    x, y = from_zero(corner, job.size, bed)
    return x + border, y + border


def quarter_turned(job: Job) -> Job:
    """Return a job of one sheet turned by a quarter to the left."""
    width, height = job.size
    steps = tuple(
        replace(step, strokes=tuple(np.column_stack([height - stroke[:, 1], stroke[:, 0]]) for stroke in step.strokes))
        for step in job.steps
    )
    return replace(job, size=(height, width), turned=not job.turned, steps=steps)


def _fitting(room: float, size: float) -> int:
    """Return how many sheets of a size fit beside each other."""
    return max(0, math.floor((room + APART_MM + SLACK_MM) / (size + APART_MM)))


def _no_room(sheet: Sheet, bed: Bed, border: float, layout: BedLayout, most: int) -> JobError:
    """Return the error that says that sheets do not fit, and what would."""
    what = f"{layout.copies} copies" if layout.copies > 1 else "the sheet"
    what = f"{what} of {sheet.width:g} x {sheet.height:g} mm" if layout.copies > 1 else f"{what} of {sheet}"
    there = f" from {layout.at[0]:g},{layout.at[1]:g} on" if layout.at is not None else ""
    goes = "does" if layout.copies == 1 else "do"
    text = f"{what} {goes} not fit the machine's {bed.width_mm:g} x {bed.height_mm:g} mm{there}"
    if most:
        fewer = f"use --copies {most}"
        return TooLargeError(f"{text}, {APART_MM:g} mm apart", f"{fewer}, or a smaller --sheet", fewer)
    x, y = (max(0.0, side - length - border) for side, length in _as_it_fits(sheet, bed, border))
    return JobError(f"{text}; use --at {x:g},{y:g} or less")


def _as_it_fits(sheet: Sheet, bed: Bed, border: float) -> list[tuple[float, float]]:
    """Return the sides of the bed, each with that of the sheet along it, as the sheet lies alone."""
    size = Lay.on(sheet, bed, border).size
    return [(bed.width_mm, size[0] - 2 * border), (bed.height_mm, size[1] - 2 * border)]
