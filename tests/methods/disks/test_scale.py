"""Fast code against the simple code it replaced: the same results, number by number."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles import simple_assignment, simple_layers, simple_molecules
from oracles.simple_boundary import distances_to_edges
from support.paper import random_paper
from support.places import ROOT
from support.samples import TESTED
from support.several_loops import random_loops
from support.strategies import DISK_SHAPES, star, star_shaped, two_opt

import foldcut
from foldcut.core.arrays import Ragged
from foldcut.core.compiled import COMPILED, expect_many_drawings
from foldcut.core.errors import UnfoldableError
from foldcut.drawing.placement import parse_sheet, place
from foldcut.drawing.shape import make_shape
from foldcut.geometry import box_tree as layertree
from foldcut.geometry import planar_graph as planar
from foldcut.geometry.box_tree import LayerTree
from foldcut.geometry.planar_graph import edge_faces, edge_lengths, edge_sides, half_edges
from foldcut.methods.disks import packing
from foldcut.methods.disks.boundary import BoundaryDisks, boundary_disks
from foldcut.methods.disks.chains import StuckError
from foldcut.methods.disks.disk_pairs import near_disks
from foldcut.methods.disks.dividing import NEARLY
from foldcut.methods.disks.layers import fold_layers
from foldcut.methods.disks.loops import distances_to_edges as nearest_edges
from foldcut.methods.disks.molecules import build_molecules
from foldcut.methods.disks.packing import Packing, fill_gaps
from foldcut.methods.disks.rolling import EQUAL
from foldcut.methods.disks.tolerance import Tolerance
from foldcut.methods.disks.trees import assign_creases
from foldcut.pattern import face_maps as flatfold
from foldcut.pattern.face_maps import fold_faces
from foldcut.proof import cut as cutline
from foldcut.proof.verify import verify
from foldcut.readers import read_shape
from foldcut.samples import sample_path

SHEET = parse_sheet("a4")
TOLERANCE = Tolerance.for_sheet(SHEET)
RANDOM = int(os.environ.get("FOLDCUT_RANDOM_SCALE", "6"))


def cases() -> Iterator[tuple[str, Any, float]]:
    """Yield names, loops and ribbons: samples, shapes with ties and touching disks, random ones."""
    for name in TESTED:
        loops = read_shape(sample_path(name)).loops
        yield name, loops, 0.0
        yield f"{name} with a ribbon", loops, 0.1
    for name in ("square", "cross", "star"):
        if name in DISK_SHAPES:
            yield f"exact {name}", DISK_SHAPES[name], 0.0
    yield "star of 40", [star(40, 0.8)], 0.0
    turns, reach = 2 * np.pi * np.arange(250) / 250, 1 + 0.02 * np.random.default_rng(1).random(250)
    yield "rough circle of 250", [np.column_stack([reach * np.cos(turns), reach * np.sin(turns)])], 0.02
    for seed in range(RANDOM):
        rng = np.random.default_rng(seed)
        yield f"star-shaped {seed}", [star_shaped(rng, int(rng.integers(5, 25)))], 0.0
        yield f"tour {seed}", [two_opt(rng, int(rng.integers(5, 25)))], 0.02
        yield f"holes {seed}", random_loops(seed, holes=True), 0.0


CASES = {name: (loops, ribbon) for name, loops, ribbon in cases()}


def disks(name: str) -> BoundaryDisks:
    loops, ribbon = CASES[name]
    shape, _ = place(make_shape(loops), SHEET, margin=20.0)
    return boundary_disks(shape, SHEET, ribbon, TOLERANCE)


def differences(one: object, other: object) -> list[str]:
    """Return the fields in which two dataclasses of arrays differ by a bit, a type or a sign of zero."""
    found = []
    for field in fields(one):  # type: ignore[arg-type]
        a, b = getattr(one, field.name), getattr(other, field.name)
        pairs = [(a.values, b.values), (a.offsets, b.offsets)] if isinstance(a, Ragged) else [(a, b)]
        if any(np.asarray(x).tobytes() != np.asarray(y).tobytes() for x, y in pairs):
            found.append(field.name)
    return found


def python_path() -> str:
    return os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])


def filled(name: str) -> Packing:
    return fill_gaps(disks(name), TOLERANCE)


@pytest.mark.parametrize("name", CASES)
def test_compiled_code_fills_gaps_as_the_simple_code_does(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    packing_compiled = pytest.importorskip("foldcut.methods.disks.packing_compiled", reason="needs numba")
    boundary = disks(name)
    started = []
    start = packing_compiled.GapFiller.start
    monkeypatch.setattr(packing_compiled.GapFiller, "start", lambda *args: started.append(1) or start(*args))
    monkeypatch.setattr(packing, "MANY_DISKS", 0)
    compiled = fill_gaps(boundary, TOLERANCE)
    assert len(started) == len(boundary.face_inside)
    monkeypatch.setattr(packing, "MANY_DISKS", 10**9)
    simple = fill_gaps(boundary, TOLERANCE)
    assert len(started) == len(boundary.face_inside)
    assert differences(compiled, simple) == []


@pytest.mark.parametrize("many", [True, False])
def test_compiled_code_fills_small_gaps_where_many_drawings_are_expected(
    many: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    packing_compiled = pytest.importorskip("foldcut.methods.disks.packing_compiled", reason="needs numba")
    asked = []
    fill = packing_compiled.GapFiller.fill
    monkeypatch.setattr(packing_compiled.GapFiller, "fill", lambda *args: asked.append(1) or fill(*args))
    monkeypatch.setattr(COMPILED, "many_drawings", many)
    filled("fish")
    assert bool(asked) == many


@pytest.mark.parametrize("many", [True, False])
def test_what_a_process_expects_decides_not_what_is_loaded(many: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("foldcut.geometry.box_tree_compiled", reason="needs numba")
    monkeypatch.setattr(COMPILED, "many_drawings", False)
    if many:
        expect_many_drawings()
    assert COMPILED.many_drawings == many
    boxes = np.zeros((layertree.MANY_BOXES_ONCE_LOADED, 1))
    assert LayerTree(boxes, boxes).is_compiled == many
    assert not LayerTree(boxes[1:], boxes[1:]).is_compiled
    assert COMPILED.pays(layertree.MANY_BOXES, layertree.MANY_BOXES, layertree.MANY_BOXES_ONCE_LOADED)


def test_a_gap_that_nothing_divides_is_refused_with_its_place(monkeypatch: pytest.MonkeyPatch) -> None:
    packing_compiled = pytest.importorskip("foldcut.methods.disks.packing_compiled", reason="needs numba")
    chain = np.arange(2, dtype=np.int32)  # there is no gap between two disks
    filler = packing_compiled.GapFiller(TOLERANCE.tie, TOLERANCE.rounding, NEARLY, EQUAL)
    filler.start(chain, np.array([(0.0, 0.0), (2.0, 0.0)]), np.ones(2), 2)
    with pytest.raises(StuckError) as caught:
        filler.fill(chain, lambda: None)
    assert caught.value.chains == [[0, 1]]
    assert caught.value.place == (1.0, 0.0)

    def stuck(*_: object) -> None:
        raise StuckError([[3, 4], [5, 6, 7]], (1.25, 2.5))

    monkeypatch.setattr(packing_compiled.GapFiller, "fill", stuck)
    monkeypatch.setattr(packing, "MANY_DISKS", 0)
    with pytest.raises(UnfoldableError, match=r"gap of 2 and 3 disks near \(1.250, 2.500\) mm"):
        filled("fish")


def test_where_numba_lays_arrays_out_otherwise_they_keep_their_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    numba = pytest.importorskip("numba")
    packing_compiled = pytest.importorskip("foldcut.methods.disks.packing_compiled", reason="needs numba")
    without_counts = packing_compiled.uncounted
    state = (np.arange(5.0), np.arange(4, dtype=np.int32))

    def total(state: tuple[np.ndarray, np.ndarray]) -> float:
        own = without_counts(state)
        own[0][0] += 1.0
        return own[0].sum() + own[1].sum()

    assert numba.njit(total)(state) == 17
    monkeypatch.setattr(packing_compiled, "cgutils", object())
    counted = sys.getrefcount(state[0])
    assert numba.njit(total)(state) == 18
    after = sys.getrefcount(state[0])  # not inside an assert, which would hold one more reference
    assert after == counted


def test_who_waits_for_the_compiler_is_told(tmp_path: Path) -> None:
    pytest.importorskip("numba")
    code = (
        "import foldcut, foldcut.core.compiled, foldcut.methods.disks.packing_compiled as packing_compiled\n"
        "class Enough(Exception): pass\n"
        "def stop(*args): raise Enough\n"
        "packing_compiled.GapFiller.fill = stop\n"
        "foldcut.core.compiled.expect_many_drawings()\n"
        "try: foldcut.fold([[(0, 0), (3, 0), (0, 2)]], method='paper', progress=lambda stage, _: print(stage))\n"
        "except Enough: pass"
    )
    environment = {**os.environ, "PYTHONPATH": python_path(), "NUMBA_CACHE_DIR": str(tmp_path)}
    for told in (True, False):
        run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment)
        assert (f"packing: {packing.COMPILING}" in run.stdout.splitlines()) == told, run.stdout + run.stderr


def test_the_comparison_sees_one_bit() -> None:
    packed = filled("fish")
    radii = packed.radii.copy()
    radii[3] = np.nextafter(radii[3], 2 * radii[3])
    assert differences(Packing(**{**vars(packed), "radii": radii}), packed) == ["radii"]


@pytest.mark.parametrize("name", CASES)
def test_molecules_are_made_at_once_as_one_by_one(name: str) -> None:
    packed = filled(name)
    at_once = build_molecules(packed, TOLERANCE)
    assert differences(at_once, simple_molecules.build_molecules(packed, TOLERANCE)) == []


@pytest.mark.parametrize("name", [name for name in CASES if len(CASES[name][0]) == 1])
def test_assignment_and_layers_are_those_of_the_simple_code(name: str) -> None:
    packed = filled(name)
    molecules = build_molecules(packed, TOLERANCE)
    assignment = assign_creases(molecules, packed.face_inside)
    assert differences(assignment, simple_assignment.assign_creases(molecules, packed.face_inside)) == []
    creases, folded = fold_layers(molecules, assignment)
    simple_creases, simple_folded = simple_layers.fold_layers(molecules, assignment)
    assert differences(creases, simple_creases) == []
    assert differences(folded, simple_folded) == []


@pytest.mark.parametrize("seed", range(5))
def test_nearest_edges_are_those_of_all_pairs(seed: int) -> None:
    rng = np.random.default_rng(seed)
    starts = [np.array(star_shaped(rng, 20)), 0.1 * np.array(star_shaped(rng, 3))]
    ends = [np.roll(points, -1, axis=0) for points in starts]
    quick = nearest_edges(starts, ends)
    assert all(np.array_equal(a, b) for a, b in zip(quick, distances_to_edges(starts, ends), strict=True))


def test_pairs_of_chosen_disks_are_those_among_all_pairs() -> None:
    rng = np.random.default_rng(3)
    centres, radii = rng.random((300, 2)), 0.1 * rng.random(300)
    face, chosen = rng.integers(-1, 3, 300), rng.random(300) < 0.2
    i, j, slack = near_disks(centres, radii, face)
    mine = chosen[i] | chosen[j]
    expected = sorted(zip(i[mine].tolist(), j[mine].tolist(), slack[mine].tolist(), strict=True))
    assert sorted(zip(*(a.tolist() for a in near_disks(centres, radii, face, chosen)), strict=True)) == expected
    assert 50 < len(expected) < len(i)


def test_compiled_code_finds_the_meetings_that_array_code_finds(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("numba")
    rng = np.random.default_rng(4)
    low, high = (np.sort(rng.random((2, 500, 3)), axis=0)) * [1.0, 0.3, 0.3]
    first = rng.integers(0, 500, 500)
    last = np.minimum(first + rng.integers(0, 200, 500), 500)

    def meetings() -> list[tuple[int, int]]:
        found = [*LayerTree(low, high).meetings(low, high, first, last)]
        return sorted(pair for query, item in found for pair in zip(query.tolist(), item.tolist(), strict=True))

    expected = meetings()
    monkeypatch.setattr(layertree, "MANY_BOXES", 0)
    assert LayerTree(low, high).is_compiled
    monkeypatch.setattr(layertree, "BATCH", 100)
    assert meetings() == expected
    assert len(expected) > 1000


@pytest.mark.parametrize("name", ["star", "triangle", "swan"])
def test_edges_on_the_cut_line_tell_what_all_edges_tell(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    severed = foldcut.fold(sample_path(name), method="paper", ribbon=0)
    good = foldcut.fold(sample_path(name), method="paper", ribbon=0.5).folded_pattern
    monkeypatch.setattr(cutline, "MANY_EDGES", 0)
    pattern = severed.folded_pattern
    assert verify(pattern.creases, pattern.folded.layers, pattern.shape) == list(severed.findings) != []
    asked = []
    all_edges = cutline.edges_near

    def counted(pattern: Any, sides: Any, distance: float, among: Any = None) -> Any:
        asked.append(among is None)
        return all_edges(pattern, sides, distance, among)

    monkeypatch.setattr(cutline, "edges_near", counted)
    assert verify(good.creases, good.folded.layers, good.shape) == []
    assert asked == [False]


@pytest.mark.parametrize("seed", range(8))
def test_compiled_code_folds_faces_to_where_array_code_folds_them(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("numba")
    rng = np.random.default_rng(seed)
    pattern, _ = random_paper(rng, folds=int(rng.integers(1, 7)), lines=int(rng.integers(3))).pattern()
    faces = edge_faces(pattern)
    simple = fold_faces(pattern, faces)
    monkeypatch.setattr(flatfold, "MANY_FACES", 0)
    assert flatfold.compiled_fold() is not None
    quick = fold_faces(pattern, faces)
    assert np.array_equal(simple.up, quick.up)
    assert np.allclose(simple.turn, quick.turn, rtol=0, atol=1e-11)
    assert np.allclose(simple.shift, quick.shift, rtol=0, atol=1e-11)


def test_compiled_code_folds_over_the_longer_of_two_edges() -> None:
    pytest.importorskip("numba")
    rng = np.random.default_rng(1)
    pattern, _ = random_paper(rng, folds=6, lines=3).pattern()
    faces = edge_faces(pattern)
    from foldcut.pattern.face_maps_compiled import tree_of_faces

    ends = np.ascontiguousarray(pattern.edges_vertices), pattern.vertices_coords.copy()
    via = tree_of_faces(*np.ascontiguousarray(faces.T), *ends, len(pattern.faces_vertices), 1e-300)
    inner = np.flatnonzero((faces >= 0).all(axis=1))
    cost = 1 / edge_lengths(pattern)
    least, _ = flatfold.short_paths(*faces[inner].T, cost[inner], len(via))
    for face in range(len(via)):
        here, far, steps = face, 0.0, 0
        while here:
            far, here, steps = far + cost[via[here]], int(faces[via[here]].sum()) - here, steps + 1
            assert steps <= len(via)
        assert least[face] * (1 - 1e-6) <= far <= 2 * least[face]


@pytest.mark.parametrize("seed", range(8))
def test_half_edges_are_found_by_a_matrix_as_by_their_numbers(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(seed)
    pattern, _ = random_paper(rng, folds=5, lines=2).pattern()
    faces = pattern.faces_vertices.to_lists()
    twice = replace(pattern, faces_vertices=Ragged.from_rows([*faces, faces[0]]))
    fewer = replace(pattern, faces_vertices=Ragged.from_rows(faces[1:]))
    simple = [edge_sides(pattern), edge_sides(fewer)]
    monkeypatch.setattr(planar, "MANY_EDGES", 0)
    assert all(np.array_equal(one, edge_sides(of)) for one, of in zip(simple, (pattern, fewer), strict=True))
    for side, (tail, head) in zip(edge_sides(twice), pattern.edges_vertices.tolist(), strict=True):
        starts, ends = half_edges(twice.faces_vertices)
        for number, ways in zip(side.tolist(), ((tail, head), (head, tail)), strict=True):
            assert number < 0 or (starts[number], ends[number]) == ways
    assert np.array_equal(edge_sides(twice) >= 0, simple[0] >= 0)


def test_without_numba_all_is_done_by_the_simple_code() -> None:
    code = (
        "import sys; sys.modules['numba'] = None\n"
        "import foldcut; from foldcut.pattern import face_maps; from foldcut.geometry import box_tree\n"
        "from foldcut.methods.disks import packing\n"
        "packing.MANY_DISKS = box_tree.MANY_BOXES = face_maps.MANY_FACES = 0\n"
        "print(foldcut.fold([[(0, 0), (3, 0), (0, 2)]], method='paper').verified)"
    )
    environment = {**os.environ, "PYTHONPATH": python_path()}
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment)
    assert run.stdout.strip() == "True", run.stderr


def test_small_patterns_do_not_load_numba() -> None:
    code = (
        "import sys, foldcut; foldcut.fold([[(0, 0), (3, 0), (0, 2)]], method='paper'); print('numba' in sys.modules)"
    )
    environment = {**os.environ, "PYTHONPATH": python_path()}
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment)
    assert run.stdout.strip() == "False", run.stderr
