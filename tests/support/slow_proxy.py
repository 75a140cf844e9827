"""What an outline costs to fold, the slow way: by tracing in Python, dividing the sheet and counting creases.

Nothing here is shared with ``redraw.proxy_kernel`` but the straight skeleton.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np

from foldcut.core.arrays import Floats, Ragged, index_array, points_array
from foldcut.core.model import CreasePattern, Shape, Sheet
from foldcut.methods.skeleton import perpendiculars as perpendiculars_module
from foldcut.methods.skeleton.choices import away_from_roots
from foldcut.methods.skeleton.facets import Division
from foldcut.methods.skeleton.perpendiculars import Perpendiculars, trace
from foldcut.methods.skeleton.search import ridges_of
from foldcut.pattern.foldability import crease_numbers
from foldcut.redraw.proxy_kernel import MOST_CROSSINGS


class Counted(NamedTuple):
    """What can be counted in the pattern of one set of perpendiculars."""

    lines: int
    shortest: float
    taken: int


class Slow(NamedTuple):
    """How many nodes are odd, of how many of them no perpendicular ends, and how many perpendiculars do not end.

    ``counted``: for each set of perpendiculars away from a corridor, if all end.
    """

    odd: int
    endless: int
    loose: int
    counted: list[Counted]

    @property
    def all_end(self) -> bool:
        return not self.loose


@contextmanager
def as_many_crossings() -> Iterator[None]:
    """Give perpendiculars up after as many crossings as the proxy does."""
    before = perpendiculars_module.MOST_CROSSINGS
    perpendiculars_module.MOST_CROSSINGS = MOST_CROSSINGS
    try:
        yield
    finally:
        perpendiculars_module.MOST_CROSSINGS = before


def slow_proxy(shape: Shape, sheet: Sheet, axes: tuple[int, ...] = ()) -> Slow:
    """Return what an outline costs on a sheet; with ``axes``, on a half or quarter whose border is creased there."""
    with as_many_crossings():
        ridges = ridges_of(shape, sheet, 0.0)
        every = trace(ridges, ridges.nodes)
    ending = {node for path in every.paths for node in (path.start, path.end)}
    nodes = set(ridges.nodes)
    begun = sum(
        _begins(every, number, node, upper)
        for number, face in enumerate(ridges.skeleton.faces)
        for upper, chain in enumerate((face.lower, face.upper))
        for node in chain
        if node in nodes
    )
    ended = sum(1 + (path.end in nodes) for path in every.paths)
    endless = sum(node not in ending for node in ridges.odd)
    sets = (away_from_roots(every) or [[]]) if begun == ended else []
    patterns = [counted(every, taken, sheet, axes) for taken in sets]
    return Slow(len(ridges.odd), endless, begun - ended, patterns)


def _begins(every: Perpendiculars, face: int, node: int, upper: int) -> bool:
    """Return whether a perpendicular begins at a node of a face, on one of its chains."""
    ridges = every.ridges
    u = ridges.u(face, node)
    hit = ridges.hit(face, u, 1 - upper)
    here = ridges.places[node]
    return hit is not None and float(np.hypot(hit.place[0] - here[0], hit.place[1] - here[1])) >= ridges.snap


def creases_of(every: Perpendiculars, taken: list[int]) -> tuple[Floats, list[tuple[int, int]]]:
    """Return points, and pairs of them, of the creases that some perpendiculars and the ridges make on the sheet."""
    division = Division(every, taken)
    return np.array(division.points), [edge for edge, _ in division.planar()[1]]


def counted(every: Perpendiculars, taken: list[int], sheet: Sheet, axes: tuple[int, ...] = ()) -> Counted:
    """Return what can be counted in the pattern of a set of perpendiculars, pieces of axes included."""
    points, edges = creases_of(every, taken)
    used = np.unique(edges)
    number = np.full(len(points), -1)
    number[used] = np.arange(len(used))
    kinds = np.array(["M"] * len(edges))
    creases = CreasePattern(
        points_array(points[used]), index_array(number[np.array(edges)]), kinds, Ragged.from_rows([])
    )
    numbers = crease_numbers(creases)
    lengths = [numbers.shortest_crease_mm or np.inf]
    for axis in axes:
        length = (sheet.height, sheet.width)[axis]
        places = points[used][np.abs(points[used][:, axis]) <= every.ridges.snap, 1 - axis]
        pieces = np.diff(np.unique([0.0, *places, length]))
        lengths.append(float(pieces[pieces > every.ridges.snap].min()))
    return Counted(numbers.lines, min(lengths), len(taken))
