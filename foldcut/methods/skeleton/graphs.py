"""Fold any planar graph: open lines, lines that cross, outlines that touch (docs/graphs.md).

``Shape`` of a graph on its sheet -> ``Skeletal``: a verified pattern. Which faces of the graph go to which side of the
cut line is free (``drawing.graph``), so one choice after another is folded as loops are, and of the first ones that can
be folded the one that is easiest to cut and to fold is taken. No corner is moved.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.drawing.graph import CutGraph
from foldcut.methods.skeleton.budget import Budget
from foldcut.methods.skeleton.quick import fold_outline
from foldcut.methods.skeleton.search import MOST_CORNERS, Search
from foldcut.methods.skeleton.trial import Skeletal
from foldcut.pattern.cut_line import sides_of_lines
from foldcut.pattern.foldability import crease_numbers
from foldcut.pattern.ranking import Rank, rank, shortest_crease

__all__ = ["fold_graph"]


@dataclass(frozen=True)
class _Work:
    """How much is tried.

    ``choices`` of sides, and how many of those that can be folded are ``compared``; if none can, it is searched from
    ``searched`` of the choices, for ``seconds`` of the budget's model each.
    """

    choices: int
    compared: int
    searched: int
    seconds: float


WORK = {"fast": _Work(4, 1, 0, 0.0), "normal": _Work(12, 2, 2, 4.0), "best": _Work(40, 6, 4, 20.0)}
"""By effort."""


def fold_graph(
    shape: Shape,
    sheet: Sheet,
    *,
    ribbon: float = 0.0,
    effort: str = "normal",
    seconds: float | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> Skeletal:
    """Fold a graph along its straight skeleton, and along edges whose two sides go to the same side of the cut line.

    ``shape`` is in the sheet's mm; ``ribbon`` as for ``fold_skeletal``. ``effort`` is one of ``WORK``; after so many
    ``seconds``, if given, no more choices are tried. ``progress`` is called with a text and the part done. Ctrl-C ends
    the search with the best pattern so far. Raises ``UnfoldableError`` with the first reason where none of the choices
    of sides can be folded.
    """
    graph, work = CutGraph.of(shape), WORK[effort]
    if len(graph.graph.edges) > MOST_CORNERS:
        raise UnfoldableError(
            f"the drawing has {len(graph.graph.edges)} straight lines; this method takes at most {MOST_CORNERS}: "
            "draw fewer, or allow --simplify 1mm"
        )
    found: list[Skeletal] = []
    problem: UnfoldableError | None = None
    tried: list[Shape] = []
    interrupted, end = False, math.inf if seconds is None else time.monotonic() + seconds
    for number, choice in enumerate(graph.shapes()):
        if number >= work.choices or len(found) >= work.compared or (number and time.monotonic() > end):
            break
        if progress is not None:
            progress("sides of the cut", number / work.choices)
        tried.append(choice)
        try:
            found.append(fold_outline(choice, sheet, ribbon=ribbon))
        except UnfoldableError as error:
            problem = problem or error
        except KeyboardInterrupt:
            if not found:
                raise
            interrupted = True
            break
    for choice in tried[: work.searched] if not found and time.monotonic() < end else ():
        search = Search(sheet, ribbon, Budget(work.seconds), progress)
        search.fold(choice, 0.0, work.seconds)
        if search.made is not None:
            return search.made
        problem = problem or search.problem
    if not found:
        raise problem or UnfoldableError("no choice of sides can be folded")
    return replace(min(found, key=_rank), interrupted=interrupted)


def _rank(made: Skeletal) -> tuple[bool, Rank]:
    """Return by what patterns are compared: less is better, and first all whose cut parts every fold on one side."""
    inside = sides_of_lines(made.shape)
    return bool(inside.any() and not inside.all()), rank(crease_numbers(made.part).lines, shortest_crease(made.creases))
