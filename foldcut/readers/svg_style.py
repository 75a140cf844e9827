"""What style sheets, ``style`` and presentation attributes say of SVG elements: the cascade, and colours.

The elements of a file -> the properties of one of them (``Cascade.style``): attributes, then rules of style sheets by
specificity, then ``style``, then the same once more for what is ``!important`` (CSS Cascading 4, section 6; SVG 2,
section 6.6). cssselect2 matches selectors and tinycss2 divides style sheets; both are imported where a file has any.
Rules for other media than a screen are passed over, and so is what is not understood, which is counted.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Callable, Iterator
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

from foldcut.core.errors import FileFormatError
from foldcut.readers.svg_paths import NUMBER, tag_of

MOST_RULES = 10_000
"""Style sheets with more selectors are refused."""

MOST_MATCHES = 20_000_000
"""Style sheets are refused where selectors times elements are more than this."""

UNREADABLE = "unreadable style rule"
"""What is counted for each rule or declaration that is not understood."""

INHERITED = frozenset(
    {"visibility", "color", "fill", "fill-rule", "fill-opacity", "stroke", "stroke-width", "stroke-opacity"}
    | {"clip-rule", "stroke-linecap", "stroke-linejoin", "stroke-miterlimit", "stroke-dasharray"}
)
GEOMETRY = frozenset(("x", "y", "cx", "cy", "r", "rx", "ry", "width", "height"))
"""Attributes that are properties of CSS, too (SVG 2, section 8.1 and chapter 10)."""

_CSS_ONLY = frozenset(("translate", "rotate", "scale", "d", *GEOMETRY))
"""Properties whose attributes of the same name are read elsewhere, or are none."""

_LENGTH = re.compile(rf"(?:{NUMBER})(?:px|mm|cm|in|pt|pc|%)?")
_SHARE = re.compile(rf"(?:{NUMBER})%?")
_PLAIN = re.compile(r"[^\"'/\\!{}@]*")
_URL = re.compile(r"url\(\s*+[\"']?+([^)\"']*+)[\"']?+\s*+\)\s*+(.*)", re.DOTALL | re.IGNORECASE)
_VARIABLE = re.compile(r"var\(\s*(--[\w-]+)\s*(?:,([^()]*))?\)")
_GLOBAL = ("inherit", "initial", "unset", "revert", "revert-layer")
_SILENT = ("charset", "font-face", "keyframes", "-webkit-keyframes", "page", "counter-style", "property")
"""At-rules that do not change where outlines are."""

_FEATURES = {
    "prefers-color-scheme": {"light": True, "dark": False},
    "prefers-reduced-motion": {"no-preference": True, "reduce": False},
}

Style = dict[str, str]


class Colour(NamedTuple):
    """Red, green, blue and alpha, from 0 to 1."""

    red: float
    green: float
    blue: float
    alpha: float

    @property
    def is_white(self) -> bool:
        """Whether this cannot be told from white paper, and hides what is behind it."""
        return min(self) > 0.97


BLACK = Colour(0.0, 0.0, 0.0, 1.0)
_PLAIN_COLOURS = {
    "black": BLACK,
    "white": Colour(1.0, 1.0, 1.0, 1.0),
    "transparent": Colour(0.0, 0.0, 0.0, 0.0),
    "red": Colour(1.0, 0.0, 0.0, 1.0),
}


@lru_cache(maxsize=4096)
def colour_of(text: str) -> Colour | None:
    """Return a colour of CSS; None if the text is none. ``currentColor`` is for the caller."""
    text = text.strip().lower()
    if text in _PLAIN_COLOURS:
        return _PLAIN_COLOURS[text]
    if match := re.fullmatch("#([0-9a-f]{6})", text):
        red, green, blue = (int(match[1][at : at + 2], 16) / 255 for at in (0, 2, 4))
        return Colour(red, green, blue, 1.0)
    import tinycss2.color4

    if text == "currentcolor":
        return None
    try:
        colour: Any = tinycss2.color4.parse_color(text)
        if colour is None:
            return None
        try:
            values = [float(value or 0.0) for value in colour.to("srgb").coordinates]
        except NotImplementedError:  # for lab, lch and the like: whether it is white
            values = [1.0 if colour.coordinates[0] in (1.0, 100.0) and not any(colour.coordinates[1:]) else 0.5] * 3
        red, green, blue = values
        return Colour(red, green, blue, float(colour.alpha))
    except (ValueError, TypeError, ArithmeticError, AttributeError, RecursionError):
        return None


def share(text: str) -> float:
    """Return a number or a percentage as a share from 0 to 1."""
    number = float(text.rstrip("% "))
    return min(max(number / 100 if text.rstrip().endswith("%") else number, 0.0), 1.0)


def _is_paint(text: str) -> bool:
    if match := _URL.fullmatch(text):
        return not match[2] or _is_paint(match[2])
    lower = text.lower()
    return lower in ("none", "currentcolor", "context-fill", "context-stroke") or colour_of(text) is not None


def _one_of(*words: str) -> Callable[[str], bool]:
    return lambda text: text.lower() in words


def _is_share(text: str) -> bool:
    return bool(_SHARE.fullmatch(text))


def _is_length(text: str) -> bool:
    return bool(_LENGTH.fullmatch(text)) and not text.startswith("-")


def _any(text: str) -> bool:
    return bool(text)


CHECKS: dict[str, Callable[[str], bool]] = {
    "display": lambda text: bool(re.fullmatch(r"[a-zA-Z-]+(\s+[a-zA-Z-]+)*", text)),
    "visibility": _one_of("visible", "hidden", "collapse"),
    "color": lambda text: text.lower() == "currentcolor" or colour_of(text) is not None,
    "fill": _is_paint,
    "stroke": _is_paint,
    **dict.fromkeys(("fill-rule", "clip-rule"), _one_of("nonzero", "evenodd")),
    **dict.fromkeys(("opacity", "fill-opacity", "stroke-opacity", "stop-opacity"), _is_share),
    "stop-color": lambda text: text.lower() == "currentcolor" or colour_of(text) is not None,
    "stroke-width": _is_length,
    "stroke-linecap": _one_of("butt", "round", "square"),
    "stroke-linejoin": _one_of("miter", "round", "bevel", "miter-clip", "arcs"),
    "stroke-miterlimit": lambda text: bool(re.fullmatch(NUMBER, text)),
    **dict.fromkeys(("transform", "transform-origin", "transform-box", "translate", "rotate", "scale"), _any),
    **dict.fromkeys(("clip-path", "mask", "filter", "overflow", "vector-effect", "stroke-dasharray"), _any),
    **dict.fromkeys(("x", "y", "cx", "cy", "r", "rx", "ry", "width", "height"), lambda text: bool(text)),
    "d": lambda text: text == "none" or text.startswith("path("),
}
"""The properties that matter here, and whether browsers take a text as their value; else it is as if not there."""


def inherited(style: Style) -> Style:
    """Return what an element hands on to those in it."""
    return {name: value for name, value in style.items() if name in INHERITED or name.startswith("--")}


class Cascade:
    """The style sheets of a file. ``ignored`` counts what is not understood, and sheets from outside the file."""

    def __init__(self, root: ET.Element, ignored: Counter[str]) -> None:
        self.root, self.ignored = root, ignored
        self._inline: dict[str, list[tuple[str, str, bool]]] = {}
        self._unread: set[str] = set()

    @cached_property
    def matcher(self) -> Any:
        """The rules of all style sheets, or None if there are none."""
        sheets = [
            element.text or ""
            for element in self.root.iter()
            if tag_of(element) == "style" and element.get("type", "text/css") in ("", "text/css")
            if self._media(element.get("media", ""))
        ]
        if not "".join(sheets).strip():
            return None
        import cssselect2
        import tinycss2

        self.spaces: dict[Any, str] = {}
        matcher, count = cssselect2.Matcher(), 0
        for sheet in sheets:
            rules = tinycss2.parse_stylesheet(sheet, skip_comments=True, skip_whitespace=True)
            for prelude, content in self._rules(rules, 0):
                declared = self._declared(content)
                try:
                    selectors = cssselect2.compile_selector_list(prelude, namespaces=self.spaces)
                except (cssselect2.SelectorError, RecursionError):
                    self.ignored[UNREADABLE] += 1
                    continue
                count += len(selectors)
                if count > MOST_RULES:
                    raise FileFormatError(f"its style sheets have more than {MOST_RULES:,} selectors; remove some")
                for selector in selectors:
                    if selector.pseudo_element is None and declared:
                        matcher.add_selector(selector, declared)
        elements = sum(1 for _ in self.root.iter())
        if count * elements > MOST_MATCHES:
            raise FileFormatError(
                f"its style sheets have {count:,} selectors for {elements:,} elements; give a simpler drawing"
            )
        return matcher

    @cached_property
    def wrappers(self) -> dict[ET.Element, Any]:
        """What cssselect2 knows of each element of the file."""
        import cssselect2

        whole = cssselect2.ElementWrapper.from_xml_root(self.root)
        return {wrapper.etree_element: wrapper for wrapper in whole.iter_subtree()}

    def _media(self, text: str) -> bool:
        """Whether a list of media queries holds for a screen; one that is not understood is counted."""
        if not text.strip():
            return True
        known = [_query(one) for one in text.lower().split(",")]
        if any(known):
            return True
        self.ignored[UNREADABLE] += sum(one is None for one in known)
        return False

    def _rules(self, rules: list[Any], depth: int) -> Iterator[tuple[Any, Any]]:
        """Yield the prelude and the content of each rule that holds for a screen."""
        import tinycss2

        for rule in rules:
            if rule.type == "qualified-rule":
                yield rule.prelude, rule.content
            elif rule.type != "at-rule":
                self.ignored[UNREADABLE] += 1
            elif rule.lower_at_keyword == "media" and rule.content is not None and depth < 10:
                if self._media(tinycss2.serialize(rule.prelude)):
                    inner = tinycss2.parse_rule_list(rule.content, skip_comments=True, skip_whitespace=True)
                    yield from self._rules(inner, depth + 1)
            elif rule.lower_at_keyword == "import":
                self.ignored["external style sheet"] += 1
            elif rule.lower_at_keyword == "namespace":
                self._name_space(rule.prelude)
            elif rule.lower_at_keyword not in _SILENT:
                self.ignored[UNREADABLE] += 1

    def _name_space(self, prelude: list[Any]) -> None:
        inner = [node.arguments[:1] if node.type == "function" else [node] for node in prelude]
        nodes = [node for part in inner for node in part if node.type in ("ident", "string", "url")]
        if nodes and nodes[-1].type != "ident":
            self.spaces[nodes[0].value if nodes[0].type == "ident" else None] = nodes[-1].value

    def _declared(self, content: Any) -> list[tuple[str, str, bool]]:
        """Return those declarations of a rule that matter here: name, value, and whether it is important."""
        import tinycss2

        found: list[tuple[str, str, bool]] = []
        for node in tinycss2.parse_blocks_contents(content, skip_comments=True, skip_whitespace=True):
            if node.type == "declaration":
                name = node.name if node.name.startswith("--") else node.lower_name
                self._add(found, name, tinycss2.serialize(node.value).strip(), node.important)
            elif node.type != "error" or node.kind != "empty":
                self.ignored[UNREADABLE] += 1
        return found

    def _add(self, found: list[tuple[str, str, bool]], name: str, value: str, important: bool) -> None:
        """Add a declaration if browsers would take it; one that they may take and that is not understood is counted."""
        value = re.sub(r"/\*.*?(?:\*/|\Z)", " ", value, flags=re.DOTALL).strip()
        if name.startswith("--"):
            found.append((name, value, important))
        elif name in CHECKS:
            if value.lower() in _GLOBAL or "var(" in value or CHECKS[name](value):
                found.append((name, value, important))
            elif (key := f"{name}:{value}") not in self._unread:
                self._unread.add(key)
                self.ignored[UNREADABLE] += 1

    def inline(self, text: str) -> list[tuple[str, str, bool]]:
        """Return the declarations in a ``style`` attribute."""
        if text not in self._inline:
            if not _PLAIN.fullmatch(text) or re.search(r"\([^();]*;", text):
                self._inline[text] = self._declared(text)
            else:
                found: list[tuple[str, str, bool]] = []
                for part in text.split(";"):
                    name, _, value = part.partition(":")
                    name = name.strip()
                    self._add(found, name if name.startswith("--") else name.lower(), value.strip(), False)
                self._inline[text] = found
        return self._inline[text]

    def style(self, element: ET.Element, outer: Style) -> Style:
        """Return the properties of an element that matter here; ``outer``: those of the element around it.

        A value from CSS of a property that is also an attribute with another grammar, ``transform``, stands under its
        name; the attribute itself is left to the caller.
        """
        given = [
            (name, element.attrib[name].strip(), False)
            for name, check in CHECKS.items()
            if name in element.attrib and name not in _CSS_ONLY and name != "transform"
            if check(element.attrib[name].strip()) or element.attrib[name].strip().lower() in _GLOBAL
        ]
        if self.matcher is not None:
            given += [one for *_, said in self.matcher.match(self.wrappers[element]) for one in said]
        text = element.get("style", "")
        if text:
            given += self.inline(text)
        style = inherited(outer)
        for important in (False, True):
            for name, value, weight in given:
                if weight == important:
                    style[name] = value
        if any("var(" in style[name] for name, *_ in given if name in style):
            style = self._with_variables(style, outer)
        for name, *_ in given:
            if name in style and style[name].lower() in _GLOBAL:
                word = style.pop(name).lower()
                if name in outer and (word == "inherit" or (word != "initial" and name in INHERITED)):
                    style[name] = outer[name]
        return style

    def _with_variables(self, style: Style, outer: Style) -> Style:
        """Return properties with the values of custom properties in place of their names."""
        found: Style = {}
        for name, value in style.items():
            for _ in range(10):
                if "var(" not in value or len(value) > 10_000:
                    break
                value = _VARIABLE.sub(lambda match: style.get(match[1], match[2] or ""), value).strip()
            if name.startswith("--") or value.lower() in _GLOBAL or CHECKS[name](value):
                found[name] = value
            elif name in INHERITED and name in outer:  # as if unset
                found[name] = outer[name]
        return found


def _query(text: str) -> bool | None:
    """Whether a media query holds for a screen; None if it is not understood."""
    match = re.fullmatch(
        r"\s*+(?:(not|only)\s++)?+([a-z-]++)?+\s*+(?:\band\b)?+\s*+((?:\([^()]*+\)\s*+(?:and\s*+)?+)*+)", text
    )
    if match is None or not (match[2] or match[3]):
        return None
    holds: bool | None = match[2] in (None, "screen", "all")
    for feature in re.findall(r"\(([^()]*)\)", match[3]):
        name, _, value = (part.strip() for part in feature.partition(":"))
        known = _FEATURES.get(name, {}).get(value)
        if holds:
            holds = known
    return holds if match[1] != "not" or holds is None else not holds
