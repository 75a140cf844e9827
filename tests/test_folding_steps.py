"""The folding order: every state is verified, every straight fold is one, and every crease is folded once."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import shapely
from support.folded import folded_sample
from support.patterns import book_fold, build_pattern, letter_fold, square_out_of_square
from support.samples import TESTED

from foldcut.core.model import CreasePattern, FoldedPattern, FoldedState, Region
from foldcut.folding_steps import LEAST_GROUP, MOST_GROUPS, FoldingStep, folding_steps
from foldcut.proof.verify import verify


@cache
def folded(sample: str, method: str = "auto") -> FoldedPattern:
    """Fold a sample on A4."""
    return folded_sample(sample, method=method)


@cache
def steps_of(sample: str, method: str = "auto") -> tuple[FoldingStep, ...]:
    """Return the steps of a sample."""
    return folding_steps(folded(sample, method))


def flat_state(pattern: FoldedPattern) -> FoldedState:
    """Return the sheet before the first step."""
    creases = pattern.creases
    return FoldedState(creases.vertices_coords, np.arange(len(creases.faces_vertices), dtype=np.int32))


def bodies(creases: CreasePattern, state: FoldedState, less: float) -> list[shapely.Polygon]:
    """Return the faces where they lie, shrunk by ``less``."""
    return [shapely.Polygon(state.vertices_coords[ring]).buffer(-less) for ring in creases.faces_vertices]


def check_fold(pattern: FoldedPattern, before: FoldedState, step: FoldingStep) -> None:
    """Check that a step is a straight fold that paper can make, without the code that found it."""
    creases, tie = pattern.creases, 1e-6 * pattern.sheet.diagonal
    assert step.line is not None
    assert step.moved is not None
    start, end = step.line
    along = (end - start) / np.hypot(*(end - start))
    across = np.array([-along[1], along[0]])
    moved = set(step.moved.tolist())
    rest = set(range(len(creases.faces_vertices))) - moved
    assert moved
    assert rest
    # what moves is mirrored in the line, the rest stays
    at = before.vertices_coords
    mirrored = at - 2 * ((at - start) @ across)[:, None] * across
    for face, ring in enumerate(creases.faces_vertices):
        np.testing.assert_allclose(
            step.state.vertices_coords[ring], (mirrored if face in moved else at)[ring], atol=tie
        )
    # what moves is at one side of the line
    sides = (np.concatenate([at[creases.faces_vertices[face]] for face in moved]) - start) @ across
    assert sides.min() > -tie or sides.max() < tie
    # it hangs on the rest along the line, by creases that were open
    owners: dict[frozenset[int], list[int]] = {}
    for face, ring in enumerate(creases.faces_vertices.to_lists()):
        for pair in zip(ring, ring[1:] + ring[:1], strict=True):
            owners.setdefault(frozenset(pair), []).append(face)
    hinges = set()
    for edge, pair in enumerate(creases.edges_vertices.tolist()):
        faces = owners[frozenset(pair)]
        if len(faces) == 2 and (faces[0] in moved) != (faces[1] in moved):
            assert np.abs((at[pair] - start) @ across).max() < tie
            hinges.add(edge)
    assert hinges == set(step.edges.tolist())
    # nothing that stays lies in its way
    old, new = np.argsort(before.layers), np.argsort(step.state.layers)
    there, then = (bodies(creases, state, tie) for state in (before, step.state))
    for face in moved:
        for other in rest:
            if there[face].intersects(there[other]):
                assert (old[face] > old[other]) == step.over, "something lies on what moves"
            if then[face].intersects(then[other]):
                assert (new[face] > new[other]) == step.over, "what has moved does not lie outside"
    # and each part keeps its own order, the moved one upside down
    for part, sign in ((moved, -1), (rest, 1)):
        members = sorted(part)
        assert np.array_equal(np.argsort(old[members])[::sign], np.argsort(new[members]))


@pytest.mark.parametrize("sample", TESTED)
def test_each_crease_is_folded_once_and_the_verifier_accepts_the_sheet_after_each_step(sample: str) -> None:
    creases = folded(sample).creases
    done = np.zeros(len(creases.edges_vertices), dtype=bool)
    for step in steps_of(sample):
        assert not done[step.edges].any()
        done[step.edges] = True
        kinds = np.where(done | (creases.edges_assignment == "B"), creases.edges_assignment, "F")
        layers = step.state.layers
        if not _front_up(creases, step.state):
            layers = layers[::-1]  # the verifier looks at face 0 from its front
        assert verify(replace(creases, edges_assignment=kinds), layers) == []
    assert np.array_equal(done, np.isin(creases.edges_assignment, ("M", "V")))


def _front_up(creases: CreasePattern, state: FoldedState) -> bool:
    return bool(shapely.LinearRing(state.vertices_coords[creases.faces_vertices[0]]).is_ccw)


@pytest.mark.parametrize("sample", TESTED)
def test_straight_folds_are_straight_folds_of_the_sheet_as_it_lies(sample: str) -> None:
    pattern = folded(sample)
    before = flat_state(pattern)
    for step in steps_of(sample):
        if step.line is not None:
            check_fold(pattern, before, step)
        before = step.state


@pytest.mark.parametrize("sample", TESTED)
def test_the_last_state_is_the_verified_one_moved_or_turned_over(sample: str) -> None:
    pattern = folded(sample)
    last, end = steps_of(sample)[-1].state, pattern.folded
    one, other = (state.vertices_coords - state.vertices_coords[0] for state in (last, end))
    np.testing.assert_allclose(one @ one.T, other @ other.T, atol=1e-6 * pattern.sheet.diagonal**2)
    turned = _front_up(pattern.creases, last) != _front_up(pattern.creases, end)
    ranks = np.argsort(last.layers[::-1] if turned else last.layers), np.argsort(end.layers)
    tree = shapely.STRtree(shapes := bodies(pattern.creases, end, 1e-6 * pattern.sheet.diagonal))
    a, b = tree.query(shapes, predicate="intersects")
    assert np.array_equal(ranks[0][a] < ranks[0][b], ranks[1][a] < ranks[1][b])


def test_a_book_and_a_letter_are_straight_folds() -> None:
    (book,) = folding_steps(book_fold())
    assert book.line is not None
    assert sorted(book.line.tolist()) == [[50, 0], [50, 60]]
    assert book.over
    letter = folding_steps(letter_fold())
    assert [step.over for step in letter] == [True, True]
    assert [len(step.edges) for step in letter] == [1, 1]
    np.testing.assert_allclose([step.line[0, 0] for step in letter if step.line is not None], [30, 60])
    assert folding_steps(book_fold("M"))[0].over is False


def test_a_fan_around_one_point_is_no_row_of_straight_folds() -> None:
    steps = folding_steps(square_out_of_square())
    assert sum(len(step.edges) for step in steps) == 8
    assert any(step.line is None for step in steps)


def test_a_mirror_axis_is_folded_first_through_one_layer_and_what_follows_through_all() -> None:
    pattern = folded("tree", "mirror")
    first, second, *_ = folding_steps(pattern)
    assert first.line is not None
    assert {tuple(np.round(p, 6)) for p in first.line} == {tuple(np.round(p, 6)) for p in pattern.first_folds[0]}
    assert all(step.line is not None for step in folding_steps(pattern))
    assert len(second.edges) == 2


@pytest.mark.parametrize(("sample", "method"), [("fish", "compact"), ("swan", "compact"), ("heart", "compact")])
def test_groups_divide_what_collapses_and_what_is_inside_comes_first(sample: str, method: str) -> None:
    pattern = folded(sample, method)
    ends = pattern.creases.vertices_coords[pattern.creases.edges_vertices]
    for step in steps_of(sample, method):
        if step.line is None:
            assert sorted(np.concatenate(step.groups).tolist()) == sorted(step.edges.tolist())
            assert 1 < len(step.groups) <= MOST_GROUPS
            assert min(map(len, step.groups[:-1])) >= LEAST_GROUP
            places = {}
            for group, edges in enumerate(step.groups):
                for edge in edges.tolist():
                    region = _smallest_region(pattern.regions, ends[edge])
                    assert places.setdefault(region, group) == group
            for region, group in places.items():
                for above in _ancestors(pattern.regions, region):
                    assert places.get(above, MOST_GROUPS) >= group


def _smallest_region(regions: tuple[Region, ...], ends: np.ndarray) -> int:
    points = [shapely.Point(ends[0] * (1 - share) + ends[1] * share) for share in (0.02, 0.5, 0.98)]
    areas = [
        (shapely.Polygon(ring).area, number)
        for number, region in enumerate(regions)
        for ring in region.outlines
        if len(ring) > 2 and any(shapely.Polygon(ring).intersects(point) for point in points)
    ]
    return min(areas)[1]


def _ancestors(regions: tuple[Region, ...], region: int) -> list[int]:
    above = regions[region].parent
    return [] if above < 0 else [above, *_ancestors(regions, above)]


@pytest.mark.parametrize("method", ["compact", "paper"])
def test_regions_are_trees_on_the_sheet(method: str) -> None:
    pattern = folded("triangle", method)
    assert all(region.parent < len(pattern.regions) for region in pattern.regions)
    area = pattern.sheet.width * pattern.sheet.height
    tops = [region for region in pattern.regions if region.parent < 0]
    assert len(tops) == (1 if method == "compact" else 2)  # the whole sheet; or the molecules inside and outside
    if method == "paper":
        every = sum(shapely.Polygon(ring).area for region in pattern.regions for ring in region.outlines)
        assert every == pytest.approx(area, rel=0.02)  # except the ribbon
        (step,) = folding_steps(pattern)
        assert len(step.groups) == MOST_GROUPS


@pytest.mark.parametrize("sample", ["fish", "boat"])
def test_a_part_of_a_molecule_is_in_the_part_that_fell_apart(sample: str) -> None:
    regions = folded(sample, "compact").regions
    shapes = [shapely.Polygon(region.outlines[0]) for region in regions]
    depths = [len(_ancestors(regions, number)) for number in range(len(regions))]
    assert max(depths) >= 4
    for number, (region, shape) in enumerate(zip(regions, shapes, strict=True)):
        inside = shape.representative_point()
        if region.parent >= 0 and shape.is_valid and shapes[0].contains(inside):
            around = [k for k, other in enumerate(shapes) if k != number and other.area > shape.area]
            assert min((k for k in around if shapes[k].contains(inside)), key=lambda k: shapes[k].area) == region.parent


def test_without_regions_long_creases_come_first() -> None:
    pattern = replace(folded("fish"), regions=())
    (step,) = (step for step in folding_steps(pattern) if step.line is None)
    ends = pattern.creases.vertices_coords[pattern.creases.edges_vertices]
    lengths = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    for one, other in zip(step.groups, step.groups[1:], strict=False):
        assert lengths[one].min() >= lengths[other].max()


def test_a_roll_is_folded_from_its_inner_end() -> None:
    """A strip of four squares rolled up folds in one order only."""
    flat = [(10.0 * k, y) for y in (0.0, 10.0) for k in range(5)]
    x = [10, 0, 10, 0, 10]
    roll = build_pattern(
        flat=flat,
        folded=[(x[k], y - 5) for y in (0.0, 10.0) for k in range(5)],
        edges=[
            *((k, k + 1, "B") for k in range(4)),
            *((k + 5, k + 6, "B") for k in range(4)),
            (0, 5, "B"),
            (4, 9, "B"),
            *((k, k + 5, "V") for k in (1, 2, 3)),
        ],
        faces=[(k, k + 1, k + 6, k + 5) for k in range(4)],
        layers=[0, 2, 3, 1],
        loop=[(1, 1), (2, 1), (2, 2)],
    )
    assert verify(roll.creases, roll.folded.layers) == []
    steps = folding_steps(roll)
    assert [float(roll.creases.vertices_coords[roll.creases.edges_vertices[step.edges]].mean()) for step in steps] == [
        pytest.approx((x + 5) / 2) for x in (30, 20, 10)
    ]
    before = flat_state(roll)
    for step in steps:
        check_fold(roll, before, step)
        before = step.state
