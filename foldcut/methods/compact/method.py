"""The method ``compact``: one loop with few creases, by a search over walks along the boundary."""

from __future__ import annotations

from foldcut.methods import METHODS
from foldcut.methods.base import Effort, Made, Problem, require_one_loop, straight_folds
from foldcut.methods.compact.pattern import regions
from foldcut.methods.compact.search import fold_compact

__all__ = ["fold", "search_told"]


def fold(problem: Problem, effort: Effort) -> Made:
    """Fold a shape of one loop; the pattern is verified.

    Raises ``UnfoldableError`` for a shape of several loops, or where no pattern is found.
    """
    require_one_loop(problem.shape)
    least = problem.wishes.min_crease
    with problem.stages("searching"):
        found = fold_compact(
            problem.shape.loops[0],
            problem.sheet,
            ribbon=problem.wishes.free_ribbon,
            effort=effort.name,
            seconds=effort.seconds,
            progress=problem.stages.tell,
            share=effort.share,
            least=METHODS["compact"].min_crease_mm if least is None else least,
        )
    return Made(
        "compact",
        found.creases,
        found.folded,
        problem.laid,
        problem.wishes.free_ribbon,
        straight_folds(found.creases),
        told=search_told("compact", found.tried, interrupted=found.interrupted),
        numbers={"tried": found.tried, "interrupted": found.interrupted},
        regions=regions(found.walk, found.molecules, problem.sheet),
        detail=found,
    )


def search_told(method: str, tried: int, *, interrupted: bool) -> tuple[str, ...]:
    """Return how a search has found its pattern, in words."""
    best = f"{method}, best of {tried} tried"
    return (f"interrupted: {best}" if interrupted else best,)
