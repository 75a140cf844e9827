"""The k-cornered molecule, inside and outside a walk, and what the layers make of it."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from support.strategies import cross, rectangle, regular, star

import foldcut
from foldcut.core.arrays import Floats, points_array
from foldcut.core.model import Finding, Shape, Sheet
from foldcut.drawing.placement import place
from foldcut.drawing.shape import make_shape
from foldcut.methods.compact import molecule as universal
from foldcut.methods.compact import part_state
from foldcut.methods.compact.event_queue import Queue
from foldcut.methods.compact.many_disks import crowded_solution
from foldcut.methods.compact.motion import Table, looks_inside
from foldcut.methods.compact.pattern import Molecules, Walk, build_molecules, fold_molecules, molecule_faults
from foldcut.methods.compact.search import fold_compact
from foldcut.methods.compact.turns import Outline
from foldcut.methods.disks.molecules import Kind
from foldcut.proof.verify import verify
from foldcut.readers import read_shape
from foldcut.samples import sample_path

SHEET = Sheet(200.0, 200.0)


def placed(points: list[tuple[float, float]]) -> Shape:
    return place(make_shape([points]), SHEET, margin=30)[0]


def walk_of(loop: Floats, reach: Floats, valleys: tuple[int, ...] = (), root: int | None = None) -> Walk:
    """The walk with these reaches of the corners; ``root`` is a valley, or else the turn on the last side is the root.

    On every side between two peaks is a turn as low as the side's length wants.
    """
    along = np.roll(loop, -1, axis=0) - loop
    length = np.hypot(*along.T)
    points, x, peaks, directions = [], [], [], []
    for k in range(len(loop)):
        points.append(loop[k])
        x.append(reach[k])
        peaks.append(k not in valleys)
        directions.append(along[k] / length[k])
        if {k, (k + 1) % len(loop)}.isdisjoint(valleys):
            x.append((reach[k] + reach[(k + 1) % len(loop)] - length[k]) / 2)
            points.append(loop[k] + directions[-1] * (reach[k] - x[-1]))
            peaks.append(False)
            directions.append(directions[-1])
    first = -1 if root is None else next(k for k, p in enumerate(points) if p is loop[root] or np.all(p == loop[root]))
    order = (first + np.arange(len(points))) % len(points)
    images = np.where(np.abs(x) < 1e-9, 0.0, x)[order]
    pockets = np.full(len(points), int(bool(valleys)))
    return Walk(
        np.array(points)[order],
        images,
        np.array(peaks)[order],
        np.array(directions)[order],
        pockets,
        np.stack([images, images]),
        turned=int(bool(valleys)),
    )


def walk(shape: Shape, reach: list[float], valleys: tuple[int, ...] = (), root: int | None = None) -> Walk:
    """As ``walk_of``, with reaches in units of the longest side."""
    loop = shape.loops[0]
    longest = np.hypot(*(np.roll(loop, -1, axis=0) - loop).T).max()
    return walk_of(loop, np.array(reach) * longest, valleys, root)


def fold(shape: Shape, its_walk: Walk) -> tuple[Molecules, int, list[Finding]]:
    """Fold a walk; return the molecules, the number of creases, and what verification finds."""
    molecules = build_molecules(its_walk, SHEET)
    assert molecule_faults(molecules) == []
    creases, folded = fold_molecules(molecules, SHEET)
    return molecules, creases.crease_count, verify(creases, folded.layers, shape)


def test_a_triangle_is_a_rabbit_ear_and_needs_six_creases_with_its_outside() -> None:
    shape = placed([(0, 0), (4, 0), (0, 3)])
    molecules, count, findings = fold(shape, walk(shape, [0.2, 0.6, 0.4]))
    assert (count, findings) == (6, [])
    flat, folded = np.array(molecules.vertices.flat), np.array(molecules.vertices.folded)
    apex = flat[np.argmax(folded[:, 1])]
    corner, unit = shape.loops[0][0], np.ptp(shape.loops[0][:, 0]) / 4
    assert np.allclose(apex, corner + unit, atol=1e-9), "the incentre of a 3-4-5 triangle"


@pytest.mark.parametrize("n", range(3, 13))
def test_regular_polygons_close_in_one_point_and_need_two_creases_a_corner(n: int) -> None:
    shape = placed(regular(n))
    molecules, count, findings = fold(shape, walk(shape, [0.5] * n))
    assert (count, findings) == (2 * n, [])
    assert molecules.inside.gussets == molecules.outside.gussets == 0


def test_a_quadrilateral_has_the_gusset_of_the_papers_formulas() -> None:
    # Four tangent disks about a quadrilateral; the same molecule by the closed formulas of the paper's method.
    from test_molecules import one_molecule

    radii = [1.0, 1.5, 1.0, 1.5]
    half = math.sqrt(2.5**2 - 1.1**2)
    corners = [(0.0, -1.1), (half, 0.0), (0.0, 1.1), (-half, 0.0)]
    formula = one_molecule(corners, radii)
    molecules = build_molecules(walk_of(np.array(corners), np.array(radii)), Sheet(10, 10))
    assert molecules.inside.gussets == 1
    theirs = {tuple(np.round(point, 9)) for point in formula.vertices.tolist()}
    inside = {v for ring in molecules.inside.rings() for v in ring}
    ours = {tuple(np.round(molecules.vertices.flat[v], 9)) for v in inside}
    assert ours == theirs
    edges = {
        frozenset(pair) for ring in molecules.inside.rings() for pair in zip(ring, ring[1:] + ring[:1], strict=True)
    }
    by_place = {tuple(np.round(molecules.vertices.flat[v], 9)): v for v in inside}
    creases = {
        frozenset(by_place[tuple(np.round(formula.vertices[v], 9).tolist())] for v in pair)
        for pair, kind in zip(formula.creases.tolist(), formula.crease_kind.tolist(), strict=True)
        if kind != Kind.RIBBON
    }
    assert edges == creases


def test_a_long_rectangle_folds_over_two_hubs_without_added_corners() -> None:
    # One hub would need ten corners: here a river joins the hubs of the two ends.
    shape = placed(rectangle(3, 1))
    r = 0.5 / 3
    _, count, findings = fold(shape, walk(shape, [r, 1 - r, 1 - r, r]))
    assert findings == []
    assert count <= 10


def test_a_five_pointed_star_folds_like_a_fan_with_ten_creases() -> None:
    shape = placed(star(5, 0.4))
    _, count, findings = fold(shape, walk(shape, [1, 0] * 5, valleys=(1, 3, 5, 7, 9), root=1))
    assert (count, findings) == (10, [])


def test_a_plus_sign_on_one_hub_has_gussets_inside_and_outside() -> None:
    shape = placed(cross())
    loop = shape.loops[0]
    before, after = loop - np.roll(loop, 1, axis=0), np.roll(loop, -1, axis=0) - loop
    reflex = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] < 0
    reach = [0.45 if notch else 0.55 for notch in reflex]
    its_walk = walk(shape, reach)
    first = int(np.flatnonzero((its_walk.x == 0) & ~its_walk.peaks)[0])
    turned = (np.roll(getattr(its_walk, name), -first, axis=0) for name in ("points", "x", "peaks", "directions"))
    its_walk = Walk(*turned, its_walk.pockets, np.roll(its_walk.levels, -first, axis=1))
    molecules, _, findings = fold(shape, its_walk)
    assert findings == []
    assert molecules.inside.gussets > 0
    assert molecules.outside.gussets > 0


def test_the_sheet_may_be_any_rectangle_that_holds_the_shape() -> None:
    shape = placed(regular(5))
    molecules = build_molecules(walk(shape, [0.5] * 5), SHEET)
    low, high = shape.loops[0].min(axis=0), shape.loops[0].max(axis=0)
    for room in (0.001, 1.0, 25.0):
        size = high - low + 2 * room
        moved = Shape((points_array(shape.loops[0] - low + room),), (-1,))
        sheet = Sheet(float(size[0]), float(size[1]))
        creases, folded = fold_molecules(build_molecules(walk(moved, [0.5] * 5), sheet), sheet)
        assert verify(creases, folded.layers, moved) == []
    assert molecule_faults(molecules) == []


def test_the_checker_sees_a_reach_that_does_not_fit() -> None:
    shape = placed(regular(5))
    right = walk(shape, [0.5] * 5)
    shift = np.where(np.arange(10) == 5, 1.0, 0.0)
    wrong = dataclasses.replace(right, x=right.x + shift)
    assert molecule_faults(build_molecules(wrong, SHEET)) != []


def crowded_walk(corners: int) -> Walk:
    """Many small disks along a star-shaped polygon: one hub."""
    random = np.random.default_rng(corners)
    angles = (np.arange(corners) + random.uniform(0.1, 0.9, corners)) * 2 * np.pi / corners
    reach = random.uniform(0.5, 1.0, corners) * 60
    outline = Outline(points_array(100 + np.stack([reach * np.cos(angles), reach * np.sin(angles)], axis=1)))
    return crowded_solution(outline, 0.02).walk(outline, careful=False)


def searched_walk(name: str) -> Walk:
    """What the search finds for a sample with no pocket turned: a tree of several hubs."""
    shape, _ = place(make_shape(read_shape(sample_path(name)).loops), SHEET, margin=30)
    return fold_compact(shape.loops[0], SHEET, effort="fast").walk


@pytest.mark.parametrize("made", [lambda: crowded_walk(8), lambda: crowded_walk(20), lambda: searched_walk("fish")])
def test_looking_for_gussets_among_near_pairs_gives_the_same_molecules(
    made: Callable[[], Walk], monkeypatch: pytest.MonkeyPatch
) -> None:
    walk = made()
    monkeypatch.setattr(universal, "FEW", 10**9)
    monkeypatch.setattr(part_state, "FEW", 10**9)
    every = build_molecules(walk, SHEET)
    monkeypatch.setattr(universal, "FEW", 4)
    monkeypatch.setattr(part_state, "FEW", 4)
    near = build_molecules(walk, SHEET)
    assert every.inside.gussets > 0
    assert every.vertices == near.vertices
    for side in ("inside", "outside"):
        one, other = getattr(every, side), getattr(near, side)
        assert (one.order, one.rings()) == (other.order, other.rings())


@pytest.mark.parametrize("count", range(3, 11))
def test_few_turns_looked_at_one_by_one_make_the_same_pairs_and_pinches(
    count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    random = np.random.default_rng(count)
    pinches = 0
    for _ in range(200):
        state: Any = SimpleNamespace(
            position=random.integers(0, 3, (count, 2)).astype(float),
            x=random.integers(0, 2, count).astype(float),
            level=random.integers(0, 3, count).astype(float),
            peak=np.arange(count) % 2 == random.integers(2),
            shrink=random.integers(0, 2, count).astype(float),
            turned=np.zeros(count, dtype=np.int64),
        )
        state._few_pairs = partial(part_state._State._few_pairs, state)
        found = []
        for few in (0, count):
            monkeypatch.setattr(part_state, "VERY_FEW", few)
            pairs = part_state._State._pairs(state, 1e-9, 1.0)
            found.append((*(column.tolist() for column in pairs), part_state._State.coincident(state, 1e-9)))
        assert found[0] == found[1]
        pinches += found[0][-1] is not None
    assert pinches or count == 3


def gear_walk(teeth: int) -> Walk:
    """Many small disks along a shape with exact ties."""
    angles = np.arange(2 * teeth) * np.pi / teeth
    reach = np.where(np.arange(2 * teeth) % 2, 50.0, 60.0)
    outline = Outline(points_array(100 + np.stack([reach * np.cos(angles), reach * np.sin(angles)], axis=1)))
    return crowded_solution(outline, 0.02).walk(outline, careful=False)


def convex_walk(corners: int) -> Walk:
    """What the search finds for a convex polygon: feet on several levels."""
    random = np.random.default_rng(corners)
    angles = (np.arange(corners) + random.uniform(0.1, 0.9, corners)) * 2 * np.pi / corners
    loop = points_array(np.stack([100 + 80 * np.cos(angles), 100 + 30 * np.sin(angles)], axis=1))
    return fold_compact(loop, SHEET, effort="fast").walk


@pytest.mark.parametrize(
    "made",
    [
        lambda: crowded_walk(8),
        lambda: crowded_walk(20),
        lambda: crowded_walk(50),
        lambda: gear_walk(6),
        lambda: gear_walk(9),
        lambda: convex_walk(14),
        lambda: searched_walk("fish"),
    ],
)
def test_queued_events_give_the_same_molecules(made: Callable[[], Walk], monkeypatch: pytest.MonkeyPatch) -> None:
    walk = made()
    monkeypatch.setattr(universal, "SMALL_TIE", universal.TIE)

    def built() -> Any:
        try:
            molecules = build_molecules(walk, SHEET)
        except universal.NotClosedError as error:
            return str(error), error.stretches
        sides = molecules.inside, molecules.outside
        return molecules.vertices, [(side.order, side.rings(), side.lowest_event, side.gussets) for side in sides]

    simple = built()
    monkeypatch.setattr(universal, "FEW", 4)
    monkeypatch.setattr(part_state, "FEW", 4)
    monkeypatch.setattr(universal, "MANY", 4)
    monkeypatch.setattr(universal, "PATIENCE", 1)
    assert built() == simple


def test_the_queue_sees_what_the_simple_code_sees() -> None:
    walk = crowded_walk(30)
    table, count = Table(), len(walk.x)
    turns = [
        part_state._Turn(
            *(walk.points[k], 0.0, float(walk.x[k]), bool(walk.peaks[k]), walk.directions[k - 1], walk.directions[k]),
            *((k - 1) % count, k, k, 0, 0.0),
        )
        for k in range(count)
    ]
    queue = Queue(table, turns, 0.0, np.inf, 1e-7)
    state = part_state._State(part_state._Part(turns, 0.0, False), 0, table)
    queue.place[queue.numbers] = np.arange(count)
    pairs = [(i, j) for i in range(1, count, 2) for j in range(i + 4, count, 2)]
    seen = [queue._sees((turns[i].number, turns[j].number), 0.0, 0.0) for i, j in pairs]
    assert seen == [state.sees(0.0, i, j) for i, j in pairs]
    looking = [looks_inside(turns[i], walk.points[j] - walk.points[i]) for i, j in pairs]
    assert 0 < sum(seen) < sum(looking)


def test_most_gussets_of_crowded_disks_come_from_the_queue(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(universal, "FEW", 10)
    monkeypatch.setattr(part_state, "FEW", 10)
    monkeypatch.setattr(universal, "MANY", 10)
    queued = 0
    split = Queue.split

    def counting(self: Queue, *rest: Any) -> int:
        nonlocal queued
        queued += 1
        return split(self, *rest)

    monkeypatch.setattr(Queue, "split", counting)
    molecules = build_molecules(crowded_walk(40), SHEET)
    assert queued > 0.6 * (molecules.inside.gussets + molecules.outside.gussets)


def test_two_hundred_corners_are_folded_with_crowded_disks() -> None:
    angles = np.arange(200) * 2 * np.pi / 200
    reach = 100 + 15 * np.sin(7 * angles) + 3 * np.sin(31 * angles)
    loop = np.stack([reach * np.cos(angles), reach * np.sin(angles)], axis=1)
    result = foldcut.fold([loop], method="compact", effort="fast", min_crease=0)
    assert result.findings == ()
