"""How the nodes of a straight skeleton move when the points of its graph are moved by little.

``StraightSkeleton`` -> ``NodeDerivatives``. A node is at the place x and time t where n . (x - p) = t for each of its
sides, with the side's normal n and its tail p. Three of these equations give x and t. Moving the side's ends by da and
db changes them to

    n . dx - dt = n . ((1 - u) da + u db),      u: how far along the side the node is, 0 at its tail and 1 at its head.

Two sides on one line have the same equation. Where three sides leave a node's place open for this reason, the arc
between two such sides is followed from where it starts: x - x0 = (t - t0) v with v = (n + n') / (1 + n . n').
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from foldcut.core.arrays import Floats, Indices, sealed
from foldcut.geometry.straight_skeleton.graph import Graph
from foldcut.geometry.straight_skeleton.skeleton import StraightSkeleton
from foldcut.geometry.vectors import left_normal

__all__ = ["NodeDerivatives", "node_derivatives"]

FLAT = 1e-4
"""Three sides whose normals span a triangle with less than half this area may leave a place open."""


@dataclass(frozen=True, eq=False)
class NodeDerivatives:
    """The derivatives of the nodes' places and times by the places of the graph's points.

    A list of small matrices, which are to be added where a node and a point are in it several times; all others are
    zero. ``node``, ``point`` ``(e,)``; ``matrix`` ``(e, 3, 2)``: the derivatives of the node's (x, y, time) by the
    point's (x, y). ``node_count`` and ``point_count``: how many there are in all.
    """

    node: Indices
    point: Indices
    matrix: Floats
    node_count: int
    point_count: int

    def dense(self) -> Floats:
        """Return all derivatives as one array ``(k, 3, n, 2)``: of node i's (x, y, time) by point j's (x, y)."""
        full = np.zeros((self.node_count, self.point_count, 3, 2))
        np.add.at(full, (self.node, self.point), self.matrix)
        return np.ascontiguousarray(full.transpose(0, 2, 1, 3))

    def changes(self, steps: ArrayLike) -> Floats:
        """Return how (x, y, time) of all nodes change, ``(k, 3)``, to first order, if the points move by ``(n, 2)``."""
        steps = np.asarray(steps, dtype=np.float64).reshape(self.point_count, 2)
        changes = np.zeros((self.node_count, 3))
        np.add.at(changes, self.node, np.einsum("eij,ej->ei", self.matrix, steps[self.point]))
        return changes

    def gradient(self, by_node: ArrayLike) -> Floats:
        """Return the gradient of a function by the points ``(n, 2)``, given its gradient by the nodes ``(k, 3)``.

        The function depends on the (x, y, time) of all nodes; the graph's points are the first n of these.
        """
        by_node = np.asarray(by_node, dtype=np.float64).reshape(self.node_count, 3)
        gradient = np.zeros((self.point_count, 2))
        np.add.at(gradient, self.point, np.einsum("eij,ei->ej", self.matrix, by_node[self.node]))
        return gradient


def node_derivatives(skeleton: StraightSkeleton) -> NodeDerivatives:
    """Return the derivatives of all nodes, which hold as long as no arc appears or vanishes.

    The derivatives of a node of four or more sides hold for those movements that keep it together; they are those of
    the place where three of its sides meet. Raises ``ArithmeticError`` for a node that its sides do not determine.
    Source: the equations above, as in Aichholzer and Aurenhammer, "Straight Skeletons for General Polygonal Figures",
    1996, section 2: a node is where the wavefront's lines of its sides meet.
    """
    graph = skeleton.graph
    count, points = len(skeleton.nodes), len(graph.points)
    three, area = _three_sides(skeleton)
    good = np.flatnonzero(area > FLAT) + points
    normal = left_normal(graph.side_along)
    own = np.arange(points)
    sides = three[good - points]
    inverse = np.linalg.inv(np.concatenate([normal[sides], np.full((*sides.shape, 1), -1.0)], axis=2))
    by_tail, by_head = _right_sides(graph, sides, skeleton.nodes[good, None])
    matrix = np.concatenate([np.einsum("kis,ksj->ksij", inverse, by) for by in (by_tail, by_head)], axis=1)
    source = graph.source[sides]
    at = np.concatenate([graph.tail[source], graph.head[source]], axis=1)
    identity = np.broadcast_to(np.eye(3, 2), (points, 3, 2))
    node = np.concatenate([own, np.repeat(good, 6)])
    point = np.concatenate([own, at.ravel()])
    found = np.concatenate([identity, matrix.reshape(-1, 3, 2)])
    if len(good) + points < count:
        node, point, found = _along_arcs(skeleton, np.flatnonzero(area <= FLAT) + points, node, point, found)
    return NodeDerivatives(sealed(node), sealed(point), sealed(found), count, points)


def _three_sides(skeleton: StraightSkeleton) -> tuple[Indices, Floats]:
    """Return for each node that is no point three of its sides, ``(k - n, 3)``, and the area that their normals span.

    The first, the one whose normal is farthest from that, and the one whose normal is farthest from both.
    """
    graph, sides_of = skeleton.graph, skeleton.sides_of_nodes
    points, count = len(graph.points), len(skeleton.nodes)
    normal = left_normal(graph.side_along)
    three = np.empty((count - points, 3), dtype=np.intp)
    lengths = np.diff(sides_of.offsets)[points:]
    first = sides_of.offsets[points:-1]
    simple = lengths == 3
    three[simple] = sides_of.values[first[simple, None] + np.arange(3)]
    for k in np.flatnonzero(~simple).tolist():
        sides = sides_of[points + k]
        a = normal[sides[0]]
        to = normal[sides] - a
        second = int(np.argmax((to * to).sum(axis=1)))
        third = int(np.argmax(np.abs(to[:, 0] * to[second, 1] - to[:, 1] * to[second, 0])))
        three[k] = sides[[0, second, third]]
    a, b, c = normal[three.T]
    area = np.abs((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]))
    return three, area


def _right_sides(graph: Graph, sides: Indices, places: Floats) -> tuple[Floats, Floats]:
    """Return by what to multiply the movements of a side's tail and head in its equation at a place, ``(..., 2)`` each.

    A cap's normal is its source's direction d, and turns with it: n . dx - dt = d . db - w m . (db - da), where m is
    the source's normal and w how far the node is to its left, in lengths of the source.
    """
    source = graph.source[sides]
    tail, head = graph.points[graph.tail[source]], graph.points[graph.head[source]]
    length = np.sqrt(((head - tail) ** 2).sum(axis=-1))[..., None]
    along = (head - tail) / length
    across = np.stack([-along[..., 1], along[..., 0]], axis=-1)
    u = (along * (places - tail)).sum(axis=-1)[..., None] / length
    w = (across * (places - tail)).sum(axis=-1)[..., None] / length
    is_cap = (source != sides)[..., None]
    by_tail = np.where(is_cap, w, 1 - u) * across
    by_head = np.where(is_cap, along - w * across, u * across)
    return by_tail, by_head


def _along_arcs(
    skeleton: StraightSkeleton, nodes: Indices, node: Indices, point: Indices, matrix: Floats
) -> tuple[Indices, Indices, Floats]:
    """Add the derivatives of nodes at which arcs between sides of one direction end, the earliest first."""
    graph = skeleton.graph
    normal = left_normal(graph.side_along)
    known: dict[int, dict[int, Floats]] = {}
    by_node = np.argsort(node, kind="stable")
    starts = np.searchsorted(node[by_node], np.arange(len(skeleton.nodes) + 1))
    more: list[tuple[int, int, Floats]] = []
    dot = (normal[skeleton.arc_sides[:, 0]] * normal[skeleton.arc_sides[:, 1]]).sum(axis=1)
    for k in nodes[np.argsort(skeleton.time[nodes], kind="stable")].tolist():
        arcs = np.flatnonzero(skeleton.arcs[:, 1] == k)
        if not len(arcs) or dot[arc := arcs[np.argmax(dot[arcs])]] <= 0:
            x, y = skeleton.nodes[k]
            raise ArithmeticError(f"the sides of the node at ({x:.6g}, {y:.6g}) do not determine its place")
        start, pair = int(skeleton.arcs[arc, 0]), skeleton.arc_sides[arc]
        velocity = normal[pair].sum(axis=0) / (1 + dot[arc])
        sides = skeleton.node_sides(k)
        side = int(sides[np.argmax(np.abs(normal[sides] @ velocity - 1))])
        inverse = np.linalg.inv([[1, 0, -velocity[0]], [0, 1, -velocity[1]], [*normal[side], -1]])
        parts: dict[int, Floats] = {}

        def add(at: int, rows: Floats, parts: dict[int, Floats] = parts, inverse: Floats = inverse) -> None:
            parts[at] = parts.get(at, np.zeros((3, 2))) + inverse[:, : len(rows)] @ rows

        before = known.get(start)
        if before is None:
            before = {}
            for entry in by_node[starts[start] : starts[start + 1]].tolist():
                at = int(point[entry])
                before[at] = before.get(at, np.zeros((3, 2))) + matrix[entry]
        for at, by in before.items():
            add(at, by[:2] - velocity[:, None] * by[2])
        late = skeleton.time[k] - skeleton.time[start]
        for one, other in (pair, pair[::-1]):
            source = graph.source[one]
            tail, head = int(graph.tail[source]), int(graph.head[source])
            ends = graph.points[head] - graph.points[tail]
            # a step of its head turns the normal n of side ``one`` by turn @ step
            turn = -np.outer(graph.side_along[one], normal[source]) / np.sqrt(ends @ ends)
            change = late * (turn - np.outer(velocity, normal[other] @ turn)) / (1 + dot[arc])
            add(head, change)
            add(tail, -change)
        source = int(graph.source[side])
        for at, by in zip(
            (graph.tail[source], graph.head[source]),
            _right_sides(graph, np.array(side), skeleton.nodes[k]),
            strict=True,
        ):
            add(int(at), np.stack([np.zeros(2), np.zeros(2), by]))
        known[k] = parts
        more += [(k, at, by) for at, by in parts.items()]
    return (
        np.concatenate([node, [entry[0] for entry in more]]),
        np.concatenate([point, [entry[1] for entry in more]]),
        np.concatenate([matrix, [entry[2] for entry in more]]),
    )
