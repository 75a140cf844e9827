"""SVG files in all encodings, and with the entities that drawing programs declare."""

from __future__ import annotations

import codecs
import time
from pathlib import Path

import pytest
import shapely

from foldcut.core.errors import FileFormatError
from foldcut.readers import Drawing, read_shape

KITE = '<path d="M 10 10 L 90 20 L 70 85 L 30 60 Z"/>'
KITE_AREA = 3450.0
TITLE = "Größe"


def text(encoding: str = "", title: str = TITLE, body: str = KITE, doctype: str = "") -> str:
    declared = f' encoding="{encoding}"' if encoding else ""
    return (
        f'<?xml version="1.0"{declared}?>{doctype}<svg xmlns="http://www.w3.org/2000/svg" width="100mm" '
        f'height="100mm" viewBox="0 0 100 100"><title>{title}</title>{body}</svg>'
    )


def read(folder: Path, data: bytes) -> Drawing:
    path = folder / "a.svg"
    path.write_bytes(data)
    return read_shape(path)


@pytest.mark.parametrize(
    ("data", "title"),
    [
        (text("UTF-8").encode(), TITLE),
        (text().encode(), TITLE),
        (codecs.BOM_UTF8 + text("UTF-8").encode(), TITLE),
        (codecs.BOM_UTF8 + text("ISO-8859-1").encode(), TITLE),  # the mark is believed
        (text("UTF-16").encode("utf-16"), TITLE),
        (codecs.BOM_UTF16_BE + text("UTF-16").encode("utf-16-be"), TITLE),
        (text("UTF-16LE").encode("utf-16-le"), TITLE),
        (text("UTF-16BE").encode("utf-16-be"), TITLE),
        (text("utf-16").encode(), TITLE),  # as programs write that change the encoding and not the declaration
        (text("UTF-32").encode("utf-32"), TITLE),
        (text("ISO-8859-1").encode("latin-1"), TITLE),
        (text("iso-8859-1", "a “kite”").encode("cp1252"), "a “kite”"),  # as browsers read it
        (text("windows-1252", "100 €").encode("cp1252"), "100 €"),
        (text("ISO-8859-15", "100 €").encode("iso-8859-15"), "100 €"),
        (text("windows-1251", "змей").encode("cp1251"), "змей"),
        (text("Shift_JIS", "たこ").encode("shift_jis"), "たこ"),
        (text("GB2312", "风筝").encode("gb2312"), "风筝"),
        (text("us-ascii", "kite").encode("ascii"), "kite"),
        (text("UTF-16", "\U0001fa81").encode("utf-16"), "\U0001fa81"),
        (b"\n" + text("")[text("").index("<svg") :].encode("utf-8"), TITLE),
    ],
)
def test_every_encoding_is_read(tmp_path: Path, data: bytes, title: str) -> None:
    drawing = read(tmp_path, data)
    assert drawing.title == title
    (loop,) = drawing.loops
    assert shapely.Polygon(loop).area == KITE_AREA


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (text("UTF-8").encode("latin-1"), "byte 138 is not UTF-8; save the file as UTF-8 text"),
        (text("").encode("latin-1"), "is not UTF-8; save the file as UTF-8 text"),
        (text("klingon").encode(), "its encoding 'klingon' is not known; save the file as UTF-8 text"),
        (text("rot13").encode(), "its encoding 'rot13' is not known; save the file as UTF-8 text"),
        (text("UTF-16").encode("utf-16")[:-1], "is not utf-16-le; save the file as UTF-8 text"),
        (text("cp1252", "a").encode() + b"\x81", "is not cp1252; save the file as UTF-8 text"),
        (codecs.BOM_UTF16_LE + "  ".encode("utf-16-le"), "the file is empty"),
    ],
)
def test_what_is_not_in_its_encoding_is_refused(tmp_path: Path, data: bytes, words: str) -> None:
    with pytest.raises(FileFormatError, match=words):
        read(tmp_path, data)


def test_numbers_are_counted_in_every_encoding(tmp_path: Path) -> None:
    """In UTF-16 a digit takes two bytes, and is not a number of its own."""
    points = " ".join(f"{x}.{x % 10}25,{x * 7 % 1000}.5" for x in range(30_000))
    body = f'{KITE}<polyline fill="none" points="{points}"/>'
    assert read(tmp_path, text("UTF-16", body=body).encode("utf-16")).loops
    many = f'<polyline points="{points * 4}"/>'
    with pytest.raises(FileFormatError, match="has about 120,00. points, and at most 100,000"):
        read(tmp_path, text("UTF-16", body=many).encode("utf-16"))


ILLUSTRATOR = """<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd" [
  <!ENTITY ns_ai "http://ns.adobe.com/AdobeIllustrator/10.0/">
  <!ENTITY st0 "fill:none;">
  <!ENTITY st1 'fill:#1D1D1B;stroke:none'>
  <!ENTITY place "10 10 L 90 20">
  <!ENTITY gr "&#71;r">
  <!ENTITY % unused "that is for a DTD">
]>"""
"""As Illustrator 10 and CorelDRAW write it; a parameter entity is refused."""


@pytest.mark.parametrize(
    "body",
    [
        '<g xmlns:i="&ns_ai;" i:extraneous="self"><path d="M &place; L 70 85 L 30 60 Z"/></g>',
        f'<rect style="&st0;" width="100" height="100"/>{KITE}',
        f'<g style="&st0;"><rect width="100" height="100"/><g style="&st1;">{KITE}</g></g>',
        f'<switch><foreignObject requiredExtensions="&ns_ai;" width="1" height="1"/><g>{KITE}</g></switch>',
    ],
)
def test_entities_of_plain_text_are_read(tmp_path: Path, body: str) -> None:
    doctype = ILLUSTRATOR.replace('  <!ENTITY % unused "that is for a DTD">\n', "")
    drawing = read(tmp_path, text("UTF-8", "&gr;öße", body, doctype).encode())
    (loop,) = drawing.loops
    assert shapely.Polygon(loop).area == KITE_AREA
    assert drawing.title == TITLE


@pytest.mark.parametrize(
    ("declarations", "words"),
    [
        ('<!ENTITY a "x"><!ENTITY b "&a;&a;">', "such as 'b', which has elements or other entities in it"),
        ('<!ENTITY b "&#38;a;">', "such as 'b', which has elements or other entities in it"),
        ('<!ENTITY b "<path/>">', "such as 'b', which has elements or other entities in it"),
        ('<!ENTITY b SYSTEM "file:///etc/hostname">', "that are in other files"),
        ('<!ENTITY b PUBLIC "b" "http://127.0.0.1:9/">', "that are in other files"),
        ('<!ENTITY % b "x">', "that are in other files"),
        (f'<!ENTITY b "{"x" * 10_001}">', "or one with more than 10,000"),
        (f'<!ENTITY b "{"x" * 5_000}">', "come to more than 2,000,000 letters"),
        ('<!NOTATION n SYSTEM "n"><!ENTITY b SYSTEM "b" NDATA n>', "that are in other files"),
    ],
)
def test_other_entities_are_refused_at_once(tmp_path: Path, declarations: str, words: str) -> None:
    doctype = f"<!DOCTYPE svg [{declarations}]>"
    started = time.process_time()
    with pytest.raises(FileFormatError, match=f"the file declares XML entities .*{words}"):
        read(tmp_path, text(title="&b;" * 400, doctype=doctype).encode())
    assert time.process_time() - started < 5
