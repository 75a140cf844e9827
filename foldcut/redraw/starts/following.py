"""Fit one edge of a strip so that it follows the other: bends at the same places, tangents of common disks.

Of each side the line of one edge is known, that of the leading edge; which edge leads may change from side to side. The
middles of the disks then lie on bisectors of the leading edge, and each has only its radius to choose: a small dynamic
program over a few radii for each bend. Where the leading edge changes, the lines of both edges are known for one side,
and the radii at its ends follow from that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Bools, Floats, Indices
from foldcut.redraw.starts import pieces
from foldcut.redraw.starts.fitting import ANY, End, Sides

__all__ = ["Lead", "follow", "lead_of"]

RADII = np.arange(-8, 9)
"""The radii that are tried: so many steps from the one found."""

STEP = 0.2
"""A step from one radius to the next, as a part of the tolerance."""

TAPER = 1.0
"""What a side costs whose edges are not parallel: the ridges across a strip go on straight between sides that are."""

CLOSER = 0.3
"""What a side costs that is off by all of the tolerance."""

STEEPEST = 0.7
"""How fast a radius may change along a strip."""

Disks = tuple[Floats, Floats]
"""Middles ``(r, 2)`` and radii ``(r,)``, negative for disks on the right of the first edge."""


@dataclass(frozen=True, eq=False)
class Lead:
    """The lines that are known of a strip: side s goes from column ``cuts[s]`` to ``cuts[s + 1]``.

    ``normals`` ``(2, s, 2)`` and ``offsets`` ``(2, s)`` as in ``Sides``, where ``known`` ``(2, s)`` says so.
    """

    cuts: Indices
    normals: Floats
    offsets: Floats
    known: Bools


def lead_of(sides: Sides, edge: int) -> Lead:
    """Return what is known if one edge, 0 or 1, leads all the way: its lines, the only row of ``sides``."""
    count = len(sides.normals[0])
    known = np.zeros((2, count), dtype=bool)
    known[edge] = True
    return Lead(sides.cuts, np.repeat(sides.normals[:1], 2, axis=0), np.repeat(sides.offsets[:1], 2, axis=0), known)


def follow(
    points: Floats, along: Floats, lead: Lead, tolerance: float, *, first: End = ANY, last: End = ANY
) -> Sides | None:
    """Return the lines of both rows of ``points`` ``(2, m, 2)``, with those that are known, or None.

    ``along`` ``(m, 3)`` mm: middle and radius of disks that touch both rows; the radius is negative on the right of the
    first. ``first``, ``last``: only those of an axis matter. The other lines are within ``tolerance`` mm of their rows.
    """
    count = lead.known.shape[1]
    step, usual = STEP * tolerance, float(np.median(along[:, 2]))
    nodes: list[Disks] = []
    for k in range(count + 1):
        radii = usual + step * (RADII + round((float(along[lead.cuts[k], 2]) - usual) / step))
        node = _node(points, radii.astype(np.float64), lead, k)
        if node is None:
            return None
        nodes.append(node)
    cost = np.zeros(len(nodes[0][1]))
    behind: list[Indices] = []
    lines: list[tuple[Floats, Floats]] = []
    for s in range(count):
        edge = int(lead.known[0, s])  # the edge that follows
        if lead.known[:, s].all():
            shape = len(nodes[s][1]), len(nodes[s + 1][1])
            normal = np.broadcast_to(lead.normals[1, s], (*shape, 2))
            offset, price = np.full(shape, lead.offsets[1, s]), np.zeros(shape)
        else:
            across = (s == 0 and first.kind == pieces.DIRECTED) or (s == count - 1 and last.kind == pieces.DIRECTED)
            known = lead.normals[1 - edge, s]
            if across:
                before = s == 0 and count > 1
                normal, offset, possible = _parallel(nodes[s], nodes[s + 1], known, edge, before=before)
            else:
                normal, offset, possible = _tangents(nodes[s], nodes[s + 1], known, edge)
            piece = points[edge, lead.cuts[s] : lead.cuts[s + 1] + 1]
            off = np.abs(normal @ piece.T - offset[..., None]).max(axis=2)
            taper = np.abs(normal @ np.array([known[1], -known[0]])) > 1e-9
            price = np.where(possible & (off <= tolerance), CLOSER * (off / tolerance) ** 2 + TAPER * taper, np.inf)
        total = cost[:, None] + price
        behind.append(total.argmin(axis=0))
        cost = total.min(axis=0)
        lines.append((normal, offset))
    if not np.isfinite(cost).any():
        return None
    b = int(cost.argmin())
    normals, offsets = lead.normals.copy(), lead.offsets.copy()
    for s in range(count - 1, -1, -1):
        a = int(behind[s][b])
        edge = int(lead.known[0, s])
        normals[edge, s], offsets[edge, s] = lines[s][0][a, b], lines[s][1][a, b]
        b = a
    return Sides(lead.cuts, normals, offsets, float(count))


def _node(points: Floats, radii: Floats, lead: Lead, k: int) -> Disks | None:
    """Return the disks that may lie between sides k - 1 and k, or at an end."""
    column, count = int(lead.cuts[k]), lead.known.shape[1]
    sides = [s for s in (k - 1, k) if 0 <= s < count]
    rows, values = [], []
    for edge in (0, 1):
        for s in sides:
            if lead.known[edge, s]:
                rows.append([*lead.normals[edge, s], -1.0 if edge == 0 else 1.0])
                values.append(lead.offsets[edge, s])
    if len(sides) == 1:  # at an end: beside the sample there
        x, y = lead.normals[int(not lead.known[0, sides[0]]), sides[0]]
        place = points[int(not lead.known[0, sides[0]]), column]
        rows.append([y, -x, 0.0])
        values.append(float(y * place[0] - x * place[1]))
    system, value = np.array(rows), np.array(values)
    if len(rows) < 2:
        return None
    if len(rows) == 2:
        sine = float(system[0, 0] * system[1, 1] - system[0, 1] * system[1, 0])
        if abs(sine) < 0.03:
            return None
        inverse = np.array([(system[1, 1], -system[0, 1]), (-system[1, 0], system[0, 0])]) / sine
        return (value - radii[:, None] * system[:, 2]) @ inverse.T, radii
    found = np.linalg.lstsq(system, value, rcond=None)[0]
    if len(rows) > 3 and np.abs(system @ found - value).max() > 1e-9 * np.abs(value).max():
        return None
    if not radii.min() <= found[2] <= radii.max():
        return None
    return found[None, :2], found[2:]


def _tangents(one: Disks, two: Disks, lead: Floats, edge: int) -> tuple[Floats, Floats, Bools]:
    """Return normals, offsets, and which are possible, of an edge's tangents between the disks of two nodes."""
    (p, r), (q, w) = one, two
    away = q[None] - p[:, None]
    length = np.maximum(np.hypot(away[..., 0], away[..., 1]), 1e-12)
    ahead = away / length[..., None]
    slope = (w[None] - r[:, None]) / length
    left = np.stack([-ahead[..., 1], ahead[..., 0]], axis=-1)
    level = np.sqrt(np.maximum(1 - slope**2, 0.0))
    sign = 1.0 if edge == 0 else -1.0
    normal = sign * slope[..., None] * ahead + level[..., None] * left
    possible = (np.abs(slope) < STEEPEST) & (ahead @ np.array([lead[1], -lead[0]]) > 0)
    offset = (normal * p[:, None]).sum(axis=-1) - sign * r[:, None]
    return normal, offset, possible


def _parallel(one: Disks, two: Disks, lead: Floats, edge: int, *, before: bool) -> tuple[Floats, Floats, Bools]:
    """Return what ``_tangents`` does for a side across an axis: parallel to the leading one, touching one disk.

    ``before``: the side lies before the second node, and there is none at its other end.
    """
    middles, radii = two if before else one
    shape = len(one[1]), len(two[1])
    offset = middles @ lead - (1.0 if edge == 0 else -1.0) * radii
    offsets = np.broadcast_to(offset[None] if before else offset[:, None], shape)
    return np.broadcast_to(lead, (*shape, 2)), offsets, np.ones(shape, dtype=bool)
