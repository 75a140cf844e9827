"""How a sheet lies on the bed of a machine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.model import Sheet
from foldcut.jobs.errors import JobError
from foldcut.profiles import Bed

Side = Literal["both", "front", "back"]


@dataclass(frozen=True)
class Lay:
    """How a sheet lies on the bed: see ``Job``."""

    sheet: Sheet
    size: tuple[float, float]
    at: tuple[float, float]
    turned: bool

    @classmethod
    def on(cls, sheet: Sheet, bed: Bed | None) -> Lay:
        """Lay a sheet in the origin's corner, upright if it fits so, else turned a quarter."""
        width, height = sheet.width, sheet.height
        if bed is None:
            return cls(sheet, (width, height), (0.0, 0.0), False)
        slack = 1e-6
        for turned, (w, h) in ((False, (width, height)), (True, (height, width))):
            if w <= bed.width_mm + slack and h <= bed.height_mm + slack:
                at = (0.0, bed.height_mm - h if bed.origin == "upper-left" else 0.0)
                return cls(sheet, (w, h), at, turned)
        small, large = sorted((bed.width_mm, bed.height_mm))
        raise JobError(
            f"the sheet of {width:g} x {height:g} mm does not fit the machine's {bed.width_mm:g} x "
            f"{bed.height_mm:g} mm; use --sheet {small:g}x{large:g}mm or smaller, or --tile on a printer"
        )

    def place(self, points: Floats, side: Side = "both") -> Floats:
        """Move points from the pattern's sheet to the sheet as it lies."""
        x, y = points[:, 0], points[:, 1]
        if side == "back":
            x = self.sheet.width - x
        return np.column_stack([self.sheet.height - y, x] if self.turned else [x, y])
