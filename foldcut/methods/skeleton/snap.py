"""Move corners of a drawing by hairs, so that creases along its straight skeleton meet where they nearly meet.

``Shape`` on its sheet -> ``Shape``, and how far its corners were moved. Curves and symmetric shapes are drawn with
rounded numbers; without this each rounding error has creases of its own.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely

from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.geometry.union_find import groups
from foldcut.methods.skeleton.perpendiculars import SNAP, Perpendiculars, divide_sheet
from foldcut.methods.skeleton.straight_skeleton import EXACT, TIES, DrawnSkeleton, straight_skeleton

__all__ = ["tie_nodes", "tie_perpendiculars"]

Side = tuple[int, bool]  # a side, and whether what is meant is at its left
Tie = frozenset[Side]  # sides that are equally far from one point

ROUNDS, NEWTON_STEPS = 6, 12

REACH, MOST_TRIALS = 60.0, 40
"""Ridges this many times longer than corners may be moved are tried to be made to vanish, so many in a round."""

FREE = 100.0
"""How much more freely nodes are moved than corners."""

PASSING, MOST_MEETINGS, MOST_MISSES = 10.0, 12, 8
"""Perpendiculars that pass a node this many times farther off than corners may be moved are tried to be made to meet
it, so many in all; of those that do not yet, so many are tried for each that is found."""

DIFFERENCE = 1e-6
"""Corners are moved by so much, relative to the sheet's diagonal, for derivatives of where a perpendicular comes to."""


@dataclass(frozen=True)
class Meeting:
    """A perpendicular that has to come to a node.

    The sides around the node that it starts at, those that it crosses, and those around the node that it comes to.
    """

    start: Tie
    way: tuple[Side, ...]
    end: Tie


@dataclass
class _Moves:
    """A shape whose corners are moved by as little as possible, and what that is for."""

    original: Shape
    sheet: Sheet
    near: float
    now: Shape
    ties: list[Tie]
    meetings: list[Meeting]

    def add(self, ties: Sequence[Tie] = (), meetings: Sequence[Meeting] = ()) -> bool:
        """Move corners for this, too; leave all as it is and return False where that cannot be.

        Some had to move by more than ``near``, or sides would cross or touch.
        """
        kept = [known for known in self.ties if not any(known < tie for tie in ties)]
        ties, meetings = [*kept, *ties], [*self.meetings, *meetings]
        moved = _moved(self.original, self.sheet, ties, meetings)
        if moved is None or _farthest(moved, self.original) > self.near:
            return False
        if not shapely.multilinestrings([shapely.linearrings(loop) for loop in moved.loops]).is_simple:
            return False
        self.now, self.ties, self.meetings = moved, ties, meetings
        return True

    def is_known(self, tie: Tie) -> bool:
        return any(tie <= known for known in self.ties)


def tie_nodes(shape: Shape, sheet: Sheet, near: float) -> tuple[Shape, float]:
    """Move corners so that nodes of the straight skeleton that are nearer than ``near``, in mm, become one.

    Returns the shape, and how far in mm its corners were moved at most. Nodes that would need more than ``near`` are
    left as they are.
    """
    moves = _tied(shape, sheet, near)
    return moves.now, _farthest(moves.now, shape)


def tie_perpendiculars(shape: Shape, sheet: Sheet, near: float) -> tuple[Shape, float]:
    """Do as ``tie_nodes``, and move corners so that perpendiculars that pass a node by a hair come to it.

    Returns the shape, and how far in mm its corners were moved at most. What comes of it has a straight skeleton whose
    perpendiculars end, if the shape with its nodes tied has one.
    """
    moves = _tied(shape, sheet, near)
    with suppress(UnfoldableError):
        missed = _misses(moves.now, sheet, PASSING * near)
        refused: set[Tie | Meeting] = set()
        for _ in range(MOST_MEETINGS):
            for new in [new for _, new in missed if new not in refused][:MOST_MISSES]:
                refused.add(new)
                tried = replace(moves)
                if not (tried.add(meetings=[new]) if isinstance(new, Meeting) else tried.add([new])):
                    continue
                with suppress(UnfoldableError):
                    missed = _misses(tried.now, sheet, PASSING * near)
                    moves = tried
                    break
            else:
                break
    return moves.now, _farthest(moves.now, shape)


def _tied(shape: Shape, sheet: Sheet, near: float) -> _Moves:
    moves = _Moves(shape, sheet, near, shape, [], [])
    refused: set[Tie] = set()
    for _ in range(ROUNDS):
        found = [tie for _, tie in _near_ties(DrawnSkeleton(moves.now, sheet, TIES[-1]), near)]
        found = [tie for tie in found if not moves.is_known(tie)]
        if not found or not moves.add(found):
            break
    for _ in range(ROUNDS):
        ridges = _near_ties(DrawnSkeleton(moves.now, sheet, TIES[-1]), REACH * near, single=True)
        changed = False
        new = [tie for _, tie in sorted(ridges, key=lambda one: one[0])]
        for tie in [tie for tie in new if not moves.is_known(tie) and tie not in refused][:MOST_TRIALS]:
            if moves.add([tie]):
                changed = True
            else:
                refused.add(tie)
        if not changed:
            break
    return moves


def _farthest(one: Shape, other: Shape) -> float:
    return max(float(np.hypot(*(a - b).T).max()) for a, b in zip(one.loops, other.loops, strict=True))


def _misses(shape: Shape, sheet: Sheet, reach: float) -> list[tuple[float, Tie | Meeting]]:
    """Return what perpendiculars that are likely to be folded miss by no more than ``reach``, the nearest first.

    They pass nodes, or begin or end at nodes that nearly are on another ridge; with how far they miss.
    Raises ``UnfoldableError`` where there is no skeleton, perpendiculars do not end, or facets do not meet.
    """
    skeleton = straight_skeleton(shape, sheet)
    perpendiculars = Perpendiculars(skeleton, sheet)
    perpendiculars.trace(perpendiculars.odd)
    perpendiculars.require_ends()
    choices = [*perpendiculars.fewest(1), *perpendiculars.rooted()[:1]]
    divide_sheet(perpendiculars, choices[0] if choices else [])
    sides = [(region.side, perpendiculars.is_left(region)) for region in skeleton.regions]
    around: dict[int, Tie] = defaultdict(frozenset)
    for side, region in zip(sides, skeleton.regions, strict=True):
        for vertex in region.ring:
            around[vertex] |= {side}
    nodes = set(perpendiculars.nodes)
    found: list[tuple[float, Tie | Meeting]] = []
    for number in sorted({number for taken in choices for number in taken}):
        path = perpendiculars.paths[number]
        way = tuple(sides[step.region] for step in path.steps)
        for k, step in enumerate(path.steps):
            region = skeleton.regions[step.region]
            for vertex in sorted(nodes.intersection(region.ring) - {path.start, path.end}):
                miss = abs(skeleton.u(region.side, vertex) - step.u)
                if perpendiculars.snap < miss < reach:
                    found.append((miss, Meeting(around[path.start], way[: k + 1], around[vertex])))
        if len(way) > 1:
            ends = ((path.start, path.steps[0], way[1]), (path.end, path.steps[-1], way[-2]))
            for vertex, step, beyond in ends:
                miss = float(np.hypot(*(step.end - step.start)))
                if vertex in nodes and miss < reach and beyond not in around[vertex]:
                    found.append((miss, around[vertex] | {beyond}))
    return sorted(found, key=lambda one: one[0])


def _near_ties(drawn: DrawnSkeleton, near: float, *, single: bool = False) -> Iterator[tuple[float, Tie]]:
    """Yield the sides that meet in nodes with a way along ridges shorter than ``near`` between them, and its length.

    ``single``: for each ridge by itself.
    """
    points, rings = drawn.faces()
    beside: dict[int, set[tuple[int, bool]]] = defaultdict(set)
    edges = set()
    for side, left, ring in rings:
        for vertex in ring:
            beside[vertex].add((side, left))
        edges |= {(a, b) for a, b in zip(ring, ring[1:] + ring[:1], strict=True) if b > a >= drawn.count}
    ends = np.array(sorted(edges)).reshape(-1, 2)
    length = np.hypot(*(points[ends[:, 0]] - points[ends[:, 1]]).T)
    short = ends[length < near]
    if single:
        for (a, b), way in zip(short.tolist(), length[length < near].tolist(), strict=True):
            yield way, frozenset(beside[a] | beside[b])
        return
    group = np.array(groups(len(points), short.tolist()))
    for number in np.unique(group[short[:, 0]]).tolist():
        yield near, frozenset().union(*(beside[v] for v in np.flatnonzero(group == number).tolist()))


def _moved(shape: Shape, sheet: Sheet, ties: Sequence[Tie], meetings: Sequence[Meeting]) -> Shape | None:
    """Return the shape with corners moved as little as possible for all ties and meetings.

    Newton's method, each step the least one; None where that does not lead to it.
    """
    ends = np.cumsum([len(loop) for loop in shape.loops])
    corners = np.concatenate(shape.loops)
    following = np.concatenate(
        [np.roll(np.arange(b - len(loop), b), -1) for b, loop in zip(ends, shape.loops, strict=True)]
    )
    original, count = corners.copy(), len(corners)
    nodes: list[Floats] = []
    exact, snap = EXACT * sheet.diagonal / 10, SNAP * sheet.diagonal / 100
    for step in range(NEWTON_STEPS):
        if not (np.hypot(*(corners[following] - corners).T) > exact).all():
            return None  # a side of no length has no direction
        along, normal, length = _sides(corners, following)
        rows: list[Floats] = []
        values: list[float] = []
        for k, tie in enumerate(ties):
            number, turn = _turns(tie)
            if step == 0:
                nodes.append(_node(corners, normal, tie))
            place, height = nodes[k][:2], nodes[k][2]
            for side, sign in zip(number, turn.tolist(), strict=True):
                away = place - corners[side]
                part = float(away @ along[side]) / length[side]
                row = np.zeros(2 * count + 3 * len(ties))
                row[2 * side : 2 * side + 2] = -sign * (1 - part) * normal[side]
                row[2 * following[side] : 2 * following[side] + 2] -= sign * part * normal[side]
                at = 2 * count + 3 * k
                row[at : at + 2] = sign * normal[side]
                row[at + 2] = -1.0
                rows.append(row)
                values.append(height - sign * float(away @ normal[side]))
        with np.errstate(all="ignore"):
            missed = [float(_missed(corners, following, meeting)) for meeting in meetings]
        if not np.isfinite(missed).all():
            return None
        if max(map(abs, values), default=0.0) <= exact and max(map(abs, missed), default=0.0) <= snap:
            loops = tuple(points_array(loop) for loop in np.split(corners, ends[:-1]))
            return Shape(loops, shape.parent)
        for meeting, value in zip(meetings, missed, strict=True):
            with np.errstate(all="ignore"):
                slopes = _slopes(corners, following, meeting, DIFFERENCE * sheet.diagonal)
            rows.append(np.concatenate([slopes, np.zeros(3 * len(ties))]))
            values.append(-value)
        system = np.array(rows)
        if not np.isfinite(system).all():
            return None
        # the least way from the drawing, not from the last step
        system[:, 2 * count :] *= FREE
        behind = np.concatenate([(corners - original).ravel(), np.zeros(3 * len(ties))])
        change = np.linalg.lstsq(system, np.array(values) + system @ behind, rcond=1e-10)[0] - behind
        corners = corners + change[: 2 * count].reshape(-1, 2)
        for k, node in enumerate(change[2 * count :].reshape(-1, 3)):
            nodes[k] = nodes[k] + FREE * node
    return None


def _sides(corners: Floats, following: Floats) -> tuple[Floats, Floats, Floats]:
    """The sides' directions, left normals and lengths; ``corners`` are ``(..., n, 2)``."""
    along = corners[..., following, :] - corners
    length = np.hypot(along[..., 0], along[..., 1])
    along = along / length[..., None]
    return along, np.stack([-along[..., 1], along[..., 0]], axis=-1), length


def _turns(tie: Tie) -> tuple[list[int], Floats]:
    ordered = sorted(tie)
    return [side for side, _ in ordered], np.where([left for _, left in ordered], 1.0, -1.0)


def _node(corners: Floats, normal: Floats, tie: Tie) -> Floats:
    """The point that is equally far from sides, and how far, ``(..., 3)``."""
    number, turn = _turns(tie)
    inward = turn[:, None] * normal[..., number, :]
    system = np.concatenate([inward, np.full((*inward.shape[:-1], 1), -1.0)], axis=-1)
    right = (inward * corners[..., number, :]).sum(axis=-1, keepdims=True)
    node: Floats = (np.linalg.pinv(system, rcond=1e-12) @ right)[..., 0]
    return node


def _missed(corners: Floats, following: Floats, meeting: Meeting) -> Floats:
    """How far a perpendicular passes the node that it has to meet, ``(...)`` for corners ``(..., n, 2)``."""
    along, normal, _ = _sides(corners, following)

    def along_side(side: int, place: Floats) -> Floats:
        u: Floats = ((place - corners[..., side, :]) * along[..., side, :]).sum(axis=-1)
        return u

    place = _node(corners, normal, meeting.start)[..., :2]
    for (one, left), (other, other_left) in pairwise(meeting.way):
        if one == other:
            continue  # across the side itself
        # at the height over the one side at which the other one is as far
        foot = corners[..., one, :] + along_side(one, place)[..., None] * along[..., one, :]
        up, down = (1 if left else -1) * normal[..., one, :], (1 if other_left else -1) * normal[..., other, :]
        level = ((foot - corners[..., other, :]) * down).sum(axis=-1)
        place = foot + (level / (1 - (up * down).sum(axis=-1)))[..., None] * up
    last = meeting.way[-1][0]
    return along_side(last, place) - along_side(last, _node(corners, normal, meeting.end)[..., :2])


def _slopes(corners: Floats, following: Floats, meeting: Meeting, step: float) -> Floats:
    """The derivatives of ``_missed`` by the corners' coordinates, ``(2 n,)``."""
    sides = [side for side, _ in (*meeting.start, *meeting.way, *meeting.end)]
    moved = np.unique(np.concatenate([sides, following[sides]]))
    variables = np.unique(np.concatenate([2 * moved, 2 * moved + 1]))
    flat = np.tile(corners.ravel(), (2 * len(variables), 1))
    for k, variable in enumerate(variables.tolist()):
        flat[2 * k, variable] += step
        flat[2 * k + 1, variable] -= step
    missed = _missed(flat.reshape(-1, *corners.shape), following, meeting)
    slopes = np.zeros(corners.size)
    slopes[variables] = (missed[::2] - missed[1::2]) / (2 * step)
    return slopes
