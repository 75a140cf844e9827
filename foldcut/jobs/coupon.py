"""The test card of a machine: one sheet with scores and perforations in many settings, to fold and compare.

``Profile`` -> ``Job``. Each row is a strip, free except at its left end, with a fold line across it, so that it can be
folded by itself. First come scores of increasing power, then perforations with longer and longer dashes. The number of
ticks at its left end is the row's number. Each row is a step of its own, with its own layer, colour and setting.
"""

from __future__ import annotations

import colorsys
from dataclasses import replace

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.model import Sheet
from foldcut.jobs.bed import Lay
from foldcut.jobs.dashes import perforation
from foldcut.jobs.job import Job, JobStep, check_job
from foldcut.jobs.pen_path import travel
from foldcut.profiles import Dash, Operation, Profile, Setting

WIDTH_MM = 60.0
"""The width of the card."""

ROW_MM = 14.0
"""The height of a row."""

EDGE_MM = 8.0
"""The margin above and below the rows; strips end this far from the right edge."""

TICK_MM = 2.0
"""The length of a tick."""

POWERS = (0.5, 0.7, 0.85, 1.0, 1.2, 1.5)
"""The power of each scored row, as a multiple of the profile's power for scores."""

DASHES = ((0.5, 1.5), (0.5, 1.0), (1.0, 1.0), (1.0, 0.5), (2.0, 1.0), (2.0, 0.5))
"""Dash and gap of each perforated row, as multiples of the profile's for mountains."""

Row = tuple[str, Setting | None, Dash | None]
"""What a row is called, its setting, and its dashes; None: a score."""


def make_coupon(profile: Profile, material: str | None = None) -> tuple[Job, list[str]]:
    """Return the job of the test card for a material, by default the profile's first, and what each row is.

    Raises JobError: the card does not fit the bed, or the profile has no such material or is only for drawings.
    """
    height = 2 * EDGE_MM + ROW_MM * (len(POWERS) + len(DASHES))
    sheet = Sheet(WIDTH_MM, height, "test card")
    check_job(sheet, profile, material=material)
    name = material or next(iter(profile.materials))
    stuff = profile.materials[name]
    rows = [_score(stuff.score, part) for part in POWERS] + [
        _perforation(stuff.perforate, stuff.mountain, p) for p in DASHES
    ]
    steps, texts = [], []
    marks: list[Floats] = []
    for number, (text, setting, dash) in enumerate(rows, 1):
        y = height - EDGE_MM - (number - 0.5) * ROW_MM
        line = np.array([[WIDTH_MM / 2, y - ROW_MM / 2], [WIDTH_MM / 2, y + ROW_MM / 2]])
        strokes = [line] if dash is None else perforation(line, dash)
        hue = (number - 1) / len(rows)
        red, green, blue = (round(255 * part) for part in colorsys.hsv_to_rgb(hue, 1.0, 0.8))
        pen = profile.operations["mountain"].pen
        layer = f"{number:02d} {text}"
        steps.append(
            JobStep(
                "mountain",
                Operation(layer=layer, colour=f"#{red:02x}{green:02x}{blue:02x}", pen=pen),
                setting,
                tuple(strokes),
            )
        )
        texts.append(layer)
        left = EDGE_MM / 2
        marks += [
            np.array([[left, y - ROW_MM / 3 + n * 0.7], [left + TICK_MM, y - ROW_MM / 3 + n * 0.7]])
            for n in range(number)
        ]
    steps.insert(0, JobStep("mark", profile.operations["mark"], stuff.mark, tuple(marks)))
    cuts = [
        np.array([[1.5 * EDGE_MM, y], [WIDTH_MM - EDGE_MM, y]])
        for y in height - EDGE_MM - ROW_MM * np.arange(len(rows) + 1)
    ]
    slit = np.array([[WIDTH_MM - EDGE_MM, EDGE_MM], [WIDTH_MM - EDGE_MM, height - EDGE_MM]])
    outline = np.concatenate([sheet.corners, sheet.corners[:1]])
    steps.append(JobStep("cut", profile.operations["cut"], stuff.cut, (*cuts, slit, outline)))
    lay = Lay.on(sheet, profile.bed)
    laid = tuple(replace(step, strokes=tuple(map(lay.place, step.strokes))) for step in steps)
    way = travel([step.strokes for step in laid], np.zeros(2))
    return Job(f"Test card: {name}", lay.size, lay.at, lay.turned, "both", laid, way, way), texts


def _score(setting: Setting | None, part: float) -> Row:
    if setting is None:
        return f"score, {part:g} of the usual pressure", None, None
    power = min(100.0, round(part * setting.power_percent, 1))
    text = f"score, {power:g} % at {setting.speed_mm_s:g} mm a second"
    return text, setting.model_copy(update={"power_percent": power}), None


def _perforation(setting: Setting | None, usual: Dash, parts: tuple[float, float]) -> Row:
    dash, gap = round(parts[0] * usual.dash_mm, 2), round(parts[1] * usual.gap_mm, 2)
    cut = Dash(dash_mm=dash, gap_mm=gap, clearance_mm=usual.clearance_mm)
    return f"perforation, {dash:g} mm cut, {gap:g} mm gap", setting, cut
