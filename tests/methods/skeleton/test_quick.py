"""Folding exactly one outline: with the fewest folds first, nothing moved, soon."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest
import shapely
from support.several_loops import random_loops
from support.strategies import Points, rectangle

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.drawing.placement import Layout, parse_sheet
from foldcut.drawing.shape import make_shape
from foldcut.methods.sheet_part import SheetPart
from foldcut.methods.skeleton.budget import Budget
from foldcut.methods.skeleton.choices import fewest_folds, promising_sets
from foldcut.methods.skeleton.layer_order import _connected, _Graph
from foldcut.methods.skeleton.perpendiculars import Ridges, trace
from foldcut.methods.skeleton.quick import fold_outline
from foldcut.methods.skeleton.skeleton_faces import skeleton_of
from foldcut.methods.skeleton.trial import NOT_BETTER, Drawing, attempt, promise
from foldcut.pattern.foldability import crease_numbers
from foldcut.pattern.ranking import Goal, rank
from foldcut.proof.verify import verify


def framed(loops: list[Points]) -> tuple[Shape, Sheet]:
    sheet, shape, *_ = Layout(parse_sheet("a4"), rotation=0.0).place(make_shape(loops))
    return shape, sheet


def strip(line: list[tuple[float, float]], width: float) -> list[Points]:
    """A bent strip whose two sides have the same bends."""
    outline = shapely.LineString(line).buffer(width, cap_style="flat", join_style="mitre", mitre_limit=10)
    return [np.array(outline.exterior.coords)[:-1].tolist()]


def letter_u(bends: int) -> list[Points]:
    """The letter U, with legs that are not equally long."""
    angles = [math.pi * k / bends for k in np.arange(0.5, bends, 1)]
    r = 30 / math.cos(math.pi / 2 / bends)
    return strip([(-30, 67), *((-r * math.cos(a), -r * math.sin(a)) for a in angles), (30, 60)], 10)


def letter_s(bends: int) -> list[Points]:
    r = 20 / math.cos(math.pi * 0.75 / bends)
    turns = np.linspace(0, 270, 2 * bends + 1)[1::2]
    upper = [(20 + r * math.cos(math.radians(a)), 60 + r * math.sin(math.radians(a))) for a in turns]
    lower = [(20 + r * math.cos(math.radians(90 - a)), 20 + r * math.sin(math.radians(90 - a))) for a in turns]
    return strip([(40, 52), *upper, *lower, (0, 28)], 6)


@pytest.mark.parametrize(
    ("loops", "folds"), [(letter_u(2), 10), (letter_u(4), 14), (letter_u(6), 18), (letter_s(3), 19)]
)
def test_strips_with_matched_bends_take_few_folds_at_the_first_try(loops: list[Points], folds: int) -> None:
    shape, sheet = framed(loops)
    made = fold_outline(shape, sheet, tries=1)
    assert made.shape is shape
    assert made.moved_mm == 0.0
    assert verify(made.creases, made.folded.layers, shape) == []
    assert crease_numbers(made.creases).lines <= folds


def test_twenty_corners_fold_in_a_fraction_of_a_second() -> None:
    shape, sheet = framed(letter_u(8))
    assert shape.corner_count == 20
    fold_outline(shape, sheet)  # loads what has to be loaded
    start = time.process_time()
    fold_outline(shape, sheet)
    assert time.process_time() - start < 1.0


def test_what_cannot_be_folded_has_a_reason() -> None:
    shape, sheet = framed([rectangle(12, 9)])
    with pytest.raises(UnfoldableError, match="within the ribbon"):
        fold_outline(shape, sheet, ribbon=120.0)
    with pytest.raises(UnfoldableError, match="no set of perpendiculars"):
        fold_outline(shape, sheet, tries=0)


@pytest.mark.parametrize("loops", [letter_u(3), letter_s(4), random_loops(1, holes=True)])
def test_folds_are_counted_before_anything_is_divided(loops: list[Points]) -> None:
    shape, sheet = framed(loops)
    counted = 0
    for perpendiculars, taken in list(promising_sets(Ridges(skeleton_of(shape, sheet), sheet)))[:6]:
        drawing = Drawing(SheetPart(shape), 0.0, perpendiculars)
        trial = attempt(drawing, frozenset(taken), Budget(1.0))
        if trial.made is not None:
            lines = crease_numbers(trial.made.creases).lines
            assert lines == perpendiculars.ridge_lines + perpendiculars.line_count(taken)
            assert promise(drawing, frozenset(taken)) <= trial.quality
            counted += 1
            again = attempt(drawing, frozenset(taken), Budget(1.0), trial.quality)
            assert (again.made, again.problem) == (None, NOT_BETTER)
    assert counted


def test_sets_come_in_the_order_of_their_folds() -> None:
    shape, sheet = framed(letter_s(3))
    ridges = Ridges(skeleton_of(shape, sheet), sheet)
    found = trace(ridges, ridges.odd)
    counts = [found.line_count(taken) for taken in fewest_folds(found, 6)]
    assert counts == sorted(counts)
    assert len(counts) == 6


@pytest.mark.parametrize("seed", range(3))
def test_unions_and_shortest_ways_are_those_of_scipy(seed: int) -> None:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components, shortest_path

    random = np.random.default_rng(seed)
    count = 60
    one, other = random.integers(0, count, (2, 50))
    graph = coo_array((np.ones(50), (one, other)), shape=(count, count)).tocsr()
    group = connected_components(graph, directed=False)[1]
    mine = _connected(count, one, other)
    assert all((group == group[k]).tolist() == (mine == mine[k]).tolist() for k in range(count))
    steps = shortest_path(graph, directed=False, indices=[0], unweighted=True)[0]
    ways = _Graph(count, one, other)
    for node in np.flatnonzero(np.isfinite(steps))[1:].tolist():
        way = ways.shortest_way(0, node, count)
        assert way is not None
        assert len(way) == steps[node] + 1
        assert ways.shortest_way(0, node, len(way) - 1) is None


def test_a_goal_is_reached_with_enough_folds_that_are_long_enough() -> None:
    goal = Goal(rank(20, 5.0), 4, 1.5)
    assert goal.is_reached(4, 3.0)
    assert not goal.is_reached(5, 3.0)
    assert not goal.is_reached(4, 2.9)
    assert goal.is_near(19, 3.0)
    assert goal.is_near(29, 3.0)
    assert not goal.is_near(31, 3.0)
    assert not goal.is_near(20, 0.4)
    assert Goal().is_near(1000, 0.1)
