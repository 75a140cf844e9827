"""Shapes with several mirror axes through one point, evenly spaced: stars, snowflakes, rosettes; and windmills.

``Shape`` -> ``Dihedral``; with it the shape made exactly symmetric about all axes together.

The *centre* is the mean of the corners. ``count`` axes at equal angles divide the plane into 2 ``count`` *sectors*;
the shape in one of them, reflected at its borders again and again, is all of the shape. A windmill has turns that bring
it onto itself, and no axis: there is no sector whose borders could be folded.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Floats, Numbers, points_array
from foldcut.core.model import Shape
from foldcut.geometry.mirror_axes import ALIGNED, ROUNDING, Axis, mirror_axes, partners

__all__ = ["MOST_AXES", "Dihedral", "dihedral", "made_dihedral", "sector_maps", "turns_of"]

MOST_AXES = 12
"""The largest number of axes that are folded first: a sector then has 15 degrees."""

EVEN = 0.02
"""Axes are evenly spaced if each is at most this part of the angle between neighbours off its place."""


@dataclass(frozen=True)
class Dihedral:
    """Mirror axes through the mean of a shape's corners, evenly spaced.

    ``angle`` is the direction of one of the ``count`` axes in radians, at least 0 and less than pi / ``count``.
    ``deviation``: the largest distance of a corner from the mirror image of its partner, in the shape's unit.
    """

    count: int
    angle: float
    deviation: float

    def turned(self, turn: float) -> Dihedral:
        """Return the axes of the shape turned by ``turn`` radians; directions within ``ALIGNED`` of level are level."""
        return Dihedral(self.count, _least(self.angle + turn, math.pi / self.count), self.deviation)

    @property
    def first(self) -> float:
        """The direction in radians of the axis to fold first: a level one, else an upright one, else ``angle``."""
        is_upright = abs(math.remainder(math.pi / 2 - self.angle, math.pi / self.count)) < 1e-12
        return math.pi / 2 if self.angle and is_upright else self.angle

    @property
    def upright_turn(self) -> float:
        """The least turn, in radians, after which one of the axes is upright or level."""
        step = math.pi / self.count
        turns = [math.remainder(quarter - self.angle, step) for quarter in (0.0, math.pi / 2)]
        least = min(turns, key=abs)
        return 0.0 if abs(least) < ALIGNED else least


def dihedral(shape: Shape, allowed: float = 0.0) -> Dihedral | None:
    """Return the most axes, of 2 to ``MOST_AXES``, that a shape has through one point; None if it has not even two.

    ``allowed`` is by how much a corner may be off, in the shape's unit; rounding is always allowed.
    """
    axes = mirror_axes(shape, allowed)
    for count in range(min(MOST_AXES, len(axes)), 1, -1):
        for found in _evenly_spaced(axes, count):
            step = math.pi / count
            first = found[0].angle
            off = [math.remainder(axis.angle - first, step) for axis in found]
            angle = _least(first + sum(off) / count, step)
            return Dihedral(count, angle, max(axis.deviation for axis in found))
    return None


def _evenly_spaced(axes: Sequence[Axis], count: int) -> Iterator[list[Axis]]:
    """Yield the ways to choose evenly spaced axes."""
    step = math.pi / count
    for first in axes:
        places = [first.angle + number * step for number in range(count)]
        chosen = [min(axes, key=lambda axis: abs(math.remainder(axis.angle - place, math.pi))) for place in places]
        off = [math.remainder(axis.angle - place, math.pi) for axis, place in zip(chosen, places, strict=True)]
        if max(map(abs, off)) <= EVEN * step:
            yield chosen


def _least(angle: float, step: float) -> float:
    """Return the same direction, but for multiples of ``step``, from 0 to below it; upright and level axes exactly so.

    An axis is upright or level if it is so within ``ALIGNED``.
    """
    for quarter in (0.0, math.pi / 2):
        if abs(math.remainder(angle - quarter, step)) < ALIGNED:
            angle = quarter
            break
    angle %= step
    return 0.0 if step - angle < 1e-12 else angle


def sector_maps(count: int, angle: float) -> Floats:
    """Return what takes the first sector to each of 2 ``count`` sectors around the origin, ``(2 count, 2, 2)``.

    The first sector lies between the directions ``angle`` and ``angle`` + pi / ``count``; the others follow
    counter-clockwise. A point ``p`` goes to ``p @ map``. The map of every other sector is a reflection.
    """
    step = math.pi / count
    maps = []
    for number in range(2 * count):
        if number % 2 == 0:
            cosine, sine = math.cos(number * step), math.sin(number * step)
            maps.append([(cosine, sine), (-sine, cosine)])
        else:
            twice = 2 * angle + (number + 1) * step
            cosine, sine = math.cos(twice), math.sin(twice)
            maps.append([(cosine, sine), (sine, -cosine)])
    return np.array(maps)


def made_dihedral(shape: Shape, axes: Dihedral) -> tuple[Shape, Floats, float] | None:
    """Return a shape made exactly symmetric, its centre ``(2,)``, and how far a corner was moved for that at most.

    Each corner becomes the mean of its 2 ``count`` images, taken back to where it was. None where corners have no
    partners about some of the axes.
    """
    drawn = np.concatenate(shape.loops)
    centre = drawn.mean(axis=0)
    points = drawn - centre
    maps = sector_maps(axes.count, axes.angle)
    # the map of sector 1 reflects at the border that it shares with sector 0, that of the last one at the other border
    swaps = [partners(shape, points @ maps[number], points)[0] for number in (1, -1)]
    if any(swap is None for swap in swaps):
        return None
    one, last = swaps
    assert one is not None
    assert last is not None
    images = [np.arange(len(points))]
    for number in range(2 * axes.count - 1):
        images.append(images[-1][one] if number % 2 == 0 else images[-1][last])
    if len({tuple(row) for row in (images[-1][last], images[0])}) > 1:
        return None
    mean = np.mean([points[image] @ maps[k].T for k, image in enumerate(images)], axis=0)
    exact = _from_one_of_each(mean, images, maps)
    ends = np.cumsum([len(loop) for loop in shape.loops])[:-1]
    moved = float(np.hypot(*(exact - points).T).max())
    return Shape(tuple(points_array(loop) for loop in np.split(exact + centre, ends)), shape.parent), centre, moved


def _from_one_of_each(points: Floats, images: Sequence[Numbers], maps: Floats) -> Floats:
    """Return points with all images of one computed from it, so that they agree to the last digits."""
    exact = points.copy()
    done = np.zeros(len(points), dtype=np.bool_)
    for corner in range(len(points)):
        if not done[corner]:
            for image, matrix in zip(images, maps, strict=True):
                exact[image[corner]] = points[corner] @ matrix
                done[image[corner]] = True
            exact[corner] = points[corner]
    return exact


def turns_of(shape: Shape, allowed: float = 0.0) -> int:
    """Return the largest number of equal turns, up to ``MOST_AXES``, that bring a shape onto itself; 1 if none does.

    ``allowed`` is as for ``dihedral``.
    """
    points = np.concatenate(shape.loops)
    centred = points - points.mean(axis=0)
    allowed = max(allowed, ROUNDING * float(np.ptp(points, axis=0).max()))
    for count in range(MOST_AXES, 1, -1):
        turn = sector_maps(count, 0.0)[2]
        found, off = partners(shape, centred @ turn, centred, turned=True)
        if found is not None and off <= allowed:
            return count
    return 1
