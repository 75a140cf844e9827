"""Straight lines in the plane: sides joined along them, and the lines along which a drawing may be folded.

Sides -> ``merged_sides``; sides and the paper around them -> ``fold_lines``.

Every fold of a shortest sequence brings two lines with sides of the drawing together. So it is one of the two lines
that bisect them, or the one midway between them if they are parallel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from shapely import affinity
from shapely.geometry.base import BaseGeometry

from foldcut.core.arrays import Bools, Floats, Indices, blocks
from foldcut.geometry.vectors import cross, left_normal

__all__ = ["Line", "fold_lines", "line_of", "merged_sides"]

PARALLEL = 1e-7
"""Lines whose unit normals differ by less are parallel, so that only the line midway between them is a bisector."""

NEARLY_PARALLEL = 1e-6
"""The same for a direction that is asked for."""

AT_A_TIME = 1 << 18
"""The number of pairs of a line and a side that are looked at together; it bounds the memory, not the result."""


@dataclass(frozen=True, eq=False)
class Line:
    """A straight line through ``origin`` ``(2,)`` in the direction ``along`` ``(2,)``, a unit vector."""

    origin: Floats
    along: Floats

    @property
    def reverse(self) -> Line:
        """The same line the other way, so that left and right change."""
        return Line(self.origin, -self.along)

    def off(self, points: Floats) -> Floats:
        """Return how far points ``(..., 2)`` are to the left of the line."""
        return cross(self.along, points - self.origin)

    def half_plane(self, reach: float) -> tuple[BaseGeometry, BaseGeometry]:
        """Return squares to the left and to the right of the line, their sides ``2 * reach`` long."""
        ahead, aside = reach * self.along, 2 * reach * left_normal(self.along)
        ends = [self.origin - ahead, self.origin + ahead]
        left, right = (shapely.Polygon([*ends, ends[1] + s * aside, ends[0] + s * aside]) for s in (1, -1))
        return left, right

    def mirror(self, points: Floats) -> Floats:
        """Return the mirror images of points ``(..., 2)``."""
        away = points - self.origin
        return np.asarray(self.origin + 2 * (away @ self.along)[..., None] * self.along - away)

    def mirrored(self, geometry: BaseGeometry) -> BaseGeometry:
        """Return the mirror image of a geometry."""
        cosine, sine = 2 * self.along[0] ** 2 - 1, 2 * self.along[0] * self.along[1]
        shift = self.mirror(np.zeros(2))
        return affinity.affine_transform(geometry, [cosine, sine, sine, -cosine, *shift])

    def folded(self, sides: Floats, origins: Indices, tie: float) -> tuple[Floats, Indices]:
        """Return sides ``(n, 2, 2)`` after what is to the right of the line has been turned over.

        Those across it are divided. ``origins`` ``(n,)`` go with them.
        """
        off = self.off(sides)
        off = np.where(np.abs(off) <= tie, 0.0, off)
        across = off[:, 0] * off[:, 1] < 0
        share = (off[across, 0] / (off[across, 0] - off[across, 1]))[:, None]
        middle = sides[across, 0] * (1 - share) + sides[across, 1] * share
        pieces = np.concatenate(
            [
                sides[~across],
                np.stack([sides[across, 0], middle], axis=1),
                np.stack([middle, sides[across, 1]], axis=1),
            ]
        )
        right = np.concatenate([off[~across].min(axis=1), off[across, 0], off[across, 1]]) < 0
        pieces[right] = self.mirror(pieces[right])
        return pieces, np.concatenate([origins[~across], origins[across], origins[across]])


def line_of(start: Floats, end: Floats) -> Line:
    """Return the line through two points."""
    return Line(start, (end - start) / np.hypot(*(end - start)))


def merged_sides(sides: Floats, origins: Indices, tie: float) -> tuple[Floats, Indices, Indices]:
    """Join sides ``(n, 2, 2)`` that lie on each other, or go on straight, within ``tie``.

    Returns the sides, the number of the line that each is on, and the least of the ``origins`` of each.
    """
    along = sides[:, 1] - sides[:, 0]
    length = np.hypot(*along.T)
    left = length > tie
    joined: list[Floats] = []
    lines: list[int] = []
    first: list[int] = []
    count = 0
    while left.any():
        longest = int(np.where(left, length, 0).argmax())
        line = line_of(*sides[longest])
        on = left & (np.abs(line.off(sides)) <= 2 * tie).all(axis=1)
        on[longest] = True
        left &= ~on
        at = np.sort((sides[on] - line.origin) @ line.along, axis=1)
        order = np.lexsort((at[:, 1], at[:, 0]))
        numbers = origins[on][order].tolist()
        spans: list[tuple[float, float, int]] = []
        for (low, high), number in zip(at[order].tolist(), numbers, strict=True):
            if spans and low <= spans[-1][1] + tie:
                start, end, one = spans[-1]
                spans[-1] = start, max(end, high), min(one, number)
            else:
                spans.append((low, high, number))
        for low, high, number in spans:
            joined.append(line.origin + np.array([[low], [high]]) * line.along)
            lines.append(count)
            first.append(number)
        count += 1
    return np.array(joined).reshape(-1, 2, 2), np.array(lines, dtype=np.intp), np.array(first, dtype=np.intp)


def fold_lines(
    sides: Floats, line: Indices, paper: BaseGeometry, tie: float, direction: Floats | None = None
) -> list[Line]:
    """Return the lines that bring two lines of sides together and may be folded, as far as the sides tell.

    ``line`` ``(n,)``: the number of the straight line that each of the ``sides`` ``(n, 2, 2)`` is on. A side that a
    fold crosses is at right angles to it or ends there, and no side lies along it. Those that bring most lines together
    come first. ``direction``, a unit vector: only those that are parallel to it.
    """
    origin, along = _bisectors(sides, line)
    if direction is not None:
        parallel = np.abs(cross(along, direction)) < NEARLY_PARALLEL
        origin, along = origin[parallel], along[parallel]
    corners = shapely.get_coordinates(shapely.convex_hull(paper))
    off = cross(along[:, None], corners - origin[:, None])
    on_paper = (off.max(axis=1) > 4 * tie) & (off.min(axis=1) < -4 * tie)
    origin, along = origin[on_paper], along[on_paper]
    good = np.ones(len(origin), dtype=np.bool_)
    for some in blocks(len(origin), max(1, AT_A_TIME // len(sides))):
        good[some] = _may_fold(sides, origin[some], along[some], tie)
    return _different(origin[good], along[good], tie, corners)


def _may_fold(sides: Floats, origin: Floats, along: Floats, tie: float) -> Bools:
    """Return which lines through ``origin`` have sides on both sides of them and cross none but at right angles.

    They may go through ends of sides, but not along a side.
    """
    off = cross(along[:, None, None], sides - origin[:, None, None])
    reach = ((sides[:, 1] - sides[:, 0]) * along[:, None]).sum(axis=2)
    on = np.abs(off) <= 2 * tie
    across = (off[..., 0] * off[..., 1] < 0) & ~on.any(axis=2)
    wrong = on.all(axis=2) | (across & (np.abs(reach) > 4 * tie))
    between = (off.max(axis=(1, 2)) > 2 * tie) & (off.min(axis=(1, 2)) < -2 * tie)
    good: Bools = between & ~wrong.any(axis=1)
    return good


def _bisectors(sides: Floats, line: Indices) -> tuple[Floats, Floats]:
    """Return the lines that bisect two of the lines of sides each, or lie midway between them if they are parallel.

    The result is the point of each that is nearest to the sides' middle, and its unit direction, ``(m, 2)``.
    """
    middle = sides.reshape(-1, 2).mean(axis=0)
    length = np.hypot(*(sides[:, 1] - sides[:, 0]).T)
    order = np.lexsort((-length, line))
    longest = order[np.unique(line[order], return_index=True)[1]]
    normal = left_normal(sides[longest, 1] - sides[longest, 0]) / length[longest][:, None]
    level = (normal * (sides[longest, 0] - middle)).sum(axis=1)
    a, b = np.triu_indices(len(longest), 1)
    # where a place is as far off one line as off the other, to the same side or to different ones
    across = np.concatenate([normal[a] + normal[b], normal[a] - normal[b]])
    levels = np.concatenate([level[a] + level[b], level[a] - level[b]])
    size = np.hypot(*across.T)
    across, levels, size = across[size > PARALLEL], levels[size > PARALLEL], size[size > PARALLEL]
    across = across / size[:, None]
    return middle + (levels / size)[:, None] * across, left_normal(across)


def _different(origin: Floats, along: Floats, tie: float, corners: Floats) -> list[Line]:
    """Return lines once each, those first that are there most often."""
    along = np.where((along[:, :1] < -1e-9) | ((np.abs(along[:, :1]) <= 1e-9) & (along[:, 1:] < 0)), -along, along)
    low, high = corners.min(axis=0), corners.max(axis=0)
    # two lines are the same on the paper if they are so at two places of it
    off = np.stack([cross(along, place - origin) for place in (low, high, np.array([low[0], high[1]]))], axis=1)
    found: list[list[int]] = []
    for number in range(len(origin)):
        for same in found:
            if (np.abs(off[number] - off[same[0]]) <= 4 * tie).all():
                same.append(number)
                break
        else:
            found.append([number])
    found.sort(key=lambda same: -len(same))
    return [Line(origin[same[0]], along[same[0]]) for same in found]
