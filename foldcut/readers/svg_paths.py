"""The outlines of single SVG elements: path data, basic shapes, lengths, and the points along curves.

An element and its viewport -> segments of svgelements -> points in user units. svgelements interprets path data. It
skips what it cannot read, so the data is checked first. (SVG 2, chapters 8 to 10.)
"""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np
from svgelements import Arc, Close, CubicBezier, Line, Move, QuadraticBezier
from svgelements import Path as PathData

from foldcut.core.arrays import Floats
from foldcut.core.errors import FileFormatError
from foldcut.core.units import MM_PER_UNIT
from foldcut.geometry import curves

MOST_STEPS = 1000
"""The greatest number of straight segments that replace a curve."""

NAMESPACE = "{http://www.w3.org/2000/svg}"
"""SVG's namespace, as ElementTree writes it before names."""

Point = tuple[float, float]

Size = tuple[float, float] | None
"""Width and height of a viewport in user units; None if the file does not say."""

_WHOLE: dict[str, Callable[[float, float], float]] = {
    **dict.fromkeys(("x", "cx", "x1", "x2", "width", "rx"), lambda width, _: width),
    **dict.fromkeys(("y", "cy", "y1", "y2", "height", "ry"), lambda _, height: height),
    "r": lambda width, height: math.hypot(width, height) / math.sqrt(2),
}
"""The length that a percentage refers to, from the width and height of the viewport (SVG 2, section 8.9)."""

# Possessive quantifiers (++, ?+), so that a run of digits is never split in more than one way.
NUMBER = r"[+-]?+(?:[0-9]++\.?+[0-9]*+|\.[0-9]++)(?:[eE][+-]?+[0-9]++)?+"
NEXT = rf"[\s,]*+{NUMBER}"
_NUMBERS = re.compile(rf"(?:{NEXT})*+[\s,]*+")
_ARC = rf"{NEXT}{NEXT}{NEXT}[\s,]*+[01][\s,]*+[01]{NEXT}{NEXT}"
_PATH = re.compile(
    rf"(?:\s*+(?=[Mm])(?:[\s,]*+(?:[Zz]|[HhVv](?:{NEXT})++|[MmLlTt](?:{NEXT}{NEXT})++"
    rf"|[QqSs](?:(?:{NEXT}){{4}})++|[Cc](?:(?:{NEXT}){{6}})++|[Aa](?:{_ARC})++))++)?+[\s,]*+"
)
_LENGTH = re.compile(rf"\s*+({NUMBER})\s*+(mm|cm|in|px|pt|pc|%)?+\s*+")


def tag_of(element: ET.Element) -> str:
    """Return the name of an element without SVG's namespace; other namespaces stay in it."""
    return element.tag.removeprefix(NAMESPACE)


def path_of(element: ET.Element, name: str, viewport: Size) -> list[Any]:
    """Return the outline of an element as segments of svgelements; there are none where SVG draws nothing."""
    tag = tag_of(element)
    if tag == "path":
        data = element.get("d", "")
        if rest := _PATH.sub("", data, count=1).lstrip():
            raise FileFormatError(f"{name} has unreadable path data at {rest[:20]!r}; correct it there")
        return _segments(data, name)
    if tag in ("polygon", "polyline"):
        numbers = number_list(element.get("points", ""), f"points of {name}")
        if not numbers or len(numbers) % 2:
            raise FileFormatError(f"{name} has {len(numbers)} numbers in points; give an x and a y for each point")
        points = list(zip(numbers[::2], numbers[1::2], strict=True))
        lines = [Move(end=points[0]), *(Line(one, other) for one, other in pairwise(points))]
        return [*lines, Close(points[-1], points[0])] if tag == "polygon" else lines

    def length(attribute: str) -> float:
        text = element.get(attribute, "0").strip()
        whole = None if viewport is None else _WHOLE[attribute](*viewport)
        return user_units("0" if text == "auto" else text, f"{attribute} of {name}", whole)

    if tag == "line":
        return _segments(f"M{length('x1')!r} {length('y1')!r}L{length('x2')!r} {length('y2')!r}", name)
    rx, ry = (length("r"),) * 2 if tag == "circle" else (length("rx"), length("ry"))
    if element.get("rx", "auto") == "auto":
        rx = ry
    if element.get("ry", "auto") == "auto" and tag != "circle":
        ry = rx
    if tag == "rect":
        x, y, width, height = map(length, ("x", "y", "width", "height"))
        rx, ry = min(rx, width / 2), min(ry, height / 2)
    else:
        x, y, width, height = length("cx") - rx, length("cy") - ry, 2 * rx, 2 * ry
    if not (width > 0 and height > 0):
        return []
    right, bottom = x + width, y + height
    if not (rx > 0 and ry > 0):
        return _segments(f"M{x!r} {y!r}H{right!r}V{bottom!r}H{x!r}Z", name)
    arc = f"A{rx!r} {ry!r} 0 0 1"
    return _segments(
        f"M{x + rx!r} {y!r}H{right - rx!r}{arc} {right!r} {y + ry!r}V{bottom - ry!r}{arc} {right - rx!r} {bottom!r}"
        f"H{x + rx!r}{arc} {x!r} {bottom - ry!r}V{y + ry!r}{arc} {x + rx!r} {y!r}Z",
        name,
    )


def _segments(data: str, name: str) -> list[Any]:
    try:
        # After each Z, move to where it ends anyway: svgelements looks back for the last move at each Z.
        segments = list(PathData(re.sub("[Zz]", "Zm0 0", data)))
        if any(None in (segment.end.x, segment.end.y) for segment in segments):  # of an arc that is too large
            raise ValueError
        return segments
    except (ValueError, ArithmeticError, AttributeError, TypeError):  # an arc with senseless numbers
        raise FileFormatError(f"{name} has path data that cannot be drawn; correct its numbers") from None


def flattened(path: list[Any], tolerance: float) -> Iterator[tuple[list[Point], bool, list[Any]]]:
    """Yield the points of each subpath, whether it is closed, and its segments between the first and the last point.

    A closed one may repeat its first point; if it does not, the line that closes it is none of its segments.
    """
    points: list[Point] = []
    drawn: list[Any] = []
    for segment in path:
        end = float(segment.end.x), float(segment.end.y)
        if isinstance(segment, Close):
            if len(points) > 1:
                yield points, True, drawn
            points, drawn = [end], []
        elif isinstance(segment, Move):
            if len(points) > 1:
                yield points, False, drawn
            points, drawn = [end], []
        elif not points or end != points[-1] or isinstance(segment, CubicBezier | QuadraticBezier):
            points += _inner(segment, tolerance)
            points.append(end)
            drawn.append(segment)
    if len(points) > 1:
        yield points, False, drawn


def curved(drawn: list[Any], matrix: Floats) -> tuple[curves.Segment, ...]:
    """Return segments of svgelements after a transform, ``(2, 3)``; nothing if all of them are straight."""
    if all(isinstance(segment, Line) for segment in drawn):
        return ()
    return tuple(_segment(segment).transformed(matrix) for segment in drawn)


def _segment(segment: Any) -> curves.Segment:
    start, end = np.array(segment.start, dtype=np.float64), np.array(segment.end, dtype=np.float64)
    if isinstance(segment, CubicBezier | QuadraticBezier):
        return curves.Bezier(np.array([(node.x, node.y) for node in segment], dtype=np.float64))
    if not isinstance(segment, Arc) or not segment.sweep or not min(segment.rx, segment.ry) > 0:
        return curves.Line(start, end)
    centre, sweep = np.array(segment.center, dtype=np.float64), float(segment.sweep)
    first = start - centre
    share = min(1.0, math.pi / 2 / abs(sweep))  # the place of the other half diameter, or the end
    place = np.array(segment.point(share), dtype=np.float64) - centre
    second = (place - math.cos(sweep * share) * first) / math.sin(sweep * share)
    return curves.Arc(centre, first, second, sweep)


def _inner(segment: Any, tolerance: float) -> list[Point]:
    """Return points between the ends of a curve, so that the straight lines through all are within ``tolerance``."""
    if isinstance(segment, Arc):
        radius = max(float(segment.rx), float(segment.ry))
        step = 2 * math.acos(max(1 - tolerance / radius, 0.0)) if radius > 0 else math.inf
        count = abs(float(segment.sweep)) / min(step, math.pi / 2) if step > 0 else math.inf
    elif isinstance(segment, CubicBezier | QuadraticBezier):
        nodes = [complex(*node) for node in segment]
        bends = [abs(a - 2 * b + c) for a, b, c in zip(nodes, nodes[1:], nodes[2:], strict=False)]
        degree = len(nodes) - 1
        count = math.sqrt(degree * (degree - 1) * max(bends) / (8 * tolerance)) if tolerance > 0 else math.inf
        count = max(count, 2.0)
    else:
        return []
    steps = math.ceil(round(min(count, MOST_STEPS), 6)) if count == count else 1
    places = (segment.point(step / steps) for step in range(1, steps))
    return [(float(place.x), float(place.y)) for place in places]


def number_list(text: str, what: str) -> list[float]:
    """Return the numbers in a text; raises ``FileFormatError`` if there is anything else in it."""
    if not _NUMBERS.fullmatch(text):
        raise FileFormatError(f"{what} has something other than numbers: {text[:40]!r}; correct it")
    return [float(number) for number in re.findall(NUMBER, text)]


def user_units(text: str, what: str, whole: float | None = None) -> float:
    """Return a length in user units; ``whole`` is the length that percentages refer to."""
    match = _LENGTH.fullmatch(text)
    if not match:
        raise FileFormatError(f"{what} is {text!r}; give a number, or one with mm, cm, in, px, pt, pc or %")
    number, unit = float(match[1]), match[2]
    if not math.isfinite(number):
        raise FileFormatError(f"{what} is {text!r}; give a finite number")
    if unit != "%":
        return number * (MM_PER_UNIT[unit] / MM_PER_UNIT["px"] if unit else 1.0)
    if whole is None:
        raise FileFormatError(f"{what} is {text!r} of a size that the file does not give; add a viewBox")
    return number / 100 * whole
