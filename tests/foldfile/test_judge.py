"""Every field of a FOLD file that other programs read is judged: a lie in any of them is found, and says where."""

from __future__ import annotations

import json
import re
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.folded import folded_sample
from support.patterns import letter_fold, square_out_of_square

from foldcut.cli.main import main
from foldcut.core.errors import FileFormatError
from foldcut.core.model import Finding
from foldcut.exporters import export
from foldcut.foldfile.judge import incidences, judge
from foldcut.foldfile.read import read_fold

Document = dict[str, Any]


@pytest.fixture
def letter() -> Document:
    """Return the FOLD object of a sheet folded in three: faces 1 and 2 lie on face 0."""
    return json.loads(export(letter_fold(), ".fold"))  # type: ignore[no-any-return]


def judged(document: Document, folder: Path) -> list[Finding]:
    path = folder / "judged.fold"
    path.write_text(json.dumps({key: value for key, value in document.items() if value is not None}))
    return judge(read_fold(path))


@pytest.mark.parametrize("sample", ["fish", "plus", "ring"])
def test_what_foldcut_wrote_agrees_with_itself(sample: str, tmp_path: Path) -> None:
    document = json.loads(export(folded_sample(sample), ".fold"))
    assert judged(document, tmp_path) == []
    document["foldcut:layers"] = None
    assert judged(document, tmp_path) == []  # faceOrders alone prove it


# ---- angles ----


@pytest.mark.parametrize("angle", [90, -180, 0, 179])
def test_an_angle_that_does_not_fold_a_valley_flat_is_found(angle: float, letter: Document, tmp_path: Path) -> None:
    valley = letter["edges_assignment"].index("V")
    letter["edges_foldAngle"][valley] = angle
    (finding,) = judged(letter, tmp_path)
    assert str(finding).startswith(
        f"fields at (30, 25): edges_foldAngle[{valley}] is {angle} degrees, but the edge is V"
    )


def test_an_angle_at_the_border_is_found_and_null_says_nothing(letter: Document, tmp_path: Path) -> None:
    letter["edges_foldAngle"][0] = 180
    (finding,) = judged(letter, tmp_path)
    assert "edges_foldAngle[0] is 180 degrees, but the edge is B: 0" in finding.message
    letter["edges_foldAngle"] = [None] * 10
    assert judged(letter, tmp_path) == []


@pytest.mark.parametrize(
    ("angles", "words"),
    [
        ([0] * 9, "edges_foldAngle: must be a list of one number for each of the 10 edges"),
        ({}, "edges_foldAngle: must be a list"),
        ([0] * 9 + ["180"], "edges_foldAngle[9]: '180' is not a number"),
        ([0] * 9 + [10**4000], "edges_foldAngle[9]: 1000000000000000000000000000000000000000... is not a number"),
    ],
)
def test_angles_that_are_none_are_refused(angles: object, words: str, letter: Document, tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match=re.escape(words)):
        judged(letter | {"edges_foldAngle": angles}, tmp_path)


# ---- face orders ----


def test_face_orders_that_contradict_the_layers_are_found(letter: Document, tmp_path: Path) -> None:
    orders = letter["faceOrders"]
    for row in range(len(orders)):
        changed = deepcopy(orders)
        changed[row][2] *= -1
        (finding,) = judged(letter | {"faceOrders": changed}, tmp_path)
        f, g, _ = changed[row]
        assert finding.message.startswith(f"faceOrders[{row}] lays face {f} ")
        assert f"face {g}, foldcut:layers the other way round" in finding.message
    (finding,) = judged(letter | {"faceOrders": [*orders, [1, 1, 1]]}, tmp_path)
    assert f"faceOrders[{len(orders)}] lays face 1 " in finding.message


def test_face_orders_of_another_frame_are_judged(letter: Document, tmp_path: Path) -> None:
    letter["file_frames"][0]["faceOrders"] = [[f, g, -s] for f, g, s in letter["faceOrders"]]
    findings = judged(letter, tmp_path)
    assert [finding.message[:28] for finding in findings] == [f"file_frames[0].faceOrders[{n}]" for n in range(3)]
    findings = judged(letter | {"foldcut:layers": None}, tmp_path)
    assert len(findings) == 3
    assert "faceOrders the other way round" in findings[0].message


def test_face_orders_name_faces_that_are_there(letter: Document, tmp_path: Path) -> None:
    for row, words in (
        ([0, 99999, 1], "faceOrders[0][1]: 99999 is not a number from 0 to 2"),
        ([0, 1, 2], "2 is not 1"),
    ):
        with pytest.raises(FileFormatError, match=re.escape(words)):
            judged(letter | {"faceOrders": [row]}, tmp_path)


@pytest.mark.parametrize("left", [[], [0], [1], [2], [0, 1], [0, 2]])
def test_faces_without_an_order_prove_nothing(left: list[int], letter: Document, tmp_path: Path) -> None:
    letter["foldcut:layers"] = None
    orders = letter["faceOrders"]  # of faces 0 and 1, 0 and 2, 1 and 2: the last lies on top
    findings = judged(letter | {"faceOrders": [orders[row] for row in left]}, tmp_path)
    if left == [0, 2]:
        assert findings == []  # that 2 lies over 0 follows
    else:
        assert [finding.check for finding in findings] == ["layers"]
        assert "does not say which is above" in findings[0].message


def test_orders_of_nothing_prove_nothing(letter: Document, tmp_path: Path) -> None:
    letter["foldcut:layers"] = None
    for orders in ([], [[0, 1, 0], [0, 2, 0], [1, 2, 0]], [[1, 2, 1]] * 5):
        (finding,) = judged(letter | {"faceOrders": orders}, tmp_path)
        assert finding.check == "layers"


def test_an_empty_list_beside_our_own_layers_is_told(letter: Document, tmp_path: Path) -> None:
    path = tmp_path / "a.fold"
    path.write_text(json.dumps(letter | {"faceOrders": []}))
    assert "faceOrders is empty" in read_fold(path).notes[-1]
    assert judge(read_fold(path)) == []


# ---- frames ----


@pytest.mark.parametrize("turn", [0.0, 1.0, 3.0])
@pytest.mark.parametrize("flip", [1, -1])
def test_a_folded_form_may_lie_anywhere(turn: float, flip: int, letter: Document, tmp_path: Path) -> None:
    c, s = np.cos(turn), np.sin(turn)
    places = np.array(letter["file_frames"][0]["vertices_coords"])
    moved = places * (flip, 1) @ np.array([[c, s], [-s, c]]) + (70, -20)
    letter["file_frames"][0]["vertices_coords"] = moved.tolist()
    assert judged(letter, tmp_path) == []
    moved[4, 0] += 0.01
    letter["file_frames"][0]["vertices_coords"] = moved.tolist()
    (finding,) = judged(letter, tmp_path)
    assert "file_frames[0].vertices_coords[4] is 0.00" in finding.message


@pytest.mark.parametrize("stretch", [(1.001, 1), (2, 2), (0, 0)])
def test_a_folded_form_that_is_stretched_is_found(
    stretch: tuple[float, float], letter: Document, tmp_path: Path
) -> None:
    frame = letter["file_frames"][0]
    frame["vertices_coords"] = (np.array(frame["vertices_coords"]) * stretch).tolist()
    (finding,) = judged(letter, tmp_path)
    assert "from where the creases put the vertex" in finding.message


def test_a_frame_with_other_assignments_is_found(letter: Document, tmp_path: Path) -> None:
    letter["file_frames"][0]["edges_assignment"] = ["B"] * 8 + ["V", "M"]
    (finding,) = judged(letter, tmp_path)
    assert "file_frames[0].edges_assignment[9] is M, but V in the first frame" in finding.message


def test_a_frame_that_is_folded_in_part_is_told_and_not_judged(letter: Document, tmp_path: Path) -> None:
    flat = [[*point, 1.0] for point in letter["file_frames"][0]["vertices_coords"]]
    half = {"frame_classes": ["foldedForm"], "vertices_coords": flat, "edges_foldAngle": [0] * 8 + [90, 90]}
    other = {"frame_classes": ["foldedForm"], "faces_vertices": [[0, 1, 2]], "faceOrders": [[0, 0, 1]]}
    letter["file_frames"] += [half, other]
    path = tmp_path / "a.fold"
    path.write_text(json.dumps(letter))
    assert [note[:15] for note in read_fold(path).notes] == ["file_frames[1].", "file_frames[2]."]
    assert judge(read_fold(path)) == []


# ---- what lies beside what ----


def beside() -> dict[str, Any]:
    return {name: [sorted(row) for row in rows] for name, rows in incidences(square_out_of_square().creases).items()}


def test_what_lies_beside_what_is_as_the_drawing_shows() -> None:
    found = beside()  # see the picture of square_out_of_square
    assert found["vertices_vertices"][1] == [0, 2, 3]
    assert found["vertices_edges"][1] == [0, 8, 15]
    assert found["vertices_faces"][1] == [0, 1]
    assert found["edges_faces"][:2] == [[0, 1], [1, 2]]
    assert found["edges_faces"][8] == [1]
    assert found["faces_edges"][1] == [0, 1, 8]
    assert found["faces_faces"][1] == [0, 2]


@pytest.mark.parametrize("name", list(beside()))
def test_a_field_that_says_what_lies_beside_what_is_judged(name: str, tmp_path: Path) -> None:
    document = json.loads(export(square_out_of_square(), ".fold"))
    rows = beside()[name]
    assert judged(document | {name: [[None, *row[::-1]] for row in rows]}, tmp_path) == []
    for at in (0, len(rows) - 1):
        fewer = deepcopy(rows)
        lost = fewer[at].pop()
        (finding,) = judged(document | {name: fewer}, tmp_path)
        assert finding.message.startswith(f"{name}[{at}] leaves out {lost}")
    more = deepcopy(rows)
    more[1] = sorted({0, 1, 2, 3, 4, 5, 6, 7} | set(more[1]))
    (finding,) = judged(document | {name: more}, tmp_path)
    assert finding.message.startswith(f"{name}[1] lists ")
    with pytest.raises(FileFormatError, match=f"{name}: must be a list of one list for each of the "):
        judged(document | {name: rows[1:]}, tmp_path)


def test_lengths_are_judged(letter: Document, tmp_path: Path) -> None:
    ends = np.array(letter["vertices_coords"])[letter["edges_vertices"]]
    lengths = np.round(np.hypot(*(ends[:, 1] - ends[:, 0]).T), 2).tolist()
    assert judged(letter | {"edges_length": lengths}, tmp_path) == []
    for at, wrong in ((3, 51.0), (0, 0.0), (9, 1e9)):
        changed = [*lengths[:at], wrong, *lengths[at + 1 :]]
        (finding,) = judged(letter | {"edges_length": changed}, tmp_path)
        assert finding.message.startswith(f"edges_length[{at}] says ")


# ---- the placement ----


@pytest.mark.parametrize(
    "matrix",
    [
        [[2.77, 0, 10], [0, 1.385, 35]],
        [[1, 0, 0], [0, 1.0001, 0]],
        [[1, 0.5, 0], [0, 1, 0]],
        [[1, 1, 0], [1, 1, 0]],
        [[0, 0, 5], [0, 0, 5]],
        [[1, 0, 0], [0, 0, 0]],
    ],
)
def test_a_placement_that_is_no_similarity_is_refused(
    matrix: list[list[float]], letter: Document, tmp_path: Path
) -> None:
    with pytest.raises(FileFormatError, match="foldcut:placement: is no similarity: "):
        judged(letter | {"foldcut:placement": matrix}, tmp_path)


@pytest.mark.parametrize(
    "matrix", [[[0, -3, 1], [3, 0, 2]], [[0.6, 0.8, 0], [0.8, -0.6, 0]], [[1e-9, 0, 0], [0, 1e-9, 0]]]
)
def test_a_placement_may_turn_mirror_and_scale(matrix: list[list[float]], letter: Document, tmp_path: Path) -> None:
    assert judged(letter | {"foldcut:placement": matrix}, tmp_path) == []


def test_check_and_make_refuse_a_file_that_contradicts_itself(
    letter: Document, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    document = json.loads(export(square_out_of_square(), ".fold"))
    document["edges_foldAngle"][0] *= -1
    Path("a.fold").write_text(json.dumps(document))
    assert main(["check", "a.fold"]) == 1
    assert "NOT VALID fields at (" in capsys.readouterr().out
    assert main(["make", "a.fold", "-o", "b.svg"]) == 1
    assert not Path("b.svg").exists()
