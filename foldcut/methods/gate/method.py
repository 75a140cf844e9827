"""The method ``gate``: several loops by disk packing, joined by gates through rings of equal disks."""

from __future__ import annotations

from foldcut.methods.base import Effort, Made, Problem, straight_folds
from foldcut.methods.disks.molecules import regions
from foldcut.methods.disks.ribbon import ribbon_or_default
from foldcut.methods.gate.ring_sizes import fold_gated

__all__ = ["fold"]


def fold(problem: Problem, effort: Effort) -> Made:
    """Fold a shape of several loops; the pattern is verified.

    Raises ``UnfoldableError`` where the loops are too near to each other, or too many disks are needed.
    """
    shape, sheet = problem.shape, problem.sheet
    ribbon = ribbon_or_default(problem.wishes.ribbon, shape, sheet)
    with problem.stages("gates"):
        made = fold_gated(shape, sheet, ribbon, effort=effort.name, seconds=effort.seconds)
    disks, count, rings = len(made.packing.radii), len(made.molecules.corners), len(made.rings)
    return Made(
        "gate",
        made.creases,
        made.folded,
        problem.laid,
        ribbon,
        straight_folds(made.creases),
        told=(f"gate: {rings} rings, {disks} disks, {count} molecules",),
        numbers={"disks": disks, "molecules": count, "rings": rings},
        regions=regions(made.molecules, made.parent.tolist()),
        detail=made,
    )
