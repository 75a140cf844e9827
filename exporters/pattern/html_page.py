"""HTML: a page on which to look at a pattern, fold it and cut it; it loads nothing from anywhere.

Input: a ``FoldedPattern``; output: ``page.html`` with the pattern in it as JSON. At both ends of its fold slider it
shows the verified states; in between it shows an approximation, and says how far lengths are off.
"""

from __future__ import annotations

import html
import json
from importlib.resources import files

from foldcut.core.model import FoldedPattern
from foldcut.profiles import Profile

DIGITS = 6
"""Digits of a length in mm after the point: nanometres."""


def export(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return a page that shows ``pattern``; nothing on it depends on the profile."""
    creases, folded = pattern.creases, pattern.folded
    data = {
        "title": pattern.title,
        "sheet": [pattern.sheet.width, pattern.sheet.height],
        "flat": creases.vertices_coords.round(DIGITS).tolist(),
        "folded": folded.vertices_coords.round(DIGITS).tolist(),
        "edges": creases.edges_vertices.tolist(),
        "letters": creases.edges_assignment.tolist(),
        "faces": creases.faces_vertices.to_lists(),
        "layers": folded.layers.tolist(),
        "shape": [stroke.round(DIGITS).tolist() for stroke in pattern.shape.closed_strokes],
        "first": [line.round(DIGITS).tolist() for line in pattern.first_folds],
    }
    if pattern.drawn:
        data["drawn"] = [loop.round(DIGITS).tolist() for loop in pattern.drawn]
    # "<" would end the script element, whatever the title is
    text = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
    page = files(__package__).joinpath("page.html").read_text("utf-8")
    page = page.replace("<title>foldcut</title>", f"<title>{html.escape(pattern.title)} – foldcut</title>")
    return page.replace(">DATA<", f">{text}<").encode()
