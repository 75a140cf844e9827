"""Circles among the drawn loops, and the regular polygons that are drawn for them.

All bisectors of a regular polygon meet in its middle; with an even number of sides that node needs no perpendicular.
Concentric circles get the same number of sides at the same angles.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.redraw.starts.chains import Chain, Line

__all__ = ["Circle", "circles_of", "regular_lines"]

ROUND = 0.2
"""How far a circle may be off, as a part of the tolerance."""


@dataclass(frozen=True, eq=False)
class Circle:
    """A chain, by its number, that is a circle: ``middle`` ``(2,)`` and ``radius`` in mm; ``off`` mm from it.

    ``largest``: the radius of the largest of those around the same middle.
    """

    chain: int
    middle: Floats
    radius: float
    off: float
    largest: float

    def sides(self, tolerance: float) -> int:
        """Return how many sides a polygon has, at least, that is within ``tolerance`` of all around its middle."""
        bound = min((0.99 * tolerance - self.off) / self.largest, 0.9)
        # a polygon of n sides, half of it outside, is off by r (1 - c) / (1 + c) with c = cos(pi / n)
        n = math.ceil(math.pi / math.acos((1 - bound) / (1 + bound)) - 1e-9)
        return max(4, n + n % 2)


def circles_of(chains: Sequence[Chain], tolerance: float) -> list[Circle]:
    """Return the circles among chains without corners, the largest first; concentric ones share a middle."""
    fitted: list[tuple[float, int, Floats, float]] = []
    for number, chain in enumerate(chains):
        if chain.corners.any() or len(chain.points) < 6:
            continue
        middle, radius = _fitted(chain)
        fitted.append((radius, number, middle, _off(chain, middle, radius)))
    found: list[Circle] = []
    for radius, number, middle, off in sorted(fitted, key=lambda one: (-one[0], one[1])):
        if off > ROUND * tolerance:
            continue
        near = [one for one in found if float(np.hypot(*(one.middle - middle))) < ROUND * tolerance / 2]
        if near:
            shared = near[0].middle
            found.append(Circle(number, shared, radius, _off(chains[number], shared, radius), near[0].largest))
        else:
            found.append(Circle(number, middle, radius, off, radius))
    return found


def _off(chain: Chain, middle: Floats, radius: float) -> float:
    """Return how far a chain is from a circle."""
    return float(np.abs(np.hypot(*(chain.points - middle).T) - radius).max())


def _fitted(chain: Chain) -> tuple[Floats, float]:
    """Return middle and radius of the circle by least squares; its middle is on the axes at which the chain ends."""
    points = chain.points
    shift = points.mean(axis=0)
    rows = [np.column_stack([2 * (points - shift), np.ones(len(points))])]
    values = [((points - shift) ** 2).sum(axis=1)]
    for axis in chain.ends:
        if axis is not None:
            rows.append(1e6 * np.array([[*axis.normal, 0.0]]))
            values.append(1e6 * np.array([float(axis.normal @ (axis.place - shift))]))
    x, y, rest = np.linalg.lstsq(np.concatenate(rows), np.concatenate(values), rcond=None)[0]
    return np.array([x, y]) + shift, math.sqrt(rest + x * x + y * y)


def regular_lines(chain: Chain, circle: Circle, sides: int, *, flat: bool) -> list[Line]:
    """Return the lines of a regular polygon for a circle; ``flat``: a side lies across its first axis, or below."""
    start = chain.ends[0]
    half = math.pi / sides
    upright = start.angle if start is not None else math.pi / 2
    phase = upright if flat else upright + half
    cosine = math.cos(half)
    away = 2 * circle.radius * cosine / (1 + cosine)
    turns = np.unwrap(np.arctan2(*(chain.points - circle.middle).T[::-1]))
    ahead = 1.0 if turns[-1] > turns[0] else -1.0
    number = np.round((turns - phase) / (2 * half)).astype(int)
    lines: list[Line] = []
    inward = ahead  # the left of a chain that runs to the left is the inside
    bounds = [0, *(np.flatnonzero(np.diff(number)) + 1).tolist(), len(number) - 1]
    for a, b in pairwise(bounds):
        if b <= a:
            continue
        angle = phase + 2 * half * int(number[a])
        out = np.array([math.cos(angle), math.sin(angle)])
        normal = -inward * out
        lines.append(Line(a, b, normal, float(normal @ circle.middle) - inward * away))
    if chain.is_closed and len(lines) > 1 and np.allclose(lines[0].normal, lines[-1].normal):
        last, here = lines.pop(), lines[0]
        lines[0] = Line(last.start, here.end, here.normal, here.offset)
    return lines
