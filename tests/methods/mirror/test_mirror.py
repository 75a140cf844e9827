"""Folding the mirror axes first: halves of shapes, and whole patterns of them."""

from __future__ import annotations

import math
from math import comb

import numpy as np
import pytest
import shapely
from support.strategies import Points, cross, rectangle, regular

import foldcut
from foldcut.core.arrays import Floats
from foldcut.core.model import Shape, Sheet
from foldcut.drawing.laying import AS_IT_IS, Laid
from foldcut.drawing.placement import parse_sheet, place
from foldcut.drawing.shape import invariant_faults, make_shape
from foldcut.geometry.mirror_axes import symmetric
from foldcut.methods.mirror import search
from foldcut.methods.mirror.halves import extended, halves_of, matchings, one_loop_halves
from foldcut.methods.mirror.skeletal import fold_part, lines_beside, made_of_half
from foldcut.methods.mirror.unfold import Half
from foldcut.methods.skeleton.search import Search
from foldcut.pattern.foldability import crease_numbers
from foldcut.pattern.ranking import shortest_crease
from foldcut.proof.verify import verify
from foldcut.samples import sample_path

LETTER_D: Points = [(0, 0), (4, 0), (6, 2), (6, 5), (4, 7), (0, 7)]
HOLE_D: Points = [(1.5, 1.5), (3.5, 1.5), (4.5, 2.5), (4.5, 4.5), (3.5, 5.5), (1.5, 5.5)]

BOTH_SIDES = (-1, 1)
SHAPES: dict[str, tuple[list[Points], int]] = {
    # loops, and the most folds that are allowed with fast effort
    "square ring": ([rectangle(10, 10), rectangle(5, 5)], 3),
    "letter O": ([regular(8), [(0.5 * x, 0.5 * y) for x, y in regular(8)]], 5),
    "letter D": ([LETTER_D, HOLE_D], 20),
    "figure 8": ([rectangle(6, 10), *([(x, y + d) for x, y in rectangle(3, 3)] for d in (-2.25, 2.25))], 9),
    "letter B": ([[(0, -5), (4, -5), (5, -4), (5, -1), (4, 0), (5, 1), (5, 4), (4, 5), (0, 5)]], 9),
    "three rings": ([rectangle(s, s) for s in (12, 8, 4)], 4),
    "equals sign": ([[(x, y + d) for x, y in rectangle(10, 2)] for d in (-3, 3)], 5),
    "colon, level": ([[(x + d, y) for x, y in rectangle(2, 2)] for d in (-3, 3)], 3),
    "four dots": ([[(x + d, y + e) for x, y in rectangle(2, 2)] for d in (-3, 3) for e in (-3, 3)], 4),
    "letter i": ([[(-1, 0), (1, 0), (1, 6), (-1, 6)], [(-1, 8), (1, 8), (1, 10), (-1, 10)]], 6),
    "eyes": ([rectangle(12, 7), *([(s * x, y) for x, y in [(2, 1), (4, 2), (2, 2.5)]] for s in BOTH_SIDES)], 20),
}


def fold(loops: list[Points], **options: object) -> foldcut.Result:
    return foldcut.fold(loops, method="mirror", effort="fast", min_crease=0, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", sorted(SHAPES))
def test_symmetric_shapes_are_verified_and_take_few_folds(name: str) -> None:
    loops, most = SHAPES[name]
    result = fold(loops)
    assert result.findings == ()
    assert result.actions <= most
    assert len(result.folded_pattern.first_folds) >= 1


@pytest.mark.parametrize(("name", "most"), [("ring", 3), ("letter-a", 13), ("two-triangles", 4)])
def test_samples_with_several_loops_are_verified_and_take_few_folds(name: str, most: int) -> None:
    result = foldcut.fold(sample_path(name), method="mirror", effort="fast")
    assert result.findings == ()
    assert result.actions <= most


def test_a_square_ring_is_folded_along_its_diagonals() -> None:
    result = fold(SHAPES["square ring"][0])
    assert result.actions == 3
    assert len(result.folded_pattern.first_folds) == 2


def test_a_symmetric_shape_of_one_loop_takes_fewer_folds_than_without_its_axis() -> None:
    mirrored = fold([cross()])
    compact = foldcut.fold([cross()], method="compact", effort="fast", min_crease=0)
    assert mirrored.actions <= 8
    assert compact.actions >= 4 * mirrored.actions
    auto = foldcut.fold([cross()], effort="fast")
    assert (auto.method, auto.actions) == ("simple", mirrored.actions)
    assert [attempt.method for attempt in auto.attempts] == ["simple"]
    assert all(attempt.creases for attempt in auto.attempts)


def mirrored_places(points: Floats, axis: int, size: float) -> Floats:
    image = points.copy()
    image[:, axis] = size - image[:, axis]
    return image


def test_the_pattern_is_its_own_mirror_image_with_mountains_for_valleys() -> None:
    pattern = fold([LETTER_D, HOLE_D]).folded_pattern
    (line,) = pattern.first_folds
    axis = 0 if line[0, 0] == line[1, 0] else 1
    size = (pattern.sheet.width, pattern.sheet.height)[axis]
    coords = pattern.creases.vertices_coords

    def named(points: Floats) -> dict[frozenset[tuple[float, float]], str]:
        places = [tuple(place) for place in np.round(points, 6).tolist()]
        pairs = pattern.creases.edges_vertices.tolist()
        kinds = pattern.creases.edges_assignment.tolist()
        return {frozenset((places[a], places[b])): kind for (a, b), kind in zip(pairs, kinds, strict=True)}

    here, there = named(coords), named(mirrored_places(coords, axis, size))
    assert here.keys() == there.keys()
    swapped = {"M": "V", "V": "M", "B": "B"}
    on_axis = [edge for edge in here if all(abs(point[axis] - size / 2) < 1e-6 for point in edge)]
    assert on_axis
    assert all(there[edge] == swapped[kind] for edge, kind in here.items() if edge not in on_axis)
    # the axis is a crease along all of its length
    assert sum(abs(np.subtract(*edge)).max() for edge in map(tuple, on_axis)) == pytest.approx(
        (pattern.sheet.height, pattern.sheet.width)[axis]
    )


def test_the_image_on_the_wrong_side_of_a_face_is_found_by_verification() -> None:
    pattern = fold(SHAPES["letter D"][0]).folded_pattern
    creases, folded, shape = pattern.creases, pattern.folded, pattern.shape
    assert verify(creases, folded.layers, shape) == []
    # layers 2k and 2k + 1 are a face and its image
    for k in range(0, len(folded.layers), 2):
        layers = folded.layers.copy()
        layers[[k, k + 1]] = layers[[k + 1, k]]
        assert verify(creases, layers, shape)


@pytest.mark.parametrize(
    ("loops", "options", "message"),
    [
        ([[(0, 0), (4, 0), (3, 2), (1, 2.5)]], {}, "the drawing is not mirror-symmetric"),
        ([[(0, 0), (4, 0), (3, 2), (1, 2.5)]], {"symmetry": 0.1}, "not mirror-symmetric within 0.1 mm"),
        (
            [rectangle(12, 7), *([(x + d, y) for x, y in [(0, 1), (1, 2), (0.5, 2.5)]] for d in (-3, 3))],
            {},
            "the drawing is not mirror-symmetric",
        ),
        ([rectangle(4, 3)], {"offset": (20.0, 20.0), "scale": 20.0}, "not in the middle of the sheet"),
        ([rectangle(4, 3)], {"rotation": 17.0}, "no mirror axis of the drawing lies along the sheet"),
    ],
)
def test_what_cannot_be_mirrored_is_refused_with_the_reason(
    loops: list[Points], options: dict[str, object], message: str
) -> None:
    with pytest.raises(foldcut.UnfoldableError, match=message):
        fold(loops, **options)


def test_without_an_axis_several_loops_go_to_the_skeleton_and_the_attempts_say_why() -> None:
    loops = [rectangle(12, 7), [(2.0, 1.0), (4.0, 2.0), (2.0, 2.5)]]
    result = foldcut.fold(loops, effort="fast")
    assert (result.findings, result.method) == ((), "skeleton")
    mirror_failure, _, compact_failure = [attempt.failure for attempt in result.attempts]
    assert "the drawing is not" in mirror_failure
    assert "loop 1 " in compact_failure
    assert "loop 2 " in compact_failure


def test_near_symmetry_is_made_exact_on_request() -> None:
    loop = np.array(cross())
    loop[0] += 0.002  # about 0.1 mm on A4
    with pytest.raises(foldcut.UnfoldableError, match=r"but nearly: corners are 0\.\d+ mm off; .*--symmetry 0\.\d+mm"):
        foldcut.fold([loop], method="mirror")
    result = foldcut.fold([loop], method="mirror", effort="fast", symmetry=0.5)
    assert result.findings == ()
    assert any(note.startswith("made symmetric: corners moved by at most 0.") for note in result.notes)


@pytest.mark.parametrize("sheet", ["100x220", "220x100"])
def test_an_axis_is_folded_however_the_drawing_is_turned_to_have_room(sheet: str) -> None:
    angle = math.radians(60)
    house = np.array([(-8, 0), (8, 0), (8, 30), (0, 40), (-8, 30)])
    turned = house @ [(math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))]
    result = foldcut.fold([turned], sheet, method="mirror", effort="fast", min_crease=0)
    assert result.verified
    size = np.ptp(result.folded_pattern.shape.loops[0], axis=0)
    assert sorted(size.tolist()) == pytest.approx([80, 200])
    assert sum("turned" in note for note in result.notes) == (2 if sheet == "100x220" else 1)


def test_arcs_do_not_cross_and_are_all() -> None:
    for n in range(1, 6):
        found = list(matchings(range(2 * n)))
        assert len(found) == comb(2 * n, n) // (n + 1)  # Catalan's numbers
        for arcs in found:
            assert sorted(end for arc in arcs for end in arc) == list(range(2 * n))
            assert not any(a < c < b < d for a, b in arcs for c, d in arcs)


def laid(loops: list[Points], axes: tuple[int, ...], sheet: str = "a4") -> tuple[Shape, Sheet]:
    """Return a shape, symmetric about axes of the sheet, in the middle of the sheet."""
    on = parse_sheet(sheet)
    shape, _ = place(make_shape(loops), on)
    return symmetric(shape, np.array([on.width, on.height]) / 2, axes)[0], on


def filled(shape: Shape) -> shapely.Geometry:
    area = shapely.Polygon()
    for loop in shape.loops:
        area = area.symmetric_difference(shapely.Polygon(loop))
    return area


def disagreement(half: Half) -> float:
    """Return the area on the half sheet that is inside the whole shape and outside the half's loops, or vice versa."""
    on_half = shapely.box(0, 0, half.sheet.width, half.sheet.height)
    size = np.array([half.sheet.width, half.sheet.height])
    step = -np.where(np.isin([0, 1], half.axes), size, 0.0)
    whole_shape = shapely.affinity.translate(filled(half.shape), *step)
    return float(
        whole_shape.intersection(on_half).symmetric_difference(filled(half.outline).intersection(on_half)).area
    )


BOW: Points = [(-6, 0), (-2, 4), (2, 4), (6, 0), (2, -4), (0, -1), (-2, -4)]
AXES: list[tuple[str, tuple[int, ...]]] = [
    ("letter D", (1,)),
    ("letter B", (1,)),
    ("letter i", (0,)),
    ("eyes", (0,)),
    ("square ring", (0, 1)),
    ("letter O", (0, 1)),
    ("figure 8", (0,)),
    ("figure 8", (1,)),
    ("figure 8", (0, 1)),
    ("equals sign", (0,)),
    ("equals sign", (1,)),
    ("equals sign", (0, 1)),
    ("four dots", (0, 1)),
    ("three rings", (0, 1)),
]


@pytest.mark.parametrize(("name", "axes"), AXES)
def test_loops_of_halves_agree_with_the_shape_on_the_half_sheet(name: str, axes: tuple[int, ...]) -> None:
    shape, sheet = laid(SHAPES[name][0], axes)
    found = list(halves_of(shape, sheet, axes))
    assert len(found) == 2
    for half in found:
        assert half.sheet.width == pytest.approx(sheet.width / (2 if 0 in axes else 1))
        assert half.sheet.height == pytest.approx(sheet.height / (2 if 1 in axes else 1))
        assert invariant_faults(half.outline) == []
        assert disagreement(half) < 1e-6
    # the first goes straight on at the axes: no corner lies on them, and no more loops than needed
    assert all(abs(corner[axis]) > 1e-6 for loop in found[0].loops for corner in loop for axis in axes)
    assert found[0].outline.corner_count <= found[1].outline.corner_count


def test_single_loops_agree_with_the_shape_on_the_half_sheet() -> None:
    shape, sheet = laid([LETTER_D, HOLE_D], (1,), "a5")
    found = list(one_loop_halves(shape, sheet, (1,)))
    assert found
    for half in found:
        assert len(half.loops) == 1
        assert half.sheet.height == pytest.approx(sheet.height / 2)
        assert disagreement(half) < 1e-9


def test_the_disagreement_of_loops_can_be_found() -> None:
    shape, sheet = laid([LETTER_D, HOLE_D], (1,))
    *_, half = halves_of(shape, sheet, (1,))
    assert disagreement(half) < 1e-6
    assert disagreement(Half(shape, half.loops[:-1], half.sheet, half.axes)) > 100
    assert disagreement(Half(shape, tuple(loop + 0.01 for loop in half.loops), half.sheet, half.axes)) > 0.1
    assert disagreement(Half(shape, half.loops, half.sheet, (0,))) > 100


def test_sides_that_meet_beyond_the_border_are_joined_there() -> None:
    # the tip and the notch of a bow: both pairs of sides are chains that run toward each other beyond the axis
    shape, sheet = laid([BOW], (0,))
    half = next(halves_of(shape, sheet, (0,)))
    assert (half.loops[0][:, 0] < 0).sum() >= 1
    assert disagreement(half) < 1e-6
    loops = [np.array(loop) * (100, 60) for loop in ([(-1, 0), (0, 1), (1, 0), (0, -1)],)]
    shape, sheet = laid([[(float(x), float(y)) for x, y in loop] for loop in loops], (0,))
    (loop,) = next(halves_of(shape, sheet, (0,))).loops
    assert len(loop) == 3, "a rhombus cut at its axis: the sides go straight on until they are far away"


@pytest.mark.parametrize("axes", [(0,), (1,), (0, 1)])
@pytest.mark.parametrize(
    "points", [regular(4), regular(6), cross(), rectangle(4, 3)], ids=["square", "hexagon", "cross", "rectangle"]
)
def test_nodes_on_the_axis_end_what_comes_to_them(points: Points, axes: tuple[int, ...]) -> None:
    # all bisectors of the square meet in the middle of the sheet, which is a corner of the quarter sheet
    shape, sheet = laid([points], axes)
    straight_on, whole_loops = (fold_part(half) for half in halves_of(shape, sheet, axes))
    for found in (straight_on, whole_loops):
        assert verify(found.creases, found.folded.layers, shape) == []
    assert lines_beside(straight_on.creases, sheet, axes) == lines_beside(whole_loops.creases, sheet, axes)


@pytest.mark.parametrize(
    ("name", "axes"), [("letter D", (1,)), ("letter i", (0,)), ("eyes", (0,)), ("three rings", (0, 1))]
)
def test_what_lies_beyond_the_border_does_not_matter(name: str, axes: tuple[int, ...]) -> None:
    shape, sheet = laid(SHAPES[name][0], axes)
    folds, shortest = zip(
        *(
            (lines_beside(found.creases, sheet, axes), shortest_crease(found.creases))
            for found in map(fold_part, halves_of(shape, sheet, axes))
        ),
        strict=True,
    )
    assert len(set(folds)) == 1
    assert shortest[0] == pytest.approx(shortest[1])


def test_a_drawing_that_crosses_its_axis_often_has_a_skeleton_but_no_single_loop() -> None:
    # 18 bars across the upright axis, joined on both sides in turn, so that the axis cuts 34 chains
    bars = [[(x, y + d) for x, y in rectangle(10, 1)] for d in range(0, 36, 2)]
    shape, sheet = laid(bars, (0,))
    with pytest.raises(foldcut.UnfoldableError, match="crosses the mirror axis 36 times"):
        list(one_loop_halves(shape, sheet, (0,)))
    found = fold_part(next(halves_of(shape, sheet, (0,))))
    assert verify(found.creases, found.folded.layers, shape) == []


def test_a_loop_off_the_axis_is_refused_by_the_one_and_taken_by_the_other() -> None:
    shape, sheet = laid(SHAPES["eyes"][0], (0,))
    with pytest.raises(foldcut.UnfoldableError, match=r"the loop around \(.*\) mm does not meet the mirror axis"):
        list(one_loop_halves(shape, sheet, (0,)))
    assert len(next(halves_of(shape, sheet, (0,))).loops) == 2


def test_a_half_whose_pattern_would_have_too_many_creases_is_refused() -> None:
    shape, sheet = laid(random_symmetric(4), (0,))
    with pytest.raises(foldcut.UnfoldableError, match="creases"):
        fold_part(next(halves_of(shape, sheet, (0,))))


def test_a_half_becomes_what_the_method_made() -> None:
    shape, sheet = laid(SHAPES["figure 8"][0], (0, 1))
    found = fold_part(next(halves_of(shape, sheet, (0, 1))))
    on = Laid(sheet, shape, AS_IT_IS, (), False, shape, AS_IT_IS)
    made = made_of_half((0, 1), found, on)
    assert made.actions == 2 + crease_numbers(found.part).lines
    assert made.min_crease_mm == 0, "short creases are refused where compact makes them, but not along the skeleton"
    assert [line.tolist() for line in made.first_folds] == [
        [[0, sheet.height / 2], [sheet.width, sheet.height / 2]],
        [[sheet.width / 2, 0], [sheet.width / 2, sheet.height]],
    ]
    assert verify(made.creases, made.folded.layers, shape) == []


def test_corners_are_moved_so_that_creases_meet_on_the_axis() -> None:
    # the bisectors of this star's inner corners miss each other by a hair
    star: Points = [(0, 10), (2.0002, 2), (10.0008, 0), (2.0002, -2), (0, -10), (-2, -2), (-10, 0), (-2, 2)]
    result = fold([star])
    assert result.actions <= 5
    assert result.foldability.shortest_crease_mm > 50
    exact = fold([star], adjust=0.0)
    assert exact.actions > result.actions or exact.foldability.shortest_crease_mm < 1


@pytest.mark.parametrize("sheet", ["a3", "a6", "500x300"])
def test_other_sheets_take_as_many_folds(sheet: str) -> None:
    result = foldcut.fold(SHAPES["letter B"][0], sheet, method="mirror", effort="fast", min_crease=0)
    assert result.findings == ()
    assert result.actions <= SHAPES["letter B"][1] + 2
    assert result.folded_pattern.first_folds[0].max() <= max(
        result.folded_pattern.sheet.width, result.folded_pattern.sheet.height
    )


def test_where_the_half_has_few_folds_the_whole_sheet_is_not_searched() -> None:
    result = foldcut.fold(sample_path("tree"), effort="fast")
    assert [attempt.method for attempt in result.attempts] == ["mirror"]
    assert (result.method, result.actions) == ("mirror", 8)
    short = foldcut.fold(sample_path("letter-a"), effort="fast")
    assert [attempt.method for attempt in short.attempts][:2] == ["mirror", "skeleton"], "its creases are short"


def random_symmetric(seed: int) -> list[Points]:
    """A shape that is symmetric about x = 0: up to 10 corners on a side, and up to two holes across the axis."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 9))
    angles = np.sort(rng.uniform(-0.45 * np.pi, 0.45 * np.pi, count))
    radius = rng.uniform(0.6, 1.0, count)
    right = np.column_stack([radius * np.cos(angles), radius * np.sin(angles)])
    loops = [np.concatenate([right, right[::-1] * (-1, 1)])]
    holes = int(rng.integers(0, 3))
    middle = loops[0][:, 1].mean()
    for k in range(holes):
        size = rng.uniform(0.04, 0.1)
        at = middle + (k - (holes - 1) / 2) * 0.28
        hole = [(size, at - size), (size * rng.uniform(0.6, 1.4), at + size)]
        loops.append(np.array([*hole, *((-x, y) for x, y in hole[::-1])]))
    return [[(float(x), float(y)) for x, y in loop] for loop in loops]


@pytest.mark.parametrize("seed", range(12))
def test_random_symmetric_shapes_are_verified(seed: int) -> None:
    loops = random_symmetric(seed)
    try:
        make_shape(loops)
    except foldcut.ShapeError:
        pytest.skip("loops touch")
    assert fold(loops).findings == ()


def test_ctrl_c_in_the_search_by_compact_keeps_the_best_so_far(monkeypatch: pytest.MonkeyPatch) -> None:
    real = search.fold_compact
    calls = []

    def interrupted(*args: object, **options: object) -> object:
        calls.append(args)
        if len(calls) > 1:
            raise KeyboardInterrupt
        return real(*args, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(search, "fold_compact", interrupted)
    shape, sheet = laid([cross()], (0, 1))
    halves = list(one_loop_halves(shape, sheet, (0, 1)))
    made = search.fold_mirrored(halves, effort="fast")
    assert made.found.interrupted
    assert verify(made.creases, made.folded.layers, shape) == []
    with pytest.raises(KeyboardInterrupt):
        search.fold_mirrored(halves, effort="fast")


def test_ctrl_c_in_the_search_along_the_skeleton_keeps_the_best_so_far(monkeypatch: pytest.MonkeyPatch) -> None:
    real = Search.attempt
    made = []

    def interrupted(self: Search, *args: object) -> object:
        if made:
            raise KeyboardInterrupt
        trial = real(self, *args)  # type: ignore[arg-type]
        made.extend([trial] if trial.made else [])
        return trial

    monkeypatch.setattr(Search, "attempt", interrupted)
    result = foldcut.fold([LETTER_D, HOLE_D], effort="fast", min_crease=0)
    assert result.findings == ()
    assert [attempt.method for attempt in result.attempts] == ["mirror"], "no other method is tried after Ctrl-C"
    with pytest.raises(KeyboardInterrupt):
        foldcut.fold([LETTER_D, HOLE_D], method="mirror", effort="fast")


@pytest.mark.parametrize(("points", "most"), [(regular(3), 4), (regular(4), 8), (cross(), 100)])
def test_single_loops_of_halves_fold_by_compact(points: Points, most: int) -> None:
    axes = (1,) if len(points) == 3 else (0, 1)
    shape, sheet = laid([points], axes)
    made = search.fold_mirrored(list(one_loop_halves(shape, sheet, axes)), effort="fast")
    assert verify(made.creases, made.folded.layers, shape) == []
    assert made.creases.crease_count <= most
    assert len(made.regions) > 1


@pytest.mark.parametrize(("points", "most"), [(regular(3), 4), (regular(4), 8), (cross(), 24)])
def test_simple_shapes_are_as_simple_as_they_can_be(points: Points, most: int) -> None:
    assert fold([points]).folded_pattern.creases.crease_count <= most


def test_a_side_goes_on_as_far_beyond_the_border_as_asked_but_a_flat_one_no_more_than_three_times_that() -> None:
    end = np.array([0.0, 10.0])
    for before, beyond in (
        ((3.0, 6.0), (-6.0, 18.0)),  # 6 mm beyond the upright axis
        ((2.0, 10.0), (-6.0, 10.0)),
        ((6.0, 2.0), (-6.0, 18.0)),
        ((0.3, 6.0), (-18 * 0.3 / np.hypot(0.3, 4), 10 + 18 * 4 / np.hypot(0.3, 4))),
    ):
        assert np.allclose(extended(np.array(before), end, (0,), 6.0), beyond)
        turned = extended(np.array(before[::-1]), end[::-1], (1,), 6.0)
        assert np.allclose(turned, beyond[::-1])
    assert np.allclose(extended(np.array([4.0, 6.0]), np.array([10.0, 0.0]), (0, 1), 6.0), (16.0, -6.0))
