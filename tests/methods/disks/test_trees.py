"""Joining the molecules, for one boundary loop."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from support.stages import Stages, run_stages
from support.strategies import SINGLE_LOOPS, regular, star

from foldcut.core.errors import UnfoldableError
from foldcut.drawing.shape import make_shape
from foldcut.methods.base import require_one_loop
from foldcut.methods.disks.molecules import Kind
from foldcut.methods.disks.trees import assign_creases


def assignment_faults(stages: Stages) -> list[str]:
    """List what breaks the invariants of the assignment."""
    molecules, assignment = stages.molecules, stages.assignment
    faults = []
    if (assignment.entry_side < 0).any() or (assignment.parent < 0).sum() != 2:
        faults.append("T_M is not two spanning trees")
    children = Counter(assignment.corner_tree[:, 0].tolist())
    if max(children.values()) > 1:
        faults.append("a corner has two parents in T_C")
    excess: Counter[int] = Counter()
    on_border: set[int] = set()
    for (a, b), kind in zip(molecules.creases.tolist(), assignment.crease_assignment.tolist(), strict=True):
        for vertex in (a, b):
            excess[vertex] += {"M": 1, "V": -1}.get(kind, 0)
            if kind == "B":
                on_border.add(vertex)
    off = [vertex for vertex, value in excess.items() if abs(value) != 2 and vertex not in on_border]
    if off:
        faults.append(f"{len(off)} vertices have not two mountains or valleys more, such as {off[0]}")
    return faults


@pytest.mark.parametrize("name", SINGLE_LOOPS)
@pytest.mark.parametrize("ribbon", [0.0, 0.3])
def test_trees_span_and_every_vertex_has_two_more_mountains_or_valleys(name: str, ribbon: float) -> None:
    assert assignment_faults(run_stages([SINGLE_LOOPS[name]], ribbon=ribbon)) == []


def test_bisectors_are_mountains_and_one_tangency_edge_of_each_part_too() -> None:
    stages = run_stages([star(5, 0.4)])
    kinds, assignment = stages.molecules.crease_kind, stages.assignment.crease_assignment
    assert set(assignment[kinds == Kind.BISECTOR]) == {"M"}
    assert set(assignment[kinds == Kind.DIAGONAL]) == {"V"}
    tangency = np.flatnonzero((kinds == Kind.TANGENCY) & (assignment == "M"))
    parts = list(
        zip(
            stages.molecules.crease_molecule[tangency].tolist(),
            stages.molecules.crease_part[tangency].tolist(),
            strict=True,
        )
    )
    assert len(parts) == len(set(parts)) == sum(max(row) + 1 for row in stages.molecules.side_part)


def test_the_shapes_boundary_is_not_folded_and_the_trees_meet_at_one_tangency_point() -> None:
    stages = run_stages([regular(7)])
    assignment, molecules = stages.assignment, stages.molecules
    sides = molecules.boundary_sides[molecules.boundary_sides[:, 3] > 0]
    unfolded = {frozenset(row) for row in molecules.creases[assignment.crease_assignment == "F"].tolist()}
    assert unfolded == {frozenset(pair) for a, t, b, _ in sides.tolist() for pair in ((a, t), (t, b))}
    feet = [int(molecules.feet[root][assignment.entry_side[root]]) for root in assignment.roots]
    assert feet[0] == feet[1]


def test_several_loops_are_refused_by_name() -> None:
    ring = make_shape([[(0, 0), (30, 0), (30, 30), (0, 30)], [(10, 10), (20, 10), (20, 20), (10, 20)]])
    with pytest.raises(UnfoldableError, match=r"2 boundary loops.*loop 1 \(outer.*loop 2 \(hole, 4 corners"):
        require_one_loop(ring)


def test_an_unconnected_tree_is_an_error() -> None:
    stages = run_stages([SINGLE_LOOPS["triangle"]])
    molecules = stages.molecules
    molecules.boundary_sides.setflags(write=True)
    molecules.boundary_sides[molecules.boundary_sides[:, 3] > 0, 3] = 0  # a sheet without a shape
    with pytest.raises(UnfoldableError, match="does not reach every corner"):
        assign_creases(molecules, stages.packing.face_inside)
