"""Lay a shape on its sheet, as often as methods ask for it at another angle.

``Shape`` in the drawing's units, ``Layout`` -> ``Laid``: the shape in the sheet's mm, simplified if that is asked for.
"""

from __future__ import annotations

from dataclasses import dataclass

from foldcut.core.model import Placement, Shape, Sheet
from foldcut.drawing.placement import Layout
from foldcut.drawing.simplify import simplify

__all__ = ["Laid", "Laying"]


@dataclass(frozen=True, eq=False)
class Laid:
    """A shape on its sheet, and what was done to it on the way, in words.

    ``shape`` is in the sheet's mm. ``quarter``: the drawing was turned a quarter, to have more room.
    """

    sheet: Sheet
    shape: Shape
    placement: Placement
    notes: tuple[str, ...]
    quarter: bool


@dataclass(frozen=True, eq=False)
class Laying:
    """What is needed to lay a shape on its sheet.

    ``simplify``: corners are left out that are off by no more than so many mm. ``mirrored``: the drawing was turned
    over, and ``y_down``: its y axis points down, which only the placement has to know.
    """

    outline: Shape
    layout: Layout
    simplify: float = 0.0
    mirrored: bool = False
    y_down: bool = False

    def lay(self, turn: float = 0.0) -> Laid:
        """Lay the shape on the sheet, turned by so many degrees more than the layout says.

        Raises ``SheetError`` where it does not fit, ``ShapeError`` where nothing is left of it.
        """
        sheet, shape, placement, quarter = self.layout.place(self.outline, turn)
        notes = [f"turned by {turn:.4g} degrees, so that a mirror axis lies along the sheet"] if turn else []
        notes += ["turned by a quarter, so that it has more room on the sheet"] * quarter
        if self.simplify:
            simplified = simplify(shape, self.simplify)
            shape = simplified.shape
            notes.append(str(simplified))
        placement = Placement(placement.matrix * (-1.0, 1.0, 1.0)) if self.mirrored else placement
        return Laid(sheet, shape, placement.from_y_down() if self.y_down else placement, tuple(notes), quarter)
