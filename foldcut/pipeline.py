"""From a drawing to a verified crease pattern: the stages in their order, and nothing else.

shape -> sheet -> simplification -> the method's own stages -> verification. Those of the paper's method are boundary
disks -> packing -> molecules -> assignment -> layers, in the paper's order; the compact method searches.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from foldcut.assignment import Assignment, assign_creases, require_one_loop
from foldcut.boundary import boundary_disks, default_ribbon
from foldcut.errors import BadInputError, CreaseTooShortError, RibbonError, VerificationError
from foldcut.foldability import Foldability, crease_numbers, foldability, remedies
from foldcut.layers import fold_layers
from foldcut.methods import DEFAULT_METHOD, EFFORTS, METHODS, MIN_CREASE_MM
from foldcut.model import CreasePattern, Finding, FoldedPattern, FoldedState, Shape, Sheet
from foldcut.molecules import Molecules, build_molecules
from foldcut.packing import Packing, fill_gaps
from foldcut.readers import Drawing, read_shape
from foldcut.shape import make_shape
from foldcut.sheet import parse_sheet, place
from foldcut.simplify import simplify as simplify_shape
from foldcut.tolerance import Tolerance
from foldcut.verify import verify

if TYPE_CHECKING:
    from foldcut.search import Compact

__all__ = ["EFFORTS", "METHODS", "PaperStages", "Progress", "Result", "fold"]

Progress = Callable[[str, float], None]


@dataclass(frozen=True, eq=False)
class PaperStages:
    """What the stages of the paper's method made."""

    packing: Packing
    molecules: Molecules
    assignment: Assignment
    creases: CreasePattern
    folded: FoldedState


@dataclass(frozen=True, eq=False)
class Result:
    """A pattern, how it folds, what the method's stages made, and what verification found.

    ``findings`` is empty exactly when the pattern is verified. ``ribbon`` is the half-width in mm that the pattern has.
    ``seconds`` holds the time of each stage and the totals "build" and "verify". ``notes`` say what was left out of the
    drawing, and what was simplified.
    """

    folded_pattern: FoldedPattern
    findings: tuple[Finding, ...]
    stages: PaperStages | Compact
    method: str
    ribbon: float
    seconds: dict[str, float]
    notes: tuple[str, ...]

    @cached_property
    def foldability(self) -> Foldability:
        """How hard the pattern is to fold and to cut, of office paper."""
        return foldability(self.folded_pattern)

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
    method: str = DEFAULT_METHOD,
    ribbon: float | None = None,
    min_crease: float | None = None,
    simplify: float = 0.0,
    effort: str = "normal",
    seconds: float | None = None,
    title: str = "",
    progress: Progress | None = None,
) -> Result:
    """Compute how to fold ``sheet`` so that one straight cut cuts ``shape`` out, and verify it.

    ``shape`` is a shape, a drawing, loops of points (even-odd), or a file's path; ``margin`` and ``offset`` are in mm,
    ``scale`` is "fit", or a factor on the size that the file states (mm per unit where nothing is stated),
    ``rotation`` in degrees counter-clockwise. ``method`` is "compact" (few creases) or "paper" (Bern, Demaine, Eppstein
    and Hayes). ``ribbon`` is the half-width in mm of the strip along the shape's boundary that is not folded; None is
    the method's default, which for "paper" is a small one: without, creases fold onto the cut line.
    ``min_crease`` is the shortest crease in mm that a pattern may have, None the method's default (0.5, "paper": 0).
    ``simplify`` leaves out corners that are off by no more than so many mm on the sheet. ``effort`` ("fast", "normal",
    "best") and ``seconds`` bound the search of "compact". ``progress`` is called with a stage's name and the part of it
    that is done.

    Raises ``BadInputError`` for what cannot be used, ``UnfoldableError`` for what cannot be folded, and
    ``CreaseTooShortError``, one of these, for a verified pattern with too short a crease. A pattern
    that fails verification is returned with its findings; ``Result.require_verified`` refuses it.
    """
    _check_options(method, ribbon, min_crease, effort, seconds)
    stages = _Stages(progress)
    with stages("reading"):
        drawing = read_shape(Path(shape)) if isinstance(shape, str | PathLike) else shape
        notes: list[str] = []
        y_down = isinstance(drawing, Drawing) and drawing.y_down
        if isinstance(drawing, Drawing):
            title = title or drawing.title
            notes += drawing.notes
            scale = scale if isinstance(scale, str) else scale * (drawing.unit_mm or 1.0)
            drawing = drawing.loops
        outline = drawing if isinstance(drawing, Shape) else make_shape(drawing)
        sheet = parse_sheet(sheet) if isinstance(sheet, str) else sheet
        require_one_loop(outline)
        placed, placement = place(outline, sheet, margin=margin, scale=scale, offset=offset, rotation=rotation)
        if y_down:
            placement = placement.from_y_down()
        if simplify:
            simplified = simplify_shape(placed, simplify)
            placed = simplified.shape
            notes.append(str(simplified))
    made: PaperStages | Compact
    if method == "compact":
        ribbon = ribbon or 0.0
        with stages("searching"):
            from foldcut.search import fold_compact

            made = fold_compact(
                placed.loops[0], sheet, ribbon=ribbon, effort=effort, seconds=seconds, progress=stages.tell
            )
    else:
        ribbon = default_ribbon(placed, sheet) if ribbon is None else ribbon
        made = _fold_by_the_paper(placed, sheet, ribbon, stages)
    stages.seconds["build"] = sum(stages.seconds.values())
    with stages("verify"):
        findings = verify(made.creases, made.folded.layers, placed)
    if not findings:
        _require_length(made.creases, sheet, MIN_CREASE_MM[method] if min_crease is None else min_crease)
    pattern = FoldedPattern(made.creases, made.folded, sheet, placed, placement, title)
    return Result(pattern, tuple(findings), made, method, ribbon, stages.seconds, tuple(notes))


def _check_options(
    method: str, ribbon: float | None, min_crease: float | None, effort: str, seconds: float | None
) -> None:
    """Refuse options that mean nothing."""
    if method not in METHODS:
        raise BadInputError(f"unknown method {method!r}; known: {', '.join(METHODS)}")
    if effort not in EFFORTS:
        raise BadInputError(f"unknown effort {effort!r}; known: {', '.join(EFFORTS)}")
    if ribbon is not None and not 0 <= ribbon < float("inf"):
        raise RibbonError(f"the ribbon's half-width is {ribbon} mm; give 0 or a positive number")
    if min_crease is not None and not 0 <= min_crease < float("inf"):
        raise BadInputError(f"the shortest crease allowed is {min_crease} mm; give 0 or a positive number")
    if seconds is not None and not 0 < seconds < float("inf"):
        raise BadInputError(f"the time to search is {seconds} s; give a positive number")


def _fold_by_the_paper(shape: Shape, sheet: Sheet, ribbon: float, stages: _Stages) -> PaperStages:
    """Run the stages of the paper's method."""
    tolerance = Tolerance.for_sheet(sheet)
    with stages("boundary disks"):
        boundary = boundary_disks(shape, sheet, ribbon, tolerance)
    with stages("packing"):
        packing = fill_gaps(boundary, tolerance, stages.report)
    with stages("molecules"):
        molecules = build_molecules(packing, tolerance)
    with stages("assignment"):
        assignment = assign_creases(molecules, packing.face_inside)
    with stages("layers"):
        creases, folded = fold_layers(molecules, assignment)
    return PaperStages(packing, molecules, assignment, creases, folded)


def _require_length(creases: CreasePattern, sheet: Sheet, least: float) -> None:
    """Refuse a crease that is shorter than ``least``, in mm, with what to do about it."""
    numbers = crease_numbers(creases)
    length, at = numbers.shortest_crease_mm, numbers.shortest_crease_at
    if length is None or at is None or length >= least:
        return
    raise CreaseTooShortError(
        f"the crease at ({at[0]:.4g}, {at[1]:.4g}) is only {length:.2g} mm long, shorter than {least:g} mm; "
        f"{remedies(sheet, least / length)}, or allow it with --min-crease {_rounded_down(length)}mm",
        length,
        at,
    )


def _rounded_down(length: float) -> str:
    """Return a length in two digits that it is not shorter than."""
    digits = 1 - math.floor(math.log10(length))
    return f"{math.floor(length * 10**digits) / 10**digits:g}"


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
        self.tell(self.name, fraction)

    def tell(self, stage: str, fraction: float) -> None:
        if self.progress is not None:
            self.progress(stage, fraction)
