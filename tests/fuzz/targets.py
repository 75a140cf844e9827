"""What is fuzzed: for each reader, a function of bytes that fails if foldcut breaks its promise, and seeds.

The promise: any bytes give a shape or a documented error of one line, within 10 s. Nothing here needs atheris.
"""

from __future__ import annotations

import io
import json
import sys
import tempfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape, quoteattr

import shapely
from cases.table import CASES
from fontTools.fontBuilder import FontBuilder
from fontTools.pens.ttGlyphPen import TTGlyphPen
from PIL import Image, ImageDraw
from reportlab.pdfgen.canvas import Canvas

from foldcut.core.errors import FoldcutError
from foldcut.core.units import parse_length
from foldcut.drawing.limits import parse_limits
from foldcut.drawing.mend import Preparation, prepare
from foldcut.drawing.placement import parse_sheet
from foldcut.drawing.shape import invariant_faults, make_shape
from foldcut.foldfile.decide import decide
from foldcut.foldfile.patterns import read_pattern
from foldcut.profiles import load_profile
from foldcut.readers import Drawing, ReadOptions, read_shape
from foldcut.readers.typed_text import draw_text
from foldcut.samples import sample_names, sample_path

LONGEST_SEED = 20_000
"""The size of the largest seed, in bytes: larger cases are about size, which fuzzing is not."""

TEXT = "Ag"
"""The text that is drawn with each font."""


class BrokenPromiseError(AssertionError):
    """What came out is neither a shape nor an error as documented."""


@dataclass(frozen=True)
class Target:
    """How a reader is called, its seeds, and how to mend changed bytes that it would refuse at once."""

    read: Callable[[bytes], None]
    seeds: tuple[bytes, ...]
    mended: Callable[[bytes], bytes] = bytes

    def check(self, data: bytes) -> bool:
        """Return whether ``data`` is taken; raises whatever the reader must not raise."""
        try:
            self.read(data)
        except FoldcutError as error:
            if not str(error).strip() or "\n" in str(error):
                raise BrokenPromiseError(f"the error is not one line: {str(error)!r}") from error
            return False
        return True


def _to_shape(drawing: Drawing) -> None:
    prepared = prepare(drawing.loops, Preparation())
    if faults := invariant_faults(make_shape(prepared.loops)):
        raise BrokenPromiseError(f"no shape: {faults}")


def _by_suffix(suffix: str) -> Callable[[bytes], None]:
    def read(data: bytes) -> None:
        before, sys.stdin = sys.stdin, io.TextIOWrapper(io.BytesIO(data))
        try:
            drawing = read_shape("-", ReadOptions(suffix=suffix))
        finally:
            sys.stdin = before
        _to_shape(drawing)

    return read


def _pattern(suffix: str) -> Callable[[bytes], None]:
    """Return a function that does all that ``check`` does with a pattern."""

    def read(data: bytes) -> None:
        with tempfile.NamedTemporaryFile(suffix=suffix) as file:
            file.write(data)
            file.flush()
            pattern = read_pattern(Path(file.name))
        decide(pattern)

    return read


def _css(data: bytes) -> None:
    """Read a drawing with a style sheet, and with the same text as the style of one element."""
    text = "".join(letter for letter in data.decode("utf-8", "replace") if letter.isprintable() or letter == "\n")
    for drawing in (
        f"<svg><style>{escape(text)}</style>{STYLED}</svg>",
        f"<svg><g style={quoteattr(text)}>{STYLED}</g></svg>",
    ):
        read_svg(drawing.encode())


def _text(data: bytes) -> None:
    with tempfile.NamedTemporaryFile(suffix=".ttf") as file:
        file.write(data)
        file.flush()
        drawing = draw_text(TEXT, file.name)
    _to_shape(drawing)


def _values(data: bytes) -> None:
    """Read a text as each kind of value that options have; the first error is as good as any."""
    text = data.decode("utf-8", "replace")
    errors: list[FoldcutError] = []
    readers: tuple[Callable[[str], object], ...] = (
        parse_length,
        parse_sheet,
        lambda text: parse_limits([text]),
        lambda text: load_profile("plain", [text]),
    )
    for read in readers:
        try:
            read(text)
        except FoldcutError as error:
            if "\n" in str(error):
                raise
            errors.append(error)
    if len(errors) == len(readers):
        raise errors[0]


read_svg = _by_suffix("svg")

STYLED = (
    '<g id="a" class="b c"><rect width="40" height="30"/><path id="d" class="c" data-x="1" d="M5 5H20V20z"/></g>'
    '<use href="#d" x="50" width="9"/><clipPath id="e"><circle r="30"/></clipPath>'
)
"""The elements that style sheets are tried on."""


# --- seeds


def _cases(suffix: str, *more: str | bytes) -> tuple[bytes, ...]:
    """Return the cases and samples of a format, and those in ``more``, as bytes."""
    found = [case.data for name, case in CASES.items() if name.endswith(suffix) and len(case.data) <= LONGEST_SEED]
    paths = map(sample_path, sample_names())
    found += [path.read_bytes() for path in paths if path.suffix == suffix]
    found += [one.encode() if isinstance(one, str) else one for one in more]
    return tuple(dict.fromkeys(found))


RING = [(0, 0), (40, 0), (40, 30), (0, 30), (0, 0)]
HOLE = [(10, 10), (20, 10), (20, 20), (10, 10)]

SVGS = (
    '<svg width="9mm" height="9mm" viewBox="0 0 9 9"><g transform="rotate(9) scale(2 -1)"><circle r="4"/></g></svg>',
    '<svg><defs><rect id="a" width="9" height="9" rx="2"/></defs><use href="#a" x="3"/><use href="#a" y="40"/></svg>',
    '<svg><style>.b{fill:none;stroke:red}</style><path class="b" d="M0 0A9 9 0 0 1 9 9Q3 3 2 2T1 1S5 5 0 0z"/></svg>',
    '<svg><line x1="0" y1="0" x2="9" y2="0"/><polyline fill="none" stroke="#000" points="9,0 9,9 0,0"/></svg>',
    '<svg><symbol id="s" viewBox="0 0 4 4"><ellipse rx="1"/></symbol><use href="#s" width="9" height="9"/></svg>',
    '<svg><style>g>a~.b:not(#c),rect:has(+a){fill:var(--d,red)}</style><g style="--d:#00f"><rect width="9" height="9" '
    'fill="url( #e )"/></g><linearGradient id="e"><stop/></linearGradient></svg>',
    '<svg><clipPath id="a"><circle r="4"/></clipPath><g clip-path="url(#a)" style="transform:rotate(9deg)"><rect '
    'width="9" height="9" stroke="red" stroke-dasharray="1 2"/></g></svg>',
    '<svg><path d="M50 0 2 29 98 29 21 99 21 0 80 99z"/><path fill="#fff" d="M20 20H60V60z"/></svg>',
    '<svg><path fill-rule="evenodd" d="M0 0H40V40H0ZM10 10h9v9h-9zM5 5C9 5 30 9 35 35Z"/><svg><rect/></svg></svg>',
)


SHEETS = (
    ".b>rect,g~#d:not(.e){fill:none!important;stroke:red;stroke-width:2mm}",
    "@media screen{#d{transform:rotate(9deg)}}@media print{rect{display:none}}",
    "@namespace s url(http://www.w3.org/2000/svg);s|rect,[data-x^='1' i],*:first-child{fill:var(--d, #fff8)}",
    "transform:translate(10px,5%) matrix(1,0,0,1,2,2);transform-origin:50% left;--a:var(--b);--b:var(--a)",
    ".c{clip-path:url(#e);d:path('M0 0H9V9z');opacity:.0;fill:hsl(9deg 50% 50%/20%)}/* \\26 */@import 'x.css';",
    "fill:color-mix(in srgb,red,lab(50% 1 2));visibility:hidden;stroke-dasharray:1 2;width:calc(1px + 2em)",
)


MARKERS = {
    "LWPOLYLINE": "AcDbPolyline",
    "CIRCLE": "AcDbCircle",
    "ELLIPSE": "AcDbEllipse",
    "SPLINE": "AcDbSpline",
    "POLYLINE": "AcDb2dPolyline",
    "VERTEX": "AcDbVertex 100 AcDb2dVertex",
    "SOLID": "AcDbTrace",
    "INSERT": "AcDbBlockReference",
    "HATCH": "AcDbHatch",
}


def _dxf(*entities: str, unit: int = 4, block: str = "") -> str:
    """Return a DXF file of 2000; an entity is ``KIND code value code value ...``."""

    def section(name: str, text: str) -> str:
        return f"0 SECTION 2 {name} {text} 0 ENDSEC "

    def shown(entity: str) -> str:
        kind, _, rest = entity.partition(" ")
        marker = f"100 {MARKERS[kind]}" if kind in MARKERS else ""
        return f"0 {kind} 100 AcDbEntity 8 0 {marker} {rest}"

    text = section("HEADER", f"9 $ACADVER 1 AC1015 9 $INSUNITS 70 {unit}")
    if block:
        start = "0 BLOCK 100 AcDbEntity 8 0 100 AcDbBlockBegin 2 B 70 0 10 0 20 0"
        text += section("BLOCKS", f"{start} {shown(block)} 0 ENDBLK 100 AcDbEntity 8 0 100 AcDbBlockEnd")
    text += section("ENTITIES", " ".join(map(shown, entities))) + "0 EOF"
    return "\n".join(text.split()) + "\n"


SQUARE = "10 0 20 0 10 40 20 0 10 40 20 40 10 0 20 40"
LINES = [
    f"LINE 10 {a} 20 {b} 11 {c} 21 {d}"
    for a, b, c, d in [(0, 0, 40, 0), (40, 0, 40, 30), (40, 30, 0, 30), (0, 30, 0, 0)]
]
HATCH = "HATCH 10 0 20 0 30 0 2 SOLID 70 1 71 0 91 1"
ARC_EDGES = "93 2 72 1 10 0 20 0 11 40 21 0 72 2 10 20 20 0 40 20 50 0 51 180 73 1"
DXFS = (
    _dxf(f"LWPOLYLINE 90 4 70 1 {SQUARE}"),
    _dxf("LWPOLYLINE 90 2 70 1 10 0 20 0 42 1 10 40 20 0 42 0.5", unit=1),
    _dxf(*LINES),
    _dxf("LINE 10 0 20 0 11 40 21 0", "ARC 10 20 20 0 40 20 50 0 51 180"),
    _dxf("CIRCLE 10 5 20 5 40 9", "TEXT 10 0 20 0 40 1 1 hello"),
    _dxf("ELLIPSE 10 0 20 0 30 0 11 9 21 0 31 0 40 0.5 41 0 42 6.283185307"),
    _dxf(f"SPLINE 70 8 71 2 72 7 73 4 40 0 40 0 40 0 40 1 40 2 40 2 40 2 {SQUARE}", "LINE 10 0 20 40 11 0 21 0"),
    _dxf("SPLINE 70 0 71 3 74 4 11 0 21 0 11 9 21 0 11 9 21 9 11 0 21 0"),
    _dxf("POLYLINE 66 1 70 1", *(f"VERTEX 10 {x} 20 {y} 42 0.1" for x, y in RING[:3]), "SEQEND"),
    _dxf("SOLID 10 0 20 0 11 9 21 0 12 0 22 9 13 9 23 9"),
    _dxf("INSERT 2 B 10 3 20 4 41 2 42 -1 50 30 70 2 71 1 44 60", block=f"LWPOLYLINE 90 4 70 1 {SQUARE}"),
    _dxf("INSERT 2 B 10 0 20 0", block="INSERT 2 B 10 0 20 0"),
    _dxf(f"{HATCH} 92 2 72 0 73 1 93 4 {SQUARE} 97 0 75 1 76 1 98 0"),
    _dxf(f"{HATCH} 92 1 {ARC_EDGES} 97 0 75 1 76 1 98 0"),
)

GEOJSONS = (
    json.dumps({"type": "Polygon", "coordinates": [RING, HOLE]}),
    json.dumps({"type": "Feature", "geometry": {"type": "MultiPolygon", "coordinates": [[RING], [HOLE]]}}),
    json.dumps({"type": "FeatureCollection", "features": [{"type": "Feature", "geometry": None}]}),
    json.dumps({"type": "GeometryCollection", "geometries": [{"type": "Polygon", "coordinates": [RING]}]}),
)

CSVS = ("loop;x;y\n1;0;0\n1;9;0\n1;0;9\n2;20;0\n2;29;0\n2;20;9\n", "# a\nx y\n0 0\n9 0\n0 9\n\n5 5\n")

POLYGON = shapely.Polygon(RING, [HOLE])
TWO = shapely.MultiPolygon([POLYGON, shapely.Polygon(RING[:4]).buffer(1, quad_segs=1)])
WKBS = (
    shapely.to_wkb(POLYGON),
    shapely.to_wkb(TWO, hex=True),
    shapely.to_wkb(shapely.force_3d(POLYGON), byte_order=0),
    shapely.to_wkb(shapely.GeometryCollection([POLYGON, shapely.Point(1, 2)])),
    shapely.to_wkb(shapely.set_srid(POLYGON, 4326), include_srid=True),
    shapely.to_wkb(shapely.Polygon()),
)


def _pdf(draw: Callable[[Any], object], pages: int = 1, compressed: int = 0) -> bytes:
    stream = io.BytesIO()
    canvas = Canvas(stream, pagesize=(100, 80), pageCompression=compressed, invariant=1)
    for _ in range(pages):
        draw(canvas)
        canvas.showPage()
    canvas.save()
    return stream.getvalue()


def _page(canvas: Any) -> None:
    canvas.setFillColorRGB(1, 1, 1)
    canvas.rect(0, 0, 100, 80, stroke=0, fill=1)
    canvas.setFillColorRGB(0, 0, 0)
    canvas.transform(1, 0.1, 0, 1, 5, 5)
    canvas.rect(10, 10, 40, 30, stroke=0, fill=1)
    canvas.circle(70, 40, 9, stroke=1, fill=0)
    canvas.drawString(9, 9, "hello")


def _form(canvas: Any) -> None:
    if not canvas.hasForm("form"):
        canvas.beginForm("form")
        canvas.rect(10, 10, 40, 30, stroke=0, fill=1)
        canvas.endForm()
    canvas.doForm("form")
    canvas.line(60, 10, 60, 20)


SMALL_PDF = (
    b"%PDF-1.4\n1 0 obj<</Type/Catalog/Pages 2 0 R>>endobj 2 0 obj<</Type/Pages/Kids[3 0 R]/Count 1>>endobj "
    b"3 0 obj<</Type/Page/Parent 2 0 R/MediaBox[0 0 99 99]/Contents 4 0 R>>endobj 4 0 obj<</Length 48>>stream\n"
    b"q 1 0 0 1 5 5 cm 0 0 m 40 0 l 40 40 9 9 0 40 c f* Q\nendstream endobj trailer<</Root 1 0 R>>"
)
FORMS_PDF = (
    b"%PDF-1.4\n1 0 obj<</Type/Catalog/Pages 2 0 R>>endobj 2 0 obj<</Type/Pages/Kids[3 0 R]/Count 1>>endobj "
    b"3 0 obj<</Type/Page/Parent 2 0 R/MediaBox[0 0 99 99]/Contents 4 0 R/Resources<</XObject<</F 5 0 R>>>>>>endobj "
    b"4 0 obj<</Length 11>>stream\n/F Do /F Do\nendstream endobj "
    b"5 0 obj<</Type/XObject/Subtype/Form/BBox[0 0 99 99]/Length 11/Resources<</XObject<</F 6 0 R>>>>>>"
    b"stream\n/F Do /F Do\nendstream endobj "
    b"6 0 obj<</Type/XObject/Subtype/Form/BBox[0 0 99 99]/Length 14>>stream\n9 9 40 30 re f\nendstream endobj "
    b"trailer<</Root 1 0 R>>"
)
PDFS = (SMALL_PDF, _pdf(_page), _pdf(_page, pages=2, compressed=1), _pdf(_form), FORMS_PDF)


def _picture(kind: str, mode: str = "L", **save: Any) -> bytes:
    image = Image.new("L", (24, 16), 255)
    draw = ImageDraw.Draw(image)
    draw.polygon([(2, 2), (20, 3), (12, 13)], fill=0)
    draw.rectangle((9, 5, 11, 7), fill=255)
    if mode == "RGBA":
        clear = Image.new("RGBA", image.size, (255, 255, 255, 0))
        clear.paste((0, 0, 0, 255), mask=image.point(lambda value: 255 - value))
        image = clear
    stream = io.BytesIO()
    image.convert(mode).save(stream, kind, **save)
    return stream.getvalue()


PICTURES = (
    _picture("PNG"),
    _picture("PNG", "1"),
    _picture("PNG", "P"),
    _picture("PNG", "RGBA", dpi=(300, 300)),
    _picture("PNG", "I;16"),
    _picture("JPEG", quality=50),
    _picture("JPEG", progressive=True, dpi=(72, 72)),
)


def mend_png(data: bytes) -> bytes:
    """Return a PNG with the right checksums for its chunks, and anything else as it is."""
    if not data.startswith(b"\x89PNG\r\n\x1a\n"):
        return data
    mended, at = bytearray(data), 8
    while at + 12 <= len(data):
        end = at + 8 + int.from_bytes(data[at : at + 4], "big")
        if end + 4 > len(data):
            break
        mended[end : end + 4] = zlib.crc32(data[at + 4 : end]).to_bytes(4, "big")
        at = end + 4
    return bytes(mended)


def _font(*, outlines: str, composite: bool = False) -> bytes:
    """Return a font with an A and a g, of TrueType or PostScript outlines."""
    contours = {"A": [(0, 0), (250, 700), (500, 0)], "g": [(0, -200), (0, 500), (500, 500), (500, -200)]}
    builder = FontBuilder(1000, isTTF=outlines == "glyf")
    names = [".notdef", *contours]
    builder.setupGlyphOrder(names)
    builder.setupCharacterMap({ord(name): name for name in contours})

    def drawn(name: str, pen: Any) -> Any:
        if name in contours:
            first, *rest = contours[name]
            pen.moveTo(first)
            pen.lineTo(rest[0])
            if name == "g":
                pen.qCurveTo(*rest) if outlines == "glyf" else pen.curveTo(*rest)
            else:
                pen.lineTo(rest[1])
            pen.closePath()
        return pen

    if outlines == "glyf":
        glyphs = {name: drawn(name, TTGlyphPen(None)).glyph() for name in names}
        if composite:
            pen = TTGlyphPen(dict.fromkeys(names))
            pen.addComponent("A", (1, 0, 0.5, 1, 9, 9))
            glyphs["g"] = pen.glyph()
        builder.setupGlyf(glyphs)
    else:
        from fontTools.pens.t2CharStringPen import T2CharStringPen

        strings = {name: drawn(name, T2CharStringPen(600, None)).getCharString() for name in names}
        builder.setupCFF("Test", {}, strings, {})
    builder.setupHorizontalMetrics(dict.fromkeys(names, (600, 0)))
    builder.setupHorizontalHeader(ascent=800, descent=-200)
    builder.setupPost()
    stream = io.BytesIO()
    builder.save(stream)
    return stream.getvalue()


CPS = ("1 0 0 9 0\n1 9 0 9 9\n1 9 9 0 9\n1 0 9 0 0\n2 0 0 9 9\n3 4.5 4.5 9 0\n", "2,0,-9,0,9\n\n0 0 0 1e2 -.5\n")
OPX = (
    '<java><object class="java.beans.XMLDecoder"><object class="oripa.DataSet"><array class="oripa.OriLineProxy">'
    + "".join(
        f'<void index="{at}"><object class="oripa.OriLineProxy"><void property="type"><int>{kind}</int></void>'
        + "".join(
            f'<void property="{name}"><double>{value}</double></void>'
            for name, value in zip(("x0", "y0", "x1", "y1"), ends, strict=True)
        )
        + "</object></void>"
        for at, (kind, *ends) in enumerate([(1, 0, 0, 9, 0), (1, 9, 0, 9, 9), (1, 9, 9, 0, 0), (2, 9, 0, 4.5, 4.5)])
    )
    + "</array></object></object></java>"
)
CREASES = (
    '<svg><g fill="none" stroke="#000"><rect width="90" height="60"/><path stroke="red" d="M0 0 90 60M45 0v60"/>'
    '<line stroke="blue" x2="90" y1="60"/><polyline stroke="#888" points="0,30 45,30 90,30"/></g></svg>',
    '<svg width="9cm" height="9cm" viewBox="0 0 9 9"><style>.m{stroke:#f00}.v{stroke:#00f}path{stroke:#000}</style>'
    '<path d="M0 0H9V9H0z"/><path class="m" d="M0 4H9"/><path class="v" d="M4 0V9"/></svg>',
)

VALUES = (
    b"10mm",
    b".5e1 in",
    b"a4",
    b"200x 300 mm",
    b"points=7",
    b"pen.width_mm=0.5",
    b'materials.paper={a=1,b=["c"]}',
)
FONTS = (_font(outlines="glyf"), _font(outlines="CFF "), _font(outlines="glyf", composite=True))
GOLDEN = Path(__file__).parent.parent / "golden"

TARGETS = {
    "svg": Target(_by_suffix("svg"), _cases(".svg", *SVGS)),
    "dxf": Target(_by_suffix("dxf"), _cases(".dxf", *DXFS)),
    "pdf": Target(_by_suffix("pdf"), _cases(".pdf", *PDFS)),
    "geojson": Target(_by_suffix("geojson"), _cases(".geojson", *GEOJSONS)),
    "wkt": Target(_by_suffix("wkt"), _cases(".wkt", TWO.wkt)),
    "wkb": Target(_by_suffix("wkb"), _cases(".wkb", *WKBS)),
    "csv": Target(_by_suffix("csv"), _cases(".csv", *CSVS)),
    "json": Target(_by_suffix("json"), _cases(".json", *GEOJSONS)),
    "image": Target(_by_suffix("png"), (*_cases(".png", *PICTURES), *_cases(".jpg")), mend_png),
    "text": Target(_text, FONTS),
    "values": Target(_values, VALUES),
    "css": Target(_css, tuple(sheet.encode() for sheet in SHEETS)),
    "fold": Target(_pattern(".fold"), _cases(".fold", (GOLDEN / "book.fold").read_bytes())),
    "cp": Target(_pattern(".cp"), _cases(".cp", *CPS)),
    "opx": Target(_pattern(".opx"), _cases(".opx", OPX)),
    "creases": Target(_pattern(".svg"), tuple(drawing.encode() for drawing in CREASES)),
}
