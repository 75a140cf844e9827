"""Redraw a drawing within one tolerance, and fold it: better and better patterns, all verified.

``Drawing``, a tolerance -> ``Redrawn``s. The search judges outlines by a proxy; only those that promise more
than the best pattern so far are folded, and where the layers of one have no order, its cost is raised.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import islice

from foldcut.core.errors import FoldcutError
from foldcut.core.model import Shape
from foldcut.methods.base import Made
from foldcut.methods.mirror.skeletal import made_of_half
from foldcut.methods.skeleton.method import made_of_whole
from foldcut.methods.skeleton.quick import fold_outline
from foldcut.methods.skeleton.trial import Skeletal
from foldcut.pattern.ranking import shortest_crease
from foldcut.redraw.bounds import ANY_METHOD, HANDS_FOLDS
from foldcut.redraw.plans import Corners, Drawing, Plan, on_the_sheet, plans
from foldcut.redraw.proxy import LEAST_CREASE_MM, SHORT_COST, Assessment, Engine
from foldcut.redraw.search import Search
from foldcut.redraw.wedges import Around, around

MOST_FOLDED = 12, 36
"""How many outlines are folded at most in one search, and how many are tried at most."""

TRIES = 8, 200
"""How many sets of perpendiculars are tried for each: so many, or more if there are few corners."""

CHEAPER_TRIES = 3
"""How many cheaper sets are tried once one can be folded: they hardly ever can."""

MOST_FOLDS = 150
"""Outlines whose patterns have more folds are not for hands, and not folded."""

MOST_FOLDS_AT_LAST, MOST_TRIED_AT_LAST = 400, 6
"""The same while there is no pattern at the last tolerance, and how many outlines with so many folds are tried: each
takes about a second."""

MOST_OF_WEDGE = 24
"""How many outlines of a drawing with three axes or more are folded: where none of these is for two hands, hardly one
of the others is."""

REFUSED = 30.0
"""What is added to the cost of an outline whose layers have no order."""

MOST_REFUSED = 2
"""So many outlines with the same skeleton are refused before no more of them are folded."""

NEAR_MISS = 1.1
"""Where the best pattern has more folds than two hands can make, but no more than this many times, more is searched."""

DEAR = 20.0, 20.0
"""What a short crease costs, as ``SHORT_COST``, where the best pattern has few folds, but one crease is too short."""

MORE_STARTS = 1.1, 0.9
"""Then outlines are begun with that are made for so many times the tolerance."""

LESS_WORK = 0.4
"""The part of the work for each further plan once one has a pattern, for a tolerance that is not needed, and for a
second search that is not thorough."""

WORK = {"fast": 6_000, "normal": 20_000, "best": 200_000}
"""How much work a search by one plan is, by effort, in assessments of outlines."""


@dataclass(frozen=True, eq=False)
class Redrawn:
    """A verified pattern for a redrawn outline.

    ``shape`` is in mm of the frame; ``made`` is on the sheet that is asked for. ``folds``: straight folds; ``shortest``
    crease and ``off``, the distance between outline and drawing, in mm of the frame.
    """

    plan: Plan
    shape: Shape
    made: Made
    folds: int
    shortest: float
    off: float

    @property
    def is_for_hands(self) -> bool:
        """Whether it has few folds and no short crease."""
        return self.shortest >= LEAST_CREASE_MM and self.folds <= HANDS_FOLDS

    @property
    def key(self) -> tuple[bool, bool, float, float]:
        """Less is better: first patterns for two hands, then no tiny creases, then fewer folds, then longer creases."""
        lack = max(0.0, 1 - self.shortest / LEAST_CREASE_MM)
        return not self.is_for_hands, lack > 0.9, self.folds * (1.0 + 0.3 * (lack > 0)) + 20 * lack, -self.shortest


def redraw(
    drawing: Drawing,
    tolerance: float,
    *,
    method: str = ANY_METHOD,
    work: int = WORK["normal"],
    found: Callable[[Redrawn], None] | None = None,
    is_late: Callable[[], bool] = lambda: False,
    progress: Callable[[str, float], None] | None = None,
    wanted: float = math.inf,
    thorough: bool = True,
) -> Redrawn | None:
    """Return the best pattern found for a drawing redrawn within ``tolerance`` mm of the frame, or None.

    ``method`` folds: "mirror", "skeleton", or any. ``work`` is how much is done for each plan, in assessments of
    outlines. ``found`` is called with each pattern that is better than those before. The search ends early when
    ``is_late``. ``progress`` is called with a text and the part done. ``wanted``: how many folds a pattern may have; a
    search that seems to end with far more is given up. ``thorough``: where a pattern for two hands is nearly found,
    more is searched.
    """
    best: Redrawn | None = None

    def keep(one: Redrawn) -> None:
        nonlocal best
        if best is None or one.key < best.key:
            best = one
            if found is not None:
                found(one)

    if method in (ANY_METHOD, "mirror") and (wedge := around(drawing)) is not None:
        _fold_as_wedge(wedge, tolerance, lambda: best, keep, is_late)
        if best is not None and best.is_for_hands:
            return best
    for number, plan in enumerate(plans(drawing)):
        if method != ANY_METHOD and method != ("mirror" if plan.axes else "skeleton"):
            continue
        if is_late() or (best is not None and not plan.axes and best.folds <= MOST_FOLDS):
            break  # folded in half first, it is easier than as a whole
        if best is not None and (not thorough or (best.is_for_hands and len(plan.axes) < len(best.plan.axes))):
            break  # what has most axes, and comes first, has the fewest folds
        if number and not (plan.axes or thorough):
            break  # with twice the corners, it would take longest where least is to be hoped for

        def ends(
            part: float, before: float = number / (number + 1), share: float = 1 / ((number + 1) * (number + 2))
        ) -> bool:
            if progress is not None:
                progress(f"outlines within {tolerance:g} mm", before + share * part)
            return is_late()

        share_of_work = 1.0 if best is None else LESS_WORK
        _Redrawing(plan, tolerance, keep, wanted, thorough=thorough).run(int(share_of_work * work), ends)
    return best


def _fold_as_wedge(
    wedge: Around,
    tolerance: float,
    best: Callable[[], Redrawn | None],
    keep: Callable[[Redrawn], None],
    is_late: Callable[[], bool],
) -> None:
    """Fold some outlines of a drawing with several axes; once one is for two hands, only those with no more corners."""
    for shape, off in islice(wedge.outlines(tolerance), MOST_OF_WEDGE):
        if is_late():
            return
        so_far, most = best(), float(MOST_FOLDS)
        if so_far is not None and so_far.is_for_hands:
            if shape.corner_count > so_far.shape.corner_count:
                continue
            most = so_far.folds
        for made in wedge.fold(shape, most):
            shortest = shortest_crease(made.creases) / wedge.plan.frame.scale
            keep(Redrawn(wedge.plan, shape, made, made.actions, shortest, off))


class _Redrawing:
    """A search by one plan."""

    def __init__(
        self,
        plan: Plan,
        tolerance: float,
        keep: Callable[[Redrawn], None],
        wanted: float = math.inf,
        *,
        thorough: bool = True,
    ) -> None:
        self.plan = plan
        self.wanted = wanted
        self.thorough = thorough
        self.tolerance = tolerance
        self.keep = keep
        self.folded = self.tried = self.tried_at_last = 0
        self.short_cost = SHORT_COST
        self.is_given_up = False
        self.best: Redrawn | None = None
        self.refused: Counter[object] = Counter()
        self.field = plan.field(tolerance)

    def run(self, work: int, ends: Callable[[float], bool]) -> None:
        """Search; ``ends`` is called now and then with the part done, and says whether to stop."""
        starts: list[Corners] = []
        self.search(_kept(self.plan.starts(self.tolerance), starts), work, ends)
        if not starts:
            return
        again = int((1.0 if self.thorough else LESS_WORK) * work)
        many = self.best is None or self.best.folds > MOST_FOLDS
        if many and self.thorough and not self.is_given_up:  # looser outlines may have an order where none else has
            self.search(starts, again, lambda _: ends(1.0), tightens=False)
        if self.best is not None and self.best.shortest < LEAST_CREASE_MM and self.best.folds < HANDS_FOLDS:
            self.search(starts, again, lambda _: ends(1.0), short_cost=DEAR)
        for part in MORE_STARTS if self.thorough else ():
            if ends(1.0) or self.best is None or self.best.is_for_hands or self.best.folds > NEAR_MISS * HANDS_FOLDS:
                break
            self.search(self.plan.starts(part * self.tolerance), work, lambda _: ends(1.0))

    def search(
        self,
        starts: Iterable[Corners],
        work: int,
        ends: Callable[[float], bool],
        *,
        tightens: bool = True,
        short_cost: tuple[float, float] = SHORT_COST,
    ) -> None:
        """Search from some outlines to begin with."""
        self.folded = self.tried = 0
        self.short_cost = short_cost
        engine = Engine(self.field, short_cost=short_cost)
        search = Search(engine, work, believe=self.believe, ends=ends, tightens=tightens, wanted=self.wanted)
        search.run(starts)
        self.is_given_up = search.is_given_up

    def believe(self, one: Assessment) -> float:
        """Fold an outline, and return what has to be added to its cost."""
        skeleton = one.lines, one.loop_sizes, frozenset(one.details.sides.values())
        most, most_tried = MOST_FOLDED
        if self.folded >= most or self.tried >= most_tried or self.refused[skeleton] >= MOST_REFUSED:
            return REFUSED
        try:
            shape, half = self.plan.outline(one.points, one.loop_sizes)
            off, _ = self.plan.target.off_by(shape.loops)
            if off > self.tolerance * (1 + 1e-6):
                return REFUSED
            self.tried += 1
            sheet = self.plan.frame.sheet if half is None else half.sheet
            outline = shape if half is None else half.outline
            tries = max(TRIES[0], TRIES[1] // outline.corner_count)
            most_folds = MOST_FOLDS
            if self.best is None and math.isinf(self.wanted) and self.tried_at_last < MOST_TRIED_AT_LAST:
                self.tried_at_last += one.lines > MOST_FOLDS
                most_folds = MOST_FOLDS_AT_LAST
            made = fold_outline(
                outline, sheet, tries=tries, part=half, most_folds=most_folds, cheaper_tries=CHEAPER_TRIES
            )
            redrawn = self._on_sheet(shape, made, off)
            self.folded += 1
        except FoldcutError:
            self.refused[skeleton] += 1
            return REFUSED
        self.keep(redrawn)
        if self.best is None or redrawn.key < self.best.key:
            self.best = redrawn
        true = redrawn.folds - len(self.plan.axes) + _cost_of_shortest(redrawn.shortest, self.short_cost)
        return true - one.lines - _cost_of_shortest(one.shortest, self.short_cost)

    def _on_sheet(self, shape: Shape, found: Skeletal, off: float) -> Redrawn:
        plan, frame = self.plan, self.plan.frame
        creases, folded = frame.pattern(found.creases, found.folded, shape)
        laid = on_the_sheet(plan, shape)
        if plan.axes:
            swapped = abs(frame.turn[0, 0]) < 0.5
            axes = tuple(sorted(1 - axis for axis in plan.axes)) if swapped else plan.axes
            made = made_of_half(axes, replace(found, creases=creases, folded=folded), laid)
        else:
            whole = replace(found, creases=creases, folded=folded)
            made = made_of_whole(whole, laid, moved_mm=off * frame.scale)
        return Redrawn(plan, shape, made, made.actions, shortest_crease(creases) / frame.scale, off)


def _kept(starts: Iterator[Corners], kept: list[Corners]) -> Iterator[Corners]:
    """Yield outlines, and keep them."""
    for one in starts:
        kept.append(one)
        yield one


def _cost_of_shortest(length: float, short_cost: tuple[float, float]) -> float:
    """Return what the shortest crease costs, in lines."""
    if length >= LEAST_CREASE_MM:
        return 0.0
    return short_cost[0] + short_cost[1] * (1 - length / LEAST_CREASE_MM)
