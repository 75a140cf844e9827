"""The folded state."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from support.stages import run_stages
from support.strategies import SINGLE_LOOPS, star

from foldcut.core.model import CreasePattern, FoldedState
from foldcut.geometry.vectors import signed_area
from foldcut.methods.disks.layers import fold_layers


def layer_faults(pattern: CreasePattern, folded: FoldedState) -> list[str]:
    """List what breaks the invariants of the folded state, crease by crease."""
    rank = np.empty(len(folded.layers), dtype=int)
    rank[folded.layers] = np.arange(len(rank))
    faces = pattern.faces_vertices.to_lists()
    up = [signed_area(folded.vertices_coords[face]) > 0 for face in faces]
    beside = {side: n for n, face in enumerate(faces) for side in zip(face, face[1:] + face[:1], strict=True)}
    faults = [] if up[0] else ["face 0 looks down"]
    for (a, b), kind in zip(pattern.edges_vertices.tolist(), pattern.edges_assignment.tolist(), strict=True):
        one, other = beside.get((a, b)), beside.get((b, a))
        if kind == "B":
            faults += [] if (one is None) != (other is None) else [f"border edge {a}-{b} is inside"]
        elif one is None or other is None:
            faults.append(f"crease {a}-{b} has paper on one side only")
        elif up[one] == up[other]:
            faults.append(f"the faces at crease {a}-{b} look the same way")
        else:
            above, below = (other, one) if up[one] else (one, other)
            if (kind == "V") != (rank[above] > rank[below]):
                faults.append(f"crease {a}-{b} is {kind} against the layer order")
    return faults


@pytest.mark.parametrize("name", SINGLE_LOOPS)
@pytest.mark.parametrize("ribbon", [0.0, 0.3])
def test_mountains_and_valleys_are_what_the_stack_says(name: str, ribbon: float) -> None:
    stages = run_stages([SINGLE_LOOPS[name]], ribbon=ribbon)
    assert layer_faults(*fold_layers(stages.molecules, stages.assignment)) == []


def test_the_checker_sees_a_flipped_crease_and_a_swapped_pair() -> None:
    stages = run_stages([SINGLE_LOOPS["triangle"]])
    pattern, folded = fold_layers(stages.molecules, stages.assignment)
    flipped = pattern.edges_assignment.copy()
    crease = int(np.flatnonzero(flipped == "M")[0])
    flipped[crease] = "V"
    assert len(layer_faults(dataclasses.replace(pattern, edges_assignment=flipped), folded)) == 1
    swapped = folded.layers.copy()
    swapped[[4, 5]] = swapped[[5, 4]]
    assert layer_faults(pattern, dataclasses.replace(folded, layers=swapped)) != []


def test_facets_on_both_sides_of_the_shapes_boundary_are_one_face() -> None:
    stages = run_stages([star(5, 0.4)])
    pattern, folded = fold_layers(stages.molecules, stages.assignment)
    heights = [folded.vertices_coords[face][:, 1] for face in pattern.faces_vertices]
    crossing = sum(h.min() < -1e-9 and h.max() > 1e-9 for h in heights)
    sides = stages.molecules.boundary_sides
    assert crossing == 2 * (sides[:, 3] > 0).sum()


def test_no_vertex_is_left_on_a_straight_crease() -> None:
    stages = run_stages([star(5, 0.4)])
    pattern, _ = fold_layers(stages.molecules, stages.assignment)
    degree = np.bincount(pattern.edges_vertices.ravel())
    corners = {tuple(corner) for corner in stages.sheet.corners.tolist()}
    two = {tuple(point) for point in pattern.vertices_coords[degree == 2].tolist()}
    assert two <= corners


def test_the_cut_line_is_height_zero_and_the_ribbon_lies_on_both_sides_of_it() -> None:
    for ribbon in (0.0, 0.4):
        stages = run_stages([star(5, 0.4)], ribbon=ribbon)
        _, folded = fold_layers(stages.molecules, stages.assignment)
        heights = folded.vertices_coords[:, 1]
        assert heights.min() < -ribbon <= ribbon < heights.max()
        assert not (np.abs(heights) < ribbon - 1e-9).any()
