"""The job: what a machine does to the sheet, step after step, ready for any format.

``FoldedPattern`` and ``Profile`` -> a ``Job`` for each side. Lengths are mm, y points up, and (0, 0) is the lower left
corner of the sheet as it lies on the bed (``bed``); ``Job.at`` says where on the bed that is.

The steps come in this order: marks, mountains, valleys, and last the outline of the sheet, which is cut when everything
else is done. No line is drawn twice. ``marks`` draws the marks, ``dashes`` divides creases into pieces, and
``pen_path`` orders the strokes of each step.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely

from foldcut.core.arrays import Floats
from foldcut.core.model import FoldedPattern, Sheet
from foldcut.jobs.bed import Lay, Side
from foldcut.jobs.dashes import crease_pieces
from foldcut.jobs.errors import JobError
from foldcut.jobs.marks import DEFAULT_MARKS, HOLES_MM, MARKS, corner_marks, crosses, holes
from foldcut.jobs.pen_path import Run, ordered, travel
from foldcut.profiles import Dash, Operation, Profile, Role, Setting, Treatment

Registration = Literal["corners", "holes", "pins"]
"""What lines the back up with the front: marks in the corners, holes for pegs, or pinholes."""


@dataclass(frozen=True, eq=False)
class JobStep:
    """The strokes of one role, ``(n, 2)`` each, in the order and the direction in which they are made.

    ``operation`` says what the machine calls the role; ``setting`` is None where the material has none for it.
    """

    role: Role
    operation: Operation
    setting: Setting | None
    strokes: tuple[Floats, ...]

    @property
    def length(self) -> float:
        """The length of all strokes in mm."""
        return float(sum(np.hypot(*np.diff(stroke, axis=0).T).sum() for stroke in self.strokes))


@dataclass(frozen=True, eq=False)
class Job:
    """Everything that is done to one side of a sheet.

    ``size``, ``at`` and ``turned`` are those of the ``Lay``; ``travel_before`` and ``travel``: how far the tool moves
    between strokes, in mm, in the pattern's own order and in the job's.
    """

    title: str
    size: tuple[float, float]
    at: tuple[float, float]
    turned: bool
    side: Side
    steps: tuple[JobStep, ...]
    travel_before: float
    travel: float


def make_jobs(
    pattern: FoldedPattern,
    profile: Profile,
    *,
    material: str | None = None,
    treatment: Treatment | None = None,
    two_sided: bool = False,
    registration: Registration = "corners",
    marks: Sequence[str] = DEFAULT_MARKS,
    tile: bool = False,
) -> tuple[Job, ...]:
    """Return the job for a pattern on a machine, or with ``two_sided`` one for its front and one for its back.

    ``material``: a name from the profile; its first by default. ``treatment`` of the creases: "score", "perforate" or
    "draw"; the profile's by default. ``two_sided``: mountains from the front and valleys from the back; the sheet is
    turned over like a page, left to right. ``registration`` lines the sides up: corner marks on both, or "holes" or
    "pins" that are cut from the front and have crosses at their places on the back. ``marks``: names from ``MARKS``.
    ``tile``: a printer may use several pages for the sheet.

    Raises JobError: the sheet does not fit the bed, or the profile has no such material.
    """
    treatment = treatment or profile.treatment
    check_job(pattern.sheet, profile, material=material, tile=tile)
    dashes, settings = _material(profile, material, treatment)
    lay = Lay.on(pattern.sheet, None if tile else profile.bed)
    sides: tuple[Side, ...] = ("front", "back") if two_sided else ("both",)
    jobs = []
    for side in sides:
        runs: dict[Role, list[Run]] = {"mark": [], "mountain": [], "valley": [], "cut": []}
        if side != "back":
            # the cut line is part of the outline, and no line may be there twice
            names = [name for name in marks if name != "cut-line" or "outline" not in marks]
            runs["mark"] += [[line] for name in names for line in MARKS[name](pattern)]
        if two_sided:
            role, lines = _registration(pattern.sheet, registration, side)
            runs[role] += [[line] for line in lines]
        for role, letter, absent in (("mountain", "M", "back"), ("valley", "V", "front")):
            if side != absent:
                runs[role] += list(crease_pieces(pattern.creases, letter, treatment, dashes, profile.drawing))
        if profile.cut_outline and side != "front":
            corners = _outset(pattern.sheet.corners, profile.kerf_mm / 2)
            runs["cut"].append([np.concatenate([corners, corners[:1]])])
        jobs.append(_job(pattern, profile, runs, settings, lay, side))
    return tuple(jobs)


def _registration(sheet: Sheet, kind: Registration, side: Side) -> tuple[Role, list[Floats]]:
    """Return the lines that line one side up with the other, and their role."""
    if kind == "corners":
        return "mark", corner_marks(sheet)
    diameter = HOLES_MM[kind]
    return ("cut", holes(sheet, diameter)) if side == "front" else ("mark", crosses(sheet, diameter))


def check_job(sheet: Sheet, profile: Profile, *, material: str | None = None, tile: bool = False) -> None:
    """Check a job before there is a pattern.

    Raises JobError: the sheet does not fit the bed, or the profile has no such material or is only for drawings.
    """
    for role in ("mark", "mountain", "valley", "cut"):
        if role not in profile.operations:
            raise JobError(
                f"the profile {profile.title!r} has no operation {role!r}; leave --profile out for a drawing"
            )
    _material(profile, material, "score")
    if tile and profile.page is None:
        raise JobError(f"the profile {profile.title!r} cannot tile: only printers take several pages")
    Lay.on(sheet, None if tile else profile.bed)


def steps_of(profile: Profile, material: str | None = None) -> tuple[JobStep, ...]:
    """Return a job's steps without strokes, to check that a format finds all it needs in the profile."""
    _, settings = _material(profile, material, profile.treatment)
    return tuple(JobStep(role, operation, settings[role], ()) for role, operation in profile.operations.items())


def _job(
    pattern: FoldedPattern,
    profile: Profile,
    runs_of: dict[Role, list[Run]],
    settings: dict[Role, Setting | None],
    lay: Lay,
    side: Side,
) -> Job:
    """Lay the runs on the bed and order them, role by role; each role goes on where the one before it ended."""
    steps = []
    travel_before = travel_after = 0.0
    here = here_before = np.zeros(2)
    for role, runs in runs_of.items():
        if not runs:
            continue
        runs = [[lay.place(stroke, side) for stroke in run] for run in runs]
        travel_before += travel(runs, here_before)
        here_before = runs[-1][-1][-1]
        runs = ordered(runs, here)
        travel_after += travel(runs, here)
        here = runs[-1][-1][-1]
        strokes = tuple(stroke for run in runs for stroke in run)
        steps.append(JobStep(role, profile.operations[role], settings[role], strokes))
    return Job(pattern.title, lay.size, lay.at, lay.turned, side, tuple(steps), travel_before, travel_after)


def _material(
    profile: Profile, name: str | None, treatment: Treatment
) -> tuple[dict[str, Dash], dict[Role, Setting | None]]:
    """Return the perforations of a material by assignment, and its settings by role."""
    if not profile.materials:
        raise JobError(f"the profile {profile.title!r} has no materials")
    name = name or next(iter(profile.materials))
    if name not in profile.materials:
        raise JobError(f"there is no material {name!r}; choose one of {', '.join(profile.materials)}")
    material = profile.materials[name]
    score = material.perforate if treatment == "perforate" else material.score
    settings: dict[Role, Setting | None] = {
        "mark": material.mark,
        "mountain": score,
        "valley": score,
        "cut": material.cut,
    }
    return {"M": material.mountain, "V": material.valley}, settings


def _outset(corners: Floats, by: float) -> Floats:
    """Return an outline moved outwards by half the kerf, so that what is cut out has its true size."""
    if not by:
        return corners
    outline = shapely.Polygon(corners).buffer(by, join_style="mitre").exterior
    return np.asarray(outline.coords)[:-1]
