"""Patterns of graphs: verified, and the pieces of the cut are the sheet divided by the graph, by a second opinion."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
import shapely
from oracles.cut_pieces import pieces_of_cut, pieces_of_sheet
from support.cut_graphs import GRAPHS, TANGRAM, Lines, random_lines, shape_of
from support.single_vertex import folds_flat

import foldcut
from foldcut.core.arrays import points_array
from foldcut.core.errors import BadInputError, UnfoldableError
from foldcut.core.model import Sheet
from foldcut.drawing.graph import CutGraph
from foldcut.drawing.mend import Preparation
from foldcut.drawing.placement import Layout, parse_sheet
from foldcut.methods.skeleton.graphs import fold_graph
from foldcut.methods.skeleton.trial import Skeletal
from foldcut.pattern.cut_line import pieces_of
from foldcut.proof.verify import verify
from foldcut.readers import Drawing


def sheet_of(drawn: Lines) -> Sheet:
    return Layout(parse_sheet("a4")).place(shape_of(drawn))[0]


def folded(drawn: Lines) -> Skeletal:
    return fold_graph(shape_of(drawn), sheet_of(drawn), effort="fast")


def assert_pieces(made: Skeletal, sheet: Sheet) -> None:
    """The cut leaves just the pieces of the sheet divided by the lines: as many, and each where it should be."""
    assert verify(made.creases, made.folded.layers, made.shape) == []
    found = pieces_of_cut(made.creases, made.folded.vertices_coords[:, 1].tolist())
    wanted = pieces_of_sheet(shapely.box(0, 0, sheet.width, sheet.height), made.shape)
    assert len(found) == len(wanted)
    by_area = [sorted(pieces, key=lambda piece: (round(piece.area, 3), piece.bounds)) for pieces in (found, wanted)]
    for piece in by_area[1]:
        assert min(shapely.symmetric_difference(piece, other).area for other in by_area[0]) < 0.01


@pytest.mark.parametrize("name", GRAPHS)
def test_graphs_are_folded_and_the_cut_leaves_their_pieces(name: str) -> None:
    assert_pieces(folded(GRAPHS[name]), sheet_of(GRAPHS[name]))


@pytest.mark.parametrize("seed", range(4))
def test_random_graphs_are_folded_and_the_cut_leaves_their_pieces(seed: int) -> None:
    drawn = random_lines(seed)
    assert_pieces(folded(drawn), sheet_of(drawn))


def test_the_second_opinion_sees_a_cut_beside_the_graph() -> None:
    made, sheet = folded(GRAPHS["tee"]), sheet_of(GRAPHS["tee"])
    beside = (made.folded.vertices_coords[:, 1] + 1.0).tolist()
    wanted = pieces_of_sheet(shapely.box(0, 0, sheet.width, sheet.height), made.shape)
    assert len(pieces_of_cut(made.creases, beside)) != len(wanted)


def test_a_tangram_has_seven_pieces() -> None:
    result = foldcut.fold(Drawing((), None, "tangram", lines=tuple(TANGRAM)), effort="fast")
    assert result.verified
    assert len(pieces_of(result.folded_pattern.shape, result.folded_pattern.sheet)) == 8  # and what is around them
    assert_pieces(
        Skeletal(
            result.folded_pattern.shape,
            0.0,
            0,
            result.folded_pattern.creases,
            result.folded_pattern.folded,
            result.folded_pattern.creases,
        ),
        result.folded_pattern.sheet,
    )


def test_figures_that_touch_in_corners_are_folded_without_creases_on_the_cut() -> None:
    loops = [drawn[:-1] for drawn in GRAPHS["bow tie"]]
    result = foldcut.fold(loops)
    assert result.verified
    assert result.folded_pattern.shape.touching
    assert not result.folded_pattern.shape.lines


def test_methods_for_loops_refuse_graphs() -> None:
    loops = [drawn[:-1] for drawn in GRAPHS["bow tie"]]
    with pytest.raises(BadInputError, match="give --method skeleton"):
        foldcut.fold(loops, method="compact")
    with pytest.raises(BadInputError, match="--corners is for closed outlines"):
        foldcut.fold(loops, preparation=Preparation(corners=5))


def test_what_cannot_be_folded_is_refused_with_a_reason() -> None:
    many = [points_array(GRAPHS["zigzag"][0] + np.array([3.0 * k, 0.1 * k])) for k in range(40)]
    with pytest.raises(UnfoldableError, match="takes at most 120"):
        folded(many)


# One vertex, by brute force. Sectors between the edges of a graph fold along their bisectors; edges are creases too
# where both of their sides go to the same side of the cut line.


@pytest.mark.parametrize("wedges", [(360.0,), (150.0, 210.0), (100.0, 120.0, 140.0), (70.0, 110.0, 80.0, 100.0)])
def test_every_vertex_of_a_graph_folds_flat_whatever_side_its_faces_go_to(wedges: tuple[float, ...]) -> None:
    count = len(wedges)
    for sides in ((1, *others) for others in product((1, -1), repeat=count - 1)):
        creases = [(sum(wedges[:k]) + wedges[k] / 2) for k in range(count)]
        creases += [sum(wedges[:k]) for k in range(count) if sides[k] == sides[k - 1]]
        if count == 1:  # a dead end: its square end has two ridges, and a perpendicular goes straight on
            creases = [0.0, 135.0, 180.0, 225.0]
        creases.sort()
        sectors = [float(b - a) for a, b in zip(creases, [*creases[1:], creases[0] + 360], strict=True)]
        assert len(sectors) % 2 == 0
        if len(sectors) > 6:
            continue  # too many orders for brute force
        assert np.isclose(sum(sectors[::2]), 180.0)
        assert any(folds_flat(sectors, kinds) for kinds in product("MV", repeat=len(sectors)))


def test_choices_of_sides_begin_with_the_fewest_folded_edges_on_one_side_of_the_line() -> None:
    graph = CutGraph.of(shape_of(GRAPHS["triangle in three"]))
    shapes = list(graph.shapes())
    folds = [sum(len(line) - 1 for line in shape.lines) for shape in shapes]
    assert folds[0] == 3  # all on one side; two would be enough on both
    assert min(folds) == 2
    for shape in shapes:
        assert sum(map(len, shape.loops)) + sum(len(line) - 1 for line in shape.lines) == 6
