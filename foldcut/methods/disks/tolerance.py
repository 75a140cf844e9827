"""The tolerances of the disk packing, derived once from the size of the sheet and passed to every stage."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.model import Sheet


@dataclass(frozen=True)
class Tolerance:
    """What counts as a tie.

    ``tie`` is relative to the smaller of two disks; ``rounding`` is the absolute error, in mm, of float64 coordinates
    as large as the sheet.
    """

    tie: float
    rounding: float

    @classmethod
    def for_sheet(cls, sheet: Sheet) -> Tolerance:
        """Return the tolerances for a sheet: ties at 1e-8, rounding at about 100 units in the last place."""
        return cls(tie=1e-8, rounding=3e-14 * sheet.diagonal)

    def touching(self, a: Floats, b: Floats) -> Floats:
        """Return how far apart, in mm, two disks of radii ``a`` and ``b`` may be and still count as touching."""
        return self.tie * np.minimum(a, b) + self.rounding
