"""The finished pattern: what is left out where nothing turns, and what stays."""

from __future__ import annotations

import numpy as np

from foldcut.core.model import CreasePattern
from foldcut.pattern.assemble import assemble, creases_of_stack

# a square sheet whose sides have a vertex in their middles, folded along a diagonal that has one, too
FLAT = np.array([(0, 0), (5, 0), (10, 0), (10, 5), (10, 10), (5, 10), (0, 10), (0, 5), (5, 5)], dtype=float)
FOLDED = np.where((FLAT[:, 1] > FLAT[:, 0])[:, None], FLAT[:, ::-1], FLAT)
STACK = [[0, 1, 2, 3, 4, 8], [0, 8, 4, 5, 6, 7]]
CORNERS = {0, 2, 4, 6}


def assembled(corners: set[int]) -> CreasePattern:
    edges, kinds = creases_of_stack(FOLDED, STACK)
    return assemble(FLAT, FOLDED, STACK, edges, kinds, corners)[0]


def test_the_sheets_corners_stay_with_a_crease_and_without_and_nothing_else_that_is_straight() -> None:
    creases = assembled(CORNERS)
    assert creases.vertices_coords.tolist() == [[0, 0], [10, 0], [10, 10], [0, 10]]
    pairs = {tuple(sorted(pair)) for pair in creases.edges_vertices.tolist()}
    assert pairs == {(0, 1), (1, 2), (2, 3), (0, 3), (0, 2)}
    assert creases.edges_assignment.tolist().count("B") == 4
    assert [sorted(ring) for ring in creases.faces_vertices.to_lists()] == [[0, 1, 2], [0, 2, 3]]


def test_a_corner_that_is_not_named_is_left_out_like_any_vertex_of_two_edges() -> None:
    creases = assembled(CORNERS - {6})
    assert creases.vertices_coords.tolist() == [[0, 0], [10, 0], [10, 10]]
