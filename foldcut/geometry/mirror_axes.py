"""The mirror axes of a shape, exact or nearly so, and the shape made exactly symmetric.

``Shape`` -> list of ``Axis``; ``Shape`` on its sheet -> the same with every corner moved to match its mirror image.

A mirror axis goes through the mean of the corners, and reflects the corner farthest from the mean to a corner that is
as far away. So only the axes that do this are tried.
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
"""A drawing whose corners are off by less than this, relative to its size, is symmetric but for its file's rounding."""

ALIGNED = 1e-5
"""Axes whose directions differ by less than this, in radians, are parallel."""

NEARLY_SAME = 0.1
"""By how much, in radians, the best axis for all corners may differ from the one that was tried."""

MOST_TURNS = 3
"""The largest number of turns that are tried."""


@dataclass(frozen=True)
class Axis:
    """A mirror axis through the mean of a shape's corners.

    ``angle`` is its direction in radians, at least 0 and less than pi; ``deviation`` is the largest distance of a
    corner from the mirror image of its partner, in the shape's unit.
    """

    angle: float
    deviation: float


def mirror_axes(shape: Shape, allowed: float = 0.0) -> list[Axis]:
    """Return the axes about which ``shape`` is symmetric: first those that are exact but for rounding.

    ``allowed`` is by how much a corner may be off, in the shape's unit; rounding is always allowed.
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
        partner, deviation = partners(shape, _reflected(centred, angle), centred)
        if partner is None or deviation > allowed:
            continue
        angle = _best_angle(centred, centred[partner], angle)
        partner, deviation = partners(shape, _reflected(centred, angle), centred)
        if partner is not None:
            found.append(Axis(0.0 if math.pi - angle < ALIGNED else angle, deviation))
    return sorted(found, key=lambda axis: (axis.deviation > rounding, axis.angle))


def sheet_axes(shape: Shape, allowed: float, *, may_turn: bool) -> Iterator[tuple[float, tuple[int, ...]]]:
    """Yield turns in degrees after which mirror axes are parallel to the sheet's sides, and which axes these then are.

    0 is an upright axis, 1 a level one; where a turn gives both, both together come before each alone. ``allowed`` is
    as for ``mirror_axes``. Unless ``may_turn``, the shape is not turned: the only turn is 0.
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
    """Return ``shape`` with every corner moved half-way to its partner's mirror image, and the longest such move.

    ``axes`` go through ``middle`` ``(2,)``: 0 is the upright axis, 1 the level one.
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
    """Return the direction of the axis that takes points nearest to their partners, by least squares."""
    z, w = points @ (1, 1j), partners @ (1, 1j)
    best = float(np.angle((z * w).sum())) / 2 % math.pi
    return best if abs(math.remainder(best - angle, math.pi)) < NEARLY_SAME else angle


def _nearest(points: Floats, places: Floats) -> Numbers:
    """Return the number of the nearest point for each of ``places``."""
    return np.asarray(shapely.STRtree(shapely.points(points)).nearest(shapely.points(places)), dtype=np.intp)


def partners(shape: Shape, images: Floats, points: Floats, *, turned: bool = False) -> tuple[Numbers | None, float]:
    """Return for each corner the one nearest to its image, and the largest distance between the two.

    ``points`` and ``images`` ``(n, 2)``: the corners of all loops, and where a reflection takes them, or if the shape
    is ``turned``, a turn. None if the partners are not the corners of the same loops, walked backwards where it was
    reflected.
    """
    partner = _nearest(points, images)
    distance = np.hypot(*(points[partner] - images).T)
    if len(np.unique(partner)) < len(points):
        return None, math.inf
    first = 0
    following = np.empty(len(points), dtype=np.intp)
    for loop in shape.loops:
        following[first : first + len(loop)] = first + np.roll(np.arange(len(loop)), -1)
        first += len(loop)
    same = following[partner] == partner[following] if turned else following[partner[following]] == partner
    if not same.all():
        return None, math.inf
    return partner, float(distance.max())
