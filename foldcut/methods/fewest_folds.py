"""A lower bound for the number of folds that a shape needs, so that a search can stop where nothing better exists.

``Shape`` on its sheet -> ``Fewest``.

At a corner of the shape both sides come to lie on the cut line, with the paper inside the shape on one side of it and
the paper outside on the other. So at least one crease leaves the corner on the inside and one on the outside. If it is
just one on each, both bisect the corner, so they lie on one line. Otherwise there are four or more, as their number is
even. Let a line count at each corner that it passes through:

- 1 if it bisects the corner;
- 1/2 if it does not, as at most two of the corner's creases lie on it;
- 1/2 for both ends of a side together if it runs along that side, as the side itself is no crease.

Then the lines through any one corner count 1 or more there. If no line counts more than w at all its corners together,
n corners need at least n / w lines.

Where the sheet is folded along mirror axes first, these are needed, and the lines for the corners on one side of them.
Three axes or more through one point are folded by fewer folds than they are lines; what follows them is not counted.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from foldcut.core.arrays import Bools, Floats
from foldcut.core.model import Shape, Sheet
from foldcut.geometry.dihedral import dihedral
from foldcut.geometry.mirror_axes import mirror_axes
from foldcut.geometry.vectors import cross
from foldcut.pattern.first_folds import FEWEST_OF_WEDGE, fan_folds

__all__ = ["Fewest", "fewest_folds"]

MOST_CORNERS = 60
"""Drawings with more corners get no bound: the time grows with the third power of their number."""

SAVED = 2
"""A wedge of three axes or more counts only where it may save so many folds: the ridges alone are folded at once, and
looking for a wedge as well takes time."""

RIGHT_ANGLE = 1e-5
"""Axes whose angle differs from a right one by less than this, in radians, are perpendicular."""

STRAIGHT = 1e-6
"""A corner is straight if the directions of its sides differ by less than this."""


@dataclass(frozen=True)
class Fewest:
    """Lower bounds for a shape with a number of ``corners``.

    ``folds``: no pattern has creases on fewer lines, or where mirror axes are folded first, fewer folds, but for a
    wedge that takes less than ``SAVED`` fewer; 0 if unknown.
    ``bisectors``: how many lines the bisectors of the corners lie on; every straight skeleton has creases on these.
    """

    folds: int
    bisectors: int
    corners: int


def fewest_folds(
    shape: Shape, sheet: Sheet, near: float = 0.0, symmetry: float = 0.0, several: float | None = None
) -> Fewest:
    """Return a lower bound for the folds of a shape on its sheet that holds even if corners move by ``near`` mm.

    ``symmetry`` is how far corners may be off for a mirror axis, in mm; ``several``: the same for three axes or more
    through one point, None for no more.
    """
    corners = np.concatenate(shape.loops)
    inside = np.minimum(corners, (sheet.width, sheet.height) - corners).min() > near
    if len(corners) > MOST_CORNERS or not inside:
        return Fewest(0, len(corners), len(corners))
    lines = _Lines(shape, max(near, symmetry) + 1e-9 * sheet.diagonal)
    folds = [lines.fewest(np.ones(len(corners), dtype=np.bool_))]
    normals = [np.array([-math.sin(axis.angle), math.cos(axis.angle)]) for axis in mirror_axes(shape, symmetry)]
    away = [(corners - corners.mean(axis=0)) @ normal for normal in normals]
    sides = [distance > lines.near for distance in away]
    folds += [1 + lines.fewest(side) for side in sides]
    for one, other in combinations(range(len(sides)), 2):
        if abs(normals[one] @ normals[other]) < RIGHT_ANGLE:
            folds.append(2 + lines.fewest(sides[one] & sides[other]))
    around = dihedral(shape, symmetry if several is None else several)
    if around is not None and around.count >= FEWEST_OF_WEDGE:
        wedge = fan_folds(around.count)
        folds += [wedge] if wedge <= min(folds) - SAVED else []
    return Fewest(min(folds), lines.bisectors(), len(corners))


class _Lines:
    """The lines through two corners each, and which corners lie on each of them, or may do so once corners have moved.

    ``on`` and ``bisected`` are ``(lines, corners)``: which corners a line passes, and which of these it bisects.
    ``bent`` ``(corners,)``: which corners cannot become straight.
    """

    def __init__(self, shape: Shape, near: float) -> None:
        self.near = near
        corners = np.concatenate(shape.loops)
        number = np.split(np.arange(len(corners)), np.cumsum([len(loop) for loop in shape.loops])[:-1])
        self.following = np.concatenate([np.roll(loop, -1) for loop in number])
        side = corners[self.following] - corners
        length = np.hypot(*side.T)
        ahead = side / length[:, None]
        before = np.empty_like(self.following)
        before[self.following] = np.arange(len(corners))
        bisector = ahead - ahead[before]
        flat = np.hypot(*bisector.T) < STRAIGHT  # so the bisector is perpendicular to the side
        bisector[flat] = np.column_stack([-ahead[flat, 1], ahead[flat, 0]])
        bisector /= np.hypot(*bisector.T)[:, None]
        turning = 2 * near / np.minimum(length, length[before])
        self.bent: Bools = np.abs(np.arctan2(cross(ahead[before], ahead), (ahead * ahead[before]).sum(axis=1))) > (
            2 * turning
        )
        one, other = np.triu_indices(len(corners), 1)
        along = corners[other] - corners[one]
        apart = np.hypot(*along.T)[:, None]
        along = along / apart
        to = corners - corners[one][:, None]
        at = (to * along[:, None]).sum(axis=2) / apart
        self.on: Bools = np.abs(cross(along[:, None], to)) <= near * (2 + 2 * np.abs(at))
        turned = np.abs(cross(along[:, None], bisector))
        self.bisected: Bools = self.on & (turned <= 2 * near / apart + turning)
        self.ends = one, other

    def fewest(self, some: Bools) -> int:
        """Return how many lines some of the corners need at least; those that may become straight need none."""
        some = some & self.bent
        bisected, on = self.bisected & some, self.on & some
        single = on & ~bisected
        # both ends of a side are on the line; of several such sides in a row only the first counts
        pair = single & single[:, self.following]
        before_on = np.zeros_like(on)
        before_on[:, self.following] = on
        pair &= ~before_on
        counts: Floats = bisected.sum(axis=1) + single.sum(axis=1) / 2 - pair.sum(axis=1) / 2
        return math.ceil(int(some.sum()) / max(1.0, float(counts.max(initial=0.0))) - 1e-9)

    def bisectors(self) -> int:
        """Return how many lines the bisectors of the corners lie on."""
        one, other = self.ends
        numbers = np.arange(len(one))
        shared = self.bisected[numbers, one] & self.bisected[numbers, other]
        sizes = np.ones(self.on.shape[1]) + np.bincount(one[shared], minlength=self.on.shape[1])
        sizes += np.bincount(other[shared], minlength=self.on.shape[1])
        return round(float((1 / sizes).sum()))
