"""No pattern has fewer folds than the lower bound, and where a pattern has no more, nothing else is tried."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support.strategies import Points, cross, rectangle, regular, star, star_shaped

import foldcut
from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Sheet
from foldcut.drawing.placement import Layout, parse_sheet
from foldcut.drawing.shape import make_shape
from foldcut.methods.fewest_folds import Fewest, fewest_folds
from foldcut.samples import sample_path

ISOSCELES = [(0.0, 0.0), (60.0, 0.0), (30.0, 50.0)]
KITE = [(0.0, 0.0), (30.0, -20.0), (80.0, 0.0), (30.0, 20.0)]
TANGENTIAL = [(3.0, 0.0), (0.0, 4.0), (-3.0, 0.0), (0.0, -4.0)]
SHAPES: dict[str, Points] = {
    "square": rectangle(5, 5),
    "rectangle": rectangle(9, 5),
    "cross": cross(),
    "isosceles triangle": ISOSCELES,
    "kite": KITE,
    "rhombus": TANGENTIAL,
    "regular pentagon": regular(5),
    "regular hexagon": regular(6),
    "star of four": star(4, 0.4),
    "star of six": star(6, 0.5),
    **{f"random {n}": star_shaped(np.random.default_rng(n), n) for n in (3, 4, 5, 6)},
}
LEAST = {"square": 2, "rectangle": 3, "isosceles triangle": 2, "kite": 2, "rhombus": 2, "regular hexagon": 3}


def fewest(*loops: Points, near: float = 0.0, margin: float = 10.0) -> Fewest:
    sheet, placed, *_ = Layout(parse_sheet("a4"), margin).place(make_shape(loops))
    return fewest_folds(placed, sheet, near)


@pytest.mark.parametrize("name", SHAPES)
def test_no_method_folds_with_less(name: str) -> None:
    least = fewest(SHAPES[name])
    assert least.folds >= 2
    assert fewest(SHAPES[name], near=0.05).folds <= least.folds
    for method in ("mirror", "skeleton", "compact"):
        try:
            result = foldcut.fold([SHAPES[name]], method=method, seconds=0.3, min_crease=0, adjust=0)
        except UnfoldableError:
            continue
        assert result.actions >= least.folds


@pytest.mark.parametrize("name", LEAST)
def test_the_bound_of_simple_shapes_is_what_they_need(name: str) -> None:
    assert fewest(SHAPES[name]).folds == LEAST[name]
    assert foldcut.fold([SHAPES[name]], effort="fast").actions == LEAST[name]


@pytest.mark.parametrize(("name", "folds"), [("star", 5), ("hexagon", 3), ("square", 2)])
def test_a_pattern_with_the_fewest_folds_ends_the_search(
    name: str, folds: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    def none(*_: object) -> None:
        raise UnfoldableError("no simple folds")

    monkeypatch.setattr("foldcut.methods.simple.method.sequences", none)  # they come before
    result = foldcut.fold(sample_path(name), effort="best")
    assert [(attempt.method, attempt.actions) for attempt in result.attempts] == [("skeleton", folds)]
    assert result.findings == ()
    others = foldcut.fold(sample_path(name), effort="fast", method="skeleton")
    assert np.array_equal(result.folded_pattern.creases.vertices_coords, others.folded_pattern.creases.vertices_coords)


def test_other_drawings_are_tried_by_every_method() -> None:
    # neither is symmetric, and ridges meet by threes
    hole = [(x + 1.2, y + 0.4) for x, y in rectangle(5, 5)]
    for shape in ([[(0.0, 0.0), (9.0, 0.0), (8.0, 5.0), (0.5, 4.0)]], [rectangle(10, 10), hole]):
        result = foldcut.fold(shape, seconds=0.1)
        assert [attempt.method for attempt in result.attempts] == ["mirror", "skeleton", "compact"]


def test_a_ribbon_that_creases_meet_within_is_kept() -> None:
    # the square's diagonals meet 95 mm from its sides, the ridges outside nowhere
    assert foldcut.fold([rectangle(5, 5)], effort="fast", ribbon=94).attempts[0].method == "simple"
    for method in ("simple", "skeleton"):
        with pytest.raises(UnfoldableError, match="within the ribbon"):
            foldcut.fold([rectangle(5, 5)], effort="fast", ribbon=96, method=method)


def test_bisectors_of_opposite_corners_are_one_line_also_in_rounded_numbers() -> None:
    rounded = [(round(100 * x, 2), round(100 * y, 2)) for x, y in star(5, 0.4)]
    assert fewest(rounded, near=0.05) == Fewest(5, 5, 10)
    assert fewest(rounded).bisectors > 5


def test_corners_at_the_border_of_the_sheet_and_flat_ones_need_not_be_folded() -> None:
    shape = make_shape([rectangle(100, 50)])
    sheet = Sheet(300, 200)
    assert fewest_folds(Layout(sheet, 0, 1.0).place(shape)[1], sheet).folds == 3
    assert fewest_folds(shape, Sheet(300, 200)).folds == 0, "one corner is the sheet's"
    bent = [(0.0, 0.0), (100.0, 0.0), (100.01, 20.0), (100.0, 50.0), (0.0, 50.0)]
    assert (fewest(bent).folds, fewest(bent, near=0.05).folds) == (5, 4)


BISECTED = [(0.0, 0.0), (2.0, -2.0), (9.0, -1.0), (10.0, 0.0), (8.0, 2.0), (3.0, 3.0)]
COMB = [(0.0, 0.0), (12.0, -3.0), (10.0, 5.0), (8.0, 3.0), (7.5, 5.0), (5.0, 2.0), (3.0, 5.0), (2.0, 1.0), (1.0, 5.0)]
NOTCHED = [(0.0, 0.0), (11.0, -1.0), (10.0, 5.0), (7.0, 5.0), (6.0, 3.3), (3.0, 2.0), (2.5, 5.0), (-0.3, 5.0)]


@pytest.mark.parametrize(
    ("shape", "most"),
    [
        pytest.param(BISECTED, 2, id="one line halves two corners"),
        pytest.param(COMB, 2, id="one line passes through four tips, half of their creases on it"),
        pytest.param(NOTCHED, 1, id="one line goes along two sides: four corners count one"),
    ],
)
def test_corners_on_a_line_share_it(shape: Points, most: float) -> None:
    assert fewest(shape).folds == -(-len(shape) // most)
    turned = [(0.6 * x - 0.8 * y, 0.8 * x + 0.6 * y) for x, y in shape]
    assert fewest(turned).folds == fewest(shape[3:] + shape[:3]).folds == fewest(shape).folds


def test_two_mirror_axes_leave_a_quarter_of_the_corners() -> None:
    quarter = [(6.0, 1.3), (4.1, 3.7)]
    octagon = [*quarter, *((-x, y) for x, y in quarter[::-1])]
    octagon += [(-x, -y) for x, y in octagon]
    assert fewest(octagon).folds == 4


def test_a_wedge_counts_where_it_may_save_folds() -> None:
    heptagram = [
        (math.cos(k * math.pi / 7) * (1.0, 0.5)[k % 2], math.sin(k * math.pi / 7) * (1.0, 0.5)[k % 2])
        for k in range(14)
    ]
    result = foldcut.fold([heptagram], method="mirror", effort="fast")
    assert (result.method, result.findings) == ("mirror", ())
    assert result.actions <= 5
    assert len(result.folded_pattern.first_folds) == 7
