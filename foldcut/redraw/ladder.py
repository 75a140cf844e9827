"""The ladder: one tolerance after another, what each costs to fold, and which of them is taken.

A drawing, how it is laid, ``Bounds``, and what folds an outline -> ``Ladder``: a ``Level`` for each tolerance that was
tried. Taken is the most exact level for two hands: with few folds and no crease that is too short. If there is none,
the one that is easiest to fold is taken.

The search ends with the best level so far at Ctrl-C and when a limit in seconds has passed. Without such a limit all
work is counted, so that the result is the same on every machine.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.errors import CreaseTooShortError, UnfoldableError
from foldcut.core.model import Finding, FoldedPattern, Shape
from foldcut.core.units import rounded_up
from foldcut.drawing.laying import Laid, Laying
from foldcut.drawing.placement import Layout, parse_sheet
from foldcut.geometry.curves import CurvedLoop
from foldcut.geometry.dihedral import dihedral
from foldcut.geometry.mirror_axes import mirror_axes
from foldcut.methods import last_resort
from foldcut.methods.auto import Attempt
from foldcut.methods.base import AS_TOLERATED, Effort, Made, Wishes
from foldcut.methods.frame import ADJUST
from foldcut.methods.progress import Stages
from foldcut.pattern.foldability import layers_at_cut
from foldcut.pattern.ranking import Rank, rank, shortest_crease
from foldcut.proof.verify import verify
from foldcut.redraw.bounds import ANY_METHOD, FOLD_REDRAWN, HANDS_CREASE_MM, HANDS_FOLDS, Bounds
from foldcut.redraw.distance import apart

if TYPE_CHECKING:
    from foldcut.folding_steps.phases import Phase
    from foldcut.folding_steps.simple_first import Easier
    from foldcut.redraw.plans import Drawing
    from foldcut.redraw.redrawing import Redrawn

__all__ = ["Drawn", "Fold", "Ladder", "Level", "Tried", "redraw_and_fold"]

CORNERS_FOR_A_FOLD = 1.0
"""A drawing with more corners than this for each fold that is allowed is not tried as it is: it is not for hands. Of a
symmetric drawing those on one side of its axes count."""

FEWER_CORNERS_FOR_A_FOLD = 0.65
"""The same where outlines that are far off may be tried: then it takes longer than those, and finds more folds."""

FAR_OFF = 1.0
"""Outlines that are at least so much off, in mm of the frame, are far off."""

FOLDS_FOR_A_CORNER = 2.0
"""Patterns of curved drawings have at least this many folds for each corner of an outline, or of its part between axes.

With more than are allowed, a tolerance is passed over if a larger one is to come. Measured: 2.2 and more as a whole,
1.7 and more in halves (letters and icons at 2 and 4 mm)."""

MOST_CORNERS_FOR_A_FOLD = 1.0
"""With more corners than this for each fold, a tolerance is passed over even if there are mirror axes, one or two."""

FIT = 0.6
"""An outline whose lines lie on both sides of a curve has about this many corners for each that chords need."""

LOOK_FIRST = 30
"""A drawing with more corners than this gets a short look first, and is folded in earnest only if that is promising."""

PROMISING, PROMISING_IF_FAR = 2.0, 1.2
"""A short look is promising if it finds at most the first times the folds that are allowed, at most the second where
outlines that are far off may be tried."""

THOROUGH = 2.0
"""Where a search nearly has a pattern for two hands, it is made once more within at least so many mm of the frame, and
within the last tolerance: a larger one takes no longer, and mostly has one."""

SHARE_OF_SECONDS = 0.4
"""The part of the seconds left that the methods get for each outline, where the time is limited by the clock."""

NOT_MOVED = 1e-6
"""An outline that is no farther than this from the drawing, in mm of the frame, has not moved."""

SYMMETRIC_MM = 0.5
"""How far corners may be off in a drawing that is taken as symmetric without a tolerance, if that is to be looked for,
in mm of the frame."""

SEEN_MM = 0.05
"""What moved by less than this, in mm on the sheet, is not drawn as it was before."""

SIMPLER = (1.0, 4.0, 8.0, 16.0)
"""The tolerances, in mm of the frame, among which one is looked for that helps where nothing folds."""

MOST_STEPS = 300
"""Folds that can be made one after another are counted in patterns with at most this many creases."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """A drawing and how it is laid.

    ``whole``: the drawing before anything in it was moved, in the units of ``laying.outline``, which may have fewer
    corners already; ``title``: its name.
    """

    whole: Shape
    laying: Laying
    title: str = ""
    curves: tuple[CurvedLoop, ...] = ()
    may_turn: bool = False


@dataclass(frozen=True, eq=False)
class Tried:
    """What folding an outline came to: the pattern, what came of each method, what verification found, and notes."""

    made: Made
    attempts: tuple[Attempt, ...]
    findings: tuple[Finding, ...] = ()
    notes: tuple[str, ...] = ()


Fold = Callable[[Laying, Wishes, Effort, Stages], Tried]
"""Folds an outline as it is laid, and verifies the pattern.

Raises ``UnfoldableError`` where there is no pattern, or one with too short a crease.
"""


@dataclass(frozen=True, eq=False)
class Level:
    """What one tolerance costs; lengths in mm on the sheet.

    ``tolerance_mm``: how far the outline was allowed to be from the drawing; ``off_by_mm``: how far it is. ``laid``:
    the outline on its sheet, None where none was found; ``tried``: its pattern, None where there is none. ``failure``
    says why. ``known``: its phases, if they were counted.
    ``folds``: straight folds that a person makes; ``layers``: how many the cut goes through. ``seconds``: how long it
    took. ``for_hands``: it has few enough folds and no crease that is too short. ``drawn``: the drawing on the same
    sheet, if the outline is another. ``notes``: what was done to the drawing. ``scale``: mm for each mm of the frame.
    """

    tolerance_mm: float
    scale: float
    off_by_mm: float = 0.0
    laid: Laid | None = None
    tried: Tried | None = None
    corners: int = 0
    folds: int | None = None
    shortest_mm: float | None = None
    layers: int | None = None
    for_hands: bool = False
    failure: str = ""
    seconds: float = 0.0
    drawn: tuple[Floats, ...] = ()
    notes: tuple[str, ...] = ()
    title: str = ""
    known: tuple[Phase, ...] = ()

    @property
    def shape(self) -> Shape | None:
        """The outline on its sheet."""
        return None if self.laid is None else self.laid.shape

    @property
    def made(self) -> Made | None:
        """The pattern and how it was found."""
        return None if self.tried is None else self.tried.made

    @property
    def verified(self) -> bool:
        """Whether there is a pattern and verification found nothing wrong with it."""
        return self.tried is not None and not self.tried.findings

    @property
    def rank(self) -> Rank:
        """How hard the pattern is to fold, for an outline that has one."""
        assert self.folds is not None
        assert self.shortest_mm is not None
        return rank(self.folds, self.shortest_mm / self.scale)

    @cached_property
    def pattern(self) -> FoldedPattern | None:
        """The pattern as exporters take it."""
        return None if self.made is None else pattern_of(self.made, self.title, self.drawn)

    @cached_property
    def phases(self) -> tuple[Phase, ...]:
        """How many simple folds are made one after another, and how many creases then close together, and so on.

        None are known where there is no pattern, and where it has so many creases that nobody has counted them.
        """
        pattern = self.pattern
        if self.known or pattern is None or pattern.creases.crease_count > MOST_STEPS:
            return self.known
        from foldcut.folding_steps import folding_steps, phases

        return phases(pattern, folding_steps(pattern))

    @property
    def counted_folds(self) -> int | None:
        """How many folds a person makes: the sum of ``phases``, or else ``folds``, which the search took it for."""
        return sum(phase.count for phase in self.phases) or self.folds

    @property
    def simple_folds(self) -> int | None:
        """How many of the folds are simple folds, flat sheet to flat sheet; None where nobody has counted them."""
        return sum(phase.count for phase in self.phases if not phase.together) if self.phases else None


@dataclass(frozen=True, eq=False)
class Ladder:
    """The levels that were tried, the most exact first, and which one was ``taken``.

    ``folds``: how many folds were allowed; ``interrupted``: Ctrl-C or a limit in seconds ended the search early.
    """

    levels: tuple[Level, ...]
    taken: int
    folds: int
    interrupted: bool = False

    @property
    def level(self) -> Level:
        """The level that was taken."""
        return self.levels[self.taken]

    @property
    def after(self) -> Level | None:
        """The level after the one that was taken, which says what a larger tolerance would cost; None: not tried."""
        return self.levels[self.taken + 1] if self.taken + 1 < len(self.levels) else None


def pattern_of(made: Made, title: str, drawn: tuple[Floats, ...] = ()) -> FoldedPattern:
    """Return what a method made as exporters take it; ``drawn``: the drawing on the sheet, if it was drawn anew."""
    on = made.laid
    return FoldedPattern(
        made.creases,
        made.folded,
        on.sheet,
        on.shape,
        on.placement,
        title,
        made.first_folds,
        made.regions,
        drawn,
    )


def redraw_and_fold(
    drawn: Drawn,
    bounds: Bounds,
    wishes: Wishes,
    fold: Fold,
    effort: Effort,
    stages: Stages,
    *,
    on_pattern: Callable[[Level], None] | None = None,
) -> Ladder:
    """Fold a drawing at one tolerance after another and return what each costs.

    ``on_pattern`` is called with each verified pattern that is easier to fold, or nearer to the drawing, than those
    before: the first one at once. Where no tolerance has a pattern, the error of the drawing as it is is raised, with a
    larger tolerance that has one if there is any.
    """
    return _Search(drawn, bounds, wishes, fold, effort, stages, on_pattern).run()


def redraw(
    drawing: Drawing,
    tolerance: float,
    *,
    method: str,
    effort: str,
    found: Callable[[Redrawn], None],
    is_late: Callable[[], bool],
    progress: Callable[[str, float], None],
    compiled: Callable[[float], None],
    wanted: float,
    thorough: bool,
    needed: bool,
) -> None:
    """Search outlines as ``redrawing.redraw`` does, which is loaded now, and compiled where it has not been yet.

    ``compiled`` is called with the seconds that compiling took. A tolerance that is not ``needed`` gets less work.
    """
    from foldcut.redraw import compiling, redrawing

    compiled(compiling.get_ready(lambda text: progress(text, 0.0)))
    redrawing.redraw(
        drawing,
        tolerance,
        method=method,
        work=int((1.0 if needed else redrawing.LESS_WORK) * redrawing.WORK[effort]),
        found=found,
        is_late=is_late,
        progress=progress,
        wanted=wanted,
        thorough=thorough,
    )


@dataclass(eq=False)
class _Search:
    """The search over tolerances: ``levels`` are those tried so far.

    ``told`` is the best pattern that was handed over, ``latest`` the best of the tolerance that is being tried.
    ``drawing``: the drawing as the search for outlines takes it, once it is known.
    """

    drawn: Drawn
    bounds: Bounds
    wishes: Wishes
    fold: Fold
    effort: Effort
    stages: Stages
    on_pattern: Callable[[Level], None] | None
    levels: list[Level] = field(default_factory=list)
    interrupted: bool = False
    error: UnfoldableError | None = None
    told: Level | None = None
    latest: Level | None = None
    easier: dict[bytes, Easier | None] = field(default_factory=dict)
    drawing: Drawing | None = None

    def __post_init__(self) -> None:
        _, _, placement, _ = Layout(parse_sheet("a4"), rotation=0.0).place(self.drawn.whole)
        self.unit = placement.scale  # mm of the frame for each unit of the drawing
        self.scale = self.drawn.laying.lay().placement.scale / self.unit
        self.deadline = None if self.effort.seconds is None else time.monotonic() + self.effort.seconds
        self.more = 0
        self.since = self.until = self.stages.done

    def run(self) -> Ladder:
        """Try the tolerances, and decide."""
        tolerances = self.bounds.tolerances(self.scale)
        alone = len(tolerances) == 1
        for number, tolerance in enumerate(tolerances):
            self.more += any(level.for_hands for level in self.levels)
            self._progress_to(last=number == len(tolerances) - 1)
            try:
                last = number == len(tolerances) - 1
                level = self._redrawn(tolerance, last=last) if tolerance else self._as_it_is(alone=alone)
                if level is not None:
                    self._keep(level)
            except KeyboardInterrupt:
                self._keep_latest()
                if not any(level.verified for level in self.levels):
                    raise
                self.interrupted = True
                break
            if self._is_enough():
                break
        ladder = Ladder(tuple(self.levels), self._taken(), self.bounds.folds, self.interrupted)
        self.until = 1.0
        self._progress("verify", 1.0)  # as each of them was
        return ladder

    # ---- one level ----

    def _as_it_is(self, *, alone: bool) -> Level:
        """Fold the drawing as it is; if it may be drawn anew, only where that has a chance to be one for hands."""
        laying = self.drawn.laying
        corners = laying.outline.corner_count
        start = Level(0.0, self.scale, corners=corners, title=self.drawn.title)
        if not alone:
            far = self.bounds.tolerances(self.scale)[-1] >= FAR_OFF
            most = FEWER_CORNERS_FOR_A_FOLD if far else CORNERS_FOR_A_FOLD
            if self._corners_beside_axes() > most * max(self.bounds.folds, HANDS_FOLDS):
                failure = f"not tried: {corners} corners are too many for {self.bounds.folds} folds"
                return replace(start, laid=laying.lay(), failure=failure)
            if corners > LOOK_FIRST and self.effort.name != "fast" and self.effort.seconds is None:
                look = self._folded(start, effort=Effort("fast"), adjusts=not far)
                promising = PROMISING_IF_FAR if far else PROMISING
                if look.folds is None or look.folds > promising * self.bounds.folds:
                    return look
                self._tell(look)
        return self._folded(start)

    def _corners_beside_axes(self) -> float:
        """Return how many corners the drawing has in a sector between its mirror axes, or on one side of one."""
        shape = self.drawn.laying.outline
        allowed = self._wishes().axes_off(
            float(np.ptp(np.concatenate(shape.loops), axis=0).max()) * self.unit * self.scale
        )
        allowed /= self.unit * self.scale
        several = dihedral(shape, allowed)
        return shape.corner_count / (2 * several.count if several else 2 if mirror_axes(shape, allowed) else 1)

    def _redrawn(self, tolerance: float, *, last: bool) -> Level | None:
        """Draw the outline anew within a tolerance in mm of the frame, and fold it.

        Unless it is the ``last``, one at which the outline has too many corners is passed over.
        """
        started = time.perf_counter()
        drawing = self._drawing(tolerance)
        start = Level(tolerance * self.scale, self.scale, title=self.drawn.title, notes=_named(drawing, self))
        if not last:
            corners = round(FIT * drawing.chords())
            most, copies = self.bounds.folds, drawing.copies()
            many = copies <= 4 and corners > MOST_CORNERS_FOR_A_FOLD * most
            if many or FOLDS_FOR_A_CORNER * corners / copies > most:
                failure = f"not tried: about {corners} corners are too many for {self.bounds.folds} folds"
                return replace(start, failure=failure)
        needed = self.bounds.takes_fewest or not any(level.for_hands for level in self.levels)
        best: Level | None = None

        def found(one: Redrawn) -> None:
            nonlocal best
            long = self.wishes.min_crease is None or shortest_crease(one.made.creases) >= self.wishes.min_crease
            if long and self._has_few_corners(one.made.laid.shape):
                best = self._of_redrawn(start, drawing, one, time.perf_counter() - started)
                self._tell(best)

        try:
            redraw(
                drawing,
                tolerance,
                method=self.bounds.method,
                effort=self.effort.name,
                found=found,
                is_late=self._is_late,
                progress=self._progress,
                compiled=self._wait,
                wanted=math.inf if last else self.bounds.folds,
                thorough=needed and (last or tolerance >= THOROUGH),
                needed=needed,
            )
        finally:
            seconds = time.perf_counter() - started
            self.stages.seconds["outlines"] = self.stages.seconds.get("outlines", 0.0) + seconds
        if best is None:
            failure = "no outline with a pattern was found"
            return replace(start, laid=drawing.laid, failure=failure, seconds=seconds)
        return self._begun_simply(replace(best, seconds=time.perf_counter() - started))

    def _drawing(self, tolerance: float) -> Drawing:
        """Return the drawing as the search for outlines takes it."""
        from foldcut.redraw.plans import Drawing

        if self.drawing is not None:
            return self.drawing.within(tolerance)
        laying = replace(self.drawn.laying, simplify=0.0)
        if self.drawn.whole is not laying.outline:
            laying = replace(laying, outline=self.drawn.whole)
        self.drawing = Drawing.of(
            laying, self.drawn.curves, tolerance, self.bounds.small_parts, may_turn=self.drawn.may_turn
        )
        return self.drawing

    def _of_redrawn(self, level: Level, drawing: Drawing, one: Redrawn, seconds: float) -> Level:
        """Return a level with the pattern of a redrawn outline."""
        made, on = one.made, one.made.laid
        off = 0.0 if one.off < NOT_MOVED else one.off * self.scale
        started = time.perf_counter()
        findings = tuple(verify(made.creases, made.folded.layers, on.shape))
        spent = self.stages.seconds
        spent["verify"] = spent.get("verify", 0.0) + time.perf_counter() - started
        attempt = Attempt(made.method, made.creases.crease_count, made.actions, shortest_crease(made.creases), "")
        corners = f"{self.drawn.whole.corner_count} -> {on.shape.corner_count} corners"
        notes = (f"the outline was drawn anew, at most {rounded_up(off)} mm off: {corners}", *level.notes)
        drawn = drawing.on_sheet(one.plan) if off > SEEN_MM else ()
        tried = Tried(made, (attempt,), findings)
        return self._with_pattern(replace(level, notes=notes, drawn=drawn), tried, off, seconds)

    def _with_pattern(self, level: Level, tried: Tried, off: float, seconds: float) -> Level:
        """Return a level with a pattern and what is known of it; ``off``: how far the outline is from the drawing."""
        made, on = tried.made, tried.made.laid
        shortest = shortest_crease(made.creases)
        few, long = made.actions <= self.bounds.folds, shortest >= HANDS_CREASE_MM * self.scale * (1 - 1e-9)
        return replace(
            level,
            off_by_mm=off,
            laid=on,
            tried=tried,
            corners=on.shape.corner_count,
            folds=made.actions,
            shortest_mm=shortest,
            layers=layers_at_cut(made.creases.faces_vertices, made.folded, beside=bool(on.shape.lines)),
            for_hands=few and long and not tried.findings,
            failure=f"not verified: {tried.findings[0]}" if tried.findings else "",
            seconds=seconds,
        )

    def _begun_simply(self, level: Level) -> Level:
        """Return a level whose pattern begins with as many simple folds as its creases allow, and its phases if any.

        That takes as long as a good part of a search, so it is done with the best pattern of each tolerance only.
        """
        from foldcut.folding_steps.simple_first import easier

        tried = level.tried
        if tried is None or tried.findings:
            return level
        made = tried.made
        same = made.creases.vertices_coords.tobytes() + made.folded.layers.tobytes()
        same += made.laid.shape.points.tobytes()
        if same not in self.easier:  # one pattern may be found within several tolerances
            self.easier[same] = easier(pattern_of(made, ""))
        found = self.easier[same]
        if found is None:
            return level
        creases, folded = found.pattern.creases, found.pattern.folded
        made = replace(made, creases=creases, folded=folded, actions=min(made.actions, found.actions))
        level = self._with_pattern(level, replace(tried, made=made), level.off_by_mm, level.seconds)
        return replace(level, known=found.phases)

    def _has_few_corners(self, outline: Shape) -> bool:
        return self.bounds.corners is None or outline.corner_count <= self.bounds.corners

    def _folded(self, level: Level, *, effort: Effort | None = None, adjusts: bool = True) -> Level:
        """Fold the drawing as it is; unless it ``adjusts``, corners are not moved: with 60 that may take a minute."""
        started = time.perf_counter()
        laying, within = self.drawn.laying, Stages(self._progress)
        wishes = self._wishes() if adjusts else replace(self._wishes(), adjust=0.0)
        try:
            tried = self.fold(laying, wishes, self._part(effort or self.effort), within)
        except UnfoldableError as error:
            self.error = error
            return replace(level, laid=laying.lay(), failure=str(error), seconds=time.perf_counter() - started)
        finally:
            for name, seconds in within.seconds.items():
                self.stages.seconds[name] = self.stages.seconds.get(name, 0.0) + seconds
        self.interrupted |= tried.made.interrupted
        on = tried.made.laid
        before = laying.on_sheet(self.drawn.whole.loops, on)
        off = 0.0 if on.shape.is_graph else apart(on.shape.loops, before)
        off = 0.0 if off < NOT_MOVED * self.scale else off
        drawn = before if laying.simplify > 0 and off > SEEN_MM else ()
        found = self._with_pattern(replace(level, drawn=drawn), tried, off, 0.0)
        return replace(self._begun_simply(found), seconds=time.perf_counter() - started)

    def _wishes(self) -> Wishes:
        """Return what a method may do to the drawing as it is: move corners by hairs, as far as that is allowed."""
        wishes, bounds = self.wishes, self.bounds
        if bounds.is_exact:
            return replace(wishes, adjust=0.0, symmetry=0.0)
        if bounds.method not in FOLD_REDRAWN:  # it folds the drawing as it is, but it may make it symmetric
            return replace(wishes, adjust=0.0, symmetry=min(wishes.symmetry, bounds.tolerance or math.inf))
        most = bounds.most(self.scale)
        if wishes.symmetry == AS_TOLERATED:
            stated = bounds.tolerance is not None or bounds.level
            wishes = replace(wishes, symmetry=(most if stated else min(most, SYMMETRIC_MM)) * self.scale)
        if most >= ADJUST:
            return wishes
        adjust = most * self.scale if wishes.adjust is None else min(wishes.adjust, most * self.scale)
        return replace(wishes, adjust=adjust, symmetry=min(wishes.symmetry, most * self.scale))

    # ---- all levels ----

    def _keep(self, level: Level) -> None:
        self.levels.append(level)
        self._tell(level)

    def _keep_latest(self) -> None:
        """Keep the best pattern of a tolerance that the search has not done with."""
        latest = self.latest
        if latest is not None and all(level.tolerance_mm != latest.tolerance_mm for level in self.levels):
            self.levels.append(latest if latest.known else self._begun_simply(latest))

    def _tell(self, level: Level) -> None:
        """Hand a pattern to whoever waits for one, if it is better than the one before."""
        if not level.verified:
            return
        self.latest = level
        if self.on_pattern is None:
            return
        same = self.told is not None and self.told.tolerance_mm == level.tolerance_mm
        if self.told is None or self._key(level, exact=not same) < self._key(self.told, exact=not same):
            self.told = level
            self.on_pattern(level)

    def _key(self, level: Level, *, exact: bool = True) -> tuple[bool, bool, float, Rank]:
        """Return by what levels with patterns are compared: the least is taken.

        ``exact``: the nearer to the drawing, the better, if both are for two hands. An outline that was found within a
        larger tolerance may be the nearer one.
        """
        exact_first = exact and level.for_hands and not self.bounds.takes_fewest
        return (not level.verified, not level.for_hands, level.off_by_mm if exact_first else 0.0, level.rank)

    def _is_enough(self) -> bool:
        """Whether no more tolerances need be tried."""
        if self.interrupted or self._is_late():
            self.interrupted = True
            return True
        if self.bounds.takes_fewest:
            return False
        if self.levels and self.levels[0].for_hands and not self.levels[0].tolerance_mm:
            return True  # the drawing folds as it is, so nobody asks what else it would cost
        hands = any(level.for_hands for level in self.levels)
        return hands and self.more >= self.bounds.next_level

    def _wait(self, seconds: float) -> None:
        """Put off the end of the search by what is no part of it."""
        if self.deadline is not None:
            self.deadline += seconds

    def _is_late(self) -> bool:
        return self.deadline is not None and time.monotonic() > self.deadline

    def _taken(self) -> int:
        """Return the level that is taken; raises ``UnfoldableError`` where none has a pattern."""
        found = [(self._key(level), number) for number, level in enumerate(self.levels) if level.tried is not None]
        if found:
            return min(found)[1]
        if self.interrupted and self.effort.seconds is not None:
            raise UnfoldableError(
                f"no pattern was found in {self.effort.seconds:g} s; allow more with --seconds, or a larger --tolerance"
            )
        raise self._failure()

    def _failure(self) -> UnfoldableError:
        """Return the error where nothing folds, with what helps."""
        error, off = self.error, f"{self.levels[-1].tolerance_mm:.3g} mm"
        if error is None:  # as it is, the drawing has too many corners to be tried
            text = f"no outline within {off} of the drawing was found that has a pattern"
        elif len(self.levels) > 1:
            text = f"{error}; an outline within {off} of the drawing has no pattern, either"
        else:
            text = str(error)
        if self.bounds.method == ANY_METHOD and not self.drawn.whole.is_graph:
            text += self._remedies()
        if self.drawn.whole.touching and not self.drawn.whole.lines:
            text += "; outlines that touch are set apart with --separate 0.5mm"
        if isinstance(error, CreaseTooShortError):
            return CreaseTooShortError(text, error.length, error.place)
        return UnfoldableError(text)

    def _remedies(self) -> str:
        """Return what helps where nothing folds: the least of some larger tolerances that has a pattern."""
        text = ""
        for tolerance in SIMPLER:
            off = float(f"{tolerance * self.scale:.2g}")
            if off > self.levels[-1].tolerance_mm and not self._is_late():
                level = self._redrawn(off / self.scale, last=True)
                if level is not None and level.verified:
                    text = f"; {'leave out --exact' if self.bounds.is_exact else 'allow more'}: "
                    text += f"--tolerance {off:g}mm gives a pattern of {level.folds} folds"
                    break
        method = last_resort(len(self.drawn.whole.loops))
        return f"{text}; --method {method} may fold the drawing as it is, with thousands of folds"

    # ---- time ----

    def _part(self, effort: Effort) -> Effort:
        """Return the effort for the next outline, from what is left of a limit in seconds."""
        if self.deadline is None or self.bounds.is_exact:
            return effort
        left = max(0.05, self.deadline - time.monotonic())
        return replace(effort, seconds=SHARE_OF_SECONDS * left)

    def _progress_to(self, *, last: bool) -> None:
        """Say which part of the whole progress the next level takes: half of what is left, and the last one all."""
        self.since, self.until = self.until, 1.0 if last else (self.until + 1.0) / 2

    def _progress(self, text: str, fraction: float) -> None:
        self.stages.start, self.stages.until = self.since, self.until
        self.stages.tell(text, fraction)


def _named(drawing: Drawing, search: _Search) -> tuple[str, ...]:
    """Return a note for each small part: what and where it is, and what became of it."""
    done = {"drop": "left out", "keep": "kept", "enlarge": "enlarged"}[search.bounds.small_parts]
    return tuple(
        f"{done}: {part.named(drawing.place(part.place), drawing.frame.scale)}; it is too small for the tolerance "
        "(--small-parts)"
        for part in drawing.small_parts
    )
