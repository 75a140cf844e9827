"""Turns that always fit: the boundary is covered with disks that keep apart, all on one hub.

Outline -> ``Solution``, with many turns. For shapes that are too much for the linear programs of ``zigzag``.

Vertex disks take nearly half the way to the nearest other side; stretches between them are halved until no two disks
come near each other. Source: paper section 2.
"""

from __future__ import annotations

import numpy as np

from foldcut.errors import UnfoldableError
from foldcut.model import Bools, Floats, Numbers
from foldcut.zigzag import Outline, Solution, Turns

MOST_DISKS = 1500


def crowded_solution(outline: Outline, clearance: float, shrink: Floats | float = 0.0) -> Solution:
    """Cover the boundary with disks; ``shrink`` makes vertex disks smaller by these parts.

    Raises ``UnfoldableError`` with the place of a feature that needs too many.
    """
    loop, length, direction = outline.loop, outline.length, outline.direction
    count = len(loop)
    to_corner = loop[:, None] - loop[None]
    part = np.clip(np.sum(to_corner * direction[None], axis=2), 0, length[None])
    away = np.hypot(*np.moveaxis(to_corner - part[:, :, None] * direction[None], 2, 0))
    row = np.arange(count)
    away[row, row] = away[row, row - 1] = np.inf
    radius = (1 - shrink) * (0.5 - clearance) * np.minimum(away.min(axis=1), np.minimum(length, np.roll(length, 1)))
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
    centres = [np.append(0.0, ends[side == s].mean(axis=1)) for s in row]
    radii = [np.append(radius[s], np.diff(ends[side == s])[:, 0] / 2) for s in row]
    sides = np.concatenate([np.full(2 * len(c), s) for s, c in enumerate(centres)])
    along = np.concatenate([np.stack([c, c + r], axis=1).ravel() for c, r in zip(centres, radii, strict=True)])
    x = np.concatenate([np.stack([r, np.zeros_like(r)], axis=1).ravel() for r in radii])
    peak = np.arange(len(x)) % 2 == 0
    corner = (along == 0.0) & peak
    sides, along, x, peak, corner = (np.roll(column, -1) for column in (sides, along, x, peak, corner))
    return Solution(Turns(sides, corner, peak), x, along, np.zeros(len(x)), clearance)


def _crowded(outline: Outline, side: Numbers, ends: Floats, radius: Floats, clearance: float) -> Bools:
    """Which stretches have a disk that comes near another, no larger one, of another side."""
    loop = outline.loop
    count = len(loop)
    middle = loop[side] + outline.direction[side] * ends.mean(axis=1)[:, None]
    half = np.diff(ends)[:, 0] / 2
    centres, radii = np.concatenate([middle, loop]), np.concatenate([half, radius])
    apart = centres[:, None] - centres[None]
    near = np.hypot(apart[:, :, 0], apart[:, :, 1]) * (1 - 2 * clearance) < radii[:, None] + radii[None]
    # disks of one side, its corners' among them, do not crowd each other
    first = np.concatenate([side, np.arange(count)])
    second = np.concatenate([side, (np.arange(count) - 1) % count])
    same = (first[:, None] == first) | (first[:, None] == second) | (second[:, None] == first)
    corner = np.arange(len(radii)) >= len(side)
    same |= (second[:, None] == second) & ~(corner[:, None] & corner)
    larger = (radii[:, None] >= radii[None] * (1 - 1e-9)) | corner[None]
    return np.asarray((near & ~same & larger).any(axis=1)[: len(side)])
