"""A zip archive of a job's files, with a README.txt that says what each is and in which order to load them.

Input: names and contents of files, the ``Job`` of each, the ``Profile``; output: bytes.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping, Sequence

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.model import FoldedPattern
from foldcut.jobs.duration import about, seconds_of_steps
from foldcut.jobs.instructions import instructions
from foldcut.jobs.job import Job
from foldcut.pattern.first_folds import is_wedge, sectors_left
from foldcut.profiles import Profile

from .text import number, printable

README = "README.txt"
"""The name of the file that explains the others."""

OURS = "foldcut"
"""Every README that foldcut wrote begins with this, and so may be replaced by it."""

WHAT = {
    "svg": "the pattern, at true size",
    "fold": "the pattern for origami programs and for foldcut view, draw, guide and check",
    "png": "a picture of it",
}
"""What a file without a job is, by its ending."""

FRAME_STEM = "-frame."
"""What is in the name of a file that goes round a job."""

FRAME = "goes round the job with the tool off"
"""What such a file does."""


def readme(
    pattern: FoldedPattern,
    files: Mapping[str, Job | None],
    profile: Profile | None,
    whole: Sequence[Job] = (),
    made: Sequence[str] = (),
) -> bytes:
    """Return the text that lists the files in the order to load them and says how to go on.

    ``files``: what of the jobs is in each file, by name; None if the file has the pattern itself; ``whole``: the jobs;
    ``made``: how the files were made, in words.
    """
    sheet = pattern.sheet
    jobs = [job for job in files.values() if job is not None]
    lines = [
        f"{OURS}: {printable(pattern.title) or 'crease pattern'}",
        "",
        f"Sheet: {number(sheet.width)} x {number(sheet.height)} mm",
        "",
        "Files, in the order to use them:" if jobs else "Files:",
    ]
    for place, (name, job) in enumerate(files.items(), start=1):
        what = f": {job.side} of the sheet" if job and job.side != "both" else ""
        what = f": {FRAME}" if job is None and FRAME_STEM in name else what
        what = f": {WHAT[ending]}" if job is None and (ending := name.rpartition(".")[2]) in WHAT else what
        turned = ", which lies a quarter turn to the left" if job and job.turned else ""
        lines.append(f"  {place}. {name}{what}{turned}")
    for job in whole:
        lines += _operations(job, profile)
    if profile is not None:
        lines += ["", f"{profile.title}:", *(f"  {line}" for line in instructions(profile, whole))]
    if pattern.first_folds:
        # arrowheads are a mark, which a job may have or not
        where = _places(pattern.first_folds) if jobs else "each wide pale line"
        lines += ["", f"Fold the sheet in half first, away from you, along {where}."]
        if is_wedge(pattern.first_folds):
            left = ", then ".join(map(str, sectors_left(len(pattern.first_folds))))
            lines[-1] = (
                f"Fold the sheet first, always away from you, along {where}: in half along the first, then so "
                f"that of the {len(pattern.first_folds)} sectors of the half {left} stay beside each other."
            )
    lines += [
        "",
        "With the front up, fold mountains away from you and valleys toward you, flat, then cut once along the shape's "
        "outline.",
        *(["", *made] if made else []),
    ]
    return ("\r\n".join(lines) + "\r\n").encode()


def card_readme(
    title: str, files: Sequence[str], rows: Sequence[str], following: Sequence[str], made: Sequence[str]
) -> bytes:
    """Return the text that goes with a test card: its files, its rows, what the operator does, how it was made."""
    lines = [f"{OURS}: {title}", "", "Files, in the order to use them:"]
    lines += [f"  {place}. {name}" for place, name in enumerate(files, start=1)]
    lines += ["", "Rows; the ticks beside each are its number:", *(f"  {row}" for row in rows)]
    lines += ["", *following, "", *made]
    return ("\r\n".join(lines) + "\r\n").encode()


def _operations(job: Job, profile: Profile | None) -> list[str]:
    """Return what a job does in which order, with which settings, and how long that takes."""
    seconds = None if profile is None else seconds_of_steps(job, profile)
    lines = ["", f"Operations{'' if job.side == 'both' else f' on the {job.side}'}, in this order:"]
    for place, step in enumerate(job.steps):
        setting = ""
        if step.setting is not None:
            numbers = {key: value for key, value in step.setting.model_dump().items() if value is not None}
            setting = f" ({', '.join(f'{key} {value:g}' for key, value in numbers.items())}: a starting point)"
        amount = f"{len(step.strokes)} strokes, {step.length:.0f} mm"
        lasts = "" if seconds is None else f", {about(seconds[place])}"
        lines.append(f"  - {step.operation.layer}: {amount}{lasts}{setting}")
    if seconds is not None:
        lines.append(f"  Together {about(sum(seconds))} on the machine, without changing tools.")
    return lines


def _places(first_folds: Sequence[Floats]) -> str:
    """Return where lines are on the sheet, in mm from its lower left corner as the drawing stands upright."""
    lines = (
        f"the line from ({a:.1f}, {b:.1f}) to ({c:.1f}, {d:.1f})" for (a, b), (c, d) in map(np.asarray, first_folds)
    )
    return f"{' and '.join(lines)}, in mm from the sheet's lower left corner"


def zipped(parts: Mapping[str, bytes]) -> bytes:
    """Return files as a zip archive; the same files give the same bytes."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in parts.items():
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, data)
    return out.getvalue()
