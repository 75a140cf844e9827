"""Read SVG: all shapes, in groups, with transforms, clones, styles and fill rules.

What one element fills by its own fill rule becomes an even-odd set of loops. Sets that overlap are united, or cut out
where white is painted over others; an outline wholly within another is its hole, whatever the colours, since cutters
see it so. An element that is only stroked counts as the outline that it draws; open lines are joined end to end. With
the option ``strokes``, what counts is the area that strokes cover. Curves become segments within the tolerance.

The y axis points up in a ``Drawing`` and down in SVG, so every y changes its sign. Loops are in the user units of the
outermost viewBox; ``unit_mm`` follows from width and height (a px is 1/96 in, SVG 2, section 8).

Nothing outside the file is opened. ``readers.svg_text`` parses the file, ``readers.svg_page`` finds what is painted.
"""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from collections import Counter
from dataclasses import replace

import numpy as np

from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import FileFormatError
from foldcut.core.units import MM_PER_UNIT
from foldcut.readers.base import Drawing, ReadOptions, Source, counted
from foldcut.readers.clips import Clips
from foldcut.readers.join_outlines import Outline, loops_of
from foldcut.readers.strokes import WIDE_STROKE, with_strokes
from foldcut.readers.svg_page import Element, Page, side_mm, too_many, view_box
from foldcut.readers.svg_paths import curved, tag_of
from foldcut.readers.svg_style import Style
from foldcut.readers.svg_text import root_of, text_of

TEXTS = "texts are left out: make them into paths in the drawing program, or draw a text with --text"
"""The note on texts in a drawing."""

CUT_STROKES = "cut out the strokes as they are drawn with --strokes outline"
"""What may be done with strokes that are no outline."""


def read(source: Source, options: ReadOptions) -> Drawing:
    """Return the drawing in an SVG file; its title is the one in the file, or else the name of the file."""
    text = text_of(source.data)
    options.limits.check_numbers(text.encode())
    root = root_of(text, options.limits)
    if tag_of(root) != "svg":
        raise FileFormatError(f"the outermost element is {root.tag!r}, not svg; give an SVG file")
    drawing = drawing_of(root, source.name, options)
    outside = len(re.findall(r"<\?xml-stylesheet\s", text))
    return replace(drawing, ignored=(*drawing.ignored, *counted(Counter({"external style sheet": outside}))))


def drawing_of(root: ET.Element, name: str, options: ReadOptions, *, y_down: bool = True) -> Drawing:
    """Return the drawing of an svg element, whose title is its own or else ``name``.

    ``y_down``: that is how coordinates are told; else the y of the ``Drawing`` is that of the file that the element was
    made of.
    """
    unit_mm, stretch = _units(root)
    page = Page(root, options)
    flip = np.diag([1.0, -stretch])
    with np.errstate(all="ignore"):  # make_shape refuses numbers that are not finite, and says where
        shown = page.seen()
        if not shown:
            raise FileFormatError(page.nothing())
        rough = np.concatenate([flip @ one.points(math.inf) for one in shown], axis=1)
        rough = rough[:, np.isfinite(rough).all(axis=0)]
        extent = float(np.ptp(rough, axis=1).max()) if rough.size else 0.0
        tolerance = options.units(options.flatten_mm, unit_mm, extent)
        outlines: list[Outline] = []
        clips = Clips(flip, tolerance)
        count = 0
        for one in shown:
            lines, curves = [], []
            for points, closed, segments in one.lines(tolerance):
                lines.append((points_array((flip @ points).T), closed))
                curves.append(curved(segments, flip @ one.matrix[:2]))
                count += points.shape[1]
            if count > options.limits.points:
                raise too_many(options)
            filled = one.filled and not (options.open_lines and one.stroked)  # a stroke does not close its path
            outline = Outline(lines, filled, one.even_odd, curves, one.name, one.paint)
            drawn = [outline]
            if options.strokes == "outline" and one.stroked:
                drawn = with_strokes(outline, one, flip, tolerance, unit_mm)
            outlines += filter(None, (clips.seen(part, one) for part in drawn))
        page.ignored["clip-path"] += clips.whole
        told = _told_of_strokes(shown, options, extent, unit_mm)
        try:
            found = loops_of(outlines, options, unit_mm, extent, own_y=-1 / stretch if y_down else 1.0)
        except FileFormatError as error:
            raise FileFormatError("; or ".join([str(error), *(CUT_STROKES for _ in told)])) from None
    notes = (*page.notes, *clips.notes(), *found.notes, *told)
    if page.ignored["text"]:
        notes += (TEXTS,)
    ignored = counted(page.ignored)
    title = _title(root) or name
    return found.drawing(unit_mm, title, notes, ignored, y_down=y_down)


def _told_of_strokes(
    shown: list[Element], options: ReadOptions, extent: float, unit_mm: float | None
) -> tuple[str, ...]:
    """Return the note on strokes whose width can be seen and was not read."""
    widths = [one.stroke_width for one in shown if one.stroked and not one.filled]
    widest = max(widths, default=0.0)
    if options.strokes == "outline" or not widest > WIDE_STROKE * extent:
        return ()
    width = f"{widest:.3g}" if unit_mm is None else f"{widest * unit_mm:.3g} mm"
    return (f"strokes of up to {width} were read as lines without width; {CUT_STROKES}",)


def _title(root: ET.Element) -> str:
    titles = [element.text or "" for element in root if tag_of(element) == "title"]
    return " ".join(titles[0].split()) if titles else ""


def lines_of_svg(root: ET.Element, options: ReadOptions) -> tuple[list[tuple[Floats, Style]], float | None]:
    """Return the strokes that an SVG shows, ``(n, 2)`` points each with its style, y up, and the mm of their unit.

    A closed one repeats its first point. Curves are divided as finely as ``options`` say.
    """
    unit_mm, stretch = _units(root)
    flip = np.diag([1.0, -stretch])
    found = []
    with np.errstate(all="ignore"):  # whoever takes them refuses numbers that are not finite
        shown = [one for one in Page(root, options).seen() if one.stroked]
        rough = np.concatenate([np.zeros((2, 1)), *(flip @ one.points(math.inf) for one in shown)], axis=1)
        extent = float(np.ptp(rough, axis=1).max())
        for one in shown:
            for points, closed, _ in one.lines(options.units(options.flatten_mm, unit_mm, extent)):
                line = (flip @ points).T
                found.append((np.concatenate([line, line[:1]]) if closed else line, one.style))
    return found, unit_mm


def _units(root: ET.Element) -> tuple[float | None, float]:
    """Return mm per user unit along x, if the file says, and the ratio of a unit along y to one along x."""
    sides = [side_mm(root, "width"), side_mm(root, "height")]
    if "viewBox" not in root.attrib:
        return MM_PER_UNIT["px"], 1.0
    box = view_box(root, "the viewBox")
    scales = [side / extent for side, extent in zip(sides, box[2:], strict=True) if side is not None]
    if not scales:
        return None, 1.0
    fitting = root.get("preserveAspectRatio", "")
    if fitting.strip() == "none":
        return scales[0], scales[-1] / scales[0]
    return (max if "slice" in fitting else min)(scales), 1.0
