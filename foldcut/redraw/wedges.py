"""Redraw a drawing with three mirror axes or more through one point, and fold it as a wedge: snowflakes and rosettes.

``Drawing`` -> ``Around``, which yields outlines within a tolerance and folds them. The outline of one sector is fitted,
and its images make the rest of it (``starts.chains``), so that all axes are exact. A sector has few corners: all
outlines to begin with are folded, and none is searched further.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import chain

from foldcut.core.arrays import Floats
from foldcut.core.errors import FoldcutError
from foldcut.core.model import Shape, Sheet
from foldcut.geometry.dihedral import Dihedral, made_dihedral
from foldcut.methods.base import Made
from foldcut.methods.mirror.halves import CLOSED, closed_wedge
from foldcut.methods.mirror.skeletal import made_of_wedge
from foldcut.methods.mirror.wedge import Wedge
from foldcut.methods.skeleton.quick import fold_outline
from foldcut.pattern.first_folds import FEWEST_OF_WEDGE, fan_folds
from foldcut.redraw.plans import Drawing, Plan, on_the_sheet
from foldcut.redraw.starts import Axis, all_starts
from foldcut.redraw.symmetry import Symmetry

__all__ = ["Around", "around"]

MOST_CORNERS = 30
"""Outlines with more corners than this in a sector have too many folds for two hands, and are not folded."""

PARTS = (1.0, 0.85, 0.7)
"""Outlines are begun with that are made for so many times the tolerance."""

TRIES = 12
"""How many sets of perpendiculars are tried for each outline."""


@dataclass(frozen=True, eq=False)
class Around:
    """A drawing in the frame of ``plan``, and its ``axes`` through ``centre``, ``(2,)`` mm of that frame."""

    plan: Plan
    centre: Floats
    axes: Dihedral

    def outlines(self, tolerance: float) -> Iterator[tuple[Shape, float]]:
        """Yield outlines with all axes exact, and how far off they are: at most ``tolerance`` mm of the frame."""
        step = math.pi / self.axes.count
        axes = [Axis(self.centre, self.axes.angle + number * step) for number in range(self.axes.count)]
        every = (all_starts(self.plan.target.shape, part * tolerance, axes) for part in PARTS)
        for start in chain.from_iterable(every):
            if not start.axes:
                continue
            exact = made_dihedral(start.shape, self.axes)
            if exact is None or exact[0].corner_count > 2 * self.axes.count * MOST_CORNERS:
                continue
            off, _ = self.plan.target.off_by(exact[0].loops)
            if off <= tolerance * (1 + 1e-6):
                yield exact[0], off

    def fold(self, outline: Shape, most_folds: float) -> Iterator[Made]:
        """Yield patterns of an outline with at most ``most_folds`` folds, on the sheet that is asked for."""
        frame, laid = self.plan.frame, on_the_sheet(self.plan, outline)
        turned = self.axes.turned(math.atan2(frame.turn[1, 0], frame.turn[0, 0]))
        whole = self._wedge(outline, frame.sheet, self.axes)
        for near in CLOSED:
            with suppress(FoldcutError):
                wedge = closed_wedge(whole, near)
                if wedge is None:
                    continue
                found = fold_outline(
                    wedge.outline,
                    wedge.sheet,
                    tries=TRIES,
                    part=wedge,
                    most_folds=most_folds - fan_folds(self.axes.count),
                )
                creases, folded = frame.pattern(found.creases, found.folded, outline)
                found = replace(found, creases=creases, folded=folded, shape=laid.shape)
                yield made_of_wedge(self._wedge(laid.shape, laid.sheet, turned), found, laid)

    def _wedge(self, shape: Shape, sheet: Sheet, axes: Dihedral) -> Wedge:
        """Return the wedge of a sheet for a shape that has such axes."""
        exact = made_dihedral(shape, axes)
        if exact is None:
            raise ValueError("an outline with exact axes has partners for all corners")
        return Wedge.of(exact[0], sheet, exact[1], axes.count, axes.first)


def around(drawing: Drawing) -> Around | None:
    """Return a drawing with its mirror axes, if it has three or more through one point; None otherwise.

    If it may be turned, it is turned until one axis is along the sheet. None for circles, too: as a quarter of the
    sheet they have hardly more folds, and far fewer layers.
    """
    found = drawing.symmetry
    if len(found.axes) < FEWEST_OF_WEDGE or found.is_round:
        return None
    axes = _axes_of(found)
    if axes.upright_turn and drawing.may_turn:
        again = drawing.turned(math.degrees(axes.upright_turn))
        if len(again.symmetry.axes) == len(found.axes):
            drawing, found = again, again.symmetry
            axes = _axes_of(found)
    return Around(Plan(drawing.laid, drawing.frame, drawing.target, ()), found.centre, axes)


def _axes_of(found: Symmetry) -> Dihedral:
    """Return the axes of a symmetry; those that are nearly upright or level are exactly so."""
    return Dihedral(len(found.axes), found.angles[0], found.off).turned(0.0)
