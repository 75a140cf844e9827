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
from foldcut.drawing.placement import parse_sheet, place
from foldcut.drawing.shape import make_shape
from foldcut.methods.mirror import search
from foldcut.methods.mirror.halves import extended, halves, matchings
from foldcut.methods.mirror.search import Mirrored
from foldcut.proof.verify import verify
from foldcut.samples import sample_path

LETTER_D: Points = [(0, 0), (4, 0), (6, 2), (6, 5), (4, 7), (0, 7)]
HOLE_D: Points = [(1.5, 1.5), (3.5, 1.5), (4.5, 2.5), (4.5, 4.5), (3.5, 5.5), (1.5, 5.5)]

SHAPES: dict[str, tuple[list[Points], int]] = {
    # loops, and the most creases that are allowed with fast effort
    "square ring": ([rectangle(10, 10), rectangle(5, 5)], 80),
    "letter O": ([regular(8), [(0.5 * x, 0.5 * y) for x, y in regular(8)]], 120),
    "letter D": ([LETTER_D, HOLE_D], 350),
    "figure 8": ([rectangle(6, 10), *([(x, y + d) for x, y in rectangle(3, 3)] for d in (-2.25, 2.25))], 550),
    "letter B": ([[(0, -5), (4, -5), (5, -4), (5, -1), (4, 0), (5, 1), (5, 4), (4, 5), (0, 5)]], 120),
    "three rings": ([rectangle(s, s) for s in (12, 8, 4)], 1100),
    "equals sign": ([[(x, y + d) for x, y in rectangle(10, 2)] for d in (-3, 3)], 120),
    "colon, level": ([[(x + d, y) for x, y in rectangle(2, 2)] for d in (-3, 3)], 60),
    "four dots": ([[(x + d, y + e) for x, y in rectangle(2, 2)] for d in (-3, 3) for e in (-3, 3)], 60),
    "letter i": ([[(-1, 0), (1, 0), (1, 6), (-1, 6)], [(-1, 8), (1, 8), (1, 10), (-1, 10)]], 120),
}


def fold(loops: list[Points], **options: object) -> foldcut.Result:
    return foldcut.fold(loops, method="mirror", effort="fast", min_crease=0, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", sorted(SHAPES))
def test_symmetric_shapes_are_verified_and_have_few_creases(name: str) -> None:
    loops, most = SHAPES[name]
    result = fold(loops)
    assert result.findings == ()
    assert result.folded_pattern.creases.crease_count <= most
    assert len(result.folded_pattern.first_folds) >= 1


@pytest.mark.parametrize("name", ["ring", "letter-a", "two-triangles"])
def test_samples_with_several_loops_are_verified(name: str) -> None:
    result = foldcut.fold(sample_path(name), method="mirror", effort="fast")
    assert result.findings == ()
    assert result.folded_pattern.creases.crease_count <= 250


def test_a_square_ring_takes_a_handful_of_folds() -> None:
    result = fold(SHAPES["square ring"][0])
    assert result.actions <= 8
    assert len(result.folded_pattern.first_folds) == 2


def test_a_symmetric_shape_of_one_loop_takes_fewer_folds_than_without_its_axis() -> None:
    mirrored = fold([cross()])
    compact = foldcut.fold([cross()], method="compact", effort="fast", min_crease=0)
    assert mirrored.actions <= 8
    assert compact.actions >= 4 * mirrored.actions
    auto = foldcut.fold([cross()], effort="fast")
    assert (auto.method, auto.actions) == ("mirror", mirrored.actions)
    assert [attempt.method for attempt in auto.attempts] == ["skeleton", "mirror", "compact"]
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
    result = fold(SHAPES["letter D"][0])
    assert isinstance(result.stages, Mirrored)
    creases, folded = result.stages.creases, result.stages.folded
    shape = result.folded_pattern.shape
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
        (
            [rectangle(12, 7), *([(s * x, y) for x, y in [(2, 1), (4, 2), (2, 2.5)]] for s in (-1, 1))],
            {},
            r"the loop around \(.*\) mm does not meet the mirror axis",
        ),
        ([cross()], {"offset": (20.0, 20.0), "scale": 20.0}, "not in the middle of the sheet"),
        ([regular(3)], {"rotation": 17.0}, "no mirror axis of the drawing lies along the sheet"),
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
    _, mirror_failure, compact_failure = [attempt.failure for attempt in result.attempts]
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


def test_halves_are_loops_that_agree_with_the_shape_on_the_half_sheet() -> None:
    sheet = parse_sheet("a5")
    shape, _ = place(make_shape([LETTER_D, HOLE_D]), sheet)
    drawn = shapely.Polygon(shape.loops[0], [shape.loops[1]])
    found = list(halves(shape, sheet, (1,)))
    assert found
    for half in found:
        assert half.sheet.height == pytest.approx(sheet.height / 2)
        on_half = shapely.box(0, 0, half.sheet.width, half.sheet.height)
        part = shapely.affinity.translate(drawn, 0, -sheet.height / 2).intersection(on_half)
        assert shapely.Polygon(half.loop).intersection(on_half).symmetric_difference(part).area < 1e-9


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


def test_ctrl_c_keeps_the_best_so_far(monkeypatch: pytest.MonkeyPatch) -> None:
    real = search.fold_compact
    calls = []

    def interrupted(*args: object, **options: object) -> object:
        calls.append(args)
        if len(calls) > 1:
            raise KeyboardInterrupt
        return real(*args, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(search, "fold_compact", interrupted)
    result = foldcut.fold([cross()], effort="fast", min_crease=0)
    assert result.findings == ()
    assert isinstance(result.stages, Mirrored)
    assert result.stages.found.interrupted
    assert [attempt.method for attempt in result.attempts] == ["skeleton", "mirror"], (
        "no other method is tried after Ctrl-C"
    )
    calls.append(())
    monkeypatch.setattr(search, "along_skeletons", lambda *_: iter(()))
    with pytest.raises(KeyboardInterrupt):
        foldcut.fold([cross()], method="mirror", effort="fast")


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
