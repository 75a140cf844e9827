"""Fold a half of the sheet by the loop that is easiest to fold.

``Half`` candidates -> ``Mirrored``, a verified pattern of the whole sheet. All promising candidates get a first look
with little effort, and the best of them more.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import CreasePattern, FoldedState, Region
from foldcut.methods.base import straight_folds
from foldcut.methods.compact.budget import EFFORT_SECONDS
from foldcut.methods.compact.pattern import regions
from foldcut.methods.compact.search import Compact, fold_compact
from foldcut.methods.mirror.wedge import Part
from foldcut.pattern.ranking import FOLDABLE_MM, Goal, Rank, rank, shortest_crease

SCAN = 0.4
"""The part of the effort for the first looks."""

MOST_SCAN = 0.08
"""The part of the effort for one first look, at most."""

FINAL = 0.3
"""The part of the effort for the second looks."""

FINALISTS = 2
"""How many candidates get a second look."""

LOOK_S = 0.25
"""How long a first look takes at least, in seconds of effort."""

FEWEST_LOOKS = 3
"""How many candidates get a first look however little effort there is."""

EASY, HARD = 1.5, 2.0
"""A first look goes on after a third of its time if its pattern takes no more than this many times what is to be
beaten, where that is easy or hard to fold by hand."""

MOST_IN_VAIN = 2
"""After so many first looks in a row that bring nothing better there are no more."""

HOPEFUL = 4.0
"""A candidate gets a second look if its pattern takes no more than this many times what is to be beaten."""

MOST_LOOKS = 16
"""How many candidates get a first look at most."""


@dataclass(frozen=True, eq=False)
class Mirrored:
    """The pattern of a sheet that is folded along its axes first: what was found for a half, and which half."""

    found: Compact
    half: Part

    @property
    def creases(self) -> CreasePattern:
        """The creases of the whole sheet."""
        return self.found.creases

    @property
    def folded(self) -> FoldedState:
        """How the whole sheet folds."""
        return self.found.folded

    @property
    def regions(self) -> tuple[Region, ...]:
        """The regions of the whole sheet."""
        return self.half.unfold_regions(regions(self.found.walk, self.found.molecules, self.half.sheet))


def fold_mirrored(
    candidates: Sequence[Part],
    *,
    ribbon: float = 0.0,
    effort: str = "normal",
    seconds: float | None = None,
    whole: float = 1.0,
    progress: Callable[[str, float], None] | None = None,
    goal: Goal | None = None,
) -> Mirrored:
    """Return the verified pattern that is easiest to fold; see ``fold_compact`` for the options and for Ctrl-C.

    ``whole`` is the part of the effort or the seconds that may be spent on all candidates together.
    Raises ``UnfoldableError`` where no pattern is found for any of them.
    """
    best: tuple[Rank, Mirrored] | None = None
    part = 0.0
    enough = Goal(enough=goal.enough if goal is not None else 0)
    # a pattern for hands is hard to beat: no first look goes on for long that does not
    to_beat = goal.beat if goal is not None else None
    is_easy = to_beat is not None and -to_beat.minus_shortest >= FOLDABLE_MM
    first = replace(enough, beat=to_beat, hopeful=EASY if is_easy else HARD, patient=True) if to_beat else enough

    def tell(text: str, done: float) -> None:
        if progress is not None:
            progress(f"half of the sheet: {text}", (part + share * done) / whole)

    def look(half: Part, goal: Goal) -> Rank | None:
        nonlocal best, part
        try:
            found = fold_compact(
                half.loops[0],
                half.sheet,
                ribbon=ribbon,
                effort=effort,
                seconds=seconds,
                progress=tell,
                share=share,
                part=half,
                goal=goal,
                first_folds=half.fold_count,
            )
        except UnfoldableError:
            return None
        finally:
            part += share
        key = rank(half.fold_count + found.part.crease_count, shortest_crease(found.creases))
        if best is None or key < best[0]:
            best = key, Mirrored(found, half)
        if found.interrupted:
            raise KeyboardInterrupt
        return key

    def is_enough() -> bool:
        """Return whether the best pattern cannot be beaten."""
        if best is None:
            return False
        made = best[1]
        return enough.is_reached(made.half.fold_count + straight_folds(made.found.part), shortest_crease(made.creases))

    try:
        looks = min(max(round(SCAN * whole * (seconds or EFFORT_SECONDS[effort]) / LOOK_S), FEWEST_LOOKS), MOST_LOOKS)
        candidates = _by_promise(candidates)[:looks]
        share = whole * min(MOST_SCAN, SCAN / max(1, len(candidates)))
        ranked: list[tuple[Rank, int]] = []
        in_vain = 0
        for number, half in enumerate(candidates):
            before = best
            key = look(half, first)
            if key is not None:
                ranked.append((key, number))
            in_vain = in_vain + 1 if best is before else 0
            if is_enough() or (number + 1 >= FEWEST_LOOKS and in_vain >= MOST_IN_VAIN):
                break
        finalists = sorted(ranked)[:FINALISTS]
        share = whole * FINAL / max(1, len(finalists))
        for key, number in finalists:
            if not is_enough() and (to_beat is None or key.creases < (EASY if is_easy else HOPEFUL) * to_beat.creases):
                beat = best[0] if best is not None else None
                look(candidates[number], replace(enough, beat=beat, hopeful=1.0, patient=True))
    except KeyboardInterrupt:
        if best is None:
            raise
        return Mirrored(replace(best[1].found, interrupted=True), best[1].half)
    if best is None:
        raise UnfoldableError("no pattern was found for the half sheet; try a higher effort")
    return best[1]


def _by_promise(candidates: Sequence[Part]) -> list[Part]:
    """Return candidates with few corners and many first folds first; those for different ways to lay it take turns."""
    seen: Counter[int] = Counter()
    keys = []
    for number, half in enumerate(candidates):
        way = id(half.shape)  # each way to lay the shape has its own
        keys.append((len(half.loops[0]) - 2 * half.fold_count, seen[way], number))
        seen[way] += 1
    return [candidates[number] for *_, number in sorted(keys)]
