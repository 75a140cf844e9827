"""The method ``simple``: which drawings are cut after simple folds alone, and that paper can be folded so."""

from __future__ import annotations

import numpy as np
import pytest
from support.folded import folded_sample
from support.strategies import rectangle, regular, star

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Sheet
from foldcut.drawing.shape import make_shape
from foldcut.folding_steps import folding_steps
from foldcut.methods.simple.search import sequences
from foldcut.pipeline import Result, fold
from foldcut.samples import sample_path

SAMPLES = {"star": 4, "square": 2, "hexagon": 3, "plus": 4, "kite": 2, "ring": 3, "two-triangles": 3}
"""Samples that simple folds cut out, and how many these are."""


def simple(name: str) -> Result:
    """Fold a sample as it is."""
    return fold(sample_path(name), "a4", method="simple", exact=True)


@pytest.mark.parametrize("name", SAMPLES)
def test_a_sample_is_cut_after_simple_folds_alone(name: str) -> None:
    result = simple(name)
    assert result.verified
    assert result.actions == SAMPLES[name]
    assert all(step.line is not None for step in folding_steps(result.folded_pattern))


@pytest.mark.parametrize("corners", [3, 5, 7, 10, 12])
def test_regular_polygons_need_no_more_folds_than_halving_their_sides(corners: int) -> None:
    result = fold([regular(corners)], "a4", method="simple", exact=True)
    assert result.verified
    assert 2 ** (result.actions - 1) < corners <= 2**result.actions


@pytest.mark.parametrize("points", [5, 6, 8])
def test_a_drawing_with_few_digits_is_made_exactly_symmetric(points: int) -> None:
    z = np.array(star(points, 0.45)) @ (1, 1j) * np.exp(0.3j)
    rounded = [(round(x.real, 2), round(x.imag, 2)) for x in z.tolist()]
    with pytest.raises(UnfoldableError):
        fold([rounded], "a4", method="simple", exact=True)
    result = fold([rounded], "a4", method="simple", symmetry=3.0)
    assert result.verified
    assert result.foldability.shortest_crease_mm > 10
    (note,) = result.notes
    assert note.startswith("made symmetric: corners moved by at most")


@pytest.mark.parametrize("lean", [1e-7, 1e-3, 2.0])
def test_sides_that_are_nearly_parallel_are_laid_on_each_other(lean: float) -> None:
    shape = make_shape([[(30, 30), (110, 30), (110 - lean, 90), (30 + lean, 90)]])
    found = sequences(shape, Sheet(140, 120))
    first = found[0][0][0]
    assert np.abs(first.off(np.array([[70, 0], [70, 120]]))).max() < 1e-6
    assert len(found[0][0]) == 3


def test_what_stops_the_folds_is_said_with_its_corner() -> None:
    shape = make_shape([[(20, 20), (80, 20), (60, 50), (30, 70)]])
    with pytest.raises(UnfoldableError, match=r"no straight fold .* at the corner at \(\d+, \d+\) mm"):
        sequences(shape, Sheet(100, 100))


@pytest.mark.parametrize(("name", "folds"), [("arrow", 2), ("tree", 4), ("heart", 1), ("letter-t", 2)])
def test_no_fold_lays_a_side_on_blank_paper(name: str, folds: int) -> None:
    pattern = folded_sample(name, method="mirror")
    with pytest.raises(UnfoldableError, match=f"^after {folds} simple fold"):
        sequences(pattern.shape, pattern.sheet)


def test_a_symmetric_drawing_off_the_middle_is_folded_off_the_middle() -> None:
    result = fold([rectangle(30, 20)], "a4", method="simple", exact=True, offset=(31.0, 57.0), scale=1.0)
    assert result.verified
