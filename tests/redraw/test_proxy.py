"""What an outline costs to fold: as the patterns say that are made of it."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
from support.outlines import (
    A4,
    KINDS,
    corners_of,
    engine_for,
    half_of,
    mirrored_outline,
    on_a4,
    random_outline,
    sample_outline,
)
from support.samples import TESTED
from support.slow_proxy import Slow, slow_proxy
from support.strategies import rectangle, regular

from foldcut.core.errors import UnfoldableError
from foldcut.core.model import Shape, Sheet
from foldcut.methods.skeleton.quick import fold_outline
from foldcut.pattern.foldability import crease_numbers
from foldcut.redraw.proxy import ENDLESS_COST, LEAST_CREASE_MM, LOOSE_COST, SHORT_COST, Assessment, Field

pytestmark = pytest.mark.usefixtures("kernels_are_loaded")

JOINED = 1
"""Two perpendiculars that are one straight line where they meet: what that saves is seen only once they are chosen.
So many lines more than necessary the set may have that the proxy chooses, in any of these drawings."""

EXACT_MM = 1e-6

AXES = ((0,), (1,), (0, 1))


def assessed(
    shape: Shape, sheet: Sheet = A4, axes: tuple[int, ...] = (), *, compiled: bool | None = None
) -> Assessment:
    found = engine_for(shape, sheet, axes=axes, compiled=compiled).assess(*corners_of(shape), reach=5.0)
    assert found is not None
    return found


def faults(fast: Assessment, slow: Slow, more: int = 0) -> list[str]:
    """What an assessment says that the slow way does not: up to ``more`` lines more than necessary are no fault."""
    wrong = []
    if fast.odd != slow.odd:
        wrong.append(f"{fast.odd} odd nodes instead of {slow.odd}")
    if fast.endless < slow.endless:
        wrong.append(f"of {slow.endless} nodes no perpendicular ends, but it says {fast.endless}")
    if not slow.all_end:
        return wrong
    if fast.endless:
        wrong.append(f"{fast.endless} endless perpendiculars, but all end")
    least = min(slow.counted).lines
    if not least <= fast.lines <= least + more:
        wrong.append(f"{fast.lines} lines, but {least} are enough")
    if not any(fast.lines == one.lines and abs(fast.shortest - one.shortest) < EXACT_MM for one in slow.counted):
        wrong.append(f"no set away from a corridor has {fast.lines} lines and a shortest crease of {fast.shortest} mm")
    return wrong


def halves(axes: tuple[int, ...], count: int) -> Iterator[tuple[str, Shape, Sheet]]:
    for seed in range(count):
        half = half_of(mirrored_outline(seed, axes), axes)
        yield f"seed {seed}", half.outline, half.sheet


@pytest.mark.parametrize("kind", KINDS)
def test_lines_and_shortest_crease_of_random_outlines_are_those_of_their_patterns(kind: str) -> None:
    wrong, all_end = {}, 0
    for seed in range(25):
        shape = random_outline(kind, seed)
        slow = slow_proxy(shape, A4)
        all_end += slow.all_end
        wrong[seed] = faults(assessed(shape), slow)
    assert not {seed: what for seed, what in wrong.items() if what}
    assert all_end >= 10, "too few of these outlines can be compared"


NEARLY_JOINED = {"rosette", "snowflake"}
"""Their nodes come together but for the rounding of their corners: the proxy joins them, its slow twin does not."""


@pytest.mark.parametrize("name", sorted({*TESTED} - NEARLY_JOINED))
def test_samples_cost_what_their_patterns_cost(name: str) -> None:
    shape, sheet = sample_outline(name)
    assert not faults(assessed(shape, sheet), slow_proxy(shape, sheet), JOINED)


@pytest.mark.parametrize("axes", AXES)
def test_halves_cost_what_their_patterns_cost_and_pieces_of_the_axes_count(axes: tuple[int, ...]) -> None:
    by_axis = 0
    for name, shape, sheet in halves(axes, 25):
        fast, slow = assessed(shape, sheet, axes), slow_proxy(shape, sheet, axes)
        assert not faults(fast, slow, JOINED), name
        without = assessed(shape, sheet)
        assert without.shortest >= fast.shortest
        assert without.lines == fast.lines, "an axis is no line of the part"
        by_axis += without.shortest > fast.shortest
    assert by_axis >= 5, "too few of these parts have their shortest crease on an axis"


@pytest.mark.parametrize(
    ("name", "axes"),
    [("heart", (0,)), ("letter-t", (0,)), ("arrow", (1,)), ("plus", (0, 1)), ("hexagon", (0, 1)), ("ring", (0, 1))],
)
def test_halves_of_samples_cost_what_their_patterns_cost(name: str, axes: tuple[int, ...]) -> None:
    shape, sheet = sample_outline(name)
    half = half_of(shape, axes, sheet)
    assert not faults(assessed(half.outline, half.sheet, axes), slow_proxy(half.outline, half.sheet, axes), JOINED)


@pytest.mark.parametrize("kind", ["star", "tour"])
def test_patterns_are_as_promised_wherever_the_promised_set_is_folded(kind: str) -> None:
    """The whole way, to verified patterns: others have other sets, most of them easier to fold."""
    same = easier = tried = 0
    for seed in range(14):
        shape = random_outline(kind, seed)
        fast = assessed(shape)
        try:
            made = fold_outline(shape, A4)
        except UnfoldableError:
            continue
        numbers = crease_numbers(made.creases)
        tried += 1
        shortest = numbers.shortest_crease_mm or 0
        same += numbers.lines == fast.lines and abs(shortest - fast.shortest) < EXACT_MM
        easier += numbers.lines < fast.lines or (numbers.lines == fast.lines and shortest > fast.shortest + EXACT_MM)
    assert tried >= 9
    assert same >= 3
    assert same + easier >= tried - 2


@pytest.mark.parametrize("kind", KINDS)
def test_compiled_and_plain_kernels_say_the_same(kind: str) -> None:
    for seed in range(4):
        shape = random_outline(kind, seed)
        plain, compiled = (assessed(shape, compiled=one) for one in (False, True))
        for name in ("cost", "lines", "shortest", "short", "endless", "odd", "taken"):
            assert getattr(plain, name) == getattr(compiled, name), (seed, name)
        for name in ("sides", "ridges", "paths", "misses", "degree", "on_sheet"):
            assert getattr(plain.details, name) == getattr(compiled.details, name), (seed, name)


def test_costs_are_lines_short_creases_and_endless_ones_taken_or_not() -> None:
    loose = 0
    for seed in range(12):
        shape = random_outline("star", seed)
        one, slow = assessed(shape), slow_proxy(shape, A4)
        loose += slow.loose
        least = one.lines + ENDLESS_COST * one.endless + LOOSE_COST * slow.loose + SHORT_COST[0] * one.short
        assert least <= one.cost <= least + SHORT_COST[1] * one.short
        assert (one.short > 0) == (one.shortest < LEAST_CREASE_MM)
        if one.short == 1:
            assert one.cost == pytest.approx(least + SHORT_COST[1] * (1 - one.shortest / LEAST_CREASE_MM))
    assert loose


def test_a_square_in_the_middle_of_a_square_folds_along_diagonals_and_away_from_a_corridor() -> None:
    shape = Shape((np.array([(50.0, 50.0), (150.0, 50.0), (150.0, 150.0), (50.0, 150.0)]),), (-1,))
    found = assessed(shape, Sheet(200.0, 200.0))
    # Both diagonals go on to the corners of the sheet. They are enough, but the proxy knows only sets away from a
    # corridor, and two of the perpendiculars from the middle do not border on it.
    assert (found.lines, found.odd, found.endless, found.taken) == (2 + 2, 0, 0, 2)
    assert found.shortest == pytest.approx(50 * math.sqrt(2))


@pytest.mark.parametrize("count", range(3, 10))
def test_regular_polygons_need_no_perpendiculars(count: int) -> None:
    shape = on_a4([np.array(regular(count))])
    found = assessed(shape)
    assert (found.endless, found.odd) == (0, count % 2)
    assert len(found.details.sides[min(found.details.sides)]) >= 3
    assert count in {len(tie) for tie in found.details.sides.values()}, "all its sides meet in the middle"


def test_moved_corners_change_what_it_costs() -> None:
    """One engine for many outlines: nothing is left of the one before."""
    shape = random_outline("star", 3)
    engine = engine_for(shape)
    points, sizes = corners_of(shape)
    before = engine.assess(points, sizes)
    rng = np.random.default_rng(0)
    for _ in range(20):
        moved = points + rng.normal(0, 0.7, points.shape)
        again, fresh = engine.assess(moved, sizes), engine_for(shape).assess(moved, sizes)
        assert (again is None) == (fresh is None)
        if again is not None and fresh is not None:
            assert (again.cost, again.shortest, again.lines) == (fresh.cost, fresh.shortest, fresh.lines)
    after = engine.assess(points, sizes)
    assert before is not None
    assert after is not None
    assert (before.cost, before.shortest) == (after.cost, after.shortest)


def test_where_the_outline_begins_makes_no_difference() -> None:
    for seed in range(8):
        shape = random_outline("tour", seed)
        points, sizes = corners_of(shape)
        engine = engine_for(shape)
        costs = [engine.assess(np.roll(points, k, axis=0), sizes) for k in range(0, len(points), 3)]
        first = costs[0]
        assert first is not None
        for one in costs[1:]:
            assert one is not None
            assert (one.lines, one.odd, one.endless) == (first.lines, first.odd, first.endless), seed
            assert one.shortest == pytest.approx(first.shortest, abs=EXACT_MM)


def test_misses_are_how_far_perpendiculars_pass_nodes() -> None:
    shape = random_outline("star", 2)
    found = assessed(shape)
    details = found.details
    assert details.misses
    for miss, path, step, node in details.misses:
        assert 0 < miss < 5.0
        assert details.on_sheet[node]
        assert details.paths[path][2][step] in details.sides[node], "it passes the node in a face of that node"


def test_samples_of_the_drawing_are_on_it_and_on_the_sheet() -> None:
    loop = np.array(rectangle(250, 100), dtype=float) + np.array([-20, 50])
    field = Field((loop,), 210.0, 297.0, 1.0)
    points = field.samples
    assert ((points >= 0) & (points <= (210, 297))).all()
    x, y = points.T
    assert (np.isclose(y, loop[:, 1].min()) | np.isclose(y, loop[:, 1].max()) | np.isclose(x, loop[:, 0].max())
            | np.isclose(x, loop[:, 0].min())).all()  # fmt: skip
    assert len(points) > 200


def test_the_comparison_can_fail() -> None:
    shape = random_outline("star", 1)
    fast, slow = assessed(shape), slow_proxy(shape, A4)
    assert slow.all_end
    assert not faults(fast, slow)
    for changed in (
        {"odd": 5},
        {"lines": fast.lines - 1},
        {"lines": fast.lines + 3},
        {"shortest": 1.0},
        {"endless": 1},
    ):
        other = Assessment(**{**vars(fast), **changed})
        assert faults(other, slow), changed
