"""Read SVG: all shapes, in groups, with transforms, clones and fill rules.

What one element fills by its own fill rule becomes an even-odd set of loops. Sets that overlap are united, and an
outline wholly within another is its hole, whatever the colours, since cutters see it so. An element that is only
stroked counts as the outline that it draws; open lines are joined end to end. Curves become segments within the
tolerance.

The y axis points up in a ``Drawing`` and down in SVG, so every y changes its sign. Loops are in the user units of the
outermost viewBox; ``unit_mm`` follows from width and height (a px is 1/96 in, SVG 2, section 8).

Nothing outside the file is opened, and a file that declares XML entities is refused. svgelements interprets transforms.
It skips what it cannot read, so transforms are checked first. ``readers.svg_paths`` reads the single elements.
"""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from defusedxml import DefusedXmlException
from defusedxml.ElementTree import fromstring
from svgelements import Matrix

from foldcut.core.arrays import Floats, points_array
from foldcut.core.errors import FileFormatError
from foldcut.core.units import MM_PER_UNIT
from foldcut.readers.base import Drawing, ReadOptions, Source, counted
from foldcut.readers.join_outlines import Outline, loops_of
from foldcut.readers.svg_paths import NEXT, NUMBER, Size, curved, flattened, number_list, path_of, tag_of, user_units

MOST_ELEMENTS = 200_000
"""A file that shows more elements is refused; clones count as often as they are shown."""

_XLINK_HREF = "{http://www.w3.org/1999/xlink}href"
_LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
_GROUPS = {"g", "a", "switch", "svg", "symbol", "use"}
_OUTLINES = {"polygon", "polyline", "rect", "path", "circle", "ellipse", "line"}
_UNSEEN = {"title", "desc", "metadata", "style", "view", "defs", "clipPath", "mask"}
_NO_PAINT = ("none", "transparent")
_WHITE = ("white", "#fff", "#ffffff", "rgb(255,255,255)")
_STYLES = ("display", "visibility", "fill", "fill-rule", "stroke")

_TRANSFORM = re.compile(
    rf"(?:[\s,]*+(?:matrix\s*\((?:{NEXT}){{6}}|(?:translate|scale)\s*\((?:{NEXT}){{1,2}}"
    rf"|rotate\s*\((?:{NEXT})(?:{NEXT}{NEXT})?|skew[XY]\s*\({NEXT})\s*\))*+[\s,]*+"
)
_RULE = re.compile(r"([^{}]*+)\{([^{}]*+)\}")


def read(source: Source, options: ReadOptions) -> Drawing:
    """Return the drawing in an SVG file; its title is the one in the file, or else the name of the file."""
    root = _parse(source.text())
    unit_mm, stretch = _units(root)
    page = _Page(root, options)
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
        count = 0
        for one in shown:
            lines, curves = [], []
            for points, closed, drawn in one.lines(tolerance):
                lines.append((points_array((flip @ points).T), closed))
                curves.append(curved(drawn, flip @ one.matrix[:2]))
                count += points.shape[1]
            if count > options.limits.points:
                raise _too_many(options)
            outlines.append(Outline(lines, one.filled, one.even_odd, curves))
        found = loops_of(outlines, options, unit_mm, extent)
    title = _title(root) or source.name
    ignored = counted(page.ignored)
    return Drawing(found.loops, unit_mm, title, found.notes, True, ignored, found.repairs, found.curves)


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
    except ValueError as error:  # for an encoding that Python does not know
        raise FileFormatError(f"not XML: {error}; save the file as UTF-8 text") from None
    if tag_of(root) != "svg":
        raise FileFormatError(f"the outermost element is {root.tag!r}, not svg; give an SVG file")
    return root


def _title(root: ET.Element) -> str:
    titles = [element.text or "" for element in root if tag_of(element) == "title"]
    return " ".join(titles[0].split()) if titles else ""


def _units(root: ET.Element) -> tuple[float | None, float]:
    """Return mm per user unit along x, if the file says, and the ratio of a unit along y to one along x."""
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
    """Return the width or height of the file in mm, or None if it does not say."""
    text = root.get(attribute, "auto").strip()
    if text == "auto" or text.endswith("%"):
        return None
    side = user_units(text, f"the {attribute} of the file") * MM_PER_UNIT["px"]
    if not 0 < side < np.inf:
        raise FileFormatError(f"the {attribute} of the file is {text!r}; give a positive length such as 100mm")
    return side


def _transform(element: ET.Element, outer: Floats, name: str) -> Floats:
    """Return the transform of an element, ``(3, 3)``, after the ``outer`` one; ``name`` is for errors."""
    text = element.get("transform", "")
    unreadable = FileFormatError(f"{name} has the transform {text[:40]!r}; correct it, or apply it to the points")
    if not _TRANSFORM.fullmatch(text):
        raise unreadable
    try:
        own = Matrix(text)
    except ValueError:  # for an angle beyond float64
        raise unreadable from None
    matrix: Floats = outer @ np.array([(own.a, own.c, own.e), (own.b, own.d, own.f), (0.0, 0.0, 1.0)])
    return matrix


@dataclass(frozen=True)
class _Element:
    """A visible element: its path in its own user units, its transform, ``(3, 3)``, and how it is painted."""

    path: list[Any]
    matrix: Floats
    filled: bool
    stroked: bool
    even_odd: bool
    white: bool

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
    """

    element: ET.Element
    matrix: Floats
    style: dict[str, str]
    layer: bool
    chosen: bool
    clones: frozenset[str]
    depth: int
    viewport: Size
    given: tuple[str | None, str | None] | None = None


class _Page:
    """Walks the tree of a file, and counts what is passed over."""

    def __init__(self, root: ET.Element, options: ReadOptions) -> None:
        self.root, self.options = root, options
        self.ignored: Counter[str] = Counter()
        self.named: set[str] = set()
        self.labels: set[str] = set()
        self.numbers = 0

    @cached_property
    def by_id(self) -> dict[str, ET.Element]:
        """The elements that a clone can refer to."""
        return {element.attrib["id"]: element for element in reversed(list(self.root.iter())) if element.get("id")}

    @cached_property
    def rules(self) -> list[tuple[str, dict[str, str]]]:
        """The simple selectors (element, .class, #id) of the style sheets in the file, and their declarations."""
        sheets = " ".join(element.text or "" for element in self.root.iter() if tag_of(element) == "style")
        sheets = re.sub(r"/\*.*?(?:\*/|\Z)", "", sheets, flags=re.DOTALL)
        pairs = ((names, _declarations(body)) for names, body in _RULE.findall(sheets))
        rules = [(name.strip(), said) for names, said in pairs for name in names.split(",")]
        # In the order of their weight: of those that apply to an element, the last one wins.
        return sorted(rules, key=lambda rule: {"#": 3, ".": 2, "*": 0}.get(rule[0][:1], 1))

    def nothing(self) -> str:
        """Return the error message for a file in which no outline is found."""
        for option, names, there in (
            ("--id", self.options.ids, self.named),
            ("--layer", self.options.layers, self.labels),
        ):
            if names:
                known = ", ".join(sorted(there)[:20]) or "none"
                return f"no outline is in {option} {', '.join(names)}; the file has {known}"
        texts = ", and make texts into paths" if self.ignored["text"] else ""
        return f"the file has no polygon, polyline, rect or path; draw a closed outline{texts}"

    def seen(self) -> list[_Element]:
        """Return the painted outlines, or all if none is painted, without a white background behind all others."""
        every = list(self.outlines())
        seen = [one for one in every if one.filled or one.stroked] or every
        self.ignored["outline without fill and stroke"] += len(every) - len(seen)
        while len(seen) > 1 and seen[0].white:
            (low, high), *others = [_box(one) for one in seen]
            if not all((low <= one).all() and (high >= other).all() for one, other in others):
                break
            self.ignored["white background"] += 1
            seen = seen[1:]
        return seen

    def outlines(self) -> Iterator[_Element]:
        """Yield every visible outline, in drawing order."""
        count: Counter[str] = Counter()
        style, matrix = self._style(self.root, {}), _transform(self.root, np.eye(3), "the svg element")
        layer, chosen = not self.options.layers, not self.options.ids
        every = _Visit(self.root, matrix, style, layer, chosen, frozenset(), 0, _root_viewport(self.root))
        waiting = _children(every, matrix, style, every.viewport)
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
                    viewport = seen.viewport
                    if tag in ("svg", "symbol"):
                        matrix, viewport = _viewport(seen, matrix, name)
                    waiting += _children(seen, matrix, style, viewport)
                elif seen.layer and seen.chosen:
                    filled = tag != "line" and style.get("fill") not in _NO_PAINT
                    even_odd = style.get("fill-rule") == "evenodd" or not filled
                    drawn = element.get("points", element.get("d", ""))
                    self.numbers += len(re.findall(NUMBER, drawn)) + len(re.findall("[Zz]", drawn))
                    if self.numbers > 4 * self.options.limits.points:
                        raise _too_many(self.options)
                    if path := path_of(element, name, seen.viewport):
                        stroked = style.get("stroke", "black" if tag == "line" else "none") not in _NO_PAINT
                        white = style.get("fill", "").lower().replace(" ", "") in _WHITE and not stroked
                        yield _Element(path, matrix, filled, stroked, even_odd, white)

    def _style(self, element: ET.Element, outer: dict[str, str]) -> dict[str, str]:
        """Return those properties of an element that matter here; all but display are inherited."""
        style = {name: value for name, value in outer.items() if name != "display"}
        style |= {name: element.attrib[name].strip() for name in _STYLES if element.get(name, "inherit") != "inherit"}
        if self.rules:
            selectors = {tag_of(element), f"#{element.get('id')}", *(f".{c}" for c in element.get("class", "").split())}
            for selector, said in self.rules:
                if selector in selectors or selector == "*":
                    style |= said
        return style | _declarations(element.get("style", ""))

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

    def _clone(self, seen: _Visit, matrix: Floats, style: dict[str, str], name: str) -> list[_Visit]:
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


def _box(element: _Element) -> tuple[Floats, Floats]:
    """Return the corners of the rough box around an outline; that of an empty one lies within every other."""
    points = element.points(math.inf)
    return points.min(axis=1, initial=math.inf), points.max(axis=1, initial=-math.inf)


def _children(seen: _Visit, matrix: Floats, style: dict[str, str], viewport: Size) -> list[_Visit]:
    """Return visits of the children of an element, the first child last."""
    inner = replace(seen, matrix=matrix, style=style, depth=seen.depth + 1, viewport=viewport, given=None)
    return [replace(inner, element=child) for child in reversed(seen.element)]


def _declarations(text: str) -> dict[str, str]:
    """Return those declarations of a style that matter here."""
    pairs = (part.partition(":") for part in text.split(";"))
    said = {name.strip(): value.replace("!important", "").strip() for name, _, value in pairs}
    return {name: said[name] for name in _STYLES if said.get(name, "inherit") != "inherit"}


def _root_viewport(root: ET.Element) -> Size:
    """Return the size of the outermost svg element in user units, or None if the file does not say."""
    if "viewBox" in root.attrib:
        _, _, width, height = _view_box(root, "the viewBox")
        return width, height
    width_mm, height_mm = _side_mm(root, "width"), _side_mm(root, "height")
    if width_mm is None or height_mm is None:
        return None
    return width_mm / MM_PER_UNIT["px"], height_mm / MM_PER_UNIT["px"]


def _place(seen: _Visit, name: str) -> list[float]:
    """Return x and y of an element."""
    sizes = zip(("x", "y"), seen.viewport or (None, None), strict=True)
    return [user_units(seen.element.get(side, "0"), f"{side} of {name}", whole) for side, whole in sizes]


def _viewport(seen: _Visit, matrix: Floats, name: str) -> tuple[Floats, Size]:
    """Return the transform and the viewport inside a nested svg or a symbol, whose viewBox is fitted into its size."""
    element = seen.element
    x, y = _place(seen, name)
    placed: Floats = matrix @ np.array([(1.0, 0.0, x), (0.0, 1.0, y), (0.0, 0.0, 1.0)])
    box = _view_box(element, f"the viewBox of {name}") if "viewBox" in element.attrib else None
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
        return placed, size
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
    return fitted, (box[2], box[3])


def _view_box(element: ET.Element, what: str) -> list[float]:
    box = number_list(element.attrib["viewBox"], what)
    if len(box) != 4 or not min(box[2:]) > 0:
        raise FileFormatError(f"{what} is {element.attrib['viewBox']!r}; give min-x min-y width height")
    return box
