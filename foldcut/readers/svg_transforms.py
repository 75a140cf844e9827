"""Transforms of SVG elements: the attribute, and CSS with its origin and reference box.

The properties of an element -> its transform, ``(3, 3)``. CSS is read as browsers do (CSS Transforms 1 and 2): the
property comes before the attribute; ``translate``, ``rotate`` and ``scale`` before ``transform``; all of them about
``transform-origin``, which is (0, 0) unless it is given. What is turned out of the plane is seen from the front.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any

import numpy as np
from svgelements import Matrix

from foldcut.core.arrays import Floats
from foldcut.core.errors import FileFormatError
from foldcut.core.units import MM_PER_UNIT
from foldcut.readers.svg_paths import NEXT
from foldcut.readers.svg_style import Style

Box = tuple[float, float, float, float]
"""Left, top, width and height of what percentages and keywords refer to."""

PROPERTIES = ("transform", "translate", "rotate", "scale")

_ATTRIBUTE = re.compile(
    rf"(?:[\s,]*+(?:matrix\s*\((?:{NEXT}){{6}}|(?:translate|scale)\s*\((?:{NEXT}){{1,2}}"
    rf"|rotate\s*\((?:{NEXT})(?:{NEXT}{NEXT})?|skew[XY]\s*\({NEXT})\s*\))*+[\s,]*+"
)
_LENGTHS = {unit: MM_PER_UNIT[unit] / MM_PER_UNIT["px"] for unit in ("px", "mm", "cm", "in", "pt", "pc")}
_LENGTHS["q"] = _LENGTHS["mm"] / 4
_DEGREES = {"deg": 1.0, "grad": 0.9, "rad": 180 / math.pi, "turn": 360.0}
_SIDES = {"left": 0.0, "top": 0.0, "center": 0.5, "right": 1.0, "bottom": 1.0}


class UnreadableError(Exception):
    """A value of CSS that is not understood; it counts as if it were not there."""


def of_attribute(text: str, name: str) -> Floats:
    """Return the transform, ``(3, 3)``, of the attribute of an element; ``name`` is the element's, for errors."""
    unreadable = FileFormatError(f"{name} has the transform {text[:40]!r}; correct it, or apply it to the points")
    if not _ATTRIBUTE.fullmatch(text):
        raise unreadable
    try:
        own = Matrix(text)
    except ValueError:  # for an angle beyond float64
        raise unreadable from None
    return np.array([(own.a, own.c, own.e), (own.b, own.d, own.f), (0.0, 0.0, 1.0)])


def about(matrix: Floats, origin: tuple[float, float]) -> Floats:
    """Return a transform, ``(3, 3)``, about another origin than (0, 0)."""
    there, back = np.eye(3), np.eye(3)
    there[:2, 2], back[:2, 2] = origin, (-origin[0], -origin[1])
    turned: Floats = there @ matrix @ back
    return turned


def of_css(style: Style, box: Box) -> Floats | None:
    """Return the transform, ``(3, 3)``, that CSS gives an element, without its origin; None if it gives none.

    Raises ``UnreadableError``.
    """
    if not any(name in style for name in PROPERTIES):
        return None
    whole = np.eye(4)
    for name in ("translate", "rotate", "scale"):
        if style.get(name, "none").lower() != "none":
            whole = whole @ _single(name, style[name], box)
    text = style.get("transform", "none")
    if text.lower() != "none":
        for node in _nodes(text):
            if node.type != "function":
                raise UnreadableError(text)
            whole = whole @ _function(node.lower_name, _arguments(node.arguments), box)
    flat: Floats = whole[np.ix_((0, 1, 3), (0, 1, 3))]
    if not np.array_equal(whole[3], (0, 0, 0, 1)):
        raise UnreadableError(text)
    return flat


def origin_of(text: str, box: Box, *, unitless: bool) -> tuple[float, float]:
    """Return the point that ``transform-origin`` means; ``unitless``: it is an attribute, where numbers are lengths.

    Raises ``UnreadableError``.
    """
    nodes = _nodes(text)[:2]
    words = [node.lower_value if node.type == "ident" else "" for node in nodes]
    if len(nodes) == 1:
        nodes, words = (nodes * 2, ["center", words[0]]) if words[0] in ("top", "bottom") else (nodes * 2, [*words, ""])
        if words[1] == "":
            words[1] = "center"
    elif words[0] in ("top", "bottom") or words[1] in ("left", "right"):
        nodes, words = nodes[::-1], words[::-1]
    found = []
    for node, word, start, size in zip(nodes, words, box[:2], box[2:], strict=True):
        if word:
            if word not in _SIDES:
                raise UnreadableError(text)
            found.append(start + _SIDES[word] * size)
        else:
            found.append(start + _length(node, size, unitless=unitless))
    return found[0], found[1]


def _nodes(text: str) -> list[Any]:
    import tinycss2

    found = [
        node for node in tinycss2.parse_component_value_list(text, skip_comments=True) if node.type != "whitespace"
    ]
    if not found:
        raise UnreadableError(text)
    return found


def _finite(value: float) -> float:
    if not math.isfinite(value):
        raise UnreadableError
    return value


def _arguments(nodes: list[Any]) -> list[Any]:
    return [node for node in nodes if node.type not in ("whitespace", "comment") and node != ","]


def _number(node: Any) -> float:
    if node.type not in ("percentage", "number"):
        raise UnreadableError
    return _finite(float(node.value) / (100 if node.type == "percentage" else 1))


def _length(node: Any, whole: float, *, unitless: bool = False) -> float:
    if node.type == "percentage":
        return _finite(float(node.value) / 100 * whole)
    if node.type == "number" and (unitless or node.value == 0):
        return _finite(float(node.value))
    if node.type != "dimension" or node.lower_unit not in _LENGTHS:
        raise UnreadableError
    return _finite(float(node.value) * _LENGTHS[node.lower_unit])


def _angle(node: Any) -> float:
    """Return an angle in radians."""
    if node.type == "number" and node.value == 0:
        return 0.0
    if node.type != "dimension" or node.lower_unit not in _DEGREES:
        raise UnreadableError
    return math.radians(_finite(float(node.value) * _DEGREES[node.lower_unit]))


def _single(name: str, text: str, box: Box) -> Floats:
    """Return the transform, ``(4, 4)``, of one of the properties ``translate``, ``rotate`` and ``scale``."""
    nodes = _nodes(text)
    if name == "translate":
        return _function("translate3d" if len(nodes) == 3 else "translate", nodes, box)
    if name == "scale":
        return _function("scale3d" if len(nodes) == 3 else "scale", nodes, box)
    if len(nodes) == 1:
        return _function("rotate", nodes, box)
    angles = [node for node in nodes if node.type == "dimension"]
    rest = [node for node in nodes if node.type != "dimension"]
    if len(angles) == 1 and len(rest) == 1 and rest[0].type == "ident" and rest[0].lower_value in ("x", "y", "z"):
        return _function(f"rotate{rest[0].lower_value}", angles, box)
    return _function("rotate3d", [*rest, *angles], box)


def _function(name: str, given: list[Any], box: Box) -> Floats:
    """Return the transform, ``(4, 4)``, of one function of ``transform``; raises ``UnreadableError``."""
    least, most, make = _FUNCTIONS.get(name, (1, 0, _matrix))
    if not least <= len(given) <= most:
        raise UnreadableError(name)
    return make(given, box)


def _moved(x: float, y: float, z: float = 0.0) -> Floats:
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def _turned(x: float, y: float, z: float, angle: float) -> Floats:
    """Return the rotation about an axis (CSS Transforms 2, section 13.1; Rodrigues' formula)."""
    length = math.sqrt(x * x + y * y + z * z)
    if not length:
        return np.eye(4)
    x, y, z = x / length, y / length, z / length
    cross = np.array([(0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)])
    matrix = np.eye(4)
    matrix[:3, :3] += math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    return matrix


def _sheared(x: float, y: float) -> Floats:
    matrix = np.eye(4)
    matrix[0, 1], matrix[1, 0] = math.tan(x), math.tan(y)
    return matrix


def _scaled(given: list[Any], _: Box) -> Floats:
    x = _number(given[0])
    return np.diag([x, _number(given[1]) if len(given) > 1 else x, 1.0, 1.0])


def _matrix(given: list[Any], _: Box) -> Floats:
    a, b, c, d, e, f = map(_number, given)
    return np.array([(a, c, 0, e), (b, d, 0, f), (0, 0, 1, 0), (0, 0, 0, 1)], dtype=np.float64)


_FUNCTIONS: dict[str, tuple[int, int, Callable[[list[Any], Box], Floats]]] = {
    "matrix": (6, 6, _matrix),
    "matrix3d": (16, 16, lambda given, _: np.array(list(map(_number, given))).reshape(4, 4).T),
    "translate": (
        1,
        2,
        lambda given, box: _moved(_length(given[0], box[2]), _length(given[1], box[3]) if len(given) > 1 else 0.0),
    ),
    "translatex": (1, 1, lambda given, box: _moved(_length(given[0], box[2]), 0.0)),
    "translatey": (1, 1, lambda given, box: _moved(0.0, _length(given[0], box[3]))),
    "translatez": (1, 1, lambda given, _: _moved(0.0, 0.0, _length(given[0], math.nan))),
    "translate3d": (
        3,
        3,
        lambda given, box: _moved(_length(given[0], box[2]), _length(given[1], box[3]), _length(given[2], math.nan)),
    ),
    "scale": (1, 2, _scaled),
    "scalex": (1, 1, lambda given, _: np.diag([_number(given[0]), 1.0, 1.0, 1.0])),
    "scaley": (1, 1, lambda given, _: np.diag([1.0, _number(given[0]), 1.0, 1.0])),
    "scalez": (1, 1, lambda given, _: np.diag([1.0, 1.0, _number(given[0]), 1.0])),
    "scale3d": (3, 3, lambda given, _: np.diag([*map(_number, given), 1.0])),
    "rotate": (1, 1, lambda given, _: _turned(0.0, 0.0, 1.0, _angle(given[0]))),
    "rotatez": (1, 1, lambda given, _: _turned(0.0, 0.0, 1.0, _angle(given[0]))),
    "rotatex": (1, 1, lambda given, _: _turned(1.0, 0.0, 0.0, _angle(given[0]))),
    "rotatey": (1, 1, lambda given, _: _turned(0.0, 1.0, 0.0, _angle(given[0]))),
    "rotate3d": (
        4,
        4,
        lambda given, _: _turned(_number(given[0]), _number(given[1]), _number(given[2]), _angle(given[3])),
    ),
    "skew": (1, 2, lambda given, _: _sheared(_angle(given[0]), _angle(given[1]) if len(given) > 1 else 0.0)),
    "skewx": (1, 1, lambda given, _: _sheared(_angle(given[0]), 0.0)),
    "skewy": (1, 1, lambda given, _: _sheared(0.0, _angle(given[0]))),
}
"""By the function's name in lower case: how many arguments it takes, and what it does."""
