"""The cut check for graphs: what it has to refuse, before any pattern is made of a graph."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.cut_graphs import GRAPHS, shape_of
from support.paper import Point, square_paper

from foldcut.core.arrays import Floats, points_array
from foldcut.core.model import Finding, Shape
from foldcut.drawing.placement import Layout, parse_sheet
from foldcut.methods.skeleton.graphs import fold_graph
from foldcut.methods.skeleton.trial import Skeletal
from foldcut.proof.verify import verify


def lines(*drawn: list[Point]) -> Shape:
    return Shape((), (), tuple(points_array(line) for line in drawn))


def folded_square() -> tuple[object, object]:
    """Return a square of 100 mm folded in the middle, upwards."""
    return square_paper().fold((50, 0), (0, 1)).pattern()


def only(findings: list[Finding], words: str) -> Finding:
    assert {finding.check for finding in findings} == {"cut"}
    assert any(words in finding.message for finding in findings), findings
    return findings[0]


def test_a_sheet_may_be_cut_along_its_fold() -> None:
    pattern, layers = folded_square()
    assert verify(pattern, layers, lines([(50, 0), (50, 100)])) == []
    assert verify(pattern, layers, lines([(50, 0), (50, 30), (50, 100)])) == []
    assert verify(pattern, layers, lines([(50, 100), (50, 40)], [(50, 0), (50, 40)])) == []


def test_a_fold_on_the_cut_line_is_severed_where_no_line_is() -> None:
    pattern, layers = folded_square()
    for line in ([(50, 20), (50, 80)], [(50, 0), (50, 99)]):
        finding = only(verify(pattern, layers, lines(line)), "sever the paper")
        assert finding.size == 100


def test_lines_that_fold_away_from_the_cut_line_are_found() -> None:
    pattern, layers = folded_square()
    only(verify(pattern, layers, lines([(50, 0), (50, 100)], [(20, 20), (30, 30)])), "away from the cut line")
    only(verify(pattern, layers, lines([(50, 0), (50, 100)], [(40, 20), (40, 60)])), "away from the cut line")


def test_a_line_where_paper_lies_on_both_sides_of_the_cut_is_found() -> None:
    pattern, layers = folded_square()
    only(verify(pattern, layers, lines([(20, 0), (20, 100)], [(80, 0), (80, 100)])), "over the cut line")


def test_a_line_may_not_leave_the_sheet() -> None:
    pattern, layers = folded_square()
    only(verify(pattern, layers, lines([(50, 0), (50, 120)])), "over the sheet's border")


def test_a_crease_along_the_side_of_a_loop_is_refused_all_the_same() -> None:
    pattern, layers = folded_square()
    loop = points_array([(50, 0), (100, 0), (100, 100), (50, 100)])
    only(verify(pattern, layers, Shape((loop,), (-1,))), "lies on the shape's boundary")


@pytest.fixture(scope="module", params=["two slits", "bow tie", "tee", "triangle in three"])
def made(request: pytest.FixtureRequest) -> Skeletal:
    shape = shape_of(GRAPHS[request.param])
    return fold_graph(shape, Layout(parse_sheet("a4")).place(shape)[0], effort="fast")


def test_what_is_left_out_of_a_graph_is_found(made: Skeletal) -> None:
    shape = made.shape
    assert verify(made.creases, made.folded.layers, shape) == []
    for number in range(len(shape.lines)):
        fewer = replace(shape, lines=shape.lines[:number] + shape.lines[number + 1 :])
        assert verify(made.creases, made.folded.layers, fewer)
    for number in range(len(shape.loops)):
        loops, parents = (row[:number] + row[number + 1 :] for row in (shape.loops, shape.parent))
        assert verify(made.creases, made.folded.layers, replace(shape, loops=loops, parent=parents))


def test_what_is_added_to_a_graph_or_moved_is_found(made: Skeletal) -> None:
    shape, random = made.shape, np.random.default_rng(0)
    middle, half = shape.points.mean(axis=0), np.ptp(shape.points, axis=0) / 2

    def refused(other: Shape) -> bool:
        return {finding.check for finding in verify(made.creases, made.folded.layers, other)} == {"cut"}

    for _ in range(2):
        line: Floats = points_array(middle + (random.random((2, 2)) - 0.5) * half)
        assert refused(replace(shape, lines=(*shape.lines, line)))
        moved = np.array(shape.points)
        moved[random.integers(len(moved))] += random.random(2) + 0.01
        assert refused(shape.with_points(moved))


def test_a_line_that_is_taken_for_a_loop_and_a_loop_for_a_line_are_found(made: Skeletal) -> None:
    shape = made.shape
    as_lines = replace(shape, loops=(), parent=(), lines=shape.strokes)
    assert bool(verify(made.creases, made.folded.layers, as_lines)) == bool(shape.loops)
