"""Read SVG: polygon, polyline, rect and straight path elements, in groups, with transforms.

All outlines of the file are loops of one even-odd set. y goes up in a ``Drawing`` and down in SVG: every y
changes its sign. Loops are in the user units of the outermost viewBox; ``unit_mm`` follows from width and
height (a px is 1/96 in, SVG 2 section 8). Nothing outside the file is opened, and a file that declares XML
entities is refused. svgelements interprets path data and transforms; both are checked first, because it skips
what it cannot read.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from svgelements import Close, Matrix, Move
from svgelements import Path as PathData

from foldcut.errors import FileFormatError
from foldcut.model import Floats, points_array
from foldcut.readers.base import Drawing, read_text
from foldcut.units import MM_PER_UNIT

#: An outline whose ends are nearer than this to each other is closed (relative to its size).
CLOSING_GAP = 1e-3

_NAMESPACE = "{http://www.w3.org/2000/svg}"
_GROUPS = {"g", "a", "switch"}
_OUTLINES = {"polygon", "polyline", "rect", "path"}
_UNSEEN = {"title", "desc", "metadata", "style", "script", "view", "defs", "symbol", "clipPath", "mask"}
_REMEDIES = {
    "circle": "draw it as a polygon with straight segments",
    "ellipse": "draw it as a polygon with straight segments",
    "line": "join the lines into one closed path",
    "use": "replace the clone by its shape (Inkscape: Edit > Clone > Unlink)",
    "svg": "move its content into the outer svg element",
}

# Possessive (++, ?+), so that no run of digits is split in more than one way.
_NUMBER = r"[+-]?+(?:[0-9]++\.?+[0-9]*+|\.[0-9]++)(?:[eE][+-]?+[0-9]++)?+"
_NEXT = rf"[\s,]*+{_NUMBER}"
_NUMBERS = re.compile(rf"(?:{_NEXT})*+[\s,]*+")
_STRAIGHT = re.compile(
    rf"(?:\s*+(?=[Mm])(?:[\s,]*+(?:[Zz]|[HhVv](?:{_NEXT})++|[MmLl](?:{_NEXT}{_NEXT})++))++)?+[\s,]*+"
)
_TRANSFORM = re.compile(
    rf"(?:[\s,]*+(?:matrix\s*\((?:{_NEXT}){{6}}|(?:translate|scale)\s*\((?:{_NEXT}){{1,2}}"
    rf"|rotate\s*\((?:{_NEXT})(?:{_NEXT}{_NEXT})?|skew[XY]\s*\({_NEXT})\s*\))*+[\s,]*+"
)
_LENGTH = re.compile(rf"\s*({_NUMBER})\s*(mm|cm|in|px|pt|pc)?\s*")


def read_svg(path: Path) -> Drawing:
    """Return the drawing in an SVG file; its title is that of the file, or else the file's stem."""
    root = _parse(read_text(path))
    unit_mm, stretch = _units(root)
    loops: list[Floats] = []
    ignored: Counter[str] = Counter()
    with np.errstate(all="ignore"):  # make_shape refuses what is not finite, and says where
        for element, matrix, name in _outline_elements(root, ignored):
            for points in _outlines(element, name):
                x, y = matrix[:2, :2] @ np.array(points).reshape(-1, 2).T + matrix[:2, 2:]
                loops.append(points_array(np.column_stack([x, -y * stretch])))
    if not loops:
        raise FileFormatError("the file has no polygon, polyline, rect or path; draw a closed outline")
    notes = tuple(f"ignored: {count} {what}" for what, count in sorted(ignored.items()))
    return Drawing(tuple(loops), unit_mm, _title(root) or path.stem, notes, y_down=True)


def _parse(text: str) -> ET.Element:
    if "<!ENTITY" in text:
        raise FileFormatError("the file declares XML entities; save it as plain SVG without a DOCTYPE")
    try:
        root = ET.fromstring(text)
    except ET.ParseError as error:
        raise FileFormatError(f"not XML: {error}; save the drawing again as plain SVG") from None
    if _tag(root) != "svg":
        raise FileFormatError(f"the outermost element is {root.tag!r}, not svg; give an SVG file")
    return root


def _tag(element: ET.Element) -> str:
    """Return the element's name without SVG's namespace; other namespaces stay in it."""
    return element.tag.removeprefix(_NAMESPACE)


def _title(root: ET.Element) -> str:
    titles = [element.text or "" for element in root if _tag(element) == "title"]
    return " ".join(titles[0].split()) if titles else ""


def _units(root: ET.Element) -> tuple[float | None, float]:
    """Return mm per user unit along x, if the file says, and how much longer a unit along y is."""
    sides = [_side_mm(root, "width"), _side_mm(root, "height")]
    if "viewBox" not in root.attrib:
        return MM_PER_UNIT["px"], 1.0
    box = _numbers(root.attrib["viewBox"], "the viewBox")
    if len(box) != 4 or not min(box[2:]) > 0:
        raise FileFormatError(f"the viewBox is {root.attrib['viewBox']!r}; give min-x min-y width height")
    scales = [side / extent for side, extent in zip(sides, box[2:], strict=True) if side is not None]
    if not scales:
        return None, 1.0
    fitting = root.get("preserveAspectRatio", "")
    if fitting.strip() == "none":
        return scales[0], scales[-1] / scales[0]
    return (max if "slice" in fitting else min)(scales), 1.0


def _side_mm(root: ET.Element, attribute: str) -> float | None:
    text = root.get(attribute, "auto").strip()
    if text == "auto" or text.endswith("%"):
        return None
    side = _user_units(text, f"the {attribute} of the file") * MM_PER_UNIT["px"]
    if not 0 < side < np.inf:
        raise FileFormatError(f"the {attribute} of the file is {text!r}; give a positive length such as 100mm")
    return side


def _outline_elements(root: ET.Element, ignored: Counter[str]) -> Iterator[tuple[ET.Element, Floats, str]]:
    """Yield every visible outline, in drawing order, with its transform, ``(3, 3)``, and its name."""
    seen: Counter[str] = Counter()
    matrix = _transform(root, np.eye(3), "the svg element")
    waiting = [(element, matrix) for element in reversed(root)]
    while waiting:  # a stack, not recursion: files nest as deep as they like
        element, outer = waiting.pop()
        tag = _tag(element)
        if tag in _UNSEEN or tag.startswith("{"):
            continue
        seen[tag] += 1
        name = f'{tag} "{element.attrib["id"]}"' if element.get("id") else f"{tag} number {seen[tag]}"
        if tag in _REMEDIES:
            raise FileFormatError(f"{name} is not an outline of straight segments; {_REMEDIES[tag]}")
        if _hidden(element):
            ignored["hidden element"] += 1
        elif tag in _GROUPS | _OUTLINES:
            ignored.update(attribute for attribute in ("clip-path", "mask") if attribute in element.attrib)
            matrix = _transform(element, outer, name)
            if tag in _OUTLINES:
                yield element, matrix, name
            else:
                waiting += [(child, matrix) for child in reversed(element)]
        else:
            ignored[tag] += 1


def _hidden(element: ET.Element) -> bool:
    style = element.get("style", "").replace(" ", "")
    return (
        element.get("display") == "none"
        or element.get("visibility") in ("hidden", "collapse")
        or "display:none" in style
        or "visibility:hidden" in style
    )


def _transform(element: ET.Element, outer: Floats, name: str) -> Floats:
    text = element.get("transform", "")
    try:
        if not _TRANSFORM.fullmatch(text):
            raise ValueError
        own = Matrix(text)  # a ValueError for an angle beyond float64
    except ValueError:
        raise FileFormatError(
            f"{name} has the transform {text[:40]!r}; correct it, or apply it to the points"
        ) from None
    matrix: Floats = outer @ np.array([(own.a, own.c, own.e), (own.b, own.d, own.f), (0.0, 0.0, 1.0)])
    return matrix


def _outlines(element: ET.Element, name: str) -> Iterator[list[tuple[float, float]]]:
    """Yield the closed outlines of an element, in its own user units."""
    tag = _tag(element)
    if tag == "path":
        yield from _path_outlines(element.get("d", ""), name)
    elif tag == "rect":
        yield _rectangle(element, name)
    else:
        numbers = _numbers(element.get("points", ""), f"points of {name}")
        points = list(zip(numbers[::2], numbers[1::2], strict=False))
        if not points or len(numbers) % 2:
            raise FileFormatError(f"{name} has {len(numbers)} numbers in points; give an x and a y for each point")
        yield points if tag == "polygon" else _closed(points, name)


def _path_outlines(data: str, name: str) -> Iterator[list[tuple[float, float]]]:
    rest = _STRAIGHT.sub("", data, count=1).lstrip()
    if rest[:1] in tuple("CcSsQqTtAa"):
        raise FileFormatError(
            f"{name} has a curve ({rest[:20].rstrip()!r}); flatten it to straight segments "
            "(Inkscape: Extensions > Modify Path > Flatten Beziers)"
        )
    if rest:
        raise FileFormatError(f"{name} has unreadable path data at {rest[:20]!r}; correct it there")
    points: list[tuple[float, float]] = []
    for segment in PathData(data):
        end = (float(segment.end.x), float(segment.end.y))
        if isinstance(segment, Close):
            if len(points) > 1:
                yield points
            points = [end]
        elif isinstance(segment, Move):
            if len(points) > 1:
                yield _closed(points, name)
            points = [end]
        else:
            points.append(end)
    if len(points) > 1:
        yield _closed(points, name)


def _closed(points: list[tuple[float, float]], name: str) -> list[tuple[float, float]]:
    """Return ``points`` without the last one, which must repeat the first."""
    size = float(np.hypot(*np.ptp(points, axis=0)))
    (x, y), (last_x, last_y) = points[0], points[-1]
    gap = float(np.hypot(last_x - x, last_y - y))
    if gap > CLOSING_GAP * size:
        raise FileFormatError(
            f"{name} is open: it starts at ({x:g}, {y:g}) and ends at ({last_x:g}, {last_y:g}), {gap:.3g} "
            "away; close it (Z at the end of a path; polygon instead of polyline)"
        )
    return points[:-1]


def _rectangle(element: ET.Element, name: str) -> list[tuple[float, float]]:
    x, y, width, height, *radii = (
        _user_units(element.get(attribute, "0"), f"{attribute} of {name}")
        for attribute in ("x", "y", "width", "height", "rx", "ry")
    )
    if any(radii):
        raise FileFormatError(f"{name} has round corners; set rx and ry to 0")
    return [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]


def _numbers(text: str, what: str) -> list[float]:
    if not _NUMBERS.fullmatch(text):
        raise FileFormatError(f"{what} has something other than numbers: {text[:40]!r}; correct it")
    return [float(number) for number in re.findall(_NUMBER, text)]


def _user_units(text: str, what: str) -> float:
    match = _LENGTH.fullmatch(text)
    if not match:
        raise FileFormatError(f"{what} is {text!r}; give a number, or one with mm, cm, in, px, pt or pc")
    return float(match[1]) * (MM_PER_UNIT[match[2]] / MM_PER_UNIT["px"] if match[2] else 1.0)
