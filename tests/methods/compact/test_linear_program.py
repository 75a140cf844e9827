"""Turns, and the linear program that places them."""

from __future__ import annotations

import numpy as np
import pytest
from support.compact import covered, loop_of, plain_turns
from support.strategies import rectangle, regular, star, star_shaped

from foldcut.geometry.wavefront import corner_lives, side_nodes
from foldcut.methods.compact.cover import under_nodes
from foldcut.methods.compact.linear_program import Program
from foldcut.methods.compact.outline import Outline
from foldcut.methods.compact.pairs import Pairs, later_pairs, sees_each_other, tree_paths, visible_pairs
from foldcut.methods.compact.turns import Solution, Turns


@pytest.mark.parametrize("seed", range(4))
def test_turns_are_added_until_nothing_is_left_out(seed: int) -> None:
    outline, program, solution = covered(loop_of(star_shaped(np.random.default_rng(seed), 10 + 5 * seed)))
    assert program.true_clearance(solution) > 0.01
    step = np.abs(solution.x - np.roll(solution.x, -1))
    assert np.allclose(np.bincount(solution.turns.side, step), outline.length)
    assert (solution.x >= -1e-9).all()
    assert solution.x[0] == pytest.approx(0, abs=1e-9)
    assert (solution.turns.crest == (np.arange(len(step)) % 2 == 1)).all()


def test_a_narrow_bar_needs_more_turns_only_where_it_bends() -> None:
    assert len(covered(loop_of(rectangle(20, 1)), clearance=0.0005)[2].turns) == 8


def test_what_was_added_can_be_taken_away() -> None:
    turns = plain_turns(loop_of(regular(5)))
    more = turns.inserted(1)
    assert len(more) == len(turns) + 2
    fewer = more.removed(2)
    assert np.array_equal(fewer.side, turns.side)
    assert np.array_equal(fewer.crest, turns.crest)


def test_turns_in_a_pocket_that_is_turned_are_a_fan() -> None:
    outline = Outline(loop_of(star(5, 0.4)))
    crests = ~outline.reflex
    turns = Turns.build(crests, int(np.flatnonzero(outline.reflex)[0]), at_corner=True, turned=31, careful=False)
    program = Program(outline, turns)
    solution = program.solve(program.evenly(), clearance=0.01)
    assert solution is not None
    assert not solution.left_out.any()
    assert len(turns) == 10


def test_turns_see_each_other_inside_or_outside_or_not_at_all() -> None:
    c = np.array([(0, 0), (6, 0), (6, 1), (1, 1), (1, 2), (6, 2), (6, 3), (0, 3)], dtype=float)
    turns = Turns(np.arange(8), np.ones(8, dtype=bool), np.ones(8, dtype=bool))
    i, j = np.array([0, 1, 2, 2, 3]), np.array([3, 6, 5, 4, 7])
    inside, outside = sees_each_other(Outline(c), c, turns, i, j)
    assert inside.tolist() == [True, False, False, False, True]
    assert outside.tolist() == [False, False, True, True, False]


@pytest.mark.parametrize("turned", [False, True])
def test_paths_turn_back_at_the_lowest_turn_between_or_the_highest_in_a_turned_pocket(turned: bool) -> None:
    x = np.array([0.0, 5.0, 1.0, 4.0, 2.0, 6.0])
    i, j = np.array([1, 3, 2]), np.array([3, 5, 4])
    pairs = Pairs(i, j, np.full(3, turned), np.ones(3), np.zeros((3, 2)))
    at, path = tree_paths(x, pairs, np.zeros((2, 6)))
    if turned:
        assert at.tolist() == [1, 5, 3]
        assert path.tolist() == [1.0, 2.0, 5.0]
    else:
        assert at.tolist() == [2, 4, 2]
        assert path.tolist() == [7.0, 6.0, 1.0]


def test_a_turn_that_keeps_falling_is_passed_below_its_lowest_level() -> None:
    x = np.array([0.0, 5.0, 1.0, 4.0])
    pairs = Pairs(np.array([1, 2]), np.array([3, 3]), np.zeros(2, dtype=bool), np.ones(2), np.zeros((2, 2)))
    levels = np.array([[0.0, 0.0, -0.5, 0.0], [0.0] * 4])
    at, path = tree_paths(x, pairs, levels)
    assert at.tolist() == [2, 2]
    assert path.tolist() == [8.0, -np.inf], "its own paths are bound at later heights"


def test_only_pairs_that_see_each_other_are_looked_at() -> None:
    loop = np.array([(0, 0), (6, 0), (6, 1), (1, 1), (1, 2), (6, 2), (6, 3), (0, 3)], dtype=float)
    outline = Outline(loop)
    program = Program(outline, plain_turns(loop))
    along = program.evenly()
    pairs = visible_pairs(outline, program.turns, along)
    place = program.turns.places(outline, along)
    assert (pairs.i < pairs.j).all()
    assert np.allclose(pairs.distance, np.hypot(*(place[pairs.i] - place[pairs.j]).T))
    inside, outside = sees_each_other(outline, place, program.turns, pairs.i, pairs.j)
    assert (inside | outside).all()
    assert not pairs.turned.any()
    assert later_pairs(outline, program.turns, along) == [], "no corner falls"


def test_wishes_are_met_where_nothing_keeps_a_turn_from_it() -> None:
    outline, program, solution = covered(loop_of(rectangle(3, 1)))
    wishes = under_nodes(outline, solution.turns)
    assert np.isnan(wishes.along[solution.turns.corner]).all()
    moved = program.solve(solution.along, clearance=0.02, wishes=wishes, whole=True)
    assert moved is not None
    wished = ~np.isnan(wishes.along)

    def off(some: Solution) -> float:
        return float(np.abs(some.along - wishes.along)[wished].sum())

    assert wished.any()
    assert off(moved) <= off(solution) + 1e-6


def test_a_reflex_corner_falls_until_its_wavefront_meets_another() -> None:
    lives, falls = corner_lives(np.array([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)], dtype=float))
    assert lives[3] == pytest.approx(0.5)
    assert falls.tolist() == pytest.approx([0, 0, 0, 0.5, 0, 0])


def test_the_skeletons_nodes_stand_over_the_sides_that_vanish() -> None:
    nodes = side_nodes(np.array([(0, 0), (3, 0), (3, 1), (0, 1)], dtype=float))
    assert {(node.side, round(node.along, 9), round(node.height, 9)) for node in nodes} >= {
        (1, 0.5, 0.5),
        (3, 0.5, 0.5),
    }
    triangle = side_nodes(np.array([(0, 0), (4, 0), (0, 3)], dtype=float))
    assert sorted((node.side, round(node.along, 9)) for node in triangle) == [(0, 1.0), (1, 3.0), (2, 2.0)]
