"""HTML: one page to look at a pattern, to fold it and to cut it, with nothing loaded from anywhere.

Input: a ``FoldedPattern``; output: ``page.html`` with the pattern as JSON in it. Both ends of its fold slider are the
verified states; what is shown in between is an approximation, and the page says how far lengths are off.
"""

from __future__ import annotations

import html
import json
from importlib.resources import files

from foldcut.core.model import FoldedPattern
from foldcut.profiles import Profile

DIGITS = 6  # of a millimetre: a nanometre


def export(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return a page that shows ``pattern``; nothing in it depends on the profile."""
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
        "shape": [loop.round(DIGITS).tolist() for loop in pattern.shape.loops],
        "first": [line.round(DIGITS).tolist() for line in pattern.first_folds],
    }
    # "<" would end the script element, whatever the title is
    text = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
    page = files(__package__).joinpath("page.html").read_text("utf-8")
    page = page.replace("<title>foldcut</title>", f"<title>{html.escape(pattern.title)} – foldcut</title>")
    return page.replace(">DATA<", f">{text}<").encode()
