"""Outlines of texts, of PDF pages and of silhouettes in pictures."""

from __future__ import annotations

import io
import math
import shutil
import sys
from functools import reduce
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from fontTools.fontBuilder import FontBuilder
from fontTools.pens.ttGlyphPen import TTGlyphPen
from PIL import Image, ImageDraw
from reportlab.pdfgen.canvas import Canvas

from foldcut import fold
from foldcut.cli.main import main
from foldcut.core.errors import BadInputError, FileFormatError
from foldcut.drawing.limits import Limits
from foldcut.drawing.shape import make_shape
from foldcut.readers import Drawing, ReadOptions, read_shape
from foldcut.readers.typed_text import draw_text, find_font, font_families

MM = 25.4 / 72


def area(drawing: Drawing) -> float:
    polygons = [shapely.Polygon(loop) for loop in drawing.loops]
    return float(reduce(shapely.symmetric_difference, polygons).area)


def read(folder: Path, name: str, data: bytes, **options: Any) -> Drawing:
    (folder / name).write_bytes(data)
    return read_shape(folder / name, ReadOptions(**options))


# --- text


@pytest.fixture(scope="module")
def font(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Make a font with an L, an O with a hole, a round o, and an X of two strokes that overlap."""

    def glyph(*contours: list[tuple[int, int]], curved: bool = False) -> Any:
        pen = TTGlyphPen(None)
        for contour in contours:
            if curved:
                pen.qCurveTo(*contour, None)
            else:
                pen.moveTo(contour[0])
                for point in contour[1:]:
                    pen.lineTo(point)
            pen.closePath()
        return pen.glyph()

    glyphs = {
        ".notdef": glyph(),
        "space": glyph(),
        "L": glyph([(0, 0), (0, 700), (200, 700), (200, 200), (500, 200), (500, 0)]),
        "O": glyph([(0, 0), (0, 700), (500, 700), (500, 0)], [(200, 200), (300, 200), (300, 500), (200, 500)]),
        "o": glyph([(0, 0), (0, 500), (500, 500), (500, 0)], curved=True),
        "X": glyph([(0, 0), (400, 700), (500, 700), (100, 0)], [(400, 0), (0, 700), (100, 700), (500, 0)]),
    }
    builder = FontBuilder(1000, isTTF=True)
    builder.setupGlyphOrder(list(glyphs))
    builder.setupCharacterMap({32: "space", **{ord(name): name for name in glyphs if len(name) == 1}})
    builder.setupGlyf(glyphs)
    builder.setupHorizontalMetrics(dict.fromkeys(glyphs, (600, 0)))
    builder.setupHorizontalHeader(ascent=800, descent=-200)
    builder.setupNameTable({"familyName": "Test", "styleName": "Regular"})
    builder.setupOS2()
    builder.setupPost()
    path = tmp_path_factory.mktemp("font") / "Test.ttf"
    builder.save(path)
    return str(path)


def test_a_text_is_drawn_with_the_fonts_outlines(font: str) -> None:
    drawing = draw_text("L O\nL", font)
    assert [len(loop) for loop in drawing.loops] == [6, 4, 4, 6]
    assert [loop.min(axis=0).tolist() for loop in drawing.loops] == [[0, 0], [1200, 0], [1400, 200], [0, -1200]]
    assert (drawing.title, drawing.unit_mm) == ("L O L", None)
    assert area(draw_text("o", font)) == pytest.approx(500**2 * 5 / 6, rel=1e-3)


def test_strokes_of_a_letter_that_overlap_are_one_outline(font: str) -> None:
    drawing = draw_text("X", font)
    assert len(drawing.loops) == 1
    make_shape(drawing.loops)


def test_a_letter_is_folded(font: str, tmp_path: Path) -> None:
    assert fold(draw_text("L", font), "a5", effort="fast").verified
    out = tmp_path / "l.fold"
    assert main(["make", "--text", "L", "--font", font, "--effort", "fast", "-o", str(out), "--quiet"]) == 0
    assert out.exists()


def test_texts_and_fonts_that_cannot_be_drawn_are_refused(font: str, tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="the font has no letter 'é'; leave it out"):
        draw_text("é", font)
    for text in ("", "  ", "L" * 1001):
        with pytest.raises(BadInputError, match="give 1 to 1000"):
            draw_text(text, font)
    with pytest.raises(FileFormatError, match=r"x\.ttf: there is no such font file; "):
        draw_text("L", str(tmp_path / "x.ttf"))
    data = Path(font).read_bytes()
    for number, broken in enumerate((b"hello", data[:300], data[:50] + bytes(200) + data[250:])):
        path = tmp_path / f"{number}.ttf"
        path.write_bytes(broken)
        with pytest.raises(FileFormatError, match="not a font that can be read"):
            draw_text("L", str(path))
    if shutil.which("fc-match"):
        with pytest.raises(FileFormatError, match="there is no such font; the nearest is"):
            draw_text("L", "No Such Family")


def test_a_shape_or_a_text_is_needed_and_not_both(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["make", "fish", "--text", "L"]) == 2
    assert "give a SHAPE or a --text, not both" in capsys.readouterr().err
    assert main(["make"]) == 2
    assert "give a SHAPE or a --text\n" in capsys.readouterr().err


# --- PDF


def pdf(draw: Any) -> bytes:
    buffer = io.BytesIO()
    canvas = Canvas(buffer, pagesize=(300, 200), invariant=1)
    draw(canvas)
    canvas.showPage()
    canvas.save()
    return buffer.getvalue()


def holed(canvas: Canvas) -> None:
    canvas.setFillColorRGB(1, 1, 1)
    canvas.rect(0, 0, 300, 200, fill=1, stroke=0)
    canvas.setFillColorRGB(0, 0, 1)
    canvas.drawString(10, 10, "hello")
    path = canvas.beginPath()
    path.rect(100, 50, 80, 40)
    path.rect(110, 60, 20, 20)
    canvas.drawPath(path, fill=1, stroke=0, fillMode=0)


def in_a_form(canvas: Canvas) -> None:
    canvas.beginForm("f")
    canvas.translate(10, 10)
    canvas.rect(0, 0, 20, 10, fill=1, stroke=0)
    canvas.endForm()
    canvas.scale(2, 2)
    canvas.doForm("f")


@pytest.mark.parametrize(
    ("draw", "expected"),
    [
        (lambda canvas: canvas.rect(10, 20, 30, 40, fill=1), 1200),
        (lambda canvas: canvas.rect(10, 20, 30, 40, fill=0), 1200),
        (lambda canvas: canvas.circle(100, 100, 50, fill=1), math.pi * 2500),
        (lambda canvas: canvas.lines([(0, 0, 40, 0), (40, 0, 40, 30), (40, 30, 0, 0)]), 600),
        (holed, 2800),
        (in_a_form, 800),
        (lambda canvas: (canvas.rotate(30), canvas.rect(100, 20, 30, 40, fill=1)), 1200),
    ],
)
def test_the_paths_of_a_pdf_page_are_loops(tmp_path: Path, draw: Any, expected: float) -> None:
    pytest.importorskip("pypdfium2")
    drawing = read(tmp_path, "a.pdf", pdf(draw))
    assert drawing.unit_mm == pytest.approx(MM)
    assert area(drawing) == pytest.approx(expected, rel=2e-3)
    make_shape(drawing.loops)
    if draw is holed:
        assert drawing.ignored == ("1 text", "1 white background")
        assert drawing.size_mm == pytest.approx((80 * MM, 40 * MM))
        corners = np.concatenate(drawing.own_coordinates())
        assert corners.min(axis=0).tolist() == pytest.approx([100, 50])  # y is up in a PDF


def test_gaps_and_strays_of_a_pdf_page_are_mended_and_told(tmp_path: Path) -> None:
    pytest.importorskip("pypdfium2")
    lines = [(0, 0, 40, 0), (40.005, 0, 40, 30), (40, 30, 0, 0), (60, 60, 70, 70)]
    drawing = read(tmp_path, "a.pdf", pdf(lambda canvas: canvas.lines(lines)))
    assert area(drawing) == pytest.approx(600, rel=1e-3)
    gap, stray = drawing.repairs
    assert gap.startswith("closed 1 gap of at most 0.0018 mm")
    assert stray.startswith("left out a line that ends where no other continues")


def test_forms_of_a_pdf_page_nest_as_deep_as_is_allowed(tmp_path: Path) -> None:
    pytest.importorskip("pypdfium2")

    def in_forms(canvas: Canvas) -> None:
        for number in range(4):
            canvas.beginForm(f"f{number}")
            canvas.doForm(f"f{number - 1}") if number else canvas.rect(0, 0, 20, 10, fill=1, stroke=0)
            canvas.endForm()
        canvas.doForm("f3")

    data = pdf(in_forms)
    assert area(read(tmp_path, "a.pdf", data, limits=Limits(nesting=4))) == pytest.approx(200, rel=2e-3)
    for deepest in (1, 2, 3):
        with pytest.raises(FileFormatError, match=f"nested too deep, and at most {deepest} are allowed"):
            read(tmp_path, "a.pdf", data, limits=Limits(nesting=deepest))


def test_bad_pdfs_are_refused_in_one_line(tmp_path: Path) -> None:
    pytest.importorskip("pypdfium2")
    good = pdf(holed)
    for data in (b"hello", good[:200], b"%PDF-1.4\n%%EOF"):
        with pytest.raises(FileFormatError, match=r"not a PDF file that can be read: .*; export"):
            read(tmp_path, "a.pdf", data)
    with pytest.raises(FileFormatError, match="the first page has no vector path, only 1 text; export"):
        read(tmp_path, "a.pdf", pdf(lambda canvas: canvas.drawString(10, 10, "hello")))
    random = np.random.default_rng(1)
    for _ in range(60):
        data = bytearray(good)
        for place in random.integers(0, len(data), size=4).tolist():
            data[place] = random.integers(256)
        try:
            read(tmp_path, "a.pdf", bytes(data))
        except FileFormatError as error:
            assert len(str(error).splitlines()) == 1


# --- pictures


def picture(mode: str = "L", kind: str = "PNG", **save: Any) -> bytes:
    """Draw a black L, 200 x 150 pixels large, and two specks, on white."""
    image = Image.new("L", (300, 200), 255)
    draw = ImageDraw.Draw(image)
    draw.polygon([(50, 20), (100, 20), (100, 120), (249, 120), (249, 169), (50, 169)], fill=0)
    draw.point([(5, 5), (280, 190), (70, 70)], fill=0)
    image.putpixel((70, 70), 255)
    if mode == "RGBA":
        clear = Image.new("RGBA", image.size, (255, 255, 255, 0))
        clear.paste((255, 255, 0, 255), mask=image.point(lambda value: 255 - value))
        image = clear
    buffer = io.BytesIO()
    image.save(buffer, kind, **save)
    return buffer.getvalue()


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("a.png", picture()),
        ("a.PNG", picture("RGBA")),
        ("a.jpg", picture(kind="JPEG", quality=95)),
        ("a.jpeg", picture(kind="JPEG", quality=95)),
    ],
)
def test_the_silhouette_in_a_picture_is_traced(tmp_path: Path, name: str, data: bytes) -> None:
    pytest.importorskip("vtracer")
    drawing = read(tmp_path, name, data)
    shape = make_shape(drawing.loops)
    assert len(shape.loops) == 1
    assert drawing.size == pytest.approx((200, 150), abs=2)
    assert area(drawing) == pytest.approx(51 * 150 + 149 * 50, rel=0.01)
    assert drawing.ignored == ("1 small hole", "2 specks")
    assert drawing.unit_mm is None
    assert shape.corner_count < 12


def test_the_dots_per_inch_of_a_picture_are_its_size(tmp_path: Path) -> None:
    pytest.importorskip("vtracer")
    drawing = read(tmp_path, "a.png", picture(dpi=(100, 100)))
    assert drawing.size_mm == pytest.approx((50.8, 38.1), rel=0.01)


def grey(dark: int, light: int, **save: Any) -> bytes:
    """Return the L as a picture in grey of 16 bits."""
    is_light = np.asarray(Image.open(io.BytesIO(picture()))) > 128
    buffer = io.BytesIO()
    Image.fromarray(np.where(is_light, light, dark).astype(np.uint16)).save(buffer, "PNG", **save)
    return buffer.getvalue()


@pytest.mark.parametrize(
    ("dark", "light", "threshold"),
    [(5000, 60_000, 0.5), (0, 65_535, 0.5), (300, 33_000, 0.5), (20_000, 24_000, 0.33), (40_000, 60_000, 0.7)],
)
def test_grey_of_16_bits_is_scaled(tmp_path: Path, dark: int, light: int, threshold: float) -> None:
    pytest.importorskip("vtracer")
    assert Image.open(io.BytesIO(grey(dark, light))).mode.startswith("I")
    drawing = read(tmp_path, "a.png", grey(dark, light), threshold=threshold)
    assert area(drawing) == pytest.approx(51 * 150 + 149 * 50, rel=0.01)
    with pytest.raises(FileFormatError, match="the picture has no silhouette"):
        read(tmp_path, "a.png", grey(dark, light), threshold=dark / 65_535 * 0.99)


def test_a_grey_of_16_bits_that_is_transparent_is_no_part_of_the_shape(tmp_path: Path) -> None:
    pytest.importorskip("vtracer")
    drawing = read(tmp_path, "a.png", grey(65_535, 0, transparency=0))
    assert area(drawing) == pytest.approx(51 * 150 + 149 * 50, rel=0.01)


@pytest.mark.parametrize("kind", ["PNG", "JPEG"])
@pytest.mark.parametrize("orientation", range(1, 9))
def test_pictures_are_turned_as_their_exif_data_say(tmp_path: Path, kind: str, orientation: int) -> None:
    pytest.importorskip("vtracer")
    upright = Image.open(io.BytesIO(picture())).convert("L")
    # how the picture has to lie in the file so that the orientation turns it upright
    laid = {
        2: Image.Transpose.FLIP_LEFT_RIGHT, 3: Image.Transpose.ROTATE_180, 4: Image.Transpose.FLIP_TOP_BOTTOM,
        5: Image.Transpose.TRANSPOSE, 6: Image.Transpose.ROTATE_90, 7: Image.Transpose.TRANSVERSE,
        8: Image.Transpose.ROTATE_270,
    }  # fmt: skip
    image = upright.transpose(laid[orientation]) if orientation > 1 else upright
    exif = Image.Exif()
    exif[0x0112] = orientation
    buffer = io.BytesIO()
    image.save(buffer, kind, exif=exif)
    drawing = read(tmp_path, f"a.{kind.lower()}", buffer.getvalue())
    (loop,) = drawing.own_coordinates()
    assert loop.min(axis=0) == pytest.approx([50, 20], abs=2)
    assert loop.max(axis=0) == pytest.approx([250, 170], abs=2)
    assert not any(np.hypot(*(loop - (250, 20)).T) < 50)


def test_broken_exif_data_are_passed_over(tmp_path: Path) -> None:
    pytest.importorskip("vtracer")
    drawing = read(tmp_path, "a.jpg", picture(kind="JPEG", quality=95, exif=b"Exif\0\0MM\0*\xff\xff\xff\xff"))
    assert len(drawing.loops) == 1


def test_bad_pictures_are_refused_in_one_line(tmp_path: Path) -> None:
    pytest.importorskip("vtracer")
    good = picture()
    buffer = io.BytesIO()
    Image.new("L", (300, 200), 255).save(buffer, "PNG")
    with pytest.raises(FileFormatError, match="the picture has no silhouette; give a dark shape"):
        read(tmp_path, "a.png", buffer.getvalue())
    with pytest.raises(FileFormatError, match="the picture has 60,000 pixels, and at most 50,000 are"):
        read(tmp_path, "a.png", good, limits=Limits(pixels=50_000))
    for data in (b"hello", good[:100], b"GIF89a" + good):
        with pytest.raises(FileFormatError, match=r"not a PNG or JPEG that can be read: .*; save the picture again"):
            read(tmp_path, "a.png", data)
    huge = bytearray(good)
    huge[16:24] = (60_000).to_bytes(4, "big") * 2
    with pytest.raises(FileFormatError, match="a.png: "):
        read(tmp_path, "a.png", bytes(huge))


@pytest.mark.parametrize(("name", "module", "extra"), [("a.pdf", "pypdfium2", "pdf"), ("a.png", "vtracer", "image")])
def test_a_missing_library_is_told_with_its_extra(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, module: str, extra: str
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(FileFormatError, match=rf"need the extra '{extra}'; install it with pip install"):
        read(tmp_path, name, b"x")


@pytest.mark.skipif(shutil.which("fc-list") is None, reason="fontconfig: not installed")
def test_families_that_are_listed_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    families = font_families()
    assert families == tuple(sorted(set(families), key=str.casefold))
    for family in families[:3]:
        assert find_font(family).is_file()
    monkeypatch.setenv("PATH", "")
    assert font_families() == ()
