"""What the operator of a machine does: load the file, give every layer its operation, turn the sheet over.

``Profile`` and the jobs of one pattern -> lines of text. They name every layer, colour and pen that is in the files,
and every setting that the files cannot have; so nothing is left that a machine's software might take for a cut.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.jobs.job import Job, JobStep
from foldcut.jobs.marks import HOLES_MM
from foldcut.jobs.pages import flip_edge, tiles
from foldcut.profiles import Profile, Setting, Solid

COLOURS = {
    "#000000": "black",
    "#0000ff": "blue",
    "#00e000": "green",
    "#00ff00": "green",
    "#808080": "grey",
    "#ff0000": "red",
    "#ff00ff": "magenta",
    "#ffff00": "yellow",
    "#00ffff": "cyan",
}
"""The names of colours that have a plain one."""

IN_THE_FILE = {
    "hpgl": {"force_g", "speed_mm_s", "passes"},
    "gcode": {"speed_mm_s", "passes"},
    "lbrn2": {"speed_mm_s", "power_percent", "passes"},
}
"""The settings that a format has room for, besides a laser's power in G-code."""

MISSED_MM = 0.1
"""Margins narrower than this that a machine does not reach are not worth a word."""


def instructions(profile: Profile, jobs: Sequence[Job], formats: Collection[str] = ()) -> list[str]:
    """Return what the operator does with the files of these jobs, line by line.

    ``formats``: those of the files, such as "svg"; the machine's own by default, which alone says how to load a file.
    """
    formats = formats or (profile.format,)
    load = list(profile.instructions) if profile.format in formats else []
    if not jobs:
        return load if profile.solid is None or not load else solid_words(profile.solid, load)
    lines = load[:1]
    for job in jobs:
        side = "" if job.side == "both" else f"{job.side.capitalize()}: "
        lines += [f"{side}{step_words(step, profile, job.side, formats)}" for step in job.steps]
    lines += [*load[1:], *glued(profile, jobs[0])]
    if len(jobs) > 1:
        # out of a jig the sheet comes only when its tabs are cut
        lines += [*tabs_left(jobs[0], ", before you turn it over"), *turning_over(profile, jobs)]
    return [*lines, *notes(profile, jobs), *tabs_left(jobs[-1])]


def solid_words(solid: Solid, load: Sequence[str]) -> list[str]:
    """Return what to know of a solid: ``load``, as for a sheet with grooves on both sides, or what differs from it."""
    if solid.folded:
        return [
            load[0],
            "The plates are the layers in the order that was proven, as thick as the sheet; creases are not rounded.",
        ]
    if solid.one_sided:
        return [load[0], "All grooves are on top: fold mountains away from them, and valleys shut.", *load[2:]]
    return [*load]


def step_words(step: JobStep, profile: Profile, side: str = "both", formats: Collection[str] = ()) -> str:
    """Return what a step is called in the machine's software, what is done with it, and with which setting."""
    formats = formats or (profile.format,)
    operation = step.operation
    colour = f"{COLOURS[operation.colour]} " if operation.colour in COLOURS else ""
    pen = f", pen {operation.pen}" if operation.pen is not None and {"hpgl", "gcode"} & {*formats} else ""
    what = profile.does.get(step.action, step.action)
    if step.words:
        what = f"{step.words.partition(' ')[2]}: {what}"
    # seen from behind, a valley is a mountain
    behind = "; these valleys fold away from you on this side" if side == "back" and step.role == "valley" else ""
    setting = told_setting(step.setting, profile, formats)
    return f"{operation.layer} ({colour}{operation.colour}{pen}): {what}{behind}{setting}"


def told_setting(setting: Setting | None, profile: Profile, formats: Collection[str]) -> str:
    """Return the part of a setting that one of the files has no room for."""
    if setting is None:
        return ""
    known = set.intersection(*(_room(name, profile) for name in formats))
    parts = []
    if setting.power_percent is not None and "power_percent" not in known:
        parts.append(f"{setting.power_percent:g} % of the power")
    if setting.force_g is not None and "force_g" not in known:
        parts.append(f"{setting.force_g:g} g")
    if "speed_mm_s" not in known:
        parts.append(f"{setting.speed_mm_s:g} mm/s")
    if setting.passes > 1 and "passes" not in known:
        parts.append(f"{setting.passes} passes")
    return f"; begin with {', '.join(parts)}" if parts else ""


def _room(name: str, profile: Profile) -> set[str]:
    """Return the settings that a format has room for."""
    laser = name == "gcode" and profile.gcode is not None and profile.gcode.tool == "laser"
    return IN_THE_FILE.get(name, set()) | ({"power_percent"} if laser else set())


def glued(profile: Profile, job: Job) -> list[str]:
    """Return how to put a sheet together that is printed on several pages."""
    if profile.page is None or profile.format != "pdf":
        return []
    count = next(tiles(job, profile)).count
    line = f"{count} pages: glue them cross on cross; the small picture on each shows where it goes."
    return [line] if count > 1 else []


def turning_over(profile: Profile, jobs: Sequence[Job]) -> list[str]:
    """Return how the sheet is turned over between the front and the back, and what holds it in its place."""
    front, back = jobs[0], jobs[-1]
    assert back.turned_over is not None
    if profile.page is not None and profile.format == "pdf":
        edge = flip_edge(back.turned_over, next(tiles(front, profile)))
        lines = [
            f"Print on both sides, flip on {edge} edge, as the file asks; or print the odd pages, turn the sheet "
            f"over {back.turned_over}, and print the even ones."
        ]
        if back.registration == "corners":
            return [*lines, "Held against the light, the corner marks lie on one another."]
        return [
            *lines,
            holes_at(profile, front, back),
            "Where the page lies right the crosses of the back are on them.",
        ]
    turn = f"Do the front first, then turn the sheet over {back.turned_over}"
    corner = _zero(profile)
    if back.registration == "jig":
        return [
            f"{turn}: the front cuts its outline last; leave the stock fixed on the bed, and lay the sheet back into "
            "the hole it was cut out of."
        ]
    if back.registration == "corners":
        return [
            f"{turn}: fix two strips of card along its left and its {corner.split()[0]} edge before the front, and "
            "push it against them again; the corner marks lie on one another."
        ]
    size = HOLES_MM["pins" if back.registration == "pins" else "holes"]
    pegs = "needles" if back.registration == "pins" else "pegs"
    return [
        holes_at(profile, front, back),
        f"{turn}: put {pegs} of {size:g} mm into a board at these places, fix it on the bed, and lay the holes over "
        "them. Where the sheet lies right the crosses of the back are on the holes.",
    ]


def holes_at(profile: Profile, front: Job, back: Job) -> str:
    """Return where the registration holes are on both sides."""
    size = HOLES_MM["pins" if back.registration == "pins" else "holes"]
    return (
        f"Holes of {size:g} mm, in mm from the {_zero(profile)} corner of the bed: on the front "
        f"{_places(front, profile)}; with the sheet turned over they are at {_places(back, profile)}."
    )


def notes(profile: Profile, jobs: Sequence[Job]) -> list[str]:
    """Return where sheets lie, and what the machine leaves to be done by hand."""
    job = jobs[0]
    lines = []
    if job.framed:
        lines.append(
            "The file whose name ends in -frame goes round the job with the tool off: send it first, and see that the "
            "stock lies under its path."
        )
    if job.corners:
        lines.append(_where(job, profile))
    if job.paper is not None:
        lines.append(f"Load paper {job.paper.upper() if len(job.paper) < 3 else job.paper.capitalize()}.")
    edges = [
        f"{width:.1f} mm at the {name} edge"
        for name, width in zip(("left", "lower", "right", "upper"), job.missed, strict=True)
        if width > MISSED_MM
    ]
    if edges:
        where = (
            f"the outer {job.missed[0]:.1f} mm" if max(job.missed) - min(job.missed) < MISSED_MM else ", ".join(edges)
        )
        lines.append(f"Not reached: {where}; creases that end there go straight on to the edge of the sheet.")
    if job.uncut:
        one = job.uncut == 1
        lines.append(
            f"{job.uncut} crease{'' if one else 's'} {'is' if one else 'are'} too short to perforate and left uncut; "
            f"fold {'it' if one else 'them'} by hand."
        )
    return lines


def tabs_left(job: Job, when: str = "") -> list[str]:
    """Return where the outline of a job is not cut, and when its tabs are."""
    tabs = job.tabs
    if tabs is None:
        return []
    one, each = tabs.count == 1, " of each sheet" if len(job.corners) > 1 else ""
    return [
        f"The outline{each} is not cut at {tabs.count} tab{'' if one else 's'} of {tabs.width_mm:g} mm, which "
        f"{'holds' if one else 'hold'} the sheet in the stock: cut {'it' if one else 'them'} with a knife{when}."
    ]


def _where(job: Job, profile: Profile) -> str:
    """Return where the corners of sheets lie on the bed."""
    corner = _zero(profile)
    places = ", ".join(f"({x:g}, {y:g})" for x, y in np.round(job.corners, 3).tolist())
    sheets = "The sheet lies with its" if len(job.corners) == 1 else f"{len(job.corners)} sheets lie with their"
    turned = ", turned by a quarter to the left" if job.turned else ""
    return (
        f"{sheets} {corner} corner{'s' * (len(job.corners) > 1)} at {places}, in mm from the {corner} corner of the "
        f"bed{turned}; the file is for the whole bed of {job.size[0]:g} x {job.size[1]:g} mm."
    )


def _zero(profile: Profile) -> str:
    """Return which corner of the bed its zero is in."""
    return "upper left" if profile.bed is not None and profile.bed.origin == "upper-left" else "lower left"


def _places(job: Job, profile: Profile) -> str:
    """Return the centres of a job's holes on the bed, from the corner where the sheet lies."""
    assert job.holes is not None
    places: Floats = job.holes + job.at
    if profile.bed is not None and profile.bed.origin == "upper-left":
        places = _from_above(places, profile.bed.height_mm)
    return ", ".join(f"({x:.2f}, {y:.2f})" for x, y in places.tolist())


def _from_above(places: Floats, height: float) -> Floats:
    """Return points with y counted down from the top."""
    flipped: Floats = places * (1.0, -1.0) + (0.0, height)
    return flipped
