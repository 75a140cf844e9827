"""The test card of a machine: one sheet with scores and perforations in many settings, to fold and compare.

``Profile`` -> ``Job``. Each row is a strip that hangs on the card by its left end and has a fold line across it, so
that it can be folded by itself. The first rows are scores of more and more power, then come perforations with longer
and longer dashes. A row's number is told by the ticks beside it. Each row is an operation of its own, with its own
layer, colour and setting.
"""

from __future__ import annotations

import colorsys
from dataclasses import replace

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.model import Sheet
from foldcut.jobs.bed import Lay
from foldcut.jobs.dashes import perforation
from foldcut.jobs.job import Job, Step, check_job
from foldcut.jobs.pen_path import travel
from foldcut.profiles import Dash, Operation, Profile, Setting

WIDTH_MM, ROW_MM, EDGE_MM, TICK_MM = 60.0, 14.0, 8.0, 2.0
POWERS = (0.5, 0.7, 0.85, 1.0, 1.2, 1.5)
"""Parts of the profile's power for scores."""
DASHES = ((0.5, 1.5), (0.5, 1.0), (1.0, 1.0), (1.0, 0.5), (2.0, 1.0), (2.0, 0.5))
"""Dash and gap, as parts of the profile's for mountains."""

Row = tuple[str, Setting | None, Dash | None]


def make_coupon(profile: Profile, material: str | None = None) -> tuple[Job, list[str]]:
    """Return the job of the test card for a material, the profile's first unless given, and what each row is.

    Raises JobError: the card does not fit the bed, or the profile has no such material or is for drawings only.
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
            Step(
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
    steps.insert(0, Step("mark", profile.operations["mark"], stuff.mark, tuple(marks)))
    cuts = [
        np.array([[1.5 * EDGE_MM, y], [WIDTH_MM - EDGE_MM, y]])
        for y in height - EDGE_MM - ROW_MM * np.arange(len(rows) + 1)
    ]
    slit = np.array([[WIDTH_MM - EDGE_MM, EDGE_MM], [WIDTH_MM - EDGE_MM, height - EDGE_MM]])
    outline = np.concatenate([sheet.corners, sheet.corners[:1]])
    steps.append(Step("cut", profile.operations["cut"], stuff.cut, (*cuts, slit, outline)))
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
