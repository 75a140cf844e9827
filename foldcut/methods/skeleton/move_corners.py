"""Move the corners of a shape as little as possible, so that skeleton nodes meet and perpendiculars come to nodes.

``Shape``, ``Tie``s and ``Meeting``s -> ``Shape``, by Newton's method. The unknowns are the corners, and for each tie
the node that its sides are to share, with its height. Each step takes the solution nearest to the original drawing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from foldcut.core.arrays import Floats, Numbers, points_array
from foldcut.core.model import Shape, Sheet
from foldcut.methods.skeleton.perpendiculars import SNAP
from foldcut.methods.skeleton.skeleton_faces import EXACT, Flank

Tie = frozenset[Flank]
"""Flanks whose sides are to be equally far from one point: the node that they share."""

Line = tuple[int, ...]
"""Sides that lie on one line."""

NEWTON_STEPS = 12
"""How many steps Newton's method gets."""

FREE = 100.0
"""How much more freely nodes are moved than corners."""

DIFFERENCE = 1e-6
"""How far corners are moved to estimate the derivatives of a meeting, relative to the sheet's diagonal."""


@dataclass(frozen=True)
class Meeting:
    """A perpendicular that is to come to a node.

    ``start`` are the flanks around the node that it begins at, ``way`` those of the faces that it crosses, and ``end``
    those around the node that it is to come to.
    """

    start: Tie
    way: tuple[Flank, ...]
    end: Tie


def with_corners_moved(
    shape: Shape, sheet: Sheet, ties: Sequence[Tie], meetings: Sequence[Meeting], lines: Sequence[Line] = ()
) -> Shape | None:
    """Return the shape with corners moved as little as possible for ties and meetings to hold, None if that fails.

    Sides on one of the ``lines`` stay on one line.
    """
    corners, ends = np.concatenate(shape.loops), np.cumsum([len(loop) for loop in shape.loops])
    following = np.concatenate(
        [np.roll(np.arange(b - len(loop), b), -1) for b, loop in zip(ends, shape.loops, strict=True)]
    )
    original, count = corners.copy(), len(corners)
    nodes: list[Floats] = []
    exact, snap = EXACT * sheet.diagonal / 10, SNAP * sheet.diagonal / 100
    for step in range(NEWTON_STEPS):
        length = np.hypot(*(corners[following] - corners).T)
        if not ((length > exact) & np.isfinite(length)).all():
            return None  # a side of no length has no direction
        if step == 0:
            _, normal, _ = _sides(corners, following)
            nodes = [_node(corners, normal, tie) for tie in ties]
        rows, values = _tie_equations(corners, following, ties, nodes)
        straight, away = _line_equations(corners, following, lines)
        rows += [np.concatenate([row, np.zeros(3 * len(ties))]) for row in straight]
        values += away
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
        # the solution nearest to the drawing, not to the last step
        system[:, 2 * count :] *= FREE
        behind = np.concatenate([(corners - original).ravel(), np.zeros(3 * len(ties))])
        change = np.linalg.lstsq(system, np.array(values) + system @ behind, rcond=1e-10)[0] - behind
        corners = corners + change[: 2 * count].reshape(-1, 2)
        nodes = [node + FREE * moved for node, moved in zip(nodes, change[2 * count :].reshape(-1, 3), strict=True)]
    return None


def _tie_equations(
    corners: Floats, following: Numbers, ties: Sequence[Tie], nodes: Sequence[Floats]
) -> tuple[list[Floats], list[float]]:
    """Return one linear equation for every flank of every tie: its side is as far from the node as the node's height.

    Each is a row of coefficients, two for every corner and three for every node, and the value that is missing.
    """
    along, normal, length = _sides(corners, following)
    count = len(corners)
    rows: list[Floats] = []
    values: list[float] = []
    for k, (tie, node) in enumerate(zip(ties, nodes, strict=True)):
        sides, turn = _turns(tie)
        place, height = node[:2], node[2]
        for side, sign in zip(sides, turn.tolist(), strict=True):
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
    return rows, values


def _line_equations(corners: Floats, following: Numbers, lines: Sequence[Line]) -> tuple[list[Floats], list[float]]:
    """Return one linear equation for every corner of all but the first side of each line: it is on that side's line.

    Each is a row of coefficients, two for every corner, and the value that is missing.
    """
    along, normal, length = _sides(corners, following)
    rows: list[Floats] = []
    values: list[float] = []
    for first, *others in lines:
        start, end = first, int(following[first])
        for corner in sorted({corner for side in others for corner in (side, int(following[side]))} - {start, end}):
            away = corners[corner] - corners[start]
            part = float(away @ along[first]) / length[first]
            row = np.zeros((len(corners), 2))
            row[corner], row[start], row[end] = normal[first], (part - 1) * normal[first], -part * normal[first]
            rows.append(row.ravel())
            values.append(-float(away @ normal[first]))
    return rows, values


def _sides(corners: Floats, following: Numbers) -> tuple[Floats, Floats, Floats]:
    """Return the sides' directions, left normals and lengths; ``corners`` are ``(..., n, 2)``."""
    along = corners[..., following, :] - corners
    length = np.hypot(along[..., 0], along[..., 1])
    along = along / length[..., None]
    return along, np.stack([-along[..., 1], along[..., 0]], axis=-1), length


def _turns(tie: Tie) -> tuple[list[int], Floats]:
    """Return the sides of a tie, and 1.0 where their left is meant, else -1.0."""
    flanks = sorted(tie)
    return [flank.side for flank in flanks], np.where([flank.left for flank in flanks], 1.0, -1.0)


def _node(corners: Floats, normal: Floats, tie: Tie) -> Floats:
    """Return the point that is equally far from the sides of a tie, and how far that is, ``(..., 3)``."""
    sides, turn = _turns(tie)
    inward = turn[:, None] * normal[..., sides, :]
    system = np.concatenate([inward, np.full((*inward.shape[:-1], 1), -1.0)], axis=-1)
    right = (inward * corners[..., sides, :]).sum(axis=-1, keepdims=True)
    if not np.isfinite(system).all():  # of a side of no length; its singular values would be an error
        return np.full((*inward.shape[:-2], 3), np.nan)
    node: Floats = (np.linalg.pinv(system, rcond=1e-12) @ right)[..., 0]
    return node


def _missed(corners: Floats, following: Numbers, meeting: Meeting) -> Floats:
    """Return by how much a perpendicular misses the node that it is to meet, ``(...)`` mm for ``(..., n, 2)`` corners.

    It is not finite where a side has no length, or where two sides are parallel that the perpendicular crosses.
    """
    along, normal, _ = _sides(corners, following)

    def along_side(side: int, place: Floats) -> Floats:
        u: Floats = ((place - corners[..., side, :]) * along[..., side, :]).sum(axis=-1)
        return u

    place = _node(corners, normal, meeting.start)[..., :2]
    for (one, left), (other, other_left) in pairwise(meeting.way):
        if one == other:
            continue  # across the side itself
        # go straight up from the one side to where the other one is as far away
        foot = corners[..., one, :] + along_side(one, place)[..., None] * along[..., one, :]
        up, down = (1 if left else -1) * normal[..., one, :], (1 if other_left else -1) * normal[..., other, :]
        level = ((foot - corners[..., other, :]) * down).sum(axis=-1)
        place = foot + (level / (1 - (up * down).sum(axis=-1)))[..., None] * up
    last = meeting.way[-1].side
    return along_side(last, place) - along_side(last, _node(corners, normal, meeting.end)[..., :2])


def _slopes(corners: Floats, following: Numbers, meeting: Meeting, step: float) -> Floats:
    """Return the derivatives of ``_missed`` with respect to the corners' coordinates, ``(2 n,)``."""
    sides = [flank.side for flank in (*meeting.start, *meeting.way, *meeting.end)]
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
