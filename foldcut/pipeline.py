"""From a drawing to a verified crease pattern: the stages in their order, and nothing else.

shape -> sheet -> simplification -> the method's own stages -> verification. Those of the paper's method are boundary
disks -> packing -> molecules -> assignment -> layers, in the paper's order; the compact method searches.
"""

from __future__ import annotations

import html
import math
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property, partial
from os import PathLike
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import ArrayLike

from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import BadInputError, CreaseTooShortError, RibbonError, UnfoldableError, VerificationError
from foldcut.core.model import CreasePattern, Finding, FoldedPattern, FoldedState, Placement, Region, Shape, Sheet
from foldcut.drawing.limits import Limits
from foldcut.drawing.mend import Preparation, Prepared, prepare, refuse_changes
from foldcut.drawing.placement import Layout, parse_sheet
from foldcut.drawing.shape import LARGEST_NUMBER, make_shape
from foldcut.drawing.simplify import simplify as simplify_shape
from foldcut.geometry.mirror_axes import ROUNDING, mirror_axes, sheet_axes, symmetric
from foldcut.geometry.tolerance import Tolerance
from foldcut.methods import ADJUST_MM, DEFAULT_METHOD, EFFORTS, METHODS, MIN_CREASE_MM
from foldcut.methods.compact import pattern as compact
from foldcut.methods.compact.search import Compact, fold_compact
from foldcut.methods.disks import molecules
from foldcut.methods.disks.boundary import boundary_disks, default_ribbon
from foldcut.methods.disks.layers import fold_layers
from foldcut.methods.disks.molecules import Molecules, build_molecules
from foldcut.methods.disks.packing import Packing, fill_gaps
from foldcut.methods.disks.trees import Assignment, assign_creases, require_one_loop
from foldcut.methods.fewest_folds import fewest_folds
from foldcut.methods.gate.joining import Gated, fold_gated
from foldcut.methods.mirror.halves import Half, Mirrored, fold_mirrored, halves
from foldcut.methods.skeleton.search import Skeletal, fold_ridges, fold_skeletal
from foldcut.pattern.foldability import Foldability, crease_numbers, foldability, remedies
from foldcut.pattern.ranking import rank, shortest_crease
from foldcut.proof.tolerance import COINCIDENT
from foldcut.proof.verify import verify
from foldcut.readers import Drawing, ReadOptions, read_shape

__all__ = ["EFFORTS", "METHODS", "PaperStages", "Progress", "Result", "fold"]

Progress = Callable[[str, float], None]

NEARLY = 0.01
"""Corners that are off by less than this, relative to the shape's size, are worth a hint."""

READ, RIDGES, ENDS, FOLDED = 0.02, 0.04, {"mirror": 0.6, "skeleton": 0.75, "compact": 0.9}, 0.98
"""How much of all is done when the drawing is read, after each method that ``auto`` tries, and with a pattern."""

AFTER_OTHERS = 0.3
"""The part of the effort that a method gets when another has given a pattern."""


@dataclass(frozen=True, eq=False)
class PaperStages:
    """What the stages of the paper's method made."""

    packing: Packing
    molecules: Molecules
    assignment: Assignment
    creases: CreasePattern
    folded: FoldedState


@dataclass(frozen=True)
class Attempt:
    """What a method came to: its creases on the sheet, folding actions and shortest crease in mm, or why it failed."""

    method: str
    creases: int | None
    actions: int | None
    shortest_mm: float | None
    failure: str


@dataclass(frozen=True, eq=False)
class Result:
    """A pattern, how it folds, what the method's stages made, and what verification found.

    ``findings`` is empty exactly when the pattern is verified. ``method`` is the one that made it, ``attempts`` has
    what all that were tried came to. ``actions``: how many straight folds a person makes, through one layer or more.
    ``ribbon`` is the half-width in mm that the pattern has.
    ``seconds`` holds the time of each stage and the totals "build" and "verify". ``notes`` say what was done to the
    drawing: left out, mended, simplified; ``prepared`` has the loops before and after, if they were prepared.
    ``drawing`` is what was read, unless the shape was given as points.
    """

    folded_pattern: FoldedPattern
    findings: tuple[Finding, ...]
    stages: PaperStages | Compact | Mirrored | Gated | Skeletal
    method: str
    actions: int
    attempts: tuple[Attempt, ...]
    ribbon: float
    seconds: dict[str, float]
    notes: tuple[str, ...]
    drawing: Drawing | None = None
    prepared: Prepared | None = None

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

    def _repr_html_(self) -> str:
        """Show the page of a verified pattern in Jupyter, in a frame of its own; what is wrong with any other."""
        from foldcut.exporters import export

        if self.findings:
            return "<br>".join(html.escape(str(finding)) for finding in self.findings)
        page = html.escape(export(self.folded_pattern, ".html").decode())
        return (
            f'<iframe srcdoc="{page}" sandbox="allow-scripts" style="width: 100%; height: 48rem; border: 0"></iframe>'
        )

    def _repr_svg_(self) -> str | None:
        """Show the drawing of a verified pattern where there are no pages."""
        from foldcut.exporters import export

        return None if self.findings else export(self.folded_pattern, ".svg").decode()


def fold(
    shape: Shape | Drawing | Sequence[ArrayLike] | str | PathLike[str],
    sheet: Sheet | str = "a4",
    *,
    margin: float = 10.0,
    scale: str | float = "fit",
    offset: tuple[float, float] | None = None,
    rotation: str | float | None = None,
    width: float | None = None,
    height: float | None = None,
    method: str = DEFAULT_METHOD,
    ribbon: float | None = None,
    min_crease: float | None = None,
    simplify: float = 0.0,
    symmetry: float = 0.0,
    adjust: float = ADJUST_MM,
    effort: str = "normal",
    seconds: float | None = None,
    title: str = "",
    limits: Limits | None = None,
    preparation: Preparation | None = None,
    progress: Progress | None = None,
) -> Result:
    """Compute how to fold ``sheet`` so that one straight cut cuts ``shape`` out, and verify it.

    ``shape`` is a shape, a drawing, loops of points (even-odd), or a file's path; ``margin`` and ``offset`` are in
    mm, ``scale`` is "fit", or a factor on the size that the file states (mm per unit where nothing is stated);
    instead, ``width`` and ``height`` say in mm how large the drawing is to be, both as the most it may be.
    ``rotation`` is in degrees counter-clockwise, "best" is the angle at which the drawing is largest, and None turns it
    a quarter where that lets it be larger, and as its mirror axes ask for. ``method`` is "mirror" (the shape's mirror
    axes are folded first, the rest through two or four layers), "compact" (few creases), "skeleton" (Demaine, Demaine
    and Lubiw), "paper" (Bern, Demaine, Eppstein and Hayes), "gate" (the same for several loops), or "auto": of the
    first three, the one with the fewest folding actions, else the gate, or for one loop the paper's. ``ribbon`` is
    the half-width in mm of the strip along the shape's boundary that is not folded; None is the method's default,
    which for "paper" is a small one: without, creases fold onto the cut line. ``min_crease`` is the shortest crease
    in mm that a pattern may have, None the method's default (0.5 for "mirror" and "compact", else 0).
    ``simplify`` leaves out corners that are off by no more than so many mm on the sheet; ``symmetry`` takes a drawing
    as symmetric whose corners are off by so much, and makes it so; ``adjust`` is how far in mm
    "skeleton" may move corners so that creases meet. ``effort`` ("fast", "normal", "best") and
    ``seconds`` bound the search. ``limits`` bound how large a file may be. ``preparation`` says how the drawing is
    mended and simplified, None that it must be a shape as it is. ``progress`` is called with a stage's name and the
    part of all that is done, which never gets smaller.

    Raises ``BadInputError`` for what cannot be used, ``UnfoldableError`` for what cannot be folded, and
    ``CreaseTooShortError``, one of these, for a verified pattern with too short a crease. A pattern
    that fails verification is returned with its findings; ``Result.require_verified`` refuses it.
    """
    _check_options(method, ribbon, min_crease, symmetry, adjust, effort, seconds)
    stages = _Stages(progress)
    stages.up_to(READ)
    with stages("reading"):
        drawing = (
            read_shape(Path(shape), ReadOptions(limits=limits or Limits()))
            if isinstance(shape, str | PathLike)
            else shape
        )
        notes: list[str] = []
        read = drawing if isinstance(drawing, Drawing) else None
        y_down = read is not None and read.y_down
        if isinstance(drawing, Drawing):
            title = title or drawing.title
            notes += (*drawing.notes, *drawing.repairs)
            if preparation is not None and preparation.strict:
                refuse_changes(drawing.repairs)
            scale = scale if isinstance(scale, str) else scale * (drawing.unit_mm or 1.0)
            drawing = drawing.loops
        paper = parse_sheet(sheet) if isinstance(sheet, str) else sheet
        layout = Layout(paper, margin, scale, offset, rotation, width, height)
        prepared, mirrored = None, preparation is not None and preparation.mirror
        if preparation is not None and not isinstance(drawing, Shape):
            unit = layout.place(_hull(drawing))[2].scale
            prepared = prepare([points_array(loop) * unit for loop in drawing], preparation)
            notes += prepared.changes
            drawing = [loop / unit for loop in prepared.loops] if prepared.changes else drawing
        outline = drawing if isinstance(drawing, Shape) else make_shape(drawing)

        def lay(turn: float) -> _Laid:
            """Lay the shape on the sheet, turned by so many degrees more."""
            on, placed, placement, quarter = layout.place(outline, turn)
            notes = [f"turned by {turn:.4g} degrees, so that a mirror axis lies along the sheet"] if turn else []
            notes += ["turned by a quarter, so that it has more room on the sheet"] * quarter
            if simplify:
                simplified = simplify_shape(placed, simplify)
                placed = simplified.shape
                notes.append(str(simplified))
            placement = Placement(placement.matrix * (-1.0, 1.0, 1.0)) if mirrored else placement
            return _Laid(on, placed, placement.from_y_down() if y_down else placement, notes, quarter)

        laid = lay(0.0)
    may_turn = rotation is None and offset is None
    trials = _Trials(stages, ribbon, effort, seconds, symmetry, adjust, min_crease, may_turn=may_turn)
    made = trials.run(method, laid, lay)
    stages.up_to(FOLDED)
    stages.up_to(1.0)
    stages.seconds["build"] = sum(stages.seconds.values())
    with stages("verify"):
        findings = verify(made.stages.creases, made.stages.folded.layers, made.laid.shape)
    if not findings:
        least = MIN_CREASE_MM[made.method] if min_crease is None else min_crease
        _require_length(made, least, {attempt.method for attempt in trials.attempts})
    on = made.laid
    pattern = FoldedPattern(
        made.stages.creases,
        made.stages.folded,
        on.sheet,
        on.shape,
        on.placement,
        title,
        made.first_folds,
        _regions(made),
    )
    return Result(
        pattern,
        tuple(findings),
        made.stages,
        made.method,
        made.actions,
        tuple(trials.attempts),
        made.ribbon,
        stages.seconds,
        (*notes, *on.notes),
        read,
        prepared,
    )


def _regions(made: _Made) -> tuple[Region, ...]:
    """Return how the molecules that a method made hang together, if it says so."""
    stages = made.stages
    if isinstance(stages, PaperStages):
        return molecules.regions(stages.molecules, stages.assignment.parent.tolist())
    if isinstance(stages, Gated):
        return molecules.regions(stages.molecules, stages.parent.tolist())
    if isinstance(stages, Mirrored):
        return stages.regions
    if isinstance(stages, Compact):
        return compact.regions(stages.walk, stages.molecules, made.laid.sheet)
    return ()


def _hull(loops: Sequence[ArrayLike]) -> Shape:
    """Return the hull of loops, which lies on the sheet as they do; raises ``ShapeError`` where they have none."""
    points = [np.asarray(loop, dtype=np.float64) for loop in loops]
    if not points or not all((np.abs(loop) < LARGEST_NUMBER).all() for loop in points):  # nan compares as False
        return make_shape(points)  # which says where
    hull = shapely.convex_hull(shapely.multipoints(np.concatenate(points)))
    return make_shape([shapely.get_coordinates(hull)] if isinstance(hull, shapely.Polygon) else points)


@dataclass(frozen=True, eq=False)
class _Laid:
    """A shape on its sheet, and what was done to it on the way."""

    sheet: Sheet
    shape: Shape
    placement: Placement
    notes: list[str]
    quarter: bool


@dataclass(frozen=True, eq=False)
class _Made:
    """What a method made of a shape on its sheet."""

    method: str
    stages: PaperStages | Compact | Mirrored | Gated | Skeletal
    laid: _Laid
    ribbon: float
    actions: int
    first_folds: tuple[Floats, ...] = ()
    interrupted: bool = False


class _Trials:
    """Runs methods and keeps what came of each."""

    def __init__(
        self,
        stages: _Stages,
        ribbon: float | None,
        effort: str,
        seconds: float | None,
        symmetry: float,
        adjust: float,
        min_crease: float | None,
        *,
        may_turn: bool,
    ) -> None:
        self.stages, self.ribbon, self.may_turn = stages, ribbon, may_turn
        self.symmetry, self.adjust = symmetry, adjust
        self.free = ribbon or 0.0  # the ribbon of methods that need none
        self.fold_compact = partial(
            fold_compact,
            ribbon=self.free,
            effort=effort,
            seconds=seconds,
            progress=stages.tell,
            least=MIN_CREASE_MM["compact"] if min_crease is None else min_crease,
        )
        self.fold_mirrored = partial(
            fold_mirrored, ribbon=self.free, effort=effort, seconds=seconds, progress=stages.tell
        )
        self.fold_skeletal = partial(
            fold_skeletal, ribbon=self.free, near=adjust, effort=effort, seconds=seconds, progress=stages.tell
        )
        self.fold_gated = partial(fold_gated, effort=effort, seconds=seconds)
        self.attempts: list[Attempt] = []

    def run(self, method: str, laid: _Laid, lay: Callable[[float], _Laid]) -> _Made:
        """Return what a method makes, or the best of what several do."""
        folds: dict[str, Callable[[float], _Made]] = {
            "mirror": lambda _: self._mirror(laid, lay),
            "skeleton": lambda share: self._skeleton(laid, share),
            "compact": lambda share: self._compact(laid, share),
            "gate": lambda _: self._gate(laid),
            "paper": lambda _: self._paper(laid),
        }
        self.stages.up_to(RIDGES if method == "auto" else FOLDED)
        if method != "auto":
            return self._kept(folds[method](1.0))
        if (proven := self._fewest(laid)) is not None:
            return self._kept(proven)
        made: list[_Made] = []
        reasons: list[str] = []
        for name in ("mirror", "skeleton", "compact", "gate" if len(laid.shape.loops) > 1 else "paper"):
            if name in ("gate", "paper") and made:
                break
            self.stages.up_to(ENDS.get(name, FOLDED))
            try:
                made.append(self._kept(folds[name](AFTER_OTHERS if made else 1.0)))
            except UnfoldableError as error:
                reasons.append(self._failed(name, error))
            except KeyboardInterrupt:
                if not made:
                    raise
                break
            if made and made[-1].interrupted:
                break
        if not made:
            raise UnfoldableError("; ".join(reasons))
        return min(made, key=lambda one: rank(one.actions, shortest_crease(one.stages.creases)))

    def _kept(self, made: _Made) -> _Made:
        creases = made.stages.creases
        self.attempts.append(Attempt(made.method, creases.crease_count, made.actions, shortest_crease(creases), ""))
        return made

    def _failed(self, method: str, error: UnfoldableError) -> str:
        self.attempts.append(Attempt(method, None, None, None, str(error)))
        return f"{method}: {error}"

    def _compact(self, laid: _Laid, share: float) -> _Made:
        require_one_loop(laid.shape)
        with self.stages("searching"):
            found = self.fold_compact(laid.shape.loops[0], laid.sheet, share=share)
        return _Made("compact", found, laid, self.free, crease_numbers(found.creases).lines)

    def _mirror(self, laid: _Laid, lay: Callable[[float], _Laid]) -> _Made:
        with self.stages("mirror axes", 0.02):
            candidates = list(self._halves(laid, lay))
        with self.stages("searching half"):
            made = self.fold_mirrored([half for half, _ in candidates])
        half, laid = next(one for one in candidates if one[0] is made.half)
        actions = len(half.axes) + crease_numbers(made.found.part).lines
        return _Made("mirror", made, laid, self.free, actions, half.first_folds, made.found.interrupted)

    def _halves(self, laid: _Laid, lay: Callable[[float], _Laid]) -> Iterator[tuple[Half, _Laid]]:
        """Yield the halves of the sheet by which a shape can be folded, and how it lies for each."""
        refused = ""
        found = False
        for turn, axes in sheet_axes(laid.shape, self.symmetry, may_turn=self.may_turn):
            on = lay(turn) if turn else laid
            if on.quarter != laid.quarter:
                axes = tuple(1 - axis for axis in axes)
            middle = np.array([on.sheet.width, on.sheet.height]) / 2
            shape, moved = symmetric(on.shape, middle, axes)
            if moved > max(self.symmetry, ROUNDING * on.sheet.diagonal):
                refused = "the drawing's mirror axis is not in the middle of the sheet; leave out --offset and --rotate"
                continue
            notes = list(on.notes)
            if moved > COINCIDENT[0] * on.sheet.diagonal:
                notes.append(f"made symmetric: corners moved by at most {moved:.2g} mm")
            on = _Laid(on.sheet, shape, on.placement, notes, on.quarter)
            try:
                for half in halves(shape, on.sheet, axes):
                    found = True
                    yield half, on
            except UnfoldableError as error:
                refused = str(error)
        if not found:
            raise UnfoldableError(refused or self._no_axis(laid.shape))

    def _no_axis(self, shape: Shape) -> str:
        """Say why a shape on the sheet has no axis to fold along, or how near it comes to having one, in mm."""
        if mirror_axes(shape, self.symmetry):
            return "no mirror axis of the drawing lies along the sheet; leave out --offset and --rotate"
        near = mirror_axes(shape, NEARLY * float(np.ptp(np.concatenate(shape.loops), axis=0).max()))
        if not near:
            return f"the drawing is not mirror-symmetric{f' within {self.symmetry:g} mm' if self.symmetry else ''}"
        off = min(axis.deviation for axis in near)
        return (
            f"the drawing is not mirror-symmetric, but nearly: corners are {off:.2g} mm off; "
            f"make it so with --symmetry {math.ceil(off * 100) / 100:g}mm"
        )

    def _fewest(self, laid: _Laid) -> _Made | None:
        """Return the pattern of the straight skeleton's ridges alone where it is proven that none has fewer folds."""
        least = fewest_folds(laid.shape, laid.sheet, self.adjust, self.symmetry)
        # else a pattern of ridges is unlikely or has more folds
        if not least.bisectors <= least.folds < least.corners:
            return None
        try:
            with self.stages("straight skeleton"):
                made = self._of_skeleton(laid, fold_ridges(laid.shape, laid.sheet, ribbon=self.free, near=self.adjust))
        except UnfoldableError:
            return None
        too_short, folds, _ = rank(made.actions, shortest_crease(made.stages.creases))
        return None if too_short or folds > least.folds else made

    def _skeleton(self, laid: _Laid, share: float) -> _Made:
        with self.stages("straight skeleton"):
            made = self.fold_skeletal(laid.shape, laid.sheet, share=share)
        return self._of_skeleton(laid, made)

    def _of_skeleton(self, laid: _Laid, made: Skeletal) -> _Made:
        notes = list(laid.notes)
        if made.moved_mm > COINCIDENT[0] * laid.sheet.diagonal:
            notes.append(f"corners moved by at most {made.moved_mm:.2g} mm, so that creases meet")
        on = replace(laid, shape=made.shape, notes=notes)
        actions = crease_numbers(made.creases).lines
        return _Made("skeleton", made, on, self.free, actions, interrupted=made.interrupted)

    def _gate(self, laid: _Laid) -> _Made:
        ribbon = default_ribbon(laid.shape, laid.sheet) if self.ribbon is None else self.ribbon
        with self.stages("gates"):
            made = self.fold_gated(laid.shape, laid.sheet, ribbon)
        return _Made("gate", made, laid, ribbon, crease_numbers(made.creases).lines)

    def _paper(self, laid: _Laid) -> _Made:
        require_one_loop(laid.shape)
        ribbon = default_ribbon(laid.shape, laid.sheet) if self.ribbon is None else self.ribbon
        made = _fold_by_the_paper(laid.shape, laid.sheet, ribbon, self.stages)
        return _Made("paper", made, laid, ribbon, crease_numbers(made.creases).lines)


def _check_options(
    method: str,
    ribbon: float | None,
    min_crease: float | None,
    symmetry: float,
    adjust: float,
    effort: str,
    seconds: float | None,
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
    if not 0 <= symmetry < float("inf"):
        raise BadInputError(f"the deviation from symmetry allowed is {symmetry} mm; give 0 or a positive number")
    if not 0 <= adjust < float("inf"):
        raise BadInputError(f"how far corners may be moved is {adjust} mm; give 0 or a positive number")
    if seconds is not None and not 0 < seconds < float("inf"):
        raise BadInputError(f"the time to search is {seconds} s; give a positive number")


def _fold_by_the_paper(shape: Shape, sheet: Sheet, ribbon: float, stages: _Stages) -> PaperStages:
    """Run the stages of the paper's method."""
    tolerance = Tolerance.for_sheet(sheet)
    with stages("boundary disks", 0.1):
        boundary = boundary_disks(shape, sheet, ribbon, tolerance)
    with stages("packing", 0.3):
        packing = fill_gaps(boundary, tolerance, stages.report)
    with stages("molecules", 0.4):
        built = build_molecules(packing, tolerance)
    with stages("assignment", 0.4):
        assignment = assign_creases(built, packing.face_inside)
    with stages("layers"):
        creases, folded = fold_layers(built, assignment)
    return PaperStages(packing, built, assignment, creases, folded)


def _require_length(made: _Made, least: float, tried: set[str]) -> None:
    """Refuse a crease that is shorter than ``least``, in mm, with what to do about it but methods that were tried."""
    numbers = crease_numbers(made.stages.creases)
    length, at = numbers.shortest_crease_mm, numbers.shortest_crease_at
    if length is None or at is None or length >= least:
        return
    remedy = remedies(made.laid.sheet, least / length, len(made.laid.shape.loops), tried)
    raise CreaseTooShortError(
        f"the crease at ({at[0]:.4g}, {at[1]:.4g}) is only {length:.2g} mm long, shorter than {least:g} mm; "
        f"{remedy}, or allow it with --min-crease {_rounded_down(length)}mm",
        length,
        at,
    )


def _rounded_down(length: float) -> str:
    """Return a length in two digits that it is not shorter than."""
    digits = 1 - math.floor(math.log10(length))
    return f"{math.floor(length * 10**digits) / 10**digits:g}"


class _Stages:
    """Times the stages and reports them, and how much of all is done: a part that never gets smaller."""

    def __init__(self, progress: Progress | None) -> None:
        self.progress = progress
        self.seconds: dict[str, float] = {}
        self.name = ""
        self.done = self.start = self.end = self.until = 0.0

    def up_to(self, done: float) -> None:
        """Say that the stages so far are over, and how much of all is done when those that follow are."""
        self.done, self.end = max(self.done, self.end), done

    @contextmanager
    def __call__(self, name: str, part: float = 1.0) -> Iterator[None]:
        """Time a stage that is this part of what follows up to the end that was said."""
        self.name, self.start = name, self.done
        self.until = self.start + part * (self.end - self.start)
        self.report(0.0)
        start = time.perf_counter()
        yield
        self.seconds[name] = time.perf_counter() - start
        self.report(1.0)

    def report(self, fraction: float, doing: str = "") -> None:
        self.tell(f"{self.name}: {doing}" if doing else self.name, fraction)

    def tell(self, stage: str, fraction: float) -> None:
        self.done = max(self.done, self.start + fraction * (self.until - self.start))
        if self.progress is not None:
            self.progress(stage, self.done)
