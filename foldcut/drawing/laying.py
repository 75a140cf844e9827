"""Lay a shape on its sheet, again at each angle that a method asks for.

``Shape`` in the drawing's units, ``Layout`` -> ``Laid``: the shape in the sheet's mm, simplified on request.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.model import Placement, Shape, Sheet
from foldcut.drawing.placement import Layout
from foldcut.drawing.simplify import simplify

__all__ = ["AS_IT_IS", "Laid", "Laying"]

AS_IT_IS = Placement(np.eye(2, 3))
"""The placement that changes nothing."""


@dataclass(frozen=True, eq=False)
class Laid:
    """A shape on its sheet, and notes on what was done to it.

    ``shape`` is in the sheet's mm. ``quarter``: the drawing was given a quarter turn, to have more room. ``drawn`` is
    the shape before it was laid, in numbers that do not depend on its size on the sheet, and ``similarity`` takes it to
    ``shape``; where it was changed after that, ``drawn`` is ``shape`` itself.
    """

    sheet: Sheet
    shape: Shape
    placement: Placement
    notes: tuple[str, ...]
    quarter: bool
    drawn: Shape
    similarity: Placement


@dataclass(frozen=True, eq=False)
class Laying:
    """What is needed to lay a shape, ``outline``, on its sheet.

    ``simplify``: the tolerance, in mm, within which corners are left out. ``mirrored``: left and right of the drawing
    were swapped. ``y_down``: its y axis points down. The last two only affect the placement.
    """

    outline: Shape
    layout: Layout
    simplify: float = 0.0
    mirrored: bool = False
    y_down: bool = False

    def lay(self, turn: float = 0.0) -> Laid:
        """Lay the shape on the sheet, turned by ``turn`` degrees in addition to what the layout says.

        Raises ``SheetError`` for numbers that make no sense, and ``ShapeError`` for a shape that does not fit or that
        is not valid once it is simplified.
        """
        sheet, shape, placement, quarter = self.layout.place(self.outline, turn)
        drawn, similarity = self.outline, placement
        notes = [f"turned by {turn:.4g} degrees, so that a mirror axis lies along the sheet"] if turn else []
        notes += ["turned by a quarter, so that it has more room on the sheet"] * quarter
        if self.simplify:
            simplified = simplify(shape, self.simplify)
            shape = drawn = simplified.shape
            similarity = AS_IT_IS
            notes.append(str(simplified))
        return Laid(sheet, shape, self._flipped(placement), tuple(notes), quarter, drawn, similarity)

    def on_sheet(self, loops: Sequence[Floats], laid: Laid) -> tuple[Floats, ...]:
        """Return loops in the units and directions of ``outline`` where they lie on the sheet, in mm."""
        placement = self._flipped(laid.placement)
        return tuple(placement.apply(loop) for loop in loops)

    def _flipped(self, placement: Placement) -> Placement:
        """Return a placement of ``outline`` as one of the file's own coordinates, or the other way around."""
        placement = Placement(placement.matrix * (-1.0, 1.0, 1.0)) if self.mirrored else placement
        return placement.from_y_down() if self.y_down else placement
