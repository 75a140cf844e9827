"""Read the first page of a PDF with PDFium (extra ``pdf``): its filled and stroked paths.

The paths become an SVG, which the SVG reader flattens and unites. White fills before anything else are taken for the
background of the page and passed over, as are texts, pictures and clipping. The unit is the point.
"""

from __future__ import annotations

import ctypes
from collections import Counter
from dataclasses import replace
from typing import Any

from foldcut.core.errors import FileFormatError
from foldcut.drawing.limits import Limits
from foldcut.readers import svg
from foldcut.readers.base import Drawing, ReadOptions, Source, counted, missing

MOST_SEGMENTS = 1_000_000
"""A page with more segments of paths is refused."""

_WHITE = (255, 255, 255)


def read(source: Source, options: ReadOptions) -> Drawing:
    """Return the drawing on the first page of a PDF file; its title is the name of the file."""
    try:
        import pypdfium2
    except ImportError:
        raise missing("PDF files", "pdf") from None
    ignored: Counter[str] = Counter()
    try:
        with pypdfium2.PdfDocument(source.data) as document:
            pages = len(document)
            page = document[0]
            size, paths = page.get_size(), _paths(page, ignored, options.limits)
    except FileFormatError:
        raise
    except Exception as error:  # a PdfiumError, or one of ctypes where the file is broken
        about = " ".join(str(error).split())[:120] or type(error).__name__
        raise FileFormatError(f"not a PDF file that can be read: {about}; export the drawing again") from None
    if not paths:
        there = ", ".join(counted(ignored)) or "nothing"
        raise FileFormatError(f"the first page has no vector path, only {there}; export the drawing as vectors")
    if pages > 1:
        ignored["further page"] += pages - 1
    width, height = size
    text = (
        f'<svg width="{width!r}pt" height="{height!r}pt" viewBox="0 0 {width!r} {height!r}">'
        f'<g transform="matrix(1 0 0 -1 0 {height!r})">{"".join(paths)}</g></svg>'
    )
    return replace(svg.read(Source(text.encode(), source.name), options), ignored=counted(ignored))


def _paths(page: Any, ignored: Counter[str], limits: Limits) -> list[str]:
    """Return the page's paths as SVG elements, y up."""
    from pypdfium2 import raw

    names = {raw.FPDF_PAGEOBJ_TEXT: "text", raw.FPDF_PAGEOBJ_IMAGE: "image", raw.FPDF_PAGEOBJ_SHADING: "shading"}
    paths: list[str] = []
    segments = 0
    for item in page.get_objects(max_depth=limits.nesting + 1):
        limits.check_nesting(_depth(item) - 1)
        if item.type != raw.FPDF_PAGEOBJ_PATH:
            if item.type in names:
                ignored[names[item.type]] += 1
            continue
        segments += max(raw.FPDFPath_CountSegments(item), 0)
        if segments > MOST_SEGMENTS:
            raise FileFormatError(f"the page has more than {MOST_SEGMENTS:,} segments; give a simpler drawing")
        mode, stroke = ctypes.c_int(), ctypes.c_int()
        raw.FPDFPath_GetDrawMode(item, mode, stroke)
        filled = mode.value != raw.FPDF_FILLMODE_NONE
        if not (filled or stroke.value):
            continue
        if filled and not paths and _fill_color(item) == _WHITE:
            ignored["white background"] += 1
            continue
        paint = 'fill="black"' if filled else 'fill="none" stroke="black"'
        rule = "evenodd" if mode.value == raw.FPDF_FILLMODE_ALTERNATE else "nonzero"
        paths.append(f'{_groups(item)}<path {paint} fill-rule="{rule}" d="{_data(item)}"/>' + "</g>" * _depth(item))
    return paths


def _depth(item: Any) -> int:
    """Return how many forms an item is in, counting itself."""
    return 0 if item is None else 1 + _depth(item.container)


def _groups(item: Any) -> str:
    """Return the opening tags of groups that have the transforms of an item and of the forms that it is in."""
    if item is None:
        return ""
    numbers = " ".join(repr(float(number)) for number in item.get_matrix().get())
    return f'{_groups(item.container)}<g transform="matrix({numbers})">'


def _fill_color(item: Any) -> tuple[int, int, int]:
    from pypdfium2 import raw

    red, green, blue, alpha = (ctypes.c_uint() for _ in range(4))
    raw.FPDFPageObj_GetFillColor(item, red, green, blue, alpha)
    return red.value, green.value, blue.value


def _data(item: Any) -> str:
    """Return the path's segments as SVG path data."""
    from pypdfium2 import raw

    x, y = ctypes.c_float(), ctypes.c_float()
    words: list[str] = []
    last, bezier = -1, 0
    for number in range(raw.FPDFPath_CountSegments(item)):
        segment = raw.FPDFPath_GetPathSegment(item, number)
        raw.FPDFPathSegment_GetPoint(segment, x, y)
        kind = raw.FPDFPathSegment_GetType(segment)
        if kind == raw.FPDF_SEGMENT_BEZIERTO:
            letter = "C" if bezier % 3 == 0 else ""
            bezier += 1
        else:
            letter, bezier = ("M" if kind == raw.FPDF_SEGMENT_MOVETO or last < 0 else "L"), 0
        words.append(f"{letter}{x.value!r} {y.value!r}")
        if raw.FPDFPathSegment_GetClose(segment):
            words.append("Z")
        last = kind
    return " ".join(words)
