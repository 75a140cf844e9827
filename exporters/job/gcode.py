"""G-code: a job for machines that run GRBL, with a laser, or with a pen on a Z axis or a servo.

Input: a ``Job`` and a ``Profile``; output: G-code in mm, absolute, one block to a line. A laser runs in dynamic mode
(M4): its power follows the speed; power is relative to ``$30``. It is off during G0, and every G0 says S0 for
controllers that are not in laser mode (``$32=0``). Source: GRBL 1.1, *Laser Mode*.
"""

from __future__ import annotations

from collections.abc import Iterator

from foldcut.jobs.errors import LackingError
from foldcut.jobs.job import Job, JobStep
from foldcut.profiles import Gcode, Profile

from ..text import number
from .no_power import no_power

SLOW_MM_S = 50.0
"""How fast a frame is traced if the profile does not say how fast the machine moves."""


def export(job: Job, profile: Profile) -> bytes:
    """Return a job as a G-code file.

    Raises JobError: the profile does not say how the tool is switched, or a laser's setting is missing.
    """
    code = _code(profile)
    lines = [_comment(f"foldcut: {job.title}"), "G21", "G90"]
    laser = code.tool == "laser"
    lines += _laser(job, profile, code) if laser else _pen(job, code)
    lines += ["G0 X0 Y0 S0" if laser else "G0 X0 Y0", "M2"]
    return ("\n".join(lines) + "\n").encode("ascii")


def export_frame(job: Job, profile: Profile) -> bytes:
    """Return the way round the box of a job, with the laser off or the pen up, as a G-code file."""
    code = _code(profile)
    laser = code.tool == "laser"
    speed = SLOW_MM_S if profile.motion is None else profile.motion.travel_mm_s
    lines = [
        _comment(f"foldcut: the frame of {job.title}"),
        "G21",
        "G90",
        *(["M5"] if laser else _up_and_down(code)[0]),
    ]
    (left, low), (right, high) = (corner.tolist() for corner in job.box)
    corners = [(left, low), (right, low), (right, high), (left, high), (left, low)]
    points = [f"X{number(x)} Y{number(y)}" for x, y in corners]
    off = " S0" if laser else ""
    lines += [f"G0 {points[0]}{off}", *(f"G1 {point}{off} F{number(60 * speed)}" for point in points[1:])]
    lines += [f"G0 X0 Y0{off}", *(["M5"] if code.tool == "servo" else []), "M2"]
    return ("\n".join(lines) + "\n").encode("ascii")


def _code(profile: Profile) -> Gcode:
    """Return how the tool of a machine is switched; raise JobError if its profile does not say."""
    if profile.gcode is None:
        tool = "laser" if profile.kind == "laser" else "z"
        raise LackingError(f"the profile {profile.title!r} lacks what G-code needs", [f"gcode.tool={tool}"])
    return profile.gcode


def _laser(job: Job, profile: Profile, code: Gcode) -> Iterator[str]:
    yield "M4 S0"
    for step in job.steps:
        setting = step.setting
        if setting is None or setting.power_percent is None:
            raise no_power(step, profile)
        power = round(setting.power_percent / 100 * code.most_power)
        yield _comment(step.operation.layer)
        for _ in range(setting.passes):
            for first, rest in _strokes(job, step):
                yield f"G0 {first} S0"
                yield f"G1 {rest[0]} S{power} F{number(60 * setting.speed_mm_s)}"
                yield from (f"G1 {point}" for point in rest[1:])
    yield "M5"


def _pen(job: Job, code: Gcode) -> Iterator[str]:
    up, down = _up_and_down(code)
    yield from up
    pen: int | None = None
    for step in job.steps:
        if step.operation.pen != pen:
            pen = step.operation.pen
            yield from (_comment(f"pen {pen}: {step.operation.layer}"), "M0")
        else:
            yield _comment(f"pen {pen}: {step.operation.layer}")
        speed = code.draw_mm_s if step.setting is None else step.setting.speed_mm_s
        for _ in range(1 if step.setting is None else step.setting.passes):
            for first, rest in _strokes(job, step):
                yield f"G0 {first}"
                yield from down
                yield from (f"G1 {point} F{number(60 * speed)}" for point in rest)
                yield from up
    if code.tool == "servo":
        yield "M5"


def _up_and_down(code: Gcode) -> tuple[list[str], list[str]]:
    """Return what lifts a pen, and what puts it down."""
    if code.tool == "servo":
        dwell = [f"G4 P{number(code.dwell_s)}"] if code.dwell_s else []
        return [f"M3 S{code.servo_up}", *dwell], [f"M3 S{code.servo_down}", *dwell]
    return [f"G0 Z{number(code.pen_up)}"], [f"G1 Z{number(code.pen_down)} F{number(60 * code.plunge_mm_s)}"]


def _strokes(job: Job, step: JobStep) -> Iterator[tuple[str, list[str]]]:
    """Yield the first point of each stroke, and its other points, on the bed."""
    right, up = job.at
    for stroke in step.strokes:
        first, *rest = (f"X{number(x + right)} Y{number(y + up)}" for x, y in stroke.tolist())
        yield first, rest


def _comment(text: str) -> str:
    """Return a comment with this text; other letters than ASCII, which GRBL cannot read, become "?"."""
    return "; " + "".join(letter if letter.isascii() and letter.isprintable() else "?" for letter in text)
