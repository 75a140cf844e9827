"""HPGL: a job for pen plotters and drag-knife cutters, with a pen or tool for each operation.

Input: a ``Job`` and a ``Profile`` with its unit; output: HP-GL, one group of instructions to a line. (0, 0) is the
bed's lower left corner, or that of the part of its paper that a plotter reaches. Sources: HP 7475A *Interfacing and
Programming Manual*, chapters 1 to 4: IN, SP, PU, PD, VS; HP 7550A's: PS, FS, NR.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.jobs.blade import holder_path
from foldcut.jobs.errors import LackingError, TooLargeError
from foldcut.jobs.job import Job, JobStep
from foldcut.profiles import Hpgl, Paper, Profile, Setting

POINTS_A_LINE = 16
"""The most pairs of coordinates in one instruction: old plotters have small buffers."""


def export(job: Job, profile: Profile) -> bytes:
    """Return a job as an HPGL file.

    Raises JobError: the profile has no unit, bed or papers, an operation has no pen, or a stroke leaves the bed.
    """
    hpgl = _hpgl(profile)
    paper = None if job.paper is None else profile.papers[job.paper]
    lines = _beginning(paper)
    pen: int | None = None
    for step in job.steps:
        if pen is not None and step.operation.pen != pen and hpgl.pause:
            lines += ["PU;", hpgl.pause]
        pen = step.operation.pen
        if pen is None:
            raise LackingError(f"the profile {profile.title!r} has no pen for {step.role}", _pens(profile))
        lines += [f"SP{pen};", *_setting(step.setting), *_strokes(step, job, profile, paper)]
    return ("\n".join([*lines, *_end(paper)]) + "\n").encode("ascii")


def export_frame(job: Job, profile: Profile) -> bytes:
    """Return the way round the box of a job with the pen up, as an HPGL file."""
    hpgl = _hpgl(profile)
    paper = None if job.paper is None else profile.papers[job.paper]
    (left, low), (right, high) = job.box
    corners = np.array([(left, low), (right, low), (right, high), (left, high), (left, low)])
    units = np.rint(corners / hpgl.unit_mm).astype(int)
    _check(units, profile, paper)
    lines = [*_beginning(paper), *(f"PU{x},{y};" for x, y in units.tolist()), *_end(paper)]
    return ("\n".join(lines) + "\n").encode("ascii")


def _hpgl(profile: Profile) -> Hpgl:
    """Return what a profile says of HPGL; raise JobError if it lacks anything."""
    if profile.hpgl is None or (profile.bed is None and not profile.papers):
        lacking = [] if profile.hpgl is not None else ["hpgl.unit_mm=0.025"]
        lacking += [] if profile.bed or profile.papers else ["bed.width_mm=297", "bed.height_mm=210"]
        raise LackingError(f"the profile {profile.title!r} lacks what HPGL needs", [*lacking, *_pens(profile)])
    return profile.hpgl


def _pens(profile: Profile) -> list[str]:
    """Return pens for the operations that have none."""
    return [f"operations.{role}.pen=1" for role, operation in profile.operations.items() if operation.pen is None]


def _beginning(paper: Paper | None) -> list[str]:
    return ["IN;"] + ([f"PS{paper.set_ps};"] if paper is not None and paper.set_ps is not None else [])


def _end(paper: Paper | None) -> list[str]:
    """Return what lifts the pen, takes it out of the way, and puts it away."""
    return ["PU;" if paper is None else f"PU{paper.final_x_units},{paper.final_y_units};", "SP0;"]


def _setting(setting: Setting | None) -> Iterator[str]:
    if setting is None:
        return
    if setting.force_g is not None:
        yield f"FS{max(1, round(setting.force_g))};"
    yield f"VS{max(1, round(setting.speed_mm_s / 10))};"  # cm/s


def _strokes(step: JobStep, job: Job, profile: Profile, paper: Paper | None) -> Iterator[str]:
    """Yield the instructions for the strokes of a step; all of them once before any is repeated."""
    if not step.strokes:
        return
    assert profile.hpgl is not None
    blade = profile.blade if profile.blade is not None and profile.blade.compensate else None
    strokes = [stroke if blade is None else holder_path(stroke, blade) for stroke in step.strokes]
    units = np.rint((np.concatenate(strokes) + np.array(job.at)) / profile.hpgl.unit_mm).astype(int)
    _check(units, profile, paper)
    ends = np.cumsum([len(stroke) for stroke in strokes])
    for _ in range(1 if step.setting is None else step.setting.passes):
        for some in np.split(units, ends[:-1]):
            yield from _stroke(some.tolist())


def _check(units: Floats, profile: Profile, paper: Paper | None) -> None:
    """Raise JobError if a point is beyond what the machine reaches."""
    assert profile.hpgl is not None
    unit = profile.hpgl.unit_mm
    if paper is not None:
        reach = np.array([paper.x_units, paper.y_units])
    else:
        assert profile.bed is not None
        reach = np.rint(np.array([profile.bed.width_mm, profile.bed.height_mm]) / unit).astype(int)
    beyond = np.flatnonzero(((units < 0) | (units > reach)).any(axis=1))
    if len(beyond):
        x, y = units[beyond[0]] * unit
        width, height = reach * unit
        raise TooLargeError(
            f"({x:.2f}, {y:.2f}) mm is beyond the machine's {width:g} x {height:g} mm", "use a smaller --sheet"
        )


def _stroke(units: list[list[int]]) -> list[str]:
    first, *rest = units
    parts = (rest[n : n + POINTS_A_LINE] for n in range(0, len(rest), POINTS_A_LINE))
    return [f"PU{first[0]},{first[1]};", *("PD" + ",".join(f"{x},{y}" for x, y in part) + ";" for part in parts)]
