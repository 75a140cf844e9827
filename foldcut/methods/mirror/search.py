"""Which half is folded: the search for the pattern that is easiest to fold."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import CreasePattern, FoldedState, Region
from foldcut.methods.compact.pattern import regions
from foldcut.methods.compact.search import EFFORTS, Compact, fold_compact
from foldcut.methods.mirror.unfold import Half
from foldcut.pattern.ranking import Rank, rank, shortest_crease

SCAN, MOST_SCAN, FINAL, FINALISTS = 0.4, 0.08, 0.3, 2
"""Parts of the effort: for a first look at loops, for each of them at most, and for so many of the best."""


LOOK_S, FEWEST_LOOKS, MOST_LOOKS = 0.25, 3, 16
"""What a first look takes at least, in seconds of effort; and how many loops are looked at."""


@dataclass(frozen=True, eq=False)
class Mirrored:
    """The pattern of a sheet that is folded along its axes first: what the search found for the half, and the half."""

    found: Compact
    half: Half

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
    candidates: Sequence[Half],
    *,
    ribbon: float = 0.0,
    effort: str = "normal",
    seconds: float | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> Mirrored:
    """Return the verified pattern that is easiest to fold: see ``fold_compact`` for the options and Ctrl-C.

    The most promising of ``candidates`` get a first look, the best of these more. Raises ``UnfoldableError`` when none
    folds.
    """
    best: tuple[Rank, Mirrored] | None = None
    part = 0.0

    def tell(text: str, done: float) -> None:
        if progress is not None:
            progress(f"half of the sheet: {text}", part + share * done)

    def look(half: Half) -> Rank | None:
        nonlocal best, part
        try:
            found = fold_compact(
                half.loop,
                half.sheet,
                ribbon=ribbon,
                effort=effort,
                seconds=seconds,
                progress=tell,
                share=share,
                whole=half,
            )
        except UnfoldableError:
            return None
        finally:
            part += share
        key = rank(len(half.axes) + found.part.crease_count, shortest_crease(found.creases))
        if best is None or key < best[0]:
            best = key, Mirrored(found, half)
        if found.interrupted:
            raise KeyboardInterrupt
        return key

    try:
        looks = min(max(round(SCAN * (seconds or EFFORTS[effort]) / LOOK_S), FEWEST_LOOKS), MOST_LOOKS)
        candidates = _by_promise(candidates)[:looks]
        share = min(MOST_SCAN, SCAN / max(1, len(candidates)))
        ranked = [(key, number) for number, half in enumerate(candidates) if (key := look(half)) is not None]
        finalists = sorted(ranked)[:FINALISTS]
        share = FINAL / max(1, len(finalists))
        for _, number in finalists:
            look(candidates[number])
    except KeyboardInterrupt:
        if best is None:
            raise
        return Mirrored(replace(best[1].found, interrupted=True), best[1].half)
    if best is None:
        raise UnfoldableError("no pattern was found for the half sheet; try a higher effort")
    return best[1]


def _by_promise(candidates: Sequence[Half]) -> list[Half]:
    """Return those first that promise most: few corners and two axes; ways to lay the shape take turns."""
    seen: Counter[tuple[int, tuple[int, ...]]] = Counter()
    keys = []
    for number, half in enumerate(candidates):
        way = id(half.shape), half.axes
        keys.append((len(half.loop) - 2 * len(half.axes), seen[way], number))
        seen[way] += 1
    return [candidates[number] for *_, number in sorted(keys)]
