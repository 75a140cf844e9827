"""Reading FOLD files: what a file may leave out, and the errors for files that cannot be read."""

from __future__ import annotations

import json
import re
import tempfile
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.paper import Paper, random_paper

from foldcut.core.arrays import Ints
from foldcut.core.errors import FileFormatError
from foldcut.foldfile import read as fold
from foldcut.foldfile.read import FoldFile, read_fold
from foldcut.geometry.planar_graph import edge_faces
from foldcut.pattern.face_maps import fold_faces
from foldcut.proof.verify import verify

Document = dict[str, Any]


def book(**changes: object) -> Document:
    """Return the FOLD object of a sheet of 2 x 1 with a valley in the middle; None leaves a key out."""
    document: Document = {
        "file_spec": 1.1,
        "frame_unit": "mm",
        "frame_classes": ["creasePattern"],
        "vertices_coords": [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]],
        "edges_vertices": [[0, 1], [1, 2], [2, 5], [5, 4], [4, 3], [3, 0], [1, 4]],
        "edges_assignment": ["B", "B", "B", "B", "B", "B", "V"],
        "faces_vertices": [[0, 1, 4, 3], [1, 2, 5, 4]],
        "foldcut:layers": [0, 1],
        **changes,
    }
    return {key: value for key, value in document.items() if value is not None}


def paper_document(paper: Paper, order: list[int]) -> tuple[Document, Ints]:
    """Return the FOLD object of folded paper, without layers, and its layer order."""
    pattern, layers = paper.pattern(order)
    document = book(
        vertices_coords=pattern.vertices_coords.tolist(),
        edges_vertices=pattern.edges_vertices.tolist(),
        edges_assignment=pattern.edges_assignment.tolist(),
        faces_vertices=pattern.faces_vertices.to_lists(),
    )
    del document["foldcut:layers"]
    return document, layers


def face_orders(document: Document, layers: Ints, turned: frozenset[int] = frozenset()) -> list[list[int]]:
    """Return the order of every two faces, as FOLD writes it; faces ``turned`` are clockwise in the file."""
    pattern = read(document).pattern
    up = fold_faces(pattern, edge_faces(pattern)).up
    rank = np.argsort(layers)
    return [
        [f, g, 1 if (rank[f] > rank[g]) == (bool(up[g]) != (g in turned)) else -1]
        for f, g in combinations(range(len(layers)), 2)
    ]


def read(document: object, folder: Path | None = None) -> FoldFile:
    """Read a FOLD object as if it came from a file."""
    with tempfile.TemporaryDirectory() as temporary:
        path = (folder or Path(temporary)) / "test.fold"
        path.write_text(document if isinstance(document, str) else json.dumps(document), encoding="utf-8")
        return read_fold(path)


def test_a_pattern_with_layers_is_read_and_verifies() -> None:
    file = read(book())
    assert verify(file.pattern, file.layers) == []
    assert file.unit_mm == 1.0
    assert file.placement is None
    assert file.notes == ()


@pytest.mark.parametrize(
    ("unit", "mm"), [("mm", 1.0), ("cm", 10.0), ("m", 1000.0), ("um", 0.001), ("in", 25.4), ("pt", 25.4 / 72)]
)
def test_lengths_come_in_millimetres(unit: str, mm: float) -> None:
    file = read(book(frame_unit=unit))
    assert file.unit_mm == pytest.approx(mm)
    assert file.pattern.vertices_coords[5] == pytest.approx((2 * mm, mm))


@pytest.mark.parametrize("unit", ["unit", None])
def test_a_file_without_a_unit_is_taken_as_millimetres_with_a_note(unit: str | None) -> None:
    file = read(book(frame_unit=unit))
    assert file.unit_mm == 1.0
    assert "taken as 1 mm" in file.notes[0]


def test_coordinates_may_have_a_z_of_zero() -> None:
    flat = [[x, y, 0] for x, y in book()["vertices_coords"]]
    assert read(book(vertices_coords=flat)).pattern.vertices_coords.shape == (6, 2)


def test_faces_are_traced_where_the_file_has_none() -> None:
    file = read(book(faces_vertices=None))
    assert sorted(map(sorted, file.pattern.faces_vertices.to_lists())) == [[0, 1, 3, 4], [1, 2, 4, 5]]
    assert file.layers is None
    assert "faces traced" in file.notes[0]
    assert [finding.check for finding in verify(file.pattern, file.layers)] == ["layers"]


@pytest.mark.parametrize("seed", range(5))
def test_traced_faces_tile_the_sheet(seed: int) -> None:
    paper = random_paper(np.random.default_rng(seed), 4)
    document, _ = paper_document(paper, list(range(len(paper.layers))))
    del document["faces_vertices"]
    findings = verify(read(document).pattern, None)
    assert [finding.message[:14] for finding in findings] == ["no layer order"]


def test_clockwise_faces_are_turned_round() -> None:
    file = read(book(faces_vertices=[[3, 4, 1, 0], [1, 2, 5, 4]]))
    assert file.pattern.faces_vertices.to_lists() == [[0, 1, 4, 3], [1, 2, 5, 4]]
    assert verify(file.pattern, file.layers) == []


@pytest.mark.parametrize("seed", range(8))
def test_face_orders_give_back_the_layer_order(seed: int) -> None:
    rng = np.random.default_rng(seed)
    paper = random_paper(rng, 4)
    document, layers = paper_document(paper, rng.permutation(len(paper.layers)).tolist())
    document["faceOrders"] = face_orders(document, layers)
    assert read(document).layers == pytest.approx(layers)


def test_face_orders_follow_the_normals_of_the_faces_as_they_are_in_the_file() -> None:
    paper = random_paper(np.random.default_rng(1), 4)
    document, layers = paper_document(paper, list(range(len(paper.layers))))
    turned = frozenset(range(1, len(layers), 3))
    orders = face_orders(document, layers, turned)
    for face in turned:
        document["faces_vertices"][face].reverse()
    assert read({**document, "faceOrders": orders}).layers == pytest.approx(layers)


def test_face_orders_may_leave_out_faces_that_do_not_overlap() -> None:
    # Face 1 is turned over and lies on face 0: on the side of its own normal lies face 0.
    file = read(book(**{"foldcut:layers": None, "faceOrders": [[0, 1, 1], [1, 0, 1], [0, 1, 0]]}))
    assert verify(file.pattern, file.layers) == []


def test_face_orders_of_a_folded_frame_are_read() -> None:
    frame: Document = {"frame_classes": ["foldedForm"], "frame_parent": 0, "faceOrders": [[1, 0, 1]]}
    assert read(book(**{"foldcut:layers": None, "file_frames": [{}, frame]})).layers == pytest.approx([0, 1])
    frame["faces_vertices"] = [[0, 1, 4], [1, 2, 5]]
    file = read(book(**{"foldcut:layers": None, "file_frames": [frame]}))
    assert file.layers is None
    assert "file_frames[0].faces_vertices is not that of the first frame" in file.notes[0]


def test_face_orders_that_go_round_in_a_circle_are_refused() -> None:
    orders = [[1, 0, 1], [0, 1, -1]]
    message = re.escape("faceOrders: circular: faces ") + "(0, 1|1, 0) "
    with pytest.raises(FileFormatError, match=message):
        read(book(**{"foldcut:layers": None, "faceOrders": orders}))


def test_the_placement_is_read() -> None:
    file = read(book(**{"foldcut:placement": [[2, 0, 5], [0, 2, 7]]}))
    assert file.placement is not None
    assert file.placement.scale == 2.0
    assert file.placement.apply(np.array([(1.0, 1.0)])) == pytest.approx(np.array([(7.0, 9.0)]))


MALFORMED = [
    (book(vertices_coords=None), "vertices_coords: missing"),
    (book(vertices_coords={}), "vertices_coords: must be a list of lists"),
    (book(vertices_coords=[[0, 0], 3]), "vertices_coords[1]: must be a list"),
    (book(vertices_coords=[[0, 0], [0]]), "vertices_coords[1]: 1 coordinates; give x and y"),
    (book(vertices_coords=[[0, "0"]]), "vertices_coords[0][1]: '0' is not a number"),
    (book(vertices_coords=[[0, True]]), "vertices_coords[0][1]: True is not a number"),
    (book(vertices_coords=[[0, 10**400]]), "vertices_coords[0][1]: "),
    (book(vertices_coords=[[0, 0, 0.5]]), "vertices_coords[0][2]: z is 0.5"),
    (book(edges_vertices=None), "edges_vertices: missing"),
    (book(edges_vertices=[[0, 6]]), "edges_vertices[0][1]: 6 is not a number from 0 to 5"),
    (book(edges_vertices=[[0, 1.0]]), "edges_vertices[0][1]: 1.0 is not a number from 0 to 5"),
    (book(edges_vertices=[[0, 1, 2]]), "edges_vertices[0]: 3 vertices; an edge has two"),
    (book(edges_assignment=["B"]), "edges_assignment: must be a list of one letter for each of the 7 edges"),
    (book(edges_assignment=list("BBBBBBv")), "edges_assignment[6]: 'v' is not one of B, M, V, F, U, C, J"),
    (book(edges_assignment=[*"BBBBBB", []]), "edges_assignment[6]: [] is not one of B, M, V, F, U"),
    (book(faces_vertices=[[0, 1]]), "faces_vertices[0]: 2 vertices; a face has at least three"),
    (book(faces_vertices=[[0, 1, -1]]), "faces_vertices[0][2]: -1 is not a number from 0 to 5"),
    (book(faces_vertices=[]), "faces_vertices: there are no faces"),
    (book(faces_vertices=None, edges_vertices=[], edges_assignment=[]), "edges_vertices: there are no faces"),
    (book(frame_unit="mile"), "frame_unit: 'mile' is not one of mm, cm"),
    (book(frame_unit=[]), "frame_unit: [] is not one of mm, cm"),
    (book(frame_classes=["foldedForm"], faces_vertices=None), "faces_vertices: missing; a folded form has to name"),
    (book(frame_classes=["foldedForm"], edges_assignment=None), "edges_assignment: missing; a folded form has to say"),
    (book(**{"foldcut:layers": [0, 0]}), "foldcut:layers: must name each of the 2 faces once"),
    (book(**{"foldcut:layers": [0, 2]}), "foldcut:layers[1]: 2 is not a number from 0 to 1"),
    (book(**{"foldcut:layers": 5}), "foldcut:layers: must be a list"),
    (book(**{"foldcut:layers": None, "faceOrders": {}}), "faceOrders: must be a list"),
    (
        book(**{"foldcut:layers": None, "faceOrders": [[0, 1]]}),
        "faceOrders[0]: must be [face, face, 1, 0 or -1]",
    ),
    (book(**{"foldcut:layers": None, "faceOrders": [[0, 9, 1]]}), "faceOrders[0][1]: 9 is not a number"),
    (book(**{"foldcut:layers": None, "faceOrders": [[0, 1, 2]]}), "faceOrders[0][2]: 2 is not 1, 0 or -1"),
    (book(**{"foldcut:layers": None, "faceOrders": [[0, 0, 1]]}), "faceOrders: circular: faces 0 "),
    (book(**{"foldcut:layers": None, "file_frames": 1}), "file_frames: must be a list of frames"),
    (book(**{"foldcut:layers": None, "file_frames": [1]}), "file_frames[0]: must be an object"),
    (book(**{"foldcut:placement": [[1, 0, 0]]}), "foldcut:placement: must be a 2 x 3 matrix"),
    (
        book(**{"foldcut:placement": [[1, 0, None], [0, 1, 0]]}),
        "foldcut:placement[0][2]: None is not a number",
    ),
    ([], "holds one JSON object, not a list"),
    ("{", "not JSON, as a FOLD file has to be: "),
    ("", "the file is empty"),
    ('{"vertices_coords": [[NaN, 0]]}', "NaN is not a JSON number"),
    ('{"vertices_coords": [[1e999, 0]]}', "vertices_coords[0][0]: inf is not a number below 1e15"),
    ("[" * 100_000, "not JSON, as a FOLD file has to be: "),
]


@pytest.mark.parametrize(("document", "message"), MALFORMED, ids=[message for _, message in MALFORMED])
def test_malformed_files_are_refused_with_the_place(document: object, message: str) -> None:
    with pytest.raises(FileFormatError, match=re.escape(message)):
        read(document)


def test_broken_patterns_are_read_and_left_to_the_verifier() -> None:
    # An edge without length, a face that runs back on itself, a vertex on nothing.
    squashed = book(vertices_coords=[[0, 0], [1, 0], [2, 0], [0, 1], [1, 0], [2, 1]])
    for document in (squashed, book(edges_vertices=[[0, 1]] * 7), book(faces_vertices=[[0, 1, 0, 3]])):
        del document["foldcut:layers"]
        file = read({**document, "faceOrders": [[0, 0, 0]]})
        assert verify(file.pattern, file.layers)


def test_files_that_cannot_be_opened_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match=r"nothing\.fold: No such file"):
        read_fold(tmp_path / "nothing.fold")
    with pytest.raises(FileFormatError, match="Is a directory"):
        read_fold(tmp_path)


def test_files_above_the_limit_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fold, "LARGEST_FILE", 100)
    with pytest.raises(FileFormatError, match="give one of at most"):
        read(book(), tmp_path)
