"""The named tolerances of the construction, derived once from the scale of the sheet and passed to the stages."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.model import Sheet


@dataclass(frozen=True)
class Tolerance:
    """What counts as a tie.

    ``tie`` is relative to the smaller of two disks; ``rounding`` is the absolute error, in mm, that float64 leaves in
    coordinates as large as the sheet.
    """

    tie: float
    rounding: float

    @classmethod
    def for_sheet(cls, sheet: Sheet) -> Tolerance:
        """Return the tolerances for a sheet: ties at 1e-8, rounding at some 100 units in the last place."""
        return cls(tie=1e-8, rounding=3e-14 * sheet.diagonal)

    def touching(self, a: Floats, b: Floats) -> Floats:
        """How far apart, in mm, two disks of radii ``a`` and ``b`` may be and still count as touching."""
        return self.tie * np.minimum(a, b) + self.rounding
