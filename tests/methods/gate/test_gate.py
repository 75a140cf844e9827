"""Several loops by the equal-disk gate: whole patterns, and what the gate's moved layers are for."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from support.several_loops import random_loops
from support.strategies import Points, rectangle, regular

import foldcut
from foldcut.cli.main import main
from foldcut.core.errors import UnfoldableError
from foldcut.drawing.placement import parse_sheet, place
from foldcut.drawing.shape import make_shape
from foldcut.geometry.planar_graph import edge_faces
from foldcut.methods.disks.boundary import BoundaryDisks
from foldcut.methods.disks.packing import packing_faults
from foldcut.methods.disks.ribbon import default_ribbon
from foldcut.methods.disks.tolerance import Tolerance
from foldcut.methods.gate.parts import Parts, divide_faces
from foldcut.methods.gate.ring_sizes import MOST_DISKS, ROOMS, build_gated, fold_gated
from foldcut.methods.gate.rings import MOST, Ring, equal_sides, plan_rings
from foldcut.pattern.face_maps import fold_faces
from foldcut.proof.layers import check_stacking
from foldcut.proof.tolerance import COINCIDENT
from foldcut.proof.verify import verify
from foldcut.samples import sample_path

SHEET = parse_sheet("a4")
TRIANGULAR_HOLE: list[Points] = [
    [(-2.1, -2.0), (2.05, -2.05), (2.0, 2.1), (-2.02, 2.04)],
    [(-0.17, -0.09), (0.15, -0.1), (0.02, 0.17)],
]
ISLAND = [rectangle(20, 20), rectangle(12, 12), [(x + 0.4, y) for x, y in rectangle(3, 3)]]


@pytest.mark.parametrize("ribbon", [0.5, None])
@pytest.mark.parametrize("name", ["ring", "letter-a"])
def test_samples_with_a_hole_are_verified(name: str, ribbon: float | None) -> None:
    result = foldcut.fold(sample_path(name), method="gate", ribbon=ribbon)
    assert result.findings == ()
    assert result.method == "gate"


def test_two_components_are_verified() -> None:
    assert foldcut.fold(sample_path("two-triangles"), method="gate", margin=50).findings == ()


@pytest.mark.parametrize("loops", [TRIANGULAR_HOLE, ISLAND], ids=["triangular hole", "island in a hole"])
def test_drawn_shapes_are_verified(loops: list[Points]) -> None:
    assert foldcut.fold(loops, method="gate").findings == ()


@pytest.mark.parametrize("holes", [True, False], ids=["holes", "components"])
@pytest.mark.parametrize("seed", range(2))
def test_random_shapes_are_verified(seed: int, holes: bool) -> None:
    assert foldcut.fold(random_loops(seed, holes=holes), method="gate", margin=40).findings == ()


@pytest.fixture
def no_skeleton(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no shape have a straight skeleton."""

    def none(*_: object) -> None:
        raise UnfoldableError("there is no straight skeleton")

    monkeypatch.setattr("foldcut.methods.skeleton.search.skeleton_of", none)


@pytest.mark.usefixtures("no_skeleton")
def test_the_gate_is_made_only_where_it_is_asked_for() -> None:
    with pytest.raises(UnfoldableError, match="--method gate may fold the drawing as it is, with thousands of folds$"):
        foldcut.fold(TRIANGULAR_HOLE, effort="fast")
    assert foldcut.fold(TRIANGULAR_HOLE, effort="fast", method="gate").verified


def test_rings_are_equal_disks_that_touch_and_the_packing_is_one() -> None:
    shape, _ = place(make_shape(random_loops(0, holes=True)), SHEET)
    ribbon = default_ribbon(shape, SHEET)
    made = build_gated(shape, SHEET, ribbon, ROOMS[0])
    for ring in made.rings:
        sides = np.hypot(*(np.roll(ring.centres, -1, axis=0) - ring.centres).T)
        np.testing.assert_allclose(sides, 2 * ring.radius, rtol=1e-12)
        assert shapely.Polygon(ring.centres).contains(shapely.Polygon(shape.loops[ring.loop - 1]))
    strip = sum(shapely.LinearRing(loop).buffer(ribbon, join_style="mitre").area for loop in shape.loops)
    assert packing_faults(made.packing, SHEET.width * SHEET.height - strip, Tolerance.for_sheet(SHEET)) == []


@pytest.mark.parametrize("loops", [[rectangle(10, 10), rectangle(5, 5)], TRIANGULAR_HOLE], ids=["ring", "triangle"])
def test_without_the_moved_layers_verification_rejects_the_pattern(loops: list[Points]) -> None:
    shape, _ = place(make_shape(loops), SHEET)
    ribbon = default_ribbon(shape, SHEET)
    gated = build_gated(shape, SHEET, ribbon, ROOMS[0])
    assert verify(gated.creases, gated.folded.layers, shape) == []
    plain = build_gated(shape, SHEET, ribbon, ROOMS[0], move_layers=False)
    assert {one.check for one in verify(plain.creases, plain.folded.layers, shape)} == {"maekawa"}
    # Not only the count of mountains: the layers themselves cross.
    faces = edge_faces(plain.creases)
    found = check_stacking(
        plain.creases, faces, fold_faces(plain.creases, faces), plain.folded.layers, COINCIDENT[0] * SHEET.diagonal
    )
    assert "taco-tortilla" in {one.check for one in found}


def test_no_room_for_a_ring_is_refused_with_the_loop() -> None:
    shape, _ = place(make_shape([regular(40), [(0.999 * x, 0.999 * y) for x, y in regular(40)]]), SHEET)
    with pytest.raises(UnfoldableError, match=f"around loop 2.*at most {MOST} disks"):
        plan_rings(shape, SHEET, 0.0, ROOMS[0])
    with pytest.raises(UnfoldableError, match="2 loops cannot be joined.*loop 2"):
        fold_gated(shape, SHEET, 0.0)


def test_one_loop_needs_no_gate() -> None:
    with pytest.raises(UnfoldableError, match="one boundary loop"):
        foldcut.fold(sample_path("fish"), method="gate")


@pytest.mark.usefixtures("no_skeleton")
def test_the_command_reports_rings(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    drawing = tmp_path / "two.json"
    drawing.write_text(json.dumps({"loops": [loop.tolist() for loop in random_loops(3, holes=True)]}))
    command = ["make", str(drawing), "--method", "gate", "--margin", "40mm", "--effort", "fast", "--min-crease", "0mm"]
    assert main([*command, "-o", str(tmp_path / "two.fold")]) == 0
    said = capsys.readouterr().out
    assert re.search(r"method +gate: [1-3] rings, \d+ disks", said)
    assert "verified  " in said


def test_too_many_disks_are_refused_before_packing(monkeypatch: pytest.MonkeyPatch) -> None:
    shape, _ = place(make_shape(TRIANGULAR_HOLE), SHEET)
    monkeypatch.setattr("foldcut.methods.gate.ring_sizes.fill_gaps", None)
    monkeypatch.setitem(MOST_DISKS, "fast", 150)
    with pytest.raises(UnfoldableError, match=r"disks would be needed.* may have 150; give --effort best"):
        fold_gated(shape, SHEET, 0.1, "fast")
    monkeypatch.setitem(MOST_DISKS, "fast", 10)
    with pytest.raises(UnfoldableError, match="over 10 disks would be needed"):
        fold_gated(shape, SHEET, 0.1, "fast")


def test_no_disks_are_packed_when_the_time_is_over(monkeypatch: pytest.MonkeyPatch) -> None:
    shape, _ = place(make_shape(TRIANGULAR_HOLE), SHEET)
    monkeypatch.setattr("foldcut.methods.gate.ring_sizes.fill_gaps", None)
    with pytest.raises(UnfoldableError, match="the 0.0001 seconds are over; give more --seconds"):
        fold_gated(shape, SHEET, 0.1, seconds=0.0001)


def test_equal_sides_move_corners_a_little_and_a_side_of_no_length_not_at_all() -> None:
    corners = np.array(regular(9)) + 0.01 * np.random.default_rng(1).random((9, 2))
    moved = equal_sides(corners)
    lengths = np.hypot(*(np.roll(moved, -1, axis=0) - moved).T)
    np.testing.assert_allclose(lengths, lengths[0], rtol=1e-12)
    assert np.abs(moved - corners).max() < 0.02 * lengths[0]
    corners[4] = corners[3]
    assert np.array_equal(equal_sides(corners), corners)


def test_rings_that_overlap_are_refused_before_packing(monkeypatch: pytest.MonkeyPatch) -> None:
    shape, _ = place(make_shape([rectangle(10, 10), rectangle(5, 5)]), SHEET)

    def divide_wide(boundary: BoundaryDisks, rings: list[Ring]) -> Parts:
        """As if the rings had less room than they need."""
        parts = divide_faces(boundary, rings)
        return replace(parts, boundary=replace(parts.boundary, radii=1.2 * parts.boundary.radii))

    monkeypatch.setattr("foldcut.methods.gate.ring_sizes.divide_faces", divide_wide)
    monkeypatch.setattr("foldcut.methods.gate.ring_sizes.fill_gaps", None)
    with pytest.raises(UnfoldableError, match=r"disks of the rings overlap near \("):
        build_gated(shape, SHEET, 0.1, ROOMS[0])
