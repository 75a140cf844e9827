"""PNG: the drawing of the crease pattern as a picture, for screens.

Input: a ``FoldedPattern`` and a ``Profile``; output: PNG, as the ``svg`` exporter draws it on white, at ``DPI`` pixels
an inch, which the file says (PNG specification, 11.3.5.3). Words are in reportlab's own font, so that they are there on
every machine; letters that it does not have are the system's.
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
MOST_PIXELS = 10_000
"""The longest side of a picture; larger sheets get fewer pixels an inch."""

FONT, FONT_NAME = Path(reportlab.__file__).parent / "fonts" / "Vera.ttf", "Bitstream Vera Sans"


def export(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return a picture of ``pattern`` as a PNG file."""
    return rendered(svg.export(pattern, profile), (pattern.sheet.width, pattern.sheet.height))


def rendered(drawing: bytes, size: tuple[float, float]) -> bytes:
    """Return an SVG of ``size`` in mm as a PNG file."""
    dpi = min(DPI, MOST_PIXELS / max(size) * MM_PER_INCH)
    pixels = resvg_py.svg_to_bytes(
        svg_string=drawing.decode(), dpi=dpi, background="#ffffff", font_files=[str(FONT)], sans_serif_family=FONT_NAME
    )
    out = io.BytesIO()
    Image.open(io.BytesIO(bytes(pixels))).convert("RGB").save(out, "PNG", dpi=(dpi, dpi))
    return out.getvalue()
