"""The wavefront with decimal numbers of many digits, for graphs that doubles are not precise enough for.

Such are sides that are parallel but for a millionth of a degree: the vertex between them is so fast that doubles do not
tell where it is. The coordinates of the graph are taken as exact. It takes about fifty times as long as doubles.
"""

from __future__ import annotations

from decimal import Context, Decimal, localcontext
from functools import cache
from math import inf
from types import ModuleType
from typing import Any

from foldcut.core.compiled import copy_of
from foldcut.geometry.straight_skeleton import wavefront
from foldcut.geometry.straight_skeleton.frame import Frame
from foldcut.geometry.straight_skeleton.tables import Front, Graphs

__all__ = ["DIGITS", "ZERO", "decimal_copy", "run_with_decimals"]

DIGITS = 60
"""How many digits numbers have."""

ROUNDING = Decimal(10) ** -(DIGITS - 2)
"""The rounding of a number near 1."""

ZERO = Decimal(0)


@cache
def decimal_copy() -> ModuleType:
    """Return a copy of ``wavefront`` whose constants are decimal, and which never uses the grid."""
    copy: Any = copy_of(wavefront, "_decimal")
    for name, value in list(vars(copy).items()):
        if isinstance(value, float) and value != inf:
            setattr(copy, name, Decimal(value))
    copy.ULP = ROUNDING
    copy.MOST_ERROR = copy.SQUARE = Decimal(10) ** -(DIGITS // 2)
    copy.FEW = copy.FEW_LATE = 1 << 60
    copy.NEVER = Decimal("Infinity")
    copy.sqrt = Decimal.sqrt
    made: ModuleType = copy
    return made


def run_with_decimals(front: Front, sides: Graphs, frame: Frame) -> int:
    """Do as ``wavefront.run``, with tables that are lists of decimal numbers."""
    with localcontext(Context(prec=DIGITS)):
        x, y = (
            [(Decimal(value) - Decimal(origin)) / Decimal(frame.scale) for value in column]
            for column, origin in zip(frame.points.T.tolist(), frame.middle.tolist(), strict=True)
        )
        status: int = decimal_copy().run(front, sides, x, y, ROUNDING)
        return status
