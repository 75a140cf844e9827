"""The creases and facets of each sort of molecule, with vertices numbered within the molecule (paper, Figures 2 to 4).

There are four sorts: the rabbit ear of a triangle, the quadrilateral whose perpendicular points coincide, and the
gusset with either diagonal.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from foldcut.core.arrays import Ints, index_array

__all__ = ["COINCIDENT", "GUSSET", "TEMPLATES", "TRIANGLE", "Kind", "Template"]


class Kind(IntEnum):
    """What a crease is in its molecule."""

    BISECTOR = 0  # from a corner, and the four sides of the gusset
    TANGENCY = 1  # from a side's tangency point, or the diagonal's midpoint, to the centre of a part
    DIAGONAL = 2  # the halves of a gusset's diagonal
    SIDE = 3  # the halves of a molecule's side
    RIBBON = 4  # across the ribbon, at a corner or at a tangency point


@dataclass(frozen=True)
class Template:
    """The creases and facets of one sort of molecule.

    Vertices are numbered within the molecule: its corners come first, then the feet, then the inner vertices.
    ``creases`` ``(c, 5)``: two vertices, kind, part and side; only tangency edges have a part and a side, else -1;
    ``facets``: the vertices of each, and its corner; ``side_part``: the part behind each side; ``inner``: the
    number of inner vertices.
    """

    creases: Ints
    facets: tuple[tuple[tuple[int, ...], int], ...]
    side_part: tuple[int, ...]
    inner: int

    @classmethod
    def make(
        cls,
        corners: int,
        inner: list[tuple[int, int, Kind, int, int]],
        facets: list[tuple[list[int], int]],
        side_part: list[int],
        own: int,
    ) -> Template:
        """Return the template with these inner creases and facets, and the creases of the sides before them."""
        sides = []
        for k in range(corners):
            sides += [(k, corners + k, Kind.SIDE, -1, -1), (corners + k, (k + 1) % corners, Kind.SIDE, -1, -1)]
        rows = index_array(np.array([*sides, *inner], dtype=np.int32))
        return cls(rows, tuple((tuple(outline), corner) for outline, corner in facets), tuple(side_part), own)


def _ear_template(corners: int) -> Template:
    """Return the molecule whose creases meet in one point: the rabbit ear, or coincident perpendicular points."""
    apex = 2 * corners
    inner: list[tuple[int, int, Kind, int, int]] = []
    facets: list[tuple[list[int], int]] = []
    for k in range(corners):
        foot = corners + k
        inner += [(k, apex, Kind.BISECTOR, -1, -1), (foot, apex, Kind.TANGENCY, 0, k)]
        facets += [([corners + (k - 1) % corners, k, apex], k), ([k, foot, apex], k)]
    return Template.make(corners, inner, facets, [0] * corners, 1)


def _gusset_template(first: int) -> Template:
    r"""Return two rabbit ears on the inset quadrilateral, joined along its diagonal p - r.

    ::

          d --------- c        u, v: perpendicular points (centres of the parts a b c and c d a)
          | \   v   / |        p, r: corners of the inset quadrilateral, on the bisectors at a and c
          |  p--m--r  |        m: where the diagonal p r meets u v
          | /   u   \ |
          a --------- b
    """
    a, b, c, d = ((first + k) % 4 for k in range(4))
    u, v, m, p, r = range(8, 13)
    feet = [4, 5, 6, 7]
    parts = [0] * 4
    parts[c] = parts[d] = 1
    inner = [(start, end, Kind.BISECTOR, -1, -1) for start, end in ((a, p), (c, r), (b, u), (d, v))]
    inner += [(start, end, Kind.BISECTOR, -1, -1) for start, end in ((p, u), (p, v), (r, u), (r, v))]
    inner += [(p, m, Kind.DIAGONAL, -1, -1), (m, r, Kind.DIAGONAL, -1, -1)]
    inner += [(feet[side], (u, v)[part], Kind.TANGENCY, part, side) for side, part in enumerate(parts)]
    inner += [(m, u, Kind.TANGENCY, 0, 4), (m, v, Kind.TANGENCY, 1, 4)]
    around = {
        a: [[feet[d], a, p, v], [v, p, m], [m, p, u], [a, feet[a], u, p]],
        b: [[feet[a], b, u], [b, feet[b], u]],
        c: [[feet[b], c, r, u], [u, r, m], [m, r, v], [c, feet[c], v, r]],
        d: [[feet[c], d, v], [d, feet[d], v]],
    }
    return Template.make(4, inner, [(outline, corner) for corner in range(4) for outline in around[corner]], parts, 5)


TRIANGLE = 0
"""A triangle: the rabbit ear."""

COINCIDENT = 1
"""A quadrilateral whose perpendicular points coincide."""

GUSSET = 2
"""A gusset with the diagonal at corners 0 and 2; GUSSET + 1 has the one at corners 1 and 3."""

TEMPLATES = (_ear_template(3), _ear_template(4), _gusset_template(0), _gusset_template(1))
"""The template of each sort."""
