"""Where the recipe stands in a file: what it was made of, and how, where its format has a place for such a text.

The bytes of a finished file, its ending and the recipe, one line of JSON in ASCII -> the bytes with the recipe in them;
and back again. It is a comment in SVG, HTML, .opx, DXF, G-code and STEP, a key of FOLD, the notes of a LightBurn
project, an entry of PDF's document information, a text chunk of PNG, the description of a 3MF model and the comment of
a zip archive. HPGL and .cp have no place for one, and STL only for half of the drawing's hash.
"""

from __future__ import annotations

import io
import re
import zipfile
import zlib
from collections.abc import Callable
from typing import NamedTuple
from xml.sax.saxutils import escape, unescape

from .bundle import zipped

MARK = "foldcut recipe: "
"""What a recipe begins with wherever it is one text among others."""

PDF_KEY = "/FoldcutRecipe"
"""The entry of a PDF's document information."""

FOLD_KEY = "foldcut:recipe"
"""The key of a FOLD file."""

PNG_KEYWORD = b"foldcut recipe"
"""The keyword of the text chunk."""

DXF_LETTERS = 200
"""Letters of a recipe in one comment of a DXF, whose lines have 255 at most."""

GCODE_LETTERS = 50
"""Letters of a recipe in one comment of G-code: old GRBL takes lines of 80."""

MODEL = "3D/3dmodel.model"
"""The part of a 3MF package that has the model."""

NO_PLACE = {
    ".hpgl": "HPGL has no comments",
    ".cp": "a .cp file has no comments",
    ".stl": "an STL file has room for no more than the drawing's hash",
}
"""The formats without a place, and why."""


BROKEN_ARCHIVE = (zipfile.BadZipFile, zlib.error, KeyError, ValueError, EOFError, NotImplementedError, RuntimeError)
"""What ``zipfile`` raises where an archive is broken, or needs what it cannot do."""


class Place(NamedTuple):
    """How a recipe is put into the bytes of a format, and how it is found there, "" if it is not."""

    put: Callable[[bytes, str], bytes]
    find: Callable[[bytes], str]


IN_MARKUP = re.compile(rb"<!-- " + MARK.encode() + rb"(\{.*\}) -->")
IN_STEP = re.compile(rb"/\* " + MARK.encode() + rb"(\{.*\}) \*/")
IN_DXF = re.compile(rb"^[ \t]*999\r?\n" + MARK.encode() + rb"(.*?)\r?$", re.MULTILINE)
IN_GCODE = re.compile(rb"^; " + MARK.encode() + rb"(.*?)\r?$", re.MULTILINE)
IN_FOLD = re.compile(rb'"' + FOLD_KEY.encode() + rb'": (\{.*\})')
IN_LBRN2 = re.compile(rb'Notes="' + MARK.encode() + rb'([^"]*)"')
IN_3MF = re.compile(rb'<metadata name="Description">' + MARK.encode() + rb"([^<]*)</metadata>")


def with_recipe(data: bytes, suffix: str, recipe: str) -> bytes:
    """Return the bytes of a file with this ending with a recipe in them; the same bytes if there is no place."""
    place = PLACES.get(suffix.lower())
    return data if place is None else place.put(data, recipe)


def recipe_in(data: bytes, suffix: str) -> str:
    """Return the recipe in the bytes of a file, or "" if there is none."""
    place = PLACES.get(suffix.lower())
    return "" if place is None else place.find(data)


def _put_markup(data: bytes, recipe: str) -> bytes:
    """Put a comment after the first line, which is the declaration; two hyphens would end it."""
    text = recipe.replace("--", "-\\u002d")
    first, end, rest = data.partition(b"\n")
    return first + end + f"<!-- {MARK}{text} -->\n".encode() + rest


def _find_markup(data: bytes) -> str:
    return _first(IN_MARKUP, data[:100_000])


def _put_step(data: bytes, recipe: str) -> bytes:
    """Put a comment after the first line."""
    text = recipe.replace("*/", "*\\u002f")
    first, end, rest = data.partition(b"\n")
    return first + end + f"/* {MARK}{text} */\n".encode() + rest


def _find_step(data: bytes) -> str:
    return _first(IN_STEP, data[:100_000])


def _put_dxf(data: bytes, recipe: str) -> bytes:
    """Put comments, group code 999, before everything else."""
    return b"".join(f"999\n{MARK}{part}\n".encode() for part in _parts(recipe, DXF_LETTERS)) + data


def _find_dxf(data: bytes) -> str:
    return _joined(IN_DXF, data)


def _put_gcode(data: bytes, recipe: str) -> bytes:
    """Put comments before everything else, without the letters that GRBL obeys even in comments."""
    for letter in "!?~":
        recipe = recipe.replace(letter, f"\\u{ord(letter):04x}")
    return b"".join(f"; {MARK}{part}\n".encode() for part in _parts(recipe, GCODE_LETTERS)) + data


def _find_gcode(data: bytes) -> str:
    return _joined(IN_GCODE, data)


def _put_fold(data: bytes, recipe: str) -> bytes:
    return data.removesuffix(b"\n}\n") + f',\n"{FOLD_KEY}": {recipe}\n}}\n'.encode()


def _find_fold(data: bytes) -> str:
    return _first(IN_FOLD, data)


def _put_lbrn2(data: bytes, recipe: str) -> bytes:
    notes = f' <Notes ShowOnLoad="0" Notes="{escape(MARK + recipe, {chr(34): "&quot;"})}" />\n'
    end = b"</LightBurnProject>"
    before, _, after = data.rpartition(end)
    return before + notes.encode() + end + after


def _find_lbrn2(data: bytes) -> str:
    return unescape(_first(IN_LBRN2, data), {"&quot;": '"'})


def _put_pdf(data: bytes, recipe: str) -> bytes:
    import pikepdf

    with pikepdf.open(io.BytesIO(data)) as pdf:
        pdf.docinfo[PDF_KEY] = recipe
        out = io.BytesIO()
        pdf.save(out, deterministic_id=True, compress_streams=True)
    return out.getvalue()


def _find_pdf(data: bytes) -> str:
    import pikepdf

    try:
        with pikepdf.open(io.BytesIO(data)) as pdf:
            return str(pdf.docinfo.get(PDF_KEY, ""))
    except pikepdf.PdfError:
        return ""


def _put_png(data: bytes, recipe: str) -> bytes:
    """Put a text chunk after the header, which is the first chunk (PNG specification, 5.3 and 11.3.4.3)."""
    chunk = b"tEXt" + PNG_KEYWORD + b"\0" + recipe.encode()
    sized = (len(chunk) - 4).to_bytes(4, "big") + chunk + zlib.crc32(chunk).to_bytes(4, "big")
    header = 8 + 25
    return data[:header] + sized + data[header:]


def _find_png(data: bytes) -> str:
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(io.BytesIO(data)) as picture:
            return str(picture.info.get(PNG_KEYWORD.decode(), ""))
    except (UnidentifiedImageError, OSError, ValueError):
        return ""


def _put_3mf(data: bytes, recipe: str) -> bytes:
    with zipfile.ZipFile(io.BytesIO(data)) as package:
        parts = {name: package.read(name) for name in package.namelist()}
    text = f'<metadata name="Description">{escape(MARK + recipe)}</metadata>'.encode()
    parts[MODEL] = parts[MODEL].replace(b"<resources>", text + b"<resources>", 1)
    return zipped(parts)


def _find_3mf(data: bytes) -> str:
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as package, package.open(MODEL) as model:
            start = model.read(100_000)
    except BROKEN_ARCHIVE:
        return ""
    return unescape(_first(IN_3MF, start))


def _put_zip(data: bytes, recipe: str) -> bytes:
    """Put a comment at the end; its length is the last thing in an archive that has none (APPNOTE 4.3.16)."""
    comment = (MARK + recipe).encode()
    return data[:-2] + len(comment).to_bytes(2, "little") + comment


def _find_zip(data: bytes) -> str:
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            comment = archive.comment.decode("ascii", "replace")
    except BROKEN_ARCHIVE:
        return ""
    return comment.removeprefix(MARK) if comment.startswith(MARK) else ""


def _put_stl(data: bytes, recipe: str) -> bytes:
    """Put the first half of the drawing's hash into the header, 80 bytes, which has room for no more."""
    found = re.search(r'"sha256":"([0-9a-f]{32})', recipe)
    if found is None:
        return data
    return (data[:80].rstrip() + f"; drawing sha256 {found[1]}".encode()).ljust(80)[:80] + data[80:]


def _parts(text: str, size: int) -> list[str]:
    """Return a text in parts of so many letters."""
    return [text[at : at + size] for at in range(0, len(text), size)]


def _first(pattern: re.Pattern[bytes], data: bytes) -> str:
    found = pattern.search(data)
    return "" if found is None else found[1].decode("ascii", "replace")


def _joined(pattern: re.Pattern[bytes], data: bytes) -> str:
    return b"".join(pattern.findall(data[:100_000])).decode("ascii", "replace")


MARKUP = Place(_put_markup, _find_markup)
PLACES = {
    ".svg": MARKUP,
    ".html": MARKUP,
    ".opx": MARKUP,
    ".dxf": Place(_put_dxf, _find_dxf),
    ".gcode": Place(_put_gcode, _find_gcode),
    ".fold": Place(_put_fold, _find_fold),
    ".lbrn2": Place(_put_lbrn2, _find_lbrn2),
    ".pdf": Place(_put_pdf, _find_pdf),
    ".png": Place(_put_png, _find_png),
    ".step": Place(_put_step, _find_step),
    ".3mf": Place(_put_3mf, _find_3mf),
    ".stl": Place(_put_stl, lambda data: ""),
    ".zip": Place(_put_zip, _find_zip),
}
"""The formats with a place, by their endings; STL's is for a hash only."""
