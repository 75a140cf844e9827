"""The paper's own assignment: Kawasaki and Maekawa hold at every vertex, and no layer order folds it."""

from __future__ import annotations

import dataclasses
import math
from collections import defaultdict
from collections.abc import Iterator

import numpy as np
import pytest
from oracles.papers_rule import papers_assignment
from support.single_vertex import folds_flat
from support.stages import Stages, run_stages
from support.strategies import star

from foldcut.core.model import CreasePattern, FoldedState
from foldcut.methods.disks.layers import fold_layers
from foldcut.proof.verify import verify


@pytest.fixture(scope="module")
def stages() -> Stages:
    return run_stages([star(5, 0.4)])


@pytest.fixture(scope="module")
def folded(stages: Stages) -> tuple[CreasePattern, FoldedState]:
    paper = papers_assignment(stages.molecules, stages.packing.face_inside)
    return fold_layers(stages.molecules, dataclasses.replace(stages.assignment, crease_assignment=paper))


def around_vertices(pattern: CreasePattern) -> Iterator[tuple[list[float], list[str]]]:
    """The sectors in degrees and the crease before each, of every vertex off the border."""
    at: dict[int, list[tuple[float, str]]] = defaultdict(list)
    for (a, b), kind in zip(pattern.edges_vertices.tolist(), pattern.edges_assignment.tolist(), strict=True):
        x, y = pattern.vertices_coords[b] - pattern.vertices_coords[a]
        at[a].append((math.degrees(math.atan2(y, x)), kind))
        at[b].append((math.degrees(math.atan2(-y, -x)), kind))
    for spokes in at.values():
        if all(kind != "B" for _, kind in spokes):
            spokes.sort()
            angles = [angle for angle, _ in spokes]
            sectors = [(b - a) % 360 for a, b in zip(angles, angles[1:] + angles[:1], strict=True)]
            yield sectors, [kind for _, kind in spokes]


def test_kawasaki_and_maekawa_hold_at_every_vertex(folded: tuple[CreasePattern, FoldedState]) -> None:
    pattern, _ = folded
    vertices = list(around_vertices(pattern))
    assert len(vertices) > 100
    for sectors, kinds in vertices:
        assert sum(sectors[::2]) == pytest.approx(180)
        assert abs(kinds.count("M") - kinds.count("V")) == 2


def test_some_vertices_have_no_layer_order_at_all(folded: tuple[CreasePattern, FoldedState]) -> None:
    # Around one vertex, whatever the rest of the sheet does, none of the 720 orders of six layers is possible.
    pattern, _ = folded
    six = [(sectors, kinds) for sectors, kinds in around_vertices(pattern) if len(kinds) == 6]
    assert any(not folds_flat(sectors, kinds) for sectors, kinds in six)


def test_our_assignment_folds_at_every_vertex_of_the_same_creases(stages: Stages) -> None:
    pattern, _ = fold_layers(stages.molecules, stages.assignment)
    six = [(sectors, kinds) for sectors, kinds in around_vertices(pattern) if len(kinds) == 6]
    assert len(six) > 10
    assert all(folds_flat(sectors, kinds) for sectors, kinds in six)


def test_verification_rejects_it(stages: Stages, folded: tuple[CreasePattern, FoldedState]) -> None:
    pattern, state = folded
    findings = verify(pattern, state.layers)
    assert findings
    assert {finding.check for finding in findings} <= {"mountain-valley", "layers"}
    ours, its_state = fold_layers(stages.molecules, stages.assignment)
    assert verify(ours, its_state.layers) == []
    assert np.array_equal(ours.vertices_coords, pattern.vertices_coords)
