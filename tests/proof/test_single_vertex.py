"""docs/assignment.md as a runnable proof: at a corner on the shape's boundary the paper's rule cannot fold flat."""

from __future__ import annotations

from itertools import product

import pytest
from support.single_vertex import folds_flat

# The shape's edge runs straight through the vertex. Inside molecules have angles 70 and 110 there, outside ones 80
# and 100; creases in cyclic order: bisector, side, bisector (inside), bisector, side, bisector (outside).
SECTORS = [70 / 2, 110 / 2, (110 + 80) / 2, 80 / 2, 100 / 2, (100 + 70) / 2]


@pytest.mark.parametrize("creases", ["MVMVVV", "MMMVMV"])
def test_the_papers_rule_has_no_layer_order_at_a_boundary_corner(creases: str) -> None:
    assert abs(creases.count("M") - creases.count("V")) == 2, "Maekawa holds, which proves nothing"
    assert sum(SECTORS[::2]) == sum(SECTORS[1::2]) == 180, "so does Kawasaki"
    assert not folds_flat(SECTORS, creases)


def test_mountain_bisectors_on_both_sides_fold_flat() -> None:
    assert folds_flat(SECTORS, "MVMMVM")


def test_the_papers_rule_is_not_among_the_assignments_that_fold() -> None:
    foldable = {"".join(kinds) for kinds in product("MV", repeat=6) if folds_flat(SECTORS, kinds)}
    assert foldable == {"MVMMVM", "MVMVMM", "MVVMVV", "MVVVMV", "VMMMVM", "VMMVMM", "VMVMVV", "VMVVMV"}


def test_the_oracle_knows_the_big_little_big_lemma() -> None:
    # The creases on either side of a sector smaller than both its neighbours are a mountain and a valley.
    foldable = {"".join(kinds) for kinds in product("MV", repeat=4) if folds_flat([60, 90, 120, 90], kinds)}
    assert foldable == {"MVMM", "MVVV", "VMMM", "VMVV"}


@pytest.mark.parametrize("wedges", [(90, 90, 90, 90), (70, 100, 80, 110), (40, 120, 50, 150)])
def test_where_two_loops_share_a_corner_one_fold_encloses_a_whole_loop(wedges: tuple[float, ...]) -> None:
    # Four edges on the cut line, inside and outside in turn, and each of the four wedges folds along its bisector.
    sectors = [(one + other) / 2 for one, other in zip(wedges, wedges[1:] + wedges[:1], strict=True)]
    foldable = {"".join(kinds) for kinds in product("MV", repeat=4) if folds_flat(sectors, kinds)}
    assert foldable
    # The one that differs from the other three lies around the two sectors that it does not join: the ends of a loop.
    assert all(sorted((kinds.count("M"), kinds.count("V"))) == [1, 3] for kinds in foldable)
