"""Every file is read by programs that are not ours, and they agree with us."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.folded import folded_sample
from support.patterns import book_fold, letter_fold, square_out_of_square
from support.programs import require_program, run_node, run_program
from support.samples import TESTED

from foldcut.core.arrays import Floats
from foldcut.core.model import FoldedPattern
from foldcut.exporters import export

FOLDED_MM = 1e-6
"""How far our folded coordinates may be from another program's."""


PATTERNS = {
    "book fold": book_fold,
    "letter fold": letter_fold,
    "square": square_out_of_square,
    "triangle sample": lambda: folded_sample("triangle"),
    "letter T sample": lambda: folded_sample("letter-t"),
    "bolt sample": lambda: folded_sample("bolt"),
    "letter A with its hole": lambda: folded_sample("letter-a"),
    "square ring": lambda: folded_sample("ring"),
}


@pytest.fixture(scope="module", params=PATTERNS)
def pattern(request: pytest.FixtureRequest) -> FoldedPattern:
    """Give hand-made patterns and computed ones."""
    made: FoldedPattern = PATTERNS[request.param]()
    return made


@pytest.fixture(scope="module")
def rabbit_ear(pattern: FoldedPattern, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Give what rabbit-ear makes of the pattern."""
    seen: dict[str, Any] = run_node("rabbit_ear.cjs", write(tmp_path_factory.mktemp("fold"), pattern, ".fold"))
    return seen


def write(folder: Path, pattern: FoldedPattern, suffix: str) -> Path:
    """Write a pattern as a file."""
    path = folder / f"pattern{suffix}"
    path.write_bytes(export(pattern, suffix))
    return path


def moved_onto(points: Floats, target: Floats) -> Floats:
    """Move ``points`` rigidly, not turned over, so that they come as near to ``target`` as possible."""
    centre, goal = points.mean(axis=0), target.mean(axis=0)
    x, y = (points - centre).T
    u, v = (target - goal).T
    angle = np.arctan2((x * v - y * u).sum(), (x * u + y * v).sum())
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    moved: Floats = (points - centre) @ turn.T + goal
    return moved


def assert_folds_like(pattern: FoldedPattern, coords: list[list[float]]) -> None:
    """Compare folded coordinates of another program with ours; both leave face 0 unturned."""
    ours = pattern.folded.vertices_coords
    # Aligned by all points: a small face 0 would magnify its rounding.
    theirs = moved_onto(np.array(coords), ours)
    assert_allclose(theirs, ours, rtol=0, atol=FOLDED_MM)


def test_rabbit_ear_finds_our_faces_and_no_local_fault(pattern: FoldedPattern, rabbit_ear: dict[str, Any]) -> None:
    assert rabbit_ear["validate"] == "valid"
    assert rabbit_ear["planar_faces"] == len(pattern.creases.faces_vertices)
    assert rabbit_ear["kawasaki"] == []
    assert rabbit_ear["maekawa"] == []
    assert_folds_like(pattern, rabbit_ear["folded_coords"])


ONE_LOOP = sorted(set(TESTED) - {"letter-a", "ring", "rosette", "snowflake", "two-triangles"})


@pytest.mark.parametrize(
    ("name", "method"),
    [(name, "compact") for name in ONE_LOOP]
    + [(name, "paper") for name in ONE_LOOP[::4]]  # thousands of creases each
    + [
        (name, "mirror")
        for name in ("letter-a", "ring", "rosette", "snowflake", "two-triangles", "tree", "plus", "heart")
    ],
)
def test_rabbit_ear_and_the_fold_package_accept_samples(name: str, method: str, tmp_path: Path) -> None:
    pattern = folded_sample(name, method=method)
    path = write(tmp_path, pattern, ".fold")
    seen = run_node("rabbit_ear.cjs", path, "local")
    assert (seen["validate"], seen["kawasaki"], seen["maekawa"]) == ("valid", [], [])
    assert seen["planar_faces"] == len(pattern.creases.faces_vertices)
    assert_folds_like(pattern, seen["folded_coords"])
    seen = run_node("fold_package.cjs", path)
    assert seen["faces"] == len(pattern.creases.faces_vertices)
    assert_folds_like(pattern, seen["folded_coords"])


def test_rabbit_ear_finds_our_layers_possible(pattern: FoldedPattern, rabbit_ear: dict[str, Any]) -> None:
    assert rabbit_ear["neighbours"] == pattern.creases.crease_count
    assert rabbit_ear["neighbours_wrong"] == 0
    assert rabbit_ear["overlaps_unordered"] == 0
    for kind, count in rabbit_ear["layers"].items():
        assert (kind, count["violated"], count["unordered"]) == (kind, 0, 0)


def test_rabbit_ear_finds_wrong_layers_impossible(tmp_path: Path) -> None:
    fold: dict[str, Any] = json.loads(export(square_out_of_square(), ".fold"))
    fold["faceOrders"] = [[f, g, -s if (f, g) == (0, 4) else s] for f, g, s in fold["faceOrders"]]
    path = tmp_path / "wrong.fold"
    path.write_text(json.dumps(fold))
    seen = run_node("rabbit_ear.cjs", path)
    assert seen["neighbours_wrong"] == 0
    assert sum(count["violated"] for count in seen["layers"].values()) > 0


def test_rabbit_ear_sees_a_flipped_mountain(tmp_path: Path) -> None:
    fold: dict[str, Any] = json.loads(export(square_out_of_square(), ".fold"))
    crease = fold["edges_assignment"].index("M")
    fold["edges_assignment"][crease] = "V"
    path = tmp_path / "wrong.fold"
    path.write_text(json.dumps(fold))
    seen = run_node("rabbit_ear.cjs", path)
    assert seen["maekawa"] == [0]
    assert seen["neighbours_wrong"] == 1


def test_the_fold_package_finds_our_faces_and_folds_them_alike(pattern: FoldedPattern, tmp_path: Path) -> None:
    seen = run_node("fold_package.cjs", write(tmp_path, pattern, ".fold"))
    assert seen["faces"] == len(pattern.creases.faces_vertices)
    assert seen["closure_error"] < FOLDED_MM
    assert_folds_like(pattern, seen["folded_coords"])


def test_rsvg_renders_every_layer_at_true_size(pattern: FoldedPattern, tmp_path: Path) -> None:
    rsvg = require_program("rsvg-convert")
    drawing = write(tmp_path, pattern, ".svg")
    picture = tmp_path / "pattern.png"
    run_program(rsvg, drawing, "-d", 254, "-p", 254, "-b", "white", "-o", picture)
    header = picture.read_bytes()[:24]
    pixels = [int.from_bytes(header[at : at + 4], "big") for at in (16, 20)]
    # 254 dpi are 10 pixels a mm.
    assert_allclose(pixels, [10 * pattern.sheet.width, 10 * pattern.sheet.height], atol=1)


def test_inkscape_agrees_on_layers_and_sizes(pattern: FoldedPattern, tmp_path: Path) -> None:
    inkscape = require_program("inkscape")
    rows = run_program(inkscape, "--query-all", write(tmp_path, pattern, ".svg")).splitlines()
    boxes = {name: [float(number) for number in rest.split(",")] for name, rest in (r.split(",", 1) for r in rows)}
    # It does not list a layer with nothing in it.
    drawn = {"M": "mountain", "V": "valley"}
    filled = {drawn[letter] for letter in pattern.creases.edges_assignment if letter in drawn}
    assert {"shape", "cut", "legend"} | filled <= boxes.keys()
    assert ("first-fold" in boxes) == bool(pattern.first_folds)
    # Inkscape answers in px, 96 to the inch, and counts the stroke in; 0.35 mm wide around the sheet.
    px = 96 / 25.4
    stroke = 0.35
    expected = [-stroke / 2, -stroke / 2, pattern.sheet.width + stroke, pattern.sheet.height + stroke]
    assert_allclose(np.array(boxes["cut"]) / px, expected, atol=0.01)
    x, y, width, height = np.array(boxes["legend"]) / px
    assert min(x, y) > 0
    assert x + width < pattern.sheet.width
    assert y + height < pattern.sheet.height


def test_svgelements_reads_sizes_in_mm(pattern: FoldedPattern, tmp_path: Path) -> None:
    svgelements = pytest.importorskip("svgelements")
    drawing = svgelements.SVG.parse(write(tmp_path, pattern, ".svg"), ppi=25.4)
    groups = [element for element in drawing if isinstance(element, svgelements.Group)]
    labels = [group.values["{http://www.inkscape.org/namespaces/inkscape}label"] for group in groups]
    first = ["First-fold"] if pattern.first_folds else []
    assert labels == [*first, "Shape", "Valley", "Mountain", "Cut", "Legend"]
    by_label = dict(zip(labels, groups, strict=True))
    outline = by_label["Cut"].bbox()
    assert_allclose(outline, [0, 0, pattern.sheet.width, pattern.sheet.height], rtol=1e-6)  # its mm has seven digits
    loop = pattern.shape.loops[0]
    x0, y0, x1, y1 = by_label["Shape"].bbox()
    assert_allclose(
        [x0, pattern.sheet.height - y1, x1, pattern.sheet.height - y0],
        [*loop.min(axis=0), *loop.max(axis=0)],
        atol=2e-4,
    )
