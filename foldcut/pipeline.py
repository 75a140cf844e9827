"""From a drawing to a verified crease pattern: the stages in the paper's order, and nothing else.

shape -> sheet -> boundary disks -> packing -> molecules -> assignment -> layers -> verification.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from numpy.typing import ArrayLike

from foldcut.assignment import Assignment, assign_creases, require_one_loop
from foldcut.boundary import boundary_disks
from foldcut.errors import BadInputError, RibbonError, VerificationError
from foldcut.layers import fold_layers
from foldcut.model import Finding, FoldedPattern, Shape, Sheet
from foldcut.molecules import Molecules, build_molecules
from foldcut.packing import Packing, fill_gaps
from foldcut.readers import Drawing, read_shape
from foldcut.shape import make_shape
from foldcut.sheet import parse_sheet, place
from foldcut.tolerance import Tolerance
from foldcut.verify import verify

METHODS = ("paper",)
Progress = Callable[[str, float], None]


@dataclass(frozen=True, eq=False)
class Result:
    """A pattern, how it folds, what each stage made, and what verification found.

    ``findings`` is empty exactly when the pattern is verified. ``seconds`` holds the time of each stage and the totals
    "build" and "verify".
    """

    folded_pattern: FoldedPattern
    findings: tuple[Finding, ...]
    packing: Packing
    molecules: Molecules
    assignment: Assignment
    method: str
    ribbon: float
    seconds: dict[str, float]
    drawing_notes: tuple[str, ...]

    @property
    def verified(self) -> bool:
        """Whether verification found nothing wrong."""
        return not self.findings

    def require_verified(self) -> FoldedPattern:
        """Return the pattern for an exporter, or raise ``VerificationError`` with the findings."""
        if self.findings:
            raise VerificationError(self.findings)
        return self.folded_pattern


def fold(
    shape: Shape | Drawing | Sequence[ArrayLike] | str | PathLike[str],
    sheet: Sheet | str = "a4",
    *,
    margin: float = 10.0,
    scale: str | float = "fit",
    offset: tuple[float, float] | None = None,
    rotation: float = 0.0,
    method: str = "paper",
    ribbon: float = 0.0,
    title: str = "",
    progress: Progress | None = None,
) -> Result:
    """Compute how to fold ``sheet`` so that one straight cut cuts ``shape`` out, and verify it.

    ``shape`` is a shape, a drawing, loops of points (even-odd), or a file's path; ``margin`` and ``offset`` are in mm,
    ``scale`` is "fit", or a factor on the size that the file states (mm per unit where nothing is stated),
    ``rotation`` in degrees counter-clockwise, ``ribbon`` the half-width in mm of the strip along the shape's boundary
    that is not folded. ``progress`` is called with a stage's name and the part of it that is done.

    Raises ``BadInputError`` for what cannot be used and ``UnfoldableError`` for what cannot be folded. A pattern
    that fails verification is returned with its findings; ``Result.require_verified`` refuses it.
    """
    if method not in METHODS:
        raise BadInputError(f"unknown method {method!r}; known: {', '.join(METHODS)}")
    if not 0 <= ribbon < float("inf"):
        raise RibbonError(f"the ribbon's half-width is {ribbon} mm; give 0 or a positive number")
    stages = _Stages(progress)
    with stages("reading"):
        drawing = read_shape(Path(shape)) if isinstance(shape, str | PathLike) else shape
        notes: tuple[str, ...] = ()
        if isinstance(drawing, Drawing):
            title, notes = title or drawing.title, drawing.notes
            scale = scale if isinstance(scale, str) else scale * (drawing.unit_mm or 1.0)
            drawing = drawing.loops
        outline = drawing if isinstance(drawing, Shape) else make_shape(drawing)
        sheet = parse_sheet(sheet) if isinstance(sheet, str) else sheet
        require_one_loop(outline)
        placed, placement = place(outline, sheet, margin=margin, scale=scale, offset=offset, rotation=rotation)
    tolerance = Tolerance.for_sheet(sheet)
    with stages("boundary disks"):
        boundary = boundary_disks(placed, sheet, ribbon, tolerance)
    with stages("packing"):
        packing = fill_gaps(boundary, tolerance, stages.report)
    with stages("molecules"):
        molecules = build_molecules(packing, tolerance)
    with stages("assignment"):
        assignment = assign_creases(molecules, packing.face_inside)
    with stages("layers"):
        creases, folded = fold_layers(molecules, assignment)
    stages.seconds["build"] = sum(stages.seconds.values())
    with stages("verify"):
        findings = verify(creases, folded.layers, placed)
    pattern = FoldedPattern(creases, folded, sheet, placed, placement, title)
    return Result(
        pattern, tuple(findings), packing, molecules, assignment, method, ribbon, stages.seconds, tuple(notes)
    )


class _Stages:
    """Times the stages and reports them."""

    def __init__(self, progress: Progress | None) -> None:
        self.progress = progress
        self.seconds: dict[str, float] = {}
        self.name = ""

    @contextmanager
    def __call__(self, name: str) -> Iterator[None]:
        self.name = name
        self.report(0.0)
        start = time.perf_counter()
        yield
        self.seconds[name] = time.perf_counter() - start
        self.report(1.0)

    def report(self, fraction: float) -> None:
        if self.progress is not None:
            self.progress(self.name, fraction)
