"""``--open``: every line of a drawing is cut, in every format that has lines."""

from __future__ import annotations

import json
from pathlib import Path

import ezdxf
import pytest
from support.folded import folded_sample

import foldcut
from foldcut.cli.main import main
from foldcut.core.errors import FileFormatError
from foldcut.foldfile.read import read_fold
from foldcut.foldfile.reopen import reopen
from foldcut.readers import ReadOptions, read_shape

OPEN = ReadOptions(open_lines=True)
SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="90mm" height="90mm" viewBox="0 0 90 90">{}</svg>'
SLITS = '<path d="M10 10H80V80H10Z" fill="none" stroke="red"/><path d="M20 20H70" stroke="black"/>'


def drawings(folder: Path) -> dict[str, Path]:
    """Return a square with a slit in each format."""
    (folder / "a.svg").write_text(SVG.format(SLITS))
    (folder / "a.json").write_text(
        json.dumps({"loops": [[[0, 0], [70, 0], [70, 70], [0, 70]]], "lines": [[[10, 60], [60, 60]]]})
    )
    (folder / "a.wkt").write_text(
        "GEOMETRYCOLLECTION (POLYGON ((0 0, 70 0, 70 70, 0 70, 0 0)), LINESTRING (10 60, 60 60))"
    )
    document = ezdxf.new()
    document.modelspace().add_lwpolyline([(0, 0), (70, 0), (70, 70), (0, 70)], close=True)
    document.modelspace().add_line((10, 60), (60, 60))
    document.saveas(folder / "a.dxf")
    return {path.suffix: path for path in sorted(folder.iterdir())}


def test_every_format_keeps_open_lines_when_asked(tmp_path: Path) -> None:
    found = drawings(tmp_path)
    assert set(found) == {".svg", ".json", ".wkt", ".dxf"}
    for path in found.values():
        drawing = read_shape(path, OPEN)
        assert (len(drawing.loops), len(drawing.lines)) == (0, 2)
        assert drawing.size == (70, 70)
    result = foldcut.fold(drawing, effort="fast")
    assert result.verified
    assert [len(line) for line in result.folded_pattern.shape.lines] == [2]


def test_open_lines_that_are_left_out_are_told_with_the_remedy(tmp_path: Path) -> None:
    found = drawings(tmp_path)
    for suffix in (".svg", ".dxf"):
        (repair,) = read_shape(found[suffix]).repairs
        assert repair.endswith("(cut along open lines, too, with --open)")
    (tmp_path / "b.svg").write_text(SVG.format('<path d="M10 10H80" stroke="red" fill="none"/>'))
    with pytest.raises(FileFormatError, match="with --open"):
        read_shape(tmp_path / "b.svg")
    assert len(read_shape(tmp_path / "b.svg", OPEN).lines) == 1


def test_a_stroke_is_not_closed_by_the_fill_of_its_path(tmp_path: Path) -> None:
    (tmp_path / "a.svg").write_text(SVG.format('<path d="M10 10L40 40L80 10" stroke="black"/>'))
    assert [len(line) for line in read_shape(tmp_path / "a.svg", OPEN).lines] == [3]


def test_a_fold_file_of_a_graph_is_checked_and_opened_again(tmp_path: Path) -> None:
    path, out = drawings(tmp_path)[".svg"], tmp_path / "out.fold"
    assert main(["make", str(path), "--open", "--effort", "fast", "-o", str(out), "--quiet"]) == 0
    assert main(["check", str(out), "--shape", str(path), "--open", "--quiet"]) == 0
    assert main(["check", str(out), "--shape", str(path), "--quiet"]) == 1  # without the slit it is another drawing
    opened = reopen(read_fold(out))
    assert opened.verified
    assert len(opened.folded_pattern.shape.lines) == 1
    spoiled = json.loads(out.read_text())
    del spoiled["foldcut:lines"]
    (tmp_path / "spoiled.fold").write_text(json.dumps(spoiled))
    assert not reopen(read_fold(tmp_path / "spoiled.fold")).verified


def test_a_sample_of_lines_is_written_in_all_formats(tmp_path: Path) -> None:
    pattern = folded_sample("zigzag")
    assert pattern.shape.is_graph
    svg = tmp_path / "zigzag.svg"
    names = [svg, *(tmp_path / f"zigzag.{suffix}" for suffix in ("html", "fold"))]
    outputs = [word for name in names for word in ("-o", str(name))]
    assert main(["make", "zigzag", *outputs, "--effort", "fast", "--quiet"]) == 0
    assert all(name.stat().st_size for name in names)
    assert main(["draw", "zigzag", "-o", str(tmp_path / "p.svg"), "--effort", "fast", "--quiet"]) == 0
    marks = ["--profile", "laser-dxf", "--marks", "outline,cut-line"]
    assert main(["make", "zigzag", "-o", str(tmp_path / "z.dxf"), *marks, "--effort", "fast", "--quiet"]) == 0


def test_lines_are_simplified_on_request_and_where_there_are_too_many(tmp_path: Path) -> None:
    (tmp_path / "a.svg").write_text(SVG.format('<path d="M10 40C30 0 70 80 90 40" fill="none" stroke="red"/>'))
    drawing = read_shape(tmp_path / "a.svg", OPEN)
    result = foldcut.fold(drawing, simplify=8.0, effort="fast")
    assert result.verified
    assert any(note.startswith("simplified: ") for note in result.notes)


def test_lines_that_are_closed_outlines_and_nothing_else_are_folded_as_outlines(tmp_path: Path) -> None:
    path, out = tmp_path / "a.json", tmp_path / "a.fold"
    comb = [*([10 + 6 * k, 10 + k % 2] for k in range(11)), [70, 80], [10, 80]]
    path.write_text(json.dumps({"lines": [comb[:5], comb[4:], [comb[-1], comb[0]]]}))
    result = foldcut.fold(read_shape(path), effort="fast", exact=True)
    assert result.drawing is not None
    assert (len(result.drawing.loops), len(result.drawing.lines)) == (1, 0)
    assert not result.folded_pattern.shape.is_graph
    assert result.folded_pattern.moved_by is not None
    assert main(["make", str(path), "--corners", "4", "--effort", "fast", "-o", str(out), "--quiet"]) == 0
    assert reopen(read_fold(out)).folded_pattern.shape.corner_count == 4
