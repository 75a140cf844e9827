"""Three mirror axes or more folded first: the fan, the wedge, and whole patterns."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from support.dihedral_shapes import dihedral_shape
from support.strategies import Points, regular

import foldcut
from foldcut.core.arrays import Ints, points_array
from foldcut.core.model import CreasePattern, FoldedState, Shape, Sheet
from foldcut.drawing.laying import Laying
from foldcut.drawing.placement import Layout, parse_sheet, place
from foldcut.drawing.shape import invariant_faults, make_shape
from foldcut.geometry.dihedral import dihedral, made_dihedral
from foldcut.methods import METHODS
from foldcut.methods.base import Effort, Problem, Wishes
from foldcut.methods.mirror import method
from foldcut.methods.mirror.halves import closed_wedge, one_loop_wedges
from foldcut.methods.mirror.skeletal import fold_part
from foldcut.methods.mirror.wedge import Wedge, wedge_lines
from foldcut.pattern.first_folds import axis_order, fan, fan_folds, first_fold_count, in_front, layers_after
from foldcut.pattern.foldability import crease_numbers
from foldcut.pattern.ranking import shortest_crease
from foldcut.proof.verify import verify

SOME = [
    ("star", 3, 0),
    ("snowflake", 4, 4),
    ("rosette", 5, 8),
    ("snowflake", 6, 10),
    ("rosette", 8, 14),
    ("star", 12, 15),
]


def wedge_of(loops: list[Points] | tuple[Points, ...], sheet: str = "a4") -> Wedge:
    """Return the wedge of a shape that lies as large as it can on a sheet."""
    on = parse_sheet(sheet)
    shape, _ = place(make_shape(loops), on)
    axes = dihedral(shape)
    assert axes is not None
    made = made_dihedral(shape, axes)
    assert made is not None
    return Wedge.of(made[0], on, made[1], axes.count, axes.first)


@pytest.mark.parametrize("count", range(2, 13))
def test_no_paper_of_a_fan_passes_through_paper(count: int) -> None:
    layers = fan(count)
    assert layers[0] == 0
    assert sorted(layers) == list(range(2 * count))
    level = {sector: number for number, sector in enumerate(layers)}
    # sectors are joined at the wedge's two borders in turns; at each of them the joints must not cross
    for border in (0, 1):
        joints = [sorted((level[sector], level[(sector + 1) % (2 * count)])) for sector in range(border, 2 * count, 2)]
        assert not any(a < c < b < d for a, b in joints for c, d in joints)
    assert fan_folds(count) == math.ceil(math.log2(2 * count))
    order = axis_order(count)
    assert order[0] == 0
    assert sorted(order) == list(range(count))


def test_six_axes_are_folded_in_half_in_half_and_in_thirds() -> None:
    assert fan(6) == [0, 11, 6, 5, 2, 9, 8, 3, 4, 7, 10, 1]
    assert axis_order(6) == [0, 3, 2, 4, 1, 5]


@pytest.mark.parametrize(("kind", "axes", "seed"), SOME)
def test_shapes_with_several_axes_take_few_folds(kind: str, axes: int, seed: int) -> None:
    drawn = dihedral_shape(kind, axes, seed)
    result = foldcut.fold(list(drawn.loops), method="mirror", effort="fast", exact=True)
    assert result.findings == ()
    assert result.actions <= fan_folds(axes) + 3 * drawn.sector_corners
    first = result.folded_pattern.first_folds
    assert len(first) == axes
    assert (first_fold_count(first), layers_after(first)) == (fan_folds(axes), 2 * axes)


def test_the_sectors_of_a_sheet_differ_and_the_wedge_covers_them_all() -> None:
    wedge = wedge_of(dihedral_shape("snowflake", 5, 7).loops, "180x250mm")
    outline = shapely.Polygon(wedge.sheet.corners)
    corners = [wedge.in_wedge(np.array([[corner, corner]]))[0, 0] for corner in wedge.whole.corners]
    assert all(outline.buffer(1e-6).covers(shapely.Point(place)) for place in corners)
    assert len({tuple(place) for place in np.round(corners, 3).tolist()}) == 2
    found = fold_part(wedge)
    assert verify(found.creases, found.folded.layers, wedge.shape) == []
    places = {tuple(place) for place in found.creases.vertices_coords.tolist()}
    assert {tuple(place) for place in wedge.whole.corners.tolist()} <= places
    assert found.creases.vertices_coords.min() == 0
    assert found.creases.vertices_coords.max(axis=0).tolist() == [wedge.whole.width, wedge.whole.height]


def test_a_sector_in_the_wrong_place_of_the_fan_is_found_by_verification(monkeypatch: pytest.MonkeyPatch) -> None:
    wedge = wedge_of([regular(4)])
    found = fold_part(wedge)
    state = flat_state(found.part)
    right = fan(4)
    assert verify(*pattern(wedge, found.part, state), wedge.shape) == []
    for k in range(7):
        wrong = [*right[:k], right[k + 1], right[k], *right[k + 2 :]]
        monkeypatch.setattr("foldcut.methods.mirror.wedge.fan", lambda _count, wrong=wrong: wrong)
        assert verify(*pattern(wedge, found.part, state), wedge.shape), k


def flat_state(creases: CreasePattern) -> FoldedState:
    """Return the state of a wedge with a single face: it needs no fold but its borders."""
    assert len(creases.faces_vertices) == 1
    return FoldedState(points_array(creases.vertices_coords), np.zeros(1, dtype=np.int32))


def pattern(wedge: Wedge, creases: CreasePattern, state: FoldedState) -> tuple[CreasePattern, Ints]:
    """Return the creases of the whole sheet and the order of its layers."""
    unfolded, folded = wedge.unfold(creases, state)
    return unfolded, folded.layers


@pytest.mark.parametrize("sheet", ["a3", "100x220mm", "300x160mm"])
def test_what_is_cut_off_by_the_sheet_in_one_sector_counts_once(sheet: str) -> None:
    wedge = wedge_of(dihedral_shape("snowflake", 6, 10).loops, sheet)
    found = fold_part(wedge)
    assert verify(found.creases, found.folded.layers, wedge.shape) == []
    assert 0 < wedge_lines(found.creases, wedge) <= crease_numbers(found.part).lines


def test_only_creases_of_the_wedge_are_counted() -> None:
    wedge = wedge_of(dihedral_shape("snowflake", 6, 10).loops)
    found = fold_part(wedge)
    lines = crease_numbers(found.part).lines
    assert lines > 5
    assert wedge_lines(found.creases, wedge) == lines
    assert crease_numbers(found.creases).lines > 3 * lines


@pytest.mark.parametrize(
    "options",
    [{"rotation": 17.0}, {"offset": (12.0, 31.0), "scale": 60.0}, {"rotation": -5.0, "width": 120.0}],
)
def test_axes_need_not_lie_along_the_sheet_nor_in_its_middle(options: dict[str, object]) -> None:
    loops = list(dihedral_shape("star", 5, 6).loops)
    result = foldcut.fold(loops, method="mirror", effort="fast", exact=True, **options)  # type: ignore[arg-type]
    assert result.findings == ()
    assert result.actions <= 4 + 9
    lines = result.folded_pattern.first_folds
    centre = np.mean(np.concatenate(result.folded_pattern.shape.loops), axis=0)
    for start, end in lines:
        along = (end - start) / math.dist(start, end)
        assert abs((centre - start) @ (-along[1], along[0])) < 1e-6


def test_rounded_coordinates_are_symmetric_but_exact_forbids_to_move_them() -> None:
    loops = [[(round(50 * x, 2), round(50 * y, 2)) for x, y in loop] for loop in dihedral_shape("star", 5, 6).loops]
    result = foldcut.fold(loops, method="mirror", effort="fast", tolerance=0.05, next_level=False)
    assert result.findings == ()
    assert len(result.folded_pattern.first_folds) == 5
    assert any(note.startswith("made symmetric: corners moved by at most 0.0") for note in result.notes)
    exact = foldcut.fold(loops, method="mirror", effort="fast", exact=True, min_crease=0)
    assert len(exact.folded_pattern.first_folds) == 1


def test_a_drawing_that_is_nearly_symmetric_is_made_so_on_request() -> None:
    random = np.random.default_rng(3)
    loop = np.array(dihedral_shape("star", 6, 9).loops[0])
    loop += random.uniform(-0.002, 0.002, loop.shape)
    problem = problem_of([loop], symmetry=1.0)
    made = METHODS["mirror"].fold(problem, Effort("fast"))
    assert len(made.first_folds) == 6
    assert made.laid.notes[-1].startswith("made symmetric: corners moved by at most 0.")
    off = np.hypot(*(made.laid.shape.loops[0] - problem.shape.loops[0]).T).max()
    assert 0.05 < off < 1.0
    with pytest.raises(foldcut.UnfoldableError, match="not mirror-symmetric"):
        METHODS["mirror"].fold(problem_of([loop]), Effort("fast"))


def problem_of(loops: list[Points], symmetry: float = 0.0) -> Problem:
    laying = Laying(make_shape(loops), Layout(parse_sheet("a4"), 10.0, rotation=0.0))
    return Problem(laying.lay(), laying.lay, Wishes(symmetry=symmetry, adjust=0.0))


@pytest.mark.parametrize(("kind", "axes", "seed"), [("snowflake", 6, 10), ("rosette", 5, 8), ("star", 3, 0)])
def test_single_loops_agree_with_the_shape_in_the_wedge(kind: str, axes: int, seed: int) -> None:
    wedge = wedge_of(dihedral_shape(kind, axes, seed).loops)
    found = list(one_loop_wedges(wedge))
    assert found
    on_wedge = shapely.Polygon(wedge.sheet.corners)
    drawn = filled(wedge.outline).intersection(on_wedge)
    for one in found:
        assert len(one.loops) == 1
        assert invariant_faults(one.outline) == []
        assert drawn.symmetric_difference(filled(one.outline).intersection(on_wedge)).area < 1e-6 * drawn.area


def filled(shape: Shape) -> shapely.Geometry:
    area = shapely.Polygon()
    for loop in shape.loops:
        area = area.symmetric_difference(shapely.Polygon(loop))
    return area


def test_a_point_of_the_axes_beyond_the_sheet_is_refused() -> None:
    wedge = wedge_of([regular(5)])
    beyond = Wedge.of(wedge.shape, Sheet(50, 50), wedge.centre, wedge.count, wedge.angle)
    with pytest.raises(foldcut.UnfoldableError, match=r"where the mirror axes meet, \(.*\) mm, is not on the sheet"):
        beyond.sheet  # noqa: B018


def test_lines_in_front_are_those_of_one_sector() -> None:
    wedge = wedge_of(dihedral_shape("snowflake", 6, 10).loops)
    found = fold_part(wedge)
    ends = found.creases.edges_vertices[found.creases.edges_assignment != "B"]
    lines = found.creases.vertices_coords[ends]
    shown = [line for line in lines if in_front(line, wedge.first_folds)]
    at = np.array([wedge.in_sector(line).mean(axis=0) for line in shown])
    angle = np.degrees(np.arctan2(at[:, 1], at[:, 0]))
    assert ((angle > 0) & (angle < 30)).all()
    assert 0 < len(shown) < len(lines) / 11


@pytest.mark.parametrize(
    ("kind", "axes", "seed", "near"),
    [
        *(("snowflake", 6, 10, near) for near in [(True, True), (True, False), (False, True)]),
        ("rosette", 5, 8, (True, True)),  # far away its inner and its outer chain would cross
        ("star", 3, 0, (True, False)),
    ],
)
def test_loops_closed_beyond_a_border_fold_the_same_shape(
    kind: str, axes: int, seed: int, near: tuple[bool, bool]
) -> None:
    wedge = wedge_of(dihedral_shape(kind, axes, seed).loops)
    closed = closed_wedge(wedge, near)
    assert closed is not None
    on_wedge = shapely.Polygon(wedge.sheet.corners)
    drawn = filled(wedge.outline).intersection(on_wedge)
    assert drawn.symmetric_difference(filled(closed.outline).intersection(on_wedge)).area < 1e-6 * drawn.area
    corners = np.concatenate(closed.loops)
    last, first = (corners @ np.linalg.inv(wedge.borders)).T
    for beyond, is_near in ((last, near[0]), (first, near[1])):
        assert (beyond[beyond < -1e-9].max() > -1) == is_near
    found = fold_part(closed)
    assert verify(found.creases, found.folded.layers, wedge.shape) == []


def test_a_drawing_is_turned_where_creases_are_short_at_the_edge_of_the_sheet() -> None:
    problem = problem_of(list(dihedral_shape("star", 5, 106).loops))
    short = METHODS["mirror"].fold(problem, Effort("fast"))
    assert shortest_crease(short.creases) < 1
    assert METHODS["mirror"].fold(problem, Effort("normal")).laid.notes == ()
    made = METHODS["mirror"].fold(replace(problem, may_turn=True), Effort("normal"))
    assert made.laid.notes == ("turned by 9 degrees, so that creases are longer at the sheet's edge",)
    assert shortest_crease(made.creases) > 3
    assert verify(made.creases, made.folded.layers, made.laid.shape) == []
    assert made.actions == short.actions


def test_a_windmill_is_told_from_a_shape_with_axes() -> None:
    windmill: Points = [(1, 0), (4, 1), (0, 1), (-1, 4), (-1, 0), (-4, -1), (0, -1), (1, -4)]
    with pytest.raises(foldcut.UnfoldableError, match="4 equal turns bring it onto itself, but without an axis"):
        METHODS["mirror"].fold(problem_of([windmill]), Effort("fast"))


def test_the_axis_of_most_of_a_drawing_is_named() -> None:
    tree: Points = [(0, 0), (40, 0), (25, 30), (35, 30), (15, 70), (2, 96), (2, 98), (-2, 98), (-2, 96), (-15, 70)]
    tree += [(-35, 30), (-25, 30), (-40, 0)]
    bird: Points = [*tree[:7], (3, 100), (1, 103), *tree[7:]]
    with pytest.raises(
        foldcut.UnfoldableError,
        match=r"all except \d% of its outline is so about the axis at 90 degrees through \(1.*\) mm; draw the rest",
    ):
        METHODS["mirror"].fold(problem_of([bird]), Effort("fast"))


def test_as_many_axes_as_the_tolerance_allows_are_taken_on_request() -> None:
    random = np.random.default_rng(3)
    loop = np.array(dihedral_shape("star", 6, 45).loops[0])
    loop += random.uniform(-0.0008, 0.0008, loop.shape)
    assert dihedral(make_shape([loop])) is None
    result = foldcut.fold([loop], method="mirror", effort="fast", symmetry="auto")
    assert len(result.folded_pattern.first_folds) == 6
    assert any(note.startswith("made symmetric: corners moved by at most 0.") for note in result.notes)


def test_a_drawing_that_would_not_fit_is_not_turned() -> None:
    # a square of 190 mm fits on A4 upright and level only
    ring = [[(s * x, s * y) for x, y in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]] for s in (95.0, 60.0)]
    laying = Laying(make_shape(ring), Layout(parse_sheet("a4"), 10.0, scale=1.0))
    problem = Problem(laying.lay(), laying.lay, may_turn=True)
    made = METHODS["mirror"].fold(problem, Effort("fast"))
    assert made.laid.notes == ()
    assert len(made.first_folds) in (2, 4)
    assert method._tilted(problem) == []
    roomy = Laying(make_shape(ring), Layout(parse_sheet("a4"), 10.0))
    assert len(method._tilted(Problem(roomy.lay(), roomy.lay, may_turn=True))) > 4
