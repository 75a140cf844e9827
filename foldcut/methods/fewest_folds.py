"""How few folds a shape can have: a lower bound, so that a search can end where nothing is left to be found.

``Shape`` on its sheet -> ``Fewest``.

At a corner c of the shape both sides come to lie on the cut line, the paper inside on one side of it and that outside
on the other. So creases leave c inside and outside. If there is one on each side, both halve the corner: they are on
one line. Else there are four or more, as their number is even. A line that halves c counts 1 for it; any other through
c counts 1/2, as it has two creases there at most; and along a side it counts 1/2 for both of its ends together, as the
side itself is no crease. Then the lines through every corner count 1 or more together, and if no line counts more than
w for all of its corners, n corners need n / w lines.

A drawing that is folded along mirror axes first needs these, and the lines for the corners at one side of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from foldcut.core.arrays import Bools, Floats
from foldcut.core.model import Shape, Sheet
from foldcut.geometry.mirror_axes import mirror_axes
from foldcut.geometry.vectors import cross

__all__ = ["Fewest", "fewest_folds"]

MOST_CORNERS = 60
"""Drawings with more corners are not looked at: the time grows with the third power."""

SQUARE = 1e-5
"""Axes that differ from a right angle by less, in radians, are at one."""


@dataclass(frozen=True)
class Fewest:
    """``folds``: no pattern has fewer lines, nor one folded along mirror axes first fewer folds; 0 if not known.

    ``bisectors``: on so many lines are the bisectors of the ``corners``; every straight skeleton has them.
    """

    folds: int
    bisectors: int
    corners: int


def fewest_folds(shape: Shape, sheet: Sheet, near: float = 0.0, symmetry: float = 0.0) -> Fewest:
    """Return how many folds a shape on its sheet needs at least, even if corners are moved by up to ``near`` mm.

    ``symmetry``: how far in mm corners may be off for a mirror axis.
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
        if abs(normals[one] @ normals[other]) < SQUARE:
            folds.append(2 + lines.fewest(sides[one] & sides[other]))
    return Fewest(min(folds), lines.bisectors(), len(corners))


class _Lines:
    """The lines through two corners, and which corners are on each, or may be if corners are moved a little."""

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
        flat = np.hypot(*bisector.T) < 1e-6  # it hardly turns: upright on the side
        bisector[flat] = np.column_stack([-ahead[flat, 1], ahead[flat, 0]])
        bisector /= np.hypot(*bisector.T)[:, None]
        turning = 2 * near / np.minimum(length, length[before])  # how far sides, and bisectors, may be turned
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
        self.halved: Bools = self.on & (turned <= 2 * near / apart + turning)
        self.ends = one, other

    def fewest(self, some: Bools) -> int:
        """Return the least number of lines for some of the corners; those that may become straight need none."""
        some = some & self.bent
        halved, on = self.halved & some, self.on & some
        single = on & ~halved
        # both ends of a side on the line, the first of a row of such sides only
        pair = single & single[:, self.following]
        before_on = np.zeros_like(on)
        before_on[:, self.following] = on
        pair &= ~before_on
        counts: Floats = halved.sum(axis=1) + single.sum(axis=1) / 2 - pair.sum(axis=1) / 2
        return math.ceil(int(some.sum()) / max(1.0, float(counts.max(initial=0.0))) - 1e-9)

    def bisectors(self) -> int:
        """Return how many lines the corners' bisectors are on."""
        one, other = self.ends
        numbers = np.arange(len(one))
        shared = self.halved[numbers, one] & self.halved[numbers, other]
        sizes = np.ones(self.on.shape[1]) + np.bincount(one[shared], minlength=self.on.shape[1])
        sizes += np.bincount(other[shared], minlength=self.on.shape[1])
        return round(float((1 / sizes).sum()))
