"""The turns of a walk around a shape, and where they land on the cut line.

An outline and a plan -> ``Turns``; with the images that the linear program finds -> ``Solution`` -> ``Walk``.

In the folded state the outline of the shape runs to and fro along the cut line. Call the coordinate along the cut line
x. A *turn* is a point of the outline where it changes direction: at a *crest* x is largest, at a *dip* it is smallest,
and crests and dips alternate. Every corner of the shape is a turn. All other turns are points on sides, from which a
perpendicular crease goes up. The *image* of a turn is the x where it lands. Turn 0, where the walk begins and ends, is
the *root*: a dip, and no other dip is lower.

Joining equal x across the dips makes the walk a planar tree whose leaves are the crests. In a *turned* pocket, the
outside is folded along the other tree instead, which is joined across the crests and has the dips for leaves.

Source: Lang's tree method (*Origami Design Secrets*, chapter 11).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from foldcut.core.arrays import Bools, Floats, Numbers
from foldcut.methods.compact.outline import Outline
from foldcut.methods.compact.pattern import Walk


@dataclass(frozen=True, eq=False)
class Turns:
    """The turns of a walk around an outline, counter-clockwise from the root.

    ``side`` ``(n,)``: the side that a turn lies on, or for a corner the side that begins there. ``corner``, ``crest``
    ``(n,)``: which turns are corners, and which are crests. ``turned``: the turned pockets, as bits. ``careful``:
    whether the linear program and the molecules take account of corners that keep falling or rising, see
    ``Turns.levels``; without that the pattern may be simpler, or not fold at all.
    """

    side: Numbers
    corner: Bools
    crest: Bools
    turned: int = 0
    careful: bool = True

    def __len__(self) -> int:
        return len(self.side)

    @classmethod
    def build(cls, corner_crests: Bools, root: int, *, at_corner: bool, turned: int = 0, careful: bool = True) -> Turns:
        """Return the fewest turns for which the corners ``corner_crests`` are crests and all others are dips.

        The root is the corner ``root`` if ``at_corner``, else the turn on the side ``root``.
        """
        side, corner = [], []
        count = len(corner_crests)
        for s in range(count):
            side.append(s)
            corner.append(True)
            if corner_crests[s] == corner_crests[(s + 1) % count]:
                side.append(s)
                corner.append(False)
        sides, corners = np.array(side), np.array(corner)
        crests = np.where(corners, corner_crests[sides], ~corner_crests[sides])
        first = int(np.flatnonzero((sides == root) & (corners == at_corner))[0])
        return cls(np.roll(sides, -first), np.roll(corners, -first), np.roll(crests, -first), turned, careful)

    def inserted(self, at: int) -> Turns:
        """Return the turns with two more after turn ``at``, on the same side."""
        kind = self.crest[at]
        side = np.insert(self.side, at + 1, [self.side[at]] * 2)
        corner = np.insert(self.corner, at + 1, [False, False])
        return replace(self, side=side, corner=corner, crest=np.insert(self.crest, at + 1, [not kind, kind]))

    def removed(self, at: int) -> Turns:
        """Return the turns without turns ``at`` and ``at + 1``; neither may be a corner or the root."""
        keep = np.ones(len(self), dtype=bool)
        keep[[at, at + 1]] = False
        return replace(self, side=self.side[keep], corner=self.corner[keep], crest=self.crest[keep])

    def places(self, outline: Outline, along: Floats) -> Floats:
        """Where the turns are, ``(n, 2)`` mm, given how far ``along`` its side each one is, ``(n,)`` mm."""
        places: Floats = outline.loop[self.side] + outline.direction[self.side] * along[:, None]
        return places

    def pockets(self, outline: Outline) -> Numbers:
        """The pockets that each turn borders, as bits, ``(n,)``."""
        pockets = outline.pockets[self.side]
        return np.where(self.corner, pockets | outline.pockets[self.side - 1], pockets)

    def levels(self, outline: Outline) -> Floats:
        """How far the turns move outwards after the border, ``(2, n)`` mm: inside and outside; 0 unless ``careful``.

        Inside, a reflex corner that is a dip *falls*: its image moves to smaller x as the molecule grows, because the
        sides at it get longer. Outside, a convex corner that is a crest *rises*. A gusset crease that wraps such a
        corner has to land beyond all x that the corner ever reaches.
        """
        if not self.careful:
            return np.zeros((2, len(self)))
        inside = np.where(self.corner & ~self.crest, -outline.falls[self.side], 0.0)
        outside = np.where(self.corner & self.crest, outline.rises[self.side], 0.0)
        return np.stack([inside, outside])


@dataclass(frozen=True, eq=False)
class Solution:
    """Where turns are and land.

    ``x``: their images; ``along``: how far along their sides they are; ``left_out``: how much of the outline is left
    out after each of them; all ``(n,)`` mm. ``clearance``: the one asked for, see ``Program.solve``.
    """

    turns: Turns
    x: Floats
    along: Floats
    left_out: Floats
    clearance: float

    def walk(self, outline: Outline) -> Walk:
        """Return the walk; nothing may be left out."""
        turns = self.turns
        points, pockets = turns.places(outline, self.along), turns.pockets(outline)
        levels = self.x + turns.levels(outline)
        return Walk(points, self.x, turns.crest, outline.direction[turns.side], pockets, levels, turns.turned)
