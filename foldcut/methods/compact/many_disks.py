"""Turns that always suffice: the outline is covered with many small disks, as in the publication's method.

``Outline`` -> ``Solution`` with many turns, for shapes that are too large for linear programs.

The crests are the centres of the disks, and the dips are where neighbouring disks touch. All dips are at x = 0, so the
tree is a star: all flaps meet in one hub. The disk at a corner reaches nearly half the way to the nearest other side;
the stretches of sides between these are halved until no two disks come near each other.

Source: paper section 2.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, Numbers
from foldcut.core.errors import UnfoldableError
from foldcut.methods.compact.outline import Outline
from foldcut.methods.compact.trials import Attempt
from foldcut.methods.compact.turns import Solution, Turns

MOST_DISKS = 30_000
"""How many disks on sides are enough for any shape that can be folded."""

NOISES = (0.0, 0.01, 0.03, 0.06)
"""By what parts corner disks are made smaller at random, at most, until the molecules close."""

MENDS = 10
"""How often, for each of these, disks are made smaller where events nearly coincide."""

SHAKEN = 0.15
"""By what part, at most, the disks are made smaller from which such events come."""

SHAKEN_AGAIN = 0.6
"""The same for disks for which that has not been enough."""

NEAR = 1e-9
"""By what part distances and radii are enlarged or reduced, so that rounding hides no disk that is near."""


def fold_many_disks(
    outline: Outline, clearance: float, random: np.random.Generator, attempt: Callable[[Solution], Attempt]
) -> None:
    """Try solutions with many disks until one folds, or give up.

    ``clearance``: see ``Program.solve``; ``attempt`` folds a solution, and tells where that fails. Raises
    ``UnfoldableError`` with the place of a feature that needs too many disks.
    """
    count = len(outline.loop)
    for noisy in NOISES:
        # where a shape is symmetric, events coincide exactly, and a molecule may not close: a little noise helps
        shrink, shaken = noisy * random.random(count), np.full(count, SHAKEN)
        for _ in range(MENDS):
            solution = many_disks(outline, clearance, shrink)
            tried = attempt(solution)
            if tried.folds:
                return
            if not tried.stretches or (tried.open and not noisy):
                break
            # among very many events some happen to nearly coincide: change the disks that they come from, and no others
            corners = np.unique(solution.turns.side[list(tried.stretches)])
            shrink[corners] = shaken[corners] * random.random(len(corners))
            shaken[corners] = SHAKEN_AGAIN


def many_disks(outline: Outline, clearance: float, shrink: Floats | float = 0.0) -> Solution:
    """Cover the outline with disks; make those at corners smaller by the parts ``shrink``, ``(n,)``.

    Raises ``UnfoldableError`` with the place of a feature that needs too many disks.
    """
    loop, length = outline.loop, outline.length
    shorter = np.minimum(length, np.roll(length, 1))
    radius = (1 - shrink) * (0.5 - clearance) * np.minimum(corner_distances(outline, shorter), shorter)
    side, ends = np.arange(len(loop)), np.stack([radius, length - np.roll(radius, -1)], axis=1)
    while (crowded := _crowded(outline, side, ends, radius, clearance)).any():
        if len(side) > MOST_DISKS:
            x, y = loop[side[int(np.diff(ends).argmin())]]
            raise UnfoldableError(
                f"a feature near ({x:.2f}, {y:.2f}) mm is so fine that over {MOST_DISKS} disks would be needed; "
                "simplify the drawing there"
            )
        side, ends = _halved(side, ends, crowded)
    return _touching(outline, side, ends, radius, clearance)


def _halved(side: Numbers, ends: Floats, some: Bools) -> tuple[Numbers, Floats]:
    """Halve some of the stretches, which are from one of their ``ends`` ``(m, 2)`` to the other along sides."""
    middle = ends.mean(axis=1)
    halves = np.stack([ends, ends], axis=1)
    halves[:, 0, 1] = halves[:, 1, 0] = middle
    halves[~some, 0] = ends[~some]
    keep = np.stack([np.ones(len(side), dtype=bool), some], axis=1)
    return np.repeat(side, 1 + some), halves[keep]


def _touching(outline: Outline, side: Numbers, ends: Floats, radius: Floats, clearance: float) -> Solution:
    """The solution with a crest at the centre of each disk, and a dip where it touches the next."""
    parts = np.split(ends, np.searchsorted(side, np.arange(1, len(outline.loop))))
    centres = [np.append(0.0, part.mean(axis=1)) for part in parts]
    radii = [np.append(radius[s], np.diff(part)[:, 0] / 2) for s, part in enumerate(parts)]
    sides = np.concatenate([np.full(2 * len(c), s) for s, c in enumerate(centres)])
    along = np.concatenate([np.stack([c, c + r], axis=1).ravel() for c, r in zip(centres, radii, strict=True)])
    x = np.concatenate([np.stack([r, np.zeros_like(r)], axis=1).ravel() for r in radii])
    crest = np.arange(len(x)) % 2 == 0
    corner = (along == 0.0) & crest
    sides, along, x, crest, corner = (np.roll(column, -1) for column in (sides, along, x, crest, corner))
    # all corners are crests and no pocket is turned, so that no corner falls or rises
    return Solution(Turns(sides, corner, crest, careful=False), x, along, np.zeros(len(x)), clearance)


def corner_distances(outline: Outline, most: Floats) -> Floats:
    """Return how far each corner is from the nearest side that does not end in it, ``(n,)`` mm.

    Only sides no farther away than ``most`` ``(n,)`` mm are sure to be considered.
    """
    loop = outline.loop
    count = len(loop)
    sides = shapely.linestrings(np.stack([loop, np.roll(loop, -1, axis=0)], axis=1))
    reach = most * (1 + NEAR)
    corner, side = shapely.STRtree(sides).query(shapely.points(loop), predicate="dwithin", distance=reach)
    other = (side != corner) & (side != (corner - 1) % count)
    corner, side = corner[other], side[other]
    to_corner = loop[corner] - loop[side]
    part = np.clip(np.sum(to_corner * outline.direction[side], axis=1), 0, outline.length[side])
    distances = np.full(count, np.inf)
    np.minimum.at(distances, corner, np.hypot(*(to_corner - part[:, None] * outline.direction[side]).T))
    return distances


def _crowded(outline: Outline, side: Numbers, ends: Floats, radius: Floats, clearance: float) -> Bools:
    """Which stretches of sides have a disk that comes near a disk of another side that is no larger, or of a corner."""
    loop = outline.loop
    count = len(loop)
    middle = loop[side] + outline.direction[side] * ends.mean(axis=1)[:, None]
    half = np.diff(ends)[:, 0] / 2
    centres, radii = np.concatenate([middle, loop]), np.concatenate([half, radius])
    x, y = centres.T
    reach = radii / (1 - 2 * clearance) * (1 + NEAR)
    boxes = shapely.box(x - reach, y - reach, x + reach, y + reach)
    i, j = shapely.STRtree(boxes).query(boxes[: len(side)])
    apart = centres[i] - centres[j]
    near = np.hypot(*apart.T) * (1 - 2 * clearance) < radii[i] + radii[j]
    # the disks of one side do not crowd each other, nor those of the corners at its ends
    first = np.concatenate([side, np.arange(count)])
    second = np.concatenate([side, (np.arange(count) - 1) % count])
    same = (first[i] == first[j]) | (first[i] == second[j]) | (second[i] == first[j]) | (second[i] == second[j])
    larger = (radii[i] >= radii[j] * (1 - NEAR)) | (j >= len(side))
    crowded = np.zeros(len(side), dtype=bool)
    crowded[i[near & ~same & larger]] = True
    return crowded
