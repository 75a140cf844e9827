"""From a drawing to a verified crease pattern: read, draw it anew, lay on the sheet, fold by a method, verify.

The way of a drawing: ``readers`` -> ``drawing`` (mend, make a shape) -> ``redraw`` (outlines near to it, one tolerance
after another) -> ``drawing`` (lay it on the sheet) -> ``methods`` (fold it) -> ``proof`` (verify the pattern). Nothing
else happens here.
"""

from __future__ import annotations

import html
import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import shapely
from numpy.typing import ArrayLike

from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import (
    BadInputError,
    CreaseTooShortError,
    FoldcutError,
    ShapeError,
    TouchError,
    UnfoldableError,
    VerificationError,
)
from foldcut.core.model import Finding, FoldedPattern, Shape, Sheet
from foldcut.core.text import as_title
from foldcut.core.units import in_mm, rounded_up
from foldcut.drawing.curved import curves_of
from foldcut.drawing.graph import MOST_EDGES, CutGraph, make_graph
from foldcut.drawing.laying import Laying
from foldcut.drawing.limits import Limits
from foldcut.drawing.mend import Preparation, Prepared, prepare, refuse_changes
from foldcut.drawing.placement import Layout, parse_scale
from foldcut.drawing.shape import LARGEST_NUMBER, make_shape
from foldcut.geometry.curves import CurvedLoop
from foldcut.methods import AUTO, METHODS, auto, check_choice, check_graph, fewer_creases
from foldcut.methods.auto import FOLDED, Attempt
from foldcut.methods.base import AS_TOLERATED, FILE_ROUNDING, Effort, Made, Problem, Wishes
from foldcut.methods.frame import cut_down
from foldcut.methods.progress import Progress, Stages
from foldcut.options import Options
from foldcut.pattern.foldability import Foldability, crease_numbers, foldability, remedies
from foldcut.proof.verify import verify
from foldcut.readers import Drawing, ReadOptions, read_shape
from foldcut.redraw.bounds import FOLD_REDRAWN, HANDS_FOLDS, Bounds
from foldcut.redraw.deviation import moved_by
from foldcut.redraw.ladder import Drawn, Ladder, Level, Tried, redraw_and_fold
from foldcut.samples import drawing_path

if TYPE_CHECKING:
    from foldcut.folding_steps.phases import Phase
    from foldcut.methods.disks.method import DiskStages
    from foldcut.output.recipe import Recipe
    from foldcut.output.render import JobOptions
    from foldcut.pattern.difficulty import Difficulty
    from foldcut.profiles import Profile

__all__ = ["Progress", "Result", "fold"]

ROUNDING = 2e-6
"""What moved by less than this, relative to the drawing's size, was only rounded and is not reported."""

MOST_LINES = 60
"""A graph with more lines is simplified, unless that is forbidden: a pattern of more is for no hands."""

SIMPLER_LINES = (0.001, 0.002, 0.004, 0.008, 0.016)
"""How far lines may be off then, relative to the drawing's size."""

READ = 0.02
"""The part of the whole progress, from 0 to 1, that is reached once the drawing is read and laid on its sheet."""


@dataclass(frozen=True, eq=False)
class Result:
    """A pattern, how it folds, how it was made, and what verification found.

    ``findings`` is empty exactly when the pattern is verified. ``method`` made it; ``attempts`` say what came of each
    method that was tried. ``actions``: how many straight folds the search took it for; ``folds`` is what was counted.
    ``ribbon``: the half-width in mm of the strip along the cut that is not folded. ``told`` and ``numbers`` say how the
    method found the pattern, in words and for programs; ``stages`` is what the method's own stages made.
    ``seconds``: the time of each stage, and the totals "build" and "verify". ``notes``: what was done to the drawing
    (left out, mended, simplified); ``prepared``: its loops before and after, if they were prepared. ``drawing``: what
    was read, unless the shape was given as points.
    """

    folded_pattern: FoldedPattern
    findings: tuple[Finding, ...]
    stages: object
    method: str
    actions: int
    attempts: tuple[Attempt, ...]
    ribbon: float
    seconds: dict[str, float]
    notes: tuple[str, ...]
    drawing: Drawing | None = None
    prepared: Prepared | None = None
    told: tuple[str, ...] = ()
    numbers: Mapping[str, float] = field(default_factory=dict)
    ladder: Ladder | None = None
    options: Options = field(default_factory=Options)
    file: str = ""

    @property
    def phases(self) -> tuple[Phase, ...]:
        """The simple folds, and the creases that close together, in the order in which they are folded.

        There are none where the pattern has so many creases that they were not counted.
        """
        return () if self.ladder is None else self.ladder.level.phases

    @property
    def folds(self) -> int:
        """How many folds a person makes: the sum of ``phases``, or else ``actions``, which the search estimated."""
        return sum(phase.count for phase in self.phases) or self.actions

    @cached_property
    def foldability(self) -> Foldability:
        """How hard the pattern is to fold and to cut, if the sheet is office paper."""
        return foldability(self.folded_pattern, method=fewer_creases())

    @cached_property
    def difficulty(self) -> Difficulty:
        """How difficult the pattern is for a person with a sheet of office paper, in words."""
        from foldcut.folding_steps.phases import difficulty_of

        return difficulty_of(self.phases, self.foldability, self.actions)

    @property
    def drawn(self) -> tuple[Floats, ...]:
        """The loops of the drawing on the sheet, ``(n, 2)`` mm each, if another outline is cut out; otherwise none."""
        return self.folded_pattern.drawn

    @property
    def construction(self) -> DiskStages | None:
        """The stages by which the pattern was built, for pictures of them; None where the method has no pictures."""
        return cast("DiskStages", self.stages) if METHODS[self.method].construction else None

    @property
    def verified(self) -> bool:
        """Whether verification found nothing wrong."""
        return not self.findings

    def require_verified(self) -> FoldedPattern:
        """Return the pattern for an exporter, or raise ``VerificationError`` with the findings."""
        if self.findings:
            raise VerificationError(self.findings)
        return self.folded_pattern

    def save(
        self,
        path: str | PathLike[str],
        profile: str | Profile | None = None,
        job: JobOptions | None = None,
        *,
        force: bool = False,
    ) -> tuple[Path, ...]:
        """Write the pattern, or with a machine's ``profile`` its job, to the format that the name's ending says.

        The bytes are those of ``foldcut make`` with the same options. A PDF is for the home printer and a DXF for any
        laser unless a ``profile`` is named; ``foldcut profiles`` lists them. ``job``: what else ``make`` takes for a
        machine, such as its material. Returns the files that were written: a job of two sides may have two.

        Raises ``VerificationError`` for a pattern that is not verified, ``BadInputError`` where it cannot be written
        like that, and unless ``force`` is true also where a file is there already.
        """
        from foldcut.output.saving import pattern_files

        path = Path(path)
        files = pattern_files(self.require_verified(), path, self._recipe("make"), self.options.sheet, profile, job)
        return _written(files, force)

    def save_guide(self, path: str | PathLike[str], *, force: bool = False) -> Path:
        """Write how a person folds the pattern, as PDF, HTML or animated SVG; errors as of ``save``."""
        from foldcut.output.saving import guide_file

        path = Path(path)
        _written({path: guide_file(self.require_verified(), path, self._recipe("guide"))}, force)
        return path

    def _recipe(self, command: str) -> Recipe | None:
        """Return how a file was made, if the command line can make it again: not of loops, which are in no file."""
        from foldcut.output.recipe import Recipe

        words = self.options.words()
        if not self.file or words is None or self.drawing is None:
            return None
        return Recipe(command, words, self.file, self.drawing.sha256)

    def __repr__(self) -> str:
        pattern = self.folded_pattern
        name = f"{self.title} " if self.title else ""
        creases = pattern.creases.crease_count
        proven = "verified" if self.verified else f"not verified: {self.findings[0]}"
        return f"<Result {name}on {pattern.sheet}: {self.folds} folds, {creases} creases by {self.method}, {proven}>"

    @property
    def title(self) -> str:
        """What the pattern is called."""
        return self.folded_pattern.title

    def _repr_html_(self) -> str:
        """Show the page of a verified pattern in Jupyter, in a frame of its own, or what is wrong with the pattern."""
        from foldcut.exporters import export

        if self.findings:
            return "<br>".join(html.escape(str(finding)) for finding in self.findings)
        page = html.escape(export(self.folded_pattern, ".html").decode())
        return (
            f'<iframe srcdoc="{page}" sandbox="allow-scripts" style="width: 100%; height: 48rem; border: 0"></iframe>'
        )

    def _repr_svg_(self) -> str | None:
        """Show the drawing of a verified pattern where a page cannot be shown."""
        from foldcut.exporters import export

        return None if self.findings else export(self.folded_pattern, ".svg").decode()


def fold(
    shape: Shape | Drawing | Sequence[ArrayLike] | str | PathLike[str],
    options: Options | Sheet | str | None = None,
    *,
    progress: Progress | None = None,
    on_pattern: Callable[[Level], None] | None = None,
    **changes: Any,
) -> Result:
    """Compute how to fold a sheet so that one straight cut cuts ``shape`` out, and verify it.

    ``shape`` is a file's path, the name of a sample, loops of points (even-odd), a shape, or a drawing.

    ``options`` say how (see ``Options``), or only the sheet, such as "a5"; whatever is given by name beside them goes
    before them: ``fold("fish", "a5", margin="15mm")``. Lengths are in mm, or texts such as "10mm".

    The drawing is tried as it is, and if that is not for two hands (more than 60 folds, or a crease under 3 mm on A4),
    outlines that are at most 0.25, 0.5, 1, 2 and 4 mm off on A4, in proportion on other sheets. The most exact one for
    two hands is taken, or the one that is easiest to fold if there is none; ``Result.ladder`` has them all.

    ``progress`` is called with a stage's name and how much is done, from 0 to 1; ``on_pattern`` with each verified
    pattern that is better than the ones before, the first at once. Ctrl-C ends the search with the best one.

    Raises ``BadInputError`` for what cannot be used, ``UnfoldableError`` for what cannot be folded, and
    ``CreaseTooShortError``, an ``UnfoldableError``, for a verified pattern with too short a crease. A pattern that
    fails verification is returned with its findings; ``Result.require_verified`` refuses it.
    """
    if not isinstance(options, Options):
        options = Options() if options is None else Options(sheet=options)
    asked = options.but(changes)
    method, level, exact, preparation = asked.method, asked.level, asked.exact, asked.preparation
    tolerance, simplify, adjust = in_mm(asked.tolerance), in_mm(asked.simplify), in_mm(asked.adjust)
    ribbon, min_crease = in_mm(asked.ribbon), in_mm(asked.min_crease)
    symmetry = AS_TOLERATED if asked.symmetry == AUTO else in_mm(asked.symmetry)
    check_choice(method)
    exertion = Effort(asked.effort, asked.seconds)
    wishes = Wishes(ribbon, min_crease, symmetry, adjust)
    stages = Stages(progress)
    stages.up_to(READ)
    if (exact or level == "exact") and (simplify or symmetry or adjust):
        raise BadInputError("--exact forbids to move corners; leave it out, or --simplify, --symmetry and --adjust")
    if tolerance is None and simplify > 0 and not level:
        tolerance = simplify
    if method not in FOLD_REDRAWN and tolerance is not None and not simplify:
        simplify = tolerance  # as near as these methods come: corners are left out
    if exact is None:
        exact = method != AUTO and METHODS[method].needs_ribbon and tolerance is None and not level
    corners = None if preparation is None else preparation.corners
    folds = HANDS_FOLDS if asked.folds is None else asked.folds
    bounds = Bounds(tolerance, level, exact, folds, corners, asked.small_parts, asked.next_level, method)
    with stages("reading"):
        paper = asked.paper
        _check_lengths(
            paper,
            {
                "--ribbon": ribbon,
                "--min-crease": min_crease,
                "--tolerance": tolerance,
                "--simplify": simplify,
                "--symmetry": None if asked.symmetry == AUTO else symmetry,
                "--adjust": adjust,
            },
        )
        layout = _layout(paper, asked)
        if isinstance(shape, str | PathLike):
            shape = drawing_path(shape)
        file = shape.name if isinstance(shape, Path) else ""
        near = 0.0 if bounds.is_exact else simplify or tolerance
        read = _read(shape, asked.limits, layout, preparation, near)
        if read.outline.is_graph:
            bounds, simplify = _bounds_of_graph(bounds, preparation), 0.0
        if read.outline.lines and ribbon:
            raise BadInputError(
                "--ribbon keeps folds away from the cut, and lines of this drawing are folded on it; leave it out"
            )
        mirrored = preparation is not None and preparation.mirror
        laying = Laying(read.outline, read.layout, simplify, mirrored=mirrored, y_down=read.y_down)
        may_turn = layout.rotation is None and layout.offset is None
        title = as_title(asked.title or read.title)
        drawn = Drawn(read.whole or read.outline, laying, title, read.curves(mirrored=mirrored), may_turn)
        laying.lay()
    stages.up_to(READ)

    def fold_outline(laying: Laying, wishes: Wishes, effort: Effort, stages: Stages) -> Tried:
        problem = Problem(laying.lay(), laying.lay, wishes, may_turn, stages)
        return _on_less_paper(method, problem, effort, laying)

    ladder = redraw_and_fold(drawn, bounds, wishes, fold_outline, exertion, stages, on_pattern=on_pattern)
    stages.seconds["build"] = sum(stages.seconds.values()) - stages.seconds.get("verify", 0.0)
    taken = ladder.level
    tried, pattern = taken.tried, taken.pattern
    assert tried is not None
    assert pattern is not None
    made = tried.made
    loops = shape if read.drawing is None else read.drawing.own_coordinates()
    return Result(
        replace(pattern, moved_by=_moved_by(pattern, loops)),
        tried.findings,
        made.detail,
        made.method,
        made.actions,
        tried.attempts,
        made.ribbon,
        stages.seconds,
        (*tried.notes, *read.notes, *taken.notes, *made.laid.notes),
        read.drawing,
        read.prepared,
        made.told,
        made.numbers,
        ladder,
        asked,
        file,
    )


def _written(files: Mapping[Path, bytes], force: bool) -> tuple[Path, ...]:
    """Write files and return their names; without ``force`` none is replaced."""
    from foldcut.output.atomic import OutputError, write_files

    there = next((path for path in files if path.exists()), None)
    if there is not None and not force:
        raise OutputError(
            f"cannot write {there}: it is there already; replace it with force=True, or give another name"
        )
    write_files(files, replace=force)
    return tuple(files)


def _layout(sheet: Sheet, options: Options) -> Layout:
    """Return where the drawing lies on the sheet."""
    offset = None if options.offset is None else (in_mm(options.offset[0]), in_mm(options.offset[1]))
    margin, width, height = in_mm(options.margin), in_mm(options.width), in_mm(options.height)
    scale = parse_scale(options.scale) if isinstance(options.scale, str) else options.scale
    return Layout(sheet, margin, scale, offset, options.rotation, width, height)


def _bounds_of_graph(bounds: Bounds, preparation: Preparation | None) -> Bounds:
    """Return the bounds for open lines and outlines that touch, which are not drawn anew.

    Raises ``BadInputError`` for a method and for options that are for closed outlines only.
    """
    check_graph(bounds.method)
    preparation = preparation or Preparation()
    asked = {
        "--corners": preparation.corners,
        "--min-feature": preparation.min_feature,
        "--separate": preparation.separate,
    }
    given = [option for option, value in asked.items() if value]
    if given:
        raise BadInputError(
            f"{given[0]} is for closed outlines that lie apart, and this drawing has open lines or outlines that "
            "touch; leave it out"
        )
    return replace(bounds, exact=True, tolerance=None, level="")


def _check_lengths(sheet: Sheet, lengths: Mapping[str, float | None]) -> None:
    """Raise ``BadInputError`` for a length on the sheet that has no room there: the search would never end."""
    for option, length in lengths.items():
        if length is not None and length > sheet.diagonal:
            raise BadInputError(
                f"{option} is {length:.4g} mm, and the sheet {sheet} is {sheet.diagonal:.4g} mm from corner to corner; "
                "give a shorter length"
            )


def _moved_by(pattern: FoldedPattern, drawn: object) -> float | None:
    """Return by how many mm the outline was moved from what was drawn: a shape, or loops in the file's coordinates."""
    if pattern.shape.is_graph:
        return None
    loops = drawn.loops if isinstance(drawn, Shape) else cast(Sequence[ArrayLike], drawn)
    try:
        on_sheet = [pattern.placement.apply(points_array(loop)) for loop in loops]
        return moved_by(pattern.shape.loops, make_shape(prepare(on_sheet, Preparation()).loops).loops)
    except ShapeError:  # it can be folded only because something was left out on request
        return None


def _on_less_paper(method: str, problem: Problem, effort: Effort, laying: Laying) -> Tried:
    """Do as ``_folded``, on the sheet cut down if it does not fold otherwise, or takes more folds than hands like.

    A note says so. A drawing that is to lie at a certain place stays there.
    """
    smaller = cut_down(problem.laid) if laying.layout.offset is None else None
    whole: Tried | UnfoldableError
    try:
        whole = _folded(method, problem, effort)
        made = whole.made
        may_help = method == AUTO or METHODS[made.method].cuts_down
        if not may_help or _folds(made) <= HANDS_FOLDS or made.interrupted:
            smaller = None
    except UnfoldableError as error:
        whole = error
    if smaller is not None:
        ends_the_search = () if isinstance(whole, UnfoldableError) else (KeyboardInterrupt,)
        with suppress(FoldcutError, *ends_the_search):
            part = _folded(method, _laid_on(problem, laying, *smaller), effort)
            if isinstance(whole, UnfoldableError) or (not part.findings and _folds(part.made) < _folds(whole.made)):
                sheet = smaller[0]
                why = "the whole sheet has no pattern" if isinstance(whole, UnfoldableError) else "it takes fewer folds"
                note = f"cut the sheet down to {sheet.width:g} by {sheet.height:g} mm first: {why}"
                return replace(part, notes=(note,))
    if isinstance(whole, UnfoldableError):
        raise whole
    return whole


def _folds(made: Made) -> int:
    """Return how many straight lines are folded."""
    return crease_numbers(made.creases).lines


def _laid_on(problem: Problem, laying: Laying, sheet: Sheet, margin: float) -> Problem:
    """Return a problem with the shape laid on another sheet, as large as before."""
    laying = replace(laying, layout=replace(laying.layout, sheet=sheet, margin=margin))
    return replace(problem, laid=laying.lay(), lay=laying.lay)


def _folded(method: str, problem: Problem, effort: Effort) -> Tried:
    """Fold by a method and verify."""
    stages, wishes = problem.stages, problem.wishes
    made, attempts = auto.run(method, problem, effort)
    stages.up_to(FOLDED)
    stages.up_to(1.0)
    with stages("verify"):
        findings = verify(made.creases, made.folded.layers, made.laid.shape)
    if not findings:
        least = METHODS[made.method].min_crease_mm if made.min_crease_mm is None else made.min_crease_mm
        least = least if wishes.min_crease is None else wishes.min_crease
        _require_length(made, least, {attempt.method for attempt in attempts})
    return Tried(made, attempts, tuple(findings))


@dataclass(frozen=True, eq=False)
class _Read:
    """A drawing that has become a shape, and how it is to be laid, in its own units.

    ``whole``: the shape with all of its corners, if some were left out to keep to a number.
    """

    outline: Shape
    layout: Layout
    title: str = ""
    y_down: bool = False
    notes: tuple[str, ...] = ()
    drawing: Drawing | None = None
    prepared: Prepared | None = None
    whole: Shape | None = None

    def curves(self, *, mirrored: bool) -> tuple[CurvedLoop, ...]:
        """Return the loops of ``whole``, or else ``outline``, as they were drawn, where curves are known."""
        if self.drawing is None or not self.drawing.curves or self.outline.is_graph:
            return ()
        return curves_of(self.whole or self.outline, self.drawing.loops, self.drawing.curves, mirrored=mirrored)


def _read(
    shape: Shape | Drawing | Sequence[ArrayLike] | Path,
    limits: Limits | None,
    layout: Layout,
    preparation: Preparation | None,
    near: float | None,
) -> _Read:
    """Read a drawing, mend it as ``preparation`` says, and make a shape of it.

    ``near``: how far lines of a graph may be off in mm, None for as far as needed.
    """
    if isinstance(shape, Path):
        shape = read_shape(shape, ReadOptions(limits=limits or Limits()))
    if isinstance(shape, Shape):
        return _Read(shape, layout)
    drawing = shape if isinstance(shape, Drawing) else None
    loops = shape.loops if isinstance(shape, Drawing) else shape
    notes: tuple[str, ...] = ()
    if drawing is not None:
        notes = (*drawing.notes, *drawing.repairs)
        if preparation is not None and preparation.strict:
            refuse_changes(drawing.repairs)
        if not isinstance(layout.scale, str):
            layout = replace(layout, scale=layout.scale * (drawing.unit_mm or 1.0))
    title, y_down = ("", False) if drawing is None else (drawing.title, drawing.y_down)
    graph = _graph_as_drawn(loops, drawing, preparation)
    if graph is not None and drawing is not None and drawing.lines:
        apart = next(graph.shapes())
        if not apart.is_graph:  # these lines are closed outlines and nothing else
            drawing, loops = replace(drawing, loops=apart.loops, lines=()), apart.loops
            notes, graph = (*notes, *_joined(graph, drawing)), None
    if graph is not None:
        outline, more = _of_graph(graph, layout, near, preparation, drawing)
        return _Read(outline, layout, title, y_down, (*notes, *more), drawing)
    prepared = whole = None
    if preparation is not None:
        unit = layout.place(_hull(loops))[2].scale
        prepared = prepare([points_array(loop) * unit for loop in loops], preparation)
        notes = (*notes, *prepared.changes)
        loops = [loop / unit for loop in prepared.loops] if prepared.changes else loops
        whole = None if prepared.whole is None else make_shape([loop / unit for loop in prepared.whole])
    try:
        outline = make_shape(loops, y_down=y_down)
    except TouchError as error:
        outline, simplified = _touching(loops, error, layout, near, y_down=y_down)
        notes = (*notes, *simplified)
    return _Read(outline, layout, title, y_down, notes, drawing, prepared, whole)


def _graph_as_drawn(
    loops: Sequence[ArrayLike], drawing: Drawing | None, preparation: Preparation | None
) -> CutGraph | None:
    """Return the graph of a drawing with open lines, or of loops that meet in corners and nowhere else; or None."""
    y_down = drawing is not None and drawing.y_down
    if drawing is not None and drawing.lines:
        return make_graph((), drawing.lines, join=drawing.join, y_down=y_down)
    if preparation is not None and (preparation.separate or preparation.min_feature):
        return None  # then outlines may be set apart
    if sum(len(np.asarray(loop)) for loop in loops) > MOST_EDGES:
        return None
    try:
        make_shape(loops)
    except TouchError:
        graph = make_graph([points_array(loop) for loop in loops], (), y_down=y_down)
        return graph if graph.is_as_drawn else None
    except ShapeError:
        pass
    return None


def _of_graph(
    graph: CutGraph, layout: Layout, near: float | None, preparation: Preparation | None, drawing: Drawing | None
) -> tuple[Shape, tuple[str, ...]]:
    """Return a graph as a shape, and notes on it."""
    notes = [*_joined(graph, drawing)]
    graph, simplified = _simplified(graph, layout, near)
    notes += simplified
    if near != 0.0:
        graph, drawn = graph.symmetric(FILE_ROUNDING * graph.size), graph
        moved = float(np.hypot(*(graph.graph.points - drawn.graph.points).T).max())
        if moved > ROUNDING * graph.size:
            notes.append(
                f"made exactly symmetric; points moved by at most {moved / graph.size:.1g} of the drawing's size"
            )
    if preparation is not None and preparation.mirror:
        graph = graph.mirrored()
        notes.append("mirrored, left to right")
    return next(graph.shapes()), tuple(notes)


def _joined(graph: CutGraph, drawing: Drawing | None) -> tuple[str, ...]:
    """Return a note on how far ends of lines were moved to be joined, if they were."""
    unit = None if drawing is None else drawing.unit_mm
    if graph.moved <= ROUNDING * graph.size:
        return ()
    most = f"{graph.moved:.2g}" if unit is None else f"{graph.moved * unit:.2g} mm"
    return (f"ends of lines were joined, and moved by at most {most} for that",)


def _simplified(graph: CutGraph, layout: Layout, near: float | None) -> tuple[CutGraph, list[str]]:
    """Return a graph with points left out within ``near`` mm, and a note on it.

    None: only where there are too many edges, and within the least tolerance that leaves few enough.
    """
    before, scale = len(graph.graph.edges), layout.place(next(graph.shapes()))[2].scale
    if near is not None:
        tolerances: Sequence[float] = (near,) if near else ()
    else:
        tolerances = [part * graph.size * scale for part in SIMPLER_LINES] if before > MOST_LINES else ()
    found = graph
    for tolerance in tolerances:
        found = graph.simplified(tolerance / scale)
        if len(found.graph.edges) <= MOST_LINES:
            break
    after = len(found.graph.edges)
    notes = [f"simplified: {before} -> {after} lines, at most {rounded_up(tolerance)} mm off"] if after < before else []
    return found, notes


def _touching(
    loops: Sequence[ArrayLike], error: TouchError, layout: Layout, near: float | None, *, y_down: bool
) -> tuple[Shape, list[str]]:
    """Return loops that touch as a shape, and notes on it; raise ``error``, which says where, if that is no graph."""
    try:
        graph = make_graph([points_array(loop) for loop in loops], (), y_down=y_down)
        graph, notes = _simplified(graph, layout, near)
    except ShapeError:
        raise error from None
    return next(graph.shapes()), notes


def _hull(loops: Sequence[ArrayLike]) -> Shape:
    """Return the convex hull of loops, which has their width and height; raises ``ShapeError`` where there is none."""
    points = [np.asarray(loop, dtype=np.float64) for loop in loops]
    if not points or not all((np.abs(loop) < LARGEST_NUMBER).all() for loop in points):  # nan compares as False
        return make_shape(points)  # which says where
    hull = shapely.convex_hull(shapely.multipoints(np.concatenate(points)))
    return make_shape([shapely.get_coordinates(hull)] if isinstance(hull, shapely.Polygon) else points)


def _require_length(made: Made, least: float, tried: set[str]) -> None:
    """Refuse a crease shorter than ``least`` mm, and say what to do; ``tried``: methods that need not be named."""
    numbers = crease_numbers(made.creases)
    length, at = numbers.shortest_crease_mm, numbers.shortest_crease_at
    if length is None or at is None or length >= least:
        return
    shape = made.laid.shape
    method = fewer_creases(tried)
    remedy = remedies(made.laid.sheet, least / length, len(shape.loops), method, simplify=not shape.is_graph)
    raise CreaseTooShortError(
        f"the crease at ({at[0]:.4g}, {at[1]:.4g}) is only {_two_digits(length)} mm long, shorter than {least:g} mm; "
        f"{remedy}, or allow it with --min-crease {_rounded_down(length)}mm",
        length,
        at,
    )


def _two_digits(length: float) -> str:
    """Return a length in two digits, without an exponent."""
    return f"{length:.0f}" if length >= 100 else f"{length:.2g}"


def _rounded_down(length: float) -> str:
    """Return a length rounded down to two digits, so that the crease is not shorter than that."""
    digits = 1 - math.floor(math.log10(length))
    return f"{math.floor(length * 10**digits) / 10**digits:g}"
