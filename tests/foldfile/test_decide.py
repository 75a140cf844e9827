"""Any pattern is decided: it folds, it does not, or that is not decided, each with one sentence."""

from __future__ import annotations

import json
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.flat_patterns import Document, strip, twist, vertex
from support.folded import folded_sample
from support.single_vertex import folds_flat

from foldcut.cli.main import main
from foldcut.exporters import export
from foldcut.foldfile.decide import Decision, decide
from foldcut.foldfile.read import FoldFile, read_fold
from foldcut.proof.verify import PairOrder, verify


def read(document: Document, folder: Path) -> FoldFile:
    path = folder / "pattern.fold"
    path.write_text(json.dumps(document))
    return read_fold(path)


def decided(document: Document, folder: Path, **options: Any) -> Decision:
    return decide(read(document, folder), **options)


def in_a_circle(decision: Decision) -> bool:
    """Whether the order that was found cannot be written as a list."""
    assert decision.pairs is not None
    left = set(map(tuple, decision.pairs.tolist()))
    while left:
        upper = {one for one, _ in left}
        kept = {(one, other) for one, other in left if other in upper}
        if kept == left:
            return True
        left = kept
    return False


# ---- orders that are found


def test_a_square_twist_folds_with_its_pleats_in_a_circle(tmp_path: Path) -> None:
    decision = decided(twist(4, 45, "MVM"), tmp_path)
    assert decision.folds is True
    assert in_a_circle(decision)
    assert "one was found" in decision.sentence


@pytest.mark.parametrize(("sides", "turn"), [(3, 60), (4, 45), (4, -45), (5, 40), (6, 30)])
def test_twists_fold_both_ways_up(sides: int, turn: float, tmp_path: Path) -> None:
    first = [decided(twist(sides, turn, letters), tmp_path).folds for letters in ("MMV", "MVM")]
    assert first[(turn > 0)] is True
    swapped = [decided(twist(sides, turn, letters), tmp_path).folds for letters in ("VVM", "VMV")]
    assert swapped == first


def test_unassigned_creases_are_folded_whichever_way_fits(tmp_path: Path) -> None:
    decision = decided(twist(4, 45, "UUU"), tmp_path)
    assert decision.folds is True
    assert set(decision.pattern.edges_assignment.tolist()) == {"B", "M", "V"}
    assert decision.pairs is not None
    assert verify(decision.pattern, PairOrder(decision.pairs)) == []


@pytest.mark.parametrize("letters", ["MVMVVV", "MMMVMV", "MVMMVM", "VVMVMV", "VMVMMM"])
def test_a_vertex_is_decided_as_brute_force_decides_it(letters: str, tmp_path: Path) -> None:
    six = (35.0, 55.0, 95.0, 40.0, 50.0, 85.0)
    assert decided(vertex(six, letters), tmp_path).folds is folds_flat(six, letters)


def test_strips_are_decided_as_their_lengths_say(tmp_path: Path) -> None:
    # a part between two creases of the same kind must not be shorter than both parts beside it
    for letters in product("MV", repeat=2):
        blocked = letters[0] == letters[1]
        assert decided(strip((20, 10, 20), "".join(letters)), tmp_path).folds is not blocked
        assert decided(strip((5, 10, 5.5), "".join(letters)), tmp_path).folds is True


# ---- what does not fold


def test_creases_that_block_each_other_are_named(tmp_path: Path) -> None:
    decision = decided(strip((30, 20, 10, 20), "MVV"), tmp_path)
    assert decision.folds is False
    assert "these 2 cannot all be folded as assigned" in decision.sentence
    assert "V at (50, 5), V at (60, 5)" in decision.sentence


def test_a_triangle_that_no_mountains_and_valleys_fold_is_told(tmp_path: Path) -> None:
    # the angle of 60 degrees is the smallest at each corner, so any two sides of the triangle would have to differ
    decision = decided(twist(3, 0, "UUU"), tmp_path)
    assert decision.folds is False
    assert "whichever creases are mountains" in decision.sentence
    assert decided(twist(3, 0, "MMV"), tmp_path).folds is False
    assert decided(twist(3, 60, "UUU"), tmp_path).folds is True


def test_an_order_that_blocks_is_told_from_a_pattern_that_does_not_fold(tmp_path: Path) -> None:
    file = strip((20, 20, 20), "VV") | {"faces_vertices": [[0, 2, 3, 1], [2, 4, 5, 3], [4, 6, 7, 5]]}
    for orders, folds in (([], True), ([[2, 0, -1]], True), ([[2, 0, 1]], True), ([[1, 0, -1]], False)):
        decision = decided(file | {"faceOrders": orders}, tmp_path)
        assert decision.folds is folds, orders
    assert "as the file says, though it does in another layer order" in decision.sentence


# ---- coordinates


@pytest.mark.parametrize("sample", ["fish", "star", "plus", "ring"])
@pytest.mark.parametrize("share", [1e-7, 1e-6, 1e-5])
def test_our_own_patterns_are_accepted_with_rounded_coordinates(sample: str, share: float, tmp_path: Path) -> None:
    document = json.loads(export(folded_sample(sample), ".fold"))
    step = share * np.hypot(*np.ptp(document["vertices_coords"], axis=0))
    document["vertices_coords"] = (np.round(np.array(document["vertices_coords"]) / step) * step).tolist()
    decision = decided(document, tmp_path)
    assert decision.folds is True
    assert decision.moved is not None
    assert 0 < decision.moved.most < 5 * step
    assert "vertices moved by at most" in decision.notes[0]
    assert decided(document, tmp_path, tolerance=0).folds is False
    layers = document["foldcut:layers"]
    document["foldcut:layers"] = [*layers[1:], layers[0]]
    assert decided(document, tmp_path).folds is False
    document |= {"foldcut:layers": None, "faceOrders": []}
    del document["foldcut:layers"]
    assert decided(document, tmp_path).folds is True


def test_a_vertex_that_is_too_far_off_is_named_with_how_far(tmp_path: Path) -> None:
    off = twist(4, 45, "MVM")
    off["vertices_coords"][0][0] += 0.3
    decision = decided(off, tmp_path)
    assert decision.folds is False
    assert "would have to move by" in decision.sentence
    assert decided(off, tmp_path, tolerance=0.005).folds is True


# ---- what is read


def test_patterns_in_other_frames_are_read(tmp_path: Path) -> None:
    pattern = strip((20, 20, 20), "MV")
    inherited = {"frame_parent": 0, "frame_inherit": True, "frame_classes": ["creasePattern"]}
    coords = pattern.pop("vertices_coords")
    for document in (
        {"file_spec": 1.1, "file_frames": [pattern | {"vertices_coords": coords}]},
        pattern | {"file_frames": [{"frame_classes": []}, inherited | {"vertices_coords": coords}]},
        {"frame_classes": ["foldedForm"], "file_frames": [pattern | {"vertices_coords": coords}]},
    ):
        decision = decided(document, tmp_path)
        assert decision.folds is True
        assert len(decision.pattern.faces_vertices) == 3


def test_a_folded_form_alone_is_unfolded(tmp_path: Path) -> None:
    folded = strip((20, 20, 20), "MV") | {"frame_classes": ["foldedForm"]}
    folded["faces_vertices"] = [[0, 2, 3, 1], [2, 4, 5, 3], [4, 6, 7, 5]]
    folded["vertices_coords"] = [[x, y] for x in (20, 0, 20, 0) for y in (0, 10)]
    file = read(folded, tmp_path)
    assert np.ptp(file.pattern.vertices_coords, axis=0).tolist() == [60, 10]
    assert decide(file).folds is True


def test_angles_alone_joins_and_cuts_at_the_border_are_read(tmp_path: Path) -> None:
    pattern = strip((20, 20, 20), "MV")
    letters = pattern.pop("edges_assignment")
    angles = [{"M": -180, "V": 180}.get(letter) for letter in letters]
    file = read(pattern | {"edges_foldAngle": angles}, tmp_path)
    assert file.pattern.edges_assignment.tolist() == letters
    assert read(pattern, tmp_path).pattern.edges_assignment.tolist() == list("BUUBBBBBBB")
    cut = read(pattern | {"edges_assignment": ["C", "J", "M", *letters[3:]]}, tmp_path)
    assert cut.pattern.edges_assignment.tolist()[:4] == list("BFMB")
    assert decide(cut).folds is True


def test_what_was_not_compared_is_not_decided(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "cut.fold"
    pattern = strip((20, 20, 20), "MV")
    path.write_text(json.dumps(pattern | {"edges_assignment": ["B", "C", *pattern["edges_assignment"][2:]]}))
    assert main(["check", str(path)]) == 3
    assert "not decided: edge 1 at (20, 5) cuts into the sheet" in capsys.readouterr().err
    path.write_text(json.dumps(pattern))
    assert main(["check", str(path)]) == 0
    path.write_text(json.dumps(strip((20, 10, 20), "VV")))
    assert main(["check", str(path)]) == 1


@pytest.mark.parametrize("tolerance", ["nought", "-1", "0.5", "nan"])
def test_a_tolerance_has_to_be_a_share(tolerance: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a.fold"
    path.write_text(json.dumps(strip((20, 20), "M")))
    assert main(["check", str(path), f"--tolerance={tolerance}"]) == 2
    assert "give a part of the sheet's diagonal" in capsys.readouterr().err


def test_unassigned_lines_that_cannot_be_folded_stay_flat(tmp_path: Path) -> None:
    # a vertex on a crease, with a line to the border that no fold can go along
    pattern = strip((20, 20), "M")
    pattern["vertices_coords"] += [[20, 5], [40, 3]]
    pattern["edges_vertices"] = [*pattern["edges_vertices"][:1], [2, 6], *pattern["edges_vertices"][2:], [6, 3], [6, 7]]
    pattern["edges_assignment"] += ["M", "U"]
    at = pattern["edges_vertices"].index([4, 5])
    pattern["edges_vertices"][at] = [4, 7]
    pattern["edges_vertices"].append([7, 5])
    pattern["edges_assignment"].append("B")
    decision = decided(pattern, tmp_path)
    assert decision.folds is True
    assert decision.pattern.edges_assignment.tolist().count("F") == 1
