"""Move corners of a drawing by hairs, so that creases along its straight skeleton meet where they nearly meet.

``Shape`` on its sheet -> ``Shape``, and how far its corners were moved. Curves and symmetric shapes are drawn with
rounded numbers; without this each rounding error has creases of its own.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence

import numpy as np

from foldcut.model import Floats, Shape, Sheet, points_array
from foldcut.perpendiculars import EXACT, TIES, DrawnSkeleton, groups
from foldcut.plane import left_normal

__all__ = ["tie_nodes"]

Tie = frozenset[tuple[int, bool]]  # sides that are equally far from one point, and whether it is at their left

ROUNDS, NEWTON_STEPS = 6, 12

REACH, MOST_TRIALS = 60.0, 40
"""Ridges this many times longer than corners may be moved are tried to be made to vanish, so many in a round."""

FREE = 100.0
"""How much more freely nodes are moved than corners."""


def tie_nodes(shape: Shape, sheet: Sheet, near: float) -> tuple[Shape, float]:
    """Move corners so that nodes of the straight skeleton that are nearer than ``near``, in mm, become one.

    Returns the shape, and how far in mm its corners were moved at most. Nodes that would need more than ``near`` are
    left as they are.
    """
    ties: list[Tie] = []
    refused: set[Tie] = set()
    now = shape
    for _ in range(ROUNDS):
        found = [tie for _, tie in _near_ties(DrawnSkeleton(now, sheet, TIES[-1]), near) if not _is_known(tie, ties)]
        if not found:
            break
        moved = _with_ties(shape, sheet, ties, found, near)
        if moved is None:
            break
        now, ties = moved
    for _ in range(ROUNDS):
        ridges = sorted(
            _near_ties(DrawnSkeleton(now, sheet, TIES[-1]), REACH * near, single=True), key=lambda one: one[0]
        )
        new = [tie for _, tie in ridges if not _is_known(tie, ties) and tie not in refused]
        changed = False
        for tie in new[:MOST_TRIALS]:
            moved = _with_ties(shape, sheet, ties, [tie], near)
            if moved is None:
                refused.add(tie)
            else:
                changed = True
                now, ties = moved
        if not changed:
            break
    return now, max(map(_farthest, now.loops, shape.loops))


def _is_known(tie: Tie, ties: Sequence[Tie]) -> bool:
    return any(tie <= known for known in ties)


def _with_ties(
    shape: Shape, sheet: Sheet, ties: list[Tie], more: list[Tie], near: float
) -> tuple[Shape, list[Tie]] | None:
    """Return the shape with more ties, and all its ties, or None if corners are moved by more than ``near``."""
    ties = [known for known in ties if not any(known < tie for tie in more)] + more
    moved = _moved(shape, sheet, ties)
    if moved is None or max(map(_farthest, moved.loops, shape.loops)) > near:
        return None
    return moved, ties


def _farthest(one: Floats, other: Floats) -> float:
    return float(np.hypot(*(one - other).T).max())


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


def _moved(shape: Shape, sheet: Sheet, ties: Sequence[Tie]) -> Shape | None:
    """Return the shape with corners moved as little as possible so that each tie's sides are equally far from a point.

    Newton's method, each step the least one; None where that does not lead to it.
    """
    ends = np.cumsum([len(loop) for loop in shape.loops])
    corners = np.concatenate(shape.loops)
    following = np.concatenate(
        [np.roll(np.arange(b - len(loop), b), -1) for b, loop in zip(ends, shape.loops, strict=True)]
    )
    original, count = corners.copy(), len(corners)
    nodes: list[Floats] = []
    exact = EXACT * sheet.diagonal / 10
    for step in range(NEWTON_STEPS):
        along = corners[following] - corners
        length = np.hypot(*along.T)
        along /= length[:, None]
        normal = left_normal(along)
        rows: list[Floats] = []
        values: list[float] = []
        for k, tie in enumerate(ties):
            number = [side for side, _ in tie]
            turn = np.where([left for _, left in tie], 1.0, -1.0)
            if step == 0:
                system = np.column_stack([turn[:, None] * normal[number], -np.ones(len(number))])
                right = (turn[:, None] * normal[number] * corners[number]).sum(axis=1)
                nodes.append(np.linalg.lstsq(system, right, rcond=1e-12)[0])
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
        if max(map(abs, values)) <= exact:
            loops = tuple(points_array(loop) for loop in np.split(corners, ends[:-1]))
            return Shape(loops, shape.parent)
        system = np.array(rows)
        # the least way from the drawing, not from the last step
        system[:, 2 * count :] *= FREE
        behind = np.concatenate([(corners - original).ravel(), np.zeros(3 * len(ties))])
        change = np.linalg.lstsq(system, np.array(values) + system @ behind, rcond=1e-10)[0] - behind
        corners = corners + change[: 2 * count].reshape(-1, 2)
        for k, node in enumerate(change[2 * count :].reshape(-1, 3)):
            nodes[k] = nodes[k] + FREE * node
    return None
