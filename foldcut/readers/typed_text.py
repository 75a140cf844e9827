"""Draw a text that the user types, with the outlines of a font.

The letters become an SVG with one path each, which the SVG reader flattens and unites. There is no kerning: letters
follow each other by their advance widths, and lines by 1.2 em. A text has no size of its own; ``unit_mm`` is None.
"""

from __future__ import annotations

import io
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

from fontTools.pens.svgPathPen import SVGPathPen
from fontTools.ttLib import TTFont

from foldcut.core.errors import BadInputError, FileFormatError
from foldcut.readers import svg
from foldcut.readers.base import Drawing, ReadOptions, Source

LONGEST = 1000
"""The greatest number of letters."""

LINE_EM = 1.2
"""The distance between lines, in em."""


def draw_text(text: str, font: str = "sans", options: ReadOptions | None = None) -> Drawing:
    """Return the outlines of ``text``; ``font`` is the path of a font file or, with fontconfig, a family.

    Raises ``FileFormatError`` if the font cannot be read, and ``BadInputError`` if it lacks a letter.
    """
    if not text.strip() or len(text) > LONGEST:
        raise BadInputError(f"the text has {len(text.strip())} letters; give 1 to {LONGEST}")
    path = find_font(font)
    try:
        drawn = _svg(TTFont(io.BytesIO(path.read_bytes()), fontNumber=0), text)
    except BadInputError:
        raise
    except Exception as error:  # fontTools raises all kinds of errors where a font is broken
        about = " ".join(str(error).split())[:120] or type(error).__name__
        raise FileFormatError(f"{path}: not a font that can be read: {about}; give a .ttf or .otf file") from None
    drawing = svg.read(Source(drawn.encode(), text), options or ReadOptions())
    return replace(drawing, unit_mm=None, y_down=False)


def font_families() -> tuple[str, ...]:
    """Return the names of the font families that ``draw_text`` takes; there are none without fontconfig."""
    command = shutil.which("fc-list")
    if command is None:
        return ()
    words = [command, "--format", "%{family[0]}\n", ":fontformat=TrueType"]
    words_cff = [*words[:-1], ":fontformat=CFF"]
    try:
        found = [subprocess.run(w, capture_output=True, text=True, timeout=20, check=True) for w in (words, words_cff)]
    except (subprocess.SubprocessError, OSError, ValueError):
        return ()
    return tuple(sorted({line for one in found for line in one.stdout.splitlines() if line}, key=str.casefold))


def find_font(font: str) -> Path:
    """Return the file of a font, given as a path or as the name of a family."""
    path = Path(font)
    if path.is_file():
        return path
    command = shutil.which("fc-match")
    if path.suffix.lower() in (".ttf", ".otf", ".ttc", ".woff", ".woff2") or command is None:
        hint = "check the path" if command else "give the path of a .ttf or .otf file: family names need fontconfig"
        raise FileFormatError(f"{font}: there is no such font file; {hint}")
    words = [command, "--format", "%{file}\n%{family}", "--", font]
    try:
        found = subprocess.run(words, capture_output=True, text=True, timeout=20, check=True).stdout
    except (subprocess.SubprocessError, OSError, ValueError):
        raise FileFormatError(f"{font}: fontconfig did not answer; give the path of a font file") from None
    file, _, families = found.partition("\n")
    generic = font.casefold() in ("sans", "serif", "monospace", "sans-serif")
    family = font.partition(":")[0].casefold()
    if not file or not (generic or family in (one.strip().casefold() for one in families.split(","))):
        raise FileFormatError(f"{font}: there is no such font; the nearest is {families.split(',')[0] or 'none'}")
    return Path(file)


def _svg(font: Any, text: str) -> str:
    """Return the text as an SVG, y up as in the font."""
    glyphs, names = font.getGlyphSet(), font.getBestCmap() or {}
    em = int(font["head"].unitsPerEm)
    paths = []
    for row, line in enumerate(text.splitlines()):
        x = 0.0
        for letter in line:
            if ord(letter) not in names:
                raise BadInputError(f"the font has no letter {letter!r}; leave it out or give another --font")
            glyph = glyphs[names[ord(letter)]]
            pen = SVGPathPen(glyphs)
            glyph.draw(pen)
            if commands := pen.getCommands():
                paths.append(f'<path transform="translate({x!r} {row * LINE_EM * em!r}) scale(1 -1)" d="{commands}"/>')
            x += glyph.width
    if not paths:
        raise BadInputError("the text has no outline; give letters")
    title = escape("".join(letter if letter.isprintable() else " " for letter in text))
    return f'<svg viewBox="0 0 {em} {em}"><title>{title}</title>{"".join(paths)}</svg>'
