"""Lines as a graph: divided where they meet, joined where they nearly do; which faces go to which side."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import pytest
import shapely
from support.cut_graphs import GRAPHS, TANGRAM, chessboard, lines, random_lines, square

from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import ShapeError
from foldcut.core.model import Shape
from foldcut.drawing import graph as graphs
from foldcut.drawing.graph import CutGraph, edges_of, make_graph, shape_of_parts, shapes_of


def counts(drawn: Sequence[Floats]) -> tuple[int, int, int]:
    """Return the numbers of points, edges and faces of lines."""
    found = make_graph((), drawn)
    return len(found.graph.points), len(found.graph.edges), found.face_count


def test_lines_are_divided_where_they_cross_meet_and_lie_on_each_other() -> None:
    assert counts(lines([(0, 0), (4, 4)], [(0, 4), (4, 0)])) == (5, 4, 1)
    assert counts(lines([(0, 0), (4, 0)], [(2, 0), (2, 3)])) == (4, 3, 1)
    assert counts(lines([(0, 0), (4, 0)], [(2, 0), (6, 0)])) == (2, 1, 1)
    assert counts([square(0, 0, 4), square(4, 1, 2)]) == (8, 9, 3)
    assert counts(lines([(0, 0), (1, 0), (2, 0), (2, 2)])) == (3, 2, 1)
    assert counts(chessboard(3)) == (16, 24, 10)
    assert counts(TANGRAM)[2] == 8


def test_ends_that_nearly_meet_are_joined_and_it_is_told_how_far() -> None:
    nearly = lines([(0, 0), (100, 0)], [(100.01, 0.01), (50, 80)], [(50, 79.99), (0.01, 0)])
    found = make_graph((), nearly)
    assert (len(found.graph.points), found.face_count) == (3, 2)
    assert 0 < found.moved < 0.02
    assert make_graph((), nearly, join=1e-6).face_count == 1


@pytest.mark.parametrize(
    ("drawn", "words"),
    [
        (lines([(1, 1), (1, 1)]), "draw at least one line, or join ends that are nearer"),
        (lines([(0, 0), (float("inf"), 1)]), "finite coordinates"),
        ([], "draw at least one line"),
        (lines([(0, 0), (50, 0)], [(0, 0), (100, 0.01)]), "two lines leave (0, 0) with 0.0057 degrees between them"),
    ],
)
def test_what_is_no_graph_is_refused_with_the_place(drawn: Sequence[Floats], words: str) -> None:
    with pytest.raises(ShapeError, match=re.escape(words)):
        make_graph((), drawn, join=1e-6)


@pytest.mark.parametrize("seed", range(12))
def test_loops_and_lines_of_every_choice_are_the_graph_and_keep_their_sides(seed: int) -> None:
    found = make_graph((), random_lines(seed))
    whole = shapely.union_all(shapely.linestrings(found.graph.points[found.graph.edges]))
    for shape in list(found.shapes())[:20]:
        drawn = shapely.union_all([shapely.linestrings(stroke) for stroke in shape.strokes])
        assert shapely.symmetric_difference(whole, drawn).length < 1e-9
        assert sum(shapely.length(shapely.linestrings(stroke)) for stroke in shape.strokes) == pytest.approx(
            whole.length
        )
        assert all(shapely.Polygon(loop).is_valid and shapely.Polygon(loop).exterior.is_ccw for loop in shape.loops)
        again = shape_of_parts(shape.loops, shape.lines)
        assert (again.parent, again.touching) == (shape.parent, shape.touching)
        assert len(edges_of(shape).edges) == len(found.graph.edges)


def test_many_faces_get_sides_by_a_program_as_few_do_by_trying_all(monkeypatch: pytest.MonkeyPatch) -> None:
    def folded(shape: Shape) -> int:
        return sum(len(line) - 1 for line in shape.lines)

    for drawn in (TANGRAM, GRAPHS["triangle in three"]):
        found = make_graph((), drawn)
        first = [next(found.shapes())]
        monkeypatch.setattr(graphs, "FEW_FACES", 1)
        first.append(next(found.shapes()))
        monkeypatch.undo()
        assert folded(first[0]) == folded(first[1])


def test_a_loop_that_touches_the_loop_around_it_is_a_hole() -> None:
    around, hole = square(0, 0, 4)[:-1], points_array([(0, 0), (2, 1), (1, 2)])
    shape = shapes_of([around, hole])[0]
    assert sorted(shape.parent) == [-1, 0] or sorted(shape.parent) == [-1, 1]
    assert shape.touching
    assert not shape.lines


def test_loops_that_lie_apart_stay_loops() -> None:
    (shape,) = shapes_of([square(0, 0)[:-1], square(2, 0)[:-1]])
    assert not shape.is_graph


def test_simplified_lines_keep_where_they_meet() -> None:
    turns = np.linspace(0, np.pi, 40)
    arc = points_array(np.column_stack([50 * np.cos(turns), 50 * np.sin(turns)]))
    found = make_graph((), [arc, *lines([(0, 0), (0, 50)])])
    coarse = found.simplified(2.0)
    assert 4 < len(coarse.graph.edges) < 12 < len(found.graph.edges)
    for place in ((50, 0), (-50, 0), (0, 0)):
        assert (np.hypot(*(coarse.graph.points - place).T) < 1e-9).any()
    line = shapely.union_all(shapely.linestrings(coarse.graph.points[coarse.graph.edges]))
    assert shapely.distance(line, shapely.points(arc)).max() <= 2.0


def web(spokes: int, digits: int) -> list[Floats]:
    turns = 2 * np.pi * np.arange(spokes) / spokes
    ring = np.column_stack([np.cos(turns), np.sin(turns)])
    outlines = [np.round(radius * np.concatenate([ring, ring[:1]]), digits) for radius in (20, 40)]
    return [*map(points_array, outlines), *(points_array([(0, 0), corner]) for corner in outlines[1][:-1])]


def test_rounded_drawings_are_made_exactly_symmetric() -> None:
    rounded, exact = (make_graph((), web(7, digits)) for digits in (2, 15))
    made = rounded.symmetric(0.02)
    assert np.abs(rounded.graph.points - exact.graph.points).max() > 1e-3
    assert np.abs(made.graph.points - rounded.graph.points).max() < 0.01
    angle = 2 * np.pi / 7
    turn = np.array([(np.cos(angle), np.sin(angle)), (-np.sin(angle), np.cos(angle))])
    centred = made.graph.points - made.graph.points.mean(axis=0)
    away = np.hypot(*((centred @ turn)[:, None] - centred[None]).transpose(2, 0, 1)).min(axis=1)
    assert away.max() < 1e-12
    assert rounded.symmetric(1e-6) is rounded  # no more than is allowed
    lopsided = make_graph((), [*web(7, 2), *lines([(50, 3), (60, 8)])])
    assert lopsided.symmetric(0.02) is lopsided


def test_a_mirrored_graph_is_mirrored() -> None:
    found = CutGraph.of(next(make_graph((), lines([(0, 0), (3, 1)])).shapes()))
    assert np.array_equal(found.mirrored().graph.points, found.graph.points * (-1.0, 1.0))
