"""The method ``compact``: one loop with few creases, by a search over walks along the boundary."""

from __future__ import annotations

from foldcut.core.errors import CreaseTooShortError
from foldcut.methods import METHODS
from foldcut.methods.base import Effort, Made, Problem, require_one_loop, straight_folds
from foldcut.methods.compact.pattern import regions
from foldcut.methods.compact.search import fold_compact
from foldcut.methods.frame import Frame, in_frame

__all__ = ["fold", "search_told"]


def fold(problem: Problem, effort: Effort) -> Made:
    """Fold a shape of one loop; the pattern is verified.

    Raises ``UnfoldableError`` for a shape of several loops, or where no pattern is found.
    """
    require_one_loop(problem.shape)
    wishes = problem.wishes
    least = METHODS["compact"].min_crease_mm if wishes.min_crease is None else wishes.min_crease

    def in_this(frame: Frame) -> Made:
        found = fold_compact(
            frame.shape.loops[0],
            frame.sheet,
            ribbon=wishes.free_ribbon / frame.scale,
            effort=effort.name,
            seconds=effort.seconds,
            progress=problem.stages.tell,
            share=effort.share,
            goal=effort.goal,
            least=least / frame.scale,
        )
        creases, folded = frame.pattern(found.creases, found.folded, frame.shape)
        return Made(
            "compact",
            creases,
            folded,
            problem.laid,
            wishes.free_ribbon,
            straight_folds(creases),
            told=search_told("compact", found.tried, interrupted=found.interrupted),
            numbers={"tried": found.tried, "interrupted": found.interrupted},
            regions=frame.regions(regions(found.walk, found.molecules, frame.sheet)),
            interrupted=found.interrupted,
            detail=found,
        )

    with problem.stages("searching"):
        try:
            return in_frame(problem.laid, in_this, retry=False)
        except CreaseTooShortError as error:
            x, y = error.place
            raise CreaseTooShortError(
                f"{error}: the first one found, at ({x:.4g}, {y:.4g}), is {error.length:.2g} mm long, shorter than "
                f"{least:g} mm; leave out small corners with --simplify, use a larger sheet with the drawing larger to "
                "match, or allow all with --min-crease 0",
                error.length,
                error.place,
            ) from None


def search_told(method: str, tried: int, *, interrupted: bool) -> tuple[str, ...]:
    """Return how a search has found its pattern, in words."""
    best = f"{method}, best of {tried} tried"
    return (f"interrupted: {best}" if interrupted else best,)
