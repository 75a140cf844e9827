"""PNG: the drawing of the crease pattern as a picture, for screens.

Input: a ``FoldedPattern`` and a ``Profile``; output: PNG of the drawing that ``svg`` makes, on white, at ``DPI`` pixels
per inch, which the file states (PNG specification, 11.3.5.3). Words are set in a font that comes with reportlab, so
that they look the same on every machine; letters that it lacks come from the system's fonts.
"""

from __future__ import annotations

import io
from pathlib import Path

import reportlab
import resvg_py
from PIL import Image

from foldcut.core.model import FoldedPattern
from foldcut.core.units import MM_PER_INCH
from foldcut.profiles import Profile

from . import svg

DPI = 200
"""Pixels per inch."""

MOST_PIXELS = 10_000
"""The most pixels along the longer side; larger sheets get fewer pixels per inch."""

FONT = Path(reportlab.__file__).parent / "fonts" / "Vera.ttf"
"""The font of the words."""

FONT_NAME = "Bitstream Vera Sans"
"""What that font calls itself."""


def export(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return a picture of ``pattern`` as a PNG file."""
    return rendered(svg.export(pattern, profile), (pattern.sheet.width, pattern.sheet.height))


def rendered(drawing: bytes, size: tuple[float, float]) -> bytes:
    """Return an SVG, whose width and height in mm are ``size``, as a PNG file."""
    dpi = min(DPI, MOST_PIXELS / max(size) * MM_PER_INCH)
    pixels = resvg_py.svg_to_bytes(
        svg_string=drawing.decode(), dpi=dpi, background="#ffffff", font_files=[str(FONT)], sans_serif_family=FONT_NAME
    )
    out = io.BytesIO()
    Image.open(io.BytesIO(bytes(pixels))).convert("RGB").save(out, "PNG", dpi=(dpi, dpi))
    return out.getvalue()
