"""Pairs of turns that see each other: their distance on the sheet, and the length of their path in the tree.

Outline, ``Turns`` and where they are along their sides -> ``Pairs``.

A molecule closes only if any two turns that see each other, inside or outside, are at least as far apart on the sheet
as in the tree that the molecule is folded along. For turns i and j the path in the tree has the length
x_i + x_j - 2 x_m, where m is the lowest turn between them on the side away from the root; in a turned pocket it has
the length 2 x_m - x_i - x_j, where m is the highest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely

from foldcut.core.arrays import Bools, Floats, Numbers
from foldcut.geometry.vectors import cross
from foldcut.methods.compact.outline import Outline
from foldcut.methods.compact.turns import Turns

LATER = (0.2, 0.45, 0.7, 0.93)
"""Heights at which corners that keep falling are checked, as parts of the longest life of such a corner."""

SEEN = 1e-9
"""By how many radians a line of sight has to clear the sides at its ends."""

BLOCK = 4096
"""How many lines of sight are compared with all sides at once; this bounds the memory."""


@dataclass(frozen=True, eq=False)
class Pairs:
    """Pairs of turns ``i`` < ``j``, ``(m,)``, that see each other.

    ``turned`` ``(m,)``: which pairs see each other in a turned pocket; ``distance`` ``(m,)`` mm on the sheet;
    ``direction`` ``(m, 2)``: unit vectors from j to i. For pairs at a later height, ``shift`` ``(n,)`` mm is how far
    the image of each turn has moved by then, and ``still`` ``(n,)`` tells which turns still fall or rise.
    """

    i: Numbers
    j: Numbers
    turned: Bools
    distance: Floats
    direction: Floats
    shift: Floats | None = None
    still: Bools | None = None


def visible_pairs(outline: Outline, turns: Turns, along: Floats) -> Pairs:
    """Return the pairs of turns that see each other and may be too near, with turns ``along`` ``(n,)`` mm their sides.

    Pairs that other pairs imply are not among them.
    """
    place, pockets = turns.places(outline, along), turns.pockets(outline)
    i, j = np.triu_indices(len(turns), 1)
    inside, outside = sees_each_other(outline, place, turns, i, j)
    turned = outside & (pockets[i] & pockets[j] & turns.turned != 0)
    leaf = turns.crest | turns.corner
    leaf[0] = True
    leaf_of_turned = turns.corner | ~turns.crest
    inner = inside & leaf[i] & leaf[j]
    outer = outside & np.where(turned, leaf_of_turned[i] & leaf_of_turned[j], leaf[i] & leaf[j])
    i, j = np.concatenate([i[inner], i[outer]]), np.concatenate([j[inner], j[outer]])
    turned = np.concatenate([np.zeros(int(inner.sum()), dtype=bool), turned[outer]])
    distance, direction = _apart(place, i, j)
    return Pairs(i, j, turned, distance, direction)


def later_pairs(outline: Outline, turns: Turns, along: Floats) -> list[Pairs]:
    """Return pairs at some later heights, where a crease between them may wrap a corner that keeps falling.

    Inside, reflex corners that are dips fall; in turned pockets, convex corners that are crests rise. No gusset may end
    in such a corner while it moves.
    """
    place, pockets = turns.places(outline, along), turns.pockets(outline)
    bend = np.where(turns.corner, outline.turning[turns.side], 0.0)
    up = np.where(turns.crest, 1.0, -1.0)
    arriving = outline.direction[np.where(turns.corner, turns.side - 1, turns.side)]
    middle = arriving + outline.direction[turns.side]
    middle /= np.maximum(np.hypot(*middle.T), 1e-9)[:, None]
    sideways = np.stack([-middle[:, 1], middle[:, 0]], axis=-1) / np.cos(bend / 2)[:, None]
    first, second = np.triu_indices(len(turns), 2)
    found = []
    for outside in (False, True):
        sign = -1.0 if outside else 1.0
        shrink = np.tan(sign * bend / 2)
        falling = turns.corner & (turns.crest if outside else ~turns.crest) & (shrink < 0)
        if outside:
            falling &= pockets & turns.turned != 0
        if not falling.any():
            continue
        lives = (outline.outside_lives if outside else outline.inside_lives)[0]
        life = np.where(turns.corner, lives[turns.side], np.inf)
        longest = min(float(np.max(life[falling])), outline.size / 2)
        leaf = (~turns.crest if outside else turns.crest) | turns.corner
        leaf[0] = True
        some = leaf[first] & leaf[second]
        if outside:
            some &= pockets[first] & pockets[second] & turns.turned != 0
        for part in LATER:
            height = part * longest
            then = place + sign * sideways * height
            i, j = first[some], second[some]
            lines = shapely.linestrings(np.stack([then[i], then[j]], axis=1))
            seen = shapely.covers(outline.front(height, outside), lines)
            i, j = i[seen], j[seen]
            distance, direction = _apart(then, i, j)
            still = falling & (life >= height)
            found.append(Pairs(i, j, np.full(len(i), outside), distance, direction, -up * shrink * height, still))
    return found


def _apart(place: Floats, i: Numbers, j: Numbers) -> tuple[Floats, Floats]:
    """The distances of pairs, and the unit vectors from j to i."""
    apart = place[i] - place[j]
    distance: Floats = np.hypot(apart[:, 0], apart[:, 1])
    return distance, apart / np.maximum(distance, 1e-300)[:, None]


def tree_paths(x: Floats, pairs: Pairs, levels: Floats) -> tuple[Numbers, Floats]:
    """Return for each pair the turn where its path in the tree turns back, and the length of the path, ``(m,)`` each.

    ``x`` ``(n,)`` mm: the images of the turns; ``levels`` ``(2, n)`` mm: see ``Turns.levels``. The length is -inf where
    a path turns back at one of its own ends while that keeps falling: ``later_pairs`` bound those.
    """
    count = len(x)
    steps = np.arange(count)
    low, high = x + levels[0], x + levels[1]
    if pairs.shift is not None:
        low = high = x
    ahead = steps >= steps[:, None]
    way = np.where(ahead, low, np.inf)
    lowest = np.maximum.accumulate(np.where(way <= np.minimum.accumulate(way, axis=1), steps, 0), axis=1)
    highest = lowest
    if pairs.turned.any():
        way = np.where(ahead, high, -np.inf)
        highest = np.maximum.accumulate(np.where(way >= np.maximum.accumulate(way, axis=1), steps, 0), axis=1)
    at = np.where(pairs.turned, highest[pairs.i, pairs.j], lowest[pairs.i, pairs.j])
    # the root is at both ends of the walk; in a turned pocket the shorter way to it counts
    from_root = pairs.turned & (pairs.i == 0)
    if from_root.any():
        back = np.maximum.accumulate(np.where(high[::-1] >= np.maximum.accumulate(high[::-1]), steps, 0))
        other = count - 1 - back[count - 1 - pairs.j]
        at = np.where(from_root & (high[other] < high[at]), other, at)
    level = np.where(pairs.turned, high[at], low[at])
    path = x[pairs.i] + x[pairs.j] - 2 * level
    path = np.where(pairs.turned, -path, path)
    own = ((at == pairs.i) | (at == pairs.j)) & (np.abs(level - x[at]) > 0)
    return at, np.where(own, -np.inf, path)


def sees_each_other(outline: Outline, place: Floats, turns: Turns, i: Numbers, j: Numbers) -> tuple[Bools, Bools]:
    """Tell whether the segments between turns i and j lie inside the outline, and whether outside, ``(m,)`` each."""
    count = len(outline.loop)
    side = turns.side
    before = np.where(turns.corner, (side - 1) % count, side)
    leaving = outline.direction[side]
    opening = np.where(turns.corner, math.pi - outline.turning[side], math.pi)

    def looks(a: Numbers, line: Floats) -> tuple[Bools, Bools]:
        angle = np.arctan2(cross(leaving[a], line), (leaving[a] * line).sum(axis=1)) % (2 * math.pi)
        return (angle > SEEN) & (angle < opening[a] - SEEN), (angle > opening[a] + SEEN) & (angle < math.tau - SEEN)

    line = place[j] - place[i]
    (in_i, out_i), (in_j, out_j) = looks(i, line), looks(j, -line)
    inside, outside = in_i & in_j, out_i & out_j
    candidates = np.flatnonzero(inside | outside)
    start, along = outline.loop, outline.along
    row = np.arange(count)
    for n in range(0, len(candidates), BLOCK):
        some = candidates[n : n + BLOCK]
        a, b = i[some], j[some]
        ray = line[some][:, None]
        scale = 1e-10 * np.hypot(*line[some].T)[:, None] * outline.length
        from_start = cross(ray, start[None] - place[a][:, None])
        from_end = from_start + cross(ray, along[None])
        near = cross(along[None], place[a][:, None] - start[None])
        far = near + cross(along[None], ray)
        meets = (from_start * from_end <= scale**2) & (near * far <= scale**2)
        meets &= (np.abs(from_start) > scale) | (np.abs(from_end) > scale)  # a side on one line with the ray does not
        own = (row == side[a][:, None]) | (row == side[b][:, None]) | (row == before[a][:, None])
        own |= row == before[b][:, None]
        blocked = (meets & ~own).any(axis=1)
        inside[some] &= ~blocked
        outside[some] &= ~blocked
    return inside, outside
