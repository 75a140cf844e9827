"""Fit one edge of a strip so that it follows the other: bends at the same places, tangents of common disks.

The sides of the leading edge are known. The middles of the disks then lie on its bisectors, and each has only its
radius to choose: a small dynamic program over a few radii for each bend.
"""

from __future__ import annotations

import numpy as np

from foldcut.core.arrays import Bools, Floats, Indices
from foldcut.redraw.starts import pieces
from foldcut.redraw.starts.fitting import ANY, End, Sides

__all__ = ["follow"]

RADII = np.linspace(-1.6, 1.6, 17)
"""By how much the radii that are tried differ from the one found, as parts of the tolerance."""

STEEPEST = 0.7
"""How fast a radius may change along a strip."""


def follow(
    points: Floats, along: Floats, lead: Sides, tolerance: float, *, first: End = ANY, last: End = ANY
) -> Sides | None:
    """Return the lines of both rows of ``points`` ``(2, m, 2)``, the first row's as in ``lead``, or None.

    ``along`` ``(m, 3)`` mm: middle and radius of disks that touch both rows; the radius is negative on the right of the
    first. ``first``, ``last``: only those of an axis matter. The second row's lines are within ``tolerance`` of it.
    """
    normals, offsets, cuts = lead.normals[0], lead.offsets[0], lead.cuts
    count = len(normals)
    nodes = [_node(points[0], along, normals, offsets, cuts, k, tolerance) for k in range(count + 1)]
    if any(node is None for node in nodes):
        return None
    sure = [node for node in nodes if node is not None]
    cost = np.zeros(len(RADII))
    behind: list[Indices] = []
    lines: list[tuple[Floats, Floats]] = []
    for s in range(count):
        across = (s == 0 and first.kind == pieces.DIRECTED) or (s == count - 1 and last.kind == pieces.DIRECTED)
        near = sure[s + 1] if s == 0 and count > 1 else sure[s]
        normal, offset, possible = (
            _parallel(near, normals[s], s == 0 and count > 1) if across else _lines(sure[s], sure[s + 1], normals[s])
        )
        piece = points[1, cuts[s] : cuts[s + 1] + 1]
        off = np.abs(normal @ piece.T - offset[..., None]).max(axis=2)
        price = np.where(possible & (off <= tolerance), (off / tolerance) ** 2, np.inf)
        total = cost[:, None] + price
        behind.append(total.argmin(axis=0))
        cost = total.min(axis=0)
        lines.append((normal, offset))
    if not np.isfinite(cost).any():
        return None
    b = int(cost.argmin())
    other, across_offsets = np.empty_like(normals), np.empty(count)
    for s in range(count - 1, -1, -1):
        a = int(behind[s][b])
        other[s], across_offsets[s] = lines[s][0][a, b], lines[s][1][a, b]
        b = a
    return Sides(cuts, np.stack([normals, other]), np.stack([offsets, across_offsets]), lead.cost)


def _node(
    row: Floats, along: Floats, normals: Floats, offsets: Floats, cuts: Indices, k: int, tolerance: float
) -> tuple[Floats, Floats] | None:
    """Return middles ``(r, 2)`` and radii ``(r,)`` of the disks that may lie between sides k - 1 and k."""
    radii = along[cuts[k], 2] + tolerance * RADII
    if 0 < k < len(normals):
        a, b = normals[k - 1], normals[k]
        sine = float(a[0] * b[1] - a[1] * b[0])
        if abs(sine) < 0.03:
            return None
        inverse = np.array([(b[1], -a[1]), (-b[0], a[0])]) / sine
        return (offsets[k - 1 : k + 1] + radii[:, None]) @ inverse.T, radii
    s = min(k, len(normals) - 1)
    place = row[cuts[k]]
    return place + (offsets[s] + radii - normals[s] @ place)[:, None] * normals[s], radii


def _lines(one: tuple[Floats, Floats], two: tuple[Floats, Floats], lead: Floats) -> tuple[Floats, Floats, Bools]:
    """Return normals, offsets, and which are possible, of the other tangents between disks of two nodes."""
    (p, r), (q, w) = one, two
    away = q[None] - p[:, None]
    length = np.maximum(np.hypot(away[..., 0], away[..., 1]), 1e-12)
    ahead = away / length[..., None]
    slope = (w[None] - r[:, None]) / length
    left = np.stack([-ahead[..., 1], ahead[..., 0]], axis=-1)
    level = np.sqrt(np.maximum(1 - slope**2, 0.0))
    normal = -slope[..., None] * ahead + level[..., None] * left
    possible = (np.abs(slope) < STEEPEST) & (ahead @ np.array([lead[1], -lead[0]]) > 0)
    offset = (normal * p[:, None]).sum(axis=-1) + r[:, None]
    return normal, offset, possible


def _parallel(node: tuple[Floats, Floats], lead: Floats, before: bool) -> tuple[Floats, Floats, Bools]:
    """Return what ``_lines`` does for a side across an axis: parallel to the leading one, touching the disk of a node.

    ``before``: the side lies before that node; there is none at its other end.
    """
    middles, radii = node
    count = len(radii)
    offset = middles @ lead + radii
    offsets = np.tile(offset, (count, 1)) if before else np.tile(offset[:, None], (1, count))
    return np.broadcast_to(lead, (count, count, 2)), offsets, np.ones((count, count), dtype=bool)
