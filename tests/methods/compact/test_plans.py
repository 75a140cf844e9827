"""Plans: which pockets are turned, and where the root is."""

from __future__ import annotations

import numpy as np
import pytest
from support.compact import loop_of
from support.strategies import regular, star

from foldcut.methods.compact.outline import Outline
from foldcut.methods.compact.plans import Plan, neighbours, plans


@pytest.fixture(scope="module")
def five() -> Outline:
    return Outline(loop_of(star(5, 0.4)))


def test_a_convex_shape_has_a_plan_for_each_side_and_corner() -> None:
    hexagon = Outline(loop_of(regular(6)))
    found = list(plans(hexagon, turned=False))
    roots = sorted((plan.root, plan.at_corner) for plan in found)
    assert roots == [(n, corner) for n in range(6) for corner in (False, True)]
    assert hexagon.pocket_bits == []
    assert not list(neighbours(hexagon, found[0]))


def test_reflex_corners_of_turned_pockets_are_dips(five: Outline) -> None:
    assert five.pocket_bits == [1, 2, 4, 8, 16]
    root = int(np.flatnonzero(~five.reflex)[0])
    assert Plan.make(five, 31, root, at_corner=False, careful=True) is None, "a dip beside the root"
    plan = Plan.make(five, 31, int(np.flatnonzero(five.reflex)[0]), at_corner=True, careful=True)
    assert plan is not None
    assert (plan.crests == ~five.reflex).all()
    turns = plan.turns()
    assert len(turns) == 10
    assert (turns.crest == (np.arange(10) % 2 == 1)).all()


def test_neighbours_differ_in_one_pocket(five: Outline) -> None:
    plan = next(plans(five, turned=False))
    others = list(neighbours(five, plan))
    assert others
    assert all(other.turned in five.pocket_bits for other in others)
    assert len({other.choices for other in others}) == len(others)
    back = {one.choices for one in neighbours(five, others[0])}
    assert plan.choices in back


def test_turned_plans_turn_all_pockets_or_one(five: Outline) -> None:
    assert {plan.turned for plan in plans(five, turned=True)} == {31, 1, 2, 4, 8, 16}
