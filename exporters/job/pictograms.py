"""Small pictures of what a person does with a printed sheet: polylines in a square of side 1, y up, black on white."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.geometry.vectors import left_normal
from foldcut.jobs.model import Pictogram

__all__ = ["PICTOGRAMS", "Stroke"]


@dataclass(frozen=True, eq=False)
class Stroke:
    """A polyline, ``(n, 2)``; ``dashed`` for a fold, ``grey`` for the cut, ``filled`` for an arrow's head."""

    points: Floats
    dashed: bool = False
    grey: bool = False
    filled: bool = False


def _line(*points: tuple[float, float]) -> Floats:
    return np.array(points, dtype=np.float64)


def _arc(middle: tuple[float, float], radius: float, start: float, end: float) -> Floats:
    """Return an arc, from one angle to another in degrees."""
    angle = np.radians(np.linspace(start, end, 17))
    return np.array(middle) + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _arrow(curve: Floats) -> list[Stroke]:
    """Return a curved line with a head at its end."""
    tip = curve[-1]
    back = (curve[-3] - tip) / np.hypot(*(curve[-3] - tip)) * 0.2
    aside = left_normal(back) * 0.5
    return [Stroke(curve), Stroke(np.array([tip, tip + back + aside, tip + back - aside]), filled=True)]


_SHEET = _line((0.1, 0.05), (0.9, 0.05), (0.9, 0.8), (0.1, 0.8), (0.1, 0.05))
_OVER = _arc((0.5, 0.62), 0.3, 160, 20)

PICTOGRAMS: dict[Pictogram, tuple[Stroke, ...]] = {
    "first": (
        Stroke(_SHEET),
        Stroke(_line((0.5, 0.05), (0.5, 0.8)), dashed=True),
        Stroke(_line((0.44, 0.14), (0.5, 0.05), (0.56, 0.14))),
        Stroke(_line((0.44, 0.71), (0.5, 0.8), (0.56, 0.71))),
        *_arrow(_OVER),
    ),
    "fold": (Stroke(_SHEET), Stroke(_line((0.5, 0.05), (0.5, 0.8)), dashed=True), *_arrow(_OVER)),
    "press": (
        Stroke(_SHEET),
        Stroke(_line((0.5, 0.42), (0.1, 0.65)), dashed=True),
        Stroke(_line((0.5, 0.42), (0.9, 0.65)), dashed=True),
        Stroke(_line((0.5, 0.42), (0.5, 0.05)), dashed=True),
        Stroke(_line((0.5, 0.42), (0.65, 0.8)), dashed=True),
    ),
    "flatten": (
        Stroke(_line((0.05, 0.12), (0.95, 0.12))),
        Stroke(_line((0.05, 0.2), (0.95, 0.2))),
        Stroke(_line((0.1, 0.38), (0.3, 0.62), (0.5, 0.38), (0.7, 0.62), (0.9, 0.38))),
        *_arrow(np.linspace((0.5, 0.98), (0.5, 0.68), 5)),
    ),
    "cut": (
        Stroke(_line((0.0, 0.5), (1.0, 0.5)), grey=True),
        Stroke(_line((0.34, 0.3), (0.95, 0.66))),
        Stroke(_line((0.34, 0.7), (0.95, 0.34))),
        Stroke(_arc((0.2, 0.22), 0.15, 0, 360)),
        Stroke(_arc((0.2, 0.78), 0.15, 0, 360)),
    ),
}
"""What each hint has beside it."""
