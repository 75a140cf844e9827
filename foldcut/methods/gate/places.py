"""The corners and sides of all molecules of a shape with several loops, labelled by loop and ring.

A *place* is a corner of a molecule together with the side after it, numbered as in ``Molecules.corners.values``. The
vertices on a loop, and the disks' centres on a ring, count as one *node* of the corner tree T_C each.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldcut.core.arrays import Bools, Ints, Numbers
from foldcut.methods.disks.layers import facets_at_places
from foldcut.methods.disks.molecules import Kind, Molecules
from foldcut.methods.disks.trees import opposite_sides

__all__ = ["Places", "is_ring", "loop_node", "ring_node"]

RINGS = 1_000_000
"""The nodes of rings are below those of loops by this much, so there may be half as many loops."""


def loop_node(loop: int) -> int:
    """Return the node that stands for a loop."""
    return -1 - loop


def ring_node(loop: int) -> int:
    """Return the node that stands for the ring around a loop."""
    return loop - RINGS


def is_ring(nodes: Ints | int) -> Bools:
    """Tell which nodes stand for rings."""
    return np.asarray(nodes <= -RINGS // 2)


@dataclass(frozen=True, eq=False)
class Places:
    """Labels of places and vertices.

    By place: ``row``, its molecule; ``part``, the part of the plane that the molecule lies in; ``corner``, ``foot`` and
    ``next_corner``, the vertices at the corner, at the side's tangency point and at the side's end; ``following``, the
    next place around the molecule; ``opposite``, the place of the same side in the molecule across it, or -1;
    ``first_facet`` and ``facet_count``, the facets at the corner.

    By vertex: ``partner``, the vertex across the ribbon, or itself; ``node``, its node of T_C, negative on loops and
    rings; ``loop_of_foot`` and ``ring_of_foot``, the loop or ring whose side has this tangency point, or -1;
    ``barrier``, whether either is set.

    ``ring_vertices``: by loop, the vertices at the centres of its ring's disks.
    """

    molecules: Molecules
    ring_vertices: dict[int, list[int]]
    row: Ints
    part: Ints
    corner: Ints
    foot: Ints
    next_corner: Ints
    following: Numbers
    opposite: Numbers
    first_facet: Numbers
    facet_count: Numbers
    partner: Ints
    node: Ints
    loop_of_foot: Ints
    ring_of_foot: Ints
    barrier: Bools

    @classmethod
    def of(cls, molecules: Molecules, ring_disks: dict[int, list[int]]) -> Places:
        """Label the places and vertices; ``ring_disks``: by loop, the disks of its ring."""
        corner, foot = molecules.corners.values, molecules.feet.values
        following = molecules.corners.following
        next_corner = corner[following]
        ring_vertices = {loop: molecules.disk_vertex[np.array(disks)].tolist() for loop, disks in ring_disks.items()}

        count = len(molecules.vertices)
        partner, node = np.arange(count, dtype=np.int32), np.arange(count, dtype=np.int32)
        across = molecules.creases[molecules.crease_kind == Kind.RIBBON]
        partner[across[:, 0]] = across[:, 1]
        loop_of_foot, ring_of_foot = np.full(count, -1, dtype=np.int32), np.full(count, -1, dtype=np.int32)
        side_start, side_foot, side_end, loop = molecules.boundary_sides.T
        for vertex in (side_start, side_end):
            node[vertex] = node[partner[vertex]] = -1 - loop  # loop_node of each
        loop_of_foot[side_foot] = loop_of_foot[partner[side_foot]] = loop
        for number, vertices in ring_vertices.items():
            node[vertices] = ring_node(number)
            on_ring = (node[corner] == ring_node(number)) & (node[next_corner] == ring_node(number))
            ring_of_foot[foot[on_ring]] = number
        first_facet, facet_count = facets_at_places(molecules)
        row = molecules.corners.rows
        return cls(
            molecules=molecules,
            ring_vertices=ring_vertices,
            row=row,
            part=molecules.face[row],
            corner=corner,
            foot=foot,
            next_corner=next_corner,
            following=following,
            opposite=opposite_sides(foot),
            first_facet=first_facet,
            facet_count=facet_count,
            partner=partner,
            node=node,
            loop_of_foot=loop_of_foot,
            ring_of_foot=ring_of_foot,
            barrier=(loop_of_foot >= 0) | (ring_of_foot >= 0),
        )

    @property
    def last_facet(self) -> Numbers:
        """The last facet at each place's corner."""
        return self.first_facet + self.facet_count - 1

    def beside(self, foot: int) -> list[int]:
        """Return the places on both sides of the side with this tangency point, also across the ribbon."""
        places = np.flatnonzero(self.foot == foot)
        if self.partner[foot] != foot:
            places = np.append(places, np.flatnonzero(self.foot == self.partner[foot]))
        return [int(place) for place in places]
