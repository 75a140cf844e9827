"""The method ``paper``: the stages of the disk packing in the publication's order.

Boundary disks, packing, molecules, assignment, layers (Bern, Demaine, Eppstein and Hayes, sections 3 to 5).
"""

from __future__ import annotations

from dataclasses import dataclass

from foldcut.core.model import CreasePattern, FoldedState
from foldcut.methods.base import Effort, Made, Problem, require_one_loop, straight_folds
from foldcut.methods.disks.boundary import boundary_disks
from foldcut.methods.disks.layers import fold_layers
from foldcut.methods.disks.molecules import Molecules, build_molecules, regions
from foldcut.methods.disks.packing import Packing, fill_gaps
from foldcut.methods.disks.ribbon import ribbon_or_default
from foldcut.methods.disks.tolerance import Tolerance
from foldcut.methods.disks.trees import Assignment, assign_creases

__all__ = ["DiskStages", "fold"]


@dataclass(frozen=True, eq=False)
class DiskStages:
    """What each stage made."""

    packing: Packing
    molecules: Molecules
    assignment: Assignment
    creases: CreasePattern
    folded: FoldedState


def fold(problem: Problem, effort: Effort) -> Made:
    """Fold a shape of one loop by disk packing; the effort makes no difference.

    Raises ``UnfoldableError`` for a shape of several loops, or one for whose disks numbers are not fine enough.
    """
    shape, sheet, stages = problem.shape, problem.sheet, problem.stages
    require_one_loop(shape)
    ribbon = ribbon_or_default(problem.wishes.ribbon, shape, sheet)
    tolerance = Tolerance.for_sheet(sheet)
    with stages("boundary disks", 0.1):
        boundary = boundary_disks(shape, sheet, ribbon, tolerance)
    with stages("packing", 0.3):
        packing = fill_gaps(boundary, tolerance, stages.report)
    with stages("molecules", 0.4):
        molecules = build_molecules(packing, tolerance)
    with stages("assignment", 0.4):
        assignment = assign_creases(molecules, packing.face_inside)
    with stages("layers"):
        creases, folded = fold_layers(molecules, assignment)
    disks, count = len(packing.radii), len(molecules.corners)
    return Made(
        "paper",
        creases,
        folded,
        problem.laid,
        ribbon,
        straight_folds(creases),
        told=(f"paper: {disks} disks, {count} molecules",),
        numbers={"disks": disks, "molecules": count},
        regions=regions(molecules, assignment.parent.tolist()),
        detail=DiskStages(packing, molecules, assignment, creases, folded),
    )
