"""Read the first page of a PDF with PDFium (extra ``pdf``): its filled and stroked paths.

The paths become an SVG, with their colours, strokes and clips, which the SVG reader flattens, clips and unites. White
fills before anything else are taken for the background of the page and passed over, as are texts and pictures, and what
is in layers that are off. The unit is the point, or what the page says a unit is (``UserUnit``).
"""

from __future__ import annotations

import ctypes
import hashlib
import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from foldcut.core.errors import FileFormatError
from foldcut.drawing.limits import DEEPEST, Limits
from foldcut.readers import svg
from foldcut.readers.base import Drawing, ReadOptions, Source, counted, missing
from foldcut.readers.svg_text import root_of

MOST_SEGMENTS = 1_000_000
"""A page with more segments of paths is refused."""

_WHITE = (255, 255, 255)


_NEEDS_PIKEPDF = (b"/UserUnit", b"/OCProperties", b"/ObjStm")
"""What PDFium does not tell is in a file that has one of these; the last one has objects that are compressed."""

_CAPS = ("butt", "round", "square")
_JOINS = ("miter", "round", "bevel")


def read(source: Source, options: ReadOptions) -> Drawing:
    """Return the drawing on the first page of a PDF file; its title is the name of the file."""
    try:
        import pypdfium2
    except ImportError:
        raise missing("PDF files", "pdf") from None
    ignored: Counter[str] = Counter()
    try:
        data, unit = _shown(source.data, ignored)
        with pypdfium2.PdfDocument(data) as document:
            pages = len(document)
            page = document[0]
            paths = _Paths(options.limits, ignored)
            paths.add(page)
            left, bottom, right, top = page.get_cropbox()
    except FileFormatError:
        raise
    except Exception as error:  # a PdfiumError, or one of ctypes where the file is broken
        about = " ".join(str(error).split())[:120].rstrip(".") or type(error).__name__
        raise FileFormatError(f"not a PDF file that can be read: {about}; export the drawing again") from None
    if not paths.found:
        there = ", ".join(counted(ignored)) or "nothing"
        raise FileFormatError(f"the first page has no vector path, only {there}; export the drawing as vectors")
    if pages > 1:
        ignored["further page"] += pages - 1
    width, height = right - left, top - bottom
    text = (
        f'<svg width="{width * unit!r}pt" height="{height * unit!r}pt" '
        f'viewBox="{left!r} {-top!r} {width!r} {height!r}">'
        f"{''.join(paths.clips.values())}"
        f'<clipPath id="page"><path d="M{left!r} {bottom!r}H{right!r}V{top!r}H{left!r}Z"/></clipPath>'
        f'<g transform="scale(1 -1)"><g clip-path="url(#page)">{"".join(paths.found)}</g></g></svg>'
    )
    roomy = replace(options, limits=replace(options.limits, nesting=DEEPEST))  # clips are nested, too
    drawing = svg.drawing_of(root_of(text, options.limits), source.name, roomy, y_down=False)
    return replace(drawing, ignored=(*counted(ignored), *drawing.ignored))


def _shown(data: bytes, ignored: Counter[str]) -> tuple[bytes, float]:
    """Return a PDF without what is in layers that are off, and the points to a unit of its first page.

    Raises ``FileFormatError`` if forms are drawn so often that the page would take all memory.
    """
    has_layers = any(word in data for word in _NEEDS_PIKEPDF)
    if not has_layers and b"/Form" not in data:
        return data, 1.0
    import pikepdf

    from foldcut.readers.pdf_layers import require_few_forms, shown_page

    try:
        require_few_forms(data)
        if not has_layers:
            return data, 1.0
        shown = shown_page(data)
    except FileFormatError:
        raise
    except (pikepdf.PdfError, ValueError, TypeError, KeyError, AttributeError, RuntimeError, IndexError):
        ignored["unreadable list of layers"] += has_layers  # PDFium mends more than pikepdf does
        return data, 1.0
    ignored["object in a hidden layer"] += shown.taken_out
    unit = shown.user_unit
    return shown.data, unit if math.isfinite(unit) and unit > 0 else 1.0


class _Paths:
    """Collects the paths of a page as SVG elements, y up, and the clip paths that they are in."""

    def __init__(self, limits: Limits, ignored: Counter[str]) -> None:
        self.limits, self.ignored = limits, ignored
        self.found: list[str] = []
        self.clips: dict[str, str] = {}
        self.segments = 0

    def add(self, page: Any) -> None:
        """Add the paths of a page."""
        from pypdfium2 import raw

        names = {raw.FPDF_PAGEOBJ_TEXT: "text", raw.FPDF_PAGEOBJ_IMAGE: "image", raw.FPDF_PAGEOBJ_SHADING: "shading"}
        for item in page.get_objects(max_depth=self.limits.nesting + 2):
            self.limits.check_nesting(_depth(item) - 1)
            if item.type == raw.FPDF_PAGEOBJ_PATH:
                self._count(raw.FPDFPath_CountSegments(item))
                self._add_path(item)
            elif item.type in names:
                self.ignored[names[item.type]] += 1

    def _count(self, segments: int) -> None:
        self.segments += max(segments, 0)
        if self.segments > MOST_SEGMENTS:
            raise FileFormatError(f"the page has more than {MOST_SEGMENTS:,} segments; give a simpler drawing")

    def _add_path(self, item: Any) -> None:
        from pypdfium2 import raw

        mode, stroke = ctypes.c_int(), ctypes.c_int()
        raw.FPDFPath_GetDrawMode(item, mode, stroke)
        fill = _colour(raw.FPDFPageObj_GetFillColor, item) if mode.value != raw.FPDF_FILLMODE_NONE else None
        line = _colour(raw.FPDFPageObj_GetStrokeColor, item) if stroke.value else None
        if (fill is None or fill[3] == 0) and (line is None or line[3] == 0):
            self.ignored["path that is not painted"] += fill is not None or line is not None
            return
        if fill is not None and fill[:3] == _WHITE and line is None and not self.found:
            self.ignored["white background"] += 1
            return
        rule = "evenodd" if mode.value == raw.FPDF_FILLMODE_ALTERNATE else "nonzero"
        paint = f'{_paint("fill", fill)} {_paint("stroke", line)} fill-rule="{rule}"'
        if line is not None:
            paint += _line(item)
        clips = [*self._clips(item)]
        groups = "".join(f'<g clip-path="url(#{name})">' for name in clips)
        whole = f'<path transform="{_transform(item)}" {paint} d="{_data(item)}"/>'
        self.found.append(f"{groups}{whole}{'</g>' * len(clips)}")

    def _clips(self, item: Any) -> Iterator[str]:
        """Yield the names of the clip paths of an item and of the forms around it.

        PDFium does not tell by which rule they are filled.
        """
        from pypdfium2 import raw

        if item is None:
            return
        yield from self._clips(item.container)
        place = _transform(item.container)

        clip = raw.FPDFPageObj_GetClipPath(item)
        for number in range(max(raw.FPDFClipPath_CountPaths(clip), 0)):
            count = raw.FPDFClipPath_CountPathSegments(clip, number)
            self._count(count)
            data = _path_data(raw.FPDFClipPath_GetPathSegment(clip, number, at) for at in range(max(count, 0)))
            name = f"clip{hashlib.sha256(f'{place} {data}'.encode()).hexdigest()}"
            self.clips[name] = f'<clipPath id="{name}"><path transform="{place}" d="{data}"/></clipPath>'
            yield name


def _depth(item: Any) -> int:
    """Return how many forms an item is in, counting itself."""
    return 0 if item is None else 1 + _depth(item.container)


def _transform(item: Any) -> str:
    """Return the transform of an item and of the forms that it is in, as SVG has it."""
    whole = np.eye(3)
    while item is not None:
        a, b, c, d, e, f = map(float, item.get_matrix().get())
        whole = np.array([(a, c, e), (b, d, f), (0.0, 0.0, 1.0)]) @ whole
        item = item.container
    return f"matrix({' '.join(map(repr, whole[:2].T.ravel().tolist()))})"


def _colour(call: Any, item: Any) -> tuple[int, int, int, int]:
    """Return red, green, blue and alpha, up to 255, of an item; black where PDFium does not know."""
    values = [ctypes.c_uint() for _ in range(4)]
    if not call(item, *values):
        return 0, 0, 0, 255
    red, green, blue, alpha = (value.value for value in values)
    return red, green, blue, alpha


def _paint(kind: str, colour: tuple[int, int, int, int] | None) -> str:
    """Return the attributes of SVG for a colour."""
    if colour is None:
        return f'{kind}="none"'
    red, green, blue, alpha = colour
    return f'{kind}="#{red:02x}{green:02x}{blue:02x}" {kind}-opacity="{alpha / 255:.4f}"'


def _line(item: Any) -> str:
    """Return the attributes of SVG for the stroke of an item; one of no width is as thin as a device draws it."""
    from pypdfium2 import raw

    width = ctypes.c_float()
    raw.FPDFPageObj_GetStrokeWidth(item, width)
    cap, join = raw.FPDFPageObj_GetLineCap(item), raw.FPDFPageObj_GetLineJoin(item)
    return (
        f' stroke-width="{max(width.value, 0.01)!r}" stroke-linecap="{_CAPS[cap if 0 <= cap < 3 else 0]}"'
        f' stroke-linejoin="{_JOINS[join if 0 <= join < 3 else 0]}" stroke-miterlimit="10"'
    )


def _data(item: Any) -> str:
    """Return the path's segments as SVG path data."""
    from pypdfium2 import raw

    count = raw.FPDFPath_CountSegments(item)
    return _path_data(raw.FPDFPath_GetPathSegment(item, number) for number in range(count))


def _path_data(segments: Iterator[Any]) -> str:
    """Return segments of PDFium as SVG path data."""
    from pypdfium2 import raw

    x, y = ctypes.c_float(), ctypes.c_float()
    words: list[str] = []
    last, bezier = -1, 0
    for segment in segments:
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
