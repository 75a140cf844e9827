"""Rows of figures: parallel folds first, and the rest of the last piece through all layers."""

from __future__ import annotations

import numpy as np
import pytest
from support.strategies import Points

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.drawing.shape import make_shape
from foldcut.folding_steps import folding_steps
from foldcut.methods.simple.chain import Chain, chain_of, fold_chain
from foldcut.pipeline import fold
from foldcut.proof.verify import verify
from foldcut.samples import sample_path

SHEET = Sheet(297, 210)


def row(figures: int, *, upright: bool = False, digits: int = 9) -> Points:
    """Return figures with arms of 10 mm, joined at their hands, in a row around the middle of a sheet."""
    middle = [(36.0 * k + 148.5 - 18 * (figures - 1), 100.0) for k in range(figures)]
    left, right = middle[0][0] - 18, middle[-1][0] + 18
    over = [(x + dx, y + dy) for x, y in middle for dx, dy in ((-8, 6), (0, 14), (8, 6))]
    under = [(x + dx, y + dy) for x, y in middle[::-1] for dx, dy in ((6, -4), (12, -28), (-12, -28), (-6, -4))]
    loop = [(left, 106.0), *over, (right, 106.0), (right + 3, 101.0), (right, 96.0), *under, (left, 96.0)]
    points = np.array([*loop, (left - 3, 101.0)])
    if upright:
        points = points[:, ::-1] - (0.0, 43.5)
    turned = points.round(digits)
    return [(float(x), float(y)) for x, y in turned]


def folded(shape: Shape, sheet: Sheet) -> tuple[Chain, int]:
    """Return a chain whose pattern is verified, and how many folds it takes."""
    chain = chain_of(shape, sheet)
    made = fold_chain(chain, ribbon=0.0, seconds=1.0)
    assert verify(made.creases, made.folded.layers, chain.drawn) == []
    return chain, made.actions


def test_the_sample_is_folded_in_half_and_twice_more_before_anything_else() -> None:
    result = fold(sample_path("paper-chain"), "a4", exact=True)
    assert result.verified
    assert (result.method, result.actions) == ("simple", 12)
    first = folding_steps(result.folded_pattern)[:3]
    lines = [step.line for step in first if step.line is not None]
    assert len(lines) == 3
    assert all(abs(line[0, 0] - line[1, 0]) < 1e-6 for line in lines)
    assert sum(phase.count for phase in result.phases) == result.actions


@pytest.mark.parametrize(("figures", "folds"), [(2, 2), (3, 3), (4, 3)])
def test_more_figures_take_no_more_folds_than_halving_them(figures: int, folds: int) -> None:
    chain, actions = folded(make_shape([row(figures)]), SHEET)
    assert (chain.axis, len(chain.folds)) == (0, folds)
    assert actions == folded(make_shape([row(2)]), SHEET)[1] + folds - 2


def test_a_row_may_stand_upright() -> None:
    chain, _ = folded(make_shape([row(3, upright=True)]), Sheet(210, 210))
    assert (chain.axis, len(chain.folds)) == (1, 3)


@pytest.mark.parametrize("x", [50.1, 60.1, 70.1])
def test_figures_without_an_axis_of_their_own_are_made_exact_mirror_images(x: float) -> None:
    figure = np.array([(-11 * 2**0.5, -7 * 3**0.5), (5 * 5**0.5, -4 * 2**0.5), (-3 * 3**0.5, 9 * 5**0.5)])
    loops = [figure * (1 - k % 2 * 2, 1) + (x + 45 * k, 90) for k in range(4)]
    loops[1][1] += (3e-5, 6e-5)
    shape = make_shape(loops)
    chain, _ = folded(shape, Sheet(255, 190))
    assert (len(chain.folds), chain.turned) == (2, x > 60)
    moved = np.concatenate(chain.drawn.loops) - np.concatenate(shape.loops)
    assert 5e-5 < np.abs(moved).max() < 1e-4


def test_one_figure_is_no_row() -> None:
    with pytest.raises(UnfoldableError, match="no row of figures"):
        chain_of(make_shape([row(1)]), SHEET)
