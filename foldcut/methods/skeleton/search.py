"""Several loops, or one, with few creases: along the straight skeleton, the layers ordered by a solver.

``Shape`` on its sheet -> ``Skeletal``: a verified pattern (Demaine, Demaine and Lubiw 1999; docs/several-loops.md).

Which perpendiculars are folded is chosen in several ways, see ``perpendiculars``; for each of these choices
``ordersolver`` looks for a layer order, and ``verify`` has the last word. The pattern that is easiest to fold is taken.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
import shapely

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import CreasePattern, FoldedState, Shape, Sheet
from foldcut.methods import ADJUST_MM
from foldcut.methods.skeleton.layer_order import NO_ORDER, OrderSolver, layer_order
from foldcut.methods.skeleton.perpendiculars import Facets, Perpendiculars, divide_sheet
from foldcut.methods.skeleton.snap import tie_nodes, tie_perpendiculars
from foldcut.methods.skeleton.straight_skeleton import straight_skeleton
from foldcut.pattern.assemble import assemble, creases_of_stack
from foldcut.pattern.foldability import crease_numbers
from foldcut.pattern.ranking import FOLDABLE_MM, Rank, rank, shortest_crease
from foldcut.proof.verify import verify

__all__ = ["Skeletal", "fold_ridges", "fold_skeletal"]

SECONDS = {"fast": 1.0, "normal": 8.0, "best": 60.0}
"""How long choices are tried, by effort and the model of ``_cost``: what comes out does not depend on the machine."""

FEWEST = 4
"""So many of the sets of perpendiculars with the fewest pieces are tried."""

PATIENCE, LEAST_PATIENCE = 3.0, 3.0
"""How many times as long choices are tried for the drawing as it is while none has an order; for how many seconds at
least with its corners moved."""

FIRST = 3 / 4
"""The part of that time for the fewest perpendiculars and those away from a root; the rest is for what is near."""

TYPICAL_FACETS, USUAL_ROUNDS = 400, 10
"""Patterns with too many creases cost as much as those of so many facets; orders take so many rounds of the solver."""

LESS = 0.2
"""Corners are also moved by only so much of what is allowed: less is sometimes better."""

MOST_CREASES, MOST_CORNERS = 1000, 120
"""Patterns with more creases are not looked at, nor drawings with more corners."""


@dataclass(frozen=True, eq=False)
class Skeletal:
    """What the method made.

    ``shape`` is the drawing that was folded, ``moved_mm`` how far its corners were moved for that at most;
    ``perpendiculars`` how many there are; ``interrupted`` by Ctrl-C, so that not all choices were tried.
    """

    shape: Shape
    moved_mm: float
    perpendiculars: int
    creases: CreasePattern
    folded: FoldedState
    interrupted: bool = False


def fold_skeletal(
    shape: Shape,
    sheet: Sheet,
    *,
    ribbon: float = 0.0,
    near: float = ADJUST_MM,
    effort: str = "normal",
    seconds: float | None = None,
    share: float = 1.0,
    progress: Callable[[str, float], None] | None = None,
) -> Skeletal:
    """Fold a shape along its straight skeleton.

    ``shape`` is in the sheet's mm; corners may be moved by ``near`` mm where that joins nodes of the skeleton or
    takes perpendiculars to them. ``ribbon`` is a half-width in mm: so near to the cut, creases run straight across it
    or along a corner's bisector.
    Raises ``UnfoldableError`` with the reason where perpendiculars do not end, creases are too many, or no choice has
    a layer order.
    """
    if shape.corner_count > MOST_CORNERS:
        raise UnfoldableError(f"the drawing has {shape.corner_count} corners; at most {MOST_CORNERS} are looked at")
    search = _Search(sheet, ribbon, share * (seconds if seconds is not None else SECONDS[effort]), progress)
    patience = PATIENCE * search.limit
    adjusted = _adjusted(shape, sheet, near)
    interrupted = False
    try:
        for number, (tied, moved) in enumerate(adjusted, start=1):
            try:
                search.fold(tied, moved, patience if number == len(adjusted) else max(search.limit, LEAST_PATIENCE))
            except UnfoldableError as error:
                search.problem = search.problem or str(error)
            if search.best and search.best.made and shortest_crease(search.best.made.creases) >= FOLDABLE_MM:
                break
        search.improve()
    except KeyboardInterrupt:
        if search.best is None:
            raise
        interrupted = True
    if search.best is None or search.best.made is None:
        raise UnfoldableError(search.problem or "no set of perpendiculars makes the creases at every node even")
    return replace(search.best.made, interrupted=interrupted)


def fold_ridges(shape: Shape, sheet: Sheet, *, ribbon: float = 0.0, near: float = ADJUST_MM) -> Skeletal:
    """Fold a shape along the ridges of its straight skeleton alone; the options are those of ``fold_skeletal``.

    Raises ``UnfoldableError`` with the reason where this needs perpendiculars, too, or has no layer order.
    """
    tied, moved = tie_nodes(shape, sheet, near) if near else (shape, 0.0)
    perpendiculars = _perpendiculars(tied, sheet, ribbon)
    if perpendiculars.odd:
        raise UnfoldableError("at some nodes of the straight skeleton perpendiculars begin")
    facets = _divided(perpendiculars, [])
    return _ordered(tied, moved, facets, _conditions(facets), 0)


def _perpendiculars(shape: Shape, sheet: Sheet, ribbon: float) -> Perpendiculars:
    """Return the straight skeleton with where perpendiculars may begin, if no creases meet within the ribbon."""
    skeleton = straight_skeleton(shape, sheet)
    perpendiculars = Perpendiculars(skeleton, sheet)
    lowest = min((float(skeleton.height[node]) for node in perpendiculars.nodes), default=np.inf)
    if lowest <= ribbon:
        raise UnfoldableError(
            f"creases of the straight skeleton meet {lowest:.2g} mm from the cut, within the ribbon of {ribbon:g} mm"
        )
    return perpendiculars


def _adjusted(shape: Shape, sheet: Sheet, near: float) -> list[tuple[Shape, float]]:
    """Return the shape as it is, and moved so that creases meet in several ways, those that do most for it first."""
    if not near:
        return [(shape, 0.0)]
    moved = [tie_perpendiculars(shape, sheet, way) for way in (near, LESS * near)]
    moved += [tie_nodes(shape, sheet, near), (shape, 0.0)]
    different: list[tuple[Shape, float]] = []
    for one, way in moved:
        if all(any((a != b).any() for a, b in zip(one.loops, other.loops, strict=True)) for other, _ in different):
            different.append((one, way))
    return different


@dataclass(frozen=True, eq=False)
class _Drawing:
    """A shape with its perpendiculars, of which sets are chosen; how far its corners were ``moved``."""

    shape: Shape
    moved: float
    perpendiculars: Perpendiculars

    def pieces(self, taken: Iterable[int]) -> int:
        return sum(len(self.perpendiculars.paths[k].steps) for k in taken)


@dataclass(frozen=True, eq=False)
class _Trial:
    """A set of perpendiculars that was tried, what it made, if anything, and how many contradictions it has.

    ``cause``: perpendiculars one of which has to be folded, or not any more, for one of the contradictions to go.
    """

    drawing: _Drawing
    taken: frozenset[int]
    made: Skeletal | None
    contradictory: tuple[float, float]
    cause: frozenset[int]

    @property
    def quality(self) -> tuple[float, ...]:
        """Less is better."""
        return (0.0, *_rank(self.made)) if self.made else (1.0, *self.contradictory)


@dataclass
class _Search:
    """The best pattern so far, and the time spent by the model of ``_cost``."""

    sheet: Sheet
    ribbon: float
    limit: float
    progress: Callable[[str, float], None] | None
    best: _Trial | None = None
    problem: str = ""
    spent: float = 0.0

    def fold(self, shape: Shape, moved: float, patience: float) -> None:
        """Try choices of perpendiculars for a shape as it is; ``moved`` is only noted.

        ``patience`` is for how many seconds while there is no pattern. Raises ``UnfoldableError`` where there are no
        choices.
        """
        if self.best is None:
            self.spent = 0.0
        nearest: _Trial | None = None
        for perpendiculars, taken in _choices(lambda: _perpendiculars(shape, self.sheet, self.ribbon)):
            if self.spent > (self.limit / 2 if self.best else FIRST * patience):
                break
            trial = self.attempt(_Drawing(shape, moved, perpendiculars), frozenset(taken))
            if nearest is None or trial.quality < nearest.quality:
                nearest = trial
        if self.best is None and nearest is not None:
            self.walk(nearest, patience)

    def improve(self) -> None:
        """Look for a better pattern near to the best one."""
        if self.best is not None:
            self.walk(self.best, self.spent + self.limit / 2)

    def walk(self, here: _Trial, end: float) -> None:
        """Go from one set of perpendiculars to another that differs in two or three of them and is no worse.

        As long as none has an order, a set with no more contradictions is no worse, and the next one changes something
        in the cause of a contradiction; the walk ends when a set has an order. From one that has, it is only to those
        that are easier to fold. ``end`` is in seconds spent.
        """
        drawing, pieces, folds = here.drawing, here.drawing.pieces, here.made is not None
        exchanges = drawing.perpendiculars.exchanges()
        random, seen = np.random.default_rng(0), {here.taken}
        while self.spent + (_cost(len(here.made.creases.faces_vertices)) if here.made else 0.0) <= end:
            ways = [one for one in exchanges if one & here.cause and here.taken ^ one not in seen]
            if folds:
                ways = [one for one in ways if pieces(here.taken ^ one) <= pieces(here.taken)]
            if not ways:
                break
            taken = here.taken ^ ways[int(random.integers(len(ways)))]
            seen.add(taken)
            trial = self.attempt(drawing, taken)
            if trial.quality <= here.quality:
                here = trial
            if trial.made and not folds:
                break

    def attempt(self, drawing: _Drawing, taken: frozenset[int]) -> _Trial:
        """Try a set of perpendiculars."""
        if self.progress is not None:
            self.progress("layer orders", min(1.0, self.spent / self.limit))
        made: Skeletal | None = None
        contradictory: tuple[float, float] = (np.inf, np.inf)
        cause = frozenset(range(len(drawing.perpendiculars.paths)))
        try:
            self.spent += _test_cost(TYPICAL_FACETS)  # should it be too large
            facets = _divided(drawing.perpendiculars, sorted(taken))
            self.spent += _test_cost(len(facets.rings)) - _test_cost(TYPICAL_FACETS)
            conditions = _conditions(facets)
            contradictory = conditions.contradictory
            if contradictory[0]:
                cause = _perpendiculars_in(drawing.perpendiculars, facets, conditions.facets_of_contradiction())
            if any(contradictory):
                raise UnfoldableError(NO_ORDER)
            try:
                made = _ordered(drawing.shape, drawing.moved, facets, conditions, len(taken))
            finally:
                self.spent += _cost(len(facets.rings), conditions.rounds)
        except UnfoldableError as error:
            self.problem = self.problem or str(error)
        trial = _Trial(drawing, taken, made, contradictory, cause)
        if made and (self.best is None or trial.quality < self.best.quality):
            self.best = trial
        return trial


def _rank(made: Skeletal) -> Rank:
    return rank(crease_numbers(made.creases).lines, shortest_crease(made.creases))


def _cost(facets: int, rounds: int = USUAL_ROUNDS) -> float:
    """About how many seconds it takes to order so many facets in so many rounds, and to verify what that makes."""
    return (facets / 120) * (0.05 + 0.02 * rounds)


def _test_cost(facets: int) -> float:
    """About how many seconds it takes to divide the sheet into so many facets and to look for contradictions."""
    return float((facets / 120) ** 1.5) / 30


def _choices(perpendiculars_of: Callable[[], Perpendiculars]) -> Iterator[tuple[Perpendiculars, list[int]]]:
    """Yield perpendiculars and choices of them: the fewest, then those that fold away from a root.

    Raises ``UnfoldableError`` where there are none, or none with few enough creases.
    """
    perpendiculars = perpendiculars_of()
    perpendiculars.trace(perpendiculars.odd)
    perpendiculars.require_ends()
    fewest = list(perpendiculars.fewest(FEWEST))
    if fewest:
        _divided(perpendiculars, fewest[0])  # the others have more creases, if this one has too many
    rooted = perpendiculars.rooted()
    seen: set[tuple[int, ...]] = set()
    for taken in [*fewest[:1], *rooted[:1], *fewest[1:], *rooted[1:]]:
        if tuple(taken) not in seen:
            seen.add(tuple(taken))
            yield perpendiculars, taken
    if len(perpendiculars.nodes) > len(perpendiculars.odd):
        perpendiculars = perpendiculars_of()
        perpendiculars.trace(perpendiculars.nodes)
        for taken in perpendiculars.rooted():
            yield perpendiculars, taken


def _divided(perpendiculars: Perpendiculars, taken: list[int]) -> Facets:
    facets = divide_sheet(perpendiculars, taken)
    if len(facets.creases) > MOST_CREASES:
        raise UnfoldableError(
            f"the pattern has {len(facets.creases):,} creases; at most {MOST_CREASES:,} are looked at"
        )
    return facets


def _perpendiculars_in(perpendiculars: Perpendiculars, facets: Facets, within: Iterable[int]) -> frozenset[int]:
    """Perpendiculars that border on some of the facets, or would divide them."""
    rings = [facets.flat[facets.rings[k]] for k in within]
    tree = shapely.STRtree(shapely.polygons([shapely.linearrings(ring) for ring in rings]))
    steps = [(k, (step.start + step.end) / 2) for k, path in enumerate(perpendiculars.paths) for step in path.steps]
    middles = shapely.points(np.array([middle for _, middle in steps]))
    found = tree.query(middles, predicate="dwithin", distance=perpendiculars.snap)[0]
    return frozenset(steps[k][0] for k in found.tolist())


def _conditions(facets: Facets) -> OrderSolver:
    return OrderSolver(facets.folded, facets.rings, facets.creases, facets.up)


def _ordered(shape: Shape, moved: float, facets: Facets, conditions: OrderSolver, perpendiculars: int) -> Skeletal:
    """Find a layer order, and verify what it makes."""
    order = layer_order(conditions)
    rings = [facets.rings[k] for k in order]
    edges, kinds = creases_of_stack(facets.folded, rings)
    creases, folded = assemble(facets.flat, facets.folded, rings, edges, kinds, facets.sheet_corners)
    findings = verify(creases, folded.layers, shape)
    if findings:
        raise UnfoldableError(f"the pattern fails verification ({findings[0]})")
    return Skeletal(shape, moved, perpendiculars, creases, folded)
