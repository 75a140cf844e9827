"""PNG: the drawing of the crease pattern as a picture, for screens.

Input: a ``FoldedPattern`` and a ``Profile``; output: PNG, as the ``svg`` exporter draws it on white, at ``DPI`` pixels
an inch, which the file says (PNG specification, 11.3.5.3).
"""

from __future__ import annotations

import io

import resvg_py
from PIL import Image

from foldcut.model import FoldedPattern
from foldcut.profiles import Profile

from . import svg

DPI = 200
MOST_PIXELS = 10_000
"""The longest side of a picture; larger sheets get fewer pixels an inch."""

MM_PER_INCH = 25.4


def export(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return a picture of ``pattern`` as a PNG file."""
    longest = max(pattern.sheet.width, pattern.sheet.height) / MM_PER_INCH
    dpi = min(DPI, MOST_PIXELS / longest)
    drawing = svg.export(pattern, profile).decode()
    data = bytes(resvg_py.svg_to_bytes(svg_string=drawing, dpi=dpi, background="#ffffff"))
    out = io.BytesIO()
    Image.open(io.BytesIO(data)).convert("RGB").save(out, "PNG", dpi=(dpi, dpi))
    return out.getvalue()
