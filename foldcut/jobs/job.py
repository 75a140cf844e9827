"""The job: what a machine does to the sheet, step after step, ready for any format.

``FoldedPattern`` and ``Profile`` -> a ``Job`` for each side. Lengths are mm, y points up, and (0, 0) is the lower left
corner of the sheet as it lies on the bed (``bed``); ``Job.at`` says where on the bed that is.

The steps come in this order: marks, mountains, valleys, and last the outline of the sheet, which is cut when everything
else is done. No line is drawn twice, and none goes beyond what the machine reaches. ``marks`` draws the marks,
``dashes`` divides creases into pieces, and ``pen_path`` joins and orders the strokes of each step.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import cast

import numpy as np
import shapely

from foldcut.core.arrays import Floats
from foldcut.core.model import FoldedPattern, Sheet
from foldcut.jobs.arrange import IN_THE_CORNER, BedLayout, arranged, check_sides, laid_out
from foldcut.jobs.bed import Box, Lay, Side
from foldcut.jobs.dashes import Cuts, crease_pieces, perforations
from foldcut.jobs.errors import JobError, TooLargeError
from foldcut.jobs.marks import HOLES_MM, MARKS, Room, corner_marks, crosses, hole_centres, holes
from foldcut.jobs.model import Job, JobStep, operation_after
from foldcut.jobs.pen_path import Run, chained, joined, ordered, travel
from foldcut.jobs.tabs import Tabs, check_tabs, cut_around_tabs
from foldcut.profiles import Action, Material, Profile, Registration, Role, Treatment

__all__ = ["Job", "JobStep", "Registration", "check_job", "make_jobs", "steps_of"]

SHORTEST_STROKE_MM = 0.05
"""What is left of a line at the edge of a plotter's reach is drawn if it is at least this long."""


def make_jobs(
    pattern: FoldedPattern,
    profile: Profile,
    *,
    material: str | None = None,
    treatment: Treatment | None = None,
    two_sided: bool = False,
    registration: Registration | None = None,
    marks: Sequence[str] | None = None,
    tile: bool = False,
    layout: BedLayout = IN_THE_CORNER,
    tabs: Tabs | None = None,
    framed: bool = False,
) -> tuple[Job, ...]:
    """Return the job for a pattern on a machine, or with ``two_sided`` one for its front and one for its back.

    ``material``: a name from the profile; its first by default. ``treatment`` of the creases: "score", "perforate" or
    "draw"; the profile's by default. ``two_sided``: mountains from the front and valleys from the back; how the sheet
    is turned over between them is in ``Job.turned_over``. ``registration`` lines the sides up, by default the
    profile's: "jig": the outline is cut with the front, and the sheet turned over in the hole it leaves; "corners":
    marks on both sides; or "holes" or "pins" that are cut from the front and have crosses at their places on the back.
    ``marks``: names from ``MARKS``; the profile's by default. ``tile``: a printer may use several pages for the sheet.
    ``layout``: where on the bed the sheet lies, and how many copies of it. ``tabs`` hold it when it is cut out.
    ``framed``: a file beside the job's will go round it with the tool off.

    Raises JobError: the sheet does not fit the bed, the profile has no such material, or the machine cannot do what is
    asked for.
    """
    treatment = treatment or profile.treatment
    registration = registration or profile.registration
    check_job(
        pattern.sheet,
        profile,
        material=material,
        tile=tile,
        registration=registration if two_sided else None,
        layout=layout,
        tabs=tabs,
    )
    lay = Lay.for_machine(pattern.sheet, profile, tile=tile)
    corners: list[tuple[float, float]] = []
    if layout.asked_for:
        together = two_sided and registration in HOLES_MM
        lay, corners = laid_out(pattern.sheet, profile, layout, full_rows=together)
    stuff = _material(profile, material)
    creases, uncut = _creases(pattern, profile, stuff, treatment)
    # the cut line is part of the outline, and no line may be there twice
    names = profile.marks if marks is None else marks
    drawn = [
        line for name in names if name != "cut-line" or "outline" not in names for line in _mark(name, pattern, lay)
    ]
    jobs = []
    for side in cast("tuple[Side, ...]", ("front", "back") if two_sided else ("both",)):
        runs: dict[Role, list[Run]] = {"mark": [], "mountain": [], "valley": [], "cut": []}
        if side != "back":
            runs["mark"] += [[line] for line in drawn]
        if two_sided:
            role, lines = _registration(pattern.sheet, registration, side, lay.room)
            runs[role] += [[line] for line in lines]
        for role, letter, absent in (("mountain", "M", "back"), ("valley", "V", "front")):
            if side != absent:
                runs[role] += creases[letter]
        # out of a jig the sheet is cut before it is turned over
        last = "front" if registration == "jig" else "back"
        if (profile.cut_outline or lay.cut_out) and side in ("both", last):
            outline = _outset(pattern.sheet.corners, profile.kerf_mm / 2)
            runs["cut"].append([outline] if tabs is None else cut_around_tabs(outline, tabs, profile.kerf_mm))
        job = replace(_job(pattern, profile, runs, _actions(treatment), stuff, lay, side), uncut=uncut)
        if two_sided:
            job = replace(job, registration=registration, turned_over=lay.turned_over)
        if two_sided and registration in HOLES_MM:
            centres = hole_centres(pattern.sheet, HOLES_MM[registration], lay.room)
            job = replace(job, holes=lay.place(centres, side))
        job = replace(job, framed=framed, tabs=tabs if runs["cut"] and side in ("both", last) else None)
        jobs.append(arranged([(job, corner) for corner in corners], profile) if corners else job)
    return tuple(jobs)


def _mark(name: str, pattern: FoldedPattern, lay: Lay) -> list[Floats]:
    return MARKS[name](pattern, None if lay.reach is None else lay.room)


def _creases(
    pattern: FoldedPattern, profile: Profile, stuff: Material, treatment: Treatment
) -> tuple[Mapping[str, list[Run]], int]:
    """Return the runs of mountains and valleys, and how many creases are too short to perforate."""
    if treatment == "perforate":
        shortest = profile.blade.offset_mm if profile.blade is not None else 0.0
        dashes = {"M": stuff.mountain, "V": stuff.valley}
        return perforations(pattern.creases, Cuts(dashes, profile.kerf_mm + stuff.web_mm, shortest))
    return {
        letter: list(crease_pieces(pattern.creases, letter, treatment, profile.drawing)) for letter in ("M", "V")
    }, 0


def _registration(sheet: Sheet, kind: Registration, side: Side, room: Room) -> tuple[Role, list[Floats]]:
    """Return the lines that line one side up with the other, and their role."""
    if kind == "jig":
        return "cut", []
    if kind == "corners":
        return "mark", corner_marks(sheet, room)
    diameter = HOLES_MM[kind]
    return ("cut", holes(sheet, diameter, room)) if side == "front" else ("mark", crosses(sheet, diameter, room))


def check_job(
    sheet: Sheet,
    profile: Profile,
    *,
    material: str | None = None,
    tile: bool = False,
    registration: Registration | None = None,
    layout: BedLayout = IN_THE_CORNER,
    tabs: Tabs | None = None,
) -> None:
    """Check a job before there is a pattern.

    ``registration``: what lines up the sides of a job that has two. Raises JobError: the sheet does not fit the bed,
    the profile has no such material or is only for drawings, or the machine does not do what is asked for.
    """
    for role in ("mark", "mountain", "valley", "cut"):
        if role not in profile.operations:
            raise JobError(
                f"the profile {profile.title!r} has no operation {role!r}; leave --profile out for a drawing"
            )
    _material(profile, material)
    if tile and profile.page is None:
        raise JobError(f"the profile {profile.title!r} cannot tile: only printers take several pages")
    Lay.for_machine(sheet, profile, tile=tile)
    if layout.asked_for:
        laid_out(sheet, profile, layout)
    if registration is not None:
        check_sides(sheet, profile, layout, registration)
    if tabs is not None:
        check_tabs(tabs, sheet, profile)


def steps_of(profile: Profile, material: str | None = None) -> tuple[JobStep, ...]:
    """Return a job's steps without strokes, to check that a format finds all it needs in the profile."""
    actions, stuff = _actions(profile.treatment), _material(profile, material)
    return tuple(
        JobStep(role, operation, getattr(stuff, _SETTINGS[actions[role]]), (), actions[role])
        for role, operation in profile.operations.items()
    )


def _job(
    pattern: FoldedPattern,
    profile: Profile,
    runs_of: dict[Role, list[Run]],
    actions: Mapping[Role, Action],
    stuff: Material,
    lay: Lay,
    side: Side,
) -> Job:
    """Lay the runs on the bed and order them, role by role; each role goes on where the one before it ended."""
    steps: list[JobStep] = []
    travel_before = travel_after = 0.0
    here = here_before = np.zeros(2)
    for role, runs in runs_of.items():
        runs = within([[lay.place(stroke, side) for stroke in run] for run in runs], lay.reach)
        if not runs:
            continue
        travel_before += travel(runs, here_before)
        here_before = runs[-1][-1][-1]
        runs = chained(ordered(joined(runs), here))
        travel_after += travel(runs, here)
        here = runs[-1][-1][-1]
        strokes = tuple(stroke for run in runs for stroke in run)
        action = actions[role]
        operation = operation_after(steps[-1] if steps else None, profile, role, action)
        steps.append(JobStep(role, operation, getattr(stuff, _SETTINGS[action]), strokes, action))
    job = Job(pattern.title, lay.size, lay.at, lay.turned, side, tuple(steps), travel_before, travel_after, lay.paper)
    _check_reach(job, profile)
    if lay.reach is not None:
        (width, height), (x, y, u, v) = lay.size, lay.reach
        job = replace(job, missed=(max(0.0, x), max(0.0, y), max(0.0, width - u), max(0.0, height - v)))
    return job


def within(runs: list[Run], reach: Box | None) -> list[Run]:
    """Return what is left of the runs within the reach of the machine; runs that are beyond it are left out."""
    if reach is None:
        return runs
    low, high = np.array(reach[:2]), np.array(reach[2:])
    box = shapely.box(*reach)
    return [left for run in runs if (left := [part for stroke in run for part in _inside(stroke, low, high, box)])]


def _inside(stroke: Floats, low: Floats, high: Floats, box: shapely.Geometry) -> list[Floats]:
    """Return the parts of a stroke in a box, in their order."""
    if (stroke >= low).all() and (stroke <= high).all():
        return [stroke]
    line = shapely.linestrings(stroke)
    shared = shapely.get_parts(shapely.intersection(line, box))
    lines = [part for part in shared if shapely.length(part) >= SHORTEST_STROKE_MM]
    return [shapely.get_coordinates(part) for part in lines]


def _check_reach(job: Job, profile: Profile) -> None:
    """Raise JobError if a stroke leaves the bed: a wide kerf, or marks on the sheet's edge."""
    if profile.bed is None or profile.page is not None:
        return
    bed = profile.bed
    for step in job.steps:
        points = np.concatenate(step.strokes) + job.at
        if (points < -1e-6).any() or (points > np.array([bed.width_mm, bed.height_mm]) + 1e-6).any():
            raise TooLargeError(
                f"layer {step.operation.layer} goes beyond the machine's {bed.width_mm:g} x {bed.height_mm:g} mm",
                "use a smaller --sheet",
            )


_SETTINGS: dict[Action, str] = {
    "mark": "mark",
    "score": "score",
    "draw": "score",
    "perforate": "perforate",
    "cut": "cut",
}
"""Which setting of a material goes with an action."""


def _actions(treatment: Treatment) -> dict[Role, Action]:
    return {"mark": "mark", "mountain": treatment, "valley": treatment, "cut": "cut"}


def _material(profile: Profile, name: str | None) -> Material:
    """Return a material of a profile; raises JobError: there is none of this name."""
    if not profile.materials:
        raise JobError(f"the profile {profile.title!r} has no materials")
    name = name or next(iter(profile.materials))
    if name not in profile.materials:
        raise JobError(f"there is no material {name!r}; choose one of {', '.join(profile.materials)}")
    return profile.materials[name]


def _outset(corners: Floats, by: float) -> Floats:
    """Return the closed outline of the sheet, moved outwards by half the kerf, so that the sheet has its true size."""
    if by:
        corners = np.asarray(shapely.Polygon(corners).buffer(by, join_style="mitre").exterior.coords)[:-1]
    return np.concatenate([corners, corners[:1]])
