"""The last door: every job and every pattern passes here just before an exporter makes bytes of it.

Whatever made it, a method, a FOLD file or a program: each coordinate is finite and on the sheet, and those of a job are
on the bed of its machine, with marks and kerf as they are. Nothing that fails this reaches a file.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.errors import BadInputError
from foldcut.core.model import FoldedPattern
from foldcut.jobs.bed import SLACK_MM
from foldcut.jobs.errors import JobError, TooLargeError
from foldcut.jobs.job import Job, JobStep
from foldcut.profiles import Profile

__all__ = ["brought_on_bed", "check_pattern"]

DRAWN_BEYOND = 0.1
"""The drawing, which is only shown beside the outline, may reach this part of the diagonal beyond the sheet."""


def brought_on_bed(job: Job, profile: Profile) -> Job:
    """Return the job as it may be exported: on the bed, moved by half of the kerf if the outline would leave the bed.

    A printer has no bed but pages, which its format divides the sheet into. Raises JobError: a number is not finite, a
    stroke has fewer than two points, or one leaves the sheet by more than half of the kerf, or the bed.
    """
    beyond = profile.kerf_mm / 2 + SLACK_MM
    if not np.isfinite([*job.size, *job.at]).all():
        raise JobError(f"the job's sheet is {job.size} mm large and lies at {job.at}; give finite numbers")
    for step in job.steps:
        _check_step(step, job.size, beyond)
    if profile.bed is None or profile.page is not None:
        return job
    corners = [points.reshape(-1, 2) for step in job.steps for points in _box(step.strokes)]
    points = np.concatenate([*corners, [(0.0, 0.0), job.size]]) + np.array(job.at)
    reach = np.array([profile.bed.width_mm, profile.bed.height_mm])
    shift = np.maximum(-points.min(axis=0), 0.0)
    shift -= np.maximum(points.max(axis=0) + shift - reach, 0.0)
    shift[np.abs(shift) <= SLACK_MM] = 0.0  # rounding does not move a job
    too_wide = (np.ptp(points, axis=0) > reach + SLACK_MM).any()
    if too_wide or (np.abs(shift) > beyond).any():
        x, y = points[int(np.maximum(-points, points - reach).max(axis=1).argmax())]
        kerf = f", with a kerf of {profile.kerf_mm:g} mm" if profile.kerf_mm else ""
        raise TooLargeError(
            f"the job reaches ({x:.6g}, {y:.6g}) mm{kerf}, beyond the machine's {reach[0]:g} x {reach[1]:g} mm",
            "use a smaller --sheet",
        )
    right, up = shift.tolist()
    return replace(job, at=(job.at[0] + right, job.at[1] + up)) if right or up else job


def check_pattern(pattern: FoldedPattern) -> None:
    """Raise BadInputError unless each coordinate of a pattern is finite and on its sheet."""
    sheet = pattern.sheet
    size = np.array([sheet.width, sheet.height])
    slack = 1e-6 * sheet.diagonal
    parts = {
        "a vertex": ([pattern.creases.vertices_coords], slack),
        "the shape": ((*pattern.shape.loops, *pattern.shape.lines), slack),
        "a first fold": (pattern.first_folds, slack),
        "the drawing": (pattern.drawn, DRAWN_BEYOND * sheet.diagonal),
    }
    for name, (arrays, beyond) in parts.items():
        for points in arrays:
            place = _first_beyond(points, size, beyond)
            if place is not None:
                x, y = place
                raise BadInputError(
                    f"{name} of the pattern is at ({x:.6g}, {y:.6g}) mm, off the sheet of {sheet}; foldcut check "
                    "says what else is wrong with a FOLD file"
                )
    if not np.isfinite(pattern.folded.vertices_coords).all():
        raise BadInputError("a vertex of the folded pattern is not at a finite place; fold the drawing again")


def _check_step(step: JobStep, size: tuple[float, float], beyond: float) -> None:
    """Raise JobError unless the numbers and strokes of a step can be carried out on a sheet of this size."""
    numbers = [] if step.setting is None else [one for one in step.setting.model_dump().values() if one is not None]
    if not np.isfinite(np.array(numbers, dtype=np.float64)).all():
        raise JobError(f"the setting of {step.role} is {step.setting}; give finite numbers with --set")
    for stroke in step.strokes:
        if len(stroke) < 2:
            raise JobError(f"a stroke of {step.role} has {len(stroke)} points; it needs two")
        place = _first_beyond(stroke, np.array(size), beyond)
        if place is not None:
            x, y = place
            remedy = "leave marks out with --marks none, or use a larger --sheet"
            raise JobError(
                f"{step.role} reaches ({x:.6g}, {y:.6g}) mm, beyond the sheet of {size[0]:g} x {size[1]:g} mm; {remedy}"
            )


def _first_beyond(points: Floats, size: Floats, beyond: float) -> tuple[float, float] | None:
    """Return the first point that is not finite, or off a sheet of this size by more than ``beyond`` mm, if any is."""
    inside = ((points >= -beyond) & (points <= size + beyond)).all(axis=1)  # NaN is neither
    if inside.all():
        return None
    x, y = points[int(inside.argmin())].tolist()
    return x, y


def _box(strokes: Sequence[Floats]) -> list[Floats]:
    """Return the corners of the box around strokes; nothing where there are none."""
    if not strokes:
        return []
    points = np.concatenate(strokes)
    return [points.min(axis=0), points.max(axis=0)]
