"""HPGL: a job for pen plotters and drag-knife cutters, with a pen or tool for each operation.

Input: a ``Job`` and a ``Profile`` with its unit; output: HP-GL, one group of instructions to a line. The bed's lower
left corner is at (0, 0). Source: HP 7475A *Interfacing and Programming Manual*, chapters 1 to 4: IN, SP, PU, PD, VS.
"""

from __future__ import annotations

import numpy as np

from foldcut.jobs.errors import JobError
from foldcut.jobs.job import Job
from foldcut.profiles import Profile

POINTS_A_LINE = 16
"""The most pairs of coordinates in one instruction: old plotters have small buffers."""


def export(job: Job, profile: Profile) -> bytes:
    """Return a job as an HPGL file.

    Raises JobError: the profile has no unit or bed, an operation has no pen, or a stroke leaves the bed.
    """
    if profile.hpgl is None or profile.bed is None:
        raise JobError(
            f"the profile {profile.title!r} lacks what HPGL needs: hpgl.unit_mm and bed; add them with --set"
        )
    unit = profile.hpgl.unit_mm
    reach = np.array([profile.bed.width_mm, profile.bed.height_mm])
    lines = ["IN;"]
    for step in job.steps:
        pen = step.operation.pen
        if pen is None:
            raise JobError(
                f"the profile {profile.title!r} has no pen for {step.role}: --set operations.{step.role}.pen=1"
            )
        lines.append(f"SP{pen};")
        if step.setting is not None:
            lines.append(f"VS{max(1, round(step.setting.speed_mm_s / 10))};")  # cm/s
        passes = step.setting.passes if step.setting is not None else 1
        if not step.strokes:
            continue
        points = np.concatenate(step.strokes) + np.array(job.at)
        if (points < -1e-6).any() or (points > reach + 1e-6).any():
            x, y = points[int(np.argmax(np.abs(points - reach / 2).max(axis=1)))]
            raise JobError(f"({x:.2f}, {y:.2f}) mm is beyond the machine's {reach[0]:g} x {reach[1]:g} mm")
        units = np.rint(points / unit).astype(int).tolist()
        end = 0
        for stroke in step.strokes:
            start, end = end, end + len(stroke)
            lines += _stroke(units[start:end]) * passes
    lines += ["PU;", "SP0;"]
    return ("\n".join(lines) + "\n").encode("ascii")


def _stroke(units: list[list[int]]) -> list[str]:
    first, *rest = units
    parts = (rest[n : n + POINTS_A_LINE] for n in range(0, len(rest), POINTS_A_LINE))
    return [f"PU{first[0]},{first[1]};", *("PD" + ",".join(f"{x},{y}" for x, y in part) + ";" for part in parts)]
