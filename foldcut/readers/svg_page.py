"""What an SVG file shows: a walk through its elements, with styles, transforms, clones and viewports.

The svg element of a file -> its painted outlines in drawing order (``Page.seen``), as browsers paint them. What is
passed over is counted. Everything that is hidden, has no paint, or has an opacity of 0 is not painted.
"""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from foldcut.core.arrays import Floats
from foldcut.core.errors import FileFormatError
from foldcut.core.units import MM_PER_UNIT
from foldcut.readers.base import ReadOptions
from foldcut.readers.fill_outlines import Paint
from foldcut.readers.svg_paths import NUMBER, Size, flattened, number_list, path_of, tag_of, user_units
from foldcut.readers.svg_style import (
    BLACK,
    GEOMETRY,
    UNREADABLE,
    Cascade,
    Colour,
    Style,
    colour_of,
    inherited,
    share,
)
from foldcut.readers.svg_transforms import PROPERTIES, Box, UnreadableError, about, of_attribute, of_css, origin_of

MOST_ELEMENTS = 100_000
"""A file that shows more elements is refused; clones count as often as they are shown."""

SEEN = 1 / 510
"""What is less opaque than this is not seen: it does not change a colour of 8 bits."""

NOTHING_PAINTED = "nothing in the file has a fill or a stroke, so all of its outlines were read"
"""The note on a file that shows nothing."""

_XLINK_HREF = "{http://www.w3.org/1999/xlink}href"
_LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
_GROUPS = {"g", "a", "switch", "svg", "symbol", "use"}
_OUTLINES = {"polygon", "polyline", "rect", "path", "circle", "ellipse", "line"}
_UNSEEN = {"title", "desc", "metadata", "style", "view", "defs", "clipPath", "mask", "marker", "filter", "pattern"} | {
    "linearGradient", "radialGradient"
}  # fmt: skip
_GRADIENTS = ("linearGradient", "radialGradient")
_URL = re.compile(r"url\(\s*+[\"']?+\s*+#?+([^)\"'\s]*+)\s*+[\"']?+\s*+\)\s*+(.*)", re.DOTALL | re.IGNORECASE)
_PATH_VALUE = re.compile(r"path\(\s*(?:(?:evenodd|nonzero)\s*,\s*)?([\"'])(.*)\1\s*\)", re.DOTALL)


def too_many(options: ReadOptions) -> FileFormatError:
    """Return the error for a drawing with too many points."""
    most = f"{options.limits.points:,} points"
    return FileFormatError(f"the drawing has more than {most}; give a simpler one, or a larger --flatten")


Clip = tuple["Element", ...]
"""The elements that a clip path has; what one of them fills can be seen."""


@dataclass(frozen=True)
class Element:
    """A painted element: its path in its own user units, its transform, ``(3, 3)``, and how it is painted.

    ``filled`` and ``stroked``: whether it has such a paint that can be seen. ``paint``, ``stroke_paint``: of both.
    ``stroke_width`` is in units of the drawing, ``own_width`` in those of the element, or, if it is ``fixed``, of the
    screen. ``clips``: what it is clipped by, all of them together.
    """

    path: list[Any]
    matrix: Floats
    filled: bool
    stroked: bool
    even_odd: bool
    name: str
    paint: Paint
    stroke_paint: Paint = Paint.DARK
    own_width: float = 1.0
    style: Style = field(default_factory=dict)
    clips: tuple[Clip, ...] = ()

    @property
    def white(self) -> bool:
        """Whether nothing but white is painted."""
        return self.paint is Paint.WHITE

    @property
    def fixed(self) -> bool:
        """Whether the width of the stroke does not grow with the element."""
        return self.style.get("vector-effect", "") == "non-scaling-stroke"

    @property
    def stroke_width(self) -> float:
        """The mean width of the stroke in units of the drawing."""
        scale = 1.0 if self.fixed else math.sqrt(abs(float(np.linalg.det(self.matrix[:2, :2]))))
        return self.own_width * scale

    def points(self, tolerance: float) -> Floats:
        """Return all points, ``(2, n)``."""
        return np.concatenate([points for points, _, _ in self._lines(tolerance)] or [np.empty((2, 0))], axis=1)

    def lines(self, tolerance: float) -> Iterator[tuple[Floats, bool, list[Any]]]:
        """Yield the visible lines, ``(2, n)``, whether each is closed, and its segments in the element's own units."""
        for points, closed, drawn in self._lines(tolerance):
            if closed or self.stroked or not self.filled or points.shape[1] > 2:
                yield points, closed, drawn

    def _lines(self, tolerance: float) -> Iterator[tuple[Floats, bool, list[Any]]]:
        scale = float(np.linalg.norm(self.matrix[:2, :2], 2)) if np.isfinite(self.matrix).all() else 1.0
        for points, closed, drawn in flattened(self.path, tolerance / scale if scale else math.inf):
            yield self.matrix[:2, :2] @ np.array(points).reshape(-1, 2).T + self.matrix[:2, 2:], closed, drawn


@dataclass(frozen=True)
class _Visit:
    """An element while the tree is walked, with what its ancestors say of it.

    ``layer`` and ``chosen``: it is in one of the requested layers and ids. ``clones``: the references that led here.
    ``viewport``: the size that percentages refer to, in user units. ``given``: the width and height of its clone.
    ``opacity``: of all elements around it together. ``clips``: their clip paths.
    """

    element: ET.Element
    matrix: Floats
    style: Style
    layer: bool
    chosen: bool
    clones: frozenset[str]
    depth: int
    viewport: Size
    given: tuple[str | None, str | None] | None = None
    opacity: float = 1.0
    clips: tuple[Clip, ...] = ()


class Page:
    """Walks the tree of a file, and counts what is passed over."""

    def __init__(self, root: ET.Element, options: ReadOptions) -> None:
        self.root, self.options = root, options
        self.ignored: Counter[str] = Counter()
        self.notes: tuple[str, ...] = ()
        self.named: set[str] = set()
        self.labels: set[str] = set()
        self.numbers = 0
        self.cascade = Cascade(root, self.ignored)
        self.boxes: dict[ET.Element, Box] = {}
        self.clips: dict[tuple[ET.Element, bytes], Clip] = {}

    @cached_property
    def by_id(self) -> dict[str, ET.Element]:
        """The elements that a clone can refer to."""
        return {element.attrib["id"]: element for element in reversed(list(self.root.iter())) if element.get("id")}

    def nothing(self) -> str:
        """Return the error message for a file in which no outline is found."""
        for option, names, there in (
            ("--id", self.options.ids, self.named),
            ("--layer", self.options.layers, self.labels),
        ):
            if names:
                known = ", ".join(sorted(there)[:20]) or "none"
                return f"no outline is in {option} {', '.join(names)}; the file has {known}"
        if self.ignored["hidden element"]:
            return "all outlines of the file are hidden or have an opacity of 0; show one in the drawing program"
        texts = ", and make texts into paths, or draw a text with --text" if self.ignored["text"] else ""
        return f"the file has no polygon, polyline, rect or path; draw a closed outline{texts}"

    def seen(self) -> list[Element]:
        """Return the painted outlines, or all if none is painted, without a white background behind all others."""
        every = list(self.outlines())
        seen = [one for one in every if one.filled or one.stroked]
        if every and not seen:
            self.notes += (NOTHING_PAINTED,)
            seen = every
        self.ignored["outline without fill and stroke"] += len(every) - len(seen)
        while len(seen) > 1 and seen[0].white:
            (low, high), *others = [_box(one) for one in seen]
            if not all((low <= one).all() and (high >= other).all() for one, other in others):
                break
            self.ignored["white background"] += 1
            seen = seen[1:]
        return seen

    def outlines(self) -> Iterator[Element]:
        """Yield every outline that is displayed, painted or not, in drawing order."""
        style = self.cascade.style(self.root, {})
        root = _Visit(
            self.root, np.eye(3), {}, not self.options.layers, not self.options.ids, frozenset(), 0,
            _root_viewport(self.root),
        )  # fmt: skip
        root = replace(root, opacity=share(style.get("opacity", "1")))
        if style.get("display", "") == "none":
            self.ignored["hidden element"] += 1
            return iter(())
        root = replace(root, matrix=self._matrix(root, style, "the svg element"))
        return self._walk(self._children(root, root.matrix, style, root.viewport))

    def _walk(self, waiting: list[_Visit], *, counts: bool = True) -> Iterator[Element]:
        """Yield the outlines in elements and in those that they show; the last is visited first."""
        count: Counter[str] = Counter()
        while waiting:  # a stack, not recursion: files may nest deeper than Python recurses
            seen = waiting.pop()
            self.options.limits.check_nesting(seen.depth)
            element, tag = seen.element, tag_of(seen.element)
            if tag in _UNSEEN or tag.startswith("{") or (tag == "symbol" and seen.given is None):
                continue
            count[tag] += 1
            if count.total() > MOST_ELEMENTS:
                raise FileFormatError(f"more than {MOST_ELEMENTS:,} elements are shown; give a simpler drawing")
            name = f'{tag} "{element.attrib["id"]}"' if element.get("id") else f"{tag} number {count[tag]}"
            style = self.cascade.style(element, seen.style)
            opacity = seen.opacity * share(style.get("opacity", "1"))
            if style.get("display", "").lower() == "none" or opacity < SEEN:
                self.ignored["hidden element"] += counts
            elif tag not in _GROUPS | _OUTLINES:
                self.ignored[tag] += counts and self._is_visible(style)
            elif not _holds(element):
                continue
            else:
                seen = self._choose(replace(seen, opacity=opacity))
                if counts:
                    self.ignored.update(key for key in ("mask", "filter") if style.get(key, "none") != "none")
                matrix = self._matrix(seen, style, name)
                if style.get("clip-path", "none") != "none" and counts:
                    seen = self._clipped(seen, style, matrix)
                if tag == "use":
                    waiting += self._clone(seen, matrix, style, name)
                elif tag in _GROUPS:
                    viewport = seen.viewport
                    if tag in ("svg", "symbol"):
                        placed = matrix
                        matrix, viewport, size = _viewport(seen, matrix, name)
                        if size is not None and style.get("overflow", "hidden") in ("hidden", "clip", "scroll"):
                            seen = replace(seen, clips=(*seen.clips, _window(placed, _place(seen, name), size)))
                    waiting += self._children(seen, matrix, style, viewport)
                elif not self._is_visible(style):
                    self.ignored["hidden element"] += counts
                elif seen.layer and seen.chosen and (found := self._outline(seen, matrix, style, name)):
                    dashed = found.stroked and style.get("stroke-dasharray", "none") != "none"
                    self.ignored["stroke-dasharray"] += counts and dashed
                    yield found

    def _is_visible(self, style: Style) -> bool:
        return style.get("visibility", "visible").lower() == "visible"

    def _children(self, seen: _Visit, matrix: Floats, style: Style, viewport: Size) -> list[_Visit]:
        """Return visits of the children of an element, the first child last; of a switch, of the one that is shown."""
        inner = replace(seen, matrix=matrix, style=style, depth=seen.depth + 1, viewport=viewport, given=None)
        children = list(seen.element)
        if tag_of(seen.element) == "switch":
            children = [child for child in children if not tag_of(child).startswith("{") and _holds(child)][:1]
        return [replace(inner, element=child) for child in reversed(children)]

    def _outline(self, seen: _Visit, matrix: Floats, style: Style, name: str) -> Element | None:
        """Return the outline of an element, painted or not; None where SVG draws nothing."""
        element, tag = self._with_geometry(seen.element, style), tag_of(seen.element)
        drawn = element.get("points", element.get("d", ""))
        self.numbers += len(re.findall(NUMBER, drawn)) + len(re.findall("[Zz]", drawn))
        if self.numbers > 4 * self.options.limits.points:
            raise too_many(self.options)
        path = path_of(element, name, seen.viewport)
        if not path:
            return None
        fill = None if tag == "line" else self._colour("fill", "black", style, seen.opacity)
        width = self._stroke_width(style, seen.viewport, name)
        stroke = self._colour("stroke", "black" if tag == "line" else "none", style, seen.opacity)
        stroke = stroke if width > 0 else None
        white = fill is not None and fill.is_white
        hidden = stroke is None or stroke.is_white
        paint = Paint.DARK if not white else Paint.WHITE if hidden else Paint.WHITE_WITH_STROKE
        stroke_paint = Paint.WHITE if stroke is not None and stroke.is_white else Paint.DARK
        even_odd = style.get("fill-rule", "").lower() == "evenodd" or fill is None
        return Element(
            path, matrix, fill is not None, stroke is not None, even_odd, name, paint, stroke_paint, width, style,
            seen.clips,
        )  # fmt: skip

    def _clipped(self, seen: _Visit, style: Style, matrix: Floats) -> _Visit:
        """Return a visit with the clip path of the element; one that is not a path in the file is counted."""
        match = _URL.fullmatch(style["clip-path"])
        element = self.by_id.get(match[1]) if match else None
        if element is None or tag_of(element) != "clipPath":
            self.ignored["clip-path"] += 1
            return seen
        own = matrix
        if element.get("clipPathUnits", "") == "objectBoundingBox":
            left, top, width, height = self._box_of(seen, style)
            own = matrix @ np.array([(width, 0.0, left), (0.0, height, top), (0.0, 0.0, 1.0)])
        key = element, own.tobytes()
        if key not in self.clips:
            self.clips[key] = ()  # for a clip path that clips itself
            said = self.cascade.style(element, {})
            inner = replace(
                seen,
                element=element,
                matrix=own,
                style={},
                layer=True,
                chosen=True,
                opacity=1.0,
                clips=(),
                clones=frozenset(),
            )
            inner = replace(inner, matrix=self._matrix(inner, said, "a clipPath"))
            found = self._walk(self._children(inner, inner.matrix, said, seen.viewport), counts=False)
            self.clips[key] = tuple(
                replace(one, filled=True, stroked=False, even_odd=one.style.get("clip-rule", "").lower() == "evenodd")
                for one in found
            )
        return replace(seen, clips=(*seen.clips, self.clips[key]))

    def _with_geometry(self, element: ET.Element, style: Style) -> ET.Element:
        """Return an element with the coordinates that CSS gives it as attributes."""
        said = {name: style[name] for name in GEOMETRY if name in style}
        if match := _PATH_VALUE.fullmatch(style.get("d", "")):
            said["d"] = match[2]
        return ET.Element(element.tag, {**element.attrib, **said}) if said else element

    def _stroke_width(self, style: Style, viewport: Size, name: str) -> float:
        whole = None if viewport is None else math.hypot(*viewport) / math.sqrt(2)
        try:
            return user_units(style.get("stroke-width", "1"), f"stroke-width of {name}", whole)
        except FileFormatError:  # too large a number, or a percentage of nothing
            self.ignored[UNREADABLE] += 1
            return 1.0

    def _colour(self, kind: str, default: str, style: Style, opacity: float) -> Colour | None:
        """Return the colour of a fill or stroke with its opacity, or None if it cannot be seen."""
        colour = self._paint(style.get(kind, default), style)
        if colour is None:
            return None
        alpha = colour.alpha * share(style.get(f"{kind}-opacity", "1")) * opacity
        return None if alpha < SEEN else colour._replace(alpha=alpha)

    def _paint(self, text: str, style: Style) -> Colour | None:
        """Return the colour of a paint, or None if there is none; of a pattern or gradient, one that stands for it."""
        lower = text.lower()
        if lower == "none":
            return None
        if match := _URL.fullmatch(text):
            server = self.by_id.get(match[1])
            if server is not None and tag_of(server) in _GRADIENTS:
                return self._gradient(server)
            if server is not None and tag_of(server) == "pattern":
                return BLACK
            return self._paint(match[2], style) if match[2] else None
        if lower == "currentcolor":
            colour = style.get("color", "black")
            return BLACK if colour.lower() == "currentcolor" else colour_of(colour) or BLACK
        return colour_of(text) or BLACK

    def _gradient(self, gradient: ET.Element) -> Colour | None:
        """Return white if all of a gradient is white, None if nothing of it can be seen, and black otherwise."""
        for _ in range(20):
            stops = [child for child in gradient if tag_of(child) == "stop"]
            reference = gradient.get("href", gradient.get(_XLINK_HREF, ""))
            if stops or reference[1:] not in self.by_id:
                break
            gradient = self.by_id[reference[1:]]
        colours = []
        for stop in stops[:1000]:
            style = self.cascade.style(stop, {})
            colour = self._paint(style.get("stop-color", "black"), style) or BLACK
            colours.append(colour._replace(alpha=colour.alpha * share(style.get("stop-opacity", "1"))))
        if all(colour.alpha < SEEN for colour in colours):
            return None
        return colours[0] if all(colour.is_white for colour in colours) else BLACK

    def _matrix(self, seen: _Visit, style: Style, name: str) -> Floats:
        """Return the transform of an element, ``(3, 3)``, after that of those around it."""
        own = of_attribute(seen.element.get("transform", ""), name)
        if not any(key in style for key in (*PROPERTIES, "transform-origin")):
            matrix: Floats = seen.matrix @ own
            return matrix
        try:
            box = self._reference_box(seen, style)
            given = of_css(style, box)
            if given is not None:
                own = given if "transform" in style else given @ own
            text = style.get("transform-origin", "0 0")
            unitless = seen.element.get("transform-origin", "").strip() == text
            matrix = seen.matrix @ about(own, origin_of(text, box, unitless=unitless))
        except UnreadableError:
            self.ignored[UNREADABLE] += 1
            matrix = seen.matrix @ own
        return matrix

    def _reference_box(self, seen: _Visit, style: Style) -> Box:
        """Return what percentages in transforms refer to (CSS Transforms 1, section 3)."""
        if style.get("transform-box", "view-box") in ("fill-box", "content-box", "stroke-box", "border-box"):
            return self._box_of(seen, style)
        width, height = seen.viewport or (math.nan, math.nan)
        return 0.0, 0.0, width, height

    def _box_of(self, seen: _Visit, style: Style) -> Box:
        """Return the box around an element and all in it, in its own units."""
        if seen.element in self.boxes:
            return self.boxes[seen.element]
        self.boxes[seen.element] = (0.0, 0.0, 0.0, 0.0)  # for an element that is in itself
        inner = replace(seen, matrix=np.eye(3), style=inherited(style), layer=True, chosen=True)
        if tag_of(seen.element) in _OUTLINES:
            outline = self._outline(inner, np.eye(3), style, "an outline")
            found = [] if outline is None else [outline]
        elif tag_of(seen.element) == "use":
            found = list(self._walk(self._clone(inner, np.eye(3), style, "a clone"), counts=False))
        else:
            found = list(self._walk(self._children(inner, np.eye(3), style, seen.viewport), counts=False))
        points = np.concatenate([one.points(0.01) for one in found] or [np.empty((2, 0))], axis=1)
        if points.size:
            low, size = points.min(axis=1).tolist(), np.ptp(points, axis=1).tolist()
            self.boxes[seen.element] = (*low, *size)
        return self.boxes[seen.element]

    def _choose(self, seen: _Visit) -> _Visit:
        """Return the visit, with whether the element is in one of the requested layers and ids."""
        own_id, label = seen.element.get("id"), seen.element.get(_LABEL)
        if own_id:
            self.named.add(own_id)
        if tag_of(seen.element) == "g" and (label or own_id):
            self.labels.add(label or own_id or "")
        layer = seen.layer or (tag_of(seen.element) == "g" and bool({own_id, label} & set(self.options.layers)))
        chosen = seen.chosen or own_id in self.options.ids
        return replace(seen, layer=layer, chosen=chosen)

    def _clone(self, seen: _Visit, matrix: Floats, style: Style, name: str) -> list[_Visit]:
        """Return a visit of the element that a use element shows; none if it is not in this file."""
        href = seen.element.get("href", seen.element.get(_XLINK_HREF, ""))
        if not href.startswith("#"):
            self.ignored["external reference"] += 1
            return []
        if href in seen.clones:
            raise FileFormatError(f"{name} shows {href}, which it is part of; remove the clone")
        if href[1:] not in self.by_id:
            raise FileFormatError(f"{name} shows {href!r}, which is not in the file; correct its href")
        x, y = _place(seen, name)
        moved: Floats = matrix @ np.array([(1.0, 0.0, x), (0.0, 1.0, y), (0.0, 0.0, 1.0)])
        given = (seen.element.get("width"), seen.element.get("height"))
        shown, clones = self.by_id[href[1:]], seen.clones | {href}
        return [
            replace(seen, element=shown, matrix=moved, style=style, clones=clones, depth=seen.depth + 1, given=given)
        ]


def _box(element: Element) -> tuple[Floats, Floats]:
    """Return the corners of the rough box around an outline; that of an empty one lies within every other."""
    points = element.points(math.inf)
    return points.min(axis=1, initial=math.inf), points.max(axis=1, initial=-math.inf)


def _window(matrix: Floats, place: list[float], size: tuple[float, float]) -> Clip:
    """Return the clip path of a nested svg or a symbol: what lies outside of it cannot be seen."""
    (x, y), (width, height) = place, size
    corners = ((x, y), (x + width, y), (x + width, y + height), (x, y + height))
    points = " ".join(f"{left!r},{top!r}" for left, top in corners)
    path = path_of(ET.Element("polygon", {"points": points}), "a viewport", None)
    return (Element(path, matrix, True, False, True, "a viewport", Paint.DARK),)


def _holds(element: ET.Element) -> bool:
    """Whether an element is shown at all to a browser that knows no extensions and prefers English."""
    languages = element.get("systemLanguage")
    if languages is not None and not any(one.strip().lower().split("-")[0] == "en" for one in languages.split(",")):
        return False
    return not element.get("requiredExtensions", "").strip()


def _root_viewport(root: ET.Element) -> Size:
    """Return the size of the outermost svg element in user units, or None if the file does not say."""
    if "viewBox" in root.attrib:
        _, _, width, height = view_box(root, "the viewBox")
        return width, height
    width_mm, height_mm = side_mm(root, "width"), side_mm(root, "height")
    if width_mm is None or height_mm is None:
        return None
    return width_mm / MM_PER_UNIT["px"], height_mm / MM_PER_UNIT["px"]


def _place(seen: _Visit, name: str) -> list[float]:
    """Return x and y of an element."""
    sizes = zip(("x", "y"), seen.viewport or (None, None), strict=True)
    return [user_units(seen.element.get(side, "0"), f"{side} of {name}", whole) for side, whole in sizes]


def _viewport(seen: _Visit, matrix: Floats, name: str) -> tuple[Floats, Size, Size]:
    """Return the transform and the viewport inside a nested svg or a symbol, and its size.

    Its viewBox is fitted into its size, which may be unknown.
    """
    element = seen.element
    x, y = _place(seen, name)
    placed: Floats = matrix @ np.array([(1.0, 0.0, x), (0.0, 1.0, y), (0.0, 0.0, 1.0)])
    box = view_box(element, f"the viewBox of {name}") if "viewBox" in element.attrib else None
    texts = [
        given or element.attrib.get(side, "auto")
        for given, side in zip(seen.given or (None, None), ("width", "height"), strict=True)
    ]
    texts = ["100%" if text == "auto" else text for text in texts]
    if seen.viewport is None and any(text.endswith("%") for text in texts):
        size: Size = (box[2], box[3]) if box else None  # the file does not say: as large as its content
    else:
        wholes = seen.viewport or (None, None)
        width, height = (user_units(text, f"size of {name}", whole) for text, whole in zip(texts, wholes, strict=True))
        size = width, height
    if box is None or size is None:
        return placed, size, size
    across, up = size[0] / box[2], size[1] / box[3]
    fitting = element.get("preserveAspectRatio", "")
    if fitting.strip() != "none":
        across = up = (max if "slice" in fitting else min)(across, up)
    share = {"Min": 0.0, "Mid": 0.5, "Max": 1.0}
    aligned = re.match(r"\s*x(Min|Mid|Max)Y(Min|Mid|Max)", fitting)
    x_share, y_share = (share[word] for word in (aligned.groups() if aligned else ("Mid", "Mid")))
    left = (size[0] - box[2] * across) * x_share - box[0] * across
    top = (size[1] - box[3] * up) * y_share - box[1] * up
    fitted: Floats = placed @ np.array([(across, 0.0, left), (0.0, up, top), (0.0, 0.0, 1.0)])
    return fitted, (box[2], box[3]), size


def view_box(element: ET.Element, what: str) -> list[float]:
    """Return the four numbers of the viewBox of an element; ``what`` it is, for errors."""
    box = number_list(element.attrib["viewBox"], what)
    if len(box) != 4 or not min(box[2:]) > 0:
        raise FileFormatError(f"{what} is {element.attrib['viewBox']!r}; give min-x min-y width height")
    return box


def side_mm(root: ET.Element, attribute: str) -> float | None:
    """Return the width or height of the file in mm, or None if it does not say."""
    text = root.get(attribute, "auto").strip()
    if text == "auto" or text.endswith("%"):
        return None
    side = user_units(text, f"the {attribute} of the file") * MM_PER_UNIT["px"]
    if not 0 < side < math.inf:
        raise FileFormatError(f"the {attribute} of the file is {text!r}; give a positive length such as 100mm")
    return side
