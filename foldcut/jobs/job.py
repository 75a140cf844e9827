"""The job: what a machine does to the sheet, operation after operation, ready for any format.

``FoldedPattern`` and ``Profile`` -> ``Job``. Lengths are mm, y points up, (0, 0) is the sheet's lower left corner as it
lies on the bed; ``Job.at`` says where that is.

Creases that go straight on are one line, and no line is there twice. Perforations are fitted to each crease between
two vertices: cuts end a clearance before both, so that no two cuts meet. Operations come in this order: marks,
mountains, valleys, the sheet's outline last; each operation's strokes are in the order of a short way for the pen.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely

from foldcut.core.arrays import Floats
from foldcut.core.model import FoldedPattern, Sheet
from foldcut.jobs.bed import Lay, Side
from foldcut.jobs.dashes import mountain_pieces, perforation, valley_pieces
from foldcut.jobs.errors import JobError
from foldcut.jobs.marks import DEFAULT_MARKS, HOLES_MM, MARKS, corner_marks, crosses, holes
from foldcut.jobs.pen_path import _ordered, travel
from foldcut.pattern.straight_lines import straight_lines
from foldcut.profiles import Dash, Drawing, Operation, Profile, Role, Setting, Treatment

Registration = Literal["corners", "holes", "pins"]
"""What lines the back up with the front: marks to look at, holes for pegs, or needles' holes."""


@dataclass(frozen=True, eq=False)
class Step:
    """One operation: its strokes, ``(n, 2)`` each, in the order and direction they are made."""

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

    ``size`` of the sheet as it lies, in mm; ``at``: where its lower left corner lies from the bed's; ``turned``:
    whether it lies a quarter turn counter-clockwise; ``travel_before`` and ``travel``: the way between strokes, in
    mm, in the pattern's own order and in the job's.
    """

    title: str
    size: tuple[float, float]
    at: tuple[float, float]
    turned: bool
    side: Side
    steps: tuple[Step, ...]
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
    """Return the job for a pattern on a machine, or with ``two_sided`` those for its front and its back.

    ``material`` is one of the profile's, its first unless given; ``treatment`` of the creases: "score", "perforate" or
    "draw", the profile's unless given. ``two_sided``: mountains from the front, valleys from the back, which is turned
    over like a page, left to right; ``registration`` lines it up: corner marks on both sides, or "holes" or "pins"
    that are cut from the front, with crosses there on the back. ``marks``: names from ``MARKS``. ``tile``: a printer
    may take several pages for the sheet.

    Raises JobError: the sheet does not fit the bed, or the profile has no such material.
    """
    treatment = treatment or profile.treatment
    check_job(pattern.sheet, profile, material=material, tile=tile)
    dashes, settings = _material(profile, material, treatment)
    lay = Lay.on(pattern.sheet, None if tile else profile.bed)
    sides: tuple[Side, ...] = ("front", "back") if two_sided else ("both",)
    jobs = []
    for side in sides:
        roles: dict[Role, list[list[Floats]]] = {"mark": [], "mountain": [], "valley": [], "cut": []}
        if side != "back":
            # the cut line is a part of the outline, and no line is there twice
            names = [name for name in marks if name != "cut-line" or "outline" not in marks]
            roles["mark"] += [[line] for name in names for line in MARKS[name](pattern)]
        if two_sided:
            role, lines = _registration(pattern.sheet, registration, side)
            roles[role] += [[line] for line in lines]
        for role, letter, absent in (("mountain", "M", "back"), ("valley", "V", "front")):
            if side != absent:
                roles[role] += list(_creases(pattern, letter, treatment, dashes, profile.drawing))
        if profile.cut_outline and side != "front":
            corners = _outset(pattern.sheet.corners, profile.kerf_mm / 2)
            roles["cut"].append([np.concatenate([corners, corners[:1]])])
        jobs.append(_job(pattern, profile, roles, settings, lay, side))
    return tuple(jobs)


def _registration(sheet: Sheet, kind: Registration, side: Side) -> tuple[Role, list[Floats]]:
    """Return what lines one side up with the other, and the operation that it belongs to."""
    if kind == "corners":
        return "mark", corner_marks(sheet)
    diameter = HOLES_MM[kind]
    return ("cut", holes(sheet, diameter)) if side == "front" else ("mark", crosses(sheet, diameter))


def check_job(sheet: Sheet, profile: Profile, *, material: str | None = None, tile: bool = False) -> None:
    """Raise JobError: the sheet does not fit the bed, or the profile has no such material or is for drawings only."""
    for role in ("mark", "mountain", "valley", "cut"):
        if role not in profile.operations:
            raise JobError(
                f"the profile {profile.title!r} has no operation {role!r}; leave --profile out for a drawing"
            )
    _material(profile, material, "score")
    if tile and profile.page is None:
        raise JobError(f"the profile {profile.title!r} cannot tile: only printers take several pages")
    Lay.on(sheet, None if tile else profile.bed)


def steps_of(profile: Profile, material: str | None = None) -> tuple[Step, ...]:
    """Return the steps of a job with nothing in them, to see whether a format has all that it needs."""
    _, settings = _material(profile, material, profile.treatment)
    return tuple(Step(role, operation, settings[role], ()) for role, operation in profile.operations.items())


def _job(
    pattern: FoldedPattern,
    profile: Profile,
    roles: dict[Role, list[list[Floats]]],
    settings: dict[Role, Setting | None],
    lay: Lay,
    side: Side,
) -> Job:
    steps = []
    before = after = 0.0
    here = there = np.zeros(2)
    for role, lines in roles.items():
        if not lines:
            continue
        lines = [[lay.place(piece, side) for piece in line] for line in lines]
        before += travel(lines, there)
        there = lines[-1][-1][-1]
        lines = _ordered(lines, here)
        after += travel(lines, here)
        here = lines[-1][-1][-1]
        steps.append(
            Step(role, profile.operations[role], settings[role], tuple(piece for line in lines for piece in line))
        )
    return Job(pattern.title, lay.size, lay.at, lay.turned, side, tuple(steps), before, after)


def _material(
    profile: Profile, name: str | None, treatment: Treatment
) -> tuple[dict[str, Dash], dict[Role, Setting | None]]:
    """Return the dashes by letter and the settings by role."""
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


def _creases(
    pattern: FoldedPattern, letter: str, treatment: Treatment, dashes: dict[str, Dash], drawing: Drawing
) -> Iterator[list[Floats]]:
    """Yield the creases of a kind, each as the pieces that are made of it."""
    creases = pattern.creases
    edges = creases.edges_vertices[creases.edges_assignment == letter]
    points = creases.vertices_coords
    if treatment == "perforate":
        for edge in edges:
            pieces = perforation(points[edge], dashes[letter])
            if pieces:
                yield pieces
        return
    for a, b in straight_lines(points, edges.tolist()):
        line = points[[a, b]]
        if treatment == "score":
            yield [line]
        elif letter == "V":
            yield list(valley_pieces(line, drawing))
        else:
            yield list(mountain_pieces(line, drawing))


def _outset(corners: Floats, by: float) -> Floats:
    """Return the outline moved outwards by half the kerf, so that what is cut has its true size."""
    if not by:
        return corners
    ring = shapely.Polygon(corners).buffer(by, join_style="mitre").exterior
    return np.asarray(ring.coords)[:-1]
