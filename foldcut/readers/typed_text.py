"""Draw a text that the user types, with the outlines of a font.

The letters become an SVG with one path each, which the SVG reader flattens and unites. There is no kerning: letters
follow each other by their advance widths, and lines by 1.2 em. A text has no size of its own; ``unit_mm`` is None.
The font ``foldcut`` comes with foldcut (``readers.folding_font``); all others are files.
"""

from __future__ import annotations

import io
import shutil
import subprocess
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol
from xml.sax.saxutils import escape

import numpy as np
from fontTools.pens.boundsPen import BoundsPen
from fontTools.pens.svgPathPen import SVGPathPen
from fontTools.ttLib import TTFont

from foldcut.core.errors import BadInputError, FileFormatError
from foldcut.readers import svg
from foldcut.readers.base import Drawing, ReadOptions, Source
from foldcut.readers.folding_font import NAME, folding_font

LONGEST = 1000
"""The greatest number of letters."""

LINE_EM = 1.2
"""The distance between lines, in em."""


BAR_EM = 0.1
"""How thick the bar is that joins the letters of a font that does not say how wide its strokes are, in em."""

INTO_BAR_EM = 0.02
"""So far letters stand in the bar under them: round ones do not all reach the baseline alike."""

JOINED = ("bar", "baseline")
"""How letters are joined: by a bar under them, or by one as high as a stroke on the baseline, through their feet."""


@dataclass(frozen=True)
class Letter:
    """What is drawn for a letter, in units of the font: the path's data, y up, and its horizontal bounds.

    ``data`` is empty for a space; ``left`` and ``right`` are where its outline begins and ends.
    """

    data: str
    width: float
    left: float = 0.0
    right: float = 0.0


class Glyphs(Protocol):
    """A font: lengths in its units. ``em``: its size; ``line``: from one line to the next; ``bar``: of joined words."""

    em: float
    line: float
    bar: float
    into_bar: float

    def letter(self, letter: str) -> Letter:
        """Return what is drawn for a letter; raises ``BadInputError`` if the font lacks it."""
        ...


def draw_text(text: str, font: str = "sans", options: ReadOptions | None = None, joined: str | None = None) -> Drawing:
    """Return the outlines of ``text``; ``font`` is the path of a font file, with fontconfig a family, or ``foldcut``.

    ``joined``: "bar" or "baseline" joins the letters of each line, see ``JOINED``.

    Raises ``FileFormatError`` if the font cannot be read, and ``BadInputError`` if it lacks a letter.
    """
    drawing = svg.read(Source(text_svg(text, font, joined).encode(), text), options or ReadOptions())
    return replace(drawing, unit_mm=None, y_down=False)


def text_svg(text: str, font: str = "sans", joined: str | None = None) -> str:
    """Return ``text`` as an SVG; see ``draw_text``."""
    _require_letters(text)
    if joined is not None and joined not in JOINED:
        raise BadInputError(f"letters cannot be joined by {joined!r}; choose {' or '.join(JOINED)}")
    if font == NAME:
        return _svg(_Built(), text, joined)
    path = find_font(font)
    try:
        return _svg(_Read(TTFont(io.BytesIO(path.read_bytes()), fontNumber=0)), text, joined)
    except BadInputError:
        raise
    except Exception as error:  # fontTools raises all kinds of errors where a font is broken
        about = " ".join(str(error).split())[:120] or type(error).__name__
        raise FileFormatError(f"{path}: not a font that can be read: {about}; give a .ttf or .otf file") from None


def letter_svgs(text: str, font: str = "sans") -> dict[str, str]:
    """Return each letter of ``text`` once, as an SVG under its name of ``letter_names``, in the order of the text.

    Raises what ``draw_text`` raises.
    """
    names = dict(zip(letter_names(text), _letters(text), strict=True))
    return {name: text_svg(letter, font) for name, letter in names.items()}


def letter_names(text: str) -> list[str]:
    """Return what the files of each letter of ``text`` are called, without spaces.

    A letter or digit is its own name; a small one that also occurs as a capital is called "a-small", and other signs
    by their Unicode name, such as "exclamation-mark". So no two letters share a name, even where case is ignored.
    """
    _require_letters(text)
    letters = _letters(text)
    return [_file_name(letter, letters) for letter in letters]


def _letters(text: str) -> list[str]:
    """Return the letters of a text without spaces."""
    return [letter for letter in text if not letter.isspace()]


def _require_letters(text: str) -> None:
    if not text.strip() or len(text) > LONGEST:
        raise BadInputError(f"the text has {len(text.strip())} letters; give 1 to {LONGEST}")


def _file_name(letter: str, letters: Sequence[str]) -> str:
    if not letter.isalnum():
        return unicodedata.name(letter, f"sign-{ord(letter):x}").lower().replace(" ", "-")
    twin = any(other != letter and other.casefold() == letter.casefold() for other in letters)
    return f"{letter}-small" if twin and letter.islower() else letter


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


def font_file(font: str) -> Path | None:
    """Return the file of a font, or None if it comes with foldcut; raises ``FileFormatError`` if there is none."""
    return None if font == NAME else find_font(font)


def find_font(font: str) -> Path:
    """Return the file of a font, given as a path or as the name of a family."""
    path = Path(font)
    if path.is_file():
        return path
    command = shutil.which("fc-match")
    if path.suffix.lower() in (".ttf", ".otf", ".ttc", ".woff", ".woff2") or command is None:
        families_need = f"give {NAME}, which comes with foldcut, or a .ttf or .otf file: family names need fontconfig"
        hint = "check the path" if command else families_need
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


class _Read:
    """The glyphs of a font file."""

    def __init__(self, font: Any) -> None:
        self.em = float(font["head"].unitsPerEm)
        self.line, self.bar, self.into_bar = LINE_EM * self.em, BAR_EM * self.em, INTO_BAR_EM * self.em
        self._glyphs, self._names = font.getGlyphSet(), font.getBestCmap() or {}

    def letter(self, letter: str) -> Letter:
        if ord(letter) not in self._names:
            raise BadInputError(f"the font has no letter {letter!r}; leave it out or give another --font")
        glyph = self._glyphs[self._names[ord(letter)]]
        pen, bounds = SVGPathPen(self._glyphs), BoundsPen(self._glyphs)
        glyph.draw(pen)
        glyph.draw(bounds)
        left, right = bounds.bounds[::2] if bounds.bounds else (0.0, 0.0)
        return Letter(pen.getCommands(), float(glyph.width), float(left), float(right))


class _Built:
    """The glyphs of the font that comes with foldcut."""

    def __init__(self) -> None:
        self._font = folding_font()
        self.em, self.line = self._font.height, self._font.line
        self.bar, self.into_bar = self._font.stroke, 0.0

    def letter(self, letter: str) -> Letter:
        glyph = self._font.glyphs.get(letter)
        if glyph is None:
            raise BadInputError(
                f"the font {NAME} has no letter {letter!r}; it has A to Z, a to z, 0 to 9, and - . ! Leave it out or "
                "give another --font"
            )
        width = glyph.width + self._font.gap
        if not glyph.loops:
            return Letter("", width)
        data = "".join("M" + "L".join(f"{x!r} {y!r}" for x, y in loop.tolist()) + "Z" for loop in glyph.loops)
        x = np.concatenate(glyph.loops)[:, 0]
        return Letter(data, width, float(x.min()), float(x.max()))


def _svg(font: Glyphs, text: str, joined: str | None) -> str:
    """Return the text as an SVG, y up as in the font."""
    paths = []
    for row, line in enumerate(text.splitlines()):
        x, ends = 0.0, list[float]()
        y = row * font.line
        for letter in line:
            drawn = font.letter(letter)
            if drawn.data:
                paths.append(f'<path transform="translate({x!r} {y!r}) scale(1 -1)" d="{drawn.data}"/>')
                ends += [x + drawn.left, x + drawn.right]
            x += drawn.width
        if joined is not None and ends:
            bottom, top = (-font.bar, font.into_bar) if joined == "bar" else (0.0, font.bar)
            box = f"M{min(ends)!r} {bottom!r}H{max(ends)!r}V{top!r}H{min(ends)!r}Z"
            paths.append(f'<path transform="translate(0 {y!r}) scale(1 -1)" d="{box}"/>')
    if not paths:
        raise BadInputError("the text has no outline; give letters")
    title = escape("".join(letter if letter.isprintable() else " " for letter in text))
    return f'<svg viewBox="0 0 {font.em!r} {font.em!r}"><title>{title}</title>{"".join(paths)}</svg>'
