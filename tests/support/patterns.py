"""Hand-made folded patterns whose every number can be seen without computing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from foldcut.core.arrays import Ragged, index_array, points_array
from foldcut.core.model import CreasePattern, FoldedPattern, FoldedState, Placement, Shape, Sheet

Point = tuple[float, float]


def build_pattern(
    flat: Sequence[Point],
    folded: Sequence[Point],
    edges: Sequence[tuple[int, int, str]],
    faces: Sequence[Sequence[int]],
    layers: Sequence[int],
    loop: Sequence[Point] = ((20, 20), (40, 20), (40, 40), (20, 40)),
    title: str = "",
) -> FoldedPattern:
    """Return a pattern from plain lists; the sheet is the box from the origin to the largest coordinates."""
    width, height = (max(point[axis] for point in flat) for axis in (0, 1))
    creases = CreasePattern(
        vertices_coords=points_array(flat),
        edges_vertices=index_array([edge[:2] for edge in edges]),
        edges_assignment=np.array([edge[2] for edge in edges]),
        faces_vertices=Ragged.from_rows(faces),
    )
    return FoldedPattern(
        creases=creases,
        folded=FoldedState(points_array(folded), index_array(layers)),
        sheet=Sheet(width, height),
        shape=Shape((points_array(loop),), (-1,)),
        placement=Placement(np.array([(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)])),
        title=title,
    )


def book_fold(assignment: str = "V", title: str = "book") -> FoldedPattern:
    """Return a sheet of 100 x 60 mm folded along x = 50; a valley lays the right half on the left.

    ::

        5-----4-----3        face 0 is the left half, 0 1 4 5;
        |  0  |  1  |        face 1 the right half, 1 2 3 4
        0-----1-----2
    """
    return build_pattern(
        flat=[(0, 0), (50, 0), (100, 0), (100, 60), (50, 60), (0, 60)],
        folded=[(0, -30), (50, -30), (0, -30), (0, 30), (50, 30), (0, 30)],
        edges=[
            (0, 1, "B"),
            (1, 2, "B"),
            (2, 3, "B"),
            (3, 4, "B"),
            (4, 5, "B"),
            (5, 0, "B"),
            (1, 4, assignment),
        ],
        faces=[(0, 1, 4, 5), (1, 2, 3, 4)],
        layers=[0, 1] if assignment == "V" else [1, 0],
        title=title,
    )


def letter_fold() -> FoldedPattern:
    """Return a sheet of 90 x 50 mm in three: left third folded over the middle, right third over both.

    Bottom to top: the middle (face 0), the left third (face 1), the right third (face 2).
    """
    return build_pattern(
        flat=[(0, 0), (30, 0), (60, 0), (90, 0), (90, 50), (60, 50), (30, 50), (0, 50)],
        folded=[(60, -25), (30, -25), (60, -25), (30, -25), (30, 25), (60, 25), (30, 25), (60, 25)],
        edges=[
            *((a, b, "B") for a, b in [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 6), (6, 7), (7, 0)]),
            (1, 6, "V"),
            (2, 5, "V"),
        ],
        faces=[(1, 2, 5, 6), (0, 1, 6, 7), (2, 3, 4, 5)],
        layers=[0, 1, 2],
    )


def notched_sheet() -> FoldedPattern:
    """Return a flat sheet with a face like an L around another face: they touch and do not overlap."""
    flat = [(0.0, 0.0), (60.0, 0.0), (60.0, 30.0), (30.0, 30.0), (30.0, 60.0), (0.0, 60.0), (60.0, 60.0)]
    return build_pattern(
        flat=flat,
        folded=flat,
        edges=[
            *((a, b, "B") for a, b in [(0, 1), (1, 2), (2, 6), (6, 4), (4, 5), (5, 0)]),
            (2, 3, "F"),
            (3, 4, "F"),
        ],
        faces=[(0, 1, 2, 3, 4, 5), (3, 2, 6, 4)],
        layers=[0, 1],
    )


def square_out_of_square() -> FoldedPattern:
    r"""Return a sheet of 48 x 48 mm that one cut makes a square of 40 x 40 mm: eight creases in one point.

    All faces land on the triangle (0, 20), (0, -4), (24, -4), in layers as they stand around the centre.

    ::

        8--7--6
        |\ | /|
        2--0--5
        |/ | \|
        1--3--4
    """
    top, foot, far = (0, 20), (0, -4), (24, -4)
    ring = [1, 3, 4, 5, 6, 7, 8, 2]
    spokes = [(0, end, letter) for end, letter in zip(ring, "VMVMVMVV", strict=True)]
    rim = [(a, b, "B") for a, b in zip(ring, [*ring[1:], ring[0]], strict=True)]
    return build_pattern(
        flat=[(24, 24), (0, 0), (0, 24), (24, 0), (48, 0), (48, 24), (48, 48), (24, 48), (0, 48)],
        folded=[top, far, foot, foot, far, foot, far, foot, far],
        edges=[*spokes, *rim],
        faces=[(0, 2, 1), (0, 1, 3), (0, 3, 4), (0, 4, 5), (0, 5, 6), (0, 6, 7), (0, 7, 8), (0, 8, 2)],
        layers=range(8),
        loop=[(4, 4), (44, 4), (44, 44), (4, 44)],
        title="square",
    )
