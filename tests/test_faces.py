"""The finished crease pattern, from stacked facets."""

from __future__ import annotations

import numpy as np

from foldcut.faces import assemble
from foldcut.model import points_array


def test_the_sheet_keeps_its_corners_and_no_other_vertex_that_nothing_turns_at() -> None:
    # A square with a vertex in the middle of two sides; on one of them a valley ends that has one more, too.
    flat = points_array([(0, 0), (1, 0), (2, 0), (2, 2), (1, 2), (0, 2), (1, 1), (2, 1)])
    rings = [[0, 1, 6, 4, 5], [1, 2, 7, 3, 4, 6]]
    folded = points_array(np.column_stack([np.minimum(flat[:, 0], 2 - flat[:, 0]), flat[:, 1]]))
    border = [(0, 1), (1, 2), (2, 7), (7, 3), (3, 4), (4, 5), (5, 0)]
    edges, kinds = [*border, (1, 6), (6, 4)], [*"BBBBBBB", *"VV"]
    creases, state = assemble(flat, folded, rings, edges, kinds, {0, 2, 3, 5})
    assert creases.vertices_coords.tolist() == [[0, 0], [1, 0], [2, 0], [2, 2], [1, 2], [0, 2]]
    assert state.vertices_coords.tolist() == [[0, 0], [1, 0], [0, 0], [0, 2], [1, 2], [0, 2]]
    assert creases.faces_vertices.to_lists() == [[0, 1, 4, 5], [1, 2, 3, 4]]
    pairs = zip(map(sorted, creases.edges_vertices.tolist()), creases.edges_assignment.tolist(), strict=True)
    expected = [([0, 1], "B"), ([1, 2], "B"), ([2, 3], "B"), ([3, 4], "B"), ([4, 5], "B"), ([0, 5], "B"), ([1, 4], "V")]
    assert sorted(pairs) == sorted(expected)
