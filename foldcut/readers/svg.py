"""Read SVG: every shape, in groups, with transforms, clones and fill rules.

What one element fills by its own fill rule is an even-odd set of loops; sets that overlap are united, and an outline
wholly within another is its hole (as for cutters, whatever the colours). An element that is stroked only counts as the
outline it draws; open lines are joined end to end. Curves become segments within the tolerance.
y goes up in a ``Drawing`` and down in SVG: every y changes its sign. Loops are in the user units of the outermost
viewBox; ``unit_mm`` follows from width and height (a px is 1/96 in, SVG 2 section 8). Nothing outside the file is
opened, and a file that declares XML entities is refused. svgelements interprets path data and transforms; both are
checked first, because it skips what it cannot read.
"""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from defusedxml import DefusedXmlException
from defusedxml.ElementTree import fromstring
from svgelements import Arc, Close, CubicBezier, Line, Matrix, Move, QuadraticBezier
from svgelements import Path as PathData

from foldcut.errors import FileFormatError
from foldcut.model import Floats, points_array
from foldcut.readers.base import Drawing, ReadOptions, Source, counted
from foldcut.readers.fills import fill, join, unite
from foldcut.units import MM_PER_UNIT

#: An outline whose ends are nearer than this to each other is closed (relative to its size).
CLOSING_GAP = 1e-3

#: A file that shows more elements, clones counted as often as they are shown, is refused.
MOST_ELEMENTS = 200_000

#: A curve has no more segments than this.
MOST_STEPS = 1000

Point = tuple[float, float]

_NAMESPACE = "{http://www.w3.org/2000/svg}"
_XLINK_HREF = "{http://www.w3.org/1999/xlink}href"
_LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
_GROUPS = {"g", "a", "switch", "svg", "symbol", "use"}
_OUTLINES = {"polygon", "polyline", "rect", "path", "circle", "ellipse", "line"}
_UNSEEN = {"title", "desc", "metadata", "style", "view", "defs", "clipPath", "mask"}
_STYLES = ("display", "visibility", "fill", "fill-rule", "stroke")

# Possessive (++, ?+), so that no run of digits is split in more than one way.
_NUMBER = r"[+-]?+(?:[0-9]++\.?+[0-9]*+|\.[0-9]++)(?:[eE][+-]?+[0-9]++)?+"
_NEXT = rf"[\s,]*+{_NUMBER}"
_NUMBERS = re.compile(rf"(?:{_NEXT})*+[\s,]*+")
_ARC = rf"{_NEXT}{_NEXT}{_NEXT}[\s,]*+[01][\s,]*+[01]{_NEXT}{_NEXT}"
_PATH = re.compile(
    rf"(?:\s*+(?=[Mm])(?:[\s,]*+(?:[Zz]|[HhVv](?:{_NEXT})++|[MmLlTt](?:{_NEXT}{_NEXT})++"
    rf"|[QqSs](?:(?:{_NEXT}){{4}})++|[Cc](?:(?:{_NEXT}){{6}})++|[Aa](?:{_ARC})++))++)?+[\s,]*+"
)
_TRANSFORM = re.compile(
    rf"(?:[\s,]*+(?:matrix\s*\((?:{_NEXT}){{6}}|(?:translate|scale)\s*\((?:{_NEXT}){{1,2}}"
    rf"|rotate\s*\((?:{_NEXT})(?:{_NEXT}{_NEXT})?|skew[XY]\s*\({_NEXT})\s*\))*+[\s,]*+"
)
_LENGTH = re.compile(rf"\s*({_NUMBER})\s*(mm|cm|in|px|pt|pc)?\s*")
_RULE = re.compile(r"([^{}]*+)\{([^{}]*+)\}")


def read(source: Source, options: ReadOptions) -> Drawing:
    """Return the drawing in an SVG file; its title is that of the file, or else the file's stem."""
    root = _parse(source.text())
    unit_mm, stretch = _units(root)
    page = _Page(root, options)
    flip = np.diag([1.0, -stretch])
    with np.errstate(all="ignore"):  # make_shape refuses what is not finite, and says where
        shown = list(page.outlines())
        if not shown:
            raise FileFormatError(page.nothing())
        rough = np.concatenate([flip @ one.points(math.inf) for one in shown], axis=1)
        rough = rough[:, np.isfinite(rough).all(axis=0)]
        extent = float(np.ptp(rough, axis=1).max()) if rough.size else 0.0
        tolerance = options.units(options.flatten_mm, unit_mm, extent)
        parts: list[list[Floats]] = []
        chains: list[Floats] = []
        count = 0
        for one in shown:
            closed: list[Floats] = []
            for points, is_closed in one.lines(tolerance):
                (closed if is_closed else chains).append(points_array((flip @ points).T))
                count += points.shape[1]
                if count > options.limits.points:
                    raise _too_many(options)
            if closed:
                parts.append(fill(closed, even_odd=one.even_odd))
        loops, united = unite(parts)
        loops += join(chains, options.units(options.join_mm, unit_mm, extent))
    if not loops:
        raise FileFormatError("the outlines of the file enclose no area; draw at least one closed outline")
    notes = [f"{united} outlines that overlap or touch were united"] if united else []
    title = _title(root) or source.name
    return Drawing(tuple(loops), unit_mm, title, tuple(notes), y_down=True, ignored=counted(page.ignored))


def _too_many(options: ReadOptions) -> FileFormatError:
    most = f"{options.limits.points:,} points"
    return FileFormatError(f"the drawing has more than {most}; give a simpler one, or a larger --flatten")


def _parse(text: str) -> ET.Element:
    try:
        root: ET.Element = fromstring(text)
    except ET.ParseError as error:
        raise FileFormatError(f"not XML: {error}; save the drawing again as plain SVG") from None
    except DefusedXmlException:
        raise FileFormatError("the file declares XML entities; save it as plain SVG without a DOCTYPE") from None
    except ValueError as error:  # an encoding that Python does not know
        raise FileFormatError(f"not XML: {error}; save the file as UTF-8 text") from None
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
    box = _view_box(root, "the viewBox")
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


@dataclass(frozen=True)
class _Outline:
    """An element that is seen: its path in own user units, its transform, ``(3, 3)``, and its fill."""

    path: list[Any]
    matrix: Floats
    filled: bool
    stroked: bool
    even_odd: bool
    name: str

    def points(self, tolerance: float) -> Floats:
        """Return all points, ``(2, n)``."""
        return np.concatenate([points for points, _ in self._lines(tolerance)] or [np.empty((2, 0))], axis=1)

    def lines(self, tolerance: float) -> Iterator[tuple[Floats, bool]]:
        """Yield the lines, ``(2, n)``, and whether each is closed; filled ones all are."""
        for points, closed in self._lines(tolerance):
            size = float(np.hypot(*np.ptp(points, axis=1)))
            gap = float(np.hypot(*(points[:, -1] - points[:, 0])))
            near = gap <= CLOSING_GAP * size
            if not closed and near and points.shape[1] > 2:
                yield points[:, :-1], True
            elif closed or (self.filled and points.shape[1] > 2):
                yield points, True
            elif self.stroked and not near:
                yield points, False

    def _lines(self, tolerance: float) -> Iterator[tuple[Floats, bool]]:
        scale = float(np.linalg.norm(self.matrix[:2, :2], 2)) if np.isfinite(self.matrix).all() else 1.0
        for points, closed in _path_lines(self.path, tolerance / scale if scale else math.inf):
            yield self.matrix[:2, :2] @ np.array(points).reshape(-1, 2).T + self.matrix[:2, 2:], closed


@dataclass(frozen=True)
class _Seen:
    """An element on its way to be drawn."""

    element: ET.Element
    matrix: Floats
    style: dict[str, str]
    layer: bool
    chosen: bool
    clones: frozenset[str]
    width: str | None = None
    height: str | None = None


class _Page:
    """The tree of a file being walked, and what of it is passed over."""

    def __init__(self, root: ET.Element, options: ReadOptions) -> None:
        self.root, self.options = root, options
        self.ignored: Counter[str] = Counter()
        self.named: set[str] = set()
        self.labels: set[str] = set()
        self.numbers = 0

    @cached_property
    def by_id(self) -> dict[str, ET.Element]:
        """The elements that a clone can name."""
        return {element.attrib["id"]: element for element in reversed(list(self.root.iter())) if element.get("id")}

    @cached_property
    def rules(self) -> list[tuple[str, dict[str, str]]]:
        """The simple selectors (element, .class, #id) of the file's style sheets, and what they say."""
        sheets = " ".join(element.text or "" for element in self.root.iter() if _tag(element) == "style")
        sheets = re.sub(r"/\*.*?(?:\*/|\Z)", "", sheets, flags=re.DOTALL)
        pairs = ((names, _declarations(body)) for names, body in _RULE.findall(sheets))
        return [(name.strip(), said) for names, said in pairs for name in names.split(",")]

    def nothing(self) -> str:
        """Say why there is no outline."""
        for option, names, there in (
            ("--id", self.options.ids, self.named),
            ("--layer", self.options.layers, self.labels),
        ):
            if names:
                known = ", ".join(sorted(there)[:20]) or "none"
                return f"no outline is in {option} {', '.join(names)}; the file has {known}"
        return "the file has no polygon, polyline, rect or path; draw a closed outline"

    def outlines(self) -> Iterator[_Outline]:
        """Yield every visible outline, in drawing order."""
        count: Counter[str] = Counter()
        every = _Seen(self.root, np.eye(3), {}, not self.options.layers, not self.options.ids, frozenset())
        style, matrix = self._style(self.root, {}), _transform(self.root, np.eye(3), "the svg element")
        waiting = [_child(every, child, matrix, style) for child in reversed(self.root)]
        while waiting:  # a stack, not recursion: files nest as deep as they like
            seen = waiting.pop()
            element, tag = seen.element, _tag(seen.element)
            if tag in _UNSEEN or tag.startswith("{") or (tag == "symbol" and seen.width is None):
                continue
            count[tag] += 1
            if count.total() > MOST_ELEMENTS:
                raise FileFormatError(f"more than {MOST_ELEMENTS:,} elements are shown; give a simpler drawing")
            name = f'{tag} "{element.attrib["id"]}"' if element.get("id") else f"{tag} number {count[tag]}"
            style = self._style(element, seen.style)
            if style.get("display") == "none" or style.get("visibility") in ("hidden", "collapse"):
                self.ignored["hidden element"] += 1
            elif tag not in _GROUPS | _OUTLINES:
                self.ignored[tag] += 1
            else:
                seen = self._choose(seen)
                self.ignored.update(attribute for attribute in ("clip-path", "mask") if attribute in element.attrib)
                matrix = _transform(element, seen.matrix, name)
                if tag == "use":
                    waiting += self._clone(seen, matrix, style, name)
                elif tag in _GROUPS:
                    if tag in ("svg", "symbol"):
                        matrix = _viewport(seen, matrix, name)
                    waiting += [_child(seen, child, matrix, style) for child in reversed(element)]
                elif seen.layer and seen.chosen:
                    filled = tag != "line" and style.get("fill") not in ("none", "transparent")
                    even_odd = style.get("fill-rule") == "evenodd" or not filled
                    drawn = element.get("points", element.get("d", ""))
                    self.numbers += len(re.findall(_NUMBER, drawn)) + len(re.findall("[Zz]", drawn))
                    if self.numbers > 4 * self.options.limits.points:
                        raise _too_many(self.options)
                    if path := _path(element, name):
                        stroked = tag == "line" or not filled or style.get("stroke", "none") != "none"
                        yield _Outline(path, matrix, filled, stroked, even_odd, name)

    def _style(self, element: ET.Element, outer: dict[str, str]) -> dict[str, str]:
        """Return what applies to an element of the properties that matter; display is not inherited."""
        style = {name: value for name, value in outer.items() if name != "display"}
        style |= {name: element.attrib[name].strip() for name in _STYLES if name in element.attrib}
        if self.rules:
            selectors = {_tag(element), f"#{element.get('id')}", *(f".{c}" for c in element.get("class", "").split())}
            for selector, said in self.rules:
                if selector in selectors or selector == "*":
                    style |= said
        return style | _declarations(element.get("style", ""))

    def _choose(self, seen: _Seen) -> _Seen:
        """Return an element with whether it is in one of the layers and ids that are asked for."""
        own_id, label = seen.element.get("id"), seen.element.get(_LABEL)
        if own_id:
            self.named.add(own_id)
        if _tag(seen.element) == "g" and (label or own_id):
            self.labels.add(label or own_id or "")
        layer = seen.layer or (_tag(seen.element) == "g" and bool({own_id, label} & set(self.options.layers)))
        chosen = seen.chosen or own_id in self.options.ids
        return _Seen(seen.element, seen.matrix, seen.style, layer, chosen, seen.clones, seen.width, seen.height)

    def _clone(self, seen: _Seen, matrix: Floats, style: dict[str, str], name: str) -> list[_Seen]:
        """Return what a use element shows: an element of the same file, or nothing."""
        href = seen.element.get("href", seen.element.get(_XLINK_HREF, ""))
        if not href.startswith("#"):
            self.ignored["external reference"] += 1
            return []
        if href in seen.clones:
            raise FileFormatError(f"{name} shows {href}, which it is part of; remove the clone")
        if href[1:] not in self.by_id:
            raise FileFormatError(f"{name} shows {href!r}, which is not in the file; correct its href")
        x, y = (_user_units(seen.element.get(side, "0"), f"{side} of {name}") for side in ("x", "y"))
        moved: Floats = matrix @ np.array([(1.0, 0.0, x), (0.0, 1.0, y), (0.0, 0.0, 1.0)])
        size = (seen.element.get("width", "100%"), seen.element.get("height", "100%"))
        return [_Seen(self.by_id[href[1:]], moved, style, seen.layer, seen.chosen, seen.clones | {href}, *size)]


def _child(seen: _Seen, child: ET.Element, matrix: Floats, style: dict[str, str]) -> _Seen:
    return _Seen(child, matrix, style, seen.layer, seen.chosen, seen.clones)


def _declarations(text: str) -> dict[str, str]:
    """Return what a style says of the properties that matter."""
    pairs = (part.partition(":") for part in text.split(";"))
    said = {name.strip(): value.replace("!important", "").strip() for name, _, value in pairs}
    return {name: said[name] for name in _STYLES if name in said}


def _viewport(seen: _Seen, matrix: Floats, name: str) -> Floats:
    """Return the transform inside a nested svg or a symbol: its place, and its viewBox fitted into its size."""
    element = seen.element
    x, y = (_user_units(element.get(side, "0"), f"{side} of {name}") for side in ("x", "y"))
    placed: Floats = matrix @ np.array([(1.0, 0.0, x), (0.0, 1.0, y), (0.0, 0.0, 1.0)])
    if "viewBox" not in element.attrib:
        return placed
    left, top, *box = _view_box(element, f"the viewBox of {name}")
    given = (
        seen.width if seen.width not in (None, "100%") else element.get("width", "100%"),
        seen.height if seen.height not in (None, "100%") else element.get("height", "100%"),
    )
    if any(text is None or text.endswith("%") for text in given):
        size = box  # as large as its content: the file does not say in user units
    else:
        size = [_user_units(text or "", f"size of {name}") for text in given]
    across, up = (side / extent for side, extent in zip(size, box, strict=True))
    fitting = element.get("preserveAspectRatio", "")
    if fitting.strip() != "none":
        across = up = (max if "slice" in fitting else min)(across, up)
    place = fitting if re.match(r"\s*x(Min|Mid|Max)Y(Min|Mid|Max)", fitting) else "xMidYMid"
    share = {"Min": 0.0, "Mid": 0.5, "Max": 1.0}
    free = [size[0] - box[0] * across, size[1] - box[1] * up]
    if fitting.strip() == "none":
        free = [0.0, 0.0]
    x_share, y_share = (share[word] for word in re.findall("Min|Mid|Max", place)[:2])
    inner = np.array(
        [
            (across, 0.0, free[0] * x_share - left * across),
            (0.0, up, free[1] * y_share - top * up),
            (0.0, 0.0, 1.0),
        ]
    )
    fitted: Floats = placed @ inner
    return fitted


def _view_box(element: ET.Element, what: str) -> list[float]:
    box = _numbers(element.attrib["viewBox"], what)
    if len(box) != 4 or not min(box[2:]) > 0:
        raise FileFormatError(f"{what} is {element.attrib['viewBox']!r}; give min-x min-y width height")
    return box


def _path(element: ET.Element, name: str) -> list[Any]:
    """Return the element's outline as svgelements' segments; none where SVG draws nothing."""
    tag = _tag(element)
    if tag == "path":
        data = element.get("d", "")
        if rest := _PATH.sub("", data, count=1).lstrip():
            raise FileFormatError(f"{name} has unreadable path data at {rest[:20]!r}; correct it there")
        return _segments(data, name)
    if tag in ("polygon", "polyline"):
        numbers = _numbers(element.get("points", ""), f"points of {name}")
        if not numbers or len(numbers) % 2:
            raise FileFormatError(f"{name} has {len(numbers)} numbers in points; give an x and a y for each point")
        points = list(zip(numbers[::2], numbers[1::2], strict=True))
        lines = [Move(end=points[0]), *(Line(one, other) for one, other in pairwise(points))]
        return [*lines, Close(points[-1], points[0])] if tag == "polygon" else lines

    def length(attribute: str) -> float:
        text = element.get(attribute, "0").strip()
        return _user_units("0" if text == "auto" else text, f"{attribute} of {name}")

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
        # A move to where a Z ends anyway: svgelements looks for the last move again at each Z.
        return list(PathData(re.sub("[Zz]", "Zm0 0", data)))
    except (ValueError, ArithmeticError, AttributeError, TypeError):  # an arc of senseless numbers
        raise FileFormatError(f"{name} has path data that cannot be drawn; correct its numbers") from None


def _path_lines(path: list[Any], tolerance: float) -> Iterator[tuple[list[Point], bool]]:
    """Yield the subpaths as points, and whether each is closed; a closed one does not repeat its first point."""
    points: list[Point] = []
    for segment in path:
        end = float(segment.end.x), float(segment.end.y)
        if isinstance(segment, Close):
            if len(points) > 1:
                yield points[:-1] if points[-1] == points[0] and len(points) > 3 else points, True
            points = [end]
        elif isinstance(segment, Move):
            if len(points) > 1:
                yield points, False
            points = [end]
        elif not points or end != points[-1] or isinstance(segment, CubicBezier | QuadraticBezier):
            points += _inner(segment, tolerance)
            points.append(end)
    if len(points) > 1:
        yield points, False


def _inner(segment: Any, tolerance: float) -> list[Point]:
    """Return the points between the ends of a segment whose joins are within ``tolerance`` of it."""
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


def _numbers(text: str, what: str) -> list[float]:
    if not _NUMBERS.fullmatch(text):
        raise FileFormatError(f"{what} has something other than numbers: {text[:40]!r}; correct it")
    return [float(number) for number in re.findall(_NUMBER, text)]


def _user_units(text: str, what: str) -> float:
    match = _LENGTH.fullmatch(text)
    if not match:
        raise FileFormatError(f"{what} is {text!r}; give a number, or one with mm, cm, in, px, pt or pc")
    number = float(match[1])
    if not math.isfinite(number):
        raise FileFormatError(f"{what} is {text!r}; give a finite number")
    return number * (MM_PER_UNIT[match[2]] / MM_PER_UNIT["px"] if match[2] else 1.0)
