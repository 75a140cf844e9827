"""Runs the stages one after the other for tests, on an A5 sheet unless told otherwise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from numpy.typing import ArrayLike

from foldcut.core.model import Shape, Sheet
from foldcut.drawing.placement import parse_sheet, place
from foldcut.drawing.shape import make_shape
from foldcut.methods.disks.boundary import BoundaryDisks, boundary_disks
from foldcut.methods.disks.molecules import Molecules, build_molecules
from foldcut.methods.disks.packing import Packing, fill_gaps
from foldcut.methods.disks.tolerance import Tolerance
from foldcut.methods.disks.trees import Assignment, assign_creases


@dataclass(frozen=True)
class Stages:
    """What each stage made."""

    shape: Shape
    sheet: Sheet
    tolerance: Tolerance
    boundary: BoundaryDisks
    packing: Packing
    molecules: Molecules

    @property
    def area(self) -> float:
        """What the facets tile."""
        return self.sheet.width * self.sheet.height

    @property
    def assignment(self) -> Assignment:
        """The joined molecules; for one-loop shapes only."""
        return assign_creases(self.molecules, self.packing.face_inside)


def run_stages(loops: Sequence[ArrayLike], *, sheet: str = "a5", ribbon: float = 0.0) -> Stages:
    """Run all stages up to the molecules."""
    paper = parse_sheet(sheet)
    shape, _ = place(make_shape(loops), paper)
    tolerance = Tolerance.for_sheet(paper)
    boundary = boundary_disks(shape, paper, ribbon, tolerance)
    packing = fill_gaps(boundary, tolerance)
    return Stages(shape, paper, tolerance, boundary, packing, build_molecules(packing, tolerance))
