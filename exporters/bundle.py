"""Several files as one: a job's files and a README.txt that says what to load first, for a folder or a zip archive.

Input: names and contents of files, the ``Job`` list, the ``Profile``; output: bytes.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping, Sequence

from foldcut.job import Job
from foldcut.model import FoldedPattern
from foldcut.profiles import Profile

from .text import number, printable

README = "README.txt"
OURS = "foldcut"
"""What our README begins with."""


def readme(pattern: FoldedPattern, names: Sequence[str], jobs: Sequence[Job], profile: Profile | None) -> bytes:
    """Return the text that says what each file is, in the order to load them, and how to go on."""
    sheet = pattern.sheet
    lines = [
        f"{OURS}: {printable(pattern.title) or 'crease pattern'}",
        "",
        f"Sheet: {number(sheet.width)} x {number(sheet.height)} mm",
        "",
    ]
    lines.append("Files, in the order to use them:")
    sides = {job.side: job for job in jobs}
    for place, name in enumerate(names, start=1):
        what = ""
        for side, job in sides.items():
            if (side == "both" and len(names) == 1) or f"-{side}." in name:
                what = f": {side} of the sheet" if side != "both" else ""
                what += ", which lies a quarter turn to the left" if job.turned else ""
        lines.append(f"  {place}. {name}{what}")
    for job in jobs:
        lines += ["", f"Operations{'' if job.side == 'both' else f' on the {job.side}'}, in this order:"]
        for step in job.steps:
            setting = ""
            if step.setting is not None:
                numbers = {key: value for key, value in step.setting.model_dump().items() if value is not None}
                setting = f" ({', '.join(f'{key} {value:g}' for key, value in numbers.items())}: a starting point)"
            lines.append(f"  - {step.operation.layer}: {len(step.strokes)} strokes, {step.length:.0f} mm{setting}")
    if {"front", "back"} <= sides.keys():
        lines += [
            "",
            "Do the front first. Turn the sheet over like a page, left to right, line it up, and do the back.",
        ]
    if profile is not None and profile.instructions:
        lines += ["", f"{profile.title}:", *(f"  {line}" for line in profile.instructions)]
    if pattern.first_folds:
        where = "line between arrowheads" if jobs else "wide pale line"
        lines += ["", f"Fold the sheet in half first, away from you, along each {where}."]
    lines += ["", "Fold mountains away from you and valleys toward you, flat, then cut once along the shape's outline."]
    return ("\r\n".join(lines) + "\r\n").encode()


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
