"""How a sheet lies on the bed of a machine: upright or turned, with its front or its back up, and where.

``Sheet`` and ``Profile`` -> ``Lay``, which moves points from the pattern's coordinates to those of the sheet as it
lies. Both are in mm with y up. (0, 0) is the sheet's lower left corner before, and after it as well unless the job has
a border: room around the sheet that the tool needs to cut it out.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.model import Sheet
from foldcut.jobs.errors import TooLargeError
from foldcut.profiles import Bed, Paper, Profile

Side = Literal["both", "front", "back"]
"""The side of the sheet that a job works on; "both": everything is done from the front, in one job."""

TurnedOver = Literal["left to right", "top to bottom"]
"""How a sheet that lies on the bed is turned over: like the page of a book, or like that of a calendar on the wall."""

Box = tuple[float, float, float, float]
"""Left, lower, right and upper edge, in mm."""

SLACK_MM = 1e-6
"""A sheet may be this much larger than the bed, so that rounding does not turn one away that fits exactly."""

SAME_PAPER_MM = 0.5
"""A sheet is a paper, and not cut out of it, if their sides differ by no more than this."""


@dataclass(frozen=True)
class Lay:
    """How a sheet lies on a bed.

    ``size``: width and height of the sheet as it lies, with its border, in mm; ``at``: the lower left corner of that on
    the bed, in mm from the bed's lower left corner; ``turned``: whether it lies a quarter turn counter-clockwise.
    ``border``: how far beyond the sheet the tool goes, on every side. ``reach``: the part of ``size`` that the machine
    reaches; None: all of it. ``paper``: the plotter's paper that it is or is drawn on; ``cut_out``: whether the paper
    is larger, so that the sheet is cut out of it.
    """

    sheet: Sheet
    size: tuple[float, float]
    at: tuple[float, float]
    turned: bool
    border: float = 0.0
    reach: Box | None = None
    paper: str | None = None
    cut_out: bool = False

    @classmethod
    def on(cls, sheet: Sheet, bed: Bed | None, border: float = 0.0) -> Lay:
        """Lay a sheet in the corner of the bed's origin: upright if it fits that way, otherwise turned by a quarter.

        Without a bed it lies upright. Raises JobError: the sheet does not fit either way.
        """
        width, height = sheet.width + 2 * border, sheet.height + 2 * border
        if bed is None:
            return cls(sheet, (width, height), (0.0, 0.0), False, border)
        for turned, (w, h) in ((False, (width, height)), (True, (height, width))):
            if w <= bed.width_mm + SLACK_MM and h <= bed.height_mm + SLACK_MM:
                at = (0.0, bed.height_mm - h if bed.origin == "upper-left" else 0.0)
                return cls(sheet, (w, h), at, turned, border)
        small, large = sorted((bed.width_mm - 2 * border, bed.height_mm - 2 * border))
        around = f" with the {border:g} mm around it that the tool needs" if border else ""
        raise TooLargeError(
            f"the sheet of {sheet.width:g} x {sheet.height:g} mm{around} does not fit the machine's {bed.width_mm:g} x "
            f"{bed.height_mm:g} mm",
            f"use --sheet {small:g}x{large:g}mm or smaller, or --tile on a printer",
        )

    @classmethod
    def for_machine(cls, sheet: Sheet, profile: Profile, *, tile: bool = False) -> Lay:
        """Lay a sheet on a machine's bed, on the paper that its plotter takes, or on a printer's page.

        ``tile``: a printer may use several pages. Raises JobError: the sheet does not fit.
        """
        if tile:
            return cls.on(sheet, None)
        if profile.papers:
            return _on_paper(sheet, profile)
        lay = cls.on(sheet, profile.bed, tool_border(profile))
        if profile.page is None or profile.bed is None:
            return lay
        return replace(lay, reach=_printed(lay.size, profile.bed, profile.page.margin_mm))

    def place(self, points: Floats, side: Side = "both") -> Floats:
        """Move points, ``(n, 2)``, from the pattern to the sheet as it lies; the back is mirrored on the pattern."""
        x, y = points[:, 0], points[:, 1]
        if side == "back":
            x = self.sheet.width - x
        lying = np.column_stack([self.sheet.height - y, x] if self.turned else [x, y])
        return lying + self.border if self.border else lying

    @property
    def turned_over(self) -> TurnedOver:
        """How the sheet on the bed is turned over so that its back lies as ``place`` puts it."""
        ends = np.array([[0.0, 0.0], [self.sheet.width, self.sheet.height]])
        front, back = self.place(ends), self.place(ends, "back")
        return "left to right" if front[0, 0] != back[0, 0] else "top to bottom"

    @property
    def room(self) -> Box:
        """The part of the pattern's sheet that the machine reaches on the front and on the back."""
        left, low, right, high = 0.0, 0.0, self.sheet.width, self.sheet.height
        if self.reach is None:
            return left, low, right, high
        x, y, u, v = (edge - self.border for edge in self.reach)
        if self.turned:  # as ``place`` does: lying (x, y) = (height - y, x)
            x, y, u, v = y, high - u, v, high - x
        left = max(left, x, right - u)
        return left, max(low, y), right - left, min(high, v)


def tool_border(profile: Profile) -> float:
    """Return how far beyond the sheet a tool goes to cut it out, in mm: half the kerf, and a blade's offset."""
    if not profile.cut_outline:
        return 0.0
    blade = profile.blade.offset_mm if profile.blade is not None and profile.blade.compensate else 0.0
    return profile.kerf_mm / 2 + blade


def unreached(sheet: Sheet, profile: Profile) -> float:
    """Return how wide the margin is, in mm, that a machine cannot reach at one of the edges of a sheet."""
    left, low, right, high = Lay.for_machine(sheet, profile).room
    return max(left, low, sheet.width - right, sheet.height - high)


def _printed(size: tuple[float, float], bed: Bed, margin: float) -> Box:
    """Return what a printer can print of a sheet in the middle of its page."""
    x, y = (bed.width_mm - size[0]) / 2 - margin, (bed.height_mm - size[1]) / 2 - margin
    return -x, -y, size[0] + x, size[1] + y


def _on_paper(sheet: Sheet, profile: Profile) -> Lay:
    """Lay a sheet on a plotter's paper of its size, or else on the first one on which the pen reaches all of it."""
    unit = profile.hpgl.unit_mm if profile.hpgl is not None else 1.0
    both = ((False, (sheet.width, sheet.height)), (True, (sheet.height, sheet.width)))
    for name, paper in profile.papers.items():
        for turned, (w, h) in both:
            if max(abs(w - paper.width_mm), abs(h - paper.height_mm)) <= SAME_PAPER_MM:
                x, y = paper.origin_x_mm, paper.origin_y_mm
                reach = (x, y, x + paper.x_units * unit, y + paper.y_units * unit)
                return Lay(sheet, (w, h), (-x, -y), turned, reach=reach, paper=name)
    for name, paper in profile.papers.items():
        for turned, (w, h) in both:
            if w <= paper.x_units * unit + SLACK_MM and h <= paper.y_units * unit + SLACK_MM:
                return Lay(sheet, (w, h), (0.0, 0.0), turned, paper=name, cut_out=True)
    largest, paper = max(profile.papers.items(), key=lambda item: item[1].x_units * item[1].y_units)
    raise TooLargeError(
        f"the sheet of {sheet.width:g} x {sheet.height:g} mm is larger than what {profile.title} reaches on its "
        "largest paper",
        f"use --sheet {largest}, or {_reach(paper, unit)} or smaller",
    )


def _reach(paper: Paper, unit: float) -> str:
    """Return the sheet that is just what a pen reaches on a paper, as --sheet takes it."""
    return f"{int(paper.y_units * unit)}x{int(paper.x_units * unit)}mm"
