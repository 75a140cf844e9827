"""The k-cornered molecule, inside and outside a walk, and what the layers make of it."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from support.molecules import one_molecule
from support.strategies import cross, rectangle, regular, star

import foldcut
from foldcut.core.arrays import Floats, points_array
from foldcut.core.model import Finding, Shape, Sheet
from foldcut.drawing.placement import place
from foldcut.drawing.shape import make_shape
from foldcut.methods.compact.event_queue import EventQueue
from foldcut.methods.compact.facets import LayerList
from foldcut.methods.compact.growing_boxes import GrowingBoxes
from foldcut.methods.compact.gusset_pairs import all_pairs, few_pairs, last_lowest, near_pairs
from foldcut.methods.compact.many_disks import many_disks
from foldcut.methods.compact.molecule import NotClosedError, runs_of_turns
from foldcut.methods.compact.motion import Motion, Turn, TurnTable, looks_inside
from foldcut.methods.compact.outline import Outline
from foldcut.methods.compact.part_state import (
    Collapse,
    Part,
    PartState,
    Thresholds,
    coincident_of_few,
    coincident_of_many,
)
from foldcut.methods.compact.pattern import Molecules, Walk, build_molecules, fold_molecules, molecule_faults
from foldcut.methods.compact.search import fold_compact
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
    radii = [1.0, 1.5, 1.0, 1.5]
    half = math.sqrt(2.5**2 - 1.1**2)
    corners = [(0.0, -1.1), (half, 0.0), (0.0, 1.1), (-half, 0.0)]
    formula = one_molecule(corners, radii)
    molecules = build_molecules(walk_of(np.array(corners), np.array(radii)), Sheet(10, 10))
    assert molecules.inside.gussets == 1
    theirs = {tuple(np.round(point, 9)) for point in formula.vertices.tolist()}
    inside = {v for ring in molecules.inside.polygons() for v in ring}
    ours = {tuple(np.round(molecules.vertices.flat[v], 9)) for v in inside}
    assert ours == theirs
    edges = {
        frozenset(pair) for ring in molecules.inside.polygons() for pair in zip(ring, ring[1:] + ring[:1], strict=True)
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
    first = int(np.flatnonzero((its_walk.x == 0) & ~its_walk.crests)[0])
    turned = (np.roll(getattr(its_walk, name), -first, axis=0) for name in ("points", "x", "crests", "directions"))
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
    return many_disks(outline, 0.02).walk(outline)


def searched_walk(name: str) -> Walk:
    """What the search finds for a sample with no pocket turned: a tree of several hubs."""
    shape, _ = place(make_shape(read_shape(sample_path(name)).loops), SHEET, margin=30)
    return fold_compact(shape.loops[0], SHEET, effort="fast").walk


@pytest.mark.parametrize("made", [lambda: crowded_walk(8), lambda: crowded_walk(20), lambda: searched_walk("fish")])
def test_looking_for_gussets_among_near_pairs_gives_the_same_molecules(made: Callable[[], Walk]) -> None:
    walk = made()
    every = build_molecules(walk, SHEET, thresholds=Thresholds(near_only=10**9))
    near = build_molecules(walk, SHEET, thresholds=Thresholds(near_only=4))
    assert every.inside.gussets > 0
    assert every.vertices == near.vertices
    for side in ("inside", "outside"):
        one, other = getattr(every, side), getattr(near, side)
        assert (one.order, one.polygons()) == (other.order, other.polygons())


@pytest.mark.parametrize("count", range(3, 11))
def test_few_turns_looked_at_one_by_one_make_the_same_pairs_and_pinches(count: int) -> None:
    random = np.random.default_rng(count)
    pinches = 0
    for _ in range(200):
        position = random.integers(0, 3, (count, 2)).astype(float)
        x = random.integers(0, 2, count).astype(float)
        level = random.integers(0, 3, count).astype(float)
        crest = np.arange(count) % 2 == random.integers(2)
        ends = crest | (random.integers(0, 2, count) > 0)
        ends[0] |= bool((x[1:] > x[0]).all())
        nowhere = np.zeros(count, dtype=np.int64)
        few, every = few_pairs(level, ends), all_pairs(level, ends, nowhere, ends)
        assert [column.tolist() for column in few] == [column.tolist() for column in every]
        near = near_pairs(level, ends, np.stack(np.triu_indices(count, 1)))
        assert [column.tolist() for column in near] == [column.tolist() for column in every]
        pinch = coincident_of_few(position, x, crest, 1e-9)
        assert pinch == coincident_of_many(position, x, crest, 1e-9)
        pinches += pinch is not None
    assert pinches or count == 3


def test_the_last_of_equal_lowest_levels_is_found() -> None:
    random = np.random.default_rng(1)
    level = random.integers(0, 4, 40).astype(float)
    i = random.integers(0, 39, 200)
    j = i + 1 + random.integers(0, 39 - i)
    found = last_lowest(level, i, j)
    expected = [b - int(level[a : b + 1][::-1].argmin()) for a, b in zip(i.tolist(), j.tolist(), strict=True)]
    assert found.tolist() == expected


def test_a_turn_moves_along_its_bisector_and_lands_where_its_sides_shrink_to() -> None:
    right, up = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    corner = Turn(np.array([4.0, 0.0]), 0.0, 3.0, True, right, up, 0, 1, 0, pockets=0, level=3.0)
    table = TurnTable()
    motion = Motion(table.rows(table.numbers([corner])), 0.5)
    assert np.allclose(motion.positions(0.5), [[3.0, 1.0]])
    assert np.allclose(motion.images(0.5), [2.0])
    assert table.row(corner.number).image_at(1.0) == pytest.approx(2.0)


def test_a_square_collapses_when_its_inset_has_no_length_left() -> None:
    points = np.array([[1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0], [0.0, 1.0], [0.0, 0.0]])
    along = np.array(
        [[1.0, 0.0], [0.0, 1.0], [0.0, 1.0], [-1.0, 0.0], [-1.0, 0.0], [0.0, -1.0], [0.0, -1.0], [1.0, 0.0]]
    )
    turns = [
        Turn(points[k], 0.0, float(k % 2), k % 2 == 1, along[k - 1], along[k], (k - 1) % 8, k, k, pockets=0, level=0.0)
        for k in range(8)
    ]
    state = PartState(Part(turns, 0.0, False), 0, TurnTable())
    event = state.next_event(np.inf, 1e-9)
    assert isinstance(event, Collapse)
    assert event.time == pytest.approx(1.0)
    assert state.sees(0.0, 1, 5)
    assert not state.sees(0.0, 1, 2), "turns of one side look along it"


def test_turns_meet_in_runs_that_may_go_around_the_end() -> None:
    gone = np.array([True, False, False, True, True])
    assert runs_of_turns(gone) == [[2], [3, 4, 0, 1]]


def test_layers_are_put_in_front_of_and_behind_others() -> None:
    layers = LayerList(3)
    layers.insert_before(0, [3, 4])
    layers.insert_after(2, [5])
    layers.insert_after(0, [6])
    assert layers.facets() == [3, 4, 0, 6, 1, 2, 5]


def test_boxes_are_found_whether_they_came_early_or_late() -> None:
    random = np.random.default_rng(2)
    low = random.uniform(0, 10, (600, 2))
    boxes = np.concatenate([low, low + random.uniform(0, 2, (600, 2))], axis=1)
    grown = GrowingBoxes(boxes[:50], np.arange(50))
    for number in range(50, 600):
        grown.add(boxes[number], number)
    for box in boxes[::40]:
        apart = (boxes[:, :2] > box[2:]).any(axis=1) | (boxes[:, 2:] < box[:2]).any(axis=1)
        assert sorted(grown.meeting(box).tolist()) == np.flatnonzero(~apart).tolist()


def gear_walk(teeth: int) -> Walk:
    """Many small disks along a shape with exact ties."""
    angles = np.arange(2 * teeth) * np.pi / teeth
    reach = np.where(np.arange(2 * teeth) % 2, 50.0, 60.0)
    outline = Outline(points_array(100 + np.stack([reach * np.cos(angles), reach * np.sin(angles)], axis=1)))
    return many_disks(outline, 0.02).walk(outline)


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
def test_queued_events_give_the_same_molecules(made: Callable[[], Walk]) -> None:
    walk = made()

    def built(thresholds: Thresholds) -> Any:
        try:
            molecules = build_molecules(walk, SHEET, thresholds=thresholds)
        except NotClosedError as error:
            return str(error), error.stretches
        sides = molecules.inside, molecules.outside
        return molecules.vertices, [(side.order, side.polygons(), side.lowest_event, side.gussets) for side in sides]

    assert built(Thresholds(near_only=4, queued=4, patience=1)) == built(Thresholds(queued=10**9))


def test_the_queue_sees_what_the_simple_code_sees() -> None:
    walk = crowded_walk(30)
    table, count = TurnTable(), len(walk.x)
    turns = [
        Turn(
            *(walk.points[k], 0.0, float(walk.x[k]), bool(walk.crests[k]), walk.directions[k - 1], walk.directions[k]),
            *((k - 1) % count, k, k, 0, 0.0),
        )
        for k in range(count)
    ]
    queue = EventQueue(table, turns, 0.0, np.inf, 1e-7)
    state = PartState(Part(turns, 0.0, False), 0, table)
    queue.border.update_places()
    pairs = [(i, j) for i in range(1, count, 2) for j in range(i + 4, count, 2)]
    seen = [queue.sees((turns[i].number, turns[j].number), 0.0, 0.0) for i, j in pairs]
    assert seen == [state.sees(0.0, i, j) for i, j in pairs]
    looking = [looks_inside(turns[i], walk.points[j] - walk.points[i]) for i, j in pairs]
    assert 0 < sum(seen) < sum(looking)


def test_most_gussets_of_crowded_disks_come_from_the_queue(monkeypatch: pytest.MonkeyPatch) -> None:
    queued = 0
    split = EventQueue.split

    def counting(self: EventQueue, *rest: Any) -> int | None:
        nonlocal queued
        queued += 1
        return split(self, *rest)

    monkeypatch.setattr(EventQueue, "split", counting)
    molecules = build_molecules(crowded_walk(40), SHEET, thresholds=Thresholds(near_only=10, queued=10))
    assert queued > 0.6 * (molecules.inside.gussets + molecules.outside.gussets)


def test_two_hundred_corners_are_folded_with_crowded_disks() -> None:
    angles = np.arange(200) * 2 * np.pi / 200
    reach = 100 + 15 * np.sin(7 * angles) + 3 * np.sin(31 * angles)
    loop = np.stack([reach * np.cos(angles), reach * np.sin(angles)], axis=1)
    result = foldcut.fold([loop], method="compact", effort="fast", min_crease=0)
    assert result.findings == ()


def test_layers_that_do_not_match_are_a_molecule_that_does_not_close() -> None:
    shape = placed(regular(5))
    molecules = build_molecules(walk(shape, [0.5] * 5), SHEET)
    order = molecules.outside.order
    shuffled = dataclasses.replace(molecules.outside, order=[order[1], order[0], *order[2:]])
    with pytest.raises(NotClosedError, match="do not match"):
        fold_molecules(dataclasses.replace(molecules, outside=shuffled), SHEET)
