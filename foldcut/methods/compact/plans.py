"""Plans: the discrete choices with which a walk around an outline begins.

``Outline`` -> ``Plan`` after ``Plan`` -> ``Turns``.

A plan says which pockets are turned (see ``turns``) and where the root is. All corners are crests except the reflex
corners of turned pockets, and except the root, which is always a dip.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Bools
from foldcut.methods.compact.outline import Outline
from foldcut.methods.compact.turns import Turns


@dataclass(frozen=True, eq=False)
class Plan:
    """Which corners are crests, ``crests`` ``(n,)``, and where the root is: at a corner or on a side, ``root``.

    ``turned``: the turned pockets, as bits; ``careful``: see ``Turns``.
    """

    crests: Bools
    root: int
    at_corner: bool
    turned: int
    careful: bool = True

    @classmethod
    def make(cls, outline: Outline, turned: int, root: int, *, at_corner: bool, careful: bool) -> Plan | None:
        """Return the plan with these choices, or None if the turns beside the root would not be crests."""
        pockets = outline.pockets | np.roll(outline.pockets, 1)
        crests = ~(outline.reflex & (pockets & turned != 0))
        after = (root + 1) % len(crests)
        if at_corner:
            crests[root] = False
            if not (crests[root - 1] and crests[after]):
                return None
        elif not (crests[root] and crests[after]):
            return None
        return cls(crests, root, at_corner, turned, careful)

    @property
    def choices(self) -> tuple[int, int, bool, bool]:
        """What tells the plan from other plans of the same outline."""
        return self.turned, self.root, self.at_corner, self.careful

    def turns(self) -> Turns:
        """Return the fewest turns that the plan needs."""
        return Turns.build(self.crests, self.root, at_corner=self.at_corner, turned=self.turned, careful=self.careful)


def plans(outline: Outline, *, turned: bool) -> Iterator[Plan]:
    """Yield plans with no pocket turned; or if ``turned``, those with all pockets turned and with one.

    Plans with the root at the sides that vanish last in the straight skeleton come first.
    """
    bits = outline.pocket_bits
    modes = [0]
    if turned:
        modes = [sum(bits), *bits] if len(bits) > 1 else bits
    heights = np.zeros(len(outline.loop))
    for side, nodes in enumerate(outline.nodes):
        heights[side] = max((node.height for node in nodes), default=0.0)
    for side in np.argsort(-heights, kind="stable").tolist():
        for mode in modes:
            for careful in (True, False) if mode else (True,):
                for at_corner in (False, True):
                    plan = Plan.make(outline, mode, side, at_corner=at_corner, careful=careful)
                    if plan is not None:
                        yield plan


def neighbours(outline: Outline, plan: Plan) -> Iterator[Plan]:
    """Yield the plans that differ from ``plan`` in one pocket: it is turned, or no longer turned."""
    for bit in outline.pocket_bits:
        for careful in (True, False):
            other = Plan.make(outline, plan.turned ^ bit, plan.root, at_corner=plan.at_corner, careful=careful)
            if other is not None:
                yield other
