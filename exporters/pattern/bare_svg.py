"""Bare SVG: the crease pattern as lines and nothing else, for programs that fold it.

Input: a ``FoldedPattern``; output: SVG with one ``<line style="stroke:...">`` for each edge, in mm, y pointing down:
red mountains, blue valleys, black border. Flat-Folder (io.js, SVG_2_L) and Origami Simulator (pattern.js,
typeForStroke) read it. For people there is ``svg``.
"""

from __future__ import annotations

from foldcut.core.model import FoldedPattern
from foldcut.profiles import Profile

from .edges import edge_lines

STROKES = {"B": "#000000", "M": "#ff0000", "V": "#0000ff"}
"""The colours by which programs tell assignments."""


def export(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return the edges as SVG lines; nothing in it depends on the profile."""
    width, height = (f"{size:g}" for size in (pattern.sheet.width, pattern.sheet.height))
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" viewBox="0 0 {width} {height}">'
    )
    lines = (
        f'<line x1="{a!r}" y1="{b!r}" x2="{c!r}" y2="{d!r}" style="stroke:{STROKES[letter]};stroke-width:0.25"/>'
        for letter, a, b, c, d in edge_lines(pattern)
    )
    return "\n".join(['<?xml version="1.0" encoding="utf-8"?>', head, *lines, "</svg>\n"]).encode()
