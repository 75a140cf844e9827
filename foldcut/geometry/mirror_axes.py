"""Mirror axes of a shape, exact and near enough, and the shape made exactly symmetric.

``Shape`` -> ``Axis`` list; ``Shape`` on its sheet -> the same, with coordinates that agree with their mirror images.

An axis of symmetry goes through the mean of the corners and takes the corner that is farthest from it to one as far
away, so only those need to be tried.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
import shapely

from foldcut.core.arrays import Floats, Numbers, points_array
from foldcut.core.model import Shape

ROUNDING = 2e-6
"""Off by less than this, relative to its size, a drawing is symmetric but for the rounding of its file."""

ALIGNED = 1e-5
"""Axes that differ by less than this, in radians, are parallel."""

MOST_TURNS = 3


@dataclass(frozen=True)
class Axis:
    """A mirror axis: its direction in radians, from 0 up to pi, and by how much corners are off, in the shape's unit.

    It goes through the mean of the shape's corners.
    """

    angle: float
    deviation: float


def mirror_axes(shape: Shape, allowed: float = 0.0) -> list[Axis]:
    """Return the axes about which ``shape`` is symmetric, those first that are exact but for rounding.

    ``allowed``: by how much a corner may be off, in the shape's unit; what rounding does always may.
    """
    points = np.concatenate(shape.loops)
    centred = points - points.mean(axis=0)
    rounding = ROUNDING * float(np.ptp(points, axis=0).max())
    allowed = max(allowed, rounding)
    far = np.hypot(*centred.T)
    first = int(far.argmax())
    angles = np.arctan2(centred[:, 1], centred[:, 0])
    found: list[Axis] = []
    for other in np.flatnonzero(np.abs(far - far[first]) <= 2 * allowed).tolist():
        angle = float((angles[first] + angles[other]) / 2 % math.pi)
        partner, deviation = _partners(shape, _reflected(centred, angle), centred)
        if partner is None or deviation > allowed:
            continue
        angle = _best_angle(centred, centred[partner], angle)
        partner, deviation = _partners(shape, _reflected(centred, angle), centred)
        if partner is not None:
            found.append(Axis(0.0 if math.pi - angle < ALIGNED else angle, deviation))
    return sorted(found, key=lambda axis: (axis.deviation > rounding, axis.angle))


def sheet_axes(shape: Shape, allowed: float, *, may_turn: bool) -> Iterator[tuple[float, tuple[int, ...]]]:
    """Yield turns in degrees that take mirror axes along the sheet, and which: 0 upright, 1 level, or both.

    ``allowed`` as for ``mirror_axes``; ``may_turn``: also other turns than none.
    """
    groups: dict[int, set[int]] = {}
    turns: dict[int, float] = {}
    for axis in mirror_axes(shape, allowed):
        turn = -math.remainder(axis.angle, math.pi / 2)
        turn = 0.0 if abs(turn) < ALIGNED else -abs(turn) if abs(turn) > math.pi / 4 - ALIGNED else turn
        key = next((k for k, known in turns.items() if abs(known - turn) < ALIGNED), len(turns))
        turns.setdefault(key, turn)
        groups.setdefault(key, set()).add(1 - round((axis.angle + turn) / (math.pi / 2)) % 2)
    for key in sorted(turns, key=lambda key: abs(turns[key]))[:MOST_TURNS]:
        if may_turn or not turns[key]:
            some = sorted(groups[key])
            for axes in ([tuple(some)] if len(some) == 2 else []) + [(axis,) for axis in some]:
                yield math.degrees(turns[key]), axes


def symmetric(shape: Shape, middle: Floats, axes: Iterable[int]) -> tuple[Shape, float]:
    """Return ``shape`` with every corner half-way to the mirror image of its partner, and how far corners moved.

    ``middle`` ``(2,)``; ``axes``: 0 for the upright axis through it, 1 for the level one, or both.
    """
    drawn = np.concatenate(shape.loops) - middle
    points = drawn
    for axis in axes:
        sign = np.where(np.arange(2) == axis, -1.0, 1.0)
        partner = _nearest(points, points * sign)
        points = (points + points[partner] * sign) / 2
        points[partner == np.arange(len(points)), axis] = 0.0
    ends = np.cumsum([len(loop) for loop in shape.loops])[:-1]
    moved = float(np.hypot(*(points - drawn).T).max())
    return Shape(tuple(points_array(loop) for loop in np.split(points + middle, ends)), shape.parent), moved


def _reflected(points: Floats, angle: float) -> Floats:
    cosine, sine = math.cos(2 * angle), math.sin(2 * angle)
    reflected: Floats = points @ np.array([(cosine, sine), (sine, -cosine)])
    return reflected


def _best_angle(points: Floats, partners: Floats, angle: float) -> float:
    """Return the angle of the axis about which points come nearest to their partners, by least squares."""
    z, w = points @ (1, 1j), partners @ (1, 1j)
    best = float(np.angle((z * w).sum())) / 2 % math.pi
    return best if abs(math.remainder(best - angle, math.pi)) < 0.1 else angle


def _nearest(points: Floats, places: Floats) -> Numbers:
    """Return for each of ``places`` the number of the point that is nearest to it."""
    return np.asarray(shapely.STRtree(shapely.points(points)).nearest(shapely.points(places)), dtype=np.intp)


def _partners(shape: Shape, reflected: Floats, points: Floats) -> tuple[Numbers | None, float]:
    """Return for each corner the one nearest to its mirror image, and the largest distance between them.

    None if these do not make up the same loops, walked backwards.
    """
    partner = _nearest(points, reflected)
    distance = np.hypot(*(points[partner] - reflected).T)
    if len(np.unique(partner)) < len(points):
        return None, math.inf
    first = 0
    following = np.empty(len(points), dtype=np.intp)
    for loop in shape.loops:
        following[first : first + len(loop)] = first + np.roll(np.arange(len(loop)), -1)
        first += len(loop)
    if not np.array_equal(following[partner[following]], partner):
        return None, math.inf
    return partner, float(distance.max())
