"""Whether two straight skeletons of the same graph are the same but for the numbers of their nodes and arcs."""

from __future__ import annotations

from collections import Counter

import numpy as np

from foldcut.geometry.straight_skeleton import StraightSkeleton

NEAR = 1e-9
"""How far apart the same node may be in two skeletons: in parts of its distance from the graph and the graph's size."""


def differences(one: StraightSkeleton, other: StraightSkeleton, near: float = NEAR) -> list[str]:
    """Return what is different, in words; nothing if the skeletons are the same."""
    if any((one.graph.edges != other.graph.edges).flat) or any((one.graph.points != other.graph.points).flat):
        return ["the graphs are different"]
    found = []
    if one.face_nodes.offsets.tolist() != other.face_nodes.offsets.tolist():
        wrong = np.flatnonzero(np.diff(one.face_nodes.offsets) != np.diff(other.face_nodes.offsets))
        return [f"the faces of sides {wrong[:8].tolist()} have other numbers of nodes"]
    node, partner = one.face_nodes.values, other.face_nodes.values
    if ((node < 0) != (partner < 0)).any():
        return ["faces are open at other places"]
    both = set(zip(node.tolist(), partner.tolist(), strict=True))
    pairs = dict(both)
    if not len(both) == len(pairs) == len(set(pairs.values())):
        return ["faces share nodes that they do not share in the other"]
    size = float(np.ptp(one.graph.points, axis=0).max())
    off = np.hypot(*(one.nodes[node] - other.nodes[partner]).T) + np.abs(one.time[node] - other.time[partner])
    far = (off > near * (size + one.time[node])) & (node >= 0)
    found += [f"node {k} is off by {d:.3g}" for k, d in zip(node[far][:4].tolist(), off[far].tolist(), strict=False)]
    arcs, others = (
        Counter(
            arc if moves or arc[0] < arc[1] else (arc[1], arc[0], arc[3], arc[2])  # level arcs may be there either way
            for arc, moves in zip(
                [(number[start], number.get(end, -1), *sides) for (start, end), sides in rows],
                skeleton.arc_velocity.any(axis=1).tolist(),
                strict=True,
            )
        )
        for skeleton, number, rows in (
            (one, pairs, zip(one.arcs.tolist(), one.arc_sides.tolist(), strict=True)),
            (other, {k: k for k in partner.tolist()}, zip(other.arcs.tolist(), other.arc_sides.tolist(), strict=True)),
        )
    )
    found += [f"the arc {arc} is not in both" for arc in list((arcs - others) + (others - arcs))[:4]]
    return found
