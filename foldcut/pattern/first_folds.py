"""What lines that are folded before all else come to: a half, a quarter, or a wedge of the sheet.

``FoldedPattern.first_folds`` -> how many folds these are, and how many layers.

One line folds the sheet in half, two perpendicular ones to a quarter. Three or more go through one point, with equal
angles between them, and fold it into a wedge: in half along the first line, and then the row of ``n`` sectors that is
left again and again, always away from you, so that half of them, or one less, go under the others. The sector that is
then on top is the one to the left of the first line, beside its second half.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.geometry.vectors import cross

FEWEST_OF_WEDGE = 3
"""With so many lines or more that are folded first, the sheet becomes a wedge."""


ON_LINE_MM = 1e-6
"""What is nearer than this to a line is on it."""

PLACES = 65
"""At so many places along a line it is looked whether it is in the sector on top."""


def is_wedge(lines: Sequence[Floats]) -> bool:
    """Return whether lines that are folded first fold the sheet into a wedge."""
    return len(lines) >= FEWEST_OF_WEDGE


def sectors_left(count: int) -> list[int]:
    """Return how many sectors lie beside each other after each fold of a wedge but the first, which leaves all."""
    left = []
    while count > 1:
        count = (count + 1) // 2
        left.append(count)
    return left


def fan_folds(count: int) -> int:
    """Return how many straight folds make a wedge: the fewest that can, as a fold at most doubles the layers."""
    return 1 + len(sectors_left(count))


def fan(count: int) -> list[int]:
    """Return the sectors of a sheet with ``count`` lines in the order in which they lie in the fan, from top to bottom.

    Sector 0 is on top. Sectors are numbered counter-clockwise from the second half of the first line on.
    """
    row = [[number, 2 * count - 1 - number] for number in range(count)]
    for left in sectors_left(count):
        row = _folded(row, left)
    return row[0]


def axis_order(count: int) -> list[int]:
    """Return the lines in the order in which the fan's folds crease them; one that is creased twice counts once.

    Line ``number`` has the direction of the border between sectors ``number`` - 1 and ``number``.
    """
    return list(dict.fromkeys(half % count for half in letters_of_wedge(count)))


def letters_of_wedge(count: int) -> dict[int, str]:
    """Return which half-lines of a wedge of ``count`` lines are mountains ("M") and which are valleys ("V").

    They have the numbers of the sectors that follow them, and come in the order in which the fan's folds crease them.
    """
    letters: dict[int, str] = {}
    for _, half, letter in _creased(count):
        letters.setdefault(half, letter)
    return letters


def fold_numbers(count: int) -> list[int]:
    """Return the number of the fold that creases each of ``count`` lines, counted from 1, in the lines' order.

    One fold of a wedge creases several lines; that of a line which is creased twice is the first.
    """
    if count < FEWEST_OF_WEDGE:
        return list(range(1, count + 1))
    folds: dict[int, int] = {}
    for fold, half, _ in _creased(count):
        folds.setdefault(half % count, fold)
    return list(folds.values())


def _creased(count: int) -> Iterator[tuple[int, int, str]]:
    """Yield what each fold of a fan creases: the fold's number, counted from 1, a half-line, and its letter."""
    yield from ((1, 0, "M"), (1, count, "M"))
    row = [[number, 2 * count - 1 - number] for number in range(count)]
    for fold, left in enumerate(sectors_left(count), start=2):
        # every other sector of a column lies turned over: its first border is the one away from column 0
        turned = {sector: (sector - left) % 2 for sector in row[left]}
        for sector in sorted(turned, key=lambda one: (one + turned[one]) % count):
            yield fold, (sector + turned[sector]) % (2 * count), "V" if turned[sector] else "M"
        row = _folded(row, left)


def _folded(row: Sequence[list[int]], left: int) -> list[list[int]]:
    """Return the columns, each from top to bottom, of which those from number ``left`` on go under the others."""
    under = [*row[left:], *[[]] * (2 * left - len(row))][::-1]
    return [[*above, *below[::-1]] for above, below in zip(row[:left], under, strict=True)]


def in_front(line: Floats, first_folds: Sequence[Floats]) -> bool:
    """Return whether a line, ``(2, 2)`` mm, is at least in part on what is on top once the first folds are made.

    That is the part to the right of an upright first fold, above a level one, and of a wedge the sector on top.
    """
    if not is_wedge(first_folds):
        across = [0 if first[0, 0] == first[1, 0] else 1 for first in first_folds]
        pairs = zip(first_folds, across, strict=True)
        return all(line[:, axis].max() > first[0, axis] + ON_LINE_MM for first, axis in pairs)
    first, *others = first_folds
    turns = [_turn(first, other) for other in others]
    last = others[int(np.argmin(turns))]
    last = last if cross(first[1] - first[0], last[1] - last[0]) > 0 else last[::-1]
    points = line[0] + np.linspace(0, 1, PLACES)[:, None] * (line[1] - line[0])
    inside = (_left(first, points) > ON_LINE_MM) & (_left(last, points) < -ON_LINE_MM)
    return bool(inside.any())


def _turn(line: Floats, other: Floats) -> float:
    """Return the angle from the direction of a line counter-clockwise to that of another, from 0 to pi."""
    (x, y), (to_x, to_y) = line[1] - line[0], other[1] - other[0]
    return (math.atan2(to_y, to_x) - math.atan2(y, x)) % math.pi


def _left(line: Floats, points: Floats) -> Floats:
    """Return how far points, ``(n, 2)``, are to the left of a line, in mm."""
    along = line[1] - line[0]
    return np.asarray(cross(along, points - line[0]) / math.hypot(*along))


def first_fold_count(lines: Sequence[Floats]) -> int:
    """Return how many straight folds the lines are that are folded first."""
    return fan_folds(len(lines)) if is_wedge(lines) else len(lines)


def layers_after(lines: Sequence[Floats]) -> int:
    """Return how many layers lie on each other after the lines are folded that are folded first."""
    return 2 * len(lines) if is_wedge(lines) else 2 ** len(lines)
