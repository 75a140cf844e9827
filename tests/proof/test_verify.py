"""The verifier against known answers, brute force, a slow second opinion, and every mistake it must find."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import permutations, product

import numpy as np
import pytest
from oracles.slow_layers import slow_check
from support.paper import Paper, Point, box_shape, random_paper, rectangle_fold, square_paper
from support.single_vertex import folds_flat

from foldcut.core.arrays import Floats, Ints, Ragged, index_array, points_array
from foldcut.core.model import CreasePattern, Finding, Shape
from foldcut.geometry import box_tree as layertree
from foldcut.geometry.planar_graph import edge_faces, trace_faces
from foldcut.geometry.polygons import Outlines
from foldcut.pattern import face_maps as flatfold
from foldcut.pattern.cut_line import sides_of
from foldcut.pattern.face_maps import fold_faces
from foldcut.proof import cut as cutline
from foldcut.proof.cut import check_cut
from foldcut.proof.layers import check_mountains, check_stacking
from foldcut.proof.verify import CHECKS, verify
from foldcut.proof.vertices import check_vertices, is_flat_at_vertices

TINY = 1e-6


def make(
    points: Sequence[Point], edges: Sequence[tuple[int, int, str]], faces: Sequence[Sequence[int]]
) -> CreasePattern:
    return CreasePattern(
        points_array(points),
        index_array([edge[:2] for edge in edges]),
        np.array([edge[2] for edge in edges]),
        Ragged.from_rows(faces),
    )


def book(letter: str = "V") -> CreasePattern:
    """Return a sheet of 2 x 1 with a crease in the middle; face 0 is the left half.

    ::

        3-----4-----5
        |  0  |  1  |
        0-----1-----2
    """
    points = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (0.0, 1.0), (1.0, 1.0), (2.0, 1.0)]
    border = [(0, 1, "B"), (1, 2, "B"), (2, 5, "B"), (5, 4, "B"), (4, 3, "B"), (3, 0, "B")]
    return make(points, [*border, (1, 4, letter)], [[0, 1, 4, 3], [1, 2, 5, 4]])


def strip(letters: str) -> CreasePattern:
    """Return unit squares in a row, with creases of these letters between them."""
    count = len(letters) + 1
    points = [(float(x), float(y)) for x in range(count + 1) for y in (0, 1)]
    across = [(2 * x, 2 * x + 1, letter) for x, letter in enumerate(f"B{letters}B")]
    along = [(2 * x + y, 2 * x + 2 + y, "B") for x in range(count) for y in (0, 1)]
    return make(points, across + along, [[2 * x, 2 * x + 2, 2 * x + 3, 2 * x + 1] for x in range(count)])


def grid(columns: int, rows: int) -> CreasePattern:
    """Return unit squares in a grid; all creases are mountains until layers decide."""
    number = {(x, y): x * (rows + 1) + y for x in range(columns + 1) for y in range(rows + 1)}
    edges = [(number[x, y], number[x + 1, y], "BM"[0 < y < rows]) for x in range(columns) for y in range(rows + 1)]
    edges += [(number[x, y], number[x, y + 1], "BM"[0 < x < columns]) for x in range(columns + 1) for y in range(rows)]
    corners = ((0, 0), (1, 0), (1, 1), (0, 1))
    faces = [[number[x + dx, y + dy] for dx, dy in corners] for x in range(columns) for y in range(rows)]
    return make([(float(x), float(y)) for x, y in number], edges, faces)


def star_vertex(sectors: Sequence[float], letters: str) -> CreasePattern:
    """Return a vertex inside a polygon, with creases to its corners; crease i comes before sector i."""
    turn = np.radians(np.concatenate([[0], np.cumsum(sectors)[:-1]]))
    rim = [(float(np.cos(t)), float(np.sin(t))) for t in turn]
    count = len(sectors)
    edges = [(0, k + 1, letter) for k, letter in enumerate(letters)]
    edges += [(k + 1, (k + 1) % count + 1, "B") for k in range(count)]
    return make([(0.0, 0.0), *rim], edges, [[0, k + 1, (k + 1) % count + 1] for k in range(count)])


def with_creases_from(pattern: CreasePattern, layers: Ints) -> CreasePattern:
    """Return the pattern with the mountains and valleys that the layer order makes."""
    faces = edge_faces(pattern)
    maps = fold_faces(pattern, faces)
    rank = np.argsort(layers)
    upper = np.where(maps.up[faces[:, 0]], faces[:, 0], faces[:, 1])
    lower = np.where(maps.up[faces[:, 0]], faces[:, 1], faces[:, 0])
    kind = np.where(rank[lower] > rank[upper], "V", "M")
    folded = np.isin(pattern.edges_assignment, ("M", "V"))
    return replace(pattern, edges_assignment=np.where(folded, kind, pattern.edges_assignment))


def stack_findings(pattern: CreasePattern, layers: Sequence[int]) -> list[Finding]:
    """Return what keeps layers from lying in this order, with the mountains and valleys that it makes."""
    faces = edge_faces(pattern)
    return check_stacking(pattern, faces, fold_faces(pattern, faces), index_array(layers), 1e-8)


def kinds(findings: Sequence[Finding]) -> set[str]:
    return {finding.check for finding in findings}


def only(findings: Sequence[Finding], check: str, words: str) -> Finding:
    """Return the first finding, after asserting that all are of one check and that it contains ``words``."""
    assert check in CHECKS
    assert kinds(findings) == {check}, [str(finding) for finding in findings]
    assert words in findings[0].message
    return findings[0]


# What is valid


def test_a_valley_lays_the_right_half_on_top() -> None:
    assert verify(book("V"), index_array([0, 1])) == []
    assert kinds(verify(book("V"), index_array([1, 0]))) == {"mountain-valley"}


def test_a_mountain_lays_the_right_half_below() -> None:
    assert verify(book("M"), index_array([1, 0])) == []
    assert kinds(verify(book("M"), index_array([0, 1]))) == {"mountain-valley"}


@pytest.mark.parametrize("letter", ["F", "U"])
def test_an_edge_that_is_not_folded_leaves_the_sheet_flat(letter: str) -> None:
    assert verify(book(letter), index_array([0, 1])) == []


def test_an_accordion_folds_in_order() -> None:
    assert verify(strip("VMVMV"), index_array(range(6))) == []


def test_a_roll_folds_inside_out() -> None:
    paper = square_paper(8.0).fold((4, 0), (0, 1)).fold((2, 0), (0, 1))
    assert verify(*paper.pattern()) == []


@pytest.mark.parametrize(("count", "foldings"), [(2, 2), (3, 6), (4, 16), (5, 50), (6, 144)])
def test_a_strip_of_stamps_folds_in_as_many_ways_as_the_literature_says(count: int, foldings: int) -> None:
    # OEIS A000136.
    pattern = strip("M" * (count - 1))
    assert sum(not stack_findings(pattern, order) for order in permutations(range(count))) == foldings


@pytest.mark.parametrize(("columns", "rows", "foldings"), [(2, 2, 8), (3, 2, 60)])
def test_a_map_folds_in_as_many_ways_as_the_literature_says(columns: int, rows: int, foldings: int) -> None:
    # OEIS A001415.
    pattern = grid(columns, rows)
    assert sum(not stack_findings(pattern, order) for order in permutations(range(columns * rows))) == foldings


@pytest.mark.parametrize("seed", range(20))
def test_paper_folded_at_random_verifies(seed: int) -> None:
    rng = np.random.default_rng(seed)
    paper = random_paper(rng, folds=int(rng.integers(1, 7)), lines=int(rng.integers(3)))
    pattern, layers = paper.pattern(rng.permutation(len(paper.layers)))
    assert verify(pattern, layers) == []


def test_a_sheet_that_is_not_convex_may_have_reflex_faces() -> None:
    # An L, the fold across its foot: face 0 keeps the reflex corner.
    points = [(0.0, 0.0), (3.0, 0.0), (4.0, 0.0), (4.0, 1.0), (3.0, 1.0), (1.0, 1.0), (1.0, 4.0), (0.0, 4.0)]
    border = [(k, (k + 1) % 8, "B") for k in range(8)]
    pattern = make(points, [*border, (1, 4, "V")], [[0, 1, 4, 5, 6, 7], [1, 2, 3, 4]])
    assert verify(pattern, index_array([0, 1])) == []


# A vertex: Kawasaki and Maekawa are not enough

SIX = (35.0, 55.0, 95.0, 40.0, 50.0, 85.0)


@pytest.mark.parametrize("letters", ["MVMVVV", "MMMVMV", "MVMMVM", "VVMVMV", "VMVMMM"])
def test_the_layers_of_a_vertex_are_found_possible_exactly_when_brute_force_finds_an_order(
    letters: str,
) -> None:
    pattern = star_vertex(SIX, letters)
    assert only(verify(pattern, None), "layers", "no layer order")
    faces = edge_faces(pattern)
    maps = fold_faces(pattern, faces)
    orders = (index_array(order) for order in permutations(range(6)))
    fitting = [order for order in orders if not check_mountains(pattern, faces, maps, order)]
    found = any(not check_stacking(pattern, faces, maps, order, 1e-8) for order in fitting)
    assert found == folds_flat(SIX, letters)


def test_the_corner_of_the_paper_that_cannot_fold_is_rejected_in_every_order() -> None:
    assert not folds_flat(SIX, "MVMVVV")
    assert folds_flat(SIX, "MVMMVM")


@pytest.mark.parametrize("sectors", [(90.0, 90.0, 90.0, 90.0), (60.0, 80.0, 120.0, 100.0)])
def test_a_degree_four_vertex_agrees_with_brute_force(sectors: tuple[float, ...]) -> None:
    for letters in map("".join, product("MV", repeat=4)):
        pattern = star_vertex(sectors, letters)
        possible = any(not verify(pattern, index_array(order)) for order in permutations(range(4)))
        assert possible == (abs(letters.count("M") - 2) == 1 and folds_flat(sectors, letters))


# The second opinion

Mutation = Callable[[np.random.Generator, CreasePattern, Ints], tuple[CreasePattern, Ints]]


def nothing(_: np.random.Generator, pattern: CreasePattern, layers: Ints) -> tuple[CreasePattern, Ints]:
    return pattern, layers


def swapped(rng: np.random.Generator, pattern: CreasePattern, layers: Ints) -> tuple[CreasePattern, Ints]:
    order = layers.copy()
    one, two = rng.choice(len(order), 2, replace=False)
    order[[one, two]] = order[[two, one]]
    return pattern, order


def moved(rng: np.random.Generator, pattern: CreasePattern, layers: Ints) -> tuple[CreasePattern, Ints]:
    order = layers.tolist()
    order.insert(int(rng.integers(len(order))), order.pop(int(rng.integers(len(order)))))
    return pattern, index_array(order)


def shuffled(rng: np.random.Generator, pattern: CreasePattern, layers: Ints) -> tuple[CreasePattern, Ints]:
    return pattern, index_array(rng.permutation(layers))


def refolded(rng: np.random.Generator, pattern: CreasePattern, layers: Ints) -> tuple[CreasePattern, Ints]:
    pattern, order = moved(rng, pattern, layers)
    return with_creases_from(pattern, order), order


@pytest.mark.parametrize("mutation", [nothing, swapped, moved, shuffled, refolded])
@pytest.mark.parametrize("seed", range(int(os.environ.get("FOLDCUT_RANDOM_LAYERS", "12"))))
def test_the_slow_checker_comes_to_the_same_verdict(
    mutation: Mutation, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(seed)
    paper = random_paper(rng, folds=int(rng.integers(2, 5)), lines=int(rng.integers(3)))
    pattern, layers = mutation(rng, *paper.pattern(rng.permutation(len(paper.layers))))
    faces = edge_faces(pattern)
    maps = fold_faces(pattern, faces)
    quick = check_mountains(pattern, faces, maps, layers) + check_stacking(pattern, faces, maps, layers, 1e-8)
    verdict = slow_check(pattern, layers)
    assert kinds(quick) == verdict
    monkeypatch.setattr(layertree, "MANY_BOXES", 0)  # by compiled code, where numba is
    monkeypatch.setattr(flatfold, "MANY_FACES", 0)
    maps = fold_faces(pattern, faces)
    assert kinds(check_stacking(pattern, faces, maps, layers, 1e-8)) == verdict - {"mountain-valley"}


# Every check can fail


def test_arrays_that_make_no_sense_are_found() -> None:
    good = book()
    layers = index_array([0, 1])
    nowhere = good.vertices_coords.copy()
    nowhere[2, 0] = np.nan
    only(verify(replace(good, vertices_coords=nowhere), layers), "arrays", "vertex 2 is not at a finite place")
    edges = good.edges_vertices.copy()
    edges[3, 1] = 17
    only(
        verify(replace(good, edges_vertices=edges), layers),
        "arrays",
        "edges_vertices names vertex 17; there are 6",
    )
    faces = Ragged.from_rows([[0, 1, 4, 3], [1, 2, -1]])
    only(verify(replace(good, faces_vertices=faces), layers), "arrays", "faces_vertices names vertex -1")
    faces = Ragged.from_rows([[0, 1, 4, 3], [1, 2]])
    only(verify(replace(good, faces_vertices=faces), layers), "arrays", "face 1 has 2 vertices")
    only(verify(book("C"), layers), "arrays", "edge 6 is assigned 'C'")
    short = replace(good, edges_assignment=good.edges_assignment[:-1])
    only(verify(short, layers), "arrays", "6 assignments for 7 edges")
    only(verify(make([(0, 0)], [(0, 0, "B")], []), layers), "arrays", "no faces")


def test_crossing_creases_are_found_where_they_cross() -> None:
    points = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    border = [(k, (k + 1) % 4, "B") for k in range(4)]
    pattern = make(points, [*border, (0, 2, "V"), (1, 3, "M")], [[0, 1, 2], [0, 2, 3]])
    findings = verify(pattern, index_array([0, 1]))
    crossing = next(finding for finding in findings if "cross" in finding.message)
    assert kinds(findings) == {"planar"}
    assert crossing.place == pytest.approx((0.5, 0.5))


def test_a_vertex_on_the_middle_of_an_edge_is_found() -> None:
    points = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (1.0, 0.0), (1.0, 2.0)]
    edges = [(0, 1, "B"), (1, 2, "B"), (2, 5, "B"), (5, 3, "B"), (3, 0, "B"), (4, 5, "V")]
    findings = verify(make(points, edges, [[0, 4, 5, 3], [4, 1, 2, 5]]), index_array([0, 1]))
    on_edge = next(finding for finding in findings if "lies on edge" in finding.message)
    assert on_edge.place == (1.0, 0.0)


def test_edges_without_length_and_repeated_edges_are_found() -> None:
    good = book()
    points = good.vertices_coords.copy()
    points[4] = points[1]
    findings = verify(replace(good, vertices_coords=points), index_array([0, 1]))
    assert only(findings, "planar", "edge 6 is only 0 mm long").place == (1.0, 0.0)
    twice = make(
        good.vertices_coords.tolist(),
        [*zip(*good.edges_vertices.T.tolist(), good.edges_assignment.tolist(), strict=True), (4, 1, "V")],
        good.faces_vertices.to_lists(),
    )
    assert only(verify(twice, index_array([0, 1])), "planar", "edge 7 repeats").place == (1.0, 0.5)


def test_a_vertex_on_no_edge_is_found() -> None:
    good = book()
    points = np.vstack([good.vertices_coords, [(0.5, 0.5)]])
    findings = verify(replace(good, vertices_coords=points), index_array([0, 1]))
    assert only(findings, "planar", "vertex 6 is on no edge").place == (0.5, 0.5)


def test_faces_that_are_not_simple_or_run_clockwise_are_found() -> None:
    twisted = replace(book(), faces_vertices=Ragged.from_rows([[0, 1, 3, 4], [1, 2, 5, 4]]))
    assert only(verify(twisted, index_array([0, 1])), "planar", "face 0 is not a simple polygon")
    clockwise = replace(book(), faces_vertices=Ragged.from_rows([[0, 1, 4, 3], [4, 5, 2, 1]]))
    assert only(verify(clockwise, index_array([0, 1])), "planar", "face 1 runs clockwise")


def test_faces_that_do_not_meet_at_edges_are_found() -> None:
    missing = replace(book(), faces_vertices=Ragged.from_rows([[0, 1, 4, 3]]))
    messages = " ".join(finding.message for finding in verify(missing, index_array([0])))
    assert "edge 1 borders no face" in messages
    assert "edge 6 has a face on one side only" in messages
    double = replace(book(), faces_vertices=Ragged.from_rows([[0, 1, 4, 3], [1, 2, 5, 4], [1, 2, 5, 4]]))
    assert only(verify(double, index_array([0, 1, 2])), "planar", "face 2 lies on the same side of an edge")
    assert only(verify(book("B"), index_array([0, 1])), "planar", "edge 6 is assigned B but has faces on both sides")
    good = book()
    bare = replace(good, edges_vertices=good.edges_vertices[:-1], edges_assignment=good.edges_assignment[:-1])
    assert only(verify(bare, index_array([0, 1])), "planar", "vertices 1 to 4, that is not an edge")


def test_a_sheet_with_a_hole_is_found() -> None:
    outer, inner = (
        [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (0.0, 3.0)],
        [(1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0)],
    )
    border = [(k + base, (k + 1) % 4 + base, "B") for base in (0, 4) for k in range(4)]
    spokes = [(k, k + 4, "F") for k in range(4)]
    faces = [[k, (k + 1) % 4, (k + 1) % 4 + 4, k + 4] for k in range(4)]
    findings = verify(make(outer + inner, border + spokes, faces), index_array(range(4)))
    assert only(findings, "planar", "second border")


def test_sheets_that_touch_in_one_point_are_found() -> None:
    points = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
    edges = [(0, 1, "B"), (1, 2, "B"), (2, 0, "B"), (0, 3, "B"), (3, 4, "B"), (4, 0, "B")]
    findings = verify(make(points, edges, [[0, 1, 2], [0, 3, 4]]), index_array([0, 1]))
    assert only(findings, "planar", "meets itself").place == (0.0, 0.0)


def test_a_sheet_that_overlaps_itself_is_found() -> None:
    # A chain of five right triangles around a point, one more than fit.
    turn = np.radians(90) * np.arange(6)
    rim = [(float(1.2**k * np.cos(t)), float(1.2**k * np.sin(t))) for k, t in enumerate(turn)]
    faces = [[0, k + 1, k + 2] for k in range(5)]
    edges = [(0, k + 1, "B" if k in (0, 5) else "F") for k in range(6)] + [(k + 1, k + 2, "B") for k in range(5)]
    findings = verify(make([(0.0, 0.0), *rim], edges, faces), index_array(range(5)))
    assert kinds(findings) == {"planar"}


def test_kawasaki_names_the_vertex_and_the_angle() -> None:
    pattern = star_vertex((90.0, 90.0, 89.0, 91.0), "MMMV")
    finding = next(f for f in verify(pattern, index_array(range(4))) if f.check == "kawasaki")
    assert finding.place == (0.0, 0.0)
    assert finding.size == pytest.approx(1.0)


def test_an_odd_number_of_creases_is_found() -> None:
    assert "kawasaki" in kinds(verify(star_vertex((120.0, 120.0, 120.0), "MMM"), index_array(range(3))))


def test_maekawa_names_the_vertex() -> None:
    finding = only(verify(star_vertex((90.0,) * 4, "MMVV"), index_array(range(4))), "maekawa", "2 mountains and 2")
    assert finding.place == (0.0, 0.0)


def test_faces_that_do_not_meet_when_folded_are_measured() -> None:
    findings = verify(star_vertex((90.0, 90.0, 89.0, 91.0), "MMMV"), index_array(range(4)))
    gap = next(finding for finding in findings if finding.check == "closure")
    assert gap.size == pytest.approx(2 * np.sin(np.radians(1.0)), rel=1e-3)


def test_errors_of_rounding_are_no_findings_and_larger_ones_are() -> None:
    pattern, layers, shape = good_rectangle()
    for error, good in ((1e-9, True), (1e-4, False)):
        points = pattern.vertices_coords + error * np.sin(np.arange(pattern.vertices_coords.size)).reshape(-1, 2)
        assert (verify(replace(pattern, vertices_coords=points), layers, shape) == []) == good


@pytest.mark.parametrize(("width", "good"), [(1e-8, True), (1e-9, True), (1e-11, True), (1e-13, False)])
def test_pleats_may_be_finer_than_the_coarse_tolerance_but_not_than_the_finest(width: float, good: bool) -> None:
    pleat = strip("MV")
    points = pleat.vertices_coords.copy()
    points[4:, 0] += width - 1
    pleat = replace(pleat, vertices_coords=points_array(points))
    findings = verify(pleat, index_array([2, 1, 0]))
    assert not findings if good else only(findings, "planar", "merge its vertices")
    assert verify(pleat, index_array([1, 2, 0]))


def test_layer_orders_that_are_not_permutations_are_found() -> None:
    for layers in ([0, 0], [0], [0, 1, 2], [0, 2], [-1, 0]):
        assert only(verify(book(), index_array(layers)), "layers", "not a permutation of the 2 faces")


def test_a_pattern_without_layers_is_not_verified() -> None:
    assert only(verify(book(), None), "layers", "no layer order")


def test_a_layer_inside_a_fold_that_it_runs_across_is_taco_tortilla() -> None:
    # Face 1 is long: tucked between faces 2 and 3, it would pass through the crease between them.
    points = [(x, y) for x in (0.0, 1.0, 4.0, 5.0, 6.0) for y in (0.0, 1.0)]
    across = [(0, 1, "B"), (2, 3, "V"), (4, 5, "V"), (6, 7, "M"), (8, 9, "B")]
    along = [(k, k + 2, "B") for k in range(8)]
    pattern = make(points, across + along, [[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(4)])
    assert not stack_findings(pattern, [1, 0, 2, 3])
    order = index_array([2, 1, 0, 3])
    finding = only(
        verify(with_creases_from(pattern, order), order),
        "taco-tortilla",
        "face 1 runs across crease 3, between its faces 2 and 3",
    )
    assert finding.place == (5.0, 0.5)


def test_two_folds_that_pass_through_each_other_are_taco_taco() -> None:
    pattern = strip("MMM")
    finding = only(
        verify(with_creases_from(pattern, [0, 2, 1, 3]), index_array([0, 2, 1, 3])), "taco-taco", "interleave"
    )
    assert finding.place[1] == 0.5


def test_folds_on_opposite_sides_of_a_line_may_interleave() -> None:
    # Rows of two stamps: folds 0-1 and 2-3 point left and right of x = 1 in the folded state.
    assert not stack_findings(strip("MM"), [1, 0, 2])
    assert not stack_findings(strip("MM"), [0, 2, 1])


def test_sheets_that_change_places_at_unfolded_edges_are_tortilla_tortilla() -> None:
    # A book with a line across both halves: above the line one half is on top, below it the other.
    pattern, layers = Paper([(0, 0), (4, 0), (4, 2), (0, 2)]).fold((2, 0), (0, 1)).divide((0, 1), (-1, 0)).pattern()
    assert verify(pattern, layers) == []
    above = [pattern.vertices_coords[ring][:, 1].mean() > 1 for ring in pattern.faces_vertices]
    order = [face for face in layers.tolist() if not above[face]]
    order += [face for face in layers.tolist()[::-1] if above[face]]
    assert "change places" in only(stack_findings(pattern, order), "tortilla-tortilla", "edges").message


def test_a_face_may_not_cut_through_a_sheet_at_an_unfolded_edge() -> None:
    # Face 2 reaches across the line between faces 0 and 1, over the one and under the other.
    points = [(x, y) for x in (0.0, 1.0, 2.0, 4.0) for y in (0.0, 1.0)]
    across = [(0, 1, "B"), (2, 3, "F"), (4, 5, "V"), (6, 7, "B")]
    along = [(k, k + 2, "B") for k in range(6)]
    pattern = make(points, across + along, [[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(3)])
    assert verify(pattern, index_array([0, 1, 2])) == []
    findings = verify(with_creases_from(pattern, index_array([0, 2, 1])), index_array([0, 2, 1]))
    only(findings, "tortilla-tortilla", "face 2 cuts through the sheet of faces 0 and 1")


def test_an_unfolded_edge_may_not_lie_in_a_fold_that_coincides_with_it() -> None:
    # Faces 1 and 2 are one flat sheet, which runs on across the fold between faces 3 and 4.
    pattern = strip("MFMM")
    assert verify(with_creases_from(pattern, index_array([4, 3, 2, 1, 0])), index_array([4, 3, 2, 1, 0])) == []
    order = index_array([3, 2, 4, 1, 0])
    only(verify(with_creases_from(pattern, order), order), "taco-tortilla", "interleave")


@pytest.mark.parametrize("seed", range(20))
def test_vertices_are_flat_exactly_when_nothing_is_found_at_them(seed: int) -> None:
    rng = np.random.default_rng(seed)
    paper = random_paper(rng, folds=int(rng.integers(2, 6)), lines=int(rng.integers(3)))
    good, _ = paper.pattern(rng.permutation(len(paper.layers)))
    faces = edge_faces(good)
    maps = fold_faces(good, faces)
    verdicts = []
    for flips in (0, 1, 1, 2, 2, 3):
        letters = good.edges_assignment.copy()
        at = rng.choice(np.flatnonzero(np.isin(letters, ("M", "V"))), flips)
        letters[at] = np.where(letters[at] == "M", "V", "M")
        pattern = replace(good, edges_assignment=letters)
        flat = is_flat_at_vertices(pattern, faces, maps, TINY)
        assert flat == (not check_vertices(pattern, faces, TINY))
        verdicts.append(flat)
    assert verdicts[0]
    bent = good.vertices_coords + 1e-3 * rng.standard_normal(good.vertices_coords.shape)
    pattern = replace(good, vertices_coords=bent)
    flat = is_flat_at_vertices(pattern, faces, fold_faces(pattern, faces), TINY)
    assert flat == (not check_vertices(pattern, faces, TINY))


def test_many_findings_of_one_kind_are_cut_short() -> None:
    rng = np.random.default_rng(0)
    pattern = strip("MV" * 200)
    findings = verify(pattern, index_array(rng.permutation(401)))
    assert sum(finding.check == "taco-taco" for finding in findings) == 100


# The mutations that any change to a good pattern could make


def good_rectangle() -> tuple[CreasePattern, Ints, Shape]:
    paper, shape = rectangle_fold(60.0, 40.0)
    return (*paper.pattern(), shape)


def test_every_flipped_crease_is_rejected() -> None:
    pattern, layers, shape = good_rectangle()
    for edge in np.flatnonzero(pattern.edges_assignment != "B"):
        letters = pattern.edges_assignment.copy()
        letters[edge] = {"M": "V", "V": "M"}[str(letters[edge])]
        assert verify(replace(pattern, edges_assignment=letters), layers, shape)


def test_every_swapped_pair_of_neighbouring_layers_is_rejected() -> None:
    pattern, layers, shape = good_rectangle()
    for at in range(len(layers) - 1):
        order = layers.copy()
        order[[at, at + 1]] = order[[at + 1, at]]
        assert verify(pattern, order, shape)


def test_every_moved_inner_vertex_is_rejected() -> None:
    pattern, layers, shape = good_rectangle()
    inside = np.setdiff1d(
        np.arange(len(pattern.vertices_coords)), pattern.edges_vertices[pattern.edges_assignment == "B"]
    )
    for vertex in inside:
        points = pattern.vertices_coords.copy()
        points[vertex] += 1e-4 * 100 * np.array([0.6, 0.8])
        assert verify(replace(pattern, vertices_coords=points), layers, shape)


# The cut


@pytest.mark.parametrize(("width", "height"), [(60.0, 40.0), (50.0, 50.0), (90.0, 10.0)])
def test_a_rectangle_is_cut_out_of_a_quartered_sheet(width: float, height: float) -> None:
    paper, shape = rectangle_fold(width, height)
    assert verify(*paper.pattern(), shape) == []


def test_two_components_are_cut_at_once() -> None:
    paper = Paper([(0, 0), (200, 0), (200, 100), (0, 100)]).fold((100, 0), (0, 1))
    paper.fold((50, 0), (0, -1)).fold((0, 50), (1, 0)).fold((75, 75), (1, 1))
    shape = box_shape((25, 25, 75, 75), (125, 25, 175, 75))
    assert verify(*paper.pattern(), shape) == []
    assert kinds(verify(*paper.pattern(), box_shape((25, 25, 75, 75)))) == {"cut"}


def test_a_hole_is_cut_at_once() -> None:
    # The hole's edges lie on y = 70, the outer ones on y = 90: one more fold between them.
    paper, outer = rectangle_fold(80.0, 80.0)
    pattern, layers = paper.fold((0, 80), (1, 0)).pattern()
    ring = Shape((outer.loops[0], box_shape((30, 30, 70, 70)).loops[0]), (-1, 0))
    assert verify(pattern, layers, ring) == []
    only(verify(pattern, layers, outer), "cut", "over the cut line")


@pytest.mark.parametrize(
    "other",
    [
        box_shape((20, 30, 80, 70.001)),
        box_shape((20.001, 30, 80, 70)),
        box_shape((25, 25, 75, 75)),
        box_shape((20, 30, 80, 50)),
        box_shape((20, 30, 80, 70), (45, 45, 55, 55), parent=(-1, 0)),
    ],
)
def test_another_shape_is_rejected(other: Shape) -> None:
    pattern, layers, shape = good_rectangle()
    assert verify(pattern, layers, shape) == []
    assert kinds(verify(pattern, layers, other)) == {"cut"}


def test_a_boundary_that_folds_off_the_line_is_measured() -> None:
    pattern, layers, _ = good_rectangle()
    findings = verify(pattern, layers, box_shape((20, 30, 80, 70.5)))
    assert only(findings, "cut", "away from the cut line").size > 0.1


def test_a_crease_along_the_boundary_is_found() -> None:
    paper = square_paper(100.0).fold((50, 0), (0, 1))
    findings = verify(*paper.pattern(), box_shape((50, 20, 80, 60)))
    assert "lies on the shape's boundary for 40 mm" in findings[0].message


def test_a_shape_without_loops_is_found() -> None:
    pattern, layers, _ = good_rectangle()
    only(verify(pattern, layers, Shape((), ())), "cut", "no loops")


def test_a_shape_that_leaves_the_sheet_is_found() -> None:
    pattern, layers, _ = good_rectangle()
    assert only(verify(pattern, layers, box_shape((20, 30, 120, 70))), "cut", "over the sheet's border")


def test_paper_on_the_wrong_side_of_the_cut_is_found() -> None:
    # The boundary is on y = 80; the fold at y = 70 takes the middle of the shape across that line.
    paper, shape = rectangle_fold(60.0, 60.0)
    findings = verify(*paper.fold((0, 70), (1, 0)).pattern(), shape)
    assert only(findings, "cut", "inside the shape, folds").size == pytest.approx(10)


def test_unfolded_edges_may_lie_on_the_boundary() -> None:
    paper, shape = rectangle_fold(60.0, 40.0)
    pattern, layers = paper.divide((80.0, 0), (0, 1)).pattern()
    assert "F" in pattern.edges_assignment
    assert verify(pattern, layers, shape) == []


def cut_verdicts(pattern: CreasePattern, shape: Shape, monkeypatch: pytest.MonkeyPatch) -> list[bool]:
    """Return whether the cut is right, judged by the edges that reach the line, as in large patterns, and by all."""
    faces = edge_faces(pattern)
    maps = fold_faces(pattern, faces)
    monkeypatch.setattr(cutline, "MANY_EDGES", 10**9)
    slow = not check_cut(pattern, faces, maps, shape, TINY)
    sides = sides_of(shape)
    if cutline.check_on_sheet(pattern, faces, sides, TINY):
        assert not slow
        return [False, False]
    return [cutline.is_surely_cut(pattern, faces, maps, shape, sides, TINY), slow]


def test_edges_that_reach_the_line_tell_whether_the_cut_is_right(monkeypatch: pytest.MonkeyPatch) -> None:
    paper, shape = rectangle_fold(60.0, 40.0)
    pattern, _ = paper.pattern()
    assert cut_verdicts(pattern, shape, monkeypatch) == [True, True]
    divided, _ = rectangle_fold(60.0, 40.0)[0].divide((80.0, 0), (0, 1)).pattern()
    assert cut_verdicts(divided, shape, monkeypatch) == [True, True]
    beyond, square = rectangle_fold(60.0, 60.0)  # paper on the wrong side of the line, as below
    assert cut_verdicts(beyond.fold((0, 70), (1, 0)).pattern()[0], square, monkeypatch) == [False, False]
    rng = np.random.default_rng(0)
    for far in 10.0 ** rng.uniform(-5, 1, 60):  # one corner elsewhere
        (loop,) = shape.loops
        moved = loop.copy()
        moved[rng.integers(4)] += far * np.array([0.6, 0.8])
        assert cut_verdicts(pattern, Shape((points_array(moved),), (-1,)), monkeypatch) == [False, False]
    for _ in range(60):  # another loop, which the line does not come near
        x, y, width, height = *rng.uniform(2, 90, 2), *rng.uniform(0.1, 8, 2)
        box = box_shape((x, y, x + width, y + height)).loops[0]
        more = Shape((shape.loops[0], box), (-1, -1))
        assert cut_verdicts(pattern, more, monkeypatch) == [False, False]
    for _ in range(60):  # the shape, turned and moved
        angle, shift = 0.1 * rng.standard_normal(), 3 * rng.standard_normal(2)
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        turned = points_array((shape.loops[0] - 50) @ turn.T + 50 + shift)
        assert cut_verdicts(pattern, Shape((turned,), (-1,)), monkeypatch) == [False, False]


@pytest.mark.parametrize(("off", "believed"), [(0.0, True), (40 * TINY, True), (30.0, False)])
def test_a_guess_of_the_line_need_not_be_good(off: float, believed: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    paper, shape = rectangle_fold(60.0, 40.0)
    pattern, _ = paper.pattern()
    honest, asked = cutline.line_through, []

    def guessed(points: Floats) -> tuple[Floats, float]:
        along, level = honest(points)
        asked.append(along)
        turn = off if len(asked) == 2 else 0.0  # the first is that of the slow check
        return along + turn / 100 * np.array([-along[1], along[0]]), level + turn

    monkeypatch.setattr(cutline, "line_through", guessed)
    assert cut_verdicts(pattern, shape, monkeypatch) == [believed, True]


def test_faces_that_pieces_of_the_boundary_are_not_in_are_not_believed(monkeypatch: pytest.MonkeyPatch) -> None:
    paper, shape = rectangle_fold(60.0, 40.0)
    pattern, _ = paper.pattern()
    honest = cutline.fold_pieces
    assert cut_verdicts(pattern, shape, monkeypatch) == [True, True]

    def elsewhere(*given: object) -> tuple[object, ...]:
        pieces, faces, landed = honest(*given)  # type: ignore[arg-type]
        return pieces, np.roll(faces, 1), landed

    monkeypatch.setattr(cutline, "fold_pieces", elsewhere)
    assert cut_verdicts(pattern, shape, monkeypatch) == [False, True]


# Nothing depends on where the sheet lies, or how its parts are numbered


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e4])
def test_scale_and_place_change_no_verdict(scale: float) -> None:
    pattern, layers, shape = good_rectangle()
    turn = np.array([[0.6, -0.8], [0.8, 0.6]]) * scale
    place = lambda points: points_array(points @ turn.T + (3 * scale, -7 * scale))  # noqa: E731
    turned = replace(pattern, vertices_coords=place(pattern.vertices_coords))
    assert verify(turned, layers, Shape(tuple(map(place, shape.loops)), shape.parent)) == []
    swapped_layers = layers.copy()
    swapped_layers[[0, 1]] = swapped_layers[[1, 0]]
    assert kinds(verify(turned, swapped_layers)) == kinds(verify(pattern, swapped_layers))


def test_traced_faces_are_the_pattern_s_faces() -> None:
    paper = random_paper(np.random.default_rng(4), 5)
    pattern, _ = paper.pattern()
    traced = trace_faces(pattern.vertices_coords, pattern.edges_vertices)

    def rings(faces: Ragged) -> set[tuple[int, ...]]:
        return {tuple(np.roll(ring, -int(np.argmin(ring))).tolist()) for ring in faces}

    assert rings(traced) == rings(pattern.faces_vertices)


def test_segments_enter_polygons_only_by_more_than_the_inset() -> None:
    corners = np.array([(0, 0), (2, 0), (2, 2), (0, 2), (0, 0), (2, 0), (2, 2), (1, 0.5)], dtype=float)
    outlines = Outlines(corners, np.array([0, 4, 8]), TINY)
    segments = np.array(
        [
            [(-1, 1), (3, 1)],  # through both
            [(0, -1), (0, 3)],  # along a side of the square
            [(-1, 2 - TINY / 2), (3, 2 - TINY / 2)],  # less than the inset from a side
            [(0.5, 0.5), (0.9, 0.9)],  # inside the square, in the notch of the other
            [(2, 2), (3, 3)],  # from a corner, outwards
        ],
        dtype=float,
    )
    square, notched = np.zeros(5, dtype=int), np.ones(5, dtype=int)
    assert outlines.crossed(segments, square).tolist() == [True, False, False, True, False]
    assert outlines.crossed(segments, notched).tolist() == [True, False, False, False, False]
