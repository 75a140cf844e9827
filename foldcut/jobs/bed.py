"""How a sheet lies on the bed of a machine: upright or turned, with its front or its back up, and where.

``Sheet`` and ``Bed`` -> ``Lay``, which moves points from the pattern's coordinates to those of the sheet as it lies.
Both are in mm with y up; (0, 0) is the sheet's lower left corner before and after.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.model import Sheet
from foldcut.jobs.errors import JobError
from foldcut.profiles import Bed

Side = Literal["both", "front", "back"]
"""The side of the sheet that a job works on; "both": everything is done from the front, in one job."""

SLACK_MM = 1e-6
"""A sheet may be this much larger than the bed, so that rounding does not turn one away that fits exactly."""


@dataclass(frozen=True)
class Lay:
    """How a sheet lies on a bed.

    ``size``: width and height of the sheet as it lies, in mm; ``at``: its lower left corner on the bed, in mm from the
    bed's lower left corner; ``turned``: whether it lies a quarter turn counter-clockwise.
    """

    sheet: Sheet
    size: tuple[float, float]
    at: tuple[float, float]
    turned: bool

    @classmethod
    def on(cls, sheet: Sheet, bed: Bed | None) -> Lay:
        """Lay a sheet in the corner of the bed's origin: upright if it fits that way, otherwise turned by a quarter.

        Without a bed it lies upright. Raises JobError: the sheet does not fit either way.
        """
        width, height = sheet.width, sheet.height
        if bed is None:
            return cls(sheet, (width, height), (0.0, 0.0), False)
        for turned, (w, h) in ((False, (width, height)), (True, (height, width))):
            if w <= bed.width_mm + SLACK_MM and h <= bed.height_mm + SLACK_MM:
                at = (0.0, bed.height_mm - h if bed.origin == "upper-left" else 0.0)
                return cls(sheet, (w, h), at, turned)
        small, large = sorted((bed.width_mm, bed.height_mm))
        raise JobError(
            f"the sheet of {width:g} x {height:g} mm does not fit the machine's {bed.width_mm:g} x "
            f"{bed.height_mm:g} mm; use --sheet {small:g}x{large:g}mm or smaller, or --tile on a printer"
        )

    def place(self, points: Floats, side: Side = "both") -> Floats:
        """Move points, ``(n, 2)``, from the pattern to the sheet as it lies; the back is turned over left to right."""
        x, y = points[:, 0], points[:, 1]
        if side == "back":
            x = self.sheet.width - x
        return np.column_stack([self.sheet.height - y, x] if self.turned else [x, y])
