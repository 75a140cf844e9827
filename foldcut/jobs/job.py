"""The job: what a machine does to the sheet, operation after operation, ready for any format.

``FoldedPattern`` and ``Profile`` -> ``Job``. Lengths are mm, y points up, (0, 0) is the sheet's lower left corner as it
lies on the bed; ``Job.at`` says where that is.

Creases that go straight on are one line, and no line is there twice. Perforations are fitted to each crease between
two vertices: cuts end a clearance before both, so that no two cuts meet. Operations come in this order: marks,
mountains, valleys, the sheet's outline last; each operation's strokes are in the order of a short way for the pen.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
import shapely

from foldcut.core.arrays import Floats
from foldcut.core.errors import BadInputError
from foldcut.core.model import FoldedPattern, Sheet
from foldcut.jobs.marks import DEFAULT_MARKS, HOLES_MM, MARKS, corner_marks, crosses, holes
from foldcut.pattern.straight_lines import straight_lines
from foldcut.profiles import Bed, Dash, Drawing, Operation, Profile, Role, Setting, Treatment

Side = Literal["both", "front", "back"]

PASSES, MOST_LINES = 20, 4000
"""How often the whole way is gone through to make it shorter, and for how many lines at most; of more lines the nearest
ends are looked for in a tree."""

Registration = Literal["corners", "holes", "pins"]
"""What lines the back up with the front: marks to look at, holes for pegs, or needles' holes."""


class JobError(BadInputError):
    """The job does not suit the machine: too large, or the profile lacks what it needs."""


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


@dataclass(frozen=True)
class Lay:
    """How a sheet lies on the bed: see ``Job``."""

    sheet: Sheet
    size: tuple[float, float]
    at: tuple[float, float]
    turned: bool

    @classmethod
    def on(cls, sheet: Sheet, bed: Bed | None) -> Lay:
        """Lay a sheet in the origin's corner, upright if it fits so, else turned a quarter."""
        width, height = sheet.width, sheet.height
        if bed is None:
            return cls(sheet, (width, height), (0.0, 0.0), False)
        slack = 1e-6
        for turned, (w, h) in ((False, (width, height)), (True, (height, width))):
            if w <= bed.width_mm + slack and h <= bed.height_mm + slack:
                at = (0.0, bed.height_mm - h if bed.origin == "upper-left" else 0.0)
                return cls(sheet, (w, h), at, turned)
        small, large = sorted((bed.width_mm, bed.height_mm))
        raise JobError(
            f"the sheet of {width:g} x {height:g} mm does not fit the machine's {bed.width_mm:g} x "
            f"{bed.height_mm:g} mm; use --sheet {small:g}x{large:g}mm or smaller, or --tile on a printer"
        )

    def place(self, points: Floats, side: Side = "both") -> Floats:
        """Move points from the pattern's sheet to the sheet as it lies."""
        x, y = points[:, 0], points[:, 1]
        if side == "back":
            x = self.sheet.width - x
        return np.column_stack([self.sheet.height - y, x] if self.turned else [x, y])


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


def perforation(line: Floats, dash: Dash) -> list[Floats]:
    """Return the cuts along a crease, ``(2, 2)`` each: stretched a little to fit, with paper at both ends.

    A crease too short for one cut and both clearances gets one cut in its middle half; none is lost.
    """
    length = float(math.dist(*line))
    room = length - 2 * dash.clearance_mm
    if room < dash.dash_mm:
        ends = np.array([0.25, 0.75])
    else:
        count = max(0, round((room - dash.dash_mm) / (dash.dash_mm + dash.gap_mm)))
        steps = np.array([0.0, *np.cumsum([dash.dash_mm, *[dash.gap_mm, dash.dash_mm] * count])])
        ends = (dash.clearance_mm + steps / steps[-1] * room) / length
    places = line[0] + ends[:, None] * (line[1] - line[0])
    return list(places.reshape(-1, 2, 2))


def valley_pieces(line: Floats, drawing: Drawing) -> Floats:
    """Return the dashes along a valley, ``(n, 2, 2)``, stretched a little so that both ends have ink."""
    dash, gap = drawing.dash_mm, drawing.gap_mm
    count = round((math.dist(*line) - dash) / (dash + gap))
    return _divided(line, [dash, gap] * max(0, count) + [dash])


def mountain_pieces(line: Floats, drawing: Drawing) -> Floats:
    """Return the dashes and dots along a mountain, ``(n, 2, 2)``, stretched to begin and end with a dash."""
    dash, gap, dot = drawing.dash_mm, drawing.gap_mm, drawing.dot_mm
    count = round((math.dist(*line) - dash) / (dash + gap + dot + gap))
    return _divided(line, [dash, gap, dot, gap] * max(0, count) + [dash])


def _divided(line: Floats, lengths: Sequence[float]) -> Floats:
    """Divide a line in these proportions and return every other part, the first and the last among them."""
    if len(lengths) == 1:  # most creases of large patterns are shorter than two dashes
        return line[None].copy()
    ends = np.concatenate([[0.0], np.cumsum(lengths) / np.sum(lengths)])
    start, end = line
    points: Floats = start + ends[:, None] * (end - start)
    points[-1] = end
    return points.reshape(-1, 2, 2)


def _outset(corners: Floats, by: float) -> Floats:
    """Return the outline moved outwards by half the kerf, so that what is cut has its true size."""
    if not by:
        return corners
    ring = shapely.Polygon(corners).buffer(by, join_style="mitre").exterior
    return np.asarray(ring.coords)[:-1]


def travel(lines: Sequence[Sequence[Floats]], start: Floats) -> float:
    """The way between strokes in mm, from ``start`` on."""
    pieces = [piece for line in lines for piece in line]
    ways = [math.dist(start, pieces[0][0]), *(math.dist(a[-1], b[0]) for a, b in pairwise(pieces))]
    return sum(ways)


def _ordered(lines: list[list[Floats]], start: Floats) -> list[list[Floats]]:
    """Order lines, and turn them round, so that each begins near where the last one ended."""
    ends = np.array([[line[0][0], line[-1][-1]] for line in lines])
    order, back = _greedy(ends, start) if len(lines) <= MOST_LINES else _greedy_by_tree(ends, start)
    order, back = _two_opt(ends, order, back, start)
    turned = ([piece[::-1] for piece in reversed(line)] for line in lines)
    both = list(zip(lines, turned, strict=True))
    return [both[line][end] for line, end in zip(order, back, strict=True)]


def _greedy(ends: Floats, start: Floats) -> tuple[list[int], list[bool]]:
    """The line whose end is nearest next, and whether it is turned round; ``ends`` are ``(n, 2, 2)``."""
    left = np.ones(len(ends), dtype=bool)
    here, order, back = start, [], []
    for _ in ends:
        away = np.where(left[:, None], ((ends - here) ** 2).sum(axis=2), np.inf)
        line, end = divmod(int(away.argmin()), 2)
        left[line] = False
        order.append(line)
        back.append(bool(end))
        here = ends[line, 1 - end]
    return order, back


def _greedy_by_tree(ends: Floats, start: Floats) -> tuple[list[int], list[bool]]:
    """Do as ``_greedy`` for many lines, of ends equally far off any; the tree is made anew when half of it is gone."""
    from scipy.spatial import KDTree

    order: list[int] = []
    back: list[bool] = []
    here, left = start, np.ones(len(ends), dtype=bool)
    while len(order) < len(ends):
        lines = np.flatnonzero(left)
        tree = KDTree(ends[lines].reshape(-1, 2))
        for _ in range((len(lines) + 1) // 2):
            count = 2
            while True:
                near = lines[(found := np.atleast_1d(tree.query(here, k=min(count, tree.n))[1])) // 2]
                if left[near].any():
                    break
                count *= 4
            first = int(np.argmax(left[near]))
            line, end = int(near[first]), int(found[first]) % 2
            left[line] = False
            order.append(line)
            back.append(bool(end))
            here = ends[line, 1 - end]
    return order, back


def _two_opt(ends: Floats, order: list[int], back: list[bool], start: Floats) -> tuple[list[int], list[bool]]:
    """Turn stretches of the way round as long as that makes it shorter."""
    way = np.where(np.array(back)[:, None, None], ends[order][:, ::-1], ends[order])  # (n, 2, 2): in, out
    number, turned = np.array(order), np.array(back)
    count = len(number)
    for _ in range(PASSES if count <= MOST_LINES else 0):
        better = False
        for i in range(count):
            before = way[i - 1, 1] if i else start
            # the stretch from i to j turned round; after the last line the way ends anywhere
            joined = np.hypot(*(way[i:, 1] - before).T)
            after = np.append(np.hypot(*(way[i + 1 :, 0] - way[i, 0]).T), 0.0)
            now = np.append(np.hypot(*(way[i + 1 :, 0] - way[i:-1, 1]).T), 0.0)
            gain = math.dist(before, way[i, 0]) + now - joined - after
            j = int(gain.argmax())
            if gain[j] > 1e-6:
                some = slice(i, i + j + 1)
                way[some] = way[some][::-1, ::-1].copy()
                number[some] = number[some][::-1].copy()
                turned[some] = ~turned[some][::-1]
                better = True
        if not better:
            break
    return number.tolist(), turned.tolist()
