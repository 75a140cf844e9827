"""HTML: a page on which to look at a pattern, fold it and cut it; it loads nothing from anywhere.

Input: a ``FoldedPattern``; output: ``page.html`` with the pattern in it as JSON, and with ``page.css`` and ``page.js``,
which ``make page`` bundles from the folder ``page``. The page shows the steps in which the pattern is folded: the
states between them are those of ``folding_steps``, straight folds are exact, and of what closes together it shows a
picture, and says how far lengths are off.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
from functools import cache
from importlib.resources import files
from typing import Any

from foldcut.core.model import FoldedPattern
from foldcut.folding_steps import FoldingStep, folding_steps
from foldcut.profiles import Profile

__all__ = ["export", "page_part", "pattern_in"]

DIGITS = 6
"""Digits of a length in mm after the point: nanometres."""

STEP_DIGITS = 4
"""The same between two steps, where nothing is measured."""

MOST_STEPS = 300
"""Patterns with more creases than this close in one step: nobody folds them one by one."""


def export(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return a page that shows ``pattern``; nothing on it depends on the profile."""
    creases, folded = pattern.creases, pattern.folded
    steps = folding_steps(pattern) if creases.crease_count <= MOST_STEPS else ()
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
        "steps": [_step(step) for step in steps],
    }
    if pattern.drawn:
        data["drawn"] = [loop.round(DIGITS).tolist() for loop in pattern.drawn]
    # "<" would end the script element, whatever the title is
    text = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
    page = files(__package__).joinpath("page.html").read_text("utf-8")
    style, script = page_part("page.css"), page_part("page.js")
    for place, content in (
        ("STYLE-HASH", _hash(style)),
        ("SCRIPT-HASH", _hash(script)),
        (">STYLE<", f">{style}<"),
        ("<title>foldcut</title>", f"<title>{html.escape(pattern.title)} – foldcut</title>"),
        (">DATA<", f">{text}<"),
        (">SCRIPT<", f">{script}<"),
    ):
        page = page.replace(place, content, 1)
    return page.encode()


def _step(step: FoldingStep) -> dict[str, Any]:
    """Return a step as the page takes it: its creases, the sheet after it, and how a straight fold moves."""
    told: dict[str, Any] = {
        "edges": step.edges.tolist(),
        "at": step.state.vertices_coords.round(STEP_DIGITS).tolist(),
        "layers": step.state.layers.tolist(),
    }
    if step.line is not None and step.moved is not None:
        told |= {"line": step.line.round(DIGITS).tolist(), "moved": step.moved.tolist(), "over": step.over}
    return told


@cache
def page_part(name: str) -> str:
    """Return ``page.css`` or ``page.js``, which the page of ``foldcut serve`` has as well."""
    return files(__package__).joinpath(name).read_text("utf-8")


def _hash(text: str) -> str:
    """Return what a content security policy calls a text."""
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def pattern_in(page: bytes) -> bytes:
    """Return the pattern that is in a page of ``export``, as JSON; raises ``ValueError`` for any other page."""
    _, begins, rest = page.partition(b'<script type="application/json" id="data">')
    data, ends, _ = rest.partition(b"</script>")
    if not (begins and ends):
        raise ValueError("there is no pattern in this page")
    return data
