"""The part of a sheet that the search folds, and how its pattern becomes the pattern of the whole sheet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Bools
from foldcut.core.model import CreasePattern, FoldedState, Shape


@dataclass(frozen=True, eq=False)
class SheetPart:
    """A part of a sheet that is folded instead of the whole. In this class the part is all of the sheet.

    The mirror method folds the sheet along its mirror axes first, so that what is left to fold is a half or a quarter:
    a subclass. ``shape``: what is cut out of the whole sheet, in mm on it.
    """

    shape: Shape

    def unfold(self, creases: CreasePattern, folded: FoldedState) -> tuple[CreasePattern, FoldedState]:
        """Return the pattern and the folded state of the whole sheet, given those of the part."""
        return creases, folded

    def creased(self, creases: CreasePattern) -> Bools:
        """Tell which edges of the part's pattern are creases of the whole sheet, ``(e,)``."""
        return np.asarray(creases.edges_assignment != "B")
