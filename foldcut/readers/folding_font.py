"""The font made for folding, ``--font foldcut``: letters and digits whose outlines need few folds.

``folding_font.toml`` has the centre lines of all strokes on a small grid -> the outline of each glyph, as loops. All
strokes are equally wide and have mitred bends, so that both sides of a stroke bend together: then the ridges between
them are one line, and where ridges meet there is an even number of them, so no perpendicular begins.
"""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np
import shapely

from foldcut.core.arrays import Floats

__all__ = ["NAME", "FoldingFont", "Glyph", "folding_font"]

NAME = "foldcut"
"""The name of the font."""

GRID = 1e-9
"""Coordinates of outlines are rounded to this, in units of the font, so that equal corners are equal numbers."""

STRAIGHT = 1e-6
"""Corners are left out where the outline turns by less than this, as the sine of the angle times both lengths."""

_MITRE = {"join_style": "mitre", "mitre_limit": 20.0}


@dataclass(frozen=True, eq=False)
class Glyph:
    """The outline of a letter, in units of the font: ``loops`` ``(n, 2)``, y up from the baseline; and its ``width``.

    There are no loops for a space.
    """

    loops: tuple[Floats, ...]
    width: float


@dataclass(frozen=True, eq=False)
class FoldingFont:
    """All glyphs by their letters; lengths in units of the font: the ``stroke`` is as wide everywhere.

    ``height`` is that of a capital, ``gap`` what is between two letters, ``line`` the distance between lines of text.
    """

    stroke: float
    height: float
    gap: float
    line: float
    glyphs: dict[str, Glyph]


@cache
def folding_font() -> FoldingFont:
    """Return the font."""
    data = tomllib.loads(files("foldcut.readers").joinpath("folding_font.toml").read_text("utf-8"))
    stroke, height = float(data["stroke"]), float(data["height"])
    glyphs = {
        letter: Glyph(
            _outline(row["strokes"], stroke, row.get("box", (0.0, 0.0, row["width"], height))), float(row["width"])
        )
        for letter, row in data["glyphs"].items()
    }
    return FoldingFont(stroke, height, float(data["gap"]), float(data["line"]), glyphs)


def _outline(strokes: Sequence[Sequence[Sequence[float]]], width: float, box: Sequence[float]) -> tuple[Floats, ...]:
    """Return the loops around strokes of a pen; what is outside of a box is left out."""
    parts = []
    for stroke in strokes:
        if stroke[0] == stroke[-1]:
            parts.append(shapely.buffer(shapely.LinearRing(stroke), width / 2, **_MITRE))
        else:
            parts.append(shapely.buffer(shapely.LineString(stroke), width / 2, cap_style="flat", **_MITRE))
    drawn = shapely.intersection(shapely.union_all(parts, grid_size=GRID), shapely.box(*box), grid_size=GRID)
    rings = [ring for part in shapely.get_parts(drawn) for ring in (part.exterior, *part.interiors)]
    return tuple(_corners(shapely.get_coordinates(ring)[:-1]) for ring in rings)


def _corners(points: Floats) -> Floats:
    """Return the points at which a loop turns."""
    before, after = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    corners: Floats = points[np.abs(turn) > STRAIGHT]
    return corners
