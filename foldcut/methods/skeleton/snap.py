"""Move corners of a drawing by hairs, so that creases along its straight skeleton meet where they nearly meet.

``Shape`` on its sheet -> ``Shape``, and how far its corners were moved. Curves and symmetric shapes are drawn with
rounded numbers, and otherwise each rounding error would get creases of its own.

Here it is decided what is to meet; ``move_corners`` does the moving.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
import shapely

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.geometry.union_find import groups
from foldcut.methods.skeleton.choices import away_from_roots, fewest_folds
from foldcut.methods.skeleton.facets import divide_sheet
from foldcut.methods.skeleton.move_corners import Line, Meeting, Tie, with_corners_moved
from foldcut.methods.skeleton.perpendiculars import Ridges, trace
from foldcut.methods.skeleton.skeleton_faces import Edge, Skeleton, half_edges, skeleton_of

__all__ = ["tie_nodes", "tie_perpendiculars"]

ROUNDS = 6
"""How many times ties are looked for, each time in the drawing as it has been moved so far."""

REACH = 60.0
"""Ridges are tried to be shrunk to nothing if they are no longer than this many times what corners may be moved."""

MOST_TRIALS = 40
"""How many such ridges are tried in a round."""

PASSING = 10.0
"""Perpendiculars are moved to a node that they miss by no more than this many times what corners may be moved."""

MOST_MEETINGS = 12
"""How many perpendiculars are moved to nodes."""

MOST_MISSES = 8
"""How many are tried for each that is."""


@dataclass
class Moves:
    """A shape whose corners are moved as little as possible, and the ties and meetings for which they are.

    Sides on one of the ``lines`` stay on one line.
    """

    original: Shape
    sheet: Sheet
    near: float
    now: Shape
    lines: list[Line] = field(default_factory=list)
    ties: list[Tie] = field(default_factory=list)
    meetings: list[Meeting] = field(default_factory=list)

    def add(self, ties: Sequence[Tie] = (), meetings: Sequence[Meeting] = ()) -> bool:
        """Move corners for these, too, and return True; return False and change nothing where that cannot be done.

        It cannot where a corner would have to move by more than ``near`` mm, or where sides would cross or touch.
        """
        kept = [known for known in self.ties if not any(known < tie for tie in ties)]
        ties, meetings = [*kept, *ties], [*self.meetings, *meetings]
        moved = with_corners_moved(self.original, self.sheet, ties, meetings, self.lines)
        if moved is None or _farthest(moved, self.original) > self.near:
            return False
        if not shapely.multilinestrings([shapely.linearrings(loop) for loop in moved.loops]).is_simple:
            return False
        self.now, self.ties, self.meetings = moved, ties, meetings
        return True

    def is_known(self, tie: Tie) -> bool:
        """Return whether the sides of a tie are tied already, with others perhaps."""
        return any(tie <= known for known in self.ties)


def tie_nodes(shape: Shape, sheet: Sheet, near: float) -> tuple[Shape, float]:
    """Move corners so that skeleton nodes less than ``near`` mm apart become one.

    Returns the shape, and how far in mm its corners were moved at most. Nodes for which a corner would have to move by
    more than ``near`` are left as they are.
    """
    moves = _tied(shape, sheet, near)
    return moves.now, _farthest(moves.now, shape)


def tie_perpendiculars(shape: Shape, sheet: Sheet, near: float) -> tuple[Shape, float]:
    """Do as ``tie_nodes``, and also move corners so that perpendiculars come to the nodes that they miss by a hair.

    Returns the shape, and how far in mm its corners were moved at most. If the shape with its nodes tied has a straight
    skeleton whose perpendiculars end, the one that is returned has, too.
    """
    moves = replace(_tied(shape, sheet, near))
    with suppress(UnfoldableError):  # without a skeleton, or where perpendiculars do not end, nothing more is moved
        missed = _misses(moves.now, sheet, PASSING * near)
        refused: set[Tie | Meeting] = set()
        for _ in range(MOST_MEETINGS):
            for new in [new for _, new in missed if new not in refused][:MOST_MISSES]:
                refused.add(new)
                tried = replace(moves)
                if not (tried.add(meetings=[new]) if isinstance(new, Meeting) else tried.add([new])):
                    continue
                with suppress(UnfoldableError):  # a move that spoils the skeleton is not kept
                    missed = _misses(tried.now, sheet, PASSING * near)
                    moves = tried
                    break
            else:
                break
    return moves.now, _farthest(moves.now, shape)


@lru_cache(maxsize=8)
def _tied(shape: Shape, sheet: Sheet, near: float) -> Moves:
    """Tie nodes that are near to each other, all at once; then shrink ridges to nothing, one after the other."""
    lines = {tuple(flank.side for flank in face.flanks) for face in skeleton_of(shape, sheet).faces}
    moves = Moves(shape, sheet, near, shape, sorted(line for line in lines if len(line) > 1))
    refused: set[Tie] = set()
    for _ in range(ROUNDS):
        found = list(_near_nodes(skeleton_of(moves.now, sheet), near))
        found = [tie for tie in found if not moves.is_known(tie)]
        if not found or not moves.add(found):
            break
    for _ in range(ROUNDS):
        skeleton = skeleton_of(moves.now, sheet)
        changed = False
        ridges = sorted(_short_ridges(skeleton, REACH * near))
        new = [skeleton.flanks_at[a] | skeleton.flanks_at[b] for _, (a, b) in ridges]
        for tie in [tie for tie in new if not moves.is_known(tie) and tie not in refused][:MOST_TRIALS]:
            if moves.add([tie]):
                changed = True
            else:
                refused.add(tie)
        if not changed:
            break
    return moves


def _farthest(one: Shape, other: Shape) -> float:
    """Return the largest distance between corners of two shapes."""
    return max(float(np.hypot(*(a - b).T).max()) for a, b in zip(one.loops, other.loops, strict=True))


def _misses(shape: Shape, sheet: Sheet, reach: float) -> list[tuple[float, Tie | Meeting]]:
    """Return what perpendiculars that are likely to be folded miss by less than ``reach`` mm, and by how much.

    They pass a node (a meeting), or the node at one of their ends nearly lies on another ridge (a tie). The nearest
    come first. Raises ``UnfoldableError`` where there is no skeleton, where perpendiculars do not end, and where facets
    do not meet.
    """
    skeleton = skeleton_of(shape, sheet)
    ridges = Ridges(skeleton, sheet)
    perpendiculars = trace(ridges, ridges.odd)
    perpendiculars.require_ends()
    sets = [*fewest_folds(perpendiculars, 1), *away_from_roots(perpendiculars)[:1]]
    divide_sheet(perpendiculars, sets[0] if sets else [], most_creases=np.inf)
    around = skeleton.flanks_at
    nodes = set(ridges.nodes)
    found: list[tuple[float, Tie | Meeting]] = []
    for number in sorted({number for taken in sets for number in taken}):
        path = perpendiculars.paths[number]
        way = tuple(skeleton.faces[piece.face].flank for piece in path.pieces)
        for k, piece in enumerate(path.pieces):
            face = skeleton.faces[piece.face]
            for vertex in sorted(nodes.intersection(face.vertices) - {path.start, path.end}):
                miss = abs(skeleton.u(face.side, vertex) - piece.u)
                if ridges.snap < miss < reach:
                    found.append((miss, Meeting(around[path.start], way[: k + 1], around[vertex])))
        if len(way) > 1:
            ends = ((path.start, path.pieces[0], way[1]), (path.end, path.pieces[-1], way[-2]))
            for vertex, piece, beyond in ends:
                miss = math.dist(piece.start, piece.end)
                if vertex in nodes and miss < reach and beyond not in around[vertex]:
                    found.append((miss, around[vertex] | {beyond}))
    return sorted(found, key=lambda one: one[0])


def _near_nodes(skeleton: Skeleton, near: float) -> Iterator[Tie]:
    """Yield the ties of nodes that are joined by ridges shorter than ``near`` mm."""
    short = [ridge for _, ridge in _short_ridges(skeleton, near)]
    group = groups(len(skeleton.points), short)
    for number in sorted({group[a] for a, _ in short}):
        yield frozenset().union(*(flanks for vertex, flanks in skeleton.flanks_at.items() if group[vertex] == number))


def _short_ridges(skeleton: Skeleton, near: float) -> Iterator[tuple[float, Edge]]:
    """Yield every ridge between two nodes that is shorter than ``near`` mm, with its length."""
    corners = len(skeleton.starts)
    ridges = {(a, b) for face in skeleton.faces for a, b in half_edges(face.vertices) if b > a >= corners}
    for a, b in sorted(ridges):
        length = float(np.hypot(*(skeleton.points[a] - skeleton.points[b])))
        if length < near:
            yield length, (a, b)
