"""Crease patterns as bare lines, for programs that fold them: SVG, .cp and .opx.

Input: a ``FoldedPattern``; output: one line for each edge, in mm, y pointing down, unmerged and unbroken.

- SVG: ``<line style="stroke:...">`` and nothing else, red mountains, blue valleys, black border: what Flat-Folder
  (io.js, SVG_2_L) and Origami Simulator (pattern.js, typeForStroke) read.
- .cp: ``type x1 y1 x2 y2``, 1 border, 2 mountain, 3 valley: ORIPA, Orihime, Flat-Folder (io.js, CP_2_L).
- .opx: ORIPA's own XML of Java beans, the same types (Flat-Folder's io.js, OPX_2_L).
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator

from foldcut.model import FoldedPattern
from foldcut.profiles import Profile

from .text import printable

STROKES = {"B": "#000000", "M": "#ff0000", "V": "#0000ff"}
TYPES = {"B": 1, "M": 2, "V": 3}


def export_svg(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return the edges as SVG lines; nothing in it depends on the profile."""
    width, height = (f"{size:g}" for size in (pattern.sheet.width, pattern.sheet.height))
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" viewBox="0 0 {width} {height}">'
    )
    lines = (
        f'<line x1="{a!r}" y1="{b!r}" x2="{c!r}" y2="{d!r}" style="stroke:{STROKES[letter]};stroke-width:0.25"/>'
        for letter, a, b, c, d in _edges(pattern)
    )
    return "\n".join(['<?xml version="1.0" encoding="utf-8"?>', head, *lines, "</svg>\n"]).encode()


def export_cp(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return the edges as a .cp file; nothing in it depends on the profile."""
    lines = (f"{TYPES[letter]} {a!r} {b!r} {c!r} {d!r}\n" for letter, a, b, c, d in _edges(pattern))
    return "".join(lines).encode("ascii")


def export_opx(pattern: FoldedPattern, profile: Profile) -> bytes:
    """Return the edges as an .opx file; nothing in it depends on the profile."""
    edges = list(_edges(pattern))
    root = ET.Element("java", version="1.8.0", attrib={"class": "java.beans.XMLDecoder"})
    data = ET.SubElement(root, "object", attrib={"class": "oripa.DataSet"})
    lines = ET.SubElement(data, "void", property="lines")
    array = ET.SubElement(lines, "array", attrib={"class": "oripa.OriLineProxy"}, length=str(len(edges)))
    for number, (letter, *coordinates) in enumerate(edges):
        line = ET.SubElement(ET.SubElement(array, "void", index=str(number)), "object")
        line.set("class", "oripa.OriLineProxy")
        ET.SubElement(ET.SubElement(line, "void", property="type"), "int").text = str(TYPES[letter])
        for name, value in zip(("x0", "y0", "x1", "y1"), coordinates, strict=True):
            ET.SubElement(ET.SubElement(line, "void", property=name), "double").text = repr(value)
    for name, kind, text in (
        ("mainVersion", "int", "1"),
        ("paperSize", "double", repr(max(pattern.sheet.width, pattern.sheet.height))),
        ("title", "string", printable(pattern.title)),
    ):
        ET.SubElement(ET.SubElement(data, "void", property=name), kind).text = text
    ET.indent(root, " ")
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root) + b"\n"


def _edges(pattern: FoldedPattern) -> Iterator[tuple[str, float, float, float, float]]:
    """Yield assignment and ends of all edges, y down."""
    creases = pattern.creases
    points = creases.vertices_coords * (1, -1) + (0, pattern.sheet.height)
    for (a, b), letter in zip(creases.edges_vertices.tolist(), creases.edges_assignment.tolist(), strict=True):
        (x1, y1), (x2, y2) = points[a].tolist(), points[b].tolist()
        yield letter, x1, y1, x2, y2
