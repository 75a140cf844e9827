"""Turns that always fit: the boundary is covered with disks that keep apart, all on one hub.

Outline -> ``Solution``, with many turns. For shapes that are too much for the linear programs of ``zigzag``.

Vertex disks take nearly half the way to the nearest other side; stretches between them are halved until no two disks
come near each other. Source: paper section 2.
"""

from __future__ import annotations

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, Numbers
from foldcut.core.errors import UnfoldableError
from foldcut.methods.compact.turns import Outline, Solution, Turns

MOST_DISKS = 30_000


def crowded_solution(outline: Outline, clearance: float, shrink: Floats | float = 0.0) -> Solution:
    """Cover the boundary with disks; ``shrink`` makes vertex disks smaller by these parts.

    Raises ``UnfoldableError`` with the place of a feature that needs too many.
    """
    loop, length = outline.loop, outline.length
    count = len(loop)
    row = np.arange(count)
    shorter = np.minimum(length, np.roll(length, 1))
    radius = (1 - shrink) * (0.5 - clearance) * np.minimum(_away(outline, shorter), shorter)
    side = row
    ends = np.stack([radius, length - np.roll(radius, -1)], axis=1)
    while (crowded := _crowded(outline, side, ends, radius, clearance)).any():
        if len(side) > MOST_DISKS:
            x, y = loop[side[int(np.diff(ends).argmin())]]
            raise UnfoldableError(
                f"a feature near ({x:.2f}, {y:.2f}) mm is so fine that over {MOST_DISKS} disks would be needed; "
                "simplify the drawing there"
            )
        middle = ends.mean(axis=1)
        halves = np.stack([ends, ends], axis=1)
        halves[:, 0, 1] = halves[:, 1, 0] = middle
        keep = np.stack([np.ones(len(side), dtype=bool), crowded], axis=1)
        halves[~crowded, 0] = ends[~crowded]
        side, ends = np.repeat(side, 1 + crowded), halves[keep]
    # a peak at every disk's centre, a valley where it touches the next
    parts = np.split(ends, np.searchsorted(side, row[1:]))
    centres = [np.append(0.0, part.mean(axis=1)) for part in parts]
    radii = [np.append(radius[s], np.diff(part)[:, 0] / 2) for s, part in enumerate(parts)]
    sides = np.concatenate([np.full(2 * len(c), s) for s, c in enumerate(centres)])
    along = np.concatenate([np.stack([c, c + r], axis=1).ravel() for c, r in zip(centres, radii, strict=True)])
    x = np.concatenate([np.stack([r, np.zeros_like(r)], axis=1).ravel() for r in radii])
    peak = np.arange(len(x)) % 2 == 0
    corner = (along == 0.0) & peak
    sides, along, x, peak, corner = (np.roll(column, -1) for column in (sides, along, x, peak, corner))
    return Solution(Turns(sides, corner, peak), x, along, np.zeros(len(x)), clearance)


def _away(outline: Outline, near: Floats) -> Floats:
    """How far each corner is from the nearest side that does not end in it, ``(n,)``; only what is ``near`` is sure."""
    loop = outline.loop
    count = len(loop)
    sides = shapely.linestrings(np.stack([loop, np.roll(loop, -1, axis=0)], axis=1))
    reach = near * (1 + 1e-9)
    corner, side = shapely.STRtree(sides).query(shapely.points(loop), predicate="dwithin", distance=reach)
    other = (side != corner) & (side != (corner - 1) % count)
    corner, side = corner[other], side[other]
    to_corner = loop[corner] - loop[side]
    part = np.clip(np.sum(to_corner * outline.direction[side], axis=1), 0, outline.length[side])
    away = np.full(count, np.inf)
    np.minimum.at(away, corner, np.hypot(*(to_corner - part[:, None] * outline.direction[side]).T))
    return away


def _crowded(outline: Outline, side: Numbers, ends: Floats, radius: Floats, clearance: float) -> Bools:
    """Which stretches have a disk that comes near another, no larger one, of another side."""
    loop = outline.loop
    count = len(loop)
    middle = loop[side] + outline.direction[side] * ends.mean(axis=1)[:, None]
    half = np.diff(ends)[:, 0] / 2
    centres, radii = np.concatenate([middle, loop]), np.concatenate([half, radius])
    x, y = centres.T
    reach = radii / (1 - 2 * clearance) * (1 + 1e-9)
    boxes = shapely.box(x - reach, y - reach, x + reach, y + reach)
    i, j = shapely.STRtree(boxes).query(boxes[: len(side)])
    apart = centres[i] - centres[j]
    near = np.hypot(*apart.T) * (1 - 2 * clearance) < radii[i] + radii[j]
    # disks of one side, its corners' among them, do not crowd each other
    first = np.concatenate([side, np.arange(count)])
    second = np.concatenate([side, (np.arange(count) - 1) % count])
    same = (first[i] == first[j]) | (first[i] == second[j]) | (second[i] == first[j]) | (second[i] == second[j])
    larger = (radii[i] >= radii[j] * (1 - 1e-9)) | (j >= len(side))
    crowded = np.zeros(len(side), dtype=bool)
    crowded[i[near & ~same & larger]] = True
    return crowded
