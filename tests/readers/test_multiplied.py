"""What a small file multiplies is counted before it is done: forms of a PDF, parts of letters, corners of a face."""

from __future__ import annotations

import io
import json
import struct
import time
import zlib
from pathlib import Path

import numpy as np
import pytest
from fontTools.fontBuilder import FontBuilder
from fontTools.pens.t2CharStringPen import T2CharStringPen
from fontTools.pens.ttGlyphPen import TTGlyphPen

from foldcut.cli.main import main
from foldcut.core.errors import FileFormatError
from foldcut.foldfile.judge import judge
from foldcut.foldfile.read import read_fold
from foldcut.readers import read_shape
from foldcut.readers.typed_text import draw_text

LONGEST_S = 5.0
"""Seconds of the processor: a multiplied one would take hours, and this is a busy machine."""


def pdf(content: bytes, *forms: bytes) -> bytes:
    """Return a PDF whose page can draw the first of some forms by the name F, and each form the next one."""

    def stream(data: bytes, more: bytes = b"") -> bytes:
        return b"<<%s/Length %d>>stream\n%s\nendstream" % (more, len(data), data)

    head = b"/Type/XObject/Subtype/Form/BBox[0 0 99 99]/Resources<</XObject<</F %d 0 R>>>>"
    objects = [
        b"<</Type/Catalog/Pages 2 0 R>>",
        b"<</Type/Pages/Kids[3 0 R]/Count 1>>",
        b"<</Type/Page/Parent 2 0 R/MediaBox[0 0 99 99]/Contents 4 0 R/Resources<</XObject<</F 5 0 R>>>>>>",
        stream(content),
        *(stream(form, head % number) for number, form in enumerate(forms, start=6)),
        b"null",
    ]
    body = b"".join(b"%d 0 obj\n%s\nendobj\n" % pair for pair in enumerate(objects, start=1))
    return b"%PDF-1.4\n" + body + b"trailer<</Root 1 0 R/Size 99>>"


SQUARE = b"5 5 40 30 re f "


@pytest.mark.parametrize(
    "data",
    [
        pdf(b"/F Do " * 10, *[b"/F Do " * 10] * 9, SQUARE),
        pdf(b"/F Do " * 3000, b"\n/F\n Do" * 3000, SQUARE),
        pdf(b"/F Do " * 30_000, SQUARE * 3000),
        pdf(b"/F Do", b"/F Do /F Do").replace(b"/F 6 0 R", b"/F 5 0 R"),
    ],
    ids=["deep", "wide", "long", "itself"],
)
def test_a_pdf_whose_forms_multiply_is_refused_before_it_is_drawn(data: bytes, tmp_path: Path) -> None:
    pytest.importorskip("pikepdf")
    path = tmp_path / "a.pdf"
    path.write_bytes(data)
    started = time.process_time()
    with pytest.raises(FileFormatError, match="the page draws more than .* counted as often as they are drawn"):
        read_shape(path)
    assert time.process_time() - started < LONGEST_S


def test_a_form_that_draws_itself_once_is_read(tmp_path: Path) -> None:
    pytest.importorskip("pikepdf")
    path = tmp_path / "a.pdf"
    path.write_bytes(pdf(b"/F Do", SQUARE + b"/F Do").replace(b"/F 6 0 R", b"/F 5 0 R"))
    assert len(read_shape(path).loops) == 1


def test_forms_that_are_drawn_a_few_times_are_read(tmp_path: Path) -> None:
    pytest.importorskip("pikepdf")
    path = tmp_path / "a.pdf"
    path.write_bytes(pdf(b"/F Do 1 0 0 1 50 0 cm /F Do", b"/F Do", b"/F Do /F Do", SQUARE + b"/F Do"))
    assert len(read_shape(path).loops) == 2


def font(parts: list[tuple[str, int]]) -> bytes:
    """Return a font with an A made of parts, each of so many times the next one; the last is a triangle."""
    names = [".notdef", "A", *(f"part{number}" for number in range(len(parts)))]
    builder = FontBuilder(1000, isTTF=True)
    builder.setupGlyphOrder(names)
    builder.setupCharacterMap({ord("A"): "A"})
    glyphs = {".notdef": TTGlyphPen(None).glyph()}
    for number, name in enumerate(names[1:]):
        pen = TTGlyphPen(dict.fromkeys(names))
        if number < len(parts):
            for step in range(parts[number][1]):
                pen.addComponent(f"part{number}", (1, 0, 0, 1, step, 0))
        else:
            pen.moveTo((0, 0))
            pen.lineTo((500, 0))
            pen.lineTo((0, 700))
            pen.closePath()
        glyphs[name] = pen.glyph()
        for side in ("xMin", "yMin", "xMax", "yMax"):
            setattr(glyphs[name], side, 0)
    builder.setupGlyf(glyphs, calcGlyphBounds=False)
    builder.font.recalcBBoxes = False
    builder.setupHorizontalMetrics(dict.fromkeys(names, (600, 0)))
    builder.setupHorizontalHeader(ascent=800, descent=-200)
    builder.setupPost()
    for table in ("maxp", "hhea"):
        builder.font[table].recalc = lambda *_: None  # which would draw them all
    stream = io.BytesIO()
    builder.save(stream)
    return stream.getvalue()


def postscript_font(lines: int) -> bytes:
    """Return a font with an A of so many lines."""
    names = [".notdef", "A"]
    builder = FontBuilder(1000, isTTF=False)
    builder.setupGlyphOrder(names)
    builder.setupCharacterMap({ord("A"): "A"})
    pen = T2CharStringPen(600, None)
    pen.moveTo((0, 0))
    for step in range(lines):
        pen.lineTo((step % 700, step % 7))
    pen.closePath()
    empty = T2CharStringPen(600, None).getCharString()
    builder.setupCFF("Test", {}, {".notdef": empty, "A": pen.getCharString()}, {})
    builder.setupHorizontalMetrics(dict.fromkeys(names, (600, 0)))
    builder.setupHorizontalHeader(ascent=800, descent=-200)
    builder.setupPost()
    stream = io.BytesIO()
    builder.save(stream)
    return stream.getvalue()


@pytest.mark.parametrize(
    "data",
    [font([("", 10)] * 9), font([("", 300), ("", 300)]), postscript_font(21_000)],
    ids=["deep", "wide", "postscript"],
)
def test_a_font_whose_parts_multiply_is_refused(data: bytes, tmp_path: Path) -> None:
    path = tmp_path / "a.ttf"
    path.write_bytes(data)
    started = time.process_time()
    with pytest.raises(FileFormatError, match=r"a.ttf: a letter has more than 20,000 parts; give another --font"):
        draw_text("A", str(path))
    assert time.process_time() - started < LONGEST_S


def test_a_font_with_parts_of_parts_is_read(tmp_path: Path) -> None:
    path = tmp_path / "a.ttf"
    path.write_bytes(font([("", 1), ("", 1)]))
    assert [len(loop) for loop in draw_text("A", str(path)).loops] == [3]


def fold_file(vertices: list[list[float]], edges: list[list[int]], faces: list[list[int]]) -> str:
    letters = ["B"] * len(edges)
    named = zip(("vertices_coords", "edges_vertices", "edges_assignment"), (vertices, edges, letters), strict=True)
    return json.dumps({**dict(named), "faces_vertices": faces})


CORNERS = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
SIDES = [[0, 1], [1, 2], [2, 3], [3, 0]]


def turned(count: int) -> list[list[float]]:
    """Return points around a circle in an order in which the lines from one to the next cross all the time."""
    angles = np.arange(count) * 2.4
    return np.column_stack([np.cos(angles), np.sin(angles)]).tolist()


@pytest.mark.parametrize(
    "text",
    [
        fold_file(CORNERS, SIDES, [[0, 1, 2, 3] * 5000]),
        fold_file(turned(1200), [[k, (k + 1) % 1200] for k in range(1200)], [[0, 1, 2]]),
        fold_file(
            [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] + [[0.5, 1e-13 * k] for k in range(2500)],
            [[k, (k + 1) % 2503] for k in range(2503)],
            [list(range(2503))],
        ),
        fold_file(CORNERS, SIDES, [[0, 1, 2, 3] * 100_000]),
        fold_file(CORNERS, SIDES, [[0, 1, 2, 3]] * 50_000),
        fold_file(turned(8_000), [[k, (k + 1) % 8_000] for k in range(8_000)], [list(range(8_000))]),
        fold_file(turned(8_000), [[k, (k + 1) % 8_000] for k in range(8_000)], [[*range(8_000), *range(50)]]),
    ],
    ids=[
        "a vertex many times",
        "edges that cross",
        "vertices in one place",
        "a face of 400,000 corners",
        "many faces of the same edges",
        "a face that crosses itself all over",
        "the same, with vertices named twice",
    ],
)
def test_findings_of_a_fold_file_are_bounded(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a.fold"
    path.write_text(text)
    started = time.process_time()
    findings = judge(read_fold(path))
    assert time.process_time() - started < LONGEST_S
    assert findings
    assert {finding.check for finding in findings} == {"planar"}
    assert len(findings) <= 4000
    assert main(["check", str(path)]) in (1, 2, 3)
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize(("width", "height"), [(30_000, 30_000), (2_000_000, 1_000), (1, 400_000_000)])
def test_a_picture_that_is_too_large_is_refused_by_its_size(width: int, height: int, tmp_path: Path) -> None:
    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    path = tmp_path / "a.png"
    head = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + head + chunk(b"IDAT", zlib.compress(bytes(1000))) + chunk(b"IEND", b""))
    with pytest.raises(FileFormatError, match=r"the picture has .*pixels.*; give a smaller one"):
        read_shape(path)
