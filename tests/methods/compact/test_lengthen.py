"""Short creases are lengthened, or sent through zero."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy import linalg
from support.compact import A4, covered, loop_of
from support.strategies import Points, two_opt

from foldcut.core.model import CreasePattern
from foldcut.methods.compact.lengthen import Mover, null_space
from foldcut.methods.compact.pattern import Molecules, build_molecules, fold_molecules
from foldcut.methods.compact.sensitivity import vertex_slopes
from foldcut.methods.compact.turns import Solution


def mover_of(points: Points) -> tuple[Mover, Callable[[Solution], tuple[Molecules, CreasePattern]]]:
    outline, _, solution = covered(loop_of(points))

    def folded(some: Solution) -> tuple[Molecules, CreasePattern]:
        molecules = build_molecules(some.walk(outline), A4)
        return molecules, fold_molecules(molecules, A4)[0]

    return Mover(outline, solution, folded, lambda creases: creases.edges_assignment != "B"), folded


def test_short_creases_are_made_longer() -> None:
    # this swan has a crease of 0.006 mm at first
    mover, _ = mover_of(two_opt(np.random.default_rng(3), 12))
    before = mover.lengths()[0]
    assert mover.lengthen(3.3)
    assert mover.lengths()[0] > 1.5 * before


def test_a_shortest_crease_goes_through_zero() -> None:
    mover, folded = mover_of(two_opt(np.random.default_rng(3), 12))
    for _ in range(4):
        mover.lengthen(3.3)
    number = len(mover.lengths())
    others = list(mover.across(3.3))
    assert others
    # not merely moved: with events in another order there are other creases, or others are the shortest
    edges = [folded(other.solution)[1].edges_vertices.tolist() for other in others]
    assert folded(mover.solution)[1].edges_vertices.tolist() not in edges
    assert all(abs(len(other.lengths()) - number) < 20 for other in others)


@pytest.mark.parametrize("seed", [3, 5, 11])
def test_slopes_of_vertices_are_what_differences_say(seed: int) -> None:
    mover, folded = mover_of(two_opt(np.random.default_rng(seed), 12))
    molecules, _ = folded(mover.solution)
    images = mover.basis
    program, solution = mover.program, mover.solution
    along = program.walked[:, : len(solution.x)] @ images
    direction = program.outline.direction[solution.turns.side]
    slopes = vertex_slopes(molecules, direction[:, :, None] * along[:, None], images)
    # where creases end beyond the sheet is left open
    on_sheet = (np.abs(np.array(molecules.vertices.flat) - A4.corners.mean(axis=0)) < A4.corners[2] / 2 + 1e-6).all(
        axis=1
    )
    step = 1e-7
    compared = 0
    for column in range(images.shape[1]):
        there, back = (folded(mover.moved(way * images[:, column]))[0].vertices for way in (step, -step))
        if len(there.flat) == len(molecules.vertices.flat) == len(back.flat):
            difference = (np.array(there.flat) - np.array(back.flat)) / (2 * step)
            same = on_sheet & (np.abs(difference).max(axis=1) < 1e3)  # events in another order number them otherwise
            assert same.sum() > 0.9 * on_sheet.sum()
            assert slopes[same, :, column] == pytest.approx(difference[same], rel=1e-3, abs=1e-3)
            compared += 1
    assert compared > images.shape[1] / 2


def test_null_space_is_scipys() -> None:
    matrix = np.random.default_rng(8).normal(size=(4, 9))
    matrix[3] = matrix[0] + matrix[1]
    ours, theirs = null_space(matrix), linalg.null_space(matrix)
    assert ours.shape == theirs.shape == (9, 6)
    assert np.allclose(ours @ ours.T, theirs @ theirs.T)
